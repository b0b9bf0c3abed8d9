/* evidence.c: how much the recordings say for what is hidden: half of the fall of chi2 by it, conditional on
 * the richest plain model of the data: a free law (hats), its arms and more of them, a contact, a zero and a
 * gain of each run's own. */
#include "worlds.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* In noise sd, without the correlation from sample to sample. */
static void whiten(const truth *t, double *v) {
    double sd = sqrt(t->white * t->white + t->step * t->step / 12), rest = sd * sqrt(1 - t->keep * t->keep);
    for (size_t i = 0; i < t->session.n_runs; i++) {
        double *own = v + t->session.run[i].first;
        for (size_t k = t->session.run[i].n; k-- > 1;)
            own[k] = (own[k] - t->keep * own[k - 1]) / rest;
        own[0] /= sd;
    }
}

static double dot(size_t n, const double *a, const double *b) {
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

static void project(const nuisance *u, double *v) {
    for (size_t k = 0; k < u->n_columns; k++) {
        const double *column = u->column + k * u->n;
        double share = dot(u->n, column, v);
        for (size_t i = 0; i < u->n; i++)
            v[i] -= share * column[i];
    }
}

/* The next column: whitened, orthogonal to those before; dropped where they can do it all. */
static void append(nuisance *u) {
    double *v = u->column + u->n_columns * u->n;
    whiten(u->truth, v);
    double whole = sqrt(dot(u->n, v, v));
    project(u, v);
    project(u, v);
    double length = sqrt(dot(u->n, v, v));
    if (length < 1e-6 * whole || whole == 0)
        return;
    for (size_t i = 0; i < u->n; i++)
        v[i] /= length;
    u->n_columns++;
}

/* The change of the forces from the solid before to the one after. */
static void append_change(nuisance *u, const double *before, const solid *after) {
    double *v = u->column + u->n_columns * u->n;
    session_press(after, &u->truth->session, v);
    for (size_t i = 0; i < u->n; i++)
        v[i] -= before[i];
    append(u);
}

static void append_law(nuisance *u, const solid *plain, const double *force) {
    for (int k = 0; k < HATS; k++) {
        solid s = *plain;
        s.hat[k] += 1e-3 * s.size;
        append_change(u, force, &s);
    }
}

/* More arms than there are, but where one is what is hidden. */
static void append_arms(nuisance *u, const solid *plain, const double *force) {
    const lab *l = u->truth->lab;
    for (size_t j = 0; j < plain->n_arms; j++) {
        solid stiffer = *plain, slower = *plain;
        stiffer.arms[j].stiffness *= 1.01;
        slower.arms[j].time *= 1.01;
        append_change(u, force, &stiffer);
        append_change(u, force, &slower);
    }
    for (int k = 0; k < TIMES && u->truth->effect != RELAXATION_ARM; k++) {
        solid more = *plain;
        more.arms[more.n_arms++] = (arm){0.01 * plain->size / plain->top, 4 * pow(5, k) / l->Hz};
        append_change(u, force, &more);
    }
}

/* A run's own contact, zero and gain. */
static void append_run(nuisance *u, const run *r, const double *force, const double *moved) {
    for (int kind = 0; kind < 3; kind++) {
        double *v = u->column + u->n_columns * u->n;
        memset(v, 0, u->n * sizeof *v);
        for (size_t i = r->first; i < r->first + r->n; i++)
            v[i] = kind == 0 ? moved[i] - force[i] : kind == 1 ? u->truth->white : force[i];
        append(u);
    }
}

static bool columns_make(nuisance *u, const solid *plain, double *force, double *moved) {
    session shifted = u->truth->session;
    for (size_t i = 0; i < shifted.n_runs; i++)
        shifted.run[i].shift += 2e-3 * lab_travel(u->truth->lab);
    session_press(plain, &u->truth->session, force);
    session_press(plain, &shifted, moved);
    append_law(u, plain, force);
    append_arms(u, plain, force);
    for (size_t i = 0; i < shifted.n_runs; i++)
        append_run(u, &shifted.run[i], force, moved);
    return true;
}

bool nuisance_make(nuisance *u, const truth *t, const solid *plain) {
    size_t most = HATS + 2 * SOLID_ARMS + TIMES + 3 * RUNS + 1;
    *u = (nuisance){.truth = t, .n = t->session.n};
    u->column = malloc(most * u->n * sizeof *u->column);
    double *space = malloc(2 * u->n * sizeof *space);
    bool good = u->column && space && columns_make(u, plain, space, space + u->n);
    free(space);
    return good;
}

void nuisance_free(nuisance *u) {
    free(u->column);
}

double nuisance_left(const nuisance *u, const double *with, const double *without, double *left) {
    for (size_t i = 0; i < u->n; i++)
        left[i] = with[i] - without[i];
    whiten(u->truth, left);
    project(u, left);
    return 0.5 * dot(u->n, left, left);
}

static double largest(size_t n, const double *v) {
    double most = 0;
    for (size_t i = 0; i < n; i++)
        most = fmax(most, fabs(v[i]));
    return most;
}

bool search_make(search *h, const truth *t, const solid *plain) {
    *h = (search){.plain = *plain};
    h->force = malloc(3 * t->session.n * sizeof *h->force);
    if (!h->force || !nuisance_make(&h->beside, t, plain)) {
        free(h->force);
        return false;
    }
    h->with = h->force + t->session.n;
    h->left = h->with + t->session.n;
    session_press(plain, &t->session, h->force);
    h->peak = largest(t->session.n, h->force);
    return true;
}

void search_free(search *h) {
    nuisance_free(&h->beside);
    free(h->force);
}

/* Nats for s over the plain solid: half of chi2's fall less half the logarithm of the samples for each
 * parameter. */
double search_evidence(search *h, const solid *s, size_t n_parameters) {
    session_press(s, &h->beside.truth->session, h->with);
    return nuisance_left(&h->beside, h->with, h->force, h->left) -
           0.5 * (double)n_parameters * log((double)h->beside.n);
}

/* The largest cosine between the hidden effect (y) and the residual of the effect, over a few of its
 * shapes. */
static double cosine_with(search *h, int id, const double *y) {
    const truth *t = h->beside.truth;
    random_state rng = random_make(7, (uint64_t)id);
    double most = 0, shape[VALUES];
    int shapes = effect_kinds[id].n > 1 ? 6 : 1;
    for (int i = 0; i < shapes; i++) {
        solid s = h->plain;
        effect_shape(t, &s, id, &rng, shape);
        effect_put(t, &s, id, 0.2, shape, h->peak);
        search_evidence(h, &s, 0);
        double length = sqrt(dot(h->beside.n, h->left, h->left));
        if (length > 0.1)
            most = fmax(most, fabs(dot(h->beside.n, h->left, y)) / length);
    }
    return most;
}

bool evidence_classes(search *h, const solid *hidden, double cosine[EFFECTS]) {
    size_t n = h->beside.n;
    double *y = malloc(n * sizeof *y);
    if (!y)
        return false;
    search_evidence(h, hidden, 0);
    double length = sqrt(dot(n, h->left, h->left));
    for (size_t i = 0; i < n; i++)
        y[i] = length > 0 ? h->left[i] / length : 0;
    for (int id = 0; id < EFFECTS; id++)
        cosine[id] = effect_possible(h->beside.truth->lab, id) ? cosine_with(h, id, y) : 0;
    free(y);
    return true;
}
