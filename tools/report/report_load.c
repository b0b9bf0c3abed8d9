/* report_load.c: the files of a report, and what each of them is. */
#define _POSIX_C_SOURCE 200809L
#include "report.h"
#include "shared/crc32.h"
#include "shared/opening.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const char NAME[] = "report";

static bool ends(const char *path, const char *ending) {
    size_t n = strlen(path), m = strlen(ending);
    return n > m && strcmp(path + n - m, ending) == 0;
}

size_t report_count(const report *r, report_kind kind) {
    size_t count = 0;
    for (size_t i = 0; i < r->n; i++)
        count += r->file[i].kind == kind;
    return count;
}

static int checksum(report_file *file) {
    char *text;
    size_t size;
    palp_error error;
    palp_status status = palp_file_read(file->source, &text, &size, &error);
    if (status)
        return cli_status(NAME, status, &error);
    file->crc = crc32_add(0, text, size);
    free(text);
    return CLI_OK;
}

static void load_run(report_file *file) {
    palp_error error = {PALP_OK, ""};
    const palp_recording_settings settings = palp_recording_settings_default();
    const char *text;
    double number;
    if (palp_experiment_read(file->source, &file->experiment, &error)) {
        snprintf(file->note, sizeof file->note, "%.*s", REPORT_NOTE_MAX - 1, error.text);
        return;
    }
    /* with noise a simulation counts as a recording */
    bool simulated = palp_experiment_get_string(file->experiment, "model.file", &text) == PALP_OK &&
                     palp_experiment_get_number(file->experiment, "sensor.noise_N", &number) != PALP_OK;
    file->kind = simulated ? REPORT_SIMULATION : REPORT_RECORDING;
    if (open_no_specimen(file->experiment))
        return; /* air and rigid blocks need no preparation */
    if (palp_recording_prepare(file->experiment, file->path, &settings, &file->recording, &error)) {
        snprintf(file->note, sizeof file->note, "%.*s", REPORT_NOTE_MAX - 1, error.text);
        memset(&file->recording, 0, sizeof file->recording);
    }
}

static void load_json(report_file *file) {
    static const char *const results[] = {"characterize", "calibrate", "explain"};
    json_error_t where;
    palp_error error = {PALP_OK, ""};
    palp_mesh_source mesh;
    file->json = json_load_file(file->source, 0, &where);
    const json_t *about = json_object_get(file->json, "palpate");
    for (size_t i = 0; i < sizeof results / sizeof results[0]; i++)
        if (json_is_integer(json_object_get(about, results[i])))
            file->kind = REPORT_RESULT;
    if (json_is_integer(json_object_get(about, "model"))) {
        if (palp_model_read(file->source, &file->model, &mesh, &error) == PALP_OK)
            file->kind = REPORT_MODEL;
        snprintf(file->note, sizeof file->note, "%.*s", REPORT_NOTE_MAX - 1, error.text);
    } else if (!file->json) {
        snprintf(file->note, sizeof file->note, "line %d: %s", where.line, where.text);
    } else if (file->kind == REPORT_OTHER) {
        snprintf(file->note, sizeof file->note, "not a JSON file of palpate");
    }
}

/* Copies what can be read only once, such as a pipe. */
static int choose_source(report_file *file, struct stat *entry) {
    char *text;
    size_t size;
    palp_error error;
    file->source = file->path;
    if (stat(file->path, entry) != 0)
        return cli_failure(NAME, "%s: %s", file->path, strerror(errno));
    if (S_ISREG(entry->st_mode) && strncmp(file->path, "/dev/", 5) != 0)
        return CLI_OK;
    palp_status status = palp_file_read(file->path, &text, &size, &error);
    if (status)
        return cli_status(NAME, status, &error);
    file->copy = tmpfile();
    bool copied = file->copy && fwrite(text, 1, size, file->copy) == size && fflush(file->copy) == 0;
    free(text);
    if (!copied || fstat(fileno(file->copy), entry) != 0)
        return cli_failure(NAME, "%s: cannot be copied: %s", file->path, strerror(errno));
    snprintf(file->copied, sizeof file->copied, "/dev/fd/%d", fileno(file->copy));
    file->source = file->copied;
    return CLI_OK;
}

/* Extension of a file's name; for a copy it follows from the content. */
static const char *ending_of(const report_file *file) {
    int first = 0;
    if (!file->copy) {
        const char *dot = strrchr(cli_base(file->path), '.');
        return dot ? dot : "";
    }
    rewind(file->copy);
    while ((first = getc(file->copy)) == ' ' || first == '\n') {
    }
    return first == '{' ? ".json" : ".csv";
}

static void load(report_file *file) {
    const char *ending = ending_of(file);
    if (strcmp(ending, ".csv") == 0)
        load_run(file);
    else if (strcmp(ending, ".json") == 0)
        load_json(file);
    else
        snprintf(file->note, sizeof file->note, "neither .csv nor .json");
}

/* Reports what is wrong with a file; returns an exit code. */
static int say_note(const report_file *file, bool must_read) {
    size_t n = strlen(file->source);
    const char *note = strncmp(file->note, file->source, n) == 0 ? file->note + n : file->note;
    const char *between = note > file->note ? "" : ": ";
    if (note[0] && must_read && file->kind == REPORT_OTHER)
        return cli_failure(NAME, "%s%s%s", file->path, between, note);
    if (note[0])
        cli_warning(NAME, "%s%s%s", file->path, between, note);
    return CLI_OK;
}

static int add_file(report *r, const char *path, bool must_read) {
    struct stat entry;
    if (r->n == REPORT_FILES_MAX)
        return cli_failure(NAME, "more than %d files", REPORT_FILES_MAX);
    report_file *file = &r->file[r->n];
    memset(file, 0, sizeof *file);
    file->path = malloc(strlen(path) + 1);
    if (!file->path)
        return cli_failure(NAME, "%s", palp_status_text(PALP_ERR_NO_MEMORY));
    strcpy(file->path, path);
    r->n++;
    int code = choose_source(file, &entry);
    code = code ? code : checksum(file);
    if (code)
        return code;
    file->size = (long long)entry.st_size;
    file->modified = entry.st_mtime;
    load(file);
    palp_text_make_plain(file->path); /* from here on the name is only shown and compared */
    return say_note(file, must_read);
}

static int wanted(const struct dirent *entry) {
    return entry->d_name[0] != '.' && (ends(entry->d_name, ".csv") || ends(entry->d_name, ".json"));
}

static int add_folder(report *r, const char *folder) {
    struct dirent **entry = NULL;
    char path[CLI_PATH_MAX];
    int n = scandir(folder, &entry, wanted, alphasort), code = CLI_OK;
    if (n < 0)
        return cli_failure(NAME, "%s: %s", folder, strerror(errno));
    for (int i = 0; i < n; i++) {
        int length = snprintf(path, sizeof path, "%s/%s", folder, entry[i]->d_name);
        if (code == CLI_OK && length > 0 && (size_t)length < sizeof path)
            code = add_file(r, path, false);
        free(entry[i]);
    }
    free(entry);
    return code;
}

int report_add(report *r, const char *path, bool must_read) {
    struct stat entry;
    if (stat(path, &entry) == 0 && S_ISDIR(entry.st_mode))
        return add_folder(r, path);
    return add_file(r, path, must_read);
}

/* Runs without a press sort first. */
static bool goes_before(const report_file *a, const report_file *b) {
    if (a->recording.n == 0 || b->recording.n == 0)
        return a->recording.n == 0 && b->recording.n > 0;
    return run_before(&a->recording, &b->recording);
}

static void sort_kind(report *r, report_kind kind) {
    for (size_t i = 0; i < r->n; i++)
        for (size_t at = i, k = i; r->file[i].kind == kind && k-- > 0;) {
            if (r->file[k].kind != kind)
                continue;
            if (!goes_before(&r->file[at], &r->file[k]))
                break;
            const report_file moved = r->file[k];
            r->file[k] = r->file[at];
            r->file[at] = moved;
            at = k;
        }
}

void report_sort(report *r) {
    sort_kind(r, REPORT_RECORDING);
    sort_kind(r, REPORT_SIMULATION);
}

void report_free(report *r) {
    for (size_t i = 0; i < r->n_pairs; i++) {
        free(r->pair[i].force_N);
        free(r->pair[i].band_N);
    }
    for (size_t i = 0; i < r->n; i++) {
        report_file *file = &r->file[i];
        palp_experiment_free(file->experiment);
        palp_recording_free(&file->recording);
        json_decref(file->json);
        if (file->copy)
            fclose(file->copy);
        free(file->path);
    }
    free(r->file);
}
