/* test_serial.c: libserialport for real: an exchange with a device over a pseudo-terminal, with serial_shim.c
 * preloaded. */
/* link: -pthread */
#define _XOPEN_SOURCE 700
#include "indenter/device.h"
#include "device_peer.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <cmocka.h>

/* ---- the part with the shim: this program again, as the host ---- */

static int host_fails(const char *what, device *d) {
    fprintf(stderr, "host: %s: %s\n", what, d->why);
    device_close(d);
    return 1;
}

/* Shakes hands, asks for every class of gains, listens to the stream, sees the other end go. */
static int host(const char *port) {
    device d;
    palp_wire_message got, ask = {.type = PALP_WIRE_TYPE_GET_GAINS};
    device_result result = device_open(port, LINK_BAUD, &d);
    if (result != DEVICE_OK) {
        return host_fails("no handshake", &d);
    }
    for (uint8_t i = 0; i < 100; i++) {
        ask.as.get_gains.softness = i;
        if (device_command(&d, &ask, &got) != DEVICE_OK || got.as.gains.kp_N_m != 100U * i) {
            return host_fails("wrong gains", &d);
        }
    }
    if (device_do(&d, PALP_WIRE_TYPE_STREAM, NULL) != DEVICE_OK) {
        return host_fails("no stream", &d);
    }
    while (d.device_tick < 1000 && (result = device_poll(&d, 5000)) == DEVICE_OK) {
    }
    if (result != DEVICE_OK || d.lost_frames || d.decoder.bad) {
        return host_fails("samples lost", &d);
    }
    device_do(&d, PALP_WIRE_TYPE_STOP, NULL); /* the peer leaves */
    while ((result = device_poll(&d, 5000)) == DEVICE_OK) {
    }
    if (result != DEVICE_CLOSED || !strstr(d.why, "unplugged")) {
        return host_fails("not unplugged", &d);
    }
    device_close(&d);
    return 0;
}

/* ---- the part without: the device ---- */

/* This program's path, and the shim's beside it. */
static void find_programs(char self[PATH_MAX], char shim[PATH_MAX]) {
    ssize_t n = readlink("/proc/self/exe", self, PATH_MAX - 1);
    assert_true(n > 0);
    self[n] = '\0';
    const char *slash = strrchr(self, '/');
    assert_non_null(slash);
    snprintf(shim, PATH_MAX, "%.*s/serial_shim.so", (int)(slash - self), self);
    if (access(shim, R_OK) != 0)
        fail_msg("no %s: make %s", shim, shim);
}

static pid_t start_host(const char *port, bool shimmed) {
    char self[PATH_MAX], shim[PATH_MAX], preload[PATH_MAX + 16];
    find_programs(self, shim);
    snprintf(preload, sizeof preload, "LD_PRELOAD=%s", shim);
    pid_t child = fork();
    if (child == 0) { /* no setenv: the device's thread may have been in malloc */
        if (shimmed)
            execlp("env", "env", preload, "ASAN_OPTIONS=verify_asan_link_order=0", self, "host", port,
                   (char *)NULL);
        else
            execl(self, self, "host", port, (char *)NULL);
        _exit(127);
    }
    assert_true(child > 0);
    return child;
}

static int exit_code(pid_t child) {
    int status;
    while (waitpid(child, &status, 0) < 0)
        assert_int_equal(errno, EINTR);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static int open_master(char name[64]) {
    int master = posix_openpt(O_RDWR | O_NOCTTY);
    assert_true(master >= 0 && grantpt(master) == 0 && unlockpt(master) == 0);
    fcntl(master, F_SETFD, FD_CLOEXEC); /* the host would keep it open */
    snprintf(name, 64, "%s", ptsname(master));
    return master;
}

static void test_exchange(void **state) {
    peer_settings settings = {.stream_ticks = 10, .stream_on_demand = true, .leaves_at_stop = true};
    char name[64];
    peer p;
    int master = open_master(name), slave = open(name, O_RDWR | O_NOCTTY); /* held until the host has it */
    (void)state;
    assert_true(slave >= 0);
    peer_start(&p, master, &settings);
    pid_t child = start_host(name, true);
    int code = exit_code(child);
    peer_stop(&p);
    close(slave);
    if (p.fd >= 0)
        close(p.fd);
    assert_int_equal(code, 0);
    assert_int_equal(p.done[PALP_WIRE_TYPE_GET_GAINS], 100);
}

/* What the shim is for. */
static void test_without_shim(void **state) {
    char name[64];
    int master = open_master(name);
    (void)state;
    assert_int_equal(exit_code(start_host(name, false)), 1);
    close(master);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_exchange), cmocka_unit_test(test_without_shim)};
    if (argc == 3 && strcmp(argv[1], "host") == 0) {
        return host(argv[2]);
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
