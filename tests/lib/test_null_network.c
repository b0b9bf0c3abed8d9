/* test_null_network.c: the same rule for meshes, networks and what is made of them. */
#include "null_make.h"

static const int32_t *nodes = (const int32_t[]){0, 1};

START_TEST(null_in_calibrate) {
    REFUSED(palp_calibrate_static(NULL, &material, 2, numbers, numbers, (void *)storage, (void *)storage));
    REFUSED(palp_calibrate_static(net, NULL, 2, numbers, numbers, (void *)storage, (void *)storage));
    REFUSED(palp_calibrate_static(net, &material, 2, NULL, numbers, (void *)storage, (void *)storage));
    REFUSED(palp_calibrate_static(net, &material, 2, numbers, NULL, (void *)storage, (void *)storage));
    REFUSED(palp_calibrate_static(net, &material, 2, numbers, numbers, NULL, (void *)storage));
    REFUSED(palp_calibrate_static(net, &material, 2, numbers, numbers, (void *)storage, NULL));
    REFUSED(
        palp_calibrate_presses(NULL, (void *)storage, 1, (void *)storage, (void *)storage, (void *)storage));
    REFUSED(
        palp_calibrate_presses((void *)storage, NULL, 1, (void *)storage, (void *)storage, (void *)storage));
    REFUSED(
        palp_calibrate_presses((void *)storage, (void *)storage, 1, NULL, (void *)storage, (void *)storage));
    REFUSED(
        palp_calibrate_presses((void *)storage, (void *)storage, 1, (void *)storage, NULL, (void *)storage));
    REFUSED(
        palp_calibrate_presses((void *)storage, (void *)storage, 1, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_calibrate_two_level(NULL, net, &material, 2, numbers, numbers, (void *)storage,
                                     (void *)storage));
    REFUSED(palp_calibrate_two_level(net, NULL, &material, 2, numbers, numbers, (void *)storage,
                                     (void *)storage));
    REFUSED(palp_calibrate_two_level(net, net, NULL, 2, numbers, numbers, (void *)storage, (void *)storage));
    REFUSED(
        palp_calibrate_two_level(net, net, &material, 2, NULL, numbers, (void *)storage, (void *)storage));
    REFUSED(
        palp_calibrate_two_level(net, net, &material, 2, numbers, NULL, (void *)storage, (void *)storage));
    REFUSED(palp_calibrate_two_level(net, net, &material, 2, numbers, numbers, NULL, (void *)storage));
    REFUSED(palp_calibrate_two_level(net, net, &material, 2, numbers, numbers, (void *)storage, NULL));
    REFUSED(
        palp_calibrate_covariance(NULL, (void *)storage, 1, (void *)storage, (double *)storage, NULL, NULL));
    REFUSED(
        palp_calibrate_covariance((void *)storage, NULL, 1, (void *)storage, (double *)storage, NULL, NULL));
    REFUSED(
        palp_calibrate_covariance((void *)storage, (void *)storage, 1, NULL, (double *)storage, NULL, NULL));
    REFUSED(
        palp_calibrate_covariance((void *)storage, (void *)storage, 1, (void *)storage, NULL, NULL, NULL));
    REFUSED(palp_calibrate_relaxation(NULL, &material, 2, (void *)storage, (void *)storage, (void *)storage));
    REFUSED(palp_calibrate_relaxation(net, NULL, 2, (void *)storage, (void *)storage, (void *)storage));
    REFUSED(palp_calibrate_relaxation(net, &material, 2, NULL, (void *)storage, (void *)storage));
    REFUSED(palp_calibrate_relaxation(net, &material, 2, (void *)storage, NULL, (void *)storage));
    REFUSED(palp_calibrate_relaxation(net, &material, 2, (void *)storage, (void *)storage, NULL));
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

static double everywhere(void *user, const double x[3]) {
    (void)user;
    (void)x;
    return 1.0;
}

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
    REFUSED(palp_law_of_solid(NULL, 0.25, 1.0, (palp_law *)pointers));
    REFUSED(palp_law_of_solid(mesh, 0.25, 1.0, NULL));
    REFUSED(palp_mesh_add_set(NULL, text, 2, nodes));
    REFUSED(palp_mesh_add_set(mesh, NULL, 2, nodes));
    REFUSED(palp_mesh_add_set(mesh, text, 2, NULL));
    REFUSED(palp_mesh_add_plane_set(NULL, text, 1, 0.5, 0.5));
    REFUSED(palp_mesh_add_plane_set(mesh, NULL, 1, 0.5, 0.5));
    REFUSED(palp_mesh_set(NULL, text, &count, &nodes));
    REFUSED(palp_mesh_set(mesh, NULL, &count, &nodes));
    REFUSED(palp_mesh_set(mesh, text, NULL, &nodes));
    REFUSED(palp_mesh_set(mesh, text, &count, NULL));
    REFUSED(palp_mesh_add_region(NULL, text, everywhere, NULL));
    REFUSED(palp_mesh_add_region(mesh, NULL, everywhere, NULL));
    REFUSED(palp_mesh_add_region(mesh, text, NULL, NULL));
    REFUSED(palp_mesh_region(NULL, text, (const double **)pointers));
    REFUSED(palp_mesh_region(mesh, NULL, (const double **)pointers));
    REFUSED(palp_mesh_region(mesh, text, NULL));
    REFUSED(palp_region_place_in(NULL, (void *)storage, NULL));
    REFUSED(palp_region_place_in(mesh, NULL, NULL));
    REFUSED(palp_mesh_join(NULL, mesh, text, (palp_mesh **)pointers));
    REFUSED(palp_mesh_join(mesh, NULL, text, (palp_mesh **)pointers));
    REFUSED(palp_mesh_join(mesh, mesh, NULL, (palp_mesh **)pointers));
    REFUSED(palp_mesh_join(mesh, mesh, text, NULL));
    REFUSED(palp_mesh_transform(NULL, numbers, numbers));
    REFUSED(palp_mesh_transform(mesh, NULL, numbers));
    REFUSED(palp_mesh_transform(mesh, numbers, NULL));
    palp_mesh_bounds(NULL, numbers, numbers);
    palp_mesh_bounds(mesh, NULL, numbers);
    palp_mesh_bounds(mesh, numbers, NULL);
}
END_TEST

START_TEST(null_in_network) {
    palp_supports_default(NULL);
    REFUSED(palp_network_create(NULL, &material, 2, (void *)storage, (void *)storage,
                                (palp_network **)pointers, NULL));
    REFUSED(palp_network_create(mesh, NULL, 2, (void *)storage, (void *)storage, (palp_network **)pointers,
                                NULL));
    REFUSED(palp_network_create(mesh, &material, 2, NULL, (void *)storage, (palp_network **)pointers, NULL));
    REFUSED(palp_network_create(mesh, &material, 2, (void *)storage, NULL, (palp_network **)pointers, NULL));
    REFUSED(palp_network_create(mesh, &material, 2, (void *)storage, (void *)storage, NULL, NULL));
    REFUSED(palp_network_from_model(NULL, mesh, 2, (void *)storage, (void *)storage,
                                    (palp_network **)pointers, NULL));
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
    NOTHING(palp_network_volume_solids(NULL, NULL, NULL, NULL) == 0.0);
    NOTHING(!palp_network_volume_moduli(NULL));
    NOTHING(!palp_network_mesh(NULL));
    palp_network_element_force(NULL, numbers);
    palp_network_element_force(net, NULL);
    REFUSED(palp_network_set_forces(NULL, 2, nodes, numbers));
    REFUSED(palp_network_set_forces(net, 2, NULL, numbers));
    REFUSED(palp_network_set_forces(net, 2, nodes, NULL));
    REFUSED(palp_network_set_velocities(NULL, numbers));
    REFUSED(palp_network_set_velocities(net, NULL));
    NOTHING(!palp_network_velocities(NULL));
    NOTHING(!palp_network_element_scale(NULL));
    NOTHING(palp_network_settings_of_model(NULL).tolerance > 0.0);
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

START_TEST(null_in_reduce) {
    REFUSED(palp_snapshots_record(NULL, (void *)storage, (void *)storage, NULL, NULL,
                                  (palp_snapshots **)pointers, NULL));
    REFUSED(palp_snapshots_record(net, (void *)storage, NULL, NULL, NULL, (palp_snapshots **)pointers, NULL));
    REFUSED(palp_snapshots_record(net, (void *)storage, (void *)storage, NULL, NULL, NULL, NULL));
    REFUSED(palp_reduced_create(NULL, 2, (palp_snapshots *const *)pointers, 2,
                                (palp_snapshots *const *)pointers, (void *)storage, (palp_reduced **)pointers,
                                (void *)storage, NULL));
    REFUSED(palp_reduced_create(net, 2, NULL, 2, (palp_snapshots *const *)pointers, (void *)storage,
                                (palp_reduced **)pointers, (void *)storage, NULL));
    REFUSED(palp_reduced_create(net, 2, (palp_snapshots *const *)pointers, 2, NULL, (void *)storage,
                                (palp_reduced **)pointers, (void *)storage, NULL));
    REFUSED(palp_reduced_create(net, 2, (palp_snapshots *const *)pointers, 2,
                                (palp_snapshots *const *)pointers, NULL, (palp_reduced **)pointers,
                                (void *)storage, NULL));
    REFUSED(palp_reduced_create(net, 2, (palp_snapshots *const *)pointers, 2,
                                (palp_snapshots *const *)pointers, (void *)storage, NULL, (void *)storage,
                                NULL));
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

START_TEST(null_in_visual) {
    REFUSED(palp_visual_create(NULL, 2, numbers, 0, nodes, (palp_visual **)pointers, NULL));
    REFUSED(palp_visual_create(net, 2, NULL, 0, nodes, (palp_visual **)pointers, NULL));
    REFUSED(palp_visual_create(net, 2, numbers, 0, NULL, (palp_visual **)pointers, NULL));
    REFUSED(palp_visual_create(net, 2, numbers, 0, nodes, NULL, NULL));
    palp_visual_free(NULL);
    REFUSED(palp_visual_follow(NULL, net, numbers, numbers));
    REFUSED(palp_visual_follow((void *)storage, NULL, numbers, numbers));
    REFUSED(palp_visual_follow((void *)storage, net, NULL, numbers));
    REFUSED(palp_visual_follow_float(NULL, net, (void *)numbers, (void *)numbers));
    REFUSED(palp_visual_follow_float((void *)storage, NULL, (void *)numbers, (void *)numbers));
    REFUSED(palp_visual_follow_float((void *)storage, net, NULL, (void *)numbers));
    REFUSED(palp_visual_triangles(NULL, &count, &nodes, &count));
    REFUSED(palp_visual_triangles((void *)storage, NULL, &nodes, &count));
    REFUSED(palp_visual_triangles((void *)storage, &count, NULL, &count));
}
END_TEST

START_TEST(null_in_tool) {
    palp_hull *hull = NULL;
    REFUSED(palp_hull_create(5, NULL, &hull, NULL));
    REFUSED(palp_hull_create(5, numbers, NULL, NULL));
    REFUSED(palp_hull_create_box(NULL, &hull, NULL));
    REFUSED(palp_hull_create_box(numbers, NULL, NULL));
    palp_hull_free(NULL);
    REFUSED(palp_network_enable_tools(NULL, 2, 2, (void *)storage));
    REFUSED(palp_network_enable_tools(net, 2, 2, NULL));
    REFUSED(palp_network_set_tools(NULL, 2, (void *)storage));
    REFUSED(palp_network_set_tools(net, 2, NULL));
    REFUSED(palp_network_tool_force(NULL, (void *)storage));
    REFUSED(palp_network_tool_force(net, NULL));
    REFUSED(palp_network_contacts(NULL, 2, (void *)storage, &count));
    REFUSED(palp_network_contacts(net, 2, NULL, &count));
    REFUSED(palp_network_contacts(net, 2, (void *)storage, NULL));
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

START_TEST(null_in_tie) {
    REFUSED(palp_tie_point_at(NULL, numbers, (void *)storage));
    REFUSED(palp_tie_point_at(palp_network_mesh(net), NULL, (void *)storage));
    REFUSED(palp_tie_point_at(palp_network_mesh(net), numbers, NULL));
    REFUSED(palp_network_enable_ties(NULL, 2));
    REFUSED(palp_network_set_ties(NULL, 2, (void *)storage));
    REFUSED(palp_network_set_ties(net, 2, NULL));
    REFUSED(palp_network_ties(NULL, (void *)storage));
    REFUSED(palp_network_ties(net, NULL));
    REFUSED(palp_network_tie_length(NULL, (void *)storage, numbers));
    REFUSED(palp_network_tie_length(net, NULL, numbers));
    REFUSED(palp_network_tie_length(net, (void *)storage, NULL));
}
END_TEST

START_TEST(null_in_palpation) {
    REFUSED(palp_palpate(NULL, mesh, 2, (void *)storage, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_palpate(&model, NULL, 2, (void *)storage, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_palpate(&model, mesh, 2, NULL, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_palpate(&model, mesh, 2, (void *)storage, NULL, (void *)storage, NULL));
    REFUSED(palp_palpate(&model, mesh, 2, (void *)storage, (void *)storage, NULL, NULL));
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

START_TEST(null_in_ranks) {
    REFUSED(palp_ranks_start(NULL, NULL));
    NOTHING(palp_ranks_rank(NULL) == 0 && palp_ranks_count(NULL) == 1);
    NOTHING(palp_ranks_agree(NULL, PALP_ERR_INPUT, NULL) == PALP_ERR_INPUT);
    REFUSED(palp_ranks_network(NULL, &model, mesh, 0, NULL, NULL, false, (void *)pointers, NULL));
    REFUSED(palp_ranks_network((void *)storage, NULL, mesh, 0, NULL, NULL, false, (void *)pointers, NULL));
    REFUSED(palp_ranks_network((void *)storage, &model, mesh, 0, NULL, NULL, false, NULL, NULL));
    REFUSED(palp_ranks_save(NULL, text, 0, NULL, NULL));
    REFUSED(palp_ranks_save(net, NULL, 0, NULL, NULL));
    REFUSED(palp_ranks_save(net, text, 1, NULL, NULL));
    REFUSED(palp_ranks_restore(NULL, text, (void *)storage, (void *)pointers, NULL));
    REFUSED(palp_ranks_restore(net, NULL, (void *)storage, (void *)pointers, NULL));
    REFUSED(palp_ranks_restore(net, text, NULL, (void *)pointers, NULL));
    REFUSED(palp_ranks_restore(net, text, (void *)storage, NULL, NULL));
    palp_ranks_finish(NULL);
}
END_TEST

START_TEST(null_in_forward) {
    NOTHING(!palp_forward_parameter_count(NULL));
    REFUSED(palp_forward_get(NULL, numbers));
    REFUSED(palp_forward_get(&model, NULL));
    REFUSED(palp_forward_set(NULL, numbers));
    REFUSED(palp_forward_set(&model, NULL));
    REFUSED(palp_forward_band(NULL, (void *)storage, numbers, numbers, numbers, NULL));
    REFUSED(palp_forward_band(&model, NULL, numbers, numbers, numbers, NULL));
    REFUSED(palp_forward_band(&model, (void *)storage, NULL, numbers, numbers, NULL));
    REFUSED(palp_forward_band(&model, (void *)storage, numbers, NULL, numbers, NULL));
    REFUSED(palp_forward_band(&model, (void *)storage, numbers, numbers, NULL, NULL));
    REFUSED(palp_forward_force(NULL, (void *)storage, numbers, numbers, NULL));
    REFUSED(palp_forward_force(&model, NULL, numbers, numbers, NULL));
    REFUSED(palp_forward_force(&model, (void *)storage, NULL, numbers, NULL));
    REFUSED(palp_forward_network(NULL, (void *)storage, (void *)storage, numbers, NULL));
    REFUSED(palp_forward_network(&model, (void *)storage, NULL, numbers, NULL));
    REFUSED(palp_forward_network(&model, (void *)storage, (void *)storage, NULL, NULL));
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

void tests(TCase *tc) {
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, null_in_calibrate);
    tcase_add_test(tc, null_in_cut);
    tcase_add_test(tc, null_in_mesh);
    tcase_add_test(tc, null_in_network);
    tcase_add_test(tc, null_in_realtime);
    tcase_add_test(tc, null_in_reduce);
    tcase_add_test(tc, null_in_thesis);
    tcase_add_test(tc, null_in_visual);
    tcase_add_test(tc, null_in_tool);
    tcase_add_test(tc, null_in_palpation);
    tcase_add_test(tc, null_in_tie);
    tcase_add_test(tc, null_in_vtu);
    tcase_add_test(tc, null_in_ranks);
    tcase_add_test(tc, null_in_forward);
    tcase_add_test(tc, null_in_specimen);
}
