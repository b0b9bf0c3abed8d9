/* hal.h: what a board gives the firmware. One implementation a board folder; no call waits without a bound,
 * except hal_tick_wait for the next tick. */
#ifndef HAL_H
#define HAL_H

#include "app.h"
#include "ring.h"

/* Clocks, pins, drivers; the motor stays off. APP_*_FAILED, a bit each: the firmware goes on to say so. */
uint8_t hal_init(void);
uint8_t hal_reset_cause(void);    /* APP_RESET_* */
const char *hal_board_name(void); /* at most PALP_WIRE_NAME bytes */
uint32_t hal_serial_number(void);
bool hal_is_simulated(void);
const machine *hal_machine(void);

/* Sleeps until the next control tick; ticks since the last call: 1 = on time, more = some were missed. */
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
void hal_transmit(ring *transmit); /* starts sending what is in the ring; the ring must stay */

void hal_watchdog_kick(void);
bool hal_stack_intact(void); /* false once after each time that the stack overran its guard */
/* For the host to know. 0 where simulated, so that what is sent does not depend on what compiled it; there
 * the plant is told (plant_link.h). */
uint32_t hal_cost(void);       /* a free-running count of processor cycles */
uint32_t hal_stack_free(void); /* bytes of the stack never used so far */

#endif
