/* acquire_json.c: JSON files with the line in every error, and the sensor's calibration. */
#include "acquire.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "acquire";

int acquire_json_open(const char *file, const char *what, acquire_json *j) {
    json_error_t where;
    palp_error error;
    size_t size;
    *j = (acquire_json){file, NULL, NULL};
    palp_status status = palp_file_read(file, &j->text, &size, &error);
    if (status)
        return cli_status(NAME, status, &error);
    j->root = json_loads(j->text, JSON_REJECT_DUPLICATES, &where);
    int code = CLI_OK;
    if (!j->root)
        code =
            cli_failure(NAME, "%s:%d: malformed JSON: %s", file, where.line > 0 ? where.line : 1, where.text);
    else if (json_integer_value(json_object_get(json_object_get(j->root, "palpate"), what)) != 1)
        code = cli_failure(NAME, "%s:1: lacks \"palpate\": {\"%s\": 1}", file, what);
    if (code)
        acquire_json_close(j);
    return code;
}

void acquire_json_close(acquire_json *j) {
    json_decref(j->root);
    free(j->text);
    *j = (acquire_json){NULL, NULL, NULL};
}

/* ---- line of a value, in text that was parsed without error ---- */

static const char *skip(const char *p, const char *what) {
    return p + strspn(p, what);
}

static const char *value_end(const char *p) {
    json_error_t where;
    json_t *value = json_loads(p, JSON_DECODE_ANY | JSON_DISABLE_EOF_CHECK, &where);
    json_decref(value);
    return value ? p + where.position : p + strlen(p);
}

/* Finds the key or item within the value at p; p itself if there is none. */
static const char *member(const char *p, const char *key, size_t length) {
    if (*p != '{')
        return p;
    for (const char *at = skip(p + 1, " \t\r\n"); *at == '"';) {
        const char *end = value_end(at);
        if ((size_t)(end - at) == length + 2 && memcmp(at + 1, key, length) == 0)
            return at;
        at = skip(value_end(skip(end, " \t\r\n:")), " \t\r\n,");
    }
    return p;
}

static const char *item(const char *p, unsigned long index) {
    if (*p != '[')
        return p;
    const char *at = skip(p + 1, " \t\r\n");
    for (; index > 0 && *at && *at != ']'; index--)
        at = skip(value_end(at), " \t\r\n,");
    return at;
}

/* where: a path such as runs[2].depth_mm; keys may contain any character. */
static int line_of(const char *text, const char *where) {
    const char *p = skip(text, " \t\r\n"), *at = p;
    for (char *rest; *where; where += *where == '.') {
        p = *at == '"' ? skip(value_end(at), " \t\r\n:") : at; /* from the key to its value */
        if (*where == '[') {
            at = item(p, strtoul(where + 1, &rest, 10));
            where = rest + (*rest == ']');
        } else {
            size_t length = strcspn(where, ".[");
            at = member(p, where, length);
            where += length;
        }
    }
    int line = 1;
    for (p = text; p < at; p++)
        line += *p == '\n';
    return line;
}

int acquire_json_fail(const acquire_json *j, const char *where, const char *format, ...) {
    char text[ACQUIRE_TEXT];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return cli_failure(NAME, "%s:%d: %s%s%s", j->file, line_of(j->text, where), where, *where ? " " : "",
                       text);
}

/* ---- calibration: {"palpate": {"calibration": 1}, "Fz_N": [N a count of each channel], ...} ---- */

static const char *const axes[PALP_WIRE_CHANNELS] = {"Fx_N", "Fy_N", "Fz_N", "Tx_Nm", "Ty_Nm", "Tz_Nm"};

static int read_row(const acquire_json *j, const char *axis, const json_t *list,
                    int32_t row[PALP_WIRE_CHANNELS]) {
    bool zero = true;
    if (json_array_size(list) != PALP_WIRE_CHANNELS)
        return acquire_json_fail(j, axis, "must be a list of %d numbers", PALP_WIRE_CHANNELS);
    for (size_t i = 0; i < PALP_WIRE_CHANNELS; i++) {
        double nano = rint(1e9 * json_number_value(json_array_get(list, i)));
        if (!json_is_number(json_array_get(list, i)) || fabs(nano) > INT32_MAX)
            return acquire_json_fail(j, axis,
                                     "must be numbers from -2 to 2, in N or N m per count of each channel");
        row[i] = (int32_t)nano;
        zero = zero && row[i] == 0;
    }
    return zero ? acquire_json_fail(j, axis, "is zero in every channel") : CLI_OK;
}

int acquire_calibration_read(const char *file, int32_t row[PALP_WIRE_CHANNELS][PALP_WIRE_CHANNELS],
                             bool given[PALP_WIRE_CHANNELS]) {
    acquire_json j;
    const char *key;
    json_t *value;
    int code = acquire_json_open(file, "calibration", &j);
    if (code)
        return code;
    json_object_foreach(j.root, key, value) {
        size_t axis = 0;
        while (axis < PALP_WIRE_CHANNELS && strcmp(axes[axis], key) != 0)
            axis++;
        if (axis < PALP_WIRE_CHANNELS) {
            code = read_row(&j, key, value, row[axis]);
            given[axis] = true;
        } else if (strcmp(key, "palpate") != 0 && strcmp(key, "about") != 0) {
            code = acquire_json_fail(
                &j, key, "is not a known key, which are Fx_N, Fy_N, Fz_N, Tx_Nm, Ty_Nm and Tz_Nm");
        }
        if (code)
            break;
    }
    acquire_json_close(&j);
    return code;
}
