/* test_fit_law.c: which stiffness law recordings ask for: its family and its size. */
#include "recordings.h"

enum { LAWS = 10 };
static const double AREA = 4.5e-4;

/* In the order of preference, each with first guesses far from the truth; newtons times force. */
static size_t candidates(double force, palp_law law[LAWS]) {
    const double ones[7] = {10.0 * force, 1e-3 * force, 1e-3 * force, 1e-3 * force,
                            1e-3 * force, 1e-3 * force, 1e-3 * force};
    const double pascals[5] = {3000.0 * force, 100.0 * force, 100.0 * force, 100.0 * force, 100.0 * force};
    const double knots[4] = {0.0, 0.125, 0.25, 0.375};
    const double flat[4] = {10.0 * force, 10.0 * force, 10.0 * force, 10.0 * force};
    size_t n = 0;
    law[n++] = polynomial(1, ones);
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_NEO_HOOKEAN, 1, pascals, AREA, &law[n++]), PALP_OK);
    law[n++] = polynomial(2, ones);
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_MOONEY_RIVLIN2, 2, pascals, AREA, &law[n++]), PALP_OK);
    law[n++] = polynomial(3, ones);
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_YEOH, 3, pascals, AREA, &law[n++]), PALP_OK);
    law[n++] = polynomial(4, ones);
    ck_assert_int_eq(palp_law_spline(4, knots, flat, &law[n++]), PALP_OK);
    law[n++] = polynomial(5, ones);
    law[n++] = polynomial(6, ones);
    return n;
}

static palp_recording press(palp_law law, size_t n_arms, double depth_mm, double ramp_s, double hold_s,
                            uint64_t seed) {
    palp_material m = phantom();
    m.law = law;
    m.n_arms = n_arms;
    take t = {m, depth_mm, ramp_s, hold_s, 1.0, 50.0, 0.004, hold_s > 0.0 ? "ramp_hold" : "static", seed};
    return prepare(record(&t));
}

/* Newtons of every run times force, lengths times length. */
static void rescale(size_t n, palp_recording *r, double force, double length) {
    for (size_t q = 0; q < n; q++) {
        for (size_t i = 0; i < r[q].n; i++) {
            r[q].force_N[i] *= force;
            r[q].depth_m[i] *= length;
        }
        r[q].height_m *= length;
        r[q].deepest_m *= length;
        r[q].contact_m *= length;
        r[q].contact_sd_m *= length;
        r[q].noise_N *= force;
        r[q].zero_N *= force;
        r[q].zero_sd_N *= force;
    }
}

static size_t chosen(size_t n, const palp_recording *r, size_t n_arms, double force, palp_law law[LAWS]) {
    double score[LAWS], sd[LAWS];
    size_t count = candidates(force, law), best = 99;
    palp_error error = {PALP_OK, ""};
    palp_characterize_settings s = with_law(law[0], n_arms);
    palp_status status = palp_characterize_select_law(n, r, &s, count, law, score, sd, &best, &error);
    ck_assert_msg(status == PALP_OK, "%s", error.text);
    for (size_t c = 0; c < count; c++)
        ck_assert(isfinite(score[c]) && score[c] > 0.0);
    return best;
}

/* The family and the size that made the run, of a press alone, of five presses, and in other units. */
START_TEST(the_law_that_made_the_runs_is_chosen) {
    static const double c[3] = {8.0, -6.0, 120.0}, neo[1] = {4000.0}, yeoh[3] = {3000.0, 1500.0, 4000.0};
    palp_law truth, law[LAWS];
    static const size_t want[4] = {0, 4, 1, 5};
    if (_i < 2)
        truth = polynomial(_i == 0 ? 1 : 3, c);
    else
        ck_assert_int_eq(palp_law_hyperelastic(_i == 2 ? PALP_LAW_NEO_HOOKEAN : PALP_LAW_YEOH,
                                               _i == 2 ? 1 : 3, _i == 2 ? neo : yeoh, AREA, &truth),
                         PALP_OK);
    palp_recording r[5];
    for (uint64_t q = 0; q < 5; q++)
        r[q] = q == 0 ? press(truth, 2, 9.0, 90.0, 0.0, 40 + q)
                      : press(truth, 2, 9.0 - 1.5 * (double)q, 1.0, 60.0, 40 + q);
    ck_assert_uint_eq(chosen(5, r, 2, 1.0, law), want[_i]);
    rescale(5, r, 1e-6, 1e-3);
    ck_assert_uint_eq(chosen(5, r, 2, 1e-6, law), want[_i]);
    free_all(5, r);
    r[0] = press(truth, 0, 9.0, 90.0, 0.0, 50);
    ck_assert_uint_eq(chosen(1, r, 0, 1.0, law), want[_i]);
    palp_recording_free(&r[0]);
}
END_TEST

/* K(e) of no family here: the force of what is chosen is right to 1 % of the largest all the same. */
START_TEST(a_law_of_no_family_is_met) {
    static const double grid[9] = {0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4};
    double k[9];
    palp_law truth, law[LAWS];
    for (int i = 0; i < 9; i++)
        k[i] = 4.0 + 3.0 * exp(7.0 * grid[i]) + 2.0 / (1.0 + exp(-(grid[i] - 0.15) / 0.04));
    ck_assert_int_eq(palp_law_spline(9, grid, k, &truth), PALP_OK);
    palp_recording r[4];
    for (uint64_t q = 0; q < 4; q++)
        r[q] = q == 0 ? press(truth, 2, 9.0, 90.0, 0.0, 60)
                      : press(truth, 2, 9.0 - 2.0 * (double)q, 1.0, 60.0, 60 + q);
    size_t best = chosen(4, r, 2, 1.0, law);
    palp_lumped_fit f = fit(4, r, with_law(law[best], 2));
    double worst = 0.0, want, got, top = 9.0 / 24.0;
    for (int i = 1; i <= 100; i++) {
        double e = top * i / 100;
        palp_law_force(&truth, 1, &e, &want, NULL, NULL);
        palp_law_force(&f.material.law, 1, &e, &got, NULL, NULL);
        worst = fmax(worst, fabs(got - want));
    }
    palp_law_force(&truth, 1, &top, &want, NULL, NULL);
    ck_assert_msg(worst < 0.01 * want, "law %zu: off by %g of %g N", best, worst, want);
    palp_lumped_fit_free(&f);
    free_all(4, r);
}
END_TEST

/* One ramp and hold: the ramp shows that K rises, the hold the relaxed stiffness. */
START_TEST(a_single_ramp_and_hold_has_a_law) {
    palp_law law[LAWS];
    palp_recording r = press(polynomial(2, (double[2]){6.0, 20.0}), 1, 8.0, 10.0, 100.0, 70);
    size_t best = chosen(1, &r, 1, 1.0, law);
    ck_assert_uint_eq(best, 2);
    palp_lumped_fit f = fit(1, &r, with_law(law[best], 1));
    ck_assert_double_eq_tol(f.material.law.coefficients[0], 6.0, 0.1);
    ck_assert_double_eq_tol(f.material.law.coefficients[1], 20.0, 0.4);
    palp_lumped_fit_free(&f);
    palp_recording_free(&r);
}
END_TEST

START_TEST(bad_requests_are_refused) {
    palp_law law[LAWS];
    palp_recording r = press(polynomial(1, (double[1]){9.0}), 0, 5.0, 50.0, 0.0, 1);
    double score[LAWS], sd[LAWS];
    size_t count = candidates(1.0, law), best;
    palp_characterize_settings s = with_law(law[0], 0);
    ck_assert_int_eq(palp_characterize_select_law(1, &r, &s, 0, law, score, sd, &best, NULL),
                     PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_characterize_select_law(0, &r, &s, count, law, score, sd, &best, NULL),
                     PALP_ERR_ARGUMENT);
    s.spring = PALP_SPRING_PER_RUN;
    ck_assert_int_eq(palp_characterize_select_law(1, &r, &s, count, law, score, sd, &best, NULL),
                     PALP_ERR_ARGUMENT);
    palp_recording_free(&r);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, the_law_that_made_the_runs_is_chosen, 0, 4);
    tcase_add_test(tc, a_law_of_no_family_is_met);
    tcase_add_test(tc, a_single_ramp_and_hold_has_a_law);
    tcase_add_test(tc, bad_requests_are_refused);
}
