/* coulomb_friction.c: a constant force against the motion. */
#include "effect_internal.h"

#include <math.h>

static const double SLIDING =
    1e-3; /* relative to the run's largest speed: the speed at half the friction force */

static void add_friction_force(const double *value, const effect_moment *at, double input, double input_old,
                               double output_old, effect_reading *out) {
    (void)input_old, (void)output_old;
    out->by_value[0] =
        at->velocity == 0.0 ? 0.0 : at->velocity / (fabs(at->velocity) + SLIDING * at->fastest);
    out->force = input + value[0] * out->by_value[0];
}

const effect_row effect_coulomb_friction = {
    .info = {.id = "coulomb_friction",
             .name = "Coulomb friction",
             .place = PALP_EFFECT_FRAME,
             .means = "A constant friction force acts against the motion, in air too.",
             .seen_by = "both directions, in air too",
             .n_parameters = 1,
             .parameter = {{"force_N", 1, 0, 1e12, 0.05, .scale = PALP_SCALE_FORCE, .strength = true}},
             EFFECT_ALIKE(PALP_EFFECT_DAMAGE_SOFTENING, PALP_EFFECT_RATE_STIFFENING),
             .in_lumped = true,
             .in_network = true},
    .stage = 2,
    .sensor = add_friction_force,
    .need = EFFECT_NEEDS_REVERSAL,
    .least = 0.02};
