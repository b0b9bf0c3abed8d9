/* test_recording_contact.c: contact, zero force, clipping and the noise's lines of recordings made by
 * formula, against formulas. */
#include "data/recording_internal.h"

#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 20000 };
static const double STEP_M = 1e-5, SLOPE_N_M = 100.0; /* so a force of 1e-3 N a sample */

typedef struct made {
    double time[MOST], depth[MOST], force[MOST];
    unsigned char use[MOST];
    palp_recording r;
} made;

static made *make(size_t n) {
    made *m = calloc(1, sizeof *m);
    ck_assert_ptr_nonnull(m);
    m->r = (palp_recording){.n = n,
                            .time_s = m->time,
                            .depth_m = m->depth,
                            .force_N = m->force,
                            .use = m->use,
                            .height_m = 0.024,
                            .noise_N = 1e-4};
    for (size_t i = 0; i < n; i++) {
        m->time[i] = 1e-3 * (double)i;
        m->use[i] = 1;
    }
    return m;
}

/* From -air samples above 0 to 2.05 mm: a thousandth, 3 and 6 percent of that are 0.2, 6.15 and 12.3 samples.
 */
static made *press(size_t air, double zero_N) {
    made *m = make(air + 206);
    for (size_t i = 0; i < m->r.n; i++) {
        m->depth[i] = STEP_M * ((double)i - (double)air);
        m->force[i] = zero_N;
    }
    return m;
}

/* Where a line through n points crosses zero, and the sd of that. */
static double crossing(size_t n, const double *x, const double *y, double zero, double noise, double zero_sd,
                       double *sd) {
    double s = (double)n, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (size_t i = 0; i < n; i++) {
        sx += x[i];
        sy += y[i] - zero;
        sxx += x[i] * x[i];
        sxy += x[i] * (y[i] - zero);
    }
    double slope = (s * sxy - sx * sy) / (s * sxx - sx * sx), level = (sy - slope * sx) / s;
    double at = -level / slope; /* variance of the line there: s^2 (sxx - 2 at sx + n at^2) / det */
    double variance = noise * noise * (sxx - 2 * at * sx + s * at * at) / (s * sxx - sx * sx);
    *sd = sqrt(variance + zero_sd * zero_sd) / fabs(slope);
    return at;
}

/* The specimen begins at sample `touch`, whose depth is not 0. The window's sum passes 12 sds, 1.2e-3 N, with
 * the second sample of the rise: from there on it is extrapolated. */
static void contact_at(size_t touch, double beyond_m) {
    const palp_recording_settings settings = palp_recording_settings_default();
    made *m = press(100, 0.3);
    palp_recording *r = &m->r;
    for (size_t i = 0; i < r->n; i++)
        m->depth[i] += beyond_m;
    for (size_t i = touch; i < r->n; i++)
        m->force[i] += SLOPE_N_M * (m->depth[i] - m->depth[touch]);
    recording_find_contact(r, &settings);
    size_t quiet = 101, left = touch + 2, air = left < quiet ? left : quiet;
    double zero = 0.3 + (air > touch + 1 ? 1e-3 / (double)air : 0.0), sd, white = 1e-4 / sqrt((double)air);
    ck_assert_int_eq(r->contact_rule, PALP_CONTACT_FREE_AIR);
    ck_assert_double_eq_tol(r->zero_N, zero, 1e-12);
    if (air == quiet)
        ck_assert_double_eq_tol(r->zero_sd_N, white, 1e-12);
    double at = crossing(7, m->depth + left, m->force + left, r->zero_N, 1e-4, r->zero_sd_N, &sd);
    ck_assert_double_eq_tol(r->contact_sd_m, sd, 1e-6 * sd);
    ck_assert_double_eq_tol(r->contact_m, fabs(at) > 3.0 * sd ? at : 0.0, 1e-12);
    free(m);
}

START_TEST(contact_is_the_crossing_of_the_first_of_the_rise) {
    contact_at(104, 0.0);
    contact_at(110, 0.0);
    contact_at(120, 0.0);
    contact_at(110,
               2e-6); /* less than a thousandth of the way from the start, 3.05 mm: not yet past contact */
}
END_TEST

/* Contact is searched up to half of the largest force. A force that returns to zero at 0.4 of it had no
 * contact; at 0.6 the plate separates for a while. */
START_TEST(contact_comes_before_half_the_force) {
    for (int later = 0; later < 2; later++) {
        const palp_recording_settings settings = palp_recording_settings_default();
        const size_t touch = 110, gone = 150, back = 180;
        made *m = press(100, 0.05);
        for (size_t i = touch; i < gone; i++)
            m->force[i] += SLOPE_N_M * (m->depth[i] - m->depth[touch]);
        double top = (m->force[gone - 1] - 0.05) / (later ? 0.4 : 0.6);
        for (size_t i = back; i < m->r.n; i++)
            m->force[i] += top * (double)(i - back) / (double)(m->r.n - 1 - back);
        recording_find_contact(&m->r, &settings);
        ck_assert_double_eq_tol(m->r.contact_m, m->depth[later ? back : touch], 1e-7);
        free(m);
    }
}
END_TEST

/* Off by 2.5 or by 3.5 of its own sds. */
START_TEST(contact_moves_from_three_sds_on) {
    for (int over = 0; over < 2; over++) {
        const palp_recording_settings settings = palp_recording_settings_default();
        made *m = press(400, 0.0);
        for (size_t i = 410; i < m->r.n; i++)
            m->force[i] = SLOPE_N_M * (m->depth[i] - m->depth[410]);
        m->r.noise_N = 2e-4;
        recording_find_contact(&m->r, &settings);
        double sd = m->r.contact_sd_m, off = over ? 3.5 : 2.5;
        double touch = m->depth[410];
        for (size_t i = 0; i < m->r.n; i++)
            m->depth[i] += off * sd - touch; /* the same press about another zero */
        m->r.contact_sd_m = m->r.contact_m = 0.0;
        recording_find_contact(&m->r, &settings);
        ck_assert_double_eq_tol(m->r.contact_sd_m, sd, 0.15 * sd); /* the samples lie otherwise */
        ck_assert_double_eq_tol(m->r.contact_m, over ? off * sd : 0.0, 1e-9);
        free(m);
    }
}
END_TEST

/* F = c (x - 0)^2: the lines through 3 % and 6 % lead to different places, which counts three times. */
START_TEST(a_bend_counts_three_times) {
    const palp_recording_settings settings = palp_recording_settings_default();
    made *m = press(100, 0.0);
    palp_recording *r = &m->r;
    for (size_t i = 100; i < r->n; i++)
        m->force[i] = 2e6 * m->depth[i] * m->depth[i];
    recording_find_contact(r, &settings);
    double near_sd, far_sd, sum = 0.0;
    size_t first = 100;
    for (size_t i = 92; sum <= 1.2e-3; first = ++i) { /* of nine samples */
        sum = 0.0;
        for (size_t k = i - 8; k <= i; k++)
            sum += m->force[k] - r->zero_N;
    }
    first--;
    double near = crossing(7, m->depth + first, m->force + first, r->zero_N, 1e-4, r->zero_sd_N, &near_sd);
    double far = crossing(13, m->depth + first, m->force + first, r->zero_N, 1e-4, r->zero_sd_N, &far_sd);
    ck_assert_double_gt(fabs(near - far), near_sd);
    double sd = hypot(near_sd, 3.0 * (fabs(near - far) - near_sd));
    ck_assert_double_eq_tol(r->contact_sd_m, sd, 1e-6 * sd);
    ck_assert_double_eq(r->contact_m, 0.0);
    free(m);
}
END_TEST

START_TEST(a_nominal_contact_is_doubted_by_what_the_rise_says) {
    const palp_recording_settings settings = palp_recording_settings_default();
    made *m = press(0, 0.0);
    for (size_t i = 0; i < m->r.n; i++)
        m->force[i] = SLOPE_N_M * (m->depth[i] + 3e-5);
    recording_find_contact(&m->r, &settings);
    double sd,
        at = crossing(7, m->depth + 1, m->force + 1, 0.0, 1e-4, 0.0, &sd); /* from the first that moved */
    ck_assert_int_eq(m->r.contact_rule, PALP_CONTACT_NOMINAL);
    ck_assert_double_eq_tol(at, -3e-5, 1e-12);
    ck_assert_double_eq_tol(m->r.contact_sd_m, hypot(sd, at), 1e-11);
    ck_assert_double_eq(m->r.contact_m, 0.0);
    ck_assert_double_eq(m->r.zero_N, 0.0);
    m->r.contact_sd_m = 1e-6; /* said by the file */
    recording_find_contact(&m->r, &settings);
    ck_assert_double_eq(m->r.contact_sd_m, 1e-6);
    free(m);
}
END_TEST

/* Ten parts of ten samples, each at a level of its own: the sd of their mean, unless white noise says more.
 */
START_TEST(zero_force_that_is_not_white) {
    const palp_recording_settings settings = palp_recording_settings_default();
    for (int big = 0; big < 2; big++) {
        double level = big ? 1.8e-5 : 1.2e-5; /* against 1.6 times the white sd of 1e-5 */
        made *m = make(400);
        for (size_t i = 0; i < m->r.n; i++) {
            m->depth[i] = i < 100 ? 0.0 : STEP_M * (double)(i - 99);
            m->force[i] =
                0.5 + (i < 100 ? 3.0 * level * ((i / 10) % 2 ? 1.0 : -1.0) : 0.1 * (double)(i - 99));
        }
        recording_find_contact(&m->r, &settings);
        double parts = 3.0 * level * sqrt(10.0 / 9.0 / 10.0);
        ck_assert_double_eq_tol(m->r.zero_N, 0.5, 1e-12);
        ck_assert_double_eq_tol(m->r.zero_sd_N, big ? parts : 1e-5, 1e-12);
        ck_assert_int_eq(m->r.contact_rule, PALP_CONTACT_NOMINAL);
        free(m);
    }
}
END_TEST

/* Ten samples of rest on the specimen are enough, nine are not. */
START_TEST(a_short_rest_is_zero_force) {
    const palp_recording_settings settings = palp_recording_settings_default();
    for (size_t rest = 9; rest < 11; rest++) {
        made *m = make(400);
        for (size_t i = 0; i < m->r.n; i++) {
            m->depth[i] = i < rest ? 0.0 : STEP_M * (double)(i - rest + 1);
            m->force[i] = 0.5 + SLOPE_N_M * m->depth[i];
        }
        recording_find_contact(&m->r, &settings);
        ck_assert_double_eq_tol(m->r.zero_N, rest == 10 ? 0.5 : 0.0, 1e-12);
        ck_assert_double_eq_tol(m->r.zero_sd_N, rest == 10 ? 1e-4 / sqrt(10.0) : 0.0, 1e-15);
        free(m);
    }
}
END_TEST

/* ---- clipping ---- */

static size_t clipped(size_t flat, double share, double moves) {
    made *m = make(1000);
    for (size_t i = 0; i < 1000; i++) {
        double t = i < 500 ? (double)i : i < 500 + flat ? 500.0 : (double)(i - flat);
        m->force[i] = i < 500 + flat ? fmin(t, 500.0) : 500.0 - 0.25 - 0.5 * (t - 500.0);
        m->depth[i] = 1e-6 * (i < 500 ? (double)i : 500.0 + moves * (double)(i - 500));
    }
    recording_mask_clipped(&m->r, share);
    size_t count = 0;
    for (size_t i = 0; i < 1000; i++)
        count += !m->use[i];
    ck_assert_uint_eq(count, m->r.n_clipped);
    ck_assert_uint_eq(count, count ? flat : 0);
    for (size_t i = 500; count && i < 500 + flat; i++)
        ck_assert_uint_eq(m->use[i], 0);
    free(m);
    return count;
}

START_TEST(clipping_is_a_flat_top_while_the_plate_moves) {
    ck_assert_uint_eq(clipped(20, 0.002, 1.0), 20);
    ck_assert_uint_eq(clipped(5, 0.002, 1.0), 5);
    ck_assert_uint_eq(clipped(4, 0.002, 1.0), 0);
    ck_assert_uint_eq(clipped(20, 0.020, 1.0), 20);
    ck_assert_uint_eq(clipped(19, 0.020, 1.0), 0);
    ck_assert_uint_eq(clipped(20, 0.002, 0.0), 0);  /* a hold of an elastic specimen */
    ck_assert_uint_eq(clipped(20, 0.002, 0.02), 0); /* 0.4 of the converter's steps */
}
END_TEST

/* A converter of ten steps over the rise. The force stays at its largest value for a third of the travel, in
 * which it should rise by three steps. */
START_TEST(a_coarse_converter_is_not_clipping) {
    for (size_t flat = 290; flat <= 320; flat += 30) {
        made *m = make(1001);
        for (size_t i = 0; i < m->r.n; i++) {
            m->depth[i] = 1e-6 * (double)i;
            m->force[i] = i < 500 ? floor((double)i / 50.0) : i <= 500 + flat ? 10.0 : 9.0;
        }
        recording_mask_clipped(&m->r, 0.002);
        ck_assert_uint_eq(m->r.n_clipped, flat > 300 ? flat + 1 : 0);
        free(m);
    }
}
END_TEST

/* ---- residual force in the dwell at the end ---- */

static palp_recording tail(double (*noise)(size_t i)) {
    made *m = make(MOST);
    for (size_t i = 0; i < m->r.n; i++) {
        m->depth[i] = 1e-3 * fmin((double)i / 1000.0, 1.0);
        m->force[i] = 1.0 + noise(i);
    }
    m->r.deepest_m = 1e-3;
    ck_assert_int_eq(recording_look_at_noise(&m->r, 1e-3), PALP_OK);
    palp_recording r = m->r;
    free(m);
    return r;
}
static double alternating(size_t i) {
    return i % 2 ? 1e-3 : -1e-3;
}
static double pairs(size_t i) {
    return i % 4 < 2 ? 1e-3 : -1e-3;
}
static double blocks(size_t i) {
    return i % 8 < 4 ? 1e-3 : -1e-3;
}
static double hum_Hz;
static double hum(size_t i) {
    return 2e-3 * cos(2.0 * 3.14159265358979 * hum_Hz * 1e-3 * (double)i + 0.7);
}

START_TEST(correlation_from_sample_to_sample) {
    ck_assert_double_eq_tol(tail(alternating).correlation, -1.0, 2e-3);
    ck_assert_double_eq_tol(tail(pairs).correlation, 0.0, 2e-3);
    ck_assert_double_eq_tol(tail(blocks).correlation, 0.5, 2e-3);
    ck_assert_double_eq(tail(alternating).hum_N, 0.0);
}
END_TEST

/* A plate that moves to the end leaves no still stretch to tell it from: a thousandth of the way is motion.
 */
START_TEST(correlation_is_of_a_still_end) {
    for (int still = 0; still < 2; still++) {
        made *m = make(2000);
        for (size_t i = 0; i < m->r.n; i++) {
            m->depth[i] = 1e-3 + (still ? 0.9e-6 : 1.1e-6) * (double)(i % 2) - (i < 1000 ? 1e-4 : 0.0);
            m->force[i] = 1.0 + alternating(i);
        }
        m->r.deepest_m = 1e-3;
        ck_assert_int_eq(recording_look_at_noise(&m->r, 1e-3), PALP_OK);
        ck_assert_double_eq_tol(m->r.correlation, still ? -1.0 : 0.0, 0.02);
        free(m);
    }
}
END_TEST

START_TEST(hum_has_its_amplitude_and_frequency) {
    for (hum_Hz = 52.3; hum_Hz < 52.36; hum_Hz += 0.01) { /* a line's width is 0.12 Hz */
        palp_recording r = tail(hum);
        ck_assert_double_eq_tol(r.hum_N, 2e-3, 1e-5);
        ck_assert_double_eq_tol(r.hum_Hz, hum_Hz, 0.004);
    }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, contact_is_the_crossing_of_the_first_of_the_rise);
    tcase_add_test(tc, contact_comes_before_half_the_force);
    tcase_add_test(tc, contact_moves_from_three_sds_on);
    tcase_add_test(tc, a_bend_counts_three_times);
    tcase_add_test(tc, a_nominal_contact_is_doubted_by_what_the_rise_says);
    tcase_add_test(tc, zero_force_that_is_not_white);
    tcase_add_test(tc, a_short_rest_is_zero_force);
    tcase_add_test(tc, clipping_is_a_flat_top_while_the_plate_moves);
    tcase_add_test(tc, a_coarse_converter_is_not_clipping);
    tcase_add_test(tc, correlation_from_sample_to_sample);
    tcase_add_test(tc, correlation_is_of_a_still_end);
    tcase_add_test(tc, hum_has_its_amplitude_and_frequency);
}
