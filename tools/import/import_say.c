/* import_say.c: one table on stderr of what was understood of each file, and notes of what was left out. */
#include "import.h"

#include <math.h>
#include <string.h>

enum { FIELDS = 7, WIDEST = 60 };

typedef struct row {
    char field[FIELDS][WIDEST];
} row;

static const char *const titles[FIELDS] = {"run", "samples", "time", "depth", "force", "contact", "phases"};

/* Width of a text on the screen. */
static size_t width_of(const char *text) {
    size_t n = 0;
    for (; *text; text++)
        n += ((unsigned char)*text & 0xC0) != 0x80;
    return n;
}

/* Column number, name without unit, unit, and whether the sign changed. */
static void say_column(const import_source *s, int role, bool reversed, char to[WIDEST]) {
    size_t column = s->used[role];
    char name[24];
    size_t n = strcspn(s->column[column], "([");
    n = n < sizeof name ? n : sizeof name - 1;
    while (n > 0 && (s->column[column][n - 1] == ' ' || ((unsigned char)s->column[column][n] & 0xC0) == 0x80))
        n--;
    memcpy(name, s->column[column], n);
    name[n] = '\0';
    snprintf(to, WIDEST, "%zu %s%s%.9s%s", column + 1, name, n ? ", " : "", s->unit[role]->name,
             reversed ? ", reversed" : "");
}

static void fill(const import_source *s, row *r) {
    snprintf(r->field[0], WIDEST, "%.40s", s->name);
    palp_text_make_plain(r->field[0]); /* before its width is asked for */
    snprintf(r->field[1], WIDEST, "%zu", s->rows);
    say_column(s, TIME, false, r->field[2]);
    say_column(s, s->role[DEPTH], s->depth_sign < 0, r->field[3]);
    say_column(s, s->role[FORCE], s->force_sign < 0, r->field[4]);
    snprintf(r->field[5], WIDEST, "%s at %.5g +- %.2g mm, %.3g N", s->contact_rule, s->contact_mm,
             s->contact_sd_mm, s->zero_N);
    snprintf(r->field[6], WIDEST, "%.59s", *s->phases ? s->phases : s->protocol);
}

static void print_row(const row *r, const size_t width[FIELDS]) {
    char line[FIELDS * 2 * WIDEST];
    size_t n = 0;
    for (size_t k = 0; k < FIELDS; k++) {
        size_t pad = k + 1 < FIELDS ? width[k] + 2 - width_of(r->field[k]) : 0;
        n += (size_t)snprintf(line + n, sizeof line - n, "%s%*s", r->field[k], (int)pad, "");
    }
    cli_say(stderr, "%s", line);
}

static void note(const import_source *s) {
    if (s->bad > 0)
        cli_warning("import", "%s: left out %zu of %zu rows that are not numbers, the first at line %zu",
                    s->name, s->bad, s->bad + s->doubled + s->rows, s->bad_line);
    if (s->doubled > 0)
        cli_warning("import",
                    "%s: left out %zu of %zu rows whose time does not increase, the first at line %zu",
                    s->name, s->doubled, s->bad + s->doubled + s->rows, s->doubled_line);
    if (20 * s->lost > s->rows)
        cli_warning("import",
                    "%s: %zu samples are missing (%.2g %% of all, at a sampling interval of %.4g s)", s->name,
                    s->lost, 100.0 * (double)s->lost / (double)(s->lost + s->rows), s->step_s);
    if (s->restarts > 0)
        cli_warning("import",
                    "%s: the clock restarts %zu time%s within the run; its times were made continuous",
                    s->name, s->restarts, s->restarts > 1 ? "s" : "");
    if (s->tip && s->tip_radius_mm > 0)
        cli_note("import", "%s: the tip is a %s, radius %.5g mm", s->name, s->tip, s->tip_radius_mm);
    if (s->groups > 1 && s->group == 1)
        cli_note("import",
                 "%s: the columns of %s repeat, so %zu specimens become a run each; choose one by --map "
                 "time=NUMBER,depth=NUMBER,force=NUMBER",
                 s->name, cli_base(s->file), s->groups);
    if (s->seconds_assumed)
        cli_warning("import", "%s: the time has no unit and is taken as seconds; --units time=ms changes it",
                    s->name);
    if (s->height_from && strncmp(s->height_from, "--", 2) != 0) {
        char radius[2 * IMPORT_WORD] = "";
        if (s->radius_mm > 0 && s->radius_from)
            snprintf(radius, sizeof radius, ", radius %.5g mm from \"%s\"", s->radius_mm, s->radius_from);
        cli_note("import", "%s: height %.5g mm from \"%s\"%s", s->name, s->height_mm, s->height_from, radius);
    }
}

void import_say(const import_sources *all) {
    row head, one;
    size_t width[FIELDS];
    for (size_t k = 0; k < FIELDS; k++) {
        snprintf(head.field[k], WIDEST, "%s", titles[k]);
        width[k] = width_of(head.field[k]);
    }
    for (size_t i = 0; i < all->n; i++) {
        if (!all->source[i]->skip) {
            fill(all->source[i], &one);
            for (size_t k = 0; k < FIELDS; k++) {
                size_t n = width_of(one.field[k]);
                width[k] = n > width[k] ? n : width[k];
            }
        }
    }
    print_row(&head, width);
    for (size_t i = 0; i < all->n; i++) {
        if (!all->source[i]->skip) {
            fill(all->source[i], &one);
            print_row(&one, width);
        }
    }
    for (size_t i = 0; i < all->n; i++)
        if (!all->source[i]->skip)
            note(all->source[i]);
}
