/* test_infer_specimens.c: specimens of other heights, areas and stiffnesses, one test each, in one session.
 * check: once */
#include "forward_make.h"

#include <palpate/explain.h>
#include <palpate/random.h>

enum { RUNS = 8, EACH = 140 };
static const double SPREAD = 0.2, FRICTION = 0.02;

static palp_explain_input input[RUNS];
static double factor[RUNS], friction;
static bool law_alone;          /* the arms are alike */
static double range = HUGE_VAL; /* N: where the sensor ends */

/* A press, a dwell and a withdrawal to the same strain at two speeds. */
static void record(uint64_t noise) {
    static samples s;
    for (size_t r = 0; r < RUNS; r++) {
        palp_model m = lumped_model(1);
        add_effect(&m, PALP_EFFECT_COULOMB_FRICTION, 0)->value[0] = friction;
        const double height = 0.8 + 0.4 * palp_random_uniform(&noise), area = 0.8 + 0.4 * (double)(r % 3) / 2;
        factor[r] = exp(SPREAD * palp_random_normal(&noise));
        m.height_m *= height;
        ck_assert_int_eq(palp_law_scale(&m.material.law, area * factor[r], &m.material.law), PALP_OK);
        m.material.arms[0].stiffness_N *= area * (law_alone ? 1 : factor[r]);
        m.material.arms[0].viscosity_Ns *= area * (law_alone ? 1 : factor[r]);
        start(&s, 0, -1);
        for (size_t i = 1; i < EACH; i++) {
            const double up = (double)i / (20 + 25 * (double)(r % 2)), down = (EACH - 15.0 - (double)i) / 40;
            s.time_s[i] = 0.05 * (double)i;
            s.depth_m[i] = 1e-3 * fmax(-1, 6 * height * fmin(1, fmin(up, down)) - 1);
        }
        s.n = EACH;
        press_model(&m, &s);
        for (size_t i = 0; i < EACH; i++)
            s.force_N[i] = fmin(range, s.force_N[i] + 2e-3 * palp_random_normal(&noise));
        palp_experiment *e = samples_experiment(&s);
        const char name[] = {(char)('a' + (int)r), '\0'};
        ck_assert_int_eq(palp_experiment_set_string(e, "specimen.name", name), PALP_OK);
        ck_assert_int_eq(palp_experiment_set_number(e, "specimen.height_mm", 1e3 * m.height_m), PALP_OK);
        ck_assert_int_eq(palp_experiment_set_number(e, "specimen.radius_mm", 1e3 * m.radius_m * sqrt(area)),
                         PALP_OK);
        input[r] = (palp_explain_input){e, "run.csv"};
    }
}

static void forget(void) {
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}

/* The answer where friction and one more effect are candidates. */
static palp_explanation explain(palp_effect_id other) {
    const palp_model m = lumped_model(1);
    palp_explanation e;
    palp_error error = {.text = ""};
    palp_explain_settings s = palp_explain_settings_default();
    memset(s.candidate, 0, sizeof s.candidate);
    s.candidate[PALP_EFFECT_COULOMB_FRICTION] = s.candidate[other] = true;
    record(7);
    ck_assert_msg(palp_explain(&m, RUNS, input, &s, &e, &error) == PALP_OK, "%s", error.text);
    forget();
    return e;
}

/* The friction is found as in one specimen; the spread, its interval and the specimens' factors
 * are those of the factors that were drawn: a sample's, which are far better known than their population. */
START_TEST(an_effect_in_specimens_that_differ) {
    friction = FRICTION;
    law_alone = false;
    palp_explanation e = explain(PALP_EFFECT_SENSOR_DRIFT);
    ck_assert_uint_eq(e.n_effects, 1);
    ck_assert_int_eq(e.effect[0].effect.id, PALP_EFFECT_COULOMB_FRICTION);
    ck_assert_double_eq_tol(e.effect[0].effect.value[0], FRICTION, 0.2 * FRICTION);
    ck_assert_uint_eq(e.specimens.n, RUNS);
    ck_assert(e.specimens.found && !e.specimens.law);
    double mean = 0, square = 0;
    for (size_t r = 0; r < RUNS; r++)
        mean += log(factor[r]) / RUNS;
    for (size_t r = 0; r < RUNS; r++)
        square += pow(log(factor[r]) - mean, 2);
    const double chi2[] = {16.0128, 1.6899}; /* 97.5 % and 2.5 % points, 7 degrees of freedom */
    ck_assert_double_eq_tol(e.specimens.sd, sqrt(square / (RUNS - 1)), 0.05 * e.specimens.sd);
    ck_assert_double_eq_tol(e.specimens.low, sqrt(square / chi2[0]), 0.06 * e.specimens.low);
    ck_assert_double_eq_tol(e.specimens.high, sqrt(square / chi2[1]), 0.06 * e.specimens.high);
    for (size_t r = 1; r < RUNS; r++) /* the mean belongs to the law */
        ck_assert_double_eq_tol(e.run[r].stiffness / e.run[0].stiffness, factor[r] / factor[0],
                                0.05 * factor[r] / factor[0]);
    palp_explanation_free(&e);
}
END_TEST

/* Their laws alone differ, which no one factor on all stiffnesses follows: nothing is accused of it, and the
 * spread is the laws'. */
START_TEST(laws_of_their_own_are_no_effect) {
    friction = 0;
    law_alone = true;
    palp_explanation e = explain(PALP_EFFECT_SENSOR_LAG);
    ck_assert_uint_eq(e.n_effects, 0);
    ck_assert(e.specimens.found && e.specimens.law && !e.gain.found);
    for (size_t r = 1; r < RUNS; r++)
        ck_assert_double_eq_tol(e.run[r].stiffness / e.run[0].stiffness, factor[r] / factor[0],
                                0.05 * factor[r] / factor[0]);
    const size_t n = e.model.material.law.n + 2, arm = n - 2;
    const double spring = e.model.between[0] / pow(e.model.material.law.coefficients[0], 2),
                 own = e.model.between[arm * (n + 1)] / pow(e.model.material.arms[0].stiffness_N, 2);
    ck_assert_double_eq_tol(sqrt(spring), e.specimens.sd, 1e-6);
    ck_assert_double_lt(sqrt(own), 0.1 * e.specimens.sd);
    palp_explanation_free(&e);
}
END_TEST

/* The stiff specimens reach the end of the sensor's range, the soft ones do not. */
START_TEST(a_sensor_that_ends_is_found_beside_them) {
    friction = 0;
    law_alone = false;
    range = 1.5;
    palp_explanation e = explain(PALP_EFFECT_FORCE_SATURATION);
    range = HUGE_VAL;
    ck_assert_uint_eq(e.n_effects, 1);
    ck_assert_int_eq(e.effect[0].effect.id, PALP_EFFECT_FORCE_SATURATION);
    ck_assert_double_eq_tol(e.effect[0].effect.value[0], 1.5, 5e-3);
    palp_explanation_free(&e);
}
END_TEST

/* The same specimens without friction: the mean's material, each one's factor, and the spread.
 */
START_TEST(the_mean_of_specimens) {
    const palp_model truth = lumped_model(1);
    const palp_model specimen = {
        .kind = PALP_MODEL_LUMPED, .height_m = truth.height_m, .radius_m = truth.radius_m};
    const palp_explain_settings s = palp_explain_settings_default();
    const palp_explain_choice choice = {.least_arms = 1, .most_arms = 1};
    palp_specimens_fit fit;
    palp_specimens_point point;
    palp_error error = {.text = ""};
    friction = 0;
    law_alone = false;
    record(7);
    ck_assert_msg(palp_explain_material(&specimen, RUNS, input, &s, &choice, &fit, &error) == PALP_OK, "%s",
                  error.text);
    ck_assert_uint_eq(fit.n_specimens, RUNS);
    ck_assert_uint_eq(fit.n_spread, 1);
    double mean = 0, square = 0, strain = 0.15, is, found;
    for (size_t r = 0; r < RUNS; r++)
        mean += log(factor[r]) / RUNS;
    for (size_t r = 0; r < RUNS; r++) {
        square += pow(log(factor[r]) - mean, 2);
        ck_assert_double_eq_tol(fit.factor[r], factor[r] / exp(mean), 0.05 * fit.factor[r]);
        palp_law_stiffness(&fit.own[r].law, strain, &found, NULL);
        palp_law_stiffness(&fit.mean.material.law, strain, &is, NULL);
        ck_assert_double_eq_tol(found, fit.factor[r] * is, 1e-6 * found);
    }
    ck_assert_int_eq(palp_specimens_fit_stiffness(&fit, 1, &strain, &point), PALP_OK);
    palp_law_stiffness(&truth.material.law, strain, &is, NULL);
    ck_assert_double_eq_tol(point.stiffness_N, exp(mean) * is, 0.05 * is);
    ck_assert_double_eq_tol(point.between_N, sqrt(square / (RUNS - 1)) * point.stiffness_N,
                            0.1 * point.between_N);
    ck_assert_double_lt(point.between_low, point.between_N);
    ck_assert_double_gt(point.between_high, point.between_N);
    ck_assert_double_lt(point.within_N, 0.2 * point.between_N);
    ck_assert_double_gt(point.sd_N, point.between_N / sqrt(RUNS));
    ck_assert_double_lt(point.sd_N, 2 * point.between_N / sqrt(RUNS));
    palp_specimens_fit_free(&fit);
    forget();
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, the_mean_of_specimens);
    tcase_add_test(tc, an_effect_in_specimens_that_differ);
    tcase_add_test(tc, laws_of_their_own_are_no_effect);
    tcase_add_test(tc, a_sensor_that_ends_is_found_beside_them);
}
