/* explain_fit.c: a model in search coordinates, and its sums over the runs. */
#include "explain_internal.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double TURN = 6.28318530717958647692;

/* ---- coordinates ---- */

static void set_coordinate(explain_fit *fit, size_t k, double low, double high, double unit, bool logarithmic) {
    fit->logarithmic[k] = logarithmic;
    fit->low[k] = logarithmic ? log(low) : low;
    fit->high[k] = logarithmic ? log(high) : high;
    fit->unit[k] = unit;
}

/* Within what these runs can mean. */
static void set_effect(explain_fit *fit, size_t k, const effect_row *row, size_t p, const explain_data *data) {
    const palp_effect_parameter *q = &row->info.parameter[p];
    const effect_data facts = explain_facts(data);
    double low = q->low, high = q->high, unit = q->typical != 0.0 ? 300.0 * fabs(q->typical) : 10.0;
    if (q->scale == PALP_SCALE_TIME) {
        low = fmax(low, 1e-3);
        high = fmin(high, 20.0 * data->duration);
    }
    if (q->scale == PALP_SCALE_LENGTH) {
        low = fmax(low, -0.5 * data->deepest);
        high = fmin(high, 0.5 * data->deepest);
    }
    if (row->read && !row->missing(&facts)) {
        effect_read read;
        row->read(&facts, &read);
        low = high = read.value;
    }
    if (q->scale == PALP_SCALE_FORCE)
        unit = 30.0 * data->peak;
    set_coordinate(fit, k, low, high, q->logarithmic ? 5.0 : unit, q->logarithmic);
}

palp_status explain_fit_create(const palp_model *model, const explain_data *data, explain_fit *fit) {
    memset(fit, 0, sizeof *fit);
    fit->model = *model;
    fit->n_columns = palp_forward_parameter_count(model);
    fit->m = fit->n_columns + EXPLAIN_NUISANCES + 1;
    fit->product = calloc(data->n_runs * fit->m * fit->m, sizeof *fit->product);
    if (!fit->product)
        return PALP_ERR_NO_MEMORY;
    double stiffness = data->peak * data->height / data->deepest, strain = data->deepest / data->height;
    size_t k = 0;
    for (; k < model->material.law.n; k++) {
        bool plain = model->material.law.kind == PALP_LAW_POLYNOMIAL;
        double unit = plain ? 100.0 * stiffness / pow(strain, (double)k) : 100.0 * fabs(model->material.law.coefficients[k]);
        set_coordinate(fit, k, -HUGE_VAL, HUGE_VAL, unit + 1e-12, false);
    }
    for (size_t j = 0; j < model->material.n_arms; j++) {
        set_coordinate(fit, k++, 1e-4 * stiffness, 1e3 * stiffness, 5.0, true);
        set_coordinate(fit, k++, 1e-4, 1e3 * data->duration, 5.0, true);
    }
    for (size_t i = 0; i < model->n_effects; i++) {
        const effect_row *row = effect_row_of(model->effects[i].id);
        for (size_t p = 0; p < row->info.n_parameters; p++)
            set_effect(fit, k++, row, p, data);
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

palp_status explain_fit_beside(const explain_fit *base, const palp_model *model, const explain_data *data,
                               explain_fit *fit) {
    palp_status status = explain_fit_create(model, data, fit);
    fit->scatter = base->scatter;
    fit->hum_Hz = base->hum_Hz;
    fit->hum_N = base->hum_N;
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
    size_t bytes = n_runs * from->m * from->m * sizeof *to->product;
    *to = *from;
    to->product = malloc(bytes);
    if (!to->product)
        return PALP_ERR_NO_MEMORY;
    memcpy(to->product, from->product, bytes);
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

/* The model with a contact offset and a gain, if need be at zero: a run's own contact and gain are theirs. */
static palp_status augment(const palp_model *model, palp_model *full, size_t *offset, size_t *gain) {
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

static void chain(const explain_fit *fit, size_t n, double *gradient) {
    const palp_material *m = &fit->model.material;
    for (size_t j = 0; j < m->n_arms; j++) {
        double *k = gradient + (m->law.n + 2 * j) * n, *b = k + n;
        for (size_t i = 0; i < n; i++) {
            b[i] *= m->arms[j].viscosity_Ns;
            k[i] = k[i] * m->arms[j].stiffness_N + b[i];
        }
    }
    for (size_t k = m->law.n + 2 * m->n_arms; k < fit->n_columns; k++)
        if (fit->logarithmic[k])
            for (size_t i = 0; i < n; i++)
                gradient[k * n + i] *= exp(fit->x[k]);
}

static void hum_columns(const explain_fit *fit, const explain_run *run, double *sine, double *cosine) {
    for (size_t i = 0; i < run->n; i++) {
        double turn = TURN * fit->hum_Hz * run->time[i];
        sine[i] = fit->hum_Hz > 0.0 ? sin(turn) : 0.0;
        cosine[i] = fit->hum_Hz > 0.0 ? cos(turn) : 0.0;
    }
}

/* work: [(n_columns + 3 parameters and more) n] */
static palp_status run_products(explain_fit *fit, const explain_run *run, const palp_forward_run *path,
                                const palp_model *full, size_t offset, size_t gain, double *force, double *gradient,
                                double *column, double *product) {
    size_t n = run->n, k = fit->n_columns, m = fit->m;
    palp_status status = explain_predict(full, path, force, gradient, NULL);
    if (status)
        return status;
    double *own = column + k * n;
    memcpy(own + n, gradient + offset * n, n * sizeof *own);
    memcpy(own + 2 * n, gradient + gain * n, n * sizeof *own);
    chain(fit, n, gradient);
    memcpy(column, gradient, k * n * sizeof *column);
    for (size_t i = 0; i < n; i++)
        own[i] = 1.0;
    hum_columns(fit, run, own + 3 * n, own + 4 * n);
    double *y = own + EXPLAIN_NUISANCES * n;
    for (size_t i = 0; i < n; i++)
        y[i] = run->force[i] - force[i];
    for (size_t j = 0; j < m; j++)
        explain_whiten(run, column + j * n);
    dense_transposed_product(m, m, n, column, column, product);
    return PALP_OK;
}

double explain_fit_score(const explain_fit *fit, const explain_data *data) {
    double sum = 0.0;
    for (size_t r = 0; r < data->n_runs; r++) {
        double chi2, logdet;
        if (data->run[r].held_out)
            continue;
        explain_normal_of(fit, r, NULL, NULL, &chi2, &logdet);
        sum -= 0.5 * (chi2 + logdet);
    }
    return sum;
}

palp_status explain_fit_products(explain_fit *fit, const explain_data *data, double *force) {
    palp_model *full = malloc(sizeof *full);
    size_t offset, gain;
    palp_status status = full ? augment(&fit->model, full, &offset, &gain) : PALP_ERR_NO_MEMORY;
    if (status) {
        free(full);
        return status;
    }
    size_t columns = palp_forward_parameter_count(full), n = data->longest;
    double *work = malloc((1 + columns + fit->m) * n * sizeof *work);
    status = work ? PALP_OK : PALP_ERR_NO_MEMORY;
    explain_wear wear = {.wear.peak = 0.0};
    for (size_t r = 0; r < data->n_runs && !status; r++) {
        palp_forward_run path = explain_forward_run(&data->run[r], &wear);
        status = run_products(fit, &data->run[r], &path, full, offset, gain, work, work + n, work + (1 + columns) * n,
                              fit->product + r * fit->m * fit->m);
        if (force && !status) {
            memcpy(force, work, data->run[r].n * sizeof *force);
            force += data->run[r].n;
        }
    }
    palp_forward_wear_free(&wear.wear);
    free(work);
    free(full);
    if (!status)
        fit->score = explain_fit_score(fit, data);
    return status;
}

/* ---- a run's nuisance parameters, eliminated ---- */

static void nuisance_sd(const explain_fit *fit, double sd[EXPLAIN_NUISANCES]) {
    const explain_scatter *s = &fit->scatter;
    double share = 1.0 / fmax(1.0, s->misfit);
    double all[EXPLAIN_NUISANCES] = {share * s->zero, share * s->contact, share * s->gain, fit->hum_N, fit->hum_N};
    memcpy(sd, all, sizeof all);
}

/* Factor of 1 + S N'N S. */
static void nuisance_factor(const explain_fit *fit, size_t r, const double *sd, double *factor) {
    const double *g = fit->product + r * fit->m * fit->m;
    size_t k = fit->n_columns;
    for (size_t i = 0; i < EXPLAIN_NUISANCES; i++)
        for (size_t j = 0; j < EXPLAIN_NUISANCES; j++)
            factor[i * EXPLAIN_NUISANCES + j] = (i == j) + sd[i] * g[(k + i) * fit->m + k + j] * sd[j];
    dense_cholesky(EXPLAIN_NUISANCES, factor);
}

void explain_normal_of(const explain_fit *fit, size_t r, double *h, double *g, double *chi2, double *logdet) {
    enum { Q = EXPLAIN_NUISANCES };
    const double *product = fit->product + r * fit->m * fit->m;
    size_t k = fit->n_columns, m = fit->m, first = h ? 0 : k;
    double sd[Q], factor[Q * Q], z[EXPLAIN_COLUMNS + 1][Q];
    nuisance_sd(fit, sd);
    nuisance_factor(fit, r, sd, factor);
    *logdet = dense_log_determinant(Q, factor);
    for (size_t c = first; c <= k; c++) { /* factor^-1 S N' of each column, the last: y */
        size_t at = c < k ? c : m - 1;
        for (size_t i = 0; i < Q; i++)
            z[c][i] = sd[i] * product[at * m + k + i];
    }
    dense_forward(Q, factor, k + 1 - first, z[first]);
    *chi2 = product[(m - 1) * m + m - 1];
    for (size_t i = 0; i < Q; i++)
        *chi2 -= z[k][i] * z[k][i];
    for (size_t a = 0; h && a < k; a++) {
        g[a] = product[a * m + m - 1];
        for (size_t i = 0; i < Q; i++)
            g[a] -= z[a][i] * z[k][i];
        for (size_t b = 0; b <= a; b++) {
            double sum = product[a * m + b];
            for (size_t i = 0; i < Q; i++)
                sum -= z[a][i] * z[b][i];
            h[a * k + b] = h[b * k + a] = sum;
        }
    }
}

void explain_nuisances(const explain_fit *fit, size_t r, double own[EXPLAIN_NUISANCES], double sd_out[EXPLAIN_NUISANCES]) {
    enum { Q = EXPLAIN_NUISANCES };
    double sd[Q], factor[Q * Q];
    const double *product = fit->product + r * fit->m * fit->m;
    nuisance_sd(fit, sd);
    nuisance_factor(fit, r, sd, factor);
    for (size_t i = 0; i < Q; i++)
        own[i] = sd[i] * product[(fit->m - 1) * fit->m + fit->n_columns + i];
    dense_cholesky_solve(Q, factor, 1, own);
    for (size_t i = 0; i < Q; i++) {
        double unit[Q] = {0};
        unit[i] = 1.0;
        dense_cholesky_solve(Q, factor, 1, unit);
        own[i] *= sd[i];
        sd_out[i] = sd[i] * sqrt(unit[i]);
    }
}

double explain_chi2(const explain_data *data, const explain_fit *fit) {
    double sum = 0.0, chi2, logdet;
    for (size_t r = 0; r < data->n_runs; r++) {
        if (data->run[r].held_out)
            continue;
        explain_normal_of(fit, r, NULL, NULL, &chi2, &logdet);
        sum += chi2;
    }
    return sum / (double)explain_samples(data);
}

/* Never far beyond the expectation, or of gain what replicates show: a model's own faults are not scatter. */
void explain_fit_scatter(explain_fit *fit, const explain_data *data, const palp_explain_settings *settings) {
    enum { TRUST = 6, ROUNDS = 20 }; /* the expectation counts as so many runs */
    double white = 0.0;
    for (size_t r = 0; r < data->n_runs; r++)
        white += data->run[r].white / (double)data->n_runs;
    double expected[3] = {0.3 * white, settings->contact_scatter_m, settings->repeatability};
    double most[3] = {fmax(2.0 * expected[0], 1.5 * data->zero_scatter), 2.0 * expected[1],
                      fmax(2.0 * expected[2], 1.5 * data->replicate_gain)};
    double *scatter[3] = {&fit->scatter.zero, &fit->scatter.contact, &fit->scatter.gain};
    for (int i = 0; i < 3; i++)
        *scatter[i] = *scatter[i] > 0.0 ? *scatter[i] : expected[i];
    for (int round = 0; round < ROUNDS; round++) {
        double sum[3], count = TRUST;
        for (int i = 0; i < 3; i++)
            sum[i] = TRUST * expected[i] * expected[i];
        for (size_t r = 0; r < data->n_runs; r++) {
            double own[EXPLAIN_NUISANCES], sd[EXPLAIN_NUISANCES];
            if (data->run[r].held_out)
                continue;
            explain_nuisances(fit, r, own, sd);
            count += 1.0;
            for (int i = 0; i < 3; i++)
                sum[i] += own[i] * own[i] + sd[i] * sd[i];
        }
        for (int i = 0; i < 3; i++)
            *scatter[i] = fmin(sqrt(sum[i] / count), most[i]);
        fit->scatter.misfit = sqrt(fmax(1.0, explain_chi2(data, fit)));
    }
    fit->score = explain_fit_score(fit, data);
    for (int i = 0; i < 3; i++) { /* what scatter beyond the expected costs */
        double ratio = expected[i] / *scatter[i];
        fit->score -= 0.5 * TRUST * (ratio * ratio - 1.0 - 2.0 * log(ratio));
    }
}
