/* multigrid_finest.c: the finest level of a cycle, on the elements. */
#include "multigrid_internal.h"

#include <string.h>

typedef multigrid_four four;

/* (along d d' + across 1) x of two numbers e */
static inline four element_times(const float *e, four d, four x) {
    const four p = d * x;
    return multigrid_all(e[0] * (p[0] + p[1] + p[2])) * d + multigrid_all(e[1]) * x;
}

static inline four free_part(const mg_level *l, size_t i, four s) {
    return multigrid_load(MULTIGRID_FREE[l->axes[i]]) * s;
}

/* x of each node grows by its share of what the coarser level has. */
static inline void take_down(const mg_level *l, size_t i) {
    const four s = multigrid_take_down(l, i, l[1].x, multigrid_all(0.0F));
    multigrid_store(l->x + 4 * i, multigrid_load(l->x + 4 * i) + free_part(l, i, s));
}

/* ---- damped Jacobi ------------------------------------------------------------------------------- */

/* Of a step before the coarser levels and one behind them. The elements' part of the tangent is at most twice that of its own
 * blocks, as that of a single element is; a step is a contraction up to 2.7. */
static const float DAMPING = 0.74F;

/* rest less these elements' part of the tangent times x, those from node i to higher ones */
static inline void subtract_elements(const multigrid *mg, const float *element, const float *x, size_t i) {
    const float *place = element + mg->nodes;
    const four own = multigrid_load(x + 4 * i), here = multigrid_load(place + 4 * i);
    four sum = multigrid_load(mg->rest + 4 * i);
    for (uint32_t k = mg->after[i]; k < mg->after[i + 1]; k++) {
        const size_t j = 4 * (size_t)mg->high[k];
        const four f = element_times(element + 2 * (size_t)k, multigrid_load(place + j) - here, multigrid_load(x + j) - own);
        sum += f;
        multigrid_store(mg->rest + j, multigrid_load(mg->rest + j) - f);
    }
    multigrid_store(mg->rest + 4 * i, sum);
}

/* rest = r - A x on the free axes */
static void find_rest(multigrid *mg) {
    const mg_level *l = &mg->level[0];
    for (size_t i = 0; i < l->n; i++) {
        const float *s = mg->touched + 6 * i, *x = l->x + 4 * i, *r = l->r + 4 * i;
        float *rest = mg->rest + 4 * i;
        rest[0] = r[0] - (s[0] * x[0] + s[1] * x[1] + s[3] * x[2]);
        rest[1] = r[1] - (s[1] * x[0] + s[2] * x[1] + s[4] * x[2]);
        rest[2] = r[2] - (s[3] * x[0] + s[4] * x[1] + s[5] * x[2]);
    }
    if (mg->n_batches > 0)
        multigrid_batches_subtract(mg, mg->element[mg->used], l->x, mg->rest);
    for (size_t i = 0; i < l->n; i++) {
        if (mg->n_batches == 0)
            subtract_elements(mg, mg->element[mg->used], l->x, i); /* the last that node i gets */
        multigrid_store(mg->rest + 4 * i, free_part(l, i, multigrid_load(mg->rest + 4 * i)));
    }
}

/* What a step makes of r. */
static inline four step(const multigrid *mg, size_t i, const float *r) {
    const float *inverse = mg->level[0].inverse[mg->used] + BLOCK_FLOATS * i;
    return multigrid_all(DAMPING) * multigrid_times(inverse, multigrid_load(r + 4 * i));
}

void multigrid_jacobi_down(multigrid *mg) {
    const mg_level *l = &mg->level[0];
    for (size_t i = 0; i < l->n; i++)
        multigrid_store(l->x + 4 * i, step(mg, i, l->r));
    find_rest(mg);
    memset(l[1].r, 0, 4 * l[1].n * sizeof *l[1].r);
    for (size_t i = 0; i < l->n; i++)
        multigrid_pass_up(l, i, multigrid_load(mg->rest + 4 * i), l[1].r);
}

void multigrid_jacobi_up(multigrid *mg) {
    const mg_level *l = &mg->level[0];
    for (size_t i = 0; i < l->n; i++)
        take_down(l, i);
    find_rest(mg);
    for (size_t i = 0; i < l->n; i++)
        multigrid_store(l->x + 4 * i, multigrid_load(l->x + 4 * i) + step(mg, i, mg->rest));
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
        subtract_elements(mg, element, l->r, i);
    multigrid_widen(l->n, mg->rest, out);
}

/* ---- Gauss-Seidel -------------------------------------------------------------------------------- */

/* A node passes on to higher ones what it has become, or collects from them. */
static void pass_on(multigrid *mg, size_t i) {
    const float *x = mg->level[0].x + 4 * i, *element = mg->element[mg->used], *place = element + mg->nodes;
    const four own = multigrid_load(x), here = multigrid_load(place + 4 * i);
    for (uint32_t k = mg->after[i]; k < mg->after[i + 1]; k++) {
        const size_t j = 4 * (size_t)mg->high[k];
        const four f = element_times(element + 2 * (size_t)k, multigrid_load(place + j) - here, own);
        multigrid_store(mg->rest + j, multigrid_load(mg->rest + j) + f);
    }
    for (int32_t k = mg->first_touching[i]; k >= 0; k = mg->touching[k].next) {
        const multigrid_coupling *c = &mg->touching[k];
        for (size_t r = 0; r < 3; r++)
            mg->rest[4 * (size_t)c->high + r] -= c->block[r] * x[0] + c->block[3 + r] * x[1] + c->block[6 + r] * x[2];
    }
}

static four collect(const multigrid *mg, size_t i, four s) {
    const float *element = mg->element[mg->used], *place = element + mg->nodes;
    const four here = multigrid_load(place + 4 * i);
    for (uint32_t k = mg->after[i]; k < mg->after[i + 1]; k++) {
        const size_t j = 4 * (size_t)mg->high[k];
        s += element_times(element + 2 * (size_t)k, multigrid_load(place + j) - here, multigrid_load(mg->level[0].x + j));
    }
    for (int32_t k = mg->first_touching[i]; k >= 0; k = mg->touching[k].next) {
        const multigrid_coupling *c = &mg->touching[k];
        const float *x = mg->level[0].x + 4 * (size_t)c->high;
        for (size_t r = 0; r < 3; r++)
            s[r] -= c->block[3 * r] * x[0] + c->block[3 * r + 1] * x[1] + c->block[3 * r + 2] * x[2];
    }
    return s;
}

static inline four solve_own(const multigrid *mg, size_t i, four s) {
    return multigrid_times(mg->level[0].inverse[mg->used] + BLOCK_FLOATS * i, s);
}

void multigrid_seidel_down(multigrid *mg) {
    const mg_level *l = &mg->level[0];
    memset(l[1].r, 0, 4 * l[1].n * sizeof *l[1].r);
    memcpy(mg->rest, l->r, 4 * l->n * sizeof *l->r);
    for (size_t i = 0; i < l->n; i++) {
        multigrid_store(l->x + 4 * i, solve_own(mg, i, multigrid_load(mg->rest + 4 * i)));
        pass_on(mg, i);
    }
    for (size_t i = 0; i < l->n; i++)
        multigrid_pass_up(l, i, free_part(l, i, collect(mg, i, multigrid_all(0.0F))), l[1].r);
}

void multigrid_seidel_up(multigrid *mg) {
    const mg_level *l = &mg->level[0];
    memcpy(mg->rest, l->r, 4 * l->n * sizeof *l->r);
    for (size_t i = 0; i < l->n; i++) {
        take_down(l, i);
        pass_on(mg, i);
    }
    for (size_t i = l->n; i-- > 0;)
        multigrid_store(l->x + 4 * i, solve_own(mg, i, collect(mg, i, multigrid_load(mg->rest + 4 * i))));
}
