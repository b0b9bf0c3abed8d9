/* levenberg.h: least squares within bounds by Levenberg and Marquardt, from normal matrices. Internal. For
 * residuals r(x) with the Jacobian J: chi2 = r'r, g = -J'r (minus half its gradient), h = J'J, by rows. */
#ifndef LEVENBERG_H
#define LEVENBERG_H

#include <palpate/status.h>
#include <stdbool.h>
#include <stddef.h>

typedef struct levenberg {
    size_t n, evaluations;    /* number of coordinates; limit of evaluations */
    const double *low, *high; /* [n] bounds */
    const double *reach;      /* [n] the longest step of a coordinate */
    /* The search ends when an evaluation lowers chi2 by less than stop_absolute + stop_relative chi2, or
     * raises it by less than stop_rise. It ends before an evaluation that is expected to lower chi2 by less
     * than stop_expected. */
    double stop_absolute, stop_relative, stop_rise, stop_expected;
    /* h[n n], g[n] and chi2 at x[n]. ERR_NO_MEMORY ends the search; after any other error a shorter step is
     * tried. */
    palp_status (*evaluate)(void *user, const double *x, double *h, double *g, double *chi2);
    void (*keep)(void *user); /* called when the x evaluated last is the best so far */
    void *user;
} levenberg;

/* Solves (h + damping diag h) step = g, step[n]. Coordinates of x at a bound that would leave it have step 0.
 * False and 0 if the matrix is singular. work[n n] becomes the Cholesky factor. */
bool levenberg_step(size_t n, const double *x, const double *low, const double *high, const double *h,
                    const double *g, double damping, double *work, double *step);

/* In: x, a first guess within the bounds, with its h, g and chi2. Out: the best x found, with its own. */
palp_status levenberg_solve(const levenberg *problem, double *x, double *h, double *g, double *chi2);

#endif
