/* rate_stiffening.c: a spring whose stiffness grows with each decade of strain rate. */
#include "effect_internal.h"

#include <math.h>

static const double FIRST = 0.01; /* strain rate above which decades count if the file does not say, 1/s */

/* value: stiffening per decade, strain rate above which decades count. */
static void rate_stiffening_factor(const double *value, double rate, effect_number *out) {
    const double first = value[1] > 0.0 ? value[1] : FIRST, x = fabs(rate) / first;
    out->by_value[0] = log10(1.0 + x);
    out->by_value[1] = -value[0] * x / (first * (1.0 + x)) / log(10.0);
    out->value = 1.0 + value[0] * out->by_value[0];
}

static palp_status propose_rate_starts(const effect_data *data, effect_starts *out) {
    static const double parts[] = {0.02, 0.3};
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++)
        effect_start_at(out, 0.0, parts[k] * data->fastest / data->height, 0.0);
    return PALP_OK;
}

const effect_row effect_rate_stiffening = {
    .info = {.id = "rate_stiffening",
             .name = "rate stiffening",
             .place = PALP_EFFECT_SPECIMEN,
             .means = "The specimen's spring is stiffer the faster the plate moves.",
             .seen_by = "ramps at several rates, one in a decade",
             .n_parameters = 2,
             .parameter = {{"per_decade", 1, 0, 2, 0.05, .strength = true},
                           {"from_per_s", 1, 0, 1e12, 0.01, .scale = PALP_SCALE_STRAIN_RATE,
                            .logarithmic = true, .optional = true}},
             EFFECT_ALIKE(PALP_EFFECT_RELAXATION_ARM, PALP_EFFECT_POWER_LAW_RELAXATION,
                          PALP_EFFECT_COULOMB_FRICTION),
             .in_lumped = true,
             .in_network = true},
    .spring = rate_stiffening_factor,
    .starts = propose_rate_starts,
    .need = EFFECT_NEEDS_RATES,
    .least = 1.5};
