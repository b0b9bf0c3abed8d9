/* test_segments_smooth.c: a path whose depth is noisy is smoothed; one that is exact stays to the bit. */
#include "data/segments_internal.h"

#include <check.h>
#include <math.h>
#include <palpate/random.h>
#include <string.h>

enum { N = 900 };
static const double TURN = 6.283185307179586;

/* Paths that real plates go, in mm, at 50 samples a second. */
static double straight(double t) { /* there and back four times, with corners */
    double u = fmod(t, 4.5);
    return u < 2.25 ? 2.0 * u : 9.0 - 2.0 * u;
}
static double fast_sinusoid(double t) { /* five samples a period */
    return 2.0 + sin(TURN * 10.0 * t + 0.3);
}
static double ringing(double t) { /* swings after a step of the speed */
    double u = fmod(t, 3.0);
    return 0.8 * t - 0.05 * exp(-2.0 * u) * sin(TURN * 3.0 * u);
}
static double creeping(double t) {
    return 3.0 * log1p(t);
}
static double counted(double t) { /* an encoder's steps of 5 um */
    return 5e-3 * floor(straight(t) / 5e-3 + 0.5);
}
static double by_hand(double t) {
    return 2.5 + 1.5 * sin(0.9 * t) + 0.7 * sin(2.3 * t + 1.0) + 0.2 * sin(5.1 * t);
}

static void fill(double (*path)(double t), double *time, double *depth) {
    for (size_t i = 0; i < N; i++) {
        time[i] = 0.02 * (double)i;
        depth[i] = path(time[i]);
    }
}

START_TEST(exact_paths_stay) {
    static double (*const paths[])(double t) = {straight, fast_sinusoid, ringing, creeping, counted, by_hand};
    double time[N], depth[N], before[N], noise;
    fill(paths[_i], time, depth);
    memcpy(before, depth, sizeof depth);
    ck_assert_int_eq(palp_segments_smooth_path(N, time, depth, &noise), PALP_OK);
    ck_assert_double_eq(noise, 0.0);
    ck_assert_mem_eq(depth, before, sizeof depth);
}
END_TEST

static double rms(const double *a, const double *b) {
    double sum = 0.0;
    for (size_t i = 0; i < N; i++)
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sqrt(sum / N);
}

static void add_noise(double sd, double *depth) {
    for (size_t i = 0; i < N; i++)
        depth[i] += sd * palp_random_normal_at(7, i);
}

/* The noise is measured, and most of it leaves the path; along a hand's way and along straight ones. */
START_TEST(noisy_paths_are_smoothed) {
    static double (*const paths[])(double t) = {by_hand, straight, creeping};
    static const double left[] = {0.6, 0.8, 0.6}; /* corners of straight ways bear less smoothing */
    const double sd = 12e-3;
    double time[N], truth[N], depth[N], noise;
    fill(paths[_i], time, truth);
    memcpy(depth, truth, sizeof truth);
    add_noise(sd, depth);
    ck_assert_int_eq(palp_segments_smooth_path(N, time, depth, &noise), PALP_OK);
    ck_assert_double_eq_tol(noise, sd, 0.15 * sd);
    ck_assert_double_lt(rms(depth, truth), left[_i] * sd);
}
END_TEST

/* In metres and minutes it is the same path. */
START_TEST(units_change_nothing) {
    double time[N], depth[N], minutes[N], metres[N], noise, other;
    fill(by_hand, time, depth);
    add_noise(12e-3, depth);
    for (size_t i = 0; i < N; i++) {
        minutes[i] = time[i] / 60.0;
        metres[i] = 1e-3 * depth[i];
    }
    ck_assert_int_eq(palp_segments_smooth_path(N, time, depth, &noise), PALP_OK);
    ck_assert_int_eq(palp_segments_smooth_path(N, minutes, metres, &other), PALP_OK);
    ck_assert_double_eq_tol(1e3 * other, noise, 1e-6 * noise);
    for (size_t i = 0; i < N; i++)
        ck_assert_double_eq_tol(1e3 * metres[i], depth[i], 1e-8);
}
END_TEST

/* The order of the prediction decides nothing. With 6, 8 and 10 the noise is the same within two standard
 * errors of a median of N absolute values, whose efficiency is 0.37. The path is the same within a tenth of
 * the noise, and an exact path stays. */
START_TEST(the_order_changes_little) {
    static double (*const paths[])(double t) = {by_hand, straight, creeping, fast_sinusoid, ringing};
    const double sd = 12e-3, share = 2.0 / sqrt(2.0 * 0.37 * N); /* 8 % */
    double time[N], truth[N], depth[N], usual[N], noise, wanted;
    fill(paths[_i / 2], time, truth);
    memcpy(usual, truth, sizeof truth);
    add_noise(sd, usual);
    memcpy(depth, usual, sizeof usual);
    ck_assert_int_eq(segments_smooth_by_order(8, N, time, usual, &wanted), PALP_OK);
    ck_assert_int_eq(segments_smooth_by_order(_i % 2 ? 6 : 10, N, time, depth, &noise), PALP_OK);
    ck_assert_double_le(fabs(noise - wanted), share * wanted);
    ck_assert_double_lt(rms(depth, usual), 0.1 * sd);
    memcpy(depth, truth, sizeof truth);
    ck_assert_int_eq(segments_smooth_by_order(_i % 2 ? 6 : 10, N, time, depth, &noise), PALP_OK);
    ck_assert_mem_eq(depth, truth, sizeof truth);
}
END_TEST

START_TEST(few_samples_stay) {
    double time[20], depth[20], noise = 1.0;
    for (size_t i = 0; i < 20; i++) {
        time[i] = (double)i;
        depth[i] = i % 2 ? 1.0 : 1.1;
    }
    ck_assert_int_eq(palp_segments_smooth_path(20, time, depth, &noise), PALP_OK);
    ck_assert_double_eq(noise, 0.0);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, exact_paths_stay, 0, 6);
    tcase_add_loop_test(tc, noisy_paths_are_smoothed, 0, 3);
    tcase_add_test(tc, units_change_nothing);
    tcase_add_loop_test(tc, the_order_changes_little, 0, 10);
    tcase_add_test(tc, few_samples_stay);
}
