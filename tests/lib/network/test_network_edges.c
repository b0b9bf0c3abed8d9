/* test_network_edges.c: a bonded block is the solid, for cells that are corrected at its edges. */
#include "mesh/mesh_internal.h"
#include "network_settle.h"

enum { RATIOS = 4 };
static const double RATIO[RATIOS] = {0.25, 0.3, 0.45, 0.49};

static palp_mesh *box(const size_t nodes[3]) {
    palp_mesh *mesh = NULL;
    ck_assert_int_eq(palp_mesh_lattice(nodes, (double[]){HEIGHT, HEIGHT, HEIGHT}, PALP_NEIGHBOURS_26, &mesh),
                     PALP_OK);
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, 0.0, NULL), PALP_OK);
    return mesh;
}

static palp_network_settings settings_of(double ratio, bool corrected) {
    palp_network_settings settings = palp_network_settings_default();
    settings.poisson_ratio = ratio > 0.25 ? ratio : 0.0;
    settings.edge_correction = corrected;
    return settings;
}

/* Force of a cube between bonded plates over that of a bar of its modulus, at small strain. */
static double press(const size_t nodes[3], double ratio, bool corrected) {
    const double stiffness = 8.0, depth = 1e-6 * HEIGHT;
    palp_material m = {.n_arms = 0};
    palp_mesh *mesh = box(nodes);
    const palp_network_settings settings = settings_of(ratio, corrected);
    ck_assert_int_eq(palp_law_polynomial(1, &stiffness, &m.law), PALP_OK);
    palp_network *net = network_on(mesh, &m, &settings);
    ck_assert_int_eq(palp_network_step(net, depth, INFINITY, NULL), PALP_OK);
    const double over = palp_network_force(net) / (0.8 * (1.0 + ratio) * stiffness * depth / HEIGHT);
    palp_network_free(net);
    palp_mesh_free(mesh);
    return over;
}

/* SOLID: of quadratic elements, from data/contact/edge_factor.py cube. The law of the correction was found
 * on a strip in plane strain. */
START_TEST(a_bonded_cube_is_the_solid) {
    static const double SOLID[RATIOS] = {1.0426, 1.0640, 1.1729, 1.2206};
    static const struct {
        size_t nodes[3];
        double within;
    } CASE[] = {{{5, 5, 5}, 0.011},
                {{7, 7, 7}, 0.004},
                {{11, 11, 11}, 0.003},
                {{7, 10, 7}, 0.012},
                {{9, 7, 9}, 0.004}};
    for (size_t i = 0; i < sizeof CASE / sizeof *CASE; i++) {
        const double without = press(CASE[i].nodes, RATIO[_i], false) / SOLID[_i],
                     with = press(CASE[i].nodes, RATIO[_i], true) / SOLID[_i];
        ck_assert_msg(fabs(with - 1.0) < CASE[i].within, "%g, %zu x %zu: %.4f", RATIO[_i], CASE[i].nodes[0],
                      CASE[i].nodes[1], with);
        ck_assert_msg(without - 1.0 > 2.0 * fabs(with - 1.0), "%g, %zu x %zu: %.4f without, %.4f with",
                      RATIO[_i], CASE[i].nodes[0], CASE[i].nodes[1], without, with);
    }
}
END_TEST

/* Only cells at an edge of a bonded face differ, and only their springs. */
START_TEST(only_edges_of_bonded_faces_change) {
    const palp_material m = quartic(0);
    const palp_network_settings settings = settings_of(0.45, true);
    palp_mesh *mesh = box((size_t[]){5, 5, 5});
    palp_support supports[2];
    palp_supports_default(supports);
    for (size_t bonded = 0; bonded < 3; bonded++) { /* none, the floor, both */
        palp_network *net = NULL;
        size_t softer = 0, wanted = 0;
        for (size_t s = 0; s < 2; s++)
            supports[s].axis[0] = s < bonded ? PALP_FIXED : PALP_FREE;
        ck_assert_int_eq(palp_network_create(mesh, &m, 2, supports, &settings, &net, NULL), PALP_OK);
        const double *scale = palp_network_element_scale(net), *plain = palp_mesh_element_scale(mesh),
                     *x = palp_mesh_positions(mesh);
        for (size_t i = 0; i < element_count(net); i++) {
            const int32_t *pair = palp_mesh_pairs(mesh) + 2 * i;
            double low[3], high[3];
            for (size_t k = 0; k < 3; k++) {
                low[k] = fmin(x[3 * pair[0] + (int)k], x[3 * pair[1] + (int)k]) / HEIGHT;
                high[k] = fmax(x[3 * pair[0] + (int)k], x[3 * pair[1] + (int)k]) / HEIGHT;
            }
            const bool rim = high[0] < 0.3 || low[0] > 0.7 || high[2] < 0.3 || low[2] > 0.7;
            const bool reached = rim && ((bonded > 0 && high[1] < 0.3) || (bonded > 1 && low[1] > 0.7));
            softer += scale[i] < plain[i] * (1.0 - 1e-9);
            wanted += reached;
            ck_assert_msg(reached || fabs(scale[i] / plain[i] - 1.0) < 1e-12, "element %zu: %g", i,
                          scale[i] / plain[i]);
            ck_assert(scale[i] > 0.7 * plain[i]);
        }
        ck_assert_uint_eq(softer, wanted);
        palp_network_free(net);
    }
    palp_mesh_free(mesh);
}
END_TEST

/* Setting aside, nothing changes in a network of another scaling, of 6 neighbours or of tetrahedra. */
START_TEST(other_networks_stay_as_they_are) {
    const palp_material m = quartic(1);
    palp_network *net[2];
    for (int c = 0; c < 2; c++) {
        const palp_network_settings settings = settings_of(0.45, c);
        palp_mesh *mesh = cube(4, PALP_NEIGHBOURS_26); /* not scaled */
        net[c] = network_on(mesh, &m, &settings);
        ck_assert_int_eq(palp_network_step(net[c], 2e-3, 0.1, NULL), PALP_OK);
        palp_mesh_free(mesh);
    }
    snapshot first = snapshot_take(net[0]);
    ck_assert(still_at(net[1], &first));
    snapshot_free(&first);
    palp_network_free(net[0]);
    palp_network_free(net[1]);
}
END_TEST

/* A state does not go to a network without the correction. */
START_TEST(state_belongs_to_it) {
    const palp_material m = quartic(1);
    palp_mesh *mesh = box((size_t[]){4, 4, 4});
    palp_network *net[2];
    for (int c = 0; c < 2; c++) {
        const palp_network_settings settings = settings_of(0.45, c);
        net[c] = network_on(mesh, &m, &settings);
    }
    const size_t size = palp_network_state_size(net[1]);
    void *state = malloc(size);
    ck_assert(state != NULL);
    ck_assert_int_eq(palp_network_save(net[1], state, size), PALP_OK);
    ck_assert_int_eq(palp_network_restore(net[0], state, size), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_restore(net[1], state, size), PALP_OK);
    free(state);
    for (int c = 0; c < 2; c++)
        palp_network_free(net[c]);
    palp_mesh_free(mesh);
}
END_TEST

/* Regions multiply their stiffness with that of the edges; forces are derivatives of the energy. */
START_TEST(regions_and_edges_multiply) {
    palp_material m = quartic(0);
    palp_mesh *mesh = box((size_t[]){4, 4, 4});
    const palp_region stiff = {.name = "all", .shape = PALP_REGION_BOX, .stiffness = 3.0};
    palp_network_settings settings = settings_of(0.45, true);
    double *part = malloc(palp_mesh_tetrahedron_count(mesh) * sizeof *part);
    ck_assert(part != NULL);
    for (size_t i = 0; i < palp_mesh_tetrahedron_count(mesh); i++)
        part[i] = 1.0;
    ck_assert_int_eq(mesh_take_region(mesh, "all", part), PALP_OK);
    palp_network *plain = network_on(mesh, &m, &settings);
    settings.n_regions = 1;
    settings.regions = &stiff;
    palp_network *stiffer = network_on(mesh, &m, &settings);
    ck_assert_int_eq(palp_network_step(plain, 2e-3, INFINITY, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_step(stiffer, 2e-3, INFINITY, NULL), PALP_OK);
    const double ratio = palp_network_force(stiffer) / palp_network_force(plain), h = 1e-6;
    ck_assert_msg(fabs(ratio / 3.0 - 1.0) < 1e-9, "%.12f", ratio);
    double energy[2], depth[2] = {2e-3 - h, 2e-3 + h};
    for (int i = 0; i < 2; i++) {
        ck_assert_int_eq(palp_network_step(stiffer, depth[i], INFINITY, NULL), PALP_OK);
        ck_assert(network_energy(stiffer, &energy[i]));
    }
    ck_assert_int_eq(palp_network_step(stiffer, 2e-3, INFINITY, NULL), PALP_OK);
    const double slope = (energy[1] - energy[0]) / (2.0 * h), force = palp_network_force(stiffer);
    ck_assert_msg(fabs(slope / force - 1.0) < 1e-6, "%.9g not %.9g", slope, force);
    free(part);
    palp_network_free(plain);
    palp_network_free(stiffer);
    palp_mesh_free(mesh);
}
END_TEST

void tests(TCase *tc);
void tests(TCase *tc) {
    tcase_add_loop_test(tc, a_bonded_cube_is_the_solid, 0, RATIOS);
    tcase_add_test(tc, only_edges_of_bonded_faces_change);
    tcase_add_test(tc, other_networks_stay_as_they_are);
    tcase_add_test(tc, state_belongs_to_it);
    tcase_add_test(tc, regions_and_edges_multiply);
}
