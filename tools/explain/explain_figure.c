/* explain_figure.c: recorded minus model over time, run by run, as given and with the effects: small panels
 * of one scale. */
#include "explain.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PANELS = PLOT_PANELS_MAX, COLUMNS = 2, BINS = 263, SERIES = 5 };

/* ---- curves: what falls on one bin is a mean, and a lowest and highest ---- */

typedef struct curve {
    size_t n;
    double time_s[BINS], mean[BINS], band[2 * BINS]; /* mN; band: n lowest, then n highest */
} curve;

typedef struct panel {
    char title[96];
    double level_s[2], level_mN[4];
    curve before, after;
    plot_series series[SERIES];
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

/* Of a name that is too long its start and its end: what tells runs apart may be either. */
static void short_name(const char *name, char text[48]) {
    size_t n = strlen(name);
    if (n <= 40)
        snprintf(text, 48, "%s", name);
    else
        snprintf(text, 48, "%.18s...%s", name, name + n - 19);
}

static plot_panel make_panel(panel *p, const palp_explain_run *run, const palp_explanation *e,
                             double most_mN) {
    const double level = 1e3 * e->gap.noise_level_N;
    bool two = e->n_effects > 0;
    char name[48];
    short_name(cli_base(run->name), name);
    int n = snprintf(p->title, sizeof p->title, "%s   rms %.3g", name,
                     1e3 * sqrt(mean_square(run, run->before_N)));
    snprintf(p->title + n, sizeof p->title - (size_t)n, two ? " \u2192 %.3g mN" : " mN",
             1e3 * sqrt(mean_square(run, run->after_N)));
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
    memcpy(p->series, series, sizeof series);
    return (plot_panel){.x_label = "time (s)",
                        .y_label = "mN",
                        .n_series = two ? SERIES : 3,
                        .series = p->series,
                        .title = p->title,
                        .y_low = -most_mN,
                        .y_high = most_mN};
}

/* ---- the figure ---- */

/* The runs with the largest residuals, in their own order. */
static size_t choose(const palp_explanation *e, size_t shown[PANELS]) {
    size_t n = 0;
    for (size_t r = 0; r < e->n_runs; r++) {
        double own = mean_square(&e->run[r], e->run[r].before_N);
        size_t before = 0;
        for (size_t k = 0; k < e->n_runs; k++) {
            double other = mean_square(&e->run[k], e->run[k].before_N);
            before += other > own || (other == own && k < r);
        }
        if (before < PANELS)
            shown[n++] = r;
    }
    return n;
}

void explain_figure(plot_book *book, const palp_explanation *e) {
    size_t shown[PANELS], n = choose(e, shown);
    panel *p = calloc(PANELS, sizeof *p);
    plot_figure figure = {.n_panels = n,
                          .columns = COLUMNS,
                          .width = 600 * COLUMNS,
                          .height = 230 * (unsigned)((n + COLUMNS - 1) / COLUMNS)};

    double most = 2 * e->gap.noise_level_N;
    if (!p) {
        book->result = PLOT_FAILED;
        return;
    }
    for (size_t k = 0; k < n; k++) {
        const palp_explain_run *run = &e->run[shown[k]];
        double peak = largest(run, run->before_N); /* but for spikes */
        most = fmax(most, fmin(1.05 * peak, 6 * sqrt(mean_square(run, run->before_N))));
    }
    for (size_t k = 0; k < n; k++)
        figure.panel[k] = make_panel(&p[k], &e->run[shown[k]], e, 1e3 * most);
    plot_draw(book, "explain_residuals", &figure);
    free(p);
}
