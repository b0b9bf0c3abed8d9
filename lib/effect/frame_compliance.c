/* frame_compliance.c: a frame that deforms under load. */
#include "effect_internal.h"

static void subtract_frame_deflection(const double *value, const effect_press *at, effect_surface *out) {
    out->depth = at->depth - value[0] * at->force;
    out->by_force = -value[0];
    out->by_value[0] = -at->force;
}

/* Runs on a rigid block measure the frame alone. */
static bool read_frame_compliance(const effect_data *data, effect_read *out) {
    out->low = data->frame[0];
    out->high = data->frame[1];
    return data->frame[1] > 0.0;
}

const effect_row effect_frame_compliance = {
    .info = {.id = "frame_compliance",
             .name = "frame compliance",
             .place = PALP_EFFECT_FRAME,
             .means =
                 "The frame yields under load: the specimen is pressed less deep than the encoder reads.",
             .seen_by = "a rigid block, or specimens of two heights",
             .n_parameters = 1,
             .parameter = {{"compliance_mm_N", 1e-3, 0, 1e12, 1e-5, .scale = PALP_SCALE_COMPLIANCE,
                            .strength = true}},
             EFFECT_ALIKE(PALP_EFFECT_STRAIN_DEPENDENT_ARM, PALP_EFFECT_SENSOR_GAIN),
             .in_lumped = true,
             .in_network = true},
    .stage = 2,
    .map = subtract_frame_deflection,
    .gives_way = true,
    .read = read_frame_compliance};
