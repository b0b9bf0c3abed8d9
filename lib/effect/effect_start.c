/* effect_start.c: starting values for the search for an effect. */
#include "effect_internal.h"

#include <math.h>

void effect_start_at(effect_starts *starts, double a, double b, double c) {
    if (starts->n < EFFECT_STARTS)
        starts->effect[starts->n++] = (palp_effect){.id = starts->id, .value = {a, b, c}};
}

void effect_start_times(effect_starts *starts, const effect_data *data, double samples, size_t n) {
    double low = samples * data->step, high = 2.0 * data->duration;
    for (size_t k = 0; k < n; k++)
        effect_start_at(starts, 0.0, low * pow(high / low, (double)k / (double)(n - 1)), 0.0);
}
