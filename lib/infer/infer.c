/* infer.c: an explanation by the evidence: the search, and what it found as the caller gets it. */
#include <palpate/infer.h>

#include "base/dense.h"
#include "base/file.h"
#include "explain/explain_result.h"
#include "infer_search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

palp_status infer_begin(infer_fit *fit, const explain_data *data) {
    palp_status status = infer_fit_settle(fit, data, 2, false);
    return status ? status : infer_fit_settle(fit, data, 4, true);
}

/* Sum of squares of what the fit, refitted without run r, leaves of it beside what the run has of its own. */
static palp_status left_of_run(infer_search *s, const infer_fit *fit, size_t r, double *squares,
                               double *count) {
    enum { EVALUATIONS = 6 };
    infer_fit without;
    explain_run *run = &s->data.run[r];
    const bool was = run->held_out;
    palp_status status = infer_fit_copy(fit, &s->data, &without);
    if (status)
        return status;
    run->held_out = true;
    if (!was)
        status = infer_fit_improve(&without, &s->data, EVALUATIONS);
    if (!status)
        status = infer_residual(&without, &s->data, s->residual, s->discrepancy);
    run->held_out = was;
    size_t at = 0;
    for (size_t i = 0; i < r; i++)
        at += s->data.run[i].n;
    for (size_t i = at; i < at + run->n && !status; i++)
        *squares += s->residual[i] * s->residual[i];
    *count += (double)run->n;
    infer_fit_free(&without);
    return status;
}

/* rms over the runs that are held out; where none is, over each in turn, but for a single one. */
static palp_status held_out(infer_search *s, const infer_fit *fit, double *rms_N) {
    const bool each = explain_fitted_runs(&s->data) == s->data.n_runs && s->data.n_runs > 1;
    double squares = 0.0, count = 0.0;
    palp_status status = PALP_OK;
    for (size_t r = 0; r < s->data.n_runs && !status; r++)
        if (each || s->data.run[r].held_out)
            status = left_of_run(s, fit, r, &squares, &count);
    *rms_N = count > 0.0 ? sqrt(squares / count) : 0.0;
    return status;
}

/* ---- the accepted effects ---- */

/* Effects whose odds beside the others at hand are within the threshold of those of effect i. */
static palp_status find_class(const infer_search *s, size_t i, palp_explain_effect *out) {
    infer_search rest;
    palp_status status = infer_search_without(s, i, &rest);
    out->evidence = status ? 0.0 : s->fit.score - rest.fit.score;
    if (!status)
        status = infer_try_all(&rest);
    out->alike[out->n_class++] = out->effect.id;
    for (int k = 0; k < PALP_EFFECT_COUNT && !status; k++)
        if (k != (int)out->effect.id && rest.trial[k].fit.raw &&
            rest.trial[k].fit.score > s->fit.score - infer_threshold(s->settings))
            out->alike[out->n_class++] = (palp_effect_id)k;
    if (!status) {
        const double before = explain_fitted_rms(&s->data, rest.residual),
                     after = explain_fitted_rms(&s->data, s->residual), noise = s->fit.noise.white;
        const double gap = before * before - noise * noise;
        out->gap_closed = gap > 0.0 ? fmin(1.0, fmax(0.0, (before * before - after * after) / gap)) : 0.0;
    }
    infer_search_free(&rest);
    return status == PALP_ERR_STOPPED ? PALP_OK : status;
}

/* Intervals of 95 %: of a coordinate, from the posterior's curvature. */
static palp_status find_intervals(const infer_search *s, size_t at, palp_explain_effect *out) {
    infer_posterior p;
    palp_status status = infer_posterior_find(&s->fit, &s->data, &p);
    if (status)
        return status;
    const size_t first = explain_first_column(&s->fit.c.model, at);
    double *unit = calloc(p.g, sizeof *unit);
    for (size_t k = 0; unit && k < palp_effect_look_up(out->effect.id)->n_parameters; k++) {
        memset(unit, 0, p.g * sizeof *unit);
        unit[INFER_HATS + first + k] = 1.0;
        dense_forward(p.g, p.factor, 1, unit);
        const double x = s->fit.c.x[first + k], reach = 1.96 * sqrt(dense_dot(p.g, unit, unit));
        const bool logarithmic = s->fit.c.logarithmic[first + k];
        out->low[k] = logarithmic ? exp(x - reach) : x - reach;
        out->high[k] = logarithmic ? exp(x + reach) : x + reach;
    }
    free(unit);
    infer_posterior_free(&p);
    return unit ? PALP_OK : PALP_ERR_NO_MEMORY;
}

/* The mains' hum: frequency and mean amplitude of the runs' own. */
static palp_status find_hum(const infer_search *s, palp_explain_effect *out) {
    infer_posterior p;
    palp_status status = infer_posterior_find(&s->fit, &s->data, &p);
    double sum = 0.0;
    for (size_t r = 0; r < s->data.n_runs && !status; r++) {
        double own[INFER_BLOCK];
        status = infer_own(&s->fit, &p, r, own, NULL);
        sum += hypot(own[INFER_SINE], own[INFER_COSINE]) / (double)s->data.n_runs;
    }
    infer_posterior_free(&p);
    const double value[2] = {sum, s->fit.c.hum_Hz};
    for (int k = 0; k < 2; k++)
        out->effect.value[k] = out->low[k] = out->high[k] = value[k];
    return status;
}

static palp_status describe(infer_search *s, palp_explanation *e) {
    palp_status status = infer_residual(&s->fit, &s->data, s->residual, s->discrepancy);
    for (size_t i = 0; i < infer_added(s) && !status; i++) {
        const size_t at = s->n_given + i;
        palp_explain_effect *out = &e->effect[e->n_effects++];
        *out = (palp_explain_effect){.effect.id = infer_added_id(s, i)};
        if (at < s->fit.c.model.n_effects) {
            out->effect = s->fit.c.model.effects[at];
            status = find_intervals(s, at, out);
        } else {
            status = find_hum(s, out);
            if (!status && e->model.n_effects < PALP_EFFECTS_MAX)
                e->model.effects[e->model.n_effects++] = out->effect;
        }
        if (!status)
            status = find_class(s, i, out);
    }
    return status;
}

/* ---- what remains ---- */

/* Evidence of the discrepancy: what the fit loses without it, its noise learned anew, nats. */
static palp_status worth_of_discrepancy(const infer_search *s, double *nats) {
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

static palp_explain_verdict verdict_of(const palp_explanation *e, bool remains) {
    if (remains)
        return PALP_EXPLAIN_UNEXPLAINED;
    for (size_t i = 0; i < e->n_effects; i++)
        if (e->effect[i].n_class > 1)
            return PALP_EXPLAIN_AMBIGUOUS;
    return e->n_effects || e->law.found ? PALP_EXPLAIN_EXPLAINED : PALP_EXPLAIN_AGREES;
}

static void list_candidates(const infer_search *s, palp_explanation *e) {
    for (int i = 0; i < PALP_EFFECT_COUNT; i++) {
        if (!s->settings->candidate[i])
            continue;
        palp_explain_candidate *out = &e->candidate[e->n_candidates++];
        const infer_trial *t = &s->trial[i];
        *out = (palp_explain_candidate){.id = (palp_effect_id)i, .identifiable = t->fit.raw != NULL};
        out->score = t->fit.raw ? t->gain : 0.0;
        snprintf(out->reason, sizeof out->reason, "%s",
                 t->reason        ? t->reason
                 : !t->fit.raw    ? "these runs cannot show it"
                 : t->gain <= 0.0 ? "is less probable than nothing"
                                  : "another effect is more probable");
    }
}

static void mark_accepted(palp_explanation *e) {
    for (size_t i = 0; i < e->n_effects; i++)
        for (size_t k = 0; k < e->n_candidates; k++)
            if (e->candidate[k].id == e->effect[i].effect.id) {
                e->candidate[k].accepted = true;
                e->candidate[k].reason[0] = '\0';
            }
}

static palp_status conclude(infer_search *s, palp_explanation *e) {
    const infer_noise *noise = &s->fit.noise;
    double slow = 0.0, nats;
    for (int a = 0; a < INFER_SLOW; a++)
        slow += noise->slow[a] * noise->slow[a];
    e->white_N = noise->white;
    e->correlated_N = sqrt(slow);
    e->correlation_s = noise->time[0];
    e->gap.noise_level_N = hypot(noise->white, e->correlated_N);
    e->gap.after_N = explain_fitted_rms(&s->data, s->residual);
    const double open = e->gap.heldout_before_N - e->gap.noise_level_N;
    e->gap.closed = open > 0.0 ? (e->gap.heldout_before_N - e->gap.heldout_after_N) / open : 0.0;
    e->gap.closed = fmin(1.0, fmax(0.0, e->gap.closed));
    e->zero.sd = s->fit.sizes.own[INFER_ZERO];
    e->contact.sd = s->fit.sizes.own[INFER_CONTACT];
    e->gain.sd = s->fit.sizes.own[INFER_GAIN];
    explain_keep_residual(s->residual, e, false);
    e->unexplained_N = explain_fitted_rms(&s->data, s->discrepancy);
    palp_status status = worth_of_discrepancy(s, &nats);
    if (status)
        return status;
    e->verdict = verdict_of(e, nats > infer_threshold(s->settings) &&
                                   e->unexplained_N > s->settings->good_enough * s->data.peak);
    explain_phase_shares(&s->data, e, e->gap.noise_level_N);
    status = explain_diagnostics_find(&s->data, s->residual, e);
    e->event = s->data.event;
    e->n_events = s->data.n_events;
    s->data.event = NULL;
    return status;
}

/* explain_copy_runs asks a search for its runs alone. */
static palp_status copy_runs(const infer_search *s, palp_explanation *e) {
    explain_search *only = calloc(1, sizeof *only);
    if (!only)
        return PALP_ERR_NO_MEMORY;
    only->data = s->data;
    palp_status status = explain_copy_runs(only, e);
    free(only);
    for (size_t r = 0; r < e->n_runs && !status; r++)
        e->run[r].stiffness = 1.0;
    return status;
}

static palp_status infer(infer_search *s, const palp_model *model, palp_explanation *e) {
    palp_status status = infer_fit_create(model, &s->data, NULL, &s->fit);
    if (!status)
        status = infer_fit_evaluate(&s->fit, &s->data);
    if (!status)
        status = infer_begin(&s->fit, &s->data);
    if (!status)
        status = copy_runs(s, e);
    if (!status)
        status = infer_residual(&s->fit, &s->data, s->residual, s->discrepancy);
    if (status)
        return status;
    e->base = s->fit.c.model;
    e->null_threshold = infer_threshold(s->settings);
    e->gap.before_N = explain_fitted_rms(&s->data, s->residual);
    explain_keep_residual(s->residual, e, true);
    status = held_out(s, &s->fit, &e->gap.heldout_before_N);
    if (!status)
        status = infer_search_run(s);
    if (!status)
        status = held_out(s, &s->fit, &e->gap.heldout_after_N);
    if (status)
        return status;
    e->stopped = s->stopped;
    list_candidates(s, e);
    e->model = s->fit.c.model;
    e->law.found = e->model.material.quasi_linear != model->material.quasi_linear;
    status = describe(s, e);
    mark_accepted(e);
    return status ? status : conclude(s, e);
}

palp_status palp_infer(const palp_model *model, size_t n, const palp_explain_input *inputs,
                       const palp_explain_settings *settings, palp_explanation *explanation,
                       palp_error *error) {
    if (!model || !inputs || !settings || !explanation)
        return palp_error_null(error);
    memset(explanation, 0, sizeof *explanation);
    if (n == 0)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "no runs to explain");
    if (model->kind != PALP_MODEL_LUMPED)
        return palp_error_set(error, PALP_ERR_UNSUPPORTED,
                              "the likelihood takes a lumped model, not a network");
    if (settings->contact == PALP_CONTACT_KNOWN || settings->contact == PALP_CONTACT_COMMON)
        return palp_error_set(error, PALP_ERR_UNSUPPORTED,
                              "the likelihood takes the contact of each run as its own");
    if (model->n_effects + settings->max_effects + 2 > PALP_EFFECTS_MAX)
        return palp_error_set(error, PALP_ERR_LIMIT,
                              "%zu effects in the model and up to %zu more: at most %d", model->n_effects,
                              settings->max_effects, PALP_EFFECTS_MAX - 2);
    infer_search *s = calloc(1, sizeof *s);
    palp_status status = s ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (s) {
        s->settings = settings;
        s->n_given = model->n_effects;
        status = explain_data_create(n, inputs, settings, model, &s->data, error);
        if (!status) {
            s->residual = malloc(2 * s->data.n * sizeof *s->residual);
            s->discrepancy = s->residual ? s->residual + s->data.n : NULL;
            status = s->residual ? infer(s, model, explanation) : PALP_ERR_NO_MEMORY;
        }
        infer_search_free(s);
        explain_data_free(&s->data);
    }
    free(s);
    if (status)
        palp_explanation_free(explanation);
    return status == PALP_ERR_NO_MEMORY ? palp_error_set(error, status, "out of memory") : status;
}
