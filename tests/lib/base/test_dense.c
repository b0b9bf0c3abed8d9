/* test_dense.c: dense factorizations, by what they must give back. */
#include "base/dense.h"

#include <check.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { N = 7, M = 12, COUNT = 3 };

/* In (-0.5, 0.5), the same on every machine. */
static double noise(uint32_t *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    return (double)(*seed >> 8) / 16777216.0 - 0.5;
}

static void fill(size_t n, double *a) {
    uint32_t seed = 7;
    for (size_t i = 0; i < n; i++)
        a[i] = noise(&seed);
}

/* Symmetric, with this on its diagonal beside numbers within a half. */
static void make_symmetric(double diagonal, double a[N * N]) {
    fill(N * N, a);
    for (size_t i = 0; i < N; i++) {
        for (size_t j = 0; j < i; j++)
            a[j * N + i] = a[i * N + j];
        a[i * N + i] += i % 2 ? fabs(diagonal) : diagonal;
    }
}

/* Largest |A X - B|. */
static double misfit(const double a[N * N], const double *x, const double *b) {
    double worst = 0.0;
    for (size_t c = 0; c < COUNT; c++)
        for (size_t i = 0; i < N; i++) {
            double sum = -b[c * N + i];
            for (size_t j = 0; j < N; j++)
                sum += a[i * N + j] * x[c * N + j];
            worst = fmax(worst, fabs(sum));
        }
    return worst;
}

static void spoil_above(double a[N * N]) {
    for (size_t i = 0; i < N; i++)
        for (size_t j = i + 1; j < N; j++)
            a[i * N + j] = NAN;
}

START_TEST(cholesky_gives_back_the_matrix_and_its_solution) {
    double a[N * N], l[N * N], b[N * COUNT], x[N * COUNT], sum = 0.0;
    make_symmetric(4.0, a);
    memcpy(l, a, sizeof l);
    spoil_above(l);
    fill(N * COUNT, b);
    memcpy(x, b, sizeof x);
    ck_assert(dense_cholesky(N, l));
    for (size_t i = 0; i < N; i++)
        for (size_t j = 0; j <= i; j++)
            ck_assert_double_eq_tol(dense_dot(j + 1, l + i * N, l + j * N), a[i * N + j], 1e-14);
    dense_cholesky_solve(N, l, COUNT, x);
    ck_assert_double_lt(misfit(a, x, b), 1e-14);
    for (size_t i = 0; i < N; i++)
        sum += log(l[i * N + i]);
    ck_assert_double_eq_tol(dense_log_determinant(N, l), 2.0 * sum, 1e-14);
}
END_TEST

START_TEST(the_two_halves_of_a_solution) {
    double l[N * N], x[N] = {1, -2, 3, -4, 5, -6, 7}, b[N] = {0}, c[N] = {0};
    make_symmetric(4.0, l);
    for (size_t i = 0; i < N; i++)
        for (size_t j = 0; j <= i; j++) {
            b[i] += l[i * N + j] * x[j];
            c[j] += l[i * N + j] * x[i];
        }
    spoil_above(l);
    dense_forward(N, l, 1, b);
    dense_backward(N, l, 1, c);
    for (size_t i = 0; i < N; i++) {
        ck_assert_double_eq_tol(b[i], x[i], 1e-13);
        ck_assert_double_eq_tol(c[i], x[i], 1e-13);
    }
}
END_TEST

START_TEST(an_indefinite_matrix_has_no_cholesky_but_an_ldl) {
    double a[N * N], f[N * N], b[N * COUNT], x[N * COUNT], work[DENSE_WORK * N];
    int pivot[N];
    make_symmetric(-4.0, a);
    memcpy(f, a, sizeof f);
    ck_assert(!dense_cholesky(N, f));
    memcpy(f, a, sizeof f);
    spoil_above(f);
    fill(N * COUNT, b);
    memcpy(x, b, sizeof x);
    ck_assert(dense_ldl(N, f, pivot, work));
    dense_ldl_solve(N, f, pivot, COUNT, x);
    ck_assert_double_lt(misfit(a, x, b), 1e-13);
    memset(f, 0, sizeof f);
    ck_assert(!dense_ldl(N, f, pivot, work));
}
END_TEST

START_TEST(the_triangle_of_a_squares_to_its_gram_matrix) {
    double a[M * N], kept[M * N], l[N * N], gram[N * N], tau[N], work[DENSE_WORK * N];
    fill(M * N, a);
    memcpy(kept, a, sizeof kept);
    dense_triangle_of(M, N, a, tau, work, l);
    dense_transposed_product(N, N, M, kept, kept, gram);
    for (size_t i = 0; i < N; i++)
        for (size_t j = 0; j < N; j++) {
            ck_assert_double_eq_tol(dense_dot(N, l + i * N, l + j * N), gram[i * N + j], 1e-14);
            ck_assert(j <= i || l[i * N + j] == 0.0);
        }
}
END_TEST

START_TEST(products_against_sums) {
    double a[M * N], b[N * COUNT], c[M * COUNT], outer[M * N], x[M], y[M], z[N];
    fill(M * N, a);
    fill(N * COUNT, b);
    fill(M, x);
    dense_product(M, COUNT, N, a, b, c);
    memcpy(y, x, sizeof y);
    dense_times(M, N, 2.0, a, b, 3.0, y);
    dense_transposed_times(M, N, 2.0, a, x, 0.0, z);
    for (size_t i = 0; i < M; i++) {
        double row[N];
        for (size_t j = 0; j < N; j++)
            row[j] = a[i + j * M];
        for (size_t k = 0; k < COUNT; k++)
            ck_assert_double_eq_tol(c[i + k * M], dense_dot(N, row, b + k * N), 1e-14);
        ck_assert_double_eq_tol(y[i], 2.0 * dense_dot(N, row, b) + 3.0 * x[i], 1e-14);
    }
    memcpy(outer, a, sizeof outer);
    dense_add_outer(M, N, COUNT, -1.0, c, M, b, N, outer, M);
    for (size_t j = 0; j < N; j++) {
        ck_assert_double_eq_tol(z[j], 2.0 * dense_dot(M, a + j * M, x), 1e-14);
        for (size_t i = 0; i < M; i++) {
            double sum = a[i + j * M];
            for (size_t k = 0; k < COUNT; k++)
                sum -= c[i + k * M] * b[j + k * N];
            ck_assert_double_eq_tol(outer[i + j * M], sum, 1e-14);
        }
    }
}
END_TEST

START_TEST(a_sum_of_nothing) {
    double y[2] = {1.0, 2.0};
    dense_times(2, 0, 1.0, NULL, NULL, 3.0, y);
    ck_assert(y[0] == 3.0 && y[1] == 6.0);
    dense_transposed_times(0, 2, 1.0, NULL, NULL, 0.0, y);
    ck_assert(y[0] == 0.0 && y[1] == 0.0);
}
END_TEST

START_TEST(eigenvectors_of_a_symmetric_matrix) {
    double a[N * N], v[N * N], w[N];
    make_symmetric(-4.0, a);
    memcpy(v, a, sizeof v);
    ck_assert_int_eq(dense_eigen(N, v, w), PALP_OK);
    for (size_t k = 0; k < N; k++) {
        ck_assert(k == 0 || w[k] >= w[k - 1]);
        for (size_t j = 0; j < N; j++)
            ck_assert_double_eq_tol(dense_dot(N, v + k * N, v + j * N), k == j, 1e-14);
        for (size_t i = 0; i < N; i++)
            ck_assert_double_eq_tol(dense_dot(N, a + i * N, v + k * N), w[k] * v[k * N + i], 1e-13);
    }
}
END_TEST

START_TEST(a_polynomial_comes_back_and_a_misfit_is_measured) {
    double x[M], y[M], c[3], norm;
    for (size_t i = 0; i < M; i++) {
        x[i] = 0.03 * (double)i - 0.1;
        y[i] = 2.0 * x[i] - 5.0 * x[i] * x[i] + 40.0 * pow(x[i], 3.0);
    }
    ck_assert_int_eq(dense_polynomial(M, x, y, 1, 3, c, &norm), PALP_OK);
    ck_assert_double_eq_tol(c[0], 2.0, 1e-12);
    ck_assert_double_eq_tol(c[1], -5.0, 1e-11);
    ck_assert_double_eq_tol(c[2], 40.0, 1e-10);
    ck_assert_double_lt(norm, 1e-13);
    double level[2] = {1.0, 3.0}, at[2] = {4.0, 5.0};
    ck_assert_int_eq(dense_polynomial(2, at, level, 0, 0, c, &norm), PALP_OK);
    ck_assert_double_eq_tol(c[0], 2.0, 1e-14);
    ck_assert_double_eq_tol(norm, sqrt(2.0), 1e-14);
    ck_assert_int_eq(dense_polynomial(2, at, level, 0, 2, c, &norm), PALP_ERR_INPUT);
    at[0] = at[1] = 0.0;
    ck_assert_int_eq(dense_polynomial(2, at, level, 0, 0, c, &norm), PALP_ERR_INPUT);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, cholesky_gives_back_the_matrix_and_its_solution);
    tcase_add_test(tc, the_two_halves_of_a_solution);
    tcase_add_test(tc, an_indefinite_matrix_has_no_cholesky_but_an_ldl);
    tcase_add_test(tc, the_triangle_of_a_squares_to_its_gram_matrix);
    tcase_add_test(tc, products_against_sums);
    tcase_add_test(tc, a_sum_of_nothing);
    tcase_add_test(tc, eigenvectors_of_a_symmetric_matrix);
    tcase_add_test(tc, a_polynomial_comes_back_and_a_misfit_is_measured);
}
