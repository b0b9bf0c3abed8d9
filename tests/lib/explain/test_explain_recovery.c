/* test_explain_recovery.c: a session whose specimen keeps its permanent set from run to run, and one whose
 * specimen has recovered before each run: the files say the same of both. check: once */
#include "forward_make.h"

#include <palpate/explain.h>

enum { RUNS = 5 };

static const double SET = 0.08, WHITE = 2e-3; /* WHITE: N */

static palp_experiment *made[RUNS];
static palp_explain_input input[RUNS];

static void session(const palp_model *truth, bool recovers) {
    static const double plan[RUNS][2] = {{5, 2}, {3, 0.5}, {6, 2}, {4, 1}, {6, 0.5}}; /* mm, mm/s */
    static samples s;
    uint64_t state = 5;
    palp_load_history kept = {0};
    for (size_t r = 0; r < RUNS; r++) {
        const double depth = plan[r][0], ramp_s = (depth + 1) / plan[r][1];
        start(&s, 0, -1);
        go(&s, ramp_s, depth, 60);
        go(&s, ramp_s + 3, depth, 40);
        go(&s, 2 * ramp_s + 3, -1, 60);
        go(&s, 3 * ramp_s + 3, depth, 60);
        go(&s, 4 * ramp_s + 3, -1, 60);
        palp_forward_run run = {.n = s.n,
                                .time_s = s.time_s,
                                .depth_m = s.depth_m,
                                .session_s = 300 * (double)r,
                                .history = recovers ? NULL : &kept};
        ck_assert_int_eq(palp_forward_force(truth, &run, s.force_N, NULL, NULL), PALP_OK);
        ck_assert_int_eq(palp_experiment_create(s.n, &made[r]), PALP_OK);
        for (size_t i = 0; i < s.n; i++) {
            palp_experiment_column(made[r], "time_s")[i] = s.time_s[i];
            palp_experiment_column(made[r], "depth_mm")[i] = 1e3 * s.depth_m[i];
            palp_experiment_column(made[r], "force_N")[i] = s.force_N[i] + WHITE * white_noise(&state);
        }
        palp_experiment_set_number(made[r], "session.start_s", 300 * (double)r);
        input[r] = (palp_explain_input){made[r], "run.csv"};
    }
    palp_load_history_free(&kept);
}

static void explain(const palp_model *given, palp_explanation *e) {
    palp_explain_settings settings = palp_explain_settings_default();
    palp_error error = {PALP_OK, ""};
    ck_assert_msg(palp_explain(given, RUNS, input, &settings, e, &error) == PALP_OK, "%s", error.text);
}

static void free_session(void) {
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free(made[r]);
}

/* The set is found, and the model with it explains the runs completely. */
static void found_as(bool recovers) {
    palp_model truth = lumped_model(1), given = truth;
    palp_explanation e, again;
    truth.effects[truth.n_effects++] = (palp_effect){.id = PALP_EFFECT_PERMANENT_SET, .value = {SET}};
    ck_assert_int_eq(palp_law_scale(&given.material.law, 1.05, &given.material.law), PALP_OK);
    session(&truth, recovers);
    explain(&given, &e);
    ck_assert_uint_eq(e.n_effects, 1);
    ck_assert_int_eq(e.effect[0].effect.id, PALP_EFFECT_PERMANENT_SET);
    ck_assert(e.effect[0].recovers == recovers);
    ck_assert_msg(e.effect[0].low[0] < SET && SET < e.effect[0].high[0], "%g to %g", e.effect[0].low[0],
                  e.effect[0].high[0]);
    ck_assert_double_eq_tol(e.gap.after_N, WHITE, 0.2 * WHITE);
    explain(&e.model, &again);
    ck_assert_uint_eq(again.n_effects, 0);
    ck_assert_int_eq(again.verdict, PALP_EXPLAIN_AGREES);
    palp_explanation_free(&again);
    palp_explanation_free(&e);
    free_session();
}

START_TEST(a_set_that_stays_is_found) {
    found_as(false);
}
END_TEST

START_TEST(a_set_that_is_gone_before_the_next_run_is_found) {
    found_as(true);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, a_set_that_stays_is_found);
    tcase_add_test(tc, a_set_that_is_gone_before_the_next_run_is_found);
}
