/* test_mesh_surface.c: tetrahedra that fill a mesh and the triangles around them. */
#include "mesh/mesh_internal.h"

#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

static const double SIZE[3] = {0.024, 0.012, 0.036};

enum { CUBOID, SLAB, TETRA, HEXA, HEXA_DIAGONALS, MESHES };

static palp_mesh *mesh_of(int kind) {
    palp_mesh *mesh = NULL;
    palp_status status = PALP_OK;
    if (kind <= SLAB)
        status = palp_mesh_lattice(kind == CUBOID ? (size_t[]){4, 3, 6} : (size_t[]){2, 7, 2}, SIZE,
                                   kind == CUBOID ? PALP_NEIGHBOURS_26 : PALP_NEIGHBOURS_6, &mesh);
    else
        status =
            palp_mesh_read_gmsh(kind == TETRA ? "data/meshes/cylinder_tetra.msh" : "data/meshes/box_hexa.msh",
                                1e-3, kind == HEXA_DIAGONALS, &mesh, NULL);
    ck_assert_int_eq(status, PALP_OK);
    return mesh;
}

/* Of the prism on the polygon of the cylinder's outer nodes. */
static double cylinder_volume(const palp_mesh *mesh) {
    const double *x = palp_mesh_positions(mesh);
    size_t n = 0;
    for (size_t i = 0; i < palp_mesh_node_count(mesh); i++)
        n += x[3 * i + 1] == 0.0 && fabs(hypot(x[3 * i], x[3 * i + 2]) - 0.012) < 1e-9;
    ck_assert_uint_ge(n, 12);
    return 0.5 * (double)n * 0.012 * 0.012 * sin(2.0 * PI / (double)n) * 0.024;
}

static double expected_volume(int kind, const palp_mesh *mesh) {
    return kind <= SLAB    ? SIZE[0] * SIZE[1] * SIZE[2]
           : kind == TETRA ? cylinder_volume(mesh)
                           : 0.024 * 0.024 * 0.024;
}

/* a . (b x c) */
static double triple(const double a[3], const double b[3], const double c[3]) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

static double tetrahedron_volume(const double *x, const int32_t *t) {
    double u[3][3];
    for (size_t i = 0; i < 3; i++)
        for (size_t k = 0; k < 3; k++)
            u[i][k] = x[3 * (size_t)t[i + 1] + k] - x[3 * (size_t)t[0] + k];
    return triple(u[0], u[1], u[2]) / 6.0;
}

START_TEST(tetrahedra_fill_the_mesh) {
    palp_mesh *mesh = mesh_of(_i);
    const double *x = palp_mesh_positions(mesh);
    double sum = 0.0, expected = expected_volume(_i, mesh);
    size_t n = palp_mesh_tetrahedron_count(mesh);
    for (size_t i = 0; i < n; i++) {
        double volume = tetrahedron_volume(x, palp_mesh_tetrahedra(mesh) + 4 * i);
        ck_assert_double_gt(volume, 1e-3 * expected / (double)n);
        sum += volume;
    }
    ck_assert_double_eq_tol(sum, expected, 1e-8 * expected);
    palp_mesh_free(mesh);
}
END_TEST

/* Divergence theorem: only outward triangles of a closed surface enclose the volume. */
START_TEST(surface_encloses_the_volume) {
    palp_mesh *mesh = mesh_of(_i);
    const double *x = palp_mesh_positions(mesh);
    double sum = 0.0, expected = expected_volume(_i, mesh);
    for (size_t i = 0; i < palp_mesh_triangle_count(mesh); i++) {
        const int32_t *t = palp_mesh_triangles(mesh) + 3 * i;
        sum += triple(x + 3 * t[0], x + 3 * t[1], x + 3 * t[2]) / 6.0;
    }
    ck_assert_double_eq_tol(sum, expected, 1e-8 * expected);
    palp_mesh_free(mesh);
}
END_TEST

/* The bodies are convex: outward is away from the middle. */
START_TEST(triangles_face_outward) {
    palp_mesh *mesh = mesh_of(_i);
    const double *x = palp_mesh_positions(mesh);
    double low[3], high[3];
    palp_mesh_bounds(mesh, low, high);
    ck_assert_uint_gt(palp_mesh_triangle_count(mesh), 0);
    for (size_t i = 0; i < palp_mesh_triangle_count(mesh); i++) {
        const int32_t *t = palp_mesh_triangles(mesh) + 3 * i;
        double from[3], u[2][3];
        for (size_t k = 0; k < 3; k++) {
            from[k] = x[3 * (size_t)t[0] + k] - 0.5 * (low[k] + high[k]);
            for (size_t j = 0; j < 2; j++)
                u[j][k] = x[3 * (size_t)t[j + 1] + k] - x[3 * (size_t)t[0] + k];
        }
        ck_assert_double_gt(triple(from, u[0], u[1]), 0.0);
    }
    palp_mesh_free(mesh);
}
END_TEST

static int compare_edges(const void *left, const void *right) {
    return memcmp(left, right, 2 * sizeof(int32_t));
}

/* Every edge is walked once each way, and V - E + F = 2: a sphere. */
START_TEST(surface_is_closed) {
    palp_mesh *mesh = mesh_of(_i);
    size_t n = palp_mesh_triangle_count(mesh), nodes = 0;
    int32_t(*edge)[2] = malloc(3 * n * sizeof *edge);
    unsigned char *seen = calloc(palp_mesh_node_count(mesh), 1);
    ck_assert(edge && seen);
    for (size_t i = 0; i < 3 * n; i++) {
        edge[i][0] = palp_mesh_triangles(mesh)[i];
        edge[i][1] = palp_mesh_triangles(mesh)[i / 3 * 3 + (i + 1) % 3];
        nodes += !seen[edge[i][0]];
        seen[edge[i][0]] = 1;
    }
    qsort(edge, 3 * n, sizeof *edge, compare_edges);
    for (size_t i = 0; i < 3 * n; i++) {
        int32_t back[2] = {edge[i][1], edge[i][0]};
        ck_assert(i == 0 || compare_edges(edge[i - 1], edge[i]) != 0);
        ck_assert(bsearch(back, edge, 3 * n, sizeof *edge, compare_edges) != NULL);
    }
    ck_assert_uint_eq(nodes + n, 3 * n / 2 + 2);
    free(edge);
    free(seen);
    palp_mesh_free(mesh);
}
END_TEST

/* Those of a lattice are all of its elements' kind: every edge of a tetrahedron is an element. */
START_TEST(lattice_edges_are_elements) {
    palp_mesh *mesh = mesh_of(CUBOID);
    const int32_t *t = palp_mesh_tetrahedra(mesh), *pairs = palp_mesh_pairs(mesh);
    ck_assert_uint_eq(palp_mesh_tetrahedron_count(mesh), 6 * 3 * 2 * 5);
    ck_assert_uint_eq(palp_mesh_triangle_count(mesh), 4 * (3 * 2 + 3 * 5 + 2 * 5));
    for (size_t i = 0; i < palp_mesh_tetrahedron_count(mesh); i++, t += 4)
        for (size_t a = 0; a < 4; a++)
            for (size_t b = a + 1; b < 4; b++) {
                size_t e = 0;
                while (e < palp_mesh_element_count(mesh) &&
                       !((pairs[2 * e] == t[a] && pairs[2 * e + 1] == t[b]) ||
                         (pairs[2 * e] == t[b] && pairs[2 * e + 1] == t[a])))
                    e++;
                ck_assert_uint_lt(e, palp_mesh_element_count(mesh));
            }
    palp_mesh_free(mesh);
}
END_TEST

START_TEST(a_copy_has_them_too) {
    palp_mesh *mesh = mesh_of(TETRA), *copy = NULL;
    ck_assert_int_eq(mesh_copy(mesh, &copy), PALP_OK);
    ck_assert_uint_eq(palp_mesh_tetrahedron_count(copy), palp_mesh_tetrahedron_count(mesh));
    ck_assert_uint_eq(palp_mesh_triangle_count(copy), palp_mesh_triangle_count(mesh));
    ck_assert(palp_mesh_tetrahedra(copy) != palp_mesh_tetrahedra(mesh));
    ck_assert_mem_eq(palp_mesh_tetrahedra(copy), palp_mesh_tetrahedra(mesh),
                     4 * palp_mesh_tetrahedron_count(mesh) * sizeof(int32_t));
    ck_assert_mem_eq(palp_mesh_triangles(copy), palp_mesh_triangles(mesh),
                     3 * palp_mesh_triangle_count(mesh) * sizeof(int32_t));
    palp_mesh_free(mesh);
    palp_mesh_free(copy);
}
END_TEST

START_TEST(arrays_have_none) {
    static const double x[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const int32_t pairs[] = {0, 1, 0, 2, 0, 3, 1, 2, 1, 3, 2, 3};
    palp_mesh *mesh = NULL;
    ck_assert_int_eq(palp_mesh_create(4, x, 6, pairs, &mesh, NULL), PALP_OK);
    ck_assert_uint_eq(palp_mesh_tetrahedron_count(mesh), 0);
    ck_assert_uint_eq(palp_mesh_triangle_count(mesh), 0);
    palp_mesh_free(mesh);
}
END_TEST

/* Two tetrahedra on either side of a triangle, both written with it first: one is wound the other way. */
START_TEST(a_file_wound_the_other_way_is_turned) {
    palp_mesh *mesh = NULL;
    const char *path = "tests/data/mesh/good_tetra.msh";
    ck_assert_int_eq(palp_mesh_read_gmsh(path, 1e-3, false, &mesh, NULL), PALP_OK);
    for (size_t i = 0; i < palp_mesh_tetrahedron_count(mesh); i++)
        ck_assert_double_gt(tetrahedron_volume(palp_mesh_positions(mesh), palp_mesh_tetrahedra(mesh) + 4 * i),
                            0.0);
    ck_assert_uint_eq(palp_mesh_triangle_count(mesh), 6);
    palp_mesh_free(mesh);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, tetrahedra_fill_the_mesh, 0, MESHES);
    tcase_add_loop_test(tc, surface_encloses_the_volume, 0, MESHES);
    tcase_add_loop_test(tc, triangles_face_outward, 0, MESHES);
    tcase_add_loop_test(tc, surface_is_closed, 0, MESHES);
    tcase_add_test(tc, lattice_edges_are_elements);
    tcase_add_test(tc, a_copy_has_them_too);
    tcase_add_test(tc, arrays_have_none);
    tcase_add_test(tc, a_file_wound_the_other_way_is_turned);
}
