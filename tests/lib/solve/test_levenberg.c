/* test_levenberg.c: Levenberg and Marquardt on problems with known answers. */
#include "solve/levenberg.h"

#include <check.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { MOST = 8, N_MAX = 3 };

/* Residuals and their Jacobian by rows [m n]; false: x is no solution. */
typedef struct model {
    size_t n, m;
    bool (*residuals)(const double *x, double *r, double *jacobian);
    size_t calls, kept, fail_at; /* fail_at: the call that finds no memory, 0 = none */
    double at[N_MAX], best[N_MAX];
} model;

static palp_status evaluate(void *user, const double *x, double *h, double *g, double *chi2) {
    model *f = user;
    double r[MOST], jacobian[MOST * N_MAX];
    memcpy(f->at, x, f->n * sizeof *x);
    if (++f->calls == f->fail_at)
        return PALP_ERR_NO_MEMORY;
    if (!f->residuals(x, r, jacobian))
        return PALP_ERR_NOT_CONVERGED;
    *chi2 = 0.0;
    memset(g, 0, f->n * sizeof *g);
    memset(h, 0, f->n * f->n * sizeof *h);
    for (size_t i = 0; i < f->m; i++) {
        *chi2 += r[i] * r[i];
        for (size_t a = 0; a < f->n; a++) {
            g[a] -= jacobian[i * f->n + a] * r[i];
            for (size_t b = 0; b < f->n; b++)
                h[a * f->n + b] += jacobian[i * f->n + a] * jacobian[i * f->n + b];
        }
    }
    return PALP_OK;
}

static void keep(void *user) {
    model *f = user;
    f->kept++;
    memcpy(f->best, f->at, sizeof f->best);
}

static const double free_low[N_MAX] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL},
                    free_high[N_MAX] = {HUGE_VAL, HUGE_VAL, HUGE_VAL};

static palp_status solve(model *f, const double *low, const double *high, const double *reach,
                         size_t evaluations, double *x, double *chi2) {
    double h[N_MAX * N_MAX], g[N_MAX];
    levenberg problem = {.n = f->n,
                         .evaluations = evaluations,
                         .low = low,
                         .high = high,
                         .reach = reach,
                         .stop_relative = 1e-14,
                         .evaluate = evaluate,
                         .keep = keep,
                         .user = f};
    palp_status status = evaluate(f, x, h, g, chi2);
    if (!status)
        status = levenberg_solve(&problem, x, h, g, chi2);
    return status;
}

/* Columns (1,1,1,1) and (0,1,2,3) to (1,3,4,6): the line 1.1 + 1.6 t, chi2 0.2. */
static bool line(const double *x, double *r, double *jacobian) {
    static const double y[4] = {1, 3, 4, 6};
    for (size_t i = 0; i < 4; i++) {
        r[i] = x[0] + x[1] * (double)i - y[i];
        jacobian[2 * i] = 1.0;
        jacobian[2 * i + 1] = (double)i;
    }
    return true;
}

START_TEST(a_line_by_its_normal_equations) {
    model f = {.n = 2, .m = 4, .residuals = line};
    double x[2] = {-5, 7}, chi2;
    ck_assert_int_eq(solve(&f, free_low, free_high, free_high, 20, x, &chi2), PALP_OK);
    ck_assert_double_eq_tol(x[0], 1.1, 1e-9);
    ck_assert_double_eq_tol(x[1], 1.6, 1e-9);
    ck_assert_double_eq_tol(chi2, 0.2, 1e-12);
    ck_assert_uint_le(f.calls, 6);
}
END_TEST

/* With x1 <= 1 the best x0 is the mean of y - t: 2. */
START_TEST(a_bound_holds_and_the_others_move_beside_it) {
    const double high[2] = {HUGE_VAL, 1};
    model f = {.n = 2, .m = 4, .residuals = line};
    double x[2] = {-5, 0}, chi2;
    ck_assert_int_eq(solve(&f, free_low, high, free_high, 30, x, &chi2), PALP_OK);
    ck_assert_double_eq(x[1], 1.0);
    ck_assert_double_eq_tol(x[0], 2.0, 1e-9);
    ck_assert_double_eq_tol(chi2, 2.0, 1e-9);
    const double low[2] = {-HUGE_VAL, 2};
    x[1] = 9;
    ck_assert_int_eq(solve(&f, low, free_high, free_high, 30, x, &chi2), PALP_OK);
    ck_assert_double_eq(x[1], 2.0);
    ck_assert_double_eq_tol(x[0], 0.5, 1e-9);
}
END_TEST

/* One step of (h + damping diag h) step = g. */
START_TEST(the_step_is_damped_by_the_diagonal) {
    const double x[2] = {0, 0}, h[4] = {4, 2, 2, 3}, g[2] = {1, 2};
    double work[4], step[2];
    levenberg_step(2, x, free_low, free_high, h, g, 0.5, work, step);
    ck_assert_double_eq_tol(6 * step[0] + 2 * step[1], 1.0, 1e-14);
    ck_assert_double_eq_tol(2 * step[0] + 4.5 * step[1], 2.0, 1e-14);
    const double low[2] = {-1, 0}, down[2] = {1, -2};
    levenberg_step(2, x, low, free_high, h, down, 0.5, work, step);
    ck_assert_double_eq_tol(step[0], 1.0 / 6.0, 1e-15);
    ck_assert_double_eq(step[1], 0.0);
    const double singular[4] = {1, 2, 2, 1};
    levenberg_step(2, x, free_low, free_high, singular, g, 0.0, work, step);
    ck_assert_double_eq(step[0], 0.0);
    ck_assert_double_eq(step[1], 0.0);
}
END_TEST

/* 3 exp(-t / 2) + 1 at 8 times, exactly; where the time is not positive there is no solution. */
static bool decay(const double *x, double *r, double *jacobian) {
    if (!(x[1] > 0.0))
        return false;
    for (size_t i = 0; i < 8; i++) {
        double t = 0.5 * (double)i, e = exp(-t / x[1]);
        r[i] = x[0] * e + x[2] - (3.0 * exp(-t / 2.0) + 1.0);
        jacobian[3 * i] = e;
        jacobian[3 * i + 1] = x[0] * e * t / (x[1] * x[1]);
        jacobian[3 * i + 2] = 1.0;
    }
    return true;
}

START_TEST(a_decay_is_found_around_where_it_has_no_solution) {
    model f = {.n = 3, .m = 8, .residuals = decay};
    double x[3] = {1.0, 0.2, 0.0}, chi2;
    ck_assert_int_eq(solve(&f, free_low, free_high, free_high, 200, x, &chi2), PALP_OK);
    ck_assert_double_eq_tol(x[0], 3.0, 1e-7);
    ck_assert_double_eq_tol(x[1], 2.0, 1e-7);
    ck_assert_double_eq_tol(x[2], 1.0, 1e-7);
    ck_assert_double_lt(chi2, 1e-14);
    ck_assert_mem_eq(f.best, x, sizeof x);  /* what was kept last is what is returned */
    ck_assert_uint_lt(f.kept + 1, f.calls); /* some were not */
}
END_TEST

static bool arc_tangent(const double *x, double *r, double *jacobian) {
    r[0] = atan(x[0]);
    jacobian[0] = 1.0 / (1.0 + x[0] * x[0]);
    return true;
}

/* From far off Newton's step goes farther still: damping, or a short reach, brings it back. */
START_TEST(steps_that_go_too_far) {
    const double reach = 1.0;
    for (double far = 2.0; far < 1e3; far *= 3.0) {
        model f = {.n = 1, .m = 1, .residuals = arc_tangent};
        double x = far, chi2;
        ck_assert_int_eq(solve(&f, free_low, free_high, free_high, 200, &x, &chi2), PALP_OK);
        ck_assert_double_eq_tol(x, 0.0, 1e-6);
    }
    model f = {.n = 1, .m = 1, .residuals = arc_tangent};
    double x = 10.25, chi2;
    ck_assert_int_eq(solve(&f, free_low, free_high, &reach, 10, &x, &chi2), PALP_OK);
    ck_assert_double_eq_tol(x, 0.25, 1e-12); /* ten steps of one */
    ck_assert_uint_eq(f.kept, 10);
}
END_TEST

START_TEST(want_of_memory_ends_it) {
    for (size_t at = 2; at < 6; at++) {
        model f = {.n = 3, .m = 8, .residuals = decay, .fail_at = at};
        double x[3] = {2.0, 1.5, 0.7}, chi2;
        ck_assert_int_eq(solve(&f, free_low, free_high, free_high, 200, x, &chi2), PALP_ERR_NO_MEMORY);
        ck_assert_uint_eq(f.calls, at);
    }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, a_line_by_its_normal_equations);
    tcase_add_test(tc, a_bound_holds_and_the_others_move_beside_it);
    tcase_add_test(tc, the_step_is_damped_by_the_diagonal);
    tcase_add_test(tc, a_decay_is_found_around_where_it_has_no_solution);
    tcase_add_test(tc, steps_that_go_too_far);
    tcase_add_test(tc, want_of_memory_ends_it);
}
