/* forward_plan.c: sorts a model's effects by what they change in the forward model. */
#include "base/file.h"
#include "forward_internal.h"
#include "model/model_internal.h"

#include <math.h>
#include <string.h>

/* First column of an arm's parameters. */
static size_t forward_arm_column(const palp_model *model, size_t arm) {
    return model->material.law.n + 2 * arm;
}

size_t forward_effect_column(const palp_model *model, size_t effect) {
    size_t column = forward_arm_column(model, model->material.n_arms);
    for (size_t i = 0; i < effect; i++)
        column += effect_row_of(model->effects[i].id)->info.n_parameters;
    return column;
}

static palp_status add_effect_arm(forward_plan *plan, const double *value, size_t column, palp_error *error) {
    palp_material *m = &plan->material;
    if (m->n_arms == PALP_ARMS_MAX)
        return palp_error_set(error, PALP_ERR_LIMIT, "relaxation_arm: the model already has %d arms",
                              PALP_ARMS_MAX);
    double stiffness = fmax(value[0], FORWARD_NO_STIFFNESS);
    plan->arm_column[m->n_arms] = column;
    plan->arm_timed[m->n_arms] = true;
    m->arms[m->n_arms++] = (palp_arm){.stiffness_N = stiffness, .viscosity_Ns = stiffness * value[1]};
    return PALP_OK;
}

/* Inserts the effect in the order of stages. */
static palp_status insert_effect_by_stage(forward_plan *plan, size_t i, palp_error *error) {
    const palp_effect *effect = &plan->model->effects[i];
    const effect_row *row = effect_row_of(effect->id);
    const size_t column = forward_effect_column(plan->model, i);
    size_t at = plan->n_effects++;
    for (; at > 0 && plan->effect[at - 1].row->stage > row->stage; at--)
        plan->effect[at] = plan->effect[at - 1];
    plan->effect[at] = (forward_effect){.row = row, .effect = effect, .column = column};
    plan->n_spectra += row->spectrum != NULL;
    if (plan->n_spectra > FORWARD_SPECTRA)
        return palp_error_set(error, PALP_ERR_LIMIT, "%s: the model already has %d such effects",
                              row->info.id, FORWARD_SPECTRA);
    return row->arm ? add_effect_arm(plan, effect->value, column, error) : PALP_OK;
}

double forward_rate_factor(const forward_plan *plan, double rate, effect_number *of_effect) {
    double rate_factor = 1.0;
    for (size_t i = 0; i < plan->n_effects; i++) {
        const forward_effect *f = &plan->effect[i];
        if (!f->row->spring)
            continue;
        f->row->spring(f->effect->value, rate, &of_effect[i]);
        rate_factor *= of_effect[i].value;
    }
    return rate_factor;
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

size_t forward_arm_slopes(const forward_plan *plan, size_t j, forward_arm_slope *slope) {
    const palp_arm *arm = &plan->material.arms[j];
    const size_t column = plan->arm_column[j];
    const double by_stiffness = 1.0 / arm->stiffness_N, by_viscosity = 1.0 / arm->viscosity_Ns;
    const double by_time = arm->stiffness_N / arm->viscosity_Ns;
    slope[0] = (forward_arm_slope){column, {.log_stiffness = by_stiffness, .log_time = -by_stiffness}};
    slope[1] = (forward_arm_slope){column + 1, {.log_time = by_viscosity}};
    if (plan->arm_timed[j]) {
        slope[0].by.log_time = 0.0;
        slope[1].by.log_time = by_time;
    }
    size_t n = 2;
    for (size_t i = 0; i < plan->n_effects; i++) {
        const forward_effect *f = &plan->effect[i];
        effect_arm by[PALP_EFFECT_PARAMETERS] = {{.beta = 0.0}};
        palp_arm changed = *arm;
        if (!f->row->arms)
            continue;
        f->row->arms(f->effect->value, &changed, by);
        for (size_t k = 0; k < f->row->info.n_parameters; k++)
            slope[n++] = (forward_arm_slope){f->column + k, by[k]};
    }
    return n;
}

/* Applies the effects on the material. */
static void apply_effects_to_material(forward_plan *plan) {
    plan->damage.sharpness = 1.0;
    for (size_t i = 0; i < plan->n_effects; i++) {
        const forward_effect *f = &plan->effect[i];
        const double *value = f->effect->value;
        effect_arm arm_by[PALP_EFFECT_PARAMETERS] = {{.beta = 0.0}};
        element_damage damage_by[PALP_EFFECT_PARAMETERS] = {{.set = 0.0}};
        for (size_t j = 0; f->row->arms && j < plan->material.n_arms; j++)
            f->row->arms(value, &plan->material.arms[j], arm_by);
        if (!f->row->history)
            continue;
        f->row->history(value, &plan->damage, damage_by);
        plan->damaged = true;
        for (size_t k = 0; k < f->row->info.n_parameters; k++) {
            plan->sets = plan->sets || damage_by[k].set != 0.0;
            plan->damage_slope[plan->n_damage_slopes++] = (forward_damage_slope){f->column + k, damage_by[k]};
        }
    }
}

static void find_contact_effects(forward_plan *plan) {
    for (size_t i = 0; i < plan->n_effects; i++) {
        forward_effect *f = &plan->effect[i];
        plan->gives_way = plan->gives_way || (f->row->gives_way && !effect_is_off(f->effect));
        if (!f->row->bond)
            continue;
        effect_bond bond = {.reach = 0.0};
        f->row->bond(f->effect->value, 0.0, &bond);
        plan->adhesion = bond.strongest;
        plan->reaches = bond.strongest > 0.0 && bond.reach > 0.0;
    }
}

palp_status forward_plan_age(forward_plan *plan, double session_s) {
    plan->age = 1.0;
    for (size_t i = 0; i < plan->n_effects; i++) {
        forward_effect *f = &plan->effect[i];
        if (!f->row->specimen)
            continue;
        f->row->specimen(f->effect->value, session_s, &f->age);
        plan->age *= f->age.value;
    }
    return plan->age > 0.0 && isfinite(plan->age) ? PALP_OK : PALP_ERR_ARGUMENT;
}

static palp_status check_lumped_model(const palp_model *model, palp_error *error) {
    if (model->material.formulation != PALP_HISTORY)
        return palp_error_set(error, PALP_ERR_UNSUPPORTED,
                              "formulation sedef2008 does not support effects; use history");
    if (!(model->height_m > 0.0))
        return palp_error_set(error, PALP_ERR_ARGUMENT, "the specimen has no height");
    return PALP_OK;
}

palp_status forward_plan_make(const palp_model *model, double session_s, forward_plan *plan,
                              palp_error *error) {
    palp_status status = model->kind == PALP_MODEL_LUMPED ? check_lumped_model(model, error) : PALP_OK;
    if (!status)
        status = palp_model_effects_check(model, error);
    memset(plan, 0, sizeof *plan);
    plan->model = model;
    plan->material = model->material;
    for (size_t j = 0; j < model->material.n_arms && j < PALP_ARMS_MAX; j++)
        plan->arm_column[j] = forward_arm_column(model, j);
    for (size_t i = 0; i < model->n_effects && !status; i++)
        status = insert_effect_by_stage(plan, i, error);
    if (status)
        return status;
    plan->n_columns = forward_effect_column(model, model->n_effects);
    apply_effects_to_material(plan);
    find_contact_effects(plan);
    if (forward_plan_age(plan, session_s))
        return palp_error_set(error, PALP_ERR_ARGUMENT,
                              "session_ageing leaves no force of the specimen at %.6g s of the session",
                              session_s);
    return palp_material_check(&plan->material, error);
}
