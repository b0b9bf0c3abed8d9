/* infer_free.c: free terms: the part of the discrepancy that all runs share, as a function of one variable of
 * the path. The kinds of functions are compared by the evidence of a fit without other discrepancies. */
#include "explain_result.h"
#include "infer_answer.h"
#include "base/dense.h"
#include "response/free_term.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A kind is tried once, a response with several times until it has ended. */
enum { FINALISTS = 3, LENGTHS = 6, TRIALS = PALP_FREE_KINDS - 1 + LENGTHS };

/* Columns of all terms; the other columns stay. */
static palp_status take_hats(infer_fit *fit, const explain_data *data) {
    palp_status status = PALP_OK;
    for (size_t r = 0, at = 0; r < data->n_runs && !status; at += data->run[r++].n) {
        double *raw = fit->raw + at * fit->m;
        status = infer_free_hats(fit, data, r, raw + (fit->m - 1) * data->run[r].n,
                                 raw + (fit->k + INFER_OWN) * data->run[r].n);
    }
    return status;
}

/* ---- the search ---- */

/* Products and score, then sizes and noise. */
static palp_status learn(infer_fit *fit, const explain_data *data, size_t rounds, size_t evaluations) {
    palp_status status = infer_fit_products(fit, data);
    if (!status)
        status = infer_fit_score(fit, data);
    if (!status)
        status = infer_sizes_learn(fit, data, rounds);
    return status ? status : infer_noise_learn(fit, data, evaluations, false);
}

/* One term more beside a fit; fit.raw NULL: there is none. */
typedef struct trial {
    infer_fit fit;
    double evidence; /* over the fit without it, nats */
    palp_status status;
} trial;

typedef struct terms {
    const infer_search *s;
    infer_fit fit;
    trial trial[TRIALS];
    palp_status status[TRIALS];
} terms;

/* One term more, of the first sizes. */
static void put_term(infer_fit *fit, const explain_data *data, const palp_free_term *term) {
    const infer_sizes first = infer_sizes_first(data);
    const size_t d = fit->n_terms++;
    fit->term[d] = *term;
    memcpy(fit->sizes.common[d], first.common[0], sizeof first.common[0]);
    memcpy(fit->sizes.each[d], first.each[0], sizeof first.each[0]);
}

static bool has_term(const infer_fit *fit, palp_free_kind kind) {
    for (size_t d = 0; d < fit->n_terms; d++)
        if (fit->term[d].kind == kind)
            return true;
    return false;
}

static void try_kind(void *user, size_t i) {
    enum { ROUNDS = 6, EVALUATIONS = 4 };
    terms *t = user;
    const explain_data *data = &t->s->data;
    trial *one = &t->trial[i];
    const palp_free_kind kind = (palp_free_kind)(i < PALP_FREE_RESPONSE ? i : PALP_FREE_RESPONSE);
    palp_free_term term;
    one->fit.raw = NULL;
    one->evidence = -HUGE_VAL;
    t->status[i] = PALP_OK;
    if (has_term(&t->fit, kind) || infer_free_term(data, kind, (int)i - (int)kind, &term))
        return;
    t->status[i] = infer_fit_copy(&t->fit, data, &one->fit);
    if (t->status[i])
        return;
    put_term(&one->fit, data, &term);
    t->status[i] = take_hats(&one->fit, data);
    if (!t->status[i])
        t->status[i] = learn(&one->fit, data, ROUNDS, EVALUATIONS);
    if (t->status[i] == PALP_ERR_NO_MEMORY)
        return;
    if (t->status[i])
        one->fit.promised = -HUGE_VAL;
    t->status[i] = PALP_OK;
}

/* What the sizes of term d cost, and its kind, nats. */
static palp_status find_cost(const infer_fit *fit, const infer_search *s, size_t d, bool own, double *nats) {
    infer_fit work;
    palp_status status = infer_fit_copy(fit, &s->data, &work);
    if (status)
        return status;
    *nats = log(TRIALS);
    for (size_t l = 0; l < INFER_LENGTHS && !status; l++) {
        status = infer_size_cost(&work, &s->data, &work.sizes.common[d][l], nats);
        if (!status && own)
            status = infer_size_cost(&work, &s->data, &work.sizes.each[d][l], nats);
    }
    infer_fit_free(&work);
    return status;
}

/* Log odds of the fit over one whose runs do not share term d. The prior cost of the term's sizes and of its
 * kind is taken off. */
static palp_status weigh(const infer_fit *fit, const infer_search *s, size_t d, double *nats) {
    enum { ROUNDS = 12, EVALUATIONS = 15 };
    infer_fit without;
    double cost;
    palp_status status = find_cost(fit, s, d, false, &cost);
    if (!status)
        status = infer_fit_copy(fit, &s->data, &without);
    if (status)
        return status;
    memset(without.sizes.common[d], 0, sizeof without.sizes.common[d]);
    status = learn(&without, &s->data, ROUNDS, EVALUATIONS);
    *nats = fit->promised - without.promised - cost;
    infer_fit_free(&without);
    return status;
}

static void weigh_kind(void *user, size_t i) {
    enum { ROUNDS = 12, EVALUATIONS = 15 };
    terms *t = user;
    trial *one = &t->trial[i];
    size_t better = 0;
    for (size_t k = 0; k < TRIALS; k++)
        better += t->trial[k].fit.raw && t->trial[k].fit.promised > one->fit.promised;
    if (!one->fit.raw || better >= FINALISTS || !isfinite(one->fit.promised))
        return;
    infer_fit last;
    double cost;
    t->status[i] = infer_fit_copy(&one->fit, &t->s->data, &last); /* the others look at the trial's score */
    if (t->status[i])
        return;
    const size_t d = last.n_terms - 1;
    t->status[i] = learn(&last, &t->s->data, ROUNDS, EVALUATIONS);
    if (!t->status[i] && infer_any(last.sizes.common[d])) {
        t->status[i] = find_cost(&last, t->s, d, true, &cost);
        one->evidence = last.promised - t->fit.promised - cost;
    }
    infer_fit_free(&last);
    if (t->status[i] && t->status[i] != PALP_ERR_NO_MEMORY) {
        one->evidence = -HUGE_VAL;
        t->status[i] = PALP_OK;
    }
}

static void free_trials(terms *t) {
    for (size_t i = 0; i < TRIALS; i++)
        if (t->trial[i].fit.raw)
            infer_fit_free(&t->trial[i].fit);
}

/* Of the responses the most probable one stays. */
static void keep_one_response(terms *t) {
    trial *best = &t->trial[PALP_FREE_RESPONSE];
    for (trial *one = best + 1; one < t->trial + TRIALS; one++) {
        if (one->fit.raw && (!best->fit.raw || one->fit.promised > best->fit.promised))
            infer_fit_exchange(&one->fit, &best->fit);
        if (one->fit.raw)
            infer_fit_free(&one->fit);
    }
}

/* A fit with these terms from the model as given: law and arms of the fit at hand may have absorbed what they
 * are to follow. *fit becomes the more probable one. */
static palp_status begin_anew(const infer_search *s, infer_fit *fit) {
    enum { ROUNDS = 6, SIZES = 12, NOISE = 15, SETTLED = 4 };
    const explain_data *data = &s->data;
    palp_model model = fit->c.model;
    infer_fit anew;
    model.material = data->given->material;
    palp_status status = infer_fit_create(&model, data, NULL, &anew);
    if (status)
        return status;
    anew.c.renewed = fit->c.renewed;
    anew.free = true;
    memset(anew.sizes.common, 0, sizeof anew.sizes.common);
    memset(anew.sizes.each, 0, sizeof anew.sizes.each);
    for (size_t d = 0; d < fit->n_terms; d++)
        put_term(&anew, data, &fit->term[d]);
    status = infer_fit_anneal(&anew, data, ROUNDS);
    if (!status)
        status = learn(&anew, data, SIZES, NOISE);
    if (!status)
        status = infer_fit_settle(&anew, data, SETTLED, true);
    if (!status)
        status = infer_fit_converge(&anew, data);
    if (!status && anew.score > fit->score)
        infer_fit_exchange(fit, &anew);
    infer_fit_free(&anew);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

/* Adds the most probable further term to the fit at hand. found: its evidence exceeds the threshold. */
static palp_status add_term(terms *t, bool *found) {
    enum { EVALUATIONS = 5 };
    const infer_search *s = t->s;
    size_t best = 0;
    palp_status status = explain_each(s->settings, TRIALS, try_kind, t, t->status);
    keep_one_response(t);
    if (!status)
        status = explain_each(s->settings, TRIALS, weigh_kind, t, t->status);
    for (size_t i = 0; i < TRIALS; i++)
        best = t->trial[i].evidence > t->trial[best].evidence ? i : best;
    *found = !status && t->trial[best].evidence > infer_threshold(s->settings);
    if (*found) {
        infer_fit_exchange(&t->fit, &t->trial[best].fit);
        status = infer_fit_improve(&t->fit, &s->data, EVALUATIONS);
    }
    free_trials(t);
    return *found && !status ? begin_anew(s, &t->fit) : status;
}

/* Without term d. */
static palp_status drop_term(infer_fit *fit, const explain_data *data, size_t d) {
    fit->n_terms--;
    for (size_t a = d; a < fit->n_terms; a++) {
        fit->term[a] = fit->term[a + 1];
        memcpy(fit->sizes.common[a], fit->sizes.common[a + 1], sizeof fit->sizes.common[a]);
        memcpy(fit->sizes.each[a], fit->sizes.each[a + 1], sizeof fit->sizes.each[a]);
    }
    memset(fit->sizes.common[fit->n_terms], 0, sizeof fit->sizes.common[0]);
    memset(fit->sizes.each[fit->n_terms], 0, sizeof fit->sizes.each[0]);
    palp_status status = take_hats(fit, data);
    return status ? status : infer_fit_converge(fit, data);
}

/* Removes terms that are not certain conditional on the others, from the last to the first. evidence: of
 * those that stay. */
static palp_status drop_uncertain(infer_fit *fit, const infer_search *s, double *evidence) {
    palp_status status = PALP_OK;
    for (size_t d = fit->n_terms; d-- > 0 && !status;) {
        evidence[d] = -HUGE_VAL;
        if (infer_any(fit->sizes.common[d]))
            status = weigh(fit, s, d, &evidence[d]);
        if (status || evidence[d] > infer_threshold(s->settings))
            continue;
        status = drop_term(fit, &s->data, d);
        memmove(evidence + d, evidence + d + 1, (fit->n_terms - d) * sizeof *evidence);
    }
    return status;
}

/* ---- runs left out ---- */

/* Sum of squared residuals of run r with the shared terms of the other runs. Its own parameters have their
 * means given those of the others. */
static palp_status add_left(const infer_fit *fit, explain_data *data, size_t r, size_t at, double *squares) {
    explain_run *run = &data->run[r];
    const bool was = run->held_out;
    const size_t n = run->n;
    double own[INFER_BLOCK], undone[EXPLAIN_COLUMNS];
    infer_posterior p;
    run->held_out = true;
    palp_status status = infer_posterior_find(fit, data, &p);
    run->held_out = was;
    if (status)
        return status;
    status = infer_own(fit, data, &p, r, own, NULL);
    const double *raw = fit->raw + at * fit->m, *own_column = raw + fit->k * n;
    for (size_t a = 0; a < fit->k; a++)
        undone[a] = infer_undone(&p, 0, INFER_HATS, a);
    for (size_t i = 0; i < n && !status; i++) {
        double left = raw[(fit->m - 1) * n + i];
        for (size_t a = 0; a < fit->k; a++)
            left -= (p.mean[p.hats + a] - undone[a]) * raw[a * n + i];
        for (size_t a = 0; a < INFER_OWN; a++)
            left -= own[a] * own_column[a * n + i];
        for (size_t a = 0; a < INFER_HATS; a++)
            left -= infer_common(&p, a) * own_column[(INFER_OWN + a) * n + i];
        *squares += run->use[i] ? left * left : 0.0;
    }
    infer_posterior_free(&p);
    return status;
}

/* rms of the runs left out, as the others predict them: without any run's own part of a term. */
static palp_status find_left(const infer_fit *fit, explain_data *data, double *rms) {
    const bool each = explain_fitted_runs(data) == data->n_runs;
    double squares = 0.0, count = 0.0;
    infer_fit shared;
    palp_status status = infer_fit_copy(fit, data, &shared);
    if (status)
        return status;
    memset(shared.sizes.each, 0, sizeof shared.sizes.each);
    status = infer_fit_products(&shared, data);
    for (size_t r = 0, at = 0; r < data->n_runs && !status; at += data->run[r++].n) {
        if (!each && !data->run[r].held_out)
            continue;
        status = add_left(&shared, data, r, at, &squares);
        count += (double)data->run[r].n;
    }
    infer_fit_free(&shared);
    *rms = count > 0.0 ? sqrt(squares / count) : 0.0;
    return status;
}

/* Whether the terms improve the prediction of runs left out, and which share of the gap they close. */
static palp_status confirm(const infer_fit *fit, const infer_fit *without, const infer_search *s,
                           palp_explain_free *out, bool *better) {
    explain_data data = s->data; /* its runs are marked as held out in turn */
    infer_left_out with = {.n = 0}, plain = {.n = 0};
    double se;
    palp_status status = infer_leave_out(fit, &data, &with);
    if (!status)
        status = infer_leave_out(without, &data, &plain);
    *better = !status && infer_predicts_better(&with, &plain, &se) > 0.0;
    out->heldout_before_N = plain.rms_N;
    out->heldout_after_N = 0.0;
    if (!status && plain.rms_N > 0.0)
        status = find_left(fit, &data, &out->heldout_after_N);
    double slow = 0.0;
    for (int a = 0; a < INFER_SLOW; a++)
        slow += fit->noise.slow[a] * fit->noise.slow[a];
    out->noise_level_N = hypot(infer_white_level(fit, &data), sqrt(slow));
    const double open = out->heldout_before_N - out->noise_level_N;
    out->closed = open > 0.0 ? (out->heldout_before_N - out->heldout_after_N) / open : 0.0;
    out->closed = fmin(1.0, fmax(0.0, out->closed));
    *better = *better && (!(plain.rms_N > 0.0) || out->heldout_after_N < out->heldout_before_N);
    infer_left_out_free(&with);
    infer_left_out_free(&plain);
    return status;
}

/* ---- as a model ---- */

/* The class of a term. One that is alike on both ways is elastic. */
static palp_free_class class_of(const infer_fit *fit, size_t d) {
    static const palp_free_class classes[PALP_FREE_KINDS] = {
        PALP_FREE_DISSIPATIVE, PALP_FREE_DISSIPATIVE, PALP_FREE_DISSIPATIVE, PALP_FREE_CLOCK,
        PALP_FREE_CLOCK,       PALP_FREE_AGE,         PALP_FREE_DISSIPATIVE, PALP_FREE_DISSIPATIVE,
        PALP_FREE_DISSIPATIVE, PALP_FREE_OF_SESSION,  PALP_FREE_OF_PLACE,    PALP_FREE_OF_PLACE,
        PALP_FREE_DISSIPATIVE};
    const palp_free_kind kind = fit->term[d].kind;
    double even = 0.0, odd = 0.0;
    for (size_t b = 0; b < fit->n_terms; b++)
        for (size_t a = 0; a < INFER_NODES && kind <= PALP_FREE_UNLOADING; a++) {
            if (b == d || fit->term[b].kind > PALP_FREE_UNLOADING)
                continue;
            even += pow(fit->term[d].force_N[a] + fit->term[b].force_N[a], 2.0);
            odd += pow(fit->term[d].force_N[a] - fit->term[b].force_N[a], 2.0);
        }
    return even > odd ? PALP_FREE_ELASTIC : classes[kind];
}

/* The information of the runs on the table of term d: the posterior precision less the prior's. */
static palp_status take_information(const infer_fit *fit, const infer_posterior *p, size_t d,
                                    palp_explain_free *out) {
    enum { N = INFER_NODES };
    double covariance[N * N], prior[N * N] = {0.0}, *unit = calloc(p->g * N, sizeof *unit);
    if (!unit)
        return PALP_ERR_NO_MEMORY;
    for (size_t a = 0; a < N; a++)
        unit[a * p->g + p->domain[d] + a] = 1.0;
    dense_forward(p->g, p->factor, N, unit);
    dense_transposed_product(N, N, p->g, unit, unit, covariance);
    free(unit);
    if (!dense_cholesky(N, covariance))
        return PALP_ERR_SINGULAR;
    double *information = out->information[d];
    for (size_t a = 0; a < N; a++)
        information[a * (N + 1)] = 1.0;
    dense_cholesky_solve(N, covariance, N, information);
    dense_times(N, N, 1.0, information, p->mean + p->domain[d], 0.0, out->pull[d]);
    infer_hats_precision(fit->sizes.common[d], N, prior);
    for (size_t i = 0; i < N * N; i++)
        information[i] -= prior[i];
    return PALP_OK;
}

/* Tables and bands of the posterior into fit->term. The law takes the part of a common term that it can
 * follow. */
static palp_status take_tables(infer_fit *fit, const explain_data *data, palp_explain_free *out) {
    enum { N = INFER_NODES };
    infer_posterior p;
    palp_status status = infer_posterior_find(fit, data, &p);
    double *unit = status ? NULL : calloc(p.g, sizeof *unit);
    if (!unit)
        return status ? status : PALP_ERR_NO_MEMORY;
    for (size_t d = 0; d < fit->n_terms; d++)
        for (size_t a = 0; a < N && p.domain[d] != SIZE_MAX; a++) {
            const bool none = a == free_term_zero(fit->term[d].kind);
            memset(unit, 0, p.g * sizeof *unit);
            unit[p.domain[d] + a] = 1.0;
            dense_forward(p.g, p.factor, 1, unit);
            fit->term[d].force_N[a] = none ? 0.0 : p.mean[p.domain[d] + a];
            fit->term[d].sd_N[a] = none ? 0.0 : infer_tail_widening(fit) * sqrt(dense_dot(p.g, unit, unit));
        }
    for (size_t d = 0; d < fit->n_terms && !status; d++)
        status = p.domain[d] != SIZE_MAX ? take_information(fit, &p, d, out) : PALP_OK;
    for (size_t d = 0; d < fit->n_terms; d++)
        fit->term[d].does = class_of(fit, d);
    for (size_t a = 0; a < fit->k; a++)
        fit->c.x[a] = fmin(fit->c.high[a], fmax(fit->c.low[a], fit->c.x[a] + p.mean[p.hats + a] -
                                                                   infer_undone(&p, 0, INFER_HATS, a)));
    free(unit);
    infer_posterior_free(&p);
    return status ? status : explain_fit_to_model(&fit->c);
}

/* rms of each term over the samples. */
static palp_status find_rms(const infer_fit *fit, const explain_data *data, double *rms) {
    double *force = calloc(data->longest, sizeof *force);
    palp_status status = force ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t d = 0; d < fit->n_terms && !status; d++) {
        double squares = 0.0;
        for (size_t r = 0; r < data->n_runs && !status; r++) {
            const explain_run *run = &data->run[r];
            memcpy(force, run->force, run->n * sizeof *force); /* near that of the model */
            status = palp_free_term_add(&fit->term[d], run->n, run->time, run->depth, run->height,
                                        run->session, force);
            for (size_t i = 0; i < run->n; i++)
                squares += pow(force[i] - run->force[i], 2.0);
        }
        rms[d] = sqrt(squares / (double)data->n);
    }
    free(force);
    return status;
}

/* The model with the terms fixed; its other parameters and those of each run are refitted. */
static palp_status write_model(infer_fit *fit, const infer_search *s, palp_explanation *e) {
    enum { ROUNDS = 3 };
    const explain_data *data = &s->data;
    palp_status status = take_tables(fit, data, &e->free);
    if (status)
        return status;
    memcpy(fit->c.model.free_term + fit->c.model.n_free, fit->term, fit->n_terms * sizeof *fit->term);
    fit->c.model.n_free += fit->n_terms;
    memset(fit->sizes.common, 0, sizeof fit->sizes.common);
    fit->plain = true; /* none of them is estimated again */
    double *residual = malloc(2 * data->n * sizeof *residual);
    status = residual ? infer_fit_evaluate(fit, data) : PALP_ERR_NO_MEMORY;
    if (!status)
        status = infer_fit_score(fit, data);
    if (!status)
        status = infer_fit_settle(fit, data, ROUNDS, false);
    if (!status)
        status = infer_residual(fit, data, residual, residual + data->n);
    if (!status)
        status = find_rms(fit, data, e->free.rms_N);
    if (!status) {
        const palp_model was = e->model;
        e->free.n = fit->n_terms;
        double squares = 0.0;
        for (size_t r = 0; r < data->n_runs; r++)
            squares += dense_dot(data->run[r].n, data->run[r].force, data->run[r].force);
        e->free.scale_N = sqrt(squares / (double)data->n);
        e->free.after_N = explain_fitted_rms(data, residual);
        e->model = fit->c.model;
        e->model.material.law.strain_max = was.material.law.strain_max;
        e->model.between = was.between;
        e->model.n_specimens = was.n_specimens;
    }
    free(residual);
    return status;
}

/* The effect that would come nearest, of those that were not accepted. */
static palp_effect_id find_nearest(const palp_explanation *e) {
    palp_effect_id best = PALP_EFFECT_COUNT;
    double score = 0.0;
    for (size_t k = 0; k < e->n_candidates; k++)
        if (!e->candidate[k].accepted && e->candidate[k].score > score) {
            score = e->candidate[k].score;
            best = e->candidate[k].id;
        }
    return best;
}

/* From the fit at hand without its discrepancy. */
static palp_status begin(const infer_search *s, infer_fit *fit) {
    enum { ROUNDS = 6, EVALUATIONS = 25 };
    palp_status status = infer_without_discrepancy(s, fit);
    if (status)
        return status;
    fit->free = true;
    fit->plain = false;
    status = learn(fit, &s->data, ROUNDS, EVALUATIONS);
    if (status)
        infer_fit_free(fit);
    return status;
}

/* The terms that are certain beside the effects of a search, into *fit, which is the caller's to free; its
 * raw is NULL where there is none. out: their evidence, and what they do to runs left out. */
static palp_status find_terms(const infer_search *s, infer_fit *fit, palp_explain_free *out) {
    infer_fit without = {.raw = NULL};
    bool found = true, better = false;
    memset(fit, 0, sizeof *fit);
    terms *t = calloc(1, sizeof *t);
    if (!t)
        return PALP_ERR_NO_MEMORY;
    t->s = s;
    palp_status status = begin(s, &t->fit);
    if (!status)
        status = infer_fit_copy(&t->fit, &s->data, &without);
    while (!status && found && t->fit.n_terms + s->data.given->n_free < PALP_FREE_TERMS)
        status = add_term(t, &found);
    if (!status && t->fit.n_terms > 0)
        status = infer_fit_converge(&t->fit, &s->data);
    if (!status)
        status = drop_uncertain(&t->fit, s, out->evidence);
    if (!status && t->fit.n_terms > 0)
        status = confirm(&t->fit, &without, s, out, &better);
    if (!status && better)
        infer_fit_exchange(fit, &t->fit);
    if (t->fit.raw)
        infer_fit_free(&t->fit);
    if (without.raw)
        infer_fit_free(&without);
    free(t);
    return status;
}

/* ---- effects beside the terms ---- */

/* Log evidence of a fit with terms, less the prior costs of their kinds and sizes, nats. */
static palp_status find_value(const infer_fit *fit, const infer_search *s, double *nats) {
    palp_status status = PALP_OK;
    *nats = fit->score;
    for (size_t d = 0; d < fit->n_terms && !status; d++) {
        double cost;
        status = find_cost(fit, s, d, true, &cost);
        *nats -= status ? 0.0 : cost;
    }
    return status;
}

/* Goes on without an effect if the terms that are certain without it are as good: with it and its own terms
 * the evidence is not larger by the threshold. */
static palp_status drop_needless(infer_search *s, const infer_fit *with, palp_explanation *e, bool *dropped) {
    double own, other;
    palp_status status = find_value(with, s, &own);
    *dropped = false;
    for (size_t i = infer_added(s); i-- > 0 && !status && !*dropped;) {
        palp_explain_candidate *needless = explain_candidate_of(e, infer_added_id(s, i));
        infer_search rest;
        infer_fit fit = {.raw = NULL};
        palp_explain_free out;
        status = infer_search_without(s, i, &rest);
        if (!status)
            status = find_terms(&rest, &fit, &out);
        if (!status && fit.raw)
            status = find_value(&fit, &rest, &other);
        *dropped = !status && fit.raw && own - infer_price(s) - other < infer_threshold(s->settings);
        if (status != PALP_ERR_NO_MEMORY)
            status = PALP_OK; /* an effect that cannot be left out stays */
        if (*dropped)
            infer_search_go_on(s, &rest);
        if (*dropped && needless)
            snprintf(needless->reason, sizeof needless->reason, "is not needed beside a free term");
        if (fit.raw)
            infer_fit_free(&fit);
        infer_search_free(&rest);
    }
    return status;
}

/* The same effects as those of the fit at hand: no look-alike has taken the place of one. */
static bool has_effects_of(const infer_fit *fit, const infer_search *s) {
    const palp_model *one = &fit->c.model, *other = &s->fit.c.model;
    bool same = one->n_effects == other->n_effects && fit->c.hum_Hz == s->fit.c.hum_Hz;
    for (size_t i = 0; same && i < one->n_effects; i++)
        same = one->effects[i].id == other->effects[i].id;
    return same;
}

palp_status infer_free_find(infer_search *s, palp_explanation *e, infer_fit *found) {
    palp_status status = infer_residual(&s->fit, &s->data, s->residual, s->discrepancy);
    memset(found, 0, sizeof *found);
    if (status || explain_fitted_rms(&s->data, s->residual) <= s->settings->good_enough * s->data.peak)
        return status; /* below the practical limit */
    for (bool dropped = true; dropped && !status;) {
        infer_left_out left = {.n = 0};
        dropped = false;
        status = find_terms(s, found, &e->free);
        if (!status && found->raw)
            status = drop_needless(s, found, e, &dropped);
        if (status || !dropped)
            break;
        infer_fit_free(found);
        status = infer_fit_converge(&s->fit, &s->data);
        if (!status)
            status = infer_leave_out(&s->fit, &s->data, &left);
        if (!status)
            e->gap.heldout_after_N = left.rms_N;
        infer_left_out_free(&left);
    }
    if (status && found->raw) /* a fit that fails or is stopped gives no term; all other results stay */
        infer_fit_free(found);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

palp_status infer_free_take(const infer_search *s, palp_explanation *e, infer_fit *found) {
    static const palp_explain_free none = {.resembles = PALP_EFFECT_COUNT};
    palp_status status = PALP_OK;
    if (found->raw && !has_effects_of(found, s)) {
        infer_fit_free(found);
        status = find_terms(s, found, &e->free);
    }
    const bool some = !status && found->raw;
    if (some) {
        e->free.resembles = find_nearest(e);
        status = write_model(found, s, e);
    }
    if (some && !status)
        e->verdict = PALP_EXPLAIN_UNEXPLAINED;
    else
        e->free = none;
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}
