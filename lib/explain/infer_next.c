/* infer_next.c: the run of which one expects most: what its forces by one set of effects would say against
 * another set, all that a run has of its own and what the parameters leave open taken into account. */
#include "infer_answer.h"
#include "explain_result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The runs that were measured, and after them those that could be. */
typedef struct next_runs {
    explain_data data;
    explain_path *path; /* [EXPLAIN_PROTOCOLS] */
    double *force;      /* [EXPLAIN_PROTOCOLS EXPLAIN_PATH] by the other set */
    double *stood;      /* likewise, for how long the plate stands still */
    unsigned char *use;
    bool *done; /* the other set gives a force */
} next_runs;

static void free_runs(next_runs *next) {
    free(next->data.run);
    free(next->path);
    free(next->force);
    free(next->use);
    free(next->done);
}

/* Where several specimens were pressed, another one of the mean size. */
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
                         .session = like->session,
                         .white = like->white,
                         .fresh = true,
                         .specimen = next->data.n_specimens > 1 ? next->data.n_specimens : like->specimen,
                         .height = next->data.height,
                         .area = 1.0,
                         .held_out = true};
}

static palp_status make_runs(const explain_data *data, next_runs *next) {
    const size_t n = data->n_runs, all = n + EXPLAIN_PROTOCOLS;
    *next = (next_runs){.data = *data,
                        .path = malloc(EXPLAIN_PROTOCOLS * sizeof *next->path),
                        .force = calloc(2 * (size_t)EXPLAIN_PROTOCOLS * EXPLAIN_PATH, sizeof *next->force),
                        .use = malloc((size_t)EXPLAIN_PROTOCOLS * EXPLAIN_PATH),
                        .done = calloc(EXPLAIN_PROTOCOLS, sizeof *next->done)};
    next->data.run = calloc(all, sizeof *next->data.run);
    if (!next->data.run || !next->path || !next->force || !next->use || !next->done)
        return PALP_ERR_NO_MEMORY;
    next->stood = next->force + (size_t)EXPLAIN_PROTOCOLS * EXPLAIN_PATH;
    memset(next->use, 1, (size_t)EXPLAIN_PROTOCOLS * EXPLAIN_PATH);
    memcpy(next->data.run, data->run, n * sizeof *data->run);
    for (size_t k = 0; k < EXPLAIN_PROTOCOLS; k++) {
        explain_path_find(k, data, &next->path[k]);
        set_run(next, k, &data->run[n - 1], &next->data.run[n + k]);
        next->data.n += next->path[k].n;
        next->data.longest = next->path[k].n > next->data.longest ? next->path[k].n : next->data.longest;
    }
    next->data.n_runs = all;
    return PALP_OK;
}

/* full's fit with the columns of the new runs too. */
static palp_status extend(const infer_fit *full, size_t n_runs, const explain_data *data, infer_fit *fit) {
    palp_status status = infer_fit_create(&full->c.model, data, NULL, fit);
    if (status)
        return status;
    fit->noise = full->noise;
    fit->sizes = full->sizes;
    fit->c.hum_Hz = full->c.hum_Hz;
    fit->c.renewed = full->c.renewed;
    memcpy(fit->c.x, full->c.x, fit->k * sizeof *fit->c.x);
    memcpy(fit->given, full->given, fit->k * sizeof *fit->given);
    memcpy(fit->width, full->width, fit->k * sizeof *fit->width);
    memcpy(fit->scan, full->scan, fit->k * sizeof *fit->scan);
    memcpy(fit->c.contact, full->c.contact, n_runs * sizeof *fit->c.contact);
    memcpy(fit->c.gain, full->c.gain, n_runs * sizeof *fit->c.gain);
    status = infer_fit_evaluate(fit, data);
    if (status)
        infer_fit_free(fit);
    return status;
}

/* Forces of the new runs by the other set. */
static void predict_other(const infer_fit *other, next_runs *next) {
    for (size_t k = 0; k < EXPLAIN_PROTOCOLS; k++) {
        const explain_path *p = &next->path[k];
        const palp_forward_run run = {.n = p->n, .time_s = p->time, .depth_m = p->depth};
        next->done[k] =
            explain_predict(&other->c.model, &run, next->force + k * EXPLAIN_PATH, NULL, NULL) == PALP_OK;
    }
}

/* chi2 of all runs that were measured and of run r, if that records what this fit predicts (own) or what the
 * other set does. */
static palp_status find_chi2(const infer_fit *fit, next_runs *next, size_t r, bool own, double *chi2) {
    const size_t m = fit->m;
    double *product = fit->product + r * m * m, *was = malloc(m * m * sizeof *was);
    infer_posterior p;
    if (!was)
        return PALP_ERR_NO_MEMORY;
    memcpy(was, product, m * m * sizeof *was);
    for (size_t a = 0; a < m && own; a++)
        product[a * m + m - 1] = product[(m - 1) * m + a] = 0.0;
    next->data.run[r].held_out = false;
    palp_status status = infer_posterior_find(fit, &next->data, &p);
    next->data.run[r].held_out = true;
    memcpy(product, was, m * m * sizeof *was);
    free(was);
    *chi2 = status ? 0.0 : p.chi2;
    infer_posterior_free(&p);
    return status;
}

/* Takes the run of which most is expected, if it is more than what *out has. */
static palp_status compare(const infer_fit *fit, size_t n_runs, next_runs *next, palp_explain_next *out) {
    double by_own, by_other, own[EXPLAIN_PATH];
    palp_status status = PALP_OK;
    for (size_t k = 0; k < EXPLAIN_PROTOCOLS && !status; k++) {
        const explain_path *p = &next->path[k];
        const palp_forward_run run = {.n = p->n, .time_s = p->time, .depth_m = p->depth};
        if (!next->done[k] || explain_predict(&fit->c.model, &run, own, NULL, NULL))
            continue;
        status = find_chi2(fit, next, n_runs + k, true, &by_own);
        if (!status)
            status = find_chi2(fit, next, n_runs + k, false, &by_other);
        const double nats = 0.5 * (by_other - by_own);
        if (status || !(nats > out->nats))
            continue;
        *out = explain_next_of(k, &next->data);
        out->nats = nats;
        out->separation_N = explain_separation(p, own, next->force + k * EXPLAIN_PATH);
    }
    return status;
}

palp_status infer_next_find(const infer_search *full, const infer_search *rest,
                            const palp_explain_effect *out, palp_explain_next *next) {
    const size_t n_runs = full->data.n_runs;
    next_runs runs;
    palp_status status = out->n_class > 1 ? make_runs(&full->data, &runs) : PALP_OK;
    for (size_t c = 1; c < out->n_class && !status; c++) {
        const infer_trial *t = &rest->trial[out->alike[c]];
        palp_explain_next found = *next;
        infer_fit fit;
        if (!t->fit.raw)
            continue;
        predict_other(&t->fit, &runs);
        status = extend(&full->fit, n_runs, &runs.data, &fit);
        if (status)
            break;
        status = compare(&fit, n_runs, &runs, &found);
        infer_fit_free(&fit);
        if (found.nats > next->nats || !next->wanted) {
            *next = found;
            next->wanted = true;
            next->between[0] = out->effect.id;
            next->between[1] = out->alike[c];
        }
    }
    if (out->n_class > 1)
        free_runs(&runs);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}
