/* test_infer_contacts.c: a contact that was found wrong moves neither the other ones nor the law, and a
 * material without anything missing is that of explain. check: once */
#include "forward_make.h"

#include <palpate/explain.h>

enum { RUNS = 4, EACH = 220, WRONG = 2 };

static palp_explain_input input[RUNS];
static const char *const name[RUNS] = {"1.csv", "2.csv", "3.csv", "4.csv"};

/* Contact of one run is later by so much than recorded depth 0. */
static void record(const palp_model *m, double late_m) {
    static samples s;
    uint64_t noise = 4;
    for (size_t r = 0; r < RUNS; r++) {
        press_session_run(m, r, EACH, &noise, &s);
        for (size_t i = 0; i < EACH; i++)
            s.depth_m[i] += r == WRONG ? late_m : 0.0;
        input[r] = (palp_explain_input){samples_experiment(&s), name[r]};
    }
}

static void forget(void) {
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}

static palp_lumped_fit characterize(const palp_explain_settings *settings) {
    const palp_model specimen = {.kind = PALP_MODEL_LUMPED, .height_m = HEIGHT};
    const palp_explain_choice choice = {.least_arms = 1, .most_arms = 1};
    palp_error error = {.text = ""};
    palp_specimens_fit all;
    ck_assert_msg(palp_explain_material(&specimen, RUNS, input, settings, &choice, &all, &error) == PALP_OK,
                  "%s", error.text);
    return all.mean;
}

START_TEST(one_wrong_contact_moves_no_other) {
    const double late = 0.3e-3, near = 0.01e-3;
    const palp_model truth = lumped_model(1);
    const palp_explain_settings settings = palp_explain_settings_default();
    record(&truth, late);
    palp_lumped_fit fit = characterize(&settings);
    for (size_t r = 0; r < RUNS; r++)
        ck_assert_double_eq_tol(fit.contact_m[r], r == WRONG ? late : 0.0, near);
    for (double strain = 0.05; strain < 0.2; strain += 0.05) {
        double found, is;
        palp_law_stiffness(&fit.material.law, strain, &found, NULL);
        palp_law_stiffness(&truth.material.law, strain, &is, NULL);
        ck_assert_double_eq_tol(found, is, 0.01 * is);
    }
    palp_lumped_fit_free(&fit);
    forget();
}
END_TEST

/* Explain has gains and a discrepancy besides, which find nothing here. */
START_TEST(explain_fits_the_same_material) {
    const palp_model truth = lumped_model(1);
    palp_explain_settings settings = palp_explain_settings_default();
    palp_explanation e;
    settings.contact = PALP_CONTACT_KNOWN;
    record(&truth, 0.0);
    palp_lumped_fit fit = characterize(&settings);
    for (size_t r = 0; r < RUNS; r++)
        ck_assert_double_eq(fit.contact_sd_m[r], 0.0);
    palp_model model = truth;
    model.material = fit.material;
    memset(settings.candidate, 0, sizeof settings.candidate);
    ck_assert_int_eq(palp_explain(&model, RUNS, input, &settings, &e, NULL), PALP_OK);
    const palp_material *other = &e.model.material;
    ck_assert_uint_eq(other->law.n, fit.material.law.n);
    for (size_t i = 0; i < fit.n_estimates; i++) {
        const size_t springs = other->law.n, what = i - springs;
        const palp_estimate *own = &fit.estimate[i];
        const double it = i < springs ? other->law.coefficients[i]
                          : what == 0 ? other->arms[0].stiffness_N
                          : what == 1 ? other->arms[0].viscosity_Ns
                                      : other->arms[0].viscosity_Ns / other->arms[0].stiffness_N;
        ck_assert_double_eq_tol(it, own->value, 0.2 * own->sd);
    }
    palp_explanation_free(&e);
    palp_lumped_fit_free(&fit);
    forget();
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, one_wrong_contact_moves_no_other);
    tcase_add_test(tc, explain_fits_the_same_material);
}
