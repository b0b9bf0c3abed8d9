/* test_infer.c: effects hidden in samples, found by the odds of their evidence. check: once */
#include "forward_make.h"

#include <palpate/explain.h>

enum { RUNS = 4, EACH = 220 };

static palp_explain_input input[RUNS];
static const char *const name[RUNS] = {"1.csv", "2.csv", "3.csv", "4.csv"};

/* Forces and lengths in these units. */
static void record(const palp_model *m, double force, double length) {
    static samples s;
    uint64_t noise = 4;
    for (size_t r = 0; r < RUNS; r++) {
        press_session_run(m, r, EACH, &noise, &s);
        for (size_t i = 0; i < EACH; i++) {
            s.force_N[i] *= force;
            s.depth_m[i] *= length;
        }
        input[r] = (palp_explain_input){samples_experiment(&s), name[r]};
    }
}

static void forget(void) {
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}

/* The model as given is ten per cent off, in the same units. */
static void ask(double force, double length, palp_explanation *e) {
    palp_model m = lumped_model(1);
    palp_error error = {.text = ""};
    const palp_explain_settings s = palp_explain_settings_default();
    ck_assert_int_eq(palp_law_scale(&m.material.law, 1.1 * force, &m.material.law), PALP_OK);
    m.material.arms[0].stiffness_N *= force;
    m.material.arms[0].viscosity_Ns *= 1.1 * force;
    m.height_m *= length;
    ck_assert_msg(palp_explain(&m, RUNS, input, &s, e, &error) == PALP_OK, "%s", error.text);
}

static const struct {
    palp_effect_id id;
    double strength;
} hidden[] = {
    {PALP_EFFECT_COULOMB_FRICTION, 0.02}, {PALP_EFFECT_SENSOR_LAG, 0.02}, {PALP_EFFECT_SENSOR_DRIFT, 4e-3}};

static palp_model with(int i) {
    palp_model m = lumped_model(1);
    add_effect(&m, hidden[i].id, 0)->value[0] = hidden[i].strength;
    return m;
}

START_TEST(nothing_hidden_nothing_named) {
    palp_model truth = lumped_model(1);
    palp_explanation e;
    record(&truth, 1, 1);
    ask(1, 1, &e);
    ck_assert_int_eq(e.verdict, PALP_EXPLAIN_AGREES);
    ck_assert_uint_eq(e.n_effects, 0);
    ck_assert_double_eq_tol(e.white_N, 2e-3, 2e-4);
    palp_explanation_free(&e);
    forget();
}
END_TEST

START_TEST(a_hidden_effect_is_named_with_its_interval) {
    palp_model truth = with(_i);
    palp_explanation e;
    record(&truth, 1, 1);
    ask(1, 1, &e);
    ck_assert_uint_eq(e.n_effects, 1);
    ck_assert_int_eq(e.effect[0].effect.id, hidden[_i].id);
    const double reach = 0.5 * (e.effect[0].high[0] - e.effect[0].low[0]) / 1.96; /* one sd */
    ck_assert_double_le(fabs(e.effect[0].effect.value[0] - hidden[_i].strength), 3.0 * reach);
    ck_assert_double_lt(e.effect[0].high[0] - e.effect[0].low[0], 0.5 * hidden[_i].strength);
    ck_assert_double_gt(e.effect[0].evidence, 10);
    palp_explanation_free(&e);
    forget();
}
END_TEST

/* Arms that the elastic force drives are another law, not an effect. */
START_TEST(quasi_linear_arms_are_another_law) {
    palp_model truth = lumped_model(1);
    palp_explanation e;
    truth.material.quasi_linear = true;
    record(&truth, 1, 1);
    ask(1, 1, &e);
    ck_assert_uint_eq(e.n_effects, 0);
    ck_assert(e.law.found);
    ck_assert_double_gt(e.law.evidence, 3);
    ck_assert_double_gt(e.law.without_N, e.gap.after_N);
    ck_assert_int_eq(e.verdict, PALP_EXPLAIN_ANOTHER_LAW);
    ck_assert(e.model.material.quasi_linear);
    palp_explanation_free(&e);
    forget();
}
END_TEST

/* The steps record the effect that was taken and the results of the others; the last has none. */
START_TEST(steps_tell_the_search) {
    palp_model truth = with(1);
    palp_explanation e;
    record(&truth, 1, 1);
    ask(1, 1, &e);
    ck_assert_uint_ge(e.n_steps, 2);
    ck_assert_int_eq(e.step[0].taken, PALP_EFFECT_SENSOR_LAG);
    ck_assert_int_eq(e.step[e.n_steps - 1].taken, PALP_EFFECT_COUNT);
    ck_assert_uint_eq(e.step[0].n_candidates, PALP_EFFECT_COUNT);
    size_t accepted = 0;
    double most = 0;
    for (size_t k = 0; k < e.n_candidates; k++) {
        const palp_explain_candidate *c = &e.candidate[k];
        accepted += c->accepted;
        ck_assert(c->accepted == (c->id == PALP_EFFECT_SENSOR_LAG));
        ck_assert(c->accepted || c->reason[0]);
        ck_assert_double_le(c->share, 1);
        most = fmax(most, c->identifiable ? c->score : 0);
        if (c->accepted)
            ck_assert_double_gt(c->explained_N, 2e-3);
        if (c->id == PALP_EFFECT_SESSION_AGEING) /* no file says when its run began */
            ck_assert(!c->identifiable);
    }
    ck_assert_uint_eq(accepted, 1);
    ck_assert_double_gt(most, 10);
    ck_assert_double_gt(e.effect[0].evidence_se, 0);
    ck_assert_double_gt(e.gap.heldout_before_N, 2 * e.gap.heldout_after_N);
    ck_assert_double_eq_tol(e.gap.heldout_after_N, 2e-3, 4e-4);
    ck_assert(!e.discrepancy.found);
    palp_explanation_free(&e);
    forget();
}
END_TEST

static void share_done(void *user, double share) {
    *(double *)user += share;
}

/* A law beyond the family of the given one, and nothing else; the reported work is 1 in all. */
START_TEST(a_law_of_another_family_is_its_own_word) {
    static const double truth_N[] = {8, 0, 200}, given_N[] = {9, 3};
    palp_model m = lumped_model(1);
    palp_explanation e;
    palp_explain_settings s = palp_explain_settings_default();
    double done = 0;
    s.progress = share_done;
    s.progress_user = &done;
    ck_assert_int_eq(palp_law_polynomial(3, truth_N, &m.material.law), PALP_OK);
    record(&m, 1, 1);
    ck_assert_int_eq(palp_law_polynomial(2, given_N, &m.material.law), PALP_OK);
    ck_assert_int_eq(palp_explain(&m, RUNS, input, &s, &e, NULL), PALP_OK);
    ck_assert_int_eq(e.verdict, PALP_EXPLAIN_ANOTHER_LAW);
    ck_assert_int_eq(e.base.material.law.kind, PALP_LAW_POLYNOMIAL);
    ck_assert_double_gt(e.law.without_N, 1.1 * e.gap.after_N);
    ck_assert_double_eq_tol(done, 1, 1e-9);
    palp_explanation_free(&e);
    forget();
}
END_TEST

/* Contacts that are known have no scatter and no offset; of the others it is found. */
START_TEST(contacts_may_be_known) {
    static const double by_m[RUNS] = {1e-4, -1.5e-4, 0.5e-4, -1e-4};
    palp_model m = lumped_model(1);
    palp_explanation e;
    palp_explain_settings s = palp_explain_settings_default();
    s.max_effects = 0;
    record(&m, 1, 1);
    for (size_t r = 0; r < RUNS; r++) {
        double *depth_mm =
            palp_experiment_column((palp_experiment *)(uintptr_t)input[r].experiment, "depth_mm");
        for (size_t i = 0; i < EACH; i++)
            depth_mm[i] += 1e3 * by_m[r];
    }
    ck_assert_int_eq(palp_explain(&m, RUNS, input, &s, &e, NULL), PALP_OK);
    ck_assert(e.contact.found);
    ck_assert_double_gt(e.contact.evidence, 10);
    ck_assert_double_gt(e.contact.without_N, 1.5 * e.gap.after_N);
    ck_assert_double_eq_tol(e.contact.sd, 1e-4, 6e-5);
    palp_explanation_free(&e);
    s.contact = PALP_CONTACT_KNOWN;
    ck_assert_int_eq(palp_explain(&m, RUNS, input, &s, &e, NULL), PALP_OK);
    ck_assert_double_eq(e.contact.sd, 0);
    ck_assert(!e.contact.found);
    ck_assert_double_gt(e.gap.after_N, 3e-3); /* nothing takes it in whole */
    palp_explanation_free(&e);
    forget();
}
END_TEST

/* The searches over sizes and noise end within a tolerance, in which the evidence may differ. */
START_TEST(units_change_nothing) {
    palp_model truth = with(0);
    palp_explanation e, other;
    record(&truth, 1, 1);
    ask(1, 1, &e);
    forget();
    record(&truth, 1000, 10);
    ask(1000, 10, &other);
    forget();
    ck_assert_int_eq(other.verdict, e.verdict);
    ck_assert_uint_eq(other.n_effects, e.n_effects);
    ck_assert_int_eq(other.effect[0].effect.id, e.effect[0].effect.id);
    ck_assert_double_eq_tol(other.effect[0].effect.value[0], 1000 * e.effect[0].effect.value[0],
                            1e-2 * other.effect[0].effect.value[0]);
    ck_assert_double_eq_tol(other.effect[0].evidence, e.effect[0].evidence, 0.03 * e.effect[0].evidence);
    palp_explanation_free(&e);
    palp_explanation_free(&other);
}
END_TEST

/* Law, arms and their number from samples alone, with nothing to start from. */
static void characterize(size_t n, size_t least, size_t most, palp_lumped_fit *fit) {
    palp_model specimen = {.kind = PALP_MODEL_LUMPED, .height_m = HEIGHT};
    palp_error error = {.text = ""};
    const palp_explain_settings s = palp_explain_settings_default();
    const palp_explain_choice choice = {.least_arms = least, .most_arms = most};
    palp_specimens_fit all;
    ck_assert_msg(palp_explain_material(&specimen, n, input, &s, &choice, &all, &error) == PALP_OK, "%s",
                  error.text);
    ck_assert_uint_eq(all.n_specimens, 0);
    *fit = all.mean;
}

static void check_within(const palp_estimate *e, double truth) {
    ck_assert_msg(fabs(log(e->value / truth)) < 3.0 * e->sd / e->value, "%s is %g +- %g, not %g", e->name,
                  e->value, e->sd, truth);
    ck_assert_double_lt(e->sd, 0.1 * e->value);
}

START_TEST(a_solid_is_found_from_nothing) {
    palp_model truth = lumped_model(2);
    palp_lumped_fit fit;
    truth.material.quasi_linear = _i == 1;
    truth.material.arms[0].viscosity_Ns = 5.0;
    record(&truth, 1, 1);
    characterize(RUNS, 0, PALP_ARMS_MAX, &fit);
    ck_assert_uint_eq(fit.material.n_arms, 2);
    ck_assert_int_eq(fit.material.quasi_linear, truth.material.quasi_linear);
    ck_assert_uint_eq(fit.n_parameters, fit.material.law.n + 4);
    for (size_t j = 0; j < 2; j++) { /* by rising time */
        const palp_estimate *arm = &fit.estimate[fit.material.law.n + 3 * j];
        const palp_arm *is = &truth.material.arms[1 - j];
        check_within(&arm[0], is->stiffness_N);
        check_within(&arm[2], is->viscosity_Ns / is->stiffness_N);
        ck_assert_double_eq_tol(arm[1].value, arm[0].value * arm[2].value, 1e-9 * arm[1].value);
    }
    double strain = 0.15, found, sd, is;
    ck_assert_int_eq(palp_lumped_fit_stiffness(&fit, 1, &strain, &found, &sd), PALP_OK);
    palp_law_stiffness(&truth.material.law, strain, &is, NULL);
    ck_assert_double_eq_tol(found, is, 3.0 * sd);
    for (size_t r = 0; r < RUNS; r++)
        ck_assert_double_eq_tol(fit.rms_N[r], 2e-3, 4e-4);
    palp_lumped_fit_free(&fit);
    forget();
}
END_TEST

/* Its noise is learned, whatever the unit of its force. */
START_TEST(one_run_has_the_same_answer_in_another_unit) {
    const palp_model truth = lumped_model(1);
    palp_lumped_fit fit[2];
    for (int i = 0; i < 2; i++) {
        record(&truth, i ? 3.0 : 1.0, 1);
        characterize(1, 1, 1, &fit[i]);
        forget();
    }
    for (size_t i = 0; i < fit[0].n_estimates; i++) {
        const palp_estimate *e = &fit[0].estimate[i], *other = &fit[1].estimate[i];
        const double unit = strcmp(e->unit, "s") == 0 ? 1.0 : 3.0;
        ck_assert_double_eq_tol(other->value, unit * e->value, 1e-6 * fabs(other->value));
        ck_assert_double_eq_tol(other->sd, unit * e->sd, 1e-5 * other->sd);
    }
    for (int i = 0; i < 2; i++)
        palp_lumped_fit_free(&fit[i]);
}
END_TEST

START_TEST(so_many_arms_as_asked_for) {
    palp_model truth = lumped_model(2);
    palp_lumped_fit fit;
    palp_specimens_fit none;
    palp_error error;
    const palp_explain_settings s = palp_explain_settings_default();
    const palp_explain_choice less = {.least_arms = 2, .most_arms = 1}, no_law = {.no_spline = true};
    truth.material.arms[0].viscosity_Ns = 5.0;
    record(&truth, 1, 1);
    characterize(RUNS, 1, 1, &fit);
    ck_assert_uint_eq(fit.material.n_arms, 1);
    palp_lumped_fit_free(&fit);
    ck_assert_int_eq(palp_explain_material(&truth, RUNS, input, &s, &less, &none, &error), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_explain_material(&truth, RUNS, input, &s, &no_law, &none, &error),
                     PALP_ERR_ARGUMENT);
    ck_assert_int_eq(
        palp_explain_material(&truth, 0, input, &s, &(palp_explain_choice){.most_arms = 1}, &none, &error),
        PALP_ERR_ARGUMENT);
    forget();
}
END_TEST

/* Of the calls of the search so many are let through. */
static bool no_more(void *user) {
    int *left = user;
    return (*left)-- <= 0;
}

/* Stopped at once nothing is named; stopped after the first effect, that one is, and stays. */
START_TEST(a_search_that_is_stopped_tells_what_it_found) {
    palp_model truth = with(0), m = lumped_model(1);
    palp_explain_settings s = palp_explain_settings_default();
    record(&truth, 1, 1);
    s.stop = no_more;
    for (int found = 0; found < 2; found++) {
        int left = found ? 3 * PALP_EFFECT_COUNT : 0;
        palp_explanation e;
        s.stop_user = &left;
        ck_assert_int_eq(palp_explain(&m, RUNS, input, &s, &e, NULL), PALP_OK);
        ck_assert(e.stopped);
        ck_assert_uint_eq(e.n_runs, RUNS);
        ck_assert_uint_eq(e.n_effects, (size_t)found);
        ck_assert(e.gap.noise_level_N > 0 && isfinite(e.gap.after_N));
        if (found)
            ck_assert_int_eq(e.effect[0].effect.id, hidden[0].id);
        palp_explanation_free(&e);
    }
    forget();
}
END_TEST

START_TEST(what_it_cannot_do_is_refused) {
    palp_model m = lumped_model(1);
    palp_explanation e;
    palp_explain_settings s = palp_explain_settings_default();
    record(&m, 1, 1);
    ck_assert_int_eq(palp_explain(&m, 0, input, &s, &e, NULL), PALP_ERR_ARGUMENT);
    s.max_effects = PALP_EFFECTS_MAX;
    ck_assert_int_eq(palp_explain(&m, RUNS, input, &s, &e, NULL), PALP_ERR_LIMIT);
    forget();
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, nothing_hidden_nothing_named);
    tcase_add_loop_test(tc, a_hidden_effect_is_named_with_its_interval, 0, sizeof hidden / sizeof *hidden);
    tcase_add_test(tc, quasi_linear_arms_are_another_law);
    tcase_add_test(tc, steps_tell_the_search);
    tcase_add_test(tc, a_law_of_another_family_is_its_own_word);
    tcase_add_test(tc, contacts_may_be_known);
    tcase_add_test(tc, units_change_nothing);
    tcase_add_loop_test(tc, a_solid_is_found_from_nothing, 0, 2);
    tcase_add_test(tc, one_run_has_the_same_answer_in_another_unit);
    tcase_add_test(tc, so_many_arms_as_asked_for);
    tcase_add_test(tc, a_search_that_is_stopped_tells_what_it_found);
    tcase_add_test(tc, what_it_cannot_do_is_refused);
}
