/* segments.h: what the path and the force of a recording tell before any model: noise, air, contact, phases.
 * Lengths are in any one unit, which results are then in too; arrays are the caller's and only read. May change. */
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
    PALP_NOISE_MEDIAN, /* by their median; from a coarse converter by the mean square of all but the largest 1
                          % */
    PALP_NOISE_TRIMMED /* by the mean square of all but the largest 5 % */
} palp_noise_rule;

/* *sd: of the white noise of a sample of force_N[n]; 0 if fewer than three samples tell it. Where time_s is
 * not NULL, steps may differ, and differences across three time steps of step_s and more (a gap) do not
 * count. ERR_NO_MEMORY. */
PALP_API palp_status palp_segments_noise(size_t n, const double *time_s, double step_s, const double *force_N,
                                         palp_noise_rule rule, double *sd);

/* What the plate does at a sample. */
typedef enum palp_phase {
    PALP_PHASE_AIR,
    PALP_PHASE_RAMP,
    PALP_PHASE_CORNER,
    PALP_PHASE_EARLY_DWELL,
    PALP_PHASE_LATE_DWELL,
    PALP_PHASE_UNLOAD,
    PALP_PHASE_RECOVERY,
    PALP_PHASE_RELOAD,
    PALP_PHASE_COUNT
} palp_phase;

PALP_API const char *palp_phase_name(palp_phase phase); /* "air", "early_dwell", ...; "unknown" */

/* phase[n]: a palp_phase for each sample of a path whose depth 0 is contact, n >= 2, by its pieces (below). A
 * corner lasts a fifth of the motion that begins or ends at it, a dwell is early for five times the motion
 * before it, and the air after the first touch is recovery. Where force_N is not NULL, a force that is held
 * while the depth goes on is a dwell, too (palp_segments_creep). ERR_ARGUMENT, ERR_NO_MEMORY. */
PALP_API palp_status palp_segments_phases(size_t n, const double *time_s, const double *depth,
                                          const double *force_N, unsigned char *phase);

/* What the plate does over a stretch of its path, whatever it was asked to do. */
typedef enum palp_motion {
    PALP_MOTION_REST,     /* stands still in the air or where it touches */
    PALP_MOTION_APPROACH, /* moves through the air towards the specimen */
    PALP_MOTION_RAMP,
    PALP_MOTION_DWELL,
    PALP_MOTION_UNLOAD,
    PALP_MOTION_CYCLE, /* two cycles and more without a dwell, of about one length */
    PALP_MOTION_SWEEP, /* cycles that become shorter or longer, the last by half of the first and more */
    PALP_MOTION_COUNT
} palp_motion;

PALP_API const char *palp_motion_name(palp_motion motion); /* "rest", "approach", ...; "unknown" */

typedef struct palp_piece {
    palp_motion motion;
    size_t first, last; /* samples; a piece begins with the sample that the one before ends with */
} palp_piece;

typedef struct palp_pieces {
    size_t n;
    palp_piece *piece; /* [n] owned */
} palp_pieces;

/* The pieces of a path whose depth 0 is contact, n >= 2, by the path alone: nothing follows from the unit of
 * depth or time. A stretch counts as still that moves by less than 0.5 % of the path's range, or 15 sds of
 * the depth's noise, and lasts a sixth of the motion before it. palp_pieces_free. ERR_ARGUMENT,
 * ERR_NO_MEMORY. */
PALP_API palp_status palp_segments_pieces(size_t n, const double *time_s, const double *depth,
                                          palp_pieces *pieces);

/* Stretches of creep, each a PALP_MOTION_DWELL: from a ramp on the force stands still as a depth does in a
 * dwell, and the depth goes on by over 1 % of its range, at less than half of the ramp's speed.
 * palp_pieces_free. ERR_ARGUMENT, ERR_NO_MEMORY. */
PALP_API palp_status palp_segments_creep(size_t n, const double *time_s, const double *depth,
                                         const double *force_N, palp_pieces *creep);
PALP_API void palp_pieces_free(palp_pieces *pieces); /* frees what is owned, zeroes; NULL is fine */

/* *step_s: the clock's step, of which nearly all differences of time_s[n] are multiples, and how many samples
 * are missing on it; the median difference and 0 if there is no such clock. ERR_ARGUMENT, ERR_NO_MEMORY. */
PALP_API palp_status palp_segments_clock(size_t n, const double *time_s, double *step_s, size_t *missing);

/* A press whose contact is not known: its depth may start anywhere and either way may be into the specimen.
 */
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
    double level_N, drift_N_s;        /* straight line through the force at time 0 */
    double sd_N;                      /* of the running mean about that line */
    size_t contact;                   /* the first sample after the air; the press' peak if there is none */
    double contact_depth, contact_sd; /* depth of the contact, and how exact it is */
    bool seen; /* the plate moved through air before: by more than 3 sds of the contact; an approach: it
                  touched */
} palp_air;

/* n >= 3; palp_press_free. ERR_NO_MEMORY. */
PALP_API palp_status palp_press_create(size_t n, const double *time_s, const double *depth,
                                       const double *force_N, palp_press *press);
PALP_API void palp_press_free(palp_press *press); /* frees what is owned, zeroes; NULL is fine */

/* Finds the air. A search for the contact (approach) is nearly all air, and its load cell may drift
 * meanwhile; its contact is where the force leaves the air. Of another recording only its rest, or its first
 * samples, are surely air; its contact is where a force that rises with depth, its power 1.5 or 2 leads back
 * to, by the first sixth of the force. */
PALP_API palp_air palp_press_air(const palp_press *press, bool approach);
PALP_API double palp_air_force(const palp_air *air, double time_s); /* N */

/* Whether the force of the first samples does not trend. */
PALP_API bool palp_press_starts_in_air(const palp_press *press);

/* Samples at the start before the plate moves. */
PALP_API size_t palp_press_rest(const palp_press *press);

/* The travel that a force stands for, by the slope of the first twentieth of the press; 0 if the force never
 * changes. */
PALP_API double palp_press_travel(const palp_press *press, double force_N);

#ifdef __cplusplus
}
#endif
#endif
