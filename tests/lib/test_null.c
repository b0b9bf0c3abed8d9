/* test_null.c: the rule of palpate/status.h about pointers: a call that lacks one it needs is refused. A row
 * leaves out one pointer; tests/install/symbols.sh sees to it that every function with pointers has its rows.
 */
#include "null_make.h"

static char *made_text;

START_TEST(null_in_characterize) {
    REFUSED(palp_characterize_fit(2, NULL, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_characterize_fit(2, (void *)storage, NULL, (void *)storage, NULL));
    REFUSED(palp_characterize_fit(2, (void *)storage, (void *)storage, NULL, NULL));
    REFUSED(palp_specimens_fit_stiffness(NULL, 2, numbers, (void *)storage));
    REFUSED(palp_specimens_fit_stiffness((void *)storage, 2, NULL, (void *)storage));
    REFUSED(palp_specimens_fit_stiffness((void *)storage, 2, numbers, NULL));
    REFUSED(palp_lumped_fit_stiffness(NULL, 2, numbers, numbers, numbers));
    REFUSED(palp_lumped_fit_stiffness((void *)storage, 2, NULL, numbers, numbers));
    REFUSED(palp_lumped_fit_stiffness((void *)storage, 2, numbers, NULL, numbers));
    REFUSED(palp_lumped_fit_stiffness((void *)storage, 2, numbers, numbers, NULL));
    REFUSED(palp_lumped_fit_force(NULL, 2, (void *)storage, numbers));
    REFUSED(palp_lumped_fit_force((void *)storage, 2, NULL, numbers));
    REFUSED(palp_lumped_fit_force((void *)storage, 2, (void *)storage, NULL));
    REFUSED(palp_spectrum_measure(NULL, (void *)storage));
    REFUSED(palp_spectrum_measure((void *)storage, NULL));
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
    REFUSED(palp_lumped_oscillation(NULL, 0.5, 0.5, 2, numbers, numbers, numbers));
    REFUSED(palp_lumped_oscillation(&material, 0.5, 0.5, 2, NULL, numbers, numbers));
    REFUSED(palp_lumped_oscillation(&material, 0.5, 0.5, 2, numbers, NULL, numbers));
    REFUSED(palp_lumped_oscillation(&material, 0.5, 0.5, 2, numbers, numbers, NULL));
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
    NOTHING(!palp_experiment_key(NULL, 0));
    REFUSED(palp_experiment_get_json(NULL, text, (char **)pointers));
    REFUSED(palp_experiment_get_json((void *)storage, NULL, (char **)pointers));
    REFUSED(palp_experiment_get_json((void *)storage, text, NULL));
    REFUSED(palp_experiment_set_json(NULL, text, text));
    REFUSED(palp_experiment_set_json((void *)storage, NULL, text));
    REFUSED(palp_experiment_set_json((void *)storage, text, NULL));
    REFUSED(palp_experiment_join(2, NULL, (palp_experiment **)pointers, &count));
    REFUSED(palp_experiment_join(2, (void *)storage, NULL, &count));
    REFUSED(palp_experiment_join(2, (void *)storage, (palp_experiment **)pointers, NULL));
}
END_TEST

START_TEST(null_in_indentation) {
    palp_indentation in = {.tip = PALP_TIP_FLAT, .radius_m = 1e-3, .thickness_m = 1e-2, .poisson = 0.3};
    palp_tip_kind kind;
    REFUSED(palp_indentation_force(NULL, 2, numbers, numbers));
    REFUSED(palp_indentation_force(&in, 2, NULL, numbers));
    REFUSED(palp_indentation_force(&in, 2, numbers, NULL));
    REFUSED(palp_indentation_contact(NULL, 0.5, numbers));
    REFUSED(palp_indentation_contact(&in, 0.5, NULL));
    REFUSED(palp_moduli_pool(2, NULL, (void *)storage, (void *)storage));
    REFUSED(palp_moduli_pool(2, (void *)storage, NULL, (void *)storage));
    REFUSED(palp_moduli_pool(2, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_moduli_fit(2, NULL, &in, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_moduli_fit(2, (void *)storage, NULL, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_moduli_fit(2, (void *)storage, &in, NULL, (void *)storage, NULL));
    REFUSED(palp_moduli_fit(2, (void *)storage, &in, (void *)storage, NULL, NULL));
    NOTHING(!palp_tip_find(NULL, &kind));
    NOTHING(!palp_tip_find("flat", NULL));
}
END_TEST

START_TEST(null_in_explain) {
    REFUSED(palp_explain(NULL, 2, (void *)storage, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_explain(&model, 2, NULL, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_explain(&model, 2, (void *)storage, NULL, (void *)storage, NULL));
    REFUSED(palp_explain(&model, 2, (void *)storage, (void *)storage, NULL, NULL));
    REFUSED(palp_explain_material(NULL, 2, (void *)storage, (void *)storage, (void *)storage, (void *)storage,
                                  NULL));
    REFUSED(palp_explain_material(&model, 2, NULL, (void *)storage, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_explain_material(&model, 2, (void *)storage, NULL, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_explain_material(&model, 2, (void *)storage, (void *)storage, NULL, (void *)storage, NULL));
    REFUSED(palp_explain_material(&model, 2, (void *)storage, (void *)storage, (void *)storage, NULL, NULL));
    REFUSED(palp_explain_recordings(2, NULL, NULL, (void *)storage, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_explain_recordings(2, (void *)storage, NULL, NULL, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_explain_recordings(2, (void *)storage, NULL, (void *)storage, NULL, (void *)storage, NULL));
    REFUSED(palp_explain_recordings(2, (void *)storage, NULL, (void *)storage, (void *)storage, NULL, NULL));
    REFUSED(palp_explain_frame(2, NULL, (void *)storage, NULL));
    REFUSED(palp_explain_frame(2, (void *)storage, NULL, NULL));
    REFUSED(palp_free_term_check(NULL));
    REFUSED(palp_formula_find(NULL, (void *)storage, (void *)storage, 1, 0.05, (void *)storage));
    palp_free_term term = {.to = 1, .depth_m = 1, .slow_m_s = 1};
    NOTHING(palp_free_term_check(&term) == PALP_OK);
    NOTHING(isnan(palp_free_term_coordinate(NULL, 0.5)));
    REFUSED(palp_free_term_add(NULL, 2, numbers, numbers, 0.01, 0, numbers));
    REFUSED(palp_free_term_add(&term, 2, NULL, numbers, 0.01, 0, numbers));
    REFUSED(palp_free_term_add(&term, 2, numbers, NULL, 0.01, 0, numbers));
    REFUSED(palp_free_term_add(&term, 2, numbers, numbers, 0.01, 0, NULL));
    NOTHING(palp_formula_force(NULL, 0.5) == 0.0);
    REFUSED(palp_formula_find(&term, NULL, (void *)storage, 1, 0.05, (void *)storage));
    REFUSED(palp_formula_find(&term, (void *)storage, NULL, 1, 0.05, (void *)storage));
    REFUSED(palp_formula_find(&term, (void *)storage, (void *)storage, 1, 0.05, NULL));
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
    NOTHING(palp_text_make_plain(NULL) == NULL);
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

START_TEST(null_in_model) {
    REFUSED(palp_model_read_covariance(NULL, (void *)storage, NULL));
    REFUSED(palp_model_read_covariance(text, NULL, NULL));
    REFUSED(palp_model_read_between(NULL, (void *)storage, &count, NULL));
    REFUSED(palp_model_read_between(text, NULL, &count, NULL));
    REFUSED(palp_model_read_between(text, (void *)storage, NULL, NULL));
    REFUSED(palp_model_tool_error(NULL, 0.5, 0.5, numbers));
    REFUSED(palp_model_tool_error(&model, 0.5, 0.5, NULL));
    REFUSED(palp_model_unmeasured(2, NULL, numbers, 2, numbers));
    REFUSED(palp_model_unmeasured(2, numbers, NULL, 2, numbers));
    REFUSED(palp_model_unmeasured(2, numbers, numbers, 2, NULL));
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

START_TEST(null_in_recording) {
    REFUSED(palp_recording_prepare(NULL, text, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_recording_prepare((void *)storage, NULL, (void *)storage, (void *)storage, NULL));
    REFUSED(palp_recording_prepare((void *)storage, text, NULL, (void *)storage, NULL));
    REFUSED(palp_recording_prepare((void *)storage, text, (void *)storage, NULL, NULL));
    REFUSED(palp_recording_check(NULL, text, 1, NULL));
    REFUSED(palp_recording_check((void *)storage, NULL, 1, NULL));
    REFUSED(palp_filter_zero_phase(2, NULL, 0.5, 4, 0.5, numbers));
    REFUSED(palp_filter_zero_phase(2, numbers, 0.5, 4, 0.5, NULL));
}
END_TEST

START_TEST(null_in_segments) {
    REFUSED(palp_segments_noise(2, numbers, 0.5, NULL, 0, numbers));
    REFUSED(palp_segments_noise(2, numbers, 0.5, numbers, 0, NULL));
    REFUSED(palp_segments_phases(2, NULL, numbers, numbers, storage));
    REFUSED(palp_segments_phases(2, numbers, NULL, numbers, storage));
    REFUSED(palp_segments_phases(2, numbers, numbers, numbers, NULL));
    REFUSED(palp_segments_creep(2, NULL, numbers, numbers, (void *)storage));
    REFUSED(palp_segments_creep(2, numbers, NULL, numbers, (void *)storage));
    REFUSED(palp_segments_creep(2, numbers, numbers, NULL, (void *)storage));
    REFUSED(palp_segments_creep(2, numbers, numbers, numbers, NULL));
    REFUSED(palp_segments_smooth_path(2, NULL, numbers, numbers));
    REFUSED(palp_segments_smooth_path(2, numbers, NULL, numbers));
    REFUSED(palp_segments_smooth_path(2, numbers, numbers, NULL));
    REFUSED(palp_segments_pieces(2, NULL, numbers, (void *)storage));
    REFUSED(palp_segments_pieces(2, numbers, NULL, (void *)storage));
    REFUSED(palp_segments_pieces(2, numbers, numbers, NULL));
    REFUSED(palp_segments_clock(2, NULL, numbers, (void *)storage));
    REFUSED(palp_segments_clock(2, numbers, NULL, (void *)storage));
    REFUSED(palp_segments_clock(2, numbers, numbers, NULL));
    REFUSED(palp_recording_blocks(NULL, 100.0, (void *)storage));
    REFUSED(palp_recording_blocks((void *)storage, 100.0, NULL));
    NOTHING(palp_recording_kind_of(NULL) == PALP_RECORDING_OTHER);
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

START_TEST(null_in_solid) {
    palp_solid solid = {.c_Pa = {1.0}};
    palp_solid_press press = {3, numbers, numbers, numbers, NULL};
    NOTHING(palp_solid_shear(NULL) == 0.0 && palp_solid_bulk(NULL) == 0.0 && palp_solid_lambda(NULL) == 0.0);
    NOTHING(isinf(palp_solid_energy(NULL, numbers, NULL, NULL)));
    NOTHING(isinf(palp_solid_energy(&solid, NULL, NULL, NULL)));
    REFUSED(palp_solid_supports(NULL, false, storage));
    REFUSED(palp_solid_supports(mesh, false, NULL));
    REFUSED(palp_solid_force(NULL, mesh, 1, numbers + 1, numbers + 8));
    REFUSED(palp_solid_force(&solid, NULL, 1, numbers + 1, numbers + 8));
    REFUSED(palp_solid_force(&solid, mesh, 1, NULL, numbers + 8));
    REFUSED(palp_solid_force(&solid, mesh, 1, numbers + 1, NULL));
    REFUSED(palp_solid_fit(NULL, mesh, 1, &press, (void *)storage));
    REFUSED(palp_solid_fit(&solid, NULL, 1, &press, (void *)storage));
    REFUSED(palp_solid_fit(&solid, mesh, 1, NULL, (void *)storage));
    REFUSED(palp_solid_fit(&solid, mesh, 1, &press, NULL));
    REFUSED(palp_solid_run(NULL, mesh, &press, numbers + 8));
    REFUSED(palp_solid_run(&solid, NULL, &press, numbers + 8));
    REFUSED(palp_solid_run(&solid, mesh, NULL, numbers + 8));
    REFUSED(palp_solid_run(&solid, mesh, &press, NULL));
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
    palp_spectrum_free(NULL);
    palp_specimens_fit_free(NULL);
    palp_recording_scale(NULL, 1.0, 1.0);
    palp_experiment_free(NULL);
    palp_explanation_free(NULL);
    palp_load_history_free(NULL);
    palp_mesh_free(NULL);
    palp_network_free(NULL);
    palp_path_free(NULL);
    palp_realtime_free(NULL);
    palp_pieces_free(NULL);
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
    tcase_add_test(tc, null_in_characterize);
    tcase_add_test(tc, null_in_closed_form);
    tcase_add_test(tc, null_in_effect);
    tcase_add_test(tc, null_in_experiment);
    tcase_add_test(tc, null_in_indentation);
    tcase_add_test(tc, null_in_explain);
    tcase_add_test(tc, null_in_file);
    tcase_add_test(tc, null_in_law);
    tcase_add_test(tc, null_in_material);
    tcase_add_test(tc, null_in_model);
    tcase_add_test(tc, null_in_path);
    tcase_add_test(tc, null_in_random);
    tcase_add_test(tc, null_in_recording);
    tcase_add_test(tc, null_in_segments);
    tcase_add_test(tc, null_in_solid);
    tcase_add_test(tc, null_in_wire);
    tcase_add_test(tc, null_that_is_asked_for_nothing);
    tcase_add_test(tc, null_is_freed);
}
