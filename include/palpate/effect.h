/* effect.h: the catalogue of effects: what can be added to the plain model of a specimen (a nonlinear
 * spring beside Maxwell arms, pressed by a rigid, frictionless, exact instrument). The equations are in
 * doc/effects.md. Stable. */
#ifndef PALPATE_EFFECT_H
#define PALPATE_EFFECT_H

#include <palpate/export.h>
#include <palpate/status.h>
#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The registry of effects, X(NAME, id), in the order of the catalogue; the row of each is in its own file
 * lib/effect/id.c. */
#define PALP_EFFECTS(X)                                                                                      \
    X(RELAXATION_ARM, relaxation_arm)                                                                        \
    X(POWER_LAW_RELAXATION, power_law_relaxation)                                                            \
    X(STRAIN_DEPENDENT_ARM, strain_dependent_arm)                                                            \
    X(RATE_STIFFENING, rate_stiffening)                                                                      \
    X(DAMAGE_SOFTENING, damage_softening)                                                                    \
    X(PERMANENT_SET, permanent_set)                                                                          \
    X(POROELASTIC, poroelastic)                                                                              \
    X(CONTACT_OFFSET, contact_offset)                                                                        \
    X(TOE_REGION, toe_region)                                                                                \
    X(ADHESION, adhesion)                                                                                    \
    X(PLATE_SLIP, plate_slip)                                                                                \
    X(SESSION_AGEING, session_ageing)                                                                        \
    X(FRAME_COMPLIANCE, frame_compliance)                                                                    \
    X(PLATE_INERTIA, plate_inertia)                                                                          \
    X(COULOMB_FRICTION, coulomb_friction)                                                                    \
    X(SENSOR_LAG, sensor_lag)                                                                                \
    X(SENSOR_BIAS, sensor_bias)                                                                              \
    X(SENSOR_DRIFT, sensor_drift)                                                                            \
    X(SENSOR_GAIN, sensor_gain)                                                                              \
    X(FORCE_SATURATION, force_saturation)                                                                    \
    X(MAINS_HUM, mains_hum)                                                                                  \
    X(DRIVE_RIPPLE, drive_ripple)                                                                            \
    X(THERMAL_EXPANSION, thermal_expansion)

typedef enum palp_effect_id {
#define PALP_EFFECT_MEMBER(NAME, id) PALP_EFFECT_##NAME,
    PALP_EFFECTS(PALP_EFFECT_MEMBER)
#undef PALP_EFFECT_MEMBER
        PALP_EFFECT_COUNT
} palp_effect_id;

/* Where an effect acts. */
typedef enum palp_effect_place {
    PALP_EFFECT_SPECIMEN, /* the material: in a network every element has it */
    PALP_EFFECT_CONTACT,  /* between the specimen and the plates */
    PALP_EFFECT_FRAME,    /* the instrument's drive and frame */
    PALP_EFFECT_SENSOR    /* the instrument's force sensor */
} palp_effect_place;

/* Which quantity of a recording the typical size of a parameter is proportional to. */
typedef enum palp_effect_scale {
    PALP_SCALE_NONE,
    PALP_SCALE_TIME,       /* its duration */
    PALP_SCALE_LENGTH,     /* its depth */
    PALP_SCALE_FORCE,      /* its force */
    PALP_SCALE_FORCE_1_S,  /* its force one second after the load; it decays as a power of time */
    PALP_SCALE_FORCE_RATE, /* force over duration */
    PALP_SCALE_COMPLIANCE, /* depth over force */
    PALP_SCALE_MASS,       /* force over depth, times duration twice */
    PALP_SCALE_RATE,       /* one over the duration of the session */
    PALP_SCALE_STRAIN_RATE /* speed over height */
} palp_effect_scale;

enum { PALP_EFFECT_PARAMETERS = 3, PALP_EFFECTS_MAX = 8 };

/* One parameter: its key in the model file (with its unit), and SI units inside. */
typedef struct palp_effect_parameter {
    const char *key;  /* "compliance_mm_N" */
    double unit;      /* SI per file unit: 1e-3 m/N per mm/N */
    double low, high; /* bounds of the value in a file, SI; a search may use narrower ones */
    double typical;   /* default of a parameter that is not the strength of the effect, SI */
    palp_effect_scale scale;
    bool logarithmic; /* searched in its logarithm: a time, a length */
    bool strength; /* the effect is off when all of its strengths are zero, whatever its other parameters */
    bool optional; /* a file may leave it out: it is 0 then */
} palp_effect_parameter;

/* What the catalogue says of an effect. */
typedef struct palp_effect_info {
    const char *id;
    palp_effect_place place;
    const char *name;    /* "frame compliance" */
    const char *means;   /* what it does, a sentence */
    const char *seen_by; /* what an experiment must contain to see it */
    size_t n_parameters;
    palp_effect_parameter parameter[PALP_EFFECT_PARAMETERS];
    size_t n_alike;
    palp_effect_id alike[4];    /* [n_alike] its look-alikes */
    bool in_lumped, in_network; /* which models can carry it */
    bool repeats;               /* a model may have it more than once */
    const char *column;         /* "temperature_C": column of a recording that it reads; NULL = none */
} palp_effect_info;

/* One effect with its numbers, SI; a plain value. */
typedef struct palp_effect {
    palp_effect_id id;
    double value[PALP_EFFECT_PARAMETERS];
} palp_effect;

/* NULL for a number outside the catalogue. */
PALP_API const palp_effect_info *palp_effect_look_up(palp_effect_id id);
PALP_API palp_status palp_effect_parse(const char *id, palp_effect_id *found); /* ERR_ARGUMENT */

/* The effect at its typical parameters with strength zero. ERR_ARGUMENT. */
PALP_API palp_status palp_effect_default(palp_effect_id id, palp_effect *effect);

/* ERR_ARGUMENT with a line that names the parameter that is out of its bounds or not finite. */
PALP_API palp_status palp_effect_check(const palp_effect *effect, palp_error *error);

#ifdef __cplusplus
}
#endif
#endif
