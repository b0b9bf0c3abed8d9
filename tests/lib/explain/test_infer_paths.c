/* test_infer_paths.c: information of presses along few paths on an effect, by the likelihood: at one speed,
 * and without a way back. check: once */
#include "forward_make.h"

#include <palpate/explain.h>
#include <palpate/random.h>

enum { RUNS = 4 };

static palp_explain_input input[RUNS];

/* Presses to several depths (mm), each at its speed (mm/s), with a hold or none. */
static void session(const palp_model *truth, const double plan[RUNS][2], bool holds) {
    static samples s;
    uint64_t noise = 5;
    for (size_t r = 0; r < RUNS; r++) {
        const double ramp_s = (plan[r][0] + 1) / plan[r][1];
        start(&s, -1, 0);
        go(&s, ramp_s, plan[r][0], 120);
        if (holds)
            go(&s, ramp_s + 10, plan[r][0], 80);
        palp_forward_run run = {
            .n = s.n, .time_s = s.time_s, .depth_m = s.depth_m, .contact_m = 2e-5 * (double)r};
        ck_assert_int_eq(palp_forward_force(truth, &run, s.force_N, NULL, NULL), PALP_OK);
        for (size_t i = 0; i < s.n; i++)
            s.force_N[i] += 2e-3 * palp_random_normal(&noise);
        input[r] = (palp_explain_input){samples_experiment(&s), "run"};
    }
}

static palp_explanation explain(const palp_model *given) {
    const palp_explain_settings settings = palp_explain_settings_default();
    palp_explanation e;
    palp_error error = {.text = ""};
    ck_assert_msg(palp_explain(given, RUNS, input, &settings, &e, &error) == PALP_OK, "%s", error.text);
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
    return e;
}

static const double one_speed[RUNS][2] = {{4, 1}, {6, 1}, {7, 1}, {4, 1}};

/* Neither law nor discrepancy may take the ripple's place, also where the given law cannot follow the runs.
 */
START_TEST(a_ripple_at_one_speed_is_named) {
    static const double straight = 8;
    palp_model truth = lumped_model(1), given = truth;
    palp_effect *ripple = add_effect(&truth, PALP_EFFECT_DRIVE_RIPPLE, 0);
    ripple->value[0] = 0.05;
    ripple->value[1] = 6.5e-4;
    ck_assert_int_eq(palp_law_polynomial(1, &straight, &given.material.law), PALP_OK);
    session(&truth, one_speed, false);
    palp_explanation e = explain(&given);
    ck_assert_uint_eq(e.n_effects, 1);
    const palp_effect *found = &e.effect[0].effect;
    ck_assert_int_eq(found->id, PALP_EFFECT_DRIVE_RIPPLE);
    ck_assert_double_eq_tol(fabs(found->value[0]), 0.05, 0.005);
    ck_assert_double_eq_tol(found->value[1], 6.5e-4, 1e-5);
    palp_explanation_free(&e);
}
END_TEST

/* Friction's step at the end of a ramp is the same after each, a fast relaxation's is not. */
START_TEST(friction_is_seen_where_ramps_end) {
    static const double plan[RUNS][2] = {{4, 1}, {6, 4}, {7, 12}, {5, 2}};
    palp_model truth = lumped_model(1), given = truth;
    palp_effect *friction = add_effect(&truth, PALP_EFFECT_COULOMB_FRICTION, 0);
    friction->value[0] = 0.06;
    session(&truth, plan, true);
    palp_explanation e = explain(&given);
    ck_assert_uint_eq(e.n_effects, 1);
    ck_assert_int_eq(e.effect[0].effect.id, PALP_EFFECT_COULOMB_FRICTION);
    ck_assert_double_eq_tol(e.effect[0].effect.value[0], 0.06, 0.003);
    palp_explanation_free(&e);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, a_ripple_at_one_speed_is_named);
    tcase_add_test(tc, friction_is_seen_where_ramps_end);
}
