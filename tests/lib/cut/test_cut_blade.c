/* test_cut_blade.c: which elements a blade crosses. */
#include "cut_make.h"

/* Between two layers of an n x n lattice each node has up to nine elements: (3 n - 2)^2 in all. */
START_TEST(a_level_cut_takes_the_layer_between) {
    palp_material m = quartic(0);
    palp_network *net = cuttable(5, &m);
    ck_assert_uint_eq(cut_level(net, 0.4 * HEIGHT, 1.0), 13 * 13);
    ck_assert_uint_eq(count_alive(net), element_count(net) - 13 * 13);
    ck_assert_uint_eq(cut_level(net, 0.4 * HEIGHT, 1.0), 0);
    palp_network_free(net);
}
END_TEST

/* Exactly through the nodes of a layer: they all stay with one side, one layer of elements is cut. */
START_TEST(a_blade_through_nodes_cuts_one_side) {
    static const double levels[] = {0.0, 0.25, 0.5, 0.75, 1.0};
    palp_material m = quartic(0);
    palp_network *net = cuttable(5, &m);
    size_t n = cut_level(net, levels[_i] * HEIGHT, 1.0);
    ck_assert(n == 13 * 13 || (n == 0 && (_i == 0 || _i == 4)));
    for (size_t e = 0; e < element_count(net); e++) { /* nothing in the layer itself */
        const int32_t *pair = palp_mesh_pairs(palp_network_mesh(net)) + 2 * e;
        const double *x = palp_mesh_positions(palp_network_mesh(net));
        ck_assert(palp_network_alive(net)[e] || x[3 * pair[0] + 1] != x[3 * pair[1] + 1]);
    }
    palp_network_free(net);
}
END_TEST

static const int ORDERS[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}, {1, 0, 2}, {0, 2, 1}};

/* On a lattice that is exact in binary, with corners on its nodes: every kind of tie. */
START_TEST(the_order_of_corners_plays_no_part) {
    palp_mesh *mesh = NULL;
    palp_material m = quartic(0);
    palp_network_settings settings = palp_network_settings_default();
    ck_assert_int_eq(palp_mesh_lattice((size_t[]){5, 5, 5}, (double[]){1, 1, 1}, PALP_NEIGHBOURS_26, &mesh),
                     PALP_OK);
    palp_network *net = network_on(mesh, &m, &settings);
    palp_mesh_free(mesh);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    unsigned char *expected = malloc(element_count(net));
    uint64_t seed = 17 + (uint64_t)_i;
    double corners[9], turned[9];
    for (size_t i = 0; i < 9; i++)
        corners[i] = floor(5.0 * palp_random_uniform(&seed)) / 4.0;
    for (int k = 0; k < 6; k++) {
        palp_network_reset(net);
        for (size_t i = 0; i < 9; i++)
            turned[i] = corners[3 * ORDERS[k][i / 3] + (int)(i % 3)];
        ck_assert_int_eq(palp_network_cut(net, turned, NULL), PALP_OK);
        if (k == 0)
            memcpy(expected, palp_network_alive(net), element_count(net));
        ck_assert_mem_eq(expected, palp_network_alive(net), element_count(net));
    }
    free(expected);
    palp_network_free(net);
}
END_TEST

/* A blade's edge along a lattice line, its diagonal too: the rectangle x, z in (0, 1/2) at y between two
 * layers. Whatever the diagonal, each vertical element with its foot in the half open rectangle is cut once,
 * none twice. */
START_TEST(the_seam_of_a_sweep_lets_nothing_through) {
    palp_material m = quartic(0);
    palp_mesh *mesh = NULL;
    palp_network_settings settings = palp_network_settings_default();
    ck_assert_int_eq(palp_mesh_lattice((size_t[]){5, 3, 5}, (double[]){1, 0.5, 1}, PALP_NEIGHBOURS_6, &mesh),
                     PALP_OK);
    palp_network *net = network_on(mesh, &m, &settings);
    palp_mesh_free(mesh);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    static const double corner[4][3] = {{0, 0.375, 0}, {0.5, 0.375, 0}, {0.5, 0.375, 0.5}, {0, 0.375, 0.5}};
    size_t n = 0;
    for (size_t k = 0; k < 2; k++) { /* both diagonals, by starting one corner on */
        size_t o = (size_t)_i, found = 0;
        double blade[9];
        memcpy(blade, corner[o % 4], sizeof corner[0]);
        memcpy(blade + 3, corner[(o + 1 + k) % 4], sizeof corner[0]);
        memcpy(blade + 6, corner[(o + 2 + k) % 4], sizeof corner[0]);
        ck_assert_int_eq(palp_network_cut(net, blade, &found), PALP_OK);
        n += found;
    }
    ck_assert_uint_eq(n, 4);
    palp_network_free(net);
}
END_TEST

/* Springs that pass the seam of two triangles within some roundings of it, on either side: each is cut by one
 * of the two, whatever the order of their corners. A chain below the blade joins their feet. */
START_TEST(at_its_seam_a_sweep_cuts_once) {
    enum { SPRINGS = 20000 };
    static const int turn[3][3] = {{0, 1, 2}, {1, 2, 0}, {2, 1, 0}};
    static double x[6 * SPRINGS];
    static int32_t pair[4 * SPRINGS];
    const double corner[4][3] = {
        {0.011, 0.1003, -0.37}, {1.31, 0.087, -0.211}, {1.07, 0.153, 0.83}, {-0.13, 0.21, 0.617}};
    uint64_t seed = 3 + (uint64_t)_i;
    palp_material m = quartic(0);
    palp_mesh *mesh = NULL;
    for (size_t i = 0; i < SPRINGS; i++) {
        double t = 0.1 + 0.8 * palp_random_uniform(&seed), off = 4e-14 * (palp_random_uniform(&seed) - 0.5);
        double up = 0.1 + palp_random_uniform(&seed), down = 0.1 + palp_random_uniform(&seed);
        double along[3] = {palp_random_uniform(&seed) - 0.5, 1, palp_random_uniform(&seed) - 0.5};
        for (size_t k = 0; k < 3; k++) {
            double at =
                corner[0][k] + t * (corner[2][k] - corner[0][k]) + off * (corner[1][k] - corner[3][k]);
            x[6 * i + k] = at - down * along[k];
            x[6 * i + 3 + k] = at + up * along[k];
        }
        pair[4 * i] = pair[4 * i + 2] = (int32_t)(2 * i);
        pair[4 * i + 1] = (int32_t)(2 * i + 1);
        pair[4 * i + 3] = (int32_t)(2 * i + 2);
    }
    ck_assert_int_eq(palp_mesh_create(2 * SPRINGS, x, 2 * SPRINGS - 1, pair, &mesh, NULL), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_plane_set(mesh, "all", 1, 0.0, 10.0), PALP_OK);
    palp_support held = {"all", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}};
    palp_network_settings settings = palp_network_settings_default();
    palp_network *net = NULL;
    ck_assert_int_eq(palp_network_create(mesh, &m, 1, &held, &settings, &net, NULL), PALP_OK);
    palp_mesh_free(mesh);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    size_t n = 0;
    for (size_t side = 0; side < 2; side++) { /* corners 0 and 2 in both */
        const size_t of[3] = {0, side ? 2 : 1, side ? 3 : 2};
        double blade[9];
        size_t found;
        for (size_t k = 0; k < 3; k++)
            memcpy(blade + 3 * k, corner[of[turn[_i][k]]], 3 * sizeof *blade);
        ck_assert_int_eq(palp_network_cut(net, blade, &found), PALP_OK);
        if (side == 0)
            ck_assert(found > SPRINGS / 4 && found < SPRINGS - SPRINGS / 4);
        n += found;
    }
    ck_assert_uint_eq(n, SPRINGS); /* what the first cut is cut: the second counts what it missed */
    palp_network_free(net);
}
END_TEST

/* Moeller and Trumbore's test in extended precision; *near: too close to an edge to judge. */
static bool crosses(const double *p, const double *q, const double *c, bool *near) {
    long double d[3], u[3], v[3], w[3];
    for (size_t k = 0; k < 3; k++) {
        d[k] = (long double)q[k] - p[k];
        u[k] = (long double)c[3 + k] - c[k];
        v[k] = (long double)c[6 + k] - c[k];
        w[k] = (long double)p[k] - c[k];
    }
#define CROSS(a, b, i) ((a)[((i) + 1) % 3] * (b)[((i) + 2) % 3] - (a)[((i) + 2) % 3] * (b)[((i) + 1) % 3])
    long double dv[3] = {CROSS(d, v, 0), CROSS(d, v, 1), CROSS(d, v, 2)};
    long double wu[3] = {CROSS(w, u, 0), CROSS(w, u, 1), CROSS(w, u, 2)};
#undef CROSS
    long double det = u[0] * dv[0] + u[1] * dv[1] + u[2] * dv[2];
    long double a = (w[0] * dv[0] + w[1] * dv[1] + w[2] * dv[2]) / det;
    long double b = (d[0] * wu[0] + d[1] * wu[1] + d[2] * wu[2]) / det;
    long double t = (v[0] * wu[0] + v[1] * wu[1] + v[2] * wu[2]) / det;
    long double margin = fminl(fminl(fminl(a, b), 1.0L - a - b), fminl(t, 1.0L - t));
    *near = !(fabsl(margin) > 1e-9L);
    return margin > 0.0L;
}

START_TEST(random_blades_cut_what_they_cross) {
    palp_material m = quartic(0);
    palp_network *net = cuttable(4, &m);
    uint64_t seed = 1 + (uint64_t)_i;
    size_t total = 0;
    step_to(net, 0.1 * HEIGHT, INFINITY);
    for (int k = 0; k < 20; k++) {
        double corners[9];
        random_blade(&seed, 1.0, corners);
        unsigned char before[1000];
        ck_assert_uint_le(element_count(net), sizeof before);
        memcpy(before, palp_network_alive(net), element_count(net));
        size_t n;
        ck_assert_int_eq(palp_network_cut(net, corners, &n), PALP_OK);
        total += n;
        for (size_t e = 0; e < element_count(net); e++) {
            const int32_t *pair = palp_mesh_pairs(palp_network_mesh(net)) + 2 * e;
            const double *x = palp_network_positions(net);
            bool near, hit = crosses(x + 3 * pair[0], x + 3 * pair[1], corners, &near);
            if (!near)
                ck_assert_int_eq(palp_network_alive(net)[e], before[e] && !hit);
        }
    }
    ck_assert_uint_gt(total, 50);
    palp_network_free(net);
}
END_TEST

START_TEST(a_blade_without_area_cuts_nothing) {
    static const double blades[3][9] = {{0.01, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01},
                                        {-1, 0.011, 0.011, 0, 0.011, 0.011, 1, 0.011, 0.011},
                                        {-1, -1, -1, 0, 0, 0, 1, 1, 1}};
    palp_material m = quartic(0);
    palp_network *net = cuttable(4, &m);
    size_t n = 7;
    ck_assert_int_eq(palp_network_cut(net, blades[_i], &n), PALP_OK);
    ck_assert_uint_eq(n, 0);
    palp_network_free(net);
}
END_TEST

/* Nodes that are on the blade but for rounding are all on the side to which the shift takes them. */
START_TEST(nodes_on_the_blade_are_on_one_side) {
    static const double shift[3] = {1.0, 0.7548776662466927, 0.5698402909980532};
    uint64_t seed = 4;
    for (int trial = 0; trial < 2000; trial++) {
        double corners[9], u[3], v[3], x[3], s = palp_random_uniform(&seed), t = palp_random_uniform(&seed),
                                             d = 0.0;
        signed char side;
        for (int i = 0; i < 9; i++)
            corners[i] = palp_random_uniform(&seed) - 0.5;
        for (int k = 0; k < 3; k++) {
            u[k] = corners[3 + k] - corners[k];
            v[k] = corners[6 + k] - corners[k];
            x[k] = corners[k] + s * u[k] + t * v[k];
        }
        for (int k = 0; k < 3; k++)
            d += shift[k] * (u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
        cut_sides(1, x, corners, &side);
        ck_assert_msg(side == (d > 0.0 ? 1 : -1), "trial %d: %d, not as %g", trial, side, d);
    }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, nodes_on_the_blade_are_on_one_side);
    tcase_add_test(tc, a_level_cut_takes_the_layer_between);
    tcase_add_loop_test(tc, a_blade_through_nodes_cuts_one_side, 0, 5);
    tcase_add_loop_test(tc, the_order_of_corners_plays_no_part, 0, 40);
    tcase_add_loop_test(tc, the_seam_of_a_sweep_lets_nothing_through, 0, 4);
    tcase_add_loop_test(tc, at_its_seam_a_sweep_cuts_once, 0, 3);
    tcase_add_loop_test(tc, random_blades_cut_what_they_cross, 0, 10);
    tcase_add_loop_test(tc, a_blade_without_area_cuts_nothing, 0, 3);
}
