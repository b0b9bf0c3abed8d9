/* explain_figure.c: recorded minus model over time, run by run, as given and with the effects: one SVG of small
 * panels of one scale. */
#include "explain.h"
#include "report.h"

#include <math.h>

static const char GIVEN[] = "#d55e00", EXPLAINED[] = "#0072b2";

enum { PANELS = 12, COLUMNS = 2, WIDTH = 600, HEIGHT = 190, LEFT = 58, TOP = 26, ACROSS = 526, DOWN = 118, BINS = 263 };

/* ---- scales ---- */

/* 1, 2 or 5 times a power of ten, so that about n of them make the range. */
static double tick_step(double range, double n) {
    double step = pow(10, floor(log10(range / n)));
    double times = range / n / step;
    return step * (times > 5 ? 10 : times > 2 ? 5 : times > 1 ? 2 : 1);
}

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

static void axes(FILE *to, double length_s, double most, double floor_N) {
    double step = tick_step(2 * most, 4), y = height_of(floor_N, most);
    fprintf(to, "<rect x=\"%d\" y=\"%.1f\" width=\"%d\" height=\"%.1f\" fill=\"#e3e8ec\"/>\n", LEFT, y, ACROSS,
            height_of(-floor_N, most) - y);
    for (double v = -step * floor(most / step); v < most + 0.5 * step; v += step) {
        if (v <= most) {
            y = height_of(v, most);
            fprintf(to, "<path d=\"M%d %.1fh%d\" stroke=\"#d5dbe0\" stroke-width=\"0.7\"/>", LEFT, y, ACROSS);
            fprintf(to, "<text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%.4g</text>\n", LEFT - 6, y + 4,
                    fabs(v) < 0.01 * step ? 0.0 : 1e3 * v);
        }
    }
    step = tick_step(length_s, 6);
    for (double t = 0; t <= length_s * 1.0001; t += step) {
        double x = LEFT + ACROSS * t / length_s;
        bool last = t + step > length_s * 1.0001;
        fprintf(to, "<path d=\"M%.1f %dv4\" stroke=\"#8a959e\"/>", x, TOP + DOWN);
        fprintf(to, "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%.4g%s</text>\n", x, TOP + DOWN + 17, t,
                last ? " s" : "");
    }
    fprintf(to, "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"none\" stroke=\"#8a959e\"/>\n", LEFT, TOP,
            ACROSS, DOWN);
    fprintf(to, "<text x=\"12\" y=\"%d\" text-anchor=\"middle\" transform=\"rotate(-90 12 %d)\">mN</text>\n",
            TOP + DOWN / 2, TOP + DOWN / 2);
}

static void panel(FILE *to, const palp_explanation *e, const palp_explain_run *run, size_t place, double most) {
    fprintf(to, "<g transform=\"translate(%zu %zu)\">\n", place % COLUMNS * WIDTH, place / COLUMNS * HEIGHT);
    axes(to, run->time_s[run->n - 1] - run->time_s[0], most, e->gap.floor_N);
    curve(to, run, run->before_N, most, GIVEN);
    if (e->n_effects > 0) {
        curve(to, run, run->after_N, most, EXPLAINED);
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
    double most = 2 * e->gap.floor_N;
    for (size_t k = 0; k < n; k++) {
        const palp_explain_run *run = &e->run[shown[k]];
        double peak = largest(run, run->before_N); /* but for spikes */
        most = fmax(most, fmin(1.05 * peak, 6 * sqrt(square_of(run, run->before_N))));
    }
    fprintf(to,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %zu\" role=\"img\" font-size=\"12\" "
            "font-family=\"system-ui,'DejaVu Sans',Arial,sans-serif\" fill=\"#1c2329\">\n",
            COLUMNS * WIDTH, rows * HEIGHT);
    for (size_t k = 0; k < n; k++) {
        panel(to, e, &e->run[shown[k]], k, most);
    }
    fputs("</svg>\n", to);
}
