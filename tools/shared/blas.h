/* blas.h: the BLAS that the process runs on, and threads. */
#ifndef BLAS_H
#define BLAS_H

#include <stddef.h>

/* Prevents OpenBLAS from starting threads, so that results do not depend on their number. If memory is
 * limited, the program restarts (argv) without its threads. With too little memory it ends with a message.
 * Call first in main. */
void blas_one_thread(char **argv);

/* Number of threads of a command (its name) that may call BLAS: wanted, or fewer with a warning if memory is
 * short, and 1 if BLAS is not thread-safe (Debian's serial OpenBLAS 0.3.21). */
size_t blas_jobs(const char *name, size_t wanted);

#endif
