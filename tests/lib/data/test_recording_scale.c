/* test_recording_scale.c: force, length and time in other units give the same recording: its contact, zero,
 * noise, kind and motion scale. */
#include "recordings.h"

static palp_recording scaled(const take *t, double force, double length, double time) {
    palp_experiment *e = record(t);
    double *s = palp_experiment_column(e, "time_s"), *d = palp_experiment_column(e, "depth_mm"),
           *f = palp_experiment_column(e, "force_N");
    for (size_t i = 0; i < palp_experiment_rows(e); i++) {
        s[i] *= time;
        d[i] = length * (d[i] - 0.05); /* contact is off */
        f[i] = force * (f[i] + 0.3);   /* and zero */
    }
    palp_experiment_set_number(e, "specimen.height_mm", 24.0 * length);
    return prepare(e);
}

START_TEST(scales_change_nothing) {
    static const double forces[] = {1e-9, 1e-3, 1.0, 1e3}, lengths[] = {1e-4, 1.0, 10.0},
                        times[] = {1e-3, 1.0, 1e3};
    take t = {
        two_arms(8.9, 2.3, 3.5, 0.63, 21.0), 4.0, 1.0, 6.0, 1.0, 100.0, _i ? 0.004 : 0.0, "ramp_hold", 11};
    palp_recording one = scaled(&t, 1.0, 1.0, 1.0);
    ck_assert_int_eq(one.kind, PALP_RECORDING_RAMP_HOLD);
    for (size_t k = 0; k < 36; k++) {
        double f = forces[k % 4], l = lengths[k / 4 % 3], s = times[k / 12];
        palp_recording r = scaled(&t, f, l, s);
        ck_assert_int_eq(r.kind, one.kind);
        ck_assert_int_eq(r.contact_rule, one.contact_rule);
        ck_assert_uint_eq(r.n_spikes + r.n_clipped + r.n_gaps + r.n_missing, 0);
        ck_assert_double_eq_tol(r.contact_m, l * one.contact_m, 1e-6 * fabs(l * one.contact_m));
        ck_assert_double_eq_tol(r.zero_N, f * one.zero_N, 1e-6 * fabs(f * one.zero_N));
        ck_assert_double_eq_tol(r.noise_N, f * one.noise_N, 1e-6 * f * one.noise_N + 1e-12 * f);
        ck_assert_double_eq_tol(r.ramp_start_s, s * one.ramp_start_s, 1e-9 * s * one.ramp_start_s);
        ck_assert_double_eq_tol(r.ramp_end_s, s * one.ramp_end_s, 1e-9 * s * one.ramp_end_s);
        palp_recording_free(&r);
    }
    palp_recording_free(&one);
}
END_TEST

/* Two recordings of the same press, but for the noise: zero and contact by the same rule, within what their
 * sds say. */
START_TEST(identical_runs_are_found_alike) {
    double low = HUGE_VAL, high = -HUGE_VAL, sd = 0.0;
    for (uint64_t seed = 1; seed <= 24; seed++) {
        take t = {two_arms(8.9, 2.3, 3.5, 0.63, 21.0), 4.0, 1.0, 6.0, 1.0, 1000.0, 0.02, "ramp_hold", seed};
        palp_recording r = prepare(record(&t));
        ck_assert_int_eq(r.contact_rule, PALP_CONTACT_FREE_AIR);
        low = fmin(low, r.contact_m);
        high = fmax(high, r.contact_m);
        sd = fmax(sd, r.contact_sd_m);
        palp_recording_free(&r);
    }
    ck_assert_double_le(high - low, 6.0 * sd);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, scales_change_nothing, 0, 2);
    tcase_add_test(tc, identical_runs_are_found_alike);
}
