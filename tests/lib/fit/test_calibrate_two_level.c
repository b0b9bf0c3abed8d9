/* test_calibrate_two_level.c: the static stage of large networks through a coarse one of the same body. check: once */
#include "fit/calibrate_internal.h"
#include "network_make.h"

enum { SAMPLES = 240 };

typedef struct curve {
    double depth[SAMPLES], force[SAMPLES];
} curve;

/* The lumped specimen's, to depth. */
static curve lumped_curve(double depth) {
    curve c;
    palp_law law;
    ck_assert_int_eq(palp_law_polynomial(5, (double[]){8.18, -0.70, 47.47, -131.36, 146.89}, &law), PALP_OK);
    for (int i = 0; i < SAMPLES; i++) {
        c.depth[i] = depth * (i + 1) / SAMPLES;
        double e = c.depth[i] / HEIGHT;
        palp_law_force(&law, 1, &e, &c.force[i], NULL, NULL);
    }
    return c;
}

static palp_status carry(size_t fine, size_t coarse, palp_branch branch, const curve *c, palp_calibration *result) {
    palp_material start = quartic(0);
    palp_network_settings how = palp_network_settings_default();
    how.branch = branch;
    palp_network *large = cube_network(fine, &start, &how), *small = cube_network(coarse, &start, NULL);
    palp_static_settings settings = palp_static_settings_default();
    palp_status status =
        palp_calibrate_two_level(large, small, &start, SAMPLES, c->depth, c->force, &settings, result);
    palp_network_free(large);
    palp_network_free(small);
    return status;
}

/* Another network with the law that was found, stepped by its factor, meets the target. */
START_TEST(the_coarse_law_meets_the_target) {
    const curve c = lumped_curve(0.007);
    palp_calibration result;
    ck_assert_int_eq(carry(9, 5, PALP_BRANCH_CONTINUE, &c, &result), PALP_OK);
    ck_assert(result.converged);
    ck_assert(!result.buckled);
    ck_assert_double_eq(result.reached_m, 0.007);
    ck_assert_uint_le(result.n_iterations, 5);
    palp_network *net = cube_network(9, &result.material, NULL);
    for (int i = 9; i < SAMPLES; i += 10) {
        ck_assert_int_eq(palp_network_step(net, c.depth[i], INFINITY, NULL), PALP_OK);
        double got = palp_network_force(net), peak = c.force[SAMPLES - 1];
        ck_assert_double_eq_tol(got, result.force_N[i], 1e-4 * peak);
        ck_assert_double_eq_tol(got, c.force[i], 1e-3 * peak);
    }
    palp_network_free(net);
    palp_calibration_free(&result);
}
END_TEST

/* 11 nodes a side fold at a strain of some 0.37: the result says so, and holds as far as it reached. */
START_TEST(the_branchs_end_is_told) {
    const curve c = lumped_curve(0.0097);
    palp_calibration result;
    ck_assert_int_eq(carry(11, 5, PALP_BRANCH_CONTINUE, &c, &result), PALP_OK);
    ck_assert(result.buckled);
    ck_assert_double_gt(result.reached_m, 0.33 * HEIGHT);
    ck_assert_double_lt(result.reached_m, 0.39 * HEIGHT);
    ck_assert_double_eq(result.stable_m, result.reached_m);
    ck_assert_double_gt(result.unstable_m, result.stable_m);
    for (int i = 0; i < SAMPLES && c.depth[i] <= 0.008; i++)
        ck_assert_double_eq_tol(result.force_N[i], c.force[i], 0.02 * c.force[SAMPLES - 1]);
    palp_calibration_free(&result);
}
END_TEST

/* With the stable branch the same lattice goes all the way: the law is as good before the fold, and where it was is told. */
START_TEST(the_stable_branch_goes_on) {
    const curve c = lumped_curve(0.0097);
    palp_calibration result;
    ck_assert_int_eq(carry(11, 5, PALP_BRANCH_STABLE, &c, &result), PALP_OK);
    ck_assert_double_eq(result.reached_m, c.depth[SAMPLES - 1]);
    ck_assert(result.buckled);
    ck_assert_double_gt(result.stable_m, 0.33 * HEIGHT);
    ck_assert_double_lt(result.unstable_m, 0.0097);
    ck_assert_double_gt(result.unstable_m, result.stable_m);
    for (int i = 0; i < SAMPLES && c.depth[i] <= 0.008; i++)
        ck_assert_double_eq_tol(result.force_N[i], c.force[i], 0.02 * c.force[SAMPLES - 1]);
    palp_calibration_free(&result);
}
END_TEST

START_TEST(two_levels_refuse) {
    const curve c = lumped_curve(0.005);
    palp_material start = quartic(0);
    palp_network *net = cube_network(3, &start, NULL);
    palp_static_settings settings = palp_static_settings_default();
    palp_calibration result;
    ck_assert_int_eq(palp_calibrate_two_level(net, net, &start, 0, c.depth, c.force, &settings, &result),
                     PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_calibrate_two_level(net, net, &start, SAMPLES, c.force, c.depth, &settings, &result),
                     PALP_ERR_ARGUMENT);
    ck_assert_ptr_null(result.force_N);
    palp_network_free(net);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, the_coarse_law_meets_the_target);
    tcase_add_test(tc, the_branchs_end_is_told);
    tcase_add_test(tc, the_stable_branch_goes_on);
    tcase_add_test(tc, two_levels_refuse);
}
