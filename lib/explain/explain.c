/* explain.c: the whole procedure: refit, candidates, steps, classes, verdict. */
#include "explain_result.h"
#include "explain_noise.h"
#include "base/file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double MOST_LEFT = 0.2; /* of the gap: if more is left, the effects do not account for it */

/* Of all work, about; of the rest one can say no more beforehand. */
static const double OPENING = 0.05, SEARCH = 0.6, AGAIN = 0.15, DESCRIPTION = 0.15, CLOSING = 0.05;

palp_explain_settings palp_explain_settings_default(void) {
    palp_explain_settings s = {
        .contact = PALP_CONTACT_FREE, .max_effects = 4, .false_alarm = 0.05, .seed = 1};
    memset(s.candidate, 1, sizeof s.candidate);
    return s;
}

const char *palp_explain_verdict_name(palp_explain_verdict verdict) {
    static const char *const names[] = {"agrees",      "explained", "ambiguous",
                                        "unexplained", "suspected", "another_law"};
    return (unsigned)verdict < sizeof names / sizeof *names ? names[verdict] : "unknown";
}

const char *palp_explain_object_name(palp_explain_object object) {
    static const char *const names[] = {"specimen", "air", "block"};
    return (unsigned)object < sizeof names / sizeof *names ? names[object] : "unknown";
}

void palp_explanation_free(palp_explanation *e) {
    if (!e)
        return;
    for (size_t r = 0; e->run && r < e->n_runs; r++)
        free(e->run[r].time_s);
    free(e->run);
    free(e->pressed);
    free(e->event);
    free(e->step);
    free(e->specimens.between);
    memset(e, 0, sizeof *e);
}

/* ---- the procedure ---- */

/* Whether the specimen recovers between the runs of a session from what the model as given has of damage or
 * set. */
static palp_status find_recovery(explain_search *s) {
    explain_fit kept;
    bool may = false;
    for (size_t i = 0; i < s->fit.model.n_effects; i++)
        may = may || explain_may_recover(&s->data, s->fit.model.effects[i].id);
    palp_status status = may ? explain_fit_copy(&s->fit, s->data.n_runs, &kept) : PALP_OK;
    if (status || !may)
        return status;
    s->fit.renewed = true;
    status = explain_refit_anywhere(s);
    if (!status) /* the noise is another since */
        status = explain_fit_products(&kept, &s->data, NULL);
    if (!status && kept.score >= explain_fit_score(&s->fit, &s->data)) {
        explain_fit_free(&s->fit);
        s->fit = kept;
        return explain_refit(s);
    }
    explain_fit_free(&kept);
    return status;
}

static palp_status start(explain_search *s, const palp_model *model, size_t n,
                         const palp_explain_input *inputs, palp_error *error) {
    palp_status status = explain_data_create(n, inputs, s->settings, model, &s->data, error);
    if (!status)
        status = explain_data_one_height(&s->data, error);
    if (status)
        return status;
    n = s->data.n_runs;
    palp_model framed = *model;
    s->n_given += explain_frame_add(&s->data, s->settings, &framed);
    s->force = malloc(s->data.n * sizeof *s->force);
    s->residual = malloc(s->data.n * sizeof *s->residual);
    s->first = malloc(s->data.n * sizeof *s->first);
    if (!s->force || !s->residual || !s->first)
        return PALP_ERR_NO_MEMORY;
    status = explain_fit_create(&framed, &s->data, &s->fit);
    explain_history history = {.load.peak = 0.0};
    for (size_t r = 0, at = 0; r < n && !status; at += s->data.run[r++].n) {
        palp_forward_run path = explain_forward_run(&s->data.run[r], 0.0, &history);
        status = explain_predict(&framed, &path, s->force + at, NULL, error);
    }
    palp_load_history_free(&history.load);
    for (size_t r = 0, at = 0; r < n && !status; at += s->data.run[r++].n)
        for (size_t i = 0; i < s->data.run[r].n; i++)
            s->residual[at + i] = s->data.run[r].force[i] - s->force[at + i];
    if (!status)
        status = explain_noise_find(&s->data, s->residual);
    if (!status)
        status = explain_refit_anywhere(s);
    return status ? status : find_recovery(s);
}

/* ---- the verdict ---- */

/* Effects that leave much of the structure that the model as given left only mimic something else. */
static bool mimicked(const explain_search *s, const palp_explanation *e, double noise_level_N) {
    double gap = sqrt(fmax(0.0, s->opened * s->opened - noise_level_N * noise_level_N));
    return e->n_effects > 0 && e->unexplained_N > MOST_LEFT * gap;
}

/* Whether the only recording has candidates that another one could confirm. */
static bool suspected(const explain_search *s, const palp_explanation *e) {
    bool some = false;
    for (size_t k = 0; k < e->n_candidates; k++)
        some = some || e->candidate[k].unconfirmed;
    return explain_fitted_runs(&s->data) == 1 && some;
}

static palp_explain_verdict judge(const explain_search *s, bool remains, const palp_explanation *e) {
    if (remains)
        return suspected(s, e) ? PALP_EXPLAIN_SUSPECTED : PALP_EXPLAIN_UNEXPLAINED;
    for (size_t i = 0; i < e->n_effects; i++)
        if (e->effect[i].n_class > 1)
            return PALP_EXPLAIN_AMBIGUOUS;
    return e->n_effects || e->law.found || e->specimens.law ? PALP_EXPLAIN_EXPLAINED : PALP_EXPLAIN_AGREES;
}

static void mark(palp_explanation *e, palp_effect_id id, const char *reason) {
    for (size_t k = 0; k < e->n_candidates; k++)
        if (e->candidate[k].id == id) {
            e->candidate[k].accepted = reason == NULL;
            snprintf(e->candidate[k].reason, sizeof e->candidate[k].reason, "%s", reason ? reason : "");
        }
}

static palp_status conclude(explain_search *s, double noise_level_N, palp_explanation *e) {
    palp_explain_gap *gap = &e->gap;
    explain_rest rest;
    gap->noise_level_N = noise_level_N;
    gap->after_N = explain_fitted_rms(&s->data, s->residual);
    double open = gap->heldout_before_N - noise_level_N;
    gap->closed = open > 0.0 ? (gap->heldout_before_N - gap->heldout_after_N) / open : 0.0;
    gap->closed = fmin(1.0, fmax(0.0, gap->closed));
    palp_status status = explain_intervals(s, e);
    if (!status)
        status = explain_rest_find(s, s->force, s->residual, &rest);
    if (status)
        return status;
    explain_keep_residual(s->residual, e, false);
    e->white_N = s->data.run[0].white;
    e->correlated_N = s->data.correlated;
    e->correlation_s = s->data.correlation_time;
    e->replicates = s->data.n_replicates > 0;
    e->unexplained_N = rest.rms_N;
    e->model = s->fit.model;
    e->model.between = e->specimens.between;
    e->model.n_specimens = e->specimens.between ? e->specimens.n : 0;
    explain_add_hum(s, e);
    bool mimics = mimicked(s, e, noise_level_N);
    if (mimics) {
        explain_disown(s, e);
        e->unexplained_N = sqrt(fmax(0.0, s->opened * s->opened - noise_level_N * noise_level_N));
    }
    if (s->n_given > s->data.given->n_effects && e->n_effects < PALP_EXPLAIN_EFFECTS) {
        e->effect[e->n_effects++] = explain_frame_effect(&s->data);
        mark(e, PALP_EFFECT_FRAME_COMPLIANCE, NULL);
    }
    e->verdict = judge(s, mimics || explain_rest_matters(s, &rest), e);
    explain_phase_shares(&s->data, e, noise_level_N);
    for (size_t r = 0, at = 0; r < e->n_runs; at += e->run[r++].n)
        memcpy(s->residual + at, e->run[r].after_N, e->run[r].n * sizeof *s->residual);
    status = explain_diagnostics_find(&s->data, s->residual, e);
    e->event = s->data.event;
    e->n_events = s->data.n_events;
    s->data.event = NULL;
    return status;
}

static palp_status keep_step(const explain_search *s, palp_explanation *e, double threshold,
                             palp_effect_id taken) {
    palp_explain_step *grown = realloc(e->step, (e->n_steps + 1) * sizeof *grown);
    if (!grown)
        return PALP_ERR_NO_MEMORY;
    e->step = grown;
    palp_explain_step *step = &grown[e->n_steps++];
    memset(step, 0, sizeof *step);
    step->taken = explain_added_count(s) < s->settings->max_effects ? taken : PALP_EFFECT_COUNT;
    step->n_candidates = explain_list_candidates(s, threshold, step->candidate);
    for (size_t k = 0; k < step->n_candidates; k++)
        if (step->candidate[k].id == step->taken) {
            step->candidate[k].accepted = true;
            step->candidate[k].reason[0] = '\0';
        }
    return PALP_OK;
}

/* Takes out an effect as explain_drop does, and says why. */
static palp_status drop(explain_search *s, palp_explanation *e, double threshold, double gain, bool last,
                        palp_effect_id *dropped) {
    palp_status status = explain_drop(s, threshold, gain, last, dropped);
    if (!status && *dropped != PALP_EFFECT_COUNT)
        mark(e, *dropped, "is superfluous beside what was added later");
    return status;
}

/* Takes back a law that what was added later makes superfluous, and an effect: of those that gain less than
 * the one taken last; of all where the law was taken back. */
static palp_status tidy(explain_search *s, palp_explanation *e, double threshold, palp_effect_id *dropped) {
    const bool changed = s->law_changed;
    palp_status status = explain_law_review(s, &e->law);
    const bool back = changed && !s->law_changed;
    return status ? status : drop(s, e, threshold, back ? HUGE_VAL : s->taken_gain, back, dropped);
}

/* Another law, or a stiffness of each specimen, instead of the best trial, if it gains more, or if that
 * accuses the contact or the instrument of what is nothing beside that law. */
static palp_status change_law(explain_search *s, double threshold, size_t best, bool *changed) {
    explain_trial law = {.tried = true}, specimens = {.tried = true};
    palp_status status = s->law_fixed ? PALP_OK : explain_law_try(s, threshold, &law);
    if (!status)
        status = explain_specimens_try(s, threshold, &specimens);
    double gain = best == PALP_EFFECT_COUNT ? -HUGE_VAL : s->trial[best].gain;
    const bool differ = !status && specimens.fit.product && specimens.gain > gain &&
                        !(law.fit.product && law.gain > specimens.gain);
    bool stands = true;
    if (!status && law.fit.product && !differ && best != PALP_EFFECT_COUNT && law.gain <= gain)
        status = explain_law_spares(s, &law, &s->trial[best], threshold, &stands);
    *changed = differ || (!status && law.fit.product && (law.gain > gain || !stands));
    if (*changed)
        status = differ ? explain_specimens_take(s, &specimens) : explain_law_take(s, &law);
    explain_law_free(&law);
    explain_law_free(&specimens);
    return status;
}

/* Adds effects as long as one is accepted; what later ones make superfluous is taken out again. share: of all
 * work; a step is told as half of what is left, since how many there will be is not known. */
static palp_status search(explain_search *s, palp_explanation *e, double share) {
    palp_status status = PALP_OK;
    bool out[PALP_EFFECT_COUNT] = {false}; /* was dropped once */
    double threshold = e->null_threshold;
    for (size_t step = 0; explain_added_count(s) <= s->settings->max_effects && !status; step++) {
        palp_effect_id dropped;
        s->step_share = 0.5 * share;
        share -= s->step_share;
        if (step > 0)
            status = explain_null_threshold(s, &threshold, NULL);
        if (!status)
            status = explain_try_all(s);
        if (status == PALP_ERR_STOPPED) {
            e->stopped = true;
            status = PALP_OK;
            break;
        }
        for (size_t i = 0; i < PALP_EFFECT_COUNT; i++)
            if (out[i])
                explain_fit_free(&s->trial[i].fit);
        size_t best = status ? PALP_EFFECT_COUNT : explain_best_trial(s, threshold, &status);
        bool changed = false;
        if (!status)
            status = change_law(s, threshold, best, &changed);
        if (changed)
            continue;
        if (!status && best == PALP_EFFECT_COUNT)
            status = explain_completing_trial(s, threshold, &best);
        if (!status)
            status = keep_step(s, e, threshold, (palp_effect_id)best);
        if (!status && e->n_steps == 1)
            e->n_candidates = explain_list_candidates(s, threshold, e->candidate);
        if (status || best == PALP_EFFECT_COUNT || explain_added_count(s) == s->settings->max_effects)
            break;
        mark(e, (palp_effect_id)best, NULL);
        s->worth = 4.0;
        status = explain_take(s, best);
        if (!status)
            status = tidy(s, e, threshold, &dropped);
        if (!status && dropped != PALP_EFFECT_COUNT)
            out[dropped] = true;
    }
    explain_tell(s, share);
    return status;
}

/* Evidence of all that the search has come to. */
static double worth_of(const explain_search *s, const explain_fit *fit) {
    return fit->score - 0.5 * (double)fit->n_columns * log((double)s->data.n);
}

/* What a search came to, aside. */
typedef struct outcome {
    explain_fit fit;
    explain_memory memory;
    palp_explain_law law;
    palp_material first_material;
    palp_model given;
    size_t n_steps, n_candidates;
    palp_explain_step *step;
    palp_explain_candidate candidate[PALP_EFFECT_COUNT];
} outcome;

/* Moves it aside, or back. */
static void exchange(explain_search *s, palp_explanation *e, outcome *o) {
    const outcome was = *o;
    *o = (outcome){.fit = s->fit,
                   .memory = *s->memory,
                   .law = e->law,
                   .first_material = s->first_material,
                   .given = s->given,
                   .n_steps = e->n_steps,
                   .n_candidates = e->n_candidates,
                   .step = e->step};
    memcpy(o->candidate, e->candidate, sizeof o->candidate);
    s->fit = was.fit;
    *s->memory = was.memory;
    s->first_material = was.first_material;
    s->given = was.given;
    s->law_changed = was.law.found;
    e->law = was.law;
    e->n_steps = was.n_steps;
    e->n_candidates = was.n_candidates;
    e->step = was.step;
    memcpy(e->candidate, was.candidate, sizeof e->candidate);
}

/* Effects beside another law may stand for effects beside the given one, which it kept from being seen: the
 * search once more with the given law, and the better of the two. */
static palp_status search_again(explain_search *s, palp_explanation *e, const explain_fit *base) {
    outcome *o = calloc(1, sizeof *o);
    const palp_model *given = s->data.given;
    palp_status status = o ? explain_fit_copy(base, s->data.n_runs, &o->fit) : PALP_ERR_NO_MEMORY;
    if (!status) {
        exchange(s, e, o);
        s->data.given = s->as_given;
        s->law_fixed = true;
        s->worth = 4.0;
        o->fit.spread = s->settings;
        status = explain_refit(s);
    }
    if (!status)
        status = search(s, e, AGAIN);
    if (!status)
        status = explain_fit_products(&o->fit, &s->data, NULL);
    if (!status)
        status = explain_fit_improve(&o->fit, &s->data, 10);
    if (!status)
        explain_fit_scatter(&o->fit, &s->data, s->settings);
    if (!status && worth_of(s, &o->fit) > worth_of(s, &s->fit)) {
        exchange(s, e, o);
        s->data.given = given;
        status = explain_refit(s);
    }
    if (o) {
        explain_fit_free(&o->fit);
        free(o->step);
    }
    free(o);
    return status;
}

/* Each effect is asked for once more at the end, whenever it was taken. */
static palp_status drop_needless(explain_search *s, palp_explanation *e) {
    palp_effect_id dropped;
    palp_status status;
    do
        status = drop(s, e, e->null_threshold, -HUGE_VAL, true, &dropped);
    while (!status && dropped != PALP_EFFECT_COUNT);
    return status;
}

static palp_status explain(explain_search *s, palp_explanation *e) {
    explain_fit base = {.n_columns = 0};
    palp_status status = explain_copy_runs(s, e);
    if (!status)
        status = explain_fit_copy(&s->fit, s->data.n_runs, &base);
    e->base = s->fit.model;
    s->opened = explain_fitted_rms(&s->data, s->residual);
    if (!status)
        memcpy(s->first, s->residual, s->data.n * sizeof *s->first);
    if (!status)
        status = explain_null_threshold(s, &e->null_threshold, s->share);
    explain_tell(s, OPENING);
    if (!status)
        status = search(s, e, SEARCH);
    if (!status && s->law_changed && explain_added_count(s) > 0 && !e->stopped)
        status = search_again(s, e, &base);
    else
        explain_tell(s, AGAIN);
    if (!status)
        status = explain_keep_given_arms(s);
    if (!status)
        status = explain_law_review(s, &e->law);
    if (!status)
        status = drop_needless(s, e);
    if (!status)
        status = explain_describe(s, e);
    explain_tell(s, DESCRIPTION);
    if (!status)
        status = explain_before_find(s, &base, e);
    if (!status)
        status = explain_scatter_find(s, e);
    if (!status)
        status = explain_specimens_find(s, e);
    explain_fit_free(&base);
    if (!status)
        status = explain_held_out(s, &s->fit, &e->gap.heldout_after_N);
    explain_tell(s, CLOSING);
    return status ? status : conclude(s, explain_noise_level(&s->data), e);
}

palp_status palp_explain(const palp_model *model, size_t n, const palp_explain_input *inputs,
                         const palp_explain_settings *settings, palp_explanation *explanation,
                         palp_error *error) {
    if (!model || !inputs || !settings || !explanation)
        return palp_error_null(error);
    memset(explanation, 0, sizeof *explanation);
    if (n == 0)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "no runs to explain");
    if (model->n_effects + settings->max_effects + 2 > PALP_EFFECTS_MAX)
        return palp_error_set(error, PALP_ERR_LIMIT,
                              "%zu effects in the model and up to %zu more: at most %d", model->n_effects,
                              settings->max_effects, PALP_EFFECTS_MAX - 2);
    explain_search *s = calloc(1, sizeof *s);
    explain_memory *memory = calloc(1, sizeof *memory);
    palp_status status = s && memory ? PALP_OK : PALP_ERR_NO_MEMORY;
    palp_explain_settings used = *settings;
    if (used.contact == PALP_CONTACT_AUTO) /* they are integrated out */
        used.contact = PALP_CONTACT_FREE;
    if (used.contact == PALP_CONTACT_KNOWN) /* to be exact */
        used.candidate[PALP_EFFECT_CONTACT_OFFSET] = 0;
    if (!status) {
        *s = (explain_search){.settings = &used,
                              .worth = 4.0,
                              .memory = memory,
                              .n_given = model->n_effects,
                              .as_given = model};
        status = start(s, model, n, inputs, error);
        if (!status)
            status = explain(s, explanation);
        explain_search_free(s);
        explain_data_free(&s->data);
    }
    free(memory);
    free(s);
    if (status)
        palp_explanation_free(explanation);
    return status == PALP_ERR_NO_MEMORY ? palp_error_set(error, status, "out of memory") : status;
}
