/* explain_describe.c: each accepted effect compared with the fit without it, and against those that could stand in its
 * place. */
#include "explain_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- without one ---- */

size_t explain_added_count(const explain_search *s) {
    return s->fit.model.n_effects - s->n_given + (s->fit.hum_Hz > 0.0);
}

palp_effect explain_added(const explain_search *s, size_t i) {
    if (s->n_given + i < s->fit.model.n_effects)
        return s->fit.model.effects[s->n_given + i];
    return (palp_effect){.id = effect_line(), .value = {0.0, s->fit.hum_Hz}};
}

static palp_status without(const explain_fit *fit, const explain_data *data, size_t n_given, size_t skip,
                           explain_fit *less) {
    palp_model *model = malloc(sizeof *model);
    if (!model)
        return PALP_ERR_NO_MEMORY;
    bool hum = n_given + skip >= fit->model.n_effects;
    *model = fit->model;
    for (size_t i = n_given + skip; !hum && i + 1 < model->n_effects; i++)
        model->effects[i] = model->effects[i + 1];
    model->n_effects -= !hum;
    palp_status status = explain_fit_beside(fit, model, data, less);
    free(model);
    if (hum)
        less->hum_Hz = less->hum_N = 0.0;
    return status;
}

/* A second search on the same data at the fit without added effect i. */
palp_status explain_search_without(const explain_search *full, size_t i, explain_search *rest) {
    size_t bytes = full->data.n * sizeof *rest->force;
    memset(rest, 0, sizeof *rest);
    rest->data = full->data;
    rest->settings = full->settings;
    rest->n_given = full->n_given;
    rest->opened = full->opened;
    rest->force = malloc(bytes);
    rest->residual = malloc(bytes);
    palp_status status = rest->force && rest->residual ? without(&full->fit, &full->data, full->n_given, i, &rest->fit)
                                                       : PALP_ERR_NO_MEMORY;
    if (!status)
        status = explain_fit_products(&rest->fit, &rest->data, NULL);
    for (int round = 0; round < 2 && !status; round++) {
        status = explain_fit_improve(&rest->fit, &rest->data, 20);
        explain_fit_scatter(&rest->fit, &rest->data, rest->settings);
    }
    if (!status)
        status = explain_fit_products(&rest->fit, &rest->data, rest->force);
    explain_fit_scatter(&rest->fit, &rest->data, rest->settings);
    if (!status)
        explain_residual(&rest->data, &rest->fit, rest->force, rest->residual);
    return status;
}

void explain_search_free(explain_search *s) {
    explain_trials_free(s);
    explain_fit_free(&s->fit);
    free(s->force);
    free(s->residual);
}

/* ---- in its place ---- */

palp_status explain_trial_again(const explain_search *full, explain_search *rest, palp_effect_id id) {
    explain_trial *t = &rest->trial[id];
    t->tried = true;
    palp_status status = explain_fit_copy(&full->fit, full->data.n_runs, &t->fit);
    return status ? status : explain_trial_examine(rest, id, t);
}

typedef struct place {
    const explain_search *full;
    explain_search *rest;
    size_t i; /* the added effect that others stand in for */
    palp_status status[PALP_EFFECT_COUNT];
} place;

/* Whether a candidate that promises so little of what the effect gains cannot be alike. */
static palp_status falls_behind(const place *p, const explain_fit *fit, bool *behind) {
    double samples = (double)explain_samples(&p->full->data), promised;
    double with = samples * explain_chi2(&p->full->data, &p->full->fit),
           without_it = samples * explain_chi2(&p->rest->data, &p->rest->fit);
    palp_status status = explain_fit_predict(fit, &p->full->data, &promised);
    *behind = !status && promised > without_it - EXPLAIN_CONTENDER * (without_it - with);
    return status;
}

/* What the search found for candidate c when effect i was added, beside the effects that came later. */
static palp_status stand_in(const place *p, size_t c, explain_fit *fit) {
    const explain_search *full = p->full;
    const palp_model *found = &full->memory->step[p->i].model[c];
    palp_model *model = malloc(sizeof *model);
    if (!model)
        return PALP_ERR_NO_MEMORY;
    *model = full->fit.model;
    size_t at = full->n_given + p->i;
    if (at + 1 == model->n_effects)
        model->material = found->material;
    model->effects[at] = found->effects[found->n_effects - 1];
    palp_status status = explain_fit_beside(&full->fit, model, &full->data, fit);
    free(model);
    if (status)
        return status;
    status = explain_fit_products(fit, &full->data, NULL);
    if (!status)
        status = explain_fit_improve(fit, &full->data, 4);
    bool hopeless = false;
    if (!status)
        status = falls_behind(p, fit, &hopeless);
    explain_fit_scatter(fit, &full->data, full->settings);
    for (size_t rounds = 20; rounds > 2 && !status && !hopeless; rounds /= 4) {
        status = explain_fit_improve(fit, &full->data, rounds);
        explain_fit_scatter(fit, &full->data, full->settings);
    }
    return status;
}

static bool stands(const palp_model *model, size_t id) {
    for (size_t i = 0; i < model->n_effects; i++)
        if (model->effects[i].id == (palp_effect_id)id)
            return true;
    return false;
}

static void place_task(void *user, size_t c) {
    place *p = user;
    explain_trial *t = &p->rest->trial[c];
    palp_effect_id self = explain_added(p->full, p->i).id;
    if (c == (size_t)self) {
        p->status[c] = explain_trial_again(p->full, p->rest, self);
        return;
    }
    bool there = stands(&p->full->fit.model, c) && !palp_effect_look_up((palp_effect_id)c)->repeats;
    if (effect_row_of(self)->line || there || p->i >= p->full->memory->n || !p->full->memory->step[p->i].has[c])
        return;
    t->tried = true;
    palp_status status = stand_in(p, c, &t->fit);
    if (status == PALP_ERR_NO_MEMORY)
        p->status[c] = status;
    else if (status)
        explain_fit_free(&t->fit);
    else
        p->status[c] = explain_trial_examine(p->rest, (palp_effect_id)c, t);
}

static palp_status try_places(const explain_search *full, explain_search *rest, size_t i) {
    place p = {.full = full, .rest = rest, .i = i};
    if (full->settings->loop)
        full->settings->loop(full->settings->loop_user, PALP_EFFECT_COUNT, place_task, &p);
    else
        for (size_t c = 0; c < PALP_EFFECT_COUNT; c++)
            place_task(&p, c);
    for (size_t c = 0; c < PALP_EFFECT_COUNT; c++)
        if (p.status[c])
            return p.status[c];
    return PALP_OK;
}

/* ---- the accepted ones ---- */

/* Share of the squared gap that opens when the effect is taken out again. */
static palp_status closed_by(const explain_search *s, const explain_search *rest, palp_explain_effect *out) {
    double noise_level_N, with = explain_fitted_rms(&s->data, s->residual), less = explain_fitted_rms(&s->data, rest->residual);
    palp_status status = explain_noise_level(&s->data, &s->fit, s->force, &noise_level_N);
    double open = less * less - noise_level_N * noise_level_N;
    out->gap_closed = !status && open > 0.0 ? fmin(1.0, fmax(0.0, (less * less - with * with) / open)) : 0.0;
    return status;
}

palp_status explain_describe(explain_search *s, palp_explanation *e) {
    palp_status status = PALP_OK;
    e->n_effects = explain_added_count(s);
    for (size_t i = 0; i < e->n_effects && !status; i++) {
        explain_search rest;
        palp_explain_effect *out = &e->effect[i];
        out->effect = explain_added(s, i);
        out->alike[0] = out->effect.id;
        out->n_class = 1;
        status = explain_search_without(s, i, &rest);
        if (status == PALP_ERR_NOT_CONVERGED) { /* without it the model does not run: nothing to compare with */
            explain_search_free(&rest);
            status = PALP_OK;
            continue;
        }
        if (!status)
            status = try_places(s, &rest, i);
        if (!status)
            status = explain_class_find(s, &rest, out);
        const explain_trial *own = &rest.trial[out->effect.id];
        if (!status)
            status = explain_next_find(s, &rest, out, &e->next);
        out->evidence = own->held_out_gain;
        out->evidence_se = own->held_out_se;
        if (!status)
            status = closed_by(s, &rest, out);
        explain_search_free(&rest);
    }
    return status;
}
