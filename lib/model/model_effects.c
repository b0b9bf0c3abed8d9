/* model_effects.c: effects of a model: checks of the list, and reading of "effects": [{"id": , "parameters":
 * {...}}]. */
#include "base/file.h"
#include "model_internal.h"

#include <string.h>

static palp_status read_effect_id(const palp_json *at, const palp_model *model, palp_effect *effect) {
    palp_json id;
    const char *name = "";
    palp_status status = palp_json_require(at, "id", &id);
    if (!status)
        status = palp_json_string(&id, &name);
    if (status)
        return status;
    if (palp_effect_parse(name, &effect->id))
        return palp_json_fail(&id, PALP_ERR_UNSUPPORTED, "\"%s\" is not an effect of this version", name);
    const palp_effect_info *info = palp_effect_look_up(effect->id);
    bool network = model->kind == PALP_MODEL_NETWORK;
    if (!(network ? info->in_network : info->in_lumped))
        return palp_json_fail(&id, PALP_ERR_UNSUPPORTED, "\"%s\" is not an effect of a %s", name,
                              network ? "network" : "lumped model");
    for (size_t i = 0; i < model->n_effects && !info->repeats; i++)
        if (model->effects[i].id == effect->id)
            return palp_json_fail(&id, PALP_ERR_INPUT, "\"%s\" is given twice", name);
    return PALP_OK;
}

static palp_status read_effect_parameter(const palp_json *at, const palp_effect_parameter *p, double *value) {
    palp_json number;
    double read = 0;
    *value = 0.0;
    if (p->optional && !palp_json_member(at, p->key, &number))
        return PALP_OK;
    palp_status status = palp_json_require(at, p->key, &number);
    if (!status)
        status = palp_json_number(&number, &read);
    *value = read * p->unit;
    if (!status && !(*value >= p->low && *value <= p->high))
        status = palp_json_fail(&number, PALP_ERR_INPUT, "must be between %.6g and %.6g, not %g",
                                p->low / p->unit, p->high / p->unit, read);
    return status;
}

static palp_status read_effect_parameters(const palp_json *at, const palp_model *model, palp_effect *effect) {
    static const char *const keys[] = {"id", "parameters"};
    const char *known[PALP_EFFECT_PARAMETERS];
    palp_json parameters;
    palp_status status = palp_json_keys(at, 2, keys);
    if (!status)
        status = read_effect_id(at, model, effect);
    if (!status)
        status = palp_json_require(at, "parameters", &parameters);
    if (status)
        return status;
    const palp_effect_info *info = palp_effect_look_up(effect->id);
    for (size_t k = 0; k < info->n_parameters; k++)
        known[k] = info->parameter[k].key;
    status = palp_json_keys(&parameters, info->n_parameters, known);
    for (size_t k = 0; k < info->n_parameters && !status; k++)
        status = read_effect_parameter(&parameters, &info->parameter[k], &effect->value[k]);
    return status;
}

palp_status palp_model_effects_read(const palp_json *root, palp_model *model) {
    palp_json effects, item;
    size_t n = 0;
    if (!palp_json_member(root, "effects", &effects))
        return PALP_OK;
    palp_status status = palp_json_list(&effects, PALP_EFFECTS_MAX, &n);
    if (!status && n > 0 && model->material.formulation != PALP_HISTORY)
        status = palp_json_fail(&effects, PALP_ERR_UNSUPPORTED,
                                "are not supported by formulation sedef2008; use history");
    for (size_t i = 0; i < n && !status; i++) {
        palp_effect effect;
        memset(&effect, 0, sizeof effect);
        status = palp_json_item(&effects, i, &item);
        if (!status)
            status = read_effect_parameters(&item, model, &effect);
        if (!status)
            model->effects[model->n_effects++] = effect;
    }
    return status;
}

static palp_status check_one_effect(const palp_model *model, size_t i, palp_error *error) {
    const palp_effect *effect = &model->effects[i];
    palp_status status = palp_effect_check(effect, error);
    if (status)
        return status;
    const palp_effect_info *info = palp_effect_look_up(effect->id);
    bool network = model->kind == PALP_MODEL_NETWORK;
    if (!(network ? info->in_network : info->in_lumped))
        return palp_error_set(error, PALP_ERR_UNSUPPORTED, "%s is not an effect of a %s", info->id,
                              network ? "network" : "lumped model");
    for (size_t j = 0; j < i && !info->repeats; j++)
        if (model->effects[j].id == effect->id)
            return palp_error_set(error, PALP_ERR_ARGUMENT, "%s is given twice", info->id);
    return PALP_OK;
}

palp_status palp_model_effects_check(const palp_model *model, palp_error *error) {
    palp_status status = PALP_OK;
    if (model->n_effects > PALP_EFFECTS_MAX)
        return palp_error_set(error, PALP_ERR_LIMIT, "%zu effects, at most %d", model->n_effects,
                              PALP_EFFECTS_MAX);
    if (model->n_effects > 0 && model->material.formulation != PALP_HISTORY)
        return palp_error_set(error, PALP_ERR_UNSUPPORTED,
                              "formulation sedef2008 does not support effects; use history");
    for (size_t i = 0; i < model->n_effects && !status; i++)
        status = check_one_effect(model, i, error);
    return status;
}
