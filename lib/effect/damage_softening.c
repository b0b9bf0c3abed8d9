/* damage_softening.c: a spring that is softer below the largest strain so far (Ogden and Roxburgh 1999). */
#include "effect_internal.h"

static void set_damage_softening(const double *value, element_damage *damage,
                                 element_damage by_value[PALP_EFFECT_PARAMETERS]) {
    damage->softening = value[0];
    damage->sharpness = value[1];
    by_value[0].softening = 1.0;
    by_value[1].sharpness = 1.0;
}

static palp_status propose_softening_starts(const effect_data *data, effect_starts *out) {
    (void)data;
    effect_start_at(out, 0.05, 0.2, 0.0);
    effect_start_at(out, 0.05, 0.5, 0.0);
    effect_start_at(out, 0.2, 1.5, 0.0);
    return PALP_OK;
}

const effect_row effect_damage_softening = {
    .info = {.id = "damage_softening",
             .name = "damage softening (Mullins)",
             .place = PALP_EFFECT_SPECIMEN,
             .means = "Once pressed, the specimen is softer on unloading and reloading, up to the "
                      "largest depth so far.",
             .seen_by = "unloading, and loading again",
             .n_parameters = 2,
             .parameter = {{"softening", 1, 0, 0.9, 0.2, .strength = true},
                           {"sharpness", 1, 0.02, 20, 0.5, .logarithmic = true}},
             EFFECT_ALIKE(PALP_EFFECT_PERMANENT_SET, PALP_EFFECT_COULOMB_FRICTION),
             .in_lumped = true,
             .in_network = true},
    .history = set_damage_softening,
    .starts = propose_softening_starts,
    .need = EFFECT_NEEDS_UNLOADING,
    .least = 0.1};
