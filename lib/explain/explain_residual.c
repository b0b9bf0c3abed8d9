/* explain_residual.c: what a fit leaves of the forces, and the noise level beside it. */
#include "explain_fit.h"

#include <math.h>
#include <stdlib.h>

static const double TURN = 6.28318530717958647692;

double explain_rms(size_t n, const double *a, const double *b) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    }
    return sqrt(sum / (double)n);
}

double explain_fitted_rms(const explain_data *data, const double *x) {
    double sum = 0.0, count = 0.0;
    for (size_t r = 0, at = 0; r < data->n_runs; at += data->run[r++].n)
        for (size_t i = 0; i < data->run[r].n && !data->run[r].held_out; i++)
            if (data->run[r].use[i]) {
                sum += x[at + i] * x[at + i];
                count += 1.0;
            }
    return count > 0.0 ? sqrt(sum / count) : 0.0;
}

/* Mean of the zeros of the runs that are fitted; none where the air shows that they wander as far. */
static double common_zero(const explain_data *data, const explain_fit *fit) {
    double sum = 0.0, count = 0.0, own[EXPLAIN_NUISANCES], sd[EXPLAIN_NUISANCES];
    for (size_t r = 0; r < data->n_runs; r++) {
        if (data->run[r].held_out)
            continue;
        explain_nuisances(fit, r, own, sd);
        sum += own[0];
        count += 1.0;
    }
    double mean = count > 0.0 ? sum / count : 0.0;
    return fabs(mean) > 3.0 * data->zero_scatter ? mean : 0.0;
}

/* A run's zero is its own, but what all have in common is a bias. */
void explain_residual(const explain_data *data, const explain_fit *fit, const double *force, double *residual) {
    const double common = common_zero(data, fit);
    for (size_t r = 0, at = 0; r < data->n_runs; at += data->run[r++].n) {
        const explain_run *run = &data->run[r];
        double own[EXPLAIN_NUISANCES], sd[EXPLAIN_NUISANCES];
        explain_nuisances(fit, r, own, sd);
        const double zero = run->held_out ? 0.0 : own[0] - common;
        for (size_t i = 0; i < run->n; i++) {
            double hum = 0.0, turn = TURN * fit->hum_Hz * run->time[i];
            if (fit->hum_Hz > 0.0)
                hum = own[3] * sin(turn) + own[4] * cos(turn);
            residual[at + i] = run->use[i] ? run->force[i] - force[at + i] - zero - hum : 0.0;
        }
    }
}

palp_status explain_noise_level(const explain_data *data, const explain_fit *fit, const double *force,
                                double *noise_level_N) {
    double *other = malloc(data->longest * sizeof *other), slope = 0.0, load = 0.0, white = 0.0, step = 1e-6;
    double jump = 100.0 * step * data->peak / data->deepest; /* a plate that lets go a sample earlier has no slope */
    palp_status status = other ? PALP_OK : PALP_ERR_NO_MEMORY;
    explain_history history = {.load.peak = 0.0};
    for (size_t r = 0, at = 0; r < data->n_runs && !status; at += data->run[r++].n) {
        const explain_run *run = &data->run[r];
        double *depth = malloc(run->n * sizeof *depth);
        status = depth ? PALP_OK : PALP_ERR_NO_MEMORY;
        for (size_t i = 0; i < run->n && depth; i++)
            depth[i] = run->depth[i] + step;
        palp_forward_run path = explain_forward_run(run, &history);
        path.depth_m = depth;
        if (!status)
            status = explain_predict(&fit->model, &path, other, NULL, NULL);
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
    palp_load_history_free(&history.load);
    double n = (double)data->n;
    *noise_level_N = sqrt(white / n + data->correlated * data->correlated + pow(fit->scatter.gain, 2) * load / n +
                    pow(fit->scatter.contact, 2) * slope / n);
    free(other);
    return status;
}
