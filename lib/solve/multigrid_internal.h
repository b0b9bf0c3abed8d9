/* multigrid_internal.h: levels of a multigrid, shared by its own files. */
#ifndef MULTIGRID_INTERNAL_H
#define MULTIGRID_INTERNAL_H

#include "base/arena.h"
#include "multigrid.h"

#include <string.h>

enum { MULTIGRID_LEVELS = 12, BLOCK_FLOATS = 12, MULTIGRID_BATCH = 8 };

/* A row is a node. Blocks are three columns of four floats, vectors four floats a node; the fourth is unused.
 * The finest level has elements instead of blocks. */
typedef struct mg_level {
    size_t n;
    uint32_t *first;     /* [n + 1] entries of each row without its own block, columns ascending */
    uint32_t *middle;    /* [n] first entry behind the diagonal */
    int32_t *column;     /* [first[n]] */
    unsigned char *axes; /* [n] bits of the free axes */
    uint32_t *low_first; /* [n + 1] counts entries before the diagonal only */
    float *block[2]; /* [12 low_first[n]] blocks before the diagonal, those behind are their transposes; none
                        on the finest level */
    float *inverse[2];      /* [12 n] of the own blocks */
    float *own[2];          /* [12 n] own blocks */
    float *x, *r;           /* [4 n] */
    uint32_t *up_first;     /* [n + 1] entries of each node in up */
    int32_t *up;            /* [up_first[n]] nodes of the next coarser level */
    float *weight;          /* [up_first[n]] */
    uint32_t *local_first;  /* [n + 1] entries of row i of (D / 2 + L) P, L before the diagonal, in local */
    uint16_t *local;        /* [local_first[n]] position in the row to which this share of a block is added */
    uint32_t *target_first; /* [n + 1] entries of node i in target */
    uint32_t *target;       /* [target_first[n]] block of the next level to which each product is added */
} mg_level;

typedef enum mg_stage {
    MG_IDLE,
    MG_CLEAR,
    MG_ELEMENTS,
    MG_NODES,
    MG_INVERT,
    MG_COARSEN,
    MG_FILL,
    MG_FACTOR,
    MG_DONE
} mg_stage;

struct multigrid {
    arena memory; /* of all arrays, those of the levels included */
    size_t n_nodes, n_elements, n_levels;
    uint32_t *place; /* [n_elements] slot of each element */
    uint32_t *after; /* [n_nodes + 1] sorted elements from node i to higher ones: after[i] to after[i + 1] */
    int32_t *high;   /* [n_elements] higher node of each sorted element */
    uint32_t *
        slot; /* [n_elements] index in element[] of a sorted element's two numbers, which are spacing apart */
    size_t spacing;
    float *element[2];          /* [n_floats] */
    size_t n_floats, n_batches; /* n_batches: 0 unless elements are stored in batches */
    size_t nodes; /* index in element[] of node positions less origin: by axis with batches, else four floats
                     a node */
    double
        origin[3];   /* mean position at rest, m: coordinates relative to it lose least in single precision */
    int32_t *batch;  /* [2 n_batches] first low and first high node */
    float *straight; /* [6 (n_nodes + MULTIGRID_BATCH)] a vector by axis, and its product */
    uint32_t *through;               /* [first[n_nodes]] sorted element of each entry of the finest level */
    float *node[2];                  /* [6 n_nodes] */
    multigrid_coupling *coupling[2]; /* [MULTIGRID_COUPLINGS] */
    int32_t n_couplings[2];
    int32_t *coupled; /* [n_nodes] a node's first coupling to a higher one in the set being made, or -1 */
    float *between[2], *beside[2]; /* [n_between] blocks between nodes, rows of the lower; [n_beside] own
                                      blocks; or NULL and 0 */
    size_t n_between, n_beside;
    double spread; /* bound of their sum, over own blocks */
    float
        *touched; /* [6 n_nodes] own blocks and couplings of the set in use, from the last multigrid_touch */
    multigrid_coupling *touching;
    int32_t n_touching, *first_touching; /* [n_nodes] */
    int32_t *patch; /* [n_patch] nodes of the finest level with stiff contacts, ascending */
    size_t n_patch;
    bool *patched; /* [n_nodes] is the node in the patch? */
    float *rest;   /* [4 n_nodes] residual of the present sweep */
    mg_level level[MULTIGRID_LEVELS];
    int32_t *dof; /* [3 n of the coarsest level] its unknown in the factor, or -1 */
    size_t n_direct;
    linsys *factor[2];
    double *rhs;      /* [n_direct] */
    int used;         /* which set of numbers is in use */
    bool definite[2]; /* made without what may be indefinite */
    mg_stage stage;   /* stage of the making; its level and row are next */
    size_t at_level, at;
    float *row; /* [12 row_max] one row of A P */
};

/* Distance between the axes of vectors stored by axis. */
static inline size_t multigrid_stride(const multigrid *mg) {
    return mg->n_nodes + MULTIGRID_BATCH;
}

/* Index of the block of entry k of row i, before the diagonal. */
static inline size_t multigrid_low(const mg_level *l, size_t i, uint32_t k) {
    return (size_t)BLOCK_FLOATS * (l->low_first[i] + (k - l->first[i]));
}

/* Index of entry (row, column) in a level's pattern. */
static inline uint32_t multigrid_entry(const mg_level *l, int32_t row, int32_t column) {
    uint32_t low = l->first[row], high = l->first[row + 1];
    while (high - low > 1) {
        uint32_t half = low + (high - low) / 2;
        if (l->column[half] <= column)
            low = half;
        else
            high = half;
    }
    return low;
}

/* d, along and across of the k-th sorted element, whose lower node is i. */
static inline void multigrid_element(const multigrid *mg, const float *element, size_t i, uint32_t k,
                                     float e[5]) {
    const size_t across = mg->n_batches > 0 ? multigrid_stride(mg) : 1, along = mg->n_batches > 0 ? 1 : 4;
    const float *x = element + mg->nodes, *low = x + along * i, *high = x + along * (size_t)mg->high[k];
    for (size_t c = 0; c < 3; c++)
        e[c] = high[c * across] - low[c * across];
    e[3] = element[mg->slot[k]];
    e[4] = element[mg->slot[k] + mg->spacing];
}

static const float MULTIGRID_FREE[8][4] = {{0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}, {1, 1, 0, 0},
                                           {0, 0, 1, 0}, {1, 0, 1, 0}, {0, 1, 1, 0}, {1, 1, 1, 0}};

/* Four floats at once; the fourth of a node is never used. */
typedef float multigrid_four __attribute__((vector_size(16)));

static inline multigrid_four multigrid_load(const float *p) {
    multigrid_four v;
    memcpy(&v, p, sizeof v);
    return v;
}

static inline void multigrid_store(float *p, multigrid_four v) {
    memcpy(p, &v, sizeof v);
}

static inline multigrid_four multigrid_all(float f) {
    return (multigrid_four){f, f, f, f};
}

/* Products of a block and of its transpose with a vector. */
static inline multigrid_four multigrid_times(const float *b, multigrid_four v) {
    return multigrid_load(b) * multigrid_all(v[0]) + multigrid_load(b + 4) * multigrid_all(v[1]) +
           multigrid_load(b + 8) * multigrid_all(v[2]);
}

static inline multigrid_four multigrid_turned_times(const float *b, multigrid_four v) {
    const multigrid_four p = multigrid_load(b) * v, q = multigrid_load(b + 4) * v,
                         r = multigrid_load(b + 8) * v;
    return (multigrid_four){p[0], q[0], r[0], 0.0F} + (multigrid_four){p[1], q[1], r[1], 0.0F} +
           (multigrid_four){p[2], q[2], r[2], 0.0F};
}

/* Conversions of [3 n] to [4 n] and back. */
static inline void multigrid_narrow(size_t n, const double *v, float *to) {
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 3; k++)
            to[4 * i + k] = (float)v[3 * i + k];
}

static inline void multigrid_widen(size_t n, const float *v, double *to) {
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 3; k++)
            to[3 * i + k] = (double)v[4 * i + k];
}

/* Adds s to the coarse nodes that node i follows, by their weights; then their values to x. */
static inline void multigrid_pass_up(const mg_level *l, size_t i, multigrid_four s, float *coarse) {
    for (uint32_t k = l->up_first[i]; k < l->up_first[i + 1]; k++) {
        float *to = coarse + 4 * (size_t)l->up[k];
        multigrid_store(to, multigrid_load(to) + multigrid_all(l->weight[k]) * s);
    }
}

static inline multigrid_four multigrid_take_down(const mg_level *l, size_t i, const float *coarse,
                                                 multigrid_four x) {
    for (uint32_t k = l->up_first[i]; k < l->up_first[i + 1]; k++)
        x += multigrid_all(l->weight[k]) * multigrid_load(coarse + 4 * (size_t)l->up[k]);
    return x;
}

/* ---- multigrid_finest.c: both halves of a cycle on the finest level: from r to the next level's r, and from
 * the next level's x back to x ---- */

void multigrid_finest_down(multigrid *mg);
void multigrid_finest_up(multigrid *mg);

/* ---- multigrid_batch.c ---- */

/* Sets batches and slots if the elements can stand by batches. */
palp_status multigrid_make_batches(multigrid *mg);

/* rest[4 n_nodes] -= elements' part of the tangent times x[4 n_nodes]; the second, times x[3 n_nodes]. */
void multigrid_batches_subtract(multigrid *mg, const float *element, const float *x, float *rest);
void multigrid_batches_times(multigrid *mg, const float *element, const double *x, double *out);

/* ---- multigrid_between.c ---- */

/* Does a set have blocks of terms on all nodes? */
static inline bool multigrid_has_between(const multigrid *mg, int set) {
    return mg->between[set] && !mg->definite[set];
}

/* The block between nodes i and j, joined by the k-th sorted element. */
void multigrid_between(const multigrid *mg, int set, size_t i, size_t j, uint32_t k,
                       float block[BLOCK_FLOATS]);

/* rest[4 n_nodes] -= these blocks of the set in use times x[4 n_nodes]. */
void multigrid_between_subtract(multigrid *mg, const float *x, float *rest);

/* ---- multigrid_product.c ---- */

/* Finds where the products' numbers go, for all levels. */
palp_status multigrid_make_products(multigrid *mg);

/* Adds row i of A to P' A P of the set being made. Returns the number of entries touched in each row. */
size_t multigrid_coarsen(multigrid *mg, size_t level, size_t i);

/* Entry k of row i, before the diagonal, of the set being made: a block, or one made from the element in
 * room[12]. */
const float *multigrid_entry_block(const multigrid *mg, const mg_level *l, size_t i, uint32_t k, float *room);

#endif
