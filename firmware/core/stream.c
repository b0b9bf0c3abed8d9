/* stream.c: frames to the host: samples of every tick, and answers. */
#include "stream.h"

#include <string.h>

void stream_init(stream *s, uint8_t *byte, uint32_t size) {
    memset(s, 0, sizeof *s);
    ring_init(&s->out, byte, size);
    s->block[0].type = s->block[1].type = PALP_WIRE_TYPE_SAMPLES;
}

/* A frame that finds no room takes no number, so that a gap in the numbers means a loss on the line. */
static bool send_leaving(stream *s, palp_wire_message *message, uint32_t reserve) {
    uint8_t frame[PALP_WIRE_FRAME_MAX];
    const size_t most = palp_wire_payload_size(message->type) + PALP_WIRE_FRAME_MAX - PALP_WIRE_PAYLOAD_MAX;
    if (ring_free(&s->out) < most + reserve)
        return false;
    message->sequence = s->sequence++;
    message->lost = s->lost;
    return ring_put_all(&s->out, frame, palp_wire_encode(message, frame));
}

bool stream_send(stream *s, palp_wire_message *message) {
    return send_leaving(s, message, 0);
}

bool stream_offer(stream *s, palp_wire_message *message) {
    return send_leaving(s, message, STREAM_RESERVE);
}

bool stream_turn(stream *s) {
    palp_wire_message *block = &s->block[!s->gathering];
    if (!s->due)
        return false;
    if (!stream_offer(s, block))
        s->lost += block->as.samples.count;
    s->due = false;
    return true;
}

void stream_end_block(stream *s) {
    if (s->block[s->gathering].as.samples.count == 0)
        return;
    (void)stream_turn(s);
    s->due = true;
    s->gathering = !s->gathering;
    memset(&s->block[s->gathering].as.samples, 0, sizeof s->block[0].as.samples);
}

static void add(palp_wire_samples *block, const sample *one) {
    const uint8_t i = block->count++;
    block->position[i] = one->position;
    block->error[i] = one->error;
    memcpy(block->adc + (size_t)i * PALP_WIRE_CHANNELS, one->adc, sizeof one->adc);
    block->duty[i] = one->duty;
    block->flags[i] = one->flags;
}

void stream_sample(stream *s, const sample *one, uint8_t state, int16_t case_cC) {
    palp_wire_samples *block = &s->block[s->gathering].as.samples;
    if (!s->on)
        return;
    if (block->state != state || one->tick != block->tick + block->count)
        stream_end_block(s);
    block = &s->block[s->gathering].as.samples;
    if (block->count == 0) {
        block->tick = one->tick;
        block->state = state;
        block->case_cC = case_cC;
    }
    add(block, one);
    if (block->count == PALP_WIRE_SAMPLES)
        stream_end_block(s);
}
