/* explain_lines.c: periodic residuals: over time (the mains) and over depth (the drive). */
#include "explain_lines.h"
#include "base/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double TURN = 6.28318530717958647692;

typedef struct line {
    double x, power, cosine, sine;
} line;

/* Least squares of cosine and sine; power: reduction of the sum of squares. */
static line fit_line(size_t n, const double *at, const double *y, double x) {
    double cc = 0.0, ss = 0.0, cs = 0.0, yc = 0.0, ys = 0.0;
    for (size_t i = 0; i < n; i++) {
        double c = cos(TURN * x * at[i]), s = sin(TURN * x * at[i]);
        cc += c * c;
        ss += s * s;
        cs += c * s;
        yc += c * y[i];
        ys += s * y[i];
    }
    double det = cc * ss - cs * cs;
    if (!(det > 1e-6 * cc * ss))
        return (line){.x = x};
    line l = {.x = x, .cosine = (yc * ss - ys * cs) / det, .sine = (ys * cc - yc * cs) / det};
    l.power = l.cosine * yc + l.sine * ys;
    return l;
}

/* ---- over time ---- */

/* Power of y, in units of the noise, at a frequency in stretches of some seconds, each with a phase of its
 * own. */
static double power_at(const explain_data *data, const double *y, double frequency, double stretch) {
    double power = 0.0;
    for (size_t r = 0; r < data->n_runs; r++) {
        const explain_run *run = &data->run[r];
        double re = 0.0, im = 0.0, c = 1.0, s = 0.0, step = 0.0, cs = 1.0, sn = 0.0, start = run->time[0];
        size_t count = 0;
        for (size_t i = 0; i < run->n; i++) {
            double dt = i ? run->time[i] - run->time[i - 1] : 0.0;
            if (fabs(dt - step) > 1e-6 * dt) {
                step = dt;
                cs = cos(TURN * frequency * dt);
                sn = sin(TURN * frequency * dt);
            }
            double turned = c * cs - s * sn;
            s = s * cs + c * sn;
            c = turned;
            if (run->time[i] - start > stretch) {
                power += (re * re + im * im) / (double)(count + 1);
                start = run->time[i];
                re = im = 0.0;
                count = 0;
            }
            re += c * y[i];
            im += s * y[i];
            count++;
        }
        power += (re * re + im * im) / (double)(count + 1);
        y += run->n;
    }
    return power;
}

enum { GRID = EXPLAIN_FREQUENCIES, OUTSTANDING = 3, OUTSTANDING_ALIAS = 10 }; /* times the typical power */
static const double LOWEST = EXPLAIN_LINE_LOWEST, HIGHEST = EXPLAIN_LINE_HIGHEST;
static const double PERIODS =
    10.0; /* of the lowest: the band then has the widths of seven lines, and a typical power */
static const double NYQUIST =
    140.0; /* samples a second: with fewer the mains are seen as an alias, as other lines are */

bool explain_line_visible(const explain_data *data) {
    const effect_data facts = explain_facts(data);
    char lack[EFFECT_LACK_MAX];
    return effect_need_met(effect_row_of(effect_line()), &facts, lack);
}

bool explain_line_resolved(const explain_data *data) {
    return data->duration * LOWEST >= PERIODS;
}

palp_status explain_line_in_time(const explain_data *data, const double *residual, double *frequency,
                                 double *amplitude) {
    if (!explain_line_visible(data))
        return PALP_ERR_UNSUPPORTED;
    double *y = malloc(data->n * sizeof *y), best = 0.0, white = 0.0;
    if (!y)
        return PALP_ERR_NO_MEMORY;
    memcpy(y, residual, data->n * sizeof *y);
    for (size_t r = 0, at = 0; r < data->n_runs; at += data->run[r++].n) {
        const explain_run *run = &data->run[r];
        for (size_t i = 0; i < run->n; i++)
            y[at + i] *= !run->use[i] ? 0.0 : run->white > 0.0 ? 1.0 / run->white : 1.0;
        white += run->white / (double)data->n_runs;
    }
    double power[GRID], typical, centre = 50.0;
    for (int k = 0; k < GRID; k++) { /* stretches of 10 s are 0.1 Hz wide */
        power[k] = power_at(data, y, LOWEST + 0.05 * k, 10.0);
        if (power[k] > best) {
            best = power[k];
            centre = LOWEST + 0.05 * k;
        }
    }
    typical = statistics_median(power, GRID);
    const bool stands_out = !explain_line_resolved(data) ||
                            best > (data->shown.rate < NYQUIST ? OUTSTANDING_ALIAS : OUTSTANDING) * typical,
               within = centre > LOWEST && centre < HIGHEST;
    best = 0.0;
    for (int k = -40; k <= 40; k++) {
        double f = fmin(HIGHEST, fmax(LOWEST, centre + 0.0015 * k)), there = power_at(data, y, f, 1e9);
        if (there > best) {
            best = there;
            *frequency = f;
        }
    }
    *amplitude = 2.0 * white * sqrt(best / (double)data->n);
    free(y);
    return stands_out && within ? PALP_OK : PALP_ERR_UNSUPPORTED;
}

/* ---- over depth ---- */

/* [data->n] each: every so-many-th sample. */
typedef struct thinned {
    size_t n;
    double *depth, *y, low, high;
} thinned;

static palp_status thin(const explain_data *data, const double *residual, thinned *t) {
    enum { MOST = 6000 };
    size_t stride = data->n / MOST + 1;
    *t = (thinned){.low = HUGE_VAL, .high = -HUGE_VAL};
    t->depth = malloc(2 * (data->n / stride + 1) * sizeof *t->depth);
    if (!t->depth)
        return PALP_ERR_NO_MEMORY;
    t->y = t->depth + data->n / stride + 1;
    for (size_t r = 0, at = 0; r < data->n_runs; at += data->run[r++].n)
        for (size_t i = 0; i < data->run[r].n; i++)
            if ((at + i) % stride == 0) {
                t->depth[t->n] = data->run[r].depth[i];
                t->low = fmin(t->low, t->depth[t->n]);
                t->high = fmax(t->high, t->depth[t->n]);
                t->y[t->n++] = residual[at + i];
            }
    return PALP_OK;
}

palp_status explain_line_in_depth(const explain_data *data, const double *residual, double *period,
                                  double *amplitude, double *phase) {
    thinned t;
    palp_status status = thin(data, residual, &t);
    if (status)
        return status;
    line best = {.x = 0.0};
    double shortest = (t.high - t.low) / 120.0, step = 0.2 / (t.high - t.low);
    for (double x = (double)EXPLAIN_PERIODS / (t.high - t.low); x < 1.0 / shortest; x += step) {
        line l = fit_line(t.n, t.depth, t.y, x);
        if (l.power > best.power)
            best = l;
    }
    for (int round = 0; round < 4; round++) {
        step *= 0.4;
        for (int k = -1; k <= 1; k += 2) {
            line l = fit_line(t.n, t.depth, t.y, best.x + k * step);
            if (l.power > best.power)
                best = l;
        }
    }
    *period = best.x > 0.0 ? 1.0 / best.x : 0.1 * (t.high - t.low);
    *amplitude = hypot(best.cosine, best.sine);
    *phase = atan2(best.cosine, best.sine);
    free(t.depth);
    return PALP_OK;
}

/* ---- peaks of the residual ---- */

palp_status explain_peak_in_depth(const explain_data *data, const double *residual, palp_explain_peak *peak) {
    enum { FREQUENCIES = 600 };
    double power[FREQUENCIES];
    thinned t;
    palp_status status = thin(data, residual, &t);
    line best = {.x = 0.0};
    if (status)
        return status;
    for (int k = 0; k < FREQUENCIES; k++) {
        line l = fit_line(t.n, t.depth, t.y, (1.5 + 0.2 * k) / (t.high - t.low));
        power[k] = l.power;
        if (l.power > best.power)
            best = l;
    }
    double typical = statistics_median(power, FREQUENCIES);
    *peak = (palp_explain_peak){.at = best.x > 0.0 ? 1.0 / best.x : 0.0,
                                .amplitude_N = hypot(best.cosine, best.sine),
                                .prominence = typical > 0.0 ? best.power / typical : 0.0};
    free(t.depth);
    return PALP_OK;
}

/* Takes the mean off every stretch of power_at, which would leak into slow waves. */
static void take_off_means(const explain_run *run, double *y, double stretch) {
    for (size_t from = 0, i = 0; from < run->n; from = i) {
        double mean = 0.0;
        for (i = from; i < run->n && run->time[i] - run->time[from] <= stretch; i++)
            mean += y[i];
        mean /= (double)(i - from);
        for (size_t k = from; k < i; k++)
            y[k] -= mean;
    }
}

palp_status explain_peak_in_time(const explain_data *data, const double *residual, palp_explain_peak *peak) {
    enum { FREQUENCIES = 200 };
    double power[FREQUENCIES], best = 0.0, fastest = 0.45 * data->shown.rate, slowest = 6.0 / data->duration;
    const double stretch = 0.25 * data->duration;
    double *y = malloc(data->n * sizeof *y);
    *peak = (palp_explain_peak){.at = 0.0};
    if (!y)
        return PALP_ERR_NO_MEMORY;
    memcpy(y, residual, data->n * sizeof *y);
    for (size_t r = 0, at = 0; r < data->n_runs; at += data->run[r++].n)
        take_off_means(&data->run[r], y + at, stretch);
    for (int k = 0; k < FREQUENCIES && fastest > slowest; k++) {
        double f = slowest * pow(fastest / slowest, (double)k / (FREQUENCIES - 1));
        power[k] = power_at(data, y, f, stretch);
        if (power[k] > best) {
            best = power[k];
            peak->at = f;
        }
    }
    double typical = fastest > slowest ? statistics_median(power, FREQUENCIES) : 0.0;
    peak->amplitude_N = 2.0 * sqrt(best / (double)data->n);
    peak->prominence = typical > 0.0 ? best / typical : 0.0;
    free(y);
    return PALP_OK;
}
