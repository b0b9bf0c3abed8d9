/* wire_names.c: names of the protocol's messages, states, faults and results. The firmware leaves it out. */
#include <palpate/wire.h>

/* A name that the list has for this number. */
#define PICK(number, table) ((number) < sizeof(table) / sizeof(table)[0] ? (table)[number] : "?")

const char *palp_wire_type_name(uint8_t type) {
    switch (type) {
#define CASE(NAME, number, member, fields)                                                                   \
    case number:                                                                                             \
        return #NAME;
        PALP_WIRE_MESSAGES(CASE)
    default:
        return "?";
    }
}

const char *palp_wire_state_name(uint8_t state) {
#define NAME(name, id) #id,
    static const char *const names[] = {PALP_WIRE_STATES(NAME)};
#undef NAME
    return PICK(state, names);
}

const char *palp_wire_fault_name(uint8_t fault) {
#define NAME(name, id, text) #id,
    static const char *const names[] = {PALP_WIRE_FAULTS(NAME)};
#undef NAME
    return PICK(fault, names);
}

const char *palp_wire_fault_text(uint8_t fault) {
#define NAME(name, id, text) text,
    static const char *const texts[] = {PALP_WIRE_FAULTS(NAME)};
#undef NAME
    return PICK(fault, texts);
}

const char *palp_wire_result_text(uint8_t result) {
#define NAME(name, text) text,
    static const char *const texts[] = {PALP_WIRE_RESULTS(NAME)};
#undef NAME
    return PICK(result, texts);
}
