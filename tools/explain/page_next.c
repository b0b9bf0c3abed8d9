/* page_next.c: what to measure next: the run that tells look-alikes apart, drawn. */
#include "page.h"

#include <math.h>
#include <string.h>

enum { POINTS = 128 };

static const double AIR = 2; /* mm: where the indenter waits */

typedef struct path {
    size_t n;
    double time[POINTS], depth[POINTS];
} path;

static void go(path *p, double depth, double seconds) {
    if (p->n < POINTS) {
        p->time[p->n] = p->time[p->n - 1] + seconds;
        p->depth[p->n++] = depth;
    }
}

/* As palpate acquire runs it; false if the run has no speed. */
static bool walk(const json_t *run, path *p) {
    const char *kind = json_text_at(run, "kind");
    double depth = json_number_at(run, "depth_mm"), rate = json_number_at(run, "rate_mm_s"),
           hold = json_number_at(run, "hold_s"), cycles = json_number_at(run, "cycles");
    double top = strcmp(kind, "free") == 0 ? -AIR - depth : depth, way = fabs(top + AIR);
    *p = (path){.n = 1, .depth = {-AIR}};
    if (!(rate > 0))
        return false;
    go(p, -AIR, 1);
    for (int c = 0; c < (cycles > 1 ? (int)cycles : 1); c++) {
        if (c > 0)
            go(p, 0, top / rate);
        go(p, top, (c ? top : way) / rate);
        go(p, top, hold > 0 ? hold : 0);
    }
    go(p, -AIR, way / rate);
    go(p, -AIR, fmax(1, 0.02 * p->time[p->n - 1]));
    return true;
}

static void draw(FILE *to, const json_t *run) {
    path p;
    if (!walk(run, &p))
        return;
    const double ends[2] = {0, p.time[p.n - 1]}, contact[2] = {0, 0};
    const plot_series series[] = {{NULL, PLOT_LINE, PLOT_BLUE, p.n, p.time, p.depth},
                                  {"contact", PLOT_DASHED, PLOT_BLACK, 2, ends, contact}};
    const plot_figure figure = {
        .n_panels = 1,
        .panel = {{.x_label = "time (s)", .y_label = "depth (mm)", .n_series = 2, .series = series}},
        .width = 630,
        .height = 240};
    fputs("<div class=\"figures\">", to);
    html_draw(to, &figure,
              "The next experiment: depth of the plate over time. The protocol file is written by --next, "
              "and run by "
              "palpate acquire --protocol.");
    fputs("</div>\n", to);
}

static void kind_words(const json_t *run, char text[PAGE_LINE]) {
    const char *kind = json_text_at(run, "kind");
    double depth = json_number_at(run, "depth_mm"), rate = json_number_at(run, "rate_mm_s"),
           hold = json_number_at(run, "hold_s"), cycles = json_number_at(run, "cycles");
    if (strcmp(kind, "ramp_hold") == 0)
        snprintf(text, PAGE_LINE, "a ramp to %.3g mm at %.3g mm/s, held for %.3g s", depth, rate, hold);
    else if (strcmp(kind, "static") == 0)
        snprintf(text, PAGE_LINE, "a slow press to %.3g mm at %.3g mm/s and back", depth, rate);
    else if (strcmp(kind, "cyclic") == 0)
        snprintf(text, PAGE_LINE, "%.0f cycles to %.3g mm at %.3g mm/s", cycles, depth, rate);
    else if (strcmp(kind, "free") == 0)
        snprintf(text, PAGE_LINE, "a stroke of %.3g mm in the air at %.3g mm/s", depth, rate);
    else
        snprintf(text, PAGE_LINE, "%.100s to %.3g mm", kind, depth);
}

/* Where most is left. */
static void repeat_words(const json_t *all, char text[2 * PAGE_LINE]) {
    const json_t *runs = json_object_get(json_object_get(all, "profile"), "experiments"), *run, *worst = NULL;
    char force[32];
    for (size_t i = 0; (run = json_array_get(runs, i)) != NULL; i++)
        if (!worst || json_number_at(run, "after_N") > json_number_at(worst, "after_N"))
            worst = run;
    if (json_array_size(runs) == 1)
        snprintf(text, 2 * PAGE_LINE,
                 "Press again the same way, and once more at another depth and speed: what comes back is no "
                 "accident.");
    else
        snprintf(text, 2 * PAGE_LINE,
                 "For what has no name no experiment can be computed. Repeat %s, where most is left (%s "
                 "rms): what comes back is no "
                 "accident.",
                 worst ? cli_base(json_text_at(worst, "experiment")) : "an experiment",
                 page_force(worst ? json_number_at(worst, "after_N") : NAN, force));
}

void page_next_text(const json_t *all, char text[2 * PAGE_LINE]) {
    const json_t *next = json_object_get(all, "next_experiment"), *run = json_object_get(next, "run");
    const char *verdict = json_text_at(all, "verdict");
    char what[PAGE_LINE], both[PAGE_LINE], apart[32], noise[32];
    page_names(json_object_get(next, "between"), 0, " and ", both);
    if (json_is_object(run)) {
        kind_words(run, what);
        snprintf(text, 2 * PAGE_LINE,
                 "Measure %.300s. Both %.300s fit the runs there are; in this run the forces they predict "
                 "are %s apart, rms, after a zero "
                 "and a gain of the run's own (the noise level is %s).",
                 what, both, page_force(json_number_at(next, "separation_N"), apart),
                 page_force(json_number_at(json_object_get(all, "gap"), "noise_level_N"), noise));
    } else if (json_is_object(next)) {
        snprintf(text, 2 * PAGE_LINE, "No run that the indenter can do tells %s apart.", both);
    } else if (strcmp(verdict, "unexplained") == 0 || strcmp(verdict, "suspected") == 0) {
        repeat_words(all, text);
    } else {
        snprintf(text, 2 * PAGE_LINE, "Nothing is left to be told apart.%s",
                 json_array_size(json_object_get(all, "not_identifiable")) > 0
                     ? " What these runs cannot show, the page and the result list."
                     : "");
    }
}

void page_next(FILE *to, const json_t *all) {
    const json_t *next = json_object_get(all, "next_experiment"), *run = json_object_get(next, "run"),
                 *note = json_object_get(next, "note");
    char text[2 * PAGE_LINE];
    fputs("<h3>What to measure next</h3>\n", to);
    page_next_text(all, text);
    page_paragraph(to, "%s", text);
    if (json_is_object(run))
        draw(to, run);
    if (json_is_string(note))
        page_paragraph(to, "%s", json_string_value(note));
}
