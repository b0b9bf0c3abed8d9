/* effect_need.c: do recordings contain what makes an effect identifiable? */
#include "effect_internal.h"
#include "base/file.h"

#include <math.h>

static const double TURNED =
    0.1; /* relative to the largest depth: shortest return that counts as a reversal */
static const double CLEAR =
    1.0 / 3.0; /* distance of an alias from slow changes, relative to the highest frequency of the line */

static bool needs_sampling_rate(const effect_row *row, const effect_data *data, char lack[EFFECT_LACK_MAX]) {
    const palp_effect_parameter *frequency = &row->info.parameter[1];
    const double rate = (1.0 + CLEAR) * frequency->high, periods = data->duration * frequency->low;
    if (data->shown.rate < rate)
        snprintf(lack, EFFECT_LACK_MAX,
                 "%.3g samples a second, but %.3g are needed to separate %.0f to %.0f Hz from slow changes",
                 data->shown.rate, rate, frequency->low, frequency->high);
    else
        snprintf(lack, EFFECT_LACK_MAX,
                 "the longest run has %.2g periods of %.0f Hz, but needs %.0f, which take %.2g s", periods,
                 frequency->low, row->least, row->least / frequency->low);
    return data->shown.rate >= rate && periods >= row->least;
}

static bool needs_several_rates(const effect_row *row, const effect_data *data, char lack[EFFECT_LACK_MAX]) {
    const effect_shown *shown = &data->shown;
    snprintf(lack, EFFECT_LACK_MAX,
             "the plate presses at one speed (the fastest is %.2g times the slowest), without pause or "
             "reversal; needed: %s",
             shown->speeds, row->info.seen_by);
    return shown->speeds >= row->least || shown->back >= TURNED;
}

static bool needs_motion_reversal(const effect_row *row, const effect_data *data,
                                  char lack[EFFECT_LACK_MAX]) {
    snprintf(lack, EFFECT_LACK_MAX,
             "the plate goes back by %.2g %% of the depth, but by %.2g %% at least is needed: %s",
             100.0 * data->shown.back, 100.0 * row->least, row->info.seen_by);
    return data->shown.back >= row->least;
}

static bool needs_several_depths(const effect_row *row, const effect_data *data, char lack[EFFECT_LACK_MAX]) {
    snprintf(lack, EFFECT_LACK_MAX,
             "all dwells and runs go to one depth (the deepest is %.3g times the shallowest); needed: %s",
             data->shown.depths, row->info.seen_by);
    return data->shown.depths >= row->least || data->shown.back >= TURNED;
}

static bool needs_several_periods(const effect_row *row, const effect_data *data,
                                  char lack[EFFECT_LACK_MAX]) {
    const double room = 0.5 * data->deepest / data->shown.stride;
    snprintf(lack, EFFECT_LACK_MAX,
             "the travel has %.2g periods of two samples each, but %.0f are needed: %s", room, row->least,
             row->info.seen_by);
    return room >= row->least;
}

bool effect_need_met(const effect_row *row, const effect_data *data, char lack[EFFECT_LACK_MAX]) {
    switch (row->need) {
    case EFFECT_NEEDS_RATES:
        return needs_several_rates(row, data, lack);
    case EFFECT_NEEDS_REVERSAL:
        return needs_motion_reversal(row, data, lack);
    case EFFECT_NEEDS_UNLOADING:
        return needs_motion_reversal(row, data, lack) || data->shown.again;
    case EFFECT_NEEDS_DEPTHS:
        return needs_several_depths(row, data, lack);
    case EFFECT_NEEDS_NYQUIST:
        return needs_sampling_rate(row, data, lack);
    case EFFECT_NEEDS_PERIODS:
        return needs_several_periods(row, data, lack);
    case EFFECT_NEEDS_WITHDRAWAL:
        snprintf(lack, EFFECT_LACK_MAX, "in no run the plate withdraws until the force is zero; needed: %s",
                 row->info.seen_by);
        return data->n_releases > 0 || data->pulled > 0.0;
    case EFFECT_NEEDS_COLUMN:
        snprintf(lack, EFFECT_LACK_MAX, "no run has a %s that changes", row->info.column);
        return data->change_of(data, row->info.column) > 0.0;
    case EFFECT_NEEDS_WEIGHT:
        snprintf(lack, EFFECT_LACK_MAX, "the gain cannot be separated from an unknown stiffness; needed: %s",
                 row->info.seen_by);
        return data->known_force;
    case EFFECT_NEEDS_NOTHING:
        break;
    }
    return true;
}
