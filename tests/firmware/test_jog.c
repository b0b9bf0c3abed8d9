/* test_jog.c: the plate sent to a place by hand, and HALT, which stops it from the host. */
#include "faults_make.h"

static palp_wire_message jog(double to_mm, double rate_mm_s) {
    return (palp_wire_message){.type = PALP_WIRE_TYPE_JOG,
                               .as.jog = {(int32_t)(1e6 * to_mm), (uint32_t)(1e6 * rate_mm_s)}};
}

static double plate_m(const bench *b) {
    return plant_look(b->plant).carriage_m;
}

/* There and back, at the rate that was asked for, and held; also from IDLE, once homed. */
static void test_goes_and_holds(void **state) {
    palp_wire_message down = jog(8, 4), up = jog(2, 10);
    bench b;
    (void)state;
    bench_open(&b, NULL);
    bench_home(&b);
    const double from_m = plate_m(&b);
    bench_accepted(&b, &down);
    assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_JOG);
    const uint32_t ticks = bench_until(&b, PALP_WIRE_STATE_READY, 5000);
    bench_near(ticks, 1e3 * (8e-3 - from_m) / 4e-3, 20);
    bench_run(&b, 500);
    bench_near(plate_m(&b), 8e-3, 2e-5);
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_STOP), PALP_WIRE_RESULT_DONE); /* lets go */
    bench_accepted(&b, &up);
    bench_until(&b, PALP_WIRE_STATE_READY, 5000);
    bench_run(&b, 500);
    bench_near(plate_m(&b), 2e-3, 2e-5);
    for (size_t i = 0; i < b.n_samples; i++)
        assert_false(b.sample[i].flags & PALP_WIRE_FLAG_RECORD);
    bench_close(&b);
}

static void test_ranges(void **state) {
    const double bad[][2] = {{-0.1, 1}, {30.1, 1}, {5, 0}, {5, 10.1}};
    palp_wire_message early = jog(5, 1);
    bench b;
    (void)state;
    bench_open(&b, NULL);
    bench_until(&b, PALP_WIRE_STATE_IDLE, 200);
    assert_int_equal(bench_command(&b, &early), PALP_WIRE_RESULT_NOT_HOMED);
    bench_home(&b);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        palp_wire_message m = jog(bad[i][0], bad[i][1]);
        assert_int_equal(bench_command(&b, &m), PALP_WIRE_RESULT_RANGE);
        assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_READY);
    }
    bench_close(&b);
}

/* STOP: no deeper; out of a specimen that is known, else back to where it began. The withdrawal after a run
 * keeps its own rate, whatever a jog was asked for. */
static void test_stopped(void **state) {
    palp_wire_message slow = jog(20, 0.5), deep = jog(15, 2), ramp = bench_move(0, 3, 3),
                      start = bench_start(1, -1, 0, 0);
    bench b;
    (void)state;
    bench_open(&b, NULL);
    bench_home(&b);
    const double from_m = plate_m(&b);
    bench_accepted(&b, &slow);
    bench_run(&b, 4000);
    assert_true(plate_m(&b) > from_m + 1e-3);
    bench_simple(&b, PALP_WIRE_TYPE_STOP);
    bench_until(&b, PALP_WIRE_STATE_READY, 5000);
    bench_near(plate_m(&b), from_m, 3e-5);

    bench_contact(&b);
    bench_accepted(&b, &deep);
    while (plate_m(&b) < 14e-3)
        bench_tick(&b);
    bench_simple(&b, PALP_WIRE_TYPE_STOP);
    bench_until(&b, PALP_WIRE_STATE_READY, 5000);
    bench_near(plate_m(&b), b.app.contact_m - 1e-3, 3e-5);

    bench_accepted(&b, &slow);
    bench_run(&b, 100);
    bench_simple(&b, PALP_WIRE_TYPE_STOP); /* in the air already */
    bench_until(&b, PALP_WIRE_STATE_READY, 500);
    bench_accepted(&b, &ramp);
    bench_accepted(&b, &start);
    bench_run(&b, 1000);
    bench_simple(&b, PALP_WIRE_TYPE_STOP);
    assert_true(bench_until(&b, PALP_WIRE_STATE_READY, 3000) < 1000);
    bench_close(&b);
}

/* A block in the way: the limit of force stops it. */
static void test_meets_a_block(void **state) {
    palp_wire_message fast = jog(20, 10);
    plant_settings s = plant_settings_default();
    bench b;
    (void)state;
    s.specimen = PLANT_RIGID;
    bench_open(&b, &s);
    bench_home(&b);
    bench_accepted(&b, &fast);
    double most = 0;
    for (int i = 0; i < 5000 && b.app.supervisor.state != PALP_WIRE_STATE_FAULT; i++) {
        bench_tick(&b);
        most = plant_look(b.plant).force_N > most ? plant_look(b.plant).force_N : most;
    }
    assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_FAULT);
    print_message("a block met at 10 mm/s: %.1f N\n", most);
    assert_true(most < 48);
    bench_close(&b);
}

/* HALT: in the very tick, from every state that may move, latched; cleared at once, since no switch is
 * pressed. */
static void test_halt(void **state) {
    static const uint8_t from[] = {PALP_WIRE_STATE_IDLE,     PALP_WIRE_STATE_HOMING, PALP_WIRE_STATE_READY,
                                   PALP_WIRE_STATE_APPROACH, PALP_WIRE_STATE_RUN,    PALP_WIRE_STATE_JOG};
    (void)state;
    for (size_t i = 0; i < sizeof from; i++) {
        palp_wire_message ramp = bench_move(0, 5, 2), start = bench_start(1, 0, 0, 0),
                          find = bench_find_contact(5, 0), down = jog(13, 1);
        bench b;
        bench_open(&b, NULL);
        bench_until(&b, PALP_WIRE_STATE_IDLE, 200);
        if (from[i] == PALP_WIRE_STATE_HOMING)
            bench_simple(&b, PALP_WIRE_TYPE_HOME);
        else if (from[i] != PALP_WIRE_STATE_IDLE)
            bench_contact(&b);
        if (from[i] == PALP_WIRE_STATE_APPROACH)
            bench_accepted(&b, &find);
        if (from[i] == PALP_WIRE_STATE_JOG)
            bench_accepted(&b, &down);
        if (from[i] == PALP_WIRE_STATE_RUN) {
            bench_accepted(&b, &ramp);
            bench_accepted(&b, &start);
            bench_run(&b, 2500);
        }
        assert_int_equal(b.app.supervisor.state, from[i]);
        assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_HALT), PALP_WIRE_RESULT_DONE);
        assert_false(b.out.motor_on);
        assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_FAULT);
        assert_int_equal(b.app.supervisor.fault, PALP_WIRE_FAULT_EMERGENCY_STOP);
        bench_run(&b, 2000);
        assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_HALT), PALP_WIRE_RESULT_FAULTED);
        assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_CLEAR_FAULT), PALP_WIRE_RESULT_DONE);
        bench_close(&b);
    }
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_goes_and_holds), cmocka_unit_test(test_ranges), cmocka_unit_test(test_stopped),
    cmocka_unit_test(test_meets_a_block),  cmocka_unit_test(test_halt),   {0},
};
