/* sensor_bias.c: an error of the sensor's zero, equal in all runs. */
#include "effect_internal.h"

static void add_sensor_bias_force(const double *value, const effect_moment *at, double input,
                                  double input_old, double output_old, effect_reading *out) {
    (void)at, (void)input_old, (void)output_old;
    out->force = input + value[0];
    out->by_value[0] = 1.0;
}

const effect_row effect_sensor_bias = {
    .info = {.id = "sensor_bias",
             .name = "bias of the sensor",
             .place = PALP_EFFECT_SENSOR,
             .means = "The force sensor has the same offset in all runs.",
             .seen_by = "free air",
             .n_parameters = 1,
             .parameter = {{"force_N", 1, -1e12, 1e12, 0.05, .scale = PALP_SCALE_FORCE, .strength = true}},
             EFFECT_ALIKE(PALP_EFFECT_CONTACT_OFFSET),
             .in_lumped = true,
             .in_network = true},
    .stage = 6,
    .sensor = add_sensor_bias_force,
    .of_runs = true};
