/* model_regions.c: "regions" of a model file, and whether they may be written. */
#include "model_internal.h"

#include <math.h>
#include <string.h>

#define COUNT(list) (sizeof(list) / sizeof(list)[0])

/* Its square must be a number too. */
static bool has_direction(const double v[3]) {
    const double square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    return square > 0.0 && isfinite(square);
}

static palp_status read_place(const palp_json *at, const char *key, double place_m[3]) {
    palp_json list;
    double place_mm[3];
    size_t n = 0;
    palp_status status = palp_json_require(at, key, &list);
    if (!status)
        status = palp_json_numbers(&list, 3, &n, place_mm);
    if (!status && n != 3)
        status = palp_json_fail(&list, PALP_ERR_INPUT, "must be three coordinates");
    for (size_t k = 0; k < 3 && !status; k++)
        place_m[k] = place_mm[k] / 1000;
    return status;
}

static palp_status read_box(const palp_json *at, palp_region *region) {
    static const char *const keys[] = {"low_mm", "high_mm"};
    palp_status status = palp_json_keys(at, COUNT(keys), keys);
    region->shape = PALP_REGION_BOX;
    if (!status)
        status = read_place(at, "low_mm", region->low_m);
    if (!status)
        status = read_place(at, "high_mm", region->high_m);
    for (size_t k = 0; k < 3 && !status; k++)
        if (!(region->high_m[k] > region->low_m[k]))
            status = palp_json_fail(at, PALP_ERR_INPUT, "must have every coordinate of high_mm above low_mm");
    return status;
}

static palp_status read_sphere(const palp_json *at, palp_region *region) {
    static const char *const keys[] = {"centre_mm", "radius_mm"};
    palp_json radius;
    palp_status status = palp_json_keys(at, COUNT(keys), keys);
    region->shape = PALP_REGION_SPHERE;
    if (!status)
        status = read_place(at, "centre_mm", region->centre_m);
    if (!status)
        status = palp_json_require(at, "radius_mm", &radius);
    if (!status)
        status = palp_json_positive(&radius, &region->radius_m);
    region->radius_m /= 1000;
    return status;
}

static palp_status read_membrane(const palp_json *at, palp_region *region) {
    static const char *const keys[] = {"set"};
    palp_json set;
    const char *name = "";
    palp_status status = palp_json_keys(at, COUNT(keys), keys);
    region->shape = PALP_REGION_MEMBRANE;
    if (!status && palp_json_member(at, "set", &set))
        status = palp_json_string(&set, &name);
    if (!status && strlen(name) >= PALP_REGION_NAME_MAX)
        status = palp_json_fail(&set, PALP_ERR_INPUT, "must be shorter than %d bytes", PALP_REGION_NAME_MAX);
    if (!status)
        strcpy(region->set, name);
    return status;
}

static palp_status read_shape(const palp_json *at, palp_region *region) {
    static const struct {
        const char *key;
        palp_status (*read)(const palp_json *at, palp_region *region);
    } shapes[] = {{"box", read_box}, {"sphere", read_sphere}, {"membrane", read_membrane}};
    palp_json shape;
    palp_status status = PALP_OK;
    bool any = false;
    region->shape = PALP_REGION_OF_MESH;
    for (size_t i = 0; i < COUNT(shapes) && !status; i++) {
        if (!palp_json_member(at, shapes[i].key, &shape))
            continue;
        status = any ? palp_json_fail(&shape, PALP_ERR_INPUT, "does not go with another shape")
                     : shapes[i].read(&shape, region);
        any = true;
    }
    return status;
}

static palp_status read_region_material(const palp_json *at, const palp_model *model, palp_region *region) {
    static const char *const keys[] = {"stiffness", "arms", "dashpot_Ns", "quasi_linear"};
    palp_model own = {.radius_m = model->radius_m};
    palp_error wrong = {PALP_OK, ""};
    palp_status status = palp_json_keys(at, COUNT(keys), keys);
    if (!status)
        status = palp_model_material_read(at, &own);
    if (!status && palp_material_check(&own.material, &wrong))
        status = palp_json_fail(at, PALP_ERR_INPUT, "cannot be used: %s", wrong.text);
    if (!status && model->material.formulation != PALP_HISTORY)
        status = palp_json_fail(at, PALP_ERR_UNSUPPORTED, "needs the formulation \"history\"");
    region->own_material = own.material;
    return status;
}

static palp_status read_fibre(const palp_json *at, palp_region *region) {
    static const char *const keys[] = {"direction", "stiffness_Pa"};
    palp_json list, modulus;
    size_t n = 0;
    palp_status status = palp_json_keys(at, COUNT(keys), keys);
    if (!status)
        status = palp_json_require(at, "direction", &list);
    if (!status)
        status = palp_json_numbers(&list, 3, &n, region->fibre);
    if (!status && (n != 3 || !has_direction(region->fibre)))
        status = palp_json_fail(&list, PALP_ERR_INPUT, "must be three numbers that are not all 0");
    if (!status)
        status = palp_json_require(at, "stiffness_Pa", &modulus);
    if (!status)
        status = palp_json_positive(&modulus, &region->fibre_Pa);
    if (!status && region->shape == PALP_REGION_MEMBRANE)
        status = palp_json_fail(at, PALP_ERR_INPUT, "does not go with a membrane");
    return status;
}

static palp_status read_region_stiffness(const palp_json *at, const palp_model *model, palp_region *region) {
    palp_json factor, material, ratio, fibre;
    const bool has_factor = palp_json_member(at, "stiffness_factor", &factor),
               has_material = palp_json_member(at, "material", &material);
    palp_status status = PALP_OK;
    if (has_factor == has_material)
        return palp_json_fail(at, PALP_ERR_INPUT, "needs either stiffness_factor or material");
    if (region->shape == PALP_REGION_MEMBRANE &&
        (has_factor || palp_json_member(at, "poisson_ratio", &ratio)))
        return palp_json_fail(at, PALP_ERR_INPUT,
                              "is a membrane: it needs a material, and has no Poisson's ratio");
    status = has_factor ? palp_json_positive(&factor, &region->stiffness)
                        : read_region_material(&material, model, region);
    if (!status && palp_json_member(at, "poisson_ratio", &ratio))
        status = palp_model_ratio_read(&ratio, model->volume_modulus_Pa, &region->poisson_ratio);
    if (!status && palp_json_member(at, "fibre", &fibre))
        status = read_fibre(&fibre, region);
    return status;
}

static palp_status read_region(const palp_json *at, const palp_model *model, palp_region *region) {
    static const char *const keys[] = {"name",     "box",           "sphere", "membrane", "stiffness_factor",
                                       "material", "poisson_ratio", "fibre"};
    palp_json name;
    const char *text = "";
    memset(region, 0, sizeof *region);
    palp_status status = palp_json_keys(at, COUNT(keys), keys);
    if (!status)
        status = palp_json_require(at, "name", &name);
    if (!status)
        status = palp_json_string(&name, &text);
    if (!status && (!text[0] || strlen(text) >= PALP_REGION_NAME_MAX))
        status = palp_json_fail(&name, PALP_ERR_INPUT, "must have 1 to %d bytes", PALP_REGION_NAME_MAX - 1);
    if (!status)
        strcpy(region->name, text);
    if (!status)
        status = read_shape(at, region);
    return status ? status : read_region_stiffness(at, model, region);
}

palp_status palp_model_regions_read(const palp_json *root, const palp_model *model,
                                    palp_mesh_source *source) {
    palp_json list, item;
    if (!palp_json_member(root, "regions", &list))
        return PALP_OK;
    palp_status status = palp_json_list(&list, PALP_REGIONS_MAX, &source->n_regions);
    for (size_t r = 0; r < source->n_regions && !status; r++) {
        status = palp_json_item(&list, r, &item);
        if (!status)
            status = read_region(&item, model, &source->regions[r]);
        for (size_t before = 0; before < r && !status; before++)
            if (strcmp(source->regions[before].name, source->regions[r].name) == 0)
                status = palp_json_fail(&item, PALP_ERR_INPUT, "has the name of another region");
    }
    return status;
}

static bool are_finite(size_t n, const double *value) {
    for (size_t i = 0; i < n; i++)
        if (!isfinite(value[i]))
            return false;
    return true;
}

static bool is_region_valid(const palp_model *model, const palp_region *r) {
    const bool named = memchr(r->name, '\0', PALP_REGION_NAME_MAX) && r->name[0];
    bool shape = r->shape == PALP_REGION_OF_MESH ||
                 (r->shape == PALP_REGION_MEMBRANE && memchr(r->set, '\0', PALP_REGION_NAME_MAX) &&
                  r->stiffness == 0 && r->poisson_ratio == 0);
    if (r->shape == PALP_REGION_BOX)
        shape = are_finite(3, r->low_m) && are_finite(3, r->high_m) && r->high_m[0] > r->low_m[0] &&
                r->high_m[1] > r->low_m[1] && r->high_m[2] > r->low_m[2];
    if (r->shape == PALP_REGION_SPHERE)
        shape = are_finite(3, r->centre_m) && isfinite(r->radius_m) && r->radius_m > 0;
    const bool ratio = r->poisson_ratio == 0 ||
                       (r->poisson_ratio >= 0.25 && r->poisson_ratio < 0.5 && model->volume_modulus_Pa == 0);
    const bool material = r->stiffness > 0
                              ? isfinite(r->stiffness)
                              : r->stiffness == 0 && !palp_material_check(&r->own_material, NULL) &&
                                    palp_model_lowest(&r->own_material.law) > 0 &&
                                    r->own_material.formulation == PALP_HISTORY &&
                                    model->material.formulation == PALP_HISTORY;
    const bool fibre = r->fibre_Pa == 0 || (r->fibre_Pa > 0 && isfinite(r->fibre_Pa) &&
                                            has_direction(r->fibre) && r->shape != PALP_REGION_MEMBRANE);
    return named && shape && ratio && material && fibre;
}

bool palp_model_regions_valid(const palp_model *model) {
    if (model->mesh->n_regions > PALP_REGIONS_MAX)
        return false;
    for (size_t r = 0; r < model->mesh->n_regions; r++)
        if (!is_region_valid(model, &model->mesh->regions[r]))
            return false;
    return true;
}
