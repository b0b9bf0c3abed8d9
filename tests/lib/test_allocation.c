/* test_allocation.c: what the library asks for is given back, and each request may be refused: files,
 * meshes, fits. */
/* link: -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=free */
#define _POSIX_C_SOURCE 200809L
#include "explain/explain_data.h"
#include "scratch.h"
#include "allocation_count.h"

#include <palpate/thesis.h>
#include <palpate/experiment.h>
#include <palpate/forward.h>
#include <palpate/path.h>
#include <palpate/vtu.h>

/* ---- each fails in turn ---- */

/* A folder with a failed write holds nothing. */
static void check_folder(palp_status status) {
    ck_assert_int_eq(scratch_entries(scratch_folder, 1), status ? 0 : 1);
}

static palp_status read_model(palp_error *error) {
    static palp_model model;
    return palp_model_read("data/sedef2008/lumped_n2.json", &model, NULL, error);
}

static palp_model lumped_model(void) {
    return (palp_model){.kind = PALP_MODEL_LUMPED,
                        .height_m = CUBE_HEIGHT_M,
                        .material.law = {.kind = PALP_LAW_POLYNOMIAL, .n = 1, .coefficients = {2.0}}};
}

static palp_status write_model(palp_error *error) {
    palp_model model = lumped_model();
    return palp_model_write(&model, scratch_path("model.json"), error);
}

static palp_status format_model(palp_error *error) {
    char *json;
    palp_model model = lumped_model();
    (void)error;
    palp_status status = palp_model_format(&model, &json);
    if (status ? json != NULL : json == NULL)
        abort();
    free(json);
    return status;
}

START_TEST(models) {
    each_fails(read_model, 1, NULL);
    each_fails(write_model, 1, check_folder);
    each_fails(format_model, 0, NULL);
}
END_TEST

static palp_status write_experiment(palp_error *error) {
    palp_experiment *e;
    palp_status status = palp_experiment_create(3, &e);
    if (status)
        return status;
    for (size_t i = 0; i < 3; i++)
        palp_experiment_column(e, "time_s")[i] = (double)i;
    status = palp_experiment_add_column(e, "temperature_C");
    if (!status)
        status = palp_experiment_set_string(e, "specimen.kind", "cylinder");
    if (!status)
        status = palp_experiment_set_number(e, "end.count", 3);
    if (!status)
        status = palp_experiment_write(e, scratch_path("run.csv"), error);
    palp_experiment_free(e);
    return status;
}

static palp_status read_experiment(palp_error *error) {
    palp_experiment *e = NULL;
    palp_status status = palp_experiment_read(scratch_path("long.csv"), &e, error);
    if (!status && palp_experiment_rows(e) != 1000)
        abort();
    palp_experiment_free(e);
    return status;
}

START_TEST(experiments) {
    each_fails(write_experiment, 8, check_folder);
    FILE *f = fopen(scratch_path("long.csv"), "w");
    ck_assert_ptr_nonnull(f);
    fputs("# palpate.experiment: 1\n# specimen.kind: \"cylinder\"\ntime_s,depth_mm,force_N,other\n", f);
    for (int i = 0; i < 1000; i++)
        fprintf(f, "%d,1,2,3\n", i);
    ck_assert_int_eq(fclose(f), 0);
    each_fails(read_experiment, 10, NULL);
}
END_TEST

static palp_status lattice(palp_error *error) {
    palp_mesh *mesh = NULL;
    const int32_t some[3] = {2, 0, 1};
    palp_status status =
        palp_mesh_lattice((size_t[3]){3, 4, 2}, (double[3]){1, 1, 1}, PALP_NEIGHBOURS_26, &mesh);
    (void)error;
    if (!status)
        status = palp_mesh_add_set(mesh, "some", 3, some);
    if (!status)
        status = palp_mesh_add_set(mesh, "some", 2, some);
    if (!status)
        status = palp_mesh_add_plane_set(mesh, "plane", 0, 0.5, 1e-9);
    palp_mesh_free(mesh);
    return status;
}

static palp_status triangle(palp_error *error) {
    const double x[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const int32_t pairs[6] = {0, 1, 1, 2, 2, 0};
    palp_mesh *mesh = NULL;
    palp_status status = palp_mesh_create(3, x, 3, pairs, &mesh, error);
    palp_mesh_free(mesh);
    return status;
}

static palp_status gmsh(palp_error *error) {
    palp_mesh *mesh = NULL;
    palp_status status = palp_mesh_read_gmsh("data/meshes/box_hexa.msh", 1e-3, true, &mesh, error);
    palp_mesh_free(mesh);
    return status;
}

static palp_status gmsh_version_2(palp_error *error) {
    palp_mesh *mesh = NULL;
    palp_status status = palp_mesh_read_gmsh("tests/data/mesh/good_groups_2.msh", 1e-3, true, &mesh, error);
    palp_mesh_free(mesh);
    return status;
}

static palp_status scaled_mesh(palp_error *error) {
    palp_mesh *mesh = NULL;
    palp_network *network = NULL;
    palp_material material = {.law = {.kind = PALP_LAW_POLYNOMIAL, .n = 1, .coefficients = {2.0}}};
    palp_network_settings settings = palp_network_settings_default();
    palp_support supports[2];
    palp_supports_default(supports);
    palp_status status = palp_mesh_read_gmsh("tests/data/mesh/good_tetra.msh", 1e-3, false, &mesh, error);
    if (!status)
        status = palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, 0.0, error);
    if (!status)
        status = palp_network_create(mesh, &material, 2, supports, &settings, &network, error);
    palp_network_free(network);
    palp_mesh_free(mesh);
    return status;
}

static palp_status mesh_of_model(palp_error *error) {
    palp_mesh *mesh = NULL;
    const palp_mesh_source source = {
        .nodes = {2, 2, 2}, .size_m = {1, 1, 1}, .neighbourhood = PALP_NEIGHBOURS_26};
    palp_model model = {.kind = PALP_MODEL_NETWORK, .mesh = &source};
    palp_status status = palp_model_mesh(&model, &mesh, error);
    palp_mesh_free(mesh);
    return status;
}

START_TEST(meshes) {
    each_fails(lattice, 10, NULL);
    each_fails(triangle, 3, NULL);
    each_fails(gmsh, 10, NULL);
    each_fails(gmsh_version_2, 12, NULL);
    each_fails(scaled_mesh, 20, NULL);
    each_fails(mesh_of_model, 5, NULL);
}
END_TEST

static palp_status paths(palp_error *error) {
    palp_path path;
    (void)error;
    palp_status status = palp_path_ramp_hold(0.005, 1.0, 10.0, &path);
    if (!status)
        palp_path_free(&path);
    if (!status && !(status = palp_path_cyclic(0.005, 1.0, 3, &path)))
        palp_path_free(&path);
    if (!status && !(status = palp_path_creep(1.0, 1.0, 3.0, &path)))
        palp_path_free(&path);
    return status;
}

START_TEST(path_makers) {
    each_fails(paths, 6, NULL);
}
END_TEST

/* ---- the forward model ---- */

static palp_status forward(bool network, palp_error *error) {
    static const double time_s[4] = {0, 0.5, 1, 1.5}, depth_m[4] = {-1e-4, 1e-3, 5e-4, -1e-4};
    static double force[4], gradient[4 * 32];
    const palp_effect_id ids[] = {PALP_EFFECT_FRAME_COMPLIANCE, PALP_EFFECT_DAMAGE_SOFTENING,
                                  PALP_EFFECT_SENSOR_LAG,
                                  network ? PALP_EFFECT_PLATE_SLIP : PALP_EFFECT_POWER_LAW_RELAXATION};
    const palp_forward_run run = {.n = 4, .time_s = time_s, .depth_m = depth_m};
    palp_network_settings settings = palp_network_settings_default();
    palp_model model = lumped_model();
    model.n_effects = 4;
    for (size_t i = 0; i < 4; i++)
        model.effects[i] = (palp_effect){ids[i], {1e-3, 0.5, 0}};
    if (!network)
        return palp_forward_force(&model, &run, force, gradient, error);
    settings.solver = PALP_SOLVER_BAND;
    model.kind = PALP_MODEL_NETWORK;
    const palp_mesh_source source = {.nodes = {3, 3, 3},
                                     .size_m = {CUBE_HEIGHT_M, CUBE_HEIGHT_M, CUBE_HEIGHT_M},
                                     .neighbourhood = PALP_NEIGHBOURS_26};
    model.mesh = &source;
    palp_status status = palp_forward_network(&model, &settings, &run, force, error);
    return status ? status : explain_predict(&model, &run, force, gradient, error);
}

static palp_status forward_lumped(palp_error *error) {
    return forward(false, error);
}

static palp_status forward_network(palp_error *error) {
    return forward(true, error);
}

START_TEST(forward_models) {
    each_fails(forward_lumped, 3, NULL);
    each_fails(forward_network, 50, NULL);
}
END_TEST

static palp_network *shown; /* not counted */

static palp_status frames(palp_error *error) {
    palp_vtu *series = NULL;
    palp_status status = palp_vtu_open(scratch_folder, "frame", &series, error);
    for (int i = 0; i < 2 && !status; i++)
        status = palp_vtu_add(series, shown, error);
    palp_status closed = palp_vtu_close(series, error);
    return status ? status : closed;
}

/* Whatever stands in the folder is whole. */
static void check_frames(palp_status status) {
    static const char *const names[3] = {"frame_0000.vtu", "frame_0001.vtu", "frame.pvd"};
    static const char end[] = "</VTKFile>\n";
    int found = 0;
    for (size_t i = 0; i < 3; i++) {
        const char *path = scratch_path(names[i]);
        if (access(path, F_OK) != 0)
            continue;
        char *text = scratch_read(path);
        ck_assert_uint_gt(strlen(text), sizeof end);
        ck_assert_str_eq(text + strlen(text) - (sizeof end - 1), end);
        free(text);
        found++;
    }
    ck_assert_int_eq(scratch_entries(scratch_folder, 1), found); /* no temporary stays */
    ck_assert(status || found == 3);
}

START_TEST(vtu_series) {
    ck_assert_int_eq(make_network(PALP_SOLVER_BAND, 0.0, &shown, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_step(shown, 0.001, 0.1, NULL), PALP_OK);
    each_fails(frames, 10, check_frames);
    palp_network_free(shown);
}
END_TEST

/* ---- calibration ---- */

static void check_failed(palp_status status, palp_calibration *result) {
    if (status && (result->iterations || result->force_N || result->n_iterations))
        abort();
    palp_calibration_free(result);
}

static palp_status calibrate_static(palp_error *error) {
    palp_network *network;
    palp_status status = make_network(PALP_SOLVER_BAND, 0.0, &network, error);
    palp_static_settings settings = palp_static_settings_default();
    palp_material start = with_arms(1);
    double depth[12], target[12];
    for (size_t i = 0; i < 12; i++) {
        depth[i] = 0.0005 * (double)(i + 1);
        target[i] = 300.0 * depth[i];
    }
    settings.max_evaluations = 3;
    settings.curve_tolerance = 1e-2;
    for (int k = 0; k < 3 && !status; k++) {
        palp_calibration result;
        settings.every_step = k == 2;
        if (k == 1)
            status = palp_thesis_fixed_point(network, &start, 12, depth, target, &settings, &result);
        else
            status = palp_calibrate_static(network, &start, 12, depth, target, &settings, &result);
        check_failed(status, &result);
    }
    palp_network_free(network);
    return status;
}

static palp_status calibrate_two_level(palp_error *error) {
    palp_network *network = NULL, *coarse = NULL;
    palp_static_settings settings = palp_static_settings_default();
    palp_material start = with_arms(1);
    palp_calibration result;
    double depth[12], target[12];
    for (size_t i = 0; i < 12; i++) {
        depth[i] = 0.0002 * (double)(i + 1);
        target[i] = 300.0 * depth[i];
    }
    settings.curve_tolerance = 1e-2;
    palp_status status = make_network(PALP_SOLVER_BAND, 0.0, &network, error);
    if (!status)
        status = make_network(PALP_SOLVER_BAND, 0.0, &coarse, error);
    if (!status) {
        status = palp_calibrate_two_level(network, coarse, &start, 12, depth, target, &settings, &result);
        check_failed(status, &result);
    }
    palp_network_free(network);
    palp_network_free(coarse);
    return status;
}

static palp_status calibrate_relaxation(palp_error *error) {
    const double time_s[4] = {0.5, 1.0, 2.0, 3.0}, force_N[4] = {1.0, 2.0, 1.8, 1.7};
    palp_target target = {.n = 4, .time_s = time_s, .force_N = force_N};
    palp_relaxation_settings settings = palp_relaxation_settings_default();
    palp_three_phase_settings phases = {
        .max_evaluations = 4, .dt_s = 0.5, .error_bound = 0.01, .steady_slope_N_s = 1e-3};
    palp_material start = with_arms(2);
    palp_network *network = NULL;
    palp_status status = palp_path_ramp_hold(0.005, 1.0, 10.0, &target.path);
    if (!status)
        status = make_network(PALP_SOLVER_BAND, 0.0, &network, error);
    settings.max_evaluations = 4;
    settings.tolerance = 1e-2;
    settings.fit_beta = true;
    for (int k = 0; k < 2 && !status; k++) {
        palp_calibration result;
        start.n_arms = k ? 1 : 2;
        if (k)
            status = palp_thesis_three_phase(network, &start, &target, &phases, &result);
        else
            status = palp_calibrate_relaxation(network, &start, 1, &target, &settings, &result);
        check_failed(status, &result);
    }
    palp_network_free(network);
    palp_path_free(&target.path);
    return status;
}

START_TEST(calibrations) {
    each_fails(calibrate_static, 80, NULL);
    each_fails(calibrate_two_level, 80, NULL);
    each_fails(calibrate_relaxation, 80, NULL);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_checked_fixture(tc, scratch_setup, scratch_teardown);
    tcase_add_test(tc, models);
    tcase_add_test(tc, experiments);
    tcase_add_test(tc, meshes);
    tcase_add_test(tc, path_makers);
    tcase_add_test(tc, forward_models);
    tcase_add_test(tc, vtu_series);
    tcase_add_test(tc, calibrations);
}
