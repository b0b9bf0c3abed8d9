/* test_stepper.c: the cheap machine: steps that are counted, a force sensor that says something 80 times a
 * second. */
#include "app_bench.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

static plant_settings cheap(uint8_t which, plant_specimen specimen) {
    plant_settings s = plant_settings_default();
    s.machine = which;
    s.actuator.count_m = 0.625e-6;
    s.specimen = specimen;
    s.rigid_N_m = 1e5; /* frame and cell are no stiffer */
    return s;
}

static palp_wire_message jog(double to_mm, double rate_mm_s) {
    return (palp_wire_message){.type = PALP_WIRE_TYPE_JOG,
                               .as.jog = {(int32_t)(1e6 * to_mm), (uint32_t)(1e6 * rate_mm_s)}};
}

/* Largest force until the state is entered. */
static double peak_until(bench *b, uint8_t state, int at_most) {
    double most = 0;
    for (int i = 0; i < at_most && b->app.supervisor.state != state; i++) {
        bench_tick(b);
        most = fmax(most, plant_look(b->plant).force_N);
    }
    assert_int_equal(b->app.supervisor.state, state);
    return most;
}

/* Homed, and the cell's own weight taken off. */
static void make_ready(bench *b) {
    palp_wire_message tare = {.type = PALP_WIRE_TYPE_TARE, .as.tare = {.samples = 1000}};
    bench_home(b);
    bench_accepted(b, &tare);
    bench_run(b, 1100);
}

/* Home, contact, a ramp and a dwell: the plate is where it should be, the force what the specimen gives. */
static void check_session(uint8_t which, double heard_per_tick) {
    palp_wire_message ramp = bench_move(0, 3, 2), hold = bench_hold(1, 2000),
                      start = bench_start(2, -1, 500, 500);
    palp_wire_message find = bench_find_contact(0.5, 0);
    plant_settings s = cheap(which, PLANT_MODEL);
    uint32_t heard = 0, ticks = 0;
    double worst_m = 0;
    bench b;
    bench_open(&b, &s);
    make_ready(&b);
    bench_near((double)b.app.force_N, 0, 0.01);
    bench_accepted(&b, &find);
    bench_until(&b, PALP_WIRE_STATE_READY, 60000);
    print_message("contact %.1f um off\n", 1e6 * ((double)b.app.contact_m - 12e-3));
    bench_near((double)b.app.contact_m, 12e-3, 3e-5);
    bench_accepted(&b, &ramp);
    bench_accepted(&b, &hold);
    bench_accepted(&b, &start);
    while (b.app.supervisor.state == PALP_WIRE_STATE_RUN) {
        bench_tick(&b);
        ticks++;
        heard += !b.inputs.force_held;
        worst_m = fmax(worst_m, fabs((double)b.app.reference.position_m - plant_look(b.plant).carriage_m));
        if (b.app.trajectory.current == 1 && b.app.trajectory.tick == 1000)
            bench_near((double)b.app.force_N, plant_look(b.plant).force_N, 0.02);
    }
    assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_READY);
    bench_near(heard, heard_per_tick * ticks, 2);
    bench_near(worst_m, 0, 4e-6); /* a tick's way, and half a count */
    bench_close(&b);
}

static void test_session(void **state) {
    (void)state;
    check_session(PLANT_STEPPER, 0.08);
    check_session(PLANT_STEPPER_FAST, 1);
}

/* What is not known is met so slowly that the limit is passed by less than itself; faster is refused. */
static void test_blind(void **state) {
    palp_wire_message fast = bench_find_contact(2.1, 0), find = bench_find_contact(2, 0);
    palp_wire_message down = jog(20, 2.1), slowly = jog(20, 2), up = jog(1, 5), faster = jog(1, 5.1);
    plant_settings s = cheap(PLANT_STEPPER, PLANT_RIGID);
    bench b;
    (void)state;
    bench_open(&b, &s);
    make_ready(&b);
    assert_int_equal(bench_command(&b, &fast), PALP_WIRE_RESULT_RANGE);
    assert_int_equal(bench_command(&b, &down), PALP_WIRE_RESULT_RANGE);
    bench_accepted(&b, &slowly);
    const double most = peak_until(&b, PALP_WIRE_STATE_FAULT, 20000);
    assert_int_equal(b.app.supervisor.fault, PALP_WIRE_FAULT_OVER_FORCE);
    print_message("a block met at 2 mm/s: %.1f N\n", most);
    assert_true(most > 20 && most < 40);

    /* It holds what it presses; cleared, it is not homed, and HOME leads away from there. */
    bench_run(&b, 1000);
    assert_true(plant_look(b.plant).force_N > 20);
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_CLEAR_FAULT), PALP_WIRE_RESULT_DONE);
    assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_IDLE);
    assert_false(b.app.homed);
    bench_home(&b);
    bench_near(plant_look(b.plant).force_N, 0, 1e-9);

    bench_accepted(&b, &find);
    const double found = peak_until(&b, PALP_WIRE_STATE_READY, 30000);
    print_message("found at 2 mm/s: %.1f N\n", found);
    assert_true(found < 20 && b.app.contact_known);
    assert_int_equal(bench_command(&b, &faster), PALP_WIRE_RESULT_RANGE);
    bench_accepted(&b, &up);
    bench_close(&b);
}

/* Something so hard that the sensor is at its rail, and tared there on top of it: still no hand is needed. */
static void test_rail(void **state) {
    palp_wire_message down = jog(20, 2), tare = {.type = PALP_WIRE_TYPE_TARE, .as.tare = {.samples = 20}};
    plant_settings s = cheap(PLANT_STEPPER, PLANT_RIGID);
    bench b;
    (void)state;
    s.rigid_N_m = 1e6;
    bench_open(&b, &s);
    make_ready(&b);
    bench_accepted(&b, &down);
    const double most = peak_until(&b, PALP_WIRE_STATE_FAULT, 20000);
    bench_run(&b, 100);
    print_message("a harder block met at 2 mm/s: %.0f N\n", most);
    assert_true(b.app.saturated);
    bench_accepted(&b, &tare);
    bench_run(&b, 100);
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_CLEAR_FAULT), PALP_WIRE_RESULT_DONE);
    assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_IDLE);
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_HOME), PALP_WIRE_RESULT_DONE);
    for (int i = 0; i < 2000 && plant_look(b.plant).force_N > 0; i++)
        bench_tick(&b);
    bench_near(plant_look(b.plant).force_N, 0, 1e-9);
    bench_close(&b);
}

/* How fast a program may be follows from the stiffness that was found: what passes the limit adds less than
 * it again. */
static void test_program(void **state) {
    palp_wire_message find = bench_find_contact(0.5, 0), start = bench_start(1, -1, 0, 0);
    plant_settings s = cheap(PLANT_STEPPER, PLANT_RIGID);
    bench b;
    (void)state;
    bench_open(&b, &s);
    make_ready(&b);
    bench_accepted(&b, &find);
    bench_until(&b, PALP_WIRE_STATE_READY, 60000);
    const double k = (double)b.app.stiffness_N_m, safe_mm_s = 1e3 * 20 / (k * 0.0645);
    print_message("%.3g N/m: at most %.2f mm/s\n", k, safe_mm_s);
    palp_wire_message faster = bench_move(0, 1, 1.02 * safe_mm_s),
                      slower = bench_move(0, 1, 0.98 * safe_mm_s);
    bench_accepted(&b, &faster);
    assert_int_equal(bench_command(&b, &start), PALP_WIRE_RESULT_RANGE);
    bench_accepted(&b, &slower);
    bench_accepted(&b, &start);
    const double most = peak_until(&b, PALP_WIRE_STATE_FAULT, 30000);
    print_message("met: %.1f N\n", most);
    assert_true(most < 40);
    bench_close(&b);
}

/* A force held, by a loop as slow as the sensor asks for. */
static void test_creep(void **state) {
    palp_wire_message force = {.type = PALP_WIRE_TYPE_SEGMENT}, find = bench_find_contact(0.5, 0),
                      start = bench_start(1, -1, 0, 0);
    plant_settings s = cheap(PLANT_STEPPER, PLANT_MODEL);
    bench b;
    double off_N = 0, before_N = 0;
    (void)state;
    force.as.segment = (palp_wire_segment){
        .kind = PALP_WIRE_SEGMENT_FORCE, .target_nm = 1000000, .rate_nm_s = 500000, .duration_ms = 10000};
    bench_open(&b, &s);
    make_ready(&b);
    bench_accepted(&b, &find);
    bench_until(&b, PALP_WIRE_STATE_READY, 60000);
    bench_accepted(&b, &force);
    bench_accepted(&b, &start);
    while (b.app.supervisor.state == PALP_WIRE_STATE_RUN) {
        bench_tick(&b);
        const double now_N = plant_look(b.plant).force_N;
        if (b.app.trajectory.wants && b.app.trajectory.tick > 3000 && b.app.phase == 3)
            off_N = fmax(off_N, fabs(now_N - 1));
        before_N = fmax(before_N, now_N);
    }
    print_message("1 N is held to %.1f mN, passed by %.1f mN before\n", 1e3 * off_N, 1e3 * (before_N - 1));
    assert_true(off_N > 0 && off_N < 0.02 && before_N < 1.1);
    bench_close(&b);
}

/* Its one channel may say 0 for long without being taken for unplugged; one that says nothing is. */
static void test_sensor(void **state) {
    plant_settings s = cheap(PLANT_STEPPER, PLANT_AIR);
    bench b;
    (void)state;
    bench_open(&b, &s);
    make_ready(&b);
    b.unplugged = true; /* the bench's word for a level on all channels */
    b.level = 0;
    bench_run(&b, 500);
    assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_READY);
    plant_inject(b.plant, PLANT_SILENT);
    bench_until(&b, PALP_WIRE_STATE_FAULT, 5);
    assert_int_equal(b.app.supervisor.fault, PALP_WIRE_FAULT_SENSOR_SILENT);
    bench_close(&b);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_session),
    cmocka_unit_test(test_blind),
    cmocka_unit_test(test_rail),
    cmocka_unit_test(test_program),
    cmocka_unit_test(test_creep),
    cmocka_unit_test(test_sensor),
    {0},
};
