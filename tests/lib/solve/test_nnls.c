/* test_nnls.c: least squares with unknowns that are not negative, judged by the conditions of Kuhn and
 * Tucker. */
#include "solve/nnls.h"

#include <check.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

/* In (-0.5, 0.5), the same on every machine. */
static double noise(uint32_t *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    return (double)(*seed >> 8) / 16777216.0 - 0.5;
}

static void make(size_t rows, size_t n, uint32_t seed, double *a, double *b) {
    for (size_t i = 0; i < rows * n; i++)
        a[i] = noise(&seed);
    for (size_t i = 0; i < rows; i++)
        b[i] = noise(&seed);
}

/* rest = b - a x; returns its length. */
static double find_rest(size_t rows, size_t n, const double *a, const double *b, const double *x,
                        double *rest) {
    double sum = 0.0;
    for (size_t i = 0; i < rows; i++) {
        rest[i] = b[i];
        for (size_t j = 0; j < n; j++)
            rest[i] -= a[j * rows + i] * x[j];
        sum += rest[i] * rest[i];
    }
    return sqrt(sum);
}

START_TEST(closed_form) {
    /* columns (1,0), (0,1), (1,1)/2; b = (1,-1): only the first helps, x = 1, rest (0,-1) */
    const double a[] = {1, 0, 0, 1, 0.5, 0.5}, b[] = {1, -1};
    double x[3], residual;
    ck_assert_int_eq(nnls_solve(2, 3, a, b, 0.0, 3, x, &residual), PALP_OK);
    ck_assert_double_eq_tol(x[0], 1.0, 1e-14);
    ck_assert_double_eq(x[1], 0.0);
    ck_assert_double_eq(x[2], 0.0);
    ck_assert_double_eq_tol(residual, 1.0 / sqrt(2.0), 1e-14);
}
END_TEST

/* Optimal: x >= 0, the gradient a' rest <= 0, and 0 where x > 0. */
START_TEST(kuhn_and_tucker) {
    enum { ROWS = 40, N = 30 };
    static double a[ROWS * N], b[ROWS], x[N], rest[ROWS];
    for (uint32_t seed = 1; seed <= 20; seed++) {
        double residual, size = 0.0;
        size_t above = 0;
        make(ROWS, N, seed, a, b);
        ck_assert_int_eq(nnls_solve(ROWS, N, a, b, 0.0, N, x, &residual), PALP_OK);
        double left = find_rest(ROWS, N, a, b, x, rest);
        for (size_t i = 0; i < ROWS; i++)
            size += b[i] * b[i];
        ck_assert_double_eq_tol(residual, left / sqrt(size), 1e-10);
        for (size_t j = 0; j < N; j++) {
            double gradient = 0.0;
            for (size_t i = 0; i < ROWS; i++)
                gradient += a[j * ROWS + i] * rest[i];
            ck_assert_double_ge(x[j], 0.0);
            ck_assert_double_le(gradient, 1e-10);
            if (x[j] > 0.0)
                ck_assert_double_ge(gradient, -1e-10);
            above += x[j] > 0.0;
        }
        ck_assert_uint_gt(above, 0);
        ck_assert_uint_lt(above, N);
    }
}
END_TEST

/* What was made from few columns is found again, and stops there. */
START_TEST(sparse) {
    enum { ROWS = 60, N = 200, USED = 7 };
    static double a[ROWS * N], b[ROWS], x[N], rest[ROWS];
    double residual;
    make(ROWS, N, 5, a, b);
    for (size_t i = 0; i < ROWS; i++)
        b[i] = 0.0;
    for (size_t k = 0; k < USED; k++)
        for (size_t i = 0; i < ROWS; i++)
            b[i] += (double)(k + 1) * a[29 * k * ROWS + i];
    ck_assert_int_eq(nnls_solve(ROWS, N, a, b, 1e-10, N, x, &residual), PALP_OK);
    ck_assert_double_le(residual, 1e-10);
    for (size_t k = 0; k < USED; k++)
        ck_assert_double_eq_tol(x[29 * k], (double)(k + 1), 1e-8);
    /* early stops */
    ck_assert_int_eq(nnls_solve(ROWS, N, a, b, 0.3, N, x, &residual), PALP_OK);
    ck_assert_double_le(residual, 0.3);
    ck_assert_double_gt(residual, 1e-6);
    ck_assert_int_eq(nnls_solve(ROWS, N, a, b, 1e-10, 3, x, &residual), PALP_OK);
    size_t above = 0;
    for (size_t j = 0; j < N; j++)
        above += x[j] > 0.0;
    ck_assert_uint_eq(above, 3);
    ck_assert_double_gt(find_rest(ROWS, N, a, b, x, rest), 0.0);
}
END_TEST

/* Columns twice, and a column of zeros: no harm. */
START_TEST(dependent_columns) {
    enum { ROWS = 10, N = 12 };
    double a[ROWS * N], b[ROWS], x[N], rest[ROWS], residual;
    make(ROWS, N, 9, a, b);
    for (size_t i = 0; i < ROWS; i++) {
        a[3 * ROWS + i] = 0.0;
        a[7 * ROWS + i] = a[5 * ROWS + i];
        b[i] = a[5 * ROWS + i] + 2.0 * a[8 * ROWS + i];
    }
    ck_assert_int_eq(nnls_solve(ROWS, N, a, b, 1e-12, N, x, &residual), PALP_OK);
    ck_assert_double_le(find_rest(ROWS, N, a, b, x, rest), 1e-10);
    ck_assert_double_eq(x[3], 0.0);
    ck_assert_double_eq_tol(x[5] + x[7], 1.0, 1e-9);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, closed_form);
    tcase_add_test(tc, kuhn_and_tucker);
    tcase_add_test(tc, sparse);
    tcase_add_test(tc, dependent_columns);
}
