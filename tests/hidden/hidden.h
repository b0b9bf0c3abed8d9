/* hidden.h: what the parts of the generator share: the truth of a case, its session, its random numbers. SI
 * units. Nothing here comes from the library: a benchmark that shares its physics would only test its
 * arithmetic. */
#ifndef HIDDEN_H
#define HIDDEN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum { LAW = 5, ARMS = 2, BASE = LAW + 2 * ARMS, VALUES = 3, KNOTS = 160, RUNS = 16, CUBE = 14 };

/* ---- random numbers (random.c) ---- */
typedef struct random_state {
    uint64_t s[4];
} random_state;
random_state random_make(uint64_t seed, uint64_t stream);
double random_uniform(random_state *r, double low, double high);
double random_log(random_state *r, double low, double high); /* uniform in the logarithm */
double random_normal(random_state *r);
size_t random_index(random_state *r, size_t n);
double random_sign(random_state *r);

/* ---- what is pressed and what with ---- */
enum effect_id {
    RELAXATION_ARM,
    POWER_LAW_RELAXATION,
    STRAIN_DEPENDENT_ARM,
    RATE_STIFFENING,
    DAMAGE_SOFTENING,
    PERMANENT_SET,
    POROELASTIC,
    CONTACT_OFFSET,
    TOE_REGION,
    ADHESION,
    SESSION_AGEING,
    FRAME_COMPLIANCE,
    PLATE_INERTIA,
    COULOMB_FRICTION,
    SENSOR_LAG,
    SENSOR_BIAS,
    SENSOR_DRIFT,
    SENSOR_GAIN,
    FORCE_SATURATION,
    MAINS_HUM,
    DRIVE_RIPPLE,
    EFFECTS
};

/* What no row of the catalogue describes (foreign.c). */
enum foreign_id {
    NOTHING_FOREIGN,
    STICK_SLIP,      /* teeth of irregular length in position */
    THERMAL_CYCLE,   /* the zero follows the room's air conditioning */
    STIFFNESS_CYCLE, /* the specimen's stiffness does */
    COARSE_ADC,      /* few steps over the range */
    GAIN_MAP,        /* off-centre load: the gain depends on the position */
    SIDE_WALL,       /* a second contact below a depth */
    POWER_DAMPER,    /* a damper of the 0.4th power of speed, in contact */
    MISPLACED,       /* the specimen lies off the centre in some runs, and is softer there */
    BACKLASH,        /* play between encoder and plate */
    CELL_HYSTERESIS, /* the load cell lags behind in force, not in time */
    WANDER,          /* the zero wanders, 1/f */
    TELEGRAPH,       /* the zero flips between two values */
    FOREIGNERS
};

/* What is hidden where particles are given to a lumped model. */
enum network_kind {
    MILD,   /* only a geometry with a residual below a noise level */
    BENT,   /* only a geometry with a residual of 3 noise levels or more */
    FAULTY, /* a mild one, and an effect of the contact or the instrument */
    NETWORK_KINDS
};

typedef struct arm {
    double stiffness, time;
} arm;

/* Everything that is true of a case. An effect of strength 0 is off. */
typedef struct world {
    double height, radius;
    bool cube;       /* of particles: law and arms are each element's */
    double law[LAW]; /* K(e), ascending powers */
    size_t n_arms;
    arm arms[ARMS];
    double value[EFFECTS][VALUES]; /* each effect's parameters, as the model file has them but in SI */
    enum foreign_id foreign;
    double foreign_size, foreign_shape[2];
    uint64_t foreign_seed;
} world;

/* ---- a session of runs (path.c, session.c) ---- */
typedef struct run {
    const char *kind;               /* of the file's key protocol.kind */
    double depth, rate, ramp, hold; /* as asked for; 0 = not in the file */
    int cycles, repeat, order;
    double session;                              /* when it began */
    size_t knots;                                /* the path: straight between these, corners rounded */
    double knot_t[KNOTS], knot_d[KNOTS], corner; /* corner: its longest duration */
    double Hz;
    size_t n, first;               /* samples, and where they start in the session's rows */
    double hum_phase, shift, gain; /* of this run alone; shift and gain: repeatability */
} run;

typedef struct session {
    size_t n_runs, n;
    double deepest;
    bool lasting; /* one specimen all the time: it keeps its damage and set from run to run; else a new one
                     each */
    run run[RUNS];
} session;

void path_start(run *r, double depth);
void path_wait(run *r, double seconds);
void path_to(run *r, double depth, double speed);
/* Depth, speed and acceleration at t, for t that grow from call to call; hint: 0 at first. */
void path_at(const run *r, double t, size_t *hint, double *d, double *v, double *a);

/* What a careful experimenter runs: nine experiments. fineness scales the number of rows. */
void session_rich(session *s, random_state *r, double height, double fineness);
/* The seed's: ramps and holds at 12 depths and a static loading, without air or withdrawal. */
void session_seed(session *s, random_state *r, double height);

/* ---- the physics (world.c, foreign.c) ---- */
/* What a specimen keeps: its largest strain and energy. */
typedef struct wear {
    double most, energy;
} wear;
/* Recorded force of every sample; steps of at most h. kept: NULL (a new specimen), or before and after the
 * run. noise (may be NULL) is added before the converter clips. real: with the run's own shift and gain. */
void world_run(const world *w, const run *r, double h, bool real, const double *noise, wear *kept,
               double *force);
void world_session(const world *w, const session *s, double h, bool real, const double *noise, double *force);

/* ---- a specimen of particles (cube.c) ---- */
/* How far the middle layer bulges, in spacings of the nodes; strain and arms of each kind of element. */
typedef struct cube {
    double bulge[2], strain[CUBE], arm_force[CUBE][ARMS];
} cube;
/* Force on the plates at strain e after a step (0 = an instant); end: the cube then. */
double cube_press(const world *w, const cube *c, double step, double e, cube *end);

/* What the foreign effects remember within a run, and their random numbers. */
typedef struct foreign_state {
    double play, cell, force, table[200];
} foreign_state;
void foreign_begin(const world *w, const run *r, foreign_state *state);
double foreign_depth(const world *w, double d, foreign_state *state); /* of the plate */
double foreign_factor(const world *w, double session_time);           /* of the specimen's force */
double foreign_contact(const world *w, double x, double v);           /* added in contact */
double foreign_record(const world *w, double session_time, double d, double v, double force,
                      foreign_state *state);
double foreign_convert(const world *w, double force); /* by the converter */
const char *foreign_name(enum foreign_id id);

/* ---- the catalogue as the generator has it (kinds.c) ---- */
typedef struct effect_kind {
    const char *id;
    size_t n;                         /* parameters; the first is the strength */
    const char *key[VALUES];          /* in the model file */
    double unit[VALUES];              /* SI per file unit */
    double low[VALUES], high[VALUES]; /* SI; [0]: unused and the largest strength in units of its scale */
    bool logarithmic[VALUES];
    enum { PLAIN, OF_STIFFNESS, OF_FORCE, OF_COMPLIANCE } scale;
    bool either_sign, linear, coupled; /* coupled: the other parameters are given per strength */
    bool plane;                        /* its directions are free to mix: a phase, two coefficients */
} effect_kind;
extern const effect_kind effect_kinds[EFFECTS];

/* ---- what can be seen of an effect (judge.c, alike.c) ---- */
/* The plain model's sensitivities at some of its numbers: basis * triangle, basis [n_base][n] orthonormal. */
typedef struct slopes {
    double *basis, triangle[BASE][BASE];
} slopes;

typedef struct judge {
    const world *plain;
    const session *session;
    double h, peak;
    size_t n, n_base;
    double *force; /* of the plain world */
    slopes at;     /* there */
} judge;
bool judge_make(judge *j, const world *plain, const session *s, double h);
void judge_free(judge *j);
double judge_dot(const judge *j, const double *a, const double *b);
double judge_rms(const judge *j, const double *v);
void judge_project(const judge *j, double *v); /* takes off what the plain model's numbers can do */

/* rms of world - plain: raw, and after a refit of the plain model's numbers to the world (left). residual
 * (NULL or [n]) is that of the refit. */
typedef struct visible {
    double raw, left;
} visible;
visible judge_visible(const judge *j, const world *w, double *residual);
/* The plain world that comes nearest to w; rms of the residual. */
double judge_fit(const judge *j, const world *w, world *nearest);

/* Puts the effect in at strength s (in its own scale; the largest is 1). shape[0]: its sign. id EFFECTS: the
 * foreign one of w. */
void judge_put(const judge *j, world *w, int id, const double shape[VALUES], double s);
/* The same at the strength at which the residual (raw: the effect itself) is target, or the largest there
 * is. */
visible judge_strengthen(const judge *j, world *w, int id, const double shape[VALUES], double target,
                         bool raw);

/* For every effect, the largest cosine between y and the effect, both orthogonal to the plain model and to
 * also ([n_also][n] orthonormal). Removes their part from y. */
void judge_alike(const judge *j, double *y, size_t n_also, const double *also, double cosine[EFFECTS]);

/* The same of a frame for the residual of w, by refits with frames of several strengths: a stiff one hides in
 * the law, a soft one may look like an arm that depends on strain, so that small steps say little. */
double judge_frame(const judge *j, const world *w, double left);

/* ---- cases (cases.c, write.c) ---- */
enum group { SINGLE, NONE, TWO, OUTSIDE, SEED, NETWORK, GROUPS };
typedef struct plan {
    enum group group;
    int effect;      /* SINGLE: which; OUTSIDE, SEED: which of those that are used there; NETWORK: its kind */
    int strength;    /* 0, 1, 2 */
    double fineness; /* of the rows */
    bool lasting;    /* of the session */
} plan;

typedef struct hidden_effect {
    int id;
    double strength; /* what was aimed at, in noise levels */
    visible seen;    /* in newtons */
    double cosine[EFFECTS];
} hidden_effect;

typedef struct hidden_case {
    char name[32];
    plan plan;
    int tries;
    world world, plain; /* plain: what the given model is near */
    session session;
    double white, correlated, correlation_time, noise_level, peak;
    size_t n_effects;
    hidden_effect effect[2];
    visible foreign; /* or the network's geometry; and its likeness to the catalogue */
    double foreign_cosine[EFFECTS];
    double *force;          /* recorded */
    random_state left_over; /* for the given model's numbers */
} hidden_case;

/* Draws the case; false without memory. raw: strengths are measured before the plain model is refitted. */
bool case_make(hidden_case *c, uint64_t seed, size_t number, plan p, bool raw);
void case_free(hidden_case *c);
bool case_write(const hidden_case *c, const char *folder);
void truth_write(FILE *f, const hidden_case *c);

int self_test(void); /* number of failures, each printed */

#endif
