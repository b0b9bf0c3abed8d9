/* calibrate_static.c: the element's stiffness law from a static force curve (Section 5.3.1). */
#include "calibrate_internal.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

palp_static_settings palp_static_settings_default(void) {
    return (palp_static_settings){.method = PALP_CALIBRATE_NLOPT,
                                  .max_evaluations = 60,
                                  .every_step = false,
                                  .curve_tolerance = 0.0,
                                  .stop_relative = 1e-4};
}

typedef struct stage {
    palp_network *net;
    const palp_material *start;
    const palp_static_settings *settings;
    size_t n;
    const double *depth, *target;
    double tolerance; /* of the curve */
    force_curve curve;
    double *force; /* [n] */
    palp_calibration *result;
} stage;

static palp_status report(stage *s, const palp_material *material) {
    double sum = 0.0;
    for (size_t i = 0; i < s->n; i++)
        sum += (s->force[i] - s->target[i]) * (s->force[i] - s->target[i]);
    palp_calibrate_iteration it = {.residual_N = sqrt(sum), .material = *material};
    palp_status status = calibration_add(s->result, &it);
    if (status)
        return status;
    if (s->result->n_iterations == 1 || it.residual_N < s->result->residual_N) {
        s->result->residual_N = it.residual_N;
        s->result->material = *material;
        s->result->buckled = palp_network_buckled(s->net, &s->result->stable_m, &s->result->unstable_m);
        s->result->reached_m = s->curve.depth[s->curve.n - 1];
        memcpy(s->result->force_N, s->force, s->n * sizeof *s->force);
    }
    double done = (double)s->result->n_iterations / (double)s->settings->max_evaluations;
    if (s->settings->progress && s->settings->progress(s->settings->user, done, &it))
        return PALP_ERR_STOPPED;
    return PALP_OK;
}

/* Force of the network at the samples; a curve that ends early keeps its last force, which the fit
 * then sees as a large residual. */
static palp_status run_curve(stage *s, const palp_material *material, double *gradient) {
    palp_status status = palp_network_set_material(s->net, material);
    if (status)
        return status;
    if (s->settings->every_step)
        status = force_curve_steps(&s->curve, s->net, s->n, s->depth, gradient != NULL);
    else
        status = force_curve_trace(&s->curve, s->net, s->depth[s->n - 1], s->tolerance);
    bool early = calibration_lost(status);
    if (status && !(early && s->curve.n > 1))
        return status;
    if (s->settings->every_step && !early && !gradient) {
        memcpy(s->force, s->curve.force, s->n * sizeof *s->force);
        return PALP_OK;
    }
    force_curve_sample(&s->curve, s->n, s->depth, s->force, gradient);
    return PALP_OK;
}

/* Figure 5.6. The fit has a constant term, which is dropped: that is what reproduces Table 5.1. */
static palp_status fixed_point(stage *s) {
    palp_material material = *s->start;
    double fit[PALP_LAW_MAX + 1], norm, *strain = malloc(2 * s->n * sizeof *strain);
    if (!strain)
        return PALP_ERR_NO_MEMORY;
    double *guess = strain + s->n;
    for (size_t i = 0; i < s->n; i++) {
        strain[i] = s->depth[i] / s->net->height;
        guess[i] = s->target[i];
    }
    palp_status status = PALP_OK;
    double least = HUGE_VAL;
    while (!status && s->result->n_iterations < s->settings->max_evaluations) {
        status = run_curve(s, &material, NULL);
        if (!status)
            status = report(s, &material);
        if (status)
            break;
        double residual = s->result->iterations[s->result->n_iterations - 1].residual_N;
        if (!(residual < least)) {
            s->result->converged = true;
            break;
        }
        least = residual;
        for (size_t i = 0; i < s->n; i++)
            guess[i] *= s->target[i] / s->force[i];
        status = dense_polynomial(s->n, strain, guess, 0, material.law.n, fit, &norm);
        if (!status)
            status = palp_law_polynomial(material.law.n, fit + 1, &material.law);
    }
    free(strain);
    return status;
}

static palp_status residuals(void *user, const double *p, double *r, double *jacobian) {
    stage *s = user;
    palp_material material = *s->start;
    palp_status status = palp_law_set_coefficients(&material.law, p);
    if (!status)
        status = run_curve(s, &material, jacobian);
    if (!status)
        status = report(s, &material);
    for (size_t i = 0; i < s->n && !status; i++)
        r[i] = s->force[i] - s->target[i];
    return status;
}

enum { GRID = 48 };

/* K(a) >= floor on a grid up to a little beyond the network's nominal strain; a spline's knots. */
static size_t positive_rows(const stage *s, double *row, double *floor) {
    const palp_law *law = &s->start->law;
    bool spline = law->kind == PALP_LAW_SPLINE;
    size_t rows = spline ? law->n : GRID, n = law->n;
    double reach = 1.2 * s->depth[s->n - 1] / s->net->height;
    memset(row, 0, rows * n * sizeof *row);
    for (size_t i = 0; i < rows; i++) {
        double a = reach * (double)i / (GRID - 1), power = 1.0;
        floor[i] = 0.0;
        if (spline)
            row[i * n + i] = 1.0;
        else
            for (size_t k = 0; k < n; k++, power *= a)
                row[i * n + k] = power;
    }
    return rows;
}

/* A relaxed network's force is proportional to its law, so the best scale of the first guess costs one
 * evaluation. */
static palp_status scale_start(stage *s, double *p) {
    double product = 0.0, square = 0.0;
    palp_status status = run_curve(s, s->start, NULL);
    if (!status)
        status = report(s, s->start);
    for (size_t i = 0; i < s->n && !status; i++) {
        product += s->force[i] * s->target[i];
        square += s->force[i] * s->force[i];
    }
    if (!status && !(product > 0.0))
        return PALP_ERR_ARGUMENT;
    for (size_t k = 0; k < s->start->law.n && !status; k++)
        p[k] = s->start->law.coefficients[k] * product / square;
    return status;
}

static palp_status least_squares_fit(stage *s) {
    size_t n = s->start->law.n;
    double p[PALP_LAW_MAX], norm, floor[GRID + PALP_LAW_MAX];
    double *row = malloc((GRID + PALP_LAW_MAX) * n * sizeof *row);
    palp_status status = row ? scale_start(s, p) : PALP_ERR_NO_MEMORY;
    if (!status) {
        least_squares problem = {.n_parameters = n,
                                 .n_residuals = s->n,
                                 .max_evaluations = s->settings->max_evaluations - 1,
                                 .stop_relative = s->settings->stop_relative,
                                 .evaluate = residuals,
                                 .user = s,
                                 .n_constraints = positive_rows(s, row, floor),
                                 .constraint = row,
                                 .floor = floor};
        for (size_t i = 0; i < problem.n_constraints; i++)
            floor[i] = 0.02 * p[0];
        status = least_squares_solve(&problem, p, &norm, &s->result->converged);
    }
    free(row);
    return status;
}

static palp_status check(const stage *s) {
    const palp_law *law = &s->start->law;
    bool fixed = s->settings->method == PALP_CALIBRATE_FIXED_POINT;
    if (law->kind != PALP_LAW_POLYNOMIAL && (fixed || law->kind != PALP_LAW_SPLINE))
        return PALP_ERR_UNSUPPORTED;
    if (s->settings->method == PALP_CALIBRATE_THREE_PHASE)
        return PALP_ERR_UNSUPPORTED;
    if (s->n <= law->n + 1 || s->settings->max_evaluations < 2 || !(s->tolerance > 0.0))
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < s->n; i++)
        if (!(s->depth[i] > (i ? s->depth[i - 1] : 0.0)) || !isfinite(s->target[i]) || !(s->target[i] > 0.0))
            return PALP_ERR_ARGUMENT;
    double strain = s->depth[s->n - 1] / s->net->height;
    if (!(strain < 1.0) || !(palp_law_minimum(law, strain) > 0.0))
        return PALP_ERR_ARGUMENT;
    return palp_material_check(s->start, NULL);
}

palp_status palp_calibrate_static(palp_network *network, const palp_material *start, size_t n, const double *depth_m,
                                  const double *target_N, const palp_static_settings *settings,
                                  palp_calibration *result) {
    stage s = {.net = network, .start = start, .settings = settings, .n = n,
               .depth = depth_m, .target = target_N, .result = result};
    memset(result, 0, sizeof *result);
    s.tolerance = settings->curve_tolerance;
    if (s.tolerance == 0.0)
        s.tolerance = network->chord ? 1e-4 : 1e-6;
    palp_status status = check(&s);
    if (status)
        return status;
    s.force = calloc(n, sizeof *s.force);
    result->n_samples = n;
    result->depth_m = malloc(n * sizeof *result->depth_m);
    result->target_N = malloc(n * sizeof *result->target_N);
    result->force_N = calloc(n, sizeof *result->force_N);
    if (s.force && result->depth_m && result->target_N && result->force_N) {
        memcpy(result->depth_m, depth_m, n * sizeof *depth_m);
        memcpy(result->target_N, target_N, n * sizeof *target_N);
        status = settings->method == PALP_CALIBRATE_FIXED_POINT ? fixed_point(&s) : least_squares_fit(&s);
    } else {
        status = PALP_ERR_NO_MEMORY;
    }
    if (!status)
        status = palp_network_set_material(network, &result->material);
    free(s.force);
    force_curve_free(&s.curve);
    if (status)
        palp_calibration_free(result);
    return status;
}
