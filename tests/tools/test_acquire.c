/* test_acquire.c: sessions of acquire against a scripted indenter. */
/* link: -pthread */
#define _POSIX_C_SOURCE 200809L
#include "acquire_make.h"

#include <palpate/recording.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- sessions ---- */

typedef struct outcome {
    int code;
    char words[4096]; /* on stderr */
    json_t *summary;
    fake device;
} outcome;

static void read_words(outcome *o, const char *file) {
    FILE *from = fopen(file, "r");
    size_t n = from ? fread(o->words, 1, sizeof o->words - 1, from) : 0;
    o->words[n] = '\0';
    if (from) {
        fclose(from);
    }
}

/* Two ramps and holds, in a folder of its own. */
static void run_session(const fake_settings *settings, const char *name, outcome *o) {
    char out[600], why[ACQUIRE_TEXT];
    acquire_options options = {.command = "acquire",
                               .port = "fake",
                               .height_mm = 24,
                               .contact_N = 0.01,
                               .gains = PALP_WIRE_GAINS_AUTO,
                               .specimen_kind = "cylinder",
                               .calibration = {[2] = true},
                               .row = {[2] = {0, 0, 781250}}};
    acquire_plan *plan = empty_plan();
    acquire_motion m = acquire_motion_none();
    m.hold_s = 0.5;
    m.air_s = m.after_s = m.rest_s = 0.2;
    for (m.depth_mm = 2; m.depth_mm < 5; m.depth_mm += 2) {
        assert_non_null(acquire_plan_add(plan, ACQUIRE_RAMP_HOLD, &m, NULL, why));
    }
    assert_true(acquire_plan_arrange(plan));
    snprintf(out, sizeof out, "%s", in_folder(name));
    mkdir(out, 0777);
    fake_start(&o->device, settings);
    options.where = o->device.port;
    options.out = out;
    options.force = true;
    fflush(stderr);
    int saved = dup(STDERR_FILENO);
    assert_non_null(freopen(in_folder("words"), "w", stderr));
    o->summary = NULL;
    o->code = acquire_session(&options, plan, &o->summary);
    fflush(stderr);
    dup2(saved, STDERR_FILENO);
    close(saved);
    fake_join(&o->device);
    read_words(o, in_folder("words"));
    free(plan);
}

static bool there(const char *name) {
    return access(in_folder(name), F_OK) == 0;
}

static double number_of(const palp_experiment *e, const char *key) {
    double value = NAN;
    palp_experiment_get_number(e, key, &value);
    return value;
}

static void says(const outcome *o, const char *text) {
    if (!strstr(o->words, text)) {
        fail_msg("\"%s\" is not in \"%s\"", text, o->words);
    }
}

/* A failure's words are one line, the last; before it one about contact and one for each run that was done.
 */
static void fails(const outcome *o, int code, size_t lines, const char *text) {
    size_t n = 0;
    for (const char *c = o->words; *c; c++) {
        n += *c == '\n';
    }
    says(o, text);
    assert_int_equal(n, lines);
    assert_int_equal(o->code, code);
}

static void test_session(void **state) {
    static outcome o;
    const fake_settings settings = {0};
    palp_recording r;
    palp_error error;
    (void)state;
    run_session(&settings, "plain", &o);
    fails(&o, CLI_OK, 3, "ramp_hold_4mm.csv");
    assert_int_equal(o.device.starts, 2);
    assert_int_equal(o.device.stops, 0);
    assert_int_equal(o.device.homings, 1);
    assert_int_equal(json_array_size(json_object_get(o.summary, "runs")), 2);
    assert_true(json_is_null(json_object_get(o.summary, "fault")));
    json_decref(o.summary);
    palp_experiment *e = read_file("plain/ramp_hold_2mm.csv");
    assert_null(fault_of(e));
    near(number_of(e, "protocol.order"), 1, 0);
    near(number_of(e, "protocol.rate_mm_s"), 2, 0);
    near(number_of(e, "device.stiffness_N_m"), 477, 0);
    near(number_of(e, "end.lost_samples"), 0, 0);
    size_t rows = palp_experiment_rows(e);
    near((double)rows, 200 + 1500 + 500 + 600 + 200, 10);
    const double *t = palp_experiment_column(e, "time_s"), *d = palp_experiment_column(e, "depth_mm"),
                 *F = palp_experiment_column(e, "force_N");
    near(t[0], 0, 0);
    near(t[rows - 1], 1e-3 * (double)(rows - 1), 1e-9);
    near(d[0], -1, 1e-3);
    for (size_t i = 0; i < rows; i++) {
        near(F[i], 0.477 * fmax(d[i], 0), 1.0 / 1280);
    }
    const palp_recording_settings defaults = palp_recording_settings_default();
    assert_int_equal(palp_recording_prepare(e, "x", &defaults, &r, &error), PALP_OK);
    near(r.deepest_m, 2e-3, 1e-9);
    near(r.end_s, t[0] + 0.2 + 1.5 + 0.5, 0.01); /* the way back does not count */
    palp_recording_free(&r);
    palp_experiment_free(e);
}

static void test_fault(void **state) {
    static outcome o;
    const fake_settings settings = {
        .fault = PALP_WIRE_FAULT_OVER_TEMPERATURE, .fault_run = 2, .fault_tick = 1234};
    (void)state;
    run_session(&settings, "fault", &o);
    fails(&o, CLI_DEVICE_FAULT, 3, "over_temperature (the motor is too hot), run 2 of 2 at 1.233 s");
    says(&o, "fault/ramp_hold_4mm.csv");
    says(&o, "clear-fault --port fake");
    assert_string_equal(json_string_value(json_object_get(o.summary, "fault")), "over_temperature");
    json_decref(o.summary);
    palp_experiment *e = read_file("fault/ramp_hold_4mm.csv");
    assert_string_equal(fault_of(e), "over_temperature");
    assert_int_equal(palp_experiment_rows(e), 1234);
    palp_experiment_free(e);
    e = read_file("fault/ramp_hold_2mm.csv");
    assert_null(fault_of(e));
    palp_experiment_free(e);
}

static void test_latched(void **state) {
    static outcome o;
    const fake_settings settings = {.latched = PALP_WIRE_FAULT_EMERGENCY_STOP};
    (void)state;
    run_session(&settings, "latched", &o);
    fails(&o, CLI_DEVICE_FAULT, 1, "emergency_stop");
    says(&o, "clear-fault");
    assert_int_equal(o.device.homings, 0);
    assert_false(there("latched/ramp_hold_2mm.csv"));
    json_decref(o.summary);
}

static void test_unplugged(void **state) {
    static outcome o;
    const fake_settings settings = {.unplug_tick = 777};
    (void)state;
    run_session(&settings, "unplugged", &o);
    fails(&o, CLI_FAILURE, 2, "has closed");
    json_decref(o.summary);
    palp_experiment *e = read_file("unplugged/ramp_hold_2mm.csv");
    assert_string_equal(fault_of(e), "disconnected");
    assert_int_equal(palp_experiment_rows(e), 777);
    palp_experiment_free(e);
}

static void test_restarted(void **state) {
    static outcome o;
    const fake_settings settings = {.restart_tick = 900};
    (void)state;
    run_session(&settings, "restarted", &o);
    fails(&o, CLI_DEVICE_FAULT, 2, "watchdog_reset");
    json_decref(o.summary);
    palp_experiment *e = read_file("restarted/ramp_hold_2mm.csv");
    assert_string_equal(fault_of(e), "watchdog_reset");
    size_t rows = palp_experiment_rows(e); /* the block under way died with it */
    assert_true(rows > 890 && rows <= 900);
    palp_experiment_free(e);
}

static void test_stopped(void **state) {
    static outcome o;
    const fake_settings settings = {.signal_tick = 800};
    (void)state;
    run_session(&settings, "stopped", &o);
    fails(&o, CLI_FAILURE, 2, "stopped, run 1 of 2");
    assert_int_equal(o.device.stops, 1);
    json_decref(o.summary);
    palp_experiment *e = read_file("stopped/ramp_hold_2mm.csv");
    assert_string_equal(fault_of(e), "stopped");
    assert_true(palp_experiment_rows(e) >= 800);
    palp_experiment_free(e);
    assert_false(there("stopped/ramp_hold_4mm.csv"));
}

static void test_lost(void **state) {
    static outcome o;
    const fake_settings settings = {.lose_tick = 500, .bad_tick = 700, .contact_mm = 0.5};
    (void)state;
    run_session(&settings, "lost", &o);
    fails(&o, CLI_OK, 4, "lost, 1 without a reading");
    says(&o, "ramp_hold_4mm.csv: contact at 0.5");
    json_decref(o.summary);
    palp_experiment *e = read_file("lost/ramp_hold_2mm.csv");
    double lost = number_of(e, "end.lost_samples");
    assert_true(lost >= 10);
    near(number_of(e, "end.bad_samples"), 1, 0);
    const double *t = palp_experiment_column(e, "time_s");
    size_t rows = palp_experiment_rows(e);
    near(1e3 * t[rows - 1] + 1, (double)rows + lost + 1, 1e-6);
    palp_experiment_free(e);
}

/* Most of a run does not arrive: it is not passed off as one, wherever the hole is. */
static void test_lost_too_much(void **state) {
    static outcome o;
    static const uint32_t from[] = {1, 500, 1500}, n[] = {2400, 1800, 1400};
    (void)state;
    for (size_t i = 0; i < 3; i++) {
        char folder[32], path[64];
        snprintf(folder, sizeof folder, "holes%zu", i);
        snprintf(path, sizeof path, "%s/ramp_hold_2mm.csv", folder);
        const fake_settings settings = {.lose_tick = from[i], .lose_ticks = n[i]};
        run_session(&settings, folder, &o);
        assert_int_equal(o.code, CLI_FAILURE);
        says(&o, "ramp_hold_2mm.csv lacks ");
        says(&o, "; and 1 more like it");
        json_t *first = json_array_get(json_object_get(o.summary, "runs"), 0);
        assert_string_equal(json_string_value(json_object_get(first, "fault")), "samples_lost");
        json_decref(o.summary);
        palp_experiment *e = read_file(path);
        assert_string_equal(fault_of(e), "samples_lost");
        near(number_of(e, "end.samples"), (double)palp_experiment_rows(e), 0);
        near((double)palp_experiment_rows(e) + number_of(e, "end.lost_samples"), 3000, 40);
        palp_experiment_free(e);
    }
}

static void test_refused(void **state) {
    static outcome o;
    (void)state;
    run_session(&(fake_settings){.protocol = 9}, "version", &o);
    fails(&o, CLI_FAILURE, 1, "protocol 9");
    assert_null(o.summary);
    run_session(&(fake_settings){.no_contact = true}, "nothing", &o);
    fails(&o, CLI_FAILURE, 1, "no contact");
    assert_int_equal(o.device.starts, 0);
    json_decref(o.summary);
}

/* ---- the curve ---- */

static void test_curve(void **state) {
    static acquire_live live;
    char text[4096];
    (void)state;
    acquire_live_start(&live, true);
    acquire_live_begin(&live, true);
    for (int i = 0; i <= 20000; i++) { /* more than it keeps */
        acquire_live_add(&live,
                         &(acquire_sample){.time_s = 1e-3 * i, .depth_mm = 1e-4 * i, .force_N = 3e-4 * i});
    }
    FILE *to = fmemopen(text, sizeof text, "w");
    acquire_live_draw(&live, 11, 21, to);
    fclose(to);
    assert_non_null(strstr(text, "   6.0"));
    assert_non_null(strstr(text, "mm\n"));
    const char *row = text;
    for (int r = 0; r < 11; r++, row = strchr(row, '\n') + 1) { /* a straight line, from corner to corner */
        for (int c = 0; c < 21; c++) {
            bool on = row[10 + c] == '*';
            assert_true(on ? abs(c - 2 * (10 - r)) <= 1 : c != 2 * (10 - r));
        }
    }
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_session),
    cmocka_unit_test(test_fault),
    cmocka_unit_test(test_latched),
    cmocka_unit_test(test_unplugged),
    cmocka_unit_test(test_restarted),
    cmocka_unit_test(test_stopped),
    cmocka_unit_test(test_lost),
    cmocka_unit_test(test_lost_too_much),
    cmocka_unit_test(test_refused),
    cmocka_unit_test(test_curve),
    {0},
};
