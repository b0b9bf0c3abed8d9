/* test_mesh_scale.c: factors of the elements of meshes of tetrahedra, against the solid that they stand for.
 */
#include "mesh/mesh_internal.h"
#include "network_make.h"

#include <stdio.h>

static const double AREA = 4.5e-4; /* m^2 */
static const double MODULUS = 1e3; /* Pa, of the solids */

static palp_mesh *read_mesh(const char *name) {
    char path[64];
    palp_mesh *mesh = NULL;
    palp_error error = {PALP_OK, ""};
    snprintf(path, sizeof path, "data/meshes/%s.msh", name);
    palp_status status = palp_mesh_read_gmsh(path, 1e-3, true, &mesh, &error);
    ck_assert_msg(!status, "%s", error.text);
    return mesh;
}

static palp_mesh *scaled_mesh(const char *name, palp_mesh_scaling scaling) {
    palp_mesh *mesh = read_mesh(name);
    palp_error error = {PALP_OK, ""};
    palp_status status = palp_mesh_scale(mesh, scaling, AREA, &error);
    ck_assert_msg(!status, "%s", error.text);
    return mesh;
}

static double length_of(const palp_mesh *mesh, size_t i, double n[3]) {
    double square = 0.0;
    for (size_t k = 0; k < 3; k++) {
        n[k] =
            mesh->x_m[3 * (size_t)mesh->pairs[2 * i + 1] + k] - mesh->x_m[3 * (size_t)mesh->pairs[2 * i] + k];
        square += n[k] * n[k];
    }
    for (size_t k = 0; k < 3; k++)
        n[k] /= sqrt(square);
    return sqrt(square);
}

/* Force of a network of that one stiffness at a small strain, over it. */
static double small_stiffness(const palp_mesh *mesh, double stiffness_N) {
    palp_material m = {.n_arms = 0};
    palp_network_settings settings = palp_network_settings_default();
    palp_step_info info;
    double low[3], high[3];
    ck_assert_int_eq(palp_law_polynomial(1, &stiffness_N, &m.law), PALP_OK);
    palp_network *net = network_on(mesh, &m, &settings);
    palp_mesh_bounds(mesh, low, high);
    ck_assert_int_eq(palp_network_step(net, 1e-4 * (high[1] - low[1]), INFINITY, &info), PALP_OK);
    palp_network_free(net);
    return info.force_N / 1e-4;
}

/* ---- against the solid --------------------------------------------------------------------------- */

/* N per unit strain between bonded flats, of a modulus of 1 kPa and Poisson's ratio 1/4: CalculiX, quadratic
 * tetrahedra; the bodies' by data/meshes/make_bodies.sh --solid, where they have come to rest. */
static const struct {
    const char *mesh;
    double solid_N;
} BODIES[] = {{"box_tetra", 0.6020},  {"cylinder_tetra", 0.4694}, {"sphere_4.4", 0.2845},
              {"sphere_3.8", 0.2845}, {"sphere_3.2", 0.2845},     {"liver_9", 1.710},
              {"liver_7.5", 1.710},   {"liver_6.5", 1.710}};
enum { N_BODIES = sizeof BODIES / sizeof *BODIES };

START_TEST(networks_are_as_stiff_as_the_solid) {
    palp_mesh *mesh = scaled_mesh(BODIES[_i].mesh, PALP_SCALING_CONTINUUM);
    double got = small_stiffness(mesh, MODULUS * AREA), off = got / BODIES[_i].solid_N - 1.0;
    ck_assert_msg(fabs(off) < 0.03, "%s: %.4f N, %+.1f %%", BODIES[_i].mesh, got, 100.0 * off);
    palp_mesh_free(mesh);
}
END_TEST

/* Energy of an evenly strained body, against 1/2 (lambda tr^2 + 2 mu e:e) V with lambda = mu = 2/5 E. */
START_TEST(even_strain_has_the_solids_energy) {
    static const double strains[][6] = {{1, 1, 1, 0, 0, 0}, {0, -1, 0, 0, 0, 0}, {0.25, -1, 0.25, 0, 0, 0},
                                        {0, 0, 0, 1, 0, 0}, {0, 0, 0, 0, 1, 0},  {1, 0, -1, 0, 0, 1}};
    palp_mesh *mesh = scaled_mesh(BODIES[_i].mesh, PALP_SCALING_CONTINUUM);
    for (size_t s = 0; s < sizeof strains / sizeof *strains; s++) {
        const double *e = strains[s];
        double trace = e[0] + e[1] + e[2], springs = 0.0, n[3];
        double square =
            e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + 2.0 * (e[3] * e[3] + e[4] * e[4] + e[5] * e[5]);
        double solid = 0.5 * 0.4 * MODULUS * (trace * trace + 2.0 * square) * mesh_volume(mesh, NULL);
        for (size_t i = 0; i < mesh->n_elements; i++) {
            double length = length_of(mesh, i, n);
            double along = e[0] * n[0] * n[0] + e[1] * n[1] * n[1] + e[2] * n[2] * n[2] +
                           2.0 * (e[3] * n[0] * n[1] + e[4] * n[1] * n[2] + e[5] * n[0] * n[2]);
            springs += 0.5 * mesh->scale[i] * MODULUS * AREA * along * along * length;
        }
        ck_assert_msg(fabs(springs / solid - 1.0) < 0.06, "%s, strain %zu: %.4f of the solid's energy",
                      BODIES[_i].mesh, s, springs / solid);
    }
    palp_mesh_free(mesh);
}
END_TEST

/* Without the fit the mesh shows: the same cylinder, cut into regular tetrahedra, is a fifth too stiff by
 * volume. */
START_TEST(volume_alone_feels_the_mesh) {
    palp_mesh *mesh = scaled_mesh("cylinder_tetra", PALP_SCALING_VOLUME);
    double sum = 0.0, n[3];
    for (size_t i = 0; i < mesh->n_elements; i++)
        sum += mesh->scale[i] * length_of(mesh, i, n) * AREA;
    ck_assert_double_eq_tol(sum, 6.0 * mesh_volume(mesh, NULL), 1e-12 * sum);
    double off = small_stiffness(mesh, MODULUS * AREA) / 0.4694 - 1.0;
    ck_assert_double_gt(off, 0.1);
    ck_assert_double_lt(off, 0.3);
    palp_mesh_free(mesh);
}
END_TEST

/* ---- against the lattice ------------------------------------------------------------------------- */

/* The lattice's law on the lattice meshed as tetrahedra: one factor does for all depths to a strain of 0.3.
 */
START_TEST(lattice_of_tetrahedra_presses_as_the_lattice) {
    palp_material m = quartic(0);
    palp_mesh *mesh = scaled_mesh("box_tetra", PALP_SCALING_CONTINUUM);
    palp_network_settings settings = palp_network_settings_default();
    palp_network *lattice = cube_network(5, &m, NULL), *net = network_on(mesh, &m, &settings);
    double least = INFINITY, most = 0.0;
    for (int i = 1; i <= 60; i++) {
        ck_assert_int_eq(palp_network_step(lattice, 0.005 * i * HEIGHT, INFINITY, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, 0.005 * i * HEIGHT, INFINITY, NULL), PALP_OK);
        double ratio = palp_network_force(net) / palp_network_force(lattice);
        least = fmin(least, ratio);
        most = fmax(most, ratio);
    }
    ck_assert_msg(most < 1.03 * least, "the ratio goes from %.5f to %.5f", least, most);
    palp_network_free(lattice);
    palp_network_free(net);
    palp_mesh_free(mesh);
}
END_TEST

/* ---- refused meshes and other cases ---- */

START_TEST(scaling_refuses) {
    palp_error error = {PALP_OK, ""};
    palp_mesh *mesh = read_mesh("box_hexa");
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_VOLUME, AREA, &error), PALP_ERR_UNSUPPORTED);
    ck_assert_ptr_null(palp_mesh_element_scale(mesh));
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_NONE, AREA, &error), PALP_OK);
    palp_mesh_free(mesh);
    mesh = cube(3, PALP_NEIGHBOURS_26);
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_VOLUME, 0.0, &error), PALP_ERR_UNSUPPORTED);
    palp_mesh_free(mesh);
    ck_assert_int_eq(palp_mesh_create(2, (double[]){0, 0, 0, 0, 1, 0}, 1, (int32_t[]){0, 1}, &mesh, NULL),
                     PALP_OK);
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_VOLUME, 0.0, NULL), PALP_ERR_UNSUPPORTED);
    palp_mesh_free(mesh);
    mesh = read_mesh("box_tetra");
    static const double bad[] = {-1.0, NAN, INFINITY};
    for (size_t i = 0; i < 3; i++)
        ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_VOLUME, bad[i], NULL), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_mesh_scale(NULL, PALP_SCALING_VOLUME, AREA, NULL), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_mesh_scale(mesh, (palp_mesh_scaling)3, AREA, NULL), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_VOLUME, AREA, NULL), PALP_OK);
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, AREA, NULL), PALP_ERR_ARGUMENT);
    palp_mesh_free(mesh);
}
END_TEST

/* A tetrahedron pressed flat has no volume, nor have its own edges. */
START_TEST(flat_tetrahedra_are_refused) {
    palp_mesh *mesh = read_mesh("box_tetra");
    for (size_t i = 0; i < mesh->n_nodes; i++)
        mesh->x_m[3 * i + 2] = 0.5 * mesh->x_m[3 * i];
    palp_error error = {PALP_OK, ""};
    palp_status status = palp_mesh_scale(mesh, PALP_SCALING_VOLUME, AREA, &error);
    ck_assert_int_eq(status, PALP_ERR_INPUT);
    ck_assert_ptr_nonnull(strstr(error.text, "belongs to no tetrahedron with a volume"));
    palp_mesh_free(mesh);
}
END_TEST

/* Area 0 is the mesh's volume over its height; factors go with 1 / area; a copy has them too. */
START_TEST(area_and_copies) {
    palp_mesh *one = scaled_mesh("box_tetra", PALP_SCALING_CONTINUUM), *own = read_mesh("box_tetra"),
              *copy = NULL;
    ck_assert_int_eq(palp_mesh_scale(own, PALP_SCALING_CONTINUUM, 0.0, NULL), PALP_OK);
    ck_assert_int_eq(mesh_copy(one, &copy), PALP_OK);
    ck_assert_uint_eq(palp_mesh_element_count(copy), palp_mesh_element_count(one));
    for (size_t i = 0; i < one->n_elements; i++) {
        ck_assert_double_eq_tol(own->scale[i] * 576e-6, one->scale[i] * AREA, 1e-9 * AREA);
        ck_assert_double_eq(palp_mesh_element_scale(copy)[i], one->scale[i]);
    }
    palp_mesh_free(one);
    palp_mesh_free(own);
    palp_mesh_free(copy);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, networks_are_as_stiff_as_the_solid, 0, N_BODIES);
    tcase_add_loop_test(tc, even_strain_has_the_solids_energy, 0, N_BODIES);
    tcase_add_test(tc, volume_alone_feels_the_mesh);
    tcase_add_test(tc, lattice_of_tetrahedra_presses_as_the_lattice);
    tcase_add_test(tc, scaling_refuses);
    tcase_add_test(tc, flat_tetrahedra_are_refused);
    tcase_add_test(tc, area_and_copies);
}
