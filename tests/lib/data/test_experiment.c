/* test_experiment.c: the experiment CSV: round trips, every error with its line, atomic writing. */
#define _POSIX_C_SOURCE 200809L
#include <palpate/experiment.h>

#include "scratch.h"

#include <math.h>
#include <stdint.h>

/* ---- errors ---- */

static const struct {
    const char *name; /* of tests/data/bad/run_NAME.csv */
    int line;
    const char *text;
} bad[] = {
    {"after_blank", 7, "numbers after the end of the run, where only \"# key: value\" lines may stand"},
    {"after_end", 7, "numbers after the end of the run, where only \"# key: value\" lines may stand"},
    {"column_empty", 3, "\"\" is not a column name; expected time_s,depth_mm,force_N"},
    {"column_twice", 3, "column depth_mm is given twice; rename one"},
    {"comment", 2, "expected \"# key: JSON value\", not \"# pressed on a Tuesday\""},
    {"cut", 6,
     "the last line has no line end, as if cut short; remove the line, or end it if it is complete"},
    {"cut_header", 2,
     "the last line has no line end, as if cut short; remove the line, or end it if it is complete"},
    {"empty", 1, "no line \"# palpate.experiment: 1\" before this: not an experiment of palpate"},
    {"empty_field", 6, "depth_mm is not a finite number: \"\""},
    {"hexadecimal", 6, "depth_mm is not a finite number: \"0x1p3\""},
    {"infinity", 6, "depth_mm is not a finite number: \"inf\""},
    {"key_twice", 3, "specimen.height_mm is given twice; keep one"},
    {"names_missing", 3, "\"0\" is not a column name; expected time_s,depth_mm,force_N"},
    {"nan", 6, "force_N is not a finite number: \"nan\""},
    {"narrow", 6, "2 numbers where the name row has 3 columns"},
    {"no_force", 3, "no column force_N: the name row must have time_s, depth_mm and force_N"},
    {"no_names", 3, "no name row (time_s,depth_mm,force_N) before the end of the file"},
    {"no_number", 6, "force_N is not a finite number: \"12N\""},
    {"no_version", 2, "no line \"# palpate.experiment: 1\" before this: not an experiment of palpate"},
    {"nul", 5, "depth_mm is not a finite number: \"0.5\""},
    {"overflow", 6, "depth_mm is not a finite number: \"1e999\""},
    {"semicolon", 3, "no column time_s: the name row must have time_s, depth_mm and force_N"},
    {"time", 7, "time_s does not increase (0.3 after 0.31)"},
    {"time_equal", 6, "time_s does not increase (0.1 after 0.1)"},
    {"unit", 3, "column \"depth_m\": \"depth_mm\" is expected; convert the unit"},
    {"value", 2,
     "the value of specimen.kind is not JSON: invalid token near 'cylinder' (put text in quotes)"},
    {"version_2", 1, "palpate.experiment is not 1, the only version that this build reads"},
    {"wide", 6, "4 numbers where the name row has 3 columns"},
};

START_TEST(bad_file_gives_its_line) {
    char path[SCRATCH_PATH], want[PALP_ERROR_TEXT];
    palp_error error;
    palp_experiment *experiment;
    snprintf(path, sizeof path, "%s/bad/run_%s.csv", PALP_TEST_DATA, bad[_i].name);
    ck_assert_int_lt(snprintf(want, sizeof want, "%s:%d: %s", path, bad[_i].line, bad[_i].text),
                     (int)sizeof want);
    ck_assert_int_eq(palp_experiment_read(path, &experiment, &error), PALP_ERR_INPUT);
    ck_assert_int_eq(error.status, PALP_ERR_INPUT);
    ck_assert_str_eq(error.text, want);
    ck_assert_ptr_null(experiment);
    ck_assert_int_eq(palp_experiment_read(path, &experiment, NULL), PALP_ERR_INPUT);
}
END_TEST

START_TEST(missing_file_is_a_file_error) {
    palp_error error;
    palp_experiment *experiment;
    ck_assert_int_eq(palp_experiment_read("/nowhere/run.csv", &experiment, &error), PALP_ERR_FILE);
    ck_assert_str_eq(error.text, "/nowhere/run.csv: cannot open: No such file or directory");
    ck_assert_ptr_null(experiment);
}
END_TEST

/* ---- reading ---- */

static const char sample[] = "# palpate.experiment: 1\n"
                             "# specimen.height_mm: 24.0\n"
                             "# specimen.kind: \"cylinder\"\n"
                             "# protocol.order: [3, 1, 2.5]\n"
                             "# lab: {\"room\": \"B 12\", \"heated\": true}\n"
                             "time_s,depth_mm,force_N,temperature_C\n"
                             "0,0,0.001,21.5\n"
                             "0.1,0.5,0.30000000000000004,21.5\n"
                             "0.25,-1e-3,1.25,21.6\n"
                             "# end.fault: \"over_temperature\"\n";

static palp_experiment *read_text(const char *text) {
    palp_error error = {PALP_OK, ""};
    palp_experiment *experiment;
    const char *path = scratch_write("run.csv", text, strlen(text));
    ck_assert_msg(palp_experiment_read(path, &experiment, &error) == PALP_OK, "%s", error.text);
    return experiment;
}

static void is_sample(const palp_experiment *experiment) {
    static const double want[4][3] = {
        {0, 0.1, 0.25}, {0, 0.5, -1e-3}, {0.001, 0.1 + 0.2, 1.25}, {21.5, 21.5, 21.6}};
    static const char *const names[] = {"time_s", "depth_mm", "force_N", "temperature_C"};
    const char *text;
    double value;
    ck_assert_uint_eq(palp_experiment_rows(experiment), 3);
    ck_assert_uint_eq(palp_experiment_column_count(experiment), 4);
    for (size_t j = 0; j < 4; j++) {
        ck_assert_str_eq(palp_experiment_column_name(experiment, j), names[j]);
        for (size_t i = 0; i < 3; i++)
            ck_assert_double_eq(palp_experiment_column(experiment, names[j])[i], want[j][i]);
    }
    ck_assert_ptr_null(palp_experiment_column_name(experiment, 4));
    ck_assert_ptr_null(palp_experiment_column(experiment, "pressure_Pa"));
    ck_assert_int_eq(palp_experiment_get_number(experiment, "specimen.height_mm", &value), PALP_OK);
    ck_assert_double_eq(value, 24);
    ck_assert_int_eq(palp_experiment_get_string(experiment, "specimen.kind", &text), PALP_OK);
    ck_assert_str_eq(text, "cylinder");
    ck_assert_int_eq(palp_experiment_get_string(experiment, "end.fault", &text), PALP_OK);
    ck_assert_str_eq(text, "over_temperature");
}

START_TEST(keys_are_json) {
    static const char *const given[][2] = {
        {"list", "[1, 2.5, null]"}, {"flag", "true"}, {"whole", "7"}, {"third", "0.33333333333333331"}};
    palp_experiment *experiment;
    char *text;
    double value;
    ck_assert_int_eq(palp_experiment_create(1, &experiment), PALP_OK);
    for (size_t i = 0; i < 4; i++) {
        ck_assert_int_eq(palp_experiment_set_json(experiment, given[i][0], given[i][1]), PALP_OK);
        ck_assert_str_eq(palp_experiment_key(experiment, i + 1), given[i][0]);
    }
    ck_assert_str_eq(palp_experiment_key(experiment, 0), "palpate.experiment");
    ck_assert_ptr_null(palp_experiment_key(experiment, 5));
    ck_assert_int_eq(palp_experiment_get_number(experiment, "third", &value), PALP_OK);
    ck_assert_double_eq(value, 1.0 / 3);
    for (size_t i = 0; i < 4; i++) {
        ck_assert_int_eq(palp_experiment_get_json(experiment, given[i][0], &text), PALP_OK);
        ck_assert_str_eq(text, i == 3 ? "0.3333333333333333" : given[i][1]);
        free(text);
    }
    ck_assert_int_eq(palp_experiment_get_json(experiment, "none", &text), PALP_ERR_INPUT);
    ck_assert_int_eq(palp_experiment_set_json(experiment, "list", "[1,"), PALP_ERR_INPUT);
    ck_assert_int_eq(palp_experiment_set_json(experiment, "a key", "1"), PALP_ERR_ARGUMENT);
    palp_experiment_free(experiment);
}
END_TEST

START_TEST(sample_is_read) {
    double value = -1;
    const char *text = NULL;
    palp_experiment *experiment = read_text(sample);
    is_sample(experiment);
    ck_assert_int_eq(palp_experiment_get_number(experiment, "specimen.kind", &value), PALP_ERR_INPUT);
    ck_assert_int_eq(palp_experiment_get_string(experiment, "specimen.height_mm", &text), PALP_ERR_INPUT);
    ck_assert_int_eq(palp_experiment_get_number(experiment, "protocol.rate_mm_s", &value), PALP_ERR_INPUT);
    palp_experiment_free(experiment);
    palp_experiment_free(NULL);
}
END_TEST

/* With CR LF at every line end, a byte order mark, blanks about the numbers and empty lines. */
START_TEST(line_ends_marks_and_blanks_do_not_matter) {
    char text[2 * sizeof sample + 32] = "\xEF\xBB\xBF\r\n";
    size_t n = strlen(text);
    for (const char *p = sample; *p; p++) {
        if (*p == ',')
            text[n++] = ' ';
        if (*p == '\n')
            text[n++] = '\r';
        text[n++] = *p;
        if (*p == ',')
            text[n++] = '\t';
    }
    strcpy(text + n, "\r\n\n");
    palp_experiment *experiment = read_text(text);
    is_sample(experiment);
    palp_experiment_free(experiment);
}
END_TEST

START_TEST(no_rows_is_an_experiment_too) {
    palp_experiment *experiment = read_text("# palpate.experiment: 1\nforce_N,depth_mm,time_s\n");
    ck_assert_uint_eq(palp_experiment_rows(experiment), 0);
    ck_assert_str_eq(palp_experiment_column_name(experiment, 0), "force_N");
    palp_experiment_free(experiment);
}
END_TEST

/* Every truncation is read or gives one line that starts with the file's name. */
START_TEST(truncations_are_read_or_named) {
    const char *path = scratch_path("cut.csv");
    int read = 0;
    for (size_t n = 0; n < sizeof sample; n++) {
        palp_error error = {PALP_OK, ""};
        palp_experiment *experiment;
        scratch_write("cut.csv", sample, n);
        palp_status status = palp_experiment_read(path, &experiment, &error);
        read += status == PALP_OK;
        palp_experiment_free(experiment);
        if (status) {
            ck_assert_int_eq(status, PALP_ERR_INPUT);
            ck_assert_int_eq(strncmp(error.text, path, strlen(path)), 0);
            ck_assert_int_eq(error.text[strlen(path)], ':');
        } else
            ck_assert_int_eq(sample[n - 1], '\n');
    }
    ck_assert_int_eq(read, 5); /* after the name row, after each row, and whole */
}
END_TEST

/* Every byte of the sample changed to each of a few: no crash, and what is read is finite. */
START_TEST(changed_bytes_are_survived) {
    static const char bytes[] = {'\0', '\n', '\r', ',', '#', '"', '-', 'e', '9', ' ', ':', (char)0xC3};
    char text[sizeof sample];
    const char *path = scratch_path("changed.csv");
    for (size_t i = 0; i + 1 < sizeof sample; i++)
        for (size_t k = 0; k < sizeof bytes; k++) {
            palp_experiment *experiment;
            palp_error error = {PALP_OK, ""};
            memcpy(text, sample, sizeof sample);
            text[i] = bytes[k];
            scratch_write("changed.csv", text, sizeof sample - 1);
            if (palp_experiment_read(path, &experiment, &error)) {
                ck_assert_int_eq(strncmp(error.text, path, strlen(path)), 0);
                continue;
            }
            for (size_t row = 0; row < palp_experiment_rows(experiment); row++)
                ck_assert(isfinite(palp_experiment_column(experiment, "force_N")[row]));
            palp_experiment_free(experiment);
        }
}
END_TEST

/* ---- writing ---- */

START_TEST(text_that_is_read_is_written_back) {
    palp_experiment *experiment = read_text(sample);
    const char *path = scratch_path("out.csv");
    ck_assert_int_eq(palp_experiment_write(experiment, path, NULL), PALP_OK);
    palp_experiment_free(experiment);
    char *text = scratch_read(path), want[sizeof sample];
    strcpy(want, sample);
    char *number = strstr(want, "-1e-3"); /* the one number that is not in its shortest form */
    ck_assert_ptr_nonnull(number);
    ck_assert_ptr_nonnull(strstr(text, "0.25,-0.001,1.25,21.6\n"));
    ck_assert_int_eq(strncmp(text, want, (size_t)(number - want)), 0);
    ck_assert_str_eq(strstr(text, ",1.25,"), strstr(want, ",1.25,"));
    free(text);
}
END_TEST

static double random_unit(uint64_t *state) {
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*state >> 11) * 0x1p-53;
}

START_TEST(numbers_come_back_bit_for_bit) {
    enum { ROWS = 5000 };
    palp_experiment *made, *back;
    uint64_t state = 1;
    ck_assert_int_eq(palp_experiment_create(ROWS, &made), PALP_OK);
    ck_assert_int_eq(palp_experiment_add_column(made, "raw_counts"), PALP_OK);
    ck_assert_int_eq(palp_experiment_set_number(made, "specimen.height_mm", 0.1 + 0.2), PALP_OK);
    for (size_t j = 0; j < 4; j++) {
        double *column = palp_experiment_column(made, palp_experiment_column_name(made, j)), time_s = -3;
        for (size_t i = 0; i < ROWS; i++) {
            double u = random_unit(&state);
            time_s += u * 1e-3;
            column[i] = j == 0 ? time_s : (u - 0.5) * pow(10, floor(600 * random_unit(&state) - 300));
        }
    }
    const char *path = scratch_path("out.csv");
    ck_assert_int_eq(palp_experiment_write(made, path, NULL), PALP_OK);
    ck_assert_int_eq(palp_experiment_read(path, &back, NULL), PALP_OK);
    ck_assert_uint_eq(palp_experiment_rows(back), ROWS);
    for (size_t j = 0; j < 4; j++) {
        const char *name = palp_experiment_column_name(made, j);
        ck_assert_mem_eq(palp_experiment_column(back, name), palp_experiment_column(made, name),
                         ROWS * sizeof(double));
    }
    double height_mm;
    ck_assert_int_eq(palp_experiment_get_number(back, "specimen.height_mm", &height_mm), PALP_OK);
    ck_assert_double_eq(height_mm, 0.1 + 0.2);
    palp_experiment_free(made);
    palp_experiment_free(back);
}
END_TEST

/* Two rows at 0 s and 1 s. */
static palp_experiment *small(void) {
    palp_experiment *experiment;
    ck_assert_int_eq(palp_experiment_create(2, &experiment), PALP_OK);
    palp_experiment_column(experiment, "time_s")[1] = 1;
    return experiment;
}

START_TEST(created_experiment_is_written_as_designed) {
    palp_experiment *experiment = small();
    const char *path = scratch_path("out.csv");
    palp_experiment_column(experiment, "force_N")[1] = 0.1;
    ck_assert_int_eq(palp_experiment_set_string(experiment, "end.fault", "a \"b\"\n\xC3\xA9"), PALP_OK);
    ck_assert_int_eq(palp_experiment_set_string(experiment, "specimen.kind", "rigid"), PALP_OK);
    ck_assert_int_eq(palp_experiment_set_number(experiment, "specimen.height_mm", 1), PALP_OK);
    ck_assert_int_eq(palp_experiment_set_number(experiment, "specimen.height_mm", 24), PALP_OK);
    ck_assert_int_eq(palp_experiment_set_number(experiment, "protocol.rate_mm_s", 0.1), PALP_OK);
    ck_assert_int_eq(palp_experiment_write(experiment, path, NULL), PALP_OK);
    char *text = scratch_read(path);
    ck_assert_str_eq(text, "# palpate.experiment: 1\n"
                           "# specimen.kind: \"rigid\"\n"
                           "# specimen.height_mm: 24.0\n"
                           "# protocol.rate_mm_s: 0.1\n"
                           "time_s,depth_mm,force_N\n"
                           "0,0,0\n"
                           "1,0,0.1\n"
                           "# end.fault: \"a \\\"b\\\"\\n\xC3\xA9\"\n");
    free(text);
    palp_experiment_free(experiment);
}
END_TEST

START_TEST(bad_arguments_are_refused) {
    static const char *const names[] = {"", "force_N", "a,b", " a", "a ", "#a", "a\n", "1st", "-a"};
    palp_experiment *experiment = small();
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        ck_assert_int_eq(palp_experiment_add_column(experiment, names[i]), PALP_ERR_ARGUMENT);
    ck_assert_uint_eq(palp_experiment_column_count(experiment), 3);
    ck_assert_int_eq(palp_experiment_set_number(experiment, "a", NAN), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_experiment_set_number(experiment, "a", INFINITY), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_experiment_set_number(experiment, "a b", 1), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_experiment_set_number(experiment, "", 1), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_experiment_set_string(experiment, "a:", "x"), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_experiment_set_string(experiment, "a", "\xFF"), PALP_ERR_ARGUMENT);
    palp_experiment_free(experiment);
}
END_TEST

/* A write that fails names the file and leaves the folder and the old file as they were. */
static void write_fails(const palp_experiment *experiment, const char *path, palp_status want) {
    palp_error error;
    int before = scratch_entries(scratch_folder, 0);
    ck_assert_int_eq(palp_experiment_write(experiment, path, &error), want);
    ck_assert_int_eq(strncmp(error.text, path, strlen(path)), 0);
    ck_assert_int_eq(scratch_entries(scratch_folder, 0), before);
}

START_TEST(failed_write_leaves_nothing) {
    palp_experiment *experiment = small();
    const char *path = scratch_write("old.csv", "old", 3);
    write_fails(experiment, scratch_path("missing/run.csv"), PALP_ERR_FILE);
    write_fails(experiment, scratch_folder, PALP_ERR_FILE);
    palp_experiment_column(experiment, "force_N")[1] = NAN;
    write_fails(experiment, path, PALP_ERR_ARGUMENT);
    palp_experiment_column(experiment, "force_N")[1] = INFINITY;
    write_fails(experiment, path, PALP_ERR_ARGUMENT);
    palp_experiment_column(experiment, "force_N")[1] = 0;
    palp_experiment_column(experiment, "time_s")[1] = 0;
    write_fails(experiment, path, PALP_ERR_ARGUMENT);
    char *text = scratch_read(path);
    ck_assert_str_eq(text, "old");
    free(text);
    palp_experiment_column(experiment, "time_s")[1] = 2;
    ck_assert_int_eq(palp_experiment_write(experiment, path, NULL), PALP_OK);
    ck_assert_int_eq(scratch_entries(scratch_folder, 0), 1);
    palp_experiment_free(experiment);
}
END_TEST

enum { PART = 40 };

/* A ramp under load, of which these are the rows from first on. */
static palp_experiment *part(int first) {
    palp_experiment *e;
    ck_assert_int_eq(palp_experiment_create(PART, &e), PALP_OK);
    for (int i = 0; i < PART; i++) {
        palp_experiment_column(e, "time_s")[i] = 1.7e9 + 0.01 * (first + i);
        palp_experiment_column(e, "depth_mm")[i] = 1e-3 * (first + i);
        palp_experiment_column(e, "force_N")[i] = 1e-9 * (first + i);
    }
    return e;
}

/* What goes on in other files is one run, whichever comes first: its rows in turn, the keys of the first
 * part, and how the last ended. */
START_TEST(run_in_three_files_is_one) {
    static const size_t orders[][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    const size_t *order = orders[_i], alone = 3;
    const palp_experiment *run[4] = {NULL};
    palp_experiment *whole[4], *made[4];
    size_t of[4], first = 0;
    double value;
    for (size_t i = 0; i < 3; i++) {
        run[i] = made[i] = part(PART * (int)order[i]);
        palp_experiment_set_number(made[i], "specimen.height_mm", 24 + (double)order[i]);
        palp_experiment_set_number(made[i], "end.rows", (double)order[i]);
        first = order[i] == 0 ? i : first;
    }
    palp_experiment_add_column(made[first], "temperature_C");
    run[alone] = made[alone] = part(10 * PART); /* no other ends there */
    ck_assert_int_eq(palp_experiment_join(4, run, whole, of), PALP_OK);
    for (size_t i = 0; i < 4; i++) {
        ck_assert_uint_eq(of[i], i == alone ? alone : first);
        ck_assert((whole[i] != NULL) == (i == first));
    }
    const palp_experiment *all = whole[first];
    ck_assert_uint_eq(palp_experiment_rows(all), 3 * PART);
    ck_assert_uint_eq(palp_experiment_column_count(all), 3);
    for (int i = 0; i < 3 * PART; i++)
        ck_assert_double_eq(palp_experiment_column(all, "force_N")[i], 1e-9 * i);
    ck_assert(!palp_experiment_get_number(all, "specimen.height_mm", &value) && value == 24);
    ck_assert(!palp_experiment_get_number(all, "end.rows", &value) && value == 2);
    palp_experiment_free(whole[first]);
    for (size_t i = 0; i < 4; i++)
        palp_experiment_free(made[i]);
}
END_TEST

/* Whether these two are one run. */
static bool one(const palp_experiment *first, const palp_experiment *second) {
    const palp_experiment *run[2] = {first, second};
    palp_experiment *whole[2];
    size_t of[2];
    ck_assert_int_eq(palp_experiment_join(2, run, whole, of), PALP_OK);
    palp_experiment_free(whole[0]);
    ck_assert(!whole[1]);
    ck_assert((of[1] == 0) == (whole[0] != NULL));
    return of[1] == 0;
}

START_TEST(other_runs_are_not_joined) {
    palp_experiment *first = part(0), *second = part(PART);
    ck_assert(one(first, second));
    palp_experiment_set_string(second, "specimen.name", "another");
    ck_assert(!one(first, second));
    palp_experiment_set_string(first, "specimen.name", "another");
    ck_assert(one(first, second));
    palp_experiment_column(second, "force_N")[0] = 0; /* the plate has left it between the two */
    ck_assert(!one(first, second));
    ck_assert(!one(first, first));
    palp_experiment_free(first);
    palp_experiment_free(second);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_checked_fixture(tc, scratch_setup, scratch_teardown);
    tcase_add_loop_test(tc, bad_file_gives_its_line, 0, sizeof bad / sizeof bad[0]);
    tcase_add_test(tc, missing_file_is_a_file_error);
    tcase_add_test(tc, sample_is_read);
    tcase_add_test(tc, keys_are_json);
    tcase_add_test(tc, line_ends_marks_and_blanks_do_not_matter);
    tcase_add_test(tc, no_rows_is_an_experiment_too);
    tcase_add_test(tc, truncations_are_read_or_named);
    tcase_add_test(tc, changed_bytes_are_survived);
    tcase_add_test(tc, text_that_is_read_is_written_back);
    tcase_add_test(tc, numbers_come_back_bit_for_bit);
    tcase_add_test(tc, created_experiment_is_written_as_designed);
    tcase_add_test(tc, bad_arguments_are_refused);
    tcase_add_test(tc, failed_write_leaves_nothing);
    tcase_add_loop_test(tc, run_in_three_files_is_one, 0, 6);
    tcase_add_test(tc, other_runs_are_not_joined);
}
