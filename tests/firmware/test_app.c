/* test_app.c: the app end to end around the simulated indenter: homing, contact, runs, heat. */
#include "app_bench.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* ---- start ---- */

static void test_starts(void **state) {
    palp_wire_message hello = {.type = PALP_WIRE_TYPE_HELLO};
    bench b;
    (void)state;
    bench_open(&b, NULL);
    assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_BOOT);
    bench_tick(&b);
    assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_IDLE);
    assert_int_equal(b.statuses, 1);
    hello.as.hello.protocol = PALP_WIRE_VERSION;
    bench_accepted(&b, &hello);
    const palp_wire_info *info = &bench_answer(&b, PALP_WIRE_TYPE_INFO)->as.info;
    assert_int_equal(info->protocol, PALP_WIRE_VERSION);
    assert_int_equal(info->tick_Hz, 1000);
    assert_int_equal(info->count_pm, 1000000);
    assert_int_equal(info->travel_nm, 30000000);
    assert_int_equal(info->force_uN, 24000000);
    assert_int_equal(info->serial, 7);
    assert_int_equal(info->simulated, 1);
    assert_memory_equal(info->board, "test\0\0\0\0\0\0\0\0\0\0\0\0", PALP_WIRE_NAME);
    assert_true(sizeof(app) <= 24 * 1024);
    bench_close(&b);
}

/* A board whose clock or encoder did not come up never moves; without a sensor it can still be talked to. */
static void test_unfit_board(void **state) {
    bench b;
    (void)state;
    bench_open(&b, NULL);
    for (uint8_t failed = 0; failed < 8; failed++) {
        bench_restart(&b, 0, failed);
        bench_run(&b, 10);
        assert_int_equal(b.app.supervisor.state, (failed & 5) ? PALP_WIRE_STATE_BOOT : PALP_WIRE_STATE_IDLE);
        assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_HOME),
                         (failed & 5) ? PALP_WIRE_RESULT_STATE : PALP_WIRE_RESULT_DONE);
        assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_GET_STATUS), PALP_WIRE_RESULT_DONE);
    }
    bench_close(&b);
}

/* ---- homing ---- */

/* From below the switch, from on it and from beyond it: the zero is where it closes. */
static void test_homes(void **state) {
    static const double start_mm[] = {5, 29, 0.2, 0, -0.4};
    (void)state;
    for (size_t i = 0; i < sizeof start_mm / sizeof start_mm[0]; i++) {
        plant_settings s = plant_settings_default();
        bench b;
        s.specimen = PLANT_AIR;
        s.actuator.start_m = start_mm[i] * 1e-3;
        bench_open(&b, &s);
        bench_home(&b);
        assert_true(b.app.homed && !b.app.contact_known);
        bench_near(plant_look(b.plant).carriage_m, 1e-3, 2e-5);
        bench_near(b.app.position_m, 1e-3, 2e-5);
        assert_true(b.status.homed && b.status.state == PALP_WIRE_STATE_READY);
        bench_near(b.status.position, 1000, 20);
        bench_close(&b);
    }
}

static void test_stops_homing(void **state) {
    bench b;
    (void)state;
    bench_open(&b, NULL);
    bench_tick(&b);
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_HOME), PALP_WIRE_RESULT_DONE);
    bench_run(&b, 100);
    assert_true(b.out.motor_on);
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_STOP), PALP_WIRE_RESULT_DONE);
    assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_IDLE);
    assert_false(b.app.homed || b.out.motor_on);
    bench_home(&b);
    bench_close(&b);
}

/* ---- contact ---- */

static void test_finds_contact(void **state) {
    palp_wire_message find = bench_find_contact(0, 0);
    bench b;
    (void)state;
    bench_open(&b, NULL);
    bench_home(&b);
    bench_accepted(&b, &find);
    assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_APPROACH);
    bench_until(&b, PALP_WIRE_STATE_RETRACT, 30000);
    assert_true(b.app.contact_known);
    bench_near(b.app.contact_m, 12e-3, 2e-5);
    bench_near(b.app.stiffness_N_m, 477, 30);
    assert_int_equal(b.app.softness, 2);
    bench_until(&b, PALP_WIRE_STATE_READY, 2000);
    bench_near(plant_look(b.plant).carriage_m, b.app.contact_m - 1e-3, 2e-5);
    assert_true(b.status.contact_known);
    bench_near(b.status.contact, 12000, 20);
    bench_near(b.status.stiffness_mN_m, 477e3, 30e3);
    bench_close(&b);
}

static void test_classes_of_softness(void **state) {
    static const double scale[] = {0.2, 0.45, 1, 2, 3.2, 5};
    palp_wire_message find = bench_find_contact(0.5, 0), by_hand = {.type = PALP_WIRE_TYPE_SELECT_GAINS};
    (void)state;
    for (uint8_t i = 0; i < GAINS_CLASSES; i++) {
        plant_settings s = plant_settings_default();
        bench b;
        s.scale = scale[i];
        s.contact_m = 4e-3;
        s.actuator.start_m = 2e-3;
        bench_open(&b, &s);
        bench_home(&b);
        assert_int_equal(b.app.softness, GAINS_MIDDLE);
        bench_accepted(&b, &find);
        bench_until(&b, PALP_WIRE_STATE_READY, 10000);
        assert_int_equal(b.app.softness, i);
        by_hand.as.select_gains.softness = 5;
        bench_accepted(&b, &by_hand);
        bench_accepted(&b, &find);
        bench_until(&b, PALP_WIRE_STATE_READY, 10000);
        assert_int_equal(b.app.softness, 5);
        by_hand.as.select_gains.softness = PALP_WIRE_GAINS_AUTO;
        bench_accepted(&b, &by_hand);
        assert_int_equal(b.app.softness, i);
        bench_close(&b);
    }
}

/* Nothing there: back to where it began, contact unknown, whether the way or the travel ended it. */
static void test_finds_nothing(void **state) {
    static const double travel_mm[] = {3, 0};
    (void)state;
    for (size_t i = 0; i < 2; i++) {
        palp_wire_message find = bench_find_contact(10, travel_mm[i]);
        plant_settings s = plant_settings_default();
        double lowest = 0;
        bench b;
        s.specimen = PLANT_AIR;
        bench_open(&b, &s);
        bench_home(&b);
        bench_accepted(&b, &find);
        while (b.app.supervisor.state != PALP_WIRE_STATE_READY) {
            bench_tick(&b);
            lowest = fmax(lowest, plant_look(b.plant).carriage_m);
            assert_int_not_equal(b.app.supervisor.state, PALP_WIRE_STATE_FAULT);
        }
        bench_near(lowest, travel_mm[i] > 0 ? 4e-3 : 30e-3, 1e-4);
        assert_false(b.app.contact_known || b.status.contact_known);
        bench_near(plant_look(b.plant).carriage_m, 1e-3, 2e-5);
        palp_wire_message move = bench_move(0, 1, 1), start = bench_start(1, -1, 0, 0);
        bench_accepted(&b, &move);
        assert_int_equal(bench_command(&b, &start), PALP_WIRE_RESULT_NO_CONTACT);
        bench_close(&b);
    }
}

static void test_rigid_block(void **state) {
    palp_wire_message find = bench_find_contact(0.5, 0);
    plant_settings s = plant_settings_default();
    bench b;
    (void)state;
    s.specimen = PLANT_RIGID;
    s.contact_m = 4e-3;
    s.actuator.start_m = 2e-3;
    bench_open(&b, &s);
    bench_home(&b);
    bench_accepted(&b, &find);
    bench_until(&b, PALP_WIRE_STATE_READY, 10000);
    assert_true(b.app.contact_known);
    bench_near(b.app.contact_m, 4e-3, 1e-5);
    assert_int_equal(b.app.softness, GAINS_CLASSES - 1);
    bench_close(&b);
}

/* ---- runs ---- */

static size_t count_flagged(const bench *b, uint16_t flag) {
    size_t n = 0;
    for (size_t i = 0; i < b->n_samples; i++)
        n += (b->sample[i].flags & flag) != 0;
    return n;
}

static void check_whole(const bench *b) {
    assert_int_equal(b->damaged, 0);
    assert_int_equal(b->lost, 0);
    for (size_t i = 1; i < b->n_samples; i++)
        assert_int_equal(b->sample[i].tick, b->sample[i - 1].tick + 1);
}

static void test_ramp_and_hold(void **state) {
    palp_wire_message streaming = bench_stream(true), ramp = bench_move(0, 3, 3), hold = bench_hold(1, 1500);
    palp_wire_message start = bench_start(2, -1, 700, 400);
    bench b;
    double deepest = 0, square = 0;
    size_t in_ramp = 0;
    (void)state;
    bench_open(&b, NULL);
    bench_contact(&b);
    bench_accepted(&b, &streaming);
    bench_accepted(&b, &ramp);
    bench_accepted(&b, &hold);
    bench_accepted(&b, &start);
    bench_until(&b, PALP_WIRE_STATE_READY, 20000);
    bench_run(&b, 10);
    check_whole(&b);
    const size_t air = 700, segments = 1340 + 1500, back = 1, after = 400;
    bench_near((double)count_flagged(&b, PALP_WIRE_FLAG_TRAJECTORY), (double)segments, 2);
    bench_near((double)count_flagged(&b, PALP_WIRE_FLAG_RECORD),
               (double)(air + segments + back * 801 + after), 10);
    for (size_t i = 0; i < b.n_samples; i++) {
        const sample *s = &b.sample[i];
        const double depth = s->position * 1e-6 - (double)b.app.contact_m;
        deepest = fmax(deepest, depth);
        if ((s->flags & PALP_WIRE_FLAG_TRAJECTORY) && s->flags >> 8 == 0) {
            in_ramp++;
            square += s->error * 1e-6 * s->error * 1e-6;
        }
        if ((s->flags & PALP_WIRE_FLAG_TRAJECTORY) && s->flags >> 8 == 1 && i > 200)
            bench_near(depth, 3e-3, 6e-5);
        assert_true((s->flags & PALP_WIRE_FLAG_MOTOR) != 0);
    }
    bench_near(deepest, 3e-3, 6e-5);
    assert_true(sqrt(square / (double)in_ramp) < 3e-5);
    bench_near(plant_look(b.plant).carriage_m, (double)b.app.contact_m - 1e-3, 2e-5);
    bench_close(&b);
}

/* Turning points of the position among the samples that follow the segments. */
static int turns(const bench *b, int32_t margin) {
    int n = 0, way = 1;
    int32_t extreme = INT32_MIN;
    for (size_t i = 0; i < b->n_samples; i++) {
        const int32_t x = way * b->sample[i].position;
        if (!(b->sample[i].flags & PALP_WIRE_FLAG_TRAJECTORY))
            continue;
        if (x > extreme) {
            extreme = x;
        } else if (x < extreme - margin) {
            n++;
            way = -way;
            extreme = -x;
        }
    }
    return n;
}

static void test_cycles(void **state) {
    palp_wire_message streaming = bench_stream(true), ramp = bench_move(0, 1, 5), cycle = bench_move(1, 2, 5);
    palp_wire_message start = bench_start(2, -0.5, 0, 0);
    bench b;
    (void)state;
    cycle.as.segment.kind = PALP_WIRE_SEGMENT_CYCLE;
    cycle.as.segment.cycles = 4;
    bench_open(&b, NULL);
    bench_contact(&b);
    bench_accepted(&b, &streaming);
    bench_accepted(&b, &ramp);
    bench_accepted(&b, &cycle);
    bench_accepted(&b, &start);
    bench_until(&b, PALP_WIRE_STATE_READY, 20000);
    bench_run(&b, 10);
    check_whole(&b);
    assert_int_equal(turns(&b, 500), 2 * 4 - 1);
    bench_close(&b);
}

static void test_every_segment(void **state) {
    palp_wire_message streaming = bench_stream(true), first = bench_move(0, 2, 5), hold = bench_hold(0, 3);
    palp_wire_message start = bench_start(PALP_WIRE_SEGMENTS, -0.5, 0, 0);
    bench b;
    uint32_t seen = 0;
    (void)state;
    bench_open(&b, NULL);
    bench_contact(&b);
    bench_accepted(&b, &streaming);
    bench_accepted(&b, &first);
    assert_int_equal(bench_command(&b, &start), PALP_WIRE_RESULT_RANGE);
    for (uint8_t i = 1; i < PALP_WIRE_SEGMENTS; i++) {
        hold.as.segment.index = i;
        bench_accepted(&b, &hold);
    }
    bench_accepted(&b, &start);
    bench_until(&b, PALP_WIRE_STATE_READY, 20000);
    bench_run(&b, 10);
    for (size_t i = 0; i < b.n_samples; i++)
        if (b.sample[i].flags & PALP_WIRE_FLAG_TRAJECTORY)
            seen |= 1u << (b.sample[i].flags >> 8);
    assert_true(seen == UINT32_MAX);
    bench_close(&b);
}

/* In the middle of a fast ramp: withdraws to the start without a jump, and can run again. */
static void test_stop_in_the_middle(void **state) {
    palp_wire_message streaming = bench_stream(true), ramp = bench_move(0, 6, 20),
                      start = bench_start(1, -1, 100, 100);
    bench b;
    (void)state;
    bench_open(&b, NULL);
    bench_contact(&b);
    bench_accepted(&b, &streaming);
    bench_accepted(&b, &ramp);
    bench_accepted(&b, &start);
    while (plant_look(b.plant).depth_m < 3e-3)
        bench_tick(&b);
    b.n_samples = 0;
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_STOP), PALP_WIRE_RESULT_DONE);
    assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_RETRACT);
    bench_until(&b, PALP_WIRE_STATE_READY, 5000);
    bench_near(plant_look(b.plant).carriage_m, (double)b.app.contact_m - 1e-3, 2e-5);
    for (size_t i = 1; i < b.n_samples; i++) {
        assert_true(abs(b.sample[i].position - b.sample[i - 1].position) < 30);
        assert_true(abs(b.sample[i].error) < 200);
    }
    bench_accepted(&b, &start);
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_STOP), PALP_WIRE_RESULT_DONE);
    bench_until(&b, PALP_WIRE_STATE_READY, 5000);
    bench_close(&b);
}

static void test_stops_the_search(void **state) {
    palp_wire_message find = bench_find_contact(5, 0);
    bench b;
    (void)state;
    bench_open(&b, NULL);
    bench_home(&b);
    bench_accepted(&b, &find);
    bench_run(&b, 500);
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_STOP), PALP_WIRE_RESULT_DONE);
    bench_until(&b, PALP_WIRE_STATE_READY, 5000);
    assert_false(b.app.contact_known);
    bench_near(plant_look(b.plant).carriage_m, 1e-3, 2e-5);
    bench_close(&b);
}

/* From within the specimen, where a fault may have left it. */
static void test_starts_pressed(void **state) {
    palp_wire_message hold = bench_hold(0, 100), start = bench_start(1, 2, 100, 0);
    bench b;
    (void)state;
    bench_open(&b, NULL);
    bench_contact(&b);
    bench_accepted(&b, &hold);
    for (int i = 0; i < 2; i++) {
        bench_accepted(&b, &start);
        bench_until(&b, PALP_WIRE_STATE_READY, 5000);
        start.as.start.start_nm = 1000000;
    }
    bench_near(b.app.position_m, b.app.contact_m + 1e-3f, 5e-5);
    bench_close(&b);
}

/* A little out of its travel, as a hand may leave it: it may come back in. */
static void test_starts_outside(void **state) {
    palp_wire_message hold = bench_hold(0, 100), start = bench_start(1, -2, 10, 0);
    palp_wire_message limits = bench_limits((palp_wire_limits){.travel_nm = 10900000});
    bench b;
    (void)state;
    bench_open(&b, NULL);
    bench_contact(&b);
    bench_accepted(&b, &limits);
    bench_accepted(&b, &hold);
    assert_true(b.app.position_m > b.app.limits.travel_m);
    bench_accepted(&b, &start);
    bench_until(&b, PALP_WIRE_STATE_READY, 5000);
    bench_near(b.app.position_m, b.app.contact_m - 2e-3f, 5e-5);
    bench_close(&b);
}

/* ---- limits ---- */

/* A hot motor is held back, not stopped; hotter, it is stopped. */
static void test_derates(void **state) {
    plant_settings s = plant_settings_default();
    palp_wire_message streaming = bench_stream(true);
    bench b;
    (void)state;
    s.actuator.ambient_C = 100;
    bench_open(&b, &s);
    bench_accepted(&b, &streaming);
    bench_contact(&b);
    bench_simple(&b, PALP_WIRE_TYPE_GET_STATUS);
    bench_near(b.status.derating_permille, 500, 20);
    bench_near(b.status.case_cC, 10000, 100);
    assert_int_equal(count_flagged(&b, PALP_WIRE_FLAG_DERATED), b.n_samples);
    palp_wire_message limits = bench_limits((palp_wire_limits){.temperature_cC = 9500});
    bench_accepted(&b, &limits);
    bench_tick(&b);
    assert_int_equal(b.app.supervisor.fault, PALP_WIRE_FAULT_OVER_TEMPERATURE);
    bench_close(&b);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_starts),
    cmocka_unit_test(test_unfit_board),
    cmocka_unit_test(test_homes),
    cmocka_unit_test(test_stops_homing),
    cmocka_unit_test(test_finds_contact),
    cmocka_unit_test(test_classes_of_softness),
    cmocka_unit_test(test_finds_nothing),
    cmocka_unit_test(test_rigid_block),
    cmocka_unit_test(test_ramp_and_hold),
    cmocka_unit_test(test_cycles),
    cmocka_unit_test(test_every_segment),
    cmocka_unit_test(test_stop_in_the_middle),
    cmocka_unit_test(test_stops_the_search),
    cmocka_unit_test(test_starts_pressed),
    cmocka_unit_test(test_starts_outside),
    cmocka_unit_test(test_derates),
    {0},
};
