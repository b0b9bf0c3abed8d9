/* bench_ripple.c: ripple of the force on a smooth sphere that slides over a lattice scaled as a solid. The
 * lattice has the solid's law. The sphere touches whole triangles (-1), local points (0) or a smooth surface.
 * Ripple is the range within the length of an edge over the mean, after subtraction of a moving mean over one
 * edge. */
#include "bench.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NODES = 7, EDGE = 24, PLACES = 2 * EDGE + 1, APPROACH = 3 }; /* EDGE: steps to an edge of the mesh */

static palp_network *block(int subdivisions) {
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0}};
    palp_network_settings settings = palp_network_settings_default();
    palp_contact_settings touch = palp_contact_settings_default();
    palp_material material = {.n_arms = 0};
    palp_mesh *mesh = NULL;
    palp_network *net = NULL;
    touch.local = subdivisions >= 0;
    touch.subdivisions = subdivisions > 0 ? (size_t)subdivisions : 0;
    bench_check(palp_mesh_lattice((size_t[]){NODES, NODES, NODES},
                                  (double[]){BENCH_SIZE, BENCH_SIZE, BENCH_SIZE}, PALP_NEIGHBOURS_26, &mesh),
                "lattice");
    bench_check(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, 0.0, NULL), "scaling");
    bench_check(palp_law_of_solid(mesh, 0.25, 5e3, &material.law), "law");
    bench_check(palp_network_create(mesh, &material, 1, &bottom, &settings, &net, NULL), "network");
    bench_check(palp_network_enable_tools(net, 1, 0, &touch), "tools");
    palp_mesh_free(mesh);
    return net;
}

static double ripple(const double force[PLACES]) {
    double low = INFINITY, high = -INFINITY;
    for (int i = EDGE / 2; i < PLACES - EDGE / 2; i++) {
        double around = 0.5 * (force[i - EDGE / 2] + force[i + EDGE / 2]);
        for (int j = 1 - EDGE / 2; j < EDGE / 2; j++)
            around += force[i + j];
        low = fmin(low, force[i] - around / EDGE);
        high = fmax(high, force[i] - around / EDGE);
    }
    return high - low;
}

/* Across the middle of the block's top, in steps of (x, z). */
static void slide(int subdivisions, double radius, double press, const double way[2]) {
    const double edge = BENCH_SIZE / (NODES - 1), middle = 0.5 * BENCH_SIZE;
    double force[3][PLACES], mean = 0.0;
    palp_network *net = block(subdivisions);
    for (int i = 1 - APPROACH; i < PLACES; i++) {
        double aside = edge * (i < 0 ? -1.0 : (double)i / EDGE - 1.0),
               deep = press * fmin(1.0, (double)(i + APPROACH) / APPROACH);
        palp_tool tool = {.shape = PALP_TOOL_SPHERE, .radius_m = radius};
        palp_tool_force felt;
        memcpy(tool.position_m,
               (double[]){middle + 3e-4 + way[0] * aside, BENCH_SIZE + radius - deep,
                          middle + 7e-4 + way[1] * aside},
               sizeof tool.position_m);
        bench_check(palp_network_set_tools(net, 1, &tool), "tool");
        bench_check(palp_network_step(net, 0.0, 0.01, NULL), "step");
        bench_check(palp_network_tool_force(net, &felt), "force");
        for (int k = 0; k < 3 && i >= 0; k++)
            force[k][i] = felt.force_N[k];
        mean += i >= 0 ? felt.force_N[1] / PLACES : 0.0;
    }
    printf(" %8.3f %7.2f %7.2f", mean, 100.0 * ripple(force[1]) / mean,
           100.0 * fmax(ripple(force[0]), ripple(force[2])) / mean);
    palp_network_free(net);
}

int main(void) {
    static const double spheres[][2] = {
        {3e-3, 0.5e-3}, {3e-3, 1e-3}, {4e-3, 1e-3}, {5e-3, 1.5e-3}, {10e-3, 1.5e-3}}; /* radius, depth, m */
    static const double ways[][2] = {{1.0, 0.0}, {1.0, 1.0}};
    printf(
        "%d nodes a side of %g mm, along x and as far along x and z: mean N, ripple %% normal and lateral\n",
        NODES, 1e3 * BENCH_SIZE);
    printf("%9s %8s %12s %24s %24s\n", "radius mm", "depth mm", "subdivisions", "x", "x and z");
    for (size_t s = 0; s < sizeof spheres / sizeof *spheres; s++)
        for (int k = -1; k <= 3; k++) {
            printf("%9g %8g %12d", 1e3 * spheres[s][0], 1e3 * spheres[s][1], k);
            for (size_t w = 0; w < 2; w++)
                slide(k, spheres[s][0], spheres[s][1], ways[w]);
            printf("\n");
            fflush(stdout);
        }
    return 0;
}
