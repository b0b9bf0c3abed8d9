/* material.c: the public interface to one element: checks, one step, a lumped specimen's force curve. */
#include "element.h"
#include "base/file.h"
#include "law_internal.h"

#include <math.h>

static palp_status check_maxwell_arm(const palp_material *material, size_t j, palp_error *error) {
    const palp_arm *arm = &material->arms[j];
    if (!(arm->stiffness_N > 0.0) || !isfinite(arm->stiffness_N))
        return palp_error_set(error, PALP_ERR_ARGUMENT, "arm %zu: stiffness_N must be positive", j + 1);
    if (!(arm->viscosity_Ns > 0.0) || !isfinite(arm->viscosity_Ns))
        return palp_error_set(error, PALP_ERR_ARGUMENT, "arm %zu: viscosity_Ns must be positive", j + 1);
    if (!(arm->beta > -1.0) || !isfinite(arm->beta) || !(arm->gamma > -1.0) || !isfinite(arm->gamma))
        return palp_error_set(error, PALP_ERR_ARGUMENT, "arm %zu: strain dependence must be above -1", j + 1);
    if (material->quasi_linear && arm->beta != 0.0)
        return palp_error_set(error, PALP_ERR_UNSUPPORTED,
                              "a quasi-linear material does not support strain-dependent arms");
    if (material->formulation == PALP_SEDEF2008 && (arm->beta != 0.0 || arm->gamma != 0.0))
        return palp_error_set(error, PALP_ERR_UNSUPPORTED,
                              "formulation sedef2008 does not support strain-dependent arms");
    return PALP_OK;
}

palp_status palp_material_check(const palp_material *material, palp_error *error) {
    if (!material)
        return palp_error_null(error);
    palp_status status = PALP_OK;
    if (material->n_arms > PALP_ARMS_MAX)
        return palp_error_set(error, PALP_ERR_LIMIT, "%zu arms, at most %d", material->n_arms, PALP_ARMS_MAX);
    for (size_t j = 0; j < material->n_arms; j++) {
        status = check_maxwell_arm(material, j, error);
        if (status)
            return status;
    }
    if (!(material->dashpot_Ns >= 0.0) || !isfinite(material->dashpot_Ns))
        return palp_error_set(error, PALP_ERR_ARGUMENT, "dashpot_Ns must not be negative");
    status = law_check(&material->law);
    if (status)
        return palp_error_set(error, status, "invalid stiffness law: %s", palp_status_text(status));
    double start;
    palp_law_stiffness(&material->law, 0.0, &start, NULL);
    if (!isfinite(start) || (material->quasi_linear && !(start > 0.0)))
        return palp_error_set(error, PALP_ERR_ARGUMENT, "the stiffness at zero strain must be positive");
    if (material->formulation == PALP_SEDEF2008 &&
        (material->n_arms > 1 || material->quasi_linear || material->dashpot_Ns > 0.0))
        return palp_error_set(
            error, PALP_ERR_UNSUPPORTED,
            "formulation sedef2008 supports at most one arm, no dashpot and no quasi_linear");
    return PALP_OK;
}

/* palp_element_advance with a prepared step, without checks. */
static void element_advance(const palp_material *material, const element_step *step,
                            const palp_element_state *from, double strain, palp_element_state *to,
                            double *tangent_N) {
    palp_element_state start = *from, end = *from;
    double force, tangent, elastic_old;
    palp_law_force(&material->law, 1, &start.strain, &elastic_old, NULL, NULL);
    element_history old = {&start.strain, &elastic_old, start.arm_N, NULL, 1};
    element_history new = {&end.strain, &(double){0}, end.arm_N, NULL, 1};
    element_trial(material, step, 1, &strain, &old, &new, &force, &tangent);
    if (material->formulation == PALP_SEDEF2008)
        force += step->carry * start.force_N;
    end.force_N = force;
    *to = end;
    if (tangent_N)
        *tangent_N = tangent;
}

/* Can palp_element_advance take this step? */
static bool can_element_take_step(const palp_material *material, double strain, double dt) {
    bool rate =
        material->dashpot_Ns > 0.0 || (material->formulation == PALP_SEDEF2008 && material->n_arms > 0);
    return dt >= 0.0 && isfinite(strain) && !(dt == 0.0 && rate);
}

palp_status palp_element_advance(const palp_material *material, const palp_element_state *from, double strain,
                                 double dt_s, palp_element_state *to, double *tangent_N) {
    if (!material || !from || !to || material->n_arms > PALP_ARMS_MAX || !law_bounded(&material->law) ||
        !can_element_take_step(material, strain, dt_s))
        return PALP_ERR_ARGUMENT;
    element_step step;
    element_step_prepare(material, dt_s, &step);
    element_advance(material, &step, from, strain, to, tangent_N);
    return PALP_OK;
}

palp_status palp_lumped_run(const palp_material *material, double height_m, size_t n, const double *time_s,
                            const double *depth_m, double *force_N) {
    if (!material || !time_s || !depth_m || !force_N)
        return PALP_ERR_ARGUMENT;
    palp_status status = palp_material_check(material, NULL);
    if (status)
        return status;
    if (!(height_m > 0.0))
        return PALP_ERR_ARGUMENT;
    palp_element_state state = {0};
    element_steps steps = {0};
    for (size_t i = 0; i < n; i++) {
        double strain = depth_m[i] / height_m, dt = i ? time_s[i] - time_s[i - 1] : 0.0;
        if (i && !(dt > 0.0))
            return PALP_ERR_ARGUMENT;
        if (i == 0 && strain == 0.0) {
            force_N[0] = 0.0;
            continue;
        }
        if (!can_element_take_step(material, strain, dt))
            return PALP_ERR_ARGUMENT;
        element_advance(material, element_steps_of(material, dt, &steps), &state, strain, &state, NULL);
        force_N[i] = state.force_N;
    }
    return PALP_OK;
}
