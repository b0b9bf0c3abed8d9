/* json.c: strict reading of JSON files: unknown keys are errors, and errors give the line. */
#include "json.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static palp_status report_syntax_error(const palp_json_file *file, const json_error_t *json) {
    bool memory = json_error_code(json) == json_error_out_of_memory || !json->text[0];
    if (memory)
        return palp_error_set(file->error, PALP_ERR_NO_MEMORY, "%s: out of memory", file->path);
    size_t line = json->line > 0 ? (size_t)json->line : 1;
    return palp_error_set_line(file->error, PALP_ERR_INPUT, file->path, line, "malformed JSON: %s",
                               json->text);
}

palp_status palp_json_open(const char *path, palp_json_file *file, palp_json *root, palp_error *error) {
    size_t size;
    json_error_t json;
    memset(file, 0, sizeof *file);
    file->path = path;
    file->error = error;
    palp_status status = palp_file_read(path, &file->text, &size, error);
    if (status)
        return status;
    file->root = json_loadb(file->text, size, JSON_REJECT_DUPLICATES, &json);
    if (!file->root) {
        status = report_syntax_error(file, &json);
        palp_json_close(file);
        return status;
    }
    *root = (palp_json){file, NULL, NULL, 0, file->root};
    return PALP_OK;
}

void palp_json_close(palp_json_file *file) {
    json_decref(file->root);
    free(file->text);
    file->root = NULL;
    file->text = NULL;
}

/* Jansson has parsed this text, so the walk needs no error checks; it still stops at the NUL. */

static const char *skip_white_space(const char *p) {
    return p + strspn(p, " \t\r\n");
}

static const char *find_string_end(const char *p) {
    for (p++; *p && *p != '"'; p++)
        if (*p == '\\' && p[1])
            p++;
    return *p ? p + 1 : p;
}

static const char *find_value_end(const char *p) {
    int depth = 0;
    do {
        if (*p == '"')
            p = find_string_end(p);
        else if (*p == '{' || *p == '[') {
            depth++;
            p++;
        } else if (*p == '}' || *p == ']') {
            depth--;
            p++;
        } else
            p += depth > 0 ? 1 : strcspn(p, ",]} \t\r\n");
    } while (depth > 0 && *p);
    return p;
}

/* From the end of a member or item to the start of the next; NULL after the last. */
static const char *find_next_entry(const char *p) {
    p = skip_white_space(find_value_end(p));
    return *p == ',' ? skip_white_space(p + 1) : NULL;
}

/* Where the value of the key that starts at p starts. */
static const char *find_value_of_key(const char *p) {
    p = skip_white_space(find_string_end(p));
    return skip_white_space(*p == ':' ? p + 1 : p);
}

static const char *find_member_start(const char *object, const char *key) {
    size_t length = strlen(key);
    const char *p = skip_white_space(object + 1);
    while (p && *p == '"') {
        if ((size_t)(find_string_end(p) - p) == length + 2 && memcmp(p + 1, key, length) == 0)
            return p;
        p = find_next_entry(find_value_of_key(p));
    }
    return object; /* a key with escapes: the nearest known place */
}

static const char *find_item_start(const char *array, size_t index) {
    const char *p = skip_white_space(array + 1);
    for (; p && index > 0; index--)
        p = find_next_entry(p);
    return p ? p : array;
}

static const char *find_value_start(const palp_json *at) {
    if (!at->parent)
        return skip_white_space(at->file->text);
    const char *parent = find_value_start(at->parent);
    if (!at->key)
        return find_item_start(parent, at->index);
    const char *p = find_member_start(parent, at->key);
    return p == parent ? p : find_value_of_key(p);
}

static size_t find_line_of_value(const palp_json *at) {
    const char *p = at->parent && at->key ? find_member_start(find_value_start(at->parent), at->key)
                                          : find_value_start(at);
    size_t line = 1;
    for (const char *c = at->file->text; c < p; c++)
        line += *c == '\n';
    return line;
}

/* Appends the dotted name, "arms[1].viscosity_Ns", and returns the length with it. */
static size_t append_dotted_name(const palp_json *at, char *name, size_t size, size_t n) {
    if (!at->parent)
        return n;
    n = append_dotted_name(at->parent, name, size, n);
    int added = at->key ? snprintf(name + n, size - n, "%s%s", n ? "." : "", at->key)
                        : snprintf(name + n, size - n, "[%zu]", at->index);
    n += added > 0 ? (size_t)added : 0;
    return n < size ? n : size - 1;
}

palp_status palp_json_fail(const palp_json *at, palp_status status, const char *format, ...) {
    char name[128] = "", text[PALP_ERROR_TEXT];
    if (!at->file->error)
        return status;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    size_t n = append_dotted_name(at, name, sizeof name, 0);
    return palp_error_set_line(at->file->error, status, at->file->path, find_line_of_value(at), "%s%s%s",
                               name, n ? " " : "", text);
}

static size_t length_without_unit(const char *key) {
    const char *unit = strrchr(key, '_');
    return unit ? (size_t)(unit - key) : strlen(key);
}

const char *palp_key_hint(const char *key, size_t n, const char *const *expected) {
    for (size_t i = 0; i < n; i++) {
        size_t stem = length_without_unit(expected[i]);
        if (expected[i][stem] != '_' || strncmp(key, expected[i], stem) != 0)
            continue;
        if (key[stem] == '\0' || (key[stem] == '_' && length_without_unit(key) == stem))
            return expected[i];
    }
    return NULL;
}

static palp_status report_unknown_key(const palp_json *at, const char *key, size_t n,
                                      const char *const *allowed) {
    char list[256] = "";
    const char *hint = palp_key_hint(key, n, allowed);
    palp_json unknown = {at->file, at, key, 0, NULL};
    if (hint)
        return palp_json_fail(&unknown, PALP_ERR_INPUT, "is not a known key: \"%s\" is expected", hint);
    for (size_t i = 0, length = 0; i < n && length < sizeof list; i++) {
        int added = snprintf(list + length, sizeof list - length, "%s%s", i ? ", " : "", allowed[i]);
        length += added > 0 ? (size_t)added : 0;
    }
    return palp_json_fail(&unknown, PALP_ERR_INPUT, "is not a known key, which are %s", list);
}

static bool is_key_in_list(const char *key, size_t n, const char *const *allowed) {
    for (size_t i = 0; i < n; i++)
        if (strcmp(key, allowed[i]) == 0)
            return true;
    return false;
}

palp_status palp_json_keys(const palp_json *at, size_t n, const char *const *allowed) {
    const char *key;
    json_t *value;
    if (!json_is_object(at->value))
        return palp_json_fail(at, PALP_ERR_INPUT, "must be an object {...}");
    json_object_foreach(at->value, key,
                        value) if (!is_key_in_list(key, n, allowed)) return report_unknown_key(at, key, n,
                                                                                               allowed);
    return PALP_OK;
}

bool palp_json_member(const palp_json *at, const char *key, palp_json *member) {
    *member = (palp_json){at->file, at, key, 0, json_object_get(at->value, key)};
    return member->value != NULL;
}

palp_status palp_json_require(const palp_json *at, const char *key, palp_json *member) {
    if (palp_json_member(at, key, member))
        return PALP_OK;
    return palp_json_fail(at, PALP_ERR_INPUT, "%s\"%s\"", at->parent ? "lacks " : "missing key ", key);
}

palp_status palp_json_item(const palp_json *at, size_t index, palp_json *item) {
    *item = (palp_json){at->file, at, NULL, index, json_array_get(at->value, index)};
    return item->value ? PALP_OK : palp_json_fail(at, PALP_ERR_INPUT, "has no item %zu", index);
}

palp_status palp_json_list(const palp_json *at, size_t most, size_t *n) {
    if (!json_is_array(at->value))
        return palp_json_fail(at, PALP_ERR_INPUT, "must be a list [...]");
    *n = json_array_size(at->value);
    if (*n > most)
        return palp_json_fail(at, PALP_ERR_LIMIT, "has %zu items, at most %zu can be held", *n, most);
    return PALP_OK;
}

palp_status palp_json_number(const palp_json *at, double *value) {
    if (!json_is_number(at->value))
        return palp_json_fail(at, PALP_ERR_INPUT, "must be a number");
    *value = json_number_value(at->value);
    return PALP_OK;
}

palp_status palp_json_positive(const palp_json *at, double *value) {
    palp_status status = palp_json_number(at, value);
    if (!status && !(*value > 0))
        status = palp_json_fail(at, PALP_ERR_INPUT, "must be greater than 0, not %g", *value);
    return status;
}

palp_status palp_json_not_negative(const palp_json *at, double *value) {
    palp_status status = palp_json_number(at, value);
    if (!status && *value < 0)
        status = palp_json_fail(at, PALP_ERR_INPUT, "must not be negative");
    return status;
}

palp_status palp_json_numbers(const palp_json *at, size_t most, size_t *n, double *values) {
    palp_status status = palp_json_list(at, most, n);
    for (size_t i = 0; !status && i < *n; i++) {
        palp_json item;
        status = palp_json_item(at, i, &item);
        if (!status)
            status = palp_json_number(&item, &values[i]);
    }
    return status;
}

palp_status palp_json_bool(const palp_json *at, bool *value) {
    if (!json_is_boolean(at->value))
        return palp_json_fail(at, PALP_ERR_INPUT, "must be true or false");
    *value = json_is_true(at->value);
    return PALP_OK;
}

palp_status palp_json_string(const palp_json *at, const char **value) {
    if (!json_is_string(at->value))
        return palp_json_fail(at, PALP_ERR_INPUT, "must be a text in quotes");
    *value = json_string_value(at->value);
    return PALP_OK;
}
