/* test_mesh_part.c: the parts of a mesh that processes have. */
#include "mesh/mesh_internal.h"
#include "network_make.h"

#include <stdlib.h>

enum { OWNERS = 3 };

/* Each element and solid is in one part, with its nodes where they were. */
static void check_part(const palp_mesh *whole, const int32_t *owner, int32_t who, bool surface, int *elements,
                       size_t *tetrahedra) {
    palp_mesh *part = NULL;
    int32_t *node = NULL, *element = NULL, *solid = NULL;
    ck_assert_int_eq(mesh_part(whole, owner, who, surface, &part, &node, &element, &solid), PALP_OK);
    const double *scale = palp_mesh_element_scale(whole);
    size_t own = 0, wanted = 0;
    for (size_t i = 0; i < whole->n_nodes; i++)
        wanted += owner[i] == who;
    for (size_t i = 0; i < part->n_nodes; i++) {
        own += owner[node[i]] == who;
        if (i > 0)
            ck_assert_int_lt(node[i - 1], node[i]);
        ck_assert_mem_eq(part->x_m + 3 * i, whole->x_m + 3 * node[i], 3 * sizeof(double));
    }
    ck_assert_uint_eq(own, wanted);
    for (size_t i = 0; i < part->n_elements; i++) {
        const int32_t *pair = part->pairs + 2 * i, *of = whole->pairs + 2 * element[i];
        elements[element[i]]++;
        ck_assert_int_eq(node[pair[0]], of[0]);
        ck_assert_int_eq(node[pair[1]], of[1]);
        ck_assert_int_eq(owner[of[0]], who);
        ck_assert_uint_eq(palp_mesh_element_between(part, pair[1], pair[0]), i);
        if (scale)
            ck_assert_double_eq(palp_mesh_element_scale(part)[i], scale[element[i]]);
    }
    *tetrahedra += part->n_tetrahedra;
    for (size_t i = 0; i < part->n_tetrahedra; i++)
        ck_assert_double_gt(mesh_volume6(part->x_m, part->tetrahedra + 4 * i), 0.0);
    ck_assert_uint_eq(6 * part->n_hexahedra, part->n_tetrahedra);
    for (size_t i = 0; i < part->n_hexahedra; i++)
        for (size_t c = 0; c < 8; c++)
            ck_assert_int_eq(node[part->hexahedra[8 * i + c]], whole->hexahedra[8 * (size_t)solid[i] + c]);
    ck_assert_uint_eq(part->n_triangles, surface ? whole->n_triangles : 0);
    for (size_t i = 0; i < 3 * part->n_triangles; i++)
        ck_assert_int_eq(node[part->triangles[i]], whole->triangles[i]);
    size_t n, n_whole, found = 0;
    const int32_t *top, *top_of_whole;
    ck_assert_int_eq(palp_mesh_set(part, "top", &n, &top), PALP_OK);
    ck_assert_int_eq(palp_mesh_set(whole, "top", &n_whole, &top_of_whole), PALP_OK);
    for (size_t i = 0; i < n_whole; i++)
        for (size_t k = 0; k < n; k++)
            found += node[top[k]] == top_of_whole[i];
    ck_assert_uint_eq(found, n);
    if (surface)
        ck_assert_uint_eq(n, n_whole);
    palp_mesh_free(part);
    free(node);
    free(element);
    free(solid);
}

START_TEST(parts_make_the_whole) {
    palp_mesh *whole = cube(5, _i & 1 ? PALP_NEIGHBOURS_26 : PALP_NEIGHBOURS_6);
    if (_i & 1)
        ck_assert_int_eq(palp_mesh_scale(whole, PALP_SCALING_CONTINUUM, 0.0, NULL), PALP_OK);
    int32_t *owner = malloc(whole->n_nodes * sizeof *owner);
    int *elements = calloc(whole->n_elements, sizeof *elements);
    size_t tetrahedra = 0;
    for (size_t i = 0; i < whole->n_nodes; i++)
        owner[i] = (int32_t)(i * i / 7 % OWNERS);
    for (int32_t who = 0; who < OWNERS; who++)
        check_part(whole, owner, who, _i & 2, elements, &tetrahedra);
    for (size_t i = 0; i < whole->n_elements; i++)
        ck_assert_int_eq(elements[i], 1);
    ck_assert_uint_eq(tetrahedra, palp_mesh_tetrahedron_count(whole));
    free(owner);
    free(elements);
    palp_mesh_free(whole);
}
END_TEST

/* A process may have nothing. */
START_TEST(a_part_may_be_empty) {
    palp_mesh *whole = cube(3, PALP_NEIGHBOURS_26), *part = NULL;
    int32_t owner[27] = {0}, *node = NULL, *element = NULL, *solid = NULL;
    ck_assert_int_eq(mesh_part(whole, owner, 1, false, &part, &node, &element, &solid), PALP_OK);
    ck_assert_uint_eq(part->n_nodes + part->n_elements + part->n_tetrahedra, 0);
    palp_mesh_free(part);
    palp_mesh_free(whole);
    free(node);
    free(element);
    free(solid);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, parts_make_the_whole, 0, 4);
    tcase_add_test(tc, a_part_may_be_empty);
}
