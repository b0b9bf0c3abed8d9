/* calibrate_known.c: how well the network is known, carried over from the lumped model that it was calibrated
 * to. */
#include "calibrate.h"

#include <math.h>
#include <stdlib.h>

static const char NAME[] = "calibrate";

enum { SAMPLES = 32, RAMP = 8, SHOWN = 3, NODES_MAX = 2000 };

/* A press with its samples. */
typedef struct known_run {
    double time_s[SAMPLES], depth_m[SAMPLES];
} known_run;

static double slowest(const palp_material *m) {
    double tau = 0;
    for (size_t j = 0; j < m->n_arms; j++)
        tau = fmax(tau, m->arms[j].viscosity_Ns / m->arms[j].stiffness_N);
    return tau;
}

/* The static curve, slow enough for relaxed arms. */
static void static_run(const calibrate_state *s, known_run *run) {
    double deepest = fmin(s->depth_m[s->n_static - 1], s->static_result.reached_m);
    double whole = 1e4 * fmax(fmax(slowest(&s->lumped.material), slowest(&s->model.material)), 1e-3);
    for (size_t i = 0; i < SAMPLES; i++) {
        run->time_s[i] = whole * (double)i / (SAMPLES - 1);
        run->depth_m[i] = deepest * (double)i / (SAMPLES - 1);
    }
}

/* Samples at equal steps on the ramp, then at equal steps of log time. */
static void press_run(const press_target *press, known_run *run) {
    const palp_path *path = &press->path;
    double ramp = path->time_s[1], hold = path->time_s[path->n - 1] - ramp;
    for (size_t i = 0; i < SAMPLES; i++) {
        double part = (double)(i + 1 - RAMP) / (SAMPLES - RAMP);
        run->time_s[i] = i < RAMP ? ramp * (double)i / (RAMP - 1) : ramp + hold * pow(1e-3, 1 - part);
        if (hold <= 0)
            run->time_s[i] = ramp * (double)i / (SAMPLES - 1);
        run->depth_m[i] = palp_path_at(path, run->time_s[i]);
    }
}

static palp_forward_run as_forward(const known_run *run) {
    return (palp_forward_run){.n = SAMPLES, .time_s = run->time_s, .depth_m = run->depth_m};
}

/* The targets: the static curve, and the shallowest, a middle and the deepest press. */
static size_t list_runs(const calibrate_state *s, known_run *run) {
    size_t n = 0, last = s->n_presses - 1, of[SHOWN] = {0, last / 2, last};
    if (s->does_static)
        static_run(s, &run[n++]);
    for (size_t i = 0; i < SHOWN && i < s->n_presses; i++)
        press_run(&s->press[s->n_presses < SHOWN ? i : of[i]], &run[n++]);
    return n;
}

/* Why the covariance cannot be carried over to the network; NULL if it can. */
static const char *reason_not(const calibrate_state *s) {
    if (s->does_static && !s->static_lumped)
        return "the static curve is from a run, not from the lumped model";
    for (size_t i = 0; i < s->n_presses; i++)
        if (s->press[i].measured)
            return "the presses are from runs, not from the lumped model";
    if (s->model.material.formulation != PALP_HISTORY)
        return "the formulation sedef2008 has no derivatives";
    return palp_mesh_node_count(s->mesh) > NODES_MAX ? "the network is too large" : NULL;
}

static palp_status carry(calibrate_state *s, palp_error *error) {
    known_run run[1 + SHOWN];
    palp_forward_run forward[1 + SHOWN];
    size_t n = list_runs(s, run), size = s->model.material.law.n + 2 * s->model.material.n_arms;
    for (size_t i = 0; i < n; i++)
        forward[i] = as_forward(&run[i]);
    s->covariance = calloc(size * size + 1, sizeof *s->covariance);
    s->between = s->lumped_between ? calloc(size * size + 1, sizeof *s->between) : NULL;
    if (!s->covariance || (s->lumped_between && !s->between))
        return PALP_ERR_NO_MEMORY;
    s->lumped.covariance = s->lumped_covariance;
    s->lumped.between = s->lumped_between;
    palp_status status =
        palp_calibrate_covariance(&s->lumped, &s->model, n, forward, s->covariance, s->between, error);
    if (status)
        return status;
    s->model.covariance = s->covariance;
    s->model.between = s->between;
    s->model.n_specimens = s->n_specimens;
    return PALP_OK;
}

int calibrate_known(const calibrate_options *o, calibrate_state *s) {
    palp_error error = {PALP_OK, ""};
    palp_status status = palp_model_read_covariance(o->lumped, &s->lumped_covariance, &error);
    if (status == PALP_OK)
        status = palp_model_read_between(o->lumped, &s->lumped_between, &s->n_specimens, &error);
    if (status || !s->lumped_covariance)
        return status ? cli_status(NAME, status, &error) : CLI_OK;
    const char *why = reason_not(s);
    if (!why && (status = carry(s, &error)) != PALP_OK)
        why = error.text[0] ? error.text : palp_status_text(status);
    if (why)
        cli_warning(NAME, "the network has no covariance, as the lumped model has: %s", why);
    return CLI_OK;
}
