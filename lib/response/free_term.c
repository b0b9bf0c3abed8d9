/* free_term.c: forces that depend on the path of the plate by a table. */
#include "free_term.h"
#include "data/segments_internal.h"
#include "model/model_internal.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { N = PALP_FREE_NODES };

/* The variable of a kind, and whether its force is in proportion to the depth. */
typedef struct kind_row {
    bool logarithm, pressed, both_signs;
} kind_row;

static const kind_row kinds[PALP_FREE_KINDS] = {
    [PALP_FREE_DWELL] = {.logarithm = true, .pressed = true},
    [PALP_FREE_EARLY] = {.logarithm = true},
    [PALP_FREE_SPEED] = {.both_signs = true},
    [PALP_FREE_PRESSED_SPEED] = {.pressed = true, .both_signs = true},
    [PALP_FREE_TURN] = {.pressed = true},
    [PALP_FREE_PLACE] = {.both_signs = true},
    [PALP_FREE_GAIN] = {.both_signs = true},
};

void free_term_bends(double bend[FREE_BENDS]) {
    double pivot[N] = {0.0};
    memset(bend, 0, FREE_BENDS * sizeof *bend);
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

void free_term_hats(const double bend[FREE_BENDS], double at, double size, size_t n, size_t i,
                    double *column) {
    const double place = fmin(1.0, fmax(0.0, at)) * (N - 1);
    const size_t left = (size_t)fmin(place, N - 2);
    const double u = place - (double)left, v = 1.0 - u, *low = bend + left * N, *high = low + N;
    for (size_t a = 0; a < N; a++)
        column[a * n + i] = size * ((v * v * v - v) * low[a] + (u * u * u - u) * high[a]) / 6.0;
    column[left * n + i] += size * v;
    column[(left + 1) * n + i] += size * u;
}

/* ---- where a path is ---- */

/* The direction of the plate, 1 in and -1 out, and its way since it turned. It has turned once it has gone
 * back by a hundredth of the deepest. */
typedef struct way {
    double most, least, turned;
    bool back;
} way;

static double follow_way(way *w, double depth, double least_way) {
    w->most = fmax(w->most, depth);
    w->least = fmin(w->least, depth);
    if (!w->back && depth < w->most - least_way) {
        w->back = true;
        w->turned = w->most;
        w->least = depth;
    } else if (w->back && depth > w->least + least_way) {
        w->back = false;
        w->turned = w->least;
        w->most = depth;
    }
    return fabs(depth - w->turned);
}

static double speed_at(size_t n, const double *time, const double *depth, size_t i) {
    const size_t from = i ? i - 1 : 0, to = i + 1 < n ? i + 1 : i;
    return to > from ? (depth[to] - depth[from]) / (time[to] - time[from]) : 0.0;
}

/* at[n] of times: the logarithm begins where the grid does. */
static double logarithm(const palp_free_term *t, double seconds) {
    return log(fmax(seconds, exp(t->from)));
}

static palp_status place_dwell(const palp_free_term *t, size_t n, const double *time, const double *depth,
                               double *at, double *weight) {
    unsigned char *phase = malloc(n + 1);
    palp_status status = phase ? segments_phases(n, time, depth, NULL, phase, at) : PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n && !status; i++) {
        if (at[i] < 0.0 || depth[i] <= 0.0)
            weight[i] = 0.0;
        at[i] = logarithm(t, at[i]);
    }
    free(phase);
    return status;
}

static void place_on_way(const palp_free_term *t, size_t n, const double *depth, double height, double *at,
                         double *weight) {
    way w = {.most = depth[0], .least = depth[0], .turned = depth[0]};
    for (size_t i = 0; i < n; i++) {
        const double since = follow_way(&w, depth[i], 0.01 * t->depth_m);
        if (t->kind == PALP_FREE_TURN) {
            at[i] = since;
            weight[i] *= w.back ? -1.0 : 1.0;
            continue;
        }
        at[i] = depth[i] / height;
        weight[i] = depth[i] > 0.0 && w.back == (t->kind == PALP_FREE_UNLOADING) ? 1.0 : 0.0;
    }
}

/* at[n]: share of the grid from 0 to 1; weight[n]: by which the table is multiplied, 0 where it does not act.
 */
static palp_status place(const palp_free_term *t, size_t n, const double *time, const double *depth,
                         double height, double session, const double *force, double *at, double *weight) {
    palp_status status = PALP_OK;
    for (size_t i = 0; i < n; i++)
        weight[i] = palp_model_free_of_force(t->kind) ? force[i] / t->plate_N
                    : kinds[t->kind].pressed          ? fmax(0.0, depth[i]) / t->depth_m
                                                      : 1.0;
    switch (t->kind) {
    case PALP_FREE_LOADING:
    case PALP_FREE_UNLOADING:
    case PALP_FREE_TURN:
        place_on_way(t, n, depth, height, at, weight);
        break;
    case PALP_FREE_DWELL:
        status = place_dwell(t, n, time, depth, at, weight);
        break;
    default:
        for (size_t i = 0; i < n; i++) {
            const double since = time[i] - time[0];
            at[i] = t->kind == PALP_FREE_EARLY                                ? logarithm(t, since)
                    : t->kind == PALP_FREE_SESSION                            ? session + since
                    : t->kind == PALP_FREE_PLACE || t->kind == PALP_FREE_GAIN ? depth[i]
                    : kinds[t->kind].both_signs ? asinh(speed_at(n, time, depth, i) / t->slow_m_s)
                                                : since;
        }
    }
    for (size_t i = 0; i < n; i++)
        at[i] = fmin(1.0, fmax(0.0, (at[i] - t->from) / (t->to - t->from)));
    return status;
}

size_t free_term_zero(palp_free_kind kind) {
    return kind == PALP_FREE_DWELL ? 0 : kind == PALP_FREE_RESPONSE ? N - 1 : N;
}

/* A linear system's answer to the path: each change of speed from one pair of samples to the next starts the
 * table once more. change[n]: work. */
static void respond(const palp_free_term *t, size_t n, const double *time, const double *depth,
                    const double bend[FREE_BENDS], double *change, double *column) {
    const double unit = t->to / t->depth_m, step = (t->to - t->from) / (N - 1);
    for (size_t s = 0; s < n; s++)
        change[s] = s == 0 || s + 1 == n ? 0.0
                                         : unit * ((depth[s + 1] - depth[s]) / (time[s + 1] - time[s]) -
                                                   (depth[s] - depth[s - 1]) / (time[s] - time[s - 1]));
    for (size_t i = 0; i < n; i++) {
        double value[N] = {0.0},
               bent[N] = {0.0}; /* what multiplies the nodes' values and second derivatives */
        for (size_t s = i + 1; s-- > 0 && time[i] - time[s] < t->to;) {
            const double place = fmax(0.0, time[i] - time[s] - t->from) / step;
            const size_t left = (size_t)fmin(place, N - 2);
            const double u = place - (double)left, v = 1.0 - u;
            value[left] += change[s] * v;
            value[left + 1] += change[s] * u;
            bent[left] += change[s] * (v * v * v - v) / 6.0;
            bent[left + 1] += change[s] * (u * u * u - u) / 6.0;
        }
        for (size_t a = 0; a < N; a++) {
            column[a * n + i] = value[a];
            for (size_t b = 0; b < N; b++)
                column[a * n + i] += bent[b] * bend[b * N + a];
        }
    }
}

palp_status free_term_columns(const palp_free_term *t, size_t n, const double *time, const double *depth,
                              double height, double session, const double *force, double *column) {
    double bend[FREE_BENDS];
    free_term_bends(bend);
    memset(column, 0, N * n * sizeof *column);
    double *at = malloc(2 * (n + 1) * sizeof *at);
    if (!at)
        return PALP_ERR_NO_MEMORY;
    palp_status status = PALP_OK;
    if (t->kind == PALP_FREE_RESPONSE)
        respond(t, n, time, depth, bend, at, column);
    else {
        status = place(t, n, time, depth, height, session, force, at, at + n);
        for (size_t i = 0; i < n && !status; i++)
            free_term_hats(bend, at[i], at[n + i], n, i, column);
    }
    const size_t zero = free_term_zero(t->kind);
    if (zero < N)
        memset(column + zero * n, 0, n * sizeof *column);
    free(at);
    return status;
}

palp_status palp_free_term_add(const palp_free_term *t, size_t n, const double *time_s, const double *depth_m,
                               double height_m, double session_s, double *force_N) {
    if (palp_free_term_check(t) || !time_s || !depth_m || !force_N || !(height_m > 0.0))
        return PALP_ERR_ARGUMENT;
    double *column = n ? malloc(N * n * sizeof *column) : NULL;
    if (!column)
        return n ? PALP_ERR_NO_MEMORY : PALP_OK;
    palp_status status = free_term_columns(t, n, time_s, depth_m, height_m, session_s, force_N, column);
    for (size_t a = 0; a < N && !status; a++)
        for (size_t i = 0; i < n; i++)
            force_N[i] += t->force_N[a] * column[a * n + i];
    free(column);
    return status;
}
