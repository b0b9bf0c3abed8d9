/* supply.c: the processor's own supply. At 2.9 V an interrupt warns while the program still runs. At 2.8 V
 * the chip holds itself in reset, where its option bytes are set so; in a new chip they are not. */
#include "drivers.h"

enum {
    KEY_1 = 0x08192a3b,
    KEY_2 = 0x4c5d6e7f,
    OPTION_POLLS = 40000000 /* seconds: done once in a board's life */
};

/* BOR level 3, the highest. RM0090, 3.6.2: unlock, write, start, wait. */
static void reset_level(void) {
    if ((FLASH->OPTCR & FLASH_OPTCR_BOR) == 0)
        return;
    FLASH->OPTKEYR = KEY_1;
    FLASH->OPTKEYR = KEY_2;
    if (!wait_for(&FLASH->SR, FLASH_SR_BSY, 0, OPTION_POLLS))
        return;
    FLASH->OPTCR &= ~(uint32_t)FLASH_OPTCR_BOR;
    FLASH->OPTCR |= FLASH_OPTCR_OPTSTRT;
    (void)wait_for(&FLASH->SR, FLASH_SR_BSY, 0, OPTION_POLLS);
    FLASH->OPTCR |= FLASH_OPTCR_OPTLOCK;
}

void supply_start(void) {
    RCC->APB1ENR |= RCC_APB1ENR_PWR;
    BARRIER();
    reset_level();
    PWR->CR |= PWR_CR_PLS_2V9 | PWR_CR_PVDE;
    EXTI->RTSR |= EXTI_PVD; /* its output rises when the supply falls */
    EXTI->PR = EXTI_PVD;
    EXTI->IMR |= EXTI_PVD;
    NVIC->ISER[PVD_IRQ / 32] = 1u << PVD_IRQ % 32;
}

void supply_interrupt(void) {
    motor_off();
    reset_because(APP_RESET_BROWN_OUT);
}
