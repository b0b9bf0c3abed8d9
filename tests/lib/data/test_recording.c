/* test_recording.c: facts found in a recording, clean and disturbed. */
#include "recordings.h"

static take clean(void) {
    return (take){two_arms(8.9, 2.3, 3.5, 0.63, 21.0), 4.0, 1.0, 12.0, 1.0, 1000.0, 0.004, "ramp_hold", 11};
}

static palp_recording prepare_with(palp_experiment *e, palp_recording_settings settings) {
    palp_recording r;
    ck_assert_int_eq(palp_recording_prepare(e, "run.csv", &settings, &r, NULL), PALP_OK);
    palp_experiment_free(e);
    return r;
}

START_TEST(a_clean_recording_has_no_findings) {
    for (uint64_t seed = 1; seed <= 8; seed++) {
        take t = clean();
        t.seed = seed;
        palp_recording r = prepare(record(&t));
        ck_assert_double_eq_tol(r.noise_N, 0.004, 0.0002);
        ck_assert_int_eq(r.contact_rule, PALP_CONTACT_FREE_AIR);
        ck_assert_double_eq(r.contact_m, 0.0);
        ck_assert_double_lt(r.contact_sd_m, 2e-5);
        ck_assert_double_lt(fabs(r.zero_N), 4.0 * r.zero_sd_N);
        ck_assert_double_eq_tol(r.zero_sd_N, 0.004 / sqrt(1000.0), 0.1 * 0.004 / sqrt(1000.0));
        ck_assert_double_lt(fabs(r.correlation), 0.05);
        ck_assert_uint_eq(r.n_spikes + r.n_clipped + r.n_gaps, 0);
        ck_assert(!r.uneven && !r.faulted && !r.contact_found && r.hum_N == 0.0);
        ck_assert_double_eq_tol(r.ramp_start_s, 1.0, 0.01);
        ck_assert_double_eq_tol(r.ramp_end_s, 2.0, 0.01);
        ck_assert_double_eq_tol(r.deepest_m, 4e-3, 1e-12);
        palp_recording_free(&r);
    }
}
END_TEST

/* Nothing to find in an exact curve: elastic, whose hold is one number, or with arms; slow or in a second. */
START_TEST(a_recording_without_noise_has_no_findings) {
    for (int k = 0; k < 4; k++) {
        take t = clean();
        t.noise_N = 0.0;
        t.material.n_arms = k % 2 ? 2 : 0;
        t.ramp_s = k / 2 ? 1.0 : 40.0;
        t.rate_Hz = 200.0;
        palp_recording r = prepare(record(&t));
        ck_assert_uint_eq(r.n_spikes + r.n_clipped + r.n_gaps, 0);
        ck_assert_double_eq(r.contact_m, 0.0);
        ck_assert_double_lt(r.contact_sd_m, 1e-5);
        ck_assert_double_lt(r.noise_N, 1e-4);
        ck_assert_double_lt(fabs(r.zero_N), 1e-6);
        ck_assert(r.hum_N == 0.0);
        palp_recording_free(&r);
    }
}
END_TEST

/* The nominal contact is off by up to 0.08 mm either way: found within 3 of its sd, and that is small. */
START_TEST(contact_is_found_where_the_nominal_one_is_off) {
    double worst = 0.0, square = 0.0;
    for (int k = 0; k < 10; k++) {
        take t = clean();
        t.seed = (uint64_t)k + 1;
        double off = k % 2 ? 0.08 : -0.05;
        palp_experiment *e = record(&t);
        double *depth = palp_experiment_column(e, "depth_mm");
        for (size_t i = 0; i < palp_experiment_rows(e); i++)
            depth[i] += off;
        palp_recording r = prepare(e);
        double z = (1e3 * r.contact_m - off) / (1e3 * r.contact_sd_m);
        worst = fmax(worst, fabs(z));
        square += z * z / 10.0;
        ck_assert_double_lt(1e3 * r.contact_sd_m, 0.02);
        ck_assert_double_eq_tol(1e3 * r.deepest_m, 4.0, 0.02);
        palp_recording_free(&r);
    }
    ck_assert_double_lt(worst, 3.5);
    ck_assert_double_lt(square, 2.0);
}
END_TEST

START_TEST(a_force_that_bends_from_the_start_moves_no_contact) {
    take t = clean();
    double c[2] = {0.0, 60.0}; /* F = 60 e^2: a straight line through its first part crosses zero late */
    t.material.n_arms = 0;
    ck_assert_int_eq(palp_law_polynomial(2, c, &t.material.law), PALP_OK);
    t.ramp_s = 20.0;
    palp_recording r = prepare(record(&t));
    ck_assert_double_eq(r.contact_m, 0.0);
    palp_recording_free(&r);
}
END_TEST

START_TEST(without_air_the_record_is_trusted_and_doubted) {
    take t = clean();
    t.air_s = 0.0;
    palp_recording r = prepare(record(&t));
    ck_assert_int_eq(r.contact_rule, PALP_CONTACT_NOMINAL);
    ck_assert_double_eq(r.contact_m, 0.0);
    ck_assert_double_eq(r.zero_N, 0.0);
    ck_assert_double_gt(r.contact_sd_m, 1e-7);
    ck_assert_double_lt(r.contact_sd_m, 3e-5);
    palp_recording_free(&r);
    palp_experiment *e = record(&t);
    double *force = palp_experiment_column(e, "force_N");
    for (size_t i = 0; i < palp_experiment_rows(e); i++)
        force[i] += 0.02; /* as 0.02 N / 0.45 N/mm would: the first of the rise shows it */
    r = prepare(e);
    ck_assert_double_gt(r.contact_sd_m, 0.8 * 0.02 / 450.0);
    palp_recording_free(&r);
    e = record(&t);
    palp_experiment_set_number(e, "contact.sd_mm", 0.07);
    r = prepare(e);
    ck_assert_double_eq_tol(r.contact_sd_m, 0.07e-3, 1e-15);
    palp_recording_free(&r);
}
END_TEST

START_TEST(rest_on_the_specimen_is_zero_force_but_rest_within_it_is_not) {
    take t = clean();
    t.air_s = 0.0;
    palp_experiment *e = record(&t);
    size_t n = palp_experiment_rows(e), rest = 500;
    double *depth = palp_experiment_column(e, "depth_mm"), *force = palp_experiment_column(e, "force_N");
    uint64_t state = 5;
    for (size_t i = n; i-- > 0;) { /* half a second later, on a cell that shows 0.1 N */
        depth[i] = i >= rest ? depth[i - rest] : 0.0;
        force[i] = 0.1 + (i >= rest ? force[i - rest] : 0.004 * palp_random_normal(&state));
    }
    palp_recording r = prepare(e);
    ck_assert_double_eq_tol(r.zero_N, 0.1, 4.0 * 0.004 / sqrt(500.0));
    ck_assert_double_eq_tol(r.zero_sd_N, 0.004 / sqrt(500.0), 1e-5);
    palp_recording_free(&r);
    e = record(&t);
    depth = palp_experiment_column(e, "depth_mm");
    force = palp_experiment_column(e, "force_N");
    for (size_t i = n; i-- > 0;) { /* or 0.5 mm deep with its force */
        depth[i] = fmax(i >= rest ? depth[i - rest] : 0.0, 0.5);
        force[i] = i >= rest + 125 ? force[i - rest] : 0.22;
    }
    r = prepare(e);
    ck_assert_double_eq(r.zero_N, 0.0);
    ck_assert_double_eq_tol(r.force_N[100], 0.22, 1e-12);
    palp_recording_free(&r);
}
END_TEST

START_TEST(a_given_contact_is_taken) {
    take t = clean();
    palp_recording_settings settings = palp_recording_settings_default();
    settings.contact_given = true;
    settings.contact_m = 0.3e-3;
    settings.height_m = 0.025;
    palp_recording r = prepare_with(record(&t), settings);
    ck_assert_int_eq(r.contact_rule, PALP_CONTACT_GIVEN);
    ck_assert_double_eq(r.contact_m, 0.3e-3);
    ck_assert_double_eq(r.contact_sd_m, 0.0);
    ck_assert_double_eq(r.height_m, 0.025);
    ck_assert_double_eq_tol(r.deepest_m, 3.7e-3, 1e-12);
    palp_recording_free(&r);
    palp_experiment *e = record(&t);
    palp_experiment_set_string(e, "contact.rule", "find_contact");
    palp_experiment_set_number(e, "contact.sd_mm", 0.01);
    r = prepare(e);
    ck_assert(r.contact_found);
    ck_assert_int_eq(r.contact_rule, PALP_CONTACT_GIVEN);
    ck_assert_double_eq(r.contact_m, 0.0);
    ck_assert_double_eq_tol(r.contact_sd_m, 1e-5, 1e-18);
    ck_assert_double_eq(r.zero_N, 0.0);
    palp_recording_free(&r);
    e = record(&t);
    palp_experiment_set_string(e, "contact.rule", "as_recorded");
    r = prepare(e);
    ck_assert(!r.contact_found);
    ck_assert_int_eq(r.contact_rule, PALP_CONTACT_FREE_AIR);
    palp_recording_free(&r);
}
END_TEST

START_TEST(hum_a_spike_and_a_lost_second_are_found) {
    static const double hum_Hz[] = {50.0, 49.97, 60.03};
    for (size_t k = 0; k < 3; k++) {
        take t = clean();
        palp_experiment *e = record(&t);
        double *force = palp_experiment_column(e, "force_N"), *time = palp_experiment_column(e, "time_s");
        size_t n = palp_experiment_rows(e);
        for (size_t i = 0; i < n; i++)
            force[i] += 0.003 * sin(6.283185307179586 * hum_Hz[k] * time[i]);
        force[9000] += 1.0;
        for (size_t i = 12000; i < n; i++)
            time[i] += 1.0; /* a second was lost */
        palp_recording r = prepare(e);
        ck_assert_double_eq_tol(r.hum_Hz, hum_Hz[k], 0.03);
        ck_assert_double_eq_tol(r.hum_N, 0.003, 0.0003);
        ck_assert_double_eq_tol(r.noise_N, 0.004, 0.0003);
        ck_assert_uint_eq(r.n_spikes, 1);
        ck_assert_uint_eq(r.use[9000], 0);
        ck_assert_uint_eq(r.n_gaps, 1);
        ck_assert_double_eq_tol(r.longest_gap_s, 1.001, 1e-9);
        ck_assert(!r.uneven);
        palp_recording_free(&r);
    }
}
END_TEST

START_TEST(a_spike_in_the_air_moves_no_zero) {
    take t = clean();
    palp_experiment *e = record(&t);
    palp_experiment_column(e, "force_N")[300] = 20.0;
    palp_recording r = prepare(e);
    ck_assert_uint_eq(r.n_spikes, 1);
    ck_assert_double_lt(fabs(r.zero_N), 4.0 * 0.004 / sqrt(1000.0));
    ck_assert_double_eq(r.contact_m, 0.0);
    palp_recording_free(&r);
}
END_TEST

START_TEST(drift_in_the_air_widens_the_zero) {
    take t = clean();
    palp_experiment *e = record(&t);
    double *force = palp_experiment_column(e, "force_N");
    for (size_t i = 0; i < 1000; i++)
        force[i] += 0.008 * ((double)i / 1000.0 - 0.5);
    palp_recording r = prepare(e);
    ck_assert_double_gt(r.zero_sd_N, 2.0 * 0.004 / sqrt(1000.0));
    palp_recording_free(&r);
}
END_TEST

START_TEST(a_clipped_top_is_masked) {
    for (uint64_t seed = 1; seed <= 5; seed++) {
        take t = clean();
        t.seed = seed;
        palp_experiment *e = record(&t);
        double *force = palp_experiment_column(e, "force_N");
        size_t over = 0, odd = 0;
        for (size_t i = 0; i < palp_experiment_rows(e); i++)
            if (force[i] > 1.75) {
                force[i] = 1.75;
                over++;
            }
        palp_recording r = prepare(e);
        ck_assert_uint_gt(over, 100);
        ck_assert_uint_ge(r.n_clipped, over * 9 / 10);
        ck_assert_uint_le(r.n_clipped, over * 3);
        for (size_t i = 0; i < r.n; i++) /* nothing but what noise put there is masked */
            odd += !r.use[i] && r.force_N[i] + r.zero_N < 1.75 - 6.0 * t.noise_N;
        ck_assert_uint_eq(odd, 0);
        palp_recording_free(&r);
    }
}
END_TEST

/* Noise below one count of the converter, the counts written to seven digits, as a Mach-1 does. */
START_TEST(counts_of_a_coarse_converter_are_no_findings) {
    for (int k = 0; k < 3; k++) {
        const double count = 0.00122583, noise[] = {0.0006, 0.0003, 0.0};
        take t = clean();
        t.noise_N = noise[k];
        t.rate_Hz = 100.0;
        t.hold_s = 100.0;
        palp_experiment *e = record(&t);
        double *force = palp_experiment_column(e, "force_N");
        for (size_t i = 0; i < palp_experiment_rows(e); i++)
            force[i] = floor(force[i] / count + 0.5) * count + 1e-9 * (double)(i % 3);
        palp_recording r = prepare(e);
        ck_assert_uint_eq(r.n_spikes + r.n_clipped, 0);
        ck_assert_double_eq(r.contact_m, 0.0);
        /* between nothing and the noise with that of rounding, count / sqrt(12) */
        ck_assert_double_le(r.noise_N, 1.3 * hypot(noise[k], count / sqrt(12.0)));
        ck_assert_double_ge(r.noise_N, 0.5 * noise[k]);
        palp_recording_free(&r);
    }
}
END_TEST

START_TEST(uneven_times_and_a_fault_are_told) {
    take t = clean();
    palp_experiment *e = record(&t);
    double *time = palp_experiment_column(e, "time_s");
    uint64_t state = 3;
    for (size_t i = 0; i < palp_experiment_rows(e); i++)
        time[i] += 3e-4 * palp_random_uniform(&state);
    palp_experiment_set_string(e, "end.fault", "over_temperature");
    palp_recording r = prepare(e);
    ck_assert(r.uneven && r.faulted);
    ck_assert_uint_eq(r.n_gaps, 0);
    palp_recording_free(&r);
    e = record(&t);
    time = palp_experiment_column(e, "time_s");
    for (size_t i = 700; i < palp_experiment_rows(e); i++)
        time[i] += 1e-3; /* one lost sample makes no uneven recording */
    r = prepare(e);
    ck_assert(!r.uneven);
    palp_recording_free(&r);
}
END_TEST

/* The plate goes back to 1 mm in the air within half a second, and the specimen does not follow. */
START_TEST(a_withdrawal_after_the_hold_is_left_out) {
    take t = {two_arms(8.0, 2.4, 3.6, 0.7, 25.0), 5.0, 1.0, 60.0, 1.0, 200.0, 0.004, "ramp_hold", 5};
    palp_experiment *e = record(&t);
    size_t n = palp_experiment_rows(e), away = n - 800;
    double *depth = palp_experiment_column(e, "depth_mm"), *force = palp_experiment_column(e, "force_N");
    uint64_t state = 9;
    for (size_t i = away; i < n; i++) {
        depth[i] = fmax(5.0 - 12.0 * (double)(i - away + 1) / 200.0, -1.0);
        force[i] = 0.004 * palp_random_normal(&state);
    }
    palp_recording r = prepare(e);
    ck_assert_double_eq_tol(r.end_s, 58.0, 0.02);
    for (size_t i = away; i < n; i++)
        ck_assert_uint_eq(r.use[i], 0);
    ck_assert_uint_eq(r.use[away - 20], 1);
    palp_characterize_settings settings = palp_characterize_settings_default();
    settings.n_arms = 2;
    palp_lumped_fit f = fit(1, &r, settings);
    ck_assert_double_eq_tol(f.spring_N[0], 8.0, 0.05);
    ck_assert_double_eq_tol(f.material.arms[0].stiffness_N, 2.4, 0.1);
    palp_lumped_fit_free(&f);
    palp_recording_free(&r);
}
END_TEST

START_TEST(contact_is_that_of_the_first_press) {
    take t = clean();
    t.hold_s = 0.0;
    palp_experiment *once = record(&t), *e;
    size_t n = palp_experiment_rows(once), m = 4 * n;
    ck_assert_int_eq(palp_experiment_create(m, &e), PALP_OK);
    double *time = palp_experiment_column(e, "time_s"), *depth = palp_experiment_column(e, "depth_mm"),
           *force = palp_experiment_column(e, "force_N");
    const double *d = palp_experiment_column(once, "depth_mm"), *f = palp_experiment_column(once, "force_N");
    for (size_t i = 0; i < m; i++) { /* up, down, up deeper in force, down */
        size_t j = (i / n) % 2 ? n - 1 - i % n : i % n;
        time[i] = 1e-3 * (double)i;
        depth[i] = d[j] + 0.1;
        force[i] = f[j] * (i >= 2 * n ? 1.1 : 1.0);
    }
    palp_experiment_set_number(e, "specimen.height_mm", 24.0);
    palp_experiment_set_string(e, "protocol.kind", "cyclic");
    palp_recording r = prepare(e);
    ck_assert_int_eq(r.kind, PALP_RECORDING_OTHER);
    ck_assert_double_eq_tol(1e3 * r.contact_m, 0.1, 0.02);
    ck_assert_double_lt(r.ramp_start_s, 1.1);
    palp_recording_free(&r);
    palp_experiment_free(once);
}
END_TEST

static void refused(palp_experiment *e, const char *line) {
    palp_recording r;
    palp_error error = {PALP_OK, ""};
    palp_recording_settings settings = palp_recording_settings_default();
    ck_assert_int_eq(palp_recording_prepare(e, "run.csv", &settings, &r, &error), PALP_ERR_INPUT);
    ck_assert_msg(strstr(error.text, line) && strncmp(error.text, "run.csv: ", 9) == 0, "%s", error.text);
    ck_assert_ptr_null(r.time_s);
    error.text[0] = '\0';
    ck_assert_int_eq(palp_recording_check(e, "run.csv", 0.0, &error), PALP_ERR_INPUT);
    ck_assert_msg(strstr(error.text, line), "%s", error.text);
    palp_experiment_free(e);
}

/* The clean recording with depth and force times a factor. */
static palp_experiment *times(double depth_factor, double force_factor) {
    take t = clean();
    palp_experiment *e = record(&t);
    double *depth = palp_experiment_column(e, "depth_mm"), *force = palp_experiment_column(e, "force_N");
    for (size_t i = 0; i < palp_experiment_rows(e); i++) {
        depth[i] *= depth_factor;
        force[i] *= force_factor;
    }
    return e;
}

/* A force of +-0.004 N, whose noise is 0.016 / sqrt(6) N, and a step of so many sds above its first sample.
 */
static palp_experiment *a_step_of(double sds) {
    take t = clean();
    palp_experiment *e = record(&t);
    double *depth = palp_experiment_column(e, "depth_mm"), *force = palp_experiment_column(e, "force_N");
    for (size_t i = 0; i < palp_experiment_rows(e); i++)
        force[i] = (i % 2 ? 0.004 : -0.004) + (depth[i] > 2.0 ? sds * 0.016 / sqrt(6.0) - 0.008 : 0.0);
    return e;
}

START_TEST(a_contact_is_six_sds_of_force) {
    refused(a_step_of(5.8), "never exceeds its noise");
    palp_recording r = prepare(a_step_of(6.2));
    palp_recording_free(&r);
}
END_TEST

/* Nearly fluid: the force falls by 99 % in the dwell, after ramps of many samples and of one; and a plate
 * that sticks and is pulled off with more than it pressed with. */
START_TEST(what_follows_the_loading_says_nothing_of_the_sign) {
    static const double ramp_s[] = {12.0, 1.0, 0.05, 0.03};
    for (size_t i = 0; i < 8; i++) {
        take t = {two_arms(0.01, 20.0, 2.0, 10.0, 40.0),
                  4.0,
                  ramp_s[i / 2],
                  100.0,
                  (double)(i % 2),
                  32.0,
                  0.001,
                  "ramp_hold",
                  5};
        palp_recording r = prepare(record(&t));
        ck_assert_int_eq(r.kind, PALP_RECORDING_RAMP_HOLD);
        palp_recording_free(&r);
    }
    palp_experiment *e = times(1.0, 1.0);
    double *depth = palp_experiment_column(e, "depth_mm"), *force = palp_experiment_column(e, "force_N");
    const size_t n = palp_experiment_rows(e), back = n - n / 4;
    for (size_t i = back; i < n; i++) {
        const double share = (double)(i - back) / (double)(n - back);
        depth[i] = 4.0 - 5.0 * share;
        force[i] = 1.5 * (1.0 - 4.0 * share);
    }
    palp_recording r = prepare(e);
    palp_recording_free(&r);
}
END_TEST

START_TEST(what_cannot_be_used_is_refused_in_one_line) {
    refused(times(-1.0, 1.0), "depth or force has the wrong sign");
    refused(times(1.0, -1.0), "depth or force has the wrong sign");
    refused(times(-1.0, -1.0), "both have the wrong sign");
    refused(times(0.0, 1.0), "never changes");
    palp_experiment *e = times(1.0, 1.0);
    double *force = palp_experiment_column(e, "force_N");
    for (size_t i = 0; i < palp_experiment_rows(e); i++)
        force[i] = i % 2 ? 0.004 : -0.004;
    refused(e, "never exceeds its noise");
    refused(times(1.0, 0.0), "never exceeds its noise");
    e = times(1.0, 1.0);
    palp_experiment_set_number(e, "specimen.height_mm", 3.0);
    refused(e, "exceeds the specimen's height");
    e = times(1.0, 1.0);
    palp_experiment_column(e, "force_N")[50] = (double)NAN;
    refused(e, "not finite");
    e = times(1.0, 1.0);
    palp_experiment_column(e, "force_N")[50] = 1e300;
    refused(e, "beyond 1e12");
    e = times(1.0, 1.0);
    palp_experiment_column(e, "time_s")[50] = 0.049;
    refused(e, "does not increase");
    ck_assert_int_eq(palp_experiment_create(40, &e), PALP_OK);
    refused(e, "has no specimen.height_mm");
    ck_assert_int_eq(palp_experiment_create(15, &e), PALP_OK);
    palp_experiment_set_number(e, "specimen.height_mm", 24.0);
    refused(e, "has 15 samples, but at least 16 are needed");
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, a_clean_recording_has_no_findings);
    tcase_add_test(tc, a_recording_without_noise_has_no_findings);
    tcase_add_test(tc, contact_is_found_where_the_nominal_one_is_off);
    tcase_add_test(tc, a_force_that_bends_from_the_start_moves_no_contact);
    tcase_add_test(tc, without_air_the_record_is_trusted_and_doubted);
    tcase_add_test(tc, rest_on_the_specimen_is_zero_force_but_rest_within_it_is_not);
    tcase_add_test(tc, a_given_contact_is_taken);
    tcase_add_test(tc, hum_a_spike_and_a_lost_second_are_found);
    tcase_add_test(tc, a_spike_in_the_air_moves_no_zero);
    tcase_add_test(tc, drift_in_the_air_widens_the_zero);
    tcase_add_test(tc, a_clipped_top_is_masked);
    tcase_add_test(tc, counts_of_a_coarse_converter_are_no_findings);
    tcase_add_test(tc, uneven_times_and_a_fault_are_told);
    tcase_add_test(tc, a_withdrawal_after_the_hold_is_left_out);
    tcase_add_test(tc, contact_is_that_of_the_first_press);
    tcase_add_test(tc, a_contact_is_six_sds_of_force);
    tcase_add_test(tc, what_follows_the_loading_says_nothing_of_the_sign);
    tcase_add_test(tc, what_cannot_be_used_is_refused_in_one_line);
}
