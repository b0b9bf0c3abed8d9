/* recording_noise.c: the noise of a recording: how much, spikes, clipping, correlation, mains hum. */
#include "recording_internal.h"

#include <math.h>
#include <stdlib.h>

static const double PI = 3.14159265358979323846;

/* Hoare's quickselect; the middle as pivot, so that sorted and constant data are no worse than others. */
double recording_kth(double *x, size_t n, size_t k) {
    ptrdiff_t low = 0, high = (ptrdiff_t)n - 1, wanted = (ptrdiff_t)k;
    while (low < high) {
        double pivot = x[low + (high - low) / 2];
        ptrdiff_t i = low, j = high;
        while (i <= j) {
            while (x[i] < pivot)
                i++;
            while (pivot < x[j])
                j--;
            if (i <= j) {
                double t = x[i];
                x[i++] = x[j];
                x[j--] = t;
            }
        }
        if (j < wanted)
            low = i;
        if (wanted < i)
            high = j;
    }
    return x[k];
}

static double quantile(double *x, size_t n, double share) {
    return recording_kth(x, n, (size_t)(share * (double)(n - 1)));
}

/* Root mean square of those up to a limit. */
static double trimmed_rms(const double *x, size_t n, double limit) {
    double sum = 0.0, kept = 0.0;
    for (size_t i = 0; i < n; i++)
        if (x[i] <= limit) {
            sum += x[i] * x[i];
            kept += 1.0;
        }
    return sqrt(sum / kept);
}

/* From second differences d, sd sqrt(6) times that of a sample, by their median: corners and spikes do not
 * count. The few counts of a coarse converter show in quantiles that a Gaussian (0.32, 0.67, 1.64 sd) does
 * not have; then the mean square of all but the largest. */
palp_status recording_find_noise(palp_recording *r, double step) {
    double *d = malloc(r->n * sizeof *d);
    size_t m = 0;
    if (!d)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 1; i + 1 < r->n; i++)
        if (r->time_s[i + 1] - r->time_s[i - 1] < 3.0 * step)
            d[m++] = fabs(r->force_N[i - 1] - 2.0 * r->force_N[i] + r->force_N[i + 1]);
    if (m > 0) {
        double middle = quantile(d, m, 0.5), quarter = quantile(d, m, 0.25), most = quantile(d, m, 0.9);
        bool coarse = quarter >= 0.9 * middle || most > 5.0 * middle;
        double sd = coarse ? trimmed_rms(d, m, quantile(d, m, 0.99)) : 1.4826 * middle;
        r->noise_N = sd / sqrt(6.0);
    }
    free(d);
    return PALP_OK;
}

/* A lone sample far from both its neighbours, and by more than the curve moves there. */
void recording_mask_spikes(palp_recording *r, double sigma) {
    const double *f = r->force_N;
    for (size_t i = 2; i + 2 < r->n && r->noise_N > 0.0; i++) {
        double up = f[i] - f[i - 1], down = f[i] - f[i + 1];
        double around = fmax(fabs(f[i - 1] - f[i - 2]), fabs(f[i + 2] - f[i + 1]));
        if (up * down > 0.0 && fmin(fabs(up), fabs(down)) > sigma * r->noise_N + 3.0 * around) {
            r->use[i] = 0;
            r->n_spikes++;
        }
    }
}

/* The largest force in use and the next below it. */
static double largest(const palp_recording *r, double *next) {
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

/* Whether the force should have risen by several of the converter's steps from one sample to another:
 * a hold of an elastic specimen, or a coarse converter, stays on its largest force too. */
static bool should_have_risen(const palp_recording *r, size_t from, size_t to, double top, double step) {
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

/* Stretches at exactly the largest force. What lies between two such samples is masked with them: noise
 * that the limit cut only on one side. */
void recording_mask_clipped(palp_recording *r, double share) {
    double next, top = largest(r, &next);
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
        if (hits < least || !should_have_risen(r, first, last, top, top - next))
            continue;
        for (size_t i = first; i <= last; i++) {
            r->n_clipped += r->use[i];
            r->use[i] = 0;
        }
    }
}

/* The second half of the stretch at the end without motion, or of the recording, and of that the last. */
static size_t still_tail(const palp_recording *r, bool *still) {
    enum { FEWEST = 20, MOST = 8192 };
    size_t i = r->n - 1;
    while (i > 0 && fabs(r->depth_m[i - 1] - r->depth_m[r->n - 1]) < 1e-3 * r->deepest_m)
        i--;
    size_t tail = r->n - i, half;
    *still = tail > FEWEST;
    half = *still ? (tail + 1) / 2 : r->n / 2;
    return r->n - (half < MOST ? half : MOST);
}

static void detrend(const double *f, size_t n, double *x) {
    double middle = 0.5 * ((double)n - 1.0), level = 0.0, sxx = 0.0, sxf = 0.0;
    for (size_t i = 0; i < n; i++) {
        level += f[i] / (double)n;
        sxx += ((double)i - middle) * ((double)i - middle);
        sxf += ((double)i - middle) * f[i];
    }
    for (size_t i = 0; i < n; i++)
        x[i] = f[i] - level - (sxx > 0.0 ? sxf / sxx : 0.0) * ((double)i - middle);
}

/* The tail without a straight line through each of some pieces; masked samples become 0. */
static double *detrended_tail(const palp_recording *r, size_t *n_out, bool *still) {
    enum { PIECES = 8 };
    size_t first = still_tail(r, still), piece = (r->n - first) / PIECES;
    *n_out = piece * PIECES;
    double *x = malloc((*n_out + 1) * sizeof *x);
    for (size_t p = 0; x && p < PIECES && piece > 0; p++)
        detrend(r->force_N + first + p * piece, piece, x + p * piece);
    for (size_t i = 0; x && i < *n_out; i++)
        x[i] *= r->use[first + i];
    return x;
}

/* Amplitude of a line at f Hz by projection. */
static double line_amplitude(const double *x, size_t n, double f, double step) {
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

/* The strongest line from low to high, by steps of a share of the resolution 1 / T. */
static void strongest_line(palp_recording *r, const double *x, size_t n, double step, double low, double high,
                           double share) {
    double df = share / ((double)n * step);
    for (double f = low; f <= high; f += df) {
        double a = line_amplitude(x, n, f, step);
        if (a > r->hum_N) {
            r->hum_N = a;
            r->hum_Hz = f;
        }
    }
}

palp_status recording_look_at_noise(palp_recording *r, double step) {
    size_t n;
    bool still;
    double *x = detrended_tail(r, &n, &still), own = 0.0, next = 0.0;
    if (!x)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n; i++) {
        own += x[i] * x[i];
        next += i ? x[i] * x[i - 1] : 0.0;
    }
    r->correlation = still && own > 0.0 ? next / own : 0.0; /* what bends would look like noise */
    if (n >= 200 && step < 1.0 / 135.0 && !r->uneven && r->noise_N > 0.0) {
        double sd = sqrt(own / (double)n), around = 0.5 / ((double)n * step);
        strongest_line(r, x, n, step, 45.0, 65.0, 0.5);
        strongest_line(r, x, n, step, r->hum_Hz - around, r->hum_Hz + around, 0.05);
        if (r->hum_N <= 8.0 * sd * sqrt(2.0 / (double)n))
            r->hum_N = r->hum_Hz = 0.0;
    }
    free(x);
    return PALP_OK;
}
