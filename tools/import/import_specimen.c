/* import_specimen.c: what was pressed and when: from the file's settings and the options. */
#define _POSIX_C_SOURCE 200809L
#include "import.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const char NAME[] = "import";
static const double PI = 3.14159265358979323846;

/* A setting in mm, mm2, N/m, Hz ...: by the unit after the number, else in the key, else this default. */
static bool setting_value(const import_source *s, size_t i, import_dimension dimension, double *value) {
    const import_dialect *d = &s->dialect,
                         swapped = {d->separator, d->decimal == '.' ? ',' : '.', d->decimal};
    const char *text = s->setting[i][1], *rest;
    bool number = import_number_unit(text, d, value, &rest) && *rest != '.' && *rest != ',';
    if (!number && !import_number_unit(text, &swapped, value, &rest)) { /* header and rows differ */
        return false;
    }
    const import_unit *unit = import_unit_find(rest + strspn(rest, " "));
    unit = unit ? unit : import_unit_of_name(s->setting[i][0]);
    *value *= unit && unit->dimension == dimension ? unit->factor : 1;
    return *value > 0 && (!unit || unit->dimension == dimension);
}

double import_part(const import_source *s, int part, const char **key) {
    static const import_dimension of[PARTS] = {UNIT_LENGTH, UNIT_LENGTH, UNIT_LENGTH, UNIT_AREA,
                                               UNIT_SPRING, UNIT_SLOPE,  UNIT_RATE,   UNIT_TIME,
                                               UNIT_LENGTH, UNIT_LENGTH};
    int best = 0;
    double found = 0, value;
    for (size_t i = 0; i < s->n_settings; i++) {
        int rank = import_part_rank(s->setting[i][0], part);
        if (rank > best && setting_value(s, i, of[part], &value)) {
            best = rank;
            found = value;
            *key = s->setting[i][0];
        }
    }
    return found;
}

/* "Size: 10.0 24.0": length and diameter, mm, as some rheometers write it. */
static void use_size(import_source *s) {
    const char *size = import_setting(s, "Size"), *rest;
    double length, diameter;
    if (size && import_number_unit(size, &s->dialect, &length, &rest) && *rest == ' ' &&
        import_number_unit(rest + strspn(rest, " "), &s->dialect, &diameter, &rest) && length > 0 &&
        diameter > 0 &&
        !(*rest && import_number_unit(rest + strspn(rest, " "), &s->dialect, &diameter, &rest))) {
        s->height_mm = s->height_mm > 0 ? s->height_mm : length;
        s->height_from = s->height_from ? s->height_from : "Size";
        s->radius_mm = s->radius_mm > 0 ? s->radius_mm : diameter / 2;
        s->radius_from = s->radius_from ? s->radius_from : "Size";
    }
}

/* The start, by a setting that is a date or a time of day. */
static void find_stamp(import_source *s) {
    static const char *const words[] = {"date",      "time",      "datum",    "zeit",    "fecha", "data",
                                        "hora",      "heure",     "ora",      "beginn",  "start", "started",
                                        "test date", "test time", "run date", "recorded"};
    double date = NAN, time = NAN;
    for (size_t i = 0; i < s->n_settings; i++) {
        char key[IMPORT_WORD];
        double seconds;
        bool dated;
        import_plain(s->setting[i][0], true, key, sizeof key);
        size_t k = 0, n = sizeof words / sizeof *words;
        while (k < n && !strstr(key, words[k]))
            k++;
        if (k == n || !import_clock(s->setting[i][1], &seconds, &dated))
            continue;
        date = dated && isnan(date) ? seconds : date;
        time = !dated && isnan(time) ? seconds : time;
    }
    s->stamp_dated = isfinite(date);
    s->stamp_s = isfinite(date) ? date + (isfinite(time) && fmod(date, 86400) == 0 ? time : 0) : time;
}

void import_specimen(const import_options *o, import_source *s) {
    const char *key = NULL;
    s->height_mm = import_part(s, PART_HEIGHT, &key);
    s->height_from = key;
    key = NULL;
    double diameter = import_part(s, PART_DIAMETER, &key),
           radius = diameter > 0 ? 0 : import_part(s, PART_RADIUS, &key);
    double area = diameter + radius > 0 ? 0 : import_part(s, PART_AREA, &key);
    s->radius_mm = diameter > 0 ? diameter / 2 : radius > 0 ? radius : sqrt(area / PI);
    s->radius_from = key;
    use_size(s);
    s->spring_N_m = o->spring_N_m > 0 ? o->spring_N_m : import_part(s, PART_SPRING, &key);
    s->slope_mm_V = import_part(s, PART_SENSITIVITY, &key);
    for (size_t i = 0; i < s->n_settings; i++) { /* a sensitivity without a unit is in m/V */
        bool slope = strcmp(s->setting[i][0], "sensitivity") == 0 && !import_unit_of_name(s->setting[i][1]);
        s->slope_mm_V *= slope ? 1e3 : 1;
    }
    if (o->height_mm > 0) {
        s->height_mm = o->height_mm;
        s->height_from = "--specimen-height-mm";
    }
    if (o->radius_mm > 0 || o->area_mm2 > 0) {
        s->radius_mm = o->radius_mm > 0 ? o->radius_mm : sqrt(o->area_mm2 / PI);
        s->radius_from = o->radius_mm > 0 ? "--specimen-radius-mm" : "--specimen-area-mm2";
    }
    find_stamp(s);
}

int import_specimen_check(const import_options *o, const import_source *s) {
    double deepest_mm = s->depth_mm[0];
    for (size_t i = 0; i < s->rows; i++)
        deepest_mm = fmax(deepest_mm, s->depth_mm[i]);
    if (o->kind && strcmp(o->kind, "none") == 0)
        return CLI_OK;
    if (s->height_mm <= 0)
        return cli_failure(NAME, "%s: has no height of the specimen; give --specimen-height-mm", s->file);
    if (deepest_mm >= s->height_mm && import_is_stretch(s))
        cli_warning(NAME,
                    "%s: stretched to %.4g times its height; other commands do not fit tension beyond 2",
                    s->file, 1 + deepest_mm / s->height_mm);
    else if (deepest_mm >= s->height_mm)
        return cli_failure(
            NAME,
            "%s: the depth of %.4g mm exceeds the specimen's height of %.4g mm; check unit, sign "
            "and --specimen-height-mm",
            s->file, deepest_mm, s->height_mm);
    return CLI_OK;
}

/* Start by the time at which the file was closed, for files without a time stamp. */
static double file_time(const import_source *s) {
    struct stat about;
    double length = s->rows ? s->time_s[s->rows - 1] - s->time_s[0] : 0;
    return stat(s->file, &about) ? NAN : (double)about.st_mtime - length;
}

static int by_start(const void *a, const void *b) {
    const import_source *x = *(import_source *const *)a, *y = *(import_source *const *)b;
    return x->start_s < y->start_s ? -1 : x->start_s > y->start_s ? 1 : strcmp(x->name, y->name);
}

int import_session(const import_options *o, import_sources *all) {
    double first = HUGE_VAL, began = NAN, day;
    bool dated = true, told = true, begun_dated = false;
    if (!o->session && !o->folder)
        return CLI_OK;
    for (size_t i = 0; i < all->n; i++) {
        told = told && isfinite(all->source[i]->stamp_s);
        dated = dated && all->source[i]->stamp_dated;
    }
    if (o->session && !import_clock(o->session, &began, &begun_dated))
        return cli_usage_error(NAME,
                               "--session-start must be a date and time, or a time of day, such as "
                               "2024-03-01T10:00:00, not \"%s\"",
                               o->session);
    for (size_t i = 0; i < all->n; i++) {
        import_source *s = all->source[i];
        day = told && !(dated && (begun_dated || !o->session)) ? 86400 : 0; /* compare the time of day only */
        s->start_s = told ? s->stamp_s : file_time(s);
        s->start_s = day > 0 && s->start_s > day ? fmod(s->start_s, day) : s->start_s;
        first = fmin(first, s->start_s);
    }
    if (o->session && !told)
        return cli_failure(NAME, "--session-start needs the time of its start in every file");
    began = isfinite(began) ? (dated && begun_dated ? began : fmod(began, 86400)) : first;
    if (!told)
        cli_warning(
            NAME,
            "not every file has the time of its start: runs are ordered by when the files were written");
    for (size_t i = 0; i < all->n; i++) {
        all->source[i]->start_s -= began;
        if (all->source[i]->start_s < 0)
            return cli_failure(NAME, "%s: began %.0f s before --session-start", all->source[i]->file,
                               -all->source[i]->start_s);
    }
    qsort(all->source, all->n, sizeof *all->source, by_start);
    return CLI_OK;
}
