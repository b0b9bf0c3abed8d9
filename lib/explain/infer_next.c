/* infer_next.c: the experiment with the largest expected information on which set of effects is the true one.
 * Parameters of each run and the uncertainty of all others are taken into account. */
#include "infer_answer.h"
#include "explain_result.h"

#include <math.h>
#include <palpate/random.h>
#include <stdlib.h>
#include <string.h>

enum { CAUSES = 4 }; /* the most probable ones of a class */

/* The measured runs, then the possible ones. */
typedef struct next_runs {
    palp_explain_limits limits;
    size_t n_before, n; /* measured, possible */
    explain_protocol protocol[EXPLAIN_PROTOCOLS];
    explain_data data;
    explain_path *path; /* [n] */
    double *force;      /* [n EXPLAIN_PATH] that they record */
    double *stood;      /* likewise, for how long the plate stands still */
    unsigned char *use;
    bool chosen[EXPLAIN_PROTOCOLS], lost[EXPLAIN_PROTOCOLS]; /* lost: some cause predicts no force */
} next_runs;

/* A set of effects that may be the true one. */
typedef struct next_cause {
    palp_effect_id id;
    const infer_fit *measured;
    double probability;
    double *force; /* [n EXPLAIN_PATH] that it predicts */
    infer_fit fit; /* with the columns of the possible runs */
    double *other; /* [CAUSES n m] products of the residuals with the columns, if that cause is true */
} next_cause;

typedef struct next_class {
    size_t n;
    next_cause cause[CAUSES];
} next_class;

static void free_runs(next_runs *next) {
    free(next->data.run);
    free(next->path);
    free(next->force);
    free(next->use);
}

static void free_class(next_class *all) {
    for (size_t i = 0; i < all->n; i++) {
        infer_fit_free(&all->cause[i].fit);
        free(all->cause[i].force);
        free(all->cause[i].other);
    }
}

/* Where several specimens were pressed, a new one of the mean size. */
static void set_run(next_runs *next, size_t k, const explain_run *like, explain_run *run) {
    explain_path *p = &next->path[k];
    double *stood = next->stood + k * EXPLAIN_PATH;
    stood[0] = -1.0;
    for (size_t i = 1; i < p->n; i++)
        stood[i] =
            p->depth[i] == p->depth[i - 1] ? fmax(0.0, stood[i - 1]) + p->time[i] - p->time[i - 1] : -1.0;
    *run = (explain_run){.n = p->n,
                         .time = p->time,
                         .depth = p->depth,
                         .force = next->force + k * EXPLAIN_PATH,
                         .use = next->use + k * EXPLAIN_PATH,
                         .stood = stood,
                         .samples = p->samples,
                         .session = like->session,
                         .white = like->white,
                         .fresh = true,
                         .specimen = next->data.n_specimens > 1 ? next->data.n_specimens : like->specimen,
                         .height = next->data.height,
                         .area = 1.0,
                         .held_out = true};
}

/* All paths together have about as many samples as the runs, so that they cost as much as an evaluation. */
static palp_status make_runs(const explain_data *data, const palp_explain_limits *limits, next_runs *next) {
    *next = (next_runs){.data = *data, .n_before = data->n_runs};
    next->data.run = NULL;
    next->limits = explain_limits_find(limits, data);
    const size_t n = next->n = explain_protocols_list(&next->limits, next->protocol);
    next->path = malloc((n + 1) * sizeof *next->path);
    next->force = calloc(2 * (n + 1) * EXPLAIN_PATH, sizeof *next->force);
    next->use = malloc((n + 1) * EXPLAIN_PATH);
    next->data.run = calloc(data->n_runs + n, sizeof *next->data.run);
    if (!next->path || !next->force || !next->use || !next->data.run)
        return PALP_ERR_NO_MEMORY;
    next->stood = next->force + n * EXPLAIN_PATH;
    memset(next->use, 1, n * EXPLAIN_PATH);
    memcpy(next->data.run, data->run, data->n_runs * sizeof *data->run);
    for (size_t k = 0; k < n; k++) {
        explain_path_find(&next->protocol[k], data, data->n / n, &next->path[k]);
        set_run(next, k, &data->run[data->n_runs - 1], &next->data.run[data->n_runs + k]);
        next->data.n += next->path[k].n;
        next->data.longest = next->path[k].n > next->data.longest ? next->path[k].n : next->data.longest;
    }
    next->data.n_runs += n;
    return PALP_OK;
}

/* The fit of the first n_runs of the data with the columns of all of them. */
static palp_status extend(const infer_fit *full, size_t n_runs, const explain_data *data, infer_fit *fit) {
    palp_status status = infer_fit_create_as(&full->c.model, data, NULL, fit);
    size_t n = 0;
    if (status)
        return status;
    for (size_t r = 0; r < n_runs; r++)
        n += data->run[r].n;
    fit->noise = full->noise;
    fit->sizes = full->sizes;
    fit->converter = full->converter;
    fit->rounding = full->rounding;
    fit->plain = full->plain;
    fit->held = full->held;
    fit->c.hum_Hz = full->c.hum_Hz;
    fit->c.hum_cost = full->c.hum_cost;
    fit->c.renewed = full->c.renewed;
    memcpy(fit->certain, full->certain, sizeof fit->certain);
    memcpy(fit->sample, full->sample, n * sizeof *fit->sample);
    memcpy(fit->specimen, full->specimen, INFER_SPECIMEN * n_runs * sizeof *fit->specimen);
    memcpy(fit->c.x, full->c.x, fit->k * sizeof *fit->c.x);
    memcpy(fit->given, full->given, fit->k * sizeof *fit->given);
    memcpy(fit->width, full->width, fit->k * sizeof *fit->width);
    memcpy(fit->scan, full->scan, fit->k * sizeof *fit->scan);
    memcpy(fit->c.contact, full->c.contact, n_runs * sizeof *fit->c.contact);
    memcpy(fit->c.gain, full->c.gain, n_runs * sizeof *fit->c.gain);
    memcpy(fit->c.zero, full->c.zero, n_runs * sizeof *fit->c.zero);
    return infer_fit_evaluate(fit, data);
}

/* Forces of the possible runs. */
static palp_status predict(next_runs *next, next_cause *cause) {
    cause->force = malloc((next->n + 1) * EXPLAIN_PATH * sizeof *cause->force);
    for (size_t k = 0; k < next->n && cause->force; k++) {
        const explain_path *p = &next->path[k];
        const palp_forward_run run = {.n = p->n, .time_s = p->time, .depth_m = p->depth};
        const palp_status status =
            explain_predict(&cause->measured->c.model, &run, cause->force + k * EXPLAIN_PATH, NULL, NULL);
        if (status == PALP_ERR_NO_MEMORY)
            return status;
        next->lost[k] = next->lost[k] || status;
    }
    return cause->force ? PALP_OK : PALP_ERR_NO_MEMORY;
}

/* How the possible runs would differ from the prediction of one cause if another one is true. The difference
 * is zero if the cause itself is true. */
static palp_status compare(next_runs *next, next_class *all, size_t i) {
    next_cause *c = &all->cause[i];
    const size_t m = c->fit.m, last = m - 1;
    c->other = calloc(all->n * next->n * m + 1, sizeof *c->other);
    palp_status status = c->other ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t j = 0; j < all->n && !status; j++) {
        if (j == i)
            continue;
        memcpy(next->force, all->cause[j].force, next->n * EXPLAIN_PATH * sizeof *next->force);
        status = infer_fit_reevaluate(&c->fit, &next->data);
        for (size_t k = 0; k < next->n && !status; k++)
            memcpy(c->other + (j * next->n + k) * m, c->fit.product + ((next->n_before + k) * m + last) * m,
                   m * sizeof *c->other);
    }
    return status;
}

/* chi2 of cause i with the measured runs, the chosen ones and run k, if these record the forces of cause j.
 * The parameters of cause i and those of each run are refitted. */
static palp_status find_chi2(next_runs *next, next_class *all, size_t i, size_t j, size_t k, double *chi2) {
    next_cause *c = &all->cause[i];
    const size_t m = c->fit.m, last = m - 1;
    const bool was = next->chosen[k];
    infer_posterior p;
    next->chosen[k] = true;
    for (size_t q = 0; q < next->n; q++) {
        double *product = c->fit.product + (next->n_before + q) * m * m;
        const double *other = c->other + (j * next->n + q) * m;
        next->data.run[next->n_before + q].held_out = !next->chosen[q];
        for (size_t a = 0; a < m && next->chosen[q]; a++)
            product[last * m + a] = product[a * m + last] = other[a];
    }
    palp_status status = infer_posterior_find(&c->fit, &next->data, &p);
    *chi2 = status ? 0.0 : p.chi2;
    infer_posterior_free(&p);
    next->chosen[k] = was;
    return status;
}

/* A lower bound of the information about the cause that follows from the expected log odds, nats. Kolchinsky
 * and Tracey (Entropy 19 (2017) 361), Eq. 10, with Bhattacharyya's distance. This is a quarter of the log
 * odds for normal distributions of equal covariance. */
static double information(const next_class *all, double nats[CAUSES][CAUSES]) {
    double sum = 0.0;
    for (size_t i = 0; i < all->n; i++) {
        double mixed = 0.0;
        for (size_t j = 0; j < all->n; j++)
            mixed += all->cause[j].probability * exp(-0.125 * (nats[i][j] + nats[j][i]));
        sum -= all->cause[i].probability * log(mixed);
    }
    return sum;
}

/* The expected log odds of cause j over cause i, if j is true, after the chosen runs and run k; *told: the
 * information that follows. */
static palp_status weigh(next_runs *next, next_class *all, size_t k, double nats[CAUSES][CAUSES],
                         double *told) {
    palp_status status = PALP_OK;
    for (size_t i = 0; i < all->n && !status; i++) {
        double own, chi2;
        status = find_chi2(next, all, i, i, k, &own);
        for (size_t j = 0; j < all->n && !status; j++) {
            nats[i][j] = chi2 = 0.0;
            if (i != j)
                status = find_chi2(next, all, i, j, k, &chi2);
            if (i != j && !status)
                nats[i][j] = fmax(0.0, 0.5 * (chi2 - own));
        }
    }
    *told = status ? 0.0 : information(all, nats);
    return status;
}

/* ---- a rehearsal ---- */

/* The measured runs, the chosen ones and run k. The latter two record the forces of a cause, with the noise
 * of the runs. */
static void rehearse_runs(const next_runs *next, size_t k, const double *force, double *recorded,
                          explain_run *run, explain_data *data) {
    uint64_t seed = 1;
    *data = next->data;
    data->run = run;
    data->n_runs = next->n_before;
    data->n = 0;
    memcpy(run, next->data.run, next->n_before * sizeof *run);
    for (size_t r = 0; r < next->n_before; r++)
        data->n += run[r].n;
    for (size_t q = 0; q < next->n; q++) {
        if (q != k && !next->chosen[q])
            continue;
        explain_run *one = &run[data->n_runs++];
        *one = next->data.run[next->n_before + q];
        one->held_out = false;
        one->force = recorded + q * EXPLAIN_PATH;
        for (size_t i = 0; i < one->n; i++)
            one->force[i] =
                force[q * EXPLAIN_PATH + i] + one->white / sqrt(one->samples[i]) * palp_random_normal(&seed);
        data->n += one->n;
    }
}

/* Log evidence of a cause for them, with its noise and sizes estimated again. */
static palp_status rehearse_fit(const next_runs *next, const next_cause *c, const explain_data *data,
                                double *score) {
    enum { ROUNDS = 6, EVALUATIONS = 10 };
    infer_fit fit = {.raw = NULL};
    palp_status status = extend(c->measured, next->n_before, data, &fit);
    if (!status)
        status = infer_sizes_learn(&fit, data, ROUNDS);
    if (!status)
        status = infer_noise_learn(&fit, data, EVALUATIONS, true);
    *score = status ? 0.0 : fit.promised;
    if (fit.raw)
        infer_fit_free(&fit);
    return status;
}

/* As weigh, but noise and sizes are estimated again, so that they may absorb the residual of a wrong
 * cause. */
static palp_status rehearse(const next_runs *next, next_class *all, size_t k, double nats[CAUSES][CAUSES],
                            double *told) {
    const size_t most = next->n_before + next->n;
    explain_run *run = malloc(most * sizeof *run);
    double *recorded = malloc((next->n + 1) * EXPLAIN_PATH * sizeof *recorded), score[CAUSES][CAUSES];
    palp_status status = run && recorded ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t j = 0; j < all->n && !status; j++) {
        explain_data data;
        rehearse_runs(next, k, all->cause[j].force, recorded, run, &data);
        for (size_t i = 0; i < all->n && !status; i++)
            status = rehearse_fit(next, &all->cause[i], &data, &score[i][j]);
    }
    for (size_t i = 0; i < all->n && !status; i++)
        for (size_t j = 0; j < all->n; j++)
            nats[i][j] = fmax(0.0, score[j][j] - score[i][j]);
    *told = status ? 0.0 : information(all, nats);
    free(run);
    free(recorded);
    return status;
}

/* ---- the choice ---- */

/* Information over the time of the experiment plus the limit. A run that takes all of the time must give
 * twice the information of one that takes none. */
static double value_of(const next_runs *next, double told, double time) {
    return told / (next->limits.time_s + time);
}

static double time_with(const next_runs *next, const palp_explain_next *out, size_t k) {
    return out->time_s + next->protocol[k].duration + next->limits.rest_s;
}

/* The most promising run of each speed, list[EXPLAIN_PROTOCOLS]. How much of a misfit the noise can absorb
 * depends on the speed. */
static palp_status list_promising(next_runs *next, next_class *all, const palp_explain_next *out,
                                  size_t *list, size_t *n) {
    double nats[CAUSES][CAUSES], told, best[EXPLAIN_PROTOCOLS];
    palp_status status = PALP_OK;
    *n = 0;
    for (size_t k = 0; k < next->n && !status; k++) {
        const double time = time_with(next, out, k);
        size_t a = 0;
        if (next->chosen[k] || next->lost[k] || time > next->limits.time_s)
            continue;
        status = weigh(next, all, k, nats, &told);
        while (a < *n && next->protocol[list[a]].rate != next->protocol[k].rate)
            a++;
        if (!status && (a == *n || value_of(next, told, time) > best[a])) {
            *n += a == *n;
            best[a] = value_of(next, told, time);
            list[a] = k;
        }
    }
    return status;
}

/* Adds runs one by one, each the best conditional on those before, as long as the information grows faster
 * than the time. */
static palp_status choose(next_runs *next, next_class *all, palp_explain_next *out) {
    double unknown = 0.0, most = 0.0;
    palp_status status = PALP_OK;
    for (size_t i = 0; i < all->n; i++)
        unknown -= all->cause[i].probability * log(all->cause[i].probability);
    while (out->n_runs < PALP_EXPLAIN_NEXT_RUNS && !status) {
        size_t list[EXPLAIN_PROTOCOLS], n, best = next->n;
        double nats[CAUSES][CAUSES], told;
        status = list_promising(next, all, out, list, &n);
        for (size_t a = 0; a < n && !status; a++) {
            const double time = time_with(next, out, list[a]);
            status = rehearse(next, all, list[a], nats, &told);
            if (status || !(value_of(next, told, time) > most))
                continue;
            most = value_of(next, told, time);
            best = list[a];
            out->information = told / unknown;
            out->nats = fmin(nats[0][1], nats[1][0]);
        }
        if (best == next->n || status)
            break;
        if (out->n_runs == 0)
            out->separation_N =
                explain_separation(&next->path[best], all->cause[0].force + best * EXPLAIN_PATH,
                                   all->cause[1].force + best * EXPLAIN_PATH);
        out->time_s = time_with(next, out, best);
        next->chosen[best] = true;
        out->run[out->n_runs++] = explain_next_run_of(&next->protocol[best]);
    }
    return status;
}

/* The effect itself and the most probable look-alikes. */
static void find_causes(const infer_search *full, const infer_search *rest, const palp_explain_effect *out,
                        next_class *all) {
    double sum = 0.0;
    for (size_t c = 0; c < out->n_class && all->n < CAUSES; c++) {
        const infer_fit *fit = c ? &rest->trial[out->alike[c]].fit : &full->fit;
        if (fit->raw)
            all->cause[all->n++] = (next_cause){.id = out->alike[c], .measured = fit};
    }
    for (size_t i = 0; i < all->n; i++)
        sum += all->cause[i].probability = exp(all->cause[i].measured->score - full->fit.score);
    for (size_t i = 0; i < all->n; i++)
        all->cause[i].probability /= sum;
}

palp_status infer_next_find(const infer_search *full, const infer_search *rest,
                            const palp_explain_effect *out, palp_explain_next *next) {
    next_class all = {.n = 0};
    find_causes(full, rest, out, &all);
    if (all.n < 2)
        return PALP_OK;
    palp_explain_next found = {.wanted = true, .between = {all.cause[0].id, all.cause[1].id}};
    next_runs *runs = malloc(sizeof *runs);
    palp_status status = runs ? make_runs(&full->data, &full->settings->next, runs) : PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < all.n && !status; i++)
        status = predict(runs, &all.cause[i]);
    for (size_t i = 0; i < all.n && !status; i++)
        status = extend(all.cause[i].measured, runs->n_before, &runs->data, &all.cause[i].fit);
    for (size_t i = 0; i < all.n && !status; i++)
        status = compare(runs, &all, i);
    if (!status)
        status = choose(runs, &all, &found);
    found.rest_s = status ? 0.0 : runs->limits.rest_s;
    if (!status && (!next->wanted || found.information > next->information))
        *next = found;
    free_class(&all);
    if (runs)
        free_runs(runs);
    free(runs);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}
