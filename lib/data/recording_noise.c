/* recording_noise.c: faults of a recording's force: clipping, correlation, mains hum. */
#include "base/statistics.h"
#include "recording_internal.h"

#include <math.h>
#include <stdlib.h>

static const double PI = 3.14159265358979323846;

/* The largest force used, and the next below it. */
static double find_two_largest_forces(const palp_recording *r, double *next) {
    double top = -HUGE_VAL;
    *next = -HUGE_VAL;
    for (size_t i = 0; i < r->n; i++) {
        double f = r->force_N[i];
        if (!r->use[i] || f <= *next || f == top)
            continue;
        *next = f > top ? top : f;
        top = fmax(top, f);
    }
    return top;
}

/* Should the force have risen by several steps of the converter between two samples? The largest force also
 * repeats in a hold of an elastic specimen, or with a coarse converter. */
static bool should_force_have_risen(const palp_recording *r, size_t from, size_t to, double top,
                                    double step) {
    double low = r->depth_m[0], high = low, moved = 0.0;
    for (size_t i = 0; i < r->n; i++) {
        low = fmin(low, r->depth_m[i]);
        high = fmax(high, r->depth_m[i]);
        if (i >= from && i <= to)
            moved = fmax(moved, r->depth_m[i] - r->depth_m[from]);
    }
    double share = high > low ? moved / (high - low) : 0.0;
    return share > 2e-3 && share * (top - r->force_N[0]) > 3.0 * step;
}

/* Masks stretches at exactly the largest force. Samples between two of them are masked too: their noise is
 * cut on one side only. */
void recording_mask_clipped(palp_recording *r, double share) {
    double next, top = find_two_largest_forces(r, &next);
    size_t least = (size_t)fmax(5.0, share * (double)r->n);
    for (size_t first = 0, last; first < r->n; first = last + 1) {
        size_t hits = 0;
        last = first;
        if (r->force_N[first] != top)
            continue;
        for (size_t i = first; i < r->n && i - last <= least; i++)
            if (r->force_N[i] == top) {
                last = i;
                hits++;
            }
        if (hits < least || !should_force_have_risen(r, first, last, top, top - next))
            continue;
        for (size_t i = first; i <= last; i++) {
            r->n_clipped += r->use[i];
            r->use[i] = 0;
        }
    }
}

/* The second half of the motionless stretch at the end, or of the recording; of that at most the last
 * samples. */
static size_t find_motionless_tail(const palp_recording *r, bool *still) {
    enum { FEWEST = 20, MOST = 8192 };
    size_t i = r->n - 1;
    while (i > 0 && fabs(r->depth_m[i - 1] - r->depth_m[r->n - 1]) < 1e-3 * r->deepest_m)
        i--;
    size_t tail = r->n - i, half;
    *still = tail > FEWEST;
    half = *still ? (tail + 1) / 2 : r->n / 2;
    return r->n - (half < MOST ? half : MOST);
}

static void subtract_linear_trend(const double *f, size_t n, double *x) {
    statistics_line line = statistics_line_fit(n, NULL, f, NULL);
    for (size_t i = 0; i < n; i++)
        x[i] = f[i] - line.mean_y - line.slope * ((double)i - line.mean_x);
}

/* The tail, without a straight line through each of several pieces; masked samples become 0. */
static double *copy_detrended_tail(const palp_recording *r, size_t *n_out, bool *still) {
    enum { PIECES = 8 };
    size_t first = find_motionless_tail(r, still), piece = (r->n - first) / PIECES;
    *n_out = piece * PIECES;
    double *x = malloc((*n_out + 1) * sizeof *x);
    for (size_t p = 0; x && p < PIECES && piece > 0; p++)
        subtract_linear_trend(r->force_N + first + p * piece, piece, x + p * piece);
    for (size_t i = 0; x && i < *n_out; i++)
        x[i] *= r->use[first + i];
    return x;
}

/* Amplitude at f Hz by projection. */
static double spectral_line_amplitude(const double *x, size_t n, double f, double step) {
    double angle = 2.0 * PI * f * step, c = cos(angle), s = sin(angle), re = 1.0, im = 0.0, a = 0.0, b = 0.0;
    for (size_t i = 0; i < n; i++) {
        a += x[i] * re;
        b += x[i] * im;
        double next = re * c - im * s;
        im = re * s + im * c;
        re = next;
    }
    return 2.0 * hypot(a, b) / (double)n;
}

/* The strongest line from low to high, in steps of a share of the resolution 1 / T. */
static void find_strongest_line(palp_recording *r, const double *x, size_t n, double step, double low,
                                double high, double share) {
    double df = share / ((double)n * step);
    for (double f = low; f <= high; f += df) {
        double a = spectral_line_amplitude(x, n, f, step);
        if (a > r->hum_N) {
            r->hum_N = a;
            r->hum_Hz = f;
        }
    }
}

palp_status recording_look_at_noise(palp_recording *r, double step) {
    size_t n;
    bool still;
    double *x = copy_detrended_tail(r, &n, &still), own = 0.0, next = 0.0;
    if (!x)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n; i++) {
        own += x[i] * x[i];
        next += i ? x[i] * x[i - 1] : 0.0;
    }
    r->correlation = still && own > 0.0 ? next / own : 0.0; /* curvature would look like correlation */
    if (n >= 200 && step < 1.0 / 135.0 && !r->uneven && r->noise_N > 0.0) {
        double sd = sqrt(own / (double)n), around = 0.5 / ((double)n * step);
        find_strongest_line(r, x, n, step, 45.0, 65.0, 0.5);
        find_strongest_line(r, x, n, step, r->hum_Hz - around, r->hum_Hz + around, 0.05);
        if (r->hum_N <= 8.0 * sd * sqrt(2.0 / (double)n))
            r->hum_N = r->hum_Hz = 0.0;
    }
    free(x);
    return PALP_OK;
}
