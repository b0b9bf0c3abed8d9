/* import_table.c: the tables of any text file: which lines are rows, which line names the columns, which says their
 * units; all other lines are settings. */
#include "import.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "import";

enum { PENDING = 3, ABOVE = 12, SIDE_ROWS = 2 };

/* Rows of one width, and the lines above them that no table before has. */
typedef struct block {
    size_t above, first, last; /* lines, from 0; last = after the last row */
    size_t width, rows;
    size_t names, units;       /* lines; IMPORT_NONE = there is none */
    int roles;                 /* how many of time, depth and force its names tell */
} block;

typedef struct scanner {
    const import_text *text;
    import_dialect dialect;
    size_t begin; /* the first line that counts */
    char *scratch, *scratch2;
    size_t n, capacity;
    block *blocks;
} scanner;

/* Characters of a comment's sign before a line's text: "#", "//", "% " */
static size_t comment_sign(const char *text) {
    size_t n = strspn(text, " ");
    return text[n] == '#' ? n + strspn(text + n, "#") : strncmp(text + n, "//", 2) == 0 ? n + 2 : strncmp(text + n, "% ", 2) == 0 ? n + 2 : 0;
}

/* A line's fields, without a comment sign before them; they stay until the next call. */
static size_t fields_of(const scanner *c, size_t line, char *fields[IMPORT_COLUMNS]) {
    const char *from = c->text->lines[line];
    size_t sign = comment_sign(from);
    strcpy(c->scratch, from + sign + (sign ? strspn(from + sign, " ") : 0));
    return import_split(c->scratch, c->dialect.separator, fields);
}

static bool is_number(const scanner *c, const char *field) {
    double x;
    bool dated;
    return import_number(field, &c->dialect, &x) || import_clock(field, &x, &dated);
}

/* Whether a line is a row of numbers: two of them at least and most of its fields. */
static bool is_row(const scanner *c, size_t line, size_t *width) {
    char *fields[IMPORT_COLUMNS];
    const char *text = c->text->lines[line];
    text += strspn(text, " \t");
    if (!*text || *text == '#') {
        return false;
    }
    size_t n = fields_of(c, line, fields), numbers = 0;
    for (size_t j = 0; j < n; j++) {
        numbers += is_number(c, fields[j]);
    }
    *width = n;
    return numbers >= 2 && 2 * numbers > n;
}

/* ---- names and units ---- */

/* Bracketed words belong to the name before: "Time (s)" between blanks. */
static size_t join_brackets(char *fields[IMPORT_COLUMNS], size_t n) {
    size_t m = 0;
    for (size_t j = 0; j < n; j++) {
        if (m > 0 && (*fields[j] == '(' || *fields[j] == '[')) {
            char *end = fields[m - 1] + strlen(fields[m - 1]);
            *end = ' ';
            memmove(end + 1, fields[j], strlen(fields[j]) + 1);
        } else {
            fields[m++] = fields[j];
        }
    }
    return m;
}

/* Two blanks and more part names that have single blanks in them. */
static size_t split_wide(const scanner *c, size_t line, char *fields[IMPORT_COLUMNS]) {
    char *to = c->scratch2;
    for (const char *at = c->text->lines[line]; *at;) {
        size_t blanks = strspn(at, " ");
        *to++ = blanks > 1 ? '\t' : *at;
        at += blanks > 1 ? blanks : 1;
    }
    *to = '\0';
    strcpy(c->scratch, c->scratch2 + comment_sign(c->scratch2));
    return import_split(c->scratch, '\t', fields);
}

/* The fields of a line of names: of a table between blanks, by another sign if only that gives the table's width. A key
 * before them, "columns:", is none. */
static size_t names_of(const scanner *c, size_t line, size_t width, char *fields[IMPORT_COLUMNS]) {
    static const char others[] = "\t;,";
    size_t n = fields_of(c, line, fields);
    if (c->dialect.separator == ' ' && n != width) {
        n = join_brackets(fields, n);
        for (const char *sign = others; n != width && n != width + 1 && *sign; sign++) {
            scanner other = *c;
            other.dialect.separator = *sign;
            n = fields_of(&other, line, fields);
        }
        n = n == width || n == width + 1 ? n : split_wide(c, line, fields);
        n = n == width || n == width + 1 ? n : join_brackets(fields, fields_of(c, line, fields));
    }
    if (n == width + 1 && *fields[0] && fields[0][strlen(fields[0]) - 1] == ':') {
        memmove(fields, fields + 1, width * sizeof *fields);
        n = width;
    }
    return n;
}

/* How many of time, depth and force the fields name. */
static int roles_of(char *const *fields, size_t n) {
    bool seen[ROLES] = {false};
    for (size_t j = 0; j < n; j++) {
        const import_unit *unit = import_unit_of_name(fields[j]);
        for (int role = 0; role < ROLES && *fields[j]; role++) {
            seen[role] = seen[role] || import_name_rank(fields[j], unit, role) > 0;
        }
    }
    return seen[TIME] + (seen[DEPTH] || seen[STRAIN]) + (seen[FORCE] || seen[STRESS]);
}

/* All fields are units, in brackets or not, or empty; a unit at least. */
static bool are_units(char *const *fields, size_t n) {
    size_t good = 0, other = 0;
    for (size_t j = 0; j < n; j++) {
        bool bracketed = *fields[j] == '(' || *fields[j] == '[';
        bool unit = bracketed ? import_unit_of_name(fields[j]) != NULL : import_unit_any(fields[j]);
        good += unit && *fields[j];
        other += *fields[j] && !unit && !bracketed;
    }
    return good > 0 && other <= good / 2;
}

static bool has_number(const scanner *c, char *const *fields, size_t n) {
    for (size_t j = 0; j < n; j++) {
        if (is_number(c, fields[j])) {
            return true;
        }
    }
    return false;
}

/* The line above the rows that names most of time, depth and force, the lowest of them; else the lowest that has a field
 * for most columns and no number. */
static void find_names(const scanner *c, block *b) {
    char *fields[IMPORT_COLUMNS];
    size_t other = IMPORT_NONE, seen = 0;
    b->names = b->units = IMPORT_NONE;
    for (size_t line = b->first; line > b->above && seen < ABOVE; line--) {
        size_t n = names_of(c, line - 1, b->width, fields);
        seen += n > 0;
        if (n < 2 || 2 * n <= b->width || has_number(c, fields, n)) {
            continue;
        }
        if (are_units(fields, n)) {
            b->units = b->units == IMPORT_NONE && other == IMPORT_NONE ? line - 1 : b->units;
            continue;
        }
        int roles = roles_of(fields, n);
        if (roles > b->roles && roles >= 2) {
            b->names = line - 1;
            b->roles = roles;
        }
        other = other == IMPORT_NONE && n <= b->width + 1 && seen <= PENDING ? line - 1 : other;
    }
    b->names = b->names == IMPORT_NONE ? other : b->names;
    if (b->units != IMPORT_NONE && b->names != IMPORT_NONE && b->units < b->names) {
        b->units = IMPORT_NONE;
    }
}

/* "Sig1 Time (min)", "Column 2: Force (N)": a line for each column. */
static bool name_of_column(char *text, size_t *column, char **name) {
    size_t n = 0;
    while (isalpha((unsigned char)text[n])) {
        n++;
    }
    size_t at = n + strspn(text + n, " ");
    if (n == 0 || !isdigit((unsigned char)text[at])) {
        return false;
    }
    *column = strtoul(text + at, name, 10);
    *name += strspn(*name, " \t:=-,;");
    return **name != '\0' && *column >= 1;
}

static void list_names(const scanner *c, const block *b, import_source *s) {
    for (size_t line = b->above; line < b->first; line++) {
        char *name;
        size_t column;
        strcpy(c->scratch, c->text->lines[line] + strspn(c->text->lines[line], "# "));
        if (name_of_column(c->scratch, &column, &name) && column <= s->n_columns && isalpha((unsigned char)*name)) {
            import_copy_word(s->column[column - 1], name, strlen(name));
        }
    }
}

static void add_unit(char name[IMPORT_WORD], const char *unit) {
    size_t have = strlen(name), n = strlen(unit);
    bool bracketed = *unit == '(' || *unit == '[';
    if (n > 0 && have + n + 4 < IMPORT_WORD) {
        snprintf(name + have, IMPORT_WORD - have, bracketed ? " %s" : " (%s)", unit);
    }
}

static void set_columns(const scanner *c, const block *b, import_source *s) {
    char *fields[IMPORT_COLUMNS];
    size_t n = b->names == IMPORT_NONE ? 0 : names_of(c, b->names, b->width, fields);
    import_set_names(s, fields, n);
    s->n_columns = n < b->width ? b->width : n; /* the rest has no name */
    if (b->roles < 2) {
        list_names(c, b, s);
    }
    n = b->units == IMPORT_NONE ? 0 : names_of(c, b->units, b->width, fields);
    for (size_t j = 0; j < n && j < s->n_columns; j++) {
        add_unit(s->column[j], fields[j]);
    }
}

/* ---- blocks ---- */

/* Lines within a table that are no rows: a new header among them, or only faults. */
static bool header_between(const scanner *c, size_t from, size_t to) {
    char *fields[IMPORT_COLUMNS];
    size_t lines = 0;
    for (size_t line = from; line < to; line++) {
        const char *text = c->text->lines[line];
        size_t n = fields_of(c, line, fields);
        lines += n > 0;
        if (*text == '#' || *text == '[' || lines > PENDING || (n > 1 && roles_of(fields, n) >= 2)) {
            return true;
        }
    }
    return false;
}

static block *new_block(scanner *c, size_t above, size_t first, size_t width) {
    if (c->n == c->capacity) {
        size_t capacity = c->capacity ? 2 * c->capacity : 16;
        block *larger = realloc(c->blocks, capacity * sizeof *larger);
        if (!larger) {
            return NULL;
        }
        c->blocks = larger;
        c->capacity = capacity;
    }
    c->blocks[c->n] = (block){.above = above, .first = first, .width = width};
    return &c->blocks[c->n++];
}

/* A row may lack fields at its end, or have a word more. */
static bool find_blocks(scanner *c) {
    block *b = NULL;
    for (size_t line = c->begin; line < c->text->n; line++) {
        size_t width;
        if (!is_row(c, line, &width)) {
            continue;
        }
        if (!b || (width > b->width && b->rows <= SIDE_ROWS && line > b->last) || header_between(c, b->last, line)) {
            b = new_block(c, b ? b->last : c->begin, line, width);
            if (!b) {
                return false;
            }
        }
        b->last = line + 1;
        b->width = b->rows++ <= SIDE_ROWS && width > b->width ? width : b->width;
    }
    for (size_t i = 0; i < c->n; i++) {
        find_names(c, &c->blocks[i]);
    }
    return true;
}

/* The table: of those that name time, depth and force, the longest; else the longest. */
static const block *main_block(const scanner *c) {
    const block *best = NULL;
    for (size_t i = 0; i < c->n; i++) {
        const block *b = &c->blocks[i];
        bool whole = b->roles == QUANTITIES && b->rows > SIDE_ROWS, best_whole = best && best->roles == QUANTITIES && best->rows > SIDE_ROWS;
        if (!best || (whole != best_whole ? whole : b->rows > best->rows)) {
            best = b;
        }
    }
    return best;
}

/* ---- settings ---- */

/* "key;24,0;mm", "key: value; key: value", "key = value" or "key 24 mm". */
static void add_line(const scanner *c, size_t line, import_source *s) {
    char *fields[IMPORT_COLUMNS], value[2 * IMPORT_WORD];
    size_t n = c->dialect.separator == ' ' ? 0 : fields_of(c, line, fields);
    if (n >= 2 && (is_number(c, fields[1]) || !strchr(fields[1], ':')) && isalpha((unsigned char)*fields[0])) {
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
    } else if (text[word] && is_number(c, text + word + strspn(text + word, " \t"))) {
        text[word] = '\0';
        import_add_setting(s, text, text + word + 1);
    }
}

/* A small table beside the recording: names of the specimen's sizes, and the numbers under them. */
static void add_side_table(const scanner *c, const block *b, import_source *s) {
    char *fields[IMPORT_COLUMNS];
    import_source *side = calloc(1, sizeof *side);
    if (!side) {
        return;
    }
    set_columns(c, b, side);
    size_t n = fields_of(c, b->first, fields);
    for (size_t j = 0; j < n && j < side->n_columns; j++) {
        if (*side->column[j]) {
            import_add_setting(s, side->column[j], fields[j]);
        }
    }
    if (isalpha((unsigned char)*fields[0]) && n > 1) { /* "Size 10.0 24.0" */
        char text[IMPORT_WORD] = "";
        for (size_t j = 1; j < n && strlen(text) + 32 < sizeof text; j++) {
            snprintf(text + strlen(text), sizeof text - strlen(text), "%.24s ", fields[j]);
        }
        import_add_setting(s, fields[0], text);
    }
    free(side);
}

/* Of all lines before the last row of the source that are no rows of a table. */
static void add_all_settings(const scanner *c, const block *own, import_source *s) {
    for (size_t i = 0; i < c->n && &c->blocks[i] <= own; i++) {
        const block *b = &c->blocks[i];
        for (size_t line = b->above; line < b->first; line++) {
            if (line != b->names && line != b->units) {
                add_line(c, line, s);
            }
        }
        if (b != own && b->rows <= SIDE_ROWS) {
            add_side_table(c, b, s);
        }
    }
}

/* ---- sources ---- */

static bool same_names(const import_source *a, const import_source *b) {
    bool same = a->n_columns == b->n_columns;
    for (size_t j = 0; same && j < a->n_columns; j++) {
        same = strcmp(a->column[j], b->column[j]) == 0;
    }
    return same;
}

/* Rows of a block; a line among them that is none becomes a row without numbers. */
static int read_rows(const scanner *c, const block *b, import_source *s) {
    char *fields[IMPORT_COLUMNS];
    int code = CLI_OK;
    for (size_t line = b->first; code == CLI_OK && line < b->last; line++) {
        size_t n = fields_of(c, line, fields);
        code = n > 0 ? import_add_row(s, fields, n, line + 1) : CLI_OK;
    }
    return code;
}

/* Whether a block is more of the main table: of the same columns, or without names and as wide. */
static bool continues(const scanner *c, const block *b, const block *whole, const import_source *reference) {
    import_source *own = calloc(1, sizeof *own);
    bool same = own != NULL && b->rows > SIDE_ROWS;
    if (same && b->names == IMPORT_NONE && b > whole) {
        same = b->width == whole->width;
    } else if (same) {
        set_columns(c, b, own);
        same = same_names(own, reference);
    }
    free(own);
    return same;
}

static int add_source(const scanner *c, const block *b, const import_source *reference, import_format format, import_sources *all) {
    import_source *s = import_append(all, c->text, format);
    if (!s) {
        return cli_failure(NAME, "%s: out of memory", c->text->file);
    }
    s->dialect = c->dialect;
    s->n_columns = reference->n_columns;
    memcpy(s->column, reference->column, sizeof s->column);
    add_all_settings(c, b, s);
    return read_rows(c, b, s);
}

static int add_sources(const scanner *c, import_format format, import_sources *all) {
    const block *whole = main_block(c);
    import_source *reference = calloc(1, sizeof *reference);
    int code = reference ? CLI_OK : cli_failure(NAME, "%s: out of memory", c->text->file);
    if (reference) {
        set_columns(c, whole, reference);
    }
    for (size_t i = 0; code == CLI_OK && i < c->n; i++) {
        const block *b = &c->blocks[i];
        if (b == whole || continues(c, b, whole, reference)) {
            code = add_source(c, b, reference, format, all);
        }
    }
    free(reference);
    return code;
}

int import_table_read(const import_options *o, import_text *text, import_format format, import_sources *all) {
    scanner c = {.text = text, .begin = o->skip_lines == SIZE_MAX ? 0 : o->skip_lines};
    int code;
    c.scratch = malloc(2 * (text->longest + 1));
    if (!c.scratch) {
        return cli_failure(NAME, "%s: out of memory", text->file);
    }
    c.scratch2 = c.scratch + text->longest + 1;
    import_dialect_find(text, o->separator, c.scratch, &c.dialect);
    if (!find_blocks(&c)) {
        code = cli_failure(NAME, "%s: out of memory", text->file);
    } else if (c.n == 0) {
        code = cli_failure(NAME, "%s:%zu: no row of numbers up to the end of the file%s", text->file, text->n,
                           o->separator >= 0 ? "; is --separator right?" : "");
    } else {
        code = add_sources(&c, format, all);
    }
    free(c.scratch);
    free(c.blocks);
    return code;
}
