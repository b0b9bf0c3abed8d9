/* test_tool_hull.c: hulls on networks: beside a plane and a sphere, as jaws, after cuts, in saved states. */
#include "hull_make.h"
#include "tool_make.h"

#include <palpate/cut.h>

static palp_contact_settings touching(bool local, size_t subdivisions) {
    palp_contact_settings touch = palp_contact_settings_default();
    touch.local = local;
    touch.subdivisions = subdivisions;
    return touch;
}

/* ---- beside other shapes --------------------------------------------------------------------------- */

/* A box wider than the block. Its points between the nodes share the penalty, so that it is a little softer:
 * by 1.6 % at 5 nodes a side and 0.7 % at 7, rough by 2.1 % and 1.1 %. On a smooth surface its rim, which is
 * beside the block, still leaves a little local compliance. */
START_TEST(a_wide_box_is_a_plane) {
    palp_material m = linear();
    palp_hull *hull = box_hull(0.02, 0.004, 0.02);
    for (int kind = 0; kind < 6; kind++) {
        const bool smooth = kind >= 4;
        const size_t n = kind % 2 ? 7 : 5;
        const double friction = kind / 2 == 1 ? 10.0 : 0.0,
                     most = smooth ? 0.01 : (n == 5 ? 0.016 : 0.0075) + (friction > 0.0 ? 0.006 : 0.0);
        const palp_contact_settings touch = touching(true, smooth ? 2 : 0);
        palp_network *net[2] = {block(n, &m, 0.0, &touch), block(n, &m, 0.0, &touch)};
        for (int i = 1; i <= 4; i++) {
            const double y = HEIGHT - 5e-4 * i;
            const palp_tool box = hull_tool(hull, 0.012, y + 0.006, 0.012, 0.002, friction),
                            flat = plane(y, friction);
            const double force = step(net[1], &flat, INFINITY).force_N[1];
            ck_assert_double_eq_tol(step(net[0], &box, INFINITY).force_N[1], force, most * force);
        }
        palp_network_free(net[0]);
        palp_network_free(net[1]);
    }
    palp_hull_free(hull);
}
END_TEST

/* Almost a sphere, at 11 nodes a side: within 9 % of one that touches each triangle in its nearest point. */
START_TEST(a_tiny_hull_is_a_sphere) {
    palp_material m = linear();
    const double radius = 0.005, core = 1e-3 * radius;
    const palp_contact_settings touch = touching(false, 0);
    palp_hull *hull = box_hull(core, core, core);
    palp_network *net[2] = {block(11, &m, 0.0, &touch), block(11, &m, 0.0, &touch)};
    for (int i = 1; i <= 4; i++) {
        const palp_tool ball = sphere(0.0121, HEIGHT - 5e-4 * i, 0.0118, radius, 0.0),
                        box = hull_tool(hull, 0.0121, HEIGHT + radius - 5e-4 * i, 0.0118, radius, 0.0);
        const double force = step(net[1], &ball, INFINITY).force_N[1];
        ck_assert_double_eq_tol(step(net[0], &box, INFINITY).force_N[1], force, 0.09 * force);
    }
    palp_network_free(net[0]);
    palp_network_free(net[1]);
    palp_hull_free(hull);
}
END_TEST

static const double SHEAR = 5680.0; /* Pa */

/* A lattice scaled as a solid of this Poisson's ratio, with its law. */
static palp_network *solid_block(size_t n, double poisson, size_t subdivisions) {
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}};
    const palp_contact_settings touch = touching(true, subdivisions);
    palp_mesh *mesh = cube(n, PALP_NEIGHBOURS_26);
    palp_network_settings settings = palp_network_settings_default();
    palp_material m = {.n_arms = 0};
    palp_network *net = NULL;
    settings.poisson_ratio = poisson > 0.25 ? poisson : 0.0;
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, 0.0, NULL), PALP_OK);
    ck_assert_int_eq(palp_law_of_solid(mesh, poisson, 2.0 * (1.0 + poisson) * SHEAR, &m.law), PALP_OK);
    ck_assert_int_eq(palp_network_create(mesh, &m, 1, &bottom, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(net, 1, 0, &touch), PALP_OK);
    palp_mesh_free(mesh);
    return net;
}

/* A flat punch of 5 mm, pressed 1 mm, on a node and in mid-cell, its edge rounded by 0.5 mm. CalculiX
 * (data/tips/block.csv, the finer mesh, over the shear modulus and the cube's face) has a sharp edge. A punch
 * that is rounded by R outside the radius b has the contact radius b + e at the depth 0.943 sqrt(b) e^1.5 /
 * R. Its force is the integral of that of flat punches, so its radius is b + 0.6 e: 4.74 mm. */
START_TEST(flat_punch_is_that_of_a_solid) {
    static const double poisson[2] = {0.25, 0.45}, solid[2] = {0.047544192, 0.063259776}, edge = 5e-4,
                        rounding = 4.74 / 5.0;
    static const struct {
        size_t nodes;
        double least[2], most[2]; /* over the solid's force, on triangles and on a smooth surface */
    } bounds[3] = {
        {5, {0.86, 0.98}, {1.08, 1.22}}, {7, {0.92, 0.96}, {1.03, 1.09}}, {11, {0.94, 0.97}, {1.05, 1.07}}};
    palp_hull *hull = cylinder_hull(16, 1.013 * (5e-3 - edge), 4e-3); /* a circle's area */
    for (int b = 0; b < 3; b++)
        for (int k = 0; k < 8; k++) {
            const double nu = poisson[k / 2 % 2],
                         whole = solid[k / 2 % 2] * SHEAR * HEIGHT * HEIGHT * rounding,
                         at = 0.012 + (k % 2 ? 0.5 * HEIGHT / (double)(bounds[b].nodes - 1) : 0.0);
            palp_network *net = solid_block(bounds[b].nodes, nu, k < 4 ? 0 : 2);
            double force = 0.0;
            for (int i = 1; i <= 5; i++) {
                const palp_tool punch = hull_tool(hull, at, HEIGHT + 4e-3 + edge - 2e-4 * i, at, edge, 0.0);
                force = step(net, &punch, INFINITY).force_N[1];
            }
            const double ratio = force / whole;
            ck_assert_msg(ratio > bounds[b].least[k / 4] && ratio < bounds[b].most[k / 4],
                          "%zu nodes, case %d, Poisson's ratio %g: %g", bounds[b].nodes, k, nu, ratio);
            palp_network_free(net);
        }
    palp_hull_free(hull);
}
END_TEST

/* A blade 2 mm thick, its edges rounded by 0.5 mm, goes in by 3.5 mm in one step, 8 or 40. It penetrates the
 * tissue deeper than that rounding, which used to make the tissue snap off in 8 steps. */
START_TEST(tissue_stays_below_a_blade) {
    static const int steps[3] = {40, 8, 1};
    const palp_contact_settings touch = touching(true, 2);
    palp_material m = linear();
    palp_hull *hull = box_hull(0.0005, 0.004, 0.006);
    double force[3] = {0.0};
    for (int way = 0; way < 3; way++) {
        palp_network *net = block(7, &m, 0.0, &touch);
        palp_tool_force felt = {.contacts = 0};
        for (int i = 0; i <= steps[way]; i++) {
            const palp_tool blade =
                hull_tool(hull, 0.0121, HEIGHT + 0.0045 - 0.0035 * i / steps[way], 0.0118, 5e-4, 0.0);
            felt = step(net, &blade, INFINITY);
        }
        ck_assert_double_gt(felt.depth_m, 5e-4);
        force[way] = felt.force_N[1];
        palp_network_free(net);
    }
    ck_assert_double_gt(force[0], 2.0);
    for (int way = 1; way < 3; way++)
        ck_assert_double_eq_tol(force[way], force[0], 0.03 * force[0]);
    palp_hull_free(hull);
}
END_TEST

/* The same blade on either surface, 4 mm in 160 steps: it finds an equilibrium in each, and its force does
 * not jump, on a smooth surface by 0.1 N at most. */
START_TEST(a_blade_goes_in_by_small_steps) {
    enum { STEPS = 160 };
    const palp_contact_settings touch = touching(true, _i ? 2 : 0);
    palp_material m = linear();
    palp_hull *hull = box_hull(0.0005, 0.004, 0.006);
    palp_network *net = block(7, &m, 0.0, &touch);
    double before = 0.0;
    for (int i = 0; i <= STEPS; i++) {
        const palp_tool blade =
            hull_tool(hull, 0.0121, HEIGHT + 0.0045 - 0.004 * i / STEPS, 0.0118, 5e-4, 0.0);
        const double force = step(net, &blade, INFINITY).force_N[1];
        ck_assert_double_eq_tol(force, before, _i ? 0.15 : 0.05);
        before = force;
    }
    ck_assert_double_gt(before, 2.0);
    palp_network_free(net);
    palp_hull_free(hull);
}
END_TEST

/* However far a hull goes in a step, it is felt as one that went there slowly: a box, a blade and a wedge on
 * its edge, in one step, or in 8 that are not parted. */
START_TEST(far_in_one_step) {
    static const double wedge[6][3] = {{0, -0.004, -0.006}, {-0.003, 0.004, -0.006}, {0.003, 0.004, -0.006},
                                       {0, -0.004, 0.006},  {-0.003, 0.004, 0.006},  {0.003, 0.004, 0.006}};
    static const int steps[3] = {40, 8, 1};
    palp_material m = linear();
    palp_hull *hull[3] = {box_hull(0.003, 0.004, 0.002), box_hull(0.0005, 0.004, 0.006), NULL};
    ck_assert_int_eq(palp_hull_create(6, wedge[0], &hull[2], NULL), PALP_OK);
    for (int k = 0; k < 3; k++) {
        double force[3] = {0.0};
        for (int way = 0; way < 3; way++) {
            palp_network *net = block(7, &m, 0.0, NULL);
            palp_tool tool = hull_tool(hull[k], 0.0121, HEIGHT + 0.005, 0.0118, 0.001, 0.0);
            step(net, &tool, INFINITY);
            for (int i = 1; i <= steps[way]; i++) {
                tool.position_m[1] = HEIGHT + 0.005 - 0.004 * i / steps[way];
                force[way] = step(net, &tool, INFINITY).force_N[1];
            }
            palp_network_free(net);
        }
        ck_assert_double_gt(force[0], 1.0);
        ck_assert_double_eq_tol(force[1], force[0], 0.015 * force[0]);
        ck_assert_double_eq_tol(force[2], force[0], 3e-3 * force[0]);
        palp_hull_free(hull[k]);
    }
}
END_TEST

/* ---- balances -------------------------------------------------------------------------------------- */

START_TEST(forces_and_moments_balance) {
    palp_material m = linear();
    palp_hull *hull[2] = {box_hull(0.003, 0.002, 0.005), cylinder_hull(6, 0.004, 0.003)};
    for (size_t subdivisions = 0; subdivisions < 3; subdivisions += 2) {
        const palp_contact_settings touch = touching(true, subdivisions);
        palp_network *net = block(5, &m, 0.0, &touch);
        palp_tool tools[3] = {hull_tool(hull[0], 0.006, HEIGHT + 0.0035, 0.008, 0.001, 0.4),
                              hull_tool(hull[1], 0.017, HEIGHT + 0.004, 0.016, 0.0015, 0.3),
                              sphere(0.006, HEIGHT - 5e-4, 0.018, 0.004, 0.5)};
        double sum[6];
        turn_tool(&tools[0], (const double[]){0.8, 0.0, 0.6}, 0.2);
        for (int i = 0; i < 8; i++) {
            for (int k = 0; k < 3; k++) {
                tools[k].position_m[1] -= 2e-4;
                turn_tool(&tools[k], (const double[]){0.0, 0.28, 0.96}, 0.1);
            }
            ck_assert_int_eq(palp_network_set_tools(net, 3, tools), PALP_OK);
            ck_assert_int_eq(palp_network_step(net, 0.0, INFINITY, NULL), PALP_OK);
            balance(net, 3, tools, sum);
            for (int k = 0; k < 3; k++) {
                ck_assert_double_eq_tol(sum[k], 0.0, 1e-8);
                ck_assert_double_eq_tol(sum[3 + k], 0.0, 1e-10);
            }
        }
        palp_contact contacts[500];
        palp_tool_force felt[3];
        size_t n;
        ck_assert_int_eq(palp_network_contacts(net, 500, contacts, &n), PALP_OK);
        ck_assert_int_eq(palp_network_tool_force(net, felt), PALP_OK);
        for (size_t i = 0; i < n; i++)
            for (int k = 0; k < 3; k++)
                felt[contacts[i].tool].force_N[k] +=
                    contacts[i].normal_N * contacts[i].normal[k] + contacts[i].friction_N[k];
        for (int i = 0; i < 9; i++)
            ck_assert_double_eq_tol(felt[i / 3].force_N[i % 3], 0.0, 1e-12);
        for (int i = 0; i < 3; i++)
            ck_assert_msg(felt[i].contacts > 0, "tool %d, %zu subdivisions", i, subdivisions);
        palp_network_free(net);
    }
    palp_hull_free(hull[0]);
    palp_hull_free(hull[1]);
}
END_TEST

/* ---- jaws ------------------------------------------------------------------------------------------ */

/* A column, its top free, and two jaws that close on it by 1.5 mm a side and then lift by 2.5 mm. */
static double force_of_lift(double friction, palp_tool_force felt[2]) {
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}};
    const palp_contact_settings touch = palp_contact_settings_default();
    const palp_network_settings settings = palp_network_settings_default();
    const size_t nodes[3] = {5, 9, 5};
    const double size[3] = {0.012, 0.024, 0.012};
    palp_material m = linear();
    palp_hull *hull = box_hull(0.002, 0.004, 0.010);
    palp_mesh *mesh = NULL;
    palp_network *net = NULL;
    double reaction[3];
    ck_assert_int_eq(palp_mesh_lattice(nodes, size, PALP_NEIGHBOURS_26, &mesh), PALP_OK);
    ck_assert_int_eq(palp_network_create(mesh, &m, 1, &bottom, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(net, 2, 0, &touch), PALP_OK);
    palp_tool jaw[2] = {hull_tool(hull, -0.003, 0.020, 0.006, 0.001, friction),
                        hull_tool(hull, 0.015, 0.020, 0.006, 0.001, friction)};
    for (int i = 0; i < 20; i++) {
        for (int k = 0; k < 2; k++)
            jaw[k].position_m[i < 10 ? 0 : 1] += i < 10 ? (k ? -1.5e-4 : 1.5e-4) : 2.5e-4;
        ck_assert_int_eq(palp_network_set_tools(net, 2, jaw), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, 0.0, INFINITY, NULL), PALP_OK);
    }
    ck_assert_int_eq(palp_network_tool_force(net, felt), PALP_OK);
    ck_assert_int_eq(palp_network_reaction(net, "bottom", reaction), PALP_OK);
    ck_assert_double_eq_tol(reaction[1], -felt[0].force_N[1] - felt[1].force_N[1], 1e-8);
    palp_network_free(net);
    palp_mesh_free(mesh);
    palp_hull_free(hull);
    return reaction[1];
}

/* Rough jaws lift the tissue with a good part of what they may; smooth ones slide up it. */
START_TEST(jaws_lift_by_friction) {
    palp_tool_force felt[2];
    ck_assert_double_lt(force_of_lift(0.0, felt), 0.0);
    const double lift = force_of_lift(0.8, felt), squeeze = felt[1].force_N[0];
    ck_assert_double_eq_tol(felt[0].force_N[0], -squeeze, 1e-3 * squeeze);
    ck_assert_double_gt(lift, 0.4 * squeeze);
    ck_assert_double_lt(lift, 2.0 * 0.8 * squeeze);
    for (int k = 0; k < 2; k++)
        ck_assert_double_eq_tol(felt[k].force_N[1], -0.5 * lift, 0.01 * lift);
}
END_TEST

/* ---- cuts and states ------------------------------------------------------------------------------- */

START_TEST(follows_the_surface_of_a_cut) {
    palp_material m = quartic(0);
    const double side[2][9] = {{0.0118, 0.011, -0.01, 0.0118, 0.011, 0.03, 0.0118, 0.03, 0.03},
                               {0.0118, 0.011, -0.01, 0.0118, 0.03, 0.03, 0.0118, 0.03, -0.01}};
    palp_hull *hull = box_hull(0.003, 0.002, 0.003);
    palp_tool box = hull_tool(hull, 0.0121, HEIGHT + 0.003, 0.0118, 0.001, 0.2);
    double force[2], sum[6];
    for (int cut = 0; cut < 2; cut++) {
        palp_network *net = block(5, &m, 0.0, NULL);
        ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
        for (int i = 0; i < 2 && cut; i++)
            ck_assert_int_eq(palp_network_cut(net, side[i], NULL), PALP_OK);
        for (int i = 1; i <= 10; i++) {
            box.position_m[1] = HEIGHT + 0.003 - 1.5e-4 * i;
            force[cut] = step(net, &box, INFINITY).force_N[1];
        }
        balance(net, 1, &box, sum);
        for (int k = 0; k < 3; k++)
            ck_assert_double_eq_tol(sum[k], 0.0, 1e-8);
        palp_network_free(net);
    }
    ck_assert_double_lt(force[1], 0.9 * force[0]);
    ck_assert_double_gt(force[1], 0.1 * force[0]);
    palp_hull_free(hull);
}
END_TEST

static palp_tool dragged(const palp_hull *hull, int i) {
    palp_tool box = hull_tool(hull, 0.009 + 1e-4 * i, HEIGHT + 2e-3, 0.0117, 0.001, 0.4);
    turn_tool(&box, (const double[]){0, 1, 0}, 0.05 * i);
    return box;
}

static palp_tool_force drag(palp_network *net, const palp_hull *hull, int from, int to) {
    palp_tool_force f = {.contacts = 0};
    for (int i = from; i < to; i++) {
        const palp_tool box = dragged(hull, i);
        f = step(net, &box, 0.01);
    }
    return f;
}

/* Saved while a box drags, which then is freed; restored with another like it, it drags on as before. A
 * network that has no hull to restore has no contact, until its tools are set. */
START_TEST(restored_with_the_hull_of_the_present) {
    palp_material m = quartic(1);
    palp_network *net = block(5, &m, 0.0, NULL), *other = block(5, &m, 0.0, NULL);
    palp_hull *hull = box_hull(0.003, 0.002, 0.005), *like = box_hull(0.003, 0.002, 0.005);
    drag(net, hull, 0, 6);
    const size_t size = palp_network_state_size(net);
    void *state = malloc(size);
    ck_assert_int_eq(palp_network_save(net, state, size), PALP_OK);
    const palp_tool_force want = drag(net, hull, 6, 12);
    drag(net, like, 30, 33);
    palp_hull_free(hull);
    ck_assert_int_eq(palp_network_restore(net, state, size), PALP_OK);
    palp_tool_force got = drag(net, like, 6, 12);
    for (int k = 0; k < 3; k++)
        ck_assert_double_eq_tol(got.force_N[k], want.force_N[k], 1e-7);
    ck_assert_int_eq(palp_network_restore(other, state, size), PALP_OK);
    ck_assert_int_eq(palp_network_step(other, 0.0, INFINITY, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_tool_force(other, &got), PALP_OK);
    ck_assert_uint_eq(got.contacts, 0);
    ck_assert_int_eq(palp_network_restore(other, state, size), PALP_OK);
    got = drag(other, like, 6, 12);
    for (int k = 0; k < 3; k++)
        ck_assert_double_eq_tol(got.force_N[k], want.force_N[k], 1e-7);
    free(state);
    palp_network_free(net);
    palp_network_free(other);
    palp_hull_free(like);
}
END_TEST

/* ---- what is refused ------------------------------------------------------------------------------- */

START_TEST(refuses_what_makes_no_sense) {
    palp_material m = linear();
    palp_network *net = block(5, &m, 0.0, NULL);
    palp_hull *hull = box_hull(0.001, 0.001, 0.001);
    const palp_tool box = hull_tool(hull, 0.012, 0.011 + 0.3, 0.013, 0.001, 0.0);
    palp_tool wrong[6];
    for (int i = 0; i < 6; i++)
        wrong[i] = box;
    wrong[0].hull = NULL;
    wrong[1].radius_m = 0.0;
    wrong[2].orientation[0] = 1.0 + 2e-6;
    wrong[3].orientation[3] = 0.5;
    wrong[4].orientation[1] = NAN;
    wrong[5] = sphere(0.0, 1.0, 0.0, 0.001, 0.0);
    wrong[5].orientation[2] = 1e-7;
    for (int i = 0; i < 6; i++)
        ck_assert_int_eq(palp_network_set_tools(net, 1, &wrong[i]), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_set_tools(net, 1, &box), PALP_OK);
    palp_hull_free(hull);
    palp_network_free(net);
}
END_TEST

/* The middle of a hull decides, not the origin of its frame. */
START_TEST(begins_inside) {
    palp_material m = linear();
    palp_network *net = block(5, &m, 0.0, NULL);
    palp_hull *hull = NULL;
    double points[8][3];
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++)
            points[i][k] = (k == 1 ? 0.1 : 0.0) + (i >> k & 1 ? 5e-4 : -5e-4);
    ck_assert_int_eq(palp_hull_create(8, points[0], &hull, NULL), PALP_OK);
    for (int turned = 0; turned < 2; turned++) {
        const double down = turned ? 0.1 : -0.1;
        palp_tool box = hull_tool(hull, 0.012, 0.011 + down, 0.013, 5e-4, 0.0);
        if (turned)
            turn_tool(&box, (const double[]){1, 0, 0}, acos(-1.0));
        palp_network_reset(net);
        ck_assert_int_eq(palp_network_set_tools(net, 1, &box), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, 0.0, INFINITY, NULL), PALP_ERR_INSIDE);
        box.position_m[1] = 0.011;
        ck_assert_int_eq(palp_network_set_tools(net, 1, &box), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, 0.0, INFINITY, NULL), PALP_OK);
    }
    palp_hull_free(hull);
    palp_network_free(net);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, a_wide_box_is_a_plane);
    tcase_add_test(tc, a_tiny_hull_is_a_sphere);
    tcase_add_test(tc, flat_punch_is_that_of_a_solid);
    tcase_add_test(tc, tissue_stays_below_a_blade);
    tcase_add_loop_test(tc, a_blade_goes_in_by_small_steps, 0, 2);
    tcase_add_test(tc, far_in_one_step);
    tcase_add_test(tc, forces_and_moments_balance);
    tcase_add_test(tc, jaws_lift_by_friction);
    tcase_add_test(tc, follows_the_surface_of_a_cut);
    tcase_add_test(tc, restored_with_the_hull_of_the_present);
    tcase_add_test(tc, refuses_what_makes_no_sense);
    tcase_add_test(tc, begins_inside);
}
