/* test_faults_matrix.c: every fault in every state: which stop, in which tick, for what reason, and how it
 * is left. */
#include "faults_make.h"

/* ---- the causes ---- */

/* How a fault is made in a state, and what is expected of it. */
typedef struct cause {
    void (*make)(bench *b);
    void (*lift)(bench *b); /* NULL: nothing of it lasts */
    uint32_t least, most;   /* ticks from make() to the stop, that of the stop included */
    bool stays;             /* for minutes after lift() */
} cause;

/* X(name, plant_fault): the plant's, seen with the tick after next: it has sensed the next already. */
/* clang-format off */
#define PLANT_CAUSES(X)                                                                                      \
    X(obstacle, PLANT_OBSTACLE)                                                                              \
    X(hot, PLANT_HOT) X(silent, PLANT_SILENT) X(saturated, PLANT_SATURATED) X(emergency, PLANT_EMERGENCY)    \
    X(encoder, PLANT_ENCODER) X(driver, PLANT_DRIVER)
/* clang-format on */
#define MAKE_AND_LIFT(name, fault)                                                                           \
    static void make_##name(bench *b) {                                                                      \
        plant_inject(b->plant, fault);                                                                       \
    }                                                                                                        \
    static void lift_##name(bench *b) {                                                                      \
        plant_lift(b->plant, fault);                                                                         \
    }
PLANT_CAUSES(MAKE_AND_LIFT)

static void make_jump(bench *b) {
    plant_inject(b->plant, PLANT_JUMP);
}

static void make_far_out(bench *b) {
    end_travel_at(b, -1e-3f);
}

static void make_just_out(bench *b) {
    end_travel_at(b, -1e-4f);
}

/* A hand moves the plate, which is held, by 1.6 mm and keeps it there. */
static void make_shoved(bench *b) {
    plant_inject(b->plant, PLANT_PUSHED);
    bench_run(b, 8);
    plant_lift(b->plant, PLANT_PUSHED);
    plant_inject(b->plant, PLANT_JAMMED);
}

static void make_stuck(bench *b) {
    b->switch_stuck = true;
    assert_int_equal(bench_simple(b, PALP_WIRE_TYPE_STOP), PALP_WIRE_RESULT_DONE);
    assert_int_equal(bench_simple(b, PALP_WIRE_TYPE_HOME), PALP_WIRE_RESULT_DONE);
}

static void make_silence(bench *b) {
    set_limits(b, (palp_wire_limits){.host_timeout_ms = 100});
    b->mute = true;
}

static void make_stall(bench *b) {
    set_limits(b, (palp_wire_limits){.overflow_samples = 50});
    b->stalled = true;
}

static void make_watchdog(bench *b) {
    bench_restart(b, APP_RESET_WATCHDOG, 0);
}

static void make_stack_reset(bench *b) {
    bench_restart(b, APP_RESET_STACK, 0);
}

static void make_brown_out(bench *b) {
    bench_restart(b, APP_RESET_BROWN_OUT, 0);
}

/* Up to a newton, which it holds when it happens. */
static void hold_force(bench *b) {
    palp_wire_message force = bench_force(0, 1, 2, 30000), start = bench_start(1, -1, 0, 0);
    assert_int_equal(bench_simple(b, PALP_WIRE_TYPE_STOP), PALP_WIRE_RESULT_DONE);
    bench_until(b, PALP_WIRE_STATE_READY, 5000);
    bench_accepted(b, &force);
    bench_accepted(b, &start);
    bench_run(b, 3000);
}

static void make_gone(bench *b) {
    hold_force(b);
    plant_inject(b->plant, PLANT_GONE);
}

static void make_shaken(bench *b) {
    hold_force(b);
    plant_inject(b->plant, PLANT_SHAKEN);
}

static const cause obstacle = {make_obstacle, lift_obstacle, 2, 2, false};
static const cause shoved = {make_shoved, NULL, 20, 40, false};
static const cause far_out = {make_far_out, NULL, 1, 1, false};
static const cause just_out = {make_just_out, NULL, 1, 1, false};
static const cause stuck = {make_stuck, NULL, 300, 500, false};
static const cause hot = {make_hot, lift_hot, 100, 300, true};
static const cause jammed = {make_jammed, NULL, 100, 2200, false};
static const cause silent = {make_silent, lift_silent, 3, 3, false};
static const cause saturated = {make_saturated, lift_saturated, 3, 3, false};
static const cause jump = {make_jump, NULL, 2, 2, false};
static const cause emergency = {make_emergency, lift_emergency, 2, 2, false};
static const cause silence = {make_silence, NULL, 101, 101, false};
static const cause stall = {make_stall, NULL, 600, 800, false};
static const cause smash = {make_smash, NULL, 1, 1, false};
static const cause watchdog = {make_watchdog, NULL, 0, 0, false};
static const cause brown_out = {make_brown_out, NULL, 0, 0, false};
static const cause encoder = {make_encoder, lift_encoder, 3, 3, false};
static const cause driver = {make_driver, lift_driver, 2, 2, false};
static const cause gone = {make_gone, NULL, 3300, 6000, false};
static const cause shaken = {make_shaken, NULL, 3300, 6000, false};
static const cause stack_reset = {make_stack_reset, NULL, 0, 0, false};

/* What makes a fault in a state; NULL: it cannot happen there. */
#define ROW(fault, ...) [PALP_WIRE_FAULT_##fault] = {__VA_ARGS__}
#define ALL(c) &c, &c, &c, &c, &c, NULL, &c /* homing, ready, approach, run, retract; jog */
#define MOVING(c) &c, NULL, &c, &c, &c, NULL, &c
static const cause *const causes[PALP_WIRE_FAULT_COUNT][PALP_WIRE_STATE_COUNT] = {
    ROW(OVER_FORCE, NULL, &obstacle, ALL(obstacle)),
    ROW(OVER_TRAVEL, NULL, NULL, &stuck, &far_out, &far_out, &far_out, &far_out, NULL, &far_out),
    ROW(OVER_TEMPERATURE, NULL, &hot, ALL(hot)),
    ROW(FOLLOWING_ERROR, NULL, NULL, &jammed, &shoved, &jammed, &jammed, &jammed, NULL, &jammed),
    ROW(SENSOR_SILENT, NULL, &silent, ALL(silent)),
    ROW(SENSOR_SATURATED, NULL, &saturated, ALL(saturated)),
    ROW(ENCODER_JUMP, NULL, NULL, ALL(jump)),
    ROW(HOST_TIMEOUT, NULL, NULL, MOVING(silence)),
    ROW(STREAM_OVERFLOW, NULL, NULL, NULL, NULL, NULL, &stall, NULL),
    ROW(COMMAND_OUT_OF_RANGE, NULL, NULL, NULL, NULL, &just_out, &just_out, &just_out, NULL, &just_out),
    ROW(WATCHDOG_RESET, &watchdog, &watchdog, ALL(watchdog)),
    ROW(STACK_GUARD, &stack_reset, &smash, ALL(smash)),
    ROW(EMERGENCY_STOP, NULL, &emergency, ALL(emergency)),
    ROW(ENCODER_LOST, NULL, &encoder, ALL(encoder)),
    ROW(DRIVER_FAULT, NULL, &driver, ALL(driver)),
    ROW(BROWN_OUT, &brown_out, &brown_out, ALL(brown_out)),
    ROW(CONTACT_LOST, NULL, NULL, NULL, NULL, NULL, &gone),
    ROW(FORCE_OSCILLATES, NULL, NULL, NULL, NULL, NULL, &shaken),
};

static bool restarts(uint8_t fault) {
    return fault == PALP_WIRE_FAULT_WATCHDOG_RESET || fault == PALP_WIRE_FAULT_BROWN_OUT;
}

/* There is nothing to stop in IDLE, but the motion that would begin is stopped in its first tick. */
static bool waits_for_home(uint8_t fault, uint8_t from) {
    return from == PALP_WIRE_STATE_IDLE && !restarts(fault) && fault != PALP_WIRE_FAULT_STACK_GUARD &&
           fault != PALP_WIRE_FAULT_EMERGENCY_STOP;
}

/* ---- what must be so ---- */

/* The tick that sees it turns the motor off: bench_tick() asserts that it is on while moving only. */
static void check_stop(bench *b, uint8_t fault, uint8_t from, const cause *c) {
    const uint32_t before = b->app.tick;
    uint8_t last = from;
    c->make(b);
    const bool restarted = c->least == 0;
    while (b->app.supervisor.state != PALP_WIRE_STATE_FAULT && b->app.tick - before <= c->most) {
        last = b->app.supervisor.state;
        bench_tick(b);
    }
    if (b->app.supervisor.fault != fault)
        fail_msg("%s after %u ticks", palp_wire_fault_name(b->app.supervisor.fault),
                 (unsigned)(b->app.tick - before));
    if (restarted) {
        bench_tick(b);
        assert_false(b->out.motor_on);
        return;
    }
    assert_int_equal(last, from);
    assert_int_equal(b->app.supervisor.fault_tick, b->app.tick);
    assert_in_range(b->app.tick - before, c->least, c->most);
    assert_false(b->out.motor_on);
}

static void check_refused(bench *b, uint8_t type) {
    const uint8_t result = bench_simple(b, type);
    if (result != PALP_WIRE_RESULT_FAULTED)
        fail_msg("%s: %s", palp_wire_type_name(type), palp_wire_result_text(result));
}

static void check_latched(bench *b, uint8_t fault) {
    const uint32_t tick = b->app.supervisor.fault_tick;
    b->stalled = b->mute = false;
    b->smashed = true;
    plant_inject(b->plant, PLANT_EMERGENCY);
    bench_run(b, 20);
    if (fault != PALP_WIRE_FAULT_EMERGENCY_STOP)
        plant_lift(b->plant, PLANT_EMERGENCY);
    bench_run(b, 5);
    check_refused(b, PALP_WIRE_TYPE_HOME);
    check_refused(b, PALP_WIRE_TYPE_SELECT_GAINS);
    check_refused(b, PALP_WIRE_TYPE_FIND_CONTACT);
    check_refused(b, PALP_WIRE_TYPE_SEGMENT);
    check_refused(b, PALP_WIRE_TYPE_START);
    check_refused(b, PALP_WIRE_TYPE_STOP);
    assert_int_equal(bench_simple(b, PALP_WIRE_TYPE_GET_STATUS), PALP_WIRE_RESULT_DONE);
    assert_int_equal(b->status.state, PALP_WIRE_STATE_FAULT);
    assert_int_equal(b->status.fault, fault);
    assert_int_equal(b->status.fault_tick, tick);
}

/* Every tick up to the stop and on is in the stream or counted; from the tick of the stop on it says so. */
static void check_stream(const bench *b) {
    const uint32_t stop = b->app.supervisor.fault_tick;
    size_t gap = 0, at = 0;
    uint32_t next = 1;
    assert_int_equal(b->damaged, 0);
    for (size_t i = 0; i < b->n_samples; i++) {
        const sample *s = &b->sample[i];
        gap += s->tick - next;
        next = s->tick + 1;
        at += s->tick == stop;
        assert_int_equal((s->flags & PALP_WIRE_FLAG_FAULT) != 0, s->tick >= stop);
        assert_false(s->tick >= stop && ((s->flags & PALP_WIRE_FLAG_MOTOR) || s->duty != 0));
    }
    assert_int_equal(gap, b->lost);
    assert_true(b->lost > 0 || at == 1);
}

/* Cleared only once the cause is gone; then homed again, or ready as before. */
static void check_cleared(bench *b, const cause *c, bool position_known, bool contact_known) {
    if (c->lift) {
        assert_int_equal(bench_simple(b, PALP_WIRE_TYPE_CLEAR_FAULT), PALP_WIRE_RESULT_PERSISTS);
        assert_int_equal(b->app.supervisor.state, PALP_WIRE_STATE_FAULT);
        c->lift(b);
        bench_run(b, 2);
    }
    if (c->stays) {
        assert_int_equal(bench_simple(b, PALP_WIRE_TYPE_CLEAR_FAULT), PALP_WIRE_RESULT_PERSISTS);
        return;
    }
    b->switch_stuck = false;
    plant_lift(b->plant, PLANT_JAMMED);
    bench_run(b, 1);
    assert_int_equal(bench_simple(b, PALP_WIRE_TYPE_CLEAR_FAULT), PALP_WIRE_RESULT_DONE);
    assert_int_equal(b->app.supervisor.state, position_known ? PALP_WIRE_STATE_READY : PALP_WIRE_STATE_IDLE);
    assert_int_equal(b->app.supervisor.fault, PALP_WIRE_FAULT_NONE);
    assert_int_equal(b->app.contact_known, contact_known);
    set_limits(b,
               (palp_wire_limits){.travel_nm = 30000000, .host_timeout_ms = 5000, .overflow_samples = 1000});
    bench_home(b);
}

/* In IDLE: the cause alone stops nothing; homing stops before the motor has been on. */
static void check_at_home(bench *b, uint8_t fault, const cause *c) {
    c->make(b);
    bench_run(b, c->most + 20);
    assert_int_equal(b->app.supervisor.state, PALP_WIRE_STATE_IDLE);
    assert_int_equal(bench_simple(b, PALP_WIRE_TYPE_HOME), PALP_WIRE_RESULT_DONE);
    assert_int_equal(b->app.supervisor.fault, fault);
    for (size_t i = 0; i < b->n_samples; i++)
        assert_false(b->sample[i].flags & PALP_WIRE_FLAG_MOTOR);
}

/* What is left of the position and of contact when a fault has stopped this state. */
static bool position_is_known(uint8_t fault, uint8_t from) {
    return from >= PALP_WIRE_STATE_READY && fault != PALP_WIRE_FAULT_ENCODER_JUMP &&
           fault != PALP_WIRE_FAULT_ENCODER_LOST && fault != PALP_WIRE_FAULT_OVER_TRAVEL && !restarts(fault);
}

static const char *check_cell(uint8_t fault, uint8_t from) {
    const cause *c = causes[fault][from];
    const bool known = position_is_known(fault, from), waits = waits_for_home(fault, from);
    bench b;
    if (!c)
        return "-";
    bring_to(&b, from);
    if (waits)
        check_at_home(&b, fault, c);
    else
        check_stop(&b, fault, from, c);
    check_latched(&b, fault);
    if (c->least > 0) /* else it has restarted */
        check_stream(&b);
    check_cleared(&b, c, known, known && from != PALP_WIRE_STATE_APPROACH);
    bench_close(&b);
    return waits ? "at HOME" : "ok";
}

static void test_every_fault_in_every_state(void **state) {
    (void)state;
    print_message("%-22s", "");
    for (uint8_t s = 0; s < PALP_WIRE_STATE_COUNT; s++)
        print_message(" %-8s", palp_wire_state_name(s));
    print_message("\n");
    for (uint8_t fault = 1; fault < PALP_WIRE_FAULT_COUNT; fault++) {
        print_message("%-22s", palp_wire_fault_name(fault));
        for (uint8_t s = 0; s < PALP_WIRE_STATE_COUNT; s++)
            print_message(" %-8s", check_cell(fault, s));
        print_message("\n");
    }
    print_message(
        "ok: stops in that tick; at HOME: stops the motion that would begin; -: cannot happen there\n");
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_every_fault_in_every_state),
    {0},
};
