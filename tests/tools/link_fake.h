/* link_fake.h: a serial port that is a socket, and reads and writes that are short or fail, by --wrap. For
 * test_link.c alone. */
#ifndef LINK_FAKE_H
#define LINK_FAKE_H

#include <errno.h>
#include <libserialport.h>
#include <poll.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmocka.h>

/* What the next reads or writes do: at most n bytes; 0; or fail. When they are used up, the real thing. */
typedef struct step {
    ssize_t n;
    int error;
} step;

static struct {
    int fd, baud;    /* of the fake serial port; the rate it was set to */
    int ports, open; /* how many are made and open */
    enum sp_return found, opened, baud_set, bits_set;
    int error;
    const step *steps;
    size_t n_steps, next_step;
    int poll_interruptions;
} fake;

static struct sp_port *const PORT = (struct sp_port *)&fake;

static int reset(void **state) {
    (void)state;
    memset(&fake, 0, sizeof fake);
    fake.fd = -1;
    return 0;
}

static int no_port_is_left(void **state) {
    (void)state;
    return fake.ports || fake.open;
}

static void will_do(size_t n, const step *steps) {
    fake.steps = steps;
    fake.n_steps = n;
    fake.next_step = 0;
}

/* The next step, if there is one: true if the call is over with *result. */
static bool stepped(size_t *size, ssize_t *result) {
    if (fake.next_step == fake.n_steps)
        return false;
    step s = fake.steps[fake.next_step++];
    if (s.n > 0) {
        *size = *size < (size_t)s.n ? *size : (size_t)s.n;
        return false;
    }
    errno = s.error;
    *result = s.n;
    return true;
}

ssize_t __real_read(int fd, void *to, size_t size);
ssize_t __wrap_read(int fd, void *to, size_t size);
ssize_t __wrap_read(int fd, void *to, size_t size) {
    ssize_t result;
    return stepped(&size, &result) ? result : __real_read(fd, to, size);
}

ssize_t __real_write(int fd, const void *from, size_t size);
ssize_t __wrap_write(int fd, const void *from, size_t size);
ssize_t __wrap_write(int fd, const void *from, size_t size) {
    ssize_t result;
    return stepped(&size, &result) ? result : __real_write(fd, from, size);
}

ssize_t __real_send(int fd, const void *from, size_t size, int flags);
ssize_t __wrap_send(int fd, const void *from, size_t size, int flags);
ssize_t __wrap_send(int fd, const void *from, size_t size, int flags) {
    ssize_t result;
    return stepped(&size, &result) ? result : __real_send(fd, from, size, flags);
}

int __real_poll(struct pollfd *fds, nfds_t n, int timeout_ms);
int __wrap_poll(struct pollfd *fds, nfds_t n, int timeout_ms);
int __wrap_poll(struct pollfd *fds, nfds_t n, int timeout_ms) {
    if (fake.poll_interruptions > 0) {
        fake.poll_interruptions--;
        errno = EINTR;
        return -1;
    }
    return __real_poll(fds, n, timeout_ms);
}

enum sp_return __wrap_sp_get_port_by_name(const char *name, struct sp_port **port);
enum sp_return __wrap_sp_get_port_by_name(const char *name, struct sp_port **port) {
    assert_non_null(name);
    fake.ports += fake.found == SP_OK;
    *port = fake.found == SP_OK ? PORT : NULL;
    return fake.found;
}

void __wrap_sp_free_port(struct sp_port *port);
void __wrap_sp_free_port(struct sp_port *port) {
    assert_ptr_equal(port, PORT);
    fake.ports--;
}

enum sp_return __wrap_sp_open(struct sp_port *port, enum sp_mode mode);
enum sp_return __wrap_sp_open(struct sp_port *port, enum sp_mode mode) {
    assert_ptr_equal(port, PORT);
    assert_int_equal(mode, SP_MODE_READ_WRITE);
    fake.open += fake.opened == SP_OK;
    return fake.opened;
}

enum sp_return __wrap_sp_close(struct sp_port *port);
enum sp_return __wrap_sp_close(struct sp_port *port) {
    assert_ptr_equal(port, PORT);
    fake.open--;
    return SP_OK;
}

enum sp_return __wrap_sp_get_port_handle(const struct sp_port *port, void *handle);
enum sp_return __wrap_sp_get_port_handle(const struct sp_port *port, void *handle) {
    assert_ptr_equal(port, PORT);
    *(int *)handle = fake.fd;
    return SP_OK;
}

enum sp_return __wrap_sp_set_baudrate(struct sp_port *port, int baud);
enum sp_return __wrap_sp_set_baudrate(struct sp_port *port, int baud) {
    assert_ptr_equal(port, PORT);
    fake.baud = baud;
    return fake.baud_set;
}

enum sp_return __wrap_sp_set_bits(struct sp_port *port, int bits);
enum sp_return __wrap_sp_set_bits(struct sp_port *port, int bits) {
    assert_ptr_equal(port, PORT);
    assert_int_equal(bits, 8);
    return fake.bits_set;
}

enum sp_return __wrap_sp_set_parity(struct sp_port *port, enum sp_parity parity);
enum sp_return __wrap_sp_set_parity(struct sp_port *port, enum sp_parity parity) {
    (void)port;
    return parity == SP_PARITY_NONE ? SP_OK : SP_ERR_ARG;
}

enum sp_return __wrap_sp_set_stopbits(struct sp_port *port, int bits);
enum sp_return __wrap_sp_set_stopbits(struct sp_port *port, int bits) {
    (void)port;
    return bits == 1 ? SP_OK : SP_ERR_ARG;
}

enum sp_return __wrap_sp_set_flowcontrol(struct sp_port *port, enum sp_flowcontrol control);
enum sp_return __wrap_sp_set_flowcontrol(struct sp_port *port, enum sp_flowcontrol control) {
    (void)port;
    return control == SP_FLOWCONTROL_NONE ? SP_OK : SP_ERR_ARG;
}

/* libserialport says 0 where read() says EAGAIN. */
enum sp_return __wrap_sp_nonblocking_read(struct sp_port *port, void *to, size_t size);
enum sp_return __wrap_sp_nonblocking_read(struct sp_port *port, void *to, size_t size) {
    ssize_t n;
    assert_ptr_equal(port, PORT);
    if (!stepped(&size, &n))
        n = __real_read(fake.fd, to, size);
    fake.error = n < 0 ? errno : 0;
    return n < 0 && errno == EAGAIN ? 0 : n < 0 ? SP_ERR_FAIL : (enum sp_return)n;
}

enum sp_return __wrap_sp_nonblocking_write(struct sp_port *port, const void *from, size_t size);
enum sp_return __wrap_sp_nonblocking_write(struct sp_port *port, const void *from, size_t size) {
    ssize_t n;
    assert_ptr_equal(port, PORT);
    if (!stepped(&size, &n))
        n = __real_send(fake.fd, from, size, MSG_NOSIGNAL);
    fake.error = n < 0 ? errno : 0;
    return n < 0 && errno == EAGAIN ? 0 : n < 0 ? SP_ERR_FAIL : (enum sp_return)n;
}

int __wrap_sp_last_error_code(void);
int __wrap_sp_last_error_code(void) {
    return fake.error;
}

enum sp_return __wrap_sp_list_ports(struct sp_port ***list);
enum sp_return __wrap_sp_list_ports(struct sp_port ***list) {
    static struct sp_port *two[] = {(struct sp_port *)&fake, (struct sp_port *)&fake.baud, NULL};
    *list = two;
    return fake.found;
}

void __wrap_sp_free_port_list(struct sp_port **list);
void __wrap_sp_free_port_list(struct sp_port **list) {
    assert_null(list[2]);
}

char *__wrap_sp_get_port_name(const struct sp_port *port);
char *__wrap_sp_get_port_name(const struct sp_port *port) {
    static char name[] = "/dev/ttyACM7";
    assert_non_null(port);
    return name;
}

char *__wrap_sp_get_port_description(const struct sp_port *port);
char *__wrap_sp_get_port_description(const struct sp_port *port) {
    static char about[] = "palpate indenter";
    return port == PORT ? about : NULL;
}

#endif
