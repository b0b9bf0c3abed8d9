/* ring.h: a byte queue between one writer and one reader, either of which may be an interrupt. */
#ifndef RING_H
#define RING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Zero head and tail = empty. size: a power of two; holds size - 1 bytes. */
typedef struct ring {
    uint8_t *byte;
    uint32_t size;
    volatile uint32_t head; /* next to write; the writer's */
    volatile uint32_t tail; /* next to read; the reader's */
} ring;

void ring_init(ring *r, uint8_t *byte, uint32_t size);
uint32_t ring_used(const ring *r);
uint32_t ring_free(const ring *r);
bool ring_put(ring *r, uint8_t byte);                      /* false = full */
bool ring_put_all(ring *r, const uint8_t *byte, size_t n); /* all or nothing */
bool ring_get(ring *r, uint8_t *byte);                     /* false = empty */
uint32_t ring_take(ring *r, uint8_t *byte, uint32_t most); /* how many it took */

#endif
