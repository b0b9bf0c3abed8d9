/* model_read.c: reads and checks the model JSON. */
#include "base/json.h"
#include "model_internal.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(list) (sizeof(list) / sizeof(list)[0])

/* Reads value_mm in metres; true if it is present and positive. */
static palp_status read_length_in_mm(const palp_json *at, double *value_m) {
    double value_mm = 0;
    palp_status status = palp_json_positive(at, &value_mm);
    *value_m = value_mm / 1000;
    return status;
}

static palp_status read_model_version(const palp_json *root) {
    static const char *const keys[] = {"model"};
    palp_json palpate, model;
    if (!json_is_object(root->value) || !palp_json_member(root, "palpate", &palpate))
        return palp_json_fail(root, PALP_ERR_INPUT,
                              "not a model of palpate: it lacks \"palpate\": {\"model\": 1}");
    palp_status status = palp_json_keys(&palpate, COUNT(keys), keys);
    if (!status)
        status = palp_json_require(&palpate, "model", &model);
    if (!status && !(json_is_integer(model.value) && json_integer_value(model.value) >= 1 &&
                     json_integer_value(model.value) <= 4))
        status = palp_json_fail(&model, PALP_ERR_INPUT, "is not 1 to 4, the versions that this build reads");
    return status;
}

static palp_status read_model_kind(const palp_json *root, palp_model *model) {
    palp_json kind;
    const char *name = "";
    palp_status status = palp_json_require(root, "kind", &kind);
    if (!status)
        status = palp_json_string(&kind, &name);
    if (status)
        return status;
    bool network = strcmp(name, "network") == 0;
    if (!network && strcmp(name, "lumped") != 0)
        return palp_json_fail(&kind, PALP_ERR_INPUT, "must be \"lumped\" or \"network\", not \"%s\"", name);
    model->kind = network ? PALP_MODEL_NETWORK : PALP_MODEL_LUMPED;
    return PALP_OK;
}

static palp_status read_specimen_kind(const palp_json *kind, palp_model *model) {
    const char *name = "";
    palp_status status = palp_json_string(kind, &name);
    if (status)
        return status;
    if (!palp_model_kind_valid(name))
        return palp_json_fail(kind, PALP_ERR_INPUT, "must be one short word such as \"cylinder\"");
    strcpy(model->specimen_kind, name);
    return PALP_OK;
}

/* A network may omit the specimen: its mesh has the height. */
static palp_status read_specimen_size(const palp_json *root, palp_model *model) {
    static const char *const keys[] = {"height_mm", "radius_mm", "kind"};
    palp_json specimen, value;
    palp_status status = PALP_OK;
    if (!palp_json_member(root, "specimen", &specimen))
        return model->kind == PALP_MODEL_NETWORK ? PALP_OK : palp_json_require(root, "specimen", &specimen);
    status = palp_json_keys(&specimen, COUNT(keys), keys);
    if (!status && palp_json_member(&specimen, "height_mm", &value))
        status = read_length_in_mm(&value, &model->height_m);
    else if (!status && model->kind == PALP_MODEL_LUMPED)
        status = palp_json_require(&specimen, "height_mm", &value);
    if (!status && palp_json_member(&specimen, "radius_mm", &value))
        status = read_length_in_mm(&value, &model->radius_m);
    if (!status && palp_json_member(&specimen, "kind", &value))
        status = read_specimen_kind(&value, model);
    return status;
}

static palp_status read_formulation_name(const palp_json *root, palp_material *material) {
    palp_json formulation;
    const char *name = "";
    if (!palp_json_member(root, "formulation", &formulation))
        return PALP_OK;
    palp_status status = palp_json_string(&formulation, &name);
    if (status)
        return status;
    bool sedef = strcmp(name, "sedef2008") == 0;
    if (!sedef && strcmp(name, "history") != 0)
        return palp_json_fail(&formulation, PALP_ERR_INPUT,
                              "must be \"history\" or \"sedef2008\", not \"%s\"", name);
    material->formulation = sedef ? PALP_SEDEF2008 : PALP_HISTORY;
    return PALP_OK;
}

static palp_status read_element_material(const palp_json *root, palp_model *model) {
    palp_json value;
    palp_error wrong = {PALP_OK, ""};
    palp_material *material = &model->material;
    palp_status status = palp_model_material_read(root, model);
    if (!status)
        status = read_formulation_name(root, material);
    if (!status)
        status = palp_model_effects_read(root, model);
    if (!status)
        status = palp_model_free_terms_read(root, model);
    if (status)
        return status;
    status = palp_material_check(material, &wrong);
    if (!status)
        return PALP_OK;
    if (status == PALP_ERR_ARGUMENT)
        status = PALP_ERR_INPUT;
    palp_json_member(root, material->formulation == PALP_HISTORY ? "arms" : "formulation", &value);
    return palp_json_fail(value.value ? &value : root, status, "%s%s", value.value ? "cannot be used: " : "",
                          wrong.text);
}

static palp_status read_lattice_nodes(const palp_json *at, size_t nodes[3]) {
    double count[3], product = 1;
    size_t n = 0;
    palp_status status = palp_json_numbers(at, 3, &n, count);
    if (status)
        return status;
    for (size_t i = 0; i < n; i++) {
        if (!(count[i] >= 2) || count[i] != floor(count[i]))
            return palp_json_fail(at, PALP_ERR_INPUT, "must be whole numbers of at least 2, not %g",
                                  count[i]);
        product *= count[i];
    }
    if (n != 3 || !(product <= INT32_MAX))
        return palp_json_fail(at, PALP_ERR_INPUT, "must be three counts, below 2^31 nodes in all");
    for (size_t i = 0; i < 3; i++)
        nodes[i] = (size_t)count[i];
    return PALP_OK;
}

static palp_status read_lattice_size(const palp_json *at, double size_m[3]) {
    double size_mm[3];
    size_t n = 0;
    palp_status status = palp_json_numbers(at, 3, &n, size_mm);
    if (!status && n != 3)
        status = palp_json_fail(at, PALP_ERR_INPUT, "must be three lengths");
    for (size_t i = 0; !status && i < 3; i++) {
        size_m[i] = size_mm[i] / 1000;
        if (!(size_m[i] > 0))
            status = palp_json_fail(at, PALP_ERR_INPUT, "must be greater than 0, not %g", size_mm[i]);
    }
    return status;
}

static palp_status read_mesh_scaling(const palp_json *at, palp_mesh_source *source) {
    palp_json value;
    const char *name = "";
    if (!palp_json_member(at, "scaling", &value))
        return palp_json_member(at, "area_mm2", &value)
                   ? palp_json_fail(&value, PALP_ERR_INPUT, "needs \"scaling\" too")
                   : PALP_OK;
    palp_status status = palp_json_string(&value, &name);
    int kind = PALP_SCALING_NONE;
    while (kind <= PALP_SCALING_CONTINUUM && strcmp(name, palp_model_scalings[kind]) != 0)
        kind++;
    if (!status && kind > PALP_SCALING_CONTINUUM)
        status = palp_json_fail(&value, PALP_ERR_INPUT,
                                "must be \"none\", \"volume\" or \"continuum\", not \"%s\"", name);
    if (!status)
        source->scaling = (palp_mesh_scaling)kind;
    if (!status && palp_json_member(at, "area_mm2", &value)) {
        status = palp_json_positive(&value, &source->area_m2);
        source->area_m2 *= 1e-6;
    }
    return status;
}

static palp_status read_lattice_mesh(const palp_json *at, palp_mesh_source *source) {
    static const char *const keys[] = {"kind", "nodes", "size_mm", "neighbourhood", "scaling", "area_mm2"};
    palp_json value;
    double reach = 26;
    palp_status status = palp_json_keys(at, COUNT(keys), keys);
    if (!status)
        status = palp_json_require(at, "nodes", &value);
    if (!status)
        status = read_lattice_nodes(&value, source->nodes);
    if (!status)
        status = palp_json_require(at, "size_mm", &value);
    if (!status)
        status = read_lattice_size(&value, source->size_m);
    if (!status && palp_json_member(at, "neighbourhood", &value)) {
        status = palp_json_number(&value, &reach);
        if (!status && reach != 6 && reach != 18 && reach != 26)
            status = palp_json_fail(&value, PALP_ERR_INPUT, "must be 6, 18 or 26, not %g", reach);
    }
    if (!status)
        source->neighbourhood = (palp_neighbourhood)(int)reach;
    return status ? status : read_mesh_scaling(at, source);
}

static palp_status read_mesh_file_source(const palp_json *at, palp_mesh_source *source) {
    static const char *const keys[] = {"kind", "path", "scale_mm", "hex_diagonals", "scaling", "area_mm2"};
    palp_json value;
    const char *path = "";
    source->kind = PALP_MESH_FILE;
    source->scale_m = 0.001;
    palp_status status = palp_json_keys(at, COUNT(keys), keys);
    if (!status)
        status = palp_json_require(at, "path", &value);
    if (!status)
        status = palp_json_string(&value, &path);
    if (!status && (!path[0] || strlen(path) >= PALP_PATH_MAX))
        status = palp_json_fail(&value, PALP_ERR_INPUT, "must be the path of a Gmsh file");
    if (!status)
        strcpy(source->path, path);
    if (!status && palp_json_member(at, "scale_mm", &value))
        status = read_length_in_mm(&value, &source->scale_m);
    if (!status && palp_json_member(at, "hex_diagonals", &value))
        status = palp_json_bool(&value, &source->hex_diagonals);
    if (!status)
        status = read_mesh_scaling(at, source);
    if (!status && palp_model_folder(at->file->path, source->folder))
        status = palp_json_fail(&value, PALP_ERR_LIMIT, "has too long a path");
    return status;
}

static palp_status read_mesh_source(const palp_json *root, palp_mesh_source *source) {
    palp_json mesh, kind;
    const char *name = "";
    palp_status status = palp_json_require(root, "mesh", &mesh);
    if (status)
        return status;
    if (!json_is_object(mesh.value))
        return palp_json_fail(&mesh, PALP_ERR_INPUT, "must be an object {...}");
    status = palp_json_require(&mesh, "kind", &kind);
    if (!status)
        status = palp_json_string(&kind, &name);
    if (status)
        return status;
    if (strcmp(name, "lattice") == 0)
        return read_lattice_mesh(&mesh, source);
    if (strcmp(name, "file") == 0)
        return read_mesh_file_source(&mesh, source);
    return palp_json_fail(&kind, PALP_ERR_INPUT, "must be \"lattice\" or \"file\", not \"%s\"", name);
}

static palp_status read_network_members(const palp_json *root, palp_model *model, palp_mesh_source *source) {
    palp_json density, volume, poisson, edges;
    palp_status status = read_mesh_source(root, source);
    model->mesh = source;
    if (!status && palp_json_member(root, "density_kg_m3", &density))
        status = palp_json_not_negative(&density, &model->density_kg_m3);
    if (!status && palp_json_member(root, "volume_modulus_Pa", &volume))
        status = palp_json_positive(&volume, &model->volume_modulus_Pa);
    if (!status && palp_json_member(root, "poisson_ratio", &poisson))
        status = palp_model_ratio_read(&poisson, model->volume_modulus_Pa, &model->poisson_ratio);
    if (!status && palp_json_member(root, "edge_correction", &edges))
        status = palp_json_bool(&edges, &model->edge_correction);
    if (!status)
        status = palp_model_regions_read(root, model, source);
    if (!status)
        status = palp_model_validity_read(root, model);
    if (!status && model->height_m == 0 && source->kind == PALP_MESH_LATTICE)
        model->height_m = source->size_m[1];
    return status;
}

palp_status palp_model_from_json(const palp_json *root, palp_model *model, palp_mesh_source *source) {
    /* the last seven only in a network */
    static const char *const keys[] = {
        "palpate",           "kind",          "specimen",        "stiffness", "arms",
        "dashpot_Ns",        "quasi_linear",  "formulation",     "effects",   "fractional",
        "covariance",        "specimens",     "free_term",       "mesh",      "density_kg_m3",
        "volume_modulus_Pa", "poisson_ratio", "edge_correction", "validity",  "regions"};
    palp_json mesh;
    double *covariance = NULL, *between = NULL;
    size_t n_specimens;
    memset(model, 0, sizeof *model);
    memset(source, 0, sizeof *source);
    palp_status status = read_model_version(root);
    if (!status)
        status = read_model_kind(root, model);
    bool network = model->kind == PALP_MODEL_NETWORK;
    if (!status && !network && palp_json_member(root, "mesh", &mesh))
        status = palp_json_fail(&mesh, PALP_ERR_INPUT, "is only for models of kind \"network\"");
    if (!status)
        status = palp_json_keys(root, network ? COUNT(keys) : COUNT(keys) - 7, keys);
    if (!status)
        status = read_specimen_size(root, model);
    if (!status)
        status = read_element_material(root, model);
    if (!status && network)
        status = read_network_members(root, model, source);
    if (!status)
        status = palp_model_fractional_check(root);
    if (!status)
        status = palp_model_covariance_read(root, &model->material, &covariance);
    if (!status)
        status = palp_model_between_read(root, &model->material, &between, &n_specimens);
    free(covariance);
    free(between);
    return status;
}

palp_status palp_model_read(const char *path, palp_model *model, palp_mesh_source *mesh, palp_error *error) {
    if (!path || !model)
        return palp_error_null(error);
    palp_json_file file;
    palp_json root;
    palp_model made;
    palp_mesh_source unwanted;
    palp_status status = palp_json_open(path, &file, &root, error);
    if (status)
        return status;
    status = palp_model_from_json(&root, &made, mesh ? mesh : &unwanted);
    palp_json_close(&file);
    if (status)
        return status;
    if (!mesh)
        made.mesh = NULL;
    *model = made;
    return PALP_OK;
}

/* Reads one of the two; the pointer of the other is NULL. */
static palp_status read_model_uncertainty(const char *path, double **covariance, double **between,
                                          size_t *n_specimens, palp_error *error) {
    palp_json_file file;
    palp_json root;
    palp_model model;
    palp_mesh_source mesh;
    palp_status status = palp_json_open(path, &file, &root, error);
    if (status)
        return status;
    status = palp_model_from_json(&root, &model, &mesh);
    if (!status)
        status = covariance ? palp_model_covariance_read(&root, &model.material, covariance)
                            : palp_model_between_read(&root, &model.material, between, n_specimens);
    palp_json_close(&file);
    return status;
}

palp_status palp_model_read_covariance(const char *path, double **covariance, palp_error *error) {
    if (!path || !covariance)
        return palp_error_null(error);
    *covariance = NULL;
    return read_model_uncertainty(path, covariance, NULL, NULL, error);
}

palp_status palp_model_read_between(const char *path, double **between, size_t *n_specimens,
                                    palp_error *error) {
    if (!path || !between || !n_specimens)
        return palp_error_null(error);
    *between = NULL;
    *n_specimens = 0;
    return read_model_uncertainty(path, NULL, between, n_specimens, error);
}
