/* import_header.c: the lines above a table with the names and units of its columns. */
#include "import_table.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

enum { NEAR = 3, ABOVE = 12 };

/* Characters of a comment's sign before a line's text: "#", "//", "% " */
static size_t comment_sign(const char *text) {
    size_t n = strspn(text, " ");
    return text[n] == '#'                    ? n + strspn(text + n, "#")
           : strncmp(text + n, "//", 2) == 0 ? n + 2
           : strncmp(text + n, "% ", 2) == 0 ? n + 2
                                             : 0;
}

size_t table_fields(const table_scanner *c, size_t line, char *fields[IMPORT_COLUMNS]) {
    const char *from = c->text->lines[line];
    size_t sign = comment_sign(from);
    strcpy(c->scratch, from + sign + (sign ? strspn(from + sign, " ") : 0));
    return import_split(c->scratch, c->dialect.separator, fields);
}

bool table_is_number(const table_scanner *c, const char *field) {
    double x;
    bool dated;
    return import_number(field, &c->dialect, &x) || import_clock(field, &x, &dated);
}

/* Joins bracketed words to the name before: "Time (s)" between blanks. */
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

/* Splits at two or more blanks names that contain single blanks. */
static size_t split_wide(const table_scanner *c, size_t line, char *fields[IMPORT_COLUMNS]) {
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

/* Splits a line of names, by another separator if only that gives the width of the table. A key before them,
 * "columns:", is not a name. */
static size_t names_of(const table_scanner *c, size_t line, size_t width, char *fields[IMPORT_COLUMNS]) {
    static const char others[] = "\t;,";
    size_t n = table_fields(c, line, fields);
    if (c->dialect.separator == ' ' && n != width) {
        n = join_brackets(fields, n);
        for (const char *sign = others; n != width && n != width + 1 && *sign; sign++) {
            table_scanner other = *c;
            other.dialect.separator = *sign;
            n = table_fields(&other, line, fields);
        }
        n = n == width || n == width + 1 ? n : split_wide(c, line, fields);
        n = n == width || n == width + 1 ? n : join_brackets(fields, table_fields(c, line, fields));
    }
    if (n == width + 1 && *fields[0] && fields[0][strlen(fields[0]) - 1] == ':') {
        memmove(fields, fields + 1, width * sizeof *fields);
        n = width;
    }
    return n;
}

int table_roles(char *const *fields, size_t n) {
    bool seen[ROLES] = {false};
    for (size_t j = 0; j < n; j++) {
        const import_unit *unit = import_unit_of_name(fields[j]);
        for (int role = 0; role < ROLES && *fields[j]; role++)
            seen[role] = seen[role] || import_name_rank(fields[j], unit, role) > 0;
    }
    return seen[TIME] + (seen[DEPTH] || seen[STRAIN]) + (seen[FORCE] || seen[STRESS]);
}

/* Whether all fields are units, in brackets or not, or empty, with at least one unit. */
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

/* "Units: s N mm", "Y_Unit_Label": a line of units that says so, wherever it stands above the names. */
static bool is_unit_label(const char *field) {
    char plain[IMPORT_WORD];
    import_plain(field, true, plain, sizeof plain);
    return strstr(plain, "unit") || strstr(plain, "einheit") || strstr(plain, "unidad");
}

static size_t labelled_units(const table_scanner *c, const table_block *b) {
    char *fields[IMPORT_COLUMNS];
    for (size_t line = b->names; line != IMPORT_NONE && line > c->begin; line--) {
        size_t n = table_fields(c, line - 1, fields);
        if (n > 1 && 2 * n > b->width && is_unit_label(fields[0]) && are_units(fields + 1, n - 1))
            return line - 1;
    }
    return IMPORT_NONE;
}

static bool has_number(const table_scanner *c, char *const *fields, size_t n) {
    for (size_t j = 0; j < n; j++)
        if (table_is_number(c, fields[j]))
            return true;
    return false;
}

/* The lowest of the lines above the rows with the most names of time, depth and force; else the lowest line
 * with a text for most columns. */
void table_find_names(const table_scanner *c, table_block *b) {
    char *fields[IMPORT_COLUMNS];
    size_t other = IMPORT_NONE, seen = 0;
    b->names = b->units = IMPORT_NONE;
    for (size_t line = b->first; line > b->above && seen < ABOVE; line--) {
        size_t n = names_of(c, line - 1, b->width, fields);
        seen += n > 0;
        if (n < 2 || 2 * n <= b->width || has_number(c, fields, n))
            continue;
        if (are_units(fields, n)) {
            b->units = b->units == IMPORT_NONE && other == IMPORT_NONE ? line - 1 : b->units;
            continue;
        }
        int roles = table_roles(fields, n);
        if (roles > b->roles && roles >= 2) {
            b->names = line - 1;
            b->roles = roles;
        }
        other = other == IMPORT_NONE && n <= b->width + 1 && seen <= NEAR ? line - 1 : other;
    }
    b->names = b->names == IMPORT_NONE ? other : b->names;
    if (b->units != IMPORT_NONE && b->names != IMPORT_NONE && b->units < b->names)
        b->units = IMPORT_NONE;
    b->units = b->units == IMPORT_NONE ? labelled_units(c, b) : b->units;
}

/* "Sig1 Time (min)", "Column 2: Force (N)": a line for each column. */
static bool name_of_column(char *text, size_t *column, char **name) {
    size_t n = 0;
    while (isalpha((unsigned char)text[n]))
        n++;
    size_t at = n + strspn(text + n, " ");
    if (n == 0 || !isdigit((unsigned char)text[at]))
        return false;
    *column = strtoul(text + at, name, 10);
    *name += strspn(*name, " \t:=-,;");
    return **name != '\0' && *column >= 1;
}

static void list_names(const table_scanner *c, const table_block *b, import_source *s) {
    for (size_t line = b->above; line < b->first; line++) {
        char *name;
        size_t column;
        strcpy(c->scratch, c->text->lines[line] + strspn(c->text->lines[line], "# "));
        if (name_of_column(c->scratch, &column, &name) && column <= s->n_columns &&
            isalpha((unsigned char)*name))
            import_copy_word(s->column[column - 1], name, strlen(name));
    }
}

static void add_unit(char name[IMPORT_WORD], const char *unit) {
    size_t have = strlen(name), n = strlen(unit);
    bool bracketed = *unit == '(' || *unit == '[';
    if (n > 0 && have + n + 4 < IMPORT_WORD)
        snprintf(name + have, IMPORT_WORD - have, bracketed ? " %s" : " (%s)", unit);
}

void table_set_columns(const table_scanner *c, const table_block *b, import_source *s) {
    char *fields[IMPORT_COLUMNS];
    size_t n = b->names == IMPORT_NONE ? 0 : names_of(c, b->names, b->width, fields);
    import_set_names(s, fields, n);
    s->n_columns = n < b->width ? b->width : n; /* other columns have no name */
    if (b->roles < 2)
        list_names(c, b, s);
    n = b->units == IMPORT_NONE ? 0 : names_of(c, b->units, b->width, fields);
    size_t label = n > 0 && is_unit_label(fields[0]), more = label && n == s->n_columns + 1;
    for (size_t j = label; j < n && j - more < s->n_columns; j++)
        add_unit(s->column[j - more], fields[j]);
}

/* Units behind the numbers: "5.0 mm". */
void table_add_units(const table_scanner *c, size_t line, import_source *s) {
    char *fields[IMPORT_COLUMNS];
    size_t n = table_fields(c, line, fields);
    for (size_t j = 0; j < n && j < s->n_columns; j++) {
        const char *rest;
        double x;
        bool number = import_number_unit(fields[j], &c->dialect, &x, &rest);
        rest += number ? strspn(rest, " ") : 0;
        if (number && *rest && import_unit_any(rest) && !import_unit_of_name(s->column[j]))
            add_unit(s->column[j], rest);
    }
}
