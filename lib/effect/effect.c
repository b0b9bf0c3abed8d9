/* effect.c: the catalogue of effects and its properties. */
#include "effect_internal.h"
#include "base/file.h"

#include <string.h>

#define EFFECT_ENTRY(NAME, id) [PALP_EFFECT_##NAME] = &effect_##id,
static const effect_row *const CATALOGUE[PALP_EFFECT_COUNT] = {PALP_EFFECTS(EFFECT_ENTRY)};
#undef EFFECT_ENTRY

const effect_row *effect_row_of(palp_effect_id id) {
    return (unsigned)id < PALP_EFFECT_COUNT ? CATALOGUE[id] : NULL;
}

const palp_effect_info *palp_effect_look_up(palp_effect_id id) {
    const effect_row *row = effect_row_of(id);
    return row ? &row->info : NULL;
}

palp_status palp_effect_parse(const char *id, palp_effect_id *found) {
    if (!id || !found)
        return PALP_ERR_ARGUMENT;
    for (int i = 0; i < PALP_EFFECT_COUNT; i++)
        if (strcmp(CATALOGUE[i]->info.id, id) == 0) {
            *found = (palp_effect_id)i;
            return PALP_OK;
        }
    return PALP_ERR_ARGUMENT;
}

palp_status palp_effect_default(palp_effect_id id, palp_effect *effect) {
    if (!effect)
        return PALP_ERR_ARGUMENT;
    const effect_row *row = effect_row_of(id);
    if (!row)
        return PALP_ERR_ARGUMENT;
    *effect = (palp_effect){.id = id};
    for (size_t k = 0; k < row->info.n_parameters; k++)
        effect->value[k] = row->info.parameter[k].strength ? 0.0 : row->info.parameter[k].typical;
    return PALP_OK;
}

palp_status palp_effect_check(const palp_effect *effect, palp_error *error) {
    if (!effect)
        return palp_error_null(error);
    const effect_row *row = effect_row_of(effect->id);
    if (!row)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "there is no effect number %d", (int)effect->id);
    for (size_t k = 0; k < row->info.n_parameters; k++) {
        const palp_effect_parameter *p = &row->info.parameter[k];
        if (!(effect->value[k] >= p->low && effect->value[k] <= p->high))
            return palp_error_set(error, PALP_ERR_ARGUMENT, "%s: %s must be between %.6g and %.6g, not %.6g",
                                  row->info.id, p->key, p->low / p->unit, p->high / p->unit,
                                  effect->value[k] / p->unit);
    }
    return PALP_OK;
}

palp_effect_id effect_line(void) {
    int i = 0;
    while (i < PALP_EFFECT_COUNT && !CATALOGUE[i]->line)
        i++;
    return (palp_effect_id)i;
}

bool effect_is_off(const palp_effect *effect) {
    const effect_row *row = effect_row_of(effect->id);
    for (size_t k = 0; k < row->info.n_parameters; k++)
        if (row->info.parameter[k].strength && effect->value[k] != 0.0)
            return false;
    return true;
}
