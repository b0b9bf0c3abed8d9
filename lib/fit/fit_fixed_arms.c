/* fit_fixed_arms.c: arms at fixed times, even in log, with the spectrum of a fractional element. */
#include "base/dense.h"
#include "fit_internal.h"
#include "solve/least_squares.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* ---- normal equations ---- */

typedef struct normal {
    size_t springs, n; /* columns: the spring's, all */
    double *gram, *right, total;
} normal;

static palp_status normal_make(const fit_problem *p, normal *e) {
    e->springs = fit_spring_columns(p);
    e->n = e->springs + p->n_times;
    e->gram = calloc(e->n * e->n + e->n, sizeof *e->gram);
    if (!e->gram)
        return PALP_ERR_NO_MEMORY;
    e->right = e->gram + e->n * e->n;
    palp_status status = fit_normal_equations(p, p->n_times, p->time, e->gram, e->right, &e->total);
    for (size_t a = 0; a < e->n; a++)
        for (size_t b = 0; b < a; b++)
            e->gram[b * e->n + a] = e->gram[a * e->n + b];
    return status;
}

/* ---- a fractional element ---- */

/* The spectrum of an element of unit stiffness by the logarithm of the time, log x from that of the element.
 */
static double density(double a, double log_x) {
    return sin(PI * a) / (2.0 * PI * (cosh(a * log_x) + cos(PI * a)));
}

/* Arms of the trapezoidal rule, a step apart, which for smooth spectra is exact but for exp(-pi^2 / step).
 * All arms from one on to ever slower or faster times count as one arm of *size, with the log of its time.
 * Slow ones are joined by their mean rate, fast ones by their viscosity. */
static double tail(const double *theta, double log_time, double step, double *size) {
    enum { ARMS = 1000 };
    double sum = 0.0;
    *size = 0.0;
    for (int i = 0; i < ARMS; i++) {
        double own = fabs(step) * density(theta[2], log_time + i * step - theta[1]);
        *size += own;
        sum += own * exp(-i * fabs(step));
        if (own < 1e-9 * *size)
            break;
    }
    return log_time + (step > 0.0 ? -log(sum / *size) : log(sum / *size));
}

/* log K_j and log tau_j of the arms in turn; theta: log K, log tau, a. The last ones include all beyond. */
static void spread(const fit_problem *p, const double *theta, double *arm) {
    double step = log(p->time[1] / p->time[0]), size;
    size_t last = p->n_times - 1;
    for (size_t j = 0; j <= last; j++) {
        double at = log(p->time[j]);
        size = step * density(theta[2], at - theta[1]);
        if (j == 0 || j == last)
            at = tail(theta, at, j == 0 ? -step : step, &size);
        arm[2 * j] = theta[0] + log(fmax(size, 1e-15));
        arm[2 * j + 1] = at;
    }
}

/* The parameters of springs and theta, and the derivatives p->reduced. */
static void place(const fit_problem *p, const double *springs, const double *theta, double *v) {
    const double step[3] = {1e-3, 1e-4, 1e-5};
    double up[2 * PALP_ARMS_MAX], down[2 * PALP_ARMS_MAX];
    size_t n = fit_parameter_count(p), ns = p->n_springs;
    memcpy(v, springs, ns * sizeof *v);
    spread(p, theta, v + ns);
    for (size_t k = 0; k < 3; k++) {
        double moved[3] = {theta[0], theta[1], theta[2]};
        moved[k] = theta[k] + step[k];
        spread(p, moved, up);
        moved[k] = theta[k] - step[k];
        spread(p, moved, down);
        for (size_t i = 0; i < 2 * p->n_arms; i++)
            p->reduced[(ns + k) * n + ns + i] = (up[i] - down[i]) / (2.0 * step[k]);
    }
    for (size_t k = 0; k < ns; k++)
        p->reduced[k * n + k] = 1.0;
}

/* Springs in their units, then theta. */
typedef struct fractional {
    const fit_problem *problem;
    double unit[FIT_PARAMETERS_MAX], springs[FIT_PARAMETERS_MAX], *v, *jacobian; /* [n_blocks n_parameters] */
    double origin;                                                               /* of log K */
} fractional;

static void take(fractional *f, const double *u, double *theta) {
    size_t ns = f->problem->n_springs;
    for (size_t k = 0; k < ns; k++)
        f->springs[k] = u[k] * f->unit[k];
    theta[0] = u[ns] + f->origin;
    theta[1] = u[ns + 1] + log(f->problem->tau_max);
    theta[2] = u[ns + 2];
}

static palp_status evaluate(void *user, const double *u, double *residual, double *jacobian) {
    fractional *f = user;
    const fit_problem *p = f->problem;
    double theta[3];
    size_t m = p->n_blocks, n = fit_parameter_count(p);
    take(f, u, theta);
    place(p, f->springs, theta, f->v);
    palp_status status = fit_evaluate(p, f->v, residual, jacobian ? f->jacobian : NULL);
    if (!jacobian || status)
        return status;
    dense_product(m, p->n_reduced, n, f->jacobian, p->reduced, jacobian);
    for (size_t k = 0; k < p->n_springs; k++)
        for (size_t i = 0; i < m; i++)
            jacobian[k * m + i] *= f->unit[k];
    return status;
}

/* Residual of a fit with this time and exponent, with springs and stiffness by least squares; HUGE_VAL if a
 * stiffness is negative. */
static double try_start(const fit_problem *p, const normal *e, double *theta, double *solution) {
    size_t n = e->springs + 1;
    double weight[2 * PALP_ARMS_MAX], l[(PALP_LAW_MAX + 1) * (PALP_LAW_MAX + 1)];
    theta[0] = 0.0;
    spread(p, theta, weight);
    for (size_t a = 0; a < n; a++) {
        solution[a] = 0.0;
        for (size_t b = 0; b <= a; b++)
            l[a * n + b] = 0.0;
        for (size_t i = 0; i < (a < e->springs ? 1 : p->n_times); i++) {
            size_t row = a + i;
            double of = a < e->springs ? 1.0 : exp(weight[2 * i]);
            solution[a] += of * e->right[row];
            for (size_t b = 0; b <= a; b++)
                for (size_t k = 0; k < (b < e->springs ? 1 : p->n_times); k++)
                    l[a * n + b] +=
                        of * (b < e->springs ? 1.0 : exp(weight[2 * k])) * e->gram[row * e->n + b + k];
        }
        l[a * n + a] *= 1.0 + 1e-12;
    }
    if (!dense_cholesky(n, l))
        return HUGE_VAL;
    dense_forward(n, l, 1, solution);
    double left = e->total - dense_dot(n, solution, solution);
    dense_backward(n, l, 1, solution);
    theta[0] = log(fmax(solution[e->springs], 1e-300));
    return solution[e->springs] > 0.0 ? left : HUGE_VAL;
}

/* The best of some times and exponents. */
static palp_status start(const fit_problem *p, const normal *e, double *v, double *theta) {
    enum { START_TIMES = 8, EXPONENTS = 9 };
    double best = HUGE_VAL, solution[PALP_LAW_MAX + 1];
    for (size_t i = 0; i < START_TIMES; i++)
        for (size_t k = 1; k <= EXPONENTS; k++) {
            double at[3] = {0.0,
                            log(p->tau_min) + log(p->tau_max / p->tau_min) * (double)i / (START_TIMES - 1),
                            0.1 * (double)k};
            double left = try_start(p, e, at, solution);
            if (left >= best)
                continue;
            best = left;
            memcpy(theta, at, sizeof at);
            fit_springs_of(p, solution, v);
        }
    return isfinite(best) ? PALP_OK : PALP_ERR_SINGULAR;
}

enum { STRAINS = 40, ROWS = 6 + STRAINS };

/* log tau within a thousand times the times, the exponent within 0.02 to 0.98, log K not below a millionth of
 * the stiffness; K(e) > 0 at some strains, since a slow element acts as a spring and reduces the law's. unit:
 * of the springs. */
static size_t bound(const fit_problem *p, const double *unit, double *row, double *floor) {
    size_t n = p->n_reduced, k = p->n_springs;
    const double span = log(p->tau_max / p->tau_min) + log(1e3);
    const double low[3] = {log(1e-6), -span, 0.02}, high[3] = {log(1e6), log(1e3), 0.98};
    for (size_t i = 0; i < 3; i++) {
        row[2 * i * n + k + i] = 1.0;
        floor[2 * i] = low[i];
        row[(2 * i + 1) * n + k + i] = -1.0;
        floor[2 * i + 1] = -high[i];
    }
    bool linear = fit_spring_columns(p) == p->n_springs && p->law.kind != PALP_LAW_SPLINE;
    for (size_t i = 0; i < STRAINS && linear; i++) {
        double e = p->strain_max * fmax((double)i, 1e-6) / (STRAINS - 1), by[PALP_LAW_MAX];
        palp_law_gradient(&p->law, e, by);
        for (size_t j = 0; j < k; j++)
            row[(6 + i) * n + j] = by[j] * unit[j] / (e * p->stiffness);
        floor[6 + i] = 1e-3;
    }
    return linear ? ROWS : 6;
}

static palp_status solve_fractional(fit_problem *p, const normal *e, double *v, double *theta,
                                    bool *converged) {
    size_t n = fit_parameter_count(p), q = p->n_springs + 3, ns = p->n_springs;
    fractional f = {.problem = p, .v = v, .origin = log(p->stiffness)};
    arena memory = {0};
    double *u = arena_take(&memory, q, sizeof *u), *row = arena_take(&memory, ROWS * q, sizeof *u),
           floor[ROWS], norm;
    f.jacobian = arena_take(&memory, p->n_blocks * n, sizeof *u);
    p->n_reduced = q;
    p->reduced = arena_take(&p->memory, n * q, sizeof *p->reduced);
    palp_status status = memory.failed || !p->reduced ? PALP_ERR_NO_MEMORY : start(p, e, v, theta);
    for (size_t k = 0; k < ns && !status; k++) {
        bool exponent = p->law.kind == PALP_LAW_OGDEN && k % 2 == 1;
        f.unit[k] = exponent ? 1.0 : p->law.area_m2 > 0.0 ? p->stiffness / p->law.area_m2 : p->stiffness;
        u[k] = v[k] / f.unit[k];
    }
    if (!status) {
        u[ns] = theta[0] - f.origin;
        u[ns + 1] = theta[1] - log(p->tau_max);
        u[ns + 2] = theta[2];
        least_squares problem = {.n_parameters = q,
                                 .n_residuals = p->n_blocks,
                                 .max_evaluations = 10 * p->settings->max_evaluations,
                                 .stop_relative = 1e-7,
                                 .evaluate = evaluate,
                                 .user = &f,
                                 .constraint = row,
                                 .floor = floor};
        problem.n_constraints = bound(p, f.unit, row, floor);
        status = least_squares_solve(&problem, u, &norm, converged);
    }
    if (!status) {
        take(&f, u, theta);
        place(p, f.springs, theta, v);
    }
    arena_free(&memory);
    return status;
}

palp_status fit_solve_spectrum(fit_problem *p, double *v, double *theta, bool *converged) {
    normal e = {.gram = NULL};
    palp_status status = normal_make(p, &e);
    *converged = true;
    if (!status)
        status = solve_fractional(p, &e, v, theta, converged);
    free(e.gram);
    return status;
}

/* ---- estimates ---- */

/* Covariance of springs and theta from that of all parameters: by the left inverse of p->reduced. */
static palp_status covariance_of(const fit_problem *p, const fit_curvature *c, double widen, double *to) {
    size_t n = fit_parameter_count(p), q = p->n_reduced;
    double *all = malloc((n * n + 2 * q * q + 2 * n * q) * sizeof *all);
    if (!all)
        return PALP_ERR_NO_MEMORY;
    double *square = all + n * n, *inverse = square + q * q, *left = inverse + q * q, *half = left + n * q;
    for (size_t i = 0; i < n * n; i++)
        all[i] = widen * c->covariance[i] + c->systematic[i];
    dense_transposed_product(q, q, n, p->reduced, p->reduced, square);
    palp_status status = fit_invert(q, square, inverse);
    dense_product(n, q, q, p->reduced, inverse, left);
    dense_product(n, q, n, all, left, half);
    dense_transposed_product(q, q, n, left, half, to);
    free(all);
    return status;
}

palp_status fit_estimate_fractional(const fit_problem *p, const double *theta, const fit_curvature *c,
                                    palp_lumped_fit *fit) {
    static const char *const names[3] = {"K_frac", "tau_frac", "exponent"}, *const units[3] = {"N", "s", "1"};
    const double z = 1.959963984540054;
    size_t q = p->n_reduced, ns = p->n_springs;
    double *covariance = calloc(q * q, sizeof *covariance);
    palp_status status =
        covariance ? covariance_of(p, c, fit->inflation * fit->inflation, covariance) : PALP_ERR_NO_MEMORY;
    for (size_t k = 0; k < 3 && !status; k++) {
        palp_estimate *e = &fit->estimate[ns + k];
        double sd = sqrt(fmax(covariance[(ns + k) * q + ns + k], 0.0));
        bool plain = k == 2;
        *e = (palp_estimate){.unit = units[k], .value = plain ? theta[k] : exp(theta[k])};
        snprintf(e->name, sizeof e->name, "%s", names[k]);
        e->sd = plain ? sd : e->value * sd;
        e->low = plain ? theta[k] - z * sd : exp(theta[k] - z * sd);
        e->high = plain ? theta[k] + z * sd : exp(theta[k] + z * sd);
        e->determined = plain ? e->low > 0.0 : 2.0 * z * sd < log(10.0);
    }
    for (size_t a = 0; a < q && !status; a++)
        for (size_t b = 0; b < q; b++) {
            double sd = sqrt(covariance[a * q + a] * covariance[b * q + b]);
            fit->correlation[a * q + b] = a == b ? 1.0 : sd > 0.0 ? covariance[a * q + b] / sd : 0.0;
        }
    fit->n_estimates = status ? fit->n_estimates : q;
    free(covariance);
    return status;
}
