/* test_skin.c: the smooth surface that tools touch: Loop's scheme against what is known of it, and how little
 * of the mesh is felt through it. */
#include "tool_make.h"
#include "contact/skin.h"

#include <palpate/cut.h>

/* ---- the surface --------------------------------------------------------------------------------- */

typedef struct made {
    arena memory;
    palp_mesh *mesh;
    double *unit; /* of each node, 1 + a tenth of its number */
    skin skin;
} made;

static void make(made *m, palp_mesh *mesh, size_t subdivisions) {
    *m = (made){.mesh = mesh};
    size_t n = palp_mesh_node_count(mesh);
    m->unit = malloc(n * sizeof *m->unit);
    for (size_t i = 0; i < n; i++)
        m->unit[i] = 1.0 + 0.1 * (double)i;
    ck_assert_int_eq(skin_make(&m->memory, n, palp_mesh_positions(mesh), palp_mesh_triangle_count(mesh),
                               palp_mesh_triangles(mesh), m->unit, subdivisions, &m->skin),
                     PALP_OK);
}

static void drop(made *m) {
    arena_free(&m->memory);
    palp_mesh_free(m->mesh);
    free(m->unit);
}

/* What a vertex has of a node. */
static double weight_of(const skin *s, size_t vertex, int32_t node) {
    for (uint32_t k = s->first[vertex]; k < s->first[vertex + 1]; k++)
        if (s->node[k] == node)
            return s->weight[k];
    return 0.0;
}

START_TEST(weights_are_means) {
    for (size_t subdivisions = 1; subdivisions <= 3; subdivisions++) {
        made m;
        make(&m, cube(4, PALP_NEIGHBOURS_26), subdivisions);
        const skin *s = &m.skin;
        double nodes = 0.0, vertices = 0.0;
        ck_assert_uint_eq(s->n_triangles, palp_mesh_triangle_count(m.mesh) << 2 * subdivisions);
        for (size_t v = 0; v < s->n; v++) {
            double sum = 0.0;
            for (uint32_t k = s->first[v]; k < s->first[v + 1]; k++) {
                ck_assert_double_ge(s->weight[k], 0.0);
                ck_assert(k == s->first[v] || s->node[k] > s->node[k - 1]);
                sum += s->weight[k];
            }
            ck_assert_double_eq_tol(sum, 1.0, 1e-14);
            vertices += s->unit[v];
        }
        for (size_t i = 0; i < palp_mesh_node_count(m.mesh); i++) { /* 8 of 64 are inside */
            const double *x = palp_mesh_positions(m.mesh) + 3 * i;
            bool outside = false;
            for (int k = 0; k < 3; k++)
                outside = outside || x[k] < 1e-9 || x[k] > HEIGHT - 1e-9;
            nodes += outside ? m.unit[i] : 0.0;
        }
        ck_assert_double_eq_tol(vertices, nodes, 1e-10 * nodes);
        drop(&m);
    }
}
END_TEST

/* In the middle of a face each node has six neighbours: the limit of a vertex is half itself and a twelfth of
 * each (Loop 1987), here of nodes that were moved by the same means before. The corners of a cube stay, its
 * edges and faces stay straight and plane; and a limit does not depend on how often the surface was
 * subdivided on the way there. */
START_TEST(limits_are_loops) {
    const size_t n = 7;
    made once, twice;
    make(&once, cube(n, PALP_NEIGHBOURS_26), 1);
    make(&twice, cube(n, PALP_NEIGHBOURS_26), 2);
    const int32_t middle = (int32_t)((3 * n + 6) * n + 3), corner = (int32_t)(6 * n),
                  edge = (int32_t)((3 * n + 6) * n);
    ck_assert_double_eq_tol(weight_of(&once.skin, (size_t)middle, middle), 0.25 + 6.0 / 144.0, 1e-14);
    ck_assert_double_eq_tol(weight_of(&once.skin, (size_t)middle, middle + 1), 1.0 / 12.0 + 2.0 / 144.0,
                            1e-14);
    ck_assert_double_eq_tol(weight_of(&once.skin, (size_t)corner, corner), 1.0, 1e-14);
    ck_assert_double_eq_tol(weight_of(&once.skin, (size_t)edge, edge), 4.0 / 9.0 + 2.0 / 36.0, 1e-14);
    ck_assert_double_eq_tol(weight_of(&once.skin, (size_t)edge, edge + (int32_t)(n * n)), 2.0 / 9.0, 1e-14);
    for (size_t v = 0; v < once.skin.n; v++)
        for (int k = 0; k < 3; k++)
            ck_assert_double_eq_tol(once.skin.rest[3 * v + (size_t)k], twice.skin.rest[3 * v + (size_t)k],
                                    1e-15);
    for (size_t v = 0; v < twice.skin.n; v++) {
        bool on_a_face = twice.skin.around_first[v] == twice.skin.around_first[v + 1]; /* or inside */
        for (size_t k = 0; k < 3; k++) {
            double x = twice.skin.rest[3 * v + k];
            on_a_face = on_a_face || fabs(x) < 1e-15 || fabs(x - HEIGHT) < 1e-15;
        }
        ck_assert(on_a_face);
    }
    drop(&once);
    drop(&twice);
}
END_TEST

/* ---- what is felt -------------------------------------------------------------------------------- */

/* Of a smooth sphere that is led across two edges of a mesh, around its middle: its mean force, and over that
 * the largest less the smallest force, normal and lateral; of the force less its mean over the way of an
 * edge, which the whole block's shape gives it. */
typedef struct felt {
    double mean, normal, lateral;
} felt;

enum { EDGE = 12, PLACES = 2 * EDGE + 1 }; /* steps to an edge */

static double ripple_of(const double force[PLACES]) {
    double low = INFINITY, high = -INFINITY;
    for (int i = EDGE / 2; i < PLACES - EDGE / 2; i++) {
        double around = 0.5 * (force[i - EDGE / 2] + force[i + EDGE / 2]);
        for (int j = 1 - EDGE / 2; j < EDGE / 2; j++)
            around += force[i + j];
        low = fmin(low, force[i] - around / EDGE);
        high = fmax(high, force[i] - around / EDGE);
    }
    return high - low;
}

/* Along x, and as far along z if across. */
static felt slide(const palp_contact_settings *touch, double radius, double press, bool across) {
    const double edge = HEIGHT / 6.0;
    palp_material m = linear();
    double force[3][PLACES], mean = 0.0;
    palp_network *net = block(7, &m, 0.0, touch);
    for (int i = -2; i < PLACES; i++) {
        double aside = edge * ((double)(i < 0 ? 0 : i) / EDGE - 1.0),
               deep = press * (i < 0 ? (3.0 + i) / 3.0 : 1.0);
        palp_tool tool = sphere(0.5 * HEIGHT + 3e-4 + aside, HEIGHT - deep,
                                0.5 * HEIGHT + 7e-4 + (across ? aside : 0.0), radius, 0);
        palp_tool_force now = step(net, &tool, 0.01);
        for (int k = 0; k < 3 && i >= 0; k++)
            force[k][i] = now.force_N[k];
        mean += i >= 0 ? now.force_N[1] / PLACES : 0.0;
    }
    palp_network_free(net);
    return (felt){mean, ripple_of(force[1]) / mean, fmax(ripple_of(force[0]), ripple_of(force[2])) / mean};
}

START_TEST(a_sphere_feels_little_of_the_mesh) {
    for (int across = 0; across < 2; across++) {
        palp_contact_settings touch = palp_contact_settings_default();
        felt points = slide(&touch, 0.005, 0.0015, across);
        touch.local = false;
        felt triangles = slide(&touch, 0.005, 0.0015, across);
        touch.subdivisions = 2;
        felt smooth = slide(&touch, 0.005, 0.0015, across);
        ck_assert_double_gt(triangles.normal, 0.05);
        ck_assert_double_gt(triangles.lateral, 0.05);
        ck_assert_msg(points.normal < 0.1 && points.lateral < 0.1, "ripple %g, lateral %g", points.normal,
                      points.lateral);
        ck_assert(points.normal < triangles.normal && points.lateral < triangles.lateral);
        ck_assert_msg(smooth.normal < 0.012 && smooth.lateral < 0.015, "ripple %g, lateral %g", smooth.normal,
                      smooth.lateral);
        felt large = slide(&touch, 0.01, 0.0015, across);
        ck_assert_double_lt(large.normal, 0.012);
        ck_assert_double_lt(large.lateral, 0.012);
    }
}
END_TEST

/* One of less than an edge needs a subdivision more. */
START_TEST(a_small_sphere_feels_little_of_the_mesh) {
    palp_contact_settings touch = palp_contact_settings_default();
    touch.subdivisions = 3;
    felt smooth = slide(&touch, 0.003, 0.001, true);
    ck_assert_msg(smooth.normal < 0.012 && smooth.lateral < 0.012, "ripple %g, lateral %g", smooth.normal,
                  smooth.lateral);
}
END_TEST

/* A cube that is scaled as a solid and has its force under a bonded plate, with a smooth surface or local
 * points. */
static palp_network *solid_block(size_t n, double stiffness, bool plate, bool local) {
    palp_mesh *mesh = cube(n, PALP_NEIGHBOURS_26);
    palp_material m = {.n_arms = 0};
    palp_network_settings settings = palp_network_settings_default();
    palp_contact_settings touch = palp_contact_settings_default();
    palp_support supports[2];
    palp_network *net = NULL;
    palp_supports_default(supports);
    touch.subdivisions = local ? 0 : n > 5 ? 2 : 3;
    touch.local = local;
    ck_assert_int_eq(palp_law_polynomial(1, &stiffness, &m.law), PALP_OK);
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, 0.0, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_create(mesh, &m, plate ? 2 : 1, supports, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(net, 1, 0, &touch), PALP_OK);
    palp_mesh_free(mesh);
    return net;
}

/* A bonded cube of 24 mm and Poisson's ratio 1/4 has 8.18 N per unit strain with 13590 Pa. A network with
 * that force lets spheres feel what Hertz says of the solid, wherever they are between its nodes. For this
 * block Hertz is right within 3 %. */
START_TEST(a_sphere_feels_the_solid) {
    static const struct {
        size_t nodes;
        double within, smallest; /* smallest radius for which, m */
    } CASES[] = {{5, 0.15, 0.005}, {7, 0.12, 0.003}, {9, 0.12, 0.003},
                 {5, 0.12, 0.003}, {7, 0.1, 0.003},  {9, 0.12, 0.003}};
    const bool local = _i >= 3;
    static const double RADIUS[] = {0.003, 0.005, 0.010}, PLATE = 8.18, MODULUS = 13590.0;
    const size_t n = CASES[_i].nodes;
    palp_network *plate = solid_block(n, PLATE, true, local);
    ck_assert_int_eq(palp_network_step(plate, 1e-5 * HEIGHT, INFINITY, NULL), PALP_OK);
    const double stiffness = PLATE * 1e-5 * PLATE / palp_network_force(plate),
                 edge = HEIGHT / (double)(n - 1);
    palp_network_free(plate);
    for (size_t r = 0; r < 3; r++)
        for (int place = 0; place < 3 && RADIUS[r] >= CASES[_i].smallest; place++) {
            palp_network *net = solid_block(n, stiffness, false, local);
            for (int half = 1; half <= 2; half++) {
                const double depth = 0.0005 * half, at = 0.5 * HEIGHT + 0.25 * place * edge;
                palp_tool tool = sphere(at, HEIGHT - depth, 0.5 * HEIGHT + 0.2 * place * edge, RADIUS[r], 0);
                const double force = step(net, &tool, INFINITY).force_N[1],
                             hertz = 4.0 / 3.0 * MODULUS / 0.9375 * sqrt(RADIUS[r] * depth) * depth;
                ck_assert_msg(fabs(force / hertz - 1.0) < CASES[_i].within,
                              "%zu nodes, radius %g, depth %g, place %d: %.3f of the solid's force", n,
                              RADIUS[r], depth, place, force / hertz);
            }
            palp_network_free(net);
        }
}
END_TEST

/* On local points, where the contact is as wide as a cell: the force must hardly tell where the nodes are. */
START_TEST(local_points_hardly_ripple) {
    enum { ALONG = 12, NODES = 7 };
    const double edge = HEIGHT / (NODES - 1);
    double low = INFINITY, high = 0.0;
    palp_network *net = solid_block(NODES, 8.18, false, true);
    for (int i = 0; i < ALONG; i++) {
        const double at = 0.5 * HEIGHT + edge * (i / (double)ALONG - 0.5);
        palp_tool tool = sphere(at + 3e-4, HEIGHT - 0.001, at + 7e-4, 0.003, 0);
        const double force = step(net, &tool, INFINITY).force_N[1];
        low = fmin(low, force);
        high = fmax(high, force);
    }
    ck_assert_msg(high < 1.045 * low, "forces from %g to %g N", low, high);
    palp_network_free(net);
}
END_TEST

START_TEST(forces_balance_and_work_comes_back) {
    palp_contact_settings penalty = palp_contact_settings_default();
    palp_material m = quartic(0);
    const palp_tool tools[] = {sphere(0.0101, HEIGHT, 0.0117, 0.005, 0.3),
                               capsule(0.0081, HEIGHT, 0.0088, 0.004, 0.3), plane(HEIGHT, 0.3)};
    penalty.subdivisions = 1;
    for (int t = 0; t < 3; t++) {
        palp_network *net = block(5, &m, 0.0, &penalty);
        palp_tool tool = tools[t];
        double sum[6], pressed = 0.0, back = 0.0;
        for (int i = 0; i < 10; i++) {
            tool.position_m[1] -= 1e-4;
            pressed = step(net, &tool, INFINITY).force_N[1];
        }
        balance(net, 1, &tool, sum);
        for (int k = 0; k < 3; k++) {
            ck_assert_double_eq_tol(sum[k], 0.0, 1e-8);
            ck_assert_double_eq_tol(sum[3 + k], 0.0, 1e-10);
        }
        tool.friction = 0.0;
        for (int i = 0; i < 20; i++) { /* a smooth tool goes to and fro: what it feels is its place's alone */
            tool.position_m[0] += i < 10 ? 1e-4 : -1e-4;
            back = step(net, &tool, INFINITY).force_N[1];
        }
        palp_network_reset(net);
        for (int i = 0; i < 10; i++) {
            tool.position_m[1] = tools[t].position_m[1] - 1e-4 * (i + 1);
            pressed = step(net, &tool, INFINITY).force_N[1];
        }
        ck_assert_double_eq_tol(back, pressed, 1e-6 * pressed);
        ck_assert_double_gt(pressed, 0.1);
        palp_network_free(net);
    }
}
END_TEST

START_TEST(no_cuts) {
    palp_contact_settings penalty = palp_contact_settings_default();
    palp_material m = quartic(0);
    penalty.subdivisions = 1;
    palp_network *net = block(3, &m, 0.0, &penalty);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_ERR_UNSUPPORTED);
    palp_network_free(net);
    net = cube_network(3, &m, NULL);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(net, 1, 0, &penalty), PALP_ERR_UNSUPPORTED);
    palp_network_free(net);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, weights_are_means);
    tcase_add_test(tc, limits_are_loops);
    tcase_add_test(tc, a_sphere_feels_little_of_the_mesh);
    tcase_add_test(tc, a_small_sphere_feels_little_of_the_mesh);
    tcase_add_loop_test(tc, a_sphere_feels_the_solid, 0, 6);
    tcase_add_test(tc, local_points_hardly_ripple);
    tcase_add_test(tc, forces_balance_and_work_comes_back);
    tcase_add_test(tc, no_cuts);
}
