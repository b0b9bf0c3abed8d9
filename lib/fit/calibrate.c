/* calibrate.c: results of a calibration. */
#include "calibrate_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void palp_calibration_free(palp_calibration *c) {
    if (!c)
        return;
    free(c->iterations);
    free(c->depth_m);
    free(c->target_N);
    free(c->force_N);
    memset(c, 0, sizeof *c);
}

palp_status calibration_add(palp_calibration *c, const palp_calibrate_iteration *iteration) {
    palp_calibrate_iteration *grown = realloc(c->iterations, (c->n_iterations + 1) * sizeof *grown);
    if (!grown)
        return PALP_ERR_NO_MEMORY;
    c->iterations = grown;
    grown[c->n_iterations++] = *iteration;
    return PALP_OK;
}

palp_calibrate_iteration calibration_iteration(const palp_material *material, double squares, double weighted,
                                               size_t n) {
    return (palp_calibrate_iteration){.residual_N = sqrt(squares),
                                      .relative_rms = sqrt(weighted / (double)n),
                                      .material = *material,
                                      .peak_error_percent = NAN,
                                      .steady_time_error_percent = NAN,
                                      .steady_force_error_percent = NAN};
}

bool calibration_lost(palp_status status) {
    return status == PALP_ERR_NOT_CONVERGED || status == PALP_ERR_BUCKLED || status == PALP_ERR_COLLAPSED;
}

palp_status calibration_set_target(palp_calibration *c, size_t n, const double *depth, const double *target) {
    c->n_samples = n;
    c->depth_m = malloc(n * sizeof *c->depth_m);
    c->target_N = malloc(n * sizeof *c->target_N);
    c->force_N = calloc(n, sizeof *c->force_N);
    if (!c->depth_m || !c->target_N || !c->force_N)
        return PALP_ERR_NO_MEMORY;
    memcpy(c->depth_m, depth, n * sizeof *depth);
    memcpy(c->target_N, target, n * sizeof *target);
    return PALP_OK;
}
