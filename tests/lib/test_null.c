/* test_null.c: the rule of palpate/status.h about pointers: a call that lacks one it needs is refused. A row leaves out one
 * pointer; tests/install/symbols.sh sees to it that every function with pointers has its rows. */
#include "network_make.h"

#include <palpate/palpate.h>

#include <stdint.h>

#define REFUSED(call) ck_assert_int_eq(call, PALP_ERR_ARGUMENT)
#define NOTHING(told) ck_assert(told)

/* What else the calls are given; opaque and large things are storage, which a call that is refused does not look at. */
static union {
    double aligned;
    unsigned char bytes[1 << 16];
} room;
static unsigned char *const storage = room.bytes;
static void *pointers[4] = {room.bytes, room.bytes, room.bytes, room.bytes};
static double numbers[16] = {0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9};
static const size_t sizes[3] = {3, 3, 3};
static const int32_t *nodes = (const int32_t[]){0, 1};
static const char *text = "top";
static char *made_text;
static size_t count;
static palp_material material;
static palp_model model;
static palp_path path;
static palp_mesh *mesh;
static palp_network *net;

static void setup(void) {
    palp_contact_settings settings = palp_contact_settings_default();
    material = quartic(1);
    model.material = material;
    ck_assert_int_eq(palp_path_ramp_hold(1e-3, 1.0, 1.0, &path), PALP_OK);
    mesh = cube(3, PALP_NEIGHBOURS_26);
    net = cube_network(3, &material, NULL);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(net, 2, 2, &settings), PALP_OK);
}

static void teardown(void) {
    palp_network_free(net);
    palp_mesh_free(mesh);
    palp_path_free(&path);
}

START_TEST(null_in_calibrate) {
    REFUSED(palp_calibrate_static(NULL, &material, 2, numbers, numbers, (void *)storage, (void *)storage));
    REFUSED(palp_calibrate_static(net, NULL, 2, numbers, numbers, (void *)storage, (void *)storage));
    REFUSED(palp_calibrate_static(net, &material, 2, NULL, numbers, (void *)storage, (void *)storage));
    REFUSED(palp_calibrate_static(net, &material, 2, numbers, NULL, (void *)storage, (void *)storage));
    REFUSED(palp_calibrate_static(net, &material, 2, numbers, numbers, NULL, (void *)storage));
    REFUSED(palp_calibrate_static(net, &material, 2, numbers, numbers, (void *)storage, NULL));
    REFUSED(palp_calibrate_two_level(NULL, net, &material, 2, numbers, numbers, (void *)storage, (void *)storage));
    REFUSED(palp_calibrate_two_level(net, NULL, &material, 2, numbers, numbers, (void *)storage, (void *)storage));
    REFUSED(palp_calibrate_two_level(net, net, NULL, 2, numbers, numbers, (void *)storage, (void *)storage));
    REFUSED(palp_calibrate_two_level(net, net, &material, 2, NULL, numbers, (void *)storage, (void *)storage));
    REFUSED(palp_calibrate_two_level(net, net, &material, 2, numbers, NULL, (void *)storage, (void *)storage));
    REFUSED(palp_calibrate_two_level(net, net, &material, 2, numbers, numbers, NULL, (void *)storage));
    REFUSED(palp_calibrate_two_level(net, net, &material, 2, numbers, numbers, (void *)storage, NULL));
    REFUSED(palp_calibrate_relaxation(NULL, &material, 2, (void *)storage, (void *)storage, (void *)storage));
    REFUSED(palp_calibrate_relaxation(net, NULL, 2, (void *)storage, (void *)storage, (void *)storage));
    REFUSED(palp_calibrate_relaxation(net, &material, 2, NULL, (void *)storage, (void *)storage));
    REFUSED(palp_calibrate_relaxation(net, &material, 2, (void *)storage, NULL, (void *)storage));
    REFUSED(palp_calibrate_relaxation(net, &material, 2, (void *)storage, (void *)storage, NULL));
}
END_TEST

START_TEST(null_in_characterize) {
    REFUSED(palp_characterize_fit(2, NULL, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_characterize_fit(2, (void *)storage, NULL, (void *)storage, NULL));
    REFUSED(palp_characterize_fit(2, (void *)storage, (void *)storage, NULL, NULL));
    REFUSED(palp_characterize_select_arms(2, NULL, (void *)storage, 2, numbers, numbers, &count, NULL));
    REFUSED(palp_characterize_select_arms(2, (void *)storage, NULL, 2, numbers, numbers, &count, NULL));
    REFUSED(palp_characterize_select_arms(2, (void *)storage, (void *)storage, 2, NULL, numbers, &count, NULL));
    REFUSED(palp_characterize_select_arms(2, (void *)storage, (void *)storage, 2, numbers, NULL, &count, NULL));
    REFUSED(palp_characterize_select_arms(2, (void *)storage, (void *)storage, 2, numbers, numbers, NULL, NULL));
    REFUSED(palp_characterize_select_law(2, NULL, (void *)storage, 2, &material.law, numbers, numbers, &count, NULL));
    REFUSED(palp_characterize_select_law(2, (void *)storage, NULL, 2, &material.law, numbers, numbers, &count, NULL));
    REFUSED(palp_characterize_select_law(2, (void *)storage, (void *)storage, 2, NULL, numbers, numbers, &count, NULL));
    REFUSED(palp_characterize_select_law(2, (void *)storage, (void *)storage, 2, &material.law, NULL, numbers, &count, NULL));
    REFUSED(palp_characterize_select_law(2, (void *)storage, (void *)storage, 2, &material.law, numbers, NULL, &count, NULL));
    REFUSED(palp_characterize_select_law(2, (void *)storage, (void *)storage, 2, &material.law, numbers, numbers, NULL, NULL));
    REFUSED(palp_characterize_select_degree(2, NULL, (void *)storage, 2, numbers, numbers, &count, NULL));
    REFUSED(palp_characterize_select_degree(2, (void *)storage, NULL, 2, numbers, numbers, &count, NULL));
    REFUSED(palp_characterize_select_degree(2, (void *)storage, (void *)storage, 2, NULL, numbers, &count, NULL));
    REFUSED(palp_characterize_select_degree(2, (void *)storage, (void *)storage, 2, numbers, NULL, &count, NULL));
    REFUSED(palp_characterize_select_degree(2, (void *)storage, (void *)storage, 2, numbers, numbers, NULL, NULL));
    REFUSED(palp_lumped_fit_force(NULL, 2, (void *)storage, numbers));
    REFUSED(palp_lumped_fit_force((void *)storage, 2, NULL, numbers));
    REFUSED(palp_lumped_fit_force((void *)storage, 2, (void *)storage, NULL));
}
END_TEST

START_TEST(null_in_closed_form) {
    NOTHING(isnan(palp_generalized_maxwell_relaxation(NULL, 0.5, 0.5)));
    NOTHING(isnan(palp_generalized_maxwell_ramp(NULL, 0.5, 0.5)));
    NOTHING(isnan(palp_generalized_maxwell_ramp_hold(NULL, 0.5, 0.5, 0.5)));
    REFUSED(palp_retardation_spectrum(NULL, (void *)storage));
    REFUSED(palp_retardation_spectrum((void *)storage, NULL));
    NOTHING(isnan(palp_generalized_maxwell_creep(NULL, 0.5, 0.5)));
    REFUSED(palp_lumped_ramp_hold(NULL, 0.5, 0.5, 2, numbers, numbers));
    REFUSED(palp_lumped_ramp_hold(&material, 0.5, 0.5, 2, NULL, numbers));
    REFUSED(palp_lumped_ramp_hold(&material, 0.5, 0.5, 2, numbers, NULL));
}
END_TEST

START_TEST(null_in_cut) {
    REFUSED(palp_network_enable_cutting(NULL));
    REFUSED(palp_network_cut(NULL, numbers, &count));
    REFUSED(palp_network_cut(net, NULL, &count));
    REFUSED(palp_network_cut_elements(NULL, 2, nodes));
    REFUSED(palp_network_cut_elements(net, 2, NULL));
    REFUSED(palp_network_set_tearing(NULL, 0.5, 0.5));
    REFUSED(palp_network_tear(NULL, &count));
    NOTHING(!palp_network_alive(NULL));
    NOTHING(!palp_network_loose(NULL, storage));
}
END_TEST

START_TEST(null_in_effect) {
    REFUSED(palp_effect_parse(NULL, (void *)storage));
    REFUSED(palp_effect_parse(text, NULL));
    REFUSED(palp_effect_default(0, NULL));
    REFUSED(palp_effect_check(NULL, NULL));
}
END_TEST

START_TEST(null_in_experiment) {
    REFUSED(palp_experiment_create(2, NULL));
    REFUSED(palp_experiment_read(NULL, (palp_experiment **)pointers, NULL));
    REFUSED(palp_experiment_read(text, NULL, NULL));
    REFUSED(palp_experiment_write(NULL, text, NULL));
    REFUSED(palp_experiment_write((void *)storage, NULL, NULL));
    NOTHING(!palp_experiment_rows(NULL));
    NOTHING(!palp_experiment_column(NULL, text));
    NOTHING(!palp_experiment_column((void *)storage, NULL));
    NOTHING(!palp_experiment_column_count(NULL));
    NOTHING(!palp_experiment_column_name(NULL, 2));
    REFUSED(palp_experiment_add_column(NULL, text));
    REFUSED(palp_experiment_add_column((void *)storage, NULL));
    REFUSED(palp_experiment_get_number(NULL, text, numbers));
    REFUSED(palp_experiment_get_number((void *)storage, NULL, numbers));
    REFUSED(palp_experiment_get_number((void *)storage, text, NULL));
    REFUSED(palp_experiment_get_string(NULL, text, &text));
    REFUSED(palp_experiment_get_string((void *)storage, NULL, &text));
    REFUSED(palp_experiment_get_string((void *)storage, text, NULL));
    REFUSED(palp_experiment_set_number(NULL, text, 0.5));
    REFUSED(palp_experiment_set_number((void *)storage, NULL, 0.5));
    REFUSED(palp_experiment_set_string(NULL, text, text));
    REFUSED(palp_experiment_set_string((void *)storage, NULL, text));
    REFUSED(palp_experiment_set_string((void *)storage, text, NULL));
}
END_TEST

START_TEST(null_in_explain) {
    REFUSED(palp_explain(NULL, 2, (void *)storage, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_explain(&model, 2, NULL, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_explain(&model, 2, (void *)storage, NULL, (void *)storage, NULL));
    REFUSED(palp_explain(&model, 2, (void *)storage, (void *)storage, NULL, NULL));
}
END_TEST

START_TEST(null_in_file) {
    REFUSED(palp_file_read(NULL, &made_text, &count, NULL));
    REFUSED(palp_file_read(text, NULL, &count, NULL));
    REFUSED(palp_file_read(text, &made_text, NULL, NULL));
    REFUSED(palp_file_begin(NULL, text, NULL));
    REFUSED(palp_file_begin((void *)storage, NULL, NULL));
    REFUSED(palp_file_commit(NULL, false, NULL));
    REFUSED(palp_file_commit_pair(NULL, (void *)storage, false, NULL));
    REFUSED(palp_file_commit_pair((void *)storage, NULL, false, NULL));
    palp_file_abandon(NULL);
}
END_TEST

START_TEST(null_in_forward) {
    NOTHING(!palp_forward_parameter_count(NULL));
    REFUSED(palp_forward_get(NULL, numbers));
    REFUSED(palp_forward_get(&model, NULL));
    REFUSED(palp_forward_set(NULL, numbers));
    REFUSED(palp_forward_set(&model, NULL));
    REFUSED(palp_forward_force(NULL, (void *)storage, numbers, numbers, NULL));
    REFUSED(palp_forward_force(&model, NULL, numbers, numbers, NULL));
    REFUSED(palp_forward_force(&model, (void *)storage, NULL, numbers, NULL));
    REFUSED(palp_forward_network(NULL, (void *)storage, (void *)storage, numbers, NULL));
    REFUSED(palp_forward_network(&model, (void *)storage, NULL, numbers, NULL));
    REFUSED(palp_forward_network(&model, (void *)storage, (void *)storage, NULL, NULL));
}
END_TEST

START_TEST(null_in_law) {
    REFUSED(palp_law_polynomial(2, NULL, &material.law));
    REFUSED(palp_law_polynomial(2, numbers, NULL));
    REFUSED(palp_law_spline(2, NULL, numbers, &material.law));
    REFUSED(palp_law_spline(2, numbers, NULL, &material.law));
    REFUSED(palp_law_spline(2, numbers, numbers, NULL));
    REFUSED(palp_law_hyperelastic(0, 2, NULL, 0.5, &material.law));
    REFUSED(palp_law_hyperelastic(0, 2, numbers, 0.5, NULL));
    REFUSED(palp_law_set_coefficients(NULL, numbers));
    REFUSED(palp_law_set_coefficients(&material.law, NULL));
    REFUSED(palp_law_limit(NULL, 0.5));
    NOTHING(palp_law_beyond(NULL, 0.5) == 0.0);
    REFUSED(palp_law_scale(NULL, 0.5, &material.law));
    REFUSED(palp_law_scale(&material.law, 0.5, NULL));
    palp_law_stiffness(NULL, 0.5, numbers, numbers);
    palp_law_force(NULL, 2, numbers, numbers, numbers, numbers);
    palp_law_force(&material.law, 2, NULL, numbers, numbers, numbers);
    palp_law_force(&material.law, 2, numbers, NULL, numbers, numbers);
    palp_law_gradient(NULL, 0.5, numbers);
    palp_law_gradient(&material.law, 0.5, NULL);
    NOTHING(isnan(palp_law_minimum(NULL, 0.5)));
    REFUSED(palp_law_kind_parse(NULL, (void *)storage));
    REFUSED(palp_law_kind_parse(text, NULL));
}
END_TEST

START_TEST(null_in_material) {
    REFUSED(palp_material_check(NULL, NULL));
    REFUSED(palp_element_advance(NULL, (void *)storage, 0.5, 0.5, (void *)storage, numbers));
    REFUSED(palp_element_advance(&material, NULL, 0.5, 0.5, (void *)storage, numbers));
    REFUSED(palp_element_advance(&material, (void *)storage, 0.5, 0.5, NULL, numbers));
    REFUSED(palp_lumped_run(NULL, 0.5, 2, numbers, numbers, numbers));
    REFUSED(palp_lumped_run(&material, 0.5, 2, NULL, numbers, numbers));
    REFUSED(palp_lumped_run(&material, 0.5, 2, numbers, NULL, numbers));
    REFUSED(palp_lumped_run(&material, 0.5, 2, numbers, numbers, NULL));
}
END_TEST

START_TEST(null_in_mesh) {
    REFUSED(palp_mesh_lattice(NULL, numbers, PALP_NEIGHBOURS_26, (palp_mesh **)pointers));
    REFUSED(palp_mesh_lattice(sizes, NULL, PALP_NEIGHBOURS_26, (palp_mesh **)pointers));
    REFUSED(palp_mesh_lattice(sizes, numbers, PALP_NEIGHBOURS_26, NULL));
    REFUSED(palp_mesh_create(2, NULL, 2, nodes, (palp_mesh **)pointers, NULL));
    REFUSED(palp_mesh_create(2, numbers, 2, NULL, (palp_mesh **)pointers, NULL));
    REFUSED(palp_mesh_create(2, numbers, 2, nodes, NULL, NULL));
    REFUSED(palp_mesh_read_gmsh(NULL, 0.5, false, (palp_mesh **)pointers, NULL));
    REFUSED(palp_mesh_read_gmsh(text, 0.5, false, NULL, NULL));
    NOTHING(!palp_mesh_node_count(NULL));
    NOTHING(!palp_mesh_element_count(NULL));
    NOTHING(!palp_mesh_positions(NULL));
    NOTHING(!palp_mesh_pairs(NULL));
    NOTHING(!palp_mesh_tetrahedron_count(NULL));
    NOTHING(!palp_mesh_tetrahedra(NULL));
    NOTHING(!palp_mesh_triangle_count(NULL));
    NOTHING(!palp_mesh_triangles(NULL));
    REFUSED(palp_mesh_scale(NULL, 0, 0.5, NULL));
    NOTHING(!palp_mesh_element_scale(NULL));
    REFUSED(palp_mesh_add_set(NULL, text, 2, nodes));
    REFUSED(palp_mesh_add_set(mesh, NULL, 2, nodes));
    REFUSED(palp_mesh_add_set(mesh, text, 2, NULL));
    REFUSED(palp_mesh_add_plane_set(NULL, text, 1, 0.5, 0.5));
    REFUSED(palp_mesh_add_plane_set(mesh, NULL, 1, 0.5, 0.5));
    REFUSED(palp_mesh_set(NULL, text, &count, &nodes));
    REFUSED(palp_mesh_set(mesh, NULL, &count, &nodes));
    REFUSED(palp_mesh_set(mesh, text, NULL, &nodes));
    REFUSED(palp_mesh_set(mesh, text, &count, NULL));
    REFUSED(palp_mesh_transform(NULL, numbers, numbers));
    REFUSED(palp_mesh_transform(mesh, NULL, numbers));
    REFUSED(palp_mesh_transform(mesh, numbers, NULL));
    palp_mesh_bounds(NULL, numbers, numbers);
    palp_mesh_bounds(mesh, NULL, numbers);
    palp_mesh_bounds(mesh, numbers, NULL);
}
END_TEST

START_TEST(null_in_model) {
    REFUSED(palp_model_read(NULL, &model, NULL, NULL));
    REFUSED(palp_model_read(text, NULL, NULL, NULL));
    REFUSED(palp_model_write(NULL, text, NULL));
    REFUSED(palp_model_write(&model, NULL, NULL));
    REFUSED(palp_model_format(NULL, &made_text));
    REFUSED(palp_model_format(&model, NULL));
    REFUSED(palp_model_mesh(NULL, (palp_mesh **)pointers, NULL));
    REFUSED(palp_model_mesh(&model, NULL, NULL));
}
END_TEST

START_TEST(null_in_network) {
    palp_supports_default(NULL);
    REFUSED(palp_network_create(NULL, &material, 2, (void *)storage, (void *)storage, (palp_network **)pointers,
            NULL));
    REFUSED(palp_network_create(mesh, NULL, 2, (void *)storage, (void *)storage, (palp_network **)pointers, NULL));
    REFUSED(palp_network_create(mesh, &material, 2, NULL, (void *)storage, (palp_network **)pointers, NULL));
    REFUSED(palp_network_create(mesh, &material, 2, (void *)storage, NULL, (palp_network **)pointers, NULL));
    REFUSED(palp_network_create(mesh, &material, 2, (void *)storage, (void *)storage, NULL, NULL));
    REFUSED(palp_network_from_model(NULL, mesh, 2, (void *)storage, (void *)storage, (palp_network **)pointers,
            NULL));
    REFUSED(palp_network_from_model(&model, mesh, 2, (void *)storage, (void *)storage, NULL, NULL));
    palp_network_reset(NULL);
    REFUSED(palp_network_set_material(NULL, &material));
    REFUSED(palp_network_set_material(net, NULL));
    REFUSED(palp_network_try(NULL, 0.5, 0.5, NULL));
    palp_network_commit(NULL);
    REFUSED(palp_network_step(NULL, 0.5, 0.5, NULL));
    REFUSED(palp_network_step_force(NULL, 0.5, 0.5, NULL));
    NOTHING(!palp_network_state_size(NULL));
    REFUSED(palp_network_save(NULL, storage, sizeof storage));
    REFUSED(palp_network_save(net, NULL, sizeof storage));
    REFUSED(palp_network_restore(NULL, storage, sizeof storage));
    REFUSED(palp_network_restore(net, NULL, sizeof storage));
    NOTHING(isnan(palp_network_depth(NULL)));
    NOTHING(isnan(palp_network_time(NULL)));
    NOTHING(isnan(palp_network_force(NULL)));
    NOTHING(!palp_network_positions(NULL));
    NOTHING(!palp_network_element_strain(NULL));
    NOTHING(!palp_network_unknown_count(NULL));
    NOTHING(palp_network_strain_max(NULL) == 0.0);
    NOTHING(!palp_network_mesh(NULL));
    palp_network_element_force(NULL, numbers);
    palp_network_element_force(net, NULL);
    REFUSED(palp_network_reaction(NULL, text, numbers));
    REFUSED(palp_network_reaction(net, NULL, numbers));
    REFUSED(palp_network_reaction(net, text, NULL));
    REFUSED(palp_network_surface(NULL, &count, &nodes));
    REFUSED(palp_network_surface(net, NULL, &nodes));
    REFUSED(palp_network_surface(net, &count, NULL));
    NOTHING(!palp_network_buckled(NULL, numbers, numbers));
    NOTHING(!palp_network_buckled(net, NULL, numbers));
    NOTHING(!palp_network_buckled(net, numbers, NULL));
    REFUSED(palp_network_run(NULL, &path, (void *)storage, NULL));
    REFUSED(palp_network_run(net, NULL, (void *)storage, NULL));
    REFUSED(palp_network_run(net, &path, NULL, NULL));
}
END_TEST

START_TEST(null_in_path) {
    REFUSED(palp_path_create(2, NULL, numbers, &path));
    REFUSED(palp_path_create(2, numbers, NULL, &path));
    REFUSED(palp_path_create(2, numbers, numbers, NULL));
    REFUSED(palp_path_static(0.5, 0.5, NULL));
    REFUSED(palp_path_ramp_hold(0.5, 0.5, 0.5, NULL));
    REFUSED(palp_path_cyclic(0.5, 0.5, 2, NULL));
    REFUSED(palp_path_creep(0.5, 0.5, 0.5, NULL));
    NOTHING(isnan(palp_path_at(NULL, 0.5)));
}
END_TEST

START_TEST(null_in_random) {
    NOTHING(!palp_random_next(NULL));
    NOTHING(isnan(palp_random_uniform(NULL)));
    NOTHING(isnan(palp_random_normal(NULL)));
}
END_TEST

START_TEST(null_in_realtime) {
    REFUSED(palp_realtime_create(NULL, (void *)storage, (palp_realtime **)pointers));
    REFUSED(palp_realtime_create(net, NULL, (palp_realtime **)pointers));
    REFUSED(palp_realtime_create(net, (void *)storage, NULL));
    NOTHING(!palp_realtime_network(NULL));
    REFUSED(palp_realtime_reset(NULL));
    REFUSED(palp_realtime_step(NULL, 0.5, 0.5, (void *)storage, NULL));
    REFUSED(palp_realtime_step((void *)storage, 0.5, 0.5, NULL, NULL));
    NOTHING(!palp_realtime_state_size(NULL));
    NOTHING(palp_realtime_energy(NULL) != palp_realtime_energy(NULL)); /* NAN */
    REFUSED(palp_realtime_save(NULL, storage, sizeof storage));
    REFUSED(palp_realtime_save((void *)storage, NULL, sizeof storage));
    REFUSED(palp_realtime_restore(NULL, storage, sizeof storage));
    REFUSED(palp_realtime_restore((void *)storage, NULL, sizeof storage));
}
END_TEST

START_TEST(null_in_recording) {
    REFUSED(palp_recording_prepare(NULL, text, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_recording_prepare((void *)storage, NULL, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_recording_prepare((void *)storage, text, NULL, (void *)storage, NULL));
    REFUSED(palp_recording_prepare((void *)storage, text, (void *)storage, NULL, NULL));
    REFUSED(palp_filter_zero_phase(2, NULL, 0.5, 4, 0.5, numbers));
    REFUSED(palp_filter_zero_phase(2, numbers, 0.5, 4, 0.5, NULL));
}
END_TEST

START_TEST(null_in_reduce) {
    REFUSED(palp_snapshots_record(NULL, (void *)storage, (void *)storage, NULL, NULL, (palp_snapshots **)pointers,
            NULL));
    REFUSED(palp_snapshots_record(net, (void *)storage, NULL, NULL, NULL, (palp_snapshots **)pointers, NULL));
    REFUSED(palp_snapshots_record(net, (void *)storage, (void *)storage, NULL, NULL, NULL, NULL));
    REFUSED(palp_reduced_create(NULL, 2, (palp_snapshots *const *)pointers, 2, (palp_snapshots *const *)pointers,
            (void *)storage, (palp_reduced **)pointers, (void *)storage, NULL));
    REFUSED(palp_reduced_create(net, 2, NULL, 2, (palp_snapshots *const *)pointers, (void *)storage, (palp_reduced
            **)pointers, (void *)storage, NULL));
    REFUSED(palp_reduced_create(net, 2, (palp_snapshots *const *)pointers, 2, NULL, (void *)storage, (palp_reduced
            **)pointers, (void *)storage, NULL));
    REFUSED(palp_reduced_create(net, 2, (palp_snapshots *const *)pointers, 2, (palp_snapshots *const *)pointers, NULL,
            (palp_reduced **)pointers, (void *)storage, NULL));
    REFUSED(palp_reduced_create(net, 2, (palp_snapshots *const *)pointers, 2, (palp_snapshots *const *)pointers, (void
            *)storage, NULL, (void *)storage, NULL));
    REFUSED(palp_reduced_compare(NULL, (void *)storage, (void *)storage));
    REFUSED(palp_reduced_compare((void *)storage, NULL, (void *)storage));
    REFUSED(palp_reduced_compare((void *)storage, (void *)storage, NULL));
    NOTHING(palp_reduced_describe(NULL).modes == 0);
    REFUSED(palp_reduced_step(NULL, 0.5, 2, (void *)storage, 0.5, (void *)storage, NULL));
    REFUSED(palp_reduced_step((void *)storage, 0.5, 2, NULL, 0.5, (void *)storage, NULL));
    REFUSED(palp_reduced_set_limits(NULL, 0.5, 4));
    palp_reduced_reset(NULL);
    REFUSED(palp_reduced_positions(NULL, 2, nodes, numbers));
    REFUSED(palp_reduced_positions((void *)storage, 2, nodes, NULL));
    NOTHING(!palp_reduced_node_count(NULL));
    NOTHING(!palp_reduced_triangle_count(NULL));
    NOTHING(!palp_reduced_triangles(NULL));
    REFUSED(palp_reduced_write(NULL, &model, text, NULL));
    REFUSED(palp_reduced_write((void *)storage, NULL, text, NULL));
    REFUSED(palp_reduced_write((void *)storage, &model, NULL, NULL));
    REFUSED(palp_reduced_read(NULL, &model, NULL, (palp_reduced **)pointers, NULL));
    REFUSED(palp_reduced_read(text, &model, NULL, NULL, NULL));
}
END_TEST

START_TEST(null_in_segments) {
    REFUSED(palp_segments_noise(2, numbers, 0.5, NULL, 0, numbers));
    REFUSED(palp_segments_noise(2, numbers, 0.5, numbers, 0, NULL));
    palp_segments_phases(2, NULL, numbers, storage);
    palp_segments_phases(2, numbers, NULL, storage);
    palp_segments_phases(2, numbers, numbers, NULL);
    REFUSED(palp_press_create(2, NULL, numbers, numbers, (void *)storage));
    REFUSED(palp_press_create(2, numbers, NULL, numbers, (void *)storage));
    REFUSED(palp_press_create(2, numbers, numbers, NULL, (void *)storage));
    REFUSED(palp_press_create(2, numbers, numbers, numbers, NULL));
    NOTHING(palp_press_air(NULL, false).contact == 0);
    NOTHING(isnan(palp_air_force(NULL, 0.5)));
    NOTHING(!palp_press_starts_in_air(NULL));
    NOTHING(!palp_press_rest(NULL));
    NOTHING(isnan(palp_press_travel(NULL, 0.5)));
}
END_TEST

START_TEST(null_in_specimen) {
    REFUSED(palp_specimen_create(NULL, (void *)storage, (palp_specimen **)pointers, NULL));
    REFUSED(palp_specimen_create(&model, (void *)storage, NULL, NULL));
    REFUSED(palp_specimen_step(NULL, 0.5, 0.5, numbers));
    REFUSED(palp_specimen_step((void *)storage, 0.5, 0.5, NULL));
    NOTHING(isnan(palp_specimen_sense(NULL, (void *)storage)));
    NOTHING(isnan(palp_specimen_sense((void *)storage, NULL)));
}
END_TEST

START_TEST(null_in_thesis) {
    REFUSED(palp_thesis_polynomial(NULL, 2, &material.law, numbers));
    REFUSED(palp_thesis_polynomial((void *)storage, 2, NULL, numbers));
    REFUSED(palp_thesis_polynomial((void *)storage, 2, &material.law, NULL));
    REFUSED(palp_thesis_grid(2, NULL, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_thesis_grid(2, (void *)storage, NULL, (void *)storage, NULL));
    REFUSED(palp_thesis_grid(2, (void *)storage, (void *)storage, NULL, NULL));
    REFUSED(palp_thesis_fixed_point(NULL, &material, 2, numbers, numbers, (void *)storage, (void *)storage));
    REFUSED(palp_thesis_fixed_point(net, NULL, 2, numbers, numbers, (void *)storage, (void *)storage));
    REFUSED(palp_thesis_fixed_point(net, &material, 2, NULL, numbers, (void *)storage, (void *)storage));
    REFUSED(palp_thesis_fixed_point(net, &material, 2, numbers, NULL, (void *)storage, (void *)storage));
    REFUSED(palp_thesis_fixed_point(net, &material, 2, numbers, numbers, NULL, (void *)storage));
    REFUSED(palp_thesis_fixed_point(net, &material, 2, numbers, numbers, (void *)storage, NULL));
    REFUSED(palp_thesis_three_phase(NULL, &material, (void *)storage, (void *)storage, (void *)storage));
    REFUSED(palp_thesis_three_phase(net, NULL, (void *)storage, (void *)storage, (void *)storage));
    REFUSED(palp_thesis_three_phase(net, &material, NULL, (void *)storage, (void *)storage));
    REFUSED(palp_thesis_three_phase(net, &material, (void *)storage, NULL, (void *)storage));
    REFUSED(palp_thesis_three_phase(net, &material, (void *)storage, (void *)storage, NULL));
}
END_TEST

START_TEST(null_in_tool) {
    REFUSED(palp_network_enable_tools(NULL, 2, 2, (void *)storage));
    REFUSED(palp_network_enable_tools(net, 2, 2, NULL));
    REFUSED(palp_network_set_tools(NULL, 2, (void *)storage));
    REFUSED(palp_network_set_tools(net, 2, NULL));
    REFUSED(palp_network_tool_force(NULL, (void *)storage));
    REFUSED(palp_network_tool_force(net, NULL));
    REFUSED(palp_network_grasp(NULL, 2, nodes, numbers));
    REFUSED(palp_network_grasp(net, 2, NULL, numbers));
    REFUSED(palp_network_grasp(net, 2, nodes, NULL));
    REFUSED(palp_network_release(NULL, 2, nodes));
    REFUSED(palp_network_release(net, 2, NULL));
    REFUSED(palp_network_grasp_force(NULL, 2, nodes, numbers));
    REFUSED(palp_network_grasp_force(net, 2, NULL, numbers));
    REFUSED(palp_network_grasp_force(net, 2, nodes, NULL));
}
END_TEST

START_TEST(null_in_vtu) {
    REFUSED(palp_vtu_open(NULL, text, (palp_vtu **)pointers, NULL));
    REFUSED(palp_vtu_open(text, NULL, (palp_vtu **)pointers, NULL));
    REFUSED(palp_vtu_open(text, text, NULL, NULL));
    REFUSED(palp_vtu_add(NULL, net, NULL));
    REFUSED(palp_vtu_add((void *)storage, NULL, NULL));
}
END_TEST

START_TEST(null_in_wire) {
    NOTHING(!palp_wire_encode(NULL, storage));
    NOTHING(!palp_wire_encode((void *)storage, NULL));
    NOTHING(!palp_wire_decode(NULL, 0, (void *)storage));
    NOTHING(!palp_wire_decode((void *)storage, 0, NULL));
    NOTHING(!palp_wire_crc(NULL, 2));
}
END_TEST

START_TEST(null_that_is_asked_for_nothing) {
    ck_assert_double_eq(palp_voigt_relaxation((palp_spring_dashpot){1.0, 1.0}, 0.5, 0.5, NULL), 0.5);
}
END_TEST

START_TEST(null_is_freed) {
    palp_calibration_free(NULL);
    palp_lumped_fit_free(NULL);
    palp_experiment_free(NULL);
    palp_explanation_free(NULL);
    palp_load_history_free(NULL);
    palp_mesh_free(NULL);
    palp_network_free(NULL);
    palp_path_free(NULL);
    palp_realtime_free(NULL);
    palp_recording_free(NULL);
    palp_snapshots_free(NULL);
    palp_reduced_free(NULL);
    palp_press_free(NULL);
    palp_specimen_free(NULL);
    ck_assert_int_eq(palp_vtu_close(NULL, NULL), PALP_OK);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, null_in_calibrate);
    tcase_add_test(tc, null_in_characterize);
    tcase_add_test(tc, null_in_closed_form);
    tcase_add_test(tc, null_in_cut);
    tcase_add_test(tc, null_in_effect);
    tcase_add_test(tc, null_in_experiment);
    tcase_add_test(tc, null_in_explain);
    tcase_add_test(tc, null_in_file);
    tcase_add_test(tc, null_in_forward);
    tcase_add_test(tc, null_in_law);
    tcase_add_test(tc, null_in_material);
    tcase_add_test(tc, null_in_mesh);
    tcase_add_test(tc, null_in_model);
    tcase_add_test(tc, null_in_network);
    tcase_add_test(tc, null_in_path);
    tcase_add_test(tc, null_in_random);
    tcase_add_test(tc, null_in_realtime);
    tcase_add_test(tc, null_in_recording);
    tcase_add_test(tc, null_in_reduce);
    tcase_add_test(tc, null_in_segments);
    tcase_add_test(tc, null_in_specimen);
    tcase_add_test(tc, null_in_thesis);
    tcase_add_test(tc, null_in_tool);
    tcase_add_test(tc, null_in_vtu);
    tcase_add_test(tc, null_in_wire);
    tcase_add_test(tc, null_that_is_asked_for_nothing);
    tcase_add_test(tc, null_is_freed);
}
