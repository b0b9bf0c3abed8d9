/* explain_figure.c: recorded minus model over time, as given and with the effects: a figure for each of the
 * runs with the largest residuals, of one scale. */
#include "explain.h"
#include "shared/plot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SHOWN = 12, BINS = 263, SERIES = 5 };

/* ---- curves: what falls on one bin is a mean, and a lowest and highest ---- */

typedef struct curve {
    size_t n;
    double time_s[BINS], mean[BINS], band[2 * BINS]; /* mN; band: n lowest, then n highest */
} curve;

typedef struct panel {
    double level_s[2], level_mN[4];
    curve before, after;
} panel;

static void add(curve *c, double time_s, double mean_mN, double low_mN, double high_mN) {
    c->time_s[c->n] = time_s;
    c->mean[c->n] = mean_mN;
    c->band[c->n] = low_mN;
    c->band[BINS + c->n] = high_mN;
    c->n++;
}

static void make_curve(const palp_explain_run *run, const double *y, curve *c) {
    double start = run->time_s[0], width = (run->time_s[run->n - 1] - start) / BINS;
    for (size_t i = 0, next; i < run->n; i = next) {
        double bin = floor(0.999999 * (run->time_s[i] - start) / width), sum = 0, low = y[i], high = y[i];
        for (next = i; next < run->n && floor(0.999999 * (run->time_s[next] - start) / width) == bin;
             next++) {
            sum += y[next];
            low = fmin(low, y[next]);
            high = fmax(high, y[next]);
        }
        add(c, (bin + 0.5) * width, 1e3 * sum / (double)(next - i), 1e3 * low, 1e3 * high);
    }
    memmove(c->band + c->n, c->band + BINS, c->n * sizeof *c->band);
}

/* ---- panels ---- */

static double mean_square(const palp_explain_run *run, const double *y) {
    double sum = 0;
    for (size_t i = 0; i < run->n; i++)
        sum += y[i] * y[i] / (double)run->n;
    return sum;
}

static double largest(const palp_explain_run *run, const double *y) {
    double most = 0;
    for (size_t i = 0; i < run->n; i++)
        most = fmax(most, fabs(y[i]));
    return most;
}

static void draw(json_t *figures, panel *p, const palp_explain_run *run, const palp_explanation *e,
                 double most_mN) {
    const double level = 1e3 * e->gap.noise_level_N, before = 1e3 * sqrt(mean_square(run, run->before_N)),
                 after = 1e3 * sqrt(mean_square(run, run->after_N));
    bool two = e->n_effects > 0;
    char title[CLI_PATH_MAX + 64];
    snprintf(title, sizeof title, two ? "%s, rms %.3g \u2192 %.3g mN" : "%s, rms %.3g mN",
             cli_base(run->name), before, after);
    p->level_s[1] = run->time_s[run->n - 1] - run->time_s[0];
    p->level_mN[0] = p->level_mN[1] = -level;
    p->level_mN[2] = p->level_mN[3] = level;
    make_curve(run, run->before_N, &p->before);
    make_curve(run, run->after_N, &p->after);
    const plot_series series[SERIES] = {
        {NULL, PLOT_BAND, PLOT_BLACK, 2, p->level_s, p->level_mN},
        {NULL, PLOT_BAND, PLOT_ORANGE, p->before.n, p->before.time_s, p->before.band},
        {NULL, PLOT_LINE, PLOT_ORANGE, p->before.n, p->before.time_s, p->before.mean},
        {NULL, PLOT_BAND, PLOT_BLUE, p->after.n, p->after.time_s, p->after.band},
        {NULL, PLOT_LINE, PLOT_BLUE, p->after.n, p->after.time_s, p->after.mean}};
    const plot_figure figure = {.title = title,
                                .n_panels = 1,
                                .panel = {{.x_label = "time (s)",
                                           .y_label = "force (mN)",
                                           .n_series = two ? SERIES : 3,
                                           .series = series,
                                           .y_low = -most_mN,
                                           .y_high = most_mN}}};
    plot_draw(figures, "explain_residuals", &figure);
}

/* ---- the figures ---- */

/* The runs with the largest residuals, in their own order. */
static size_t choose(const palp_explanation *e, size_t shown[SHOWN]) {
    size_t n = 0;
    for (size_t r = 0; r < e->n_runs; r++) {
        double own = mean_square(&e->run[r], e->run[r].before_N);
        size_t before = 0;
        for (size_t k = 0; k < e->n_runs; k++) {
            double other = mean_square(&e->run[k], e->run[k].before_N);
            before += other > own || (other == own && k < r);
        }
        if (before < SHOWN)
            shown[n++] = r;
    }
    return n;
}

void explain_figures(json_t *figures, const palp_explanation *e) {
    size_t shown[SHOWN], n = choose(e, shown);
    double most = 2 * e->gap.noise_level_N;
    for (size_t k = 0; k < n; k++) {
        const palp_explain_run *run = &e->run[shown[k]];
        double peak = largest(run, run->before_N); /* but for spikes */
        most = fmax(most, fmin(1.05 * peak, 6 * sqrt(mean_square(run, run->before_N))));
    }
    panel *p = calloc(n + 1, sizeof *p);
    for (size_t k = 0; p && k < n; k++)
        draw(figures, &p[k], &e->run[shown[k]], e, 1e3 * most);
    free(p);
}
