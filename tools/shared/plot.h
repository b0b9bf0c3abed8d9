/* plot.h: figures as JSON; tools/page/page.js draws them. */
#ifndef PALPATE_PLOT_H
#define PALPATE_PLOT_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

typedef enum plot_style {
    PLOT_LINE,
    PLOT_POINTS,
    PLOT_PALE, /* a thin line in a light tint: raw samples behind what is made of them */
    PLOT_BAND  /* a tint between two curves: y holds n lower, then n upper values */
} plot_style;

/* A colour from PLOT_SHADE + 0 to PLOT_SHADE + 999 is a place on a ramp from dark to light, for curves
 * that follow each other, such as depths. */
enum { PLOT_BLUE, PLOT_ORANGE, PLOT_BLACK = 6, PLOT_SHADE = 1000 };

typedef struct plot_series {
    const char *title; /* NULL = not in the key */
    plot_style style;
    int colour; /* index in the palette, or a shade; series of one colour belong together */
    size_t n;
    const double *x, *y; /* caller's; points that are not finite are left out */
} plot_series;

typedef struct plot_panel {
    const char *x_label, *y_label;
    bool x_log, y_log;
    size_t n_series;
    const plot_series *series;
    double y_low, y_high; /* both 0 = as the series need */
} plot_panel;

enum { PLOT_PANELS_MAX = 2 };

typedef struct plot_figure {
    const char *title;
    size_t n_panels; /* two share x, and the first takes two thirds of the height */
    plot_panel panel[PLOT_PANELS_MAX];
} plot_figure;

/* Appends the figure to a list; its numbers have five digits. */
void plot_draw(json_t *figures, const char *name, const plot_figure *figure);

#endif
