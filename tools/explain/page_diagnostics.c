/* page_diagnostics.c: diagnostics of the residual: waves over time and depth, free curves, order from sample
 * to sample, events. */
#include "page.h"

#include <math.h>
#include <string.h>

enum { POINTS = 256, EVENTS = 30 };

/* ---- waves ---- */

static size_t numbers(const json_t *list, double scale, double to[POINTS]) {
    size_t n = json_array_size(list) < POINTS ? json_array_size(list) : POINTS;
    for (size_t i = 0; i < n; i++) {
        const json_t *value = json_array_get(list, i);
        to[i] = json_is_number(value) ? scale * json_number_value(value) : NAN;
    }
    return n;
}

static void spectrum(FILE *to, const json_t *waves, const char *key, const char *label, bool two,
                     const char *caption) {
    double x[POINTS], before[POINTS], after[POINTS];
    size_t n = numbers(json_object_get(waves, key), 1, x);
    if (n < 2 || numbers(json_object_get(waves, "before_N"), 1e3, before) != n ||
        numbers(json_object_get(waves, "after_N"), 1e3, after) != n) {
        return;
    }
    const plot_series series[] = {{NULL, PLOT_LINE, PLOT_ORANGE, n, x, before},
                                  {NULL, PLOT_LINE, PLOT_BLUE, n, x, after}};
    const plot_figure figure = {.n_panels = 1,
                                .panel = {{.x_label = label,
                                           .y_label = "amplitude (mN)",
                                           .x_scale = PLOT_LOG_FINE,
                                           .y_scale = PLOT_LOG_FINE,
                                           .n_series = two ? 2 : 1,
                                           .series = series}},
                                .width = 580,
                                .height = 260};
    html_draw(to, &figure, caption);
}

static void line_text(const json_t *line, const char *key, const char *what, char text[PAGE_LINE]) {
    char force[32];
    double prominence = json_number_at(line, "prominence");
    if (!(json_number_at(line, key) > 0)) {
        snprintf(text, PAGE_LINE, "No wave over %s could be looked for.",
                 strcmp(what, "Hz") == 0 ? "time" : "depth");
        return;
    }
    snprintf(
        text, PAGE_LINE, "Strongest wave of the residual: %.4g %s, %s, %.2g times the usual power there.",
        json_number_at(line, key), what, page_force(json_number_at(line, "amplitude_N"), force), prominence);
}

static void waves(FILE *to, const json_t *all, bool two) {
    const json_t *spectra = json_object_get(all, "spectrum"),
                 *diagnostics = json_object_get(all, "residual_diagnostics");
    char text[PAGE_LINE], caption[2 * PAGE_LINE];
    fputs("<div class=\"figures\">\n", to);
    line_text(json_object_get(diagnostics, "line_in_time"), "frequency_Hz", "Hz", text);
    snprintf(caption, sizeof caption, "Waves over time: amplitude against frequency. %s", text);
    spectrum(to, json_object_get(spectra, "time"), "frequency_Hz", "frequency (Hz)", two, caption);
    line_text(json_object_get(diagnostics, "line_in_depth"), "period_mm", "mm from crest to crest", text);
    snprintf(caption, sizeof caption, "Waves over depth, while the plate moves: amplitude against period. %s",
             text);
    spectrum(to, json_object_get(spectra, "depth"), "period_mm", "period (mm)", two, caption);
    fputs("</div>\n", to);
}

/* ---- free curves ---- */

static void free_curves(FILE *to, const json_t *all, bool two) {
    static const char *const labels[] = {"the whole residual", "above the noise level",
                                         "a curve of depth takes off", "a curve of time takes off",
                                         "a curve of speed takes off"};
    const json_t *curves = json_object_get(json_object_get(all, "residual_diagnostics"), "free_curves"),
                 *gap = json_object_get(all, "gap");
    const double size[] = {json_number_at(gap, "after_N"), json_number_at(gap, "unexplained_N"),
                           json_number_at(curves, "depth_N"), json_number_at(curves, "time_N"),
                           json_number_at(curves, "rate_N")};
    page_bar bar[5];
    for (size_t i = 0; i < 5; i++) {
        bar[i] = (page_bar){.before = two ? NAN : size[i], .after = two ? size[i] : NAN};
        strcpy(bar[i].label, labels[i]);
    }
    page_bars(to,
              "The most that an effect nobody has thought of could still explain, rms: free curves of depth, "
              "of time "
              "within a run, of the plate's speed.",
              5, bar, json_number_at(gap, "noise_level_N"));
}

/* ---- tables ---- */

static void order(FILE *to, const json_t *all) {
    const json_t *list = json_object_get(all, "phase_shares"), *place;
    char phase[32];
    if (json_array_size(list) == 0)
        return;
    fputs("<details><summary>From sample to sample: correlation and runs test, place by place</summary>\n",
          to);
    page_paragraph(
        to, "White noise has a correlation of 0 from sample to sample and a runs test within 2 standard "
            "deviations; correlated noise, a part of the noise level, has not.");
    html_table(to, NULL,
               "experiment|~phase|share of the first gap (%)|correlation|runs test (standard deviations)");
    for (size_t i = 0; (place = json_array_get(list, i)) != NULL; i++) {
        page_phase(json_text_at(place, "phase"), phase);
        html_row(to, "%s|~%s|%.2f|%.2f|%.1f", cli_base(json_text_at(place, "experiment")), phase,
                 100 * json_number_at(place, "share"), json_number_at(place, "residual_lag1"),
                 json_number_at(place, "residual_runs_z"));
    }
    html_table_end(to);
    fputs("</details>\n", to);
}

static void events(FILE *to, const json_t *all) {
    const json_t *list = json_object_get(all, "events"), *event;
    size_t n = json_array_size(list);
    char force[32];
    if (n == 0) {
        page_paragraph(to, "No events: no lone spikes, no plate letting go, no slips.");
        return;
    }
    html_table(to, "Events: they do not count against the model", "experiment|~what|from (s)|to (s)|size");
    for (size_t i = 0; i < n && i < EVENTS; i++) {
        event = json_array_get(list, i);
        html_row(to, "%s|~%s|%.3f|%.3f|%s", cli_base(json_text_at(event, "experiment")),
                 json_text_at(event, "kind"), json_number_at(event, "from_s"), json_number_at(event, "to_s"),
                 page_force(json_number_at(event, "size_N"), force));
    }
    html_table_end(to);
    if (n > EVENTS)
        page_paragraph(to, "And %zu more.", n - EVENTS);
    fputs("<p class=\"about\">spike: a lone sample far from its neighbours; release: the plate lets go of "
          "the specimen; slip: "
          "the residual steps and stays.</p>\n",
          to);
}

void page_diagnostics(FILE *to, const json_t *all) {
    bool two = json_array_size(json_object_get(all, "effects")) > 0;
    fputs("<h3>Residual diagnostics</h3>\n", to);
    waves(to, all, two);
    fputs("<div class=\"figures\">\n", to);
    free_curves(to, all, two);
    fputs("<div>\n", to);
    events(to, all);
    fputs("</div></div>\n", to);
    order(to, all);
}
