/* test_force_control.c: FORCE segments in the simulated indenter: to a force, held, on six softnesses;
 * limits. */
#include "app_bench.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

static void open_soft(bench *b, double scale, uint64_t seed) {
    plant_settings s = plant_settings_default();
    s.scale = scale;
    s.sensor.seed = seed;
    bench_open(b, &s);
    bench_contact(b);
}

/* Runs the segments; the largest distance of the true force from what is wanted, during the ramps and the
 * holds of FORCE (from 0.2 s after the ramp on), of the target. */
typedef struct tracking {
    double ramp, hold, overshoot;
} tracking;

static tracking follow(bench *b, uint8_t segments, double target_N) {
    palp_wire_message start = bench_start(segments, -0.5, 50, 50);
    tracking t = {0, 0, 0};
    uint32_t held = 0;
    bench_accepted(b, &start);
    while (b->app.supervisor.state == PALP_WIRE_STATE_RUN) {
        bench_tick(b);
        const trajectory *now = &b->app.trajectory;
        const double off = plant_look(b->plant).force_N - (double)now->wanted_N;
        if (b->app.phase != 2 || !now->wants || now->list[now->current].kind != PALP_WIRE_SEGMENT_FORCE ||
            now->current == now->count)
            continue;
        held = now->tick > 0 ? held + 1 : 0;
        if (held == 0 && (double)now->wanted_N > 0.1 * target_N)
            t.ramp = fmax(t.ramp, fabs(off) / target_N);
        if (held > 200)
            t.hold = fmax(t.hold, fabs(off) / target_N);
        if (now->list[now->current].target_N > 0.99f * (float)target_N)
            t.overshoot = fmax(t.overshoot, (plant_look(b->plant).force_N - target_N) / target_N);
    }
    assert_int_equal(b->app.supervisor.fault, PALP_WIRE_FAULT_NONE);
    return t;
}

/* Creep: up in 1 s, held for 10 s. A preload, more, and back to it. */
static void test_tracks_on_six_softnesses(void **state) {
    static const double scale[] = {0.2, 0.45, 1, 2, 3.2, 5};
    (void)state;
    for (size_t i = 0; i < 6; i++) {
        for (int stiff = 0; stiff < 2; stiff++) { /* to about 2 and 6 mm of depth */
            const double target = (stiff ? 3.5 : 1.0) * scale[i];
            palp_wire_message creep = bench_force(0, target, target, 10000);
            palp_wire_message steps[] = {bench_force(0, 0.2 * target, 0.2 * target, 2000),
                                         bench_force(1, target, target, 3000),
                                         bench_force(2, 0.2 * target, target, 3000)};
            bench b;
            open_soft(&b, scale[i], 1 + i);
            bench_accepted(&b, &creep);
            const tracking one = follow(&b, 1, target);
            for (int k = 0; k < 3; k++)
                bench_accepted(&b, &steps[k]);
            const tracking three = follow(&b, 3, target);
            print_message("%.2f x, %5.2f N: ramp %.2f %%, hold %.2f %%, over %.2f %%; steps: ramp %.2f %%, "
                          "hold %.2f %%\n",
                          scale[i], target, 100 * one.ramp, 100 * one.hold, 100 * one.overshoot,
                          100 * three.ramp, 100 * three.hold);
            assert_true(one.ramp < 0.01 && one.hold < 0.01 && one.overshoot < 0.02);
            assert_true(three.ramp < 0.02 && three.hold < 0.01);
            bench_close(&b);
        }
    }
}

/* Turns at a force: no dwell there, and the way back begins. */
static void test_turns_at_a_force(void **state) {
    palp_wire_message up = bench_force(0, 1.5, 1.5, 0), back = bench_move(1, 0, 5),
                      start = bench_start(2, -0.5, 0, 0);
    double most = 0;
    bench b;
    (void)state;
    open_soft(&b, 1, 1);
    bench_accepted(&b, &up);
    bench_accepted(&b, &back);
    bench_accepted(&b, &start);
    while (b.app.supervisor.state == PALP_WIRE_STATE_RUN) {
        bench_tick(&b);
        most = fmax(most, plant_look(b.plant).force_N);
    }
    assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_READY);
    bench_near(most, 1.5, 0.05);
    bench_close(&b);
}

/* Refused: no force, more than the limit. Nothing there to press: the end of the travel stops it. */
static void test_limits_of_force(void **state) {
    palp_wire_message none = bench_force(0, 0, 1, 100), backwards = bench_force(0, -1, 1, 100),
                      slow = bench_force(0, 1, 0, 100), much = bench_force(0, 24.1, 1, 100),
                      some = bench_force(0, 5, 5, 100), start = bench_start(1, -0.5, 0, 0);
    palp_wire_message limits = bench_limits((palp_wire_limits){.force_uN = 4900000});
    bench b;
    (void)state;
    open_soft(&b, 1, 1);
    assert_int_equal(bench_command(&b, &none), PALP_WIRE_RESULT_RANGE);
    assert_int_equal(bench_command(&b, &backwards), PALP_WIRE_RESULT_RANGE);
    assert_int_equal(bench_command(&b, &slow), PALP_WIRE_RESULT_RANGE);
    assert_int_equal(bench_command(&b, &much), PALP_WIRE_RESULT_RANGE);
    bench_accepted(&b, &some);
    bench_accepted(&b, &limits);
    assert_int_equal(bench_command(&b, &start), PALP_WIRE_RESULT_RANGE);
    bench_close(&b);
    plant_settings s = plant_settings_default();
    s.specimen = PLANT_AIR;
    bench_open(&b, &s);
    bench_home(&b);
    b.app.contact_known = true; /* the specimen has been taken away since */
    b.app.contact_m = 12e-3f;
    b.app.stiffness_N_m = 477.0f;
    bench_accepted(&b, &some);
    bench_accepted(&b, &start);
    bench_until(&b, PALP_WIRE_STATE_FAULT, 60000);
    assert_int_equal(b.app.supervisor.fault, PALP_WIRE_FAULT_COMMAND_OUT_OF_RANGE);
    assert_true(plant_look(b.plant).carriage_m < 30.4e-3);
    bench_close(&b);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_tracks_on_six_softnesses),
    cmocka_unit_test(test_turns_at_a_force),
    cmocka_unit_test(test_limits_of_force),
    {0},
};
