/* infer_steps.c: the steps of encoder and converter, found in the files, and their rounding errors. */
#include "infer_internal.h"

#include <math.h>

/* Finer steps than this share of the range do not matter; numbers in a file are as exact. */
static const double FINEST = 1e-5, EXACT = 1e-7;

/* The largest common divisor of both, to so much; 0: below finest there is none. */
static double common_divisor(double a, double b, double exact, double finest) {
    while (b > exact) {
        double rest = fmod(a, b);
        if (b - rest < exact)
            rest = 0.0;
        a = b;
        b = rest;
        if (a < finest)
            return NAN;
    }
    return a;
}

double infer_common_step(size_t n, const double *value, double step) {
    double low = value[0], high = value[0];
    for (size_t i = 1; i < n; i++) {
        low = fmin(low, value[i]);
        high = fmax(high, value[i]);
    }
    const double range = high - low;
    for (size_t i = 1; i < n && !isnan(step); i++)
        step = common_divisor(fabs(value[i] - value[i - 1]), step, EXACT * range, FINEST * range);
    return step;
}

/* Correlation of the errors of two successive samples, for a path of so many steps a sample. Both are
 * remainders with a constant difference (Bennett, Bell Syst. Tech. J. 27 (1948) 446). */
static double correlation(double steps) {
    const double share = steps - floor(steps);
    return 1.0 - 6.0 * share * (1.0 - share);
}

static void find_correlations(const explain_run *run, double step, infer_sample *sample) {
    enum { BEFORE = 4, AFTER = 3 };
    sample[0].keep = 0.0;
    for (size_t i = 1; i < run->n; i++) {
        const size_t from = i > BEFORE ? i - BEFORE : 0, to = i + AFTER < run->n ? i + AFTER : run->n - 1;
        const double way = fabs(run->depth[to] - run->depth[from]) / (double)(to - from);
        sample[i].keep = correlation(way / step);
    }
}

void infer_steps_find(infer_fit *fit, const explain_data *data) {
    double depth = 0.0, force = 0.0;
    for (size_t r = 0; r < data->n_runs; r++) {
        const explain_run *run = &data->run[r];
        depth = run->samples ? NAN : infer_common_step(run->n, run->depth, depth); /* means have none */
        force = run->samples ? NAN : infer_common_step(run->n, run->force, force);
    }
    fit->converter = force > 0.0 ? force : 0.0; /* NAN: there is none */
    fit->rounding = fit->noise.encoder = depth > 0.0 ? depth / sqrt(12.0) : 0.0;
    for (size_t r = 0, at = 0; r < data->n_runs; at += data->run[r++].n)
        if (depth > 0.0)
            find_correlations(&data->run[r], depth, fit->sample + at);
}
