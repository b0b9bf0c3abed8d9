/* segments.h: what the path and the force of a recording tell before any model: noise, air, contact, phases.
 * Lengths are in any one unit, which results are then in too; arrays are the caller's and only read. */
#ifndef PALPATE_SEGMENTS_H
#define PALPATE_SEGMENTS_H

#include <palpate/export.h>
#include <palpate/status.h>
#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How the noise of one sample is told from the second differences of the force. */
typedef enum palp_noise_rule {
    PALP_NOISE_MEDIAN, /* by their median; from a coarse converter by the mean square of all but the largest 1 % */
    PALP_NOISE_TRIMMED /* by the mean square of all but the largest 5 % */
} palp_noise_rule;

/* *sd: of the white noise of a sample of force_N[n]; 0 if fewer than three samples tell it. Where time_s is not NULL,
 * differences across three time steps of step_s and more (a gap) do not count. ERR_NO_MEMORY. */
PALP_API palp_status palp_segments_noise(size_t n, const double *time_s, double step_s, const double *force_N,
                                         palp_noise_rule rule, double *sd);

/* What the plate does at a sample. */
typedef enum palp_phase {
    PALP_PHASE_AIR, PALP_PHASE_RAMP, PALP_PHASE_CORNER, PALP_PHASE_EARLY_DWELL, PALP_PHASE_LATE_DWELL,
    PALP_PHASE_UNLOAD, PALP_PHASE_RECOVERY, PALP_PHASE_RELOAD, PALP_PHASE_COUNT
} palp_phase;

PALP_API const char *palp_phase_name(palp_phase phase); /* "air", "early_dwell", ...; "unknown" */

/* phase[n]: a palp_phase for each sample of a path whose depth 0 is contact, n >= 2. A corner lasts 0.2 s, a dwell is
 * early for its first 5 s, and the air after the first touch is recovery. */
PALP_API void palp_segments_phases(size_t n, const double *time_s, const double *depth, unsigned char *phase);

/* A press whose contact is not known: its depth may start anywhere and either way may be into the specimen. */
typedef struct palp_press {
    size_t n;
    const double *time_s, *depth, *force_N; /* [n] the caller's */
    double *mean_N;                         /* [n] running mean of the force; owned */
    size_t window;                          /* samples in it */
    size_t peak;                            /* where it is furthest from its start */
    double noise_N;                         /* sd of a sample */
} palp_press;

/* The force in the air before contact. */
typedef struct palp_air {
    double level_N, drift_N_s; /* straight line through the force at time 0 */
    double sd_N;               /* of the running mean about that line */
    size_t contact;            /* the first sample after the air; the press' peak if there is none */
    double contact_sd;         /* how exact its depth is */
} palp_air;

/* n >= 3; palp_press_free. ERR_NO_MEMORY. */
PALP_API palp_status palp_press_create(size_t n, const double *time_s, const double *depth, const double *force_N,
                                       palp_press *press);
PALP_API void palp_press_free(palp_press *press); /* frees what is owned, zeroes; NULL is fine */

/* Finds the air. A search for the contact (approach) is nearly all air, and its load cell may drift meanwhile; of
 * another recording only the first samples are surely air. */
PALP_API palp_air palp_press_air(const palp_press *press, bool approach);
PALP_API double palp_air_force(const palp_air *air, double time_s); /* N */

/* Whether the force of the first samples does not trend. */
PALP_API bool palp_press_starts_in_air(const palp_press *press);

/* Samples at the start before the plate moves. */
PALP_API size_t palp_press_rest(const palp_press *press);

/* The travel that a force stands for, by the slope of the first twentieth of the press; 0 if the force never changes. */
PALP_API double palp_press_travel(const palp_press *press, double force_N);

#ifdef __cplusplus
}
#endif
#endif
