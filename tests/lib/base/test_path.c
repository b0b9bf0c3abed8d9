/* test_path.c: depth paths against their corners written out. */
#include <palpate/path.h>

#include <check.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

static void corner_is(const palp_path *path, size_t i, double time_s, double value) {
    ck_assert_double_eq_tol(path->time_s[i], time_s, 1e-15);
    ck_assert_double_eq_tol(path->depth_m ? path->depth_m[i] : path->force_N[i], value, 1e-15);
}

START_TEST(static_path_is_one_ramp) {
    palp_path path;
    ck_assert_int_eq(palp_path_static(0.006, 0.0001, &path), PALP_OK);
    ck_assert_uint_eq(path.n, 2);
    corner_is(&path, 0, 0, 0);
    ck_assert_double_eq_tol(path.time_s[1], 60, 1e-12);
    ck_assert_double_eq_tol(palp_path_at(&path, 15), 0.0015, 1e-15);
    palp_path_free(&path);
    ck_assert_int_eq(palp_path_static(-0.002, 0.001, &path), PALP_OK); /* away from the specimen */
    corner_is(&path, 1, 2, -0.002);
    palp_path_free(&path);
}
END_TEST

START_TEST(ramp_hold_with_and_without_its_parts) {
    palp_path path;
    ck_assert_int_eq(palp_path_ramp_hold(0.005, 1, 200, &path), PALP_OK);
    ck_assert_uint_eq(path.n, 3);
    corner_is(&path, 0, 0, 0);
    corner_is(&path, 1, 1, 0.005);
    corner_is(&path, 2, 201, 0.005);
    palp_path_free(&path);
    ck_assert_int_eq(palp_path_ramp_hold(0.005, 1, 0, &path), PALP_OK);
    ck_assert_uint_eq(path.n, 2);
    corner_is(&path, 1, 1, 0.005);
    palp_path_free(&path);
    ck_assert_int_eq(palp_path_ramp_hold(0.005, 0, 200, &path), PALP_OK);
    ck_assert_uint_eq(path.n, 2);
    corner_is(&path, 0, 0, 0.005);
    corner_is(&path, 1, 200, 0.005);
    palp_path_free(&path);
}
END_TEST

START_TEST(cyclic_path_goes_to_and_fro) {
    palp_path path;
    ck_assert_int_eq(palp_path_cyclic(0.004, 0.002, 3, &path), PALP_OK);
    ck_assert_uint_eq(path.n, 7);
    for (size_t i = 0; i < 7; i++)
        corner_is(&path, i, 2.0 * (double)i, i % 2 ? 0.004 : 0);
    ck_assert_double_eq_tol(palp_path_at(&path, 7), 0.002, 1e-15);
    palp_path_free(&path);
}
END_TEST

START_TEST(creep_path_holds_force) {
    palp_path path;
    ck_assert_int_eq(palp_path_creep(2.5, 0.5, 10, &path), PALP_OK);
    ck_assert_ptr_null(path.depth_m);
    ck_assert_uint_eq(path.n, 3);
    corner_is(&path, 1, 0.5, 2.5);
    corner_is(&path, 2, 10.5, 2.5);
    ck_assert_double_eq_tol(palp_path_at(&path, 0.1), 0.5, 1e-15);
    palp_path_free(&path);
    ck_assert_ptr_null(path.force_N);
}
END_TEST

START_TEST(between_corners_it_is_linear_and_outside_constant) {
    double time_s[5] = {-1, 0, 0.5, 2, 7}, depth_m[5] = {3, 1, 4, 1, 5};
    palp_path path;
    ck_assert_int_eq(palp_path_create(5, time_s, depth_m, &path), PALP_OK);
    for (size_t i = 0; i < 5; i++)
        ck_assert_double_eq(palp_path_at(&path, time_s[i]), depth_m[i]);
    for (size_t i = 0; i < 4; i++)
        ck_assert_double_eq_tol(palp_path_at(&path, 0.75 * time_s[i] + 0.25 * time_s[i + 1]),
                                0.75 * depth_m[i] + 0.25 * depth_m[i + 1], 1e-15);
    ck_assert_double_eq(palp_path_at(&path, -100), 3);
    ck_assert_double_eq(palp_path_at(&path, INFINITY), 5);
    time_s[0] = -50; /* it keeps copies */
    ck_assert_double_eq(path.time_s[0], -1);
    palp_path_free(&path);
    ck_assert_uint_eq(path.n, 0);
    ck_assert_double_eq(palp_path_at(&path, 1), 0);
    palp_path_free(&path); /* again is harmless */
    palp_path_free(NULL);
}
END_TEST

static void refused(palp_status status, const palp_path *path) {
    ck_assert_int_eq(status, PALP_ERR_ARGUMENT);
    ck_assert_ptr_null(path->time_s);
    ck_assert_ptr_null(path->depth_m);
    ck_assert_uint_eq(path->n, 0);
}

START_TEST(numbers_that_make_no_path_are_refused) {
    palp_path path;
    double good[2] = {0, 1}, same[2] = {1, 1}, back[2] = {1, 0}, nan_at[2] = {0, NAN}, far[2] = {0, INFINITY};
    refused(palp_path_create(0, good, good, &path), &path);
    refused(palp_path_create(2, same, good, &path), &path);
    refused(palp_path_create(2, back, good, &path), &path);
    refused(palp_path_create(2, nan_at, good, &path), &path);
    refused(palp_path_create(2, far, good, &path), &path);
    refused(palp_path_create(2, good, nan_at, &path), &path);
    refused(palp_path_static(0.001, 0, &path), &path);
    refused(palp_path_static(0.001, -1, &path), &path);
    refused(palp_path_static(0, 1, &path), &path);
    refused(palp_path_static(NAN, 1, &path), &path);
    refused(palp_path_ramp_hold(0.001, -1, 1, &path), &path);
    refused(palp_path_ramp_hold(0.001, 1, -1, &path), &path);
    refused(palp_path_ramp_hold(0.001, NAN, 1, &path), &path);
    refused(palp_path_ramp_hold(INFINITY, 1, 1, &path), &path);
    refused(palp_path_cyclic(0.001, 1, 0, &path), &path);
    refused(palp_path_cyclic(0.001, 1, SIZE_MAX, &path), &path);
    refused(palp_path_cyclic(0.001, 0, 1, &path), &path);
    refused(palp_path_cyclic(0.001, -1, 1, &path), &path);
    refused(palp_path_creep(NAN, 1, 1, &path), &path);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, static_path_is_one_ramp);
    tcase_add_test(tc, ramp_hold_with_and_without_its_parts);
    tcase_add_test(tc, cyclic_path_goes_to_and_fro);
    tcase_add_test(tc, creep_path_holds_force);
    tcase_add_test(tc, between_corners_it_is_linear_and_outside_constant);
    tcase_add_test(tc, numbers_that_make_no_path_are_refused);
}
