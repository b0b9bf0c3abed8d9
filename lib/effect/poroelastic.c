/* poroelastic.c: liquid pressed out of pores: its relaxation modulus as a sum of exponentials. */
#include "effect_internal.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

/* Terms 1 / n^2 of odd n in [n, end) as one mode; returns its weight and the viscosity that determines its
 * rate. */
static effect_mode group_odd_series_terms(int n, int end, double *weight, double *viscosity) {
    double w = 0.0, v = 0.0;
    for (; n < end; n += 2) {
        w += 1.0 / ((double)n * n);
        v += 1.0 / ((double)n * n * n * n);
    }
    *weight -= w;
    *viscosity -= v;
    return (effect_mode){.weight = w, .rate = w / v};
}

/* value: stiffness, time. 8 / pi^2 sum over odd n of exp(-n^2 t / time) / n^2: first single terms, then
 * groups of increasing width, then all other terms. */
static void find_poroelastic_modes(const double *value, const effect_range *range, effect_mode *mode) {
    enum { LAST = 1001 };
    const double whole = PI * PI / 8.0; /* sum of 1 / n^2 */
    const size_t alone = range->n / 3, groups = range->n - 1 - alone;
    double weight = whole, viscosity = PI * PI * PI * PI / 96.0; /* remainders of both sums */
    int n = 1;
    for (size_t i = 0; i + 1 < range->n; i++) {
        double wider = pow((double)LAST / n, 1.0 / (double)(alone + groups - i));
        int end = i < alone ? n + 2 : (int)fmax(n + 2, wider * n) | 1;
        mode[i] = group_odd_series_terms(n, end, &weight, &viscosity);
        n = end;
    }
    mode[range->n - 1] = (effect_mode){.weight = weight, .rate = weight / viscosity};
    for (size_t i = 0; i < range->n; i++) {
        double unit = mode[i].weight / whole, rate = mode[i].rate / value[1];
        mode[i] = (effect_mode){
            .weight = value[0] * unit, .rate = rate, .weight_by = {unit}, .rate_by = {0.0, -rate / value[1]}};
    }
}

static palp_status propose_drainage_times(const effect_data *data, effect_starts *out) {
    effect_start_times(out, data, 3.0, 8);
    return PALP_OK;
}

const effect_row effect_poroelastic = {
    .info = {.id = "poroelastic",
             .name = "poroelastic consolidation",
             .place = PALP_EFFECT_SPECIMEN,
             .means = "Liquid is pressed out of pores; the force falls as it drains.",
             .seen_by = "dwells as long as the time, ramps a hundredth of it",
             .n_parameters = 2,
             .parameter = {{"stiffness_N", 1, 0, 1e12, 1, .scale = PALP_SCALE_FORCE, .strength = true},
                           {"time_s", 1, 1e-12, 1e12, 10, .scale = PALP_SCALE_TIME, .logarithmic = true}},
             EFFECT_ALIKE(PALP_EFFECT_RELAXATION_ARM, PALP_EFFECT_POWER_LAW_RELAXATION),
             .in_lumped = true,
             .in_network = true},
    .stage = 2,
    .spectrum = find_poroelastic_modes,
    .starts = propose_drainage_times,
    .need = EFFECT_NEEDS_RATES,
    .least = 1.5};
