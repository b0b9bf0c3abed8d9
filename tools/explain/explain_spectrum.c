/* explain_spectrum.c: amplitudes of waves in recorded minus model, over time and over depth. A wave is fitted
 * in stretches of so many of its periods, each with a mean and a phase of its own. */
#include "explain.h"
#include "shared/json_out.h"

#include <math.h>

enum { WAVES_MAX = 256, SAMPLES = 20000 }; /* about so many samples are used for each wave */

static const double TURN = 6.28318530717958647692;

/* Waves from low to high cycles per second or mm, each ratio times the last, in stretches of so many cycles.
 */
typedef struct band {
    double low, high, ratio, cycles;
    bool over_depth;
} band;

typedef struct stretch {
    const palp_explain_run *run;
    size_t from, to;
} stretch;

static double x_of(const palp_explain_run *run, size_t i, const band *l) {
    return l->over_depth ? 1e3 * run->depth_m[i] : run->time_s[i];
}

/* From sample s->from one way over a length; false if it turns or ends before that, at s->to. */
static bool find_end(stretch *s, double length, const band *l) {
    double start = x_of(s->run, s->from, l), furthest = 0;
    for (s->to = s->from + 1; s->to < s->run->n; s->to++) {
        double way = x_of(s->run, s->to, l) - start;
        if (fabs(way) >= length)
            return true;
        if (fabs(way - furthest) > 0.25 * length / l->cycles && fabs(way) < fabs(furthest))
            return false;
        furthest = fabs(way) > fabs(furthest) ? way : furthest;
    }
    return false;
}

/* Adds the squared amplitudes of a wave; a sample counts with its step of x, and less near the ends. */
static void add_squares(const stretch *s, double cycles_per_x, const band *l, double square[2]) {
    const double *y[2] = {s->run->before_N, s->run->after_N};
    double start = x_of(s->run, s->from, l), length = fabs(x_of(s->run, s->to, l) - start);
    double sum = 0, c1 = 0, s1 = 0, mean[2] = {0}, re[2] = {0}, im[2] = {0};
    for (size_t i = s->from + 1; i <= s->to; i++) {
        double x = x_of(s->run, i, l), step = fabs(x - x_of(s->run, i - 1, l)), turn = TURN * (x - start);
        double weight = step * (1 - cos(turn / length)), c = weight * cos(cycles_per_x * turn),
               sine = weight * sin(cycles_per_x * turn);
        sum += weight;
        c1 += c;
        s1 += sine;
        for (int k = 0; k < 2; k++) {
            mean[k] += weight * y[k][i];
            re[k] += c * y[k][i];
            im[k] += sine * y[k][i];
        }
    }
    for (int k = 0; k < 2 && sum > 0; k++) {
        double a = (re[k] - c1 * mean[k] / sum) / sum, b = (im[k] - s1 * mean[k] / sum) / sum;
        square[k] += 4 * (a * a + b * b);
    }
}

/* rms over the stretches of all runs; NAN if there is none. */
static void amplitudes(const palp_explanation *e, const band *l, double cycles_per_x, size_t stride,
                       double amplitude[2]) {
    double square[2] = {0}, length = l->cycles / cycles_per_x;
    size_t n = 0, seen = 0;
    for (size_t r = 0; r < e->n_runs; r++) {
        stretch s = {.run = &e->run[r]};
        for (; s.from + 1 < s.run->n; s.from = s.to) {
            if (find_end(&s, length, l) && s.to - s.from >= (size_t)(3 * l->cycles) && seen++ % stride == 0) {
                add_squares(&s, cycles_per_x, l, square);
                n++;
            }
        }
    }
    for (int k = 0; k < 2; k++)
        amplitude[k] = n ? sqrt(square[k] / (double)n) : NAN;
}

static json_t *spectrum(const palp_explanation *e, const band *l, const char *key) {
    double x[WAVES_MAX], before[WAVES_MAX], after[WAVES_MAX], amplitude[2];
    size_t n = 0, samples = 0;
    for (size_t r = 0; r < e->n_runs; r++)
        samples += e->run[r].n;
    for (double w = l->low; w <= l->high && n < WAVES_MAX; w *= l->ratio) {
        amplitudes(e, l, w, 1 + samples / SAMPLES, amplitude);
        if (isfinite(amplitude[0]) && isfinite(amplitude[1])) {
            x[n] = l->over_depth ? 1 / w : w;
            before[n] = amplitude[0];
            after[n++] = amplitude[1];
        }
    }
    return json_pack("{s:o, s:o, s:o}", key, json_numbers(n, x), "before_N", json_numbers(n, before),
                     "after_N", json_numbers(n, after));
}

json_t *explain_spectrum(const palp_explanation *e) {
    double fastest = 0, longest = 0, shallow = 0, deep = 0;
    for (size_t r = 0; r < e->n_runs; r++) {
        const palp_explain_run *run = &e->run[r];
        double seconds = run->time_s[run->n - 1] - run->time_s[0];
        longest = fmax(longest, seconds);
        fastest = fmax(fastest, (double)(run->n - 1) / seconds);
        for (size_t i = 0; i < run->n; i++) {
            shallow = fmin(shallow, 1e3 * run->depth_m[i]);
            deep = fmax(deep, 1e3 * run->depth_m[i]);
        }
    }
    band in_time = {12 / longest, fastest / 3, 1.06, 12, false},
         in_depth = {4 / (deep - shallow), 200 / (deep - shallow), 1.06, 3, true};
    return json_pack("{s:o, s:o}", "time", spectrum(e, &in_time, "frequency_Hz"), "depth",
                     spectrum(e, &in_depth, "period_mm"));
}
