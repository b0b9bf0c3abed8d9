/* explain_gap.c: the noise level, what is left of runs that a fit has not seen, and the threshold of chance. */
#include "explain_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

palp_status explain_noise_level(const explain_data *data, const explain_fit *fit, const double *force, double *noise_level_N) {
    palp_model *moved = malloc(sizeof *moved);
    double *other = malloc(data->longest * sizeof *other), slope = 0.0, load = 0.0, white = 0.0, step = 1e-6;
    double jump = 100.0 * step * data->peak / data->deepest; /* a plate that lets go a sample earlier has no slope */
    palp_status status = moved && other ? PALP_OK : PALP_ERR_NO_MEMORY;
    explain_wear wear = {.wear.peak = 0.0};
    if (!status)
        *moved = fit->model;
    for (size_t r = 0, at = 0; r < data->n_runs && !status; at += data->run[r++].n) {
        const explain_run *run = &data->run[r];
        double *depth = malloc(run->n * sizeof *depth);
        status = depth ? PALP_OK : PALP_ERR_NO_MEMORY;
        for (size_t i = 0; i < run->n && depth; i++)
            depth[i] = run->depth[i] + step;
        palp_forward_run path = explain_forward_run(run, &wear);
        path.depth_m = depth;
        if (!status)
            status = explain_predict(moved, &path, other, NULL, NULL);
        bool known = status != PALP_ERR_NOT_CONVERGED; /* no solution a micrometre on: the slope of the others */
        status = known ? status : PALP_OK;
        for (size_t i = 0; i < run->n && known && !status; i++) {
            if (!run->use[i])
                continue;
            double change = other[i] - force[at + i];
            slope += fabs(change) < jump ? pow(change / step, 2) : 0.0;
            load += force[at + i] * force[at + i];
        }
        white += run->white * run->white * (double)run->n;
        free(depth);
    }
    palp_forward_wear_free(&wear.wear);
    double n = (double)data->n;
    *noise_level_N = sqrt(white / n + data->correlated * data->correlated + pow(fit->scatter.gain, 2) * load / n +
                    pow(fit->scatter.contact, 2) * slope / n);
    free(moved);
    free(other);
    return status;
}

size_t explain_samples(const explain_data *data) {
    size_t n = 0;
    for (size_t r = 0; r < data->n_runs; r++)
        n += data->run[r].held_out ? 0 : data->run[r].n;
    return n;
}

double explain_chi2(const explain_data *data, const explain_fit *fit) {
    double sum = 0.0, chi2, logdet;
    for (size_t r = 0; r < data->n_runs; r++) {
        if (data->run[r].held_out)
            continue;
        explain_normal_of(fit, r, NULL, NULL, &chi2, &logdet);
        sum += chi2;
    }
    return sum / (double)explain_samples(data);
}

/* ---- held out ---- */

enum { REFIT = 4, REFIT_NETWORK = 1 }; /* rounds; a network's are dear */

typedef struct left_out {
    const explain_search *search;
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
    double *force = malloc(2 * data->n * sizeof *force), limit = l->some ? HUGE_VAL : 1.01 * deepest_without(data, r);
    palp_status status = force ? explain_fit_copy(&l->search->fit, data->n_runs, &fit) : PALP_ERR_NO_MEMORY;
    if (!status && !l->some && data->n_runs > 1)
        status = refit_without(data, r, &fit);
    if (!status)
        status = explain_fit_products(&fit, data, force);
    if (!status) {
        double *residual = force + data->n;
        size_t at = 0;
        explain_residual(data, &fit, force, residual);
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

palp_status explain_held_out(const explain_search *s, double *rms_N) {
    size_t n = s->data.n_runs;
    left_out l = {.search = s, .square = calloc(2 * n, sizeof(double)), .status = calloc(n, sizeof *l.status)};
    palp_status status = l.square && l.status ? PALP_OK : PALP_ERR_NO_MEMORY;
    double square = 0.0, count = 0.0;
    for (size_t r = 0; r < n; r++)
        l.some = l.some || s->data.run[r].held_out;
    l.count = l.square ? l.square + n : NULL;
    if (!status && s->settings->loop)
        s->settings->loop(s->settings->loop_user, n, leave_out_task, &l);
    for (size_t r = 0; r < n && !status && !s->settings->loop; r++)
        leave_out_task(&l, r);
    for (size_t r = 0; r < n && !status; r++) {
        status = l.status[r];
        square += l.square[r];
        count += l.count[r];
    }
    *rms_N = count > 0.0 ? sqrt(square / count) : 0.0;
    free(l.square);
    free(l.status);
    return status;
}
