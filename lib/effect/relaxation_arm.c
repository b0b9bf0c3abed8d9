/* relaxation_arm.c: an additional Maxwell arm. */
#include "effect_internal.h"

static palp_status propose_relaxation_times(const effect_data *data, effect_starts *out) {
    effect_start_times(out, data, 1.0, 10);
    return PALP_OK;
}

const effect_row effect_relaxation_arm = {
    .info = {.id = "relaxation_arm",
             .name = "another relaxation time",
             .place = PALP_EFFECT_SPECIMEN,
             .means = "The specimen relaxes with one more relaxation time.",
             .seen_by = "dwells as long as the time, ramps as short",
             .n_parameters = 2,
             .parameter = {{"stiffness_N", 1, 0, 1e12, 1, .scale = PALP_SCALE_FORCE, .strength = true},
                           {"time_s", 1, 1e-12, 1e12, 10, .scale = PALP_SCALE_TIME, .logarithmic = true}},
             EFFECT_ALIKE(PALP_EFFECT_POWER_LAW_RELAXATION, PALP_EFFECT_POROELASTIC,
                          PALP_EFFECT_SENSOR_DRIFT),
             .in_lumped = true,
             .in_network = true,
             .repeats = true},
    .arm = true,
    .starts = propose_relaxation_times,
    .need = EFFECT_NEEDS_RATES,
    .least = 1.5};
