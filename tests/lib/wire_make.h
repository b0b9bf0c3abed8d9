/* wire_make.h: messages of the indenter's protocol for tests: random ones, comparison, and the golden frames.
 */
#ifndef WIRE_MAKE_H
#define WIRE_MAKE_H

#include <palpate/wire.h>

/* One of each message. */
#define WIRE_ONE(NAME, number, member, fields) +1
enum { WIRE_GOLDEN = PALP_WIRE_MESSAGES(WIRE_ONE) };

typedef struct wire_frame {
    palp_wire_message message;
    uint8_t byte[PALP_WIRE_FRAME_MAX];
    size_t n;
} wire_frame;

uint64_t wire_random(uint64_t *state);

/* Sequence, lost and every field of a message of this type; zeros are frequent. */
void wire_fill(palp_wire_message *message, uint8_t type, uint64_t *state);

/* The same header and fields. */
bool wire_same(const palp_wire_message *a, const palp_wire_message *b);

/* Reads tests/data/wire/golden.txt: how many frames, or 0 and a line on stderr. */
size_t wire_golden(wire_frame golden[WIRE_GOLDEN]);

#endif
