/* effect_internal.h: a row of the catalogue: what an effect is and does. Each row is in its effect's own
 * file; the rest of the library runs, fits and names effects by their rows only. */
#ifndef EFFECT_INTERNAL_H
#define EFFECT_INTERNAL_H

#include <palpate/effect.h>

#include "material/element.h"

/* ---- between the encoder and the specimen's surface: the depth that goes on ---- */
typedef struct effect_press {
    double depth, force; /* on the plate */
    double change;       /* of the effect's column since the first sample */
} effect_press;

typedef struct effect_surface {
    double depth, by_depth, by_force, by_change, by_value[PALP_EFFECT_PARAMETERS];
} effect_surface;

/* out comes with the depth of at, by_depth = 1 and the rest 0. */
typedef void effect_map(const double *value, const effect_press *at, effect_surface *out);

/* ---- between the plate and the recorded force: one sample of the force that goes on ---- */
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

/* One of them, weight exp(-rate t), and its derivatives by the effect's parameters. */
typedef struct effect_mode {
    double weight, rate;
    double weight_by[PALP_EFFECT_PARAMETERS], rate_by[PALP_EFFECT_PARAMETERS];
} effect_mode;

/* Fills mode[range->n]. */
typedef void effect_spectrum(const double *value, const effect_range *range, effect_mode *mode);

/* ---- the specimen's arms and spring ---- */

/* How far a parameter moves an arm: log K with tau held, log tau with K held, beta, gamma. */
typedef struct effect_arm {
    double log_stiffness, log_time, beta, gamma;
} effect_arm;

/* Changes an arm of the model, or of another effect; by_value comes zeroed. */
typedef void effect_arms(const double *value, palp_arm *arm, effect_arm by_value[PALP_EFFECT_PARAMETERS]);

/* Changes how loading damages the spring; by_value comes zeroed. */
typedef void effect_history(const double *value, element_damage *damage,
                            element_damage by_value[PALP_EFFECT_PARAMETERS]);

/* ---- between the plate and the surface ---- */

/* What pulls a surface that is so far behind the plate; strongest without a reach: it stays on the plate up
 * to there. */
typedef struct effect_bond {
    double strongest, reach;
    double pull, by_gap, by_value[PALP_EFFECT_PARAMETERS];
} effect_bond;
typedef void effect_bonds(const double *value, double gap, effect_bond *out); /* out comes zeroed */

/* ---- a number: a factor, a stiffness ---- */
typedef struct effect_number {
    double value, by_value[PALP_EFFECT_PARAMETERS];
} effect_number;
typedef void effect_quantity(const double *value, double at, effect_number *out);

/* ---- the search for an effect in measured runs ---- */

/* What the runs hold, as the plate moves in them. */
typedef struct effect_shown {
    double speeds; /* fastest over slowest mean speed of a stretch while it presses; HUGE_VAL where it stands
                      or turns back */
    double back;   /* furthest way back within a run, of the deepest */
    double depths; /* deepest over the least deep dwell or run, of those that press */
    bool again;    /* a specimen is pressed again */
    double rate;   /* samples a second of the slowest run */
    double stride; /* largest way between two samples, of the run where it is least, m */
} effect_shown;

/* What runs tell: longest run, typical time from sample to sample, largest depth, speed and force, sd of a
 * sample's white noise; the specimen's height. */
typedef struct effect_data {
    double duration, step, deepest, fastest, peak, white, height;
    size_t n_releases; /* at which a plate let go with a jump, */
    double pull[2];    /* and the pull there: the strongest recorded, and what would be too strong */
    double pulled; /* strongest pull that the runs record on withdrawal, and what noise hides at least; 0 = no
                      plate goes so far */
    effect_shown shown;
    double frame[2];  /* what runs on a rigid block show of the frame's compliance, an interval; 0, 0 = there
                         are none */
    const void *runs; /* of the next two */
    const double *residual; /* that a fit leaves of them; NULL: not asked for */
    /* Period, amplitude and phase of the strongest wave that the residual has over depth. */
    palp_status (*wave_in_depth)(const struct effect_data *data, double wave[3]);
    /* By how much a column changes within a run, at most; 0 where that is its noise, and where no run has it.
     */
    double (*change_of)(const struct effect_data *data, const char *column);
} effect_data;

enum { EFFECT_STARTS = 16 };

typedef struct effect_starts {
    palp_effect_id id;
    size_t n;
    palp_effect effect[EFFECT_STARTS];
} effect_starts;

void effect_start_at(effect_starts *starts, double a, double b, double c);
/* n of the second parameter, a time: from so many samples to twice the longest run, evenly in its logarithm.
 */
void effect_start_times(effect_starts *starts, const effect_data *data, double samples, size_t n);

/* What recordings must hold for an effect to be told at all, however strong it is; row->least says how much
 * of it. What is left of the effect beside the specimen's law is asked beside it. */
typedef enum effect_need {
    EFFECT_NEEDS_NOTHING,    /* what is left of it says all */
    EFFECT_NEEDS_RATES,      /* speeds that differ by a factor, a dwell, or a reversal */
    EFFECT_NEEDS_REVERSAL,   /* a way back, of the deepest */
    EFFECT_NEEDS_UNLOADING,  /* the same, or a specimen that is pressed again */
    EFFECT_NEEDS_WITHDRAWAL, /* until the force is gone */
    EFFECT_NEEDS_DEPTHS,     /* two depths, by a factor; or a way back through all of them */
    EFFECT_NEEDS_NYQUIST,    /* samples fast enough for its second parameter, a frequency, and so many of its
                                periods in a run */
    EFFECT_NEEDS_PERIODS,    /* room for so many periods of it in the travel, each of two samples at least */
    EFFECT_NEEDS_COLUMN,     /* its own column, which changes */
    EFFECT_NEEDS_WEIGHT      /* a known weight, which no recording of a press has */
} effect_need;

/* The interval of a parameter that is read off the data and not fitted. */
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
    bool bends;     /* the sensor's reading is no straight line over the force */
    effect_spectrum *spectrum;
    bool arm; /* it is one more arm: its parameters are K and tau */
    effect_arms *arms;
    effect_history *history;
    effect_quantity *spring;   /* factor of the spring's force at a strain rate of the plate, 1/s */
    effect_quantity *specimen; /* factor of all the specimen's force at a time of the session, s */
    effect_bonds *bond;        /* of a surface to the plate; one effect of a model at most */
    effect_quantity
        *foundation; /* stiffness that holds a network's nodes sideways at the plates over that of the
                      elements there, at = 0; by_value: of its logarithm. Held fast where the effect is off */
    effect_need need;
    double least;                                                       /* how much of it */
    palp_status (*starts)(const effect_data *data, effect_starts *out); /* NULL: one, with all values 0 */
    bool (*read)(const effect_data *data,
                 effect_read *out); /* NULL, or of its first parameter, if these runs show it */
    bool line;       /* a line of the spectrum whose phase is each run's own; at most one effect is */
    double scanned;  /* the search looks at so many periods or frequencies and takes the best; 0 = at one */
    bool of_runs;    /* each run has one of its own beside it: what can be told is their mean */
    bool as_scatter; /* may first look like scatter of the runs' gains or contacts */
} effect_row;

#define EFFECT_ALIKE(...)                                                                                    \
    .n_alike = sizeof((palp_effect_id[]){__VA_ARGS__}) / sizeof(palp_effect_id), .alike = {__VA_ARGS__}

#define EFFECT_ROW(NAME, id) extern const effect_row effect_##id;
PALP_EFFECTS(EFFECT_ROW)
#undef EFFECT_ROW

const effect_row *effect_row_of(palp_effect_id id); /* NULL outside the catalogue */

enum { EFFECT_LACK_MAX = 160 };

/* Whether the runs hold what the effect needs; if not, what they hold instead, with its number, and what
 * would do. */
bool effect_need_met(const effect_row *row, const effect_data *data, char lack[EFFECT_LACK_MAX]);

palp_effect_id
effect_line(void); /* the effect that is a line of the spectrum; PALP_EFFECT_COUNT: there is none */

/* Whether all strengths are zero. */
bool effect_is_off(const palp_effect *effect);

#endif
