/* json.h: strict reading of JSON files: unknown keys are errors, and errors give the line. */
#ifndef PALP_JSON_H
#define PALP_JSON_H

#include "file.h"

#include <jansson.h>

/* A parsed file; its text is kept to find line numbers. */
typedef struct palp_json_file {
    const char *path; /* caller's */
    char *text;
    json_t *root;
    palp_error *error; /* receives failures, may be NULL */
} palp_json_file;

/* A value and its position: member key of parent, or item index of it if key is NULL. */
typedef struct palp_json {
    const palp_json_file *file;
    const struct palp_json *parent; /* NULL: the root */
    const char *key;
    size_t index;
    json_t *value;
} palp_json;

palp_status palp_json_open(const char *path, palp_json_file *file, palp_json *root, palp_error *error);
void palp_json_close(palp_json_file *file);

/* "path:line: name text" with the line of at's key and its dotted name. Returns status. */
palp_status palp_json_fail(const palp_json *at, palp_status status, const char *format, ...)
    PALP_PRINTF(3, 4);

/* ERR_INPUT unless at is an object with keys from allowed[n] only. The error says so if a key differs from an
 * allowed one only in its unit. */
palp_status palp_json_keys(const palp_json *at, size_t n, const char *const *allowed);

bool palp_json_member(const palp_json *at, const char *key, palp_json *member); /* false: absent */
palp_status palp_json_require(const palp_json *at, const char *key,
                              palp_json *member); /* ERR_INPUT: absent */
palp_status palp_json_item(const palp_json *at, size_t index, palp_json *item);
palp_status palp_json_list(const palp_json *at, size_t most, size_t *n); /* length; ERR_LIMIT above most */

palp_status palp_json_number(const palp_json *at, double *value);
palp_status palp_json_positive(const palp_json *at, double *value); /* > 0 */
palp_status palp_json_not_negative(const palp_json *at, double *value);
palp_status palp_json_numbers(const palp_json *at, size_t most, size_t *n, double *values);
palp_status palp_json_bool(const palp_json *at, bool *value);
palp_status palp_json_string(const palp_json *at, const char **value); /* owned by the file */

/* The member of expected[n] that differs from key only in its unit (after the last '_'), or NULL. */
const char *palp_key_hint(const char *key, size_t n, const char *const *expected);

#endif
