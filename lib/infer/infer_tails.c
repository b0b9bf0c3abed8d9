/* infer_tails.c: noise of heavy tails: Student's t as a mixture of normal distributions over their precision. */
#include "infer_internal.h"

#include <math.h>
#include <stdlib.h>

/* Degrees of freedom: from Cauchy's distribution to what no session tells from the normal one. */
static const double LEAST = 1.0, MOST = 1000.0;

/* A precision w has a gamma distribution of shape and rate freedom / 2; q of it, of shape (freedom + 1) / 2,
 * is the nearest to its posterior. The bound of the evidence has the expected log of the prior over q, less
 * what the determinant with the expected precision has too much: 0 for a normal distribution. */
double infer_tail_evidence(double freedom, double certain) {
    const double half = 0.5 * freedom, more = half + 0.5;
    return lgamma(more) - lgamma(half) - half * log(more / half) + more - 0.5 * log(more) +
           half * (log(certain) - certain);
}

/* Log density of samples with these squares in units of their variance. */
static double log_density(double freedom, size_t n, const double *square) {
    double sum = (double)n * (lgamma(0.5 * freedom + 0.5) - lgamma(0.5 * freedom) - 0.5 * log(freedom));
    for (size_t i = 0; i < n; i++)
        sum -= (0.5 * freedom + 0.5) * log1p(square[i] / freedom);
    return sum;
}

/* The most likely one, by golden sections of its logarithm. */
static double find_freedom(size_t n, const double *square) {
    enum { ROUNDS = 20 };
    static const double GOLDEN = 0.6180339887498949;
    double low = log(LEAST), high = log(MOST), a = high - GOLDEN * (high - low),
           b = low + GOLDEN * (high - low);
    double at_a = log_density(exp(a), n, square), at_b = log_density(exp(b), n, square);
    for (int i = 0; i < ROUNDS; i++) {
        if (at_a > at_b) {
            high = b, b = a, at_b = at_a;
            a = high - GOLDEN * (high - low);
            at_a = log_density(exp(a), n, square);
        } else {
            low = a, a = b, at_a = at_b;
            b = low + GOLDEN * (high - low);
            at_b = log_density(exp(b), n, square);
        }
    }
    return exp(0.5 * (low + high));
}

/* Expected squares of what is independent in run r, over its variance: square[n]; -1 without use. left[n] is
 * overwritten. work: [(INFER_FILTER + 2) n + INFER_STATES]. */
static void find_squares(const infer_fit *fit, const explain_run *run, const infer_sample *sample, double *left,
                         double *square, double *work) {
    double *variance = work + INFER_FILTER * run->n + INFER_STATES, *inverse = variance + run->n;
    infer_variance(fit, run->n, sample, variance);
    infer_whiten(&fit->noise, run->n, run->time, sample, variance, run->use, 1, left, work);
    infer_unwhiten(run->n, work, left, inverse);
    for (size_t i = 0; i < run->n; i++) {
        const double v = variance[i], mean = v * left[i];
        square[i] = run->use[i] ? (mean * mean + v - v * v * inverse[i]) / (v * sample[i].certain) : -1.0;
    }
}

/* One round at what is left of all samples. work: [3 data->n + (INFER_FILTER + 2) longest + STATES]. */
static void learn_once(infer_fit *fit, const explain_data *data, const double *left, double *work) {
    double *copy = work, *square = work + data->n, *fitted = square + data->n, *more = fitted + data->n;
    size_t n = 0;
    for (size_t r = 0, at = 0; r < data->n_runs; at += data->run[r++].n) {
        for (size_t i = at; i < at + data->run[r].n; i++)
            copy[i] = left[i];
        find_squares(fit, &data->run[r], fit->sample + at, copy + at, square + at, more);
        for (size_t i = at; i < at + data->run[r].n && !data->run[r].held_out; i++)
            if (square[i] >= 0.0)
                fitted[n++] = square[i];
    }
    const double f = fit->noise.freedom = find_freedom(n, fitted);
    for (size_t i = 0; i < data->n; i++)
        fit->sample[i].certain = square[i] >= 0.0 ? (f + 1.0) / (f + square[i]) : 1.0;
}

/* What the best step, the runs' own and the discrepancy leave. */
palp_status infer_tails_learn(infer_fit *fit, const explain_data *data) {
    enum { ROUNDS = 4 };
    double *left = malloc((5 * data->n + (INFER_FILTER + 2) * data->longest + INFER_STATES) * sizeof *left);
    if (!left)
        return PALP_ERR_NO_MEMORY;
    double *taken = left + data->n;
    palp_status status = infer_residual(fit, data, left, taken);
    for (size_t i = 0; i < data->n && !status; i++)
        left[i] -= taken[i];
    for (int i = 0; i < ROUNDS && !status; i++)
        learn_once(fit, data, left, taken + data->n);
    free(left);
    if (!status)
        status = infer_fit_products(fit, data);
    return status ? status : infer_fit_score(fit, data);
}
