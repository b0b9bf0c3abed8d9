/* fit_spread.h: a random-effects estimate: the mean of specimens' parameters and their scatter. Specimen i
 * has the parameters x_i, which its own runs give with a covariance V_i. x_i is normal about the mean with
 * the covariance "between". It is found by restricted maximum likelihood with the EM algorithm (Laird and
 * Ware 1982), started at the sample covariance. Only directions count in which specimens differ by more than
 * chance would in one case of twenty: the largest root of a Wishart matrix (Johnstone 2001). Internal. */
#ifndef FIT_SPREAD_H
#define FIT_SPREAD_H

#include <palpate/status.h>
#include <stddef.h>

typedef struct fit_spread {
    size_t n, n_specimens;
    const double *x, *v;      /* [n_specimens n], [n_specimens n n], caller's */
    double *mean;             /* [n] caller's, as are the others, [n n] */
    double *mean_covariance;  /* of the mean */
    double *between, *within; /* within: V of a specimen, as the harmonic mean of all */
    size_t n_directions;      /* in which specimens differ; 0: between is 0 */
} fit_spread;

/* ERR_SINGULAR: no specimen determines a direction. */
palp_status fit_spread_find(fit_spread *spread);

#endif
