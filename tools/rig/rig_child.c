/* rig_child.c: the virtual indenter in a child process, for palpate acquire. */
#define _GNU_SOURCE
#include "shared/cli.h"
#include "rig_internal.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

enum { START_MS = 20000 };

static volatile sig_atomic_t closed;

static void on_close(int number) {
    (void)number;
    closed = 1;
}

/* The child: no Ctrl-C of the terminal's reaches it; SIGTERM, also at its parent's death, ends it. */
static void be_rig(const char *name, const rig_settings *settings, pid_t parent) {
    struct sigaction act = {.sa_handler = on_close};
    sigaction(SIGTERM, &act, NULL);
    signal(SIGPIPE, SIG_IGN);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    int code = CLI_FAILURE;
    if (setpgid(0, 0) == 0 && getppid() == parent) {
        code = rig_run(name, settings, &closed, NULL, NULL, NULL);
    }
    _exit(code);
}

/* A listening socket in a folder of its own; -1 and errno. */
static int listen_in(const char *folder, char path[RIG_PATH]) {
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    int n = snprintf(address.sun_path, sizeof address.sun_path, "%s/uart", folder);
    strcpy(path, address.sun_path);
    if (fd >= 0 && (n >= (int)sizeof address.sun_path ||
                    bind(fd, (struct sockaddr *)&address, sizeof address) != 0 || listen(fd, 1) != 0)) {
        close(fd);
        fd = -1;
    }
    return fd;
}

/* The firmware's connection; -1 if the child ends before it comes, or it does not come. */
static int accept_from(int listener, pid_t *child, int *code) {
    for (int waited_ms = 0; waited_ms < START_MS; waited_ms += 50) {
        struct pollfd one = {.fd = listener, .events = POLLIN};
        int status;
        if (poll(&one, 1, 50) > 0) {
            return accept4(listener, NULL, NULL, SOCK_CLOEXEC);
        }
        if (waitpid(*child, &status, WNOHANG) == *child) {
            *child = 0;
            *code = WIFEXITED(status) && WEXITSTATUS(status) ? WEXITSTATUS(status) : CLI_FAILURE;
            return -1;
        }
    }
    return -1;
}

static int start_child(const char *name, const rig_settings *settings, const char *path, int listener,
                       rig *r) {
    char port[RIG_PATH + 8];
    rig_settings own = *settings;
    pid_t parent = getpid();
    int code = CLI_OK;
    snprintf(port, sizeof port, "unix:%s", path);
    own.port = port;
    r->child = fork();
    if (r->child == 0) {
        close(listener);
        be_rig(name, &own, parent);
    }
    int fd = r->child > 0 ? accept_from(listener, &r->child, &code) : -1;
    if (fd < 0) {
        rig_close(r);
        return code ? code : cli_failure(name, "the virtual indenter does not start");
    }
    snprintf(r->port, sizeof r->port, "fd:%d", fd);
    return CLI_OK;
}

int rig_open(const char *name, const rig_settings *settings, rig *r) {
    char folder[RIG_PATH], path[RIG_PATH] = "";
    *r = (rig){.child = 0};
    if (!rig_folder(folder)) {
        return cli_failure(name, "a temporary folder: %s", strerror(errno));
    }
    int listener = listen_in(folder, path);
    int code = listener < 0 ? cli_failure(name, "%s: %s", path, strerror(errno))
                            : start_child(name, settings, path, listener, r);
    if (listener >= 0) {
        close(listener);
    }
    unlink(path);
    rmdir(folder);
    return code;
}

int rig_close(rig *r) {
    int status = 0;
    if (r->child <= 0) {
        return CLI_OK;
    }
    kill(r->child, SIGTERM);
    while (waitpid(r->child, &status, 0) < 0 && errno == EINTR) {
    }
    r->child = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : CLI_FAILURE;
}
