/* arena.h: the arrays of an object, freed together. Internal. */
#ifndef ARENA_H
#define ARENA_H

#include <stdbool.h>
#include <stddef.h>

/* {NULL, false} is an empty arena. */
typedef struct arena {
    struct arena_block *last;
    bool failed; /* an allocation failed */
} arena;

/* An array of n elements of this size, all zero; n = 0 gives an array too. NULL, and failed is set, if there
 * is no memory. */
void *arena_take(arena *a, size_t n, size_t size);

/* Frees all arrays and empties the arena. */
void arena_free(arena *a);

#endif
