/* explain_figure.c: recorded minus model over time, run by run, as given and with the effects: one SVG of small
 * panels of one scale. */
#include "explain.h"
#include "report/report.h"
#include "report/report_svg.h"

#include <math.h>

enum { PANELS = 12, COLUMNS = 2, WIDTH = 600, HEIGHT = 190, LEFT = 58, TOP = 26, ACROSS = 526, DOWN = 118, BINS = 263 };

/* ---- scales ---- */

static double height_of(double force_N, double most) {
    return TOP + 0.5 * DOWN * (1 - fmax(-1, fmin(1, force_N / most)));
}

static double square_of(const palp_explain_run *run, const double *y) {
    double sum = 0;
    for (size_t i = 0; i < run->n; i++) {
        sum += y[i] * y[i] / (double)run->n;
    }
    return sum;
}

static double largest(const palp_explain_run *run, const double *y) {
    double most = 0;
    for (size_t i = 0; i < run->n; i++) {
        most = fmax(most, fabs(y[i]));
    }
    return most;
}

/* ---- curves: what falls on one bin is a mean, and a lowest and highest ---- */

typedef struct bins {
    size_t n[BINS];
    double mean[BINS], low[BINS], high[BINS];
} bins;

static void sort_into(const palp_explain_run *run, const double *y, bins *b) {
    double length = run->time_s[run->n - 1] - run->time_s[0];
    *b = (bins){.n = {0}};
    for (size_t i = 0; i < run->n; i++) {
        size_t k = (size_t)(BINS * 0.999999 * (run->time_s[i] - run->time_s[0]) / length);
        b->mean[k] += (y[i] - b->mean[k]) / (double)(b->n[k] + 1);
        b->low[k] = b->n[k] ? fmin(b->low[k], y[i]) : y[i];
        b->high[k] = b->n[k] ? fmax(b->high[k], y[i]) : y[i];
        b->n[k]++;
    }
}

static void point(FILE *to, size_t bin, double force_N, double most) {
    fprintf(to, "%.0f,%.1f ", LEFT + ACROSS * ((double)bin + 0.5) / BINS, height_of(force_N, most));
}

static void curve(FILE *to, const palp_explain_run *run, const double *y, double most, const char *colour) {
    bins b;
    sort_into(run, y, &b);
    fprintf(to, "<polygon fill=\"%s\" fill-opacity=\"0.22\" points=\"", colour);
    for (size_t k = 0; k < BINS; k++) {
        if (b.n[k] > 0) {
            point(to, k, b.high[k], most);
        }
    }
    for (size_t k = BINS; k-- > 0;) {
        if (b.n[k] > 0) {
            point(to, k, b.low[k], most);
        }
    }
    fprintf(to, "\"/>\n<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"1.3\" points=\"", colour);
    for (size_t k = 0; k < BINS; k++) {
        if (b.n[k] > 0) {
            point(to, k, b.mean[k], most);
        }
    }
    fputs("\"/>\n", to);
}

/* ---- a panel ---- */

static void axes(FILE *to, double length_s, double most, double noise_level_N) {
    svg_axis x = {0, length_s, LEFT, LEFT + ACROSS, false}, y = {-1e3 * most, 1e3 * most, TOP + DOWN, TOP, false};
    double top = svg_at(&y, 1e3 * noise_level_N);
    svg_bar(to, LEFT, top, ACROSS, svg_at(&y, -1e3 * noise_level_N) - top, "#e3e8ec");
    svg_frame(to, &x, &y, " s", "mN");
}

static void panel(FILE *to, const palp_explanation *e, const palp_explain_run *run, size_t place, double most) {
    fprintf(to, "<g transform=\"translate(%zu %zu)\">\n", place % COLUMNS * WIDTH, place / COLUMNS * HEIGHT);
    axes(to, run->time_s[run->n - 1] - run->time_s[0], most, e->gap.noise_level_N);
    curve(to, run, run->before_N, most, SVG_BEFORE);
    if (e->n_effects > 0) {
        curve(to, run, run->after_N, most, SVG_AFTER);
    }
    fprintf(to, "<text x=\"%d\" y=\"17\" font-weight=\"bold\">", LEFT);
    html_text(to, report_base(run->name));
    fprintf(to, "</text><text x=\"%d\" y=\"17\" text-anchor=\"end\">rms %.3g", LEFT + ACROSS,
            1e3 * sqrt(square_of(run, run->before_N)));
    if (e->n_effects > 0) {
        fprintf(to, " &#8594; %.3g", 1e3 * sqrt(square_of(run, run->after_N)));
    }
    fputs(" mN</text>\n</g>\n", to);
}

/* ---- the figure ---- */

/* The runs with the largest residuals, in their own order. */
static size_t choose(const palp_explanation *e, size_t shown[PANELS]) {
    size_t n = 0;
    for (size_t r = 0; r < e->n_runs; r++) {
        double own = square_of(&e->run[r], e->run[r].before_N);
        size_t before = 0;
        for (size_t k = 0; k < e->n_runs; k++) {
            double other = square_of(&e->run[k], e->run[k].before_N);
            before += other > own || (other == own && k < r);
        }
        if (before < PANELS) {
            shown[n++] = r;
        }
    }
    return n;
}

void explain_figure(FILE *to, const palp_explanation *e) {
    size_t shown[PANELS], n = choose(e, shown), rows = (n + COLUMNS - 1) / COLUMNS;
    double most = 2 * e->gap.noise_level_N;
    for (size_t k = 0; k < n; k++) {
        const palp_explain_run *run = &e->run[shown[k]];
        double peak = largest(run, run->before_N); /* but for spikes */
        most = fmax(most, fmin(1.05 * peak, 6 * sqrt(square_of(run, run->before_N))));
    }
    svg_open(to, COLUMNS * WIDTH, (double)(rows * HEIGHT), "recorded minus model over time");
    for (size_t k = 0; k < n; k++) {
        panel(to, e, &e->run[shown[k]], k, most);
    }
    svg_close(to);
}
