/* bench_mesh.c: meshes of tetrahedra by scaling: stiffness at small strain against the solid's, force over
 * strain, how far the branch of equilibria goes. Forces of a law K(a) that is the lumped specimen's, for its
 * section. */
#include "bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double SECTION = 452.389e-6; /* m^2 */
static const double STEP = 0.005;         /* strain */

/* N per unit strain and kPa of the solid with bonded flats, Poisson's ratio 1/4: CalculiX, quadratic
 * tetrahedra (data/meshes/make_bodies.sh --solid). */
static const struct {
    const char *name;
    double solid_N;
} BODIES[] = {{"box_tetra", 0.6020},  {"cylinder_tetra", 0.4694}, {"sphere_4.4", 0.2845},
              {"sphere_3.8", 0.2845}, {"sphere_3.2", 0.2845},     {"liver_9", 1.710},
              {"liver_7.5", 1.710},   {"liver_6.5", 1.710}};

static palp_network *make(const palp_mesh *mesh) {
    palp_material material = {.n_arms = 0};
    palp_support supports[2];
    palp_network_settings settings = palp_network_settings_default();
    palp_network *net = NULL;
    bench_check(palp_law_polynomial(5, (double[]){8.18, -0.70, 47.47, -131.36, 146.89}, &material.law),
                "law");
    palp_supports_default(supports);
    bench_check(palp_network_create(mesh, &material, 2, supports, &settings, &net, NULL), "network");
    return net;
}

static void press(const palp_mesh *mesh, double solid_N, double unit) {
    double low[3], high[3], reached = 0.0, at[3] = {NAN, NAN, NAN};
    palp_step_info info;
    palp_network *net = make(mesh);
    palp_mesh_bounds(mesh, low, high);
    double height = high[1] - low[1];
    bench_check(palp_network_step(net, 1e-4 * height, INFINITY, &info), "small step");
    double small = info.force_N / 1e-4;
    for (int i = 1; i <= 90 && !palp_network_step(net, i * STEP * height, INFINITY, &info); i++) {
        reached = i * STEP;
        if (i % 20 == 0 && i <= 60)
            at[i / 20 - 1] = info.force_N / reached / small;
    }
    if (unit > 0.0)
        printf(" %+8.1f", 100.0 * (small / unit / solid_N - 1.0));
    else
        printf(" %8s", "-");
    printf(" %6.3f %6.3f %6.3f %8.3f\n", at[0], at[1], at[2], reached);
    palp_network_free(net);
}

int main(void) {
    static const char *const scalings[] = {"none", "volume", "continuum"};
    printf("%16s %10s %6s %8s %7s %8s %6s %6s %6s %8s\n", "mesh", "scaling", "nodes", "elements", "ms",
           "error %", "0.1", "0.2", "0.3", "reached");
    for (size_t b = 0; b < sizeof BODIES / sizeof *BODIES; b++)
        for (int s = 0; s < 3; s++) {
            char path[64];
            palp_mesh *mesh = NULL;
            snprintf(path, sizeof path, "data/meshes/%s.msh", BODIES[b].name);
            bench_check(palp_mesh_read_gmsh(path, 1e-3, false, &mesh, NULL), path);
            double start = bench_seconds();
            bench_check(palp_mesh_scale(mesh, (palp_mesh_scaling)s, SECTION, NULL), "scaling");
            printf("%16s %10s %6zu %8zu %7.1f", BODIES[b].name, scalings[s], palp_mesh_node_count(mesh),
                   palp_mesh_element_count(mesh), 1e3 * (bench_seconds() - start));
            press(mesh, BODIES[b].solid_N, s > 0 ? 8.18 / SECTION / 1e3 : 0.0);
            palp_mesh_free(mesh);
        }
    printf("error: of force / strain at strain 1e-4 against the solid; 0.1, 0.2, 0.3: force / strain there "
           "over that\n"
           "at 1e-4; reached: strain to which steps of %g converge, at most 0.45\n",
           STEP);
    return 0;
}
