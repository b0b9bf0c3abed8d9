/* test_wire.c: the indenter's protocol: golden frames, round trips, what the decoder refuses,
 * doc/protocol.md. */
#include "wire_make.h"

#include <check.h>
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static wire_frame golden[WIRE_GOLDEN];

static void read_golden(void) {
    ck_assert_uint_eq(wire_golden(golden), WIRE_GOLDEN);
}

/* Feeds bytes; how many messages came out, the last in *message. */
static unsigned feed(palp_wire_decoder *decoder, const uint8_t *byte, size_t n, palp_wire_message *message) {
    unsigned good = 0;
    for (size_t i = 0; i < n; i++)
        good += palp_wire_decode(decoder, byte[i], message);
    return good;
}

/* ---- check and layout ---- */

static uint16_t slow_crc(const uint8_t *byte, size_t n) {
    unsigned crc = 0xffff;
    for (size_t i = 0; i < 8 * n; i++) {
        unsigned bit = ((unsigned)byte[i / 8] >> (7 - i % 8) & 1) ^ crc >> 15;
        crc = (crc << 1 & 0xffff) ^ (bit ? 0x1021 : 0);
    }
    return (uint16_t)crc;
}

START_TEST(crc_is_the_division) {
    uint64_t state = 5;
    uint8_t byte[64];
    ck_assert_uint_eq(palp_wire_crc((const uint8_t *)"123456789", 9), 0x29b1);
    ck_assert_uint_eq(palp_wire_crc(NULL, 0), 0xffff);
    for (int k = 0; k < 2000; k++) {
        size_t n = wire_random(&state) % sizeof byte;
        for (size_t i = 0; i < n; i++)
            byte[i] = (uint8_t)wire_random(&state);
        ck_assert_uint_eq(palp_wire_crc(byte, n), slow_crc(byte, n));
    }
}
END_TEST

START_TEST(types_outside_the_list_have_no_size_and_no_frame) {
    size_t known = 0;
    for (unsigned type = 0; type < 256; type++) {
        palp_wire_message message = {.type = (uint8_t)type};
        uint8_t frame[PALP_WIRE_FRAME_MAX];
        size_t size = palp_wire_payload_size((uint8_t)type);
        known += size > 0;
        ck_assert_uint_eq(palp_wire_encode(&message, frame), size ? size + 5 : 0);
        ck_assert(size <= PALP_WIRE_PAYLOAD_MAX &&
                  (size == 0) == (strcmp(palp_wire_type_name((uint8_t)type), "?") == 0));
    }
    ck_assert_uint_eq(known, WIRE_GOLDEN);
    ck_assert_uint_eq(palp_wire_payload_size(PALP_WIRE_TYPE_HELLO), 9);
    ck_assert_uint_eq(palp_wire_payload_size(PALP_WIRE_TYPE_SAMPLES), 235);
}
END_TEST

START_TEST(names) {
    ck_assert_str_eq(palp_wire_type_name(PALP_WIRE_TYPE_FIND_CONTACT), "FIND_CONTACT");
    ck_assert_str_eq(palp_wire_state_name(PALP_WIRE_STATE_APPROACH), "approach");
    ck_assert_str_eq(palp_wire_fault_name(PALP_WIRE_FAULT_EMERGENCY_STOP), "emergency_stop");
    ck_assert_str_eq(palp_wire_fault_text(PALP_WIRE_FAULT_NONE), "no fault");
    ck_assert_str_eq(palp_wire_result_text(PALP_WIRE_RESULT_NOT_HOMED), "not homed yet");
    ck_assert_str_eq(palp_wire_state_name(PALP_WIRE_STATE_COUNT), "?");
    ck_assert_str_eq(palp_wire_fault_name(PALP_WIRE_FAULT_COUNT), "?");
    ck_assert_str_eq(palp_wire_fault_text(255), "?");
    ck_assert_str_eq(palp_wire_result_text(PALP_WIRE_RESULT_COUNT), "?");
}
END_TEST

/* ---- frames ---- */

START_TEST(golden_frames) {
    bool seen[256] = {false};
    for (size_t i = 0; i < WIRE_GOLDEN; i++) {
        const wire_frame *g = &golden[i];
        palp_wire_decoder decoder = {0};
        palp_wire_message message;
        uint8_t frame[PALP_WIRE_FRAME_MAX];
        ck_assert_uint_eq(palp_wire_encode(&g->message, frame), g->n);
        ck_assert_mem_eq(frame, g->byte, g->n);
        ck_assert_uint_eq(feed(&decoder, g->byte, g->n, &message), 1);
        ck_assert(wire_same(&message, &g->message));
        ck_assert(!seen[message.type]);
        seen[message.type] = true;
    }
}
END_TEST

START_TEST(random_messages_come_back) {
    uint64_t state = 11;
    palp_wire_decoder decoder = {0};
    unsigned sent = 0;
    for (unsigned type = 0; type < 256; type++) {
        for (int k = 0; palp_wire_payload_size((uint8_t)type) && k < 2000; k++) {
            palp_wire_message message, back;
            uint8_t frame[PALP_WIRE_FRAME_MAX];
            wire_fill(&message, (uint8_t)type, &state);
            size_t n = palp_wire_encode(&message, frame);
            ck_assert_ptr_null(memchr(frame, 0, n - 1));
            ck_assert_uint_eq(feed(&decoder, frame, n - 1, &back), 0);
            ck_assert(palp_wire_decode(&decoder, frame[n - 1], &back));
            ck_assert(wire_same(&message, &back));
            sent++;
        }
    }
    ck_assert_uint_eq(decoder.frames, sent);
    ck_assert_uint_eq(decoder.bad, 0);
}
END_TEST

/* ---- what is refused ---- */

/* Encoded bytes with the right check and a zero: only their structure can be wrong. */
static size_t close_frame(uint8_t *encoded, size_t n) {
    unsigned crc = palp_wire_crc(encoded, n);
    encoded[n] = (uint8_t)(0x80 | crc >> 10);
    encoded[n + 1] = (uint8_t)(0x80 | (crc >> 4 & 0x3f));
    encoded[n + 2] = (uint8_t)(0x80 | (crc & 0xf));
    encoded[n + 3] = 0;
    return n + 4;
}

static void refused(uint8_t *encoded, size_t n) {
    const palp_wire_message before = {.type = 77, .lost = 5};
    palp_wire_message message = before;
    palp_wire_decoder decoder = {0};
    ck_assert_uint_eq(feed(&decoder, encoded, close_frame(encoded, n), &message), 0);
    ck_assert_uint_eq(decoder.bad, 1);
    ck_assert(message.type == before.type && message.lost == before.lost);
    ck_assert_uint_eq(feed(&decoder, golden[0].byte, golden[0].n, &message), 1);
}

START_TEST(a_right_check_does_not_save_a_wrong_structure) {
    uint8_t alive[] = {9, 2, 3, 3, 3, 3, 3, 3, 3, 0, 0, 0, 0}, tried[300];
    palp_wire_decoder decoder = {0};
    palp_wire_message message;
    ck_assert_uint_eq(feed(&decoder, alive, close_frame(alive, 9), &message), 1); /* this is right */
    memcpy(tried, alive, 9);
    tried[0] = 8; /* a code that leads to one that leads beyond the end */
    refused(tried, 9);
    tried[0] = 10; /* beyond the end at once */
    refused(tried, 9);
    tried[0] = 255;
    refused(tried, 9);
    memcpy(tried, alive, 9);
    tried[1] = 99; /* a type that is not in the list */
    refused(tried, 9);
    tried[1] = 1; /* of another length */
    refused(tried, 9);
    memcpy(tried, alive, 9);
    tried[0] = 8; /* a byte short */
    refused(tried, 8);
    tried[0] = 1; /* nothing but a code */
    refused(tried, 1);
    memset(tried, 1, sizeof tried); /* longer than any frame */
    refused(tried, 280);
}
END_TEST

START_TEST(check_characters_are_all_checked) {
    const wire_frame *g = &golden[0];
    for (size_t i = g->n - 4; i < g->n - 1; i++) {
        for (unsigned value = 1; value < 256; value++) {
            palp_wire_decoder decoder = {0};
            palp_wire_message message;
            uint8_t frame[PALP_WIRE_FRAME_MAX];
            memcpy(frame, g->byte, g->n);
            frame[i] = (uint8_t)value;
            ck_assert_uint_eq(feed(&decoder, frame, g->n, &message), value == g->byte[i]);
        }
    }
}
END_TEST

START_TEST(empty_and_endless_frames) {
    palp_wire_decoder decoder = {0};
    palp_wire_message message;
    for (int i = 0; i < 5; i++)
        ck_assert(!palp_wire_decode(&decoder, 0, &message));
    ck_assert_uint_eq(decoder.bad, 0);
    for (int i = 0; i < 100000; i++)
        ck_assert(!palp_wire_decode(&decoder, 0xa5, &message));
    ck_assert_uint_eq(decoder.bad, 0); /* not over yet */
    ck_assert(!palp_wire_decode(&decoder, 0, &message));
    ck_assert_uint_eq(decoder.bad, 1);
    ck_assert_uint_eq(feed(&decoder, golden[3].byte, golden[3].n, &message), 1);
    ck_assert(wire_same(&message, &golden[3].message));
}
END_TEST

/* ---- doc/protocol.md ---- */

static const char *next_entry(FILE *page) { /* a numbered row of a table, or a message's heading */
    static char line[1000];
    while (fgets(line, sizeof line, page)) {
        bool heading = strncmp(line, "### ", 4) == 0 && strchr(line, ':');
        if (heading || (line[0] == '|' && isdigit((unsigned char)line[2])))
            return line;
    }
    return "(the end)";
}

static void says(FILE *page, const char *expected) {
    const char *entry = next_entry(page);
    ck_assert_msg(strncmp(entry, expected, strlen(expected)) == 0, "protocol.md has\n%s, the code %s", entry,
                  expected);
}

static void says_row(FILE *page, unsigned number, const char *name, const char *text) {
    char row[300];
    snprintf(row, sizeof row, "| %u | %s | %s", number, name, text);
    says(page, row);
}

static void says_field(FILE *page, size_t *at, const char *type, size_t count, const char *name) {
    char row[100], array[8] = "";
    if (count)
        snprintf(array, sizeof array, "[%u]", (unsigned)count);
    snprintf(row, sizeof row, "| %u | %s%s | %s | ", (unsigned)*at, type, array, name);
    says(page, row);
    *at += (size_t)atoi(type + 1) / 8 * (count ? count : 1);
}

START_TEST(page_has_the_numbers_of_the_code) {
    FILE *page = fopen("doc/protocol.md", "r");
    char title[100];
    unsigned i;
    ck_assert_ptr_nonnull(page);
    ck_assert_ptr_nonnull(fgets(title, sizeof title, page));
    ck_assert_int_eq(atoi(strstr(title, "version ") + 8), PALP_WIRE_VERSION);
#define STATE(NAME, id) says_row(page, i++, #NAME, "");
    i = 0;
    PALP_WIRE_STATES(STATE)
#define FAULT(NAME, id, text) says_row(page, i++, #NAME, text);
    i = 0;
    PALP_WIRE_FAULTS(FAULT)
#define RESULT(NAME, text) says_row(page, i++, #NAME, text);
    i = 0;
    PALP_WIRE_RESULTS(RESULT)
#define SEARCH(NAME) says_row(page, i++, #NAME, "");
    i = 0;
    PALP_WIRE_SEARCHES(SEARCH)
#define KIND(NAME) says_row(page, i++, #NAME, "");
    i = 0;
    PALP_WIRE_SEGMENT_KINDS(KIND)
#define FLAG(NAME) says_row(page, PALP_WIRE_FLAG_##NAME, #NAME, "");
    FLAG(RECORD)
    FLAG(TRAJECTORY)
    FLAG(MOTOR)
    FLAG(DERATED)
    FLAG(HOME_SWITCH)
    FLAG(SENSOR_BAD)
    FLAG(TICK_MISSED)
    FLAG(FAULT)
    FLAG(TRIGGER_IN)
    FLAG(TRIGGER_OUT)
#define FIELD(type, name) says_field(page, &at, #type, 0, #name);
#define ARRAY(type, name, count) says_field(page, &at, #type, count, #name);
#define MESSAGE(NAME, number, member, list)                                                                  \
    {                                                                                                        \
        char heading[80];                                                                                    \
        size_t at = 7, size = palp_wire_payload_size(number);                                                \
        snprintf(heading, sizeof heading, "### %s: %d, %u bytes\n", #NAME, number, (unsigned)size);          \
        says(page, heading);                                                                                 \
        list(FIELD, ARRAY) ck_assert_uint_eq(at, size);                                                      \
    }
    PALP_WIRE_MESSAGES(MESSAGE)
    ck_assert_str_eq(next_entry(page), "(the end)");
    fclose(page);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_checked_fixture(tc, read_golden, NULL);
    tcase_add_test(tc, crc_is_the_division);
    tcase_add_test(tc, types_outside_the_list_have_no_size_and_no_frame);
    tcase_add_test(tc, names);
    tcase_add_test(tc, golden_frames);
    tcase_add_test(tc, random_messages_come_back);
    tcase_add_test(tc, a_right_check_does_not_save_a_wrong_structure);
    tcase_add_test(tc, check_characters_are_all_checked);
    tcase_add_test(tc, empty_and_endless_frames);
    tcase_add_test(tc, page_has_the_numbers_of_the_code);
}
