/* process.c: the board under QEMU as the plant sees it: records, restart, end. */
#include "drivers.h"
#include "semihosting.h"
#include "simulated.h"

void simulated_write(const uint8_t out[PLANT_LINK_OUT]) {
    semihosting_write(out, PLANT_LINK_OUT);
}

void simulated_read(uint8_t in[PLANT_LINK_IN]) {
    semihosting_read(in, PLANT_LINK_IN);
}

void simulated_recall(uint32_t *word, uint32_t n) {
    semihosting_recall(word, n);
}

void simulated_keep(uint32_t at, const uint32_t *word, uint32_t n) {
    semihosting_keep(at, word, n);
}

void simulated_restart(void) {
    reset_because(APP_RESET_WATCHDOG);
}

void simulated_end(void) {
    semihosting_exit(true);
}

void simulated_smash(void) {
    extern uint32_t stack_bottom[];
    stack_bottom[0] = 0;
}
