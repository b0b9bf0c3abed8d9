/* explain_fit.c: a model in search coordinates. */
#include "explain_fit.h"
#include "explain_lines.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static void set_coordinate(explain_fit *fit, size_t k, double low, double high, double unit,
                           bool logarithmic) {
    fit->logarithmic[k] = logarithmic;
    fit->low[k] = logarithmic ? log(low) : low;
    fit->high[k] = logarithmic ? log(high) : high;
    fit->unit[k] = unit;
}

/* The expected size of a parameter of that kind for these runs. */
static double size_of(palp_effect_scale scale, const explain_data *data) {
    switch (scale) {
    case PALP_SCALE_TIME:
        return data->duration;
    case PALP_SCALE_LENGTH:
        return data->deepest;
    case PALP_SCALE_FORCE:
        return data->peak;
    case PALP_SCALE_FORCE_1_S:
        return data->peak * fmax(1.0, data->duration);
    case PALP_SCALE_FORCE_RATE:
        return data->peak / data->duration;
    case PALP_SCALE_COMPLIANCE:
        return data->deepest / data->peak;
    case PALP_SCALE_MASS:
        return data->peak * data->duration * data->duration / data->deepest;
    case PALP_SCALE_RATE:
        return 1.0 / data->span;
    case PALP_SCALE_STRAIN_RATE:
        return data->fastest / data->height;
    case PALP_SCALE_NONE:
        break;
    }
    return 1.0;
}

/* The period of a wave over depth has ends on both sides in the runs' samples and travel. */
static bool is_period(const effect_row *row, size_t p) {
    return row->scanned > 0.0 && row->info.parameter[p].scale == PALP_SCALE_LENGTH;
}

/* Limits the value to the range that these runs can show. value: the model's; one taken from the data stays
 * there. */
static void set_effect(explain_fit *fit, size_t k, const effect_row *row, size_t p, double value,
                       const explain_data *data) {
    const palp_effect_parameter *q = &row->info.parameter[p];
    const effect_data facts = explain_facts(data);
    double low = q->low, high = q->high, size = size_of(q->scale, data), unit = 30.0 * size;
    if (q->scale == PALP_SCALE_NONE)
        unit = q->typical != 0.0 ? 300.0 * fabs(q->typical) : 10.0;
    if (q->scale == PALP_SCALE_TIME) {
        low = fmax(low, q->logarithmic ? 0.03 * data->step : 0.0);
        high = fmin(high, 20.0 * size);
    }
    if (q->scale == PALP_SCALE_LENGTH) {
        low = q->logarithmic ? 1e-3 * size : fmax(low, -0.5 * size);
        high = q->logarithmic ? 10.0 * size : fmin(high, 0.5 * size);
        if (is_period(row, p)) { /* two samples at least, and some in the travel */
            high = size / EXPLAIN_PERIODS;
            low = fmin(2.0 * data->stride, 0.5 * high);
        }
    }
    if (q->scale == PALP_SCALE_STRAIN_RATE) { /* some run is faster; it may be far below all speeds, as a
                                                 dwell shows it */
        low = 1e-6 * size;
        high = size;
    }
    if (q->scale == PALP_SCALE_RATE) { /* so that a factor of it and of the session stays positive */
        low = fmax(low, -0.9 * size);
        high = fmin(high, 1e3 * size);
    }
    effect_read read;
    if (p == 0 && row->read && row->read(&facts, &read))
        low = high = fmin(read.high, fmax(read.low, value));
    set_coordinate(fit, k, low, high, q->logarithmic ? 5.0 : unit, q->logarithmic);
}

palp_status explain_fit_create(const palp_model *model, const explain_data *data, explain_fit *fit) {
    memset(fit, 0, sizeof *fit);
    fit->model = *model;
    fit->n_columns = palp_forward_parameter_count(model);
    fit->contact = calloc(3 * data->n_runs, sizeof *fit->contact);
    if (!fit->contact)
        return PALP_ERR_NO_MEMORY;
    fit->gain = fit->contact + data->n_runs;
    fit->zero = fit->gain + data->n_runs;
    double stiffness = data->peak * data->height / data->deepest, strain = data->deepest / data->height;
    size_t k = 0;
    if (data->law_alone) {
        fit->softest = EXPLAIN_SOFTEST * stiffness;
        fit->strain = strain;
    }
    for (; k < model->material.law.n; k++) {
        const bool plain = model->material.law.kind == PALP_LAW_POLYNOMIAL,
                   spline = model->material.law.kind == PALP_LAW_SPLINE;
        double unit = plain ? 100.0 * stiffness / pow(strain, (double)k)
                            : 100.0 * fabs(model->material.law.coefficients[k]);
        set_coordinate(fit, k, spline ? EXPLAIN_SOFTEST * stiffness : -HUGE_VAL, HUGE_VAL,
                       unit + 1e-9 * stiffness, false);
    }
    for (size_t j = 0; j < model->material.n_arms; j++) {
        set_coordinate(fit, k++, 1e-4 * stiffness * (model->material.quasi_linear ? EXPLAIN_SOFTEST : 1.0),
                       1e3 * stiffness, 5.0, true);
        set_coordinate(fit, k++, 0.003 * data->step, 1e3 * data->duration, 5.0, true);
    }
    for (size_t i = 0; i < model->n_effects; i++) {
        const effect_row *row = effect_row_of(model->effects[i].id);
        for (size_t p = 0; p < row->info.n_parameters; p++)
            set_effect(fit, k++, row, p, model->effects[i].value[p], data);
    }
    double value[EXPLAIN_COLUMNS];
    palp_forward_get(model, value);
    for (size_t j = 0; j < model->material.n_arms; j++) /* viscosity to time */
        value[model->material.law.n + 2 * j + 1] /= value[model->material.law.n + 2 * j];
    for (k = 0; k < fit->n_columns; k++) {
        fit->x[k] = fit->logarithmic[k] ? log(value[k]) : value[k];
        if (data->simulated && k < model->material.law.n + 2 * model->material.n_arms)
            fit->low[k] = fit->high[k] = fit->x[k]; /* it is not fitted */
        fit->x[k] = fmin(fit->high[k], fmax(fit->low[k], fit->x[k]));
    }
    return PALP_OK;
}

bool explain_bends(const palp_model *model) {
    bool any = false;
    for (size_t i = 0; i < model->n_effects; i++)
        any = any || effect_row_of(model->effects[i].id)->bends;
    return any;
}

void explain_add_own(palp_model *model, double gain, double zero) {
    for (size_t i = 0; i < model->n_effects; i++)
        model->effects[i].value[0] += model->effects[i].id == PALP_EFFECT_SENSOR_GAIN   ? gain
                                      : model->effects[i].id == PALP_EFFECT_SENSOR_BIAS ? zero
                                                                                        : 0.0;
}

size_t explain_first_column(const palp_model *model, size_t i) {
    size_t at = model->material.law.n + 2 * model->material.n_arms;
    for (size_t j = 0; j < i; j++)
        at += palp_effect_look_up(model->effects[j].id)->n_parameters;
    return at;
}

void explain_fit_free(explain_fit *fit) {
    free(fit->contact);
    memset(fit, 0, sizeof *fit);
}

palp_status explain_fit_copy(const explain_fit *from, size_t n_runs, explain_fit *to) {
    const size_t bytes = 3 * n_runs * sizeof *to->contact;
    *to = *from;
    to->contact = malloc(bytes);
    if (!to->contact)
        return PALP_ERR_NO_MEMORY;
    memcpy(to->contact, from->contact, bytes);
    to->gain = to->contact + n_runs;
    to->zero = to->gain + n_runs;
    return PALP_OK;
}

bool explain_is_stiff(const explain_fit *fit, const palp_law *law) {
    return !(fit->softest > 0.0) || law->kind == PALP_LAW_SPLINE ||
           palp_law_minimum(law, fit->strain) >= fit->softest;
}

palp_status explain_fit_to_model(explain_fit *fit) {
    double value[EXPLAIN_COLUMNS];
    for (size_t k = 0; k < fit->n_columns; k++)
        value[k] = fit->logarithmic[k] ? exp(fit->x[k]) : fit->x[k];
    for (size_t j = 0; j < fit->model.material.n_arms; j++)
        value[fit->model.material.law.n + 2 * j + 1] *= value[fit->model.material.law.n + 2 * j];
    palp_status status = palp_forward_set(&fit->model, value);
    return status || explain_is_stiff(fit, &fit->model.material.law) ? status : PALP_ERR_NOT_CONVERGED;
}

palp_status explain_augment(const palp_model *model, palp_model *full, size_t column[EXPLAIN_BY]) {
    static const palp_effect_id own[EXPLAIN_BY] = {PALP_EFFECT_CONTACT_OFFSET, PALP_EFFECT_SENSOR_GAIN,
                                                   PALP_EFFECT_SENSOR_BIAS};
    const bool bends = explain_bends(model);
    *full = *model;
    for (int k = 0; k < EXPLAIN_BY; k++) {
        size_t i = 0;
        column[k] = SIZE_MAX;
        while (i < full->n_effects && full->effects[i].id != own[k])
            i++;
        if (k == EXPLAIN_BY_ZERO && (!bends || i == PALP_EFFECTS_MAX))
            break;
        if (i == PALP_EFFECTS_MAX)
            return PALP_ERR_LIMIT;
        if (i == full->n_effects)
            palp_effect_default(own[k], &full->effects[full->n_effects++]);
        column[k] = explain_first_column(full, i);
    }
    return PALP_OK;
}

void explain_chain(const explain_fit *fit, size_t n, double *gradient) {
    const palp_material *m = &fit->model.material;
    for (size_t j = 0; j < m->n_arms; j++) {
        double *k = gradient + (m->law.n + 2 * j) * n, *b = k + n;
        for (size_t i = 0; i < n; i++) {
            b[i] *= m->arms[j].viscosity_Ns;
            k[i] = k[i] * m->arms[j].stiffness_N + b[i];
        }
    }
    for (size_t k = 0; k < fit->n_columns; k++) {
        const bool arm = k >= m->law.n && k < m->law.n + 2 * m->n_arms;
        for (size_t i = 0; i < n && fit->logarithmic[k] && !arm; i++)
            gradient[k * n + i] *= exp(fit->x[k]);
    }
}
