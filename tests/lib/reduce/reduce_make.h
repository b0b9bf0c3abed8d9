/* reduce_make.h: reduced models of small networks. */
#ifndef REDUCE_MAKE_H
#define REDUCE_MAKE_H

#include "network_make.h"
#include "reduce/reduce_internal.h"

static const double RADIUS = 0.008; /* m, of the ball */

/* A block on its bottom, its top free, that a ball may touch. */
static inline palp_network *block(size_t n, const palp_material *m) {
    palp_network_settings settings = palp_network_settings_default();
    palp_contact_settings touch = palp_contact_settings_default();
    touch.local = false;
    palp_support supports[2];
    palp_mesh *mesh = cube(n, PALP_NEIGHBOURS_26);
    palp_network *net = NULL;
    settings.tolerance = 1e-8;
    palp_supports_default(supports);
    ck_assert_int_eq(palp_network_create(mesh, m, 1, supports, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(net, 1, 0, &touch), PALP_OK);
    palp_mesh_free(mesh);
    return net;
}

/* A ball over (x, z) whose lowest point is at this depth below the top at rest. */
static inline palp_tool ball(double x, double z, double depth) {
    return (palp_tool){
        .shape = PALP_TOOL_SPHERE, .position_m = {x, HEIGHT + RADIUS - depth, z}, .radius_m = RADIUS};
}

static inline palp_snapshots *record(palp_network *net, const palp_tool_path *path) {
    palp_snapshots *snapshots = NULL;
    palp_error error = {PALP_OK, ""};
    palp_status status = palp_snapshots_record(net, NULL, path, NULL, NULL, &snapshots, &error);
    ck_assert_msg(!status, "%s", error.text);
    return snapshots;
}

/* The plate: down to depth at rate, held, up. */
static inline palp_snapshots *press(palp_network *net, double depth, double rate, double hold) {
    enum { N = 12 };
    double time[3 * N], travel[3 * N], t = 0.0;
    for (size_t i = 0; i < 3 * N; i++) {
        t += i / N == 1 ? hold / N : depth / rate / N;
        time[i] = t;
        travel[i] = i / N == 0   ? depth * (double)(i + 1) / N
                    : i / N == 1 ? depth
                                 : depth * (double)(3 * N - 1 - i) / N;
    }
    return record(net, &(palp_tool_path){.n = 3 * N, .time_s = time, .depth_m = travel});
}

/* The ball: down at (x0, z0), across to (x1, z1). */
static inline palp_snapshots *slide(palp_network *net, double x0, double z0, double x1, double z1,
                                    double depth) {
    enum { DOWN = 6, N = 16 };
    double time[N];
    palp_tool tools[N];
    for (size_t i = 0; i < N; i++) {
        double down = fmin((double)(i + 1) / DOWN, 1.0),
               over = i < DOWN ? 0.0 : (double)(i + 1 - DOWN) / (N - DOWN);
        time[i] = 0.05 * (double)(i + 1);
        tools[i] = ball(x0 + over * (x1 - x0), z0 + over * (z1 - z0), depth * down);
    }
    return record(net, &(palp_tool_path){.n = N, .time_s = time, .n_tools = 1, .tools = tools});
}

static inline palp_reduced *reduce(palp_network *net, size_t n, palp_snapshots *const *snapshots,
                                   size_t n_held_out, palp_snapshots *const *held_out,
                                   const palp_reduce_settings *settings) {
    palp_reduced *reduced = NULL;
    palp_error error = {PALP_OK, ""};
    palp_status status =
        palp_reduced_create(net, n, snapshots, n_held_out, held_out, settings, &reduced, NULL, &error);
    ck_assert_msg(!status, "%s", error.text);
    return reduced;
}

static inline void free_all(size_t n, palp_snapshots **snapshots) {
    for (size_t i = 0; i < n; i++)
        palp_snapshots_free(snapshots[i]);
}

/* One tick of a plate and a ball for the tests below. */
static inline palp_status tick(palp_reduced *reduced, int i, palp_tool_force *force,
                               palp_reduced_info *info) {
    palp_tool tool = ball(0.010 + 0.00002 * i, 0.011, 0.00004 * i - 0.0001);
    return palp_reduced_step(reduced, 0.0, 1, &tool, 0.001, force, info);
}

static inline palp_reduced *under_a_ball(palp_network **net) {
    palp_material m = quartic(2);
    *net = block(5, &m);
    palp_snapshots *paths[] = {slide(*net, 0.009, 0.009, 0.015, 0.012, 0.001),
                               slide(*net, 0.009, 0.014, 0.014, 0.01, 0.001)};
    palp_reduce_settings settings = palp_reduce_settings_default();
    settings.modes = 12;
    settings.static_modes = 3;
    settings.elements = 150;
    palp_reduced *reduced = reduce(*net, 1, paths, 1, paths + 1, &settings);
    ck_assert_uint_ge(palp_reduced_describe(reduced).modes, 8);
    free_all(2, paths);
    return reduced;
}

#endif
