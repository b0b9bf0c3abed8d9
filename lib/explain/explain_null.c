/* explain_null.c: how much chance alone gains: simulated null cases, linear beside the fit at hand. */
#include "explain_search.h"
#include "explain_noise.h"
#include "base/dense.h"
#include "base/statistics.h"

#include <math.h>
#include <palpate/random.h>
#include <stdlib.h>
#include <string.h>

enum { NULLS = 4000 };

/* Effects at which the search starts, and those half way from each to the next, since the search goes on
 * between them; as directions beside s->fit: the derivative by the strength. */
typedef struct directions {
    size_t n;
    palp_effect effect[PALP_EFFECT_COUNT * 2 * EFFECT_STARTS];
} directions;

static palp_effect half_way(const palp_effect_info *info, const palp_effect *a, const palp_effect *b) {
    palp_effect effect = *a;
    for (size_t p = 0; p < info->n_parameters; p++) {
        double product = a->value[p] * b->value[p];
        effect.value[p] =
            product > 0.0 ? copysign(sqrt(product), a->value[p]) : 0.5 * (a->value[p] + b->value[p]);
    }
    return effect;
}

static palp_status find_directions(const explain_search *s, directions *d) {
    palp_status status = PALP_OK;
    d->n = 0;
    for (int id = 0; id < PALP_EFFECT_COUNT && !status; id++) {
        effect_starts list;
        const char *reason = NULL;
        const effect_row *row = effect_row_of((palp_effect_id)id);
        bool there = explain_has(&s->fit, (palp_effect_id)id) && !row->info.repeats;
        if (!s->settings->candidate[id] || !explain_carries(&s->fit.model, &row->info) || there || row->line)
            continue;
        status = explain_starts_find((palp_effect_id)id, &s->data, s->residual, &list, &reason);
        if (status == PALP_ERR_UNSUPPORTED) {
            status = PALP_OK;
            continue;
        }
        for (size_t k = 0; k < list.n; k++) {
            d->effect[d->n++] = list.effect[k];
            if (k + 1 < list.n)
                d->effect[d->n++] = half_way(&row->info, &list.effect[k], &list.effect[k + 1]);
        }
    }
    return status;
}

/* work: room for (n_columns + PALP_EFFECT_PARAMETERS + 2) n. */
static palp_status strength_column(const explain_fit *fit, const palp_effect *effect, const explain_run *run,
                                   double contact, double own_gain, double *work, double *column) {
    palp_model more = fit->model;
    size_t k = palp_forward_parameter_count(&more);
    more.effects[more.n_effects++] = *effect;
    if (explain_bends(&more))
        explain_add_gain(&more, own_gain);
    explain_history history = {.renewed = fit->renewed, .load.peak = run->largest_strain};
    palp_forward_run path = explain_forward_run(run, contact, &history);
    palp_status status = explain_predict(&more, &path, work, work + run->n, NULL);
    if (status)
        memset(column, 0, run->n * sizeof *column);
    else
        memcpy(column, work + (1 + k) * run->n, run->n * sizeof *column);
    palp_load_history_free(&history.load);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

/* Whitened columns of run r: its zero, contact, gain; the model's parameters; rich others of a law and arms;
 * the directions. */
static palp_status make_columns(const explain_search *s, const directions *d, size_t rich, size_t r,
                                double *column) {
    const explain_run *run = &s->data.run[r];
    const palp_model *model = &s->fit.model;
    static const palp_effect offset = {.id = PALP_EFFECT_CONTACT_OFFSET},
                             gain = {.id = PALP_EFFECT_SENSOR_GAIN};
    size_t n = run->n, k = s->fit.n_columns;
    const double contact = s->fit.contact[r];
    double *work = malloc((k + PALP_EFFECT_PARAMETERS + 2) * n * sizeof *work), own[EXPLAIN_NUISANCES],
           sd[EXPLAIN_NUISANCES];
    explain_history history = {.renewed = s->fit.renewed, .load.peak = run->largest_strain};
    palp_forward_run path = explain_forward_run(run, contact, &history);
    palp_status status = work ? PALP_OK : PALP_ERR_NO_MEMORY;
    explain_nuisances(&s->fit, r, own, sd);
    for (size_t i = 0; i < n && work; i++)
        column[i] = 1.0;
    if (!status)
        status = strength_column(&s->fit, &offset, run, contact, own[2], work, column + n);
    if (!status)
        status = strength_column(&s->fit, &gain, run, contact, own[2], work, column + 2 * n);
    if (!status)
        status = explain_predict(model, &path, work, column + 3 * n, NULL);
    if (!status && rich > 0)
        status = explain_rich_columns(s, r, column + (3 + k) * n);
    for (size_t i = 0; i < d->n && !status; i++)
        status = strength_column(&s->fit, &d->effect[i], run, contact, own[2], work,
                                 column + (3 + k + rich + i) * n);
    if (!status)
        explain_whiten(run, 3 + k + rich + d->n, column);
    palp_load_history_free(&history.load);
    free(work);
    return status;
}

/* Takes what columns from..to - 1 can do off those after them in g[m m], whose products they are. */
static void eliminate(double *g, size_t m, size_t from, size_t to) {
    for (size_t p = from; p < to; p++) {
        double pivot = g[p * m + p];
        if (!(pivot > 0.0))
            continue;
        for (size_t i = p + 1; i < m; i++) {
            double share = g[i * m + p] / pivot;
            for (size_t j = p + 1; j < m && share != 0.0; j++)
                g[i * m + j] -= share * g[p * m + j];
        }
    }
}

enum { OWN = 3 }; /* a run's zero, contact and gain */

typedef struct sums {
    const explain_search *search;
    const directions *directions;
    size_t rich, m;
    double *product;     /* [n_runs m m] */
    double *whole;       /* [n_runs m] of the columns' squares before */
    palp_status *status; /* [n_runs] */
} sums;

/* Products of run r's columns with its nuisance parameters eliminated. */
static void sum_task(void *user, size_t r) {
    sums *w = user;
    const explain_search *s = w->search;
    const explain_scatter *scatter = &s->fit.scatter;
    double sd[OWN] = {scatter->zero, scatter->contact, scatter->gain};
    double *g = w->product + r * w->m * w->m, *whole = w->whole + r * w->m;
    if (s->data.run[r].held_out)
        return;
    double *column = malloc(w->m * s->data.run[r].n * sizeof *column);
    w->status[r] = column ? make_columns(s, w->directions, w->rich, r, column) : PALP_ERR_NO_MEMORY;
    if (!w->status[r]) {
        dense_transposed_product(w->m, w->m, s->data.run[r].n, column, column, g);
        for (size_t i = 0; i < w->m; i++)
            whole[i] = g[i * w->m + i];
        for (size_t q = 0; q < OWN; q++)
            g[q * w->m + q] += 1.0 / (sd[q] * sd[q]);
        eliminate(g, w->m, 0, OWN);
    }
    free(column);
}

/* What is left of the directions; [n] of each, squared. */
typedef struct left_of {
    double *product; /* [n n] beside the model, and room for n more */
    double *whole, *beside_own, *beside_law,
        *beside_all; /* of the column; beside the runs' own; the richest law; arms too */
} left_of;

/* Of the sum over all runs, [rest rest]: the model's parameters, the richest law's and arms, the directions.
 */
static void find_left(const explain_search *s, size_t n, size_t rich, double *g, const double *was,
                      left_of *left) {
    const size_t k = s->fit.n_columns, law = rich ? explain_rich_law(&s->data) : 0, at = k + rich,
                 rest = at + n;
    for (size_t i = 0; i < n; i++) {
        left->whole[i] = was[at + i];
        left->beside_own[i] = g[(at + i) * rest + at + i];
    }
    for (size_t p = 0; p < at;
         p++) /* columns that say the same twice: what rounding leaves of them must not count */
        g[p * rest + p] += 1e-10 * was[p];
    eliminate(g, rest, 0, k);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            left->product[i * n + j] = g[(at + i) * rest + at + j];
    eliminate(g, rest, k, k + law);
    for (size_t i = 0; i < n; i++)
        left->beside_law[i] = g[(at + i) * rest + at + i];
    eliminate(g, rest, k + law, at);
    for (size_t i = 0; i < n; i++)
        left->beside_all[i] = g[(at + i) * rest + at + i];
}

/* By elimination run by run (nuisance parameters) and then of all that the runs have in common. */
static palp_status find_products(const explain_search *s, const directions *d, size_t rich, left_of *left) {
    size_t rest = s->fit.n_columns + rich + d->n, m = OWN + rest, n = s->data.n_runs;
    sums w = {.search = s,
              .directions = d,
              .rich = rich,
              .m = m,
              .product = calloc(n * m * (m + 1), sizeof *w.product),
              .status = calloc(n, sizeof *w.status)};
    double *g = calloc(rest * (rest + 1), sizeof *g), *was = g ? g + rest * rest : NULL;
    palp_status status = w.product && w.status && g ? PALP_OK : PALP_ERR_NO_MEMORY;
    w.whole = w.product ? w.product + n * m * m : NULL;
    if (!status)
        status = explain_each(s->settings, n, sum_task, &w, w.status);
    for (size_t r = 0; r < n && !status; r++)
        for (size_t i = 0; i < rest; i++) {
            was[i] += w.whole[r * m + OWN + i];
            for (size_t j = 0; j < rest; j++)
                g[i * rest + j] += w.product[(r * m + OWN + i) * m + OWN + j];
        }
    if (!status)
        find_left(s, d->n, rich, g, was, left);
    free(w.product);
    free(w.status);
    free(g);
    return status;
}

/* The quantile of the largest of the scores that normal numbers with these products have. */
static palp_status simulate(const explain_search *s, size_t n, const left_of *of, double *threshold) {
    double *score = malloc((NULLS + n) * sizeof *score), *z = score + NULLS, *left = of->product;
    uint64_t state = s->settings->seed;
    if (!score)
        return PALP_ERR_NO_MEMORY;
    double *scale = left + n * n;
    for (size_t i = 0; i < n; i++)
        scale[i] = left[i * n + i] > 1e-8 * of->beside_own[i] ? 1.0 / sqrt(left[i * n + i]) : 0.0;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            left[i * n + j] = i == j ? 1.0 + 1e-6 : left[i * n + j] * scale[i] * scale[j];
    if (!dense_cholesky(n, left)) { /* rounding: as if they were independent */
        memset(left, 0, n * n * sizeof *left);
        for (size_t i = 0; i < n; i++)
            left[i * n + i] = 1.0;
    }
    for (size_t k = 0; k < NULLS; k++) {
        score[k] = 0.0;
        for (size_t i = 0; i < n; i++)
            z[i] = palp_random_normal(&state);
        for (size_t i = 0; i < n; i++) {
            double x = 0.0;
            for (size_t j = 0; j <= i; j++)
                x += left[i * n + j] * z[j];
            score[k] = fmax(score[k], scale[i] > 0.0 ? 0.5 * x * x : 0.0);
        }
    }
    *threshold =
        statistics_kth(score, NULLS, (size_t)fmin(NULLS - 1, (1.0 - s->settings->false_alarm) * NULLS));
    free(score);
    return PALP_OK;
}

/* What is left of direction i beside its rivals: of an instrument every law and all arms, of a material every
 * law, of a surface, which is half a law itself and competes with it by evidence, the model at hand. */
static double beside_rivals(const left_of *left, size_t n, size_t i, palp_effect_place place) {
    if (place == PALP_EFFECT_SPECIMEN)
        return left->beside_law[i];
    return place == PALP_EFFECT_CONTACT ? left->product[i * n + i] : left->beside_all[i];
}

/* The share of each effect that is left; of several starts the largest. Of what each run has one of its own,
 * as its contact, only that is asked for which the runs have in common. */
static void find_shares(const directions *d, const left_of *left, double *share) {
    for (size_t i = 0; i < d->n; i++) {
        const effect_row *row = effect_row_of(d->effect[i].id);
        const double rest = beside_rivals(left, d->n, i, row->info.place);
        const bool beside_own = row->of_runs || row->info.place == PALP_EFFECT_CONTACT;
        const double whole = beside_own ? left->beside_own[i] : left->whole[i];
        double *most = &share[d->effect[i].id];
        if (whole > 0.0)
            *most = fmax(*most, sqrt(fmin(1.0, fmax(0.0, rest / whole))));
    }
}

palp_status explain_null_threshold(const explain_search *s, double *threshold, double *share) {
    directions *d = malloc(sizeof *d);
    palp_status status = d ? find_directions(s, d) : PALP_ERR_NO_MEMORY;
    const size_t n = status ? 0 : d->n, rich = share ? explain_rich_law(&s->data) + explain_rich_arms(s) : 0;
    double *work = malloc((n * n + 5 * n + 1) * sizeof *work); /* n may be 0 */
    if (!status && !work)
        status = PALP_ERR_NO_MEMORY;
    if (!status) {
        double *more = work + n * n + n;
        left_of left = {work, more, more + n, more + 2 * n, more + 3 * n};
        status = find_products(s, d, rich, &left);
        if (!status && share)
            find_shares(d, &left, share);
        if (!status)
            status = simulate(s, n, &left, threshold);
    }
    free(work);
    free(d);
    return status;
}
