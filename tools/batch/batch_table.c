/* batch_table.c: the scalars that the jobs print as JSON, one row a job, in a CSV file. */
#define _POSIX_C_SOURCE 200809L
#include "batch.h"

#include <stdlib.h>
#include <string.h>

enum { COLUMNS_MAX = 500 };

static bool is_scalar(const json_t *value) {
    return value && !json_is_object(value) && !json_is_array(value);
}

static bool is_taken(const char *name) {
    return strcmp(name, "name") == 0 || strcmp(name, "status") == 0 || strcmp(name, "seconds") == 0;
}

static void add(batch_table *table, json_t *row, const char *above, const char *key, json_t *value) {
    char name[256];
    int n = snprintf(name, sizeof name, "%s%s%s", above, *above ? "." : is_taken(key) ? "result." : "", key);
    if (n < 0 || (size_t)n >= sizeof name)
        return;
    if (!json_object_get(table->columns, name)) {
        if (json_object_size(table->columns) == COLUMNS_MAX) {
            table->left_out++;
            return;
        }
        json_object_set_new(table->columns, name, json_integer((json_int_t)json_object_size(table->columns)));
    }
    json_object_set(row, name, value);
}

/* Members of the object and of the objects in it, but for "palpate", which says what the object is. */
static void flatten(batch_table *table, json_t *row, json_t *object) {
    const char *key, *inner;
    json_t *value, *own;
    json_object_foreach(object, key, value) {
        if (is_scalar(value))
            add(table, row, "", key, value);
        if (!json_is_object(value) || strcmp(key, "palpate") == 0)
            continue;
        json_object_foreach(value, inner, own) {
            if (is_scalar(own))
                add(table, row, key, inner, own);
        }
    }
}

/* What a job printed, if it is one JSON object. */
static json_t *result_of(const char *out, const batch_job *job) {
    char path[BATCH_PATH_MAX];
    batch_path(path, out, job->name, ".out");
    FILE *from = job->ended ? fopen(path, "r") : NULL;
    int first = from ? getc(from) : EOF;
    json_t *result = first == '{' && ungetc(first, from) == first ? json_loadf(from, 0, NULL) : NULL;
    if (from)
        fclose(from);
    return result;
}

int batch_table_make(const char *out, const batch_plan *plan, batch_table *table) {
    *table = (batch_table){json_object(), calloc(plan->n, sizeof *table->row), plan->n, 0};
    if (!table->columns || !table->row)
        return cli_failure(BATCH_NAME, "out of memory");
    for (size_t i = 0; i < plan->n; i++) {
        json_t *result = result_of(out, &plan->job[i]);
        table->row[i] = result ? json_object() : NULL;
        if (table->row[i])
            flatten(table, table->row[i], result);
        json_decref(result);
    }
    if (table->left_out > 0)
        cli_warning(BATCH_NAME, "the table has only the first %d columns; %zu values are left out",
                    COLUMNS_MAX, table->left_out);
    return CLI_OK;
}

/* By RFC 4180: quoted where it has to be. */
static void put_text(const char *text, FILE *to) {
    if (!text[strcspn(text, ",\"\r\n")]) {
        fputs(text, to);
        return;
    }
    fputc('"', to);
    for (; *text; text++)
        fprintf(to, *text == '"' ? "\"\"" : "%c", *text);
    fputc('"', to);
}

static void put_value(const json_t *value, FILE *to) {
    fputc(',', to);
    if (json_is_string(value)) {
        put_text(json_string_value(value), to);
    } else if (value && !json_is_null(value)) {
        char *text = json_dumps(value, JSON_ENCODE_ANY | JSON_REAL_PRECISION(15));
        fputs(text ? text : "", to);
        free(text);
    }
}

static void put_row(const batch_job *job, const batch_table *table, FILE *to) {
    char shown[BATCH_NAME_MAX + 1];
    const char *name;
    json_t *number;
    put_text(palp_text_make_plain(strcpy(shown, job->name)), to);
    if (job->ended)
        fprintf(to, ",%d,%.3f", job->status, job->seconds);
    else
        fputs(",,", to);
    json_object_foreach(table->columns, name, number)
        put_value(json_object_get(table->row[job->number], name), to);
    fputc('\n', to);
}

int batch_table_save(const char *out, const batch_plan *plan, const batch_table *table) {
    char path[BATCH_PATH_MAX];
    palp_file file;
    const char *name;
    json_t *number;
    batch_path(path, out, "table", ".csv");
    int code = cli_file_open(BATCH_NAME, path, &file);
    if (code)
        return code;
    fputs("name,status,seconds", file.stream);
    json_object_foreach(table->columns, name, number) {
        fputc(',', file.stream);
        put_text(name, file.stream);
    }
    fputc('\n', file.stream);
    for (size_t i = 0; i < plan->n; i++)
        put_row(&plan->job[i], table, file.stream);
    return cli_file_close(BATCH_NAME, &file);
}

void batch_table_free(batch_table *table) {
    for (size_t i = 0; i < table->n && table->row; i++)
        json_decref(table->row[i]);
    free(table->row);
    json_decref(table->columns);
}
