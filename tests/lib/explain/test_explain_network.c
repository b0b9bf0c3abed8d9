/* test_explain_network.c: effects hidden in a network are named. check: all */
#include "forward_make.h"

#include <palpate/explain.h>

#include <stdint.h>
#include <stdio.h>

enum { RUNS = 4 };
static palp_explain_input input[RUNS];

/* Presses of the model with white noise, the first again at the end. */
static void session(const palp_model *m) {
    static const double plan[RUNS][2] = {{4, 1}, {6, 2}, {8, 0.5}, {4, 1}};
    static samples s;
    uint64_t state = 7;
    for (size_t r = 0; r < RUNS; r++) {
        palp_experiment *e;
        start(&s, 0, -0.5);
        go(&s, 0.5, -0.5, 10);
        go(&s, 0.5 + plan[r][1], plan[r][0], 100);
        go(&s, 15, plan[r][0], 150);
        go(&s, 15 + plan[r][1], -0.5, 100);
        palp_forward_run run = {
            .n = s.n, .time_s = s.time_s, .depth_m = s.depth_m, .session_s = 200 * (double)r};
        ck_assert_int_eq(palp_forward_network(m, NULL, &run, s.force_N, NULL), PALP_OK);
        ck_assert_int_eq(palp_experiment_create(s.n, &e), PALP_OK);
        for (size_t i = 0; i < s.n; i++) {
            palp_experiment_column(e, "time_s")[i] = s.time_s[i];
            palp_experiment_column(e, "depth_mm")[i] = 1e3 * s.depth_m[i];
            palp_experiment_column(e, "force_N")[i] = s.force_N[i] + 2e-3 * white_noise(&state);
        }
        palp_experiment_set_string(e, "protocol.kind", "ramp_hold");
        palp_experiment_set_number(e, "protocol.depth_mm", plan[r][0]);
        palp_experiment_set_number(e, "protocol.ramp_s", plan[r][1]);
        palp_experiment_set_number(e, "session.start_s", 200 * (double)r);
        input[r] = (palp_explain_input){e, "run.csv"};
    }
}

/* What is made of runs of truth by a network that is ten per cent off. The candidates are some of each stage.
 */
static void explain(const palp_model *truth, palp_explanation *e) {
    static const palp_effect_id candidates[] = {PALP_EFFECT_RELAXATION_ARM,  PALP_EFFECT_STRAIN_DEPENDENT_ARM,
                                                PALP_EFFECT_RATE_STIFFENING, PALP_EFFECT_FRAME_COMPLIANCE,
                                                PALP_EFFECT_SENSOR_LAG,      PALP_EFFECT_SENSOR_BIAS,
                                                PALP_EFFECT_PLATE_SLIP};
    palp_explain_settings settings = palp_explain_settings_default();
    palp_model guess = lattice_model(1, 3);
    palp_error error = {.text = ""};
    ck_assert_int_eq(palp_law_scale(&guess.material.law, 1.1, &guess.material.law), PALP_OK);
    guess.material.arms[0].viscosity_Ns *= 1.1;
    memset(settings.candidate, 0, sizeof settings.candidate);
    for (size_t i = 0; i < sizeof candidates / sizeof *candidates; i++)
        settings.candidate[candidates[i]] = 1;
    session(truth);
    palp_status status = palp_explain(&guess, RUNS, input, &settings, e, &error);
    ck_assert_msg(status == PALP_OK, "%s", error.text);
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}

START_TEST(a_network_misses_nothing) {
    palp_model truth = lattice_model(1, 3);
    palp_explanation e;
    explain(&truth, &e);
    ck_assert_int_eq(e.verdict, PALP_EXPLAIN_AGREES);
    ck_assert_uint_eq(e.n_effects, 0);
    ck_assert_double_eq_tol(e.white_N, 2e-3, 3e-4);
    palp_explanation_free(&e);
}
END_TEST

/* Its own id must be named; the strength must be in the interval where the effect has no look-alike. */
START_TEST(an_effect_hidden_in_a_network_is_named) {
    static const struct {
        palp_effect_id id;
        double value[2];
    } hidden[] = {{PALP_EFFECT_SENSOR_LAG, {0.06, 0}},
                  {PALP_EFFECT_RELAXATION_ARM, {0.08, 0.15}},
                  {PALP_EFFECT_STRAIN_DEPENDENT_ARM, {2.5, 0}}};
    palp_model truth = lattice_model(1, 3);
    palp_explanation e;
    truth.effects[truth.n_effects++] =
        (palp_effect){.id = hidden[_i].id, .value = {hidden[_i].value[0], hidden[_i].value[1]}};
    explain(&truth, &e);
    ck_assert_uint_eq(e.n_effects, 1);
    ck_assert_int_eq(e.effect[0].effect.id, hidden[_i].id);
    for (size_t k = 0; k < palp_effect_look_up(hidden[_i].id)->n_parameters; k++)
        ck_assert_msg(e.effect[0].low[k] <= hidden[_i].value[k] && hidden[_i].value[k] <= e.effect[0].high[k],
                      "parameter %zu: %g to %g", k, e.effect[0].low[k], e.effect[0].high[k]);
    ck_assert_int_ne(e.verdict, PALP_EXPLAIN_UNEXPLAINED);
    ck_assert(e.gap.closed > 0.9);
    ck_assert_int_eq(e.model.kind, PALP_MODEL_NETWORK);
    palp_explanation_free(&e);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, a_network_misses_nothing);
    tcase_add_loop_test(tc, an_effect_hidden_in_a_network_is_named, 0, 3);
}
