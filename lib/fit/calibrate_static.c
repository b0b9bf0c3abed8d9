/* calibrate_static.c: the element's stiffness law from a static force curve (Section 5.3.1). */
#include "calibrate_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

palp_static_settings palp_static_settings_default(void) {
    return (palp_static_settings){
        .max_evaluations = 60, .every_step = false, .curve_tolerance = 0.0, .stop_relative = 1e-4};
}

static palp_status report(static_stage *s, const palp_material *material) {
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
        s->result->strain_max = s->curve.strain_max;
        memcpy(s->result->force_N, s->force, s->n * sizeof *s->force);
    }
    double done = (double)s->result->n_iterations / (double)s->settings->max_evaluations;
    if (s->settings->progress && s->settings->progress(s->settings->user, done, &it))
        return PALP_ERR_STOPPED;
    return PALP_OK;
}

/* Force of the network at the samples. */
static palp_status run_curve(static_stage *s, const palp_material *material, double *gradient) {
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

palp_status static_stage_run(static_stage *s, const palp_material *material, double *gradient) {
    palp_status status = run_curve(s, material, gradient);
    return status ? status : report(s, material);
}

static palp_status residuals(void *user, const double *p, double *r, double *jacobian) {
    static_stage *s = user;
    palp_material material = *s->start;
    palp_status status = palp_law_set_coefficients(&material.law, p);
    if (!status)
        status = static_stage_run(s, &material, jacobian);
    for (size_t i = 0; i < s->n && !status; i++)
        r[i] = s->force[i] - s->target[i];
    return status;
}

size_t law_positive_rows(const palp_law *law, double reach, size_t columns, double *row) {
    bool spline = law->kind == PALP_LAW_SPLINE;
    size_t rows = spline ? law->n : LAW_GRID;
    memset(row, 0, rows * columns * sizeof *row);
    for (size_t i = 0; i < rows; i++) {
        double a = reach * (double)i / (LAW_GRID - 1), power = 1.0;
        if (spline)
            row[i * columns + i] = 1.0;
        else
            for (size_t k = 0; k < law->n; k++, power *= a)
                row[i * columns + k] = power;
    }
    return rows;
}

/* A relaxed network's force is proportional to its law, so the best scale of the first guess costs one
 * evaluation. */
static palp_status scale_start(static_stage *s, double *p) {
    double product = 0.0, square = 0.0;
    palp_status status = static_stage_run(s, s->start, NULL);
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

static palp_status least_squares_fit(static_stage *s) {
    size_t n = s->start->law.n;
    double p[PALP_LAW_MAX], norm, floor[LAW_ROWS];
    double *row = malloc(LAW_ROWS * n * sizeof *row);
    palp_status status = row ? scale_start(s, p) : PALP_ERR_NO_MEMORY;
    if (!status) {
        least_squares problem = {.n_parameters = n,
                                 .n_residuals = s->n,
                                 .max_evaluations = s->settings->max_evaluations - 1,
                                 .stop_relative = s->settings->stop_relative,
                                 .evaluate = residuals,
                                 .user = s,
                                 .n_constraints = law_positive_rows(
                                     &s->start->law, 1.2 * s->depth[s->n - 1] / s->net->height, n, row),
                                 .constraint = row,
                                 .floor = floor};
        for (size_t i = 0; i < problem.n_constraints; i++)
            floor[i] = 0.02 * p[0];
        status = least_squares_solve(&problem, p, &norm, &s->result->converged);
    }
    free(row);
    return status;
}

static palp_status check(const static_stage *s) {
    const palp_law *law = &s->start->law;
    if (law->kind != PALP_LAW_POLYNOMIAL && law->kind != PALP_LAW_SPLINE)
        return PALP_ERR_UNSUPPORTED;
    if (s->n <= law->n + 1 || s->settings->max_evaluations < 2 || !(s->tolerance > 0.0))
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < s->n; i++)
        if (!(s->depth[i] > (i ? s->depth[i - 1] : 0.0)) || !isfinite(s->target[i]))
            return PALP_ERR_ARGUMENT;
    double strain = s->depth[s->n - 1] / s->net->height;
    if (!(strain < 1.0) || !(palp_law_minimum(law, strain) > 0.0))
        return PALP_ERR_ARGUMENT;
    return palp_material_check(s->start, NULL);
}

static palp_status solve_checked(static_stage *s, palp_status (*solve)(static_stage *)) {
    s->force = calloc(s->n, sizeof *s->force);
    palp_status status =
        s->force ? calibration_set_target(s->result, s->n, s->depth, s->target) : PALP_ERR_NO_MEMORY;
    if (!status)
        status = solve(s);
    if (!status)
        status = palp_network_set_material(s->net, &s->result->material);
    free(s->force);
    force_curve_free(&s->curve);
    return status;
}

palp_status static_stage_solve(palp_network *network, const palp_material *start, size_t n,
                               const double *depth_m, const double *target_N,
                               const palp_static_settings *settings, palp_calibration *result,
                               palp_status (*solve)(static_stage *)) {
    if (!network || !start || !depth_m || !target_N || !settings || !result)
        return PALP_ERR_ARGUMENT;
    static_stage s = {.net = network,
                      .start = start,
                      .settings = settings,
                      .n = n,
                      .depth = depth_m,
                      .target = target_N,
                      .result = result,
                      .tolerance = settings->curve_tolerance};
    memset(result, 0, sizeof *result);
    if (s.tolerance == 0.0)
        s.tolerance = network->reuse_factor ? 1e-4 : 1e-6;
    palp_status status = check(&s);
    if (!status)
        status = solve_checked(&s, solve);
    if (status)
        palp_calibration_free(result);
    return status;
}

palp_status palp_calibrate_static(palp_network *network, const palp_material *start, size_t n,
                                  const double *depth_m, const double *target_N,
                                  const palp_static_settings *settings, palp_calibration *result) {
    return static_stage_solve(network, start, n, depth_m, target_N, settings, result, least_squares_fit);
}
