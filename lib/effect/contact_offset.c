/* contact_offset.c: a surface that is not at the nominal depth 0. */
#include "effect_internal.h"

static void subtract_contact_offset(const double *value, const effect_press *at, effect_surface *out) {
    out->depth = at->depth - value[0];
    out->by_value[0] = -1.0;
}

const effect_row effect_contact_offset = {
    .info = {.id = "contact_offset",
             .name = "contact offset",
             .place = PALP_EFFECT_CONTACT,
             .means = "The recorded depth 0 is not at the surface.",
             .seen_by = "free air before contact",
             .n_parameters = 1,
             .parameter = {{"offset_mm", 1e-3, -1e3, 1e3, 1e-4, .scale = PALP_SCALE_LENGTH,
                            .strength = true}},
             EFFECT_ALIKE(PALP_EFFECT_SENSOR_BIAS, PALP_EFFECT_TOE_REGION),
             .in_lumped = true,
             .in_network = true},
    .stage = 1,
    .map = subtract_contact_offset,
    .as_scatter = true,
    .of_runs = true};
