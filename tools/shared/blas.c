/* blas.c: see blas.h. */
#define _POSIX_C_SOURCE 200809L
#include "blas.h"
#include "cli.h"

#include <dlfcn.h>

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
    if (limit)
        limit(1);
}

size_t blas_jobs(const char *name, size_t wanted) {
    int (*parallel)(void) = (int (*)(void))find("openblas_get_parallel");
    if (wanted < 2 || !parallel || parallel() != 0)
        return wanted;
    cli_warning(name, "one job at a time: this OpenBLAS has no locks (install libopenblas0-pthread)");
    return 1;
}
