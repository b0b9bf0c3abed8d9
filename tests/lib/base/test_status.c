/* test_status.c: names and texts of the status codes, the version, and the one-line errors. */
#define _POSIX_C_SOURCE 200809L
#include <palpate/status.h>
#include <palpate/version.h>

#include "base/file.h"
#include "base/text.h"
#include "scratch.h"

#include <errno.h>
#include <sys/stat.h>

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

/* Of a long path the end, and the reason. */
START_TEST(reason_of_a_long_path_is_said) {
    palp_error error;
    char path[2 * PALP_ERROR_TEXT];
    memset(path, 'p', sizeof path);
    strcpy(path + sizeof path - 6, "a.csv");
    palp_error_set_file(&error, path, "cannot open", ENOENT);
    ck_assert_ptr_nonnull(strstr(error.text, "ppa.csv: cannot open: No such file or directory"));
}
END_TEST

/* Each byte that is replaced is one '?': controls, C1 controls, bidirectional and separators, and what is no
 * UTF-8: Latin-1, a character cut off, overlong forms, a surrogate, beyond the last character. */
START_TEST(any_bytes_become_plain_text) {
    static const char *const text[][2] = {
        {"", ""},
        {"plain ~ text", "plain ~ text"},
        {"Gr\xC3\xB6\xC3\x9F"
         "e \xE9\xAB\x98 \xF0\x9F\x98\x80",
         "Gr\xC3\xB6\xC3\x9F"
         "e \xE9\xAB\x98 \xF0\x9F\x98\x80"},
        {"a\nb\tc\033[2J\177\a", "a?b?c?[2J??"},
        {"\xC2\x9B"
         "2J\xC2\xA0",
         "??2J\xC2\xA0"},
        {"\xE2\x80\xAE\xE2\x80\xA8\xE2\x81\xA6\xE2\x80\xA7", "?????????\xE2\x80\xA7"},
        {"Gr\xF6\xDF"
         "e",
         "Gr??e"},
        {"a\xE9\xAB", "a??"},
        {"\xE9\xAB"
         "a",
         "??a"},
        {"\xC0\xAF\xE0\x80\xAF\xF0\x80\x80\xAF", "?????????"},
        {"\xED\xA0\x80\xED\x9F\xBF", "???\xED\x9F\xBF"},
        {"\xF4\x8F\xBF\xBF\xF4\x90\x80\x80\xF5\x80\xFF", "\xF4\x8F\xBF\xBF???????"},
    };
    for (size_t i = 0; i < sizeof text / sizeof text[0]; i++) {
        char bytes[64];
        strcpy(bytes, text[i][0]);
        ck_assert_ptr_eq(palp_text_make_plain(bytes), bytes);
        ck_assert_str_eq(bytes, text[i][1]);
        ck_assert(palp_text_is_utf8(bytes));
        bool utf8 = i != 6 && i != 7 && i != 8 && i != 9 && i != 10 && i != 11;
        ck_assert_int_eq(palp_text_is_utf8(text[i][0]), utf8);
    }
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

/* What a link points to is made where it is not there, and a loop of links is an error. */
START_TEST(dangling_link_is_followed) {
    palp_file file;
    palp_error error;
    const char *link = scratch_path("link.txt"), *loop = scratch_path("loop.txt");
    ck_assert_int_eq(symlink("second.txt", link), 0);
    ck_assert_int_eq(symlink("made.txt", scratch_path("second.txt")), 0);
    ck_assert_int_eq(symlink("loop.txt", loop), 0);
    ck_assert_int_eq(palp_file_begin(&file, link, NULL), PALP_OK);
    fputs("new", file.stream);
    ck_assert_int_eq(palp_file_commit(&file, false, NULL), PALP_OK);
    char *text = scratch_read(scratch_path("made.txt")), target[16] = "";
    ck_assert_str_eq(text, "new");
    ck_assert_int_eq((int)readlink(link, target, sizeof target - 1), 10);
    free(text);
    ck_assert_int_eq(palp_file_begin(&file, loop, &error), PALP_ERR_FILE);
    ck_assert_ptr_nonnull(strstr(error.text, "cannot write: Too many levels of symbolic links"));
}
END_TEST

START_TEST(replaced_file_keeps_its_permissions) {
    palp_file file;
    struct stat info;
    const char *path = scratch_write("a.txt", "old", 3);
    const mode_t modes[] = {0600, 0664, 0440};
    for (size_t i = 0; i < sizeof modes / sizeof modes[0]; i++) {
        ck_assert_int_eq(chmod(path, modes[i]), 0);
        ck_assert_int_eq(palp_file_begin(&file, path, NULL), PALP_OK);
        ck_assert_int_eq(palp_file_commit(&file, false, NULL), PALP_OK);
        ck_assert_int_eq(stat(path, &info), 0);
        ck_assert_uint_eq(info.st_mode & 07777, modes[i]);
    }
}
END_TEST

/* The temporary's name is no longer than a name may be. */
START_TEST(longest_name_is_written) {
    palp_file file;
    char name[256];
    memset(name, 'n', 255);
    name[255] = '\0';
    const char *path = scratch_path(name);
    palp_status status = palp_file_begin(&file, path, NULL);
    ck_assert_int_eq(status, PALP_OK);
    ck_assert_int_eq(palp_file_commit(&file, false, NULL), PALP_OK);
    ck_assert_int_eq(access(path, R_OK), 0);
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
    tcase_add_test(tc, reason_of_a_long_path_is_said);
    tcase_add_test(tc, any_bytes_become_plain_text);
    tcase_add_test(tc, committed_file_replaces_and_abandoned_does_not);
    tcase_add_test(tc, symbolic_link_is_followed);
    tcase_add_test(tc, dangling_link_is_followed);
    tcase_add_test(tc, replaced_file_keeps_its_permissions);
    tcase_add_test(tc, longest_name_is_written);
    tcase_add_test(tc, device_is_written_in_place);
    tcase_add_test(tc, full_device_is_named_late_too);
    tcase_add_test(tc, pair_is_replaced_as_a_pair);
    tcase_add_test(tc, unreadable_files_are_file_errors);
    tcase_add_test(tc, pipe_is_read_to_its_end);
}
