/* test_realtime_ways.c: a rough tool on many random ways, with friction of 0 to 1 and 1 to 10 corrections a
 * tick. check: all */
#include "realtime_rough.h"

/* On the median way each correction leaves less than half of what one fewer does; of all steps from one
 * number of corrections to the next a twentieth at most make the error larger. */
static void check_ways(uint64_t from, uint64_t to) {
    const size_t corrections[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
    double median[10];
    const size_t rises = rough_ways(from, to, corrections, 10, median);
    for (size_t k = 1; k < 10; k++)
        ck_assert_msg(median[k] < 0.5 * median[k - 1], "%zu corrections: %g after %g", k + 1, median[k],
                      median[k - 1]);
    ck_assert_double_lt(median[1], 0.1 * median[0]);
    ck_assert_double_lt(median[9], 1e-5 * median[0]);
    ck_assert_uint_le(20 * rises, 9 * (size_t)(to - from));
}

START_TEST(many_random_ways) {
    check_ways(5, 45);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, many_random_ways);
}
