/* test_model_errors.c: model files that are wrong: every error with its line. */
#define _POSIX_C_SOURCE 200809L
#include "scratch.h"
#include "model_make.h"

/* ---- errors ---- */

static const struct {
    const char *name; /* of tests/data/bad/model_NAME.json */
    int line;
    palp_status status;
    const char *text;
} bad[] = {
    {"arms", 7, PALP_ERR_INPUT, "dashpot_Ns must not be negative"},
    {"coefficients_empty", 6, PALP_ERR_INPUT, "stiffness.coefficients_N must not be empty"},
    {"coefficients_many", 6, PALP_ERR_LIMIT, "stiffness.coefficients_N has 33 items, at most 32 can be held"},
    {"coefficients_text", 6, PALP_ERR_INPUT, "stiffness.coefficients_N[1] must be a number"},
    {"cut", 10, PALP_ERR_INPUT, "malformed JSON: string or '}' expected near end of file"},
    {"validity", 14, PALP_ERR_INPUT, "validity[0].error must not be negative"},
    {"density", 13, PALP_ERR_INPUT, "density_kg_m3 must not be negative"},
    {"effect", 12, PALP_ERR_UNSUPPORTED, "effects[0].id \"plate_friction\" is not an effect of this version"},
    {"empty", 1, PALP_ERR_INPUT, "malformed JSON: '[' or '{' expected near end of file"},
    {"formulation", 12, PALP_ERR_INPUT, "formulation must be \"history\" or \"sedef2008\", not \"maxwell\""},
    {"height_text", 4, PALP_ERR_INPUT, "specimen.height_mm must be a number"},
    {"height_zero", 4, PALP_ERR_INPUT, "specimen.height_mm must be greater than 0, not 0"},
    {"hyperelastic_count", 6, PALP_ERR_INPUT,
     "stiffness.coefficients_Pa do not form a mooney_rivlin2 law: there are 3"},
    {"key_twice", 8, PALP_ERR_INPUT, "malformed JSON: duplicate object key near '\"stiffness_N\"'"},
    {"kind", 3, PALP_ERR_INPUT, "kind must be \"lumped\" or \"network\", not \"limped\""},
    {"knots", 6, PALP_ERR_INPUT, "stiffness.strain must increase (0.2 after 0.2)"},
    {"knots_count", 6, PALP_ERR_INPUT, "stiffness.stiffness_N has 3 values for 2 knots"},
    {"knots_negative", 6, PALP_ERR_INPUT, "stiffness.stiffness_N must be greater than 0 at every knot"},
    {"knots_start", 5, PALP_ERR_INPUT, "stiffness.strain must have at least two knots, the first at 0"},
    {"law", 5, PALP_ERR_INPUT,
     "stiffness.kind \"cubic\" is not one of polynomial, spline, neo_hookean, mooney_rivlin2, "
     "mooney_rivlin5, "
     "yeoh, ogden"},
    {"list", 1, PALP_ERR_INPUT, "not a model of palpate: it lacks \"palpate\": {\"model\": 1}"},
    {"mesh_in_lumped", 12, PALP_ERR_INPUT, "mesh is only for models of kind \"network\""},
    {"mesh_kind", 12, PALP_ERR_INPUT, "mesh.kind must be \"lattice\" or \"file\", not \"grid\""},
    {"nan", 8, PALP_ERR_INPUT, "malformed JSON: invalid token near 'NaN'"},
    {"neighbourhood", 13, PALP_ERR_INPUT, "mesh.neighbourhood must be 6, 18 or 26, not 8"},
    {"no_height", 4, PALP_ERR_INPUT, "specimen lacks \"height_mm\""},
    {"no_mesh", 1, PALP_ERR_INPUT, "missing key \"mesh\""},
    {"no_radius", 5, PALP_ERR_INPUT, "stiffness is hyperelastic: it needs specimen.radius_mm for the area"},
    {"no_specimen", 1, PALP_ERR_INPUT, "missing key \"specimen\""},
    {"no_viscosity", 8, PALP_ERR_INPUT, "arms[0] lacks \"viscosity_Ns\""},
    {"nodes_half", 13, PALP_ERR_INPUT, "mesh.nodes must be whole numbers of at least 2, not 2.5"},
    {"nodes_many", 13, PALP_ERR_INPUT, "mesh.nodes must be three counts, below 2^31 nodes in all"},
    {"nodes_one", 13, PALP_ERR_INPUT, "mesh.nodes must be whole numbers of at least 2, not 1"},
    {"nodes_two", 13, PALP_ERR_INPUT, "mesh.nodes must be three counts, below 2^31 nodes in all"},
    {"other", 1, PALP_ERR_INPUT, "not a model of palpate: it lacks \"palpate\": {\"model\": 1}"},
    {"overflow", 8, PALP_ERR_INPUT, "malformed JSON: real number overflow near '1e999'"},
    {"poisson", 13, PALP_ERR_INPUT, "poisson_ratio must be from 0.25 to below 0.5"},
    {"poisson_and_volume", 14, PALP_ERR_INPUT, "poisson_ratio does not go with volume_modulus_Pa"},
    {"path", 13, PALP_ERR_INPUT, "mesh.path must be the path of a Gmsh file"},
    {"area", 14, PALP_ERR_INPUT, "mesh.area_mm2 must be greater than 0, not 0"},
    {"area_alone", 13, PALP_ERR_INPUT, "mesh.area_mm2 needs \"scaling\" too"},
    {"scaling", 13, PALP_ERR_INPUT,
     "mesh.scaling must be \"none\", \"volume\" or \"continuum\", not \"length\""},
    {"scale", 13, PALP_ERR_INPUT, "mesh.scale_mm must be greater than 0, not 0"},
    {"sedef_arms", 12, PALP_ERR_UNSUPPORTED,
     "formulation cannot be used: formulation sedef2008 supports at most one arm, no dashpot and no "
     "quasi_linear"},
    {"size", 13, PALP_ERR_INPUT, "mesh.size_mm must be greater than 0, not 0"},
    {"size_unit", 13, PALP_ERR_INPUT, "mesh.size_m is not a known key: \"size_mm\" is expected"},
    {"stiffness_falls", 5, PALP_ERR_INPUT,
     "stiffness falls to -0.396 N between strain 0 and 0.4, but must stay above 0"},
    {"unit_coefficients", 6, PALP_ERR_INPUT,
     "stiffness.coefficients_Pa is not a known key: \"coefficients_N\" is expected"},
    {"unit_height", 4, PALP_ERR_INPUT, "specimen.height_m is not a known key: \"height_mm\" is expected"},
    {"unit_missing", 10, PALP_ERR_INPUT,
     "arms[1].viscosity is not a known key: \"viscosity_Ns\" is expected"},
    {"unit_stiffness", 9, PALP_ERR_INPUT,
     "arms[1].stiffness_kN is not a known key: \"stiffness_N\" is expected"},
    {"unknown", 12, PALP_ERR_INPUT,
     "colour is not a known key, which are palpate, kind, specimen, stiffness, arms, dashpot_Ns, "
     "quasi_linear, formulation, effects, fractional, covariance, specimens, free_term"},
    {"version_5", 2, PALP_ERR_INPUT, "palpate.model is not 1 to 4, the versions that this build reads"},
    {"plate_N", 8, PALP_ERR_INPUT, "free_term[0] lacks \"plate_N\""},
    {"no_gain", 8, PALP_ERR_INPUT,
     "free_term[0].plate_N is not a known key, which are depends_on, class, from, to, depth_mm, slow_mm_s, "
     "force_N, sd_N"},
    {"viscosity", 10, PALP_ERR_INPUT, "arms[1].viscosity_Ns must be greater than 0, not -30"},
};

START_TEST(bad_file_gives_its_line) {
    char path[SCRATCH_PATH], want[PALP_ERROR_TEXT];
    palp_error error;
    palp_model model;
    memset(&model, 0x5A, sizeof model);
    palp_model before;
    memcpy(&before, &model, sizeof before);
    snprintf(path, sizeof path, "%s/bad/model_%s.json", PALP_TEST_DATA, bad[_i].name);
    ck_assert_int_lt(snprintf(want, sizeof want, "%s:%d: %s", path, bad[_i].line, bad[_i].text),
                     (int)sizeof want);
    ck_assert_int_eq(palp_model_read(path, &model, NULL, &error), bad[_i].status);
    ck_assert_int_eq(error.status, bad[_i].status);
    ck_assert_str_eq(error.text, want);
    ck_assert_mem_eq(&model, &before, sizeof model);
    ck_assert_int_eq(palp_model_read(path, &model, NULL, NULL), bad[_i].status);
}
END_TEST

START_TEST(missing_file_is_a_file_error) {
    palp_error error;
    palp_model model;
    ck_assert_int_eq(palp_model_read("/nowhere/m.json", &model, NULL, &error), PALP_ERR_FILE);
    ck_assert_str_eq(error.text, "/nowhere/m.json: cannot open: No such file or directory");
}
END_TEST

/* Keys in other places, strings with brackets and quotes, one line only: the line is still found. */
START_TEST(line_is_found_in_any_layout) {
    static const char text[] =
        "\n\n{\"kind\": \"lumped\", \"arms\": [\n{\"viscosity_Ns\": 3, \"stiffness_N\": 1},"
        "\n{\"viscosity_Ns\": 3,\n\n\"stiffness_N\": -1}],\n\"palpate\": {\"model\": 1},\n"
        "\"specimen\": {\"height_mm\": 24},\n\"stiffness\": {\"kind\": \"polynomial\", "
        "\"coefficients_N\": [1]}}";
    static const char quoted[] = "{\"kind\":\"lumped\",\"palpate\":{\"model\":1},\n"
                                 "\"a \\\"}] \\\\\": [\"]}\", {\"stiffness\": 1}],\n\"stiffness\": 2}";
    palp_error error;
    palp_model model;
    char want[PALP_ERROR_TEXT];
    const char *path = scratch_write("m.json", text, sizeof text - 1);
    ck_assert_int_eq(palp_model_read(path, &model, NULL, &error), PALP_ERR_INPUT);
    snprintf(want, sizeof want, "%s:7: arms[1].stiffness_N must be greater than 0, not -1", path);
    ck_assert_str_eq(error.text, want);
    scratch_write("m.json", quoted, sizeof quoted - 1);
    ck_assert_int_eq(palp_model_read(path, &model, NULL, &error), PALP_ERR_INPUT);
    snprintf(want, sizeof want, "%s:1: a \"}] \\ is not a known key", path); /* escapes: its object's line */
    ck_assert_int_eq(strncmp(error.text, want, strlen(want)), 0);
}
END_TEST

/* ---- reading ---- */

START_TEST(truncations_are_read_or_named) {
    const char *path = scratch_path("cut.json");
    for (size_t n = 0; n < sizeof sample; n++) {
        palp_error error = {PALP_OK, ""};
        palp_model model;
        scratch_write("cut.json", sample, n);
        if (palp_model_read(path, &model, &source, &error)) {
            ck_assert_uint_lt(n, sizeof sample - 2);
            ck_assert_int_eq(error.status, PALP_ERR_INPUT);
            ck_assert_int_eq(strncmp(error.text, path, strlen(path)), 0);
            ck_assert_int_eq(error.text[strlen(path)], ':');
        } else
            is_sample(&model); /* whole but for the last line end */
    }
}
END_TEST

/* Every byte changed to each of a few, and every byte left out. */
START_TEST(changed_bytes_are_survived) {
    static const char bytes[] = {'\0', '\n', '"', '\\', '{', ']', ',', '-', '0', 'e', 'N', (char)0xC3};
    char text[sizeof sample];
    const char *path = scratch_path("changed.json");
    for (size_t i = 0; i + 1 < sizeof sample; i++)
        for (size_t k = 0; k <= sizeof bytes; k++) {
            palp_model model;
            palp_error error = {PALP_OK, ""};
            memcpy(text, sample, sizeof sample);
            size_t n = sizeof sample - 1;
            if (k < sizeof bytes)
                text[i] = bytes[k];
            else
                memmove(text + i, text + i + 1, n-- - i);
            scratch_write("changed.json", text, n);
            if (palp_model_read(path, &model, &source, &error))
                ck_assert_int_eq(strncmp(error.text, path, strlen(path)), 0);
            else
                ck_assert_int_eq(palp_material_check(&model.material, NULL), PALP_OK);
        }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_checked_fixture(tc, scratch_setup, scratch_teardown);
    tcase_add_loop_test(tc, bad_file_gives_its_line, 0, sizeof bad / sizeof bad[0]);
    tcase_add_test(tc, missing_file_is_a_file_error);
    tcase_add_test(tc, line_is_found_in_any_layout);
    tcase_add_test(tc, truncations_are_read_or_named);
    tcase_add_test(tc, changed_bytes_are_survived);
}
