/* model.c: what a model file refers to: folder and path of its mesh, the mesh itself, valid words. */
#include "base/file.h"
#include "model_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *const palp_model_scalings[] = {"none", "volume", "continuum"};

double palp_model_area(double radius_m) {
    return 3.14159265358979323846 * radius_m * radius_m;
}

double palp_model_lowest(const palp_law *law) {
    return palp_law_minimum(law, fmax(PALP_MODEL_STRAIN, law->strain_max));
}

bool palp_model_kind_valid(const char *kind) {
    static const char allowed[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    size_t length = strspn(kind, allowed);
    return kind[length] == '\0' && length < PALP_SPECIMEN_KIND_MAX;
}

palp_status palp_model_folder(const char *path, char folder[PALP_PATH_MAX]) {
    const char *slash = strrchr(path, '/');
    size_t length = slash ? (size_t)(slash - path) : 0;
    if (slash == path)
        length = 1;
    if (length >= PALP_PATH_MAX)
        return PALP_ERR_LIMIT;
    memcpy(folder, path, length);
    folder[length] = '\0';
    return PALP_OK;
}

palp_status palp_model_join(const char *folder, const char *path, char joined[PALP_PATH_MAX]) {
    bool alone = path[0] == '/' || folder[0] == '\0';
    int n = alone ? snprintf(joined, PALP_PATH_MAX, "%s", path)
                  : snprintf(joined, PALP_PATH_MAX, "%s/%s", folder, path);
    return n >= 0 && n < PALP_PATH_MAX ? PALP_OK : PALP_ERR_LIMIT;
}

palp_status palp_model_mesh(const palp_model *model, palp_mesh **mesh, palp_error *error) {
    if (!model || !mesh)
        return palp_error_null(error);
    const palp_mesh_source *source = model->mesh;
    char path[PALP_PATH_MAX];
    *mesh = NULL;
    if (model->kind != PALP_MODEL_NETWORK)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "a lumped model has no mesh");
    if (!source)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "the model was read without the source of its mesh");
    palp_status status = PALP_OK;
    palp_error why = {PALP_OK, ""};
    if (source->kind == PALP_MESH_LATTICE) {
        strcpy(path, "the lattice");
        status = palp_mesh_lattice(source->nodes, source->size_m, source->neighbourhood, mesh);
        if (status)
            palp_error_set(error, status, "%s: %s", path, palp_status_text(status));
    } else {
        status = palp_model_join(source->folder, source->path, path);
        status = status ? palp_error_set(error, status, "the path of the mesh is too long")
                        : palp_mesh_read_gmsh(path, source->scale_m, source->hex_diagonals, mesh, error);
    }
    if (!status)
        palp_mesh_scale(*mesh, source->scaling, source->area_m2, &why);
    for (size_t r = 0; r < source->n_regions && !status && !why.status; r++)
        palp_region_place_in(*mesh, &source->regions[r], &why);
    if (!status && why.status) {
        palp_mesh_free(*mesh);
        *mesh = NULL;
        status = palp_error_set(error, why.status, "%s: %s", path, why.text);
    }
    return status;
}
