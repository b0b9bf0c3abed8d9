/* batch_line.c: the line of a value in a JSON text; jansson has read it and finds where each value ends. */
#include "batch.h"

#include <string.h>

static const char *skip_blanks(const char *at) {
    return at + strspn(at, " \t\r\n");
}

/* The end of the value at a place; *value, if wanted, is the caller's. */
static const char *end_of(const char *at, json_t **value) {
    json_error_t place;
    json_t *read = json_loads(at, JSON_DECODE_ANY | JSON_DISABLE_EOF_CHECK, &place);
    const char *end = read ? at + place.position : at + strlen(at);
    if (value)
        *value = read;
    else
        json_decref(read);
    return end;
}

/* From the end of an entry to the start of the next. */
static const char *next_entry(const char *end) {
    const char *at = skip_blanks(end);
    return *at == ',' ? skip_blanks(at + 1) : at;
}

static const char *find_member(const char *object, const char *key) {
    const char *at = skip_blanks(object + 1);
    while (*at == '"') {
        json_t *found = NULL;
        const char *value = skip_blanks(end_of(at, &found));
        value = *value == ':' ? skip_blanks(value + 1) : value;
        bool same = json_is_string(found) && strcmp(json_string_value(found), key) == 0;
        json_decref(found);
        if (same)
            return value;
        at = next_entry(end_of(value, NULL));
    }
    return object;
}

static const char *find_item(const char *list, size_t index) {
    const char *at = skip_blanks(list + 1);
    for (; index > 0 && *at && *at != ']'; index--)
        at = next_entry(end_of(at, NULL));
    return *at ? at : list;
}

size_t batch_line_of(const char *text, const char *key, size_t index) {
    const char *root = skip_blanks(text), *at = *root == '{' ? find_member(root, key) : root;
    size_t line = 1;
    if (*at == '[' && index != SIZE_MAX)
        at = find_item(at, index);
    for (const char *c = text; c < at; c++)
        line += *c == '\n';
    return line;
}
