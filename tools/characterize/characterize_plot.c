/* characterize_plot.c: the figures of palpate characterize. */
#include "characterize.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "characterize";

enum { MARKS = 60, CURVE_POINTS = 200 };

/* ---- the static press and its polynomials, Figures 4.12 to 4.15 ---- */

/* Every so many samples in contact. */
static size_t static_marks(const palp_recording *r, double *strain, double *force_N) {
    size_t n = 0, every = r->n / MARKS + 1;
    for (size_t i = 0; i < r->n && n < MARKS; i += every) {
        if (r->use[i] && r->depth_m[i] > 0) {
            strain[n] = r->depth_m[i] / r->height_m;
            force_N[n++] = r->force_N[i];
        }
    }
    return n;
}

/* Means of polynomial minus measured over stretches of the press, in hundredths of the force. */
static size_t miss_of(const palp_recording *r, const palp_law *law, double peak_N, double *strain,
                      double *miss) {
    size_t n = 0, every = r->n / CURVE_POINTS + 1, count = 0;
    double sum = 0, sum_e = 0;
    for (size_t i = 0; i < r->n && n < CURVE_POINTS; i++) {
        double e = r->depth_m[i] / r->height_m, force = 0;
        if (r->use[i] && e > 0) {
            palp_law_force(law, 1, &e, &force, NULL, NULL);
            sum += 100 * (force - r->force_N[i]) / peak_N;
            sum_e += e;
            count++;
        }
        if (count == every) {
            strain[n] = sum_e / (double)count;
            miss[n++] = sum / (double)count;
            sum = sum_e = 0;
            count = 0;
        }
    }
    return n;
}

static void plot_static(plot_book *book, const characterize_state *s) {
    enum { SHOWN = 4 };
    static const char *const titles[SHOWN] = {"degree 2", "degree 3", "degree 4", "degree 5"};
    double mark[2][MARKS], curve_e[CURVE_POINTS], curve[SHOWN][CURVE_POINTS], miss_e[SHOWN][CURVE_POINTS + 1],
        miss[SHOWN][CURVE_POINTS + 1];
    plot_series force[SHOWN + 1], residual[SHOWN];
    const palp_recording *r = &s->run[0];
    size_t n = static_marks(r, mark[0], mark[1]);
    double peak_N = 0;
    for (size_t i = 0; i < r->n; i++)
        peak_N = r->use[i] ? fmax(peak_N, r->force_N[i]) : peak_N;
    force[0] = (plot_series){"measured", PLOT_POINTS, 6, n, mark[0], mark[1]};
    for (size_t i = 0; i < CURVE_POINTS; i++)
        curve_e[i] = r->deepest_m / r->height_m * (double)i / (CURVE_POINTS - 1);
    for (size_t k = 0; k < SHOWN; k++) {
        const palp_law *law = &s->plain[0][k + 2];
        palp_law_force(law, CURVE_POINTS, curve_e, curve[k], NULL, NULL);
        size_t m = miss_of(r, law, peak_N, miss_e[k], miss[k]);
        force[k + 1] = (plot_series){titles[k], PLOT_LINE, (int)k, CURVE_POINTS, curve_e, curve[k]};
        residual[k] = (plot_series){NULL, PLOT_LINE, (int)k, m, miss_e[k], miss[k]};
    }
    const plot_figure figure = {
        .title = "Ramp without a dwell: polynomials F(e) of degree 2 to 5",
        .n_panels = 2,
        .panel = {{.x_label = "", .y_label = "force (N)", .n_series = SHOWN + 1, .series = force},
                  {.x_label = "strain e",
                   .y_label = "fit - measured (% of the peak)",
                   .n_series = SHOWN,
                   .series = residual}}};
    plot_draw(book, "static_polynomials", &figure);
}

/* ---- K_inf, Figure 4.26 ---- */

static void plot_stiffness(plot_book *book, const characterize_state *s) {
    double strain[CHARACTERIZE_RUNS_MAX], k[3 * CHARACTERIZE_RUNS_MAX];
    law_line line[2] = {{s->n_static ? "joint law" : "law", s->material.law, false}};
    size_t n_lines = 1, n = s->n_gap;
    for (size_t i = 0; i < n; i++) {
        const characterize_gap *g = &s->gap[i];
        strain[i] = g->strain;
        k[i] = g->run_N;
        k[n + i] = isfinite(g->low_N) ? g->low_N : g->run_N;
        k[2 * n + i] = isfinite(g->high_N) ? g->high_N : g->run_N;
    }
    if (s->n_static > 0 && s->n_arms > 0)
        line[n_lines++] = (law_line){"static polynomial", s->plain[0][s->degree], true};
    double at[CHARACTERIZE_BAND], ends[2 * CHARACTERIZE_BAND];
    for (size_t i = 0; i < s->n_band; i++) {
        at[i] = s->band[i].strain;
        ends[i] = s->band[i].low_N;
        ends[s->n_band + i] = s->band[i].high_N;
    }
    const plot_series band = {"95 % band", PLOT_BAND, 0, s->n_band, at, ends};
    const plot_series points = {"ramp and hold", PLOT_BARS, PLOT_BLACK, n, strain, k};
    plot_runs_stiffness(
        book, "stiffness_law", "Stiffness law K(e), and K_inf of single depths with 95 % intervals",
        characterize_strain_max(s), n_lines, line, s->n_band ? &band : NULL, n ? &points : NULL);
}

/* ---- how many arms ---- */

static void plot_scores(plot_book *book, const char *name, const char *title, const char *label,
                        const characterize_scores *c, bool rms) {
    double x[DEGREE_MAX + 2];
    for (size_t k = 0; k < c->n; k++)
        x[k] = (double)(c->first + k);
    const size_t best = c->best - c->first;
    const plot_series score[] = {{"held out", PLOT_LINE_POINTS, 0, c->n, x, c->score},
                                 {"taken", PLOT_LINE_POINTS, 1, 1, x + best, c->score + best}};
    const plot_series ratio = {NULL, PLOT_LINE_POINTS, 2, c->n, x, c->rms_noise};
    plot_figure figure = {.title = title,
                          .n_panels = rms ? 2 : 1,
                          .panel = {{.x_label = rms ? "" : label,
                                     .y_label = "held-out error / noise variance",
                                     .y_scale = PLOT_LOG,
                                     .n_series = 2,
                                     .series = score},
                                    {.x_label = label,
                                     .y_label = "rms / noise",
                                     .y_scale = PLOT_LOG,
                                     .n_series = 1,
                                     .series = &ratio}}};
    figure.panel[0].x_counts = figure.panel[1].x_counts = true;
    plot_draw(book, name, &figure);
}

/* ---- recordings and fits ---- */

static int make_curves(const characterize_state *s, run_curve *curve) {
    for (size_t i = 0; i < s->n; i++) {
        const palp_recording *r = &s->run[i];
        curve[i] =
            (run_curve){r, s->filtered_N[i], s->has_final ? malloc(r->n * sizeof(double)) : NULL, NULL};
        if (curve[i].fit_N && palp_lumped_fit_force(&s->final, i, r, curve[i].fit_N))
            return cli_failure(NAME, "%s: the fit's force could not be computed", r->name);
    }
    return CLI_OK;
}

static void plot_timed(plot_book *book, size_t n, const run_curve *curve, bool fitted, double cutoff_Hz) {
    char title[160];
    snprintf(title, sizeof title,
             "Ramp and hold: raw (light) and filtered (Butterworth of order %d both ways, %.3g Hz)",
             RUN_FILTER_ORDER, cutoff_Hz);
    plot_runs_recorded(book, title, n, curve);
    if (fitted)
        plot_runs_fitted(book, "Ramp and hold: raw (light) and the fitted model",
                         "Force against depth: raw (light) and the fitted model",
                         "Residuals of the fitted model", n, curve);
}

static void plot_all(plot_book *book, const characterize_state *s, const run_curve *curve) {
    if (s->n > s->n_static)
        plot_timed(book, s->n - s->n_static, curve + s->n_static, s->has_final, s->cutoff_Hz);
    if (s->n_static > 0) {
        plot_runs_depth(book, "recordings_static", "Ramps without a dwell: raw (light) and filtered",
                        s->n_static, curve, false);
        plot_static(book, s);
        if (s->has_final)
            plot_runs_depth(book, "fit_static", "Ramps without a dwell: raw (light) and the fitted model",
                            s->n_static, curve, true);
    }
    plot_stiffness(book, s);
    characterize_plot_spectrum(book, s);
    characterize_plot_specimens(book, s);
    if (s->arms.n > 0)
        plot_scores(book, "arms_score", "How many arms: error on blocks left out of the fit",
                    "number of arms", &s->arms, true);
    if (s->degrees.n > 0)
        plot_scores(book, "degree_score", "Which degree: error on blocks left out of the fit",
                    "degree of F(e)", &s->degrees, false);
}

int characterize_plot(const characterize_options *o, const characterize_state *s) {
    plot_book book = {.command = NAME, .folder = o->plot};
    run_curve curve[CHARACTERIZE_RUNS_MAX] = {{NULL, NULL, NULL, NULL}};
    if (cli_folder(NAME, o->plot))
        return CLI_FAILURE;
    int code = make_curves(s, curve);
    if (code == CLI_OK)
        plot_all(&book, s, curve);
    for (size_t i = 0; i < s->n; i++)
        free(curve[i].fit_N);
    return code == CLI_OK ? plot_close(&book) : code;
}
