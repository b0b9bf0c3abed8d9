/* report_svg.h: small figures written straight into a page: no gnuplot, no scripts, no ids. */
#ifndef PALPATE_TOOL_REPORT_SVG_H
#define PALPATE_TOOL_REPORT_SVG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#define SVG_BEFORE "#d55e00" /* the model as given */
#define SVG_AFTER "#0072b2"  /* with the effects */
#define SVG_FLOOR "#c3ccd3"
#define SVG_FRAME "#8a959e"

/* From values low..high to pixels from..to. */
typedef struct svg_axis {
    double low, high, from, to;
    bool log;
} svg_axis;

typedef enum svg_anchor { SVG_START, SVG_MIDDLE, SVG_END } svg_anchor;

void svg_open(FILE *to, double width, double height, const char *about); /* about: for those who do not see it */
void svg_close(FILE *to);
double svg_at(const svg_axis *axis, double value); /* kept within the axis */
void svg_text(FILE *to, double x, double y, svg_anchor anchor, const char *text); /* escaped */
void svg_bar(FILE *to, double x, double y, double width, double height, const char *colour);

/* 1, 2 or 5 times a power of ten, so that about n of them make the range. */
double svg_step(double range, double n);

/* The frame of a chart with ticks along x and grid lines along y; last gets the unit of x behind it. */
void svg_frame(FILE *to, const svg_axis *x, const svg_axis *y, const char *x_unit, const char *y_label);

/* A line through the points whose x and y are finite. */
void svg_line(FILE *to, const svg_axis *x, const svg_axis *y, size_t n, const double *xs, const double *ys,
              const char *colour);

#endif
