/* import_source.c: tables of a file: their list, settings and rows. */
#include "import.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "import";

void *import_grow(void *list, size_t n, size_t *capacity, size_t size) {
    if (n < *capacity)
        return list;
    size_t more = *capacity ? 2 * *capacity : 64;
    void *larger = realloc(list, more * size);
    *capacity = larger ? more : *capacity;
    return larger;
}

import_source *import_append(import_sources *all, const import_text *text, import_format format) {
    import_source **list = import_grow(all->source, all->n, &all->capacity, sizeof *list), *s;
    all->source = list ? list : all->source;
    if (!list || !(s = calloc(1, sizeof *s)))
        return NULL;
    all->source[all->n++] = s;
    s->file = text->file;
    s->size = text->size;
    s->crc32 = text->crc32;
    s->format = format;
    s->segments = 1;
    s->stamp_s = s->start_s = NAN;
    for (int role = 0; role < ROLES; role++)
        s->used[role] = IMPORT_NONE;
    const char *base = cli_base(text->file), *dot = strrchr(base, '.');
    snprintf(s->name, sizeof s->name, "%.*s", (int)(dot && dot > base ? (size_t)(dot - base) : strlen(base)),
             base);
    return s;
}

void import_free_source(import_source *s) {
    free(s->value);
    free(s->line);
    free(s->time_s);
    free(s->depth_mm);
    free(s->force_N);
    free(s);
}

void import_free(import_sources *all) {
    for (size_t i = 0; i < all->n; i++)
        import_free_source(all->source[i]);
    free(all->source);
    memset(all, 0, sizeof *all);
}

void import_copy_word(char to[IMPORT_WORD], const char *from, size_t n) {
    while (n > 0 && isspace((unsigned char)*from)) {
        from++;
        n--;
    }
    while (n > 0 && (isspace((unsigned char)from[n - 1]) || from[n - 1] == ':'))
        n--;
    if (n >= IMPORT_WORD) {
        n = IMPORT_WORD - 1;
        while (n > 0 && ((unsigned char)from[n] & 0xC0) == 0x80) { /* not within a character */
            n--;
        }
    }
    memcpy(to, from, n);
    to[n] = '\0';
}

void import_add_setting(import_source *s, const char *key, const char *value) {
    if (s->n_settings < IMPORT_SETTINGS && isalpha((unsigned char)*key)) {
        import_copy_word(s->setting[s->n_settings][0], key, strlen(key));
        import_copy_word(s->setting[s->n_settings++][1], value, strlen(value));
    }
}

void import_add_settings(import_source *s, const char *text) {
    for (const char *at = text; at && s->n_settings < IMPORT_SETTINGS;) {
        size_t n = strcspn(at, ";"), key = strcspn(at, ":");
        if (key < n) {
            import_copy_word(s->setting[s->n_settings][0], at, key);
            import_copy_word(s->setting[s->n_settings][1], at + key + 1, n - key - 1);
            s->n_settings++;
        }
        at = at[n] ? at + n + 1 : NULL;
    }
}

const char *import_setting(const import_source *s, const char *key) {
    for (size_t i = 0; i < s->n_settings; i++)
        if (strcmp(s->setting[i][0], key) == 0)
            return s->setting[i][1];
    return NULL;
}

double import_setting_number(const import_source *s, const char *key) {
    const char *text = import_setting(s, key), *rest;
    double value;
    return text && import_number_unit(text, &s->dialect, &value, &rest) ? value : 0;
}

void import_set_names(import_source *s, char *const *fields, size_t n) {
    s->n_columns = n;
    for (size_t j = 0; j < n; j++)
        import_copy_word(s->column[j], fields[j], strlen(fields[j]));
}

static bool grow(import_source *s) {
    size_t capacity = s->capacity ? 2 * s->capacity : 1024;
    double *value = realloc(s->value, capacity * s->n_columns * sizeof *value);
    s->value = value ? value : s->value;
    size_t *line = value ? realloc(s->line, capacity * sizeof *line) : NULL;
    s->line = line ? line : s->line;
    s->capacity = line ? capacity : s->capacity;
    return line != NULL;
}

/* A time of day that falls by half a day has passed midnight. */
static double after_midnight(const import_source *s, size_t j, double seconds) {
    double before =
        s->rows > 1 ? s->value[(s->rows - 2) * s->n_columns + j] : NAN; /* the last row is the new one */
    double days = isfinite(before) ? floor((before - seconds) / 86400 + 0.5) : 0;
    return days > 0 ? seconds + 86400 * days : seconds;
}

double *import_new_row(import_source *s, size_t line) {
    if (s->rows == s->capacity && !grow(s))
        return NULL;
    s->line[s->rows] = line;
    return &s->value[s->rows++ * s->n_columns];
}

int import_add_row(import_source *s, char *const *fields, size_t n, size_t line) {
    double *row = import_new_row(s, line);
    if (!row)
        return cli_failure(NAME, "%s: out of memory", s->file);
    for (size_t j = 0; j < s->n_columns; j++) {
        double *to = &row[j], seconds;
        bool dated;
        if (j >= n || import_number(fields[j], &s->dialect, to)) {
            *to = j < n ? *to : NAN;
        } else if (import_clock(fields[j], &seconds, &dated)) {
            s->clock[j] = true;
            *to = dated ? seconds : after_midnight(s, j, seconds);
        } else {
            *to = NAN;
        }
    }
    return CLI_OK;
}
