/* explain_fit.c: a model in search coordinates, and its sums over the runs. */
#include "explain_fit.h"
#include "explain_noise.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double TURN = 6.28318530717958647692;

/* ---- coordinates ---- */

static void set_coordinate(explain_fit *fit, size_t k, double low, double high, double unit,
                           bool logarithmic) {
    fit->logarithmic[k] = logarithmic;
    fit->low[k] = logarithmic ? log(low) : low;
    fit->high[k] = logarithmic ? log(high) : high;
    fit->unit[k] = unit;
}

/* How large a parameter of that kind these runs let one expect. */
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

bool explain_is_period(const effect_row *row, size_t p) {
    return row->scanned > 0.0 && row->info.parameter[p].scale == PALP_SCALE_LENGTH;
}

/* Within what these runs can mean. value: the model's; one that is read off the data stays there. */
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
        if (explain_is_period(row, p)) { /* two samples at least, and some in the travel */
            high = size / EXPLAIN_PERIODS;
            low = fmin(2.0 * data->stride, 0.5 * high);
        }
    }
    if (q->scale ==
        PALP_SCALE_STRAIN_RATE) { /* some run is faster; it may be far below all of them, as a dwell tells */
        low = 1e-6 * size;
        high = size;
    }
    if (q->scale == PALP_SCALE_RATE) { /* so that a factor of it and the session stays above zero */
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
    fit->m = fit->n_columns + EXPLAIN_NUISANCES + 1;
    fit->product = calloc(data->n_runs * (fit->m * fit->m + 2), sizeof *fit->product);
    if (!fit->product)
        return PALP_ERR_NO_MEMORY;
    fit->contact = fit->product + data->n_runs * fit->m * fit->m;
    fit->gain = fit->contact + data->n_runs;
    double stiffness = data->peak * data->height / data->deepest, strain = data->deepest / data->height;
    size_t k = 0;
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

void explain_add_gain(palp_model *model, double gain) {
    size_t i = 0;
    while (i < model->n_effects && model->effects[i].id != PALP_EFFECT_SENSOR_GAIN)
        i++;
    if (i == PALP_EFFECTS_MAX)
        return;
    if (i == model->n_effects)
        palp_effect_default(PALP_EFFECT_SENSOR_GAIN, &model->effects[model->n_effects++]);
    model->effects[i].value[0] += gain;
}

palp_status explain_fit_beside(const explain_fit *base, const palp_model *model, const explain_data *data,
                               explain_fit *fit) {
    palp_status status = explain_fit_create(model, data, fit);
    for (size_t r = 0; r < data->n_runs && !status; r++) {
        double own[EXPLAIN_NUISANCES], sd[EXPLAIN_NUISANCES];
        explain_nuisances(base, r, own, sd);
        fit->contact[r] = base->contact[r];
        fit->gain[r] = explain_bends(model) ? fmin(0.5, fmax(-0.5, own[2])) : 0.0;
    }
    fit->scatter = base->scatter;
    fit->hum_Hz = base->hum_Hz;
    fit->hum_N = base->hum_N;
    fit->renewed = base->renewed;
    return status;
}

size_t explain_first_column(const palp_model *model, size_t i) {
    size_t at = model->material.law.n + 2 * model->material.n_arms;
    for (size_t j = 0; j < i; j++)
        at += palp_effect_look_up(model->effects[j].id)->n_parameters;
    return at;
}

void explain_fit_free(explain_fit *fit) {
    free(fit->product);
    memset(fit, 0, sizeof *fit);
}

palp_status explain_fit_copy(const explain_fit *from, size_t n_runs, explain_fit *to) {
    size_t bytes = n_runs * (from->m * from->m + 2) * sizeof *to->product;
    *to = *from;
    to->spread = NULL;
    to->product = malloc(bytes);
    if (!to->product)
        return PALP_ERR_NO_MEMORY;
    memcpy(to->product, from->product, bytes);
    to->contact = to->product + n_runs * from->m * from->m;
    to->gain = to->contact + n_runs;
    return PALP_OK;
}

palp_status explain_fit_to_model(explain_fit *fit) {
    double value[EXPLAIN_COLUMNS];
    for (size_t k = 0; k < fit->n_columns; k++)
        value[k] = fit->logarithmic[k] ? exp(fit->x[k]) : fit->x[k];
    for (size_t j = 0; j < fit->model.material.n_arms; j++)
        value[fit->model.material.law.n + 2 * j + 1] *= value[fit->model.material.law.n + 2 * j];
    return palp_forward_set(&fit->model, value);
}

/* ---- sums ---- */

palp_status explain_augment(const palp_model *model, palp_model *full, size_t *offset, size_t *gain) {
    static const palp_effect_id own[2] = {PALP_EFFECT_CONTACT_OFFSET, PALP_EFFECT_SENSOR_GAIN};
    size_t found[2];
    *full = *model;
    for (int k = 0; k < 2; k++) {
        size_t i = 0;
        while (i < full->n_effects && full->effects[i].id != own[k])
            i++;
        if (i == PALP_EFFECTS_MAX)
            return PALP_ERR_LIMIT;
        if (i == full->n_effects)
            palp_effect_default(own[k], &full->effects[full->n_effects++]);
        found[k] = explain_first_column(full, i);
    }
    *offset = found[0];
    *gain = found[1];
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

static void hum_columns(const explain_fit *fit, const explain_run *run, double *sine, double *cosine) {
    for (size_t i = 0; i < run->n; i++) {
        double turn = TURN * fit->hum_Hz * run->time[i];
        sine[i] = fit->hum_Hz > 0.0 ? sin(turn) : 0.0;
        cosine[i] = fit->hum_Hz > 0.0 ? cos(turn) : 0.0;
    }
}

/* By how much the run's force grows as its specimen's law does: every law is so many times stiffer as its
 * coefficients together are, of Ogden's as those before each exponent. */
static void law_column(const palp_law *law, size_t n, const double *gradient, double *column) {
    memset(column, 0, n * sizeof *column);
    for (size_t k = 0; k < law->n; k += law->kind == PALP_LAW_OGDEN ? 2 : 1)
        for (size_t i = 0; i < n; i++)
            column[i] += law->coefficients[k] * gradient[k * n + i];
}

/* The run's surface is at contact and its gain at own_gain; its residual as if they were where the model has
 * them, so that its contact and its gain as a whole have the scatter of all. work: [(n_columns + 3 parameters
 * and more) n] */
static palp_status run_products(explain_fit *fit, const explain_run *run, const palp_forward_run *path,
                                const palp_model *full, double own_gain, size_t offset, size_t gain,
                                double *force, double *gradient, double *column, double *product) {
    size_t n = run->n, k = fit->n_columns, m = fit->m;
    palp_status status = explain_predict(full, path, force, gradient, NULL);
    if (status)
        return status;
    double *own = column + k * n;
    memcpy(own + n, gradient + offset * n, n * sizeof *own);
    memcpy(own + 2 * n, gradient + gain * n, n * sizeof *own);
    explain_chain(fit, n, gradient);
    memcpy(column, gradient, k * n * sizeof *column);
    for (size_t i = 0; i < n; i++)
        own[i] = 1.0;
    hum_columns(fit, run, own + 3 * n, own + 4 * n);
    law_column(&fit->model.material.law, n, gradient, own + 5 * n);
    double *y = own + EXPLAIN_NUISANCES * n;
    for (size_t i = 0; i < n; i++)
        y[i] = run->force[i] - force[i] + path->contact_m * own[n + i] + own_gain * own[2 * n + i];
    explain_whiten(run, m, column);
    dense_transposed_product(m, m, n, column, column, product);
    return PALP_OK;
}

/* What the model's force and run r's nuisance parameters leave; contact, gain and law: columns [n]. */
static void find_residual(const explain_fit *fit, const explain_run *run, size_t r, const double *force,
                          const double *contact, const double *gain, const double *law, double *residual) {
    double own[EXPLAIN_NUISANCES], sd[EXPLAIN_NUISANCES];
    explain_nuisances(fit, r, own, sd);
    for (size_t i = 0; i < run->n; i++) {
        double turn = TURN * fit->hum_Hz * run->time[i];
        double more = own[0] + (own[1] - fit->contact[r]) * contact[i] + (own[2] - fit->gain[r]) * gain[i] +
                      own[5] * law[i];
        if (fit->hum_Hz > 0.0)
            more += own[3] * sin(turn) + own[4] * cos(turn);
        residual[i] = run->use[i] ? run->force[i] - force[i] - more : 0.0;
    }
}

/* A fit's products; its runs in chains, each by one task. */
typedef struct evaluation {
    explain_fit *fit;
    const explain_data *data;
    palp_model full;
    size_t columns, offset, gain; /* of full: how many, and where a run's own contact and gain are */
    double *force, *residual;     /* NULL, or [n] */
    explain_visit *visit;
    void *user;
    bool together, remembers; /* all runs one after the other; a specimen keeps something from run to run */
    palp_status *status;      /* [n_runs] */
} evaluation;

/* work: [2 + columns + m, n] */
static palp_status evaluate_run(const evaluation *e, size_t r, explain_history *history, double *work) {
    const explain_run *run = &e->data->run[r];
    const size_t n = run->n, m = e->fit->m;
    double *gradient = work + n, *column = gradient + e->columns * n, *law = column + m * n;
    const palp_law *of = &e->fit->model.material.law;
    palp_forward_run path = explain_forward_run(run, e->fit->contact[r], history);
    palp_model full = e->full;
    explain_add_gain(&full, e->fit->gain[r]);
    palp_status status = run_products(e->fit, run, &path, &full, e->fit->gain[r], e->offset, e->gain, work,
                                      gradient, column, e->fit->product + r * m * m);
    size_t at = 0;
    for (size_t i = 0; i < r; i++)
        at += e->data->run[i].n;
    if (e->visit && !status)
        e->visit(e->user, r, column);
    if (e->force && !status)
        memcpy(e->force + at, work, n * sizeof *work);
    if (e->residual && !status) {
        law_column(of, n, gradient, law);
        find_residual(e->fit, run, r, work, gradient + n * e->offset, gradient + n * e->gain, law,
                      e->residual + at);
    }
    return status;
}

/* Whether run r is in a chain that begins with an earlier one. */
static bool follows(const evaluation *e, size_t r) {
    return r > 0 && (e->together || (e->remembers && !e->fit->renewed && !e->data->run[r].fresh));
}

static void chain_task(void *user, size_t first) {
    const evaluation *e = user;
    palp_status *status = &e->status[first];
    if (follows(e, first))
        return;
    double *work = malloc((2 + e->columns + e->fit->m) * e->data->longest * sizeof *work);
    explain_history history = {.renewed = e->fit->renewed};
    *status = work ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t r = first; r < e->data->n_runs && !*status && (r == first || follows(e, r)); r++)
        *status = evaluate_run(e, r, &history, work);
    palp_load_history_free(&history.load);
    free(work);
}

static palp_status evaluate(explain_fit *fit, const explain_data *data, double *force, double *residual,
                            explain_visit *visit, void *user) {
    static const palp_explain_settings alone = {.loop = NULL};
    const bool spreads = fit->spread && fit->spread->loop && !visit;
    evaluation e = {.fit = fit,
                    .data = data,
                    .force = force,
                    .residual = residual,
                    .visit = visit,
                    .user = user,
                    .together = !spreads};
    palp_status status = explain_augment(&fit->model, &e.full, &e.offset, &e.gain);
    if (status)
        return status;
    e.columns = palp_forward_parameter_count(&e.full);
    for (size_t i = 0; i < e.full.n_effects; i++)
        e.remembers = e.remembers || effect_row_of(e.full.effects[i].id)->history;
    e.status = calloc(data->n_runs, sizeof *e.status);
    if (!e.status)
        return PALP_ERR_NO_MEMORY;
    status = explain_each(spreads ? fit->spread : &alone, data->n_runs, chain_task, &e, e.status);
    free(e.status);
    if (!status)
        fit->score = explain_fit_score(fit, data);
    return status;
}

palp_status explain_fit_evaluate(explain_fit *fit, const explain_data *data, double *force,
                                 double *residual) {
    return evaluate(fit, data, force, residual, NULL, NULL);
}

palp_status explain_fit_visit(explain_fit *fit, const explain_data *data, double *force, double *residual,
                              explain_visit *visit, void *user) {
    return evaluate(fit, data, force, residual, visit, user);
}

palp_status explain_fit_products(explain_fit *fit, const explain_data *data, double *force) {
    return explain_fit_evaluate(fit, data, force, NULL);
}
