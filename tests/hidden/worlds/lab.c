/* lab.c: the laboratories, and what they run. Durations are counted in samples, so that a protocol suits its
 * tester. */
#include "worlds.h"

#include <math.h>
#include <string.h>

const lab laboratories[LABS] = {
    {"force_microscope", "2 kHz, 5e-9 N, 1.5 um, law of a sphere, headers without keys", 2000, 1e-5, 5e-9,
     0.15, 4e-3, 0.05, 0, GAUSS, HERTZ, RICH, THREE, .other = false},
    {"impact_bench", "10 kHz, 1 N, 1 mm, Fung's law", 10000, 5e-3, 1, 0.2, 2e-3, 0.02, 0, GAUSS, FUNG, RICH,
     FULL, .other = false},
    {"hour_long", "1 Hz, 100 N, 15 mm, law with a knee, heavy tails", 1, 0.1, 100, 0.15, 3e-3, 0.05, 0,
     STUDENT, PIECEWISE, RICH, HEIGHT, .other = false},
    {"large_press", "20 Hz, 1 kN, 0.1 m, Fung's law, heavy tails, contacts up to a fifth of the travel", 20,
     0.4, 1e3, 0.25, 3e-3, 0.2, 0, STUDENT, FUNG, RICH, HEIGHT, .other = false},
    {"cheap", "10 Hz, 3 N, 6 mm, Fung's law, a force step of 3 noise sd", 10, 0.03, 3, 0.2, 3e-3, 0.05, 0,
     QUANTIZED, FUNG, RICH, HEIGHT, .other = false},
    {"rumble", "50 Hz, 12 N, 4 mm, law with a knee, correlated noise, headers without keys", 50, 0.02, 12,
     0.2, 4e-3, 0.03, 0, CORRELATED, PIECEWISE, RICH, THREE, .other = false},
    {"specimens", "100 Hz, 20 N, 5 mm, Fung's law, another specimen in each run, 10 % stiffer or softer", 100,
     0.02, 20, 0.25, 2e-3, 0.02, 0.1, GAUSS, FUNG, RICH, FULL, .other = false},
    {"family", "40 Hz, 5 N, 5 mm, law and noise of the library's families", 40, 0.025, 5, 0.2, 3e-3, 0.02, 0,
     GAUSS, QUADRATIC, RICH, FULL, .other = false},
    {"one_recording", "100 Hz, 10 N, 4 mm, Fung's law, a single recording", 100, 0.02, 10, 0.2, 3e-3, 0.02, 0,
     GAUSS, FUNG, ONE_RUN, HEIGHT, .other = false},
    {"one_speed", "10 Hz, 8 N, 5 mm, law with a knee, four presses at one speed, no unloading", 10, 0.025, 8,
     0.2, 4e-3, 0.05, 0, GAUSS, PIECEWISE, ONE_SPEED, HEIGHT, .other = false},
    {"no_unloading", "30 Hz, 8 N, 5 mm, Fung's law, ramps and holds at three speeds, no unloading", 30, 0.025,
     8, 0.2, 3e-3, 0.05, 0, GAUSS, FUNG, NO_UNLOADING, HEIGHT, .other = false},
    /* Other testers. */
    {.name = "servo",
     .about = "500 Hz, 30 N, 6 mm, Fung's law; the plate overshoots and rings at each corner",
     .Hz = 500,
     .height = 0.024,
     .force = 30,
     .strain = 0.25,
     .noise = 2e-3,
     .scatter = 0.02,
     .law = FUNG,
     .protocol = RICH,
     .header = HEIGHT,
     .other = true,
     .tester = RINGS},
    {.name = "stepper",
     .about = "100 Hz, 2 N, 3 mm, law with a knee; steps of 1/400 of the travel, counted",
     .Hz = 100,
     .height = 0.015,
     .force = 2,
     .strain = 0.2,
     .noise = 3e-3,
     .scatter = 0.03,
     .law = PIECEWISE,
     .protocol = RICH,
     .header = HEIGHT,
     .other = true,
     .tester = STEPS},
    {.name = "sinusoids",
     .about = "200 Hz, 8 N, 2 mm, Fung's law; sinusoids of 5 to 150 samples a period",
     .Hz = 200,
     .height = 0.01,
     .force = 8,
     .strain = 0.2,
     .noise = 3e-3,
     .scatter = 0.02,
     .law = FUNG,
     .protocol = SINES,
     .header = HEIGHT,
     .other = true},
    {.name = "triangles",
     .about = "1 kHz, 2e-8 N, 1 um, law of a sphere; growing triangles, three speeds",
     .Hz = 1000,
     .height = 1e-5,
     .force = 2e-8,
     .strain = 0.1,
     .noise = 4e-3,
     .scatter = 0.05,
     .law = HERTZ,
     .protocol = TRIANGLES,
     .header = THREE,
     .other = true},
    {.name = "hand_held",
     .about = "50 Hz, 6 N, 5 mm, Fung's law; pressed by hand, noise of depth and clock",
     .Hz = 50,
     .height = 0.025,
     .force = 6,
     .strain = 0.2,
     .noise = 4e-3,
     .scatter = 0.05,
     .law = FUNG,
     .protocol = BY_HAND,
     .header = HEIGHT,
     .other = true,
     .depth_noise = 2.4e-3,
     .jitter = 0.1},
    {.name = "slow_clock",
     .about = "5 Hz, 15 N, 4 mm, law with a knee; presses of few samples",
     .Hz = 5,
     .height = 0.02,
     .force = 15,
     .strain = 0.2,
     .noise = 3e-3,
     .scatter = 0.03,
     .law = PIECEWISE,
     .protocol = RICH,
     .header = HEIGHT,
     .other = true,
     .fast = 4},
    {.name = "force_control",
     .about = "50 Hz, 10 N, 4 mm, Fung's law; ramps to a force, then creep",
     .Hz = 50,
     .height = 0.02,
     .force = 10,
     .strain = 0.2,
     .noise = 3e-3,
     .scatter = 0.03,
     .law = FUNG,
     .protocol = TO_FORCE,
     .header = HEIGHT,
     .other = true},
    {.name = "quasi_linear",
     .about = "100 Hz, 4 N, 4 mm, Fung's law; arms that the spring's force drives",
     .Hz = 100,
     .height = 0.02,
     .force = 4,
     .strain = 0.2,
     .noise = 3e-3,
     .scatter = 0.03,
     .law = FUNG,
     .protocol = RICH,
     .header = FULL,
     .other = true,
     .spectrum = FORCE_DRIVEN},
    {.name = "fractional",
     .about = "60 Hz, 12 N, 5 mm, quadratic law; a springpot beside it",
     .Hz = 60,
     .height = 0.025,
     .force = 12,
     .strain = 0.2,
     .noise = 3e-3,
     .scatter = 0.03,
     .law = QUADRATIC,
     .protocol = RICH,
     .header = FULL,
     .other = true,
     .spectrum = FRACTIONAL},
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
    return lab_travel(l) * l->Hz * (l->fast > 0 ? l->fast : 1) / samples;
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

/* ---- other testers ---- */

/* Periods of so many samples about a depth, both of the travel. */
static void sinusoid(run *r, const lab *l, double middle, double size, double samples, int periods) {
    enum { PARTS = 16 };
    double travel = lab_travel(l), period = samples / l->Hz, last = 0;
    path_to(r, middle * travel, speed(l, 100));
    for (int i = 1; i <= PARTS * periods; i++) {
        double d = size * sin(6.283185307179586 * i / PARTS);
        path_to(r, (middle + d) * travel, fmax(1e-9, fabs(d - last)) * travel * PARTS / period);
        last = d;
    }
}

static void sines(session *s, const lab *l) {
    static const double samples[] = {150, 40, 12, 5};
    for (int i = 0; i < 4; i++) {
        run *r = add(s, l, "sine");
        r->corner = 0.1 * samples[i] / l->Hz;
        sinusoid(r, l, 0.6, i % 2 ? 0.35 : 0.2, samples[i], 7);
        path_to(r, -0.3 * lab_travel(l), speed(l, 100));
        path_wait(r, 60 / l->Hz);
    }
    cycles(add(s, l, "cyclic"), l, 2, 200);
    dwell(add(s, l, "ramp_hold"), l, 0.9, 30, true);
}

static void triangles(session *s, const lab *l) {
    static const double samples[] = {400, 100, 25, 100};
    for (int i = 0; i < 4; i++) {
        run *r = add(s, l, "cyclic");
        for (int k = 1; k <= 4; k++) {
            path_to(r, 0.25 * k * lab_travel(l), speed(l, samples[i]));
            path_to(r, k < 4 ? 0 : -0.3 * lab_travel(l), speed(l, samples[i]));
        }
        path_wait(r, 40 / l->Hz);
    }
}

/* What a plate does that holds a force on a specimen that creeps: on and on by the logarithm of time. */
static void creep(run *r, const lab *l, double share, double samples) {
    path_to(r, share * lab_travel(l), speed(l, samples));
    double before = 0;
    for (int i = 1; i <= 24; i++) {
        double now = log1p(15 * (double)i / 24), rise = 0.05 * share * lab_travel(l) * (now - before);
        path_to(r, r->knot_d[r->knots - 1] + rise, rise * l->Hz / 15);
        before = now;
    }
    path_to(r, -0.3 * lab_travel(l), speed(l, samples));
    path_wait(r, 60 / l->Hz);
}

static void to_force(session *s, const lab *l) {
    creep(add(s, l, "creep"), l, 0.4, 40);
    creep(add(s, l, "creep"), l, 0.7, 40);
    creep(add(s, l, "creep"), l, 0.85, 40);
    creep(add(s, l, "creep"), l, 0.85, 160);
    creep(add(s, l, "creep"), l, 0.85, 20);
}

static void by_hand(session *s, const lab *l, random_state *rng) {
    double travel = lab_travel(l);
    for (int i = 0; i < 6; i++) {
        run *r = add(s, l, "static");
        r->corner = 8 / l->Hz;
        double pace = speed(l, random_log(rng, 15, 120)), most = random_uniform(rng, 0.6, 1);
        for (int k = 1; k <= 5; k++)
            path_to(r, most * travel * (0.2 * k + random_uniform(rng, -0.07, 0.07)),
                    pace * random_log(rng, 0.6, 1.7));
        for (int k = 0; k < 8; k++) { /* a hand does not stand still */
            path_to(r, travel * (most + random_uniform(rng, -0.06, 0.06)),
                    speed(l, random_log(rng, 200, 900)));
            path_wait(r, 5 / l->Hz);
        }
        for (int k = 4; k >= 1; k--)
            path_to(r, most * travel * (0.2 * k + random_uniform(rng, -0.07, 0.07)),
                    pace * random_log(rng, 0.6, 1.7));
        path_to(r, -0.3 * travel, pace);
        path_wait(r, 40 / l->Hz);
    }
}

/* The plate is a mass on its drive's spring: each change of speed leaves a swing that dies away. */
static void ring(const run *r, double t, double *d, double *v) {
    static const double damping = 0.15;
    double w = 6.283185307179586 * r->Hz / 25;
    for (size_t k = 1; k + 1 < r->knots && r->knot_t[k] < t; k++) {
        double since = t - r->knot_t[k], fade = exp(-damping * w * since);
        if (fade < 1e-9)
            continue;
        double before = (r->knot_d[k] - r->knot_d[k - 1]) / (r->knot_t[k] - r->knot_t[k - 1]);
        double after = (r->knot_d[k + 1] - r->knot_d[k]) / (r->knot_t[k + 1] - r->knot_t[k]);
        *d -= (after - before) / w * fade * sin(w * since);
        *v -= (after - before) * fade * (cos(w * since) - damping * sin(w * since));
    }
}

static double step_of(const lab *l) {
    return lab_travel(l) / 400;
}

/* It stands for most of a step's time, then moves on by one. */
static void step(const lab *l, double *d, double *v) {
    static const double moving = 0.2;
    double at = *d / step_of(l), whole = floor(at), share = fmax(0, (at - whole - 1 + moving) / moving);
    *d = step_of(l) * (whole + share * share * (3 - 2 * share));
    *v *= share > 0 ? 6 * share * (1 - share) / moving : 0;
}

void lab_path(const lab *l, const run *r, double t, size_t *hint, double *d, double *v, double *a) {
    path_at(r, t, hint, d, v, a);
    if (l && l->tester == RINGS)
        ring(r, t, d, v);
    else if (l && l->tester == STEPS)
        step(l, d, v);
}

double lab_depth(const lab *l, const run *r, double t, size_t *hint, random_state *rng) {
    double d, v, a;
    lab_path(l->tester == STEPS ? NULL : l, r, t, hint, &d, &v, &a);
    if (l->tester == STEPS)
        d = step_of(l) * floor(d / step_of(l));
    if (l->depth_noise > 0)
        d += l->depth_noise * lab_travel(l) * random_normal(rng);
    return d;
}

double lab_time(const lab *l, const run *r, size_t number, size_t i) {
    double late = 0;
    if (l && l->jitter > 0 && i > 0) {
        random_state own = random_make(1000 + number, i);
        late = l->jitter * fmax(-3, fmin(3, random_normal(&own)));
    }
    return ((double)i + late) / r->Hz;
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
    if (l->protocol == SINES)
        sines(s, l);
    else if (l->protocol == TRIANGLES)
        triangles(s, l);
    else if (l->protocol == TO_FORCE)
        to_force(s, l);
    else if (l->protocol == BY_HAND)
        by_hand(s, l, rng);
    for (size_t i = 0; i < s->n_runs && l->tester == RINGS; i++)
        s->run[i].corner = 0;
    schedule(s, rng);
}
