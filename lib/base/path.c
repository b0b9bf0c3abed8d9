/* path.c: depth or, in creep, force of the plate over time, piecewise linear; paths of the protocols. */
#include <palpate/path.h>

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static double *duplicate_array(size_t n, const double *values) {
    double *copy = malloc(n * sizeof *copy);
    return copy ? memcpy(copy, values, n * sizeof *copy) : NULL;
}

static bool are_corners_valid(size_t n, const double *time_s, const double *values) {
    for (size_t i = 0; i < n; i++)
        if (!isfinite(time_s[i]) || !isfinite(values[i]) || (i > 0 && !(time_s[i] > time_s[i - 1])))
            return false;
    return n > 0 && n <= SIZE_MAX / sizeof(double);
}

static palp_status create_from_corners(size_t n, const double *time_s, const double *values, bool force,
                                       palp_path *path) {
    memset(path, 0, sizeof *path);
    if (!are_corners_valid(n, time_s, values))
        return PALP_ERR_ARGUMENT;
    double **slot = force ? &path->force_N : &path->depth_m;
    path->n = n;
    path->time_s = duplicate_array(n, time_s);
    *slot = duplicate_array(n, values);
    if (path->time_s && *slot)
        return PALP_OK;
    palp_path_free(path);
    return PALP_ERR_NO_MEMORY;
}

palp_status palp_path_create(size_t n, const double *time_s, const double *depth_m, palp_path *path) {
    if (!time_s || !depth_m || !path)
        return PALP_ERR_ARGUMENT;
    return create_from_corners(n, time_s, depth_m, false, path);
}

palp_status palp_path_static(double depth_m, double rate_m_s, palp_path *path) {
    if (!path)
        return PALP_ERR_ARGUMENT;
    double time_s[2] = {0, fabs(depth_m) / rate_m_s}, corner_m[2] = {0, depth_m};
    return create_from_corners(2, time_s, corner_m, false, path);
}

/* From 0 to value in ramp_s (at once if 0), then constant for hold_s (none if 0). */
static palp_status create_ramp_and_hold(double value, double ramp_s, double hold_s, bool force,
                                        palp_path *path) {
    memset(path, 0, sizeof *path);
    if (!(ramp_s >= 0) || !(hold_s >= 0))
        return PALP_ERR_ARGUMENT;
    double time_s[3] = {0, ramp_s, ramp_s + hold_s}, corner[3] = {0, value, value};
    size_t from = ramp_s > 0 ? 0u : 1u, to = hold_s > 0 ? 3u : 2u;
    return create_from_corners(to - from, time_s + from, corner + from, force, path);
}

palp_status palp_path_ramp_hold(double depth_m, double ramp_s, double hold_s, palp_path *path) {
    return path ? create_ramp_and_hold(depth_m, ramp_s, hold_s, false, path) : PALP_ERR_ARGUMENT;
}

palp_status palp_path_creep(double force_N, double ramp_s, double hold_s, palp_path *path) {
    return path ? create_ramp_and_hold(force_N, ramp_s, hold_s, true, path) : PALP_ERR_ARGUMENT;
}

palp_status palp_path_cyclic(double depth_m, double rate_m_s, size_t cycles, palp_path *path) {
    if (!path)
        return PALP_ERR_ARGUMENT;
    memset(path, 0, sizeof *path);
    double half_s = fabs(depth_m) / rate_m_s;
    if (cycles == 0 || cycles > SIZE_MAX / (4 * sizeof(double)) || !(half_s > 0) || !isfinite(half_s))
        return PALP_ERR_ARGUMENT;
    size_t n = 2 * cycles + 1;
    double *time_s = malloc(n * sizeof *time_s), *corner_m = malloc(n * sizeof *corner_m);
    palp_status status = PALP_ERR_NO_MEMORY;
    if (time_s && corner_m) {
        for (size_t i = 0; i < n; i++) {
            time_s[i] = (double)i * half_s;
            corner_m[i] = i % 2 ? depth_m : 0;
        }
        status = create_from_corners(n, time_s, corner_m, false, path);
    }
    free(time_s);
    free(corner_m);
    return status;
}

double palp_path_at(const palp_path *path, double t) {
    if (!path)
        return NAN;
    const double *time_s = path->time_s, *value = path->depth_m ? path->depth_m : path->force_N;
    if (path->n == 0)
        return 0;
    if (t <= time_s[0])
        return value[0];
    if (t >= time_s[path->n - 1])
        return value[path->n - 1];
    size_t low = 0, high = path->n - 1; /* time_s[low] < t < time_s[high] */
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (time_s[middle] <= t)
            low = middle;
        else
            high = middle;
    }
    return value[low] + (value[high] - value[low]) * ((t - time_s[low]) / (time_s[high] - time_s[low]));
}

void palp_path_free(palp_path *path) {
    if (!path)
        return;
    free(path->time_s);
    free(path->depth_m);
    free(path->force_N);
    memset(path, 0, sizeof *path);
}
