/* test_filter.c: the zero-phase Butterworth filter against its transfer function. */
#include <palpate/recording.h>

#include <check.h>
#include <math.h>
#include <stdlib.h>

enum { N = 4000 };

static const double PI = 3.14159265358979323846, STEP = 1e-3;

/* Amplitude that a sine of a frequency comes out with, away from the ends. */
static double gain(int order, double cutoff, double f) {
    double in[N], out[N], a = 0.0, b = 0.0;
    size_t used = 0;
    for (size_t i = 0; i < N; i++)
        in[i] = sin(2.0 * PI * f * STEP * (double)i);
    ck_assert_int_eq(palp_filter_zero_phase(N, in, STEP, order, cutoff, out), PALP_OK);
    for (size_t i = N / 4; i < 3 * N / 4; i++, used++) { /* whole periods of every frequency asked for */
        a += out[i] * in[i];
        b += out[i] * cos(2.0 * PI * f * STEP * (double)i);
    }
    ck_assert_double_eq_tol(2.0 * b / (double)used, 0.0,
                            1e-6); /* no phase; the difference comes from the ends */
    return 2.0 * a / (double)used;
}

/* |H|^2 of the bilinear Butterworth low-pass, which is what two passes give. */
static double expected(int order, double cutoff, double f) {
    return 1.0 / (1.0 + pow(tan(PI * f * STEP) / tan(PI * cutoff * STEP), 2.0 * order));
}

START_TEST(gain_is_butterworth_squared) {
    static const double f[] = {1.0, 5.0, 10.0, 20.0, 30.0, 40.0, 80.0, 200.0};
    for (int order = 2; order <= 8; order += 2)
        for (size_t k = 0; k < sizeof f / sizeof *f; k++)
            ck_assert_double_eq_tol(gain(order, 20.0, f[k]), expected(order, 20.0, f[k]), 1e-9);
}
END_TEST

START_TEST(cutoff_is_6_dB_and_the_slope_that_of_twice_the_order) {
    for (int order = 2; order <= 8; order += 2) {
        ck_assert_double_eq_tol(20.0 * log10(gain(order, 20.0, 20.0)), -20.0 * log10(2.0), 1e-6);
        /* well above the cut-off and below the sampling rate: 12.04 dB an octave for each order */
        if (order > 4)
            continue; /* smaller than what the ends leave */
        double octave = 20.0 * log10(gain(order, 5.0, 20.0) / gain(order, 5.0, 40.0));
        ck_assert_double_eq_tol(octave / (40.0 * log10(2.0)), order, 0.02 * order);
    }
}
END_TEST

START_TEST(a_pulse_stays_symmetric_and_keeps_its_area) {
    for (int order = 2; order <= 8; order += 2) {
        double in[N + 1] = {0}, out[N + 1], area = 0.0;
        in[N / 2] = 1.0;
        ck_assert_int_eq(palp_filter_zero_phase(N + 1, in, STEP, order, 25.0, out), PALP_OK);
        for (size_t i = 0; i <= N; i++)
            area += out[i];
        for (size_t i = 1; i < N / 2; i++)
            ck_assert_double_eq_tol(out[N / 2 - i], out[N / 2 + i], 1e-12);
        ck_assert_double_eq_tol(area, 1.0, 1e-9);
    }
}
END_TEST

START_TEST(constants_and_ramps_pass_up_to_the_ends) {
    double in[N], out[N];
    for (size_t i = 0; i < N; i++)
        in[i] = 3.0 - 0.01 * (double)i; /* odd reflection continues a straight line */
    ck_assert_int_eq(palp_filter_zero_phase(N, in, STEP, 4, 25.0, out), PALP_OK);
    ck_assert_double_eq_tol(out[0], in[0], 1e-3);
    ck_assert_double_eq_tol(out[N / 2], in[N / 2], 1e-9);
    ck_assert_double_eq_tol(out[N - 1], in[N - 1], 1e-3);
    for (size_t i = 0; i < N; i++)
        in[i] = 3.0;
    ck_assert_int_eq(palp_filter_zero_phase(N, in, STEP, 8, 25.0, in), PALP_OK); /* in place */
    for (size_t i = 0; i < N; i++)
        ck_assert_double_eq_tol(in[i], 3.0, 1e-9);
}
END_TEST

START_TEST(short_recordings_and_bad_arguments) {
    double in[3] = {1.0, 2.0, 3.0}, out[3] = {0.0};
    for (size_t n = 1; n <= 3; n++)
        ck_assert_int_eq(palp_filter_zero_phase(n, in, STEP, 4, 25.0, out), PALP_OK);
    ck_assert_int_eq(palp_filter_zero_phase(1, in, STEP, 4, 25.0, out), PALP_OK);
    ck_assert_double_eq_tol(out[0], 1.0, 1e-12);
    static const int orders[] = {-2, 0, 1, 3, 9, 10};
    static const double cutoffs[] = {0.0, -1.0, 500.0, 600.0};
    for (size_t k = 0; k < 6; k++)
        ck_assert_int_eq(palp_filter_zero_phase(3, in, STEP, orders[k], 25.0, out), PALP_ERR_ARGUMENT);
    for (size_t k = 0; k < 4; k++)
        ck_assert_int_eq(palp_filter_zero_phase(3, in, STEP, 4, cutoffs[k], out), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_filter_zero_phase(3, in, STEP, 4, (double)NAN, out), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_filter_zero_phase(3, in, 0.0, 4, 25.0, out), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_filter_zero_phase(0, in, STEP, 4, 25.0, out), PALP_ERR_ARGUMENT);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, gain_is_butterworth_squared);
    tcase_add_test(tc, cutoff_is_6_dB_and_the_slope_that_of_twice_the_order);
    tcase_add_test(tc, a_pulse_stays_symmetric_and_keeps_its_area);
    tcase_add_test(tc, constants_and_ramps_pass_up_to_the_ends);
    tcase_add_test(tc, short_recordings_and_bad_arguments);
}
