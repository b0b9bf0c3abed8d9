/* palpation_posterior.c: the evidence of a region as a sum over several stiffnesses, along a ridge of the
 * likelihood; intervals of the mixture of these.
 */
#include "palpation_internal.h"

#include "base/dense.h"
#include "base/statistics.h"

#include <math.h>
#include <string.h>

const double palpation_stiffness[] = {1.5, 2.2, 3.5, 6.0, 12.0, 25.0, 50.0};

static const double LEAST = 0.6; /* smallest size, in mean edges: smaller regions are not in the mesh */
static const double MOST = 0.45; /* largest, of the shortest side of the mesh */
static const double PI2 = 6.283185307179586;

void palpation_range(const palpation_search *s, size_t k, double *low, double *high) {
    const bool is_size = k + 1 == s->kind->n;
    *low = is_size ? log(LEAST) : s->low[k] / s->edge;
    *high = is_size ? log(MOST * s->shortest / s->edge) : s->high[k] / s->edge;
}

/* ---- evidence ------------------------------------------------------------------------------------- */

double palpation_variance(const palpation_search *s, const palpation_candidate *c) {
    return (c->squares + s->known_squares) / (palpation_freedom(s, 0) + s->known);
}

double palpation_freedom(const palpation_search *s, size_t parameters) {
    const size_t fitted = parameters + (s->settings->gain_known ? 0 : 1);
    return s->n > fitted + 1 ? (double)(s->n - fitted) : 1.0;
}

/* Logarithm of the ratio of marginal likelihoods, this region over none: the place is integrated out over the
 * mesh and the logarithm of the size over its range, by Laplace's method. none: the likelihood of none. */
static double evidence_of_region(const palpation_search *s, const palpation_candidate *c, double none) {
    const size_t n = s->kind->n;
    const double variance = palpation_variance(s, c);
    double normal[PALPATION_PLACE * PALPATION_PLACE];
    if (!c->known)
        return -INFINITY;
    memcpy(normal, c->covariance, sizeof normal);
    if (!dense_cholesky(n, normal))
        return -INFINITY;
    double volume = 0.5 * dense_log_determinant(n, normal) + 0.5 * (double)n * log(PI2 * variance);
    for (size_t k = 0; k < n; k++) {
        double low, high;
        palpation_range(s, k, &low, &high);
        volume -= log(high - low);
    }
    return c->likelihood - none + fmin(volume, 0.0);
}

/* Each stiffness is for an interval of the absolute logarithm; together they are for 1 to the last. */
static void interval_of_stiffness(size_t i, double *low, double *high) {
    const double *f = palpation_stiffness;
    *low = i > 0 ? 0.5 * log(f[i - 1] * f[i]) : 0.0;
    *high = i + 1 < PALPATION_STIFFNESSES ? 0.5 * log(f[i] * f[i + 1]) : log(f[i]);
}

static double width_of_stiffness(size_t i) {
    double low, high;
    interval_of_stiffness(i, &low, &high);
    return high - low;
}

/* Sum over all stiffnesses. The other side of 1 has as much prior. */
double palpation_evidence(const palpation_search *s, const palpation_candidate found[PALPATION_STIFFNESSES],
                          double none, double posterior[PALPATION_STIFFNESSES]) {
    double sum = 0.0, widths = 0.0, most = -INFINITY;
    for (size_t i = 0; i < PALPATION_STIFFNESSES; i++) {
        posterior[i] = evidence_of_region(s, &found[i], none) + log(width_of_stiffness(i));
        most = fmax(most, posterior[i]);
        widths += 2.0 * width_of_stiffness(i);
    }
    for (size_t i = 0; i < PALPATION_STIFFNESSES; i++) {
        posterior[i] = isfinite(most) ? exp(posterior[i] - most) : 1.0;
        sum += posterior[i];
    }
    for (size_t i = 0; i < PALPATION_STIFFNESSES; i++)
        posterior[i] /= sum;
    return most + log(sum / widths);
}

/* ---- intervals ------------------------------------------------------------------------------------ */

/* A mixture of normal distributions. */
typedef struct mixture {
    size_t n;
    double share[PALPATION_STIFFNESSES], mean[PALPATION_STIFFNESSES], sd[PALPATION_STIFFNESSES];
} mixture;

static double share_below(const mixture *m, double x) {
    double sum = 0.0;
    for (size_t i = 0; i < m->n; i++)
        sum += m->share[i] * 0.5 * erfc(-(x - m->mean[i]) / (sqrt(2.0) * m->sd[i]));
    return sum;
}

static double quantile_of_mixture(const mixture *m, double share, double low, double high) {
    enum { HALVES = 60 };
    for (int i = 0; i < HALVES; i++) {
        const double middle = 0.5 * (low + high);
        if (share_below(m, middle) < share)
            low = middle;
        else
            high = middle;
    }
    return low; /* an end of the range is met exactly */
}

/* The posterior is uniform over the width of each stiffness. The interval is open where an end of the range
 * has more than the tail. */
static void find_interval_of_stiffness(const palpation_candidate found[PALPATION_STIFFNESSES],
                                       const double posterior[PALPATION_STIFFNESSES], double tail,
                                       palp_palpation_value *v) {
    double end[2] = {0.0, log(palpation_stiffness[PALPATION_STIFFNESSES - 1])}, from = 0.0, below = 0.0;
    for (size_t i = 0; i < PALPATION_STIFFNESSES; i++) {
        const double width = width_of_stiffness(i);
        for (int side = 0; side < 2; side++) {
            const double wanted = side == 0 ? tail : 1.0 - tail;
            if (below < wanted && below + posterior[i] >= wanted)
                end[side] = from + width * (wanted - below) / posterior[i];
        }
        below += posterior[i];
        from += width;
    }
    const bool open = posterior[PALPATION_STIFFNESSES - 1] > tail, softer = found[0].log_stiffness < 0.0;
    v->low = softer ? (open ? 0.0 : exp(-end[1])) : exp(end[0]);
    v->high = softer ? exp(-end[0]) : open ? INFINITY : exp(end[1]);
}

/* Mean and deviation of parameter k with a stiffness, which is uniform over its interval. Place and size
 * follow it linearly. */
static void add_stiffness(const palpation_search *s, const palpation_candidate *c, size_t i, size_t k,
                          mixture *m) {
    const size_t n = s->kind->n;
    const double freedom = s->known + palpation_freedom(s, n + 1), sign = c->log_stiffness < 0.0 ? -1.0 : 1.0,
                 variance = (c->squares + s->known_squares) / freedom * c->covariance[k * n + k],
                 widening = statistics_student_widening((size_t)freedom);
    double low, high;
    interval_of_stiffness(i, &low, &high);
    const double across = c->along[k] * (high - low);
    m->mean[i] = c->p[k] + c->along[k] * sign * (0.5 * (low + high) - fabs(c->log_stiffness));
    m->sd[i] = sqrt(widening * widening * variance + across * across / 12.0);
}

size_t palpation_intervals(const palpation_search *s, const palpation_candidate found[PALPATION_STIFFNESSES],
                           const double posterior[PALPATION_STIFFNESSES],
                           palp_palpation_value *const *value) {
    static const double TAIL = 0.025;
    const size_t n = s->kind->n;
    size_t best = 0;
    for (size_t i = 1; i < PALPATION_STIFFNESSES; i++)
        best = posterior[i] > posterior[best] ? i : best;
    for (size_t k = 0; k < n; k++) {
        mixture m = {.n = PALPATION_STIFFNESSES};
        double least, most;
        palpation_range(s, k, &least, &most);
        for (size_t i = 0; i < PALPATION_STIFFNESSES; i++)
            add_stiffness(s, &found[i], i, k, &m);
        for (size_t i = 0; i < PALPATION_STIFFNESSES; i++) {
            m.share[i] = posterior[i];
            m.mean[i] = fmin(fmax(m.mean[i], least), most);
            m.sd[i] = fmax(fmin(m.sd[i], most - least), 1e-9);
        }
        const double low = quantile_of_mixture(&m, TAIL, least, most),
                     high = quantile_of_mixture(&m, 1.0 - TAIL, least, most), middle = found[best].p[k];
        *value[k] = k + 1 < n ? (palp_palpation_value){s->edge * middle, s->edge * low, s->edge * high}
                              : (palp_palpation_value){s->edge * exp(middle), s->edge * exp(low),
                                                       s->edge * exp(high)};
    }
    find_interval_of_stiffness(found, posterior, TAIL, value[n]);
    value[n]->best = exp(found[best].log_stiffness);
    return best;
}
