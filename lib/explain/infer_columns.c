/* infer_columns.c: the functions of which a run's discrepancy is the sum: over depth on both ways, over the
 * time in a dwell, and over the height of a plate that withdraws, which a specimen may follow. Each is a
 * natural cubic spline, 1 at one node of a grid and 0 at the others; they are called hats for short. */
#include "infer_internal.h"

#include <math.h>
#include <string.h>

enum { N = INFER_NODES };

/* Second derivatives at the nodes, bend[node N + function], of the natural cubic splines that are 1 at one
 * node and 0 at the others. */
static void find_bends(double bend[N * N]) {
    double pivot[N] = {0.0};
    memset(bend, 0, N * N * sizeof *bend);
    for (int i = 1; i + 1 < N; i++) {
        pivot[i] = 1.0 / (4.0 - pivot[i - 1]);
        for (int a = 0; a < N; a++) {
            const double turn = a == i ? -12.0 : a == i - 1 || a == i + 1 ? 6.0 : 0.0;
            bend[i * N + a] = (turn - bend[(i - 1) * N + a]) * pivot[i];
        }
    }
    for (int i = N - 2; i > 0; i--)
        for (int a = 0; a < N; a++)
            bend[i * N + a] -= pivot[i] * bend[(i + 1) * N + a];
}

/* Adds a sample at this share of the grid. */
static void add_hat(const double *bend, double at, double size, size_t n, size_t i, double *column) {
    const double place = fmin(1.0, fmax(0.0, at)) * (N - 1);
    const size_t left = (size_t)fmin(place, N - 2);
    const double u = place - (double)left, v = 1.0 - u, *low = bend + left * N, *high = low + N;
    for (size_t a = 0; a < N; a++)
        column[a * n + i] = size * ((v * v * v - v) * low[a] + (u * u * u - u) * high[a]) / 6.0;
    column[left * n + i] += size * v;
    column[(left + 1) * n + i] += size * u;
}

void infer_hats(const explain_data *data, size_t r, double contact, double *column) {
    const explain_run *run = &data->run[r];
    const size_t n = run->n;
    const double span = log(data->duration / data->step);
    double bend[N * N], top = run->depth[0], bottom = run->depth[0];
    bool back = false;
    const double surface = fmin(0.0, contact); /* below nominal contact there are the others */
    double above = 0.0, *dwell = column + INFER_DWELL * INFER_NODES * n;
    for (size_t i = 0; i < n; i++)
        above = fmax(above, surface - run->depth[i]);
    const double height = log1p(above / data->stride); /* how far a surface follows the plate is not known */
    find_bends(bend);
    memset(column, 0, INFER_HATS * n * sizeof *column);
    for (size_t i = 0; i < n; i++) {
        const double turned = 0.01 * data->deepest;
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
                add_hat(bend, log1p((surface - run->depth[i]) / data->stride) / height, 1.0, n, i,
                        column + INFER_WITHDRAWN * INFER_NODES * n);
            continue;
        }
        add_hat(bend, run->depth[i] / run->height / data->strain, 1.0, n, i,
                column + (size_t)(back ? INFER_UNLOADING : INFER_LOADING) * INFER_NODES * n);
        if (run->stood[i] >= 0.0)
            add_hat(bend, log(fmax(run->stood[i], data->step) / data->step) / span,
                    run->depth[i] / data->deepest, n, i, dwell);
        dwell[i] = 0.0; /* a dwell begins with the force that the way to it ended with */
    }
}
