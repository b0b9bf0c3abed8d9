/* linsys.h: symmetric sparse systems behind one door: factor, inertia, solve. Internal.
 * The pattern is the lower triangle by columns, rows ascending, diagonal first. Values are written
 * straight into the solver's own storage through linsys_slot. */
#ifndef LINSYS_H
#define LINSYS_H

#include <palpate/solver.h>
#include <palpate/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct linsys linsys;

/* Analyses the pattern and allocates all that factor and solve need. */
palp_status linsys_create(palp_solver solver, size_t n, const size_t *column, const int32_t *row,
                          linsys **out);
void linsys_free(linsys *ls);

double *linsys_values(linsys *ls);
size_t linsys_value_count(const linsys *ls); /* value slots; one more may be written as a bin */
size_t linsys_slot(const linsys *ls, size_t row, size_t column);
double linsys_flops(const linsys *ls); /* of one factorization, estimated */

/* Factors the values (and may destroy them). *negative: number of negative pivots (Sylvester).
 * ERR_SINGULAR: a pivot that is not finite, or so small beside the largest that it is rounding. */
palp_status linsys_factor(linsys *ls, int *negative);
void linsys_solve(linsys *ls, double *b); /* b[n] in, solution out */

/* A factor in parts: begin, then advance by at least so many flops (a solver that cannot stop does it all)
 * until *done; status and *negative then as linsys_factor. */
void linsys_begin(linsys *ls);
palp_status linsys_advance(linsys *ls, double flops, int *negative, bool *done);

#endif
