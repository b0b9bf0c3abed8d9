/* test_realtime_touched.c: the factor and the corrections where a tool touches. */
#include "realtime_make.h"
#include "realtime/realtime_internal.h"

static double size_of(const double *v, size_t n) {
    return sqrt(network_dot(v, v, n));
}

/* A cube that a sphere slid on and is about to slide on further, its factor that of the tangent there; r
 * random on the free axes. */
static palp_realtime *slid(size_t n, double friction) {
    palp_realtime *rt = cube_on_a_table(n, 0);
    palp_network *net = net_of(rt);
    ck_assert_int_eq(network_set_foundation(net, "top", 2.0), PALP_OK);
    for (int i = 0; i <= 6; i++) {
        palp_tool tool = {.shape = PALP_TOOL_SPHERE, .radius_m = 0.005, .friction = friction};
        double at[3] = {0.011 + 1e-4 * i, HEIGHT + 0.0049 - 2e-4 * i, 0.0135};
        memcpy(tool.position_m, at, sizeof at);
        ck_assert_int_eq(palp_network_set_tools(net, 1, &tool), PALP_OK);
        if (i < 6)
            ck_assert_int_eq(palp_realtime_step(rt, 0.0, DT, &ALL, NULL), PALP_OK);
    }
    ck_assert_int_eq(network_begin(net, 0.0, DT), PALP_OK);
    memcpy(net->next.x, net->now.x, 3 * net->n_nodes * sizeof *net->next.x);
    ck_assert(network_evaluate(net));
    ck_assert_int_eq(realtime_refresh_now(rt), PALP_OK);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        rt->r[i] = net->dof[i] < 0 ? 0.0 : sin(1.0 + 3.7 * (double)i);
    rt->n_directions = 0;
    return rt;
}

/* A rough sphere's blocks and a foundation's springs are in the factor of a network so small that there are
 * no levels: with them it solves, but for what is not symmetric. */
START_TEST(blocks_of_terms_are_in_the_factor) {
    palp_realtime *rt = slid(4, 0.5);
    const size_t n = 3 * net_of(rt)->n_nodes;
    realtime_touch(rt);
    multigrid_apply(rt->mg, rt->r, rt->z);
    realtime_tangent_times(rt, rt->z, rt->q);
    for (size_t i = 0; i < n; i++)
        rt->q[i] -= rt->r[i];
    ck_assert_double_le(size_of(rt->q, n), 1e-4 * size_of(rt->r, n));
    drop(rt);
}
END_TEST

/* Without friction the tangent is symmetric: corrections in the directions so far are conjugate gradients, in
 * one round or one by one. */
START_TEST(directions_of_a_smooth_tool_are_conjugate) {
    enum { CORRECTIONS = 4 };
    palp_realtime *rt = slid(6, 0.0);
    const size_t n = 3 * net_of(rt)->n_nodes;
    double *r = malloc(n * sizeof *r), *move = malloc(n * sizeof *move), *sum = calloc(n, sizeof *sum);
    memcpy(r, rt->r, n * sizeof *r);
    ck_assert_uint_eq(realtime_solve(rt, CORRECTIONS, 0.0, 0.0), CORRECTIONS);
    memcpy(move, rt->move, n * sizeof *move);
    for (int one_by_one = 0; one_by_one < 2; one_by_one++) {
        const size_t limit = one_by_one ? 1 : CORRECTIONS;
        memcpy(rt->r, r, n * sizeof *r);
        memset(sum, 0, n * sizeof *sum);
        rt->n_directions = 0;
        for (size_t done = 0; done < CORRECTIONS; done += limit) {
            ck_assert_uint_eq(realtime_solve_touched(rt, limit, 0.0), limit);
            for (size_t i = 0; i < n; i++)
                sum[i] += rt->move[i];
        }
        for (size_t i = 0; i < n; i++)
            sum[i] -= move[i];
        ck_assert_double_le(size_of(sum, n), 1e-4 * size_of(move, n));
    }
    free(r);
    free(move);
    free(sum);
    drop(rt);
}
END_TEST

/* A tool that slips: corrections one by one, more of them than there is room for, solve with the unsymmetric
 * part in the tangent. */
START_TEST(corrections_follow_what_slips) {
    palp_realtime *rt = slid(6, 0.9);
    const size_t n = 3 * net_of(rt)->n_nodes;
    const double first = size_of(rt->r, n);
    double *sum = calloc(n, sizeof *sum), *left = malloc(n * sizeof *left),
           *symmetric = malloc(n * sizeof *symmetric);
    memcpy(left, rt->r, n * sizeof *left);
    for (size_t i = 0; i < REALTIME_DIRECTIONS + 4; i++) {
        ck_assert_uint_eq(realtime_solve_touched(rt, 1, 0.0), 1);
        for (size_t k = 0; k < n; k++)
            sum[k] += rt->move[k];
    }
    realtime_tangent_times(rt, sum, symmetric);
    realtime_tissue_times(rt, sum, rt->q);
    realtime_add_touching(rt, true, sum, rt->q);
    for (size_t k = 0; k < n; k++) {
        left[k] -= rt->q[k];
        symmetric[k] -= rt->q[k];
    }
    ck_assert_double_le(size_of(left, n), 1e-5 * first);
    ck_assert_double_gt(size_of(symmetric, n), 5e-4 * first);
    free(sum);
    free(left);
    free(symmetric);
    drop(rt);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, blocks_of_terms_are_in_the_factor);
    tcase_add_test(tc, directions_of_a_smooth_tool_are_conjugate);
    tcase_add_test(tc, corrections_follow_what_slips);
}
