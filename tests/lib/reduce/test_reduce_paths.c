/* test_reduce_paths.c: reduced models against the full network, on paths of which they have no snapshots. */
/* link: -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc */
#define _POSIX_C_SOURCE 200809L
#include "reduce_make.h"

/* ---- allocations, counted where the library asks for them ---- */

void *__real_malloc(size_t size);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *old, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *old, size_t size);

static size_t allocations;

void *__wrap_malloc(size_t size) {
    allocations++;
    return __real_malloc(size);
}

void *__wrap_calloc(size_t n, size_t size) {
    allocations++;
    return __real_calloc(n, size);
}

void *__wrap_realloc(void *old, size_t size) {
    allocations++;
    return __real_realloc(old, size);
}

/* ---- tests ---- */

/* A model of paths, its bound from held-out ones, and its error on one that it has never seen. */
static void check_unseen(palp_reduced *reduced, const palp_snapshots *unseen, double most) {
    palp_reduced_summary s = palp_reduced_describe(reduced);
    palp_reduce_error error;
    ck_assert_uint_lt(10 * s.modes, s.unknowns);
    ck_assert_uint_lt(3 * s.elements, s.network_elements);
    ck_assert_double_gt(s.bound, 0.0);
    ck_assert_double_lt(s.bound, 2.5 * most);
    ck_assert_int_eq(palp_reduced_compare(reduced, unseen, &error), PALP_OK);
    ck_assert_double_gt(error.peak_N, 0.1);
    ck_assert_double_lt(error.worst_N, s.bound * error.peak_N);
    ck_assert_double_lt(error.worst_N, most * error.peak_N);
    ck_assert_double_lt(error.rms_N, error.worst_N);
}

START_TEST(plate_on_paths_held_out) {
    palp_material m = quartic(2);
    palp_network *net = cube_network(6, &m, NULL);
    palp_snapshots *paths[] = {press(net, 0.0048, 0.024, 1.0), press(net, 0.003, 0.006, 2.0),
                               press(net, 0.0055, 0.05, 0.5),  press(net, 0.004, 0.012, 1.0),
                               press(net, 0.0052, 0.04, 0.7),  press(net, 0.0045, 0.02, 0.4)};
    palp_reduce_settings settings = palp_reduce_settings_default();
    palp_reduced *reduced = reduce(net, 3, paths, 2, paths + 3, &settings);
    check_unseen(reduced, paths[5], 0.005);
    palp_reduced_free(reduced);
    free_all(6, paths);
    palp_network_free(net);
}
END_TEST

START_TEST(tool_on_paths_held_out) {
    const double near = 0.009, mid = 0.012, far = 0.015, depth = 0.001;
    palp_material m = quartic(1);
    palp_network *net = block(7, &m);
    palp_snapshots *paths[] = {slide(net, near, near, far, near, depth),
                               slide(net, far, mid, near, mid, 0.9 * depth),
                               slide(net, near, far, far, far, depth),
                               slide(net, near, far, near, near, depth),
                               slide(net, mid, near, mid, far, 0.8 * depth),
                               slide(net, far, far, far, near, depth),
                               slide(net, near, near, far, far, 0.9 * depth),
                               slide(net, far, near, near, far, 0.95 * depth),
                               slide(net, 0.010, near, 0.014, 0.014, 0.85 * depth)};
    palp_reduce_settings settings = palp_reduce_settings_default();
    settings.elements = 400;
    settings.element_tolerance = 1e-2;
    palp_reduced *reduced = reduce(net, 6, paths, 2, paths + 6, &settings);
    check_unseen(reduced, paths[8], 0.01);
    palp_reduced_free(reduced);
    free_all(9, paths);
    palp_network_free(net);
}
END_TEST

/* Outside of its snapshots a model says so, and expects more error. */
START_TEST(knows_its_range) {
    palp_material m = quartic(1);
    palp_network *net = cube_network(5, &m, NULL);
    palp_snapshots *paths[] = {press(net, 0.002, 0.01, 0.5), press(net, 0.0015, 0.02, 0.5)};
    palp_reduce_settings settings = palp_reduce_settings_default();
    settings.elements = 400;
    palp_reduced *reduced = reduce(net, 1, paths, 1, paths + 1, &settings);
    palp_reduced_info in, out;
    ck_assert_int_eq(palp_reduced_step(reduced, 0.001, 0, NULL, 0.1, NULL, &in), PALP_OK);
    ck_assert_int_eq(palp_reduced_step(reduced, 0.004, 0, NULL, 0.3, NULL, &out), PALP_OK);
    ck_assert_double_lt(in.outside, 0.1);
    ck_assert_double_ge(out.outside, 1.0); /* as far again as the 2 mm of the snapshots */
    double floor_N = palp_reduced_describe(reduced).held_out_peak_N,
           bound = palp_reduced_describe(reduced).bound;
    ck_assert_double_gt(floor_N, 0.1);
    ck_assert_double_ge(in.force_error_N,
                        bound * floor_N); /* also at a force below that of the held-out path */
    ck_assert_double_gt(out.force_error_N, 1.9 * bound * out.force_N);
    palp_reduced_free(reduced);
    free_all(2, paths);
    palp_network_free(net);
}
END_TEST

START_TEST(same_bits_no_allocation_no_trace) {
    palp_network *net;
    palp_reduced *reduced = under_a_ball(&net);
    palp_tool_force force, again[30];
    palp_reduced_info info;
    for (int i = 0; i < 30; i++)
        ck_assert_int_eq(tick(reduced, i, &again[i], NULL), PALP_OK);
    ck_assert_double_gt(again[29].force_N[1], 0.01);
    palp_reduced_reset(reduced);
    size_t taken = 0;
    for (int i = 0; i < 30; i++) {
        palp_tool wrong = ball(0.012, 0.012, 0.0);
        wrong.radius_m = -1.0;
        ck_assert_int_eq(palp_reduced_step(reduced, NAN, 0, NULL, 0.001, NULL, NULL), PALP_ERR_ARGUMENT);
        ck_assert_int_eq(palp_reduced_step(reduced, 0.0, 0, NULL, -1.0, NULL, NULL), PALP_ERR_ARGUMENT);
        ck_assert_int_eq(palp_reduced_step(reduced, 0.0, 2, &wrong, 0.001, NULL, NULL), PALP_ERR_ARGUMENT);
        ck_assert_int_eq(palp_reduced_step(reduced, 0.0, 1, &wrong, 0.001, NULL, NULL), PALP_ERR_ARGUMENT);
        size_t before = allocations;
        palp_status status = tick(reduced, i, &force, &info);
        taken += allocations - before;
        ck_assert_int_eq(status, PALP_OK);
        ck_assert(info.converged);
        ck_assert(memcmp(force.force_N, again[i].force_N, sizeof force.force_N) == 0);
    }
    ck_assert_uint_eq(taken, 0);
    palp_reduced_free(reduced);
    palp_network_free(net);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, plate_on_paths_held_out);
    tcase_add_test(tc, tool_on_paths_held_out);
    tcase_add_test(tc, knows_its_range);
    tcase_add_test(tc, same_bits_no_allocation_no_trace);
}
