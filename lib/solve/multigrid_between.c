/* multigrid_between.c: blocks of terms on all nodes: between the nodes of each element, and on each node.
 * They are stored in batches like the elements. */
#include "base/clones.h"
#include "multigrid_internal.h"

#include <string.h>

palp_status multigrid_make_room(multigrid *mg, double spread) {
    mg->spread = spread;
    mg->n_between = 9 * (mg->nodes / 2);
    mg->n_beside = 6 * mg->n_nodes;
    for (size_t k = 0; k < 2; k++) {
        mg->between[k] = arena_take(&mg->memory, mg->n_between, sizeof *mg->between[k]);
        mg->beside[k] = arena_take(&mg->memory, mg->n_beside, sizeof *mg->beside[k]);
    }
    return mg->memory.failed ? PALP_ERR_NO_MEMORY : PALP_OK;
}

void multigrid_clear_blocks(multigrid *mg) {
    memset(mg->between[1 - mg->used], 0, mg->n_between * sizeof(float));
    memset(mg->beside[1 - mg->used], 0, mg->n_beside * sizeof(float));
}

/* Distance between the nine numbers of an element's block, which is by rows. */
static inline size_t spacing_of_block_numbers(const multigrid *mg) {
    return mg->n_batches > 0 ? MULTIGRID_BATCH : 1;
}

/* Index of the first number of the k-th sorted element. */
static inline size_t place_of_element_block(const multigrid *mg, uint32_t k) {
    const size_t slot = mg->slot[k];
    return mg->n_batches > 0 ? slot / MULTIGRID_BATCH * (9 * MULTIGRID_BATCH) + slot % MULTIGRID_BATCH
                             : 9 * (size_t)k;
}

void multigrid_add_block(multigrid *mg, int32_t row, int32_t column, const double block[9]) {
    static const size_t lower[6] = {0, 3, 4, 6, 7, 8};
    const int set = 1 - mg->used;
    if (row == column) {
        for (size_t k = 0; k < 6; k++)
            mg->beside[set][6 * (size_t)row + k] += (float)block[lower[k]];
        return;
    }
    float *to = mg->between[set] +
                place_of_element_block(mg, mg->through[multigrid_entry(&mg->level[0], row, column)]);
    for (size_t k = 0; k < 9; k++)
        to[k * spacing_of_block_numbers(mg)] += (float)block[row < column ? k : 3 * (k % 3) + k / 3];
}

void multigrid_between(const multigrid *mg, int set, size_t i, size_t j, uint32_t k,
                       float block[BLOCK_FLOATS]) {
    const float *from = mg->between[set] + place_of_element_block(mg, k);
    for (size_t r = 0; r < 3; r++)
        for (size_t c = 0; c < 3; c++)
            block[4 * c + r] = from[(i < j ? 3 * r + c : 3 * c + r) * spacing_of_block_numbers(mg)];
    for (size_t c = 0; c < 3; c++)
        block[4 * c + 3] = 0.0F;
}

typedef float eight __attribute__((vector_size(MULTIGRID_BATCH * sizeof(float))));

#define LOAD(v, p) memcpy(&(v), p, sizeof(eight))
#define ADD_TO(p, v) (LOAD(sum, p), sum += (v), memcpy(p, &sum, sizeof(eight)))

/* out -= blocks between nodes times x, by axis. */
PALP_CLONES
static void subtract_batch_products(size_t n, const int32_t *batch, const float *between, size_t stride,
                                    const float *x, float *out) {
    enum { B = MULTIGRID_BATCH };
    const float *x1 = x + stride, *x2 = x1 + stride;
    float *out1 = out + stride, *out2 = out1 + stride;
    for (size_t i = 0; i < n; i++) {
        const int32_t low = batch[2 * i], high = batch[2 * i + 1];
        const float *b = between + 9 * B * i;
        eight b0, b1, b2, u0, u1, u2, v0, v1, v2, w0, w1, w2, sum;
        LOAD(u0, x + low), LOAD(u1, x1 + low), LOAD(u2, x2 + low);
        LOAD(v0, x + high), LOAD(v1, x1 + high), LOAD(v2, x2 + high);
        LOAD(b0, b), LOAD(b1, b + B), LOAD(b2, b + 2 * B);
        w0 = b0 * u0, w1 = b1 * u0, w2 = b2 * u0;
        ADD_TO(out + low, -(b0 * v0 + b1 * v1 + b2 * v2));
        LOAD(b0, b + 3 * B), LOAD(b1, b + 4 * B), LOAD(b2, b + 5 * B);
        w0 += b0 * u1, w1 += b1 * u1, w2 += b2 * u1;
        ADD_TO(out1 + low, -(b0 * v0 + b1 * v1 + b2 * v2));
        LOAD(b0, b + 6 * B), LOAD(b1, b + 7 * B), LOAD(b2, b + 8 * B);
        w0 += b0 * u2, w1 += b1 * u2, w2 += b2 * u2;
        ADD_TO(out2 + low, -(b0 * v0 + b1 * v1 + b2 * v2));
        ADD_TO(out + high, -w0), ADD_TO(out1 + high, -w1), ADD_TO(out2 + high, -w2);
    }
}

/* The same for single elements, four numbers a node. */
static void subtract_element_products(const multigrid *mg, const float *x, float *rest) {
    for (size_t i = 0; i < mg->n_nodes; i++)
        for (uint32_t k = mg->after[i]; k < mg->after[i + 1]; k++) {
            const float *b = mg->between[mg->used] + place_of_element_block(mg, k), *u = x + 4 * i,
                        *v = x + 4 * (size_t)mg->high[k];
            float *low = rest + 4 * i, *high = rest + 4 * (size_t)mg->high[k];
            for (size_t c = 0; c < 3; c++) {
                low[c] -= b[3 * c] * v[0] + b[3 * c + 1] * v[1] + b[3 * c + 2] * v[2];
                high[c] -= b[c] * u[0] + b[c + 3] * u[1] + b[c + 6] * u[2];
            }
        }
}

/* sum -= own block s times x */
static inline void subtract_own_block_product(const float *s, const float *x, float *sum) {
    sum[0] -= s[0] * x[0] + s[1] * x[1] + s[3] * x[2];
    sum[1] -= s[1] * x[0] + s[2] * x[1] + s[4] * x[2];
    sum[2] -= s[3] * x[0] + s[4] * x[1] + s[5] * x[2];
}

void multigrid_between_subtract(multigrid *mg, const float *x, float *rest) {
    const size_t n = mg->n_nodes, stride = multigrid_stride(mg);
    for (size_t i = 0; i < n; i++)
        subtract_own_block_product(mg->beside[mg->used] + 6 * i, x + 4 * i, rest + 4 * i);
    if (mg->n_batches == 0) {
        subtract_element_products(mg, x, rest);
        return;
    }
    float *in = mg->straight, *out = in + 3 * stride;
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < 3; c++) {
            in[c * stride + i] = x[4 * i + c];
            out[c * stride + i] = 0.0F;
        }
    subtract_batch_products(mg->n_batches, mg->batch, mg->between[mg->used], stride, in, out);
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < 3; c++)
            rest[4 * i + c] += out[c * stride + i];
}
