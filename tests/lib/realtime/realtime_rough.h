/* realtime_rough.h: a rough sphere on a random way over a cube, stepped within budgets beside the converged
 * answer. */
#ifndef REALTIME_ROUGH_H
#define REALTIME_ROUGH_H

#include "realtime_make.h"

#include <palpate/random.h>

enum { ROUGH_TICKS = 400, ROUGH_WAYS = 60, ROUGH_BUDGETS = 10, WAVES = 3 };

/* Three waves an axis, the last one a hand's tremor; pressed within 0.1 s. */
typedef struct rough_way {
    size_t nodes, n_arms;
    double radius, friction, press, middle[3], size[3][WAVES], rate[3][WAVES], phase[3][WAVES];
} rough_way;

static inline double between(uint64_t *r, double low, double high) {
    return low + (high - low) * palp_random_uniform(r);
}

static inline rough_way rough_way_make(uint64_t seed) {
    uint64_t r = seed;
    palp_random_next(&r);
    rough_way w = {.nodes = 5 + (size_t)between(&r, 0.0, 3.0)};
    w.n_arms = (size_t)between(&r, 0.0, 3.0);
    w.radius = between(&r, 3e-3, 6e-3);
    w.friction = between(&r, 0.0, 1.0);
    w.press = between(&r, 0.8e-3, 2e-3);
    for (int k = 0; k < 3; k++) {
        w.middle[k] = between(&r, 0.009, 0.015);
        for (int j = 0; j < WAVES; j++) {
            bool tremor = j == WAVES - 1;
            w.size[k][j] = tremor ? between(&r, 0.0, 1e-4) : between(&r, 0.0, 2e-3) / (1 + j);
            w.rate[k][j] = 6.283 * (tremor ? between(&r, 6.0, 10.0) : between(&r, 0.5, 3.0));
            w.phase[k][j] = between(&r, 0.0, 6.283);
        }
    }
    return w;
}

static inline palp_tool rough_tool(const rough_way *w, double time) {
    palp_tool tool = {
        .shape = PALP_TOOL_SPHERE, .radius_m = w->radius, .friction = w->friction, .axis = {0, 1, 0}};
    for (int k = 0; k < 3; k++) {
        double aside = 0.0;
        for (int j = 0; j < WAVES; j++)
            aside += w->size[k][j] * (sin(w->rate[k][j] * time + w->phase[k][j]) - sin(w->phase[k][j]));
        tool.position_m[k] =
            (k == 1 ? HEIGHT + w->radius + 2e-4 - w->press * fmin(1.0, time / 0.1) + 0.35 * aside
                    : w->middle[k] + aside);
    }
    return tool;
}

/* Largest error of a run, and its root mean square, over the peak of the force. */
typedef struct rough_error {
    double most, mean, peak;
    size_t beyond; /* ticks in which it was larger than estimated */
} rough_error;

static inline double apart(const double a[3], const double b[3]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
}

/* One tick; the force on the tool. */
static inline void rough_tick(palp_realtime *rt, const palp_tool *tool, const palp_budget *budget,
                              palp_tick_info *info, double force[3]) {
    palp_tool_force felt;
    ck_assert_int_eq(palp_network_set_tools(net_of(rt), 1, tool), PALP_OK);
    ck_assert_int_eq(palp_realtime_step(rt, 0.0, 1e-3, budget, info), PALP_OK);
    ck_assert_int_eq(palp_network_tool_force(net_of(rt), &felt), PALP_OK);
    memcpy(force, felt.force_N, 3 * sizeof *force);
}

/* Follows tool(way, time) with so many corrections a tick, beside truth[n][3]; allowed: of the peak, beyond
 * the estimate. */
static inline rough_error rough_run(palp_realtime *rt, palp_tool (*tool)(const rough_way *, double),
                                    const rough_way *w, size_t n, size_t corrections, double (*truth)[3],
                                    double allowed) {
    const palp_budget budget = {.corrections = corrections};
    const double none[3] = {0.0};
    rough_error e = {0};
    for (size_t i = 0; i < n; i++)
        e.peak = fmax(e.peak, apart(truth[i], none));
    for (size_t i = 0; i < n; i++) {
        palp_tool at = tool(w, 1e-3 * (double)(i + 1));
        palp_tick_info info;
        double force[3];
        rough_tick(rt, &at, &budget, &info, force);
        double off = apart(force, truth[i]);
        e.most = fmax(e.most, off / e.peak);
        e.mean += off * off / (e.peak * e.peak * (double)n);
        e.beyond += off > info.force_error_N + allowed * e.peak;
    }
    e.mean = sqrt(e.mean);
    return e;
}

static inline void rough_truth(palp_realtime *rt, palp_tool (*tool)(const rough_way *, double),
                               const rough_way *w, size_t n, double (*truth)[3]) {
    for (size_t i = 0; i < n; i++) {
        palp_tool at = tool(w, 1e-3 * (double)(i + 1));
        rough_tick(rt, &at, &ALL, NULL, truth[i]);
    }
}

static inline int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Random paths from one seed to another, at most ROUGH_WAYS. The estimate exceeds the error in every tick, to
 * 2e-4 of the peak. median[n]: median over paths of the rms error for each number of corrections; in a mean
 * the few paths that stick where the exact answer slips would dominate. Returns how often an error is a tenth
 * larger than with one correction fewer. */
static inline size_t rough_ways(uint64_t from, uint64_t to, const size_t *corrections, size_t n,
                                double *median) {
    static double truth[ROUGH_TICKS][3], error[ROUGH_BUDGETS][ROUGH_WAYS];
    size_t rises = 0;
    ck_assert(to - from <= ROUGH_WAYS && n <= ROUGH_BUDGETS);
    for (uint64_t seed = from; seed < to; seed++) {
        rough_way w = rough_way_make(seed);
        palp_realtime *rt = cube_on_a_table(w.nodes, w.n_arms);
        rough_truth(rt, rough_tool, &w, ROUGH_TICKS, truth);
        drop(rt);
        for (size_t k = 0; k < n; k++) {
            rt = cube_on_a_table(w.nodes, w.n_arms);
            rough_error e = rough_run(rt, rough_tool, &w, ROUGH_TICKS, corrections[k], truth, 2e-4);
            ck_assert_msg(e.beyond == 0, "seed %d, %zu corrections: beyond the estimate in %zu ticks",
                          (int)seed, corrections[k], e.beyond);
            error[k][seed - from] = e.mean;
            rises += k > 0 && e.mean > 1.1 * error[k - 1][seed - from];
            drop(rt);
        }
    }
    for (size_t k = 0; k < n; k++) {
        qsort(error[k], to - from, sizeof **error, ascending);
        median[k] = error[k][(to - from) / 2];
    }
    return rises;
}

#endif
