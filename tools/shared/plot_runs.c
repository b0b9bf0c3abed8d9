/* plot_runs.c: the figures of recordings, and of fits to them. */
#include "plot_runs.h"

#include "cli.h"
#include "json_out.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS = 6000, LEAST_BINS = 60, MOST_BINS = 450, KEY_MAX = 14 };

static const double FIRST_S = 10, LOG_FROM_S = 0.01;

bool run_before(const palp_recording *a, const palp_recording *b) {
    if (a->kind != b->kind)
        return a->kind < b->kind;
    return a->kind == PALP_RECORDING_RAMP_HOLD && a->deepest_m < b->deepest_m;
}

json_t *run_json(const palp_recording *r) {
    static const char *const kinds[] = {"ramp", "ramp_hold", "other", "creep"};
    static const char *const rules[] = {"given", "free air", "nominal"};
    json_t *to = json_object();
    json_object_set_new(to, "file", json_text(r->name));
    json_object_set_new(to, "kind", json_string(kinds[r->kind]));
    json_object_set_new(to, "contact_rule", json_string(rules[r->contact_rule]));
    json_figures(to, {"duration_s", r->time_s[r->n - 1] - r->time_s[0]}, {"rate_Hz", run_rate_Hz(r)},
                 {"height_mm", 1e3 * r->height_m}, {"deepest_mm", 1e3 * r->deepest_m},
                 {"ramp_s", r->ramp_end_s - r->ramp_start_s}, {"contact_mm", 1e3 * r->contact_m},
                 {"contact_sd_mm", 1e3 * r->contact_sd_m}, {"zero_N", r->zero_N}, {"zero_sd_N", r->zero_sd_N},
                 {"noise_N", r->noise_N}, {"correlation", r->correlation}, {"hum_Hz", r->hum_Hz},
                 {"hum_N", r->hum_N}, {"longest_gap_s", r->longest_gap_s});
    json_object_set_new(to, "samples", json_integer((json_int_t)r->n));
    json_object_set_new(to, "missing", json_integer((json_int_t)r->n_missing));
    json_object_set_new(to, "spikes", json_integer((json_int_t)r->n_spikes));
    json_object_set_new(to, "clipped", json_integer((json_int_t)r->n_clipped));
    json_object_set_new(to, "gaps", json_integer((json_int_t)r->n_gaps));
    json_object_set_new(to, "fault", json_boolean(r->faulted));
    json_object_set_new(to, "uneven", json_boolean(r->uneven));
    return to;
}

typedef struct axis {
    bool depth, log;
    double from, to;
    size_t bins;
} axis;

static double abscissa(const palp_recording *r, const axis *a, size_t i) {
    return a->depth ? 1e3 * r->depth_m[i] : r->time_s[i] - r->ramp_start_s;
}

/* Bin of a sample, -1 = not drawn. Bins are equal in time or log time. Over depth they are equal in the
 * number of samples, mixed with the travel of the plate. */
static long bin_of(const palp_recording *r, const axis *a, size_t i, double gone) {
    double x = abscissa(r, a, i), at = 0;
    if (!r->use[i] || x < a->from || x > a->to)
        return -1;
    if (a->depth)
        at = 0.5 * ((double)i / (double)r->n + gone);
    else if (a->log)
        at = log(x / a->from) / log(a->to / a->from);
    else
        at = (x - a->from) / (a->to - a->from);
    return (long)fmin(at * (double)a->bins, (double)a->bins - 1);
}

/* The lowest and the highest sample of each bin, in their order; x and y hold 2 bins numbers. */
static size_t thin(const palp_recording *r, const double *force_N, const axis *a, double *x, double *y) {
    size_t n = 0, low = 0, high = 0;
    long bin = -1;
    double way = 0, gone = 0;
    for (size_t i = 1; i < r->n; i++)
        way += fabs(r->depth_m[i] - r->depth_m[i - 1]);
    for (size_t i = 0; i <= r->n; i++) {
        gone += i > 0 && i < r->n ? fabs(r->depth_m[i] - r->depth_m[i - 1]) : 0;
        long own = i < r->n ? bin_of(r, a, i, gone / way) : -1;
        if (own == bin && own >= 0) {
            low = force_N[i] < force_N[low] ? i : low;
            high = force_N[i] > force_N[high] ? i : high;
            continue;
        }
        for (int k = 0; k < 2 && bin >= 0 && n < 2 * a->bins; k++) {
            size_t at = (k == 0) == (low < high) ? low : high;
            if (k == 0 || low != high) {
                x[n] = abscissa(r, a, at);
                y[n++] = force_N[at];
            }
        }
        low = high = i;
        bin = own;
    }
    return n;
}

typedef struct curves {
    size_t n, used, drawn;
    bool by_depth;
    plot_series *series; /* [3 n] */
    char (*title)[32];   /* [n] */
    double *work;        /* [14 n bins] */
} curves;

static bool curves_create(size_t n, size_t bins, curves *c) {
    *c = (curves){.n = n,
                  .series = calloc(3 * n + 1, sizeof *c->series),
                  .title = calloc(n + 1, sizeof *c->title),
                  .work = calloc(14 * n * bins + 1, sizeof *c->work)};
    return c->series && c->title && c->work;
}

static void curves_free(curves *c) {
    free(c->series);
    free(c->title);
    free(c->work);
}

/* The palette for few runs, a ramp from the first to the last for many. */
static int colour_of(size_t k, size_t n) {
    return n <= 4 ? (int)k : PLOT_SHADE + (int)(999 * k / (n - 1));
}

/* Of many runs every so many is named in the key. */
static bool named(size_t k, size_t n) {
    size_t every = (n + KEY_MAX - 1) / KEY_MAX;
    return every <= 1 || k % every == 0;
}

/* Ramp and hold by their depths, where these tell all of them apart. */
static bool depths_differ(size_t n, const run_curve *run) {
    for (size_t k = 0; k < n; k++) {
        const palp_recording *r = run[k].recording;
        if (r->kind != PALP_RECORDING_RAMP_HOLD ||
            (k > 0 && fabs(r->deepest_m - run[k - 1].recording->deepest_m) < 0.02 * r->deepest_m))
            return false;
    }
    return true;
}

static void name_curve(const run_curve *run, bool by_depth, char title[32]) {
    if (by_depth)
        snprintf(title, 32, "%.3g mm", 1e3 * run->recording->deepest_m);
    else {
        const char *name = cli_base(run->recording->name), *dot = strrchr(name, '.');
        int n = dot && dot > name ? (int)(dot - name) : (int)strlen(name), from = n > 24 ? n - 24 : 0;
        snprintf(title, 32, "%s%.*s", from ? ".." : "", n - from,
                 name + from); /* names differ at their ends */
    }
}

/* Where the fit's force may lie, behind the curves. */
static void add_band(curves *c, const run_curve *run, size_t k, const axis *a) {
    const palp_recording *r = run->recording;
    double *x = c->work + 8 * a->bins * c->n + 6 * a->bins * k, *low = x + 2 * a->bins,
           *high = low + 2 * a->bins;
    size_t n = 0, every = r->n / (2 * a->bins) + 1;
    for (size_t i = 0; i < r->n; i += every) {
        if (bin_of(r, a, i, 0) >= 0 && isfinite(run->band_N[i]) && isfinite(run->band_N[r->n + i])) {
            x[n] = abscissa(r, a, i);
            low[n] = run->band_N[i];
            high[n++] = run->band_N[r->n + i];
        }
    }
    memmove(low + n, high, n * sizeof *high);
    c->series[c->used++] =
        (plot_series){k == 0 ? "95 % band" : NULL, PLOT_BAND, colour_of(k, c->n), n, x, low};
}

static void add_curve(curves *c, const run_curve *run, size_t k, const axis *a, const double *force_N,
                      plot_style style, bool key) {
    double *x = c->work + 4 * a->bins * c->drawn++, *y = x + 2 * a->bins;
    size_t n = thin(run->recording, force_N, a, x, y);
    name_curve(run, c->by_depth, c->title[k]);
    c->series[c->used++] =
        (plot_series){key && named(k, c->n) ? c->title[k] : NULL, style, colour_of(k, c->n), n, x, y};
}

/* Raw curves behind, then what is made of them. */
static void draw_curves(json_t *figures, const char *name, const char *title, size_t n, const run_curve *run,
                        axis a, bool fit) {
    curves c;
    a.bins = (size_t)fmin(fmax((double)POINTS / (double)(2 * n), LEAST_BINS), MOST_BINS);
    if (curves_create(n, a.bins, &c)) {
        c.by_depth = depths_differ(n, run);
        for (size_t k = 0; k < n; k++)
            if (fit && run[k].band_N && (!a.depth || run[k].recording->kind == PALP_RECORDING_STATIC))
                add_band(&c, &run[k], k, &a);
        for (size_t k = 0; k < n; k++) { /* raw samples that nothing lies over are the line */
            const double *over = fit ? run[k].fit_N : run[k].filtered_N;
            add_curve(&c, &run[k], k, &a, run[k].recording->force_N, over ? PLOT_PALE : PLOT_LINE, !over);
        }
        for (size_t k = 0; k < n; k++) {
            const double *over = fit ? run[k].fit_N : run[k].filtered_N;
            if (over)
                add_curve(&c, &run[k], k, &a, over, PLOT_LINE, true);
        }
        const plot_figure figure = {
            .title = title,
            .n_panels = 1,
            .panel = {{.x_label = a.depth ? "depth (mm)" : "time from the start of the ramp (s)",
                       .y_label = "force (N)",
                       .x_log = a.log,
                       .n_series = c.used,
                       .series = c.series}}};
        plot_draw(figures, name, &figure);
    }
    curves_free(&c);
}

static double longest_s(size_t n, const run_curve *run) {
    double end = 0;
    for (size_t k = 0; k < n; k++) {
        const palp_recording *r = run[k].recording;
        end = fmax(end, r->time_s[r->n - 1] - r->ramp_start_s);
    }
    return end;
}

void plot_runs_time(json_t *figures, const char *name, const char *title, size_t n, const run_curve *run,
                    plot_time time, bool fit) {
    double end = longest_s(n, run);
    axis a = {false, time == PLOT_TIME_LOG,
              time == PLOT_TIME_LOG ? fmin(LOG_FROM_S, 0.01 * end) : -0.05 * end, end, 0};
    if (time == PLOT_TIME_FIRST) {
        a.to = fmin(FIRST_S, end);
        a.from = -0.05 * a.to;
    }
    draw_curves(figures, name, title, n, run, a, fit);
}

void plot_runs_depth(json_t *figures, const char *name, const char *title, size_t n, const run_curve *run,
                     bool fit) {
    const double AIR = 0.1; /* of the depth, before contact */
    double deepest = 0;
    for (size_t k = 0; k < n; k++)
        deepest = fmax(deepest, 1e3 * run[k].recording->deepest_m);
    draw_curves(figures, name, title, n, run, (axis){true, false, -AIR * deepest, HUGE_VAL, 0}, fit);
}

/* Means of fit minus measured over noise in bins of log time. */
static size_t bin_means(const run_curve *run, const axis *a, double *x, double *y) {
    const palp_recording *r = run->recording;
    double sum = 0, sum_x = 0, count = 0;
    size_t n = 0;
    long bin = -1;
    for (size_t i = 0; i <= r->n; i++) {
        long own = i < r->n ? bin_of(r, a, i, 0) : -1;
        if (own != bin && count > 0) {
            x[n] = sum_x / count;
            y[n++] = sum / count / r->noise_N;
            sum = sum_x = count = 0;
        }
        bin = own;
        if (own >= 0) {
            sum += run->fit_N[i] - r->force_N[i];
            sum_x += abscissa(r, a, i);
            count++;
        }
    }
    return n;
}

static void plot_residual(json_t *figures, const char *name, const char *title, size_t n,
                          const run_curve *run) {
    enum { BINS = 120 };
    double end = longest_s(n, run);
    const axis a = {false, true, fmin(LOG_FROM_S, 0.01 * end), end, BINS};
    curves c;
    if (!curves_create(n, BINS, &c)) {
        curves_free(&c);
        return;
    }
    for (size_t k = 0; k < n; k++) {
        if (run[k].fit_N && run[k].recording->noise_N > 0) {
            double *x = c.work + 4 * BINS * c.used, *y = x + 2 * BINS;
            size_t points = bin_means(&run[k], &a, x, y);
            name_curve(&run[k], depths_differ(n, run), c.title[k]);
            c.series[c.used++] =
                (plot_series){named(k, n) ? c.title[k] : NULL, PLOT_LINE, colour_of(k, n), points, x, y};
        }
    }
    const plot_figure figure = {.title = title,
                                .n_panels = 1,
                                .panel = {{.x_label = "time from the start of the ramp (s)",
                                           .y_label = "(fit - measured) / noise",
                                           .x_log = true,
                                           .n_series = c.used,
                                           .series = c.series}}};
    if (c.used > 0)
        plot_draw(figures, name, &figure);
    curves_free(&c);
}

/* ---- what is drawn of recordings and of a fit to them ---- */

void plot_runs_recorded(json_t *figures, size_t n, const run_curve *run) {
    static const char title[] = "Recordings: raw (light) and filtered (dark)";
    plot_runs_time(figures, "recordings_linear", title, n, run, PLOT_TIME_LINEAR, false);
    plot_runs_time(figures, "recordings_log", title, n, run, PLOT_TIME_LOG, false);
    plot_runs_time(figures, "recordings_first", title, n, run, PLOT_TIME_FIRST, false);
}

void plot_runs_fitted(json_t *figures, size_t n, const run_curve *run) {
    static const char title[] = "Recordings (light) and the lumped model (dark)";
    plot_runs_time(figures, "fit_linear", title, n, run, PLOT_TIME_LINEAR, true);
    plot_runs_time(figures, "fit_log", title, n, run, PLOT_TIME_LOG, true);
    plot_runs_time(figures, "fit_first", title, n, run, PLOT_TIME_FIRST, true);
    plot_runs_depth(figures, "fit_depth", title, n, run, true);
    plot_residual(figures, "residuals", "Residuals of the lumped model", n, run);
}

/* Of the first stretch without a gap. */
double run_rate_Hz(const palp_recording *r) {
    double step = r->time_s[1] - r->time_s[0];
    size_t i = 1;
    while (i + 1 < r->n && r->time_s[i + 1] - r->time_s[i] < 3 * step)
        i++;
    return (double)i / (r->time_s[i] - r->time_s[0]);
}

double run_cutoff_Hz(const palp_recording *r) {
    return fmin(10, 0.2 * run_rate_Hz(r));
}

double *run_filter(const palp_recording *r, double cutoff_Hz) {
    enum { FEWEST = 16 };
    double *out = r->uneven ? NULL : malloc(r->n * sizeof *out), *in = out ? malloc(r->n * sizeof *in) : NULL;
    double dt = 1 / run_rate_Hz(r);
    for (size_t i = 0; in && i < r->n; i++) { /* a masked sample repeats the one before */
        in[i] = r->use[i] || i == 0 ? r->force_N[i] : in[i - 1];
        out[i] = in[i];
    }
    for (size_t from = 0, to; in && from < r->n; from = to) {
        for (to = from + 1; to < r->n && r->time_s[to] - r->time_s[to - 1] < 3 * dt; to++) {
        }
        if (to - from >= FEWEST &&
            palp_filter_zero_phase(to - from, in + from, dt, RUN_FILTER_ORDER, cutoff_Hz, out + from)) {
            free(out);
            out = NULL;
            break;
        }
    }
    if (!in) {
        free(out);
        out = NULL;
    }
    free(in);
    return out;
}
