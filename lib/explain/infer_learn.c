/* infer_learn.c: sizes of the noise by average information restricted maximum likelihood (Gilmour, Thompson
 * and Cullis, Biometrics 51 (1995) 1440). */
#include "infer_internal.h"
#include "base/dense.h"
#include "solve/levenberg.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct learning {
    infer_fit *fit;
    const explain_data *data;
    unsigned n;        /* sizes that are learned */
    infer_noise start; /* coordinates are logarithms of the sizes, relative to those at the start */
    double promised;   /* at the start: so that units do not matter */
    double least;      /* chi2 so far */
    bool best;         /* the last evaluation is the best so far */
} learning;

static double *size_of(infer_noise *noise, int a) {
    return a == INFER_BY_WHITE     ? &noise->white
           : a == INFER_BY_DEPTH   ? &noise->depth
           : a == INFER_BY_CLOCK   ? &noise->clock
           : a == INFER_BY_ENCODER ? &noise->encoder
                                   : &noise->slow[a - INFER_BY_SLOW];
}

/* Cholesky factor of a whole symmetric covariance, in place. Rounding may make one that is nearly singular
 * indefinite: the diagonal then grows by as little as is needed. */
static bool factorize(size_t n, double *a) {
    double diagonal[EXPLAIN_COLUMNS + INFER_BLOCK + INFER_SPECIMEN];
    for (size_t i = 0; i < n; i++)
        diagonal[i] = a[i * n + i];
    for (double more = 0.0; more < 1e-9; more = fmax(1e-15, 10.0 * more)) {
        for (size_t i = 0; i < n; i++) {
            for (size_t j = 0; j < i; j++)
                a[i * n + j] = a[j * n + i];
            a[i * n + i] = diagonal[i] * (1.0 + more);
        }
        if (dense_cholesky(n, a))
            return true;
    }
    return false;
}

/* Combinations by[count m] of a run's columns. Their squares add up to the expected square of the residual;
 * the last one is the residual at the posterior mean. Returns count, or 0 where the covariance is not
 * definite. covariance[m m] is overwritten. */
static size_t combine(const infer_fit *fit, const double *mean, double *covariance, double *by) {
    const size_t m = fit->m, n = m - 1;
    size_t list[EXPLAIN_COLUMNS + INFER_BLOCK + INFER_SPECIMEN + 1];
    const size_t active = infer_active_columns(fit, list) - 1;
    const size_t count = active + 1 > INFER_NOISES ? active + 1 : INFER_NOISES;
    for (size_t a = 0; a < active; a++)
        for (size_t b = 0; b < active; b++)
            covariance[a * active + b] = covariance[list[a] * n + list[b]];
    if (!factorize(active, covariance))
        return 0;
    memset(by, 0, count * m * sizeof *by);
    for (size_t a = 0; a < active; a++) {
        for (size_t b = 0; b <= a; b++)
            by[list[a] * count + b] = covariance[a * active + b];
        by[list[a] * count + count - 1] = mean[list[a]];
    }
    by[n * count + count - 1] = -1.0;
    return count;
}

/* Adds the contribution of run r. room: as infer_noise_slopes makes it. */
static palp_status add_run(const infer_fit *fit, const explain_data *data, const infer_posterior *p, size_t r,
                           const double *raw, const infer_sample *sample, double *room, double *slope,
                           double *information) {
    const size_t m = fit->m, n = data->run[r].n, most = m + INFER_NOISES;
    double *mean = room, *covariance = mean + m, *by = covariance + m * m, *x = by + most * m,
           *variance = x + most * n, *moved = variance + n, *work = moved + INFER_NOISES * n;
    palp_status status = infer_run_moments(fit, data, p, r, mean, covariance);
    const size_t count = status ? 0 : combine(fit, mean, covariance, by);
    if (count == 0)
        return status ? status : PALP_ERR_SINGULAR;
    memset(x, 0, count * n * sizeof *x);
    dense_add_outer(count, n, m, 1.0, by, count, raw, n, x, count);
    infer_variance(fit, n, sample, variance);
    infer_whiten(&fit->noise, n, data->run[r].time, sample, variance, data->run[r].use, count, x, work);
    infer_noise_slope(&fit->noise, n, sample, count, x, work, moved, slope, information);
    return PALP_OK;
}

palp_status infer_noise_slopes(const infer_fit *fit, const explain_data *data, const infer_posterior *p,
                               double slope[INFER_NOISES], double *information) {
    enum { N = INFER_NOISES };
    const size_t m = fit->m, most = m + N, n = data->longest;
    double *room = malloc((m + m * m + most * m + (most + 1 + N + INFER_FILTER) * n + INFER_STATES * most) *
                          sizeof *room);
    memset(slope, 0, N * sizeof *slope);
    memset(information, 0, N * N * sizeof *information);
    palp_status status = room ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t r = 0, at = 0; r < data->n_runs && !status; at += data->run[r++].n)
        if (!data->run[r].held_out)
            status = add_run(fit, data, p, r, fit->raw + at * m, fit->sample + at, room, slope, information);
    free(room);
    return status;
}

static palp_status evaluate(void *user, const double *x, double *h, double *g, double *chi2) {
    learning *l = user;
    l->best = false;
    for (unsigned a = 0; a < l->n; a++)
        *size_of(&l->fit->noise, (int)a) = *size_of(&l->start, (int)a) * exp(x[a]);
    double slope[INFER_NOISES], information[INFER_NOISES * INFER_NOISES];
    infer_posterior p = {.memory = NULL};
    palp_status status = infer_fit_products(l->fit, l->data);
    if (!status)
        status = infer_posterior_find(l->fit, l->data, &p);
    if (!status)
        infer_take_scores(l->fit, &p);
    *chi2 = 2.0 * (l->promised - l->fit->promised);
    const bool worse = !status && *chi2 > l->least; /* no step is made from there */
    if (!status && !worse)
        status = infer_noise_slopes(l->fit, l->data, &p, slope, information);
    infer_posterior_free(&p);
    if (worse)
        return PALP_OK;
    for (size_t a = 0; a < l->n && !status; a++) {
        memcpy(h + a * l->n, information + a * INFER_NOISES, l->n * sizeof *h);
        h[a * (l->n + 1)] += 1e-12 * information[0]; /* a size of nothing has no information */
        g[a] = slope[a];
    }
    l->least = status ? l->least : *chi2;
    return !status || status == PALP_ERR_NO_MEMORY ? status : PALP_ERR_NOT_CONVERGED;
}

static void keep(void *user) {
    ((learning *)user)->best = true;
}

/* Bounds: no noise is larger than the largest force, and none smaller than the error of the mean of all
 * samples can be seen. White noise of means is at least that of their samples. Of a law alone, an
 * encoder's is no larger than its rounding's; beside a discrepancy it may be, as one session (Mach-1
 * static_00) else has several maxima. */
static void bound(learning *l, bool anew, double *x, double *low, double *high) {
    const explain_data *data = l->data;
    const double hidden = data->run[0].white / sqrt((double)explain_samples(data));
    for (int a = 0; a < (int)l->n; a++) {
        double *now = size_of(&l->start, a);
        const bool depth = a == INFER_BY_DEPTH || a == INFER_BY_ENCODER;
        const double unit = depth                 ? data->deepest / data->peak
                            : a == INFER_BY_CLOCK ? data->deepest / data->fastest / data->peak
                                                  : 1.0;
        const double most = a == INFER_BY_ENCODER && data->law_alone ? l->fit->rounding : data->peak * unit,
                     least =
                         fmin(most, (a == INFER_BY_WHITE ? fmax(0.01 * data->run[0].white, data->sample_noise)
                                                         : hidden) *
                                        unit);
        *now = fmin(most, fmax(least, *now));
        low[a] = log(least / *now);
        high[a] = log(most / *now);
        x[a] = anew && a != INFER_BY_WHITE ? fmin(high[a], fmax(0.0, log(3.0 * least / *now))) : 0.0;
    }
}

palp_status infer_noise_learn(infer_fit *fit, const explain_data *data, size_t evaluations, bool anew) {
    enum { N = INFER_NOISES };
    double x[N], low[N], high[N], reach[N], h[N * N], g[N], chi2;
    palp_status status = infer_tails_learn(fit, data);
    learning l = {.fit = fit,
                  .data = data,
                  .n = data->reduced              ? INFER_BY_WHITE + 1
                       : fit->noise.encoder > 0.0 ? N
                                                  : INFER_BY_ENCODER,
                  .start = fit->noise,
                  .promised = fit->promised,
                  .least = HUGE_VAL};
    bound(&l, anew, x, low, high);
    for (int a = 0; a < N; a++)
        reach[a] = 1.5;
    const levenberg problem = {.n = l.n,
                               .evaluations = evaluations,
                               .low = low,
                               .high = high,
                               .reach = reach,
                               .stop_absolute = 2e-3,
                               .stop_rise = 1e-3,
                               .stop_expected = 2e-3,
                               .evaluate = evaluate,
                               .keep = keep,
                               .user = &l};
    if (!status)
        status = evaluate(&l, x, h, g, &chi2);
    if (!status) {
        l.best = true;
        status = levenberg_solve(&problem, x, h, g, &chi2);
    }
    if (!status && !l.best)
        status = evaluate(&l, x, h, g, &chi2);
    if (status == PALP_ERR_NOT_CONVERGED) { /* without slopes the noise stays as it was */
        fit->noise = l.start;
        status = infer_fit_products(fit, data);
        if (!status)
            status = infer_fit_score(fit, data);
    }
    return status ? status : infer_tails_learn(fit, data);
}
