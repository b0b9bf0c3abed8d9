/* test_fit.c: laws, arms, intervals and derivatives of a fit. */
#include "fit/fit_internal.h"
#include "recordings.h"

/* 4 mm in a second, held. */
static palp_recording one_press(double hold_s, uint64_t seed) {
    take t = {two_arms(8.9, 2.3, 3.5, 0.63, 21.0), 4.0, 1.0, hold_s, 1.0, 200.0, 0.002, "ramp_hold", seed};
    return prepare(record(&t));
}

/* Static data of a law, with noise of a thousandth of the peak. */
static palp_recording static_run(palp_law law, uint64_t seed) {
    palp_material m = {.law = law};
    double e = 9.6 / 24.0, peak;
    palp_law_force(&law, 1, &e, &peak, NULL, NULL);
    take t = {m, 9.6, 40.0, 0.0, 1.0, 50.0, 1e-3 * peak, "static", seed};
    return prepare(record(&t));
}

/* Fits a law of the same shape but other coefficients; the force must come back within a few noise sds. */
static palp_lumped_fit law_comes_back(palp_law truth, palp_law guess) {
    palp_recording r = static_run(truth, 7);
    palp_lumped_fit f = fit(1, &r, with_law(guess, 0));
    for (double e = 0.02; e < 0.4; e += 0.02) {
        double ours, known;
        palp_law_force(&f.material.law, 1, &e, &ours, NULL, NULL);
        palp_law_force(&truth, 1, &e, &known, NULL, NULL);
        ck_assert_double_eq_tol(ours, known, r.noise_N);
    }
    ck_assert_double_eq_tol(f.reduced_chi2, 1.0, 0.35);
    ck_assert(!f.constrained);
    palp_recording_free(&r);
    return f;
}

static void estimates_are(const palp_lumped_fit *f, const double *truth, const char *unit) {
    for (size_t i = 0; i < f->n_estimates; i++) {
        ck_assert_double_eq_tol(f->estimate[i].value, truth[i], 4.0 * f->estimate[i].sd);
        ck_assert_str_eq(f->estimate[i].unit, unit);
    }
}

START_TEST(laws_come_back) {
    const double area = 4.52e-4, mooney[2] = {4000.0, 1500.0}, yeoh[2] = {3000.0, 900.0},
                 ones[2] = {1.0, 1.0};
    palp_law truth, guess;
    palp_lumped_fit f = law_comes_back(polynomial(5, LAW), polynomial(5, (double[5]){1.0}));
    estimates_are(&f, LAW, "N");
    palp_lumped_fit_free(&f);
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_MOONEY_RIVLIN2, 2, mooney, area, &truth), PALP_OK);
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_MOONEY_RIVLIN2, 2, ones, area, &guess), PALP_OK);
    f = law_comes_back(truth, guess);
    estimates_are(&f, mooney, "Pa");
    palp_lumped_fit_free(&f);
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_YEOH, 2, yeoh, area, &truth), PALP_OK);
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_YEOH, 2, ones, area, &guess), PALP_OK);
    f = law_comes_back(truth, guess);
    estimates_are(&f, yeoh, "Pa");
    palp_lumped_fit_free(&f);
}
END_TEST

START_TEST(laws_that_are_not_linear_come_back) {
    const double area = 4.52e-4, ogden[2] = {2500.0, 7.0}, start[2] = {1000.0, 3.0};
    const double knots[5] = {0.0, 0.1, 0.2, 0.3, 0.4}, k[5] = {8.2, 8.4, 9.0, 9.4, 11.0},
                 ones[5] = {1, 1, 1, 1, 1};
    palp_law truth, guess;
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_OGDEN, 2, ogden, area, &truth), PALP_OK);
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_OGDEN, 2, start, area, &guess), PALP_OK);
    palp_lumped_fit f = law_comes_back(truth, guess);
    ck_assert_double_eq_tol(f.estimate[0].value, ogden[0], 4.0 * f.estimate[0].sd);
    ck_assert_double_eq_tol(f.estimate[1].value, ogden[1], 4.0 * f.estimate[1].sd);
    ck_assert_str_eq(f.estimate[1].unit, "1");
    palp_lumped_fit_free(&f);
    ck_assert_int_eq(palp_law_spline(5, knots, k, &truth), PALP_OK);
    ck_assert_int_eq(palp_law_spline(5, knots, ones, &guess), PALP_OK);
    f = law_comes_back(truth, guess);
    estimates_are(&f, k, "N");
    palp_lumped_fit_free(&f);
}
END_TEST

START_TEST(hyperelastic_law_and_arms_at_once) {
    const double area = 4.52e-4, mooney[2] = {4000.0, 1500.0}, ones[2] = {1.0, 1.0};
    palp_material m =
        two_arms(1.0, 0.02, 0.03, 0.01, 0.3); /* soft against a law in Pa: bounds must not care */
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_MOONEY_RIVLIN2, 2, mooney, area, &m.law), PALP_OK);
    palp_recording r[2];
    for (size_t q = 0; q < 2; q++) {
        take t = {m, 4.0 + 4.0 * (double)q, 1.0, 100.0, 1.0, 100.0, 1e-5, "ramp_hold", 4 + q};
        r[q] = prepare(record(&t));
    }
    palp_law guess;
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_MOONEY_RIVLIN2, 2, ones, area, &guess), PALP_OK);
    palp_lumped_fit f = fit(2, r, with_law(guess, 2));
    ck_assert_double_eq_tol(f.estimate[0].value, 4000.0, 4.0);
    ck_assert_double_eq_tol(f.material.arms[0].stiffness_N, 0.02, 2e-4);
    ck_assert_double_eq_tol(f.material.arms[1].stiffness_N, 0.01, 1e-4);
    palp_lumped_fit_free(&f);
    free_all(2, r);
}
END_TEST

/* K of Eq. 4.3 minus 9: negative for small strain, which a spring cannot be. */
START_TEST(stiffness_is_kept_positive) {
    double c[5] = {-0.82, -0.70, 47.47, -131.36, 146.89};
    palp_material m = two_arms(1.0, 2.5, 3.6, 0.7, 24.0);
    take t = {m, 9.6, 40.0, 0.0, 1.0, 50.0, 0.001, "static", 3};
    palp_experiment *e = record(&t);
    double *depth = palp_experiment_column(e, "depth_mm"), *force = palp_experiment_column(e, "force_N");
    uint64_t state = 9;
    for (size_t i = 0; i < palp_experiment_rows(e); i++) {
        double strain = fmax(depth[i], 0.0) / 24.0, f = 0.0;
        for (size_t k = 5; k-- > 0;)
            f = (f + c[k]) * strain;
        force[i] = f + 0.001 * palp_random_normal(&state);
    }
    palp_experiment_set_string(e, "contact.rule",
                               "find_contact"); /* do not look for it where the force rises */
    palp_recording r = prepare(e);
    palp_lumped_fit f = fit(1, &r, with_law(polynomial(5, (double[5]){1.0}), 0));
    ck_assert(f.constrained);
    ck_assert_double_gt(palp_law_minimum(&f.material.law, 0.39), 0.0);
    palp_lumped_fit_free(&f);
    palp_recording_free(&r);
}
END_TEST

START_TEST(polynomial_of_table_4_1_has_the_norm_of_its_residual) {
    palp_recording r = static_run(polynomial(5, LAW), 21);
    double last = HUGE_VAL;
    for (size_t degree = 2; degree <= 7; degree++) {
        palp_law law;
        double norm, sum = 0.0;
        ck_assert_int_eq(palp_thesis_polynomial(&r, degree, &law, &norm), PALP_OK);
        ck_assert_uint_eq(law.n, degree);
        for (size_t i = 0; i < r.n; i++) {
            double e = r.depth_m[i] / r.height_m, f;
            if (e <= 0.0)
                continue;
            palp_law_force(&law, 1, &e, &f, NULL, NULL);
            sum += (f - r.force_N[i]) * (f - r.force_N[i]);
        }
        ck_assert_double_eq_tol(norm, sqrt(sum), 1e-9 * norm);
        ck_assert_double_le(norm, last * (1.0 + 1e-12));
        last = norm;
    }
    palp_law law;
    double norm;
    ck_assert_int_eq(palp_thesis_polynomial(&r, 0, &law, &norm), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_thesis_polynomial(&r, PALP_LAW_MAX + 1, &law, &norm), PALP_ERR_ARGUMENT);
    palp_recording_free(&r);
}
END_TEST

/* A hold of 4 s says nothing about an arm of 100 s. */
START_TEST(what_the_data_do_not_determine_is_called_so) {
    take t = {two_arms(9.0, 2.4, 1.2, 0.7, 70.0), 4.0, 0.5, 4.0, 1.0, 200.0, 0.004, "ramp_hold", 5};
    palp_recording r = prepare(record(&t));
    palp_lumped_fit f = fit(1, &r, with_arms(2));
    bool all = f.n_merged == 0;
    for (size_t i = 0; i < f.n_estimates; i++)
        all = all && f.estimate[i].determined;
    ck_assert(!all);
    palp_lumped_fit_free(&f);
    palp_recording_free(&r);
}
END_TEST

START_TEST(two_arms_of_one_time_are_merged) {
    take t = {two_arms(9.0, 1.0, 3.0, 0.7, 2.2), 4.0, 1.0, 40.0, 1.0, 200.0, 0.004, "ramp_hold", 5};
    palp_recording r = prepare(record(&t));
    palp_lumped_fit f = fit(1, &r, with_arms(2));
    ck_assert_uint_eq(f.n_merged, 1);
    ck_assert_uint_eq(f.material.n_arms, 1);
    ck_assert_uint_eq(f.n_estimates, 4);
    ck_assert_double_eq_tol(f.material.arms[0].stiffness_N, 1.7, 0.02);
    palp_lumped_fit_free(&f);
    f = fit(1, &r, with_arms(4));
    ck_assert_uint_eq(f.n_merged, 3);
    palp_lumped_fit_free(&f);
    t.material.n_arms = 0; /* an arm that is not there is not determined */
    palp_recording elastic = prepare(record(&t));
    f = fit(1, &elastic, with_arms(1));
    ck_assert(!f.estimate[1].determined);
    ck_assert_double_lt(f.estimate[1].value, 0.01);
    palp_lumped_fit_free(&f);
    palp_recording_free(&elastic);
    palp_recording_free(&r);
}
END_TEST

START_TEST(correlations_are_those_of_the_parameters) {
    palp_recording r = one_press(100.0, 1);
    palp_lumped_fit f = fit(1, &r, with_arms(2));
    size_t n = f.n_estimates;
    ck_assert_uint_eq(n, 7);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            ck_assert_double_le(fabs(f.correlation[i * n + j]), 1.0 + 1e-9);
            ck_assert_double_eq(f.correlation[i * n + j], f.correlation[j * n + i]);
        }
    /* log b = log K + log tau: its variance follows */
    double k = f.estimate[1].sd / f.estimate[1].value, b = f.estimate[2].sd / f.estimate[2].value,
           tau = f.estimate[3].sd / f.estimate[3].value, c = f.correlation[1 * n + 3];
    ck_assert_double_eq_tol(b * b, k * k + tau * tau + 2.0 * c * k * tau, 1e-9 * b * b);
    ck_assert_double_eq_tol(f.estimate[2].value, f.estimate[1].value * f.estimate[3].value, 1e-9);
    ck_assert_str_eq(f.estimate[0].name, "K_inf [1]");
    ck_assert_str_eq(f.estimate[6].name, "tau_2");
    palp_lumped_fit_free(&f);
    palp_recording_free(&r);
}
END_TEST

START_TEST(force_is_that_of_the_material) {
    palp_recording r = one_press(20.0, 2);
    palp_lumped_fit f = fit(1, &r, with_arms(2));
    double *ours = malloc(r.n * sizeof *ours), *known = malloc(r.n * sizeof *known),
           *depth = malloc(r.n * sizeof *depth);
    ck_assert_int_eq(palp_lumped_fit_force(&f, 0, &r, ours), PALP_OK);
    ck_assert_int_eq(palp_lumped_fit_force(&f, 1, &r, ours), PALP_ERR_ARGUMENT);
    for (size_t i = 0; i < r.n; i++)
        depth[i] = fmax(r.depth_m[i], 0.0);
    ck_assert_int_eq(palp_lumped_run(&f.material, r.height_m, r.n, r.time_s, depth, known), PALP_OK);
    for (size_t i = 0; i < r.n; i++)
        ck_assert_double_eq_tol(ours[i], known[i], 1e-12);
    free(ours);
    free(known);
    free(depth);
    palp_lumped_fit_free(&f);
    palp_recording_free(&r);
}
END_TEST

/* The residuals' derivatives against central differences, for a law and for a spring a run. */
static void jacobian_is_right(size_t n, const palp_recording *r, palp_characterize_settings s,
                              const double *v) {
    fit_problem p;
    ck_assert_int_eq(fit_problem_create(&p, n, r, &s, NULL), PALP_OK);
    size_t parameters = fit_parameter_count(&p), m = p.n_blocks;
    double *a = malloc(m * sizeof *a), *b = malloc(m * sizeof *b), *j = malloc(m * parameters * sizeof *j),
           w[16];
    ck_assert_uint_le(parameters, 16);
    memcpy(w, v, parameters * sizeof *w);
    ck_assert_int_eq(fit_evaluate(&p, v, a, j), PALP_OK);
    for (size_t k = 0; k < parameters; k++) {
        double h = 1e-5 * fmax(fabs(v[k]), 0.1), size = 0.0;
        w[k] = v[k] + h;
        ck_assert_int_eq(fit_evaluate(&p, w, a, NULL), PALP_OK);
        w[k] = v[k] - h;
        ck_assert_int_eq(fit_evaluate(&p, w, b, NULL), PALP_OK);
        w[k] = v[k];
        for (size_t i = 0; i < m; i++)
            size = fmax(size, fabs(j[k * m + i]));
        ck_assert_double_gt(size, 0.0);
        for (size_t i = 0; i < m; i++)
            ck_assert_double_eq_tol(j[k * m + i], (a[i] - b[i]) / (2.0 * h), 1e-7 * size);
    }
    free(a);
    free(b);
    free(j);
    fit_problem_free(&p);
}

START_TEST(derivatives_agree_with_differences) {
    palp_recording r[2] = {one_press(30.0, 3), one_press(20.0, 4)};
    const double area = 4.52e-4, knots[3] = {0.0, 0.1, 0.2}, k[3] = {8.0, 8.6, 9.9};
    const double springs[6] = {8.1, 9.2, log(2.3), log(1.5), log(0.7), log(30.0)};
    jacobian_is_right(2, r, with_arms(2), springs);
    const double law[7] = {8.18, -0.70, 47.47, log(2.3), log(1.5), log(0.7), log(30.0)};
    jacobian_is_right(2, r, with_law(polynomial(3, law), 2), law);
    const double ogden[4] = {2500.0, 7.0, log(2.3), log(1.5)};
    palp_law shape;
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_OGDEN, 2, ogden, area, &shape), PALP_OK);
    jacobian_is_right(2, r, with_law(shape, 1), ogden);
    ck_assert_int_eq(palp_law_spline(3, knots, k, &shape), PALP_OK);
    jacobian_is_right(2, r, with_law(shape, 0), k);
    free_all(2, r);
}
END_TEST

/* Blocks only save time: the blocks of a curve without noise lie on the curve. */
START_TEST(blocks_cost_no_accuracy) {
    static const double ramp[] = {1.0, 30.0, 0.2};
    for (int k = 0; k < 3; k++) {
        palp_material m = phantom();
        take t = {m, 7.0, ramp[k], 100.0, 3.0, 500.0, 0.0, "ramp_hold", 1};
        palp_recording r = prepare(record(&t));
        r.noise_N = 1.0; /* residuals in N by the root of the count */
        palp_characterize_settings s = with_law(m.law, 2);
        fit_problem p;
        ck_assert_int_eq(fit_problem_create(&p, 1, &r, &s, NULL), PALP_OK);
        double v[9], *residual = malloc(p.n_blocks * sizeof *residual), samples = 0.0;
        memcpy(v, LAW, sizeof LAW);
        for (size_t j = 0; j < 2; j++) {
            v[5 + 2 * j] = log(m.arms[j].stiffness_N);
            v[6 + 2 * j] = log(m.arms[j].viscosity_Ns / m.arms[j].stiffness_N);
        }
        ck_assert_int_eq(fit_evaluate(&p, v, residual, NULL), PALP_OK);
        for (size_t i = 0; i < p.n_blocks; i++) {
            samples += p.run[0].count[i];
            if (p.run[0].count[i] > 0.0) /* 3.1 N at most: a hundredth of the noise of a sample */
                ck_assert_double_lt(fabs(residual[i]) / sqrt(p.run[0].count[i]), 4e-5);
        }
        ck_assert_double_eq(samples, round((ramp[k] + 100.0) * 500.0));
        ck_assert_uint_lt(p.n_blocks, 1200);
        free(residual);
        fit_problem_free(&p);
        palp_recording_free(&r);
    }
}
END_TEST

START_TEST(bad_requests_are_refused) {
    palp_recording r[2] = {one_press(5.0, 3), one_press(5.0, 4)};
    palp_lumped_fit f;
    palp_error error = {PALP_OK, ""};
    palp_characterize_settings s = with_arms(1);
    ck_assert_int_eq(palp_characterize_fit(0, r, &s, &f, &error), PALP_ERR_ARGUMENT);
    r[1].height_m = 0.025;
    ck_assert_int_eq(palp_characterize_fit(2, r, &s, &f, &error), PALP_ERR_INPUT);
    ck_assert_ptr_nonnull(strstr(error.text, "specimen of 25 mm among specimens of 24 mm"));
    s = with_law((palp_law){.kind = PALP_LAW_POLYNOMIAL}, 1);
    ck_assert_int_eq(palp_characterize_fit(1, r, &s, &f, &error), PALP_ERR_ARGUMENT);
    s = with_arms(PALP_ARMS_MAX + 1);
    ck_assert_int_eq(palp_characterize_fit(1, r, &s, &f, &error), PALP_ERR_LIMIT);
    s = with_arms(3);
    ck_assert_int_eq(palp_thesis_grid(1, r, &s, &f, &error), PALP_ERR_UNSUPPORTED);
    free_all(2, r);
    palp_lumped_fit_free(NULL);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, laws_come_back);
    tcase_add_test(tc, laws_that_are_not_linear_come_back);
    tcase_add_test(tc, hyperelastic_law_and_arms_at_once);
    tcase_add_test(tc, stiffness_is_kept_positive);
    tcase_add_test(tc, polynomial_of_table_4_1_has_the_norm_of_its_residual);
    tcase_add_test(tc, what_the_data_do_not_determine_is_called_so);
    tcase_add_test(tc, two_arms_of_one_time_are_merged);
    tcase_add_test(tc, correlations_are_those_of_the_parameters);
    tcase_add_test(tc, force_is_that_of_the_material);
    tcase_add_test(tc, derivatives_agree_with_differences);
    tcase_add_test(tc, blocks_cost_no_accuracy);
    tcase_add_test(tc, bad_requests_are_refused);
}
