/* grid.c: shared arms by the grid of Section 4.3.3. */
#include <palpate/thesis.h>

#include "base/file.h"
#include "fit/fit_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 21 }; /* 20 intervals */

/* Curves of one arm on the grid of K and b for one recording: a quarter gigabyte never, since recordings
 * come in blocks. */
typedef struct grid {
    size_t n_arms;
    double low_k[2], step_k[2], low_b[2], step_b[2];
    double *total; /* sum of |residual| by combination, [STEPS^(2 n_arms)] */
    double *curve; /* [n_arms STEPS^2 longest] */
    size_t longest;
} grid;

static void find_grid_range(size_t n, const palp_lumped_fit *fits, size_t arm, bool stiffness, double *low,
                            double *step) {
    double high = 0.0;
    *low = HUGE_VAL;
    for (size_t r = 0; r < n; r++) {
        const palp_arm *a = &fits[r].material.arms[arm];
        double v = stiffness ? a->stiffness_N : a->viscosity_Ns;
        *low = fmin(*low, v);
        high = fmax(high, v);
    }
    *step = (high - *low) / (STEPS - 1);
}

static void tabulate_arm_responses(grid *g, const fit_run *run) {
    for (size_t j = 0; j < g->n_arms; j++)
        for (size_t c = 0; c < STEPS * STEPS; c++) {
            double k = g->low_k[j] + g->step_k[j] * (double)(c / STEPS),
                   b = g->low_b[j] + g->step_b[j] * (double)(c % STEPS);
            double *curve = g->curve + (j * STEPS * STEPS + c) * g->longest;
            fit_arm_response(run, b / k, curve, NULL);
            for (size_t i = 0; i < run->n; i++)
                curve[i] *= k;
        }
}

/* Adds one recording's residual to every combination. work[longest] holds measured minus spring. */
static void add_recording_residuals(grid *g, const fit_run *run, double spring, double *work) {
    const size_t pairs = STEPS * STEPS;
    tabulate_arm_responses(g, run);
    for (size_t i = 0; i < run->n; i++)
        work[i] = run->force[i] - spring * run->strain[i];
    for (size_t a = 0; a < pairs; a++)
        for (size_t b = 0; b < (g->n_arms == 2 ? pairs : 1); b++) {
            const double *first = g->curve + a * g->longest, *second = g->curve + (pairs + b) * g->longest;
            double sum = 0.0;
            for (size_t i = 0; i < run->n; i++)
                sum += run->count[i] * fabs(work[i] - first[i] - (g->n_arms == 2 ? second[i] : 0.0));
            g->total[a * (g->n_arms == 2 ? pairs : 1) + b] += sum;
        }
}

static palp_status search_best_combination(fit_problem *p, const palp_lumped_fit *fits,
                                           palp_lumped_fit *fit) {
    size_t pairs = STEPS * STEPS, combinations = p->n_arms == 2 ? pairs * pairs : pairs, best = 0;
    grid g = {.n_arms = p->n_arms};
    for (size_t r = 0; r < p->n_runs; r++)
        g.longest = p->run[r].n > g.longest ? p->run[r].n : g.longest;
    for (size_t j = 0; j < p->n_arms; j++) {
        find_grid_range(p->n_runs, fits, j, true, &g.low_k[j], &g.step_k[j]);
        find_grid_range(p->n_runs, fits, j, false, &g.low_b[j], &g.step_b[j]);
    }
    g.total = calloc(combinations, sizeof *g.total);
    g.curve = malloc((2 * pairs + 1) * g.longest * sizeof *g.curve);
    palp_status status = g.total && g.curve ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t r = 0; r < p->n_runs && !status; r++)
        add_recording_residuals(&g, &p->run[r], fits[r].spring_N[0], g.curve + 2 * pairs * g.longest);
    for (size_t c = 1; c < combinations && !status; c++)
        best = g.total[c] < g.total[best] ? c : best;
    for (size_t j = 0; j < p->n_arms && !status; j++) {
        size_t c = p->n_arms == 2 ? (j == 0 ? best / pairs : best % pairs) : best;
        fit->material.arms[j] = (palp_arm){.stiffness_N = g.low_k[j] + g.step_k[j] * (double)(c / STEPS),
                                           .viscosity_Ns = g.low_b[j] + g.step_b[j] * (double)(c % STEPS)};
    }
    free(g.total);
    free(g.curve);
    return status;
}

/* A fit of every recording on its own gives the ranges and K_inf. */
static palp_status fit_each_recording(size_t n, const palp_recording *recordings,
                                      const palp_characterize_settings *settings, palp_lumped_fit *fits,
                                      palp_error *error) {
    palp_status status = PALP_OK;
    for (size_t r = 0; r < n && !status; r++) {
        status = palp_characterize_fit(1, &recordings[r], settings, &fits[r], error);
        if (!status && fits[r].material.n_arms != settings->n_arms)
            status = palp_error_set(error, PALP_ERR_INPUT, "%s: does not identify %zu arms",
                                    recordings[r].name, settings->n_arms);
    }
    return status;
}

static palp_status fill_grid_result(size_t n, const palp_recording *recordings,
                                    const palp_characterize_settings *settings, const palp_lumped_fit *fits,
                                    palp_lumped_fit *fit) {
    double middle = 0.0;
    fit->n_runs = n;
    fit->spring_N = malloc(n * sizeof(double));
    fit->rms_N = calloc(n, sizeof(double));
    fit->absolute_N = calloc(n, sizeof(double));
    if (!fit->spring_N || !fit->rms_N || !fit->absolute_N)
        return PALP_ERR_NO_MEMORY;
    for (size_t r = 0; r < n; r++) {
        fit->spring_N[r] = fits[r].spring_N[0];
        middle += fit->spring_N[r] / (double)n;
    }
    palp_status status = palp_law_polynomial(1, &middle, &fit->material.law);
    fit->converged = true;
    return status ? status : fit_fill_residuals(n, recordings, settings, fit);
}

palp_status palp_thesis_grid(size_t n, const palp_recording *recordings,
                             const palp_characterize_settings *settings, palp_lumped_fit *fit,
                             palp_error *error) {
    if (!recordings || !settings || !fit)
        return palp_error_null(error);
    memset(fit, 0, sizeof *fit);
    if (settings->n_arms < 1 || settings->n_arms > 2)
        return palp_error_set(error, PALP_ERR_UNSUPPORTED, "the grid search supports one or two arms only");
    palp_characterize_settings each = *settings;
    each.spring = PALP_SPRING_PER_RUN;
    fit_problem p;
    palp_status status = fit_problem_create(&p, n, recordings, &each, error);
    if (status)
        return status;
    palp_lumped_fit *fits = calloc(n, sizeof *fits);
    status = fits ? fit_each_recording(n, recordings, &each, fits, error) : PALP_ERR_NO_MEMORY;
    fit->material.n_arms = settings->n_arms;
    if (!status)
        status = search_best_combination(&p, fits, fit);
    if (!status)
        status = fill_grid_result(n, recordings, &each, fits, fit);
    for (size_t r = 0; fits && r < n; r++)
        palp_lumped_fit_free(&fits[r]);
    free(fits);
    fit_problem_free(&p);
    if (status)
        palp_lumped_fit_free(fit);
    return status;
}
