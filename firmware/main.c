/* main.c: the firmware's loop, the same on every board. */
#include "hal.h"

enum { RECEIVE_MOST = 128 }; /* bytes a tick; the line carries 92 */

static app indenter;

static void receive(void) {
    uint8_t byte;
    for (int i = 0; i < RECEIVE_MOST && app_listens(&indenter) && hal_receive(&byte); i++)
        app_receive(&indenter, byte);
}

/* One control tick. cost: of the last tick; returns its own. */
static uint32_t turn(uint32_t cost) {
    app_inputs inputs = {.position = 0};
    app_outputs outputs;
    const uint32_t passed = hal_tick_wait(), start = hal_cost();
    hal_sense(&inputs);
    inputs.missed = passed > 1 ? passed - 1 : 0;
    inputs.cost = cost;
    inputs.stack_intact = hal_stack_intact();
    inputs.stack_free = (uint16_t)hal_stack_free();
    receive();
    app_tick(&indenter, &inputs, &outputs);
    hal_drive(&outputs);
    if (outputs.stores)
        hal_store(outputs.store_at, outputs.store_word);
    hal_transmit(&indenter.stream.out);
    hal_watchdog_kick();
    return hal_cost() - start;
}

int main(void) {
    const uint8_t failed = hal_init();
    const app_identity who = {hal_board_name(), hal_serial_number(), hal_is_simulated()};
    uint32_t cost = 0;
    app_init(&indenter, hal_machine(), &who, hal_reset_cause(), failed);
    app_load(&indenter, hal_stored());
    for (;;)
        cost = turn(cost);
}
