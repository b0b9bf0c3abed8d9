/* test_segments.c: noise, spikes, straight pieces, phases and contact of paths whose answer is a formula. */
#include "data/segments_internal.h"

#include <check.h>
#include <math.h>
#include <stdlib.h>

enum { BENDS = 21, MOST = 4000 };

/* A force whose second differences are the bends, in an order that is not sorted. */
static void integrate(size_t n, const double *bend, double *force) {
    force[0] = force[1] = 0.0;
    for (size_t i = 0; i < n; i++)
        force[i + 2] = bend[i * 8 % n] + 2.0 * force[i + 1] - force[i];
}

static double noise_of(size_t n, const double *time, const double *force, palp_noise_rule rule) {
    double sd;
    ck_assert_int_eq(palp_segments_noise(n, time, 1.0, force, rule, &sd), PALP_OK);
    return sd;
}

START_TEST(noise_by_the_median_of_the_bends) {
    double bend[BENDS], force[BENDS + 2];
    for (size_t i = 0; i < BENDS; i++)
        bend[i] = (double)(i + 1);
    integrate(BENDS, bend, force);
    ck_assert_double_eq_tol(noise_of(BENDS + 2, NULL, force, PALP_NOISE_MEDIAN), 1.4826 * 11.0 / sqrt(6.0),
                            1e-12);
    ck_assert_double_eq(noise_of(2, NULL, force, PALP_NOISE_MEDIAN), 0.0);
}
END_TEST

/* Either many bends of one size, or a seventh far beyond the middle; the largest does not count. */
START_TEST(noise_of_a_coarse_converter) {
    const double even[BENDS] = {1,  2,  3,  10, 10, 10, 10, 10, 10, 10,  10,
                                10, 10, 11, 12, 13, 14, 15, 16, 17, 1000};
    const double wide[BENDS] = {1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 40, 50, 60, 70};
    const double neither[BENDS] = {1, 1, 1, 1, 1, 8, 9, 9, 9, 9, 10, 10, 10, 10, 10, 10, 10, 10, 49, 60, 70};
    double force[BENDS + 2];
    integrate(BENDS, even, force);
    ck_assert_double_eq_tol(noise_of(BENDS + 2, NULL, force, PALP_NOISE_MEDIAN), sqrt(2414.0 / 20.0 / 6.0),
                            1e-12);
    integrate(BENDS, wide, force);
    ck_assert_double_eq_tol(noise_of(BENDS + 2, NULL, force, PALP_NOISE_MEDIAN), sqrt(7750.0 / 20.0 / 6.0),
                            1e-12);
    integrate(BENDS, neither, force);
    ck_assert_double_eq_tol(noise_of(BENDS + 2, NULL, force, PALP_NOISE_MEDIAN), 1.4826 * 9.0 / sqrt(6.0),
                            1e-12); /* without 60 and 70 */
}
END_TEST

START_TEST(noise_without_the_largest_twentieth) {
    double bend[40], force[42];
    for (size_t i = 0; i < 40; i++)
        bend[i] = i < 38 ? (double)(i + 1) : 1e6;
    force[0] = force[1] = 0.0;
    for (size_t i = 0; i < 40; i++)
        force[i + 2] = bend[i * 7 % 40] + 2.0 * force[i + 1] - force[i];
    ck_assert_double_eq_tol(noise_of(42, NULL, force, PALP_NOISE_TRIMMED), sqrt(19019.0 / 38.0 / 0.76 / 6.0),
                            1e-6);
}
END_TEST

/* Two bends of 1e6 straddle a lost sample. */
START_TEST(a_gap_tells_no_noise) {
    double time[BENDS + 4], force[BENDS + 4];
    force[0] = force[1] = 0.0;
    for (size_t i = 0; i < BENDS + 4; i++)
        time[i] = (double)(i + (i > 10));
    for (size_t i = 0; i < BENDS + 2; i++) {
        size_t k = i < 9 ? i : i - 2;
        double bend = i == 9 || i == 10 ? 1e6 : (double)(k * 8 % BENDS + 1);
        force[i + 2] = bend + 2.0 * force[i + 1] - force[i];
    }
    ck_assert_double_eq_tol(noise_of(BENDS + 4, time, force, PALP_NOISE_MEDIAN), 1.4826 * 11.0 / sqrt(6.0),
                            1e-6);
    ck_assert_double_eq_tol(noise_of(BENDS + 4, NULL, force, PALP_NOISE_MEDIAN), 1.4826 * 11.0 / sqrt(6.0),
                            1e-6); /* nor so few */
    ck_assert_double_gt(noise_of(BENDS + 4, NULL, force, PALP_NOISE_TRIMMED),
                        noise_of(BENDS + 4, time, force, PALP_NOISE_TRIMMED));
}
END_TEST

static size_t spikes_in(const double f[9], size_t *where) {
    unsigned char use[9] = {1, 1, 1, 1, 1, 1, 1, 1, 1};
    size_t count = segments_mask_spikes(9, f, 1.0, 8.0, use), masked = 0;
    for (size_t i = 0; i < 9; i++)
        if (!use[i]) {
            *where = i;
            masked++;
        }
    ck_assert_uint_eq(masked, count);
    return count;
}

START_TEST(a_spike_is_beyond_the_noise_and_three_times_the_curve) {
    for (int over = 0; over < 2; over++) {
        double at = over ? 0.1 : -0.1;
        const double f[][9] = {{0, 0, 0, 0, 8.0 + at, 0, 0, 0, 0},     {0, 0, 0, 0, -8.0 - at, 0, 0, 0, 0},
                               {-1, -1, -1, 0, 11.0 + at, 0, 0, 0, 0}, {1, 1, 1, 0, 11.0 + at, 0, 0, 0, 0},
                               {0, 0, 0, 0, 11.0 + at, 0, -1, -1, -1}, {0, 0, 0, 0, 11.0 + at, 0, 1, 1, 1},
                               {0, 0, 0, 0, 10.0 + at, 2, 2, 2, 2},    {2, 2, 2, 2, 10.0 + at, 0, 0, 0, 0}};
        for (size_t k = 0; k < sizeof f / sizeof *f; k++) {
            size_t where = 4;
            ck_assert_uint_eq(spikes_in(f[k], &where), (size_t)over);
            ck_assert_uint_eq(where, 4);
        }
    }
    const double step[9] = {0, 0, 0, 0, 20, 40, 40, 40, 40}, early[9] = {0, 0, 20, 0, 0, 0, 0, 0, 0},
                 late[9] = {0, 0, 0, 0, 0, 0, 20, 0, 0}, end[9] = {0, 20, 0, 0, 0, 0, 0, 20, 0};
    size_t where = 0;
    ck_assert_uint_eq(spikes_in(step, &where), 0);
    ck_assert_uint_eq(spikes_in(early, &where), 1);
    ck_assert_uint_eq(where, 2);
    ck_assert_uint_eq(spikes_in(late, &where), 1);
    ck_assert_uint_eq(where, 6);
    ck_assert_uint_eq(spikes_in(end, &where), 0); /* has no two neighbours on each side */
    unsigned char use[9] = {0};
    ck_assert_uint_eq(segments_mask_spikes(9, early, 0.0, 8.0, use), 0);
}
END_TEST

START_TEST(a_cone_closes_where_no_line_passes) {
    segments_cone c = segments_cone_open();
    ck_assert(segments_cone_take(&c, 1.0, 1.0, 0.5));
    ck_assert_double_eq(c.low, 0.5);
    ck_assert_double_eq(c.high, 1.5);
    ck_assert(segments_cone_take(&c, 2.0, 1.5, 0.5)); /* 0.5 to 1 */
    ck_assert_double_eq(c.low, 0.5);
    ck_assert_double_eq(c.high, 1.0);
    segments_cone before = c;
    ck_assert(!segments_cone_take(&c, 4.0, 4.6, 0.5)); /* 1.025 and more */
    ck_assert(!segments_cone_take(&before, 4.0, 1.4, 0.5));
}
END_TEST

START_TEST(bends_of_a_path) {
    const double depth[6] = {1, 2, 4, 7, 7, 5};
    double bend[4];
    segments_bends(6, depth, bend);
    ck_assert(bend[0] == 1 && bend[1] == 1 && bend[2] == 3 && bend[3] == 2);
}
END_TEST

/* Rest at `from`, 1000 steps to 1, rest, 1000 steps back, rest: 50 samples each. */
static size_t there_and_back(double from, double *depth) {
    size_t n = 0;
    for (int i = 0; i < 50; i++)
        depth[n++] = from;
    for (int i = 1; i <= 1000; i++)
        depth[n++] = from + (1.0 - from) * i / 1000.0;
    for (int i = 0; i < 50; i++)
        depth[n++] = 1.0;
    for (int i = 1; i <= 1000; i++)
        depth[n++] = 1.0 - (1.0 - from) * i / 1000.0;
    return n;
}

static void ramp_is(double from, double begun, double arrived) {
    double depth[MOST];
    size_t n = there_and_back(from, depth), start, end, last = 1099;
    segments_ramp(n, depth, 1.0, &start, &end);
    ck_assert(depth[start] >= begun - 1e-12 && depth[start - 1] < begun);
    ck_assert(start < end && depth[end] >= arrived - 1e-12 && depth[end - 1] < arrived);
    while (depth[last + 1] >= 0.998)
        last++;
    ck_assert_uint_eq(segments_press_end(n, depth, 1.0, end), last);
    ck_assert_uint_eq(segments_press_end(1120, depth, 1.0, end), 1120); /* ends above 0.95 */
}

START_TEST(the_first_ramp_and_the_end_of_the_press) {
    ramp_is(0.0, 0.002, 0.998);
    ramp_is(-0.5, 0.002, 0.998); /* from the air: contact counts */
    ramp_is(0.25, 0.2515, 0.998);
    double depth[MOST];
    size_t n = there_and_back(0.0, depth), again = n;
    for (size_t i = 0; i < n && again < MOST; i++)
        depth[again++] = depth[i];
    ck_assert_uint_eq(segments_press_end(again, depth, 1.0, 1048), segments_press_end(n, depth, 1.0, 1048));
}
END_TEST

/* ---- phases ---- */

typedef struct corner {
    double time, depth;
} corner;

static size_t path_of(size_t corners, const corner *c, double step, double *time, double *depth) {
    size_t n = 0;
    for (size_t k = 0; k + 1 < corners; n++) {
        double t = step * (double)n;
        while (k + 1 < corners && t > c[k + 1].time + 0.1 * step)
            k++;
        if (k + 1 == corners)
            break;
        time[n] = t;
        depth[n] = c[k].depth + (c[k + 1].depth - c[k].depth) * (t - c[k].time) / (c[k + 1].time - c[k].time);
    }
    return n;
}

/* Contact at 2 s, 2 s of ramp: corners last 0.4 s there, the dwell is early for 10 s. */
START_TEST(phases_of_a_path) {
    const corner c[] = {{0, -1}, {1, -1}, {4, 2}, {19, 2.0}, {20, 1}, {21, 2}, {25, -2}, {26, -2}};
    const struct {
        double until;
        palp_phase phase;
    } wanted[] = {
        {2.0, PALP_PHASE_AIR},           {4.01, PALP_PHASE_RAMP},        {4.41, PALP_PHASE_CORNER},
        {14.01, PALP_PHASE_EARLY_DWELL}, {19.01, PALP_PHASE_LATE_DWELL}, {19.21, PALP_PHASE_CORNER},
        {20.01, PALP_PHASE_UNLOAD},      {20.21, PALP_PHASE_CORNER},     {21.01, PALP_PHASE_RELOAD},
        {21.81, PALP_PHASE_CORNER},      {23.0, PALP_PHASE_UNLOAD},      {99.0, PALP_PHASE_RECOVERY}};
    static const double scales[] = {1.0, 1e-3, 1e3};
    double time[MOST], depth[MOST], scaled[MOST];
    unsigned char phase[MOST], again[MOST];
    size_t n = path_of(8, c, 0.01, time, depth);
    ck_assert_uint_eq(n, 2601);
    ck_assert_int_eq(palp_segments_phases(n, time, depth, NULL, phase), PALP_OK);
    for (size_t i = 0, k = 0; i < n; i++) {
        while (time[i] > wanted[k].until)
            k++;
        if (wanted[k].until - time[i] > 0.1 && (k == 0 || time[i] - wanted[k - 1].until > 0.1))
            ck_assert_msg(phase[i] == wanted[k].phase, "%g s: %s", time[i],
                          palp_phase_name((palp_phase)phase[i]));
    }
    for (size_t k = 0; k < 3; k++) {
        for (size_t i = 0; i < n; i++)
            scaled[i] = scales[k] * time[i];
        ck_assert_int_eq(palp_segments_phases(n, scaled, depth, NULL, again), PALP_OK);
        size_t differ = 0;
        for (size_t i = 0; i < n; i++)
            differ += phase[i] != again[i];
        ck_assert_uint_le(differ, 8); /* at the edges, by rounding */
    }
}
END_TEST

/* The time in a dwell, which its phases do not interrupt. */
START_TEST(how_long_a_plate_stands) {
    const corner c[] = {{0, -1}, {1, -1}, {4, 2}, {19, 2.0}, {20, 1}, {21, 2}, {25, -2}, {26, -2}};
    double time[MOST], depth[MOST], stood[MOST];
    unsigned char phase[MOST];
    size_t n = path_of(8, c, 0.01, time, depth), standing = 0;
    ck_assert_int_eq(segments_phases(n, time, depth, NULL, phase, stood), PALP_OK);
    for (size_t i = 0; i < n; i++) {
        const bool within = time[i] > 4.1 && time[i]<18.9, moves = time[i]> 1.1 && time[i] < 3.9;
        standing += within;
        if (within)
            ck_assert_double_eq_tol(stood[i], time[i] - 4, 0.03);
        else if (moves || (time[i] > 19.1 && time[i] < 24.9))
            ck_assert_double_lt(stood[i], 0);
    }
    ck_assert_uint_gt(standing, 1000);
}
END_TEST

/* The legs of a cycle: five up and five down, each with its corner. */
START_TEST(phases_of_a_cycle) {
    const corner c[] = {{0, 0}, {2, 1}, {4, 0}, {6, 1}, {8, 0}, {10, 1}, {12, 0}};
    double time[MOST], depth[MOST];
    unsigned char phase[MOST];
    size_t n = path_of(7, c, 0.01, time, depth);
    ck_assert_int_eq(palp_segments_phases(n, time, depth, NULL, phase), PALP_OK);
    ck_assert_int_eq(phase[150], PALP_PHASE_RAMP);
    ck_assert_int_eq(phase[220], PALP_PHASE_CORNER);
    ck_assert_int_eq(phase[350], PALP_PHASE_UNLOAD);
    ck_assert_int_eq(phase[550], PALP_PHASE_RELOAD);
    ck_assert_int_eq(phase[1150], PALP_PHASE_UNLOAD);
    ck_assert_int_eq(palp_segments_phases(n, time, NULL, NULL, phase), PALP_ERR_ARGUMENT);
}
END_TEST

START_TEST(names_of_phases) {
    ck_assert_str_eq(palp_phase_name(PALP_PHASE_AIR), "air");
    ck_assert_str_eq(palp_phase_name(PALP_PHASE_RELOAD), "reload");
    ck_assert_str_eq(palp_phase_name(PALP_PHASE_COUNT), "unknown");
}
END_TEST

/* ---- the contact of a press ---- */

enum { SAMPLES = 400, TOUCH = 200 };

typedef struct pressing {
    double time[MOST], depth[MOST], force[MOST];
} pressing;

/* 0.01 a sample down; air of 0.5 with a drift and a noise of +-ripple, then stiffness times the way beyond
 * TOUCH. */
static palp_press make_press(pressing *p, size_t n, double drift, double ripple, double stiffness) {
    palp_press press;
    for (size_t i = 0; i < n; i++) {
        p->time[i] = 0.1 * (double)i;
        p->depth[i] = 5.0 + 0.01 * (double)i;
        p->force[i] = 0.5 + drift * p->time[i] + (i % 2 ? ripple : -ripple) +
                      stiffness * (i > TOUCH ? 0.01 * (double)(i - TOUCH) : 0.0);
    }
    ck_assert_int_eq(palp_press_create(n, p->time, p->depth, p->force, &press), PALP_OK);
    return press;
}

START_TEST(contact_is_where_the_rise_leads_back_to) {
    static pressing p;
    palp_press press = make_press(&p, SAMPLES, 0.0, 1e-3, 1.0);
    ck_assert_uint_eq(press.window, 11);
    ck_assert_uint_eq(press.peak, SAMPLES - 1);
    ck_assert_double_eq_tol(press.noise_N, 4e-3 / sqrt(6.0 * 0.76), 1e-4);
    ck_assert_double_eq_tol(press.mean_N[300], 0.5 + 1.0 + 1e-3 / 11.0, 1e-12);
    ck_assert_double_eq_tol(press.mean_N[2], 0.5, 1e-12); /* of eight samples */
    palp_air air = palp_press_air(&press, false);
    double sd = press.noise_N / sqrt(11.0); /* 0.6e-3: the mean's own ripple is less */
    ck_assert_double_eq_tol(air.sd_N, sd, 1e-12);
    ck_assert_double_eq_tol(air.level_N, 0.5, 2e-5);
    ck_assert_double_eq(air.drift_N_s, 0.0);
    ck_assert_uint_ge(air.contact, TOUCH);
    ck_assert_uint_le(air.contact, TOUCH + 1);
    ck_assert_double_eq_tol(air.contact_depth, 5.0 + 0.01 * TOUCH, 2e-3);
    ck_assert_double_lt(air.contact_sd, 2e-3);
    ck_assert(air.seen);
    ck_assert_double_eq_tol(palp_air_force(&air, 7.0), air.level_N, 1e-12);
    ck_assert(palp_press_starts_in_air(&press));
    palp_press_free(&press);
    ck_assert_ptr_null(press.mean_N);
}
END_TEST

/* The first 55 samples say what may be air, all of it but the last window what it is: here a step of 1.5e-3 N
 * in it. */
START_TEST(the_air_that_is_found_says_what_air_is) {
    static pressing p;
    palp_press press = make_press(&p, SAMPLES, 0.0, 1e-3, 1.0);
    palp_press_free(&press);
    for (size_t i = 100; i < SAMPLES; i++)
        p.force[i] += 1.5e-3;
    ck_assert_int_eq(palp_press_create(SAMPLES, p.time, p.depth, p.force, &press), PALP_OK);
    palp_air air = palp_press_air(&press, false);
    double n = (double)(air.contact - 11), above = n - 100.0;
    ck_assert_double_eq_tol(air.level_N, 0.5 + 1.5e-3 * above / n, 2e-5);
    ck_assert_double_eq_tol(air.sd_N, 1.5e-3 * sqrt(100.0 * above) / n, 2e-5); /* more than the noise */
    palp_press_free(&press);
}
END_TEST

/* A force that rises as a power of the way. */
START_TEST(contact_is_as_exact_as_it_says) {
    static pressing p;
    static const double powers[] = {1.0, 1.5, 2.0};
    for (size_t k = 0; k < 3; k++) {
        palp_press press = make_press(&p, SAMPLES, 0.0, 5e-3, 0.0);
        palp_press_free(&press);
        for (size_t i = TOUCH; i < SAMPLES; i++)
            p.force[i] += 0.5 * pow(0.01 * (double)(i - TOUCH), powers[k]);
        ck_assert_int_eq(palp_press_create(SAMPLES, p.time, p.depth, p.force, &press), PALP_OK);
        palp_air air = palp_press_air(&press, false);
        ck_assert_double_le(fabs(air.contact_depth - (5.0 + 0.01 * TOUCH)), 3.0 * air.contact_sd);
        ck_assert(air.seen);
        ck_assert_double_lt(air.contact_sd, 0.15);
        palp_press_free(&press);
    }
}
END_TEST

/* A force that bends from the start on, without noise, is no air. */
START_TEST(a_bend_is_no_air) {
    static pressing p;
    palp_press press = make_press(&p, SAMPLES, 0.0, 0.0, 0.0);
    palp_press_free(&press);
    for (size_t i = 0; i < SAMPLES; i++) {
        double way = 0.01 * fmax(0.0, (double)i - 20.0);
        p.depth[i] = 5.0 + way;
        p.force[i] = 0.2 * way + 0.05 * way * way;
    }
    ck_assert_int_eq(palp_press_create(SAMPLES, p.time, p.depth, p.force, &press), PALP_OK);
    ck_assert(!palp_press_air(&press, false).seen);
    palp_press_free(&press);
}
END_TEST

START_TEST(an_approach_drifts) {
    static pressing p;
    palp_press press = make_press(&p, 230, 0.02, 1e-3, 5.0);
    palp_air air = palp_press_air(&press, true);
    ck_assert_double_eq_tol(air.drift_N_s, 0.02, 2e-5);
    ck_assert_double_eq_tol(air.level_N, 0.5, 2e-4);
    ck_assert_double_eq_tol(palp_air_force(&air, 20.0), 0.9, 2e-4);
    ck_assert_uint_eq(air.contact, 196); /* 0.05 N / 11 is beyond 4 sds, 2.3e-3 N */
    palp_press_free(&press);
}
END_TEST

START_TEST(a_press_without_contact_ends_in_the_air) {
    static pressing p;
    palp_press press = make_press(&p, SAMPLES, 0.0, 1e-3, 0.0);
    palp_air air = palp_press_air(&press, false);
    ck_assert_uint_eq(air.contact, press.peak);
    palp_press_free(&press);
}
END_TEST

/* A step of the first 55 samples by d on a ripple of 1: |d| <= 4 sqrt((1 + d^2 / 4) / 18), so to 1.07. */
START_TEST(a_trend_is_no_air) {
    static pressing p;
    for (int over = 0; over < 2; over++) {
        palp_press press = make_press(&p, SAMPLES, 0.0, 1.0, 0.0);
        palp_press_free(&press);
        for (size_t i = 27; i < SAMPLES; i++)
            p.force[i] += over ? 1.10 : 1.04;
        ck_assert_int_eq(palp_press_create(SAMPLES, p.time, p.depth, p.force, &press), PALP_OK);
        ck_assert(palp_press_starts_in_air(&press) == !over);
        palp_press_free(&press);
    }
    palp_press few =
        make_press(&p, 39, 0.0, 1.0, 0.0); /* its window is of three samples, five of them are too few */
    ck_assert(!palp_press_starts_in_air(&few));
    palp_press_free(&few);
    few = make_press(&p, 40, 0.0, 1.0, 0.0);
    ck_assert(palp_press_starts_in_air(&few));
    palp_press_free(&few);
}
END_TEST

/* Rest of 100 samples, then 4000 - 100 straight down: the means at the ends of the first twentieth tell the
 * slope. */
START_TEST(a_force_is_a_travel) {
    static pressing p;
    palp_press press;
    for (size_t i = 0; i < MOST; i++) {
        size_t step = i < 100 ? 0 : i - 100;
        p.time[i] = 0.1 * (double)i;
        p.depth[i] = 3.0 + 0.01 * (double)step;
        p.force[i] = 7.0 + 0.02 * (double)step;
    }
    ck_assert_int_eq(palp_press_create(MOST, p.time, p.depth, p.force, &press), PALP_OK);
    size_t peak = press.peak, way = peak - 100; /* in steps */
    ck_assert_uint_eq(peak, MOST - 1);
    size_t from = 100 + (size_t)floor(1e-3 * (double)way) + 1,
           to = 100 + (size_t)floor(0.05 * (double)way) + 1;
    double mean_from = 0.0;
    for (size_t i = from - 5; i <= from + 5; i++)
        mean_from += (i < 100 ? 0.0 : 0.02 * (double)(i - 100)) / 11.0;
    double rise = 0.02 * (double)(to - 100) - mean_from;
    ck_assert_uint_eq(palp_press_rest(&press), from);
    ck_assert_double_eq_tol(palp_press_travel(&press, 0.3), 0.3 * 0.01 * (double)(to - from) / rise, 1e-9);
    ck_assert_double_eq_tol(palp_press_travel(&press, -0.3), palp_press_travel(&press, 0.3), 1e-15);
    palp_press_free(&press);
    for (size_t i = 100; i < 400; i++) /* falls at first: then the slope of the whole press */
        p.force[i] = 7.0 - 0.001 * (double)(i - 100);
    ck_assert_int_eq(palp_press_create(MOST, p.time, p.depth, p.force, &press), PALP_OK);
    double whole = (press.mean_N[press.peak] - 7.0) / (0.01 * (double)(press.peak - 100));
    ck_assert_double_eq_tol(palp_press_travel(&press, 0.3), 0.3 / whole, 1e-9);
    palp_press_free(&press);
    for (size_t i = 0; i < MOST; i++)
        p.force[i] = 7.0;
    ck_assert_int_eq(palp_press_create(MOST, p.time, p.depth, p.force, &press), PALP_OK);
    ck_assert_double_eq(palp_press_travel(&press, 0.3), 0.0);
    palp_press_free(&press);
    palp_press_free(NULL);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, noise_by_the_median_of_the_bends);
    tcase_add_test(tc, noise_of_a_coarse_converter);
    tcase_add_test(tc, noise_without_the_largest_twentieth);
    tcase_add_test(tc, a_gap_tells_no_noise);
    tcase_add_test(tc, a_spike_is_beyond_the_noise_and_three_times_the_curve);
    tcase_add_test(tc, a_cone_closes_where_no_line_passes);
    tcase_add_test(tc, bends_of_a_path);
    tcase_add_test(tc, the_first_ramp_and_the_end_of_the_press);
    tcase_add_test(tc, phases_of_a_path);
    tcase_add_test(tc, how_long_a_plate_stands);
    tcase_add_test(tc, phases_of_a_cycle);
    tcase_add_test(tc, names_of_phases);
    tcase_add_test(tc, contact_is_where_the_rise_leads_back_to);
    tcase_add_test(tc, the_air_that_is_found_says_what_air_is);
    tcase_add_test(tc, contact_is_as_exact_as_it_says);
    tcase_add_test(tc, a_bend_is_no_air);
    tcase_add_test(tc, an_approach_drifts);
    tcase_add_test(tc, a_press_without_contact_ends_in_the_air);
    tcase_add_test(tc, a_trend_is_no_air);
    tcase_add_test(tc, a_force_is_a_travel);
}
