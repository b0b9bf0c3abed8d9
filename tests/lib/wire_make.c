/* wire_make.c: messages of the indenter's protocol for tests. */
#include "wire_make.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

uint64_t wire_random(uint64_t *state) { /* xorshift64* (Vigna 2016) */
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return *state * UINT64_C(2685821657736338717);
}

static uint32_t any_value(uint64_t *state) {
    uint64_t r = wire_random(state);
    uint32_t value = (uint32_t)(r >> 32);
    return r % 4 == 0 ? 0 : r % 4 == 1 ? value & 0xff : value;
}

#define FILL(type, name) m->name = (palp_wire_##type)any_value(state);
#define FILL_ARRAY(type, name, count)                                                                        \
    for (size_t i = 0; i < (count); i++) {                                                                   \
        m->name[i] = (palp_wire_##type)any_value(state);                                                     \
    }
#define FILL_CASE(NAME, number, member, list)                                                                \
    case number: {                                                                                           \
        palp_wire_##member *m = &message->as.member;                                                         \
        list(FILL, FILL_ARRAY) break;                                                                        \
    }

void wire_fill(palp_wire_message *message, uint8_t type, uint64_t *state) {
    memset(message, 0, sizeof *message);
    message->type = type;
    message->sequence = (uint16_t)any_value(state);
    message->lost = any_value(state);
    switch (type) { PALP_WIRE_MESSAGES(FILL_CASE) }
}

#define SAME(type, name) same = same && x->name == y->name;
#define SAME_ARRAY(type, name, count) same = same && memcmp(x->name, y->name, sizeof x->name) == 0;
#define SAME_CASE(NAME, number, member, list)                                                                \
    case number: {                                                                                           \
        const palp_wire_##member *x = &a->as.member, *y = &b->as.member;                                     \
        list(SAME, SAME_ARRAY) break;                                                                        \
    }

bool wire_same(const palp_wire_message *a, const palp_wire_message *b) {
    bool same = a->type == b->type && a->sequence == b->sequence && a->lost == b->lost;
    if (same) {
        switch (a->type) { PALP_WIRE_MESSAGES(SAME_CASE) }
    }
    return same;
}

/* ---- golden frames ---- */

/* The i-th number of "name=1,2,3" in text; stops the test where it is not there. */
static long long number_of(const char *text, const char *name, size_t i) {
    char key[40];
    snprintf(key, sizeof key, " %s=", name);
    const char *at = strstr(text, key);
    char *end = NULL;
    long long value = 0;
    for (at = at ? at + strlen(key) : NULL; at; at = *end == ',' ? end + 1 : NULL) {
        value = strtoll(at, &end, 10);
        if (end == at) {
            break;
        }
        if (i-- == 0) {
            return value;
        }
    }
    fprintf(stderr, "golden.txt: no number for %s in %.60s\n", name, text);
    exit(1);
}

#define READ(type, name) m->name = (palp_wire_##type)number_of(text, #name, 0);
#define READ_ARRAY(type, name, count)                                                                        \
    for (size_t i = 0; i < (count); i++) {                                                                   \
        m->name[i] = (palp_wire_##type)number_of(text, #name, i);                                            \
    }
#define READ_CASE(NAME, number, member, list)                                                                \
    if (strncmp(text, #NAME " ", strlen(#NAME) + 1) == 0) {                                                  \
        palp_wire_##member *m = &message->as.member;                                                         \
        message->type = number;                                                                              \
        list(READ, READ_ARRAY)                                                                               \
    }

static void read_message(const char *text, palp_wire_message *message) {
    memset(message, 0, sizeof *message);
    PALP_WIRE_MESSAGES(READ_CASE)
    message->sequence = (uint16_t)number_of(text, "header.sequence", 0);
    message->lost = (uint32_t)number_of(text, "header.lost", 0);
}

static size_t read_hex(const char *text, uint8_t byte[PALP_WIRE_FRAME_MAX]) {
    size_t n = 0;
    for (char *end; n < PALP_WIRE_FRAME_MAX; text = end) {
        unsigned long value = strtoul(text, &end, 16);
        if (end == text) {
            break;
        }
        byte[n++] = (uint8_t)value;
    }
    return n;
}

size_t wire_golden(wire_frame golden[WIRE_GOLDEN]) {
    static char line[8192];
    FILE *from = fopen("tests/data/wire/golden.txt", "r");
    size_t n = 0;
    if (!from) {
        fputs("no tests/data/wire/golden.txt: run from the root of the tree\n", stderr);
        return 0;
    }
    while (n < WIRE_GOLDEN && fgets(line, sizeof line, from)) {
        if (*line != '#') {
            read_message(line, &golden[n].message);
            golden[n].n = fgets(line, sizeof line, from) ? read_hex(line, golden[n].byte) : 0;
            n++;
        }
    }
    fclose(from);
    return n;
}
