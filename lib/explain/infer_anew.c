/* infer_anew.c: the search once more, from the model as given and without a discrepancy. Law and discrepancy
 * of a fit may have absorbed an effect, so that no residual shows it. */
#include "explain_fit.h"
#include "infer_answer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 3, PROMISING = 8, FINALISTS = 3 };

/* Whether the current fit has a discrepancy or another law, which may stand for an effect. */
static palp_status is_left(const infer_search *s, bool *left) {
    const double threshold = infer_threshold(s->settings);
    palp_law nearest;
    double nats;
    infer_fit without;
    palp_status status = infer_law_compare(&s->fit, &s->data, &s->data.given->material.law, &nearest, &nats);
    *left = !status && (s->drive_gain > 0.0 || nats > threshold);
    if (status || *left)
        return status;
    status = infer_without_discrepancy(s, &without);
    if (status)
        return status;
    nats = s->fit.promised - without.promised; /* with other noise it is less */
    infer_fit_free(&without);
    if (nats > threshold)
        status = infer_discrepancy_weigh(s, &nats);
    *left = nats > threshold;
    return status;
}

/* ---- one effect beside the model as given ---- */

typedef struct anew {
    const infer_search *s;
    const infer_fit *base;
    infer_fit fit[PALP_EFFECT_COUNT]; /* raw NULL: there is none */
    palp_status status[PALP_EFFECT_COUNT];
    double promising; /* fits with at least this score go on */
} anew;

/* Frees a fit that failed with this status. */
static palp_status keep_if_had(infer_fit *fit, palp_status status) {
    if (status && fit->raw)
        infer_fit_free(fit);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

/* The model as given with this effect (NULL: none), without a discrepancy. */
static palp_status begin(const infer_search *s, const infer_fit *base, const palp_effect *start,
                         size_t rounds, infer_fit *fit) {
    palp_model model = base->c.model;
    model.material = s->data.given->material;
    if (start)
        model.effects[model.n_effects++] = *start;
    palp_status status = infer_fit_create(&model, &s->data, NULL, fit);
    if (status)
        return status;
    fit->c.renewed = base->c.renewed;
    status = infer_fit_anneal(fit, &s->data, rounds);
    if (status)
        infer_fit_free(fit);
    return status;
}

/* The residual of the model as given, from which effects begin. If that fit fails, the residual of the search
 * takes its place. */
static palp_status find_residual(infer_search *s, const infer_fit *base) {
    infer_fit fit;
    palp_status status = begin(s, base, NULL, 2 * ROUNDS, &fit);
    if (status)
        return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
    status = infer_residual(&fit, &s->data, s->residual, s->discrepancy);
    infer_fit_free(&fit);
    return status;
}

/* Keeps the start with the smallest residual. */
static palp_status enter(const anew *a, const palp_effect *start, infer_fit *best) {
    infer_fit fit;
    const palp_status status = begin(a->s, a->base, start, 0, &fit);
    if (!status && (!best->raw || fit.noise.white < best->noise.white))
        infer_fit_exchange(best, &fit);
    if (!status && fit.raw)
        infer_fit_free(&fit);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

static void try_anew(void *user, size_t i) {
    anew *a = user;
    const infer_search *s = a->s;
    const palp_effect_id id = (palp_effect_id)i;
    const palp_effect_info *info = palp_effect_look_up(id);
    infer_fit *best = &a->fit[i];
    effect_starts starts;
    palp_status status = PALP_OK;
    if (!s->settings->candidate[i] || effect_row_of(id)->line || !explain_carries(&a->base->c.model, info) ||
        (explain_has(&a->base->c, id) && !info->repeats) ||
        explain_starts_find(id, &s->data, s->residual, &starts))
        return;
    for (size_t k = 0; k < starts.n && !status; k++)
        status = enter(a, &starts.effect[k], best);
    if (!status && best->raw)
        status = infer_fit_anneal(best, &s->data, 1);
    a->status[i] = keep_if_had(best, status);
}

static void go_on(void *user, size_t i) {
    anew *a = user;
    if (a->fit[i].raw && a->fit[i].score >= a->promising)
        a->status[i] = keep_if_had(&a->fit[i], infer_fit_anneal(&a->fit[i], &a->s->data, ROUNDS - 1));
}

/* PALP_EFFECT_COUNT: there is none below this score. */
static int best_below(const anew *a, double score) {
    int best = PALP_EFFECT_COUNT;
    for (int i = 0; i < PALP_EFFECT_COUNT; i++)
        if (a->fit[i].raw && a->fit[i].score < score &&
            (best == PALP_EFFECT_COUNT || a->fit[i].score > a->fit[best].score))
            best = i;
    return best;
}

/* The n best ones, in their order; PALP_EFFECT_COUNT: there are no more. */
static void list_best(const anew *a, size_t n, int *list) {
    double score = HUGE_VAL;
    for (size_t k = 0; k < n; k++) {
        list[k] = best_below(a, score);
        score = list[k] == PALP_EFFECT_COUNT ? -HUGE_VAL : a->fit[list[k]].score;
    }
}

/* The best of all, with its noise and sizes estimated; PALP_EFFECT_COUNT: there is none. */
static palp_status find_best(anew *a, int *best) {
    const explain_data *data = &a->s->data;
    int promising[PROMISING], finalist[FINALISTS];
    *best = PALP_EFFECT_COUNT;
    palp_status status = explain_each(a->s->settings, PALP_EFFECT_COUNT, try_anew, a, a->status);
    list_best(a, PROMISING, promising);
    a->promising =
        promising[PROMISING - 1] == PALP_EFFECT_COUNT ? -HUGE_VAL : a->fit[promising[PROMISING - 1]].score;
    if (!status)
        status = explain_each(a->s->settings, PALP_EFFECT_COUNT, go_on, a, a->status);
    list_best(a, FINALISTS, finalist);
    for (int k = 0; k < FINALISTS && finalist[k] != PALP_EFFECT_COUNT && !status; k++)
        status = keep_if_had(&a->fit[finalist[k]], infer_fit_anneal(&a->fit[finalist[k]], data, ROUNDS));
    *best = best_below(a, HUGE_VAL);
    if (status || *best == PALP_EFFECT_COUNT)
        return status;
    infer_fit *fit = &a->fit[*best];
    status = infer_noise_learn(fit, data, 15, true);
    if (!status)
        status = infer_fit_settle(fit, data, 2, true);
    status = keep_if_had(fit, status ? status : infer_fit_converge(fit, data));
    *best = fit->raw ? *best : PALP_EFFECT_COUNT;
    return status;
}

/* ---- the search from there ---- */

/* The first step of a search that took this effect. */
static palp_status copy_step(const infer_search *s, int taken, infer_search *again) {
    if (s->n_steps == 0)
        return PALP_OK;
    again->step = malloc(sizeof *again->step);
    if (!again->step)
        return PALP_ERR_NO_MEMORY;
    *again->step = s->step[0];
    again->step->taken = (palp_effect_id)taken;
    again->n_steps = 1;
    for (size_t k = 0; k < again->step->n_candidates; k++) {
        palp_explain_candidate *c = &again->step->candidate[k];
        c->accepted = c->id == again->step->taken;
    }
    return PALP_OK;
}

/* Exchanges the ends of two searches. */
static void exchange(infer_search *s, infer_search *again) {
    const infer_search was = *s;
    s->fit = again->fit;
    s->drive_gain = again->drive_gain;
    s->step = again->step;
    s->n_steps = again->n_steps;
    again->fit = was.fit;
    again->step = was.step;
}

static double value(const infer_search *s) {
    return s->fit.score - infer_price(s) * (double)infer_added(s);
}

/* Continues from this fit, which it takes over. */
static palp_status search_from(infer_search *s, infer_fit *fit, int taken) {
    infer_trials_free(s);
    infer_search again = *s;
    again.fit = *fit;
    again.drive_gain = 0.0;
    again.step = NULL;
    again.n_steps = 0;
    fit->raw = NULL;
    palp_status status = copy_step(s, taken, &again);
    if (!status)
        status = infer_search_run(&again);
    s->stopped = again.stopped;
    s->told = again.told;
    if (!status && value(&again) > value(s))
        exchange(s, &again);
    infer_trials_free(&again);
    infer_fit_free(&again.fit);
    free(again.step);
    return status;
}

palp_status infer_search_anew(infer_search *s, const infer_fit *base) {
    bool left = false;
    int best = PALP_EFFECT_COUNT;
    palp_status status = s->stopped || s->settings->max_effects == 0 ? PALP_OK : is_left(s, &left);
    anew *a = !status && left ? calloc(1, sizeof *a) : NULL;
    if (status || !left || !a)
        return status || !left ? status : PALP_ERR_NO_MEMORY;
    a->s = s;
    a->base = base;
    status = find_residual(s, base);
    if (!status)
        status = find_best(a, &best);
    if (!status && best != PALP_EFFECT_COUNT &&
        a->fit[best].score - infer_price(s) > fmax(s->first, base->score + infer_threshold(s->settings)))
        status = search_from(s, &a->fit[best], best);
    for (int i = 0; i < PALP_EFFECT_COUNT; i++)
        if (a->fit[i].raw)
            infer_fit_free(&a->fit[i]);
    free(a);
    return status;
}
