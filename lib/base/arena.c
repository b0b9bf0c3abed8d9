/* arena.c: a list of blocks, each a header and an array. */
#include "arena.h"

#include <stdint.h>
#include <stdlib.h>

typedef struct arena_block {
    struct arena_block *before;
    long double array[]; /* aligned for every type */
} arena_block;

void *arena_take(arena *a, size_t n, size_t size) {
    bool fits = n <= (SIZE_MAX - sizeof(arena_block)) / size;
    arena_block *block = fits ? calloc(1, sizeof *block + n * size) : NULL;
    if (!block) {
        a->failed = true;
        return NULL;
    }
    block->before = a->last;
    a->last = block;
    return block->array;
}

void arena_free(arena *a) {
    while (a->last) {
        arena_block *block = a->last;
        a->last = block->before;
        free(block);
    }
    a->failed = false;
}
