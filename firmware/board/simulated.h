/* simulated.h: a board whose sensors and motor are the simulated plant. simulated.c is shared by the image
 * under QEMU (rig) and the process (host); the functions below differ between them. */
#ifndef SIMULATED_H
#define SIMULATED_H

#include "hal.h"
#include "plant_link.h"

uint8_t simulated_boot(void); /* exchanges the first record; returns the plant's APP_RESET_* */
/* At every tick: sends the last output and the figures to the plant, and takes the next input from it. */
void simulated_tick(uint32_t last_cost, uint16_t stack_free);
void simulated_drive(const app_outputs *outputs);
bool simulated_late(void); /* once after PLANT_EVENT_LATE */

/* The board's own: a record each way, flash, restart, end, overwritten guard of the stack. process.c */
void simulated_write(const uint8_t out[PLANT_LINK_OUT]);
void simulated_read(uint8_t in[PLANT_LINK_IN]);
void simulated_recall(uint32_t *word, uint32_t n); /* from the file that is the flash, as many as it has */
void simulated_keep(uint32_t at, const uint32_t *word, uint32_t n);
void simulated_restart(void);
void simulated_end(void);
void simulated_smash(void);

#endif
