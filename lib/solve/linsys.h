/* linsys.h: symmetric sparse systems behind one door: factor, inertia, solve. Internal.
 * The pattern is the lower triangle by columns, rows ascending, diagonal first. Values are written
 * straight into the solver's own storage through linsys_slot. */
#ifndef LINSYS_H
#define LINSYS_H

#include <palpate/network.h>

typedef struct linsys linsys;

/* What a solver gives: one table a solver, one linsys.c that picks. */
typedef struct linsys_ops {
    palp_status (*factor)(void *self, int *negative);
    void (*begin)(void *self);                                                   /* or NULL, */
    palp_status (*advance)(void *self, double flops, int *negative, bool *done); /* like this */
    void (*solve)(void *self, double *b);
    size_t (*slot)(const void *self, size_t row, size_t column); /* row >= column */
    void (*destroy)(void *self);
} linsys_ops;

/* Analyses the pattern and allocates all that factor and solve need. */
palp_status linsys_create(palp_solver solver, size_t n, const size_t *column, const int32_t *row, linsys **out);
void linsys_free(linsys *ls);

double *linsys_values(linsys *ls);
size_t linsys_value_count(const linsys *ls); /* value slots; one more may be written as a bin */
size_t linsys_slot(const linsys *ls, size_t row, size_t column);
double linsys_flops(const linsys *ls);       /* of one factorization, estimated */

/* Factors the values (and may destroy them). *negative: number of negative pivots (Sylvester).
 * ERR_SINGULAR: a pivot that is not finite, or so small beside the largest that it is rounding. */
palp_status linsys_factor(linsys *ls, int *negative);
void linsys_solve(linsys *ls, double *b); /* b[n] in, solution out */

/* A factor in parts: begin, then advance by at least so many flops (a solver that cannot stop does it all) until
 * *done; status and *negative then as linsys_factor. */
void linsys_begin(linsys *ls);
palp_status linsys_advance(linsys *ls, double flops, int *negative, bool *done);

/* Makers, one a solver; *values has *count + 1 entries and belongs to self. */
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
/* The verdict on a factor: OK if no pivot is lost in the rounding of the largest one. */
palp_status linsys_judge(double smallest, double largest);

/* Position of every unknown in the numbering of reverse Cuthill-McKee (linsys_order.c). */
palp_status linsys_order(size_t n, const size_t *column, const int32_t *row, int32_t *position);

/* Seconds a factorization is expected to take, to choose by. */
palp_status linsys_band_cost(size_t n, const size_t *column, const int32_t *row, double *cost);

#endif
