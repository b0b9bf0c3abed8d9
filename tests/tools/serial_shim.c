/* serial_shim.c: to be preloaded, so that libserialport opens a pseudo-terminal: it looks for a port's entry
 * in /sys/class/tty and asks for its modem lines, and a pseudo-terminal has neither. Linux and glibc only. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

static const char ENTRY[] = "/sys/class/tty/pts/";

/* The number of a pseudo-terminal that exists, from its entry's path; else NULL. */
static const char *number_of(const char *path) {
    char device[64];
    if (strncmp(path, ENTRY, sizeof ENTRY - 1) != 0) {
        return NULL;
    }
    const char *number = path + sizeof ENTRY - 1;
    snprintf(device, sizeof device, "/dev/pts/%.32s", number);
    return access(device, F_OK) == 0 ? number : NULL;
}

/* The library's own function behind one of ours; *to is a pointer to it. */
static void find_next(const char *name, void *to) {
    void *found = dlsym(RTLD_NEXT, name);
    memcpy(to, &found, sizeof found);
}

static void fill_link(struct stat *file) {
    memset(file, 0, sizeof *file);
    file->st_mode = S_IFLNK | 0777;
}

int lstat(const char *path, struct stat *file) {
    int (*next)(const char *, struct stat *);
    if (number_of(path)) {
        fill_link(file);
        return 0;
    }
    find_next("lstat", &next);
    return next(path, file);
}

/* What programs built for a glibc before 2.33 call. */
int __lxstat(int version, const char *path, struct stat *file);
int __lxstat(int version, const char *path, struct stat *file) {
    int (*next)(int, const char *, struct stat *);
    if (number_of(path)) {
        fill_link(file);
        return 0;
    }
    find_next("__lxstat", &next);
    return next(version, path, file);
}

ssize_t readlink(const char *path, char *to, size_t size) {
    ssize_t (*next)(const char *, char *, size_t);
    const char *number = number_of(path);
    if (number) {
        int n = snprintf(to, size, "../../devices/shim/tty/pts/%s", number);
        return n < (int)size ? n : (ssize_t)size;
    }
    find_next("readlink", &next);
    return next(path, to, size);
}

int ioctl(int fd, unsigned long request, ...) {
    int (*next)(int, unsigned long, ...);
    va_list list;
    va_start(list, request);
    void *argument = va_arg(list, void *);
    va_end(list);
    find_next("ioctl", &next);
    int result = next(fd, request, argument);
    if (result == 0 || (errno != ENOTTY && errno != EINVAL)) {
        return result;
    }
    switch (request) {
    case TIOCMGET:
        *(int *)argument = TIOCM_DTR | TIOCM_RTS | TIOCM_CTS | TIOCM_DSR | TIOCM_CAR;
        return 0;
    case TIOCMSET:
    case TIOCMBIS:
    case TIOCMBIC:
        return 0;
    default:
        return result;
    }
}
