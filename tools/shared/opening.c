/* opening.c: models and runs as every command opens them. */
#include "opening.h"
#include "cli.h"

#include <palpate/segments.h>
#include <stdlib.h>
#include <string.h>

int open_model(const char *command, const char *file, palp_model *model, palp_mesh_source *mesh) {
    palp_error error = {PALP_OK, ""};
    palp_status status = palp_model_read(file, model, mesh, &error);
    return status ? cli_status(command, status, &error) : CLI_OK;
}

int open_model_of(const char *command, const char *file, palp_model_kind kind, const char *otherwise,
                  palp_model *model, palp_mesh_source *mesh) {
    int code = open_model(command, file, model, mesh);
    return code == CLI_OK && model->kind != kind ? cli_failure(command, "%s: %s", file, otherwise) : code;
}

int open_refuse_mass(const char *command, const char *file, const palp_model *model) {
    return model->density_kg_m3 > 0
               ? cli_failure(command,
                             "%s: has density_kg_m3, but networks are fitted without mass; "
                             "remove the key",
                             file)
               : CLI_OK;
}

int open_run(const char *command, const char *file, palp_experiment **run) {
    palp_error error = {PALP_OK, ""};
    palp_status status = palp_experiment_read(file, run, &error);
    return status ? cli_status(command, status, &error) : CLI_OK;
}

palp_status open_smooth_path(palp_experiment *run) {
    static const char *const coordinate[] = {"depth_mm", "tool_x_mm", "tool_y_mm", "tool_z_mm"};
    palp_status status = PALP_OK;
    double noise_mm;
    for (size_t k = 0; k < sizeof coordinate / sizeof *coordinate && !status; k++) {
        double *column = palp_experiment_column(run, coordinate[k]);
        if (column)
            status = palp_segments_smooth_path(palp_experiment_rows(run),
                                               palp_experiment_column(run, "time_s"), column, &noise_mm);
    }
    return status;
}

palp_status open_set_text(palp_experiment *run, const char *key, const char *text) {
    char *copy = malloc(strlen(text) + 1);
    palp_status status = copy ? palp_experiment_set_string(run, key, palp_text_make_plain(strcpy(copy, text)))
                              : PALP_ERR_NO_MEMORY;
    free(copy);
    return status;
}

const char *open_no_specimen(const palp_experiment *run) {
    const char *kind;
    if (palp_experiment_get_string(run, "specimen.kind", &kind))
        return NULL;
    return strcmp(kind, "none") == 0 || strcmp(kind, "rigid") == 0 ? kind : NULL;
}
