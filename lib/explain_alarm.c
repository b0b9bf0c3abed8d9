/* explain_alarm.c: how much chance alone gains: simulated null cases, linear beside the fit at hand. */
#include "explain_internal.h"
#include "lapack.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { NULLS = 4000 };

/* splitmix64, then Box and Muller. */
static double normal(uint64_t *state) {
    double u[2];
    for (int i = 0; i < 2; i++) {
        uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
        z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
        z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
        u[i] = ((double)((z ^ (z >> 31)) >> 11) + 0.5) * 0x1p-53;
    }
    return sqrt(-2.0 * log(u[0])) * cos(6.28318530717958647692 * u[1]);
}

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

/* Products of what is left of the suspects' directions, by elimination run by run (own numbers) and then of the
 * model's parameters. */
static palp_status directions(const explain_search *s, const explain_directions *d, double *left) {
    enum { Q = 3 };
    const explain_fit *fit = &s->fit;
    size_t k = fit->n_columns, m = Q + k + d->n, longest = s->data.longest;
    double *column = malloc((m * longest + m * m) * sizeof *column), *sum = calloc(m * m, sizeof *sum);
    double sd[Q] = {fit->scatter.zero, fit->scatter.contact, fit->scatter.gain};
    palp_status status = column && sum ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t r = 0; r < s->data.n_runs && !status; r++) {
        double *g = column + m * longest, one = 1.0, zero = 0.0;
        int in = (int)s->data.run[r].n, im = (int)m;
        if (s->data.run[r].held)
            continue;
        status = explain_directions_columns(s, d, r, column);
        if (status)
            break;
        dgemm_("T", "N", &im, &im, &in, &one, column, &in, column, &in, &zero, g, &im);
        for (size_t q = 0; q < Q; q++)
            g[q * m + q] += 1.0 / (sd[q] * sd[q]);
        eliminate(g, m, Q);
        for (size_t i = 0; i < m * m; i++)
            sum[i] += g[i];
    }
    if (!status) {
        size_t rest = k + d->n;
        double *g = column;
        for (size_t i = 0; i < rest; i++)
            for (size_t j = 0; j < rest; j++)
                g[i * rest + j] = sum[(Q + i) * m + Q + j];
        for (size_t i = 0; i < d->n; i++)
            left[d->n * d->n + i] = g[(k + i) * rest + k + i];
        eliminate(g, rest, k);
        for (size_t i = 0; i < d->n; i++)
            for (size_t j = 0; j < d->n; j++)
                left[i * d->n + j] = g[(k + i) * rest + k + j];
    }
    free(column);
    free(sum);
    return status;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
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
    if (!explain_cholesky(left, n)) { /* rounding: as if they were independent */
        memset(left, 0, n * n * sizeof *left);
        for (size_t i = 0; i < n; i++)
            left[i * n + i] = 1.0;
    }
    for (size_t k = 0; k < NULLS; k++) {
        score[k] = 0.0;
        for (size_t i = 0; i < n; i++)
            z[i] = normal(&state);
        for (size_t i = 0; i < n; i++) {
            double x = 0.0;
            for (size_t j = 0; j <= i; j++)
                x += left[i * n + j] * z[j];
            score[k] = fmax(score[k], scale[i] > 0.0 ? 0.5 * x * x : 0.0);
        }
    }
    qsort(score, NULLS, sizeof *score, ascending);
    *threshold = score[(size_t)fmin(NULLS - 1, (1.0 - s->settings->false_alarm) * NULLS)];
    free(score);
    return PALP_OK;
}

palp_status explain_threshold(const explain_search *s, double *threshold, bool seen[PALP_EFFECT_COUNT]) {
    enum { BLIND = 3600 }; /* of the squared effect less than one part in so many is left: not to be seen */
    explain_directions *d = malloc(sizeof *d);
    palp_status status = d ? explain_directions_find(s, d) : PALP_ERR_NO_MEMORY;
    double *left = status ? NULL : malloc((d->n + 1) * d->n * sizeof *left);
    if (!status && !left)
        status = PALP_ERR_NO_MEMORY;
    if (!status)
        status = directions(s, d, left);
    for (size_t i = 0; !status && i < d->n; i++)
        if (left[i * d->n + i] * BLIND > left[d->n * d->n + i] && left[d->n * d->n + i] > 0.0)
            seen[d->effect[i].id] = true;
    if (!status)
        status = simulate(s, d, left, threshold);
    free(left);
    free(d);
    return status;
}
