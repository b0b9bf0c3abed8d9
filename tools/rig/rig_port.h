/* rig_port.h: where the virtual indenter answers: a pseudo-terminal, TCP, a file or an open socket. */
#ifndef PALPATE_RIG_PORT_H
#define PALPATE_RIG_PORT_H

#include "plant_link.h"

#include <palpate/file.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum rig_port_kind { RIG_PORT_SOCKET, RIG_PORT_PTY, RIG_PORT_FILE } rig_port_kind;

typedef struct rig_port {
    const char *command; /* for its errors */
    rig_port_kind kind;
    int listener, connection; /* descriptors; -1 = none */
    int patience_ms;          /* how long a full port may delay the indenter; 0 after it was once too long */
    uint8_t held[PLANT_LINK_TX];
    size_t n_held;
    palp_file file; /* of "file:PATH" */
    int failed;     /* errno of a write that failed, 0 = none */
} rig_port;

/* Opens "pty", "tcp:PORT" (of this machine), "file:PATH" or "fd:NUMBER". name: what to connect to, such as
 * "pty:/dev/pts/5". Both return an exit code, after one line on stderr under command. rig_port_close must
 * follow in any case. */
int rig_port_open(const char *command, const char *wanted, rig_port *port, char *name, size_t size);
int rig_port_close(rig_port *port);

/* Reads at most so many of the bytes that have arrived. Accepts a connection. */
size_t rig_port_read(rig_port *port, uint8_t *byte, size_t most);

/* Writes n bytes, at most PLANT_LINK_TX, after those that wait. False while bytes wait at a full port: then
 * only n = 0 may be written. Without a listener the bytes are dropped, as on a serial line. */
bool rig_port_write(rig_port *port, const uint8_t *byte, size_t n);

#endif
