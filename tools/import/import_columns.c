/* import_columns.c: which column of a file is time, depth and force, and in which unit; the recording they
 * make. */
#include "import.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "import";
static const char *const roles[ROLES] = {"time", "depth", "force", "stress", "strain", "deflection"};
static const char *const units_of[QUANTITIES] = {"s", "mm (or um, m, %, stretch, ...)",
                                                 "N (or mN, gf, kPa, ...)"};
static const char *const units_of_stress = "kPa (or Pa, MPa, ...)", *const units_of_strain =
                                                                        "1 (or %, stretch)";

static const double ALIKE = 1e-3; /* share of its range within which two columns are equal */

static double at(const import_source *s, size_t i, size_t column) {
    return s->value[i * s->n_columns + column];
}

/* The value after "role=" in a list such as time=1,depth=2; empty if it is not there. */
static void listed(const char *list, int role, char value[IMPORT_WORD]) {
    size_t n = strlen(roles[role]);
    value[0] = '\0';
    for (const char *from = list; from;) {
        size_t end = strcspn(from, ",");
        if (strncmp(from, roles[role], n) == 0 && from[n] == '=' && end > n && end - n <= IMPORT_WORD) {
            memcpy(value, from + n + 1, end - n - 1);
            value[end - n - 1] = '\0';
        }
        from = from[end] ? from + end + 1 : NULL;
    }
}

/* The columns, for messages: 1 "Time (s)", 2 "Load (N)". */
static void list_columns(const import_source *s, char *to, size_t room) {
    size_t n = 0;
    *to = '\0';
    for (size_t j = 0; j < s->n_columns && n + 16 < room; j++) {
        int more = snprintf(to + n, room - n, "%s%zu%s%.40s%s", j ? ", " : "", j + 1,
                            *s->column[j] ? " \"" : "", s->column[j], *s->column[j] ? "\"" : "");
        n += more > 0 ? (size_t)more : 0;
    }
}

/* Finds a column by its name, else by its number from 1. */
static int find_named(import_source *s, int role, const char *wanted) {
    double number;
    char columns[1024];
    s->listed[role] = true;
    for (size_t j = 0; j < s->n_columns; j++) {
        const char *name = s->column[j], *bracket = strstr(name, " (");
        size_t n = strlen(wanted);
        if (strcmp(name, wanted) == 0 ||
            (bracket && (size_t)(bracket - name) == n && strncmp(name, wanted, n) == 0)) {
            s->used[role] = j;
            return CLI_OK;
        }
    }
    if (cli_read_number(wanted, &number) && number >= 1 && number <= (double)s->n_columns &&
        number == floor(number)) {
        s->used[role] = (size_t)number - 1;
        return CLI_OK;
    }
    list_columns(s, columns, sizeof columns);
    return cli_failure(NAME,
                       "%s: no column \"%s\" for --map %s; give a name (without commas) or number of %s",
                       s->file, wanted, roles[role], columns);
}

typedef struct column_look {
    bool any, changes, falls; /* numbers, from the first, anywhere */
} column_look;

static column_look look_at(const import_source *s, size_t j) {
    column_look look = {false, false, false};
    double first = NAN, before = NAN;
    for (size_t i = 0; i < s->rows; i++) {
        double x = at(s, i, j);
        if (!isfinite(x))
            continue;
        first = look.any ? first : x;
        look.any = true;
        look.changes = look.changes || x != first;
        look.falls = look.falls || x < before;
        before = x;
    }
    return look;
}

static const import_unit *unit_of(const import_source *s, size_t j) {
    const import_unit *unit = import_unit_of_name(s->column[j]);
    return unit || !s->clock[j] ? unit : import_unit_find("s");
}

/* Whether two columns are equal except for a constant and their sign, in their units. */
static bool same_data(const import_source *s, size_t a, size_t b) {
    const import_unit *ua = unit_of(s, a), *ub = unit_of(s, b);
    double fa = ua ? ua->factor : 1, fb = ub ? ub->factor : 1;
    for (double sign = -1; sign <= 1; sign += 2) {
        double low = HUGE_VAL, high = -HUGE_VAL, least = HUGE_VAL, most = -HUGE_VAL;
        for (size_t i = 0; i < s->rows; i++) {
            double x = fa * at(s, i, a), off = x - sign * fb * at(s, i, b);
            if (isfinite(off)) {
                low = fmin(low, x);
                high = fmax(high, x);
                least = fmin(least, off);
                most = fmax(most, off);
            }
        }
        if (most - least <= ALIKE * (high - low))
            return true;
    }
    return false;
}

/* Confidence that a column is a quantity; lower if it is constant, or is a clock that runs backwards. */
static int rank_of(const import_source *s, size_t j, int role) {
    const import_unit *unit = unit_of(s, j);
    int rank = *s->column[j] || s->clock[j] ? import_name_rank(s->column[j], unit, role) : 0;
    bool bent = role == DEPTH && s->spring_N_m > 0 && import_name_rank(s->column[j], unit, DEFLECTION) > 0;
    const column_look look = rank == 0 ? (column_look){false, false, false} : look_at(s, j);
    if (!look.any || bent || (role != TIME && s->clock[j]))
        return 0;
    rank = 4 * rank + (unit && import_unit_fits(unit, role) ? 1 : 0);
    bool odd = role == TIME ? look.falls : !look.changes;
    return odd ? 1 : rank;
}

static int ambiguous(const import_source *s, int role, size_t a, size_t b) {
    char columns[1024];
    list_columns(s, columns, sizeof columns);
    return cli_failure(NAME,
                       "%s: columns %zu \"%s\" and %zu \"%s\" could both be the %s; choose by --map "
                       "%s=NAME or NUMBER of %s",
                       s->file, a + 1, s->column[a], b + 1, s->column[b], roles[role], roles[role], columns);
}

/* A Mach-1 file names its axes; otherwise the most probable column is taken. Two equal columns count as one.
 */
static int find_column(import_source *s, int role, bool quiet) {
    const char *axis = role == DEPTH ? import_setting(s, "Stage Axis") : NULL;
    axis = role == FORCE ? import_setting(s, "Load Cell Axis") : axis;
    int best = 0;
    size_t second = IMPORT_NONE;
    for (size_t j = 0; axis && j < s->n_columns; j++) {
        if (strncmp(s->column[j], axis, strlen(axis)) == 0) {
            s->used[role] = j;
            return CLI_OK;
        }
    }
    for (size_t j = 0; j < s->n_columns; j++) {
        int rank = rank_of(s, j, role);
        if (rank > best) {
            s->used[role] = j;
            best = rank;
            second = IMPORT_NONE;
        } else if (rank == best && best > 0 && second == IMPORT_NONE && !same_data(s, s->used[role], j)) {
            second = j;
        }
    }
    return second == IMPORT_NONE || quiet ? CLI_OK : ambiguous(s, role, s->used[role], second);
}

bool import_has_time(const import_options *o, import_source *s) {
    char wanted[IMPORT_WORD];
    listed(o->map, TIME, wanted);
    s->used[TIME] = IMPORT_NONE;
    return *wanted || (find_column(s, TIME, true) == CLI_OK && s->used[TIME] != IMPORT_NONE);
}

static int find_unit(const import_options *o, import_source *s, int role, int quantity, bool quiet) {
    char wanted[IMPORT_WORD];
    listed(o->units, role, wanted);
    if (!*wanted)
        listed(o->units, quantity, wanted);
    const import_unit *unit = *wanted ? import_unit_find(wanted) : unit_of(s, s->used[role]);
    if (!unit && role == TIME) { /* seconds are nearly always right */
        unit = import_unit_find("s");
        s->seconds_assumed = true;
    }
    s->unit[role] = unit;
    if (*wanted && !(unit && import_unit_fits(unit, role)))
        return cli_usage_error(NAME, "--units %s=%s: not a unit of this quantity", roles[quantity], wanted);
    const char *units = role == STRESS   ? units_of_stress
                        : role == STRAIN ? units_of_strain
                                         : units_of[quantity];
    if (!(unit && import_unit_fits(unit, role)))
        return quiet ? CLI_FAILURE
                     : cli_failure(NAME, "%s: column \"%s\" has no unit; give it by --units %s=%s", s->file,
                                   *s->column[s->used[role]] ? s->column[s->used[role]] : "without a name",
                                   roles[role == STRESS || role == STRAIN ? role : quantity], units);
    return CLI_OK;
}

static int not_there(const import_source *s, int role) {
    char columns[1024];
    list_columns(s, columns, sizeof columns);
    return cli_failure(
        NAME, "%s: no column looks like a %s by its name; choose by --map %s=NAME or NUMBER of %s%s", s->file,
        roles[role], roles[role], columns, role == TIME ? ", or give the sampling rate by --rate HZ" : "");
}

/* Whether another quantity replaces this one: no column has its name, or --units names that one. */
static bool instead(const import_options *o, import_source *s, int quantity, int other) {
    char unit[IMPORT_WORD];
    listed(o->units, quantity, unit);
    const import_unit *u = *unit ? import_unit_find(unit) : NULL;
    if (u && import_unit_fits(u, other)) {
        s->used[other] = s->used[quantity] == IMPORT_NONE ? s->used[other] : s->used[quantity];
        return s->used[other] != IMPORT_NONE;
    }
    return s->used[other] != IMPORT_NONE && s->used[quantity] == IMPORT_NONE;
}

static int find_all(const import_options *o, import_source *s, bool quiet) {
    char wanted[IMPORT_WORD];
    int code = CLI_OK;
    for (int role = 0; code == CLI_OK && role < ROLES; role++) {
        s->used[role] = IMPORT_NONE;
        listed(o->map, role, wanted);
        code = *wanted ? find_named(s, role, wanted) : CLI_OK;
    }
    for (int role = 0; code == CLI_OK && role < ROLES; role++) {
        bool direct = (role == STRESS && s->used[FORCE] != IMPORT_NONE) ||
                      (role == STRAIN && s->used[DEPTH] != IMPORT_NONE);
        if (role == TIME && s->rated)
            s->used[TIME] = s->n_columns - 1;
        else if (!s->listed[role])
            code = find_column(s, role, quiet || role >= QUANTITIES || direct);
    }
    return code;
}

/* Takes depth and force from their own columns, else from strain and stress, or from the deflection of a
 * cantilever. */
static int settle(const import_options *o, import_source *s, bool quiet) {
    int code = CLI_OK;
    if (s->listed[STRAIN] && !s->listed[DEPTH])
        s->used[DEPTH] = IMPORT_NONE;
    if (s->listed[STRESS] && !s->listed[FORCE])
        s->used[FORCE] = IMPORT_NONE;
    bool bent = s->used[FORCE] == IMPORT_NONE && s->used[DEFLECTION] != IMPORT_NONE && s->spring_N_m > 0;
    if (bent && s->used[DEPTH] == s->used[DEFLECTION])
        return quiet ? CLI_FAILURE : not_there(s, DEPTH);
    int *use = s->role;
    use[TIME] = TIME;
    use[DEPTH] = instead(o, s, DEPTH, STRAIN) ? STRAIN : DEPTH;
    use[FORCE] = bent ? DEFLECTION : instead(o, s, FORCE, STRESS) ? STRESS : FORCE;
    for (int q = 0; code == CLI_OK && q < QUANTITIES; q++) {
        if (s->used[use[q]] == IMPORT_NONE)
            return quiet ? CLI_FAILURE : not_there(s, q);
        code = find_unit(o, s, use[q], q, quiet);
    }
    if (code == CLI_OK) {
        char name[IMPORT_WORD];
        const char *depth = s->column[s->used[use[DEPTH]]];
        import_plain(depth, true, name, sizeof name);
        bool bends = bent || strstr(s->column[s->used[use[FORCE]]], "eflection");
        s->gap = use[DEPTH] == DEPTH && import_names_gap(depth);
        s->piezo = bends && !strstr(name, "tip") && !strstr(name, "indent") && !strstr(name, "separation");
    }
    for (int role = 0; role < ROLES; role++)
        if (role != use[DEPTH] && role != use[FORCE] && role != TIME)
            s->used[role] = IMPORT_NONE;
    return code;
}

/* The column of a gap, or of the remaining height, that moves as the depth does; it also gives the height. */
static void prefer_gap(import_source *s) {
    for (size_t j = 0;
         j < s->n_columns && s->height_mm <= 0 && s->used[DEPTH] != IMPORT_NONE && !s->listed[DEPTH]; j++) {
        const import_unit *unit = unit_of(s, j);
        bool length = unit && unit->dimension == UNIT_LENGTH;
        if (length && import_names_gap(s->column[j]) && same_data(s, s->used[DEPTH], j))
            s->used[DEPTH] = j;
    }
}

int import_columns_find(const import_options *o, import_source *s, bool quiet) {
    int code = find_all(o, s, quiet);
    if (code == CLI_OK)
        prefer_gap(s);
    return code ? code : settle(o, s, quiet);
}
