/* test_fit_contact.c: contacts that differ from run to run are found beside the fit, and bias it no more. */
#include "recordings.h"

enum { RUNS = 6 };
static const double TRUTH[3] = {8.0, -6.0, 80.0};

/* Runs whose recorded depth has its zero off by shift_mm[run], and no air by which to tell. */
static void runs_of(const double shift_mm[RUNS], double force, double length, palp_recording r[RUNS]) {
    palp_material m = {.n_arms = 1, .arms = {{2.4, 4.8, 0, 0}}};
    m.law = polynomial(3, TRUTH);
    for (uint64_t q = 0; q < RUNS; q++) {
        take t = {m, 3.0 + (double)q, 1.0 + 0.5 * (double)q, 20.0, 1.0, 50.0, 0.004, "ramp_hold", 100 + q};
        palp_experiment *e = record(&t);
        double *depth = palp_experiment_column(e, "depth_mm"), *f = palp_experiment_column(e, "force_N");
        for (size_t i = 0; i < palp_experiment_rows(e); i++) {
            depth[i] = (depth[i] + shift_mm[q]) * length;
            f[i] *= force;
        }
        palp_experiment_set_number(e, "specimen.height_mm", 24.0 * length);
        palp_recording_settings settings = palp_recording_settings_default();
        settings.contact_given = true;
        ck_assert_int_eq(palp_recording_prepare(e, "run.csv", &settings, &r[q], NULL), PALP_OK);
        palp_experiment_free(e);
    }
}

static palp_lumped_fit fit_with(palp_contact_form contact, double force, const palp_recording r[RUNS]) {
    palp_characterize_settings s = with_law(polynomial(3, (double[3]){5.0 * force, force, force}), 1);
    s.contact = contact;
    return fit(RUNS, r, s);
}

/* Largest error of K(e) over the strains measured, relative. */
static double error_of(const palp_lumped_fit *f, double force) {
    palp_law truth = polynomial(3, TRUTH);
    double worst = 0.0, want, got;
    for (int i = 2; i <= 10; i++) {
        palp_law_stiffness(&truth, 0.033 * i, &want, NULL);
        palp_law_stiffness(&f->material.law, 0.033 * i, &got, NULL);
        worst = fmax(worst, fabs(got / force / want - 1.0));
    }
    return worst;
}

static const double shifts[RUNS] = {0.12, -0.08, 0.05, -0.11, 0.09, -0.07};

START_TEST(scattered_contacts_are_found) {
    palp_recording r[RUNS];
    runs_of(shifts, 1.0, 1.0, r);
    palp_lumped_fit known = fit_with(PALP_CONTACT_KNOWN, 1.0, r), f = fit_with(PALP_CONTACT_FREE, 1.0, r);
    double left = 0.0, given = 0.0;
    ck_assert_ptr_null(known.contact_m);
    ck_assert_double_gt(known.reduced_chi2, 20.0);
    ck_assert_double_lt(f.reduced_chi2, 3.0);
    for (int q = 0; q < RUNS; q++) { /* what was depth 0 is contact 'shift' later */
        left += pow(1e3 * f.contact_m[q] - shifts[q], 2);
        given += pow(shifts[q], 2);
        ck_assert_double_gt(f.contact_sd_m[q], 0.0);
    }
    ck_assert_msg(left < 0.01 * given, "shifts are off by %g of %g mm", sqrt(left / RUNS),
                  sqrt(given / RUNS));
    ck_assert_double_gt(f.contact_scatter_m, 0.05e-3);
    ck_assert_double_lt(f.contact_scatter_m, 0.2e-3);
    ck_assert_msg(error_of(&f, 1.0) < 0.01 && error_of(&f, 1.0) < 0.5 * error_of(&known, 1.0),
                  "K off by %g, with known contacts by %g", error_of(&f, 1.0), error_of(&known, 1.0));
    ck_assert_double_eq_tol(f.material.arms[0].stiffness_N, 2.4, 0.02);
    ck_assert_double_lt(fabs(f.rms_N[0] - 0.004), 0.0015);
    palp_lumped_fit_free(&known);
    palp_lumped_fit_free(&f);
    free_all(RUNS, r);
}
END_TEST

START_TEST(contacts_that_are_right_stay) {
    static const double none[RUNS] = {0};
    palp_recording r[RUNS];
    runs_of(none, 1.0, 1.0, r);
    palp_lumped_fit known = fit_with(PALP_CONTACT_KNOWN, 1.0, r), f = fit_with(PALP_CONTACT_FREE, 1.0, r);
    ck_assert_double_lt(f.contact_scatter_m, 0.02e-3);
    for (int q = 0; q < RUNS; q++)
        ck_assert_double_lt(fabs(f.contact_m[q]), 0.02e-3);
    for (int k = 0; k < 3; k++) /* within what the known ones say, widened a little by the contacts */
        ck_assert_double_lt(fabs(f.material.law.coefficients[k] - TRUTH[k]), 4.0 * f.estimate[k].sd);
    ck_assert_double_lt(error_of(&f, 1.0), 0.01);
    palp_lumped_fit_free(&known);
    palp_lumped_fit_free(&f);
    free_all(RUNS, r);
}
END_TEST

START_TEST(a_common_contact_is_found) {
    static const double same[RUNS] = {0.1, 0.1, 0.1, 0.1, 0.1, 0.1};
    palp_recording r[RUNS];
    runs_of(same, 1.0, 1.0, r);
    palp_lumped_fit f = fit_with(PALP_CONTACT_COMMON, 1.0, r);
    for (int q = 0; q < RUNS; q++)
        ck_assert_double_eq(f.contact_m[q], f.contact_m[0]);
    ck_assert_msg(fabs(f.contact_m[0] - 0.1e-3) < fmax(3.0 * f.contact_sd_m[0], 0.01e-3), "%g +- %g mm",
                  1e3 * f.contact_m[0], 1e3 * f.contact_sd_m[0]);
    ck_assert_double_lt(fabs(f.contact_m[0] - 0.1e-3), 0.03e-3);
    palp_lumped_fit_free(&f);
    free_all(RUNS, r);
}
END_TEST

START_TEST(other_units_find_the_same) {
    palp_recording r[2][RUNS];
    runs_of(shifts, 1.0, 1.0, r[0]);
    runs_of(shifts, 1e-6, 1e-3, r[1]);
    palp_lumped_fit f = fit_with(PALP_CONTACT_FREE, 1.0, r[0]), g = fit_with(PALP_CONTACT_FREE, 1e-6, r[1]);
    for (int q = 0; q < RUNS; q++)
        ck_assert_double_eq_tol(1e3 * g.contact_m[q], f.contact_m[q], 1e-5 * f.contact_scatter_m);
    for (int k = 0; k < 3; k++)
        ck_assert_double_eq_tol(1e6 * g.material.law.coefficients[k], f.material.law.coefficients[k],
                                1e-5 * fabs(f.material.law.coefficients[k]));
    palp_lumped_fit_free(&f);
    palp_lumped_fit_free(&g);
    free_all(RUNS, r[0]);
    free_all(RUNS, r[1]);
}
END_TEST

/* Two sessions of an indenter that each find contact in the air to some micrometres: their recorded depth has
 * its zero off. */
static void two_sessions(const double shift_mm[2], uint64_t seed, palp_recording r[2]) {
    palp_material m = {.n_arms = 1, .arms = {{2.4, 4.8, 0, 0}}};
    m.law = polynomial(3, TRUTH);
    for (uint64_t q = 0; q < 2; q++) {
        take t = {m, 3.0, 3.0, q ? 5.0 : 60.0, 1.0, 200.0, 0.002, "ramp_hold", 1000 * seed + q};
        palp_experiment *e = record(&t);
        double *depth = palp_experiment_column(e, "depth_mm");
        for (size_t i = 0; i < palp_experiment_rows(e); i++)
            depth[i] += shift_mm[q];
        r[q] = prepare(e);
        ck_assert_int_eq(r[q].contact_rule, PALP_CONTACT_FREE_AIR);
    }
}

static palp_characterize_settings by_evidence(void) {
    palp_characterize_settings s = with_law(polynomial(3, (double[3]){5.0, 1.0, 1.0}), 1);
    s.contact = PALP_CONTACT_AUTO;
    return s;
}

/* Freed where they differ, by about as much as they do. What both have alike, the law's slope has too: the
 * intervals say so. */
START_TEST(contacts_of_two_sessions_are_found) {
    enum { CASES = 10 };
    static const double by[2] = {0.004, -0.003};
    double square = 0.0;
    for (uint64_t seed = 1; seed <= CASES; seed++) {
        palp_recording r[2];
        two_sessions(by, seed, r);
        palp_characterize_settings s = by_evidence();
        palp_lumped_fit f = fit(2, r, s);
        s.contact = PALP_CONTACT_KNOWN;
        palp_lumped_fit known = fit(2, r, s);
        ck_assert_ptr_nonnull(f.contact_m);
        ck_assert_double_lt(f.reduced_chi2, 1.2);
        ck_assert_double_gt(known.reduced_chi2, f.reduced_chi2);
        ck_assert_double_eq_tol(1e3 * (r[0].contact_m + f.contact_m[0] - r[1].contact_m - f.contact_m[1]),
                                0.007, 0.002); /* the zero forces are off, too */
        for (int q = 0; q < 2; q++)
            ck_assert_double_lt(fabs(1e3 * (r[q].contact_m + f.contact_m[q]) - by[q]),
                                4.0 * 1e3 * f.contact_sd_m[q]);
        for (int k = 0; k < 3; k++)
            square += pow((f.material.law.coefficients[k] - TRUTH[k]) / f.estimate[k].sd, 2) / (3 * CASES);
        palp_lumped_fit_free(&known);
        palp_lumped_fit_free(&f);
        free_all(2, r);
    }
    ck_assert_msg(square < 3.0, "coefficients are off by %g of their sds (rms)", sqrt(square));
}
END_TEST

/* But for the few that chance frees; one run has none of its own. */
START_TEST(right_contacts_of_two_sessions_stay) {
    enum { CASES = 40 };
    int freed = 0;
    for (uint64_t seed = 1; seed <= CASES; seed++) {
        palp_recording r[2];
        two_sessions((double[2]){0.0, 0.0}, seed, r);
        palp_lumped_fit f = fit(2, r, by_evidence()), one = fit(1, r, by_evidence());
        freed += f.contact_m != NULL;
        ck_assert_ptr_null(one.contact_m);
        palp_lumped_fit_free(&f);
        palp_lumped_fit_free(&one);
        free_all(2, r);
    }
    ck_assert_msg(freed <= 4, "%d of %d", freed, CASES);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, scattered_contacts_are_found);
    tcase_add_test(tc, contacts_that_are_right_stay);
    tcase_add_test(tc, a_common_contact_is_found);
    tcase_add_test(tc, other_units_find_the_same);
    tcase_add_test(tc, contacts_of_two_sessions_are_found);
    tcase_add_test(tc, right_contacts_of_two_sessions_stay);
}
