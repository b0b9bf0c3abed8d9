/* multigrid_finest.c: the finest level of a cycle, on the elements. */
#include "multigrid_internal.h"

#include <string.h>

/* ---- damped Jacobi ------------------------------------------------------------------------------- */

/* Of a step before the coarser levels and one behind them. The elements' part of the tangent is at most twice that of its own
 * blocks, as that of a single element is; a step is a contraction up to 2.7. */
static const float DAMPING = 0.74F;

/* Four floats at once. The fourth of a node's is never used: what comes to stand in it does not matter. */
typedef float four __attribute__((vector_size(16)));

static inline four load(const float *p) {
    four v;
    memcpy(&v, p, sizeof v);
    return v;
}

static inline void store(float *p, four v) {
    memcpy(p, &v, sizeof v);
}

static inline four all(float f) {
    return (four){f, f, f, f};
}

/* left -= the elements' part of the tangent times x, those from node i to higher ones */
static inline void subtract_elements(const multigrid *mg, size_t i, const float *x, float *restrict left) {
    const four own = load(x + 4 * i);
    four sum = load(left + 4 * i);
    for (uint32_t k = mg->after[i]; k < mg->after[i + 1]; k++) {
        const float *e = mg->element[mg->used] + 5 * (size_t)k;
        float *to = left + 4 * (size_t)mg->high[k];
        const four n = load(e), d = load(x + 4 * (size_t)mg->high[k]) - own, p = n * d;
        const four f = all(e[3] * (p[0] + p[1] + p[2])) * n + all(e[4]) * d;
        sum += f;
        store(to, load(to) - f);
    }
    store(left + 4 * i, sum);
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
    for (size_t i = 0; i < l->n; i++) {
        subtract_elements(mg, i, l->x, mg->rest); /* the last ones to it, too */
        store(mg->rest + 4 * i, load(mg->rest + 4 * i) * load(MULTIGRID_FREE[l->axes[i]]));
    }
}

/* z = what a step makes of r */
static inline void step(const multigrid *mg, size_t i, const float *r, float z[4]) {
    multigrid_times_inverse(mg->level[0].inverse[mg->used] + BLOCK_FLOATS * i, r + 4 * i, z);
    for (size_t k = 0; k < 4; k++)
        z[k] *= DAMPING;
}

void multigrid_jacobi_down(multigrid *mg) {
    const mg_level *l = &mg->level[0];
    for (size_t i = 0; i < l->n; i++)
        step(mg, i, l->r, l->x + 4 * i);
    find_rest(mg);
    memset(l[1].r, 0, 4 * l[1].n * sizeof *l[1].r);
    for (size_t i = 0; i < l->n; i++)
        multigrid_pass_up(l, i, mg->rest + 4 * i, l[1].r);
}

void multigrid_jacobi_up(multigrid *mg) {
    const mg_level *l = &mg->level[0];
    for (size_t i = 0; i < l->n; i++) {
        float s[4] = {0.0F};
        multigrid_take_down(l, i, l[1].x, s);
        for (size_t k = 0; k < 4; k++)
            l->x[4 * i + k] += MULTIGRID_FREE[l->axes[i]][k] * s[k];
    }
    find_rest(mg);
    for (size_t i = 0; i < l->n; i++) {
        float z[4];
        step(mg, i, mg->rest, z);
        for (size_t k = 0; k < 4; k++)
            l->x[4 * i + k] += z[k];
    }
}

/* ---- Gauss-Seidel -------------------------------------------------------------------------------- */

/* y += (along n n' + across 1) x */
static inline void add_element(const float *e, const float *x, float *y) {
    float t = e[3] * (e[0] * x[0] + e[1] * x[1] + e[2] * x[2]);
    y[0] += t * e[0] + e[4] * x[0];
    y[1] += t * e[1] + e[4] * x[1];
    y[2] += t * e[2] + e[4] * x[2];
}

/* Gauss-Seidel on the elements: a node passes on to higher ones what it has become, or collects from them. */
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

void multigrid_seidel_down(multigrid *mg) {
    mg_level *l = &mg->level[0], *coarse = l + 1;
    memset(coarse->r, 0, 4 * coarse->n * sizeof *coarse->r);
    memcpy(mg->rest, l->r, 4 * l->n * sizeof *l->r);
    for (size_t i = 0; i < l->n; i++) {
        multigrid_times_inverse(l->inverse[mg->used] + BLOCK_FLOATS * i, mg->rest + 4 * i, l->x + 4 * i);
        pass_on(mg, i);
    }
    for (size_t i = 0; i < l->n; i++) {
        float s[4] = {0.0F};
        collect(mg, i, s);
        for (size_t r = 0; r < 4; r++)
            s[r] *= MULTIGRID_FREE[l->axes[i]][r];
        multigrid_pass_up(l, i, s, coarse->r);
    }
}

void multigrid_seidel_up(multigrid *mg) {
    mg_level *l = &mg->level[0], *coarse = l + 1;
    memcpy(mg->rest, l->r, 4 * l->n * sizeof *l->r);
    for (size_t i = 0; i < l->n; i++) {
        float s[4] = {0.0F};
        multigrid_take_down(l, i, coarse->x, s);
        for (size_t r = 0; r < 4; r++)
            l->x[4 * i + r] += MULTIGRID_FREE[l->axes[i]][r] * s[r];
        pass_on(mg, i);
    }
    for (size_t i = l->n; i-- > 0;) {
        collect(mg, i, mg->rest + 4 * i);
        multigrid_times_inverse(l->inverse[mg->used] + BLOCK_FLOATS * i, mg->rest + 4 * i, l->x + 4 * i);
    }
}
