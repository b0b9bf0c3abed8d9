/* port.h: the host process's side of serial.h: a socket, a pseudo-terminal or TCP. */
#ifndef PORT_H
#define PORT_H

#include "serial.h"

/* Descriptors to keep over a restart of the process; -1 = none. */
typedef struct port_files {
    int listener, connection;
} port_files;

/* "unix:PATH", "pty" or "tcp:PORT" (0 = any); says on stdout what to connect to. Why not, or NULL. */
const char *port_open(const char *name);
void port_resume(const char *name, port_files files);
port_files port_kept(void);
void port_poll(void); /* once a tick: takes what has arrived, and whoever connects */

#endif
