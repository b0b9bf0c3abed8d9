/* segments_noise.c: white noise of a sample, and spikes. */
#include "base/statistics.h"
#include "segments_internal.h"

#include <math.h>
#include <stdlib.h>

/* For Gaussian noise: sd over median absolute value, variance without the outer 5 %; and sds beyond which
 * there is none. */
static const double SD_OF_MEDIAN = 1.4826, KEPT_VARIANCE = 0.76, BEYOND = 4.5;

/* Root mean square of the values up to a limit. */
static double rms_up_to_limit(const double *x, size_t n, double limit) {
    double sum = 0.0, kept = 0.0;
    for (size_t i = 0; i < n; i++)
        if (x[i] <= limit) {
            sum += x[i] * x[i];
            kept += 1.0;
        }
    return sqrt(sum / kept);
}

/* Median of the values possible for a Gaussian of this median. Bursts in a tenth of the samples hardly move
 * it. */
static double trimmed_median(double *bend, size_t n, double middle) {
    enum { ROUNDS = 4 };
    for (int round = 0; round < ROUNDS && middle > 0.0; round++) {
        size_t kept = 0;
        for (size_t i = 0; i < n; i++)
            if (bend[i] <= BEYOND * SD_OF_MEDIAN * middle) {
                double other = bend[kept];
                bend[kept++] = bend[i];
                bend[i] = other;
            }
        if (kept == n)
            break;
        n = kept;
        middle = statistics_quantile(bend, n, 0.5);
    }
    return middle;
}

/* Corners and spikes do not affect a median. The few levels of a coarse converter give quantiles unlike a
 * Gaussian's (0.32, 0.67, 1.64 sd). In that case the mean square of all but the largest is taken. */
static double noise_by_median(double *bend, size_t n) {
    double middle = statistics_quantile(bend, n, 0.5), quarter = statistics_quantile(bend, n, 0.25);
    double most = statistics_quantile(bend, n, 0.85);
    bool coarse = quarter >= 0.9 * middle || most > 5.0 * middle;
    return coarse ? rms_up_to_limit(bend, n, statistics_quantile(bend, n, 0.99))
                  : SD_OF_MEDIAN * trimmed_median(bend, n, middle);
}

static double noise_by_most_samples(double *bend, size_t n) {
    size_t used = n - n / 20;
    double limit = statistics_kth(bend, n, used - 1);
    return rms_up_to_limit(bend, used, limit) / sqrt(KEPT_VARIANCE);
}

/* Distance of a sample from the line through its neighbours, scaled like the second difference of an even
 * path. */
static double second_difference_at(const double *time, const double *force, size_t i) {
    double even = fabs(force[i - 1] - 2.0 * force[i] + force[i + 1]);
    if (!time)
        return even;
    double a = (time[i + 1] - time[i]) / (time[i + 1] - time[i - 1]), b = 1.0 - a;
    if (fabs(a - b) < 0.02)
        return even;
    return fabs(a * force[i - 1] - force[i] + b * force[i + 1]) * sqrt(6.0 / (1.0 + a * a + b * b));
}

palp_status palp_segments_noise(size_t n, const double *time_s, double step_s, const double *force_N,
                                palp_noise_rule rule, double *sd) {
    if (!force_N || !sd)
        return PALP_ERR_ARGUMENT;
    double *bend = malloc((n + 1) * sizeof *bend);
    size_t m = 0;
    *sd = 0.0;
    if (!bend)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 1; i + 1 < n; i++)
        if (!time_s || time_s[i + 1] - time_s[i - 1] < 3.0 * step_s)
            bend[m++] = second_difference_at(time_s, force_N, i);
    if (m > 0) /* a second difference has sqrt(6) times the sd of a sample */
        *sd = (rule == PALP_NOISE_MEDIAN ? noise_by_median(bend, m) : noise_by_most_samples(bend, m)) /
              sqrt(6.0);
    free(bend);
    return PALP_OK;
}

size_t segments_mask_spikes(size_t n, const double *f, double noise, double sigma, unsigned char *use) {
    size_t count = 0;
    for (size_t i = 2; i + 2 < n && noise > 0.0; i++) {
        double up = f[i] - f[i - 1], down = f[i] - f[i + 1];
        double around = fmax(fabs(f[i - 1] - f[i - 2]), fabs(f[i + 2] - f[i + 1]));
        if (up * down > 0.0 && fmin(fabs(up), fabs(down)) > sigma * noise + 3.0 * around) {
            use[i] = 0;
            count++;
        }
    }
    return count;
}
