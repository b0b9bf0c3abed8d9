/* test_realtime.c: stepping within a budget: against palp_network_step, its own error estimate, and to the
 * bit. */
#define _POSIX_C_SOURCE 200809L
#include "realtime_make.h"

#include <pthread.h>

static palp_realtime *realtime_cube(size_t n, const palp_material *m, bool background) {
    return realtime_on(cube_network(n, m, NULL), background);
}

/* Depth of a tick: a ramp, a dwell, then to and fro; up to a fifth of the height. */
static double path_depth(size_t tick) {
    double t = (double)tick;
    if (tick < 60)
        return 0.15 * HEIGHT * t / 60.0;
    if (tick < 80)
        return 0.15 * HEIGHT;
    return (0.15 + 0.03 * sin(0.07 * (t - 80.0)) + 0.02 * sin(0.23 * (t - 80.0))) * HEIGHT;
}

static double largest_difference(const double *a, const double *b, size_t n) {
    double most = 0.0;
    for (size_t i = 0; i < n; i++)
        most = fmax(most, fabs(a[i] - b[i]));
    return most;
}

static void compare_with_step(size_t n, const palp_material *m) {
    palp_realtime *net = realtime_cube(n, m, false);
    palp_network *reference = cube_network(n, m, NULL);
    size_t n3 = 3 * node_count(net_of(net));
    for (size_t i = 1; i<TICKS; i += n> 7 ? 4 : 1) {
        palp_tick_info info;
        ck_assert_int_eq(palp_realtime_step(net, path_depth(i), DT, &ALL, &info), PALP_OK);
        ck_assert_int_eq(palp_network_step(reference, path_depth(i), DT, NULL), PALP_OK);
        ck_assert(info.converged);
        ck_assert_double_le(info.residual, 1e-10);
        double force = palp_network_force(reference);
        ck_assert_double_eq_tol(info.force_N, force, 1e-8 * fabs(force));
        ck_assert_double_eq(info.force_N, palp_network_force(net_of(net)));
        ck_assert_double_le(
            largest_difference(palp_network_positions(net_of(net)), palp_network_positions(reference), n3),
            1e-9 * HEIGHT);
    }
    drop(net);
    palp_network_free(reference);
}

START_TEST(converged_is_a_step) {
    palp_material m = material_of(_i);
    compare_with_step(5, &m);
}
END_TEST

START_TEST(converged_is_a_step_with_levels) {
    palp_material m = quartic(2);
    compare_with_step(10, &m);
}
END_TEST

/* What the energy is must follow from the work done: elastic, quasi-static. */
START_TEST(energy_is_the_work) {
    palp_material m = quartic(0);
    palp_realtime *net = realtime_cube(5, &m, false);
    palp_tick_info info;
    double work = 0.0, before = 0.0;
    for (size_t i = 1; i <= 100; i++) {
        ck_assert_int_eq(palp_realtime_step(net, 0.002 * HEIGHT * (double)i, DT, &ALL, &info), PALP_OK);
        work += 0.5 * (before + info.force_N) * 0.002 * HEIGHT;
        before = info.force_N;
    }
    ck_assert_double_eq_tol(palp_realtime_energy(net), work, 1e-4 * work);
    drop(net);
}
END_TEST

/* With few corrections the force stays near the converged one, and the estimate says how near. */
static void check_estimate(size_t n, size_t corrections, double most) {
    palp_material m = quartic(2);
    palp_realtime *net = realtime_cube(n, &m, false), *reference = realtime_cube(n, &m, false);
    palp_budget budget = {.corrections = corrections};
    double peak = 0.0, worst = 0.0, errors = 0.0, estimates = 0.0;
    for (size_t i = 1; i < TICKS; i++) {
        palp_tick_info info, truth;
        ck_assert_int_eq(palp_realtime_step(net, path_depth(i), DT, &budget, &info), PALP_OK);
        ck_assert_int_eq(palp_realtime_step(reference, path_depth(i), DT, &ALL, &truth), PALP_OK);
        ck_assert_uint_le(info.corrections, corrections);
        peak = fmax(peak, fabs(truth.force_N));
        double error = fabs(info.force_N - truth.force_N);
        worst = fmax(worst, error);
        ck_assert_msg(error <= info.force_error_N + 1e-9 * peak, "tick %zu: error %g, estimate %g", i, error,
                      info.force_error_N);
        errors += error;
        estimates += info.force_error_N;
    }
    ck_assert_double_le(worst, most * peak);
    ck_assert_double_le(estimates, 1000.0 * errors + 1e-9 * peak * TICKS);
    drop(net);
    drop(reference);
}

START_TEST(estimate_brackets_the_error) {
    check_estimate(5, 1, 1e-4);
    check_estimate(7, 1, 1e-4);
    check_estimate(10, 1, 1e-4);
}
END_TEST

/* A force error asked for is kept. */
START_TEST(error_budget_is_kept) {
    palp_material m = quartic(2);
    palp_realtime *net = realtime_cube(7, &m, false), *reference = realtime_cube(7, &m, false);
    palp_budget budget = {.force_error = 1e-3};
    size_t corrections = 0, all = 0;
    for (size_t i = 1; i < TICKS; i++) {
        palp_tick_info info, truth;
        ck_assert_int_eq(palp_realtime_step(net, path_depth(i), DT, &budget, &info), PALP_OK);
        ck_assert_int_eq(palp_realtime_step(reference, path_depth(i), DT, &ALL, &truth), PALP_OK);
        ck_assert(info.converged);
        ck_assert_double_eq_tol(info.force_N, truth.force_N, 2e-3 * fabs(truth.force_N));
        corrections += info.corrections;
        all += truth.corrections;
    }
    ck_assert_uint_lt(corrections, all);
    drop(net);
    drop(reference);
}
END_TEST

/* ---- to the bit ---- */

typedef struct follower {
    size_t nodes, corrections;
    snapshot end;
} follower;

static void follow(palp_realtime *rt, size_t from, size_t to, size_t corrections) {
    palp_budget budget = {.corrections = corrections};
    for (size_t i = from; i < to; i++)
        ck_assert_int_eq(palp_realtime_step(rt, path_depth(i), DT, &budget, NULL), PALP_OK);
}

static void *follow_path(void *user) {
    follower *f = user;
    palp_material m = quartic(2);
    palp_realtime *net = realtime_cube(f->nodes, &m, false);
    follow(net, 1, TICKS, f->corrections);
    f->end = snapshot_take(net_of(net));
    drop(net);
    return NULL;
}

/* Alone, again, and two at a time in threads of their own. */
START_TEST(same_bits_whoever_runs) {
    const size_t nodes[] = {5, 10};
    for (size_t k = 0; k < 2; k++) {
        follower f[4] = {{nodes[k], 1, {0}}, {nodes[k], 1, {0}}, {nodes[k], 1, {0}}, {nodes[k], 1, {0}}};
        pthread_t thread[2];
        follow_path(&f[0]);
        follow_path(&f[1]);
        for (size_t i = 0; i < 2; i++)
            ck_assert_int_eq(pthread_create(&thread[i], NULL, follow_path, &f[2 + i]), 0);
        for (size_t i = 0; i < 2; i++)
            ck_assert_int_eq(pthread_join(thread[i], NULL), 0);
        for (size_t i = 1; i < 4; i++)
            ck_assert(snapshot_same(&f[0].end, &f[i].end));
        for (size_t i = 0; i < 4; i++)
            snapshot_free(&f[i].end);
    }
}
END_TEST

/* Saved at any tick, the same network or another one goes on to the same bits. */
static void check_restore(size_t n, size_t at) {
    palp_material m = quartic(2);
    palp_realtime *net = realtime_cube(n, &m, false), *other = realtime_cube(n, &m, false);
    size_t size = palp_realtime_state_size(net);
    void *saved = malloc(size);
    ck_assert_ptr_nonnull(saved);
    follow(net, 1, at, 1);
    snapshot then = snapshot_take(net_of(net));
    ck_assert_int_eq(palp_realtime_save(net, saved, size), PALP_OK);
    follow(net, at, TICKS, 1);
    snapshot end = snapshot_take(net_of(net));
    follow(other, 1, 9, 2); /* elsewhere */
    palp_realtime *restored[] = {net, other};
    for (size_t i = 0; i < 2; i++) {
        ck_assert_int_eq(palp_realtime_restore(restored[i], saved, size), PALP_OK);
        ck_assert(still_at(net_of(restored[i]), &then));
        follow(restored[i], at, TICKS, 1);
        ck_assert_msg(still_at(net_of(restored[i]), &end), "%zu nodes a side, saved at %zu", n, at);
    }
    snapshot_free(&then);
    snapshot_free(&end);
    free(saved);
    drop(net);
    drop(other);
}

START_TEST(restored_goes_on_the_same) {
    const size_t at[] = {2, 17, 18, 19, 20, 64, 100};
    for (size_t i = 0; i < sizeof at / sizeof *at; i++)
        check_restore(6, at[i]);
    check_restore(10, 30);
    check_restore(10, 59);
}
END_TEST

/* A step that went wrong is taken back by what was saved of the network alone: the factor stays. */
START_TEST(network_restored) {
    palp_material m = quartic(2);
    palp_realtime *rt = realtime_cube(5, &m, false), *straight = realtime_cube(5, &m, false);
    const size_t size = palp_network_state_size(net_of(rt));
    void *saved = malloc(size);
    ck_assert_ptr_nonnull(saved);
    follow(rt, 1, 40, 1);
    snapshot before = snapshot_take(net_of(rt));
    ck_assert_int_eq(palp_network_save(net_of(rt), saved, size), PALP_OK);
    ck_assert_int_eq(palp_realtime_step(rt, 0.3 * HEIGHT, DT, &ALL, NULL), PALP_OK);
    ck_assert(!still_at(net_of(rt), &before));
    ck_assert_int_eq(palp_network_restore(net_of(rt), saved, size), PALP_OK);
    ck_assert(still_at(net_of(rt), &before));
    palp_tick_info a, b;
    follow(straight, 1, 40, 1);
    ck_assert_int_eq(palp_realtime_step(rt, path_depth(40), DT, &ALL, &a), PALP_OK);
    ck_assert_int_eq(palp_realtime_step(straight, path_depth(40), DT, &ALL, &b), PALP_OK);
    ck_assert_double_eq_tol(a.force_N, b.force_N, 1e-9 * fabs(b.force_N));
    snapshot_free(&before);
    free(saved);
    drop(rt);
    drop(straight);
}
END_TEST

/* A plain step too, with what the predictor knows. */
START_TEST(plain_step_restored) {
    palp_material m = quartic(1);
    palp_network *net = cube_network(4, &m, NULL), *straight = cube_network(4, &m, NULL);
    const size_t size = palp_network_state_size(net);
    void *saved = malloc(size);
    ck_assert_ptr_nonnull(saved);
    for (size_t i = 1; i < 6; i++) {
        ck_assert_int_eq(palp_network_save(net, saved, size), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, path_depth(i) + 1e-4, DT, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_restore(net, saved, size), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, path_depth(i), DT, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_step(straight, path_depth(i), DT, NULL), PALP_OK);
    }
    ck_assert_double_eq_tol(palp_network_force(net), palp_network_force(straight),
                            1e-9 * palp_network_force(straight));
    free(saved);
    palp_network_free(net);
    palp_network_free(straight);
}
END_TEST

/* ---- a thread of its own ---- */

START_TEST(background_factor) {
    palp_material m = quartic(2);
    palp_realtime *net = realtime_cube(10, &m, true), *alone = realtime_cube(10, &m, false);
    palp_budget budget = {.corrections = 2};
    size_t refreshed = 0;
    for (size_t i = 1; i < TICKS; i++) {
        palp_tick_info a, b;
        ck_assert_int_eq(palp_realtime_step(net, path_depth(i), DT, &budget, &a), PALP_OK);
        ck_assert_int_eq(palp_realtime_step(alone, path_depth(i), DT, &budget, &b), PALP_OK);
        ck_assert_double_eq_tol(a.force_N, b.force_N, 1e-6 * fabs(b.force_N));
        refreshed += a.refreshed;
    }
    ck_assert_uint_gt(refreshed, 0);
    drop(net);
    drop(alone);
}
END_TEST

/* ---- hard cases ---- */

/* With mass: settles to the massless force. */
START_TEST(mass_settles) {
    palp_material m = quartic(0);
    palp_network_settings settings = palp_network_settings_default();
    settings.density_kg_m3 = 1070.0;
    palp_realtime *net = realtime_on(cube_network(6, &m, &settings), false);
    palp_network *massless = cube_network(6, &m, NULL);
    palp_tick_info info;
    palp_budget budget = {.corrections = 2};
    for (size_t i = 1; i <= 600; i++) {
        double depth = 0.1 * HEIGHT * fmin(1.0, (double)i / 300.0);
        ck_assert_int_eq(palp_realtime_step(net, depth, 1e-3, &budget, &info), PALP_OK);
    }
    ck_assert_int_eq(palp_network_step(massless, 0.1 * HEIGHT, 1.0, NULL), PALP_OK);
    ck_assert_double_eq_tol(info.force_N, palp_network_force(massless), 1e-5 * info.force_N);
    drop(net);
    palp_network_free(massless);
}
END_TEST

/* Far past where the tangent is definite: every tick ends, nothing blows up, the force stays that of such a
 * press. */
START_TEST(past_buckling) {
    palp_material m = quartic(2);
    palp_realtime *net = realtime_cube(9, &m, false);
    palp_budget budget = {.corrections = 2};
    for (size_t i = 1; i <= 400; i++) {
        palp_tick_info info;
        ck_assert_int_eq(palp_realtime_step(net, 0.45 * HEIGHT * (double)i / 400.0, DT, &budget, &info),
                         PALP_OK);
        ck_assert(isfinite(info.force_N) && isfinite(palp_realtime_energy(net)) &&
                  isfinite(info.force_error_N));
        ck_assert_double_lt(fabs(info.force_N), 500.0);
    }
    drop(net);
}
END_TEST

/* A jump no predictor foresaw, within one tick and worked off over some. */
START_TEST(jump) {
    palp_material m = quartic(0);
    palp_realtime *net = realtime_cube(10, &m, false), *reference = realtime_cube(10, &m, false);
    palp_budget budget = {.corrections = 2};
    palp_tick_info info, truth;
    for (size_t i = 0; i < 12; i++)
        ck_assert_int_eq(palp_realtime_step(net, 0.1 * HEIGHT, DT, &budget, &info), PALP_OK);
    ck_assert_int_eq(palp_realtime_step(reference, 0.1 * HEIGHT, DT, &ALL, &truth), PALP_OK);
    ck_assert(truth.converged);
    ck_assert_double_eq_tol(info.force_N, truth.force_N, 1e-7 * truth.force_N);
    drop(net);
    drop(reference);
}
END_TEST

/* Tetrahedra from a file: no lattice for the levels to fit. */
START_TEST(unordered_mesh) {
    palp_mesh *mesh = NULL;
    palp_material m = quartic(2);
    palp_network_settings settings = palp_network_settings_default();
    ck_assert_int_eq(palp_mesh_read_gmsh("data/meshes/cylinder_tetra.msh", 1e-3, false, &mesh, NULL),
                     PALP_OK);
    palp_realtime *net = realtime_on(network_on(mesh, &m, &settings), false);
    palp_network *reference = network_on(mesh, &m, &settings);
    palp_mesh_free(mesh);
    for (size_t i = 1; i <= 20; i++) {
        palp_tick_info info;
        ck_assert_int_eq(palp_realtime_step(net, 5e-5 * (double)i, DT, &ALL, &info), PALP_OK);
        ck_assert_int_eq(palp_network_step(reference, 5e-5 * (double)i, DT, NULL), PALP_OK);
        ck_assert(info.converged);
        ck_assert_double_eq_tol(info.force_N, palp_network_force(reference), 1e-7 * fabs(info.force_N));
    }
    drop(net);
    palp_network_free(reference);
}
END_TEST

/* ---- tools ---- */

/* Reset is as good as new, and so is a network that was reset behind its back. */
START_TEST(reset_is_new) {
    palp_material m = quartic(2);
    palp_realtime *fresh = realtime_cube(10, &m, false);
    follow(fresh, 1, 60, 1);
    snapshot s = snapshot_take(net_of(fresh));
    for (int behind = 0; behind < 2; behind++) {
        palp_realtime *rt = realtime_cube(10, &m, false);
        follow(rt, 1, 50, 1);
        if (behind)
            palp_network_reset(net_of(rt));
        else
            ck_assert_int_eq(palp_realtime_reset(rt), PALP_OK);
        follow(rt, 1, 60, 1);
        ck_assert(still_at(net_of(rt), &s));
        drop(rt);
    }
    snapshot_free(&s);
    drop(fresh);
}
END_TEST

START_TEST(refused) {
    palp_material m = quartic(1);
    palp_network *net = cube_network(3, &m, NULL);
    palp_realtime *rt = NULL, *bigger = realtime_cube(4, &m, false);
    palp_realtime_settings settings = palp_realtime_settings_default();
    const double bad_share[] = {0.0, 1.0, -0.1, NAN};
    for (size_t i = 0; i < 4; i++) {
        settings.refresh_share = bad_share[i];
        ck_assert_int_eq(palp_realtime_create(net, &settings, &rt), PALP_ERR_ARGUMENT);
    }
    rt = realtime_on(net, false);
    palp_realtime *second = NULL;
    settings = palp_realtime_settings_default();
    ck_assert_int_eq(palp_realtime_create(net, &settings, &second), PALP_ERR_ARGUMENT);
    palp_realtime_free(rt);
    rt = realtime_on(net, false); /* one after the other */
    follow(rt, 1, 5, 1);
    const double bad[] = {NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < 3; i++) {
        palp_budget budget = {.seconds = i == 2 ? -1.0 : NAN}, other = {.force_error = i == 2 ? -1.0 : NAN};
        ck_assert_int_eq(palp_realtime_step(rt, bad[i], DT, &ALL, NULL), PALP_ERR_ARGUMENT);
        ck_assert_int_eq(palp_realtime_step(rt, 1e-3, i == 1 ? -1e-3 : NAN, &ALL, NULL), PALP_ERR_ARGUMENT);
        ck_assert_int_eq(palp_realtime_step(rt, 1e-3, DT, &budget, NULL), PALP_ERR_ARGUMENT);
        ck_assert_int_eq(palp_realtime_step(rt, 1e-3, DT, &other, NULL), PALP_ERR_ARGUMENT);
    }
    ck_assert_int_eq(palp_realtime_step(rt, 2.0 * HEIGHT, DT, &ALL, NULL) != PALP_OK ||
                         isfinite(palp_network_force(net)),
                     1);
    size_t size = palp_realtime_state_size(rt), plain = palp_network_state_size(net);
    void *saved = malloc(size);
    ck_assert_ptr_nonnull(saved);
    ck_assert_int_eq(palp_realtime_save(rt, saved, size - 1), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_realtime_save(rt, NULL, size), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_realtime_save(rt, saved, size), PALP_OK);
    ck_assert_int_eq(palp_network_restore(net, saved, size), PALP_ERR_ARGUMENT); /* another kind */
    ck_assert_int_eq(palp_realtime_restore(bigger, saved, size), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_realtime_restore(rt, saved, size - 1), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_realtime_restore(rt, NULL, size), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_realtime_restore(rt, saved, size), PALP_OK);
    for (size_t i = 0; i < size; i += 1 + i / 8) { /* a bit turned over */
        ((unsigned char *)saved)[i] ^= 4;
        ck_assert_int_ne(palp_realtime_restore(rt, saved, size), PALP_OK);
        ((unsigned char *)saved)[i] ^= 4;
    }
    ((unsigned char *)saved)[size - 1] ^= 4;
    ck_assert_int_eq(palp_realtime_restore(rt, saved, size), PALP_ERR_INPUT);
    ((unsigned char *)saved)[size - 1] ^= 4;
    ck_assert_int_eq(palp_realtime_restore(rt, saved, size), PALP_OK);
    ck_assert_int_eq(palp_network_save(net, saved, plain - 1), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_save(net, NULL, plain), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_save(net, saved, plain), PALP_OK);
    ck_assert_int_eq(palp_realtime_restore(rt, saved, size), PALP_ERR_ARGUMENT); /* another kind */
    ck_assert_int_eq(palp_network_restore(net_of(bigger), saved, plain), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_restore(net, saved, plain - 1), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_restore(net, saved, plain), PALP_OK);
    free(saved);
    drop(rt);
    drop(bigger);
}
END_TEST

/* What PALP_SEDEF2008 carries from the last step as a vector is in an element's force along its direction, as
 * that now is. */
START_TEST(carried_force_is_along_the_element) {
    palp_network_settings settings = palp_network_settings_default();
    palp_material m = quartic(1);
    m.formulation = PALP_SEDEF2008;
    palp_network *net = cube_network(5, &m, &settings), *other = cube_network(5, &m, &settings);
    palp_realtime *rt = realtime_on(net, false);
    const size_t n = palp_mesh_element_count(palp_network_mesh(net));
    double *force = calloc(2 * n, sizeof *force);
    ck_assert(force != NULL);
    for (int i = 1; i <= 20; i++) {
        ck_assert_int_eq(palp_realtime_step(rt, 2e-4 * i, DT, &ALL, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_step(other, 2e-4 * i, DT, NULL), PALP_OK);
    }
    palp_network_element_force(net, force);
    palp_network_element_force(other, force + n);
    for (size_t i = 0; i < n; i++)
        ck_assert_double_eq_tol(force[i], force[n + i], 1e-9);
    free(force);
    palp_network_free(other);
    drop(rt);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, carried_force_is_along_the_element);
    tcase_add_loop_test(tc, converged_is_a_step, 0, KINDS);
    tcase_add_test(tc, converged_is_a_step_with_levels);
    tcase_add_test(tc, energy_is_the_work);
    tcase_add_test(tc, estimate_brackets_the_error);
    tcase_add_test(tc, error_budget_is_kept);
    tcase_add_test(tc, same_bits_whoever_runs);
    tcase_add_test(tc, restored_goes_on_the_same);
    tcase_add_test(tc, reset_is_new);
    tcase_add_test(tc, network_restored);
    tcase_add_test(tc, plain_step_restored);
    tcase_add_test(tc, background_factor);
    tcase_add_test(tc, mass_settles);
    tcase_add_test(tc, past_buckling);
    tcase_add_test(tc, jump);
    tcase_add_test(tc, unordered_mesh);
    tcase_add_test(tc, refused);
}
