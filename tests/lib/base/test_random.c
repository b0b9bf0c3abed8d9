/* test_random.c: the generator's published numbers, and the moments of what is made of them. */
#include <palpate/random.h>

#include <check.h>
#include <math.h>
#include <stdlib.h>

enum { N = 100000 };

START_TEST(splitmix64_gives_its_published_numbers) {
    static const uint64_t expected[] = {UINT64_C(6457827717110365317), UINT64_C(3203168211198807973),
                                        UINT64_C(9817491932198370423)};
    uint64_t state = 1234567;
    for (int i = 0; i < 3; i++)
        ck_assert_uint_eq(palp_random_next(&state), expected[i]);
    state = 1234567;
    ck_assert_double_eq_tol(palp_random_uniform(&state), 6457827717110365317.0 / 18446744073709551616.0,
                            1e-15);
}
END_TEST

/* Of a sample of normal numbers: the mean is 0, the square 1, and one in twenty is outside 1.96. */
static void check_normal(const double *x) {
    double mean = 0.0, square = 0.0, tail = 0.0;
    for (size_t k = 0; k < N; k++) {
        mean += x[k] / N;
        square += x[k] * x[k] / N;
        tail += fabs(x[k]) > 1.959964 ? 1.0 / N : 0.0;
    }
    ck_assert_double_lt(fabs(mean), 4.0 / sqrt(N));
    ck_assert_double_lt(fabs(square - 1.0), 4.0 * sqrt(2.0 / N));
    ck_assert_double_lt(fabs(tail - 0.05), 4.0 * sqrt(0.05 * 0.95 / N));
}

START_TEST(normal_numbers_are_normal) {
    static double x[N];
    uint64_t state = 1;
    double product = 0.0;
    for (size_t k = 0; k < N; k++)
        x[k] = palp_random_normal(&state);
    check_normal(x);
    for (size_t k = 1; k < N; k++)
        product += x[k] * x[k - 1] / N;
    ck_assert_double_lt(fabs(product), 4.0 / sqrt(N));
}
END_TEST

/* A seed's neighbour is not the same stream moved by one. */
START_TEST(normal_numbers_by_place) {
    static double x[N];
    double product = 0.0;
    for (size_t k = N; k-- > 0;) {
        x[k] = palp_random_normal_at(1, k);
        ck_assert(x[k] == palp_random_normal_at(1, k));
        product += x[k] * palp_random_normal_at(2, k + 1) / N;
    }
    check_normal(x);
    ck_assert_double_lt(fabs(product), 4.0 / sqrt(N));
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, splitmix64_gives_its_published_numbers);
    tcase_add_test(tc, normal_numbers_are_normal);
    tcase_add_test(tc, normal_numbers_by_place);
}
