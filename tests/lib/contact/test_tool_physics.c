/* test_tool_physics.c: tools against the balance of energy, Coulomb's law, the plate's force, Hertz's
 * exponent. */
#include "tool_make.h"

/* ---- energy -------------------------------------------------------------------------------------- */

/* Work of the hand that leads a smooth tool down, along and back, over the work of going down. */
static double loop_work(palp_tool tool, int steps) {
    static const double corner[5][2] = {{0, 0}, {0, -0.0018}, {0.0021, -0.0012}, {0.0013, -0.0006}, {0, 0}};
    palp_material m = quartic(0);
    palp_network *net = block(5, &m, 0.0, NULL);
    palp_tool_force before = step(net, &tool, INFINITY);
    const double start[2] = {tool.position_m[0], tool.position_m[1]};
    double work = 0.0, down = 0.0;
    for (int leg = 0; leg < 4; leg++)
        for (int i = 1; i <= steps; i++) {
            double was[2] = {tool.position_m[0], tool.position_m[1]}, share = (double)i / steps;
            for (int k = 0; k < 2; k++)
                tool.position_m[k] = start[k] + (1.0 - share) * corner[leg][k] + share * corner[leg + 1][k];
            palp_tool_force now = step(net, &tool, INFINITY);
            for (int k = 0; k < 2; k++)
                work -= 0.5 * (before.force_N[k] + now.force_N[k]) * (tool.position_m[k] - was[k]);
            before = now;
            down = leg == 0 ? work : down;
        }
    palp_network_free(net);
    ck_assert_double_gt(down, 1e-5);
    return work / down;
}

START_TEST(smooth_contact_does_no_work_on_a_closed_path) {
    const palp_tool tools[] = {sphere(0.0101, HEIGHT, 0.0117, 0.005, 0), plane(HEIGHT, 0),
                               capsule(0.0081, HEIGHT, 0.0088, 0.004, 0)};
    for (int i = 0; i < 3; i++) {
        double coarse = fabs(loop_work(tools[i], 15)), fine = fabs(loop_work(tools[i], 60));
        if (tools[i].shape ==
            PALP_TOOL_CAPSULE) { /* drawn to the middle of triangles it is not quite the nearest */
            ck_assert_double_lt(fine, 5e-3);
            continue;
        }
        ck_assert_double_lt(fine, 1e-3);
        ck_assert_double_lt(fine, fmax(0.5 * coarse, 1e-6));
    }
}
END_TEST

START_TEST(friction_takes_work_on_a_closed_path) {
    ck_assert_double_gt(loop_work(sphere(0.0101, HEIGHT, 0.0117, 0.005, 0.4), 30), 0.05);
}
END_TEST

/* ---- friction ------------------------------------------------------------------------------------ */

static double along_ground(const double f[3]) {
    return hypot(f[0], f[2]);
}

START_TEST(coulomb_stick_and_slip) {
    const double mu = 0.25;
    palp_material m = quartic(0);
    palp_network *net = block(5, &m, 0.0, NULL);
    palp_tool tool = plane(HEIGHT - 5e-4, mu);
    palp_tool_force f = step(net, &tool, INFINITY);
    double last = 0.0;
    int stuck = 0, slipping = 0;
    for (int i = 0; i < 60; i++) {
        tool.position_m[0] += 2e-5;
        f = step(net, &tool, INFINITY);
        double share = along_ground(f.force_N) / f.force_N[1];
        ck_assert_double_le(share, mu * (1.0 + 1e-9));
        ck_assert_double_le(f.force_N[0], 1e-9); /* the tissue holds the tool back */
        stuck += share < 0.9 * mu && share > last;
        slipping += share > mu * (1.0 - 1e-6);
        last = share;
    }
    ck_assert_int_ge(stuck, 5);
    ck_assert_int_ge(slipping, 10);
    /* turned round, it first sticks, then slips the other way */
    for (int i = 0; i < 60; i++) {
        tool.position_m[0] -= 4e-5;
        f = step(net, &tool, INFINITY);
        ck_assert_double_le(along_ground(f.force_N), mu * f.force_N[1] * (1.0 + 1e-9));
    }
    ck_assert_double_eq_tol(f.force_N[0], mu * f.force_N[1], 1e-6 * f.force_N[1]);
    palp_network_free(net);
}
END_TEST

/* Dragged over a node's length after another, so that the bumps of the lattice cancel. */
START_TEST(friction_holds_a_sphere_back) {
    static const double mu[] = {0.0, 0.2, 0.4};
    palp_material m = quartic(0);
    for (int k = 0; k < 3; k++) {
        palp_network *net = block(7, &m, 0.0, NULL);
        palp_tool tool = sphere(0.008, HEIGHT - 1e-3, 0.012, 0.006, mu[k]);
        double drag = 0.0, lift = 0.0;
        step(net, &tool, INFINITY);
        for (int i = 1; i <= 40; i++) {
            tool.position_m[0] += 2e-4;
            palp_tool_force f = step(net, &tool, INFINITY);
            drag -= i > 20 ? f.force_N[0] : 0.0; /* 20 steps are an edge */
            lift += i > 20 ? f.force_N[1] : 0.0;
        }
        ck_assert_double_eq_tol(drag / lift, mu[k], 0.1 * mu[k] + 0.02);
        palp_network_free(net);
    }
    /* a little push only: it sticks, and is pulled back as by an elastic block */
    palp_network *net = block(7, &m, 0.0, NULL);
    palp_tool tool = sphere(0.008, HEIGHT - 1e-3, 0.012, 0.006, 5.0);
    double pull[3];
    for (int i = 0; i < 3; i++) {
        pull[i] = -step(net, &tool, INFINITY).force_N[0];
        tool.position_m[0] += 5e-5;
    }
    ck_assert_double_gt(pull[1] - pull[0], 1e-3);
    ck_assert_double_eq_tol(pull[2] - pull[0], 2.0 * (pull[1] - pull[0]), 0.2 * (pull[2] - pull[0]));
    palp_network_free(net);
}
END_TEST

/* A smooth sphere pressed deep and dragged: tissue slides off it and snaps, and each step ends in an
 * equilibrium. */
START_TEST(snaps_off_a_small_tool) {
    palp_material m = quartic(1);
    palp_contact_settings triangles = palp_contact_settings_default();
    triangles.local = false; /* points that give way do not let it snap */
    palp_network *net = block(7, &m, 0.0, &triangles);
    palp_tool tool = sphere(0.0123, HEIGHT, 0.0117, 0.002, 0);
    double reaction[3], stable, unstable;
    net->settings.branch = PALP_BRANCH_CONTINUE;
    for (int i = 0; i < 60; i++) {
        tool.position_m[i < 30 ? 1 : 0] += i < 30 ? -1e-4 : 1e-4;
        palp_tool_force f = step(net, &tool, 1e-3);
        ck_assert_int_eq(palp_network_reaction(net, "bottom", reaction), PALP_OK);
        for (int k = 0; k < 3; k++)
            ck_assert_double_eq_tol(f.force_N[k], -reaction[k], 1e-8);
    }
    ck_assert(palp_network_buckled(net, &stable, &unstable)); /* it did snap */
    palp_network_free(net);
}
END_TEST

/* ---- what others say ----------------------------------------------------------------------------- */

/* A rough plane is a plate that holds the top: the stiffer the penalty, the nearer to the driven plate's
 * force. */
START_TEST(rough_plane_is_the_driven_plate) {
    palp_material m = quartic(0);
    palp_network *plate = cube_network(5, &m, NULL);
    double error[3], want;
    for (int i = 1; i <= 10; i++)
        ck_assert_int_eq(palp_network_step(plate, 0.01 * i * HEIGHT, INFINITY, NULL), PALP_OK);
    want = palp_network_force(plate);
    ck_assert_double_eq_tol(want, 2.551424, 1e-6); /* of two other solvers */
    for (int k = 0; k < 3; k++) {
        palp_contact_settings penalty = palp_contact_settings_default();
        penalty.stiffness = k == 0 ? 20.0 : k == 1 ? 200.0 : 2000.0;
        penalty.smoothing = 0.01 * 20.0 / penalty.stiffness;
        palp_network *net = block(5, &m, 0.0, &penalty);
        palp_tool tool = plane(HEIGHT, 50.0);
        palp_tool_force f = step(net, &tool, INFINITY);
        for (int i = 1; i <= 10; i++) {
            tool.position_m[1] = HEIGHT - 0.01 * i * HEIGHT;
            f = step(net, &tool, INFINITY);
        }
        error[k] = fabs(f.force_N[1] - want) / want;
        ck_assert_uint_eq(f.contacts, 25);
        palp_network_free(net);
    }
    ck_assert_double_lt(error[0], 0.05);
    ck_assert_double_lt(error[1], 0.2 * error[0]);
    ck_assert_double_lt(error[2], 0.2 * error[1]);
    ck_assert_double_lt(error[2], 1e-3);
    palp_network_free(plate);
}
END_TEST

/* Pressed and then tilted about a point beside the block, it carries the top with it as one body. */
START_TEST(rough_plane_tilts_with_what_it_holds) {
    enum { PRESS = 5, TILT = 5 };
    const double pivot[3] = {0.012, HEIGHT, -0.02};
    palp_material m = quartic(0);
    palp_contact_settings penalty = palp_contact_settings_default();
    penalty.stiffness = penalty.grasp_stiffness = 1e4;
    penalty.smoothing = 1e-5;
    palp_network *pressed = block(5, &m, 0.0, &penalty), *held = block(5, &m, 0.0, &penalty);
    palp_tool tool = {PALP_TOOL_PLANE, {0, 0, 0}, {0, -1, 0}, 0, 0, 100.0, {0}, NULL};
    const int32_t *top;
    size_t n;
    double target[75], hand[3];
    palp_tool_force f = {.contacts = 0};
    ck_assert_int_eq(palp_mesh_set(held->mesh, "top", &n, &top), PALP_OK);
    for (int i = 0; i <= PRESS + TILT; i++) {
        double down = 2e-4 * (i < PRESS ? i : PRESS), angle = i > PRESS ? 0.01 * (i - PRESS) : 0.0;
        double c = cos(angle), s = sin(angle);
        memcpy(tool.position_m, pivot, sizeof pivot);
        tool.position_m[1] -= down;
        tool.axis[1] = -c; /* turned about x */
        tool.axis[2] = -s;
        f = step(pressed, &tool, INFINITY);
        for (size_t j = 0; j < n; j++) {
            const double *x = held->rest + 3 * top[j];
            double y = x[1] - pivot[1], z = x[2] - pivot[2];
            target[3 * j] = x[0];
            target[3 * j + 1] = pivot[1] - down + c * y - s * z;
            target[3 * j + 2] = pivot[2] + s * y + c * z;
        }
        ck_assert_int_eq(palp_network_grasp(held, n, top, target), PALP_OK);
        ck_assert_int_eq(palp_network_step(held, 0.0, INFINITY, NULL), PALP_OK);
    }
    ck_assert_int_eq(palp_network_grasp_force(held, n, top, hand), PALP_OK);
    ck_assert_uint_eq(f.contacts, 25);
    ck_assert_double_gt(fabs(hand[2]), 0.01 * hand[1]);
    for (int k = 0; k < 3; k++)
        ck_assert_double_eq_tol(f.force_N[k], hand[k], 2e-3 * hand[1]);
    palp_network_free(pressed);
    palp_network_free(held);
}
END_TEST

/* Hertz 1882: force as depth^1.5, while the contact is wide beside the mesh and narrow beside the block. */
START_TEST(sphere_force_grows_as_hertz_says) {
    enum { N = 4 };
    palp_material m = linear();
    palp_contact_settings penalty = palp_contact_settings_default();
    penalty.stiffness = 200.0;
    penalty.smoothing = 1e-3;
    palp_network *net = block(13, &m, 0.0, &penalty);
    double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
    for (int i = 0; i < N; i++) {
        double depth = 4e-4 * pow(4.0, (double)i / (N - 1));
        palp_tool tool = sphere(0.012, HEIGHT - depth, 0.012, 0.030, 0);
        double x = log(depth), y = log(step(net, &tool, INFINITY).force_N[1]);
        sx += x, sy += y, sxx += x * x, sxy += x * y;
    }
    ck_assert_double_eq_tol((N * sxy - sx * sy) / (N * sxx - sx * sx), 1.5, 0.15);
    palp_network_free(net);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, smooth_contact_does_no_work_on_a_closed_path);
    tcase_add_test(tc, friction_takes_work_on_a_closed_path);
    tcase_add_test(tc, coulomb_stick_and_slip);
    tcase_add_test(tc, friction_holds_a_sphere_back);
    tcase_add_test(tc, snaps_off_a_small_tool);
    tcase_add_test(tc, rough_plane_is_the_driven_plate);
    tcase_add_test(tc, rough_plane_tilts_with_what_it_holds);
    tcase_add_test(tc, sphere_force_grows_as_hertz_says);
}
