/* levenberg.h: least squares within bounds by Levenberg and Marquardt, from normal matrices. Internal.
 * For residuals r(x) with the Jacobian J: chi2 = r'r, g = -J'r (minus half its gradient), h = J'J, by rows.
 */
#ifndef LEVENBERG_H
#define LEVENBERG_H

#include <palpate/status.h>
#include <stdbool.h>
#include <stddef.h>

/* What must hold of x: row[n count], one condition after the other, times x is at least least[count]. */
typedef struct levenberg_walls {
    size_t count;
    double *row, *least;
} levenberg_walls;

typedef struct levenberg {
    size_t n, evaluations;        /* coordinates; of evaluate, at most */
    const double *low, *high;     /* [n] bounds */
    const levenberg_walls *walls; /* NULL: there are none */
    const double *reach;          /* [n] the longest step of a coordinate */
    /* It ends when an evaluation lowers chi2 by less than stop_absolute + stop_relative chi2, or raises it by
     * less than stop_rise. */
    double stop_absolute, stop_relative, stop_rise;
    /* h[n n], g[n] and chi2 at x[n]. ERR_NO_MEMORY ends the search; another error says that x is no solution,
     * and a shorter step is tried. */
    palp_status (*evaluate)(void *user, const double *x, double *h, double *g, double *chi2);
    void (*keep)(void *user); /* the x evaluated last is the best so far */
    void *user;
} levenberg;

/* step[n] of (h + damping diag h) step = g without the coordinates of x that lie on a bound and are pushed
 * beyond it; 0 and false if the matrix is singular. work: [n n], the matrix' Cholesky factor. */
bool levenberg_step(size_t n, const double *x, const double *low, const double *high, const double *h,
                    const double *g, double damping, double *work, double *step);

/* A step whose matrix has that factor, to the best one by the same matrix that ends within the walls: it goes
 * along those that it would cross. */
palp_status levenberg_confine(size_t n, const levenberg_walls *walls, const double *x, const double *factor,
                              double *step);

/* x, h, g and chi2 in: at the first guess, which lies within the bounds; out: at the best x found. */
palp_status levenberg_solve(const levenberg *problem, double *x, double *h, double *g, double *chi2);

#endif
