/* link_serial.c: serial ports, by libserialport. */
#define _POSIX_C_SOURCE 200809L
#include "link_serial.h"

#include <errno.h>
#include <grp.h>
#include <libserialport.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>

/* The group that may use the port: dialout on Debian, uucp elsewhere. */
static const char *group_of(const char *name) {
    struct stat file;
    struct group *group = stat(name, &file) == 0 ? getgrgid(file.st_gid) : NULL;
    return group && file.st_gid != 0 ? group->gr_name : "dialout";
}

static void say_busy(const char *name, char why[LINK_TEXT]) {
    snprintf(why, LINK_TEXT,
             "%s is in use by another program; close it (fuser -v %s names it; ModemManager holds a new port "
             "for some seconds)",
             name, name);
}

static void say_missing(const char *name, char why[LINK_TEXT]) {
    bool pseudo = strncmp(name, "/dev/pts/", 9) == 0;
    snprintf(why, LINK_TEXT, "no such serial port: %s; %s%s", name,
             pseudo ? "a pseudo-terminal is named pty:"
                    : "is it plugged in? palpate acquire --list shows the ports",
             pseudo ? name : "");
}

static void say_why(const char *name, int error, char why[LINK_TEXT]) {
    if (error == EBUSY || error == EWOULDBLOCK)
        say_busy(name, why);
    else if (error == ENOENT || error == ENODEV || error == ENXIO)
        say_missing(name, why);
    else if (error == EACCES || error == EPERM)
        snprintf(why, LINK_TEXT,
                 "no permission to open %s; join its group (sudo usermod -aG %s \"$USER\") and log in again",
                 name, group_of(name));
    else
        snprintf(why, LINK_TEXT, "%s cannot be used as a serial port: %s", name, strerror(error));
}

static bool configure(struct sp_port *port, const char *name, int baud, char why[LINK_TEXT]) {
    if (sp_set_baudrate(port, baud) != SP_OK) {
        snprintf(why, LINK_TEXT, "%s does not do %d baud; give the rate of the firmware with --baud", name,
                 baud);
        return false;
    }
    if (sp_set_bits(port, 8) != SP_OK || sp_set_parity(port, SP_PARITY_NONE) != SP_OK ||
        sp_set_stopbits(port, 1) != SP_OK || sp_set_flowcontrol(port, SP_FLOWCONTROL_NONE) != SP_OK) {
        snprintf(why, LINK_TEXT, "%s cannot be set to 8N1 without flow control: %s", name,
                 strerror(sp_last_error_code()));
        return false;
    }
    return true;
}

struct sp_port *link_serial_open(const char *name, int baud, int *fd, char why[LINK_TEXT]) {
    struct sp_port *port = NULL;
    if (sp_get_port_by_name(name, &port) != SP_OK) {
        say_missing(name, why);
        return NULL;
    }
    if (sp_open(port, SP_MODE_READ_WRITE) != SP_OK) {
        say_why(name, sp_last_error_code(), why);
        sp_free_port(port);
        return NULL;
    }
    bool mine = sp_get_port_handle(port, fd) == SP_OK && flock(*fd, LOCK_EX | LOCK_NB) == 0;
    if (!mine)
        say_why(name, errno, why);
    else
        (void)ioctl(
            *fd,
            TIOCEXCL); /* flock keeps other palpates out, even root's; this keeps out all other programs */
    if (!mine || !configure(port, name, baud, why)) {
        link_serial_close(port);
        return NULL;
    }
    return port;
}

void link_serial_close(struct sp_port *port) {
    sp_close(port);
    sp_free_port(port);
}

static ssize_t with_errno(enum sp_return n) {
    if (n < 0) {
        errno = n == SP_ERR_FAIL ? sp_last_error_code() : EINVAL;
        return -1;
    }
    return (ssize_t)n;
}

ssize_t link_serial_read(struct sp_port *port, void *buffer, size_t size) {
    return with_errno(sp_nonblocking_read(port, buffer, size));
}

ssize_t link_serial_write(struct sp_port *port, const void *buffer, size_t size) {
    return with_errno(sp_nonblocking_write(port, buffer, size));
}

int link_list(void) {
    struct sp_port **ports = NULL;
    int n = 0;
    if (sp_list_ports(&ports) != SP_OK)
        return -1;
    for (; ports[n]; n++) {
        const char *about = sp_get_port_description(ports[n]);
        printf("%-16s %s\n", sp_get_port_name(ports[n]), about ? about : "");
    }
    sp_free_port_list(ports);
    return n;
}
