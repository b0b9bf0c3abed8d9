/* html.h: the pieces of a page: escaped text, tables, cards, bars, figures. */
#ifndef PALPATE_HTML_H
#define PALPATE_HTML_H

#include "plot.h"

#include <jansson.h>
#include <stdio.h>

void html_text(FILE *to, const char *text); /* any bytes, made plain and escaped; NULL: none */
void html_open(FILE *to, const char *title);
void html_close(FILE *to);
void html_section(FILE *to, const char *id, const char *title);
void html_row(FILE *to, const char *format, ...); /* cells separated by '|': first text, others numbers */
void html_table(FILE *to, const char *caption, const char *heads); /* heads separated by '|' */
void html_table_end(FILE *to);
void html_card(FILE *to, const char *label, const char *format, ...);
void html_number(char text[32], const json_t *value, int digits); /* "-" if it is no number */

/* A cell of a table with a bar for each value that is not NAN (orange as given, blue with the effects) and a
 * dashed line at mark; 1 is the cell's width. */
void html_bars(FILE *to, double before, double after, double mark);

/* A figure in its frame, caption below; svg is the text of an SVG from "<svg" on. html_svg makes it part of
 * the page and is for figures drawn now; html_image is for one from a file: an image, in which a browser runs
 * and loads nothing. */
void html_svg(FILE *to, const char *svg, const char *caption);
void html_image(FILE *to, const char *svg, const char *caption);

/* The same of a figure that is drawn now; without gnuplot a line says that it is missing. */
void html_draw(FILE *to, const plot_figure *figure, const char *caption);

#endif
