/* segments_creep.c: finds creep: constant force while depth goes on. */
#include "segments_internal.h"

#include <math.h>

static const double DRIFT = 0.01;  /* relative to the range of depth: least motion during creep */
static const double BEGINS = 0.02; /* relative to the stretch: samples that may still belong to the ramp */
static const double SLOWER =
    0.5; /* relative to the speed before it: faster motion is a press, whatever the force */

static double range_of_values(size_t n, const double *x) {
    double low = x[0], high = x[0];
    for (size_t i = 1; i < n; i++) {
        low = fmin(low, x[i]);
        high = fmax(high, x[i]);
    }
    return high - low;
}

/* The first sample at least s seconds after sample i. */
static size_t find_sample_after_time(const double *time, size_t i, size_t last, double s) {
    size_t k = i;
    while (k < last && time[k] - time[i] < s)
        k++;
    return k;
}

/* Is the force constant from a ramp on, while depth goes on more slowly than on the ramp? */
static bool is_force_held_in_creep(const palp_piece *ramp, const palp_piece *dwell, const double *time,
                                   const double *depth, double least) {
    double lasts = time[dwell->last] - time[dwell->first], came = time[ramp->last] - time[ramp->first];
    size_t from = find_sample_after_time(time, dwell->first, dwell->last, BEGINS * lasts);
    double drift = depth[dwell->last] - depth[from], way = depth[ramp->last] - depth[ramp->first];
    return ramp->motion == PALP_MOTION_RAMP && dwell->motion == PALP_MOTION_DWELL && depth[from] > 0.0 &&
           drift > least && drift / lasts < SLOWER * way / came;
}

palp_status palp_segments_creep(size_t n, const double *time_s, const double *depth, const double *force_N,
                                palp_pieces *creep) {
    if (!depth || !force_N || !creep)
        return PALP_ERR_ARGUMENT;
    palp_status status = palp_segments_pieces(n, time_s, force_N, creep);
    if (status)
        return status;
    double least = DRIFT * range_of_values(n, depth);
    size_t kept = 0;
    palp_piece before = {PALP_MOTION_REST, 0, 0};
    for (size_t k = 0; k < creep->n; k++) {
        palp_piece piece = creep->piece[k];
        if (is_force_held_in_creep(&before, &piece, time_s, depth, least))
            creep->piece[kept++] = piece;
        before = piece;
    }
    creep->n = kept;
    return PALP_OK;
}
