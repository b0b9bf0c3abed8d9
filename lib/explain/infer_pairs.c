/* infer_pairs.c: two effects at once where neither shows alone, as those that are nearly opposite: the lag of
 * a sensor and an arm that the model lacks. With the cosine -c of what they change, each alone takes (1 - c)
 * / 2 of the gain of both. */
#include "infer_search.h"

#include <math.h>
#include <string.h>

/* All pairs of the best effects alone are evaluated; so many of them are fitted. */
enum { BEST = 10, PAIRS = BEST * (BEST - 1) / 2, FINALISTS = 3 };

typedef struct pairs {
    const infer_search *s;
    const infer_trial *trial[BEST]; /* NULL: there are no more */
    double promised[PAIRS];         /* predicted log evidence */
    palp_status status[PAIRS];
} pairs;

static void list_best(pairs *p) {
    bool known[PALP_EFFECT_COUNT] = {false};
    for (int k = 0; k < BEST; k++) {
        int best = PALP_EFFECT_COUNT;
        for (int i = 0; i < PALP_EFFECT_COUNT; i++) {
            const infer_trial *t = &p->s->trial[i];
            if (!known[i] && t->fit.raw && !effect_row_of((palp_effect_id)i)->line &&
                (best == PALP_EFFECT_COUNT || t->gain > p->s->trial[best].gain))
                best = i;
        }
        p->trial[k] = best == PALP_EFFECT_COUNT ? NULL : &p->s->trial[best];
        if (p->trial[k])
            known[best] = true;
    }
}

/* The fit at hand with both effects where they began, evaluated. */
static palp_status add_both(const infer_search *s, const infer_trial *a, const infer_trial *b,
                            infer_fit *fit) {
    palp_model model = s->fit.c.model;
    model.effects[model.n_effects++] = a->start;
    model.effects[model.n_effects++] = b->start;
    palp_status status = infer_fit_create(&model, &s->data, &s->fit, fit);
    if (status)
        return status;
    const bool was = s->fit.c.renewed;
    fit->c.renewed = a->fit.c.renewed != was || b->fit.c.renewed != was ? !was : was;
    status = explain_fit_to_model(&fit->c);
    if (!status)
        status = infer_fit_evaluate(fit, &s->data);
    if (!status)
        status = infer_fit_score(fit, &s->data);
    if (status)
        infer_fit_free(fit);
    return status;
}

/* Pair number i of effects a < b. */
static void place(size_t i, size_t *a, size_t *b) {
    for (*b = 1; i >= *b; (*b)++)
        i -= *b;
    *a = i;
}

static void evaluate_pair(void *user, size_t i) {
    pairs *p = user;
    size_t a, b;
    infer_fit fit;
    place(i, &a, &b);
    p->promised[i] = -HUGE_VAL;
    if (!p->trial[a] || !p->trial[b] ||
        (p->s->settings->stop && p->s->settings->stop(p->s->settings->stop_user)))
        return;
    const palp_status status = add_both(p->s, p->trial[a], p->trial[b], &fit);
    p->status[i] = status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
    if (!status) {
        p->promised[i] = fit.promised;
        infer_fit_free(&fit);
    }
}

/* Gain in log evidence over the fit at hand, less the price of two effects. */
static double gain(const infer_search *s, double score) {
    return score - s->fit.score - 2.0 * infer_price(s);
}

/* Fits a pair; freed unless it exceeds the threshold, and the runs determine both strengths. */
static palp_status settle(const infer_search *s, infer_fit *fit) {
    const size_t n = s->fit.c.model.n_effects;
    const double threshold = infer_threshold(s->settings);
    double changed = 0.0, learned[2] = {0.0, 0.0};
    palp_status status = infer_approach(s, fit);
    if (!status && fit->raw && gain(s, fit->promised) > 0.0)
        status = infer_fit_settle(fit, &s->data, 2, false);
    if (!status && fit->raw && gain(s, fit->score) > 0.0)
        status = infer_settle_with_noise(s, 1, fit);
    if (!status && fit->raw && gain(s, fit->score) > threshold)
        status = infer_begin_anew(fit, &s->data);
    for (size_t i = 0; i < 2 && !status && fit->raw; i++)
        status = infer_learned(fit, &s->data, n + i, &learned[i]);
    if (!status && fit->raw)
        status = infer_change(s, fit, &changed);
    const bool taken = !status && gain(s, fit->score) > threshold && infer_is_shown(learned[0]) &&
                       infer_is_shown(learned[1]) && changed > s->settings->good_enough * s->data.peak;
    if (fit->raw && !taken)
        infer_fit_free(fit);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

palp_status infer_pair_find(infer_search *s, infer_fit *both, palp_effect_id pair[2]) {
    pairs p = {.s = s};
    list_best(&p);
    palp_status status = explain_each(s->settings, PAIRS, evaluate_pair, &p, p.status);
    for (int k = 0; k < FINALISTS && !status; k++) {
        size_t first, second, best = 0;
        infer_fit fit;
        for (size_t i = 1; i < PAIRS; i++)
            best = p.promised[i] > p.promised[best] ? i : best;
        if (!(p.promised[best] > -HUGE_VAL))
            break;
        p.promised[best] = -HUGE_VAL;
        place(best, &first, &second);
        status = add_both(s, p.trial[first], p.trial[second], &fit);
        if (!status)
            status = settle(s, &fit);
        if (!status && fit.raw && (!both->raw || fit.score > both->score)) {
            infer_fit_exchange(both, &fit);
            pair[0] = p.trial[first]->start.id;
            pair[1] = p.trial[second]->start.id;
        }
        if (!status && fit.raw)
            infer_fit_free(&fit);
    }
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}
