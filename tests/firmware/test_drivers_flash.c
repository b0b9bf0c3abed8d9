/* test_drivers_flash.c: the parameters' flash on fake registers: erased at the start only, programmed word by
 * word. */
#include "drivers_make.h"

static void test_blank_is_left(void **state) {
    (void)state;
    flash_start();
    assert_int_equal(FLASH->CR, FLASH_CR_LOCK);
    assert_ptr_equal(hal_stored(), hardware.stored);
}

static void test_word(void **state) {
    (void)state;
    hal_store(3, 0x12345678);
    assert_int_equal(hardware.stored[3], 0x12345678);
    assert_int_equal(FLASH->CR, FLASH_CR_LOCK);
    assert_int_equal(FLASH->SR & FLASH_SR_ERRORS, FLASH_SR_ERRORS); /* cleared by writing ones */
    assert_true(hardware.polls < 10);
}

/* The area that is not needed, and no other. */
static void test_erases(void **state) {
    (void)state;
    hardware.stored[0] = hardware.stored[STORE_AREA] = 5; /* nothing good anywhere */
    FLASH->ACR = FLASH_ACR_5_WAITS | FLASH_ACR_CACHES;
    flash_start();
    assert_int_equal(hardware.stored[0], 5); /* damage must be reported */
    assert_int_equal(hardware.stored[STORE_AREA], STORE_BLANK);
    assert_int_equal(FLASH->CR, FLASH_CR_LOCK);
    assert_int_equal(FLASH->ACR, FLASH_ACR_5_WAITS | FLASH_ACR_CACHES);
    hardware.stored[STORE_AREA + 7] = 0;
    flash_start();
    assert_int_equal(hardware.stored[STORE_AREA + 7], STORE_BLANK);
}

/* Bounded: a second or so at the start, nothing that the watchdog would see later. */
static void test_hangs(void **state) {
    (void)state;
    hardware.flash_hangs = true;
    hardware.stored[STORE_AREA] = 5;
    flash_start();
    hal_store(1, 0);
    assert_int_equal(hardware.stored[1], STORE_BLANK);
    assert_true(hardware.polls <= 2 * 20000);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup(test_blank_is_left, setup),
    cmocka_unit_test_setup(test_word, setup),
    cmocka_unit_test_setup(test_erases, setup),
    cmocka_unit_test_setup(test_hangs, setup),
    {0},
};
