/* bench_regions.c: time of a tick of a network with three regions over that of the same network without. It
 * is measured too where the surface may also touch itself. A sphere slides and presses on a lattice of 11
 * nodes a side, scaled as a solid, with two arms. The networks tick in turn, with the same corrections; the
 * ratio is of medians. */
#include "bench.h"

#include <palpate/realtime.h>
#include <palpate/tool.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NODES = 11, TICKS = 1500, KINDS = 6, REGIONS = 3 };
static const char *const NAMES[KINDS] = {"none",
                                         "three, stiffer by a factor",
                                         "three, materials of their own",
                                         "three by a factor, self contact",
                                         "three of their own, self contact",
                                         "three by a factor, with fibres"};
static const double HEIGHT = 0.024, DT = 1e-3;

static palp_material tissue(double factor) {
    palp_material m = {.n_arms = 2,
                       .arms = {{4.0 * factor, 0.4 * factor, 0, 0}, {2.0 * factor, 2.0 * factor, 0, 0}}};
    const double law[] = {8.18 * factor, -0.70 * factor, 47.47 * factor};
    bench_check(palp_law_polynomial(3, law, &m.law), "law");
    return m;
}

/* A skin, a nodule and a layer at the bottom. */
static void choose_regions(int kind, palp_region region[REGIONS]) {
    memset(region, 0, REGIONS * sizeof *region);
    for (int r = 0; r < REGIONS; r++) {
        snprintf(region[r].name, sizeof region[r].name, "region %d", r);
        region[r].shape = r == 1 ? PALP_REGION_SPHERE : PALP_REGION_BOX;
        region[r].low_m[0] = region[r].low_m[2] = -1.0;
        region[r].high_m[0] = region[r].high_m[2] = 1.0;
        region[r].low_m[1] = r == 0 ? 0.9 * HEIGHT : -1.0;
        region[r].high_m[1] = r == 0 ? 1.0 : 0.2 * HEIGHT;
        region[r].centre_m[0] = region[r].centre_m[1] = region[r].centre_m[2] = 0.5 * HEIGHT;
        region[r].radius_m = 0.2 * HEIGHT;
        region[r].stiffness = kind % 2 == 1 ? 2.0 + r : 0.0;
        region[r].own_material = tissue(2.0 + r);
        region[r].fibre[r] = 1.0;
        region[r].fibre_Pa = kind == 5 ? 4e4 : 0.0;
    }
}

static palp_realtime *make(int kind) {
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0, 0, 0}};
    palp_contact_settings touch = palp_contact_settings_default();
    palp_network_settings settings = palp_network_settings_default();
    const palp_realtime_settings realtime = palp_realtime_settings_default();
    const palp_material m = tissue(1.0);
    palp_region region[REGIONS];
    palp_mesh *mesh = NULL;
    palp_network *net = NULL;
    palp_realtime *rt = NULL;
    touch.tissue = kind == 3 || kind == 4;
    choose_regions(kind, region);
    bench_check(palp_mesh_lattice((size_t[]){NODES, NODES, NODES}, (double[]){HEIGHT, HEIGHT, HEIGHT},
                                  PALP_NEIGHBOURS_26, &mesh),
                "lattice");
    bench_check(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, 0.0, NULL), "scale");
    for (int r = 0; r < REGIONS; r++)
        bench_check(palp_region_place_in(mesh, &region[r], NULL), "region");
    settings.n_regions = kind > 0 ? REGIONS : 0;
    settings.regions = region;
    bench_check(palp_network_create(mesh, &m, 1, &bottom, &settings, &net, NULL), "network");
    bench_check(palp_network_enable_tools(net, 1, 0, &touch), "tools");
    bench_check(palp_realtime_create(net, &realtime, &rt), "realtime");
    palp_mesh_free(mesh);
    return rt;
}

int main(void) {
    static double seconds[KINDS][TICKS];
    const palp_budget budget = {.corrections = 2};
    palp_realtime *rt[KINDS];
    for (int kind = 0; kind < KINDS; kind++)
        rt[kind] = make(kind);
    for (int i = 0; i < TICKS; i++) {
        const double t = DT * i;
        palp_tool sphere = {PALP_TOOL_SPHERE, {0, 0, 0.5 * HEIGHT}, {0, 0, 0}, 0, 0.005, 0.2, {0}, NULL};
        sphere.position_m[0] = HEIGHT * (0.5 + 0.2 * sin(3.0 * t));
        sphere.position_m[1] = HEIGHT + 0.005 - 1e-3 * fmin(1.0, 5.0 * t) * (1.0 + 0.3 * sin(9.0 * t));
        for (int kind = 0; kind < KINDS; kind++) {
            palp_tick_info info;
            palp_network_set_tools(palp_realtime_network(rt[kind]), 1, &sphere);
            bench_check(palp_realtime_step(rt[kind], 0.0, DT, &budget, &info), "tick");
            seconds[kind][i] = info.seconds;
        }
    }
    double median[KINDS];
    printf("%-32s %8s %8s %10s\n", "regions", "median", "99 %", "over none");
    for (int kind = 0; kind < KINDS; kind++) {
        median[kind] = bench_median(seconds[kind], TICKS);
        printf("%-32s %5.3f ms %5.3f ms %10.2f\n", NAMES[kind], 1e3 * median[kind],
               1e3 * seconds[kind][TICKS * 99 / 100], median[kind] / median[0]);
        palp_network *net = palp_realtime_network(rt[kind]);
        palp_realtime_free(rt[kind]);
        palp_network_free(net);
    }
    return 0;
}
