/* infer_remains.c: scatter of the runs' parameters, and the discrepancy. */
#include "infer_answer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double TURN = 6.28318530717958647692;

/* Refits parameters, sizes and noise after a part of the fit was removed. */
static palp_status learn_without(infer_fit *fit, const explain_data *data) {
    palp_status status = infer_fit_improve(fit, data, 5);
    if (!status)
        status = infer_sizes_learn(fit, data, 6);
    return status ? status : infer_noise_learn(fit, data, 15, true);
}

/* The parameters with the smallest residual; a discrepancy could absorb any share of it. */
static palp_status leave_least(infer_fit *fit, const explain_data *data) {
    enum { ROUNDS = 8 };
    return infer_fit_anneal(fit, data, ROUNDS);
}

typedef palp_status refit(infer_fit *fit, const explain_data *data);

/* The effect of all runs that corresponds to a parameter of each run, unless the model has it. */
static void share(palp_model *model, palp_effect_id id, double value) {
    for (size_t i = 0; i < model->n_effects; i++)
        if (model->effects[i].id == id)
            return;
    if (model->n_effects == PALP_EFFECTS_MAX)
        return;
    palp_effect *effect = &model->effects[model->n_effects++];
    palp_effect_default(id, effect);
    effect->value[0] = value;
}

/* Means of the runs' parameters, [INFER_OWN]; square: sums of their squares about these. */
static palp_status find_means(const infer_search *s, double mean[INFER_OWN], double square[INFER_OWN]) {
    infer_posterior p;
    double own[INFER_BLOCK], n = 0.0;
    memset(mean, 0, INFER_OWN * sizeof *mean);
    memset(square, 0, INFER_OWN * sizeof *square);
    palp_status status = infer_posterior_find(&s->fit, &s->data, &p);
    for (size_t r = 0; r < s->data.n_runs && !status; r++) {
        if (s->data.run[r].held_out)
            continue;
        n += 1.0;
        status = infer_own(&s->fit, &s->data, &p, r, own, NULL);
        for (size_t a = 0; a < INFER_OWN && !status; a++) {
            const double off = own[a] - mean[a];
            mean[a] += off / n;
            square[a] += off * off * (n - 1.0) / n;
        }
    }
    infer_posterior_free(&p);
    return status;
}

/* The fit at hand with one zero, contact or gain for all runs where common says so, refitted by this: that of
 * the model, or another one (mean, NULL: not tried), if it is more probable. The law absorbs a gain. The
 * remaining parameters of the runs may absorb those that are removed. */
static palp_status refit_in_common(const infer_search *s, const bool common[INFER_GAIN + 1], refit *by,
                                   const double *mean, infer_fit *fit) {
    palp_model model = s->fit.c.model;
    if (mean && common[INFER_ZERO])
        share(&model, PALP_EFFECT_SENSOR_BIAS, mean[INFER_ZERO]);
    if (mean && common[INFER_CONTACT] && !s->data.contacts_alike)
        share(&model, PALP_EFFECT_CONTACT_OFFSET, mean[INFER_CONTACT]);
    palp_status status = infer_fit_create(&model, &s->data, &s->fit, fit);
    if (status)
        return status;
    const infer_sizes first = infer_sizes_first(&s->data);
    for (size_t a = 0; a <= INFER_GAIN; a++)
        fit->sizes.own[a] = common[a] ? 0.0 : fmax(fit->sizes.own[a], first.own[a]);
    if (common[INFER_CONTACT])
        memset(fit->c.contact, 0, s->data.n_runs * sizeof *fit->c.contact);
    if (common[INFER_GAIN])
        memset(fit->c.gain, 0, s->data.n_runs * sizeof *fit->c.gain);
    if (common[INFER_ZERO])
        memset(fit->c.zero, 0, s->data.n_runs * sizeof *fit->c.zero);
    status = infer_fit_evaluate(fit, &s->data);
    return status ? status : by(fit, &s->data);
}

static palp_status fit_in_common(const infer_search *s, const bool common[INFER_GAIN + 1], refit *by,
                                 const double mean[INFER_OWN], infer_fit *fit) {
    infer_fit shared = {.raw = NULL};
    palp_status status = refit_in_common(s, common, by, NULL, fit);
    const bool effects = common[INFER_ZERO] || common[INFER_CONTACT];
    if (!status && effects && s->fit.score - fit->score > infer_threshold(s->settings))
        status = refit_in_common(s, common, by, mean, &shared);
    if (!status && shared.raw && shared.score > fit->score)
        infer_fit_exchange(fit, &shared);
    if (shared.raw)
        infer_fit_free(&shared);
    return status;
}

palp_status infer_before_find(const infer_search *s, double *residual) {
    static const bool all[INFER_GAIN + 1] = {true, true, true};
    infer_fit fit = {.raw = NULL};
    double *work = malloc(s->data.n * sizeof *work);
    palp_status status = work ? refit_in_common(s, all, leave_least, NULL, &fit) : PALP_ERR_NO_MEMORY;
    if (!status)
        status = infer_residual(&fit, &s->data, residual, work);
    if (fit.raw)
        infer_fit_free(&fit);
    free(work);
    return status;
}

/* The least rms with one zero, contact or gain for all runs where common says so. work: [2 data.n] */
static palp_status find_least(const infer_search *s, const bool common[INFER_GAIN + 1],
                              const double mean[INFER_OWN], double *work, double *least) {
    infer_fit fit = {.raw = NULL};
    palp_status status = fit_in_common(s, common, leave_least, mean, &fit);
    if (!status)
        status = infer_residual(&fit, &s->data, work, work + s->data.n);
    *least = status ? 0.0 : explain_fitted_rms(&s->data, work);
    if (fit.raw)
        infer_fit_free(&fit);
    return status;
}

/* The basis of all three verdicts: the runs' parameters, and the smallest rms residual with all of them. */
typedef struct scatters {
    double mean[INFER_OWN], square[INFER_OWN], with;
    bool known;   /* with is */
    double *work; /* [2 data.n] */
} scatters;

/* The scatter of one kind of parameters, against one value for all runs. */
static palp_status find_scatter(const infer_search *s, int which, const scatters *all,
                                palp_explain_scatter *out) {
    bool common[INFER_GAIN + 1] = {false};
    common[which] = true;
    const double left = explain_fitted_rms(&s->data, s->residual);
    *out = (palp_explain_scatter){.without_N = left};
    if (!(s->fit.sizes.own[which] > 0.0))
        return PALP_OK;
    const double told = which == INFER_CONTACT ? (double)s->data.n_contact_told : 0.0;
    const double freedom = (double)explain_fitted_runs(&s->data) - 1.0 + told;
    out->sd = sqrt((all->square[which] + told * pow(s->data.contact_told, 2.0)) / fmax(1.0, freedom));
    if (!all->known)
        return PALP_OK;
    double least;
    infer_fit without = {.raw = NULL};
    palp_status status = fit_in_common(s, common, learn_without, all->mean, &without);
    if (!status)
        status = find_least(s, common, all->mean, all->work, &least);
    if (!status) {
        out->without_N = sqrt(left * left + fmax(0.0, least * least - all->with * all->with));
        out->evidence = s->fit.score - without.score;
        out->found =
            out->evidence > infer_threshold(s->settings) &&
            sqrt(out->without_N * out->without_N - left * left) > s->settings->good_enough * s->data.peak;
    }
    if (without.raw)
        infer_fit_free(&without);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

palp_status infer_scatter_find(const infer_search *s, palp_explanation *e) {
    static const bool none[INFER_GAIN + 1] = {false};
    palp_explain_scatter *const out[INFER_GAIN + 1] = {&e->zero, &e->contact, &e->gain};
    if (s->data.n_runs < 2) /* nothing to scatter about */
        return PALP_OK;
    scatters all = {.work = malloc(2 * s->data.n * sizeof *all.work)};
    palp_status status = all.work ? find_means(s, all.mean, all.square) : PALP_ERR_NO_MEMORY;
    if (!status) {
        status = find_least(s, none, all.mean, all.work, &all.with);
        all.known = !status;
        status = status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
    }
    for (int which = 0; which <= INFER_GAIN && !status; which++)
        status = find_scatter(s, which, &all, out[which]);
    free(all.work);
    return status;
}

/* ---- the discrepancy ---- */

palp_status infer_without_discrepancy(const infer_search *s, infer_fit *without) {
    palp_status status = infer_fit_copy(&s->fit, &s->data, without);
    if (status)
        return status;
    without->plain = true;
    memset(without->sizes.common, 0, sizeof without->sizes.common);
    memset(without->sizes.each, 0, sizeof without->sizes.each);
    status = infer_fit_products(without, &s->data);
    if (!status)
        status = infer_fit_score(without, &s->data);
    if (status)
        infer_fit_free(without);
    return status;
}

/* Evidence of the discrepancy: the loss of the fit without it, with the noise estimated again, nats. */
static palp_status find_evidence(const infer_search *s, double *nats) {
    infer_fit without;
    palp_status status = infer_without_discrepancy(s, &without);
    if (status)
        return status;
    status = infer_noise_learn(&without, &s->data, 25, true);
    *nats = s->fit.promised - without.promised;
    infer_fit_free(&without);
    return status;
}

palp_status infer_size_cost(infer_fit *fit, const explain_data *data, double *size, double *nats) {
    const double step = 0.5, was = *size, score = fit->score, here = fit->promised,
                 hidden = fit->noise.white / sqrt((double)explain_samples(data));
    double sum = 0.0;
    palp_status status = PALP_OK;
    if (!(was > hidden)) /* nothing is said of it */
        return PALP_OK;
    for (int side = -1; side <= 1 && !status; side += 2) {
        *size = was * exp(side * step);
        status = infer_fit_score(fit, data);
        sum += fit->promised;
    }
    *size = was;
    fit->score = score;
    fit->promised = here;
    const double curvature = fmax(0.0, (2.0 * here - sum) / (step * step)), range = log(data->peak / hidden);
    *nats += fmax(0.0, log(range * sqrt(curvature / TURN)));
    return status;
}

palp_status infer_discrepancy_cost(const infer_search *s, double *nats) {
    infer_fit fit;
    memset(&fit, 0, sizeof fit);
    palp_status status = infer_fit_copy(&s->fit, &s->data, &fit);
    *nats = 0.0;
    for (size_t i = 0; i < INFER_DOMAINS * INFER_LENGTHS && !status; i++) {
        status =
            infer_size_cost(&fit, &s->data, &fit.sizes.common[i / INFER_LENGTHS][i % INFER_LENGTHS], nats);
        if (!status)
            status =
                infer_size_cost(&fit, &s->data, &fit.sizes.each[i / INFER_LENGTHS][i % INFER_LENGTHS], nats);
    }
    if (fit.raw)
        infer_fit_free(&fit);
    return status;
}

palp_status infer_discrepancy_weigh(const infer_search *s, double *nats) {
    double cost = 0.0;
    palp_status status = find_evidence(s, nats);
    if (!status)
        status = infer_discrepancy_cost(s, &cost);
    *nats -= cost;
    return status;
}

palp_status infer_discrepancy_drop(infer_search *s, double *nats) {
    infer_fit without;
    palp_status status = infer_discrepancy_weigh(s, nats);
    if (status || *nats > 0.0)
        return status;
    status = infer_without_discrepancy(s, &without);
    if (status)
        return status;
    status = infer_fit_converge(&without, &s->data);
    if (!status)
        infer_fit_exchange(&s->fit, &without);
    infer_fit_free(&without);
    return status;
}

/* Squares of run r's discrepancy by domain, common and its own together. */
static palp_status add_domains(const infer_search *s, const infer_posterior *p, size_t r, size_t at,
                               double square[INFER_DOMAINS]) {
    const infer_fit *fit = &s->fit;
    const size_t n = s->data.run[r].n;
    const double *raw = fit->raw + at * fit->m, *hats = raw + (fit->k + INFER_OWN) * n;
    double own[INFER_BLOCK], undone[EXPLAIN_COLUMNS];
    palp_status status = infer_own(fit, &s->data, p, r, own, NULL);
    for (size_t d = 0; d < INFER_DOMAINS && !status; d++) {
        const size_t from = d * INFER_NODES, to = from + INFER_NODES;
        for (size_t a = 0; a < fit->k; a++)
            undone[a] = infer_undone(p, from, to, a);
        for (size_t i = 0; i < n; i++) {
            double taken = 0.0;
            for (size_t a = from; a < to; a++)
                taken += (own[INFER_OWN + a] + infer_common(p, a)) * hats[a * n + i];
            for (size_t a = 0; a < fit->k; a++)
                taken -= undone[a] * raw[a * n + i];
            square[d] += s->data.run[r].use[i] ? taken * taken : 0.0;
        }
    }
    return status;
}

palp_status infer_discrepancy_find(const infer_search *s, palp_explanation *e) {
    const explain_data *data = &s->data;
    double square[INFER_DOMAINS] = {0.0}, beside = 0.0, count = 0.0;
    infer_posterior p;
    palp_status status = infer_posterior_find(&s->fit, data, &p);
    for (size_t r = 0, at = 0; r < data->n_runs && !status; at += data->run[r++].n) {
        if (data->run[r].held_out)
            continue;
        status = add_domains(s, &p, r, at, square);
        for (size_t i = at; i < at + data->run[r].n; i++) {
            const double used = data->run[r].use[i - at] ? 1.0 : 0.0;
            beside += used * pow(s->residual[i] - s->discrepancy[i], 2.0);
            count += used;
        }
    }
    infer_posterior_free(&p);
    if (status)
        return status;
    palp_explain_discrepancy *out = &e->discrepancy;
    out->loading_N = sqrt(square[INFER_LOADING] / count);
    out->unloading_N = sqrt((square[INFER_UNLOADING] + square[INFER_WITHDRAWN]) / count);
    out->dwell_N = sqrt(square[INFER_DWELL] / count);
    out->correlated_N = sqrt(fmax(0.0, beside / count - pow(infer_white_level(&s->fit, data), 2.0)));
    const bool there = out->evidence > infer_threshold(s->settings);
    e->unexplained_N = there ? explain_fitted_rms(data, s->discrepancy) : 0.0;
    out->found = there && e->unexplained_N > s->settings->good_enough * data->peak;
    return status;
}
