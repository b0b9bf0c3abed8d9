/* link.c: links by a descriptor (PTY, TCP, unix socket), and what all links share. */
#define _POSIX_C_SOURCE 200809L
#include "link.h"
#include "link_serial.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

enum { CONNECT_MS = 5000 };

struct link {
    int fd;
    struct sp_port *port; /* NULL: plain descriptor */
    bool socket;
    char name[LINK_TEXT / 2];
    char error[LINK_TEXT];
};

double link_now_s(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Waits until fd is ready for events or has failed; the next read or write says which. Returns 1, or 0 if
 * neither happened by until_s. */
static int wait_for(int fd, short events, double until_s) {
    for (;;) {
        struct pollfd one = {.fd = fd, .events = events};
        double left_ms = 1e3 * (until_s - link_now_s());
        int n = poll(&one, 1, left_ms > 0 ? (int)fmin(ceil(left_ms), INT_MAX) : 0);
        if (n >= 0 || errno != EINTR)
            return n;
    }
}

/* ---- opening; each returns a descriptor, or -1 and why ---- */

static void set_raw(struct termios *t) {
    t->c_iflag = 0;
    t->c_oflag = 0;
    t->c_lflag = 0;
    t->c_cflag = (t->c_cflag & ~(tcflag_t)(CSIZE | PARENB)) | CS8 | CREAD | CLOCAL;
    t->c_cc[VMIN] = 1;
    t->c_cc[VTIME] = 0;
}

static int open_pty(const char *path, char why[LINK_TEXT]) {
    struct termios t;
    int fd = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) {
        snprintf(why, LINK_TEXT, "%s: %s; is palpate rig running, and is this the port that it named?", path,
                 strerror(errno));
        return -1;
    }
    if (flock(fd, LOCK_EX | LOCK_NB) != 0) {
        snprintf(why, LINK_TEXT, "%s is in use by another palpate; close it", path);
    } else if (tcgetattr(fd, &t) != 0) {
        snprintf(why, LINK_TEXT, "%s is not a terminal", path);
    } else {
        set_raw(&t);
        if (tcsetattr(fd, TCSANOW, &t) == 0)
            return fd;
        snprintf(why, LINK_TEXT, "%s cannot be set raw: %s", path, strerror(errno));
    }
    close(fd);
    return -1;
}

/* Connects within CONNECT_MS; -1 and errno. */
static int connect_to(int family, const struct sockaddr *address, socklen_t length) {
    int failed = 0, on = 1;
    socklen_t size = sizeof failed;
    int fd = socket(family, SOCK_STREAM, 0);
    if (fd < 0)
        return -1;
    fcntl(fd, F_SETFD, FD_CLOEXEC);
    fcntl(fd, F_SETFL, O_NONBLOCK);
    if (connect(fd, address, length) != 0) {
        failed = errno;
        if (failed == EINPROGRESS || failed == EINTR) {
            bool ready = wait_for(fd, POLLOUT, link_now_s() + 1e-3 * CONNECT_MS) > 0;
            failed = ETIMEDOUT;
            if (ready && getsockopt(fd, SOL_SOCKET, SO_ERROR, &failed, &size) != 0)
                failed = errno;
        }
    }
    if (failed) {
        close(fd);
        errno = failed;
        return -1;
    }
    if (family != AF_UNIX) { /* commands are small and must not wait for more bytes */
        setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    }
    return fd;
}

/* HOST:PORT, [HOST]:PORT for an address with colons. */
static bool split_host(const char *text, char host[LINK_TEXT], const char **port) {
    const char *colon = strrchr(text, ':');
    size_t n = colon ? (size_t)(colon - text) : 0;
    if (n > 2 && text[0] == '[' && text[n - 1] == ']') {
        text++;
        n -= 2;
    }
    if (n == 0 || n >= LINK_TEXT || colon[1] == '\0')
        return false;
    memcpy(host, text, n);
    host[n] = '\0';
    *port = colon + 1;
    return true;
}

static int open_tcp(const char *text, char why[LINK_TEXT]) {
    char host[LINK_TEXT];
    const char *port;
    struct addrinfo want = {.ai_socktype = SOCK_STREAM}, *found = NULL;
    int fd = -1;
    if (!split_host(text, host, &port)) {
        snprintf(why, LINK_TEXT, "tcp:%s: write tcp:HOST:PORT, e.g. tcp:localhost:4000", text);
        return -1;
    }
    int failed = getaddrinfo(host, port, &want, &found);
    if (failed) {
        snprintf(why, LINK_TEXT, "tcp:%s: %s; check host and port", text, gai_strerror(failed));
        return -1;
    }
    for (const struct addrinfo *a = found; a && fd < 0; a = a->ai_next)
        fd = connect_to(a->ai_family, a->ai_addr, a->ai_addrlen);
    if (fd < 0)
        snprintf(why, LINK_TEXT, "tcp:%s: %s; is the rig or the device's server running there?", text,
                 strerror(errno));
    freeaddrinfo(found);
    return fd;
}

static int open_unix(const char *path, char why[LINK_TEXT]) {
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    if (strlen(path) >= sizeof address.sun_path) {
        snprintf(why, LINK_TEXT, "unix:%.80s...: the path is too long for a socket", path);
        return -1;
    }
    strcpy(address.sun_path, path);
    int fd = connect_to(AF_UNIX, (const struct sockaddr *)&address, sizeof address);
    if (fd < 0)
        snprintf(why, LINK_TEXT, "unix:%s: %s; is palpate rig running there?", path, strerror(errno));
    return fd;
}

static int open_fd(const char *number, char why[LINK_TEXT]) {
    char *end;
    long fd = strtol(number, &end, 10);
    int flags = *number && !*end && fd >= 0 && fd <= INT_MAX ? fcntl((int)fd, F_GETFL) : -1;
    if (flags < 0 || fcntl((int)fd, F_SETFL, flags | O_NONBLOCK) < 0) {
        snprintf(why, LINK_TEXT, "fd:%s is not an open descriptor", number);
        return -1;
    }
    return (int)fd;
}

static int open_descriptor(const char *where, bool *known, char why[LINK_TEXT]) {
    static const struct {
        const char *prefix;
        int (*open)(const char *rest, char why[LINK_TEXT]);
    } kinds[] = {{"pty:", open_pty}, {"tcp:", open_tcp}, {"unix:", open_unix}, {"fd:", open_fd}};
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        size_t n = strlen(kinds[i].prefix);
        if (strncmp(where, kinds[i].prefix, n) == 0) {
            *known = true;
            return kinds[i].open(where + n, why);
        }
    }
    *known = false;
    return -1;
}

link_result link_open(const char *where, int baud, link_t **made, char why[LINK_TEXT]) {
    struct stat file;
    bool plain;
    link_t *l = calloc(1, sizeof *l);
    *made = NULL;
    if (!l) {
        snprintf(why, LINK_TEXT, "out of memory");
        return LINK_ERROR;
    }
    snprintf(l->name, sizeof l->name, "%s", where);
    l->fd = open_descriptor(where, &plain, why);
    if (!plain)
        l->port = link_serial_open(where, baud, &l->fd, why);
    if (plain ? l->fd < 0 : !l->port) {
        free(l);
        return LINK_ERROR;
    }
    l->socket = fstat(l->fd, &file) == 0 && S_ISSOCK(file.st_mode);
    *made = l;
    return LINK_OK;
}

void link_close(link_t *l) {
    if (!l)
        return;
    if (l->port)
        link_serial_close(l->port);
    else
        close(l->fd);
    free(l);
}

static ssize_t read_some(link_t *l, void *buffer, size_t size) {
    return l->port ? link_serial_read(l->port, buffer, size) : read(l->fd, buffer, size);
}

static ssize_t write_some(link_t *l, const void *buffer, size_t size) {
    if (l->port)
        return link_serial_write(l->port, buffer, size);
    return l->socket ? send(l->fd, buffer, size, MSG_NOSIGNAL) : write(l->fd, buffer, size);
}

/* The result after a failed read or write; error 0: end of file. */
static link_result went_wrong(link_t *l, int error) {
    static const int gone[] = {0, EIO, ENXIO, ENODEV, EPIPE, ECONNRESET, ENOTCONN, ETIMEDOUT};
    for (size_t i = 0; i < sizeof gone / sizeof gone[0]; i++) {
        if (error == gone[i]) {
            snprintf(l->error, sizeof l->error, "%s: %s%s%s%s", l->name,
                     l->port ? "unplugged" : "the other end has closed", error ? " (" : "",
                     error ? strerror(error) : "", error ? ")" : "");
            return LINK_CLOSED;
        }
    }
    snprintf(l->error, sizeof l->error, "%s: %s", l->name, strerror(error));
    return LINK_ERROR;
}

static bool passing(int error) {
    return error == EINTR || error == EAGAIN || error == EWOULDBLOCK;
}

/* LINK_OK when it is ready; otherwise the result to return. */
static link_result ready(link_t *l, short events, double until_s) {
    int n = wait_for(l->fd, events, until_s);
    if (n == 0) {
        snprintf(l->error, sizeof l->error, "%s: %s", l->name,
                 events == POLLIN ? "nothing came in time" : "it does not take what is sent");
        return LINK_TIMEOUT;
    }
    return n > 0 ? LINK_OK : went_wrong(l, errno);
}

link_result link_read(link_t *l, void *buffer, size_t size, size_t *got, int timeout_ms) {
    double until_s = link_now_s() + 1e-3 * timeout_ms;
    link_result result;
    *got = 0;
    while ((result = ready(l, POLLIN, until_s)) == LINK_OK) {
        ssize_t n = read_some(l, buffer, size);
        if (n > 0) {
            *got = (size_t)n;
            return LINK_OK;
        }
        if (n == 0 || !passing(errno))
            return went_wrong(l, n == 0 ? 0 : errno);
        if (link_now_s() >= until_s)
            return LINK_TIMEOUT;
    }
    return result;
}

link_result link_write(link_t *l, const void *buffer, size_t size, int timeout_ms) {
    double until_s = link_now_s() + 1e-3 * timeout_ms;
    size_t done = 0;
    link_result result = LINK_OK;
    while (done < size && (result = ready(l, POLLOUT, until_s)) == LINK_OK) {
        ssize_t n = write_some(l, (const char *)buffer + done, size - done);
        if (n < 0 && !passing(errno))
            return went_wrong(l, errno);
        if (n <= 0 && link_now_s() >= until_s)
            return LINK_TIMEOUT;
        done += n > 0 ? (size_t)n : 0;
    }
    return result;
}

const char *link_error(const link_t *l) {
    return l->error;
}
