/* experiment_read.c: reads the experiment CSV. */
#define _POSIX_C_SOURCE 200809L /* locale_t */
#include "experiment_internal.h"
#include "base/json.h"
#include "base/number.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Position of the reader in the text. */
typedef struct reader {
    const char *path;
    const char *p, *end; /* *end is NUL */
    size_t line;         /* of p, from 1 */
    palp_experiment *experiment;
    palp_error *error;
} reader;

/* A piece of a line. */
typedef struct piece {
    const char *p;
    size_t n;
} piece;

static const char *const required[] = {"time_s", "depth_mm", "force_N"};
enum { N_REQUIRED = 3, QUOTE_MAX = 40 };

#define FAIL(r, ...) palp_error_set_line((r)->error, PALP_ERR_INPUT, (r)->path, (r)->line, __VA_ARGS__)

static palp_status report_out_of_memory(const reader *r) {
    return palp_error_set(r->error, PALP_ERR_NO_MEMORY, "%s: out of memory", r->path);
}

static int printable_piece_length(piece text) /* its length, as the precision to print it with %.*s */
{
    return text.n < QUOTE_MAX ? (int)text.n : QUOTE_MAX;
}

static piece trim_white_space(piece text) {
    while (text.n > 0 && (*text.p == ' ' || *text.p == '\t')) {
        text.p++;
        text.n--;
    }
    while (text.n > 0 && (text.p[text.n - 1] == ' ' || text.p[text.n - 1] == '\t'))
        text.n--;
    return text;
}

/* A last line without line end may have lost digits and is refused. */
static palp_status report_cut_last_line(const reader *r) {
    return FAIL(
        r, "the last line has no line end, as if cut short; remove the line, or end it if it is complete");
}

/* The line at p without its end. */
static palp_status peek_at_next_line(const reader *r, piece *line) {
    const char *newline = memchr(r->p, '\n', (size_t)(r->end - r->p));
    if (!newline)
        return report_cut_last_line(r);
    *line = (piece){r->p, (size_t)(newline - r->p)};
    if (line->n > 0 && line->p[line->n - 1] == '\r')
        line->n--;
    return PALP_OK;
}

static void advance_to_next_line(reader *r) {
    r->p = (const char *)memchr(r->p, '\n', (size_t)(r->end - r->p)) + 1;
    r->line++;
}

static palp_status set_header_value(reader *r, const char *key, piece text) {
    json_error_t json;
    json_t *value = json_loadb(text.p, text.n, JSON_DECODE_ANY | JSON_REJECT_DUPLICATES, &json);
    if (!value && (!json.text[0] || json_error_code(&json) == json_error_out_of_memory))
        return report_out_of_memory(r);
    if (!value)
        return FAIL(r, "the value of %s is not JSON: %s (put text in quotes)", key, json.text);
    return json_object_set_new(r->experiment->header, key, value) ? report_out_of_memory(r) : PALP_OK;
}

/* "# dotted.key: JSON value" */
static palp_status read_header_line(reader *r, piece line) {
    piece text = trim_white_space((piece){line.p + 1, line.n - 1});
    const char *colon = memchr(text.p, ':', text.n);
    piece name = trim_white_space((piece){text.p, colon ? (size_t)(colon - text.p) : 0});
    if (!palp_experiment_key_valid(name.p, name.n))
        return FAIL(r, "expected \"# key: JSON value\", not \"%.*s\"", printable_piece_length(line), line.p);
    char key[PALP_KEY_MAX + 1] = "";
    memcpy(key, name.p, name.n);
    if (json_object_get(r->experiment->header, key))
        return FAIL(r, "%s is given twice; keep one", key);
    piece value = trim_white_space((piece){colon + 1, (size_t)(text.p + text.n - colon - 1)});
    palp_status status = set_header_value(r, key, value);
    if (status)
        return status;
    const json_t *version = json_object_get(r->experiment->header, "palpate.experiment");
    if (version && !(json_is_number(version) && json_number_value(version) == 1))
        return FAIL(r, "palpate.experiment is not 1, the only version that this build reads");
    return PALP_OK;
}

/* Header lines and empty lines up to the first line that is neither. */
static palp_status read_header_lines(reader *r) {
    palp_status status = PALP_OK;
    piece line = {r->p, 0};
    while (!status && r->p < r->end) {
        status = peek_at_next_line(r, &line);
        if (status || (line.n > 0 && *line.p != '#'))
            break;
        if (line.n > 0)
            status = read_header_line(r, line);
        if (!status)
            advance_to_next_line(r);
    }
    return status;
}

static palp_status read_column_name(reader *r, piece name) {
    palp_experiment *e = r->experiment;
    if (!palp_experiment_name_valid(name.p, name.n))
        return FAIL(r, "\"%.*s\" is not a column name; expected time_s,depth_mm,force_N",
                    printable_piece_length(name), name.p);
    if (palp_experiment_find(e, name.p, name.n) < e->n_columns)
        return FAIL(r, "column %.*s is given twice; rename one", printable_piece_length(name), name.p);
    return palp_experiment_append_column(e, name.p, name.n) ? report_out_of_memory(r) : PALP_OK;
}

/* Are the required columns there? The error says in one line which is missing. */
static palp_status check_required_columns(const reader *r) {
    const palp_experiment *e = r->experiment;
    for (size_t i = 0; i < e->n_columns; i++) {
        const char *name = e->columns[i].name, *hint = palp_key_hint(name, N_REQUIRED, required);
        if (hint && strcmp(hint, name) != 0 && !palp_experiment_column(e, hint))
            return FAIL(r, "column \"%s\": \"%s\" is expected; convert the unit", name, hint);
    }
    for (size_t i = 0; i < N_REQUIRED; i++)
        if (!palp_experiment_column(e, required[i]))
            return FAIL(r, "no column %s: the name row must have time_s, depth_mm and force_N", required[i]);
    return PALP_OK;
}

static palp_status read_column_names(reader *r) {
    piece line = {r->p, 0};
    if (!json_object_get(r->experiment->header, "palpate.experiment"))
        return FAIL(r, "no line \"# palpate.experiment: 1\" before this: not an experiment of palpate");
    if (r->p == r->end)
        return FAIL(r, "no name row (time_s,depth_mm,force_N) before the end of the file");
    palp_status status = peek_at_next_line(r, &line);
    if (status)
        return status;
    const char *end = line.p + line.n;
    while (!status) {
        const char *comma = memchr(line.p, ',', (size_t)(end - line.p));
        status =
            read_column_name(r, trim_white_space((piece){line.p, (size_t)((comma ? comma : end) - line.p)}));
        if (!comma)
            break;
        line.p = comma + 1;
    }
    if (!status)
        status = check_required_columns(r);
    if (!status)
        advance_to_next_line(r);
    return status;
}

/* Reports what is wrong with the row at p, after reading it failed. */
static palp_status report_malformed_row(const reader *r) {
    const palp_experiment *e = r->experiment;
    piece line = {r->p, 0};
    if (peek_at_next_line(r, &line))
        return report_cut_last_line(r);
    size_t width = 1;
    for (size_t i = 0; i < line.n; i++)
        width += line.p[i] == ',';
    if (width != e->n_columns)
        return FAIL(r, "%zu numbers where the name row has %zu columns", width, e->n_columns);
    for (size_t j = 0; j < e->n_columns; j++) {
        const char *comma = memchr(line.p, ',', line.n);
        piece text = {line.p, comma ? (size_t)(comma - line.p) : line.n};
        piece field = trim_white_space(text);
        double value;
        const char *stop = field.n ? palp_number_parse(field.p, &value) : NULL;
        if (stop != field.p + field.n || !isfinite(value))
            return FAIL(r, "%s is not a finite number: \"%.*s\"", e->columns[j].name,
                        printable_piece_length(field), field.p);
        line.p += text.n + 1;
        line.n -= text.n + (comma ? 1 : 0);
    }
    return FAIL(r, "not a row of numbers");
}

static const char *skip_blanks_and_tabs(const char *p) {
    while (*p == ' ' || *p == '\t')
        p++;
    return p;
}

/* Reads the row at p into row *row* of the columns; NULL if it is incomplete or not finite. */
static const char *parse_numbers_of_row(const char *p, const palp_column *columns, size_t n, size_t row) {
    for (size_t j = 0; j < n; j++) {
        double *value = &columns[j].values[row];
        p = palp_number_parse(skip_blanks_and_tabs(p), value);
        if (!p || !isfinite(*value))
            return NULL;
        p = skip_blanks_and_tabs(p);
        if (j + 1 < n && *p++ != ',')
            return NULL;
    }
    if (*p == '\r')
        p++;
    return *p == '\n' ? p + 1 : NULL;
}

static palp_status read_numeric_rows(reader *r) {
    palp_experiment *e = r->experiment;
    size_t time = palp_experiment_find(e, "time_s", strlen("time_s"));
    while (r->p < r->end && *r->p != '#' && *r->p != '\n' && *r->p != '\r') {
        if (e->rows == e->capacity && palp_experiment_grow(e))
            return report_out_of_memory(r);
        const char *next = parse_numbers_of_row(r->p, e->columns, e->n_columns, e->rows);
        if (!next)
            return report_malformed_row(r);
        const double *time_s = e->columns[time].values + e->rows;
        if (e->rows > 0 && !(time_s[0] > time_s[-1]))
            return FAIL(r, "time_s does not increase (%.12g after %.12g)", time_s[0], time_s[-1]);
        e->rows++;
        r->p = next;
        r->line++;
    }
    return PALP_OK;
}

static palp_status read_experiment_text(reader *r) {
    if (r->end - r->p >= 3 && memcmp(r->p, "\xEF\xBB\xBF", 3) == 0)
        r->p += 3; /* the byte order mark that spreadsheets write */
    palp_status status = read_header_lines(r);
    if (!status)
        status = read_column_names(r);
    if (!status)
        status = read_numeric_rows(r);
    if (!status)
        status = read_header_lines(r); /* "# end.fault: ..." */
    if (!status && r->p < r->end)
        status = FAIL(r, "numbers after the end of the run, where only \"# key: value\" lines may stand");
    return status;
}

palp_status palp_experiment_read(const char *path, palp_experiment **experiment, palp_error *error) {
    if (!path || !experiment)
        return palp_error_null(error);
    char *text = NULL;
    size_t size = 0;
    palp_locale locale;
    *experiment = NULL;
    palp_status status = palp_file_read(path, &text, &size, error);
    if (status)
        return status;
    reader r = {path, text, text + size, 1, NULL, error};
    if (!palp_locale_enter(&locale)) {
        free(text);
        return report_out_of_memory(&r);
    }
    status = palp_experiment_empty(&r.experiment) ? report_out_of_memory(&r) : read_experiment_text(&r);
    palp_locale_leave(&locale);
    free(text);
    if (status)
        palp_experiment_free(r.experiment);
    else
        *experiment = r.experiment;
    return status;
}
