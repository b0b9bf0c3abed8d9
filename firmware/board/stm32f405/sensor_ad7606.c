/* sensor_ad7606.c: six of the eight channels of an AD7606 over SPI1: serial mode, DOUTA, +-10 V. */
#include "../identity.h"
#include "drivers.h"

/* In polls of some eight cycles: BUSY rises 45 ns after CONVST and falls 4 us later; a word takes 1.5 us. */
enum { RISE_POLLS = 50, BUSY_POLLS = 500, WORD_POLLS = 200, RESET_POLLS = 10 };

static bool busy_becomes(bool level, uint32_t polls) {
    const uint32_t bit = 1u << PIN_SENSOR_BUSY % 16;
    return wait_for(&GPIO(PIN_SENSOR_BUSY / 16)->IDR, bit, level ? bit : 0, polls);
}

static bool pulse_reset(void) {
    gpio_write(PIN_SENSOR_RESET, true);
    (void)busy_becomes(false, RESET_POLLS);
    (void)busy_becomes(true, RESET_POLLS); /* either way a pause of over 50 ns */
    gpio_write(PIN_SENSOR_RESET, false);
    return busy_becomes(false, BUSY_POLLS);
}

bool gauge_start(void) {
    RCC->APB2ENR |= RCC_APB2ENR_SPI1;
    BARRIER();
    gpio_output(PIN_SENSOR_CS, true);
    gpio_output(PIN_SENSOR_CONVERT, true);
    gpio_output(PIN_SENSOR_RESET, false);
    gpio_input(PIN_SENSOR_BUSY, PULL_UP);
    gpio_alternate(PIN_SENSOR_CLOCK, ALTERNATE_SPI1, PULL_NONE);
    gpio_alternate(PIN_SENSOR_DATA, ALTERNATE_SPI1, PULL_UP); /* an open wire reads as -1 on all channels */
    /* The first bit is there when CS falls, the others after rising edges: read at falling ones, clock at
     * rest high. 10.5 MHz. */
    SPI1->CR1 = SPI_CR1_DFF | SPI_CR1_SSM | SPI_CR1_SSI | SPI_CR1_BY_8 | SPI_CR1_MSTR | SPI_CR1_CPOL;
    SPI1->CR1 |= SPI_CR1_SPE;
    return pulse_reset();
}

static volatile bool converting; /* BUSY was seen to rise at the last tick */

void gauge_convert(void) {
    gpio_write(PIN_SENSOR_CONVERT, false);
    (void)gpio_read(PIN_SENSOR_CONVERT); /* at least 25 ns */
    gpio_write(PIN_SENSOR_CONVERT, true);
    converting = busy_becomes(true, RISE_POLLS);
}

static bool read_words(int16_t adc[PALP_WIRE_CHANNELS]) {
    bool all = true;
    (void)SPI1->DR; /* what came too late the last time */
    gpio_write(PIN_SENSOR_CS, false);
    for (int i = 0; i < PALP_WIRE_CHANNELS && all; i++) {
        SPI1->DR = 0;
        all = wait_for(&SPI1->SR, SPI_SR_RXNE, SPI_SR_RXNE, WORD_POLLS);
        adc[i] = (int16_t)SPI1->DR;
    }
    gpio_write(PIN_SENSOR_CS, true);
    return all;
}

bool gauge_read(int16_t adc[PALP_WIRE_CHANNELS], bool *held) {
    *held = false;
    if (converting && busy_becomes(false, BUSY_POLLS) && read_words(adc))
        return true;
    for (int i = 0; i < PALP_WIRE_CHANNELS; i++)
        adc[i] = 0;
    (void)pulse_reset(); /* perhaps it answers the next time */
    return false;
}

IDENTITY("stm32f405")

const machine *hal_machine(void) {
    return &machine_indenter;
}
