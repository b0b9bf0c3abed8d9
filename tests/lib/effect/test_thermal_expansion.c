/* test_thermal_expansion.c: a frame that grows with a recorded temperature: forces, derivatives, and found by
 * explain. */
#include "forward_make.h"

#include <palpate/experiment.h>
#include <palpate/explain.h>

static samples s;

static palp_forward_run warm_run(double *temperature, palp_forward_column *column) {
    palp_forward_run run = {
        .n = s.n, .time_s = s.time_s, .depth_m = s.depth_m, .n_columns = 1, .column = column};
    for (size_t i = 0; i < s.n; i++)
        temperature[i] = 22 + 0.7 * s.time_s[i];
    *column = (palp_forward_column){"temperature_C", temperature};
    return run;
}

/* The depth that the encoder would have to read without the effect. */
START_TEST(is_a_depth_that_grows) {
    static double temperature[SAMPLES_MAX], depth[SAMPLES_MAX], wanted[SAMPLES_MAX];
    palp_forward_column column;
    palp_model plain = lumped_model(2), warm = plain;
    add_effect(&warm, PALP_EFFECT_THERMAL_EXPANSION, 0)->value[0] = 5e-6;
    all_phases(&s, 40);
    palp_forward_run run = warm_run(temperature, &column),
                     same = {.n = s.n, .time_s = s.time_s, .depth_m = depth};
    for (size_t i = 0; i < s.n; i++)
        depth[i] = s.depth_m[i] + 5e-6 * (temperature[i] - temperature[0]);
    ck_assert_int_eq(palp_forward_force(&plain, &same, wanted, NULL, NULL), PALP_OK);
    ck_assert_int_eq(palp_forward_force(&warm, &run, s.force_N, NULL, NULL), PALP_OK);
    for (size_t i = 0; i < s.n; i++)
        ck_assert_msg(fabs(s.force_N[i] - wanted[i]) < 1e-12, "%g, not %g, at %g s", s.force_N[i], wanted[i],
                      s.time_s[i]);
    ck_assert_double_gt(fabs(s.force_N[3 * s.n / 4] - wanted[0]), 1e-3);
}
END_TEST

START_TEST(off_or_without_temperature_changes_no_bit) {
    static double temperature[SAMPLES_MAX], plain_N[SAMPLES_MAX];
    palp_forward_column column;
    palp_model plain = lumped_model(2), warm = plain;
    palp_effect *effect = add_effect(&warm, PALP_EFFECT_THERMAL_EXPANSION, 0);
    all_phases(&s, 40);
    palp_forward_run run = warm_run(temperature, &column);
    ck_assert_int_eq(palp_forward_force(&plain, &run, plain_N, NULL, NULL), PALP_OK);
    ck_assert_int_eq(palp_forward_force(&warm, &run, s.force_N, NULL, NULL), PALP_OK);
    ck_assert_mem_eq(s.force_N, plain_N, s.n * sizeof *plain_N);
    effect->value[0] = 5e-6;
    run.n_columns = 0;
    ck_assert_int_eq(palp_forward_force(&warm, &run, s.force_N, NULL, NULL), PALP_OK);
    ck_assert_mem_eq(s.force_N, plain_N, s.n * sizeof *plain_N);
    temperature[7] = NAN;
    run.n_columns = 1;
    ck_assert_int_eq(palp_forward_force(&warm, &run, s.force_N, NULL, NULL), PALP_ERR_ARGUMENT);
}
END_TEST

START_TEST(has_its_derivatives) {
    palp_model m = lumped_model(2);
    add_effect(&m, PALP_EFFECT_THERMAL_EXPANSION, 3);
    add_effect(&m, PALP_EFFECT_FRAME_COMPLIANCE, 0)->value[0] = 8e-4;
    add_effect(&m, PALP_EFFECT_TOE_REGION, 1);
    all_phases(&s, 12);
    check_slopes("with a frame and a toe", palp_forward_force, palp_forward_force, &m, &s, 1e-4, 5e-6);
    m = lumped_model(1);
    add_effect(&m, PALP_EFFECT_THERMAL_EXPANSION, 3);
    add_effect(&m, PALP_EFFECT_ADHESION, 1);
    check_slopes("with adhesion", palp_forward_force, palp_forward_force, &m, &s, 1e-4, 5e-6);
}
END_TEST

/* ---- found in recordings ---- */

static palp_experiment *recording(const palp_model *truth, double depth_mm, bool has_temperature,
                                  uint64_t seed) {
    static double temperature[SAMPLES_MAX];
    palp_forward_column column;
    palp_experiment *e = NULL;
    start(&s, 0, -0.5);
    go(&s, 1, -0.5, 50);
    go(&s, 3, depth_mm, 200);
    for (int i = 0; i < 900; i++)
        go(&s, 3 + 0.02 * (i + 1), depth_mm, 1);
    go(&s, 23, -0.5, 200);
    palp_forward_run run = warm_run(temperature, &column);
    for (size_t i = 0; i < s.n; i++)
        temperature[i] = 22 + 3 * sin(0.9 * s.time_s[i]);
    ck_assert_int_eq(palp_forward_force(truth, &run, s.force_N, NULL, NULL), PALP_OK);
    ck_assert_int_eq(palp_experiment_create(s.n, &e), PALP_OK);
    if (has_temperature)
        ck_assert_int_eq(palp_experiment_add_column(e, "temperature_C"), PALP_OK);
    for (size_t i = 0; i < s.n; i++) {
        palp_experiment_column(e, "time_s")[i] = s.time_s[i];
        palp_experiment_column(e, "depth_mm")[i] = 1e3 * s.depth_m[i];
        palp_experiment_column(e, "force_N")[i] = s.force_N[i] + 1e-4 * white_noise(&seed);
        if (has_temperature)
            palp_experiment_column(e, "temperature_C")[i] = temperature[i];
    }
    return e;
}

START_TEST(is_found_where_temperature_was_recorded) {
    palp_explain_settings settings = palp_explain_settings_default();
    palp_explain_input input[3];
    palp_explanation e;
    palp_error error = {PALP_OK, ""};
    palp_model truth = lumped_model(1), plain = truth;
    const bool has_temperature = _i == 0;
    memset(settings.candidate, 0, sizeof settings.candidate);
    settings.candidate[PALP_EFFECT_THERMAL_EXPANSION] = settings.candidate[PALP_EFFECT_SENSOR_DRIFT] = 1;
    add_effect(&truth, PALP_EFFECT_THERMAL_EXPANSION, 0)->value[0] = 6e-6;
    for (size_t r = 0; r < 3; r++)
        input[r] = (palp_explain_input){recording(&truth, 2 + (double)r, has_temperature, 11 + r), "run"};
    palp_status status = palp_explain(&plain, 3, input, &settings, &e, &error);
    ck_assert_msg(status == PALP_OK, "%s", error.text);
    if (has_temperature) {
        ck_assert_uint_eq(e.n_effects, 1);
        ck_assert_int_eq(e.effect[0].effect.id, PALP_EFFECT_THERMAL_EXPANSION);
        ck_assert_double_eq_tol(e.effect[0].effect.value[0], 6e-6, 2e-7);
        ck_assert_double_le(e.effect[0].low[0], 6e-6);
        ck_assert_double_ge(e.effect[0].high[0], 6e-6);
    } else {
        ck_assert_uint_eq(e.n_effects, 0);
        for (size_t i = 0; i < e.n_candidates; i++)
            if (e.candidate[i].id == PALP_EFFECT_THERMAL_EXPANSION)
                ck_assert_str_eq(e.candidate[i].reason, "no run has a temperature_C that changes");
    }
    palp_explanation_free(&e);
    for (size_t r = 0; r < 3; r++)
        palp_experiment_free((palp_experiment *)input[r].experiment);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, is_a_depth_that_grows);
    tcase_add_test(tc, off_or_without_temperature_changes_no_bit);
    tcase_add_test(tc, has_its_derivatives);
    tcase_add_loop_test(tc, is_found_where_temperature_was_recorded, 0, 2);
}
