/* test_acquire.c: protocols, recordings that are whole at every moment, sessions with a device that fails. */
/* link: -pthread */
#define _POSIX_C_SOURCE 200809L
#include "acquire/acquire.h"
#include "acquire_fake.h"

#include <errno.h>
#include <math.h>
#include <palpate/experiment.h>
#include <palpate/recording.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static const char *in_folder(const char *name) {
    static char path[4][640];
    static int next;
    char *to = path[next++ % 4];
    const char *scratch = getenv("SCRATCH");
    snprintf(to, 640, "%s/%s", scratch ? scratch : "/tmp", name);
    return to;
}

static void near(double a, double b, double tolerance) {
    if (!(fabs(a - b) <= tolerance)) {
        fail_msg("%.12g is not %.12g", a, b);
    }
}

static acquire_plan *empty_plan(void) {
    acquire_plan *plan = calloc(1, sizeof *plan);
    assert_non_null(plan);
    plan->random = plan->repeat_first = -1;
    plan->seed = NAN;
    return plan;
}

/* ---- protocols ---- */

static void test_ramp_hold(void **state) {
    char why[ACQUIRE_TEXT];
    acquire_plan *plan = empty_plan();
    acquire_motion m = acquire_motion_none();
    (void)state;
    assert_null(acquire_plan_add(plan, ACQUIRE_RAMP_HOLD, &m, NULL, why));
    assert_non_null(strstr(why, "depth_mm"));
    m.depth_mm = 5;
    const acquire_run *r = acquire_plan_add(plan, ACQUIRE_RAMP_HOLD, &m, NULL, why);
    assert_string_equal(r->name, "ramp_hold_5mm");
    assert_int_equal(r->n_segments, 2);
    assert_int_equal(r->segment[0].kind, PALP_WIRE_SEGMENT_MOVE);
    assert_int_equal(r->segment[0].target_nm, 5000000);
    assert_int_equal(r->segment[0].rate_nm_s, 5000000);
    assert_int_equal(r->segment[0].acceleration_um_s2, 500000);
    assert_int_equal(r->segment[1].kind, PALP_WIRE_SEGMENT_HOLD);
    assert_int_equal(r->segment[1].index, 1);
    assert_int_equal(r->segment[1].duration_ms, 200000);
    near(r->start_mm, -1, 0);
    near(r->deepest_mm, 5, 0);
    near(r->highest_mm, -1, 0);
    near(r->press_s, 6.0 / 5 + 200, 1e-12);
    m.rate_mm_s = 2; /* instead of the time */
    m.hold_s = 0;
    r = acquire_plan_add(plan, ACQUIRE_RAMP_HOLD, &m, "named", why);
    assert_string_equal(r->name, "named");
    assert_int_equal(r->n_segments, 1);
    assert_int_equal(r->segment[0].rate_nm_s, 2000000);
    near(r->motion.ramp_s, 2.5, 0);
    assert_true(acquire_plan_arrange(plan));
    near(plan->run[0].motion.rest_s, 0, 0); /* then as long as the last press took, or 200 s */
    near(plan->run[1].motion.rest_s, plan->run[0].press_s, 0);
    free(plan);
}

static void test_kinds(void **state) {
    char why[ACQUIRE_TEXT];
    acquire_plan *plan = empty_plan();
    acquire_motion m = acquire_motion_none();
    (void)state;
    m.depth_mm = 3;
    m.ramp_s = 0.5; /* of ramps only */
    const acquire_run *r = acquire_plan_add(plan, ACQUIRE_STATIC, &m, NULL, why);
    assert_int_equal(r->n_segments, 1);
    assert_int_equal(r->segment[0].rate_nm_s, 100000);
    assert_true(isnan(r->motion.ramp_s) && isnan(r->motion.hold_s) && isnan(r->motion.cycles));
    r = acquire_plan_add(plan, ACQUIRE_CYCLIC, &m, NULL, why);
    assert_int_equal(r->n_segments, 2);
    assert_int_equal(r->segment[0].target_nm, 0);
    assert_int_equal(r->segment[1].kind, PALP_WIRE_SEGMENT_CYCLE);
    assert_int_equal(r->segment[1].cycles, 3);
    near(r->press_s, 1 + 3 * 2 * 3, 1e-12);
    r = acquire_plan_add(plan, ACQUIRE_SWEEP, &m, NULL, why);
    assert_int_equal(r->n_segments, 3);
    assert_int_equal(r->segment[2].target_nm, 300000);
    assert_int_equal(r->segment[2].frequency_mHz, 100);
    assert_int_equal(r->segment[2].frequency_end_mHz, 10000);
    assert_int_equal(r->segment[2].duration_ms, 60000);
    near(r->deepest_mm, 3.3, 1e-12);
    r = acquire_plan_add(plan, ACQUIRE_FREE, &m, NULL, why);
    assert_int_equal(r->n_segments, 2);
    near(r->start_mm, -4, 0);
    near(r->deepest_mm, -1, 0);
    assert_int_equal(r->segment[0].rate_nm_s, 6000000);
    free(plan);
}

static void test_thesis_protocol(void **state) {
    char why[ACQUIRE_TEXT];
    acquire_motion m = acquire_motion_none();
    acquire_plan *plan = empty_plan(), *again = empty_plan();
    size_t seen = 0, moved = 0;
    (void)state;
    m.hold_s = 5;
    assert_true(acquire_plan_seed(plan, &m, why) && acquire_plan_arrange(plan));
    assert_true(acquire_plan_seed(again, &m, why) && acquire_plan_arrange(again));
    assert_int_equal(plan->n, 16);
    assert_string_equal(plan->run[0].name, "air_before");
    assert_string_equal(plan->run[15].name, "air_after");
    for (size_t i = 1; i < 15; i++) {
        const acquire_run *r = &plan->run[i];
        assert_string_equal(r->name, again->run[i].name);
        assert_true(r->kind == ACQUIRE_RAMP_HOLD || r->kind == ACQUIRE_STATIC);
        for (int k = 0; k < 12; k++) {
            seen +=
                r->kind == ACQUIRE_RAMP_HOLD && r->motion.depth_mm == 1.5 + 0.5 * k && !r->repeat ? 1u : 0;
        }
        moved += r->motion.depth_mm != 1.0 + 0.5 * (double)i;
        if (i > 1) { /* at most 107 s were pressed */
            near(r->motion.rest_s, 200, 0);
        }
    }
    assert_int_equal(seen, 12);
    assert_true(moved > 6);
    assert_true(plan->run[14].repeat);
    near(plan->run[14].motion.depth_mm, plan->run[1].motion.depth_mm, 0);
    assert_non_null(strstr(plan->run[14].name, "_repeat"));
    near(plan->run[1].motion.rest_s, 0, 0);
    again->n = 0;
    again->seed = 2;
    assert_true(acquire_plan_seed(again, &m, why) && acquire_plan_arrange(again));
    size_t same = 0;
    for (size_t i = 1; i < 15; i++) {
        same += strcmp(plan->run[i].name, again->run[i].name) == 0;
    }
    assert_true(same < 7);
    free(plan);
    free(again);
}

static acquire_plan *read_protocol(const char *text, const acquire_motion *options, int *code) {
    acquire_plan *plan = empty_plan();
    FILE *to = fopen(in_folder("protocol.json"), "w");
    fputs(text, to);
    fclose(to);
    *code = acquire_plan_read(plan, in_folder("protocol.json"), options);
    return plan;
}

static void test_protocol_file(void **state) {
    int code;
    acquire_motion options = acquire_motion_none();
    (void)state;
    options.hold_s = 7;
    acquire_plan *plan = read_protocol("{\"palpate\": {\"protocol\": 1}, \"hold_s\": 100, \"air_s\": 0.5, "
                                       "\"rate_mm_s\": 2, \"order\": \"random\",\n"
                                       " \"order_seed\": 5, \"repeat_first\": true, \"runs\": [\n"
                                       "  {\"kind\": \"ramp_hold\", \"depth_mm\": 2, \"ramp_s\": 0.5},\n"
                                       "  {\"kind\": \"ramp_hold\", \"depth_mm\": 2, \"hold_s\": 3},\n"
                                       "  {\"kind\": \"segments\", \"name\": \"steps\", \"segments\": [\n"
                                       "    {\"move_to_mm\": 1, \"rate_mm_s\": 4}, {\"hold_s\": 2}, "
                                       "{\"sine_mm\": 0.1, \"frequency_Hz\": 2, \"cycles\": 4},\n"
                                       "    {\"cycle_to_mm\": 3, \"rate_mm_s\": 1, \"cycles\": 2}, "
                                       "{\"move_to_mm\": -0.5, \"rate_mm_s\": 1}]},\n"
                                       "  {\"kind\": \"free\", \"hold_s\": 1}]}",
                                       &options, &code);
    assert_int_equal(code, CLI_OK);
    assert_int_equal(plan->n, 4);
    near(plan->run[0].motion.rate_mm_s, 4, 0); /* its own ramp time before all else */
    near(plan->run[0].motion.hold_s, 7, 0);    /* an option before what the file says for all */
    near(plan->run[1].motion.hold_s, 3, 0);    /* and what a run says before both */
    near(plan->run[1].motion.rate_mm_s, 2, 0);
    near(plan->run[1].motion.air_s, 0.5, 0);
    const acquire_run *steps = &plan->run[2];
    assert_int_equal(steps->n_segments, 5);
    near(steps->press_s, 0.5 + 2 + 2 + 8 + 1.5, 1e-12);
    near(steps->deepest_mm, 3, 0);
    near(steps->at_mm, -0.5, 0);
    assert_int_equal(plan->random, 1);
    near(plan->seed, 5, 0);
    assert_int_equal(plan->repeat_first, 1);
    assert_true(acquire_plan_arrange(plan));
    assert_int_equal(plan->n, 5);
    assert_int_equal(plan->run[4].kind, ACQUIRE_FREE);
    for (size_t i = 0; i < plan->n; i++) {
        for (size_t j = 0; j < i; j++) {
            assert_string_not_equal(plan->run[i].name, plan->run[j].name);
        }
    }
    free(plan);
}

/* A key of the file's own that looks like a place in it: the line is found without leaving the text. */
static void test_strange_keys(void **state) {
    static const char *const keys[] = {"x[", "[", "x[0", "x[5][7]", "x]", "..", "[[0]", "runs[0][1].x"};
    acquire_motion options = acquire_motion_none();
    int code;
    (void)state;
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        char text[128];
        snprintf(text, sizeof text, "{\"palpate\":{\"protocol\":1},\"runs\":[],\"%s\":1}", keys[i]);
        free(read_protocol(text, &options, &code));
        assert_int_equal(code, CLI_FAILURE);
    }
}

static void test_examples(void **state) {
    static const char *const files[] = {"data/protocols/sedef2008.json", "data/protocols/quick.json",
                                        "data/protocols/dynamic.json"};
    acquire_motion options = acquire_motion_none();
    (void)state;
    for (size_t i = 0; i < 3; i++) {
        acquire_plan *plan = empty_plan();
        assert_int_equal(acquire_plan_read(plan, files[i], &options), CLI_OK);
        assert_true(plan->n > 1 && acquire_plan_arrange(plan));
        free(plan);
    }
    acquire_plan *file = empty_plan(), *built_in = empty_plan();
    char why[ACQUIRE_TEXT];
    assert_int_equal(acquire_plan_read(file, files[0], &options), CLI_OK);
    assert_true(acquire_plan_seed(built_in, &options, why) && acquire_plan_arrange(built_in));
    assert_true(acquire_plan_arrange(file));
    assert_int_equal(file->n, built_in->n);
    for (size_t i = 0; i < file->n; i++) {
        assert_string_equal(file->run[i].name, built_in->run[i].name);
        assert_memory_equal(file->run[i].segment, built_in->run[i].segment, sizeof file->run[i].segment);
    }
    free(file);
    free(built_in);
}

/* ---- the file ---- */

static const acquire_scale scale = {
    .tick_s = 1e-3, .count_mm = 1e-3, .contact = 12000, .row_N = {0, 0, 1e-3}, .contact_N = 0.01};

/* Ten ticks from tick on, at 1 mm/s from -1 mm, 1 N/mm. */
static palp_wire_samples block_at(uint32_t tick) {
    palp_wire_samples b = {.tick = tick, .count = 10, .state = PALP_WIRE_STATE_RUN};
    for (size_t i = 0; i < 10; i++) {
        int32_t depth = (int32_t)(tick + i) - 1000;
        b.position[i] = 12000 + depth;
        b.adc[i * PALP_WIRE_CHANNELS + 2] = (int16_t)(depth > 0 ? depth : 0);
        b.flags[i] = PALP_WIRE_FLAG_RECORD | (tick >= 500 ? PALP_WIRE_FLAG_TRAJECTORY : 0);
        b.error[i] = 3;
    }
    return b;
}

static void open_file(acquire_file *f, const char *name, bool raw, uint32_t tick) {
    json_t *header = json_pack("{sf ss}", "specimen.height_mm", 24.0, "protocol.kind", "static");
    assert_int_equal(acquire_file_open(f, in_folder(name), true, raw, &scale, tick, header), CLI_OK);
    json_decref(header);
}

static acquire_file *new_file(const char *name, bool raw) {
    acquire_file *f = calloc(1, sizeof *f);
    open_file(f, name, raw, 0);
    return f;
}

static palp_experiment *read_file(const char *name) {
    palp_experiment *e = NULL;
    palp_error error = {PALP_OK, ""};
    if (palp_experiment_read(in_folder(name), &e, &error) != PALP_OK) {
        fail_msg("%s", error.text);
    }
    return e;
}

static const char *fault_of(const palp_experiment *e) {
    const char *text = NULL;
    return palp_experiment_get_string(e, "end.fault", &text) == PALP_OK ? text : NULL;
}

static void test_file(void **state) {
    acquire_file *f = new_file("file.csv", false);
    double value;
    (void)state;
    for (uint32_t tick = 0; tick < 3000; tick += 10) {
        palp_wire_samples b = block_at(tick);
        if (tick == 100 || tick == 110) {
            continue; /* lost */
        }
        if (tick == 200) {
            b.flags[4] |= PALP_WIRE_FLAG_SENSOR_BAD;
        }
        assert_int_equal(acquire_file_add(f, &b), tick == 200 ? 9 : 10);
        if (tick == 2000) {
            assert_int_equal(acquire_file_add(f, &b), 0); /* the same again */
        }
    }
    assert_int_equal(acquire_file_close(f, NULL, 31.5), CLI_OK);
    palp_experiment *e = read_file("file.csv");
    assert_null(fault_of(e));
    assert_int_equal(palp_experiment_rows(e), 3000 - 21);
    const double *t = palp_experiment_column(e, "time_s"), *d = palp_experiment_column(e, "depth_mm"),
                 *F = palp_experiment_column(e, "force_N");
    near(t[99], 0.099, 0);
    near(t[100], 0.12, 0); /* a gap stays one */
    near(t[2978], 2.999, 0);
    near(d[2978], 1.999, 0);
    near(F[2978], 1.999, 1e-12);
    assert_int_equal(palp_experiment_get_number(e, "end.lost_samples", &value), PALP_OK);
    near(value, 20, 0);
    assert_int_equal(palp_experiment_get_number(e, "end.bad_samples", &value), PALP_OK);
    near(value, 1, 0);
    assert_int_equal(palp_experiment_get_number(e, "end.error_rms_mm", &value), PALP_OK);
    near(value, 0.003, 1e-9);
    assert_int_equal(palp_experiment_get_number(e, "end.contact_mm", &value), PALP_OK);
    near(value, 0.01, 0.01); /* force and depth lag alike */
    assert_int_equal(palp_experiment_get_number(e, "end.winding_C", &value), PALP_OK);
    near(value, 31.5, 0);
    palp_experiment_free(e);
    free(f);
}

static double start_of(const char *name) {
    palp_experiment *e = read_file(name);
    double value = NAN;
    palp_experiment_get_number(e, "session.start_s", &value);
    palp_experiment_free(e);
    return value;
}

/* From first sample to first sample, over the end of the counter; until one comes, as it was expected. */
static void test_session_start(void **state) {
    static const uint32_t tick[] = {UINT32_MAX - 999, 4000, 250000};
    acquire_file *f = new_file("one.csv", false);
    (void)state;
    for (int run = 0; run < 3; run++) {
        if (run > 0) {
            open_file(f, "one.csv", false, tick[run] - 1500);
            near(start_of("one.csv"), 1e-3 * (tick[run] - 1500 - (tick[0] + 1)), 1e-9);
        }
        palp_wire_samples b = block_at(tick[run]);
        b.flags[0] = 0; /* not yet of the recording */
        assert_int_equal(acquire_file_add(f, &b), 9);
        assert_int_equal(acquire_file_close(f, NULL, NAN), CLI_OK);
        near(start_of("one.csv"), 1e-3 * (tick[run] - tick[0]), 1e-9);
    }
    free(f);
}

/* Cut anywhere between pages, which is where a write ends that is cut short, it reads, and is marked. */
static void test_file_cut(void **state) {
    struct stat now;
    (void)state;
    for (int raw = 0; raw < 2; raw++) {
        acquire_file *f = new_file("cut.csv", raw == 1);
        for (uint32_t tick = 0; tick < 2000; tick += 10) {
            palp_wire_samples b = block_at(tick);
            acquire_file_add(f, &b);
        }
        assert_int_equal(acquire_file_close(f, "over_force", NAN), CLI_OK);
        palp_experiment *e = read_file("cut.csv");
        assert_string_equal(fault_of(e), "over_force");
        assert_int_equal(palp_experiment_rows(e), 2000);
        assert_int_equal(palp_experiment_column_count(e), raw ? 13 : 3);
        palp_experiment_free(e);
        assert_int_equal(stat(in_folder("cut.csv"), &now), 0);
        size_t last = 2000;
        for (off_t size = now.st_size / 4096 * 4096; size > 0; size -= 4096) {
            assert_int_equal(truncate(in_folder("cut.csv"), size), 0);
            e = read_file("cut.csv");
            assert_true(palp_experiment_rows(e) < last);
            last = palp_experiment_rows(e);
            palp_experiment_free(e);
        }
        assert_true(last > 0 && last < 200);
        free(f);
    }
}

/* A host that is killed: what was written so far is there, and marked. */
static void test_file_killed(void **state) {
    acquire_file *f = new_file("killed.csv", false);
    (void)state;
    palp_experiment *e = read_file("killed.csv");
    assert_string_equal(fault_of(e), "interrupted");
    assert_int_equal(palp_experiment_rows(e), 0);
    palp_experiment_free(e);
    f->written_s = -10; /* as if half a second had gone by */
    palp_wire_samples b = block_at(0);
    acquire_file_add(f, &b);
    e = read_file("killed.csv");
    assert_string_equal(fault_of(e), "interrupted");
    assert_int_equal(palp_experiment_rows(e), 10);
    palp_experiment_free(e);
    acquire_file_close(f, NULL, NAN);
    free(f);
}

static void test_file_stays(void **state) {
    acquire_file *f = new_file("there.csv", false);
    json_t *header = json_object();
    (void)state;
    assert_int_equal(acquire_file_close(f, NULL, NAN), CLI_OK);
    assert_int_equal(acquire_file_open(f, in_folder("there.csv"), false, false, &scale, 0, header), CLI_FAILURE);
    assert_int_equal(acquire_file_open(f, in_folder("no/there.csv"), false, false, &scale, 0, header),
                     CLI_FAILURE);
    json_decref(header);
    free(f);
}

/* No room: what fits is whole lines, and the failure is told. */
static void test_file_full(void **state) {
    struct rlimit before, less;
    struct sigaction ignore = {.sa_handler = SIG_IGN}, was;
    (void)state;
    sigaction(SIGXFSZ, &ignore, &was);
    getrlimit(RLIMIT_FSIZE, &before);
    less = before;
    less.rlim_cur = 20001;
    setrlimit(RLIMIT_FSIZE, &less);
    acquire_file *f = new_file("full.csv", false);
    for (uint32_t tick = 0; tick < 3000; tick += 10) {
        palp_wire_samples b = block_at(tick);
        acquire_file_add(f, &b);
    }
    assert_int_equal(acquire_file_close(f, NULL, NAN), CLI_FAILURE);
    setrlimit(RLIMIT_FSIZE, &before);
    sigaction(SIGXFSZ, &was, NULL);
    assert_int_equal(f->error, EFBIG);
    palp_experiment *e = read_file("full.csv");
    assert_true(palp_experiment_rows(e) > 500 && palp_experiment_rows(e) < 3000);
    palp_experiment_free(e);
    free(f);
}

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
    acquire_options options = {.port = "fake",
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
    cmocka_unit_test(test_ramp_hold),
    cmocka_unit_test(test_kinds),
    cmocka_unit_test(test_thesis_protocol),
    cmocka_unit_test(test_protocol_file),
    cmocka_unit_test(test_strange_keys),
        cmocka_unit_test(test_examples),
    cmocka_unit_test(test_file),
    cmocka_unit_test(test_session_start),
    cmocka_unit_test(test_file_cut),
    cmocka_unit_test(test_file_killed),
    cmocka_unit_test(test_file_stays),
    cmocka_unit_test(test_file_full),
    cmocka_unit_test(test_session),
    cmocka_unit_test(test_fault),
    cmocka_unit_test(test_latched),
    cmocka_unit_test(test_unplugged),
    cmocka_unit_test(test_restarted),
    cmocka_unit_test(test_stopped),
    cmocka_unit_test(test_lost),
    cmocka_unit_test(test_refused),
    cmocka_unit_test(test_curve),
    {0},
};
