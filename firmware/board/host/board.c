/* board.c: the firmware as a process of this machine, in lockstep with the simulated plant:
 *   indenter_host PLANT_TO_FIRMWARE FIRMWARE_TO_PLANT [FLASH]
 * The first two are FIFOs; FLASH is a file that keeps the parameters. Exit code 0 after PLANT_EVENT_QUIT, 1
 * when something failed or the plant has gone, 2 for wrong arguments. */
#include "process.h"
#include "simulated.h"

#include <stdio.h>

int firmware_main(void); /* firmware/main.c */

static uint8_t cause; /* of the start */

uint8_t hal_init(void) {
    cause = simulated_boot();
    return 0;
}

uint8_t hal_reset_cause(void) {
    return cause;
}

const char *hal_board_name(void) {
    return "host";
}

uint32_t hal_tick_wait(void) {
    const uint32_t ticks = simulated_late() ? 2 : 1;
    for (uint32_t i = 0; i < ticks; i++)
        simulated_tick(0, 0);
    return ticks;
}

void hal_drive(const app_outputs *outputs) {
    simulated_drive(outputs);
}

void hal_watchdog_kick(void) {
}

bool hal_stack_intact(void) {
    return !process_smashed();
}

int main(int argc, char **argv) {
    if (argc != 3 && argc != 4) {
        fprintf(stderr, "usage: indenter_host PLANT_TO_FIRMWARE FIRMWARE_TO_PLANT [FLASH]\n");
        return 2;
    }
    process_open(argv);
    return firmware_main();
}
