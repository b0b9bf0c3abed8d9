/* explain_step.c: a greedy step: which trial is taken, and what it makes superfluous. */
#include "explain_search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char
    ONE_RUN[] = "helps in one experiment only",
    ALONE[] =
        "helps to predict the other parts of this recording: another recording would have to confirm it",
    WITHIN[] = "is within what an effect's equations are good for";

/* What an effect's equations are good for: of the first gap, and of the noise level beside an effect that is
 * there. */
static const double SHADOW = 0.06, SLIGHT = 0.25;

/* Whether coordinate k is at that end of what it may be, to a hundredth of it: the search was still on its
 * way there. */
static bool at(const explain_fit *fit, size_t k, double end) {
    return isfinite(end) && fabs(fit->x[k] - end) <= 0.01 * (fit->logarithmic[k] ? 1.0 : fabs(end));
}

/* Whether a strength, a time or a length of the trial's effect is at the end of what these runs can mean. */
static bool at_an_end(const explain_fit *fit) {
    if (fit->model.n_effects == 0)
        return false;
    const palp_effect *effect = &fit->model.effects[fit->model.n_effects - 1];
    const effect_row *row = effect_row_of(effect->id);
    const palp_effect_info *info = &row->info;
    const size_t first = explain_first_column(&fit->model, fit->model.n_effects - 1);
    for (size_t p = 0; p < info->n_parameters; p++) {
        const palp_effect_parameter *q = &info->parameter[p];
        const size_t k = first + p;
        const bool counts = q->strength || q->scale == PALP_SCALE_TIME || q->scale == PALP_SCALE_LENGTH;
        const bool two_sided = explain_is_period(row, p) || q->low < 0.0;
        if (counts && fit->low[k] < fit->high[k] &&
            ((two_sided && at(fit, k, fit->low[k])) || at(fit, k, fit->high[k])))
            return true;
    }
    return false;
}

/* Whether the trial's effect is one of the frame or the sensor. */
static bool of_the_instrument(const explain_fit *fit) {
    if (fit->model.n_effects == 0)
        return false;
    const palp_effect_info *info = palp_effect_look_up(fit->model.effects[fit->model.n_effects - 1].id);
    return info->place == PALP_EFFECT_FRAME || info->place == PALP_EFFECT_SENSOR;
}

const char *explain_judged(const explain_search *s, const explain_trial *t, double threshold) {
    if (!t->fit.product)
        return t->reason;
    if (!(t->gain > 0.0 && t->raw_gain > threshold))
        return "gains no more than chance does";
    if (!(t->gain > (t->inflation - 1.0) * (t->raw_gain - t->gain) && t->raw_gain > t->inflation * threshold))
        return "gains no more than the model's other faults would";
    if (!(t->beside_zeros > 0.0 && t->beside_zeros + t->raw_gain - t->gain > threshold))
        return "gains no more than zeros that wander in the runs would";
    if (!(t->explained > s->settings->good_enough * s->data.peak))
        return "explains less than the practical limit";
    if (at_an_end(&t->fit))
        return "its estimate is at the end of what these runs can mean";
    const bool alone = explain_fitted_runs(&s->data) == 1; /* parts of it are left out in turn */
    if (!(t->held_out_gain > t->held_out_se))
        return alone ? "does not help to predict a part of the recording left out by more than its standard "
                       "error"
                     : "does not help to predict an experiment left out by more than its standard error";
    if (!(t->held_out_rest > 0.0))
        return alone ? "helps in one part of the recording only" : ONE_RUN;
    if (alone)
        return ALONE;
    const bool slight = !(t->explained > SLIGHT * explain_noise_level(&s->data));
    const bool accuses = slight && of_the_instrument(&t->fit);
    if (accuses && !t->from_zero)
        return "cannot be told from zero, as the runs differ on it";
    if (accuses && !(t->gain > EXPLAIN_CLEAR * t->inflation))
        return "is too small to be certain of beside what the model's equations are good for";
    if ((slight && explain_added_count(s) > 0) || !(t->explained > SHADOW * s->opened))
        return WITHIN;
    return NULL;
}

bool explain_unconfirmed(const char *reason) {
    return reason == ONE_RUN || reason == ALONE;
}

size_t explain_best_trial(const explain_search *s, double threshold, palp_status *status) {
    size_t best = PALP_EFFECT_COUNT;
    for (size_t i = 0; i < PALP_EFFECT_COUNT && !*status; i++) {
        const explain_trial *t = &s->trial[i];
        if (!t->tried || !t->fit.product || !explain_shows(s, (palp_effect_id)i))
            continue;
        if (!explain_judged(s, t, threshold) && (best == PALP_EFFECT_COUNT || t->gain > s->trial[best].gain))
            best = i;
    }
    return best;
}

/* Whether the trial's fit leaves something that is no noise. work: [2 n] */
static palp_status leaves_something(const explain_search *s, explain_trial *t, double *work,
                                    bool *something) {
    explain_rest rest;
    palp_status status = explain_fit_evaluate(&t->fit, &s->data, work, work + s->data.n);
    if (!status)
        status = explain_rest_find(s, work, work + s->data.n, &rest);
    *something = !status && explain_rest_matters(s, &rest);
    return status;
}

palp_status explain_completing_trial(explain_search *s, double threshold, size_t *best) {
    explain_rest rest;
    *best = PALP_EFFECT_COUNT;
    palp_status status = explain_rest_find(s, s->force, s->residual, &rest);
    if (status || !explain_rest_matters(s, &rest))
        return status;
    double *work = malloc(2 * s->data.n * sizeof *work);
    status = work ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < PALP_EFFECT_COUNT && !status; i++) {
        explain_trial *t = &s->trial[i];
        bool something = true;
        if (!t->fit.product || !explain_shows(s, (palp_effect_id)i) ||
            explain_judged(s, t, threshold) != WITHIN)
            continue;
        if (*best == PALP_EFFECT_COUNT || t->gain > s->trial[*best].gain)
            status = leaves_something(s, t, work, &something);
        if (!status && !something)
            *best = i;
    }
    free(work);
    return status;
}

static void remember(explain_search *s) {
    explain_step *step = &s->memory->step[s->memory->n++];
    for (size_t i = 0; i < PALP_EFFECT_COUNT; i++) {
        step->has[i] = s->trial[i].fit.product && !effect_row_of((palp_effect_id)i)->line;
        if (step->has[i])
            step->model[i] = s->trial[i].fit.model;
        step->renewed[i] = s->trial[i].fit.renewed;
    }
}

static void forget(explain_memory *memory, size_t i) {
    memmove(memory->step + i, memory->step + i + 1, (memory->n - i - 1) * sizeof *memory->step);
    memory->n--;
}

palp_status explain_take(explain_search *s, size_t i) {
    if (!effect_row_of((palp_effect_id)i)->line)
        remember(s);
    s->taken_gain = s->trial[i].raw_gain;
    explain_fit_free(&s->fit);
    s->fit = s->trial[i].fit;
    s->trial[i].fit.product = NULL;
    return explain_refit(s);
}

/* Whether the model loses no more without the trial's effect than chance gives. */
static bool needless(const explain_trial *t, double threshold) {
    return t->fit.product && (!(t->gain > 0.0 && t->raw_gain > threshold) || !(t->held_out_gain > 0.0));
}

/* Takes added effect i out if it is needless, or if it gains less than that and would not be added again, now
 * that there are others. */
static palp_status drop_one(explain_search *s, size_t i, double threshold, double gain,
                            palp_effect_id *dropped) {
    explain_search rest;
    palp_effect_id id = explain_added(s, i).id;
    palp_status status = explain_search_without(s, i, &rest);
    bool runs = status != PALP_ERR_NOT_CONVERGED; /* the model without it */
    if (!status)
        status = explain_trial_again(s, &rest, id);
    const explain_trial *again = &rest.trial[id];
    bool weaker = !again->fit.product || again->raw_gain < gain;
    if (!status && ((weaker && explain_judged(&rest, again, threshold)) || needless(again, threshold))) {
        *dropped = id;
        explain_fit_free(&s->fit);
        s->fit = rest.fit;
        rest.fit.product = NULL;
        if (!effect_row_of(id)->line)
            forget(s->memory, i);
        status = explain_refit(s);
    }
    explain_search_free(&rest);
    return runs ? status : PALP_OK;
}

palp_status explain_drop(explain_search *s, double threshold, double gain, bool last,
                         palp_effect_id *dropped) {
    palp_status status = PALP_OK;
    *dropped = PALP_EFFECT_COUNT;
    for (size_t i = 0; i + !last < explain_added_count(s) && !status && *dropped == PALP_EFFECT_COUNT; i++)
        status = drop_one(s, i, threshold, gain, dropped);
    return status;
}

/* ---- which arm is the added one ---- */

static double strangeness(double time, double given_time) {
    return fabs(log(time / given_time));
}

/* A given arm and added effect i that should change places: the given one then is nearer to what it was
 * given. */
static size_t arm_to_swap(const explain_search *s, const palp_effect *added) {
    const palp_material *now = &s->fit.model.material, *given = &s->data.given->material;
    size_t best = PALP_ARMS_MAX;
    double most = 0.0;
    for (size_t j = 0; j < now->n_arms && j < given->n_arms; j++) {
        double was = given->arms[j].viscosity_Ns / given->arms[j].stiffness_N,
               is = now->arms[j].viscosity_Ns / now->arms[j].stiffness_N;
        double nearer = strangeness(is, was) - strangeness(added->value[1], was);
        if (nearer > most) {
            most = nearer;
            best = j;
        }
    }
    return best;
}

/* Exchanges them if the forces stay the same: no effect acts on one of them alone. */
static palp_status swap_arm(explain_search *s, size_t i, size_t j, bool *done) {
    explain_fit swapped;
    palp_model model = s->fit.model;
    *done = false;
    palp_arm *arm = &model.material.arms[j];
    double *added = model.effects[i].value, stiffness = added[0], viscosity = added[0] * added[1];
    added[0] = arm->stiffness_N;
    added[1] = arm->viscosity_Ns / arm->stiffness_N;
    arm->stiffness_N = stiffness;
    arm->viscosity_Ns = viscosity;
    palp_status status = explain_fit_beside(&s->fit, &model, &s->data, &swapped);
    swapped.spread = s->settings;
    if (!status)
        status = explain_fit_products(&swapped, &s->data, NULL);
    *done = !status && swapped.score > explain_fit_score(&s->fit, &s->data) - 1.0;
    explain_fit_free(*done ? &s->fit : &swapped);
    if (*done) {
        s->fit = swapped;
        return explain_refit(s);
    }
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

palp_status explain_keep_given_arms(explain_search *s) {
    palp_status status = PALP_OK;
    for (size_t i = s->n_given; i < s->fit.model.n_effects && !status; i++) {
        const palp_effect *added = &s->fit.model.effects[i];
        bool done = effect_row_of(added->id)->arm && added->value[0] > 0.0;
        for (size_t k = 0; k < s->fit.model.material.n_arms && done && !status; k++) {
            size_t j = arm_to_swap(s, added);
            done = j < PALP_ARMS_MAX;
            if (done)
                status = swap_arm(s, i, j, &done);
        }
    }
    return status;
}
