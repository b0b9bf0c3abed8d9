/* output.c: files that a command writes: what must not be replaced, and how they are closed. */
#define _POSIX_C_SOURCE 200809L
#include "cli.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* ---- what must not be replaced ---- */

static bool same_file(const char *a, const char *b) {
    struct stat one, other;
    return strcmp(a, b) == 0 || (stat(a, &one) == 0 && stat(b, &other) == 0 && one.st_dev == other.st_dev &&
                                 one.st_ino == other.st_ino && S_ISREG(one.st_mode));
}

/* A folder's files that are read as recordings, models, results and figures. */
static bool in_folder(const char *path, const char *folder) {
    char file[CLI_PATH_MAX];
    struct stat entry;
    const char *end = strrchr(path, '.');
    bool kind = end && (strcmp(end, ".csv") == 0 || strcmp(end, ".json") == 0 || strcmp(end, ".svg") == 0);
    int n = snprintf(file, sizeof file, "%s/%s", folder, cli_base(path));
    return kind && n > 0 && (size_t)n < sizeof file && stat(file, &entry) == 0 && same_file(path, file);
}

/* Whether the output is an input's file, or one of several between commas. */
static bool is_input(const char *path, const char *input) {
    char file[CLI_PATH_MAX];
    struct stat entry;
    bool folder = stat(input, &entry) == 0 && S_ISDIR(entry.st_mode);
    if (folder ? in_folder(path, input) : same_file(path, input)) {
        return true;
    }
    for (const char *at = input; *at; at += *at == ',') {
        size_t n = strcspn(at, ",");
        snprintf(file, sizeof file, "%.*s", (int)n, at);
        if (n > 0 && same_file(path, file)) {
            return true;
        }
        at += n;
    }
    return false;
}

static bool is_recording(const char *path) {
    char line[256];
    struct stat entry;
    FILE *from = stat(path, &entry) == 0 && S_ISREG(entry.st_mode) ? fopen(path, "r") : NULL;
    bool experiment = false, simulated = false;
    while (from && fgets(line, sizeof line, from) && line[0] == '#') {
        experiment = experiment || strncmp(line, "# palpate.experiment:", 21) == 0;
        simulated = simulated || strncmp(line, "# model.file:", 13) == 0;
    }
    if (from) {
        fclose(from);
    }
    return experiment && !simulated;
}

int cli_output_check(const char *name, const char *path, bool force, size_t n_inputs, const char *const inputs[]) {
    if (strncmp(path, "/dev/", 5) == 0) {
        return CLI_OK;
    }
    for (size_t i = 0; i < n_inputs; i++) {
        if (is_input(path, inputs[i])) {
            return cli_failure(name, "%s: is an input or named twice: name another output", path);
        }
    }
    return force || !is_recording(path)
               ? CLI_OK
               : cli_failure(name, "%s: is a recording: name another output, or give --force", path);
}

/* ---- writing ---- */

int cli_file_open(const char *name, const char *path, palp_file *file) {
    palp_error error;
    palp_status status = palp_file_begin(file, path ? path : "/dev/stdout", &error);
    return status ? cli_status(name, status, &error) : CLI_OK;
}

int cli_file_close(const char *name, palp_file *file) {
    palp_error error;
    palp_status status = palp_file_commit(file, false, &error);
    return status ? cli_status(name, status, &error) : CLI_OK;
}

int cli_flush(const char *name) {
    errno = 0;
    bool bad = ferror(stdout) != 0;
    bad = fflush(stdout) != 0 || bad;
    return bad ? cli_failure(name, "standard output: %s", errno ? strerror(errno) : "write error") : CLI_OK;
}

int cli_folder(const char *name, const char *folder) {
    struct stat entry;
    if (mkdir(folder, 0777) == 0 || (errno == EEXIST && stat(folder, &entry) == 0 && S_ISDIR(entry.st_mode))) {
        return CLI_OK;
    }
    return cli_failure(name, "%s: is no folder and cannot be made", folder);
}

const char *cli_base(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}
