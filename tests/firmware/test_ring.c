/* test_ring.c: the byte queue, and one writer and one reader at once. */
#define _POSIX_C_SOURCE 200809L
#include "ring.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { SIZE = 16 };

static void test_fills_and_empties(void **state) {
    uint8_t byte[SIZE], got;
    ring r;
    (void)state;
    ring_init(&r, byte, SIZE);
    assert_false(ring_get(&r, &got));
    for (uint8_t i = 0; i < SIZE - 1; i++) {
        assert_int_equal(ring_free(&r), SIZE - 1 - i);
        assert_true(ring_put(&r, i));
        assert_int_equal(ring_used(&r), i + 1);
    }
    assert_false(ring_put(&r, 99));
    for (uint8_t i = 0; i < SIZE - 1; i++) {
        assert_true(ring_get(&r, &got));
        assert_int_equal(got, i);
    }
    assert_false(ring_get(&r, &got));
}

/* From every place in the ring, every length: whole or not at all, and nothing beside the ring touched. */
static void test_all_or_nothing(void **state) {
    uint8_t byte[SIZE + 2], piece[SIZE + 1], got;
    (void)state;
    for (uint8_t i = 0; i < sizeof piece; i++)
        piece[i] = (uint8_t)(i + 1);
    for (uint32_t at = 0; at < SIZE; at++) {
        for (size_t n = 0; n <= SIZE; n++) {
            ring r;
            memset(byte, 0xee, sizeof byte);
            ring_init(&r, byte + 1, SIZE);
            r.head = r.tail = at;
            assert_int_equal(ring_put_all(&r, piece, n), n < SIZE);
            assert_int_equal(ring_used(&r), n < SIZE ? n : 0);
            for (size_t i = 0; i < n && n < SIZE; i++) {
                assert_true(ring_get(&r, &got));
                assert_int_equal(got, i + 1);
            }
            assert_false(ring_get(&r, &got));
            assert_true(byte[0] == 0xee && byte[SIZE + 1] == 0xee);
        }
    }
}

enum { BYTES = 1000000 };

static void *write_all(void *context) {
    ring *r = context;
    uint8_t piece[7];
    for (uint32_t i = 0; i < BYTES;) {
        uint8_t n = 0;
        while (n < sizeof piece && i + n < BYTES) {
            piece[n] = (uint8_t)((i + n) * 2654435761u >> 24);
            n++;
        }
        if (ring_put_all(r, piece, n))
            i += n;
    }
    return NULL;
}

static void test_two_threads(void **state) {
    uint8_t byte[SIZE], got;
    ring r;
    pthread_t writer;
    (void)state;
    ring_init(&r, byte, SIZE);
    assert_int_equal(pthread_create(&writer, NULL, write_all, &r), 0);
    for (uint32_t i = 0; i < BYTES;) {
        if (!ring_get(&r, &got))
            continue;
        assert_int_equal(got, (uint8_t)(i * 2654435761u >> 24));
        i++;
    }
    assert_int_equal(pthread_join(writer, NULL), 0);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_fills_and_empties),
    cmocka_unit_test(test_all_or_nothing),
    cmocka_unit_test(test_two_threads),
    {0},
};
