/* simulate_effects.c: palpate simulate's run of a model with effects: what its instrument would record. */
#include "simulate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "simulate";

enum { HALVINGS_MAX = 7 };

static int check(const simulate_options *o) {
    const char *option = o->protocol == 3 ? "protocol creep" : o->relaxed ? "relaxed" : o->vtu ? "vtu" : NULL;
    return option ? cli_usage_error(NAME, "--%s does not go with the effects of %s", option, o->model)
                  : CLI_OK;
}

/* Times of the samples: regular, those of the run to follow, or adaptive. */
static palp_status encoder(const simulate_options *o, const palp_path *path, size_t *n, double **time_s,
                           double **depth_m) {
    press_settings press = {1e-3 * o->dt_ms, o->tolerance, false, o->like != NULL, 0};
    palp_status status =
        o->sample_Hz > 0 ? simulate_samples(o, path, n, time_s) : press_times(path, &press, n, time_s);
    *depth_m = status == PALP_OK ? malloc((*n + 1) * sizeof **depth_m) : NULL;
    if (status == PALP_OK && !*depth_m)
        status = PALP_ERR_NO_MEMORY;
    for (size_t i = 0; status == PALP_OK && i < *n; i++) {
        double t = (*time_s)[i] - o->air_s;
        (*depth_m)[i] = t < 0 ? 1e-3 * simulate_air_rate(o) * t : palp_path_at(path, t);
    }
    return status;
}

static palp_status answer(const simulate_options *o, const simulation *s, const palp_forward_run *run,
                          double *force_N, palp_error *error) {
    palp_network_settings settings = palp_network_settings_default();
    settings.branch = (palp_branch)o->branch;
    settings.solver = (palp_solver)o->solver;
    return s->model.kind == PALP_MODEL_LUMPED
               ? palp_forward_force(&s->model, run, force_N, NULL, error)
               : palp_forward_network(&s->model, &settings, run, force_N, error);
}

/* Halves the specimen's steps until the force changes less than the tolerance. */
static palp_status answer_to_tolerance(const simulate_options *o, simulation *s, palp_forward_run *run,
                                       double *force_N, palp_error *error) {
    double *coarse = malloc((run->n + 1) * sizeof *coarse), change = 1, scale = 0;
    palp_status status = coarse ? answer(o, s, run, force_N, error) : PALP_ERR_NO_MEMORY;
    for (size_t k = 1;
         status == PALP_OK && o->dt_ms <= 0 && change > o->tolerance * scale && k <= HALVINGS_MAX; k++) {
        memcpy(coarse, force_N, run->n * sizeof *coarse);
        run->parts = (size_t)1 << k;
        status = answer(o, s, run, force_N, error);
        change = 0;
        for (size_t i = 0; status == PALP_OK && i < run->n; i++) {
            change = fmax(change, fabs(force_N[i] - coarse[i]));
            scale = fmax(scale, fabs(force_N[i]));
        }
    }
    free(coarse);
    return status;
}

/* A column of the run to follow, at the times of this one; NULL: none. */
static palp_status follow_column(const palp_experiment *like, const char *name, const palp_forward_run *run,
                                 double **value) {
    const double *t = palp_experiment_column(like, "time_s"), *v = palp_experiment_column(like, name);
    const size_t n = palp_experiment_rows(like);
    *value = t && v && n ? malloc((run->n + 1) * sizeof **value) : NULL;
    if (!*value)
        return t && v && n ? PALP_ERR_NO_MEMORY : PALP_OK;
    for (size_t i = 0, k = 0; i < run->n; i++) {
        while (k + 2 < n && t[k + 1] < run->time_s[i])
            k++;
        double share = n > 1 ? (run->time_s[i] - t[k]) / (t[k + 1] - t[k]) : 0;
        share = fmin(fmax(share, 0), 1);
        (*value)[i] = n > 1 ? v[k] + share * (v[k + 1] - v[k]) : v[0];
    }
    return PALP_OK;
}

/* The columns that the model's effects use; the caller frees column[i].value. */
static palp_status follow_columns(const simulation *s, palp_forward_run *run, palp_forward_column *column) {
    palp_status status = PALP_OK;
    run->column = column;
    for (size_t i = 0; s->like && i < s->model.n_effects && status == PALP_OK; i++) {
        const char *name = palp_effect_look_up(s->model.effects[i].id)->column;
        double *value = NULL;
        status = name ? follow_column(s->like, name, run, &value) : PALP_OK;
        if (value)
            column[run->n_columns++] = (palp_forward_column){name, value};
    }
    return status;
}

static palp_status run_forward(const simulate_options *o, simulation *s, palp_error *error) {
    palp_forward_run run = {.parts = 1};
    double *time_s = NULL, *depth_m = NULL, *force_N = NULL;
    palp_forward_column column[PALP_EFFECTS_MAX];
    palp_status status = encoder(o, &s->path, &run.n, &time_s, &depth_m);
    if (status == PALP_OK) {
        run.time_s = time_s;
        run.depth_m = depth_m;
        if (s->like)
            palp_experiment_get_number(s->like, "session.start_s", &run.session_s);
        force_N = malloc((run.n + 1) * sizeof *force_N);
        status = force_N ? follow_columns(s, &run, column) : PALP_ERR_NO_MEMORY;
    }
    if (status == PALP_OK)
        status = answer_to_tolerance(o, s, &run, force_N, error);
    for (size_t i = 0; status == PALP_OK && i < run.n; i++)
        status = record_add(&s->curve, time_s[i], depth_m[i], force_N[i]);
    s->info.steps = run.n ? (run.n - 1) * run.parts : 0;
    for (size_t i = 0; i < run.n_columns; i++)
        free((double *)column[i].value);
    free(time_s);
    free(depth_m);
    free(force_N);
    return status;
}

int simulate_effects(const simulate_options *o, simulation *s) {
    palp_error error = {PALP_OK, ""};
    int code = check(o);
    if (code)
        return code;
    s->recorded = true;
    palp_status status = run_forward(o, s, &error);
    s->info.peak_force_N = record_peak(&s->curve);
    return status ? cli_status_of(NAME, o->model, status, &error) : CLI_OK;
}
