/* explain_wander.c: what a fit gains if the zeros of the runs may wander. */
#include "explain_search.h"
#include "explain_noise.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A zero that jumps, warms up, wanders or follows the room goes on from where it was: each run's is a random
 * walk, of one pace in all runs, the likeliest. The slowest that is tried goes, within the longest run,
 * SLOWEST times as far as the mean of its samples scatters, and each other one FASTER times as far as the one
 * before it. */
enum { PACES = 12 };
static const double SLOWEST = 2.0, FASTER = 2.0;

typedef struct walks {
    const explain_data *data;
    size_t m;
    double rate[PACES]; /* by which a walk's variance grows, in units of the noise's, 1/s */
    double *product;    /* [PACES n_runs m m] of the fit's columns beside it */
    double logdet[PACES];
    palp_status status;
} walks;

/* The run with the filter (a scalar Kalman filter) of white noise of sd 1 and a random walk that begins at 0,
 * for what is whitened already. filter: [3 n]. The log determinant of the covariance. */
static double make_walk(const explain_run *run, double rate, double *filter, explain_run *walk) {
    double variance = 0.0, logdet = 0.0;
    *walk = *run;
    walk->keep = filter;
    walk->take = filter + run->n;
    walk->weight = filter + 2 * run->n;
    for (size_t i = 0; i < run->n; i++) {
        variance += i > 0 ? rate * (run->time[i] - run->time[i - 1]) : 0.0;
        const double s = variance + 1.0;
        walk->keep[i] = 1.0;
        walk->take[i] = run->use[i] ? variance / s : 0.0;
        walk->weight[i] = run->use[i] ? 1.0 / sqrt(s) : 0.0;
        if (!run->use[i])
            continue;
        variance /= s;
        logdet += log(s);
    }
    return logdet;
}

static void sum_run(void *user, size_t r, const double *column) {
    walks *w = user;
    const explain_run *run = &w->data->run[r];
    const size_t m = w->m, n = run->n;
    if (run->held_out)
        return;
    double *x = malloc((m + 3) * n * sizeof *x);
    if (!x)
        w->status = PALP_ERR_NO_MEMORY;
    for (size_t k = 0; k < PACES && x; k++) {
        explain_run walk;
        memcpy(x, column, m * n * sizeof *x);
        w->logdet[k] += make_walk(run, w->rate[k], x + m * n, &walk);
        explain_whiten(&walk, m, x);
        dense_transposed_product(m, m, n, x, x, w->product + (k * w->data->n_runs + r) * m * m);
    }
    free(x);
}

/* Of the best parameters, as the products predict them, the scatter of what each run has of its own being
 * what they say. */
static palp_status find_score(explain_fit *fit, const explain_data *data,
                              const palp_explain_settings *settings, double *score) {
    double chi2, samples = (double)explain_samples(data);
    explain_fit_scatter(fit, data, settings);
    palp_status status = explain_fit_predict(fit, data, &chi2);
    *score = fit->score + 0.5 * (samples * explain_chi2(data, fit) - chi2);
    return status;
}

/* The largest of so many numbers at even distances, or that of the parabola through it and those beside it.
 */
static double peak_of(size_t n, const double *y) {
    size_t best = 0;
    for (size_t k = 1; k < n; k++)
        best = y[k] > y[best] ? k : best;
    if (best == 0 || best + 1 == n)
        return y[best];
    const double slope = 0.5 * (y[best + 1] - y[best - 1]), bend = 2.0 * y[best] - y[best - 1] - y[best + 1];
    return y[best] + (bend > 0.0 ? 0.5 * slope * slope / bend : 0.0);
}

palp_status explain_wander_find(const explain_fit *fit, const explain_data *data,
                                const palp_explain_settings *settings, double *gain) {
    const size_t m = fit->m, room = data->n_runs * m * m;
    const double samples = (double)data->longest, least = SLOWEST * SLOWEST / (samples * data->duration);
    explain_fit beside = {.n_columns = 0};
    walks w = {.data = data, .m = m, .product = calloc(PACES * room, sizeof *w.product)};
    double still = 0.0, score[PACES];
    palp_status status = w.product ? explain_fit_copy(fit, data->n_runs, &beside) : PALP_ERR_NO_MEMORY;
    for (size_t k = 0; k < PACES; k++)
        w.rate[k] = least * pow(FASTER, 2.0 * (double)k);
    if (!status)
        status = explain_fit_visit(&beside, data, NULL, NULL, sum_run, &w);
    if (!status)
        status = w.status ? w.status : find_score(&beside, data, settings, &still);
    for (size_t k = 0; k < PACES && !status; k++) {
        beside.scatter = fit->scatter;
        memcpy(beside.product, w.product + k * room, room * sizeof *beside.product);
        status = find_score(&beside, data, settings, &score[k]);
        score[k] -= 0.5 * w.logdet[k];
    }
    *gain = status ? 0.0 : fmax(0.0, peak_of(PACES, score) - still - 0.5 * log((double)data->n));
    explain_fit_free(&beside);
    free(w.product);
    return status;
}
