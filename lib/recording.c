/* recording.c: what a raw recording tells about itself before any fit. */
#include <palpate/recording.h>

#include "file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

palp_recording_settings palp_recording_settings_default(void) {
    return (palp_recording_settings){.spike_sigma = 8.0, .clip_share = 0.002};
}

void palp_recording_free(palp_recording *r) {
    if (!r)
        return;
    free(r->time_s);
    free(r->depth_m);
    free(r->force_N);
    free(r->use);
    memset(r, 0, sizeof *r);
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Median of n numbers; sorts them. */
static double median(double *x, size_t n) {
    qsort(x, n, sizeof *x, ascending);
    return n ? x[n / 2] : 0.0;
}

static palp_status copy_columns(palp_recording *r, const palp_experiment *e) {
    const double *t = palp_experiment_column(e, "time_s"), *d = palp_experiment_column(e, "depth_mm"),
                 *f = palp_experiment_column(e, "force_N");
    r->n = palp_experiment_rows(e);
    r->time_s = malloc((r->n + 1) * sizeof(double));
    r->depth_m = malloc((r->n + 1) * sizeof(double));
    r->force_N = malloc((r->n + 1) * sizeof(double));
    r->use = malloc(r->n + 1);
    if (!r->time_s || !r->depth_m || !r->force_N || !r->use)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < r->n; i++) {
        r->time_s[i] = t[i];
        r->depth_m[i] = 1e-3 * d[i];
        r->force_N[i] = f[i];
        r->use[i] = 1;
    }
    return PALP_OK;
}

static void read_header(palp_recording *r, const palp_experiment *e, const palp_recording_settings *settings) {
    const char *text;
    double value;
    if (!palp_experiment_get_number(e, "specimen.height_mm", &value))
        r->height_m = 1e-3 * value;
    if (!palp_experiment_get_number(e, "specimen.radius_mm", &value))
        r->radius_m = 1e-3 * value;
    if (settings->height_m > 0.0)
        r->height_m = settings->height_m;
    r->kind = PALP_RECORDING_OTHER;
    if (!palp_experiment_get_string(e, "protocol.kind", &text)) {
        if (strcmp(text, "static") == 0)
            r->kind = PALP_RECORDING_STATIC;
        else if (strcmp(text, "ramp_hold") == 0)
            r->kind = PALP_RECORDING_RAMP_HOLD;
    }
    r->faulted = !palp_experiment_get_string(e, "end.fault", &text);
}

/* Times: the median step, gaps and unevenness. */
static palp_status look_at_times(palp_recording *r, double *step) {
    double *dt = malloc(r->n * sizeof *dt);
    if (!dt)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 1; i < r->n; i++)
        dt[i - 1] = r->time_s[i] - r->time_s[i - 1];
    *step = median(dt, r->n - 1);
    for (size_t i = 1; i < r->n; i++) {
        double d = r->time_s[i] - r->time_s[i - 1];
        if (d > 3.0 * *step) {
            r->n_gaps++;
            r->longest_gap_s = fmax(r->longest_gap_s, d);
        } else if (fabs(d - *step) > 0.01 * *step) {
            r->uneven = true;
        }
    }
    free(dt);
    return PALP_OK;
}

/* White noise of a sample from second differences, by their median: corners and spikes do not count. */
static palp_status find_noise(palp_recording *r, double step) {
    double *d = malloc(r->n * sizeof *d), sum = 0.0;
    size_t m = 0;
    if (!d)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 1; i + 1 < r->n; i++)
        if (r->time_s[i + 1] - r->time_s[i - 1] < 3.0 * step)
            d[m++] = fabs(r->force_N[i - 1] - 2.0 * r->force_N[i] + r->force_N[i + 1]);
    double middle = median(d, m);
    /* counts of a coarse converter: the median may be one count or none */
    size_t kept = 0;
    for (size_t i = 0; i < m; i++)
        if (d[i] <= 6.0 * middle || i < (size_t)(0.9 * (double)m)) {
            sum += d[i] * d[i];
            kept++;
        }
    double robust = 1.4826 * middle / sqrt(6.0), plain = kept ? sqrt(sum / (double)kept / 6.0) : 0.0;
    bool coarse = m && (middle == 0.0 || d[m / 4] == middle);
    r->noise_N = coarse ? plain : robust;
    free(d);
    return PALP_OK;
}

/* A lone sample far from both its neighbours, and by more than the curve moves there. */
static void mask_spikes(palp_recording *r, double sigma) {
    const double *f = r->force_N;
    for (size_t i = 2; i + 2 < r->n; i++) {
        double up = f[i] - f[i - 1], down = f[i] - f[i + 1];
        double around = fmax(fabs(f[i - 1] - f[i - 2]), fabs(f[i + 2] - f[i + 1]));
        if (up * down > 0.0 && fmin(fabs(up), fabs(down)) > sigma * r->noise_N + 3.0 * around && r->noise_N > 0.0) {
            r->use[i] = 0;
            r->n_spikes++;
        }
    }
}

/* Runs of samples at exactly the largest force. */
static void mask_clipped(palp_recording *r, double share) {
    double top = r->force_N[0];
    for (size_t i = 1; i < r->n; i++)
        top = fmax(top, r->force_N[i]);
    size_t least = (size_t)fmax(5.0, share * (double)r->n);
    for (size_t i = 0, run = 0; i <= r->n && r->noise_N > 0.0; i++) {
        if (i < r->n && r->force_N[i] == top) {
            run++;
            continue;
        }
        if (run >= least)
            for (size_t j = i - run; j < i; j++) {
                r->n_clipped += r->use[j];
                r->use[j] = 0;
            }
        run = 0;
    }
}

static double mean(const double *x, size_t n) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += x[i];
    return n ? sum / (double)n : 0.0;
}

/* Line f = a + b x through n points; sd of the crossing of zero. */
static double crossing(size_t n, const double *x, const double *f, double noise, double *sd) {
    double mx = mean(x, n), mf = mean(f, n), sxx = 0.0, sxf = 0.0;
    for (size_t i = 0; i < n; i++) {
        sxx += (x[i] - mx) * (x[i] - mx);
        sxf += (x[i] - mx) * (f[i] - mf);
    }
    double slope = sxf / sxx, at = mx - mf / slope;
    *sd = noise / fabs(slope) * sqrt(1.0 / (double)n + (at - mx) * (at - mx) / sxx);
    return at;
}

/* Samples of rest or air at the start: the depth has not come a thousandth of the way past the larger of
 * its start and zero. */
static size_t quiet_start(const palp_recording *r, double deepest) {
    double limit = fmax(r->depth_m[0], 0.0) + 1e-3 * (deepest - fmin(r->depth_m[0], 0.0));
    size_t i = 0;
    while (i < r->n && r->depth_m[i] <= limit)
        i++;
    return i;
}

/* First sample from which the force, averaged over a window, stays 4 sd above zero until it peaks. */
static size_t departure(const palp_recording *r, size_t window, double zero) {
    double limit = 4.0 * fmax(r->noise_N, 1e-12) / sqrt((double)window), sum = 0.0;
    size_t peak = 0, first = 0;
    for (size_t i = 1; i < r->n; i++)
        if (r->force_N[i] > r->force_N[peak])
            peak = i;
    for (size_t i = 0; i <= peak; i++) {
        sum += r->force_N[i] - (i >= window ? r->force_N[i - window] : zero);
        double average = sum / (double)window - (i >= window ? zero : 0.0);
        if (average <= limit)
            first = i + 1;
    }
    return first <= peak ? first : peak;
}

/* With air before contact: its mean is zero force, and contact is where the rising force leads back to.
 * The nominal contact, depth 0, stands unless it is more than 3 sd off. Without: the rest before the
 * motion is zero force, and depth 0 is contact. */
static void find_contact(palp_recording *r, const palp_recording_settings *settings, double deepest) {
    enum { FEWEST = 20, WINDOW = 9 };
    size_t quiet = quiet_start(r, deepest), used = quiet;
    bool air = quiet >= FEWEST && r->depth_m[0] < -1e-3 * deepest;
    if (air) {
        size_t left = departure(r, WINDOW, mean(r->force_N, quiet));
        used = left < quiet ? left : quiet;
    }
    if (used >= 10) {
        r->zero_N = mean(r->force_N, used);
        r->zero_sd_N = r->noise_N / sqrt((double)used);
    }
    r->contact_rule = settings->contact_given ? PALP_CONTACT_GIVEN : air ? PALP_CONTACT_FREE_AIR : PALP_CONTACT_NOMINAL;
    if (settings->contact_given) {
        r->contact_m = settings->contact_m;
        return;
    }
    size_t start = air ? departure(r, WINDOW, r->zero_N) : quiet, end = start;
    while (end < r->n && r->depth_m[end] - r->depth_m[start] < 0.06 * deepest)
        end++;
    if (end - start < 5 || r->noise_N == 0.0)
        return;
    double sd, *f = r->force_N;
    for (size_t i = start; i < end; i++)
        f[i] -= r->zero_N;
    double at = crossing(end - start, r->depth_m + start, f + start, r->noise_N, &sd);
    for (size_t i = start; i < end; i++)
        f[i] += r->zero_N;
    /* the force bends over the stretch: a hundredth of its length is the line's own error */
    r->contact_sd_m = hypot(sd, 0.01 * 0.06 * deepest);
    if (air && isfinite(at) && fabs(at) > 3.0 * r->contact_sd_m)
        r->contact_m = at;
}

static void shift(palp_recording *r) {
    r->deepest_m = -HUGE_VAL;
    for (size_t i = 0; i < r->n; i++) {
        r->depth_m[i] -= r->contact_m;
        r->force_N[i] -= r->zero_N;
        r->deepest_m = fmax(r->deepest_m, r->depth_m[i]);
    }
    size_t i = 0;
    while (i + 1 < r->n && r->depth_m[i] < 2e-3 * r->deepest_m)
        i++;
    r->ramp_start_s = r->time_s[i];
    while (i + 1 < r->n && r->depth_m[i] < 0.998 * r->deepest_m)
        i++;
    r->ramp_end_s = r->time_s[i];
}

/* The longest stretch without motion, or the whole tail: where noise is looked at. */
static size_t still_tail(const palp_recording *r) {
    size_t i = r->n - 1;
    while (i > 0 && fabs(r->depth_m[i - 1] - r->depth_m[r->n - 1]) < 1e-3 * r->deepest_m)
        i--;
    size_t tail = r->n - i;
    return r->n - (tail > 20 ? (tail + 1) / 2 : r->n / 2);
}

/* Residual of a straight line through each of some pieces of the still tail; n_out of them. */
static double *detrended_tail(const palp_recording *r, size_t *n_out) {
    enum { PIECES = 8, MOST = 40000 };
    size_t first = still_tail(r), n = r->n - first;
    if (n > MOST)
        n = MOST;
    double *x = malloc((n + 1) * sizeof *x);
    size_t piece = n / PIECES;
    *n_out = piece * PIECES;
    for (size_t p = 0; x && p < PIECES; p++) {
        const double *f = r->force_N + first + p * piece;
        double middle = 0.5 * (double)(piece - 1), level = mean(f, piece), sxx = 0.0, sxf = 0.0;
        for (size_t i = 0; i < piece; i++) {
            double d = (double)i - middle;
            sxx += d * d;
            sxf += d * (f[i] - level);
        }
        for (size_t i = 0; i < piece; i++)
            x[p * piece + i] = f[i] - level - (sxx > 0.0 ? sxf / sxx : 0.0) * ((double)i - middle);
    }
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

static palp_status look_at_noise(palp_recording *r, double step) {
    size_t n;
    double *x = detrended_tail(r, &n), own = 0.0, next = 0.0;
    if (!x)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n; i++) {
        own += x[i] * x[i];
        next += i ? x[i] * x[i - 1] : 0.0;
    }
    r->correlation = own > 0.0 ? next / own : 0.0;
    if (n >= 200 && step < 1.0 / 135.0 && !r->uneven && own > 0.0)
        for (double f = 45.0; f <= 65.0; f += fmax(0.1, 0.5 / ((double)n * step))) {
            double a = line_amplitude(x, n, f, step);
            if (a > r->hum_N && a > 8.0 * sqrt(own / (double)n) * sqrt(2.0 / (double)n)) {
                r->hum_N = a;
                r->hum_Hz = f;
            }
        }
    free(x);
    return PALP_OK;
}

/* Whether the force grows with depth; a reader of "depth in the wrong sign" gets told. */
static palp_status check_signs(const palp_recording *r, palp_error *error) {
    double md = mean(r->depth_m, r->n), mf = mean(r->force_N, r->n), cov = 0.0, low = r->depth_m[0], high = low,
           strongest = 0.0;
    for (size_t i = 0; i < r->n; i++) {
        cov += (r->depth_m[i] - md) * (r->force_N[i] - mf);
        low = fmin(low, r->depth_m[i]);
        high = fmax(high, r->depth_m[i]);
        strongest = fmax(strongest, fabs(r->force_N[i] - r->force_N[0]));
    }
    if (!(high > low))
        return palp_error_set(error, PALP_ERR_INPUT, "%s: depth_mm never changes: nothing was pressed", r->name);
    if (!(strongest > 6.0 * r->noise_N) || strongest == 0.0)
        return palp_error_set(error, PALP_ERR_INPUT, "%s: force_N never leaves its noise: no contact", r->name);
    if (cov < 0.0)
        return palp_error_set(error, PALP_ERR_INPUT,
                              "%s: force_N grows while depth_mm falls: depth or force has the wrong sign "
                              "(palpate import --negate depth or force)",
                              r->name);
    if (!(high > 0.0))
        return palp_error_set(error, PALP_ERR_INPUT, "%s: depth_mm is never positive: contact was not reached", r->name);
    return PALP_OK;
}

static palp_status prepare(palp_recording *r, const palp_experiment *experiment,
                           const palp_recording_settings *settings, palp_error *error) {
    double step, deepest = 0.0;
    palp_status status = copy_columns(r, experiment);
    if (status)
        return status;
    read_header(r, experiment, settings);
    if (r->n < 16)
        return palp_error_set(error, PALP_ERR_INPUT, "%s: %zu samples are too few", r->name, r->n);
    if (!(r->height_m > 0.0))
        return palp_error_set(error, PALP_ERR_INPUT, "%s: no specimen.height_mm: give --specimen-height-mm", r->name);
    status = look_at_times(r, &step);
    if (!status)
        status = find_noise(r, step);
    if (!status)
        status = check_signs(r, error);
    if (status)
        return status;
    mask_spikes(r, settings->spike_sigma);
    mask_clipped(r, settings->clip_share);
    for (size_t i = 0; i < r->n; i++)
        deepest = fmax(deepest, r->depth_m[i]);
    find_contact(r, settings, deepest);
    shift(r);
    if (!(r->deepest_m > 0.0) || r->deepest_m >= r->height_m)
        return palp_error_set(error, PALP_ERR_INPUT, "%s: deepest point %g mm does not fit a specimen of %g mm", r->name,
                              1e3 * r->deepest_m, 1e3 * r->height_m);
    return look_at_noise(r, step);
}

palp_status palp_recording_prepare(const palp_experiment *experiment, const char *name,
                                   const palp_recording_settings *settings, palp_recording *recording,
                                   palp_error *error) {
    memset(recording, 0, sizeof *recording);
    strncpy(recording->name, name, PALP_NAME_MAX - 1);
    palp_status status = prepare(recording, experiment, settings, error);
    if (status == PALP_ERR_NO_MEMORY)
        palp_error_set(error, status, "%s: out of memory", name);
    if (status)
        palp_recording_free(recording);
    return status;
}
