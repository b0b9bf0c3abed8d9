/* effect_internal.h: a row of the catalogue with what the effect does, by the stage that it acts in. */
#ifndef EFFECT_INTERNAL_H
#define EFFECT_INTERNAL_H

#include <palpate/model.h>

/* ---- between the encoder and the specimen's surface: the depth that goes on ---- */
typedef struct effect_surface {
    double depth, by_depth, by_force, by_value[PALP_EFFECT_PARAMETERS];
} effect_surface;

/* force: on the plate. */
typedef void effect_map(const double *value, double depth, double force, effect_surface *out);

/* ---- between the plate and the recorded force: one sample of the force that goes on ---- */
typedef struct effect_moment {
    double time, since;                   /* as recorded; since the first sample */
    double step;                          /* since the sample before, 0 = there is none */
    double depth, velocity, acceleration; /* of the encoder */
    double hum_phase;
} effect_moment;

typedef struct effect_reading {
    double force, by_input, by_input_old, by_output_old, by_value[PALP_EFFECT_PARAMETERS];
} effect_reading;

/* input_old and output_old: of this stage at the sample before; their derivatives are followed through. out
 * comes with by_input = 1 and the rest 0. */
typedef void effect_sensor(const double *value, const effect_moment *at, double input, double input_old,
                           double output_old, effect_reading *out);

/* ---- beside the specimen's spring: a relaxation modulus as a sum of exponentials ---- */
enum { EFFECT_MODES_MAX = 32, EFFECT_MODES_MIN = 6 };

/* How many of them (EFFECT_MODES_MIN to EFFECT_MODES_MAX), and the rates between which a power law needs
 * them, 1/s. */
typedef struct effect_range {
    size_t n;
    double slow, fast;
} effect_range;

/* A millisecond to three hours, to 1e-4. */
#define EFFECT_RANGE_WHOLE ((effect_range){EFFECT_MODES_MAX, 6e-6, 7e4})

/* One of them, weight exp(-rate t), and its derivatives by the effect's parameters. */
typedef struct effect_mode {
    double weight, rate;
    double weight_by[PALP_EFFECT_PARAMETERS], rate_by[PALP_EFFECT_PARAMETERS];
} effect_mode;

/* Fills mode[range->n]. */
typedef void effect_spectrum(const double *value, const effect_range *range, effect_mode *mode);

/* A row. The other stages (arms, spring, contact, supports) know their effects by id. */
typedef struct effect_row {
    palp_effect_info info;
    int stage; /* maps and sensors act in ascending order */
    effect_map *map;
    effect_sensor *sensor;
    effect_spectrum *spectrum;
} effect_row;

const effect_row *effect_row_of(palp_effect_id id); /* NULL outside the catalogue */

effect_map effect_contact_offset, effect_frame_compliance, effect_toe_region;
effect_sensor effect_sensor_gain, effect_coulomb_friction, effect_plate_inertia, effect_drive_ripple,
    effect_sensor_lag, effect_sensor_bias, effect_sensor_drift, effect_mains_hum, effect_force_saturation;
effect_spectrum effect_power_law, effect_consolidation;

/* Strain rate at which rate_stiffening counts its first decade, 1/s. */
#define EFFECT_RATE 0.01

/* Whether a model's effects are all within their bounds, carried by its kind, and there once. */
palp_status effect_list_check(const palp_model *model, palp_error *error);

/* Whether all strengths are zero. */
bool effect_is_off(const palp_effect *effect);

#endif
