/* semihosting.h: the simulator's services: two FIFOs to the plant, and the end. */
#ifndef SEMIHOSTING_H
#define SEMIHOSTING_H

#include <stdbool.h>
#include <stdint.h>

/* Opens the two FIFOs that the command line names, plant-to-firmware first, and waits for the other side. A
 * failure of a call below is printed on the simulator's standard error and ends it. */
void semihosting_open(void);
void semihosting_read(uint8_t *byte, uint32_t n);
void semihosting_write(const uint8_t *byte, uint32_t n);
void semihosting_recall(uint32_t *word, uint32_t n);
void semihosting_keep(uint32_t at, const uint32_t *word, uint32_t n);
void semihosting_exit(bool good); /* ends the simulator: exit code 0 or 1 */

#endif
