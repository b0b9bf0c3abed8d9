/* test_cut.c: blades, tearing, loose parts and mechanisms, against fresh networks and closed forms. */
#include "cut/cut_internal.h"
#include "network/network_internal.h"
#include "network_make.h"

#include <palpate/cut.h>
#include <palpate/realtime.h>
#include <palpate/tool.h>

/* ---- helpers ------------------------------------------------------------------------------------- */

static palp_network *cuttable(size_t n, const palp_material *m) {
    palp_network *net = cube_network(n, m, NULL);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    return net;
}

static void step_to(palp_network *net, double depth, double dt) {
    palp_step_info info;
    palp_status status = palp_network_step(net, depth, dt, &info);
    ck_assert_msg(!status, "depth %g: %s", depth, palp_status_text(status));
}

/* A blade as a rectangle: corner, two edges. */
static size_t cut_rectangle(palp_network *net, const double o[3], const double u[3], const double v[3]) {
    double first[9], second[9];
    size_t a = 0, b = 0;
    for (size_t k = 0; k < 3; k++) {
        first[k] = second[k] = o[k];
        first[3 + k] = o[k] + u[k];
        first[6 + k] = second[3 + k] = o[k] + u[k] + v[k];
        second[6 + k] = o[k] + v[k];
    }
    ck_assert_int_eq(palp_network_cut(net, first, &a), PALP_OK);
    ck_assert_int_eq(palp_network_cut(net, second, &b), PALP_OK);
    return a + b;
}

/* All of the plane y = height, or its part x <= reach. */
static size_t cut_level(palp_network *net, double height, double reach) {
    return cut_rectangle(net, (double[]){-1.0, height, -1.0}, (double[]){1.0 + reach, 0, 0}, (double[]){0, 0, 2.0});
}

static size_t count_alive(const palp_network *net) {
    size_t n = 0;
    for (size_t i = 0; i < element_count(net); i++)
        n += palp_network_alive(net)[i];
    return n;
}

typedef struct dice {
    uint64_t state;
} dice;

/* 0 to 1, the same on every machine (xorshift64*, Vigna 2016). */
static double roll(dice *d) {
    d->state ^= d->state >> 12;
    d->state ^= d->state << 25;
    d->state ^= d->state >> 27;
    return (double)((d->state * 2685821657736338717u) >> 11) / 9007199254740992.0;
}

static void random_blade(dice *d, double size, double corners[9]) {
    double middle[3];
    for (size_t k = 0; k < 3; k++)
        middle[k] = HEIGHT * roll(d);
    for (size_t i = 0; i < 9; i++)
        corners[i] = middle[i % 3] + size * HEIGHT * (roll(d) - 0.5);
}

/* The same elements as a network of its own: only whole ones, only nodes that one of them meets and that are held. */
static palp_network *afresh(const palp_network *net, const palp_material *m, int32_t **place) {
    size_t n = node_count(net), n_nodes = 0, n_elements = 0;
    const palp_mesh *mesh = palp_network_mesh(net);
    unsigned char *loose = malloc(n);
    double *x = malloc(3 * n * sizeof *x);
    int32_t *index = malloc(n * sizeof *index), *pairs = malloc(2 * element_count(net) * sizeof *pairs);
    ck_assert(loose && x && index && pairs);
    palp_network_loose(net, loose);
    for (size_t i = 0; i < n; i++)
        index[i] = -1;
    for (size_t e = 0; e < element_count(net); e++) {
        const int32_t *pair = palp_mesh_pairs(mesh) + 2 * e;
        if (!palp_network_alive(net)[e] || loose[pair[0]])
            continue;
        for (size_t end = 0; end < 2; end++) {
            if (index[pair[end]] < 0) {
                memcpy(x + 3 * n_nodes, palp_mesh_positions(mesh) + 3 * pair[end], 3 * sizeof *x);
                index[pair[end]] = (int32_t)n_nodes++;
            }
            pairs[2 * n_elements + end] = index[pair[end]];
        }
        n_elements++;
    }
    palp_mesh *part = NULL;
    palp_error error = {PALP_OK, ""};
    palp_status status = palp_mesh_create(n_nodes, x, n_elements, pairs, &part, &error);
    ck_assert_msg(!status, "%s", error.text);
    ck_assert_int_eq(palp_mesh_add_plane_set(part, "bottom", 1, 0.0, 0.0), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_plane_set(part, "top", 1, HEIGHT, 0.0), PALP_OK);
    palp_network_settings settings = palp_network_settings_default();
    palp_network *fresh = network_on(part, m, &settings);
    palp_mesh_free(part);
    free(loose);
    free(x);
    free(pairs);
    if (place)
        *place = index;
    else
        free(index);
    return fresh;
}

/* ---- blades -------------------------------------------------------------------------------------- */

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
    ck_assert_int_eq(palp_mesh_lattice((size_t[]){5, 5, 5}, (double[]){1, 1, 1}, PALP_NEIGHBOURS_26, &mesh), PALP_OK);
    palp_network *net = network_on(mesh, &m, &settings);
    palp_mesh_free(mesh);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    unsigned char *expected = malloc(element_count(net));
    dice d = {17 + (uint64_t)_i};
    double corners[9], turned[9];
    for (size_t i = 0; i < 9; i++)
        corners[i] = floor(5.0 * roll(&d)) / 4.0;
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

/* A blade's edge along a lattice line, its diagonal too: the rectangle x, z in (0, 1/2) at y between two layers.
 * Whatever the diagonal, each vertical element with its foot in the half open rectangle is cut once, none twice. */
START_TEST(the_seam_of_a_sweep_lets_nothing_through) {
    palp_material m = quartic(0);
    palp_mesh *mesh = NULL;
    palp_network_settings settings = palp_network_settings_default();
    ck_assert_int_eq(palp_mesh_lattice((size_t[]){5, 3, 5}, (double[]){1, 0.5, 1}, PALP_NEIGHBOURS_6, &mesh), PALP_OK);
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
    dice d = {1 + (uint64_t)_i};
    size_t total = 0;
    step_to(net, 0.1 * HEIGHT, INFINITY);
    for (int k = 0; k < 20; k++) {
        double corners[9];
        random_blade(&d, 1.0, corners);
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

/* ---- forces -------------------------------------------------------------------------------------- */

START_TEST(cut_through_bears_no_force) {
    palp_material m = material_of(_i);
    palp_network *net = cuttable(4, &m);
    for (int k = 1; k <= 5; k++)
        step_to(net, 0.02 * k * HEIGHT, 0.02);
    ck_assert_double_gt(palp_network_force(net), 0.01);
    cut_level(net, 0.5 * HEIGHT, 1.0);
    step_to(net, 0.1 * HEIGHT, 0.001);
    step_to(net, 0.12 * HEIGHT, 0.001);
    ck_assert_double_eq_tol(palp_network_force(net), 0.0, 1e-10);
    ck_assert_uint_eq(palp_network_loose(net, NULL), 0); /* the top part hangs on the plate */
    double top[3], bottom[3];
    ck_assert_int_eq(palp_network_reaction(net, "top", top), PALP_OK);
    ck_assert_int_eq(palp_network_reaction(net, "bottom", bottom), PALP_OK);
    for (size_t k = 0; k < 3; k++) {
        ck_assert_double_eq_tol(top[k], 0.0, 1e-10);
        ck_assert_double_eq_tol(bottom[k], 0.0, 1e-10);
    }
    palp_network_free(net);
}
END_TEST

/* Cut while pressed, half through, then led to the relaxed state: as a network that never had the elements. */
START_TEST(half_through_is_as_built_without) {
    palp_material m = quartic(_i == 0 ? 0 : 2);
    palp_network *net = cuttable(5, &m);
    for (int k = 1; k <= 5; k++)
        step_to(net, 0.02 * k * HEIGHT, 0.02);
    double whole = palp_network_force(net);
    ck_assert_uint_gt(cut_level(net, 0.37 * HEIGHT, 0.6 * HEIGHT), 50);
    step_to(net, 0.1 * HEIGHT, INFINITY);
    palp_network *fresh = afresh(net, &m, NULL);
    for (int k = 1; k <= 5; k++)
        step_to(fresh, 0.02 * k * HEIGHT, INFINITY);
    double force = palp_network_force(fresh);
    ck_assert_double_lt(force, 0.98 * whole);
    ck_assert_double_eq_tol(palp_network_force(net), force, 1e-8 * force);
    palp_network_free(fresh);
    palp_network_free(net);
}
END_TEST

/* The history after a cut: the same elements cut at rest, the same motion, the same forces all along. */
START_TEST(cut_elements_are_as_if_never_there) {
    palp_material m = material_of(_i);
    palp_network *net = cuttable(4, &m);
    cut_level(net, 0.4 * HEIGHT, 0.5 * HEIGHT);
    palp_network *fresh = afresh(net, &m, NULL);
    for (int k = 1; k <= 8; k++) {
        step_to(net, 0.02 * k * HEIGHT, 0.02);
        step_to(fresh, 0.02 * k * HEIGHT, 0.02);
        double force = palp_network_force(fresh);
        ck_assert_double_eq_tol(palp_network_force(net), force, 1e-9 * force);
    }
    palp_network_free(fresh);
    palp_network_free(net);
}
END_TEST

/* A box of nodes cut out on all sides floats where it was; the rest is as without it. */
START_TEST(a_loose_part_stays_where_it_was) {
    palp_material m = quartic(1);
    palp_network *net = cuttable(6, &m);
    for (int k = 1; k <= 4; k++)
        step_to(net, 0.02 * k * HEIGHT, 0.02);
    const double low = 0.3 * HEIGHT, wide = 0.4 * HEIGHT;
    for (size_t axis = 0; axis < 3; axis++)
        for (int side = 0; side < 2; side++) {
            double o[3] = {low, low, low}, u[3] = {0}, v[3] = {0};
            o[axis] += side * wide;
            u[(axis + 1) % 3] = v[(axis + 2) % 3] = wide;
            cut_rectangle(net, o, u, v);
        }
    unsigned char loose[216];
    ck_assert_uint_eq(palp_network_loose(net, loose), 8);
    for (int k = 0; k < 8; k++) /* the part relaxes against its springs */
        step_to(net, 0.08 * HEIGHT, INFINITY);
    double before[648];
    memcpy(before, palp_network_positions(net), sizeof before);
    for (int k = 5; k <= 24; k++)
        step_to(net, (0.08 + 0.002 * (k - 4)) * HEIGHT, INFINITY);
    for (size_t i = 0; i < 216; i++)
        for (size_t k = 0; k < 3 && loose[i]; k++)
            ck_assert_double_eq_tol(palp_network_positions(net)[3 * i + k], before[3 * i + k], 1e-7 * HEIGHT);
    palp_network *fresh = afresh(net, &m, NULL);
    ck_assert_uint_eq(node_count(fresh), 208);
    for (int k = 1; k <= 6; k++)
        step_to(fresh, 0.02 * k * HEIGHT, INFINITY);
    double force = palp_network_force(fresh);
    ck_assert_double_eq_tol(palp_network_force(net), force, 1e-8 * force);
    palp_network_free(fresh);
    palp_network_free(net);
}
END_TEST

/* Nodes left with one element, two or none are no obstacle, and bear nothing. */
START_TEST(mechanisms_bear_nothing) {
    palp_material m = quartic(0);
    palp_network *net = cuttable(4, &m), *part = cuttable(4, &m);
    const int32_t node = 2 * 16 + 2 * 4 + 1; /* inside */
    int32_t all[26], n_all = 0;
    for (size_t e = 0; e < element_count(net); e++)
        for (size_t end = 0; end < 2; end++)
            if (palp_mesh_pairs(palp_network_mesh(net))[2 * e + end] == node)
                all[n_all++] = (int32_t)e;
    ck_assert_int_eq(n_all, 26);
    for (int k = 1; k <= 4; k++)
        step_to(net, 0.02 * k * HEIGHT, INFINITY);
    ck_assert_int_eq(palp_network_cut_elements(net, (size_t)(26 - _i), all), PALP_OK);
    ck_assert_int_eq(palp_network_cut_elements(part, 26, all), PALP_OK);
    ck_assert_uint_eq(palp_network_loose(net, NULL), _i == 0 ? 1 : 0);
    for (int k = 1; k <= 4; k++)
        step_to(part, 0.02 * k * HEIGHT, INFINITY);
    for (int k = 0; k < 3; k++)
        step_to(net, 0.08 * HEIGHT, INFINITY);
    double force = palp_network_force(part);
    ck_assert_double_eq_tol(palp_network_force(net), force, 1e-8 * force);
    palp_network_free(part);
    palp_network_free(net);
}
END_TEST

/* ---- tearing ------------------------------------------------------------------------------------- */

/* Three parallel springs of 10, 20 and 24 mm from fixed feet to one plate, K = 2 N: strain d / L each. */
static palp_network *bundle(void) {
    static const double x[] = {0, 0.014, 0, 0.01, 0.004, 0, 0.02, 0, 0, 0, HEIGHT, 0, 0.01, HEIGHT, 0, 0.02, HEIGHT, 0};
    static const int32_t pairs[] = {0, 3, 1, 4, 2, 5, 0, 1, 1, 2};
    palp_mesh *mesh = NULL;
    palp_material m = {.n_arms = 0};
    palp_network *net = NULL;
    const double stiffness = 2.0;
    palp_support supports[2];
    palp_network_settings settings = palp_network_settings_default();
    ck_assert_int_eq(palp_law_polynomial(1, &stiffness, &m.law), PALP_OK);
    ck_assert_int_eq(palp_mesh_create(6, x, 5, pairs, &mesh, NULL), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_set(mesh, "bottom", 3, (int32_t[]){0, 1, 2}), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_set(mesh, "top", 3, (int32_t[]){3, 4, 5}), PALP_OK);
    palp_supports_default(supports);
    ck_assert_int_eq(palp_network_create(mesh, &m, 2, supports, &settings, &net, NULL), PALP_OK);
    palp_mesh_free(mesh);
    return net;
}

START_TEST(a_bundle_tears_one_by_one) {
    static const double length[] = {0.010, 0.020, 0.024};
    palp_network *net = bundle();
    bool by_force = _i == 1;
    size_t left = 3;
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    ck_assert_int_eq(palp_network_set_tearing(net, by_force ? 0.0 : 0.3, by_force ? 0.6 : 0.0), PALP_OK);
    for (int k = 1; k <= 80; k++) { /* 0.1 mm upwards each; strain 0.3, 0.6 N, is reached at 3, 6 and 7.2 mm */
        double up = 1e-4 * k, force = 0.0;
        size_t torn = 9, n = 0, expected = 0;
        step_to(net, -up, 1.0);
        for (size_t i = 3 - left; i < 3; i++)
            force += 2.0 * up / length[i];
        ck_assert_double_eq_tol(-palp_network_force(net), force, 1e-12);
        ck_assert_int_eq(palp_network_tear(net, &torn), PALP_OK);
        for (size_t i = 0; i < 3; i++) {
            expected += up / length[i] > 0.3 + 1e-9;
            n += !palp_network_alive(net)[i];
        }
        if (fabs(up / 0.3 - 0.01) > 1e-7 && fabs(up / 0.3 - 0.02) > 1e-7 && fabs(up / 0.3 - 0.024) > 1e-7)
            ck_assert_uint_eq(n, expected);
        ck_assert_uint_eq(torn, n - (3 - left));
        left = 3 - n;
    }
    ck_assert_uint_eq(left, 0);
    palp_network_free(net);
}
END_TEST

/* Two springs in a row bear the same force: the shorter rest length stretches as much, both tear at once and the
 * node between them is loose. Pressing tears nothing. */
START_TEST(a_chain_tears_in_tension_only) {
    palp_material m = quartic(0);
    palp_network *net = column_of(3, &m);
    size_t torn;
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    ck_assert_int_eq(palp_network_set_tearing(net, 0.2, 0.0), PALP_OK);
    step_to(net, 0.3 * HEIGHT, 1.0);
    ck_assert_int_eq(palp_network_tear(net, &torn), PALP_OK);
    ck_assert_uint_eq(torn, 0);
    step_to(net, -0.19 * HEIGHT, 1.0);
    ck_assert_int_eq(palp_network_tear(net, &torn), PALP_OK);
    ck_assert_uint_eq(torn, 0);
    step_to(net, -0.21 * HEIGHT, 1.0);
    ck_assert_int_eq(palp_network_tear(net, &torn), PALP_OK);
    ck_assert_uint_eq(torn, 2);
    step_to(net, -0.25 * HEIGHT, 1.0);
    ck_assert_double_eq(palp_network_force(net), 0.0);
    palp_network_free(net);
}
END_TEST

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
    dice d = {seed};
    memset(r, 0, sizeof *r);
    ck_assert_int_eq(palp_network_set_tearing(net, 0.14, 0.0), PALP_OK);
    for (int k = 0; k < 40; k++) {
        double corners[9], depth = HEIGHT * (0.12 * sin(0.3 * k) + 0.03 * (roll(&d) - 0.5));
        size_t n;
        random_blade(&d, 1.0, corners);
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
    dice d = {5};
    walk(201 + (uint64_t)_i, net, &r);
    snapshot_free(&r.state);
    for (int k = 0; k < 4; k++)
        step_to(net, 0.02 * HEIGHT, INFINITY);
    for (size_t e = 0; e < element_count(net); e++)
        if (!r.alive[e])
            ck_assert_int_eq(palp_network_cut_elements(fresh, 1, &(int32_t){(int32_t)e}), PALP_OK);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        fresh->now.x[i] = net->now.x[i] + (net->dof[i] < 0 ? 0.0 : 1e-6 * HEIGHT * (roll(&d) - 0.5));
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

/* A sphere pushes a loose part aside; it stays where it was left. */
START_TEST(a_tool_moves_a_loose_part) {
    palp_material m = quartic(0);
    palp_mesh *mesh = cube(4, PALP_NEIGHBOURS_26);
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0}};
    palp_network_settings settings = palp_network_settings_default();
    palp_contact_settings contact = palp_contact_settings_default();
    palp_network *net;
    palp_tool tool = {.shape = PALP_TOOL_SPHERE, .position_m = {-0.01, 0.75 * HEIGHT, 0.5 * HEIGHT}, .radius_m = 0.008};
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
    dice d = {31};
    ck_assert_int_eq(palp_realtime_create(net, &settings, &realtime), PALP_OK);
    for (int k = 1; k <= 60; k++) {
        if (k % 6 == 0 && k <= 48) {
            double corners[9];
            random_blade(&d, 1.0, corners);
            ck_assert_int_eq(palp_network_cut(net, corners, NULL), PALP_OK);
        }
        ck_assert_int_eq(palp_realtime_step(realtime, 0.05 * HEIGHT * fmin(1.0, k / 30.0), 0.002, &budget, &info), PALP_OK);
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

/* It encloses the volume of the tetrahedra without a cut edge, at rest, and every edge is walked both ways. */
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
    dice d = {7 + (uint64_t)_i};
    const int32_t *s;
    size_t n;
    ck_assert_int_eq(palp_network_surface(net, &n, &s), PALP_OK);
    ck_assert_uint_eq(n, palp_mesh_triangle_count(palp_network_mesh(net)));
    ck_assert_mem_eq(s, palp_mesh_triangles(palp_network_mesh(net)), 3 * n * sizeof *s);
    for (int k = 0; k < 6; k++) {
        double corners[9];
        random_blade(&d, 1.0, corners);
        ck_assert_int_eq(palp_network_cut(net, corners, NULL), PALP_OK);
        check_surface(net);
    }
    palp_network_free(net);
}
END_TEST

/* ---- misuse -------------------------------------------------------------------------------------- */

START_TEST(misuse_is_refused) {
    palp_material m = quartic(0);
    palp_network *net = cube_network(3, &m, NULL);
    double blade[9] = {0, 0, 0, 1, 0, 0, 0, 0, 1};
    const int32_t *s, bad = 158, negative = -1;
    size_t n;
    unsigned char loose[27];
    ck_assert_int_eq(palp_network_cut(net, blade, &n), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_tear(net, &n), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_set_tearing(net, 0.1, 0.0), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_cut_elements(net, 0, NULL), PALP_ERR_ARGUMENT);
    ck_assert_ptr_null(palp_network_alive(net));
    memset(loose, 9, sizeof loose);
    ck_assert_uint_eq(palp_network_loose(net, loose), 0);
    ck_assert_int_eq(loose[26], 0);
    ck_assert_int_eq(palp_network_surface(net, &n, &s), PALP_OK);
    ck_assert_uint_eq(n, 48);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_cut_elements(net, 1, &bad), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_cut_elements(net, 1, &negative), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_set_tearing(net, -0.1, 0.0), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_set_tearing(net, 0.1, NAN), PALP_ERR_ARGUMENT);
    blade[4] = NAN;
    ck_assert_int_eq(palp_network_cut(net, blade, &n), PALP_ERR_ARGUMENT);
    blade[4] = INFINITY;
    ck_assert_int_eq(palp_network_cut(net, blade, &n), PALP_ERR_ARGUMENT);
    palp_network_free(net);
}
END_TEST

/* Every element cut: all inner nodes are loose, and the network still steps. */
START_TEST(nothing_left) {
    palp_material m = quartic(1);
    palp_network *net = cuttable(4, &m);
    int32_t *all = malloc(element_count(net) * sizeof *all);
    for (size_t i = 0; i < element_count(net); i++)
        all[i] = (int32_t)i;
    step_to(net, 0.05 * HEIGHT, 0.1);
    ck_assert_int_eq(palp_network_cut_elements(net, element_count(net), all), PALP_OK);
    ck_assert_uint_eq(palp_network_loose(net, NULL), 32);
    step_to(net, 0.06 * HEIGHT, 0.1);
    ck_assert_double_eq(palp_network_force(net), 0.0);
    free(all);
    palp_network_free(net);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, a_level_cut_takes_the_layer_between);
    tcase_add_loop_test(tc, a_blade_through_nodes_cuts_one_side, 0, 5);
    tcase_add_loop_test(tc, the_order_of_corners_plays_no_part, 0, 40);
    tcase_add_loop_test(tc, the_seam_of_a_sweep_lets_nothing_through, 0, 4);
    tcase_add_loop_test(tc, random_blades_cut_what_they_cross, 0, 10);
    tcase_add_loop_test(tc, a_blade_without_area_cuts_nothing, 0, 3);
    tcase_add_loop_test(tc, cut_through_bears_no_force, 0, KINDS);
    tcase_add_loop_test(tc, half_through_is_as_built_without, 0, 2);
    tcase_add_loop_test(tc, cut_elements_are_as_if_never_there, 0, KINDS);
    tcase_add_test(tc, a_loose_part_stays_where_it_was);
    tcase_add_loop_test(tc, mechanisms_bear_nothing, 0, 3);
    tcase_add_loop_test(tc, a_bundle_tears_one_by_one, 0, 2);
    tcase_add_test(tc, a_chain_tears_in_tension_only);
    tcase_add_test(tc, a_cut_drops_the_trial_and_keeps_the_state);
    tcase_add_test(tc, reset_makes_whole);
    tcase_add_loop_test(tc, random_cuts_and_tears_twice_the_same, 0, 6);
    tcase_add_loop_test(tc, a_walk_ends_where_a_fresh_network_is, 0, 3);
    tcase_add_test(tc, restore_brings_the_cuts_back);
    tcase_add_test(tc, a_held_part_is_not_loose);
    tcase_add_test(tc, a_tool_moves_a_loose_part);
    tcase_add_test(tc, cuts_within_a_budget);
    tcase_add_loop_test(tc, the_surface_follows_the_cuts, 0, 5);
    tcase_add_test(tc, misuse_is_refused);
    tcase_add_test(tc, nothing_left);
}
