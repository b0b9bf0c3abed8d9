/* adhesion.c: a specimen that sticks to the plate until it is pulled off. */
#include "effect_internal.h"

#include <math.h>

static void pull(const double *value, double at, effect_number *out) {
    (void)at;
    out->value = value[0];
    out->by_value[0] = 1.0;
}

static const char *missing(const effect_data *data) {
    return data->n_releases == 0 ? "no plate lets go with a jump" : NULL;
}

/* Not fitted: which sample is the last before the release has no derivative. */
static void read_pull(const effect_data *data, effect_read *out) {
    out->low = data->pull[0];
    out->high = data->pull[1];
    out->value = 0.5 * (data->pull[0] + fmax(data->pull[0], data->pull[1]));
}

static palp_status starts(const effect_data *data, effect_starts *out) {
    effect_read read;
    read_pull(data, &read);
    effect_start_at(out, read.value, 0.0, 0.0);
    return PALP_OK;
}

const effect_row effect_adhesion = {
    .info = {.id = "adhesion", .name = "adhesion", .place = PALP_EFFECT_CONTACT,
             .means = "The specimen sticks to the plate, which pulls it on withdrawal until it lets go.",
             .seen_by = "withdrawal past contact",
             .n_parameters = 1,
             .parameter = {{"force_N", 1, 0, 1e12, 0.05, .scale = PALP_SCALE_FORCE, .strength = true}},
             EFFECT_ALIKE(PALP_EFFECT_SENSOR_BIAS),
             .in_lumped = true, .in_network = true},
    .pull = pull, .missing = missing, .starts = starts, .read = read_pull};
