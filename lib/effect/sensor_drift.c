/* sensor_drift.c: a zero of the sensor that drifts during a run. */
#include "effect_internal.h"

static void add_sensor_drift_force(const double *value, const effect_moment *at, double input,
                                   double input_old, double output_old, effect_reading *out) {
    (void)input_old, (void)output_old;
    out->force = input + value[0] * at->since;
    out->by_value[0] = at->since;
}

const effect_row effect_sensor_drift = {
    .info = {.id = "sensor_drift",
             .name = "drift of the sensor",
             .place = PALP_EFFECT_SENSOR,
             .means = "The zero of the force sensor moves at a constant rate during a run.",
             .seen_by = "free air before and after a long test",
             .n_parameters = 1,
             .parameter = {{"force_N_s", 1, -1e12, 1e12, 1e-3, .scale = PALP_SCALE_FORCE_RATE,
                            .strength = true}},
             EFFECT_ALIKE(PALP_EFFECT_RELAXATION_ARM, PALP_EFFECT_POWER_LAW_RELAXATION),
             .in_lumped = true,
             .in_network = true},
    .stage = 7,
    .sensor = add_sensor_drift_force,
    .need = EFFECT_NEEDS_RATES,
    .least = 1.5};
