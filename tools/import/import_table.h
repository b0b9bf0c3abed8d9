/* import_table.h: the state of the search for tables in the lines of a text. */
#ifndef PALPATE_IMPORT_TABLE_H
#define PALPATE_IMPORT_TABLE_H

#include "import.h"

/* Rows of equal width, and the lines above them that belong to no table before. */
typedef struct table_block {
    size_t above, first, last; /* lines, from 0; last = after the last row */
    size_t width, rows;
    size_t names, units; /* lines; IMPORT_NONE = there is none */
    int roles;           /* number of names of time, depth and force */
} table_block;

typedef struct table_scanner {
    const import_text *text;
    import_dialect dialect;
    size_t begin; /* the first line that counts */
    char *scratch, *scratch2;
    size_t n, capacity;
    table_block *blocks;
} table_scanner;

/* A line's fields, without a comment sign before them; they stay until the next call. */
size_t table_fields(const table_scanner *c, size_t line, char *fields[IMPORT_COLUMNS]);
bool table_is_number(const table_scanner *c, const char *field); /* or a clock time */

/* Number of fields that name time, depth or force. */
int table_roles(char *const *fields, size_t n);

/* Groups of columns that repeat from a column on, a specimen each; n = 1: none. */
typedef struct import_groups {
    size_t n, from, width;
} import_groups;

import_groups import_groups_find(import_source *s, bool timed); /* timed: the rate of sampling is known */
int import_groups_take(const import_source *all, const import_groups *g, size_t group, import_source *to);

/* Finds the lines with the names and units of the block's columns; then sets the columns of a source, and
 * units after the numbers of a row. */
void table_find_names(const table_scanner *c, table_block *b);
void table_set_columns(const table_scanner *c, const table_block *b, import_source *s);
void table_add_units(const table_scanner *c, size_t line, import_source *s);

#endif
