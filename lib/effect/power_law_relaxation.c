/* power_law_relaxation.c: a springpot parallel to the spring: its relaxation modulus as a sum of
 * exponentials. */
#include "effect_internal.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

/* sum over i >= 0 of exp(p (u - i h)) for p > 0, of exp(p (u + i h)) for p < 0, and d/dp of its logarithm. */
static double sum_geometric_series(double p, double u, double h, double *slope) {
    double ratio = 1.0 / expm1(fabs(p) * h);
    *slope = u - copysign(h * ratio, p);
    return exp(p * u) * (1.0 + ratio);
}

/* value: c, a. t^-a / Gamma(1-a) = sin(pi a) / pi * integral of exp(a u - e^u t) du by the trapezoidal rule.
 * It converges exponentially in 1 / h. Each remainder is one mode with the same first two moments. For
 * slow modes this keeps their effect at long times, for fast ones their viscosity. */
static void find_power_law_modes(const double *value, const effect_range *range, effect_mode *mode) {
    const size_t inner = range->n - 2;
    const double c = value[0], a = value[1], turn = PI / tan(PI * a);
    double start = log(range->slow), h = (log(range->fast) - start) / (double)(inner - 1);
    double scale = h * sin(PI * a) / PI, end = start + h * (double)inner, of_weight, of_first, of_second;
    for (size_t i = 0; i < inner; i++) {
        double u = start + h * (double)i, unit = scale * exp(a * u);
        mode[i] =
            (effect_mode){.weight = c * unit, .rate = exp(u), .weight_by = {unit, c * unit * (turn + u)}};
    }
    double weight = scale * sum_geometric_series(a, start - h, h, &of_weight);
    double first = scale * sum_geometric_series(a + 1.0, start - h, h, &of_first);
    mode[inner] = (effect_mode){.weight = c * weight,
                                .rate = first / weight,
                                .weight_by = {weight, c * weight * (turn + of_weight)},
                                .rate_by = {0.0, first / weight * (of_first - of_weight)}};
    first = scale * sum_geometric_series(a - 1.0, end, h, &of_first);
    double second = scale * sum_geometric_series(a - 2.0, end, h, &of_second);
    weight = first * first / second;
    mode[inner + 1] = (effect_mode){.weight = c * weight,
                                    .rate = first / second,
                                    .weight_by = {weight, c * weight * (turn + 2.0 * of_first - of_second)},
                                    .rate_by = {0.0, first / second * (of_first - of_second)}};
}

static palp_status propose_exponent_starts(const effect_data *data, effect_starts *out) {
    (void)data;
    for (int k = 0; k < 5; k++)
        effect_start_at(out, 0.0, 0.06 + 0.13 * k, 0.0);
    return PALP_OK;
}

const effect_row effect_power_law_relaxation = {
    .info = {.id = "power_law_relaxation",
             .name = "power-law relaxation (springpot)",
             .place = PALP_EFFECT_SPECIMEN,
             .means = "The specimen relaxes over many decades as a power of time.",
             .seen_by = "dwells and ramps over several decades of time",
             .n_parameters = 2,
             .parameter = {{"stiffness_N", 1, 0, 1e12, 1, .scale = PALP_SCALE_FORCE_1_S, .strength = true},
                           {"exponent", 1, 0.02, 0.9, 0.2, .strength = false}},
             EFFECT_ALIKE(PALP_EFFECT_RELAXATION_ARM, PALP_EFFECT_POROELASTIC),
             .in_lumped = true,
             .in_network = true},
    .stage = 1,
    .spectrum = find_power_law_modes,
    .starts = propose_exponent_starts,
    .need = EFFECT_NEEDS_RATES,
    .least = 1.5};
