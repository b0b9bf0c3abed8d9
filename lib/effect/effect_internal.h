/* effect_internal.h: a row of the catalogue: properties and functions of an effect. Each row is in its
 * effect's own file; the library runs, fits and names effects by their rows only. */
#ifndef EFFECT_INTERNAL_H
#define EFFECT_INTERNAL_H

#include <palpate/effect.h>

#include "material/element.h"

/* ---- between the encoder and the specimen's surface: a map of the depth ---- */
typedef struct effect_press {
    double depth, force; /* on the plate */
    double change;       /* of the effect's column since the first sample */
} effect_press;

typedef struct effect_surface {
    double depth, by_depth, by_force, by_change, by_value[PALP_EFFECT_PARAMETERS];
} effect_surface;

/* out is initialised with the depth of at, by_depth = 1 and 0 for all else. */
typedef void effect_map(const double *value, const effect_press *at, effect_surface *out);

/* ---- between the plate and the recorded force: one sample of the force ---- */
typedef struct effect_moment {
    double time, since;                   /* as recorded; since the first sample */
    double step;                          /* since the sample before, 0 = there is none */
    double depth, velocity, acceleration; /* of the encoder */
    double fastest;                       /* its largest speed in this run */
    double hum_phase;
} effect_moment;

typedef struct effect_reading {
    double force, by_input, by_input_old, by_output_old, by_value[PALP_EFFECT_PARAMETERS];
} effect_reading;

/* input_old and output_old: this stage's values at the sample before; their derivatives are included. out is
 * initialised with by_input = 1 and 0 for all else. */
typedef void effect_sensor(const double *value, const effect_moment *at, double input, double input_old,
                           double output_old, effect_reading *out);

/* ---- parallel to the specimen's spring: a relaxation modulus as a sum of exponentials ---- */
enum { EFFECT_MODES_MAX = 32, EFFECT_MODES_MIN = 6 };

/* Number of exponentials (EFFECT_MODES_MIN to EFFECT_MODES_MAX), and the range of their rates for a power
 * law, 1/s. */
typedef struct effect_range {
    size_t n;
    double slow, fast;
} effect_range;

/* One exponential, weight exp(-rate t), and its derivatives by the effect's parameters. */
typedef struct effect_mode {
    double weight, rate;
    double weight_by[PALP_EFFECT_PARAMETERS], rate_by[PALP_EFFECT_PARAMETERS];
} effect_mode;

/* Fills mode[range->n]. */
typedef void effect_spectrum(const double *value, const effect_range *range, effect_mode *mode);

/* ---- the specimen's arms and spring ---- */

/* Derivatives of an arm by a parameter: log K at fixed tau, log tau at fixed K, beta, gamma. */
typedef struct effect_arm {
    double log_stiffness, log_time, beta, gamma;
} effect_arm;

/* Changes an arm of the model or of another effect; by_value is initialised with 0. */
typedef void effect_arms(const double *value, palp_arm *arm, effect_arm by_value[PALP_EFFECT_PARAMETERS]);

/* Changes how loading damages the spring; by_value is initialised with 0. */
typedef void effect_history(const double *value, element_damage *damage,
                            element_damage by_value[PALP_EFFECT_PARAMETERS]);

/* ---- between the plate and the surface ---- */

/* Force on a surface at this distance behind the plate. strongest: without a reach, the surface stays on the
 * plate up to this force. */
typedef struct effect_bond {
    double strongest, reach;
    double pull, by_gap, by_value[PALP_EFFECT_PARAMETERS];
} effect_bond;
typedef void effect_bonds(const double *value, double gap, effect_bond *out); /* out is initialised with 0 */

/* ---- a number: a factor, a stiffness ---- */
typedef struct effect_number {
    double value, by_value[PALP_EFFECT_PARAMETERS];
} effect_number;
typedef void effect_quantity(const double *value, double at, effect_number *out);

/* ---- identification of an effect from measured runs ---- */

/* Motions of the plate that the runs contain. */
typedef struct effect_shown {
    double speeds; /* ratio of the fastest to the slowest mean speed of a stretch under load; HUGE_VAL with a
                      dwell or reversal */
    double back;   /* longest return within a run, relative to the largest depth */
    double depths; /* ratio of the largest to the smallest depth of a dwell or run under load */
    bool again;    /* a specimen is pressed again */
    double rate;   /* sample rate of the slowest run, 1/s */
    double stride; /* largest motion between two samples, of the run where it is least, m */
} effect_shown;

/* Properties of the runs: longest run, typical sample interval, largest depth, speed and force, sd of a
 * sample's white noise; the specimen's height. */
typedef struct effect_data {
    double duration, step, deepest, fastest, peak, white, height;
    size_t n_releases; /* releases of a plate with a jump, */
    double pull[2];    /* and the pull there: largest recorded, and too large */
    double pulled; /* largest pull recorded on withdrawal, at least what noise hides; 0 = no withdrawal that
                      far */
    effect_shown shown;
    bool known_force; /* the specimen's force is not fitted: another program has computed it */
    double frame[2];  /* interval of the frame's compliance from runs on a rigid block; 0, 0 = no such runs */
    const void *runs; /* for the next two functions */
    const double *residual; /* residual of a fit to the runs; NULL: not needed */
    /* Period, amplitude and phase of the residual's largest wave over depth. */
    palp_status (*wave_in_depth)(const struct effect_data *data, double wave[3]);
    /* Largest change of a column within a run; 0 if it is noise or no run has the column. */
    double (*change_of)(const struct effect_data *data, const char *column);
} effect_data;

enum { EFFECT_STARTS = 16 };

typedef struct effect_starts {
    palp_effect_id id;
    size_t n;
    palp_effect effect[EFFECT_STARTS];
} effect_starts;

void effect_start_at(effect_starts *starts, double a, double b, double c);
/* n starts of the second parameter, a time, with even logarithms: from so many samples to twice the longest
 * run. */
void effect_start_times(effect_starts *starts, const effect_data *data, double samples, size_t n);

/* What recordings must contain for an effect to be identifiable, however large it is; row->least is the
 * amount. Identifiability conditional on the specimen's law is tested separately. */
typedef enum effect_need {
    EFFECT_NEEDS_NOTHING,    /* nothing more */
    EFFECT_NEEDS_RATES,      /* speeds that differ by this factor, a dwell, or a reversal */
    EFFECT_NEEDS_REVERSAL,   /* a return, relative to the largest depth */
    EFFECT_NEEDS_UNLOADING,  /* the same, or a specimen that is pressed again */
    EFFECT_NEEDS_WITHDRAWAL, /* withdrawal until the force is gone */
    EFFECT_NEEDS_DEPTHS,     /* two depths that differ by this factor, or a return through all of them */
    EFFECT_NEEDS_NYQUIST, /* a sample rate above twice its second parameter, a frequency, and so many periods
                             in a run */
    EFFECT_NEEDS_PERIODS, /* so many of its periods in the travel, with at least two samples each */
    EFFECT_NEEDS_COLUMN,  /* its own column, not constant */
    EFFECT_NEEDS_WEIGHT   /* a known weight, which no recording of a press has */
} effect_need;

/* The interval of a parameter that is computed from the data, not fitted. */
typedef struct effect_read {
    double low, high;
} effect_read;

/* ---- a row ---- */
typedef struct effect_row {
    palp_effect_info info;
    int stage; /* maps, sensors and spectra act in ascending order */
    effect_map *map;
    bool gives_way; /* the map's depth depends on the force */
    effect_sensor *sensor;
    bool remembers; /* the sensor's reading depends on the one before it */
    bool bends;     /* the sensor's reading is a nonlinear function of the force */
    effect_spectrum *spectrum;
    bool arm; /* it is an additional arm with parameters K and tau */
    effect_arms *arms;
    effect_history *history;
    effect_quantity *spring;     /* factor of the spring's force at a strain rate of the plate, 1/s */
    effect_quantity *specimen;   /* factor of the specimen's whole force at a time of the session, s */
    effect_bonds *bond;          /* between surface and plate; at most one effect of a model */
    effect_quantity *foundation; /* stiffness that supports a network's nodes sideways at the plates, relative
                                    to that of the elements there, at = 0; by_value: of its logarithm. Nodes
                                    are fixed if the effect is off */
    effect_need need;
    double least;                                                       /* amount of it */
    palp_status (*starts)(const effect_data *data, effect_starts *out); /* NULL: one start, all values 0 */
    bool (*read)(const effect_data *data,
                 effect_read *out); /* NULL, or computes the first parameter if these runs determine it */
    bool jumps;                     /* the force jumps where its strength, its first parameter, is reached */
    bool line;       /* a spectral line whose phase differs between runs; at most one effect is */
    double scanned;  /* number of periods or frequencies among which the search takes the best; 0 = only the
                        start */
    bool of_runs;    /* a nuisance parameter of each run adds to it: only their mean is identifiable */
    bool as_scatter; /* may first appear as scatter of the runs' gains or contacts */
} effect_row;

#define EFFECT_ALIKE(...)                                                                                    \
    .n_alike = sizeof((palp_effect_id[]){__VA_ARGS__}) / sizeof(palp_effect_id), .alike = {__VA_ARGS__}

#define EFFECT_ROW(NAME, id) extern const effect_row effect_##id;
PALP_EFFECTS(EFFECT_ROW)
#undef EFFECT_ROW

const effect_row *effect_row_of(palp_effect_id id); /* NULL outside the catalogue */

enum { EFFECT_LACK_MAX = 160 };

/* Do the runs contain what the effect needs? If not, lack says what they contain instead, with its number,
 * and what would suffice. */
bool effect_need_met(const effect_row *row, const effect_data *data, char lack[EFFECT_LACK_MAX]);

palp_effect_id effect_line(void); /* the effect that is a spectral line; PALP_EFFECT_COUNT if there is none */

/* Are all strengths zero? */
bool effect_is_off(const palp_effect *effect);

#endif
