/* infer_columns.c: the hat functions of a run over depth on both ways, over the time since the last turn, and
 * over the height of a plate that withdraws, which a specimen may follow. */
#include "infer_internal.h"

#include <math.h>
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

void infer_hats(const explain_data *data, size_t r, double contact, double *column) {
    const explain_run *run = &data->run[r];
    const size_t n = run->n;
    const double span = log(data->duration / data->step);
    double start = run->time[0], top = run->depth[0], bottom = run->depth[0];
    bool back = false;
    const double surface = fmin(0.0, contact); /* below nominal contact there are the others */
    double above = 0.0;
    for (size_t i = 0; i < n; i++)
        above = fmax(above, surface - run->depth[i]);
    const double height = log1p(above / data->stride); /* how far a surface follows the plate is not known */
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
        if (run->depth[i] <= 0.0) {
            if (back && top > surface && run->depth[i] < surface)
                add_hat(log1p((surface - run->depth[i]) / data->stride) / height, 1.0, n, i,
                        column + INFER_WITHDRAWN * INFER_NODES * n);
            continue;
        }
        add_hat(run->depth[i] / run->height / data->strain, 1.0, n, i,
                column + (size_t)(back ? INFER_UNLOADING : INFER_LOADING) * INFER_NODES * n);
        add_hat(log(fmax(since, data->step) / data->step) / span, run->depth[i] / data->deepest, n, i,
                column + INFER_SINCE_TURN * INFER_NODES * n);
    }
}
