/* ring.c: a byte queue between one writer and one reader, either of which may be an interrupt. */
#include "ring.h"

#include <string.h>

/* The bytes must be written before head says so, and read before tail does. */
static uint32_t look(const volatile uint32_t *index) {
    return __atomic_load_n(index, __ATOMIC_ACQUIRE);
}

static void publish(volatile uint32_t *index, uint32_t value) {
    __atomic_store_n(index, value, __ATOMIC_RELEASE);
}

void ring_init(ring *r, uint8_t *byte, uint32_t size) {
    *r = (ring){byte, size, 0, 0};
}

uint32_t ring_used(const ring *r) {
    return (look(&r->head) - look(&r->tail)) & (r->size - 1);
}

uint32_t ring_free(const ring *r) {
    return r->size - 1 - ring_used(r);
}

bool ring_put(ring *r, uint8_t byte) {
    return ring_put_all(r, &byte, 1);
}

bool ring_put_all(ring *r, const uint8_t *byte, size_t n) {
    const uint32_t head = r->head, to_end = r->size - head;
    const size_t first = n < to_end ? n : to_end;
    if (n > ring_free(r))
        return false;
    memcpy(r->byte + head, byte, first);
    memcpy(r->byte, byte + first, n - first);
    publish(&r->head, (head + (uint32_t)n) & (r->size - 1));
    return true;
}

bool ring_get(ring *r, uint8_t *byte) {
    const uint32_t tail = r->tail;
    if (tail == look(&r->head))
        return false;
    *byte = r->byte[tail];
    publish(&r->tail, (tail + 1) & (r->size - 1));
    return true;
}

uint32_t ring_take(ring *r, uint8_t *byte, uint32_t most) {
    const uint32_t tail = r->tail, to_end = r->size - tail, used = ring_used(r);
    const uint32_t n = used < most ? used : most, first = n < to_end ? n : to_end;
    memcpy(byte, r->byte + tail, first);
    memcpy(byte + first, r->byte, n - first);
    publish(&r->tail, (tail + n) & (r->size - 1));
    return n;
}
