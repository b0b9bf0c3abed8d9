/* plot.h: figures as SVG, drawn by gnuplot. */
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
    PLOT_BARS, /* points with error bars: y holds n values, then n lower and n upper ends */
    PLOT_BAND  /* a tint between two curves: y holds n lower, then n upper values */
} plot_style;

/* A colour from PLOT_SHADE + 0 to PLOT_SHADE + 999 is a place on a ramp from dark to light, for curves
 * that follow each other, such as depths. */
enum { PLOT_BLUE, PLOT_ORANGE, PLOT_BLACK = 6, PLOT_COLOURS = 8, PLOT_SHADE = 1000 };

typedef struct plot_series {
    const char *title; /* NULL = not in the key */
    plot_style style;
    int colour; /* index in the palette, or a shade; series of one colour belong together */
    size_t n;
    const double *x, *y; /* caller's */
} plot_series;

typedef enum plot_scale {
    PLOT_LINEAR,
    PLOT_LOG,
    PLOT_LOG_FINE /* labels at 1, 2 and 5 of every decade */
} plot_scale;

typedef struct plot_panel {
    const char *x_label, *y_label;
    plot_scale x_scale, y_scale;
    size_t n_series;
    const plot_series *series;
    const char *title;    /* NULL = none */
    double y_low, y_high; /* both 0 = as the series need */
    bool x_counts;        /* x is a whole number, such as a number of arms */
} plot_panel;

enum { PLOT_PANELS_MAX = 12 };

typedef struct plot_figure {
    const char *title; /* NULL = none */
    size_t n_panels;   /* two in one column share x, and the first takes two thirds of the height */
    plot_panel panel[PLOT_PANELS_MAX];
    size_t columns;         /* 0 = 1 */
    unsigned width, height; /* 0 = 900, 560 */
} plot_figure;

typedef enum plot_result { PLOT_OK, PLOT_NO_GNUPLOT, PLOT_FAILED } plot_result;

/* The figure as the text of an SVG from "<svg" on, malloc'ed. */
plot_result plot_svg(const plot_figure *figure, char **svg);

/* Where a command's figures go: into a folder as name.svg, with gnuplot's script and the data in name.gp
 * beside it (gnuplot name.gp >name.svg makes it again); or, without a folder, to take, which frees svg. */
typedef struct plot_book {
    const char *command, *folder;
    void (*take)(void *user, const char *name, char *svg);
    void *user;
    plot_result result; /* of the figures so far */
} plot_book;

void plot_draw(plot_book *book, const char *name, const plot_figure *figure);

/* An exit code, after a warning if there is no gnuplot. */
int plot_close(const plot_book *book);

#endif
