/* plot.h: SVG figures by gnuplot; the script with its data stays beside the figure. */
#ifndef PALPATE_PLOT_H
#define PALPATE_PLOT_H

#include <stdbool.h>
#include <stddef.h>

typedef enum plot_style { PLOT_LINE, PLOT_DASHED, PLOT_POINTS, PLOT_LINE_POINTS } plot_style;

typedef struct plot_series {
    const char *title; /* NULL = not in the key */
    plot_style style;
    int colour; /* index in the palette; series of one colour belong together */
    size_t n;
    const double *x, *y; /* caller's */
} plot_series;

typedef struct plot_panel {
    const char *x_label, *y_label;
    bool x_log, y_log;
    size_t n_series;
    const plot_series *series;
} plot_panel;

enum { PLOT_PANELS_MAX = 2, PLOT_COLOURS = 8 };

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
