/* watchdog.c: the independent watchdog: a reset when it was not kicked for 20 ms (14 to 38, by its
 * oscillator). */
#include "drivers.h"

enum { KEY_START = 0xcccc, KEY_WRITE = 0x5555, KEY_KICK = 0xaaaa, RELOAD = 160, POLLS = 100000 };

void watchdog_start(void) {
    IWDG->KR = KEY_START;
    IWDG->KR = KEY_WRITE;
    IWDG->PR = 0; /* 32 kHz by 4 */
    IWDG->RLR = RELOAD;
    (void)wait_for(&IWDG->SR, 3, 0, POLLS); /* else it runs with the longer time of its reset */
    hal_watchdog_kick();
}

void hal_watchdog_kick(void) {
    IWDG->KR = KEY_KICK;
}
