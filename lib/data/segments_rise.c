/* segments_rise.c: finds contact from the force that rises after the air: level + a (depth - contact)^p. */
#include "segments_internal.h"

#include <math.h>

enum { STEPS = 40, ROUNDS = 4, POWERS = 3, FEWEST = 8, MOST = 20000 };

static const double POWER[POWERS] = {1.0, 1.5, 2.0};
static const double FIRST_PART = 1.0 / 6.0;        /* share of the rise to the peak whose samples are used */
static const double CLEAR = 20.0, MOST_PART = 0.5; /* or a larger share, up to so many sds of the noise */

/* Samples of the rise; the plate's travel is positive from the first. */
typedef struct rise {
    const palp_press *press;
    size_t n;
    double sign, farthest;
} rise;

static double press_depth_at_sample(const rise *r, size_t i) {
    return r->sign * (r->press->depth[i] - r->press->depth[0]);
}

static double power_of_positive_part(double x, double p) {
    return x <= 0.0 ? 0.0 : p == 1.0 ? x : p == 2.0 ? x * x : x * sqrt(x);
}

/* Sum of squared residuals of the line through force over (way - contact)^p. */
static double squares_left_by_contact(const rise *r, double contact, double p) {
    double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0, syy = 0.0, n = 0.0, y0 = r->press->force_N[0];
    for (size_t i = 0; i < r->n;
         i += r->n / MOST + 1, n += 1.0) { /* with very many samples only some are used */
        double x = power_of_positive_part((press_depth_at_sample(r, i) - contact) / r->farthest, p),
               y = r->press->force_N[i] - y0;
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
        syy += y * y;
    }
    double xx = sxx - sx * sx / n, xy = sxy - sx * sy / n, yy = syy - sy * sy / n;
    return xx > 0.0 ? fmax(yy - xy * xy / xx, 0.0) : yy;
}

/* The contact with the least sum of squares, by ever finer steps. */
static double find_best_contact(const rise *r, double p, double *least) {
    double low = 0.0, high = 0.98 * r->farthest, best = 0.0;
    *least = HUGE_VAL;
    for (int round = 0; round < ROUNDS; round++) {
        double step = (high - low) / STEPS;
        for (int k = 0; k <= STEPS; k++) {
            double left = squares_left_by_contact(r, low + k * step, p);
            if (left < *least) {
                *least = left;
                best = low + k * step;
            }
        }
        low = fmax(best - step, 0.0);
        high = fmin(best + step, 0.98 * r->farthest);
    }
    return best;
}

/* Standard error of contact: the distance at which the sum of squares grows by a variance of the noise. */
static double contact_standard_error(const rise *r, double contact, double p, double least, double variance) {
    double h = 1e-3 * r->farthest;
    while (h < r->farthest && squares_left_by_contact(r, contact + h, p) - least < variance)
        h *= 2.0;
    double more = squares_left_by_contact(r, contact + h, p) - least;
    return more > 0.0 ? h * sqrt(variance / more) : r->farthest;
}

/* Mean contact over the powers, weighted by their likelihood, and its sd. */
static double average_contact_of_powers(const rise *r, double noise, double *sd) {
    double contact[POWERS], left[POWERS], least = HUGE_VAL, sum = 0.0, mean = 0.0, square = 0.0;
    for (size_t k = 0; k < POWERS; k++) {
        contact[k] = find_best_contact(r, POWER[k], &left[k]);
        least = fmin(least, left[k]);
    }
    double variance = fmax(noise * noise, least / (double)(r->n < MOST ? r->n : MOST));
    for (size_t k = 0; k < POWERS; k++) {
        double weight = variance > 0.0 ? exp(-0.5 * (left[k] - least) / variance) : left[k] <= least;
        double own = weight > 0.0 ? contact_standard_error(r, contact[k], POWER[k], left[k], variance) : 0.0;
        sum += weight;
        mean += weight * contact[k];
        square += weight * (contact[k] * contact[k] + own * own);
    }
    mean /= sum;
    *sd = sqrt(fmax(square / sum - mean * mean, 0.0));
    return mean;
}

void segments_refine_contact(const palp_press *press, palp_air *air) {
    rise r = {press, air->contact, press->depth[press->peak] > press->depth[0] ? 1.0 : -1.0, 0.0};
    double level = air->level_N, top = press->mean_N[press->peak], sd;
    double part_N =
        fmax(FIRST_PART * fabs(top - level), fmin(CLEAR * press->noise_N, MOST_PART * fabs(top - level)));
    while (r.n < press->peak && fabs(press->mean_N[r.n] - level) < part_N)
        r.n++;
    r.farthest = press_depth_at_sample(&r, r.n);
    if (r.n < air->contact + FEWEST || !(r.farthest > 0.0))
        return;
    double contact = average_contact_of_powers(&r, press->noise_N, &sd);
    air->contact_sd = sd;
    air->contact_depth = press->depth[0] + r.sign * contact;
    air->contact = 0;
    while (air->contact < press->peak && press_depth_at_sample(&r, air->contact) < contact)
        air->contact++;
}

/* Before contact the force must be that of air, as exactly as noise permits. */
bool segments_air_seen(const palp_press *press, const palp_air *air) {
    rise r = {press, air->contact, air->contact_depth > press->depth[0] ? 1.0 : -1.0, 0.0};
    double travel = fabs(air->contact_depth - press->depth[0]), sum = 0.0, count = 0.0, rest = 0.0;
    if (air->contact >= press->peak || travel <= 3.0 * air->contact_sd)
        return false;
    for (size_t i = 0; i < air->contact; i++) {
        double part = press_depth_at_sample(&r, i) / travel;
        rest += part <= 0.01;
        if (part > 0.01 && part < 0.7) {
            sum += press->force_N[i] - air->level_N;
            count += 1.0;
        }
    }
    double sd = press->noise_N * sqrt(1.0 / fmax(count, 1.0) + 1.0 / fmax(rest, 1.0));
    return count > 0.0 &&
           fabs(sum / count) <= 4.0 * sd + 1e-4 * fabs(press->mean_N[press->peak] - air->level_N);
}
