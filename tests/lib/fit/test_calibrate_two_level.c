/* test_calibrate_two_level.c: the static stage of large networks through a coarse one of the same body.
 * check: once */
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

/* volume: modulus of the tetrahedra over that of the lumped specimen at rest. */
static palp_network_settings with_volume(double volume) {
    palp_network_settings how = palp_network_settings_default();
    how.volume_modulus_Pa = volume * 8.18 / (HEIGHT * HEIGHT);
    return how;
}

static palp_status carry_with(size_t fine, size_t coarse, palp_branch branch, double volume, const curve *c,
                              palp_calibration *result) {
    palp_material start = quartic(0);
    palp_network_settings of_coarse = with_volume(volume), how = of_coarse;
    how.branch = branch;
    palp_network *large = cube_network(fine, &start, &how), *small = cube_network(coarse, &start, &of_coarse);
    palp_static_settings settings = palp_static_settings_default();
    palp_status status =
        palp_calibrate_two_level(large, small, &start, SAMPLES, c->depth, c->force, &settings, result);
    palp_network_free(large);
    palp_network_free(small);
    return status;
}

static palp_status carry(size_t fine, size_t coarse, palp_branch branch, const curve *c,
                         palp_calibration *result) {
    return carry_with(fine, coarse, branch, 0.0, c, result);
}

/* Another network with the law that was found, stepped by its factor, gives the force of the result within
 * tolerance of its peak. Returns the largest difference from the target, of its peak. */
static double pressed_anew(size_t fine, double volume, const curve *c, double tolerance,
                           const palp_calibration *result) {
    const palp_network_settings how = with_volume(volume);
    palp_network *net = cube_network(fine, &result->material, &how);
    double peak = c->force[SAMPLES - 1], worst = 0.0;
    for (int i = 9; i < SAMPLES; i += 10) {
        ck_assert_int_eq(palp_network_step(net, c->depth[i], INFINITY, NULL), PALP_OK);
        double got = palp_network_force(net);
        ck_assert_double_eq_tol(got, result->force_N[i], tolerance * peak);
        worst = fmax(worst, fabs(got - c->force[i]) / peak);
    }
    palp_network_free(net);
    return worst;
}

START_TEST(the_coarse_law_meets_the_target) {
    const curve c = lumped_curve(0.007);
    palp_calibration result;
    ck_assert_int_eq(carry(9, 5, PALP_BRANCH_CONTINUE, &c, &result), PALP_OK);
    ck_assert(result.converged);
    ck_assert(!result.buckled);
    ck_assert_double_eq(result.reached_m, 0.007);
    ck_assert_uint_le(result.n_iterations, 5);
    ck_assert_double_lt(pressed_anew(9, 0.0, &c, 1e-4, &result), 1e-3);
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

/* With the stable branch the same lattice goes all the way: the law is as good before the fold, and the
 * fold's place is reported. */
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

/* What tetrahedra resist does not grow with the number of elements, as what these do: a law is another's of
 * the same material by the lengths that share in it. */
START_TEST(a_volume_is_the_same_on_both_levels) {
    const curve c = lumped_curve(0.009);
    palp_calibration result;
    ck_assert_int_eq(carry_with(11, 5, PALP_BRANCH_CONTINUE, 1.0, &c, &result), PALP_OK);
    ck_assert(result.converged);
    ck_assert(!result.buckled);
    ck_assert_double_lt(result.iterations[0].residual_N, 0.1 * c.force[SAMPLES - 1] * sqrt(SAMPLES));
    ck_assert_double_lt(result.residual_N, 1e-4 * c.force[SAMPLES - 1] * sqrt(SAMPLES));
    ck_assert_double_lt(pressed_anew(11, 1.0, &c, 1e-4, &result), 1e-3);
    palp_calibration_free(&result);
}
END_TEST

/* A coarse lattice of 27 nodes, so deep, misleads: the last round is worse than the one before. */
START_TEST(the_best_round_is_kept) {
    const curve c = lumped_curve(0.01);
    palp_calibration result;
    ck_assert_int_eq(carry_with(9, 3, PALP_BRANCH_CONTINUE, 1.0, &c, &result), PALP_OK);
    double least = INFINITY, last = result.iterations[result.n_iterations - 1].residual_N;
    for (size_t i = 0; i < result.n_iterations; i++)
        least = fmin(least, result.iterations[i].residual_N);
    ck_assert_double_gt(last, 1.1 * least);
    ck_assert_double_eq(result.residual_N, least);
    pressed_anew(9, 1.0, &c, 2e-3, &result);
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
    ck_assert_int_eq(
        palp_calibrate_two_level(net, net, &start, SAMPLES, c.force, c.depth, &settings, &result),
        PALP_ERR_ARGUMENT);
    ck_assert_ptr_null(result.force_N);
    palp_network_free(net);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, the_coarse_law_meets_the_target);
    tcase_add_test(tc, the_branchs_end_is_told);
    tcase_add_test(tc, the_stable_branch_goes_on);
    tcase_add_test(tc, a_volume_is_the_same_on_both_levels);
    tcase_add_test(tc, the_best_round_is_kept);
    tcase_add_test(tc, two_levels_refuse);
}
