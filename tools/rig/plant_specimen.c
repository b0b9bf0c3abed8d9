/* plant_specimen.c: the specimen of the plant: its model in series with the frame's compliance. */
#include "plant_specimen.h"
#include "plant_internal.h"

#include <math.h>
#include <string.h>

static const double BLOCK_M = 0.1; /* height of a rigid block */

/* The phantom of the thesis with two arms: data/sedef2008/lumped_n2.json. */
static palp_model seed_phantom(void) {
    palp_model model = {.kind = PALP_MODEL_LUMPED, .height_m = 0.024, .radius_m = 0.012};
    static const double coefficients_N[] = {8.18, -0.70, 47.47, -131.36, 146.89};
    palp_law_polynomial(5, coefficients_N, &model.material.law);
    model.material.n_arms = 2;
    model.material.arms[0] = (palp_arm){.stiffness_N = 2.5847711, .viscosity_Ns = 3.6146};
    model.material.arms[1] = (palp_arm){.stiffness_N = 0.6853036, .viscosity_Ns = 23.964533};
    return model;
}

static palp_model rigid_block(double stiffness_N_m) {
    palp_model model = {.kind = PALP_MODEL_LUMPED, .height_m = BLOCK_M};
    double coefficient_N = stiffness_N_m * BLOCK_M;
    palp_law_polynomial(1, &coefficient_N, &model.material.law);
    return model;
}

/* The compliances of the actuator's frame and of the model's are in series. */
static palp_status add_compliance(palp_model *model, double compliance_m_N, specimen *s, palp_error *error) {
    size_t i = 0;
    while (i < model->n_effects && model->effects[i].id != PALP_EFFECT_FRAME_COMPLIANCE)
        i++;
    if (i == PALP_EFFECTS_MAX && compliance_m_N > 0)
        return plant_fail(error, PALP_ERR_LIMIT, "%s: no room for the frame's compliance beside %d effects",
                          s->path, PALP_EFFECTS_MAX);
    if (i == model->n_effects && compliance_m_N > 0)
        model->effects[model->n_effects++] = (palp_effect){.id = PALP_EFFECT_FRAME_COMPLIANCE};
    if (i < model->n_effects)
        s->compliance_m_N = model->effects[i].value[0] += compliance_m_N;
    return PALP_OK;
}

/* The amplifier clips instead, after the noise. */
static void move_saturation(palp_model *model, specimen *s) {
    for (size_t i = 0; i < model->n_effects; i++) {
        if (model->effects[i].id == PALP_EFFECT_FORCE_SATURATION) {
            s->range_N = model->effects[i].value[0];
            model->effects[i].value[0] = 0;
        }
    }
}

palp_status specimen_create(const plant_settings *settings, specimen *s, palp_error *error) {
    const bool rigid = settings->specimen == PLANT_RIGID, own = !rigid && !settings->model;
    palp_specimen_settings to = palp_specimen_settings_default();
    palp_error why = {PALP_OK, ""};
    palp_mesh_source mesh;
    palp_status status = PALP_OK;
    memset(s, 0, sizeof *s);
    s->path = rigid ? "the rigid block" : own ? "the phantom of the thesis" : settings->model;
    if (settings->specimen == PLANT_AIR)
        return PALP_OK;
    palp_model model = rigid ? rigid_block(settings->rigid_N_m) : seed_phantom();
    if (!rigid && !own)
        status = palp_model_read(settings->model, &model, &mesh, error);
    if (status == PALP_OK)
        status = add_compliance(&model, settings->actuator.compliance_m_N, s, error);
    if (status)
        return status;
    move_saturation(&model, s);
    to.start_m =
        fmin(settings->actuator.start_m - settings->contact_m, 0); /* pressed from the first step on */
    to.scale = rigid ? 1 : settings->scale;
    to.table_N_m = rigid ? 0 : settings->rigid_N_m;
    s->slow = model.kind == PALP_MODEL_NETWORK;
    status = palp_specimen_create(&model, &to, &s->pressed, &why);
    return status ? plant_fail(error, status, "%s: %s", s->path, why.text) : PALP_OK;
}

void specimen_free(specimen *s) {
    palp_specimen_free(s->pressed);
}

palp_status specimen_advance(specimen *s, double reach_m, double dt_s) {
    return s->pressed ? palp_specimen_step(s->pressed, reach_m, dt_s, &s->force_N) : PALP_OK;
}

double specimen_sense(const specimen *s, const palp_specimen_motion *motion) {
    return s->pressed ? palp_specimen_sense(s->pressed, motion) : 0;
}
