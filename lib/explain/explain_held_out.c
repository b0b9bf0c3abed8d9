/* explain_held_out.c: what a fit leaves of runs that it has not seen. */
#include "explain_search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { REFIT = 4, REFIT_NETWORK = 1 }; /* rounds; a network's are dear */

typedef struct left_out {
    const explain_search *search;
    const explain_fit *fit;
    bool some;              /* runs are held out: the fit as it is tells of them */
    double *square, *count; /* [n_runs] of the residual of each run */
    palp_status *status;    /* [n_runs] */
} left_out;

/* The deepest of the runs other than r: deeper the fit without r would be extrapolated. */
static double deepest_without(const explain_data *data, size_t r) {
    double deepest = -HUGE_VAL;
    for (size_t k = 0; k < data->n_runs; k++)
        for (size_t i = 0; i < data->run[k].n && k != r && !data->run[k].held_out; i++)
            deepest = fmax(deepest, data->run[k].depth[i]);
    return deepest;
}

/* *fit refitted without run r. */
static palp_status refit_without(const explain_data *data, size_t r, explain_fit *fit) {
    explain_data less = *data;
    less.run = malloc(data->n_runs * sizeof *less.run);
    if (!less.run)
        return PALP_ERR_NO_MEMORY;
    memcpy(less.run, data->run, data->n_runs * sizeof *less.run);
    less.run[r].held_out = true;
    bool network = fit->model.kind == PALP_MODEL_NETWORK;
    palp_status status = explain_fit_improve(fit, &less, network ? REFIT_NETWORK : REFIT);
    free(less.run);
    return status;
}

static palp_status leave_out(const left_out *l, size_t r) {
    const explain_data *data = &l->search->data;
    explain_fit fit = {.n_columns = 0};
    double *force = malloc(2 * data->n * sizeof *force),
           limit = l->some ? HUGE_VAL : 1.01 * deepest_without(data, r);
    palp_status status = force ? explain_fit_copy(l->fit, data->n_runs, &fit) : PALP_ERR_NO_MEMORY;
    if (!status && !l->some && data->n_runs > 1)
        status = refit_without(data, r, &fit);
    if (!status)
        status = explain_fit_evaluate(&fit, data, force, force + data->n);
    if (!status) {
        const double *residual = force + data->n;
        size_t at = 0;
        for (size_t k = 0; k < r; k++)
            at += data->run[k].n;
        for (size_t i = 0; i < data->run[r].n; i++)
            if (data->run[r].use[i] && (data->n_runs == 1 || data->run[r].depth[i] <= limit)) {
                l->square[r] += residual[at + i] * residual[at + i];
                l->count[r] += 1.0;
            }
    }
    explain_fit_free(&fit);
    free(force);
    return status;
}

static void leave_out_task(void *user, size_t r) {
    left_out *l = user;
    if (!l->some || l->search->data.run[r].held_out)
        l->status[r] = leave_out(l, r);
}

palp_status explain_held_out(const explain_search *s, const explain_fit *fit, double *rms_N) {
    size_t n = s->data.n_runs;
    left_out l = {.search = s,
                  .fit = fit,
                  .square = calloc(2 * n, sizeof(double)),
                  .status = calloc(n, sizeof *l.status)};
    palp_status status = l.square && l.status ? PALP_OK : PALP_ERR_NO_MEMORY;
    double square = 0.0, count = 0.0;
    for (size_t r = 0; r < n; r++)
        l.some = l.some || s->data.run[r].held_out;
    l.count = l.square ? l.square + n : NULL;
    if (!status)
        status = explain_each(s->settings, n, leave_out_task, &l, l.status);
    for (size_t r = 0; r < n && !status; r++) {
        square += l.square[r];
        count += l.count[r];
    }
    *rms_N = count > 0.0 ? sqrt(square / count) : 0.0;
    free(l.square);
    free(l.status);
    return status;
}
