/* test_network_poisson.c: Poisson's ratio of a network, against the isotropic solid. */
#include "mesh/mesh_internal.h"
#include "network_make.h"
#include "network_settle.h"
#include "tangent_make.h"

#include <palpate/cut.h>
#include <palpate/realtime.h>

#include <stdlib.h>
#include <string.h>

static const double TISSUE = 0.45;

static palp_network_settings poisson(double ratio) {
    palp_network_settings settings = palp_network_settings_default();
    settings.poisson_ratio = ratio;
    return settings;
}

static palp_mesh *solid_cube(size_t n) {
    palp_mesh *mesh = cube(n, PALP_NEIGHBOURS_26);
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, 0.0, NULL), PALP_OK);
    return mesh;
}

static palp_network *solid(size_t n, const palp_material *m, double ratio) {
    const palp_network_settings settings = poisson(ratio);
    palp_mesh *mesh = solid_cube(n);
    palp_network *net = network_on(mesh, m, &settings);
    palp_mesh_free(mesh);
    return net;
}

static palp_material law_of(size_t n, const double *coefficients) {
    palp_material m = {.n_arms = 0};
    ck_assert_int_eq(palp_law_polynomial(n, coefficients, &m.law), PALP_OK);
    return m;
}

/* ---- energy, forces, tangent --------------------------------------------------------------------- */

typedef struct dense_blocks {
    double *k;
    size_t n;
} dense_blocks;

static void take(void *user, int32_t row, int32_t column, const double k[9]) {
    dense_blocks *to = user;
    for (size_t i = 0; i < 9; i++) {
        const size_t r = 3 * (size_t)row + i / 3, c = 3 * (size_t)column + i % 3;
        to->k[r * to->n + c] += k[i];
        if (row != column)
            to->k[c * to->n + r] += k[i];
    }
}

/* Forces are the slope of the energy, the tangent that of the forces; its blocks are the tangent too. Crooked
 * cells, sound and inside out. */
START_TEST(derivatives) {
    const palp_material m = law_of(1, (double[]){8.18});
    const double sizes[] = {0.02, 0.1, 0.8}, h = 1e-8;
    for (size_t s = 0; s < 3; s++) {
        palp_network *net = solid(4, &m, 0.49);
        const size_t n = 3 * net->n_nodes;
        double *x = calloc(6 * n, sizeof *x), *u = x + n, *k = u + n, *low = k + n, *high = low + n;
        dense_blocks blocks = {calloc(n * n, sizeof(double)), n};
        ck_assert(x && blocks.k);
        ck_assert_int_eq(network_begin(net, 0.0, INFINITY), PALP_OK);
        for (size_t i = 0; i < n; i++) {
            x[i] = net->rest[i] +
                   (net->dof[i] < 0 ? 0.0 : sizes[s] * HEIGHT / 3.0 * sin(1.7 * (double)i * (double)i));
            u[i] = net->dof[i] < 0 ? 0.0 : cos(2.3 * (double)i);
        }
        residual_at(net, x, u, -h, low);
        residual_at(net, x, u, h, high);
        const double before = energy_at(net, x, u, -h), after = energy_at(net, x, u, h);
        double along = 0.0, largest = 0.0;
        energy_at(net, x, u, 0.0);
        network_set_diagonal(net, 0.0);
        network_tangent_times(net, u, k);
        for (size_t i = 0; i < n; i++) {
            along += 0.5 * (low[i] + high[i]) * u[i];
            largest = fmax(largest, net->dof[i] < 0 ? 0.0 : fabs(k[i]));
        }
        ck_assert_double_eq_tol((before - after) / (2.0 * h), along, 1e-5 * fabs(along));
        for (size_t i = 0; i < n; i++)
            if (net->dof[i] >= 0)
                ck_assert_double_eq_tol((low[i] - high[i]) / (2.0 * h), k[i], 1e-5 * largest);
        double *product = low;
        memset(product, 0, n * sizeof *product);
        NETWORK_EACH_TERM(net, times, net, u, product);
        NETWORK_EACH_TERM(net, blocks, net, take, &blocks);
        for (size_t i = 0; i < n; i++) {
            double sum = 0.0;
            for (size_t j = 0; j < n; j++)
                sum += blocks.k[i * n + j] * u[j];
            ck_assert_double_eq_tol(sum, product[i], 1e-12 * largest);
        }
        free(x);
        free(blocks.k);
        palp_network_free(net);
    }
}
END_TEST

/* Energy of an even change of size. */
static double energy_of_size(const palp_mesh *mesh, double poissons_ratio, double size) {
    const palp_material m = law_of(1, (double[]){8.18});
    const palp_network_settings settings = poisson(poissons_ratio);
    palp_network *net = network_on(mesh, &m, &settings);
    double energy;
    ck_assert_int_eq(network_begin(net, 0.0, INFINITY), PALP_OK);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        net->next.x[i] = size * net->rest[i];
    ck_assert(network_evaluate(net));
    ck_assert(network_energy(net, &energy));
    palp_network_free(net);
    return energy;
}

/* Even and crooked cells fill the body: an even change of size takes the energy of the body's volume. */
START_TEST(cells_fill_the_body) {
    static const double SIZE = 0.96;
    const double ratio = SIZE * SIZE * SIZE, lambda = 0.4 * 0.8 / 0.1 * 8.18 / (HEIGHT * HEIGHT);
    palp_mesh *mesh = solid_cube(5);
    for (int crooked = 0; crooked < 2; crooked++) {
        double length = 0.0, n[3];
        for (size_t i = 0; i < 3 * mesh->n_nodes && crooked; i++) {
            const double *x = mesh->x_m + i - i % 3;
            bool inside = true;
            for (size_t c = 0; c < 3; c++)
                inside = inside && x[c] > 0.1 * HEIGHT && x[c] < 0.9 * HEIGHT;
            mesh->x_m[i] += inside ? 0.1 * HEIGHT / 4.0 * sin(1.0 + 5.0 * (double)i) : 0.0;
        }
        for (size_t i = 0; i < mesh->n_elements; i++)
            length += mesh->scale[i] * mesh_direction(mesh, mesh->pairs + 2 * i, n);
        const double wanted =
                         length / (6.0 * HEIGHT) * lambda * (ratio - 1.0 - log(ratio)) * pow(HEIGHT, 3.0),
                     got = energy_of_size(mesh, TISSUE, SIZE) - energy_of_size(mesh, 0.0, SIZE);
        ck_assert_double_eq_tol(got, wanted, 1e-9 * wanted);
    }
    palp_mesh_free(mesh);
}
END_TEST

/* The modulus follows the law, also a new one: twice the law is twice the force. */
START_TEST(modulus_follows_the_law) {
    const palp_material m = law_of(3, (double[]){8.0, -3.0, 20.0}),
                        twice = law_of(3, (double[]){16.0, -6.0, 40.0});
    palp_network *net = solid(4, &m, TISSUE);
    ck_assert_int_eq(palp_network_step(net, 0.1 * HEIGHT, INFINITY, NULL), PALP_OK);
    const double force = palp_network_force(net);
    ck_assert_int_eq(palp_network_set_material(net, &twice), PALP_OK);
    ck_assert_int_eq(palp_network_step(net, 0.1 * HEIGHT, INFINITY, NULL), PALP_OK);
    ck_assert_double_eq_tol(palp_network_force(net), 2.0 * force, 1e-8 * force);
    palp_network_free(net);
}
END_TEST

/* ---- a block between plates ---------------------------------------------------------------------- */

/* Force on the top, which moves by depth along axis; *bulge: how far the middle of a side comes out. */
static double moved_top(const palp_mesh *mesh, double ratio, bool corrected, int axis, double depth,
                        double *bulge) {
    const palp_material m = law_of(1, (double[]){8.18});
    palp_network_settings settings = poisson(ratio);
    palp_support supports[2];
    palp_network *net = NULL;
    settings.edge_correction = corrected;
    palp_supports_default(supports);
    for (int k = 0; k < 3; k++) {
        supports[1].axis[k] = k == axis ? PALP_DRIVEN : PALP_FIXED;
        supports[1].motion[k] = k == axis ? -1.0 : 0.0;
    }
    ck_assert_int_eq(palp_network_create(mesh, &m, 2, supports, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_step(net, depth, INFINITY, NULL), PALP_OK);
    const double force = palp_network_force(net);
    *bulge = 0.0;
    for (size_t i = 0; i < 3 * net->n_nodes; i += 3)
        *bulge = fmax(*bulge, (net->now.x[i] - net->rest[i]) / depth);
    palp_network_free(net);
    return force;
}

/* Shear over press and bulge over depth of a bonded cube, as quadratic finite elements have them. */
static const struct {
    double poisson, shear, bulge;
} CONTINUUM[] = {{0.25, 0.254, 0.130}, {0.45, 0.0, 0.277}, {0.49, 0.204, 0.3176}};

START_TEST(sheared_and_pressed) {
    const double ratio = CONTINUUM[_i / 2].poisson;
    const size_t n = _i % 2 ? 11 : 7;
    palp_mesh *mesh = solid_cube(n);
    double bulge, none;
    const double pressed = moved_top(mesh, ratio, true, 1, 1e-3 * HEIGHT, &bulge),
                 shear = moved_top(mesh, ratio, true, 0, 1e-3 * HEIGHT, &none) / pressed;
    ck_assert_msg(fabs(bulge / CONTINUUM[_i / 2].bulge - 1.0) < 0.05, "%zu nodes: bulge %.4f", n, bulge);
    if (CONTINUUM[_i / 2].shear > 0.0)
        ck_assert_msg(fabs(shear / CONTINUUM[_i / 2].shear - 1.0) < 0.05, "%zu nodes: shear over press %.4f",
                      n, shear);
    palp_mesh_free(mesh);
}
END_TEST

/* Tetrahedra do so up to 0.4, and lock beyond. */
START_TEST(tetrahedra_to_a_limit) {
    palp_mesh *mesh = NULL, *cells = solid_cube(5);
    ck_assert_int_eq(palp_mesh_read_gmsh("data/meshes/box_tetra.msh", 1e-3, false, &mesh, NULL), PALP_OK);
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, HEIGHT * HEIGHT, NULL), PALP_OK);
    for (int i = 0; i < 3; i++) {
        const double ratio = 0.25 + 0.05 * i;
        double bulge, none;
        const double pressed = moved_top(mesh, ratio, false, 1, 1e-3 * HEIGHT, &bulge),
                     of_cells = moved_top(cells, ratio, false, 1, 1e-3 * HEIGHT, &none);
        ck_assert_msg(fabs(pressed / of_cells - 1.0) < 0.03, "%.2f: %.4f of the cells' force", ratio,
                      pressed / of_cells);
    }
    palp_mesh_free(mesh);
    palp_mesh_free(cells);
}
END_TEST

/* Pressed by three tenths with the law of a phantom, no tetrahedron turns inside out. */
START_TEST(stable_at_large_strain) {
    const palp_material m = law_of(5, (double[]){8.18, -0.70, 47.47, -131.36, 146.89});
    for (size_t n = 5; n <= 8; n += 3)
        for (int i = 1; i < 3; i++) {
            palp_network *net = solid(n, &m, CONTINUUM[i].poisson);
            palp_step_info info;
            double stable, unstable;
            for (int k = 1; k <= 15; k++) {
                ck_assert_int_eq(palp_network_step(net, 0.02 * k * HEIGHT, INFINITY, &info), PALP_OK);
                ck_assert_uint_eq(info.inverted, 0);
            }
            ck_assert(!palp_network_buckled(net, &stable, &unstable));
            palp_network_free(net);
        }
}
END_TEST

/* ---- what stands on it --------------------------------------------------------------------------- */

/* Poisson's ratio with which a body of this share of the elements' length has the same modulus. */
static double same_modulus(double ratio, double share) {
    const double modulus = 0.4 * (4.0 * ratio - 1.0) / (1.0 - 2.0 * ratio) / share;
    return (modulus + 0.4) / (1.6 + 2.0 * modulus);
}

/* Cut from the side to beyond the middle: pressed, it is the network built without the cut elements, of cells
 * or of tetrahedra. Whole again it is what it was. */
START_TEST(cut_is_built_without) {
    const palp_material m = quartic(1);
    palp_mesh *mesh = solid_cube(5), *part = NULL;
    if (_i) {
        palp_mesh_free(mesh);
        ck_assert_int_eq(palp_mesh_read_gmsh("data/meshes/box_tetra.msh", 1e-3, false, &mesh, NULL), PALP_OK);
        ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, HEIGHT * HEIGHT, NULL), PALP_OK);
    }
    palp_network_settings settings = poisson(TISSUE);
    palp_network *net = network_on(mesh, &m, &settings), *fresh = NULL;
    const double y = 0.45 * HEIGHT, reach = 0.6 * HEIGHT;
    const double blade[2][9] = {{-1, y, -1, reach, y, -1, reach, y, 1}, {-1, y, -1, reach, y, 1, -1, y, 1}};
    double whole = 0.0, length = 0.0, left = 0.0;
    size_t cut;
    ck_assert_int_eq(palp_network_step(net, 0.04 * HEIGHT, 0.01, NULL), PALP_OK);
    whole = palp_network_force(net);
    palp_network_reset(net);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    for (int k = 0; k < 2; k++)
        ck_assert_int_eq(palp_network_cut(net, blade[k], &cut), PALP_OK);
    ck_assert_int_eq(mesh_copy(mesh, &part), PALP_OK);
    for (size_t i = 0; i < mesh->n_elements; i++) {
        double n[3], own = mesh->scale[i] * mesh_direction(mesh, mesh->pairs + 2 * i, n);
        part->scale[i] = palp_network_alive(net)[i] ? mesh->scale[i] : 0.0;
        length += own;
        left += palp_network_alive(net)[i] ? own : 0.0;
    }
    settings = poisson(same_modulus(TISSUE, left / length));
    fresh = network_on(part, &m, &settings);
    for (int i = 1; i <= 20; i++) {
        const double depth = -0.002 * HEIGHT * i;
        ck_assert_int_eq(palp_network_step(net, depth, 0.01, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_step(fresh, depth, 0.01, NULL), PALP_OK);
        ck_assert_double_eq_tol(palp_network_force(net), palp_network_force(fresh),
                                1e-8 * fabs(palp_network_force(fresh)));
    }
    palp_network_reset(net);
    ck_assert_int_eq(palp_network_step(net, 0.04 * HEIGHT, 0.01, NULL), PALP_OK);
    ck_assert_double_eq_tol(palp_network_force(net), whole, 1e-9 * whole);
    palp_network_free(net);
    palp_network_free(fresh);
    palp_mesh_free(mesh);
    palp_mesh_free(part);
}
END_TEST

/* Torn while it is stepped in ticks: converged ticks go on to be steps. */
START_TEST(torn_in_ticks) {
    const palp_material m = quartic(0);
    const palp_realtime_settings ticks = palp_realtime_settings_default();
    const palp_budget all = {.force_error = 1e-9};
    palp_network *net[2] = {solid(5, &m, TISSUE), solid(5, &m, TISSUE)};
    palp_realtime *rt = NULL;
    size_t torn[2], all_torn = 0;
    for (int k = 0; k < 2; k++) {
        ck_assert_int_eq(palp_network_enable_cutting(net[k]), PALP_OK);
        ck_assert_int_eq(palp_network_set_tearing(net[k], 0.12, 0.0), PALP_OK);
    }
    ck_assert_int_eq(palp_realtime_create(net[1], &ticks, &rt), PALP_OK);
    for (int i = 1; i <= 20; i++) {
        palp_tick_info info;
        ck_assert_int_eq(palp_network_step(net[0], -0.01 * HEIGHT * i, INFINITY, NULL), PALP_OK);
        ck_assert_int_eq(palp_realtime_step(rt, -0.01 * HEIGHT * i, INFINITY, &all, &info), PALP_OK);
        ck_assert_double_eq_tol(info.force_N, palp_network_force(net[0]), 1e-6 * fabs(info.force_N));
        for (int k = 0; k < 2; k++)
            ck_assert_int_eq(palp_network_tear(net[k], &torn[k]), PALP_OK);
        ck_assert_uint_eq(torn[0], torn[1]);
        all_torn += torn[0];
        if (all_torn > 0 && i > 15)
            break;
    }
    ck_assert_uint_gt(all_torn, 0);
    palp_realtime_free(rt);
    palp_network_free(net[0]);
    palp_network_free(net[1]);
}
END_TEST

START_TEST(refused) {
    const palp_material m = quartic(0), soft = law_of(2, (double[]){0.0, 8.0});
    const double wrong[] = {-0.3, 0.2, 0.5, NAN, INFINITY};
    palp_mesh *mesh = cube(3, PALP_NEIGHBOURS_26);
    palp_support supports[2];
    palp_network *net = NULL;
    palp_network_settings settings;
    palp_supports_default(supports);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        settings = poisson(wrong[i]);
        ck_assert_int_eq(palp_network_create(mesh, &m, 2, supports, &settings, &net, NULL),
                         PALP_ERR_ARGUMENT);
    }
    settings = poisson(0.4);
    settings.volume_modulus_Pa = 1e4;
    ck_assert_int_eq(palp_network_create(mesh, &m, 2, supports, &settings, &net, NULL), PALP_ERR_ARGUMENT);
    settings.volume_modulus_Pa = 0.0;
    ck_assert_int_eq(palp_network_create(mesh, &soft, 2, supports, &settings, &net, NULL), PALP_ERR_ARGUMENT);
    palp_mesh_free(mesh);
}
END_TEST

/* ---- the law of a solid -------------------------------------------------------------------------- */

/* Force of a neo-Hookean cube of HEIGHT and the shear modulus 1, pressed to this stretch between plates on
 * which it slides: (I1 J^(-2/3) - 3) / 2 + bulk (J - 1)^2 / 2. */
static double neo_hookean(double ratio, double along) {
    const double bulk = 2.0 * (1.0 + ratio) / (3.0 * (1.0 - 2.0 * ratio));
    double low = 1.0, high = 1.0 / sqrt(along), force = 0.0;
    for (int i = 0; i < 60; i++) {
        const double across = 0.5 * (low + high), J = along * across * across, keep = pow(J, -2.0 / 3.0),
                     by_J = bulk * (J - 1.0) - keep * (along * along + 2.0 * across * across) / (3.0 * J);
        *(keep + by_J * along > 0.0 ? &high : &low) = across;
        force = -(keep * along + by_J * across * across) * HEIGHT * HEIGHT;
    }
    return force;
}

/* Force of a cube of elements with this law, pressed so. */
static double evenly_pressed(size_t n, const palp_law *law, double ratio, double strain) {
    static const palp_support SLIDE[] = {{"bottom", {PALP_FREE, PALP_FIXED, PALP_FREE}, {0}},
                                         {"top", {PALP_FREE, PALP_DRIVEN, PALP_FREE}, {0, -1, 0}},
                                         {"low x", {PALP_FIXED, PALP_FREE, PALP_FREE}, {0}},
                                         {"low z", {PALP_FREE, PALP_FREE, PALP_FIXED}, {0}}};
    const palp_network_settings settings = poisson(ratio > 0.25 ? ratio : 0.0);
    const palp_material m = {.law = *law};
    palp_mesh *mesh = solid_cube(n);
    palp_network *net = NULL;
    ck_assert_int_eq(palp_mesh_add_plane_set(mesh, "low x", 0, 0.0, 1e-9), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_plane_set(mesh, "low z", 2, 0.0, 1e-9), PALP_OK);
    ck_assert_int_eq(palp_network_create(mesh, &m, 4, SLIDE, &settings, &net, NULL), PALP_OK);
    for (int i = 1; i <= 4; i++)
        ck_assert_int_eq(palp_network_step(net, 0.25 * i * strain * HEIGHT, INFINITY, NULL), PALP_OK);
    const double force = palp_network_force(net);
    palp_network_free(net);
    palp_mesh_free(mesh);
    return force;
}

/* A cube with that law is pressed as the neo-Hookean one of its modulus; with one stiffness it gets too soft.
 */
START_TEST(law_of_a_solid) {
    static const double RATIO[] = {0.25, 0.35, 0.45, 0.49}, STRAIN[] = {0.001, 0.05, 0.1, 0.15, 0.2, 0.25};
    const double ratio = RATIO[_i], young = 2.0 * (1.0 + ratio);
    palp_mesh *mesh = solid_cube(4);
    palp_law law, one;
    double rest;
    ck_assert_int_eq(palp_law_of_solid(mesh, ratio, young, &law), PALP_OK);
    palp_law_stiffness(&law, 0.0, &rest, NULL);
    ck_assert_double_eq_tol(rest, 2.5 * HEIGHT * HEIGHT, 1e-9 * rest);
    ck_assert_int_eq(palp_law_polynomial(1, &rest, &one), PALP_OK);
    for (size_t i = 0; i < sizeof STRAIN / sizeof *STRAIN; i++) {
        const double off =
            evenly_pressed(4, &law, ratio, STRAIN[i]) / neo_hookean(ratio, 1.0 - STRAIN[i]) - 1.0;
        ck_assert_msg(fabs(off) < 0.005, "ratio %g, strain %g: off by %g", ratio, STRAIN[i], off);
        if (STRAIN[i] == 0.1 || STRAIN[i] == 0.2)
            ck_assert_double_lt(fabs(off), 1e-4);
    }
    ck_assert_double_lt(evenly_pressed(4, &one, ratio, 0.2), 0.93 * neo_hookean(ratio, 0.8));
    ck_assert_int_eq(palp_law_of_solid(mesh, 0.2, young, &law), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_law_of_solid(mesh, 0.5, young, &law), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_law_of_solid(mesh, ratio, 0.0, &law), PALP_ERR_ARGUMENT);
    palp_mesh_free(mesh);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, derivatives);
    tcase_add_loop_test(tc, law_of_a_solid, 0, 4);
    tcase_add_test(tc, cells_fill_the_body);
    tcase_add_test(tc, modulus_follows_the_law);
    tcase_add_loop_test(tc, sheared_and_pressed, 0, 6);
    tcase_add_test(tc, tetrahedra_to_a_limit);
    tcase_add_test(tc, stable_at_large_strain);
    tcase_add_loop_test(tc, cut_is_built_without, 0, 2);
    tcase_add_test(tc, torn_in_ticks);
    tcase_add_test(tc, refused);
}
