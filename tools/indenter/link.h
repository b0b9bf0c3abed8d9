/* link.h: bytes to and from an indenter: a serial port by libserialport, a PTY or TCP by a descriptor. */
#ifndef PALPATE_LINK_H
#define PALPATE_LINK_H

#include <stdbool.h>
#include <stddef.h>

typedef struct link link_t;

typedef enum link_result { LINK_OK, LINK_TIMEOUT, LINK_CLOSED, LINK_ERROR } link_result;

enum { LINK_TEXT = 256, LINK_BAUD = 921600 };

/* "/dev/ttyACM0" (libserialport), "pty:/dev/pts/5", "tcp:HOST:PORT", "unix:PATH" or "fd:N" (closed with the
 * link). On failure *made is NULL and why holds one line that says what to do (no such port, busy, no
 * permission, unknown baud). baud: of serial ports only. */
link_result link_open(const char *where, int baud, link_t **made, char why[LINK_TEXT]);
void link_close(link_t *l);

/* Reads what is there, *got bytes; waits at most timeout_ms for the first. LINK_CLOSED: unplugged, or the
 * other end has gone; link_error has the reason. */
link_result link_read(link_t *l, void *buffer, size_t size, size_t *got, int timeout_ms);
/* Writes all of it within timeout_ms. */
link_result link_write(link_t *l, const void *buffer, size_t size, int timeout_ms);
const char *link_error(const link_t *l);

/* Prints the serial ports, one a line with its description. Returns how many there are; -1: error. */
int link_list(void);

/* Seconds of a clock that is never set back. */
double link_now_s(void);

#endif
