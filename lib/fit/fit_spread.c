/* fit_spread.c: see fit_spread.h. All work is in u = L' x, for which the harmonic mean of the specimens' own
 * covariances is the identity. So the eigenvalues of "between" are in units of the variance of one specimen's
 * estimate. */
#include "fit_spread.h"

#include "base/arena.h"
#include "base/dense.h"
#include "fit_internal.h"

#include <math.h>
#include <string.h>

enum { ROUNDS = 500 };

typedef struct whitened {
    fit_spread *s;
    arena memory;
    double *l; /* [n n] lower triangle in rows, zeros above */
    double *u, *v,
        *w; /* [n_specimens n], [n_specimens n n] twice: numbers, covariances, weights (v + between)^-1 */
    double *between, *mean, *covariance; /* [n n], [n], [n n] */
    double *a, *b, *sum;                 /* [n n] scratch */
    double *value;                       /* [n] eigenvalues */
} whitened;

static palp_status take_memory(whitened *h) {
    size_t n = h->s->n, m = h->s->n_specimens;
    double **squares[] = {&h->l, &h->between, &h->covariance, &h->a, &h->b, &h->sum};
    for (size_t i = 0; i < sizeof squares / sizeof *squares; i++)
        *squares[i] = arena_take(&h->memory, n * n, sizeof(double));
    h->u = arena_take(&h->memory, m * n, sizeof(double));
    h->v = arena_take(&h->memory, m * n * n, sizeof(double));
    h->w = arena_take(&h->memory, m * n * n, sizeof(double));
    h->mean = arena_take(&h->memory, n, sizeof(double));
    h->value = arena_take(&h->memory, n, sizeof(double));
    return h->memory.failed ? PALP_ERR_NO_MEMORY : PALP_OK;
}

/* Inverse of the positive definite a, which is overwritten. */
static bool invert(size_t n, double *a, double *inverse) {
    if (!dense_cholesky(n, a))
        return false;
    memset(inverse, 0, n * n * sizeof *inverse);
    for (size_t i = 0; i < n; i++)
        inverse[i * n + i] = 1.0;
    dense_cholesky_solve(n, a, n, inverse);
    return true;
}

/* L with L L' = mean of V_i^-1. */
static palp_status find_units(whitened *h) {
    size_t n = h->s->n;
    palp_status status = PALP_OK;
    for (size_t i = 0; i < h->s->n_specimens && !status; i++) {
        memcpy(h->a, h->s->v + i * n * n, n * n * sizeof *h->a);
        status = fit_invert(n, h->a, h->b);
        for (size_t k = 0; k < n * n && !status; k++)
            h->l[k] += 0.5 * (h->b[k] + h->b[k % n * n + k / n]) / (double)h->s->n_specimens;
    }
    if (!status && !dense_cholesky(n, h->l))
        status = PALP_ERR_SINGULAR;
    for (size_t i = 0; i < n; i++)
        for (size_t j = i + 1; j < n; j++)
            h->l[i * n + j] = 0.0;
    return status;
}

/* u = L' x and L' V L; L in rows is L' by columns. */
static void whiten(whitened *h) {
    size_t n = h->s->n;
    for (size_t i = 0; i < h->s->n_specimens; i++) {
        dense_times(n, n, 1.0, h->l, h->s->x + i * n, 0.0, h->u + i * n);
        dense_product(n, n, n, h->l, h->s->v + i * n * n, h->a);
        memset(h->v + i * n * n, 0, n * n * sizeof *h->v);
        dense_add_outer(n, n, n, 1.0, h->a, n, h->l, n, h->v + i * n * n, n);
    }
}

/* Covariance a of u as that of x: L'^-1 a L^-1. */
static void blacken(const whitened *h, const double *a, double *to) {
    size_t n = h->s->n;
    memcpy(h->b, a, n * n * sizeof *a);
    dense_backward(n, h->l, n, h->b);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            to[i * n + j] = h->b[j * n + i];
    dense_backward(n, h->l, n, to);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i; j++)
            to[i * n + j] = to[j * n + i] = 0.5 * (to[i * n + j] + to[j * n + i]);
}

/* Weights, mean and its covariance for the present "between". */
static bool find_mean(whitened *h) {
    size_t n = h->s->n;
    memset(h->sum, 0, n * n * sizeof *h->sum);
    memset(h->mean, 0, n * sizeof *h->mean);
    for (size_t i = 0; i < h->s->n_specimens; i++) {
        double *w = h->w + i * n * n;
        for (size_t k = 0; k < n * n; k++)
            h->a[k] = h->v[i * n * n + k] + h->between[k];
        if (!invert(n, h->a, w))
            return false;
        for (size_t k = 0; k < n * n; k++)
            h->sum[k] += w[k];
        dense_times(n, n, 1.0, w, h->u + i * n, 1.0, h->mean);
    }
    if (!invert(n, h->sum, h->covariance))
        return false;
    memcpy(h->value, h->mean, n * sizeof *h->value);
    dense_times(n, n, 1.0, h->covariance, h->value, 0.0, h->mean);
    return true;
}

/* Adds the contribution of specimen i to "between": E[b b'] = m m' + B - B (W - W C W) B with m = B W (u -
 * mean). */
static void add_moment(whitened *h, size_t i) {
    size_t n = h->s->n;
    const double *w = h->w + i * n * n, *b = h->between;
    double *apart = h->value, *m = h->b;
    for (size_t k = 0; k < n; k++)
        apart[k] = h->u[i * n + k] - h->mean[k];
    dense_times(n, n, 1.0, w, apart, 0.0, m);
    dense_times(n, n, 1.0, b, m, 0.0, apart);
    for (size_t k = 0; k < n * n; k++)
        h->sum[k] += apart[k / n] * apart[k % n] + b[k];
    dense_product(n, n, n, w, b, h->a);               /* G = W B */
    dense_transposed_product(n, n, n, h->a, b, h->b); /* B W B */
    for (size_t k = 0; k < n * n; k++)
        h->sum[k] -= h->b[k];
    dense_product(n, n, n, h->covariance, h->a, h->b); /* C G */
    double *last = h->w + i * n * n;                   /* its weight is no longer needed */
    dense_transposed_product(n, n, n, h->a, h->b, last);
    for (size_t k = 0; k < n * n; k++)
        h->sum[k] += last[k];
}

/* EM until "between" converges; a direction of zero variance stays so. */
static palp_status iterate(whitened *h) {
    size_t n = h->s->n;
    for (int round = 0; round < ROUNDS; round++) {
        double change = 0.0, size = 0.0;
        if (!find_mean(h))
            return PALP_ERR_SINGULAR;
        memset(h->sum, 0, n * n * sizeof *h->sum);
        for (size_t i = 0; i < h->s->n_specimens; i++)
            add_moment(h, i);
        for (size_t k = 0; k < n * n; k++) {
            double next = 0.5 * (h->sum[k] + h->sum[k % n * n + k / n]) / (double)h->s->n_specimens;
            change = fmax(change, fabs(next - h->between[k]));
            size = fmax(size, fabs(next));
            h->a[k] = next;
        }
        memcpy(h->between, h->a, n * n * sizeof *h->a);
        if (change <= 1e-7 * size)
            break;
    }
    return find_mean(h) ? PALP_OK : PALP_ERR_SINGULAR;
}

static void start(whitened *h) {
    size_t n = h->s->n, m = h->s->n_specimens;
    for (size_t i = 0; i < m; i++)
        for (size_t k = 0; k < n; k++)
            h->mean[k] += h->u[i * n + k] / (double)m;
    for (size_t i = 0; i < m; i++)
        for (size_t k = 0; k < n * n; k++)
            h->between[k] += (h->u[i * n + k / n] - h->mean[k / n]) * (h->u[i * n + k % n] - h->mean[k % n]) /
                             (double)(m - 1);
}

/* The 95 % quantile of the largest of so many variances whose true value is 1. It is that of a Wishart
 * matrix, by the Tracy-Widom law with Johnstone's centre and scale. */
static double reached_by_chance(size_t dimensions, size_t freedom) {
    double a = sqrt((double)freedom - 0.5), b = sqrt((double)dimensions - 0.5);
    return ((a + b) * (a + b) + 0.9793 * (a + b) * cbrt(1.0 / a + 1.0 / b)) / (double)freedom;
}

/* Keeps in "between" only the directions that exceed chance. */
static palp_status keep_directions(whitened *h) {
    size_t n = h->s->n, most = h->s->n_specimens - 1 < n ? h->s->n_specimens - 1 : n, kept = 0;
    memcpy(h->a, h->between, n * n * sizeof *h->a);
    palp_status status = dense_eigen(n, h->a, h->value);
    while (!status && kept < most &&
           1.0 + h->value[n - 1 - kept] > reached_by_chance(n - kept, h->s->n_specimens - 1 - kept))
        kept++;
    memset(h->between, 0, n * n * sizeof *h->between);
    for (size_t k = n - kept; k < n && !status; k++)
        for (size_t i = 0; i < n * n; i++)
            h->between[i] += h->value[k] * h->a[k * n + i / n] * h->a[k * n + i % n];
    h->s->n_directions = kept;
    return status;
}

static void give(whitened *h) {
    fit_spread *s = h->s;
    memcpy(s->mean, h->mean, s->n * sizeof *s->mean);
    dense_backward(s->n, h->l, 1, s->mean);
    blacken(h, h->covariance, s->mean_covariance);
    blacken(h, h->between, s->between);
    memset(h->a, 0, s->n * s->n * sizeof *h->a);
    for (size_t i = 0; i < s->n; i++)
        h->a[i * s->n + i] = 1.0;
    blacken(h, h->a, s->within);
}

palp_status fit_spread_find(fit_spread *s) {
    whitened h = {.s = s};
    palp_status status = s->n_specimens < 2 ? PALP_ERR_ARGUMENT : take_memory(&h);
    if (!status)
        status = find_units(&h);
    if (!status) {
        whiten(&h);
        start(&h);
        status = iterate(&h);
    }
    if (!status)
        status = keep_directions(&h);
    if (!status)
        status = iterate(&h);
    if (!status)
        give(&h);
    arena_free(&h.memory);
    return status;
}
