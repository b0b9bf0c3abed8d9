/* step_slopes.h: derivatives of a network's elements and of its force by parameters, carried from step to
 * step. The caller says what a parameter, a column, changes of the elements itself. PALP_HISTORY, no mass.
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
    double *state;               /* [n_state] the three that follow, one after the other */
    double *strain, *arm, *peak; /* of the last step; peak NULL: the springs are not damaged */
    double *partial, *fixed;     /* of the trial with the nodes held: element force and arms */
    double *by;                  /* [n_arms ELEMENT_PARTIALS m] of the arms, by element_arm_partials */
    double *by_peak;      /* [m] of the element force: the caller's to fill if the springs are damaged */
    double *drive;        /* [3 n_nodes] displacement per depth */
    const double *weight; /* [m] the caller's */
} step_slopes;

/* n columns of a network at rest whose material has n_arms; step_slopes_free. ERR_NO_MEMORY. */
palp_status step_slopes_create(palp_network *net, size_t n, size_t n_arms, step_slopes *slopes);
void step_slopes_free(step_slopes *slopes);

/* Of the trial at hand, whose network_weights are weight and net->fint: by and drive; partial is zeroed. */
void step_slopes_begin(step_slopes *slopes, const double *weight);

/* Partials of arm j of the trial by one of element_partial: [m]. */
const double *step_slopes_by(const step_slopes *slopes, size_t j, element_partial by);

/* Column k: what the last step's state changes now; then what it changes of arm j itself is added. */
void step_slopes_carry(step_slopes *slopes, size_t k);
void step_slopes_add_arm(step_slopes *slopes, size_t k, size_t j, const effect_arm *own);

/* Derivative of the force by column k at a fixed depth; stiffer: that of the logarithm of the network's
 * foundation. */
double step_slopes_force(const step_slopes *slopes, size_t k, double stiffer);

/* The state's derivatives by column k become the trial's, at equilibrium; depth_p: that of the depth. Uses
 * net->fint. */
void step_slopes_equilibrate(step_slopes *slopes, size_t k, double stiffer, double depth_p);

#endif
