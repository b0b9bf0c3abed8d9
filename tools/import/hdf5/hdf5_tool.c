/* hdf5_tool.c: palpate-hdf5: an HDF5 file as text for palpate import, and experiments to HDF5 and back. */
#define _XOPEN_SOURCE 700
#include "hdf5_tool.h"

#include <palpate/file.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

static herr_t innermost(unsigned n, const H5E_error2_t *error, void *to) {
    if (n == 0 && error->desc)
        snprintf(to, TOOL_WORD, "%s", error->desc);
    return 0;
}

int tool_failure(const char *file, const char *format, ...) {
    char text[1024], reason[TOOL_WORD] = "";
    va_list values;
    va_start(values, format);
    int n = snprintf(text, sizeof text, "%.512s: ", file);
    vsnprintf(text + n, sizeof text - (size_t)n, format, values);
    va_end(values);
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, innermost, reason);
    fprintf(stderr, "palpate import: %s%s%s%s\n", palp_text_make_plain(text), *reason ? " (" : "",
            palp_text_make_plain(reason), *reason ? ")" : "");
    return TOOL_FAILURE;
}

int tool_status(palp_status status, const palp_error *error) {
    fprintf(stderr, "palpate import: %s\n", *error->text ? error->text : palp_status_text(status));
    return TOOL_FAILURE;
}

/* The library can loop for ever over a damaged file. A whole one of 1 MB takes a second or less. */
static void limit_time(const char *file) {
    struct stat entry;
    rlim_t most_s = 20 + (stat(file, &entry) == 0 ? (rlim_t)entry.st_size / 16384 : 0);
    setrlimit(RLIMIT_CPU, &(struct rlimit){most_s, most_s});
}

int main(int argc, char **argv) {
    bool write = argc == 4 && strcmp(argv[1], "write") == 0, read = argc == 4 && strcmp(argv[1], "read") == 0;
    if (!write && !read && !(argc == 3 && strcmp(argv[1], "print") == 0)) {
        fputs("palpate import runs this program for HDF5 files; see palpate import --help\n", stderr);
        return 2;
    }
    H5dont_atexit(); /* it crashes there over a file that it could not write */
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    if (write)
        return tool_write_experiment(argv[2], argv[3]);
    limit_time(argv[2]);
    hid_t file = H5Fopen(argv[2], H5F_ACC_RDONLY, H5P_DEFAULT);
    if (file < 0)
        return tool_failure(argv[2], "the HDF5 file is truncated or damaged");
    int code = read ? tool_read_experiment(file, argv[2], argv[3]) : tool_print_tables(file, argv[2]);
    H5Fclose(file);
    return code;
}
