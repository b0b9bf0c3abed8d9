/* store.c: the machine's parameters in flash: records that are found, and written a word a tick.
 *
 * A record: 0x5041, its version and the number n of its values; its own number, from 1; n values; the CRC-32
 * of all that. */
#include "store.h"

#include <stddef.h>

#define HEAD 0x50410100u /* "PA", version 1; the number of values in the lowest byte */

enum { FIRST = 2 /* word of a record with a value */ };

/* The remainders of the half bytes 0..15. */
static const uint32_t remainder_of[16] = {
    0x00000000, 0x1db71064, 0x3b6e20c8, 0x26d930ac, 0x76dc4190, 0x6b6b51f4, 0x4db26158, 0x5005713c,
    0xedb88320, 0xf00f9344, 0xd6d6a3e8, 0xcb61b38c, 0x9b64c2b0, 0x86d3d2d4, 0xa00ae278, 0xbdbdf21c};

uint32_t store_check(uint32_t check, uint32_t word) {
    uint32_t rest = ~check ^ word;
    for (int i = 0; i < 8; i++)
        rest = rest >> 4 ^ remainder_of[rest & 15];
    return ~rest;
}

static bool is_blank(const uint32_t *word, uint32_t n) {
    for (; n > 0; n--)
        if (*word++ != STORE_BLANK)
            return false;
    return true;
}

static uint32_t values_of(const uint32_t *record) {
    const uint32_t n = record[0] - HEAD;
    return n >= 1 && n <= STORE_VALUES ? n : 0;
}

static bool is_good(const uint32_t *record) {
    const uint32_t n = values_of(record);
    uint32_t check = 0;
    for (uint32_t i = 0; i < FIRST + n; i++)
        check = store_check(check, record[i]);
    return n > 0 && record[1] > 0 && record[1] < STORE_BLANK && record[FIRST + n] == check;
}

/* Where an area is blank to its end; its end, where it is full. */
static uint32_t free_in(const uint32_t *memory, uint32_t area) {
    const uint32_t begin = area * STORE_AREA;
    uint32_t at = begin + STORE_AREA;
    while (at > begin && is_blank(memory + at - STORE_RECORD, STORE_RECORD))
        at -= STORE_RECORD;
    return at;
}

static void find_good(store *s) {
    for (uint32_t at = 0; at < STORE_WORDS; at += STORE_RECORD) {
        const uint32_t *record = s->memory + at;
        if (is_good(record) && record[1] > s->sequence) {
            s->sequence = record[1];
            s->good = at;
        } else if (!is_good(record) && !is_blank(record, STORE_RECORD)) {
            s->bad++;
        }
    }
}

/* A full area is followed by the other, once. */
static void find_room(store *s, uint32_t area, uint32_t at) {
    s->room = at;
    if (at == (area + 1) * STORE_AREA) {
        s->room = s->spare ? (STORE_AREAS - 1 - area) * STORE_AREA : (uint32_t)STORE_WORDS;
        s->spare = false;
    }
}

static uint32_t other_area(const store *s) {
    return STORE_AREAS - 1 - s->good / STORE_AREA;
}

void store_open(store *s, const uint32_t *memory) {
    *s = (store){.memory = memory, .room = STORE_WORDS};
    if (memory == NULL)
        return;
    find_good(s);
    s->spare = is_blank(memory + other_area(s) * STORE_AREA, STORE_AREA);
    find_room(s, s->good / STORE_AREA, free_in(memory, s->good / STORE_AREA));
}

const uint32_t *store_values(const store *s, uint32_t *n) {
    if (s->sequence == 0)
        return NULL;
    *n = values_of(s->memory + s->good);
    return s->memory + s->good + FIRST;
}

uint32_t store_to_erase(const uint32_t *memory) {
    store s;
    store_open(&s, memory);
    const uint32_t other = other_area(&s);
    return is_blank(memory + other * STORE_AREA, STORE_AREA) ? (uint32_t)STORE_AREAS : other;
}

bool store_begin(store *s, uint32_t n) {
    if (s->room >= STORE_WORDS || n < 1 || n > STORE_VALUES)
        return false;
    s->writing = true;
    s->failed = false;
    s->at = s->check = 0;
    s->n = n;
    return true;
}

uint32_t store_wants(const store *s) {
    return s->at >= FIRST && s->at < FIRST + s->n ? s->at - FIRST : 0;
}

static void end(store *s) {
    s->writing = false;
    s->failed = !is_good(s->memory + s->room);
    if (s->failed) {
        s->bad++;
    } else {
        s->sequence++;
        s->good = s->room;
    }
    find_room(s, s->room / STORE_AREA, s->room + STORE_RECORD);
}

bool store_step(store *s, uint32_t value, uint32_t *at, uint32_t *word) {
    if (s->at > FIRST + s->n) {
        end(s);
        return false;
    }
    *word = s->at == 0 ? HEAD + s->n : s->at == 1 ? s->sequence + 1 : s->at < FIRST + s->n ? value : s->check;
    *at = s->room + s->at++;
    s->check = store_check(s->check, *word);
    return true;
}
