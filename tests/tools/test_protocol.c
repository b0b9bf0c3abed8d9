/* test_protocol.c: doc/protocol.md says in which states the firmware takes a command and watches for a fault.
 */
#include "app.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { ROW = 200 };

static void has_row(const char *row) {
    char line[1000];
    FILE *page = fopen("doc/protocol.md", "r");
    bool found = false;
    assert_non_null(page);
    while (!found && fgets(line, sizeof line, page))
        found = strcmp(line, row) == 0;
    fclose(page);
    if (!found)
        fail_msg("doc/protocol.md lacks\n%s", row);
}

static void add(char row[ROW], const char *text) {
    snprintf(row + strlen(row), ROW - strlen(row), "%s", text);
}

/* The result with which the firmware in this state answers a command without values. */
static uint8_t ask(uint8_t state, uint8_t type) {
    static app a;
    const app_identity who = {.board = "test"};
    palp_wire_message m = {.type = type, .sequence = 1};
    palp_wire_decoder decoder = {0};
    uint8_t frame[PALP_WIRE_FRAME_MAX], byte;
    app_init(&a, &machine_indenter, &who, 0, 0);
    a.supervisor.state = state;
    if (type == PALP_WIRE_TYPE_HELLO)
        m.as.hello.protocol = PALP_WIRE_VERSION;
    size_t n = palp_wire_encode(&m, frame);
    for (size_t i = 0; i < n; i++)
        app_receive(&a, frame[i]);
    while (ring_get(&a.stream.out, &byte))
        if (palp_wire_decode(&decoder, byte, &m) && m.type == PALP_WIRE_TYPE_ACK)
            return m.as.ack.result;
    fail_msg("no answer to %s", palp_wire_type_name(type));
    return 0;
}

static const char *word(uint8_t result) {
    return result == PALP_WIRE_RESULT_STATE       ? "STATE"
           : result == PALP_WIRE_RESULT_FAULTED   ? "FAULTED"
           : result == PALP_WIRE_RESULT_NOT_HOMED ? "NOT_HOMED"
                                                  : "yes";
}

static void test_commands(void **state) {
    (void)state;
    for (uint8_t type = 1; palp_wire_payload_size(type); type++) {
        char row[ROW] = "";
        add(row, "| ");
        add(row, palp_wire_type_name(type));
        for (uint8_t s = 0; s < PALP_WIRE_STATE_COUNT; s++) {
            add(row, " | ");
            add(row, word(ask(s, type)));
        }
        add(row, " |\n");
        has_row(row);
    }
}

static void test_faults(void **state) {
#define FAULT_NAME(NAME, id, text) #NAME,
    static const char *const name[] = {PALP_WIRE_FAULTS(FAULT_NAME)};
    (void)state;
    for (uint8_t fault = 1; fault < PALP_WIRE_FAULT_COUNT; fault++) {
        char row[ROW] = "";
        add(row, "| ");
        add(row, name[fault]);
        for (uint8_t s = 0; s < PALP_WIRE_STATE_COUNT; s++)
            add(row, supervisor_watches(s, fault) ? " | x" : " | ");
        add(row, " |\n");
        has_row(row);
    }
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_commands),
    cmocka_unit_test(test_faults),
    {0},
};
