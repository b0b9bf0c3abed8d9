/* link_serial.h: a link's door to libserialport. */
#ifndef PALPATE_LINK_SERIAL_H
#define PALPATE_LINK_SERIAL_H

#include "link.h"

#include <sys/types.h>

struct sp_port;

/* Opens it raw, 8N1, without flow control, for us alone; *fd is for poll(). NULL and why on failure. */
struct sp_port *link_serial_open(const char *name, int baud, int *fd, char why[LINK_TEXT]);
void link_serial_close(struct sp_port *port);

/* As read() and write() of a descriptor that does not block: -1 and errno. */
ssize_t link_serial_read(struct sp_port *port, void *buffer, size_t size);
ssize_t link_serial_write(struct sp_port *port, const void *buffer, size_t size);

#endif
