/* test_explain_noise.c: white noise, lines and diagnostics of residuals that are known. */
#include "base/dense.h"
#include "explain/explain_lines.h"
#include "explain/explain_result.h"
#include "explain/explain_fit.h"

#include <check.h>
#include <math.h>
#include <palpate/random.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 12000, RUNS = 3 };

static const double TURN = 6.28318530717958647692;

static explain_run run[RUNS];
static explain_data data;
static double block[RUNS][3 * MOST], residual[RUNS * MOST];
static unsigned char use[RUNS][2 * MOST];

/* Runs of n samples each, some in the air, evenly dt apart, at rest. */
static void begin(size_t n_runs, size_t n, double dt) {
    data = (explain_data){.n_runs = n_runs,
                          .n = n_runs * n,
                          .longest = n,
                          .run = run,
                          .peak = 1,
                          .deepest = 5e-3,
                          .height = 0.024,
                          .step = dt,
                          .duration = (double)n * dt,
                          .shown = {.rate = 1 / dt}};
    for (size_t r = 0; r < n_runs; r++) {
        double *b = block[r];
        run[r] = (explain_run){.n = n,
                               .time = b,
                               .depth = b + n,
                               .force = b + 2 * n,
                               .use = use[r],
                               .phase = use[r] + n,
                               .white = 1};
        memset(use[r], 1, n);
        memset(use[r] + n, PALP_PHASE_RAMP, n);
        for (size_t i = 0; i < n; i++) {
            run[r].time[i] = dt * (double)i;
            run[r].depth[i] = 2e-3;
            run[r].force[i] = 0;
        }
    }
}

/* White noise and one that fades with time, into the residual of a run. */
static void make_noise(const explain_run *of, double white, double correlated, double time, double *to) {
    static uint64_t state = 3;
    double wander = correlated * palp_random_normal(&state);
    for (size_t i = 0; i < of->n; i++) {
        double fade = i ? exp(-(of->time[i] - of->time[i - 1]) / time) : 0;
        wander =
            fade * wander + sqrt(1 - fade * fade) * (i ? correlated * palp_random_normal(&state) : wander);
        to[i] = wander + white * palp_random_normal(&state);
    }
}

/* ---- noise ---- */

/* A sensor that reads no more than 1: six samples of ten are there, without noise. */
START_TEST(the_end_of_a_sensor_is_no_silence) {
    begin(1, 4000, 0.01);
    make_noise(run, 2e-3, 0, 1, residual);
    for (size_t i = 0; i < 4000; i++) {
        const double force = i % 1000 < 400 ? 2e-3 * (double)(i % 1000) + residual[i] : 1;
        residual[i] = i % 1000 < 400 ? residual[i] : 0;
        run->force[i] = force;
    }
    ck_assert_int_eq(explain_white_noise(run, residual), PALP_OK);
    ck_assert_double_eq_tol(run->white, 2e-3, 3e-4);
    memset(run->force, 0, 4000 * sizeof *run->force); /* nothing else is there */
    make_noise(run, 2e-3, 0, 1, residual);
    ck_assert_int_eq(explain_white_noise(run, residual), PALP_OK);
    ck_assert_double_eq_tol(run->white, 2e-3, 1.5e-4);
}
END_TEST

/* ---- lines ---- */

START_TEST(the_mains_over_time) {
    double frequency, amplitude;
    begin(2, 6000, 0.005);
    for (size_t k = 0; k < 2 * 6000; k++) /* another phase in each run */
        residual[k] = 0.02 * sin(TURN * 50.03 * run->time[k % 6000] + (k < 6000 ? 0.4 : 2.0));
    run[0].white = run[1].white = 0.01;
    ck_assert_int_eq(explain_line_in_time(&data, residual, &frequency, &amplitude), PALP_OK);
    ck_assert_double_eq_tol(frequency, 50.03, 1.6e-3);
    ck_assert_double_eq_tol(amplitude, 0.02, 4e-4);
    make_noise(run, 0.01, 0, 1, residual);
    make_noise(run, 0.01, 0, 1, residual + 6000);
    ck_assert_int_eq(explain_line_in_time(&data, residual, &frequency, &amplitude), PALP_ERR_UNSUPPORTED);
}
END_TEST

/* From three periods on the mains may be asked for, from ten on they must stand out; what is strongest
 * outside their band is no line of theirs. */
START_TEST(the_mains_need_three_periods) {
    double frequency = 0, amplitude;
    begin(2, 300, 0.001);
    ck_assert(explain_line_resolved(&data));
    begin(2, 70, 0.001);
    ck_assert(!explain_line_visible(&data));
    begin(2, 200, 0.001);
    ck_assert(explain_line_visible(&data) && !explain_line_resolved(&data));
    for (size_t k = 0; k < 2 * 200; k++)
        residual[k] = sin(TURN * 50.0 * run->time[k % 200]);
    ck_assert_int_eq(explain_line_in_time(&data, residual, &frequency, &amplitude), PALP_OK);
    ck_assert_double_eq_tol(frequency, 50.0, 0.1);
    ck_assert_double_eq_tol(amplitude, 1.0, 0.01);
    for (size_t k = 0; k < 2 * 200; k++)
        residual[k] = sin(TURN * 37.0 * run->time[k % 200]);
    ck_assert_int_eq(explain_line_in_time(&data, residual, &frequency, &amplitude), PALP_ERR_UNSUPPORTED);
}
END_TEST

START_TEST(a_wave_over_depth) {
    double period, amplitude, phase;
    palp_explain_peak peak;
    begin(1, 4000, 0.01);
    for (size_t i = 0; i < 4000; i++) {
        run->depth[i] = 6e-3 * (double)i / 3999;
        residual[i] = 0.03 * sin(TURN * run->depth[i] / 0.75e-3 + 0.9);
    }
    ck_assert_int_eq(explain_line_in_depth(&data, residual, &period, &amplitude, &phase), PALP_OK);
    ck_assert_double_eq_tol(period, 0.75e-3, 2e-6);
    ck_assert_double_eq_tol(amplitude, 0.03, 3e-4);
    ck_assert_double_eq_tol(phase, 0.9, 0.05);
    ck_assert_int_eq(explain_peak_in_depth(&data, residual, &peak), PALP_OK);
    ck_assert_double_eq_tol(peak.at, 0.75e-3, 1e-5);
    ck_assert_double_eq_tol(peak.amplitude_N, 0.03, 1e-3);
    ck_assert_double_gt(peak.prominence, 100);
}
END_TEST

START_TEST(a_wave_over_time) {
    palp_explain_peak peak;
    begin(1, 4000, 0.01);
    double f = 0.15 * pow(300.0, 90.0 / 199.0); /* one of those that are tried */
    for (size_t i = 0; i < 4000; i++)
        residual[i] = 0.03 * cos(TURN * f * run->time[i]) + 0.5;
    ck_assert_int_eq(explain_peak_in_time(&data, residual, &peak), PALP_OK);
    ck_assert_double_eq_tol(peak.at, f, 1e-9);
    ck_assert_double_eq_tol(peak.amplitude_N, 0.03, 1e-3);
    ck_assert_double_gt(peak.prominence, 100);
}
END_TEST

/* ---- diagnostics ---- */

static palp_explanation *diagnosed(void) {
    palp_explanation *e = calloc(1, sizeof *e);
    palp_explain_run *of = calloc(data.n_runs, sizeof *of);
    ck_assert(e && of);
    e->run = of;
    e->n_runs = data.n_runs;
    e->n_phase_shares = 1;
    e->phase_share[0] = (palp_explain_phase_share){.run = 0, .phase = PALP_PHASE_RAMP};
    for (size_t r = 0, at = 0; r < data.n_runs; at += run[r++].n) {
        of[r].n = run[r].n;
        of[r].after_N = residual + at;
    }
    ck_assert_int_eq(explain_diagnostics_find(&data, residual, e), PALP_OK);
    free(of);
    return e;
}

/* 20 samples of alternating sign: 20 runs where 11 are expected, of a variance of 2 m n (2 m n - N) / (N N (N
 * - 1)). */
START_TEST(order_from_sample_to_sample) {
    begin(1, 26, 0.1);
    for (size_t i = 0; i < 26; i++) {
        residual[i] = i % 2 ? 1 : -1;
        if (i < 3 || i >= 23)
            run->phase[i] = PALP_PHASE_AIR;
    }
    palp_explanation *e = diagnosed();
    ck_assert_double_eq_tol(e->phase_share[0].lag1, -0.95, 1e-12);
    ck_assert_double_eq_tol(e->phase_share[0].runs_z, 9 / sqrt(200.0 * 180.0 / (400.0 * 19.0)), 1e-12);
    free(e);
    for (size_t i = 0; i < 26; i++)
        residual[i] = i < 8 ? 1 : -1; /* 5 of one sign, then 15 of the other */
    e = diagnosed();
    ck_assert_double_eq_tol(e->phase_share[0].lag1, (18 - 1) / 20.0, 1e-12);
    ck_assert_double_eq_tol(e->phase_share[0].runs_z,
                            (2 - 150 / 20.0 - 1) / sqrt(150.0 * 130.0 / (400.0 * 19.0)), 1e-12);
    free(e);
}
END_TEST

/* A residual of depth alone, in steps of a bin, and one that alternates: the curve takes off the first, less
 * what as many bins take off by chance. */
START_TEST(free_curves) {
    enum { EACH = 40, BINS = 24, N = EACH * BINS };
    double square = 0;
    begin(1, N, 0.05);
    for (size_t i = 0; i < N; i++) {
        size_t bin = i * 7 / EACH % BINS; /* bins one after the other, in another order than time */
        double step = cos((double)bin);
        run->depth[i] = data.deepest * ((double)bin + 0.5) / BINS;
        residual[i] = step + (i % 2 ? 0.2 : -0.2);
        square += step * step;
    }
    palp_explanation *e = diagnosed();
    double sum[BINS] = {0}, count[BINS] = {0}, taken = 0, total = 0;
    for (size_t i = 0; i < N; i++) {
        size_t bin = i * 7 / EACH % BINS;
        sum[bin] += residual[i];
        count[bin]++;
        total += residual[i] * residual[i];
    }
    for (size_t k = 0; k < BINS; k++)
        taken += sum[k] * sum[k] / count[k];
    double noise = (total - taken) / (N - BINS);
    ck_assert_double_eq_tol(e->diagnostics.by_depth_N, sqrt((taken - BINS * noise) / N), 1e-12);
    ck_assert_double_eq_tol(e->diagnostics.by_depth_N, sqrt(square / N), 0.01);
    ck_assert_double_lt(e->diagnostics.by_time_N, 0.3 * e->diagnostics.by_depth_N);
    free(e);
}
END_TEST

START_TEST(a_step_that_stays_is_a_slip) {
    begin(1, 400, 0.01);
    run->white = 1e-3;
    for (size_t i = 0; i < 400; i++)
        residual[i] = (i < 200 ? 0.0 : 0.05) + (i % 2 ? 1e-3 : -1e-3);
    palp_explanation *e = diagnosed();
    ck_assert_uint_eq(data.n_events, 1);
    ck_assert_str_eq(data.event[0].kind, "slip");
    ck_assert_double_eq_tol(data.event[0].size_N, 0.05, 1e-3);
    ck_assert_double_eq_tol(0.5 * (data.event[0].from_s + data.event[0].to_s), 2.0, 0.011);
    free(data.event);
    free(e);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, the_mains_over_time);
    tcase_add_test(tc, the_mains_need_three_periods);
    tcase_add_test(tc, a_wave_over_depth);
    tcase_add_test(tc, a_wave_over_time);
    tcase_add_test(tc, order_from_sample_to_sample);
    tcase_add_test(tc, free_curves);
    tcase_add_test(tc, a_step_that_stays_is_a_slip);
    tcase_add_test(tc, the_end_of_a_sensor_is_no_silence);
}
