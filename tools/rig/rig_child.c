/* rig_child.c: the virtual indenter in a child process, for palpate acquire. */
#define _GNU_SOURCE
#include "shared/cli.h"
#include "rig_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

enum { START_MS = 20000 };

static volatile sig_atomic_t closed;

static void on_close(int number) {
    (void)number;
    closed = 1;
}

/* The child: Ctrl-C at the terminal does not reach it. SIGTERM ends it, and so does its parent's end. */
static void be_rig(const char *name, const rig_settings *settings, pid_t parent) {
    struct sigaction act = {.sa_handler = on_close};
    sigaction(SIGTERM, &act, NULL);
    signal(SIGPIPE, SIG_IGN);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    int code = CLI_FAILURE;
    if (setpgid(0, 0) == 0 && getppid() == parent)
        code = rig_run(name, settings, &closed, NULL, NULL, NULL);
    _exit(code);
}

/* False if the child ends before its first bytes, or sends none in time. */
static bool wait_for_bytes(int fd, pid_t *child, int *code) {
    struct pollfd one = {.fd = fd, .events = POLLIN};
    int status, ready;
    char byte;
    while ((ready = poll(&one, 1, START_MS)) < 0 && errno == EINTR) {
    }
    bool came = ready > 0 && recv(fd, &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 1;
    if (ready > 0 && !came && waitpid(*child, &status, 0) == *child) {
        *child = 0;
        *code = WIFEXITED(status) && WEXITSTATUS(status) ? WEXITSTATUS(status) : CLI_FAILURE;
    }
    return came;
}

int rig_open(const char *name, const rig_settings *settings, rig *r) {
    char port[32];
    rig_settings own = *settings;
    pid_t parent = getpid();
    int code = CLI_OK, end[2];
    *r = (rig){.child = 0, .fd = -1};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, end) != 0)
        return cli_failure(name, "a socket: %s", strerror(errno));
    snprintf(port, sizeof port, "fd:%d", end[1]);
    own.port = port;
    r->child = fork();
    if (r->child == 0) {
        close(end[0]);
        be_rig(name, &own, parent);
    }
    close(end[1]);
    if (r->child < 0 || !wait_for_bytes(end[0], &r->child, &code)) {
        close(end[0]);
        rig_close(r);
        return code ? code : cli_failure(name, "the virtual indenter does not start");
    }
    r->fd = fcntl(end[0], F_DUPFD_CLOEXEC, 0);
    snprintf(r->port, sizeof r->port, "fd:%d", end[0]);
    return CLI_OK;
}

void rig_open_again(rig *r) {
    if (r->child > 0)
        snprintf(r->port, sizeof r->port, "fd:%d", fcntl(r->fd, F_DUPFD_CLOEXEC, 0));
}

void rig_pause(const rig *r, bool on) {
    if (r->child > 0)
        kill(-r->child, on ? SIGSTOP : SIGCONT);
}

int rig_close(rig *r) {
    int status = 0;
    if (r->child <= 0)
        return CLI_OK;
    kill(r->child, SIGTERM);
    while (waitpid(r->child, &status, 0) < 0 && errno == EINTR) {
    }
    r->child = 0;
    close(r->fd);
    return WIFEXITED(status) ? WEXITSTATUS(status) : CLI_FAILURE;
}
