/* test_explain.c: runs made by the forward model with a known effect, and what is made of them. check: once
 */
#include "forward_make.h"

#include <palpate/explain.h>

#include <stdint.h>
#include <stdio.h>

enum { RUNS = 5 };

/* ---- runs ---- */

static uint64_t state;
static size_t density; /* 1: twice the samples, for a test that needs them; session_end sets it back to 0 */

/* Air, ramp, hold, withdrawal, air. */
static void ramp_hold(samples *s, double depth_mm, double rate_mm_s, double hold_s) {
    double ramp_s = (depth_mm + 1) / rate_mm_s;
    const size_t more = 1 + density;
    start(s, -1, 0);
    go(s, 1, -1, 10 * more);
    go(s, 1 + ramp_s, depth_mm, 60 * more);
    go(s, 1 + ramp_s + hold_s, depth_mm, 100 * more);
    go(s, 1 + 2 * ramp_s + hold_s, -1, 60 * more);
    go(s, 6 + 2 * ramp_s + hold_s, -1, 20 * more);
}

static palp_load_history worn; /* of the specimen so far */

static palp_experiment *record(const palp_model *m, double depth_mm, double rate_mm_s, double hold_s,
                               double session_s) {
    static samples s;
    palp_experiment *e;
    ramp_hold(&s, depth_mm, rate_mm_s, hold_s);
    palp_forward_run run = {
        .n = s.n, .time_s = s.time_s, .depth_m = s.depth_m, .session_s = session_s, .history = &worn};
    ck_assert_int_eq(palp_forward_force(m, &run, s.force_N, NULL, NULL), PALP_OK);
    ck_assert_int_eq(palp_experiment_create(s.n, &e), PALP_OK);
    for (size_t i = 0; i < s.n; i++) {
        palp_experiment_column(e, "time_s")[i] = s.time_s[i];
        palp_experiment_column(e, "depth_mm")[i] = 1e3 * s.depth_m[i];
        palp_experiment_column(e, "force_N")[i] = s.force_N[i] + 2e-3 * white_noise(&state);
    }
    palp_experiment_set_string(e, "protocol.kind", "ramp_hold");
    palp_experiment_set_number(e, "protocol.depth_mm", depth_mm);
    palp_experiment_set_number(e, "protocol.rate_mm_s", rate_mm_s);
    palp_experiment_set_number(e, "session.start_s", session_s);
    return e;
}

static palp_explain_input input[RUNS];

static void session(const palp_model *m) {
    static const double plan[RUNS][3] = {{3, 1, 20}, {5, 5, 20}, {7, 2, 30}, {6, 0.3, 5}, {3, 1, 20}};
    state = 7;
    worn.peak = 0;
    for (size_t r = 0; r < RUNS; r++)
        input[r] =
            (palp_explain_input){record(m, plan[r][0], plan[r][1], plan[r][2], 300 * (double)r), "run.csv"};
}

static void session_end(void) {
    density = 0;
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}

static palp_model with(palp_effect_id id, double strength) {
    palp_model m = lumped_model(1);
    if (strength != 0) {
        ck_assert_int_eq(palp_effect_default(id, &m.effects[0]), PALP_OK);
        m.effects[0].value[0] = strength;
        m.n_effects = 1;
    }
    return m;
}

static palp_model shaped(palp_effect_id id, double strength, double shape) {
    palp_model m = with(id, strength);
    m.effects[0].value[1] = shape;
    return m;
}

static palp_model guess(void) { /* ten per cent off */
    palp_model m = lumped_model(1);
    ck_assert_int_eq(palp_law_scale(&m.material.law, 1.1, &m.material.law), PALP_OK);
    m.material.arms[0].viscosity_Ns *= 1.1;
    return m;
}

static palp_status explain(const palp_explain_settings *s, palp_explanation *e) {
    palp_model m = guess();
    palp_error error = {.text = ""};
    palp_status status = palp_explain(&m, RUNS, input, s, e, &error);
    ck_assert_msg(status == PALP_OK, "%s", error.text);
    return status;
}

/* ---- tests ---- */

START_TEST(a_hidden_effect_is_named) {
    static const struct {
        palp_effect_id id;
        double strength;
    } hidden[] = {{PALP_EFFECT_SENSOR_BIAS, 0.05},
                  {PALP_EFFECT_COULOMB_FRICTION, 0.06},
                  {PALP_EFFECT_SENSOR_LAG, 0.05}};
    palp_model truth = with(hidden[_i].id, hidden[_i].strength);
    palp_explain_settings s = palp_explain_settings_default();
    palp_explanation e;
    session(&truth);
    explain(&s, &e);
    ck_assert_uint_eq(e.n_effects, 1);
    ck_assert_int_eq(e.effect[0].effect.id, hidden[_i].id);
    ck_assert_double_eq_tol(e.effect[0].effect.value[0], hidden[_i].strength, 0.1 * hidden[_i].strength);
    /* Within three standard errors: of 24 draws of the noise a 95 % interval missed the bias in three. */
    const double error = 0.5 * (e.effect[0].high[0] - e.effect[0].low[0]) / 1.96;
    ck_assert_double_eq_tol(e.effect[0].effect.value[0], hidden[_i].strength, 3 * error);
    ck_assert_double_lt(error, 0.006 * hidden[_i].strength);
    if (_i > 0) /* a run that is left out has a zero of its own, which takes a bias */
        ck_assert_double_gt(e.gap.closed, 0.7);
    ck_assert_int_eq(e.model.effects[0].id, hidden[_i].id);
    palp_explanation_free(&e);
    session_end();
}
END_TEST

/* A plain model lets the contacts of the runs differ instead, and a trial that keeps those contacts never
 * finds the toe. */
START_TEST(a_toe_is_no_scatter_of_contacts) {
    palp_model truth = with(PALP_EFFECT_TOE_REGION, 1.2e-3);
    palp_explain_settings s = palp_explain_settings_default();
    palp_explanation e;
    session(&truth);
    explain(&s, &e);
    ck_assert_int_eq(e.verdict, PALP_EXPLAIN_EXPLAINED);
    ck_assert_uint_eq(e.n_effects, 1);
    ck_assert_int_eq(e.effect[0].effect.id, PALP_EFFECT_TOE_REGION);
    ck_assert_double_eq_tol(e.effect[0].effect.value[0], 1.2e-3, 5e-5);
    ck_assert(!e.contact.found);
    palp_explanation_free(&e);
    session_end();
}
END_TEST

/* Zeros that differ from run to run may be within the sensor's range: its end is then the same in all runs.
 * Or they are added to the limited force, and the recorded end is as uncertain as the zeros are. */
START_TEST(a_sensor_ends_before_or_after_the_zeros_of_the_runs) {
    static const double zero[RUNS] = {0.05, 0.02, 0.09, 0.15, -0.03}, END = 2.4; /* N */
    const bool after = _i == 0;
    palp_model truth = lumped_model(1);
    palp_explain_settings s = palp_explain_settings_default();
    palp_explanation e;
    session(&truth);
    for (size_t r = 0; r < RUNS; r++) {
        palp_experiment *run = (palp_experiment *)(uintptr_t)input[r].experiment;
        double *force = palp_experiment_column(run, "force_N");
        for (size_t i = 0; i < palp_experiment_rows(run); i++)
            force[i] = after ? fmin(END, force[i] + zero[r]) : fmin(END, force[i]) + zero[r];
    }
    explain(&s, &e);
    ck_assert_uint_eq(e.n_effects, 1);
    ck_assert_int_eq(e.effect[0].effect.id, PALP_EFFECT_FORCE_SATURATION);
    const double error = 0.5 * (e.effect[0].high[0] - e.effect[0].low[0]) / 1.96;
    ck_assert_double_eq_tol(e.effect[0].effect.value[0], END, 3 * error);
    ck_assert_double_lt(error, after ? 2e-3 : 0.1);
    palp_explanation_free(&e);
    session_end();
}
END_TEST

/* A law of two coefficients cannot follow the one of five: no effect is accused of the difference. */
START_TEST(a_law_too_stiff_is_found_before_an_effect) {
    static const double few[] = {8, 4}; /* N */
    palp_model truth = lumped_model(1), m = truth;
    palp_explain_settings s = palp_explain_settings_default();
    palp_explanation e;
    ck_assert_int_eq(palp_law_polynomial(2, few, &m.material.law), PALP_OK);
    session(&truth);
    ck_assert_int_eq(palp_explain(&m, RUNS, input, &s, &e, NULL), PALP_OK);
    ck_assert_int_eq(e.verdict, PALP_EXPLAIN_ANOTHER_LAW);
    ck_assert_uint_eq(e.n_effects, 0);
    ck_assert(e.law.found);
    ck_assert_uint_eq(e.base.material.law.n, 2);
    ck_assert_uint_gt(e.model.material.law.n, 2);
    ck_assert_double_gt(e.law.without_N, 1.2 * e.gap.after_N);
    ck_assert_double_eq_tol(e.gap.after_N, 2e-3, 2e-4);
    palp_explanation_free(&e);
    session_end();
}
END_TEST

/* One specimen keeps its damage from run to run; the files' times give it, whatever their order. */
START_TEST(damage_lasts_for_the_session) {
    palp_model truth = shaped(PALP_EFFECT_DAMAGE_SOFTENING, 0.3, 0.5);
    palp_explain_settings s = palp_explain_settings_default();
    palp_explanation e;
    session(&truth);
    palp_explain_input last = input[RUNS - 1];
    input[RUNS - 1] = input[1];
    input[1] = last;
    explain(&s, &e);
    ck_assert_uint_ge(e.n_effects, 1);
    ck_assert_int_eq(e.effect[0].effect.id, PALP_EFFECT_DAMAGE_SOFTENING);
    ck_assert_double_eq_tol(e.effect[0].effect.value[0], 0.3, 0.03);
    ck_assert_double_lt(e.gap.after_N, 1.3 * e.gap.noise_level_N);
    double lasting_N = e.gap.after_N;
    palp_explanation_free(&e);
    for (size_t r = 0; r < RUNS; r++) { /* five specimens: not what happened */
        char name[16];
        snprintf(name, sizeof name, "%zu", r);
        palp_experiment_set_string((palp_experiment *)(uintptr_t)input[r].experiment, "specimen.name", name);
    }
    explain(&s, &e);
    ck_assert_double_gt(e.gap.after_N, 2 * lasting_N);
    palp_explanation_free(&e);
    session_end();
}
END_TEST

/* A law that bends down beyond what was pressed would make no model; the one that is found can be written. */
START_TEST(what_is_found_is_a_model) {
    palp_model truth = with(PALP_EFFECT_SENSOR_BIAS, 0.05);
    static const double falling[] = {8, 30, -120, 0, 0}; /* 0 at a strain of 0.41 */
    ck_assert_int_eq(palp_law_polynomial(5, falling, &truth.material.law), PALP_OK);
    palp_explain_settings s = palp_explain_settings_default();
    palp_explanation e;
    session(&truth);
    explain(&s, &e);
    for (int i = 0; i <= 100; i++) {
        double stiffness;
        palp_law_stiffness(&e.model.material.law, 0.4 * i / 100, &stiffness, NULL);
        ck_assert_double_gt(stiffness, 0);
    }
    palp_explanation_free(&e);
    session_end();
}
END_TEST

/* From the last task to the first. */
static void backwards(void *user, size_t n, void (*task)(void *work, size_t i), void *work) {
    (void)user;
    while (n-- > 0)
        task(work, n);
}

/* Candidates enough to be in another order. */
static void only_friction_and_its_like(palp_explain_settings *s) {
    memset(s->candidate, 0, sizeof s->candidate);
    s->candidate[PALP_EFFECT_COULOMB_FRICTION] = s->candidate[PALP_EFFECT_SENSOR_LAG] =
        s->candidate[PALP_EFFECT_SENSOR_GAIN] = 1;
    s->candidate[PALP_EFFECT_TOE_REGION] = s->candidate[PALP_EFFECT_RELAXATION_ARM] = 1;
}

static void add_share(void *user, double share) {
    double *done = user;
    ck_assert(share > 0 && share < 0.5);
    *done += share;
}

START_TEST(the_order_of_the_tasks_changes_no_bit) {
    palp_model truth = with(PALP_EFFECT_COULOMB_FRICTION, 0.06);
    palp_explain_settings s = palp_explain_settings_default();
    palp_explanation a, b;
    double done = 0;
    session(&truth);
    only_friction_and_its_like(&s);
    explain(&s, &a);
    s.loop = backwards;
    s.progress = add_share;
    s.progress_user = &done;
    explain(&s, &b);
    ck_assert_double_eq_tol(done, 1, 1e-9);
    ck_assert_uint_eq(a.n_effects, b.n_effects);
    ck_assert_mem_eq(a.effect[0].effect.value, b.effect[0].effect.value, sizeof a.effect[0].effect.value);
    ck_assert_mem_eq(&a.gap, &b.gap, sizeof a.gap);
    palp_explanation_free(&a);
    palp_explanation_free(&b);
    session_end();
}
END_TEST

START_TEST(a_run_held_out_is_not_fitted) {
    size_t held_out[] = {2};
    palp_model truth = with(PALP_EFFECT_SENSOR_BIAS, 0.05);
    palp_explain_settings s = palp_explain_settings_default();
    palp_explanation e;
    session(&truth);
    for (size_t i = 0; i < palp_experiment_rows(input[2].experiment); i++)
        palp_experiment_column((palp_experiment *)(uintptr_t)input[2].experiment, "force_N")[i] +=
            sin(0.7 * (double)i); /* nonsense, that no zero, contact or gain is */
    s.held_out = held_out;
    s.n_held_out = 1;
    explain(&s, &e);
    ck_assert_uint_eq(e.n_effects, 0); /* a bias helps to predict the others, and not this one */
    ck_assert_int_eq(e.verdict, PALP_EXPLAIN_SUSPECTED);
    ck_assert_double_eq_tol(e.white_N, 2e-3, 4e-4);
    ck_assert(e.gap.heldout_after_N > 0.6);
    palp_explanation_free(&e);
    session_end();
}
END_TEST

START_TEST(what_it_cannot_take_is_refused) {
    palp_model m = guess();
    palp_explain_settings s = palp_explain_settings_default();
    palp_explanation e;
    palp_error error;
    ck_assert_int_eq(palp_explain(&m, 0, NULL, &s, &e, &error), PALP_ERR_ARGUMENT);
    session(&m);
    m.kind = PALP_MODEL_NETWORK;
    m.density_kg_m3 = 1000;
    m.mesh = lattice_source(3, PALP_NEIGHBOURS_26);
    ck_assert_int_eq(palp_explain(&m, RUNS, input, &s, &e, &error), PALP_ERR_UNSUPPORTED);
    ck_assert_ptr_nonnull(strstr(error.text, "a network with mass"));
    session_end();
}
END_TEST

START_TEST(one_run_is_enough_and_air_alone_is_not) {
    palp_model m = guess();
    palp_explain_settings s = palp_explain_settings_default();
    palp_explanation e;
    palp_error error;
    session(&m);
    ck_assert_int_eq(palp_explain(&m, 1, input, &s, &e, &error), PALP_OK);
    ck_assert_int_eq(e.verdict, PALP_EXPLAIN_AGREES);
    palp_explanation_free(&e);
    double *depth = palp_experiment_column((palp_experiment *)(uintptr_t)input[0].experiment, "depth_mm");
    for (size_t i = 0; i < palp_experiment_rows(input[0].experiment); i++)
        depth[i] -= 100.0;
    ck_assert_int_eq(palp_explain(&m, 1, input, &s, &e, &error), PALP_ERR_INPUT);
    ck_assert_uint_eq(e.n_runs, 0);
    session_end();
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, a_hidden_effect_is_named, 0, 3);
    tcase_add_test(tc, a_toe_is_no_scatter_of_contacts);
    tcase_add_loop_test(tc, a_sensor_ends_before_or_after_the_zeros_of_the_runs, 0, 2);
    tcase_add_test(tc, a_law_too_stiff_is_found_before_an_effect);
    tcase_add_test(tc, the_order_of_the_tasks_changes_no_bit);
    tcase_add_test(tc, a_run_held_out_is_not_fitted);
    tcase_add_test(tc, damage_lasts_for_the_session);
    tcase_add_test(tc, what_is_found_is_a_model);
    tcase_add_test(tc, what_it_cannot_take_is_refused);
    tcase_add_test(tc, one_run_is_enough_and_air_alone_is_not);
}
