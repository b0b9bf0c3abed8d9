/* calibrate_internal.h: what the two stages of calibration share. */
#ifndef CALIBRATE_INTERNAL_H
#define CALIBRATE_INTERNAL_H

#include <palpate/calibrate.h>

#include "network/network_internal.h"

/* Appends a copy of *iteration. */
palp_status calibration_add(palp_calibration *c, const palp_calibrate_iteration *iteration);

/* No equilibrium was found: the material is at fault, another may do. */
bool calibration_lost(palp_status status);

/* Least squares by NLopt: minimises |r(p)|_2^2 / 2, r[n_residuals], over n_parameters. evaluate fills r
 * and, unless NULL, the Jacobian by columns, jacobian[k n_residuals + i] = dr_i / dp_k.
 */
typedef struct least_squares {
    size_t n_parameters, n_residuals, max_evaluations;
    double stop_relative; /* of the residual norm */
    palp_status (*evaluate)(void *user, const double *p, double *r, double *jacobian);
    void *user;
    size_t n_constraints;
    const double *constraint; /* [n_constraints n_parameters] by rows, or NULL */
    const double *floor;      /* [n_constraints]: row . p >= floor */
} least_squares;

/* p[n_parameters] in: first guess, out: best found. *norm: |r|_2 there. *converged: stopped by
 * stop_relative. */
palp_status least_squares_solve(const least_squares *problem, double *p, double *norm, bool *converged);

/* Force of the fully relaxed network against depth, with its gradient by the law's coefficients. */
typedef struct force_curve {
    size_t n, capacity, n_parameters;
    double *depth, *force, *slope; /* [n]; slope dF/ddepth, N/m */
    double *gradient;              /* [n n_parameters], by rows */
    double *weight;                /* [n_elements] scratch */
} force_curve;

void force_curve_free(force_curve *curve);

/* Solves the network from rest to depth_max in steps chosen so that cubic interpolation of the force is
 * within tolerance times its peak; or at the given depths (n > 0). Stops early, with
 * ERR_NOT_CONVERGED or ERR_BUCKLED, at the last depth reached. */
palp_status force_curve_trace(force_curve *curve, palp_network *net, double depth_max, double tolerance);
palp_status force_curve_steps(force_curve *curve, palp_network *net, size_t n, const double *depth,
                              bool with_gradient);

/* Samples the curve at depth[n] (increasing): force[n] and, if not NULL, gradient by columns
 * [n_parameters n]. Beyond the last depth reached the force stays as it was there. */
void force_curve_sample(const force_curve *curve, size_t n, const double *depth, double *force, double *gradient);

/* What the fit of palp_calibrate_relaxation by NLOPT sees at its first guess: the weighted residual[n_samples],
 * samples of all targets one after the other, and its derivatives by columns [n_samples n_parameters] (room
 * for 1 + 4 PALP_ARMS_MAX columns): by the scale (if fitted), then K_j and log tau_j of each arm (tau held
 * while K varies), then beta and gamma (if fitted), one pair or one an arm. */
palp_status relaxation_linearize(palp_network *network, const palp_material *start, size_t n_targets,
                                 const palp_target *targets, const palp_relaxation_settings *settings,
                                 size_t *n_parameters, double *residual, double *jacobian);

/* Figure 5.21; see palp_calibrate_relaxation. */
palp_status calibrate_three_phase(palp_network *network, const palp_material *start, size_t n_targets,
                                  const palp_target *targets, const palp_relaxation_settings *settings,
                                  palp_calibration *result);

#endif
