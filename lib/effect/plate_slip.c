/* plate_slip.c: springs support a network's nodes at the plates sideways, instead of fixing them. */
#include "effect_internal.h"

#include <math.h>

static const double END =
    1e-6; /* smallest distance of the slip from both ends, where the foundation or its derivative diverges */

static void lateral_stiffness_of_slip(const double *value, double at, effect_number *out) {
    double slip = fmax(value[0], END);
    (void)at;
    out->value = fmax((1.0 - slip) / slip, END);
    out->by_value[0] = -1.0 / (slip * fmax(1.0 - slip, END));
}

/* Does not start from full support, where the force hardly depends on slip. */
static palp_status propose_slip_starts(const effect_data *data, effect_starts *out) {
    (void)data;
    effect_start_at(out, 0.05, 0.0, 0.0);
    effect_start_at(out, 0.4, 0.0, 0.0);
    return PALP_OK;
}

const effect_row effect_plate_slip = {
    .info = {.id = "plate_slip",
             .name = "slip at the plates",
             .place = PALP_EFFECT_CONTACT,
             .means = "The specimen slides sideways at the plates.",
             .seen_by = "a network whose shape is known; plates dry and greased",
             .n_parameters = 1,
             .parameter = {{"slip", 1, 0, 1, 0.5, .strength = true}},
             EFFECT_ALIKE(PALP_EFFECT_SENSOR_GAIN, PALP_EFFECT_FRAME_COMPLIANCE),
             .in_network = true},
    .foundation = lateral_stiffness_of_slip,
    .starts = propose_slip_starts};
