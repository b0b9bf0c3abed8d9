/* blas.h: the BLAS that the process runs on, and threads. */
#ifndef BLAS_H
#define BLAS_H

#include <stdbool.h>

/* OpenBLAS starts no threads of its own from here on: a result does not depend on their number. */
void blas_one_thread(void);

/* Whether several threads may call it. OpenBLAS without threads of its own is built without locks too (Debian's serial
 * variant, 0.3.21): threads that call it at once spoil each other's scratch memory. */
bool blas_has_locks(void);

#endif
