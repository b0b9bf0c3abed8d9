/* explain_cross.c: how well a fit to the other runs predicts each, or of one run a fit to its other parts
 * each part. */
#include "explain_fit.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Log score of run r, whose sums are among h and g if counted, predicted by a fit to the others. work: [3 k k
 * + 3 k]. */
static double predicted_score(const explain_fit *fit, size_t r, bool counted, const double *h,
                              const double *g, double *work) {
    size_t k = fit->n_columns;
    double *own = work, *rest = own + k * k, *factor = rest + k * k, *own_g = factor + k * k,
           *move = own_g + k, *after = move + k, chi2, logdet, share = counted ? 1.0 : 0.0;
    explain_normal_of(fit, r, own, own_g, &chi2, &logdet);
    for (size_t i = 0; i < k * k; i++)
        rest[i] = h[i] - share * own[i];
    for (size_t i = 0; i < k; i++) { /* a coordinate on its bound stays there */
        bool stuck = fit->x[i] <= fit->low[i] || fit->x[i] >= fit->high[i];
        move[i] = stuck ? 0.0 : g[i] - share * own_g[i];
        rest[i * k + i] += 1e-9 * h[i * k + i];
        for (size_t j = 0; j < k && stuck; j++)
            rest[i * k + j] = rest[j * k + i] = 0.0;
        if (stuck)
            rest[i * k + i] = 1e30;
    }
    memcpy(factor, rest, k * k * sizeof *factor);
    if (!dense_cholesky(k, factor))
        return -HUGE_VAL;
    dense_cholesky_solve(k, factor, 1, move);
    logdet -= dense_log_determinant(k, factor);
    for (size_t i = 0; i < k; i++) {
        after[i] = own_g[i];
        for (size_t j = 0; j < k; j++)
            after[i] -= own[i * k + j] * move[j];
        chi2 -= move[i] * (own_g[i] + after[i]);
    }
    for (size_t i = 0; i < k * k; i++)
        factor[i] = rest[i] + own[i];
    if (!dense_cholesky(k, factor))
        return -HUGE_VAL;
    logdet += dense_log_determinant(k, factor);
    dense_forward(k, factor, 1, after);
    return -0.5 * (chi2 - dense_dot(k, after, after) + logdet);
}

palp_status explain_fit_leave_out(const explain_fit *fit, const explain_data *data, double *score) {
    size_t k = fit->n_columns;
    double *h = malloc((4 * k * k + 5 * k) * sizeof *h), chi2;
    if (!h)
        return PALP_ERR_NO_MEMORY;
    double *g = h + k * k, *work = g + k;
    explain_fit_total(fit, data, h, g, &chi2, work);
    for (size_t r = 0; r < data->n_runs; r++)
        score[r] = predicted_score(fit, r, !data->run[r].held_out, h, g, work);
    free(h);
    return PALP_OK;
}

/* ---- parts of the only run ---- */

enum { PARTS = 8 };

/* Products of the columns over each part, [PARTS m m]; status: of the visit. */
typedef struct parts {
    const explain_data *data;
    size_t m;
    double *product;
    palp_status status;
} parts;

static void find_parts(void *user, size_t r, const double *column) {
    parts *p = user;
    const explain_run *run = &p->data->run[r];
    const size_t m = p->m;
    if (run->held_out)
        return;
    double *part = malloc(m * (run->n / PARTS + 1) * sizeof *part);
    p->status = part ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t b = 0; b < PARTS && part; b++) {
        const size_t from = b * run->n / PARTS, n = (b + 1) * run->n / PARTS - from;
        for (size_t j = 0; j < m; j++)
            memcpy(part + j * n, column + j * run->n + from, n * sizeof *part);
        dense_transposed_product(m, m, n, part, part, p->product + b * m * m);
    }
    free(part);
}

/* Log likelihood of what has these products, parameters and the run's own contact, zero, gain and hum
 * integrated out. work: [m m] */
static double evidence(const explain_fit *fit, const double *product, double *work) {
    const explain_scatter *s = &fit->scatter;
    const double sd[EXPLAIN_NUISANCES] = {s->zero, s->contact, s->gain, fit->hum_N, fit->hum_N, s->stiffness};
    const size_t m = fit->m, n = m - 1, k = fit->n_columns;
    double *h = work, *g = work + n * n, chi2 = product[n * m + n];
    bool still[EXPLAIN_COLUMNS + EXPLAIN_NUISANCES]; /* a parameter on its bound, a nuisance that is none */
    for (size_t i = 0; i < n; i++)
        still[i] = i < k ? fit->x[i] <= fit->low[i] || fit->x[i] >= fit->high[i] : !(sd[i - k] > 0.0);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++)
            h[i * n + j] = still[i] || still[j] ? 0.0 : product[i * m + j];
        const double scale = still[i] ? 1.0 : i < k ? fit->unit[i] : sd[i - k];
        h[i * n + i] += 1.0 / (scale * scale);
        g[i] = still[i] ? 0.0 : product[i * m + n];
    }
    if (!dense_cholesky(n, h))
        return -HUGE_VAL;
    const double logdet = dense_log_determinant(n, h);
    dense_forward(n, h, 1, g);
    return -0.5 * (chi2 - dense_dot(n, g, g) + logdet);
}

/* Log score of each part of the only run that is fitted, predicted by the others: score[PARTS]. */
static palp_status leave_parts_out(const explain_fit *fit, const explain_data *data, double *score) {
    const size_t m = fit->m, all = m * m;
    explain_fit copy = {.n_columns = 0};
    parts p = {.data = data, .m = m, .product = malloc((PARTS + 3) * all * sizeof *p.product)};
    palp_status status = p.product ? explain_fit_copy(fit, data->n_runs, &copy) : PALP_ERR_NO_MEMORY;
    if (!status)
        status = explain_fit_visit(&copy, data, NULL, NULL, find_parts, &p);
    if (!status)
        status = p.status;
    if (!status) {
        double *sum = p.product + PARTS * all, *rest = sum + all, *work = rest + all;
        memset(sum, 0, all * sizeof *sum);
        for (size_t i = 0; i < PARTS * all; i++)
            sum[i % all] += p.product[i];
        const double whole = evidence(&copy, sum, work);
        for (size_t b = 0; b < PARTS; b++) {
            for (size_t i = 0; i < all; i++)
                rest[i] = sum[i] - p.product[b * all + i];
            score[b] = whole - evidence(&copy, rest, work);
        }
    }
    explain_fit_free(&copy);
    free(p.product);
    return status;
}

/* ---- two fits ---- */

palp_status explain_paired(const explain_data *data, const explain_fit *a, const explain_fit *b,
                           explain_pair *pair) {
    const bool alone = explain_fitted_runs(data) == 1;
    size_t n = alone ? PARTS : data->n_runs, counted = 0;
    double *score = malloc(2 * n * sizeof *score), squares = 0.0, most = -HUGE_VAL;
    if (!score)
        return PALP_ERR_NO_MEMORY;
    palp_status status = alone ? leave_parts_out(a, data, score) : explain_fit_leave_out(a, data, score);
    if (!status)
        status = alone ? leave_parts_out(b, data, score + n) : explain_fit_leave_out(b, data, score + n);
    *pair = (explain_pair){.gain = 0.0};
    for (size_t r = 0; r < n; r++) {
        if (status || (!alone && data->run[r].held_out))
            continue;
        score[r] = fmax(score[n + r], -1e12) - fmax(score[r], -1e12);
        pair->gain += score[r];
        most = fmax(most, score[r]);
        counted++;
    }
    for (size_t r = 0; r < n; r++)
        squares += status || (!alone && data->run[r].held_out)
                       ? 0.0
                       : pow(score[r] - pair->gain / (double)counted, 2);
    pair->rest = pair->gain - most;
    pair->se = counted > 1 ? sqrt(squares * (double)counted / (double)(counted - 1)) : 0.0;
    free(score);
    return status;
}
