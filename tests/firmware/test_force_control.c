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

/* Runs the segments. Returns the largest force error relative to the target: during ramps of FORCE, and
 * during its dwells from 0.2 s after the ramp on. */
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
        if (!trajectory_forces(now) || !now->felt)
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

/* Refused: no force, more than the limit, a deepest place above contact. */
static void test_limits_of_force(void **state) {
    palp_wire_message none = bench_force(0, 0, 1, 100), backwards = bench_force(0, -1, 1, 100),
                      slow = bench_force(0, 1, 0, 100), much = bench_force(0, 24.1, 1, 100),
                      high = bench_force(0, 5, 5, 100), some = bench_force(0, 5, 5, 100),
                      start = bench_start(1, -0.5, 0, 0);
    palp_wire_message limits = bench_limits((palp_wire_limits){.force_uN = 4900000});
    bench b;
    (void)state;
    high.as.segment.deepest_nm = -1;
    open_soft(&b, 1, 1);
    assert_int_equal(bench_command(&b, &none), PALP_WIRE_RESULT_RANGE);
    assert_int_equal(bench_command(&b, &backwards), PALP_WIRE_RESULT_RANGE);
    assert_int_equal(bench_command(&b, &slow), PALP_WIRE_RESULT_RANGE);
    assert_int_equal(bench_command(&b, &much), PALP_WIRE_RESULT_RANGE);
    assert_int_equal(bench_command(&b, &high), PALP_WIRE_RESULT_RANGE);
    bench_accepted(&b, &some);
    bench_accepted(&b, &limits);
    assert_int_equal(bench_command(&b, &start), PALP_WIRE_RESULT_RANGE);
    bench_close(&b);
}

/* ---- contact that is lost ---- */

/* Starts a FORCE to so much and runs until the force holds, or for so many ticks. */
static void hold_force(bench *b, double newton, double deepest_mm, uint32_t ticks) {
    palp_wire_message force = bench_force(0, newton, newton, 60000), start = bench_start(1, -0.5, 0, 0);
    force.as.segment.deepest_nm = (int32_t)(1e6 * deepest_mm);
    bench_accepted(b, &force);
    bench_accepted(b, &start);
    bench_run(b, ticks);
}

static double depth_mm(const bench *b) {
    return 1e3 * (plant_look(b->plant).carriage_m - (double)b->app.contact_m);
}

/* A step of the loop after the specimen has gone, and not before: at its own w, and where a late sensor makes
 * the loop slower; from then on the plate is no faster than in the air, after what the last ticks gave it. */
static void test_a_specimen_that_goes(void **state) {
    static const double late_s[] = {0, 0.04, 0.0625}, targets_N[] = {0.3, 1, 5};
    (void)state;
    for (size_t i = 0; i < 3; i++) {
        for (size_t k = 0; k < 3; k++) {
            bench b;
            open_soft(&b, 1, 1);
            b.app.trajectory.force_w_s = trajectory_force_w_s((float)late_s[i]);
            hold_force(&b, targets_N[k], 0, 6000);
            const double step_ticks = 4000 / (double)b.app.trajectory.force_w_s, from_mm = depth_mm(&b);
            assert_int_equal(b.app.supervisor.fault, PALP_WIRE_FAULT_NONE);
            plant_inject(b.plant, PLANT_GONE);
            const uint32_t ticks = bench_until(&b, PALP_WIRE_STATE_FAULT, 2000);
            print_message("w %4.1f /s, %.1f N: stopped after %u ticks, %.2f mm deeper\n",
                          (double)b.app.trajectory.force_w_s, targets_N[k], ticks, depth_mm(&b) - from_mm);
            assert_int_equal(b.app.supervisor.fault, PALP_WIRE_FAULT_CONTACT_LOST);
            assert_in_range(ticks, step_ticks, step_ticks + 32);
            bench_run(&b, 200);
            assert_true(depth_mm(&b) - from_mm < 1e-3 * (step_ticks + 32) + 0.5);
            bench_close(&b);
        }
    }
}

/* Away before the run: the plate goes on as in the air, to the deepest place, and no further. */
static void test_no_deeper_than_said(void **state) {
    static const double deepest_mm[] = {0.5, 3, 0};
    (void)state;
    for (size_t i = 0; i < 3; i++) {
        bench b;
        open_soft(&b, 1, 1);
        plant_inject(b.plant, PLANT_GONE);
        hold_force(&b, 5, deepest_mm[i], 1);
        bench_until(&b, PALP_WIRE_STATE_FAULT, 60000);
        assert_int_equal(b.app.supervisor.fault, PALP_WIRE_FAULT_COMMAND_OUT_OF_RANGE);
        bench_run(&b, 200);
        const double end_mm = deepest_mm[i] > 0 ? deepest_mm[i] : 30 - 1e3 * (double)b.app.contact_m;
        bench_near(depth_mm(&b), end_mm, 0.05);
        bench_close(&b);
    }
}

/* A specimen whose top has sunk by a millimetre is found again, and pressed as well as before. */
static void test_a_specimen_that_has_sunk(void **state) {
    (void)state;
    for (int deep = 0; deep < 2; deep++) {
        bench b;
        open_soft(&b, deep ? 0.2 : 1, 1);
        b.app.contact_m -= 1e-3f;
        palp_wire_message creep = bench_force(0, 1, 1, 3000);
        bench_accepted(&b, &creep);
        assert_true(follow(&b, 1, 1).hold < 0.02);
        bench_close(&b);
    }
}

/* ---- the range in which the loop is stable ---- */

typedef struct answer {
    uint8_t result;
    double found_N_m, overshoot_N, ripple_N, hold_N; /* found 0: no contact; hold: mean error */
} answer;

/* Contact with a block of this stiffness, then a FORCE that is held for 8 s. */
static answer press(plant_settings s, double stiffness_N_m, double target_N) {
    palp_wire_message find = bench_find_contact(0.5, 0), tare = {.type = PALP_WIRE_TYPE_TARE};
    palp_wire_message force = bench_force(0, target_N, target_N, 8000), start = bench_start(1, -0.5, 50, 50);
    answer a = {.result = PALP_WIRE_RESULT_NO_CONTACT};
    double low = INFINITY, high = -INFINITY, sum = 0;
    int n = 0;
    bench b;
    s.specimen = PLANT_RIGID;
    s.rigid_N_m = stiffness_N_m;
    s.actuator.start_m = 1e-3;
    s.contact_m = 4e-3;
    tare.as.tare.samples = 500;
    bench_open(&b, &s);
    bench_home(&b);
    bench_accepted(&b, &tare);
    bench_accepted(&b, &find);
    bench_until(&b, PALP_WIRE_STATE_READY, 60000);
    a.found_N_m = b.app.contact_known ? (double)b.app.stiffness_N_m : 0;
    bench_accepted(&b, &force);
    a.result = bench_command(&b, &start);
    while (b.app.supervisor.state == PALP_WIRE_STATE_RUN) {
        bench_tick(&b);
        const double off_N = plant_look(b.plant).force_N - target_N;
        if (!trajectory_forces(&b.app.trajectory))
            continue;
        a.overshoot_N = fmax(a.overshoot_N, off_N);
        if (b.app.trajectory.tick < 2000)
            continue;
        low = fmin(low, off_N);
        high = fmax(high, off_N);
        sum += off_N;
        n++;
    }
    assert_int_equal(b.app.supervisor.fault, PALP_WIRE_FAULT_NONE);
    a.ripple_N = n > 0 ? high - low : 0;
    a.hold_N = n > 0 ? sum / n : 0;
    bench_close(&b);
    return a;
}

/* From 30 N/m to 2e5 N/m on the rig: to 5 mm or 5 N. What is left are the sensor's noise and, on what is
 * stiff, the friction of the drive, 0.15 N either way. */
static void test_stable_from_soft_to_stiff(void **state) {
    static const double stiffness[] = {30, 60, 200, 1000, 5000, 2e4, 5e4, 1e5, 2e5};
    (void)state;
    for (size_t i = 0; i < sizeof stiffness / sizeof stiffness[0]; i++) {
        for (uint64_t seed = 1; seed <= 3; seed++) {
            plant_settings s = plant_settings_default();
            const double k = stiffness[i], target_N = fmin(5, 5e-3 * k);
            s.sensor.seed = seed;
            const answer a = press(s, k, target_N);
            print_message("%7g N/m, found %7.4g: %.3g N, over %.2f %%, ripple %.1f mN, mean off %.2f mN\n", k,
                          a.found_N_m, target_N, 100 * a.overshoot_N / target_N, 1e3 * a.ripple_N,
                          1e3 * a.hold_N);
            assert_int_equal(a.result, PALP_WIRE_RESULT_DONE);
            bench_near(a.found_N_m, k, 0.25 * k);
            assert_true(a.overshoot_N < 0.02 * target_N);
            assert_true(a.ripple_N < 2e-3 + 0.02 * target_N);
            bench_near(a.hold_N, 0, 1e-3 + 0.002 * target_N);
        }
    }
}

/* Beyond it START says so: too stiff for the encoder to measure it, too soft for the sensor's noise. With
 * less noise and finer counts the range is wider, as the bounds say. */
static void test_refused_outside(void **state) {
    plant_settings s = plant_settings_default();
    (void)state;
    assert_int_equal(press(s, 3.5e5, 5).result, PALP_WIRE_RESULT_UNSTABLE);
    assert_int_equal(press(s, 1e6, 5).result, PALP_WIRE_RESULT_UNSTABLE);
    assert_int_equal(press(s, 10, 0.05).result, PALP_WIRE_RESULT_UNSTABLE);
    s.sensor.noise_N = 1e-3;
    assert_int_equal(press(s, 10, 0.05).result, PALP_WIRE_RESULT_DONE);
    s.sensor.noise_N = 1e-2;
    assert_int_equal(press(s, 50, 0.25).result, PALP_WIRE_RESULT_UNSTABLE);
    s = plant_settings_default();
    s.machine = PLANT_STEPPER_FAST;
    s.actuator.count_m = 0.625e-6;
    assert_int_equal(press(s, 3e5, 5).result, PALP_WIRE_RESULT_DONE);
    assert_int_equal(press(s, 6e5, 5).result, PALP_WIRE_RESULT_UNSTABLE);
}

/* Believed to be softer than it is by this factor, a specimen makes the loop faster by it: slower than the
 * control it is stable, faster it swings, which is a fault. */
static void test_swings_are_a_fault(void **state) {
    (void)state;
    for (int wrong = 0; wrong < 2; wrong++) {
        bench b;
        open_soft(&b, 5, 1);
        b.app.stiffness_N_m /= wrong ? 100 : 5;
        hold_force(&b, 0.5, 0, 6000);
        assert_int_equal(b.app.supervisor.fault,
                         wrong ? PALP_WIRE_FAULT_FORCE_OSCILLATES : PALP_WIRE_FAULT_NONE);
        bench_close(&b);
    }
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_tracks_on_six_softnesses),  cmocka_unit_test(test_turns_at_a_force),
    cmocka_unit_test(test_limits_of_force),           cmocka_unit_test(test_a_specimen_that_goes),
    cmocka_unit_test(test_no_deeper_than_said),       cmocka_unit_test(test_a_specimen_that_has_sunk),
    cmocka_unit_test(test_stable_from_soft_to_stiff), cmocka_unit_test(test_refused_outside),
    cmocka_unit_test(test_swings_are_a_fault),        {0},
};
