/* hal.h: the functions that a board provides to the firmware, implemented once in each board's folder. Every
 * wait is bounded, except hal_tick_wait for the next tick. */
#ifndef HAL_H
#define HAL_H

#include "app.h"
#include "ring.h"

/* Starts clocks, pins and drivers; the motor stays off. Returns APP_*_FAILED, a bit each. The firmware runs
 * all the same, so that it can report them. */
uint8_t hal_init(void);
uint8_t hal_reset_cause(void);    /* APP_RESET_* */
const char *hal_board_name(void); /* at most PALP_WIRE_NAME bytes */
uint32_t hal_serial_number(void);
bool hal_is_simulated(void);
const machine *hal_machine(void);

/* Sleeps until the next control tick. Returns the ticks since the last call: 1 = on time, more = some were
 * missed. */
uint32_t hal_tick_wait(void);

void hal_sense(app_inputs *inputs);
/* The output holds until the next tick: if it is not renewed by then, the tick interrupt brakes the motor. */
void hal_drive(const app_outputs *outputs);

/* The parameters' flash (store.h). hal_init has erased what store_to_erase says, before anything could move.
 */
const uint32_t *hal_stored(void);
void hal_store(uint32_t at, uint32_t word); /* programs one word, within 0.1 ms */

/* Serial port: the rings are filled and drained by interrupt. */
bool hal_receive(uint8_t *byte);   /* false = nothing there */
void hal_transmit(ring *transmit); /* starts sending the ring's bytes; the ring must stay in place */

void hal_watchdog_kick(void);
bool hal_stack_intact(void); /* false once after each overrun of the stack's guard */
/* Reported to the host. 0 on a simulated board, so that the bytes sent do not depend on the compiler; the
 * plant gets the figures there (plant_link.h). */
uint32_t hal_cost(void);       /* a free-running count of processor cycles */
uint32_t hal_stack_free(void); /* bytes of the stack never used so far */

#endif
