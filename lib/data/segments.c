/* segments.c: the plate's path: straight pieces, the first ramp, rest. */
#include "segments_internal.h"

#include <math.h>

/* Shares of the travel at which the first motion has begun, has ended, and at which the depth is left
 * finally. */
static const double BEGUN = 2e-3, ARRIVED = 0.998, LEFT = 0.95;

segments_cone segments_cone_open(void) {
    return (segments_cone){.low = -HUGE_VAL, .high = HUGE_VAL};
}

bool segments_cone_take(segments_cone *cone, double time, double way, double tolerance) {
    cone->low = fmax(cone->low, (way - tolerance) / time);
    cone->high = fmin(cone->high, (way + tolerance) / time);
    return cone->low <= cone->high;
}

void segments_bends(size_t n, const double *depth, double *bend) {
    for (size_t i = 1; i + 1 < n; i++)
        bend[i - 1] = fabs(depth[i - 1] - 2.0 * depth[i] + depth[i + 1]);
}

void segments_ramp(size_t n, const double *depth, double deepest, size_t *start, size_t *end) {
    double from = fmax(depth[0], 0.0);
    size_t i = 0;
    while (i + 1 < n && depth[i] < from + BEGUN * (deepest - from))
        i++;
    *start = i;
    while (i + 1 < n && depth[i] < ARRIVED * deepest)
        i++;
    *end = i;
}

size_t segments_press_end(size_t n, const double *depth, double deepest, size_t ramp_end) {
    size_t last = 0;
    for (size_t i = 0; i < n; i++) {
        if (i > ramp_end && depth[i] < LEFT * deepest)
            return last;
        if (depth[i] >= ARRIVED * deepest)
            last = i;
    }
    return n;
}

bool segments_sample_valid(const double *time, const double *depth, const double *force, size_t i) {
    static const double most = 1e12;
    return fabs(time[i]) <= most && fabs(depth[i]) <= most && fabs(force[i]) <= most &&
           (i == 0 || time[i] > time[i - 1]);
}
