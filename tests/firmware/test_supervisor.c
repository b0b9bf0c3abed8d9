/* test_supervisor.c: every state with every event, every state with every fault. */
#include "supervisor.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

/* What is wanted, written apart from the code: a row a state, a column an event; "-" means nothing. Events:
 * STARTED HOME HOMED FIND_CONTACT START JOG DONE STOP FAULT CLEAR. */
static const char *const next_wanted[PALP_WIRE_STATE_COUNT][SUPERVISOR_EVENT_COUNT] = {
    {"idle", "-", "-", "-", "-", "-", "-", "-", "fault", "-"},                 /* boot */
    {"-", "homing", "ready", "-", "-", "-", "-", "idle", "fault", "-"},        /* idle */
    {"-", "-", "ready", "-", "-", "-", "-", "idle", "fault", "-"},             /* homing */
    {"-", "homing", "-", "approach", "run", "jog", "-", "idle", "fault", "-"}, /* ready */
    {"-", "-", "-", "-", "-", "-", "retract", "retract", "fault", "-"},        /* approach */
    {"-", "-", "-", "-", "-", "-", "ready", "retract", "fault", "-"},          /* run */
    {"-", "-", "-", "-", "-", "-", "ready", "retract", "fault", "-"},          /* retract */
    {"-", "-", "-", "-", "-", "-", "-", "-", "-", "idle"},                     /* fault */
    {"-", "-", "-", "-", "-", "-", "ready", "retract", "fault", "-"},          /* jog */
};

/* The states that watch for a fault: Boot Idle Homing reaDy Approach rUn reTract - Jog. */
static const struct watch {
    uint8_t fault;
    const char *states;
} watch_wanted[] = {
    {PALP_WIRE_FAULT_NONE, "........."},
    {PALP_WIRE_FAULT_OVER_FORCE, "..HDAUT.J"},
    {PALP_WIRE_FAULT_OVER_TRAVEL, "..HDAUT.J"},
    {PALP_WIRE_FAULT_OVER_TEMPERATURE, "..HDAUT.J"},
    {PALP_WIRE_FAULT_FOLLOWING_ERROR, "..HDAUT.J"},
    {PALP_WIRE_FAULT_SENSOR_SILENT, "..HDAUT.J"},
    {PALP_WIRE_FAULT_SENSOR_SATURATED, "..HDAUT.J"},
    {PALP_WIRE_FAULT_ENCODER_JUMP, "..HDAUT.J"},
    {PALP_WIRE_FAULT_HOST_TIMEOUT, "..H.AUT.J"},
    {PALP_WIRE_FAULT_STREAM_OVERFLOW, ".....U..."},
    {PALP_WIRE_FAULT_COMMAND_OUT_OF_RANGE, "....AUT.J"},
    {PALP_WIRE_FAULT_WATCHDOG_RESET, "B........"},
    {PALP_WIRE_FAULT_STACK_GUARD, "BIHDAUT.J"},
    {PALP_WIRE_FAULT_EMERGENCY_STOP, ".IHDAUT.J"},
    {PALP_WIRE_FAULT_ENCODER_LOST, "..HDAUT.J"},
    {PALP_WIRE_FAULT_DRIVER_FAULT, "..HDAUT.J"},
    {PALP_WIRE_FAULT_BROWN_OUT, "B........"},
    {PALP_WIRE_FAULT_CONTACT_LOST, ".....U..."},
    {PALP_WIRE_FAULT_FORCE_OSCILLATES, ".....U..."},
};

static void test_every_event(void **state) {
    (void)state;
    for (uint8_t from = 0; from < PALP_WIRE_STATE_COUNT; from++) {
        for (int event = 0; event < SUPERVISOR_EVENT_COUNT; event++) {
            supervisor s = {.state = from, .fault = PALP_WIRE_FAULT_OVER_FORCE, .fault_tick = 5};
            const char *wanted = next_wanted[from][event];
            const bool taken = supervisor_take(&s, (supervisor_event)event);
            assert_int_equal(taken, wanted[0] != '-');
            assert_string_equal(palp_wire_state_name(s.state), taken ? wanted : palp_wire_state_name(from));
            assert_int_equal(s.fault, taken && event == SUPERVISOR_CLEAR ? PALP_WIRE_FAULT_NONE
                                                                         : PALP_WIRE_FAULT_OVER_FORCE);
        }
    }
}

static void test_every_fault(void **state) {
    (void)state;
    assert_int_equal(sizeof watch_wanted / sizeof watch_wanted[0], PALP_WIRE_FAULT_COUNT);
    for (uint8_t fault = 0; fault < PALP_WIRE_FAULT_COUNT; fault++) {
        assert_int_equal(watch_wanted[fault].fault, fault);
        assert_int_equal(strlen(watch_wanted[fault].states), PALP_WIRE_STATE_COUNT);
        for (uint8_t from = 0; from < PALP_WIRE_STATE_COUNT; from++) {
            const bool watched = from != PALP_WIRE_STATE_FAULT && watch_wanted[fault].states[from] != '.';
            supervisor s = {.state = from};
            assert_int_equal(supervisor_watches(from, fault), watched);
            assert_int_equal(supervisor_fault(&s, fault, 42), watched);
            assert_int_equal(s.state, watched ? (uint8_t)PALP_WIRE_STATE_FAULT : from);
            assert_int_equal(s.fault, watched ? fault : (uint8_t)PALP_WIRE_FAULT_NONE);
            assert_int_equal(s.fault_tick, watched ? 42 : 0);
        }
    }
    assert_false(supervisor_watches(PALP_WIRE_STATE_RUN, PALP_WIRE_FAULT_COUNT));
}

static void test_first_fault_wins(void **state) {
    supervisor s = {.state = PALP_WIRE_STATE_RUN};
    (void)state;
    assert_true(supervisor_fault(&s, PALP_WIRE_FAULT_OVER_FORCE, 10));
    for (uint8_t fault = 0; fault < PALP_WIRE_FAULT_COUNT; fault++)
        assert_false(supervisor_fault(&s, fault, 11));
    assert_int_equal(s.fault, PALP_WIRE_FAULT_OVER_FORCE);
    assert_int_equal(s.fault_tick, 10);
    assert_true(supervisor_take(&s, SUPERVISOR_CLEAR));
    assert_int_equal(s.fault, PALP_WIRE_FAULT_NONE);
}

/* The motor is on in no state that a fault would not stop, and moves in none that the lack of a host would
 * not: READY, which it leaves by itself then (test_app), holds the plate. */
static void test_the_motor_is_watched(void **state) {
    (void)state;
    for (uint8_t s = 0; s < PALP_WIRE_STATE_COUNT; s++) {
        const bool moving = s == PALP_WIRE_STATE_HOMING || s == PALP_WIRE_STATE_APPROACH ||
                            s == PALP_WIRE_STATE_RUN || s == PALP_WIRE_STATE_RETRACT ||
                            s == PALP_WIRE_STATE_JOG;
        const bool on = moving || s == PALP_WIRE_STATE_READY;
        assert_int_equal(supervisor_moving(s), moving);
        assert_int_equal(supervisor_watches(s, PALP_WIRE_FAULT_HOST_TIMEOUT), moving);
        assert_int_equal(supervisor_drives(s), on);
        for (uint8_t fault = PALP_WIRE_FAULT_OVER_FORCE; fault <= PALP_WIRE_FAULT_ENCODER_JUMP; fault++)
            assert_int_equal(supervisor_watches(s, fault), on);
        assert_int_equal(supervisor_watches(s, PALP_WIRE_FAULT_ENCODER_LOST), on);
        assert_int_equal(supervisor_watches(s, PALP_WIRE_FAULT_DRIVER_FAULT), on);
    }
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_every_event),
    cmocka_unit_test(test_every_fault),
    cmocka_unit_test(test_first_fault_wins),
    cmocka_unit_test(test_the_motor_is_watched),
    {0},
};
