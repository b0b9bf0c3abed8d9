/* calibrate_internal.h: shared functions of the two stages of calibration. */
#ifndef CALIBRATE_INTERNAL_H
#define CALIBRATE_INTERNAL_H

#include <palpate/calibrate.h>

#include "network/network_internal.h"
#include "solve/least_squares.h"

/* Appends a copy of *iteration. */
palp_status calibration_add(palp_calibration *c, const palp_calibrate_iteration *iteration);

/* An iteration of a fit to n targets: the squares of its errors, and the weighted ones. */
palp_calibrate_iteration calibration_iteration(const palp_material *material, double squares, double weighted,
                                               size_t n);

/* Allocates the curve of n samples, and copies the target. */
palp_status calibration_set_target(palp_calibration *c, size_t n, const double *depth, const double *target);

/* Statuses of a missing equilibrium, which another material may have. */
bool calibration_lost(palp_status status);

/* Force of the fully relaxed network against depth, with its gradient by the law's coefficients. */
typedef struct force_curve {
    size_t n, capacity, n_parameters;
    double *depth, *force, *slope; /* [n]; slope dF/ddepth, N/m */
    double *gradient;              /* [n n_parameters], by rows */
    double *weight;                /* [n_elements] scratch */
    double strain_max;             /* largest |element strain| of its points */
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
void force_curve_sample(const force_curve *curve, size_t n, const double *depth, double *force,
                        double *gradient);

/* Rows row . coefficients > 0 of a law that stays positive: on a grid up to a strain, or at a spline's knots.
 * row[LAW_ROWS columns] by rows, of which the first law->n are filled; how many. */
enum { LAW_GRID = 48, LAW_ROWS = LAW_GRID + PALP_LAW_MAX };
size_t law_positive_rows(const palp_law *law, double reach, size_t columns, double *row);

/* The static stage: a law against a curve of force by depth. */
typedef struct static_stage {
    palp_network *net;
    const palp_material *start;
    const palp_static_settings *settings;
    size_t n;
    const double *depth, *target;
    double tolerance; /* of the curve */
    force_curve curve;
    double *force; /* [n] of the last run */
    palp_calibration *result;
} static_stage;

/* palp_calibrate_static by any solve: checks the arguments, runs it and fills *result, which is freed on an
 * error. */
palp_status static_stage_solve(palp_network *network, const palp_material *start, size_t n,
                               const double *depth_m, const double *target_N,
                               const palp_static_settings *settings, palp_calibration *result,
                               palp_status (*solve)(static_stage *));

/* Runs the curve of a material, with its gradient by the law's coefficients unless NULL, and stores it in the
 * result. A curve that ends early keeps its last force, so that the fit has a large residual. */
palp_status static_stage_run(static_stage *stage, const palp_material *material, double *gradient);

/* The first linearization of palp_calibrate_relaxation's fit: the weighted residual[n_samples], samples of
 * all targets one after the other, and its derivatives by columns [n_samples n_parameters] (room for 1 + 4
 * PALP_ARMS_MAX columns): by the scale (if fitted), then by K_j and log tau_j of each arm (with tau fixed
 * while K varies); last by beta and gamma (if fitted), one pair or one for each arm. */
palp_status relaxation_linearize(palp_network *network, const palp_material *start, size_t n_targets,
                                 const palp_target *targets, const palp_relaxation_settings *settings,
                                 size_t *n_parameters, double *residual, double *jacobian);

#endif
