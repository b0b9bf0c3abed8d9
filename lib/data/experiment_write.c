/* experiment_write.c: writes the experiment CSV. */
#define _POSIX_C_SOURCE 200809L /* locale_t */
#include "experiment_internal.h"
#include "base/file.h"
#include "base/number.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The value as JSON with the fewest digits that read back the same, allocated by Jansson; NULL: out of
 * memory. */
static char *format_header_value(const json_t *value) {
    char *text = NULL;
    for (size_t precision = 15; precision <= 17; precision++) {
        free(text);
        text = json_dumps(value, JSON_ENCODE_ANY | JSON_REAL_PRECISION(precision));
        json_t *back = text ? json_loads(text, JSON_DECODE_ANY, NULL) : NULL;
        bool same = json_equal(back, value);
        json_decref(back);
        if (!text || same)
            break;
    }
    return text;
}

palp_status palp_experiment_get_json(const palp_experiment *experiment, const char *key, char **text) {
    if (!experiment || !key || !text)
        return PALP_ERR_ARGUMENT;
    const json_t *value = json_object_get(experiment->header, key);
    palp_locale locale;
    if (!value)
        return PALP_ERR_INPUT;
    if (!palp_locale_enter(&locale))
        return PALP_ERR_NO_MEMORY;
    *text = format_header_value(value);
    palp_locale_leave(&locale);
    return *text ? PALP_OK : PALP_ERR_NO_MEMORY;
}

/* Keys that say how the run ended are written after the numbers. */
static bool is_end_of_run_key(const char *key) {
    return strncmp(key, "end.", 4) == 0;
}

static palp_status write_header_lines(const palp_experiment *e, bool ending, FILE *stream) {
    const char *key;
    json_t *value;
    json_object_foreach(e->header, key, value) {
        if (is_end_of_run_key(key) != ending)
            continue;
        char *text = format_header_value(value);
        if (!text)
            return PALP_ERR_NO_MEMORY;
        fprintf(stream, "# %s: %s\n", key, text);
        free(text);
    }
    return PALP_OK;
}

static void write_column_names(const palp_experiment *e, FILE *stream) {
    for (size_t j = 0; j < e->n_columns; j++)
        fprintf(stream, "%s%s", j ? "," : "", e->columns[j].name);
    fputc('\n', stream);
}

static void write_numeric_rows(const palp_experiment *e, FILE *stream) {
    char text[PALP_NUMBER_TEXT + 1];
    for (size_t i = 0; i < e->rows; i++)
        for (size_t j = 0; j < e->n_columns; j++) {
            size_t n = palp_number_format(e->columns[j].values[i], text);
            text[n] = j + 1 < e->n_columns ? ',' : '\n';
            fwrite(text, 1, n + 1, stream);
        }
}

/* Refuses values that could not be read again. */
static palp_status check_rows_before_write(const palp_experiment *e, const char *path, palp_error *error) {
    const double *time_s = palp_experiment_column(e, "time_s");
    for (size_t j = 0; j < e->n_columns; j++)
        for (size_t i = 0; i < e->rows; i++)
            if (!isfinite(e->columns[j].values[i]))
                return palp_error_set(error, PALP_ERR_ARGUMENT,
                                      "%s: not written: %s of row %zu is not finite", path,
                                      e->columns[j].name, i + 1);
    for (size_t i = 1; i < e->rows; i++)
        if (!(time_s[i] > time_s[i - 1]))
            return palp_error_set(error, PALP_ERR_ARGUMENT,
                                  "%s: not written: time_s of row %zu does not increase", path, i + 1);
    return PALP_OK;
}

static palp_status write_experiment_text(const palp_experiment *e, FILE *stream) {
    palp_locale locale;
    if (!palp_locale_enter(&locale))
        return PALP_ERR_NO_MEMORY;
    palp_status status = write_header_lines(e, false, stream);
    if (!status) {
        write_column_names(e, stream);
        write_numeric_rows(e, stream);
        status = write_header_lines(e, true, stream);
    }
    palp_locale_leave(&locale);
    return status;
}

palp_status palp_experiment_write(const palp_experiment *experiment, const char *path, palp_error *error) {
    if (!experiment || !path)
        return palp_error_null(error);
    palp_file file;
    palp_status status = check_rows_before_write(experiment, path, error);
    if (!status)
        status = palp_file_begin(&file, path, error);
    if (status)
        return status;
    status = write_experiment_text(experiment, file.stream);
    if (!status)
        return palp_file_commit(&file, true, error);
    palp_file_abandon(&file);
    return palp_error_set(error, status, "%s: not written: %s", path, palp_status_text(status));
}
