/* process.h: the host process as the plant sees it. */
#ifndef PROCESS_H
#define PROCESS_H

#include <stdbool.h>

/* Opens the FIFOs that the arguments name; a restart starts the process with the same again. */
void process_open(char **arguments);
bool process_smashed(void); /* once after simulated_smash */

#endif
