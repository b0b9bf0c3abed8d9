/* test_explain_fallback.c: what explain does where a model has no solution. */
#include "explain/explain_lines.h"
#include "explain/explain_fit.h"
#include "forward_make.h"

enum { RUNS = 2 };

/* On a frame that gives way the specimen, which softens, snaps through: beyond a depth of about a fifth of
 * its height there is no equilibrium. */
static palp_model on_a_frame(void) {
    static const double softening[] = {8, -40}; /* N */
    palp_model m = lumped_model(0);
    ck_assert_int_eq(palp_law_polynomial(2, softening, &m.material.law), PALP_OK);
    add_effect(&m, PALP_EFFECT_FRAME_COMPLIANCE, 0)->value[0] = HEIGHT / softening[0];
    return m;
}

static palp_status press(const palp_model *m, double depth_mm, samples *s) {
    start(s, 0, -1);
    go(s, 5, depth_mm, 300);
    palp_forward_run run = {.n = s->n, .time_s = s->time_s, .depth_m = s->depth_m};
    return palp_forward_force(m, &run, s->force_N, NULL, NULL);
}

/* mm, to a tenth of a micrometre. */
static double deepest(const palp_model *m) {
    static samples s;
    double low = 3, high = 10;
    ck_assert_int_eq(press(m, high, &s), PALP_ERR_NOT_CONVERGED);
    while (high - low > 1e-4) {
        double middle = 0.5 * (low + high);
        *(press(m, middle, &s) ? &high : &low) = middle;
    }
    return low;
}

static palp_experiment *record(const palp_model *m, double depth_mm) {
    static samples s;
    palp_experiment *e;
    ck_assert_int_eq(press(m, depth_mm, &s), PALP_OK);
    ck_assert_int_eq(palp_experiment_create(s.n, &e), PALP_OK);
    for (size_t i = 0; i < s.n; i++) {
        palp_experiment_column(e, "time_s")[i] = s.time_s[i];
        palp_experiment_column(e, "depth_mm")[i] = 1e3 * s.depth_m[i];
        palp_experiment_column(e, "force_N")[i] = s.force_N[i] + (i % 2 ? 1e-3 : -1e-3);
    }
    return e;
}

static explain_data data;
static explain_fit fit;
static double *force;

/* Runs to 3 mm and to the deepest that has a solution; the fit is the truth. */
static void begin(const palp_model *m) {
    palp_explain_settings settings = palp_explain_settings_default();
    palp_explain_input input[RUNS] = {{record(m, 3), "a.csv"}, {record(m, deepest(m)), "b.csv"}};
    ck_assert_int_eq(explain_data_create(RUNS, input, &settings, m, &data, NULL), PALP_OK);
    force = calloc(data.n, sizeof *force);
    ck_assert_ptr_nonnull(force);
    ck_assert_int_eq(explain_noise_find(&data, force), PALP_OK);
    ck_assert_int_eq(explain_fit_create(m, &data, &fit), PALP_OK);
    fit.scatter = (explain_scatter){1e-3, 3e-6, 3e-3, 0};
    ck_assert_int_eq(explain_fit_products(&fit, &data, force), PALP_OK);
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}

static void end(void) {
    explain_fit_free(&fit);
    explain_data_free(&data);
    free(force);
}

/* The noise level is the instrument's noise: a run's own contact and gain are no part of it, however they
 * scatter. */
START_TEST(the_noise_level_is_the_noise) {
    palp_model m = on_a_frame();
    double white = 0;
    begin(&m);
    for (size_t r = 0; r < RUNS; r++)
        white += pow(data.run[r].white, 2) * (double)data.run[r].n;
    double wanted = sqrt(white / (double)data.n + pow(data.correlated, 2));
    ck_assert_double_eq_tol(explain_noise_level(&data), wanted, 1e-9 * wanted);
    end();
}
END_TEST

/* A candidate with which the model has no solution is told so, and is no failure of the search. */
START_TEST(a_candidate_without_a_solution_is_rejected) {
    palp_model m = on_a_frame();
    explain_search *s = calloc(1, sizeof *s);
    palp_explain_settings settings = palp_explain_settings_default();
    ck_assert_ptr_nonnull(s);
    begin(&m);
    *s = (explain_search){.data = data, .settings = &settings, .fit = fit, .force = force, .residual = force};
    explain_trial *t = &s->trial[PALP_EFFECT_CONTACT_OFFSET];
    palp_model deeper = m;
    add_effect(&deeper, PALP_EFFECT_CONTACT_OFFSET, 0)->value[0] = -1e-5; /* the surface lies higher */
    ck_assert_int_eq(explain_fit_create(&deeper, &data, &t->fit), PALP_OK);
    ck_assert_int_eq(explain_fit_products(&t->fit, &data, NULL), PALP_ERR_NOT_CONVERGED);
    ck_assert_int_eq(explain_trial_examine(s, PALP_EFFECT_CONTACT_OFFSET, t), PALP_OK);
    ck_assert_ptr_null(t->fit.product);
    ck_assert_ptr_null(t->force);
    ck_assert_str_eq(explain_judged(s, t, 0), "the model has no solution with it");
    explain_trials_free(s);
    free(s);
    end();
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, the_noise_level_is_the_noise);
    tcase_add_test(tc, a_candidate_without_a_solution_is_rejected);
}
