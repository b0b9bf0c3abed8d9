/* explain_search.c: settles a fit with its noise, and tries every suspect beside it. */
#include "explain_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double TURN = 6.28318530717958647692;

double explain_rms(size_t n, const double *a, const double *b) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    }
    return sqrt(sum / (double)n);
}

double explain_fitted_rms(const explain_data *data, const double *x) {
    double sum = 0.0, count = 0.0;
    for (size_t r = 0, at = 0; r < data->n_runs; at += data->run[r++].n)
        for (size_t i = 0; i < data->run[r].n && !data->run[r].held; i++)
            if (data->run[r].use[i]) {
                sum += x[at + i] * x[at + i];
                count += 1.0;
            }
    return count > 0.0 ? sqrt(sum / count) : 0.0;
}

void explain_residual(const explain_data *data, const explain_fit *fit, const double *force, double *residual) {
    for (size_t r = 0, at = 0; r < data->n_runs; at += data->run[r++].n) {
        const explain_run *run = &data->run[r];
        double own[EXPLAIN_NUISANCES], sd[EXPLAIN_NUISANCES];
        explain_own(fit, r, own, sd);
        for (size_t i = 0; i < run->n; i++) {
            double hum = 0.0, turn = TURN * fit->hum_Hz * run->time[i];
            if (fit->hum_Hz > 0.0)
                hum = own[3] * sin(turn) + own[4] * cos(turn);
            residual[at + i] = run->use[i] ? run->force[i] - force[at + i] - hum : 0.0;
        }
    }
}

palp_status explain_settle(explain_search *s) {
    enum { ROUNDS = 3 };
    palp_status status = explain_fit_products(&s->fit, &s->data, s->force);
    for (int round = 0; round < ROUNDS && !status; round++) {
        explain_residual(&s->data, &s->fit, s->force, s->residual);
        status = explain_noise_find(&s->data, s->residual);
        if (!status)
            status = explain_fit_products(&s->fit, &s->data, NULL);
        explain_fit_scatter(&s->fit, &s->data, s->settings);
        if (!status)
            status = explain_fit_improve(&s->fit, &s->data, round ? 10 : 30);
        if (!status)
            status = explain_fit_products(&s->fit, &s->data, s->force);
        explain_fit_scatter(&s->fit, &s->data, s->settings);
    }
    explain_residual(&s->data, &s->fit, s->force, s->residual);
    return status;
}

/* ---- suspects ---- */

static palp_status compare(const explain_search *s, explain_trial *t) {
    size_t n = s->data.n_runs, counted = 0;
    double *score = malloc(2 * n * sizeof *score), squares = 0.0, most = -HUGE_VAL;
    if (!score)
        return PALP_ERR_NO_MEMORY;
    palp_status status = explain_fit_leave_out(&s->fit, &s->data, score, NULL);
    if (!status)
        status = explain_fit_leave_out(&t->fit, &s->data, score + n, NULL);
    t->held_gain = 0.0;
    for (size_t r = 0; r < n; r++) {
        if (s->data.run[r].held) {
            score[r] = 0.0;
            continue;
        }
        score[r] = fmax(score[n + r], -1e12) - fmax(score[r], -1e12);
        t->held_gain += score[r];
        most = fmax(most, score[r]);
        counted++;
    }
    for (size_t r = 0; r < n; r++)
        squares += s->data.run[r].held ? 0.0 : pow(score[r] - t->held_gain / (double)counted, 2);
    t->held_rest = t->held_gain - most;
    t->held_se = counted > 1 ? sqrt(squares * (double)counted / (double)(counted - 1)) : 0.0;
    free(score);
    return status;
}

static palp_status try_one(const explain_search *s, palp_effect_id id, explain_trial *t) {
    size_t n = s->data.n;
    palp_status status = explain_suspect_fit(&s->fit, &s->data, s->residual, s->settings, id, s->worth, &t->fit, &t->reason);
    if (status == PALP_ERR_UNSUPPORTED)
        return PALP_OK;
    t->force = status ? NULL : malloc(n * sizeof *t->force);
    if (!status)
        status = t->force ? explain_fit_products(&t->fit, &s->data, t->force) : PALP_ERR_NO_MEMORY;
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
    double cost = id == PALP_EFFECT_MAINS_HUM ? 0.5 : 0.5 * (double)(t->fit.n_columns - s->fit.n_columns);
    t->raw_gain = t->fit.score - s->fit.score;
    t->gain = t->raw_gain - cost * log((double)n);
    double hum = t->fit.hum_Hz > 0.0 && !(s->fit.hum_Hz > 0.0) ? t->fit.hum_N / sqrt(2.0) : 0.0;
    t->explained = hypot(explain_rms(n, t->force, s->force), hum);
    return compare(s, t);
}

typedef struct work {
    explain_search *search;
    palp_status status[PALP_EFFECT_COUNT];
} work;

static void task(void *user, size_t i) {
    work *w = user;
    explain_trial *t = &w->search->trial[i];
    if (!w->search->settings->candidate[i])
        return;
    t->tried = true;
    w->status[i] = try_one(w->search, (palp_effect_id)i, t);
}

palp_status explain_try_all(explain_search *s) {
    work w = {.search = s};
    const palp_explain_settings *set = s->settings;
    double excess = (explain_chi2(&s->data, &s->fit) - 1.0) * (double)explain_samples(&s->data);
    s->worth = fmax(s->worth, 0.02 * excess);
    explain_trials_free(s);
    if (set->loop)
        set->loop(set->loop_user, PALP_EFFECT_COUNT, task, &w);
    else
        for (size_t i = 0; i < PALP_EFFECT_COUNT; i++)
            task(&w, i);
    for (size_t i = 0; i < PALP_EFFECT_COUNT; i++)
        if (w.status[i])
            return w.status[i];
    return PALP_OK;
}

void explain_trials_free(explain_search *s) {
    for (size_t i = 0; i < PALP_EFFECT_COUNT; i++) {
        explain_fit_free(&s->trial[i].fit);
        free(s->trial[i].force);
        s->trial[i] = (explain_trial){0};
    }
}
