/* simulate_report.c: palpate simulate's run as an experiment, and its summary. */
#define _POSIX_C_SOURCE 200809L
#include "shared/json_out.h"
#include "shared/opening.h"
#include "simulate.h"

#include <math.h>
#include <string.h>

static const char NAME[] = "simulate";
static const char *const protocols[] = {"static", "ramp_hold", "cyclic", "creep"};

/* Adds a key to the header unless an earlier one failed. */
static void number(palp_experiment *run, const char *key, double value, palp_status *status) {
    *status = *status ? *status : palp_experiment_set_number(run, key, value);
}

static void string(palp_experiment *run, const char *key, const char *value, palp_status *status) {
    *status = *status ? *status : open_set_text(run, key, value);
}

static const char *protocol_kind(const simulate_options *o, const simulation *s) {
    const char *kind = "free";
    if (o->protocol >= 0)
        return protocols[o->protocol];
    return palp_experiment_get_string(s->like, "protocol.kind", &kind) == PALP_OK ? kind : "free";
}

static palp_status fill_protocol(const simulate_options *o, const simulation *s, palp_experiment *run) {
    palp_status status = PALP_OK;
    string(run, "protocol.kind", protocol_kind(o, s), &status);
    if (o->like) {
        string(run, "protocol.like", o->like, &status);
        return status;
    }
    if (o->protocol == 3)
        number(run, "protocol.force_N", o->force_N, &status);
    else
        number(run, "protocol.depth_mm", o->depth_mm, &status);
    if (o->protocol == 0 && o->relaxed) {
        string(run, "protocol.rate", "relaxed", &status);
    } else if (o->protocol == 0 || o->protocol == 2) {
        number(run, "protocol.rate_mm_s", o->rate_mm_s, &status);
    } else {
        number(run, "protocol.ramp_s", o->ramp_s, &status);
        number(run, "protocol.hold_s", o->hold_s, &status);
    }
    if (o->protocol == 2)
        number(run, "protocol.cycles", (double)o->cycles, &status);
    if (o->air_s > 0)
        number(run, "protocol.air_s", o->air_s, &status);
    return status;
}

static palp_status fill_sensor(const simulate_options *o, palp_experiment *run) {
    palp_status status = PALP_OK;
    const struct {
        const char *key;
        double value;
    } numbers[] = {{"sensor.sample_Hz", o->sample_Hz},
                   {"sensor.noise_N", o->noise_N},
                   {"sensor.hum_N", o->hum_N},
                   {"sensor.clip_N", o->clip_N}};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        if (numbers[i].value > 0)
            number(run, numbers[i].key, numbers[i].value, &status);
    if (o->noise_N > 0)
        number(run, "sensor.seed", (double)o->seed, &status);
    if (o->spike)
        string(run, "sensor.spike", o->spike, &status);
    if (o->drop)
        string(run, "sensor.drop", o->drop, &status);
    return status;
}

static palp_status fill_band(const simulation *s, palp_experiment *run) {
    palp_status status = palp_experiment_add_column(run, "force_low_N");
    status = status ? status : palp_experiment_add_column(run, "force_high_N");
    if (status == PALP_OK) {
        memcpy(palp_experiment_column(run, "force_low_N"), s->low_N, s->curve.n * sizeof *s->low_N);
        memcpy(palp_experiment_column(run, "force_high_N"), s->high_N, s->curve.n * sizeof *s->high_N);
    }
    return status;
}

static palp_status fill(const simulate_options *o, const simulation *s, palp_experiment *run) {
    const record *c = &s->curve;
    double *time_s = palp_experiment_column(run, "time_s"),
           *depth_mm = palp_experiment_column(run, "depth_mm"),
           *force_N = palp_experiment_column(run, "force_N"), start_s = 0;
    palp_status status = PALP_OK;
    if (s->like)
        start_s = palp_experiment_column(s->like, "time_s")[0];
    for (size_t i = 0; i < c->n; i++) {
        time_s[i] = start_s + c->time_s[i];
        depth_mm[i] = 1e3 * c->depth_m[i];
        force_N[i] = c->force_N[i];
    }
    if (s->model.specimen_kind[0])
        string(run, "specimen.kind", s->model.specimen_kind, &status);
    number(run, "specimen.height_mm", 1e3 * s->height_m, &status);
    if (s->model.radius_m > 0)
        number(run, "specimen.radius_mm", 1e3 * s->model.radius_m, &status);
    if (s->tip_radius_m > 0) {
        string(run, "tip.kind", palp_tip_name(PALP_TIP_SPHERE), &status);
        number(run, "tip.radius_mm", 1e3 * s->tip_radius_m, &status);
        for (int k = 0; k < 2 && !isnan(s->tip_m[k]); k++)
            number(run, k ? "tip.z_mm" : "tip.x_mm", 1e3 * s->tip_m[k], &status);
    }
    status = status ? status : fill_protocol(o, s, run);
    status = status ? status : fill_sensor(o, run);
    if (s->low_N && status == PALP_OK)
        status = fill_band(s, run);
    string(run, "model.file", o->model, &status);
    string(run, "palpate.version", palp_version(), &status);
    return status;
}

/* --band adds "band", of the largest and the last force. A model with strain_max adds "strain_max" and
 * "beyond": null, or when and how far the run exceeded it. */
static json_t *summary(const simulate_options *o, const simulation *s) {
    const record *c = &s->curve;
    json_t *buckling = json_null();
    if (s->buckled)
        buckling = json_pack("{s:f, s:f, s:f, s:f}", "stable_mm", 1e3 * s->stable_m, "unstable_mm",
                             1e3 * s->unstable_m, "stable_strain", s->stable_m / s->height_m,
                             "unstable_strain", s->unstable_m / s->height_m);
    json_t *all = json_pack(
        "{s:o, s:s, s:s, s:f, s:f, s:f, s:f, s:I, s:I, s:I, s:f, s:o}", "model", json_text(o->model), "kind",
        s->model.kind == PALP_MODEL_LUMPED ? "lumped" : "network", "protocol", protocol_kind(o, s),
        "peak_force_N", record_peak(c), "final_force_N", c->force_N[c->n - 1], "final_depth_mm",
        1e3 * c->depth_m[c->n - 1], "duration_s", c->time_s[c->n - 1], "steps", (json_int_t)s->info.steps,
        "rejected", (json_int_t)s->info.rejected, "iterations", (json_int_t)s->info.iterations,
        "worst_residual", s->info.worst_residual, "buckling", buckling);
    if (s->network)
        json_object_set_new(all, "inverted", json_integer((json_int_t)s->info.inverted));
    size_t peak = 0;
    for (size_t i = 0; i < c->n; i++)
        peak = fabs(c->force_N[i]) > fabs(c->force_N[peak]) ? i : peak;
    if (s->low_N)
        json_object_set_new(all, "band",
                            json_pack("{s:f, s:f, s:f, s:f}", "peak_low_N", s->low_N[peak], "peak_high_N",
                                      s->high_N[peak], "final_low_N", s->low_N[c->n - 1], "final_high_N",
                                      s->high_N[c->n - 1]));
    if (s->model.material.law.strain_max > 0) {
        json_object_set_new(all, "strain_max", json_real(s->model.material.law.strain_max));
        json_object_set_new(all, "beyond",
                            s->beyond_s < 0
                                ? json_null()
                                : json_pack("{s:f, s:f}", "from_s", s->beyond_s, "strain", s->strain_max));
    }
    return all;
}

int simulate_report(const simulate_options *o, const simulation *s) {
    palp_experiment *run = NULL;
    palp_error error = {PALP_OK, ""};
    int code = CLI_OK;
    if (palp_ranks_rank(s->ranks) > 0)
        return CLI_OK; /* the first process writes for all */
    palp_status status = palp_experiment_create(s->curve.n, &run);
    status = status ? status : fill(o, s, run);
    if (status == PALP_OK && (o->out || !o->json))
        status = palp_experiment_write(run, o->out ? o->out : "/dev/stdout", &error);
    if (status)
        code = cli_status_of(NAME, o->out ? o->out : "the run", status, &error);
    else if (o->json)
        code = json_print(NAME, summary(o, s));
    palp_experiment_free(run);
    return code;
}
