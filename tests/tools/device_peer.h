/* device_peer.h: the other end of a link for the tests of device.c: a thread that answers commands, or fails
 * to. */
#ifndef DEVICE_PEER_H
#define DEVICE_PEER_H

#include <palpate/wire.h>
#include <pthread.h>

typedef struct peer_settings {
    uint16_t protocol;       /* that it says it speaks; 0 = ours */
    bool garbage;            /* sends noise, answers nothing */
    bool chatter;            /* sends samples, answers nothing */
    bool no_info;            /* another version's device that we do not understand */
    unsigned deaf;           /* bytes that are not received at first */
    unsigned lose_acks;      /* the first ACKs get lost, and ... */
    unsigned lose_answers;   /* ... what GET commands ask for */
    unsigned damage;         /* that many of its first frames have a flipped bit */
    bool closes;             /* when it receives a command */
    unsigned mistake;        /* takes this command (from 1) for one it has done before */
    uint8_t refuse, result;  /* this type is refused with this result */
    uint8_t classes;         /* of gains; 0 = any */
    uint32_t stream_ticks;   /* sends samples that far apart, */
    bool stream_on_demand;   /* but only after STREAM */
    bool leaves_at_stop;     /* closes after STOP */
    palp_wire_status status; /* that it has; its tick comes from here: */
    uint32_t status_ticks;   /* pass with each GET_STATUS */
} peer_settings;

typedef struct peer {
    peer_settings settings;
    int fd;
    /* commands received, and how often each type was carried out */
    unsigned n_seen, done[256];
    /* inside */
    palp_wire_message last; /* command */
    palp_wire_decoder decoder;
    uint16_t sequence;
    uint32_t tick;
    int stop[2];
    pthread_t thread;
} peer;

/* A thread on fd, until peer_stop or its end is closed. peer_stop leaves fd open. */
void peer_start(peer *p, int fd, const peer_settings *settings);
void peer_stop(peer *p);

/* Sends a message with the next sequence number. */
void peer_send(peer *p, palp_wire_message *m);

#endif
