/* arena.h: the arrays of an object, freed together. Internal. */
#ifndef ARENA_H
#define ARENA_H

#include <stdbool.h>
#include <stddef.h>

/* {NULL, false} is an empty one. */
typedef struct arena {
    struct arena_block *last;
    bool failed; /* an array that was asked for is missing */
} arena;

/* n elements of this size, all zero; also for n = 0 an array of its own. NULL and failed where there is no
 * memory. */
void *arena_take(arena *a, size_t n, size_t size);

/* Frees all arrays; the arena is empty then. */
void arena_free(arena *a);

#endif
