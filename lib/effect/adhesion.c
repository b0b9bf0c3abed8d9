/* adhesion.c: a specimen that sticks to the plate until the plate is pulled off. */
#include "effect_internal.h"

#include <math.h>

/* value: force, reach. The traction of Xu and Needleman (1993): the pull rises with the gap to a maximum at
 * the reach and falls beyond. Without a reach the surface stays on the plate up to that force; there is then
 * no derivative by the reach. */
static void evaluate_adhesive_bond(const double *value, double gap, effect_bond *out) {
    out->strongest = out->pull = value[0];
    out->reach = value[1];
    out->by_value[0] = 1.0;
    if (!(value[1] > 0.0))
        return;
    double x = gap / value[1], share = x * exp(1.0 - x), by_x = (1.0 - x) * exp(1.0 - x);
    out->pull = value[0] * share;
    out->by_gap = value[0] * by_x / value[1];
    out->by_value[0] = share;
    out->by_value[1] = -out->by_gap * x;
}

/* If plates let go with a jump, and samples about it do not count, the force is that of the jump.
 * It lies between the largest recorded pull and one too large, both with three sds of the noise. */
static bool read_strongest_pull(const effect_data *data, effect_read *out) {
    double noise = 3.0 * data->white;
    out->low = fmax(0.0, data->pull[0] - noise);
    out->high = fmax(data->pull[0], data->pull[1]) + noise;
    return data->n_releases > 0;
}

static palp_status propose_adhesion_starts(const effect_data *data, effect_starts *out) {
    static const double parts[] = {0.003, 0.02, 0.06, 0.2}, places[] = {0.1, 0.35, 0.6, 0.85};
    effect_read read;
    const bool jumps = read_strongest_pull(data, &read);
    for (size_t k = 0; k < (jumps ? 4u : 2u); k++) /* the maximum of a noisy record exceeds the pull */
        for (size_t j = 0; j < 4; j++)
            effect_start_at(
                out, jumps ? read.low + places[k] * (read.high - read.low) : data->pulled / (1.0 + (double)k),
                parts[j] * data->deepest, 0.0);
    return PALP_OK;
}

const effect_row effect_adhesion = {
    .info = {.id = "adhesion",
             .name = "adhesion",
             .place = PALP_EFFECT_CONTACT,
             .means = "The specimen sticks to the plate, which pulls it on withdrawal until it lets go.",
             .seen_by = "withdrawal past contact",
             .n_parameters = 2,
             .parameter = {{"force_N", 1, 0, 1e12, 0.05, .scale = PALP_SCALE_FORCE, .strength = true},
                           {"reach_mm", 1e-3, 0, 1e3, 1e-4, .scale = PALP_SCALE_LENGTH, .logarithmic = true,
                            .optional = true}},
             EFFECT_ALIKE(PALP_EFFECT_SENSOR_BIAS),
             .in_lumped = true,
             .in_network = true},
    .bond = evaluate_adhesive_bond,
    .jumps = true,
    .need = EFFECT_NEEDS_WITHDRAWAL,
    .starts = propose_adhesion_starts,
    .read = read_strongest_pull};
