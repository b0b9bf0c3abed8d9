/* test_mesh_join.c: two meshes as parts of one. */
#include "mesh/mesh_internal.h"
#include "network_make.h"

static double upper_half(void *user, const double x[3]) {
    (void)user;
    return x[1] > 0.5 * HEIGHT ? 1.0 : 0.0;
}

/* A cube of n nodes a side with a region "half", moved up by up. */
static palp_mesh *moved_cube(size_t n, bool scaled, double up) {
    palp_mesh *mesh = cube(n, PALP_NEIGHBOURS_26);
    if (scaled)
        ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, 0.0, NULL), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_region(mesh, "half", upper_half, NULL), PALP_OK);
    ck_assert_int_eq(
        palp_mesh_transform(mesh, (double[]){1, 0, 0, 0, 1, 0, 0, 0, 1}, (double[]){0.0, up, 0.0}), PALP_OK);
    return mesh;
}

/* Everything of both is there; what is said by node or tetrahedron counts on. */
START_TEST(parts_are_there) {
    palp_mesh *first = moved_cube(3, _i == 1, 0.0), *second = moved_cube(4, _i == 0, 0.03), *both = NULL;
    ck_assert_int_eq(palp_mesh_join(first, second, "other", &both), PALP_OK);
    const size_t n = palp_mesh_node_count(first), e = palp_mesh_element_count(first),
                 t = palp_mesh_tetrahedron_count(first);
    ck_assert_uint_eq(palp_mesh_node_count(both), n + palp_mesh_node_count(second));
    ck_assert_uint_eq(palp_mesh_element_count(both), e + palp_mesh_element_count(second));
    ck_assert_uint_eq(palp_mesh_tetrahedron_count(both), t + palp_mesh_tetrahedron_count(second));
    ck_assert_uint_eq(palp_mesh_triangle_count(both),
                      palp_mesh_triangle_count(first) + palp_mesh_triangle_count(second));
    ck_assert_mem_eq(palp_mesh_positions(both), palp_mesh_positions(first), 3 * n * sizeof(double));
    ck_assert_mem_eq(palp_mesh_positions(both) + 3 * n, palp_mesh_positions(second),
                     3 * palp_mesh_node_count(second) * sizeof(double));
    for (size_t i = 0; i < palp_mesh_element_count(both); i++) {
        const palp_mesh *from = i < e ? first : second;
        const size_t own = i < e ? i : i - e;
        const int32_t *pair = palp_mesh_pairs(both) + 2 * i;
        ck_assert_int_eq(pair[0], palp_mesh_pairs(from)[2 * own] + (i < e ? 0 : (int32_t)n));
        ck_assert_uint_eq(palp_mesh_element_between(both, pair[0], pair[1]), i);
        const double *scale = palp_mesh_element_scale(from);
        ck_assert_double_eq(palp_mesh_element_scale(both)[i], scale ? scale[own] : 1.0);
    }
    ck_assert_uint_eq(palp_mesh_element_between(both, 0, (int32_t)n), both->n_elements);
    const int32_t *node, *own;
    size_t count, of_second;
    ck_assert_int_eq(palp_mesh_set(both, "other.top", &count, &node), PALP_OK);
    ck_assert_int_eq(palp_mesh_set(second, "top", &of_second, &own), PALP_OK);
    ck_assert_uint_eq(count, of_second);
    for (size_t i = 0; i < count; i++)
        ck_assert_int_eq(node[i], own[i] + (int32_t)n);
    ck_assert_int_eq(palp_mesh_set(both, "top", &count, &node), PALP_OK);
    ck_assert_uint_eq(count, 9);
    ck_assert_int_eq(palp_mesh_set(both, "other", &count, &node), PALP_OK);
    ck_assert_uint_eq(count, palp_mesh_node_count(second));
    const double *part, *half;
    ck_assert_int_eq(palp_mesh_region(both, "other", &part), PALP_OK);
    for (size_t i = 0; i < palp_mesh_tetrahedron_count(both); i++)
        ck_assert_double_eq(part[i], i < t ? 0.0 : 1.0);
    ck_assert_int_eq(palp_mesh_region(both, "other.half", &part), PALP_OK);
    ck_assert_int_eq(palp_mesh_region(second, "half", &half), PALP_OK);
    ck_assert_double_eq(part[0], 0.0);
    ck_assert_mem_eq(part + t, half, palp_mesh_tetrahedron_count(second) * sizeof *half);
    palp_mesh_free(first);
    palp_mesh_free(second);
    palp_mesh_free(both);
}
END_TEST

static double pressed(const palp_mesh *mesh, const palp_support *support, size_t n_supports,
                      const palp_region *region) {
    palp_material m = {.n_arms = 0};
    palp_network_settings settings = palp_network_settings_default();
    palp_network *net = NULL;
    palp_step_info info;
    settings.regions = region;
    settings.n_regions = region != NULL;
    ck_assert_int_eq(palp_law_polynomial(2, (double[]){0.54, 0.9}, &m.law), PALP_OK);
    ck_assert_int_eq(palp_network_create(mesh, &m, n_supports, support, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_step(net, 2e-3, 0.1, &info), PALP_OK);
    palp_network_free(net);
    return info.force_N;
}

/* Parts that do not touch are pressed as each alone; the second is a region, here three times as stiff. */
START_TEST(parts_are_alone) {
    palp_mesh *first = moved_cube(4, true, 0.0), *second = moved_cube(5, true, 0.03), *both = NULL;
    const palp_support support[] = {{"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0}},
                                    {"top", {PALP_FIXED, PALP_DRIVEN, PALP_FIXED}, {0, -1, 0}},
                                    {"other.bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0}},
                                    {"other.top", {PALP_FIXED, PALP_DRIVEN, PALP_FIXED}, {0, -1, 0}}};
    const palp_region stiffer = {.name = "other", .shape = PALP_REGION_OF_MESH, .stiffness = 3.0};
    ck_assert_int_eq(palp_mesh_join(first, second, "other", &both), PALP_OK);
    const double one = pressed(first, support, 2, NULL), two = pressed(second, support, 2, NULL);
    ck_assert_double_eq_tol(pressed(both, support, 4, NULL) / (one + two), 1.0, 1e-9);
    ck_assert_double_eq_tol(pressed(both, support, 4, &stiffer) / (one + 3.0 * two), 1.0, 1e-9);
    palp_mesh_free(first);
    palp_mesh_free(second);
    palp_mesh_free(both);
}
END_TEST

START_TEST(refused) {
    palp_mesh *first = moved_cube(3, false, 0.0), *second = moved_cube(3, false, 0.03), *both = NULL;
    ck_assert_int_eq(palp_mesh_join(first, second, "", &both), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_mesh_join(first, second, "top", &both), PALP_ERR_INPUT);
    ck_assert_int_eq(palp_mesh_join(first, second, "half", &both), PALP_ERR_INPUT);
    palp_mesh_free(first);
    palp_mesh_free(second);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, parts_are_there, 0, 2);
    tcase_add_test(tc, parts_are_alone);
    tcase_add_test(tc, refused);
}
