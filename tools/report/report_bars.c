/* report_bars.c: forces as bars: orange as given, blue with the effects, a line at the noise level. */
#include "report_explain.h"
#include "report_svg.h"

#include <math.h>

enum { WIDTH = 580, LEFT = 190, ACROSS = 250, ROW = 34, TOP = 22 };

static void row(FILE *to, const report_bar *bar, double y, const svg_axis *x) {
    char before[32], after[32], text[80] = "";
    bool is[2] = {isfinite(bar->before), isfinite(bar->after)};
    double thick = is[0] && is[1] ? 11 : 18;
    svg_text(to, LEFT - 8, y + 17, SVG_END, bar->label);
    if (is[0]) {
        svg_bar(to, LEFT, y + 3, svg_at(x, bar->before) - LEFT, thick, SVG_BEFORE);
    }
    if (is[1]) {
        svg_bar(to, LEFT, y + (is[0] ? 4 + thick : 3), svg_at(x, bar->after) - LEFT, thick, SVG_AFTER);
    }
    snprintf(text, sizeof text, "%s%s%s", is[0] ? report_force(bar->before, before) : "", is[0] && is[1] ? " \u2192 " : "",
             is[1] ? report_force(bar->after, after) : "");
    svg_text(to, LEFT + ACROSS + 10, y + 17, SVG_START, text);
}

void report_bars(FILE *to, const char *caption, size_t n, const report_bar *bar, double noise_level_N) {
    svg_axis x = {0, noise_level_N, LEFT, LEFT + ACROSS, false};
    char text[48], force[32];
    for (size_t i = 0; i < n; i++) {
        x.high = fmax(x.high, fmax(bar[i].before, bar[i].after)); /* fmax passes over NAN */
    }
    double height = (double)(TOP + ROW * n), at = svg_at(&x, noise_level_N);
    fputs("<figure>", to);
    svg_open(to, WIDTH, height + 4, caption);
    for (size_t i = 0; i < n; i++) {
        row(to, &bar[i], (double)(TOP + ROW * i), &x);
    }
    snprintf(text, sizeof text, "noise level %s", report_force(noise_level_N, force));
    fprintf(to, "<path d=\"M%.1f %dV%.1f\" stroke=\"#1c2329\" stroke-dasharray=\"4 3\"/>", at, TOP - 4, height);
    svg_text(to, at, TOP - 8, at > LEFT + 0.7 * ACROSS ? SVG_END : SVG_START, text);
    svg_close(to);
    fputs("<figcaption>", to);
    html_text(to, caption);
    fputs("</figcaption></figure>\n", to);
}
