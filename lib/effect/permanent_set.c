/* permanent_set.c: a spring that does not return to its full length. */
#include "effect_internal.h"

static void set_permanent_set(const double *value, element_damage *damage,
                              element_damage by_value[PALP_EFFECT_PARAMETERS]) {
    damage->set = value[0];
    by_value[0].set = 1.0;
}

static palp_status propose_permanent_sets(const effect_data *data, effect_starts *out) {
    (void)data;
    effect_start_at(out, 0.01, 0.0, 0.0);
    effect_start_at(out, 0.1, 0.0, 0.0);
    return PALP_OK;
}

const effect_row effect_permanent_set = {
    .info = {.id = "permanent_set",
             .name = "permanent set",
             .place = PALP_EFFECT_SPECIMEN,
             .means = "Once pressed, the specimen does not come back to its full height.",
             .seen_by = "unloading to contact, and loading again",
             .n_parameters = 1,
             .parameter = {{"fraction", 1, 0, 0.8, 0.1, .strength = true}},
             EFFECT_ALIKE(PALP_EFFECT_DAMAGE_SOFTENING, PALP_EFFECT_CONTACT_OFFSET),
             .in_lumped = true,
             .in_network = true},
    .history = set_permanent_set,
    .starts = propose_permanent_sets,
    .need = EFFECT_NEEDS_UNLOADING,
    .least = 0.1};
