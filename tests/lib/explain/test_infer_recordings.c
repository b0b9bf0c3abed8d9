/* test_infer_recordings.c: the law, the arms and the specimens of recordings, as palpate characterize finds
 * them; in any units the same to the last digits. */
#include "fractional_step.h"
#include "sweeps.h"

#include <stdio.h>

enum { LAWS = 10, RUNS = 5 };
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

static palp_specimens_fit find(size_t n, palp_recording *r, size_t most_arms, double force) {
    palp_law law[LAWS];
    palp_specimens_fit f;
    palp_error error = {PALP_OK, ""};
    for (size_t q = 0; q < n; q++)
        snprintf(r[q].name, sizeof r[q].name, "run %zu", q);
    const palp_explain_settings settings = palp_explain_settings_default();
    const palp_explain_choice choice = {.most_arms = most_arms, .n_laws = candidates(force, law), .law = law};
    palp_status status = palp_explain_recordings(n, r, NULL, &settings, &choice, &f, &error);
    ck_assert_msg(status == PALP_OK, "%s", error.text);
    return f;
}

/* Largest difference of the forces at rest up to the strain, relative to the largest. */
static double off(const palp_law *truth, const palp_law *found, double top) {
    double worst = 0.0, want = 0.0, got;
    for (int i = 1; i <= 100; i++) {
        double e = top * i / 100;
        palp_law_force(truth, 1, &e, &want, NULL, NULL);
        palp_law_force(found, 1, &e, &got, NULL, NULL);
        worst = fmax(worst, fabs(got - want));
    }
    return worst / want;
}

/* The force of the law that made the runs, of five presses and of one alone. In units a million and a
 * thousand times as small the estimates differ by these factors alone. */
START_TEST(the_law_that_made_the_runs_is_met) {
    static const double c[3] = {8.0, -6.0, 120.0}, neo[1] = {4000.0}, yeoh[3] = {3000.0, 1500.0, 4000.0};
    palp_law truth;
    if (_i < 2)
        truth = polynomial(_i == 0 ? 1 : 3, c);
    else
        ck_assert_int_eq(palp_law_hyperelastic(_i == 2 ? PALP_LAW_NEO_HOOKEAN : PALP_LAW_YEOH,
                                               _i == 2 ? 1 : 3, _i == 2 ? neo : yeoh, AREA, &truth),
                         PALP_OK);
    palp_recording r[RUNS];
    for (uint64_t q = 0; q < RUNS; q++)
        r[q] = q == 0 ? press(truth, 2, 9.0, 90.0, 0.0, 40 + q)
                      : press(truth, 2, 9.0 - 1.5 * (double)q, 1.0, 60.0, 40 + q);
    palp_specimens_fit one = find(RUNS, r, PALP_ARMS_MAX, 1.0);
    ck_assert_uint_eq(one.mean.material.n_arms, 2);
    ck_assert_double_lt(off(&truth, &one.mean.material.law, 9.0 / 24.0), 0.003);
    rescale(RUNS, r, 1e-6, 1e-3);
    palp_specimens_fit other = find(RUNS, r, PALP_ARMS_MAX, 1e-6);
    ck_assert_uint_eq(other.mean.n_estimates, one.mean.n_estimates);
    ck_assert_int_eq(other.mean.material.law.kind, one.mean.material.law.kind);
    for (size_t i = 0; i < one.mean.n_estimates; i++) {
        const palp_estimate *a = &one.mean.estimate[i], *b = &other.mean.estimate[i];
        const double unit = strcmp(a->unit, "s") == 0 || !a->unit[0] ? 1.0 : 1e-6;
        ck_assert_double_eq_tol(b->value, unit * a->value, 1e-9 * fabs(unit * a->value));
        ck_assert_double_eq_tol(b->sd, unit * a->sd, 1e-9 * unit * a->sd);
    }
    for (size_t q = 0; q < RUNS; q++)
        ck_assert_double_eq_tol(other.mean.contact_m[q], 1e-3 * one.mean.contact_m[q], 1e-15);
    palp_specimens_fit_free(&other);
    palp_specimens_fit_free(&one);
    free_all(RUNS, r);
    r[0] = press(truth, 0, 9.0, 90.0, 0.0, 50);
    one = find(1, r, PALP_ARMS_MAX, 1.0);
    ck_assert_uint_eq(one.mean.material.n_arms, 0);
    ck_assert_double_lt(off(&truth, &one.mean.material.law, 9.0 / 24.0), 0.003);
    palp_specimens_fit_free(&one);
    palp_recording_free(&r[0]);
}
END_TEST

/* K(e) of no family here. */
START_TEST(a_law_of_no_family_is_met) {
    static const double grid[9] = {0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4};
    double k[9];
    palp_law truth;
    for (int i = 0; i < 9; i++)
        k[i] = 4.0 + 3.0 * exp(7.0 * grid[i]) + 2.0 / (1.0 + exp(-(grid[i] - 0.15) / 0.04));
    ck_assert_int_eq(palp_law_spline(9, grid, k, &truth), PALP_OK);
    palp_recording r[4];
    for (uint64_t q = 0; q < 4; q++)
        r[q] = q == 0 ? press(truth, 2, 9.0, 90.0, 0.0, 60)
                      : press(truth, 2, 9.0 - 2.0 * (double)q, 1.0, 60.0, 60 + q);
    palp_specimens_fit f = find(4, r, PALP_ARMS_MAX, 1.0);
    ck_assert_double_lt(off(&truth, &f.mean.material.law, 9.0 / 24.0), 0.003);
    palp_specimens_fit_free(&f);
    free_all(4, r);
}
END_TEST

/* One ramp and hold: the ramp shows that K rises, the hold the relaxed stiffness. */
START_TEST(a_single_ramp_and_hold_has_a_law) {
    const palp_law truth = polynomial(2, (double[2]){6.0, 20.0});
    palp_recording r = press(truth, 1, 8.0, 10.0, 100.0, 70);
    palp_specimens_fit f = find(1, &r, PALP_ARMS_MAX, 1.0);
    ck_assert_double_lt(off(&truth, &f.mean.material.law, 8.0 / 24.0), 0.015);
    palp_specimens_fit_free(&f);
    palp_recording_free(&r);
}
END_TEST

/* The oscillation has most of the samples, the ramp determines the law. */
START_TEST(the_ramp_of_a_sweep_tells_the_law) {
    static const double LAW_OF_SWEEP[3] = {8.0, -6.0, 120.0};
    sweep s = {phantom(), 3.0, 0.3, 10.0, 0.1, 10.0, 60.0, 200.0, 0.002, 3};
    s.material.law = polynomial(3, LAW_OF_SWEEP);
    palp_recording r = prepare(record_sweep(&s));
    palp_specimens_fit f = find(1, &r, PALP_ARMS_MAX, 1.0);
    ck_assert_uint_eq(f.mean.material.n_arms, 2);
    ck_assert_double_lt(off(&s.material.law, &f.mean.material.law, 3.0 / 24.0), 0.01);
    ck_assert_double_lt(f.mean.rms_N[0], 1.05 * s.noise_N);
    palp_specimens_fit_free(&f);
    palp_recording_free(&r);
}
END_TEST

/* Arms at fixed times follow a fractional element: times even in log, and the force to a part in 4000. */
START_TEST(a_spectrum_even_in_log_time_follows_it) {
    palp_law law = polynomial(1, (double[1]){10.0});
    const palp_explain_settings settings = palp_explain_settings_default();
    const palp_explain_choice choice = {.per_decade = 2, .n_laws = 1, .law = &law, .no_spline = true};
    palp_recording r = step(1.0, 1.0, 1e-4);
    palp_specimens_fit f;
    ck_assert_int_eq(palp_explain_recordings(1, &r, NULL, &settings, &choice, &f, NULL), PALP_OK);
    const palp_material *m = &f.mean.material;
    ck_assert_uint_gt(m->n_arms, 4);
    for (size_t j = 1; j < m->n_arms; j++) {
        const double steps = 2.0 * log10(m->arms[j].viscosity_Ns / m->arms[j].stiffness_N /
                                         (m->arms[0].viscosity_Ns / m->arms[0].stiffness_N));
        ck_assert_double_lt(fabs(steps - round(steps)), 1e-9);
    }
    ck_assert_double_lt(f.mean.rms_N[0], 2.5e-4);
    palp_specimens_fit_free(&f);
    palp_recording_free(&r);
}
END_TEST

START_TEST(bad_requests_are_refused) {
    palp_recording r[2] = {press(polynomial(1, (double[1]){9.0}), 0, 5.0, 50.0, 0.0, 1),
                           press(polynomial(1, (double[1]){9.0}), 0, 5.0, 50.0, 0.0, 2)};
    const palp_explain_settings settings = palp_explain_settings_default();
    palp_explain_choice choice = {.n_laws = 0};
    palp_specimens_fit f;
    ck_assert_int_eq(palp_explain_recordings(0, r, NULL, &settings, &choice, &f, NULL), PALP_ERR_ARGUMENT);
    r[1].height_m *= 1.01;
    ck_assert_int_eq(palp_explain_recordings(2, r, NULL, &settings, &choice, &f, NULL), PALP_ERR_ARGUMENT);
    choice.no_spline = true;
    ck_assert_int_eq(palp_explain_recordings(1, r, NULL, &settings, &choice, &f, NULL), PALP_ERR_ARGUMENT);
    free_all(2, r);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, the_law_that_made_the_runs_is_met, 0, 4);
    tcase_add_test(tc, a_law_of_no_family_is_met);
    tcase_add_test(tc, a_single_ramp_and_hold_has_a_law);
    tcase_add_test(tc, the_ramp_of_a_sweep_tells_the_law);
    tcase_add_test(tc, a_spectrum_even_in_log_time_follows_it);
    tcase_add_test(tc, bad_requests_are_refused);
}
