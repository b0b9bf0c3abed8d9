/* infer_normal.c: what the products of the whitened columns say of parameters and discrepancy, and the
 * evidence. */
#include "infer_internal.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Column of a run's products (parameters, its own, hats, residual) of a global one: hats, then parameters. */
static size_t global_column(const infer_fit *fit, size_t a) {
    return a < INFER_HATS ? fit->k + INFER_OWN + a : a - INFER_HATS;
}

/* Cholesky factor l[BLOCK BLOCK] of the posterior precision of a run's own, given the global ones; and the
 * log determinant of its prior. false: not definite. */
static bool own_factor(const infer_fit *fit, const double *product, double *l, double *log_prior) {
    enum { B = INFER_BLOCK };
    *log_prior = 0.0;
    for (size_t a = 0; a < B; a++)
        for (size_t b = 0; b < B; b++)
            l[a * B + b] = product[(fit->k + a) * fit->m + fit->k + b];
    for (size_t a = 0; a < INFER_OWN; a++) {
        const double sd = fit->sizes.own[a];
        for (size_t b = 0; b < B && !(sd > 0.0); b++)
            l[a * B + b] = l[b * B + a] = 0.0;
        l[a * B + a] += sd > 0.0 ? 1.0 / (sd * sd) : 1.0;
        *log_prior -= sd > 0.0 ? 2.0 * log(sd) : 0.0;
    }
    for (size_t d = 0; d < INFER_DOMAINS; d++) {
        const size_t at = INFER_OWN + d * INFER_NODES;
        const bool any = infer_any(fit->sizes.each[d]);
        for (size_t a = at; a < at + INFER_NODES && !any; a++)
            for (size_t b = 0; b < B; b++)
                l[a * B + b] = l[b * B + a] = 0.0;
        *log_prior += infer_hats_precision(fit->sizes.each[d], B, l + at * B + at);
    }
    return dense_cholesky(B, l);
}

/* Whether a column of the block has no size: it takes nothing. */
static bool is_off(const infer_fit *fit, size_t a) {
    if (a < INFER_OWN)
        return !(fit->sizes.own[a] > 0.0);
    return !infer_any(fit->sizes.each[(a - INFER_OWN) / INFER_NODES]);
}

/* cross[BLOCK (g + 1)]: the run's own beside the global columns and the residual. */
static void own_cross(const infer_fit *fit, const double *product, size_t g, double *cross) {
    for (size_t b = 0; b <= g; b++) {
        const size_t column = b < g ? global_column(fit, b) : fit->m - 1;
        for (size_t a = 0; a < INFER_BLOCK; a++)
            cross[b * INFER_BLOCK + a] = is_off(fit, a) ? 0.0 : product[column * fit->m + fit->k + a];
    }
}

/* Adds run r's part, with its own eliminated, to a[(g + 1) (g + 1)]. cross: [(BLOCK + g + 1) (g + 1)] */
static bool add_run(const infer_fit *fit, size_t r, size_t g, double *a, double *cross, infer_posterior *p) {
    const double *product = fit->product + r * fit->m * fit->m;
    double l[INFER_BLOCK * INFER_BLOCK], log_prior;
    if (!own_factor(fit, product, l, &log_prior))
        return false;
    own_cross(fit, product, g, cross);
    dense_forward(INFER_BLOCK, l, g + 1, cross);
    p->log_det += dense_log_determinant(INFER_BLOCK, l);
    p->log_prior += log_prior;
    for (size_t i = 0; i <= g; i++) {
        const double *row = product + (i < g ? global_column(fit, i) : fit->m - 1) * fit->m;
        for (size_t j = 0; j <= g; j++)
            a[i * (g + 1) + j] += row[j < g ? global_column(fit, j) : fit->m - 1];
    }
    double *square = cross + INFER_BLOCK * (g + 1);
    dense_transposed_product(g + 1, g + 1, INFER_BLOCK, cross, cross, square);
    for (size_t i = 0; i < (g + 1) * (g + 1); i++)
        a[i] -= square[i];
    return true;
}

/* Takes the columns of a common discrepancy without a size out. */
static void drop_absent(const infer_fit *fit, size_t g, double *a) {
    for (size_t i = 0; i < INFER_HATS; i++) {
        const bool any = infer_any(fit->sizes.common[i / INFER_NODES]);
        for (size_t j = 0; j <= g && !any; j++)
            a[i * (g + 1) + j] = a[j * (g + 1) + i] = 0.0;
    }
}

/* Adds the priors to a[(g + 1) (g + 1)] and factorizes. */
static palp_status solve(const infer_fit *fit, const explain_data *data, infer_posterior *p, double *a,
                         double *q) {
    const size_t g = p->g, k = fit->k, e = g + 1;
    double log_prior;
    palp_status status = infer_prior(fit, data, q, &log_prior);
    if (status)
        return status;
    p->log_prior += log_prior;
    for (size_t d = 0; d < INFER_DOMAINS; d++)
        p->log_prior += infer_hats_precision(fit->sizes.common[d], e, a + d * INFER_NODES * (e + 1));
    p->chi2 = a[e * e - 1];
    for (size_t i = 0; i < k; i++)
        for (size_t j = 0; j < k; j++) {
            const double off = fit->c.x[j] - fit->given[j];
            a[(INFER_HATS + i) * e + INFER_HATS + j] += q[i * k + j];
            a[g * e + INFER_HATS + i] -= q[i * k + j] * off;
            p->chi2 += (fit->c.x[i] - fit->given[i]) * q[i * k + j] * off;
        }
    for (size_t i = 0; i < g; i++) {
        memcpy(p->factor + i * g, a + i * e, g * sizeof *p->factor);
        p->mean[i] = a[g * e + i];
    }
    return dense_cholesky(g, p->factor) ? PALP_OK : PALP_ERR_SINGULAR;
}

palp_status infer_posterior_find(const infer_fit *fit, const explain_data *data, infer_posterior *p) {
    const size_t k = fit->k, g = k + INFER_HATS, e = g + 1;
    memset(p, 0, sizeof *p);
    p->g = g;
    p->memory = calloc(g * g + g + k * k + k + e * e + k * k + (INFER_BLOCK + e) * e, sizeof *p->memory);
    if (!p->memory)
        return PALP_ERR_NO_MEMORY;
    p->factor = p->memory;
    p->mean = p->factor + g * g;
    p->normal = p->mean + g;
    p->pull = p->normal + k * k;
    double *a = p->pull + k, *q = a + e * e, *cross = q + k * k;
    bool good = true;
    for (size_t r = 0; r < data->n_runs && good; r++)
        good = data->run[r].held_out || add_run(fit, r, g, a, cross, p);
    drop_absent(fit, g, a);
    palp_status status = good ? solve(fit, data, p, a, q) : PALP_ERR_SINGULAR;
    if (status) {
        infer_posterior_free(p);
        return status;
    }
    p->log_det += dense_log_determinant(g, p->factor);
    dense_forward(g, p->factor, 1, p->mean);
    p->here = p->chi2 - dense_dot(INFER_HATS, p->mean, p->mean);
    p->chi2 -= dense_dot(g, p->mean, p->mean);
    for (size_t i = 0; i < k; i++) {
        const double *row = p->factor + (INFER_HATS + i) * g + INFER_HATS;
        p->pull[i] = dense_dot(i + 1, row, p->mean + INFER_HATS);
        for (size_t j = 0; j <= i; j++)
            p->normal[i * k + j] = p->normal[j * k + i] =
                dense_dot(j + 1, row, p->factor + (INFER_HATS + j) * g + INFER_HATS);
    }
    dense_backward(g, p->factor, 1, p->mean);
    return PALP_OK;
}

void infer_posterior_free(infer_posterior *p) {
    free(p->memory);
    memset(p, 0, sizeof *p);
}

double infer_log_evidence(const infer_fit *fit, const infer_posterior *p) {
    return -0.5 * (p->chi2 + fit->log_noise + p->log_det - p->log_prior);
}

palp_status infer_own(const infer_fit *fit, const infer_posterior *p, size_t r, double *mean,
                      double *covariance) {
    enum { B = INFER_BLOCK };
    const double *product = fit->product + r * fit->m * fit->m;
    const size_t g = p->g;
    double l[B * B], log_prior;
    double *cross = malloc((g + 1) * B * sizeof *cross), *turned = malloc(g * B * sizeof *turned);
    palp_status status = cross && turned ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status && !own_factor(fit, product, l, &log_prior))
        status = PALP_ERR_SINGULAR;
    if (!status) {
        own_cross(fit, product, g, cross);
        memcpy(mean, cross + g * B, B * sizeof *mean);
        dense_times(B, g, -1.0, cross, p->mean, 1.0, mean);
        dense_cholesky_solve(B, l, 1, mean);
    }
    if (!status && covariance) {
        memset(covariance, 0, B * B * sizeof *covariance);
        for (size_t a = 0; a < B; a++)
            covariance[a * B + a] = 1.0;
        dense_cholesky_solve(B, l, B, covariance);
        dense_cholesky_solve(B, l, g, cross); /* sensitivity of the own to the global ones */
        for (size_t a = 0; a < B; a++)
            for (size_t b = 0; b < g; b++)
                turned[a * g + b] = cross[b * B + a];
        dense_forward(g, p->factor, B, turned);
        for (size_t a = 0; a < B; a++)
            for (size_t b = 0; b < B; b++)
                covariance[a * B + b] += dense_dot(g, turned + a * g, turned + b * g);
    }
    free(cross);
    free(turned);
    return status;
}
