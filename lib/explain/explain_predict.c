/* explain_predict.c: the one function by which explain gets a model's forces. */
#include "explain_data.h"
#include "response/forward_internal.h"

bool explain_carries(const palp_model *model, const palp_effect_info *info) {
    return model->kind == PALP_MODEL_NETWORK ? info->in_network : info->in_lumped;
}

palp_status explain_resize(palp_model *model, const explain_run *run) {
    palp_material *m = &model->material;
    model->height_m = run->height;
    for (size_t j = 0; j < m->n_arms; j++) {
        m->arms[j].stiffness_N *= run->area;
        m->arms[j].viscosity_Ns *= run->area;
    }
    return palp_law_scale(&m->law, run->area, &m->law);
}

palp_status explain_height(const palp_model *model, double *height, palp_error *error) {
    double low[3], high[3];
    palp_mesh *mesh;
    *height = model->height_m;
    if (model->kind != PALP_MODEL_NETWORK)
        return PALP_OK;
    palp_status status = palp_model_mesh(model, &mesh, error);
    if (status)
        return status;
    palp_mesh_bounds(mesh, low, high);
    *height = high[1] - low[1];
    palp_mesh_free(mesh);
    return PALP_OK;
}

/* Any failure of a network to find an equilibrium means that these parameters have none. */
static palp_status predict_network(const palp_model *model, const palp_forward_run *run, double *force,
                                   double *gradient, palp_error *error) {
    palp_status status = forward_network_force(model, run, force, gradient, error);
    bool lost = status == PALP_ERR_BUCKLED || status == PALP_ERR_SINGULAR || status == PALP_ERR_COLLAPSED;
    if (lost && error)
        error->status = PALP_ERR_NOT_CONVERGED;
    return lost ? PALP_ERR_NOT_CONVERGED : status;
}

palp_status explain_predict(const palp_model *model, const palp_forward_run *run, double *force,
                            double *gradient, palp_error *error) {
    if (model->kind == PALP_MODEL_NETWORK)
        return predict_network(model, run, force, gradient, error);
    return palp_forward_force(model, run, force, gradient, error);
}
