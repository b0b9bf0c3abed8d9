/* supervisor.h: states, the events that lead from one to another, and the faults that stop. */
#ifndef SUPERVISOR_H
#define SUPERVISOR_H

#include <palpate/wire.h>

/* X(NAME): what can happen to a state. */
#define SUPERVISOR_EVENTS(X)                                                                                 \
    X(STARTED) X(HOME) X(HOMED) X(FIND_CONTACT) X(START) X(JOG) X(DONE) X(STOP) X(FAULT) X(CLEAR)

typedef enum supervisor_event {
#define SUPERVISOR_MEMBER(name) SUPERVISOR_##name,
    SUPERVISOR_EVENTS(SUPERVISOR_MEMBER)
#undef SUPERVISOR_MEMBER
        SUPERVISOR_EVENT_COUNT
} supervisor_event;

typedef struct supervisor {
    uint8_t state; /* palp_wire_state */
    uint8_t fault; /* palp_wire_fault, latched */
    uint32_t fault_tick;
} supervisor;

/* Next state by the table; false and no change where the event means nothing. */
bool supervisor_take(supervisor *s, supervisor_event event);
/* Latches the first fault if this state watches for it (a table too); true if it stopped. */
bool supervisor_fault(supervisor *s, uint8_t fault, uint32_t tick);
bool supervisor_watches(uint8_t state, uint8_t fault);
bool supervisor_moving(uint8_t state); /* a motion is in progress */
bool supervisor_drives(
    uint8_t state); /* the motor is on: in motion, and in READY, where it holds the plate */

#endif
