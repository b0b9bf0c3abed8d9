/* test_mesh_regions.c: which part of a mesh's solids and elements is in a region. */
#include "mesh/mesh_internal.h"
#include "network_make.h"

#include <palpate/region.h>

static const double PI = 3.14159265358979323846;

static palp_region box_of(double low_y, double high_y) {
    return (palp_region){.name = "box",
                         .shape = PALP_REGION_BOX,
                         .low_m = {-1, low_y, -1},
                         .high_m = {1, high_y, 1},
                         .stiffness = 1};
}

static palp_region ball_of(double radius_m) {
    const double middle = 0.5 * HEIGHT;
    return (palp_region){.name = "ball",
                         .shape = PALP_REGION_SPHERE,
                         .centre_m = {middle, middle, middle},
                         .radius_m = radius_m,
                         .stiffness = 1};
}

static const double *part_of(palp_mesh *mesh, const palp_region *region) {
    const double *part = NULL;
    palp_error error = {PALP_OK, ""};
    palp_status status = palp_region_place_in(mesh, region, &error);
    ck_assert_msg(!status, "%s", error.text);
    ck_assert_int_eq(palp_mesh_region(mesh, region->name, &part), PALP_OK);
    return part;
}

static double volume_of(const palp_mesh *mesh, const double *part) {
    double sum = 0.0;
    for (size_t i = 0; i < mesh->n_tetrahedra; i++)
        sum += part[i] * mesh_volume6(mesh->x_m, mesh->tetrahedra + 4 * i) / 6.0;
    return sum;
}

static palp_mesh *tetrahedra(void) {
    palp_mesh *mesh = NULL;
    ck_assert_int_eq(palp_mesh_read_gmsh("data/meshes/box_tetra.msh", 1e-3, false, &mesh, NULL), PALP_OK);
    return mesh;
}

START_TEST(volumes) {
    for (int i = 0; i < 2; i++) {
        palp_mesh *mesh = i ? tetrahedra() : cube(9, PALP_NEIGHBOURS_26);
        double low[3], high[3];
        palp_mesh_bounds(mesh, low, high);
        palp_region ball = ball_of(0.3 * HEIGHT),
                    slab = box_of(low[1] + 0.37 * HEIGHT, low[1] + 0.81 * HEIGHT);
        for (int k = 0; k < 3; k++)
            ball.centre_m[k] = 0.5 * (low[k] + high[k]);
        const double wanted = 4.0 / 3.0 * PI * pow(0.3 * HEIGHT, 3.0),
                     layer = 0.44 * HEIGHT * (high[0] - low[0]) * (high[2] - low[2]);
        ck_assert_double_eq_tol(volume_of(mesh, part_of(mesh, &ball)), wanted, 0.01 * wanted);
        ck_assert_double_eq_tol(volume_of(mesh, part_of(mesh, &slab)), layer, 0.015 * layer);
        palp_mesh_free(mesh);
    }
}
END_TEST

static size_t count_near(const palp_mesh *mesh, const double *element, double y, double wanted) {
    size_t n = 0;
    for (size_t e = 0; e < mesh->n_elements; e++) {
        const double *a = mesh->x_m + 3 * mesh->pairs[2 * e], *b = mesh->x_m + 3 * mesh->pairs[2 * e + 1];
        if (fabs(0.5 * (a[1] + b[1]) - y) < 1e-9) {
            ck_assert_double_eq_tol(element[e], wanted, 1e-12);
            n++;
        }
    }
    return n;
}

/* The part of every element in a region. */
static double *parts_of_elements(const palp_mesh *mesh, const double *part) {
    double *element = malloc((mesh->n_elements + mesh->n_tetrahedra) * sizeof *element),
           *solid = element + mesh->n_elements;
    mesh_parts_of_solids(mesh, part, solid, NULL);
    ck_assert_int_eq(mesh_mean_around_elements(mesh, solid, element), PALP_OK);
    return element;
}

/* Elements in the plane between two regions belong to both by half, others to one. */
START_TEST(elements_of_a_lattice) {
    palp_mesh *mesh = cube(5, PALP_NEIGHBOURS_26);
    const palp_region upper = box_of(0.5 * HEIGHT, 1.0);
    double *element = parts_of_elements(mesh, part_of(mesh, &upper));
    ck_assert_uint_gt(count_near(mesh, element, 0.5 * HEIGHT, 0.5), 0);
    ck_assert_uint_gt(count_near(mesh, element, 0.25 * HEIGHT, 0.0), 0);
    ck_assert_uint_gt(count_near(mesh, element, 0.625 * HEIGHT, 1.0), 0);
    ck_assert_uint_gt(count_near(mesh, element, HEIGHT, 1.0), 0);
    free(element);
    palp_mesh_free(mesh);
}
END_TEST

/* With the elements across faces too, none is left out, and the whole mesh is all of every element. */
START_TEST(elements_of_tetrahedra) {
    palp_mesh *mesh = tetrahedra();
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, 0.0, NULL), PALP_OK);
    const palp_region all = {
        .name = "all", .shape = PALP_REGION_BOX, .low_m = {-1, -1, -1}, .high_m = {1, 1, 1}};
    double *element = parts_of_elements(mesh, part_of(mesh, &all));
    for (size_t e = 0; e < mesh->n_elements; e++)
        ck_assert_double_eq_tol(element[e], 1.0, 1e-12);
    free(element);
    palp_mesh_free(mesh);
}
END_TEST

static double beyond_all(void *user, const double x[3]) {
    (void)user;
    return x[0] > 0.5 * HEIGHT ? 7.0 : -3.0;
}

START_TEST(by_a_function) {
    palp_mesh *mesh = cube(5, PALP_NEIGHBOURS_26), *copy = NULL;
    const double *part, *same;
    ck_assert_int_eq(palp_mesh_add_region(mesh, "half", beyond_all, NULL), PALP_OK);
    ck_assert_int_eq(palp_mesh_region(mesh, "half", &part), PALP_OK);
    ck_assert_double_eq_tol(volume_of(mesh, part), 0.5 * pow(HEIGHT, 3.0), 1e-18);
    ck_assert_int_eq(mesh_copy(mesh, &copy), PALP_OK);
    ck_assert_int_eq(palp_mesh_region(copy, "half", &same), PALP_OK);
    ck_assert_mem_eq(same, part, mesh->n_tetrahedra * sizeof *part);
    palp_mesh_free(mesh);
    palp_mesh_free(copy);
}
END_TEST

START_TEST(groups_of_volumes) {
    palp_mesh *mesh = NULL;
    const double *part;
    ck_assert_int_eq(palp_mesh_read_gmsh("tests/data/mesh/good_tetra.msh", 1e-3, false, &mesh, NULL),
                     PALP_OK);
    ck_assert_int_eq(palp_mesh_region(mesh, "tissue", &part), PALP_OK);
    for (size_t i = 0; i < mesh->n_tetrahedra; i++)
        ck_assert_double_eq(part[i], 1.0);
    ck_assert_int_eq(palp_mesh_region(mesh, "bottom", &part), PALP_ERR_INPUT);
    palp_mesh_free(mesh);
}
END_TEST

START_TEST(what_is_refused) {
    palp_mesh *mesh = cube(3, PALP_NEIGHBOURS_26), *bare = NULL;
    palp_error error = {PALP_OK, ""};
    palp_region r = ball_of(1e-6);
    const double x[] = {0, 0, 0, 1, 0, 0};

    ck_assert_int_eq(palp_mesh_create(2, x, 1, (int32_t[]){0, 1}, &bare, NULL), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_region(bare, "a", beyond_all, NULL), PALP_ERR_UNSUPPORTED);
    ck_assert_int_eq(palp_mesh_add_region(mesh, "", beyond_all, NULL), PALP_ERR_ARGUMENT);
    r.centre_m[0] = 1.0;
    ck_assert_int_eq(palp_region_place_in(mesh, &r, &error), PALP_ERR_INPUT);
    ck_assert_str_eq(error.text, "no part of the mesh is in the region \"ball\"");
    r.shape = PALP_REGION_OF_MESH;
    ck_assert_int_eq(palp_region_place_in(mesh, &r, &error), PALP_ERR_INPUT);
    ck_assert_str_eq(error.text, "the mesh has no group of volumes called \"ball\"");
    palp_mesh_free(mesh);
    palp_mesh_free(bare);
}
END_TEST

void tests(TCase *tc);
void tests(TCase *tc) {
    tcase_add_test(tc, volumes);
    tcase_add_test(tc, elements_of_a_lattice);
    tcase_add_test(tc, elements_of_tetrahedra);
    tcase_add_test(tc, by_a_function);
    tcase_add_test(tc, groups_of_volumes);
    tcase_add_test(tc, what_is_refused);
}
