/* panel_runs.c: the recordings in the folder with their figures and fits, and a recording's curve thinned for
 * drawing. */
#define _POSIX_C_SOURCE 200809L
#include "panel.h"

#include <dirent.h>
#include <math.h>
#include <palpate/experiment.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

bool panel_file(const panel *p, const char *folder, const char *name, const char *end,
                char path[CLI_PATH_MAX]) {
    size_t n = name ? strlen(name) : 0, m = strlen(end);
    if (n <= m || strcmp(name + n - m, end) != 0 || name[0] == '.' || strchr(name, '/'))
        return false;
    int length = snprintf(path, CLI_PATH_MAX, "%s/%s%s", p->setup->session.out, folder, name);
    return length > 0 && length < CLI_PATH_MAX;
}

/* The header alone: "# key: value" lines at its beginning. */
static json_t *read_header(const char *path) {
    char line[4096];
    json_t *header = json_object();
    FILE *file = fopen(path, "r");
    while (file && fgets(line, sizeof line, file) && line[0] == '#') {
        char *colon = strstr(line, ": ");
        if (!colon)
            continue;
        *colon = '\0';
        json_t *value = json_loads(colon + 2, JSON_DECODE_ANY | JSON_DISABLE_EOF_CHECK, NULL);
        json_object_set_new(header, line + 2, value ? value : json_null());
    }
    if (file)
        fclose(file);
    return header;
}

/* Law, arms and warnings of the recording's fit, unless the fit is older than the recording. */
static json_t *fit_of(const panel *p, const char *name, const struct stat *recorded) {
    char model[ACQUIRE_NAME + 16], path[CLI_PATH_MAX];
    struct stat made;
    int n = snprintf(model, sizeof model, "%.*s.json", (int)strlen(name) - 4, name);
    if (n < 0 || (size_t)n >= sizeof model || !panel_file(p, "fits/", model, ".json", path) ||
        stat(path, &made) != 0 || made.st_mtime < recorded->st_mtime)
        return json_null();
    json_t *fit = json_load_file(path, 0, NULL);
    json_object_del(fit, "covariance");
    return fit ? fit : json_null();
}

static json_t *run_json(const panel *p, const char *name, const char *path, const struct stat *file) {
    static const char *const keys[] = {"protocol.kind", "protocol.depth_mm", "specimen.height_mm",
                                       "end.fault",     "end.samples",       "end.lost_samples",
                                       "end.peak_N",    "end.contact_mm",    "end.error_rms_mm",
                                       "acquire.time",  "protocol.repeat"};
    json_t *header = read_header(path), *run = json_pack("{ss}", "name", name);
    if (!json_object_get(header, "palpate.experiment")) {
        json_decref(header);
        json_decref(run);
        return NULL;
    }
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        json_t *value = json_object_get(header, keys[i]);
        json_object_set(run, strchr(keys[i], '.') + 1, value ? value : json_null());
    }
    json_object_set_new(run, "fit", fit_of(p, name, file));
    json_decref(header);
    return run;
}

static int by_time(const void *a, const void *b) {
    const char *s = json_string_value(json_object_get(*(json_t *const *)a, "time"));
    const char *t = json_string_value(json_object_get(*(json_t *const *)b, "time"));
    int order = strcmp(s ? s : "", t ? t : "");
    return order ? order
                 : strcmp(json_string_value(json_object_get(*(json_t *const *)a, "name")),
                          json_string_value(json_object_get(*(json_t *const *)b, "name")));
}

json_t *panel_runs(const panel *p) {
    enum { MOST = 4096 };
    static const char csv[] = ".csv";
    json_t **run = calloc(MOST, sizeof *run), *list = json_array();
    DIR *folder = opendir(p->setup->session.out);
    size_t n = 0;
    for (struct dirent *e = folder ? readdir(folder) : NULL; e && run && n < MOST; e = readdir(folder)) {
        char path[CLI_PATH_MAX];
        struct stat file;
        if (panel_file(p, "", e->d_name, csv, path) && stat(path, &file) == 0 && S_ISREG(file.st_mode))
            run[n] = run_json(p, e->d_name, path, &file);
        n += run[n] != NULL;
    }
    if (folder)
        closedir(folder);
    if (n > 0)
        qsort(run, n, sizeof *run, by_time);
    for (size_t i = 0; i < n; i++)
        json_array_append_new(list, run[i]);
    free(run);
    return json_pack("{so}", "runs", list);
}

static void add(json_t *list[3], double *const column[3], size_t i) {
    for (size_t k = 0; k < 3; k++)
        json_array_append_new(list[k], json_real(column[k][i]));
}

/* Keeps of each stretch of rows the two with the least and the greatest force, so that no peak is lost. */
static void thin(json_t *list[3], double *const column[3], size_t rows) {
    const size_t step = rows / (PANEL_SHOWN / 2) + 1;
    for (size_t from = 0; from < rows; from += step) {
        size_t low = from, high = from;
        for (size_t i = from; i < rows && i < from + step; i++) {
            low = column[2][i] < column[2][low] ? i : low;
            high = column[2][i] > column[2][high] ? i : high;
        }
        add(list, column, low < high ? low : high);
        if (low != high)
            add(list, column, low < high ? high : low);
    }
}

json_t *panel_curve(const char *path, char why[ACQUIRE_TEXT]) {
    static const char *const names[] = {"time_s", "depth_mm", "force_N"};
    palp_experiment *e = NULL;
    palp_error error = {PALP_OK, ""};
    double *column[3];
    json_t *list[3], *to = json_object();
    if (palp_experiment_read(path, &e, &error)) {
        snprintf(why, ACQUIRE_TEXT, "%.500s", error.text);
        json_decref(to);
        return NULL;
    }
    for (size_t k = 0; k < 3; k++) {
        column[k] = palp_experiment_column(e, names[k]);
        list[k] = json_array();
        json_object_set_new(to, names[k], list[k]);
    }
    thin(list, column, palp_experiment_rows(e));
    palp_experiment_free(e);
    return to;
}
