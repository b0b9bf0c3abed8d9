/* explain_next.c: the runs that an indenter can do within limits, and the difference of two models in a
 * run. */
#include "explain_result.h"

#include <math.h>

enum {
    DEPTHS = 3,
    RATES = 4,
    TIMES = 4,
    FEWEST = 16 /* samples of a path */
};
static const double AIR = 0.3; /* of the largest depth: where a run starts and ends */
static const size_t cycles[] = {1, 4, 16};

/* The pauses are the time of the session outside its runs. */
palp_explain_limits explain_limits_find(const palp_explain_limits *given, const explain_data *data) {
    palp_explain_limits l = *given;
    double pressed = 0.0, shortest = data->duration;
    for (size_t r = 0; r < data->n_runs; r++) {
        const explain_run *run = &data->run[r];
        pressed += run->time[run->n - 1] - run->time[0];
        shortest = fmin(shortest, run->time[run->n - 1] - run->time[0]);
    }
    l.depth_m = l.depth_m > 0.0 ? l.depth_m : data->deepest;
    l.rate_m_s = l.rate_m_s > 0.0 ? l.rate_m_s : data->fastest;
    l.rest_s = l.rest_s > 0.0 ? l.rest_s : fmax(0.0, data->span - pressed) / (double)data->n_runs;
    l.time_s = l.time_s > 0.0 ? l.time_s : fmax(data->span, pressed) + l.rest_s;
    return l;
}

static bool add(const palp_explain_limits *l, explain_protocol p, explain_protocol *list, size_t *n) {
    const bool fits = p.duration <= l->time_s - l->rest_s && *n < EXPLAIN_PROTOCOLS;
    if (fits)
        list[(*n)++] = p;
    return fits;
}

/* Ramps at one speed to one depth, with dwells: the longest fills the time limit. */
static void add_holds(const palp_explain_limits *l, double depth, double rate, explain_protocol *list,
                      size_t *n) {
    const double way = depth * (1.0 + AIR), ramps = way / rate + way / l->rate_m_s;
    explain_protocol p = {.depth = depth, .rate = rate};
    double lasts = l->time_s - l->rest_s;
    for (size_t k = 0; k < TIMES && lasts > ramps; k++, lasts /= 4.0) {
        p.hold = lasts - ramps;
        p.duration = lasts;
        add(l, p, list, n);
    }
}

size_t explain_protocols_list(const palp_explain_limits *l, explain_protocol *list) {
    size_t n = 0;
    double rate = l->rate_m_s;
    for (size_t v = 0; v < RATES; v++, rate /= 4.0) {
        double depth = l->depth_m;
        for (size_t d = 0; d < DEPTHS; d++, depth /= 2.0) {
            add_holds(l, depth, rate, list, &n);
            for (size_t c = 0; c < sizeof cycles / sizeof cycles[0]; c++)
                add(l,
                    (explain_protocol){.cycles = cycles[c],
                                       .depth = depth,
                                       .rate = rate,
                                       .duration = 2.0 * depth * ((double)cycles[c] + AIR) / rate},
                    list, &n);
        }
        add(l,
            (explain_protocol){
                .air = true, .depth = l->depth_m, .rate = rate, .duration = 2.0 * l->depth_m / rate},
            list, &n);
    }
    return n;
}

/* A straight path to a depth, with at most so many samples, or 2. growth: ratio of successive intervals. */
static void go(const explain_data *data, double depth, double seconds, size_t most, double growth,
               explain_path *p) {
    const double t = p->time[p->n - 1], d = p->depth[p->n - 1];
    const double fine = floor(seconds / data->step);
    const size_t few = most < 2 ? 2 : most, n = fine < 2.0 ? 2 : fine < (double)few ? (size_t)fine : few;
    const double all = growth > 1.0 ? pow(growth, (double)n) - 1.0 : (double)n;
    for (size_t k = 1; k <= n && p->n < EXPLAIN_PATH; k++) {
        const double part = (growth > 1.0 ? pow(growth, (double)k) - 1.0 : (double)k) / all;
        p->time[p->n] = t + seconds * part;
        p->samples[p->n] = fmax(1.0, (p->time[p->n] - p->time[p->n - 1]) / data->step);
        p->depth[p->n++] = d + (depth - d) * part;
    }
}

void explain_path_find(const explain_protocol *q, const explain_data *data, size_t most, explain_path *p) {
    const double air = -AIR * q->depth, top = q->air ? air - q->depth : q->depth, way = fabs(top - air);
    const size_t rounds = q->cycles ? q->cycles : 1,
                 all = most < FEWEST         ? FEWEST
                       : most > EXPLAIN_PATH ? EXPLAIN_PATH
                                             : most,
                 each = all / (2 * rounds + (q->hold > 0.0 ? 1 : 0) + 1);
    const double back = q->hold > 0.0 ? fmax(q->rate, data->fastest) : q->rate;
    p->n = 1;
    p->time[0] = 0.0;
    p->depth[0] = air;
    p->samples[0] = 1.0;
    go(data, air, 2.0 * data->step, 2, 1.0, p);
    for (size_t c = 0; c < rounds; c++) {
        go(data, top, (c ? q->depth : way) / q->rate, each, 1.0, p);
        if (q->hold > 0.0)
            go(data, top, q->hold, each, pow(q->hold / data->step, 1.0 / (double)each), p);
        if (c + 1 < rounds)
            go(data, 0.0, q->depth / q->rate, each, 1.0, p);
    }
    go(data, air, way / back, each, 1.0, p);
    go(data, air, 2.0 * data->step, 2, 1.0, p);
}

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

palp_explain_next_run explain_next_run_of(const explain_protocol *q) {
    return (palp_explain_next_run){.kind = q->air      ? "free"
                                           : q->cycles ? "cyclic"
                                                       : "ramp_hold",
                                   .hold_s = q->hold,
                                   .depth_mm = 1e3 * q->depth,
                                   .rate_mm_s = 1e3 * q->rate,
                                   .cycles = q->cycles,
                                   .time_s = q->duration};
}
