/* test_realtime_relaxation.c: a sphere on a network that relaxes, ramp and dwell, by steps and by realtime
 * ticks. While contact grows or stays, the force is the elastic one in the convolution of the relaxation
 * function (Lee and Radok 1960). */
#include <palpate/realtime.h>
#include <palpate/tool.h>

#include <check.h>
#include <math.h>

enum { RAMP = 40, DWELL = 40, STEPS = RAMP + DWELL, NODES = 5 };
static const double TOLERANCE = 0.004; /* of the peak: contact grows in steps */
static const double SIDE = 0.024, RADIUS = 0.006, DEPTH = 0.0015, TIME = 0.6,
                    ARM = 1.5; /* s; of the spring */

static double step_of(int i) {
    return i < RAMP ? 1.0 / RAMP : 0.05;
}

static double depth_of(int i) {
    return DEPTH * fmin(i + 1, RAMP) / RAMP;
}

static palp_network *network(double cubic, const palp_contact_settings *contact) {
    const size_t nodes[3] = {NODES, NODES, NODES};
    const double size[3] = {SIDE, SIDE, SIDE}, c[3] = {8, 0, cubic};
    static const palp_support floor = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0}};
    const palp_network_settings settings = palp_network_settings_default();
    palp_material m = {.n_arms = 1, .quasi_linear = cubic != 0};
    palp_mesh *mesh;
    palp_network *net;
    ck_assert_int_eq(palp_law_polynomial(3, c, &m.law), PALP_OK);
    m.arms[0] = (palp_arm){ARM * 8, ARM * 8 * TIME, 0, 0};
    ck_assert_int_eq(palp_mesh_lattice(nodes, size, PALP_NEIGHBOURS_26, &mesh), PALP_OK);
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, SIDE * SIDE, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_create(mesh, &m, 1, &floor, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(net, 1, 0, contact), PALP_OK);
    palp_mesh_free(mesh);
    return net;
}

static double press(palp_network *net, palp_realtime *ticks, int i, bool relaxed) {
    const palp_budget budget = {.force_error = 1e-5};
    const palp_tool tool = {.shape = PALP_TOOL_SPHERE,
                            .position_m = {SIDE / 2, SIDE + RADIUS - depth_of(i), SIDE / 2},
                            .radius_m = RADIUS};
    double dt = relaxed ? INFINITY : step_of(i);
    palp_tool_force felt;
    palp_tick_info info;
    ck_assert_int_eq(palp_network_set_tools(net, 1, &tool), PALP_OK);
    if (ticks)
        ck_assert_int_eq(palp_realtime_step(ticks, 0, dt, &budget, &info), PALP_OK);
    else
        ck_assert_int_eq(palp_network_step(net, 0, dt, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_tool_force(net, &felt), PALP_OK);
    return felt.force_N[1];
}

static void compare(double cubic, size_t subdivisions) {
    palp_contact_settings contact = palp_contact_settings_default();
    contact.subdivisions = subdivisions;
    double elastic[STEPS], wanted[STEPS], arm = 0, was = 0, peak = 0;
    palp_network *net = network(cubic, &contact);
    for (int i = 0; i < STEPS; i++)
        elastic[i] = i < RAMP ? press(net, NULL, i, true) : elastic[RAMP - 1];
    for (int i = 0; i < STEPS; i++) {
        double fade = exp(-step_of(i) / TIME);
        arm = arm * fade + ARM * (elastic[i] - was) * TIME / step_of(i) * (1 - fade);
        was = elastic[i];
        wanted[i] = elastic[i] + arm;
        peak = fmax(peak, wanted[i]);
    }
    palp_network_reset(net);
    for (int i = 0; i < STEPS; i++) {
        double got = press(net, NULL, i, false);
        ck_assert_msg(fabs(got - wanted[i]) <= TOLERANCE * peak, "force %d is %.5g, not %.5g of %.5g", i, got,
                      wanted[i], peak);
    }
    ck_assert_msg(peak > 1.5 * elastic[STEPS - 1] && arm < 0.1 * peak, "nothing relaxes");
    palp_network_free(net);
}

START_TEST(a_linear_law) {
    compare(0, 0);
    compare(0, 2);
}
END_TEST

START_TEST(a_nonlinear_law_with_quasi_linear_arms) {
    compare(60, 0);
    compare(60, 2);
}
END_TEST

START_TEST(ticks_are_as_steps) {
    const palp_realtime_settings settings = palp_realtime_settings_default();
    const palp_contact_settings contact = palp_contact_settings_default();
    palp_network *net = network(60, &contact), *other = network(60, &contact);
    palp_realtime *ticks;
    double step[STEPS], tick[STEPS], peak = 0;
    ck_assert_int_eq(palp_realtime_create(other, &settings, &ticks), PALP_OK);
    for (int i = 0; i < STEPS; i++) {
        step[i] = press(net, NULL, i, false);
        tick[i] = press(other, ticks, i, false);
        peak = fmax(peak, step[i]);
    }
    for (int i = 0; i < STEPS; i++)
        ck_assert_msg(fabs(tick[i] - step[i]) <= 1e-3 * peak, "tick %d: %.6g, not %.6g of %.6g", i, tick[i],
                      step[i], peak);
    ck_assert_msg(peak > 1.2 * step[STEPS - 1], "nothing relaxes");
    palp_realtime_free(ticks);
    palp_network_free(net);
    palp_network_free(other);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, a_linear_law);
    tcase_add_test(tc, a_nonlinear_law_with_quasi_linear_arms);
    tcase_add_test(tc, ticks_are_as_steps);
}
