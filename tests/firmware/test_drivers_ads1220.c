/* test_drivers_ads1220.c: the cheap machine's faster amplifier on registers that are memory. */
#define DRIVERS_AMPLIFIER "../../firmware/board/stepper/sensor_ads1220.c"
#include "drivers_make.h"

/* Bytes over SPI, the first in front; a sample is there while DRDY is low. */
static void test_cell(void **state) {
    static const int16_t bytes[][3] = {
        {0x00, 0x00, 0x20}, {0xff, 0xff, 0xe0}, {0x0f, 0x42, 0x40}, {0x7f, 0xff, 0xff}, {0x80, 0, 0}};
    static const int16_t counts[] = {1, -1, 31250, 32767, -32768};
    app_inputs in;
    (void)state;
    fake_set_pin(PIN_EMERGENCY, true);
    fake_set_pin(PIN_SENSOR_BUSY, true);
    assert_int_equal(hal_init(), 0);
    assert_int_equal(hardware.words, 7); /* reset, four settings and their command, start */
    assert_int_equal(hardware.spi_cr1 & (SPI_CR1_CPHA | SPI_CR1_CPOL | SPI_CR1_DFF), SPI_CR1_CPHA);
    assert_false(fake_pin(PIN_SENSOR_CS));
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        for (int k = 0; k < 3; k++)
            hardware.channel[k] = bytes[i][k];
        hardware.next_channel = 0;
        fake_set_pin(PIN_SENSOR_BUSY, false);
        hal_sense(&in);
        assert_false(in.force_held || in.sensor_silent);
        assert_int_equal(in.adc[0], counts[i]);
        fake_set_pin(PIN_SENSOR_BUSY, true);
        hal_sense(&in);
        assert_true(in.force_held);
        assert_int_equal(in.adc[0], counts[i]);
    }
    assert_ptr_equal(hal_machine(), &machine_stepper_fast);
}

/* One that does not answer is silent, and waited for no longer than is bounded. */
static void test_absent(void **state) {
    app_inputs in;
    (void)state;
    hardware.spi_answers = false;
    fake_set_pin(PIN_SENSOR_BUSY, true);
    (void)hal_init();
    fake_set_pin(PIN_SENSOR_BUSY, true);
    for (int i = 0; i < 71; i++)
        hal_sense(&in);
    assert_true(in.sensor_silent);
    assert_true(hardware.polls < 200000);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup(test_cell, setup),
    cmocka_unit_test_setup(test_absent, setup),
    {0},
};
