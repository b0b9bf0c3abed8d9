/* realtime_make.h: networks that are stepped within a budget. */
#ifndef REALTIME_MAKE_H
#define REALTIME_MAKE_H

#include "network_make.h"

#include <palpate/palpate.h>

static const palp_budget ALL = {0};

static inline palp_realtime *realtime_on(palp_network *net, bool background) {
    palp_realtime_settings settings = palp_realtime_settings_default();
    palp_realtime *rt = NULL;
    settings.background = background;
    ck_assert_int_eq(palp_realtime_create(net, &settings, &rt), PALP_OK);
    return rt;
}

/* On its bottom, its top free for a tool that touches it so. */
static inline palp_realtime *cube_touched(size_t n, size_t n_arms, const palp_contact_settings *touch) {
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}};
    palp_network_settings settings = palp_network_settings_default();
    palp_material m = quartic(n_arms);
    palp_mesh *mesh = cube(n, PALP_NEIGHBOURS_26);
    palp_network *net = NULL;
    ck_assert_int_eq(palp_network_create(mesh, &m, 1, &bottom, &settings, &net, NULL), PALP_OK);
    palp_mesh_free(mesh);
    ck_assert_int_eq(palp_network_enable_tools(net, 1, 0, touch), PALP_OK);
    return realtime_on(net, false);
}

static inline palp_realtime *cube_on_a_table(size_t n, size_t n_arms) {
    palp_contact_settings touch = palp_contact_settings_default();
    return cube_touched(n, n_arms, &touch);
}

static inline palp_network *net_of(const palp_realtime *rt) {
    return palp_realtime_network(rt);
}

/* With its network. */
static inline void drop(palp_realtime *rt) {
    palp_network *net = net_of(rt);
    palp_realtime_free(rt);
    palp_network_free(net);
}

enum { TICKS = 160 };
static const double DT = 2e-3;

#endif
