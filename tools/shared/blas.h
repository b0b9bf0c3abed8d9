/* blas.h: the BLAS that the process runs on, and threads. */
#ifndef BLAS_H
#define BLAS_H

#include <stddef.h>

/* OpenBLAS starts no threads of its own from here on: a result does not depend on their number. Where memory
 * is limited the program is started anew (argv) without those that it has; where there is too little, which
 * OpenBLAS waits for without end, it ends with a message. Called first in main. */
void blas_one_thread(char **argv);

/* How many threads of a command (its name) may call it: wanted, or with a warning as many as memory holds,
 * and 1 where BLAS has no locks. OpenBLAS without threads of its own is built without them (Debian's serial
 * variant, 0.3.21): threads that call it at once spoil each other's scratch memory. */
size_t blas_jobs(const char *name, size_t wanted);

#endif
