/* lab.c: the laboratories, and what they run. Durations are counted in samples, so that a protocol suits its
 * tester. */
#include "worlds.h"

#include <math.h>
#include <string.h>

const lab laboratories[LABS] = {
    {"force_microscope", "2 kHz, 5e-9 N, 1.5 um, law of a sphere, headers without keys", 2000, 1e-5, 5e-9,
     0.15, 4e-3, 0.05, 0, GAUSS, HERTZ, RICH, THREE},
    {"impact_bench", "10 kHz, 1 N, 1 mm, Fung's law", 10000, 5e-3, 1, 0.2, 2e-3, 0.02, 0, GAUSS, FUNG, RICH,
     FULL},
    {"hour_long", "1 Hz, 100 N, 15 mm, law with a knee, heavy tails", 1, 0.1, 100, 0.15, 3e-3, 0.05, 0,
     STUDENT, PIECEWISE, RICH, HEIGHT},
    {"large_press", "20 Hz, 1 kN, 0.1 m, Fung's law, heavy tails, contacts up to a fifth of the travel", 20,
     0.4, 1e3, 0.25, 3e-3, 0.2, 0, STUDENT, FUNG, RICH, HEIGHT},
    {"cheap", "10 Hz, 3 N, 6 mm, Fung's law, a force step of 3 noise sd", 10, 0.03, 3, 0.2, 3e-3, 0.05, 0,
     QUANTIZED, FUNG, RICH, HEIGHT},
    {"rumble", "50 Hz, 12 N, 4 mm, law with a knee, correlated noise, headers without keys", 50, 0.02, 12,
     0.2, 4e-3, 0.03, 0, CORRELATED, PIECEWISE, RICH, THREE},
    {"specimens", "100 Hz, 20 N, 5 mm, Fung's law, another specimen in each run, 10 % stiffer or softer", 100,
     0.02, 20, 0.25, 2e-3, 0.02, 0.1, GAUSS, FUNG, RICH, FULL},
    {"family", "40 Hz, 5 N, 5 mm, law and noise of the library's families", 40, 0.025, 5, 0.2, 3e-3, 0.02, 0,
     GAUSS, QUADRATIC, RICH, FULL},
    {"one_recording", "100 Hz, 10 N, 4 mm, Fung's law, a single recording", 100, 0.02, 10, 0.2, 3e-3, 0.02, 0,
     GAUSS, FUNG, ONE_RUN, HEIGHT},
    {"one_speed", "10 Hz, 8 N, 5 mm, law with a knee, four presses at one speed, no unloading", 10, 0.025, 8,
     0.2, 4e-3, 0.05, 0, GAUSS, PIECEWISE, ONE_SPEED, HEIGHT},
    {"no_unloading", "30 Hz, 8 N, 5 mm, Fung's law, ramps and holds at three speeds, no unloading", 30, 0.025,
     8, 0.2, 3e-3, 0.05, 0, GAUSS, FUNG, NO_UNLOADING, HEIGHT},
};

double lab_travel(const lab *l) {
    return l->strain * l->height;
}

static run *add(session *s, const lab *l, const char *kind) {
    run *r = &s->run[s->n_runs++];
    memset(r, 0, sizeof *r);
    r->kind = kind;
    r->Hz = l->Hz;
    r->corner = 4 / l->Hz;
    r->rate = lab_travel(l) * l->Hz / 250;
    path_start(r, -0.3 * lab_travel(l));
    path_wait(r, 40 / l->Hz);
    return r;
}

/* Speeds: the travel in so many samples. */
static double speed(const lab *l, double samples) {
    return lab_travel(l) * l->Hz / samples;
}

static void cycles(run *r, const lab *l, int n, double samples) {
    for (int i = 0; i < n; i++) {
        path_to(r, lab_travel(l), speed(l, samples));
        path_to(r, i + 1 < n ? 0 : -0.3 * lab_travel(l), speed(l, samples));
    }
    path_wait(r, 60 / l->Hz);
}

static void dwell(run *r, const lab *l, double share, double samples, bool back) {
    path_to(r, share * lab_travel(l), speed(l, samples));
    path_wait(r, 350 / l->Hz);
    if (!back)
        return;
    path_to(r, -0.3 * lab_travel(l), speed(l, 50));
    path_wait(r, 60 / l->Hz);
}

static void rich(session *s, const lab *l) {
    cycles(add(s, l, "cyclic"), l, 1, 250);
    cycles(add(s, l, "cyclic"), l, 3, 60);
    cycles(add(s, l, "cyclic"), l, 8, 20);
    dwell(add(s, l, "ramp_hold"), l, 0.6, 40, true);
    dwell(add(s, l, "ramp_hold"), l, 0.8, 160, true);
    dwell(add(s, l, "ramp_hold"), l, 1, 20, true);
    dwell(add(s, l, "ramp_hold"), l, 1, 40, true);
}

static void one_run(session *s, const lab *l) {
    run *r = add(s, l, "cyclic");
    cycles(r, l, 2, 150);
    cycles(r, l, 6, 20);
    dwell(r, l, 0.8, 30, true);
}

/* Times of day and places of the samples; the specimen recovers in between. */
static void schedule(session *s, random_state *rng) {
    double now = 0;
    s->n = 0;
    for (size_t i = 0; i < s->n_runs; i++) {
        run *r = &s->run[i];
        double length = r->knot_t[r->knots - 1];
        r->order = (int)i + 1;
        r->session = now;
        r->n = (size_t)(length * r->Hz) + 1;
        r->first = s->n;
        r->hum_phase = random_uniform(rng, 0, 6.283185307179586);
        s->n += r->n;
        now += length * random_uniform(rng, 3, 6);
    }
}

void lab_session(const lab *l, random_state *rng, session *s) {
    memset(s, 0, sizeof *s);
    s->deepest = lab_travel(l);
    if (l->protocol == RICH)
        rich(s, l);
    else if (l->protocol == ONE_RUN)
        one_run(s, l);
    for (int i = 0; i < 4 && l->protocol == ONE_SPEED; i++)
        path_to(add(s, l, "static"), lab_travel(l), speed(l, 400));
    for (int i = 0; i < 5 && l->protocol == NO_UNLOADING; i++)
        dwell(add(s, l, "ramp_hold"), l, i % 2 ? 0.7 : 1, i < 2 ? 160 : i < 4 ? 40 : 20, false);
    schedule(s, rng);
}
