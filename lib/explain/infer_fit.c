/* infer_fit.c: a model in search coordinates with its columns. */
#include "infer_internal.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double TURN = 6.28318530717958647692;
static const double WIDE = 3.0;   /* prior sd of a logarithm: a factor of 20 */
static const double FIXED = 1e-6; /* and of one that is fixed: below the accuracy of any run */

palp_status infer_spline_of(const palp_law *law, size_t knots, double deepest, palp_law *spline) {
    double strain[PALP_LAW_MAX], stiffness[PALP_LAW_MAX], typical;
    palp_law_stiffness(law, deepest, &typical, NULL);
    for (size_t i = 0; i < knots; i++) {
        strain[i] = deepest * (double)i / (double)(knots - 1);
        palp_law_stiffness(law, strain[i], &stiffness[i], NULL);
        stiffness[i] = fmax(stiffness[i], 1e-3 * fabs(typical));
    }
    return palp_law_spline(knots, strain, stiffness, spline);
}

/* A bond's parameters are evaluated on a grid over their whole posterior. */
static void open_bond(infer_fit *fit, const explain_data *data, const effect_row *row, size_t p, size_t a) {
    const double hidden =
        data->run[0].white / sqrt((double)explain_samples(data)) * data->deepest / data->peak;
    const effect_data facts = explain_facts(data);
    effect_read read;
    if (p == 0 && row->read && row->read(&facts, &read)) {
        fit->c.low[a] = read.low;
        fit->c.high[a] = read.high;
    }
    if (row->info.parameter[p].scale == PALP_SCALE_LENGTH && fit->c.logarithmic[a])
        fit->c.low[a] = fmin(fit->c.low[a], log(hidden));
}

static void set_priors(infer_fit *fit, const explain_data *data) {
    const palp_material *m = &fit->c.model.material;
    const bool spline = m->law.kind == PALP_LAW_SPLINE;
    const size_t effects = m->law.n + 2 * m->n_arms;
    for (size_t a = 0; a < fit->k; a++) {
        fit->given[a] = fit->c.x[a];
        fit->width[a] = fit->c.logarithmic[a] || a >= effects ? WIDE : fit->c.unit[a];
    }
    for (size_t a = m->law.n + 1; a < effects && data->times_fixed; a += 2) {
        fit->c.low[a] = fit->c.high[a] = fit->c.x[a];
        fit->width[a] = FIXED;
    }
    double typical = 0.0; /* the prior is a constant law, whatever the bends of the given model */
    for (size_t a = 0; a < m->law.n && spline; a++)
        typical += log(m->law.coefficients[a]) / (double)m->law.n;
    for (size_t a = 0; a < m->law.n && spline; a++) {
        fit->c.logarithmic[a] = true;
        fit->c.x[a] = log(m->law.coefficients[a]);
        fit->given[a] = data->simulated ? fit->c.x[a] : typical;
        fit->c.low[a] = fit->c.x[a] - 5.0 * WIDE;
        fit->c.high[a] = fit->c.x[a] + 5.0 * WIDE;
        fit->width[a] = WIDE;
    }
    size_t a = effects;
    for (size_t i = 0; i < fit->c.model.n_effects; i++) {
        const effect_row *row = effect_row_of(fit->c.model.effects[i].id);
        for (size_t p = 0; p < row->info.n_parameters; p++, a++) {
            const palp_effect_parameter *q = &row->info.parameter[p];
            fit->scan[a].jumps = row->jumps;
            if (row->jumps)
                open_bond(fit, data, row, p, a);
            const double range = fit->c.high[a] - fit->c.low[a];
            if (q->strength && !fit->c.logarithmic[a]) {
                fit->given[a] = fit->width[a] = 0.0;
                continue;
            }
            fit->given[a] = isfinite(range) ? 0.5 * (fit->c.high[a] + fit->c.low[a]) : fit->c.x[a];
            fit->width[a] = isfinite(range) ? fmax(range / sqrt(12.0), 1e-9) : fit->c.unit[a];
        }
    }
}

/* Copies the posteriors of coordinates by which the forces jump, for effects that both fits have. */
static void take_scans(const infer_fit *from, infer_fit *fit) {
    const palp_model *a = &from->c.model, *b = &fit->c.model;
    for (size_t i = 0; i < a->n_effects && i < b->n_effects && a->effects[i].id == b->effects[i].id; i++)
        for (size_t p = 0; p < PALP_EFFECT_PARAMETERS; p++) {
            infer_scan *to = &fit->scan[explain_first_column(b, i) + p];
            if (p < palp_effect_look_up(a->effects[i].id)->n_parameters && to->jumps)
                *to = from->scan[explain_first_column(a, i) + p];
        }
}

void infer_noise_begin(infer_fit *fit, const explain_data *data) {
    const double white = data->run[0].white, shortest = 4.0 * data->step,
                 longest = data->memory > 0.0 ? data->memory : data->duration;
    fit->noise = (infer_noise){.white = white,
                               .depth = 1e-3 * white * data->deepest / data->peak,
                               .clock = 1e-3 * white * data->deepest / data->fastest / data->peak,
                               .freedom = 1000.0};
    for (int a = 0; a < INFER_SLOW; a++) {
        fit->noise.slow[a] = 0.3 * white;
        fit->noise.slow_freedom[a] = data->law_alone ? 1000.0 : 0.0;
        fit->noise.time[a] = shortest * pow(longest / shortest, (double)a / (INFER_SLOW - 1));
    }
    for (size_t r = 0, at = 0; r < data->n_runs; at += data->run[r++].n)
        for (size_t i = 0; i < data->run[r].n; i++) {
            fit->sample[at + i].certain = 1.0;
            for (size_t a = 0; a < INFER_SLOW; a++)
                fit->sample[at + i].steady[a] = 1.0;
            fit->sample[at + i].samples = data->run[r].samples ? fmax(1.0, data->run[r].samples[i]) : 1.0;
        }
    infer_steps_find(fit, data);
}

/* The size of fit->raw: columns, products, the specimens' parameters, the contacts' precisions, and the
 * slopes that the noise depends on. */
static size_t room(const infer_fit *fit, const explain_data *data) {
    return data->n * (fit->m + sizeof *fit->sample / sizeof(double)) +
           data->n_runs * (fit->m * fit->m + INFER_SPECIMEN + 1);
}

static void place(infer_fit *fit, const explain_data *data) {
    fit->product = fit->raw + data->n * fit->m;
    fit->specimen = fit->product + data->n_runs * fit->m * fit->m;
    fit->contact_certain = fit->specimen + data->n_runs * INFER_SPECIMEN;
    fit->sample = (infer_sample *)(fit->contact_certain + data->n_runs);
}

palp_status infer_fit_create(const palp_model *model, const explain_data *data, const infer_fit *like,
                             infer_fit *fit) {
    palp_model splined = *model;
    palp_status status = PALP_OK;
    if (model->material.law.kind != PALP_LAW_SPLINE)
        status = infer_spline_of(&model->material.law, INFER_KNOTS, data->strain, &splined.material.law);
    if (!status)
        status = infer_fit_create_as(&splined, data, like, fit);
    else
        memset(fit, 0, sizeof *fit);
    return status;
}

palp_status infer_fit_create_as(const palp_model *model, const explain_data *data, const infer_fit *like,
                                infer_fit *fit) {
    memset(fit, 0, sizeof *fit);
    palp_status status = explain_fit_create(model, data, &fit->c);
    if (status)
        return status;
    fit->k = fit->c.n_columns;
    fit->m = fit->k + INFER_BLOCK + INFER_SPECIMEN + 1;
    fit->raw = malloc(room(fit, data) * sizeof *fit->raw);
    if (!fit->raw) {
        infer_fit_free(fit);
        return PALP_ERR_NO_MEMORY;
    }
    place(fit, data);
    fit->n_known = data->simulated ? fit->c.model.material.law.n + 2 * fit->c.model.material.n_arms : 0;
    memset(fit->specimen, 0, INFER_SPECIMEN * data->n_runs * sizeof *fit->specimen);
    memset(fit->sample, 0, data->n * sizeof *fit->sample);
    infer_noise_begin(fit, data);
    fit->sizes = infer_sizes_first(data);
    set_priors(fit, data);
    for (size_t i = 0; i < PALP_LAW_MAX; i++)
        fit->certain[i] = 1.0;
    for (size_t r = 0; r < data->n_runs; r++)
        fit->contact_certain[r] = 1.0;
    if (like) {
        memcpy(fit->certain, like->certain, sizeof fit->certain);
        memcpy(fit->contact_certain, like->contact_certain, data->n_runs * sizeof *fit->contact_certain);
        fit->noise = like->noise;
        memcpy(fit->sample, like->sample, data->n * sizeof *fit->sample);
        fit->sizes = like->sizes;
        fit->c.hum_Hz = like->c.hum_Hz;
        fit->c.hum_cost = like->c.hum_cost;
        fit->c.renewed = like->c.renewed;
        memcpy(fit->specimen, like->specimen, INFER_SPECIMEN * data->n_runs * sizeof *fit->specimen);
        memcpy(fit->c.contact, like->c.contact, 3 * data->n_runs * sizeof *fit->c.contact);
        const palp_material *m = &fit->c.model.material, *other = &like->c.model.material;
        const size_t plain = m->law.n + 2 * (m->n_arms < other->n_arms ? m->n_arms : other->n_arms);
        memcpy(fit->given, like->given, plain * sizeof *fit->given);
        memcpy(fit->c.low, like->c.low, plain * sizeof *fit->given);
        memcpy(fit->c.high, like->c.high, plain * sizeof *fit->given);
        take_scans(like, fit);
    }
    return PALP_OK;
}

palp_status infer_fit_copy(const infer_fit *from, const explain_data *data, infer_fit *to) {
    *to = *from;
    to->raw = malloc(room(from, data) * sizeof *to->raw);
    palp_status status = to->raw ? explain_fit_copy(&from->c, data->n_runs, &to->c) : PALP_ERR_NO_MEMORY;
    if (status) {
        free(to->raw);
        memset(to, 0, sizeof *to);
        return status;
    }
    memcpy(to->raw, from->raw, room(from, data) * sizeof *to->raw);
    place(to, data);
    return PALP_OK;
}

void infer_fit_exchange(infer_fit *a, infer_fit *b) {
    const infer_fit was = *a;
    *a = *b;
    *b = was;
}

void infer_fit_free(infer_fit *fit) {
    explain_fit_free(&fit->c);
    free(fit->raw);
    memset(fit, 0, sizeof *fit);
}

void infer_fit_take_state(const infer_fit *from, const explain_data *data, infer_fit *fit) {
    const size_t n_runs = data->n_runs;
    const size_t law = fit->c.model.material.law.n, was = from->c.model.material.law.n;
    fit->noise = from->noise;
    memcpy(fit->sample, from->sample, data->n * sizeof *fit->sample);
    fit->sizes = from->sizes;
    fit->c.hum_Hz = from->c.hum_Hz;
    fit->c.hum_cost = from->c.hum_cost;
    fit->c.renewed = from->c.renewed;
    memcpy(fit->specimen, from->specimen, INFER_SPECIMEN * n_runs * sizeof *fit->specimen);
    memcpy(fit->c.contact, from->c.contact, 3 * n_runs * sizeof *fit->c.contact); /* gain and zero too */
    memcpy(fit->contact_certain, from->contact_certain, n_runs * sizeof *fit->contact_certain);
    memcpy(fit->given + law, from->given + was, 2 * fit->c.model.material.n_arms * sizeof *fit->given);
    take_scans(from, fit);
}

/* ---- columns ---- */

/* The material of run r's specimen. */
static palp_status make_own(const infer_fit *fit, const explain_run *run, size_t r, palp_model *model) {
    const palp_material population = model->material;
    palp_status status =
        infer_specimen_material(&population, fit->specimen + r * INFER_SPECIMEN, &model->material);
    return status ? status : explain_resize(model, run);
}

/* The gradient by the population's coefficients from that by the specimen's; column[INFER_SPECIMEN n]: that
 * by the specimen's own parameters. */
static void take_specimen(const infer_fit *fit, const explain_run *run, size_t r, double *gradient,
                          double *column) {
    const palp_material *m = &fit->c.model.material;
    const double *b = fit->specimen + r * INFER_SPECIMEN, factor = run->area * exp(b[INFER_STIFFNESS]);
    const size_t n = run->n, count = m->law.n + 2 * m->n_arms;
    double slope[INFER_SPECIMEN * (PALP_LAW_MAX + 2 * PALP_ARMS_MAX)];
    infer_specimen_slopes(m, count, slope);
    memset(column, 0, INFER_SPECIMEN * n * sizeof *column);
    for (size_t a = 0; a < count; a++) {
        const bool law = a < m->law.n, viscosity = !law && (a - m->law.n) % 2 == 1,
                   exponent = law && m->law.kind == PALP_LAW_OGDEN && a % 2 == 1;
        const double scale = exponent    ? 1.0
                             : law       ? run->area * infer_law_factor(b)
                             : viscosity ? factor * exp(b[INFER_TIMES])
                                         : factor;
        for (size_t i = 0; i < n; i++)
            gradient[a * n + i] *= scale;
        for (size_t own = 0; own < INFER_SPECIMEN; own++)
            for (size_t i = 0; i < n && slope[own * count + a] != 0.0; i++)
                column[own * n + i] += slope[own * count + a] * gradient[a * n + i];
    }
}

/* Derivative of the force by a change of depth at one sample: that of the contact, and the part that the arms
 * have relaxed since the plate met the surface. */
static void take_slopes(const explain_run *run, const palp_model *own, const double *force,
                        const double *contact, infer_sample *sample) {
    const palp_material *m = &own->material;
    double met = run->time[0], first;
    palp_law_stiffness(&m->law, 0.0, &first, NULL);
    for (size_t i = 0; i < run->n; i++) {
        const size_t from = i ? i - 1 : 0, to = i + 1 < run->n ? i + 1 : i;
        const bool in = fabs(contact[i]) > 0.0;
        double there = first, arms = 0.0;
        met = in ? met : run->time[i];
        if (in && m->quasi_linear)
            palp_law_stiffness(&m->law, fmax(0.0, run->depth[i] / run->height), &there, NULL);
        for (size_t j = 0; j < m->n_arms && in; j++)
            arms -= m->arms[j].stiffness_N *
                    expm1((met - run->time[i]) * m->arms[j].stiffness_N / m->arms[j].viscosity_Ns);
        sample[i].next_by_depth = fabs(contact[i]) + arms * (there > 0.0 ? there / first : 0.0) / run->height;
        sample[i].next_by_time = (force[to] - force[from]) / (run->time[to] - run->time[from]);
    }
}

/* The residual of run r at the point about which its columns are linear. */
static void take_residual(const infer_fit *fit, const explain_data *data, size_t r, const double *force,
                          double *out) {
    const explain_run *run = &data->run[r];
    const size_t n = run->n;
    const double *own = out + fit->k * n, *specimen = own + INFER_BLOCK * n,
                 *b = fit->specimen + r * INFER_SPECIMEN;
    double *y = out + (fit->m - 1) * n;
    for (size_t i = 0; i < n; i++) {
        y[i] = run->force[i] - force[i] + fit->c.contact[r] * own[INFER_CONTACT * n + i] +
               fit->c.gain[r] * own[INFER_GAIN * n + i] + fit->c.zero[r] * own[INFER_ZERO * n + i];
        for (size_t a = 0; a < INFER_SPECIMEN; a++)
            y[i] += b[a] * specimen[a * n + i];
    }
}

/* gradient: [columns of the full model, n]; force: [n]. */
static palp_status take_columns(const infer_fit *fit, const explain_data *data, size_t r, const double *force,
                                double *gradient, const size_t column[EXPLAIN_BY], double *out) {
    const explain_run *run = &data->run[r];
    const size_t n = run->n, k = fit->k;
    double *own = out + k * n;
    take_specimen(fit, run, r, gradient, own + INFER_BLOCK * n);
    memcpy(own + INFER_CONTACT * n, gradient + column[EXPLAIN_BY_CONTACT] * n, n * sizeof *own);
    memcpy(own + INFER_GAIN * n, gradient + column[EXPLAIN_BY_GAIN] * n, n * sizeof *own);
    for (size_t i = 0; i < n; i++)
        own[INFER_ZERO * n + i] =
            column[EXPLAIN_BY_ZERO] != SIZE_MAX ? gradient[column[EXPLAIN_BY_ZERO] * n + i] : 1.0;
    memset(own + INFER_END * n, 0, n * sizeof *own);
    for (size_t i = 0; i < fit->c.model.n_effects; i++)
        if (effect_row_of(fit->c.model.effects[i].id)->bends)
            memcpy(own + INFER_END * n, gradient + explain_first_column(&fit->c.model, i) * n,
                   n * sizeof *own);
    explain_chain(&fit->c, n, gradient);
    memcpy(out, gradient, k * n * sizeof *out);
    for (size_t i = 0; i < n; i++) {
        const double turn = TURN * fit->c.hum_Hz * run->time[i];
        own[INFER_SINE * n + i] = fit->c.hum_Hz > 0.0 ? sin(turn) : 0.0;
        own[INFER_COSINE * n + i] = fit->c.hum_Hz > 0.0 ? cos(turn) : 0.0;
    }
    take_residual(fit, data, r, force, out);
    if (fit->free)
        return infer_free_hats(fit, data, r, out + (fit->m - 1) * n, own + INFER_OWN * n);
    infer_hats(data, r, fit->c.contact[r], own + INFER_OWN * n);
    return PALP_OK;
}

/* Rows x[count n] at the means of times become the means of the samples: those of the parabola through a row
 * and its neighbours. All three are on one straight piece of the path, or at its ends. */
static void take_means(const explain_run *run, size_t count, double *x) {
    for (size_t a = 0; a < count && run->spread; a++, x += run->n) {
        double before = x[0];
        for (size_t i = 1; i + 1 < run->n; i++) {
            const double here = x[i], since = run->time[i] - run->time[i - 1],
                         left = run->time[i + 1] - run->time[i], sd = run->spread[i];
            if (run->depth[i - 1] > 0.0)
                x[i] += sd * sd * ((x[i + 1] - here) / left - (here - before) / since) / (since + left);
            before = here;
        }
    }
}

/* Forces of fit->c.model, run by run, and what becomes of them; with gradients, if the columns are wanted. */
static palp_status evaluate(infer_fit *fit, const explain_data *data, bool columns_too) {
    palp_model full;
    size_t column[EXPLAIN_BY];
    palp_status status = explain_augment(&fit->c.model, &full, column);
    if (status)
        return status;
    const size_t columns = palp_forward_parameter_count(&full);
    double *work = malloc((columns + 1) * data->longest * sizeof *work);
    explain_history history = {.renewed = fit->c.renewed};
    status = work ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t r = 0, at = 0; r < data->n_runs && !status; at += data->run[r++].n) {
        palp_forward_run path = explain_forward_run(&data->run[r], fit->c.contact[r], &history);
        palp_model own = full;
        explain_add_own(&own, fit->c.gain[r], fit->c.zero[r]);
        double *gradient = work + data->run[r].n, *out = fit->raw + at * fit->m;
        status = make_own(fit, &data->run[r], r, &own);
        if (!status)
            status = explain_predict(&own, &path, work, columns_too ? gradient : NULL, NULL);
        if (!status)
            take_means(&data->run[r], columns_too ? columns + 1 : 1, work);
        if (!status && columns_too) {
            take_slopes(&data->run[r], &own, work, gradient + column[EXPLAIN_BY_CONTACT] * data->run[r].n,
                        fit->sample + at);
            status = take_columns(fit, data, r, work, gradient, column, out);
        } else if (!status)
            take_residual(fit, data, r, work, out);
    }
    palp_load_history_free(&history.load);
    free(work);
    return status;
}

void infer_weigh(infer_fit *fit, const explain_data *data) {
    for (size_t i = 0; i < data->n; i++) {
        fit->sample[i].by_depth = fit->sample[i].next_by_depth;
        fit->sample[i].by_time = fit->sample[i].next_by_time;
    }
}

palp_status infer_fit_evaluate(infer_fit *fit, const explain_data *data) {
    palp_status status = evaluate(fit, data, true);
    if (!fit->kept_weights)
        infer_weigh(fit, data);
    return status ? status : infer_fit_products(fit, data);
}

palp_status infer_fit_reevaluate(infer_fit *fit, const explain_data *data) {
    const size_t m = fit->m, n_most = data->longest;
    size_t list[EXPLAIN_COLUMNS + INFER_BLOCK + INFER_SPECIMEN + 1];
    const size_t n_active = infer_active_columns(fit, list);
    palp_status status = evaluate(fit, data, false);
    double *x = status ? NULL : malloc(((INFER_FILTER + 3) * n_most + INFER_STATES) * sizeof *x);
    if (!x)
        return status ? status : PALP_ERR_NO_MEMORY;
    double *variance = x + n_most, *inverse = variance + n_most, *work = inverse + n_most;
    for (size_t r = 0, at = 0; r < data->n_runs; at += data->run[r++].n) {
        const explain_run *run = &data->run[r];
        const double *raw = fit->raw + at * m;
        double *product = fit->product + r * m * m;
        memcpy(x, raw + (m - 1) * run->n, run->n * sizeof *x);
        infer_variance(fit, run->n, fit->sample + at, variance);
        infer_whiten(&fit->noise, run->n, run->time, fit->sample + at, variance, run->use, 1, x, work);
        product[m * m - 1] = dense_dot(run->n, x, x);
        infer_unwhiten(&fit->noise, run->n, fit->sample + at, work, x, inverse, NULL);
        for (size_t a = 0; a + 1 < n_active; a++)
            product[list[a] * m + m - 1] = product[(m - 1) * m + list[a]] =
                dense_dot(run->n, raw + list[a] * run->n, x);
    }
    free(x);
    return PALP_OK;
}

size_t infer_active_columns(const infer_fit *fit, size_t *list) {
    size_t n = 0;
    for (size_t a = 0; a < fit->m; a++) {
        bool on = a >= fit->k || (a >= fit->n_known && !fit->scan[a].jumps);
        if (a >= fit->k && a < fit->k + INFER_OWN)
            on = fit->sizes.own[a - fit->k] > 0.0;
        if (a >= fit->k + INFER_BLOCK && a + 1 < fit->m)
            on = fit->sizes.specimen[a - fit->k - INFER_BLOCK] > 0.0;
        else if (a >= fit->k + INFER_OWN && a + 1 < fit->m) {
            const size_t d = (a - fit->k - INFER_OWN) / INFER_NODES;
            on = infer_any(fit->sizes.common[d]) || infer_any(fit->sizes.each[d]);
        }
        if (on)
            list[n++] = a;
    }
    return n;
}

/* The contribution of the tails to the bound of the evidence. */
static double tails(const infer_fit *fit, const explain_run *run, const infer_sample *sample) {
    double sum = 0.0, n = 0.0, all = 0.0;
    for (size_t i = 0; i < run->n; i++)
        if (run->use[i]) {
            sum += log(sample[i].certain) - sample[i].certain + 1.0;
            n += 1.0;
        }
    for (size_t a = 0; a < INFER_SLOW && fit->noise.slow_freedom[a] > 0.0; a++) {
        double slow = 0.0;
        for (size_t i = 1; i < run->n; i++)
            slow += log(sample[i].steady[a]) - sample[i].steady[a] + 1.0;
        all += ((double)run->n - 1.0) * infer_tail_evidence(fit->noise.slow_freedom[a], 1.0) +
               0.5 * fit->noise.slow_freedom[a] * slow;
    }
    return n * infer_tail_evidence(fit->noise.freedom, 1.0) + 0.5 * fit->noise.freedom * sum + all;
}

palp_status infer_fit_products(infer_fit *fit, const explain_data *data) {
    enum { TILE = 32 }; /* samples of all columns that a cache holds */
    const size_t m = fit->m, n_most = data->longest;
    size_t list[EXPLAIN_COLUMNS + INFER_BLOCK + INFER_SPECIMEN + 1];
    const size_t n_active = infer_active_columns(fit, list);
    double *block = malloc(((m + INFER_FILTER + 1) * n_most + INFER_STATES * m + m * m) * sizeof *block);
    if (!block)
        return PALP_ERR_NO_MEMORY;
    double *variance = block + m * n_most, *work = variance + n_most,
           *small = work + INFER_FILTER * n_most + INFER_STATES * m;
    fit->log_noise = 0.0;
    memset(fit->product, 0, data->n_runs * m * m * sizeof *fit->product);
    for (size_t r = 0, at = 0; r < data->n_runs; at += data->run[r++].n) {
        const explain_run *run = &data->run[r];
        const double *raw = fit->raw + at * m;
        double *product = fit->product + r * m * m;
        infer_variance(fit, run->n, fit->sample + at, variance);
        for (size_t from = 0; from < run->n; from += TILE)
            for (size_t a = 0; a < n_active; a++)
                for (size_t i = from; i < run->n && i < from + TILE; i++)
                    block[i * n_active + a] = raw[list[a] * run->n + i];
        const double log_det = infer_whiten(&fit->noise, run->n, run->time, fit->sample + at, variance,
                                            run->use, n_active, block, work);
        fit->log_noise += run->held_out ? 0.0 : log_det - 2.0 * tails(fit, run, fit->sample + at);
        memset(small, 0, n_active * n_active * sizeof *small);
        dense_add_square(n_active, run->n, 1.0, block, small);
        for (size_t a = 0; a < n_active; a++)
            for (size_t b = 0; b < n_active; b++)
                product[list[a] * m + list[b]] = small[a * n_active + b];
    }
    free(block);
    return PALP_OK;
}

void infer_take_scores(infer_fit *fit, const infer_posterior *p) {
    fit->score = infer_log_evidence(fit, p, p->here);
    fit->promised = infer_log_evidence(fit, p, p->chi2);
}

palp_status infer_fit_score(infer_fit *fit, const explain_data *data) {
    infer_posterior p;
    palp_status status = infer_posterior_find(fit, data, &p);
    if (!status)
        infer_take_scores(fit, &p);
    infer_posterior_free(&p);
    return status;
}

palp_status infer_residual(const infer_fit *fit, const explain_data *data, double *residual,
                           double *discrepancy) {
    infer_posterior p;
    double undone[EXPLAIN_COLUMNS];
    palp_status status = infer_posterior_find(fit, data, &p);
    for (size_t a = 0; a < fit->k && !status; a++)
        undone[a] = infer_undone(&p, 0, INFER_HATS, a);
    for (size_t r = 0, at = 0; r < data->n_runs && !status; at += data->run[r++].n) {
        const size_t n = data->run[r].n;
        const double *raw = fit->raw + at * fit->m, *own_column = raw + fit->k * n;
        double own[INFER_BLOCK], specimen[INFER_SPECIMEN];
        status = infer_own(fit, data, &p, r, own, NULL);
        if (!status)
            status = infer_specimen_own(&p, r, specimen, NULL);
        for (size_t i = 0; i < n && !status; i++) {
            double left = raw[(fit->m - 1) * n + i], taken = 0.0;
            for (size_t a = 0; a < INFER_OWN; a++)
                left -= own[a] * own_column[a * n + i];
            for (size_t a = 0; a < fit->k; a++) /* the runs' own parameters change with this step */
                left -= p.mean[p.hats + a] * raw[a * n + i];
            for (size_t a = 0; a < INFER_SPECIMEN; a++)
                left -= specimen[a] * own_column[(INFER_BLOCK + a) * n + i];
            for (size_t a = 0; a < INFER_HATS; a++)
                taken += (own[INFER_OWN + a] + infer_common(&p, a)) * own_column[(INFER_OWN + a) * n + i];
            for (size_t a = 0; a < fit->k; a++)
                taken -= undone[a] * raw[a * n + i];
            residual[at + i] = data->run[r].use[i] ? left : 0.0;
            discrepancy[at + i] = taken;
        }
    }
    infer_posterior_free(&p);
    return status;
}
