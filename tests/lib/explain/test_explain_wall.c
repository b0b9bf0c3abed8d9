/* test_explain_wall.c: a fit never follows a law that makes no model, though its steps promise most there. */
/* link: -Wl,--wrap=explain_predict */
#include "explain/explain_fit.h"
#include "explain/explain_lines.h"
#include "forward_make.h"
#include <string.h>

palp_status __real_explain_predict(const palp_model *model, const palp_forward_run *run, double *force,
                                   double *gradient, palp_error *error);
palp_status __wrap_explain_predict(const palp_model *model, const palp_forward_run *run, double *force,
                                   double *gradient, palp_error *error);

static size_t followed, beyond; /* all, and those whose law pulls where it is pressed */

palp_status __wrap_explain_predict(const palp_model *model, const palp_forward_run *run, double *force,
                                   double *gradient, palp_error *error) {
    bool pulls = false;
    for (int i = 0; i <= 40; i++) {
        double stiffness;
        palp_law_stiffness(&model->material.law, 0.01 * i, &stiffness, NULL);
        pulls = pulls || stiffness < 0;
    }
    followed++;
    beyond += pulls;
    return __real_explain_predict(model, run, force, gradient, error);
}

/* A press and a withdrawal of a specimen that stiffens with the fifth power; soft: its force by strain at
 * first, N. */
static palp_experiment *record(double depth_mm, double soft, uint64_t *noise) {
    static samples s;
    palp_experiment *e;
    start(&s, 0, -1);
    go(&s, 4, depth_mm, 120);
    go(&s, 8, -1, 120);
    ck_assert_int_eq(palp_experiment_create(s.n, &e), PALP_OK);
    for (size_t i = 0; i < s.n; i++) {
        double strain = fmax(0, s.depth_m[i] / HEIGHT);
        palp_experiment_column(e, "time_s")[i] = s.time_s[i];
        palp_experiment_column(e, "depth_mm")[i] = 1e3 * s.depth_m[i];
        palp_experiment_column(e, "force_N")[i] =
            soft * strain + 9000 * pow(strain, 5) + 1e-2 * white_noise(noise);
    }
    return e;
}

/* Fits a law that is far from the specimen's: chi2 per sample before, and at the end. */
static void fit_runs(const palp_law *law, double soft, double before_after[2]) {
    enum { RUNS = 2 };
    uint64_t noise = 3;
    palp_model m = linear_model(1);
    palp_explain_settings settings = palp_explain_settings_default();
    palp_explain_input input[RUNS] = {{record(5, soft, &noise), "a"}, {record(6, soft, &noise), "b"}};
    explain_data data;
    explain_fit fit;
    m.material.law = *law;
    ck_assert_int_eq(explain_data_create(RUNS, input, &settings, &m, &data, NULL), PALP_OK);
    ck_assert_int_eq(explain_fit_create(&m, &data, &fit), PALP_OK);
    double *residual = calloc(data.n, sizeof *residual);
    ck_assert_ptr_nonnull(residual);
    for (size_t r = 0, at = 0; r < RUNS; at += data.run[r++].n)
        memcpy(residual + at, data.run[r].force, data.run[r].n * sizeof *residual);
    ck_assert_int_eq(explain_noise_find(&data, residual), PALP_OK);
    ck_assert_int_eq(explain_fit_products(&fit, &data, NULL), PALP_OK);
    before_after[0] = explain_chi2(&data, &fit);
    followed = beyond = 0;
    ck_assert_int_eq(explain_fit_improve(&fit, &data, 20), PALP_OK);
    before_after[1] = explain_chi2(&data, &fit);
    explain_fit_free(&fit);
    explain_data_free(&data);
    free(residual);
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}

START_TEST(such_a_law_is_not_followed) {
    static const double line[] = {20, 5};
    double chi2[2];
    palp_law law;
    ck_assert_int_eq(palp_law_polynomial(2, line, &law), PALP_OK);
    fit_runs(&law, 2, chi2);
    ck_assert_uint_ge(followed, 4);
    ck_assert_uint_eq(beyond, 0);
    ck_assert_double_lt(chi2[1], 0.5 * chi2[0]);
}
END_TEST

/* The soft beginning wants knots below zero: the others are found all the same, with those at the least there
 * is. */
START_TEST(other_knots_move_beside_one_at_its_end) {
    enum { KNOTS = 14 };
    double strain[KNOTS], stiffness[KNOTS], chi2[2];
    palp_law law;
    for (int i = 0; i < KNOTS; i++) {
        strain[i] = 0.4 * i / (KNOTS - 1);
        stiffness[i] = 20;
    }
    ck_assert_int_eq(palp_law_spline(KNOTS, strain, stiffness, &law), PALP_OK);
    fit_runs(&law, -2, chi2);
    ck_assert_uint_eq(beyond, 0);
    ck_assert_double_lt(
        chi2[1],
        100.0); /* no such law leaves noise; a fit that stays where it first meets the end leaves 4000 */
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, such_a_law_is_not_followed);
    tcase_add_test(tc, other_knots_move_beside_one_at_its_end);
}
