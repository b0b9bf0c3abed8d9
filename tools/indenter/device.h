/* device.h: an indenter at the end of a link: commands with their answers, and the sample stream. */
#ifndef PALPATE_DEVICE_H
#define PALPATE_DEVICE_H

#include "link.h"

#include <palpate/wire.h>
#include <pthread.h>

enum { DEVICE_TEXT = 256 };

/* Told of every good frame, in order; lost_frames = frames missing before it by its sequence number. */
typedef void device_listener(const palp_wire_message *message, unsigned lost_frames, void *context);

typedef struct device {
    link_t *link;
    pthread_mutex_t writing; /* of frames, which must not mix */
    uint16_t halts;          /* sent by device_halt */
    palp_wire_decoder decoder;
    uint16_t sequence;                  /* of our next command */
    bool heard;                         /* a frame has come in */
    uint16_t device_sequence;           /* of the last frame */
    uint32_t device_lost;               /* its count of lost samples then */
    uint32_t lost_frames, lost_samples; /* since it was opened */
    uint32_t device_tick;               /* newest known */
    palp_wire_info info;
    palp_wire_status status; /* newest */
    bool status_known;
    double alive_s;      /* wall clock of our last frame to it */
    uint32_t alive_tick; /* and the device's tick then */
    uint8_t refusal;     /* palp_wire_result, after DEVICE_REFUSED */
    device_listener *listener;
    void *context;
    char why[DEVICE_TEXT]; /* of the last failure, one line */
} device;

typedef enum device_result {
    DEVICE_OK,
    DEVICE_TIMEOUT,
    DEVICE_CLOSED,
    DEVICE_REFUSED,
    DEVICE_OTHER_VERSION
} device_result;

/* Opens the link and shakes hands: HELLO until INFO comes (a first byte may get lost, a PTY may take a
 * second). DEVICE_OTHER_VERSION where its protocol is not ours; DEVICE_CLOSED also where the link does not
 * open. To be closed only after DEVICE_OK. */
device_result device_open(const char *where, int baud, device *d);
void device_close(device *d);

/* The same again, where the link has broken; what is known of the device stays until it says otherwise. After
 * a failure it is closed, and may be tried again. device_halt may be called meanwhile. */
device_result device_reopen(const char *where, int baud, device *d);

/* Sends a command until it is acknowledged (the same sequence number each time, so that the device does it
 * once); frames that arrive meanwhile go to the listener. DEVICE_REFUSED: why says the reason. answer (may be
 * NULL): the frame that HELLO or a GET command is answered by. */
device_result device_command(device *d, palp_wire_message *command, palp_wire_message *answer);

/* A command that is a type only. */
device_result device_do(device *d, palp_wire_type type, palp_wire_message *answer);

/* Takes what arrives within timeout_ms, at most one read of it; DEVICE_TIMEOUT: nothing came. Keeps the
 * device from missing us (ALIVE, by its clock and ours). */
device_result device_poll(device *d, int timeout_ms);

/* Sends HALT, at once: the one call that another thread may make while one is in the others. Nothing says
 * whether it came; the state does, and it may be sent again. */
device_result device_halt(device *d);

#endif
