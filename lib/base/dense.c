/* dense.c: see dense.h. */
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Fortran routines. Compilers append lengths of character arguments, which are not read. */
void dsyrk_(const char *uplo, const char *ta, const int *n, const int *k, const double *alpha,
            const double *a, const int *lda, const double *beta, double *c, const int *ldc);
void dgemm_(const char *ta, const char *tb, const int *m, const int *n, const int *k, const double *alpha,
            const double *a, const int *lda, const double *b, const int *ldb, const double *beta, double *c,
            const int *ldc);
void dgemv_(const char *ta, const int *m, const int *n, const double *alpha, const double *a, const int *lda,
            const double *x, const int *incx, const double *beta, double *y, const int *incy);
void dtrsm_(const char *side, const char *uplo, const char *ta, const char *diag, const int *m, const int *n,
            const double *alpha, const double *a, const int *lda, double *b, const int *ldb);
void dtbsv_(const char *uplo, const char *ta, const char *diag, const int *n, const int *k, const double *a,
            const int *lda, double *x, const int *incx);
void dgeqrf_(const int *m, const int *n, double *a, const int *lda, double *tau, double *work,
             const int *lwork, int *info);
void dgels_(const char *trans, const int *m, const int *n, const int *nrhs, double *a, const int *lda,
            double *b, const int *ldb, double *work, const int *lwork, int *info);
void dsyev_(const char *job, const char *uplo, const int *n, double *a, const int *lda, double *w,
            double *work, const int *lwork, int *info);
void dpotrf_(const char *uplo, const int *n, double *a, const int *lda, int *info);
void dsytrf_(const char *uplo, const int *n, double *a, const int *lda, int *pivot, double *work,
             const int *lwork, int *info);
void dsytrs_(const char *uplo, const int *n, const int *nrhs, const double *a, const int *lda,
             const int *pivot, double *b, const int *ldb, int *info);

static const int UNIT = 1;
static const double ONE = 1.0, ZERO = 0.0;

/* A leading dimension: BLAS takes none below 1. */
static int leading_dimension_for(size_t rows) {
    return rows > 0 ? (int)rows : 1;
}

double dense_dot(size_t n, const double *a, const double *b) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* With no columns BLAS returns at once and leaves y unchanged. */
static void multiply_matrix_vector(const char *transposed, size_t m, size_t n, double alpha, const double *a,
                                   const double *x, double beta, double *y) {
    const int rows = (int)m, columns = (int)n, ld = leading_dimension_for(m);
    size_t summed = *transposed == 'T' ? m : n, length = *transposed == 'T' ? n : m;
    if (summed > 0)
        dgemv_(transposed, &rows, &columns, &alpha, a, &ld, x, &UNIT, &beta, y, &UNIT);
    else
        for (size_t i = 0; i < length; i++)
            y[i] = beta == 0.0 ? 0.0 : beta * y[i];
}

void dense_times(size_t m, size_t n, double alpha, const double *a, const double *x, double beta, double *y) {
    multiply_matrix_vector("N", m, n, alpha, a, x, beta, y);
}

void dense_transposed_times(size_t m, size_t n, double alpha, const double *a, const double *x, double beta,
                            double *y) {
    multiply_matrix_vector("T", m, n, alpha, a, x, beta, y);
}

void dense_product(size_t m, size_t n, size_t k, const double *a, const double *b, double *c) {
    const int rows = (int)m, columns = (int)n, depth = (int)k, lda = leading_dimension_for(m),
              ldb = leading_dimension_for(k);
    dgemm_("N", "N", &rows, &columns, &depth, &ONE, a, &lda, b, &ldb, &ZERO, c, &lda);
}

void dense_transposed_product(size_t m, size_t n, size_t k, const double *a, const double *b, double *c) {
    const int rows = (int)m, columns = (int)n, depth = (int)k, ld = leading_dimension_for(k),
              ldc = leading_dimension_for(m);
    dgemm_("T", "N", &rows, &columns, &depth, &ONE, a, &ld, b, &ld, &ZERO, c, &ldc);
}

void dense_add_outer(size_t m, size_t n, size_t k, double alpha, const double *a, size_t lda, const double *b,
                     size_t ldb, double *c, size_t ldc) {
    const int rows = (int)m, columns = (int)n, depth = (int)k, ld_a = (int)lda, ld_b = (int)ldb,
              ld_c = (int)ldc;
    dgemm_("N", "T", &rows, &columns, &depth, &alpha, a, &ld_a, b, &ld_b, &ONE, c, &ld_c);
}

/* The triangle that dsyrk_ writes is copied to the other. */
void dense_add_square(size_t n, size_t k, double alpha, const double *a, double *c) {
    const int order = (int)n, depth = (int)k, ld = leading_dimension_for(n);
    dsyrk_("L", "N", &order, &depth, &alpha, a, &ld, &ONE, c, &ld);
    for (size_t j = 0; j < n; j++)
        for (size_t i = 0; i < j; i++)
            c[j * n + i] = c[i * n + j];
}

/* A lower triangle in rows is LAPACK's upper triangle by columns. */
bool dense_cholesky(size_t n, double *a) {
    const int order = (int)n, ld = leading_dimension_for(n);
    int info = 0;
    dpotrf_("U", &order, a, &ld, &info);
    return info == 0;
}

double dense_log_determinant(size_t n, const double *l) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += 2.0 * log(l[i * n + i]);
    return sum;
}

void dense_forward(size_t n, const double *l, size_t count, double *b) {
    const int order = (int)n, columns = (int)count, ld = leading_dimension_for(n);
    dtrsm_("L", "U", "T", "N", &order, &columns, &ONE, l, &ld, b, &ld);
}

void dense_backward(size_t n, const double *l, size_t count, double *b) {
    const int order = (int)n, columns = (int)count, ld = leading_dimension_for(n);
    dtrsm_("L", "U", "N", "N", &order, &columns, &ONE, l, &ld, b, &ld);
}

void dense_cholesky_solve(size_t n, const double *l, size_t count, double *b) {
    dense_forward(n, l, count, b);
    dense_backward(n, l, count, b);
}

bool dense_ldl(size_t n, double *a, int *pivot, double *work) {
    const int order = (int)n, ld = leading_dimension_for(n), room = DENSE_WORK * ld;
    int info = 0;
    dsytrf_("U", &order, a, &ld, pivot, work, &room, &info);
    return info == 0;
}

void dense_ldl_solve(size_t n, const double *a, const int *pivot, size_t count, double *b) {
    const int order = (int)n, columns = (int)count, ld = leading_dimension_for(n);
    int info = 0;
    dsytrs_("U", &order, &columns, a, &ld, pivot, b, &ld, &info);
}

void dense_triangle_of(size_t m, size_t n, double *a, double *tau, double *work, double *l) {
    const int rows = (int)m, columns = (int)n, ld = leading_dimension_for(m), room = DENSE_WORK * (int)n;
    int info = 0;
    dgeqrf_(&rows, &columns, a, &ld, tau, work, &room, &info);
    memset(l, 0, n * n * sizeof *l);
    for (size_t i = 0; i < n; i++)
        memcpy(l + i * n, a + i * m, (i + 1) * sizeof *l);
}

void dense_unit_solve_right(size_t m, size_t n, const double *l, size_t ldl, double *b, size_t ldb) {
    const int rows = (int)m, columns = (int)n, ld_l = (int)ldl, ld_b = (int)ldb;
    dtrsm_("R", "L", "T", "U", &rows, &columns, &ONE, l, &ld_l, b, &ld_b);
}

void dense_band_forward(size_t n, size_t width, const double *l, size_t ld, double *b) {
    const int order = (int)n, below = (int)width, ld_l = (int)ld;
    dtbsv_("L", "N", "U", &order, &below, l, &ld_l, b, &UNIT);
}

void dense_band_backward(size_t n, size_t width, const double *l, size_t ld, double *b) {
    const int order = (int)n, below = (int)width, ld_l = (int)ld;
    dtbsv_("L", "T", "U", &order, &below, l, &ld_l, b, &UNIT);
}

palp_status dense_eigen(size_t n, double *a, double *w) {
    const int order = (int)n, ld = leading_dimension_for(n), room = (int)(34 * n + 1);
    int info = 0;
    double *work = malloc((size_t)room * sizeof *work);
    if (!work)
        return PALP_ERR_NO_MEMORY;
    dsyev_("V", "L", &order, a, &ld, w, work, &room, &info);
    free(work);
    return info ? PALP_ERR_NOT_CONVERGED : PALP_OK;
}

/* Least squares A x = b by QR; b begins with x, followed by the residual. */
static palp_status least_squares_in_place(size_t m, size_t n, double *a, double *b) {
    const int rows = (int)m, columns = (int)n, room = DENSE_WORK * (int)n;
    int info = 0;
    double *work = malloc((size_t)room * sizeof *work);
    if (!work)
        return PALP_ERR_NO_MEMORY;
    dgels_("N", &rows, &columns, &UNIT, a, &rows, b, &rows, work, &room, &info);
    free(work);
    return info ? PALP_ERR_SINGULAR : PALP_OK;
}

palp_status dense_polynomial(size_t n, const double *x, const double *y, size_t low, size_t high,
                             double *coefficient, double *norm) {
    size_t columns = high - low + 1;
    double top = 0.0;
    for (size_t i = 0; i < n; i++)
        top = fmax(top, fabs(x[i]));
    if (n < columns || top == 0.0)
        return PALP_ERR_INPUT;
    double *a = malloc(n * (columns + 1) * sizeof *a), *b = a + n * columns;
    if (!a)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n; i++) {
        double t = x[i] / top, power = pow(t, (double)low);
        for (size_t k = 0; k < columns; k++) {
            a[k * n + i] = power;
            power *= t;
        }
    }
    memcpy(b, y, n * sizeof *b);
    palp_status status = least_squares_in_place(n, columns, a, b);
    for (size_t k = 0; k < columns && !status; k++)
        coefficient[k] = b[k] / pow(top, (double)(low + k));
    *norm = sqrt(dense_dot(n - columns, b + columns, b + columns));
    free(a);
    return status;
}
