/* clock.c: 168 MHz from an 8 MHz crystal, with two fallbacks. */
#include "drivers.h"

/* Of half a microsecond: 20 ms for a crystal, which takes some 2; 1 ms for a PLL, which takes 0.3. */
enum { CRYSTAL_POLLS = 40000, CLOCK_POLLS = 2000 };

/* PLL input 2 MHz, times 168, by 2; Q = 7 keeps the 48 MHz clock in its range. */
static uint32_t pll_factors(bool crystal) {
    const uint32_t divider = crystal ? 4 : 8;
    return divider | 168u << 6 | 7u << 24 | (crystal ? (uint32_t)RCC_PLLCFGR_HSE : 0);
}

/* A boot loader may have left the processor on the PLL, which then cannot be changed. */
static void use_internal(void) {
    RCC->CR |= RCC_CR_HSION;
    (void)wait_for(&RCC->CR, RCC_CR_HSIRDY, RCC_CR_HSIRDY, CLOCK_POLLS);
    RCC->CFGR = 0;
    (void)wait_for(&RCC->CFGR, RCC_CFGR_SWS, 0, CLOCK_POLLS);
}

/* The prefetch of revision A gives wrong instructions (errata sheet ES0182). */
static uint32_t flash_speedup(void) {
    return FLASH_ACR_CACHES | (*IDCODE >> 16 == IDCODE_REVISION_A ? 0 : (uint32_t)FLASH_ACR_PREFETCH);
}

static bool pll_start(bool crystal) {
    RCC->CR &= ~(uint32_t)RCC_CR_PLLON;
    if (!wait_for(&RCC->CR, RCC_CR_PLLRDY, 0, CLOCK_POLLS))
        return false;
    RCC->PLLCFGR = pll_factors(crystal);
    RCC->CR |= RCC_CR_PLLON;
    if (!wait_for(&RCC->CR, RCC_CR_PLLRDY, RCC_CR_PLLRDY, CLOCK_POLLS))
        return false;
    /* Flash first: at 168 MHz it needs five wait states. */
    FLASH->ACR = FLASH_ACR_5_WAITS | flash_speedup();
    if (!wait_for(&FLASH->ACR, FLASH_ACR_LATENCY, FLASH_ACR_5_WAITS, CLOCK_POLLS))
        return false;
    RCC->CFGR = RCC_CFGR_APB1_BY_4 | RCC_CFGR_APB2_BY_2 | RCC_CFGR_SW_PLL;
    return wait_for(&RCC->CFGR, RCC_CFGR_SWS, RCC_CFGR_SWS_PLL, CLOCK_POLLS);
}

clock_state clock_start(void) {
    use_internal();
    RCC->CR |= RCC_CR_HSEON;
    if (wait_for(&RCC->CR, RCC_CR_HSERDY, RCC_CR_HSERDY, CRYSTAL_POLLS) && pll_start(true)) {
        RCC->CR |= RCC_CR_CSSON; /* a crystal that stops later is an NMI, which restarts */
        return (clock_state){CLOCK_FULL_HZ, CLOCK_FULL_HZ / 2, true};
    }
    use_internal();
    RCC->CR &= ~(uint32_t)RCC_CR_HSEON;
    if (pll_start(false))
        return (clock_state){CLOCK_FULL_HZ, CLOCK_FULL_HZ / 2, false};
    use_internal(); /* enough to report it */
    return (clock_state){CLOCK_HSI_HZ, CLOCK_HSI_HZ, false};
}
