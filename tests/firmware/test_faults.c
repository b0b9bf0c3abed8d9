/* test_faults.c: glitches, sensors that are not there, missed ticks, and faults of several reasons. */
#include "faults_make.h"

/* A single bad reading is none of the sensor's faults. */
static void test_glitches(void **state) {
    static const plant_fault glitch[] = {PLANT_SILENT, PLANT_SATURATED};
    bench b;
    (void)state;
    bring_to(&b, PALP_WIRE_STATE_RUN);
    for (size_t i = 0; i < 2; i++) {
        for (int repeat = 0; repeat < 5; repeat++) {
            plant_inject(b.plant, glitch[i]);
            bench_tick(&b);
            plant_lift(b.plant, glitch[i]);
            bench_run(&b, 2);
            assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_RUN);
        }
    }
    bench_close(&b);
}

/* A converter that is not there reads the same level on all channels, and does not say that it is silent. */
static void test_unplugged_sensor(void **state) {
    static const int16_t level[] = {0, -1, 1};
    (void)state;
    for (size_t i = 0; i < 3; i++) {
        bench b;
        bring_to(&b, PALP_WIRE_STATE_RUN);
        b.unplugged = true;
        b.level = level[i];
        bench_run(&b, 20); /* a quiet one in the air may read so for some ticks */
        assert_int_equal(b.app.supervisor.fault, PALP_WIRE_FAULT_NONE);
        bench_run(&b, 1);
        const uint8_t wanted = level[i] == 1 ? PALP_WIRE_FAULT_NONE : PALP_WIRE_FAULT_SENSOR_SILENT;
        assert_int_equal(b.app.supervisor.fault, wanted);
        bench_close(&b);
    }
}

static void test_broken_thermistor(void **state) {
    bench b;
    (void)state;
    bring_to(&b, PALP_WIRE_STATE_RUN);
    b.no_thermistor = true;
    bench_tick(&b);
    assert_int_equal(b.app.supervisor.fault, PALP_WIRE_FAULT_OVER_TEMPERATURE);
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_CLEAR_FAULT), PALP_WIRE_RESULT_PERSISTS);
    bench_close(&b);
}

/* A plate that lags: for the heat, where that holds the motor back; nothing of it lasts. */
static void test_falls_behind(void **state) {
    static const double ambient_C[] = {85, 95};
    static const uint8_t wanted[] = {PALP_WIRE_FAULT_FOLLOWING_ERROR, PALP_WIRE_FAULT_OVER_TEMPERATURE};
    (void)state;
    for (int hot_motor = 0; hot_motor < 2; hot_motor++) {
        plant_settings s = plant_settings_default();
        bench b;
        s.actuator.ambient_C = ambient_C[hot_motor];
        bench_open(&b, &s);
        to_run(&b);
        make_jammed(&b);
        bench_until(&b, PALP_WIRE_STATE_FAULT, 2200);
        assert_int_equal(b.app.supervisor.fault, wanted[hot_motor]);
        assert_true(thermal_winding_C(&b.app.thermal) < b.app.limits.winding_C - 10.0f);
        bench_tick(&b);
        assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_CLEAR_FAULT), PALP_WIRE_RESULT_DONE);
        bench_close(&b);
    }
}

/* Several at once: the reason is what makes the others untrustworthy. */
static void test_reason_of_several(void **state) {
    bench b;
    (void)state;
    bring_to(&b, PALP_WIRE_STATE_RUN);
    end_travel_at(&b, 1e-3f);
    plant_inject(b.plant, PLANT_JUMP); /* also out of the travel by 4 mm */
    plant_inject(b.plant, PLANT_OBSTACLE);
    bench_run(&b, 2);
    assert_int_equal(b.app.supervisor.fault, PALP_WIRE_FAULT_ENCODER_JUMP);
    bench_close(&b);
    bring_to(&b, PALP_WIRE_STATE_RUN);
    plant_inject(b.plant, PLANT_EMERGENCY);
    bench_tick(&b);
    make_smash(&b);
    bench_tick(&b);
    assert_int_equal(b.app.supervisor.fault, PALP_WIRE_FAULT_STACK_GUARD);
    bench_close(&b);
}

/* A segment that would leave the travel stops there; the plate has not followed. */
static void test_segment_leaves_the_travel(void **state) {
    bench b;
    int32_t lowest = 0;
    (void)state;
    bring_to(&b, PALP_WIRE_STATE_RUN);
    set_limits(&b, (palp_wire_limits){.travel_nm = 14000000});
    bench_until(&b, PALP_WIRE_STATE_FAULT, 2000);
    assert_int_equal(b.app.supervisor.fault, PALP_WIRE_FAULT_COMMAND_OUT_OF_RANGE);
    bench_run(&b, 100);
    for (size_t i = 0; i < b.n_samples; i++)
        lowest = b.sample[i].position > lowest ? b.sample[i].position : lowest;
    assert_in_range(lowest, 13950, 14050);
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_CLEAR_FAULT), PALP_WIRE_RESULT_DONE);
    bench_close(&b);
}

/* A reference that is no number stops, too: nothing that it could be compared with would. */
static void test_reference_is_no_number(void **state) {
    bench b;
    (void)state;
    bring_to(&b, PALP_WIRE_STATE_RUN);
    b.app.trajectory.stroke.start_m = b.app.trajectory.stroke.end_m = -1.0f / 0.0f;
    b.app.trajectory.stroke.rate_m_s = 1.0f / 0.0f;
    bench_tick(&b);
    assert_int_equal(b.app.supervisor.fault, PALP_WIRE_FAULT_COMMAND_OUT_OF_RANGE);
    assert_false(b.out.motor_on);
    bench_close(&b);
}

/* The position is lost by a jump in any state, also where it stops nothing. */
static void test_jump_in_a_fault(void **state) {
    bench b;
    (void)state;
    bring_to(&b, PALP_WIRE_STATE_READY);
    make_smash(&b);
    bench_run(&b, 10);
    plant_inject(b.plant, PLANT_JUMP);
    bench_run(&b, 10);
    assert_int_equal(b.app.supervisor.fault, PALP_WIRE_FAULT_STACK_GUARD);
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_CLEAR_FAULT), PALP_WIRE_RESULT_DONE);
    assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_IDLE);
    bench_close(&b);
}

/* Fast, and ticks missed: it has gone far since the last one, but has not jumped. */
static void test_missed_ticks_are_no_jump(void **state) {
    palp_wire_message fast = bench_move(0, 0, 100), start = bench_start(1, -9, 0, 0);
    bench b;
    (void)state;
    fast.as.segment.acceleration_um_s2 = 5000000;
    bring_to(&b, PALP_WIRE_STATE_READY);
    bench_accepted(&b, &fast);
    bench_accepted(&b, &start);
    while (b.app.velocity_m_s < 0.095f)
        bench_tick(&b);
    const int32_t before = b.inputs.position;
    b.missed = 4;
    bench_tick(&b);
    assert_true(b.inputs.position - before > 400);
    bench_until(&b, PALP_WIRE_STATE_READY, 5000);
    bench_close(&b);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_glitches),
    cmocka_unit_test(test_unplugged_sensor),
    cmocka_unit_test(test_broken_thermistor),
    cmocka_unit_test(test_falls_behind),
    cmocka_unit_test(test_reason_of_several),
    cmocka_unit_test(test_segment_leaves_the_travel),
    cmocka_unit_test(test_reference_is_no_number),
    cmocka_unit_test(test_jump_in_a_fault),
    cmocka_unit_test(test_missed_ticks_are_no_jump),
    {0},
};
