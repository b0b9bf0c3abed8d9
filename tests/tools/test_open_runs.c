/* test_open_runs.c: which samples are picked where one in so many is: those at bends of the path too. */
#include "shared/opening.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

enum { N = 2001, EVERY = 50, REGULAR = 41 }; /* samples of 1 ms, one in 50 */

static double noise(size_t i, double sd) {
    return sd * (sin(12.9898 * (double)(i * i)) + sin(78.233 * (double)i));
}

/* A ramp of 0.6215 s that begins at 0.2135 s, and a dwell, mm. */
static double ramp(double t) {
    return 4.0 * fmin(1.0, fmax(0.0, (t - 0.2135) / 0.6215));
}

/* It bends everywhere, more and more. */
static double wave(double t) {
    return t * (1.0 - cos(20.0 * t));
}

/* Depths in multiples of grain, mm. */
static palp_experiment *press_along(double (*path)(double), double grain, double depth_noise,
                                    double force_noise) {
    static char file[600];
    palp_experiment *run = NULL;
    palp_explain_input input;
    const char *folder = getenv("SCRATCH");
    snprintf(file, sizeof file, "%s/press.csv", folder ? folder : "/tmp");
    const char *const files[] = {file};
    FILE *to = fopen(file, "w");
    assert_non_null(to);
    fputs("# palpate.experiment: 1\n# specimen.height_mm: 24\ntime_s,depth_mm,force_N\n", to);
    for (size_t i = 0; i < N; i++) {
        const double t = 1e-3 * (double)i, depth = path(t);
        fprintf(to, "%.3f,%.9g,%.9g\n", t, grain * round((depth + noise(i, depth_noise)) / grain),
                0.5 * depth + noise(i + 7, force_noise));
    }
    assert_int_equal(fclose(to), 0);
    assert_int_equal(open_runs("test", 1, files, EVERY, &run, &input), 0);
    assert_ptr_equal(input.experiment, run);
    return run;
}

static palp_experiment *press(double grain, double depth_noise, double force_noise) {
    return press_along(ramp, grain, depth_noise, force_noise);
}

static bool has_time(const palp_experiment *run, double time) {
    const double *t = palp_experiment_column(run, "time_s");
    bool has = false;
    for (size_t i = 0; i < palp_experiment_rows(run); i++) {
        has = has || fabs(t[i] - time) < 1e-9;
        assert_true(i == 0 || t[i] > t[i - 1]);
    }
    return has;
}

static void corners_are_kept(void **state) {
    (void)state;
    palp_experiment *run = press(1e-9, 0.0, 1e-3);
    assert_in_range(palp_experiment_rows(run), REGULAR + 2, REGULAR + 4);
    for (size_t i = 0; i < N; i += EVERY)
        assert_true(has_time(run, 1e-3 * (double)i));
    assert_true(has_time(run, 0.213) || has_time(run, 0.214));
    assert_true(has_time(run, 0.835));
    palp_experiment_free(run);
}

static void rounding_and_noise_are_no_bends(void **state) {
    (void)state;
    palp_experiment *rounded = press(0.01, 0.0, 1e-3), *noisy = press(1e-9, 0.002, 1e-3);
    assert_in_range(palp_experiment_rows(rounded), REGULAR + 1, REGULAR + 6);
    assert_in_range(palp_experiment_rows(noisy), REGULAR + 1, REGULAR + 6);
    palp_experiment_free(rounded);
    palp_experiment_free(noisy);
}

static void coarse_forces_forgive_more(void **state) {
    (void)state;
    palp_experiment *coarse = press(1e-9, 0.0, 0.5), *exact = press(1e-9, 0.0, 0.0);
    assert_int_equal(palp_experiment_rows(coarse), REGULAR);
    assert_in_range(palp_experiment_rows(exact), REGULAR + 2, 2 * REGULAR);
    palp_experiment_free(coarse);
    palp_experiment_free(exact);
}

static void bends_are_limited(void **state) {
    (void)state;
    palp_experiment *waves = press_along(wave, 1e-9, 0.0, 0.0);
    assert_in_range(palp_experiment_rows(waves), REGULAR + 10, 2 * REGULAR);
    palp_experiment_free(waves);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(corners_are_kept), cmocka_unit_test(rounding_and_noise_are_no_bends),
        cmocka_unit_test(coarse_forces_forgive_more), cmocka_unit_test(bends_are_limited)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
