/* rig_port.c: where the virtual indenter answers: a pseudo-terminal, TCP, a file or an open socket. */
#define _GNU_SOURCE
#include "rig_port.h"

#include "shared/cli.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

enum { PATIENCE_MS = 10000 };

/* After the other end was opened and closed once, it reads as hung up until somebody opens it. */
static int open_pty(char *name, size_t size) {
    struct termios raw;
    int fd = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (fd < 0 || grantpt(fd) != 0 || unlockpt(fd) != 0 || tcgetattr(fd, &raw) != 0)
        return -1;
    cfmakeraw(&raw);
    tcsetattr(fd, TCSANOW, &raw);
    int other = open(ptsname(fd), O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (other >= 0)
        close(other);
    snprintf(name, size, "pty:%s", ptsname(fd));
    return fd;
}

static int listen_at(const char *number, char *name, size_t size) {
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons((uint16_t)atoi(number))};
    int fd = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0), yes = 1;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    snprintf(name, size, "tcp:127.0.0.1:%.5s", number);
    if (fd >= 0 && (setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) != 0 ||
                    bind(fd, (struct sockaddr *)&address, sizeof address) != 0 || listen(fd, 1) != 0)) {
        close(fd);
        fd = -1;
    }
    return fd;
}

int rig_port_open(const char *command, const char *wanted, rig_port *port, char *name, size_t size) {
    int code = CLI_OK;
    *port = (rig_port){.command = command, .listener = -1, .connection = -1, .patience_ms = PATIENCE_MS};
    snprintf(name, size, "%s", wanted);
    if (strncmp(wanted, "file:", 5) == 0) {
        port->kind = RIG_PORT_FILE;
        code = cli_file_open(command, wanted + 5, &port->file);
        port->connection = code ? -1 : fileno(port->file.stream);
    } else if (strncmp(wanted, "tcp:", 4) == 0) {
        port->listener = listen_at(wanted + 4, name, size);
    } else if (strncmp(wanted, "fd:", 3) == 0) {
        port->connection = atoi(wanted + 3);
    } else {
        port->kind = RIG_PORT_PTY;
        port->connection = open_pty(name, size);
    }
    bool open =
        port->listener >= 0 || (port->connection >= 0 && fcntl(port->connection, F_SETFL, O_NONBLOCK) == 0);
    return code || open ? code : cli_failure(command, "%s: %s", wanted, strerror(errno));
}

/* A write that failed is reported now. */
static int close_file(rig_port *port) {
    if (!port->failed)
        return cli_file_close(port->command, &port->file);
    int code = cli_failure(port->command, "%s: cannot write: %s", port->file.path, strerror(port->failed));
    palp_file_abandon(&port->file);
    return code;
}

int rig_port_close(rig_port *port) {
    int code = CLI_OK;
    if (port->file.stream)
        code = close_file(port);
    else if (port->connection >= 0)
        close(port->connection);
    if (port->listener >= 0)
        close(port->listener);
    port->listener = port->connection = -1;
    return code;
}

static void hang_up(rig_port *port) {
    if (port->kind != RIG_PORT_PTY) { /* which stays open for the next one */
        close(port->connection);
        port->connection = -1;
    }
}

size_t rig_port_read(rig_port *port, uint8_t *byte, size_t most) {
    if (port->connection < 0 && port->listener >= 0)
        port->connection = accept4(port->listener, NULL, NULL, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (port->kind == RIG_PORT_FILE || port->connection < 0 || most == 0)
        return 0;
    ssize_t n = read(port->connection, byte, most);
    if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR))
        hang_up(port);
    return n > 0 ? (size_t)n : 0;
}

/* Waits at most its patience for an event at the port. */
static short wait_for_room(const rig_port *port) {
    struct pollfd p = {port->connection, POLLOUT, 0};
    while (poll(&p, 1, port->patience_ms) < 0 && errno == EINTR) {
    }
    return p.revents;
}

bool rig_port_write(rig_port *port, const uint8_t *byte, size_t n) {
    size_t room = sizeof port->held - port->n_held, kept = n < room ? n : room;
    memcpy(port->held + port->n_held, byte, kept);
    port->n_held += kept;
    while (port->n_held > 0) {
        short now = port->connection < 0 ? POLLHUP : wait_for_room(port);
        ssize_t some = 0;
        if (now & (POLLHUP | POLLERR))
            some = (ssize_t)port->n_held;
        else if (now & POLLOUT)
            some = write(port->connection, port->held, port->n_held);
        port->failed = some < 0 && errno != EAGAIN && errno != EINTR ? errno : port->failed;
        port->patience_ms = some > 0 ? PATIENCE_MS : 0;
        if (some <= 0)
            return false;
        port->n_held -= (size_t)some;
        memmove(port->held, port->held + some, port->n_held);
    }
    return true;
}
