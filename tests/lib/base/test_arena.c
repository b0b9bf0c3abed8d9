/* test_arena.c: arrays of an arena are zero, apart from one another, and gone together. */
#include "base/arena.h"

#include <check.h>
#include <stdint.h>
#include <string.h>

START_TEST(arrays_are_zero_aligned_and_apart) {
    arena a = {NULL, false};
    unsigned char *array[20];
    for (size_t i = 0; i < 20; i++) {
        array[i] = arena_take(&a, i, 3);
        ck_assert_ptr_nonnull(array[i]);
        ck_assert_uint_eq((uintptr_t)array[i] % sizeof(double), 0);
        for (size_t k = 0; k < 3 * i; k++)
            ck_assert_uint_eq(array[i][k], 0);
        memset(array[i], (int)i + 1, 3 * i);
    }
    for (size_t i = 0; i < 20; i++)
        for (size_t k = 0; k < 3 * i; k++)
            ck_assert_uint_eq(array[i][k], i + 1);
    ck_assert(!a.failed);
    arena_free(&a);
    ck_assert_ptr_null(a.last);
}
END_TEST

START_TEST(what_does_not_fit_fails_and_is_remembered) {
    arena a = {NULL, false};
    ck_assert_ptr_null(arena_take(&a, SIZE_MAX / 8 + 1, 8));
    ck_assert(a.failed);
    ck_assert_ptr_nonnull(arena_take(&a, 1, 8));
    ck_assert(a.failed);
    arena_free(&a);
    ck_assert(!a.failed);
    arena_free(&a);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, arrays_are_zero_aligned_and_apart);
    tcase_add_test(tc, what_does_not_fit_fails_and_is_remembered);
}
