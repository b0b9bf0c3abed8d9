/* characterize_plot.c: the figures of palpate characterize that need the recordings: the page draws the
 * others from the result. */
#include "characterize.h"

#include <stdlib.h>

static const char NAME[] = "characterize";

static int make_curves(const characterize_state *s, run_curve *curve) {
    for (size_t i = 0; i < s->n; i++) {
        const palp_recording *r = &s->run[i];
        curve[i] =
            (run_curve){r, s->filtered_N[i], s->has_final ? malloc(r->n * sizeof(double)) : NULL, NULL};
        if (s->has_final && (!curve[i].fit_N || palp_lumped_fit_force(&s->final, i, r, curve[i].fit_N)))
            return cli_failure(NAME, "%s: the fit's force could not be computed", r->name);
    }
    return CLI_OK;
}

json_t *characterize_figures(const characterize_state *s) {
    run_curve curve[CHARACTERIZE_RUNS_MAX] = {{NULL, NULL, NULL, NULL}};
    json_t *figures = make_curves(s, curve) == CLI_OK ? json_array() : NULL;
    if (figures && s->n > s->n_static) {
        plot_runs_recorded(figures, s->n - s->n_static, curve + s->n_static);
        if (s->has_final)
            plot_runs_fitted(figures, s->n - s->n_static, curve + s->n_static);
    }
    if (figures && s->n_static > 0) {
        plot_runs_depth(figures, "recordings_static", "Ramps without a dwell: raw (light) and filtered",
                        s->n_static, curve, false);
        if (s->has_final)
            plot_runs_depth(figures, "fit_static", "Ramps without a dwell: raw (light) and the fitted model",
                            s->n_static, curve, true);
    }
    for (size_t i = 0; i < s->n; i++)
        free(curve[i].fit_N);
    return figures;
}
