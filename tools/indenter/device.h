/* device.h: an indenter at the end of a link: commands with their answers, and the sample stream. */
#ifndef PALPATE_DEVICE_H
#define PALPATE_DEVICE_H

#include "link.h"

#include <palpate/wire.h>
#include <pthread.h>

enum { DEVICE_TEXT = 256, DEVICE_AXIS_Z = 2 /* of the sensor: along the press */ };

/* Called for every good frame, in order. lost_frames: how many are missing before it, by the sequence
 * numbers. */
typedef void device_listener(const palp_wire_message *message, unsigned lost_frames, void *context);

typedef struct device {
    link_t *link;
    pthread_mutex_t writing; /* so that the bytes of two frames do not mix */
    uint16_t halts;          /* sent by device_halt */
    palp_wire_decoder decoder;
    uint16_t sequence;                  /* of our next command */
    bool heard;                         /* a frame has come in */
    uint16_t device_sequence;           /* of the last frame */
    uint32_t device_lost;               /* its count of lost samples in that frame */
    uint32_t lost_frames, lost_samples; /* since it was opened */
    uint32_t device_tick;               /* newest known */
    palp_wire_info info;
    palp_wire_status status; /* newest */
    bool status_known;
    double alive_s;      /* wall clock of our last frame to it */
    uint32_t alive_tick; /* and the device's tick at that time */
    uint8_t refusal;     /* palp_wire_result, after DEVICE_REFUSED */
    device_listener *listener;
    void *context;
    char why[DEVICE_TEXT]; /* reason of the last failure, one line */
} device;

typedef enum device_result {
    DEVICE_OK,
    DEVICE_TIMEOUT,
    DEVICE_CLOSED,
    DEVICE_REFUSED,
    DEVICE_OTHER_VERSION
} device_result;

/* Opens the link and sends HELLO until INFO comes, since a first byte may be lost and a PTY may take a
 * second. DEVICE_OTHER_VERSION: the device speaks another protocol. DEVICE_CLOSED: also where the link does
 * not open. device_close must follow DEVICE_OK alone. */
device_result device_open(const char *where, int baud, device *d);
void device_close(device *d);

/* Opens a broken link again. The known state of the device is kept until the device reports another. After a
 * failure the link is closed, and this may be called again. device_halt may be called meanwhile. */
device_result device_reopen(const char *where, int baud, device *d);

/* Sends a command until it is acknowledged. The sequence number stays the same, so that the device carries it
 * out once. Frames that arrive meanwhile go to the listener. DEVICE_REFUSED: why has the reason. answer (may
 * be NULL): the frame that answers HELLO or a GET command. */
device_result device_command(device *d, palp_wire_message *command, palp_wire_message *answer);

/* The same for a command without fields. */
device_result device_do(device *d, palp_wire_type type, palp_wire_message *answer);

/* Reads once what arrives within timeout_ms; DEVICE_TIMEOUT: nothing came. Sends ALIVE when it is due, so
 * that the device does not stop for want of a host. */
device_result device_poll(device *d, int timeout_ms);

/* Sends HALT at once. This is the only call that a second thread may make while the first is in another. It
 * waits for no answer: the device's state shows whether HALT arrived, and it may be sent again. */
device_result device_halt(device *d);

/* device_poll for at most a twentieth of a second, then the newest status, into d->status. */
device_result device_status(device *d);

#endif
