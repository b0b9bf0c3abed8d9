/* import_write.c: an imported recording as an experiment CSV, with where each number is from. */
#include "import.h"
#include "shared/opening.h"

#include <ctype.h>
#include <math.h>
#include <palpate/version.h>
#include <string.h>
#include <sys/stat.h>

static const char NAME[] = "import";
static const char *const formats[] = {"mach1", "instron", "csv"};

/* Adds a key to the header unless an earlier one failed. */
static void number(palp_experiment *run, const char *key, double value, palp_status *status) {
    *status = *status ? *status : palp_experiment_set_number(run, key, value);
}

static void string(palp_experiment *run, const char *key, const char *value, palp_status *status) {
    *status = *status || !value || !*value ? *status : open_set_text(run, key, value);
}

static void positive(palp_experiment *run, const char *key, double value, palp_status *status) {
    if (value > 0)
        number(run, key, value, status);
}

static palp_status set_specimen(const import_options *o, const import_source *s, palp_experiment *run) {
    palp_status status = PALP_OK;
    bool cylinder = s->radius_mm > 0;
    string(run, "specimen.name", o->specimen, &status);
    string(run, "specimen.kind", o->kind ? o->kind : cylinder ? "cylinder" : NULL, &status);
    positive(run, "specimen.height_mm", s->height_mm, &status);
    positive(run, "specimen.radius_mm", s->radius_mm, &status);
    string(run, "tip.kind", s->tip, &status);
    positive(run, "tip.radius_mm", s->tip_radius_mm, &status);
    positive(run, "tip.half_angle_deg", s->tip_angle_deg, &status);
    string(run, "protocol.kind", s->protocol, &status);
    positive(run, "protocol.depth_mm", import_setting_number(s, "Amplitude, mm"), &status);
    positive(run, "protocol.rate_mm_s", import_setting_number(s, "Velocity, mm/s"), &status);
    positive(run, "protocol.rate_mm_s", import_setting_number(s, "Stage Velocity, mm/s"), &status);
    positive(run, "protocol.rate_mm_s", import_setting_number(s, "Speed (mm/min)") / 60, &status);
    positive(run, "protocol.ramps", import_setting_number(s, "Number of Ramp"), &status);
    if (strcmp(s->protocol, "ramp_hold") == 0)
        positive(run, "protocol.hold_s", import_setting_number(s, "Fixed Relaxation Time, s"), &status);
    return status;
}

static palp_status set_contact(const import_source *s, palp_experiment *run) {
    palp_status status = PALP_OK;
    string(run, "contact.rule", s->contact_rule, &status);
    string(run, "contact.from", s->contact_from, &status);
    number(run, "contact.depth_mm", s->contact_mm, &status);
    positive(run, "contact.sd_mm", s->contact_sd_mm, &status);
    number(run, "contact.zero_N", s->zero_N, &status);
    return status;
}

static palp_status set_source(const import_options *o, const import_source *s, palp_experiment *run) {
    palp_status status = PALP_OK;
    char text[64];
    string(run, "import.file", cli_base(s->file), &status);
    string(run, "import.block", s->block, &status);
    string(run, "import.format", formats[s->format], &status);
    number(run, "import.size_bytes", (double)s->size, &status);
    snprintf(text, sizeof text, "%08lx", (unsigned long)s->crc32);
    string(run, "import.crc32", text, &status);
    string(run, "import.license", o->license, &status);
    positive(run, "import.rows_bad", (double)s->bad, &status);
    positive(run, "import.rows_doubled", (double)s->doubled, &status);
    if (isfinite(s->start_s))
        number(run, "session.start_s", s->start_s, &status);
    snprintf(text, sizeof text, "%s, %s, %s", s->unit[TIME]->name, s->unit[s->role[DEPTH]]->name,
             s->unit[s->role[FORCE]]->name);
    string(run, "import.units", text, &status);
    number(run, "import.depth_sign", s->depth_sign, &status);
    number(run, "import.force_sign", s->force_sign, &status);
    string(run, "import.sign_rule", s->sign_rule, &status);
    return status;
}

/* "Stage Velocity, mm/s" -> tester.Stage_Velocity_mm_s. */
static palp_status set_settings(const import_source *s, palp_experiment *run) {
    for (size_t i = 0; i < s->n_settings; i++) {
        char key[IMPORT_WORD + 16] = "tester.";
        double value;
        size_t n = strlen(key);
        for (const char *c = s->setting[i][0]; *c && n + 1 < sizeof key; c++) {
            if (isalnum((unsigned char)*c))
                key[n++] = *c;
            else if (key[n - 1] != '_' && key[n - 1] != '.')
                key[n++] = '_';
        }
        while (key[n - 1] == '_')
            n--;
        key[n] = '\0';
        palp_status status = key[n - 1] == '.' ? PALP_OK
                             : cli_read_number(s->setting[i][1], &value)
                                 ? palp_experiment_set_number(run, key, value)
                                 : open_set_text(run, key, s->setting[i][1]);
        if (status && status != PALP_ERR_ARGUMENT)
            return status;
    }
    return PALP_OK;
}

static bool whole(const import_source *s, size_t j) {
    for (size_t i = 0; i < s->rows; i++)
        if (!isfinite(s->value[i * s->n_columns + j]))
            return false;
    return true;
}

/* Copies other columns that have a name and only numbers, with commas removed from their names. */
static palp_status add_others(const import_source *s, palp_experiment *run) {
    for (size_t j = 0; j < s->n_columns; j++) {
        char name[IMPORT_WORD];
        size_t n = 0;
        for (const char *c = s->column[j]; *c; c++)
            if (*c != ',' && *c != '#')
                name[n++] = *c;
        name[n] = '\0';
        bool used = j == s->used[TIME] || j == s->used[DEPTH] || j == s->used[FORCE];
        palp_status status =
            used || !n || !whole(s, j) ? PALP_ERR_ARGUMENT : palp_experiment_add_column(run, name);
        if (status == PALP_ERR_NO_MEMORY)
            return status;
        double *to = status ? NULL : palp_experiment_column(run, name);
        for (size_t i = 0; to && i < s->rows; i++)
            to[i] = s->value[i * s->n_columns + j];
    }
    return PALP_OK;
}

static palp_status fill(const import_options *o, const import_source *s, palp_experiment *run) {
    double *time_s = palp_experiment_column(run, "time_s"),
           *depth_mm = palp_experiment_column(run, "depth_mm"),
           *force_N = palp_experiment_column(run, "force_N");
    for (size_t i = 0; i < s->rows; i++) {
        time_s[i] = s->time_s[i];
        depth_mm[i] = s->depth_mm[i];
        force_N[i] = s->force_N[i];
    }
    palp_status status = set_specimen(o, s, run);
    status = status ? status : set_contact(s, run);
    status = status ? status : set_source(o, s, run);
    status = status ? status : set_settings(s, run);
    status = status ? status : add_others(s, run);
    string(run, "palpate.version", palp_version(), &status);
    return status;
}

bool import_out_is_file(const import_options *o) {
    struct stat entry;
    const char *end = strrchr(cli_base(o->out), '.');
    bool kind = end && (strcmp(end, ".csv") == 0 || strcmp(end, ".h5") == 0 || strcmp(end, ".hdf5") == 0);
    return kind && (stat(o->out, &entry) != 0 || !S_ISDIR(entry.st_mode));
}

int import_out_path(const import_options *o, const char *name, char path[CLI_PATH_MAX]) {
    int n = import_out_is_file(o) ? snprintf(path, CLI_PATH_MAX, "%s", o->out)
                                  : snprintf(path, CLI_PATH_MAX, "%s/%s.csv", o->out, name);
    return n > 0 && n < CLI_PATH_MAX ? CLI_OK
                                     : cli_failure(NAME, "%s/%s.csv: the name is too long", o->out, name);
}

int import_write(const import_options *o, const import_source *s) {
    char path[CLI_PATH_MAX];
    palp_experiment *run = NULL;
    palp_error error = {PALP_OK, ""};
    int code = import_out_path(o, s->name, path);
    if (code)
        return code;
    palp_status status = palp_experiment_create(s->rows, &run);
    status = status ? status : fill(o, s, run);
    status = status ? status : palp_experiment_write(run, path, &error);
    palp_experiment_free(run);
    return status ? cli_status_of(NAME, path, status, &error) : CLI_OK;
}
