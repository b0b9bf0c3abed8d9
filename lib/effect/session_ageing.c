/* session_ageing.c: a specimen that becomes stiffer or softer during the session. */
#include "effect_internal.h"

static void ageing_factor_at_time(const double *value, double session_s, effect_number *out) {
    out->value = 1.0 + value[0] * session_s;
    out->by_value[0] = session_s;
}

const effect_row effect_session_ageing = {
    .info = {.id = "session_ageing",
             .name = "ageing in the session",
             .place = PALP_EFFECT_CONTACT,
             .means = "The specimen grows stiffer or softer during the session.",
             .seen_by = "the first test again at the end",
             .n_parameters = 1,
             .parameter = {{"per_hour", 1.0 / 3600, -1e9, 1e9, 0.05 / 3600, .scale = PALP_SCALE_RATE,
                            .strength = true}},
             EFFECT_ALIKE(PALP_EFFECT_SENSOR_GAIN, PALP_EFFECT_DAMAGE_SOFTENING),
             .in_lumped = true,
             .in_network = true},
    .specimen = ageing_factor_at_time,
    .as_scatter = true,
    .of_runs = true};
