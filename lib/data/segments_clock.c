/* segments_clock.c: the step of a recording's clock, and how many of its samples are missing. */
#include "base/statistics.h"
#include "segments_internal.h"

#include <math.h>
#include <stdlib.h>

/* Limits: share of differences that are small enough to be one step; deviation from a multiple, in steps;
 * share of differences that must be multiples. */
static const double SMALL = 0.1, OFF = 0.1, REGULAR = 0.9;

/* Total number of steps in the differences; 0 if too few are multiples. */
static double count_whole_steps(size_t n, const double *difference, double step) {
    double sum = 0.0, regular = 0.0;
    for (size_t i = 0; i < n; i++) {
        double steps = rint(difference[i] / step);
        regular += steps >= 1.0 && fabs(difference[i] - steps * step) <= OFF * step;
        sum += fmax(steps, 1.0);
    }
    return regular >= REGULAR * (double)n ? sum : 0.0;
}

/* Mean of the differences of about one step. */
static double mean_of_single_steps(size_t n, const double *difference, double about) {
    double sum = 0.0, count = 0.0;
    for (size_t i = 0; i < n; i++)
        if (fabs(difference[i] - about) <= 0.25 * about) {
            sum += difference[i];
            count += 1.0;
        }
    return sum / count;
}

palp_status palp_segments_clock(size_t n, const double *time_s, double *step_s, size_t *missing) {
    if (!time_s || !step_s || !missing || n < 2)
        return PALP_ERR_ARGUMENT;
    double *difference = malloc(2 * n * sizeof *difference);
    if (!difference)
        return PALP_ERR_NO_MEMORY;
    double *sorted = difference + n;
    for (size_t i = 0; i + 1 < n; i++)
        sorted[i] = difference[i] = time_s[i + 1] - time_s[i];
    double middle = statistics_median(sorted, n - 1), small = statistics_quantile(sorted, n - 1, SMALL);
    small = mean_of_single_steps(n - 1, difference, small);
    double steps = count_whole_steps(n - 1, difference, small);
    *step_s = steps > 0.0 ? small : middle;
    steps -= (double)(n - 1);
    *missing =
        steps > 0.0 ? (size_t)fmin(steps, 1e9) : 0; /* a jump of the clock may be any number of steps */
    free(difference);
    return PALP_OK;
}
