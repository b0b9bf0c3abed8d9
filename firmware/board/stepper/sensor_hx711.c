/* sensor_hx711.c: a load cell and an HX711 at 80 samples a second (its RATE high). It converts by itself;
 * each sample settles over the four before. Its line is low when a sample is ready. 24 pulses shift it out,
 * and a 25th selects gain 128 for the next. */
#include "sensor_cell.h"
#include "../identity.h"

enum { BITS = 24, HALF_READS = 6 /* of a pin, at least 0.2 us; 60 us high would switch it off */ };
enum { SHIFT = 6 };

bool cell_start(void) {
    gpio_output(PIN_SENSOR_CLOCK, false);
    gpio_input(PIN_SENSOR_DATA, PULL_UP); /* an open wire never has a new sample */
    return true;
}

static void half(bool level) {
    gpio_write(PIN_SENSOR_CLOCK, level);
    for (int i = 0; i < HALF_READS; i++)
        (void)gpio_read(PIN_SENSOR_DATA);
}

bool cell_there(void) {
    return !gpio_read(PIN_SENSOR_DATA);
}

int32_t cell_take(void) {
    uint32_t bits = 0;
    for (int i = 0; i < BITS; i++) {
        half(true);
        bits = bits << 1 | (gpio_read(PIN_SENSOR_DATA) ? 1 : 0);
        half(false);
    }
    half(true);
    half(false);
    return (int32_t)(bits << (32 - BITS)) >> (32 - BITS + SHIFT);
}

const machine *hal_machine(void) {
    return &machine_stepper;
}

IDENTITY("stepper_hx711")
