/* test_explain_specimens.c: runs of several specimens, which their files name: what differs between these is
 * theirs, before an effect or an instrument is accused. check: once */
#include "forward_make.h"

#include <palpate/explain.h>

#include <stdint.h>
#include <stdio.h>

enum { SPECIMENS = 4, EACH = 2, RUNS = SPECIMENS * EACH };

static palp_experiment *made[RUNS];
static palp_explain_input input[RUNS];
static char name[RUNS][16];
static double range; /* of the sensor, N */

static void begin(void) {
    range = HUGE_VAL;
}

/* law, whole: how many times as stiff each specimen's law, or all of it, is; gain: of each run's sensor. */
static void session(const palp_model *plain, const double *law, const double *whole, const double *gain,
                    bool named) {
    static const double plan[EACH][2] = {{6, 3}, {4, 0.6}}; /* mm, mm/s */
    static samples s;
    uint64_t state = 11;
    for (size_t r = 0; r < RUNS; r++) {
        const size_t k = r / EACH;
        palp_model m = *plain;
        ck_assert_int_eq(palp_law_scale(&m.material.law, law[k] * whole[k], &m.material.law), PALP_OK);
        m.material.arms[0].stiffness_N *= whole[k];
        m.material.arms[0].viscosity_Ns *= whole[k];
        const double depth = plan[r % EACH][0], ramp_s = (depth + 1) / plan[r % EACH][1];
        start(&s, -1, 0);
        go(&s, 1, -1, 15);
        go(&s, 1 + ramp_s, depth, 50);
        go(&s, 13 + ramp_s, depth, 70);
        go(&s, 13 + 2 * ramp_s, -1, 50);
        go(&s, 15 + 2 * ramp_s, -1, 15);
        palp_forward_run run = {.n = s.n, .time_s = s.time_s, .depth_m = s.depth_m};
        ck_assert_int_eq(palp_forward_force(&m, &run, s.force_N, NULL, NULL), PALP_OK);
        ck_assert_int_eq(palp_experiment_create(s.n, &made[r]), PALP_OK);
        for (size_t i = 0; i < s.n; i++) {
            palp_experiment_column(made[r], "time_s")[i] = s.time_s[i];
            palp_experiment_column(made[r], "depth_mm")[i] = 1e3 * s.depth_m[i];
            palp_experiment_column(made[r], "force_N")[i] =
                fmin(range, gain[r] * s.force_N[i] + 2e-3 * white_noise(&state));
        }
        snprintf(name[r], sizeof name[r], "piece %zu", k);
        if (named)
            palp_experiment_set_string(made[r], "specimen.name", name[r]);
        input[r] = (palp_explain_input){made[r], "run.csv"};
    }
}

static void explain(palp_explanation *e) {
    palp_explain_settings s = palp_explain_settings_default();
    palp_error error = {.text = ""};
    palp_model m = lumped_model(1);
    ck_assert_int_eq(palp_law_scale(&m.material.law, 1.1, &m.material.law), PALP_OK);
    ck_assert_msg(palp_explain(&m, RUNS, input, &s, e, &error) == PALP_OK, "%s", error.text);
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free(made[r]);
}

static const double ones[RUNS] = {1, 1, 1, 1, 1, 1, 1, 1}, differ[SPECIMENS] = {0.85, 1.1, 0.95, 1.2};

START_TEST(specimens_that_differ_as_a_whole_are_no_gain) {
    palp_model plain = lumped_model(1);
    palp_explanation e;
    session(&plain, ones, differ, ones, true);
    explain(&e);
    ck_assert_uint_eq(e.n_effects, 0);
    ck_assert_int_eq(e.verdict, PALP_EXPLAIN_AGREES);
    ck_assert(e.specimens.found && !e.specimens.law && !e.gain.found);
    for (size_t r = 0; r < RUNS; r++)
        ck_assert_double_eq_tol(e.run[r].stiffness / e.run[0].stiffness, differ[r / EACH] / differ[0], 0.01);
    palp_explanation_free(&e);
}
END_TEST

/* Gains that differ in the runs of one specimen are none of the specimens'. */
START_TEST(gains_within_a_specimen_are_the_sensors) {
    static const double gain[RUNS] = {0.9, 1.1, 1.08, 0.92, 0.95, 1.07, 1.1, 0.9};
    palp_model plain = lumped_model(1);
    palp_explanation e;
    session(&plain, ones, ones, gain, true);
    explain(&e);
    ck_assert(e.gain.found && !e.specimens.found);
    ck_assert_ptr_null(e.model.between);
    palp_explanation_free(&e);
}
END_TEST

/* Nothing names a specimen: there is one, and a law that changes from run to run is no effect of the
 * catalogue. */
START_TEST(unnamed_runs_have_one_specimen) {
    palp_model plain = lumped_model(1);
    palp_explanation e;
    session(&plain, ones, differ, ones, false);
    explain(&e);
    ck_assert_uint_eq(e.specimens.n, 1);
    ck_assert(!e.specimens.found && e.gain.found);
    palp_explanation_free(&e);
}
END_TEST

START_TEST(an_effect_is_found_beside_them) {
    palp_model plain = lumped_model(1);
    palp_explanation e;
    add_effect(&plain, PALP_EFFECT_SENSOR_LAG, 1)->value[0] = 0.08;
    session(&plain, differ, ones, ones, true);
    explain(&e);
    ck_assert(e.specimens.found && e.specimens.law);
    ck_assert_uint_eq(e.n_effects, 1);
    ck_assert_int_eq(e.effect[0].effect.id, PALP_EFFECT_SENSOR_LAG);
    ck_assert_double_eq_tol(e.effect[0].effect.value[0], 0.08, 0.004);
    palp_explanation_free(&e);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_checked_fixture(tc, begin, NULL);
    tcase_add_test(tc, specimens_that_differ_as_a_whole_are_no_gain);
    tcase_add_test(tc, gains_within_a_specimen_are_the_sensors);
    tcase_add_test(tc, unnamed_runs_have_one_specimen);
    tcase_add_test(tc, an_effect_is_found_beside_them);
}
