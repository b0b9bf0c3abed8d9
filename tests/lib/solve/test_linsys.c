/* test_linsys.c: the solvers against Gaussian elimination written here and matrices of known inertia. */
#include "solve/linsys.h"

#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A symmetric matrix, dense, and the pattern of its lower triangle that the solvers are told. */
typedef struct matrix {
    size_t n;
    double *a; /* [n n] */
    size_t *column;
    int32_t *row;
} matrix;

static const palp_solver SOLVERS[] = {
    PALP_SOLVER_BAND,
    PALP_SOLVER_SIMPLICIAL,
    PALP_SOLVER_AUTO,
#ifdef PALP_GPL
    PALP_SOLVER_SUPERNODAL,
#endif
};
enum { N_SOLVERS = sizeof SOLVERS / sizeof *SOLVERS };

/* The same numbers on every machine: a 64-bit linear congruential generator (Knuth's MMIX). */
static uint64_t seed;
static double uniform(double low, double high) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(seed >> 11) / 9007199254740992.0;
}

static matrix matrix_make(size_t n, size_t width) {
    matrix m = {n, calloc(n * n + 1, sizeof(double)), malloc((n + 1) * sizeof(size_t)),
                malloc((n * (width + 1) + 1) * sizeof(int32_t))};
    ck_assert(m.a && m.column && m.row);
    return m;
}

static void matrix_free(matrix *m) {
    free(m->a);
    free(m->column);
    free(m->row);
}

/* Pattern: the diagonal and what is not zero below it. */
static void find_pattern(matrix *m) {
    size_t nz = 0;
    for (size_t j = 0; j < m->n; j++) {
        m->column[j] = nz;
        for (size_t i = j; i < m->n; i++)
            if (i == j || m->a[i * m->n + j] != 0.0)
                m->row[nz++] = (int32_t)i;
    }
    m->column[m->n] = nz;
}

/* L D L' with a random unit lower L of the given band and density, and D with the required number of negative
 * pivots. By Sylvester's law its inertia is that of D in any order of elimination. */
static matrix with_inertia(size_t n, size_t width, double share, size_t negative) {
    matrix m = matrix_make(n, width);
    double *lower = calloc(n * n + 1, sizeof *lower), *d = malloc((n + 1) * sizeof *d);
    ck_assert(lower && d);
    double size = 1.5 / (1.0 + sqrt((double)width * share));
    for (size_t i = 0; i < n; i++) {
        lower[i * n + i] = 1.0;
        d[i] = uniform(0.5, 2.0) * ((i + 1) * negative / n != i * negative / n ? -1.0 : 1.0);
        for (size_t j = i > width ? i - width : 0; j < i; j++)
            if (uniform(0.0, 1.0) < share || i - j == width)
                lower[i * n + j] = uniform(-size, size);
    }
    for (size_t i = 0; i < n; i++)
        for (size_t j = i > width ? i - width : 0; j <= i; j++) {
            double sum = 0.0;
            for (size_t k = i > width ? i - width : 0; k <= j; k++)
                sum += lower[i * n + k] * d[k] * lower[j * n + k];
            m.a[i * n + j] = m.a[j * n + i] = sum;
        }
    free(lower);
    free(d);
    find_pattern(&m);
    return m;
}

/* A random sparse pattern far from banded, diagonally dominant with diagonals of either sign: dominance
 * makes the inertia that of the diagonal (Gershgorin). */
static matrix dominant(size_t n, double share, size_t negative) {
    matrix m = matrix_make(n, n);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i; j++)
            if (uniform(0.0, 1.0) < share)
                m.a[i * n + j] = m.a[j * n + i] = uniform(-1.0, 1.0);
    for (size_t i = 0; i < n; i++) {
        double sum = 0.1;
        for (size_t j = 0; j < n; j++)
            sum += j == i ? 0.0 : fabs(m.a[i * n + j]);
        m.a[i * n + i] = (i + 1) * negative / n != i * negative / n ? -sum : sum;
    }
    find_pattern(&m);
    return m;
}

/* Gaussian elimination with row pivoting; a is destroyed, b becomes the solution. */
static void dense_solve(size_t n, double *a, double *b) {
    for (size_t j = 0; j < n; j++) {
        size_t p = j;
        for (size_t i = j + 1; i < n; i++)
            p = fabs(a[i * n + j]) > fabs(a[p * n + j]) ? i : p;
        for (size_t k = 0; k < n; k++) {
            double t = a[j * n + k];
            a[j * n + k] = a[p * n + k];
            a[p * n + k] = t;
        }
        double t = b[j];
        b[j] = b[p];
        b[p] = t;
        for (size_t i = j + 1; i < n; i++) {
            double l = a[i * n + j] / a[j * n + j];
            if (l == 0.0)
                continue;
            for (size_t k = j; k < n; k++)
                a[i * n + k] -= l * a[j * n + k];
            b[i] -= l * b[j];
        }
    }
    for (size_t i = n; i-- > 0;) {
        for (size_t k = i + 1; k < n; k++)
            b[i] -= a[i * n + k] * b[k];
        b[i] /= a[i * n + i];
    }
}

static linsys *create(palp_solver solver, const matrix *m) {
    linsys *ls = NULL;
    ck_assert_int_eq(linsys_create(solver, m->n, m->column, m->row, &ls), PALP_OK);
    return ls;
}

static void fill(linsys *ls, const matrix *m) {
    double *value = linsys_values(ls);
    memset(value, 0, linsys_value_count(ls) * sizeof *value);
    value[linsys_value_count(ls)] = NAN; /* the bin: may hold anything */
    for (size_t j = 0; j < m->n; j++)
        for (size_t k = m->column[j]; k < m->column[j + 1]; k++) {
            size_t slot = linsys_slot(ls, (size_t)m->row[k], j);
            if (slot >= linsys_value_count(ls))
                ck_abort_msg("slot out of range");
            value[slot] = m->a[(size_t)m->row[k] * m->n + j];
        }
}

static double *random_vector(size_t n) {
    double *b = malloc((n + 1) * sizeof *b);
    ck_assert(b != NULL);
    for (size_t i = 0; i < n; i++)
        b[i] = uniform(-1.0, 1.0);
    return b;
}

static double *copy_of(const double *a, size_t n) {
    double *c = malloc((n + 1) * sizeof *c);
    ck_assert(c != NULL);
    memcpy(c, a, n * sizeof *c);
    return c;
}

/* Every solver: the inertia, and the solution to 1e-9 of its largest entry, which allows an elimination
 * without pivoting some 1e6 times the unit of rounding. */
static void check_solvers(const matrix *m, size_t negative, const char *what) {
    double *b = random_vector(m->n), *want = copy_of(b, m->n), *dense = copy_of(m->a, m->n * m->n);
    double largest = 0.0;
    dense_solve(m->n, dense, want);
    for (size_t i = 0; i < m->n; i++)
        largest = fmax(largest, fabs(want[i]));
    for (size_t s = 0; s < N_SOLVERS; s++) {
        linsys *ls = create(SOLVERS[s], m);
        double *x = copy_of(b, m->n);
        int found = -1;
        fill(ls, m);
        ck_assert_msg(!linsys_factor(ls, &found), "%s: solver %d does not factor", what, (int)SOLVERS[s]);
        ck_assert_msg(found == (int)negative, "%s: solver %d finds %d negative pivots of %zu", what,
                      (int)SOLVERS[s], found, negative);
        linsys_solve(ls, x);
        for (size_t i = 0; i < m->n; i++)
            if (!(fabs(x[i] - want[i]) <= 1e-9 * largest))
                ck_abort_msg("%s: solver %d, x[%zu] = %.17g not %.17g", what, (int)SOLVERS[s], i, x[i],
                             want[i]);
        free(x);
        linsys_free(ls);
    }
    free(b);
    free(want);
    free(dense);
}

/* Band widths around the sizes that a block factorization works in, and matrices that end inside one. */
START_TEST(bands_of_every_width) {
    static const size_t width[] = {0,  1,  2,  3,  11, 12, 13, 15,  16,  17,  23,  24,  25, 31, 32,
                                   33, 39, 40, 41, 47, 48, 49, 59,  60,  61,  63,  64,  65, 71, 72,
                                   73, 79, 80, 81, 95, 96, 97, 127, 128, 129, 143, 144, 145};
    seed = 1;
    for (size_t i = 0; i < sizeof width / sizeof *width; i++) {
        size_t n[] = {width[i] + 1, width[i] + 2, width[i] + 37};
        for (size_t k = 0; k < 3; k++) {
            char what[64];
            snprintf(what, sizeof what, "n %zu, width %zu", n[k], width[i]);
            size_t negative = k == 1 ? n[k] / 3 : 0;
            matrix m = with_inertia(n[k], width[i], 0.7, negative);
            check_solvers(&m, negative, what);
            matrix_free(&m);
        }
    }
}
END_TEST

START_TEST(matrices_of_every_size) {
    static const size_t width[] = {5, 44};
    static const size_t n[] = {48, 95, 96, 97, 143, 144, 145, 191, 192, 193};
    seed = 2;
    for (size_t i = 0; i < sizeof width / sizeof *width; i++)
        for (size_t k = 0; k < sizeof n / sizeof *n; k++) {
            char what[64];
            snprintf(what, sizeof what, "n %zu, width %zu", n[k], width[i]);
            matrix m = with_inertia(n[k], width[i], 0.5, k);
            check_solvers(&m, k, what);
            matrix_free(&m);
        }
}
END_TEST

START_TEST(scattered_patterns) {
    static const size_t n[] = {1, 2, 7, 40, 150};
    seed = 3;
    for (size_t k = 0; k < sizeof n / sizeof *n; k++)
        for (size_t negative = 0; negative <= n[k]; negative += n[k] / 2 + 1) {
            char what[64];
            snprintf(what, sizeof what, "n %zu, %zu negative", n[k], negative);
            matrix m = dominant(n[k], 4.0 / (double)n[k], negative);
            check_solvers(&m, negative, what);
            matrix_free(&m);
        }
}
END_TEST

START_TEST(all_negative_and_alternating_signs) {
    seed = 4;
    for (size_t width = 10; width <= 70; width += 60) {
        matrix all = with_inertia(100, width, 0.5, 100), half = with_inertia(101, width, 0.5, 50);
        check_solvers(&all, 100, "all negative");
        check_solvers(&half, 50, "alternating");
        matrix_free(&all);
        matrix_free(&half);
    }
}
END_TEST

/* Scale is no matter: only pivots small beside others are rounding. */
START_TEST(tiny_and_huge_matrices_are_not_singular) {
    static const double scale[] = {1e-200, 1e-30, 1e30, 1e200};
    seed = 5;
    for (size_t s = 0; s < 4; s++)
        for (size_t width = 10; width <= 70; width += 60) {
            matrix m = with_inertia(90, width, 0.5, 7);
            for (size_t i = 0; i < m.n * m.n; i++)
                m.a[i] *= scale[s];
            check_solvers(&m, 7, "scaled");
            matrix_free(&m);
        }
}
END_TEST

static palp_status factor_status(palp_solver solver, const matrix *m) {
    linsys *ls = create(solver, m);
    int negative;
    fill(ls, m);
    palp_status status = linsys_factor(ls, &negative);
    linsys_free(ls);
    return status;
}

static void check_singular(const matrix *m, const char *what) {
    for (size_t s = 0; s < N_SOLVERS; s++)
        ck_assert_msg(factor_status(SOLVERS[s], m) == PALP_ERR_SINGULAR, "%s: solver %d factors it", what,
                      (int)SOLVERS[s]);
}

START_TEST(zero_and_non_finite_pivots_are_singular) {
    static const double bad[] = {0.0, NAN, INFINITY, -INFINITY};
    static const size_t where[] = {0, 33, 69};
    seed = 6;
    for (size_t width = 0; width <= 60; width += 30)
        for (size_t k = 0; k < 4; k++)
            for (size_t w = 0; w < 3; w++) {
                size_t i = where[w];
                matrix m = with_inertia(70, width, 0.5, 0);
                for (size_t j = 0; j < 70; j++)
                    if (m.a[i * 70 + j] != 0.0)
                        m.a[i * 70 + j] = m.a[j * 70 + i] = 0.0;
                m.a[i * 70 + i] = bad[k];
                check_singular(&m, "bad pivot");
                matrix_free(&m);
            }
}
END_TEST

/* A chain of springs that nothing holds: each row sums to nothing, and the last pivot is what rounding
 * leaves of zero. Widened by springs to the neighbours' neighbours. */
START_TEST(free_chain_is_singular) {
    seed = 7;
    for (size_t reach = 1; reach <= 64; reach *= 4) {
        size_t n = 130;
        matrix m = matrix_make(n, reach);
        for (size_t i = 0; i < n; i++)
            for (size_t j = i + 1; j < n && j <= i + reach; j++) {
                double k = uniform(0.1, 3.0);
                m.a[i * n + i] += k;
                m.a[j * n + j] += k;
                m.a[i * n + j] = m.a[j * n + i] = -k;
            }
        find_pattern(&m);
        check_singular(&m, "free chain");
        m.a[0] += 1e-2; /* held, if softly: sound again */
        check_solvers(&m, 0, "held chain");
        matrix_free(&m);
    }
}
END_TEST

/* Factors destroy the values: filled again they give the same bits, whatever came between. */
START_TEST(factoring_again_gives_the_same_bits) {
    seed = 8;
    for (size_t width = 20; width <= 100; width += 80) {
        matrix m = with_inertia(150, width, 0.5, 11), other = m;
        double *b = random_vector(m.n), *first = copy_of(b, m.n);
        other.a = copy_of(m.a, m.n * m.n);
        for (size_t i = 0; i < m.n; i++)
            other.a[i * m.n + i] = 0.0; /* singular or at least quite another matrix */
        for (size_t s = 0; s < N_SOLVERS; s++) {
            linsys *ls = create(SOLVERS[s], &m);
            int negative;
            memcpy(first, b, m.n * sizeof *b);
            fill(ls, &m);
            ck_assert_int_eq(linsys_factor(ls, &negative), PALP_OK);
            linsys_solve(ls, first);
            for (int again = 0; again < 2; again++) {
                double *x = copy_of(b, m.n);
                if (again) {
                    fill(ls, &other);
                    linsys_factor(ls, &negative);
                }
                fill(ls, &m);
                ck_assert_int_eq(linsys_factor(ls, &negative), PALP_OK);
                ck_assert_int_eq(negative, 11);
                linsys_solve(ls, x);
                ck_assert_mem_eq(x, first, m.n * sizeof *x);
                free(x);
            }
            linsys_free(ls);
        }
        free(other.a);
        free(b);
        free(first);
        matrix_free(&m);
    }
}
END_TEST

START_TEST(no_unknowns_at_all) {
    size_t column[1] = {0};
    int32_t row[1] = {0};
    for (size_t s = 0; s < N_SOLVERS; s++) {
        linsys *ls;
        int negative = -1;
        ck_assert_int_eq(linsys_create(SOLVERS[s], 0, column, row, &ls), PALP_OK);
        ck_assert_int_eq(linsys_factor(ls, &negative), PALP_OK);
        ck_assert_int_eq(negative, 0);
        linsys_solve(ls, &(double){1.0});
        linsys_free(ls);
    }
}
END_TEST

#ifndef PALP_GPL
START_TEST(supernodal_needs_the_gpl_build) {
    size_t column[2] = {0, 1};
    int32_t row[1] = {0};
    linsys *ls = NULL;
    ck_assert_int_eq(linsys_create(PALP_SOLVER_SUPERNODAL, 1, column, row, &ls), PALP_ERR_UNSUPPORTED);
}
END_TEST
#endif

void tests(TCase *tc) {
    tcase_add_test(tc, bands_of_every_width);
    tcase_add_test(tc, matrices_of_every_size);
    tcase_add_test(tc, scattered_patterns);
    tcase_add_test(tc, all_negative_and_alternating_signs);
    tcase_add_test(tc, tiny_and_huge_matrices_are_not_singular);
    tcase_add_test(tc, zero_and_non_finite_pivots_are_singular);
    tcase_add_test(tc, free_chain_is_singular);
    tcase_add_test(tc, factoring_again_gives_the_same_bits);
    tcase_add_test(tc, no_unknowns_at_all);
#ifndef PALP_GPL
    tcase_add_test(tc, supernodal_needs_the_gpl_build);
#endif
}
