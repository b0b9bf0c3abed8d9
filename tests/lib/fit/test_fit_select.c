/* test_fit_select.c: the number of arms and the degree by error on data that were held out. */
#include "recordings.h"

static palp_material arms(size_t n) {
    palp_material m = {.n_arms = n, .arms = {{1.2, 20.0, 0, 0}, {1.5, 2.0, 0, 0}, {1.0, 0.2, 0, 0}}};
    m.law = polynomial(1, (double[1]){9.0});
    return m;
}

static size_t selected(size_t n, const palp_recording *r, palp_characterize_settings s, size_t max_arms,
                       double *score) {
    size_t best = 99;
    double sd[PALP_ARMS_MAX + 1];
    palp_error error = {PALP_OK, ""};
    palp_status status = palp_characterize_select_arms(n, r, &s, max_arms, score, sd, &best, &error);
    ck_assert_msg(status == PALP_OK, "%s", error.text);
    for (size_t c = 0; c <= max_arms; c++)
        ck_assert(isfinite(score[c]) && isfinite(sd[c]) && sd[c] >= 0.0);
    return best;
}

START_TEST(as_many_arms_as_there_are) {
    for (uint64_t seed = 1; seed <= 4; seed++)
        for (size_t n = 0; n <= 3; n++) {
            take t = {arms(n), 4.0, 0.5, 100.0, 1.0, 200.0, 0.002, "ramp_hold", 10 * seed + n};
            palp_recording r = prepare(record(&t));
            double score[5];
            ck_assert_uint_eq(selected(1, &r, with_arms(0), 4, score), n);
            ck_assert_double_eq_tol(score[n], 1.0, 0.25); /* held-out error down to the noise */
            for (size_t c = 0; c < n; c++)
                ck_assert_double_gt(score[c], 1.3 * score[n]);
            palp_recording_free(&r);
        }
}
END_TEST

/* Runs with a spring each, and three runs of one law, where a whole run is left out. */
START_TEST(arms_of_several_runs) {
    palp_recording r[3];
    for (size_t q = 0; q < 3; q++) {
        take t = {phantom(), 3.0 + 1.5 * (double)q, 1.0, 150.0, 1.0, 100.0, 0.004, "ramp_hold", 3 + q};
        r[q] = prepare(record(&t));
    }
    palp_characterize_settings s = with_arms(0);
    s.dwell_only = true;
    double score[4];
    ck_assert_uint_eq(selected(3, r, s, 3, score), 2);
    s = with_law(polynomial(3, (double[3]){1.0}), 0);
    ck_assert_uint_eq(selected(3, r, s, 3, score), 2);
    free_all(3, r);
}
END_TEST

static palp_recording static_run(palp_law law, double depth_mm, uint64_t seed) {
    palp_material m = {.law = law};
    take t = {m, depth_mm, 40.0, 0.0, 1.0, 50.0, 0.004, "static", seed};
    return prepare(record(&t));
}

START_TEST(degree_of_a_polynomial) {
    static const double c[4][4] = {{9.0}, {8.0, 6.0}, {8.0, -6.0, 60.0}, {8.0, 3.0, -60.0, 400.0}};
    for (uint64_t seed = 1; seed <= 4; seed++)
        for (size_t degree = 0; degree < 4; degree++) {
            palp_recording r = static_run(polynomial(degree + 1, c[degree]), 9.0, seed);
            palp_characterize_settings s = with_law(polynomial(1, c[0]), 0);
            double score[6], sd[6];
            size_t best = 99;
            ck_assert_int_eq(palp_characterize_select_degree(1, &r, &s, 5, score, sd, &best, NULL), PALP_OK);
            ck_assert_uint_eq(best, degree);
            ck_assert_double_eq_tol(score[best], 1.0, 0.35);
            palp_recording_free(&r);
        }
}
END_TEST

START_TEST(degree_with_a_run_left_out) {
    palp_recording r[3];
    for (uint64_t q = 0; q < 3; q++)
        r[q] = static_run(polynomial(3, (double[3]){8.0, -6.0, 60.0}), 9.0 - 0.5 * (double)q, 30 + q);
    palp_characterize_settings s = with_law(polynomial(1, (double[1]){1.0}), 0);
    double score[6], sd[6];
    size_t best = 99;
    ck_assert_int_eq(palp_characterize_select_degree(3, r, &s, 5, score, sd, &best, NULL), PALP_OK);
    ck_assert_uint_eq(best, 2);
    free_all(3, r);
}
END_TEST

START_TEST(bad_requests_are_refused) {
    palp_recording r = static_run(polynomial(1, (double[1]){9.0}), 5.0, 1);
    palp_characterize_settings s = with_arms(0);
    palp_error error = {PALP_OK, ""};
    double score[PALP_LAW_MAX + 1], sd[PALP_LAW_MAX + 1];
    size_t best;
    ck_assert_int_eq(palp_characterize_select_arms(1, &r, &s, PALP_ARMS_MAX + 1, score, sd, &best, &error),
                     PALP_ERR_LIMIT);
    ck_assert_int_eq(palp_characterize_select_degree(1, &r, &s, 3, score, sd, &best, &error),
                     PALP_ERR_ARGUMENT);
    s.spring = PALP_SPRING_LAW;
    ck_assert_int_eq(palp_characterize_select_degree(1, &r, &s, PALP_LAW_MAX, score, sd, &best, &error),
                     PALP_ERR_LIMIT);
    ck_assert_int_eq(palp_characterize_select_degree(0, &r, &s, 3, score, sd, &best, &error),
                     PALP_ERR_ARGUMENT);
    palp_recording_free(&r);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, as_many_arms_as_there_are);
    tcase_add_test(tc, arms_of_several_runs);
    tcase_add_test(tc, degree_of_a_polynomial);
    tcase_add_test(tc, degree_with_a_run_left_out);
    tcase_add_test(tc, bad_requests_are_refused);
}
