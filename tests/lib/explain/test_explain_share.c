/* test_explain_share.c: an effect is named only where these runs could show it conditional on the richest law
 * and arms, not on the current model. check: once */
#include "forward_make.h"

#include <palpate/explain.h>

#include <stdint.h>
#include <string.h>

enum { RUNS = 4 };

static samples recorded[RUNS];

/* Presses to several depths, each at its speed; with a hold and a way back, or none. */
static void press(const double plan[RUNS][2], bool whole) {
    for (size_t r = 0; r < RUNS; r++) {
        samples *s = &recorded[r];
        double ramp_s = (plan[r][0] + 1) / plan[r][1];
        start(s, -1, 0);
        go(s, ramp_s, plan[r][0], 120);
        if (whole) {
            go(s, ramp_s + 10, plan[r][0], 80);
            go(s, 2 * ramp_s + 10, -1, 60);
        }
    }
}

static void record(const palp_model *truth) {
    uint64_t state = 5;
    for (size_t r = 0; r < RUNS; r++) {
        samples *s = &recorded[r];
        palp_forward_run run = {
            .n = s->n, .time_s = s->time_s, .depth_m = s->depth_m, .contact_m = 2e-5 * (double)r};
        ck_assert_int_eq(palp_forward_force(truth, &run, s->force_N, NULL, NULL), PALP_OK);
        for (size_t i = 0; i < s->n; i++)
            s->force_N[i] += 2e-3 * white_noise(&state);
    }
}

static void explain(const palp_model *m, palp_explanation *e) {
    palp_explain_settings settings = palp_explain_settings_default();
    palp_explain_input input[RUNS];
    palp_error error = {.text = ""};
    for (size_t r = 0; r < RUNS; r++) {
        palp_experiment *run;
        const samples *s = &recorded[r];
        ck_assert_int_eq(palp_experiment_create(s->n, &run), PALP_OK);
        for (size_t i = 0; i < s->n; i++) {
            palp_experiment_column(run, "time_s")[i] = s->time_s[i];
            palp_experiment_column(run, "depth_mm")[i] = 1e3 * s->depth_m[i];
            palp_experiment_column(run, "force_N")[i] = s->force_N[i];
        }
        input[r] = (palp_explain_input){run, "run"};
    }
    palp_status status = palp_explain(m, RUNS, input, &settings, e, &error);
    ck_assert_msg(status == PALP_OK, "%s", error.text);
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}

static const palp_explain_candidate *candidate_of(const palp_explanation *e, palp_effect_id id) {
    for (size_t k = 0; k < e->n_candidates; k++)
        if (e->candidate[k].id == id)
            return &e->candidate[k];
    ck_abort_msg("no such candidate");
    return NULL;
}

/* A frame that gives way is a softer law, even where the model at hand has a law that cannot follow. */
START_TEST(what_a_law_takes_in_is_not_named) {
    static const double plan[RUNS][2] = {{4, 1}, {6, 4}, {7, 12}, {4, 2}};
    palp_explanation e;
    palp_model truth = lumped_model(1), m = truth;
    add_effect(&truth, PALP_EFFECT_FRAME_COMPLIANCE, 1)->value[0] = 1e-4;
    press(plan, true);
    record(&truth);
    explain(&m, &e);
    for (size_t i = 0; i < e.n_effects; i++)
        ck_assert_int_ne(e.effect[i].effect.id, PALP_EFFECT_FRAME_COMPLIANCE);
    const palp_explain_candidate *gain = candidate_of(&e, PALP_EFFECT_SENSOR_GAIN);
    ck_assert(!gain->identifiable);
    ck_assert_double_lt(gain->share, 0.5);
    palp_explanation_free(&e);
}
END_TEST

/* Presses at one speed without a way back may show effects that are there, and no others. */
START_TEST(loading_at_one_speed_names_nothing_else) {
    static const double plan[RUNS][2] = {{4, 1}, {6, 1}, {7, 1}, {4, 1}};
    static const struct {
        palp_effect_id id;
        double strength, second;
    } hidden[] = {{PALP_EFFECT_SENSOR_LAG, 0.4, 0},
                  {PALP_EFFECT_COULOMB_FRICTION, 0.05, 0},
                  {PALP_EFFECT_SENSOR_DRIFT, 0.01, 0},
                  {PALP_EFFECT_FRAME_COMPLIANCE, 1e-4, 0}};
    palp_explanation e;
    palp_model truth = lumped_model(1), m = truth;
    palp_effect *effect = add_effect(&truth, hidden[_i].id, 1);
    effect->value[0] = hidden[_i].strength;
    if (hidden[_i].second > 0)
        effect->value[1] = hidden[_i].second;
    press(plan, false);
    record(&truth);
    explain(&m, &e);
    for (size_t i = 0; i < e.n_effects; i++)
        ck_assert_msg(e.effect[i].effect.id == hidden[_i].id, "%s",
                      palp_effect_look_up(e.effect[i].effect.id)->id);
    palp_explanation_free(&e);
}
END_TEST

/* A softening law where the given one is straight: whatever is answered, its parts go together. */
START_TEST(the_parts_of_an_answer_go_together) {
    static const double plan[RUNS][2] = {{4, 4}, {6, 3}, {7, 14}, {4, 4}}, softens[] = {8.2, -9, 8},
                        straight = 8;
    palp_explanation e;
    palp_model truth = lumped_model(1), m = truth;
    ck_assert_int_eq(palp_law_polynomial(3, softens, &truth.material.law), PALP_OK);
    ck_assert_int_eq(palp_law_polynomial(1, &straight, &m.material.law), PALP_OK);
    press(plan, true);
    record(&truth);
    explain(&m, &e);
    const palp_explain_scatter *scatter[] = {&e.zero, &e.contact, &e.gain};
    for (size_t i = 0; i < 3; i++)
        if (scatter[i]->found)
            ck_assert_double_gt(scatter[i]->without_N, e.gap.after_N);
    ck_assert(e.gap.closed >= 0 && e.gap.closed <= 1);
    ck_assert(e.verdict != PALP_EXPLAIN_UNEXPLAINED || e.unexplained_N > 0);
    palp_explanation_free(&e);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, what_a_law_takes_in_is_not_named);
    tcase_add_test(tc, the_parts_of_an_answer_go_together);
    tcase_add_loop_test(tc, loading_at_one_speed_names_nothing_else, 0, 4);
}
