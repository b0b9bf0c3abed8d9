/* worlds.h: laboratories that are not ours: what is true of a case, its specimen and its tester. SI units.
 * Nothing here comes from the library; names, keys and units of effects (kinds.c), paths and random numbers
 * are those of ../hidden.h. */
#ifndef WORLDS_H
#define WORLDS_H

#include "../hidden.h"

enum { HATS = 12, TIMES = 4, SPECTRUM = 10, SOLID_ARMS = SPECTRUM + TIMES + 1 };

/* ---- what is pressed (solid.c) ---- */
enum law_kind { QUADRATIC, FUNG, PIECEWISE, HERTZ };

/* What no row of the catalogue describes (outside.c). */
enum outside_id {
    NO_OUTSIDE,
    WAVE,
    WARM_UP,
    SLIP,
    WALK,
    JUMP,
    ROOM,
    OUTSIDES,             /* of the sets all and testers; those of the set outside, which come again: */
    LOAD_CELL = OUTSIDES, /* its force lags behind itself (hysteresis) */
    PLAY,                 /* the plate moves only after a part of the way back */
    CURING,               /* the specimen grows stiffer in a run */
    POSITION,             /* the gain depends on the position */
    GRIP,                 /* the specimen gives way for good beyond a force, anew in each run */
    RINGING,              /* the frame rings after each corner */
    EACH_WARM_UP,         /* the zero of each run settles alike */
    SLOW_ROOM,            /* the zero follows the room over the session */
    DAMPER,               /* of the power 0.4 of the speed */
    WALL,                 /* a wall beside the specimen rubs from a depth on */
    ALL_OUTSIDES
};

struct lab;
typedef struct solid {
    const struct lab *lab; /* whose tester presses it; NULL: an exact one */
    bool force_driven;     /* the arms follow the spring's force, not the strain (quasi-linear) */
    double height, top;    /* top: strain of the laboratory's full travel */
    enum law_kind law;
    double size, shape,
        hat[HATS]; /* spring's force at top; exponent, or place of the knee; added force at the hats */
    size_t n_arms;
    arm arms[SOLID_ARMS];
    double effect[EFFECTS][VALUES]; /* as the catalogue has them, in SI; the first 0 = off */
    enum outside_id outside;
    double outside_size, outside_place; /* place: within its run or runs, 0 to 1 */
    size_t outside_run;
    uint64_t seed; /* of what wanders */
} solid;

double solid_spring(const solid *s, double e); /* force of the law at strain e */
double solid_energy(const solid *s, double e); /* its integral over e */
/* What the tester would record of run r without noise, in force[r->n]; r->shift, r->gain: contact and
 * stiffness of this run. */
void solid_press(const solid *s, const run *r, size_t number, double *force);
/* Adds what is outside the catalogue to the force; before: of the specimen, at the force itself (SLIP). */
double outside_factor(const solid *s, const run *r, size_t number, double t);
void outside_add(const solid *s, const run *r, size_t number, double *force);
/* What remembers the path: where the plate is where the recorded depth is d; and, after the specimen's force,
 * what the sensor reads. memory: {0} at a run's start. */
typedef struct outside_memory {
    double plate, force, lag, most, swing, speed;
} outside_memory;
double outside_depth(const solid *s, outside_memory *memory, double d);
double outside_force(const solid *s, const run *r, outside_memory *memory, double t, double h,
                     const double motion[3], double force);

/* ---- who presses it (lab.c) ---- */
enum noise_kind { GAUSS, STUDENT, CORRELATED, QUANTIZED };
enum protocol_kind { RICH, ONE_RUN, ONE_SPEED, NO_UNLOADING, SINES, TRIANGLES, TO_FORCE, BY_HAND };
/* Motions of the plate in addition to its way: EXACT nothing; RINGS overshoots at each corner; STEPS goes in
 * small steps. */
enum tester_kind { EXACT, RINGS, STEPS };
enum spectrum_kind { FEW_ARMS, FORCE_DRIVEN, FRACTIONAL };
enum header_kind { FULL, HEIGHT, THREE };

typedef struct lab {
    const char *name, *about;
    double Hz, height, force, strain; /* of the full travel */
    double noise, scatter, differ;    /* of the full force, of the travel, of the stiffness */
    enum noise_kind kind;
    enum law_kind law;
    enum protocol_kind protocol;
    enum header_kind header;
    /* Of the other testers (set testers) only: */
    bool other;
    enum tester_kind tester;
    enum spectrum_kind spectrum;
    double depth_noise, jitter; /* of the recorded depth, of the travel; of the clock, of a sample's time */
    double fast;                /* so many times as fast in samples; 0 = 1 */
} lab;
enum { LABS = 20 };
extern const lab laboratories[LABS];
void lab_session(const lab *l, random_state *rng, session *s);
double lab_travel(const lab *l);
/* Where the plate is; l may be NULL. Arguments of path_at. */
void lab_path(const lab *l, const run *r, double t, size_t *hint, double *d, double *v, double *a);
/* What the tester writes down as the depth at time t. */
double lab_depth(const lab *l, const run *r, double t, size_t *hint, random_state *rng);
/* When sample i is taken, with the clock's jitter. */
double lab_time(const lab *l, const run *r, size_t number, size_t i);

/* ---- a case (draw.c, evidence.c, files.c) ---- */
typedef struct truth {
    const lab *lab;
    char name[32];
    int effect; /* EFFECTS: none */
    enum outside_id outside;
    solid solid;
    session session;
    double white, step, keep;         /* noise: sd, quantum of the force, correlation from sample to sample */
    double zero[RUNS];                /* of each run */
    double evidence, cosine[EFFECTS]; /* nats of what is hidden; how alike each effect is to it */
    int second;                       /* of a pair; EFFECTS: none */
    double second_evidence, second_cosine[EFFECTS];
    double *force; /* as recorded */
} truth;

/* false without memory. kind: 0 a null, 1 an effect, 2 outside the catalogue, 3 a pair of effects, 4 outside
 * the catalogue and in all runs. */
bool truth_draw(truth *t, const lab *l, uint64_t seed, uint64_t stream, int kind);
void truth_free(truth *t);
bool truth_files(const truth *t, const char *folder);
void truth_line(FILE *f, const truth *t); /* JSON */

/* What the richest plain model of these data can do; an effect must show in spite of it. */
typedef struct nuisance {
    const truth *truth;
    size_t n, n_columns;
    double *column; /* [n_columns][n], whitened, orthonormal */
} nuisance;
bool nuisance_make(nuisance *u, const truth *t, const solid *plain);
void nuisance_free(nuisance *u);
/* Whitens the difference of the forces with and without, takes off what the nuisance columns do. Half of what
 * chi2 falls by. */
double nuisance_left(const nuisance *u, const double *with, const double *without, double *left);

/* Tries effects in addition to a plain solid. */
typedef struct search {
    solid plain;
    nuisance beside;
    double *force, *with, *left,
        peak; /* of the plain solid, of the other, of the residual; the largest force */
} search;
bool search_make(search *h, const truth *t, const solid *plain);
void search_free(search *h);
double search_evidence(search *h, const solid *s, size_t n_parameters);
bool evidence_classes(search *h, const solid *hidden,
                      double cosine[EFFECTS]); /* its likeness to each effect */

void session_press(const solid *s, const session *runs, double *force);
/* The effect at strength s (0 to 1) and of a shape that was drawn; peak: largest force without it. */
void effect_put(const truth *t, solid *s, int id, double strength, const double shape[VALUES], double peak);
void effect_shape(const truth *t, const solid *s, int id, random_state *rng, double shape[VALUES]);
bool effect_possible(const lab *l, int id);

int worlds_self_test(void);

#endif
