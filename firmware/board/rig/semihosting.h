/* semihosting.h: the simulator's services: two FIFOs to the plant, and the end. */
#ifndef SEMIHOSTING_H
#define SEMIHOSTING_H

#include <stdbool.h>
#include <stdint.h>

/* Opens the two FIFOs that the command line names, plant-to-firmware first; waits for the other side. */
bool semihosting_open(void);
bool semihosting_read(uint8_t *byte, uint32_t n); /* all of it, or false: the other side has gone */
bool semihosting_write(const uint8_t *byte, uint32_t n);
void semihosting_say(const char *text); /* on the simulator's standard error */
void semihosting_exit(bool good);       /* ends the simulator: exit code 0 or 1 */

#endif
