/* test_tracking.c: the plate follows ramps and holds in specimens of all six classes of softness.
 * "test_tracking tune" instead tunes the table of gains: see doc/control.md. */
#include "closed_loop.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* What is asked of every class. */
static const double RMS_M = 30e-6, OVERSHOOT = 0.02, HOLD_M = 10e-6;

/* A ramp from LOOP_AIR_M above the specimen, a hold, and back, with an actuator that differs from what the
 * firmware takes it to be. */
typedef struct press {
    double scale, depth_m, ramp_s, acceleration_m_s2;
    double coulomb_N, mass, motor; /* the latter two: times what they should be */
    const gains *gains;            /* NULL = of the class that the search finds */
} press;

typedef struct outcome {
    int softness;
    double rms_m;     /* of the error while the ramp is in the specimen */
    double overshoot; /* share of the depth */
    double hold_m;    /* largest error from 0.2 s after the ramp */
    double back_m;    /* rms on the way back */
    double force_N;   /* largest */
} outcome;

static const press usual = {.scale = 1,
                            .depth_m = 7e-3,
                            .ramp_s = 1,
                            .acceleration_m_s2 = 0.5,
                            .coulomb_N = 0.15,
                            .mass = 1,
                            .motor = 1};

static double larger(double a, double b) {
    return a > b ? a : b;
}

/* Rms of the error over the stroke where the plate is in the specimen. Both sides as they are at the tick. */
static double follow(loop *l, stroke *way, double target_m, outcome *o) {
    reference next;
    double sum = 0;
    int n = 0;
    while (stroke_step(way, &next)) {
        double at = loop_position(l), error = at - (double)next.position_m;
        bool inside = (double)next.position_m >= (double)LOOP_AIR_M;
        sum += inside ? error * error : 0;
        n += inside;
        o->overshoot = larger(o->overshoot, (at - target_m) / (target_m - (double)LOOP_AIR_M));
        o->force_N = larger(o->force_N, plant_look(l->plant).force_N);
        loop_tick(l, &next);
    }
    return sqrt(sum / n);
}

static void hold(loop *l, float target_m, outcome *o) {
    const double depth = (double)target_m - (double)LOOP_AIR_M;
    for (int i = 0; i < 2000; i++) {
        double error = loop_position(l) - (double)target_m;
        o->overshoot = larger(o->overshoot, error / depth);
        o->hold_m = i < 200 ? 0 : larger(o->hold_m, fabs(error));
        loop_rest(l, target_m, 1);
    }
}

static outcome run(const press *p) {
    plant_settings s = plant_settings_default();
    outcome o = {.softness = -1};
    loop l;
    s.scale = p->scale;
    s.actuator.coulomb_N = p->coulomb_N;
    s.actuator.moving_kg *= p->mass;
    s.actuator.force_constant_N_A *= p->motor;
    loop_open(&l, s);
    loop_rest(&l, 0, 100);
    contact c = loop_search(&l, 5e-4f, 3e-3f);
    assert_int_equal(c.phase, CONTACT_FOUND);
    loop_go(&l, (float)loop_position(&l), 0);
    o.softness = gains_class(gains_table, c.stiffness_N_m);
    l.gains = p->gains ? p->gains : &gains_table[o.softness];
    l.contact_m = c.position_m;
    l.known = true;
    loop_rest(&l, 0, 500);

    stroke way;
    float target = LOOP_AIR_M + (float)p->depth_m, rate = (float)(p->depth_m / p->ramp_s);
    stroke_begin(&way, 0, target, rate, (float)p->acceleration_m_s2);
    o.rms_m = follow(&l, &way, (double)target, &o);
    hold(&l, target, &o);
    stroke_begin(&way, target, 0, rate, (float)p->acceleration_m_s2);
    o.back_m = follow(&l, &way, (double)target, &o);
    loop_close(&l);
    return o;
}

static void worse_of(outcome *worst, const outcome *o) {
    worst->rms_m = larger(worst->rms_m, o->rms_m);
    worst->overshoot = larger(worst->overshoot, o->overshoot);
    worst->hold_m = larger(worst->hold_m, o->hold_m);
    worst->back_m = larger(worst->back_m, o->back_m);
    worst->force_N = larger(worst->force_N, o->force_N);
}

static bool good(const outcome *o) {
    return o->rms_m <= RMS_M && o->overshoot <= OVERSHOOT && o->hold_m <= HOLD_M;
}

static void print_outcome(const outcome *o) {
    printf("ramp rms %6.2f um, overshoot %4.2f %%, hold %5.2f um, back rms %6.2f um, force %5.2f N\n",
           1e6 * o->rms_m, 1e2 * o->overshoot, 1e6 * o->hold_m, 1e6 * o->back_m, o->force_N);
}

static void require(const press *p, int softness) {
    outcome o = run(p);
    printf("%4.2f x, %3.1f mm in %4.1f s, %4.1f m/s2, friction %4.2f N, mass %3.1f, motor %3.1f: ", p->scale,
           1e3 * p->depth_m, p->ramp_s, p->acceleration_m_s2, p->coulomb_N, p->mass, p->motor);
    print_outcome(&o);
    assert_int_equal(o.softness, softness);
    assert_true(o.force_N < (double)machine_indenter.force_N);
    assert_true(good(&o));
}

/* ---- what is asked for ---- */

static void test_depths(void **state) {
    static const double depths_m[] = {1.5e-3, 3e-3, 5e-3, 7e-3};
    (void)state;
    for (int k = 0; k < SOFTNESSES; k++)
        for (int i = 0; i < (k == 5 ? 3 : 4); i++) {
            press p = usual;
            p.scale = softness_scale[k];
            p.depth_m = depths_m[i];
            require(&p, k);
        }
}

static void test_friction(void **state) {
    (void)state;
    for (int k = 0; k < SOFTNESSES; k++) {
        press p = usual;
        p.scale = softness_scale[k];
        p.depth_m = 5e-3;
        p.coulomb_N = 0.45;
        require(&p, k);
        p.coulomb_N = 0;
        require(&p, k);
    }
}

static void test_rates(void **state) {
    (void)state;
    for (int k = 0; k < SOFTNESSES; k++) {
        press p = usual;
        p.scale = softness_scale[k];
        p.depth_m = 5e-3;
        p.ramp_s = 50;
        require(&p, k);
        p.ramp_s = 1;
        p.acceleration_m_s2 = 5;
        require(&p, k);
    }
}

/* Heavier or lighter, stronger or weaker by a fifth. */
static void test_robust(void **state) {
    (void)state;
    for (int k = 0; k < SOFTNESSES; k++)
        for (int i = 0; i < 4; i++) {
            press p = usual;
            p.scale = softness_scale[k];
            p.depth_m = 5e-3;
            *(i < 2 ? &p.mass : &p.motor) = i % 2 == 0 ? 0.8 : 1.2;
            require(&p, k);
        }
}

/* ---- waves ---- */

/* 0.2 mm about 4 mm deep in the phantom; the first segment goes there. */
static void check_sine(uint32_t frequency_mHz) {
    const palp_wire_segment segments[] = {
        {.kind = PALP_WIRE_SEGMENT_MOVE,
         .target_nm = 4000000,
         .rate_nm_s = 4000000,
         .acceleration_um_s2 = 500000},
        {.kind = PALP_WIRE_SEGMENT_SINE, .target_nm = 200000, .frequency_mHz = frequency_mHz, .cycles = 20}};
    double sum = 0, most = 0;
    int n = 0;
    trajectory t;
    reference next;
    loop l;
    loop_open(&l, plant_settings_default());
    l.contact_m = LOOP_AIR_M;
    l.known = true;
    for (uint8_t i = 0; i < 2; i++) {
        assert_int_equal(trajectory_check(&segments[i], machine_indenter.speed_m_s, 24.0f),
                         PALP_WIRE_RESULT_DONE);
        trajectory_set(&t, i, &segments[i]);
    }
    trajectory_begin(&t, 2, -LOOP_AIR_M);
    while (trajectory_step(&t, &next)) {
        next.position_m += LOOP_AIR_M;
        double error = t.current == 1 ? fabs(loop_position(&l) - (double)next.position_m) : 0;
        sum += error * error;
        n += t.current == 1;
        most = larger(most, error);
        loop_tick(&l, &next);
    }
    loop_close(&l);
    printf("sine of 0.2 mm, %4.1f Hz: off by %.2f um rms, at most %.2f um\n", 1e-3 * frequency_mHz,
           1e6 * sqrt(sum / n), 1e6 * most);
    assert_true(sqrt(sum / n) < RMS_M);
}

static void test_sine(void **state) {
    (void)state;
    check_sine(1000);
    check_sine(5000);
    check_sine(20000);
}

/* ---- the classes earn their place ---- */

static void test_wrong_class(void **state) {
    double rms[SOFTNESSES][SOFTNESSES];
    (void)state;
    printf("5 mm in 1 s, ramp rms in um, specimen by class of gains:\n");
    for (int k = 0; k < SOFTNESSES; k++) {
        printf("%4.2f x:", softness_scale[k]);
        for (int g = 0; g < SOFTNESSES; g++) {
            press p = usual;
            p.scale = softness_scale[k];
            p.depth_m = 5e-3;
            p.gains = &gains_table[g];
            rms[k][g] = run(&p).rms_m;
            printf(" %6.2f", 1e6 * rms[k][g]);
        }
        printf("\n");
    }
    for (int k = 0; k < SOFTNESSES; k++)
        for (int g = 0; g < SOFTNESSES; g++) {
            double ratio = rms[k][g] / rms[k][k];
            if (g == 0)
                printf("%4.2f x, times the right class:", softness_scale[k]);
            printf(" %5.1f%s", ratio, g == SOFTNESSES - 1 ? "\n" : "");
            assert_true(ratio >= (g == k ? 1 : abs(g - k) == 1 ? 3 : 8));
        }
}

/* ---- tuning ---- */

/* Three equal poles at -omega for the machine's mass and drag and the class's own specimen. */
static gains placed(int k, double omega) {
    const double kg = (double)machine_indenter.moving_kg, drag = (double)machine_indenter.motor_drag_Ns_m;
    const double stiffness = 500 * softness_scale[k];
    return (gains){.stiffness_N_m = k == SOFTNESSES - 1 ? 1e6f : (float)round(477 * softness_border[k + 1]),
                   .kp_N_m = (float)round(3 * kg * omega * omega - stiffness),
                   .ki_N_ms = (float)round(kg * omega * omega * omega),
                   .kd_Ns_m = (float)round(3 * kg * omega - drag),
                   .filter_Hz = 150,
                   .feed_N_m = (float)stiffness};
}

/* Worst of all corners at once: ends of the class, shallow and deep, friction, mass and motor. */
static outcome corners(int k, const gains *g) {
    const double scales[3] = {softness_border[k], softness_scale[k], softness_border[k + 1]};
    outcome worst = {.softness = k};
    for (int i = 0; i < 48; i++) {
        press p = usual;
        p.scale = scales[i % 3];
        p.depth_m = i / 3 % 2 == 0 ? 1.5e-3 : k == 5 ? 5e-3 : 7e-3;
        p.coulomb_N = i / 6 % 2 == 0 ? 0.15 : 0.45;
        p.mass = i / 12 % 2 == 0 ? 0.8 : 1.2;
        p.motor = i / 24 % 2 == 0 ? 0.8 : 1.2;
        p.gains = g;
        outcome o = run(&p);
        worse_of(&worst, &o);
    }
    return worst;
}

/* The slowest that does what is asked, in steps of 5 /s. */
static void tune(int k) {
    for (double omega = 60; omega <= 150; omega += 5) {
        gains g = placed(k, omega);
        outcome o = corners(k, &g);
        printf("class %d, %3.0f /s: ", k, omega);
        print_outcome(&o);
        if (good(&o)) {
            printf("    {%.0ff, %.0ff, %.0ff, %.0ff, %.0ff, %.0ff},\n", (double)g.stiffness_N_m,
                   (double)g.kp_N_m, (double)g.ki_N_ms, (double)g.kd_Ns_m, (double)g.filter_Hz,
                   (double)g.feed_N_m);
            return;
        }
    }
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_depths), cmocka_unit_test(test_friction),
                                       cmocka_unit_test(test_rates),  cmocka_unit_test(test_robust),
                                       cmocka_unit_test(test_sine),   cmocka_unit_test(test_wrong_class)};
    if (argc == 2 && strcmp(argv[1], "tune") == 0) {
        for (int k = 0; k < SOFTNESSES; k++)
            tune(k);
        return 0;
    }
    return cmocka_run_group_tests_name("tracking", tests, NULL, NULL);
}
