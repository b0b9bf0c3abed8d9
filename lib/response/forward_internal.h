/* forward_internal.h: the inside of the forward model: a plan of the effects, a specimen behind one
 * interface, and the plate that meets it. */
#ifndef FORWARD_INTERNAL_H
#define FORWARD_INTERNAL_H

#include <palpate/forward.h>

#include "effect/effect_internal.h"
#include "material/element.h"

/* Of an arm that is off, N: it adds nothing to any force, and still has derivatives. */
#define FORWARD_NO_STIFFNESS 1e-200

/* An effect of the model, with its parameters and the column of the first; its factor of the specimen's force
 * at the time of the session. */
typedef struct forward_effect {
    const effect_row *row;
    const palp_effect *effect;
    size_t column;
    effect_number age;
} forward_effect;

/* By how much the strength or shape of an effect, in a column, changes how loading damages the spring. */
typedef struct forward_damage_slope {
    size_t column;
    element_damage by;
} forward_damage_slope;

/* Likewise an arm. */
typedef struct forward_arm_slope {
    size_t column;
    effect_arm by;
} forward_arm_slope;

enum { FORWARD_SPECTRA = 2 }; /* of one model, at most */
enum { FORWARD_ARM_SLOPES = 2 + PALP_EFFECTS_MAX * PALP_EFFECT_PARAMETERS };

/* What the model's effects come to. Points into the model. */
typedef struct forward_plan {
    const palp_model *model;
    size_t n_columns; /* all parameters */
    size_t n_effects, n_spectra;
    forward_effect effect[PALP_EFFECTS_MAX]; /* in the order in which they act */
    palp_material material;                  /* with what the effects make of its arms */
    size_t arm_column[PALP_ARMS_MAX];        /* of K_j; the next is b_j, or for an effect's arm its time */
    bool arm_timed[PALP_ARMS_MAX];           /* the latter */
    bool gives_way;                          /* the surface's depth depends on the force */
    bool damaged;                            /* loading damages the spring, as damage tells */
    bool sets;                               /* and does not come back to its length */
    element_damage damage;
    size_t n_damage_slopes;
    forward_damage_slope damage_slope[PALP_EFFECTS_MAX * PALP_EFFECT_PARAMETERS];
    double contact;  /* the surface of this run lies so much deeper, m */
    double age;      /* factor of the specimen's force at the time of the session */
    double adhesion; /* pull at which the plate lets go, N */
    bool reaches;    /* and the bond opens before it lets go */
} forward_plan;

/* Checks the model and lays the plan for a run that began at session_s. */
palp_status forward_plan_make(const palp_model *model, double session_s, forward_plan *plan,
                              palp_error *error);

/* Factor of the spring's force by the strain rate of the plate; of_effect[n_effects]: its parts. */
double forward_rate_factor(const forward_plan *plan, double rate, effect_number *of_effect);

/* The columns that move arm j itself: slope[FORWARD_ARM_SLOPES]. Returns how many there are. */
size_t forward_arm_slopes(const forward_plan *plan, size_t j, forward_arm_slope *slope);

/* The plan as of another time of the session. ERR_ARGUMENT: nothing is left of the specimen's force. */
palp_status forward_plan_age(forward_plan *plan, double session_s);

/* Shortest relaxation time of the plan's arms that are not off; INFINITY: it has none. */
double forward_shortest_arm(const forward_plan *plan);

/* Where the parameters of the model's arms and effects start. */
size_t forward_arm_column(const palp_model *model, size_t arm);
size_t forward_effect_column(const palp_model *model, size_t effect);

/* ---- a specimen: lumped, or a network ---- */

/* How a specimen is asked to move: from its state to a surface strain (positive = compression) in dt. */
typedef struct forward_move {
    double strain, dt;
    double rate; /* strain rate of the plate that moves it, 1/s; 0 where it is left alone */
} forward_move;

/* attempt leaves a trial that commit makes the state; force is the specimen's, N, slope (if not NULL) its
 * derivative by strain. The rest is for derivatives by the model's parameters and may be NULL without
 * columns: hold gives force_p[n_columns], the derivatives with strain and dt of the trial held, and
 * *force_dt. commit takes those of strain and dt (NULL = all 0) and gives those of the force. */
typedef struct forward_specimen {
    void *self;
    palp_status (*attempt)(void *self, const forward_move *move, double *force, double *slope);
    void (*hold)(void *self, double *force_p, double *force_dt);
    void (*commit)(void *self, const double *strain_p, const double *dt_p, double *force_p);
    double height;
    double shortest; /* relaxation time, s; 0 = it has none */
    size_t n_columns;
    double rest;          /* strain of the surface before it is touched, */
    const double *rest_p; /* [n_columns] and its derivatives; NULL = all 0 */
} forward_specimen;

/* Its modes hold for steps from shortest, in all whole seconds. */
typedef struct forward_lumped forward_lumped;
palp_status forward_lumped_create(const forward_plan *plan, size_t n_columns, double shortest, double whole,
                                  forward_lumped **lumped);
void forward_lumped_free(forward_lumped *lumped);
forward_specimen forward_lumped_specimen(forward_lumped *lumped);

/* Takes the load history over before the first step; tells it after the last. */
void forward_lumped_take_history(forward_lumped *lumped, const palp_load_history *history);
void forward_lumped_leave_history(const forward_lumped *lumped, palp_load_history *history);

/* Of one element: adds to force_p what the spring's own parameters change, strain and peak held; rate_factor
 * and of_effect: of the rate, by forward_rate_factor. */
void forward_spring_own(const forward_plan *plan, const element_damaged *spring, double peak,
                        double rate_factor, const effect_number *of_effect, double *force_p);

/* The law's coefficients move the drive of a quasi-linear arm, K(e) e / K(0), from strain e[0] to e[1]. */
void forward_quasi_linear_own(const palp_law *law, const double e[2], double drive, double *row);

/* settings may be NULL. A spectrum becomes arms of the plan that hold for steps from shortest, in all whole
 * seconds (0: none); sloped: every trial's slope is asked for. */
typedef struct forward_network forward_network;
palp_status forward_network_create(forward_plan *plan, const palp_network_settings *settings, double shortest,
                                   double whole, bool sloped, forward_network **network, palp_error *error);
palp_status forward_network_add_slopes(forward_network *network); /* of one made sloped: derivatives */

/* How the run finds the specimen, before the first step, and how it leaves it. ERR_ARGUMENT: that of another
 * mesh. */
palp_status forward_network_take_history(forward_network *network, const palp_load_history *history);
palp_status forward_network_leave_history(const forward_network *network, palp_load_history *history);
void forward_network_free(forward_network *network);
forward_specimen forward_network_specimen(forward_network *network);

/* palp_forward_network with derivatives (gradient may be NULL). The network is solved at chosen samples, its
 * force on the plate interpolated between them; where the plate meets or leaves it, at every one
 * (forward_adaptive.c). ERR_UNSUPPORTED: mass, or PALP_SEDEF2008. */
palp_status forward_network_force(const palp_model *model, const palp_forward_run *run, double *force_N,
                                  double *gradient, palp_error *error);

/* The state of the last commit kept, and gone back to; d force / d surface strain of the last commit. */
void forward_network_keep(forward_network *network);
void forward_network_back(forward_network *network);
double forward_network_slope(const forward_network *network);

/* Derivatives of a network's force, carried through its steps (forward_slopes.c). A spectrum's arms are those
 * from first on; mode[n]. */
typedef struct forward_spectrum {
    size_t first, n, column, n_values;
    effect_mode mode[PALP_ARMS_MAX];
} forward_spectrum;

typedef struct forward_slopes forward_slopes;
palp_status forward_slopes_create(const forward_plan *plan, palp_network *net, size_t n_spectra,
                                  const forward_spectrum *spectrum, forward_slopes **slopes);
void forward_slopes_free(forward_slopes *slopes);
void forward_slopes_keep(forward_slopes *slopes, bool back);

/* Derivatives of the elements' peaks before the first step, and now: [n_columns n_elements]. */
void forward_slopes_take_history(forward_slopes *slopes, const double *peak_p);
const double *forward_slopes_history(const forward_slopes *slopes);

/* Of the trial at hand, whose network_weights are weight[n_elements], stiffness and net->fint; then as
 * forward_specimen. advance makes them those of the state, before the network's commit. */
void forward_slopes_find(forward_slopes *slopes, const double *weight, double stiffness,
                         const effect_number *of_effect);
void forward_slopes_hold(forward_slopes *slopes, double *force_p, double *force_dt);
void forward_slopes_advance(forward_slopes *slopes, const double *strain_p, const double *dt_p,
                            double *force_p);

/* ---- the plate (forward_contact.c, inside: forward_plate.h) ---- */

typedef struct forward_plate {
    const forward_plan *plan;
    forward_specimen specimen;
    bool touching, fresh;     /* fresh: the specimen has not been touched yet */
    double force, *force_p;   /* on the plate */
    double strain, *strain_p; /* of the surface */
    double released;          /* when the plate last left it, s */
    double gap;               /* by which the surface lags behind a plate that pulls it, as strain; */
    double bond;              /* stiffness of the bond there, N; 0 = the surface is on the plate */
    bool abandons;            /* a surface let go is not followed: the plate does not come back */
    /* the step at hand: from depth[0] at time[0] to depth[1] at time[1], where the plate has velocity; done:
     * the share that is committed */
    double time[2], depth[2], velocity, done, *done_p;
    double change[2][PALP_EFFECTS_MAX]; /* of the columns that the plan's effects read, there */
    double *work; /* [FORWARD_WORK n_columns] scratch, after the four above in one block */
} forward_plate;

enum { FORWARD_WORK = 4 };

palp_status forward_plate_create(const forward_plan *plan, const forward_specimen *specimen,
                                 forward_plate *plate);
void forward_plate_free(forward_plate *plate);

/* Where the encoder reads and when; change of each effect's column since the first sample. */
typedef struct forward_place {
    double time, depth, velocity;
    double change[PALP_EFFECTS_MAX];
} forward_place;

/* At a share of the way from the sample before i to i; share 1 = there. velocity: of sample i. */
forward_place forward_place_at(const forward_plan *plan, const palp_forward_run *run, size_t i, double share);

/* Puts the plate at its first place, at once. Then moves it on, linearly. */
palp_status forward_plate_start(forward_plate *plate, const forward_place *place);
palp_status forward_plate_move(forward_plate *plate, const forward_place *to);

/* d force / d depth of the last move, the specimen's own by strain given; and whether the plate is clear of a
 * specimen at rest at that place. */
double forward_plate_stiffness(const forward_plate *plate, double slope);
bool forward_plate_clear(const forward_plate *plate, const forward_place *place);

/* The same by a step of dt to the bit, whatever the time: the plate's clock starts anew. */
palp_status forward_plate_step(forward_plate *plate, double dt, double depth, double velocity);

/* ---- the sensor: from the force on the plate to the recorded one (forward.c) ---- */

/* What a stage of it remembers of the sample before. */
typedef struct forward_memory {
    double input, output, *input_p, *output_p;
} forward_memory;

typedef struct forward_sensor {
    const forward_plan *plan;
    size_t n_columns;
    forward_memory stage[PALP_EFFECTS_MAX];
    double fastest;          /* speed of the run; of one whose end is not known, so far */
    double *force_p, *block; /* block: the first and all stages' rows */
} forward_sensor;

palp_status forward_sensor_create(const forward_plan *plan, size_t n_columns, double fastest,
                                  forward_sensor *sensor);
void forward_sensor_free(forward_sensor *sensor);

/* Takes a force and sensor->force_p through the stages. */
double forward_sensor_read(forward_sensor *sensor, const effect_moment *at, double force);

/* Where the instrument is at sample i. */
effect_moment forward_moment(const palp_forward_run *run, size_t i);

/* Its largest speed, and its shortest time between samples and all of it. */
double forward_fastest(const palp_forward_run *run);
void forward_times(const palp_forward_run *run, double *shortest, double *whole);

/* ERR_ARGUMENT: times that do not increase, numbers that are not finite. */
palp_status forward_check_run(const palp_forward_run *run, palp_error *error);

/* The same for a network, solved at chosen samples (forward_adaptive.c). */
palp_status forward_run_adaptive(const forward_plan *plan, forward_network *network,
                                 const palp_forward_run *run, double *force_N, double *gradient,
                                 palp_error *error);

/* The whole chain of one recording; gradient is NULL or takes the specimen's columns (forward.c). */
palp_status forward_run(const forward_plan *plan, const forward_specimen *specimen,
                        const palp_forward_run *run, double *force_N, double *gradient, palp_error *error);

/* ---- equations ---- */

/* value and d value / dx of an increasing function. */
typedef palp_status forward_equation(void *user, double x, double *value, double *slope);

/* Its zero in [low, high], by Newton kept in the bracket; *x comes as the first guess, and is the last place
 * that was asked. ERR_NOT_CONVERGED: no zero there, or none found. */
palp_status forward_solve(forward_equation *equation, void *user, double low, double high, double *x);

#endif
