/* explain_residual.c: what a fit leaves of the forces, and the noise level beside it. */
#include "explain_fit.h"

#include <math.h>

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

double explain_noise_level(const explain_data *data) {
    double white = 0.0, count = 0.0;
    for (size_t r = 0; r < data->n_runs; r++) {
        const explain_run *run = &data->run[r];
        white += run->white * run->white * (double)run->n;
        count += (double)run->n;
    }
    return sqrt(white / count + data->correlated * data->correlated);
}
