/* blas.c: see blas.h. */
#define _POSIX_C_SOURCE 200809L
#include "blas.h"

#include <dlfcn.h>
#include <stddef.h>

typedef void (*any_function)(void);

static any_function find(const char *name) {
    union {
        void *object;
        any_function function;
    } symbol = {NULL};
    void *program = dlopen(NULL, RTLD_LAZY);
    if (program) {
        symbol.object = dlsym(program, name);
        dlclose(program);
    }
    return symbol.function;
}

void blas_one_thread(void) {
    void (*limit)(int) = (void (*)(int))find("openblas_set_num_threads");
    if (limit) {
        limit(1);
    }
}

bool blas_has_locks(void) {
    int (*parallel)(void) = (int (*)(void))find("openblas_get_parallel");
    return !parallel || parallel() != 0;
}
