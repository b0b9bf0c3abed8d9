/* infer_prior.c: the priors of the coordinates and of the discrepancies, and a first guess of their sizes. */
#include "infer_internal.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const double infer_lengths[INFER_LENGTHS] = {0.5, 0.125};

bool infer_any(const double size[INFER_LENGTHS]) {
    bool any = false;
    for (int l = 0; l < INFER_LENGTHS; l++)
        any = any || size[l] > 0.0;
    return any;
}

void infer_matern(double length, double *covariance) {
    for (size_t i = 0; i < INFER_NODES; i++)
        for (size_t j = 0; j < INFER_NODES; j++) {
            const double apart = fabs((double)i - (double)j) / (INFER_NODES - 1);
            const double x = sqrt(3.0) * apart / length;
            covariance[i * INFER_NODES + j] = (1.0 + x) * exp(-x) + (i == j ? 1e-9 : 0.0);
        }
}

double infer_hats_precision(const double size[INFER_LENGTHS], size_t n, double *a) {
    enum { N = INFER_NODES };
    double sum[N * N] = {0.0}, one[N * N], inverse[N * N] = {0.0};
    const bool any = infer_any(size);
    for (int l = 0; l < INFER_LENGTHS; l++) {
        infer_matern(infer_lengths[l], one);
        for (size_t i = 0; i < N * N; i++)
            sum[i] += size[l] * size[l] * one[i];
    }
    for (size_t i = 0; i < N; i++)
        inverse[i * N + i] = 1.0;
    if (any) {
        dense_cholesky(N, sum);
        dense_cholesky_solve(N, sum, N, inverse);
    }
    for (size_t i = 0; i < N; i++)
        for (size_t j = 0; j < N; j++)
            a[i * n + j] += inverse[i * N + j];
    return any ? -dense_log_determinant(N, sum) : 0.0;
}

/* r.m.s. force over r.m.s. column of parameter p: the strength that changes the forces by their own size. A
 * parameter by which they jump is a force, which is the largest change by itself. */
static double strength_of(const infer_fit *fit, const explain_data *data, size_t p) {
    double force = 0.0, column = 0.0;
    for (size_t r = 0, at = 0; r < data->n_runs; at += data->run[r++].n) {
        const double *by = fit->raw + at * fit->m + p * data->run[r].n;
        const bool jumps = fit->scan[p].jumps;
        for (size_t i = 0; i < data->run[r].n; i++) {
            force += data->run[r].force[i] * data->run[r].force[i];
            column += jumps ? 1.0 : by[i] * by[i];
        }
    }
    return column > 0.0 ? sqrt(force / column) : HUGE_VAL;
}

palp_status infer_prior(const infer_fit *fit, const explain_data *data, double *q, double *log_det) {
    const size_t k = fit->k;
    const bool spline = fit->c.model.material.law.kind == PALP_LAW_SPLINE;
    memset(q, 0, k * k * sizeof *q);
    for (size_t a = 0; a < k; a++) {
        double sd = fit->width[a] > 0.0 ? fit->width[a] : strength_of(fit, data, a);
        if (!isfinite(sd)) /* it changes nothing here: any value will do */
            sd = fit->c.unit[a];
        q[a * k + a] = 1.0 / (sd * sd);
    }
    for (size_t i = 1; spline && fit->n_known == 0 && i + 1 < fit->c.model.material.law.n; i++) {
        const double weight = fit->certain[i] / (fit->sizes.bend * fit->sizes.bend);
        const double d[3] = {1.0, -2.0, 1.0};
        for (size_t a = 0; a < 3; a++)
            for (size_t b = 0; b < 3; b++)
                q[(i - 1 + a) * k + i - 1 + b] += weight * d[a] * d[b];
    }
    double *copy = malloc(k * k * sizeof *copy);
    if (!copy)
        return PALP_ERR_NO_MEMORY;
    memcpy(copy, q, k * k * sizeof *copy);
    const bool definite = dense_cholesky(k, copy);
    *log_det = definite ? dense_log_determinant(k, copy) : 0.0;
    free(copy);
    return definite ? PALP_OK : PALP_ERR_SINGULAR;
}

double infer_cauchy_certain(double square) {
    return 2.0 / (1.0 + square);
}

/* The precisions have independent gamma distributions of shape and rate 1/2; q of each, of shape 1, is the
 * nearest to its posterior. The bound of the evidence has the expected log of the prior over q, less the
 * excess of the determinant with the expected precision. */
double infer_cauchy_evidence(double certain) {
    return 0.5 * (log(certain) - certain + 1.0);
}

double infer_bends_evidence(const infer_fit *fit) {
    const palp_law *law = &fit->c.model.material.law;
    double sum = 0.0;
    for (size_t i = 1; law->kind == PALP_LAW_SPLINE && i + 1 < law->n; i++)
        sum += infer_cauchy_evidence(fit->certain[i]);
    return sum;
}

bool infer_has_gains(const explain_data *data) {
    bool again = false;
    for (size_t r = 1; r < data->n_runs; r++)
        again = again || data->run[r].specimen == data->run[r - 1].specimen;
    return again && !data->law_alone;
}

infer_sizes infer_sizes_first(const explain_data *data) {
    const double white = data->run[0].white, guess = fmax(white, 0.01 * data->peak);
    infer_sizes sizes = {
        .own = {white, data->contacts_alike ? 0.0 : 0.01 * data->deepest, infer_has_gains(data) ? 0.01 : 0.0},
        .bend = 0.1};
    for (size_t a = 0; a < INFER_SPECIMEN; a++)
        sizes.specimen[a] = data->n_specimens > 1 ? 0.1 : 0.0;
    for (size_t d = 0; d < INFER_DOMAINS && !data->law_alone; d++)
        for (size_t l = 0; l < INFER_LENGTHS; l++) {
            sizes.common[d][l] = guess;
            sizes.each[d][l] = data->n_runs > 1 ? guess : 0.0;
        }
    return sizes;
}
