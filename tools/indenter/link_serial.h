/* link_serial.h: what a link needs of libserialport. */
#ifndef PALPATE_LINK_SERIAL_H
#define PALPATE_LINK_SERIAL_H

#include "link.h"

#include <sys/types.h>

struct sp_port;

/* Opens a port raw, 8N1, without flow control and closed to other programs; *fd is for poll(). On failure
 * NULL, and why has the reason. */
struct sp_port *link_serial_open(const char *name, int baud, int *fd, char why[LINK_TEXT]);
void link_serial_close(struct sp_port *port);

/* As read() and write() of a descriptor that does not block: -1 and errno. */
ssize_t link_serial_read(struct sp_port *port, void *buffer, size_t size);
ssize_t link_serial_write(struct sp_port *port, const void *buffer, size_t size);

#endif
