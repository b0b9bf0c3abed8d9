/* test_multigrid.c: the preconditioner against the same cycle written with dense matrices in double
 * precision. */
#include "multigrid_dense.h"

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

/* The weights w have sum 1 and are where w' (D D' + 0.05 |d|^2) w is stationary under it: its gradient is the
 * same for all. */
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
                    dot += (place[3 * l->up[p] + (int)c] - b.x[3 * i + c]) *
                           (place[3 * l->up[q] + (int)c] - b.x[3 * i + c]);
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

/* Plain, with contacts, without what is not definite, with springs on nodes, of which the stiff ones are a
 * patch. */
START_TEST(cycle_is_that_of_dense_matrices) {
    dense_level l[LEVELS_MAX];
    make_body(&b, 0.4, _i == 2 ? 3.0 : 0.1);
    const bool coupled = _i == 1 || _i == 2;
    if (coupled || _i == 3)
        add_contacts(&b, 2.0);
    multigrid *mg = make(&b, 40);
    ck_assert_int_eq(number(mg, &b, coupled, _i == 2), PALP_OK);
    multigrid_swap(mg);
    ck_assert(_i == 0 ? mg->n_patch == 0 : mg->n_patch > COUPLED && mg->n_patch < NODES / 2);
    make_levels(mg, &b, coupled, _i == 2, l);
    check_cycle(mg, l, &b.seed);
    free_levels(multigrid_levels(mg), l);
    multigrid_free(mg);
}
END_TEST

/* What touches changes on the finest level only, where something touched before and where nothing did. */
START_TEST(touched_nodes_change_the_finest_level) {
    dense_level l[LEVELS_MAX], now[LEVELS_MAX];
    bool before = _i == 0;
    make_body(&b, 0.4, 0.1);
    if (before)
        add_contacts(&b, 2.0);
    multigrid *mg = make(&b, 40);
    ck_assert_int_eq(number(mg, &b, before, false), PALP_OK);
    multigrid_swap(mg);
    make_levels(mg, &b, before, false, l);
    add_contacts(&b, 4.0);
    multigrid_touch(mg, b.node, COUPLED, b.coupling);
    finest_matrix(&b, true, false, now);
    now[0].weights = l[0].weights;
    now[0].swept = mg->patched;
    memcpy(now + 1, l + 1, 2 * sizeof *now);
    check_cycle(mg, now, &b.seed);
    free_levels(1, now);
    free_levels(multigrid_levels(mg), l);
    multigrid_free(mg);
}
END_TEST

/* With further blocks, of what acts on all nodes: plain, with contacts, without what is not definite, of
 * which they are a part; of elements that stand by batches and, as the nodes are shuffled, of those that do
 * not. */
START_TEST(further_blocks) {
    dense_level l[LEVELS_MAX];
    const bool coupled = _i % 3 > 0, definite = _i % 3 == 2;
    make_body(&b, 0.4, definite ? 3.0 : 0.1);
    if (_i >= 3)
        shuffle(&b);
    add_further(&b, 2.0);
    if (coupled)
        add_contacts(&b, 8.0);
    multigrid *mg = make(&b, 40);
    ck_assert((mg->n_batches > 0) == (_i < 3));
    ck_assert_int_eq(number(mg, &b, coupled, definite), PALP_OK);
    multigrid_swap(mg);
    ck_assert(coupled ? mg->n_patch > COUPLED && mg->n_patch < NODES : mg->n_patch == 0);
    make_levels(mg, &b, coupled, definite, l);
    check_cycle(mg, l, &b.seed);
    free_levels(multigrid_levels(mg), l);
    multigrid_free(mg);
}
END_TEST

START_TEST(one_level_is_the_inverse) {
    dense_level l[1];
    make_body(&b, 0.4, 0.1);
    add_contacts(&b, 2.0);
    if (_i > 0)
        add_further(&b, 2.0);
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

/* The share of an error that a cycle leaves in the long run, in the energy norm of the tangent, on an even
 * lattice. */
START_TEST(contraction) {
    static const double wanted[2] = {0.6691, 0.7329};
    static double r[3 * NODES], z[3 * NODES], x[3 * NODES];
    dense_level l;
    double energy[12];
    make_body(&b, 0, 0);
    if (_i > 0)
        renumber(&b);
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
    ck_assert_msg(rate > wanted[_i] - 2e-3 && rate < wanted[_i] + 2e-3, "%g", rate);
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

/* A cycle's work: an element once and a half, an entry of a coarse row, 0.13 for a value of the factor. */
START_TEST(work_of_a_cycle) {
    make_body(&b, 0.4, 0.1);
    for (size_t direct = 40; direct <= 3 * NODES; direct += 3 * NODES - 40) {
        multigrid *mg = make(&b, direct);
        double work = 0.13 * (double)linsys_value_count(mg->factor[0]);
        if (direct == 40)
            work += 1.5 * (double)b.n_pairs + (double)mg->level[1].first[mg->level[1].n];
        ck_assert_double_eq_tol(multigrid_cycle_work(mg), work, 1e-9 * work);
        multigrid_free(mg);
    }
}
END_TEST

/* out = minus the elements' part of the tangent times x, batch by batch. */
static void plain_batches(const multigrid *mg, const float *element, const double *x, float *out) {
    const float *place = element + mg->nodes;
    for (size_t i = 0; i < mg->n_batches; i++) {
        float f[MULTIGRID_BATCH][3];
        for (size_t k = 0; k < MULTIGRID_BATCH; k++) {
            const float *e = element + MULTIGRID_BATCH * i + k;
            const size_t low = (size_t)mg->batch[2 * i] + k, high = (size_t)mg->batch[2 * i + 1] + k;
            float n[3], d[3];
            for (size_t c = 0; c < 3; c++) { /* behind the last node there is nothing */
                n[c] = place[c * multigrid_stride(mg) + high] - place[c * multigrid_stride(mg) + low];
                d[c] = (high < NODES ? (float)x[3 * high + c] : 0.0F) -
                       (low < NODES ? (float)x[3 * low + c] : 0.0F);
            }
            float along = e[0] * (n[0] * d[0] + n[1] * d[1] + n[2] * d[2]);
            for (size_t c = 0; c < 3; c++)
                f[k][c] = along * n[c] + e[mg->spacing] * d[c];
        }
        for (size_t end = 0; end < 2; end++)
            for (size_t k = 0; k < MULTIGRID_BATCH; k++)
                for (size_t c = 0; c < 3 && (size_t)mg->batch[2 * i + end] + k < NODES; c++)
                    out[3 * ((size_t)mg->batch[2 * i + end] + k) + c] += end == 0 ? f[k][c] : -f[k][c];
    }
}

/* A lattice's elements stand by batches, whose product has the bits of a plain one, whichever version of it
 * this processor takes; those of nodes in no order do not. */
START_TEST(batches_of_parallel_elements) {
    static double x[3 * NODES], out[3 * NODES], place[3 * NODES];
    static float plain[3 * NODES];
    make_body(&b, 0.4, 0.1);
    multigrid *mg = make(&b, 40);
    ck_assert_uint_gt(mg->n_batches, b.n_pairs / MULTIGRID_BATCH);
    ck_assert_int_eq(number(mg, &b, false, false), PALP_OK);
    for (size_t i = 0; i < 3 * NODES; i++) {
        x[i] = palp_random_uniform(&b.seed);
        plain[i] = 0.0F;
    }
    const float *element = multigrid_input(mg).element;
    multigrid_elements_times(mg, element, x, out);
    plain_batches(mg, element, x, plain);
    for (size_t i = 0; i < 3 * NODES; i++)
        ck_assert_msg(out[i] == (double)plain[i], "%zu: %.9g not %.9g", i, out[i], (double)plain[i]);
    multigrid_free(mg);
    for (size_t e = 0; e < 2 * b.n_pairs;
         e++) /* each number once, as 7 divides NODES; none is parallel any more */
        b.pair[e] = (100 * b.pair[e] + 7 * b.pair[e] * b.pair[e]) % NODES;
    memcpy(place, b.x, sizeof place);
    for (size_t i = 0; i < NODES; i++)
        memcpy(b.x + 3 * ((100 * i + 7 * i * i) % NODES), place + 3 * i, 3 * sizeof *place);
    mg = make(&b, 40);
    ck_assert_uint_eq(mg->n_batches, 0);
    ck_assert_int_eq(number(mg, &b, false, false), PALP_OK);
    multigrid_elements_times(mg, multigrid_input(mg).element, x, out);
    for (size_t e = 0; e < b.n_pairs; e++) { /* less what each element has brought: nothing is left */
        const float *n = b.element + 5 * e;
        double *p[2] = {out + 3 * b.pair[2 * e], out + 3 * b.pair[2 * e + 1]}, along = 0.0, d[3];
        for (size_t c = 0; c < 3; c++) {
            d[c] = x[3 * (size_t)b.pair[2 * e + 1] + c] - x[3 * (size_t)b.pair[2 * e] + c];
            along += (double)(n[3] * n[c]) * d[c];
        }
        for (size_t c = 0; c < 3; c++) {
            p[0][c] -= along * (double)n[c] + (double)n[4] * d[c];
            p[1][c] += along * (double)n[c] + (double)n[4] * d[c];
        }
    }
    for (size_t i = 0; i < 3 * NODES; i++)
        ck_assert_double_eq_tol(out[i], 0.0, 1e-5);
    multigrid_free(mg);
}
END_TEST

/* A cycle in two halves, with another one between them: to the bit. */
START_TEST(halves_make_a_cycle) {
    static double r[3 * NODES], other[3 * NODES], z[3 * NODES], halved[3 * NODES];
    make_body(&b, 0.4, 0.1);
    add_contacts(&b, 2.0);
    multigrid *mg = make(&b, _i == 0 ? 40 : 3 * NODES);
    float *half = calloc(multigrid_half_size(mg), sizeof *half);
    ck_assert_int_eq(number(mg, &b, true, false), PALP_OK);
    ck_assert(half != NULL);
    multigrid_swap(mg);
    for (size_t i = 0; i < 3 * NODES; i++) {
        r[i] = b.dof[i] < 0 ? 0.0 : palp_random_uniform(&b.seed);
        other[i] = b.dof[i] < 0 ? 0.0 : palp_random_uniform(&b.seed);
    }
    multigrid_apply(mg, r, z);
    multigrid_apply_half(mg, r, half);
    multigrid_apply(mg, other, halved);
    multigrid_apply_rest(mg, r, half, halved);
    ck_assert_mem_eq(z, halved, sizeof z);
    free(half);
    multigrid_free(mg);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, halves_make_a_cycle, 0, 2);
    tcase_add_test(tc, batches_of_parallel_elements);
    tcase_add_test(tc, work_of_a_cycle);
    tcase_add_test(tc, coarse_nodes_are_apart_and_near);
    tcase_add_test(tc, weights_are_the_nearest_mean);
    tcase_add_loop_test(tc, cycle_is_that_of_dense_matrices, 0, 4);
    tcase_add_loop_test(tc, touched_nodes_change_the_finest_level, 0, 2);
    tcase_add_loop_test(tc, one_level_is_the_inverse, 0, 2);
    tcase_add_loop_test(tc, further_blocks, 0, 6);
    tcase_add_test(tc, one_set_serves_while_the_other_is_made);
    tcase_add_loop_test(tc, contraction, 0, 2);
    tcase_add_test(tc, what_is_not_definite_is_told);
}
