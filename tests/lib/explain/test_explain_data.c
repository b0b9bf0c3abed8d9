/* test_explain_data.c: what explain reads off the runs, and how far two forces are apart in one. */
#include "explain/explain_lines.h"
#include "explain/explain_result.h"
#include "forward_make.h"

#include <palpate/random.h>

enum { RUNS = 3 };

static explain_data data;
static palp_explain_settings settings;

/* Air, ramp, dwell, withdrawal; the force times gain beside a zero. Lone spike and letting go where asked. */
static palp_experiment *record(const palp_model *m, double gain, double zero, double spike, double pull) {
    static samples s;
    static uint64_t state = 11;
    palp_experiment *e;
    start(&s, 0, -1);
    go(&s, 1, -1, 60);
    go(&s, 3, 4, 200);
    go(&s, 8, 4, 100);
    go(&s, 10, -1, 200);
    press_model(m, &s);
    ck_assert_int_eq(palp_experiment_create(s.n, &e), PALP_OK);
    for (size_t i = 0; i < s.n; i++) {
        double force = gain * s.force_N[i] + zero + 1e-4 * palp_random_normal(&state);
        if (pull > 0 && s.time_s[i] > 9.6 && s.time_s[i] < 9.8) /* grows, then lets go */
            force -= pull * (s.time_s[i] - 9.6) / 0.2;
        palp_experiment_column(e, "time_s")[i] = s.time_s[i];
        palp_experiment_column(e, "depth_mm")[i] = 1e3 * s.depth_m[i];
        palp_experiment_column(e, "force_N")[i] = force + (i == (spike > 0 ? 150 : s.n - 20) ? spike : 0);
    }
    palp_experiment_set_string(e, "protocol.kind", "ramp_hold");
    palp_experiment_set_number(e, "protocol.depth_mm", 4);
    return e;
}

static void begin(const palp_model *m, const double gain[RUNS], const double zero[RUNS], double spike,
                  double pull) {
    palp_explain_input input[RUNS];
    settings = palp_explain_settings_default();
    for (size_t r = 0; r < RUNS; r++)
        input[r] = (palp_explain_input){record(m, gain[r], zero[r], r == 1 ? spike : 0, r == 2 ? pull : 0),
                                        "run.csv"};
    ck_assert_int_eq(explain_data_create(RUNS, input, &settings, m, &data, NULL), PALP_OK);
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}

static const double ones[RUNS] = {1, 1, 1}, none[RUNS] = {0, 0, 0};

/* ---- data ---- */

/* Runs whose plate went the same way are replicates, whatever their files say of a protocol. */
START_TEST(replicates_by_their_paths) {
    palp_model m = lumped_model(1);
    begin(&m, ones, none, 0, 0);
    ck_assert_uint_eq(data.n_replicates, 2);
    ck_assert_double_eq_tol(data.run[0].white, 1e-4, 1.5e-5);
    ck_assert_double_eq_tol(data.deepest, 4e-3, 1e-12);
    ck_assert_double_eq(data.run[1].largest_strain, 0); /* each finds a specimen as new */
    explain_data_free(&data);
}
END_TEST

START_TEST(spikes_and_releases_are_events) {
    palp_model m = lumped_model(1);
    begin(&m, ones, none, 0.2, 0.3);
    ck_assert_uint_eq(data.n_events, 2);
    ck_assert_str_eq(data.event[0].kind, "spike");
    ck_assert_uint_eq(data.event[0].run, 1);
    ck_assert_double_eq_tol(data.event[0].size_N, 0.2, 0.01);
    ck_assert_uint_eq(data.run[1].use[150], 0);
    ck_assert_str_eq(data.event[1].kind, "release");
    ck_assert_uint_eq(data.event[1].run, 2);
    ck_assert_uint_eq(data.n_releases, 1);
    ck_assert_double_gt(data.pull, 0.25);
    ck_assert_double_lt(data.pull, 0.301);
    ck_assert_double_gt(data.pull_most, data.pull);
    ck_assert_double_lt(data.pull_most, data.pull + 0.03); /* one more rise */
    explain_data_free(&data);
}
END_TEST

/* One odd sample while the plate is far away, as noise with heavy tails has: nothing lets go. */
START_TEST(a_lone_sample_is_no_release) {
    palp_model m = lumped_model(1);
    begin(&m, ones, none, -0.2, 0);
    ck_assert_uint_eq(data.n_events, 1);
    ck_assert_str_eq(data.event[0].kind, "spike");
    ck_assert_uint_eq(data.n_releases, 0);
    explain_data_free(&data);
}
END_TEST

/* A pull is what the force is below the run's own zero. */
START_TEST(a_zero_is_no_pull) {
    static const double low[RUNS] = {0, 0, -0.1}, lower[RUNS] = {0, 0, -1e-3};
    palp_model m = lumped_model(1);
    begin(&m, ones, low, 0, 0.3);
    ck_assert_uint_eq(data.n_releases, 1);
    ck_assert_double_lt(data.pull, 0.301);
    ck_assert_double_gt(data.pulled, 0.25);
    ck_assert_double_lt(data.pulled, 0.301);
    explain_data_free(&data);
    begin(&m, ones, lower, 0, 9e-4);
    ck_assert_uint_eq(data.n_releases, 0); /* nine times the noise, with the zero nineteen */
    explain_data_free(&data);
}
END_TEST

/* Where the plate withdraws until the force is gone a pull may hide in the noise. */
START_TEST(a_pull_may_hide_in_the_noise) {
    palp_model m = lumped_model(1);
    begin(&m, ones, none, 0, 0);
    ck_assert_double_gt(data.pulled, 1e-4);
    ck_assert_double_lt(data.pulled, 5e-4);
    explain_data_free(&data);
}
END_TEST

/* ---- the next experiment ---- */

/* Each run has its own bias and gain: two models are separated only by what these cannot absorb. */
START_TEST(a_zero_and_a_gain_separate_nothing) {
    static double a[EXPLAIN_PATH], b[EXPLAIN_PATH];
    static explain_path path;
    palp_model m = linear_model(8), stiffer = linear_model(8.8);
    const double rate = 1e-4;
    const explain_protocol press = {.depth = 2e-3, .rate = 1e-3, .hold = 10};
    begin(&m, ones, none, 0, 0);
    explain_path_find(&press, &data, EXPLAIN_PATH, &path);
    const palp_forward_run run = {.n = path.n, .time_s = path.time, .depth_m = path.depth};
    ck_assert_int_eq(palp_forward_force(&m, &run, a, NULL, NULL), PALP_OK);
    add_effect(&stiffer, PALP_EFFECT_SENSOR_BIAS, 0)->value[0] = 0.05;
    ck_assert_int_eq(palp_forward_force(&stiffer, &run, b, NULL, NULL), PALP_OK);
    ck_assert_double_lt(explain_separation(&path, a, b), 1e-7);
    add_effect(&stiffer, PALP_EFFECT_SENSOR_DRIFT, 0)->value[0] = rate;
    ck_assert_int_eq(palp_forward_force(&stiffer, &run, b, NULL, NULL), PALP_OK);
    /* A line's rms about its mean over the run. The force takes off little of it. */
    const double lasts = path.time[path.n - 1], line = rate * lasts / sqrt(12),
                 apart = explain_separation(&path, a, b);
    ck_assert_double_lt(apart, 1.01 * line);
    ck_assert_double_gt(apart, 0.8 * line);
    explain_data_free(&data);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, replicates_by_their_paths);
    tcase_add_test(tc, spikes_and_releases_are_events);
    tcase_add_test(tc, a_lone_sample_is_no_release);
    tcase_add_test(tc, a_zero_is_no_pull);
    tcase_add_test(tc, a_pull_may_hide_in_the_noise);
    tcase_add_test(tc, a_zero_and_a_gain_separate_nothing);
}
