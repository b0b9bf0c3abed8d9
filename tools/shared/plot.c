/* plot.c: figures as JSON; tools/page/page.js draws them. */
#include "plot.h"

#include "json_out.h"

#include <math.h>

static double with_five_digits(double value) {
    double scale = value == 0 ? 1 : pow(10, 4 - floor(log10(fabs(value))));
    return round(value * scale) / scale;
}

/* The values of those points that are finite. */
static json_t *column_json(const plot_series *series, const double *value) {
    json_t *list = json_array();
    for (size_t i = 0; i < series->n; i++)
        if (isfinite(series->x[i]) && isfinite(series->y[i]))
            json_array_append_new(list, json_number_or_null(with_five_digits(value[i])));
    return list;
}

static json_t *series_json(const plot_series *series) {
    static const char *const styles[] = {"line", "points", "pale", "band"};
    json_t *to = json_pack("{s:s, s:i}", "style", styles[series->style], "colour", series->colour);
    bool band = series->style == PLOT_BAND;
    if (series->title)
        json_object_set_new(to, "title", json_text(series->title));
    json_object_set_new(to, "x", column_json(series, series->x));
    json_object_set_new(to, band ? "low" : "y", column_json(series, series->y));
    if (band)
        json_object_set_new(to, "high", column_json(series, series->y + series->n));
    return to;
}

static json_t *panel_json(const plot_panel *panel) {
    json_t *series = json_array();
    for (size_t i = 0; i < panel->n_series; i++)
        json_array_append_new(series, series_json(&panel->series[i]));
    json_t *to = json_pack("{s:s, s:s, s:b, s:b, s:o}", "x_label", panel->x_label, "y_label", panel->y_label,
                           "x_log", panel->x_log, "y_log", panel->y_log, "series", series);
    if (panel->y_high > panel->y_low)
        json_object_set_new(to, "y_range", json_pack("[f, f]", panel->y_low, panel->y_high));
    return to;
}

void plot_draw(json_t *figures, const char *name, const plot_figure *figure) {
    json_t *panels = json_array();
    for (size_t k = 0; k < figure->n_panels; k++)
        json_array_append_new(panels, panel_json(&figure->panel[k]));
    json_array_append_new(figures, json_pack("{s:s, s:o, s:o}", "name", name, "title",
                                             json_text(figure->title), "panels", panels));
}
