/* test_visual.c: a fine surface that a network carries along. */
#include "network_settle.h"

#include <palpate/cut.h>
#include <palpate/visual.h>

static const double PI = 3.14159265358979323846;

enum { SIDE = 24, VERTICES = (SIDE + 1) * (2 * SIDE), TRIANGLES = 4 * SIDE * SIDE };

typedef struct ball {
    double x[3 * VERTICES];
    int32_t triangle[3 * TRIANGLES];
    double middle[3], radius;
} ball;

/* A sphere by latitude and longitude, outward; its poles have many vertices. */
static void make_ball(ball *b, const palp_network *net, double radius) {
    double low[3], high[3];
    palp_mesh_bounds(palp_network_mesh(net), low, high);
    b->radius = radius;
    for (int k = 0; k < 3; k++)
        b->middle[k] = 0.5 * (low[k] + high[k]);
    for (int i = 0; i <= SIDE; i++)
        for (int j = 0; j < 2 * SIDE; j++) {
            const double up = PI * i / SIDE, around = PI * j / SIDE;
            double *x = b->x + 3 * (i * 2 * SIDE + j);
            x[0] = b->middle[0] + radius * sin(up) * cos(around);
            x[1] = b->middle[1] + radius * cos(up);
            x[2] = b->middle[2] + radius * sin(up) * sin(around);
        }
    for (int i = 0, n = 0; i < SIDE; i++)
        for (int j = 0; j < 2 * SIDE; j++) {
            const int32_t a = i * 2 * SIDE + j, c = i * 2 * SIDE + (j + 1) % (2 * SIDE), down = 2 * SIDE;
            const int32_t two[6] = {a, c, a + down, c, c + down, a + down};
            for (int k = 0; k < 6; k++)
                b->triangle[n++] = two[k];
        }
}

static palp_visual *bind(const palp_network *net, const ball *b) {
    palp_visual *visual = NULL;
    palp_error error = {PALP_OK, ""};
    palp_status status = palp_visual_create(net, VERTICES, b->x, TRIANGLES, b->triangle, &visual, &error);
    ck_assert_msg(!status, "%s", error.text);
    return visual;
}

static palp_network *network_of(int tetrahedra, const palp_material *m) {
    const palp_network_settings settings = palp_network_settings_default();
    palp_mesh *mesh = NULL;
    if (tetrahedra)
        ck_assert_int_eq(palp_mesh_read_gmsh("data/meshes/box_tetra.msh", 1e-3, false, &mesh, NULL), PALP_OK);
    else
        mesh = cube(5, PALP_NEIGHBOURS_26);
    palp_network *net = network_on(mesh, m, &settings);
    palp_mesh_free(mesh);
    return net;
}

/* At rest it is itself, with the normals of a sphere. */
START_TEST(at_rest) {
    const palp_material m = quartic(0);
    palp_network *net = network_of(_i, &m);
    static ball b;
    static double x[3 * VERTICES], normal[3 * VERTICES];
    make_ball(&b, net, 0.45 * HEIGHT);
    palp_visual *visual = bind(net, &b);
    ck_assert_int_eq(palp_visual_follow(visual, net, x, normal), PALP_OK);
    for (size_t i = 0; i < 3 * VERTICES; i++)
        ck_assert_double_eq(x[i], b.x[i]);
    for (size_t i = 2 * SIDE; i < VERTICES - 2 * SIDE; i++) {
        double along = 0.0;
        for (size_t k = 0; k < 3; k++)
            along += normal[3 * i + k] * (x[3 * i + k] - b.middle[k]) / b.radius;
        ck_assert_double_gt(along, 0.99);
    }
    palp_visual_free(visual);
    palp_network_free(net);
}
END_TEST

/* An affine motion of the nodes is that of every vertex, also of those outside the mesh. */
START_TEST(affine_motion) {
    static const double A[9] = {1.1, 0.2, 0.0, -0.1, 0.9, 0.05, 0.0, 0.3, 1.0},
                        SHIFT[3] = {0.01, -0.02, 0.003};
    const palp_material m = quartic(0);
    palp_network *net = network_of(_i, &m);
    static ball b;
    static double x[3 * VERTICES];
    static float as_float[3 * VERTICES], normal[3 * VERTICES];
    make_ball(&b, net, 0.6 * HEIGHT);
    palp_visual *visual = bind(net, &b);
    for (size_t i = 0; i < 3 * net->n_nodes; i++) {
        const double *r = net->rest + i - i % 3, *a = A + 3 * (i % 3);
        net->now.x[i] = a[0] * r[0] + a[1] * r[1] + a[2] * r[2] + SHIFT[i % 3];
    }
    ck_assert_int_eq(palp_visual_follow(visual, net, x, NULL), PALP_OK);
    ck_assert_int_eq(palp_visual_follow_float(visual, net, as_float, normal), PALP_OK);
    for (size_t i = 0; i < 3 * VERTICES; i++) {
        const double *r = b.x + i - i % 3, *a = A + 3 * (i % 3);
        ck_assert_double_eq_tol(x[i], a[0] * r[0] + a[1] * r[1] + a[2] * r[2] + SHIFT[i % 3], 1e-12);
        ck_assert_double_eq_tol((double)as_float[i], x[i], 1e-7 * fabs(x[i]));
    }
    palp_visual_free(visual);
    palp_network_free(net);
}
END_TEST

/* A cut through the middle takes triangles away across it alone, and both sides come apart; whole again, all
 * are there. */
START_TEST(cut_apart) {
    const palp_material m = quartic(0);
    palp_network *net = network_of(_i, &m);
    static ball b;
    static double x[3 * VERTICES];
    const int32_t *triangles;
    size_t n, version, before, cut;
    make_ball(&b, net, 0.45 * HEIGHT);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    palp_visual *visual = bind(net, &b);
    ck_assert_int_eq(palp_visual_follow(visual, net, x, NULL), PALP_OK);
    ck_assert_int_eq(palp_visual_triangles(visual, &n, &triangles, &before), PALP_OK);
    ck_assert_uint_eq(n, TRIANGLES);
    const double y = b.middle[1] + 0.06 * HEIGHT, far = 1.0;
    const double blade[2][9] = {{-far, y, -far, far, y, -far, far, y, far},
                                {-far, y, -far, far, y, far, -far, y, far}};
    for (int k = 0; k < 2; k++)
        ck_assert_int_eq(palp_network_cut(net, blade[k], &cut), PALP_OK);
    for (size_t i = 0; i < net->n_nodes; i++)
        net->now.x[3 * i + 1] = net->rest[3 * i + 1] + (net->rest[3 * i + 1] > y ? HEIGHT : 0.0);
    ck_assert_int_eq(palp_visual_follow(visual, net, x, NULL), PALP_OK);
    ck_assert_int_eq(palp_visual_triangles(visual, &n, &triangles, &version), PALP_OK);
    ck_assert_uint_ne(version, before);
    ck_assert_uint_lt(n, TRIANGLES);
    ck_assert_uint_gt(n, TRIANGLES * 3 / 4);
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++) { /* no triangle is stretched across the gap */
            const double *p = x + 3 * triangles[3 * i + (size_t)k],
                         *q = x + 3 * triangles[3 * i + (size_t)(k + 1) % 3];
            ck_assert_double_lt(fabs(p[1] - q[1]), 0.2 * HEIGHT);
        }
    palp_network_reset(net);
    ck_assert_int_eq(palp_visual_follow(visual, net, x, NULL), PALP_OK);
    ck_assert_int_eq(palp_visual_triangles(visual, &n, &triangles, NULL), PALP_OK);
    ck_assert_uint_eq(n, TRIANGLES);
    palp_visual_free(visual);
    palp_network_free(net);
}
END_TEST

/* Two networks of one mesh that are cut in different places: each is drawn as its own. */
START_TEST(two_networks) {
    const palp_material m = quartic(0);
    palp_network *net[2];
    palp_visual *visual = NULL;
    static ball b;
    static double x[3 * VERTICES];
    int32_t *first[2];
    size_t n[2], cut;
    for (int i = 0; i < 2; i++) {
        net[i] = network_of(0, &m);
        ck_assert_int_eq(palp_network_enable_cutting(net[i]), PALP_OK);
        const double y = (i ? 0.6 : 0.4) * HEIGHT;
        ck_assert_int_eq(palp_network_cut(net[i], (double[]){-1, y, -1, 2, y, -1, -1, y, 2}, &cut), PALP_OK);
        ck_assert_uint_gt(cut, 0);
    }
    ck_assert_uint_eq(net[0]->surface_changes, net[1]->surface_changes);
    make_ball(&b, net[0], 0.45 * HEIGHT);
    visual = bind(net[0], &b);
    for (int i = 0; i < 2; i++) {
        const int32_t *triangles;
        ck_assert_int_eq(palp_visual_follow(visual, net[i], x, NULL), PALP_OK);
        ck_assert_int_eq(palp_visual_triangles(visual, &n[i], &triangles, NULL), PALP_OK);
        first[i] = malloc(3 * TRIANGLES * sizeof *first[i]);
        memcpy(first[i], triangles, 3 * n[i] * sizeof *triangles);
    }
    ck_assert(n[0] != n[1] || memcmp(first[0], first[1], 3 * n[0] * sizeof *first[0]) != 0);
    for (int i = 0; i < 2; i++) {
        free(first[i]);
        palp_network_free(net[i]);
    }
    palp_visual_free(visual);
}
END_TEST

START_TEST(what_is_refused) {
    const palp_material m = quartic(0);
    palp_network *net = cube_network(3, &m, NULL), *other = cube_network(4, &m, NULL),
                 *bare = column_of(3, &m);
    double x[9] = {0.0};
    palp_visual *visual = NULL;
    palp_error error = {PALP_OK, ""};
    ck_assert_int_eq(palp_visual_create(net, 3, x, 1, (int32_t[]){0, 1, 3}, &visual, &error), PALP_ERR_INPUT);
    ck_assert_str_eq(error.text, "triangle 0: there is no vertex 3");
    ck_assert_int_eq(palp_visual_create(bare, 3, x, 1, (int32_t[]){0, 1, 2}, &visual, &error),
                     PALP_ERR_UNSUPPORTED);
    ck_assert_int_eq(palp_visual_create(net, 3, x, 1, (int32_t[]){0, 1, 2}, &visual, &error), PALP_OK);
    ck_assert_int_eq(palp_visual_follow(visual, other, x, NULL), PALP_ERR_ARGUMENT);
    palp_visual_free(visual);
    palp_network_free(net);
    palp_network_free(other);
    palp_network_free(bare);
}
END_TEST

void tests(TCase *tc);
void tests(TCase *tc) {
    tcase_add_loop_test(tc, at_rest, 0, 2);
    tcase_add_loop_test(tc, affine_motion, 0, 2);
    tcase_add_loop_test(tc, cut_apart, 0, 2);
    tcase_add_test(tc, two_networks);
    tcase_add_test(tc, what_is_refused);
}
