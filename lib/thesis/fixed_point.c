/* fixed_point.c: the stiffness law by the loop of Figure 5.6, which multiplies the law's curve by target over
 * force. */
#include <palpate/thesis.h>

#include "base/dense.h"
#include "fit/calibrate_internal.h"

#include <math.h>
#include <stdlib.h>

/* A law through the guessed curve. The fit has a constant term, which is dropped: that is what reproduces
 * Table 5.1. */
static palp_status fit_law_to_curve(size_t n, const double *strain, const double *guess, palp_law *law) {
    double fit[PALP_LAW_MAX + 1], norm;
    palp_status status = dense_polynomial(n, strain, guess, 0, law->n, fit, &norm);
    return status ? status : palp_law_polynomial(law->n, fit + 1, law);
}

static palp_status iterate_fixed_point(static_stage *s, const double *strain, double *guess) {
    palp_material material = *s->start;
    palp_calibration *result = s->result;
    double least = HUGE_VAL;
    while (result->n_iterations < s->settings->max_evaluations) {
        palp_status status = static_stage_run(s, &material, NULL);
        if (status)
            return status;
        double residual = result->iterations[result->n_iterations - 1].residual_N;
        result->converged = !(residual < least);
        if (result->converged)
            return PALP_OK;
        least = residual;
        for (size_t i = 0; i < s->n; i++)
            guess[i] *= s->target[i] / s->force[i];
        status = fit_law_to_curve(s->n, strain, guess, &material.law);
        if (status)
            return status;
    }
    return PALP_OK;
}

static palp_status run_fixed_point_stage(static_stage *s) {
    if (s->start->law.kind != PALP_LAW_POLYNOMIAL)
        return PALP_ERR_UNSUPPORTED;
    double *strain = malloc(2 * s->n * sizeof *strain);
    if (!strain)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < s->n; i++) {
        if (!(s->target[i] > 0.0)) {
            free(strain);
            return PALP_ERR_ARGUMENT;
        }
        strain[i] = s->depth[i] / s->net->height;
        strain[s->n + i] = s->target[i];
    }
    palp_status status = iterate_fixed_point(s, strain, strain + s->n);
    free(strain);
    return status;
}

palp_status palp_thesis_fixed_point(palp_network *network, const palp_material *start, size_t n,
                                    const double *depth_m, const double *target_N,
                                    const palp_static_settings *settings, palp_calibration *result) {
    return static_stage_solve(network, start, n, depth_m, target_N, settings, result, run_fixed_point_stage);
}
