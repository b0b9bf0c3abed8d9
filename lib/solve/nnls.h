/* nnls.h: least squares with unknowns that are not negative. Internal. */
#ifndef NNLS_H
#define NNLS_H

#include <palpate/status.h>
#include <stddef.h>

/* Minimises |a x - b| with x >= 0 (Lawson and Hanson 1974, chapter 23). Stops at |a x - b| <= tolerance |b|,
 * or when most unknowns are above 0, for a sparse x. a[rows n] by columns. *residual: |a x - b| / |b|
 * reached. */
palp_status nnls_solve(size_t rows, size_t n, const double *a, const double *b, double tolerance, size_t most,
                       double *x, double *residual);

#endif
