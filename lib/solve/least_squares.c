/* least_squares.c: nonlinear least squares by NLopt. */
#include "least_squares.h"
#include "base/arena.h"
#include "base/dense.h"

#include <math.h>
#include <nlopt.h>
#include <string.h>

/* One descent in coordinates y, p = origin + R^-1 y, in which the Levenberg-Marquardt Hessian is the
 * identity: the quasi-Newton method then starts with the Levenberg-Marquardt step. */
typedef struct descent {
    arena memory;
    const least_squares *problem;
    double *origin, *best, *p; /* [n_parameters] */
    double *r, *best_r;        /* [n_residuals] */
    double *jacobian;          /* [n_residuals n_parameters] */
    double *triangle;          /* [n_parameters n_parameters] R' = L, in rows */
    double *best_jacobian, *stacked, *tau, *work, *y;
    double best_value, best_excess, damping;
    double nothing;            /* changes below this are rounding, relative to the first value */
    bool overshot;             /* in the present round */
    size_t evaluations, limit; /* of the present round */
    size_t stalled;            /* evaluations since the best improved by stop_relative */
    palp_status status;
    nlopt_opt optimizer;
} descent;

/* Four partial sums, which the processor adds independently. */
static double squared_vector_norm(const double *v, size_t n) {
    double sum[4] = {0.0, 0.0, 0.0, 0.0};
    size_t i = 0;
    for (; i + 4 <= n; i += 4)
        for (size_t k = 0; k < 4; k++)
            sum[k] += v[i + k] * v[i + k];
    for (; i < n; i++)
        sum[0] += v[i] * v[i];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

static void convert_to_parameters(const descent *d, const double *y, double *p) {
    size_t n = d->problem->n_parameters;
    memcpy(p, y, n * sizeof *p);
    dense_backward(n, d->triangle, 1, p);
    for (size_t k = 0; k < n; k++)
        p[k] += d->origin[k];
}

/* Largest violation of p's constraints beyond rounding, as y mixes all parameters. */
static double largest_constraint_miss(const least_squares *problem, const double *p) {
    size_t n = problem->n_parameters;
    double most = 0.0, largest = 0.0;
    for (size_t k = 0; k < n; k++)
        largest = fmax(largest, fabs(p[k]));
    for (size_t i = 0; i < problem->n_constraints; i++) {
        double miss = problem->floor[i], size = fabs(problem->floor[i]);
        for (size_t k = 0; k < n; k++) {
            miss -= problem->constraint[i * n + k] * p[k];
            size += fabs(problem->constraint[i * n + k]) * largest;
        }
        if (miss > 1e-9 * size)
            most = fmax(most, miss);
    }
    return most;
}

static void swap_array_pointers(double **a, double **b) {
    double *old = *a;
    *a = *b;
    *b = old;
}

/* Makes the present point the best so far. Its residuals and derivatives move out of d->r and d->jacobian. */
static void keep_point_as_best(descent *d, double value, double miss) {
    d->best_value = value;
    d->best_excess = miss;
    memcpy(d->best, d->p, d->problem->n_parameters * sizeof *d->best);
    swap_array_pointers(&d->best_r, &d->r);
    swap_array_pointers(&d->best_jacobian, &d->jacobian);
}

static bool is_at_best_point(const descent *d) {
    return memcmp(d->p, d->best, d->problem->n_parameters * sizeof *d->p) == 0;
}

/* |r|^2 / 2 at d->p. A point with smaller constraint violation or value is kept. A round ends after two
 * evaluations without improvement. */
static double evaluate_residuals_at_point(descent *d) {
    const least_squares *problem = d->problem;
    d->status = problem->evaluate(problem->user, d->p, d->r, d->jacobian);
    d->evaluations++;
    if (d->status) {
        if (d->optimizer)
            nlopt_force_stop(d->optimizer);
        return HUGE_VAL;
    }
    double value = 0.5 * squared_vector_norm(d->r, problem->n_residuals),
           miss = largest_constraint_miss(problem, d->p);
    bool nearer = miss < d->best_excess;
    bool better = isfinite(value) && (nearer || (miss == d->best_excess && value < d->best_value));
    bool much = nearer || value < d->best_value * (1.0 - 2.0 * problem->stop_relative);
    d->stalled = better && much ? 0 : d->stalled + 1;
    d->overshot = d->overshot || miss > d->best_excess ||
                  !(value <= d->best_value * (1.0 + 2.0 * problem->stop_relative));
    if (better)
        keep_point_as_best(d, value, miss);
    if (d->optimizer && (d->stalled >= 2 || d->evaluations == d->limit || d->best_value <= d->nothing))
        nlopt_force_stop(d->optimizer);
    return value;
}

static double half_squares_objective(unsigned n, const double *y, double *gradient, void *user) {
    descent *d = user;
    size_t m = d->problem->n_residuals;
    convert_to_parameters(d, y, d->p);
    double value = is_at_best_point(d)
                       ? d->best_value
                       : evaluate_residuals_at_point(d); /* a round begins at the best point */
    bool best = is_at_best_point(d);
    const double *r = best ? d->best_r : d->r, *jacobian = best ? d->best_jacobian : d->jacobian;
    if (gradient && !d->status) {
        dense_transposed_times(m, n, 1.0, jacobian, r, 0.0, gradient);
        dense_forward(n, d->triangle, 1, gradient);
    }
    return value;
}

/* Constraint values: floor - row . p <= 0. */
static void linear_constraint_misses(unsigned rows, double *result, unsigned n, const double *y,
                                     double *gradient, void *user) {
    descent *d = user;
    const least_squares *problem = d->problem;
    convert_to_parameters(d, y, d->p);
    for (unsigned i = 0; i < rows; i++) {
        const double *row = problem->constraint + (size_t)i * n;
        result[i] = problem->floor[i];
        for (unsigned k = 0; k < n; k++)
            result[i] -= row[k] * d->p[k];
        if (gradient) {
            for (unsigned k = 0; k < n; k++)
                gradient[(size_t)i * n + k] = -row[k];
            dense_forward(n, d->triangle, 1, gradient + (size_t)i * n);
        }
    }
}

static const double LEAST_DAMPING = 1e-6, FELT_DAMPING = 1e-2, MOST_DAMPING = 1e2;

/* R of the best Jacobian with damping in proportion to its columns, which keeps R regular if a parameter has
 * no influence. */
static palp_status whiten_by_best_jacobian(descent *d) {
    size_t n = d->problem->n_parameters, m = d->problem->n_residuals, rows = m + n;
    double largest = 0.0;
    for (size_t k = 0; k < n; k++) {
        d->tau[k] = sqrt(squared_vector_norm(d->best_jacobian + k * m, m));
        largest = fmax(largest, d->tau[k]);
    }
    if (!(largest > 0.0) || !isfinite(largest))
        return PALP_ERR_SINGULAR;
    for (size_t k = 0; k < n; k++) {
        double *column = d->stacked + k * rows, size = d->tau[k];
        memcpy(column, d->best_jacobian + k * m, m * sizeof *column);
        memset(column + m, 0, n * sizeof *column);
        column[m + k] = d->damping * fmax(size, 1e-3 * largest);
    }
    dense_triangle_of(rows, n, d->stacked, d->tau, d->work, d->triangle);
    memcpy(d->origin, d->best, n * sizeof *d->origin);
    return PALP_OK;
}

/* Bounds on p become linear constraints on y. */
static nlopt_result minimize_from_best_point(descent *d) {
    const least_squares *problem = d->problem;
    double value;
    memset(d->y, 0, problem->n_parameters * sizeof *d->y);
    nlopt_opt o = nlopt_create(NLOPT_LD_SLSQP, (unsigned)problem->n_parameters);
    if (!o)
        return NLOPT_OUT_OF_MEMORY;
    nlopt_result result = nlopt_set_min_objective(o, half_squares_objective, d);
    nlopt_set_ftol_rel(o, problem->stop_relative);
    if (problem->n_constraints && result > 0)
        result = nlopt_add_inequality_mconstraint(o, (unsigned)problem->n_constraints,
                                                  linear_constraint_misses, d, NULL);
    d->optimizer = o;
    if (result > 0)
        result = nlopt_optimize(o, d->y, &value);
    d->optimizer = NULL;
    nlopt_destroy(o);
    return result;
}

static palp_status allocate_descent_arrays(descent *d) {
    size_t n = d->problem->n_parameters, m = d->problem->n_residuals;
    double **by_parameter[] = {&d->origin, &d->best, &d->p, &d->tau, &d->y};
    for (size_t i = 0; i < sizeof by_parameter / sizeof *by_parameter; i++)
        *by_parameter[i] = arena_take(&d->memory, n, sizeof(double));
    d->r = arena_take(&d->memory, m, sizeof(double));
    d->best_r = arena_take(&d->memory, m, sizeof(double));
    d->jacobian = arena_take(&d->memory, n * m, sizeof(double));
    d->best_jacobian = arena_take(&d->memory, n * m, sizeof(double));
    d->stacked = arena_take(&d->memory, n * (m + n), sizeof(double));
    d->triangle = arena_take(&d->memory, n * n, sizeof(double));
    d->work = arena_take(&d->memory, DENSE_WORK * n, sizeof(double));
    return d->memory.failed ? PALP_ERR_NO_MEMORY : PALP_OK;
}

static bool is_residual_mere_rounding(const descent *d) {
    return d->best_value <= d->nothing && d->best_excess == 0.0;
}

/* Short descents, each in fresh coordinates, until one brings no improvement. After one that only overshot a
 * shorter one follows. */
static palp_status descend_in_rounds(descent *d, bool *converged) {
    enum { ROUND = 2 }; /* the step, and a second one from its end or along it */
    const least_squares *problem = d->problem;
    while (!*converged && d->evaluations < problem->max_evaluations) {
        size_t left = problem->max_evaluations - d->evaluations;
        double before = d->best_value, missed = d->best_excess;
        d->stalled = 0;
        d->overshot = false;
        d->limit = d->evaluations + (left < ROUND ? left : ROUND);
        palp_status status = whiten_by_best_jacobian(d);
        if (status)
            return status;
        nlopt_result result = minimize_from_best_point(d);
        if (d->status)
            return d->status;
        if (result == NLOPT_OUT_OF_MEMORY)
            return PALP_ERR_NO_MEMORY;
        bool better =
            d->best_excess < missed || before - d->best_value > 2.0 * problem->stop_relative * before;
        bool too_far = d->overshot && d->damping < MOST_DAMPING;
        *converged = is_residual_mere_rounding(d) || (!better && !too_far);
        if (d->overshot != better)
            d->damping =
                better ? fmax(LEAST_DAMPING, 0.1 * d->damping) : fmax(FELT_DAMPING, 100.0 * d->damping);
    }
    return PALP_OK;
}

palp_status least_squares_solve(const least_squares *problem, double *p, double *norm, bool *converged) {
    descent d = {
        .problem = problem, .best_value = HUGE_VAL, .best_excess = HUGE_VAL, .damping = LEAST_DAMPING};
    size_t n = problem->n_parameters;
    palp_status status = allocate_descent_arrays(&d);
    *converged = false;
    if (!status) {
        memcpy(d.p, p, n * sizeof *p);
        evaluate_residuals_at_point(&d);
        status = d.status;
        d.nothing = 1e-24 * d.best_value;
        if (!status)
            status = descend_in_rounds(&d, converged);
        if (d.best_value < HUGE_VAL) {
            memcpy(p, d.best, n * sizeof *p);
            *norm = sqrt(2.0 * d.best_value);
        }
    }
    arena_free(&d.memory);
    return status;
}
