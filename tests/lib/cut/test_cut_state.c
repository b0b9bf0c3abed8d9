/* test_cut_state.c: cuts through commits, resets and copies, loose parts, budgets; the surface that is left.
 */
#include "cut_make.h"

/* ---- state --------------------------------------------------------------------------------------- */

START_TEST(a_cut_drops_the_trial_and_keeps_the_state) {
    palp_material m = quartic(2);
    palp_network *net = cuttable(4, &m);
    step_to(net, 0.05 * HEIGHT, 0.1);
    snapshot before = snapshot_take(net);
    ck_assert_int_eq(palp_network_try(net, 0.06 * HEIGHT, 0.1, NULL), PALP_OK);
    cut_level(net, 0.5 * HEIGHT, 0.5 * HEIGHT);
    palp_network_commit(net); /* there is nothing to commit any more */
    ck_assert(still_at(net, &before));
    ck_assert_int_eq(palp_network_try(net, 0.06 * HEIGHT, 0.1, NULL), PALP_OK);
    ck_assert(still_at(net, &before));
    snapshot_free(&before);
    palp_network_free(net);
}
END_TEST

START_TEST(reset_makes_whole) {
    palp_material m = quartic(2);
    palp_network *net = cuttable(4, &m), *other = cube_network(4, &m, NULL);
    cut_level(net, 0.5 * HEIGHT, 1.0);
    palp_network_reset(net);
    ck_assert_uint_eq(count_alive(net), element_count(net));
    step_to(net, 0.05 * HEIGHT, 0.1);
    step_to(other, 0.05 * HEIGHT, 0.1);
    snapshot s = snapshot_take(other);
    ck_assert(still_at(net, &s)); /* an uncut network is not touched by being ready to be cut */
    snapshot_free(&s);
    palp_network_free(other);
    palp_network_free(net);
}
END_TEST

/* Nothing but what the supports and the loose parts' springs take: the sum of all forces on the nodes. */
static void check_balance(const palp_network *net) {
    double sum[3] = {0.0}, size = 0.0;
    for (size_t i = 0; i < net->n_nodes; i++)
        for (size_t k = 0; k < 3; k++) {
            double f = net->now.inner[3 * i + k];
            double spring = cut_spring(cut_of(net), i) * (net->now.x[3 * i + k] - net->past[0][3 * i + k]);
            sum[k] += net->dof[3 * i + k] < 0 ? f : spring;
            size += fabs(f);
            ck_assert(isfinite(f) && isfinite(net->now.x[3 * i + k]));
        }
    for (size_t k = 0; k < 3; k++)
        ck_assert_double_le(fabs(sum[k]), 1e-9 * size + 1e-12);
}

typedef struct walk_result {
    size_t cut, torn, failed;
    snapshot state;
    unsigned char alive[1200];
} walk_result;

/* Presses, slices and tears at random; every step that fails leaves the state as it was. */
static void walk(uint64_t seed, palp_network *net, walk_result *r) {
    memset(r, 0, sizeof *r);
    ck_assert_int_eq(palp_network_set_tearing(net, 0.14, 0.0), PALP_OK);
    for (int k = 0; k < 40; k++) {
        double corners[9], depth = HEIGHT * (0.12 * sin(0.3 * k) + 0.03 * (palp_random_uniform(&seed) - 0.5));
        size_t n;
        random_blade(&seed, 1.0, corners);
        ck_assert_int_eq(palp_network_cut(net, corners, &n), PALP_OK);
        r->cut += n;
        palp_status status = palp_network_step(net, depth, 0.01, NULL);
        ck_assert(status == PALP_OK || status == PALP_ERR_NOT_CONVERGED || status == PALP_ERR_BUCKLED);
        r->failed += status != PALP_OK;
        if (!status)
            check_balance(net);
        ck_assert_int_eq(palp_network_tear(net, &n), PALP_OK);
        r->torn += n;
    }
    r->state = snapshot_take(net);
    memcpy(r->alive, palp_network_alive(net), element_count(net));
}

START_TEST(random_cuts_and_tears_twice_the_same) {
    palp_material m = quartic(1);
    palp_network *net = cuttable(5, &m);
    static walk_result first, second;
    walk(101 + (uint64_t)_i, net, &first);
    palp_network_free(net);
    net = cuttable(5, &m);
    walk(101 + (uint64_t)_i, net, &second);
    ck_assert_uint_gt(first.cut, 300);
    ck_assert_uint_le(first.failed, 4);
    ck_assert(snapshot_same(&first.state, &second.state));
    ck_assert_mem_eq(first.alive, second.alive, element_count(net));
    snapshot_free(&first.state);
    snapshot_free(&second.state);
    palp_network_free(net);
}
END_TEST

/* After a walk: another network that never had the elements, near the same places, finds the same force. */
START_TEST(a_walk_ends_where_a_fresh_network_is) {
    palp_material m = quartic(1);
    palp_network *net = cuttable(5, &m), *fresh = cuttable(5, &m);
    walk_result r;
    uint64_t seed = 5;
    walk(301 + (uint64_t)_i, net, &r);
    snapshot_free(&r.state);
    for (int k = 0; k < 4; k++)
        step_to(net, 0.02 * HEIGHT, INFINITY);
    for (size_t e = 0; e < element_count(net); e++)
        if (!r.alive[e])
            ck_assert_int_eq(palp_network_cut_elements(fresh, 1, &(int32_t){(int32_t)e}), PALP_OK);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        fresh->now.x[i] =
            net->now.x[i] + (net->dof[i] < 0 ? 0.0 : 1e-6 * HEIGHT * (palp_random_uniform(&seed) - 0.5));
    fresh->now.depth = net->now.depth;
    for (int k = 0; k < 4; k++)
        step_to(fresh, 0.02 * HEIGHT, INFINITY);
    double force = palp_network_force(fresh);
    ck_assert_double_gt(fabs(force), 0.01);
    ck_assert_double_eq_tol(palp_network_force(net), force, 1e-8 * fabs(force));
    palp_network_free(fresh);
    palp_network_free(net);
}
END_TEST

/* Saved, cut further, restored: the same bits from there on as without the detour. */
START_TEST(restore_brings_the_cuts_back) {
    palp_material m = quartic(2);
    palp_network *net = cuttable(4, &m);
    cut_level(net, 0.5 * HEIGHT, 0.4 * HEIGHT);
    for (int k = 1; k <= 4; k++)
        step_to(net, 0.02 * k * HEIGHT, 0.02);
    size_t size = palp_network_state_size(net), alive = count_alive(net), n;
    const int32_t *triangles;
    void *saved = malloc(size);
    ck_assert_int_eq(palp_network_save(net, saved, size), PALP_OK);
    ck_assert_int_eq(palp_network_surface(net, &n, &triangles), PALP_OK);
    size_t before = n;
    step_to(net, 0.1 * HEIGHT, 0.02);
    snapshot expected = snapshot_take(net);
    cut_level(net, 0.8 * HEIGHT, 0.4 * HEIGHT);
    palp_network_step(net, 0.09 * HEIGHT, 0.02, NULL); /* whether it finds a state or not */
    ck_assert_uint_lt(count_alive(net), alive);
    ck_assert_int_eq(palp_network_restore(net, saved, size), PALP_OK);
    ck_assert_uint_eq(count_alive(net), alive);
    ck_assert_int_eq(palp_network_surface(net, &n, &triangles), PALP_OK);
    ck_assert_uint_eq(n, before);
    step_to(net, 0.1 * HEIGHT, 0.02);
    snapshot again = snapshot_take(net);
    for (size_t i = 0; i < again.n; i++) /* another factor may have been at hand: the last digits */
        ck_assert_double_eq_tol(again.value[i], expected.value[i], 1e-9 * (fabs(expected.value[i]) + 0.02));
    snapshot_free(&expected);
    snapshot_free(&again);
    free(saved);
    palp_network_free(net);
}
END_TEST

/* A chain cut in two: the far part is not loose where any one axis of its end is held. */
START_TEST(held_along_one_axis_is_not_loose) {
    const double x[12] = {0, 0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0};
    const int32_t pair[6] = {0, 1, 1, 2, 2, 3}, middle = 1;
    palp_material m = quartic(0);
    palp_network_settings settings = palp_network_settings_default();
    palp_support supports[2] = {{"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}},
                                {"top", {PALP_FREE, PALP_FREE, PALP_FREE}, {0, 0, 0}}};
    palp_mesh *mesh = NULL;
    palp_network *net = NULL;
    if (_i < 3)
        supports[1].axis[_i] = PALP_FIXED;
    ck_assert_int_eq(palp_mesh_create(4, x, 3, pair, &mesh, NULL), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_plane_set(mesh, "bottom", 1, 0.0, 0.1), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_plane_set(mesh, "top", 1, 3.0, 0.1), PALP_OK);
    ck_assert_int_eq(palp_network_create(mesh, &m, 2, supports, &settings, &net, NULL), PALP_OK);
    palp_mesh_free(mesh);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    ck_assert_int_eq(palp_network_cut_elements(net, 1, &middle), PALP_OK);
    ck_assert_uint_eq(palp_network_loose(net, NULL), _i < 3 ? 0 : 2);
    palp_network_free(net);
}
END_TEST

/* The part that is cut off goes with the hand without a force, and is loose when let go. */
START_TEST(a_held_part_is_not_loose) {
    palp_material m = quartic(1);
    palp_mesh *mesh = cube(4, PALP_NEIGHBOURS_26);
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0}};
    palp_network_settings settings = palp_network_settings_default();
    palp_contact_settings contact = palp_contact_settings_default();
    palp_network *net;
    const int32_t node = 63;
    double target[3] = {HEIGHT, HEIGHT, HEIGHT}, force[3];
    ck_assert_int_eq(palp_network_create(mesh, &m, 1, &bottom, &settings, &net, NULL), PALP_OK);
    palp_mesh_free(mesh);
    ck_assert_int_eq(palp_network_enable_tools(net, 0, 1, &contact), PALP_OK);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    ck_assert_uint_eq(cut_level(net, 0.5 * HEIGHT, 1.0), 100);
    ck_assert_uint_eq(palp_network_loose(net, NULL), 32);
    ck_assert_int_eq(palp_network_grasp(net, 1, &node, target), PALP_OK);
    ck_assert_uint_eq(palp_network_loose(net, NULL), 0);
    for (int k = 1; k <= 10; k++) {
        target[1] = HEIGHT * (1.0 + 0.02 * k);
        ck_assert_int_eq(palp_network_grasp(net, 1, &node, target), PALP_OK);
        step_to(net, 0.0, 0.1);
    }
    ck_assert_int_eq(palp_network_grasp_force(net, 1, &node, force), PALP_OK);
    for (size_t k = 0; k < 3; k++)
        ck_assert_double_eq_tol(force[k], 0.0, 1e-9);
    ck_assert_double_eq_tol(palp_network_positions(net)[3 * node + 1], 1.2 * HEIGHT, 1e-9);
    ck_assert_int_eq(palp_network_release(net, 1, &node), PALP_OK);
    ck_assert_uint_eq(palp_network_loose(net, NULL), 32);
    step_to(net, 0.0, 0.1);
    ck_assert_double_eq_tol(palp_network_positions(net)[3 * node + 1], 1.2 * HEIGHT, 1e-6 * HEIGHT);
    palp_network_free(net);
}
END_TEST

/* Force of a rough sphere on a block with a slit beside it, of which a part is opened at the surface: cut
 * before the sphere came or while it pressed. */
static double force_beside_slit(bool before) {
    palp_material m = quartic(2);
    palp_network *net = cuttable(5, &m);
    const palp_contact_settings contact = palp_contact_settings_default();
    palp_tool_force felt;
    palp_tool tool = {.shape = PALP_TOOL_SPHERE, .radius_m = 0.005, .friction = 0.3};
    ck_assert_int_eq(palp_network_enable_tools(net, 1, 0, &contact), PALP_OK);
    for (int k = 0; k <= 20; k++) {
        if (k == (before ? 0 : 15))
            cut_rectangle(net, (double[]){0.39 * HEIGHT, 0.6 * HEIGHT, -1.0}, (double[]){0, 1.0, 0},
                          (double[]){0, 0, 2.0});
        memcpy(tool.position_m, (double[]){0.6 * HEIGHT, HEIGHT + 0.005 - 1e-4 * fmin(k, 15), 0.55 * HEIGHT},
               sizeof tool.position_m);
        ck_assert_int_eq(palp_network_set_tools(net, 1, &tool), PALP_OK);
        step_to(net, 0.0, k < 16 ? 0.1 : INFINITY);
    }
    ck_assert_int_eq(palp_network_tool_force(net, &felt), PALP_OK);
    palp_network_free(net);
    return felt.force_N[1];
}

START_TEST(a_tool_feels_the_same_cut) {
    const double before = force_beside_slit(true), after = force_beside_slit(false);
    ck_assert_double_gt(before, 0.05);
    ck_assert_double_eq_tol(after, before, 0.01 * before); /* friction remembers the way */
}
END_TEST

/* A sphere pushes a loose part aside; it stays where it was left. */
START_TEST(a_tool_moves_a_loose_part) {
    palp_material m = quartic(0);
    palp_mesh *mesh = cube(4, PALP_NEIGHBOURS_26);
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0}};
    palp_network_settings settings = palp_network_settings_default();
    palp_contact_settings contact = palp_contact_settings_default();
    palp_network *net;
    palp_tool tool = {
        .shape = PALP_TOOL_SPHERE, .position_m = {-0.01, 0.75 * HEIGHT, 0.5 * HEIGHT}, .radius_m = 0.008};
    ck_assert_int_eq(palp_network_create(mesh, &m, 1, &bottom, &settings, &net, NULL), PALP_OK);
    palp_mesh_free(mesh);
    ck_assert_int_eq(palp_network_enable_tools(net, 1, 0, &contact), PALP_OK);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    cut_level(net, 0.5 * HEIGHT, 1.0);
    double low = 1.0, after = 1.0;
    for (int k = 1; k <= 40; k++) {
        tool.position_m[0] = -0.01 + 0.0002 * k;
        ck_assert_int_eq(palp_network_set_tools(net, 1, &tool), PALP_OK);
        step_to(net, 0.0, 0.01);
    }
    ck_assert_int_eq(palp_network_set_tools(net, 0, NULL), PALP_OK);
    for (int k = 0; k < 20; k++)
        step_to(net, 0.0, 0.01);
    for (size_t i = 0; i < 64; i++) {
        double moved = palp_network_positions(net)[3 * i] - net->rest[3 * i];
        if (net->rest[3 * i + 1] > 0.5 * HEIGHT)
            low = fmin(low, moved);
    }
    for (int k = 0; k < 20; k++)
        step_to(net, 0.0, 0.01);
    for (size_t i = 0; i < 64; i++)
        if (net->rest[3 * i + 1] > 0.5 * HEIGHT)
            after = fmin(after, palp_network_positions(net)[3 * i] - net->rest[3 * i]);
    ck_assert_double_gt(low, 0.003); /* the sphere went 6 mm into where it was, the whole part moved */
    ck_assert_double_eq_tol(after, low, 1e-4 * HEIGHT);
    palp_network_free(net);
}
END_TEST

/* Within a budget of counted work: every number finite, the end as Newton has it. */
START_TEST(cuts_within_a_budget) {
    palp_material m = quartic(2);
    palp_network *net = cuttable(5, &m), *exact = cuttable(5, &m);
    palp_realtime_settings settings = palp_realtime_settings_default();
    palp_realtime *realtime = NULL;
    const palp_budget budget = {.corrections = 4};
    palp_tick_info info;
    uint64_t seed = 32;
    ck_assert_int_eq(palp_realtime_create(net, &settings, &realtime), PALP_OK);
    for (int k = 1; k <= 60; k++) {
        if (k % 6 == 0 && k <= 48) {
            double corners[9];
            random_blade(&seed, 1.0, corners);
            ck_assert_int_eq(palp_network_cut(net, corners, NULL), PALP_OK);
        }
        ck_assert_int_eq(
            palp_realtime_step(realtime, 0.05 * HEIGHT * fmin(1.0, k / 30.0), 0.002, &budget, &info),
            PALP_OK);
        for (size_t i = 0; i < 3 * net->n_nodes; i++)
            ck_assert(isfinite(net->now.x[i]) && isfinite(net->now.inner[i]));
    }
    for (size_t e = 0; e < element_count(net); e++)
        if (!palp_network_alive(net)[e])
            ck_assert_int_eq(palp_network_cut_elements(exact, 1, &(int32_t){(int32_t)e}), PALP_OK);
    ck_assert_uint_lt(count_alive(net), element_count(net) - 50);
    for (int k = 1; k <= 5; k++)
        step_to(exact, 0.01 * k * HEIGHT, INFINITY);
    for (int k = 0; k < 20; k++)
        ck_assert_int_eq(palp_realtime_step(realtime, 0.05 * HEIGHT, INFINITY, &budget, &info), PALP_OK);
    ck_assert_double_eq_tol(info.force_N, palp_network_force(exact), 1e-6 * palp_network_force(exact));
    palp_realtime_free(realtime);
    palp_network_free(exact);
    palp_network_free(net);
}
END_TEST

/* ---- surface ------------------------------------------------------------------------------------- */

static double triple(const double *a, const double *b, const double *c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

static bool has_cut_edge(const palp_network *net, const int32_t *t) {
    const int32_t *pairs = palp_mesh_pairs(palp_network_mesh(net));
    for (size_t e = 0; e < element_count(net); e++) {
        int ends = 0;
        for (size_t k = 0; k < 4; k++)
            ends += pairs[2 * e] == t[k] || pairs[2 * e + 1] == t[k];
        if (ends == 2 && !palp_network_alive(net)[e])
            return true;
    }
    return false;
}

/* It encloses the volume of the tetrahedra without a cut edge, at rest, and every edge is walked both ways.
 */
static void check_surface(const palp_network *net) {
    const palp_mesh *mesh = palp_network_mesh(net);
    const double *x = palp_mesh_positions(mesh);
    const int32_t *t = palp_mesh_tetrahedra(mesh), *s;
    double volume = 0.0, enclosed = 0.0;
    size_t n;
    static int walked[125][125];
    memset(walked, 0, sizeof walked);
    for (size_t i = 0; i < palp_mesh_tetrahedron_count(mesh); i++, t += 4)
        if (!has_cut_edge(net, t)) {
            double u[3][3];
            for (size_t k = 0; k < 9; k++)
                u[k / 3][k % 3] = x[3 * (size_t)t[k / 3 + 1] + k % 3] - x[3 * (size_t)t[0] + k % 3];
            volume += triple(u[0], u[1], u[2]) / 6.0;
        }
    ck_assert_int_eq(palp_network_surface(net, &n, &s), PALP_OK);
    for (size_t i = 0; i < n; i++, s += 3) {
        enclosed += triple(x + 3 * s[0], x + 3 * s[1], x + 3 * s[2]) / 6.0;
        for (size_t k = 0; k < 3; k++)
            walked[s[k]][s[(k + 1) % 3]]++;
    }
    ck_assert_double_eq_tol(enclosed, volume, 1e-12 * HEIGHT * HEIGHT * HEIGHT);
    for (size_t a = 0; a < 125; a++)
        for (size_t b = 0; b < a; b++)
            ck_assert_int_eq(walked[a][b], walked[b][a]);
}

START_TEST(the_surface_follows_the_cuts) {
    palp_material m = quartic(0);
    palp_network *net = cuttable(5, &m);
    uint64_t seed = 7 + (uint64_t)_i;
    const int32_t *s;
    size_t n;
    ck_assert_int_eq(palp_network_surface(net, &n, &s), PALP_OK);
    ck_assert_uint_eq(n, palp_mesh_triangle_count(palp_network_mesh(net)));
    ck_assert_mem_eq(s, palp_mesh_triangles(palp_network_mesh(net)), 3 * n * sizeof *s);
    for (int k = 0; k < 6; k++) {
        double corners[9];
        random_blade(&seed, 1.0, corners);
        ck_assert_int_eq(palp_network_cut(net, corners, NULL), PALP_OK);
        check_surface(net);
    }
    palp_network_free(net);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, a_cut_drops_the_trial_and_keeps_the_state);
    tcase_add_test(tc, reset_makes_whole);
    tcase_add_loop_test(tc, random_cuts_and_tears_twice_the_same, 0, 6);
    tcase_add_loop_test(tc, a_walk_ends_where_a_fresh_network_is, 0, 3);
    tcase_add_test(tc, restore_brings_the_cuts_back);
    tcase_add_loop_test(tc, held_along_one_axis_is_not_loose, 0, 4);
    tcase_add_test(tc, a_held_part_is_not_loose);
    tcase_add_test(tc, a_tool_feels_the_same_cut);
    tcase_add_test(tc, a_tool_moves_a_loose_part);
    tcase_add_test(tc, cuts_within_a_budget);
    tcase_add_loop_test(tc, the_surface_follows_the_cuts, 0, 5);
}
