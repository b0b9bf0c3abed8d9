/* sensor_lag.c: a sensor with a delay, like a low-pass filter. */
#include "effect_internal.h"

#include <math.h>

/* T dy/dt + y = x, exact for x linear between the samples. */
static void delay_by_sensor_lag(const double *value, const effect_moment *at, double input, double input_old,
                                double output_old, effect_reading *out) {
    double decay, mean, late = output_old - input_old, rise = input - input_old;
    out->force = input;
    if (at->step == 0.0)
        return;
    element_decay(value[0] > 0.0 ? at->step / value[0] : INFINITY, &decay, &mean);
    out->force = input + late * decay - rise * mean;
    out->by_input = 1.0 - mean;
    out->by_input_old = mean - decay;
    out->by_output_old = decay;
    out->by_value[0] = value[0] > 0.0
                           ? (late * decay * at->step / value[0] - rise * (mean - decay)) / value[0]
                           : -rise / at->step;
}

static palp_status propose_lag_times(const effect_data *data, effect_starts *out) {
    static const double samples[] = {0.3, 1.2, 5.0, 20.0};
    for (size_t k = 0; k < sizeof samples / sizeof *samples; k++)
        effect_start_at(out, samples[k] * data->step, 0.0, 0.0);
    if (0.03 * data->duration > 60.0 * data->step)
        effect_start_at(out, 0.03 * data->duration, 0.0, 0.0);
    return PALP_OK;
}

const effect_row effect_sensor_lag = {
    .info = {.id = "sensor_lag",
             .name = "lag of the sensor",
             .place = PALP_EFFECT_SENSOR,
             .means = "The force sensor lags, as a low-pass filter with this time constant.",
             .seen_by = "fast ramps in both directions, and their ends",
             .n_parameters = 1,
             .parameter = {{"time_s", 1, 0, 1e9, 0.01, .scale = PALP_SCALE_TIME, .strength = true}},
             EFFECT_ALIKE(PALP_EFFECT_PLATE_INERTIA, PALP_EFFECT_RELAXATION_ARM),
             .in_lumped = true,
             .in_network = true},
    .stage = 5,
    .sensor = delay_by_sensor_lag,
    .remembers = true,
    .starts = propose_lag_times,
    .need = EFFECT_NEEDS_RATES,
    .least = 1.5};
