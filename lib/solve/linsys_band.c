/* linsys_band.c: band L D L' without pivoting, blocked on BLAS. Indefinite matrices are factored too, so
 * every factor gives the inertia. */
#include "base/arena.h"
#include "base/dense.h"
#include "linsys_solver.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 24, INNER = 16, SMALL_BAND = 40 };

/* Entry (i, j) of the lower triangle is at value[i + j stride]. This is LAPACK's band storage of leading
 * dimension stride + 1, or a dense matrix of leading dimension stride of which only the band is used. stride
 * = band + 2 BLOCK leaves room for whole blocks. What a block update writes above the diagonal goes behind
 * the band. */
typedef struct band {
    arena memory; /* of all but position */
    size_t n, width, stride;
    double *value;
    double *panel;     /* [width BLOCK] */
    double *inverse;   /* [n] 1 / D */
    int32_t *position; /* [n] place of each unknown in a narrower numbering, or NULL */
    double *work;      /* [n] right-hand side in that numbering */
    size_t at;         /* columns factored so far, if in parts */
    int negative;      /* negative pivots in these */
} band;

static size_t find_band_width(size_t n, const size_t *column, const int32_t *row, const int32_t *position) {
    int32_t width = 0;
    for (size_t j = 0; j < n; j++)
        for (size_t k = column[j]; k < column[j + 1]; k++) {
            int32_t d = position ? position[row[k]] - position[j] : row[k] - (int32_t)j;
            d = d < 0 ? -d : d;
            width = d > width ? d : width;
        }
    return (size_t)width;
}

/* Chooses the narrower of natural numbering (*position NULL) and reverse Cuthill-McKee. */
static palp_status choose_narrower_numbering(size_t n, const size_t *column, const int32_t *row,
                                             int32_t **position, size_t *width) {
    int32_t *p = malloc((n + 1) * sizeof *p);
    palp_status status = p ? linsys_order(n, column, row, p) : PALP_ERR_NO_MEMORY;
    *position = NULL;
    if (!status) {
        size_t natural = find_band_width(n, column, row, NULL);
        *width = find_band_width(n, column, row, p);
        if (*width < natural) {
            *position = p;
            return PALP_OK;
        }
        *width = natural;
    }
    free(p);
    return status;
}

/* The rate is fitted to times on one core: 10 Gflop/s for narrow bands, up to 50 for wide ones. */
palp_status linsys_band_cost(size_t n, const size_t *column, const int32_t *row, double *cost) {
    int32_t *position;
    size_t width;
    palp_status status = choose_narrower_numbering(n, column, row, &position, &width);
    if (!status) {
        double w = (double)width;
        *cost = (double)n * (w + 1.0) * (w + 80.0) / 50e9;
        free(position);
    }
    return status;
}

/* Right-looking L D L' of n columns with at most width rows below the diagonal; a[i + j ld]. */
static bool factor_band_unblocked(double *a, size_t ld, size_t n, size_t width, double *inverse,
                                  int *negative) {
    for (size_t j = 0; j < n; j++) {
        double *col = a + j * ld, pivot = col[j];
        size_t end = j + width < n - 1 ? j + width : n - 1;
        if (!isfinite(pivot) || pivot == 0.0)
            return false;
        *negative += pivot < 0.0;
        inverse[j] = 1.0 / pivot;
        for (size_t k = j + 1; k <= end; k++) {
            double l = col[k] * inverse[j], *target = a + k * ld;
            if (l == 0.0)
                continue;
            for (size_t i = k; i <= end; i++)
                target[i] -= l * col[i];
        }
        for (size_t i = j + 1; i <= end; i++)
            col[i] *= inverse[j];
    }
    return true;
}

/* The rows below a factored diagonal block of n columns: panel keeps L D, a gets L. */
static void solve_rows_below_block(double *a, size_t ld, size_t n, size_t rows, const double *diagonal,
                                   const double *inverse, double *panel) {
    dense_unit_solve_right(rows, n, diagonal, ld, a, ld);
    for (size_t j = 0; j < n; j++) {
        memcpy(panel + j * rows, a + j * ld, rows * sizeof *panel);
        for (size_t i = 0; i < rows; i++)
            a[i + j * ld] *= inverse[j];
    }
}

/* target -= L (L D)' on the lower triangle. The square below its first half is one product; both halves are
 * divided likewise, down to one block. Panel's leading dimension is ldp. */
static void update_trailing_blocks(const double *lower, size_t ld, const double *panel, size_t ldp, size_t n,
                                   size_t rows, double *target) {
    bool small = rows <= BLOCK;
    size_t half = small ? rows : (rows / 2 + 7) / 8 * 8, skip = small ? 0 : half;
    dense_add_outer(rows - skip, half, n, -1.0, lower + skip, ld, panel, ldp, target + skip, ld);
    if (small)
        return;
    update_trailing_blocks(lower, ld, panel, ldp, n, half, target);
    update_trailing_blocks(lower + half, ld, panel + half, ldp, n, rows - half, target + half + half * ld);
}

/* Factors a dense diagonal block in smaller blocks. */
static bool factor_diagonal_block(double *a, size_t ld, size_t n, double *inverse, double *panel,
                                  int *negative) {
    for (size_t j = 0; j < n; j += INNER) {
        size_t w = n - j < INNER ? n - j : INNER, below = n - j - w;
        double *d = a + j + j * ld;
        if (!factor_band_unblocked(d, ld, w, w, inverse + j, negative))
            return false;
        if (below) {
            solve_rows_below_block(d + w, ld, w, below, d, inverse + j, panel);
            update_trailing_blocks(d + w, ld, panel, below, w, below, d + w + w * ld);
        }
    }
    return true;
}

static void find_pivot_extremes(const band *b, linsys_pivots *pivots) {
    *pivots = (linsys_pivots){b->negative, INFINITY, 0.0};
    for (size_t j = 0; j < b->n; j++) {
        double inverse = fabs(b->inverse[j]);
        pivots->least = inverse < pivots->least ? inverse : pivots->least;
        pivots->largest = inverse > pivots->largest ? inverse : pivots->largest;
    }
}

/* Factors block columns from b->at on, until so many flops are spent. */
static palp_status factor_within_flops(band *b, double flops, bool *done) {
    while (b->at < b->n && flops > 0.0) {
        size_t j = b->at, w = b->n - j < BLOCK ? b->n - j : BLOCK, below = b->n - j - w;
        double *d = b->value + j + j * b->stride;
        if (below > b->width)
            below = b->width;
        if (!factor_diagonal_block(d, b->stride, w, b->inverse + j, b->panel, &b->negative))
            return PALP_ERR_SINGULAR;
        if (below) {
            solve_rows_below_block(d + w, b->stride, w, below, d, b->inverse + j, b->panel);
            update_trailing_blocks(d + w, b->stride, b->panel, below, w, below, d + w + w * b->stride);
        }
        b->at += w;
        flops -= (double)w * (double)(below + w) * (double)(below + 1);
    }
    *done = b->at == b->n;
    return PALP_OK;
}

static void begin_band_factor(void *self) {
    band *b = self;
    b->at = 0;
    b->negative = 0;
}

static palp_status advance_band_factor(void *self, double flops, linsys_pivots *pivots, bool *done) {
    band *b = self;
    palp_status status = PALP_OK;
    *done = b->width <= SMALL_BAND;
    if (!*done)
        status = factor_within_flops(b, flops, done);
    else if (!factor_band_unblocked(b->value, b->stride, b->n, b->width, b->inverse, &b->negative))
        status = PALP_ERR_SINGULAR;
    if (!status && *done)
        find_pivot_extremes(b, pivots);
    return status;
}

static palp_status factor_whole_band(void *self, linsys_pivots *pivots) {
    bool done;
    begin_band_factor(self);
    return advance_band_factor(self, INFINITY, pivots, &done);
}

static void solve_in_band_order(const band *b, double *x) {
    dense_band_forward(b->n, b->width, b->value, b->stride + 1, x);
    for (size_t i = 0; i < b->n; i++)
        x[i] *= b->inverse[i];
    dense_band_backward(b->n, b->width, b->value, b->stride + 1, x);
}

static void solve_band_system(void *self, double *x) {
    const band *b = self;
    if (!b->position) {
        solve_in_band_order(b, x);
        return;
    }
    for (size_t i = 0; i < b->n; i++)
        b->work[b->position[i]] = x[i];
    solve_in_band_order(b, b->work);
    for (size_t i = 0; i < b->n; i++)
        x[i] = b->work[b->position[i]];
}

static size_t find_band_value_slot(const void *self, size_t row, size_t column) {
    const band *b = self;
    size_t i = b->position ? (size_t)b->position[row] : row;
    size_t j = b->position ? (size_t)b->position[column] : column;
    return i > j ? i + j * b->stride : j + i * b->stride;
}

static void destroy_band_solver(void *self) {
    band *b = self;
    arena_free(&b->memory);
    free(b->position);
    free(b);
}

static const linsys_ops BAND_OPS = {factor_whole_band, begin_band_factor,    advance_band_factor,
                                    solve_band_system, find_band_value_slot, destroy_band_solver};

palp_status linsys_band_make(size_t n, const size_t *column, const int32_t *row, linsys_made *made) {
    band *b = calloc(1, sizeof *b);
    if (!b)
        return PALP_ERR_NO_MEMORY;
    palp_status status = choose_narrower_numbering(n, column, row, &b->position, &b->width);
    if (status) {
        destroy_band_solver(b);
        return status;
    }
    b->n = n;
    b->stride = b->width <= SMALL_BAND ? b->width : b->width + 2 * BLOCK;
    size_t count = (b->stride + 1) * n + BLOCK;
    b->value = arena_take(&b->memory, count + 1, sizeof *b->value);
    b->panel = arena_take(&b->memory, (b->width > BLOCK ? b->width : BLOCK) * BLOCK, sizeof *b->panel);
    b->inverse = arena_take(&b->memory, n, sizeof *b->inverse);
    b->work = arena_take(&b->memory, n, sizeof *b->work);
    if (b->memory.failed) {
        destroy_band_solver(b);
        return PALP_ERR_NO_MEMORY;
    }
    double w = (double)b->width;
    *made = (linsys_made){b, &BAND_OPS, b->value, count, (double)n * w * (w + 1.0)};
    return PALP_OK;
}
