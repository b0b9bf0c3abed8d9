/* page_phases.c: shares of the gap by run and phase; the residual by depth and by speed. */
#include "explain.h"
#include "page.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PHASES = PALP_PHASE_COUNT, ROWS = 30 };

/* Share in % of the first gap of every run and phase; NAN = the gap has none there. */
typedef struct grid {
    size_t n;
    const json_t *run[EXPLAIN_RUNS_MAX];
    double before[EXPLAIN_RUNS_MAX][PHASES], after[EXPLAIN_RUNS_MAX][PHASES], total[EXPLAIN_RUNS_MAX],
        by_phase[PHASES];
} grid;

static int phase_of(const char *name) {
    int p = 0;
    while (p < PHASES && strcmp(name, palp_phase_name((palp_phase)p)) != 0)
        p++;
    return p;
}

static size_t run_of(const grid *g, const char *name) {
    size_t r = 0;
    while (r < g->n && strcmp(name, json_text_at(g->run[r], "experiment")) != 0)
        r++;
    return r;
}

static void fill(const json_t *all, grid *g) {
    const json_t *runs = json_object_get(json_object_get(all, "profile"), "experiments"),
                 *places = json_object_get(all, "phase_shares"), *place;
    g->n = json_array_size(runs) < EXPLAIN_RUNS_MAX ? json_array_size(runs) : EXPLAIN_RUNS_MAX;
    for (size_t r = 0; r < g->n; r++) {
        g->run[r] = json_array_get(runs, r);
        for (int p = 0; p < PHASES; p++)
            g->before[r][p] = g->after[r][p] = NAN;
    }
    for (size_t i = 0; (place = json_array_get(places, i)) != NULL; i++) {
        size_t r = run_of(g, json_text_at(place, "experiment"));
        int p = phase_of(json_text_at(place, "phase"));
        if (r < g->n && p < PHASES) {
            g->before[r][p] = 100 * json_number_at(place, "share");
            g->after[r][p] = 100 * json_number_at(place, "remaining");
            g->total[r] += g->before[r][p];
            g->by_phase[p] += g->before[r][p];
        }
    }
}

static size_t largest(const double *value, size_t n) {
    size_t best = 0;
    for (size_t i = 1; i < n; i++)
        best = value[i] > value[best] ? i : best;
    return best;
}

/* A share, the fainter behind the smaller it is. */
static void half_cell(FILE *to, double share, double most, const char *rgb) {
    double part = sqrt(fmin(1, share / most));
    if (share >= 0.05)
        fprintf(to, "<b style=\"background:rgba(%s,%.2f)%s\">%.*f</b>", rgb, part,
                part > 0.75 ? ";color:#fff" : "", share >= 9.95 ? 0 : 1, share);
}

static void grid_row(FILE *to, const grid *g, size_t r, double most, bool two) {
    char before[32], after[32];
    fputs("<tr><td>", to);
    html_text(to, cli_base(json_text_at(g->run[r], "experiment")));
    fputs("</td>", to);
    for (int p = 0; p < PHASES; p++) {
        fputs("<td class=\"cell\">", to);
        half_cell(to, g->before[r][p], most, "213,94,0");
        if (two)
            half_cell(to, g->after[r][p], most, "0,114,178");
        fputs("</td>", to);
    }
    fprintf(to, "<td>%s%s%s</td></tr>\n", page_force(json_number_at(g->run[r], "before_N"), before),
            two ? " \u2192 " : "", two ? page_force(json_number_at(g->run[r], "after_N"), after) : "");
}

/* Whether run r is among the rows: at most ROWS, those with the largest shares. */
static bool is_shown(const grid *g, size_t r) {
    size_t larger = 0;
    for (size_t k = 0; k < g->n; k++)
        larger += g->total[k] > g->total[r] || (g->total[k] >= g->total[r] && k < r);
    return larger < ROWS;
}

static void draw_grid(FILE *to, const grid *g, bool two) {
    double most = 1e-9;
    char heads[512] = "experiment", text[32];
    bool blue = false;
    for (size_t r = 0; r < g->n; r++) {
        for (int p = 0; p < PHASES; p++) {
            blue = blue || (two && isfinite(g->after[r][p]));
            most = fmax(most, fmax(g->before[r][p], g->after[r][p]));
        }
    }
    for (int p = 0; p < PHASES; p++) {
        page_phase(palp_phase_name((palp_phase)p), text);
        size_t n = strlen(heads);
        snprintf(heads + n, sizeof heads - n, "|~%s", text);
    }
    strcat(heads, "|whole run, rms");
    fputs("<figure>", to);
    html_table(to, NULL, heads);
    for (size_t r = 0; r < g->n; r++)
        if (is_shown(g, r))
            grid_row(to, g, r, most, two);
    html_table_end(to);
    fprintf(to,
            "<figcaption>Share of the first gap in %%, squared and above the noise level, by experiment and "
            "phase: orange as "
            "given%s. Empty: the experiment has no such phase, or nothing above the noise level in it. A "
            "corner is the first "
            "0.2 s after the motion changes; recovery is the time back at or above "
            "contact.</figcaption></figure>\n",
            blue ? ", blue what remains of it with the effects" : "");
}

static void in_words(FILE *to, const json_t *all, const grid *g) {
    const json_t *place = json_array_get(json_object_get(all, "phase_shares"), 0);
    size_t phase = largest(g->by_phase, PHASES), run = largest(g->total, g->n);
    char worst[32], common[32];
    if (!place) {
        page_paragraph(to, "Nowhere is the gap above the noise level.");
        return;
    }
    page_phase(json_text_at(place, "phase"), worst);
    page_phase(palp_phase_name((palp_phase)phase), common);
    page_paragraph(to,
                   "Of all that is above the noise level %.0f %% is in the phase \u201c%s\u201d of the "
                   "experiments, and %.0f %% in "
                   "one experiment, %s. The largest single place is %s, \u201c%s\u201d: %.0f %%.",
                   g->by_phase[phase], common, g->total[run],
                   cli_base(json_text_at(g->run[run], "experiment")),
                   cli_base(json_text_at(place, "experiment")), worst, 100 * json_number_at(place, "share"));
}

/* ---- by depth and speed ---- */

static void depth_label(const json_t *bin, char text[64]) {
    double from = json_number_at(bin, "from"), end = json_number_at(bin, "to");
    if (isfinite(from))
        snprintf(text, 64, "%.3g to %.3g mm", from, end);
    else
        strcpy(text, "in air");
}

static void speed_label(const json_t *bin, char text[64]) {
    double from = json_number_at(bin, "from"), end = json_number_at(bin, "to");
    double slow = fmin(fabs(from), fabs(end)), fast = fmax(fabs(from), fabs(end));
    const char *way = isfinite(from) && from >= 0 ? "in" : "out";
    if (from < 0 && end > 0)
        strcpy(text, "standing still");
    else if (isfinite(from) && isfinite(end))
        snprintf(text, 64, "%s, %g to %g mm/s", way, slow, fast);
    else
        snprintf(text, 64, "%s, above %g mm/s", way, slow);
}

static void profile(FILE *to, const json_t *all, const char *key, bool two,
                    void label(const json_t *, char *), const char *caption) {
    const json_t *bins = json_object_get(json_object_get(all, "profile"), key), *bin;
    page_bar bar[16];
    size_t n = 0;
    for (size_t i = 0; (bin = json_array_get(bins, i)) != NULL && n < 16; i++, n++) {
        label(bin, bar[n].label);
        bar[n].before = json_number_at(bin, "before_N");
        bar[n].after = two ? json_number_at(bin, "after_N") : NAN;
    }
    if (n > 0)
        page_bars(to, caption, n, bar, json_number_at(json_object_get(all, "gap"), "noise_level_N"));
}

void page_phases(FILE *to, const json_t *all) {
    grid *g = calloc(1, sizeof *g);
    bool two = json_array_size(json_object_get(all, "effects")) > 0;
    if (!g)
        return;
    fill(all, g);
    fputs("<h3>Where they disagree</h3>\n", to);
    if (g->n > 0) {
        in_words(to, all, g);
        draw_grid(to, g, two);
        fputs("<div class=\"figures\">\n", to);
        profile(to, all, "depth_mm", two, depth_label, "Recorded minus model by depth, rms.");
        profile(to, all, "speed_mm_s", two, speed_label, "The same by speed and direction of the plate.");
        fputs("</div>\n", to);
    }
    free(g);
}
