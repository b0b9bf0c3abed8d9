/* import_groups.c: specimens side by side in one table: groups of columns that repeat, and one source made of
 * each. */
#include "import_table.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

enum { SHARED = 2 }; /* most columns before the groups that belong to all: a row number, the time */

/* The name without the number of its specimen: "Force (N) Run #1" and "Force (N) Run #2" are equal. */
static void bare_name(const char *name, char to[IMPORT_WORD]) {
    size_t n = 0;
    import_plain(name, true, to, IMPORT_WORD);
    for (const char *from = to; *from; from++)
        if (!isdigit((unsigned char)*from))
            to[n++] = *from;
    to[n] = '\0';
}

/* Whether each column from a place on has the name of the one a period before. */
static bool repeats(const import_source *s, size_t from, size_t width) {
    char a[IMPORT_WORD], b[IMPORT_WORD];
    for (size_t j = from + width; j < s->n_columns; j++) {
        bare_name(s->column[j - width], a);
        bare_name(s->column[j], b);
        if (strcmp(a, b) != 0)
            return false;
    }
    size_t rest = (s->n_columns - from) % width;
    for (size_t j = from + rest; rest > 0 && j < from + width;
         j++) /* the last group may lack an empty column at its end */
        if (*s->column[j])
            return false;
    return true;
}

/* Whether columns name depth and force, and a time (which a rate can replace), counting those before the
 * groups. */
static bool whole_group(import_source *s, size_t from, size_t width, bool timed) {
    char *fields[IMPORT_COLUMNS], time[] = "time";
    size_t n = 0;
    for (size_t j = 0; j < from + width; j++)
        fields[n++] = s->column[j];
    int shared = table_roles(fields, from), group = table_roles(fields + from, width);
    if (timed && n < IMPORT_COLUMNS)
        fields[n++] = time;
    return table_roles(fields, n) == QUANTITIES &&
           (group == QUANTITIES || (group == QUANTITIES - 1 && (shared == 1 || timed)));
}

import_groups import_groups_find(import_source *s, bool timed) {
    for (size_t from = 0; from <= SHARED; from++)
        for (size_t width = 2; from + 2 * width <= s->n_columns + 1; width++)
            if (repeats(s, from, width) && whole_group(s, from, width, timed))
                return (import_groups){(s->n_columns - from + width - 1) / width, from, width};
    return (import_groups){1, 0, s->n_columns};
}

/* Index in the whole table of a group's column. */
static size_t place(const import_groups *g, size_t group, size_t column) {
    return column < g->from ? column : column + group * g->width;
}

static bool any_number(const import_source *s, const import_groups *g, size_t group, size_t row) {
    for (size_t j = 0; j < g->width; j++) {
        size_t at = place(g, group, g->from + j);
        if (at < s->n_columns && isfinite(s->value[row * s->n_columns + at]))
            return true;
    }
    return false;
}

int import_groups_take(const import_source *all, const import_groups *g, size_t group, import_source *to) {
    to->dialect = all->dialect;
    to->n_columns = g->from + g->width;
    to->group = group + 1;
    to->groups = g->n;
    for (size_t j = 0; j < to->n_columns; j++) {
        size_t at = place(g, group, j);
        memcpy(to->column[j], at < all->n_columns ? all->column[at] : "",
               at < all->n_columns ? IMPORT_WORD : 1);
        to->clock[j] = at < all->n_columns && all->clock[at];
    }
    for (size_t i = 0; i < all->rows; i++) {
        double *row = any_number(all, g, group, i) ? import_new_row(to, all->line[i]) : NULL;
        if (!row && any_number(all, g, group, i))
            return cli_failure("import", "%s: out of memory", all->file);
        for (size_t j = 0; row && j < to->n_columns; j++) {
            size_t at = place(g, group, j);
            row[j] = at < all->n_columns ? all->value[i * all->n_columns + at] : NAN;
        }
    }
    return CLI_OK;
}
