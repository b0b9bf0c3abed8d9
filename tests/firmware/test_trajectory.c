/* test_trajectory.c: strokes, waves and lists of segments against closed forms, bounds and refusals. */
#include "real.h"
#include "trajectory.h"
#include "trajectory_make.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void assert_near(double got, double wanted, double tolerance) {
    if (!(fabs(got - wanted) <= tolerance))
        fail_msg("%.12g is not %.12g to %g", got, wanted, tolerance);
}

static double uniform(double low, double high) {
    return low + (high - low) * rand() / RAND_MAX;
}

/* Evenly over the orders of magnitude. */
static double spread(double low, double high) {
    return low * pow(high / low, uniform(0, 1));
}

static void begin(trajectory *t, const palp_wire_segment *list, int n, double start_m) {
    memset(t, 0x5a, sizeof *t);
    for (int i = 0; i < n; i++) {
        assert_int_equal(trajectory_check(&list[i], (float)SPEED, 24.0f), PALP_WIRE_RESULT_DONE);
        trajectory_set(t, (uint8_t)i, &list[i]);
    }
    trajectory_begin(t, (uint8_t)n, (float)start_m);
}

/* ---- our own sine, logarithm and power ---- */

static void test_real(void **state) {
    double sine_off = 0, log_off = 0, power_off = 0;
    (void)state;
    for (int i = 0; i <= 100000; i++) {
        float turn = (float)(1e-5 * i), sine, cosine, x = (float)spread(1e-4, 1e4),
              y = (float)uniform(-20, 20);
        real_sine(turn, &sine, &cosine);
        sine_off = fmax(sine_off, fabs((double)sine - sin(2 * PI * (double)turn)));
        sine_off = fmax(sine_off, fabs((double)cosine - cos(2 * PI * (double)turn)));
        log_off =
            fmax(log_off, fabs((double)real_log2(x) - log2((double)x)) / fmax(1, fabs(log2((double)x))));
        power_off = fmax(power_off, fabs((double)real_exp2(y) / exp2((double)y) - 1));
    }
    printf("off by at most: sine %.1e, log2 %.1e, exp2 %.1e\n", sine_off, log_off, power_off);
    assert_true(sine_off < 2e-7 && log_off < 2e-7 && power_off < 3e-7);
    for (int i = -40; i <= 40; i++) {
        assert_near((double)real_exp2((float)i), exp2(i), 0);
        assert_near((double)real_log2((float)exp2(i)), i, 0);
    }
}

/* ---- strokes ---- */

typedef struct profile {
    double length, peak, ramp, duration, acceleration;
} profile;

static profile profile_of(double length, double rate, double acceleration) {
    profile p = {.length = length, .acceleration = acceleration};
    p.peak = fmin(rate, sqrt(length * acceleration));
    p.ramp = p.peak / acceleration;
    p.duration = length > 0 ? length / p.peak + p.ramp : 0;
    return p;
}

static double profile_at(const profile *p, double t) {
    if (t >= p->duration)
        return p->length;
    if (t <= p->ramp)
        return 0.5 * p->acceleration * t * t;
    if (t <= p->duration - p->ramp)
        return p->peak * (t - 0.5 * p->ramp);
    return p->length - 0.5 * p->acceleration * pow(p->duration - t, 2);
}

/* One stroke against the closed form, from a microsecond to hours. */
static void check_stroke(double start, double end, double rate, double acceleration) {
    const profile p = profile_of(fabs((double)(float)end - (double)(float)start), rate, acceleration);
    const double sign = end < start ? -1 : 1;
    stroke s;
    reference r;
    stroke_begin(&s, (float)start, (float)end, (float)rate, (float)acceleration);
    assert_near(s.ticks, fmax(1, ceil(1e3 * p.duration)), 1 + 1e-6 * 1e3 * p.duration);
    for (uint32_t i = 1; i <= s.ticks; i++) {
        assert_true(stroke_step(&s, &r));
        assert_near((double)r.position_m, start + sign * profile_at(&p, 1e-3 * i), 1.5e-8);
        assert_true(sign * (double)r.velocity_m_s >= 0 &&
                    sign * (double)r.velocity_m_s <= p.peak * (1 + 1e-6));
    }
    assert_true(r.position_m == (float)end && r.velocity_m_s == 0 && r.acceleration_m_s2 == 0);
    assert_false(stroke_step(&s, &r));
    assert_true(r.position_m == (float)end);
}

/* With smooth corners: twice as long for each, there at the end, and the acceleration changes by no more in a
 * tick than its law does. */
static void check_smooth(double end, double rate, double acceleration) {
    palp_wire_segment wire = {.kind = PALP_WIRE_SEGMENT_MOVE | PALP_WIRE_SEGMENT_SMOOTH,
                              .target_nm = (int32_t)(1e9 * end),
                              .rate_nm_s = (uint32_t)(1e9 * rate),
                              .acceleration_um_s2 = (uint32_t)(1e6 * acceleration)};
    const double peak = fmin(rate, sqrt(fabs(end) * acceleration / 2)), ramp = 2 * peak / acceleration;
    const double jerk = PI * acceleration / ramp;
    double place = 0, velocity = 0, before = 0;
    trajectory t;
    reference r;
    uint32_t ticks = 0;
    begin(&t, &wire, 1, 0);
    while (trajectory_step(&t, &r)) {
        ticks++;
        assert_true(fabs((double)r.velocity_m_s) <= peak * (1 + 1e-6));
        assert_true(fabs((double)r.acceleration_m_s2) <= acceleration * (1 + 1e-6));
        assert_true(fabs((double)r.acceleration_m_s2 - before) <= 1.001e-3 * jerk + 1e-6 * acceleration);
        assert_near((double)r.position_m - place, 1e-3 * 0.5 * (velocity + (double)r.velocity_m_s),
                    1e-6 * acceleration * 0.1 + 3e-8);
        place = (double)r.position_m;
        velocity = (double)r.velocity_m_s;
        before = (double)r.acceleration_m_s2;
    }
    assert_near(ticks, 1e3 * (fabs(end) / peak + ramp), 2);
    assert_near((double)r.position_m, end, 1e-8);
    assert_true(r.velocity_m_s == 0);
}

static void test_smooth(void **state) {
    palp_wire_segment bad = {.kind = PALP_WIRE_SEGMENT_HOLD | PALP_WIRE_SEGMENT_SMOOTH, .duration_ms = 5};
    (void)state;
    check_smooth(0.005, 0.005, 0.5);
    check_smooth(-0.003, 0.02, 0.2);
    check_smooth(0.001, 0.25, 0.5);
    check_smooth(0.002, 0.01, 0.03);
    assert_int_equal(trajectory_check(&bad, (float)SPEED, 24.0f), PALP_WIRE_RESULT_RANGE);
}

static void test_stroke(void **state) {
    (void)state;
    srand(1);
    for (int n = 0; n < 500; n++)
        check_stroke(uniform(-0.002, 0.01), uniform(-0.002, 0.01), spread(1e-3, 0.25), spread(0.01, 50));
    check_stroke(0, 0.007, 0.25, 50);
    check_stroke(0, 0, 0.01, 1);
    check_stroke(0.003, 0.003 + 1e-9, 0.01, 1);
    check_stroke(0, 0.0072, 1e-6, 0.1); /* two hours */
}

/* The plateau is at the rate, so that equal times make equal ways. */
static void test_plateau(void **state) {
    stroke s;
    reference r;
    float first = 0, last = 0;
    (void)state;
    stroke_begin(&s, -1e-3f, 7e-3f, 7e-3f, 0.5f);
    for (int i = 1; stroke_step(&s, &r); i++) {
        first = i == 100 ? r.position_m : first;
        last = i == 1100 ? r.position_m : last;
        assert_true(i < 100 || i > 1100 || (r.velocity_m_s == 7e-3f && r.acceleration_m_s2 == 0));
    }
    assert_near((double)last - (double)first, 7e-3, 2e-9);
}

/* ---- waves ---- */

static double phase_shape(double phase, double cycles) {
    double x = 2 * PI * phase, fade = phase < 0.5 || phase > cycles - 0.5 ? 0.5 * (1 - cos(x)) : 1;
    return phase >= cycles ? 0 : fade * sin(x);
}

/* Two hours at an odd frequency: the phase is that of the exact product to the end. */
static void test_sine(void **state) {
    const palp_wire_segment wire = {
        .kind = PALP_WIRE_SEGMENT_SINE, .target_nm = 300000, .frequency_mHz = 1237, .cycles = 8906};
    trajectory t;
    reference r = {.position_m = 0};
    int64_t tick = 0;
    (void)state;
    begin(&t, &wire, 1, 0.004);
    while (trajectory_step(&t, &r)) {
        tick++;
        double phase = (double)(tick * 1237 % 1000000) * 1e-6 + (double)(tick * 1237 / 1000000);
        if (tick % 1009 == 0 || tick < 3000 || tick > 7199000)
            assert_near((double)r.position_m, 0.004 + 3e-4 * phase_shape(phase, 8906), 2e-9);
    }
    assert_int_equal(tick, (8906LL * 1000000 + 1236) / 1237);
    assert_true(r.position_m == 0.004f && r.velocity_m_s == 0);
}

/* Position, velocity and acceleration belong together: by finite differences of each. */
static void check_derivatives(const palp_wire_segment *wire, double omega) {
    trajectory t;
    reference r, last = {.position_m = 0.001f};
    const double amplitude = fabs(1e-9 * wire->target_nm), h = 1e-3;
    begin(&t, wire, 1, 0.001);
    while (trajectory_step(&t, &r) && t.cycle < t.list[0].cycles) { /* it ends within a tick */
        double mean = 0.5 * ((double)r.velocity_m_s + (double)last.velocity_m_s);
        double bend = 0.5 * ((double)r.acceleration_m_s2 + (double)last.acceleration_m_s2);
        assert_near(((double)r.position_m - (double)last.position_m) / h, mean,
                    amplitude * omega * pow(omega * h, 2) + 4e-7);
        assert_near(((double)r.velocity_m_s - (double)last.velocity_m_s) / h, bend,
                    0.4 * amplitude * omega * omega * omega * h + 1e-4);
        last = r;
    }
}

static void test_wave_derivatives(void **state) {
    palp_wire_segment wire = {
        .kind = PALP_WIRE_SEGMENT_SINE, .target_nm = -400000, .frequency_mHz = 3000, .cycles = 1};
    (void)state;
    check_derivatives(&wire, 2 * PI * 3);
    wire.cycles = 5;
    check_derivatives(&wire, 2 * PI * 3);
    wire = (palp_wire_segment){.kind = PALP_WIRE_SEGMENT_SWEEP,
                               .target_nm = 200000,
                               .frequency_mHz = 500,
                               .frequency_end_mHz = 20000,
                               .duration_ms = 20000};
    check_derivatives(&wire, 2 * PI * 20);
}

/* A sweep against its closed form, upwards, downwards, level; whole periods, and rest to the end. */
static void check_sweep(double start_Hz, double end_Hz, double duration_s) {
    const palp_wire_segment wire = {.kind = PALP_WIRE_SEGMENT_SWEEP,
                                    .target_nm = 50000,
                                    .frequency_mHz = (uint32_t)lrint(1e3 * start_Hz),
                                    .frequency_end_mHz = (uint32_t)lrint(1e3 * end_Hz),
                                    .duration_ms = (uint32_t)lrint(1e3 * duration_s)};
    const double x = log(end_Hz / start_Hz);
    double most = 0, rate = 1 / (50e-6 * 2 * PI);
    trajectory t;
    reference r;
    uint32_t tick = 0;
    begin(&t, &wire, 1, 0);
    const double cycles = t.list[0].cycles, all = start_Hz * duration_s * (x != 0 ? (exp(x) - 1) / x : 1);
    assert_true(cycles >= 1 && cycles <= all + 0.01 && cycles > all - 1);
    while (trajectory_step(&t, &r)) {
        double s = 1e-3 * ++tick / duration_s;
        double phase = start_Hz * duration_s * (x != 0 ? (exp(x * s) - 1) / x : s);
        if (phase < cycles - 0.02) {
            most = fmax(most, fabs((double)r.position_m / 50e-6 - phase_shape(phase, cycles)));
            assert_true(fabs((double)r.velocity_m_s) * rate <= start_Hz * exp(x * s) * (1 + 1e-5));
        } else if (phase > cycles + 0.02) {
            assert_true(r.position_m == 0 && r.velocity_m_s == 0);
        }
    }
    printf("sweep %g to %g Hz in %g s: %g of %.2f periods, off by at most %.1e of the amplitude\n", start_Hz,
           end_Hz, duration_s, cycles, all, most);
    assert_int_equal(tick, wire.duration_ms);
    assert_true(most < 5e-3 * (1 + all / 1e4));
}

static void test_sweep(void **state) {
    (void)state;
    check_sweep(0.1, 20, 60);
    check_sweep(20, 0.1, 60);
    check_sweep(2, 2, 10);
    check_sweep(1, 50, 3600);
    check_sweep(0.5, 100, 2);
    check_sweep(1, 1.3, 1.5);
}

/* ---- lists ---- */

static palp_wire_segment random_segment(void) {
    palp_wire_segment w = {.kind = (uint8_t)(rand() % PALP_WIRE_SEGMENT_FORCE)};
    do {
        w.target_nm = (int32_t)(w.kind < PALP_WIRE_SEGMENT_SINE ? uniform(-1e6, 7e6) : uniform(-5e5, 5e5));
        w.rate_nm_s = (uint32_t)spread(5e5, 2.5e8);
        w.acceleration_um_s2 = (uint32_t)spread(1e4, 5e7);
        w.duration_ms = (uint32_t)spread(1, 3000);
        w.frequency_mHz = (uint32_t)spread(300, 2e4);
        w.frequency_end_mHz = (uint32_t)spread(300, 2e4);
        w.cycles = (uint16_t)(1 + rand() % 4);
    } while (trajectory_check(&w, (float)SPEED, 24.0f) != PALP_WIRE_RESULT_DONE);
    return w;
}

static double wave_omega(const palp_wire_segment *w) {
    uint32_t most = w->kind == PALP_WIRE_SEGMENT_SWEEP && w->frequency_end_mHz > w->frequency_mHz
                        ? w->frequency_end_mHz
                        : w->frequency_mHz;
    return 2 * PI * 1e-3 * most;
}

static double fastest(const palp_wire_segment *w) {
    return w->kind == PALP_WIRE_SEGMENT_HOLD  ? 0
           : w->kind < PALP_WIRE_SEGMENT_SINE ? 1e-9 * w->rate_nm_s
                                              : 1e-9 * abs(w->target_nm) * wave_omega(w);
}

static double hardest(const palp_wire_segment *w) {
    return w->kind < PALP_WIRE_SEGMENT_SINE ? 1e-6 * w->acceleration_um_s2 : 1.6 * fastest(w) * wave_omega(w);
}

/* Where it ends and how many ticks it takes, give or take one. */
static double end_of(const palp_wire_segment *w, double start, double *ticks) {
    const double target = 1e-9 * w->target_nm, periods = w->cycles;
    *ticks = w->duration_ms;
    if (w->kind == PALP_WIRE_SEGMENT_SINE)
        *ticks = ceil(periods * 1e6 / w->frequency_mHz - 1e-9);
    if (w->kind != PALP_WIRE_SEGMENT_MOVE && w->kind != PALP_WIRE_SEGMENT_CYCLE)
        return start;
    profile p = profile_of(fabs(target - start), 1e-9 * w->rate_nm_s, 1e-6 * w->acceleration_um_s2);
    *ticks = ceil(1e3 * p.duration) * (w->kind == PALP_WIRE_SEGMENT_MOVE ? 1 : 2 * periods);
    return w->kind == PALP_WIRE_SEGMENT_MOVE ? target : start;
}

/* What every tick has to keep to: from one to the next no jump of position, velocity within the segment's
 * speed, its change within the segment's acceleration. */
static void check_tick(const palp_wire_segment *w, const reference *was, const reference *is) {
    const double v = fastest(w), a = hardest(w), h = 1e-3;
    const double moved = (double)is->position_m - (double)was->position_m;
    assert_true(fabs((double)is->velocity_m_s) <= v * (1 + 1e-5));
    assert_true(fabs((double)is->acceleration_m_s2) <= a * (1 + 1e-5));
    assert_true(fabs(moved) <= v * h + 2e-9);
    assert_true(fabs((double)is->velocity_m_s - (double)was->velocity_m_s) <= a * h * (1 + 1e-4) + 1e-8);
    assert_near(moved, 0.5 * h * ((double)is->velocity_m_s + (double)was->velocity_m_s),
                0.5 * a * h * h + 3e-9);
}

static void check_list(const palp_wire_segment *list, int n) {
    trajectory t;
    reference was = {.position_m = -1e-3f}, is;
    double end = -1e-3, ticks = 0;
    begin(&t, list, n, end);
    for (int i = 0; i < n; i++) {
        const palp_wire_segment *w = &list[i];
        uint32_t taken = 0;
        end = end_of(w, end, &ticks);
        for (bool more = true; more; taken++) { /* to the tick before the next segment's first */
            assert_true(trajectory_step(&t, &is));
            assert_int_equal(t.current, i);
            check_tick(w, &was, &is);
            was = is;
            trajectory ahead = t;
            more = trajectory_step(&ahead, &is) && ahead.current == i;
        }
        assert_near(taken, fmax(1, ticks), w->kind == PALP_WIRE_SEGMENT_CYCLE ? 2 * w->cycles : 1);
        assert_true(was.position_m == (float)end || fabs((double)was.position_m - end) < 1e-9);
        assert_true(was.velocity_m_s == 0);
    }
    for (int i = 0; i < 3; i++) {
        assert_false(trajectory_step(&t, &is));
        assert_true(is.position_m == was.position_m && is.velocity_m_s == 0 && is.acceleration_m_s2 == 0);
    }
}

static void test_lists(void **state) {
    (void)state;
    srand(3);
    for (int n = 0; n < 400; n++) {
        palp_wire_segment list[PALP_WIRE_SEGMENTS];
        int count = n < 10 ? PALP_WIRE_SEGMENTS : 1 + rand() % 6;
        for (int i = 0; i < count; i++)
            list[i] = random_segment();
        check_list(list, count);
    }
}

static void test_empty(void **state) {
    trajectory t;
    reference r;
    (void)state;
    trajectory_begin(&t, 0, 0.002f);
    for (int i = 0; i < 3; i++) {
        assert_false(trajectory_step(&t, &r));
        assert_true(r.position_m == 0.002f && r.velocity_m_s == 0);
    }
}

/* Thousands of triangles: each takes as many ticks as the first. */
static void test_cycles(void **state) {
    const palp_wire_segment wire = {.kind = PALP_WIRE_SEGMENT_CYCLE,
                                    .target_nm = 5000000,
                                    .rate_nm_s = 10000000,
                                    .acceleration_um_s2 = 1000000,
                                    .cycles = 5000};
    trajectory t;
    reference r;
    uint32_t tick = 0, top = 0;
    (void)state;
    begin(&t, &wire, 1, -0.001);
    while (trajectory_step(&t, &r)) {
        tick++;
        if (r.position_m == 0.005f) {
            assert_true(tick % 1220 == 610); /* 6 mm at 10 mm/s and 10 ms of corners */
            top++;
        }
    }
    assert_int_equal(tick, 1220 * 5000);
    assert_int_equal(top, 5000);
    assert_true(r.position_m == -0.001f);
}

/* ---- the same bits everywhere ---- */

static uint32_t hash(uint32_t sum, const void *data, size_t size) {
    const unsigned char *byte = data;
    while (size-- > 0)
        sum = (sum ^ *byte++) * 16777619u;
    return sum;
}

/* Over all kinds of segments. The figure is also what the code gives on a Cortex-M4. */
static void test_bits(void **state) {
    trajectory t;
    reference r;
    uint32_t sum = 2166136261u;
    (void)state;
    begin(&t, &good[0], 1, -1e-3);
    for (uint8_t i = 0; i < 5; i++)
        trajectory_set(&t, i, &good[i]);
    t.list[2].rate_m_s = 3e-3f;
    t.list[2].acceleration_m_s2 = 0.1f;
    t.list[3].cycles = 3;
    t.list[3].ticks = 3000;
    trajectory_begin(&t, 5, -1e-3f);
    while (trajectory_step(&t, &r))
        sum = hash(sum, &r, sizeof r);
    assert_int_equal(sum, 0xb4b158edu);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_real),    cmocka_unit_test(test_stroke), cmocka_unit_test(test_smooth),
    cmocka_unit_test(test_plateau), cmocka_unit_test(test_sine),   cmocka_unit_test(test_wave_derivatives),
    cmocka_unit_test(test_sweep),   cmocka_unit_test(test_lists),  cmocka_unit_test(test_empty),
    cmocka_unit_test(test_cycles),  cmocka_unit_test(test_bits),   {0},
};
