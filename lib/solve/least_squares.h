/* least_squares.h: nonlinear least squares with linear constraints. Internal. */
#ifndef LEAST_SQUARES_H
#define LEAST_SQUARES_H

#include <palpate/status.h>
#include <stdbool.h>
#include <stddef.h>

/* Least squares by NLopt: minimises |r(p)|_2^2 / 2, r[n_residuals], over n_parameters. evaluate fills r
 * and, unless NULL, the Jacobian by columns, jacobian[k n_residuals + i] = dr_i / dp_k. */
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

#endif
