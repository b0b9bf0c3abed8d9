/* test_fit_robust.c: defects of recordings are reported, and the answer is still right. */
#include "recordings.h"

static const double TRUTH[7] = {8.9,  2.3,  3.5,        3.5 / 2.3,
                                0.63, 21.0, 21.0 / 0.63}; /* as the estimates are ordered */

static take press(uint64_t seed) {
    return (take){two_arms(8.9, 2.3, 3.5, 0.63, 21.0), 5.0, 1.0, 150.0, 1.0, 500.0, 0.004, "ramp_hold", seed};
}

/* K_inf within a share, arms within another, and the truth within 4 sd of each. */
static void answer_is(const palp_recording *r, double spring, double arms) {
    palp_lumped_fit f = fit(1, r, with_arms(2));
    ck_assert_uint_eq(f.n_merged, 0);
    for (size_t i = 0; i < 7; i++) {
        double share = i == 0 ? spring : arms, z = (f.estimate[i].value - TRUTH[i]) / f.estimate[i].sd;
        ck_assert_msg(fabs(f.estimate[i].value / TRUTH[i] - 1.0) < share, "%s: %g, not %g",
                      f.estimate[i].name, f.estimate[i].value, TRUTH[i]);
        ck_assert_msg(fabs(z) < 4.0, "%s: %g is %g sd off", f.estimate[i].name, f.estimate[i].value, z);
    }
    palp_lumped_fit_free(&f);
}

/* The samples i that keep[i] is set for. */
static palp_experiment *only(palp_experiment *e, const unsigned char *keep) {
    static const char *const NAMES[] = {"time_s", "depth_mm", "force_N"};
    size_t n = palp_experiment_rows(e), m = 0;
    palp_experiment *part;
    for (size_t i = 0; i < n; i++)
        m += keep[i];
    ck_assert_int_eq(palp_experiment_create(m, &part), PALP_OK);
    for (size_t c = 0; c < 3; c++) {
        const double *from = palp_experiment_column(e, NAMES[c]);
        double *to = palp_experiment_column(part, NAMES[c]);
        for (size_t i = 0; i < n; i++)
            if (keep[i])
                *to++ = from[i];
    }
    palp_experiment_set_number(part, "specimen.height_mm", 24.0);
    palp_experiment_set_string(part, "protocol.kind", "ramp_hold");
    palp_experiment_free(e);
    return part;
}

/* Without the samples from one time to another. */
static palp_experiment *without(palp_experiment *e, double from, double to) {
    size_t n = palp_experiment_rows(e);
    const double *time = palp_experiment_column(e, "time_s");
    unsigned char *keep = malloc(n);
    for (size_t i = 0; i < n; i++)
        keep[i] = time[i] < from || time[i] >= to;
    e = only(e, keep);
    free(keep);
    return e;
}

START_TEST(clean) {
    take t = press(1);
    palp_recording r = prepare(record(&t));
    answer_is(&r, 0.001, 0.01);
    palp_recording_free(&r);
}
END_TEST

START_TEST(mains_hum) {
    take t = press(2);
    palp_experiment *e = record(&t);
    double *force = palp_experiment_column(e, "force_N");
    const double *time = palp_experiment_column(e, "time_s");
    for (size_t i = 0; i < palp_experiment_rows(e); i++)
        force[i] += 0.02 * sin(6.283185307179586 * 50.0 * time[i] + 0.3);
    palp_recording r = prepare(e);
    ck_assert_double_eq_tol(r.hum_N, 0.02, 0.001);
    answer_is(&r, 0.003, 0.03);
    palp_recording_free(&r);
}
END_TEST

START_TEST(a_lost_second) {
    static const double lost[3][2] = {
        {30.0, 31.0}, {2.2, 3.2}, {1.4, 1.7}}; /* in the hold, early in it, on the ramp */
    for (size_t k = 0; k < 3; k++) {
        take t = press(3);
        palp_recording r = prepare(without(record(&t), lost[k][0], lost[k][1]));
        ck_assert_uint_eq(r.n_gaps, 1);
        answer_is(&r, 0.001, 0.015);
        palp_recording_free(&r);
    }
}
END_TEST

START_TEST(spikes) {
    static const size_t at[] = {200, 700, 1003, 20000, 60000}; /* air, ramp, after the peak, hold */
    take t = press(4);
    palp_experiment *e = record(&t);
    for (size_t k = 0; k < 5; k++)
        palp_experiment_column(e, "force_N")[at[k]] += k % 2 ? -3.0 : 3.0;
    palp_recording r = prepare(e);
    ck_assert_uint_eq(r.n_spikes, 5);
    answer_is(&r, 0.001, 0.01);
    palp_recording_free(&r);
}
END_TEST

START_TEST(a_clipped_top) {
    take t = press(5);
    palp_experiment *e = record(&t);
    double *force = palp_experiment_column(e, "force_N");
    for (size_t i = 0; i < palp_experiment_rows(e); i++)
        force[i] = fmin(force[i], 2.1); /* of 2.34 */
    palp_recording r = prepare(e);
    ck_assert_uint_gt(r.n_clipped, 500);
    answer_is(&r, 0.001, 0.02);
    palp_recording_free(&r);
}
END_TEST

START_TEST(a_run_that_ends_early) {
    take t = press(6);
    t.hold_s = 60.0; /* not twice the longer relaxation time */
    palp_experiment *e = record(&t);
    palp_experiment_set_string(e, "end.fault", "over_temperature");
    palp_recording r = prepare(e);
    ck_assert(r.faulted);
    answer_is(&r, 0.01, 0.05);
    palp_recording_free(&r);
}
END_TEST

START_TEST(uneven_sampling) {
    take t = press(7);
    palp_experiment *e = record(&t);
    size_t n = palp_experiment_rows(e);
    unsigned char *keep = malloc(n);
    uint64_t state = 77;
    for (size_t i = 0; i < n; i++)
        keep[i] = palp_random_uniform(&state) < 0.6;
    palp_recording r = prepare(only(e, keep));
    ck_assert(r.uneven);
    answer_is(&r, 0.001, 0.015);
    palp_recording_free(&r);
    free(keep);
}
END_TEST

START_TEST(no_free_air) {
    take t = press(8);
    t.air_s = 0.0;
    palp_recording r = prepare(record(&t));
    ck_assert_int_eq(r.contact_rule, PALP_CONTACT_NOMINAL);
    answer_is(&r, 0.001, 0.01);
    palp_recording_free(&r);
}
END_TEST

/* Contact where the file does not say: found, and the intervals know how well. */
START_TEST(contact_off) {
    for (int k = 0; k < 2; k++) {
        take t = press(9);
        palp_experiment *e = record(&t);
        double *depth = palp_experiment_column(e, "depth_mm"), off = k ? 0.05 : -0.06;
        for (size_t i = 0; i < palp_experiment_rows(e); i++)
            depth[i] += off;
        palp_recording r = prepare(e);
        ck_assert_double_eq_tol(1e3 * r.contact_m, off, 3e3 * r.contact_sd_m);
        answer_is(&r, 0.005, 0.02);
        palp_lumped_fit f = fit(1, &r, with_arms(2));
        ck_assert_double_gt(f.estimate[0].sd, 0.9 * f.estimate[0].value * r.contact_sd_m / 5e-3);
        palp_lumped_fit_free(&f);
        palp_recording_free(&r);
    }
}
END_TEST

/* One count is 5 mN, the noise before rounding a fifth of that. */
START_TEST(a_coarse_converter) {
    take t = press(10);
    t.noise_N = 0.001;
    t.rate_Hz = 100.0;
    palp_experiment *e = record(&t);
    double *force = palp_experiment_column(e, "force_N");
    for (size_t i = 0; i < palp_experiment_rows(e); i++)
        force[i] = 0.005 * floor(force[i] / 0.005 + 0.5);
    palp_recording r = prepare(e);
    ck_assert_uint_eq(r.n_spikes + r.n_clipped, 0);
    answer_is(&r, 0.005, 0.03);
    palp_recording_free(&r);
}
END_TEST

START_TEST(no_noise) {
    take t = press(11);
    t.noise_N = 0.0;
    palp_recording r = prepare(record(&t));
    palp_lumped_fit f = fit(1, &r, with_arms(2));
    for (size_t i = 0; i < 7; i++)
        ck_assert_double_eq_tol(f.estimate[i].value, TRUTH[i], 1e-4 * TRUTH[i]);
    palp_lumped_fit_free(&f);
    palp_recording_free(&r);
}
END_TEST

/* Noise that is not white, correlated by 0.9 from sample to sample: wider intervals. */
START_TEST(coloured_noise) {
    take t = press(12);
    t.noise_N = 0.0;
    palp_experiment *e = record(&t);
    double *force = palp_experiment_column(e, "force_N"), x = 0.0;
    uint64_t state = 12;
    for (size_t i = 0; i < palp_experiment_rows(e); i++) {
        x = 0.9 * x + 0.002 * palp_random_normal(&state);
        force[i] += x;
    }
    palp_recording r = prepare(e);
    ck_assert_double_gt(r.correlation, 0.8);
    palp_lumped_fit f = fit(1, &r, with_arms(2));
    ck_assert_double_gt(f.inflation, 2.0);
    palp_lumped_fit_free(&f);
    answer_is(&r, 0.003, 0.03);
    palp_recording_free(&r);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, clean);
    tcase_add_test(tc, mains_hum);
    tcase_add_test(tc, a_lost_second);
    tcase_add_test(tc, spikes);
    tcase_add_test(tc, a_clipped_top);
    tcase_add_test(tc, a_run_that_ends_early);
    tcase_add_test(tc, uneven_sampling);
    tcase_add_test(tc, no_free_air);
    tcase_add_test(tc, contact_off);
    tcase_add_test(tc, a_coarse_converter);
    tcase_add_test(tc, no_noise);
    tcase_add_test(tc, coloured_noise);
}
