/* test_explain_units.c: explain's answers do not depend on the units of force, length and time. Nor do they
 * depend on the order of the runs, their names, or the clock's zero. The runs have time, depth and force
 * only, and contacts of their own. check: all */
#include "forward_make.h"

#include <palpate/explain.h>

#include <stdint.h>
#include <stdio.h>

enum { RUNS = 4, FILES = RUNS + 1 };

/* Times of SI units that a recording is in. */
typedef struct units {
    double force, length, time, zero_s;
    bool backwards;
    size_t cut; /* in the middle of the hold the second run goes on in another file: 1, behind it; 2, at
                   first; 0 = it does not */
} units;

static samples recorded[RUNS];

/* Runs of the lumped model with an effect, with noise. */
static void make(palp_effect_id id, double strength, double more) {
    static const double plan[RUNS][3] = {{4, 1, 0.05}, {6, 4, -0.04}, {7, 12, 0.02}, {4, 1, -0.03}};
    uint64_t state = 3;
    palp_model truth = lumped_model(1);
    palp_effect *effect = add_effect(&truth, id, 1);
    effect->value[0] = strength;
    effect->value[1] = more > 0 ? more : effect->value[1];
    for (size_t r = 0; r < RUNS; r++) {
        samples *s = &recorded[r];
        double ramp_s = (plan[r][0] + 1) / plan[r][1];
        start(s, -1, 0);
        go(s, 1, -1, 20);
        go(s, 1 + ramp_s, plan[r][0], 60);
        go(s, 11 + ramp_s, plan[r][0], 80);
        go(s, 11 + 2 * ramp_s, -1, 60);
        go(s, 12 + 2 * ramp_s, -1, 20);
        palp_forward_run run = {
            .n = s->n, .time_s = s->time_s, .depth_m = s->depth_m, .contact_m = 1e-3 * plan[r][2]};
        ck_assert_int_eq(palp_forward_force(&truth, &run, s->force_N, NULL, NULL), PALP_OK);
        for (size_t i = 0; i < s->n; i++)
            s->force_N[i] += 2e-3 * white_noise(&state);
    }
}

static palp_model guess(const units *u) { /* a tenth off */
    palp_model m = lumped_model(1);
    ck_assert_int_eq(palp_law_scale(&m.material.law, 1.1 * u->force, &m.material.law), PALP_OK);
    m.material.arms[0].stiffness_N *= u->force;
    m.material.arms[0].viscosity_Ns *= 1.1 * u->force * u->time;
    m.height_m *= u->length;
    return m;
}

/* Its samples from one to before another. */
static palp_experiment *in_units(const samples *s, const units *u, size_t from, size_t to) {
    palp_experiment *e;
    ck_assert_int_eq(palp_experiment_create(to - from, &e), PALP_OK);
    for (size_t i = from; i < to; i++) {
        palp_experiment_column(e, "time_s")[i - from] = u->zero_s + u->time * s->time_s[i];
        palp_experiment_column(e, "depth_mm")[i - from] = 1e3 * u->length * s->depth_m[i];
        palp_experiment_column(e, "force_N")[i - from] = u->force * s->force_N[i];
    }
    return e;
}

/* few: of all effects only those that look like these. */
static void explain(const units *u, bool few, palp_explanation *e) {
    static const palp_effect_id likes[] = {PALP_EFFECT_SENSOR_LAG, PALP_EFFECT_RELAXATION_ARM,
                                           PALP_EFFECT_COULOMB_FRICTION, PALP_EFFECT_RATE_STIFFENING,
                                           PALP_EFFECT_POWER_LAW_RELAXATION};
    palp_explain_settings settings = palp_explain_settings_default();
    for (int id = 0; id < PALP_EFFECT_COUNT && few; id++)
        settings.candidate[id] = 0;
    for (size_t i = 0; i < sizeof likes / sizeof *likes; i++)
        settings.candidate[likes[i]] = 1;
    palp_explain_input input[FILES];
    palp_error error = {.text = ""};
    palp_model m = guess(u);
    char name[FILES][16];
    size_t files = 0;
    for (size_t r = 0; r < RUNS; r++) {
        const samples *s = &recorded[u->backwards ? RUNS - 1 - r : r];
        const size_t cut = u->cut && r == 1 ? 130 : s->n;
        input[files++].experiment = in_units(s, u, 0, cut);
        if (cut < s->n)
            input[files++].experiment = in_units(s, u, cut, s->n);
    }
    if (u->cut == 2) {
        const palp_experiment *second = input[2].experiment;
        input[2] = input[0];
        input[0].experiment = second;
    }
    for (size_t f = 0; f < files; f++) {
        snprintf(name[f], sizeof name[f], "%c.csv", (int)(u->backwards ? 'z' - f : 'a' + f));
        input[f].name = name[f];
    }
    palp_status status = palp_explain(&m, files, input, &settings, e, &error);
    ck_assert_msg(status == PALP_OK, "%s", error.text);
    ck_assert_uint_eq(e->n_runs, RUNS);
    for (size_t r = 0; r < files; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}

/* Either half of a run, cut at any sample, says what is the matter: the first is a shorter run, the second is
 * refused by its name, in whatever units, where enough was pressed before. */
START_TEST(the_second_half_of_a_run_alone_is_refused) {
    static const units all[] = {{1, 1, 1, 0, false, 0}, {1e-9, 1e-4, 1e3, 1.7e9, false, 0}};
    static const size_t cuts[] = {50, 70, 100,
                                  170}; /* early and late in the ramp, in the hold, in the withdrawal */
    const units *u = &all[_i % 2];
    const size_t cut = cuts[_i / 2];
    palp_explain_settings settings = palp_explain_settings_default();
    palp_explain_input input[2];
    palp_error error = {.text = ""};
    palp_explanation e;
    palp_model m = guess(u);
    memset(settings.candidate, 0, sizeof settings.candidate);
    make(PALP_EFFECT_SENSOR_LAG, 0, 0);
    input[0] = (palp_explain_input){in_units(&recorded[0], u, 0, recorded[0].n), "whole.csv"};
    for (int first = 0; first < 2; first++) {
        palp_experiment *half =
            first ? in_units(&recorded[1], u, 0, cut) : in_units(&recorded[1], u, cut, recorded[1].n);
        input[1] = (palp_explain_input){half, "half.csv"};
        palp_status status = palp_explain(&m, 2, input, &settings, &e, &error);
        ck_assert_msg(status == (first ? PALP_OK : PALP_ERR_INPUT), "%s", error.text);
        if (first)
            palp_explanation_free(&e);
        else
            ck_assert_msg(strstr(error.text, "half.csv: begins under load"), "%s", error.text);
        palp_experiment_free(half);
    }
    palp_experiment_free((palp_experiment *)(uintptr_t)input[0].experiment);
}
END_TEST

static const units plain = {1, 1, 1, 0, false, 0};
static const units others[] = {{1e3, 10, 1, 0, false, 0},     {1, 1e-4, 1e-3, 0, false, 0},
                               {1, 1, 1, 1.7e9, false, 1}, /* the first three for nothing, too */
                               {1, 1, 1, 0, true, 0},         {1, 1, 1, 0, false, 2},
                               {1e-9, 1e-4, 1e3, 0, false, 0}};
enum { OTHERS = sizeof others / sizeof *others };

START_TEST(a_lag_is_named_in_any_units) {
    static palp_explanation first;
    palp_explanation e;
    const units *u = &others[_i];
    make(PALP_EFFECT_SENSOR_LAG, 0.15, 0);
    if (first.n_effects == 0)
        explain(&plain, false, &first);
    explain(u, false, &e);
    ck_assert_int_eq(first.verdict, PALP_EXPLAIN_EXPLAINED);
    ck_assert_int_eq(e.verdict, first.verdict);
    ck_assert_uint_eq(first.n_effects, 1);
    ck_assert_uint_eq(e.n_effects, 1);
    ck_assert_int_eq(first.effect[0].effect.id, PALP_EFFECT_SENSOR_LAG);
    ck_assert_int_eq(e.effect[0].effect.id, PALP_EFFECT_SENSOR_LAG);
    double wanted = u->time * first.effect[0].effect.value[0];
    ck_assert_double_eq_tol(first.effect[0].effect.value[0], 0.15, 0.01);
    ck_assert_double_eq_tol(e.effect[0].effect.value[0], wanted, 1e-4 * wanted);
    if (u->time == 1) /* the mains have a frequency: what is looked for there goes with the clock */
        ck_assert_double_eq_tol(e.contact.sd, u->length * first.contact.sd,
                                1e-3 * u->length * first.contact.sd);
    ck_assert(e.contact.found);
    for (size_t k = 0; k < e.n_candidates && u->time == 1 && u->length == 1; k++)
        ck_assert_double_eq_tol(e.candidate[k].share, first.candidate[k].share, 2e-3);
    palp_explanation_free(&e);
}
END_TEST

/* Of the effects that know a speed or a time. */
static const struct {
    palp_effect_id id;
    double strength, more;
} timed[] = {{PALP_EFFECT_COULOMB_FRICTION, 0.06, 0},
             {PALP_EFFECT_RATE_STIFFENING, 0.08, 0.01},
             {PALP_EFFECT_POWER_LAW_RELAXATION, 1.5, 0.3}};
enum { TIMED = sizeof timed / sizeof *timed };

/* In the units of the force; of the power law its remainder after ten seconds of the first clock. */
static double strength_of(const palp_effect *effect, const units *u) {
    if (effect->id == PALP_EFFECT_POWER_LAW_RELAXATION)
        return effect->value[0] * pow(10 * u->time, -effect->value[1]) / u->force;
    return effect->id == PALP_EFFECT_COULOMB_FRICTION ? effect->value[0] / u->force : effect->value[0];
}

START_TEST(what_knows_a_speed_or_time_is_named_in_any_units) {
    static const units all[] = {{1, 1, 1, 0, false, 0}, {1e-9, 10, 300, 0, false, 1}};
    palp_explanation e[2];
    make(timed[_i].id, timed[_i].strength, timed[_i].more);
    for (int k = 0; k < 2; k++)
        explain(&all[k], true, &e[k]);
    for (int k = 0; k < 2; k++) {
        ck_assert_int_eq(e[k].verdict, e[0].verdict);
        ck_assert_uint_eq(e[k].n_effects, 1);
        ck_assert_int_eq(e[k].effect[0].effect.id, timed[_i].id);
    }
    double first = strength_of(&e[0].effect[0].effect, &all[0]);
    /* log Z converges to a thousandth, which is 0.045 standard errors; that of the power law is 1.3 % */
    ck_assert_double_eq_tol(strength_of(&e[1].effect[0].effect, &all[1]), first, 3e-4 * first);
    for (int k = 0; k < 2; k++)
        palp_explanation_free(&e[k]);
}
END_TEST

START_TEST(nothing_is_nothing_in_any_units) {
    palp_explanation e;
    make(PALP_EFFECT_SENSOR_LAG, 0, 0);
    explain(&others[_i], false, &e);
    ck_assert_int_eq(e.verdict, PALP_EXPLAIN_AGREES);
    ck_assert_uint_eq(e.n_effects, 0);
    ck_assert_double_lt(e.gap.after_N, 1.1 * e.gap.noise_level_N);
    palp_explanation_free(&e);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, a_lag_is_named_in_any_units, 0, OTHERS);
    tcase_add_loop_test(tc, what_knows_a_speed_or_time_is_named_in_any_units, 0, TIMED);
    tcase_add_loop_test(tc, the_second_half_of_a_run_alone_is_refused, 0, 8);
    tcase_add_loop_test(tc, nothing_is_nothing_in_any_units, 0, 3);
}
