/* test_mesh_plates.c: a sphere of tetrahedra between two plates that touch it, against Hertz, on three
 * meshes. */
#include "network_make.h"

#include <palpate/tool.h>

static const double RADIUS = 12e-3, MODULUS = 18e3, AREA = 4.5e-4; /* m, Pa, m^2 */
static const char *const MESHES[] = {"data/meshes/ball_4.msh", "data/meshes/ball_3.msh",
                                     "data/meshes/ball_2.6.msh"};

/* The node nearest to the centre is fixed; friction holds the others. */
static palp_network *ball(const char *path) {
    palp_mesh *mesh = NULL;
    palp_network *net = NULL;
    palp_material m = {.n_arms = 0};
    palp_network_settings settings = palp_network_settings_default();
    palp_contact_settings contact = palp_contact_settings_default();
    const palp_support middle = {"middle", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}};
    ck_assert_int_eq(palp_mesh_read_gmsh(path, 1e-3, false, &mesh, NULL), PALP_OK);
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, AREA, NULL), PALP_OK);
    const double *x = palp_mesh_positions(mesh);
    int32_t nearest = 0;
    double least = INFINITY;
    for (size_t i = 0; i < palp_mesh_node_count(mesh); i++) {
        double square = x[3 * i] * x[3 * i] + x[3 * i + 1] * x[3 * i + 1] + x[3 * i + 2] * x[3 * i + 2];
        nearest = square < least ? (int32_t)i : nearest;
        least = fmin(least, square);
    }
    ck_assert_int_eq(palp_mesh_add_set(mesh, "middle", 1, &nearest), PALP_OK);
    ck_assert_int_eq(palp_law_polynomial(1, (double[]){MODULUS * AREA}, &m.law), PALP_OK);
    settings.tolerance = 1e-7;
    ck_assert_int_eq(palp_network_create(mesh, &m, 1, &middle, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(net, 2, 0, &contact), PALP_OK);
    palp_mesh_free(mesh);
    return net;
}

/* F = 4/3 E / (1 - nu^2) sqrt(R) (d / 2)^(3/2) for two plates that come together by d. */
START_TEST(spheres_press_as_hertz_says) {
    const double approach = 2e-3,
                 hertz = 4.0 / 3.0 * MODULUS / (1.0 - 1.0 / 16.0) * sqrt(RADIUS) * pow(1e-3, 1.5);
    palp_network *net = ball(MESHES[_i]);
    palp_tool_force force[2];
    for (int i = 1; i <= 8; i++) {
        double y = RADIUS - 0.5 * approach * i / 8;
        const palp_tool plates[2] = {
            {.shape = PALP_TOOL_PLANE, .position_m = {0, y, 0}, .axis = {0, -1, 0}, .friction = 0.3},
            {.shape = PALP_TOOL_PLANE, .position_m = {0, -y, 0}, .axis = {0, 1, 0}, .friction = 0.3}};
        ck_assert_int_eq(palp_network_set_tools(net, 2, plates), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, 0.0, 1.0, NULL), PALP_OK);
    }
    ck_assert_int_eq(palp_network_tool_force(net, force), PALP_OK);
    ck_assert_uint_ge(force[0].contacts, 3);
    double got = 0.5 * (force[0].force_N[1] - force[1].force_N[1]);
    ck_assert_msg(fabs(got / hertz - 1.0) < 0.05, "%s: %.5f N, Hertz %.5f N", MESHES[_i], got, hertz);
    palp_network_free(net);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, spheres_press_as_hertz_says, 0, 3);
}
