/* test_model.c: the model JSON: round trips, atomic writing, meshes. */
#define _POSIX_C_SOURCE 200809L
#include "scratch.h"
#include "model_make.h"

#include <palpate/network.h>

#include <math.h>
#include <sys/stat.h>

/* ---- reading ---- */

static palp_model read_text(const char *text) {
    palp_error error = {PALP_OK, ""};
    palp_model model;
    const char *path = scratch_write("model.json", text, strlen(text));
    ck_assert_msg(palp_model_read(path, &model, &source, &error) == PALP_OK, "%s", error.text);
    return model;
}

START_TEST(sample_is_read) {
    palp_model model = read_text(sample);
    is_sample(&model);
}
END_TEST

START_TEST(what_may_be_left_out_has_defaults) {
    palp_model model =
        read_text("{\"palpate\": {\"model\": 1}, \"kind\": \"network\", \"stiffness\": "
                  "{\"kind\": \"polynomial\", \"coefficients_N\": [2]}, "
                  "\"mesh\": {\"kind\": \"lattice\", \"nodes\": [2, 2, 2], \"size_mm\": [1, 2, 3]}}");
    ck_assert_double_eq(model.height_m, 0.002);
    ck_assert_double_eq(model.radius_m, 0);
    ck_assert_uint_eq(model.material.n_arms, 0);
    ck_assert_int_eq(model.mesh->neighbourhood, PALP_NEIGHBOURS_26);
    ck_assert_double_eq(model.density_kg_m3, 0);
    ck_assert_int_eq(model.material.formulation, PALP_HISTORY);
    model = read_text("{\"palpate\": {\"model\": 1}, \"kind\": \"network\", \"stiffness\": "
                      "{\"kind\": \"polynomial\", \"coefficients_N\": [2]}, "
                      "\"mesh\": {\"kind\": \"file\", \"path\": \"a.msh\"}}");
    ck_assert_double_eq(source.scale_m, 0.001);
    ck_assert(!source.hex_diagonals);
    ck_assert_int_eq(source.scaling, PALP_SCALING_NONE);
    ck_assert_str_eq(source.path, "a.msh");
    ck_assert_str_eq(source.folder, scratch_folder);
}
END_TEST

/* The area of a hyperelastic law is the specimen's: K(0) = E A with E = 6 (C10 + C01). */
START_TEST(hyperelastic_area_is_that_of_the_radius) {
    palp_model model =
        read_text("{\"palpate\": {\"model\": 1}, \"kind\": \"lumped\", \"quasi_linear\": true, "
                  "\"specimen\": {\"height_mm\": 24, \"radius_mm\": 12}, \"stiffness\": "
                  "{\"kind\": \"mooney_rivlin2\", \"coefficients_Pa\": [2500, 700]}}");
    double stiffness_N;
    palp_law_stiffness(&model.material.law, 0, &stiffness_N, NULL);
    ck_assert_double_eq_tol(stiffness_N, 6 * 3200 * acos(-1) * 0.012 * 0.012, 1e-9);
    ck_assert(model.material.quasi_linear);
}
END_TEST

/* ---- writing ---- */

static void comes_back(const palp_model *model) {
    palp_error error = {PALP_OK, ""};
    palp_model back;
    palp_mesh_source mesh;
    const char *path = scratch_path("out.json");
    ck_assert_msg(palp_model_write(model, path, &error) == PALP_OK, "%s", error.text);
    ck_assert_msg(palp_model_read(path, &back, &mesh, &error) == PALP_OK, "%s", error.text);
    ck_assert_int_eq(back.kind, model->kind);
    ck_assert_double_eq(back.height_m, model->height_m);
    ck_assert_double_eq(back.radius_m, model->radius_m);
    ck_assert_str_eq(back.specimen_kind, model->specimen_kind);
    ck_assert_int_eq(back.material.law.kind, model->material.law.kind);
    ck_assert_uint_eq(back.material.law.n, model->material.law.n);
    size_t bytes = model->material.law.n * sizeof(double);
    ck_assert_mem_eq(back.material.law.coefficients, model->material.law.coefficients, bytes);
    if (model->material.law.kind == PALP_LAW_SPLINE)
        ck_assert_mem_eq(back.material.law.strain, model->material.law.strain, bytes);
    ck_assert_double_eq(back.material.law.area_m2, model->material.law.area_m2);
    ck_assert_uint_eq(back.material.n_arms, model->material.n_arms);
    ck_assert_mem_eq(back.material.arms, model->material.arms, model->material.n_arms * sizeof(palp_arm));
    ck_assert_double_eq(back.material.dashpot_Ns, model->material.dashpot_Ns);
    ck_assert_int_eq(back.material.quasi_linear, model->material.quasi_linear);
    ck_assert_int_eq(back.material.formulation, model->material.formulation);
    ck_assert_double_eq(back.density_kg_m3, model->density_kg_m3);
    ck_assert_double_eq(back.volume_modulus_Pa, model->volume_modulus_Pa);
    ck_assert_double_eq(back.poisson_ratio, model->poisson_ratio);
    ck_assert_int_eq(back.edge_correction, model->edge_correction);
    if (model->kind == PALP_MODEL_LUMPED) {
        ck_assert_ptr_null(back.mesh);
        return;
    }
    ck_assert_int_eq(mesh.kind, model->mesh->kind);
    ck_assert_mem_eq(mesh.nodes, model->mesh->nodes, sizeof mesh.nodes);
    ck_assert_mem_eq(mesh.size_m, model->mesh->size_m, sizeof mesh.size_m);
    ck_assert_int_eq(mesh.neighbourhood, model->mesh->neighbourhood);
    ck_assert_int_eq(mesh.scaling, model->mesh->scaling);
    ck_assert_double_eq(mesh.area_m2, model->mesh->area_m2);
}

START_TEST(poissons_ratio_comes_back) {
    palp_model model =
        read_text("{\"palpate\": {\"model\": 1}, \"kind\": \"network\", \"stiffness\": "
                  "{\"kind\": \"polynomial\", \"coefficients_N\": [2]}, \"mesh\": {\"kind\": \"lattice\", "
                  "\"nodes\": [3, 3, 3], \"size_mm\": [24, 24, 24]}, \"poisson_ratio\": 0.45, "
                  "\"edge_correction\": true}");
    palp_network *net = NULL;
    double force[2];
    ck_assert_double_eq(model.poisson_ratio, 0.45);
    ck_assert(model.edge_correction);
    comes_back(&model);
    for (int i = 0; i < 2; i++, model.poisson_ratio = 0.0) {
        ck_assert_int_eq(palp_network_from_model(&model, NULL, 0, NULL, NULL, &net, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, 1e-3, INFINITY, NULL), PALP_OK);
        force[i] = palp_network_force(net);
        palp_network_free(net);
    }
    ck_assert_double_gt(force[0], 1.2 * force[1]);
    const double wrong[] = {0.2, 0.5, -0.3, NAN};
    for (size_t i = 0; i < 4; i++) {
        model.poisson_ratio = wrong[i];
        ck_assert_int_eq(palp_model_write(&model, scratch_path("m.json"), NULL), PALP_ERR_ARGUMENT);
    }
    model.poisson_ratio = 0.4;
    model.volume_modulus_Pa = 1e4;
    ck_assert_int_eq(palp_model_write(&model, scratch_path("m.json"), NULL), PALP_ERR_ARGUMENT);
}
END_TEST

START_TEST(scaling_comes_back) {
    palp_model model =
        read_text("{\"palpate\": {\"model\": 1}, \"kind\": \"network\", \"stiffness\": "
                  "{\"kind\": \"polynomial\", \"coefficients_N\": [2]}, \"mesh\": {\"kind\": \"file\", "
                  "\"path\": \"a.msh\", \"scaling\": \"continuum\", \"area_mm2\": 452.5}}");
    ck_assert_int_eq(source.scaling, PALP_SCALING_CONTINUUM);
    ck_assert_double_eq(source.area_m2, 452.5e-6);
    comes_back(&model);
    source.scaling = PALP_SCALING_VOLUME;
    source.area_m2 = 0.0;
    comes_back(&model);
    source.scaling = (palp_mesh_scaling)3;
    ck_assert_int_eq(palp_model_write(&model, scratch_path("m.json"), NULL), PALP_ERR_ARGUMENT);
    model =
        read_text("{\"palpate\": {\"model\": 1}, \"kind\": \"network\", \"stiffness\": "
                  "{\"kind\": \"polynomial\", \"coefficients_N\": [2]}, \"mesh\": {\"kind\": \"lattice\", "
                  "\"nodes\": [3, 3, 3], \"size_mm\": [24, 24, 24], \"scaling\": \"continuum\", "
                  "\"area_mm2\": 288}}");
    ck_assert_int_eq(source.scaling, PALP_SCALING_CONTINUUM);
    comes_back(&model);
    palp_mesh *mesh = NULL;
    ck_assert_int_eq(palp_model_mesh(&model, &mesh, NULL), PALP_OK);
    const double whole = palp_mesh_element_scale(mesh)[0];
    palp_mesh_free(mesh);
    source.area_m2 = 0.0; /* 576 mm^2, its own section */
    ck_assert_int_eq(palp_model_mesh(&model, &mesh, NULL), PALP_OK);
    ck_assert_double_eq_tol(palp_mesh_element_scale(mesh)[0], 0.5 * whole, 1e-12 * whole);
    palp_mesh_free(mesh);
    source.scaling = PALP_SCALING_NONE;
    ck_assert_int_eq(palp_model_mesh(&model, &mesh, NULL), PALP_OK);
    ck_assert_ptr_null(palp_mesh_element_scale(mesh));
    palp_mesh_free(mesh);
    source.scaling = PALP_SCALING_VOLUME;
    source.area_m2 = -1.0;
    ck_assert_int_eq(palp_model_write(&model, scratch_path("m.json"), NULL), PALP_ERR_ARGUMENT);
}
END_TEST

START_TEST(path_of_the_mesh_comes_back) {
    palp_model model =
        read_text("{\"palpate\": {\"model\": 1}, \"kind\": \"network\", \"stiffness\": "
                  "{\"kind\": \"polynomial\", \"coefficients_N\": [2]}, \"mesh\": {\"kind\": \"file\", "
                  "\"path\": \"a.msh\"}}");
    strcpy(source.path, "a'\n\"$(b)\033.msh");
    comes_back(&model);
    palp_error error;
    strcpy(source.path, "Gr\xF6\xDF"
                        "e.msh"); /* Latin-1, which JSON cannot hold */
    ck_assert_int_eq(palp_model_write(&model, scratch_path("m.json"), &error), PALP_ERR_ARGUMENT);
    ck_assert_ptr_nonnull(strstr(error.text, "the path of its mesh is not UTF-8"));
}
END_TEST

START_TEST(network_comes_back) {
    palp_model model = read_text(sample);
    comes_back(&model);
    model.material.law.coefficients[0] = 0.1 + 0.2; /* needs 17 digits */
    model.material.arms[1].viscosity_Ns = 1.0 / 3;
    source.neighbourhood = PALP_NEIGHBOURS_26;
    model.density_kg_m3 = 0;
    comes_back(&model);
}
END_TEST

START_TEST(lengths_in_millimetres_come_back) {
    palp_model model = read_text(sample);
    for (int i = 1; i < 3000; i++) {
        double mm = 0.01 * i; /* what a file can hold */
        palp_model back;
        model.height_m = mm / 1000;
        const char *path = scratch_path("out.json");
        ck_assert_int_eq(palp_model_write(&model, path, NULL), PALP_OK);
        ck_assert_int_eq(palp_model_read(path, &back, NULL, NULL), PALP_OK);
        ck_assert_double_eq(back.height_m, model.height_m);
        i += 1 + i / 20;
    }
}
END_TEST

START_TEST(every_law_comes_back) {
    static const double knots[] = {0, 0.1, 0.4}, c[] = {3000, 1.3, 20, 2.1, 10};
    static const size_t count[] = {0, 0, 1, 2, 5, 3, 4};
    palp_model model = {.kind = PALP_MODEL_LUMPED, .height_m = 0.024, .radius_m = 0.012};
    ck_assert_int_eq(palp_law_spline(3, knots, c, &model.material.law), PALP_OK);
    comes_back(&model);
    for (int kind = PALP_LAW_NEO_HOOKEAN; kind <= PALP_LAW_OGDEN; kind++) {
        double area_m2 = 3.14159265358979323846 * 0.012 * 0.012;
        ck_assert_int_eq(
            palp_law_hyperelastic((palp_law_kind)kind, count[kind], c, area_m2, &model.material.law),
            PALP_OK);
        model.material.quasi_linear = kind == PALP_LAW_YEOH;
        comes_back(&model);
    }
    model.radius_m = 0.013;
    ck_assert_int_eq(palp_model_write(&model, scratch_path("out.json"), NULL), PALP_ERR_ARGUMENT);
}
END_TEST

START_TEST(the_measured_strain_comes_back_and_must_be_sound) {
    static const double dips[] = {8, 0, 0, -130}; /* K falls to 0 at 0.39; F = K a rises to 0.25 */
    palp_model model = {.kind = PALP_MODEL_LUMPED, .height_m = 0.024}, back;
    ck_assert_int_eq(palp_law_polynomial(4, dips, &model.material.law), PALP_OK);
    ck_assert_int_eq(palp_model_write(&model, scratch_path("out.json"), NULL), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_law_limit(&model.material.law, 0.2), PALP_OK); /* beyond it nothing is asked of K */
    comes_back(&model);
    ck_assert_int_eq(palp_model_write(&model, scratch_path("out.json"), NULL), PALP_OK);
    ck_assert_int_eq(palp_model_read(scratch_path("out.json"), &back, NULL, NULL), PALP_OK);
    ck_assert_double_eq(back.material.law.strain_max, 0.2);
    model.material.law.strain_max = 0.3; /* the force falls there */
    ck_assert_int_eq(palp_model_write(&model, scratch_path("out.json"), NULL), PALP_ERR_ARGUMENT);
    static const double good[] = {8, 10, 0, -60}; /* K > 0 to 0.6 where it was measured to, not at 0.7 */
    ck_assert_int_eq(palp_law_polynomial(4, good, &model.material.law), PALP_OK);
    model.material.law.strain_max = 0.7;
    ck_assert_int_eq(palp_model_write(&model, scratch_path("out.json"), NULL), PALP_ERR_ARGUMENT);
}
END_TEST

START_TEST(the_covariance_comes_back_and_must_be_one) {
    double c[4][4] = {{4, 1, 0, 0.5}, {1, 9, 0, 0}, {0, 0, 0.25, 0.01}, {0.5, 0, 0.01, 1}}, *back = NULL;
    palp_model model = {.kind = PALP_MODEL_LUMPED, .height_m = 0.024, .covariance = &c[0][0]}, read;
    model.material = (palp_material){.n_arms = 1, .arms = {{1, 2, 0, 0}}};
    ck_assert_int_eq(palp_law_polynomial(2, (double[]){8, 3}, &model.material.law), PALP_OK);
    const char *path = scratch_path("out.json");
    ck_assert_int_eq(palp_model_write(&model, path, NULL), PALP_OK);
    ck_assert_int_eq(palp_model_read(path, &read, NULL, NULL), PALP_OK);
    ck_assert_ptr_null(read.covariance);
    ck_assert_int_eq(palp_model_read_covariance(path, &back, NULL), PALP_OK);
    ck_assert_mem_eq(back, c, sizeof c);
    free(back);
    model.covariance = NULL;
    ck_assert_int_eq(palp_model_write(&model, path, NULL), PALP_OK);
    ck_assert_int_eq(palp_model_read_covariance(path, &back, NULL), PALP_OK);
    ck_assert_ptr_null(back);
    model.covariance = &c[0][0];
    c[0][1] = 2; /* not symmetric */
    ck_assert_int_eq(palp_model_write(&model, path, NULL), PALP_ERR_ARGUMENT);
    c[0][1] = c[1][0] = 7; /* above sqrt(4 * 9) */
    ck_assert_int_eq(palp_model_write(&model, path, NULL), PALP_ERR_ARGUMENT);
    c[0][1] = c[1][0] = NAN;
    ck_assert_int_eq(palp_model_write(&model, path, NULL), PALP_ERR_ARGUMENT);
}
END_TEST

static void refused_covariance(const char *rows, const char *why) {
    palp_error error = {PALP_OK, ""};
    palp_model model;
    FILE *f = fopen(scratch_path("rows.json"), "w");
    ck_assert_ptr_nonnull(f);
    fprintf(f,
            "{\"palpate\": {\"model\": 1}, \"kind\": \"lumped\", \"specimen\": {\"height_mm\": 24},\n"
            "\"stiffness\": {\"kind\": \"polynomial\", \"coefficients_N\": [8, 3]}, \"covariance\": %s}\n",
            rows);
    fclose(f);
    ck_assert_int_eq(palp_model_read(scratch_path("rows.json"), &model, NULL, &error), PALP_ERR_INPUT);
    ck_assert_msg(strstr(error.text, why) != NULL, "%s: %s", rows, error.text);
}

START_TEST(the_spread_of_specimens_comes_back) {
    double c[4] = {4, 1, 1, 9}, b[4] = {2, 0.5, 0.5, 1}, total[4], *back = NULL;
    size_t n = 0;
    palp_model model = {
        .kind = PALP_MODEL_LUMPED, .height_m = 0.024, .covariance = c, .between = b, .n_specimens = 6};
    ck_assert_int_eq(palp_law_polynomial(2, (double[]){8, 3}, &model.material.law), PALP_OK);
    const char *path = scratch_path("out.json");
    ck_assert_int_eq(palp_model_write(&model, path, NULL), PALP_OK);
    ck_assert_int_eq(palp_model_read_between(path, &back, &n, NULL), PALP_OK);
    ck_assert_uint_eq(n, 6);
    ck_assert_mem_eq(back, b, sizeof b);
    free(back);
    ck_assert_int_eq(palp_model_unmeasured(2, c, b, n, total), PALP_OK);
    for (int i = 0; i < 4; i++) /* t of 5 degrees of freedom */
        ck_assert_double_eq_tol(total[i], c[i] + b[i] * pow(2.5705818 / 1.9599640, 2), 1e-6);
    ck_assert_int_eq(palp_model_unmeasured(2, c, b, 1, total), PALP_ERR_ARGUMENT);
    model.n_specimens = 1;
    ck_assert_int_eq(palp_model_write(&model, path, NULL), PALP_ERR_ARGUMENT);
    model.n_specimens = 6;
    b[0] = -1;
    ck_assert_int_eq(palp_model_write(&model, path, NULL), PALP_ERR_ARGUMENT);
    model.between = NULL;
    ck_assert_int_eq(palp_model_write(&model, path, NULL), PALP_OK);
    ck_assert_int_eq(palp_model_read_between(path, &back, &n, NULL), PALP_OK);
    ck_assert_ptr_null(back);
    ck_assert_uint_eq(n, 0);
}
END_TEST

static void refused_specimens(const char *value, const char *why) {
    palp_model model;
    palp_error error = {PALP_OK, ""};
    const char *path = scratch_path("specimens.json");
    FILE *f = fopen(path, "w");
    fprintf(f,
            "{\"palpate\": {\"model\": 1}, \"kind\": \"lumped\", \"specimen\": {\"height_mm\": 24},\n"
            "\"stiffness\": {\"kind\": \"polynomial\", \"coefficients_N\": [8, 3]}, \"specimens\": %s}\n",
            value);
    fclose(f);
    ck_assert_int_eq(palp_model_read(path, &model, NULL, &error), PALP_ERR_INPUT);
    ck_assert_msg(strstr(error.text, why) != NULL, "%s", error.text);
}

START_TEST(specimens_that_are_none_are_refused) {
    refused_specimens("{\"count\": 1, \"between\": [[1, 0], [0, 1]]}", "whole number of 2 or more");
    refused_specimens("{\"count\": 2.5, \"between\": [[1, 0], [0, 1]]}", "whole number of 2 or more");
    refused_specimens("{\"count\": 3}", "has no \"between\"");
    refused_specimens("{\"between\": [[1, 0], [0, 1]]}", "count");
    refused_specimens("{\"count\": 3, \"between\": [[1, 0]]}", "has 1 rows");
    refused_specimens("{\"count\": 3, \"between\": [[1, 2], [2, 1]]}", "is not a covariance");
    refused_specimens("3", "must be");
}
END_TEST

START_TEST(a_covariance_of_another_size_is_refused) {
    refused_covariance("[[1, 0]]", "has 1 rows, not one for each of the 2 parameters");
    refused_covariance("[[1, 0], [0]]", "has 1 numbers, not one for each of the 2 parameters");
    refused_covariance("[[1, 2], [2, 1]]", "is not a covariance");
    refused_covariance("[[-1, 0], [0, 1]]", "is not a covariance");
    refused_covariance("[1, 2]", "must be");
}
END_TEST

START_TEST(model_is_one_line_when_formatted) {
    palp_model model = read_text(sample);
    char *json;
    ck_assert_int_eq(palp_model_format(&model, &json), PALP_OK);
    ck_assert_str_eq(json,
                     "{\"palpate\": {\"model\": 1}, \"kind\": \"network\", "
                     "\"specimen\": {\"height_mm\": 24, \"radius_mm\": 12.1, \"kind\": \"cylinder\"}, "
                     "\"stiffness\": {\"kind\": \"polynomial\", \"coefficients_N\": [8.18, -0.7, 47.47]}, "
                     "\"arms\": [{\"stiffness_N\": 1.5, \"viscosity_Ns\": 3, \"stiffness_per_strain\": 2.9}, "
                     "{\"stiffness_N\": 0.5, \"viscosity_Ns\": 30, \"time_per_strain\": -0.1}], "
                     "\"dashpot_Ns\": 0.25, \"formulation\": \"history\", \"effects\": [], "
                     "\"mesh\": {\"kind\": \"lattice\", \"nodes\": [3, 4, 5], \"size_mm\": [24, 23.9, 24], "
                     "\"neighbourhood\": 18}, \"density_kg_m3\": 1040, \"volume_modulus_Pa\": 5000}");
    model = read_text(json);
    is_sample(&model);
    free(json);
    model.material.n_arms = PALP_ARMS_MAX + 1;
    ck_assert_int_eq(palp_model_format(&model, &json), PALP_ERR_LIMIT);
    ck_assert_ptr_null(json);
}
END_TEST

static void write_fails(const palp_model *model, const char *path, palp_status want) {
    palp_error error;
    int before = scratch_entries(scratch_folder, 0);
    ck_assert_int_eq(palp_model_write(model, path, &error), want);
    ck_assert_int_eq(strncmp(error.text, path, strlen(path)), 0);
    ck_assert_int_eq(scratch_entries(scratch_folder, 0), before);
}

START_TEST(failed_write_leaves_nothing) {
    palp_model model = read_text(sample), wrong = model;
    const char *path = scratch_write("old.json", "old", 3);
    write_fails(&model, scratch_path("missing/m.json"), PALP_ERR_FILE);
    write_fails(&model, scratch_folder, PALP_ERR_FILE);
    wrong.material.law.coefficients[0] = -1;
    write_fails(&wrong, path, PALP_ERR_ARGUMENT);
    wrong = model;
    wrong.material.arms[0].viscosity_Ns = NAN;
    write_fails(&wrong, path, PALP_ERR_ARGUMENT);
    wrong = model;
    wrong.height_m = INFINITY;
    write_fails(&wrong, path, PALP_ERR_ARGUMENT);
    wrong = model;
    palp_mesh_source flat = source, unnamed = {.kind = PALP_MESH_FILE, .path = "\xFF.msh", .scale_m = 0.001};
    flat.nodes[1] = 1;
    wrong.mesh = &flat;
    write_fails(&wrong, path, PALP_ERR_ARGUMENT);
    wrong = model;
    strcpy(wrong.specimen_kind, "a\"b");
    write_fails(&wrong, path, PALP_ERR_ARGUMENT);
    wrong = model;
    strcpy(unnamed.folder, scratch_folder);
    wrong.mesh = &unnamed;
    write_fails(&wrong, path, PALP_ERR_ARGUMENT);
    char *text = scratch_read(path);
    ck_assert_str_eq(text, "old");
    free(text);
}
END_TEST

/* ---- meshes ---- */

START_TEST(lattice_is_made) {
    palp_model model = read_text(sample);
    palp_mesh *mesh;
    double low_m[3], high_m[3];
    ck_assert_int_eq(palp_model_mesh(&model, &mesh, NULL), PALP_OK);
    ck_assert_uint_eq(palp_mesh_node_count(mesh), 60);
    palp_mesh_bounds(mesh, low_m, high_m);
    ck_assert_double_eq_tol(high_m[1] - low_m[1], 0.0239, 1e-16);
    palp_mesh_free(mesh);
    palp_error error;
    model.kind = PALP_MODEL_LUMPED;
    ck_assert_int_eq(palp_model_mesh(&model, &mesh, &error), PALP_ERR_ARGUMENT);
    ck_assert_str_eq(error.text, "a lumped model has no mesh");
    ck_assert_ptr_null(mesh);
}
END_TEST

/* What depends on the material, the specimen or the effects needs no mesh. */
/* What spheres were off by is kept, and looked up at the presses next to one. */
START_TEST(validity_comes_back) {
    palp_model model = read_text(sample), back;
    palp_mesh_source mesh;
    const char *path = scratch_path("out.json");
    double error = -1;
    ck_assert_int_eq(palp_model_tool_error(&model, 0.005, 0.001, &error), PALP_ERR_UNSUPPORTED);
    static const palp_validity presses[] = {
        {0.003, 0.0005, 0.3}, {0.003, 0.001, 0.2}, {0.010, 0.0005, 0.04}, {0.010, 0.001, 0.02}};
    memcpy(model.validity, presses, sizeof presses);
    model.n_validity = 4;
    ck_assert_int_eq(palp_model_write(&model, path, NULL), PALP_OK);
    ck_assert_int_eq(palp_model_read(path, &back, &mesh, NULL), PALP_OK);
    ck_assert_uint_eq(back.n_validity, 4);
    ck_assert_mem_eq(back.validity, presses, sizeof presses);
    const struct {
        double radius, depth, error;
    } cases[] = {{0.003, 0.001, 0.2},  {0.003, 0.0007, 0.3},  {0.005, 0.001, 0.2}, {0.010, 0.001, 0.02},
                 {0.020, 0.001, 0.02}, {0.020, 0.0001, 0.04}, {0.009, 0.0006, 0.3}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ck_assert_int_eq(palp_model_tool_error(&back, cases[i].radius, cases[i].depth, &error), PALP_OK);
        ck_assert_double_eq(error, cases[i].error);
    }
    ck_assert_int_eq(palp_model_tool_error(&back, 0.0029, 0.001, &error), PALP_ERR_LIMIT);
    ck_assert_int_eq(palp_model_tool_error(&back, 0.010, 0.0011, &error), PALP_ERR_LIMIT);
    ck_assert_int_eq(palp_model_tool_error(&back, 0, 0.001, &error), PALP_ERR_ARGUMENT);
    model.validity[2].error = NAN;
    write_fails(&model, path, PALP_ERR_ARGUMENT);
}
END_TEST

START_TEST(source_may_be_left_out) {
    const char *path = scratch_write("model.json", sample, sizeof sample - 1);
    palp_error error;
    palp_model model;
    palp_mesh *mesh;
    char *json;
    ck_assert_int_eq(palp_model_read(path, &model, NULL, NULL), PALP_OK);
    ck_assert_ptr_null(model.mesh);
    ck_assert_double_eq(model.height_m, 24.0 / 1000);
    ck_assert_double_eq(model.density_kg_m3, 1040);
    ck_assert_double_eq(model.volume_modulus_Pa, 5000);
    ck_assert_int_eq(palp_model_mesh(&model, &mesh, &error), PALP_ERR_ARGUMENT);
    ck_assert_str_eq(error.text, "the model was read without the source of its mesh");
    ck_assert_ptr_null(mesh);
    write_fails(&model, scratch_path("out.json"), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_model_format(&model, &json), PALP_ERR_ARGUMENT);
    ck_assert_ptr_null(json);
    ck_assert_int_eq(palp_model_read(path, &model, &source, NULL), PALP_OK);
    ck_assert_ptr_eq(model.mesh, &source);
    model =
        read_text("{\"palpate\": {\"model\": 1}, \"kind\": \"lumped\", \"specimen\": {\"height_mm\": 24}, "
                  "\"stiffness\": {\"kind\": \"polynomial\", \"coefficients_N\": [2]}}");
    ck_assert_ptr_null(model.mesh);
}
END_TEST

/* A copy has a material and effects of its own and the same mesh. */
START_TEST(model_is_copied_by_value) {
    ck_assert_uint_lt(sizeof(palp_model), 4096);
    palp_model model = read_text(sample), copy = model;
    palp_mesh *one, *other;
    model.material.law.coefficients[0] = 1;
    model.material.arms[0].viscosity_Ns = 1;
    model.n_effects = 1;
    strcpy(model.specimen_kind, "other");
    is_sample(&copy);
    ck_assert_uint_eq(copy.n_effects, 0);
    ck_assert_ptr_eq(copy.mesh, model.mesh);
    comes_back(&copy);
    source.nodes[0] = 4;
    ck_assert_int_eq(palp_model_mesh(&model, &one, NULL), PALP_OK);
    ck_assert_int_eq(palp_model_mesh(&copy, &other, NULL), PALP_OK);
    ck_assert_uint_eq(palp_mesh_node_count(one), 80);
    ck_assert_uint_eq(palp_mesh_node_count(other), 80);
    palp_mesh_free(one);
    palp_mesh_free(other);
}
END_TEST

/* The longest path that fits is looked for; one byte more is an error, in the model and beside a folder. */
START_TEST(too_long_a_path_is_an_error) {
    static const char before[] =
        "{\"palpate\": {\"model\": 1}, \"kind\": \"network\", \"stiffness\": {\"kind\": "
        "\"polynomial\", \"coefficients_N\": [2]}, \"mesh\": {\"kind\": \"file\", \"path\": \"";
    static char text[sizeof before + PALP_PATH_MAX + 8];
    palp_error error;
    palp_model model;
    palp_mesh *mesh;
    for (size_t n = PALP_PATH_MAX - 1; n <= PALP_PATH_MAX; n++) {
        memcpy(text, before, sizeof before - 1);
        memset(text + sizeof before - 1, 'a', n);
        strcpy(text + sizeof before - 1 + n, "\"}}");
        const char *path = scratch_write("long.json", text, strlen(text));
        ck_assert_int_eq(palp_model_read(path, &model, &source, &error),
                         n < PALP_PATH_MAX ? PALP_OK : PALP_ERR_INPUT);
        if (n == PALP_PATH_MAX)
            ck_assert_ptr_nonnull(strstr(error.text, "mesh.path must be the path of a Gmsh file"));
        else
            ck_assert_uint_eq(strlen(source.path), n);
    }
    memset(source.path, 'a', PALP_PATH_MAX - 1);
    source.path[PALP_PATH_MAX - 1] = '\0';
    strcpy(source.folder, "b");
    ck_assert_int_eq(palp_model_mesh(&model, &mesh, &error), PALP_ERR_LIMIT);
    ck_assert_str_eq(error.text, "the path of the mesh is too long");
    ck_assert_ptr_null(mesh);
    source.folder[0] = '\0';
    ck_assert_int_eq(palp_model_mesh(&model, &mesh, &error), PALP_ERR_FILE);
}
END_TEST

static const char tetrahedron[] =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n"
    "1 0 0 0 1 1 1 0 0\n$EndEntities\n"
    "$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n"
    "$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n";

static void mesh_is_tetrahedron(const char *path) {
    palp_error error = {PALP_OK, ""};
    palp_model model;
    palp_mesh_source own;
    palp_mesh *mesh;
    ck_assert_msg(palp_model_read(path, &model, &own, &error) == PALP_OK, "%s", error.text);
    ck_assert_msg(palp_model_mesh(&model, &mesh, &error) == PALP_OK, "%s", error.text);
    ck_assert_uint_eq(palp_mesh_node_count(mesh), 4);
    ck_assert_uint_eq(palp_mesh_element_count(mesh), 6);
    palp_mesh_free(mesh);
}

static void path_in(const char *model_path, const char *want) {
    palp_model model;
    palp_mesh_source own;
    ck_assert_int_eq(palp_model_read(model_path, &model, &own, NULL), PALP_OK);
    ck_assert_str_eq(own.path, want);
    mesh_is_tetrahedron(model_path);
}

/* The mesh is found from the model's folder, and still is when the model is written elsewhere. */
START_TEST(mesh_file_is_found_from_any_folder) {
    palp_error error;
    palp_mesh *mesh;
    ck_assert_int_eq(mkdir(scratch_path("in"), 0777), 0);
    ck_assert_int_eq(mkdir(scratch_path("out"), 0777), 0);
    scratch_write("in/t.msh", tetrahedron, sizeof tetrahedron - 1);
    palp_model model = read_text(sample);
    source = (palp_mesh_source){
        .kind = PALP_MESH_FILE, .path = "in/t.msh", .scale_m = 0.01, .hex_diagonals = true};
    strcpy(source.folder, scratch_folder);
    ck_assert_int_eq(palp_model_write(&model, scratch_path("a.json"), NULL), PALP_OK);
    path_in(scratch_path("a.json"), "in/t.msh");
    ck_assert_int_eq(palp_model_write(&model, scratch_path("out/b.json"), NULL), PALP_OK);
    path_in(scratch_path("out/b.json"), "../in/t.msh");
    ck_assert_int_eq(palp_model_write(&model, scratch_path("in/c.json"), NULL), PALP_OK);
    path_in(scratch_path("in/c.json"), "t.msh");
    ck_assert_int_eq(palp_model_read(scratch_path("out/b.json"), &model, &source, NULL), PALP_OK);
    ck_assert_double_eq(source.scale_m, 0.01);
    ck_assert(source.hex_diagonals);
    ck_assert_int_eq(palp_model_write(&model, scratch_path("d.json"), NULL), PALP_OK);
    path_in(scratch_path("d.json"), "in/t.msh");
    ck_assert_int_eq(chdir(scratch_path("out")), 0); /* a folder of "" is the working directory */
    source.folder[0] = '\0';
    ck_assert_int_eq(palp_model_write(&model, scratch_path("e.json"), NULL), PALP_OK);
    path_in(scratch_path("e.json"), "in/t.msh");
    ck_assert_int_eq(palp_model_write(&model, "f.json", NULL), PALP_OK);
    path_in("f.json", "../in/t.msh");
    strcpy(source.path, "none.msh");
    ck_assert_int_eq(palp_model_mesh(&model, &mesh, &error), PALP_ERR_FILE);
    ck_assert_int_eq(chdir("/"), 0);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_checked_fixture(tc, scratch_setup, scratch_teardown);
    tcase_add_test(tc, sample_is_read);
    tcase_add_test(tc, what_may_be_left_out_has_defaults);
    tcase_add_test(tc, hyperelastic_area_is_that_of_the_radius);
    tcase_add_test(tc, network_comes_back);
    tcase_add_test(tc, poissons_ratio_comes_back);
    tcase_add_test(tc, scaling_comes_back);
    tcase_add_test(tc, path_of_the_mesh_comes_back);
    tcase_add_test(tc, lengths_in_millimetres_come_back);
    tcase_add_test(tc, every_law_comes_back);
    tcase_add_test(tc, the_measured_strain_comes_back_and_must_be_sound);
    tcase_add_test(tc, the_covariance_comes_back_and_must_be_one);
    tcase_add_test(tc, a_covariance_of_another_size_is_refused);
    tcase_add_test(tc, the_spread_of_specimens_comes_back);
    tcase_add_test(tc, specimens_that_are_none_are_refused);
    tcase_add_test(tc, model_is_one_line_when_formatted);
    tcase_add_test(tc, failed_write_leaves_nothing);
    tcase_add_test(tc, lattice_is_made);
    tcase_add_test(tc, validity_comes_back);
    tcase_add_test(tc, source_may_be_left_out);
    tcase_add_test(tc, model_is_copied_by_value);
    tcase_add_test(tc, too_long_a_path_is_an_error);
    tcase_add_test(tc, mesh_file_is_found_from_any_folder);
}
