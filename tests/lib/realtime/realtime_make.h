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
