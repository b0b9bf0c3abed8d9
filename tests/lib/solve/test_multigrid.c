/* test_multigrid.c: the preconditioner against the same cycle written with dense matrices in double precision. */
#include "base/dense.h"
#include "solve/multigrid_internal.h"

#include <check.h>
#include <math.h>
#include <palpate/random.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 7, NODES = SIDE * SIDE * SIDE, PAIRS_MAX = 13 * NODES, LEVELS_MAX = 4, COUPLED = 5 };

/* A lattice with its nodes a little off their places: the bottom held, one node of the top held along one axis. */
typedef struct body {
    size_t n_pairs;
    double x[3 * NODES], node[6 * NODES];
    int32_t dof[3 * NODES], pair[2 * PAIRS_MAX];
    float element[5 * PAIRS_MAX]; /* n, along, across */
    multigrid_coupling coupling[COUPLED];
    uint64_t seed;
} body;

static void make_body(body *b, double off, double across) {
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
            const int far[3] = {abs(at[0] - j % SIDE), abs(at[1] - j / SIDE % SIDE), abs(at[2] - j / SIDE / SIDE)};
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

/* Stiffness on some nodes and between some joined ones, as contacts bring it. */
static void add_contacts(body *b, double size) {
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

static multigrid *make(const body *b, size_t direct) {
    multigrid *mg;
    ck_assert_int_eq(multigrid_create(NODES, b->x, b->dof, b->n_pairs, b->pair, direct, &mg), PALP_OK);
    return mg;
}

static palp_status number(multigrid *mg, const body *b, bool coupled, bool definite) {
    multigrid_source to = multigrid_input(mg);
    for (size_t e = 0; e < b->n_pairs; e++)
        memcpy(to.element + 5 * to.place[e], b->element + 5 * e, 5 * sizeof(float));
    for (size_t i = 0; i < 6 * NODES; i++)
        to.node[i] = (float)b->node[i];
    *to.n_couplings = coupled ? COUPLED : 0;
    memcpy(to.coupling, b->coupling, sizeof b->coupling);
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
    double *a;               /* [3 n, 3 n], 0 in held rows and columns, a coarse node's own block apart, which the next
                                level is made of as it is */
    unsigned char *free;     /* [3 n] */
    const mg_level *weights; /* to the next level */
} dense_level;

static void add_to_matrix(double *a, size_t i, size_t j, double block[3][3], double times, bool turned) {
    for (size_t r = 0; r < 3; r++)
        for (size_t c = 0; c < 3; c++)
            a[(3 * i + r) * 3 * NODES + 3 * j + c] += times * (turned ? block[c][r] : block[r][c]);
}

static void hold(dense_level *l, bool own_too) {
    for (size_t i = 0; i < 3 * l->n; i++)
        for (size_t j = 0; j < 3 * l->n; j++)
            if ((!l->free[i] || !l->free[j]) && (own_too || i / 3 != j / 3))
                l->a[i * 3 * l->n + j] = 0;
}

static void finest_matrix(const body *b, bool coupled, bool definite, dense_level *l) {
    double block[3][3];
    l->n = NODES;
    l->a = calloc(9 * NODES * NODES, sizeof *l->a);
    l->free = calloc(3 * NODES, 1);
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
    hold(l, true);
}

/* Is node i the one that coarse node `found` stands for? They are numbered in the nodes' order. */
static bool stands_for(const mg_level *l, size_t i, size_t found) {
    return l->up_first[i + 1] == l->up_first[i] + 1 && l->up[l->up_first[i]] == (int32_t)found;
}

/* P' A P, P by the weights of the level's nodes, the same for each axis. */
static void coarse_matrix(const multigrid *mg, size_t level, const dense_level *fine, dense_level *l) {
    const mg_level *w = fine->weights;
    l->n = mg->level[level + 1].n;
    double *half = calloc(9 * fine->n * l->n, sizeof *half); /* A P */
    l->a = calloc(9 * l->n * l->n, sizeof *l->a);
    l->free = calloc(3 * l->n, 1);
    for (size_t i = 0; i < 3 * fine->n; i++)
        for (size_t j = 0; j < 3 * fine->n; j++)
            for (uint32_t k = w->up_first[j / 3]; k < w->up_first[j / 3 + 1]; k++)
                half[i * 3 * l->n + 3 * (size_t)w->up[k] + j % 3] += fine->a[i * 3 * fine->n + j] * (double)w->weight[k];
    for (size_t i = 0; i < 3 * fine->n; i++)
        for (uint32_t k = w->up_first[i / 3]; k < w->up_first[i / 3 + 1]; k++)
            for (size_t j = 0; j < 3 * l->n; j++)
                l->a[(3 * (size_t)w->up[k] + i % 3) * 3 * l->n + j] += (double)w->weight[k] * half[i * 3 * l->n + j];
    for (size_t i = 0, found = 0; i < fine->n; i++) /* a coarse node is free as the one it stands for */
        if (stands_for(w, i, found))
            memcpy(l->free + 3 * found++, fine->free + 3 * i, 3);
    hold(l, false);
    free(half);
}

/* Solves the free part of a[n n] for x in place. */
static void solve(size_t n, size_t lda, const double *a, const unsigned char *is_free, double *x) {
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

/* One node's unknowns from the others as they are. */
static void relax(const dense_level *l, size_t i, const double *r, double *x) {
    double s[3];
    for (size_t k = 0; k < 3; k++) {
        s[k] = r[3 * i + k];
        for (size_t j = 0; j < 3 * l->n; j++)
            s[k] -= j / 3 != i ? l->a[(3 * i + k) * 3 * l->n + j] * x[j] : 0;
    }
    solve(3, 3 * l->n, l->a + 3 * i * 3 * l->n + 3 * i, l->free + 3 * i, s);
    memcpy(x + 3 * i, s, sizeof s);
}

static void cycle(size_t levels, const dense_level *l, const double *r, double *x) {
    memset(x, 0, 3 * l->n * sizeof *x);
    if (levels == 1) {
        memcpy(x, r, 3 * l->n * sizeof *x);
        solve(3 * l->n, 3 * l->n, l->a, l->free, x);
        return;
    }
    double *coarse_r = calloc(3 * l[1].n, sizeof *coarse_r), *coarse_x = calloc(3 * l[1].n, sizeof *coarse_x);
    const mg_level *w = l->weights;
    for (size_t i = 0; i < l->n; i++)
        relax(l, i, r, x);
    for (size_t i = 0; i < 3 * l->n; i++) {
        double left = l->free[i] ? r[i] - dense_dot(3 * l->n, l->a + i * 3 * l->n, x) : 0;
        for (uint32_t k = w->up_first[i / 3]; k < w->up_first[i / 3 + 1]; k++)
            coarse_r[3 * (size_t)w->up[k] + i % 3] += (double)w->weight[k] * left;
    }
    cycle(levels - 1, l + 1, coarse_r, coarse_x);
    for (size_t i = 0; i < 3 * l->n; i++)
        for (uint32_t k = w->up_first[i / 3]; k < w->up_first[i / 3 + 1]; k++)
            x[i] += l->free[i] ? (double)w->weight[k] * coarse_x[3 * (size_t)w->up[k] + i % 3] : 0;
    for (size_t i = l->n; i-- > 0;)
        relax(l, i, r, x);
    free(coarse_r);
    free(coarse_x);
}

static void check_cycle(multigrid *mg, const dense_level *l, uint64_t *seed) {
    static double r[3 * NODES], z[3 * NODES], wanted[3 * NODES];
    double largest = 0;
    for (size_t i = 0; i < 3 * NODES; i++)
        r[i] = palp_random_normal(seed);
    multigrid_apply(mg, r, z);
    cycle(multigrid_levels(mg), l, r, wanted);
    for (size_t i = 0; i < 3 * NODES; i++)
        largest = fmax(largest, fabs(wanted[i]));
    for (size_t i = 0; i < 3 * NODES; i++)
        ck_assert_msg(fabs(z[i] - wanted[i]) < 2e-5 * largest, "unknown %zu: %g, not %g (largest %g)", i, z[i], wanted[i], largest);
}

static void make_levels(const multigrid *mg, const body *b, bool coupled, bool definite, dense_level *l) {
    finest_matrix(b, coupled, definite, l);
    for (size_t k = 0; k < multigrid_levels(mg); k++) {
        l[k].weights = &mg->level[k];
        if (k > 0)
            coarse_matrix(mg, k - 1, &l[k - 1], &l[k]);
    }
}

static void free_levels(size_t n, dense_level *l) {
    for (size_t k = 0; k < n; k++) {
        free(l[k].a);
        free(l[k].free);
    }
}

/* ---- tests ---- */

static body b;

/* Of neighbours at most one goes to the next level, of a node and its neighbours at least one. */
START_TEST(coarse_nodes_are_apart_and_near) {
    make_body(&b, 0.4, 0.1);
    multigrid *mg = make(&b, 40);
    ck_assert_uint_eq(multigrid_levels(mg), 3);
    ck_assert_uint_eq(mg->level[1].n, 4 * 4 * 4);
    ck_assert_uint_eq(mg->level[2].n, 2 * 2 * 2);
    for (size_t k = 0; k < 2; k++) {
        const mg_level *l = &mg->level[k];
        for (size_t i = 0; i < l->n; i++) {
            size_t own = l->up_first[i + 1] - l->up_first[i], near = 0;
            for (uint32_t j = l->first[i]; j < l->first[i + 1]; j++)
                near += l->up_first[l->column[j] + 1] - l->up_first[l->column[j]] == 1;
            ck_assert(own >= 1);
            ck_assert(k > 0 || own == 1 || near == own);
        }
    }
    multigrid_free(mg);
}
END_TEST

/* The weights w have sum 1 and are where w' (D D' + 0.05 |d|^2) w is stationary under it: its gradient is the same for all. */
START_TEST(weights_are_the_nearest_mean) {
    double place[3 * NODES];
    make_body(&b, 0.4, 0.1);
    multigrid *mg = make(&b, 40);
    const mg_level *l = &mg->level[0];
    for (size_t i = 0, found = 0; i < NODES; i++)
        if (stands_for(l, i, found))
            memcpy(place + 3 * found++, b.x + 3 * i, 3 * sizeof *place);
    for (size_t i = 0; i < NODES; i++) {
        double sum = 0, low = HUGE_VAL, high = -HUGE_VAL;
        for (uint32_t p = l->up_first[i]; p < l->up_first[i + 1]; p++) {
            double gradient = 0;
            for (uint32_t q = l->up_first[i]; q < l->up_first[i + 1]; q++) {
                double dot = 0;
                for (size_t c = 0; c < 3; c++)
                    dot += (place[3 * l->up[p] + (int)c] - b.x[3 * i + c]) * (place[3 * l->up[q] + (int)c] - b.x[3 * i + c]);
                gradient += dot * (p == q ? 1.05 : 1.0) * (double)l->weight[q];
            }
            sum += (double)l->weight[p];
            low = fmin(low, gradient);
            high = fmax(high, gradient);
        }
        ck_assert_double_eq_tol(sum, 1, 1e-6);
        ck_assert_msg(high - low < 1e-5, "node %zu: %g to %g", i, low, high);
    }
    multigrid_free(mg);
}
END_TEST

/* Plain, with contacts, without what is not definite. */
START_TEST(cycle_is_that_of_dense_matrices) {
    dense_level l[LEVELS_MAX];
    make_body(&b, 0.4, _i == 2 ? 3.0 : 0.1);
    if (_i > 0)
        add_contacts(&b, 2.0);
    multigrid *mg = make(&b, 40);
    ck_assert_int_eq(number(mg, &b, _i > 0, _i == 2), PALP_OK);
    multigrid_swap(mg);
    make_levels(mg, &b, _i > 0, _i == 2, l);
    check_cycle(mg, l, &b.seed);
    free_levels(multigrid_levels(mg), l);
    multigrid_free(mg);
}
END_TEST

/* What touches changes on the finest level only. */
START_TEST(touched_nodes_change_the_finest_level) {
    dense_level l[LEVELS_MAX], now[LEVELS_MAX];
    make_body(&b, 0.4, 0.1);
    add_contacts(&b, 2.0);
    multigrid *mg = make(&b, 40);
    ck_assert_int_eq(number(mg, &b, true, false), PALP_OK);
    multigrid_swap(mg);
    make_levels(mg, &b, true, false, l);
    add_contacts(&b, 4.0);
    multigrid_touch(mg, b.node, COUPLED, b.coupling);
    finest_matrix(&b, true, false, now);
    now[0].weights = l[0].weights;
    memcpy(now + 1, l + 1, 2 * sizeof *now);
    check_cycle(mg, now, &b.seed);
    free_levels(1, now);
    free_levels(multigrid_levels(mg), l);
    multigrid_free(mg);
}
END_TEST

START_TEST(one_level_is_the_inverse) {
    dense_level l[1];
    make_body(&b, 0.4, 0.1);
    add_contacts(&b, 2.0);
    multigrid *mg = make(&b, 3 * NODES);
    ck_assert_uint_eq(multigrid_levels(mg), 1);
    ck_assert_int_eq(number(mg, &b, true, false), PALP_OK);
    multigrid_swap(mg);
    make_levels(mg, &b, true, false, l);
    check_cycle(mg, l, &b.seed);
    free_levels(1, l);
    multigrid_free(mg);
}
END_TEST

/* The set in use gives the same bits while the other is being made, and the other's after the swap. */
START_TEST(one_set_serves_while_the_other_is_made) {
    static double r[3 * NODES], first[3 * NODES], z[3 * NODES];
    bool done;
    make_body(&b, 0.4, 0.1);
    multigrid *mg = make(&b, 40);
    ck_assert_int_eq(number(mg, &b, false, false), PALP_OK);
    multigrid_swap(mg);
    for (size_t i = 0; i < 3 * NODES; i++)
        r[i] = palp_random_normal(&b.seed);
    multigrid_apply(mg, r, first);
    for (size_t i = 0; i < b.n_pairs; i++)
        b.element[5 * i + 3] *= 2.0F, b.element[5 * i + 4] *= 2.0F;
    ck_assert_int_eq(number(mg, &b, false, false), PALP_OK);
    multigrid_apply(mg, r, z);
    ck_assert_mem_eq(z, first, sizeof z);
    ck_assert_int_eq(multigrid_advance(mg, 1.0, &done), PALP_OK);
    ck_assert(done);
    multigrid_swap(mg);
    multigrid_apply(mg, r, z);
    for (size_t i = 0; i < 3 * NODES; i++) /* twice as stiff; a factor of 2 rounds nothing */
        ck_assert_msg(z[i] == 0.5 * first[i], "unknown %zu: %.9g, half of %.9g", i, z[i], first[i]);
    multigrid_free(mg);
}
END_TEST

/* The share of an error that a cycle leaves in the long run, in the energy norm of the tangent, on an even lattice. */
START_TEST(contraction) {
    static double r[3 * NODES], z[3 * NODES], x[3 * NODES];
    dense_level l;
    double energy[12];
    make_body(&b, 0, 0);
    multigrid *mg = make(&b, 40);
    ck_assert_int_eq(number(mg, &b, false, false), PALP_OK);
    multigrid_swap(mg);
    finest_matrix(&b, false, false, &l);
    for (size_t i = 0; i < 3 * NODES; i++)
        x[i] = l.free[i] ? palp_random_normal(&b.seed) : 0;
    for (size_t k = 0; k < 12; k++) {
        energy[k] = 0;
        for (size_t i = 0; i < 3 * NODES; i++) {
            r[i] = dense_dot(3 * NODES, l.a + i * 3 * NODES, x);
            energy[k] += x[i] * r[i];
        }
        multigrid_apply(mg, r, z);
        for (size_t i = 0; i < 3 * NODES; i++)
            x[i] -= z[i];
    }
    double rate = sqrt(energy[11] / energy[10]);
    ck_assert_msg(rate > 0.64 && rate < 0.655, "%g", rate);
    free_levels(1, &l);
    multigrid_free(mg);
}
END_TEST

START_TEST(what_is_not_definite_is_told) {
    make_body(&b, 0.4, 0.1);
    for (size_t e = 0; e < b.n_pairs; e++)
        b.element[5 * e + 4] = -2.0F;
    for (size_t direct = 40; direct <= 3 * NODES; direct += 3 * NODES - 40) {
        multigrid *mg = make(&b, direct);
        ck_assert_int_eq(number(mg, &b, false, false), PALP_ERR_SINGULAR);
        ck_assert_int_eq(number(mg, &b, false, true), PALP_OK);
        multigrid_free(mg);
    }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, coarse_nodes_are_apart_and_near);
    tcase_add_test(tc, weights_are_the_nearest_mean);
    tcase_add_loop_test(tc, cycle_is_that_of_dense_matrices, 0, 3);
    tcase_add_test(tc, touched_nodes_change_the_finest_level);
    tcase_add_test(tc, one_level_is_the_inverse);
    tcase_add_test(tc, one_set_serves_while_the_other_is_made);
    tcase_add_test(tc, contraction);
    tcase_add_test(tc, what_is_not_definite_is_told);
}
