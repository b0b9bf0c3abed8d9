/* bench_self.c: time of a tick while two tissues are pressed on each other, over that of the same tissues
 * apart. Two lattices of 11 nodes a side, scaled as solids, with an arm, face to face but for a few
 * millimetres, in one network; three corrections a tick. The ratio is of medians. */
#include "bench.h"

#include <palpate/realtime.h>
#include <palpate/tool.h>

#include <math.h>
#include <stdio.h>

enum { NODES = 11, TICKS = 1500, KINDS = 3 };
static const char *const NAMES[KINDS] = {"apart, no self contact", "apart", "touching, with friction"};
static const double HEIGHT = 0.024, DT = 1e-3;

static palp_mesh *cube(void) {
    palp_mesh *mesh = NULL;
    bench_check(palp_mesh_lattice((size_t[]){NODES, NODES, NODES}, (double[]){HEIGHT, HEIGHT, HEIGHT},
                                  PALP_NEIGHBOURS_26, &mesh),
                "lattice");
    bench_check(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, 0.0, NULL), "scale");
    return mesh;
}

static palp_realtime *make(int kind) {
    const palp_support supports[] = {
        {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}},
        {"upper.top", {PALP_FIXED, PALP_DRIVEN, PALP_FIXED}, {0, -1, 0}},
    };
    const palp_network_settings settings = palp_network_settings_default();
    const palp_realtime_settings realtime = palp_realtime_settings_default();
    palp_contact_settings touch = palp_contact_settings_default();
    palp_material m = {.n_arms = 1, .arms = {{4.0, 0.4, 0, 0}}};
    palp_mesh *lower = cube(), *upper = cube(), *both = NULL;
    palp_network *net = NULL;
    palp_realtime *rt = NULL;
    touch.tissue = kind > 0;
    touch.tissue_friction = 0.2;
    bench_check(palp_law_polynomial(1, (double[]){8.18}, &m.law), "law");
    bench_check(palp_mesh_transform(upper, (double[]){1, 0, 0, 0, 1, 0, 0, 0, 1},
                                    (double[]){0.003, HEIGHT + (kind < 2 ? 0.02 : 0.0), 0.002}),
                "transform");
    bench_check(palp_mesh_join(lower, upper, "upper", &both), "join");
    bench_check(palp_network_create(both, &m, 2, supports, &settings, &net, NULL), "network");
    bench_check(palp_network_enable_tools(net, 0, 0, &touch), "tools");
    bench_check(palp_realtime_create(net, &realtime, &rt), "realtime");
    palp_mesh_free(lower);
    palp_mesh_free(upper);
    palp_mesh_free(both);
    return rt;
}

int main(void) {
    static double seconds[KINDS][TICKS];
    const palp_budget budget = {.corrections = 3};
    palp_realtime *rt[KINDS];
    palp_tick_info info;
    size_t corrections[KINDS] = {0}, contacts;
    for (int kind = 0; kind < KINDS; kind++)
        rt[kind] = make(kind);
    for (int i = 0; i < TICKS; i++)
        for (int kind = 0; kind < KINDS; kind++) {
            const double depth = 3e-3 * fmin(1.0, DT * i) * (1.0 + 0.2 * sin(6.0 * DT * i));
            bench_check(palp_realtime_step(rt[kind], depth, DT, &budget, &info), "tick");
            seconds[kind][i] = info.seconds;
            corrections[kind] += info.corrections;
        }
    printf("%-26s %9s %9s %12s %12s\n", "two tissues", "contacts", "median", "corrections", "over apart");
    double first = 0.0;
    for (int kind = 0; kind < KINDS; kind++) {
        palp_network *net = palp_realtime_network(rt[kind]);
        const double median = bench_median(seconds[kind], TICKS);
        first = kind == 0 ? median : first;
        palp_network_contacts(net, 0, NULL, &contacts);
        printf("%-26s %9zu %6.3f ms %12.1f %12.2f\n", NAMES[kind], contacts, 1e3 * median,
               (double)corrections[kind] / TICKS, median / first);
        palp_realtime_free(rt[kind]);
        palp_network_free(net);
    }
    return 0;
}
