/* nnls.c: see nnls.h; the columns in use are factored as Q R. */
#include "nnls.h"

#include "base/dense.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const double DEPENDENT =
    1e-10; /* a column this near to the span of those in use counts as dependent */
static const double STALE =
    0.5;              /* share of the largest gradient at the last full search, below which to search again */
enum { SHORT = 256 }; /* columns in the short list */

typedef struct nnls {
    size_t rows, most, used;
    int n;
    const double *a, *b;
    double *q;              /* [rows most] orthonormal */
    double *r;              /* [most most] upper triangle by columns */
    double *projected;      /* [most] q' b */
    double *s;              /* [most] least squares of the columns in use */
    double *x;              /* [most] their coefficients */
    int *column;            /* [most] their numbers */
    double *rest;           /* [rows] residual b - a x */
    double *gradient;       /* [n] a' residual */
    unsigned char *barred;  /* [n] in use, or found dependent */
    int *shortlist, listed; /* [listed] columns of the largest gradients at the last full search */
    double floor;           /* a full search follows if no listed gradient is above this */
} nnls;

static void update_nnls_residual(nnls *p) {
    memcpy(p->rest, p->b, p->rows * sizeof *p->rest);
    dense_times(p->rows, p->used, -1.0, p->q, p->projected, 1.0, p->rest);
}

/* Keeps the best SHORT columns by gradient in a heap whose root is the least of them. */
static void insert_into_shortlist(nnls *p, int j) {
    int *heap = p->shortlist, at;
    const double *g = p->gradient;
    if (p->listed < SHORT) {
        for (at = p->listed++; at > 0 && g[heap[(at - 1) / 2]] > g[j]; at = (at - 1) / 2)
            heap[at] = heap[(at - 1) / 2];
        heap[at] = j;
        return;
    }
    if (g[j] <= g[heap[0]])
        return;
    for (at = 0; 2 * at + 1 < SHORT;) {
        int child = 2 * at + 1;
        if (child + 1 < SHORT && g[heap[child + 1]] < g[heap[child]])
            child++;
        if (g[heap[child]] >= g[j])
            break;
        heap[at] = heap[child];
        at = child;
    }
    heap[at] = j;
}

/* The listed column of the largest gradient; -1: none is above the floor. */
static int find_best_listed_column(nnls *p) {
    int best = -1;
    double most = p->floor;
    for (int i = 0; i < p->listed; i++) {
        int j = p->shortlist[i];
        if (p->barred[j])
            continue;
        double gradient = dense_dot(p->rows, p->a + (size_t)j * p->rows, p->rest);
        if (gradient > most) {
            most = gradient;
            best = j;
        }
    }
    return best;
}

/* An unused column with about the largest gradient; -1: none is positive. All columns are searched only when
 * the short list is used up. */
static int find_most_promising_column(nnls *p) {
    int j = find_best_listed_column(p);
    if (j >= 0)
        return j;
    dense_transposed_times(p->rows, (size_t)p->n, 1.0, p->a, p->rest, 0.0, p->gradient);
    p->listed = 0;
    p->floor = 0.0;
    for (j = 0; j < p->n; j++)
        if (!p->barred[j] && p->gradient[j] > 0.0) {
            insert_into_shortlist(p, j);
            p->floor = fmax(p->floor, STALE * p->gradient[j]);
        }
    return find_best_listed_column(p);
}

/* Appends column j to Q R, orthogonalized twice. False if it depends on the columns in use. */
static bool append_orthogonal_column(nnls *p, int j) {
    size_t rows = p->rows, k = p->used;
    double *v = p->q + k * rows, *h = p->r + k * p->most, *again = p->s;
    memcpy(v, p->a + (size_t)j * rows, rows * sizeof *v);
    double size = sqrt(dense_dot(rows, v, v));
    for (int round = 0; round < 2 && k > 0; round++) {
        double *out = round ? again : h;
        dense_transposed_times(rows, k, 1.0, p->q, v, 0.0, out);
        dense_times(rows, k, -1.0, p->q, out, 1.0, v);
        for (size_t i = 0; round && i < k; i++)
            h[i] += again[i];
    }
    double left = sqrt(dense_dot(rows, v, v));
    if (!(left > DEPENDENT * size))
        return false;
    for (size_t i = 0; i < rows; i++)
        v[i] /= left;
    h[k] = left;
    p->projected[k] = dense_dot(rows, v, p->b);
    p->column[k] = j;
    p->x[k] = 0.0;
    p->barred[j] = 1;
    p->used++;
    return true;
}

/* Rotates rows i and i + 1 of R (and columns of Q) so that R[i + 1][column i] vanishes. */
static void rotate_adjacent_rows(nnls *p, size_t i) {
    size_t most = p->most, rows = p->rows;
    double a = p->r[i * most + i], b = p->r[i * most + i + 1], length = hypot(a, b);
    if (length == 0.0)
        return;
    double c = a / length, s = b / length;
    for (size_t j = i; j < p->used; j++) {
        double *r = p->r + j * most + i, top = r[0];
        r[0] = c * top + s * r[1];
        r[1] = c * r[1] - s * top;
    }
    double *q = p->q + i * rows;
    for (size_t k = 0; k < rows; k++) {
        double left = q[k];
        q[k] = c * left + s * q[rows + k];
        q[rows + k] = c * q[rows + k] - s * left;
    }
    double left = p->projected[i];
    p->projected[i] = c * left + s * p->projected[i + 1];
    p->projected[i + 1] = c * p->projected[i + 1] - s * left;
}

static void drop_column_from_factor(nnls *p, size_t k) {
    size_t most = p->most;
    p->barred[p->column[k]] = 0;
    p->used--;
    for (size_t j = k; j < p->used; j++) {
        memcpy(p->r + j * most, p->r + (j + 1) * most, (j + 2) * sizeof *p->r);
        p->column[j] = p->column[j + 1];
        p->x[j] = p->x[j + 1];
    }
    for (size_t i = k; i < p->used; i++)
        rotate_adjacent_rows(p, i);
}

/* s = R^-1 q' b */
static void solve_used_columns(nnls *p) {
    size_t most = p->most;
    memcpy(p->s, p->projected, p->used * sizeof *p->s);
    for (size_t j = p->used; j-- > 0;) {
        p->s[j] /= p->r[j * most + j];
        for (size_t i = 0; i < j; i++)
            p->s[i] -= p->r[j * most + i] * p->s[j];
    }
}

/* Moves x towards s as far as it stays positive and removes columns that became 0, until x = s. */
static void move_while_positive(nnls *p) {
    for (;;) {
        double reach = 1.0;
        solve_used_columns(p);
        for (size_t i = 0; i < p->used; i++)
            if (p->s[i] <= 0.0)
                reach = fmin(reach, p->x[i] / (p->x[i] - p->s[i]));
        bool blocked = false;
        for (size_t i = p->used; i-- > 0;) {
            bool ends = p->s[i] <= 0.0 && p->x[i] / (p->x[i] - p->s[i]) <= reach;
            p->x[i] += reach * (p->s[i] - p->x[i]);
            blocked = blocked || ends;
            if (ends)
                p->x[i] = 0.0;
        }
        if (!blocked)
            return;
        for (size_t i = p->used; i-- > 0;)
            if (p->x[i] <= 0.0)
                drop_column_from_factor(p, i);
    }
}

static void iterate_active_set(nnls *p, double stop, double *residual) {
    for (size_t round = 0; round < 3 * p->most + 100; round++) {
        update_nnls_residual(p);
        *residual = sqrt(dense_dot(p->rows, p->rest, p->rest));
        if (*residual <= stop || p->used == p->most)
            return;
        int j = find_most_promising_column(p);
        if (j < 0)
            return;
        if (!append_orthogonal_column(p, j)) {
            p->barred[j] = 1;
            continue;
        }
        solve_used_columns(p);
        if (p->s[p->used - 1] <= 0.0) { /* rounding: this coefficient cannot grow */
            drop_column_from_factor(p, p->used - 1);
            p->barred[j] = 1;
            continue;
        }
        move_while_positive(p);
    }
}

palp_status nnls_solve(size_t rows, size_t n, const double *a, const double *b, double tolerance, size_t most,
                       double *x, double *residual) {
    most = most < rows ? most : rows;
    most = most < n ? most : n;
    nnls p = {.rows = rows, .n = (int)n, .most = most, .a = a, .b = b};
    size_t room = most + 1;
    double *work = calloc(rows * room + room * room + 3 * room + rows + n + 1, sizeof *work);
    p.column = calloc(room, sizeof *p.column);
    p.barred = calloc(n + 1, 1);
    p.shortlist = calloc(SHORT, sizeof *p.shortlist);
    palp_status status = work && p.column && p.barred && p.shortlist ? PALP_OK : PALP_ERR_NO_MEMORY;
    memset(x, 0, n * sizeof *x);
    if (!status && most > 0) {
        p.q = work;
        p.r = p.q + rows * room;
        p.projected = p.r + room * room;
        p.s = p.projected + room;
        p.x = p.s + room;
        p.rest = p.x + room;
        p.gradient = p.rest + rows;
        double size = sqrt(dense_dot(rows, b, b));
        iterate_active_set(&p, tolerance * size, residual);
        *residual = size > 0.0 ? *residual / size : 0.0;
        for (size_t i = 0; i < p.used; i++)
            x[p.column[i]] = p.x[i];
    }
    free(work);
    free(p.column);
    free(p.barred);
    free(p.shortlist);
    return status;
}
