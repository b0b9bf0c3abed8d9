/* dense.h: dense matrices by BLAS and LAPACK, the only place that calls them. Internal. Matrices are stored
 * by columns without gaps unless a leading dimension is given: A[m n] has element (i, j) at a[i + j m]. A
 * symmetric matrix is given whole or by its lower triangle in rows, a[i n + j] with j <= i. A Cholesky factor
 * L goes there too; what is above it is neither read nor written. Only dense_eigen and dense_polynomial
 * allocate memory. */
#ifndef DENSE_H
#define DENSE_H

#include <palpate/status.h>
#include <stdbool.h>
#include <stddef.h>

/* work[] has so many doubles for each row or column of a matrix, where a call needs it. */
enum { DENSE_WORK = 64 };

double dense_dot(size_t n, const double *a, const double *b);

/* ---- products ---- */

/* y[m] = alpha A x[n] + beta y, and y[n] = alpha A' x[m] + beta y; A[m n]. */
void dense_times(size_t m, size_t n, double alpha, const double *a, const double *x, double beta, double *y);
void dense_transposed_times(size_t m, size_t n, double alpha, const double *a, const double *x, double beta,
                            double *y);

/* C[m n] = A[m k] B[k n], and C[m n] = A' B with A[k m]. */
void dense_product(size_t m, size_t n, size_t k, const double *a, const double *b, double *c);
void dense_transposed_product(size_t m, size_t n, size_t k, const double *a, const double *b, double *c);

/* C[m n] += alpha A[m k] B', B[n k]; each with its leading dimension. */
void dense_add_outer(size_t m, size_t n, size_t k, double alpha, const double *a, size_t lda, const double *b,
                     size_t ldb, double *c, size_t ldc);

/* C[n n] += alpha A A' with A[n k]; C symmetric, given and got whole. */
void dense_add_square(size_t n, size_t k, double alpha, const double *a, double *c);

/* ---- triangles ---- */

/* A = L L', lower triangle in rows, in place. False if A is not positive definite; a is then overwritten. */
bool dense_cholesky(size_t n, double *a);
double dense_log_determinant(size_t n, const double *l); /* of L L' */

/* Solves L X = B, L' X = B and L L' X = B for the columns of b[n count], in place. */
void dense_forward(size_t n, const double *l, size_t count, double *b);
void dense_backward(size_t n, const double *l, size_t count, double *b);
void dense_cholesky_solve(size_t n, const double *l, size_t count, double *b);

/* A = L D L' of an indefinite A, lower triangle in rows, in place; pivot[n], work[DENSE_WORK n]. False if
 * singular. */
bool dense_ldl(size_t n, double *a, int *pivot, double *work);
void dense_ldl_solve(size_t n, const double *a, const int *pivot, size_t count, double *b);

/* L with L L' = A'A, lower triangle in rows and zeros above, by QR. A[m n], m >= n, is overwritten. tau[n],
 * work[DENSE_WORK n]. */
void dense_triangle_of(size_t m, size_t n, double *a, double *tau, double *work, double *l);

/* X L' = B for b[m n] in place; L[n n] by columns with 1 on its diagonal. Leading dimensions ldl and ldb. */
void dense_unit_solve_right(size_t m, size_t n, const double *l, size_t ldl, double *b, size_t ldb);

/* L x = b and L' x = b in place; L in LAPACK's band storage l[ld n], width rows below its unit diagonal. */
void dense_band_forward(size_t n, size_t width, const double *l, size_t ld, double *b);
void dense_band_backward(size_t n, size_t width, const double *l, size_t ld, double *b);

/* ---- functions that allocate ---- */

/* Eigenvalues of the whole symmetric matrix a[n n], ascending, into w[n]; eigenvectors into its columns, a[k
 * n]. ERR_NOT_CONVERGED. */
palp_status dense_eigen(size_t n, double *a, double *w);

/* Least squares of y[n] on x^low ... x^high: coefficient[high - low + 1] by ascending powers, *norm the
 * length of the residual. ERR_INPUT: fewer points than coefficients, or every x is 0; ERR_SINGULAR. */
palp_status dense_polynomial(size_t n, const double *x, const double *y, size_t low, size_t high,
                             double *coefficient, double *norm);

#endif
