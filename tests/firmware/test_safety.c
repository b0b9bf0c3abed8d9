/* test_safety.c: a carriage that is not balanced, stops under load, boards and encoders that are not fit. */
#include "faults_make.h"

#include <math.h>
#include <stdlib.h>

/* ---- a carriage that rises or falls by itself ---- */

static plant_settings with_lift(double lift_N) {
    plant_settings s = plant_settings_default();
    s.actuator.lift_N = lift_N;
    return s;
}

/* Beyond friction it lies at one of its stops at power-on. */
static double lies_at(double lift_N) {
    return lift_N > 0.15 ? -1e-3 : lift_N < -0.15 ? 31e-3 : 5e-3;
}

static void stays(bench *b, uint32_t ticks) {
    const double at_m = plant_look(b->plant).carriage_m;
    for (uint32_t i = 0; i < ticks; i++) {
        bench_tick(b);
        assert_int_equal(b->app.supervisor.state, PALP_WIRE_STATE_READY);
        bench_near(plant_look(b->plant).carriage_m, at_m, 3e-5);
    }
}

/* Homed from where it lies, tared, and held for 10 s each time that it is ready; one run and its way back. */
static void test_holds_in_ready(void **state) {
    static const double lift_N[] = {-2, -0.5, -0.2, 0, 0.2, 0.5, 2};
    (void)state;
    for (size_t i = 0; i < sizeof lift_N / sizeof lift_N[0]; i++) {
        palp_wire_message tare = {.type = PALP_WIRE_TYPE_TARE, .as.tare = {.samples = 4096}};
        palp_wire_message ramp = bench_move(0, 3, 3), start = bench_start(1, -1, 500, 500);
        plant_settings s = with_lift(lift_N[i]);
        bench b;
        s.specimen = PLANT_AIR;
        s.actuator.start_m = lies_at(lift_N[i]);
        bench_open(&b, &s);
        bench_home(&b);
        stays(&b, 10000);
        bench_accepted(&b, &tare);
        stays(&b, 5000);
        bench_close(&b);

        s.specimen = PLANT_MODEL;
        s.actuator.start_m = lift_N[i] > 0.15 ? -1e-3 : 5e-3; /* the specimen is in the way down */
        bench_open(&b, &s);
        bench_contact(&b);
        bench_near(b.app.contact_m, 12e-3, 2e-5);
        stays(&b, 10000);
        bench_accepted(&b, &ramp);
        bench_accepted(&b, &start);
        bench_until(&b, PALP_WIRE_STATE_READY, 10000);
        stays(&b, 10000);
        bench_close(&b);
    }
}

/* No host: it lets go after its timeout, without a fault; the position stays known, and a command holds it
 * again. */
static void test_lets_go_without_a_host(void **state) {
    palp_wire_message find = bench_find_contact(5, 0);
    bench b;
    (void)state;
    bench_open(&b, NULL);
    bench_home(&b);
    b.mute = true;
    bench_run(&b, 4000);
    assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_READY);
    bench_until(&b, PALP_WIRE_STATE_IDLE, 1100);
    assert_false(b.out.motor_on);
    assert_true(b.app.homed);
    b.mute = false;
    bench_accepted(&b, &find);
    assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_APPROACH);
    bench_until(&b, PALP_WIRE_STATE_READY, 10000);
    assert_true(b.app.contact_known);
    bench_close(&b);
}

/* STOP at rest: free to be moved by hand. */
static void test_stop_lets_go(void **state) {
    bench b;
    (void)state;
    bench_open(&b, NULL);
    bench_home(&b);
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_STOP), PALP_WIRE_RESULT_DONE);
    assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_IDLE);
    assert_false(b.out.motor_on);
    assert_true(b.app.homed);
    bench_close(&b);
}

/* ---- a stop under load ---- */

/* Pressed 7 mm into the phantom; how fast the plate comes up after a fault, and where it ends. */
static double fastest_after(bench *b, plant_fault fault) {
    palp_wire_message ramp = bench_move(0, 7, 20), hold = bench_hold(1, 3000),
                      start = bench_start(2, -1, 0, 0);
    double fastest = 0;
    bench_contact(b);
    bench_accepted(b, &ramp);
    bench_accepted(b, &hold);
    bench_accepted(b, &start);
    while (plant_look(b->plant).depth_m < 6.99e-3)
        bench_tick(b);
    assert_true(plant_look(b->plant).force_N > 5);
    plant_inject(b->plant, fault);
    bench_until(b, PALP_WIRE_STATE_FAULT, 5);
    for (int i = 0; i < 20000; i++) {
        bench_tick(b);
        fastest = fmax(fastest, -plant_look(b->plant).velocity_m_s);
    }
    return fastest;
}

/* It is braked; where it has risen out of its travel it is homed from there. */
static void test_stop_under_load(void **state) {
    static const double lift_N[] = {-0.5, 0, 0.2, 0.5, 2};
    static const plant_fault faults[] = {PLANT_EMERGENCY, PLANT_SILENT, PLANT_ENCODER};
    (void)state;
    for (size_t i = 0; i < sizeof lift_N / sizeof lift_N[0]; i++) {
        for (size_t k = 0; k < sizeof faults / sizeof faults[0]; k++) {
            plant_settings s = with_lift(lift_N[i]);
            s.scale = 2;
            bench b;
            bench_open(&b, &s);
            const double fastest = fastest_after(&b, faults[k]);
            if (k == 0)
                print_message("lift %4.1f N: up at %3.0f mm/s at most, ends at %5.2f mm\n", lift_N[i],
                              1e3 * fastest, 1e3 * plant_look(b.plant).carriage_m);
            assert_true(fastest < 0.17);
            plant_lift(b.plant, faults[k]);
            bench_run(&b, 2);
            assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_CLEAR_FAULT), PALP_WIRE_RESULT_DONE);
            const bool lost = lift_N[i] > 0.15 || faults[k] == PLANT_ENCODER;
            assert_int_equal(b.app.supervisor.state, lost ? PALP_WIRE_STATE_IDLE : PALP_WIRE_STATE_READY);
            assert_int_equal(b.app.homed, !lost);
            bench_home(&b);
            bench_near(plant_look(b.plant).carriage_m, 1e-3, 2e-5);
            bench_close(&b);
        }
    }
}

/* ---- what is not fit to move ---- */

/* A board that did not come up, and was restarted by its watchdog: clearing that does not make it fit. */
static void test_unfit_stays_unfit(void **state) {
    static const uint8_t failed[] = {APP_CLOCK_FAILED, APP_ENCODER_FAILED};
    static const uint8_t cause[] = {APP_RESET_WATCHDOG, APP_RESET_STACK, APP_RESET_BROWN_OUT};
    (void)state;
    for (size_t i = 0; i < 2; i++) {
        for (size_t k = 0; k < 3; k++) {
            bench b;
            bench_open(&b, NULL);
            plant_inject(b.plant, PLANT_ENCODER);
            bench_restart(&b, cause[k], failed[i]);
            bench_run(&b, 500);
            assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_CLEAR_FAULT), PALP_WIRE_RESULT_PERSISTS);
            assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_HOME), PALP_WIRE_RESULT_FAULTED);
            assert_false(b.out.motor_on);
            plant_lift(b.plant, PLANT_ENCODER);
            bench_run(&b, 99); /* one tick has sensed the signal's loss still */
            assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_CLEAR_FAULT), PALP_WIRE_RESULT_PERSISTS);
            bench_run(&b, 5);
            const bool fit =
                failed[i] == APP_ENCODER_FAILED; /* it has its signal again; no crystal comes back */
            assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_CLEAR_FAULT),
                             fit ? PALP_WIRE_RESULT_DONE : PALP_WIRE_RESULT_PERSISTS);
            if (fit)
                bench_home(&b);
            bench_close(&b);
        }
    }
}

/* In BOOT, too: it waits there for its encoder. */
static void test_boot_waits_for_the_encoder(void **state) {
    bench b;
    (void)state;
    bench_open(&b, NULL);
    plant_inject(b.plant, PLANT_ENCODER);
    bench_restart(&b, APP_RESET_POWER, APP_ENCODER_FAILED);
    bench_run(&b, 1000);
    assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_BOOT);
    plant_lift(b.plant, PLANT_ENCODER);
    bench_run(&b, 105);
    bench_home(&b);
    bench_close(&b);
}

/* An encoder that stops counting while the plate rests gives no error that could be seen. */
static void test_encoder_lost_in_a_dwell(void **state) {
    palp_wire_message hold = bench_hold(0, 60000), start = bench_start(1, 2, 0, 0);
    bench b;
    (void)state;
    bench_open(&b, NULL);
    bench_contact(&b);
    bench_accepted(&b, &hold);
    bench_accepted(&b, &start);
    bench_run(&b, 5000);
    plant_inject(b.plant, PLANT_ENCODER);
    bench_tick(&b);
    plant_lift(b.plant, PLANT_ENCODER); /* a glitch */
    bench_run(&b, 100);
    assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_RUN);
    plant_inject(b.plant, PLANT_ENCODER);
    assert_int_equal(bench_until(&b, PALP_WIRE_STATE_FAULT, 10), 3);
    assert_int_equal(b.app.supervisor.fault, PALP_WIRE_FAULT_ENCODER_LOST);
    assert_false(b.app.homed || b.app.contact_known);
    bench_close(&b);
}

/* ---- programs and limits ---- */

static palp_wire_message wave(uint8_t kind, double amplitude_mm) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_SEGMENT};
    m.as.segment = (palp_wire_segment){.index = 1,
                                       .kind = kind,
                                       .target_nm = (int32_t)(amplitude_mm * 1e6),
                                       .duration_ms = 5000,
                                       .frequency_mHz = 1000,
                                       .frequency_end_mHz = 2000,
                                       .cycles = 2};
    return m;
}

/* Segments that leave the travel are refused at START, not met an hour later; contact is 12 mm below home. */
static void test_start_checks_the_travel(void **state) {
    palp_wire_message go = bench_move(0, 5, 5), start = bench_start(2, -1, 0, 0);
    palp_wire_message wrong[] = {bench_move(1, 18.1, 5),
                                 bench_move(1, -12.1, 5),
                                 bench_move(1, 18.1, 5),
                                 wave(PALP_WIRE_SEGMENT_SINE, 13.1),
                                 wave(PALP_WIRE_SEGMENT_SINE, -13.1),
                                 wave(PALP_WIRE_SEGMENT_SWEEP, 13.1)};
    palp_wire_message right[] = {bench_move(1, 17.9, 5), bench_move(1, -11.9, 5),
                                 wave(PALP_WIRE_SEGMENT_SINE, 12.9)};
    palp_wire_message narrow = bench_limits((palp_wire_limits){.travel_nm = 17500000});
    bench b;
    (void)state;
    wrong[2].as.segment.kind = PALP_WIRE_SEGMENT_CYCLE;
    wrong[2].as.segment.cycles = 1;
    bench_open(&b, NULL);
    bench_contact(&b);
    bench_accepted(&b, &go);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        bench_accepted(&b, &wrong[i]);
        assert_int_equal(bench_command(&b, &start), PALP_WIRE_RESULT_RANGE);
        assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_READY);
    }
    for (size_t i = 0; i < sizeof right / sizeof right[0]; i++) {
        bench_accepted(&b, &right[i]);
        bench_accepted(&b, &start);
        assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_STOP), PALP_WIRE_RESULT_DONE);
        bench_until(&b, PALP_WIRE_STATE_READY, 1000);
    }
    right[0] =
        bench_move(1, 6, 5); /* 18 mm below home: within the machine's travel, not within the session's */
    bench_accepted(&b, &right[0]);
    bench_accepted(&b, &narrow);
    assert_int_equal(bench_command(&b, &start), PALP_WIRE_RESULT_RANGE);
    bench_close(&b);
}

static palp_wire_limits_now limits_of(bench *b) {
    assert_int_equal(bench_simple(b, PALP_WIRE_TYPE_GET_LIMITS), PALP_WIRE_RESULT_DONE);
    return bench_answer(b, PALP_WIRE_TYPE_LIMITS_NOW)->as.limits_now;
}

#define ALIKE(a, b)                                                                                          \
    ((a).force_uN == (b).force_uN && (a).travel_nm == (b).travel_nm &&                                       \
     (a).following_nm == (b).following_nm && (a).temperature_cC == (b).temperature_cC &&                     \
     (a).host_timeout_ms == (b).host_timeout_ms && (a).overflow_samples == (b).overflow_samples)

static void test_limits_end_with_the_session(void **state) {
    palp_wire_message narrow = bench_limits((palp_wire_limits){1000000, 20000000, 500000, 9000, 700, 10});
    palp_wire_message hello = {.type = PALP_WIRE_TYPE_HELLO, .as.hello = {PALP_WIRE_VERSION}};
    palp_wire_message find = bench_find_contact(5, 0);
    bench b;
    (void)state;
    bench_open(&b, NULL);
    const palp_wire_limits_now own = limits_of(&b);
    assert_true(own.force_uN == 24000000 && own.travel_nm == 30000000 && own.following_nm == 1000000 &&
                own.temperature_cC == 11000 && own.host_timeout_ms == 5000 && own.overflow_samples == 1000);
    bench_home(&b);
    bench_accepted(&b, &narrow);
    palp_wire_limits_now now = limits_of(&b);
    assert_true(ALIKE(now, narrow.as.limits));
    bench_accepted(&b, &find);
    bench_accepted(&b, &hello); /* the motion goes on within the limits that it was started with */
    now = limits_of(&b);
    assert_true(ALIKE(now, narrow.as.limits));
    bench_until(&b, PALP_WIRE_STATE_READY, 10000);
    hello.as.hello.protocol++;
    (void)bench_command(&b, &hello);
    now = limits_of(&b);
    assert_true(ALIKE(now, narrow.as.limits));
    hello.as.hello.protocol--;
    bench_accepted(&b, &hello);
    now = limits_of(&b);
    assert_true(ALIKE(now, own));
    bench_close(&b);
}

/* A rigid block: found, then met again as fast as may be; the limit is passed by less than itself. */
static void test_speed_into_a_block(void **state) {
    plant_settings s = plant_settings_default();
    palp_wire_message find = bench_find_contact(10, 0), ramp = bench_move(0, 1, 250),
                      start = bench_start(1, -8, 0, 0);
    double most = 0;
    bench b;
    (void)state;
    s.specimen = PLANT_RIGID;
    bench_open(&b, &s);
    bench_home(&b);
    bench_accepted(&b, &find);
    while (b.app.supervisor.state != PALP_WIRE_STATE_READY) {
        bench_tick(&b);
        most = fmax(most, plant_look(b.plant).force_N);
    }
    assert_true(b.app.contact_known);
    print_message("found at 10 mm/s: %.1f N\n", most);
    assert_true(most < 24);
    static const double rate_mm_s[] = {250, 40, 10, 9, 5, 1};
    for (size_t i = 0; i < 6; i++) {
        ramp.as.segment.rate_nm_s = (uint32_t)(rate_mm_s[i] * 1e6);
        ramp.as.segment.acceleration_um_s2 = 20000000;
        bench_accepted(&b, &ramp);
        const bool slow = rate_mm_s[i] < 9.1;
        assert_int_equal(bench_command(&b, &start), slow ? PALP_WIRE_RESULT_DONE : PALP_WIRE_RESULT_RANGE);
        if (!slow)
            continue;
        most = 0;
        while (b.app.supervisor.state != PALP_WIRE_STATE_FAULT) {
            bench_tick(&b);
            most = fmax(most, plant_look(b.plant).force_N);
        }
        for (int k = 0; k < 1000; k++) {
            bench_tick(&b);
            most = fmax(most, plant_look(b.plant).force_N);
        }
        print_message("met at %.0f mm/s: %.1f N\n", rate_mm_s[i], most);
        assert_true(most < 48);
        assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_CLEAR_FAULT), PALP_WIRE_RESULT_DONE);
    }
    bench_close(&b);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_holds_in_ready),
    cmocka_unit_test(test_lets_go_without_a_host),
    cmocka_unit_test(test_stop_lets_go),
    cmocka_unit_test(test_stop_under_load),
    cmocka_unit_test(test_unfit_stays_unfit),
    cmocka_unit_test(test_boot_waits_for_the_encoder),
    cmocka_unit_test(test_encoder_lost_in_a_dwell),
    cmocka_unit_test(test_start_checks_the_travel),
    cmocka_unit_test(test_limits_end_with_the_session),
    cmocka_unit_test(test_speed_into_a_block),
    {0},
};
