/* test_fit_creep.c: a force that is held while the depth goes on: found, blocked and fitted, against the
 * closed form of creep. */
#include "recordings.h"

static const double SPRING = 8.5, HELD = 1.0, NOISE = 0.002, TOUCH = 1.0, REACHED = 1.001;

/* Air to 1 s, then the force at once, held to 61 s. The depth wavers, too, as that of a plate does that
 * answers its force sensor. */
static palp_recording creep(size_t n_arms, double waver_mm) {
    const palp_generalized_maxwell model = {
        .spring_Pa = SPRING, .n_arms = n_arms, .arms = {{2.5847711, 3.6146}, {0.6853036, 23.964533}}};
    palp_retardation spectrum;
    palp_experiment *e;
    enum { N = 61001 };
    uint64_t state = 5;
    double answer = 0.0;
    ck_assert_int_eq(palp_retardation_spectrum(&model, &spectrum),
                     PALP_OK); /* newtons in place of pascals: strain by force */
    ck_assert_int_eq(palp_experiment_create(N, &e), PALP_OK);
    double *t = palp_experiment_column(e, "time_s"), *d = palp_experiment_column(e, "depth_mm"),
           *f = palp_experiment_column(e, "force_N");
    for (size_t i = 0; i < N; i++) {
        bool held = i > 1000;
        t[i] = 1e-3 * (double)i;
        answer = 0.9 * answer + 0.4 * palp_random_normal(&state);
        d[i] = held ? 24.0 * palp_generalized_maxwell_creep(&spectrum, HELD, t[i] - TOUCH - 5e-4) +
                          waver_mm * answer
                    : t[i] - TOUCH;
        f[i] = (held ? HELD : 0.0) + NOISE * palp_random_normal(&state);
    }
    palp_experiment_set_number(e, "specimen.height_mm", 24.0);
    return prepare(e);
}

START_TEST(a_held_force_is_creep) {
    palp_recording r = creep(2, 0.0);
    ck_assert_int_eq(r.kind, PALP_RECORDING_CREEP);
    ck_assert_uint_eq(r.creep.n, 1);
    ck_assert_double_eq_tol(r.time_s[r.creep.piece[0].first], REACHED, 0.002);
    ck_assert_double_eq_tol(r.time_s[r.creep.piece[0].last], 61.0, 0.01);
    unsigned char *phase = malloc(r.n);
    ck_assert_int_eq(palp_segments_phases(r.n, r.time_s, r.depth_m, r.force_N, phase), PALP_OK);
    ck_assert_int_eq(phase[30000], PALP_PHASE_LATE_DWELL);
    ck_assert_int_eq(palp_segments_phases(r.n, r.time_s, r.depth_m, NULL, phase), PALP_OK);
    free(phase);
    palp_recording_free(&r);
}
END_TEST

/* By its path alone a ramp and a dwell: with one arm the depth comes to rest soon. */
START_TEST(creep_that_comes_to_rest_is_creep) {
    palp_recording r = creep(1, 0.0);
    palp_pieces pieces;
    ck_assert_int_eq(palp_segments_pieces(r.n, r.time_s, r.depth_m, &pieces), PALP_OK);
    ck_assert_int_eq(palp_recording_kind_of(&pieces), PALP_RECORDING_RAMP_HOLD);
    ck_assert_int_eq(r.kind, PALP_RECORDING_CREEP);
    ck_assert_double_eq_tol(r.ramp_end_s, REACHED, 0.002);
    palp_pieces_free(&pieces);
    palp_recording_free(&r);
}
END_TEST

/* A dwell in which the force relaxes, until it stands still to the eye, is none; nor is a press that never
 * stands still. */
START_TEST(a_dwell_is_no_creep) {
    take t = {two_arms(SPRING, 2.5847711, 3.6146, 0.6853036, 23.964533),
              3.0,
              1.0,
              200.0,
              1.0,
              100.0,
              NOISE,
              "ramp_hold",
              3};
    palp_recording r = prepare(record(&t));
    ck_assert_int_eq(r.kind, PALP_RECORDING_RAMP_HOLD);
    ck_assert_uint_eq(r.creep.n, 0);
    palp_recording_free(&r);
    for (double most = 0.3; most < 1.5; most += 0.3) { /* its sensor ends on the ramp */
        palp_experiment *cut = record(&t);
        for (size_t i = 0; i < palp_experiment_rows(cut); i++)
            palp_experiment_column(cut, "force_N")[i] = fmin(palp_experiment_column(cut, "force_N")[i], most);
        r = prepare(cut);
        ck_assert_int_eq(r.kind, PALP_RECORDING_RAMP_HOLD);
        palp_recording_free(&r);
    }
    t = (take){two_arms(SPRING, 1e-3, 1e-3, 1e-3, 1e-2), 3.0, 30.0, 0.0, 1.0, 100.0, NOISE, "static", 3};
    r = prepare(record(&t));
    ck_assert_int_eq(r.kind, PALP_RECORDING_STATIC);
    ck_assert_uint_eq(r.creep.n, 0);
    palp_recording_free(&r);
    palp_experiment *e = record(&t); /* its sensor ends at 0.6 N of 1.06 N */
    for (size_t i = 0; i < palp_experiment_rows(e); i++)
        palp_experiment_column(e, "force_N")[i] = fmin(palp_experiment_column(e, "force_N")[i], 0.6);
    r = prepare(e);
    ck_assert_int_eq(r.kind, PALP_RECORDING_STATIC);
    palp_recording_free(&r);
}
END_TEST

/* The arms of the closed form, with a plate that wavers by twice the noise of the depth, or stands still. */
START_TEST(creep_tells_the_arms) {
    static const double wavers[] = {0.0, 0.004}, truth[] = {SPRING, 2.5847711, 3.6146, 0.6853036, 23.964533};
    static const size_t which[] = {0, 1, 2, 4, 5};
    const double one = 1.0;
    palp_characterize_settings s = palp_characterize_settings_default();
    s.spring = PALP_SPRING_LAW;
    s.n_arms = 2;
    ck_assert_int_eq(palp_law_polynomial(1, &one, &s.law), PALP_OK);
    palp_recording r = creep(2, wavers[_i]);
    palp_lumped_fit f;
    ck_assert_int_eq(palp_characterize_fit(1, &r, &s, &f, NULL), PALP_OK);
    ck_assert_uint_eq(f.material.n_arms, 2);
    for (size_t k = 0; k < 5; k++) {
        const palp_estimate *e = &f.estimate[which[k]];
        ck_assert_msg(fabs(e->value / truth[k] - 1.0) < 0.02 && e->high / e->low < 1.1, "%s: %g of %g",
                      e->name, e->value, truth[k]);
    }
    palp_lumped_fit_free(&f);
    palp_recording_free(&r);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, a_held_force_is_creep);
    tcase_add_test(tc, creep_that_comes_to_rest_is_creep);
    tcase_add_test(tc, a_dwell_is_no_creep);
    tcase_add_loop_test(tc, creep_tells_the_arms, 0, 2);
}
