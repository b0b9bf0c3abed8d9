/* test_cut_terms.c: all terms together: a network's forces are the slopes of its energy, its tangent theirs.
 */
#include "contact/contact_internal.h"
#include "cut_make.h"
#include "tangent_make.h"

enum { SIDE = 4, INNER = 2 * 16 + 2 * 4 + 1 };
static const double CHANGE = 1e-7; /* m */

/* A block that rests on a foundation, pressed by a sphere, weighed, held at a node, with one node cut loose;
 * within a step from a state that it has moved to. */
static palp_network *everything(void) {
    palp_mesh *mesh = cube(SIDE, PALP_NEIGHBOURS_26);
    palp_material m = quartic(2);
    palp_network_settings settings = palp_network_settings_default();
    palp_contact_settings touch = palp_contact_settings_default();
    palp_support supports[2];
    palp_network *net = NULL;
    palp_supports_default(supports);
    settings.density_kg_m3 = 1070.0;
    touch.gravity_m_s2[1] = -9.81;
    ck_assert_int_eq(palp_network_create(mesh, &m, 1, supports, &settings, &net, NULL), PALP_OK);
    palp_mesh_free(mesh);
    ck_assert_int_eq(palp_network_enable_tools(net, 1, 1, &touch), PALP_OK);
    ck_assert_int_eq(network_set_foundation(net, "top", 0.1), PALP_OK);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    int32_t around[26], corner = SIDE * SIDE * SIDE - 1;
    size_t n = 0;
    for (size_t e = 0; e < 2 * element_count(net); e++)
        if (palp_mesh_pairs(palp_network_mesh(net))[e] == INNER)
            around[n++] = (int32_t)(e / 2);
    ck_assert_uint_eq(n, 26);
    ck_assert_int_eq(palp_network_cut_elements(net, n, around), PALP_OK);
    palp_tool tool = {
        .shape = PALP_TOOL_SPHERE, .position_m = {0.008, HEIGHT + 0.0075, 0.0085}, .radius_m = 0.008};
    ck_assert_int_eq(palp_network_set_tools(net, 1, &tool), PALP_OK);
    double target[3];
    for (size_t k = 0; k < 3; k++)
        target[k] = net->rest[3 * corner + (int)k] + 1e-3;
    ck_assert_int_eq(palp_network_grasp(net, 1, &corner, target), PALP_OK);
    step_to(net, 0.0, 0.02);
    tool.position_m[1] -= 0.0004;
    ck_assert_int_eq(palp_network_set_tools(net, 1, &tool), PALP_OK);
    ck_assert_int_eq(network_begin(net, 0.0, 0.01), PALP_OK);
    return net;
}

/* Moves one free coordinate and evaluates. */
static void moved(palp_network *net, size_t at, double by, double *energy, double *residual) {
    double x = net->next.x[at], scale;
    net->next.x[at] = x + by;
    ck_assert(network_evaluate(net));
    ck_assert(network_energy(net, energy));
    network_residual(net, &scale);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        residual[i] = net->dof[i] < 0 ? 0.0 : net->rhs[net->dof[i]];
    net->next.x[at] = x;
}

START_TEST(forces_are_slopes_of_the_energy) {
    enum { N = 3 * SIDE * SIDE * SIDE };
    palp_network *net = everything();
    double energy[3], force[3][N], unit[N], product[N];
    for (size_t i = 0; i < N; i++)
        net->next.x[i] = net->dof[i] < 0 ? net->now.x[i] : net->now.x[i] + 2e-4 * sin(3.0 + 7.0 * (double)i);
    ck_assert_uint_eq(palp_network_loose(net, NULL), 1);
    for (size_t j = 0; j < N; j++) {
        if (net->dof[j] < 0)
            continue;
        moved(net, j, -CHANGE, &energy[0], force[0]);
        moved(net, j, CHANGE, &energy[1], force[1]);
        moved(net, j, 0.0, &energy[2], force[2]);
        double slope = -(energy[1] - energy[0]) / (2.0 * CHANGE);
        ck_assert_double_eq_tol(force[2][j], slope, 1e-6 * fabs(slope) + 1e-7);
        memset(unit, 0, sizeof unit);
        unit[j] = 1.0;
        network_set_diagonal(net, 0.0);
        network_tangent_times(net, unit, product);
        for (size_t i = 0; i < N; i++)
            if (net->dof[i] >= 0)
                ck_assert_double_eq_tol(product[i], (force[0][i] - force[1][i]) / (2.0 * CHANGE),
                                        1e-4 * fabs(product[j]));
    }
    palp_network_free(net);
}
END_TEST

/* A node that hangs on nothing has a thousandth of the springs it had: 6 along an edge, 12 across a face, 8
 * across a cell, at a strain of 0.1, arms included. */
START_TEST(a_loose_node_has_a_weak_spring) {
    palp_network *net = everything();
    double law = 0.54 - 2.34 * 0.1 + 33.25 * 0.01 - 124.03 * 0.001 + 177.63 * 0.0001, energy,
           force[3 * SIDE * SIDE * SIDE];
    double stiffness =
        1e-3 * (law + 0.4 + 0.15) / (HEIGHT / (SIDE - 1)) * (6.0 + 12.0 / sqrt(2.0) + 8.0 / sqrt(3.0));
    ck_assert_double_eq_tol(cut_spring(cut_of(net), INNER), stiffness, 1e-9 * stiffness);
    ck_assert_double_eq(cut_spring(cut_of(net), INNER + 1), 0.0);
    ck_assert_double_eq_tol(cut_of(net)->diagonal[INNER + 1], 1e-3 * stiffness,
                            1e-12 * stiffness); /* inner as well */
    memcpy(net->next.x, net->now.x, 3 * net->n_nodes * sizeof *net->next.x);
    moved(net, 3 * INNER, 0.0, &energy, force);
    double before = force[3 * INNER];
    moved(net, 3 * INNER, 1e-3, &energy, force); /* its mass pulls too: m / dt^2 of the step of 10 ms */
    double inertia = net->mass[INNER] / 1e-4 * 1e-3;
    double rest[3 * SIDE * SIDE * SIDE] = {0.0}, squares = 0.0,
                                  wanted = 0.0; /* how far rounding leaves it uncertain */
    const network_term *term = &cut_of(net)->term;
    term->kind->residual(term, net, rest, &squares);
    for (size_t k = 0; k < 3; k++)
        wanted += pow(stiffness * net->next.x[3 * INNER + k], 2.0);
    ck_assert_double_eq_tol(squares, wanted, 1e-9 * wanted);
    ck_assert_double_eq_tol(force[3 * INNER] - before, -1e-3 * stiffness - inertia, 1e-9 * inertia);
    palp_network_free(net);
}
END_TEST

/* The residual on nodes under a hand and a tool is divided between them by the stiffness of their springs. */
START_TEST(hands_and_tools_take_what_is_left) {
    palp_network *net = everything();
    const size_t corner = net->n_nodes - 1;
    double weight[SIDE * SIDE * SIDE] = {0.0}, residual[3 * SIDE * SIDE * SIDE], wanted[3] = {0.0}, hand[3],
                                felt[3];
    memcpy(net->next.x, net->now.x, 3 * net->n_nodes * sizeof *net->next.x);
    ck_assert(network_evaluate(net));
    network_finish(net);
    NETWORK_EACH_TERM(net, weigh, net, weight);
    double spring = 100.0 * net->unit[corner] * net->modulus;
    ck_assert_double_eq_tol(weight[corner], spring, 1e-12 * spring);
    size_t touched = 0;
    for (size_t i = 0; i < 3 * net->n_nodes; i++) {
        residual[i] = sin(1.0 + (double)i);
        wanted[i % 3] += weight[i / 3] > 0.0 && i / 3 != corner ? residual[i] : 0.0;
        touched += weight[i / 3] > 0.0;
    }
    ck_assert_uint_ge(touched, 6);
    contact_set *tools = contact_of(net);
    int32_t node = (int32_t)corner;
    contact_set_swap(tools); /* now is what the step gave */
    palp_tool_force before = tools->now.felt[0];
    contact_set_swap(tools);
    NETWORK_EACH_TERM(net, share_residual, net, weight, residual);
    NETWORK_EACH_TERM(net, swap, net);
    for (int k = 0; k < 3; k++) {
        felt[k] = tools->now.felt[0].force_N[k] - before.force_N[k];
        ck_assert_double_eq_tol(felt[k], wanted[k], 1e-12);
    }
    ck_assert_int_eq(palp_network_grasp_force(net, 1, &node, hand), PALP_OK);
    for (size_t k = 0; k < 3; k++) {
        double own = spring * (net->next.x[3 * corner + k] - (net->rest[3 * corner + k] + 1e-3));
        ck_assert_double_eq_tol(hand[k], own + residual[3 * corner + k], 1e-9);
    }
    palp_network_free(net);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, hands_and_tools_take_what_is_left);
    tcase_add_test(tc, a_loose_node_has_a_weak_spring);
    tcase_add_test(tc, forces_are_slopes_of_the_energy);
}
