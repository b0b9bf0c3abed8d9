/* import_rows.c: the rows of a table as a recording in s, mm and N: lines that are no rows are left out,
 * continued tables are joined. */
#include "import.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "import";
static const char *const quantities[] = {"time", "depth", "force"};

/* share of the travel within which a part starts at the end of the one before */
static const double GOES_ON = 0.05;

static double *cell(const import_source *s, size_t i, size_t column) {
    return &s->value[i * s->n_columns + column];
}

static size_t used_for(const import_source *s, int quantity) {
    return s->used[s->role[quantity]];
}

static double range_of(const import_source *s, size_t column) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (size_t i = 0; i < s->rows; i++) {
        double x = *cell(s, i, column);
        low = isfinite(x) ? fmin(low, x) : low;
        high = isfinite(x) ? fmax(high, x) : high;
    }
    return high - low;
}

/* Whether b continues a: its time continues or restarts, and the plate is where it was. If the time restarts
 * at the place where a began, b is another specimen. */
static bool goes_on(const import_source *a, const import_source *b) {
    size_t time = used_for(a, TIME), depth = used_for(a, DEPTH);
    double within = GOES_ON * fmax(range_of(a, depth), range_of(b, depth));
    double last = *cell(a, a->rows - 1, depth), first = *cell(b, 0, depth), began = *cell(a, 0, depth);
    if (!(fabs(first - last) <= within))
        return false;
    return *cell(b, 0, time) >= *cell(a, a->rows - 1, time) || fabs(first - began) > within;
}

static bool append_rows(import_source *a, const import_source *b) {
    size_t rows = a->rows + b->rows;
    double *value = realloc(a->value, rows * a->n_columns * sizeof *value);
    a->value = value ? value : a->value;
    size_t *line = value ? realloc(a->line, rows * sizeof *line) : NULL;
    a->line = line ? line : a->line;
    if (!line)
        return false;
    memcpy(a->value + a->rows * a->n_columns, b->value, b->rows * b->n_columns * sizeof *value);
    memcpy(a->line + a->rows, b->line, b->rows * sizeof *line);
    a->rows = a->capacity = rows;
    a->segments++;
    return true;
}

/* Numbers the tables that were not joined. */
static void number_names(import_sources *all, size_t first) {
    for (size_t i = first; all->n - first > 1 && i < all->n; i++) {
        char *name = all->source[i]->name;
        size_t n = strlen(name);
        n = n + 8 < IMPORT_NAME ? n : IMPORT_NAME - 8;
        snprintf(name + n, 8, "_%02u", (unsigned)((i - first + 1) % 10000));
    }
}

int import_join(const import_options *o, import_sources *all, size_t first) {
    size_t kept = first;
    for (size_t i = first; i < all->n; i++) {
        import_source *s = all->source[i], *before = i > first ? all->source[kept - 1] : NULL;
        bool whole = before && import_columns_find(o, s, true) == CLI_OK &&
                     import_columns_find(o, before, true) == CLI_OK;
        if (whole && goes_on(before, s)) {
            bool good = append_rows(before, s);
            free(s->value);
            free(s->line);
            free(s);
            if (!good) {
                memmove(all->source + kept, all->source + i + 1, (all->n - i - 1) * sizeof *all->source);
                all->n -= i + 1 - kept;
                return cli_failure(NAME, "%s: out of memory", before->file);
            }
        } else {
            all->source[kept++] = s;
        }
    }
    all->n = kept;
    number_names(all, first);
    return CLI_OK;
}

static int refuse_bad(const import_source *s, size_t i) {
    for (int q = 0; q < QUANTITIES; q++) {
        size_t column = used_for(s, q);
        if (!isfinite(*cell(s, i, column)))
            return cli_failure(NAME, "%s:%zu: the %s (column %zu) is not a number", s->file, s->line[i],
                               quantities[q], column + 1);
    }
    return CLI_OK;
}

static bool whole(const import_source *s, size_t i) {
    for (int q = 0; q < QUANTITIES; q++)
        if (!isfinite(*cell(s, i, used_for(s, q))))
            return false;
    return true;
}

/* Whether a clock restarts: the rows after this one rise, but stay below the last time. */
static bool restarts(const import_source *s, size_t i, double last) {
    enum { ROWS = 4 };
    size_t time = used_for(s, TIME), seen = 0;
    double before = -HUGE_VAL;
    for (; i < s->rows && seen < ROWS; i++) {
        double t = *cell(s, i, time);
        if (!isfinite(t))
            continue;
        if (t >= last || t < before)
            return false;
        before = t;
        seen++;
    }
    return seen == ROWS;
}

static void keep(import_source *s, size_t i, size_t to) {
    memmove(cell(s, to, 0), cell(s, i, 0), s->n_columns * sizeof *s->value);
    s->line[to] = s->line[i];
}

/* Removes and counts rows without a number, and rows that repeat a time. */
static int sift(const import_options *o, import_source *s) {
    size_t time = used_for(s, TIME), kept = 0;
    double clock = 0, last = -HUGE_VAL, step = 0;
    for (size_t i = 0; i < s->rows; i++) {
        if (!whole(s, i)) {
            if (o->strict)
                return refuse_bad(s, i);
            s->bad_line = s->bad++ ? s->bad_line : s->line[i];
            continue;
        }
        double t = *cell(s, i, time) + clock;
        if (t < last && restarts(s, i, last - clock)) {
            clock += last + step - t;
            t = last + step;
            s->restarts++;
        }
        if (!(t > last)) {
            if (o->strict)
                return cli_failure(NAME, "%s:%zu: time does not increase (%.9g after %.9g)", s->file,
                                   s->line[i], t, last);
            s->doubled_line = s->doubled++ ? s->doubled_line : s->line[i];
            continue;
        }
        step = isfinite(last) ? t - last : step;
        last = t;
        keep(s, i, kept);
        *cell(s, kept++, time) = t;
    }
    s->rows = kept;
    return CLI_OK;
}

bool import_is_stretch(const import_source *s) {
    return s->role[DEPTH] == STRAIN && (strcmp(s->unit[STRAIN]->name, "stretch") == 0 ||
                                        strstr(s->column[s->used[STRAIN]], "tretch") != NULL);
}

/* Factor from the unit of the column in use to s, mm or N. */
static double factor_of(const import_source *s, int q, double *offset) {
    double area_m2 = 3.14159265358979323846 * s->radius_mm * s->radius_mm * 1e-6;
    const import_unit *unit = s->unit[s->role[q]];
    *offset = 0;
    switch (s->role[q]) {
    case STRAIN:
        *offset = import_is_stretch(s) ? 1 / unit->factor : 0; /* of no strain */
        return unit->factor * s->height_mm;
    case STRESS:
        return unit->factor * area_m2;
    case DEFLECTION:
        return unit->factor * (unit->dimension == UNIT_VOLT ? s->slope_mm_V : 1) * 1e-3 * s->spring_N_m;
    default:
        return unit->factor;
    }
}

double import_digits(double x, double size) {
    char text[48];
    if (x == 0 || size == 0 || !isfinite(x))
        return x;
    double power = floor(log10(size)), scale = pow(10, 14 - power);
    if (scale >= 1 && scale <= 1e22) { /* powers of ten that are exact */
        return rint(x * scale) / scale;
    }
    int digits = (int)(14 - power + floor(log10(fabs(x))));
    snprintf(text, sizeof text, "%.*e", digits < 0 ? 0 : digits > 17 ? 17 : digits, x);
    return digits < -1 ? 0 : strtod(text, NULL);
}

static double scaled(double x, double factor) {
    return factor == 1 ? x : import_digits(factor * x, fabs(factor * x));
}

static int fill(import_source *s, int q, double *to) {
    double offset, factor = factor_of(s, q, &offset);
    size_t column = used_for(s, q);
    for (size_t i = 0; i < s->rows; i++) {
        to[i] = scaled(*cell(s, i, column) - offset, factor);
        if (!isfinite(to[i]))
            return cli_failure(NAME, "%s:%zu: the %s (column %zu) is too large", s->file, s->line[i],
                               quantities[q], column + 1);
    }
    return CLI_OK;
}

/* Makes clock times relative to the first row. */
static void start_clock(import_source *s) {
    size_t time = used_for(s, TIME);
    if (s->clock[time] && s->rows > 0) {
        double first = *cell(s, 0, time);
        s->stamp_dated = s->stamp_dated || first > 400 * 86400.0;
        s->stamp_s = isfinite(s->stamp_s) && first < 400 * 86400.0 ? s->stamp_s : first;
        for (size_t i = 0; i < s->rows; i++)
            *cell(s, i, time) = rint(1e6 * (*cell(s, i, time) - first)) / 1e6;
    }
}

/* Rows from --from to --to. */
static void crop(const import_options *o, import_source *s) {
    double factor = s->unit[TIME]->factor;
    size_t time = used_for(s, TIME), kept = 0;
    for (size_t i = 0; i < s->rows; i++) {
        double t = scaled(*cell(s, i, time), factor);
        if (!(t < o->from_s) && !(t > o->to_s))
            keep(s, i, kept++);
    }
    s->rows = kept;
}

static int check_sizes(const import_source *s) {
    if (s->used[STRAIN] != IMPORT_NONE && s->height_mm <= 0)
        return cli_failure(NAME, "%s: the depth is given as strain; give --specimen-height-mm", s->file);
    if (s->used[STRESS] != IMPORT_NONE && s->radius_mm <= 0)
        return cli_failure(
            NAME, "%s: the force is given as stress; give --specimen-radius-mm or --specimen-area-mm2",
            s->file);
    if (s->used[DEFLECTION] != IMPORT_NONE && s->unit[DEFLECTION]->dimension == UNIT_VOLT &&
        s->slope_mm_V <= 0)
        return cli_failure(NAME,
                           "%s: the deflection is in volts and the file has no sensitivity (m/V); convert it",
                           s->file);
    return CLI_OK;
}

int import_columns(const import_options *o, import_source *s) {
    double *recording[QUANTITIES] = {NULL};
    if (s->rows < 3 && *s->block) {
        s->skip = "fewer than three rows of numbers";
        return CLI_OK;
    }
    int code = import_columns_find(o, s, false);
    code = code ? code : check_sizes(s);
    code = code ? code : sift(o, s);
    if (code)
        return code;
    start_clock(s);
    crop(o, s);
    if (s->rows < 3) {
        s->skip = "fewer than three rows of numbers";
        return *s->block ? CLI_OK : cli_failure(NAME, "%s: %s", s->file, s->skip);
    }
    for (int q = 0; q < QUANTITIES; q++)
        recording[q] = malloc(s->rows * sizeof(double));
    s->time_s = recording[TIME];
    s->depth_mm = recording[DEPTH];
    s->force_N = recording[FORCE];
    if (!s->time_s || !s->depth_mm || !s->force_N)
        return cli_failure(NAME, "%s: out of memory", s->file);
    for (int q = 0; code == CLI_OK && q < QUANTITIES; q++)
        code = fill(s, q, recording[q]);
    return code;
}
