/* explain_diagnostics.c: diagnostics of the residual with the effects: its correlation from sample to sample,
 * lines, steps, and the part that a smooth curve could remove. */
#include "base/statistics.h"
#include "explain_result.h"
#include "explain_lines.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- from sample to sample ---- */

typedef struct order {
    double plus, minus, runs, square, product;
    double last; /* 0 = the sample before was not of this stretch */
} order;

static void order_add(order *o, double x) {
    if (x > 0.0)
        o->plus += 1.0;
    else
        o->minus += 1.0;
    o->runs += o->last == 0.0 || (x > 0.0) != (o->last > 0.0);
    o->square += x * x;
    o->product += x * o->last;
    o->last = x;
}

/* Wald and Wolfowitz. */
static double runs_z(const order *o) {
    double n = o->plus + o->minus, pairs = 2.0 * o->plus * o->minus;
    double variance = pairs * (pairs - n) / (n * n * (n - 1.0));
    return variance > 0.0 ? (o->runs - pairs / n - 1.0) / sqrt(variance) : 0.0;
}

static void find_order(const explain_data *data, palp_explanation *e) {
    for (size_t w = 0; w < e->n_phase_shares; w++) {
        const explain_run *run = &data->run[e->phase_share[w].run];
        order o = {.last = 0.0};
        for (size_t i = 0; i < run->n; i++)
            if (run->phase[i] == e->phase_share[w].phase && run->use[i])
                order_add(&o, e->run[e->phase_share[w].run].after_N[i]);
            else
                o.last = 0.0;
        e->phase_share[w].lag1 = o.square > 0.0 ? o.product / o.square : 0.0;
        e->phase_share[w].runs_z = runs_z(&o);
    }
}

/* ---- free curves ---- */

enum { BINS = 24 };

/* rms of the means of y in bins of x from low to high, less that of white noise. */
typedef struct curve {
    double low, high, sum[BINS], count[BINS], square, n;
} curve;

static void curve_add(curve *c, double x, double y) {
    double place = c->high > c->low ? BINS * (x - c->low) / (c->high - c->low) : 0.0;
    size_t k = (size_t)fmax(0.0, fmin(BINS - 1, floor(place)));
    c->sum[k] += y;
    c->count[k] += 1.0;
    c->square += y * y;
    c->n += 1.0;
}

static double curve_rms(const curve *c) {
    double square = 0.0, used = 0.0;
    for (size_t k = 0; k < BINS; k++)
        if (c->count[k] > 0.0) {
            square += c->sum[k] * c->sum[k] / c->count[k];
            used += 1.0;
        }
    if (!(c->n > used))
        return 0.0;
    double noise = (c->square - square) / (c->n - used);
    return sqrt(fmax(0.0, square - used * noise) / c->n);
}

static void find_curves(const explain_data *data, palp_explanation *e) {
    const double soon = data->step, slow = 1e-4 * data->fastest;
    curve depth = {.high = data->deepest}, time = {.low = log(soon), .high = log(data->duration + soon)},
          rate = {.low = -8.0, .high = 8.0};
    for (size_t r = 0; r < e->n_runs; r++) {
        const explain_run *run = &data->run[r];
        for (size_t i = 0; i < run->n; i++) {
            size_t a = i ? i - 1 : 0, b = i + 1 < run->n ? i + 1 : i;
            double speed = (run->depth[b] - run->depth[a]) / (run->time[b] - run->time[a]),
                   y = e->run[r].after_N[i];
            if (!run->use[i])
                continue;
            curve_add(&depth, run->depth[i], y);
            curve_add(&time, log(run->time[i] - run->time[0] + soon), y);
            curve_add(&rate, copysign(2.0 * log10(1.0 + fabs(speed) / slow), speed), y);
        }
    }
    e->diagnostics.by_depth_N = curve_rms(&depth);
    e->diagnostics.by_time_N = curve_rms(&time);
    e->diagnostics.by_rate_N = curve_rms(&rate);
}

/* ---- steps that stay ---- */

/* The means of two stretches before and two after a sample: a step lies between, and none within either side.
 */
static palp_status find_slips(explain_data *data, size_t r, const double *y) {
    enum { HALF = 12 };
    const explain_run *run = &data->run[r];
    double least = 8.0 * run->white;
    palp_status status = PALP_OK;
    for (size_t i = 2 * HALF; i + 2 * HALF < run->n && !status; i++) {
        double a = statistics_mean(y + i - 2 * HALF, HALF), b = statistics_mean(y + i - HALF, HALF);
        double c = statistics_mean(y + i + 1, HALF), d = statistics_mean(y + i + 1 + HALF, HALF),
               step = c - b;
        bool sudden = fabs(y[i + 1] - y[i - 1]) > 0.7 * fabs(step);
        if (!(fabs(step) > least && sudden && fabs(b - a) < 0.25 * fabs(step) &&
              fabs(d - c) < 0.25 * fabs(step)))
            continue;
        status = explain_event_add(data, &(palp_explain_event){.run = r,
                                                               .samples = 1,
                                                               .from_s = run->time[i - 1],
                                                               .to_s = run->time[i + 1],
                                                               .size_N = step,
                                                               .kind = "slip"});
        i += 2 * HALF;
    }
    return status;
}

palp_status explain_diagnostics_find(explain_data *data, const double *residual, palp_explanation *e) {
    palp_status status = PALP_OK;
    find_order(data, e);
    find_curves(data, e);
    for (size_t r = 0, at = 0; r < data->n_runs && !status; at += data->run[r++].n)
        status = find_slips(data, r, residual + at);
    if (!status)
        status = explain_peak_in_time(data, residual, &e->diagnostics.in_time);
    return status ? status : explain_peak_in_depth(data, residual, &e->diagnostics.in_depth);
}
