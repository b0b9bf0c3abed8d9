/* blas.c: see blas.h. */
#define _DEFAULT_SOURCE /* MAP_ANONYMOUS */
#include "blas.h"
#include "cli.h"

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

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

/* Whether memory suffices for OpenBLAS in this number of threads, and 32 MiB more. Without it OpenBLAS
 * retries forever. A thread beside the first needs a stack and reserves 64 MiB for what it allocates. */
static bool fits(size_t threads) {
    const size_t each = 128, beside = 64 + 8;
    const size_t bytes = (threads * each + (threads > 1 ? threads * beside : 0) + 32) << 20;
    void *room = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return room != MAP_FAILED && munmap(room, bytes) == 0;
}

void blas_one_thread(char **argv) {
    void (*limit)(int) = (void (*)(int))find("openblas_set_num_threads");
    const char *threads = getenv("OPENBLAS_NUM_THREADS");
    struct rlimit space;
    if (!limit)
        return;
    bool limited = getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY;
    if (limited && !(threads && strcmp(threads, "1") == 0) && setenv("OPENBLAS_NUM_THREADS", "1", 1) == 0)
        execv("/proc/self/exe", argv); /* ends its threads, which may wait for memory */
    if (!fits(1)) {
        cli_failure(NULL, "too little memory: at least 160 MiB are needed; see ulimit -v");
        _exit(CLI_FAILURE); /* skips exit handlers, which would wait for its threads */
    }
    limit(1);
}

size_t blas_jobs(const char *name, size_t wanted) {
    int (*parallel)(void) = (int (*)(void))find("openblas_get_parallel");
    size_t jobs = wanted;
    if (wanted < 2 || !parallel)
        return wanted;
    if (parallel() == 0) {
        cli_warning(name,
                    "--jobs 1 is used: this OpenBLAS is not thread-safe (install libopenblas0-pthread)");
        return 1;
    }
    while (jobs > 1 && !fits(jobs))
        jobs--;
    if (jobs < wanted)
        cli_warning(name, "--jobs %zu is used: there is no memory for more", jobs);
    return jobs;
}
