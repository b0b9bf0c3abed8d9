/* trigger.c: a pulse in, of any length, and one out, which lasts until the next tick. The chip latches the
 * edge: its interrupt is not enabled in the NVIC, and only the pending bit is read. */
#include "drivers.h"

enum { LINE = PIN_TRIGGER_IN % 16, EDGE = 1 << LINE };

void trigger_start(void) {
    gpio_input(PIN_TRIGGER_IN, PULL_DOWN);
    gpio_output(PIN_TRIGGER_OUT, false);
    RCC->APB2ENR |= RCC_APB2ENR_SYSCFG;
    BARRIER();
    SYSCFG->EXTICR[LINE / 4] = (uint32_t)(PIN_TRIGGER_IN / 16) << LINE % 4 * 4;
    EXTI->RTSR |= EDGE;
    EXTI->PR = EDGE;
    EXTI->IMR |= EDGE;
}

bool trigger_came(void) {
    const bool came = (EXTI->PR & EDGE) != 0;
    EXTI->PR = EDGE;
    return came;
}

void trigger_give(bool high) {
    gpio_write(PIN_TRIGGER_OUT, high);
}
