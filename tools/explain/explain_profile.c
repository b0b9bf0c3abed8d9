/* explain_profile.c: the gap by run, by depth and by speed, as given and with the effects. */
#include "explain.h"
#include "shared/json_out.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DEPTHS = 8, SPEEDS = 9, BINS = 1 + DEPTHS };

static const double STILL = 0.01, WINDOW = 0.05; /* mm/s; s to either side, over which a speed is taken */

typedef struct bin {
    double from, to, before, after;
    size_t n;
} bin;

static void bin_add(bin *b, const palp_explain_run *run, size_t i) {
    b->before += run->before_N[i] * run->before_N[i];
    b->after += run->after_N[i] * run->after_N[i];
    b->n++;
}

static double rms(double square, size_t n) {
    return n ? sqrt(square / (double)n) : NAN;
}

static void put_gap(json_t *object, const bin *b) {
    json_figures(object, {"before_N", rms(b->before, b->n)}, {"after_N", rms(b->after, b->n)});
}

/* Spikes and releases are events, not gaps: they and as many samples on either side do not count. */
static void find_used(const palp_explanation *e, size_t r, bool *use) {
    const palp_explain_run *run = &e->run[r];
    memset(use, 1, run->n);
    for (size_t k = 0; k < e->n_events; k++) {
        const palp_explain_event *event = &e->event[k];
        if (event->run != r || strcmp(event->kind, "slip") == 0)
            continue;
        for (size_t i = 0; i < run->n; i++) {
            size_t a = i > event->samples ? i - event->samples : 0, b = i + event->samples;
            b = b < run->n ? b : run->n - 1;
            use[i] = use[i] && !(run->time_s[b] >= event->from_s && run->time_s[a] <= event->to_s);
        }
    }
}

/* mm/s, towards the specimen positive. */
static double speed_at(const palp_explain_run *run, size_t i) {
    size_t a = i ? i - 1 : 0, b = i + 1 < run->n ? i + 1 : i;
    while (a > 0 && run->time_s[i] - run->time_s[a] < WINDOW)
        a--;
    while (b + 1 < run->n && run->time_s[b] - run->time_s[i] < WINDOW)
        b++;
    return 1e3 * (run->depth_m[b] - run->depth_m[a]) / (run->time_s[b] - run->time_s[a]);
}

/* Decades from STILL on, either way; the middle is standing still. */
static size_t speed_bin(double speed) {
    int decade = fabs(speed) < STILL ? 0 : 1 + (int)floor(log10(fabs(speed) / STILL));
    decade = decade > SPEEDS / 2 ? SPEEDS / 2 : decade;
    return (size_t)(SPEEDS / 2 + (speed < 0 ? -decade : decade));
}

/* The first is air. */
static size_t depth_bin(double depth, double deepest) {
    return depth <= 0 ? 0 : 1 + (size_t)fmin(DEPTHS - 1, floor(DEPTHS * depth / deepest));
}

static json_t *bins_json(size_t n, const bin *b) {
    json_t *list = json_array();
    for (size_t k = 0; k < n; k++) {
        if (b[k].n > 0) {
            json_t *object = json_pack("{s:o, s:o}", "from", json_number_or_null(b[k].from), "to",
                                       json_number_or_null(b[k].to));
            put_gap(object, &b[k]);
            json_array_append_new(list, object);
        }
    }
    return list;
}

static void set_ends(bin depth[BINS], bin speed[SPEEDS], double deepest) {
    depth[0].from = NAN;
    for (int k = 0; k < DEPTHS; k++) {
        depth[k + 1].from = deepest * k / DEPTHS;
        depth[k + 1].to = deepest * (k + 1) / DEPTHS;
    }
    for (int k = -SPEEDS / 2; k <= SPEEDS / 2; k++) {
        double low = k ? STILL * pow(10, abs(k) - 1) : -STILL, high = k ? 10 * low : STILL;
        bin *b = &speed[k + SPEEDS / 2];
        high = abs(k) == SPEEDS / 2 ? NAN : high;
        b->from = k < 0 ? -high : low;
        b->to = k < 0 ? -low : high;
    }
}

json_t *explain_profile(const palp_explanation *e) {
    bin depth[BINS] = {{.n = 0}}, speed[SPEEDS] = {{.n = 0}};
    double deepest = 0;
    size_t longest = 0;
    for (size_t r = 0; r < e->n_runs; r++) {
        longest = e->run[r].n > longest ? e->run[r].n : longest;
        for (size_t i = 0; i < e->run[r].n; i++)
            deepest = fmax(deepest, 1e3 * e->run[r].depth_m[i]);
    }
    set_ends(depth, speed, deepest);
    json_t *runs = json_array();
    bool *use = malloc(longest * sizeof *use);
    for (size_t r = 0; use && r < e->n_runs; r++) {
        const palp_explain_run *run = &e->run[r];
        json_t *object = json_pack("{s:o}", "experiment", json_text(run->name));
        bin whole = {.n = 0};
        find_used(e, r, use);
        for (size_t i = 0; i < run->n; i++) {
            if (use[i]) {
                bin_add(&whole, run, i);
                bin_add(&depth[depth_bin(1e3 * run->depth_m[i], deepest)], run, i);
                bin_add(&speed[speed_bin(speed_at(run, i))], run, i);
            }
        }
        put_gap(object, &whole);
        json_array_append_new(runs, object);
    }
    free(use);
    return json_pack("{s:o, s:o, s:o}", "experiments", runs, "depth_mm", bins_json(BINS, depth), "speed_mm_s",
                     bins_json(SPEEDS, speed));
}
