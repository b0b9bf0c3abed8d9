/* test_explain_network_wear.c: damage hidden in a session of a network: its elements stay worn from run to
 * run, and explain finds it so. check: all */
#include "forward_make.h"

#include <palpate/explain.h>

#include <stdint.h>

enum { RUNS = 4 };
static palp_explain_input input[RUNS];

static palp_model network_model(void) {
    palp_model m = cube_model();
    m.material.arms[m.material.n_arms++] = (palp_arm){.stiffness_N = 0.08, .viscosity_Ns = 0.2};
    return m;
}

/* Presses and returns of one specimen, the deepest second: what comes after finds it worn. */
static void session(const palp_model *truth) {
    static const double depth[RUNS] = {4, 7, 5, 6};
    static samples s;
    uint64_t state = 11;
    palp_load_history wear = {0};
    for (size_t r = 0; r < RUNS; r++) {
        palp_experiment *e;
        start(&s, 0, -0.5);
        go(&s, 1.5, depth[r], 75);
        go(&s, 8, depth[r], 100);
        go(&s, 9.5, -0.5, 75);
        palp_forward_run run = {.n = s.n,
                                .time_s = s.time_s,
                                .depth_m = s.depth_m,
                                .session_s = 200 * (double)r,
                                .history = &wear};
        ck_assert_int_eq(palp_forward_network(truth, NULL, &run, s.force_N, NULL), PALP_OK);
        ck_assert_int_eq(palp_experiment_create(s.n, &e), PALP_OK);
        for (size_t i = 0; i < s.n; i++) {
            palp_experiment_column(e, "time_s")[i] = s.time_s[i];
            palp_experiment_column(e, "depth_mm")[i] = 1e3 * s.depth_m[i];
            palp_experiment_column(e, "force_N")[i] = s.force_N[i] + 2e-3 * white_noise(&state);
        }
        palp_experiment_set_string(e, "protocol.kind", "ramp_hold");
        palp_experiment_set_number(e, "protocol.depth_mm", depth[r]);
        palp_experiment_set_number(e, "session.start_s", 200 * (double)r);
        input[r] = (palp_explain_input){e, "run.csv"};
    }
    palp_load_history_free(&wear);
}

START_TEST(damage_stays_from_run_to_run) {
    static const palp_effect_id candidates[] = {PALP_EFFECT_DAMAGE_SOFTENING, PALP_EFFECT_PERMANENT_SET,
                                                PALP_EFFECT_RELAXATION_ARM, PALP_EFFECT_COULOMB_FRICTION};
    palp_explain_settings settings = palp_explain_settings_default();
    palp_model truth = network_model(), guess = truth;
    palp_explanation e;
    palp_error error = {PALP_OK, ""};
    truth.effects[truth.n_effects++] = (palp_effect){.id = PALP_EFFECT_DAMAGE_SOFTENING, .value = {0.3, 0.5}};
    ck_assert_int_eq(palp_law_scale(&guess.material.law, 1.1, &guess.material.law), PALP_OK);
    memset(settings.candidate, 0, sizeof settings.candidate);
    for (size_t i = 0; i < sizeof candidates / sizeof *candidates; i++)
        settings.candidate[candidates[i]] = 1;
    session(&truth);
    palp_status status = palp_explain(&guess, RUNS, input, &settings, &e, &error);
    ck_assert_msg(status == PALP_OK, "%s", error.text);
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
    ck_assert_uint_eq(e.n_effects, 1);
    ck_assert_int_eq(e.effect[0].effect.id, PALP_EFFECT_DAMAGE_SOFTENING);
    ck_assert_int_ne(e.verdict, PALP_EXPLAIN_UNEXPLAINED);
    ck_assert(e.gap.closed > 0.9);
    for (size_t k = 0; k < 2; k++)
        ck_assert_msg(e.effect[0].low[k] <= (k ? 0.5 : 0.3) && (k ? 0.5 : 0.3) <= e.effect[0].high[k],
                      "parameter %zu: %g to %g", k, e.effect[0].low[k], e.effect[0].high[k]);
    palp_explanation_free(&e);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, damage_stays_from_run_to_run);
}
