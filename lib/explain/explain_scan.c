/* explain_scan.c: the interval of a bond to the plate. Which sample is the last before it lets go changes
 * with its force and its reach from one to the next: the likelihood is a staircase, of which slopes say
 * nothing. It is summed over a grid of both. */
#include "explain_result.h"

#include <math.h>
#include <stdlib.h>

enum { FORCES = 21, REACHES = 6, CELLS = FORCES * REACHES };

static const double OUT = 0.025; /* of the likelihood, on either side of an interval */

typedef struct scan {
    const explain_search *search;
    size_t at;                            /* column of the force; the reach's is the next */
    double force[FORCES], reach[REACHES]; /* in search coordinates, rising */
    double chi2[CELLS], most;             /* of force i and reach j: i * REACHES + j; the least of all */
    palp_status status[FORCES];
} scan;

/* chi2 that the other numbers can reach beside that force and reach. */
static double cell_chi2(explain_fit *fit, const explain_data *data, size_t at, double force, double reach) {
    enum { ROUNDS = 1 };
    double chi2 = HUGE_VAL;
    fit->low[at] = fit->high[at] = fit->x[at] = force;
    fit->low[at + 1] = fit->high[at + 1] = fit->x[at + 1] = reach;
    palp_status status = explain_fit_to_model(fit);
    if (!status)
        status = explain_fit_products(fit, data, NULL);
    if (!status)
        status = explain_fit_improve(fit, data, ROUNDS);
    if (!status)
        status = explain_fit_predict(fit, data, &chi2);
    return status ? HUGE_VAL : chi2;
}

static void force_task(void *user, size_t i) {
    scan *w = user;
    const explain_data *data = &w->search->data;
    for (size_t j = 0; j < REACHES; j++) {
        explain_fit fit;
        w->status[i] = explain_fit_copy(&w->search->fit, data->n_runs, &fit);
        if (w->status[i])
            return;
        w->chi2[i * REACHES + j] = cell_chi2(&fit, data, w->at, w->force[i], w->reach[j]);
        explain_fit_free(&fit);
    }
}

/* The refit of the other numbers crosses none of their own steps, so that beside any force and reach a
 * release may be a sample early or late: what that costs says nothing of the two. */
static double likelihood(const scan *w, size_t i, size_t j) {
    const explain_data *data = &w->search->data;
    const double widened = fmax(1.0, w->most / (double)explain_samples(data)),
                 step = pow(w->force[i] / explain_noise_level(data), 2);
    return exp(-0.5 * fmax(0.0, w->chi2[i * REACHES + j] - w->most - step) / widened);
}

/* From low to high, each so many times the one before. */
static palp_status scan_forces(scan *w, double low, double high) {
    for (size_t i = 0; i < FORCES; i++)
        w->force[i] = low * pow(high / low, (double)i / (FORCES - 1));
    palp_status status = explain_each(w->search->settings, FORCES, force_task, w, w->status);
    w->most = HUGE_VAL;
    for (size_t c = 0; c < CELLS; c++)
        w->most = fmin(w->most, w->chi2[c]);
    return status ? status : isfinite(w->most) ? PALP_OK : PALP_ERR_NOT_CONVERGED;
}

/* The first and last of n likelihoods beyond which there is no more than a share of their sum. */
static void ends(size_t n, const double *likely, double share, size_t *first, size_t *last) {
    double sum = 0.0, before = 0.0, after = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += likely[i];
    for (*first = 0; *first + 1 < n && before + likely[*first] <= share * sum; (*first)++)
        before += likely[*first];
    for (*last = n - 1; *last > 0 && after + likely[*last] <= share * sum; (*last)--)
        after += likely[*last];
}

static void force_ends(const scan *w, double share, size_t *first, size_t *last) {
    double likely[FORCES] = {0.0};
    for (size_t i = 0; i < FORCES; i++)
        for (size_t j = 0; j < REACHES; j++)
            likely[i] += likelihood(w, i, j);
    ends(FORCES, likely, share, first, last);
}

/* Around the fit's own, and so short ones that the surface stays on the plate up to the force. */
static void place_reaches(scan *w) {
    static const double parts[REACHES - 1] = {0.3, 0.6, 1.0, 1.6, 3.0}, none = 1e-2;
    const explain_fit *fit = &w->search->fit;
    const size_t at = w->at + 1;
    w->reach[0] = fit->low[at] + log(none);
    for (size_t j = 1; j < REACHES; j++)
        w->reach[j] = fmin(fit->high[at], fit->x[at] + log(parts[j - 1]));
}

palp_status explain_scan_bond(const explain_search *s, size_t at, double low[2], double high[2]) {
    static const double FAR = 2.0, SLIGHT = 1e-4;
    size_t first, last, near, far;
    scan *w = calloc(1, sizeof *w);
    palp_status status = w ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status) {
        *w = (scan){.search = s, .at = at};
        place_reaches(w);
        status = scan_forces(w, s->fit.x[at] / FAR, s->fit.x[at] * FAR);
    }
    if (!status) { /* closer */
        force_ends(w, SLIGHT, &first, &last);
        status = scan_forces(w, w->force[first > 0 ? first - 1 : 0],
                             w->force[last + 1 < FORCES ? last + 1 : last]);
    }
    if (!status) {
        double likely[REACHES] = {0.0};
        force_ends(w, OUT, &first, &last);
        for (size_t i = 0; i < FORCES; i++)
            for (size_t j = 0; j < REACHES; j++)
                likely[j] += likelihood(w, i, j);
        ends(REACHES, likely, OUT, &near, &far);
        low[0] = fmin(s->fit.x[at], w->force[first > 0 ? first - 1 : 0]);
        high[0] = fmax(s->fit.x[at], w->force[last + 1 < FORCES ? last + 1 : last]);
        low[1] = fmin(s->fit.x[at + 1], w->reach[near]);
        high[1] = fmax(s->fit.x[at + 1], w->reach[far]);
    }
    free(w);
    return status;
}
