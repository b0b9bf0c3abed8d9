/* forward_plan.c: sorts a model's effects into what the forward model has to do. */
#include "base/file.h"
#include "forward_internal.h"

#include <math.h>
#include <string.h>

size_t forward_arm_column(const palp_model *model, size_t arm) {
    return model->material.law.n + 2 * arm;
}

size_t forward_effect_column(const palp_model *model, size_t effect) {
    size_t column = forward_arm_column(model, model->material.n_arms);
    for (size_t i = 0; i < effect; i++)
        column += effect_row_of(model->effects[i].id)->info.n_parameters;
    return column;
}

static palp_status add_arm(forward_plan *plan, const double *value, size_t column, palp_error *error) {
    palp_material *m = &plan->material;
    if (m->n_arms == PALP_ARMS_MAX)
        return palp_error_set(error, PALP_ERR_LIMIT, "relaxation_arm: the model has %d arms already",
                              PALP_ARMS_MAX);
    double stiffness = fmax(value[0], FORWARD_NO_STIFFNESS);
    plan->arm_column[m->n_arms] = column;
    plan->arm_timed[m->n_arms] = true;
    m->arms[m->n_arms++] = (palp_arm){.stiffness_N = stiffness, .viscosity_Ns = stiffness * value[1]};
    return PALP_OK;
}

static void add_stage(forward_stage *list, size_t *n, forward_stage stage) {
    size_t i = (*n)++;
    for (; i > 0 && list[i - 1].row->stage > stage.row->stage; i--)
        list[i] = list[i - 1];
    list[i] = stage;
}

static palp_status add_effect(forward_plan *plan, size_t i, palp_error *error) {
    const palp_effect *effect = &plan->model->effects[i];
    const effect_row *row = effect_row_of(effect->id);
    size_t column = forward_effect_column(plan->model, i);
    plan->value[effect->id] = effect->value;
    plan->column[effect->id] = column;
    if (effect->id == PALP_EFFECT_RELAXATION_ARM)
        return add_arm(plan, effect->value, column, error);
    if (row->map)
        add_stage(plan->map, &plan->n_maps, (forward_stage){row, effect->value, column});
    if (row->sensor)
        add_stage(plan->sensor, &plan->n_sensors, (forward_stage){row, effect->value, column});
    return PALP_OK;
}

double forward_boost(const forward_plan *plan, double rate, double *decades) {
    const double *stiffening = plan->value[PALP_EFFECT_RATE_STIFFENING];
    *decades = stiffening ? log10(1.0 + fabs(rate) / EFFECT_RATE) : 0.0;
    return stiffening ? 1.0 + stiffening[0] * *decades : 1.0;
}

double forward_shortest_arm(const forward_plan *plan) {
    double shortest = INFINITY;
    for (size_t j = 0; j < plan->material.n_arms; j++) {
        const palp_arm *arm = &plan->material.arms[j];
        if (arm->stiffness_N > FORWARD_NO_STIFFNESS)
            shortest = fmin(shortest, arm->viscosity_Ns / arm->stiffness_N);
    }
    return shortest;
}

static void find_wear(forward_plan *plan) {
    const double *softening = plan->value[PALP_EFFECT_DAMAGE_SOFTENING],
                 *set = plan->value[PALP_EFFECT_PERMANENT_SET];
    plan->worn = softening || set;
    plan->wear.sharpness = 1.0;
    if (set)
        plan->wear.set = set[0];
    if (softening) {
        plan->wear.softening = softening[0];
        plan->wear.sharpness = softening[1];
    }
}

palp_status forward_plan_age(forward_plan *plan, double session_s) {
    const double *ageing = plan->value[PALP_EFFECT_SESSION_AGEING];
    plan->session_s = session_s;
    plan->age = ageing ? 1.0 + ageing[0] * session_s : 1.0;
    return plan->age > 0.0 && isfinite(plan->age) ? PALP_OK : PALP_ERR_ARGUMENT;
}

static palp_status check_lumped(const palp_model *model, palp_error *error) {
    if (model->material.formulation != PALP_HISTORY)
        return palp_error_set(error, PALP_ERR_UNSUPPORTED,
                              "formulation sedef2008 takes no effects; use history");
    if (!(model->height_m > 0.0))
        return palp_error_set(error, PALP_ERR_ARGUMENT, "the specimen has no height");
    return PALP_OK;
}

palp_status forward_plan_make(const palp_model *model, double session_s, forward_plan *plan,
                              palp_error *error) {
    palp_status status = model->kind == PALP_MODEL_LUMPED ? check_lumped(model, error) : PALP_OK;
    if (!status)
        status = effect_list_check(model, error);
    memset(plan, 0, sizeof *plan);
    plan->model = model;
    plan->material = model->material;
    for (size_t j = 0; j < model->material.n_arms && j < PALP_ARMS_MAX; j++)
        plan->arm_column[j] = forward_arm_column(model, j);
    for (size_t i = 0; i < model->n_effects && !status; i++)
        status = add_effect(plan, i, error);
    if (status)
        return status;
    plan->n_columns = forward_effect_column(model, model->n_effects);
    find_wear(plan);
    const double *dependent = plan->value[PALP_EFFECT_STRAIN_DEPENDENT_ARM];
    for (size_t j = 0; dependent && j < plan->material.n_arms; j++) {
        plan->material.arms[j].beta += dependent[0];
        plan->material.arms[j].gamma += dependent[1];
    }
    if (plan->value[PALP_EFFECT_ADHESION])
        plan->adhesion = plan->value[PALP_EFFECT_ADHESION][0];
    if (forward_plan_age(plan, session_s))
        return palp_error_set(error, PALP_ERR_ARGUMENT,
                              "session_ageing: nothing is left of the specimen's force");
    return palp_material_check(&plan->material, error);
}
