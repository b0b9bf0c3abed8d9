/* infer_remains.c: what the runs have of their own, and what no term of the model follows. */
#include "infer_answer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double TURN = 6.28318530717958647692;

/* Parameters, sizes and noise of a fit of which something was just taken out. */
static palp_status learn_without(infer_fit *fit, const explain_data *data) {
    palp_status status = infer_fit_improve(fit, data, 5);
    if (!status)
        status = infer_sizes_learn(fit, data, 6);
    return status ? status : infer_noise_learn(fit, data, 60, false);
}

/* The fit at hand with no zero, contact or gain of the runs' own. */
static palp_status find_scatter(const infer_search *s, int which, palp_explain_scatter *out) {
    *out = (palp_explain_scatter){.sd = s->fit.sizes.own[which],
                                  .without_N = explain_fitted_rms(&s->data, s->residual)};
    if (!(out->sd > 0.0))
        return PALP_OK;
    infer_fit without;
    double *work = malloc(2 * s->data.n * sizeof *work);
    palp_status status = work ? infer_fit_copy(&s->fit, &s->data, &without) : PALP_ERR_NO_MEMORY;
    if (!status) {
        const double left = out->without_N;
        without.sizes.own[which] = 0.0;
        if (which == INFER_CONTACT)
            memset(without.c.contact, 0, s->data.n_runs * sizeof *without.c.contact);
        if (which == INFER_GAIN)
            memset(without.c.gain, 0, s->data.n_runs * sizeof *without.c.gain);
        status = learn_without(&without, &s->data);
        if (!status)
            status = infer_residual(&without, &s->data, work, work + s->data.n);
        if (!status) {
            out->without_N = explain_fitted_rms(&s->data, work);
            out->evidence = s->fit.score - without.score;
            out->found = out->evidence > infer_threshold(s->settings) && out->without_N > left;
        }
        infer_fit_free(&without);
    }
    free(work);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

palp_status infer_scatter_find(const infer_search *s, palp_explanation *e) {
    palp_status status = PALP_OK;
    if (s->data.n_runs < 2) /* nothing to scatter about */
        return PALP_OK;
    status = find_scatter(s, INFER_ZERO, &e->zero);
    if (!status)
        status = find_scatter(s, INFER_CONTACT, &e->contact);
    return status ? status : find_scatter(s, INFER_GAIN, &e->gain);
}

/* ---- the discrepancy ---- */

/* Evidence of the discrepancy: what the fit loses without it, its noise learned anew, nats. */
static palp_status find_evidence(const infer_search *s, double *nats) {
    infer_fit without;
    palp_status status = infer_fit_copy(&s->fit, &s->data, &without);
    if (status)
        return status;
    memset(without.sizes.common, 0, sizeof without.sizes.common);
    memset(without.sizes.each, 0, sizeof without.sizes.each);
    status = infer_fit_products(&without, &s->data);
    if (!status)
        status = infer_fit_score(&without, &s->data);
    if (!status)
        status = infer_noise_learn(&without, &s->data, 100, false);
    *nats = s->fit.score - without.score;
    infer_fit_free(&without);
    return status;
}

/* What one size costs: its log-uniform prior over what its posterior leaves of it (Laplace), nats. */
static palp_status cost_of_size(infer_fit *fit, const explain_data *data, double *size, double *nats) {
    const double step = 0.5, was = *size, here = fit->score,
                 hidden = fit->noise.white / sqrt((double)explain_samples(data));
    double sum = 0.0;
    palp_status status = PALP_OK;
    if (!(was > hidden)) /* nothing is said of it */
        return PALP_OK;
    for (int side = -1; side <= 1 && !status; side += 2) {
        *size = was * exp(side * step);
        status = infer_fit_score(fit, data);
        sum += fit->score;
    }
    *size = was;
    fit->score = here;
    const double curvature = fmax(0.0, (2.0 * here - sum) / (step * step)), range = log(data->peak / hidden);
    *nats += fmax(0.0, log(range * sqrt(curvature / TURN)));
    return status;
}

static palp_status cost_of_sizes(const infer_search *s, double *nats) {
    infer_fit fit;
    memset(&fit, 0, sizeof fit);
    palp_status status = infer_fit_copy(&s->fit, &s->data, &fit);
    *nats = 0.0;
    for (size_t i = 0; i < INFER_DOMAINS * INFER_LENGTHS && !status; i++) {
        status = cost_of_size(&fit, &s->data, &fit.sizes.common[i / INFER_LENGTHS][i % INFER_LENGTHS], nats);
        if (!status)
            status =
                cost_of_size(&fit, &s->data, &fit.sizes.each[i / INFER_LENGTHS][i % INFER_LENGTHS], nats);
    }
    if (fit.raw)
        infer_fit_free(&fit);
    return status;
}

/* Squares of run r's discrepancy by domain, common and its own together. */
static palp_status add_domains(const infer_search *s, const infer_posterior *p, size_t r, size_t at,
                               double square[INFER_DOMAINS]) {
    const infer_fit *fit = &s->fit;
    const size_t n = s->data.run[r].n;
    const double *hats = fit->raw + at * fit->m + (fit->k + INFER_OWN) * n;
    double own[INFER_BLOCK];
    palp_status status = infer_own(fit, p, r, own, NULL);
    for (size_t d = 0; d < INFER_DOMAINS && !status; d++)
        for (size_t i = 0; i < n; i++) {
            double taken = 0.0;
            for (size_t a = d * INFER_NODES; a < (d + 1) * INFER_NODES; a++)
                taken += (own[INFER_OWN + a] + p->mean[a]) * hats[a * n + i];
            square[d] += s->data.run[r].use[i] ? taken * taken : 0.0;
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
    out->known = true;
    out->loading_N = sqrt(square[INFER_LOADING] / count);
    out->unloading_N = sqrt(square[INFER_UNLOADING] / count);
    out->since_turn_N = sqrt(square[INFER_SINCE_TURN] / count);
    out->correlated_N = sqrt(fmax(0.0, beside / count - s->fit.noise.white * s->fit.noise.white));
    double cost = 0.0;
    status = find_evidence(s, &out->evidence);
    if (!status)
        status = cost_of_sizes(s, &cost);
    out->evidence -= cost;
    const bool there = out->evidence > infer_threshold(s->settings);
    e->unexplained_N = there ? explain_fitted_rms(data, s->discrepancy) : 0.0;
    out->found = there && e->unexplained_N > s->settings->good_enough * data->peak;
    return status;
}
