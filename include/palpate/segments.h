/* segments.h: noise, air, contact and phases of a recording, from its path and force alone, before any
 * model. Lengths are in any one unit, in which the results are too. Arrays are the caller's and only read.
 * May change. */
#ifndef PALPATE_SEGMENTS_H
#define PALPATE_SEGMENTS_H

#include <palpate/export.h>
#include <palpate/status.h>
#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How the noise of one sample is estimated from the second differences of the force. */
typedef enum palp_noise_rule {
    PALP_NOISE_MEDIAN, /* from their median; for a coarse converter from the mean square of all but the
                          largest 1 % */
    PALP_NOISE_TRIMMED /* from the mean square of all but the largest 5 % */
} palp_noise_rule;

/* *sd: standard deviation of the white noise of a sample of force_N[n]; 0 with fewer than three usable
 * samples. If time_s is not NULL, steps may differ, and a second difference over 3 step_s or more (a gap)
 * does not count. ERR_NO_MEMORY. */
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

/* phase[n]: the palp_phase of each sample of a path whose depth 0 is contact, n >= 2, from its pieces
 * (below). A corner lasts a fifth of the motion that begins or ends at it. A dwell is early for five times
 * the duration of the motion before it. The air after the first contact is recovery. If force_N is not NULL,
 * creep (palp_segments_creep) is a dwell too. ERR_ARGUMENT, ERR_NO_MEMORY. */
PALP_API palp_status palp_segments_phases(size_t n, const double *time_s, const double *depth,
                                          const double *force_N, unsigned char *phase);

/* What the plate does over a stretch of its path. It is found from the path, not from the protocol. */
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

/* The pieces of a path whose depth 0 is contact, n >= 2, from the path alone; the result does not depend on
 * the units of depth and time. The plate is at rest if it moves by less than 0.5 % of the path's range, or 15
 * sds of the depth's noise. This must last at least a sixth of the duration of the motion before.
 * palp_pieces_free. ERR_ARGUMENT, ERR_NO_MEMORY. */
PALP_API palp_status palp_segments_pieces(size_t n, const double *time_s, const double *depth,
                                          palp_pieces *pieces);

/* Stretches of creep after a ramp, each a PALP_MOTION_DWELL. The force is constant, as the depth is in a
 * dwell. The depth grows by more than 1 % of its range, at less than half of the ramp's speed.
 * palp_pieces_free. ERR_ARGUMENT, ERR_NO_MEMORY. */
PALP_API palp_status palp_segments_creep(size_t n, const double *time_s, const double *depth,
                                         const double *force_N, palp_pieces *creep);
PALP_API void palp_pieces_free(palp_pieces *pieces); /* frees what is owned, zeroes; NULL is fine */

/* *step_s: the clock's step, of which nearly all differences of time_s[n] are multiples. *missing: samples
 * that are missing on that clock. Without such a clock the median difference and 0. ERR_ARGUMENT,
 * ERR_NO_MEMORY. */
PALP_API palp_status palp_segments_clock(size_t n, const double *time_s, double *step_s, size_t *missing);

/* The path of a plate whose recorded depth has white noise, in place of depth[n]: a Kalman smoother with
 * white acceleration (Wahba 1978), of the most likely intensity. All that follow a recorded path follow this
 * one. *noise: the sd; 0 = none beyond an encoder's steps, and the depth stays to the bit. The times
 * increase. ERR_ARGUMENT, ERR_NO_MEMORY. */
PALP_API palp_status palp_segments_smooth_path(size_t n, const double *time_s, double *depth, double *noise);

/* A press whose contact is not known. Its depth may start anywhere, and either direction may be into the
 * specimen. */
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
    bool seen; /* the plate moved through air, by more than 3 sds of the contact; for an approach: it touched
                */
} palp_air;

/* n >= 3; palp_press_free. ERR_NO_MEMORY. */
PALP_API palp_status palp_press_create(size_t n, const double *time_s, const double *depth,
                                       const double *force_N, palp_press *press);
PALP_API void palp_press_free(palp_press *press); /* frees what is owned, zeroes; NULL is fine */

/* Finds the air before contact. In a search for the contact (approach) nearly all is air, in which the load
 * cell may drift; contact is where the force leaves the straight line of the air. In other recordings only
 * the dwell at the start, or the first samples, count as air. Contact is then extrapolated from the first
 * sixth of the force, for a force that rises with the power 1, 1.5 or 2 of depth; the three are weighted by
 * their likelihood. */
PALP_API palp_air palp_press_air(const palp_press *press, bool approach);
PALP_API double palp_air_force(const palp_air *air, double time_s); /* N */

/* Whether the force of the first samples does not trend. */
PALP_API bool palp_press_starts_in_air(const palp_press *press);

/* Samples at the start before the plate moves. */
PALP_API size_t palp_press_rest(const palp_press *press);

/* The travel that corresponds to a force, by the slope of the first twentieth of the press; 0 if the force
 * never changes. */
PALP_API double palp_press_travel(const palp_press *press, double force_N);

#ifdef __cplusplus
}
#endif
#endif
