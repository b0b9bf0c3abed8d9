/* test_fit_encoder.c: a plate in a dwell wanders within a count of its encoder, which the depth does not
 * show: intervals cover the truth all the same. A path of equal steps that no encoder has made has no
 * counts. */
#include "recordings.h"

enum { SESSIONS = 40, ESTIMATES = 6 };

static const double COUNT_MM = 0.001, RAMP_S = 1.0137; /* 11.8 counts a sample */

/* Ramp and hold of 40 s. The plate's place within a count goes to and fro evenly, with a period and a start
 * of the session's own. */
static palp_recording session(uint64_t seed, bool counted) {
    const double rate_Hz = 250.0, pi = 3.14159265358979323846;
    const size_t air = 250, n = air + 1 + (size_t)(41.0 * rate_Hz);
    palp_material m = two_arms(8.0, 2.6, 3.6, 0.7, 14.0);
    palp_element_state s = {0};
    palp_experiment *e;
    uint64_t state = 900 + seed;
    double period = 4.0 * pow(20.0, palp_random_uniform(&state)),
           phase = 2.0 * pi * palp_random_uniform(&state);
    ck_assert_int_eq(palp_experiment_create(n, &e), PALP_OK);
    double *time = palp_experiment_column(e, "time_s"), *depth = palp_experiment_column(e, "depth_mm"),
           *force = palp_experiment_column(e, "force_N");
    for (size_t i = 0; i < n; i++) {
        time[i] = (double)i / rate_Hz;
        double t = time[i] - (double)air / rate_Hz, way = 3.0 * fmin(t / RAMP_S, 1.0),
               wander = t < RAMP_S ? 0.0 : 2.0 / pi * asin(sin(2.0 * pi * t / period + phase));
        double place = counted ? way + COUNT_MM * (0.5 + 0.49 * wander) : way;
        depth[i] = counted ? COUNT_MM * floor(place / COUNT_MM + 1e-6) : way;
        ck_assert_int_eq(
            palp_element_advance(&m, &s, fmax(place, 0.0) / 24.0, i ? 1.0 / rate_Hz : 0.0, &s, NULL),
            PALP_OK);
        force[i] = s.force_N + 0.001 * palp_random_normal(&state);
    }
    palp_experiment_set_number(e, "specimen.height_mm", 24.0);
    return prepare(e);
}

static palp_lumped_fit fit_session(uint64_t seed, bool counted) {
    const double one = 1.0;
    palp_recording r = session(seed, counted);
    palp_lumped_fit f = fit(1, &r, with_law(polynomial(1, &one), 2));
    ck_assert_uint_eq(f.n_estimates, 1 + ESTIMATES);
    palp_recording_free(&r);
    return f;
}

START_TEST(intervals_cover_what_the_encoder_does_not_tell) {
    static const double truth[ESTIMATES] = {2.6, 3.6, 3.6 / 2.6, 0.7, 14.0, 20.0};
    size_t covered[ESTIMATES] = {0};
    for (uint64_t k = 0; k < SESSIONS; k++) {
        palp_lumped_fit f = fit_session(k, true);
        for (size_t i = 0; i < ESTIMATES; i++)
            covered[i] += f.estimate[1 + i].low <= truth[i] && truth[i] <= f.estimate[1 + i].high;
        palp_lumped_fit_free(&f);
    }
    for (size_t i = 0; i < ESTIMATES; i++)
        ck_assert_msg(covered[i] >= SESSIONS * 85 / 100, "estimate %zu: %zu of %d", i, covered[i], SESSIONS);
}
END_TEST

START_TEST(equal_steps_are_no_counts) {
    palp_lumped_fit f = fit_session(1, false), g = fit_session(1, true);
    for (size_t i = 0; i < ESTIMATES; i++)
        ck_assert_double_lt(f.estimate[1 + i].sd, g.estimate[1 + i].sd);
    ck_assert_double_lt(f.estimate[5].sd, 0.01 * f.estimate[5].value);
    palp_lumped_fit_free(&f);
    palp_lumped_fit_free(&g);
}
END_TEST

void tests(TCase *tc) {
    tcase_set_timeout(tc, 120);
    tcase_add_test(tc, intervals_cover_what_the_encoder_does_not_tell);
    tcase_add_test(tc, equal_steps_are_no_counts);
}
