/* forward_internal.h: internal parts of the forward model: a plan of the effects, an interface to the
 * specimen, and the plate. */
#ifndef FORWARD_INTERNAL_H
#define FORWARD_INTERNAL_H

#include <palpate/forward.h>

#include "effect/effect_internal.h"
#include "material/element.h"

/* Stiffness of an arm that is off, N: too small to change any force, but with derivatives. */
#define FORWARD_NO_STIFFNESS 1e-200

/* An effect of the model, the column of its first parameter, and its factor of the specimen's force at the
 * time of the session. */
typedef struct forward_effect {
    const effect_row *row;
    const palp_effect *effect;
    size_t column;
    effect_number age;
} forward_effect;

/* Derivative of the spring's damage by an effect's parameter in this column. */
typedef struct forward_damage_slope {
    size_t column;
    element_damage by;
} forward_damage_slope;

/* Derivative of an arm by an effect's parameter in this column. */
typedef struct forward_arm_slope {
    size_t column;
    effect_arm by;
} forward_arm_slope;

enum { FORWARD_SPECTRA = 2 }; /* at most in one model */
enum { FORWARD_ARM_SLOPES = 2 + PALP_EFFECTS_MAX * PALP_EFFECT_PARAMETERS };

/* The model's effects, sorted by what they change. Points into the model. */
typedef struct forward_plan {
    const palp_model *model;
    size_t n_columns; /* all parameters */
    size_t n_effects, n_spectra;
    forward_effect effect[PALP_EFFECTS_MAX]; /* in the order in which they act */
    palp_material material;                  /* with the effects' changes of its arms */
    size_t arm_column[PALP_ARMS_MAX]; /* of K_j; the next column is b_j, or the time of an effect's arm */
    bool arm_timed[PALP_ARMS_MAX];    /* the next column is a time */
    bool gives_way;                   /* the surface's depth depends on the force */
    bool damaged;                     /* loading damages the spring, see damage */
    bool sets;                        /* the spring does not return to its length */
    element_damage damage;
    size_t n_damage_slopes;
    forward_damage_slope damage_slope[PALP_EFFECTS_MAX * PALP_EFFECT_PARAMETERS];
    double contact;  /* depth of this run's surface, m */
    double age;      /* factor of the specimen's force at the time of the session */
    double adhesion; /* largest pull before the plate lets go, N */
    bool reaches;    /* the bond opens before that */
} forward_plan;

/* Checks the model and makes the plan for a run that began at session_s. */
palp_status forward_plan_make(const palp_model *model, double session_s, forward_plan *plan,
                              palp_error *error);

/* Factor of the spring's force at the plate's strain rate; of_effect[n_effects]: factors of the effects. */
double forward_rate_factor(const forward_plan *plan, double rate, effect_number *of_effect);

/* The columns that change arm j itself: slope[FORWARD_ARM_SLOPES]; returns their number. */
size_t forward_arm_slopes(const forward_plan *plan, size_t j, forward_arm_slope *slope);

/* Changes the plan to another time of the session. ERR_ARGUMENT: ageing leaves no force. */
palp_status forward_plan_age(forward_plan *plan, double session_s);

/* Shortest relaxation time of the plan's arms that are on; INFINITY without any. */
double forward_shortest_arm(const forward_plan *plan);

/* First column of an effect's parameters. */
size_t forward_effect_column(const palp_model *model, size_t effect);

/* ---- a specimen: lumped, or a network ---- */

/* A motion of the specimen: from its state to a surface strain (positive = compression) in dt. */
typedef struct forward_move {
    double strain, dt;
    double rate; /* strain rate of the plate that moves it, 1/s; 0 for a free surface */
} forward_move;

/* attempt makes a trial, and commit makes it the state; force is the specimen's, N, slope (unless NULL) its
 * derivative by strain. All else is for derivatives by the model's parameters and may be NULL without
 * columns. hold gives force_p[n_columns], the derivatives at fixed strain and dt of the trial, and *force_dt.
 * commit takes the derivatives of strain and dt (NULL = 0) and gives those of the force. */
typedef struct forward_specimen {
    void *self;
    palp_status (*attempt)(void *self, const forward_move *move, double *force, double *slope);
    void (*hold)(void *self, double *force_p, double *force_dt);
    void (*commit)(void *self, const double *strain_p, const double *dt_p, double *force_p);
    double height;
    double shortest; /* relaxation time, s; 0 = none */
    size_t n_columns;
    double rest;          /* strain of the surface before contact, */
    const double *rest_p; /* [n_columns] and its derivatives; NULL = 0 */
} forward_specimen;

/* Its modes are valid for steps from shortest on, in whole seconds altogether. */
typedef struct forward_lumped forward_lumped;
palp_status forward_lumped_create(const forward_plan *plan, size_t n_columns, double shortest, double whole,
                                  forward_lumped **lumped);
void forward_lumped_free(forward_lumped *lumped);
forward_specimen forward_lumped_specimen(forward_lumped *lumped);

/* Takes the load history over before the first step; gives it after the last. */
void forward_lumped_take_history(forward_lumped *lumped, const palp_load_history *history);
void forward_lumped_leave_history(const forward_lumped *lumped, palp_load_history *history);

/* For one element: adds to force_p the derivatives by the spring's own parameters, at fixed strain and peak.
 * rate_factor and of_effect are those of forward_rate_factor. */
void forward_spring_own(const forward_plan *plan, const element_damaged *spring, double peak,
                        double rate_factor, const effect_number *of_effect, double *force_p);

/* Adds the derivatives of a quasi-linear arm's drive, K(e) e / K(0), from strain e[0] to e[1], by the law's
 * coefficients. */
void forward_quasi_linear_own(const palp_law *law, const double e[2], double drive, double *row);

/* settings may be NULL. A spectrum becomes arms of the plan, valid for steps from shortest on, in whole
 * seconds altogether (0: no spectrum). sloped: the slope of every trial is needed. */
typedef struct forward_network forward_network;
palp_status forward_network_create(forward_plan *plan, const palp_network_settings *settings, double shortest,
                                   double whole, bool sloped, forward_network **network, palp_error *error);
palp_status forward_network_add_slopes(forward_network *network); /* adds derivatives to one made sloped */

/* Load history of the network before the first step, and after the last. ERR_ARGUMENT: it belongs to another
 * mesh. */
palp_status forward_network_take_history(forward_network *network, const palp_load_history *history);
palp_status forward_network_leave_history(const forward_network *network, palp_load_history *history);
void forward_network_free(forward_network *network);
forward_specimen forward_network_specimen(forward_network *network);

/* palp_forward_network with derivatives (gradient may be NULL). Solves adaptive samples and interpolates the
 * force between them; solves every sample where the plate meets or leaves the network (forward_adaptive.c).
 * ERR_UNSUPPORTED: mass, or PALP_SEDEF2008. */
palp_status forward_network_force(const palp_model *model, const palp_forward_run *run, double *force_N,
                                  double *gradient, palp_error *error);

/* Keeps the committed state, and goes back to it; d force / d surface strain of the last commit. */
void forward_network_keep(forward_network *network);
void forward_network_back(forward_network *network);
double forward_network_slope(const forward_network *network);

/* Derivatives of a network's force, carried from step to step (forward_slopes.c). Arms from first on belong
 * to a spectrum; mode[n]. */
typedef struct forward_spectrum {
    size_t first, n, column, n_values;
    effect_mode mode[PALP_ARMS_MAX];
} forward_spectrum;

typedef struct forward_slopes forward_slopes;
palp_status forward_slopes_create(const forward_plan *plan, palp_network *net, size_t n_spectra,
                                  const forward_spectrum *spectrum, forward_slopes **slopes);
void forward_slopes_free(forward_slopes *slopes);
void forward_slopes_keep(forward_slopes *slopes, bool back);

/* Derivatives of the elements' peaks, before the first step and now: [n_columns n_elements]. */
void forward_slopes_take_history(forward_slopes *slopes, const double *peak_p);
const double *forward_slopes_history(const forward_slopes *slopes);

/* For the present trial, with weight[n_elements] and stiffness of network_weights and its net->fint; then
 * as in forward_specimen. advance makes the trial's derivatives those of the state, before the network's
 * commit. */
void forward_slopes_find(forward_slopes *slopes, const double *weight, double stiffness,
                         const effect_number *of_effect);
void forward_slopes_hold(forward_slopes *slopes, double *force_p, double *force_dt);
void forward_slopes_advance(forward_slopes *slopes, const double *strain_p, const double *dt_p,
                            double *force_p);

/* ---- the plate (forward_contact.c, inside: forward_plate.h) ---- */

typedef struct forward_plate {
    const forward_plan *plan;
    forward_specimen specimen;
    bool touching, fresh;     /* fresh: the specimen has not been in contact yet */
    double force, *force_p;   /* on the plate */
    double strain, *strain_p; /* of the surface */
    double released;          /* time at which the plate last let go, s */
    double gap;               /* distance of the surface behind a plate that pulls it, as strain; */
    double bond;              /* stiffness of the bond, N; 0 = the surface is on the plate */
    bool abandons;            /* a released surface is not followed, as the plate does not return */
    /* The present step: from depth[0] at time[0] to depth[1] at time[1], where the plate has velocity. done:
     * committed share of it. */
    double time[2], depth[2], velocity, done, *done_p;
    double change[2][PALP_EFFECTS_MAX]; /* of the columns that the effects read, at both ends */
    double *work; /* [FORWARD_WORK n_columns] scratch, in one block with the four arrays above */
} forward_plate;

enum { FORWARD_WORK = 4 };

palp_status forward_plate_create(const forward_plan *plan, const forward_specimen *specimen,
                                 forward_plate *plate);
void forward_plate_free(forward_plate *plate);

/* Depth and time of the encoder; change of each effect's column since the first sample. */
typedef struct forward_place {
    double time, depth, velocity;
    double change[PALP_EFFECTS_MAX];
} forward_place;

/* At a share of the way from the sample before i to i; share 1 = at i. velocity: that of sample i. */
forward_place forward_place_at(const forward_plan *plan, const palp_forward_run *run, size_t i, double share);

/* Puts the plate at its first place at once; the second function moves it on linearly. */
palp_status forward_plate_start(forward_plate *plate, const forward_place *place);
palp_status forward_plate_move(forward_plate *plate, const forward_place *to);

/* d force / d depth of the last move, from the specimen's slope by strain. Second: is the plate clear of a
 * specimen at rest at that place? */
double forward_plate_stiffness(const forward_plate *plate, double slope);
bool forward_plate_clear(const forward_plate *plate, const forward_place *place);

/* The same for a step of dt, with equal bits at any time: the plate's clock restarts. */
palp_status forward_plate_step(forward_plate *plate, double dt, double depth, double velocity);

/* ---- the sensor: from the force on the plate to the recorded one (forward.c) ---- */

/* What a stage keeps of the sample before. */
typedef struct forward_memory {
    double input, output, *input_p, *output_p;
} forward_memory;

typedef struct forward_sensor {
    const forward_plan *plan;
    size_t n_columns;
    forward_memory stage[PALP_EFFECTS_MAX];
    double fastest;          /* largest speed of the run; so far, if its end is unknown */
    double *force_p, *block; /* block: force_p and the rows of all stages */
} forward_sensor;

palp_status forward_sensor_create(const forward_plan *plan, size_t n_columns, double fastest,
                                  forward_sensor *sensor);
void forward_sensor_free(forward_sensor *sensor);

/* Passes a force and sensor->force_p through the stages. */
double forward_sensor_read(forward_sensor *sensor, const effect_moment *at, double force);

/* Motion of the instrument at sample i. */
effect_moment forward_moment(const palp_forward_run *run, size_t i);

/* Largest speed of the run; its shortest sample interval and its duration. */
double forward_fastest(const palp_forward_run *run);
void forward_times(const palp_forward_run *run, double *shortest, double *whole);

/* ERR_ARGUMENT: times do not increase, or a number is not finite. */
palp_status forward_check_run(const palp_forward_run *run, palp_error *error);

/* The same for a network, solved at chosen samples (forward_adaptive.c). */
palp_status forward_run_adaptive(const forward_plan *plan, forward_network *network,
                                 const palp_forward_run *run, double *force_N, double *gradient,
                                 palp_error *error);

/* Adds the model's free terms to the force along a run; gradient[columns n] (NULL: not wanted) follows a gain
 * among them. */
palp_status forward_add_free(const palp_model *model, const palp_forward_run *run, size_t columns,
                             double *force_N, double *gradient);

/* The whole chain of one recording; gradient is NULL or receives the specimen's columns (forward.c). */
palp_status forward_run(const forward_plan *plan, const forward_specimen *specimen,
                        const palp_forward_run *run, double *force_N, double *gradient, palp_error *error);

/* ---- equations ---- */

/* value and d value / dx of an increasing function. */
typedef palp_status forward_equation(void *user, double x, double *value, double *slope);

/* Its zero in [low, high], by Newton's method in a bracket. *x in: first guess; out: last evaluated place.
 * ERR_NOT_CONVERGED: no zero there, or not found. */
palp_status forward_solve(forward_equation *equation, void *user, double low, double high, double *x);

#endif
