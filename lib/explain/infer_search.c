/* infer_search.c: effects of the catalogue added to a fit, one after the other, by log evidence. */
#include "infer_search.h"
#include "explain_lines.h"
#include "explain_fit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void infer_trials_free(infer_search *s) {
    for (int i = 0; i < INFER_TRIALS; i++) {
        if (s->trial[i].fit.raw)
            infer_fit_free(&s->trial[i].fit);
        if (s->trial[i].second.raw)
            infer_fit_free(&s->trial[i].second);
    }
    memset(s->trial, 0, sizeof s->trial);
}

static void forget_without(infer_search *s) {
    for (size_t i = 0; i < PALP_EXPLAIN_EFFECTS; i++)
        if (s->without[i].raw)
            infer_fit_free(&s->without[i]);
}

void infer_search_free(infer_search *s) {
    infer_trials_free(s);
    forget_without(s);
    if (s->fit.raw)
        infer_fit_free(&s->fit);
    free(s->residual);
    s->residual = s->discrepancy = NULL;
}

size_t infer_added(const infer_search *s) {
    return s->fit.c.model.n_effects - s->n_given + (s->fit.c.hum_Hz > 0.0);
}

palp_effect_id infer_added_id(const infer_search *s, size_t i) {
    const size_t at = s->n_given + i;
    return at < s->fit.c.model.n_effects ? s->fit.c.model.effects[at].id : effect_line();
}

/* ---- one candidate ---- */

/* The drive of the material's arms at a strain, relative to that of linear ones. */
static double drive_of(const palp_material *material, double strain) {
    double first, there;
    if (!material->quasi_linear)
        return 1.0;
    palp_law_stiffness(&material->law, 0.0, &first, NULL);
    palp_law_stiffness(&material->law, strain, &there, NULL);
    return there > 0.0 && first > 0.0 ? there / first : 1.0;
}

/* The material with its arms driven otherwise, as stiff as they were at half the deepest strain. Arms driven
 * by the elastic force are relative to the stiffness at the surface. A spline's knots of nearly no stiffness
 * therefore begin at a tenth of that at half the deepest strain. */
static palp_status drive_otherwise(palp_material *m, double strain) {
    static const double FIRST = 0.1;
    double typical, stiffness[PALP_LAW_MAX], scale = drive_of(m, strain);
    palp_status status = PALP_OK;
    if (!m->quasi_linear && m->law.kind == PALP_LAW_SPLINE) {
        palp_law_stiffness(&m->law, strain, &typical, NULL);
        for (size_t i = 0; i < m->law.n; i++)
            stiffness[i] = fmax(m->law.coefficients[i], FIRST * typical);
        status = palp_law_set_coefficients(&m->law, stiffness);
    }
    m->quasi_linear = !m->quasi_linear;
    scale /= drive_of(m, strain);
    for (size_t j = 0; j < m->n_arms; j++) {
        m->arms[j].stiffness_N *= scale;
        m->arms[j].viscosity_Ns *= scale;
    }
    return status;
}

/* The same of a model, with the arms among its effects. */
static palp_status switch_drive(const infer_search *s, palp_model *model) {
    const double strain = 0.5 * s->data.strain, scale = drive_of(&model->material, strain);
    palp_status status = drive_otherwise(&model->material, strain);
    for (size_t i = 0; i < model->n_effects && !status; i++)
        if (effect_row_of(model->effects[i].id)->arm)
            model->effects[i].value[0] *= scale / drive_of(&model->material, strain);
    return status;
}

/* base with the effect at this start, with the parameters of base; and the reduction of variance there. Arms
 * that depend on the strain are driven by it. */
static palp_status added_at(const infer_search *s, const palp_effect *effect, bool renewed, infer_fit *fit,
                            double *learned) {
    palp_model model = s->fit.c.model;
    palp_status status = PALP_OK;
    if (effect->id == PALP_EFFECT_STRAIN_DEPENDENT_ARM && model.material.quasi_linear)
        status = switch_drive(s, &model);
    model.effects[model.n_effects++] = *effect;
    if (!status)
        status = infer_fit_create(&model, &s->data, &s->fit, fit);
    if (status)
        return status;
    fit->c.renewed = renewed;
    status = explain_fit_to_model(&fit->c);
    if (!status)
        status = infer_fit_evaluate(fit, &s->data);
    if (!status)
        status = infer_learned(fit, &s->data, model.n_effects - 1, learned);
    if (status)
        infer_fit_free(fit);
    return status;
}

/* Keeps in *best the more promising one; the other is freed. */
static void take_better(infer_fit *fit, infer_fit *best) {
    if (best->raw && !(fit->promised > best->promised)) {
        infer_fit_free(fit);
        return;
    }
    if (best->raw)
        infer_fit_free(best);
    *best = *fit;
    memset(fit, 0, sizeof *fit);
}

/* The two most promising starts; all others are evaluated once. */
static palp_status enter(const infer_search *s, const palp_effect *start, bool renewed, infer_fit best[2],
                         double *share) {
    infer_fit fit;
    double learned;
    palp_status status = added_at(s, start, renewed, &fit, &learned);
    if (status)
        return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
    *share = fmax(*share, learned);
    if (best[0].raw && fit.promised > best[0].promised) {
        take_better(&best[0], &best[1]);
        best[0] = fit;
    } else
        take_better(&fit, best[0].raw ? &best[1] : &best[0]);
    return PALP_OK;
}

static palp_status try_hum(const infer_search *s, infer_trial *t) {
    if (s->fit.c.hum_Hz > 0.0)
        return PALP_ERR_UNSUPPORTED;
    double amplitude, hertz;
    palp_status status = explain_line_in_time(&s->data, s->residual, &hertz, &amplitude);
    if (!status)
        status = infer_fit_copy(&s->fit, &s->data, &t->fit);
    if (status)
        return status;
    t->share = 1.0; /* it has no strength but those of the runs */
    t->fit.c.hum_Hz = hertz;
    t->fit.sizes.own[INFER_SINE] = t->fit.sizes.own[INFER_COSINE] = amplitude;
    status = infer_fit_evaluate(&t->fit, &s->data);
    return status ? status : infer_hum_cost(&t->fit, &s->data);
}

static palp_status try_effect(const infer_search *s, palp_effect_id id, infer_trial *t) {
    const palp_effect_info *info = palp_effect_look_up(id);
    effect_starts starts;
    infer_fit best[2] = {{.raw = NULL}, {.raw = NULL}};
    if (!explain_carries(&s->fit.c.model, info) || (explain_has(&s->fit.c, id) && !info->repeats))
        return PALP_ERR_UNSUPPORTED;
    palp_status status = explain_starts_find(id, &s->data, s->residual, &starts);
    for (size_t i = 0; !status && i < starts.n; i++) {
        status = enter(s, &starts.effect[i], s->fit.c.renewed, best, &t->share);
        if (!status && explain_may_recover(&s->data, id))
            status = enter(s, &starts.effect[i], !s->fit.c.renewed, best, &t->share);
    }
    if (effect_row_of(id)->jumps && best[1].raw) /* its whole posterior is scanned, from any start */
        infer_fit_free(&best[1]);
    if (best[0].raw)
        t->start = best[0].c.model.effects[best[0].c.model.n_effects - 1];
    for (int i = 0; i < 2 && !status; i++) /* an outlier without the effect need not be one with it */
        status = best[i].raw ? infer_tails_learn(&best[i], &s->data) : PALP_OK;
    t->fit = best[0];
    t->second = best[1];
    return status;
}

/* The arms driven by the elastic force where they follow the strain, and the reverse (Fung 1993, Eq. 3.77).
 */
static palp_status try_drive(const infer_search *s, infer_trial *t) {
    palp_model model = s->fit.c.model;
    if (model.material.n_arms == 0 || model.kind != PALP_MODEL_LUMPED || s->data.simulated)
        return PALP_ERR_UNSUPPORTED;
    palp_status status = switch_drive(s, &model);
    if (!status)
        status = infer_fit_create(&model, &s->data, &s->fit, &t->fit);
    if (!status)
        infer_noise_begin(&t->fit, &s->data); /* not that of a material that may be far from it */
    return status ? status : infer_fit_evaluate(&t->fit, &s->data);
}

/* The gain of a trial by the better of its fits, which becomes its first. */
static void rank(const infer_search *s, infer_trial *t) {
    if (t->second.raw && (!t->fit.raw || t->second.score > t->fit.score)) {
        const infer_fit better = t->second;
        t->second = t->fit;
        t->fit = better;
    }
    t->gain = t->fit.raw ? t->fit.score - s->fit.score - infer_price(s) : -HUGE_VAL;
}

static bool is_stopped(const infer_search *s, infer_trial *t) {
    const bool stop = s->settings->stop && s->settings->stop(s->settings->stop_user);
    if (stop)
        t->status = PALP_ERR_STOPPED;
    return stop;
}

/* How far the trial changes the residual, and how well the runs determine its strength. */
static palp_status examine(const infer_search *s, infer_trial *t) {
    palp_status status = infer_change(s, &t->fit, &t->explained);
    t->learned = 1.0;
    const size_t n = t->fit.c.model.n_effects;
    return status || n == s->fit.c.model.n_effects ? status
                                                   : infer_learned(&t->fit, &s->data, n - 1, &t->learned);
}

static void try_task(void *user, size_t i) {
    infer_search *s = user;
    infer_trial *t = &s->trial[i];
    if ((i < PALP_EFFECT_COUNT && !s->settings->candidate[i]) || (s->only && !s->only[i]))
        return;
    t->tried = true;
    t->gain = -HUGE_VAL;
    if (is_stopped(s, t))
        return;
    palp_status status = i == INFER_DRIVE                         ? try_drive(s, t)
                         : effect_row_of((palp_effect_id)i)->line ? try_hum(s, t)
                                                                  : try_effect(s, (palp_effect_id)i, t);
    if (status && t->fit.raw)
        infer_fit_free(&t->fit);
    if (status && t->second.raw)
        infer_fit_free(&t->second);
    if (!status)
        status = infer_approach(s, &t->fit);
    if (!status)
        status = infer_approach(s, &t->second);
    t->status = status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
    rank(s, t);
}

/* Brings a trial's fit to convergence if it is among the most promising ones, or if its arms are driven
 * otherwise: that takes more than a few steps. Freed where it fails. */
static palp_status settle_promising(const infer_search *s, infer_fit *fit) {
    const bool driven =
        fit->raw && fit->c.model.material.quasi_linear != s->fit.c.model.material.quasi_linear;
    if (!fit->raw || !(driven || fit->promised >= s->promising))
        return PALP_OK;
    palp_status status = infer_fit_settle(fit, &s->data, 2, false);
    if (status)
        infer_fit_free(fit);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

static void settle_task(void *user, size_t i) {
    infer_search *s = user;
    infer_trial *t = &s->trial[i];
    if (is_stopped(s, t))
        return;
    t->status = settle_promising(s, &t->fit);
    if (!t->status)
        t->status = settle_promising(s, &t->second);
    rank(s, t);
    if (t->second.raw)
        infer_fit_free(&t->second);
    if (!t->status && t->fit.raw)
        t->status = examine(s, t);
}

static void finish_task(void *user, size_t i) {
    infer_search *s = user;
    infer_trial *t = &s->trial[i];
    if (!t->fit.raw || !t->tried || is_stopped(s, t))
        return;
    t->status = infer_settle_with_noise(s, 1, &t->fit);
    rank(s, t);
    if (!t->status &&
        t->gain > infer_threshold(s->settings)) { /* it may be taken, so it begins in both ways */
        t->status = infer_begin_anew(&t->fit, &s->data);
        rank(s, t);
    }
    if (!t->status && t->fit.raw)
        t->status = examine(s, t);
}

/* So many fits converge, and so many finalists estimate the noise too. */
enum { SETTLED = 8, FINALISTS = 3 };

/* The predicted evidence of the last of the most promising fits. */
static double find_promising(const infer_search *s) {
    double least = HUGE_VAL;
    for (int k = 0; k < SETTLED; k++) {
        double next = -HUGE_VAL;
        for (int i = 0; i < 2 * INFER_TRIALS; i++) {
            const infer_trial *t = &s->trial[i / 2];
            const infer_fit *fit = i % 2 ? &t->second : &t->fit;
            if (fit->raw && fit->promised < least)
                next = fmax(next, fit->promised);
        }
        least = next;
    }
    return least;
}

static palp_status each(infer_search *s, void (*task)(void *, size_t)) {
    palp_status status[INFER_TRIALS] = {PALP_OK};
    explain_each(s->settings, INFER_TRIALS, task, s, status);
    for (int i = 0; i < INFER_TRIALS; i++)
        if (s->trial[i].status)
            return s->trial[i].status;
    return PALP_OK;
}

palp_status infer_try_all(infer_search *s) {
    infer_trials_free(s);
    palp_status status = infer_residual(&s->fit, &s->data, s->residual, s->discrepancy);
    if (!status)
        status = each(s, try_task);
    s->promising = status ? HUGE_VAL : find_promising(s);
    if (!status)
        status = each(s, settle_task);
    double least = HUGE_VAL;
    for (int k = 0; k < FINALISTS && !status; k++) { /* the gain of the last finalist */
        double next = -HUGE_VAL;
        for (int i = 0; i < INFER_TRIALS; i++)
            if (s->trial[i].fit.raw && s->trial[i].gain < least)
                next = fmax(next, s->trial[i].gain);
        least = next;
    }
    for (int i = 0; i < INFER_TRIALS; i++)
        s->trial[i].tried = s->trial[i].tried && s->trial[i].gain >= least;
    return status ? status : each(s, finish_task);
}

/* ---- sets ---- */

bool infer_may_be_named(const infer_search *s, const infer_trial *t) {
    return t->fit.raw && infer_is_shown(t->learned) && t->explained > s->settings->good_enough * s->data.peak;
}

/* INFER_TRIALS: there is none. */
static int best_trial(const infer_search *s) {
    int best = INFER_TRIALS;
    for (int i = 0; i < INFER_TRIALS; i++)
        if (infer_may_be_named(s, &s->trial[i]) &&
            (best == INFER_TRIALS || s->trial[i].gain > s->trial[best].gain))
            best = i;
    return best;
}

static void take(infer_search *s, int id) {
    if (id == INFER_DRIVE)
        s->drive_gain = s->drive_gain > 0.0 ? 0.0 : s->trial[id].gain;
    infer_fit_free(&s->fit);
    s->fit = s->trial[id].fit;
    s->trial[id].fit.raw = NULL;
}

/* full's fit with this model, in both ways: the removed effect may have reduced some sizes to 0. */
static palp_status settle_without(const infer_search *full, const palp_model *model, bool hum,
                                  infer_fit *fit) {
    enum { ROUNDS = 3 };
    palp_status status = infer_fit_create(model, &full->data, &full->fit, fit);
    if (!status && hum) {
        fit->c.hum_Hz = fit->c.hum_cost = 0.0;
        fit->sizes.own[INFER_SINE] = fit->sizes.own[INFER_COSINE] = 0.0;
    }
    if (!status)
        status = infer_fit_evaluate(fit, &full->data);
    if (!status)
        status = infer_fit_settle(fit, &full->data, ROUNDS, true);
    return status ? status : infer_begin_anew(fit, &full->data);
}

palp_status infer_search_without(const infer_search *full, size_t i, infer_search *rest) {
    *rest = *full;
    rest->step_share = 0.0;
    memset(rest->trial, 0, sizeof rest->trial);
    memset(rest->without, 0, sizeof rest->without);
    memset(&rest->fit, 0, sizeof rest->fit);
    rest->residual = malloc(2 * full->data.n * sizeof *rest->residual);
    if (!rest->residual)
        return PALP_ERR_NO_MEMORY;
    rest->discrepancy = rest->residual + full->data.n;
    if (full->without[i].raw)
        return infer_fit_copy(&full->without[i], &full->data, &rest->fit);
    palp_model model = full->fit.c.model;
    const size_t at = full->n_given + i;
    const bool hum = at >= model.n_effects;
    for (size_t k = at; k + 1 < model.n_effects; k++)
        model.effects[k] = model.effects[k + 1];
    model.n_effects -= !hum;
    return settle_without(full, &model, hum, &rest->fit);
}

/* Evidence of an effect in the fit at hand, if rest is the search without it; nats. */
static double worth_over(const infer_search *s, const infer_search *rest) {
    return s->fit.score - infer_price(s) - rest->fit.score;
}

void infer_search_go_on(infer_search *s, infer_search *rest) {
    forget_without(s);
    infer_fit_free(&s->fit);
    s->fit = rest->fit;
    s->drive_gain = rest->drive_gain;
    rest->fit.raw = NULL;
}

void infer_search_exchange(infer_search *s, infer_search *rest, int id) {
    take(rest, id);
    infer_search_go_on(s, rest);
}

/* Removes an effect whose evidence is below the threshold, or exchanges one for a better one. A single one
 * was just compared with none. */
static palp_status review(infer_search *s, bool *changed) {
    palp_status status = PALP_OK;
    *changed = false;
    const size_t n = infer_added(s);
    for (size_t i = 0; i < n && n > 1 && !status && !*changed; i++) {
        infer_search rest;
        status = infer_search_without(s, i, &rest);
        const double stays = status ? 0.0 : worth_over(s, &rest);
        *changed = !status && stays < infer_threshold(s->settings);
        if (!status && !*changed) {
            status = infer_try_all(&rest);
            const int best = status ? INFER_TRIALS : best_trial(&rest);
            *changed = best != INFER_TRIALS && best != (int)infer_added_id(s, i) &&
                       rest.trial[best].gain > stays + infer_threshold(s->settings);
            if (*changed)
                take(&rest, best);
        }
        if (*changed)
            infer_search_go_on(s, &rest);
        infer_search_free(&rest);
    }
    return status;
}

palp_status infer_search_drop(infer_search *s) {
    palp_status status = PALP_OK;
    for (size_t i = infer_added(s); i-- > 0 && !status;) {
        infer_search rest;
        status = infer_search_without(s, i, &rest);
        if (!status && worth_over(s, &rest) < infer_threshold(s->settings)) {
            infer_search_go_on(s, &rest);
            status = infer_fit_converge(&s->fit, &s->data);
        } else if (!status)
            infer_fit_exchange(&s->without[i], &rest.fit);
        infer_search_free(&rest);
    }
    return status;
}

/* ---- steps ---- */

/* lack: [EFFECT_LACK_MAX], what the runs do not contain. */
static const char *why_not(const infer_search *s, int id, char *lack) {
    const infer_trial *t = &s->trial[id];
    if (!infer_is_shown(t->share)) {
        const effect_data facts = explain_facts(&s->data);
        return effect_need_met(effect_row_of((palp_effect_id)id), &facts, lack) ? "these runs cannot show it"
                                                                                : lack;
    }
    if (!(t->gain > 0.0))
        return "is less probable than nothing";
    if (!infer_may_be_named(s, t))
        return infer_is_shown(t->learned) ? "explains less than the practical limit"
                                          : "these runs cannot show it";
    return t->gain > infer_threshold(s->settings) ? "another effect is more probable"
                                                  : "is more probable than not, but not by enough";
}

/* Keeps the trials as a step, of which best is taken (INFER_TRIALS: none). */
static palp_status keep_step(infer_search *s, int best) {
    palp_explain_step *grown = realloc(s->step, (s->n_steps + 1) * sizeof *grown);
    if (!grown)
        return PALP_ERR_NO_MEMORY;
    s->step = grown;
    palp_explain_step *step = &grown[s->n_steps++];
    *step = (palp_explain_step){.taken = best < PALP_EFFECT_COUNT ? (palp_effect_id)best : PALP_EFFECT_COUNT};
    for (int i = 0; i < PALP_EFFECT_COUNT; i++) {
        const infer_trial *t = &s->trial[i];
        const bool accepted = i == best;
        if (!s->settings->candidate[i])
            continue;
        palp_explain_candidate *out = &step->candidate[step->n_candidates++];
        *out = (palp_explain_candidate){.id = (palp_effect_id)i,
                                        .identifiable = infer_is_shown(t->share),
                                        .share = t->share,
                                        .accepted = accepted,
                                        .score = t->fit.raw ? t->gain : 0.0,
                                        .explained_N = t->explained};
        out->unconfirmed = infer_may_be_named(s, t) && !accepted && t->gain > 0.0;
        char lack[EFFECT_LACK_MAX];
        if (!accepted)
            snprintf(out->reason, sizeof out->reason, "%s", why_not(s, i, lack));
    }
    s->told += s->step_share;
    if (s->settings->progress)
        s->settings->progress(s->settings->progress_user, s->step_share);
    return PALP_OK;
}

palp_status infer_search_run(infer_search *s) {
    palp_status status = PALP_OK;
    bool changed = false;
    for (size_t step = 0; step < 2 * s->settings->max_effects + 2 && !status; step++) {
        if (infer_added(s) >= s->settings->max_effects)
            break;
        s->step_share = 0.5 * (INFER_SEARCH_SHARE - s->told); /* their number is not known in advance */
        status = infer_try_all(s);
        const int best = status ? INFER_TRIALS : best_trial(s);
        const bool worth = best != INFER_TRIALS && s->trial[best].gain > infer_threshold(s->settings);
        infer_fit both = {.raw = NULL};
        palp_effect_id pair[2];
        if (!status && !worth && infer_added(s) + 2 <= s->settings->max_effects)
            status = infer_pair_find(s, &both, pair);
        for (int i = 0; i < 2 && both.raw && !status; i++)
            status = keep_step(s, (int)pair[i]);
        if (!status && !both.raw)
            status = keep_step(s, worth ? best : INFER_TRIALS);
        if (status || !(worth || both.raw)) {
            if (both.raw)
                infer_fit_free(&both);
            break;
        }
        if (worth)
            take(s, best);
        else {
            infer_fit_exchange(&s->fit, &both);
            infer_fit_free(&both);
        }
        status = infer_settle_with_noise(s, 2, &s->fit);
        if (step == 0)
            s->first = s->fit.score - infer_price(s) * (double)infer_added(s);
        if (!status)
            status = review(s, &changed);
    }
    for (size_t i = 0; i < s->settings->max_effects && changed && !status; i++)
        status = review(s, &changed);
    s->stopped = status == PALP_ERR_STOPPED;
    return s->stopped ? PALP_OK : status;
}
