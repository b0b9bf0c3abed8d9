/* test_force_curve.c: the static force curve and its gradient against equilibria solved one by one. */
#include "fit/calibrate_internal.h"
#include "cube.h"

#include <string.h>

static palp_material with_coefficient(const palp_material *like, size_t k, double change) {
    palp_material material = *like;
    double c[PALP_LAW_MAX];
    memcpy(c, like->law.coefficients, sizeof c);
    c[k] += change;
    ck_assert_int_eq(palp_law_set_coefficients(&material.law, c), PALP_OK);
    return material;
}

/* Force at depth[n - 1] on the way over depth[n]. */
static double solved_force(palp_network *network, const palp_material *material, size_t n,
                           const double *depth) {
    ck_assert_int_eq(palp_network_set_material(network, material), PALP_OK);
    for (size_t i = 0; i < n; i++)
        ck_assert_int_eq(palp_network_step(network, depth[i], INFINITY, NULL), PALP_OK);
    return palp_network_force(network);
}

/* Central differences of forces solved to 1e-12 at changes of 1e-4 of the force: 1e-8 of rounding and as
 * much of truncation in what is compared, and the more the softer the tangent is. */
static void check_gradient(size_t nodes, const palp_material *material, double poisson) {
    enum { STEPS = 20, LOOKS = 3 };
    const size_t looked_at[LOOKS] = {2, 9, 18}; /* strain 0.06, 0.2 and 0.38, where the network has buckled */
    double depth[STEPS];
    palp_network_settings settings = palp_network_settings_default();
    force_curve curve = {0};
    settings.tolerance = 1e-12;
    settings.poisson_ratio = poisson;
    palp_network *network = cube_network(nodes, material, &settings);
    cube_depths(STEPS, 0.4 * CUBE_HEIGHT_M, depth);
    ck_assert_int_eq(force_curve_steps(&curve, network, STEPS, depth, true), PALP_OK);
    ck_assert(poisson > 0.0 || palp_network_buckled(network, &(double){0}, &(double){0}));
    for (size_t j = 0; j < LOOKS; j++) {
        size_t at = looked_at[j], n = material->law.n;
        const double force = curve.force[at];
        for (size_t k = 0; k < n; k++) {
            double g = curve.gradient[at * n + k];
            double h = material->law.kind == PALP_LAW_SPLINE ? 1e-4 * material->law.coefficients[k]
                                                             : 1e-4 * force / fmax(fabs(g), 1e-3 * force);
            palp_material up = with_coefficient(material, k, h), down = with_coefficient(material, k, -h);
            double difference =
                solved_force(network, &up, at + 1, depth) - solved_force(network, &down, at + 1, depth);
            ck_assert_double_eq_tol(g * h, 0.5 * difference, 2e-7 * 1e-4 * force + 1e-10 * force);
        }
        double before[STEPS], after[STEPS], h = 1e-6;
        memcpy(before, depth, sizeof before);
        memcpy(after, depth, sizeof after);
        before[at] -= h;
        after[at] += h;
        double slope = (solved_force(network, material, at + 1, after) -
                        solved_force(network, material, at + 1, before)) /
                       (2.0 * h);
        ck_assert_double_eq_tol(curve.slope[at], slope, 1e-6 * slope);
    }
    force_curve_free(&curve);
    palp_network_free(network);
}

START_TEST(gradient_against_differences) {
    palp_material polynomial = cube_polynomial(5, NETWORK_LAW), spline = cube_spline();
    for (size_t nodes = 3; nodes <= 5; nodes += 2) {
        check_gradient(nodes, &polynomial, 0.0);
        check_gradient(nodes, &spline, 0.0);
    }
    check_gradient(4, &polynomial, 0.4);
    check_gradient(4, &spline, 0.4);
}
END_TEST

/* The error is estimated from differences, so it is met nearly. No difference shows a spline's next knot. */
START_TEST(traced_curve_within_tolerance) {
    enum { N = 300 };
    double depth[N], force[N];
    palp_network_settings settings = palp_network_settings_default();
    palp_material materials[3] = {cube_polynomial(5, NETWORK_LAW), cube_polynomial(5, LUMPED_LAW),
                                  cube_spline()};
    cube_depths(N, CUBE_PRESS_M, depth);
    for (size_t k = 0; k < 6; k++) {
        const palp_material *material = &materials[k % 3];
        double allowed = material->law.kind == PALP_LAW_SPLINE ? 20.0 : 1.5;
        palp_network *network = cube_network(k < 3 ? 3 : 5, material, &settings);
        force_curve every = {0}, traced = {0};
        ck_assert_int_eq(force_curve_steps(&every, network, N, depth, false), PALP_OK);
        for (double tolerance = 1e-4; tolerance > 5e-7; tolerance *= 0.1) {
            ck_assert_int_eq(force_curve_trace(&traced, network, CUBE_PRESS_M, tolerance), PALP_OK);
            ck_assert_double_eq(traced.depth[traced.n - 1], CUBE_PRESS_M);
            ck_assert_uint_lt(traced.n, N / 4);
            force_curve_sample(&traced, N, depth, force, NULL);
            for (size_t i = 0; i < N; i++)
                ck_assert_double_eq_tol(force[i], every.force[i], allowed * tolerance * every.force[N - 1]);
        }
        force_curve_free(&every);
        force_curve_free(&traced);
        palp_network_free(network);
    }
}
END_TEST

/* The branch of 125 nodes of constant stiffness ends at strain 0.55: beyond, force and gradient stay. */
START_TEST(sampling_beyond_the_reach) {
    const double one = 1.0, depth[3] = {0.25 * CUBE_HEIGHT_M, 0.6 * CUBE_HEIGHT_M, 0.7 * CUBE_HEIGHT_M};
    double force[3], gradient[3];
    palp_network_settings settings = palp_network_settings_default();
    palp_material material = cube_polynomial(1, &one);
    palp_network *network = cube_network(5, &material, &settings);
    force_curve curve = {0};
    palp_status status = force_curve_trace(&curve, network, 0.7 * CUBE_HEIGHT_M, 1e-5);
    ck_assert(calibration_lost(status));
    double reached = curve.depth[curve.n - 1];
    ck_assert_double_gt(reached, 0.5 * CUBE_HEIGHT_M);
    ck_assert_double_lt(reached, depth[1]);
    force_curve_sample(&curve, 3, depth, force, gradient);
    ck_assert_double_eq_tol(force[0], solved_force(network, &material, 1, depth), 1e-4 * force[0]);
    for (size_t i = 0; i < 3; i++) /* force = coefficient times gradient, since both are 1 */
        ck_assert_double_eq_tol(gradient[i], force[i], (i ? 1e-9 : 1e-4) * force[i]);
    for (size_t i = 1; i < 3; i++)
        ck_assert_double_eq_tol(force[i], curve.force[curve.n - 1], 1e-12 * force[i]);
    force_curve_free(&curve);
    palp_network_free(network);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, gradient_against_differences);
    tcase_add_test(tc, traced_curve_within_tolerance);
    tcase_add_test(tc, sampling_beyond_the_reach);
}
