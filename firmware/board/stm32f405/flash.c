/* flash.c: the end of sector 10 and the beginning of sector 11 keep the parameters. RM0090, 3.6: wait,
 * unlock, program or erase, wait, lock. The processor stands still meanwhile: 16 us for a word, 0.1 ms at
 * most. Erasing 128 KiB takes 1 to 4 s, so that is done at the start only, before the watchdog and the tick.
 */
#include "drivers.h"

enum { FIRST_SECTOR = 10, PROGRAM_POLLS = 20000, ERASE_POLLS = 80000000 };
#define STORED REGISTERS_AT(reg, 0x080e0000u - STORE_AREA * sizeof(uint32_t))

static bool ready(uint32_t polls) {
    return wait_for(&FLASH->SR, FLASH_SR_BSY, 0, polls);
}

/* Begins an operation by words of 32 bits. Flags of earlier errors would forbid it. */
static bool unlock(uint32_t what) {
    if (!ready(PROGRAM_POLLS))
        return false;
    if ((FLASH->CR & FLASH_CR_LOCK) != 0) {
        FLASH->KEYR = FLASH_KEY_1;
        FLASH->KEYR = FLASH_KEY_2;
    }
    FLASH->SR = FLASH_SR_ERRORS;
    FLASH->CR = what | FLASH_CR_WORDS;
    return true;
}

/* The cache still holds the sector as it was before it was erased. */
static void forget_cached(void) {
    const uint32_t as_it_was = FLASH->ACR;
    FLASH->ACR = as_it_was & ~(uint32_t)FLASH_ACR_DATA_CACHE;
    FLASH->ACR |= FLASH_ACR_DATA_RESET;
    FLASH->ACR = as_it_was;
}

void flash_start(void) {
    const uint32_t area = store_to_erase(hal_stored());
    if (area >= STORE_AREAS || !unlock(FLASH_CR_SER | (FIRST_SECTOR + area) << 3))
        return;
    FLASH->CR |= FLASH_CR_STRT;
    BARRIER();
    (void)ready(ERASE_POLLS);
    FLASH->CR = FLASH_CR_LOCK;
    forget_cached();
}

const uint32_t *hal_stored(void) {
    return (const uint32_t *)STORED;
}

void hal_store(uint32_t at, uint32_t word) {
    if (!unlock(FLASH_CR_PG))
        return;
    STORED[at] = word;
    BARRIER();
    (void)ready(PROGRAM_POLLS);
    FLASH->CR = FLASH_CR_LOCK;
}
