/* board.c: the firmware as a process of this machine, in lockstep with the simulated plant:
 *   indenter_host --plant-in FIFO --plant-out FIFO --port unix:PATH|pty|tcp:PORT
 * "port ..." on stdout says what to connect to. Exit code 0 after PLANT_EVENT_QUIT, 1 when something failed
 * or the plant has gone, 2 for wrong options. */
#define _GNU_SOURCE
#include "port.h"
#include "simulated.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int firmware_main(void); /* firmware/main.c */

/* By name on the command line; --kept is added when the process restarts itself. */
enum { OPTION_IN, OPTION_OUT, OPTION_PORT, OPTION_KEPT, OPTION_COUNT };
static const char *const option_name[OPTION_COUNT] = {"--plant-in", "--plant-out", "--port", "--kept"};

static struct {
    const char *option[OPTION_COUNT];
    int in, out;
    uint8_t cause;
    bool smashed;
} host;

static void give_up(const char *what, const char *why) {
    fprintf(stderr, "indenter_host: %s: %s\n", what, why);
    exit(1);
}

static void open_all(void) {
    host.in = open(host.option[OPTION_IN], O_RDONLY);
    if (host.in < 0)
        give_up(host.option[OPTION_IN], strerror(errno));
    host.out = open(host.option[OPTION_OUT], O_WRONLY);
    if (host.out < 0)
        give_up(host.option[OPTION_OUT], strerror(errno));
    const char *why = port_open(host.option[OPTION_PORT]);
    if (why != NULL)
        give_up(host.option[OPTION_PORT], why);
}

static void resume(void) {
    port_files files;
    if (sscanf(host.option[OPTION_KEPT], "%d,%d,%d,%d", &host.in, &host.out, &files.listener,
               &files.connection) != 4)
        give_up("--kept", "not what a restart leaves");
    port_resume(host.option[OPTION_PORT], files);
}

uint8_t hal_init(void) {
    signal(SIGPIPE, SIG_IGN);
    if (host.option[OPTION_KEPT] != NULL)
        resume();
    else
        open_all();
    host.cause = simulated_boot();
    return 0;
}

uint8_t hal_reset_cause(void) {
    return host.cause;
}

const char *hal_board_name(void) {
    return "host";
}

uint32_t hal_tick_wait(void) {
    const uint32_t ticks = simulated_late() ? 2 : 1;
    for (uint32_t i = 0; i < ticks; i++)
        simulated_tick(0, 0);
    port_poll();
    return ticks;
}

void hal_drive(const app_outputs *outputs) {
    simulated_drive(outputs);
}

void hal_watchdog_kick(void) {
}

bool hal_stack_intact(void) {
    const bool intact = !host.smashed;
    host.smashed = false;
    return intact;
}

void simulated_swap(const uint8_t out[PLANT_LINK_OUT], uint8_t in[PLANT_LINK_IN]) {
    size_t got = 0;
    if (write(host.out, out, PLANT_LINK_OUT) != PLANT_LINK_OUT)
        give_up("the plant has gone", strerror(errno));
    while (got < PLANT_LINK_IN) {
        const ssize_t n = read(host.in, in + got, PLANT_LINK_IN - got);
        if (n == 0)
            give_up("the plant has gone", "end of its FIFO");
        if (n < 0 && errno != EINTR)
            give_up("the plant has gone", strerror(errno));
        got += n > 0 ? (size_t)n : 0;
    }
}

void simulated_restart(void) {
    char kept[64], name[] = "indenter_host";
    char *list[2 * OPTION_COUNT + 2] = {name};
    const port_files files = port_kept();
    snprintf(kept, sizeof kept, "%d,%d,%d,%d", host.in, host.out, files.listener, files.connection);
    host.option[OPTION_KEPT] = kept;
    for (int i = 0; i < OPTION_COUNT; i++) {
        list[2 * i + 1] = (char *)(uintptr_t)option_name[i];
        list[2 * i + 2] = (char *)(uintptr_t)host.option[i];
    }
    execv("/proc/self/exe", list);
    give_up("cannot restart", strerror(errno));
}

void simulated_quit(ring *transmit) {
    uint32_t before = UINT32_MAX;
    while (transmit != NULL && ring_used(transmit) > 0 && ring_used(transmit) < before) {
        before = ring_used(transmit);
        serial_send(transmit);
    }
    exit(0);
}

void simulated_smash(void) {
    host.smashed = true;
}

static int usage(void) {
    fprintf(stderr, "usage: indenter_host --plant-in FIFO --plant-out FIFO --port unix:PATH|pty|tcp:PORT\n");
    return 2;
}

int main(int argc, char **argv) {
    for (int i = 1; i < argc; i += 2) {
        int which = 0;
        while (which < OPTION_COUNT && strcmp(argv[i], option_name[which]) != 0)
            which++;
        if (which == OPTION_COUNT || i + 1 == argc)
            return usage();
        host.option[which] = argv[i + 1];
    }
    if (host.option[OPTION_IN] == NULL || host.option[OPTION_OUT] == NULL || host.option[OPTION_PORT] == NULL)
        return usage();
    return firmware_main();
}
