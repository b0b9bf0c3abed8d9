/* simulate_band.c: palpate simulate --band: how well the model knows the force. */
#include "simulate.h"

#include <stdlib.h>

static const char NAME[] = "simulate";

int simulate_band_check(const simulate_options *o, const simulation *s) {
    const char *option = o->protocol == 3 ? "protocol creep"
                         : o->relaxed     ? "relaxed"
                         : o->drop        ? "drop"
                                          : NULL;
    if (option)
        return cli_usage_error(NAME, "--band does not go with --%s", option);
    return s->reduced
               ? cli_usage_error(NAME, "--band needs a lumped model or a network; %s is reduced", o->model)
               : CLI_OK;
}

static palp_status find(simulation *s, const double *covariance, palp_error *error) {
    const size_t n = s->curve.n;
    const palp_forward_run run = {
        .n = n, .time_s = s->curve.time_s, .depth_m = s->curve.depth_m, .parts = s->model.n_effects ? 8 : 1};
    double *force = malloc(n * sizeof *force);
    s->low_N = malloc(n * sizeof *s->low_N);
    s->high_N = malloc(n * sizeof *s->high_N);
    palp_status status = force && s->low_N && s->high_N ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (status == PALP_OK)
        status = palp_forward_band(&s->model, &run, covariance, force, s->low_N, error);
    for (size_t i = 0; status == PALP_OK && i < n; i++) {
        double half = 1.96 * s->low_N[i];
        s->low_N[i] = force[i] - half;
        s->high_N[i] = force[i] + half;
    }
    free(force);
    return status;
}

/* Covariance for the band. For a mean of several specimens it is that of an unmeasured specimen. *part: the
 * file has the spread between specimens, but not the uncertainty of their mean. NULL: neither. */
static palp_status read_covariance(const simulate_options *o, const simulation *s, double **covariance,
                                   bool *part, palp_error *error) {
    double *between = NULL;
    size_t n_specimens = 0, n = s->model.material.law.n + 2 * s->model.material.n_arms;
    palp_status status = palp_model_read_covariance(o->model, covariance, error);
    if (status == PALP_OK)
        status = palp_model_read_between(o->model, &between, &n_specimens, error);
    *part = between && !*covariance;
    if (status == PALP_OK && *part && !(*covariance = calloc(n * n, sizeof **covariance)))
        status = PALP_ERR_NO_MEMORY;
    if (status == PALP_OK && between)
        status = palp_model_unmeasured(n, *covariance, between, n_specimens, *covariance);
    free(between);
    return status;
}

int simulate_band(const simulate_options *o, simulation *s) {
    palp_error error = {PALP_OK, ""};
    double *covariance = NULL;
    bool part = false;
    palp_status status = read_covariance(o, s, &covariance, &part, &error);
    if (status == PALP_OK && !covariance)
        return cli_failure(NAME,
                           "%s: --band needs a \"covariance\" in the model; palpate characterize "
                           "--out and palpate calibrate --out write it",
                           o->model);
    if (status == PALP_OK && part)
        cli_warning(NAME,
                    "%s: has no \"covariance\": the band shows how specimens differ, but not the "
                    "uncertainty of their mean, and is too narrow",
                    o->model);
    status = status ? status : find(s, covariance, &error);
    free(covariance);
    return status ? cli_status_of(NAME, o->model, status, &error) : CLI_OK;
}
