/* bench_touch.c: spheres pressed into a cube of 24 mm, on a node, between two, in the middle of a cell and
 * off it: force over that of a neo-Hookean solid with the same force under a plate. usage: bench_touch
 * [none|continuum [local|triangles|SUBDIVISIONS [STIFFNESS]]], or bench_touch places: spheres and capsules
 * near edges and on a side, over the forces of CalculiX in data/tips/places.csv. BENCH_NODES=N: so many nodes
 * a side alone; BENCH_POISSON: Poisson's ratio, 0.25, of places all; BENCH_LAW=one: springs of one stiffness
 * instead of the solid's law.
 */
#include "bench.h"
#include "../tests/lib/tip_places.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846, SMALL = 1e-5 /* of the height */, YOUNG = 1e4;
enum { RADII = 3, DEPTHS = 3, PLACES = 4, STEPS = 4 };
static const double radius_mm[RADII] = {3, 5, 10}, depth_mm[DEPTHS] = {0.5, 1.0, 2.0};
static const double place[PLACES][2] = {{0, 0}, {0.5, 0}, {0.5, 0.5}, {0.3, 0.1}}; /* of an edge */

static double section_radius(void) {
    return BENCH_SIZE / sqrt(PI);
}

/* Force over the shear modulus, m2; NaN beyond the tables. */
static double solid(palp_indentation tip, double poisson, double depth) {
    double force = NAN;
    tip.thickness_m = BENCH_SIZE;
    tip.poisson = poisson;
    const palp_status status = palp_indentation_force(&tip, 1, &depth, &force);
    if (status != PALP_ERR_LIMIT)
        bench_check(status, "solid");
    return status ? NAN : force;
}

static palp_mesh *cube(size_t n, palp_mesh_scaling scaling) {
    palp_mesh *mesh = NULL;
    bench_check(palp_mesh_lattice((size_t[]){n, n, n}, (double[]){BENCH_SIZE, BENCH_SIZE, BENCH_SIZE},
                                  PALP_NEIGHBOURS_26, &mesh),
                "lattice");
    bench_check(palp_mesh_scale(mesh, scaling, 0.0, NULL), "scaling");
    return mesh;
}

static palp_network_settings settings_of(double poisson) {
    palp_network_settings settings = palp_network_settings_default();
    settings.poisson_ratio = poisson > 0.25 ? poisson : 0.0;
    settings.edge_correction = !getenv("BENCH_EDGES");
    return settings;
}

/* A solid's law, or one stiffness. */
static palp_material material_of(const palp_mesh *mesh, double poisson) {
    const char *law = getenv("BENCH_LAW");
    palp_material material = {.n_arms = 0};
    double rest;
    bench_check(palp_law_of_solid(mesh, poisson, YOUNG, &material.law), "law");
    palp_law_stiffness(&material.law, 0.0, &rest, NULL);
    if (law && strcmp(law, "one") == 0)
        bench_check(palp_law_polynomial(1, &rest, &material.law), "law");
    return material;
}

/* The shear modulus of the solid with its force under a plate. */
static double modulus_by_plate(const palp_mesh *mesh, const palp_material *material, double poisson) {
    const palp_indentation plate = {.tip = PALP_TIP_PLATE, .radius_m = section_radius(), .tip_sticks = true};
    const palp_network_settings settings = settings_of(poisson);
    palp_support supports[2];
    palp_network *net = NULL;
    palp_supports_default(supports);
    bench_check(palp_network_create(mesh, material, 2, supports, &settings, &net, NULL), "network");
    bench_check(palp_network_step(net, SMALL * BENCH_SIZE, INFINITY, NULL), "plate");
    const double force = palp_network_force(net);
    palp_network_free(net);
    return force / solid(plate, poisson, SMALL * BENCH_SIZE);
}

/* Forces at all depths of a tool that begins at first contact and moves against an axis. */
static void press(const palp_mesh *mesh, const palp_material *material, double poisson,
                  const palp_contact_settings *touch, palp_tool tool, int axis, double force[DEPTHS]) {
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0}};
    const palp_network_settings settings = settings_of(poisson);
    palp_network *net = NULL;
    palp_tool_force felt = {.contacts = 0};
    const double start = tool.position_m[axis];
    bench_check(palp_network_create(mesh, material, 1, &bottom, &settings, &net, NULL), "network");
    bench_check(palp_network_enable_tools(net, 1, 0, touch), "tools");
    for (int d = 0; d < DEPTHS; d++) {
        const double before = d ? depth_mm[d - 1] : 0.0;
        for (int i = 1; i <= STEPS; i++) {
            tool.position_m[axis] = start - 1e-3 * (before + (depth_mm[d] - before) * i / STEPS);
            bench_check(palp_network_set_tools(net, 1, &tool), "tool");
            bench_check(palp_network_step(net, 0.0, INFINITY, NULL), "step");
        }
        bench_check(palp_network_tool_force(net, &felt), "force");
        force[d] = felt.force_N[axis];
    }
    palp_network_free(net);
}

static void press_all(const palp_mesh *mesh, size_t side, double poisson,
                      const palp_contact_settings *touch) {
    const palp_material material = material_of(mesh, poisson);
    const double edge = BENCH_SIZE / (double)(side - 1), shear = modulus_by_plate(mesh, &material, poisson);
    for (size_t r = 0; r < RADII; r++) {
        double force[PLACES][DEPTHS];
        const palp_indentation sphere = {.tip = PALP_TIP_SPHERE,
                                         .radius_m = 1e-3 * radius_mm[r],
                                         .large_strain = true,
                                         .specimen_radius_m = section_radius()};
        for (size_t p = 0; p < PLACES; p++) {
            const palp_tool tool = {.shape = PALP_TOOL_SPHERE,
                                    .position_m = {0.5 * BENCH_SIZE + edge * place[p][0],
                                                   BENCH_SIZE + sphere.radius_m,
                                                   0.5 * BENCH_SIZE + edge * place[p][1]},
                                    .radius_m = sphere.radius_m};
            press(mesh, &material, poisson, touch, tool, 1, force[p]);
        }
        for (size_t d = 0; d < DEPTHS; d++) {
            const double whole = shear * solid(sphere, poisson, 1e-3 * depth_mm[d]);
            if (isnan(whole))
                continue;
            printf("%7zu %6g %6g", side, radius_mm[r], depth_mm[d]);
            for (size_t p = 0; p < PLACES; p++)
                printf(" %6.3f", force[p][d] / whole);
            printf("\n");
        }
        fflush(stdout);
    }
}

/* ---- other places ---------------------------------------------------------------------------------- */

/* Presses there, shifted along z by a part of an edge. */
static void press_place(const palp_mesh *mesh, const palp_material *material,
                        const palp_contact_settings *touch, const tip_place *r, double shift,
                        double force[DEPTHS]) {
    const bool side = r->face[0] == 's';
    const double outside = BENCH_SIZE + 1e-3 * r->radius, x = 1e-3 * r->x;
    const palp_tool tool = {
        .shape = r->length > 0.0 ? PALP_TOOL_CAPSULE : PALP_TOOL_SPHERE,
        .position_m = {side ? outside : x, side ? x : outside, 1e-3 * (r->z - 0.5 * r->length) + shift},
        .axis = {0, 0, 1},
        .length_m = 1e-3 * r->length,
        .radius_m = 1e-3 * r->radius};
    press(mesh, material, r->poisson, touch, tool, side ? 0 : 1, force);
}

/* Every row of this ratio, there and, if z is in the middle, half an edge further along it. Then the smallest
 * and largest, and the plate's force over that on a solid of the springs' modulus. */
static void press_places(const palp_mesh *mesh, size_t side, double poisson,
                         const palp_contact_settings *touch) {
    const palp_material material = material_of(mesh, poisson);
    const double shear = modulus_by_plate(mesh, &material, poisson);
    const double shift = 0.5 * BENCH_SIZE / (double)(side - 1);
    double force[2][DEPTHS], low[DEPTHS] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[DEPTHS] = {0.0};
    FILE *file = tip_places_open();
    if (!file)
        bench_check(PALP_ERR_INPUT, "data/tips/places.csv");
    for (tip_place r; tip_place_read(file, &r);) {
        size_t d = 0;
        if (r.poisson != poisson)
            continue;
        while (d < DEPTHS - 1 && depth_mm[d] != r.depth)
            d++;
        if (d == 0) /* rows of a place follow each other, deeper and deeper */
            for (int k = 0; k < 2; k++)
                press_place(mesh, &material, touch, &r, r.z == 12.0 ? k * shift : 0.0, force[k]);
        printf("%7zu %5g %4s %6g %6g %5g %5g %5g", side, poisson, r.face, r.radius, r.length, r.x, r.z,
               r.depth);
        for (int k = 0; k < 2; k++) {
            const double over = force[k][d] / (shear * r.force * BENCH_SIZE * BENCH_SIZE);
            printf(" %6.3f", over);
            low[d] = fmin(low[d], over);
            high[d] = fmax(high[d], over);
        }
        printf("\n");
        fflush(stdout);
    }
    fclose(file);
    printf("# %zu nodes, %g, plate: %.3f\n", side, poisson, shear * 2.0 * (1.0 + poisson) / YOUNG);
    for (int d = 0; d < DEPTHS; d++)
        printf("# %zu nodes, %g, %g mm deep: %.3f to %.3f\n", side, poisson, depth_mm[d], low[d], high[d]);
}

/* ---- all ------------------------------------------------------------------------------------------- */

int main(int argc, char **argv) {
    static const size_t SIDES[] = {5, 7, 11};
    static const double RATIOS[] = {0.25, 0.3, 0.45, 0.49};
    const char *nodes = getenv("BENCH_NODES"), *ratio = getenv("BENCH_POISSON");
    const bool places = argc > 1 && strcmp(argv[1], "places") == 0;
    const palp_mesh_scaling scaling =
        argc > 1 && strcmp(argv[1], "none") == 0 ? PALP_SCALING_NONE : PALP_SCALING_CONTINUUM;
    palp_contact_settings touch = palp_contact_settings_default();
    touch.subdivisions = argc > 2 ? (size_t)atoi(argv[2]) : 0;
    touch.local = argc <= 2 || strcmp(argv[2], "local") == 0;
    touch.stiffness = argc > 3 ? atof(argv[3]) : touch.stiffness;
    if (places)
        printf("%7s %5s %4s %6s %6s %5s %5s %5s %s\n", "nodes", "ratio", "face", "radius", "length", "x", "z",
               "depth", "force over the solid's: there, half an edge along z");
    else
        printf("%7s %6s %6s %s\n", "nodes", "radius", "depth",
               "force over the solid's: node, edge, cell, off");
    for (size_t s = 0; s < (nodes ? 1 : sizeof SIDES / sizeof *SIDES); s++) {
        const size_t side = nodes ? strtoul(nodes, NULL, 10) : SIDES[s];
        palp_mesh *mesh = cube(side, scaling);
        for (size_t k = 0; k < (places && !ratio ? sizeof RATIOS / sizeof *RATIOS : 1); k++)
            (places ? press_places : press_all)(mesh, side, ratio ? atof(ratio) : RATIOS[k], &touch);
        palp_mesh_free(mesh);
    }
    return 0;
}
