/* test_statistics.c: order statistics against sorted numbers. */
#include "base/statistics.h"

#include <check.h>
#include <palpate/random.h>
#include <stdlib.h>
#include <string.h>

enum { N = 101 };

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Numbers of every kind: any, many of them equal, sorted either way, all the same. */
static void fill(int kind, double x[N]) {
    uint64_t state = 5;
    for (size_t i = 0; i < N; i++) {
        double u = palp_random_uniform(&state), place = (double)i;
        const double kinds[] = {u, (double)(int)(4.0 * u), place, -place, 3.0};
        x[i] = kinds[kind];
    }
}

START_TEST(every_order_statistic) {
    double x[N], sorted[N], work[N];
    for (int kind = 0; kind < 5; kind++) {
        fill(kind, x);
        memcpy(sorted, x, sizeof x);
        qsort(sorted, N, sizeof *sorted, ascending);
        for (size_t k = 0; k < N; k++) {
            memcpy(work, x, sizeof x);
            ck_assert(statistics_kth(work, N, k) == sorted[k]);
        }
        ck_assert(statistics_median(work, N) == sorted[50]);
        ck_assert(statistics_median(memcpy(work, sorted, sizeof sorted), N - 1) == sorted[50]);
        ck_assert(statistics_quantile(work, N, 0.25) == sorted[25]);
        ck_assert(statistics_quantile(work, N, 1.0) == sorted[100]);
    }
}
END_TEST

START_TEST(a_line) {
    const double x[] = {1.0, 2.0, 4.0, 9.0}, y[] = {1.0, 4.0, 5.0, -7.0};
    const unsigned char use[] = {1, 1, 1, 0};
    statistics_line l = statistics_line_fit(4, x, y, use); /* means 7/3, 10/3; sxx 14/3, sxy 17/3 */
    ck_assert_double_eq(l.n, 3.0);
    ck_assert_double_eq_tol(l.mean_x, 7.0 / 3.0, 1e-15);
    ck_assert_double_eq_tol(l.mean_y, 10.0 / 3.0, 1e-15);
    ck_assert_double_eq_tol(l.sxx, 14.0 / 3.0, 1e-14);
    ck_assert_double_eq_tol(l.slope, 17.0 / 14.0, 1e-14);
    l = statistics_line_fit(3, NULL, y, NULL); /* at 0, 1, 2 */
    ck_assert_double_eq_tol(l.mean_x, 1.0, 1e-15);
    ck_assert_double_eq_tol(l.slope, 2.0, 1e-14);
    ck_assert_double_eq(statistics_line_fit(1, x, y, NULL).slope, 0.0);
}
END_TEST

START_TEST(a_mean) {
    double x[] = {1.0, 2.0, 6.0};
    ck_assert_double_eq(statistics_mean(x, 3), 3.0);
    ck_assert_double_eq(statistics_median(x, 1), 1.0);
}
END_TEST

/* As tables give them. */
START_TEST(quantiles_of_student_and_chi_squared) {
    ck_assert_double_eq_tol(palp_student_95(1), 12.7062, 1e-4);
    ck_assert_double_eq_tol(palp_student_95(2), 4.30265, 1e-5);
    ck_assert_double_eq_tol(palp_student_95(5), 2.57058, 1e-5);
    ck_assert_double_eq_tol(palp_student_95(30), 2.04227, 1e-5);
    ck_assert_double_eq_tol(palp_student_95(1000), 1.96234, 1e-5);
    ck_assert_double_eq_tol(statistics_chi2_quantile(1, 0.025), 0.00098207, 1e-8);
    ck_assert_double_eq_tol(statistics_chi2_quantile(1, 0.975), 5.02389, 1e-5);
    ck_assert_double_eq_tol(statistics_chi2_quantile(2, 0.025), 0.0506356, 1e-7);
    ck_assert_double_eq_tol(statistics_chi2_quantile(5, 0.975), 12.8325, 1e-4);
    ck_assert_double_eq_tol(statistics_chi2_quantile(10, 0.025), 3.24697, 1e-5);
    ck_assert_double_eq_tol(statistics_chi2_quantile(100, 0.975), 129.561, 1e-3);
    ck_assert_double_eq_tol(statistics_chi2_quantile(1000, 0.975), 1089.531, 0.05);
    ck_assert_double_eq_tol(statistics_chi2_quantile(10000, 0.01), 9673.949, 0.2);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, quantiles_of_student_and_chi_squared);
    tcase_add_test(tc, every_order_statistic);
    tcase_add_test(tc, a_line);
    tcase_add_test(tc, a_mean);
}
