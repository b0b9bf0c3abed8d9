/* explain_starts.c: the starts of the search for an effect. */
#include "explain_fit.h"
#include "explain_lines.h"

static palp_status wave_in_depth(const effect_data *facts, double wave[3]) {
    return explain_line_in_depth(facts->runs, facts->residual, &wave[0], &wave[1], &wave[2]);
}

/* Without these an effect has no start, or no column. */
static bool can_start(const effect_row *row, const effect_data *facts) {
    const bool needed = row->need == EFFECT_NEEDS_WITHDRAWAL || row->need == EFFECT_NEEDS_PERIODS ||
                        row->need == EFFECT_NEEDS_COLUMN || row->need == EFFECT_NEEDS_WEIGHT;
    char lack[EFFECT_LACK_MAX];
    return !needed || effect_need_met(row, facts, lack);
}

palp_status explain_starts_find(palp_effect_id id, const explain_data *data, const double *residual,
                                effect_starts *s) {
    const effect_row *row = effect_row_of(id);
    effect_data facts = explain_facts(data);
    facts.residual = residual;
    facts.wave_in_depth = wave_in_depth;
    *s = (effect_starts){.id = id};
    if (!can_start(row, &facts))
        return PALP_ERR_UNSUPPORTED;
    if (row->starts)
        return row->starts(&facts, s);
    effect_start_at(s, 0.0, 0.0, 0.0);
    return PALP_OK;
}

bool explain_has(const explain_fit *fit, palp_effect_id id) {
    for (size_t i = 0; i < fit->model.n_effects; i++)
        if (fit->model.effects[i].id == id)
            return true;
    return false;
}
