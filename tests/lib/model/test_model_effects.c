/* test_model_effects.c: effects in the model JSON: the same file again, and every error with its line. */
#define _POSIX_C_SOURCE 200809L
#include <palpate/model.h>

#include "base/file.h"
#include "scratch.h"

#include <math.h>

static const char start[] = "{\n"
                            "  \"palpate\": {\"model\": 1},\n"
                            "  \"kind\": \"lumped\",\n"
                            "  \"specimen\": {\"height_mm\": 24},\n"
                            "  \"stiffness\": {\"kind\": \"polynomial\", \"coefficients_N\": [8.18]},\n"
                            "  \"arms\": [\n"
                            "    {\"stiffness_N\": 1.5, \"viscosity_Ns\": 3}],\n"
                            "  \"formulation\": \"history\",\n"
                            "  \"effects\": [";

static const char *model_of(const char *effects) {
    static char text[4096];
    snprintf(text, sizeof text, "%s%s]\n}\n", start, effects);
    return scratch_write("model.json", text, strlen(text));
}

static void same_file(const char *path, const char *again) {
    char *text, *back;
    size_t n, m;
    palp_model model;
    palp_error error = {PALP_OK, ""};
    ck_assert_msg(!palp_model_read(path, &model, NULL, &error), "%s", error.text);
    ck_assert_msg(!palp_model_write(&model, again, &error), "%s", error.text);
    ck_assert_int_eq(palp_file_read(path, &text, &n, NULL), PALP_OK);
    ck_assert_int_eq(palp_file_read(again, &back, &m, NULL), PALP_OK);
    ck_assert_str_eq(back, text);
    free(text);
    free(back);
}

START_TEST(written_again_is_the_same_file) {
    palp_model model;
    char again[256];
    const char *path = model_of(
        "\n    {\"id\": \"frame_compliance\", \"parameters\": {\"compliance_mm_N\": 0.01}},\n"
        "    {\"id\": \"relaxation_arm\", \"parameters\": {\"stiffness_N\": 0.37, \"time_s\": 123.4}},\n"
        "    {\"id\": \"relaxation_arm\", \"parameters\": {\"stiffness_N\": 0, \"time_s\": 0.1}},\n"
        "    {\"id\": \"session_ageing\", \"parameters\": {\"per_hour\": -0.03}},\n"
        "    {\"id\": \"drive_ripple\", \"parameters\": {\"amplitude_N\": 0.02, \"period_mm\": 0.79, "
        "\"phase_rad\": -1.1}}");
    snprintf(again, sizeof again, "%s", scratch_path("again.json"));
    same_file(path, again);
    ck_assert_int_eq(palp_model_read(again, &model, NULL, NULL), PALP_OK);
    ck_assert_uint_eq(model.n_effects, 5);
    ck_assert_int_eq((int)model.effects[0].id, PALP_EFFECT_FRAME_COMPLIANCE);
    ck_assert_double_eq_tol(model.effects[0].value[0], 1e-5, 1e-20);
    ck_assert_double_eq(model.effects[1].value[1], 123.4);
    ck_assert_double_eq_tol(model.effects[3].value[0], -0.03 / 3600, 1e-20);
}
END_TEST

/* Not every number of metres is a number of millimetres times 0.001, but then its neighbour is. */
START_TEST(every_effect_comes_back) {
    palp_model model, back;
    char first[256], again[256];
    snprintf(first, sizeof first, "%s", scratch_path("first.json"));
    snprintf(again, sizeof again, "%s", scratch_path("again.json"));
    ck_assert_int_eq(palp_model_read(model_of(""), &model, NULL, NULL), PALP_OK);
    ck_assert_uint_eq(model.n_effects, 0);
    for (int i = 0; i < PALP_EFFECT_COUNT; i++) {
        const palp_effect_info *info = palp_effect_look_up((palp_effect_id)i);
        if (!info->in_lumped)
            continue;
        model.n_effects = 1;
        ck_assert_int_eq(palp_effect_default((palp_effect_id)i, &model.effects[0]), PALP_OK);
        for (double x = 0.013; x < 1; x += 0.0471) {
            for (size_t k = 0; k < info->n_parameters; k++) {
                const palp_effect_parameter *p = &info->parameter[k];
                model.effects[0].value[k] = p->low + x * x * (p->high - p->low) / 3;
            }
            ck_assert_int_eq(palp_model_write(&model, first, NULL), PALP_OK);
            same_file(first, again);
            ck_assert_int_eq(palp_model_read(first, &back, NULL, NULL), PALP_OK);
            for (size_t k = 0; k < info->n_parameters; k++) {
                double value = model.effects[0].value[k],
                       tolerance = info->parameter[k].unit == 1 ? 0 : 3e-16;
                ck_assert_msg(fabs(back.effects[0].value[k] - value) <= tolerance * fabs(value), "%s",
                              info->id);
            }
        }
    }
}
END_TEST

static const struct {
    const char *effects;
    int line;
    palp_status status;
    const char *text;
} bad[] = {
    {"{\"id\": \"gremlins\", \"parameters\": {}}", 9, PALP_ERR_UNSUPPORTED,
     "effects[0].id \"gremlins\" is not an effect of this version"},
    {"{\"id\": \"plate_slip\", \"parameters\": {\"slip\": 1}}", 9, PALP_ERR_UNSUPPORTED,
     "effects[0].id \"plate_slip\" is not an effect of a lumped model"},
    {"\n{\"id\": \"sensor_lag\"}", 10, PALP_ERR_INPUT, "effects[0] lacks \"parameters\""},
    {"\n{\"parameters\": {}}", 10, PALP_ERR_INPUT, "effects[0] lacks \"id\""},
    {"\n{\"id\": \"sensor_lag\",\n\"strength\": 1}", 11, PALP_ERR_INPUT,
     "effects[0].strength is not a known key, which are id, parameters"},
    {"{\"id\": \"sensor_lag\", \"parameters\": {}}", 9, PALP_ERR_INPUT,
     "effects[0].parameters lacks \"time_s\""},
    {"{\"id\": \"sensor_lag\", \"parameters\":\n{\"time_ms\": 3}}", 10, PALP_ERR_INPUT,
     "effects[0].parameters.time_ms is not a known key: \"time_s\" is expected"},
    {"{\"id\": \"sensor_lag\", \"parameters\": {\"time_s\": 3}},\n\n{\"id\": \"sensor_lag\"}", 11,
     PALP_ERR_INPUT, "effects[1].id \"sensor_lag\" is given twice"},
    {"{\"id\": \"frame_compliance\", \"parameters\": {\n\"compliance_mm_N\": -2}}", 10, PALP_ERR_INPUT,
     "effects[0].parameters.compliance_mm_N must be between 0 and 1e+15, not -2"},
    {"{\"id\": \"sensor_gain\", \"parameters\": {\"gain\": \"0.1\"}}", 9, PALP_ERR_INPUT,
     "effects[0].parameters.gain must be a number"},
    {"1, 2, 3, 4, 5, 6, 7, 8, 9", 9, PALP_ERR_LIMIT, "effects has 9 items, at most 8 can be held"},
};

START_TEST(bad_effects_are_told_with_their_line) {
    palp_model model;
    palp_error error;
    char wanted[512];
    const char *path = model_of(bad[_i].effects);
    ck_assert_int_eq(palp_model_read(path, &model, NULL, &error), bad[_i].status);
    snprintf(wanted, sizeof wanted, "%s:%d: %s", path, bad[_i].line, bad[_i].text);
    ck_assert_str_eq(error.text, wanted);
}
END_TEST

START_TEST(what_may_be_left_out_is_zero) {
    palp_model model;
    ck_assert_int_eq(palp_model_read(model_of("{\"id\": \"adhesion\", \"parameters\": {\"force_N\": 0.5}}"),
                                     &model, NULL, NULL),
                     PALP_OK);
    ck_assert_double_eq(model.effects[0].value[0], 0.5);
    ck_assert_double_eq(model.effects[0].value[1], 0.0);
}
END_TEST

START_TEST(sedef_takes_none) {
    palp_model model;
    palp_error error;
    char text[4096];
    snprintf(text, sizeof text, "%s{\"id\": \"sensor_bias\", \"parameters\": {\"force_N\": 1}}]}", start);
    char *at = strstr(text, "\"history\"");
    memmove(at + 11, at + 9, strlen(at + 9) + 1);
    memcpy(at, "\"sedef2008\"", 11);
    const char *path = scratch_write("sedef.json", text, strlen(text));
    ck_assert_int_eq(palp_model_read(path, &model, NULL, &error), PALP_ERR_UNSUPPORTED);
    ck_assert_ptr_nonnull(
        strstr(error.text, "sedef.json:9: effects are not supported by formulation sedef2008"));
}
END_TEST

START_TEST(what_could_not_be_read_is_not_written) {
    palp_model model;
    palp_error error;
    ck_assert_int_eq(palp_model_read(model_of(""), &model, NULL, NULL), PALP_OK);
    model.n_effects = 1;
    model.effects[0] = (palp_effect){PALP_EFFECT_SENSOR_LAG, {-1}};
    ck_assert_int_eq(palp_model_write(&model, scratch_path("out.json"), &error), PALP_ERR_ARGUMENT);
    ck_assert_ptr_nonnull(
        strstr(error.text, "not written: sensor_lag: time_s must be between 0 and 1e+09, not -1"));
    model.n_effects = PALP_EFFECTS_MAX + 1;
    ck_assert_int_eq(palp_model_write(&model, scratch_path("out.json"), &error), PALP_ERR_LIMIT);
}
END_TEST

START_TEST(format_has_them_on_its_line) {
    palp_model model;
    char *json;
    const char *path = model_of("{\"id\": \"sensor_lag\", \"parameters\": {\"time_s\": 0.5}}, "
                                "{\"id\": \"toe_region\", \"parameters\": {\"length_mm\": 0.2}}");
    ck_assert_int_eq(palp_model_read(path, &model, NULL, NULL), PALP_OK);
    ck_assert_int_eq(palp_model_format(&model, &json), PALP_OK);
    ck_assert_ptr_nonnull(strstr(json,
                                 "\"effects\": [{\"id\": \"sensor_lag\", \"parameters\": {\"time_s\": 0.5}}, "
                                 "{\"id\": \"toe_region\", \"parameters\": {\"length_mm\": 0.2}}]"));
    free(json);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_checked_fixture(tc, scratch_setup, scratch_teardown);
    tcase_add_test(tc, written_again_is_the_same_file);
    tcase_add_test(tc, every_effect_comes_back);
    tcase_add_loop_test(tc, bad_effects_are_told_with_their_line, 0, (int)(sizeof bad / sizeof bad[0]));
    tcase_add_test(tc, what_may_be_left_out_is_zero);
    tcase_add_test(tc, sedef_takes_none);
    tcase_add_test(tc, what_could_not_be_read_is_not_written);
    tcase_add_test(tc, format_has_them_on_its_line);
}
