/* session.c: the experiments of a case: a careful experimenter's nine, or the seed's. */
#include "hidden.h"

#include <math.h>
#include <string.h>

static const double mm = 1e-3;
#define AIR (-2 * mm) /* beyond the reach of contact offsets and of most that sticks */

static run *add(session *s, const char *kind, double Hz, double start) {
    run *r = &s->run[s->n_runs++];
    memset(r, 0, sizeof *r);
    r->kind = kind;
    r->Hz = Hz;
    r->corner = 8 / Hz; /* no corner falls between the samples */
    r->repeat = 1;
    path_start(r, start);
    return r;
}

/* Slow loading and withdrawal in air. */
static void static_run(session *s, double Hz, double depth, double seconds) {
    run *r = add(s, "static", Hz, AIR);
    r->depth = depth;
    r->rate = depth / seconds;
    path_wait(r, 1.5);
    path_to(r, depth, r->rate);
    path_wait(r, 2);
    path_to(r, AIR, r->rate);
    path_wait(r, 5);
}

static void ramp_hold(session *s, double Hz, double depth, double rate, double hold) {
    run *r = add(s, "ramp_hold", Hz, AIR);
    r->depth = depth;
    r->rate = rate;
    r->ramp = depth / rate;
    r->hold = hold;
    path_wait(r, 1.5);
    path_to(r, depth, rate);
    path_wait(r, hold);
    path_to(r, AIR, fmax(rate, 2 * mm));
    path_wait(r, 0.25 * hold);
}

static void cycles(run *r, int n, double low, double high, double speed) {
    r->cycles = n;
    r->rate = speed;
    r->depth = high;
    for (int i = 0; i < n; i++) {
        path_to(r, high, speed);
        path_to(r, low, speed);
    }
}

/* To the surface and back: unloads and reloads. */
static void slow_cycles(session *s, random_state *rng, double Hz, double depth) {
    run *r = add(s, "cyclic", Hz, AIR);
    path_wait(r, 1.5);
    path_to(r, 0, 1 * mm);
    cycles(r, 4, 0, depth, 2 * depth / random_uniform(rng, 8, 11));
    path_to(r, AIR, 1 * mm);
    path_wait(r, 5);
}

static void fast_cycles(session *s, random_state *rng, double Hz, double depth) {
    double swing = random_uniform(rng, 0.6, 0.9) * mm, frequency = random_uniform(rng, 2, 3);
    run *r = add(s, "cyclic", Hz, AIR);
    path_wait(r, 1);
    path_to(r, depth - swing, 5 * mm);
    path_wait(r, 2);
    cycles(r, 20, depth - swing, depth + swing, 4 * swing * frequency);
    path_wait(r, 1);
    path_to(r, AIR, 5 * mm);
    path_wait(r, 3);
    r->corner = 0.25 / frequency;
}

/* The same motions without a specimen below. */
static void free_air(session *s, double Hz) {
    static const double speed[] = {1e-3, 4e-3, 10e-3};
    run *r = add(s, "free", Hz, AIR);
    path_wait(r, 1);
    for (size_t i = 0; i < 3; i++) {
        path_to(r, -6 * mm, speed[i]);
        path_wait(r, 0.5);
        path_to(r, AIR, speed[i]);
        path_wait(r, 0.5);
    }
    for (int i = 0; i < 6; i++) {
        path_to(r, -3.4 * mm, 7 * mm);
        path_to(r, AIR, 7 * mm);
    }
    path_wait(r, 1);
    r->corner = 0.08;
    r->rate = 10 * mm;
}

static void repeat(session *s, size_t which) {
    s->run[s->n_runs] = s->run[which];
    s->run[s->n_runs++].repeat = 2;
}

/* Times of day and places of the samples. */
static void schedule(session *s, random_state *rng) {
    double now = 0;
    s->n = 0;
    for (size_t i = 0; i < s->n_runs; i++) {
        run *r = &s->run[i];
        double length = r->knot_t[r->knots - 1];
        r->order = (int)i + 1;
        r->session = floor(now);
        r->n = (size_t)(length * r->Hz) + 1;
        r->first = s->n;
        r->hum_phase = random_uniform(rng, 0, 6.283185307179586);
        s->n += r->n;
        now += length + random_uniform(rng, 90, 300); /* the specimen recovers */
    }
}

static void shuffle(session *s, random_state *rng, size_t from) {
    for (size_t i = s->n_runs; i-- > from + 1;) {
        size_t k = from + random_index(rng, i - from + 1);
        run other = s->run[i];
        s->run[i] = s->run[k];
        s->run[k] = other;
    }
}

static size_t find(const session *s, const char *kind) {
    size_t i = 0;
    while (strcmp(s->run[i].kind, kind) != 0)
        i++;
    return i;
}

/* Rates that mains hum does not fold to nothing. */
void session_rich(session *s, random_state *rng, double height, double fineness) {
    static const double rates[] = {1e-3, 3e-3, 10e-3}, share[] = {0.45, 0.7, 1};
    double depth = random_uniform(rng, 0.28, 0.33) * height, hold = 55 * fmin(1, 2 * fineness);
    size_t turn = random_index(rng, 3);
    memset(s, 0, sizeof *s);
    s->deepest = depth;
    static_run(s, 24 * fineness, depth, 40);
    for (size_t i = 0; i < 3; i++)
        ramp_hold(s, 36 * sqrt(fineness), share[i] * depth, rates[(i + turn) % 3], hold);
    slow_cycles(s, rng, 44 * sqrt(fineness), 0.9 * depth);
    fast_cycles(s, rng, 180 * sqrt(fineness), 0.6 * depth);
    free_air(s, 180 * sqrt(fineness));
    shuffle(s, rng, 1);
    repeat(s, find(s, "ramp_hold"));
    repeat(s, 0);
    schedule(s, rng);
}

void session_seed(session *s, random_state *rng, double height) {
    memset(s, 0, sizeof *s);
    s->deepest = 9.7 / 30 * height;
    for (int i = 0; i < 12; i++) {
        run *r = add(s, "ramp_hold", 20, 0);
        r->depth = (1.5 + 0.5 * i) / 24 * height;
        r->ramp = 1;
        r->hold = 80;
        r->rate = r->depth / r->ramp;
        path_wait(r, 1);
        path_to(r, r->depth, r->rate);
        path_wait(r, r->hold);
    }
    run *r = add(s, "static", 20, 0);
    r->depth = s->deepest;
    r->rate = r->depth / 60;
    path_wait(r, 1);
    path_to(r, r->depth, r->rate);
    path_wait(r, 1);
    shuffle(s, rng, 0);
    repeat(s, 0);
    schedule(s, rng);
}
