/* forward_plate.h: internal parts of the plate: position of the surface, trials and state of the specimen. */
#ifndef FORWARD_PLATE_H
#define FORWARD_PLATE_H

#include "forward_internal.h"

/* ---- from the encoder to the surface (forward_surface.c) ---- */

typedef struct forward_surface {
    double strain, by_depth, by_force;
    double drift; /* change with the share of the step at constant depth of the encoder */
    double by_value[PALP_EFFECTS_MAX]
                   [PALP_EFFECT_PARAMETERS]; /* [n_effects], of the depth, for effects with a map */
} forward_surface;

/* Strain of a surface on the plate with this force, at a share of the step. */
forward_surface forward_held(const forward_plate *p, double share, double force);

/* Derivative of that strain by the share of the step. */
double forward_along_step(const forward_plate *p, const forward_surface *s);

/* Derivatives of that strain by the maps' own parameters. */
void forward_own_slopes(const forward_plate *p, const forward_surface *s, double *row);

double forward_step_time(const forward_plate *p);

/* Tries the specimen's force, times its ageing; the rate is the plate's if it moves the surface, otherwise
 * 0. */
palp_status forward_ask(const forward_plate *p, double strain, double share, bool moved, double *force,
                        double *slope);

/* Derivatives of the force of the last trial at fixed strain and time, with ageing; before the trial is
 * committed. */
void forward_hold(const forward_plate *p, double force, double *force_p, double *force_dt);

/* Commits the last trial at that share of the step; strain_p and share_p are the derivatives of both (share_p
 * NULL = 0). */
void forward_take(forward_plate *p, double strain, double share, double force, const double *strain_p,
                  const double *share_p);

/* ---- a surface that is pulled (forward_pull.c) ---- */

/* The bond of a surface at this distance behind the plate, as strain; returns the column of its effect. */
size_t forward_bond_at(const forward_plate *p, double gap, effect_bond *bond);

/* Moves the plate to the end of the step, at this strain, with a surface that it pulls; or it lets go. */
palp_status forward_pull(forward_plate *p, double strain);

void forward_let_go(forward_plate *p);

#endif
