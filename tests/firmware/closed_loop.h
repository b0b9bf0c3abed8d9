/* closed_loop.h: the control of the plate around the simulated indenter, in process, without the app. */
#ifndef CLOSED_LOOP_H
#define CLOSED_LOOP_H

#include "contact.h"
#include "force.h"
#include "machine.h"
#include "pid.h"
#include "rig/plant.h"

/* Positions count from where the plate begins, LOOP_AIR_M above the specimen. */
#define LOOP_AIR_M 1e-3f

enum { SOFTNESSES = GAINS_CLASSES };
extern const double softness_scale[SOFTNESSES];      /* of the phantom, in the middle of each class */
extern const double softness_border[SOFTNESSES + 1]; /* between them */

typedef struct loop {
    plant *plant;
    plant_in in;
    pid pid;
    force_sensor force;
    const gains *gains;
    bool known; /* where contact is */
    float contact_m;
    double start_m; /* from the home switch */
} loop;

/* Fail the running test on an error. */
void loop_open(loop *l, plant_settings settings);
void loop_tick(loop *l, const reference *to);
void loop_rest(loop *l, float at_m, int ticks);
void loop_go(loop *l, float from_m, float to_m);
void loop_close(loop *l);

/* Advances until contact_step() has its answer, at most to end_m; the plate stays where it then is. */
contact loop_search(loop *l, float rate_m_s, float end_m);

double loop_force(const loop *l);    /* as the sensor gives it */
double loop_position(const loop *l); /* as it truly is */

#endif
