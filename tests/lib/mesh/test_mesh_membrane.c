/* test_mesh_membrane.c: springs on a surface against the isotropic membrane of Poisson's ratio 1/3. */
#include "mesh/mesh_internal.h"
#include "network_make.h"

#include <stdio.h>

/* Energy of a plane strain of the top, over that of the membrane with modulus times thickness 1. */
static double energy_ratio(const palp_mesh *mesh, const double *width, double xx, double zz, double xz,
                           double area) {
    const double membrane =
        0.5 * (1.125 * (xx * xx + zz * zz) + 2.0 * 0.375 * xx * zz + 4.0 * 0.375 * xz * xz) * area;
    double springs = 0.0, n[3];
    for (size_t e = 0; e < mesh->n_elements; e++) {
        const double length = mesh_direction(mesh, mesh->pairs + 2 * e, n);
        const double strain = xx * n[0] * n[0] + zz * n[2] * n[2] + 2.0 * xz * n[0] * n[2];
        springs += 0.5 * width[e] * length * strain * strain;
    }
    return springs / membrane;
}

/* The largest difference from 1 over some strains. */
static double worst_of_top(palp_mesh *mesh, double area) {
    static const double STRAINS[][3] = {{1, 0, 0}, {0, 1, 0},  {0, 0, 1},
                                        {1, 1, 0}, {1, -1, 0}, {0.3, 0.7, -0.5}};
    double worst = 0.0, *width = malloc(mesh->n_elements * sizeof *width);
    unsigned char *listed = calloc(mesh->n_nodes, 1);
    const int32_t *node;
    size_t n;
    ck_assert_int_eq(palp_mesh_set(mesh, "top", &n, &node), PALP_OK);
    for (size_t i = 0; i < n; i++)
        listed[node[i]] = 1;
    ck_assert_int_eq(mesh_membrane_widths(mesh, listed, width), PALP_OK);
    for (size_t i = 0; i < sizeof STRAINS / sizeof *STRAINS; i++) {
        const double *s = STRAINS[i];
        worst = fmax(worst, fabs(energy_ratio(mesh, width, s[0], s[1], s[2], area) - 1.0));
    }
    for (size_t e = 0; e < mesh->n_elements; e++)
        ck_assert(width[e] >= 0.0 &&
                  (width[e] == 0.0 || (listed[mesh->pairs[2 * e]] && listed[mesh->pairs[2 * e + 1]])));
    free(width);
    free(listed);
    return worst;
}

static double area_of_top(palp_mesh *mesh) {
    double low[3], high[3], area = 0.0;
    palp_mesh_bounds(mesh, low, high);
    for (size_t i = 0; i < mesh->n_triangles; i++) {
        const int32_t *t = mesh->triangles + 3 * i;
        const double *a = mesh->x_m + 3 * t[0], *b = mesh->x_m + 3 * t[1], *c = mesh->x_m + 3 * t[2];
        if (fmin(a[1], fmin(b[1], c[1])) > high[1] - 1e-6 * (high[1] - low[1]))
            area += 0.5 * fabs((b[0] - a[0]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[0] - a[0]));
    }
    return area;
}

START_TEST(exact_on_rectangles) {
    static const double SIZES[][3] = {{0.024, 0.024, 0.024}, {0.030, 0.024, 0.024}};
    for (int i = 0; i < 2; i++) {
        palp_mesh *mesh = NULL;
        ck_assert_int_eq(palp_mesh_lattice((size_t[]){5, 3, 5}, SIZES[i], PALP_NEIGHBOURS_26, &mesh),
                         PALP_OK);
        ck_assert_double_le(worst_of_top(mesh, SIZES[i][0] * SIZES[i][2]), 1e-6);
        palp_mesh_free(mesh);
    }
}
END_TEST

/* With elements across faces, as a continuum has them, meshes of tetrahedra are close. */
START_TEST(close_on_triangles) {
    static const char *const MESHES[] = {"box_tetra", "cylinder_tetra", "liver_6.5", "sphere_3.2"};
    for (int i = 0; i < 4; i++) {
        char path[64];
        palp_mesh *mesh = NULL;
        snprintf(path, sizeof path, "data/meshes/%s.msh", MESHES[i]);
        ck_assert_int_eq(palp_mesh_read_gmsh(path, 1e-3, false, &mesh, NULL), PALP_OK);
        ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, 0.0, NULL), PALP_OK);
        const double worst = worst_of_top(mesh, area_of_top(mesh));
        ck_assert_msg(worst < 0.06, "%s: off by %g", MESHES[i], worst);
        palp_mesh_free(mesh);
    }
}
END_TEST

/* Without a set all of the surface: an even change of size takes the membrane's energy on every face. */
START_TEST(on_the_whole_surface) {
    palp_mesh *mesh = cube(4, PALP_NEIGHBOURS_26);
    double *width = malloc(mesh->n_elements * sizeof *width), sum = 0.0, n[3];
    ck_assert_int_eq(mesh_membrane_widths(mesh, NULL, width), PALP_OK);
    for (size_t e = 0; e < mesh->n_elements; e++)
        sum += width[e] * mesh_direction(mesh, mesh->pairs + 2 * e, n);
    ck_assert_double_eq_tol(sum, 3.0 * 6.0 * HEIGHT * HEIGHT, 1e-9 * sum);
    free(width);
    palp_mesh_free(mesh);
}
END_TEST

void tests(TCase *tc);
void tests(TCase *tc) {
    tcase_add_test(tc, exact_on_rectangles);
    tcase_add_test(tc, close_on_triangles);
    tcase_add_test(tc, on_the_whole_surface);
}
