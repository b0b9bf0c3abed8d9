/* test_network_state.c: what is promised about a network's state: steps that fail or are rolled back leave no
 * trace, the same input gives the same bits, another material starts at rest. */
#include "network/network_internal.h"
#include "network_make.h"

/* What is done between two steps of one of two like networks, and must not show afterwards. */
typedef void (*interlude)(palp_network *net);

static void check_no_trace(int kind, double density, palp_integrator integrator, palp_branch branch,
                           interlude between) {
    palp_material m = material_of(kind);
    palp_network_settings settings = palp_network_settings_default();
    settings.density_kg_m3 = density;
    settings.integrator = integrator;
    settings.branch = branch;
    palp_network *calm = cube_network(3, &m, &settings), *shaken = cube_network(3, &m, &settings);
    for (int i = 1; i <= 5; i++) {
        snapshot before = snapshot_take(shaken);
        between(shaken);
        ck_assert_msg(still_at(shaken, &before), "kind %d, density %g, step %d: the state has moved", kind,
                      density, i);
        snapshot_free(&before);
        double depth = 0.03 * HEIGHT * (i < 4 ? i : 3); /* a ramp and a hold */
        ck_assert_int_eq(palp_network_step(calm, depth, 0.05 * i, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_step(shaken, depth, 0.05 * i, NULL), PALP_OK);
        snapshot after = snapshot_take(calm);
        ck_assert_msg(still_at(shaken, &after), "kind %d, density %g, step %d: it has left a trace", kind,
                      density, i);
        snapshot_free(&after);
    }
    palp_network_free(calm);
    palp_network_free(shaken);
}

static void check_no_traces(interlude between) {
    for (int kind = 0; kind < KINDS; kind++) {
        check_no_trace(kind, 0.0, PALP_BACKWARD_EULER, PALP_BRANCH_CONTINUE, between);
        check_no_trace(kind, 0.0, PALP_BACKWARD_EULER, PALP_BRANCH_STABLE, between);
        check_no_trace(kind, 1070.0, PALP_BACKWARD_EULER, PALP_BRANCH_CONTINUE, between);
        check_no_trace(kind, 1070.0, PALP_GENERALIZED_ALPHA, PALP_BRANCH_CONTINUE, between);
    }
}

/* To the bottom, which may or may not have an equilibrium, and where there is none for sure. */
static void too_deep(palp_network *net) {
    palp_step_info info;
    palp_network_try(net, HEIGHT, 0.05, &info);
    ck_assert_int_ne(palp_network_step(net, NAN, 0.05, &info), PALP_OK);
    ck_assert_int_ne(palp_network_step(net, 1e300, 0.05, &info), PALP_OK);
}

/* A step that runs out of iterations, on the network's own settings. */
static void too_few_iterations(palp_network *net) {
    int iterations = net->settings.max_iterations;
    net->settings.max_iterations = 1;
    net->no_approach = true;
    palp_status status = palp_network_step(net, 0.5 * HEIGHT, 0.05, NULL);
    ck_assert(status == PALP_ERR_NOT_CONVERGED || status == PALP_ERR_BUCKLED);
    net->settings.max_iterations = iterations;
    net->no_approach = false;
}

static void tried_and_dropped(palp_network *net) {
    palp_step_info info;
    ck_assert_int_eq(palp_network_try(net, 0.2 * HEIGHT, 0.3, &info), PALP_OK);
    ck_assert_double_ne(info.force_N, palp_network_force(net));
    ck_assert_int_eq(palp_network_try(net, 0.01 * HEIGHT, 0.02, &info), PALP_OK);
    ck_assert_int_ne(palp_network_try(net, NAN, 0.02, &info), PALP_OK);
    palp_network_commit(net); /* of nothing: the last try has failed */
}

START_TEST(failed_steps_leave_no_trace) {
    check_no_traces(too_deep);
    check_no_traces(too_few_iterations);
}
END_TEST

START_TEST(steps_rolled_back_leave_no_trace) {
    check_no_traces(tried_and_dropped);
}
END_TEST

/* Large networks keep a factor as long as it contracts, so that a step between shows in the last digits;
 * the state itself must not move, nor the answer beyond the tolerance. */
START_TEST(failed_steps_of_a_network_with_dear_factors) {
    palp_material m = quartic(1);
    palp_network *calm = cube_network(8, &m, NULL), *shaken = cube_network(8, &m, NULL);
    ck_assert(calm->reuse_factor);
    for (int i = 1; i <= 3; i++) {
        snapshot before = snapshot_take(shaken);
        tried_and_dropped(shaken);
        ck_assert_int_ne(palp_network_step(shaken, NAN, 0.05, NULL), PALP_OK);
        ck_assert(still_at(shaken, &before));
        snapshot_free(&before);
        ck_assert_int_eq(palp_network_step(calm, 0.02 * i * HEIGHT, 0.05, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_step(shaken, 0.02 * i * HEIGHT, 0.05, NULL), PALP_OK);
        ck_assert_double_eq_tol(palp_network_force(shaken), palp_network_force(calm),
                                1e-9 * palp_network_force(calm));
    }
    palp_network_free(calm);
    palp_network_free(shaken);
}
END_TEST

START_TEST(same_input_gives_the_same_bits) {
    palp_branch branches[] = {PALP_BRANCH_CONTINUE, PALP_BRANCH_STABLE};
    for (size_t b = 0; b < 2; b++) {
        palp_material m = quartic(2);
        palp_network_settings settings = palp_network_settings_default();
        settings.branch = branches[b];
        palp_network *net[2] = {cube_network(4, &m, &settings), cube_network(4, &m, &settings)};
        for (int i = 1; i <= 10; i++) {
            for (size_t k = 0; k < 2; k++)
                ck_assert_int_eq(palp_network_step(net[k], 0.035 * i * HEIGHT, 0.1, NULL), PALP_OK);
            snapshot s = snapshot_take(net[0]);
            ck_assert(still_at(net[1], &s));
            snapshot_free(&s);
        }
        palp_network_free(net[0]);
        palp_network_free(net[1]);
    }
}
END_TEST

START_TEST(another_material_and_back) {
    palp_material one = quartic(2), other = sedef2008(), none = quartic(0), wrong = quartic(2);
    palp_network *net = cube_network(3, &one, NULL);
    snapshot rest = snapshot_take(net);
    ck_assert_int_eq(palp_network_step(net, 0.1 * HEIGHT, 0.2, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_step(net, 0.2 * HEIGHT, 0.2, NULL), PALP_OK);
    snapshot first = snapshot_take(net);
    const palp_material *between[] = {&other, &none, &one};
    for (size_t k = 0; k < 3; k++) {
        ck_assert_int_eq(palp_network_set_material(net, between[k]), PALP_OK);
        ck_assert(still_at(net, &rest));
        for (int i = 1; i <= 3; i++)
            ck_assert_int_eq(palp_network_step(net, 0.05 * i * HEIGHT, 0.1, NULL), PALP_OK);
    }
    palp_network_reset(net);
    ck_assert(still_at(net, &rest));
    ck_assert_int_eq(palp_network_step(net, 0.1 * HEIGHT, 0.2, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_step(net, 0.2 * HEIGHT, 0.2, NULL), PALP_OK);
    ck_assert(still_at(net, &first));
    wrong.arms[0].stiffness_N = -1.0;
    ck_assert_int_eq(palp_network_set_material(net, &wrong), PALP_ERR_ARGUMENT);
    ck_assert(still_at(net, &first));
    snapshot_free(&rest);
    snapshot_free(&first);
    palp_network_free(net);
}
END_TEST

static bool is_failure_of_a_step(palp_status s) {
    return s == PALP_ERR_NOT_CONVERGED || s == PALP_ERR_BUCKLED || s == PALP_ERR_SINGULAR ||
           s == PALP_ERR_COLLAPSED;
}

START_TEST(depths_beyond_collapse_give_a_status) {
    static const double depth[] = {0.999, 1.0, 1.001, 1.5, 3.0, 1e6, 1e160, 1e305, -1e6, -1e305};
    for (int branch = 0; branch < 2; branch++)
        for (size_t i = 0; i < sizeof depth / sizeof *depth; i++) {
            palp_material m = quartic(1);
            palp_network_settings settings = palp_network_settings_default();
            settings.branch = branch ? PALP_BRANCH_STABLE : PALP_BRANCH_CONTINUE;
            settings.max_iterations = 15;
            palp_network *net = cube_network(3, &m, &settings);
            snapshot rest = snapshot_take(net);
            palp_status status = palp_network_step(net, depth[i] * HEIGHT, 0.1, NULL);
            ck_assert_msg(!status || is_failure_of_a_step(status), "depth %g: status %d", depth[i],
                          (int)status);
            ck_assert(status ? still_at(net, &rest) : isfinite(palp_network_force(net)));
            snapshot_free(&rest);
            palp_network_free(net);
        }
}
END_TEST

/* A network of three nodes a side and what is changed of it: the mesh, the supports, the material or a
 * setting. */
enum { LIKE, WIDER, UNDRIVEN, STIFFER, OTHER_ARM, DENSER, LIKENESSES };

static palp_network *network_like(int change) {
    palp_material m = quartic(2);
    palp_network_settings settings = palp_network_settings_default();
    palp_mesh *mesh = NULL;
    palp_network *net = NULL;
    palp_support supports[2];
    palp_supports_default(supports);
    const double width = change == WIDER ? 1.1 * HEIGHT : HEIGHT;
    ck_assert_int_eq(
        palp_mesh_lattice((size_t[]){3, 3, 3}, (double[]){width, HEIGHT, HEIGHT}, PALP_NEIGHBOURS_26, &mesh),
        PALP_OK);
    if (change == UNDRIVEN)
        supports[1].motion[1] = -0.5;
    if (change == STIFFER)
        m.law.coefficients[0] *= 2.0;
    if (change == OTHER_ARM)
        m.arms[1].viscosity_Ns *= 2.0;
    settings.density_kg_m3 = change == DENSER ? 2000.0 : 1000.0;
    ck_assert_int_eq(palp_network_create(mesh, &m, 2, supports, &settings, &net, NULL), PALP_OK);
    palp_mesh_free(mesh);
    return net;
}

START_TEST(a_state_goes_into_a_like_network_only) {
    palp_network *net = network_like(LIKE);
    ck_assert_int_eq(palp_network_step(net, 0.1 * HEIGHT, 0.1, NULL), PALP_OK);
    const size_t size = palp_network_state_size(net);
    void *saved = malloc(size);
    ck_assert_ptr_nonnull(saved);
    ck_assert_int_eq(palp_network_save(net, saved, size), PALP_OK);
    for (int change = LIKE; change < LIKENESSES; change++) {
        palp_network *other = network_like(change);
        snapshot rest = snapshot_take(other);
        ck_assert_msg(palp_network_restore(other, saved, size) ==
                          (change == LIKE ? PALP_OK : PALP_ERR_ARGUMENT),
                      "change %d", change);
        ck_assert_int_eq(still_at(other, &rest), change != LIKE);
        snapshot_free(&rest);
        palp_network_free(other);
    }
    free(saved);
    palp_network_free(net);
}
END_TEST

/* Every byte of a saved state, one bit of it turned over. */
START_TEST(a_damaged_state_is_refused) {
    palp_network *net = network_like(LIKE);
    ck_assert_int_eq(palp_network_step(net, 0.1 * HEIGHT, 0.1, NULL), PALP_OK);
    const size_t size = palp_network_state_size(net);
    unsigned char *saved = malloc(size);
    ck_assert_ptr_nonnull(saved);
    ck_assert_int_eq(palp_network_save(net, saved, size), PALP_OK);
    snapshot before = snapshot_take(net);
    for (size_t i = 0; i < size; i++) {
        unsigned char bit = (unsigned char)(1u << i % 8);
        saved[i] ^= bit;
        palp_status status = palp_network_restore(net, saved, size);
        ck_assert_msg(status == (i < 24 ? PALP_ERR_ARGUMENT : PALP_ERR_INPUT), "byte %zu: %s", i,
                      palp_status_name(status));
        saved[i] ^= bit;
    }
    ck_assert(still_at(net, &before));
    ck_assert_int_eq(palp_network_restore(net, saved, size), PALP_OK);
    snapshot_free(&before);
    free(saved);
    palp_network_free(net);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, failed_steps_leave_no_trace);
    tcase_add_test(tc, steps_rolled_back_leave_no_trace);
    tcase_add_test(tc, failed_steps_of_a_network_with_dear_factors);
    tcase_add_test(tc, same_input_gives_the_same_bits);
    tcase_add_test(tc, another_material_and_back);
    tcase_add_test(tc, a_state_goes_into_a_like_network_only);
    tcase_add_test(tc, a_damaged_state_is_refused);
    tcase_add_test(tc, depths_beyond_collapse_give_a_status);
}
