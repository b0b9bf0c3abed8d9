/* multigrid_apply.c: one symmetric V cycle, a Gauss-Seidel sweep down and one up; whole or in two halves, and
 * its work. */
#include "multigrid_internal.h"

#include <string.h>

typedef multigrid_four four;

/* Row i's blocks before the diagonal times x, subtracted from s. The second function subtracts their
 * transposes times x from rest. */
static inline four subtract_lower_product(const mg_level *l, const float *block, size_t i, four s) {
    for (uint32_t k = l->first[i]; k < l->middle[i]; k++, block += BLOCK_FLOATS)
        s -= multigrid_times(block, multigrid_load(l->x + 4 * l->column[k]));
    return s;
}

static inline void subtract_transposed_product(const mg_level *l, const float *block, size_t i, four x,
                                               float *rest) {
    for (uint32_t k = l->first[i]; k < l->middle[i]; k++, block += BLOCK_FLOATS) {
        float *to = rest + 4 * l->column[k];
        multigrid_store(to, multigrid_load(to) - multigrid_turned_times(block, x));
    }
}

/* Forward sweep from x = 0: x = (D + L)^-1 r. The residual -L' x goes to the coarser level. */
static void sweep_level_downwards(mg_level *l, int set, float *rest) {
    mg_level *coarse = l + 1;
    memset(rest, 0, 4 * l->n * sizeof *rest);
    memset(coarse->r, 0, 4 * coarse->n * sizeof *coarse->r);
    for (size_t i = 0; i < l->n; i++) {
        const float *block = l->block[set] + multigrid_low(l, i, l->first[i]);
        const four s = subtract_lower_product(l, block, i, multigrid_load(l->r + 4 * i));
        const four x = multigrid_times(l->inverse[set] + BLOCK_FLOATS * i, s);
        multigrid_store(l->x + 4 * i, x);
        subtract_transposed_product(l, block, i, x, rest);
    }
    for (size_t i = 0; i < l->n; i++)
        multigrid_pass_up(l, i, multigrid_load(rest + 4 * i), coarse->r);
}

/* Backward sweep: x = (D + L')^-1 (r - L x). */
static void sweep_level_upwards(mg_level *l, int set, float *rest) {
    const mg_level *coarse = l + 1;
    for (size_t i = 0; i < l->n; i++)
        multigrid_store(l->x + 4 * i, multigrid_take_down(l, i, coarse->x, multigrid_load(l->x + 4 * i)));
    memcpy(rest, l->r, 4 * l->n * sizeof *rest);
    for (size_t i = l->n; i-- > 0;) {
        const float *block = l->block[set] + multigrid_low(l, i, l->first[i]);
        const four s = subtract_lower_product(l, block, i, multigrid_load(rest + 4 * i));
        const four x = multigrid_times(l->inverse[set] + BLOCK_FLOATS * i, s);
        multigrid_store(l->x + 4 * i, x);
        subtract_transposed_product(l, block, i, x, rest);
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

/* From r on the finest level down to x on the second one; with a single level, to its own x. */
static void descend_to_coarsest_level(multigrid *mg, const double *r) {
    const size_t last = mg->n_levels - 1;
    multigrid_narrow(mg->n_nodes, r, mg->level[0].r);
    if (last > 0)
        multigrid_finest_down(mg);
    for (size_t k = 1; k < last; k++)
        sweep_level_downwards(&mg->level[k], mg->used, mg->rest);
    solve_coarsest(mg);
    for (size_t k = last; k-- > 1;)
        sweep_level_upwards(&mg->level[k], mg->used, mg->rest);
}

static void ascend_to_finest_level(multigrid *mg, double *z) {
    if (mg->n_levels > 1)
        multigrid_finest_up(mg);
    multigrid_widen(mg->n_nodes, mg->level[0].x, z);
}

void multigrid_apply(multigrid *mg, const double *r, double *z) {
    descend_to_coarsest_level(mg, r);
    ascend_to_finest_level(mg, z);
}

/* Floats of x on the two finest levels. */
static size_t count_kept_level_floats(const multigrid *mg, size_t level) {
    return level < mg->n_levels ? 4 * mg->level[level].n : 0;
}

size_t multigrid_half_size(const multigrid *mg) {
    return count_kept_level_floats(mg, 0) + count_kept_level_floats(mg, 1);
}

void multigrid_apply_half(multigrid *mg, const double *r, float *half) {
    descend_to_coarsest_level(mg, r);
    memcpy(half, mg->level[0].x, count_kept_level_floats(mg, 0) * sizeof *half);
    if (mg->n_levels > 1)
        memcpy(half + count_kept_level_floats(mg, 0), mg->level[1].x,
               count_kept_level_floats(mg, 1) * sizeof *half);
}

void multigrid_apply_rest(multigrid *mg, const double *r, const float *half, double *z) {
    multigrid_narrow(mg->n_nodes, r, mg->level[0].r);
    memcpy(mg->level[0].x, half, count_kept_level_floats(mg, 0) * sizeof *half);
    if (mg->n_levels > 1)
        memcpy(mg->level[1].x, half + count_kept_level_floats(mg, 0),
               count_kept_level_floats(mg, 1) * sizeof *half);
    ascend_to_finest_level(mg, z);
}

double multigrid_cycle_work(const multigrid *mg) {
    double work = 0.13 * (double)linsys_value_count(mg->factor[0]);
    for (size_t k = 0; k + 1 < mg->n_levels; k++)
        work += k == 0 ? 1.5 * (double)mg->n_elements : (double)mg->level[k].first[mg->level[k].n];
    return work;
}
