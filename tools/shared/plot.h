/* plot.h: SVG figures by gnuplot; the script with its data stays beside the figure. */
#ifndef PALPATE_PLOT_H
#define PALPATE_PLOT_H

#include <stdbool.h>
#include <stddef.h>

typedef enum plot_style {
    PLOT_LINE,
    PLOT_DASHED,
    PLOT_POINTS,
    PLOT_LINE_POINTS,
    PLOT_PALE, /* a thin line in a light tint: raw samples behind what is made of them */
    PLOT_BARS  /* points with error bars: y holds n values, then n lower and n upper ends */
} plot_style;

/* A colour from PLOT_SHADE + 0 to PLOT_SHADE + 999 is a place on a ramp from dark to light, for curves
 * that follow each other, such as depths. */
enum { PLOT_COLOURS = 8, PLOT_BLACK = 6, PLOT_SHADE = 1000 };

typedef struct plot_series {
    const char *title; /* NULL = not in the key */
    plot_style style;
    int colour; /* index in the palette, or a shade; series of one colour belong together */
    size_t n;
    const double *x, *y; /* caller's */
} plot_series;

typedef struct plot_panel {
    const char *x_label, *y_label;
    bool x_log, y_log;
    size_t n_series;
    const plot_series *series;
} plot_panel;

enum { PLOT_PANELS_MAX = 2 };

typedef struct plot_figure {
    const char *title;
    size_t n_panels; /* one above the other; the first takes two thirds */
    plot_panel panel[PLOT_PANELS_MAX];
} plot_figure;

typedef enum plot_result { PLOT_OK, PLOT_NO_GNUPLOT, PLOT_FAILED } plot_result;

/* Makes the folder if need be. */
bool plot_folder(const char *folder);

/* Writes folder/name.gp and, by gnuplot, folder/name.svg. */
plot_result plot_write(const char *folder, const char *name, const plot_figure *figure);

#endif
