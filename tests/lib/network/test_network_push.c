/* test_network_push.c: given forces on nodes and given velocities. */
#include "network_settle.h"

#include <palpate/realtime.h>

static palp_network *standing(size_t n, const palp_material *m, double density) {
    const palp_support bottom = {"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0}};
    palp_network_settings settings = palp_network_settings_default();
    palp_mesh *mesh = cube(n, PALP_NEIGHBOURS_26);
    palp_network *net = NULL;
    settings.density_kg_m3 = density;
    ck_assert_int_eq(palp_network_create(mesh, m, 1, &bottom, &settings, &net, NULL), PALP_OK);
    palp_mesh_free(mesh);
    return net;
}

static void top_of(const palp_network *net, size_t *n, const int32_t **nodes) {
    ck_assert_int_eq(palp_mesh_set(palp_network_mesh(net), "top", n, nodes), PALP_OK);
}

/* What stands on the bottom presses it: forces on the top are the reaction, and the moved top does their
 * work. */
START_TEST(supports_carry_them) {
    const palp_material m = quartic(0);
    palp_network *net = standing(5, &m, 0.0);
    double force[3 * 25], reaction[3];
    const int32_t *nodes;
    size_t n;
    top_of(net, &n, &nodes);
    for (size_t i = 0; i < 3 * n; i++)
        force[i] = i % 3 == 1 ? -0.01 : i % 3 == 0 ? 0.002 : 0.0;
    ck_assert_int_eq(palp_network_set_forces(net, n, nodes, force), PALP_OK);
    ck_assert_int_eq(palp_network_step(net, 0.0, INFINITY, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_reaction(net, "bottom", reaction), PALP_OK);
    ck_assert_double_eq_tol(reaction[0], 0.002 * (double)n, 1e-9);
    ck_assert_double_eq_tol(reaction[1], -0.01 * (double)n, 1e-9);
    ck_assert_double_lt(palp_network_positions(net)[3 * nodes[12] + 1], HEIGHT);
    ck_assert_int_eq(palp_network_set_forces(net, 0, NULL, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_step(net, 0.0, INFINITY, NULL), PALP_OK);
    ck_assert_double_eq_tol(palp_network_positions(net)[3 * nodes[12] + 1], HEIGHT, 1e-9);
    palp_network_free(net);
}
END_TEST

/* The same forces as a plate's, node by node, give the plate's positions. */
START_TEST(as_a_plate_presses) {
    const palp_material m = quartic(1);
    palp_network *pressed = cube_network(4, &m, NULL), *pushed = standing(4, &m, 0.0);
    double force[3 * 16];
    const int32_t *nodes;
    size_t n;
    top_of(pushed, &n, &nodes);
    for (int i = 1; i <= 5; i++) {
        ck_assert_int_eq(palp_network_step(pressed, 0.01 * i * HEIGHT, 0.05, NULL), PALP_OK);
        for (size_t k = 0; k < 3 * n; k++)
            force[k] = -pressed->now.inner[3 * (size_t)nodes[k / 3] + k % 3];
        ck_assert_int_eq(palp_network_set_forces(pushed, n, nodes, force), PALP_OK);
        ck_assert_int_eq(palp_network_step(pushed, 0.0, 0.05, NULL), PALP_OK);
        for (size_t k = 0; k < 3 * pressed->n_nodes; k++)
            ck_assert_double_eq_tol(pressed->now.x[k], pushed->now.x[k], 1e-8 * HEIGHT);
    }
    palp_network_free(pressed);
    palp_network_free(pushed);
}
END_TEST

/* In ticks too, and a saved state has them. */
START_TEST(in_ticks_and_states) {
    const palp_material m = quartic(1);
    palp_network *net = standing(5, &m, 1000.0), *whole = standing(5, &m, 1000.0);
    const palp_realtime_settings settings = palp_realtime_settings_default();
    const palp_budget budget = {.corrections = 3};
    palp_realtime *rt = NULL;
    palp_tick_info info;
    const int32_t *nodes;
    size_t n;
    top_of(net, &n, &nodes);
    const double force[3] = {0.01, -0.05, 0.0};
    for (int i = 0; i < 2; i++)
        ck_assert_int_eq(palp_network_set_forces(i ? whole : net, 1, nodes + 12, force), PALP_OK);
    ck_assert_int_eq(palp_realtime_create(net, &settings, &rt), PALP_OK);
    ck_assert_int_eq(palp_network_set_forces(net, 1, nodes + 12, force), PALP_OK);
    for (int i = 0; i < 200; i++) {
        ck_assert_int_eq(palp_realtime_step(rt, 0.0, 1e-3, &budget, &info), PALP_OK);
        ck_assert_int_eq(palp_network_step(whole, 0.0, 1e-3, NULL), PALP_OK);
    }
    for (size_t k = 0; k < 3 * net->n_nodes; k++)
        ck_assert_double_eq_tol(net->now.x[k], whole->now.x[k], 1e-4 * HEIGHT);
    ck_assert_double_lt(net->now.x[3 * nodes[12] + 1], HEIGHT - 1e-4);
    void *buffer = malloc(palp_network_state_size(whole));
    double at[2];
    ck_assert_int_eq(palp_network_save(whole, buffer, palp_network_state_size(whole)), PALP_OK);
    for (int i = 0; i < 2; i++) {
        ck_assert_int_eq(palp_network_restore(whole, buffer, palp_network_state_size(whole)), PALP_OK);
        ck_assert_int_eq(palp_network_step(whole, 0.0, 0.01, NULL), PALP_OK);
        at[i] = whole->now.x[3 * nodes[12] + 1];
        ck_assert_int_eq(palp_network_set_forces(whole, 0, NULL, NULL), PALP_OK);
    }
    ck_assert_double_eq_tol(at[0], at[1], 1e-9);
    free(buffer);
    palp_realtime_free(rt);
    palp_network_free(net);
    palp_network_free(whole);
}
END_TEST

/* A free cube that is thrown keeps its momentum; its centre flies straight on. */
START_TEST(thrown) {
    const palp_material m = quartic(0);
    palp_network_settings settings = palp_network_settings_default();
    palp_mesh *mesh = cube(3, PALP_NEIGHBOURS_26);
    palp_network *net = NULL;
    settings.density_kg_m3 = 1000.0;
    settings.integrator = PALP_GENERALIZED_ALPHA;
    ck_assert_int_eq(palp_network_create(mesh, &m, 0, NULL, &settings, &net, NULL), PALP_OK);
    double v[81], momentum[3] = {0}, mass = 0.0, centre[3] = {0};
    for (size_t i = 0; i < 81; i++) {
        v[i] = 0.1 * (double)(i % 3) + 0.02 * sin((double)i);
        momentum[i % 3] += net->mass[i / 3] * v[i];
        mass += i % 3 == 0 ? net->mass[i / 3] : 0.0;
    }
    ck_assert_int_eq(palp_network_set_velocities(net, v), PALP_OK);
    for (int i = 0; i < 100; i++)
        ck_assert_int_eq(palp_network_step(net, 0.0, 1e-3, NULL), PALP_OK);
    for (size_t i = 0; i < 81; i++) {
        centre[i % 3] += net->mass[i / 3] * (net->now.x[i] - net->rest[i]) / mass;
        momentum[i % 3] -= net->mass[i / 3] * palp_network_velocities(net)[i];
    }
    for (int k = 0; k < 3; k++)
        ck_assert_double_eq_tol(momentum[k], 0.0, 1e-9 * mass);
    ck_assert_double_eq_tol(centre[2], 0.1 * 0.2, 0.002);
    palp_network_free(net);
    palp_mesh_free(mesh);
}
END_TEST

START_TEST(what_is_refused) {
    const palp_material m = quartic(0);
    palp_network *net = cube_network(3, &m, NULL);
    const double good[81] = {0.0}, bad[3] = {0.0, NAN, 0.0};
    ck_assert_int_eq(palp_network_set_forces(net, 1, (int32_t[]){27}, good), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_set_forces(net, 1, (int32_t[]){-1}, good), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_set_forces(net, 1, (int32_t[]){0}, bad), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_set_velocities(net, good), PALP_ERR_UNSUPPORTED);
    ck_assert_ptr_null(palp_network_velocities(net));
    palp_network_free(net);
}
END_TEST

void tests(TCase *tc);
void tests(TCase *tc) {
    tcase_add_test(tc, supports_carry_them);
    tcase_add_test(tc, as_a_plate_presses);
    tcase_add_test(tc, in_ticks_and_states);
    tcase_add_test(tc, thrown);
    tcase_add_test(tc, what_is_refused);
}
