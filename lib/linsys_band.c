/* linsys_band.c: band L D L' without pivoting, blocked on BLAS. Indefinite matrices are factored the
 * same way, so the inertia comes with every factor. */
#include "lapack.h"
#include "linsys.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 48, INNER = 12, SMALL_BAND = 40 };

/* Entry (i, j) of the lower triangle is at value[i + j stride]: a dense matrix of leading dimension
 * stride that only its band is touched of. stride + 1 = band + 2 BLOCK: whole blocks fit beside the
 * band, and what a block update spills above the diagonal lands behind it. */
typedef struct band {
    size_t n, width, stride;
    double *value;
    double *panel;   /* [width BLOCK] */
    double *inverse; /* [n] 1 / D */
} band;

static size_t band_width(size_t n, const size_t *column, const int32_t *row) {
    size_t width = 0;
    for (size_t j = 0; j < n; j++)
        if (column[j + 1] > column[j] && (size_t)row[column[j + 1] - 1] - j > width)
            width = (size_t)row[column[j + 1] - 1] - j;
    return width;
}

/* Rates from a fit to measured times: 1.5 Gflop/s on narrow bands, growing to 60 on wide ones. */
double linsys_band_cost(size_t n, const size_t *column, const int32_t *row) {
    double w = (double)band_width(n, column, row);
    return (double)n * w * (w + 1.0) / (1.5e9 + 60e9 * w / (w + 600.0));
}

/* Right-looking L D L' of n columns with at most width rows below the diagonal; a[i + j ld]. */
static bool factor_plain(double *a, size_t ld, size_t n, size_t width, double *inverse, int *negative) {
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
static void solve_panel(double *a, size_t ld, size_t n, size_t rows, const double *diagonal,
                        const double *inverse, double *panel) {
    int m = (int)rows, k = (int)n, lda = (int)ld;
    double one = 1.0;
    dtrsm_("R", "L", "T", "U", &m, &k, &one, diagonal, &lda, a, &lda);
    for (size_t j = 0; j < n; j++) {
        memcpy(panel + j * rows, a + j * ld, rows * sizeof *panel);
        for (size_t i = 0; i < rows; i++)
            a[i + j * ld] *= inverse[j];
    }
}

/* target -= L (L D)' on the lower triangle, in block columns. */
static void update_trailing(const double *lower, size_t ld, const double *panel, size_t n, size_t rows,
                            double *target, size_t chunk) {
    int k = (int)n, lda = (int)ld, ldp = (int)rows;
    double minus = -1.0, one = 1.0;
    for (size_t c = 0; c < rows; c += chunk) {
        int m = (int)(rows - c), w = (int)(rows - c < chunk ? rows - c : chunk);
        dgemm_("N", "T", &m, &w, &k, &minus, lower + c, &lda, panel + c, &ldp, &one, target + c + c * ld, &lda);
    }
}

/* A dense diagonal block, itself in smaller blocks. */
static bool factor_diagonal(double *a, size_t ld, size_t n, double *inverse, double *panel, int *negative) {
    for (size_t j = 0; j < n; j += INNER) {
        size_t w = n - j < INNER ? n - j : INNER, below = n - j - w;
        double *d = a + j + j * ld;
        if (!factor_plain(d, ld, w, w, inverse + j, negative))
            return false;
        if (below) {
            solve_panel(d + w, ld, w, below, d, inverse + j, panel);
            update_trailing(d + w, ld, panel, w, below, d + w + w * ld, INNER);
        }
    }
    return true;
}

static palp_status band_factor(void *self, int *negative) {
    band *b = self;
    *negative = 0;
    if (b->width <= SMALL_BAND)
        return factor_plain(b->value, b->stride, b->n, b->width, b->inverse, negative) ? PALP_OK
                                                                                       : PALP_ERR_SINGULAR;
    for (size_t j = 0; j < b->n; j += BLOCK) {
        size_t w = b->n - j < BLOCK ? b->n - j : BLOCK, below = b->n - j - w;
        double *d = b->value + j + j * b->stride;
        if (below > b->width)
            below = b->width;
        if (!factor_diagonal(d, b->stride, w, b->inverse + j, b->panel, negative))
            return PALP_ERR_SINGULAR;
        if (below) {
            solve_panel(d + w, b->stride, w, below, d, b->inverse + j, b->panel);
            update_trailing(d + w, b->stride, b->panel, w, below, d + w + w * b->stride, BLOCK);
        }
    }
    return PALP_OK;
}

static void band_solve(void *self, double *x) {
    const band *b = self;
    for (size_t j = 0; j < b->n; j++) {
        const double *col = b->value + j * b->stride;
        size_t end = j + b->width < b->n - 1 ? j + b->width : b->n - 1;
        double v = x[j];
        for (size_t i = j + 1; i <= end; i++)
            x[i] -= v * col[i];
    }
    for (size_t j = b->n; j-- > 0;) {
        const double *col = b->value + j * b->stride;
        size_t end = j + b->width < b->n - 1 ? j + b->width : b->n - 1, i = j + 1;
        double sum[4] = {0};
        for (; i + 3 <= end; i += 4)
            for (size_t k = 0; k < 4; k++)
                sum[k] += col[i + k] * x[i + k];
        for (; i <= end; i++)
            sum[0] += col[i] * x[i];
        x[j] = x[j] * b->inverse[j] - ((sum[0] + sum[1]) + (sum[2] + sum[3]));
    }
}

static size_t band_slot(const void *self, size_t row, size_t column) {
    return row + column * ((const band *)self)->stride;
}

static void band_destroy(void *self) {
    band *b = self;
    free(b->value);
    free(b->panel);
    free(b->inverse);
    free(b);
}

static const linsys_ops BAND_OPS = {band_factor, band_solve, band_slot, band_destroy};

palp_status linsys_band_make(size_t n, const size_t *column, const int32_t *row, linsys_made *made) {
    band *b = calloc(1, sizeof *b);
    if (!b)
        return PALP_ERR_NO_MEMORY;
    b->n = n;
    b->width = band_width(n, column, row);
    b->stride = b->width <= SMALL_BAND ? b->width : b->width + 2 * BLOCK;
    size_t count = (b->stride + 1) * n + BLOCK;
    b->value = calloc(count + 1, sizeof *b->value);
    b->panel = malloc(((b->width > BLOCK ? b->width : BLOCK) * BLOCK + 1) * sizeof *b->panel);
    b->inverse = malloc((n + 1) * sizeof *b->inverse);
    if (!b->value || !b->panel || !b->inverse) {
        band_destroy(b);
        return PALP_ERR_NO_MEMORY;
    }
    double w = (double)b->width;
    *made = (linsys_made){b, &BAND_OPS, b->value, count, (double)n * w * (w + 1.0)};
    return PALP_OK;
}
