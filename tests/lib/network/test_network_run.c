/* test_network_run.c: networks that follow a path: steps of both kinds, creep and cycles. */
#include "network_run_make.h"

#include <palpate/closed_form.h>

/* ---- steps --------------------------------------------------------------------------------------- */

START_TEST(fixed_steps_visit_every_corner) {
    palp_material m = quartic(1);
    palp_network *net = cube_network(3, &m, NULL);
    palp_run_settings settings = recording(0.3, 0.0);
    palp_run_info info = run_path(net, ramp_hold(0.1, 1.0, 2.0), &settings);
    ck_assert_uint_eq(info.steps, 4 + 7); /* of 0.25 and of 2/7 s */
    ck_assert_uint_eq(info.rejected, 0);
    ck_assert_uint_ge(info.iterations, 11);
    ck_assert_double_le(info.worst_residual, 1e-10);
    ck_assert_uint_eq(seen.n, 12);
    double peak = 0.0;
    for (size_t i = 0; i < seen.n; i++) {
        ck_assert_double_eq_tol(seen.time[i], i <= 4 ? 0.25 * (double)i : 1.0 + (double)(i - 4) * 2.0 / 7.0,
                                1e-14);
        ck_assert_double_eq_tol(seen.depth[i], 0.1 * HEIGHT * fmin(1.0, seen.time[i]), 1e-16);
        peak = fmax(peak, seen.force[i]);
    }
    ck_assert_double_eq(seen.time[4], 1.0);
    ck_assert_double_eq(seen.time[11], 3.0);
    ck_assert_double_eq(info.peak_force_N, peak);
    ck_assert_double_eq(peak, seen.force[4]);
    ck_assert_double_eq_tol(palp_network_time(net), 3.0, 1e-14);
    palp_network_free(net);
}
END_TEST

/* A run that goes on from a saved state makes the steps that remain, to the bit. */
START_TEST(a_restored_network_goes_on) {
    enum { STOP = 6 };
    palp_material m = quartic(1);
    palp_network *net = cube_network(3, &m, NULL), *other = cube_network(3, &m, NULL);
    palp_run_settings settings = recording(0.3, 0.0);
    run_path(net, ramp_hold(0.1, 1.0, 2.0), &settings);
    const size_t all = seen.n, size = palp_network_state_size(net);
    double *force = malloc(all * sizeof *force);
    memcpy(force, seen.force, all * sizeof *force);
    void *state = malloc(size);
    palp_path path = ramp_hold(0.1, 1.0, 2.0);
    palp_network_reset(net);
    settings = recording(0.3, 0.0);
    seen.stop_after = STOP;
    ck_assert_int_eq(palp_network_run(net, &path, &settings, NULL), PALP_ERR_STOPPED);
    palp_path_free(&path);
    ck_assert_int_eq(palp_network_save(net, state, size), PALP_OK);
    ck_assert_int_eq(palp_network_restore(other, state, size), PALP_OK);
    const double from = seen.time[STOP - 1];
    settings = recording(0.3, 0.0);
    settings.from_s = from;
    palp_run_info info = run_path(other, ramp_hold(0.1, 1.0, 2.0), &settings);
    ck_assert_uint_eq(seen.n, all - STOP);
    ck_assert_uint_eq(info.steps, all - STOP);
    for (size_t i = 0; i < seen.n; i++)
        ck_assert_double_eq(seen.force[i], force[STOP + i]);
    settings.tolerance = 1e-4; /* whose steps depend on those before */
    path = ramp_hold(0.1, 1.0, 2.0);
    ck_assert_int_eq(palp_network_run(other, &path, &settings, NULL), PALP_ERR_ARGUMENT);
    palp_path_free(&path);
    free(force);
    free(state);
    palp_network_free(net);
    palp_network_free(other);
}
END_TEST

/* Forces at the end of a ramp of 1 s and of a hold of 10 s. */
static palp_run_info ends(palp_network *net, double dt, double tolerance, double force[2]) {
    palp_run_settings settings = recording(dt, tolerance);
    palp_network_reset(net);
    palp_run_info info = run_path(net, ramp_hold(0.3, 1.0, 10.0), &settings);
    for (size_t i = 1; i < seen.n; i++) {
        if (!(seen.time[i] > seen.time[i - 1]))
            ck_abort_msg("time stands still at step %zu", i);
        if (seen.time[i] == 1.0)
            force[0] = seen.force[i];
    }
    force[1] = seen.force[seen.n - 1];
    return info;
}

START_TEST(controlled_steps_agree_with_small_fixed_ones) {
    palp_material m = quartic(2);
    m.arms[0].beta = 3.0;
    m.arms[1].gamma = 2.0;
    palp_network *net = cube_network(3, &m, NULL);
    double coarse[2], fine[2], got[2];
    ends(net, 4e-3, 0.0, coarse);
    ends(net, 2e-3, 0.0, fine);
    for (double tolerance = 1e-4; tolerance > 5e-9; tolerance *= 0.1) {
        palp_run_info info = ends(net, 0.0, tolerance, got);
        ck_assert_uint_eq(info.steps, 2 * (seen.n - 1));
        ck_assert_uint_lt(info.steps, 2500);
        for (size_t i = 0; i < 2; i++) { /* the errors of the steps fade, but add up at worst */
            double want = fine[i] + (fine[i] - coarse[i]) / 3.0,
                   off = fabs(got[i] - want) / info.peak_force_N;
            ck_assert_msg(off < 30.0 * tolerance, "tolerance %g: error %g", tolerance, off);
        }
    }
    palp_network_free(net);
}
END_TEST

START_TEST(second_order_in_dt) {
    palp_material m = quartic(3);
    m.arms[0].beta = 3.0;
    m.arms[1].gamma = 2.0;
    palp_network *net = cube_network(3, &m, NULL);
    double force[5];
    for (int k = 0; k < 5; k++) {
        palp_network_reset(net);
        palp_run_settings settings = recording(0.02 / (1 << k), 0.0);
        run_path(net, ramp_hold(0.3, 1.0, 0.5), &settings);
        force[k] = palp_network_force(net);
    }
    for (int k = 0; k < 3; k++) {
        double ratio = (force[k] - force[k + 1]) / (force[k + 1] - force[k + 2]);
        ck_assert_msg(ratio > 3.7 && ratio < 4.3, "differences fall by %g", ratio);
    }
    palp_network_free(net);
}
END_TEST

START_TEST(relaxed_runs_are_static) {
    palp_material m = quartic(2); /* arms that must not show */
    palp_network *net = cube_network(3, &m, NULL);
    palp_path path;
    palp_run_settings settings = recording(1.0, 0.0);
    settings.relaxed = true;
    ck_assert_int_eq(palp_path_static(0.3 * HEIGHT, 0.3 * HEIGHT / 30.0, &path), PALP_OK);
    run_path(net, path, &settings);
    ck_assert_uint_eq(seen.n, 31);
    ck_assert_double_eq_tol(seen.force[10], 0.851966, 1e-6);
    ck_assert_double_eq_tol(seen.force[20], 1.831668, 1e-6);
    ck_assert_double_eq_tol(seen.force[30], 2.961096, 1e-6);
    palp_network_reset(net);
    settings = recording(0.0, 1e-6);
    settings.relaxed = true;
    ck_assert_int_eq(palp_path_static(0.3 * HEIGHT, 0.3 * HEIGHT / 30.0, &path), PALP_OK);
    run_path(net, path, &settings);
    ck_assert_double_eq_tol(seen.force[seen.n - 1], 2.961096, 1e-6);
    palp_network_free(net);
}
END_TEST

START_TEST(controlled_steps_locate_buckling) {
    palp_material m = quartic(0);
    palp_network *net = cube_network(5, &m, NULL);
    palp_run_settings settings = recording(0.0, 1e-3);
    double stable, unstable;
    palp_path path;
    settings.relaxed = true;
    ck_assert_int_eq(palp_path_static(0.4 * HEIGHT, 0.001, &path), PALP_OK);
    run_path(net, path, &settings);
    ck_assert(palp_network_buckled(net, &stable, &unstable));
    ck_assert_double_ge(unstable, 0.325 * HEIGHT);
    ck_assert_double_le(stable, 0.33 * HEIGHT);
    ck_assert_double_le(unstable - stable, 1.0001 * palp_network_settings_default().check_strain * HEIGHT);
    ck_assert_double_eq_tol(palp_network_force(net), 13.264005, 1e-6);
    palp_network_free(net);
}
END_TEST

START_TEST(runs_start_where_the_network_is) {
    palp_material m = quartic(1), dashpot = quartic(0);
    dashpot.dashpot_Ns = 0.1;
    palp_network *net = cube_network(3, &m, NULL), *stepped = cube_network(3, &m, NULL),
                 *damped = cube_network(3, &dashpot, NULL);
    palp_run_settings settings = recording(0.1, 0.0);
    run_path(net, ramp_hold(0.1, 0.0, 1.0), &settings); /* starts at 0.1: at once */
    ck_assert_int_eq(palp_network_step(stepped, 0.1 * HEIGHT, 0.0, NULL), PALP_OK);
    ck_assert_double_eq(seen.force[0], palp_network_force(stepped));
    for (int i = 0; i < 10; i++)
        ck_assert_int_eq(palp_network_step(stepped, 0.1 * HEIGHT, 0.1, NULL), PALP_OK);
    ck_assert_double_eq_tol(palp_network_force(net), palp_network_force(stepped), 1e-12);
    palp_path path = ramp_hold(0.1, 0.0, 1.0);
    ck_assert_int_eq(palp_network_run(damped, &path, &settings, NULL),
                     PALP_ERR_ARGUMENT); /* infinite force */
    palp_path_free(&path);
    palp_network_free(net);
    palp_network_free(stepped);
    palp_network_free(damped);
}
END_TEST

/* ---- creep --------------------------------------------------------------------------------------- */

START_TEST(step_force_holds_the_force) {
    for (int mass = 0; mass < 2; mass++) {
        palp_material m = quartic(2);
        palp_network *net = mass ? heavy(2, PALP_BACKWARD_EULER) : cube_network(3, &m, NULL);
        palp_step_info info;
        double before = 0.0;
        for (int i = 1; i <= 30; i++) { /* raised in ten steps, held, and the specimen gives way */
            double force = 0.1 * fmin(i, 10);
            ck_assert_int_eq(palp_network_step_force(net, force, 0.1, &info), PALP_OK);
            ck_assert_double_eq_tol(palp_network_force(net), force, 1.1e-10 * force);
            ck_assert_double_eq(info.force_N, palp_network_force(net));
            ck_assert_int_lt(info.iterations, 40);
            ck_assert_double_gt(palp_network_depth(net), before);
            before = palp_network_depth(net);
        }
        ck_assert_double_eq_tol(palp_network_time(net), 3.0, 1e-12);
        palp_network_free(net);
    }
}
END_TEST

START_TEST(step_force_lets_go) {
    palp_material m = quartic(2);
    palp_network *net = cube_network(3, &m, NULL);
    ck_assert_int_eq(palp_network_step(net, 0.2 * HEIGHT, 1.0, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_step(net, 0.2 * HEIGHT, 5.0, NULL), PALP_OK);
    for (int i = 0; i < 20; i++) { /* no force: it creeps back from what the arms have kept */
        double before = palp_network_depth(net);
        ck_assert_int_eq(palp_network_step_force(net, 0.0, 1.0, NULL), PALP_OK);
        ck_assert_double_eq_tol(palp_network_force(net), 0.0, 1e-9);
        ck_assert_double_lt(palp_network_depth(net), before);
        ck_assert_double_gt(palp_network_depth(net), 0.0);
    }
    ck_assert_int_eq(palp_network_step_force(net, 0.0, INFINITY, NULL), PALP_OK);
    ck_assert_double_eq_tol(palp_network_depth(net), 0.0, 1e-9 * HEIGHT);
    palp_network_free(net);
}
END_TEST

START_TEST(failed_force_steps_leave_the_state) {
    palp_material m = quartic(2);
    palp_network *net = cube_network(3, &m, NULL);
    ck_assert_int_eq(palp_network_step(net, 0.1 * HEIGHT, 0.3, NULL), PALP_OK);
    snapshot before = snapshot_take(net);
    ck_assert_int_ne(palp_network_step_force(net, -1e9, 0.1, NULL), PALP_OK);
    ck_assert(still_at(net, &before));
    ck_assert_int_ne(palp_network_step_force(net, 1e300, 0.1, NULL), PALP_OK);
    ck_assert(still_at(net, &before));
    snapshot_free(&before);
    palp_network_free(net);
}
END_TEST

/* A column of linear springs and arms creeps as the closed form of the generalized Maxwell solid. */
START_TEST(creep_of_a_column) {
    palp_generalized_maxwell solid = {0.8, 2, {{0.4, 0.2}, {0.15, 3.0}}};
    palp_retardation spectrum;
    palp_material m = quartic(2);
    ck_assert_int_eq(palp_law_polynomial(1, (double[]){0.8}, &m.law), PALP_OK);
    ck_assert_int_eq(palp_retardation_spectrum(&solid, &spectrum), PALP_OK);
    for (int controlled = 0; controlled < 2; controlled++) {
        palp_network *net = column_of(3, &m);
        palp_path path;
        palp_run_settings settings = recording(controlled ? 0.0 : 0.01, controlled ? 1e-7 : 0.0);
        ck_assert_int_eq(palp_path_creep(0.2, 0.0, 20.0, &path), PALP_OK);
        run_path(net, path, &settings);
        for (size_t i = 0; i < seen.n; i++) {
            double want = HEIGHT * palp_generalized_maxwell_creep(&spectrum, 0.2, seen.time[i]);
            ck_assert_msg(fabs(seen.depth[i] - want) < 2e-5 * want, "t %g: %g not %g m", seen.time[i],
                          seen.depth[i], want);
            ck_assert_double_eq_tol(seen.force[i], 0.2, 1e-10);
        }
        palp_network_free(net);
    }
}
END_TEST

START_TEST(creep_ends_where_the_relaxed_network_is) {
    palp_material m = quartic(2);
    palp_network *net = cube_network(3, &m, NULL), *relaxed = cube_network(3, &m, NULL);
    palp_path path;
    palp_run_settings settings = recording(0.0, 1e-5);
    ck_assert_int_eq(palp_path_creep(1.0, 0.5, 3000.0, &path), PALP_OK);
    run_path(net, path, &settings);
    for (size_t i = 1; i < seen.n; i++) {
        ck_assert_double_eq_tol(seen.force[i], fmin(1.0, seen.time[i] / 0.5), 2e-10);
        ck_assert_double_ge(seen.depth[i], seen.depth[i - 1] - 1e-12);
    }
    ck_assert_int_eq(palp_network_step_force(relaxed, 1.0, INFINITY, NULL), PALP_OK);
    ck_assert_double_eq_tol(palp_network_depth(net), palp_network_depth(relaxed), 1e-7 * HEIGHT);
    palp_network_free(net);
    palp_network_free(relaxed);
}
END_TEST

/* ---- cycles -------------------------------------------------------------------------------------- */

START_TEST(elastic_cycles_close) {
    palp_material m = quartic(0);
    palp_network *net = cube_network(3, &m, NULL);
    palp_path path;
    palp_run_settings settings = recording(0.1, 0.0);
    ck_assert_int_eq(palp_path_cyclic(0.25 * HEIGHT, 0.25 * HEIGHT, 3, &path), PALP_OK);
    run_path(net, path, &settings);
    ck_assert_uint_eq(seen.n, 61);
    for (size_t i = 0; i <= 60; i++) { /* the same force in and out */
        size_t j = i % 20 <= 10 ? i % 20 : 20 - i % 20;
        ck_assert_double_eq_tol(seen.force[i], seen.force[j], 1e-9);
    }
    const double *x = palp_network_positions(net), *rest = palp_mesh_positions(palp_network_mesh(net));
    for (size_t i = 0; i < 3 * node_count(net); i++)
        ck_assert_double_eq_tol(x[i], rest[i], 1e-9 * HEIGHT);
    palp_network_free(net);
}
END_TEST

START_TEST(viscoelastic_cycles_settle_and_lose_energy) {
    palp_material m = quartic(1); /* tau 0.5 s */
    palp_network *net = cube_network(3, &m, NULL);
    palp_path path;
    palp_run_settings settings = recording(0.05, 0.0);
    ck_assert_int_eq(palp_path_cyclic(0.2 * HEIGHT, 0.2 * HEIGHT, 8, &path), PALP_OK);
    run_path(net, path, &settings);
    double work = 0.0;
    for (size_t i = 281; i <= 320; i++) {
        ck_assert_double_eq_tol(seen.force[i], seen.force[i - 40], 1e-8); /* settled */
        work += 0.5 * (seen.force[i] + seen.force[i - 1]) * (seen.depth[i] - seen.depth[i - 1]);
    }
    ck_assert_double_gt(work, 0.01 * seen.force[300] * 0.2 * HEIGHT);
    palp_network_free(net);
}
END_TEST

/* ---- stopping and failing ------------------------------------------------------------------------ */

START_TEST(observers_stop_a_run) {
    palp_material m = quartic(1);
    palp_network *net = cube_network(3, &m, NULL);
    for (int controlled = 0; controlled < 2; controlled++)
        for (size_t after = 1; after < 15; after += 4) {
            palp_run_settings settings = recording(controlled ? 0.0 : 0.05, controlled ? 1e-4 : 0.0);
            palp_path path = ramp_hold(0.2, 1.0, 1.0);
            palp_run_info info;
            palp_network_reset(net);
            seen.stop_after = after;
            ck_assert_int_eq(palp_network_run(net, &path, &settings, &info), PALP_ERR_STOPPED);
            ck_assert_uint_eq(seen.n, after);
            ck_assert_uint_eq(info.steps, (after - 1) * (controlled ? 2 : 1));
            ck_assert_double_eq(palp_network_depth(net), seen.depth[after - 1]);
            ck_assert_double_eq(palp_network_force(net), seen.force[after - 1]);
            ck_assert_double_eq_tol(palp_network_time(net), seen.time[after - 1], 1e-14);
            palp_path_free(&path);
        }
    palp_network_free(net);
}
END_TEST

/* A run that cannot go on gives a status and leaves the network at the last step that was seen. */
START_TEST(runs_that_fail_stay_at_the_last_step) {
    for (int controlled = 0; controlled < 2; controlled++)
        for (int creep = 0; creep < 2; creep++) {
            palp_material m = quartic(1); /* infinitely stiff at twice the length */
            ck_assert_int_eq(palp_law_hyperelastic(PALP_LAW_NEO_HOOKEAN, 1, (double[]){3e3}, 1e-4, &m.law),
                             PALP_OK);
            palp_network *net = cube_network(3, &m, NULL);
            palp_run_settings settings = recording(controlled ? 0.0 : 0.1, controlled ? 1e-3 : 0.0);
            palp_path path;
            ck_assert_int_eq(creep ? palp_path_creep(1e300, 1.0, 1.0, &path)
                                   : palp_path_ramp_hold(-3.0 * HEIGHT, 1.0, 1.0, &path),
                             PALP_OK);
            palp_status status = palp_network_run(net, &path, &settings, NULL);
            ck_assert_int_ne(status, PALP_OK);
            ck_assert_int_ne(status, PALP_ERR_ARGUMENT);
            ck_assert(creep || seen.n > 2);
            ck_assert_double_eq(palp_network_depth(net), seen.depth[seen.n - 1]);
            ck_assert_double_eq(palp_network_force(net), seen.force[seen.n - 1]);
            ck_assert_double_eq_tol(palp_network_time(net), seen.time[seen.n - 1], 1e-13);
            palp_path_free(&path);
            palp_network_free(net);
        }
}
END_TEST

START_TEST(runs_that_make_no_sense) {
    palp_material m = quartic(1);
    palp_network *net = cube_network(3, &m, NULL);
    palp_path path = ramp_hold(0.1, 1.0, 1.0), none = {0};
    static const double bad[] = {0.0, -0.1, NAN};
    snapshot rest = snapshot_take(net);
    for (size_t i = 0; i < 3; i++) {
        palp_run_settings settings = {.dt_s = bad[i]};
        ck_assert_int_eq(palp_network_run(net, &path, &settings, NULL), PALP_ERR_ARGUMENT);
        settings.tolerance = bad[i];
        ck_assert_int_eq(palp_network_run(net, &path, &settings, NULL), PALP_ERR_ARGUMENT);
    }
    palp_run_settings fine = {.dt_s = 0.1}, nan = {.dt_s = 0.1, .tolerance = NAN},
                      first = {.tolerance = 1e-3, .dt_min_s = NAN};
    ck_assert_int_eq(palp_network_run(net, &none, &fine, NULL), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_run(net, &path, &nan, NULL), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_run(net, &path, &first, NULL), PALP_ERR_ARGUMENT);
    ck_assert(still_at(net, &rest));
    ck_assert_int_eq(palp_network_run(net, &path, &fine, NULL), PALP_OK);
    snapshot_free(&rest);
    palp_path_free(&path);
    palp_network_free(net);
}
END_TEST

/* A recording's path: a ramp and a dwell as 10000 straight pieces. */
START_TEST(a_path_of_many_pieces_takes_a_step_for_each) {
    enum { PIECES = 10000 };
    palp_material m = quartic(2);
    palp_network *net = cube_network(3, &m, NULL);
    double whole[2];
    ends(net, 0.0, 1e-8, whole);
    palp_path path = {.n = PIECES + 1,
                      .time_s = malloc((PIECES + 1) * sizeof(double)),
                      .depth_m = malloc((PIECES + 1) * sizeof(double))};
    for (size_t i = 0; i <= PIECES; i++) {
        path.time_s[i] = 11.0 * (double)i / PIECES;
        path.depth_m[i] = 0.3 * HEIGHT * fmin(path.time_s[i], 1.0);
    }
    palp_run_settings settings = recording(0.0, 1e-4);
    palp_network_reset(net);
    palp_run_info info = run_path(net, path, &settings);
    ck_assert_uint_eq(seen.n, PIECES + 1);
    ck_assert_uint_eq(info.steps, 2 * PIECES);
    ck_assert_double_eq_tol(seen.force[PIECES], whole[1], 1e-5 * info.peak_force_N);
    palp_network_free(net);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, a_path_of_many_pieces_takes_a_step_for_each);
    tcase_add_test(tc, fixed_steps_visit_every_corner);
    tcase_add_test(tc, a_restored_network_goes_on);
    tcase_add_test(tc, controlled_steps_agree_with_small_fixed_ones);
    tcase_add_test(tc, second_order_in_dt);
    tcase_add_test(tc, relaxed_runs_are_static);
    tcase_add_test(tc, controlled_steps_locate_buckling);
    tcase_add_test(tc, runs_start_where_the_network_is);
    tcase_add_test(tc, step_force_holds_the_force);
    tcase_add_test(tc, step_force_lets_go);
    tcase_add_test(tc, failed_force_steps_leave_the_state);
    tcase_add_test(tc, creep_of_a_column);
    tcase_add_test(tc, creep_ends_where_the_relaxed_network_is);
    tcase_add_test(tc, elastic_cycles_close);
    tcase_add_test(tc, viscoelastic_cycles_settle_and_lose_energy);
    tcase_add_test(tc, observers_stop_a_run);
    tcase_add_test(tc, runs_that_fail_stay_at_the_last_step);
    tcase_add_test(tc, runs_that_make_no_sense);
}
