/* model_write.c: writes the model JSON. */
#define _XOPEN_SOURCE 700 /* locale_t, open_memstream, realpath */
#include "base/json.h"
#include "base/text.h"
#include "model_internal.h"
#include "base/number.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static palp_status check_stiffness_law(const palp_model *model, palp_error *error) {
    const palp_law *law = &model->material.law;
    double area_m2 = palp_model_area(model->radius_m);
    bool hyperelastic = law->kind != PALP_LAW_POLYNOMIAL && law->kind != PALP_LAW_SPLINE;
    if (hyperelastic && !(fabs(area_m2 - law->area_m2) <= 1e-9 * law->area_m2))
        return palp_error_set(error, PALP_ERR_ARGUMENT,
                              "the area of the hyperelastic law differs from that of the specimen");
    double lowest_N = palp_model_lowest(law);
    if (!(lowest_N > 0))
        return palp_error_set(error, PALP_ERR_ARGUMENT, "the stiffness falls to %.6g N at a strain below %g",
                              lowest_N, fmax(PALP_MODEL_STRAIN, law->strain_max));
    palp_law limited = *law;
    if (palp_law_limit(&limited, law->strain_max) || limited.strain_max != law->strain_max)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "the force does not rise at strain_max = %g",
                              law->strain_max);
    return PALP_OK;
}

static bool is_lattice_valid(const palp_mesh_source *mesh) {
    for (size_t i = 0; i < 3; i++)
        if (mesh->nodes[i] < 2 || !(mesh->size_m[i] > 0) || !isfinite(mesh->size_m[i]))
            return false;
    return mesh->neighbourhood == 6 || mesh->neighbourhood == 18 || mesh->neighbourhood == 26;
}

static bool is_specimen_shape_valid(const palp_model *model) {
    const palp_mesh_source *mesh = model->mesh;
    bool network = model->kind == PALP_MODEL_NETWORK;
    if (!(model->height_m >= 0) || !isfinite(model->height_m) || (!network && model->height_m == 0))
        return false;
    if (!(model->radius_m >= 0) || !isfinite(model->radius_m) || !palp_model_kind_valid(model->specimen_kind))
        return false;
    if (!network)
        return true;
    if (!mesh || !(model->density_kg_m3 >= 0) || !isfinite(model->density_kg_m3))
        return false;
    if (!(model->volume_modulus_Pa >= 0) || !isfinite(model->volume_modulus_Pa))
        return false;
    if (model->poisson_ratio != 0 &&
        !(model->poisson_ratio >= 0.25 && model->poisson_ratio < 0.5 && model->volume_modulus_Pa == 0))
        return false;
    if (!palp_model_validity_valid(model) || !palp_model_regions_valid(model))
        return false;
    if ((unsigned)mesh->scaling > PALP_SCALING_CONTINUUM || !(mesh->area_m2 >= 0) || !isfinite(mesh->area_m2))
        return false;
    if (mesh->kind == PALP_MESH_LATTICE)
        return is_lattice_valid(mesh);
    return mesh->path[0] && mesh->scale_m > 0 && isfinite(mesh->scale_m);
}

/* Refuses values that could not be read again. */
static palp_status check_model_before_write(const palp_model *model, palp_error *error) {
    if (model->kind == PALP_MODEL_NETWORK && model->mesh && model->mesh->kind == PALP_MESH_FILE &&
        !palp_text_is_utf8(model->mesh->path))
        return palp_error_set(error, PALP_ERR_ARGUMENT,
                              "the path of its mesh is not UTF-8, which JSON requires; rename the mesh");
    if (!is_specimen_shape_valid(model))
        return palp_error_set(error, PALP_ERR_ARGUMENT, "the model's specimen or mesh is out of range");
    for (size_t r = 0; model->kind == PALP_MODEL_NETWORK && r < model->mesh->n_regions; r++)
        if ((!palp_text_is_utf8(model->mesh->regions[r].name) ||
             !palp_text_is_utf8(model->mesh->regions[r].set)))
            return palp_error_set(error, PALP_ERR_ARGUMENT, "the name of a region is not UTF-8");
    palp_status status = palp_material_check(&model->material, error);
    if (!status)
        status = check_stiffness_law(model, error);
    if (!status && model->fractional && !palp_model_fractional_valid(model->fractional))
        status = palp_error_set(error, PALP_ERR_ARGUMENT, "the fractional element is out of range");
    if (!status && model->covariance &&
        !palp_model_covariance_valid(palp_model_covariance_size(&model->material), model->covariance))
        status = palp_error_set(error, PALP_ERR_ARGUMENT,
                                "the covariance is not symmetric, or has a correlation beyond 1");
    if (!status && model->between &&
        (model->n_specimens < 2 ||
         !palp_model_covariance_valid(palp_model_covariance_size(&model->material), model->between)))
        status = palp_error_set(error, PALP_ERR_ARGUMENT,
                                "the covariance between specimens is invalid, or they are fewer than 2");
    if (!status)
        status = palp_model_free_terms_check(model, error);
    return status ? status : palp_model_effects_check(model, error);
}

/* Destination of a model's text, and separators of its parts. */
typedef struct writer {
    FILE *stream;
    const char *open, *between, *item, *close;
} writer;

static const writer lines = {NULL, "{\n  ", ",\n  ", "\n    ", "\n}\n"};
static const writer one_line = {NULL, "{", ", ", "", "}"};

static void print_json_number(const writer *w, const char *before, double value) {
    char text[PALP_NUMBER_TEXT];
    palp_number_format(value, text);
    fprintf(w->stream, "%s%s", before, text);
}

/* Prints the shortest number of millimetres that reads back as the same metres, if there is one. */
static void print_length_in_mm(const writer *w, const char *before, double value_m) {
    char text[PALP_NUMBER_TEXT];
    double back = 0;
    for (int precision = 15; precision <= 17; precision++) {
        snprintf(text, sizeof text, "%.*g", precision, 1000 * value_m);
        if (palp_number_parse(text, &back) && back / 1000 == value_m)
            break;
    }
    fprintf(w->stream, "%s%s", before, text);
}

/* The shortest number near value / unit that times unit reads back as value; false: there is none. */
static bool format_quantity_in_unit(double value, double unit, char text[PALP_NUMBER_TEXT]) {
    double near = value / unit, back = 0;
    const double tries[] = {near, nextafter(near, INFINITY), nextafter(near, -INFINITY)};
    for (int i = 0; i < 9; i++) {
        snprintf(text, PALP_NUMBER_TEXT, "%.*g", 15 + i % 3, tries[i / 3]);
        if (palp_number_parse(text, &back) && back * unit == value)
            return true;
    }
    return false;
}

/* If no number reads back as value, prints one that reads back as its neighbour. */
static void print_quantity_in_unit(const writer *w, const char *before, double value, double unit) {
    char text[PALP_NUMBER_TEXT];
    if (!format_quantity_in_unit(value, unit, text))
        format_quantity_in_unit(value / unit * unit, unit, text);
    fprintf(w->stream, "%s%s", before, text);
}

static void print_number_list(const writer *w, const char *before, size_t n, const double *values) {
    fprintf(w->stream, "%s[", before);
    for (size_t i = 0; i < n; i++)
        print_json_number(w, i ? ", " : "", values[i]);
    fputc(']', w->stream);
}

static void print_specimen_size(const writer *w, const palp_model *model) {
    const char *comma = "";
    if (model->height_m == 0 && model->radius_m == 0 && !model->specimen_kind[0])
        return;
    fprintf(w->stream, "%s\"specimen\": {", w->between);
    if (model->height_m > 0) {
        print_length_in_mm(w, "\"height_mm\": ", model->height_m);
        comma = ", ";
    }
    if (model->radius_m > 0) {
        fputs(comma, w->stream);
        print_length_in_mm(w, "\"radius_mm\": ", model->radius_m);
        comma = ", ";
    }
    if (model->specimen_kind[0])
        fprintf(w->stream, "%s\"kind\": \"%s\"", comma, model->specimen_kind);
    fputc('}', w->stream);
}

static void print_stiffness_law(const writer *w, const palp_law *law) {
    fprintf(w->stream, "%s\"stiffness\": {\"kind\": \"%s\"", w->between, palp_law_kind_name(law->kind));
    if (law->kind == PALP_LAW_SPLINE) {
        print_number_list(w, ", \"strain\": ", law->n, law->strain);
        print_number_list(w, ", \"stiffness_N\": ", law->n, law->coefficients);
    } else if (law->kind == PALP_LAW_POLYNOMIAL)
        print_number_list(w, ", \"coefficients_N\": ", law->n, law->coefficients);
    else
        print_number_list(w, ", \"coefficients_Pa\": ", law->n, law->coefficients);
    if (law->strain_max > 0)
        print_json_number(w, ", \"strain_max\": ", law->strain_max);
    fputc('}', w->stream);
}

static void print_maxwell_arm(const writer *w, const palp_arm *arm) {
    print_json_number(w, "{\"stiffness_N\": ", arm->stiffness_N);
    print_json_number(w, ", \"viscosity_Ns\": ", arm->viscosity_Ns);
    if (arm->beta != 0)
        print_json_number(w, ", \"stiffness_per_strain\": ", arm->beta);
    if (arm->gamma != 0)
        print_json_number(w, ", \"time_per_strain\": ", arm->gamma);
    fputc('}', w->stream);
}

static void print_arms_and_dashpot(const writer *w, const palp_material *material) {
    fprintf(w->stream, "%s\"arms\": [", w->between);
    for (size_t j = 0; j < material->n_arms; j++) {
        fprintf(w->stream, "%s%s", j ? (w->item[0] ? "," : ", ") : "", w->item);
        print_maxwell_arm(w, &material->arms[j]);
    }
    fputc(']', w->stream);
    if (material->dashpot_Ns > 0) {
        fputs(w->between, w->stream);
        print_json_number(w, "\"dashpot_Ns\": ", material->dashpot_Ns);
    }
    if (material->quasi_linear)
        fprintf(w->stream, "%s\"quasi_linear\": true", w->between);
}

static void print_element_material(const writer *w, const palp_material *material) {
    print_stiffness_law(w, &material->law);
    print_arms_and_dashpot(w, material);
    fprintf(w->stream, "%s\"formulation\": \"%s\"", w->between,
            material->formulation == PALP_SEDEF2008 ? "sedef2008" : "history");
}

static void print_one_effect(const writer *w, const palp_effect *effect) {
    const palp_effect_info *info = palp_effect_look_up(effect->id);
    fprintf(w->stream, "{\"id\": \"%s\", \"parameters\": {", info->id);
    for (size_t k = 0; k < info->n_parameters; k++) {
        fprintf(w->stream, "%s\"%s\"", k ? ", " : "", info->parameter[k].key);
        print_quantity_in_unit(w, ": ", effect->value[k], info->parameter[k].unit);
    }
    fputs("}}", w->stream);
}

static void print_effects_list(const writer *w, const palp_model *model) {
    fprintf(w->stream, "%s\"effects\": [", w->between);
    for (size_t i = 0; i < model->n_effects; i++) {
        fprintf(w->stream, "%s%s", i ? (w->item[0] ? "," : ", ") : "", w->item);
        print_one_effect(w, &model->effects[i]);
    }
    fputc(']', w->stream);
}

static void print_free_terms(const writer *w, const palp_model *model) {
    if (model->n_free == 0)
        return;
    fprintf(w->stream, "%s\"free_term\": [", w->between);
    for (size_t i = 0; i < model->n_free; i++) {
        const palp_free_term *t = &model->free_term[i];
        const double unit = palp_model_free_unit(t->kind);
        fprintf(w->stream, "%s%s{\"depends_on\": \"%s\", \"class\": \"%s\"",
                i ? (w->item[0] ? "," : ", ") : "", w->item, palp_free_kind_name(t->kind),
                palp_free_class_name(t->does));
        print_quantity_in_unit(w, ", \"from\": ", t->from, unit);
        print_quantity_in_unit(w, ", \"to\": ", t->to, unit);
        print_length_in_mm(w, ", \"depth_mm\": ", t->depth_m);
        print_length_in_mm(w, ", \"slow_mm_s\": ", t->slow_m_s);
        if (palp_model_free_of_force(t->kind))
            print_quantity_in_unit(w, ", \"plate_N\": ", t->plate_N, 1.0);
        print_number_list(w, ", \"force_N\": ", PALP_FREE_NODES, t->force_N);
        print_number_list(w, ", \"sd_N\": ", PALP_FREE_NODES, t->sd_N);
        fputc('}', w->stream);
    }
    fputc(']', w->stream);
}

static void print_square_matrix(const writer *w, const char *key, size_t n, const double *square) {
    fprintf(w->stream, "\"%s\": [", key);
    for (size_t i = 0; i < n; i++) {
        fprintf(w->stream, "%s%s", i ? (w->item[0] ? "," : ", ") : "", w->item);
        print_number_list(w, "", n, square + i * n);
    }
    fputc(']', w->stream);
}

/* Prints the spectrum that the arms stand for, the covariance, and the differences of specimens. */
static void print_model_uncertainty(const writer *w, const palp_model *model) {
    size_t n = palp_model_covariance_size(&model->material);
    const double *f = model->fractional;
    if (f) {
        fprintf(w->stream, "%s\"fractional\": {", w->between);
        print_json_number(w, "\"stiffness_N\": ", f[0]);
        print_json_number(w, ", \"time_s\": ", f[1]);
        print_json_number(w, ", \"exponent\": ", f[2]);
        fputc('}', w->stream);
    }
    if (model->covariance) {
        fputs(w->between, w->stream);
        print_square_matrix(w, "covariance", n, model->covariance);
    }
    if (model->between) {
        fprintf(w->stream, "%s\"specimens\": {\"count\": %zu, ", w->between, model->n_specimens);
        print_square_matrix(w, "between", n, model->between);
        fputc('}', w->stream);
    }
}

/* The mesh's last members. */
static void scaling_print(const writer *w, const palp_mesh_source *mesh) {
    if (mesh->scaling != PALP_SCALING_NONE)
        fprintf(w->stream, ", \"scaling\": \"%s\"", palp_model_scalings[mesh->scaling]);
    if (mesh->scaling != PALP_SCALING_NONE && mesh->area_m2 > 0)
        print_quantity_in_unit(w, ", \"area_mm2\": ", mesh->area_m2, 1e-6);
    fputc('}', w->stream);
}

static void print_lattice_mesh(const writer *w, const palp_mesh_source *mesh) {
    const size_t *n = mesh->nodes;
    fprintf(w->stream, "%s\"mesh\": {\"kind\": \"lattice\", \"nodes\": [%zu, %zu, %zu], ", w->between, n[0],
            n[1], n[2]);
    for (size_t i = 0; i < 3; i++)
        print_length_in_mm(w, i ? ", " : "\"size_mm\": [", mesh->size_m[i]);
    fputc(']', w->stream);
    if (mesh->neighbourhood != PALP_NEIGHBOURS_26)
        fprintf(w->stream, ", \"neighbourhood\": %d", (int)mesh->neighbourhood);
    scaling_print(w, mesh);
}

static palp_status print_json_text(const writer *w, const char *before, const char *text) {
    json_t *value = json_string(text);
    char *quoted = value ? json_dumps(value, JSON_ENCODE_ANY) : NULL;
    json_decref(value);
    if (quoted)
        fprintf(w->stream, "%s%s", before, quoted);
    free(quoted);
    return quoted ? PALP_OK : PALP_ERR_NO_MEMORY;
}

static palp_status print_mesh_file_source(const writer *w, const palp_mesh_source *mesh, const char *path) {
    fputs(w->between, w->stream);
    palp_status status = print_json_text(w, "\"mesh\": {\"kind\": \"file\", \"path\": ", path);
    fputs(", ", w->stream);
    print_length_in_mm(w, "\"scale_mm\": ", mesh->scale_m);
    fputs(mesh->hex_diagonals ? ", \"hex_diagonals\": true" : "", w->stream);
    scaling_print(w, mesh);
    return status;
}

/* What spheres were found to be off by. */
static void print_validity(const writer *w, const palp_model *model) {
    if (model->n_validity == 0)
        return;
    fprintf(w->stream, "%s\"validity\": [", w->between);
    for (size_t i = 0; i < model->n_validity; i++) {
        fprintf(w->stream, "%s%s", i ? (w->item[0] ? "," : ", ") : "", w->item);
        print_length_in_mm(w, "{\"radius_mm\": ", model->validity[i].radius_m);
        print_length_in_mm(w, ", \"depth_mm\": ", model->validity[i].depth_m);
        print_json_number(w, ", \"error\": ", model->validity[i].error);
        fputc('}', w->stream);
    }
    fputc(']', w->stream);
}

static void print_place(const writer *w, const char *before, const double place_m[3]) {
    for (size_t k = 0; k < 3; k++)
        print_length_in_mm(w, k ? ", " : before, place_m[k]);
    fputc(']', w->stream);
}

static palp_status print_one_region(const writer *w, const palp_region *region) {
    const writer first = {w->stream, "", "", "", ""}, others = {w->stream, "", ", ", "", ""};
    palp_status status = print_json_text(w, "{\"name\": ", region->name);
    if (region->shape == PALP_REGION_BOX) {
        print_place(w, ", \"box\": {\"low_mm\": [", region->low_m);
        print_place(w, ", \"high_mm\": [", region->high_m);
        fputc('}', w->stream);
    } else if (region->shape == PALP_REGION_SPHERE) {
        print_place(w, ", \"sphere\": {\"centre_mm\": [", region->centre_m);
        print_length_in_mm(w, ", \"radius_mm\": ", region->radius_m);
        fputc('}', w->stream);
    }
    if (region->shape == PALP_REGION_MEMBRANE) {
        fputs(", \"membrane\": {", w->stream);
        if (!status && region->set[0])
            status = print_json_text(w, "\"set\": ", region->set);
        fputc('}', w->stream);
    }
    if (region->stiffness > 0)
        print_json_number(w, ", \"stiffness_factor\": ", region->stiffness);
    else {
        fputs(", \"material\": {", w->stream);
        print_stiffness_law(&first, &region->own_material.law);
        print_arms_and_dashpot(&others, &region->own_material);
        fputc('}', w->stream);
    }
    if (region->poisson_ratio > 0)
        print_json_number(w, ", \"poisson_ratio\": ", region->poisson_ratio);
    if (region->fibre_Pa > 0) {
        for (size_t k = 0; k < 3; k++)
            print_json_number(w, k ? ", " : ", \"fibre\": {\"direction\": [", region->fibre[k]);
        print_json_number(w, "], \"stiffness_Pa\": ", region->fibre_Pa);
        fputc('}', w->stream);
    }
    fputc('}', w->stream);
    return status;
}

static palp_status print_regions(const writer *w, const palp_mesh_source *mesh) {
    palp_status status = PALP_OK;
    if (mesh->n_regions == 0)
        return PALP_OK;
    fprintf(w->stream, "%s\"regions\": [", w->between);
    for (size_t r = 0; r < mesh->n_regions && !status; r++) {
        fprintf(w->stream, "%s%s", r ? (w->item[0] ? "," : ", ") : "", w->item);
        status = print_one_region(w, &mesh->regions[r]);
    }
    fputc(']', w->stream);
    return status;
}

static void print_positive(const writer *w, const char *key, double value) {
    if (value > 0) {
        fputs(w->between, w->stream);
        print_json_number(w, key, value);
    }
}

static palp_status print_network_members(const writer *w, const palp_model *model, const char *mesh_path) {
    palp_status status = PALP_OK;
    if (model->mesh->kind == PALP_MESH_LATTICE)
        print_lattice_mesh(w, model->mesh);
    else
        status = print_mesh_file_source(w, model->mesh, mesh_path);
    print_positive(w, "\"density_kg_m3\": ", model->density_kg_m3);
    print_positive(w, "\"volume_modulus_Pa\": ", model->volume_modulus_Pa);
    print_positive(w, "\"poisson_ratio\": ", model->poisson_ratio);
    if (model->edge_correction)
        fprintf(w->stream, "%s\"edge_correction\": true", w->between);
    print_validity(w, model);
    return status ? status : print_regions(w, model->mesh);
}

static palp_status print_complete_model(const writer *w, const palp_model *model, const char *mesh_path) {
    palp_locale locale;
    bool network = model->kind == PALP_MODEL_NETWORK;
    if (!palp_locale_enter(&locale))
        return PALP_ERR_NO_MEMORY;
    fprintf(w->stream, "%s\"palpate\": {\"model\": %d}", w->open,
            network && model->edge_correction       ? 4
            : model->n_free > 0                     ? 3
            : network && model->mesh->n_regions > 0 ? 2
                                                    : 1); /* older builds do not read these members */
    fprintf(w->stream, "%s\"kind\": \"%s\"", w->between, network ? "network" : "lumped");
    print_specimen_size(w, model);
    print_element_material(w, &model->material);
    print_effects_list(w, model);
    print_free_terms(w, model);
    print_model_uncertainty(w, model);
    palp_status status = network ? print_network_members(w, model, mesh_path) : PALP_OK;
    fputs(w->close, w->stream);
    palp_locale_leave(&locale);
    return status;
}

/* ---- the mesh's path relative to another folder ---- */

/* Path of to relative to the folder from, both absolute: "../meshes/a.msh". */
static palp_status find_relative_path(const char *from, const char *to, char path[PALP_PATH_MAX]) {
    size_t same = 0; /* length of the common folders, with the '/' after them */
    for (size_t i = 0; to[i] && (from[i] == to[i] || (!from[i] && to[i] == '/')); i++) {
        if (to[i] == '/')
            same = i + 1;
        if (!from[i])
            break;
    }
    size_t length = strlen(from), n = 0;
    for (size_t i = same; i < length; i++)
        if (i == same || from[i - 1] == '/') {
            if (n + 4 > PALP_PATH_MAX)
                return PALP_ERR_LIMIT;
            memcpy(path + n, "../", 4);
            n += 3;
        }
    if (n + strlen(to + same) + 1 > PALP_PATH_MAX)
        return PALP_ERR_LIMIT;
    strcpy(path + n, to + same);
    return PALP_OK;
}

/* find_relative_path of resolved folders; ERR_FILE if one does not exist. */
static palp_status move_mesh_path_to_target(const palp_mesh_source *mesh, const char *target,
                                            char path[PALP_PATH_MAX]) {
    char old_folder[PALP_PATH_MAX], new_folder[PALP_PATH_MAX], name[PALP_PATH_MAX], joined[PALP_PATH_MAX];
    if (palp_model_folder(target, new_folder) || palp_model_join(mesh->folder, mesh->path, name) ||
        palp_model_folder(name, old_folder))
        return PALP_ERR_LIMIT;
    char *from = realpath(new_folder[0] ? new_folder : ".", NULL);
    char *to = realpath(old_folder[0] ? old_folder : ".", NULL);
    const char *slash = strrchr(name, '/');
    palp_status status = from && to ? PALP_OK : PALP_ERR_FILE;
    if (!status)
        status = palp_model_join(strcmp(to, "/") == 0 ? "" : to, slash ? slash + 1 : name, joined);
    if (!status)
        status = find_relative_path(from, joined, path);
    free(from);
    free(to);
    return status;
}

/* The mesh's path for a model that is written at target. */
static palp_status mesh_path_seen_from_target(const palp_model *model, const char *target,
                                              char path[PALP_PATH_MAX]) {
    char folder[PALP_PATH_MAX];
    const palp_mesh_source *mesh = model->mesh;
    bool file = model->kind == PALP_MODEL_NETWORK && mesh->kind == PALP_MESH_FILE;
    strcpy(path, file ? mesh->path : "");
    if (!file || mesh->path[0] == '/')
        return PALP_OK;
    palp_status status = palp_model_folder(target, folder);
    if (status || strcmp(folder, mesh->folder) == 0)
        return status;
    return move_mesh_path_to_target(mesh, target, path);
}

palp_status palp_model_write(const palp_model *model, const char *path, palp_error *error) {
    if (!model || !path)
        return palp_error_null(error);
    palp_file file;
    palp_error wrong = {PALP_OK, ""};
    char mesh[PALP_PATH_MAX];
    palp_status status = check_model_before_write(model, &wrong);
    if (status)
        return palp_error_set(error, status, "%s: not written: %s", path, wrong.text);
    status = mesh_path_seen_from_target(model, path, mesh);
    if (status)
        return palp_error_set(error, status,
                              "%s: not written: its folder or that of the mesh \"%s\" does not exist", path,
                              model->mesh->path);
    if (!palp_text_is_utf8(mesh))
        return palp_error_set(error, PALP_ERR_ARGUMENT, "%s: not written: the mesh's path is not UTF-8",
                              path);
    status = palp_file_begin(&file, path, error);
    if (status)
        return status;
    writer w = lines;
    w.stream = file.stream;
    status = print_complete_model(&w, model, mesh);
    if (!status)
        return palp_file_commit(&file, true, error);
    palp_file_abandon(&file);
    return palp_error_set(error, status, "%s: not written: %s", path, palp_status_text(status));
}

palp_status palp_model_format(const palp_model *model, char **json) {
    if (!model || !json)
        return PALP_ERR_ARGUMENT;
    char *text = NULL;
    size_t size = 0;
    *json = NULL;
    palp_status status = check_model_before_write(model, NULL);
    if (status)
        return status;
    writer w = one_line;
    w.stream = open_memstream(&text, &size);
    if (!w.stream)
        return PALP_ERR_NO_MEMORY;
    status = print_complete_model(&w, model, model->mesh ? model->mesh->path : "");
    bool failed = ferror(w.stream) != 0;
    failed = fclose(w.stream) != 0 || failed;
    if (!status && (failed || !text))
        status = PALP_ERR_NO_MEMORY;
    if (status)
        free(text);
    else
        *json = text;
    return status;
}
