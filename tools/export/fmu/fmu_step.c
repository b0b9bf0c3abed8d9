/* fmu_step.c: the steps of a model in an FMU. */
#include "fmu.h"

#include <math.h>
#include <string.h>

enum { HALVINGS = 60 }; /* of the interval that contains the free surface: down to the last bit of a strain */

palp_status fmu_prepare(fmi3Instance fmu, palp_error *error) {
    const double tip_m = fmu->now.value[FMU_TIP_RADIUS];
    if (fmu->model.kind == PALP_MODEL_LUMPED || (fmu->network && fmu->network_tip_m == tip_m))
        return PALP_OK;
    palp_support supports[2];
    palp_supports_default(supports);
    const palp_contact_settings touch = palp_contact_settings_default();
    palp_network_free(fmu->network);
    fmu->network = NULL;
    palp_status status =
        palp_network_from_model(&fmu->model, NULL, tip_m > 0 ? 1 : 2, supports, NULL, &fmu->network, error);
    if (!status && tip_m > 0)
        status = palp_network_enable_tools(fmu->network, 1, 0, &touch);
    fmu->network_tip_m = tip_m;
    return status;
}

/* ---- lumped ---- */

/* The plate cannot pull: after separation the specimen recovers freely, with zero force. */
static palp_status press_specimen(const palp_material *material, double strain, double dt_s,
                                  palp_element_state *state) {
    palp_element_state next;
    double low = strain, high = fmax(strain, state->strain);
    palp_status status = palp_element_advance(material, state, strain, dt_s, &next, NULL);
    bool free = !status && next.force_N < 0;
    for (int i = 0; free && !status && i < HALVINGS; i++) {
        const double middle = 0.5 * (low + high);
        status = palp_element_advance(material, state, middle, dt_s, &next, NULL);
        *(next.force_N < 0 ? &low : &high) = middle;
    }
    if (!status && free)
        next.force_N = 0;
    if (!status)
        *state = next;
    return status;
}

/* ---- one step ---- */

static palp_status step_to(fmi3Instance fmu, double depth_m, const double tool_m[3], double dt_s) {
    double *value = fmu->now.value;
    palp_tool_force force = {{0}, {0}, 0, 0};
    palp_status status;
    if (!(depth_m < fmu->height_m)) {
        status = PALP_ERR_ARGUMENT;
    } else if (!fmu->network) {
        status = press_specimen(&fmu->model.material, depth_m / fmu->height_m, dt_s, &fmu->now.element);
        value[FMU_FORCE] = status ? value[FMU_FORCE] : fmu->now.element.force_N;
    } else if (fmu->network_tip_m > 0) {
        palp_tool sphere = {.shape = PALP_TOOL_SPHERE, .radius_m = fmu->network_tip_m};
        memcpy(sphere.position_m, tool_m, sizeof sphere.position_m);
        status = palp_network_set_tools(fmu->network, 1, &sphere);
        status = status ? status : palp_network_step(fmu->network, 0, dt_s, NULL);
        status = status ? status : palp_network_tool_force(fmu->network, &force);
        if (!status) {
            memcpy(value + FMU_TOOL_FORCE, force.force_N, sizeof force.force_N);
            value[FMU_FORCE] = force.force_N[1];
        }
    } else {
        palp_step_info info;
        status = palp_network_step(fmu->network, depth_m, dt_s, &info);
        value[FMU_FORCE] = status ? value[FMU_FORCE] : info.force_N;
    }
    if (!status) {
        fmu->now.reached[0] = depth_m;
        memcpy(fmu->now.reached + 1, tool_m, 3 * sizeof *tool_m);
    }
    return status;
}

palp_status fmu_begin(fmi3Instance fmu) {
    const double *value = fmu->now.value;
    const bool rests = fmu->network && fmu->network_tip_m > 0 ? false : value[FMU_DEPTH] == 0;
    fmu->now.reached[0] = value[FMU_DEPTH];
    memcpy(fmu->now.reached + 1, value + FMU_TOOL, 3 * sizeof *value);
    return rests ? PALP_OK : step_to(fmu, value[FMU_DEPTH], value + FMU_TOOL, 0);
}

palp_status fmu_advance(fmi3Instance fmu, double step_s, double *done_s) {
    const double *value = fmu->now.value, most_s = value[FMU_MAX_STEP];
    const double parts = most_s > 0 ? ceil(step_s / most_s - 1e-9) : 1;
    double from[4], to[4];
    palp_status status = PALP_OK;
    memcpy(from, fmu->now.reached, sizeof from);
    to[0] = value[FMU_DEPTH] + value[FMU_DEPTH_RATE] * step_s;
    for (int k = 0; k < 3; k++)
        to[1 + k] = value[FMU_TOOL + k] + value[FMU_TOOL_RATE + k] * step_s;
    *done_s = 0;
    for (double i = 1; i <= parts && !status; i++) {
        double at[4];
        for (int k = 0; k < 4; k++)
            at[k] = i == parts ? to[k] : from[k] + i / parts * (to[k] - from[k]);
        status = step_to(fmu, at[0], at + 1, step_s / parts);
        *done_s = status ? *done_s : i / parts * step_s;
    }
    return status;
}
