/* test_network_run_mass.c: networks with mass that follow a path: ringing, energy, and the orders of the
 * integrators. */
#include "network_run_make.h"

static const palp_integrator INTEGRATORS[] = {PALP_BACKWARD_EULER, PALP_GENERALIZED_ALPHA};

/* A 1 s ramp stops with a jolt of the plate's 4.8 mm/s. Against the massless network: within 1 % of the force
 * at once, and with backward Euler nothing left after 100 ms, without an arm that would damp it. */
START_TEST(ramps_do_not_ring) {
    static const double steps[] = {1e-3, 1e-2};
    for (size_t s = 0; s < 2; s++)
        for (size_t k = 0; k < 2; k++) {
            palp_material m = quartic(0);
            palp_network *net = heavy(0, INTEGRATORS[k]), *massless = cube_network(3, &m, NULL);
            int n = (int)lround(1.0 / steps[s]);
            double late = 0.0, force = 0.0;
            for (int i = 1; i <= n + n / 2; i++) {
                double depth = 0.2 * HEIGHT * fmin(1.0, (double)i / n);
                ck_assert_int_eq(palp_network_step(net, depth, steps[s], NULL), PALP_OK);
                ck_assert_int_eq(palp_network_step(massless, depth, steps[s], NULL), PALP_OK);
                force = palp_network_force(massless);
                double off = fabs(palp_network_force(net) - force);
                if (i >= n)
                    ck_assert_double_lt(off, 0.01 * force);
                if (i > n + n / 10)
                    late = fmax(late, off);
            }
            ck_assert_double_lt(late, (k == 0 ? 1e-6 : 2.5e-3) * force);
            ck_assert_double_eq_tol(palp_network_force(net), force, (k == 0 ? 1e-9 : 2e-3) * force);
            palp_network_free(net);
            palp_network_free(massless);
        }
}
END_TEST

/* Of motion and of the springs, J. */
static double total_energy(const palp_network *net) {
    double sum = 0.0;
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0)
            sum += 0.5 * net->mass[i / 3] * net->now.velocity[i] * net->now.velocity[i];
    for (size_t i = 0; i < net->n_elements; i++) {
        double force, energy;
        palp_law_force(&net->material.law, 1, &net->now.history.strain[i], &force, NULL, &energy);
        sum += energy / net->inverse_rest[i];
    }
    return sum;
}

/* Pressed, let back a little at once, and then left to swing with the plate at rest. Backward Euler loses
 * energy in every step; generalized alpha only on the whole, so that none above the first is asked. */
START_TEST(free_vibration_gains_no_energy) {
    static const double steps[] = {1e-4, 1e-3, 1e-2};
    for (size_t s = 0; s < 3; s++)
        for (size_t k = 0; k < 2; k++) {
            palp_network *net = heavy(0, INTEGRATORS[k]), *still = heavy(0, PALP_BACKWARD_EULER);
            ck_assert_int_eq(palp_network_step(still, 0.19 * HEIGHT, INFINITY, NULL), PALP_OK);
            ck_assert_int_eq(palp_network_step(net, 0.2 * HEIGHT, INFINITY, NULL), PALP_OK);
            ck_assert_int_eq(palp_network_step(net, 0.19 * HEIGHT, steps[s], NULL), PALP_OK);
            double least = total_energy(still), first = total_energy(net) - least, before = first;
            ck_assert_double_gt(first, 1e-7);
            for (int i = 0; i < 300; i++) {
                ck_assert_int_eq(palp_network_step(net, 0.19 * HEIGHT, steps[s], NULL), PALP_OK);
                double energy = total_energy(net) - least;
                ck_assert_double_le(energy, (k == 0 ? before : first) + 1e-9 * first);
                before = energy;
            }
            ck_assert_double_lt(before, (s == 0 ? 1.0 : k == 0 ? 1e-8 : 0.5) * first);
            palp_network_free(net);
            palp_network_free(still);
        }
}
END_TEST

/* A pulse of the plate of 0.2 s; the forces at 15 instants in steps of 0.15 s / n. */
static void pulse(palp_integrator integrator, double radius, int n, double force[15]) {
    palp_network *net = heavy_on(1, integrator, PALP_BRANCH_CONTINUE, radius);
    for (int i = 1; i <= n; i++) {
        double s = sin(acos(-1.0) * 0.75 * i / n);
        ck_assert_int_eq(palp_network_step(net, 0.2 * HEIGHT * s * s * s * s, 0.15 / n, NULL), PALP_OK);
        if (i % (n / 15) == 0)
            force[i / (n / 15) - 1] = palp_network_force(net);
    }
    palp_network_free(net);
}

static double largest_difference(const double a[15], const double b[15]) {
    double worst = 0.0;
    for (int i = 0; i < 15; i++)
        worst = fmax(worst, fabs(a[i] - b[i]));
    return worst;
}

START_TEST(orders_of_the_integrators) {
    static const double radius[] = {0.0, 0.5, 0.8};
    double want[15], coarse[15], fine[15], ratio;
    pulse(PALP_GENERALIZED_ALPHA, 1.0, 3840, want);
    pulse(PALP_BACKWARD_EULER, 0.5, 60, coarse);
    pulse(PALP_BACKWARD_EULER, 0.5, 120, fine);
    ratio = largest_difference(coarse, want) / largest_difference(fine, want);
    ck_assert_msg(ratio > 1.8 && ratio < 2.2, "backward Euler: %g", ratio);
    for (size_t k = 0; k < 3; k++) {
        pulse(PALP_GENERALIZED_ALPHA, radius[k], k ? 480 : 960, coarse);
        pulse(PALP_GENERALIZED_ALPHA, radius[k], k ? 960 : 1920, fine);
        ratio = largest_difference(coarse, want) / largest_difference(fine, want);
        ck_assert_msg(ratio > 3.6 && ratio < 5.0, "generalized alpha, radius %g: %g", radius[k], ratio);
    }
}
END_TEST

/* Mass over dt squared grows beyond what positions resolve: the step must still be found. */
START_TEST(short_steps_with_mass) {
    for (int branch = 0; branch < 2; branch++)
        for (size_t k = 0; k < 2; k++)
            for (double dt = 1e-3; dt > 5e-9; dt *= 0.1) {
                palp_network *net =
                    heavy_on(1, INTEGRATORS[k], branch ? PALP_BRANCH_STABLE : PALP_BRANCH_CONTINUE, 0.5);
                for (int i = 1; i <= 5; i++) {
                    palp_status status = palp_network_step(net, HEIGHT * dt * i, dt, NULL);
                    ck_assert_msg(!status, "branch %d, dt %g, step %d: %s", branch, dt, i,
                                  palp_status_name(status));
                }
                palp_network_free(net);
            }
}
END_TEST

START_TEST(controlled_steps_with_mass) {
    for (size_t k = 0; k < 2; k++) {
        palp_material m = quartic(1);
        palp_network *net = heavy(1, INTEGRATORS[k]), *massless = cube_network(3, &m, NULL);
        palp_run_settings settings = recording(0.0, 1e-4);
        run_path(net, ramp_hold(0.2, 1.0, 5.0), &settings);
        settings = recording(0.0, 1e-4);
        run_path(massless, ramp_hold(0.2, 1.0, 5.0), &settings);
        ck_assert_double_eq_tol(palp_network_force(net), palp_network_force(massless),
                                5e-3 * palp_network_force(massless));
        palp_network_free(net);
        palp_network_free(massless);
    }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, ramps_do_not_ring);
    tcase_add_test(tc, free_vibration_gains_no_energy);
    tcase_add_test(tc, orders_of_the_integrators);
    tcase_add_test(tc, short_steps_with_mass);
    tcase_add_test(tc, controlled_steps_with_mass);
}
