/* test_infer_given.c: what the given model has is kept: its arms with an added one, and its effects, whose
 * history lasts from run to run or not. Two effects that hide each other are added at once. check: once */
#include "forward_make.h"

#include <palpate/explain.h>

enum { RUNS = 4 };

static const double SET = 0.08, NOISE = 2e-3; /* NOISE: N */

static palp_explain_input input[RUNS];

/* Presses, dwells and withdrawals, each pressed once more to the same depth; their order is in the files. */
static void session(const palp_model *truth, bool recovers) {
    static const double plan[RUNS][2] = {{5, 2}, {3, 0.5}, {6, 2}, {4, 1}}; /* mm, mm/s */
    static samples s;
    uint64_t state = 5;
    palp_load_history kept = {0};
    for (size_t r = 0; r < RUNS; r++) {
        const double depth = plan[r][0], ramp_s = (depth + 1) / plan[r][1], session_s = 300 * (double)r;
        start(&s, 0, -1);
        go(&s, ramp_s, depth, 60);
        go(&s, ramp_s + 20, depth, 60);
        go(&s, 2 * ramp_s + 20, -1, 60);
        go(&s, 3 * ramp_s + 20, depth, 60);
        go(&s, 4 * ramp_s + 20, -1, 60);
        const palp_forward_run run = {.n = s.n,
                                      .time_s = s.time_s,
                                      .depth_m = s.depth_m,
                                      .session_s = session_s,
                                      .history = recovers ? NULL : &kept};
        ck_assert_int_eq(palp_forward_force(truth, &run, s.force_N, NULL, NULL), PALP_OK);
        for (size_t i = 0; i < s.n; i++)
            s.force_N[i] += NOISE * white_noise(&state);
        palp_experiment *made = samples_experiment(&s);
        palp_experiment_set_number(made, "session.start_s", session_s);
        input[r] = (palp_explain_input){made, "run.csv"};
    }
    palp_load_history_free(&kept);
}

/* The session of a solid with one arm more than the model has. */
static void session_with_arm(double stiffness_N, double time_s) {
    palp_model truth = lumped_model(1);
    palp_effect *hidden = add_effect(&truth, PALP_EFFECT_RELAXATION_ARM, 0);
    hidden->value[0] = stiffness_N;
    hidden->value[1] = time_s;
    session(&truth, true);
}

/* The answer to the session, by a model whose law is five per cent off; the session is freed. */
static palp_explanation explain(palp_model given, const palp_explain_settings *settings) {
    palp_explanation e;
    palp_error error = {PALP_OK, ""};
    ck_assert_int_eq(palp_law_scale(&given.material.law, 1.05, &given.material.law), PALP_OK);
    ck_assert_msg(palp_explain(&given, RUNS, input, settings, &e, &error) == PALP_OK, "%s", error.text);
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
    return e;
}

/* The plain fit's arm goes to the hidden one, which is stronger; the hidden one is called added all the same.
 */
START_TEST(the_added_arm_is_the_hidden_one) {
    const palp_explain_settings all = palp_explain_settings_default();
    const palp_arm was = lumped_model(1).material.arms[0];
    session_with_arm(4, 1.5);
    palp_explanation e = explain(lumped_model(1), &all);
    ck_assert_uint_eq(e.n_effects, 1);
    ck_assert_int_eq(e.effect[0].effect.id, PALP_EFFECT_RELAXATION_ARM);
    ck_assert_double_eq_tol(e.effect[0].effect.value[0], 4, 0.1);
    ck_assert_double_eq_tol(e.effect[0].effect.value[1], 1.5, 0.05);
    const palp_arm *arm = &e.model.material.arms[0];
    ck_assert_double_eq_tol(arm->stiffness_N, was.stiffness_N, 0.05 * was.stiffness_N);
    ck_assert_double_eq_tol(arm->viscosity_Ns, was.viscosity_Ns, 0.05 * was.viscosity_Ns);
    palp_explanation_free(&e);
}
END_TEST

/* An arm that the runs hardly determine cannot be negative: its interval is above zero, and longer upwards.
 * The specimen could as well be poroelastic, which is no candidate here. */
START_TEST(an_interval_of_what_is_positive_is_positive) {
    palp_explain_settings arms = palp_explain_settings_default();
    memset(arms.candidate, 0, sizeof arms.candidate);
    arms.candidate[PALP_EFFECT_RELAXATION_ARM] = 1;
    session_with_arm(0.13, 6);
    palp_explanation e = explain(lumped_model(1), &arms);
    ck_assert_uint_eq(e.n_effects, 1);
    ck_assert_int_eq(e.effect[0].effect.id, PALP_EFFECT_RELAXATION_ARM);
    const double value = e.effect[0].effect.value[0], low = e.effect[0].low[0], high = e.effect[0].high[0];
    ck_assert_double_gt(low, 0);
    ck_assert_double_eq_tol(high / value, value / low, 1e-9 * high / value);
    ck_assert(low < 0.13 && 0.13 < high);
    palp_explanation_free(&e);
}
END_TEST

/* Nothing is missing with a given permanent set, whether the specimen recovers from it or not. */
START_TEST(what_is_given_lasts_or_not_as_the_runs_tell) {
    palp_model truth = lumped_model(1);
    add_effect(&truth, PALP_EFFECT_PERMANENT_SET, 0)->value[0] = SET;
    session(&truth, _i == 1);
    const palp_explain_settings all = palp_explain_settings_default();
    palp_explanation e = explain(truth, &all);
    ck_assert_uint_eq(e.n_effects, 0);
    ck_assert_double_eq_tol(e.gap.after_N, NOISE, 0.2 * NOISE);
    palp_explanation_free(&e);
}
END_TEST

/* What the lag takes from the force the arm adds: neither alone is more probable than nothing. */
START_TEST(a_lag_and_an_arm_are_found_together) {
    const palp_explain_settings all = palp_explain_settings_default();
    palp_model truth = lumped_model(1);
    add_effect(&truth, PALP_EFFECT_SENSOR_LAG, 0)->value[0] = 0.008;
    palp_effect *arm = add_effect(&truth, PALP_EFFECT_RELAXATION_ARM, 0);
    arm->value[0] = 0.97;
    arm->value[1] = 0.1;
    session(&truth, true);
    palp_explanation e = explain(lumped_model(1), &all);
    for (size_t k = 0; k < e.step[0].n_candidates; k++)
        ck_assert_double_le(e.step[0].candidate[k].score, 0);
    ck_assert_uint_eq(e.n_effects, 2);
    for (size_t i = 0; i < 2; i++) {
        const palp_effect *found = &e.effect[i].effect;
        bool arm_alike = false; /* pores may stand for the arm */
        for (size_t k = 0; k < e.effect[i].n_class; k++)
            arm_alike = arm_alike || e.effect[i].alike[k] == PALP_EFFECT_RELAXATION_ARM;
        ck_assert_double_gt(e.effect[i].evidence, 20);
        if (found->id == PALP_EFFECT_SENSOR_LAG)
            ck_assert_double_eq_tol(found->value[0], 0.008, 0.003);
        else
            ck_assert(arm_alike);
    }
    ck_assert_double_eq_tol(e.gap.after_N, NOISE, 0.05 * NOISE);
    palp_explanation_free(&e);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, a_lag_and_an_arm_are_found_together);
    tcase_add_test(tc, the_added_arm_is_the_hidden_one);
    tcase_add_test(tc, an_interval_of_what_is_positive_is_positive);
    tcase_add_loop_test(tc, what_is_given_lasts_or_not_as_the_runs_tell, 0, 2);
}
