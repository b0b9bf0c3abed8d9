/* drive_ripple.c: a wave of the force that is periodic in position. */
#include "effect_internal.h"

#include <math.h>

static const double TURN = 6.28318530717958647692;

/* value: amplitude, period, phase. */
static void add_drive_ripple_force(const double *value, const effect_moment *at, double input,
                                   double input_old, double output_old, effect_reading *out) {
    (void)input_old, (void)output_old;
    double turn = TURN * at->depth / value[1], wave = sin(turn + value[2]), slope = cos(turn + value[2]);
    out->force = input + value[0] * wave;
    out->by_value[0] = wave;
    out->by_value[1] = -value[0] * slope * turn / value[1];
    out->by_value[2] = value[0] * slope;
}

static palp_status propose_ripple_starts(const effect_data *data, effect_starts *out) {
    double wave[3];
    palp_status status = data->wave_in_depth(data, wave);
    if (!status)
        effect_start_at(out, wave[1], wave[0], wave[2]);
    return status;
}

const effect_row effect_drive_ripple = {
    .info = {.id = "drive_ripple",
             .name = "ripple of the drive, periodic in position",
             .place = PALP_EFFECT_FRAME,
             .means =
                 "The force has a ripple that is periodic in position, as from a screw or gear, in air too.",
             .seen_by = "slow motion over several periods, in air too",
             .n_parameters = 3,
             .parameter = {{"amplitude_N", 1, 0, 1e12, 0.02, .scale = PALP_SCALE_FORCE, .strength = true},
                           {"period_mm", 1e-3, 1e-15, 1e3, 1e-3, .scale = PALP_SCALE_LENGTH,
                            .logarithmic = true},
                           {"phase_rad", 1, -6.28318530717958647692, 6.28318530717958647692, 0,
                            .strength = false}},
             EFFECT_ALIKE(PALP_EFFECT_MAINS_HUM),
             .in_lumped = true,
             .in_network = true},
    .stage = 4,
    .sensor = add_drive_ripple_force,
    .starts = propose_ripple_starts,
    .scanned = 600,
    .need = EFFECT_NEEDS_PERIODS,
    .least = 3};
