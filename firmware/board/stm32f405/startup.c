/* startup.c: from reset to main, and from a processor fault back to reset with the motor off. */
#include "drivers.h"

typedef void handler(void);

/* stm32f405.ld */
extern uint32_t data_start[], data_end[], data_image[], bss_start[], bss_end[], stack_top[];
int main(void);

/* Called by the vector, whatever the state of the stack: begins a new one, and passes the old pointer on. */
__attribute__((naked)) static void fault_entry(void) {
    __asm volatile("mrs r0, msp\n\t"
                   "ldr r1, =stack_top\n\t"
                   "msr msp, r1\n\t"
                   "b fault_restart");
}

__attribute__((noreturn, used)) void fault_restart(uintptr_t pointer) {
    motor_off();
    reset_because(stack_overran(pointer) ? APP_RESET_STACK : APP_RESET_WATCHDOG);
    for (;;) /* the watchdog, should that fail */
        ;
}

static void memory_start(void) {
    const uint32_t *from = data_image;
    for (uint32_t *to = data_start; to < data_end; to++)
        *to = *from++;
    for (uint32_t *to = bss_start; to < bss_end; to++)
        *to = 0;
}

__attribute__((noreturn)) void reset_handler(void);

enum { SYSTEM_VECTORS = 16, VECTOR_COUNT = SYSTEM_VECTORS + USART1_IRQ + 1 };

/* A null entry is an interrupt that is never enabled. */
__attribute__((section(".vectors"), used)) static const union {
    uint32_t *stack;
    handler *code;
} vectors[VECTOR_COUNT] = {
    [0] = {.stack = stack_top},
    [1] = {.code = reset_handler},
    [2] = {.code = fault_entry}, /* NMI: the crystal stopped */
    [3] = {.code = fault_entry}, /* hard, memory, bus and usage faults */
    [4] = {.code = fault_entry},
    [5] = {.code = fault_entry},
    [6] = {.code = fault_entry},
    [15] = {.code = tick_interrupt},
    [SYSTEM_VECTORS + PVD_IRQ] = {.code = supply_interrupt},
    [SYSTEM_VECTORS + USART1_IRQ] = {.code = uart_interrupt},
};

void reset_handler(void) {
    SCB->CPACR |= SCB_CPACR_FPU;
    SCB->VTOR = (uint32_t)(uintptr_t)vectors; /* the boot loader leaves its own */
    SCB->SHCSR |= SCB_SHCSR_FAULTS;
    BARRIER();
    memory_start();
    stack_paint();
    guard_start();
    main();
    fault_restart((uintptr_t)stack_top);
}
