/* test_mesh.c: lattices, meshes from arrays, sets, and what is refused. */
#include "mesh/mesh_internal.h"

#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- lattices ------------------------------------------------------------------------------------ */

static palp_mesh *lattice(size_t nx, size_t ny, size_t nz, palp_neighbourhood neighbourhood) {
    const size_t nodes[3] = {nx, ny, nz};
    const double size_m[3] = {0.024, 0.012, 0.036};
    palp_mesh *mesh = NULL;
    ck_assert_int_eq(palp_mesh_lattice(nodes, size_m, neighbourhood, &mesh), PALP_OK);
    return mesh;
}

/* Pairs along the axes; across the two diagonals of each face; across the four of each box. */
static size_t lattice_count(size_t nx, size_t ny, size_t nz, palp_neighbourhood neighbourhood) {
    size_t ax = nx - 1, ay = ny - 1, az = nz - 1;
    size_t count = ax * ny * nz + nx * ay * nz + nx * ny * az;
    if (neighbourhood >= PALP_NEIGHBOURS_18)
        count += 2 * (ax * ay * nz + ax * ny * az + nx * ay * az);
    if (neighbourhood == PALP_NEIGHBOURS_26)
        count += 4 * ax * ay * az;
    return count;
}

START_TEST(lattice_has_the_seeds_element_counts) {
    static const size_t expected[][2] = {{3, 158}, {5, 1036}, {11, 14230}, {21, 108860}};
    palp_mesh *mesh = lattice(expected[_i][0], expected[_i][0], expected[_i][0], PALP_NEIGHBOURS_26);
    ck_assert_uint_eq(palp_mesh_element_count(mesh), expected[_i][1]);
    palp_mesh_free(mesh);
}
END_TEST

START_TEST(lattice_counts_follow_the_closed_form) {
    static const palp_neighbourhood kinds[] = {PALP_NEIGHBOURS_6, PALP_NEIGHBOURS_18, PALP_NEIGHBOURS_26};
    for (size_t nx = 2; nx < 5; nx++)
        for (size_t ny = 2; ny < 5; ny++)
            for (size_t nz = 2; nz < 5; nz++) {
                palp_mesh *mesh = lattice(nx, ny, nz, kinds[_i]);
                ck_assert_uint_eq(palp_mesh_node_count(mesh), nx * ny * nz);
                ck_assert_uint_eq(palp_mesh_element_count(mesh), lattice_count(nx, ny, nz, kinds[_i]));
                palp_mesh_free(mesh);
            }
}
END_TEST

/* Every pair that stands is a neighbour pair, and is found as its own element (so each once); with the counts
 * above that makes it all of them. */
START_TEST(lattice_pairs_are_neighbours_each_once) {
    static const palp_neighbourhood kinds[] = {PALP_NEIGHBOURS_6, PALP_NEIGHBOURS_18, PALP_NEIGHBOURS_26};
    palp_mesh *mesh = lattice(2, 3, 4, kinds[_i]);
    const int32_t *pairs = palp_mesh_pairs(mesh);
    for (size_t e = 0; e < palp_mesh_element_count(mesh); e++) {
        int32_t a = pairs[2 * e], b = pairs[2 * e + 1];
        int dx = abs(b / 12 - a / 12), dy = abs(b / 4 % 3 - a / 4 % 3), dz = abs(b % 4 - a % 4);
        ck_assert(a < b && b < 24 && dx <= 1 && dy <= 1 && dz <= 1);
        ck_assert_int_le(dx + dy + dz, _i + 1);
        ck_assert_uint_eq(palp_mesh_element_between(mesh, a, b), e);
        ck_assert_uint_eq(palp_mesh_element_between(mesh, b, a), e);
    }
    ck_assert_uint_eq(palp_mesh_element_between(mesh, 0, 23), palp_mesh_element_count(mesh));
    palp_mesh_free(mesh);
}
END_TEST

START_TEST(lattice_fills_its_box) {
    palp_mesh *mesh = lattice(3, 4, 8, PALP_NEIGHBOURS_26);
    const double *x = palp_mesh_positions(mesh);
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 4; j++)
            for (size_t k = 0; k < 8; k++) {
                const double *at = x + 3 * ((i * 4 + j) * 8 + k);
                ck_assert_double_eq_tol(at[0], 0.012 * (double)i, 1e-17);
                ck_assert_double_eq_tol(at[1], 0.004 * (double)j, 1e-17);
                ck_assert_double_eq_tol(at[2], 0.036 / 7.0 * (double)k, 1e-17);
            }
    double low[3], high[3];
    palp_mesh_bounds(mesh, low, high);
    ck_assert(low[0] == 0.0 && low[1] == 0.0 && low[2] == 0.0);
    ck_assert(high[0] == 0.024 && high[1] == 0.012 && high[2] == 0.036);
    palp_mesh_free(mesh);
}
END_TEST

START_TEST(lattice_has_a_set_for_each_face) {
    static const struct {
        const char *name;
        size_t n;
        int axis;
        double value;
    } faces[] = {{"left", 12, 0, 0.0}, {"right", 12, 0, 0.024}, {"bottom", 8, 1, 0.0},
                 {"top", 8, 1, 0.012}, {"back", 6, 2, 0.0},     {"front", 6, 2, 0.036}};
    palp_mesh *mesh = lattice(2, 3, 4, PALP_NEIGHBOURS_6);
    size_t n = 0;
    const int32_t *nodes = NULL;
    ck_assert_int_eq(palp_mesh_set(mesh, faces[_i].name, &n, &nodes), PALP_OK);
    ck_assert_uint_eq(n, faces[_i].n);
    for (size_t i = 0; i < n; i++) {
        ck_assert_double_eq(palp_mesh_positions(mesh)[3 * nodes[i] + faces[_i].axis], faces[_i].value);
        ck_assert(i == 0 || nodes[i - 1] < nodes[i]);
    }
    palp_mesh_free(mesh);
}
END_TEST

START_TEST(lattice_refuses_bad_arguments) {
    const double size[3] = {1.0, 1.0, 1.0}, nan_size[3] = {1.0, NAN, 1.0}, flat[3] = {1.0, 1.0, 0.0};
    const size_t nodes[3] = {2, 2, 2}, thin[3] = {2, 1, 2}, many[3] = {2000, 2000, 2000};
    const size_t wraps[3] = {SIZE_MAX / 2 + 2, 2, 2};
    palp_mesh *mesh = NULL;
    ck_assert_int_eq(palp_mesh_lattice(thin, size, PALP_NEIGHBOURS_26, &mesh), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_mesh_lattice(many, size, PALP_NEIGHBOURS_26, &mesh), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_mesh_lattice(wraps, size, PALP_NEIGHBOURS_26, &mesh), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_mesh_lattice(nodes, nan_size, PALP_NEIGHBOURS_26, &mesh), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_mesh_lattice(nodes, flat, PALP_NEIGHBOURS_26, &mesh), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_mesh_lattice(nodes, size, (palp_neighbourhood)7, &mesh), PALP_ERR_ARGUMENT);
    ck_assert_ptr_null(mesh);
}
END_TEST

/* ---- meshes from arrays, sets, copies ------------------------------------------------------------ */

static const double triangle[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};

START_TEST(create_copies_its_arrays) {
    double x[9];
    int32_t pairs[] = {2, 0, 1, 2};
    palp_mesh *mesh = NULL;
    memcpy(x, triangle, sizeof x);
    ck_assert_int_eq(palp_mesh_create(3, x, 2, pairs, &mesh, NULL), PALP_OK);
    x[3] = 5.0;
    pairs[0] = 1;
    ck_assert_mem_eq(palp_mesh_positions(mesh), triangle, sizeof triangle);
    ck_assert(palp_mesh_pairs(mesh)[0] == 2 && palp_mesh_pairs(mesh)[1] == 0);
    palp_mesh_free(mesh);
}
END_TEST

START_TEST(create_refuses_bad_meshes) {
    static const double same[] = {0, 0, 0, 0, 0, 0, 1, 0, 0}, lost[] = {0, 0, 0, NAN, 0, 0, 1, 0, 0};
    static const double close[] = {0, 0, 0, 1e-13, 0, 0, 1, 0, 0}, far[] = {0, 0, 0, 1e200, 0, 0, 1, 0, 0};
    static const struct {
        const double *x;
        size_t n_elements;
        int32_t pairs[6];
        const char *text;
    } bad[] = {{same, 2, {1, 2, 0, 1}, "element 1: nodes 0 and 1 are at the same place"},
               {close, 2, {1, 2, 0, 1}, "element 1: nodes 0 and 1 are at the same place"},
               {far, 2, {0, 2, 0, 1}, "too far apart"},
               {triangle, 2, {0, 1, 2, 2}, "element 1: nodes 2 and 2"},
               {lost, 2, {0, 1, 1, 2}, "node 1: a coordinate is not finite"},
               {triangle, 2, {0, 1, 1, 3}, "element 1: there is no node 3; the mesh has 3 nodes"},
               {triangle, 2, {0, 1, -1, 2}, "there is no node -1"},
               {triangle, 3, {0, 1, 1, 2, 1, 0}, "1 elements join the same nodes"},
               {triangle, 1, {0, 1}, "2 separate parts: no elements connect node 0 to node 2"},
               {triangle, 1, {1, 2}, "2 separate parts: no elements connect node 0 to node 1"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        palp_error error = {PALP_OK, ""};
        palp_mesh *mesh = NULL;
        palp_status status = palp_mesh_create(3, bad[i].x, bad[i].n_elements, bad[i].pairs, &mesh, &error);
        ck_assert_int_eq(status, PALP_ERR_INPUT);
        ck_assert_int_eq(error.status, PALP_ERR_INPUT);
        ck_assert_msg(strstr(error.text, bad[i].text), "%zu: %s", i, error.text);
        ck_assert_ptr_null(mesh);
    }
}
END_TEST

START_TEST(sets_are_sorted_replaced_and_checked) {
    const int32_t first[] = {5, 1, 5, 0}, second[] = {7}, outside[] = {0, 27}, negative[] = {-1};
    palp_mesh *mesh = lattice(3, 3, 3, PALP_NEIGHBOURS_26);
    const int32_t *nodes = NULL;
    size_t n = 0;
    ck_assert_int_eq(palp_mesh_add_set(mesh, "grip", 4, first), PALP_OK);
    ck_assert_int_eq(palp_mesh_set(mesh, "grip", &n, &nodes), PALP_OK);
    ck_assert_uint_eq(n, 3);
    ck_assert(nodes[0] == 0 && nodes[1] == 1 && nodes[2] == 5);
    ck_assert_int_eq(palp_mesh_add_set(mesh, "grip", 1, second), PALP_OK);
    ck_assert_int_eq(palp_mesh_set(mesh, "grip", &n, &nodes), PALP_OK);
    ck_assert(n == 1 && nodes[0] == 7);
    ck_assert_int_eq(palp_mesh_add_set(mesh, "grip", 2, outside), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_mesh_add_set(mesh, "grip", 1, negative), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_mesh_add_set(mesh, "", 1, second), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_mesh_add_set(mesh, NULL, 1, second), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_mesh_set(mesh, "grip", &n, &nodes), PALP_OK);
    ck_assert(n == 1 && nodes[0] == 7);
    ck_assert_int_eq(palp_mesh_set(mesh, "Grip", &n, &nodes), PALP_ERR_INPUT);
    palp_mesh_free(mesh);
}
END_TEST

START_TEST(plane_sets_hold_the_nodes_of_a_plane) {
    palp_mesh *mesh = lattice(3, 3, 3, PALP_NEIGHBOURS_26);
    const int32_t *nodes = NULL;
    size_t n = 0;
    ck_assert_int_eq(palp_mesh_add_plane_set(mesh, "middle", 1, 0.0061, 2e-4), PALP_OK);
    ck_assert_int_eq(palp_mesh_set(mesh, "middle", &n, &nodes), PALP_OK);
    ck_assert_uint_eq(n, 9);
    for (size_t i = 0; i < n; i++)
        ck_assert_int_eq(nodes[i] / 3 % 3, 1);
    ck_assert_int_eq(palp_mesh_add_plane_set(mesh, "none", 1, 0.0061, 5e-5), PALP_ERR_INPUT);
    ck_assert_int_eq(palp_mesh_add_plane_set(mesh, "none", 3, 0.0, 1.0), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_mesh_add_plane_set(mesh, "none", 1, NAN, 1.0), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_mesh_add_plane_set(mesh, "none", 1, 0.0, -1.0), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_mesh_set(mesh, "none", &n, &nodes), PALP_ERR_INPUT);
    palp_mesh_free(mesh);
}
END_TEST

START_TEST(a_copy_is_equal_and_its_own) {
    palp_mesh *mesh = lattice(3, 4, 2, PALP_NEIGHBOURS_18), *copy = NULL;
    const int32_t *nodes = NULL, *copied = NULL, other[] = {0};
    size_t n = 0, m = 0;
    ck_assert_int_eq(mesh_copy(mesh, &copy), PALP_OK);
    ck_assert_int_eq(palp_mesh_set(mesh, "top", &n, &nodes), PALP_OK);
    ck_assert_int_eq(palp_mesh_set(copy, "top", &m, &copied), PALP_OK);
    ck_assert_uint_eq(n, m);
    ck_assert_mem_eq(nodes, copied, n * sizeof *nodes);
    ck_assert_int_eq(palp_mesh_add_set(mesh, "top", 1, other), PALP_OK);
    palp_mesh_free(mesh);
    ck_assert_int_eq(palp_mesh_set(copy, "top", &m, &copied), PALP_OK);
    ck_assert_uint_eq(n, m);
    ck_assert_uint_eq(palp_mesh_node_count(copy), 24);
    mesh = lattice(3, 4, 2, PALP_NEIGHBOURS_18);
    ck_assert_uint_eq(palp_mesh_element_count(copy), palp_mesh_element_count(mesh));
    ck_assert_mem_eq(palp_mesh_positions(copy), palp_mesh_positions(mesh), 3 * 24 * sizeof(double));
    ck_assert_mem_eq(palp_mesh_pairs(copy), palp_mesh_pairs(mesh),
                     2 * palp_mesh_element_count(mesh) * sizeof(int32_t));
    palp_mesh_free(mesh);
    palp_mesh_free(copy);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, lattice_has_the_seeds_element_counts, 0, 4);
    tcase_add_loop_test(tc, lattice_counts_follow_the_closed_form, 0, 3);
    tcase_add_loop_test(tc, lattice_pairs_are_neighbours_each_once, 0, 3);
    tcase_add_test(tc, lattice_fills_its_box);
    tcase_add_loop_test(tc, lattice_has_a_set_for_each_face, 0, 6);
    tcase_add_test(tc, lattice_refuses_bad_arguments);
    tcase_add_test(tc, create_copies_its_arrays);
    tcase_add_test(tc, create_refuses_bad_meshes);
    tcase_add_test(tc, sets_are_sorted_replaced_and_checked);
    tcase_add_test(tc, plane_sets_hold_the_nodes_of_a_plane);
    tcase_add_test(tc, a_copy_is_equal_and_its_own);
}
