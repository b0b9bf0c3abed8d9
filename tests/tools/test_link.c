/* test_link.c: links over sockets and terminals, and what goes wrong, with libserialport and the system's
 * calls faked. */
/* link: -Wl,--wrap=sp_get_port_by_name,--wrap=sp_free_port,--wrap=sp_open,--wrap=sp_close */
/* link: -Wl,--wrap=sp_get_port_handle,--wrap=sp_set_baudrate,--wrap=sp_set_bits,--wrap=sp_set_parity */
/* link: -Wl,--wrap=sp_set_stopbits,--wrap=sp_set_flowcontrol,--wrap=sp_nonblocking_read */
/* link: -Wl,--wrap=sp_nonblocking_write,--wrap=sp_last_error_code,--wrap=sp_list_ports */
/* link: -Wl,--wrap=sp_free_port_list,--wrap=sp_get_port_name,--wrap=sp_get_port_description */
/* link: -Wl,--wrap=read,--wrap=write,--wrap=send,--wrap=poll */
#define _XOPEN_SOURCE 700
#include "indenter/link.h"
#include "link_fake.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cmocka.h>

enum { SOON_MS = 20, LONG_MS = 10000 };

/* ---- helpers ---- */

static void fails(const char *where, int baud, const char *says) {
    char why[LINK_TEXT] = "";
    link_t *l = (link_t *)&fake;
    assert_int_equal(link_open(where, baud, &l, why), LINK_ERROR);
    assert_null(l);
    if (!strstr(why, says) || strchr(why, '\n'))
        fail_msg("\"%s\" does not say \"%s\"", why, says);
}

static link_t *opens(const char *where) {
    char why[LINK_TEXT] = "";
    link_t *l;
    if (link_open(where, LINK_BAUD, &l, why) != LINK_OK)
        fail_msg("%s: %s", where, why);
    return l;
}

/* A serial port, or a plain descriptor, at one end of a socket; *other is the other. */
static link_t *open_end(bool serial, int *other) {
    int end[2];
    char where[20];
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM, 0, end), 0);
    fcntl(end[0], F_SETFL, O_NONBLOCK);
    *other = end[1];
    fake.fd = end[0];
    snprintf(where, sizeof where, "fd:%d", end[0]);
    return opens(serial ? "/dev/ttyACM7" : where);
}

static void close_end(bool serial, link_t *l, int other) {
    link_close(l);
    if (serial)
        close(fake.fd);
    if (other >= 0)
        close(other);
}

/* A pseudo-terminal: its master, and its slave's name behind "pty:". */
static int make_pty(char where[64]) {
    int master = posix_openpt(O_RDWR | O_NOCTTY);
    assert_true(master >= 0 && grantpt(master) == 0 && unlockpt(master) == 0);
    snprintf(where, 64, "pty:%s", ptsname(master));
    return master;
}

static void read_all(int fd, void *to, size_t size) {
    for (size_t done = 0; done < size;) {
        ssize_t n = __real_read(fd, (char *)to + done, size - done);
        assert_true(n > 0);
        done += (size_t)n;
    }
}

/* Every byte value goes through both ways as it is. */
static void exchange(link_t *l, int other) {
    uint8_t sent[256], got[256];
    size_t n;
    for (size_t i = 0; i < sizeof sent; i++)
        sent[i] = (uint8_t)i;
    assert_int_equal(link_write(l, sent, sizeof sent, LONG_MS), LINK_OK);
    read_all(other, got, sizeof got);
    assert_memory_equal(got, sent, sizeof sent);
    assert_int_equal(__real_write(other, sent, sizeof sent), sizeof sent);
    for (size_t done = 0; done < sizeof got; done += n)
        assert_int_equal(link_read(l, got + done, sizeof got - done, &n, LONG_MS), LINK_OK);
    assert_memory_equal(got, sent, sizeof sent);
    assert_int_equal(link_read(l, got, sizeof got, &n, SOON_MS), LINK_TIMEOUT);
    assert_int_equal(n, 0);
}

/* ---- opening a serial port ---- */

static void test_serial_missing(void **state) {
    (void)state;
    fake.found = SP_ERR_ARG;
    fails("/dev/ttyACM7", LINK_BAUD,
          "no such serial port: /dev/ttyACM7; is it plugged in? palpate acquire --list");
    fails("COM3", LINK_BAUD, "no such serial port: COM3");
    fails("/dev/pts/5", LINK_BAUD, "named pty:/dev/pts/5");
}

static void test_serial_refused(void **state) {
    static const struct {
        int error;
        const char *says;
    } cases[] = {{EACCES, "no permission to open /dev/ttyACM7; join its group (sudo usermod -aG dialout"},
                 {EPERM, "no permission"},
                 {EBUSY, "/dev/ttyACM7 is in use by another program; close it (fuser -v /dev/ttyACM7"},
                 {ENOENT, "is it plugged in?"},
                 {ENXIO, "is it plugged in?"},
                 {ENOTTY, "cannot be used as a serial port"}};
    (void)state;
    fake.opened = SP_ERR_FAIL;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        fake.error = cases[i].error;
        fails("/dev/ttyACM7", LINK_BAUD, cases[i].says);
        assert_int_equal(fake.ports, 0);
    }
}

static void test_serial_locked(void **state) {
    char path[] = "/tmp/palpate_link_XXXXXX";
    int theirs = mkstemp(path);
    (void)state;
    fake.fd = open(path, O_RDWR);
    assert_true(theirs >= 0 && fake.fd >= 0 && flock(theirs, LOCK_EX) == 0);
    fails("/dev/ttyACM7", LINK_BAUD, "in use by another program");
    close(theirs);
    link_close(opens("/dev/ttyACM7"));
    close(fake.fd);
    unlink(path);
}

static void test_serial_settings(void **state) {
    int other;
    (void)state;
    link_t *l = open_end(true, &other);
    assert_int_equal(fake.baud, 921600);
    close_end(true, l, other);
    fake.fd = open("/dev/null", O_RDWR);
    fake.baud_set = SP_ERR_SUPP;
    fails("/dev/ttyACM7", 123457, "does not do 123457 baud");
    fake.baud_set = SP_OK;
    fake.bits_set = SP_ERR_FAIL;
    fails("/dev/ttyACM7", LINK_BAUD, "cannot be set to 8N1");
    close(fake.fd);
}

static void test_list(void **state) {
    char text[200] = "";
    int kept = dup(STDOUT_FILENO);
    FILE *to = tmpfile();
    (void)state;
    assert_non_null(to);
    fflush(stdout);
    dup2(fileno(to), STDOUT_FILENO);
    int n = link_list();
    fflush(stdout);
    dup2(kept, STDOUT_FILENO);
    close(kept);
    rewind(to);
    assert_true(fread(text, 1, sizeof text - 1, to) > 0);
    fclose(to);
    assert_int_equal(n, 2);
    assert_string_equal(text, "/dev/ttyACM7     palpate indenter\n/dev/ttyACM7     \n");
    fake.found = SP_ERR_FAIL;
    assert_int_equal(link_list(), -1);
}

/* ---- reading and writing, by libserialport and by descriptor ---- */

static void read_some(bool serial) {
    static const step interrupted[] = {{-1, EINTR}, {3, 0}, {-1, EINTR}, {2, 0}};
    char got[8];
    size_t n;
    int other;
    link_t *l = open_end(serial, &other);
    exchange(l, other);
    assert_int_equal(__real_write(other, "abcde", 5), 5);
    will_do(4, interrupted);
    fake.poll_interruptions = 2;
    assert_int_equal(link_read(l, got, sizeof got, &n, LONG_MS), LINK_OK);
    assert_int_equal(n, 3);
    assert_int_equal(link_read(l, got + 3, sizeof got - 3, &n, LONG_MS), LINK_OK);
    assert_int_equal(n, 2);
    assert_memory_equal(got, "abcde", 5);
    close_end(serial, l, other);
}

static void write_some(bool serial) {
    static const step interrupted[] = {{3, 0}, {-1, EINTR}, {1, 0}, {-1, EAGAIN}};
    char got[8];
    int other;
    link_t *l = open_end(serial, &other);
    will_do(4, interrupted);
    fake.poll_interruptions = 2;
    assert_int_equal(link_write(l, "abcdefgh", 8, LONG_MS), LINK_OK);
    assert_int_equal(fake.next_step, 4);
    read_all(other, got, 8);
    assert_memory_equal(got, "abcdefgh", 8);
    close_end(serial, l, other);
}

/* Always ready, never a byte: the time still ends. */
static void never_done(bool serial) {
    static const step no[] = {{-1, EINTR}, {-1, EINTR}, {-1, EINTR}};
    char got[8];
    size_t n;
    int other;
    link_t *l = open_end(serial, &other);
    assert_int_equal(__real_write(other, "a", 1), 1);
    will_do(1, no);
    assert_int_equal(link_read(l, got, sizeof got, &n, 0), LINK_TIMEOUT);
    will_do(1, no);
    assert_int_equal(link_write(l, "abc", 3, 0), LINK_TIMEOUT);
    close_end(serial, l, other);
}

/* A reader that takes nothing. */
static void full(bool serial) {
    static char much[1 << 20];
    int other;
    link_t *l = open_end(serial, &other);
    assert_int_equal(link_write(l, much, sizeof much, SOON_MS), LINK_TIMEOUT);
    assert_non_null(strstr(link_error(l), "does not take"));
    close_end(serial, l, other);
}

static void gone(bool serial) {
    static const step eof[] = {{0, 0}}, unplugged[] = {{-1, EIO}}, strange[] = {{-1, EINVAL}};
    const char *says = serial ? "unplugged" : "the other end has closed";
    char got[8];
    size_t n;
    int other;
    link_t *l = open_end(serial, &other);
    assert_int_equal(__real_write(other, "ab", 2), 2);
    will_do(1, eof);
    assert_int_equal(link_read(l, got, sizeof got, &n, LONG_MS), LINK_CLOSED);
    assert_non_null(strstr(link_error(l), says));
    will_do(1, unplugged);
    assert_int_equal(link_read(l, got, sizeof got, &n, LONG_MS), LINK_CLOSED);
    will_do(1, unplugged);
    assert_int_equal(link_write(l, "a", 1, LONG_MS), LINK_CLOSED);
    assert_non_null(strstr(link_error(l), says));
    will_do(1, strange);
    assert_int_equal(link_read(l, got, sizeof got, &n, LONG_MS), LINK_ERROR);
    will_do(1, strange);
    assert_int_equal(link_write(l, "a", 1, LONG_MS), LINK_ERROR);
    close(other); /* now for real: what had come is still there, then the end; writing raises no signal */
    assert_int_equal(link_read(l, got, sizeof got, &n, LONG_MS), LINK_OK);
    assert_int_equal(n, 2);
    assert_int_equal(link_read(l, got, sizeof got, &n, LONG_MS), LINK_CLOSED);
    assert_int_equal(link_write(l, "a", 1, LONG_MS), LINK_CLOSED);
    close_end(serial, l, -1);
}

static void test_serial_reads(void **state) {
    (void)state;
    read_some(true);
    write_some(true);
    never_done(true);
    full(true);
    gone(true);
}

static void test_descriptor_reads(void **state) {
    (void)state;
    read_some(false);
    write_some(false);
    never_done(false);
    full(false);
    gone(false);
}

/* ---- the other kinds ---- */

static void test_descriptor_wrong(void **state) {
    static const char *const wrong[] = {"fd:", "fd:-1", "fd:999", "fd:1x", "fd:99999999999999999999"};
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        fails(wrong[i], 0, "is not an open descriptor");
}

static void test_pty(void **state) {
    static char much[1 << 16];
    char where[64], byte;
    size_t n;
    int master = make_pty(where);
    link_t *l = opens(where);
    (void)state;
    exchange(l, master);
    fails(where, 0, "in use by another palpate");
    assert_int_equal(link_write(l, much, sizeof much, SOON_MS), LINK_TIMEOUT);
    close(master);
    assert_int_equal(link_read(l, &byte, 1, &n, LONG_MS), LINK_CLOSED);
    assert_int_equal(link_write(l, "a", 1, LONG_MS), LINK_CLOSED);
    link_close(l);
    fails(where, 0, "is palpate rig running");
    fails("pty:/dev/null", 0, "is not a terminal");
}

static void test_tcp(void **state) {
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t size = sizeof address;
    int listener = socket(AF_INET, SOCK_STREAM, 0);
    char where[40];
    (void)state;
    assert_int_equal(bind(listener, (struct sockaddr *)&address, size), 0);
    assert_int_equal(listen(listener, 1), 0);
    assert_int_equal(getsockname(listener, (struct sockaddr *)&address, &size), 0);
    snprintf(where, sizeof where, "tcp:127.0.0.1:%d", ntohs(address.sin_port));
    link_t *l = opens(where);
    int other = accept(listener, NULL, NULL);
    exchange(l, other);
    link_close(l);
    close(other);
    snprintf(where, sizeof where, "tcp:[127.0.0.1]:%d", ntohs(address.sin_port));
    link_close(opens(where));
    close(listener);
    fails(where, 0, "; is the rig or the device's server running there?");
    fails("tcp:localhost", 0, "write tcp:HOST:PORT");
    fails("tcp:localhost:", 0, "write tcp:HOST:PORT");
    fails("tcp:localhost:no-such-service", 0, "check host and port");
}

static void test_unix(void **state) {
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    char folder[] = "/tmp/palpate_link_XXXXXX", where[120], longer[200] = "unix:/";
    int listener = socket(AF_UNIX, SOCK_STREAM, 0);
    (void)state;
    assert_non_null(mkdtemp(folder));
    snprintf(address.sun_path, sizeof address.sun_path, "%s/socket", folder);
    snprintf(where, sizeof where, "unix:%s", address.sun_path);
    fails(where, 0, "is palpate rig running there?");
    assert_int_equal(bind(listener, (struct sockaddr *)&address, sizeof address), 0);
    assert_int_equal(listen(listener, 1), 0);
    link_t *l = opens(where);
    int other = accept(listener, NULL, NULL);
    exchange(l, other);
    link_close(l);
    close(other);
    close(listener);
    unlink(address.sun_path);
    rmdir(folder);
    memset(longer + 6, 'x', 150);
    fails(longer, 0, "too long");
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup_teardown(test_serial_missing, reset, no_port_is_left),
    cmocka_unit_test_setup_teardown(test_serial_refused, reset, no_port_is_left),
    cmocka_unit_test_setup_teardown(test_serial_locked, reset, no_port_is_left),
    cmocka_unit_test_setup_teardown(test_serial_settings, reset, no_port_is_left),
    cmocka_unit_test_setup_teardown(test_list, reset, no_port_is_left),
    cmocka_unit_test_setup_teardown(test_serial_reads, reset, no_port_is_left),
    cmocka_unit_test_setup_teardown(test_descriptor_reads, reset, no_port_is_left),
    cmocka_unit_test_setup_teardown(test_descriptor_wrong, reset, no_port_is_left),
    cmocka_unit_test_setup_teardown(test_pty, reset, no_port_is_left),
    cmocka_unit_test_setup_teardown(test_tcp, reset, no_port_is_left),
    cmocka_unit_test_setup_teardown(test_unix, reset, no_port_is_left),
    {0},
};
