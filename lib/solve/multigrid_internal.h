/* multigrid_internal.h: levels of a multigrid, shared by its own files. */
#ifndef MULTIGRID_INTERNAL_H
#define MULTIGRID_INTERNAL_H

#include "base/arena.h"
#include "multigrid.h"

#include <string.h>

enum { MULTIGRID_LEVELS = 12, BLOCK_FLOATS = 12, MULTIGRID_BATCH = 8 };

/* A row is a node. Blocks are three columns of four floats, vectors four floats a node, the fourth is of no
 * meaning. The finest level has elements in place of blocks. */
typedef struct mg_level {
    size_t n;
    uint32_t *first;     /* [n + 1] entries of each row, its own block apart, columns ascending */
    uint32_t *middle;    /* [n] first entry behind the diagonal */
    int32_t *column;     /* [first[n]] */
    unsigned char *axes; /* [n] bits of the free axes */
    uint32_t *low_first; /* [n + 1] of those before the diagonal alone, */
    float *block[2];     /* [12 low_first[n]] the blocks: those behind it are the same, transposed; not on the
                            finest */
    float *inverse[2];   /* [12 n] of the own blocks */
    float *own[2];       /* [12 n] own blocks */
    float *x, *r;        /* [4 n] */
    uint32_t *up_first;  /* [n + 1] to the next coarser level */
    int32_t *up;         /* [up_first[n]] nodes there */
    float *weight;       /* [up_first[n]] */
    uint32_t *local_first;  /* [n + 1] row i of (D / 2 + L) P, L before the diagonal: each block's share of
                               each node that is followed */
    uint16_t *local;        /* [local_first[n]] goes to this place of the row; */
    uint32_t *target_first; /* [n + 1] for each node that node i follows, each place */
    uint32_t *target;       /* [target_first[n]] to this block of the next level */
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
    arena memory; /* of all arrays, those of the levels too */
    size_t n_nodes, n_elements, n_levels;
    uint32_t *place; /* [n_elements] of each element: slot */
    uint32_t *after; /* [n_nodes + 1] sorted elements from a node to higher ones: after[i] to after[i + 1] */
    int32_t *high;   /* [n_elements] the higher node */
    uint32_t *slot; /* [n_elements] of an element sorted so, where in element[] its two numbers begin, spacing
                       apart */
    size_t spacing;
    float *element[2];          /* [n_floats] */
    size_t n_floats, n_batches; /* batches: 0 unless the elements stand by them */
    size_t nodes; /* in element[]: the nodes' places less origin, by axis where there are batches, else four a
                     node */
    double origin[3];                /* the mean place at rest, m: near it single precision is finest */
    int32_t *batch;                  /* [2 n_batches] the first low and the first high node */
    float *straight;                 /* [6 (n_nodes + MULTIGRID_BATCH)] a vector by axis, and its product */
    uint32_t *through;               /* [first[n_nodes]] element of each entry of the finest level */
    float *node[2];                  /* [6 n_nodes] */
    multigrid_coupling *coupling[2]; /* [MULTIGRID_COUPLINGS] */
    int32_t n_couplings[2];
    int32_t *coupled; /* [n_nodes] a node's first coupling to a higher one in the set being made, or -1 */
    float *between[2], *beside[2]; /* [n_between] further blocks, rows of the lower node, [n_beside] own ones;
                                      or NULL and 0 */
    size_t n_between, n_beside;
    float *touched; /* [6 n_nodes] own blocks and couplings of the set in use, as last touched */
    multigrid_coupling *touching;
    int32_t n_touching, *first_touching; /* [n_nodes] */
    int32_t *patch; /* [n_patch] ascending, of the finest level: the nodes that something stiff touches */
    size_t n_patch;
    bool *patched; /* [n_nodes] is it one? */
    float *rest;   /* [4 n_nodes] right-hand side less what is known already */
    mg_level level[MULTIGRID_LEVELS];
    int32_t *dof; /* [3 n of the coarsest level] unknown of the factor, or -1 */
    size_t n_direct;
    linsys *factor[2];
    double *rhs;      /* [n_direct] */
    int used;         /* set of numbers that serves */
    bool definite[2]; /* without what may make it indefinite */
    mg_stage stage;   /* of the making: level and row next */
    size_t at_level, at;
    float *row; /* [12 row_max] one row of A P */
};

/* Where the sums of nodes stand by axis. */
static inline size_t multigrid_stride(const multigrid *mg) {
    return mg->n_nodes + MULTIGRID_BATCH;
}

/* The block of entry k of row i, before the diagonal. */
static inline size_t multigrid_low(const mg_level *l, size_t i, uint32_t k) {
    return (size_t)BLOCK_FLOATS * (l->low_first[i] + (k - l->first[i]));
}

/* Entry (row, column) of a level's pattern. */
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

/* d, along and across of the k-th sorted element, which is node i's. */
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

/* Four floats at once. The fourth of a node's is never used: what comes to stand in it does not matter. */
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

/* A block times a vector; and the transposed one. */
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

/* [3 n] as [4 n], and back. */
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

/* Adds s to those that node i follows, each its share; and what they have become to x. */
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

/* ---- multigrid_finest.c: the two halves of a cycle on the finest level: from its r to what is left of it on
 * the next one, and with what that has become to its x ---- */

void multigrid_finest_down(multigrid *mg);
void multigrid_finest_up(multigrid *mg);

/* ---- multigrid_batch.c ---- */

/* Sets batches and slots if the elements can stand by batches. */
palp_status multigrid_make_batches(multigrid *mg);

/* rest[4 n_nodes] less the elements' part of the tangent times x[4 n_nodes]; minus that times x[3 n_nodes] */
void multigrid_batches_subtract(multigrid *mg, const float *element, const float *x, float *rest);
void multigrid_batches_times(multigrid *mg, const float *element, const double *x, double *out);

/* ---- multigrid_between.c ---- */

/* Has a set further blocks? */
static inline bool multigrid_has_between(const multigrid *mg, int set) {
    return mg->between[set] && !mg->definite[set];
}

/* That of nodes i and j, which the k-th sorted element joins. */
void multigrid_between(const multigrid *mg, int set, size_t i, size_t j, uint32_t k,
                       float block[BLOCK_FLOATS]);

/* rest[4 n_nodes] less these blocks of the set in use times x[4 n_nodes] */
void multigrid_between_subtract(multigrid *mg, const float *x, float *rest);

/* ---- multigrid_product.c ---- */

/* Where the numbers of the products go, for all levels. */
palp_status multigrid_make_products(multigrid *mg);

/* Adds what row i of A contributes to P' A P of the set being made; how many entries it has touched in each
 * row. */
size_t multigrid_coarsen(multigrid *mg, size_t level, size_t i);

/* Entry k of row i, before the diagonal, in the set being made: a level's block, or made from the element
 * into room[12]. */
const float *multigrid_entry_block(const multigrid *mg, const mg_level *l, size_t i, uint32_t k, float *room);

#endif
