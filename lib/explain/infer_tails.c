/* infer_tails.c: noise of heavy tails: Student's t as a mixture of normal distributions over their precision.
 */
#include "infer_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Degrees of freedom: from Cauchy's distribution to one that no session distinguishes from the normal one. */
static const double LEAST = 1.0, MOST = 1000.0;

/* Log density of samples with these squares in units of their variance. The logarithm is that of products, as
 * long as these do not overflow. */
static double log_density(double freedom, size_t n, const double *square) {
    const double most = 1e150, each = 1.0 / freedom;
    double sum = 0.0, product = 1.0;
    for (size_t i = 0; i < n; i++) {
        const double add = square[i] * each;
        product *= 1.0 + (add < most ? add : most);
        if (product > most) {
            sum += log(product);
            product = 1.0;
        }
    }
    sum += log(product);
    return (double)n * (lgamma(0.5 * freedom + 0.5) - lgamma(0.5 * freedom) - 0.5 * log(freedom)) -
           (0.5 * freedom + 0.5) * sum;
}

/* The most likely one, by golden sections of its logarithm; the upper end if the density increases there. */
static double find_freedom(size_t n, const double *square) {
    enum { ROUNDS = 20 };
    static const double GOLDEN = 0.6180339887498949;
    double low = log(LEAST), high = log(MOST), a = high - GOLDEN * (high - low),
           b = low + GOLDEN * (high - low);
    if (log_density(MOST, n, square) > log_density(0.9 * MOST, n, square))
        return MOST;
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

/* Expected squares over their variances in run r: of the independent noise, square[n], -1 without use; and of
 * the correlated noise's innovations, slow[n INFER_SLOW], -1 for the first sample. left[n] is overwritten.
 * work:
 * [(INFER_FILTER + 2) n + INFER_STATES]. */
static void find_squares(const infer_fit *fit, const explain_run *run, const infer_sample *sample,
                         double *left, double *square, double *slow, double *work) {
    double *variance = work + INFER_FILTER * run->n + INFER_STATES, *inverse = variance + run->n;
    infer_variance(fit, run->n, sample, variance);
    infer_whiten(&fit->noise, run->n, run->time, sample, variance, run->use, 1, left, work);
    infer_unwhiten(&fit->noise, run->n, sample, work, left, inverse, slow);
    for (size_t a = 0; a < INFER_SLOW; a++) /* no step leads to the first sample */
        slow[a] = -1.0;
    for (size_t i = 0; i < run->n; i++) {
        const double v = variance[i], mean = v * left[i];
        square[i] = run->use[i] ? (mean * mean + v - v * v * inverse[i]) / (v * sample[i].certain) : -1.0;
    }
}

/* Expected precisions of all samples from their squares (negative: they do not count), and the degrees of
 * freedom of those that are fitted. Squares are stride apart. fitted: [data->n] */
static double find_certain(const explain_data *data, const double *square, size_t stride, double *fitted,
                           double *certain) {
    enum { STRIDE = sizeof(infer_sample) / sizeof(double) };
    size_t n = 0;
    for (size_t r = 0, at = 0; r < data->n_runs; at += data->run[r++].n)
        for (size_t i = at; i < at + data->run[r].n && !data->run[r].held_out; i++)
            if (square[i * stride] >= 0.0)
                fitted[n++] = square[i * stride];
    const double f = find_freedom(n, fitted);
    for (size_t i = 0; i < data->n; i++)
        certain[i * STRIDE] = square[i * stride] >= 0.0 ? (f + 1.0) / (f + square[i * stride]) : 1.0;
    return f;
}

/* One round on the residual of all samples. work: [(3 + INFER_SLOW) data->n + (INFER_FILTER + 2) longest +
 * STATES]. */
static void learn_once(infer_fit *fit, const explain_data *data, const double *left, double *work) {
    infer_noise *noise = &fit->noise;
    double *copy = work, *square = work + data->n, *slow = square + data->n,
           *fitted = slow + INFER_SLOW * data->n, *more = fitted + data->n;
    memcpy(copy, left, data->n * sizeof *copy);
    for (size_t r = 0, at = 0; r < data->n_runs; at += data->run[r++].n)
        find_squares(fit, &data->run[r], fit->sample + at, copy + at, square + at, slow + INFER_SLOW * at,
                     more);
    noise->freedom = find_certain(data, square, 1, fitted, &fit->sample->certain);
    for (size_t a = 0; a < INFER_SLOW && noise->slow_freedom[a] > 0.0; a++)
        noise->slow_freedom[a] = find_certain(data, slow + a, INFER_SLOW, fitted, &fit->sample->steady[a]);
}

/* The residual of run r at the most probable step of the parameters, with all else at its posterior mean. */
static palp_status left_of_run(const infer_fit *fit, const explain_data *data, const infer_posterior *p,
                               size_t r, const double *column, double *left) {
    const size_t n = data->run[r].n, k = fit->k;
    double most[EXPLAIN_COLUMNS + INFER_BLOCK + INFER_SPECIMEN], *own = most + k;
    palp_status status = infer_own(fit, data, p, r, own, NULL);
    if (!status)
        status = infer_specimen_own(p, r, own + INFER_BLOCK, NULL);
    if (status)
        return status;
    for (size_t a = 0; a < k; a++)
        most[a] = p->mean[p->hats + a] - infer_undone(p, 0, INFER_HATS, a);
    for (size_t a = 0; a < INFER_HATS; a++)
        own[INFER_OWN + a] += infer_common(p, a);
    memcpy(left, column + (fit->m - 1) * n, n * sizeof *left);
    for (size_t a = 0; a + 1 < fit->m; a++)
        for (size_t i = 0; i < n && most[a] != 0.0; i++)
            left[i] -= most[a] * column[a * n + i];
    return PALP_OK;
}

static palp_status find_left(const infer_fit *fit, const explain_data *data, double *left) {
    infer_posterior p;
    palp_status status = infer_posterior_find(fit, data, &p);
    for (size_t r = 0, at = 0; r < data->n_runs && !status; at += data->run[r++].n)
        status = left_of_run(fit, data, &p, r, fit->raw + at * fit->m, left + at);
    infer_posterior_free(&p);
    return status;
}

/* The expected squares neglect the uncertainty of the parameters. Where this lowers the bound, nothing
 * changes. */
palp_status infer_tails_learn(infer_fit *fit, const explain_data *data) {
    enum { ROUNDS = 4 };
    const size_t n = data->n;
    if (data->reduced)
        return PALP_OK;
    double *left =
        malloc(((4 + INFER_SLOW) * n + (INFER_FILTER + 2) * data->longest + INFER_STATES) * sizeof *left);
    infer_sample *was = malloc(n * sizeof *was);
    const infer_noise noise = fit->noise;
    const double promised = fit->promised;
    palp_status status = left && was ? find_left(fit, data, left) : PALP_ERR_NO_MEMORY;
    if (!status)
        memcpy(was, fit->sample, n * sizeof *was);
    for (int i = 0; i < ROUNDS && !status; i++)
        learn_once(fit, data, left, left + n);
    for (int i = 0; i < 2 && !status; i++) {
        status = infer_fit_products(fit, data);
        if (!status)
            status = infer_fit_score(fit, data);
        if (status || fit->promised >= promised)
            break;
        memcpy(fit->sample, was, n * sizeof *was);
        fit->noise = noise;
    }
    free(left);
    free(was);
    return status;
}

/* Fisher's information of a mean is (f + 1) / (f + 3) of that of the expected precisions (Lange, Little and
 * Taylor, J. Am. Stat. Assoc. 84 (1989) 881). */
double infer_tail_widening(const infer_fit *fit) {
    return sqrt((fit->noise.freedom + 3.0) / (fit->noise.freedom + 1.0));
}

double infer_white_level(const infer_fit *fit, const explain_data *data) {
    const double f = fit->noise.freedom;
    double sum = 0.0, n = 0.0;
    for (size_t r = 0, at = 0; r < data->n_runs; at += data->run[r++].n)
        for (size_t i = 0; i < data->run[r].n && !data->run[r].held_out; i++)
            if (data->run[r].use[i]) {
                const infer_sample *sample = &fit->sample[at + i];
                double variance;
                infer_variance(fit, 1, sample, &variance);
                sum += variance * (f + 1.0 - f * sample->certain); /* its expected square */
                n += 1.0;
            }
    return sqrt(fmax(0.0, sum) / fmax(1.0, n));
}

void infer_use_spikes(explain_data *data) {
    for (size_t e = 0; e < data->n_events; e++) {
        const palp_explain_event *event = &data->event[e];
        explain_run *run = &data->run[event->run];
        if (strcmp(event->kind, "spike") != 0)
            continue;
        for (size_t i = 1; i + 1 < run->n; i++)
            if (run->start + run->time[i] == event->from_s && (run->use[i - 1] || run->use[i + 1]))
                run->use[i] = 1; /* but beside a release */
    }
}
