/* recording_contact.c: finds contact and zero force. */
#include "base/statistics.h"
#include "recording_internal.h"

#include <math.h>

/* The motion has begun, and a depth is past contact, at this share of the largest depth. */
static const double STARTED = 1e-3;

/* Mean of those of n samples from first on that are used; 0 if none is. *used: their number, may be NULL. */
static double recording_mean(const palp_recording *r, size_t first, size_t n, size_t *used) {
    double sum = 0.0, count = 0.0;
    for (size_t i = first; i < first + n; i++)
        if (r->use[i]) {
            sum += r->force_N[i];
            count += 1.0;
        }
    if (used)
        *used = (size_t)count;
    return count > 0.0 ? sum / count : 0.0;
}

/* Number of samples at rest or in air at the start: depth is not above the larger of its start and zero. */
static size_t count_quiet_samples(const palp_recording *r, double deepest) {
    double limit = fmax(r->depth_m[0], 0.0) + STARTED * (deepest - fmin(r->depth_m[0], 0.0));
    size_t i = 0;
    while (i < r->n && r->depth_m[i] <= limit)
        i++;
    return i;
}

/* First sample at half the largest force: always on the first press. */
static size_t find_half_peak_sample(const palp_recording *r, double zero) {
    double top = zero;
    for (size_t i = 0; i < r->n; i++)
        top = r->use[i] ? fmax(top, r->force_N[i]) : top;
    size_t i = 0;
    while (i + 1 < r->n && (!r->use[i] || r->force_N[i] - zero < 0.5 * (top - zero)))
        i++;
    return i;
}

/* First sample from which the force, averaged over a window, stays 4 sd above zero while it rises. */
static size_t find_force_departure(const palp_recording *r, double zero) {
    enum { WINDOW = 9 };
    size_t end = find_half_peak_sample(r, zero), first = 0;
    double least = 1e-12 * fabs(r->force_N[end] - zero); /* without noise */
    double limit = 4.0 * fmax(r->noise_N, least) * sqrt((double)WINDOW), sum = 0.0;
    for (size_t i = 0; i <= end; i++) {
        sum += r->use[i] ? r->force_N[i] - zero : 0.0;
        if (i >= WINDOW)
            sum -= r->use[i - WINDOW] ? r->force_N[i - WINDOW] - zero : 0.0;
        if (sum <= limit)
            first = i + 1;
    }
    return first <= end ? first : end;
}

/* Where the line through samples first to end - 1 reaches zero force, and its sd. */
static double find_zero_force_crossing(const palp_recording *r, size_t first, size_t end, double zero,
                                       double *sd) {
    statistics_line line =
        statistics_line_fit(end - first, r->depth_m + first, r->force_N + first, r->use + first);
    double way = (line.mean_y - zero) / line.slope; /* from there to the mean of the samples */
    *sd = hypot(r->noise_N * sqrt(1.0 / line.n + way * way / line.sxx), r->zero_sd_N) / fabs(line.slope);
    return line.mean_x - way;
}

static size_t find_end_of_stretch(const palp_recording *r, size_t first, double length) {
    size_t end = first;
    while (end < r->n && r->depth_m[end] - r->depth_m[first] < length)
        end++;
    return end;
}

/* Contact extrapolated from the first 3 % of the travel. If the first 6 % lead elsewhere the force is curved,
 * and may be curved within the noise too: that difference counts three times. With few samples five of each,
 * if they are in the first quarter of the travel. False: too few samples. */
static bool extrapolate_to_contact(const palp_recording *r, size_t first, double deepest, double zero,
                                   double *at, double *sd) {
    enum { FEWEST = 5 };
    size_t near = find_end_of_stretch(r, first, 0.03 * deepest),
           far = find_end_of_stretch(r, first, 0.06 * deepest);
    double sd_far;
    near = near < first + FEWEST ? first + FEWEST : near;
    far = far < near + FEWEST ? near + FEWEST : far;
    if (far > find_end_of_stretch(r, first, 0.25 * deepest))
        return false;
    *at = find_zero_force_crossing(r, first, near, zero, sd);
    double bend = fabs(*at - find_zero_force_crossing(r, first, far, zero, &sd_far));
    *sd = hypot(*sd, 3.0 * fmax(bend - *sd, 0.0));
    return isfinite(*at) && isfinite(*sd);
}

/* Zero force: mean of n samples in air or at rest. Its sd is that of white noise, unless the means of ten
 * parts differ by much more, by drift or correlated noise. */
static void find_zero_force(palp_recording *r, size_t n) {
    enum { PARTS = 10 };
    double part[PARTS], square = 0.0;
    size_t used;
    r->zero_N = recording_mean(r, 0, n, &used);
    r->zero_sd_N = used ? r->noise_N / sqrt((double)used) : 0.0;
    for (size_t k = 0; k < PARTS && n >= 10 * PARTS; k++) {
        part[k] = recording_mean(r, k * (n / PARTS), n / PARTS, NULL) - r->zero_N;
        square += part[k] * part[k];
    }
    double sd = sqrt(square / (PARTS - 1.0) / PARTS);
    if (sd > 1.6 * r->zero_sd_N) /* by chance once in two hundred */
        r->zero_sd_N = sd;
}

/* Air ends where the force departs; contact before depth 0 makes it end before the motion does. */
static void find_zero_in_air(palp_recording *r, size_t quiet) {
    find_zero_force(r, quiet);
    for (int round = 0; round < 2; round++) {
        size_t left = find_force_departure(r, r->zero_N);
        find_zero_force(r, left < quiet ? left : quiet);
    }
}

/* With air the recorded contact is kept unless extrapolation differs by more than 3 sd. */
static void check_recorded_contact(palp_recording *r, double deepest) {
    double at, sd;
    if (!extrapolate_to_contact(r, find_force_departure(r, r->zero_N), deepest, r->zero_N, &at, &sd))
        return;
    r->contact_sd_m = sd;
    if (fabs(at) > 3.0 * sd)
        r->contact_m = at;
}

/* Without air depth 0 is contact. Its uncertainty is given in the file, or else follows from the start of the
 * rise. */
static void find_contact_uncertainty(palp_recording *r, size_t quiet, double deepest) {
    double at, sd;
    if (r->contact_sd_m == 0.0 && extrapolate_to_contact(r, quiet, deepest, r->zero_N, &at, &sd))
        r->contact_sd_m = hypot(sd, at);
}

void recording_find_contact(palp_recording *r, const palp_recording_settings *settings) {
    enum { FEWEST = 20 };
    double deepest = 0.0;
    for (size_t i = 0; i < r->n; i++)
        deepest = fmax(deepest, r->depth_m[i]);
    size_t quiet = count_quiet_samples(r, deepest);
    bool air = quiet >= FEWEST && r->depth_m[0] < -STARTED * deepest;
    if (air)
        find_zero_in_air(r, quiet);
    else if (quiet >= FEWEST / 2 && fabs(r->depth_m[0]) <= STARTED * deepest)
        find_zero_force(r, quiet); /* the plate rests on the specimen */
    if (settings->contact_given || r->contact_found) {
        r->contact_rule = PALP_CONTACT_GIVEN;
        r->contact_m = settings->contact_given ? settings->contact_m : 0.0;
        r->contact_sd_m = settings->contact_given ? 0.0 : r->contact_sd_m;
        r->zero_N = r->contact_found ? 0.0 : r->zero_N;
    } else if (air) {
        r->contact_rule = PALP_CONTACT_FREE_AIR;
        check_recorded_contact(r, deepest);
    } else {
        r->contact_rule = PALP_CONTACT_NOMINAL;
        find_contact_uncertainty(r, quiet, deepest);
    }
}
