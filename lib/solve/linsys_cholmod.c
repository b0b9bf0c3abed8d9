/* linsys_cholmod.c: CHOLMOD as a linsys solver: simplicial L D L' (LGPL). With PALP_GPL supernodal L L', and
 * the simplicial factor where the matrix is indefinite. The fill-reducing permutation is applied here once,
 * so that CHOLMOD need not copy the matrix. */
#include "linsys_solver.h"

#include <cholmod.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct solver {
    cholmod_common common;
    bool started, supernodal, is_super; /* is_super: the last factor was L L' */
    size_t n;
    int32_t *position; /* [n] row of the caller -> row of the permuted matrix */
    cholmod_sparse *matrix;
    cholmod_factor *simplicial, *super;
    double *work; /* [n] permuted right-hand side */
    double *values;
} solver;

/* Simplicial takes the upper triangle without a copy, supernodal the lower one. */
static void permuted_row_and_column(const solver *s, size_t row, size_t column, size_t *r, size_t *c) {
    size_t a = (size_t)s->position[row], b = (size_t)s->position[column];
    size_t low = a < b ? a : b, high = a < b ? b : a;
    *r = s->supernodal ? high : low;
    *c = s->supernodal ? low : high;
}

static size_t find_matrix_value_slot(const void *self, size_t row, size_t column) {
    const solver *s = self;
    const int *p = s->matrix->p, *rows = s->matrix->i;
    size_t r, c;
    permuted_row_and_column(s, row, column, &r, &c);
    int low = p[c], high = p[c + 1] - 1;
    while (low < high) {
        int middle = low + (high - low) / 2;
        if ((size_t)rows[middle] < r)
            low = middle + 1;
        else
            high = middle;
    }
    return (size_t)low;
}

static void destroy_sparse_solver(void *self) {
    solver *s = self;
    if (s->started) {
        cholmod_free_factor(&s->simplicial, &s->common);
        cholmod_free_factor(&s->super, &s->common);
        if (s->matrix)
            s->matrix->x = NULL; /* allocated here, not by CHOLMOD */
        cholmod_free_sparse(&s->matrix, &s->common);
        cholmod_finish(&s->common);
    }
    free(s->position);
    free(s->work);
    free(s->values);
    free(s);
}

static palp_status find_pivot_extremes(const cholmod_factor *factor, linsys_pivots *pivots) {
    const int *p = factor->p;
    const double *x = factor->x;
    *pivots = (linsys_pivots){0, INFINITY, 0.0};
    for (size_t j = 0; j < factor->n; j++) {
        double pivot = x[p[j]];
        if (!isfinite(pivot) || pivot == 0.0)
            return PALP_ERR_SINGULAR;
        pivots->negative += pivot < 0.0;
        pivots->least = fmin(pivots->least, fabs(pivot));
        pivots->largest = fmax(pivots->largest, fabs(pivot));
    }
    return factor->minor == factor->n ? PALP_OK : PALP_ERR_SINGULAR;
}

static palp_status factor_simplicial(solver *s, linsys_pivots *pivots) {
    if (!cholmod_factorize(s->matrix, s->simplicial, &s->common) && s->common.status < CHOLMOD_OK)
        return s->common.status == CHOLMOD_OUT_OF_MEMORY ? PALP_ERR_NO_MEMORY : PALP_ERR_SINGULAR;
    return find_pivot_extremes(s->simplicial, pivots);
}

static palp_status factor_sparse_matrix(void *self, linsys_pivots *pivots) {
    solver *s = self;
    s->is_super = false;
    if (s->supernodal) {
        cholmod_factorize(s->matrix, s->super, &s->common);
        if (s->common.status == CHOLMOD_OK) {
            s->is_super = true;
            *pivots = (linsys_pivots){0, cholmod_rcond(s->super, &s->common), 1.0};
            return PALP_OK;
        }
        if (s->common.status == CHOLMOD_OUT_OF_MEMORY)
            return PALP_ERR_NO_MEMORY;
    }
    return factor_simplicial(s, pivots);
}

static void solve_with_simplicial(const cholmod_factor *factor, double *x) {
    const int *p = factor->p, *i = factor->i, *nz = factor->nz;
    const double *l = factor->x;
    for (size_t j = 0; j < factor->n; j++)
        for (int k = p[j] + 1; k < p[j] + nz[j]; k++)
            x[i[k]] -= l[k] * x[j];
    for (size_t j = factor->n; j-- > 0;) {
        double sum = x[j] / l[p[j]];
        for (int k = p[j] + 1; k < p[j] + nz[j]; k++)
            sum -= l[k] * x[i[k]];
        x[j] = sum;
    }
}

static void solve_with_supernodes(solver *s) {
#ifdef PALP_GPL
    cholmod_dense b = {.nrow = s->n,
                       .ncol = 1,
                       .nzmax = s->n,
                       .d = s->n,
                       .x = s->work,
                       .xtype = CHOLMOD_REAL,
                       .dtype = CHOLMOD_DOUBLE};
    cholmod_dense *x = cholmod_solve(CHOLMOD_LDLt, s->super, &b, &s->common);
    if (x) {
        memcpy(s->work, x->x, s->n * sizeof *s->work);
        cholmod_free_dense(&x, &s->common);
    }
#else
    (void)s;
#endif
}

static void solve_sparse_system(void *self, double *b) {
    solver *s = self;
    for (size_t i = 0; i < s->n; i++)
        s->work[s->position[i]] = b[i];
    if (s->is_super)
        solve_with_supernodes(s);
    else
        solve_with_simplicial(s->simplicial, s->work);
    for (size_t i = 0; i < s->n; i++)
        b[i] = s->work[s->position[i]];
}

static const linsys_ops SOLVER_OPS = {
    factor_sparse_matrix, NULL, NULL, solve_sparse_system, find_matrix_value_slot, destroy_sparse_solver};

/* Builds s->matrix: the permuted pattern, rows ascending in every column. */
static palp_status build_permuted_pattern(solver *s, const size_t *column, const int32_t *row) {
    size_t nz = column[s->n];
    s->matrix =
        cholmod_allocate_sparse(s->n, s->n, nz, 1, 1, s->supernodal ? -1 : 1, CHOLMOD_PATTERN, &s->common);
    cholmod_triplet *t =
        cholmod_allocate_triplet(s->n, s->n, nz, s->supernodal ? -1 : 1, CHOLMOD_PATTERN, &s->common);
    if (!s->matrix || !t) {
        cholmod_free_triplet(&t, &s->common);
        return PALP_ERR_NO_MEMORY;
    }
    for (size_t c = 0; c < s->n; c++)
        for (size_t k = column[c]; k < column[c + 1]; k++) {
            size_t i, j;
            permuted_row_and_column(s, (size_t)row[k], c, &i, &j);
            ((int *)t->i)[k] = (int)i;
            ((int *)t->j)[k] = (int)j;
        }
    t->nnz = nz;
    cholmod_free_sparse(&s->matrix, &s->common);
    s->matrix = cholmod_triplet_to_sparse(t, nz, &s->common);
    cholmod_free_triplet(&t, &s->common);
    if (!s->matrix || !cholmod_sort(s->matrix, &s->common))
        return PALP_ERR_NO_MEMORY;
    return PALP_OK;
}

static cholmod_factor *analyze_sparse_pattern(solver *s, int ordering, int supernodal) {
    s->common.nmethods = 1;
    s->common.method[0].ordering = ordering;
    s->common.postorder = ordering != CHOLMOD_NATURAL;
    s->common.supernodal = supernodal;
    return cholmod_analyze(s->matrix, &s->common);
}

/* Finds the permutation of the natural pattern and builds the permuted matrix. */
static palp_status find_fill_reducing_order(solver *s, const size_t *column, const int32_t *row) {
    for (size_t i = 0; i < s->n; i++)
        s->position[i] = (int32_t)i;
    palp_status status = build_permuted_pattern(s, column, row);
    if (status)
        return status;
    cholmod_factor *f =
        analyze_sparse_pattern(s, CHOLMOD_AMD, s->supernodal ? CHOLMOD_SUPERNODAL : CHOLMOD_SIMPLICIAL);
    if (!f)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < s->n; i++)
        s->position[((int *)f->Perm)[i]] = (int32_t)i;
    cholmod_free_factor(&f, &s->common);
    cholmod_free_sparse(&s->matrix, &s->common);
    return build_permuted_pattern(s, column, row);
}

static palp_status prepare_sparse_solver(solver *s, const size_t *column, const int32_t *row) {
    size_t nz = column[s->n];
    s->position = malloc((s->n + 1) * sizeof *s->position);
    s->work = malloc((s->n + 1) * sizeof *s->work);
    s->values = calloc(nz + 1, sizeof *s->values);
    if (!s->position || !s->work || !s->values)
        return PALP_ERR_NO_MEMORY;
    palp_status status = find_fill_reducing_order(s, column, row);
    if (status)
        return status;
    s->matrix->x = s->values;
    s->matrix->xtype = CHOLMOD_REAL;
    if (s->supernodal && !(s->super = analyze_sparse_pattern(s, CHOLMOD_NATURAL, CHOLMOD_SUPERNODAL)))
        return PALP_ERR_NO_MEMORY;
    s->simplicial = analyze_sparse_pattern(s, CHOLMOD_NATURAL, CHOLMOD_SIMPLICIAL);
    return s->simplicial ? PALP_OK : PALP_ERR_NO_MEMORY;
}

palp_status linsys_cholmod_make(bool supernodal, size_t n, const size_t *column, const int32_t *row,
                                linsys_made *made) {
#ifndef PALP_GPL
    if (supernodal)
        return PALP_ERR_UNSUPPORTED;
#endif
    if (column[n] > INT_MAX)
        return PALP_ERR_LIMIT;
    solver *s = calloc(1, sizeof *s);
    if (!s)
        return PALP_ERR_NO_MEMORY;
    s->n = n;
    s->supernodal = supernodal;
    s->started = cholmod_start(&s->common);
    s->common.print = 0;
    s->common.final_ll = 0;
    s->common.quick_return_if_not_posdef = supernodal;
    palp_status status = s->started ? prepare_sparse_solver(s, column, row) : PALP_ERR_NO_MEMORY;
    if (status) {
        destroy_sparse_solver(s);
        return status;
    }
    *made = (linsys_made){s, &SOLVER_OPS, s->values, column[n], s->common.fl};
    return PALP_OK;
}
