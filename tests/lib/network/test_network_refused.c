/* test_network_refused.c: networks, supports and steps that are refused, and mechanisms. */
#include "network_settle.h"

/* ---- mechanisms --------------------------------------------------------------------------------- */

/* A lattice of faces only, and a free row of elements, have nothing to hold them sideways. */
START_TEST(mechanisms_are_singular) {
    static const palp_solver solvers[] = {PALP_SOLVER_BAND, PALP_SOLVER_SIMPLICIAL, PALP_SOLVER_AUTO};
    static const double depth[] = {1e-6, 0.01, 0.2, -0.01};
    for (size_t n = 3; n <= 8; n++)
        for (size_t s = 0; s < 3; s++)
            for (int branch = 0; branch < 2; branch++) {
                palp_mesh *mesh = cube(n, PALP_NEIGHBOURS_6);
                palp_material m = quartic(1);
                palp_network_settings settings = palp_network_settings_default();
                settings.solver = solvers[s];
                settings.branch = branch ? PALP_BRANCH_STABLE : PALP_BRANCH_CONTINUE;
                palp_network *net = network_on(mesh, &m, &settings);
                snapshot rest = snapshot_take(net);
                for (size_t i = 0; i < 4; i++) {
                    palp_status status = palp_network_step(net, depth[i] * HEIGHT, 0.1, NULL);
                    ck_assert_msg(status == PALP_ERR_SINGULAR,
                                  "%zu nodes a side, solver %zu, branch %d, depth %g: %s", n, s, branch,
                                  depth[i], palp_status_name(status));
                    ck_assert(still_at(net, &rest));
                }
                snapshot_free(&rest);
                palp_network_free(net);
                palp_mesh_free(mesh);
            }
}
END_TEST

/* ---- what is refused ----------------------------------------------------------------------------- */

static palp_status create_status(const palp_network_settings *settings, const palp_support *supports,
                                 palp_error *error) {
    palp_mesh *mesh = cube(3, PALP_NEIGHBOURS_26);
    palp_material m = quartic(1);
    palp_network *net = NULL;
    palp_support usual[2];
    palp_network_settings plain = palp_network_settings_default();
    palp_supports_default(usual);
    palp_status status = palp_network_create(mesh, &m, 2, supports ? supports : usual,
                                             settings ? settings : &plain, &net, error);
    ck_assert((status == PALP_OK) == (net != NULL));
    palp_network_free(net);
    palp_mesh_free(mesh);
    return status;
}

static void check_refused(const palp_network_settings *settings, size_t n) {
    for (size_t i = 0; i < n; i++) {
        palp_error error = {PALP_OK, ""};
        ck_assert_msg(create_status(&settings[i], NULL, &error) == PALP_ERR_ARGUMENT, "setting %zu is taken",
                      i);
        ck_assert_int_eq(error.status, PALP_ERR_ARGUMENT);
        ck_assert_uint_gt(strlen(error.text), 10);
    }
}

START_TEST(settings_out_of_range) {
    const palp_network_settings plain = palp_network_settings_default();
    static const double bad[] = {-1e-3, NAN, -INFINITY, INFINITY};
    ck_assert_int_eq(create_status(&plain, NULL, NULL), PALP_OK);
    for (size_t i = 0; i < 4; i++) {
        palp_network_settings s[4] = {plain, plain, plain, plain};
        s[0].tolerance = s[1].density_kg_m3 = s[2].spectral_radius = s[3].check_strain = bad[i];
        check_refused(s, bad[i] < INFINITY || isnan(bad[i]) ? 4 : 3); /* never to look is fine */
    }
    palp_network_settings s[6] = {plain, plain, plain, plain, plain, plain};
    s[0].tolerance = 0.0;
    s[1].spectral_radius = 1.1;
    s[2].max_iterations = 0;
    s[3].branch = (palp_branch)2;
    s[4].solver = (palp_solver)4;
    s[5].integrator = (palp_integrator)2;
    check_refused(s, 6);
#ifndef PALP_GPL
    s[0] = plain;
    s[0].solver = PALP_SOLVER_SUPERNODAL;
    ck_assert_int_eq(create_status(&s[0], NULL, NULL), PALP_ERR_UNSUPPORTED);
#endif
}
END_TEST

START_TEST(supports_that_make_no_sense) {
    palp_support s[2];
    palp_error error = {PALP_OK, ""};
    palp_supports_default(s);
    s[1].set = "no such set";
    ck_assert_int_eq(create_status(NULL, s, &error), PALP_ERR_INPUT);
    ck_assert_ptr_nonnull(strstr(error.text, "no such set"));
    palp_supports_default(s);
    s[1].motion[1] = NAN;
    ck_assert_int_eq(create_status(NULL, s, &error), PALP_ERR_ARGUMENT);
    s[1].motion[1] = INFINITY;
    ck_assert_int_eq(create_status(NULL, s, &error), PALP_ERR_ARGUMENT);
}
END_TEST

START_TEST(nothing_need_be_driven) {
    palp_material m = quartic(1);
    palp_mesh *mesh = NULL;
    palp_network *net = NULL;
    palp_support s[2];
    palp_step_info info;
    palp_supports_default(s);
    s[1].axis[1] = PALP_FIXED;
    palp_network_settings settings = palp_network_settings_default();
    ck_assert_int_eq(
        palp_mesh_lattice((size_t[]){3, 3, 3}, (double[]){0.024, 0.024, 0.024}, PALP_NEIGHBOURS_26, &mesh),
        PALP_OK);
    ck_assert_int_eq(palp_network_create(mesh, &m, 2, s, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_step(net, 0.001, 0.1, &info), PALP_OK);
    ck_assert_double_eq(info.force_N, 0.0);
    ck_assert_mem_eq(palp_network_positions(net), palp_mesh_positions(mesh), 81 * sizeof(double));
    ck_assert_int_eq(palp_network_step_force(net, 0.1, 0.1, NULL), PALP_ERR_ARGUMENT);
    palp_network_free(net);
    palp_mesh_free(mesh);
}
END_TEST

START_TEST(steps_that_make_no_sense) {
    static const double bad_depth[] = {NAN, INFINITY, -INFINITY}, bad_dt[] = {-1.0, NAN, -INFINITY};
    palp_material m = quartic(1);
    palp_network *net = cube_network(3, &m, NULL);
    snapshot rest = snapshot_take(net);
    for (size_t i = 0; i < 3; i++) {
        ck_assert_int_eq(palp_network_step(net, bad_depth[i], 0.1, NULL), PALP_ERR_ARGUMENT);
        ck_assert_int_eq(palp_network_step(net, 0.001, bad_dt[i], NULL), PALP_ERR_ARGUMENT);
        ck_assert_int_eq(palp_network_step_force(net, bad_depth[i], 0.1, NULL), PALP_ERR_ARGUMENT);
        ck_assert_int_eq(palp_network_step_force(net, 0.1, bad_dt[i], NULL), PALP_ERR_ARGUMENT);
    }
    double force[3] = {7.0, 7.0, 7.0};
    ck_assert_int_eq(palp_network_reaction(net, "no such set", force), PALP_ERR_INPUT);
    ck_assert_double_eq(force[0], 7.0);
    ck_assert(still_at(net, &rest));
    ck_assert_int_eq(palp_network_step(net, 0.001, 0.0, NULL), PALP_OK); /* springs and arms take a jump */
    ck_assert_double_gt(palp_network_force(net), 0.0);
    ck_assert_double_eq(palp_network_time(net), 0.0);
    snapshot_free(&rest);
    palp_network_free(net);
}
END_TEST

START_TEST(jumps_where_there_is_a_rate) {
    palp_network_settings heavy = palp_network_settings_default();
    heavy.density_kg_m3 = 1000.0;
    palp_material dashpot = quartic(0), sedef = sedef2008(), plain = quartic(1);
    dashpot.dashpot_Ns = 0.1;
    palp_network *nets[] = {cube_network(3, &dashpot, NULL), cube_network(3, &sedef, NULL),
                            cube_network(3, &plain, &heavy)};
    for (size_t k = 0; k < 3; k++) {
        ck_assert_int_eq(palp_network_step(nets[k], 0.001, 0.0, NULL), PALP_ERR_ARGUMENT);
        ck_assert_int_eq(palp_network_step_force(nets[k], 0.1, 0.0, NULL), PALP_ERR_ARGUMENT);
        ck_assert_int_eq(palp_network_step(nets[k], 0.001, INFINITY, NULL), PALP_OK);
        palp_network_free(nets[k]);
    }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, mechanisms_are_singular);
    tcase_add_test(tc, settings_out_of_range);
    tcase_add_test(tc, supports_that_make_no_sense);
    tcase_add_test(tc, nothing_need_be_driven);
    tcase_add_test(tc, steps_that_make_no_sense);
    tcase_add_test(tc, jumps_where_there_is_a_rate);
}
