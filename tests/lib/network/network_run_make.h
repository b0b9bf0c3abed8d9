/* network_run_make.h: networks that follow a path, and what is recorded of it. */
#ifndef NETWORK_RUN_MAKE_H
#define NETWORK_RUN_MAKE_H

#include "network/network_internal.h"
#include "network_make.h"

static inline palp_network *heavy_on(size_t n_arms, palp_integrator integrator, palp_branch branch,
                                     double radius) {
    palp_material m = quartic(n_arms);
    palp_network_settings settings = palp_network_settings_default();
    settings.density_kg_m3 = 1070.0;
    settings.integrator = integrator;
    settings.branch = branch;
    settings.spectral_radius = radius;
    return cube_network(3, &m, &settings);
}

static inline palp_network *heavy(size_t n_arms, palp_integrator integrator) {
    return heavy_on(n_arms, integrator, PALP_BRANCH_CONTINUE, 0.5);
}

/* What a run showed. */
enum { RECORD_MAX = 20000 };
typedef struct record {
    size_t n, stop_after; /* stop_after 0: never */
    double time[RECORD_MAX], depth[RECORD_MAX], force[RECORD_MAX];
} record;

static inline int take(void *user, double time_s, double depth_m, double force_N) {
    record *r = user;
    if (r->n == RECORD_MAX)
        return 1;
    r->time[r->n] = time_s;
    r->depth[r->n] = depth_m;
    r->force[r->n++] = force_N;
    return r->n == r->stop_after;
}

static record seen; /* too large for the stack */

static inline palp_run_settings recording(double dt, double tolerance) {
    seen.n = seen.stop_after = 0;
    return (palp_run_settings){.dt_s = dt, .tolerance = tolerance, .observer = take, .user = &seen};
}

/* Runs and frees the path. */
static inline palp_run_info run_path(palp_network *net, palp_path path, const palp_run_settings *settings) {
    palp_run_info info;
    palp_status status = palp_network_run(net, &path, settings, &info);
    ck_assert_msg(!status, "%s after %zu steps", palp_status_name(status), info.steps);
    palp_path_free(&path);
    return info;
}

static inline palp_path ramp_hold(double strain, double ramp, double hold) {
    palp_path path;
    ck_assert_int_eq(palp_path_ramp_hold(strain * HEIGHT, ramp, hold, &path), PALP_OK);
    return path;
}

#endif
