/* multigrid_batch.c: elements of the finest level in batches: element k of a batch joins nodes low + k and
 * high + k. Loops over a batch have no indices and are vectorized. Nearly all elements of a lattice, numbered
 * along its axes, are in full batches. Elements missing in a batch have blocks of 0. */
#include "base/clones.h"
#include "multigrid_internal.h"

#include <stdlib.h>
#include <string.h>

/* Batches of one direction stand together for so many nodes. With fewer, a load would wait for a store that
 * overlaps it; with more, data leave the nearest cache. */
enum { STRETCH = 128 };
static const double SPARSE = 2.0; /* places per element above which batches do not pay */

/* An element, or a place of which k is the element's number in the caller's order. */
typedef struct parallel {
    int32_t stretch, offset, low;
    uint32_t k;
} parallel;

static int compare_parallel_elements(const void *a, const void *b) {
    const parallel *p = a, *q = b;
    if (p->stretch != q->stretch)
        return p->stretch < q->stretch ? -1 : 1;
    if (p->offset != q->offset)
        return p->offset < q->offset ? -1 : 1;
    if (p->low != q->low)
        return p->low < q->low ? -1 : 1;
    return (p->k > q->k) - (p->k < q->k);
}

static parallel *sort_parallel_elements(const multigrid *mg) {
    parallel *p = malloc((mg->n_elements + 1) * sizeof *p);
    for (size_t i = 0; i < mg->n_nodes && p; i++)
        for (uint32_t k = mg->after[i]; k < mg->after[i + 1]; k++)
            p[k] = (parallel){(int32_t)i / STRETCH, mg->high[k] - (int32_t)i, (int32_t)i, k};
    if (p)
        qsort(p, mg->n_elements, sizeof *p, compare_parallel_elements);
    return p;
}

/* Forms batches of sorted elements; returns their number, and lists them unless batch is NULL. */
static size_t list_element_batches(multigrid *mg, const parallel *p, int32_t *batch) {
    size_t n = 0;
    int32_t start = 0;
    for (size_t i = 0; i < mg->n_elements; i++) {
        bool same = i > 0 && p[i].stretch == p[i - 1].stretch && p[i].offset == p[i - 1].offset;
        if (!same || p[i].low - start >= MULTIGRID_BATCH || p[i].low == p[i - 1].low) {
            start = p[i].low;
            if (batch) {
                batch[2 * n] = start;
                batch[2 * n + 1] = start + p[i].offset;
            }
            n++;
        }
        if (batch)
            mg->slot[p[i].k] = (uint32_t)(MULTIGRID_BATCH * (n - 1)) + (uint32_t)(p[i].low - start);
    }
    return n;
}

palp_status multigrid_make_batches(multigrid *mg) {
    parallel *p = sort_parallel_elements(mg);
    if (!p)
        return PALP_ERR_NO_MEMORY;
    size_t n = list_element_batches(mg, p, NULL);
    if ((double)(n * MULTIGRID_BATCH) <= SPARSE * (double)mg->n_elements) {
        mg->n_batches = n;
        mg->batch = arena_take(&mg->memory, 2 * n, sizeof *mg->batch);
        mg->straight = arena_take(&mg->memory, 6 * multigrid_stride(mg), sizeof *mg->straight);
        if (!mg->memory.failed)
            list_element_batches(mg, p, mg->batch);
    }
    free(p);
    return mg->memory.failed ? PALP_ERR_NO_MEMORY : PALP_OK;
}

/* The numbers of a batch as one vector. Local variables only: passing them to functions differs with and
 * without AVX. */
typedef float eight __attribute__((vector_size(MULTIGRID_BATCH * sizeof(float))));

#define LOAD(v, p) memcpy(&(v), p, sizeof(eight))
#define ADD_TO(p, v) (LOAD(sum, p), sum += (v), memcpy(p, &sum, sizeof(eight)))

/* out -= the batches' part of the tangent times x. Both are by axis, [3 stride], as are the nodes'
 * positions. */
PALP_CLONES
static void multiply_element_batches(size_t n, const int32_t *batch, const float *element, const float *place,
                                     size_t stride, const float *x, float *out) {
    const float *x1 = x + stride, *x2 = x1 + stride, *place1 = place + stride, *place2 = place1 + stride;
    float *out1 = out + stride, *out2 = out1 + stride;
    for (size_t i = 0; i < n; i++) {
        const int32_t low = batch[2 * i], high = batch[2 * i + 1];
        const float *e = element + MULTIGRID_BATCH * i;
        eight d0, d1, d2, along, across, a0, a1, a2, u0, u1, u2, sum;
        LOAD(along, e), LOAD(across, e + MULTIGRID_BATCH * n);
        LOAD(a0, place + low), LOAD(a1, place1 + low), LOAD(a2, place2 + low);
        LOAD(d0, place + high), LOAD(d1, place1 + high), LOAD(d2, place2 + high);
        d0 -= a0, d1 -= a1, d2 -= a2;
        LOAD(a0, x + low), LOAD(a1, x1 + low), LOAD(a2, x2 + low);
        LOAD(u0, x + high), LOAD(u1, x1 + high), LOAD(u2, x2 + high);
        u0 -= a0, u1 -= a1, u2 -= a2;
        along *= d0 * u0 + d1 * u1 + d2 * u2;
        u0 = along * d0 + across * u0, u1 = along * d1 + across * u1, u2 = along * d2 + across * u2;
        ADD_TO(out + low, u0), ADD_TO(out1 + low, u1), ADD_TO(out2 + low, u2);
        ADD_TO(out + high, -u0), ADD_TO(out1 + high, -u1), ADD_TO(out2 + high, -u2);
    }
}

static void multiply_all_batches(multigrid *mg, const float *element) {
    const size_t stride = multigrid_stride(mg);
    float *out = mg->straight + 3 * stride;
    memset(out, 0, 3 * stride * sizeof *out);
    multiply_element_batches(mg->n_batches, mg->batch, element, element + mg->nodes, stride, mg->straight,
                             out);
}

void multigrid_batches_subtract(multigrid *mg, const float *element, const float *x, float *rest) {
    const size_t n = mg->n_nodes, stride = multigrid_stride(mg);
    float *in = mg->straight, *out = in + 3 * stride;
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < 3; c++)
            in[c * stride + i] = x[4 * i + c];
    multiply_all_batches(mg, element);
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < 3; c++)
            rest[4 * i + c] += out[c * stride + i];
}

void multigrid_batches_times(multigrid *mg, const float *element, const double *x, double *out) {
    const size_t n = mg->n_nodes, stride = multigrid_stride(mg);
    float *in = mg->straight, *sum = in + 3 * stride;
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < 3; c++)
            in[c * stride + i] = (float)x[3 * i + c];
    multiply_all_batches(mg, element);
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < 3; c++)
            out[3 * i + c] = (double)sum[c * stride + i];
}
