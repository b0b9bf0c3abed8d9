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

void outside_add(const solid *s, const run *r, size_t number, double *force) {
    if (s->outside == WALK)
        walk(s, r, number, force);
    else if (s->outside != NO_OUTSIDE && s->outside != SLIP)
        for (size_t i = 0; i < r->n; i++)
            force[i] += s->outside_size * zero_at(s, r, number, (double)i / r->Hz);
}
