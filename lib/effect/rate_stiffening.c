/* rate_stiffening.c: a spring that is stiffer by each decade of strain rate. */
#include "effect_internal.h"

#include <math.h>

static const double FIRST = 0.01; /* strain rate at which the first decade counts, 1/s */

static void spring(const double *value, double rate, effect_number *out) {
    out->by_value[0] = log10(1.0 + fabs(rate) / FIRST);
    out->value = 1.0 + value[0] * out->by_value[0];
}

const effect_row effect_rate_stiffening = {
    .info = {.id = "rate_stiffening", .name = "rate stiffening", .place = PALP_EFFECT_SPECIMEN,
             .means = "The specimen's spring is stiffer the faster the plate moves.",
             .seen_by = "ramps at several rates, one in a decade",
             .n_parameters = 1,
             .parameter = {{"per_decade", 1, 0, 2, 0.05, .strength = true}},
             EFFECT_ALIKE(PALP_EFFECT_RELAXATION_ARM, PALP_EFFECT_POWER_LAW_RELAXATION, PALP_EFFECT_COULOMB_FRICTION),
             .in_lumped = true, .in_network = true},
    .spring = spring};
