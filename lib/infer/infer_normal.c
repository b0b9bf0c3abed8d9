/* infer_normal.c: what the products of the whitened columns say of parameters and discrepancy, and the
 * evidence. */
#include "infer_internal.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SPECIMEN_SQUARE = INFER_SPECIMEN * INFER_SPECIMEN };

/* Column of a run's products (parameters, its own, hats, specimen's, residual) of an outer one: hats,
 * parameters, specimen's, residual. */
static size_t outer_column(const infer_fit *fit, size_t a) {
    const size_t g = INFER_HATS + fit->k;
    return a < INFER_HATS ? fit->k + INFER_OWN + a : a < g ? a - INFER_HATS : fit->k + INFER_BLOCK + (a - g);
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

/* cross[BLOCK outer]: the run's own beside the outer columns. */
static void own_cross(const infer_fit *fit, const double *product, size_t outer, double *cross) {
    for (size_t b = 0; b < outer; b++) {
        const size_t g = INFER_HATS + fit->k, column = outer_column(fit, b);
        const bool off = b >= g && b < g + INFER_SPECIMEN && !(fit->sizes.specimen[b - g] > 0.0);
        for (size_t a = 0; a < INFER_BLOCK; a++)
            cross[b * INFER_BLOCK + a] = off || is_off(fit, a) ? 0.0 : product[column * fit->m + fit->k + a];
    }
}

/* Adds run r's part, with its own eliminated, to the outer matrix a[outer outer]; and to the log determinants
 * of posterior and prior. cross: [(BLOCK + outer) outer] */
static bool add_run(const infer_fit *fit, size_t r, size_t outer, double *a, double *cross, double det[2]) {
    const double *product = fit->product + r * fit->m * fit->m;
    double l[INFER_BLOCK * INFER_BLOCK], log_prior;
    if (!own_factor(fit, product, l, &log_prior))
        return false;
    own_cross(fit, product, outer, cross);
    dense_forward(INFER_BLOCK, l, outer, cross);
    det[0] += dense_log_determinant(INFER_BLOCK, l);
    det[1] += log_prior;
    for (size_t i = 0; i < outer; i++) {
        const double *row = product + outer_column(fit, i) * fit->m;
        for (size_t j = 0; j < outer; j++)
            a[i * outer + j] += row[outer_column(fit, j)];
    }
    double *square = cross + INFER_BLOCK * outer;
    dense_transposed_product(outer, outer, INFER_BLOCK, cross, cross, square);
    for (size_t i = 0; i < outer * outer; i++)
        a[i] -= square[i];
    return true;
}

/* Doubles that a posterior keeps of a specimen: Cholesky factor of what is its own given the global ones, and
 * that factor's inverse times its rows beside the global columns and the residual, a column after the
 * other. */
static size_t specimen_room(size_t g) {
    return SPECIMEN_SQUARE + INFER_SPECIMEN * (g + 1);
}

/* The specimen's own out of a[outer outer], lower triangle; keep[specimen_room]. */
static bool take_specimen(const infer_fit *fit, size_t g, const double *a, double *keep, double det[2]) {
    enum { S = INFER_SPECIMEN };
    const size_t outer = g + S + 1;
    double *rows = keep + SPECIMEN_SQUARE;
    for (size_t i = 0; i < S; i++) {
        const double sd = fit->sizes.specimen[i];
        const bool on = sd > 0.0;
        for (size_t j = 0; j < S; j++) {
            const size_t high = i > j ? i : j, low = i > j ? j : i;
            keep[i * S + j] = on && fit->sizes.specimen[j] > 0.0 ? a[(g + high) * outer + g + low] : 0.0;
        }
        keep[i * S + i] += on ? 1.0 / (sd * sd) : 1.0;
        det[1] -= on ? 2.0 * log(sd) : 0.0;
        for (size_t b = 0; b < g; b++)
            rows[b * S + i] = on ? a[(g + i) * outer + b] : 0.0;
        rows[g * S + i] = on ? a[(g + S) * outer + g + i] : 0.0;
    }
    if (!dense_cholesky(S, keep))
        return false;
    dense_forward(S, keep, g + 1, rows);
    det[0] += dense_log_determinant(S, keep);
    return true;
}

/* Adds the runs from .. to - 1 of one specimen to a[(g + 1) (g + 1)]. One of which no run is fitted has its
 * own all the same, but adds nothing. inner: [(g + SPECIMEN + 1) (g + SPECIMEN + 1)]. */
static bool add_specimen(const infer_fit *fit, const explain_data *data, size_t from, size_t to, double *a,
                         double *inner, double *cross, infer_posterior *p) {
    enum { S = INFER_SPECIMEN };
    const size_t g = p->g, outer = g + S + 1, room = specimen_room(g);
    double det[2] = {0.0, 0.0}, *keep = p->specimen + from * room, *rows = keep + SPECIMEN_SQUARE;
    bool fitted = false;
    memset(inner, 0, outer * outer * sizeof *inner);
    for (size_t r = from; r < to; r++)
        fitted = fitted || !data->run[r].held_out;
    for (size_t r = from; r < to; r++)
        if (!(fitted && data->run[r].held_out) && !add_run(fit, r, outer, inner, cross, det))
            return false;
    if (!take_specimen(fit, g, inner, keep, det))
        return false;
    for (size_t r = from + 1; r < to; r++)
        memcpy(p->specimen + r * room, keep, room * sizeof *keep);
    for (size_t i = 0; i <= g && fitted; i++)
        for (size_t j = 0; j <= i; j++) {
            const size_t at = i < g ? i : g + S;
            const double sum =
                inner[at * outer + (j < g ? j : g + S)] - dense_dot(S, rows + i * S, rows + j * S);
            a[i * (g + 1) + j] += sum;
            a[j * (g + 1) + i] += i != j ? sum : 0.0;
        }
    p->log_det += fitted ? det[0] : 0.0;
    p->log_prior += fitted ? det[1] : 0.0;
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
    const size_t k = fit->k, g = k + INFER_HATS, e = g + 1, outer = e + INFER_SPECIMEN;
    memset(p, 0, sizeof *p);
    p->g = g;
    p->memory = calloc(g * g + g + k * k + k + e * e + k * k + (INFER_BLOCK + outer) * outer + outer * outer +
                           data->n_runs * specimen_room(g),
                       sizeof *p->memory);
    if (!p->memory)
        return PALP_ERR_NO_MEMORY;
    p->factor = p->memory;
    p->mean = p->factor + g * g;
    p->normal = p->mean + g;
    p->pull = p->normal + k * k;
    double *a = p->pull + k, *q = a + e * e, *cross = q + k * k,
           *inner = cross + (INFER_BLOCK + outer) * outer;
    p->specimen = inner + outer * outer;
    bool good = true;
    for (size_t from = 0, to = 0; from < data->n_runs && good; from = to) {
        while (to < data->n_runs && data->run[to].specimen == data->run[from].specimen)
            to++;
        good = add_specimen(fit, data, from, to, a, inner, cross, p);
    }
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
    return infer_bends_evidence(fit) - 0.5 * (p->chi2 + fit->log_noise + p->log_det - p->log_prior);
}

/* -d own / d global of the specimen of run r: slope[SPECIMEN (g + 1)], and the best own without a step as the
 * last column. */
static const double *specimen_slope(const infer_posterior *p, size_t r, double *slope) {
    const double *keep = p->specimen + r * specimen_room(p->g);
    memcpy(slope, keep + SPECIMEN_SQUARE, INFER_SPECIMEN * (p->g + 1) * sizeof *slope);
    dense_backward(INFER_SPECIMEN, keep, p->g + 1, slope);
    return keep;
}

/* covariance[n n] += x C x' with C of the global ones, x[g n] (a column after the other). */
static palp_status add_global(const infer_posterior *p, size_t n, const double *x, double *covariance) {
    const size_t g = p->g;
    double *turned = malloc(g * n * sizeof *turned);
    if (!turned)
        return PALP_ERR_NO_MEMORY;
    for (size_t a = 0; a < n; a++)
        for (size_t b = 0; b < g; b++)
            turned[a * g + b] = x[b * n + a];
    dense_forward(g, p->factor, n, turned);
    for (size_t a = 0; a < n; a++)
        for (size_t b = 0; b < n; b++)
            covariance[a * n + b] += dense_dot(g, turned + a * g, turned + b * g);
    free(turned);
    return PALP_OK;
}

/* C[n n] = the inverse of the factor's square. */
static void invert(size_t n, const double *factor, double *c) {
    memset(c, 0, n * n * sizeof *c);
    for (size_t a = 0; a < n; a++)
        c[a * n + a] = 1.0;
    dense_cholesky_solve(n, factor, n, c);
}

palp_status infer_specimen_own(const infer_posterior *p, size_t r, double *mean, double *covariance) {
    enum { S = INFER_SPECIMEN };
    const size_t g = p->g;
    double *slope = malloc((g + 1) * S * sizeof *slope);
    if (!slope)
        return PALP_ERR_NO_MEMORY;
    const double *keep = specimen_slope(p, r, slope);
    for (size_t a = 0; a < S; a++) {
        mean[a] = slope[g * S + a];
        for (size_t b = 0; b < g; b++)
            mean[a] -= slope[b * S + a] * p->mean[b];
    }
    palp_status status = PALP_OK;
    if (covariance) {
        invert(S, keep, covariance);
        status = add_global(p, S, slope, covariance);
    }
    free(slope);
    return status;
}

palp_status infer_own(const infer_fit *fit, const infer_posterior *p, size_t r, double *mean,
                      double *covariance) {
    enum { B = INFER_BLOCK, S = INFER_SPECIMEN };
    const double *product = fit->product + r * fit->m * fit->m;
    const size_t g = p->g, outer = g + S + 1;
    double l[B * B], log_prior, specimen[S], spread[S * S];
    double *cross = malloc(outer * B * sizeof *cross), *slope = malloc((g + 1) * S * sizeof *slope);
    palp_status status = cross && slope ? infer_specimen_own(p, r, specimen, NULL) : PALP_ERR_NO_MEMORY;
    if (!status && !own_factor(fit, product, l, &log_prior))
        status = PALP_ERR_SINGULAR;
    if (!status) {
        own_cross(fit, product, outer, cross);
        dense_cholesky_solve(B, l, outer, cross); /* sensitivity of the own to the outer ones */
        for (size_t a = 0; a < B; a++) {
            mean[a] = cross[(g + S) * B + a];
            for (size_t b = 0; b < g; b++)
                mean[a] -= cross[b * B + a] * p->mean[b];
            for (size_t b = 0; b < S; b++)
                mean[a] -= cross[(g + b) * B + a] * specimen[b];
        }
    }
    if (!status && covariance) {
        const double *by = cross + g * B;
        invert(S, specimen_slope(p, r, slope), spread);
        invert(B, l, covariance);
        for (size_t a = 0; a < B; a++)
            for (size_t b = 0; b < B; b++)
                for (size_t i = 0; i < S * S; i++)
                    covariance[a * B + b] += by[i / S * B + a] * spread[i] * by[i % S * B + b];
        for (size_t b = 0; b < g; b++)
            for (size_t s = 0; s < S; s++)
                for (size_t a = 0; a < B; a++)
                    cross[b * B + a] -= by[s * B + a] * slope[b * S + s];
        status = add_global(p, B, cross, covariance);
    }
    free(cross);
    free(slope);
    return status;
}
