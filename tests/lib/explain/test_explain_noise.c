/* test_explain_noise.c: the noise's filter, lines and diagnostics of residuals that are known. */
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
static double block[RUNS][6 * MOST], residual[RUNS * MOST];
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
                          .correlation_time = 1,
                          .step = dt,
                          .duration = (double)n * dt,
                          .shown = {.rate = 1 / dt}};
    for (size_t r = 0; r < n_runs; r++) {
        double *b = block[r];
        run[r] = (explain_run){.n = n,
                               .time = b,
                               .depth = b + n,
                               .force = b + 2 * n,
                               .keep = b + 3 * n,
                               .take = b + 4 * n,
                               .weight = b + 5 * n,
                               .use = use[r],
                               .phase = use[r] + n,
                               .white = 1};
        memset(use[r], 1, n);
        memset(use[r] + n, PALP_PHASE_RAMP, n);
        for (size_t i = 0; i < n; i++) {
            run[r].time[i] = dt * (double)i;
            run[r].depth[i] = 2e-3;
            run[r].force[i] = 0;
            run[r].keep[i] = run[r].take[i] = 0;
            run[r].weight[i] = 1;
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

START_TEST(white_and_correlated_noise_are_found) {
    begin(2, 12000, 0.01);
    for (size_t r = 0; r < 2; r++)
        make_noise(&run[r], 2e-3, 2e-3, 0.6, residual + r * 12000);
    ck_assert_int_eq(explain_noise_find(&data, residual), PALP_OK);
    ck_assert_double_eq_tol(run[0].white, 2e-3, 1e-4);
    ck_assert_double_eq_tol(data.correlated, 2e-3, 5e-4);
    ck_assert_double_gt(data.correlation_time, 0.3);
    ck_assert_double_lt(data.correlation_time, 1.2);
    for (size_t r = 0; r < 2; r++)
        make_noise(&run[r], 2e-3, 0, 1, residual + r * 12000);
    ck_assert_int_eq(explain_noise_find(&data, residual), PALP_OK);
    ck_assert_double_eq(data.correlated, 0);
}
END_TEST

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
    ck_assert_double_eq_tol(run->white, 2e-3, 1.5e-4);
    memset(run->force, 0, 4000 * sizeof *run->force); /* nothing else is there */
    make_noise(run, 2e-3, 0, 1, residual);
    ck_assert_int_eq(explain_white_noise(run, residual), PALP_OK);
    ck_assert_double_eq_tol(run->white, 2e-3, 1.5e-4);
}
END_TEST

/* Noise all of which fades from sample to sample: what neighbours differ by is not counted twice. */
START_TEST(noise_that_is_nowhere_white) {
    begin(2, 6000, 0.02);
    for (size_t r = 0; r < 2; r++)
        make_noise(&run[r], 0, 5e-3, 0.09, residual + r * 6000);
    ck_assert_int_eq(explain_noise_find(&data, residual), PALP_OK);
    ck_assert_double_eq_tol(hypot(run[0].white, data.correlated), 5e-3, 5e-4);
    ck_assert_double_eq_tol(data.correlation_time, 0.09, 0.02);
    ck_assert_double_eq_tol(explain_facts(&data).white, 5e-3,
                            5e-4); /* what effects know of a sample's noise */
}
END_TEST

/* What happens in a tenth of the samples is no noise of the instrument: a burst of any size, a kink; nor is
 * what a model misses in all. */
START_TEST(neither_a_burst_nor_a_misfit_is_noise) {
    enum { N = 5000 };
    static const double bursts[] = {3, 5, 10, 100, 0};
    uint64_t state = 5;
    begin(3, N, 0.01);
    for (size_t r = 0; r < 3; r++) {
        double *own = residual + r * N;
        make_noise(&run[r], 2e-3, 0, 1, own);
        for (size_t i = 0; i < N; i++) {
            const double since = fmod(run[r].time[i], 2.0);
            own[i] += bursts[_i] > 0 && i >= N / 2 && i < N / 2 + N / 10
                          ? 2e-3 * bursts[_i] * palp_random_normal(&state)
                          : 0;
            own[i] += bursts[_i] > 0 ? 0
                                     : 0.05 * exp(-run[r].time[i] / 10) -
                                           0.1 * fmin(since, 0.2); /* relaxes, has kinks */
        }
    }
    ck_assert_int_eq(explain_noise_find(&data, residual), PALP_OK);
    for (size_t r = 0; r < 3; r++)
        ck_assert_double_eq_tol(run[r].white, 2e-3, 2e-4);
}
END_TEST

/* What only one run has is structure and not correlated noise, of two runs and of three. */
START_TEST(correlated_noise_is_alike_in_all_runs) {
    enum { N = 5000 };
    const size_t runs = 2 + (size_t)_i % 2, with = _i < 2 ? 1 : runs;
    begin(runs, N, 0.01);
    for (size_t r = 0; r < runs; r++)
        make_noise(&run[r], 2e-3, r < with ? 4e-3 : 0, 0.6, residual + r * N);
    ck_assert_int_eq(explain_noise_find(&data, residual), PALP_OK);
    if (with < runs)
        ck_assert_double_eq(data.correlated, 0);
    else
        ck_assert_double_eq_tol(data.correlated, 4e-3, 1.5e-3); /* by one run, of 80 of its times */
}
END_TEST

/* The filter W of a run with samples at uneven times has W V W' = 1, V the noise's covariance; a masked
 * sample has neither part in it. */
START_TEST(whitened_noise_is_white) {
    enum { N = 150, MASKED = 70 };
    static double w[N * N], v[N * N], t[N * N], one[N * N];
    begin(1, N, 0.02);
    for (size_t i = 0; i < N; i++)
        run->time[i] += 0.3 * floor((double)i / 50.0) + 0.004 * cos((double)i);
    run->use[MASKED] = 0;
    make_noise(run, 1e-3, 4e-3, 0.5, residual);
    ck_assert_int_eq(explain_noise_find(&data, residual), PALP_OK);
    ck_assert_double_gt(data.correlated, 1e-3);
    for (size_t k = 0; k < N; k++)
        w[k * N + k] = 1;
    explain_whiten(run, N, w);
    for (size_t k = 0; k < N; k++)
        for (size_t i = 0; i < N; i++)
            v[k * N + i] =
                pow(data.correlated, 2) * exp(-fabs(run->time[k] - run->time[i]) / data.correlation_time) +
                (i == k ? pow(run->white, 2) : 0);
    dense_product(N, N, N, w, v, t); /* W V, then (W V) W' by the transposed of both */
    for (size_t i = 0; i < N; i++)
        for (size_t j = 0; j < N; j++) {
            one[i * N + j] = 0;
            for (size_t k = 0; k < N; k++)
                one[i * N + j] += t[k * N + i] * w[k * N + j];
            ck_assert_double_eq_tol(one[i * N + j], i == j && i != MASKED, 1e-9);
        }
}
END_TEST

/* ---- lines ---- */

START_TEST(the_mains_over_time) {
    double frequency, amplitude, clean = 0;
    begin(2, 6000, 0.005);
    for (size_t k = 0; k < 2 * 6000; k++) /* another phase in each run */
        residual[k] = 0.02 * sin(TURN * 50.03 * run->time[k % 6000] + (k < 6000 ? 0.4 : 2.0));
    for (size_t r = 0; r < 2; r++)
        for (size_t i = 0; i < 6000; i++) {
            run[r].weight[i] = 100;
            run[r].white = 0.01;
        }
    ck_assert_int_eq(explain_line_in_time(&data, residual, &frequency, &amplitude), PALP_OK);
    ck_assert_double_eq_tol(frequency, 50.03, 1.6e-3);
    ck_assert_double_eq_tol(amplitude, 0.02, 4e-4);
    explain_line_take(&data, 50.03, residual);
    for (size_t k = 0; k < 2 * 6000; k++)
        clean = fmax(clean, fabs(residual[k]));
    ck_assert_double_lt(clean, 1e-12);
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

/* A residual of depth alone, in steps of a bin, beside one that alternates: the curve takes off the first,
 * less what as many bins take off by chance. */
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
    tcase_add_test(tc, white_and_correlated_noise_are_found);
    tcase_add_test(tc, noise_that_is_nowhere_white);
    tcase_add_test(tc, whitened_noise_is_white);
    tcase_add_test(tc, the_mains_over_time);
    tcase_add_test(tc, the_mains_need_three_periods);
    tcase_add_test(tc, a_wave_over_depth);
    tcase_add_test(tc, a_wave_over_time);
    tcase_add_test(tc, order_from_sample_to_sample);
    tcase_add_test(tc, free_curves);
    tcase_add_test(tc, a_step_that_stays_is_a_slip);
    tcase_add_loop_test(tc, neither_a_burst_nor_a_misfit_is_noise, 0, 5);
    tcase_add_loop_test(tc, correlated_noise_is_alike_in_all_runs, 0, 4);
    tcase_add_test(tc, the_end_of_a_sensor_is_no_silence);
}
