/* port.c: bytes to and from the host's program. */
#define _GNU_SOURCE
#include "port.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <termios.h>
#include <unistd.h>

enum { PATIENCE_MS = 10000 };

/* A PTY stays when its reader goes; into a file nobody sends. */
typedef enum port_kind { PORT_SOCKET, PORT_PTY, PORT_FILE } port_kind;

static struct {
    port_kind kind;
    port_files file;
    int patience_ms; /* how long a full port may hold the firmware up; 0 after it has once been too long */
    uint8_t byte[SERIAL_RECEIVE];
    ring received;
    uint8_t held[SERIAL_BURST]; /* taken from the ring, not yet written */
    size_t n_held;
} port;

static void start(port_kind kind, port_files files) {
    port.kind = kind;
    port.file = files;
    port.patience_ms = PATIENCE_MS;
    ring_init(&port.received, port.byte, SERIAL_RECEIVE);
    if (files.connection >= 0)
        fcntl(files.connection, F_SETFL, O_NONBLOCK);
    if (files.listener >= 0)
        fcntl(files.listener, F_SETFL, O_NONBLOCK);
}

static const char *open_unix(const char *path) {
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    const int fd = socket(AF_UNIX, SOCK_STREAM, 0);
    if (strlen(path) >= sizeof address.sun_path)
        return "the path is too long for a socket";
    strcpy(address.sun_path, path);
    if (fd < 0 || connect(fd, (const struct sockaddr *)&address, sizeof address) != 0)
        return strerror(errno);
    start(PORT_SOCKET, (port_files){-1, fd});
    return NULL;
}

static const char *open_file(const char *path) {
    const int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (fd < 0)
        return strerror(errno);
    start(PORT_FILE, (port_files){-1, fd});
    return NULL;
}

/* Opened and closed once, its other end reads as hung up until somebody opens it. */
static const char *open_pty(void) {
    struct termios raw;
    const int fd = posix_openpt(O_RDWR | O_NOCTTY);
    if (fd < 0 || grantpt(fd) != 0 || unlockpt(fd) != 0 || tcgetattr(fd, &raw) != 0)
        return strerror(errno);
    cfmakeraw(&raw);
    tcsetattr(fd, TCSANOW, &raw);
    const int other = open(ptsname(fd), O_RDWR | O_NOCTTY);
    if (other >= 0)
        close(other);
    printf("port %s\n", ptsname(fd));
    fflush(stdout);
    start(PORT_PTY, (port_files){-1, fd});
    return NULL;
}

static const char *open_tcp(const char *number) {
    struct sockaddr_in address = {.sin_family = AF_INET};
    socklen_t size = sizeof address;
    char *end;
    const long wanted = strtol(number, &end, 10);
    const int fd = socket(AF_INET, SOCK_STREAM, 0), yes = 1;
    if (*number == '\0' || *end != '\0' || wanted < 0 || wanted > 65535)
        return "tcp: takes a port number";
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons((uint16_t)wanted);
    if (fd < 0 || setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) != 0 ||
        bind(fd, (const struct sockaddr *)&address, sizeof address) != 0 || listen(fd, 1) != 0 ||
        getsockname(fd, (struct sockaddr *)&address, &size) != 0)
        return strerror(errno);
    printf("port tcp:127.0.0.1:%d\n", ntohs(address.sin_port));
    fflush(stdout);
    start(PORT_SOCKET, (port_files){fd, -1});
    return NULL;
}

const char *port_open(const char *name) {
    if (strncmp(name, "unix:", 5) == 0)
        return open_unix(name + 5);
    if (strncmp(name, "tcp:", 4) == 0)
        return open_tcp(name + 4);
    if (strncmp(name, "file:", 5) == 0)
        return open_file(name + 5);
    if (strcmp(name, "pty") == 0)
        return open_pty();
    return "unix:PATH, file:PATH, pty or tcp:PORT is wanted";
}

void port_resume(const char *name, port_files files) {
    start(strcmp(name, "pty") == 0            ? PORT_PTY
          : strncmp(name, "file:", 5) == 0 ? PORT_FILE
                                           : PORT_SOCKET,
          files);
}

port_files port_kept(void) {
    return port.file;
}

static void hang_up(void) {
    if (port.kind == PORT_PTY) /* stays open for the next one */
        return;
    close(port.file.connection);
    port.file.connection = -1;
}

static short look(short events, int timeout_ms) {
    struct pollfd p = {port.file.connection, events, 0};
    while (poll(&p, 1, timeout_ms) < 0 && errno == EINTR)
        ;
    return p.revents;
}

void port_poll(void) {
    uint8_t byte[SERIAL_RECEIVE];
    if (port.file.connection < 0 && port.file.listener >= 0)
        port.file.connection = accept4(port.file.listener, NULL, NULL, SOCK_NONBLOCK);
    const uint32_t room = ring_free(&port.received);
    if (port.kind == PORT_FILE || port.file.connection < 0 || room == 0 || (look(POLLIN, 0) & POLLIN) == 0)
        return;
    const ssize_t n = read(port.file.connection, byte, room);
    if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR))
        hang_up();
    for (ssize_t i = 0; i < n; i++)
        ring_put(&port.received, byte[i]);
}

bool serial_receive(uint8_t *byte) {
    return ring_get(&port.received, byte);
}

void serial_take(uint8_t byte) {
    (void)ring_put(&port.received, byte);
}

/* Writes what is held, or drops it where nobody listens, as a line does; false if some is still held. */
static bool send_held(void) {
    while (port.n_held > 0) {
        const short now = port.file.connection < 0 ? POLLHUP : look(POLLOUT, port.patience_ms);
        ssize_t n = 0;
        if ((now & (POLLHUP | POLLERR)) != 0)
            n = (ssize_t)port.n_held;
        else if ((now & POLLOUT) != 0)
            n = write(port.file.connection, port.held, port.n_held);
        port.patience_ms = n > 0 ? PATIENCE_MS : 0;
        if (n <= 0)
            return false;
        port.n_held -= (size_t)n;
        memmove(port.held, port.held + n, port.n_held);
    }
    return true;
}

void serial_send(ring *transmit) {
    if (!send_held())
        return;
    while (port.n_held < SERIAL_BURST && ring_get(transmit, &port.held[port.n_held]))
        port.n_held++;
    (void)send_held();
}
