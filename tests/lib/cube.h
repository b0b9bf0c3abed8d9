/* cube.h: the seed's cubes of 24 mm, its materials, and small helpers of the tests that calibrate them. */
#ifndef CUBE_H
#define CUBE_H

#include <palpate/mesh.h>
#include <palpate/model.h>
#include <palpate/network.h>

#include <check.h>
#include <math.h>
#include <stdlib.h>

#define CUBE_HEIGHT_M 0.024
#define CUBE_PRESS_M 0.0097 /* the seed's static loading goes as far */

/* Eq. 4.3 and 5.21, ascending powers of strain, N. */
static const double LUMPED_LAW[5] = {8.18, -0.70, 47.47, -131.36, 146.89};
static const double NETWORK_LAW[5] = {0.54, -2.34, 33.25, -124.03, 177.63};

static inline palp_material cube_polynomial(size_t n, const double *coefficients_N) {
    palp_material material = {.n_arms = 0};
    ck_assert_int_eq(palp_law_polynomial(n, coefficients_N, &material.law), PALP_OK);
    return material;
}

/* Eight knots evenly up to a little beyond the nominal strain, on the quartic of Eq. 5.21. */
static inline palp_material cube_spline(void) {
    double strain[8], stiffness[8];
    palp_material material = cube_polynomial(5, NETWORK_LAW);
    for (size_t i = 0; i < 8; i++) {
        strain[i] = 1.05 * CUBE_PRESS_M / CUBE_HEIGHT_M * (double)i / 7.0;
        palp_law_stiffness(&material.law, strain[i], &stiffness[i], NULL);
    }
    ck_assert_int_eq(palp_law_spline(8, strain, stiffness, &material.law), PALP_OK);
    return material;
}

/* A lattice cube of n nodes a side on the seed's supports. */
static inline palp_network *cube_network(size_t n, const palp_material *material,
                                         const palp_network_settings *settings) {
    const size_t nodes[3] = {n, n, n};
    const double size_m[3] = {CUBE_HEIGHT_M, CUBE_HEIGHT_M, CUBE_HEIGHT_M};
    palp_support supports[2];
    palp_mesh *mesh;
    palp_network *network;
    ck_assert_int_eq(palp_mesh_lattice(nodes, size_m, PALP_NEIGHBOURS_26, &mesh), PALP_OK);
    palp_supports_default(supports);
    ck_assert_int_eq(palp_network_create(mesh, material, 2, supports, settings, &network, NULL), PALP_OK);
    palp_mesh_free(mesh);
    return network;
}

/* depth[n] evenly up to depth_m, the first not 0. */
static inline void cube_depths(size_t n, double depth_m, double *depth) {
    for (size_t i = 0; i < n; i++)
        depth[i] = depth_m * (double)(i + 1) / (double)n;
}

#endif
