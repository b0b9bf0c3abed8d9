/* sensor_ads1220.c: a load cell and an ADS1220 at 1200 samples a second, gain 128, its reference the cell's
 * supply: a new sample each tick. SPI1 in bytes, data read at falling edges. */
#include "sensor_cell.h"
#include "../identity.h"

enum { WORD_POLLS = 400, RESET_POLLS = 20000, SHIFT = 5 };
enum { RESET = 0x06, START = 0x08, WRITE_ALL = 0x43 };

/* Inputs 0 and 1, gain 128; 1200 a second (turbo), without an end; reference at REFP0 and REFN0; nothing
 * else. */
static const uint8_t settings[] = {WRITE_ALL, 0x0e, 0xb4, 0x40, 0x00, START};

static uint8_t exchange(uint8_t byte) {
    SPI1->DR = byte;
    return wait_for(&SPI1->SR, SPI_SR_RXNE, SPI_SR_RXNE, WORD_POLLS) ? (uint8_t)SPI1->DR : 0xff;
}

bool cell_start(void) {
    RCC->APB2ENR |= RCC_APB2ENR_SPI1;
    BARRIER();
    gpio_output(PIN_SENSOR_CS, true);
    gpio_input(PIN_SENSOR_BUSY, PULL_UP); /* its DRDY: low when a sample is there */
    gpio_alternate(PIN_SENSOR_CLOCK, ALTERNATE_SPI1, PULL_NONE);
    gpio_alternate(PIN_SENSOR_DATA, ALTERNATE_SPI1, PULL_UP);
    gpio_alternate(PIN_SENSOR_COMMAND, ALTERNATE_SPI1, PULL_NONE);
    SPI1->CR1 = SPI_CR1_SSM | SPI_CR1_SSI | SPI_CR1_BY_16 | SPI_CR1_MSTR | SPI_CR1_CPHA;
    SPI1->CR1 |= SPI_CR1_SPE;
    gpio_write(PIN_SENSOR_CS, false);
    (void)exchange(RESET);
    (void)wait_for(&GPIO(PIN_SENSOR_BUSY / 16)->IDR, 1u << PIN_SENSOR_BUSY % 16, 0,
                   RESET_POLLS); /* 50 us and more */
    for (size_t i = 0; i < sizeof settings; i++)
        (void)exchange(settings[i]);
    return true;
}

bool cell_there(void) {
    return !gpio_read(PIN_SENSOR_BUSY);
}

int32_t cell_take(void) {
    uint32_t bits = exchange(0);
    bits = bits << 8 | exchange(0);
    bits = bits << 8 | exchange(0);
    return (int32_t)(bits << 8) >> (8 + SHIFT);
}

const machine *hal_machine(void) {
    return &machine_stepper_fast;
}

IDENTITY("stepper_ads1220")
