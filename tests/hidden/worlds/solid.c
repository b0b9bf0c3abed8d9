/* solid.c: the true specimen and tester: a generalized Maxwell solid in small steps, arms by the implicit
 * midpoint rule, the free surface by bisection, the sensor's lag as a differential equation. */
#include "worlds.h"

#include <math.h>
#include <string.h>

static const double two_pi = 6.283185307179586;

/* ---- the law ---- */

enum { KNEE_RATIO = 3 }; /* how much stiffer beyond the knee */

/* Force at y = e / top >= 0, of size 1 at y = 1. */
static double unit_force(const solid *s, double y) {
    double knee = s->shape, soft = 1 / (knee + KNEE_RATIO * (1 - knee));
    switch (s->law) {
    case FUNG:
        return expm1(s->shape * y) / expm1(s->shape);
    case PIECEWISE:
        return soft * (fmin(y, knee) + KNEE_RATIO * fmax(0, y - knee));
    case HERTZ:
        return y * sqrt(y);
    default:
        return y * (1 + s->shape * y) / (1 + s->shape);
    }
}

static double unit_energy(const solid *s, double y) {
    double knee = s->shape, soft = 1 / (knee + KNEE_RATIO * (1 - knee)), beyond = fmax(0, y - knee);
    switch (s->law) {
    case FUNG:
        return (expm1(s->shape * y) / s->shape - y) / expm1(s->shape);
    case PIECEWISE:
        return soft * (0.5 * y * y + 0.5 * (KNEE_RATIO - 1) * beyond * beyond);
    case HERTZ:
        return 0.4 * y * y * sqrt(y);
    default:
        return y * y * (0.5 + s->shape * y / 3) / (1 + s->shape);
    }
}

double solid_spring(const solid *s, double e) {
    double y = fabs(e) / s->top, force = s->size * unit_force(s, y);
    for (int k = 0; k < HATS; k++) /* the last of them at 1.3 times the full travel */
        if (s->hat[k] != 0)
            force += s->hat[k] * fmax(0, 1 - fabs(y * HATS / 1.3 - (k + 1)));
    return e < 0 ? -force : force;
}

double solid_energy(const solid *s, double e) {
    return s->size * s->top * unit_energy(s, fabs(e) / s->top);
}

/* ---- the specimen ---- */

typedef struct state {
    const solid *s;
    double step, speed, factor; /* speed: of the plate, in strain */
    double strain, arm_force[SOLID_ARMS], most, energy;
    bool touching;
    double force;
} state;

static double softened(const state *at, double e) {
    const double *damage = at->s->effect[DAMAGE_SOFTENING];
    double below = at->energy - solid_energy(at->s, e);
    return damage[0] == 0 || below <= 0 ? 1 : 1 - damage[0] * erf(below / (damage[1] * at->energy));
}

static double spring(const state *at, double e) {
    double set = at->s->effect[PERMANENT_SET][0], seen = e;
    if (set != 0)
        seen = fmax(0, (e - set * fmax(at->most, e)) / (1 - set));
    double rate = at->s->effect[RATE_STIFFENING][0];
    double stiffer = rate == 0 || !at->touching ? 1 : 1 + rate * log10(1 + fabs(at->speed) / 0.01);
    return solid_spring(at->s, seen) * softened(at, e) * stiffer;
}

/* What the arms follow, as a strain. */
static double drive(const solid *s, double e) {
    return s->force_driven ? solid_spring(s, e) * s->top / s->size : e;
}

static double arm_after(const state *at, size_t j, double e) {
    const arm *own = &at->s->arms[j];
    double half = 0.5 * at->step / own->time;
    double moved = drive(at->s, e) - drive(at->s, at->strain);
    return (at->arm_force[j] * (1 - half) + own->stiffness * moved) / (1 + half);
}

static double force_at(const state *at, double e) {
    double force = spring(at, e);
    for (size_t j = 0; j < at->s->n_arms; j++)
        force += arm_after(at, j, e);
    return at->factor * force;
}

/* Where the surface lies that nothing presses. */
static double free_strain(const state *at) {
    double low = fmin(0, at->strain) - at->s->top, high = fmax(0, at->strain) + at->s->top;
    for (int i = 0; i < 40; i++) { /* to 1e-12 of the travel */
        double middle = 0.5 * (low + high);
        if (force_at(at, middle) > 0)
            high = middle;
        else
            low = middle;
    }
    return 0.5 * (low + high);
}

/* Whether nothing moves any more but by less than a millionth. */
static bool at_rest(const state *at) {
    double most = fabs(at->strain) / at->s->top;
    for (size_t j = 0; j < at->s->n_arms; j++)
        most = fmax(most, fabs(at->arm_force[j]) / at->s->size);
    return most < 1e-6;
}

static void advance(state *at, double plate) {
    double e = plate, force = at->touching ? force_at(at, e) : 0;
    if (at->touching && force < -at->s->effect[ADHESION][0])
        at->touching = false;
    if (!at->touching) {
        e = plate <= 0 && at_rest(at) ? at->strain : free_strain(at);
        at->touching = plate > e;
        if (at->touching)
            e = plate;
        force = at->touching ? force_at(at, e) : 0;
    }
    for (size_t j = 0; j < at->s->n_arms; j++)
        at->arm_force[j] = arm_after(at, j, e);
    at->strain = e;
    at->most = fmax(at->most, e);
    at->energy = fmax(at->energy, solid_energy(at->s, e));
    at->force = force;
}

/* ---- the tester ---- */

/* Friction against the motion, and a ripple of the drive. */
static double frame_force(const solid *s, const run *r, double d, double v) {
    const double *ripple = s->effect[DRIVE_RIPPLE];
    double force = s->effect[COULOMB_FRICTION][0] * v / (fabs(v) + 1e-3 * r->rate);
    return force + (ripple[0] == 0 ? 0 : ripple[0] * sin(two_pi * d / ripple[1] + ripple[2]));
}

static double lagged(const solid *s, double h, double before, double old, double input) {
    double time = s->effect[SENSOR_LAG][0], half = time > 0 ? 0.5 * h / time : 0;
    return time == 0 ? input : (before * (1 - half) + half * (old + input)) / (1 + half);
}

static size_t steps_of(const solid *s, double dt) {
    double shortest = s->effect[SENSOR_LAG][0] > 0 ? s->effect[SENSOR_LAG][0] : dt;
    for (size_t j = 0; j < s->n_arms; j++)
        shortest = fmin(shortest, s->arms[j].time);
    return (size_t)fmin(100, fmax(4, ceil(10 * dt / shortest)));
}

static void record(const solid *s, const run *r, double *force) {
    const double *hum = s->effect[MAINS_HUM];
    for (size_t i = 0; i < r->n; i++) {
        double t = (double)i / r->Hz;
        force[i] += s->effect[SENSOR_DRIFT][0] * t;
        if (hum[0] != 0)
            force[i] += hum[0] * sin(two_pi * hum[1] * t + r->hum_phase);
    }
}

void solid_press(const solid *s, const run *r, size_t number, double *force) {
    size_t steps = steps_of(s, 1 / r->Hz), hint = 0;
    double d, v, a, output = 0, old = 0, before = -1 / r->Hz;
    state at = {.s = s};
    outside_memory memory = {0};
    for (size_t i = 0; i < r->n; i++) {
        double now = lab_time(s->lab, r, number, i), h = (now - before) / (double)steps;
        at.step = h;
        for (size_t k = i == 0 ? steps - 1 : 0; k < steps;
             k++) { /* the first sample is of a specimen at rest */
            double t = before + (double)(k + 1) * h;
            lab_path(s->lab, r, t, &hint, &d, &v, &a);
            at.factor = (1 + r->gain) * outside_factor(s, r, number, t);
            at.speed = v / s->height;
            memory.plate = i == 0 ? d : memory.plate;
            advance(&at, (outside_depth(s, &memory, d) - r->shift) / s->height);
            double input = outside_force(s, r, &memory, t, h, (double[]){d, v, a}, at.force);
            input += frame_force(s, r, d, v);
            output = i == 0 ? input : lagged(s, h, output, old, input);
            old = input;
        }
        force[i] = output;
        before = now;
    }
    record(s, r, force);
    outside_add(s, r, number, force);
}

void session_press(const solid *s, const session *runs, double *force) {
    double end = s->effect[FORCE_SATURATION][0];
    for (size_t i = 0; i < runs->n_runs; i++)
        solid_press(s, &runs->run[i], i, force + runs->run[i].first);
    for (size_t i = 0; i < runs->n && end > 0; i++)
        force[i] = fmax(-end, fmin(end, force[i]));
}
