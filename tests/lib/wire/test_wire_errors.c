/* test_wire_errors.c: what errors on the line do to frames of the indenter's protocol.  check: once */
#include "wire_make.h"

#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- every one and every two flipped bits ---- */

/* Frames around the one that is damaged, and the decoder just before the zero that ends the first. */
typedef struct stage {
    wire_frame before, after, last;
    palp_wire_decoder ready;
    uint8_t byte[3 * PALP_WIRE_FRAME_MAX]; /* that zero, the frame, and the two after it */
    size_t n, n_damaged;                   /* the zero and the frame: what the errors hit */
} stage;

static wire_frame make_frame(uint8_t type, uint64_t seed) {
    wire_frame f;
    wire_fill(&f.message, type, &seed);
    f.n = palp_wire_encode(&f.message, f.byte);
    return f;
}

static void append(stage *s, const wire_frame *f) {
    memcpy(s->byte + s->n, f->byte, f->n);
    s->n += f->n;
}

static stage set_stage(const wire_frame *damaged) {
    stage s = {.before = make_frame(PALP_WIRE_TYPE_ACK, 3), .n = 1};
    palp_wire_message none;
    s.after = make_frame(PALP_WIRE_TYPE_GET_STATUS, 4);
    s.last = make_frame(PALP_WIRE_TYPE_TARE, 5);
    for (size_t i = 0; i + 1 < s.before.n; i++)
        palp_wire_decode(&s.ready, s.before.byte[i], &none);
    append(&s, damaged);
    s.n_damaged = s.n;
    append(&s, &s.after);
    append(&s, &s.last);
    return s;
}

/* With these bits flipped: what was sent intact behind an intact zero arrives, and nothing else. */
static void play(const stage *s, size_t first_bit, size_t second_bit) {
    palp_wire_decoder decoder = s->ready;
    palp_wire_message got;
    bool before = false, after = false, last = false;
    uint8_t byte[sizeof s->byte];
    memcpy(byte, s->byte, s->n);
    byte[first_bit / 8] ^= (uint8_t)(1 << first_bit % 8);
    if (second_bit != first_bit)
        byte[second_bit / 8] ^= (uint8_t)(1 << second_bit % 8);
    for (size_t i = 0; i < s->n; i++) {
        if (!palp_wire_decode(&decoder, byte[i], &got))
            continue;
        if (!before && wire_same(&got, &s->before.message))
            before = true;
        else if (!after && wire_same(&got, &s->after.message))
            after = true;
        else if (!last && wire_same(&got, &s->last.message))
            last = true;
        else
            ck_abort_msg("bits %zu and %zu: an altered %s was delivered", first_bit, second_bit,
                         palp_wire_type_name(got.type));
    }
    if (!last || before != (byte[0] == 0) || after != (byte[s->n_damaged - 1] == 0))
        ck_abort_msg("bits %zu and %zu: an intact frame was not delivered", first_bit, second_bit);
}

START_TEST(no_frame_with_one_or_two_flipped_bits_is_delivered) {
    static wire_frame golden[WIRE_GOLDEN];
    unsigned long single = 0, pairs = 0;
    ck_assert_uint_eq(wire_golden(golden), WIRE_GOLDEN);
    for (size_t k = 0; k < WIRE_GOLDEN; k++) {
        stage s = set_stage(&golden[k]);
        for (size_t i = 0; i < 8 * s.n_damaged; i++) {
            play(&s, i, i);
            single++;
            for (size_t j = i + 1; j < 8 * s.n_damaged; j++, pairs++)
                play(&s, i, j);
        }
    }
    printf("%lu single-bit and %lu double-bit errors in %d golden frames: none delivered\n", single, pairs,
           WIRE_GOLDEN);
}
END_TEST

/* ---- random bytes ---- */

START_TEST(random_bytes_are_no_frames) {
    enum { BYTES = 5000000 };
    uint64_t state = 2008;
    palp_wire_decoder decoder = {0};
    palp_wire_message got;
    for (int i = 0; i < BYTES;
         i++) { /* first as they come, then with a zero every 16, so that short frames abound */
        uint64_t r = wire_random(&state) >> 32;
        uint8_t byte = (uint8_t)(i < BYTES / 2 || r >> 8 & 15 ? r : 0);
        if (palp_wire_decode(&decoder, byte, &got))
            ck_abort_msg("accepted by chance (2^-24 and less): a %s", palp_wire_type_name(got.type));
    }
    printf("%d random bytes: %lu frames refused, none accepted\n", BYTES, (unsigned long)decoder.bad);
    ck_assert_uint_gt(decoder.bad, BYTES / 64);
}
END_TEST

/* ---- mutated frames ---- */

enum { KINDS = 8, RECENT = 16 };

typedef struct line {
    palp_wire_decoder decoder;
    uint64_t state;
    palp_wire_message recent[RECENT]; /* as sent, the newest at sent % RECENT */
    size_t sent, bytes;
    bool closed; /* the last byte that went was a zero */
    unsigned delivered, intact, mutated, altered;
} line;

static bool was_sent(const line *l, const palp_wire_message *got) {
    for (size_t i = 0; i < RECENT && i < l->sent; i++)
        if (wire_same(got, &l->recent[i]))
            return true;
    return false;
}

/* True if the last of the bytes delivered a message. */
static bool transmit(line *l, const uint8_t *byte, size_t n) {
    palp_wire_message got;
    bool good = false;
    for (size_t i = 0; i < n; i++) {
        good = palp_wire_decode(&l->decoder, byte[i], &got);
        l->delivered += good;
        l->altered += good && !was_sent(l, &got);
        l->closed = byte[i] == 0;
    }
    l->bytes += n;
    return good;
}

static size_t below(line *l, size_t n) {
    return (size_t)(wire_random(&l->state) >> 32) % n;
}

/* Damages frame[0..n-1] (room for 2 n); its new length. */
static size_t mutate(line *l, uint8_t *frame, size_t n, size_t kind) {
    size_t at = below(l, n), run = 1 + below(l, n - at);
    switch (kind) {
    case 0: /* one to three bits */
        for (size_t k = 0, bits = 1 + below(l, 3); k < bits; k++)
            frame[below(l, n)] ^= (uint8_t)(1 << below(l, 8));
        return n;
    case 1: /* a burst of two bytes */
        frame[at] ^= (uint8_t)(1 + below(l, 255));
        if (at + 1 < n)
            frame[at + 1] ^= (uint8_t)below(l, 256);
        return n;
    case 2: /* bytes are random */
        for (size_t i = at; i < at + run; i++)
            frame[i] = (uint8_t)below(l, 256);
        return n;
    case 3: /* bytes get lost */
        memmove(frame + at, frame + at + run, n - at - run);
        return n - run;
    case 4: /* a byte comes in between */
        memmove(frame + at + 1, frame + at, n - at);
        frame[at] = (uint8_t)below(l, 256);
        return n + 1;
    case 5: /* a piece comes twice */
        memmove(frame + at + run, frame + at, n - at);
        return n + run;
    case 6: /* two bytes change places */
        if (at + 1 < n) {
            uint8_t kept = frame[at];
            frame[at] = frame[at + 1];
            frame[at + 1] = kept;
        }
        return n;
    default: /* the same bit is stuck */
        for (size_t i = at; i < at + run; i++)
            frame[i] |= 4;
        return n;
    }
}

/* Half the frames are damaged, in the given kind; what is intact behind a zero must arrive. */
static line run_line(size_t kind, size_t bytes) {
    line l = {.state = 77 + kind, .closed = true};
    while (l.bytes < bytes) {
        uint8_t type, frame[2 * PALP_WIRE_FRAME_MAX], whole[PALP_WIRE_FRAME_MAX];
        palp_wire_message *message = &l.recent[l.sent++ % RECENT];
        do {
            type = (uint8_t)below(&l, 256);
        } while (!palp_wire_payload_size(type));
        wire_fill(message, type, &l.state);
        size_t n = palp_wire_encode(message, whole), size = n;
        memcpy(frame, whole, n);
        if (below(&l, 2))
            size = mutate(&l, frame, n, kind);
        bool intact = size == n && memcmp(frame, whole, n) == 0, ready = l.closed;
        bool good = transmit(&l, frame, size);
        if (intact && ready && !good)
            ck_abort_msg("an intact %s was not delivered", palp_wire_type_name(type));
        l.intact += intact && ready;
        l.mutated += !intact;
    }
    ck_assert_uint_ge(l.delivered, l.intact);
    return l;
}

START_TEST(mutated_frames_are_refused) {
    static const char *const name[KINDS] = {"up to 3 bits",  "two bytes",      "random bytes",
                                            "lost bytes",    "inserted bytes", "repeated bytes",
                                            "swapped bytes", "a stuck bit"};
    unsigned mutated = 0, altered = 0;
    for (size_t kind = 0; kind < KINDS; kind++) {
        line l = run_line(kind, 5000000 / KINDS);
        printf("%-15s %6u frames damaged, %6u intact delivered, %u altered accepted\n", name[kind], l.mutated,
               l.intact, l.altered);
        if (kind < 2) /* the guarantee of the check, but for the errors that move a frame's border */
            ck_assert_uint_eq(l.altered, 0);
        mutated += l.mutated;
        altered += l.altered;
    }
    /* Beyond that 2^-16 pass by chance: no more than that and its scatter. */
    double chance = mutated / 65536.0;
    ck_assert_msg(altered <= chance + 4 * sqrt(chance), "%u of %u passed", altered, mutated);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, no_frame_with_one_or_two_flipped_bits_is_delivered);
    tcase_add_test(tc, random_bytes_are_no_frames);
    tcase_add_test(tc, mutated_frames_are_refused);
}
