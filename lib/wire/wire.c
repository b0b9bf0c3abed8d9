/* wire.c: frames of the indenter's protocol: bytes of the messages, COBS, check characters. Freestanding. */
#include <palpate/wire.h>

#include <string.h>

enum { HEADER = 7, CHECK = 3 };

/* ---- where the fields are, made of the list of messages ---- */

typedef struct field {
    uint8_t size, count; /* bytes of an element, elements */
    uint8_t offset;      /* in the message's structure */
} field;

typedef struct layout {
    uint8_t size; /* of the payload */
    uint8_t n;
    const field *fields;
} layout;

#define BYTES(type, name) +sizeof(palp_wire_##type)
#define ARRAY_BYTES(type, name, count) +(count) * sizeof(palp_wire_##type)
#define FIELD(type, name) {sizeof(palp_wire_##type), 1, offsetof(self, name)},
#define ARRAY(type, name, count) {sizeof(palp_wire_##type), count, offsetof(self, name)},
#define LAYOUT(NAME, number, member, list)                                                                   \
    case number: {                                                                                           \
        typedef palp_wire_##member self;                                                                     \
        enum {                                                                                               \
            FITS = 1 / (HEADER list(BYTES, ARRAY_BYTES) <= PALP_WIRE_PAYLOAD_MAX && sizeof(self) < 256)      \
        };                                                                                                   \
        static const field fields[] = {list(FIELD, ARRAY)};                                                  \
        static const layout it = {HEADER list(BYTES, ARRAY_BYTES), sizeof fields / sizeof fields[0],         \
                                  fields};                                                                   \
        return &it;                                                                                          \
    }

static const layout *find_message_layout(uint8_t type) {
    switch (type) {
        PALP_WIRE_MESSAGES(LAYOUT)
    default:
        return NULL;
    }
}

size_t palp_wire_payload_size(uint8_t type) {
    const layout *it = find_message_layout(type);
    return it ? it->size : 0;
}

/* ---- fields to bytes and back, little-endian whatever the processor is ---- */

static void write_little_uint16(uint8_t *to, uint16_t value) {
    to[0] = (uint8_t)value;
    to[1] = (uint8_t)(value >> 8);
}

static void write_little_uint32(uint8_t *to, uint32_t value) {
    write_little_uint16(to, (uint16_t)value);
    write_little_uint16(to + 2, (uint16_t)(value >> 16));
}

static uint16_t read_little_uint16(const uint8_t *from) {
    return (uint16_t)(from[0] | from[1] << 8);
}

static uint32_t read_little_uint32(const uint8_t *from) {
    return read_little_uint16(from) | (uint32_t)read_little_uint16(from + 2) << 16;
}

/* A loop for each size: the firmware does this within a control tick. Return where the bytes end. */
static uint8_t *encode_message_field(uint8_t *to, const void *from, const field *f) {
    const uint8_t *byte = from;
    const uint16_t *half = from;
    const uint32_t *word = from;
    for (unsigned i = 0; f->size == 1 && i < f->count; i++) {
        to[i] = byte[i];
    }
    for (unsigned i = 0; f->size == 2 && i < f->count; i++) {
        write_little_uint16(to + 2 * i, half[i]);
    }
    for (unsigned i = 0; f->size == 4 && i < f->count; i++) {
        write_little_uint32(to + 4 * i, word[i]);
    }
    return to + f->size * f->count;
}

static const uint8_t *decode_message_field(const uint8_t *from, void *to, const field *f) {
    uint8_t *byte = to;
    uint16_t *half = to;
    uint32_t *word = to;
    for (unsigned i = 0; f->size == 1 && i < f->count; i++) {
        byte[i] = from[i];
    }
    for (unsigned i = 0; f->size == 2 && i < f->count; i++) {
        half[i] = read_little_uint16(from + 2 * i);
    }
    for (unsigned i = 0; f->size == 4 && i < f->count; i++) {
        word[i] = read_little_uint32(from + 4 * i);
    }
    return from + f->size * f->count;
}

static void encode_message_payload(uint8_t *to, const palp_wire_message *message, const layout *it) {
    const uint8_t *from = (const uint8_t *)&message->as;
    to[0] = message->type;
    write_little_uint16(to + 1, message->sequence);
    write_little_uint32(to + 3, message->lost);
    to += HEADER;
    for (uint8_t i = 0; i < it->n; i++) {
        const field *f = &it->fields[i];
        to = encode_message_field(to, from + f->offset, f);
    }
}

static void decode_message_payload(const uint8_t *from, palp_wire_message *message, const layout *it) {
    uint8_t *to = (uint8_t *)&message->as;
    message->type = from[0];
    message->sequence = read_little_uint16(from + 1);
    message->lost = read_little_uint32(from + 3);
    from += HEADER;
    for (uint8_t i = 0; i < it->n; i++) {
        const field *f = &it->fields[i];
        from = decode_message_field(from, to + f->offset, f);
    }
}

/* ---- consistent overhead byte stuffing (Cheshire and Baker 1999), in place: byte[0] is the first code and
 * byte[1..n-1] the payload; of up to 253 bytes, so that no code is ever 255 ---- */

/* From the end: each zero becomes the distance to the next one, or to the end. */
/* From the end: each zero becomes the distance to the next one, or to the end. */
static void encode_cobs_in_place(uint8_t *byte, size_t n) {
    unsigned distance = 1;
    for (uint8_t *p = byte + n - 1; p > byte; p--) {
        if (*p == 0) {
            *p = (uint8_t)distance;
            distance = 0;
        }
        distance++;
    }
    *byte = (uint8_t)distance;
}

/* False unless the codes lead from one to the next and just to the end. No byte is zero. */
static bool decode_cobs_in_place(uint8_t *byte, size_t n) {
    size_t next = 0;
    while (next < n) {
        size_t code = byte[next];
        byte[next] = 0;
        next += code;
    }
    return next == n;
}

/* The remainders of 0..255, each the sum of those of its bits. */
#define R(i)                                                                                                 \
    (((i)&1 ? 0x1021 : 0) ^ ((i)&2 ? 0x2042 : 0) ^ ((i)&4 ? 0x4084 : 0) ^ ((i)&8 ? 0x8108 : 0) ^             \
     ((i)&16 ? 0x1231 : 0) ^ ((i)&32 ? 0x2462 : 0) ^ ((i)&64 ? 0x48c4 : 0) ^ ((i)&128 ? 0x9188 : 0))
#define R4(i) R(i), R((i) + 1), R((i) + 2), R((i) + 3)
#define R16(i) R4(i), R4((i) + 4), R4((i) + 8), R4((i) + 12)
#define R64(i) R16(i), R16((i) + 16), R16((i) + 32), R16((i) + 48)
static const uint16_t remainder_of[256] = {R64(0), R64(64), R64(128), R64(192)};

uint16_t palp_wire_crc(const uint8_t *byte, size_t n) {
    if (n > 0 && !byte) {
        return 0;
    }
    uint32_t crc = 0xffff; /* its lower 16 bits */
    for (size_t i = 0; i < n; i++) {
        crc = crc << 8 ^ remainder_of[(crc >> 8 ^ byte[i]) & 0xff];
    }
    return (uint16_t)crc;
}

static void append_check_characters(uint8_t to[CHECK], uint16_t crc) {
    to[0] = (uint8_t)(0x80 | crc >> 10);
    to[1] = (uint8_t)(0x80 | (crc >> 4 & 0x3f));
    to[2] = (uint8_t)(0x80 | (crc & 0xf));
}

size_t palp_wire_encode(const palp_wire_message *message, uint8_t *frame) {
    if (!message || !frame) {
        return 0;
    }
    const layout *it = find_message_layout(message->type);
    if (!it) {
        return 0;
    }
    size_t n = (size_t)it->size + 1;
    encode_message_payload(frame + 1, message, it);
    encode_cobs_in_place(frame, n);
    append_check_characters(frame + n, palp_wire_crc(frame, n));
    frame[n + CHECK] = 0;
    return n + CHECK + 1;
}

/* The n bytes before a zero; n > 0. */
static bool decode_one_frame(uint8_t *byte, size_t n, palp_wire_message *message) {
    uint8_t check[CHECK];
    if (n < 1 + HEADER + CHECK) {
        return false;
    }
    n -= CHECK;
    append_check_characters(check, palp_wire_crc(byte, n));
    if (memcmp(check, byte + n, CHECK) != 0 || !decode_cobs_in_place(byte, n)) {
        return false;
    }
    const layout *it = find_message_layout(byte[1]);
    if (!it || n != (size_t)it->size + 1) {
        return false;
    }
    decode_message_payload(byte + 1, message, it);
    return true;
}

/* A frame that is too long fills the buffer, which no frame does without its zero: its length refuses it. */
bool palp_wire_decode(palp_wire_decoder *decoder, uint8_t byte, palp_wire_message *message) {
    if (!decoder || !message) {
        return false;
    }
    size_t n = decoder->n;
    if (byte) {
        if (n < sizeof decoder->byte) {
            decoder->byte[decoder->n++] = byte;
        }
        return false;
    }
    bool good = n > 0 && decode_one_frame(decoder->byte, n, message);
    decoder->frames += good;
    decoder->bad += !good && n > 0;
    decoder->n = 0;
    return good;
}
