/* multigrid_dense.h: a body for the tests of the multigrid, and the same cycle with dense matrices in double
 * precision. */
#ifndef MULTIGRID_DENSE_H
#define MULTIGRID_DENSE_H

#include "base/dense.h"
#include "solve/multigrid_internal.h"

#include <check.h>
#include <math.h>
#include <palpate/random.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 7, NODES = SIDE * SIDE * SIDE, PAIRS_MAX = 13 * NODES, LEVELS_MAX = 4, COUPLED = 5 };

/* A lattice with its nodes a little off their places: the bottom held, one node of the top held along one
 * axis. */
typedef struct body {
    size_t n_pairs;
    double x[3 * NODES], node[6 * NODES];
    int32_t dof[3 * NODES], pair[2 * PAIRS_MAX];
    float element[5 * PAIRS_MAX]; /* n, along, across */
    multigrid_coupling coupling[COUPLED];
    double
        further[6 * PAIRS_MAX]; /* g of both ends of a pair, whose energy grows by (g . x)^2 / 2; 0: none */
    uint64_t seed;
} body;

static inline void make_body(body *b, double off, double across) {
    memset(b, 0, sizeof *b);
    b->seed = 5;
    int32_t unknowns = 0;
    for (int i = 0; i < NODES; i++) {
        const int at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        for (int k = 0; k < 3; k++) {
            b->x[3 * i + k] = at[k] + off * (palp_random_uniform(&b->seed) - 0.5);
            b->dof[3 * i + k] = at[1] == 0 || (i == NODES - 1 && k == 2) ? -1 : unknowns++;
        }
        for (int j = 0; j < i; j++) {
            const int far[3] = {abs(at[0] - j % SIDE), abs(at[1] - j / SIDE % SIDE),
                                abs(at[2] - j / SIDE / SIDE)};
            if (far[0] <= 1 && far[1] <= 1 && far[2] <= 1) {
                bool turned = (i + j) % 3 == 0; /* either end may come first */
                b->pair[2 * b->n_pairs] = turned ? i : j;
                b->pair[2 * b->n_pairs++ + 1] = turned ? j : i;
            }
        }
    }
    for (size_t e = 0; e < b->n_pairs; e++) {
        double d[3], length = 0;
        for (int k = 0; k < 3; k++) {
            d[k] = b->x[3 * b->pair[2 * e + 1] + k] - b->x[3 * b->pair[2 * e] + k];
            length += d[k] * d[k];
        }
        for (int k = 0; k < 3; k++)
            b->element[5 * e + (size_t)k] = (float)(d[k] / sqrt(length));
        b->element[5 * e + 3] = (float)((off > 0 ? 0.5 + palp_random_uniform(&b->seed) : 1.0) / sqrt(length));
        b->element[5 * e + 4] = (float)(across * (palp_random_uniform(&b->seed) - 0.3));
    }
}

/* The same body with node i as to[i]. */
static inline void renumber_as(body *b, const int32_t *to) {
    static body old;
    old = *b;
    for (size_t i = 0; i < NODES; i++)
        for (size_t k = 0; k < 3; k++) {
            b->x[3 * (size_t)to[i] + k] = old.x[3 * i + k];
            b->dof[3 * (size_t)to[i] + k] = old.dof[3 * i + k];
        }
    for (size_t e = 0; e < 2 * b->n_pairs; e++)
        b->pair[e] = to[old.pair[e]];
}

/* In another order: coarse nodes are then anywhere, and some follow held ones. */
static inline void renumber(body *b) {
    int32_t to[NODES];
    for (int32_t i = 0; i < NODES; i++)
        to[i] = 100 * i % NODES;
    renumber_as(b, to);
}

/* In an order by chance: no two elements are alike. */
static inline void shuffle(body *b) {
    int32_t to[NODES];
    for (int32_t i = 0; i < NODES; i++) {
        const int32_t j = (int32_t)(palp_random_uniform(&b->seed) * (i + 1));
        to[i] = to[j];
        to[j] = i;
    }
    renumber_as(b, to);
}

/* Stiffness on some nodes and between some joined ones, as contacts bring it. */
static inline void add_contacts(body *b, double size) {
    for (size_t i = 0; i < NODES; i += 3) {
        double v[3];
        for (size_t k = 0; k < 3; k++)
            v[k] = size * (palp_random_uniform(&b->seed) - 0.5);
        double *to = b->node + 6 * i;
        to[0] = v[0] * v[0] + 0.1 * size, to[1] = v[1] * v[0], to[2] = v[1] * v[1] + 0.1 * size;
        to[3] = v[2] * v[0], to[4] = v[2] * v[1], to[5] = v[2] * v[2] + 0.1 * size;
    }
    for (size_t k = 0; k < COUPLED; k++) {
        const int32_t *pair = b->pair + 2 * (b->n_pairs - 1 - 17 * k);
        b->coupling[k].low = pair[0] < pair[1] ? pair[0] : pair[1];
        b->coupling[k].high = pair[0] < pair[1] ? pair[1] : pair[0];
        for (size_t i = 0; i < 9; i++)
            b->coupling[k].block[i] = (float)(0.1 * size * (palp_random_uniform(&b->seed) - 0.5));
    }
}

static inline void add_further(body *b, double size) {
    for (size_t i = 0; i < 6 * b->n_pairs; i++)
        b->further[i] = size * (palp_random_uniform(&b->seed) - 0.5);
}

static inline multigrid *make(const body *b, size_t direct) {
    multigrid *mg;
    ck_assert_int_eq(multigrid_create(NODES, b->x, b->dof, b->n_pairs, b->pair, direct, &mg), PALP_OK);
    if (b->further[0] != 0.0)
        ck_assert_int_eq(multigrid_make_room(mg, 4.0), PALP_OK);
    return mg;
}

/* Further blocks of each pair: own ones, and between them with either end first. */
static inline void number_further(multigrid *mg, const body *b) {
    multigrid_clear_blocks(mg);
    for (size_t e = 0; e < b->n_pairs; e++)
        for (size_t k = 0; k < 3; k++) {
            const size_t p = k == 0 ? e % 2 : k - 1, q = k == 0 ? 1 - e % 2 : k - 1;
            double block[9];
            for (size_t i = 0; i < 9; i++)
                block[i] = b->further[6 * e + 3 * p + i / 3] * b->further[6 * e + 3 * q + i % 3];
            multigrid_add_block(mg, b->pair[2 * e + p], b->pair[2 * e + q], block);
        }
}

static inline palp_status number(multigrid *mg, const body *b, bool coupled, bool definite) {
    multigrid_source to = multigrid_input(mg);
    for (size_t e = 0; e < b->n_pairs; e++) {
        double square = 0;
        for (size_t k = 0; k < 3; k++) {
            double d = b->x[3 * (size_t)b->pair[2 * e + 1] + k] - b->x[3 * (size_t)b->pair[2 * e] + k];
            square += d * d;
        }
        to.element[to.place[e]] = (float)((double)b->element[5 * e + 3] / square);
        to.element[to.place[e] + to.spacing] = b->element[5 * e + 4];
    }
    multigrid_place_nodes(mg, b->x, to.element);
    for (size_t i = 0; i < 6 * NODES; i++)
        to.node[i] = (float)b->node[i];
    *to.n_couplings = coupled ? COUPLED : 0;
    memcpy(to.coupling, b->coupling, sizeof b->coupling);
    if (b->further[0] != 0.0)
        number_further(mg, b);
    multigrid_begin(mg, definite);
    bool done = false;
    palp_status status = PALP_OK;
    while (!done && !status)
        status = multigrid_advance(mg, 100.0, &done);
    return status;
}

/* ---- the same with dense matrices ---- */

typedef struct dense_level {
    size_t n;
    double *a;               /* [3 n, 3 n], 0 in held rows and columns */
    unsigned char *free;     /* [3 n] */
    const mg_level *weights; /* to the next level */
    double *more;            /* [9 n] added to own blocks that are inverted; or NULL */
    const bool *swept; /* [n] nodes that Gauss-Seidel is for, the others being damped Jacobi's; NULL: all */
} dense_level;

static inline void add_to_matrix(double *a, size_t i, size_t j, double block[3][3], double times,
                                 bool turned) {
    for (size_t r = 0; r < 3; r++)
        for (size_t c = 0; c < 3; c++)
            a[(3 * i + r) * 3 * NODES + 3 * j + c] += times * (turned ? block[c][r] : block[r][c]);
}

static inline void hold(dense_level *l) {
    for (size_t i = 0; i < 3 * l->n; i++)
        for (size_t j = 0; j < 3 * l->n; j++)
            if (!l->free[i] || !l->free[j])
                l->a[i * 3 * l->n + j] = 0;
}

static inline void finest_matrix(const body *b, bool coupled, bool definite, dense_level *l) {
    double block[3][3];
    l->n = NODES;
    l->a = calloc(9 * NODES * NODES, sizeof *l->a);
    l->free = calloc(3 * NODES, 1);
    l->more = calloc(9 * NODES, sizeof *l->more);
    for (size_t i = 0; i < 3 * NODES; i++)
        l->free[i] = b->dof[i] >= 0;
    for (size_t e = 0; e < b->n_pairs; e++) {
        const float *s = b->element + 5 * e;
        double along = (double)s[3], across = (double)s[4];
        if (definite) {
            across = fmax(across, 0);
            along = fmax(along, -across);
        }
        for (size_t r = 0; r < 3; r++)
            for (size_t c = 0; c < 3; c++)
                block[r][c] = along * (double)s[r] * (double)s[c] + (r == c ? across : 0);
        size_t i = (size_t)b->pair[2 * e], j = (size_t)b->pair[2 * e + 1];
        add_to_matrix(l->a, i, i, block, 1, false);
        add_to_matrix(l->a, j, j, block, 1, false);
        add_to_matrix(l->a, i, j, block, -1, false);
        add_to_matrix(l->a, j, i, block, -1, false);
    }
    for (size_t i = 0; i < NODES; i++) {
        for (size_t r = 0; r < 3; r++)
            for (size_t c = 0; c < 3; c++)
                block[r][c] = b->node[6 * i + (r > c ? r * (r + 1) / 2 + c : c * (c + 1) / 2 + r)];
        add_to_matrix(l->a, i, i, block, 1, false);
    }
    for (size_t k = 0; k < COUPLED && coupled; k++) {
        size_t low = (size_t)b->coupling[k].low, high = (size_t)b->coupling[k].high;
        for (size_t i = 0; i < 9; i++)
            block[i / 3][i % 3] = (double)b->coupling[k].block[i];
        add_to_matrix(l->a, low, high, block, 1, false);
        add_to_matrix(l->a, high, low, block, 1, true);
    }
    for (size_t e = 0; e < b->n_pairs && b->further[0] != 0.0 && !definite; e++)
        for (size_t i = 0; i < 36; i++) {
            const size_t p = i / 18, q = i / 9 % 2, row = (size_t)b->pair[2 * e + p],
                         column = (size_t)b->pair[2 * e + q];
            const double product = b->further[6 * e + 3 * p + i / 3 % 3] * b->further[6 * e + 3 * q + i % 3];
            l->a[(3 * row + i / 3 % 3) * 3 * NODES + 3 * column + i % 3] += product;
            if (p == q)
                l->more[9 * row + i % 9] += 0.5 * product;
        }
    hold(l);
}

/* Is node i the one that coarse node `found` stands for? They are numbered in the nodes' order. */
static inline bool stands_for(const mg_level *l, size_t i, size_t found) {
    return l->up_first[i + 1] == l->up_first[i] + 1 && l->up[l->up_first[i]] == (int32_t)found;
}

/* P' A P, P by the weights of the level's nodes, the same for each axis. */
static inline void coarse_matrix(const multigrid *mg, size_t level, const dense_level *fine, dense_level *l) {
    const mg_level *w = fine->weights;
    l->n = mg->level[level + 1].n;
    l->swept = NULL;
    l->more = NULL;
    double *half = calloc(9 * fine->n * l->n, sizeof *half); /* A P */
    l->a = calloc(9 * l->n * l->n, sizeof *l->a);
    l->free = calloc(3 * l->n, 1);
    for (size_t i = 0; i < 3 * fine->n; i++)
        for (size_t j = 0; j < 3 * fine->n; j++)
            for (uint32_t k = w->up_first[j / 3]; k < w->up_first[j / 3 + 1]; k++)
                half[i * 3 * l->n + 3 * (size_t)w->up[k] + j % 3] +=
                    fine->a[i * 3 * fine->n + j] * (double)w->weight[k];
    for (size_t i = 0; i < 3 * fine->n; i++)
        for (uint32_t k = w->up_first[i / 3]; k < w->up_first[i / 3 + 1]; k++)
            for (size_t j = 0; j < 3 * l->n; j++)
                l->a[(3 * (size_t)w->up[k] + i % 3) * 3 * l->n + j] +=
                    (double)w->weight[k] * half[i * 3 * l->n + j];
    for (size_t i = 0, found = 0; i < fine->n; i++) /* a coarse node is free as the one it stands for */
        if (stands_for(w, i, found))
            memcpy(l->free + 3 * found++, fine->free + 3 * i, 3);
    hold(l);
    free(half);
}

/* Solves the free part of a[n n] for x in place. */
static inline void solve(size_t n, size_t lda, const double *a, const unsigned char *is_free, double *x) {
    double *l = calloc(n * n, sizeof *l);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j <= i; j++)
            l[i * n + j] = is_free[i] && is_free[j] ? a[i * lda + j] : i == j;
        x[i] = is_free[i] ? x[i] : 0;
    }
    ck_assert(dense_cholesky(n, l));
    dense_cholesky_solve(n, l, 1, x);
    free(l);
}

/* left = r - a x where free, of nodes from to end */
static inline void find_residual(const dense_level *l, size_t from, size_t end, const double *r,
                                 const double *x, double *left) {
    for (size_t i = 3 * from; i < 3 * end; i++)
        left[i] = l->free[i] ? r[i] - dense_dot(3 * l->n, l->a + i * 3 * l->n, x) : 0;
}

/* left of node i by its own block, and what is more. */
static inline void solve_own(const dense_level *l, size_t i, double *left) {
    double own[9];
    for (size_t k = 0; k < 9; k++)
        own[k] = l->a[(3 * i + k / 3) * 3 * l->n + 3 * i + k % 3] + (l->more ? l->more[9 * i + k] : 0);
    solve(3, 3, own, l->free + 3 * i, left);
}

/* Gauss-Seidel over the nodes that it is for, up in turned order. */
static inline void sweep(const dense_level *l, const double *r, double *x, bool up) {
    double *left = calloc(3 * l->n, sizeof *left);
    for (size_t k = 0; k < l->n; k++) {
        const size_t i = up ? l->n - 1 - k : k;
        if (l->swept && !l->swept[i])
            continue;
        find_residual(l, i, i + 1, r, x, left);
        solve_own(l, i, left + 3 * i);
        for (size_t c = 3 * i; c < 3 * i + 3; c++)
            x[c] += left[c];
    }
    free(left);
}

/* A step of damped Jacobi at the others. */
static inline void step_aside(const dense_level *l, const double *r, double *x) {
    double *left = calloc(3 * l->n, sizeof *left);
    find_residual(l, 0, l->n, r, x, left);
    for (size_t i = 0; i < l->n; i++) {
        if (!l->swept || l->swept[i])
            continue;
        solve_own(l, i, left + 3 * i);
        for (size_t c = 3 * i; c < 3 * i + 3; c++)
            x[c] += 0.74 * left[c];
    }
    free(left);
}

static inline void smooth(const dense_level *l, const double *r, double *x, bool up) {
    if (!up)
        sweep(l, r, x, false);
    step_aside(l, r, x);
    if (up)
        sweep(l, r, x, true);
}

static inline void cycle(size_t levels, const dense_level *l, const double *r, double *x) {
    memset(x, 0, 3 * l->n * sizeof *x);
    if (levels == 1) {
        memcpy(x, r, 3 * l->n * sizeof *x);
        solve(3 * l->n, 3 * l->n, l->a, l->free, x);
        return;
    }
    double *coarse_r = calloc(3 * l[1].n, sizeof *coarse_r), *coarse_x = calloc(3 * l[1].n, sizeof *coarse_x);
    const mg_level *w = l->weights;
    double *left = calloc(3 * l->n, sizeof *left);
    smooth(l, r, x, false);
    find_residual(l, 0, l->n, r, x, left);
    for (size_t i = 0; i < 3 * l->n; i++)
        for (uint32_t k = w->up_first[i / 3]; k < w->up_first[i / 3 + 1]; k++)
            coarse_r[3 * (size_t)w->up[k] + i % 3] += (double)w->weight[k] * left[i];
    free(left);
    cycle(levels - 1, l + 1, coarse_r, coarse_x);
    for (size_t i = 0; i < 3 * l->n; i++)
        for (uint32_t k = w->up_first[i / 3]; k < w->up_first[i / 3 + 1]; k++)
            x[i] += l->free[i] ? (double)w->weight[k] * coarse_x[3 * (size_t)w->up[k] + i % 3] : 0;
    smooth(l, r, x, true);
    free(coarse_r);
    free(coarse_x);
}

static inline void check_cycle(multigrid *mg, const dense_level *l, uint64_t *seed) {
    static double r[3 * NODES], z[3 * NODES], wanted[3 * NODES];
    double largest = 0;
    for (size_t i = 0; i < 3 * NODES; i++)
        r[i] = palp_random_normal(seed);
    multigrid_apply(mg, r, z);
    cycle(multigrid_levels(mg), l, r, wanted);
    for (size_t i = 0; i < 3 * NODES; i++)
        largest = fmax(largest, fabs(wanted[i]));
    for (size_t i = 0; i < 3 * NODES; i++)
        ck_assert_msg(fabs(z[i] - wanted[i]) < 2e-5 * largest, "unknown %zu: %g, not %g (largest %g)", i,
                      z[i], wanted[i], largest);
}

static inline void make_levels(const multigrid *mg, const body *b, bool coupled, bool definite,
                               dense_level *l) {
    finest_matrix(b, coupled, definite, l);
    l[0].swept = mg->patched;
    for (size_t k = 0; k < multigrid_levels(mg); k++) {
        l[k].weights = &mg->level[k];
        if (k > 0)
            coarse_matrix(mg, k - 1, &l[k - 1], &l[k]);
    }
}

static inline void free_levels(size_t n, dense_level *l) {
    for (size_t k = 0; k < n; k++) {
        free(l[k].a);
        free(l[k].free);
        free(l[k].more);
    }
}

#endif
