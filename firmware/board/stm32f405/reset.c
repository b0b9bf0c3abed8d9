/* reset.c: why the processor started, and starting it again. */
#include "drivers.h"

enum { NOTE = 0x5eed0000 };

extern volatile uint32_t reset_note; /* outlives a reset; stm32f405.ld */

uint8_t reset_cause(void) {
    const uint32_t flags = RCC->CSR, note = reset_note;
    RCC->CSR |= RCC_CSR_RMVF;
    reset_note = 0;
    if ((flags & RCC_CSR_PORRSTF) != 0) /* what the memory holds then is chance */
        return APP_RESET_POWER;
    if ((flags & RCC_CSR_BORRSTF) != 0)
        return APP_RESET_BROWN_OUT;
    if ((flags & RCC_CSR_IWDGRSTF) != 0)
        return APP_RESET_WATCHDOG;
    return (note & 0xffffff00u) == NOTE ? (uint8_t)note : APP_RESET_POWER;
}

void reset_because(uint8_t cause) {
    reset_note = NOTE | cause;
    BARRIER();
    SCB->AIRCR = SCB_AIRCR_RESET;
    BARRIER();
}
