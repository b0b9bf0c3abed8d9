/* test_rig_options.c: options of the virtual indenter: scripts, faults and others. */
#define _GNU_SOURCE
#include "rig_make.h"

/* ---- script ---- */

static const char *script(const char *text) {
    FILE *file = fopen(in_folder("script"), "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    return in_folder("script");
}

static void test_script(void **state) {
    static plant_in fed[RECORDS];
    char text[512] = "0 00ff\n7 01\n7 0203\n9 ", path[PATH_MAX];
    rig_settings s = start_with("runs");
    (void)state;
    for (int i = 0; i < 50; i++) {
        strcat(text, "aB");
    }
    strcpy(path, script(strcat(text, "\n")));
    s.script = path;
    assert_int_equal(run(&s, NULL, NULL), CLI_OK);
    size_t n = read_records(fed);
    assert_int_equal(n, 51);
    for (size_t i = 0; i < n; i++) {
        assert_int_equal(fed[i].rx_count, i == 0    ? 2
                                          : i == 7  ? 3
                                          : i == 9  ? PLANT_LINK_RX
                                          : i == 10 ? 50 - PLANT_LINK_RX
                                                    : 0);
    }
    assert_int_equal(fed[0].rx[1], 0xff);
    assert_memory_equal(fed[7].rx, "\1\2\3", 3);
    assert_int_equal(fed[10].rx[13], 0xab);
}

static void test_bad_scripts(void **state) {
    static const char *const bad[][2] = {{"5 00\n4 00\n", ":2: its tick is before"},
                                         {"5 0\n", ":1: wants pairs"},
                                         {"5 00 gg\n", ":1: wants pairs"},
                                         {"5 \n", ":1: wants pairs"},
                                         {"5\n", ":1: wants TICK"},
                                         {"\n", ":1: wants TICK"},
                                         {"-1 00\n", ":1: wants TICK"},
                                         {"1 00\n99999999999 00\n", ":2: wants TICK"}};
    rig_settings s = start_with("runs");
    char path[PATH_MAX];
    (void)state;
    s.script = path;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        strcpy(path, script(bad[i][0]));
        assert_int_equal(run(&s, NULL, bad[i][1]), CLI_FAILURE);
    }
    remove(path);
    assert_int_equal(run(&s, NULL, "script: "), CLI_FAILURE);
}

/* ---- options ---- */

static int parse(const char *line, rig_options *o) {
    char text[512], *argv[32] = {NULL};
    int argc = 0;
    cli_option list[RIG_OPTIONS];
    size_t n;
    strcpy(text, line);
    for (char *word = strtok(text, " "); word; word = strtok(NULL, " ")) {
        argv[argc++] = word;
    }
    *o = rig_options_default();
    rig_options_list(o, list);
    const cli_command command = {NAME, "", "", "", list, RIG_OPTIONS};
    int code = cli_parse(&command, argc, argv, NULL, 0, &n);
    static char kept[512]; /* of the texts, which point into this function's */
    if (o->inject) {
        o->inject = strcpy(kept, o->inject);
    }
    return code;
}

static void test_options(void **state) {
    rig_options o;
    rig_settings s, plain = rig_settings_default();
    (void)state;
    assert_int_equal(parse("test", &o), CLI_OK);
    assert_null(rig_options_given(&o));
    assert_int_equal(rig_options_settings(NAME, &o, NULL, &s), CLI_OK);
    assert_memory_equal(&s.plant, &plain.plant, sizeof s.plant);
    assert_int_equal(
        parse("test --scale 2 --contact-mm 20 --noise-N 0 --bias-N -0.5 --seed 7 --firmware host --paced "
              "--inject over_force@3.5,sensor_silent@7-8.25",
              &o),
        CLI_OK);
    assert_string_equal(rig_options_given(&o), "firmware");
    assert_int_equal(rig_options_settings(NAME, &o, "m.json", &s), CLI_OK);
    assert_string_equal(s.plant.model, "m.json");
    assert_true(s.plant.scale == 2 && fabs(s.plant.contact_m - 0.02) < 1e-15 && s.plant.sensor.noise_N == 0);
    assert_true(s.plant.sensor.bias_N == -0.5 && s.plant.sensor.seed == 7 && s.paced &&
                s.firmware == RIG_HOST);
    assert_int_equal(s.n_injections, 2);
    assert_int_equal(s.injection[0].fault, PALP_WIRE_FAULT_OVER_FORCE);
    assert_true(s.injection[0].time_s == 3.5 && s.injection[0].until_s == 0);
    assert_int_equal(s.injection[1].fault, PALP_WIRE_FAULT_SENSOR_SILENT);
    assert_true(s.injection[1].time_s == 7 && s.injection[1].until_s == 8.25);
}

static void test_bad_options(void **state) {
    static const char *const bad[] = {"over_force",
                                      "over_force@",
                                      "over_force@x",
                                      "over_force@3-2",
                                      "over_force@3-",
                                      "over_force@-1",
                                      "over_force@3s",
                                      "no_fault@1",
                                      "none@1",
                                      "over_force@1,,",
                                      "@1",
                                      "over_force@1;hot@2",
                                      "over_force@1-2-3",
                                      "over_force@1e99",
                                      "over_force@1,hot@2"};
    rig_options o;
    rig_settings s;
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        o = rig_options_default();
        o.inject = bad[i];
        assert_int_equal(rig_options_settings(NAME, &o, NULL, &s), CLI_USAGE);
    }
    assert_int_equal(parse("test --specimen none", &o), CLI_OK);
    assert_int_equal(rig_options_settings(NAME, &o, NULL, &s), CLI_OK);
    assert_int_equal(rig_options_settings(NAME, &o, "m.json", &s), CLI_USAGE);
    o = rig_options_default();
    o.actuator = "no/such/actuator.json";
    assert_int_equal(rig_options_settings(NAME, &o, NULL, &s), CLI_FAILURE);
}

static int tests(void) {
    const struct CMUnitTest all[] = {
        cmocka_unit_test(test_script),
        cmocka_unit_test(test_bad_scripts),
        cmocka_unit_test(test_options),
        cmocka_unit_test(test_bad_options),
    };
    return cmocka_run_group_tests(all, NULL, NULL);
}

int main(int argc, char **argv) {
    return rig_main(argc, argv, tests);
}
