/* multigrid_finest.c: the finest level of a cycle, element by element: a step of damped Jacobi, but
 * Gauss-Seidel at nodes with stiff contacts, called the patch. The patch is first on the way down and last on
 * the way up. */
#include "multigrid_internal.h"

#include <string.h>

typedef multigrid_four four;

/* (along d d' + across 1) x, with e = {along, across} of an element. */
static inline four multiply_element_block(const float *e, four d, four x) {
    const four p = d * x;
    return multigrid_all(e[0] * (p[0] + p[1] + p[2])) * d + multigrid_all(e[1]) * x;
}

static inline four keep_free_axes(const mg_level *l, size_t i, four s) {
    return multigrid_load(MULTIGRID_FREE[l->axes[i]]) * s;
}

/* Adds the coarser level's correction to x, interpolated. */
static inline void add_coarse_correction(const mg_level *l, size_t i) {
    const four s = multigrid_take_down(l, i, l[1].x, multigrid_all(0.0F));
    multigrid_store(l->x + 4 * i, multigrid_load(l->x + 4 * i) + keep_free_axes(l, i, s));
}

static inline four solve_own_block(const multigrid *mg, size_t i, four s) {
    return multigrid_times(mg->level[0].inverse[mg->used] + BLOCK_FLOATS * i, s);
}

/* r -= B x of a coupling; if turned, B' x. */
static inline void subtract_coupling_product(const multigrid_coupling *c, bool turned, const float *x,
                                             float *r) {
    const size_t along = turned ? 3 : 1, across = turned ? 1 : 3;
    for (size_t i = 0; i < 3; i++)
        r[i] -= c->block[across * i] * x[0] + c->block[across * i + along] * x[1] +
                c->block[across * i + 2 * along] * x[2];
}

/* The further block between nodes i and j of entry k, times v. */
static inline four multiply_further_block(const multigrid *mg, size_t i, size_t j, uint32_t k, four v) {
    float block[BLOCK_FLOATS];
    multigrid_between(mg, mg->used, i, j, mg->through[k], block);
    return multigrid_times(block, v);
}

/* Entry k of row i times v: the element between the two nodes. */
static inline four multiply_entry_of_row(const multigrid *mg, size_t i, uint32_t k, four v) {
    const size_t j = (size_t)mg->level[0].column[k];
    float e[5];
    multigrid_element(mg, mg->element[mg->used], i < j ? i : j, mg->through[k], e);
    return multiply_element_block(e + 3, (four){e[0], e[1], e[2], 0.0F}, v);
}

/* Solves for a node of the patch; subtracts its effect from other nodes and from later ones of the patch. */
static void relax_patch_node_downwards(multigrid *mg, size_t i) {
    const mg_level *l = &mg->level[0];
    const four x = solve_own_block(mg, i, multigrid_load(mg->rest + 4 * i));
    multigrid_store(l->x + 4 * i, x);
    for (uint32_t k = l->first[i]; k < l->first[i + 1]; k++) {
        float *rest = mg->rest + 4 * (size_t)l->column[k];
        four left = multigrid_load(rest) + multiply_entry_of_row(mg, i, k, x);
        if (multigrid_has_between(mg, mg->used))
            left -= multiply_further_block(mg, (size_t)l->column[k], i, k, x);
        multigrid_store(rest, left);
    }
    for (int32_t k = mg->first_touching[i]; k >= 0; k = mg->touching[k].next)
        subtract_coupling_product(&mg->touching[k], true, l->x + 4 * i,
                                  mg->rest + 4 * (size_t)mg->touching[k].high);
}

/* An own block, its lower triangle by rows, times x. */
static inline four multiply_own_block(const float *s, const float *x) {
    return (four){s[0] * x[0] + s[1] * x[1] + s[3] * x[2], s[1] * x[0] + s[2] * x[1] + s[4] * x[2],
                  s[3] * x[0] + s[4] * x[1] + s[5] * x[2], 0.0F};
}

/* Solves for a node with the present x elsewhere; rest is r less couplings to lower nodes. */
static void relax_patch_node_upwards(multigrid *mg, size_t i) {
    const mg_level *l = &mg->level[0];
    const float *s = mg->touched + 6 * i, *x = l->x + 4 * i;
    float *rest = mg->rest + 4 * i;
    for (int32_t k = mg->first_touching[i]; k >= 0; k = mg->touching[k].next)
        subtract_coupling_product(&mg->touching[k], false, l->x + 4 * (size_t)mg->touching[k].high, rest);
    four left = multigrid_load(rest), own = multigrid_load(x);
    left -= multiply_own_block(s, x);
    if (multigrid_has_between(mg, mg->used)) {
        left -= multiply_own_block(mg->beside[mg->used] + 6 * i, x);
        for (uint32_t k = l->first[i]; k < l->first[i + 1]; k++)
            left -= multiply_further_block(mg, i, (size_t)l->column[k], k,
                                           multigrid_load(l->x + 4 * (size_t)l->column[k]));
    }
    for (uint32_t k = l->first[i]; k < l->first[i + 1]; k++)
        left += multiply_entry_of_row(mg, i, k, multigrid_load(l->x + 4 * (size_t)l->column[k]) - own);
    multigrid_store(l->x + 4 * i, own + solve_own_block(mg, i, left));
}

static void relax_patch_upwards(multigrid *mg) {
    const mg_level *l = &mg->level[0];
    for (size_t k = 0; k < mg->n_patch; k++)
        memcpy(mg->rest + 4 * (size_t)mg->patch[k], l->r + 4 * (size_t)mg->patch[k], 4 * sizeof *mg->rest);
    for (int32_t k = 0; k < mg->n_touching; k++)
        subtract_coupling_product(&mg->touching[k], true, l->x + 4 * (size_t)mg->touching[k].low,
                                  mg->rest + 4 * (size_t)mg->touching[k].high);
    for (size_t k = mg->n_patch; k-- > 0;)
        relax_patch_node_upwards(mg, (size_t)mg->patch[k]);
}

/* Damping of the Jacobi steps before and after the coarser levels. The elements' part of the tangent is at
 * most twice its own blocks. A step is a contraction up to a ratio of 2.7. */
static const float DAMPING = 0.74F;

/* rest -= tangent of the elements from node i to higher ones, times x. */
static inline void subtract_element_products(const multigrid *mg, const float *element, const float *x,
                                             size_t i) {
    const float *place = element + mg->nodes;
    const four own = multigrid_load(x + 4 * i), here = multigrid_load(place + 4 * i);
    four sum = multigrid_load(mg->rest + 4 * i);
    for (uint32_t k = mg->after[i]; k < mg->after[i + 1]; k++) {
        const size_t j = 4 * (size_t)mg->high[k];
        const four f = multiply_element_block(element + 2 * (size_t)k, multigrid_load(place + j) - here,
                                              multigrid_load(x + j) - own);
        sum += f;
        multigrid_store(mg->rest + j, multigrid_load(mg->rest + j) - f);
    }
    multigrid_store(mg->rest + 4 * i, sum);
}

/* rest = r - A x; values at fixed axes are not used. */
static void find_finest_residual(multigrid *mg) {
    const mg_level *l = &mg->level[0];
    for (size_t i = 0; i < l->n; i++) {
        const float *s = mg->touched + 6 * i, *x = l->x + 4 * i, *r = l->r + 4 * i;
        float *rest = mg->rest + 4 * i;
        rest[0] = r[0] - (s[0] * x[0] + s[1] * x[1] + s[3] * x[2]);
        rest[1] = r[1] - (s[1] * x[0] + s[2] * x[1] + s[4] * x[2]);
        rest[2] = r[2] - (s[3] * x[0] + s[4] * x[1] + s[5] * x[2]);
    }
    for (int32_t k = 0; k < mg->n_touching; k++) {
        const multigrid_coupling *c = &mg->touching[k];
        const size_t low = 4 * (size_t)c->low, high = 4 * (size_t)c->high;
        subtract_coupling_product(c, false, l->x + high, mg->rest + low);
        subtract_coupling_product(c, true, l->x + low, mg->rest + high);
    }
    if (mg->n_batches > 0)
        multigrid_batches_subtract(mg, mg->element[mg->used], l->x, mg->rest);
    for (size_t i = 0; i < l->n && mg->n_batches == 0; i++)
        subtract_element_products(mg, mg->element[mg->used], l->x, i);
    if (multigrid_has_between(mg, mg->used))
        multigrid_between_subtract(mg, l->x, mg->rest);
}

void multigrid_finest_down(multigrid *mg) {
    const mg_level *l = &mg->level[0];
    memcpy(mg->rest, l->r, 4 * l->n * sizeof *l->r);
    for (size_t k = 0; k < mg->n_patch; k++)
        relax_patch_node_downwards(mg, (size_t)mg->patch[k]);
    for (size_t i = 0; i < l->n; i++)
        if (!mg->patched[i])
            multigrid_store(l->x + 4 * i, multigrid_all(DAMPING) *
                                              solve_own_block(mg, i, multigrid_load(mg->rest + 4 * i)));
    find_finest_residual(mg);
    memset(l[1].r, 0, 4 * l[1].n * sizeof *l[1].r);
    for (size_t i = 0; i < l->n; i++)
        multigrid_pass_up(l, i, keep_free_axes(l, i, multigrid_load(mg->rest + 4 * i)), l[1].r);
}

void multigrid_finest_up(multigrid *mg) {
    const mg_level *l = &mg->level[0];
    for (size_t i = 0; i < l->n; i++)
        add_coarse_correction(l, i);
    find_finest_residual(mg);
    for (size_t i = 0; i < l->n; i++)
        if (!mg->patched[i])
            multigrid_store(l->x + 4 * i, multigrid_load(l->x + 4 * i) +
                                              multigrid_all(DAMPING) *
                                                  solve_own_block(mg, i, multigrid_load(mg->rest + 4 * i)));
    relax_patch_upwards(mg);
}

void multigrid_elements_times(multigrid *mg, const float *element, const double *x, double *out) {
    const mg_level *l = &mg->level[0];
    if (mg->n_batches > 0) {
        multigrid_batches_times(mg, element, x, out);
        return;
    }
    memset(mg->rest, 0, 4 * l->n * sizeof *mg->rest);
    multigrid_narrow(l->n, x, l->r);
    for (size_t i = 0; i < l->n; i++)
        subtract_element_products(mg, element, l->r, i);
    multigrid_widen(l->n, mg->rest, out);
}
