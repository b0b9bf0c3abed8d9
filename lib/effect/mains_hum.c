/* mains_hum.c: mains hum in the force; each run has its own phase. */
#include "effect_internal.h"

#include <math.h>

static const double TURN = 6.28318530717958647692;

/* value: amplitude, frequency. */
static void add_mains_hum_force(const double *value, const effect_moment *at, double input, double input_old,
                                double output_old, effect_reading *out) {
    (void)input_old, (void)output_old;
    double turn = TURN * at->time, angle = turn * value[1] + at->hum_phase;
    out->by_value[0] = sin(angle);
    out->by_value[1] = value[0] * turn * cos(angle);
    out->force = input + value[0] * out->by_value[0];
}

const effect_row effect_mains_hum = {
    .info = {.id = "mains_hum",
             .name = "mains hum",
             .place = PALP_EFFECT_SENSOR,
             .means = "The force has a component at the mains frequency.",
             .seen_by = "a sample rate well above twice the mains'",
             .n_parameters = 2,
             .parameter = {{"amplitude_N", 1, 0, 1e12, 0.01, .scale = PALP_SCALE_FORCE, .strength = true},
                           {"frequency_Hz", 1, 40, 70, 50, .strength = false}},
             EFFECT_ALIKE(PALP_EFFECT_DRIVE_RIPPLE),
             .in_lumped = true,
             .in_network = true},
    .stage = 8,
    .sensor = add_mains_hum_force,
    .line = true,
    .need = EFFECT_NEEDS_NYQUIST,
    .least = 3};
