/* explain_describe.c: each accepted effect compared with the fit without it, and against those that could
 * stand in its place. */
#include "explain_result.h"

#include <math.h>
#include <string.h>

/* ---- in its place ---- */

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
    palp_model model = full->fit.model;
    size_t at = full->n_given + p->i;
    const palp_law *then = &found->material.law, *now = &model.material.law;
    if (at + 1 == model.n_effects && then->kind == now->kind && then->n == now->n)
        model.material = found->material;
    model.effects[at] = found->effects[found->n_effects - 1];
    palp_status status = explain_fit_beside(&full->fit, &model, &full->data, fit);
    if (status)
        return status;
    if (explain_may_recover(&full->data, (palp_effect_id)c))
        fit->renewed = full->memory->step[p->i].renewed[c];
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
    if (effect_row_of(self)->line || there || p->i >= p->full->memory->n ||
        !p->full->memory->step[p->i].has[c])
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
    return explain_each(full->settings, PALP_EFFECT_COUNT, place_task, &p, p.status);
}

/* ---- the accepted ones ---- */

/* Share of the squared gap that opens when the effect is taken out again. */
static void closed_by(const explain_search *s, const explain_search *rest, palp_explain_effect *out) {
    double with = explain_fitted_rms(&s->data, s->residual),
           less = explain_fitted_rms(&s->data, rest->residual);
    double noise_level_N = explain_noise_level(&s->data), open = less * less - noise_level_N * noise_level_N;
    out->gap_closed = open > 0.0 ? fmin(1.0, fmax(0.0, (less * less - with * with) / open)) : 0.0;
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
        out->recovers = s->fit.renewed && explain_may_recover(&s->data, out->effect.id);
        status = explain_search_without(s, i, &rest);
        if (status ==
            PALP_ERR_NOT_CONVERGED) { /* without it the model does not run: nothing to compare with */
            explain_search_free(&rest);
            status = PALP_OK;
            continue;
        }
        if (!status)
            status = try_places(s, &rest, i);
        if (!status)
            status = explain_class_find(s, &rest, e->null_threshold, out);
        const explain_trial *own = &rest.trial[out->effect.id];
        if (!status)
            status = explain_next_find(s, &rest, out, &e->next);
        out->evidence = own->held_out_gain;
        out->evidence_se = own->held_out_se;
        if (!status)
            closed_by(s, &rest, out);
        explain_search_free(&rest);
    }
    return status;
}
