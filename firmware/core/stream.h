/* stream.h: frames to the host: samples of every tick, and answers. */
#ifndef STREAM_H
#define STREAM_H

#include "ring.h"

#include <palpate/wire.h>

/* Bytes of the queue that samples leave free, so that they cannot starve answers. */
enum { STREAM_RESERVE = 1024 };

typedef struct stream {
    ring out;
    bool on;
    uint16_t sequence;          /* of the next frame */
    uint32_t lost;              /* samples dropped since the start: the queue was full */
    palp_wire_message block[2]; /* samples being gathered; and those that are due */
    uint8_t gathering;          /* which is which */
    bool due;
} stream;

typedef struct sample {
    uint32_t tick;
    int32_t position;
    int16_t error;
    int16_t adc[PALP_WIRE_CHANNELS];
    int16_t duty;
    uint16_t flags;
} sample;

void stream_init(stream *s, uint8_t *byte, uint32_t size);
/* Queues an answer; false = no room. sequence and lost are filled in. */
bool stream_send(stream *s, palp_wire_message *message);
/* The same for a frame that may be left out: it never uses the reserve. */
bool stream_offer(stream *s, palp_wire_message *message);
/* Adds a sample while on. A full block becomes due, and so does one of another state or one that a tick is
 * missing after. */
void stream_sample(stream *s, const sample *one, uint8_t state, int16_t case_cC);
void stream_end_block(stream *s); /* the gathered samples are due, however few */
/* Queues the block that is due, the most expensive of all frames; where there is no room all of it is lost.
 * False if none was due. Once a tick. */
bool stream_turn(stream *s);

#endif
