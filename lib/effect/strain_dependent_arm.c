/* strain_dependent_arm.c: arms whose stiffness and time depend on strain. */
#include "effect_internal.h"

static void add_strain_dependence(const double *value, palp_arm *arm,
                                  effect_arm by_value[PALP_EFFECT_PARAMETERS]) {
    arm->beta += value[0];
    arm->gamma += value[1];
    by_value[0].beta = 1.0;
    by_value[1].gamma = 1.0;
}

const effect_row effect_strain_dependent_arm = {
    .info = {.id = "strain_dependent_arm",
             .name = "strain-dependent arms",
             .place = PALP_EFFECT_SPECIMEN,
             .means = "How stiff the arms are, or how fast they relax, depends on strain.",
             .seen_by = "dwells at several depths",
             .n_parameters = 2,
             .parameter = {{"stiffness_per_strain", 1, -0.95, 100, 1, .strength = true},
                           {"time_per_strain", 1, -0.95, 100, 1, .strength = true}},
             EFFECT_ALIKE(PALP_EFFECT_FRAME_COMPLIANCE, PALP_EFFECT_RATE_STIFFENING),
             .in_lumped = true,
             .in_network = true},
    .arms = add_strain_dependence,
    .need = EFFECT_NEEDS_DEPTHS,
    .least = 1.1};
