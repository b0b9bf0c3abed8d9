/* segments_smooth.c: the path of a plate whose recorded depth is noisy, as a tracker's or an LVDT's is. A
 * model that follows the noise sees it in its forces; the remaining noise looks like inertia or a lag. */
#include "base/dense.h"
#include "base/statistics.h"
#include "segments_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of the linear prediction: a motion of a few decaying sinusoids, each of order 2, is foreseen. With 6 or 10
 * the noise is the same within two standard errors, which a test holds. */
enum { ORDER = 8, LEAST = 10 * (ORDER + 3) };
static const double SD_OF_MEDIAN = 1.4826; /* a Gaussian's */

/* Weights with which a sample's bend is best predicted from the bends of the order samples before it. */
static bool predict_bends(size_t order, size_t n, const double *bend, double *weight) {
    double a[SEGMENTS_ORDER_MAX * SEGMENTS_ORDER_MAX] = {0}, sum = 0.0;
    memset(weight, 0, order * sizeof *weight);
    for (size_t i = order; i < n; i++)
        for (size_t k = 0; k < order; k++) {
            weight[k] += bend[i] * bend[i - 1 - k];
            for (size_t l = 0; l <= k; l++)
                a[k * order + l] += bend[i - 1 - k] * bend[i - 1 - l];
        }
    for (size_t k = 0; k < order; k++)
        sum += a[k * order + k];
    for (size_t k = 0; k < order; k++)
        a[k * order + k] += 1e-12 * sum;
    if (!dense_cholesky(order, a))
        return false;
    dense_cholesky_solve(order, a, 1, weight);
    return true;
}

/* The sd of white noise in the depth: what no linear prediction from the samples before foresees. Straight
 * stretches, sinusoids and swings that die away are foreseen; corners are few, and do not count in a median.
 * bend[n - 2] is overwritten. */
static double noise_of(size_t order, size_t n, double *bend) {
    const size_t m = n - 2;
    double weight[SEGMENTS_ORDER_MAX], taps[SEGMENTS_ORDER_MAX + 3] = {0}, square = 0.0;
    if (!predict_bends(order, m, bend, weight))
        return 0.0;
    for (size_t k = 0; k <= order; k++) { /* what becomes of the noise of single samples */
        double w = k == 0 ? 1.0 : -weight[k - 1];
        taps[k] += w;
        taps[k + 1] -= 2.0 * w;
        taps[k + 2] += w;
    }
    for (size_t k = 0; k < order + 3; k++)
        square += taps[k] * taps[k];
    for (size_t i = m; i-- > order;)
        for (size_t k = 0; k < order; k++)
            bend[i] -= weight[k] * bend[i - 1 - k];
    for (size_t i = order; i < m; i++)
        bend[i] = fabs(bend[i]);
    return SD_OF_MEDIAN * statistics_quantile(bend + order, m - order, 0.5) / sqrt(square);
}

/* The smallest way from one sample to the next: no smaller than the step of an encoder. */
static double least_step(size_t n, const double *depth) {
    double least = HUGE_VAL;
    for (size_t i = 1; i < n; i++)
        if (depth[i] != depth[i - 1])
            least = fmin(least, fabs(depth[i] - depth[i - 1]));
    return least;
}

/* Depth and speed, and their covariance as xx, xv, vv. */
typedef struct state {
    double x, v, xx, xv, vv;
} state;

/* After time t, in which the acceleration is white noise of intensity q. */
static state ahead(const state *s, double t, double q) {
    return (state){s->x + t * s->v, s->v, s->xx + t * (2.0 * s->xv + t * s->vv) + q * t * t * t / 3.0,
                   s->xv + t * s->vv + 0.5 * q * t * t, s->vv + q * t};
}

/* A Kalman filter from the first sample on: its states (NULL: not wanted). The log likelihood, less
 * constants. */
static double filter(size_t n, const double *time, const double *depth, double noise, double q, state *kept) {
    const double length = time[n - 1] - time[0];
    state s = {depth[0], 0.0, noise * noise, 0.0, q * length};
    double score = 0.0;
    if (kept)
        kept[0] = s;
    for (size_t i = 1; i < n; i++) {
        s = ahead(&s, time[i] - time[i - 1], q);
        double variance = s.xx + noise * noise, off = depth[i] - s.x, gx = s.xx / variance,
               gv = s.xv / variance;
        score -= 0.5 * (off * off / variance + log(variance));
        s = (state){s.x + gx * off, s.v + gv * off, s.xx - gx * s.xx, s.xv - gx * s.xv, s.vv - gv * s.xv};
        if (kept)
            kept[i] = s;
    }
    return score;
}

/* The most likely intensity of the acceleration, by golden sections of its logarithm. */
static double best_intensity(size_t n, const double *time, const double *depth, double noise, double *score) {
    enum { ROUNDS = 24 };
    static const double GOLDEN = 0.6180339887498949;
    const double step = (time[n - 1] - time[0]) / (double)(n - 1);
    double far = 0.0;
    for (size_t i = 2; i < n; i++)
        far = fmax(far, fabs(depth[i] - 2.0 * depth[i - 1] + depth[i - 2]));
    double high = log(far * far / (step * step * step)), low = high - 40.0; /* far: in a single step */
    double a = high - GOLDEN * (high - low), b = low + GOLDEN * (high - low);
    double at_a = filter(n, time, depth, noise, exp(a), NULL),
           at_b = filter(n, time, depth, noise, exp(b), NULL);
    for (int i = 0; i < ROUNDS; i++) {
        if (at_a > at_b) {
            high = b, b = a, at_b = at_a;
            a = high - GOLDEN * (high - low);
            at_a = filter(n, time, depth, noise, exp(a), NULL);
        } else {
            low = a, a = b, at_a = at_b;
            b = low + GOLDEN * (high - low);
            at_b = filter(n, time, depth, noise, exp(b), NULL);
        }
    }
    *score = fmax(at_a, at_b);
    return exp(at_a > at_b ? a : b);
}

/* Rauch, Tung and Striebel's smoother, backward over the filter's states. */
static void smooth(size_t n, const double *time, double q, state *s, double *depth) {
    for (size_t i = n - 1; i-- > 0;) {
        const double t = time[i + 1] - time[i];
        state p = ahead(&s[i], t, q);
        double det = p.xx * p.vv - p.xv * p.xv;
        if (!(det > 0.0))
            continue;
        double cxx = s[i].xx + t * s[i].xv, cxv = s[i].xv, cvx = s[i].xv + t * s[i].vv, cvv = s[i].vv;
        double dx = s[i + 1].x - p.x, dv = s[i + 1].v - p.v;
        s[i].x += ((cxx * p.vv - cxv * p.xv) * dx + (cxv * p.xx - cxx * p.xv) * dv) / det;
        s[i].v += ((cvx * p.vv - cvv * p.xv) * dx + (cvv * p.xx - cvx * p.xv) * dv) / det;
    }
    for (size_t i = 0; i < n; i++)
        depth[i] = s[i].x;
}

palp_status segments_smooth_by_order(size_t order, size_t n, const double *time, double *depth,
                                     double *noise) {
    *noise = 0.0;
    if (n < LEAST)
        return PALP_OK;
    double *bend = malloc(n * sizeof *bend);
    if (!bend)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i + 2 < n; i++)
        bend[i] = depth[i] - 2.0 * depth[i + 1] + depth[i + 2];
    const double sd = noise_of(order, n, bend);
    free(bend);
    if (!(sd > 0.0) || sd <= least_step(n, depth))
        return PALP_OK;
    double with, without;
    const double q = best_intensity(n, time, depth, sd, &with);
    best_intensity(n, time, depth, 1e-3 * sd, &without);
    if (with - without <= 0.5 * log((double)n))
        return PALP_OK;
    state *states = malloc(n * sizeof *states);
    if (!states)
        return PALP_ERR_NO_MEMORY;
    filter(n, time, depth, sd, q, states);
    smooth(n, time, q, states, depth);
    free(states);
    *noise = sd;
    return PALP_OK;
}

palp_status palp_segments_smooth_path(size_t n, const double *time_s, double *depth, double *noise) {
    return time_s && depth && noise ? segments_smooth_by_order(ORDER, n, time_s, depth, noise)
                                    : PALP_ERR_ARGUMENT;
}
