/* process.c: the host process as the plant sees it: records, restart, end. */
#define _POSIX_C_SOURCE 200809L
#include "process.h"

#include "simulated.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static struct {
    char **arguments;
    int in, out, store;
    bool smashed;
} process;

static void give_up(const char *what, const char *why) {
    fprintf(stderr, "indenter_host: %s: %s\n", what, why);
    exit(1);
}

static int open_one(const char *fifo, int how) {
    const int fd = open(fifo, how | O_CLOEXEC, 0666);
    if (fd < 0)
        give_up(fifo, strerror(errno));
    return fd;
}

void process_open(char **arguments) {
    signal(SIGPIPE, SIG_IGN);
    process.arguments = arguments;
    process.in = open_one(arguments[1], O_RDONLY);
    process.out = open_one(arguments[2], O_WRONLY);
    process.store = arguments[3] ? open_one(arguments[3], O_RDWR | O_CREAT) : -1;
}

bool process_smashed(void) {
    const bool smashed = process.smashed;
    process.smashed = false;
    return smashed;
}

void simulated_write(const uint8_t out[PLANT_LINK_OUT]) {
    if (write(process.out, out, PLANT_LINK_OUT) != PLANT_LINK_OUT)
        give_up("the plant has gone", strerror(errno));
}

void simulated_read(uint8_t in[PLANT_LINK_IN]) {
    for (size_t got = 0; got < PLANT_LINK_IN;) {
        const ssize_t n = read(process.in, in + got, PLANT_LINK_IN - got);
        if (n == 0)
            give_up("the plant has gone", "end of its FIFO");
        if (n < 0 && errno != EINTR)
            give_up("the plant has gone", strerror(errno));
        got += n > 0 ? (size_t)n : 0;
    }
}

void simulated_recall(uint32_t *word, uint32_t n) {
    const size_t size = n * sizeof *word;
    if (process.store >= 0 && pread(process.store, word, size, 0) < 0)
        give_up(process.arguments[3], strerror(errno));
}

void simulated_keep(uint32_t at, const uint32_t *word, uint32_t n) {
    const size_t size = n * sizeof *word;
    if (process.store >= 0 && pwrite(process.store, word, size, (off_t)(at * sizeof *word)) != (ssize_t)size)
        give_up(process.arguments[3], strerror(errno));
}

void simulated_restart(void) {
    execv("/proc/self/exe", process.arguments);
    give_up("cannot restart", strerror(errno));
}

void simulated_end(void) {
    exit(0);
}

void simulated_smash(void) {
    process.smashed = true;
}
