/* test_calibrate_static.c: the static stage (Section 5.3.1) against Table 5.1 and materials known beforehand.
 */
#include "cube.h"

#include <palpate/thesis.h>

#include <string.h>

/* Both ways of the static stage. */
typedef palp_status static_method(palp_network *, const palp_material *, size_t, const double *,
                                  const double *, const palp_static_settings *, palp_calibration *);
static static_method *const METHODS[2] = {palp_calibrate_static, palp_thesis_fixed_point};

/* The thesis' F_REFERENCE: Eq. 4.3 at n strains. */
static double *thesis_target(size_t n, const double *depth) {
    double *force = malloc(n * sizeof *force), *strain = malloc(n * sizeof *strain);
    palp_material lumped = cube_polynomial(5, LUMPED_LAW);
    ck_assert(force && strain);
    for (size_t i = 0; i < n; i++)
        strain[i] = depth[i] / CUBE_HEIGHT_M;
    palp_law_force(&lumped.law, n, strain, force, NULL, NULL);
    free(strain);
    return force;
}

/* Calibrates a cube on the thesis' curve in n samples. */
static void calibrate_cube(static_method *method, size_t nodes, size_t n, const palp_material *start,
                           const palp_static_settings *settings, palp_calibration *result) {
    palp_network_settings network_settings = palp_network_settings_default();
    double *depth = malloc(n * sizeof *depth);
    ck_assert_ptr_nonnull(depth);
    cube_depths(n, CUBE_PRESS_M, depth);
    double *target = thesis_target(n, depth);
    palp_network *network = cube_network(nodes, start, &network_settings);
    ck_assert_int_eq(method(network, start, n, depth, target, settings, result), PALP_OK);
    palp_network_free(network);
    free(depth);
    free(target);
}

START_TEST(table_5_1) {
    const double residual[6] = {8243.89, 91.22, 35.79, 16.17, 8.55, 5.45};
    const double leading[3][3] = {{32.82, -23.54, 8.17}, {67.91, -46.94, 14.48}, {99.48, -68.62, 19.91}};
    palp_material start = cube_polynomial(5, LUMPED_LAW);
    palp_static_settings settings = palp_static_settings_default();
    palp_calibration result;
    settings.max_evaluations = 10;
    calibrate_cube(palp_thesis_fixed_point, 3, 97000, &start, &settings, &result);
    ck_assert_uint_eq(result.n_iterations, 10);
    ck_assert_double_le(result.residual_N, 3.92);
    for (size_t i = 0; i < 6; i++)
        ck_assert_double_eq_tol(result.iterations[i].residual_N, residual[i], 0.02 * residual[i]);
    for (size_t i = 0; i < 3; i++)
        for (size_t k = 0; k < 3; k++)
            ck_assert_double_eq_tol(result.iterations[i + 1].material.law.coefficients[4 - k], leading[i][k],
                                    0.02 * fabs(leading[i][k]));
    palp_calibration_free(&result);
}
END_TEST

/* 2-norms of n samples stand for those of the thesis' 97000. */
static double thesis_norm(const palp_calibration *result) {
    return result->residual_N * sqrt(97000.0 / (double)result->n_samples);
}

START_TEST(fixed_point_with_125_nodes) {
    palp_material start = cube_polynomial(5, LUMPED_LAW);
    palp_static_settings settings = palp_static_settings_default();
    palp_calibration result;
    settings.max_evaluations = 10;
    calibrate_cube(palp_thesis_fixed_point, 5, 9700, &start, &settings, &result);
    ck_assert_double_le(thesis_norm(&result), 4.76);
    palp_calibration_free(&result);
}
END_TEST

START_TEST(quartic_by_least_squares) {
    const size_t nodes[2] = {3, 5};
    const double most[2] = {1.30, 1.75};
    palp_material start = cube_polynomial(5, LUMPED_LAW);
    palp_static_settings settings = palp_static_settings_default();
    settings.max_evaluations = 30;
    for (size_t i = 0; i < 2; i++) {
        palp_calibration result;
        calibrate_cube(palp_calibrate_static, nodes[i], 970, &start, &settings, &result);
        ck_assert_double_le(thesis_norm(&result), most[i]);
        ck_assert(result.converged);
        ck_assert_uint_le(result.n_iterations, 30);
        ck_assert_double_eq(result.reached_m, CUBE_PRESS_M);
        ck_assert(result.buckled && result.stable_m < result.unstable_m && result.unstable_m <= CUBE_PRESS_M);
        palp_calibration_free(&result);
    }
}
END_TEST

START_TEST(spline_by_least_squares) {
    palp_material start = cube_spline();
    palp_static_settings settings = palp_static_settings_default();
    palp_calibration result;
    ck_assert_int_eq(palp_law_scale(&start.law, 10.0, &start.law), PALP_OK);
    calibrate_cube(palp_calibrate_static, 3, 970, &start, &settings, &result);
    ck_assert_double_le(thesis_norm(&result), 0.15);
    ck_assert(result.converged);
    palp_calibration_free(&result);
}
END_TEST

/* What the result says of itself holds: the network carries its material, the curve is that material's. */
static void check_result(palp_network *network, const palp_calibration *result, double tolerance) {
    double sum = 0.0, peak = 0.0, least = HUGE_VAL;
    for (size_t i = 0; i < result->n_samples; i++) {
        double miss = result->force_N[i] - result->target_N[i];
        sum += miss * miss;
        peak = fmax(peak, result->force_N[i]);
    }
    ck_assert_double_eq_tol(sqrt(sum), result->residual_N, 1e-12 + 1e-9 * result->residual_N);
    for (size_t i = 0; i < result->n_iterations; i++)
        least = fmin(least, result->iterations[i].residual_N);
    ck_assert_double_eq(least, result->residual_N);
    for (size_t i = 0; i < result->n_samples; i++) {
        ck_assert_int_eq(palp_network_step(network, result->depth_m[i], INFINITY, NULL), PALP_OK);
        ck_assert_double_eq_tol(palp_network_force(network), result->force_N[i], tolerance * peak);
    }
}

/* A target that a network with a known law makes. It is met to the interpolation's error, or with every step
 * to that of the equilibria. The law is recovered at all strains that the network saw. */
static void recover(size_t nodes, const palp_material *known, const palp_material *start, bool every_step) {
    enum { N = 60 };
    double depth[N], target[N], seen = 0.0, tolerance = every_step ? 1e-9 : 6e-6;
    palp_network_settings network_settings = palp_network_settings_default();
    palp_network *network = cube_network(nodes, known, &network_settings);
    palp_static_settings settings = palp_static_settings_default();
    palp_calibration result;
    const double *strain = palp_network_element_strain(network);
    cube_depths(N, 0.007, depth);
    for (size_t i = 0; i < N; i++) {
        ck_assert_int_eq(palp_network_step(network, depth[i], INFINITY, NULL), PALP_OK);
        target[i] = palp_network_force(network);
    }
    strain = palp_network_element_strain(network);
    for (size_t i = 0; i < palp_mesh_element_count(palp_network_mesh(network)); i++)
        seen = fmax(seen, fabs(strain[i]));
    settings.every_step = every_step;
    settings.stop_relative = 1e-6;
    settings.max_evaluations = 30;
    ck_assert_int_eq(palp_calibrate_static(network, start, N, depth, target, &settings, &result), PALP_OK);
    ck_assert(result.converged);
    ck_assert_double_le(result.residual_N, tolerance * sqrt((double)N) * target[N - 1]);
    check_result(network, &result, tolerance);
    for (double a = 0.0; a <= seen; a += 0.02) {
        double found, wanted;
        palp_law_stiffness(&known->law, a, &wanted, NULL);
        palp_law_stiffness(&result.material.law, a, &found, NULL);
        ck_assert_double_eq_tol(found, wanted, (every_step ? 1e-5 : 1e-2) * wanted);
    }
    palp_calibration_free(&result);
    palp_network_free(network);
}

START_TEST(known_law_comes_back) {
    const double flat[5] = {1.0, 0.0, 0.0, 0.0, 0.0}, rising[8] = {5, 5.1, 5.3, 5.6, 6, 6.5, 7.1, 7.8};
    palp_material quartic = cube_polynomial(5, NETWORK_LAW), from = cube_polynomial(5, flat),
                  spline = cube_spline();
    palp_material spline_from = spline;
    ck_assert_int_eq(palp_law_spline(8, spline.law.strain, rising, &spline_from.law), PALP_OK);
    recover(3, &quartic, &from, false);
    recover(3, &quartic, &from, true);
    recover(5, &quartic, &from, false);
    recover(3, &spline, &spline_from, true);
}
END_TEST

START_TEST(every_step_and_continuation_agree) {
    palp_material start = cube_polynomial(5, LUMPED_LAW);
    palp_static_settings settings = palp_static_settings_default();
    palp_calibration every, traced;
    for (size_t i = 0; i < 2; i++) {
        settings.every_step = true;
        calibrate_cube(METHODS[i], 3, 100, &start, &settings, &every);
        settings.every_step = false;
        calibrate_cube(METHODS[i], 3, 100, &start, &settings, &traced);
        /* the samples' forces agree to some 1e-6 of the peak, 13 N at first, 4 N later */
        ck_assert_double_eq_tol(every.iterations[0].residual_N, traced.iterations[0].residual_N, 1e-3);
        ck_assert_double_eq_tol(every.residual_N, traced.residual_N, 1e-3);
        for (double a = 0.0; a <= 0.4; a += 0.05) {
            double k[2];
            palp_law_stiffness(&every.material.law, a, &k[0], NULL);
            palp_law_stiffness(&traced.material.law, a, &k[1], NULL);
            ck_assert_double_eq_tol(k[0], k[1], 2e-3 * k[0]);
        }
        palp_calibration_free(&every);
        palp_calibration_free(&traced);
    }
}
END_TEST

/* On the stable branch the curve bends where the network falls, and is met less well. */
START_TEST(stable_branch) {
    enum { N = 97 };
    double depth[N];
    palp_network_settings network_settings = palp_network_settings_default();
    palp_material start = cube_polynomial(5, LUMPED_LAW);
    palp_static_settings settings = palp_static_settings_default();
    palp_calibration result;
    network_settings.branch = PALP_BRANCH_STABLE;
    palp_network *network = cube_network(3, &start, &network_settings);
    cube_depths(N, CUBE_PRESS_M, depth);
    double *target = thesis_target(N, depth);
    settings.max_evaluations = 20;
    ck_assert_int_eq(palp_calibrate_static(network, &start, N, depth, target, &settings, &result), PALP_OK);
    ck_assert_double_le(result.residual_N, 0.01 * sqrt((double)N) * target[N - 1]);
    ck_assert_uint_le(result.n_iterations, 20);
    palp_calibration_free(&result);
    palp_network_free(network);
    free(target);
}
END_TEST

typedef struct watch {
    int calls, stop_at;
    double fraction, residual;
} watch;

static int watch_progress(void *user, double fraction, const palp_calibrate_iteration *last) {
    watch *w = user;
    ck_assert_double_gt(fraction, w->fraction);
    ck_assert_double_le(fraction, 1.0);
    w->fraction = fraction;
    w->residual = last->residual_N;
    return ++w->calls == w->stop_at;
}

START_TEST(progress_and_stop) {
    enum { N = 50 };
    double depth[N];
    watch w = {0};
    palp_network_settings network_settings = palp_network_settings_default();
    palp_material start = cube_polynomial(5, LUMPED_LAW);
    palp_network *network = cube_network(3, &start, &network_settings);
    palp_static_settings settings = palp_static_settings_default();
    palp_calibration result;
    cube_depths(N, CUBE_PRESS_M, depth);
    double *target = thesis_target(N, depth);
    settings.progress = watch_progress;
    settings.user = &w;
    for (int method = 0; method < 2; method++) {
        for (size_t most = 2; most < 7; most++) {
            w = (watch){0};
            settings.max_evaluations = most;
            ck_assert_int_eq(METHODS[method](network, &start, N, depth, target, &settings, &result), PALP_OK);
            ck_assert_uint_eq(result.n_iterations, most); /* both need more */
            ck_assert_int_eq(w.calls, (int)most);
            ck_assert_double_eq(w.residual, result.iterations[most - 1].residual_N);
            ck_assert(!result.converged);
            palp_calibration_free(&result);
        }
        w = (watch){.stop_at = 3};
        ck_assert_int_eq(METHODS[method](network, &start, N, depth, target, &settings, &result),
                         PALP_ERR_STOPPED);
        ck_assert_int_eq(w.calls, 3);
        ck_assert_ptr_null(result.iterations);
        ck_assert_ptr_null(result.force_N);
    }
    palp_network_free(network);
    free(target);
}
END_TEST

START_TEST(bad_input) {
    enum { N = 20 };
    double depth[N], changed[N];
    const double falling[3] = {1.0, -4.0, 0.0}, nothing[2] = {0.0, 1.0};
    palp_network_settings network_settings = palp_network_settings_default();
    palp_material quartic = cube_polynomial(5, LUMPED_LAW), spline = cube_spline(), rubber = {.n_arms = 0};
    palp_material bad = cube_polynomial(3, falling), soft = cube_polynomial(2, nothing);
    palp_network *network = cube_network(3, &quartic, &network_settings);
    palp_static_settings settings = palp_static_settings_default(), other = settings;
    palp_calibration result;
    cube_depths(N, CUBE_PRESS_M, depth);
    double *target = thesis_target(N, depth);
    ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_NEO_HOOKEAN, 1, &(double){1e4}, 1e-4, &rubber.law),
                     PALP_OK);
#define STATUS(start, n, depths, targets, how, wanted)                                                       \
    do {                                                                                                     \
        ck_assert_int_eq(palp_calibrate_static(network, start, n, depths, targets, how, &result), wanted);   \
        ck_assert_ptr_null(result.iterations);                                                               \
    } while (0)
    STATUS(&quartic, 6, depth, target, &settings, PALP_ERR_ARGUMENT); /* too few samples */
    STATUS(&quartic, 0, depth, target, &settings, PALP_ERR_ARGUMENT);
    STATUS(&rubber, N, depth, target, &settings, PALP_ERR_UNSUPPORTED);
    STATUS(&bad, N, depth, target, &settings, PALP_ERR_ARGUMENT); /* K falls below 0 on the way */
    STATUS(&soft, N, depth, target, &settings, PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_thesis_fixed_point(network, &spline, N, depth, target, &settings, &result),
                     PALP_ERR_UNSUPPORTED);
    ck_assert_ptr_null(result.iterations);
    other.max_evaluations = 1;
    STATUS(&quartic, N, depth, target, &other, PALP_ERR_ARGUMENT);
    other = settings;
    other.curve_tolerance = -1.0;
    STATUS(&quartic, N, depth, target, &other, PALP_ERR_ARGUMENT);
    other.curve_tolerance = NAN;
    STATUS(&quartic, N, depth, target, &other, PALP_ERR_ARGUMENT);
    const double depths_bad[4] = {0.0, -0.001, NAN, INFINITY},
                 targets_bad[4] = {-INFINITY, -1e6, NAN, INFINITY}; /* -1e6: all in all no press */
    for (size_t i = 0; i < 4; i++) {
        memcpy(changed, depth, sizeof changed);
        changed[i == 3 ? N - 1 : 0] = depths_bad[i];
        STATUS(&quartic, N, changed, target, &settings, PALP_ERR_ARGUMENT);
        memcpy(changed, target, sizeof changed);
        changed[7] = targets_bad[i];
        STATUS(&quartic, N, depth, changed, &settings, PALP_ERR_ARGUMENT);
    }
    memcpy(changed, target, sizeof changed);
    changed[0] = 0.0;
    ck_assert_int_eq(palp_thesis_fixed_point(network, &quartic, N, depth, changed, &settings, &result),
                     PALP_ERR_ARGUMENT); /* it divides by the force */
    memcpy(changed, depth, sizeof changed);
    changed[N - 1] = CUBE_HEIGHT_M;
    STATUS(&quartic, N, changed, target, &settings, PALP_ERR_ARGUMENT);
    changed[N - 1] = depth[N - 1];
    changed[5] = changed[4];
    STATUS(&quartic, N, changed, target, &settings, PALP_ERR_ARGUMENT);
    changed[5] = 0.5 * changed[4];
    STATUS(&quartic, N, changed, target, &settings, PALP_ERR_ARGUMENT);
#undef STATUS
    palp_calibration_free(NULL);
    palp_network_free(network);
    free(target);
}
END_TEST

/* A target that goes on beyond the end of the branch is met as far as there are equilibria. */
START_TEST(target_beyond_the_reach) {
    enum { N = 70 };
    double depth[N], target[N];
    const double one = 1.0;
    palp_network_settings network_settings = palp_network_settings_default();
    palp_material start = cube_polynomial(1, &one);
    palp_network *network = cube_network(5, &start, &network_settings);
    palp_static_settings settings = palp_static_settings_default();
    palp_calibration result;
    cube_depths(N, 0.7 * CUBE_HEIGHT_M, depth);
    for (size_t i = 0; i < N; i++)
        target[i] = 1e3 * depth[i];
    for (int every = 0; every < 2; every++) {
        settings.every_step = every;
        settings.max_evaluations = 5;
        ck_assert_int_eq(palp_calibrate_static(network, &start, N, depth, target, &settings, &result),
                         PALP_OK);
        ck_assert_double_eq_tol(result.reached_m, 0.545 * CUBE_HEIGHT_M, 0.006 * CUBE_HEIGHT_M);
        ck_assert(result.buckled);
        ck_assert_double_lt(result.unstable_m, result.reached_m);
        for (size_t i = 56; i < N; i++)
            ck_assert_double_eq_tol(result.force_N[i], result.force_N[55], 1e-12);
        palp_calibration_free(&result);
    }
    palp_network_free(network);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, table_5_1);
    tcase_add_test(tc, fixed_point_with_125_nodes);
    tcase_add_test(tc, quartic_by_least_squares);
    tcase_add_test(tc, spline_by_least_squares);
    tcase_add_test(tc, known_law_comes_back);
    tcase_add_test(tc, every_step_and_continuation_agree);
    tcase_add_test(tc, stable_branch);
    tcase_add_test(tc, progress_and_stop);
    tcase_add_test(tc, bad_input);
    tcase_add_test(tc, target_beyond_the_reach);
}
