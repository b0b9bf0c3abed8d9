/* model_free_terms.c: "free_term" of a model: [{"depends_on": , "class": , "from": , "to": , "depth_mm": ,
 * "slow_mm_s": , "force_N": [], "sd_N": []}]. */
#include "base/file.h"
#include "model_internal.h"

#include <string.h>

double palp_model_free_unit(palp_free_kind kind) {
    return kind == PALP_FREE_TURN || kind == PALP_FREE_PLACE || kind == PALP_FREE_GAIN ? 1e-3 : 1.0;
}

/* The index of a name among n. */
static palp_status read_name(const palp_json *at, const char *key, size_t n, const char *name_of(size_t),
                             size_t *index) {
    palp_json value;
    const char *name = "";
    palp_status status = palp_json_require(at, key, &value);
    if (!status)
        status = palp_json_string(&value, &name);
    for (*index = 0; !status && *index < n; (*index)++)
        if (strcmp(name_of(*index), name) == 0)
            return PALP_OK;
    return status ? status
                  : palp_json_fail(&value, PALP_ERR_UNSUPPORTED, "\"%s\" is not known to this version", name);
}

static const char *kind_of(size_t i) {
    return palp_free_kind_name((palp_free_kind)i);
}

static const char *class_of(size_t i) {
    return palp_free_class_name((palp_free_class)i);
}

static palp_status read_number(const palp_json *at, const char *key, double unit, double *value) {
    palp_json number;
    double read = 0.0;
    palp_status status = palp_json_require(at, key, &number);
    if (!status)
        status = palp_json_number(&number, &read);
    *value = read * unit;
    return status;
}

static palp_status read_length(const palp_json *at, const char *key, double *value) {
    double read = 0.0;
    palp_status status = read_number(at, key, 1.0, &read);
    *value = read / 1000; /* as it is written */
    return status;
}

static palp_status read_table(const palp_json *at, const char *key, double *value) {
    palp_json list;
    size_t n = 0;
    palp_status status = palp_json_require(at, key, &list);
    if (!status)
        status = palp_json_numbers(&list, PALP_FREE_NODES, &n, value);
    if (!status && n != PALP_FREE_NODES)
        status = palp_json_fail(&list, PALP_ERR_INPUT, "must be %d numbers, not %zu", PALP_FREE_NODES, n);
    return status;
}

static palp_status read_one(const palp_json *at, palp_free_term *term) {
    static const char *const keys[] = {
        "depends_on", "class",   "from", "to",     "depth_mm",
        "slow_mm_s",  "force_N", "sd_N", "plate_N"}; /* the last of a factor on the force alone */
    const size_t n = sizeof keys / sizeof *keys;
    size_t kind = 0, does = 0;
    memset(term, 0, sizeof *term);
    palp_status status = read_name(at, "depends_on", PALP_FREE_KINDS, kind_of, &kind);
    if (!status)
        status = palp_json_keys(at, palp_model_free_of_force((palp_free_kind)kind) ? n : n - 1, keys);
    if (!status)
        status = read_name(at, "class", PALP_FREE_CLASSES, class_of, &does);
    if (status)
        return status;
    term->kind = (palp_free_kind)kind;
    term->does = (palp_free_class)does;
    const double unit = palp_model_free_unit(term->kind);
    status = read_number(at, "from", unit, &term->from);
    if (!status)
        status = read_number(at, "to", unit, &term->to);
    if (!status)
        status = read_length(at, "depth_mm", &term->depth_m);
    if (!status)
        status = read_length(at, "slow_mm_s", &term->slow_m_s);
    if (!status && palp_model_free_of_force(term->kind))
        status = read_number(at, "plate_N", 1.0, &term->plate_N);
    if (!status)
        status = read_table(at, "force_N", term->force_N);
    if (!status)
        status = read_table(at, "sd_N", term->sd_N);
    if (!status && palp_free_term_check(term))
        status = palp_json_fail(at, PALP_ERR_INPUT,
                                "must have from below to, and depth_mm, slow_mm_s, plate_N and sd_N above 0");
    return status;
}

palp_status palp_model_free_terms_read(const palp_json *root, palp_model *model) {
    palp_json list, item;
    size_t n = 0;
    if (!palp_json_member(root, "free_term", &list))
        return PALP_OK;
    palp_status status = palp_json_list(&list, PALP_FREE_TERMS, &n);
    if (!status && n > 0 && model->material.formulation != PALP_HISTORY)
        status = palp_json_fail(&list, PALP_ERR_UNSUPPORTED,
                                "is not supported by formulation sedef2008; use history");
    for (size_t i = 0; i < n && !status; i++) {
        status = palp_json_item(&list, i, &item);
        if (!status)
            status = read_one(&item, &model->free_term[model->n_free]);
        if (!status)
            model->n_free++;
    }
    return status;
}

palp_status palp_model_free_terms_check(const palp_model *model, palp_error *error) {
    if (model->n_free > PALP_FREE_TERMS)
        return palp_error_set(error, PALP_ERR_LIMIT, "%zu free terms, at most %d", model->n_free,
                              PALP_FREE_TERMS);
    for (size_t i = 0; i < model->n_free; i++)
        if (palp_free_term_check(&model->free_term[i]))
            return palp_error_set(error, PALP_ERR_ARGUMENT, "free term %zu is out of range", i + 1);
    return PALP_OK;
}
