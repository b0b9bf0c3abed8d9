/* output.c: files that a command writes: protection of other files, and closing. */
#define _POSIX_C_SOURCE 200809L
#include "cli.h"
#include "temporary.h"

#include <dirent.h>
#include <errno.h>
#include <fnmatch.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* ---- files that must not be replaced ---- */

/* Whether two files are in the same folder, existing or not. */
static bool stands_together(const char *a, const char *b) {
    const char *path[2] = {a, b};
    char folder[2][CLI_PATH_MAX];
    struct stat entry[2];
    bool there = true;
    for (int i = 0; i < 2; i++) {
        int n = (int)(cli_base(path[i]) - path[i]);
        snprintf(folder[i], CLI_PATH_MAX, "%.*s", n ? n : 2, n ? path[i] : "./");
        there = stat(folder[i], &entry[i]) == 0 && there;
    }
    return there ? entry[0].st_dev == entry[1].st_dev && entry[0].st_ino == entry[1].st_ino
                 : strcmp(folder[0], folder[1]) == 0;
}

static bool same_file(const char *a, const char *b) {
    struct stat one, other;
    bool there = stat(a, &one) == 0, too = stat(b, &other) == 0;
    if (there && too)
        return strcmp(a, b) == 0 ||
               (one.st_dev == other.st_dev && one.st_ino == other.st_ino && S_ISREG(one.st_mode));
    return !there && !too && strcmp(cli_base(a), cli_base(b)) == 0 && stands_together(a, b);
}

/* Whether a file in a folder is read as a recording, model or result. */
static bool in_folder(const char *path, const char *folder) {
    char file[CLI_PATH_MAX];
    struct stat entry;
    const char *end = strrchr(path, '.');
    bool kind = end && (strcmp(end, ".csv") == 0 || strcmp(end, ".json") == 0);
    int n = snprintf(file, sizeof file, "%s/%s", folder, cli_base(path));
    return kind && n > 0 && (size_t)n < sizeof file && stat(file, &entry) == 0 && same_file(path, file);
}

/* Whether the output is an input file, or one of several between commas. */
static bool is_input(const char *path, const char *input) {
    char file[CLI_PATH_MAX];
    struct stat entry;
    bool folder = stat(input, &entry) == 0 && S_ISDIR(entry.st_mode);
    if (folder ? in_folder(path, input) : same_file(path, input))
        return true;
    for (const char *at = input; *at; at += *at == ',') {
        size_t n = strcspn(at, ",");
        snprintf(file, sizeof file, "%.*s", (int)n, at);
        if (n > 0 && same_file(path, file))
            return true;
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
    if (from)
        fclose(from);
    return experiment && !simulated;
}

int cli_output_check(const char *name, const char *path, bool force, size_t n_inputs,
                     const char *const inputs[]) {
    if (strncmp(path, "/dev/", 5) == 0)
        return CLI_OK;
    temporary_tidy_on_signal(path);
    for (size_t i = 0; i < n_inputs; i++)
        if (is_input(path, inputs[i]))
            return cli_failure(name, "%s: is an input, or an output named twice; name another output", path);
    return force || !is_recording(path)
               ? CLI_OK
               : cli_failure(name, "%s: is a recording; name another output, or give --force", path);
}

/* Whether a file's name is one of the patterns. */
static bool matches(const char *patterns, const char *base) {
    char pattern[64];
    for (const char *at = patterns; *at; at += *at == ' ') {
        size_t n = strcspn(at, " ");
        snprintf(pattern, sizeof pattern, "%.*s", (int)n, at);
        if (fnmatch(pattern, base, 0) == 0)
            return true;
        at += n;
    }
    return false;
}

/* What is there of a folder's outputs, and the outputs named by themselves. */
static int check_folder(const cli_command *command, const cli_option *o, bool force, size_t n,
                        const char *const others[]) {
    char path[CLI_PATH_MAX];
    const char *folder = *o->to.text;
    int code = CLI_OK;
    snprintf(path, sizeof path, "%s/", folder);
    temporary_tidy_on_signal(path);
    for (size_t i = 0; i < n && code == CLI_OK; i++) {
        if (matches(o->files, cli_base(others[i])) && stands_together(others[i], path))
            code =
                cli_failure(command->name, "%s: is an input, or an output named twice; --%s would replace it",
                            others[i], o->name);
    }
    DIR *open = opendir(folder);
    for (struct dirent *entry; open && code == CLI_OK && (entry = readdir(open)) != NULL;) {
        int length = matches(o->files, entry->d_name)
                         ? snprintf(path, sizeof path, "%s/%s", folder, entry->d_name)
                         : 0;
        if (length > 0 && (size_t)length < sizeof path)
            code = cli_output_check(command->name, path, force, n, others);
    }
    if (open)
        closedir(open);
    return code;
}

int cli_outputs_check(const cli_command *command, bool force, const char *const words[], size_t n_words) {
    const char **other = malloc((n_words + command->n_options + 1) * sizeof *other);
    size_t n = 0;
    int code = other ? CLI_OK : cli_failure(command->name, "out of memory");
    for (; code == CLI_OK && n < n_words; n++)
        other[n] = words[n];
    for (int type = CLI_IN; type <= CLI_OUT_FOLDER; type++) { /* each is not to be what was named before it */
        for (size_t i = 0; i < command->n_options && code == CLI_OK; i++) {
            const cli_option *o = &command->options[i];
            if ((int)o->type != type || !*o->to.text)
                continue;
            if (type == CLI_OUT_FOLDER) {
                code = check_folder(command, o, force, n, other);
                continue;
            }
            code = type == CLI_OUT ? cli_output_check(command->name, *o->to.text, force, n, other) : CLI_OK;
            other[n++] = *o->to.text;
        }
    }
    free(other);
    return code;
}

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
    if (mkdir(folder, 0777) == 0 || (errno == EEXIST && stat(folder, &entry) == 0 && S_ISDIR(entry.st_mode)))
        return CLI_OK;
    return cli_failure(name, "%s: is not a folder and cannot be created", folder);
}

const char *cli_base(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}
