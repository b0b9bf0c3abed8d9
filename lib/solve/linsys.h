/* linsys.h: one interface to solvers of symmetric sparse systems: factor, inertia, solve. Internal. The
 * pattern is the lower triangle by columns, rows ascending, diagonal first. Values are written straight into
 * the solver's own storage through linsys_slot. */
#ifndef LINSYS_H
#define LINSYS_H

#include <palpate/solver.h>
#include <palpate/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct linsys linsys;

/* Analyses the pattern and allocates all memory of factor and solve. */
palp_status linsys_create(palp_solver solver, size_t n, const size_t *column, const int32_t *row,
                          linsys **out);
void linsys_free(linsys *ls);

double *linsys_values(linsys *ls);
size_t linsys_value_count(const linsys *ls); /* value slots; one more may be written, which is ignored */
size_t linsys_slot(const linsys *ls, size_t row, size_t column);
double linsys_flops(const linsys *ls); /* of one factorization, an estimate */

/* Factors the values and may overwrite them. *negative: number of negative pivots (Sylvester). ERR_SINGULAR:
 * a pivot is not finite, or rounding compared with the largest. */
palp_status linsys_factor(linsys *ls, int *negative);
void linsys_solve(linsys *ls, double *b); /* b[n] in, solution out */

/* A factorization in parts: begin, then advance by at least so many flops until *done. A solver that cannot
 * be interrupted does all at once. Status and *negative are then those of linsys_factor. */
void linsys_begin(linsys *ls);
palp_status linsys_advance(linsys *ls, double flops, int *negative, bool *done);

#endif
