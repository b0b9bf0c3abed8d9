/* test_stream.c: samples in whole frames or counted as lost, gaps that stay gaps, room for answers. */
#include "stream.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { SIZE = 4096, MOST = 256, FRAME = 240 };

typedef struct wire {
    stream s;
    uint8_t byte[SIZE];
    palp_wire_decoder decoder;
    palp_wire_message got[MOST];
    size_t n;
} wire;

static void begin(wire *w) {
    memset(w, 0, sizeof *w);
    stream_init(&w->s, w->byte, SIZE);
    w->s.on = true;
}

static void take(wire *w) {
    uint8_t byte;
    w->n = 0;
    while (ring_get(&w->s.out, &byte))
        if (palp_wire_decode(&w->decoder, byte, &w->got[w->n])) {
            w->n++;
            assert_true(w->n < MOST);
        }
    assert_int_equal(w->decoder.bad, 0);
}

static sample of(uint32_t tick) {
    sample one = {
        .tick = tick, .position = -(int32_t)tick, .error = (int16_t)(tick + 1), .duty = (int16_t)(tick + 2)};
    for (int i = 0; i < PALP_WIRE_CHANNELS; i++)
        one.adc[i] = (int16_t)(100 * i - (int)tick);
    one.flags = (uint16_t)(tick << 8 | 5);
    return one;
}

/* A tick; true if a frame was queued. */
static bool add(wire *w, uint32_t tick) {
    const sample one = of(tick);
    const bool sent = stream_turn(&w->s);
    stream_sample(&w->s, &one, PALP_WIRE_STATE_RUN, 2345);
    return sent;
}

static void check_block(const palp_wire_message *m, uint32_t tick, uint8_t count) {
    const palp_wire_samples *block = &m->as.samples;
    assert_int_equal(m->type, PALP_WIRE_TYPE_SAMPLES);
    assert_int_equal(block->tick, tick);
    assert_int_equal(block->count, count);
    assert_int_equal(block->case_cC, 2345);
    for (uint8_t i = 0; i < count; i++) {
        const sample wanted = of(tick + i);
        assert_int_equal(block->position[i], wanted.position);
        assert_int_equal(block->error[i], wanted.error);
        assert_int_equal(block->duty[i], wanted.duty);
        assert_int_equal(block->flags[i], wanted.flags);
        assert_memory_equal(block->adc + (size_t)i * PALP_WIRE_CHANNELS, wanted.adc, sizeof wanted.adc);
    }
    for (uint8_t i = count; i < PALP_WIRE_SAMPLES; i++)
        assert_true(block->position[i] == 0 && block->error[i] == 0 && block->duty[i] == 0 &&
                    block->flags[i] == 0);
}

static void test_ten_to_a_frame(void **state) {
    wire w;
    (void)state;
    begin(&w);
    for (uint32_t tick = 1; tick <= 31; tick++)
        assert_int_equal(add(&w, tick), tick > 1 && tick % PALP_WIRE_SAMPLES == 1);
    take(&w);
    assert_int_equal(w.n, 3);
    for (uint32_t i = 0; i < 3; i++) {
        check_block(&w.got[i], 10 * i + 1, PALP_WIRE_SAMPLES);
        assert_int_equal(w.got[i].sequence, i);
        assert_int_equal(w.got[i].lost, 0);
    }
}

static void test_off_sends_nothing(void **state) {
    wire w;
    (void)state;
    begin(&w);
    w.s.on = false;
    for (uint32_t tick = 1; tick <= 30; tick++)
        assert_false(add(&w, tick));
    take(&w);
    assert_int_equal(w.n, 0);
    assert_int_equal(w.s.lost, 0);
}

static void test_a_gap_ends_a_frame(void **state) {
    wire w;
    (void)state;
    begin(&w);
    for (uint32_t tick = 1; tick <= 4; tick++)
        add(&w, tick);
    assert_false(add(&w, 6));
    for (uint32_t tick = 7; tick <= 16; tick++)
        assert_int_equal(add(&w, tick), tick == 7 || tick == 16);
    take(&w);
    assert_int_equal(w.n, 2);
    check_block(&w.got[0], 1, 4);
    check_block(&w.got[1], 6, 10);
}

static void test_a_state_ends_a_frame(void **state) {
    wire w;
    const sample after = of(4);
    (void)state;
    begin(&w);
    for (uint32_t tick = 1; tick <= 3; tick++)
        add(&w, tick);
    stream_sample(&w.s, &after, PALP_WIRE_STATE_FAULT, 2345);
    assert_true(w.s.due);
    stream_end_block(&w.s); /* without a turn in between nothing is lost */
    assert_true(stream_turn(&w.s));
    stream_end_block(&w.s);
    assert_false(stream_turn(&w.s));
    take(&w);
    assert_int_equal(w.n, 2);
    check_block(&w.got[0], 1, 3);
    assert_int_equal(w.got[0].as.samples.state, PALP_WIRE_STATE_RUN);
    check_block(&w.got[1], 4, 1);
    assert_int_equal(w.got[1].as.samples.state, PALP_WIRE_STATE_FAULT);
}

/* Nobody reads: whole frames are lost, answers still find room, and all is accounted for. */
static void test_full(void **state) {
    const uint32_t fit = (SIZE - 1 - STREAM_RESERVE) / FRAME;
    palp_wire_message ack = {.type = PALP_WIRE_TYPE_ACK};
    wire w;
    uint32_t answers = 0, samples = 0;
    (void)state;
    begin(&w);
    for (uint32_t tick = 1; tick <= 1000; tick++)
        add(&w, tick);
    stream_turn(&w.s);
    assert_in_range(w.s.lost, 1000 - 10 * fit, 1000 - 10 * (fit - 1));
    while (stream_send(&w.s, &ack))
        answers++;
    assert_false(stream_offer(&w.s, &ack));
    assert_true(answers >= STREAM_RESERVE / 20);
    const uint32_t before = w.s.lost;
    for (uint32_t tick = 1001; tick <= 1010; tick++)
        add(&w, tick);
    stream_turn(&w.s);
    assert_int_equal(w.s.lost, before + 10);
    take(&w);
    for (size_t i = 0; i < w.n; i++) {
        assert_int_equal(w.got[i].sequence, i);
        samples += w.got[i].type == PALP_WIRE_TYPE_SAMPLES ? w.got[i].as.samples.count : 0;
    }
    assert_int_equal(samples + w.s.lost, 1010);
    for (uint32_t tick = 1011; tick <= 1020; tick++)
        add(&w, tick);
    stream_turn(&w.s);
    take(&w);
    assert_int_equal(w.n, 1);
    check_block(&w.got[0], 1011, 10);
    assert_int_equal(w.got[0].lost, w.s.lost);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_ten_to_a_frame),
    cmocka_unit_test(test_off_sends_nothing),
    cmocka_unit_test(test_a_gap_ends_a_frame),
    cmocka_unit_test(test_a_state_ends_a_frame),
    cmocka_unit_test(test_full),
    {0},
};
