/* test_least_squares.c: the least squares behind calibration on problems with known answers. */
#include "solve/least_squares.h"
#include "cube.h"

#include <string.h>

enum { MOST = 16 };

typedef struct counted {
    size_t calls, fail_at; /* 0 = never */
    size_t n, m;
    double a[MOST * MOST], b[MOST]; /* linear: r = a p - b, a by columns */
} counted;

static palp_status note(counted *c) {
    return ++c->calls == c->fail_at ? PALP_ERR_SINGULAR : PALP_OK;
}

/* Minimum 0 at (1, 1). */
static palp_status rosenbrock(void *user, const double *p, double *r, double *jacobian) {
    r[0] = 10.0 * (p[1] - p[0] * p[0]);
    r[1] = 1.0 - p[0];
    if (jacobian) {
        jacobian[0] = -20.0 * p[0];
        jacobian[1] = -1.0;
        jacobian[2] = 10.0;
        jacobian[3] = 0.0;
    }
    return note(user);
}

static palp_status linear(void *user, const double *p, double *r, double *jacobian) {
    counted *c = user;
    for (size_t i = 0; i < c->m; i++) {
        r[i] = -c->b[i];
        for (size_t k = 0; k < c->n; k++)
            r[i] += c->a[k * c->m + i] * p[k];
    }
    if (jacobian)
        memcpy(jacobian, c->a, c->n * c->m * sizeof *jacobian);
    return note(c);
}

/* From far off the step of Newton goes farther still. */
static palp_status arc_tangent(void *user, const double *p, double *r, double *jacobian) {
    r[0] = atan(p[0]);
    if (jacobian)
        jacobian[0] = 1.0 / (1.0 + p[0] * p[0]);
    return note(user);
}

static palp_status not_a_number(void *user, const double *p, double *r, double *jacobian) {
    (void)p;
    r[0] = r[1] = NAN;
    if (jacobian)
        for (size_t i = 0; i < 4; i++)
            jacobian[i] = NAN;
    return note(user);
}

static least_squares problem_of(size_t n, size_t m,
                                palp_status (*evaluate)(void *, const double *, double *, double *),
                                counted *c) {
    c->n = n;
    c->m = m;
    return (least_squares){.n_parameters = n,
                           .n_residuals = m,
                           .max_evaluations = 200,
                           .stop_relative = 1e-6,
                           .evaluate = evaluate,
                           .user = c};
}

START_TEST(rosenbrock_valley) {
    counted c = {0};
    least_squares problem = problem_of(2, 2, rosenbrock, &c);
    double p[2] = {-1.2, 1.0}, norm;
    bool converged;
    ck_assert_int_eq(least_squares_solve(&problem, p, &norm, &converged), PALP_OK);
    ck_assert_double_eq_tol(p[0], 1.0, 1e-8);
    ck_assert_double_eq_tol(p[1], 1.0, 1e-8);
    ck_assert_double_lt(norm, 1e-8);
    ck_assert(converged);
    ck_assert_uint_le(c.calls, 80);
}
END_TEST

START_TEST(steps_that_go_too_far) {
    for (double far = 2.0; far < 1e4; far *= 3.0) {
        counted c = {0};
        least_squares problem = problem_of(1, 1, arc_tangent, &c);
        double p = far, norm;
        bool converged;
        ck_assert_int_eq(least_squares_solve(&problem, &p, &norm, &converged), PALP_OK);
        ck_assert_double_eq_tol(p, 0.0, 1e-8);
        ck_assert(converged);
    }
}
END_TEST

/* The known answer is met with columns of which the fifth power nearly depends on the others: monomials on
 * [1, 2]. b = a p + w, w across all columns, so the norm at the answer is |w|. */
START_TEST(ill_conditioned_linear) {
    counted c = {0};
    least_squares problem = problem_of(6, 12, linear, &c);
    const double answer[6] = {1.0, -2.0, 3.0, -4.0, 5.0, -6.0};
    double p[6] = {0}, norm, sum = 0.0;
    bool converged;
    for (size_t i = 0; i < 12; i++)
        for (size_t k = 0; k < 6; k++)
            c.a[k * 12 + i] = pow(1.0 + (double)i / 11.0, (double)k);
    for (size_t i = 0; i < 12; i++) {
        /* differences of sixth and higher order see no polynomial of degree five */
        const double difference[7] = {1, -6, 15, -20, 15, -6, 1};
        double w = i < 7 ? 1e-3 * difference[i] : 0.0;
        c.b[i] = w;
        sum += w * w;
        for (size_t k = 0; k < 6; k++)
            c.b[i] += c.a[k * 12 + i] * answer[k];
    }
    problem.stop_relative = 1e-10;
    ck_assert_int_eq(least_squares_solve(&problem, p, &norm, &converged), PALP_OK);
    ck_assert(converged);
    ck_assert_double_eq_tol(norm, sqrt(sum), 1e-9 * sqrt(sum));
    for (size_t k = 0; k < 6; k++)
        ck_assert_double_eq_tol(p[k], answer[k], 1e-3);
}
END_TEST

START_TEST(active_constraints) {
    counted c = {.a = {1, 0, 0, 1}, .b = {1, -1}};
    least_squares problem = problem_of(2, 2, linear, &c);
    const double bounds[4] = {1, 0, 0, 1}, zeros[2] = {0, 0}, line[2] = {-1, -2}, floor = -1.0;
    double p[2] = {0.5, 0.5}, norm;
    bool converged;
    problem.n_constraints = 2;
    problem.constraint = bounds;
    problem.floor = zeros;
    ck_assert_int_eq(least_squares_solve(&problem, p, &norm, &converged), PALP_OK);
    ck_assert_double_eq_tol(p[0], 1.0, 1e-8);
    ck_assert_double_eq_tol(p[1], 0.0, 1e-8);
    ck_assert_double_eq_tol(norm, 1.0, 1e-8);
    ck_assert(converged);
    /* nearest to (1, 1) with x + 2 y <= 1: (1, 1) - 2/5 (1, 2) */
    c.b[1] = 1.0;
    problem.n_constraints = 1;
    problem.constraint = line;
    problem.floor = &floor;
    p[0] = p[1] = 0.0;
    ck_assert_int_eq(least_squares_solve(&problem, p, &norm, &converged), PALP_OK);
    ck_assert_double_eq_tol(p[0], 0.6, 1e-7);
    ck_assert_double_eq_tol(p[1], 0.2, 1e-7);
    ck_assert(converged);
}
END_TEST

/* A first guess outside has the lower residual, but is no answer. */
START_TEST(first_guess_outside) {
    counted c = {.a = {1, 0, 0, 1}, .b = {1, -1}};
    least_squares problem = problem_of(2, 2, linear, &c);
    const double bounds[4] = {1, 0, 0, 1}, zeros[2] = {0, 0};
    double p[2] = {1.0, -0.9}, norm;
    bool converged;
    problem.n_constraints = 2;
    problem.constraint = bounds;
    problem.floor = zeros;
    ck_assert_int_eq(least_squares_solve(&problem, p, &norm, &converged), PALP_OK);
    ck_assert_double_eq_tol(p[0], 1.0, 1e-7);
    ck_assert_double_eq_tol(p[1], 0.0, 1e-7);
    ck_assert_double_eq_tol(norm, 1.0, 1e-7);
}
END_TEST

START_TEST(parameter_without_influence) {
    counted c = {.a = {2, 1, 0, 0, 0, 0, 1, 0, 3}, .b = {4, 2, 3}};
    least_squares problem = problem_of(3, 3, linear, &c);
    double p[3] = {0.0, 7.0, 0.0}, norm;
    bool converged;
    ck_assert_int_eq(least_squares_solve(&problem, p, &norm, &converged), PALP_OK);
    /* normal equations of columns 0 and 2: 5 x + 2 z = 10, 2 x + 10 z = 13 */
    ck_assert_double_eq_tol(p[0], 74.0 / 46.0, 1e-7);
    ck_assert_double_eq_tol(p[1], 7.0, 1e-7);
    ck_assert_double_eq_tol(p[2], 45.0 / 46.0, 1e-7);
    ck_assert(converged);
}
END_TEST

START_TEST(nothing_has_influence) {
    counted c = {.b = {1, 2}};
    least_squares problem = problem_of(2, 2, linear, &c);
    double p[2] = {0.0, 0.0}, norm;
    bool converged;
    ck_assert_int_eq(least_squares_solve(&problem, p, &norm, &converged), PALP_ERR_SINGULAR);
    problem = problem_of(2, 2, not_a_number, &c);
    ck_assert_int_eq(least_squares_solve(&problem, p, &norm, &converged), PALP_ERR_SINGULAR);
}
END_TEST

/* The limit of evaluations is kept, and the result is never worse than the guess. A fit that ran out of
 * evaluations is not reported as converged. */
START_TEST(evaluation_limit) {
    for (size_t limit = 1; limit <= 12; limit++) {
        counted c = {0};
        least_squares problem = problem_of(2, 2, rosenbrock, &c);
        double p[2] = {-1.2, 1.0}, norm = NAN;
        bool converged;
        problem.max_evaluations = limit;
        ck_assert_int_eq(least_squares_solve(&problem, p, &norm, &converged), PALP_OK);
        ck_assert_uint_eq(c.calls, limit); /* the valley takes more */
        ck_assert_double_le(norm, sqrt(4.4 * 4.4 + 2.2 * 2.2) + 1e-12);
        ck_assert(!converged);
    }
}
END_TEST

START_TEST(error_is_passed_on) {
    for (size_t at = 1; at <= 12; at++) {
        counted c = {.fail_at = at};
        least_squares problem = problem_of(2, 2, rosenbrock, &c);
        double p[2] = {-1.2, 1.0}, norm;
        bool converged;
        ck_assert_int_eq(least_squares_solve(&problem, p, &norm, &converged), PALP_ERR_SINGULAR);
        ck_assert_uint_eq(c.calls, at);
        ck_assert(!converged);
    }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, rosenbrock_valley);
    tcase_add_test(tc, steps_that_go_too_far);
    tcase_add_test(tc, ill_conditioned_linear);
    tcase_add_test(tc, active_constraints);
    tcase_add_test(tc, first_guess_outside);
    tcase_add_test(tc, parameter_without_influence);
    tcase_add_test(tc, nothing_has_influence);
    tcase_add_test(tc, evaluation_limit);
    tcase_add_test(tc, error_is_passed_on);
}
