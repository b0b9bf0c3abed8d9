/* step_slopes.h: derivatives of a network's elements and force by parameters, carried from step to step. The
 * caller adds the direct changes of elements by a parameter, which is a column. PALP_HISTORY, no mass.
 * Internal. */
#ifndef STEP_SLOPES_H
#define STEP_SLOPES_H

#include "effect/effect_internal.h"
#include "material/element.h"
#include "network/network_internal.h"

/* By columns and elements: [n m], arms [n n_arms m]. */
typedef struct step_slopes {
    palp_network *net;
    size_t n, m, n_arms, n_state;
    double *state;               /* [n_state] the next three arrays, contiguous */
    double *strain, *arm, *peak; /* of the last step; peak NULL: springs are not damaged */
    double *partial, *fixed;     /* of the trial at fixed nodes: element force and arms */
    double *by;                  /* [n_arms ELEMENT_PARTIALS m] of the arms, by element_arm_partials */
    double *by_peak;             /* [m] of the element force: set by the caller if springs are damaged */
    double *drive;               /* [3 n_nodes] displacement per depth */
    const double *weight;        /* [m] owned by the caller */
    double outer; /* set by the caller for each column: derivative of the logarithm of the outer forces */
} step_slopes;

/* n columns for a network at rest, with n_arms in its material; free with step_slopes_free. ERR_NO_MEMORY;
 * ERR_UNSUPPORTED: a region has arms or a dashpot of its own. */
palp_status step_slopes_create(palp_network *net, size_t n, size_t n_arms, step_slopes *slopes);
void step_slopes_free(step_slopes *slopes);

/* For the present trial, with weight of network_weights and its net->fint: computes by and drive, clears
 * partial. */
void step_slopes_begin(step_slopes *slopes, const double *weight);

/* Partials of arm j of the trial, one of element_partial: [m]. */
const double *step_slopes_by(const step_slopes *slopes, size_t j, element_partial by);

/* Column k: change by the last step's state. The caller then adds the direct change of arm j. */
void step_slopes_carry(step_slopes *slopes, size_t k);
void step_slopes_add_arm(step_slopes *slopes, size_t k, size_t j, const effect_arm *own);

/* Derivative of the force by column k at fixed depth; stiffer: derivative of the logarithm of the
 * foundation. */
double step_slopes_force(const step_slopes *slopes, size_t k, double stiffer);

/* Makes the state's derivatives by column k those of the trial at equilibrium; depth_p: derivative of the
 * depth. Uses net->fint. */
void step_slopes_equilibrate(step_slopes *slopes, size_t k, double stiffer, double depth_p);

#endif
