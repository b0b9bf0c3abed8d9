/* multigrid_apply.c: one V cycle: a Gauss-Seidel sweep down, one up, so that it is symmetric. */
#include "multigrid_internal.h"

#include <string.h>

/* s -= entries of a row times x */
static inline void subtract(const float *block, const int32_t *column, uint32_t from, uint32_t to, const float *x,
                            float s[4]) {
    for (uint32_t k = from; k < to; k++) {
        const float *b = block + (size_t)BLOCK_FLOATS * k, *v = x + 4 * column[k];
        for (size_t r = 0; r < 4; r++)
            s[r] -= b[r] * v[0] + b[4 + r] * v[1] + b[8 + r] * v[2];
    }
}

static inline void times_inverse(const float *b, const float s[4], float *x) {
    for (size_t r = 0; r < 4; r++)
        x[r] = b[r] * s[0] + b[4 + r] * s[1] + b[8 + r] * s[2];
}

/* Adds s to those that node i follows, each its share; and what they have become to x. */
static inline void pass_up(const mg_level *l, size_t i, const float *restrict s, float *restrict coarse) {
    for (uint32_t k = l->up_first[i]; k < l->up_first[i + 1]; k++)
        for (size_t r = 0; r < 4; r++)
            coarse[4 * (size_t)l->up[k] + r] += l->weight[k] * s[r];
}

static inline void take_down(const mg_level *l, size_t i, const float *restrict coarse, float *restrict x) {
    for (uint32_t k = l->up_first[i]; k < l->up_first[i + 1]; k++)
        for (size_t r = 0; r < 4; r++)
            x[r] += l->weight[k] * coarse[4 * (size_t)l->up[k] + r];
}

/* From x = 0: x = (D + L)^-1 r; what is left, -U x, goes to the coarser level. */
static void sweep_down(mg_level *l, int set) {
    const float *block = l->block[set];
    mg_level *coarse = l + 1;
    memset(coarse->r, 0, 4 * coarse->n * sizeof *coarse->r);
    for (size_t i = 0; i < l->n; i++) {
        float s[4];
        memcpy(s, l->r + 4 * i, sizeof s);
        subtract(block, l->column, l->first[i], l->middle[i], l->x, s);
        times_inverse(l->inverse[set] + BLOCK_FLOATS * i, s, l->x + 4 * i);
    }
    for (size_t i = 0; i < l->n; i++) {
        float s[4] = {0.0F};
        subtract(block, l->column, l->middle[i], l->first[i + 1], l->x, s);
        pass_up(l, i, s, coarse->r);
    }
}

static void sweep_up(mg_level *l, int set) {
    const mg_level *coarse = l + 1;
    for (size_t i = 0; i < l->n; i++)
        take_down(l, i, coarse->x, l->x + 4 * i);
    for (size_t i = l->n; i-- > 0;) {
        float s[4];
        memcpy(s, l->r + 4 * i, sizeof s);
        subtract(l->block[set], l->column, l->first[i], l->first[i + 1], l->x, s);
        times_inverse(l->inverse[set] + BLOCK_FLOATS * i, s, l->x + 4 * i);
    }
}

/* y += (along n n' + across 1) x */
static inline void add_element(const float *e, const float *x, float *y) {
    float t = e[3] * (e[0] * x[0] + e[1] * x[1] + e[2] * x[2]);
    y[0] += t * e[0] + e[4] * x[0];
    y[1] += t * e[1] + e[4] * x[1];
    y[2] += t * e[2] + e[4] * x[2];
}

/* The same two sweeps on the elements: a node passes on to higher ones what it has become, or collects from them. */
static void pass_on(multigrid *mg, size_t i) {
    const float *x = mg->level[0].x + 4 * i;
    for (uint32_t k = mg->after[i]; k < mg->after[i + 1]; k++)
        add_element(mg->element[mg->used] + 5 * (size_t)k, x, mg->rest + 4 * (size_t)mg->high[k]);
    for (int32_t k = mg->first_touching[i]; k >= 0; k = mg->touching[k].next) {
        const multigrid_coupling *c = &mg->touching[k];
        for (size_t r = 0; r < 3; r++)
            mg->rest[4 * (size_t)c->high + r] -= c->block[r] * x[0] + c->block[3 + r] * x[1] + c->block[6 + r] * x[2];
    }
}

static void collect(const multigrid *mg, size_t i, float s[4]) {
    for (uint32_t k = mg->after[i]; k < mg->after[i + 1]; k++)
        add_element(mg->element[mg->used] + 5 * (size_t)k, mg->level[0].x + 4 * (size_t)mg->high[k], s);
    for (int32_t k = mg->first_touching[i]; k >= 0; k = mg->touching[k].next) {
        const multigrid_coupling *c = &mg->touching[k];
        const float *x = mg->level[0].x + 4 * (size_t)c->high;
        for (size_t r = 0; r < 3; r++)
            s[r] -= c->block[3 * r] * x[0] + c->block[3 * r + 1] * x[1] + c->block[3 * r + 2] * x[2];
    }
}

static const float FREE[8][4] = {{0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}, {1, 1, 0, 0},
                                 {0, 0, 1, 0}, {1, 0, 1, 0}, {0, 1, 1, 0}, {1, 1, 1, 0}};

static void finest_down(multigrid *mg) {
    mg_level *l = &mg->level[0], *coarse = l + 1;
    memset(coarse->r, 0, 4 * coarse->n * sizeof *coarse->r);
    memcpy(mg->rest, l->r, 4 * l->n * sizeof *l->r);
    for (size_t i = 0; i < l->n; i++) {
        times_inverse(l->inverse[mg->used] + BLOCK_FLOATS * i, mg->rest + 4 * i, l->x + 4 * i);
        pass_on(mg, i);
    }
    for (size_t i = 0; i < l->n; i++) {
        float s[4] = {0.0F};
        collect(mg, i, s);
        for (size_t r = 0; r < 4; r++)
            s[r] *= FREE[l->axes[i]][r];
        pass_up(l, i, s, coarse->r);
    }
}

static void finest_up(multigrid *mg) {
    mg_level *l = &mg->level[0], *coarse = l + 1;
    memcpy(mg->rest, l->r, 4 * l->n * sizeof *l->r);
    for (size_t i = 0; i < l->n; i++) {
        float s[4] = {0.0F};
        take_down(l, i, coarse->x, s);
        for (size_t r = 0; r < 4; r++)
            l->x[4 * i + r] += FREE[l->axes[i]][r] * s[r];
        pass_on(mg, i);
    }
    for (size_t i = l->n; i-- > 0;) {
        collect(mg, i, mg->rest + 4 * i);
        times_inverse(l->inverse[mg->used] + BLOCK_FLOATS * i, mg->rest + 4 * i, l->x + 4 * i);
    }
}

static void solve_coarsest(multigrid *mg) {
    mg_level *l = &mg->level[mg->n_levels - 1];
    for (size_t i = 0; i < 3 * l->n; i++)
        if (mg->dof[i] >= 0)
            mg->rhs[mg->dof[i]] = (double)l->r[i / 3 * 4 + i % 3];
    linsys_solve(mg->factor[mg->used], mg->rhs);
    for (size_t i = 0; i < 3 * l->n; i++)
        if (mg->dof[i] >= 0)
            l->x[i / 3 * 4 + i % 3] = (float)mg->rhs[mg->dof[i]];
}

void multigrid_apply(multigrid *mg, const double *r, double *z) {
    mg_level *l = &mg->level[0];
    size_t last = mg->n_levels - 1;
    for (size_t i = 0; i < l->n; i++)
        for (size_t k = 0; k < 3; k++)
            l->r[4 * i + k] = (float)r[3 * i + k];
    if (last > 0)
        finest_down(mg);
    for (size_t k = 1; k < last; k++)
        sweep_down(&mg->level[k], mg->used);
    solve_coarsest(mg);
    for (size_t k = last; k-- > 1;)
        sweep_up(&mg->level[k], mg->used);
    if (last > 0)
        finest_up(mg);
    for (size_t i = 0; i < l->n; i++)
        for (size_t k = 0; k < 3; k++)
            z[3 * i + k] = (double)l->x[4 * i + k];
}

double multigrid_cycle_work(const multigrid *mg) {
    double work = 0.04 * (double)linsys_value_count(mg->factor[0]);
    for (size_t k = 0; k + 1 < mg->n_levels; k++)
        work += k == 0 ? 2.0 * (double)mg->n_elements : (double)mg->level[k].first[mg->level[k].n];
    return work;
}
