/* experiment.c: an experiment in memory: header values and columns of numbers. */
#include "experiment_internal.h"
#include "base/json.h"
#include "base/text.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

palp_status palp_experiment_empty(palp_experiment **experiment) {
    *experiment = NULL;
    palp_experiment *e = calloc(1, sizeof *e);
    if (e)
        e->header = json_object();
    if (!e || !e->header) {
        free(e);
        return PALP_ERR_NO_MEMORY;
    }
    *experiment = e;
    return PALP_OK;
}

palp_status palp_experiment_create(size_t rows, palp_experiment **experiment) {
    if (!experiment)
        return PALP_ERR_ARGUMENT;
    static const char *const names[] = {"time_s", "depth_mm", "force_N"};
    palp_status status = palp_experiment_empty(experiment);
    if (status)
        return status;
    palp_experiment *e = *experiment;
    e->rows = e->capacity = rows;
    if (json_object_set_new(e->header, "palpate.experiment", json_integer(1)))
        status = PALP_ERR_NO_MEMORY;
    for (size_t i = 0; !status && i < 3; i++)
        status = palp_experiment_add_column(e, names[i]);
    if (status) {
        palp_experiment_free(e);
        *experiment = NULL;
    }
    return status;
}

void palp_experiment_free(palp_experiment *experiment) {
    if (!experiment)
        return;
    json_decref(experiment->header);
    for (size_t i = 0; i < experiment->n_columns; i++) {
        free(experiment->columns[i].name);
        free(experiment->columns[i].values);
    }
    free(experiment->columns);
    free(experiment);
}

bool palp_experiment_key_valid(const char *key, size_t length) {
    static const char allowed[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
    for (size_t i = 0; i < length; i++)
        if (!memchr(allowed, key[i], sizeof allowed - 1))
            return false;
    return length > 0 && length <= PALP_KEY_MAX;
}

bool palp_experiment_name_valid(const char *name, size_t length) {
    for (size_t i = 0; i < length; i++)
        if ((unsigned char)name[i] < ' ' || name[i] == ',' || name[i] == '#')
            return false;
    if (length == 0 || name[0] == ' ' || name[length - 1] == ' ')
        return false;
    return !strchr("0123456789+-.", name[0]); /* a number: the row of names is missing */
}

size_t palp_experiment_find(const palp_experiment *experiment, const char *name, size_t length) {
    size_t i = 0;
    for (; i < experiment->n_columns; i++) {
        const char *other = experiment->columns[i].name;
        if (strlen(other) == length && memcmp(other, name, length) == 0)
            break;
    }
    return i;
}

palp_status palp_experiment_append_column(palp_experiment *e, const char *name, size_t length) {
    palp_column *columns = realloc(e->columns, (e->n_columns + 1) * sizeof *columns);
    if (!columns)
        return PALP_ERR_NO_MEMORY;
    e->columns = columns;
    palp_column column = {malloc(length + 1), calloc(e->capacity ? e->capacity : 1, sizeof(double))};
    if (!column.name || !column.values) {
        free(column.name);
        free(column.values);
        return PALP_ERR_NO_MEMORY;
    }
    memcpy(column.name, name, length);
    column.name[length] = '\0';
    e->columns[e->n_columns++] = column;
    return PALP_OK;
}

palp_status palp_experiment_grow(palp_experiment *e) {
    size_t capacity = e->capacity < 512 ? 1024 : e->capacity;
    if (capacity > SIZE_MAX / (2 * sizeof(double)))
        return PALP_ERR_NO_MEMORY;
    capacity *= 2;
    for (size_t i = 0; i < e->n_columns; i++) {
        double *values = realloc(e->columns[i].values, capacity * sizeof *values);
        if (!values)
            return PALP_ERR_NO_MEMORY;
        e->columns[i].values = values;
    }
    e->capacity = capacity;
    return PALP_OK;
}

size_t palp_experiment_rows(const palp_experiment *experiment) {
    return experiment ? experiment->rows : 0;
}

double *palp_experiment_column(const palp_experiment *experiment, const char *name) {
    if (!experiment || !name)
        return NULL;
    size_t i = palp_experiment_find(experiment, name, strlen(name));
    return i < experiment->n_columns ? experiment->columns[i].values : NULL;
}

size_t palp_experiment_column_count(const palp_experiment *experiment) {
    return experiment ? experiment->n_columns : 0;
}

const char *palp_experiment_column_name(const palp_experiment *experiment, size_t i) {
    if (!experiment)
        return NULL;
    return i < experiment->n_columns ? experiment->columns[i].name : NULL;
}

palp_status palp_experiment_add_column(palp_experiment *experiment, const char *name) {
    if (!experiment || !name)
        return PALP_ERR_ARGUMENT;
    size_t length = strlen(name);
    if (!palp_experiment_name_valid(name, length) ||
        palp_experiment_find(experiment, name, length) < experiment->n_columns)
        return PALP_ERR_ARGUMENT;
    return palp_experiment_append_column(experiment, name, length);
}

palp_status palp_experiment_get_number(const palp_experiment *experiment, const char *key, double *value) {
    if (!experiment || !key || !value)
        return PALP_ERR_ARGUMENT;
    const json_t *found = json_object_get(experiment->header, key);
    if (!json_is_number(found))
        return PALP_ERR_INPUT;
    *value = json_number_value(found);
    return PALP_OK;
}

palp_status palp_experiment_get_string(const palp_experiment *experiment, const char *key,
                                       const char **value) {
    if (!experiment || !key || !value)
        return PALP_ERR_ARGUMENT;
    const json_t *found = json_object_get(experiment->header, key);
    if (!json_is_string(found))
        return PALP_ERR_INPUT;
    *value = json_string_value(found);
    return PALP_OK;
}

palp_status palp_experiment_set_number(palp_experiment *experiment, const char *key, double value) {
    if (!experiment || !key)
        return PALP_ERR_ARGUMENT;
    if (!isfinite(value) || !palp_experiment_key_valid(key, strlen(key)))
        return PALP_ERR_ARGUMENT;
    return json_object_set_new(experiment->header, key, json_real(value)) ? PALP_ERR_NO_MEMORY : PALP_OK;
}

palp_status palp_experiment_set_string(palp_experiment *experiment, const char *key, const char *value) {
    if (!experiment || !key || !value)
        return PALP_ERR_ARGUMENT;
    if (!palp_experiment_key_valid(key, strlen(key)) || !palp_text_is_utf8(value))
        return PALP_ERR_ARGUMENT;
    return json_object_set_new(experiment->header, key, json_string(value)) ? PALP_ERR_NO_MEMORY : PALP_OK;
}

palp_status palp_experiment_set_json(palp_experiment *experiment, const char *key, const char *text) {
    if (!experiment || !key || !text)
        return PALP_ERR_ARGUMENT;
    if (!palp_experiment_key_valid(key, strlen(key)))
        return PALP_ERR_ARGUMENT;
    json_error_t error;
    json_t *value = json_loads(text, JSON_DECODE_ANY | JSON_REJECT_DUPLICATES, &error);
    if (!value)
        return json_error_code(&error) == json_error_out_of_memory ? PALP_ERR_NO_MEMORY : PALP_ERR_INPUT;
    return json_object_set_new(experiment->header, key, value) ? PALP_ERR_NO_MEMORY : PALP_OK;
}

const char *palp_experiment_key(const palp_experiment *experiment, size_t i) {
    void *at = experiment ? json_object_iter(experiment->header) : NULL;
    for (; at && i > 0; i--)
        at = json_object_iter_next(experiment->header, at);
    return at ? json_object_iter_key(at) : NULL;
}
