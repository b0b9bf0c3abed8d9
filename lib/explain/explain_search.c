/* explain_search.c: refits a model with its noise, and tries every candidate beside it. */
#include "explain_search.h"
#include "explain_noise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A line that stands out is no noise, whether the model has it yet or not. */
static palp_status find_noise(explain_search *s) {
    double *rest = malloc(s->data.n * sizeof *rest), frequency, amplitude;
    palp_status status = rest ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status) {
        memcpy(rest, s->residual, s->data.n * sizeof *rest);
        status = explain_line_in_time(&s->data, rest, &frequency, &amplitude);
    }
    if (!status && explain_line_resolved(&s->data))
        explain_line_take(&s->data, frequency, rest);
    if (!status || status == PALP_ERR_UNSUPPORTED)
        status = explain_noise_find(&s->data, rest);
    free(rest);
    return status;
}

palp_status explain_refit(explain_search *s) {
    enum { LEAST = 3, MOST = 12 };
    double risen = 1.0;
    s->fit.spread = s->settings;
    palp_status status = explain_fit_evaluate(&s->fit, &s->data, s->force, s->residual);
    for (int round = 0; round < MOST && (round < LEAST || risen > 0.3) && !status; round++) {
        double before = s->fit.score;
        status = find_noise(s);
        if (!status)
            status = explain_fit_products(&s->fit, &s->data, NULL);
        explain_fit_scatter(&s->fit, &s->data, s->settings);
        if (!status)
            status = explain_fit_improve(&s->fit, &s->data, round ? 10 : 30);
        explain_fit_scatter(&s->fit, &s->data, s->settings);
        if (!status)
            status = explain_fit_evaluate(&s->fit, &s->data, s->force, s->residual);
        explain_fit_scatter(&s->fit, &s->data, s->settings);
        risen = s->fit.score - before;
    }
    return status;
}

/* ---- candidates ---- */

/* Whether the runs agree that the last effect is there, and by how much what is left widens the scatter of
 * its strength. */
static palp_status weigh_strength(explain_fit *fit, const explain_data *data, bool *from_zero,
                                  double *widening) {
    double reach[EXPLAIN_COLUMNS], rise[EXPLAIN_COLUMNS];
    const size_t last = fit->model.n_effects - 1, first = explain_first_column(&fit->model, last);
    const palp_effect_info *info = palp_effect_look_up(fit->model.effects[last].id);
    palp_status status = explain_reaches_find(fit, data, reach, rise);
    *from_zero = false;
    *widening = HUGE_VAL;
    for (size_t p = 0; p < info->n_parameters && !status; p++) {
        double widens;
        if (!info->parameter[p].strength)
            continue;
        const double size = fit->logarithmic[first + p] ? 1.0 : fabs(fit->x[first + p]);
        *from_zero = *from_zero || size > reach[first + p];
        status = explain_widening(fit, data, first + p, &widens);
        *widening = fmin(*widening, widens);
    }
    return status;
}

palp_status explain_trial_examine(const explain_search *s, palp_effect_id id, explain_trial *t) {
    size_t n = s->data.n;
    t->force = malloc(n * sizeof *t->force);
    double *residual = malloc(n * sizeof *residual);
    palp_status status = t->force && residual ? explain_fit_evaluate(&t->fit, &s->data, t->force, residual)
                                              : PALP_ERR_NO_MEMORY;
    if (status)
        free(residual);
    if (status && status != PALP_ERR_NO_MEMORY) {
        explain_fit_free(&t->fit);
        free(t->force);
        t->force = NULL;
        t->reason = "the model has no solution with it";
        return PALP_OK;
    }
    if (status)
        return status;
    explain_fit_scatter(&t->fit, &s->data, s->settings);
    const bool effect = id < PALP_EFFECT_COUNT, line = effect && effect_row_of(id)->line;
    double cost = line ? 0.5 : 0.5 * (double)(t->fit.n_columns - s->fit.n_columns);
    double scanned = effect ? effect_row_of(id)->scanned : 0.0;
    if (effect && explain_may_recover(&s->data, id)) /* whether the specimen recovers is looked at too */
        scanned = 2.0;
    t->raw_gain = t->fit.score - s->fit.score - (scanned > 0.0 ? log(scanned) : 0.0);
    if (effect && effect_row_of(id)->of_runs)
        t->raw_gain = explain_gain_of_mean(&t->fit, &s->data, s->settings, effect_row_of(id), t->raw_gain);
    t->gain = t->raw_gain - cost * log((double)n) - (line ? log(EXPLAIN_FREQUENCIES) : 0.0);
    double hum = t->fit.hum_Hz > 0.0 && !(s->fit.hum_Hz > 0.0) ? t->fit.hum_N / sqrt(2.0) : 0.0;
    t->explained = hypot(explain_rms(n, t->force, s->force), hum);
    explain_pair pair = {.gain = 0.0};
    status = explain_paired(&s->data, &s->fit, &t->fit, &pair);
    if (!status)
        status = explain_rest_inflation(&s->data, residual, &t->inflation);
    double before = 0.0, after = 0.0;
    if (!status && t->gain > 0.0)
        status = explain_wander_find(&s->fit, &s->data, s->settings, &before);
    if (!status && t->gain > 0.0)
        status = explain_wander_find(&t->fit, &s->data, s->settings, &after);
    t->beside_zeros = t->gain + after - before;
    t->from_zero = true;
    double widening = 1.0;
    if (!status && effect && !line)
        status = weigh_strength(&t->fit, &s->data, &t->from_zero, &widening);
    t->inflation = fmax(t->inflation, widening);
    t->held_out_gain = pair.gain;
    t->held_out_se = pair.se;
    t->held_out_rest = pair.rest;
    free(residual);
    return status;
}

typedef struct work {
    explain_search *search;
    double behind; /* chi2 above which a candidate is not refitted */
    palp_status status[PALP_EFFECT_COUNT];
} work;

void explain_tell(const explain_search *s, double share) {
    if (s->settings->progress)
        s->settings->progress(s->settings->progress_user, share);
}

static void multistart(work *w, size_t i) {
    const explain_search *s = w->search;
    explain_trial *t = &w->search->trial[i];
    if (!s->settings->candidate[i])
        return;
    t->tried = true;
    t->multistart = calloc(1, sizeof *t->multistart);
    w->status[i] = PALP_ERR_NO_MEMORY;
    if (t->multistart)
        w->status[i] = explain_candidate_multistart(&s->fit, &s->data, s->residual, s->settings,
                                                    (palp_effect_id)i, s->worth, t->multistart, &t->reason);
    if (w->status[i] == PALP_ERR_UNSUPPORTED) {
        explain_multistart_free(t->multistart);
        w->status[i] = PALP_OK;
    }
}

static bool stop_asked(work *w, size_t i) {
    const palp_explain_settings *settings = w->search->settings;
    bool stop = settings->stop && settings->stop(settings->stop_user);
    w->status[i] = stop ? PALP_ERR_STOPPED : w->status[i];
    return stop;
}

static void multistart_task(void *user, size_t i) {
    work *w = user;
    if (!stop_asked(w, i))
        multistart(w, i);
    explain_tell(w->search, 0.5 * w->search->step_share / PALP_EFFECT_COUNT);
}

static void finish(work *w, size_t i) {
    const explain_search *s = w->search;
    explain_trial *t = &w->search->trial[i];
    if (!t->multistart || t->multistart->n == 0)
        return;
    bool all = t->multistart->start[0].chi2 <= w->behind;
    w->status[i] = explain_candidate_finish(&s->fit, t->multistart, &s->data, s->settings, (palp_effect_id)i,
                                            all, &t->fit);
    if (!w->status[i])
        w->status[i] = explain_trial_examine(s, (palp_effect_id)i, t);
}

static void finish_task(void *user, size_t i) {
    work *w = user;
    if (!stop_asked(w, i))
        finish(w, i);
    explain_tell(w->search, 0.5 * w->search->step_share / PALP_EFFECT_COUNT);
}

palp_status explain_try_all(explain_search *s) {
    work w = {.search = s};
    double samples = (double)explain_samples(&s->data), start = explain_chi2(&s->data, &s->fit) * samples,
           best = start;
    s->worth = fmax(s->worth, 0.02 * (start - samples));
    explain_trials_free(s);
    palp_status status = explain_each(s->settings, PALP_EFFECT_COUNT, multistart_task, &w, w.status);
    for (size_t i = 0; i < PALP_EFFECT_COUNT && !status; i++)
        if (s->trial[i].multistart && s->trial[i].multistart->n > 0)
            best = fmin(best, s->trial[i].multistart->start[0].chi2);
    w.behind = start - EXPLAIN_CONTENDER * (start - best);
    if (!status)
        status = explain_each(s->settings, PALP_EFFECT_COUNT, finish_task, &w, w.status);
    for (size_t i = 0; i < PALP_EFFECT_COUNT; i++) {
        if (s->trial[i].multistart)
            explain_multistart_free(s->trial[i].multistart);
        free(s->trial[i].multistart);
        s->trial[i].multistart = NULL;
    }
    return status;
}

void explain_trials_free(explain_search *s) {
    for (size_t i = 0; i < PALP_EFFECT_COUNT; i++) {
        explain_fit_free(&s->trial[i].fit);
        if (s->trial[i].multistart)
            explain_multistart_free(s->trial[i].multistart);
        free(s->trial[i].multistart);
        free(s->trial[i].force);
        s->trial[i] = (explain_trial){0};
    }
}
