/* import_table.c: the tables of any text file: which lines are rows; all lines but rows and their names are
 * settings. */
#include "import_table.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "import";

enum { PENDING = 3, SIDE_ROWS = 2 };

/* Whether a line is a row of numbers: at least two, and most of the fields that are not empty. */
static bool is_row(const table_scanner *c, size_t line, size_t *width) {
    char *fields[IMPORT_COLUMNS];
    const char *text = c->text->lines[line];
    text += strspn(text, " \t");
    if (!*text || *text == '#')
        return false;
    size_t n = table_fields(c, line, fields), numbers = 0, filled = 0;
    for (size_t j = 0; j < n; j++) {
        numbers += table_is_number(c, fields[j]);
        filled += *fields[j] != '\0';
    }
    *width = n;
    return numbers >= 2 && 2 * numbers > filled;
}

/* Whether the lines within a table that are not rows are a new header, or only faults. */
static bool header_between(const table_scanner *c, size_t from, size_t to) {
    char *fields[IMPORT_COLUMNS];
    size_t lines = 0;
    for (size_t line = from; line < to; line++) {
        const char *text = c->text->lines[line];
        size_t n = table_fields(c, line, fields);
        lines += n > 0;
        if (*text == '#' || *text == '[' || lines > PENDING || (n > 1 && table_roles(fields, n) >= 2))
            return true;
    }
    return false;
}

static table_block *new_block(table_scanner *c, size_t above, size_t first, size_t width) {
    table_block *blocks = import_grow(c->blocks, c->n, &c->capacity, sizeof *blocks);
    if (!blocks)
        return NULL;
    c->blocks = blocks;
    c->blocks[c->n] = (table_block){.above = above, .first = first, .width = width};
    return &c->blocks[c->n++];
}

/* A row may lack fields at its end, or have one more word. */
static bool find_blocks(table_scanner *c) {
    table_block *b = NULL;
    for (size_t line = c->begin; line < c->text->n; line++) {
        size_t width;
        if (!is_row(c, line, &width))
            continue;
        if (!b || (width > b->width && b->rows <= SIDE_ROWS && line > b->last) ||
            header_between(c, b->last, line)) {
            b = new_block(c, b ? b->last : c->begin, line, width);
            if (!b)
                return false;
        }
        b->last = line + 1;
        b->width = b->rows++ <= SIDE_ROWS && width > b->width ? width : b->width;
    }
    for (size_t i = 0; i < c->n; i++)
        table_find_names(c, &c->blocks[i]);
    return true;
}

/* The main table: the longest of those that name time, depth and force; else the longest. */
static const table_block *main_block(const table_scanner *c) {
    const table_block *best = NULL;
    for (size_t i = 0; i < c->n; i++) {
        const table_block *b = &c->blocks[i];
        bool whole = b->roles == QUANTITIES && b->rows > SIDE_ROWS,
             best_whole = best && best->roles == QUANTITIES && best->rows > SIDE_ROWS;
        if (!best || (whole != best_whole ? whole : b->rows > best->rows))
            best = b;
    }
    return best;
}

/* "key;24,0;mm", "key: value; key: value", "key = value" or "key 24 mm". */
static void add_line(const table_scanner *c, size_t line, import_source *s) {
    char *fields[IMPORT_COLUMNS], value[2 * IMPORT_WORD];
    size_t n = c->dialect.separator == ' ' ? 0 : table_fields(c, line, fields);
    if (n >= 2 && (table_is_number(c, fields[1]) || !strchr(fields[1], ':')) &&
        isalpha((unsigned char)*fields[0])) {
        snprintf(value, sizeof value, "%.90s %.90s", fields[1], n > 2 ? fields[2] : "");
        import_add_setting(s, fields[0], value);
        return;
    }
    char *text = c->scratch;
    strcpy(text, c->text->lines[line] + strspn(c->text->lines[line], "#%\" "));
    char *equals = strchr(text, ':') ? NULL : strchr(text, '=');
    size_t word = strcspn(text, " \t");
    if (equals) {
        *equals = '\0';
        import_add_setting(s, text, equals + 1);
    } else if (strchr(text, ':')) {
        import_add_settings(s, text);
    } else if (text[word] && table_is_number(c, text + word + strspn(text + word, " \t"))) {
        text[word] = '\0';
        import_add_setting(s, text, text + word + 1);
    }
}

/* "Size 10.0 24.0" */
static void add_row_setting(const table_scanner *c, size_t line, import_source *s) {
    char *fields[IMPORT_COLUMNS], text[IMPORT_WORD] = "";
    size_t n = table_fields(c, line, fields);
    for (size_t j = 1; j < n && strlen(text) + 32 < sizeof text; j++)
        snprintf(text + strlen(text), sizeof text - strlen(text), "%.24s ", fields[j]);
    if (n > 1 && isalpha((unsigned char)*fields[0]))
        import_add_setting(s, fields[0], text);
}

/* Reads a table of sizes beside the recording: names, and the numbers below them in its first row or that of
 * a specimen. */
static void add_side_table(const table_scanner *c, const table_block *b, size_t row, import_source *s) {
    char *fields[IMPORT_COLUMNS];
    import_source *side = calloc(1, sizeof *side);
    if (!side)
        return;
    table_set_columns(c, b, side);
    size_t n = table_fields(c, b->first + row, fields);
    for (size_t j = 0; j < n && j < side->n_columns; j++)
        if (*side->column[j])
            import_add_setting(s, side->column[j], fields[j]);
    for (size_t line = b->first; line < b->last; line++)
        add_row_setting(c, line, s);
    free(side);
}

/* Reads settings from all lines before the last row of the source that are not rows. */
static void add_all_settings(const table_scanner *c, const table_block *own, const import_groups *groups,
                             size_t group, import_source *s) {
    for (size_t i = 0; i < c->n && &c->blocks[i] <= own; i++) {
        const table_block *b = &c->blocks[i];
        for (size_t line = b->above; line < b->first; line++)
            if (line != b->names && line != b->units)
                add_line(c, line, s);
        bool each = groups->n > 1 && b->rows == groups->n && b->last - b->first == b->rows;
        if (b != own && (b->rows <= SIDE_ROWS || each))
            add_side_table(c, b, each ? group : 0, s);
    }
}

static bool same_names(const import_source *a, const import_source *b) {
    bool same = a->n_columns == b->n_columns;
    for (size_t j = 0; same && j < a->n_columns; j++)
        same = strcmp(a->column[j], b->column[j]) == 0;
    return same;
}

/* Reads the rows of a block; another line becomes a row without numbers. */
static int read_rows(const table_scanner *c, const table_block *b, import_source *s) {
    char *fields[IMPORT_COLUMNS];
    int code = CLI_OK;
    for (size_t line = b->first; code == CLI_OK && line < b->last; line++) {
        size_t n = table_fields(c, line, fields);
        code = n > 0 ? import_add_row(s, fields, n, line + 1) : CLI_OK;
    }
    return code;
}

/* Whether a block continues the main table: with the same columns, or without names and as wide. */
static bool continues(const table_scanner *c, const table_block *b, const table_block *whole,
                      const import_source *reference) {
    import_source *own = calloc(1, sizeof *own);
    bool same = own != NULL && b->rows > SIDE_ROWS;
    if (same && b->names == IMPORT_NONE && b > whole) {
        same = b->width == whole->width;
    } else if (same) {
        table_set_columns(c, b, own);
        same = same_names(own, reference);
    }
    free(own);
    return same;
}

/* Makes a source from the rows of a block; from each group if its columns repeat. */
static int add_source(const table_scanner *c, const table_block *b, const import_source *reference,
                      const import_groups *groups, import_sources *all) {
    import_source *s = import_append(all, c->text, reference->format), *part = s;
    if (!s)
        return cli_failure(NAME, "%s: out of memory", c->text->file);
    s->dialect = c->dialect;
    s->n_columns = reference->n_columns;
    memcpy(s->column, reference->column, sizeof s->column);
    add_all_settings(c, b, groups, 0, s);
    int code = read_rows(c, b, s);
    for (size_t k = 0; code == CLI_OK && groups->n > 1 && k < groups->n; k++) {
        part = import_append(all, c->text, reference->format);
        if (part)
            add_all_settings(c, b, groups, k, part);
        code = part ? import_groups_take(s, groups, k, part)
                    : cli_failure(NAME, "%s: out of memory", c->text->file);
    }
    return code;
}

/* Removes the sources that were divided into groups. */
static void drop_whole(import_sources *all, size_t first) {
    size_t kept = first;
    for (size_t i = first; i < all->n; i++) {
        if (all->source[i]->groups)
            all->source[kept++] = all->source[i];
        else
            import_free_source(all->source[i]);
    }
    all->n = kept;
}

static int add_sources(const import_options *o, const table_scanner *c, import_format format,
                       import_sources *all) {
    const table_block *whole = main_block(c);
    const import_groups one = {1, 0, 0};
    import_groups groups = one;
    import_source *reference = calloc(1, sizeof *reference);
    size_t first = all->n;
    int code = reference ? CLI_OK : cli_failure(NAME, "%s: out of memory", c->text->file);
    if (reference) {
        reference->format = format;
        reference->dialect = c->dialect;
        table_set_columns(c, whole, reference);
        table_add_units(c, whole->first, reference);
        add_all_settings(c, whole, &one, 0, reference);
        groups = o->map ? one : import_groups_find(reference, import_rate_known(o, reference));
    }
    for (size_t i = 0; code == CLI_OK && i < c->n; i++) {
        const table_block *b = &c->blocks[i];
        if (b == whole || continues(c, b, whole, reference))
            code = add_source(c, b, reference, &groups, all);
    }
    if (groups.n > 1)
        drop_whole(all, first);
    free(reference);
    return code;
}

int import_table_read(const import_options *o, import_text *text, import_format format, import_sources *all) {
    table_scanner c = {.text = text, .begin = o->skip_lines == SIZE_MAX ? 0 : o->skip_lines};
    int code;
    c.scratch = malloc(2 * (text->longest + 1));
    if (!c.scratch)
        return cli_failure(NAME, "%s: out of memory", text->file);
    c.scratch2 = c.scratch + text->longest + 1;
    import_dialect_find(text, o->separator, c.scratch, &c.dialect);
    if (!find_blocks(&c))
        code = cli_failure(NAME, "%s: out of memory", text->file);
    else if (c.n == 0)
        code = import_left_out(o, text->file)
                   ? CLI_OK
                   : cli_failure(NAME, "%s:%zu: no row of numbers up to the end of the file%s", text->file,
                                 text->n, o->separator >= 0 ? "; is --separator right?" : "");
    else
        code = add_sources(o, &c, format, all);
    free(c.scratch);
    free(c.blocks);
    return code;
}
