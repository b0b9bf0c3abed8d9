/* explain.c: an explanation by the evidence: the search, and its result in the caller's form. */
#include <palpate/explain.h>

#include "base/file.h"
#include "explain_result.h"
#include "infer_answer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* More probable than not, below the threshold. */
static bool suspected(const palp_explanation *e) {
    bool some = false;
    for (size_t k = 0; k < e->n_candidates; k++)
        some = some || e->candidate[k].unconfirmed;
    return some;
}

static palp_explain_verdict verdict_of(const palp_explanation *e) {
    if (e->discrepancy.found)
        return PALP_EXPLAIN_UNEXPLAINED;
    for (size_t i = 0; i < e->n_effects; i++)
        if (e->effect[i].n_class > 1)
            return PALP_EXPLAIN_AMBIGUOUS;
    if (e->n_effects > 0)
        return PALP_EXPLAIN_EXPLAINED;
    return e->law.found   ? PALP_EXPLAIN_ANOTHER_LAW
           : suspected(e) ? PALP_EXPLAIN_SUSPECTED
                          : PALP_EXPLAIN_AGREES;
}

static void mark_accepted(palp_explanation *e) {
    for (size_t i = 0; i < e->n_effects; i++) {
        palp_explain_candidate *out = explain_candidate_of(e, e->effect[i].effect.id);
        if (!out)
            continue;
        out->accepted = true;
        out->unconfirmed = false;
        out->reason[0] = '\0';
    }
    for (size_t k = 0; k < e->n_candidates; k++) /* it was taken in a step, and exchanged later */
        if (!e->candidate[k].accepted && e->candidate[k].reason[0] == '\0')
            snprintf(e->candidate[k].reason, sizeof e->candidate[k].reason,
                     "another effect is more probable");
}

static palp_status conclude(infer_search *s, const palp_model *model, palp_explanation *e) {
    const infer_noise *noise = &s->fit.noise;
    double slow = 0.0;
    for (int a = 0; a < INFER_SLOW; a++)
        slow += noise->slow[a] * noise->slow[a];
    e->white_N = infer_white_level(&s->fit, &s->data);
    e->correlated_N = sqrt(slow);
    e->correlation_s = noise->time[0];
    e->gap.noise_level_N = hypot(e->white_N, e->correlated_N);
    e->gap.after_N = explain_fitted_rms(&s->data, s->residual);
    if (s->data.n_runs == 1) { /* no run is left out: all are fitted */
        e->gap.heldout_before_N = e->gap.before_N;
        e->gap.heldout_after_N = e->gap.after_N;
    }
    const double open = e->gap.heldout_before_N - e->gap.noise_level_N;
    e->gap.closed = open > 0.0 ? (e->gap.heldout_before_N - e->gap.heldout_after_N) / open : 0.0;
    e->gap.closed = fmin(1.0, fmax(0.0, e->gap.closed));
    e->replicates = s->data.n_replicates > 0;
    explain_keep_residual(s->residual, e, false);
    palp_status status = infer_scatter_find(s, e);
    if (!status)
        status = infer_discrepancy_find(s, e);
    if (!status)
        status = infer_law_find(s, model, e);
    if (status)
        return status;
    e->verdict = verdict_of(e);
    explain_phase_shares(&s->data, e, e->gap.noise_level_N);
    status = explain_diagnostics_find(&s->data, s->residual, e);
    e->event = s->data.event;
    e->n_events = s->data.n_events;
    s->data.event = NULL;
    return status;
}

/* A step of progress: all of the work is 1. */
static void tell(const infer_search *s, double share) {
    if (s->settings->progress)
        s->settings->progress(s->settings->progress_user, share);
}

/* The effects that were found must predict the runs left out better than no effect; otherwise they are
 * dropped. */
static palp_status confirm(infer_search *s, infer_fit *given, palp_explanation *e) {
    infer_left_out with = {.n = 0}, without;
    double se;
    palp_status status = infer_leave_out(given, &s->data, &without);
    if (!status)
        status = infer_leave_out(&s->fit, &s->data, &with);
    e->gap.heldout_before_N = without.rms_N;
    e->gap.heldout_after_N = with.rms_N;
    const bool some = infer_added(s) > 0 || s->drive_gain > 0.0;
    if (!status && some && !(infer_predicts_better(&with, &without, &se) > 0.0)) {
        const infer_fit found = s->fit;
        for (size_t i = 0; i < infer_added(s); i++) {
            palp_explain_candidate *out = explain_candidate_of(e, infer_added_id(s, i));
            if (!out)
                continue;
            out->unconfirmed = true;
            snprintf(out->reason, sizeof out->reason, "does not improve the prediction of runs left out");
        }
        s->fit = *given;
        *given = found;
        s->drive_gain = 0.0;
        e->gap.heldout_after_N = without.rms_N;
    }
    infer_left_out_free(&with);
    infer_left_out_free(&without);
    return status;
}

/* The given law refitted: the law of its family nearest to the posterior. */
static palp_status find_base(const infer_search *s, const palp_model *model, palp_explanation *e) {
    palp_law nearest;
    double nats;
    palp_status status = infer_law_compare(&s->fit, &s->data, &model->material.law, &nearest, &nats);
    e->base = s->fit.c.model;
    if (!status)
        e->base.material.law = nearest;
    e->null_threshold = infer_threshold(s->settings);
    if (!status)
        status = infer_before_find(s, s->residual);
    e->gap.before_N = explain_fitted_rms(&s->data, s->residual);
    explain_keep_residual(s->residual, e, true);
    return status;
}

/* The gain of each alone is that of the first step. Whether it is identifiable or suspected is conditional on
 * the effects found: from the last step that tried it. */
static void keep_candidates(palp_explanation *e) {
    const palp_explain_step *first = e->step, *last = e->step + e->n_steps - 1;
    e->n_candidates = first->n_candidates;
    memcpy(e->candidate, first->candidate, sizeof e->candidate);
    for (size_t k = 0; k < e->n_candidates; k++) {
        palp_explain_candidate *out = &e->candidate[k];
        const palp_explain_step *step = last;
        while (step > first && !(step->candidate[k].share > 0.0))
            step--;
        const palp_explain_candidate *told = &step->candidate[k];
        if (told->identifiable != out->identifiable)
            memcpy(out->reason, told->reason, sizeof out->reason);
        out->share = told->share;
        out->identifiable = told->identifiable;
        out->unconfirmed = last->candidate[k].unconfirmed;
        out->accepted = false;
    }
}

static palp_status find_effects(infer_search *s, palp_explanation *e) {
    infer_fit given;
    palp_status status = infer_fit_copy(&s->fit, &s->data, &given);
    if (status)
        return status;
    s->first = -HUGE_VAL;
    status = infer_search_run(s);
    if (!status)
        status = infer_search_anew(s, &given);
    e->stopped = s->stopped;
    e->step = s->step;
    e->n_steps = s->n_steps;
    s->step = NULL;
    if (e->n_steps > 0)
        keep_candidates(e);
    if (!status)
        status = confirm(s, &given, e);
    infer_fit_free(&given);
    return status;
}

/* s->fit of the model as given. Effects of the load history may last from run to run or not: the more
 * probable is kept. */
static palp_status begin(infer_search *s, const palp_model *model) {
    infer_fit renewed;
    bool may_recover = false;
    palp_status status = infer_fit_create(model, &s->data, NULL, &s->fit);
    if (!status)
        status = infer_begin(&s->fit, &s->data, s->settings);
    for (size_t i = 0; i < model->n_effects; i++)
        may_recover = may_recover || explain_may_recover(&s->data, model->effects[i].id);
    if (status || !may_recover)
        return status;
    status = infer_fit_create(model, &s->data, NULL, &renewed);
    if (status)
        return status;
    renewed.c.renewed = true;
    status = infer_begin(&renewed, &s->data, s->settings);
    if (!status && renewed.score > s->fit.score)
        infer_fit_exchange(&s->fit, &renewed);
    infer_fit_free(&renewed);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

/* The fit at hand as the answer. An effect may be exchanged for a look-alike, which increases the evidence.
 */
static palp_status describe(infer_search *s, const palp_model *model, palp_explanation *e) {
    palp_status status = PALP_OK;
    bool exchanged = true;
    for (size_t i = 0; exchanged && !status; i++) {
        exchanged = i < s->settings->max_effects;
        status = infer_keep_given_arms(s);
        if (!status)
            status = infer_discrepancy_drop(s, &e->discrepancy.evidence);
        if (status)
            break;
        e->model = s->fit.c.model;
        e->model.material.law.strain_max = model->material.law.strain_max;
        free(e->specimens.between);
        e->specimens.between = NULL;
        status = infer_specimens_find(s, e);
        e->model.between = e->specimens.between;
        e->model.n_specimens = e->specimens.between ? e->specimens.n : 0;
        if (!status)
            status = infer_describe(s, e, &exchanged);
    }
    return status;
}

static palp_status infer(infer_search *s, const palp_model *model, palp_explanation *e) {
    infer_fit terms = {.raw = NULL};
    palp_status status = begin(s, model);
    if (!status)
        status = infer_fit_converge(&s->fit, &s->data);
    if (!status)
        status = explain_copy_runs(&s->data, e);
    if (!status)
        status = infer_residual(&s->fit, &s->data, s->residual, s->discrepancy);
    if (!status)
        status = find_base(s, model, e);
    tell(s, 0.1);
    if (!status)
        status = find_effects(s, e);
    if (!status)
        status = infer_fit_converge(&s->fit, &s->data);
    if (!status)
        status = infer_search_drop(s);
    if (!status)
        status = infer_keep_given_arms(s);
    if (!status)
        status = infer_free_find(s, e, &terms);
    tell(s, INFER_SEARCH_SHARE - s->told);
    if (!status)
        status = describe(s, model, e);
    if (s->n_given > s->data.given->n_effects && e->n_effects < PALP_EXPLAIN_EFFECTS)
        e->effect[e->n_effects++] = explain_frame_effect(&s->data);
    mark_accepted(e);
    tell(s, 0.1);
    if (!status)
        status = conclude(s, model, e);
    if (!status)
        status = infer_free_take(s, e, &terms);
    if (terms.raw)
        infer_fit_free(&terms);
    tell(s, 0.1);
    return status;
}

/* Whether the model can follow the first run; if not, error says why. */
static palp_status can_be_followed(const palp_model *model, infer_search *s, palp_error *error) {
    explain_history history = {.load.peak = 0.0};
    palp_forward_run path = explain_forward_run(&s->data.run[0], 0.0, &history);
    palp_status status = explain_predict(model, &path, s->residual, NULL, error);
    palp_load_history_free(&history.load);
    return status;
}

palp_status palp_explain(const palp_model *model, size_t n, const palp_explain_input *inputs,
                         const palp_explain_settings *settings, palp_explanation *explanation,
                         palp_error *error) {
    palp_model stand_in;
    if (!inputs || !settings || !explanation || (!model && !settings->simulated))
        return palp_error_null(error);
    memset(explanation, 0, sizeof *explanation);
    if (n == 0)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "no runs to explain");
    if (model && settings->simulated)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "both a model and simulated forces");
    if (!model) {
        palp_status status = explain_stand_in(n, inputs, settings, &stand_in, error);
        if (status)
            return status;
        model = &stand_in;
    }
    if (model->n_effects + settings->max_effects + 2 > PALP_EFFECTS_MAX)
        return palp_error_set(error, PALP_ERR_LIMIT,
                              "%zu effects in the model and up to %zu more: at most %d", model->n_effects,
                              settings->max_effects, PALP_EFFECTS_MAX - 2);
    infer_search *s = calloc(1, sizeof *s);
    palp_status status = s ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (s) {
        palp_explain_settings used = *settings;
        if (used.contact == PALP_CONTACT_KNOWN) /* to be exact */
            used.candidate[PALP_EFFECT_CONTACT_OFFSET] = 0;
        s->settings = &used;
        s->n_given = model->n_effects;
        status = explain_data_create(n, inputs, settings, model, &s->data, error);
        if (!status) {
            infer_use_spikes(&s->data);
            status = explain_take_simulated(&s->data, settings->simulated, infer_threshold(settings), error);
        }
        if (!status) {
            explanation->simulated = s->data.simulated;
            explanation->simulated_off_N = s->data.simulated_off;
            s->residual = malloc(2 * s->data.n * sizeof *s->residual);
            s->discrepancy = s->residual ? s->residual + s->data.n : NULL;
            palp_model framed = *model;
            s->n_given += explain_frame_add(&s->data, settings, &framed);
            status = s->residual ? can_be_followed(&framed, s, error) : PALP_ERR_NO_MEMORY;
            if (!status)
                status = infer(s, &framed, explanation);
        }
        free(s->step);
        infer_search_free(s);
        explain_data_free(&s->data);
    }
    free(s);
    if (status)
        palp_explanation_free(explanation);
    return status == PALP_ERR_NO_MEMORY ? palp_error_set(error, status, "out of memory") : status;
}
