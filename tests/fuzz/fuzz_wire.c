/* fuzz_wire.c: libFuzzer's harness for the frames of the indenter's protocol; run.sh builds and runs it. */
#include "../lib/wire_make.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A frame is accepted only if its message is encoded to these very bytes. */
static void decode(palp_wire_decoder *decoder, const uint8_t *frame, size_t n) {
    uint8_t again[PALP_WIRE_FRAME_MAX];
    palp_wire_message got;
    for (size_t i = 0; i < n; i++) {
        if (palp_wire_decode(decoder, frame[i], &got) &&
            (i + 1 != n || palp_wire_encode(&got, again) != n || memcmp(again, frame, n) != 0)) {
            abort();
        }
    }
}

/* The bytes as they are, frame by frame. */
static void as_received(const uint8_t *data, size_t size) {
    palp_wire_decoder decoder = {0};
    for (size_t from = 0, to = 0; to < size; to++) {
        if (data[to] == 0) {
            decode(&decoder, data + from, to + 1 - from);
            from = to + 1;
        }
    }
}

/* The bytes up to a zero with the right check: what lies behind it is reached. */
static void as_checked(const uint8_t *data, size_t size) {
    static const uint8_t high = 0x80;
    palp_wire_decoder decoder = {0};
    uint8_t frame[400] = {0};
    const uint8_t *zero = memchr(data, 0, size);
    size_t n = zero ? (size_t)(zero - data) : size;
    n = n < sizeof frame - 4 ? n : sizeof frame - 4;
    memcpy(frame, data, n);
    unsigned crc = palp_wire_crc(frame, n);
    frame[n] = (uint8_t)(high | crc >> 10);
    frame[n + 1] = (uint8_t)(high | (crc >> 4 & 0x3f));
    frame[n + 2] = (uint8_t)(high | (crc & 0xf));
    decode(&decoder, frame, n + 4);
}

/* The bytes as a message, which must come back. */
static void as_message(const uint8_t *data, size_t size) {
    palp_wire_decoder decoder = {0};
    palp_wire_message message = {0}, back = {0};
    uint8_t frame[PALP_WIRE_FRAME_MAX];
    bool good = false;
    memcpy(&message, data, size < sizeof message ? size : sizeof message);
    size_t n = palp_wire_encode(&message, frame);
    for (size_t i = 0; i < n; i++) {
        good = palp_wire_decode(&decoder, frame[i], &back);
    }
    if (n > 0 && !(good && wire_same(&message, &back))) {
        abort();
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    if (size > 0) {
        as_received(data, size);
        as_checked(data, size);
        as_message(data, size);
    }
    return 0;
}
