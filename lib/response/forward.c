/* forward.c: forward model of a recording: all parameters in one vector, and the run of the whole chain. */
#include "base/file.h"
#include "forward_internal.h"
#include "model/model_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- parameters ---- */

size_t palp_forward_parameter_count(const palp_model *model) {
    return model ? forward_effect_column(model, model->n_effects) : 0;
}

static palp_status are_effects_known(const palp_model *model) {
    bool fits = model->n_effects <= PALP_EFFECTS_MAX && model->material.n_arms <= PALP_ARMS_MAX;
    for (size_t i = 0; fits && i < model->n_effects; i++)
        fits = palp_effect_look_up(model->effects[i].id) != NULL;
    return fits ? PALP_OK : PALP_ERR_ARGUMENT;
}

palp_status palp_forward_get(const palp_model *model, double *parameter) {
    if (!model || !parameter)
        return PALP_ERR_ARGUMENT;
    const palp_law *law = &model->material.law;
    if (are_effects_known(model))
        return PALP_ERR_ARGUMENT;
    memcpy(parameter, law->coefficients, law->n * sizeof *parameter);
    parameter += law->n;
    for (size_t j = 0; j < model->material.n_arms; j++) {
        *parameter++ = model->material.arms[j].stiffness_N;
        *parameter++ = model->material.arms[j].viscosity_Ns;
    }
    for (size_t i = 0; i < model->n_effects; i++)
        for (size_t k = 0; k < palp_effect_look_up(model->effects[i].id)->n_parameters; k++)
            *parameter++ = model->effects[i].value[k];
    return PALP_OK;
}

palp_status palp_forward_set(palp_model *model, const double *parameter) {
    if (!model || !parameter)
        return PALP_ERR_ARGUMENT;
    palp_material made = model->material;
    palp_effect effects[PALP_EFFECTS_MAX];
    palp_status status = are_effects_known(model);
    if (!status)
        status = palp_law_set_coefficients(&made.law, parameter);
    if (status)
        return PALP_ERR_ARGUMENT;
    parameter += made.law.n;
    for (size_t j = 0; j < made.n_arms; j++) {
        made.arms[j].stiffness_N = *parameter++;
        made.arms[j].viscosity_Ns = *parameter++;
    }
    memcpy(effects, model->effects, sizeof effects);
    for (size_t i = 0; i < model->n_effects && !status; i++) {
        for (size_t k = 0; k < palp_effect_look_up(effects[i].id)->n_parameters; k++)
            effects[i].value[k] = *parameter++;
        status = palp_effect_check(&effects[i], NULL);
    }
    if (status || palp_material_check(&made, NULL))
        return PALP_ERR_ARGUMENT;
    model->material = made;
    memcpy(model->effects, effects, sizeof effects);
    return PALP_OK;
}

/* ---- the sensor ---- */

palp_status forward_sensor_create(const forward_plan *plan, size_t n_columns, double fastest,
                                  forward_sensor *s) {
    *s = (forward_sensor){.plan = plan, .n_columns = n_columns, .fastest = fastest};
    s->block = calloc((2 * plan->n_effects + 1) * n_columns + 1, sizeof *s->block);
    if (!s->block)
        return PALP_ERR_NO_MEMORY;
    s->force_p = s->block;
    for (size_t j = 0; j < plan->n_effects; j++) {
        s->stage[j].input_p = s->block + (2 * j + 1) * n_columns;
        s->stage[j].output_p = s->block + (2 * j + 2) * n_columns;
    }
    return PALP_OK;
}

void forward_sensor_free(forward_sensor *s) {
    free(s->block);
    *s = (forward_sensor){0};
}

double forward_sensor_read(forward_sensor *s, const effect_moment *moment, double force) {
    effect_moment at = *moment;
    at.fastest = s->fastest = fmax(s->fastest, fabs(at.velocity));
    for (size_t j = 0; j < s->plan->n_effects; j++) {
        const forward_effect *f = &s->plan->effect[j];
        forward_memory *m = &s->stage[j];
        effect_reading out = {.by_input = 1.0};
        if (!f->row->sensor)
            continue;
        f->row->sensor(f->effect->value, &at, force, m->input, m->output, &out);
        for (size_t k = 0; k < s->n_columns && !f->row->remembers; k++)
            s->force_p[k] *= out.by_input;
        for (size_t k = 0; k < s->n_columns && f->row->remembers; k++) {
            double input_p = s->force_p[k];
            s->force_p[k] = out.by_input * input_p + out.by_input_old * m->input_p[k] +
                            out.by_output_old * m->output_p[k];
            m->input_p[k] = input_p;
        }
        for (size_t k = 0; s->n_columns && k < f->row->info.n_parameters; k++)
            s->force_p[f->column + k] += out.by_value[k];
        if (f->row->remembers)
            memcpy(m->output_p, s->force_p, s->n_columns * sizeof *m->output_p);
        m->input = force;
        m->output = force = out.force;
    }
    return force;
}

/* ---- the run ---- */

static double mean_velocity_after_sample(const palp_forward_run *run, size_t i) {
    return (run->depth_m[i + 1] - run->depth_m[i]) / (run->time_s[i + 1] - run->time_s[i]);
}

/* Value at sample i of what is before at one neighbour and after at the other, or half way to each. */
static double interpolate_at_sample(const palp_forward_run *run, size_t i, double before, double after) {
    const double *t = run->time_s, share = (t[i] - t[i - 1]) / (t[i + 1] - t[i - 1]);
    return before + share * (after - before);
}

/* Velocity of the parabola through sample i and its neighbours. */
static double velocity_by_parabola(const palp_forward_run *run, size_t i) {
    return interpolate_at_sample(run, i, mean_velocity_after_sample(run, i - 1),
                                 mean_velocity_after_sample(run, i));
}

/* Corrects the parabola's velocity by those of both neighbours; for even samples this is the quartic through
 * five. The result stays between the velocities on both sides, so it does not overshoot where a path stops
 * abruptly. */
static double velocity_at_sample(const palp_forward_run *run, size_t i) {
    if (run->n < 2)
        return 0.0;
    if (i == 0 || i + 1 == run->n)
        return mean_velocity_after_sample(run, i ? i - 1 : 0);
    const double come = mean_velocity_after_sample(run, i - 1), go = mean_velocity_after_sample(run, i),
                 parabola = velocity_by_parabola(run, i);
    if (i == 1 || i + 2 == run->n)
        return parabola;
    const double around =
        interpolate_at_sample(run, i, velocity_by_parabola(run, i - 1), velocity_by_parabola(run, i + 1));
    return fmin(fmax(come, go), fmax(fmin(come, go), (4.0 * parabola - around) / 3.0));
}

/* Motion of the instrument at sample i: its velocity, and the acceleration of the parabola through the sample
 * and its neighbours, 0 at the ends. */
effect_moment forward_moment(const palp_forward_run *run, size_t i) {
    const double *t = run->time_s, *d = run->depth_m;
    effect_moment m = {.time = t[i],
                       .since = t[i] - t[0],
                       .depth = d[i],
                       .hum_phase = run->hum_phase,
                       .velocity = velocity_at_sample(run, i)};
    m.step = i ? t[i] - t[i - 1] : 0.0;
    if (i > 0 && i + 1 < run->n)
        m.acceleration = 2.0 * (mean_velocity_after_sample(run, i) - mean_velocity_after_sample(run, i - 1)) /
                         (t[i + 1] - t[i - 1]);
    return m;
}

double forward_fastest(const palp_forward_run *run) {
    double fastest = 0.0;
    for (size_t i = 0; i < run->n; i++)
        fastest = fmax(fastest, fabs(forward_moment(run, i).velocity));
    return fastest;
}

void forward_times(const palp_forward_run *run, double *shortest, double *whole) {
    *shortest = INFINITY;
    *whole = run->n ? run->time_s[run->n - 1] - run->time_s[0] : 0.0;
    for (size_t i = 1; i < run->n; i++)
        *shortest = fmin(*shortest, run->time_s[i] - run->time_s[i - 1]);
}

static double change_of_recorded_column(const palp_forward_run *run, const char *column, size_t i,
                                        double share) {
    for (size_t c = 0; column && c < run->n_columns; c++) {
        const double *v = run->column[c].value;
        if (strcmp(run->column[c].name, column) == 0)
            return (share < 1.0 ? v[i - 1] + (v[i] - v[i - 1]) * share : v[i]) - v[0];
    }
    return 0.0;
}

static forward_place recorded_place_at_share(const forward_plan *plan, const palp_forward_run *run, size_t i,
                                             double share, double velocity) {
    const double *t = run->time_s, *d = run->depth_m;
    forward_place place = {.time = share < 1.0 ? t[i - 1] + (t[i] - t[i - 1]) * share : t[i],
                           .depth = share < 1.0 ? d[i - 1] + (d[i] - d[i - 1]) * share : d[i],
                           .velocity = velocity};
    for (size_t j = 0; j < plan->n_effects; j++)
        place.change[j] = change_of_recorded_column(run, plan->effect[j].row->info.column, i, share);
    return place;
}

forward_place forward_place_at(const forward_plan *plan, const palp_forward_run *run, size_t i,
                               double share) {
    return recorded_place_at_share(plan, run, i, share, forward_moment(run, i).velocity);
}

palp_status forward_check_run(const palp_forward_run *run, palp_error *error) {
    for (size_t i = 0; i < run->n; i++)
        if (!isfinite(run->time_s[i]) || !isfinite(run->depth_m[i]) ||
            (i && !(run->time_s[i] > run->time_s[i - 1])))
            return palp_error_set(error, PALP_ERR_ARGUMENT,
                                  "sample %zu: times must increase, depths be finite", i);
    for (size_t c = 0; c < run->n_columns; c++)
        for (size_t i = 0; i < run->n; i++)
            if (!isfinite(run->column[c].value[i]))
                return palp_error_set(error, PALP_ERR_ARGUMENT, "sample %zu: %s is not finite", i,
                                      run->column[c].name);
    if (!isfinite(run->session_s) || !isfinite(run->hum_phase) || !isfinite(run->contact_m))
        return palp_error_set(error, PALP_ERR_ARGUMENT, "session_s, hum_phase or contact_m is not finite");
    return PALP_OK;
}

/* Moves the plate to sample i, in as many parts as the run requires. */
static palp_status move_plate_to_sample(forward_plate *plate, const palp_forward_run *run, size_t i,
                                        double velocity) {
    const size_t parts = i && run->parts > 1 ? run->parts : 1;
    palp_status status = PALP_OK;
    for (size_t k = 1; k <= parts && !status; k++) {
        const forward_place place =
            recorded_place_at_share(plate->plan, run, i, (double)k / (double)parts, velocity);
        status = i ? forward_plate_move(plate, &place) : forward_plate_start(plate, &place);
    }
    return status;
}

static palp_status follow_recorded_path(forward_plate *plate, forward_sensor *s, const palp_forward_run *run,
                                        double *force_N, double *gradient, palp_error *error) {
    for (size_t i = 0; i < run->n; i++) {
        effect_moment at = forward_moment(run, i);
        palp_status status = move_plate_to_sample(plate, run, i, at.velocity);
        if (status)
            return palp_error_set(error, status, "at %.6g s, depth %.6g mm: %s", run->time_s[i],
                                  1e3 * run->depth_m[i], palp_status_text(status));
        memcpy(s->force_p, plate->force_p, s->n_columns * sizeof *s->force_p);
        force_N[i] = forward_sensor_read(s, &at, plate->force + (run->added_N ? run->added_N[i] : 0.0));
        for (size_t k = 0; k < s->n_columns; k++)
            gradient[k * run->n + i] = s->force_p[k];
    }
    return PALP_OK;
}

palp_status forward_run(const forward_plan *plan, const forward_specimen *specimen,
                        const palp_forward_run *run, double *force_N, double *gradient, palp_error *error) {
    forward_plate plate;
    forward_sensor s;
    palp_status status = forward_check_run(run, error);
    if (status)
        return status;
    status = forward_plate_create(plan, specimen, &plate);
    if (!status) {
        status = forward_sensor_create(plan, specimen->n_columns, forward_fastest(run), &s);
        if (!status) {
            status = follow_recorded_path(&plate, &s, run, force_N, gradient, error);
            forward_sensor_free(&s);
        }
        forward_plate_free(&plate);
    }
    return status == PALP_ERR_NO_MEMORY ? palp_error_set(error, status, "out of memory") : status;
}

/* A force of 1 N, to which the gain is added, becomes the factor on all derivatives. */
static palp_status scale_gradient(const palp_free_term *gain, const palp_model *model,
                                  const palp_forward_run *run, size_t columns, double *gradient) {
    double *factor = malloc((run->n + 1) * sizeof *factor);
    if (!factor)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < run->n; i++)
        factor[i] = 1.0;
    palp_status status =
        palp_free_term_add(gain, run->n, run->time_s, run->depth_m, model->height_m, run->session_s, factor);
    for (size_t k = 0; k < columns && !status; k++)
        for (size_t i = 0; i < run->n; i++)
            gradient[k * run->n + i] *= factor[i];
    free(factor);
    return status;
}

palp_status forward_add_free(const palp_model *model, const palp_forward_run *run, size_t columns,
                             double *force_N, double *gradient) {
    palp_status status = PALP_OK;
    for (size_t i = 0; i < model->n_free && !status; i++) {
        const palp_free_term *t = &model->free_term[i];
        status = palp_free_term_add(t, run->n, run->time_s, run->depth_m, model->height_m, run->session_s,
                                    force_N);
        if (!status && gradient && palp_model_free_of_force(t->kind))
            status = scale_gradient(t, model, run, columns, gradient);
    }
    return status;
}

palp_status palp_forward_force(const palp_model *model, const palp_forward_run *run, double *force_N,
                               double *gradient, palp_error *error) {
    if (!model || !run || !force_N)
        return palp_error_null(error);
    forward_plan plan;
    forward_lumped *lumped;
    if (model->kind != PALP_MODEL_LUMPED)
        return palp_error_set(error, PALP_ERR_UNSUPPORTED,
                              "the model is a network; use palp_forward_network");
    palp_status status = forward_plan_make(model, run->session_s, &plan, error);
    if (status)
        return status;
    plan.contact = run->contact_m;
    double shortest, whole;
    forward_times(run, &shortest, &whole);
    status = forward_lumped_create(&plan, gradient ? plan.n_columns : 0, shortest, whole, &lumped);
    if (status)
        return palp_error_set(error, status, "out of memory");
    if (run->history)
        forward_lumped_take_history(lumped, run->history);
    forward_specimen specimen = forward_lumped_specimen(lumped);
    status = forward_run(&plan, &specimen, run, force_N, gradient, error);
    if (run->history && !status)
        forward_lumped_leave_history(lumped, run->history);
    forward_lumped_free(lumped);
    return status ? status : forward_add_free(model, run, plan.n_columns, force_N, gradient);
}
