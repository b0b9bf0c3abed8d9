/* tick.c: the control tick, and the motor's output that expires with it. */
#include "drivers.h"

static struct {
    volatile uint32_t count;
    volatile bool renewed;
    uint32_t seen;         /* count at the last wake */
    uint32_t woken, spent; /* cycles then, and until the sleep after it */
} tick;

void tick_start(uint32_t clock_hz) {
    SYSTICK->LOAD = clock_hz / CONTROL_HZ - 1;
    SYSTICK->VAL = 0;
    SYSTICK->CTRL = SYSTICK_CTRL_ON;
}

uint32_t tick_now(void) {
    return tick.count;
}

uint32_t tick_spent(void) {
    return tick.spent;
}

void tick_renew(void) {
    tick.renewed = true;
}

void tick_interrupt(void) {
    board_tick();
    if (!tick.renewed)
        motor_brake();
    tick.renewed = false;
    tick.count++;
}

uint32_t hal_tick_wait(void) {
    uint32_t passed;
    tick.spent = tick.seen > 0 ? board_cycles() - tick.woken : 0;
    for (;;) {
        INTERRUPTS_OFF(); /* else a tick between the look and the sleep would be slept through */
        passed = tick.count - tick.seen;
        if (passed == 0)
            SLEEP(); /* a pending interrupt ends it though it is off */
        INTERRUPTS_ON();
        if (passed > 0)
            break;
    }
    tick.seen += passed;
    tick.woken = board_cycles();
    return passed;
}
