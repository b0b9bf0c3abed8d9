/* explain_interval.c: intervals of the accepted effects' parameters. */
#include "explain_result.h"
#include "base/dense.h"

#include <palpate/random.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double EQUATIONS =
    0.01; /* of a parameter: what samples of a path and an effect's equations are good for */

/* Squared half width of parameter at's interval: what the noise allows (factor: of the normal matrix) and
 * what the runs, each counted as one, agree on; the wider. unit: [k] work. */
static double square_reach(const explain_fit *fit, const explain_data *data, const double *factor,
                           const double *gradient, size_t at, double inflation, double *unit) {
    size_t k = fit->n_columns, counted = 0;
    double between = 0.0;
    memset(unit, 0, k * sizeof *unit);
    unit[at] = 1.0;
    dense_cholesky_solve(k, factor, 1, unit);
    for (size_t r = 0; r < data->n_runs; r++) {
        double pull = 0.0;
        if (data->run[r].held_out)
            continue;
        for (size_t i = 0; i < k; i++)
            pull += unit[i] * gradient[r * k + i];
        between += pull * pull;
        counted++;
    }
    double noise = pow(1.96, 2) * unit[at] * inflation;
    if (counted < 2)
        return noise;
    double n = (double)counted;
    return fmax(noise, pow(palp_student_95(counted > 2 ? counted - 1 : 1), 2) * between * n / (n - 1.0));
}

palp_status explain_reaches_find(const explain_fit *fit, const explain_data *data, double *reach,
                                 double *rise) {
    size_t k = fit->n_columns;
    double *h = malloc((2 * k + 2 + data->n_runs) * k * sizeof *h), chi2, logdet;
    if (!h)
        return PALP_ERR_NO_MEMORY;
    double *work = h + k * k, *unit = work + k * k + k, *gradient = unit + k;
    double inflation = fmax(1.0, explain_chi2(data, fit));
    explain_fit_total(fit, data, h, unit, &chi2, work);
    for (size_t r = 0; r < data->n_runs; r++)
        explain_normal_of(fit, r, work, gradient + r * k, &chi2, &logdet);
    bool known = dense_cholesky(k, h);
    for (size_t i = 0; i < k; i++) {
        double square = known ? square_reach(fit, data, h, gradient, i, inflation, unit) : HUGE_VAL;
        reach[i] = sqrt(square);
        rise[i] = known ? square / unit[i] : HUGE_VAL;
    }
    free(h);
    return PALP_OK;
}

/* ---- profile likelihood ---- */

static const double WIDE = 0.2; /* of a parameter: half widths beyond which the likelihood is followed */

/* One end of a parameter's interval: where the best chi2 of all fits with that parameter fixed rises by so
 * much. */
typedef struct interval_end {
    size_t at;
    double sign, reach, rise; /* reach: first that of a quadratic likelihood */
} interval_end;

enum { ENDS = 2 * PALP_EXPLAIN_EFFECTS * PALP_EFFECT_PARAMETERS };

typedef struct interval_work {
    const explain_search *search;
    double chi2; /* of the best fit */
    interval_end end[ENDS];
    palp_status status[ENDS];
} interval_work;

/* chi2 of the best fit near *fit whose parameter at is x, HUGE_VAL if there is none. */
static palp_status fixed_chi2(explain_fit *fit, const explain_data *data, size_t at, double x, double *chi2) {
    fit->low[at] = fit->high[at] = fit->x[at] = x;
    palp_status status = explain_fit_to_model(fit);
    if (!status)
        status = explain_fit_products(fit, data, NULL);
    if (!status)
        status = explain_fit_improve(fit, data, 8);
    *chi2 = status ? HUGE_VAL : explain_chi2(data, fit) * (double)explain_samples(data);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

/* The root of the rise grows about as the distance: secants on it, from the last fit that was found. */
static palp_status find_end(const interval_work *w, interval_end *end, explain_fit *fit) {
    const explain_data *data = &w->search->data;
    double centre = fit->x[end->at], wanted = sqrt(end->rise), d = end->reach, chi2;
    double bound = end->sign < 0.0 ? centre - fit->low[end->at] : fit->high[end->at] - centre;
    double low = 0.0, low_root = 0.0, high = HUGE_VAL, high_root = HUGE_VAL;
    for (int step = 0; step < 8; step++) {
        d = fmin(d, bound);
        palp_status status = fixed_chi2(fit, data, end->at, centre + end->sign * d, &chi2);
        if (status)
            return status;
        double root = fmin(4.0 * wanted, sqrt(fmax(0.0, chi2 - w->chi2)));
        end->reach = d;
        if (fabs(root - wanted) < 0.03 * wanted || (root < wanted && d >= bound))
            return PALP_OK;
        if (root < wanted) {
            low = d;
            low_root = root;
        } else {
            high = d;
            high_root = root;
        }
        double share = (wanted - low_root) / (high_root - low_root);
        d = high < HUGE_VAL ? low + fmin(0.9, fmax(0.1, share)) * (high - low)
                            : d * fmin(3.0, fmax(1.1, wanted / fmax(root, 1e-9 * wanted)));
    }
    end->reach = d;
    return PALP_OK;
}

static void end_task(void *user, size_t i) {
    interval_work *w = user;
    explain_fit fit;
    w->status[i] = explain_fit_copy(&w->search->fit, w->search->data.n_runs, &fit);
    if (!w->status[i])
        w->status[i] = find_end(w, &w->end[i], &fit);
    explain_fit_free(&fit);
}

/* Narrows or widens below[n_columns] and above[n_columns] of the added effects' parameters where they are
 * wide. A network's fits are too dear. */
static palp_status follow_likelihood(const explain_search *s, const double *rise, double *below,
                                     double *above) {
    const explain_fit *fit = &s->fit;
    size_t n = 0, columns = fit->n_columns;
    interval_work *w = calloc(1, sizeof *w);
    palp_status status = w ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t k = explain_first_column(&fit->model, s->n_given); k < columns && !status; k++) {
        double size = fit->logarithmic[k] ? 1.0 : fabs(fit->x[k]);
        bool free_to_move = fit->low[k] < fit->high[k] && isfinite(rise[k]);
        if (fit->model.kind == PALP_MODEL_NETWORK || !free_to_move || !(below[k] > WIDE * size))
            continue;
        w->end[n++] = (interval_end){.at = k, .sign = -1.0, .reach = below[k], .rise = rise[k]};
        w->end[n++] = (interval_end){.at = k, .sign = 1.0, .reach = above[k], .rise = rise[k]};
    }
    if (n > 0) {
        w->search = s;
        w->chi2 = explain_chi2(&s->data, fit) * (double)explain_samples(&s->data);
        status = explain_each(s->settings, n, end_task, w, w->status);
    }
    for (size_t i = 0; i < n && !status; i++) {
        double *reach = w->end[i].sign < 0.0 ? below : above;
        reach[w->end[i].at] = w->end[i].reach;
    }
    free(w);
    return status;
}

/* Of a bond whose force is fitted, the likelihood over both of its numbers instead. */
static palp_status scan_bonds(const explain_search *s, double *below, double *above) {
    const explain_fit *fit = &s->fit;
    for (size_t i = s->n_given; i < fit->model.n_effects; i++) {
        const size_t at = explain_first_column(&fit->model, i);
        double low[2], high[2];
        if (fit->model.kind == PALP_MODEL_NETWORK || !effect_row_of(fit->model.effects[i].id)->bond ||
            !(fit->low[at] < fit->high[at]))
            continue;
        palp_status status = explain_scan_bond(s, at, low, high);
        if (status == PALP_ERR_NO_MEMORY)
            return status;
        for (size_t p = 0; p < 2 && !status; p++) {
            below[at + p] = fit->x[at + p] - low[p];
            above[at + p] = high[p] - fit->x[at + p];
        }
    }
    return PALP_OK;
}

palp_status explain_intervals(const explain_search *s, palp_explanation *e) {
    const explain_fit *fit = &s->fit;
    const explain_data *data = &s->data;
    double below[EXPLAIN_COLUMNS], above[EXPLAIN_COLUMNS], rise[EXPLAIN_COLUMNS];
    palp_status status = explain_reaches_find(fit, data, below, rise);
    if (status)
        return status;
    memcpy(above, below, fit->n_columns * sizeof *above);
    status = follow_likelihood(s, rise, below, above);
    if (!status)
        status = scan_bonds(s, below, above);
    size_t at = explain_first_column(&fit->model, s->n_given);
    for (size_t i = s->n_given; i < fit->model.n_effects && !status; i++) {
        palp_effect_id id = fit->model.effects[i].id;
        for (size_t p = 0; p < palp_effect_look_up(id)->n_parameters; p++, at++) {
            double least = EQUATIONS * (fit->logarithmic[at] ? 1.0 : fabs(fit->x[at]));
            double low = fmax(fit->low[at], fit->x[at] - hypot(below[at], least));
            double high = fmin(fit->high[at], fit->x[at] + hypot(above[at], least));
            const effect_data facts = explain_facts(data);
            effect_read read;
            if (p == 0 && effect_row_of(id)->read &&
                effect_row_of(id)->read(&facts, &read)) { /* off the data, not fitted */
                low = read.low - least;
                high = read.high + least;
            }
            bool none = palp_effect_look_up(id)->parameter[p].optional && low <= fit->low[at];
            e->effect[i - s->n_given].low[p] = none ? 0.0 : fit->logarithmic[at] ? exp(low) : low;
            e->effect[i - s->n_given].high[p] = fit->logarithmic[at] ? exp(high) : high;
        }
    }
    return status;
}

/* The hum is the model's last effect; its amplitude is the mean of the runs' own. */
void explain_add_hum(const explain_search *s, palp_explanation *e) {
    double square = 0.0;
    if (!(s->fit.hum_Hz > 0.0) || e->model.n_effects == PALP_EFFECTS_MAX)
        return;
    for (size_t r = 0; r < s->data.n_runs; r++) {
        double own[EXPLAIN_NUISANCES], sd[EXPLAIN_NUISANCES];
        explain_nuisances(&s->fit, r, own, sd);
        square += (own[3] * own[3] + own[4] * own[4]) / (double)s->data.n_runs;
    }
    palp_effect hum = {.id = effect_line(), .value = {sqrt(square), s->fit.hum_Hz}};
    palp_explain_effect *out = &e->effect[e->n_effects - 1];
    double sd = s->data.run[0].white * sqrt(2.0 / (double)s->data.n), width = 0.2 / s->data.duration;
    e->model.effects[e->model.n_effects++] = out->effect = hum;
    out->low[0] = hum.value[0] - 1.96 * sd - 0.02 * hum.value[0];
    out->high[0] = hum.value[0] + 1.96 * sd + 0.02 * hum.value[0];
    out->low[1] = hum.value[1] - width;
    out->high[1] = hum.value[1] + width;
}
