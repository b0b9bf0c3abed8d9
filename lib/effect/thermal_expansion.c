/* thermal_expansion.c: a frame that expands with its temperature, which is a column of the recording. */
#include "effect_internal.h"

static const char COLUMN[] = "temperature_C";

static void add_thermal_expansion(const double *value, const effect_press *at, effect_surface *out) {
    out->depth = at->depth + value[0] * at->change;
    out->by_change = value[0];
    out->by_value[0] = at->change;
}

const effect_row effect_thermal_expansion = {
    .info = {.id = "thermal_expansion",
             .name = "thermal expansion of the frame",
             .place = PALP_EFFECT_FRAME,
             .means = "The frame grows with its temperature and moves the plate towards the specimen.",
             .seen_by = "a column temperature_C that changes within a run, best in a hold",
             .n_parameters = 1,
             .parameter = {{"expansion_um_K", 1e-6, -1e3, 1e3, 2e-6, .scale = PALP_SCALE_LENGTH,
                            .strength = true}},
             EFFECT_ALIKE(PALP_EFFECT_SENSOR_DRIFT, PALP_EFFECT_RELAXATION_ARM, PALP_EFFECT_CONTACT_OFFSET),
             .in_lumped = true,
             .in_network = true,
             .column = COLUMN},
    .stage = 1,
    .map = add_thermal_expansion,
    .need = EFFECT_NEEDS_COLUMN};
