/* palpation_errors.c: errors that presses have in common, and the likelihood of residuals that have them. The
 * logarithm of a force is off by multiples of these columns: the gain; the network's force over the solid's,
 * which changes with the size of the contact; the error of a lattice that a finer one shows.
 */
#include "palpation_internal.h"

#include "base/dense.h"
#include "base/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Standard deviation of the network's error for a contact of twice the area (doc/palpation.md). */
static const double LAW = 0.04;

/* An error of order p in the cell's side is 1 / (1 - 1.6^-p) times the one that a lattice with 1.6 times as
 * many cells a side shows: 1.64 of the second order, 2.67 of the first. */
static const double MULTIPLE = 1.64, MULTIPLE_SD = 1.0;

/* What then remains of it, over what the finer lattice shows, and the degrees of freedom of the variance. */
static const double REMAINS = 0.25, KNOWN = 2.0;

static void remove_mean(size_t n, double *v) {
    double mean = 0.0;
    for (size_t i = 0; i < n; i++)
        mean += v[i] / (double)n;
    for (size_t i = 0; i < n; i++)
        v[i] -= mean;
}

palp_status palpation_use_errors(palpation_search *s) {
    s->factor = malloc(s->n * s->n * sizeof *s->factor);
    s->column = malloc((PALPATION_COMMON + 5) * s->n * sizeof *s->column);
    if (!s->factor || !s->column)
        return PALP_ERR_NO_MEMORY;
    double *law = s->column + PALPATION_LAW * s->n;
    s->measured = s->column + PALPATION_COMMON * s->n;
    s->bare = s->measured + s->n;
    s->tissue = s->bare + s->n;
    s->more = s->tissue + s->n;
    s->change = s->more + s->n;
    for (size_t i = 0; i < s->n; i++) {
        const palp_palpation_press *p = &s->press[i];
        s->measured[i] = log(p->force_N);
        s->bare[i] = 0.0;
        s->column[PALPATION_GAIN * s->n + i] = 1.0;
        law[i] = log2(p->tool.radius_m * p->depth_m);
    }
    remove_mean(s->n, law);
    return PALP_OK;
}

static void factor_covariance(palpation_search *s) {
    memset(s->factor, 0, s->n * s->n * sizeof *s->factor);
    for (size_t i = 0; i < s->n; i++)
        s->factor[i * s->n + i] = 1.0;
    for (size_t k = 0; k < PALPATION_COMMON; k++)
        dense_add_square(s->n, 1, s->prior[k] / s->variance, s->column + k * s->n, s->factor);
    dense_cholesky(s->n, s->factor);
}

/* A common factor of the tissue alone stays in the forces, as the network may have been calibrated with it.
 * It is as large as a gain that is known may be. One that is not is taken off the forces instead. */
void palpation_set_errors(palpation_search *s, const double *off, double variance) {
    double *error = s->column + PALPATION_LATTICE * s->n;
    const double bare = statistics_mean(s->bare, s->n);
    for (size_t i = 0; i < s->n; i++) {
        error[i] = off[i];
        s->wanted[i] = s->measured[i] - MULTIPLE * (off[i] - bare);
    }
    remove_mean(s->n, error);
    const double remains = REMAINS * REMAINS * dense_dot(s->n, error, error) / (double)s->n;
    s->known = remains > 0.0 ? KNOWN : 0.0;
    s->known_squares = s->known * remains;
    s->prior[PALPATION_GAIN] = s->settings->gain_known ? MULTIPLE * MULTIPLE * bare * bare : 0.0;
    s->prior[PALPATION_LAW] = LAW * LAW;
    s->prior[PALPATION_LATTICE] = MULTIPLE_SD * MULTIPLE_SD;
    s->variance = variance > 0.0 ? variance : remains > 0.0 ? remains : LAW * LAW;
    factor_covariance(s);
}

void palpation_whiten(const palpation_search *s, double *v) {
    if (!s->settings->gain_known)
        remove_mean(s->n, v);
    dense_forward(s->n, s->factor, 1, v);
}

double palpation_gain(const palpation_search *s, const double *r) {
    const double mean = statistics_mean(r, s->n);
    if (!s->settings->gain_known)
        return -mean;
    memcpy(s->moved, r, s->n * sizeof *r);
    dense_cholesky_solve(s->n, s->factor, 1, s->moved);
    return -s->prior[PALPATION_GAIN] / s->variance * dense_dot(s->n, s->column, s->moved);
}

/* Products of the columns and the residuals: all that the likelihood needs of them. */
typedef struct sums {
    size_t n;
    double squares, along[PALPATION_COMMON], gram[PALPATION_COMMON * PALPATION_COMMON], freedom;
} sums;

static sums sum_products(const palpation_search *s, const double *r) {
    const double mean = s->settings->gain_known ? 0.0 : statistics_mean(r, s->n), n = (double)s->n;
    sums m = {.squares = dense_dot(s->n, r, r) - n * mean * mean,
              .freedom = n - (s->settings->gain_known ? 0.0 : 1.0)};
    const double *column[PALPATION_COMMON];
    double sd[PALPATION_COMMON];
    for (size_t k = 0; k < PALPATION_COMMON; k++) {
        column[m.n] = s->column + k * s->n;
        sd[m.n] = sqrt(s->prior[k]);
        m.n += s->prior[k] > 0.0;
    }
    for (size_t a = 0; a < m.n; a++) {
        m.along[a] = sd[a] * dense_dot(s->n, column[a], r);
        for (size_t b = 0; b < m.n; b++)
            m.gram[a * m.n + b] = sd[a] * sd[b] * dense_dot(s->n, column[a], column[b]);
    }
    return m;
}

/* Logarithm of the density of the residuals where a force has this variance. */
static double density_of(const sums *m, double variance) {
    double normal[PALPATION_COMMON * PALPATION_COMMON], along[PALPATION_COMMON];
    for (size_t a = 0; a < m->n * m->n; a++)
        normal[a] = m->gram[a] / variance + (a % (m->n + 1) == 0 ? 1.0 : 0.0);
    memcpy(along, m->along, sizeof along);
    if (!dense_cholesky(m->n, normal))
        return -INFINITY;
    dense_forward(m->n, normal, 1, along);
    const double squares = m->squares / variance - dense_dot(m->n, along, along) / variance / variance;
    return -0.5 * (m->freedom * log(variance) + dense_log_determinant(m->n, normal) + squares);
}

/* The integral over the logarithm of the variance, from 30 times the mean square to e^-40 of that. */
double palpation_likelihood(const palpation_search *s, const double *r) {
    enum { STEPS = 2000 };
    static const double TINY = 1e-24, WIDE = 30.0, SPAN = 40.0;
    const sums m = sum_products(s, r);
    const double high = log(WIDE * (m.squares + s->known_squares + TINY) / (m.freedom + s->known)),
                 step = SPAN / STEPS;
    double most = -INFINITY, sum = 0.0, at[STEPS + 1];
    for (int i = 0; i <= STEPS; i++) {
        const double u = high - step * i, variance = exp(u);
        at[i] = density_of(&m, variance) - 0.5 * (s->known * u + s->known_squares / variance);
        most = fmax(most, at[i]);
    }
    for (int i = 0; i <= STEPS; i++)
        sum += exp(at[i] - most);
    return most + log(step * sum) + (s->known > 0.0 ? 0.5 * s->known * log(s->known_squares) : 0.0);
}
