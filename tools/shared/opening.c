/* opening.c: models and runs as every command opens them. */
#include "opening.h"
#include "cli.h"

#include <math.h>
#include <palpate/indentation.h>
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

int open_tip(const char *command, const char *file, const palp_experiment *run, double *radius_m,
             double place_m[2]) {
    const char *name = "plate";
    palp_tip_kind tip = PALP_TIP_CONE;
    double mm[3] = {NAN, NAN, 0.0};
    palp_experiment_get_string(run, "tip.kind", &name);
    if (!palp_tip_find(name, &tip) || tip == PALP_TIP_FLAT || tip == PALP_TIP_CONE)
        return cli_failure(command, "%s: its tip.kind \"%s\" presses no network; only plate and sphere do",
                           file, name);
    palp_experiment_get_number(run, "tip.x_mm", &mm[0]);
    palp_experiment_get_number(run, "tip.z_mm", &mm[1]);
    if (isnan(mm[0]) != isnan(mm[1]))
        return cli_failure(command, "%s: the place of a sphere needs both tip.x_mm and tip.z_mm", file);
    if (tip == PALP_TIP_SPHERE &&
        (palp_experiment_get_number(run, "tip.radius_mm", &mm[2]) != PALP_OK || !(mm[2] > 0 && mm[2] <= 1e4)))
        return cli_failure(command, "%s: a sphere needs its tip.radius_mm", file);
    for (int k = 0; k < 2; k++)
        place_m[k] = 1e-3 * mm[k];
    *radius_m = 1e-3 * mm[2];
    return CLI_OK;
}
