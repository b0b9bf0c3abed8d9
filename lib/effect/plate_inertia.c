/* plate_inertia.c: the plate's own mass. */
#include "effect_internal.h"

static void add_plate_inertia_force(const double *value, const effect_moment *at, double input,
                                    double input_old, double output_old, effect_reading *out) {
    (void)input_old, (void)output_old;
    out->by_value[0] = at->acceleration;
    out->force = input + value[0] * at->acceleration;
}

const effect_row effect_plate_inertia = {
    .info = {.id = "plate_inertia",
             .name = "inertia of the plate",
             .place = PALP_EFFECT_FRAME,
             .means = "The plate's own mass adds a force wherever it speeds up or slows down.",
             .seen_by = "fast starts and stops, in air too",
             .n_parameters = 1,
             .parameter = {{"mass_kg", 1, 0, 1e12, 0.1, .scale = PALP_SCALE_MASS, .strength = true}},
             EFFECT_ALIKE(PALP_EFFECT_SENSOR_LAG),
             .in_lumped = true,
             .in_network = true},
    .stage = 3,
    .sensor = add_plate_inertia_force,
    .need = EFFECT_NEEDS_RATES,
    .least = 1.5};
