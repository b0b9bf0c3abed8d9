/* test_segments_pieces.c: what the plate did by its path alone: at any scale, in noise, with samples missing.
 */
#include <palpate/random.h>
#include <palpate/segments.h>

#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

enum { MOST = 20000 };

/* A path in corners, mm and s, or one that oscillates; sampled at so many a second. */
typedef struct course {
    const char *pieces; /* "rest ramp dwell" */
    double corner[12][2];
    size_t n_corners;
    double amplitude, first_Hz, last_Hz, wave_s; /* after the last corner, about it */
} course;

static const course courses[] = {
    {"rest ramp dwell", {{0, 0}, {1, 0}, {2, 5}, {30, 5}}, 4, 0, 0, 0, 0},
    {"rest ramp dwell", {{0, 0}, {1, 0}, {11, 5}, {15, 5}}, 4, 0, 0, 0, 0}, /* the dwell is shorter than its
                                                                               ramp */
    {"ramp dwell", {{0, 0}, {10, 5}, {12.5, 5}}, 3, 0, 0, 0, 0},
    {"ramp", {{0, 0}, {10, 5}}, 2, 0, 0, 0, 0},
    {"approach ramp", {{0, -2}, {14, 5}}, 2, 0, 0, 0, 0},
    {"rest approach ramp dwell unload rest",
     {{0, -1}, {1, -1}, {2.2, 5}, {40, 5}, {41.2, -1}, {42, -1}},
     6,
     0,
     0,
     0,
     0},
    {"ramp dwell ramp dwell ramp dwell",
     {{0, 0}, {1, 1}, {20, 1}, {21, 2}, {40, 2}, {41, 3}, {60, 3}},
     7,
     0,
     0,
     0,
     0},
    {"ramp dwell unload dwell unload", {{0, 0}, {2, 4}, {20, 4}, {21, 2}, {30, 2}, {31, 0}}, 6, 0, 0, 0, 0},
    {"ramp unload", {{0, 0}, {10, 5}, {20, 0}}, 3, 0, 0, 0, 0},
    {"ramp", {{0, 0}, {0.5, 2}, {60, 5}}, 3, 0, 0, 0, 0}, /* fast, then slowly: never still */
    {"ramp dwell cycle", {{0, 0}, {2, 5}, {12, 5}}, 3, 0.5, 1, 1, 10},
    {"ramp dwell sweep", {{0, 0}, {2, 5}, {12, 5}}, 3, 0.5, 0.2, 5, 20},
    {"rest cycle", {{0, 0}, {1, 0}}, 2, -2.5, 0.2, 0.2, 20}, /* from 0 to 5 mm and back, four times */
    {"cycle", {{0, 0}, {5, 5}, {10, 0}, {15, 5}, {20, 0}, {25, 5}, {30, 0}}, 7, 0, 0, 0, 0},
    {"approach", {{0, -5}, {10, -0.5}}, 2, 0, 0, 0, 0},
};

static double depth_at(const course *c, double t) {
    size_t k = 1;
    const double *end = c->corner[c->n_corners - 1];
    if (t >= end[0] && c->amplitude != 0.0) {
        double s = t - end[0], slope = (c->last_Hz - c->first_Hz) / c->wave_s;
        double phase = 2.0 * PI * (c->first_Hz * s + 0.5 * slope * s * s);
        return c->amplitude < 0.0 ? end[1] - c->amplitude * (1.0 - cos(phase))
                                  : end[1] + c->amplitude * sin(phase);
    }
    while (k + 1 < c->n_corners && t > c->corner[k][0])
        k++;
    const double *a = c->corner[k - 1], *b = c->corner[k];
    return t >= b[0] ? b[1] : a[1] + (b[1] - a[1]) * (t - a[0]) / (b[0] - a[0]);
}

static size_t sample(const course *c, double rate_Hz, double *t, double *d) {
    double end = c->corner[c->n_corners - 1][0] + c->wave_s;
    size_t n = 0;
    for (; n < MOST && (double)n / rate_Hz <= end; n++) {
        t[n] = (double)n / rate_Hz;
        d[n] = depth_at(c, t[n]);
    }
    return n;
}

/* In words, and where each begins, s. */
static void pieces_of(size_t n, const double *t, const double *d, char text[256], double began[16]) {
    palp_pieces pieces;
    ck_assert_int_eq(palp_segments_pieces(n, t, d, &pieces), PALP_OK);
    memset(began, 0, 16 * sizeof *began);
    text[0] = '\0';
    ck_assert_uint_gt(pieces.n, 0);
    ck_assert_uint_eq(pieces.piece[0].first, 0);
    ck_assert_uint_eq(pieces.piece[pieces.n - 1].last, n - 1);
    for (size_t k = 0; k < pieces.n && k < 16; k++) {
        ck_assert(k == 0 || pieces.piece[k].first == pieces.piece[k - 1].last);
        began[k] = t[pieces.piece[k].first];
        if (strlen(text) < 200) {
            strcat(text, k ? " " : "");
            strcat(text, palp_motion_name(pieces.piece[k].motion));
        }
    }
    palp_pieces_free(&pieces);
    ck_assert_ptr_null(pieces.piece);
}

static double at_s[MOST], depth[MOST], time2[MOST], depth2[MOST];

START_TEST(the_path_says_what_was_done) {
    const course *c = &courses[_i];
    char text[256];
    double began[16];
    size_t n = sample(c, 100.0, at_s, depth);
    pieces_of(n, at_s, depth, text, began);
    ck_assert_msg(strcmp(text, c->pieces) == 0, "course %d: %s, not %s", _i, text, c->pieces);
}
END_TEST

/* The unit of depth and of time changes nothing. */
START_TEST(scales_change_nothing) {
    static const double lengths[] = {1e-4, 10.0}, times[] = {1e-3, 1e3};
    const course *c = &courses[_i];
    char text[256];
    double began[16], began2[16];
    size_t n = sample(c, 100.0, at_s, depth);
    pieces_of(n, at_s, depth, text, began);
    for (size_t k = 0; k < 4; k++) {
        char text2[256];
        for (size_t i = 0; i < n; i++) {
            time2[i] = times[k / 2] * at_s[i];
            depth2[i] = lengths[k % 2] * depth[i];
        }
        pieces_of(n, time2, depth2, text2, began2);
        ck_assert_str_eq(text, text2);
        for (size_t j = 0; j < 16 && began[j] > 0.0 && j < 2; j++)
            ck_assert_double_eq_tol(began2[j] / times[k / 2], began[j], 1e-9 * began[j]);
    }
}
END_TEST

/* Half of the samples missing at random, and noise of the depth: the same pieces, which begin at about the
 * same time. */
START_TEST(missing_samples_and_noise_change_nothing) {
    const course *c = &courses[_i];
    for (uint64_t seed = 1; seed <= 10; seed++) {
        char text[256], text2[256];
        double began[16], began2[16];
        uint64_t dice = seed;
        size_t n = sample(c, 100.0, at_s, depth), m = 0;
        for (size_t i = 0; i < n; i++)
            depth[i] += 1e-3 * palp_random_normal(&dice);
        pieces_of(n, at_s, depth, text, began);
        for (size_t i = 0; i < n; i++)
            if (palp_random_uniform(&dice) < 0.5 || i == 0 || i + 1 == n) {
                time2[m] = at_s[i];
                depth2[m++] = depth[i];
            }
        pieces_of(m, time2, depth2, text2, began2);
        ck_assert_msg(strcmp(text, c->pieces) == 0, "course %d, seed %d: %s, not %s", _i, (int)seed, text,
                      c->pieces);
        ck_assert_msg(strcmp(text2, c->pieces) == 0, "course %d, seed %d: %s, not %s with half missing", _i,
                      (int)seed, text2, c->pieces);
        for (size_t k = 0; k < 16 && began[k] > 0.0;
             k++) /* 0.2 % of the range on a ramp of 10 s, and what is missing */
            ck_assert_double_eq_tol(began2[k], began[k], 0.2);
    }
}
END_TEST

START_TEST(missing_samples_are_counted) {
    uint64_t dice = 3;
    size_t m = 0, missing, kept = 0;
    double step;
    for (size_t i = 0; i < 4000; i++)
        if (palp_random_uniform(&dice) < 0.5 || i == 3999)
            at_s[m++] = 0.01 * (double)i, kept = i;
    ck_assert_int_eq(palp_segments_clock(m, at_s, &step, &missing), PALP_OK);
    ck_assert_double_eq_tol(step, 0.01, 1e-9);
    ck_assert_uint_eq(missing + m, kept + 1 - (size_t)rint(at_s[0] / 0.01));
    for (size_t i = 0; i < 200; i++) /* a clock without a step: times as their squares */
        at_s[i] = 1e-3 * (double)(i * i);
    ck_assert_int_eq(palp_segments_clock(200, at_s, &step, &missing), PALP_OK);
    ck_assert_uint_eq(missing, 0);
    for (size_t i = 0; i < 200; i++)
        at_s[i] = 7.0 * (double)i;
    ck_assert_int_eq(palp_segments_clock(200, at_s, &step, &missing), PALP_OK);
    ck_assert(missing == 0 && fabs(step - 7.0) < 1e-12);
    at_s[199] = 1e30; /* more steps than an integer counts */
    ck_assert_int_eq(palp_segments_clock(200, at_s, &step, &missing), PALP_OK);
    ck_assert_uint_eq(missing, 1000000000);
}
END_TEST

START_TEST(a_noise_is_told_with_samples_missing) {
    uint64_t dice = 5;
    size_t m = 0;
    double sd, all;
    for (size_t i = 0; i < 8000; i++) { /* a ramp of 1 a second, noise 1e-3 */
        time2[i] = 0.01 * (double)i;
        depth2[i] = time2[i] + 1e-3 * palp_random_normal(&dice);
        if (palp_random_uniform(&dice) < 0.5) {
            at_s[m] = time2[i];
            depth[m++] = depth2[i];
        }
    }
    ck_assert_int_eq(palp_segments_noise(8000, time2, 0.01, depth2, PALP_NOISE_MEDIAN, &all), PALP_OK);
    ck_assert_int_eq(palp_segments_noise(m, at_s, 0.04, depth, PALP_NOISE_MEDIAN, &sd), PALP_OK);
    ck_assert_double_eq_tol(all, 1e-3, 3e-5);
    ck_assert_double_eq_tol(sd, 1e-3, 6e-5);
}
END_TEST

START_TEST(names_and_refusals) {
    palp_pieces pieces;
    size_t missing;
    double step;
    ck_assert_str_eq(palp_motion_name(PALP_MOTION_SWEEP), "sweep");
    ck_assert_str_eq(palp_motion_name((palp_motion)99), "unknown");
    ck_assert_int_eq(palp_segments_pieces(1, at_s, depth, &pieces), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_segments_pieces(5, NULL, depth, &pieces), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_segments_clock(1, at_s, &step, &missing), PALP_ERR_ARGUMENT);
    palp_pieces_free(NULL);
}
END_TEST

void tests(TCase *tc) {
    int n = (int)(sizeof courses / sizeof *courses);
    tcase_add_loop_test(tc, the_path_says_what_was_done, 0, n);
    tcase_add_loop_test(tc, scales_change_nothing, 0, n);
    tcase_add_loop_test(tc, missing_samples_and_noise_change_nothing, 0, n);
    tcase_add_test(tc, missing_samples_are_counted);
    tcase_add_test(tc, a_noise_is_told_with_samples_missing);
    tcase_add_test(tc, names_and_refusals);
}
