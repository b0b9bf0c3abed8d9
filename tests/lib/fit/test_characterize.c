/* test_characterize.c: fits of recordings whose answer is known, Chapter 4 of Sedef 2008 first. */
#include "recordings.h"

enum { DEPTHS = 12 };

/* Table 4.3: depth, K_inf, K_1, b_1, K_2, b_2, and Table 4.2: K_inf, K_1. */
static const double TABLE[DEPTHS][8] = {
    {1.5, 7.608, 2.3573, 3.8118, 0.634, 29.8469, 7.672, 1.1217},
    {2.0, 7.9824, 2.2852, 3.52, 0.7026, 27.4352, 8.0268, 1.143},
    {2.5, 8.06304, 2.2897, 3.7776, 0.6817, 31.2822, 8.12448, 1.1435},
    {3.0, 8.2736, 2.276, 3.5098, 0.682, 23.8653, 8.3152, 1.2065},
    {3.5, 8.756571, 2.4121, 3.5052, 0.6194, 20.6645, 8.797714, 1.2247},
    {4.0, 8.904, 2.3032, 3.5462, 0.6254, 21.0861, 8.9454, 1.2338},
    {4.5, 9.088533, 2.3816, 3.5891, 0.6125, 19.6925, 9.129067, 1.2878},
    {5.0, 9.10992, 2.4522, 3.716, 0.6553, 24.4958, 9.15696, 1.2123},
    {5.5, 8.972945, 2.378, 3.692, 0.7268, 29.2931, 9.024, 1.1983},
    {6.0, 9.1376, 2.5257, 3.6713, 0.7127, 26.714, 9.1844, 1.2189},
    {6.5, 9.389169, 2.513, 3.6146, 0.7123, 23.6864, 9.430523, 1.2838},
    {7.0, 9.749486, 2.624, 3.5387, 0.7144, 22.3128, 9.809829, 1.3421},
};

static double total(const palp_lumped_fit *f) {
    double sum = 0.0;
    for (size_t r = 0; r < f->n_runs; r++)
        sum += f->absolute_N[r];
    return sum;
}

/* A depth of Table 4.3: 1 s of air, 1 s ramp, hold. 4 mN at 1 kHz is 1.8 mN at 200 Hz. */
static palp_recording table_run(size_t q, double hold_s) {
    const double *row = TABLE[q];
    take t = {two_arms(row[1], row[2], row[3], row[4], row[5]),
              row[0],
              1.0,
              hold_s,
              1.0,
              200.0,
              0.004 / sqrt(5.0),
              "ramp_hold",
              q + 1};
    return prepare(record(&t));
}

START_TEST(table_4_3_comes_back) {
    for (size_t q = 0; q < DEPTHS; q++) {
        palp_recording r = table_run(q, 200.0);
        palp_lumped_fit f = fit(1, &r, with_arms(2));
        ck_assert_double_eq_tol(f.spring_N[0], TABLE[q][1], 0.002 * TABLE[q][1]);
        for (size_t j = 0; j < 2; j++) {
            ck_assert_double_eq_tol(f.material.arms[j].stiffness_N, TABLE[q][2 + 2 * j],
                                    0.03 * TABLE[q][2 + 2 * j]);
            ck_assert_double_eq_tol(f.material.arms[j].viscosity_Ns, TABLE[q][3 + 2 * j],
                                    0.03 * TABLE[q][3 + 2 * j]);
        }
        ck_assert(f.converged && f.n_merged == 0);
        ck_assert_double_eq_tol(f.reduced_chi2, 1.0, 0.2);
        ck_assert_double_eq_tol(f.rms_N[0], r.noise_N, 0.03 * r.noise_N);
        for (size_t i = 0; i < f.n_estimates; i++)
            ck_assert(f.estimate[i].determined);
        palp_lumped_fit_free(&f);
        palp_recording_free(&r);
    }
}
END_TEST

/* One arm on the holds alone, as the thesis did. Its run at 7 mm ended after 150 s. */
START_TEST(table_4_2_comes_back) {
    for (size_t q = 0; q < DEPTHS; q++) {
        palp_recording r = table_run(q, q + 1 == DEPTHS ? 150.0 : 200.0);
        palp_characterize_settings s = with_arms(1);
        s.dwell_only = true;
        palp_lumped_fit f = fit(1, &r, s);
        ck_assert_double_eq_tol(f.spring_N[0], TABLE[q][6], 0.004 * TABLE[q][6]);
        ck_assert_double_eq_tol(f.material.arms[0].stiffness_N, TABLE[q][7], 0.1 * TABLE[q][7]);
        ck_assert_double_gt(f.reduced_chi2, 10.0); /* one arm is not enough, and the fit says so */
        ck_assert_double_gt(f.inflation, 3.0);
        palp_lumped_fit_free(&f);
        palp_recording_free(&r);
    }
}
END_TEST

START_TEST(shared_arms_leave_no_more_than_the_grid) {
    palp_recording r[DEPTHS];
    for (size_t q = 0; q < DEPTHS; q++)
        r[q] = table_run(q, 200.0);
    palp_characterize_settings s = with_arms(2);
    for (size_t n = 3; n <= DEPTHS; n += 9) { /* of three the holds only */
        s.dwell_only = n == 3;
        palp_lumped_fit ours = fit(n, r, s), grid;
        ck_assert_int_eq(palp_thesis_grid(n, r, &s, &grid, NULL), PALP_OK);
        ck_assert_double_le(total(&ours), total(&grid));
        ck_assert_double_gt(total(&ours), 0.5 * total(&grid));
        ck_assert_uint_eq(grid.material.n_arms, 2);
        palp_lumped_fit_free(&ours);
        palp_lumped_fit_free(&grid);
    }
    free_all(DEPTHS, r);
}
END_TEST

static double worst_off(const palp_law *law) {
    double worst = 0.0;
    palp_law truth = polynomial(5, LAW);
    for (double e = 0.03; e <= 0.4; e += 0.005) {
        double f, g;
        palp_law_force(law, 1, &e, &f, NULL, NULL);
        palp_law_force(&truth, 1, &e, &g, NULL, NULL);
        worst = fmax(worst, fabs(f / g - 1.0));
    }
    return worst;
}

/* Figure 4.26: 0.1 mm/s is not slow against arms of 1.4 and 35 s, so that the static curve alone is too
 * stiff; the holds and the curve together are not. */
START_TEST(static_curve_and_holds_together_close_the_gap) {
    enum { RUNS = 5 };
    palp_recording r[RUNS];
    take slow = {phantom(), 9.7, 97.0, 0.0, 2.0, 100.0, 0.004, "static", 1};
    r[0] = prepare(record(&slow));
    for (size_t q = 1; q < RUNS; q++) {
        take hold = {phantom(), 1.5 * (double)q, 1.0, 200.0, 1.0, 100.0, 0.004, "ramp_hold", 1 + q};
        r[q] = prepare(record(&hold));
    }
    palp_law plain;
    double norm, before = 0.0, after = 0.0;
    ck_assert_int_eq(palp_thesis_polynomial(&r[0], 5, &plain, &norm), PALP_OK);
    palp_lumped_fit joint = fit(RUNS, r, with_law(polynomial(5, (double[5]){1.0}), 2));
    ck_assert_double_lt(worst_off(&joint.material.law), 0.01);
    ck_assert_double_gt(worst_off(&plain), 0.03);
    ck_assert_double_eq_tol(joint.reduced_chi2, 1.0, 0.2);
    ck_assert_double_eq_tol(joint.material.arms[0].stiffness_N, 2.5847711, 0.01 * 2.5847711);
    ck_assert_double_eq_tol(joint.material.arms[1].viscosity_Ns, 23.964533, 0.01 * 23.964533);
    for (size_t q = 1; q < RUNS; q++) {
        palp_characterize_settings s = with_arms(2);
        s.dwell_only = true;
        palp_lumped_fit alone = fit(1, &r[q], s);
        double k, e = r[q].deepest_m / r[q].height_m;
        palp_law_stiffness(&plain, e, &k, NULL);
        before = fmax(before, fabs(k / alone.spring_N[0] - 1.0));
        palp_law_stiffness(&joint.material.law, e, &k, NULL);
        after = fmax(after, fabs(k / alone.spring_N[0] - 1.0));
        palp_lumped_fit_free(&alone);
    }
    ck_assert_double_gt(before, 0.05);
    ck_assert_double_lt(after, 0.01);
    palp_lumped_fit_free(&joint);
    free_all(RUNS, r);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, table_4_3_comes_back);
    tcase_add_test(tc, table_4_2_comes_back);
    tcase_add_test(tc, shared_arms_leave_no_more_than_the_grid);
    tcase_add_test(tc, static_curve_and_holds_together_close_the_gap);
}
