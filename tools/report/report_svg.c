/* report_svg.c: small figures written straight into a page. */
#include "report_svg.h"

#include "report.h"

#include <math.h>

void svg_open(FILE *to, double width, double height, const char *about) {
    fprintf(to,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" role=\"img\" "
            "font-size=\"13\" font-family=\"system-ui,'DejaVu Sans',Arial,sans-serif\" fill=\"#1c2329\" "
            "style=\"max-width:100%%;height:auto\"><title>",
            width, height, width);
    html_text(to, about);
    fputs("</title>\n", to);
}

void svg_close(FILE *to) {
    fputs("</svg>\n", to);
}

double svg_at(const svg_axis *axis, double value) {
    double part = axis->log ? log(value / axis->low) / log(axis->high / axis->low)
                            : (value - axis->low) / (axis->high - axis->low);
    return axis->from + (axis->to - axis->from) * fmax(0, fmin(1, part));
}

void svg_text(FILE *to, double x, double y, svg_anchor anchor, const char *text) {
    static const char *const anchors[] = {"start", "middle", "end"};
    fprintf(to, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">", x, y, anchors[anchor]);
    html_text(to, text);
    fputs("</text>\n", to);
}

void svg_bar(FILE *to, double x, double y, double width, double height, const char *colour) {
    fprintf(to, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"%s\"/>\n", x, y, fmax(0, width),
            height, colour);
}

double svg_step(double range, double n) {
    double step = pow(10, floor(log10(range / n)));
    double times = range / n / step;
    return step * (times > 5 ? 10 : times > 2 ? 5 : times > 1 ? 2 : 1);
}

/* ---- ticks: every step, or at 1, 2 and 5 of every decade of an axis that has few ---- */

static bool is_fine(const svg_axis *axis) {
    return axis->log && axis->high < 300 * axis->low;
}

static double next_tick(const svg_axis *axis, double tick, double step) {
    if (!axis->log) {
        return tick + step;
    }
    double power = pow(10, floor(log10(tick) + 1e-9));
    return !is_fine(axis) || tick > 4 * power ? 10 * power : tick > 1.5 * power ? 5 * power : 2 * power;
}

static double first_tick(const svg_axis *axis, double step) {
    double tick = axis->log ? pow(10, floor(log10(axis->low))) : step * ceil(axis->low / step - 1e-9);
    while (axis->log && tick < axis->low * (1 - 1e-9)) {
        tick = next_tick(axis, tick, step);
    }
    return tick;
}

static void tick_text(const svg_axis *axis, double tick, double step, const char *unit, char text[48]) {
    snprintf(text, 48, "%.4g%s", axis->log || fabs(tick) > 0.01 * step ? tick : 0.0, unit);
}

void svg_frame(FILE *to, const svg_axis *x, const svg_axis *y, const char *x_unit, const char *y_label) {
    char text[48];
    double step = svg_step(y->high - y->low, 5), middle = 0.5 * (y->from + y->to);
    for (double v = first_tick(y, step); v <= y->high * (1 + 1e-9); v = next_tick(y, v, step)) {
        tick_text(y, v, step, "", text);
        fprintf(to, "<path d=\"M%.1f %.1fh%.1f\" stroke=\"#d5dbe0\" stroke-width=\"0.7\"/>", x->from, svg_at(y, v),
                x->to - x->from);
        svg_text(to, x->from - 6, svg_at(y, v) + 4, SVG_END, text);
    }
    step = svg_step(x->high - x->low, 6);
    for (double v = first_tick(x, step); v <= x->high * (1 + 1e-9); v = next_tick(x, v, step)) {
        bool last = next_tick(x, v, step) > x->high * (1 + 1e-9);
        tick_text(x, v, step, last ? x_unit : "", text);
        fprintf(to, "<path d=\"M%.1f %.1fv4\" stroke=\"%s\"/>", svg_at(x, v), y->from, SVG_FRAME);
        svg_text(to, svg_at(x, v), y->from + 18, SVG_MIDDLE, text);
    }
    fprintf(to, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"none\" stroke=\"%s\"/>\n", x->from,
            y->to, x->to - x->from, y->from - y->to, SVG_FRAME);
    fprintf(to, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\" transform=\"rotate(-90 %.1f %.1f)\">", x->from - 48,
            middle, x->from - 48, middle);
    html_text(to, y_label);
    fputs("</text>\n", to);
}

void svg_line(FILE *to, const svg_axis *x, const svg_axis *y, size_t n, const double *xs, const double *ys,
              const char *colour) {
    fprintf(to, "<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"1.6\" points=\"", colour);
    for (size_t i = 0; i < n; i++) {
        if (isfinite(xs[i]) && isfinite(ys[i])) {
            fprintf(to, "%.1f,%.1f ", svg_at(x, xs[i]), svg_at(y, ys[i]));
        }
    }
    fputs("\"/>\n", to);
}
