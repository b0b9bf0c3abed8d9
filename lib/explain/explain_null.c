/* explain_null.c: how much chance alone gains: simulated null cases, linear beside the fit at hand. */
#include "explain_internal.h"
#include "base/dense.h"
#include "base/statistics.h"

#include <math.h>
#include <palpate/random.h>
#include <stdlib.h>
#include <string.h>

enum { NULLS = 4000 };

/* Takes what `first` columns can do off the rest of g[m m], whose products they are. */
static void eliminate(double *g, size_t m, size_t first) {
    for (size_t p = 0; p < first; p++) {
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
    const explain_directions *directions;
    size_t m;
    double *product;     /* [n_runs m m] */
    palp_status *status; /* [n_runs] */
} sums;

/* Products of run r's columns with its nuisance parameters eliminated. */
static void sum_task(void *user, size_t r) {
    sums *w = user;
    const explain_search *s = w->search;
    const explain_scatter *scatter = &s->fit.scatter;
    double sd[OWN] = {scatter->zero, scatter->contact, scatter->gain};
    double *g = w->product + r * w->m * w->m;
    if (s->data.run[r].held_out)
        return;
    double *column = malloc(w->m * s->data.run[r].n * sizeof *column);
    w->status[r] = column ? explain_directions_columns(s, w->directions, r, column) : PALP_ERR_NO_MEMORY;
    if (!w->status[r]) {
        dense_transposed_product(w->m, w->m, s->data.run[r].n, column, column, g);
        for (size_t q = 0; q < OWN; q++)
            g[q * w->m + q] += 1.0 / (sd[q] * sd[q]);
        eliminate(g, w->m, OWN);
    }
    free(column);
}

/* Products of what is left of the candidates' directions, by elimination run by run ((nuisance parameters)) and then of the
 * model's parameters. left: [d->n d->n], and then what they were before the latter. */
static palp_status directions(const explain_search *s, const explain_directions *d, double *left) {
    size_t k = s->fit.n_columns, rest = k + d->n, m = OWN + rest, n = s->data.n_runs;
    sums w = {.search = s, .directions = d, .m = m, .product = calloc(n * m * m, sizeof *w.product),
              .status = calloc(n, sizeof *w.status)};
    double *g = calloc(rest * rest, sizeof *g);
    palp_status status = w.product && w.status && g ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status && s->settings->loop)
        s->settings->loop(s->settings->loop_user, n, sum_task, &w);
    for (size_t r = 0; r < n && !status && !s->settings->loop; r++)
        sum_task(&w, r);
    for (size_t r = 0; r < n && !status; r++) {
        status = w.status[r];
        for (size_t i = 0; i < rest; i++)
            for (size_t j = 0; j < rest; j++)
                g[i * rest + j] += w.product[(r * m + OWN + i) * m + OWN + j];
    }
    if (!status) {
        for (size_t i = 0; i < d->n; i++)
            left[d->n * d->n + i] = g[(k + i) * rest + k + i];
        eliminate(g, rest, k);
        for (size_t i = 0; i < d->n; i++)
            for (size_t j = 0; j < d->n; j++)
                left[i * d->n + j] = g[(k + i) * rest + k + j];
    }
    free(w.product);
    free(w.status);
    free(g);
    return status;
}

/* The quantile of the largest of the scores that normal numbers with these products have. */
static palp_status simulate(const explain_search *s, const explain_directions *d, double *left, double *threshold) {
    size_t n = d->n;
    double *score = malloc((NULLS + n) * sizeof *score), *z = score + NULLS;
    uint64_t state = s->settings->seed;
    if (!score)
        return PALP_ERR_NO_MEMORY;
    double *scale = left + n * n;
    for (size_t i = 0; i < n; i++)
        scale[i] = left[i * n + i] > 1e-8 * scale[i] ? 1.0 / sqrt(left[i * n + i]) : 0.0;
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
    *threshold = statistics_kth(score, NULLS, (size_t)fmin(NULLS - 1, (1.0 - s->settings->false_alarm) * NULLS));
    free(score);
    return PALP_OK;
}

palp_status explain_null_threshold(const explain_search *s, double *threshold, bool *seen) {
    enum { BLIND = 3600 }; /* of the squared effect less than one part in so many is left: not to be seen */
    explain_directions *d = malloc(sizeof *d);
    palp_status status = d ? explain_directions_find(s, d) : PALP_ERR_NO_MEMORY;
    double *left = status ? NULL : malloc((d->n + 1) * (d->n + 1) * sizeof *left); /* d->n may be 0 */
    if (!status && !left)
        status = PALP_ERR_NO_MEMORY;
    if (!status)
        status = directions(s, d, left);
    for (size_t i = 0; seen && !status && i < d->n; i++)
        if (left[i * d->n + i] * BLIND > left[d->n * d->n + i] && left[d->n * d->n + i] > 0.0)
            seen[d->effect[i].id] = true;
    if (!status)
        status = simulate(s, d, left, threshold);
    free(left);
    free(d);
    return status;
}
