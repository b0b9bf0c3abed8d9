/* store.h: the machine's parameters in flash: a log of records in two areas. A record is only ever added, and
 * an area erased only while the last good record is in the other, so that a cut of the supply never takes it.
 */
#ifndef STORE_H
#define STORE_H

#include <stdbool.h>
#include <stdint.h>

/* Sizes in words of 32 bits. A word that was erased is STORE_BLANK; programming can only clear bits. */
enum {
    STORE_RECORD = 128,
    STORE_AREA = 6 * STORE_RECORD,
    STORE_AREAS = 2,
    STORE_WORDS = STORE_AREAS * STORE_AREA,
    STORE_VALUES =
        STORE_RECORD - 3 /* most values of a record: beside them its head, its number and its check */
};
#define STORE_BLANK UINT32_MAX

typedef struct store {
    const uint32_t *memory; /* STORE_WORDS as they are in flash; NULL: there is none */
    uint32_t sequence;      /* of the last good record; 0 = none */
    uint32_t good;          /* where it begins */
    uint32_t room;          /* where the next would begin; STORE_WORDS: no room before the next start */
    bool spare;             /* the other area is blank */
    uint8_t bad;            /* records that fail their check */
    /* of the record being written */
    bool writing, failed; /* failed: the last one did not come out as it should */
    uint32_t at, n, check;
} store;

/* CRC-32 (ISO-HDLC) of words, each from its lowest byte: begin with 0, feed word by word. */
uint32_t store_check(uint32_t check, uint32_t word);

/* Looks at what is there. */
void store_open(store *s, const uint32_t *memory);
/* The last good record's values, n of them; NULL where there is none. */
const uint32_t *store_values(const store *s, uint32_t *n);
/* Begins a record of n values; false: no room. */
bool store_begin(store *s, uint32_t n);
/* While writing: the value that is wanted next, by its number; and, given that, the next word to be
 * programmed and where. False: all were, and what is there now has been looked at. */
uint32_t store_wants(const store *s);
bool store_step(store *s, uint32_t value, uint32_t *at, uint32_t *word);

/* The area that is to be erased at the start, before anything can move: the one without the last good record,
 * where something is in it; STORE_AREAS = none. So there is room for six records in each session at least. */
uint32_t store_to_erase(const uint32_t *memory);

#endif
