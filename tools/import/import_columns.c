/* import_columns.c: which column of a file is time, depth and force, and in which unit. */
#include "import.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "import";
static const char *const quantities[] = {"time", "depth", "force"};

/* To s, mm and N. */
static const struct unit {
    int quantity;
    const char *name;
    double factor;
} units[] = {{TIME, "s", 1},
             {TIME, "ms", 1e-3},
             {TIME, "min", 60},
             {TIME, "sec", 1},
             {DEPTH, "mm", 1},
             {DEPTH, "um", 1e-3},
             {DEPTH, "\xC2\xB5m", 1e-3},
             {DEPTH, "\xCE\xBCm", 1e-3},
             {DEPTH, "cm", 10},
             {DEPTH, "m", 1e3},
             {DEPTH, "in", 25.4},
             {FORCE, "N", 1},
             {FORCE, "mN", 1e-3},
             {FORCE, "kN", 1e3},
             {FORCE, "gf", 9.80665e-3},
             {FORCE, "kgf", 9.80665},
             {FORCE, "lbf", 4.4482216152605}};

static const char *const words[QUANTITIES][8] = {
    {"time"},
    {"depth", "compression", "position", "pos_", "displacement", "extension", "indentation", "travel"},
    {"force", "load", "fz"}};

static const struct unit *unit_find(int quantity, const char *name, size_t n) {
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++) {
        if (units[i].quantity == quantity && strlen(units[i].name) == n &&
            memcmp(units[i].name, name, n) == 0) {
            return &units[i];
        }
    }
    return NULL;
}

/* The last word of a column's name that is a unit: "Position (z), mm". */
static const struct unit *unit_of_name(int quantity, const char *name) {
    static const char breaks[] = " ()[],_/";
    const struct unit *found = NULL;
    for (const char *at = name; *at;) {
        size_t n = strcspn(at, breaks);
        const struct unit *u = n ? unit_find(quantity, at, n) : NULL;
        found = u ? u : found;
        at += n;
        at += strspn(at, breaks);
    }
    return found;
}

/* Whether name holds word, in any case. */
static bool holds(const char *name, const char *word) {
    size_t n = strlen(word);
    for (; *name; name++) {
        size_t i = 0;
        while (i < n && tolower((unsigned char)name[i]) == word[i]) {
            i++;
        }
        if (i == n) {
            return true;
        }
    }
    return false;
}

static bool could_be(int quantity, const char *name) {
    for (size_t i = 0; i < 8 && words[quantity][i]; i++) {
        if (holds(name, words[quantity][i])) {
            return quantity != DEPTH || !could_be(FORCE, name);
        }
    }
    return false;
}

/* ---- --map and --units ---- */

/* The value after "quantity=" in a list such as time=1,depth=2; empty if it is not there. */
static void listed(const char *list, int quantity, char value[IMPORT_WORD]) {
    size_t n = strlen(quantities[quantity]);
    value[0] = '\0';
    for (const char *at = list; at;) {
        size_t end = strcspn(at, ",");
        if (strncmp(at, quantities[quantity], n) == 0 && at[n] == '=' && end > n && end - n <= IMPORT_WORD) {
            memcpy(value, at + n + 1, end - n - 1);
            value[end - n - 1] = '\0';
        }
        at = at[end] ? at + end + 1 : NULL;
    }
}

/* By its name, else by its number from 1. */
static int find_named(import_source *s, int quantity, const char *wanted) {
    double number;
    for (size_t j = 0; j < s->n_columns; j++) {
        if (strcmp(s->column[j], wanted) == 0) {
            s->used[quantity] = j;
            return CLI_OK;
        }
    }
    if (cli_read_number(wanted, &number) && number >= 1 && number <= (double)s->n_columns &&
        number == floor(number)) {
        s->used[quantity] = (size_t)number - 1;
        return CLI_OK;
    }
    return cli_failure(NAME,
                       "%s: no column \"%s\" of %zu; --map takes a name (without commas) or a number from 1",
                       s->file, wanted, s->n_columns);
}

/* The Mach-1 says which axes it used; else the one column whose name says what it is. */
static int find_column(import_source *s, int quantity) {
    const char *axis = quantity == DEPTH ? import_setting(s, "Stage Axis") : NULL;
    axis = quantity == FORCE ? import_setting(s, "Load Cell Axis") : axis;
    size_t found = s->n_columns;
    for (size_t j = 0; axis && j < s->n_columns; j++) {
        if (strncmp(s->column[j], axis, strlen(axis)) == 0) {
            s->used[quantity] = j;
            return CLI_OK;
        }
    }
    for (size_t j = 0; j < s->n_columns; j++) {
        if (!could_be(quantity, s->column[j])) {
            continue;
        }
        if (found < s->n_columns) {
            return cli_failure(
                NAME, "%s: \"%s\" and \"%s\" could both be the %s; say which by --map %s=NAME or NUMBER",
                s->file, s->column[found], s->column[j], quantities[quantity], quantities[quantity]);
        }
        found = j;
    }
    s->used[quantity] = found;
    return found < s->n_columns
               ? CLI_OK
               : cli_failure(NAME, "%s: no column is named as a %s; say which by --map %s=NAME or NUMBER",
                             s->file, quantities[quantity], quantities[quantity]);
}

static int find_unit(const import_options *o, import_source *s, int quantity, double *factor) {
    const char *column = s->column[s->used[quantity]];
    char wanted[IMPORT_WORD];
    listed(o->units, quantity, wanted);
    const struct unit *u =
        *wanted ? unit_find(quantity, wanted, strlen(wanted)) : unit_of_name(quantity, column);
    if (!u && *wanted) {
        return cli_usage_error(NAME, "--units %s=%s: no such unit of it", quantities[quantity], wanted);
    }
    if (!u) {
        return cli_failure(NAME, "%s: column \"%s\" does not say its unit; say it by --units %s=%s", s->file,
                           column, quantities[quantity],
                           quantity == TIME    ? "s"
                           : quantity == DEPTH ? "mm"
                                               : "N");
    }
    snprintf(s->unit[quantity], sizeof s->unit[quantity], "%s", u->name);
    *factor = u->factor;
    return CLI_OK;
}

/* ---- the recording ---- */

static int fill(import_source *s, int quantity, double factor, double *to) {
    for (size_t i = 0; i < s->rows; i++) {
        to[i] = factor * s->value[i * s->n_columns + s->used[quantity]];
        if (!isfinite(to[i])) {
            return cli_failure(NAME, "%s:%zu: the %s (column %zu) is not a number", s->file, s->line[i],
                               quantities[quantity], s->used[quantity] + 1);
        }
        if (quantity == TIME && i > 0 && !(to[i] > to[i - 1])) {
            return cli_failure(NAME, "%s:%zu: time does not increase (%.9g s after %.9g s)", s->file,
                               s->line[i], to[i], to[i - 1]);
        }
    }
    return CLI_OK;
}

int import_columns(const import_options *o, import_source *s) {
    char wanted[IMPORT_WORD];
    double *recording[QUANTITIES] = {NULL}, factor = 1;
    int code = CLI_OK;
    if (s->rows < 3) {
        s->skip = "fewer than three rows of numbers";
        return *s->block ? CLI_OK : cli_failure(NAME, "%s: %s", s->file, s->skip);
    }
    for (int q = 0; q < QUANTITIES; q++) {
        recording[q] = malloc(s->rows * sizeof(double));
    }
    s->time_s = recording[TIME];
    s->depth_mm = recording[DEPTH];
    s->force_N = recording[FORCE];
    if (!s->time_s || !s->depth_mm || !s->force_N) {
        return cli_failure(NAME, "%s: out of memory", s->file);
    }
    for (int q = 0; code == CLI_OK && q < QUANTITIES; q++) {
        listed(o->map, q, wanted);
        code = *wanted ? find_named(s, q, wanted) : find_column(s, q);
        code = code ? code : find_unit(o, s, q, &factor);
        code = code ? code : fill(s, q, factor, recording[q]);
    }
    return code;
}
