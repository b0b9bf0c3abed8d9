/* supervisor.c: the tables of states, events and faults. */
#include "supervisor.h"

/* Events that are not listed mean nothing in a state. No event leads back to BOOT, so its 0 marks them. */
#define TO(state) PALP_WIRE_STATE_##state
static const uint8_t next_state[PALP_WIRE_STATE_COUNT][SUPERVISOR_EVENT_COUNT] = {
    [TO(BOOT)] = {[SUPERVISOR_STARTED] = TO(IDLE), [SUPERVISOR_FAULT] = TO(FAULT)},
    [TO(IDLE)] = {[SUPERVISOR_HOME] = TO(HOMING),
                  [SUPERVISOR_HOMED] = TO(READY), /* where the position is known */
                  [SUPERVISOR_STOP] = TO(IDLE),
                  [SUPERVISOR_FAULT] = TO(FAULT)},
    [TO(HOMING)] =
        {[SUPERVISOR_HOMED] = TO(READY), [SUPERVISOR_STOP] = TO(IDLE), [SUPERVISOR_FAULT] = TO(FAULT)},
    [TO(READY)] = {[SUPERVISOR_HOME] = TO(HOMING),
                   [SUPERVISOR_FIND_CONTACT] = TO(APPROACH),
                   [SUPERVISOR_START] = TO(RUN),
                   [SUPERVISOR_JOG] = TO(JOG),
                   [SUPERVISOR_STOP] = TO(IDLE), /* lets go of the plate, whose position stays known */
                   [SUPERVISOR_FAULT] = TO(FAULT)},
    [TO(APPROACH)] =
        {[SUPERVISOR_DONE] = TO(RETRACT), [SUPERVISOR_STOP] = TO(RETRACT), [SUPERVISOR_FAULT] = TO(FAULT)},
    [TO(RUN)] =
        {[SUPERVISOR_DONE] = TO(READY), [SUPERVISOR_STOP] = TO(RETRACT), [SUPERVISOR_FAULT] = TO(FAULT)},
    [TO(RETRACT)] =
        {[SUPERVISOR_DONE] = TO(READY), [SUPERVISOR_STOP] = TO(RETRACT), [SUPERVISOR_FAULT] = TO(FAULT)},
    [TO(FAULT)] = {[SUPERVISOR_CLEAR] = TO(IDLE)},
    [TO(JOG)] =
        {[SUPERVISOR_DONE] = TO(READY), [SUPERVISOR_STOP] = TO(RETRACT), [SUPERVISOR_FAULT] = TO(FAULT)},
};
#undef TO

/* Which states watch for a fault. The motor is on in HELD: in MOVING, and in READY, where it holds the plate.
 * In READY a motion may begin at any time; a host that is silent for long ends it without a fault, and the
 * plate is let go. In IDLE the sensor may be away for mounting, and the carriage pushed by hand. A fault then
 * stops the next HOME in its first tick, before the motor is on. The reference has no bounds while HOMING,
 * since the ends are not known yet. */
#define IN(state) (1U << PALP_WIRE_STATE_##state)
#define MOVING (IN(HOMING) | IN(APPROACH) | IN(RUN) | IN(RETRACT) | IN(JOG))
#define HELD (IN(READY) | MOVING)
static const uint16_t watching[PALP_WIRE_FAULT_COUNT] = {
    [PALP_WIRE_FAULT_OVER_FORCE] = HELD,
    [PALP_WIRE_FAULT_OVER_TRAVEL] = HELD,
    [PALP_WIRE_FAULT_OVER_TEMPERATURE] = HELD,
    [PALP_WIRE_FAULT_FOLLOWING_ERROR] = HELD,
    [PALP_WIRE_FAULT_SENSOR_SILENT] = HELD,
    [PALP_WIRE_FAULT_SENSOR_SATURATED] = HELD,
    [PALP_WIRE_FAULT_ENCODER_JUMP] = HELD,
    [PALP_WIRE_FAULT_HOST_TIMEOUT] = MOVING,
    [PALP_WIRE_FAULT_STREAM_OVERFLOW] = IN(RUN),
    [PALP_WIRE_FAULT_COMMAND_OUT_OF_RANGE] = MOVING & ~IN(HOMING),
    [PALP_WIRE_FAULT_WATCHDOG_RESET] = IN(BOOT),
    [PALP_WIRE_FAULT_STACK_GUARD] = IN(BOOT) | IN(IDLE) | HELD,
    [PALP_WIRE_FAULT_EMERGENCY_STOP] = IN(IDLE) | HELD,
    [PALP_WIRE_FAULT_ENCODER_LOST] = HELD,
    [PALP_WIRE_FAULT_DRIVER_FAULT] = HELD,
    [PALP_WIRE_FAULT_BROWN_OUT] = IN(BOOT),
    [PALP_WIRE_FAULT_CONTACT_LOST] = IN(RUN),
    [PALP_WIRE_FAULT_FORCE_OSCILLATES] = IN(RUN),
};

bool supervisor_take(supervisor *s, supervisor_event event) {
    const uint8_t next = next_state[s->state][event];
    if (next == PALP_WIRE_STATE_BOOT)
        return false;
    s->state = next;
    if (event == SUPERVISOR_CLEAR)
        s->fault = PALP_WIRE_FAULT_NONE;
    return true;
}

bool supervisor_fault(supervisor *s, uint8_t fault, uint32_t tick) {
    if (!supervisor_watches(s->state, fault) || !supervisor_take(s, SUPERVISOR_FAULT))
        return false;
    s->fault = fault;
    s->fault_tick = tick;
    return true;
}

bool supervisor_watches(uint8_t state, uint8_t fault) {
    return fault < PALP_WIRE_FAULT_COUNT && (watching[fault] >> state & 1U) != 0;
}

bool supervisor_moving(uint8_t state) {
    return (MOVING >> state & 1U) != 0;
}

bool supervisor_drives(uint8_t state) {
    return (HELD >> state & 1U) != 0;
}
