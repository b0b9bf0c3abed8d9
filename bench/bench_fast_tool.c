/* bench_fast_tool.c: a sphere pressed fast: the largest error of its force with a few corrections a tick,
 * relative to the peak. 5 mm in radius, 3 mm deep into the middle of the top, then 40 ticks of rest; quartic
 * law and two arms, ticks of 1 ms. The last column is the error 20 ticks after the sphere stopped. */
#include "bench.h"

#include <math.h>
#include <stdio.h>

enum { NODES = 11, BUDGETS = 6, REST = 40, AFTER = 20, TICKS = 400 };
static const double RADIUS = 5e-3, DEPTH = 3e-3, TICK = 1e-3; /* m, m, s */

static palp_realtime *tissue(double stiffness) {
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0}};
    const palp_network_settings settings = palp_network_settings_default();
    const palp_realtime_settings realtime = palp_realtime_settings_default();
    palp_contact_settings contact = palp_contact_settings_default();
    const palp_material material = bench_material(2);
    palp_realtime *rt = NULL;
    palp_mesh *mesh = NULL;
    palp_network *net = NULL;
    contact.stiffness = stiffness;
    bench_check(palp_mesh_lattice((size_t[]){NODES, NODES, NODES},
                                  (double[]){BENCH_SIZE, BENCH_SIZE, BENCH_SIZE}, PALP_NEIGHBOURS_26, &mesh),
                "mesh");
    bench_check(palp_network_create(mesh, &material, 1, &bottom, &settings, &net, NULL), "network");
    palp_mesh_free(mesh);
    bench_check(palp_network_enable_tools(net, 1, 0, &contact), "tools");
    bench_check(palp_realtime_create(net, &realtime, &rt), "realtime");
    return rt;
}

/* Force of each of n ticks at this speed, m/s; corrections 0: converged. */
static void press(double stiffness, double speed, size_t corrections, int n, double *force) {
    const palp_budget budget = {.corrections = corrections};
    palp_realtime *rt = tissue(stiffness);
    palp_network *net = palp_realtime_network(rt);
    for (int i = 0; i < n; i++) {
        const double depth = fmin(DEPTH, speed * TICK * (i + 1));
        const palp_tool tool = {
            .shape = PALP_TOOL_SPHERE,
            .position_m = {0.5 * BENCH_SIZE + 1e-4, BENCH_SIZE + RADIUS - depth, 0.5 * BENCH_SIZE + 3e-4},
            .radius_m = RADIUS};
        palp_tool_force felt;
        bench_check(palp_network_set_tools(net, 1, &tool), "tool");
        bench_check(palp_realtime_step(rt, 0.0, TICK, &budget, NULL), "tick");
        bench_check(palp_network_tool_force(net, &felt), "force");
        force[i] = felt.force_N[1];
    }
    palp_realtime_free(rt);
    palp_network_free(net);
}

int main(void) {
    static const double stiffness[] = {20.0, 200.0}, speed[] = {10e-3, 30e-3, 100e-3};
    static const size_t corrections[BUDGETS] = {1, 2, 3, 4, 6, 8};
    static double truth[TICKS], force[TICKS];
    printf("%d nodes a side: error of the force of a fast sphere over its peak\n", NODES);
    printf("%9s %8s %11s %12s %15s\n", "stiffness", "mm/s", "corrections", "largest", "20 ticks later");
    for (size_t k = 0; k < sizeof stiffness / sizeof *stiffness; k++)
        for (size_t s = 0; s < sizeof speed / sizeof *speed; s++) {
            const int moving = (int)ceil(DEPTH / (speed[s] * TICK)), n = moving + REST;
            double peak = 0.0;
            press(stiffness[k], speed[s], 0, n, truth);
            for (int i = 0; i < n; i++)
                peak = fmax(peak, truth[i]);
            for (size_t b = 0; b < BUDGETS; b++) {
                double most = 0.0;
                press(stiffness[k], speed[s], corrections[b], n, force);
                for (int i = 0; i < n; i++)
                    most = fmax(most, fabs(force[i] - truth[i]));
                printf("%9g %8g %11zu %12.2g %15.2g\n", stiffness[k], 1e3 * speed[s], corrections[b],
                       most / peak, fabs(force[moving + AFTER] - truth[moving + AFTER]) / peak);
            }
        }
    return 0;
}
