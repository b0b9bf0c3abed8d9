/* specimen.c: a model pressed step by step, with the plate, specimen and sensor of the forward model. */
#include <palpate/specimen.h>

#include "base/file.h"
#include "forward_internal.h"

#include <math.h>
#include <stdlib.h>

static const double TABLE = 0.95; /* strain at which the plate meets the table below the specimen */

struct palp_specimen {
    palp_model model;
    palp_specimen_settings settings;
    forward_plan plan;
    forward_lumped *lumped; /* the other one is NULL */
    forward_network *network;
    forward_specimen body; /* without the table */
    forward_plate plate;
    forward_sensor sensor;
    double time_s; /* since creation */
    bool sensed;
    double sensed_s, sensed_N; /* the last reading */
};

palp_specimen_settings palp_specimen_settings_default(void) {
    return (palp_specimen_settings){
        .scale = 1.0, .step_s = 1e-3, .span_s = 1e3, .network = palp_network_settings_default()};
}

/* ---- on a table ---- */

static palp_status try_strain_above_table(void *self, const forward_move *move, double *force,
                                          double *slope) {
    palp_specimen *s = self;
    forward_move up_to = *move;
    double beyond = fmax(move->strain - TABLE, 0.0), table = s->settings.table_N_m * s->body.height;
    up_to.strain -= beyond;
    palp_status status = s->body.attempt(s->body.self, &up_to, force, slope);
    if (status || beyond == 0.0)
        return status;
    *force += table * beyond / s->plan.age; /* the plate multiplies by age, but the table does not age */
    if (slope)
        *slope = table / s->plan.age;
    return PALP_OK;
}

static void commit_specimen_strain(void *self, const double *strain_p, const double *dt_p, double *force_p) {
    palp_specimen *s = self;
    s->body.commit(s->body.self, strain_p, dt_p, force_p);
}

/* ---- created and freed ---- */

static palp_status check_specimen_settings(const palp_specimen_settings *s, palp_error *error) {
    bool good = isfinite(s->start_m) && s->scale > 0.0 && isfinite(s->scale) && s->table_N_m >= 0.0 &&
                isfinite(s->table_N_m) && isfinite(s->session_s) && s->step_s > 0.0 &&
                s->span_s >= s->step_s && isfinite(s->span_s) && s->fastest_m_s >= 0.0 &&
                isfinite(s->fastest_m_s);
    return good ? PALP_OK
                : palp_error_set(error, PALP_ERR_ARGUMENT,
                                 "a setting of the specimen or sensor is out of range");
}

/* Updates the factor of the specimen's force to the present time. */
static palp_status update_ageing_factor(palp_specimen *s) {
    palp_status status = forward_plan_age(&s->plan, s->settings.session_s + s->time_s);
    s->plan.age *= s->settings.scale;
    return status;
}

static palp_status create_specimen_body(palp_specimen *s, palp_error *error) {
    const palp_specimen_settings *to = &s->settings;
    if (s->model.kind == PALP_MODEL_NETWORK) {
        palp_status status =
            forward_network_create(&s->plan, &to->network, to->step_s, to->span_s, false, &s->network, error);
        if (!status)
            s->body = forward_network_specimen(s->network);
        return status;
    }
    if (forward_lumped_create(&s->plan, 0, to->step_s, to->span_s, &s->lumped))
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    s->body = forward_lumped_specimen(s->lumped);
    return PALP_OK;
}

static palp_status create_specimen_plate(palp_specimen *s, palp_error *error) {
    forward_specimen body = s->body;
    if (s->settings.table_N_m > 0.0) {
        body.self = s;
        body.attempt = try_strain_above_table;
        body.commit = commit_specimen_strain;
    }
    palp_status status = forward_plate_create(&s->plan, &body, &s->plate);
    if (!status)
        status = forward_sensor_create(&s->plan, 0, s->settings.fastest_m_s, &s->sensor);
    if (!status)
        status = forward_plate_start(&s->plate, &(forward_place){.depth = s->settings.start_m});
    return status ? palp_error_set(error, status, "the specimen: %s", palp_status_text(status)) : PALP_OK;
}

palp_status palp_specimen_create(const palp_model *model, const palp_specimen_settings *settings,
                                 palp_specimen **specimen, palp_error *error) {
    if (!model || !specimen)
        return palp_error_null(error);
    palp_specimen *s = calloc(1, sizeof *s);
    if (!s)
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "out of memory");
    s->model = *model;
    s->settings = settings ? *settings : palp_specimen_settings_default();
    palp_status status = check_specimen_settings(&s->settings, error);
    if (!status)
        status = forward_plan_make(&s->model, s->settings.session_s, &s->plan, error);
    if (!status)
        status = update_ageing_factor(s);
    if (!status)
        status = create_specimen_body(s, error);
    if (!status)
        status = create_specimen_plate(s, error);
    if (status)
        palp_specimen_free(s);
    else
        *specimen = s;
    return status;
}

void palp_specimen_free(palp_specimen *s) {
    if (!s)
        return;
    forward_sensor_free(&s->sensor);
    forward_plate_free(&s->plate);
    forward_lumped_free(s->lumped);
    forward_network_free(s->network);
    free(s);
}

/* ---- pressed and read ---- */

static double force_on_touching_plate(const palp_specimen *s) {
    return s->plate.touching ? s->plate.force : 0.0;
}

palp_status palp_specimen_step(palp_specimen *s, double depth_m, double dt_s, double *force_N) {
    if (!s || !force_N)
        return PALP_ERR_ARGUMENT;
    if (!isfinite(depth_m) || !(dt_s > 0.0) || !isfinite(dt_s))
        return PALP_ERR_ARGUMENT;
    palp_status status = s->plate.touching ? PALP_OK : update_ageing_factor(s);
    if (!status)
        status = forward_plate_step(&s->plate, dt_s, depth_m, (depth_m - s->plate.depth[1]) / dt_s);
    if (status)
        return status;
    s->time_s += dt_s;
    *force_N = force_on_touching_plate(s);
    return PALP_OK;
}

double palp_specimen_sense(palp_specimen *s, const palp_specimen_motion *m) {
    if (!s || !m)
        return NAN;
    if (s->sensed && !(m->time_s > s->sensed_s))
        return s->sensed_N;
    effect_moment at = {.time = m->time_s,
                        .since = m->time_s,
                        .step = s->sensed ? m->time_s - s->sensed_s : 0.0,
                        .depth = m->depth_m,
                        .velocity = m->velocity_m_s,
                        .acceleration = m->acceleration_m_s2};
    s->sensed = true;
    s->sensed_s = m->time_s;
    s->sensed_N = forward_sensor_read(&s->sensor, &at, force_on_touching_plate(s));
    return s->sensed_N;
}
