/* explain.c: the whole procedure: refit, suspects, greedy steps, backward deletion, classes, verdict. */
#include "explain_internal.h"
#include "file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double MOST_LEFT = 0.35;  /* of the gap: if more is left, the effects do not account for it */
static const double SHADOW = 0.1;      /* of the first gap: a second effect must explain more */
static const double REMAINS = 1.0;     /* floors of structure that are more than the floor */
static const double UNREPEATABLE = 4.0; /* times the expected scatter between runs of one protocol */

palp_explain_settings palp_explain_settings_default(void) {
    palp_explain_settings s = {.max_effects = 4, .false_alarm = 0.05, .practical_share = 0.5, .repeatability = 0.003,
                               .contact_scatter_m = 3e-6, .seed = 1};
    memset(s.candidate, 1, sizeof s.candidate);
    return s;
}

const char *palp_explain_verdict_name(palp_explain_verdict verdict) {
    static const char *const names[] = {"agrees", "explained", "ambiguous", "unexplained"};
    return (unsigned)verdict < 4 ? names[verdict] : "unknown";
}

const char *palp_explain_phase_name(palp_explain_phase phase) {
    static const char *const names[] = {"air", "ramp", "corner", "early_hold", "late_hold", "unload", "recovery", "reload"};
    return (unsigned)phase < PALP_PHASE_COUNT ? names[phase] : "unknown";
}

void palp_explanation_free(palp_explanation *e) {
    if (!e)
        return;
    for (size_t r = 0; e->run && r < e->n_runs; r++)
        free(e->run[r].time_s);
    free(e->run);
    free(e->event);
    memset(e, 0, sizeof *e);
}

/* ---- one step ---- */

/* Whether a trial may be accepted, or why not. */
static const char *judged(const explain_search *s, const explain_trial *t, double threshold, double floor_N) {
    if (!t->fit.product)
        return t->reason;
    if (!(t->gain > 0.0 && t->raw_gain > threshold))
        return "gains no more than chance does";
    if (!(t->explained > s->settings->practical_share * floor_N))
        return "explains less than the practical share of the floor";
    if (!(t->held_gain > t->held_se))
        return "does not help to predict an experiment left out by more than its standard error";
    if (!(t->held_rest > 0.0))
        return "helps in one experiment only";
    if (!(t->explained > SHADOW * s->opened))
        return "is within what an effect's equations are good for";
    return NULL;
}

/* The trial that gains most; PALP_EFFECT_COUNT if none is accepted. */
static size_t best_trial(const explain_search *s, double threshold, const bool *seen, palp_status *status) {
    size_t best = PALP_EFFECT_COUNT;
    for (size_t i = 0; i < PALP_EFFECT_COUNT && !*status; i++) {
        const explain_trial *t = &s->trial[i];
        double floor_N = 0.0;
        bool hidden = i == PALP_EFFECT_SENSOR_GAIN && !seen[i]; /* the law takes all of it */
        if (!t->tried || !t->fit.product || hidden)
            continue;
        *status = explain_floor(&s->data, &t->fit, t->force, &floor_N);
        if (!*status && !judged(s, t, threshold, floor_N) &&
            (best == PALP_EFFECT_COUNT || t->gain > s->trial[best].gain))
            best = i;
    }
    return best;
}

static palp_status take(explain_search *s, size_t i) {
    explain_fit_free(&s->fit);
    s->fit = s->trial[i].fit;
    s->trial[i].fit.product = NULL;
    return explain_settle(s);
}

/* ---- result ---- */

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
    palp_status status = explain_fit_create(model, data, less);
    free(model);
    less->scatter = fit->scatter;
    less->hum_Hz = hum ? 0.0 : fit->hum_Hz;
    less->hum_N = hum ? 0.0 : fit->hum_N;
    return status;
}

/* Added effects, the hum last. */
static size_t added_count(const explain_fit *fit, size_t n_given) {
    return fit->model.n_effects - n_given + (fit->hum_Hz > 0.0);
}

static palp_effect added_effect(const explain_fit *fit, size_t n_given, size_t i) {
    if (n_given + i < fit->model.n_effects)
        return fit->model.effects[n_given + i];
    return (palp_effect){.id = PALP_EFFECT_MAINS_HUM, .value = {0.0, fit->hum_Hz}};
}

/* Student's 97.5 % quantile, to 1 %: Cornish and Fisher, exact below. */
static double student(size_t freedom) {
    static const double few[] = {12.71, 4.303, 3.182, 2.776};
    double f = (double)freedom;
    if (freedom == 0)
        return few[0];
    return freedom <= 4 ? few[freedom - 1] : 1.96 + 2.372 / f + 2.823 / (f * f);
}

/* Squared half width of parameter at's interval: what the noise allows (factor: of the normal matrix) and what the
 * runs, each counted as one, agree on; the wider. unit: [k] work. */
static double square_reach(const explain_fit *fit, const explain_data *data, const double *factor,
                           const double *gradient, size_t at, double inflation, double *unit) {
    size_t k = fit->n_columns, counted = 0;
    double between = 0.0;
    memset(unit, 0, k * sizeof *unit);
    unit[at] = 1.0;
    explain_solve(factor, k, unit);
    for (size_t r = 0; r < data->n_runs; r++) {
        double pull = 0.0;
        if (data->run[r].held)
            continue;
        for (size_t i = 0; i < k; i++)
            pull += unit[i] * gradient[r * k + i];
        between += pull * pull;
        counted++;
    }
    double noise = pow(1.96, 2) * unit[at] * inflation;
    if (counted < 2)
        return noise;
    double n = (double)counted;
    return fmax(noise, pow(student(counted - 1), 2) * between * n / (n - 1.0));
}

static palp_status find_intervals(const explain_fit *fit, const explain_data *data, size_t n_given, double inflation,
                                  palp_explanation *e) {
    size_t k = fit->n_columns;
    double *h = malloc((2 * k + 2 + data->n_runs) * k * sizeof *h), chi2, logdet;
    if (!h)
        return PALP_ERR_NO_MEMORY;
    double *work = h + k * k, *unit = work + k * k + k, *gradient = unit + k;
    explain_fit_total(fit, data, h, unit, &chi2, work);
    for (size_t r = 0; r < data->n_runs; r++)
        explain_normal_of(fit, r, work, gradient + r * k, &chi2, &logdet);
    if (explain_cholesky(h, k)) {
        size_t at = fit->model.material.law.n + 2 * fit->model.material.n_arms;
        for (size_t i = 0; i < fit->model.n_effects; i++)
            for (size_t p = 0; p < palp_effect_look_up(fit->model.effects[i].id)->n_parameters; p++, at++) {
                double reach = sqrt(square_reach(fit, data, h, gradient, at, inflation, unit));
                if (fit->model.effects[i].id == PALP_EFFECT_ADHESION) /* read at the release, not fitted */
                    reach = 3.0 * data->run[0].white + 0.01 * fit->x[at];
                double low = fit->x[at] - reach, high = fit->x[at] + reach;
                if (i < n_given)
                    continue;
                e->effect[i - n_given].low[p] = fit->logarithmic[at] ? exp(low) : low;
                e->effect[i - n_given].high[p] = fit->logarithmic[at] ? exp(high) : high;
            }
    }
    free(h);
    return PALP_OK;
}

static palp_status copy_runs(const explain_search *s, palp_explanation *e) {
    const explain_data *data = &s->data;
    e->n_runs = data->n_runs;
    e->run = calloc(data->n_runs, sizeof *e->run);
    if (!e->run)
        return PALP_ERR_NO_MEMORY;
    for (size_t r = 0; r < data->n_runs; r++) {
        const explain_run *from = &data->run[r];
        palp_explain_run *to = &e->run[r];
        size_t bytes = from->n * sizeof *to->time_s;
        memcpy(to->name, from->name, sizeof to->name);
        to->n = from->n;
        to->time_s = malloc(5 * bytes);
        if (!to->time_s)
            return PALP_ERR_NO_MEMORY;
        to->depth_m = to->time_s + to->n;
        to->force_N = to->time_s + 2 * to->n;
        to->before_N = to->time_s + 3 * to->n;
        to->after_N = to->time_s + 4 * to->n;
        memcpy(to->time_s, from->time, bytes);
        memcpy(to->depth_m, from->depth, bytes);
        memcpy(to->force_N, from->force, bytes);
    }
    return PALP_OK;
}

static void keep_residual(const explain_search *s, palp_explanation *e, bool before) {
    const double *from = s->residual;
    for (size_t r = 0; r < e->n_runs; from += e->run[r++].n)
        memcpy(before ? e->run[r].before_N : e->run[r].after_N, from, e->run[r].n * sizeof *from);
}

/* Shares of the squared gap by run and phase, the largest first. */
static void find_where(const explain_data *data, palp_explanation *e, double floor_N) {
    double total = 0.0;
    for (size_t r = 0; r < e->n_runs; r++) {
        double sum[PALP_PHASE_COUNT] = {0};
        for (size_t i = 0; i < e->run[r].n; i++) {
            double x = e->run[r].before_N[i];
            sum[data->run[r].phase[i]] += x * x - floor_N * floor_N;
        }
        for (int p = 0; p < PALP_PHASE_COUNT; p++) {
            if (!(sum[p] > 0.0))
                continue;
            total += sum[p];
            size_t i = e->n_where < PALP_EXPLAIN_WHERE ? e->n_where++ : PALP_EXPLAIN_WHERE - 1;
            for (; i > 0 && e->where[i - 1].share < sum[p]; i--)
                e->where[i] = e->where[i - 1];
            e->where[i] = (palp_explain_where){.run = r, .phase = (palp_explain_phase)p, .share = sum[p]};
        }
    }
    for (size_t i = 0; i < e->n_where; i++)
        e->where[i].share /= total;
}

static void list_suspects(const explain_search *s, double threshold, double floor_N, const bool *seen,
                          palp_explanation *e) {
    for (size_t i = 0; i < PALP_EFFECT_COUNT; i++) {
        const explain_trial *t = &s->trial[i];
        if (!t->tried)
            continue;
        palp_explain_suspect *out = &e->suspect[e->n_suspects++];
        const char *why = judged(s, t, threshold, floor_N);
        out->id = (palp_effect_id)i;
        out->identifiable = seen[i] || i == PALP_EFFECT_MAINS_HUM;
        out->score = t->fit.product ? t->gain : 0.0;
        out->explained_N = t->explained;
        snprintf(out->reason, sizeof out->reason, "%s", why ? why : "another effect explains more");
    }
}

/* ---- the procedure ---- */

static palp_status start(explain_search *s, const palp_model *model, size_t n, const palp_explain_input *inputs,
                         palp_error *error) {
    palp_status status = explain_data_create(n, inputs, s->settings, model, &s->data, error);
    if (status)
        return status;
    s->force = malloc(s->data.n * sizeof *s->force);
    s->residual = malloc(s->data.n * sizeof *s->residual);
    if (!s->force || !s->residual)
        return PALP_ERR_NO_MEMORY;
    status = explain_fit_create(model, &s->data, &s->fit);
    for (size_t r = 0, at = 0; r < n && !status; at += s->data.run[r++].n) {
        palp_forward_run path = explain_forward_run(&s->data.run[r]);
        status = explain_predict(model, &path, s->force + at, NULL, error);
    }
    for (size_t r = 0, at = 0; r < n && !status; at += s->data.run[r++].n)
        for (size_t i = 0; i < s->data.run[r].n; i++)
            s->residual[at + i] = s->data.run[r].force[i] - s->force[at + i];
    if (!status)
        status = explain_noise_find(&s->data, s->residual);
    return status ? status : explain_settle(s);
}

static void finish(explain_search *s) {
    explain_trials_free(s);
    explain_fit_free(&s->fit);
    free(s->force);
    free(s->residual);
}

/* A second search on the same data at the fit without added effect i, its trials done. */
static palp_status search_without(const explain_search *full, size_t n_given, size_t i, explain_search *rest) {
    size_t bytes = full->data.n * sizeof *rest->force;
    memset(rest, 0, sizeof *rest);
    rest->data = full->data;
    rest->settings = full->settings;
    rest->force = malloc(bytes);
    rest->residual = malloc(bytes);
    palp_status status = rest->force && rest->residual ? without(&full->fit, &full->data, n_given, i, &rest->fit)
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

/* Share of the squared gap that opens when the effect is taken out again. */
static palp_status closed_by(const explain_search *s, const explain_search *rest, palp_explain_effect *out) {
    double floor_N, with = explain_fitted_rms(&s->data, s->residual), less = explain_fitted_rms(&s->data, rest->residual);
    palp_status status = explain_floor(&s->data, &s->fit, s->force, &floor_N);
    double open = less * less - floor_N * floor_N;
    out->gap_closed = !status && open > 0.0 ? fmin(1.0, fmax(0.0, (less * less - with * with) / open)) : 0.0;
    return status;
}

static palp_status describe(explain_search *s, size_t n_given, palp_explanation *e) {
    palp_status status = PALP_OK;
    e->n_effects = added_count(&s->fit, n_given);
    for (size_t i = 0; i < e->n_effects && !status; i++) {
        explain_search rest;
        palp_explain_effect *out = &e->effect[i];
        out->effect = added_effect(&s->fit, n_given, i);
        out->alike[0] = out->effect.id;
        out->n_class = 1;
        status = search_without(s, n_given, i, &rest);
        if (status == PALP_ERR_NOT_CONVERGED) { /* without it the model does not run: nothing to compare with */
            finish(&rest);
            status = PALP_OK;
            continue;
        }
        rest.worth = fmax(4.0, 0.6 * (s->fit.score - rest.fit.score));
        if (!status)
            status = explain_try_all(&rest);
        if (!status)
            status = explain_class_find(s, &rest, out);
        const explain_trial *own = &rest.trial[out->effect.id];
        if (!status)
            status = explain_next_find(s, &rest, out, &e->next);
        out->evidence = own->held_gain;
        out->evidence_se = own->held_se;
        if (!status)
            status = closed_by(s, &rest, out);
        finish(&rest);
    }
    return status;
}

/* ---- the verdict ---- */

/* What is left that is neither noise nor scatter, rms. */
static double structure(const explain_search *s, double floor_N) {
    double after = explain_fitted_rms(&s->data, s->residual), noise = 0.0;
    for (size_t r = 0; r < s->data.n_runs; r++)
        noise += pow(s->data.run[r].white, 2) * (double)s->data.run[r].n / (double)s->data.n;
    noise += pow(s->data.coloured, 2);
    double by_chi2 = sqrt(fmax(0.0, explain_chi2(&s->data, &s->fit) - 1.05) * noise);
    return fmax(by_chi2, sqrt(fmax(0.0, after * after - 2.0 * floor_N * floor_N)));
}

static palp_explain_verdict judge(const explain_search *s, double floor_N, const palp_explanation *e) {
    bool scattered = s->data.twin_gain > UNREPEATABLE * s->settings->repeatability;
    for (size_t i = 0; i < e->n_effects; i++)
        scattered = scattered && e->effect[i].effect.id != PALP_EFFECT_SESSION_AGEING;
    if (e->unexplained_N > REMAINS * floor_N || scattered)
        return PALP_EXPLAIN_UNEXPLAINED;
    for (size_t i = 0; i < e->n_effects; i++)
        if (e->effect[i].n_class > 1)
            return PALP_EXPLAIN_AMBIGUOUS;
    return e->n_effects ? PALP_EXPLAIN_EXPLAINED : PALP_EXPLAIN_AGREES;
}

/* Effects that leave much of the gap open mimic something else: they are not named. */
static void disown(palp_explanation *e) {
    for (size_t i = 0; i < e->n_effects; i++)
        for (size_t k = 0; k < e->n_suspects; k++)
            if (e->suspect[k].id == e->effect[i].effect.id && e->suspect[k].accepted) {
                e->suspect[k].accepted = false;
                snprintf(e->suspect[k].reason, sizeof e->suspect[k].reason,
                         "the best there is, but leaves %.2g of the gap open: it mimics something else",
                         1.0 - e->gap.closed);
            }
    e->n_effects = 0;
    e->next = (palp_explain_next){0};
    e->model = e->base;
    e->gap.after_N = e->gap.before_N;
    e->gap.heldout_after_N = e->gap.heldout_before_N;
    e->gap.closed = 0.0;
    for (size_t r = 0; r < e->n_runs; r++)
        memcpy(e->run[r].after_N, e->run[r].before_N, e->run[r].n * sizeof *e->run[r].after_N);
}

/* The hum is the model's last effect; its amplitude is the mean of the runs' own. */
static void add_hum(const explain_search *s, palp_explanation *e) {
    double square = 0.0;
    if (!(s->fit.hum_Hz > 0.0) || e->model.n_effects == PALP_EFFECTS_MAX)
        return;
    for (size_t r = 0; r < s->data.n_runs; r++) {
        double own[EXPLAIN_NUISANCES], sd[EXPLAIN_NUISANCES];
        explain_own(&s->fit, r, own, sd);
        square += (own[3] * own[3] + own[4] * own[4]) / (double)s->data.n_runs;
    }
    palp_effect hum = {.id = PALP_EFFECT_MAINS_HUM, .value = {sqrt(square), s->fit.hum_Hz}};
    palp_explain_effect *out = &e->effect[e->n_effects - 1];
    double sd = s->data.run[0].white * sqrt(2.0 / (double)s->data.n), width = 0.2 / s->data.duration;
    e->model.effects[e->model.n_effects++] = out->effect = hum;
    out->low[0] = hum.value[0] - 1.96 * sd - 0.02 * hum.value[0];
    out->high[0] = hum.value[0] + 1.96 * sd + 0.02 * hum.value[0];
    out->low[1] = hum.value[1] - width;
    out->high[1] = hum.value[1] + width;
}

static palp_status conclude(explain_search *s, size_t n_given, double floor_N, palp_explanation *e) {
    palp_explain_gap *gap = &e->gap;
    gap->floor_N = floor_N;
    gap->after_N = explain_fitted_rms(&s->data, s->residual);
    double open = gap->heldout_before_N - floor_N;
    gap->closed = e->n_effects && open > 0.0 ? (gap->heldout_before_N - gap->heldout_after_N) / open : 0.0;
    palp_status status = find_intervals(&s->fit, &s->data, n_given, fmax(1.0, explain_chi2(&s->data, &s->fit)), e);
    if (status)
        return status;
    keep_residual(s, e, false);
    e->white_N = s->data.run[0].white;
    e->coloured_N = s->data.coloured;
    e->colour_s = s->data.colour_time;
    e->repeatability = s->fit.scatter.gain;
    e->contact_scatter_m = s->fit.scatter.contact;
    e->replicates = s->data.n_twins > 0;
    e->unexplained_N = structure(s, floor_N);
    e->model = s->fit.model;
    add_hum(s, e);
    find_where(&s->data, e, floor_N);
    e->event = s->data.event;
    e->n_events = s->data.n_events;
    s->data.event = NULL;
    e->verdict = judge(s, floor_N, e);
    double gap_before = sqrt(fmax(0.0, pow(gap->before_N, 2) - floor_N * floor_N));
    if (e->verdict == PALP_EXPLAIN_UNEXPLAINED && e->n_effects && e->unexplained_N > MOST_LEFT * gap_before) {
        disown(e);
        e->unexplained_N = gap_before;
    }
    return PALP_OK;
}

static palp_status explain(explain_search *s, size_t n_given, palp_explanation *e) {
    double floor_N = 0.0;
    bool seen[PALP_EFFECT_COUNT] = {false};
    palp_status status = copy_runs(s, e);
    if (status)
        return status;
    keep_residual(s, e, true);
    e->base = s->fit.model;
    e->gap.before_N = s->opened = explain_fitted_rms(&s->data, s->residual);
    status = explain_held_out(&s->data, &s->fit, &e->gap.heldout_before_N);
    if (!status)
        status = explain_threshold(s, &e->threshold, seen);
    for (size_t step = 0; step <= s->settings->max_effects && !status; step++) {
        status = explain_try_all(s);
        size_t best = status ? PALP_EFFECT_COUNT : best_trial(s, e->threshold, seen, &status);
        if (!status && step == 0) {
            status = explain_floor(&s->data, &s->fit, s->force, &floor_N);
            list_suspects(s, e->threshold, floor_N, seen, e);
        }
        if (status || best == PALP_EFFECT_COUNT || step == s->settings->max_effects)
            break;
        for (size_t k = 0; k < e->n_suspects; k++)
            if (e->suspect[k].id == (palp_effect_id)best)
                e->suspect[k].accepted = true;
        s->worth = 4.0;
        status = take(s, best);
    }
    if (!status)
        status = describe(s, n_given, e);
    if (!status)
        status = explain_held_out(&s->data, &s->fit, &e->gap.heldout_after_N);
    if (!status)
        status = explain_floor(&s->data, &s->fit, s->force, &floor_N);
    if (status)
        return status;
    return conclude(s, n_given, floor_N, e);
}

palp_status palp_explain(const palp_model *model, size_t n, const palp_explain_input *inputs,
                         const palp_explain_settings *settings, palp_explanation *explanation, palp_error *error) {
    memset(explanation, 0, sizeof *explanation);
    if (n == 0)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "no runs to explain");
    if (model->kind != PALP_MODEL_LUMPED)
        return palp_error_set(error, PALP_ERR_UNSUPPORTED, "only lumped models are explained");
    if (model->n_effects + settings->max_effects + 2 > PALP_EFFECTS_MAX)
        return palp_error_set(error, PALP_ERR_LIMIT, "%zu effects in the model and up to %zu more: at most %d",
                              model->n_effects, settings->max_effects, PALP_EFFECTS_MAX - 2);
    explain_search *s = calloc(1, sizeof *s);
    palp_status status = s ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (s) {
        s->settings = settings;
        s->worth = 4.0;
        status = start(s, model, n, inputs, error);
        if (!status)
            status = explain(s, model->n_effects, explanation);
        finish(s);
        explain_data_free(&s->data);
        free(s);
    }
    if (status)
        palp_explanation_free(explanation);
    return status == PALP_ERR_NO_MEMORY ? palp_error_set(error, status, "out of memory") : status;
}
