/* test_network_range.c: a network whose elements go beyond the strain that their law was measured to. */
#include "network_make.h"

#include <palpate/realtime.h>

enum { STEPS = 30 };

static palp_material limited(double strain_max, double factor) {
    palp_material m = quartic(0);
    ck_assert_int_eq(palp_law_scale(&m.law, factor, &m.law), PALP_OK);
    ck_assert_int_eq(palp_law_limit(&m.law, strain_max), PALP_OK);
    return m;
}

START_TEST(steps_and_runs_tell_how_far_beyond) {
    palp_material m = limited(0.15, 1.0);
    palp_network *net = cube_network(3, &m, NULL);
    palp_step_info info;
    palp_path path;
    palp_run_info run;
    const palp_run_settings settings = {.relaxed = true, .dt_s = 0.05};
    ck_assert_int_eq(palp_network_step(net, 0.10 * HEIGHT, INFINITY, &info), PALP_OK);
    ck_assert_double_eq(info.beyond, 0.0);
    ck_assert_double_gt(palp_network_strain_max(net), 0.09);
    ck_assert_int_eq(palp_network_step(net, 0.25 * HEIGHT, INFINITY, &info), PALP_OK);
    ck_assert_double_gt(info.beyond, 0.05);
    ck_assert_double_eq(info.beyond, palp_network_strain_max(net) - 0.15);
    palp_network_reset(net);
    ck_assert_int_eq(palp_path_ramp_hold(0.3 * HEIGHT, 1.0, 1.0, &path), PALP_OK);
    ck_assert_int_eq(palp_network_run(net, &path, &settings, &run), PALP_OK);
    ck_assert_double_gt(run.beyond, 0.1);
    ck_assert_double_gt(run.beyond_s, 0.35); /* a mean strain of 0.15 is reached at 0.5 s */
    ck_assert_double_lt(run.beyond_s, 0.55);
    palp_path_free(&path);
    palp_network_free(net);
}
END_TEST

/* The work of the plate is the stored energy: force, tangent and energy agree across the end of the range. */
START_TEST(energy_is_the_work_across_the_end) {
    palp_material m = limited(0.15, 1.0);
    palp_network *net = cube_network(3, &m, NULL);
    palp_realtime_settings settings = palp_realtime_settings_default();
    palp_realtime *rt = NULL;
    const palp_budget exact = {.corrections = 200};
    palp_tick_info info;
    double energy[3], force[3], worst = 0.0;
    ck_assert_int_eq(palp_realtime_create(net, &settings, &rt), PALP_OK);
    for (int i = 1; i <= STEPS; i++) {
        for (int k = 0; k < 3; k++) {
            ck_assert_int_eq(
                palp_realtime_step(rt, (0.01 * i + 1e-4 * (k - 1)) * HEIGHT, INFINITY, &exact, &info),
                PALP_OK);
            ck_assert(info.converged);
            energy[k] = palp_realtime_energy(rt);
            force[k] = info.force_N;
        }
        worst = fmax(worst, fabs((energy[2] - energy[0]) / (2e-4 * HEIGHT) - force[1]) / force[1]);
        ck_assert_double_gt(force[2], force[0]);
        ck_assert_int_eq(info.beyond > 0.0, palp_network_strain_max(net) > 0.15);
    }
    ck_assert_double_lt(worst, 1e-4);
    palp_realtime_free(rt);
    palp_network_free(net);
}
END_TEST

/* Newtons a millionth: every number is the same. Beyond the range a network follows its law's tangent, not
 * the quartic. */
START_TEST(scale_changes_nothing_and_the_limit_matters) {
    palp_material m[3] = {limited(0.15, 1.0), limited(0.15, 1e-6), limited(0.0, 1.0)};
    palp_network *net[3];
    for (int k = 0; k < 3; k++)
        net[k] = cube_network(3, &m[k], NULL);
    for (int i = 1; i <= STEPS; i++) {
        double force[3], largest = palp_network_strain_max(net[0]);
        for (int k = 0; k < 3; k++) {
            ck_assert_int_eq(palp_network_step(net[k], 0.01 * i * HEIGHT, INFINITY, NULL), PALP_OK);
            force[k] = palp_network_force(net[k]);
        }
        ck_assert_double_eq_tol(1e6 * force[1], force[0], 1e-7 * force[0]);
        if (palp_network_strain_max(net[0]) < 0.15)
            ck_assert_double_eq(force[2], force[0]);
        if (i == STEPS)
            ck_assert_double_gt(fabs(force[2] - force[0]), 1e-3 * force[0]);
        ck_assert_double_ge(palp_network_strain_max(net[0]), largest);
    }
    for (int k = 0; k < 3; k++)
        palp_network_free(net[k]);
}
END_TEST

/* A state of a network whose law ends elsewhere is another network's. */
START_TEST(state_knows_the_range) {
    palp_material m[2] = {limited(0.15, 1.0), limited(0.2, 1.0)};
    palp_network *net[2] = {cube_network(3, &m[0], NULL), cube_network(3, &m[1], NULL)};
    size_t size = palp_network_state_size(net[0]);
    void *state = malloc(size);
    ck_assert_ptr_nonnull(state);
    ck_assert_int_eq(palp_network_save(net[0], state, size), PALP_OK);
    ck_assert_int_eq(palp_network_restore(net[0], state, size), PALP_OK);
    ck_assert_int_eq(palp_network_restore(net[1], state, size), PALP_ERR_ARGUMENT);
    free(state);
    palp_network_free(net[0]);
    palp_network_free(net[1]);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, steps_and_runs_tell_how_far_beyond);
    tcase_add_test(tc, energy_is_the_work_across_the_end);
    tcase_add_test(tc, scale_changes_nothing_and_the_limit_matters);
    tcase_add_test(tc, state_knows_the_range);
}
