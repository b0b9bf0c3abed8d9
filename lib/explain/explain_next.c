/* explain_next.c: the run that would tell two look-alikes apart best, of those the indenter can do. */
#include "explain_result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 2000 };
static const double AIR = 2e-3; /* m: where a run starts and ends */

/* Depths relative to the deepest so far, rates in m/s. */
typedef struct protocol {
    const char *kind;
    double depth, rate, hold;
    size_t cycles;
} protocol;

static const protocol protocols[] = {
    {"ramp_hold", 1.0, 10e-3, 300.0, 0}, {"ramp_hold", 0.5, 10e-3, 300.0, 0}, {"ramp_hold", 1.0, 0.3e-3, 60.0, 0},
    {"static", 1.0, 0.05e-3, 2.0, 0},    {"cyclic", 1.0, 1e-3, 0.0, 4},       {"cyclic", 0.6, 8e-3, 0.0, 10},
    {"cyclic", 1.2, 2e-3, 0.0, 2},       {"free", 4e-3, 8e-3, 5.0, 0},
};

typedef struct path {
    size_t n;
    double time[SAMPLES], depth[SAMPLES];
} path;

/* Straight to a depth. */
static void go(path *p, double depth, double seconds, size_t samples) {
    double t = p->time[p->n - 1], d = p->depth[p->n - 1];
    for (size_t k = 1; k <= samples && p->n < SAMPLES; k++) {
        double part = (double)k / (double)samples;
        p->time[p->n] = t + seconds * part;
        p->depth[p->n++] = d + (depth - d) * part;
    }
}

static void walk(const protocol *q, double deepest, path *p) {
    bool air = strcmp(q->kind, "free") == 0;
    double top = air ? -AIR - q->depth : q->depth * deepest, way = fabs(top + AIR);
    p->n = 1;
    p->time[0] = 0.0;
    p->depth[0] = -AIR;
    go(p, -AIR, 1.0, 10);
    for (size_t c = 0; c < (q->cycles ? q->cycles : 1); c++) {
        go(p, top, way / q->rate, 60);
        if (q->hold > 0.0)
            go(p, top, q->hold, 200);
        if (c + 1 < q->cycles)
            go(p, 0.0, top / q->rate, 60);
    }
    go(p, -AIR, way / q->rate, 60);
    go(p, -AIR, 5.0, 20);
}

/* rms of the difference that is left once the run's own zero and gain are free: what cannot be scatter. */
static double separation(const path *p, const double *a, const double *b) {
    double aa = 0.0, ad = 0.0, sa = 0.0, sd = 0.0, dd = 0.0, n = 0.0;
    for (size_t i = 1; i < p->n; i++) {
        double w = p->time[i] - p->time[i - 1], d = b[i] - a[i];
        n += w;
        sa += w * a[i];
        sd += w * d;
        aa += w * a[i] * a[i];
        ad += w * a[i] * d;
        dd += w * d * d;
    }
    double var = aa - sa * sa / n, cov = ad - sa * sd / n, left = dd - sd * sd / n;
    if (var > 0.0)
        left -= cov * cov / var;
    return sqrt(fmax(0.0, left) / n);
}

palp_status explain_next_find(const explain_search *full, const explain_search *rest, const palp_explain_effect *out,
                              palp_explain_next *next) {
    path *p = malloc(sizeof *p);
    double *force = malloc(2 * SAMPLES * sizeof *force);
    palp_status status = p && force ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t c = 1; c < out->n_class && !status; c++) {
        const explain_trial *t = &rest->trial[out->alike[c]];
        if (!t->fit.product)
            continue;
        next->wanted = true;
        for (size_t k = 0; k < sizeof protocols / sizeof *protocols; k++) {
            const protocol *q = &protocols[k];
            walk(q, full->data.deepest, p);
            palp_forward_run run = {.n = p->n, .time_s = p->time, .depth_m = p->depth};
            if (explain_predict(&full->fit.model, &run, force, NULL, NULL) ||
                explain_predict(&t->fit.model, &run, force + SAMPLES, NULL, NULL))
                continue;
            double apart = separation(p, force, force + SAMPLES);
            if (!(apart > next->separation_N))
                continue;
            bool ramp = strcmp(q->kind, "ramp_hold") == 0, air = strcmp(q->kind, "free") == 0;
            *next = (palp_explain_next){.wanted = true, .kind = q->kind, .hold_s = ramp || air ? q->hold : 0.0,
                                        .depth_mm = 1e3 * (air ? q->depth : q->depth * full->data.deepest),
                                        .rate_mm_s = 1e3 * q->rate, .cycles = q->cycles, .separation_N = apart,
                                        .between = {out->effect.id, out->alike[c]}};
        }
    }
    free(p);
    free(force);
    return status;
}
