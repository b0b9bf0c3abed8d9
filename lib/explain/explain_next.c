/* explain_next.c: the run that would tell two look-alikes apart best, of those the indenter can do. */
#include "explain_result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = EXPLAIN_PATH };
static const double AIR = 0.3; /* of the deepest: where a run starts and ends */

/* Depths relative to the deepest so far, rates to the fastest, holds to the longest run. */
typedef struct protocol {
    const char *kind;
    double depth, rate, hold;
    size_t cycles;
} protocol;

static const protocol protocols[EXPLAIN_PROTOCOLS] = {
    {"ramp_hold", 1.0, 1.0, 3.0, 0}, {"ramp_hold", 0.5, 1.0, 3.0, 0}, {"ramp_hold", 1.0, 0.03, 0.6, 0},
    {"static", 1.0, 0.03, 0.02, 0},  {"cyclic", 1.0, 0.3, 0.0, 4},    {"cyclic", 0.6, 0.8, 0.0, 10},
    {"cyclic", 1.2, 0.3, 0.0, 2},    {"free", 0.6, 0.8, 0.05, 0},
};

/* Straight to a depth. */
static void go(explain_path *p, double depth, double seconds, size_t samples) {
    double t = p->time[p->n - 1], d = p->depth[p->n - 1];
    for (size_t k = 1; k <= samples && p->n < SAMPLES; k++) {
        double part = (double)k / (double)samples;
        p->time[p->n] = t + seconds * part;
        p->depth[p->n++] = d + (depth - d) * part;
    }
}

void explain_path_find(size_t k, const explain_data *data, explain_path *p) {
    const protocol *q = &protocols[k];
    bool is_air = strcmp(q->kind, "free") == 0;
    const double air = AIR * data->deepest, rate = q->rate * data->fastest, hold = q->hold * data->duration;
    double top = is_air ? -air - q->depth * data->deepest : q->depth * data->deepest, way = fabs(top + air);
    p->n = 1;
    p->time[0] = 0.0;
    p->depth[0] = -air;
    go(p, -air, 0.01 * data->duration, 10);
    for (size_t c = 0; c < (q->cycles ? q->cycles : 1); c++) {
        go(p, top, way / rate, 60);
        if (hold > 0.0)
            go(p, top, hold, 200);
        if (c + 1 < q->cycles)
            go(p, 0.0, top / rate, 60);
    }
    go(p, -air, way / rate, 60);
    go(p, -air, 0.05 * data->duration, 20);
}

/* rms of the difference that is left once the run's own zero and gain are free: what cannot be scatter. */
double explain_separation(const explain_path *p, const double *a, const double *b) {
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

palp_explain_next explain_next_of(size_t k, const explain_data *data) {
    const protocol *q = &protocols[k];
    const bool ramp = strcmp(q->kind, "ramp_hold") == 0, air = strcmp(q->kind, "free") == 0;
    return (palp_explain_next){.wanted = true,
                               .kind = q->kind,
                               .hold_s = ramp || air ? q->hold * data->duration : 0.0,
                               .depth_mm = 1e3 * q->depth * data->deepest,
                               .rate_mm_s = 1e3 * q->rate * data->fastest,
                               .cycles = q->cycles};
}
