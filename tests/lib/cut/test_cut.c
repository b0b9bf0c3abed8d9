/* test_cut.c: a network with cuts bears the force of a new one without the cut elements; tearing; misuse. */
#include "cut_make.h"

/* ---- forces -------------------------------------------------------------------------------------- */

START_TEST(cut_through_bears_no_force) {
    palp_material m = material_of(_i);
    palp_network *net = cuttable(4, &m);
    for (int k = 1; k <= 5; k++)
        step_to(net, 0.02 * k * HEIGHT, 0.02);
    ck_assert_double_gt(palp_network_force(net), 0.01);
    cut_level(net, 0.5 * HEIGHT, 1.0);
    step_to(net, 0.1 * HEIGHT, 0.001);
    step_to(net, 0.12 * HEIGHT, 0.001);
    ck_assert_double_eq_tol(palp_network_force(net), 0.0, 1e-10);
    ck_assert_uint_eq(palp_network_loose(net, NULL), 0); /* the top part hangs on the plate */
    double top[3], bottom[3];
    ck_assert_int_eq(palp_network_reaction(net, "top", top), PALP_OK);
    ck_assert_int_eq(palp_network_reaction(net, "bottom", bottom), PALP_OK);
    for (size_t k = 0; k < 3; k++) {
        ck_assert_double_eq_tol(top[k], 0.0, 1e-10);
        ck_assert_double_eq_tol(bottom[k], 0.0, 1e-10);
    }
    palp_network_free(net);
}
END_TEST

/* Cut while pressed, half through, then led to the relaxed state: as a network that never had the elements.
 */
START_TEST(half_through_is_as_built_without) {
    palp_material m = quartic(_i == 0 ? 0 : 2);
    palp_network *net = cuttable(5, &m);
    for (int k = 1; k <= 5; k++)
        step_to(net, 0.02 * k * HEIGHT, 0.02);
    double whole = palp_network_force(net);
    ck_assert_uint_gt(cut_level(net, 0.37 * HEIGHT, 0.6 * HEIGHT), 50);
    step_to(net, 0.1 * HEIGHT, INFINITY);
    palp_network *fresh = afresh(net, &m, NULL);
    for (int k = 1; k <= 5; k++)
        step_to(fresh, 0.02 * k * HEIGHT, INFINITY);
    double force = palp_network_force(fresh);
    ck_assert_double_lt(force, 0.98 * whole);
    ck_assert_double_eq_tol(palp_network_force(net), force, 1e-8 * force);
    palp_network_free(fresh);
    palp_network_free(net);
}
END_TEST

/* The history after a cut: the same elements cut at rest, the same motion, the same forces all along. */
START_TEST(cut_elements_are_as_if_never_there) {
    palp_material m = material_of(_i);
    palp_network *net = cuttable(4, &m);
    cut_level(net, 0.4 * HEIGHT, 0.5 * HEIGHT);
    palp_network *fresh = afresh(net, &m, NULL);
    for (int k = 1; k <= 8; k++) {
        step_to(net, 0.02 * k * HEIGHT, 0.02);
        step_to(fresh, 0.02 * k * HEIGHT, 0.02);
        double force = palp_network_force(fresh);
        ck_assert_double_eq_tol(palp_network_force(net), force, 1e-9 * force);
    }
    palp_network_free(fresh);
    palp_network_free(net);
}
END_TEST

/* A box of nodes cut out on all sides stays where it was, and the other nodes behave as without it. */
START_TEST(a_loose_part_stays_where_it_was) {
    palp_material m = quartic(1);
    palp_network *net = cuttable(6, &m);
    for (int k = 1; k <= 4; k++)
        step_to(net, 0.02 * k * HEIGHT, 0.02);
    const double low = 0.3 * HEIGHT, wide = 0.4 * HEIGHT;
    for (size_t axis = 0; axis < 3; axis++)
        for (int side = 0; side < 2; side++) {
            double o[3] = {low, low, low}, u[3] = {0}, v[3] = {0};
            o[axis] += side * wide;
            u[(axis + 1) % 3] = v[(axis + 2) % 3] = wide;
            cut_rectangle(net, o, u, v);
        }
    unsigned char loose[216];
    ck_assert_uint_eq(palp_network_loose(net, loose), 8);
    for (int k = 0; k < 8; k++) /* the part relaxes against its springs */
        step_to(net, 0.08 * HEIGHT, INFINITY);
    double before[648];
    memcpy(before, palp_network_positions(net), sizeof before);
    for (int k = 5; k <= 24; k++)
        step_to(net, (0.08 + 0.002 * (k - 4)) * HEIGHT, INFINITY);
    for (size_t i = 0; i < 216; i++)
        for (size_t k = 0; k < 3 && loose[i]; k++)
            ck_assert_double_eq_tol(palp_network_positions(net)[3 * i + k], before[3 * i + k], 1e-7 * HEIGHT);
    palp_network *fresh = afresh(net, &m, NULL);
    ck_assert_uint_eq(node_count(fresh), 208);
    for (int k = 1; k <= 6; k++)
        step_to(fresh, 0.02 * k * HEIGHT, INFINITY);
    double force = palp_network_force(fresh);
    ck_assert_double_eq_tol(palp_network_force(net), force, 1e-8 * force);
    palp_network_free(fresh);
    palp_network_free(net);
}
END_TEST

/* Nodes left with one element, two or none are no obstacle, and bear nothing. */
START_TEST(mechanisms_bear_nothing) {
    palp_material m = quartic(0);
    palp_network *net = cuttable(4, &m), *part = cuttable(4, &m);
    const int32_t node = 2 * 16 + 2 * 4 + 1; /* inside */
    int32_t all[26], n_all = 0;              /* by neighbour: the last two are not in line */
    for (int32_t other = 0; other < 64; other++) {
        size_t e = palp_mesh_element_between(palp_network_mesh(net), node, other);
        if (e < element_count(net))
            all[n_all++] = (int32_t)e;
    }
    ck_assert_int_eq(n_all, 26);
    for (int k = 1; k <= 4; k++)
        step_to(net, 0.02 * k * HEIGHT, INFINITY);
    ck_assert_int_eq(palp_network_cut_elements(net, (size_t)(26 - _i), all), PALP_OK);
    ck_assert_int_eq(palp_network_cut_elements(part, 26, all), PALP_OK);
    ck_assert_uint_eq(palp_network_loose(net, NULL), _i == 0 ? 1 : 0);
    for (int k = 1; k <= 4; k++)
        step_to(part, 0.02 * k * HEIGHT, INFINITY);
    for (int k = 0; k < 3; k++)
        step_to(net, 0.08 * HEIGHT, INFINITY);
    double force = palp_network_force(part);
    ck_assert_double_eq_tol(palp_network_force(net), force, 1e-8 * force);
    palp_network_free(part);
    palp_network_free(net);
}
END_TEST

/* ---- tearing ------------------------------------------------------------------------------------- */

/* Three parallel springs of 10, 20 and 24 mm from fixed feet to one plate, K = 2 N: strain d / L each. */
static palp_network *bundle(void) {
    static const double x[] = {0, 0.014,  0, 0.01, 0.004,  0, 0.02, 0,      0,
                               0, HEIGHT, 0, 0.01, HEIGHT, 0, 0.02, HEIGHT, 0};
    static const int32_t pairs[] = {0, 3, 1, 4, 2, 5, 0, 1, 1, 2};
    palp_mesh *mesh = NULL;
    palp_material m = {.n_arms = 0};
    palp_network *net = NULL;
    const double stiffness = 2.0;
    palp_support supports[2];
    palp_network_settings settings = palp_network_settings_default();
    ck_assert_int_eq(palp_law_polynomial(1, &stiffness, &m.law), PALP_OK);
    ck_assert_int_eq(palp_mesh_create(6, x, 5, pairs, &mesh, NULL), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_set(mesh, "bottom", 3, (int32_t[]){0, 1, 2}), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_set(mesh, "top", 3, (int32_t[]){3, 4, 5}), PALP_OK);
    palp_supports_default(supports);
    ck_assert_int_eq(palp_network_create(mesh, &m, 2, supports, &settings, &net, NULL), PALP_OK);
    palp_mesh_free(mesh);
    return net;
}

START_TEST(a_bundle_tears_one_by_one) {
    static const double length[] = {0.010, 0.020, 0.024};
    palp_network *net = bundle();
    bool by_force = _i == 1;
    size_t left = 3;
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    ck_assert_int_eq(palp_network_set_tearing(net, by_force ? 0.0 : 0.3, by_force ? 0.6 : 0.0), PALP_OK);
    for (int k = 1; k <= 80;
         k++) { /* 0.1 mm upwards each; strain 0.3, 0.6 N, is reached at 3, 6 and 7.2 mm */
        double up = 1e-4 * k, force = 0.0;
        size_t torn = 9, n = 0, expected = 0;
        step_to(net, -up, 1.0);
        for (size_t i = 3 - left; i < 3; i++)
            force += 2.0 * up / length[i];
        ck_assert_double_eq_tol(-palp_network_force(net), force, 1e-12);
        ck_assert_int_eq(palp_network_tear(net, &torn), PALP_OK);
        for (size_t i = 0; i < 3; i++) {
            expected += up / length[i] > 0.3 + 1e-9;
            n += !palp_network_alive(net)[i];
        }
        if (fabs(up / 0.3 - 0.01) > 1e-7 && fabs(up / 0.3 - 0.02) > 1e-7 && fabs(up / 0.3 - 0.024) > 1e-7)
            ck_assert_uint_eq(n, expected);
        ck_assert_uint_eq(torn, n - (3 - left));
        left = 3 - n;
    }
    ck_assert_uint_eq(left, 0);
    palp_network_free(net);
}
END_TEST

/* Two springs in a row bear the same force: the shorter rest length stretches as much, both tear at once and
 * the node between them is loose. Pressing tears nothing. */
START_TEST(a_chain_tears_in_tension_only) {
    palp_material m = quartic(0);
    palp_network *net = column_of(3, &m);
    size_t torn;
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    ck_assert_int_eq(palp_network_set_tearing(net, 0.2, 0.0), PALP_OK);
    step_to(net, 0.3 * HEIGHT, 1.0);
    ck_assert_int_eq(palp_network_tear(net, &torn), PALP_OK);
    ck_assert_uint_eq(torn, 0);
    step_to(net, -0.19 * HEIGHT, 1.0);
    ck_assert_int_eq(palp_network_tear(net, &torn), PALP_OK);
    ck_assert_uint_eq(torn, 0);
    step_to(net, -0.21 * HEIGHT, 1.0);
    ck_assert_int_eq(palp_network_tear(net, &torn), PALP_OK);
    ck_assert_uint_eq(torn, 2);
    step_to(net, -0.25 * HEIGHT, 1.0);
    ck_assert_double_eq(palp_network_force(net), 0.0);
    palp_network_free(net);
}
END_TEST

/* ---- misuse -------------------------------------------------------------------------------------- */

START_TEST(misuse_is_refused) {
    palp_material m = quartic(0);
    palp_network *net = cube_network(3, &m, NULL);
    double blade[9] = {0, 0, 0, 1, 0, 0, 0, 0, 1};
    const int32_t *s, bad = 158, negative = -1;
    size_t n;
    unsigned char loose[27];
    ck_assert_int_eq(palp_network_cut(net, blade, &n), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_tear(net, &n), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_set_tearing(net, 0.1, 0.0), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_cut_elements(net, 0, NULL), PALP_ERR_ARGUMENT);
    ck_assert_ptr_null(palp_network_alive(net));
    memset(loose, 9, sizeof loose);
    ck_assert_uint_eq(palp_network_loose(net, loose), 0);
    ck_assert_int_eq(loose[26], 0);
    ck_assert_int_eq(palp_network_surface(net, &n, &s), PALP_OK);
    ck_assert_uint_eq(n, 48);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
    ck_assert_int_eq(palp_network_enable_cutting(net), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_cut_elements(net, 1, &bad), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_cut_elements(net, 1, &negative), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_set_tearing(net, -0.1, 0.0), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_set_tearing(net, 0.1, NAN), PALP_ERR_ARGUMENT);
    blade[4] = NAN;
    ck_assert_int_eq(palp_network_cut(net, blade, &n), PALP_ERR_ARGUMENT);
    blade[4] = INFINITY;
    ck_assert_int_eq(palp_network_cut(net, blade, &n), PALP_ERR_ARGUMENT);
    palp_network_free(net);
}
END_TEST

/* Every element cut: all inner nodes are loose, and the network still steps. */
START_TEST(nothing_left) {
    palp_material m = quartic(1);
    palp_network *net = cuttable(4, &m);
    int32_t *all = malloc(element_count(net) * sizeof *all);
    for (size_t i = 0; i < element_count(net); i++)
        all[i] = (int32_t)i;
    step_to(net, 0.05 * HEIGHT, 0.1);
    ck_assert_int_eq(palp_network_cut_elements(net, element_count(net), all), PALP_OK);
    ck_assert_uint_eq(palp_network_loose(net, NULL), 32);
    step_to(net, 0.06 * HEIGHT, 0.1);
    ck_assert_double_eq(palp_network_force(net), 0.0);
    free(all);
    palp_network_free(net);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, cut_through_bears_no_force, 0, KINDS);
    tcase_add_loop_test(tc, half_through_is_as_built_without, 0, 2);
    tcase_add_loop_test(tc, cut_elements_are_as_if_never_there, 0, KINDS);
    tcase_add_test(tc, a_loose_part_stays_where_it_was);
    tcase_add_loop_test(tc, mechanisms_bear_nothing, 0, 3);
    tcase_add_loop_test(tc, a_bundle_tears_one_by_one, 0, 2);
    tcase_add_test(tc, a_chain_tears_in_tension_only);
    tcase_add_test(tc, misuse_is_refused);
    tcase_add_test(tc, nothing_left);
}
