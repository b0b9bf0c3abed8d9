/* draw.c: draws a case: specimen, runs, what is hidden and how strong, noise. */
#include "worlds.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double two_pi = 6.283185307179586;

/* A springpot of this exponent: arms evenly in the logarithm of their times, from a sample to a run. */
static void draw_springpot(const lab *l, random_state *rng, solid *s) {
    double exponent = random_uniform(rng, 0.15, 0.4),
           size = s->size / s->top * random_uniform(rng, 0.1, 0.25);
    s->n_arms = SPECTRUM;
    for (size_t j = 0; j < SPECTRUM; j++) {
        double times = pow(2000, (double)j / (SPECTRUM - 1)); /* of the first */
        s->arms[j] = (arm){size * pow(times, -exponent), times / l->Hz};
    }
}

static void draw_solid(const lab *l, random_state *rng, solid *s) {
    memset(s, 0, sizeof *s);
    s->lab = l;
    s->force_driven = l->spectrum == FORCE_DRIVEN;
    s->height = l->height;
    s->top = l->strain;
    s->law = l->law;
    s->size = l->force * random_uniform(rng, 0.5, 0.7);
    s->shape = l->law == FUNG ? random_uniform(rng, 1.5, 3.5) : random_uniform(rng, 0.4, 0.7);
    if (l->spectrum == FRACTIONAL) {
        draw_springpot(l, rng, s);
        return;
    }
    s->n_arms = 1 + random_index(rng, 2);
    for (size_t j = 0; j < s->n_arms; j++) {
        s->arms[j].stiffness = s->size / s->top * random_uniform(rng, 0.2, 0.6);
        s->arms[j].time = (j == 0 ? random_log(rng, 8, 30) : random_log(rng, 80, 250)) / l->Hz;
    }
}

/* ---- the catalogue, in units of the laboratory ---- */

bool effect_possible(const lab *l, int id) {
    switch (id) {
    case RELAXATION_ARM:
    case SENSOR_LAG:
    case SENSOR_DRIFT:
    case FORCE_SATURATION:
        return true;
    case COULOMB_FRICTION: /* a hand has no guide and no drive */
    case DRIVE_RIPPLE:
        return l->protocol != BY_HAND;
    case PERMANENT_SET:
    case DAMAGE_SOFTENING:
    case ADHESION:
        return l->protocol != ONE_SPEED && l->protocol != NO_UNLOADING &&
               (id != ADHESION || l->protocol != SINES);
    case RATE_STIFFENING: /* its rates are those of 1 %/s and more */
        return l->Hz >= 10;
    case MAINS_HUM:
        return l->Hz >= 200;
    default:
        return false;
    }
}

void effect_shape(const truth *t, const solid *s, int id, random_state *rng, double shape[VALUES]) {
    double travel = lab_travel(t->lab);
    memset(shape, 0, VALUES * sizeof *shape);
    shape[0] = id == SENSOR_DRIFT ? random_sign(rng) : 1;
    if (id == RELAXATION_ARM)
        do
            shape[1] = random_log(rng, 8, 250) / t->lab->Hz;
        while (fabs(log(shape[1] / s->arms[0].time)) < log(4));
    if (id == DAMAGE_SOFTENING)
        shape[1] = random_uniform(rng, 0.3, 0.8);
    if (id == MAINS_HUM)
        shape[1] = (random_sign(rng) > 0 ? 60 : 50) + random_uniform(rng, -0.1, 0.1);
    if (id == DRIVE_RIPPLE) {
        shape[1] = random_log(rng, 0.06, 0.25) * travel;
        shape[2] = random_uniform(rng, 0, two_pi);
    }
}

/* At strength 1: in units of the stiffness, the peak force, a sample, a run's length. */
static double full_strength(const truth *t, const solid *s, int id, double peak) {
    const run *first = &t->session.run[0];
    switch (id) {
    case RELAXATION_ARM:
        return s->size / s->top;
    case SENSOR_LAG:
        return 30 / t->lab->Hz;
    case SENSOR_DRIFT:
        return 0.5 * peak * first->Hz / (double)first->n;
    case RATE_STIFFENING:
    case DAMAGE_SOFTENING:
        return 0.6;
    case PERMANENT_SET:
        return 0.5;
    default: /* of the force */
        return 0.4 * peak;
    }
}

void effect_put(const truth *t, solid *s, int id, double strength, const double shape[VALUES], double peak) {
    double *value = s->effect[id];
    memcpy(value, shape, VALUES * sizeof *value);
    value[0] = id == FORCE_SATURATION ? (1 - 0.6 * strength) * peak
                                      : shape[0] * strength * full_strength(t, s, id, peak);
    if (id == RELAXATION_ARM)
        s->arms[s->n_arms++] = (arm){value[0], value[1]};
}

/* ---- what is hidden ---- */

typedef struct secret {
    int effect;
    enum outside_id outside;
    double shape[VALUES], place, peak;
    size_t run;
    uint64_t seed;
} secret;

static void hide(const truth *t, const secret *what, double strength, solid *s) {
    if (what->effect != EFFECTS)
        effect_put(t, s, what->effect, strength, what->shape, what->peak);
    if (what->outside == NO_OUTSIDE)
        return;
    s->outside = what->outside;
    s->outside_size = what->outside >= OUTSIDES ? strength
                      : what->outside == SLIP   ? 0.5 * strength
                                                : (what->outside == WALK ? 2 : 0.5) * strength * what->peak;
    s->outside_place = what->place;
    s->outside_run = what->run;
    s->seed = what->seed;
}

/* The strength with so many nats, in hidden; false where none does. */
static bool strengthen(search *h, const secret *what, double nats, solid *hidden) {
    size_t n = what->effect == EFFECTS ? 1 : effect_kinds[what->effect].n;
    double low = log(1e-5), high = 0;
    *hidden = h->plain;
    hide(h->beside.truth, what, 1, hidden);
    if (search_evidence(h, hidden, n) < nats)
        return false;
    for (int i = 0; i < 14; i++) {
        double middle = 0.5 * (low + high);
        solid s = h->plain;
        hide(h->beside.truth, what, exp(middle), &s);
        if (search_evidence(h, &s, n) < nats)
            low = middle;
        else
            high = middle;
    }
    *hidden = h->plain;
    hide(h->beside.truth, what, exp(high), hidden);
    return true;
}

/* Where the data say nothing of an effect, it is there all the same. */
static bool vanishes(const lab *l) {
    return l->protocol == ONE_SPEED || l->protocol == NO_UNLOADING;
}

static double highest(const double cosine[EFFECTS]) {
    double most = 0;
    for (int i = 0; i < EFFECTS; i++)
        most = fmax(most, cosine[i]);
    return most;
}

/* A second effect, as strong by itself as the first and unlike it. */
static bool hide_second(truth *t, search *h, const secret *what, random_state *rng) {
    solid alone;
    if (!strengthen(h, what, random_log(rng, 60, 600), &alone))
        return false;
    t->second = what->effect;
    t->second_evidence = search_evidence(h, &alone, effect_kinds[what->effect].n);
    if (!evidence_classes(h, &alone, t->second_cosine))
        return false;
    memcpy(t->solid.effect[t->second], alone.effect[t->second], sizeof alone.effect[0]);
    if (t->second == RELAXATION_ARM)
        t->solid.arms[t->solid.n_arms++] = alone.arms[alone.n_arms - 1];
    return t->second != t->effect && t->cosine[t->second] < 0.7 && t->second_cosine[t->effect] < 0.7;
}

static bool hide_at_all(truth *t, search *h, const secret *what, random_state *rng) {
    double nats = random_log(rng, 60, 2000);
    solid hidden = h->plain;
    if (vanishes(t->lab))
        hide(t, what, random_uniform(rng, 0.1, 0.4), &hidden);
    else if (!strengthen(h, what, nats, &hidden))
        return false;
    t->solid = hidden;
    t->evidence = search_evidence(h, &hidden, what->effect == EFFECTS ? 1 : effect_kinds[what->effect].n);
    if (!evidence_classes(h, &hidden, t->cosine))
        return false;
    return what->outside == NO_OUTSIDE || highest(t->cosine) < 0.7;
}

/* What is tried at this attempt; the laboratory's cases go through the catalogue. */
static secret draw_secret(const truth *t, const solid *plain, int kind, uint64_t turn, random_state *rng) {
    secret what = {.effect = EFFECTS, .peak = t->lab->force};
    if (kind == 2)
        what.outside = (enum outside_id)(1 + turn % (OUTSIDES - 1));
    if (kind == 4)
        what.outside = (enum outside_id)(OUTSIDES + turn % (ALL_OUTSIDES - OUTSIDES));
    if (kind == 1 || kind == 3) {
        do
            what.effect = (int)random_index(rng, EFFECTS);
        while (!effect_possible(t->lab, what.effect) || (what.effect == RELAXATION_ARM && plain->n_arms > 1));
        effect_shape(t, plain, what.effect, rng, what.shape);
    }
    what.place = random_uniform(rng, 0.35, 0.6);
    what.run = random_index(rng, t->session.n_runs);
    what.seed = (uint64_t)(random_uniform(rng, 0, 1) * 1e15);
    return what;
}

/* ---- each run's own, and noise ---- */

static void draw_runs(truth *t, random_state *rng) {
    double common = random_uniform(rng, -0.5, 0.5) * t->lab->scatter;
    for (size_t i = 0; i < t->session.n_runs; i++) {
        run *r = &t->session.run[i];
        double own = fmax(-t->lab->scatter,
                          fmin(t->lab->scatter, common + 0.5 * t->lab->scatter * random_normal(rng)));
        r->shift = own * lab_travel(t->lab);
        r->gain = fmax(-0.4, (t->lab->differ > 0 ? t->lab->differ : 1e-3) * random_normal(rng));
        t->zero[i] = 2 * t->white * random_normal(rng);
    }
}

static double draw_noise(const truth *t, random_state *rng) {
    if (t->lab->kind != STUDENT)
        return t->white * random_normal(rng);
    double a = random_normal(rng), b = random_normal(rng),
           c = random_normal(rng); /* three degrees of freedom */
    return t->white * random_normal(rng) / sqrt(a * a + b * b + c * c);
}

static void record(truth *t, random_state *rng) {
    double end = t->solid.effect[FORCE_SATURATION][0];
    session_press(&t->solid, &t->session, t->force);
    for (size_t i = 0; i < t->session.n_runs; i++) {
        const run *r = &t->session.run[i];
        double noise = draw_noise(t, rng);
        for (size_t k = r->first; k < r->first + r->n; k++) {
            double force = t->force[k] + noise + t->zero[i];
            if (t->step > 0)
                force = t->step * floor(force / t->step + 0.5);
            t->force[k] = end > 0 ? fmax(-end, fmin(end, force)) : force;
            noise = t->keep * noise + sqrt(1 - t->keep * t->keep) * draw_noise(t, rng);
        }
    }
}

/* One specimen and session; false without memory. */
static bool attempt(truth *t, uint64_t turn, int kind, random_state *rng, bool *found) {
    solid plain;
    search h;
    draw_solid(t->lab, rng, &plain);
    lab_session(t->lab, rng, &t->session);
    draw_runs(t, rng);
    t->solid = plain;
    *found = kind == 0;
    if (*found)
        return true;
    secret what = draw_secret(t, &plain, kind, turn, rng);
    t->effect = what.effect;
    t->second = EFFECTS;
    t->outside = what.outside;
    if (!search_make(&h, t, &plain))
        return false;
    what.peak = h.peak;
    *found = hide_at_all(t, &h, &what, rng);
    if (*found && kind == 3) {
        what = draw_secret(t, &plain, kind, turn, rng);
        what.peak = h.peak;
        *found = hide_second(t, &h, &what, rng);
    }
    search_free(&h);
    return true;
}

bool truth_draw(truth *t, const lab *l, uint64_t seed, uint64_t stream, int kind) {
    random_state rng = random_make(seed, stream);
    bool found = false;
    memset(t, 0, sizeof *t);
    t->lab = l;
    t->effect = t->second = EFFECTS;
    t->white = l->noise * l->force;
    t->step = l->kind == QUANTIZED ? 3 * t->white : 0;
    t->keep = l->kind == CORRELATED ? 0.8 : 0;
    for (uint64_t i = 0; i < 60 && !found; i++)
        if (!attempt(t, stream + i / 4, kind, &rng, &found))
            return false;
    t->force = found ? malloc(t->session.n * sizeof *t->force) : NULL;
    if (t->force)
        record(t, &rng);
    return t->force != NULL;
}

void truth_free(truth *t) {
    free(t->force);
}
