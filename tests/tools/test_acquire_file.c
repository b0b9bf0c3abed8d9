/* test_acquire_file.c: the file that acquire writes, also after a failed write. */
/* link: -pthread */
#define _POSIX_C_SOURCE 200809L
#include "acquire_make.h"

#include <errno.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

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

static void open_file(acquire_file *f, const char *name, unsigned columns, uint32_t tick) {
    json_t *header = json_pack("{sf ss}", "specimen.height_mm", 24.0, "protocol.kind", "static");
    assert_int_equal(acquire_file_open(f, in_folder(name), true, columns, &scale, tick, header), CLI_OK);
    json_decref(header);
}

static acquire_file *new_file(const char *name, unsigned columns) {
    acquire_file *f = calloc(1, sizeof *f);
    open_file(f, name, columns, 0);
    return f;
}

static void test_file(void **state) {
    acquire_file *f = new_file("file.csv", 0);
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

/* All the columns that there are; each force by its row of the matrix, what is tared taken off. */
static void test_columns(void **state) {
    acquire_file *f =
        new_file("columns.csv", ACQUIRE_RAW | ACQUIRE_FORCES | ACQUIRE_TEMPERATURE | ACQUIRE_TRIGGER);
    palp_wire_samples b = block_at(2000);
    (void)state;
    f->scale.tare[0] = 100;
    for (int axis = 0; axis < PALP_WIRE_CHANNELS; axis++) {
        f->scale.matrix[axis][axis] = 1e-3 * (axis + 1);
        b.adc[3 * PALP_WIRE_CHANNELS + axis] = (int16_t)(axis == 0 ? -32768 : 1000 + axis);
    }
    b.case_cC = -1234;
    b.flags[3] |= PALP_WIRE_FLAG_TRIGGER_IN;
    b.flags[4] |= PALP_WIRE_FLAG_TRIGGER_OUT;
    acquire_file_add(f, &b);
    assert_int_equal(acquire_file_close(f, NULL, NAN), CLI_OK);
    free(f);
    palp_experiment *e = read_file("columns.csv");
    assert_int_equal(palp_experiment_column_count(e), 22);
    near(palp_experiment_column(e, "Fx_N")[3], -32.868, 1e-9);
    near(palp_experiment_column(e, "Fy_N")[3], 2.002, 1e-9);
    near(palp_experiment_column(e, "Tz_Nm")[3], 6.03, 1e-9);
    near(palp_experiment_column(e, "temperature_C")[9], -12.34, 1e-9);
    for (size_t i = 0; i < 10; i++) {
        near(palp_experiment_column(e, "trigger_in")[i], i == 3, 0);
        near(palp_experiment_column(e, "trigger_out")[i], i == 4, 0);
    }
    palp_experiment_free(e);
    assert_int_equal(acquire_columns("forces,temperature"), ACQUIRE_FORCES | ACQUIRE_TEMPERATURE);
    assert_int_equal(acquire_columns("temperature"), ACQUIRE_TEMPERATURE);
    assert_int_equal(acquire_columns("forces,"), ACQUIRE_FORCES);
    assert_int_equal(acquire_columns("force"), 0);
    assert_int_equal(acquire_columns("forces,forces"), 0);
    assert_int_equal(acquire_columns(""), 0);
}

static double start_of(const char *name) {
    palp_experiment *e = read_file(name);
    double value = NAN;
    palp_experiment_get_number(e, "session.start_s", &value);
    palp_experiment_free(e);
    return value;
}

/* From first sample to first sample, over the end of the counter; until one comes, as it was expected. */
/* What is missing at either end counts as well: samples of no recording stand before it and after it. */
static void test_lost_at_the_ends(void **state) {
    acquire_file *f = new_file("ends.csv", 0);
    (void)state;
    for (uint32_t tick = 0; tick < 2000; tick += 10) {
        palp_wire_samples b = block_at(tick);
        for (int i = 0; i < 10; i++) {
            b.flags[i] &= tick >= 200 && tick < 1800 ? 0xffff : (uint16_t)~PALP_WIRE_FLAG_RECORD;
        }
        if ((tick < 190 || tick >= 300) && (tick < 1500 || tick >= 1900)) {
            acquire_file_add(f, &b);
        }
    }
    assert_int_equal(f->figures.samples, 1200);
    assert_int_equal(f->figures.lost, 110 + 400);
    assert_true(acquire_file_lossy(&f->figures));
    assert_int_equal(acquire_file_close(f, NULL, NAN), CLI_OK);
    free(f);
}

static void test_session_start(void **state) {
    static const uint32_t tick[] = {UINT32_MAX - 999, 4000, 250000};
    acquire_file *f = new_file("one.csv", 0);
    (void)state;
    for (int run = 0; run < 3; run++) {
        if (run > 0) {
            open_file(f, "one.csv", 0, tick[run] - 1500);
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
        acquire_file *f = new_file("cut.csv", raw ? ACQUIRE_RAW : 0);
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
    acquire_file *f = new_file("killed.csv", 0);
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
    acquire_file *f = new_file("there.csv", 0);
    json_t *header = json_object();
    (void)state;
    assert_int_equal(acquire_file_close(f, NULL, NAN), CLI_OK);
    assert_int_equal(acquire_file_open(f, in_folder("there.csv"), 0, false, &scale, 0, header), CLI_FAILURE);
    assert_int_equal(acquire_file_open(f, in_folder("no/there.csv"), 0, false, &scale, 0, header),
                     CLI_FAILURE);
    json_decref(header);
    free(f);
}

/* A full disk: the file has whole lines, and the failure is reported. */
static void test_file_full(void **state) {
    struct rlimit before, less;
    struct sigaction ignore = {.sa_handler = SIG_IGN}, was;
    (void)state;
    sigaction(SIGXFSZ, &ignore, &was);
    getrlimit(RLIMIT_FSIZE, &before);
    less = before;
    less.rlim_cur = 20001;
    setrlimit(RLIMIT_FSIZE, &less);
    acquire_file *f = new_file("full.csv", 0);
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
    double samples = 0;
    assert_int_equal(palp_experiment_get_number(e, "end.samples", &samples), PALP_OK);
    near(samples, (double)palp_experiment_rows(e), 0);
    palp_experiment_free(e);
    free(f);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_file),
    cmocka_unit_test(test_columns),
    cmocka_unit_test(test_lost_at_the_ends),
    cmocka_unit_test(test_session_start),
    cmocka_unit_test(test_file_cut),
    cmocka_unit_test(test_file_killed),
    cmocka_unit_test(test_file_stays),
    cmocka_unit_test(test_file_full),
    {0},
};
