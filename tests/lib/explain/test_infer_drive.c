/* test_infer_drive.c: arms that the elastic force drives (Fung) with a law that stiffens, where the given
 * model's are linear, or the reverse: that is a law of the material, and no effect is named for it.
 * check: once */
#include "forward_make.h"

#include <palpate/explain.h>

enum { RUNS = 4, KNOTS = 5 };

static const double SD = 0.01, FIRST = 3; /* N */

/* Ten times as stiff at a strain of 0.25 as at the surface, or from next to nothing there; the arms are as
 * stiff as quasi-linear ones at half of that. */
static palp_model soft_tissue(bool quasi_linear, double first) {
    static const double strain[KNOTS] = {0, 0.0625, 0.125, 0.1875, 0.25};
    const double stiffness[KNOTS] = {first, 5.3, 9.5, 17, 30};
    palp_model m = lumped_model(2);
    ck_assert_int_eq(palp_law_spline(KNOTS, strain, stiffness, &m.material.law), PALP_OK);
    const double as_stiff = quasi_linear ? 1 : stiffness[2] / FIRST;
    m.material.quasi_linear = quasi_linear;
    m.material.arms[0] = (palp_arm){1.2 * as_stiff, 0.5 * as_stiff, 0, 0};
    m.material.arms[1] = (palp_arm){0.9 * as_stiff, 5.4 * as_stiff, 0, 0};
    return m;
}

/* Air, a press, a dwell, half the way back and forth, and out again, at a speed and to a depth of its own. */
static palp_experiment *record(const palp_model *m, size_t r, uint64_t *state) {
    static const double depth_mm[RUNS] = {5.8, 5.8, 4.1, 5}, way_s[RUNS] = {0.6, 6, 2, 0.6};
    static samples s;
    double t = 0.5;
    start(&s, 0, -1);
    go(&s, t, -1, 12);
    go(&s, t += way_s[r], depth_mm[r], 80);
    go(&s, t += 12, depth_mm[r], 120);
    go(&s, t += 0.5 * way_s[r], 0.5 * depth_mm[r], 40);
    go(&s, t += 0.5 * way_s[r], depth_mm[r], 40);
    go(&s, t += way_s[r], -1, 80);
    press_model(m, &s);
    for (size_t i = 0; i < s.n; i++)
        s.force_N[i] += SD * white_noise(state);
    return samples_experiment(&s);
}

/* The answer for runs of a tissue. The given model is the tissue's, but the drive of its arms may differ; so
 * may the first stiffness, which few samples show. */
static palp_explanation answer(bool quasi_linear, bool given, uint64_t state) {
    const palp_model truth = soft_tissue(quasi_linear, FIRST),
                     m = soft_tissue(given, given ? FIRST : 0.01 * FIRST);
    palp_explain_settings settings = palp_explain_settings_default();
    palp_explain_input input[RUNS];
    palp_explanation e;
    for (size_t r = 0; r < RUNS; r++)
        input[r] = (palp_explain_input){record(&truth, r, &state), "run"};
    ck_assert_int_eq(palp_explain(&m, RUNS, input, &settings, &e, NULL), PALP_OK);
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
    return e;
}

static void check_arms(bool quasi_linear, bool given) {
    const palp_model truth = soft_tissue(quasi_linear, FIRST);
    palp_explanation e = answer(quasi_linear, given, 3);
    const palp_material *found = &e.model.material;
    ck_assert_int_eq(found->quasi_linear, quasi_linear);
    ck_assert_int_eq(e.law.found, quasi_linear != given);
    ck_assert_msg(e.n_effects == 0, "%s is accused",
                  e.n_effects ? palp_effect_look_up(e.effect[0].effect.id)->id : "");
    ck_assert_int_eq(e.verdict, quasi_linear != given ? PALP_EXPLAIN_ANOTHER_LAW : PALP_EXPLAIN_AGREES);
    ck_assert_msg(e.gap.after_N < 1.05 * SD, "%g N are left", e.gap.after_N);
    ck_assert_msg(!e.law.found || e.law.without_N > 3 * SD, "with the given arms %g N are left",
                  e.law.without_N);
    for (size_t j = 0; j < 2; j++) {
        const palp_arm *is = &found->arms[j], *was = &truth.material.arms[j];
        const double time = is->viscosity_Ns / is->stiffness_N * was->stiffness_N / was->viscosity_Ns;
        ck_assert_msg(fabs(time - 1) < 0.1, "the time of arm %zu is %g of what it was", j + 1, time);
    }
    palp_explanation_free(&e);
}

START_TEST(arms_that_the_elastic_force_drives_are_found) {
    check_arms(true, false);
}
END_TEST

START_TEST(arms_that_the_strain_drives_are_found) {
    check_arms(false, true);
}
END_TEST

START_TEST(arms_as_given_stay) {
    check_arms(true, true);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, arms_that_the_elastic_force_drives_are_found);
    tcase_add_test(tc, arms_that_the_strain_drives_are_found);
    tcase_add_test(tc, arms_as_given_stay);
}
