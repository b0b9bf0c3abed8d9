/* multigrid_apply.c: one V cycle: a Gauss-Seidel sweep down, one up, so that it is symmetric. */
#include "multigrid_internal.h"

#include <string.h>

typedef multigrid_four four;

/* s less entries of a row times x */
static inline four subtract(const float *block, const int32_t *column, uint32_t from, uint32_t to, const float *x, four s) {
    for (uint32_t k = from; k < to; k++)
        s -= multigrid_times(block + (size_t)BLOCK_FLOATS * k, multigrid_load(x + 4 * column[k]));
    return s;
}

/* From x = 0: x = (D + L)^-1 r; what is left, -U x, goes to the coarser level. */
static void sweep_down(mg_level *l, int set) {
    const float *block = l->block[set];
    mg_level *coarse = l + 1;
    memset(coarse->r, 0, 4 * coarse->n * sizeof *coarse->r);
    for (size_t i = 0; i < l->n; i++) {
        four s = subtract(block, l->column, l->first[i], l->middle[i], l->x, multigrid_load(l->r + 4 * i));
        multigrid_store(l->x + 4 * i, multigrid_times(l->inverse[set] + BLOCK_FLOATS * i, s));
    }
    for (size_t i = 0; i < l->n; i++) {
        four s = subtract(block, l->column, l->middle[i], l->first[i + 1], l->x, multigrid_all(0.0F));
        multigrid_pass_up(l, i, s, coarse->r);
    }
}

static void sweep_up(mg_level *l, int set) {
    const mg_level *coarse = l + 1;
    for (size_t i = 0; i < l->n; i++)
        multigrid_store(l->x + 4 * i, multigrid_take_down(l, i, coarse->x, multigrid_load(l->x + 4 * i)));
    for (size_t i = l->n; i-- > 0;) {
        four s = subtract(l->block[set], l->column, l->first[i], l->first[i + 1], l->x, multigrid_load(l->r + 4 * i));
        multigrid_store(l->x + 4 * i, multigrid_times(l->inverse[set] + BLOCK_FLOATS * i, s));
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
    multigrid_narrow(l->n, r, l->r);
    if (last > 0)
        multigrid_finest_down(mg);
    for (size_t k = 1; k < last; k++)
        sweep_down(&mg->level[k], mg->used);
    solve_coarsest(mg);
    for (size_t k = last; k-- > 1;)
        sweep_up(&mg->level[k], mg->used);
    if (last > 0)
        multigrid_finest_up(mg);
    multigrid_widen(l->n, l->x, z);
}

double multigrid_cycle_work(const multigrid *mg) {
    double work = 0.13 * (double)linsys_value_count(mg->factor[0]);
    for (size_t k = 0; k + 1 < mg->n_levels; k++)
        work += k == 0 ? 1.5 * (double)mg->n_elements : (double)mg->level[k].first[mg->level[k].n];
    return work;
}
