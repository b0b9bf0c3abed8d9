/* network_model.c: from a model to a network that is ready to step. */
#include "base/file.h"

#include <palpate/network.h>

/* What a tester adds is no part of the tissue; what changes elements or plates cannot be left out. */
static palp_status check_effects(const palp_model *model, palp_error *error) {
    for (size_t i = 0; i < model->n_effects; i++) {
        const palp_effect_info *info = palp_effect_look_up(model->effects[i].id);
        if (!info || (info->place != PALP_EFFECT_FRAME && info->place != PALP_EFFECT_SENSOR))
            return palp_error_set(error, PALP_ERR_UNSUPPORTED, "the effect %s needs palp_forward_network",
                                  info ? info->id : "of unknown number");
    }
    return PALP_OK;
}

palp_status palp_network_from_model(const palp_model *model, const palp_mesh *mesh, size_t n_supports,
                                    const palp_support *supports, const palp_network_settings *settings,
                                    palp_network **network, palp_error *error) {
    if (!model || !network)
        return palp_error_null(error);
    palp_network_settings own = settings ? *settings : palp_network_settings_default();
    palp_support usual[2];
    palp_mesh *made = NULL;
    palp_status status = check_effects(model, error);
    if (!status && !mesh)
        status = palp_model_mesh(model, &made, error);
    if (status)
        return status;
    palp_supports_default(usual);
    own.density_kg_m3 = model->density_kg_m3;
    status = palp_network_create(mesh ? mesh : made, &model->material, supports ? n_supports : 2,
                                 supports ? supports : usual, &own, network, error);
    palp_mesh_free(made);
    return status;
}
