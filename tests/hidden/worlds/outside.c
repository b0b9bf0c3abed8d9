/* outside.c: what happens in laboratories and is in no catalogue. */
#include "worlds.h"

#include <math.h>

static const double two_pi = 6.283185307179586;

static double length_of(const run *r) {
    return (double)(r->n - 1) / r->Hz;
}

/* A specimen that slips bears less from then on. */
double outside_factor(const solid *s, const run *r, size_t number, double t) {
    bool here = s->outside == SLIP && number == s->outside_run && t > s->outside_place * length_of(r);
    return here ? 1 - s->outside_size : 1;
}

/* Something swings and comes to rest. */
static double wave(const solid *s, const run *r, double t) {
    double after = (t - s->outside_place * length_of(r)) / length_of(r);
    return after <= 0 ? 0 : exp(-after / 0.06) * sin(25 * two_pi * after);
}

/* Of unit size; a run's own sign and time of warming up come from its number. */
static double zero_at(const solid *s, const run *r, size_t number, double t) {
    random_state own = random_make(s->seed, number);
    double sign = random_sign(&own), time = random_uniform(&own, 0.03, 0.1) * length_of(r);
    switch (s->outside) {
    case WAVE:
        return number == s->outside_run ? wave(s, r, t) : 0;
    case WARM_UP:
        return sign * exp(-t / time);
    case JUMP:
        return (number + s->outside_run) % 2 == 0 && t > s->outside_place * length_of(r) ? sign : 0;
    case ROOM:
        return sin(two_pi * ((r->session + t) / (length_of(r) * (0.3 + 0.4 * s->outside_place))));
    default:
        return 0;
    }
}

/* A zero that wanders: smooth over a twentieth of the run. */
static void walk(const solid *s, const run *r, size_t number, double *force) {
    random_state own = random_make(s->seed, 1000 + number);
    double keep = exp(-20.0 / (double)r->n), rough = 0, smooth = 0;
    for (size_t i = 0; i < r->n; i++) {
        rough = keep * rough + sqrt(1 - keep * keep) * random_normal(&own);
        smooth = keep * smooth + (1 - keep) * rough;
        force[i] += s->outside_size * smooth;
    }
}

/* ---- what comes again in every run ---- */

double outside_depth(const solid *s, outside_memory *m, double d) {
    double travel = s->top * s->height, play = s->outside_size * travel;
    if (s->outside == PLAY)
        return m->plate = fmin(d + 0.5 * play, fmax(d - 0.5 * play, m->plate));
    return s->outside == GRIP ? d - 0.3 * play * m->most : d;
}

/* motion: depth, velocity and acceleration of the plate. */
double outside_force(const solid *s, const run *r, outside_memory *m, double t, double h,
                     const double motion[3], double force) {
    double travel = s->top * s->height, depth = motion[0] / travel, speed = motion[1] / r->rate,
           size = s->outside_size, rings = two_pi * r->Hz / 30, change = (force - m->force) / (0.1 * s->size);
    m->force = force;
    switch (s->outside) {
    case LOAD_CELL:
        m->lag += change - fabs(change) * m->lag;
        return force + 0.2 * size * s->size * m->lag;
    case CURING:
        return force * (1 + size * t * r->Hz / 600);
    case POSITION:
        return force * (1 + 0.3 * size * sin(1.5 * two_pi * depth));
    case GRIP:
        m->most = fmax(m->most, fmax(0, force / s->size - s->outside_place));
        return force;
    case RINGING:
        m->speed -= h * (0.1 * rings * m->speed + rings * rings * m->swing + motion[2] / travel);
        m->swing += h * m->speed;
        return force + 2 * size * s->size * m->swing;
    case EACH_WARM_UP:
        return force + 0.3 * size * s->size * exp(-t * r->Hz / (60 * s->outside_place));
    case SLOW_ROOM:
        return force +
               0.3 * size * s->size * sin(two_pi * (r->session + t) * r->Hz / (8000 * s->outside_place));
    case DAMPER:
        return force + 0.1 * size * s->size * copysign(pow(fabs(speed), 0.4), speed);
    case WALL:
        return force + size * s->size * fmax(0, depth - s->outside_place) *
                           (speed > 0   ? 1
                            : speed < 0 ? -1
                                        : 0);
    default:
        return force;
    }
}

void outside_add(const solid *s, const run *r, size_t number, double *force) {
    if (s->outside == WALK)
        walk(s, r, number, force);
    else if (s->outside != NO_OUTSIDE && s->outside != SLIP && s->outside < OUTSIDES)
        for (size_t i = 0; i < r->n; i++)
            force[i] += s->outside_size * zero_at(s, r, number, (double)i / r->Hz);
}
