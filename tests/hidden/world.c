/* world.c: the true indenter and specimen. Small steps: arms by the implicit midpoint rule, the springpot by
 * its history sum, pore pressure by finite volumes. In every step contact and frame are solved for the
 * surface. */
#include "hidden.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CELLS = 40, BLOCK = 32 };

static const double pi = 3.14159265358979323846;

/* Pore pressure in a column that drains at one end; cells grow away from it. */
typedef struct pores {
    double size[CELLS], left[CELLS], right[CELLS]; /* exchange with the neighbours in half a step */
    double pivot[CELLS], ratio[CELLS];             /* the implicit step's factors */
    double pressure[CELLS], next[CELLS], unit[CELLS];
    double next_mean, unit_mean;
} pores;

/* The springpot's memory: strain rates of the sample intervals, and their weights at every phase of a sample.
 */
typedef struct memory {
    double *rate, *weight;
    bool *busy; /* a block of rates that are not all zero */
    size_t n, done;
    double start, past; /* strain at the last sample; force of the complete intervals */
} memory;

typedef struct sim {
    const world *w;
    const run *r;
    double dt, h, step; /* step: of the one being solved, 0 = an instant */
    size_t sub, phase, knot;
    double base, factor, adhesion, arm_force[ARMS + 1];
    size_t n_arms;
    arm arms[ARMS + 1];
    bool dependent;                        /* the arms, on strain */
    double keep[ARMS + 1], take[ARMS + 1]; /* where they are not: of the force, of the rise */
    double strain, most, energy;           /* most: the largest strain so far; energy: likewise */
    bool touching;
    double force;
    pores pores;
    memory memory;
    foreign_state foreign;
    cube cube;
} sim;

/* ---- pores ---- */

static void pores_make(pores *p, double time, double h) {
    double c = 4 / (pi * pi * time), growth = 1.08, sum = 0;
    for (int i = 0; i < CELLS; i++)
        sum += p->size[i] = i == 0 ? 1 : p->size[i - 1] * growth;
    for (int i = 0; i < CELLS; i++)
        p->size[i] /= sum;
    for (int i = 0; i < CELLS; i++) {
        double before = i == 0 ? 0 : p->size[i - 1], after = i + 1 == CELLS ? 0 : p->size[i + 1];
        p->left[i] = h * c / (before + p->size[i]) / p->size[i];
        p->right[i] = i + 1 == CELLS ? 0 : h * c / (after + p->size[i]) / p->size[i];
    }
    for (int i = 0; i < CELLS; i++) {
        p->pivot[i] = 1 / (1 + p->left[i] + p->right[i] - (i == 0 ? 0 : p->left[i] * p->ratio[i - 1]));
        p->ratio[i] = p->right[i] * p->pivot[i];
    }
}

static double pores_solve(const pores *p, double *x) {
    x[0] *= p->pivot[0];
    for (int i = 1; i < CELLS; i++)
        x[i] = (x[i] + p->left[i] * x[i - 1]) * p->pivot[i];
    double mean = x[CELLS - 1] * p->size[CELLS - 1];
    for (int i = CELLS - 1; i-- > 0;) {
        x[i] += p->ratio[i] * x[i + 1];
        mean += x[i] * p->size[i];
    }
    return mean;
}

/* What would be left of the pressure after the step without strain. */
static void pores_drain(pores *p) {
    for (int i = 0; i < CELLS; i++) {
        double below = i == 0 ? 0 : p->pressure[i - 1], above = i + 1 == CELLS ? 0 : p->pressure[i + 1];
        p->next[i] =
            p->pressure[i] + p->left[i] * (below - p->pressure[i]) + p->right[i] * (above - p->pressure[i]);
    }
    p->next_mean = pores_solve(p, p->next);
}

static void pores_begin(pores *p, double time, double h) {
    pores_make(p, time, h);
    for (int i = 0; i < CELLS; i++)
        p->unit[i] = 1;
    p->unit_mean = pores_solve(p, p->unit);
}

/* ---- springpot ---- */

static bool memory_begin(memory *m, double exponent, size_t n, size_t sub, double dt) {
    memset(m, 0, sizeof *m);
    m->n = n;
    m->rate = calloc(n + BLOCK, sizeof *m->rate);
    m->busy = calloc(n / BLOCK + 1, sizeof *m->busy);
    m->weight = malloc(n * sub * sizeof *m->weight);
    if (!m->rate || !m->busy || !m->weight)
        return false;
    for (size_t phase = 1; phase <= sub; phase++) {
        double *weight = m->weight + (phase - 1) * n, offset = (double)phase / (double)sub - 1;
        double last = pow(offset * dt, 1 - exponent);
        for (size_t k = 0; k < n; k++) { /* newest interval last: forward through both arrays */
            double next = pow(((double)k + 1 + offset) * dt, 1 - exponent);
            weight[n - 1 - k] = next - last;
            last = next;
        }
    }
    return true;
}

static void memory_end(memory *m) {
    free(m->rate);
    free(m->busy);
    free(m->weight);
}

/* Sum over the complete intervals at this phase of the current one; its own weight is offset 0. */
static double memory_sum(const memory *m, size_t phase) {
    const double *weight = m->weight + phase * m->n + (m->n - 1 - m->done);
    double sum = 0;
    for (size_t b = 0; b * BLOCK < m->done; b++) {
        if (!m->busy[b])
            continue;
        size_t end = (b + 1) * BLOCK < m->done ? (b + 1) * BLOCK : m->done;
        for (size_t i = b * BLOCK; i < end; i++)
            sum += m->rate[i] * weight[i];
    }
    return sum;
}

static void memory_add(memory *m, double strain, double dt) {
    m->rate[m->done] = (strain - m->start) / dt;
    if (m->rate[m->done] != 0)
        m->busy[m->done / BLOCK] = true;
    m->done++;
    m->start = strain;
}

/* ---- the specimen ---- */

static double law_stiffness(const world *w, double e) {
    double k = w->law[LAW - 1], a = fabs(e);
    for (int i = LAW - 1; i-- > 0;)
        k = k * a + w->law[i];
    return k;
}

static double law_energy(const world *w, double e) {
    double u = w->law[LAW - 1] / (LAW + 1), a = fabs(e);
    for (int i = LAW - 1; i-- > 0;)
        u = u * a + w->law[i] / (i + 2);
    return u * a * a;
}

/* The strain that the law sees. */
static double set_strain(const sim *s, double e) {
    double share = s->w->value[PERMANENT_SET][0];
    return share == 0 ? e : fmax(0, (e - share * fmax(s->most, e)) / (1 - share));
}

static double elastic(const sim *s, double e) {
    const double *damage = s->w->value[DAMAGE_SOFTENING];
    double seen = set_strain(s, e), force = law_stiffness(s->w, seen) * seen;
    if (s->w->value[RATE_STIFFENING][0] != 0 && s->step > 0)
        force *= 1 + s->w->value[RATE_STIFFENING][0] * log10(1 + fabs(e - s->strain) / s->step / 0.01);
    if (damage[0] != 0) {
        double energy = law_energy(s->w, seen), most = fmax(s->energy, energy);
        force *= most > 0 ? 1 - damage[0] * erf((most - energy) / (damage[1] * most)) : 1;
    }
    return force;
}

static double arm_force(const sim *s, size_t j, double e) {
    if (!s->dependent && s->step > 0)
        return s->keep[j] * s->arm_force[j] + s->take[j] * (e - s->strain);
    const double *by = s->w->value[STRAIN_DEPENDENT_ARM];
    double middle = 0.5 * fabs(e + s->strain), stiffness = s->arms[j].stiffness * (1 + by[0] * middle);
    double x = 0.5 * s->step / (s->arms[j].time * (1 + by[1] * middle));
    return (s->arm_force[j] * (1 - x) + stiffness * (e - s->strain)) / (1 + x);
}

static void arms_begin(sim *s) {
    const world *w = s->w;
    const double *extra = w->value[RELAXATION_ARM], *by = w->value[STRAIN_DEPENDENT_ARM];
    s->dependent = by[0] != 0 || by[1] != 0;
    for (size_t j = 0; j < w->n_arms; j++)
        s->arms[s->n_arms++] = w->arms[j];
    if (extra[0] != 0)
        s->arms[s->n_arms++] = (arm){extra[0], extra[1]};
    for (size_t j = 0; j < s->n_arms; j++) {
        double x = 0.5 * s->h / s->arms[j].time;
        s->keep[j] = (1 - x) / (1 + x);
        s->take[j] = s->arms[j].stiffness / (1 + x);
    }
}

static double springpot(const sim *s, double e) {
    const double *pot = s->w->value[POWER_LAW_RELAXATION];
    if (pot[0] == 0 || s->step == 0)
        return 0;
    double since = s->dt * (double)(s->phase + 1) / (double)s->sub;
    double now = (e - s->memory.start) / since * pow(since, 1 - pot[1]);
    return pot[0] / tgamma(2 - pot[1]) * (s->memory.past + now);
}

static double pore_force(const sim *s, double e) {
    double stiffness = s->w->value[POROELASTIC][0];
    if (stiffness == 0)
        return 0;
    if (s->step == 0)
        return stiffness * (e - s->strain);
    return stiffness * (s->pores.next_mean + s->pores.unit_mean * (e - s->strain));
}

/* Force of the specimen if its surface were at strain e at the end of the step. */
static double specimen(const sim *s, double e) {
    cube end;
    if (s->w->cube)
        return s->factor * cube_press(s->w, &s->cube, s->step, e, &end);
    double force = elastic(s, e);
    for (size_t j = 0; j < s->n_arms; j++)
        force += arm_force(s, j, e);
    return s->factor * (force + springpot(s, e) + pore_force(s, e));
}

/* Takes e, where the specimen's force is force, as the end of the step. */
static void settle(sim *s, double e, double force) {
    double rise = e - s->strain;
    double q[ARMS + 1];
    s->force = force;
    if (s->w->cube) {
        cube start = s->cube;
        cube_press(s->w, &start, s->step, e, &s->cube);
    }
    for (size_t j = 0; j < s->n_arms; j++)
        q[j] = arm_force(s, j, e);
    memcpy(s->arm_force, q, sizeof q);
    if (s->w->value[POROELASTIC][0] != 0) {
        for (int i = 0; i < CELLS; i++)
            s->pores.pressure[i] = s->step == 0 ? rise : s->pores.next[i] + s->pores.unit[i] * rise;
    }
    s->most = fmax(s->most, e);
    if (s->w->value[DAMAGE_SOFTENING][0] != 0)
        s->energy = fmax(s->energy, law_energy(s->w, set_strain(s, e)));
    s->strain = e;
}

/* ---- contact and frame ---- */

/* Strain of a surface that the plate holds at x. */
static double held(const world *w, double x) {
    double toe = w->value[TOE_REGION][0];
    return (toe > 0 && x > 0 ? x + toe * expm1(-x / toe) : x) / w->height;
}

/* Zero where the surface is in equilibrium: free, or held by a plate whose drive stands at x. */
static double mismatch(const sim *s, bool free_surface, double x, double e) {
    double force = specimen(s, e);
    return free_surface ? force : e - held(s->w, x - s->w->value[FRAME_COMPLIANCE][0] * force);
}

static double bisect(const sim *s, bool free_surface, double x) {
    double low = s->strain - 1, high = s->strain + 1;
    for (int i = 0; i < 80; i++) {
        double middle = 0.5 * (low + high);
        if (mismatch(s, free_surface, x, middle) > 0)
            high = middle;
        else
            low = middle;
    }
    return 0.5 * (low + high);
}

static double equilibrium(const sim *s, bool free_surface, double x) {
    double a = s->strain, fa = mismatch(s, free_surface, x, a), b = a + 1e-6;
    for (int i = 0; i < 40; i++) {
        double fb = mismatch(s, free_surface, x, b), slope = (fb - fa) / (b - a);
        if (fa == 0)
            return a;
        double next = b - fb / slope;
        if (!(slope > 0) || fabs(next - s->strain) > 0.5)
            break;
        if (fabs(next - b) < 1e-13)
            return next;
        a = b, fa = fb, b = next;
    }
    return bisect(s, free_surface, x);
}

static double pressed(const sim *s, double x) {
    return s->w->value[FRAME_COMPLIANCE][0] == 0 ? held(s->w, x) : equilibrium(s, false, x);
}

/* One step to the drive's depth d. */
static void advance(sim *s, double d) {
    double shift = s->w->value[CONTACT_OFFSET][0], x = foreign_depth(s->w, d, &s->foreign) - shift;
    double e = s->touching ? pressed(s, x) : 0, force = s->touching ? specimen(s, e) : 0;
    if (force < -s->adhesion)
        s->touching = false;
    if (!s->touching) {
        e = equilibrium(s, true, 0);
        s->touching = held(s->w, x) >= e;
        e = s->touching ? pressed(s, x) : e;
        force = s->touching ? specimen(s, e) : 0;
    }
    settle(s, e, force);
}

/* ---- the instrument ---- */

typedef struct chain {
    double lagged, before; /* the sensor's output and input */
} chain;

static double sensor_input(sim *s, double t, double d, double v, double a) {
    const world *w = s->w;
    const double *ripple = w->value[DRIVE_RIPPLE];
    double force = s->touching ? s->force + foreign_contact(w, d, v) : 0;
    force *= 1 + w->value[SENSOR_GAIN][0];
    force = foreign_record(w, s->r->session + t, d, v, force, &s->foreign);
    force += w->value[COULOMB_FRICTION][0] * v / (fabs(v) + 1e-5);
    force += w->value[PLATE_INERTIA][0] * a;
    return force + (ripple[0] == 0 ? 0 : ripple[0] * sin(2 * pi * d / ripple[1] + ripple[2]));
}

static void sensor_step(const sim *s, chain *c, double input) {
    double time = s->w->value[SENSOR_LAG][0], x = 0.5 * s->h / time;
    c->lagged = time == 0 ? input : (c->lagged * (1 - x) + x * (c->before + input)) / (1 + x);
    c->before = input;
}

static double recorded(const sim *s, const chain *c, double t, double noise) {
    const world *w = s->w;
    double limit = w->value[FORCE_SATURATION][0], hum = w->value[MAINS_HUM][0];
    double force = c->lagged + w->value[SENSOR_BIAS][0] + w->value[SENSOR_DRIFT][0] * t;
    if (hum != 0)
        force += hum * sin(2 * pi * w->value[MAINS_HUM][1] * t + s->r->hum_phase);
    force = foreign_convert(w, force + noise);
    return limit > 0 ? fmax(-limit, fmin(limit, force)) : force;
}

static bool begin(sim *s, const world *w, const run *r, double h, bool real) {
    memset(s, 0, sizeof *s);
    s->w = w;
    s->r = r;
    s->dt = 1 / r->Hz;
    s->sub = (size_t)ceil(s->dt / h);
    s->h = s->dt / (double)s->sub;
    s->factor = s->base = (1 + w->value[SESSION_AGEING][0] * r->session) * (real ? 1 + r->gain : 1);
    s->adhesion = w->value[ADHESION][0];
    arms_begin(s);
    foreign_begin(w, r, &s->foreign);
    if (w->value[POROELASTIC][0] != 0)
        pores_begin(&s->pores, w->value[POROELASTIC][1], s->h);
    return w->value[POWER_LAW_RELAXATION][0] == 0 ||
           memory_begin(&s->memory, w->value[POWER_LAW_RELAXATION][1], r->n, s->sub, s->dt);
}

/* From sample i - 1 to i. */
static void sample_step(sim *s, chain *c, size_t i, double shift) {
    double d, v, a;
    for (s->phase = 0; s->phase < s->sub; s->phase++) {
        double t = ((double)(i - 1) + (double)(s->phase + 1) / (double)s->sub) * s->dt;
        path_at(s->r, t, &s->knot, &d, &v, &a);
        if (s->memory.n)
            s->memory.past = memory_sum(&s->memory, s->phase);
        if (s->w->value[POROELASTIC][0] != 0)
            pores_drain(&s->pores);
        s->factor = s->base * foreign_factor(s->w, s->r->session + t);
        advance(s, d - shift);
        sensor_step(s, c, sensor_input(s, t, d, v, a));
    }
    if (s->memory.n)
        memory_add(&s->memory, s->strain, s->dt);
}

/* A specimen that has set lies lower, at rest. */
static void put_on(sim *s, const wear *kept) {
    s->most = kept->most;
    s->energy = kept->energy;
    s->strain = s->w->value[PERMANENT_SET][0] * kept->most;
}

void world_run(const world *w, const run *r, double h, bool real, const double *noise, wear *kept,
               double *force) {
    sim *s = malloc(sizeof *s);
    if (!s || !begin(s, w, r, h, real))
        abort();
    if (kept)
        put_on(s, kept);
    double d, v, a, shift = real ? r->shift : 0;
    chain c;
    path_at(r, 0, &s->knot, &d, &v, &a);
    advance(s, d - shift); /* at once */
    s->memory.start = s->strain;
    s->step = s->h;
    c.lagged = c.before = sensor_input(s, 0, d, v, a);
    force[0] = recorded(s, &c, 0, noise ? noise[0] : 0);
    for (size_t i = 1; i < r->n; i++) {
        sample_step(s, &c, i, shift);
        force[i] = recorded(s, &c, (double)i * s->dt, noise ? noise[i] : 0);
    }
    if (kept)
        *kept = (wear){s->most, s->energy};
    memory_end(&s->memory);
    free(s);
}

void world_session(const world *w, const session *s, double h, bool real, const double *noise,
                   double *force) {
    wear kept = {0, 0};
    for (size_t i = 0; i < s->n_runs; i++) {
        const run *r = &s->run[i];
        world_run(w, r, h, real, noise ? noise + r->first : NULL, s->lasting ? &kept : NULL,
                  force + r->first);
    }
}
