/* switches.c: home and emergency stop: normally closed to 3.3 V, so that an open wire reads as pressed. */
#include "drivers.h"

void switches_start(void) {
    gpio_input(PIN_HOME, PULL_DOWN); /* the emergency stop's pin is motor.c's, which stops by it */
}

bool switches_home(void) {
    return !gpio_read(PIN_HOME);
}

bool switches_emergency(void) {
    return !gpio_read(PIN_EMERGENCY);
}
