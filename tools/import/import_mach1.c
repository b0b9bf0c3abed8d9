/* import_mach1.c: a Biomomentum Mach-1's own text file, or its table as CSV. */
#include "import.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "import";
static const char ORIGINAL[] = "<Mach-1 File>", TABLE[] = "time_s,pos_mm,force_N";

static bool starts(const import_text *text, const char *with) {
    return text->n > 0 && strncmp(text->lines[0], with, strlen(with)) == 0;
}

bool import_mach1_starts(const import_text *text) {
    return starts(text, ORIGINAL) || starts(text, TABLE);
}

/* Reads rows to the end of the file or block. In a block the clock may restart after a divider. */
static int read_rows(import_source *s, import_text *text, bool block) {
    char *fields[IMPORT_COLUMNS], *line;
    double clock = 0;
    while ((line = import_line(text))) {
        if (block && strcmp(line, "<END DATA>") == 0)
            return CLI_OK;
        bool divider = block && strcmp(line, "<divider>") == 0;
        size_t n = divider ? 0 : import_split(line, s->dialect.separator, fields);
        int code = n > 0 ? import_add_row(s, fields, n, text->line) : CLI_OK;
        if (code)
            return code;
        if (block && n > 0 && s->rows > 1) {
            double *t = &s->value[(s->rows - 1) * s->n_columns], before = *(t - s->n_columns);
            double step = s->rows > 2 ? before - *(t - 2 * s->n_columns) : 0;
            clock = *t + clock <= before && *t == 0 ? before + step : clock;
            *t += clock;
        }
    }
    if (block)
        cli_warning(NAME, "%s:%zu: the file ends before <END DATA>: its last block may be cut short", s->file,
                    text->line);
    return CLI_OK;
}

/* "time_s,pos_mm,force_N # key: value; key: value", then rows. */
static int read_table(import_source *s, import_text *text) {
    char *line = import_line(text), *settings = strchr(line, '#'), *fields[IMPORT_COLUMNS];
    s->dialect = (import_dialect){',', '.', ','};
    if (settings) {
        *settings++ = '\0';
        import_add_settings(s, settings);
    }
    import_set_names(s, fields, import_split(line, ',', fields));
    return read_rows(s, text, false);
}

/* One <DATA> block of the tester's own file; its settings are in head. */
static int read_block(import_source *s, import_text *text, const import_source *head) {
    char *line = import_line(text), *fields[IMPORT_COLUMNS];
    if (!line)
        return cli_failure(NAME, "%s:%zu: the file ends after <DATA>", s->file, text->line);
    memcpy(s->setting, head->setting, sizeof s->setting);
    memcpy(s->block, head->block, sizeof s->block);
    s->n_settings = head->n_settings;
    s->dialect = (import_dialect){'\t', '.', ','};
    import_set_names(s, fields, import_split(line, '\t', fields));
    return s->n_columns ? read_rows(s, text, true)
                        : cli_failure(NAME, "%s:%zu: no names of columns after <DATA>", s->file, text->line);
}

static void name_block(import_source *s, size_t number) {
    size_t n = strlen(s->name), room = sizeof s->name - 1;
    int written = snprintf(s->name + n, room - n, "_%02zu_", number);
    n += written > 0 ? (size_t)written : 0;
    for (const char *c = s->block; *c && n < room; c++)
        if (isalnum((unsigned char)*c))
            s->name[n++] = *c;
    s->name[n < room ? n : room] = '\0';
}

/* The file repeats <INFO> ... <END INFO>, <Function>, settings, <DATA>, names, rows, <END DATA>. Settings of
 * the first part, such as the start of the session, hold for all blocks. */
static int read_blocks(import_text *text, import_sources *all) {
    import_source *head = calloc(1, sizeof *head), *s;
    size_t blocks = 0, common = 0;
    int code = head ? CLI_OK : cli_failure(NAME, "%s: out of memory", text->file);
    char *line;
    while (code == CLI_OK && (line = import_line(text))) {
        if (strcmp(line, "<DATA>") == 0) {
            s = import_append(all, text, IMPORT_MACH1);
            code = s ? read_block(s, text, head) : cli_failure(NAME, "%s: out of memory", text->file);
            if (code == CLI_OK)
                name_block(s, blocks++);
        } else if (strcmp(line, "<END INFO>") == 0) {
            common = head->n_settings;
        } else if (*line == '<' && strcmp(line, "<INFO>") != 0) {
            import_copy_word(head->block, line + 1, strcspn(line + 1, ">"));
            head->n_settings = common;
        } else {
            if (strncmp(line, "<INFO>", 6) == 0)
                head->n_settings = common = 0;
            import_add_settings(head, line);
        }
    }
    free(head);
    if (code == CLI_OK && blocks == 0)
        return cli_failure(NAME, "%s:%zu: no <DATA> up to the end of the file", text->file, text->line);
    return code;
}

int import_mach1_read(import_text *text, import_sources *all) {
    if (starts(text, ORIGINAL))
        return read_blocks(text, all);
    if (!starts(text, "time_s,"))
        return cli_failure(NAME, "%s:1: not a Mach-1 file: it starts neither with %s nor with %s", text->file,
                           ORIGINAL, TABLE);
    import_source *s = import_append(all, text, IMPORT_MACH1);
    return s ? read_table(s, text) : cli_failure(NAME, "%s: out of memory", text->file);
}
