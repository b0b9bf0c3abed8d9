/* test_explain_surface.c: surfaces that all runs have elsewhere, where the given law stands in for them.
 * check: once */
#include "base/dense.h"
#include "forward_make.h"

#include <palpate/explain.h>

enum { RUNS = 4, PLACES = 100 };

static const double STIFFNESS = 18, WHITE = 2e-2; /* N; with less of it no fit stays there */

/* A specimen of arms and a straight spring, whose surface is at surface_mm; pressed to 4 mm, held, and let
 * go. */
static palp_experiment *record(double surface_mm, double seconds, uint64_t *noise) {
    static samples s;
    palp_model m = linear_model(STIFFNESS);
    palp_experiment *e;
    m.material.n_arms = 1;
    m.material.arms[0] = (palp_arm){10, 10, 0, 0};
    start(&s, 0, -1 - surface_mm);
    go(&s, seconds, 4 - surface_mm, 250);
    go(&s, seconds + 3, 4 - surface_mm, 100);
    go(&s, 2 * seconds + 3, -1 - surface_mm, 250);
    press_model(&m, &s);
    ck_assert_int_eq(palp_experiment_create(s.n, &e), PALP_OK);
    for (size_t i = 0; i < s.n; i++) {
        palp_experiment_column(e, "time_s")[i] = s.time_s[i];
        palp_experiment_column(e, "depth_mm")[i] = 1e3 * s.depth_m[i] + surface_mm;
        palp_experiment_column(e, "force_N")[i] = s.force_N[i] + WHITE * white_noise(noise);
    }
    return e;
}

/* What is said of runs with these surfaces if a law is given as if the surface were higher by so much. */
static palp_explanation answer(const double surface_mm[RUNS], double higher_mm,
                               palp_explain_settings settings) {
    double strain[PLACES], force[PLACES], value[4], left;
    palp_explain_input input[RUNS];
    palp_explanation e;
    palp_model m = lumped_model(1);
    uint64_t noise = 5;
    m.material.arms[0] = (palp_arm){9, 10, 0, 0};
    for (size_t i = 0; i < PLACES; i++) {
        strain[i] = 4.5e-3 / HEIGHT * (double)(i + 1) / PLACES;
        force[i] = STIFFNESS * (strain[i] + 1e-3 * higher_mm / HEIGHT);
    }
    ck_assert_int_eq(dense_polynomial(PLACES, strain, force, 1, 4, value, &left), PALP_OK);
    ck_assert_int_eq(palp_law_polynomial(4, value, &m.material.law), PALP_OK);
    for (size_t r = 0; r < RUNS; r++)
        input[r] = (palp_explain_input){record(surface_mm[r], 1 + 3 * (double)r, &noise), "run"};
    ck_assert_int_eq(palp_explain(&m, RUNS, input, &settings, &e, NULL), PALP_OK);
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
    return e;
}

static double left_from(double higher_mm) {
    static const double surface_mm[RUNS] = {-0.35, -0.2, -0.3, -0.15};
    palp_explain_settings settings = palp_explain_settings_default();
    memset(settings.candidate, 0, sizeof settings.candidate);
    palp_explanation e = answer(surface_mm, higher_mm, settings);
    const double left = e.gap.after_N;
    palp_explanation_free(&e);
    return left;
}

/* A stiff beginning looks like a surface that is higher. */
START_TEST(where_the_law_has_the_surface_is_no_matter) {
    const double wanted = left_from(0), left = left_from(0.4);
    ck_assert_msg(left < 1.004 * wanted, "%g N, not %g N", left, wanted);
}
END_TEST

/* Far from where they were said to be, and near each other: an offset of all, not a scatter from run to run.
 */
START_TEST(what_surfaces_have_in_common_is_an_offset) {
    static const double surface_mm[RUNS] = {0.93, 0.95, 0.92, 0.94};
    palp_explanation e = answer(surface_mm, 0, palp_explain_settings_default());
    ck_assert_uint_eq(e.n_effects, 1);
    ck_assert_int_eq(e.effect[0].effect.id, PALP_EFFECT_CONTACT_OFFSET);
    ck_assert_double_eq_tol(1e3 * e.effect[0].effect.value[0], 0.935, 0.02);
    ck_assert_double_lt(e.contact.sd, 5e-5);
    palp_explanation_free(&e);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, what_surfaces_have_in_common_is_an_offset);
    tcase_add_test(tc, where_the_law_has_the_surface_is_no_matter);
}
