/* explain_gap.c: the floor, what is left of runs that a fit has not seen, and the threshold of chance. */
#include "explain_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

palp_status explain_floor(const explain_data *data, const explain_fit *fit, const double *force, double *floor_N) {
    palp_model *moved = malloc(sizeof *moved);
    double *other = malloc(data->longest * sizeof *other), slope = 0.0, load = 0.0, white = 0.0, step = 1e-6;
    palp_status status = moved && other ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status)
        *moved = fit->model;
    for (size_t r = 0, at = 0; r < data->n_runs && !status; at += data->run[r++].n) {
        const explain_run *run = &data->run[r];
        double *depth = malloc(run->n * sizeof *depth);
        status = depth ? PALP_OK : PALP_ERR_NO_MEMORY;
        for (size_t i = 0; i < run->n && depth; i++)
            depth[i] = run->depth[i] + step;
        palp_forward_run path = explain_forward_run(run);
        path.depth_m = depth;
        if (!status)
            status = explain_predict(moved, &path, other, NULL, NULL);
        bool known = status != PALP_ERR_NOT_CONVERGED; /* no solution a micrometre on: the slope of the others */
        status = known ? status : PALP_OK;
        for (size_t i = 0; i < run->n && known && !status; i++) {
            if (!run->use[i])
                continue;
            slope += pow((other[i] - force[at + i]) / step, 2);
            load += force[at + i] * force[at + i];
        }
        white += run->white * run->white * (double)run->n;
        free(depth);
    }
    double n = (double)data->n;
    *floor_N = sqrt(white / n + data->coloured * data->coloured + pow(fit->scatter.gain, 2) * load / n +
                    pow(fit->scatter.contact, 2) * slope / n);
    free(moved);
    free(other);
    return status;
}

size_t explain_samples(const explain_data *data) {
    size_t n = 0;
    for (size_t r = 0; r < data->n_runs; r++)
        n += data->run[r].held ? 0 : data->run[r].n;
    return n;
}

double explain_chi2(const explain_data *data, const explain_fit *fit) {
    double sum = 0.0, chi2, logdet;
    for (size_t r = 0; r < data->n_runs; r++) {
        if (data->run[r].held)
            continue;
        explain_normal_of(fit, r, NULL, NULL, &chi2, &logdet);
        sum += chi2;
    }
    return sum / (double)explain_samples(data);
}

/* ---- held out ---- */

static palp_status held_model(const explain_fit *fit, const double *step, palp_model *model) {
    double value[EXPLAIN_COLUMNS];
    size_t law = fit->model.material.law.n;
    for (size_t k = 0; k < fit->n_columns; k++) {
        double x = fmin(fit->high[k], fmax(fit->low[k], fit->x[k] + step[k]));
        value[k] = fit->logarithmic[k] ? exp(x) : x;
    }
    for (size_t j = 0; j < fit->model.material.n_arms; j++)
        value[law + 2 * j + 1] *= value[law + 2 * j];
    *model = fit->model;
    return palp_forward_set(model, value);
}

palp_status explain_held_out(const explain_data *data, const explain_fit *fit, double *rms_N) {
    size_t k = fit->n_columns, n = data->n_runs, count = 0;
    double *step = calloc(n * k + n, sizeof *step), *force = malloc(data->n * sizeof *force), sum = 0.0;
    double *residual = malloc(data->n * sizeof *residual);
    palp_model *model = malloc(sizeof *model);
    bool some = false;
    palp_status status = step && force && residual && model ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status)
        status = explain_fit_leave_out(fit, data, step + n * k, step);
    for (size_t r = 0, at = 0; r < n && !status; at += data->run[r++].n) {
        palp_forward_run path = explain_forward_run(&data->run[r]);
        if (held_model(fit, step + r * k, model) || explain_predict(model, &path, force + at, NULL, NULL))
            status = explain_predict(&fit->model, &path, force + at, NULL, NULL);
        some = some || data->run[r].held;
    }
    if (!status)
        explain_residual(data, fit, force, residual);
    for (size_t r = 0, at = 0; r < n && !status; at += data->run[r++].n)
        for (size_t i = 0; i < data->run[r].n; i++)
            if ((!some || data->run[r].held) && data->run[r].use[i]) {
                sum += residual[at + i] * residual[at + i];
                count++;
            }
    *rms_N = count ? sqrt(sum / (double)count) : 0.0;
    free(step);
    free(force);
    free(residual);
    free(model);
    return status;
}
