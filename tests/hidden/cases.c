/* cases.c: draws a case: material, session, effects, noise. */
#include "hidden.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double mm = 1e-3, pi = 3.14159265358979323846;

enum { MATERIALS = 6, DRAWS = 200 };             /* tried for a single effect, and for what must be found */
static const double COARSE = 0.02, FINE = 0.006; /* steps, s: to judge, to write */

/* Stiffness grows 1 to 3 times up to a strain of 0.35. */
static void draw_law(world *w, random_state *rng) {
    double share[LAW], sum = 0, growth = random_uniform(rng, 0, 2);
    w->law[0] = random_log(rng, 2, 30);
    for (int i = 1; i < LAW; i++)
        sum += share[i] = -log(random_uniform(rng, 0, 1));
    for (int i = 1; i < LAW; i++)
        w->law[i] = w->law[0] * growth * share[i] / sum / pow(0.35, i);
}

/* simple: one arm, so that there is room for an effect that relaxes. */
static void draw_world(world *w, bool simple, random_state *rng) {
    memset(w, 0, sizeof *w);
    w->height = random_uniform(rng, 15, 30) * mm;
    w->radius = w->height * random_uniform(rng, 0.4, 0.8);
    draw_law(w, rng);
    w->n_arms = simple ? 1 : 1 + random_index(rng, 2);
    for (size_t i = 0; i < w->n_arms; i++)
        w->arms[i].stiffness = w->law[0] * random_uniform(rng, 0.15, 0.6);
    w->arms[0].time = w->n_arms == 1 ? random_log(rng, 0.3, 60) : random_log(rng, 0.3, 3);
    w->arms[1].time = random_log(rng, 15, 60);
}

static bool near_an_arm(const world *w, double time) {
    for (size_t i = 0; i < w->n_arms; i++)
        if (fabs(log(time / w->arms[i].time)) < log(4))
            return true;
    return false;
}

static void draw_shape(const world *w, int id, random_state *rng, double shape[VALUES]) {
    const effect_kind *kind = &effect_kinds[id];
    shape[0] = kind->either_sign ? random_sign(rng) : 1;
    for (size_t k = 1; k < kind->n; k++) {
        double low = kind->low[k], high = kind->high[k];
        do
            shape[k] = kind->logarithmic[k] ? random_log(rng, low, high) : random_uniform(rng, low, high);
        while (id == RELAXATION_ARM && near_an_arm(w, shape[k]));
    }
    if (id == MAINS_HUM && random_sign(rng) > 0)
        shape[1] += 10;
}

static void draw_foreign(world *w, enum foreign_id id, const session *s, random_state *rng) {
    const run *last = &s->run[s->n_runs - 1];
    w->foreign = id;
    w->foreign_seed = (uint64_t)(random_uniform(rng, 0, 1) * 1e15);
    w->foreign_shape[1] = random_uniform(rng, 0, 2 * pi);
    switch (w->foreign) {
    case THERMAL_CYCLE:
    case STIFFNESS_CYCLE:
        w->foreign_shape[0] = random_log(rng, 15, 120);
        break;
    case GAIN_MAP:
        w->foreign_shape[0] = random_log(rng, 1.5, 5) * mm;
        break;
    case SIDE_WALL:
        w->foreign_shape[0] = random_uniform(rng, 0.5, 0.85) * s->deepest;
        break;
    case MISPLACED:
        w->foreign_shape[0] = random_uniform(rng, 0.2, 0.4) * last->session;
        w->foreign_shape[1] = random_uniform(rng, 0.6, 0.8) * last->session;
        break;
    case CELL_HYSTERESIS:
        w->foreign_shape[0] = random_uniform(rng, 0.05, 0.3) * w->law[0] * 0.3;
        break;
    default:
        break;
    }
}

/* Repeatability, and what of the noise follows from the forces of this specimen. */
static void draw_noise(hidden_case *c, const judge *j, double *moved, random_state *rng) {
    double scatter = 3e-3 * mm, repeat = random_uniform(rng, 2e-3, 4e-3);
    session shifted = c->session;
    for (size_t i = 0; i < shifted.n_runs; i++) {
        c->session.run[i].shift = scatter * random_normal(rng);
        c->session.run[i].gain = repeat * random_normal(rng);
        shifted.run[i].shift = scatter;
        shifted.run[i].gain = 0;
    }
    world_session(j->plain, &shifted, j->h, true, NULL, moved);
    for (size_t i = 0; i < j->n; i++)
        moved[i] -= j->force[i];
    c->peak = j->peak;
    c->white = j->peak * random_uniform(rng, 4e-4, 12e-4);
    c->correlated = c->white * random_uniform(rng, 0.3, 0.7);
    c->correlation_time = random_log(rng, 0.2, 3);
    c->noise_level = sqrt(c->white * c->white + c->correlated * c->correlated +
                          pow(repeat * judge_rms(j, j->force), 2) + pow(judge_rms(j, moved), 2));
}

static size_t class_size(const double cosine[EFFECTS]) {
    size_t n = 0;
    for (int i = 0; i < EFFECTS; i++)
        n += cosine[i] > 0.9;
    return n;
}

static double target_of(const plan *p, random_state *rng) {
    static const double levels[] = {3, 10, 30};
    if (p->group == SINGLE)
        return levels[p->strength];
    if (p->group == SEED)
        return random_log(rng, 4, 12);
    return random_log(rng, 5, 20);
}

/* Adds the effect at target noise levels; false where that is out of reach. */
static bool add_effect(hidden_case *c, const judge *j, int id, double target, bool raw, random_state *rng) {
    hidden_effect *e = &c->effect[c->n_effects++];
    double shape[VALUES];
    world alone = *j->plain;
    draw_shape(j->plain, id, rng, shape);
    e->id = id;
    e->strength = target;
    e->seen = judge_strengthen(j, &alone, id, shape, target * c->noise_level, raw);
    memcpy(c->world.value[id], alone.value[id], sizeof alone.value[id]);
    return (raw ? e->seen.raw : e->seen.left) > 0.99 * target * c->noise_level;
}

/* The residual of the effect alone, in y; false where that is nothing. */
static bool leaves(const hidden_case *c, const judge *j, int id, double *y) {
    world alone = *j->plain;
    memcpy(alone.value[id], c->world.value[id], sizeof alone.value[id]);
    visible seen = judge_visible(j, &alone, y);
    judge_project(j, y);
    return seen.left > 1e-3 * seen.raw;
}

/* Which effects are alike to each of the case's, conditional on the plain model and the case's other
 * effect. */
static bool find_classes(hidden_case *c, const judge *j) {
    double *y = malloc(2 * j->n * sizeof *y), *also = y ? y + j->n : NULL;
    if (!y)
        return false;
    for (size_t i = 0; i < c->n_effects; i++) {
        hidden_effect *e = &c->effect[i];
        size_t n_also = c->n_effects == 2 && leaves(c, j, c->effect[1 - i].id, also);
        double length = n_also ? sqrt(judge_dot(j, also, also)) : 1;
        for (size_t k = 0; n_also && k < j->n; k++)
            also[k] /= length;
        if (leaves(c, j, e->id, y))
            judge_alike(j, y, n_also, also, e->cosine);
        e->cosine[e->id] = 1;
    }
    free(y);
    return true;
}

static bool add_foreign(hidden_case *c, const judge *j, double target, random_state *rng) {
    static const double shape[VALUES] = {1, 0, 0};
    double highest = 0, *y = malloc(j->n * sizeof *y);
    if (!y)
        return false;
    enum foreign_id id = (enum foreign_id)(1 + (c->plan.effect + c->tries / 6) % (FOREIGNERS - 1));
    draw_foreign(&c->world, id, &c->session, rng);
    c->foreign = judge_strengthen(j, &c->world, EFFECTS, shape, target * c->noise_level, false);
    judge_visible(j, &c->world, y);
    judge_alike(j, y, 0, NULL, c->foreign_cosine);
    for (int i = 0; i < EFFECTS; i++)
        highest = fmax(highest, c->foreign_cosine[i]);
    free(y);
    return highest < 0.7 && c->foreign.left > 4 * c->noise_level;
}

static const int seed_effects[] = {
    RELAXATION_ARM, POWER_LAW_RELAXATION, POROELASTIC, SENSOR_BIAS,
    CONTACT_OFFSET, STRAIN_DEPENDENT_ARM, TOE_REGION,
};

static int seed_effect(int i) {
    return seed_effects[(size_t)i % (sizeof seed_effects / sizeof *seed_effects)];
}

/* Two effects that are to be separated. */
static bool add_two(hidden_case *c, const judge *j, bool raw, random_state *rng) {
    int first = (int)random_index(rng, EFFECTS), second = (int)random_index(rng, EFFECTS);
    bool arms = (first == RELAXATION_ARM && second == STRAIN_DEPENDENT_ARM) ||
                (first == STRAIN_DEPENDENT_ARM && second == RELAXATION_ARM); /* of which arm? */
    if (first == second || first == SENSOR_GAIN || second == SENSOR_GAIN || arms)
        return false;
    bool reached = add_effect(c, j, first, target_of(&c->plan, rng), raw, rng) &&
                   add_effect(c, j, second, target_of(&c->plan, rng), raw, rng);
    return reached && find_classes(c, j) && c->effect[0].cosine[second] < 0.8 &&
           c->effect[1].cosine[first] < 0.8;
}

/* ---- particles for a lumped model ---- */

/* So that the springs alone are as stiff at rest as the lumped ones. */
static void cube_make(world *w) {
    world unit = {.cube = true, .law = {1}};
    cube rest = {.bulge = {0, 0}}, end;
    double small = 1e-6, as_many = cube_press(&unit, &rest, 0, small, &end) / small;
    for (int i = 0; i < LAW; i++)
        w->law[i] /= as_many;
    for (size_t i = 0; i < w->n_arms; i++)
        w->arms[i].stiffness /= as_many;
    w->cube = true;
}

/* To a strain that models are read up to. */
static bool law_positive(const world *w) {
    for (double e = 0; e < 0.41; e += 0.01)
        if (w->law[0] + e * (w->law[1] + e * (w->law[2] + e * (w->law[3] + e * w->law[4]))) <= 0)
            return false;
    return true;
}

/* A cube of such a material, and the lumped model that comes nearest to it; false if that is none, or not
 * found. */
static bool draw_cube(world *network, world *plain, const session *s, enum network_kind kind,
                      random_state *rng) {
    for (size_t i = 0; i < plain->n_arms && kind == BENT; i++)
        plain->arms[i].stiffness *= random_uniform(rng, 2, 5);
    *network = *plain;
    cube_make(network);
    double before = INFINITY;
    for (int i = 0; i < 8; i++) {
        judge j;
        world near = *plain;
        if (!judge_make(&j, &near, s, COARSE))
            return false;
        double left = judge_fit(&j, network, plain);
        judge_free(&j);
        if (left > 0.99 * before)
            return law_positive(plain);
        before = left;
    }
    return false;
}

/* The residual of the geometry, and the effects like it. Above a strain of 0.32 some cubes buckle, which
 * their symmetry would hide. */
static bool find_geometry(hidden_case *c, const judge *j, enum network_kind kind) {
    double highest = 0, *y = malloc(j->n * sizeof *y);
    if (!y)
        return false;
    c->foreign = judge_visible(j, &c->world, y);
    bool wanted = (kind == BENT ? c->foreign.left > 3 * c->noise_level : c->foreign.left < c->noise_level) &&
                  c->session.deepest < 0.32 * c->world.height;
    if (wanted)
        judge_alike(j, y, 0, NULL, c->foreign_cosine);
    for (int i = 0; i < EFFECTS && wanted; i++)
        highest = fmax(highest, c->foreign_cosine[i]);
    free(y);
    wanted = wanted && (kind != BENT || highest > 0.9);
    if (wanted)
        c->foreign_cosine[FRAME_COMPLIANCE] = judge_frame(j, &c->world, c->foreign.left);
    return wanted;
}

/* c->world is the cube. The effect is measured with the lumped model, and acts on the cube. */
static bool add_network(hidden_case *c, const judge *j, bool raw, random_state *rng) {
    static const int ids[] = {CONTACT_OFFSET, TOE_REGION,       ADHESION,   SESSION_AGEING,
                              PLATE_INERTIA,  COULOMB_FRICTION, SENSOR_LAG, SENSOR_BIAS,
                              SENSOR_DRIFT,   FORCE_SATURATION, MAINS_HUM,  DRIVE_RIPPLE};
    enum network_kind kind = (enum network_kind)c->plan.effect;
    if (!find_geometry(c, j, kind))
        return false;
    return kind != FAULTY || (add_effect(c, j, ids[random_index(rng, sizeof ids / sizeof *ids)],
                                         target_of(&c->plan, rng), raw, rng) &&
                              find_classes(c, j));
}

/* Some materials hide an effect from the experiment; one that all do is measured as it is. */
static bool add_single(hidden_case *c, const judge *j, bool raw, random_state *rng) {
    bool hidden =
        c->plan.effect == SENSOR_GAIN || c->plan.effect == FRAME_COMPLIANCE || c->tries == MATERIALS;
    return add_effect(c, j, c->plan.effect, target_of(&c->plan, rng), raw || hidden, rng) &&
           find_classes(c, j);
}

static bool add_seed(hidden_case *c, const judge *j, bool raw, random_state *rng) {
    int id = seed_effect(c->plan.effect + c->tries / 12);
    bool reached = add_effect(c, j, id, target_of(&c->plan, rng), raw, rng);
    return (reached || c->effect[0].seen.left > 3 * c->noise_level) && find_classes(c, j) &&
           class_size(c->effect[0].cosine) > 1;
}

static bool add_effects(hidden_case *c, const judge *j, bool raw, random_state *rng) {
    switch (c->plan.group) {
    case SINGLE:
        return add_single(c, j, raw, rng);
    case SEED:
        return add_seed(c, j, raw, rng);
    case TWO:
        return add_two(c, j, raw, rng);
    case OUTSIDE:
        return add_foreign(c, j, target_of(&c->plan, rng), rng);
    case NETWORK:
        return add_network(c, j, raw, rng);
    default:
        return true;
    }
}

static void make_noise(const hidden_case *c, random_state *rng, double *noise) {
    for (size_t i = 0; i < c->session.n_runs; i++) {
        const run *r = &c->session.run[i];
        double keep = exp(-1 / (r->Hz * c->correlation_time)), wander = c->correlated * random_normal(rng);
        for (size_t k = r->first; k < r->first + r->n; k++) {
            noise[k] = wander + c->white * random_normal(rng);
            wander = keep * wander + sqrt(1 - keep * keep) * c->correlated * random_normal(rng);
        }
    }
}

/* One material and session, in which the planned effects may turn out to be too weak. */
static bool attempt(hidden_case *c, bool raw, random_state *rng, bool *found) {
    judge j;
    bool relaxes = c->plan.effect == RELAXATION_ARM || c->plan.effect == POWER_LAW_RELAXATION ||
                   c->plan.effect == POROELASTIC;
    draw_world(&c->plain, c->plan.group == SINGLE && relaxes && c->tries < MATERIALS - 2, rng);
    if (c->plan.group == SEED)
        session_seed(&c->session, rng, c->plain.height);
    else
        session_rich(&c->session, rng, c->plain.height, c->plan.fineness);
    c->session.lasting = c->plan.lasting;
    c->n_effects = 0;
    c->tries++;
    c->world = c->plain;
    *found = c->plan.group != NETWORK ||
             draw_cube(&c->world, &c->plain, &c->session, (enum network_kind)c->plan.effect, rng);
    if (!*found)
        return true;
    if (!judge_make(&j, &c->plain, &c->session, COARSE))
        return false;
    double *scratch = malloc(j.n * sizeof *scratch);
    if (!scratch)
        return false;
    draw_noise(c, &j, scratch, rng);
    free(scratch);
    *found = add_effects(c, &j, raw, rng);
    judge_free(&j);
    return true;
}

bool case_make(hidden_case *c, uint64_t seed, size_t number, plan p, bool raw) {
    random_state rng = random_make(seed, number);
    bool found = false;
    memset(c, 0, sizeof *c);
    c->plan = p;
    for (int i = 0; i < (p.group == SINGLE ? MATERIALS : DRAWS) && !found; i++)
        if (!attempt(c, raw, &rng, &found))
            return false;
    if (!found && p.group != SINGLE)
        return false;
    double *noise = malloc(c->session.n * sizeof *noise);
    c->force = malloc(c->session.n * sizeof *c->force);
    if (noise && c->force) {
        make_noise(c, &rng, noise);
        world_session(&c->world, &c->session, FINE, true, noise, c->force);
    }
    c->left_over = rng;
    free(noise);
    return noise && c->force;
}

void case_free(hidden_case *c) {
    free(c->force);
}
