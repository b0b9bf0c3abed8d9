/* scratch.h: a folder of its own for a test, and small files in it. The test defines
 * _POSIX_C_SOURCE 200809L before its first include. */
#ifndef SCRATCH_H
#define SCRATCH_H

#include <check.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifndef PALP_TEST_DATA
#define PALP_TEST_DATA "tests/data" /* tests run from the root of the source tree */
#endif

enum { SCRATCH_PATH = 600 };

static char scratch_folder[256];

static void scratch_setup(void) {
    const char *base = getenv("TMPDIR");
    snprintf(scratch_folder, sizeof scratch_folder, "%s/palpate-test-XXXXXX", base ? base : "/tmp");
    ck_assert_ptr_nonnull(mkdtemp(scratch_folder));
}

/* Number of entries of a folder; with remove set, they are removed. */
static inline int scratch_entries(const char *folder, int remove_them) {
    DIR *directory = opendir(folder);
    int n = 0;
    ck_assert_ptr_nonnull(directory);
    for (struct dirent *entry; (entry = readdir(directory)) != NULL;) {
        char path[3 * SCRATCH_PATH];
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        n++;
        ck_assert_int_lt(snprintf(path, sizeof path, "%s/%s", folder, entry->d_name), (int)sizeof path);
        if (remove_them && unlink(path) != 0) {
            scratch_entries(path, 1);
            rmdir(path);
        }
    }
    closedir(directory);
    return n;
}

static void scratch_teardown(void) {
    scratch_entries(scratch_folder, 1);
    rmdir(scratch_folder);
}

/* The path of a file in the scratch folder; four may be in use at a time. */
static inline const char *scratch_path(const char *name) {
    static char paths[4][SCRATCH_PATH];
    static int next;
    char *path = paths[next++ % 4];
    snprintf(path, SCRATCH_PATH, "%s/%s", scratch_folder, name);
    return path;
}

static inline const char *scratch_write(const char *name, const char *text, size_t size) {
    const char *path = scratch_path(name);
    FILE *file = fopen(path, "wb");
    ck_assert_ptr_nonnull(file);
    ck_assert_uint_eq(fwrite(text, 1, size, file), size);
    ck_assert_int_eq(fclose(file), 0);
    return path;
}

/* The whole of a small file, NUL-terminated; the caller frees it. */
static inline char *scratch_read(const char *path) {
    enum { MOST = 1 << 20 };
    char *text = malloc(MOST);
    FILE *file = fopen(path, "rb");
    ck_assert_ptr_nonnull(text);
    ck_assert_ptr_nonnull(file);
    size_t n = fread(text, 1, MOST - 1, file);
    text[n] = '\0';
    fclose(file);
    return text;
}

#endif
