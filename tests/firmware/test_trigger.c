/* test_trigger.c: a camera's pulses: in, they mark samples or start runs; out, they go with samples of a
 * recording. */
#include "app_bench.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

static palp_wire_message trigger(uint8_t in, uint8_t out, uint16_t every) {
    return (palp_wire_message){.type = PALP_WIRE_TYPE_TRIGGER, .as.trigger = {in, out, every}};
}

/* A run to 2 mm, samples streaming. */
static void begin(bench *b, palp_wire_message wanted) {
    palp_wire_message streaming = bench_stream(true), ramp = bench_move(0, 2, 5),
                      start = bench_start(1, -5, 100, 50); /* 4 mm from where it stands */
    bench_open(b, NULL);
    bench_contact(b);
    bench_accepted(b, &wanted);
    bench_accepted(b, &ramp);
    bench_accepted(b, &streaming);
    b->n_samples = 0;
    bench_accepted(b, &start);
}

static size_t count(const bench *b, uint16_t flag) {
    size_t n = 0;
    for (size_t i = 0; i < b->n_samples; i++)
        n += (b->sample[i].flags & flag) != 0;
    return n;
}

static const sample *first(const bench *b, uint16_t flag) {
    for (size_t i = 0; i < b->n_samples; i++)
        if (b->sample[i].flags & flag)
            return &b->sample[i];
    fail_msg("no sample with flag %u", flag);
    return NULL;
}

/* Three pulses mark three samples, and change nothing else; ignored, they mark none. */
static void test_marks(void **state) {
    (void)state;
    for (uint8_t in = PALP_WIRE_TRIGGER_IGNORED; in <= PALP_WIRE_TRIGGER_MARKS; in++) {
        bench b;
        begin(&b, trigger(in, 0, 0));
        for (int i = 0; i < 3; i++) {
            bench_run(&b, 100);
            b.pulse = true;
            bench_tick(&b);
        }
        bench_until(&b, PALP_WIRE_STATE_READY, 6000);
        bench_run(&b, 20);
        assert_int_equal(count(&b, PALP_WIRE_FLAG_TRIGGER_IN), in == PALP_WIRE_TRIGGER_MARKS ? 3 : 0);
        assert_int_equal(count(&b, PALP_WIRE_FLAG_TRIGGER_OUT), 0);
        bench_close(&b);
    }
}

/* It waits at its start, however long; the pulse's sample is the first. A pulse on the way there starts
 * nothing. */
static void test_starts(void **state) {
    bench b;
    (void)state;
    begin(&b, trigger(PALP_WIRE_TRIGGER_STARTS, 0, 0));
    b.pulse = true;
    bench_run(&b, 20000);
    assert_int_equal(b.app.supervisor.state, PALP_WIRE_STATE_RUN);
    assert_int_equal(count(&b, PALP_WIRE_FLAG_RECORD), 0);
    b.pulse = true;
    bench_tick(&b);
    const uint32_t tick = b.app.tick;
    bench_until(&b, PALP_WIRE_STATE_READY, 6000);
    bench_run(&b, 20);
    assert_int_equal(first(&b, PALP_WIRE_FLAG_RECORD)->tick, tick);
    assert_true(first(&b, PALP_WIRE_FLAG_RECORD)->flags & PALP_WIRE_FLAG_TRIGGER_IN);

    palp_wire_message start = bench_start(1, -1, 100, 50);
    bench_accepted(&b, &start);
    bench_run(&b, 1000);
    assert_int_equal(bench_simple(&b, PALP_WIRE_TYPE_STOP), PALP_WIRE_RESULT_DONE); /* ends the wait */
    bench_until(&b, PALP_WIRE_STATE_READY, 1000);
    bench_close(&b);
}

/* One with the first sample of the recording, and with every 25th after it; the output is that of the flag.
 */
static void test_gives(void **state) {
    static const uint16_t every[] = {0, 25, 1};
    (void)state;
    for (size_t k = 0; k < 3; k++) {
        bench b;
        size_t given = 0, at = 0;
        begin(&b, trigger(PALP_WIRE_TRIGGER_IGNORED, 1, every[k]));
        while (b.app.supervisor.state != PALP_WIRE_STATE_READY) {
            bench_tick(&b);
            given += b.out.trigger;
        }
        bench_run(&b, 20);
        const size_t rows = count(&b, PALP_WIRE_FLAG_RECORD);
        assert_int_equal(given, every[k] ? (rows + every[k] - 1) / every[k] : 1);
        assert_int_equal(count(&b, PALP_WIRE_FLAG_TRIGGER_OUT), given);
        for (size_t i = 0; i < b.n_samples; i++) {
            const uint16_t flags = b.sample[i].flags;
            const bool due = every[k] ? at % every[k] == 0 : at == 0;
            if (flags & PALP_WIRE_FLAG_RECORD)
                assert_int_equal((flags & PALP_WIRE_FLAG_TRIGGER_OUT) != 0, due);
            at += (flags & PALP_WIRE_FLAG_RECORD) != 0;
        }
        bench_close(&b);
    }
}

/* A new host has asked for none. */
static void test_ends_with_the_session(void **state) {
    palp_wire_message hello = {.type = PALP_WIRE_TYPE_HELLO, .as.hello = {PALP_WIRE_VERSION}};
    palp_wire_message bad[] = {trigger(3, 0, 0), trigger(0, 2, 0)}, good = trigger(2, 1, 7);
    bench b;
    (void)state;
    bench_open(&b, NULL);
    bench_home(&b);
    for (size_t i = 0; i < 2; i++)
        assert_int_equal(bench_command(&b, &bad[i]), PALP_WIRE_RESULT_RANGE);
    bench_accepted(&b, &good);
    assert_int_equal(b.app.trigger.in, PALP_WIRE_TRIGGER_STARTS);
    bench_accepted(&b, &hello);
    assert_true(b.app.trigger.in == 0 && b.app.trigger.out == 0);
    bench_close(&b);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_marks),
    cmocka_unit_test(test_starts),
    cmocka_unit_test(test_gives),
    cmocka_unit_test(test_ends_with_the_session),
    {0},
};
