/* test_tool_turn.c: tools that turn: spin drags the tissue, whatever the steps, and where all is turned or
 * measured in other units nothing else changes. */
#include "hull_make.h"
#include "tool_make.h"

/* ---- spin ------------------------------------------------------------------------------------------ */

static const double ALONG[3] = {0, 0, 1}, UP[3] = {0, 1, 0};

/* A sphere, a capsule on its side and a hull that is almost a sphere, pressed 1 mm. */
static palp_tool pressed(int shape, const palp_hull *hull, double radius, double friction) {
    palp_tool tool = sphere(0.0121, HEIGHT - 1e-3, 0.0118, radius, friction);
    if (shape == 1) {
        tool.shape = PALP_TOOL_CAPSULE;
        tool.position_m[2] -= 0.003;
        tool.length_m = 0.006;
        memcpy(tool.axis, ALONG, sizeof tool.axis);
    } else if (shape == 2) {
        tool.shape = PALP_TOOL_HULL;
        tool.hull = hull;
    }
    return tool;
}

static palp_tool_force spin(palp_tool tool, double angle, int steps, palp_network *net) {
    palp_tool_force f = step(net, &tool, INFINITY);
    for (int i = 0; i < steps; i++) {
        turn_tool(&tool, ALONG, angle / steps);
        f = step(net, &tool, INFINITY);
    }
    return f;
}

/* Spinning on the surface a tool slips: the moment about its axis is friction times force times radius, less
 * what its points are nearer than that: 5 % at most. So it is in few steps and in many, and without friction
 * there is none. _i: shape. */
START_TEST(spin_drags_the_surface) {
    palp_material m = linear();
    const double radius = 0.005, friction = 0.3;
    palp_hull *hull = box_hull(1e-3 * radius, 1e-3 * radius, 1e-3 * radius);
    double moment[2];
    for (int rough = 0; rough < 3; rough++) {
        const double mu = rough > 0 ? friction : 0.0;
        palp_network *net = block(7, &m, 0.0, NULL);
        const palp_tool_force f = spin(pressed(_i, hull, radius, mu), 1.5, rough == 2 ? 4 : 20, net);
        const double most = mu * f.force_N[1] * radius;
        if (rough > 0) {
            double aside = 0.0;
            for (size_t i = 0; i < net->n_nodes; i++)
                aside = fmax(aside, palp_network_positions(net)[3 * i] - net->rest[3 * i]);
            ck_assert_double_eq_tol(f.moment_Nm[2], -0.97 * most, 0.025 * most);
            ck_assert_double_lt(f.force_N[0], -0.8 * mu * f.force_N[1]);
            ck_assert_double_gt(aside, 1e-4);
            moment[rough - 1] = f.moment_Nm[2];
        } else /* the hull is not quite a sphere */
            ck_assert_double_lt(fabs(f.moment_Nm[2]),
                                _i == 2 ? 1e-3 * friction * f.force_N[1] * radius : 1e-15);
        palp_network_free(net);
    }
    ck_assert_double_eq_tol(moment[1], moment[0], 2e-3 * fabs(moment[0]));
    palp_hull_free(hull);
}
END_TEST

/* A plane that turns about its normal twists what it holds. */
START_TEST(a_plane_twists) {
    palp_material m = linear();
    palp_network *net = block(5, &m, 0.0, NULL);
    palp_tool flat = plane(HEIGHT - 1e-3, 5.0);
    step(net, &flat, INFINITY);
    turn_tool(&flat, UP, 0.01);
    const palp_tool_force f = step(net, &flat, INFINITY);
    ck_assert_double_lt(f.moment_Nm[1], -1e-5);
    const double *x = palp_network_positions(net) + 3 * (4 * 25 + 4 * 5 + 2);
    ck_assert_double_eq_tol(x[2] - 0.012, -0.01 * 0.012, 0.1 * 0.01 * 0.012); /* of the side at x = 24 mm */
    palp_network_free(net);
}
END_TEST

/* A box that turns by 90 degrees about the normal. Smooth, its force and its lever differ by 0.2 % and 0.01
 * mm between one step and 30: a point has the stiffness of its place at a step's start. Rough, its moment
 * differs by 4 % between 6 steps and 30. */
START_TEST(turned_in_many_steps_or_few) {
    palp_material m = linear();
    palp_hull *hull = box_hull(0.006, 0.002, 0.004);
    for (int rough = 0; rough < 2; rough++) {
        static const int steps[3] = {30, 6, 1};
        palp_tool_force f[3];
        for (int k = 0; k < (rough ? 2 : 3); k++) {
            palp_network *net = block(7, &m, 0.0, NULL);
            palp_tool box = hull_tool(hull, 0.0121, HEIGHT + 0.002, 0.0118, 0.001, rough ? 0.3 : 0.0);
            step(net, &box, INFINITY);
            for (int i = 0; i < steps[k]; i++) {
                turn_tool(&box, UP, 0.5 * acos(-1.0) / steps[k]);
                f[k] = step(net, &box, INFINITY);
            }
            palp_network_free(net);
            if (rough) {
                ck_assert_double_eq_tol(f[k].moment_Nm[1], f[0].moment_Nm[1], 0.04 * fabs(f[0].moment_Nm[1]));
                ck_assert_double_eq_tol(f[k].force_N[1], f[0].force_N[1], 1e-3 * f[0].force_N[1]);
            } else
                for (int i = 0; i < 3; i++) {
                    ck_assert_double_eq_tol(f[k].force_N[i], f[0].force_N[i], 2e-3 * f[0].force_N[1]);
                    ck_assert_double_eq_tol(f[k].moment_Nm[i], f[0].moment_Nm[i], 1e-5 * f[0].force_N[1]);
                }
        }
        ck_assert_double_gt(f[0].force_N[1], 1.0);
    }
    palp_hull_free(hull);
}
END_TEST

/* Half way between two orientations, and by the shorter way. */
START_TEST(turns_by_the_shorter_way) {
    palp_tool was = {.orientation = {1, 0, 0, 0}}, is = {.orientation = {0}}, half = {.orientation = {0}};
    double q[4] = {0.0};
    turn_tool(&is, UP, 1.0);
    turn_tool(&half, UP, 0.5);
    for (int sign = 1; sign >= -1; sign -= 2) {
        for (int k = 0; k < 4; k++)
            is.orientation[k] *= sign;
        contact_turn_between(&was, &is, 0.5, q);
        for (int k = 0; k < 4; k++)
            ck_assert_double_eq_tol(q[k], half.orientation[k], 1e-15);
        is.shape = PALP_TOOL_SPHERE;
        is.radius_m = 2.0;
        ck_assert_double_eq_tol(contact_turned(&was, &is), 2.0, 1e-14);
    }
}
END_TEST

/* ---- all turned, and in other units ----------------------------------------------------------------- */

static void times_matrix(const double r[9], const double *v, double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = dot3(r + 3 * k, v);
}

/* The forces of a box on its edge that drags and a sphere that spins, on a block of this size and stiffness.
 */
static void feel(const double r[9], const double q[4], double size, double stiffness,
                 palp_tool_force felt[2]) {
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}};
    const palp_contact_settings touch = palp_contact_settings_default();
    palp_network_settings settings = palp_network_settings_default();
    const double origin[3] = {0}, sides[3] = {24 * size, 24 * size, 24 * size};
    palp_material m = {.n_arms = 0};
    palp_hull *hull = box_hull(3 * size, 2 * size, 5 * size);
    palp_mesh *mesh;
    palp_network *net;
    settings.tolerance = 1e-13;
    ck_assert_int_eq(palp_law_polynomial(1, (double[]){stiffness}, &m.law), PALP_OK);
    ck_assert_int_eq(palp_mesh_lattice((size_t[]){5, 5, 5}, sides, PALP_NEIGHBOURS_26, &mesh), PALP_OK);
    ck_assert_int_eq(palp_mesh_transform(mesh, r, origin), PALP_OK);
    ck_assert_int_eq(palp_network_create(mesh, &m, 1, &bottom, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(net, 2, 0, &touch), PALP_OK);
    for (int i = 0; i < 6; i++) {
        palp_tool tool[2] = {hull_tool(hull, 0, 0, 0, 1 * size, 0.4), sphere(0, 0, 0, 4 * size, 0.3)};
        const double at[2][3] = {{(8 + 0.2 * i) * size, (27.3 - 0.3 * i) * size, 9 * size},
                                 {17 * size, (28.1 - 0.2 * i) * size, 16 * size}};
        turn_tool(&tool[0], (const double[]){0.6, 0.0, 0.8}, 0.3 + 0.05 * i);
        turn_tool(&tool[1], (const double[]){0.8, 0.6, 0.0}, 0.1 * i);
        for (int k = 0; k < 2; k++) {
            const double angle = 2.0 * acos(q[0]), s = sin(0.5 * angle),
                         axis[3] = {q[1] / s, q[2] / s, q[3] / s};
            if (s > 0.0)
                turn_tool(&tool[k], axis, angle);
            times_matrix(r, at[k], tool[k].position_m);
        }
        ck_assert_int_eq(palp_network_set_tools(net, 2, tool), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, 0.0, INFINITY, NULL), PALP_OK);
    }
    ck_assert_int_eq(palp_network_tool_force(net, felt), PALP_OK);
    palp_network_free(net);
    palp_mesh_free(mesh);
    palp_hull_free(hull);
}

START_TEST(all_turned_or_in_other_units) {
    static const double one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, none[4] = {1, 0, 0, 0};
    const double q[4] = {0.5, 0.1, -0.7, 0.5}, w = q[0], x = q[1], y = q[2], z = q[3];
    const double turned[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                              2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                              2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    palp_tool_force here[2], there[2], larger[2];
    feel(one, none, 1e-3, 1.0, here);
    feel(turned, q, 1e-3, 1.0, there);
    feel(one, none, 3.7, 5e4, larger);
    for (int k = 0; k < 2; k++) {
        double force[3], moment[3];
        times_matrix(turned, here[k].force_N, force);
        times_matrix(turned, here[k].moment_Nm, moment);
        ck_assert_double_gt(sqrt(dot3(force, force)), 0.01);
        ck_assert_uint_eq(there[k].contacts, here[k].contacts);
        for (int i = 0; i < 3; i++) {
            ck_assert_double_eq_tol(there[k].force_N[i], force[i], 1e-9);
            ck_assert_double_eq_tol(there[k].moment_Nm[i], moment[i], 1e-11);
            ck_assert_double_eq_tol(larger[k].force_N[i] / 5e4, here[k].force_N[i], 1e-9);
            ck_assert_double_eq_tol(larger[k].moment_Nm[i] / 3.7e3 / 5e4, here[k].moment_Nm[i], 1e-11);
        }
    }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, spin_drags_the_surface, 0, 3);
    tcase_add_test(tc, a_plane_twists);
    tcase_add_test(tc, turned_in_many_steps_or_few);
    tcase_add_test(tc, turns_by_the_shorter_way);
    tcase_add_test(tc, all_turned_or_in_other_units);
}
