/* linsys_solver.h: the interface of a solver behind linsys.h. Internal. */
#ifndef LINSYS_SOLVER_H
#define LINSYS_SOLVER_H

#include <palpate/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Pivots of a factor: the number of negative ones, and the least and largest absolute value, or those of
 * their inverses. */
typedef struct linsys_pivots {
    int negative;
    double least, largest;
} linsys_pivots;

/* ERR_SINGULAR: a pivot is 0 or not finite. begin and advance may be NULL. */
typedef struct linsys_ops {
    palp_status (*factor)(void *self, linsys_pivots *pivots);
    void (*begin)(void *self);
    palp_status (*advance)(void *self, double flops, linsys_pivots *pivots,
                           bool *done); /* pivots: set when done */
    void (*solve)(void *self, double *b);
    size_t (*slot)(const void *self, size_t row, size_t column); /* row >= column */
    void (*destroy)(void *self);
} linsys_ops;

/* Constructors of the solvers; *values has *count + 1 entries and belongs to self. */
typedef struct linsys_made {
    void *self;
    const linsys_ops *ops;
    double *values;
    size_t count;
    double flops;
} linsys_made;
palp_status linsys_band_make(size_t n, const size_t *column, const int32_t *row, linsys_made *made);
palp_status linsys_cholmod_make(bool supernodal, size_t n, const size_t *column, const int32_t *row,
                                linsys_made *made);

/* Position of every unknown in the numbering of reverse Cuthill-McKee (linsys_order.c). */
palp_status linsys_order(size_t n, const size_t *column, const int32_t *row, int32_t *position);

/* Expected seconds of a factorization by bands, to choose a solver. */
palp_status linsys_band_cost(size_t n, const size_t *column, const int32_t *row, double *cost);

#endif
