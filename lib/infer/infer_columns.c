/* infer_columns.c: the hat functions of a run over depth on both ways and over the time since the last turn.
 */
#include "infer_internal.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Adds a sample at this share of the grid. */
static void add_hat(double at, double size, size_t n, size_t i, double *column) {
    const double place = fmin(1.0, fmax(0.0, at)) * (INFER_NODES - 1);
    const size_t left = (size_t)fmin(place, INFER_NODES - 2);
    column[left * n + i] = size * (1.0 - (place - (double)left));
    column[(left + 1) * n + i] = size * (place - (double)left);
}

/* Time since the plate last changed its pace, by the pieces that the run's phases are made of. */
static double since_turn(const explain_run *run, size_t i, double *start) {
    if (i > 0 && run->phase[i] != run->phase[i - 1])
        *start = run->time[i - 1];
    return run->time[i] - *start;
}

void infer_hats(const explain_data *data, size_t r, double *column) {
    const explain_run *run = &data->run[r];
    const size_t n = run->n;
    const double span = log(data->duration / data->step);
    double start = run->time[0], top = run->depth[0], bottom = run->depth[0];
    bool back = false;
    memset(column, 0, INFER_HATS * n * sizeof *column);
    for (size_t i = 0; i < n; i++) {
        const double turned = 0.01 * data->deepest, since = since_turn(run, i, &start);
        top = fmax(top, run->depth[i]);
        bottom = fmin(bottom, run->depth[i]);
        if (!back && run->depth[i] < top - turned) {
            back = true;
            bottom = run->depth[i];
        } else if (back && run->depth[i] > bottom + turned) {
            back = false;
            top = run->depth[i];
        }
        if (run->depth[i] <= 0.0)
            continue;
        add_hat(run->depth[i] / run->height / data->strain, 1.0, n, i,
                column + (size_t)(back ? INFER_UNLOADING : INFER_LOADING) * INFER_NODES * n);
        add_hat(log(fmax(since, data->step) / data->step) / span, run->depth[i] / data->deepest, n, i,
                column + INFER_SINCE_TURN * INFER_NODES * n);
    }
}

palp_status infer_turn_find(infer_fit *fit, const explain_data *data) {
    static const double RIDGE = 1e-10; /* of a column's square: it changes nothing but that all is definite */
    const size_t k = fit->k, n = k + INFER_HATS;
    double *block = malloc((data->longest * n + n * n + k * k) * sizeof *block);
    if (!block)
        return PALP_ERR_NO_MEMORY;
    double *square = block + data->longest * n, *normal = square + n * n;
    memset(square, 0, n * n * sizeof *square);
    for (size_t r = 0, at = 0; r < data->n_runs; at += data->run[r++].n) {
        const explain_run *run = &data->run[r];
        const double *raw = fit->raw + at * fit->m, *hats = raw + (k + INFER_OWN) * run->n;
        for (size_t i = 0; i < run->n; i++)
            for (size_t a = 0; a < n; a++)
                block[i * n + a] = !run->use[i] ? 0.0
                                   : a < k      ? raw[a * run->n + i]
                                                : hats[(a - k) * run->n + i];
        if (!run->held_out)
            dense_add_square(n, run->n, 1.0, block, square);
    }
    for (size_t a = 0; a < k; a++) {
        memcpy(normal + a * k, square + a * n, k * sizeof *normal);
        normal[a * k + a] += normal[a * k + a] > 0.0 ? RIDGE * normal[a * k + a] : 1.0;
        for (size_t h = 0; h < INFER_HATS; h++)
            fit->turn[h * k + a] = square[(k + h) * n + a];
    }
    const bool good = dense_cholesky(k, normal);
    if (good)
        dense_cholesky_solve(k, normal, INFER_HATS, fit->turn);
    free(block);
    return good ? PALP_OK : PALP_ERR_SINGULAR;
}
