/* free_term.h: a part of a model outside the catalogue of effects: a force that depends on the plate's path,
 * as a table with its uncertainty. palpate explain finds it. Stable. */
#ifndef PALPATE_FREE_TERM_H
#define PALPATE_FREE_TERM_H

#include <stddef.h>

#include <palpate/status.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { PALP_FREE_NODES = 12, PALP_FREE_TERMS = 4 };

/* What the force depends on. The grid is even in the coordinate of the kind: */
typedef enum palp_free_kind {
    PALP_FREE_LOADING,       /* strain, depth over height, on the way in */
    PALP_FREE_UNLOADING,     /* the same on the way out */
    PALP_FREE_DWELL,         /* log of the time for which the plate has been at rest, s; in proportion to the
                                depth */
    PALP_FREE_RUN,           /* time since the first sample, s */
    PALP_FREE_EARLY,         /* its logarithm */
    PALP_FREE_AGEING,        /* time since the first sample, s; in proportion to the force of the plate */
    PALP_FREE_SPEED,         /* asinh(speed / slow_m_s), positive on the way in */
    PALP_FREE_PRESSED_SPEED, /* the same, in proportion to the depth */
    PALP_FREE_TURN,          /* way since the plate last turned, m; in proportion to the depth, and with the
                                sign of the motion */
    PALP_FREE_SESSION,       /* time in the session, s */
    PALP_FREE_PLACE,         /* the recorded depth, m, in air too */
    PALP_FREE_GAIN,          /* the recorded depth, m; in proportion to the force of the plate */
    PALP_FREE_RESPONSE,      /* time since a change of the plate's speed, s, in air too; the sum over all
                                changes, each in proportion to its size. It ends at to, with 0 */
    PALP_FREE_KINDS
} palp_free_kind;

/* How it acts. */
typedef enum palp_free_class {
    PALP_FREE_ELASTIC,     /* the same on the way in and out */
    PALP_FREE_DISSIPATIVE, /* it depends on the direction, the speed or the time in a dwell */
    PALP_FREE_CLOCK,       /* on the time in the run, in air too */
    PALP_FREE_AGE,         /* on the time in the run, while something is pressed */
    PALP_FREE_OF_SESSION,
    PALP_FREE_OF_PLACE,
    PALP_FREE_CLASSES
} palp_free_class;

/* The force is the natural cubic spline through force_N at PALP_FREE_NODES places from .. to, and constant
 * beyond them. */
typedef struct palp_free_term {
    palp_free_kind kind;
    palp_free_class does;
    double from, to; /* in the coordinate of the kind */
    double depth_m;  /* at which a force in proportion to the depth is that of the table; of a RESPONSE,
                        depth_m / to is the change of speed to which the table belongs */
    double slow_m_s; /* of a speed */
    double plate_N;  /* of a factor on the force of the plate: the force at which the table holds; otherwise
                        0 */
    double force_N[PALP_FREE_NODES], sd_N[PALP_FREE_NODES];
} palp_free_term;

PALP_API const char *palp_free_kind_name(palp_free_kind kind);     /* "depth_loading", ... */
PALP_API const char *palp_free_class_name(palp_free_class class_); /* "elastic", ... */

/* ERR_ARGUMENT: it is no term: an unknown kind or class, from not below to, or a number that is out of
 * bounds. */
PALP_API palp_status palp_free_term_check(const palp_free_term *term);

/* What the force depends on at this share of the grid, 0 to 1: strain, s, m/s or m. NAN: no term. */
PALP_API double palp_free_term_coordinate(const palp_free_term *term, double share);

#ifdef __cplusplus
}
#endif
#endif
