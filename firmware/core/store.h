/* store.h: the machine's parameters in flash: a log of records in two areas. Records are only added. An area
 * is erased only while the last good record is in the other, so that a power failure never loses it. */
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
    bool writing, failed; /* failed: the last record does not read back as written */
    uint32_t at, n, check;
} store;

/* CRC-32 (ISO-HDLC) of words, each from its lowest byte: begin with 0, feed word by word. */
uint32_t store_check(uint32_t check, uint32_t word);

/* Reads the areas, and finds the last good record and the free place. */
void store_open(store *s, const uint32_t *memory);
/* The last good record's values, n of them; NULL where there is none. */
const uint32_t *store_values(const store *s, uint32_t *n);
/* Begins a record of n values; false: no room. */
bool store_begin(store *s, uint32_t n);
/* While a record is written: the number of the next value that is needed; with that value, the next word to
 * program and its place. False: all words are written, and the record has been read back. */
uint32_t store_wants(const store *s);
bool store_step(store *s, uint32_t value, uint32_t *at, uint32_t *word);

/* The area to erase at the start, before anything can move: the one without the last good record, unless it
 * is blank; STORE_AREAS = none. So each session has room for at least six records. */
uint32_t store_to_erase(const uint32_t *memory);

#endif
