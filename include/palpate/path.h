/* path.h: the depth of the plate, or in creep its force, against time, piecewise linear. Stable. */
#ifndef PALPATE_PATH_H
#define PALPATE_PATH_H

#include <palpate/export.h>
#include <palpate/status.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* n corners at increasing times; linear between them. Owns its arrays; free with palp_path_free.
 * A creep path holds force instead of depth: force_N, with depth_m NULL. */
typedef struct palp_path {
    size_t n;
    double *time_s;
    double *depth_m;
    double *force_N;
} palp_path;

/* Copies n corners. ERR_ARGUMENT: n = 0, a number that is not finite, times not increasing; ERR_NO_MEMORY.
 * *path is then empty. */
PALP_API palp_status palp_path_create(size_t n, const double *time_s, const double *depth_m, palp_path *path);

/* The makers below give a path from time 0, which the caller frees. ERR_ARGUMENT: a number that is not finite
 * or out of the range given; ERR_NO_MEMORY. 0 to depth_m (not 0; negative = away from the specimen) at
 * rate_m_s > 0. */
PALP_API palp_status palp_path_static(double depth_m, double rate_m_s, palp_path *path);

/* 0 to depth_m in ramp_s (0 = there at once: the path starts at depth_m), then held for hold_s
 * (0 = no hold). */
PALP_API palp_status palp_path_ramp_hold(double depth_m, double ramp_s, double hold_s, palp_path *path);

/* cycles times 0 to depth_m and back at rate_m_s. */
PALP_API palp_status palp_path_cyclic(double depth_m, double rate_m_s, size_t cycles, palp_path *path);

/* Force raised from 0 to force_N in ramp_s (0 = at once), then held for hold_s. */
PALP_API palp_status palp_path_creep(double force_N, double ramp_s, double hold_s, palp_path *path);

/* Depth, m (of a creep path force, N), at time t, s; before the path its first value, after it its last. */
PALP_API double palp_path_at(const palp_path *path, double t);

PALP_API void palp_path_free(palp_path *path); /* frees the arrays and zeroes the struct; NULL is fine */

#ifdef __cplusplus
}
#endif
#endif
