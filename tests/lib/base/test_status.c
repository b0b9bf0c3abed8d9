/* test_status.c: names and texts of the status codes, the version, and the one-line errors. */
#define _POSIX_C_SOURCE 200809L
#include <palpate/status.h>
#include <palpate/version.h>

#include "base/file.h"
#include "scratch.h"

START_TEST(every_status_has_a_text_and_a_name) {
    for (int i = 0; i < PALP_STATUS_COUNT; i++) {
        palp_status status = (palp_status)i;
        ck_assert_str_ne(palp_status_text(status), "unknown status");
        ck_assert_int_eq(strncmp(palp_status_name(status), "PALP_", 5), 0);
        for (int j = 0; j < i; j++)
            ck_assert_str_ne(palp_status_text(status), palp_status_text((palp_status)j));
    }
    ck_assert_int_eq(PALP_OK, 0);
    ck_assert_str_eq(palp_status_name(PALP_OK), "PALP_OK");
    ck_assert_str_eq(palp_status_name(PALP_ERR_INPUT), "PALP_ERR_INPUT");
    ck_assert_str_eq(palp_status_text(PALP_ERR_NO_MEMORY), "out of memory");
}
END_TEST

START_TEST(other_values_are_unknown) {
    ck_assert_str_eq(palp_status_text(PALP_STATUS_COUNT), "unknown status");
    ck_assert_str_eq(palp_status_name(PALP_STATUS_COUNT), "unknown status");
}
END_TEST

START_TEST(version_is_that_of_the_headers) {
    ck_assert_str_eq(palp_version(), PALP_VERSION);
}
END_TEST

START_TEST(error_is_one_line) {
    palp_error error;
    ck_assert_int_eq(palp_error_set(&error, PALP_ERR_INPUT, "a\nb\t%d", 7), PALP_ERR_INPUT);
    ck_assert_int_eq(error.status, PALP_ERR_INPUT);
    ck_assert_str_eq(error.text, "a?b?7");
    ck_assert_int_eq(palp_error_set_line(&error, PALP_ERR_LIMIT, "x.csv", 41, "too %s", "long"),
                     PALP_ERR_LIMIT);
    ck_assert_str_eq(error.text, "x.csv:41: too long");
    ck_assert_int_eq(palp_error_set(NULL, PALP_ERR_FILE, "unused"), PALP_ERR_FILE);
    ck_assert_int_eq(palp_error_set_line(NULL, PALP_ERR_FILE, "f", 1, "unused"), PALP_ERR_FILE);
}
END_TEST

START_TEST(error_longer_than_its_room_is_cut) {
    palp_error error;
    char path[2 * PALP_ERROR_TEXT];
    memset(path, 'p', sizeof path);
    path[sizeof path - 1] = '\0';
    palp_error_set_line(&error, PALP_ERR_INPUT, path, 3, "text");
    ck_assert_uint_eq(strlen(error.text), PALP_ERROR_TEXT - 1);
    palp_error_set(&error, PALP_ERR_INPUT, "%s", path);
    ck_assert_uint_eq(strlen(error.text), PALP_ERROR_TEXT - 1);
}
END_TEST

START_TEST(committed_file_replaces_and_abandoned_does_not) {
    palp_file file;
    palp_error error;
    const char *path = scratch_write("a.txt", "old", 3);
    ck_assert_int_eq(palp_file_begin(&file, path, &error), PALP_OK);
    fputs("half", file.stream);
    palp_file_abandon(&file);
    char *text = scratch_read(path);
    ck_assert_str_eq(text, "old");
    free(text);
    for (int durable = 0; durable < 2; durable++) {
        ck_assert_int_eq(palp_file_begin(&file, path, &error), PALP_OK);
        fprintf(file.stream, "new %d", durable);
        ck_assert_int_eq(palp_file_commit(&file, durable, &error), PALP_OK);
        text = scratch_read(path);
        ck_assert_str_eq(text, durable ? "new 1" : "new 0");
        free(text);
    }
    ck_assert_int_eq(scratch_entries(scratch_folder, 0), 1);
}
END_TEST

/* The link stays a link, what it points to is replaced. */
START_TEST(symbolic_link_is_followed) {
    palp_file file;
    const char *path = scratch_write("a.txt", "old", 3), *link = scratch_path("link.txt");
    ck_assert_int_eq(symlink("a.txt", link), 0);
    ck_assert_int_eq(palp_file_begin(&file, link, NULL), PALP_OK);
    fputs("new", file.stream);
    ck_assert_int_eq(palp_file_commit(&file, false, NULL), PALP_OK);
    char *text = scratch_read(path), target[16] = "";
    ck_assert_str_eq(text, "new");
    ck_assert_int_eq((int)readlink(link, target, sizeof target - 1), 5);
    free(text);
}
END_TEST

START_TEST(device_is_written_in_place) {
    palp_file file;
    palp_error error;
    ck_assert_int_eq(palp_file_begin(&file, "/dev/null", &error), PALP_OK);
    fputs("gone", file.stream);
    ck_assert_int_eq(palp_file_commit(&file, true, &error), PALP_OK);
    if (access("/dev/full", W_OK) != 0)
        return;
    ck_assert_int_eq(palp_file_begin(&file, "/dev/full", &error), PALP_OK);
    fputs("no room", file.stream);
    ck_assert_int_eq(palp_file_commit(&file, true, &error), PALP_ERR_FILE);
    ck_assert_str_eq(error.text, "/dev/full: cannot write: No space left on device");
}
END_TEST

/* The reason too of a write that failed long before the end. */
START_TEST(full_device_is_named_late_too) {
    palp_file file;
    palp_error error;
    if (access("/dev/full", W_OK) != 0)
        return;
    ck_assert_int_eq(palp_file_begin(&file, "/dev/full", &error), PALP_OK);
    for (int i = 0; i < 100000; i++)
        fputs("no room", file.stream);
    ck_assert_int_eq(palp_file_commit(&file, true, &error), PALP_ERR_FILE);
    ck_assert_str_eq(error.text, "/dev/full: cannot write: No space left on device");
}
END_TEST

/* Neither of a pair is replaced where one cannot be written. */
START_TEST(pair_is_replaced_as_a_pair) {
    palp_file file[2];
    palp_error error;
    const char *path = scratch_write("a.txt", "old", 3);
    if (access("/dev/full", W_OK) != 0)
        return;
    for (int full = 0; full < 2; full++) {
        ck_assert_int_eq(palp_file_begin(&file[full], "/dev/full", &error), PALP_OK);
        ck_assert_int_eq(palp_file_begin(&file[!full], path, &error), PALP_OK);
        fputs("new", file[0].stream);
        fputs("new", file[1].stream);
        ck_assert_int_eq(palp_file_commit_pair(&file[0], &file[1], true, &error), PALP_ERR_FILE);
        ck_assert_str_eq(error.text, "/dev/full: cannot write: No space left on device");
        char *text = scratch_read(path);
        ck_assert_str_eq(text, "old");
        free(text);
    }
    ck_assert_int_eq(scratch_entries(scratch_folder, 0), 1);
}
END_TEST

START_TEST(unreadable_files_are_file_errors) {
    palp_error error;
    char *text = NULL;
    size_t size;
    ck_assert_int_eq(palp_file_read("/nowhere/a.csv", &text, &size, &error), PALP_ERR_FILE);
    ck_assert_str_eq(error.text, "/nowhere/a.csv: cannot open: No such file or directory");
    ck_assert_int_eq(palp_file_read("/tmp", &text, &size, &error), PALP_ERR_FILE);
    ck_assert_str_eq(error.text, "/tmp: cannot read: Is a directory");
    ck_assert_ptr_null(text);
}
END_TEST

/* A pipe has no size to ask for. */
START_TEST(pipe_is_read_to_its_end) {
    char command[SCRATCH_PATH], name[32], *text = NULL;
    size_t size = 0;
    snprintf(command, sizeof command, "head -c 300000 /dev/zero | tr '\\0' x");
    FILE *pipe = popen(command, "r");
    ck_assert_ptr_nonnull(pipe);
    snprintf(name, sizeof name, "/dev/fd/%d", fileno(pipe));
    if (access(name, R_OK) == 0) {
        ck_assert_int_eq(palp_file_read(name, &text, &size, NULL), PALP_OK);
        ck_assert_uint_eq(size, 300000);
        ck_assert_uint_eq(strspn(text, "x"), 300000);
        free(text);
    }
    pclose(pipe);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_checked_fixture(tc, scratch_setup, scratch_teardown);
    tcase_add_test(tc, every_status_has_a_text_and_a_name);
    tcase_add_test(tc, other_values_are_unknown);
    tcase_add_test(tc, version_is_that_of_the_headers);
    tcase_add_test(tc, error_is_one_line);
    tcase_add_test(tc, error_longer_than_its_room_is_cut);
    tcase_add_test(tc, committed_file_replaces_and_abandoned_does_not);
    tcase_add_test(tc, symbolic_link_is_followed);
    tcase_add_test(tc, device_is_written_in_place);
    tcase_add_test(tc, full_device_is_named_late_too);
    tcase_add_test(tc, pair_is_replaced_as_a_pair);
    tcase_add_test(tc, unreadable_files_are_file_errors);
    tcase_add_test(tc, pipe_is_read_to_its_end);
}
