/* test_infer_bond.c: a plate that a specimen sticks to. The force jumps where it lets go, so that no
 * derivative determines the bond's strength. check: once */
#include "forward_make.h"

#include <palpate/explain.h>

enum { RUNS = 3 };

static const double FORCE = 0.08, REACH = 2e-4, NOISE = 2e-3; /* N, m, N */

static palp_explain_input input[RUNS];

/* Presses at several speeds, dwells and withdrawals into the air. */
static void session(const palp_model *truth) {
    static const double plan[RUNS][2] = {{4, 2}, {6, 1}, {5, 0.5}}; /* mm, mm/s */
    static samples s;
    uint64_t state = 8;
    for (size_t r = 0; r < RUNS; r++) {
        const double depth = plan[r][0], ramp_s = (depth + 1) / plan[r][1];
        start(&s, 0, -1);
        go(&s, ramp_s, depth, 60);
        go(&s, ramp_s + 10, depth, 40);
        go(&s, 2 * ramp_s + 10 + 2 / plan[r][1], -3, 200);
        press_model(truth, &s);
        for (size_t i = 0; i < s.n; i++)
            s.force_N[i] += NOISE * white_noise(&state);
        input[r] = (palp_explain_input){samples_experiment(&s), "run.csv"};
    }
}

static void explain(palp_explanation *e) {
    palp_explain_settings settings = palp_explain_settings_default();
    palp_error error = {.text = ""};
    palp_model truth = lumped_model(1);
    const palp_model given = truth;
    palp_effect *bond = add_effect(&truth, PALP_EFFECT_ADHESION, 1);
    bond->value[0] = FORCE;
    bond->value[1] = REACH;
    memset(settings.candidate, 0, sizeof settings.candidate);
    settings.candidate[PALP_EFFECT_ADHESION] = settings.candidate[PALP_EFFECT_SENSOR_BIAS] =
        settings.candidate[PALP_EFFECT_COULOMB_FRICTION] = 1;
    session(&truth);
    ck_assert_msg(palp_explain(&given, RUNS, input, &settings, e, &error) == PALP_OK, "%s", error.text);
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}

START_TEST(a_bond_is_as_strong_as_it_is) {
    palp_explanation e;
    explain(&e);
    ck_assert_uint_eq(e.n_effects, 1);
    ck_assert_int_eq(e.effect[0].effect.id, PALP_EFFECT_ADHESION);
    const palp_explain_effect *found = &e.effect[0];
    ck_assert_msg(found->low[0] <= FORCE && FORCE <= found->high[0], "%g N is in %g to %g N", FORCE,
                  found->low[0], found->high[0]);
    ck_assert_double_lt(found->high[0], 1.5 * FORCE);
    ck_assert_double_gt(found->low[0], 0.7 * FORCE);
    ck_assert_double_eq_tol(e.gap.after_N, NOISE, 0.2 * NOISE);
    palp_explanation_free(&e);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, a_bond_is_as_strong_as_it_is);
}
