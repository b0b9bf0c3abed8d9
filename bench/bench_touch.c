/* bench_touch.c: spheres pressed into a cube of 24 mm, on a node, between two, in the middle of a cell and
 * off it: force over that of Hertz, of the solid with the same force under a plate. usage: bench_touch
 * [none|continuum [local|triangles|SUBDIVISIONS [STIFFNESS]]] */
#include "bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PLATE = 8.18; /* N per unit strain between bonded plates */
enum { RADII = 3, DEPTHS = 3, PLACES = 4 };
static const double radius_mm[RADII] = {3, 5, 10}, depth_mm[DEPTHS] = {0.5, 1.0, 1.5};
static const double place[PLACES][2] = {{0, 0}, {0.5, 0}, {0.5, 0.5}, {0.3, 0.1}}; /* of an edge */

/* Hertz's force with the modulus of the cube that a plate meets with PLATE (bonded, Poisson's ratio 1/4):
 * linear hexahedra with contact, refined under the tip, have 0.99 to 1.03 of it for this block. */
static double hertz(double radius, double depth) {
    static const double MODULUS = 13590.0; /* Pa */
    return 4.0 / 3.0 * MODULUS / (1.0 - 1.0 / 16.0) * sqrt(radius * depth) * depth;
}

static palp_mesh *cube(size_t n, palp_mesh_scaling scaling) {
    palp_mesh *mesh = NULL;
    bench_check(palp_mesh_lattice((size_t[]){n, n, n}, (double[]){BENCH_SIZE, BENCH_SIZE, BENCH_SIZE},
                                  PALP_NEIGHBOURS_26, &mesh),
                "lattice");
    bench_check(palp_mesh_scale(mesh, scaling, 0.0, NULL), "scaling");
    return mesh;
}

/* The law that has the plate's force. */
static palp_material as_stiff(const palp_mesh *mesh) {
    palp_support supports[2];
    palp_network_settings settings = palp_network_settings_default();
    palp_material material = {.n_arms = 0};
    palp_network *net = NULL;
    double K = PLATE;
    palp_supports_default(supports);
    bench_check(palp_law_polynomial(1, &K, &material.law), "law");
    bench_check(palp_network_create(mesh, &material, 2, supports, &settings, &net, NULL), "network");
    bench_check(palp_network_step(net, 1e-5 * BENCH_SIZE, INFINITY, NULL), "plate");
    K *= 1e-5 * PLATE / palp_network_force(net);
    palp_network_free(net);
    bench_check(palp_law_polynomial(1, &K, &material.law), "law");
    return material;
}

static double press(const palp_mesh *mesh, const palp_material *material, const palp_contact_settings *touch,
                    double radius, double depth, const double at[2]) {
    enum { STEPS = 5 };
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0}};
    palp_network_settings settings = palp_network_settings_default();
    palp_network *net = NULL;
    palp_tool_force felt = {.contacts = 0};
    bench_check(palp_network_create(mesh, material, 1, &bottom, &settings, &net, NULL), "network");
    bench_check(palp_network_enable_tools(net, 1, 0, touch), "tools");
    for (int i = 1; i <= STEPS; i++) {
        const palp_tool tool = {.shape = PALP_TOOL_SPHERE,
                                .position_m = {at[0], BENCH_SIZE + radius - depth * i / STEPS, at[1]},
                                .radius_m = radius};
        bench_check(palp_network_set_tools(net, 1, &tool), "tool");
        bench_check(palp_network_step(net, 0.0, INFINITY, NULL), "step");
        bench_check(palp_network_tool_force(net, &felt), "force");
    }
    palp_network_free(net);
    return felt.force_N[1];
}

int main(int argc, char **argv) {
    static const size_t sides[] = {5, 7, 11};
    const palp_mesh_scaling scaling =
        argc > 1 && strcmp(argv[1], "none") == 0 ? PALP_SCALING_NONE : PALP_SCALING_CONTINUUM;
    palp_contact_settings touch = palp_contact_settings_default();
    touch.subdivisions = argc > 2 ? (size_t)atoi(argv[2]) : 0;
    touch.local = argc <= 2 || strcmp(argv[2], "local") == 0;
    touch.stiffness = argc > 3 ? atof(argv[3]) : touch.stiffness;
    printf("%7s %6s %6s %s\n", "nodes", "radius", "depth", "force over Hertz's: node, edge, cell, off");
    for (size_t s = 0; s < sizeof sides / sizeof *sides; s++) {
        palp_mesh *mesh = cube(sides[s], scaling);
        const palp_material material = as_stiff(mesh);
        const double edge = BENCH_SIZE / (double)(sides[s] - 1);
        for (size_t r = 0; r < RADII; r++)
            for (size_t d = 0; d < DEPTHS; d++) {
                printf("%7zu %6g %6g", sides[s], radius_mm[r], depth_mm[d]);
                for (size_t p = 0; p < PLACES; p++) {
                    const double at[2] = {0.5 * BENCH_SIZE + edge * place[p][0],
                                          0.5 * BENCH_SIZE + edge * place[p][1]};
                    const double radius = 1e-3 * radius_mm[r], depth = 1e-3 * depth_mm[d];
                    printf(" %6.2f",
                           press(mesh, &material, &touch, radius, depth, at) / hertz(radius, depth));
                }
                printf("\n");
                fflush(stdout);
            }
        palp_mesh_free(mesh);
    }
    return 0;
}
