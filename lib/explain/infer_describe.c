/* infer_describe.c: the accepted effects: intervals, evidence and look-alikes. */
#include "infer_answer.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How the evidence of an effect scatters over the runs in turn, each predicted from the others. */
static palp_status find_gain(infer_search *s, const infer_search *rest, palp_explain_effect *out) {
    infer_left_out with, without = {.n = 0};
    palp_status status = infer_leave_out(&s->fit, &s->data, &with);
    if (!status)
        status = infer_leave_out(&rest->fit, &s->data, &without);
    if (!status)
        infer_predicts_better(&with, &without, &out->evidence_se);
    infer_left_out_free(&with);
    infer_left_out_free(&without);
    return status;
}

/* A trial's fit to convergence, with a discrepancy only where that is more probable: as the fit at hand. net:
 * its score less the cost of its discrepancy's sizes, since another fit may have none. */
static palp_status finish(infer_search *rest, infer_fit *fit, double *net) {
    double nats;
    palp_status status = infer_fit_converge(fit, &rest->data);
    if (status)
        return status;
    infer_fit_exchange(&rest->fit, fit);
    status = infer_discrepancy_drop(rest, &nats);
    if (!status)
        status = infer_discrepancy_cost(rest, &nats);
    infer_fit_exchange(&rest->fit, fit);
    *net = fit->score - nats;
    return status;
}

/* Effects whose odds, conditional on the others, are within the threshold of the current fit's. The most
 * probable ones are fitted to convergence, up to the first one beyond the threshold. *better: the most
 * probable one that exceeds the effect itself, as the search compares fits short of convergence. */
static palp_status find_alike(const infer_search *s, infer_search *rest, palp_explain_effect *out,
                              int *better) {
    bool known[PALP_EFFECT_COUNT] = {false};
    double cost = 0.0, net = 0.0;
    palp_status status = infer_discrepancy_cost(s, &cost);
    double most = s->fit.score - cost;
    const double least = most - infer_threshold(s->settings);
    out->alike[out->n_class++] = out->effect.id;
    while (!status) {
        int best = PALP_EFFECT_COUNT;
        for (int k = 0; k < PALP_EFFECT_COUNT; k++) {
            const infer_fit *fit = &rest->trial[k].fit;
            if (k != (int)out->effect.id && !known[k] && fit->raw &&
                (best == PALP_EFFECT_COUNT || fit->score > rest->trial[best].fit.score))
                best = k;
        }
        if (best == PALP_EFFECT_COUNT)
            break;
        known[best] = true;
        status = finish(rest, &rest->trial[best].fit, &net);
        if (status || net < least)
            break;
        out->alike[out->n_class++] = (palp_effect_id)best;
        if (net > most && infer_may_be_named(s, &rest->trial[best])) {
            most = net;
            *better = best;
        }
    }
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

/* Effects that may resemble this one. The first step (NULL: there was none) tried each effect alone. If the
 * only effect exceeded the threshold there, an effect less probable than none is no look-alike: the
 * difference of their log evidences exceeds the threshold too. */
static void find_likely(const infer_search *s, const palp_explain_step *first, palp_effect_id id,
                        bool likely[INFER_TRIALS]) {
    bool known = false;
    for (size_t k = 0; first && k < first->n_candidates; k++)
        known = known ||
                (first->candidate[k].id == id && first->candidate[k].score > infer_threshold(s->settings));
    known = known && infer_added(s) == 1 && first->taken != PALP_EFFECT_COUNT;
    for (int k = 0; k < INFER_TRIALS; k++)
        likely[k] = k != INFER_DRIVE && !known;
    for (size_t k = 0; known && k < first->n_candidates; k++)
        likely[first->candidate[k].id] = first->candidate[k].score > 0.0;
    likely[id] = false;
}

/* exchanged: a look-alike may take the effect's place; it has, and nothing else of *out is known. */
static palp_status find_class(infer_search *s, size_t i, const palp_explain_step *first,
                              palp_explain_effect *out, palp_explain_next *next, bool *exchanged) {
    infer_search rest;
    bool likely[INFER_TRIALS];
    int better = PALP_EFFECT_COUNT;
    palp_status status = infer_search_without(s, i, &rest);
    find_likely(s, first, out->effect.id, likely);
    rest.only = likely;
    out->evidence = status ? 0.0 : s->fit.score - rest.fit.score;
    if (!status)
        status = infer_try_all(&rest);
    if (!status)
        status = find_alike(s, &rest, out, &better);
    *exchanged = *exchanged && !status && better != PALP_EFFECT_COUNT;
    if (*exchanged)
        infer_search_exchange(s, &rest, better);
    if (!status && !*exchanged)
        status = find_gain(s, &rest, out);
    if (!status && !*exchanged)
        status = infer_next_find(s, &rest, out, next);
    if (!status && !*exchanged) {
        const double before = explain_fitted_rms(&s->data, rest.residual),
                     after = explain_fitted_rms(&s->data, s->residual),
                     noise = infer_white_level(&s->fit, &s->data);
        const double gap = before * before - noise * noise;
        out->gap_closed = gap > 0.0 ? fmin(1.0, fmax(0.0, (before * before - after * after) / gap)) : 0.0;
    }
    infer_search_free(&rest);
    return status == PALP_ERR_STOPPED ? PALP_OK : status;
}

/* Intervals of 95 %, from the posterior's curvature: in the logarithm for parameters that cannot be negative.
 * For a parameter by which the forces jump, from the posterior itself. */
static palp_status find_intervals(const infer_search *s, size_t at, palp_explain_effect *out) {
    infer_posterior p;
    palp_status status = infer_posterior_find(&s->fit, &s->data, &p);
    if (status)
        return status;
    const size_t first = explain_first_column(&s->fit.c.model, at);
    double *unit = calloc(p.g, sizeof *unit);
    const palp_effect_info *info = palp_effect_look_up(out->effect.id);
    for (size_t k = 0; unit && k < info->n_parameters && !status; k++) {
        memset(unit, 0, p.g * sizeof *unit);
        unit[p.hats + first + k] = infer_tail_widening(&s->fit);
        dense_forward(p.g, p.factor, 1, unit);
        const double reach = 1.96 * sqrt(dense_dot(p.g, unit, unit)), value = out->effect.value[k];
        const bool logarithmic = s->fit.c.logarithmic[first + k];
        const bool positive = logarithmic || (info->parameter[k].low >= 0.0 && value > 0.0);
        const double ratio = exp(logarithmic ? reach : reach / value);
        out->low[k] = positive ? value / ratio : value - reach;
        out->high[k] = positive ? value * ratio : value + reach;
        if (s->fit.scan[first + k].jumps) {
            const infer_scan *scan = &s->fit.scan[first + k];
            double sd = 0.0;
            if (info->parameter[k].strength)
                status = infer_scan_pull(&s->fit, &s->data, &p, first + k, &sd);
            out->low[k] = logarithmic ? exp(scan->low) : value - hypot(value - scan->low, 1.96 * sd);
            out->high[k] = logarithmic ? exp(scan->high) : value + hypot(scan->high - value, 1.96 * sd);
        }
    }
    free(unit);
    infer_posterior_free(&p);
    return unit ? status : PALP_ERR_NO_MEMORY;
}

static palp_status find_hum(const infer_search *s, palp_explain_effect *out) {
    double amplitude, variance, information;
    palp_status status = infer_hum_measure(&s->fit, &s->data, &amplitude, &variance, &information);
    const double reach = 1.96 * infer_tail_widening(&s->fit);
    const double value[2] = {amplitude, s->fit.c.hum_Hz},
                 sd[2] = {sqrt(variance), information > 0.0 ? 1.0 / sqrt(information) : 0.0};
    for (int k = 0; k < 2; k++) {
        out->effect.value[k] = value[k];
        out->low[k] = value[k] - reach * sd[k];
        out->high[k] = value[k] + reach * sd[k];
    }
    return status;
}

palp_status infer_describe(infer_search *s, palp_explanation *e, bool *exchanged) {
    palp_status status = infer_residual(&s->fit, &s->data, s->residual, s->discrepancy);
    const bool may = *exchanged;
    *exchanged = false;
    e->n_effects = 0;
    e->next = (palp_explain_next){.wanted = false};
    for (size_t i = 0; i < infer_added(s) && !status && !*exchanged; i++) {
        const size_t at = s->n_given + i;
        palp_explain_effect *out = &e->effect[e->n_effects++];
        *out = (palp_explain_effect){.effect.id = infer_added_id(s, i)};
        out->recovers = s->fit.c.renewed && explain_may_recover(&s->data, out->effect.id);
        if (at < s->fit.c.model.n_effects) {
            out->effect = s->fit.c.model.effects[at];
            status = find_intervals(s, at, out);
        } else {
            status = find_hum(s, out);
            if (!status && e->model.n_effects < PALP_EFFECTS_MAX)
                e->model.effects[e->model.n_effects++] = out->effect;
        }
        *exchanged = may;
        if (!status)
            status = find_class(s, i, e->n_steps > 0 ? e->step : NULL, out, &e->next, exchanged);
    }
    return status;
}
