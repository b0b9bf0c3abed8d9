/* import_source.c: the tables of a Mach-1, Instron or CSV file. */
#include "import.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "import";
static const char MACH1_ORIGINAL[] = "<Mach-1 File>";

enum { HEADER_LINES = 12 };

/* ---- the list ---- */

static import_source *append(import_sources *all, const import_text *text, import_format format) {
    if (all->n == all->capacity) {
        size_t capacity = all->capacity ? 2 * all->capacity : 16;
        import_source **larger = realloc(all->source, capacity * sizeof(import_source *));
        if (!larger) {
            return NULL;
        }
        all->source = larger;
        all->capacity = capacity;
    }
    import_source *s = calloc(1, sizeof *s);
    if (!s) {
        return NULL;
    }
    all->source[all->n++] = s;
    s->file = text->file;
    s->size = text->size;
    s->crc32 = text->crc32;
    s->format = format;
    const char *slash = strrchr(text->file, '/'), *base = slash ? slash + 1 : text->file;
    const char *dot = strrchr(base, '.');
    snprintf(s->name, sizeof s->name, "%.*s", (int)(dot && dot > base ? (size_t)(dot - base) : strlen(base)),
             base);
    return s;
}

void import_free(import_sources *all) {
    for (size_t i = 0; i < all->n; i++) {
        import_source *s = all->source[i];
        free(s->value);
        free(s->line);
        free(s->time_s);
        free(s->depth_mm);
        free(s->force_N);
        free(s);
    }
    free(all->source);
    memset(all, 0, sizeof *all);
}

/* ---- settings: "key: value" between semicolons ---- */

static void copy_word(char to[IMPORT_WORD], const char *from, size_t n) {
    while (n > 0 && isspace((unsigned char)*from)) {
        from++;
        n--;
    }
    while (n > 0 && (isspace((unsigned char)from[n - 1]) || from[n - 1] == ':')) {
        n--;
    }
    n = n < IMPORT_WORD ? n : IMPORT_WORD - 1;
    memcpy(to, from, n);
    to[n] = '\0';
}

static void add_settings(import_source *s, const char *text) {
    for (const char *at = text; at && s->n_settings < IMPORT_SETTINGS;) {
        size_t n = strcspn(at, ";"), key = strcspn(at, ":");
        if (key < n) {
            copy_word(s->setting[s->n_settings][0], at, key);
            copy_word(s->setting[s->n_settings][1], at + key + 1, n - key - 1);
            s->n_settings++;
        }
        at = at[n] ? at + n + 1 : NULL;
    }
}

const char *import_setting(const import_source *s, const char *key) {
    for (size_t i = 0; i < s->n_settings; i++) {
        if (strcmp(s->setting[i][0], key) == 0) {
            return s->setting[i][1];
        }
    }
    return NULL;
}

/* ---- the table ---- */

static bool all_in_brackets(char *const *fields, size_t n) {
    for (size_t j = 0; j < n; j++) {
        if (*fields[j] && *fields[j] != '(' && *fields[j] != '[') {
            return false;
        }
    }
    return n > 0;
}

static void set_names(import_source *s, char *const *fields, size_t n) {
    s->n_columns = n;
    for (size_t j = 0; j < n; j++) {
        copy_word(s->column[j], fields[j], strlen(fields[j]));
    }
}

/* Under the names: "(s),(mm),(N)". */
static void add_units(import_source *s, char *const *fields, size_t n) {
    for (size_t j = 0; j < n && j < s->n_columns; j++) {
        size_t have = strlen(s->column[j]);
        snprintf(s->column[j] + have, IMPORT_WORD - have, " %s", fields[j]);
    }
}

static bool grow(import_source *s) {
    size_t capacity = s->capacity ? 2 * s->capacity : 4096;
    double *value = realloc(s->value, capacity * s->n_columns * sizeof *value);
    s->value = value ? value : s->value;
    size_t *line = value ? realloc(s->line, capacity * sizeof *line) : NULL;
    s->line = line ? line : s->line;
    s->capacity = line ? capacity : s->capacity;
    return line != NULL;
}

/* A row of numbers; fields that are none, or missing, become NAN. */
static int add_row(import_source *s, char *const *fields, size_t n, size_t line) {
    if (s->rows == s->capacity && !grow(s)) {
        return cli_failure(NAME, "%s: out of memory", s->file);
    }
    for (size_t j = 0; j < s->n_columns; j++) {
        double *to = &s->value[s->rows * s->n_columns + j];
        if (j >= n || !import_number(fields[j], s->separator, to)) {
            *to = NAN;
        }
    }
    s->line[s->rows++] = line;
    return CLI_OK;
}

/* Rows up to the end of the file, or of a Mach-1 block; there, a clock that starts anew after a divider
 * goes on. */
static int read_rows(import_source *s, import_text *text, bool block) {
    char *fields[IMPORT_COLUMNS], *line;
    double clock = 0;
    while ((line = import_line(text))) {
        if (block && strcmp(line, "<END DATA>") == 0) {
            return CLI_OK;
        }
        bool divider = block && strcmp(line, "<divider>") == 0;
        size_t n = divider ? 0 : import_split(line, s->separator, fields);
        int code = n > 0 ? add_row(s, fields, n, text->line) : CLI_OK;
        if (code) {
            return code;
        }
        if (block && n > 0 && s->rows > 1) {
            double *t = &s->value[(s->rows - 1) * s->n_columns], before = *(t - s->n_columns);
            double step = s->rows > 2 ? before - *(t - 2 * s->n_columns) : 0;
            clock = *t + clock <= before && *t == 0 ? before + step : clock;
            *t += clock;
        }
    }
    return block ? cli_failure(NAME, "%s:%zu: the file ends before <END DATA>", s->file, text->line) : CLI_OK;
}

/* ---- any CSV ---- */

/* Whether a line is a row of numbers, the first and most of its fields; if so, by which separator. */
static bool numeric(const char *line, const char *separators, char *separator, size_t *n) {
    char copy[4096], *fields[IMPORT_COLUMNS];
    double x;
    for (const char *c = separators; *c && strlen(line) < sizeof copy; c++) {
        strcpy(copy, line);
        *n = import_split(copy, *c, fields);
        size_t good = 0;
        for (size_t j = 0; j < *n && (j == 0 || good > 0); j++) {
            good += import_number(fields[j], *c, &x);
        }
        if (good >= 2 && 2 * good > *n) {
            *separator = *c;
            return true;
        }
    }
    return false;
}

/* Names from the last line before the numbers; the one before that if the last has the units. */
static int name_columns(import_source *s, char *last, char *before, size_t width, size_t line) {
    char *fields[IMPORT_COLUMNS], *units[IMPORT_COLUMNS];
    double x;
    size_t n = last ? import_split(last, s->separator, fields) : 0, n_units = 0;
    if (n > 0 && before && all_in_brackets(fields, n)) {
        memcpy(units, fields, sizeof units);
        n_units = n;
        n = import_split(before, s->separator, fields);
    }
    for (size_t j = 0; j < n; j++) {
        if (import_number(fields[j], s->separator, &x)) {
            return cli_failure(NAME,
                               "%s:%zu: names of columns that are numbers; say where the names are by "
                               "--skip-lines",
                               s->file, line);
        }
    }
    set_names(s, fields, n);
    add_units(s, units, n_units);
    s->n_columns = n < width ? width : n; /* the rest has no name */
    return CLI_OK;
}

static int read_csv(const import_options *o, import_source *s, import_text *text) {
    static const char *const separators[] = {"\t;,", ",", ";", "\t"};
    char *line, *last = NULL, *before = NULL;
    size_t width = 0, skipped = 0;
    bool header = s->format == IMPORT_INSTRON;
    while ((line = import_line(text))) {
        if (o->skip_lines != SIZE_MAX && skipped < o->skip_lines) {
            skipped++;
            continue;
        }
        if (numeric(line, separators[o->separator + 1], &s->separator, &width)) {
            break;
        }
        if (header) {
            add_settings(s, line);
        }
        if (*line) {
            before = last;
            last = line;
        }
    }
    if (!line) {
        return cli_failure(NAME, "%s:%zu: no row of numbers up to the end of the file%s", s->file, text->line,
                           o->separator >= 0 ? "; is --separator right?" : "");
    }
    size_t at = text->line;
    char *fields[IMPORT_COLUMNS];
    int code = name_columns(s, last, before, width, at - 1);
    code = code ? code : add_row(s, fields, import_split(line, s->separator, fields), at);
    return code ? code : read_rows(s, text, false);
}

/* ---- Mach-1 ---- */

/* "time_s,pos_mm,force_N  # key: value; key: value", then rows. */
static int read_mach1(import_source *s, import_text *text) {
    char *line = import_line(text), *settings = strchr(line, '#'), *fields[IMPORT_COLUMNS];
    s->separator = ',';
    if (settings) {
        *settings++ = '\0';
        add_settings(s, settings);
    }
    set_names(s, fields, import_split(line, ',', fields));
    return read_rows(s, text, false);
}

/* One <DATA> block of the instrument's own file; its settings are in head. */
static int read_block(import_source *s, import_text *text, const import_source *head) {
    char *line = import_line(text), *fields[IMPORT_COLUMNS];
    if (!line) {
        return cli_failure(NAME, "%s:%zu: the file ends after <DATA>", s->file, text->line);
    }
    memcpy(s->setting, head->setting, sizeof s->setting);
    memcpy(s->block, head->block, sizeof s->block);
    s->n_settings = head->n_settings;
    s->separator = '\t';
    set_names(s, fields, import_split(line, '\t', fields));
    return s->n_columns ? read_rows(s, text, true)
                        : cli_failure(NAME, "%s:%zu: no names of columns after <DATA>", s->file, text->line);
}

static void name_block(import_source *s, size_t number) {
    size_t n = strlen(s->name), room = sizeof s->name - 1;
    int written = snprintf(s->name + n, room - n, "_%02zu_", number);
    n += written > 0 ? (size_t)written : 0;
    for (const char *c = s->block; *c && n < room; c++) {
        if (isalnum((unsigned char)*c)) {
            s->name[n++] = *c;
        }
    }
    s->name[n < room ? n : room] = '\0';
}

/* <INFO> ... <END INFO>, <Function>, settings, <DATA>, names, rows, <END DATA>, and again. */
static int read_blocks(import_text *text, import_sources *all) {
    import_source *head = calloc(1, sizeof *head), *s;
    size_t blocks = 0;
    int code = head ? CLI_OK : cli_failure(NAME, "%s: out of memory", text->file);
    char *line;
    while (code == CLI_OK && (line = import_line(text))) {
        if (strcmp(line, "<DATA>") == 0) {
            s = append(all, text, IMPORT_MACH1);
            code = s ? read_block(s, text, head) : cli_failure(NAME, "%s: out of memory", text->file);
            if (code == CLI_OK) {
                name_block(s, blocks++);
            }
        } else if (*line == '<' && strcmp(line, "<INFO>") != 0 && strcmp(line, "<END INFO>") != 0) {
            copy_word(head->block, line + 1, strcspn(line + 1, ">"));
            head->n_settings = 0;
        } else {
            add_settings(head, line);
        }
    }
    free(head);
    if (code == CLI_OK && blocks == 0) {
        return cli_failure(NAME, "%s:%zu: no <DATA> up to the end of the file", text->file, text->line);
    }
    return code;
}

/* ---- which format ---- */

static bool starts(const char *text, const char *with) {
    return strncmp(text, with, strlen(with)) == 0;
}

/* Whether the first lines of the text hold a word. */
static bool near_the_top(const char *text, const char *word) {
    const char *found = strstr(text, word), *line = text;
    for (int i = 0; i < HEADER_LINES && line; i++) {
        line = strchr(line, '\n');
        line = line ? line + 1 : NULL;
    }
    return found && (!line || found < line);
}

static import_format detect(const char *text) {
    if (starts(text, MACH1_ORIGINAL) || starts(text, "time_s,pos_mm,force_N")) {
        return IMPORT_MACH1;
    }
    bool instron = near_the_top(text, "INSTRON") || near_the_top(text, "Instron");
    return instron && near_the_top(text, "Cylinder") ? IMPORT_INSTRON : IMPORT_CSV;
}

static int read_text(const import_options *o, import_text *text, import_sources *all) {
    import_format format = o->format >= 0 ? (import_format)o->format : detect(text->at);
    if (near_the_top(text->at, "# palpate.experiment")) {
        return cli_failure(NAME, "%s: is an experiment of palpate already", text->file);
    }
    if (format == IMPORT_MACH1 && starts(text->at, MACH1_ORIGINAL)) {
        return read_blocks(text, all);
    }
    if (format == IMPORT_MACH1 && !starts(text->at, "time_s,")) {
        return cli_failure(
            NAME, "%s:1: not a Mach-1 file: it starts neither with %s nor with time_s,pos_mm,force_N",
            text->file, MACH1_ORIGINAL);
    }
    import_source *s = append(all, text, format);
    if (!s) {
        return cli_failure(NAME, "%s: out of memory", text->file);
    }
    return format == IMPORT_MACH1 ? read_mach1(s, text) : read_csv(o, s, text);
}

int import_read(const import_options *o, const char *file, import_sources *all) {
    import_text text;
    int code = import_text_read(file, &text);
    code = code       ? code
           : *text.at ? read_text(o, &text, all)
                      : cli_failure(NAME, "%s: the file is empty", file);
    import_text_free(&text);
    return code;
}
