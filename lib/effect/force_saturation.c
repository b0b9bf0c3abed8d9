/* force_saturation.c: the end of the sensor's range. */
#include "effect_internal.h"

#include <math.h>

static void clip_at_sensor_range(const double *value, const effect_moment *at, double input, double input_old,
                                 double output_old, effect_reading *out) {
    (void)at, (void)input_old, (void)output_old;
    out->force = input;
    if (!(value[0] > 0.0) || fabs(input) <= value[0])
        return;
    out->force = copysign(value[0], input);
    out->by_input = 0.0;
    out->by_value[0] = copysign(1.0, input);
}

/* Below the largest force, as noise is added after saturation. */
static palp_status propose_saturation_start(const effect_data *data, effect_starts *out) {
    effect_start_at(out, data->peak - 3.0 * data->white, 0.0, 0.0);
    return PALP_OK;
}

const effect_row effect_force_saturation = {
    .info = {.id = "force_saturation",
             .name = "saturation of the sensor",
             .place = PALP_EFFECT_SENSOR,
             .means = "The force sensor does not read beyond this force.",
             .seen_by = "forces up to the limit of the sensor",
             .n_parameters = 1,
             .parameter = {{"force_N", 1, 0, 1e12, 10, .scale = PALP_SCALE_FORCE, .strength = true}},
             EFFECT_ALIKE(PALP_EFFECT_FRAME_COMPLIANCE),
             .in_lumped = true,
             .in_network = true},
    .stage = 9,
    .sensor = clip_at_sensor_range,
    .bends = true,
    .starts = propose_saturation_start};
