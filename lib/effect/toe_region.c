/* toe_region.c: an uneven surface that comes into contact gradually. */
#include "effect_internal.h"

#include <math.h>

/* depth - l (1 - exp(-depth / l)): the share of the surface that touches grows as 1 - exp(-depth / l). */
static void reduce_depth_by_toe_region(const double *value, const effect_press *at, effect_surface *out) {
    const double depth = at->depth;
    if (depth <= 0.0)
        return;
    double x = value[0] > 0.0 ? depth / value[0] : INFINITY, missing = -expm1(-x), rest = exp(-x);
    if (value[0] > 0.0) {
        out->depth = depth - value[0] * missing;
        out->by_depth = missing;
    }
    out->by_value[0] = -missing + (rest > 0.0 ? x * rest : 0.0);
}

static palp_status propose_toe_lengths(const effect_data *data, effect_starts *out) {
    static const double parts[] = {0.01, 0.04, 0.15};
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++)
        effect_start_at(out, parts[k] * data->deepest, 0.0, 0.0);
    return PALP_OK;
}

const effect_row effect_toe_region = {
    .info = {.id = "toe_region",
             .name = "toe region of an uneven surface",
             .place = PALP_EFFECT_CONTACT,
             .means = "The surface is uneven: the force begins more softly than by the law.",
             .seen_by = "a slow ramp through contact",
             .n_parameters = 1,
             .parameter = {{"length_mm", 1e-3, 0, 1e3, 2e-4, .scale = PALP_SCALE_LENGTH, .strength = true}},
             EFFECT_ALIKE(PALP_EFFECT_CONTACT_OFFSET),
             .in_lumped = true,
             .in_network = true},
    .stage = 3,
    .map = reduce_depth_by_toe_region,
    .starts = propose_toe_lengths};
