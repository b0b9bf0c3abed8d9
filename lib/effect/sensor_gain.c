/* sensor_gain.c: an error of the sensor's gain. */
#include "effect_internal.h"

static void multiply_by_sensor_gain(const double *value, const effect_moment *at, double input,
                                    double input_old, double output_old, effect_reading *out) {
    (void)at, (void)input_old, (void)output_old;
    out->by_input = 1.0 + value[0];
    out->force = input * out->by_input;
    out->by_value[0] = input;
}

const effect_row effect_sensor_gain = {
    .info = {.id = "sensor_gain",
             .name = "gain of the sensor",
             .place = PALP_EFFECT_SENSOR,
             .means = "The force sensor reads too much or too little by a factor.",
             .seen_by = "a known weight on the sensor",
             .n_parameters = 1,
             .parameter = {{"gain", 1, -0.9, 10, 0.05, .strength = true}},
             EFFECT_ALIKE(PALP_EFFECT_SESSION_AGEING, PALP_EFFECT_FRAME_COMPLIANCE),
             .in_lumped = true,
             .in_network = true},
    .stage = 1,
    .sensor = multiply_by_sensor_gain,
    .of_runs = true,
    .need = EFFECT_NEEDS_WEIGHT};
