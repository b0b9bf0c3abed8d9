/* test_infer_arms.c: arms of a material that are found in spite of noise that could take their place, arms at
 * fixed times, and fits of dwells alone. check: once */
#include "forward_make.h"

#include <palpate/explain.h>
#include <palpate/random.h>

enum { RUNS = 2, EACH = 900 };

static palp_explain_input input[RUNS];
static const char *const name[RUNS] = {"1.csv", "2.csv"};

static const double STEP = 60.0 / EACH;

/* Ramps to 4 and 6 mm that take so long, each held; ramp_N is added before the plate stands. */
static void record(const palp_model *m, const double ramp_s[RUNS], double noise_N, double ramp_N) {
    static samples s;
    uint64_t random = 7;
    for (size_t r = 0; r < RUNS; r++) {
        const double depth_mm = 4.0 + 2.0 * (double)r;
        start(&s, 0, -0.5);
        for (size_t i = 1; i < EACH; i++) {
            s.time_s[i] = STEP * (double)i;
            s.depth_m[i] = 1e-3 * fmin(depth_mm, -0.5 + s.time_s[i] / ramp_s[r] * (depth_mm + 0.5));
        }
        s.n = EACH;
        press_model(m, &s);
        for (size_t i = 0; i < EACH; i++) {
            const bool moves = i + 1 < EACH && s.depth_m[i + 1] > s.depth_m[i];
            s.force_N[i] += noise_N * palp_random_normal(&random) + (moves ? ramp_N : 0.0);
        }
        input[r] = (palp_explain_input){samples_experiment(&s), name[r]};
    }
}

static const double FAST_S[RUNS] = {0.5, 1.0}, SLOW_S[RUNS] = {15.0, 25.0}, ONE_HELD_S[RUNS] = {1.0, 60.0};

static void characterize(palp_explain_choice choice, palp_lumped_fit *fit) {
    palp_model specimen = {.kind = PALP_MODEL_LUMPED, .height_m = HEIGHT};
    palp_error error = {.text = ""};
    const palp_explain_settings s = palp_explain_settings_default();
    palp_specimens_fit all;
    ck_assert_msg(palp_explain_material(&specimen, RUNS, input, &s, &choice, &all, &error) == PALP_OK, "%s",
                  error.text);
    *fit = all.mean;
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}

/* Whether estimate i is what it should be, to three of its sds. */
static bool is_within(const palp_lumped_fit *fit, size_t i, double truth) {
    const palp_estimate *e = &fit->estimate[i];
    return fabs(log(e->value / truth)) < 3.0 * e->sd / e->value;
}

/* A sensor with a lag, which the model lacks: where the model does not fit the ramps, the dwells still give
 * the arms. */
START_TEST(a_misfit_of_ramps_hides_no_arms) {
    palp_model truth = lumped_model(2);
    palp_lumped_fit fit;
    add_effect(&truth, PALP_EFFECT_SENSOR_LAG, 0)->value[0] = 0.2;
    record(&truth, ONE_HELD_S, 4e-4, 0.0);
    characterize((palp_explain_choice){.most_arms = PALP_ARMS_MAX}, &fit);
    ck_assert_uint_ge(fit.material.n_arms, 1);
    const palp_arm *slow = &fit.material.arms[fit.material.n_arms - 1], *is = &truth.material.arms[0];
    double first, held, drive = 1.0; /* of arms that the elastic force drives, in the dwell at 4 mm */
    palp_law_stiffness(&fit.material.law, 0.0, &first, NULL);
    palp_law_stiffness(&fit.material.law, 4e-3 / HEIGHT, &held, NULL);
    if (fit.material.quasi_linear)
        drive = held / first;
    ck_assert_double_eq_tol(drive * slow->stiffness_N, is->stiffness_N, 0.03 * is->stiffness_N);
    ck_assert_double_eq_tol(drive * slow->viscosity_Ns, is->viscosity_Ns, 0.03 * is->viscosity_Ns);
    palp_lumped_fit_free(&fit);
}
END_TEST

/* Two arms a decade from four samples on, of which the solid has two. */
START_TEST(arms_at_fixed_times_are_told_apart) {
    const double time[2] = {4.0 * STEP * sqrt(10.0), 4.0 * STEP * 100.0}, stiffness[2] = {1.5, 0.9};
    palp_model truth = lumped_model(2);
    palp_lumped_fit fit;
    for (size_t j = 0; j < 2; j++)
        truth.material.arms[j] =
            (palp_arm){.stiffness_N = stiffness[j], .viscosity_Ns = stiffness[j] * time[j]};
    record(&truth, FAST_S, 2e-3, 0.0);
    characterize((palp_explain_choice){.per_decade = 2}, &fit);
    ck_assert_uint_eq(fit.material.n_arms, 2);
    for (size_t j = 0; j < 2; j++) {
        const size_t first = fit.material.law.n + 3 * j;
        ck_assert(is_within(&fit, first, stiffness[j]));
        ck_assert_double_eq_tol(fit.estimate[first + 2].value, time[j], 1e-4 * time[j]);
        ck_assert_double_lt(fit.estimate[first + 2].sd, 1e-5 * time[j]);
    }
    palp_lumped_fit_free(&fit);
}
END_TEST

START_TEST(too_many_fixed_arms_are_refused) {
    const palp_model truth = lumped_model(1);
    palp_model specimen = {.kind = PALP_MODEL_LUMPED, .height_m = HEIGHT};
    const palp_explain_settings s = palp_explain_settings_default();
    const palp_explain_choice choice = {.per_decade = 12};
    palp_specimens_fit all;
    palp_error error = {.text = ""};
    record(&truth, FAST_S, 2e-3, 0.0);
    ck_assert_int_eq(palp_explain_material(&specimen, RUNS, input, &s, &choice, &all, &error),
                     PALP_ERR_LIMIT);
    ck_assert_ptr_nonnull(strstr(error.text, "12 arms a decade"));
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}
END_TEST

/* The stiffness of the only arm moves with what is wrong on the ramps, but not if dwells alone are fitted. */
START_TEST(dwells_alone_know_nothing_of_the_ramps) {
    const palp_model truth = lumped_model(1);
    double stiffness[2], sd = 0.0;
    for (int wrong = 0; wrong < 2; wrong++) {
        palp_lumped_fit fit;
        record(&truth, SLOW_S, 2e-3, 0.1 * wrong);
        characterize((palp_explain_choice){.least_arms = 1, .most_arms = 1, .dwell_only = _i == 1}, &fit);
        stiffness[wrong] = fit.estimate[fit.material.law.n].value;
        sd = fit.estimate[fit.material.law.n].sd;
        palp_lumped_fit_free(&fit);
    }
    ck_assert((fabs(stiffness[1] - stiffness[0]) < 0.1 * sd) == (_i == 1));
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, a_misfit_of_ramps_hides_no_arms);
    tcase_add_test(tc, arms_at_fixed_times_are_told_apart);
    tcase_add_test(tc, too_many_fixed_arms_are_refused);
    tcase_add_loop_test(tc, dwells_alone_know_nothing_of_the_ramps, 0, 2);
}
