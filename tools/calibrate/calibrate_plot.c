/* calibrate_plot.c: the figures of palpate calibrate; the page draws the convergence from the result. */
#include "calibrate.h"
#include "shared/plot.h"

#include <math.h>

enum { CURVE_POINTS = 400, MARKS = 60, LAW_POINTS = 200, SHOWN_MAX = 7 };

static void plot_fit(json_t *figures, const calibrate_state *s) {
    const palp_calibration *c = &s->static_result;
    double depth[CURVE_POINTS], force[CURVE_POINTS], miss[CURVE_POINTS], mark[MARKS], wanted[MARKS];
    if (c->n_samples == 0)
        return;
    for (size_t k = 0; k < CURVE_POINTS; k++) {
        size_t i = k * (c->n_samples - 1) / (CURVE_POINTS - 1);
        depth[k] = 1e3 * c->depth_m[i];
        force[k] = c->force_N[i];
        miss[k] = 1e3 * (c->force_N[i] - c->target_N[i]);
    }
    for (size_t k = 0; k < MARKS; k++) {
        size_t i = k * (c->n_samples - 1) / (MARKS - 1);
        mark[k] = 1e3 * c->depth_m[i];
        wanted[k] = c->target_N[i];
    }
    const plot_series curve[] = {{"wanted", PLOT_POINTS, 0, MARKS, mark, wanted},
                                 {"network", PLOT_LINE, 1, CURVE_POINTS, depth, force}};
    const plot_series residual = {NULL, PLOT_LINE, 1, CURVE_POINTS, depth, miss};
    const plot_figure figure = {
        .title = "Static press: the wanted curve and the calibrated network",
        .n_panels = 2,
        .panel = {{.x_label = "", .y_label = "force (N)", .n_series = 2, .series = curve},
                  {.x_label = "depth (mm)",
                   .y_label = "network - wanted (mN)",
                   .n_series = 1,
                   .series = &residual}}};
    plot_draw(figures, "static_fit", &figure);
}

static void plot_law(json_t *figures, const calibrate_state *s) {
    double strain[LAW_POINTS], lumped[LAW_POINTS], element[LAW_POINTS];
    double strain_max = s->n_static ? s->depth_m[s->n_static - 1] / s->height_m : 0;
    for (size_t i = 0; i < s->n_presses; i++)
        strain_max = fmax(strain_max, s->press[i].depth_m / s->height_m);
    for (size_t i = 0; i < LAW_POINTS; i++) {
        strain[i] = strain_max * (double)i / (LAW_POINTS - 1);
        palp_law_stiffness(&s->lumped.material.law, strain[i], &lumped[i], NULL);
        palp_law_stiffness(&s->model.material.law, strain[i], &element[i], NULL);
    }
    const plot_series series[] = {{"lumped model", PLOT_LINE, 0, LAW_POINTS, strain, lumped},
                                  {"element", PLOT_LINE, 1, LAW_POINTS, strain, element}};
    const plot_figure figure = {.title = "Stiffness law K(e) of the lumped model and of an element",
                                .n_panels = 1,
                                .panel = {{.x_label = "strain e",
                                           .y_label = "stiffness K (N)",
                                           .y_log = true,
                                           .n_series = 2,
                                           .series = series}}};
    plot_draw(figures, "stiffness", &figure);
}

/* Samples thinned evenly in log time for the marks; returns how many. */
static size_t marks(const record *run, const double *wanted, double *time_s, double *force_N) {
    size_t n = 0;
    double next = 0;
    for (size_t i = 0; i < run->n && n < MARKS; i++) {
        if (run->time_s[i] > 0 && run->time_s[i] >= next) {
            time_s[n] = run->time_s[i];
            force_N[n++] = wanted[i];
            next = fmax(1.15 * run->time_s[i], 1e-3 * run->time_s[run->n - 1]);
        }
    }
    return n;
}

static void plot_relaxation(json_t *figures, const calibrate_state *s, bool log_time) {
    double mark_s[SHOWN_MAX][MARKS], mark_N[SHOWN_MAX][MARKS];
    char title[SHOWN_MAX][32];
    plot_series series[2 * SHOWN_MAX];
    size_t shown = s->n_presses < SHOWN_MAX ? s->n_presses : SHOWN_MAX;
    for (size_t k = 0; k < shown; k++) {
        /* of many depths some, with the shallowest and deepest */
        const press_target *p = &s->press[shown > 1 ? k * (s->n_presses - 1) / (shown - 1) : 0];
        size_t first = log_time && p->network.n > 1 && p->network.time_s[0] <= 0 ? 1 : 0;
        size_t n = marks(&p->network, p->wanted_N, mark_s[k], mark_N[k]);
        snprintf(title[k], sizeof title[k], "%.3g mm", 1e3 * p->depth_m);
        series[2 * k] = (plot_series){NULL, PLOT_POINTS, (int)k, n, mark_s[k], mark_N[k]};
        series[2 * k + 1] = (plot_series){title[k],
                                          PLOT_LINE,
                                          (int)k,
                                          p->network.n - first,
                                          p->network.time_s + first,
                                          p->network.force_N + first};
    }
    const plot_figure figure = {.title = "Ramp and hold: wanted (circles) and the calibrated network (lines)",
                                .n_panels = 1,
                                .panel = {{.x_label = "time (s)",
                                           .y_label = "force (N)",
                                           .x_log = log_time,
                                           .n_series = 2 * shown,
                                           .series = series}}};
    plot_draw(figures, log_time ? "relaxation_log" : "relaxation_linear", &figure);
}

json_t *calibrate_figures(const calibrate_state *s) {
    json_t *figures = json_array();
    plot_law(figures, s);
    if (s->does_static)
        plot_fit(figures, s);
    if (s->does_relaxation) {
        plot_relaxation(figures, s, false);
        plot_relaxation(figures, s, true);
    }
    return figures;
}
