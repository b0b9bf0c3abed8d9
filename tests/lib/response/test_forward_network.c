/* test_forward_network.c: networks with effects: columns of elements against lumped models, plates against
 * steps. */
#include "effect/effect_internal.h"
#include "forward_make.h"

static samples s;

/* Nodes a side, every neighbour or only those along the axes. A lattice of two nodes a side has four elements
 * along the plate's way, and no others that strain. */
static palp_model network_model(size_t n_arms, size_t nodes, palp_neighbourhood neighbourhood) {
    palp_model m = lumped_model(n_arms);
    m.kind = PALP_MODEL_NETWORK;
    m.mesh = lattice_source(nodes, neighbourhood);
    return m;
}

static void press_network_model(const palp_model *m, samples *to) {
    palp_forward_run run = run_of(to);
    palp_error error = {PALP_OK, ""};
    palp_status status = palp_forward_network(m, NULL, &run, to->force_N, &error);
    ck_assert_msg(status == PALP_OK, "%s", error.text);
}

/* Per element and per specimen of four. */
static double of_four(palp_effect_id id, double value) {
    if (id == PALP_EFFECT_FRAME_COMPLIANCE)
        return value / 4;
    return id == PALP_EFFECT_ADHESION || id == PALP_EFFECT_FORCE_SATURATION ? 4 * value : value;
}

START_TEST(column_is_four_lumped_models) {
    static samples lumped;
    const palp_effect_id id = (palp_effect_id)_i;
    const palp_effect_info *info = palp_effect_look_up(id);
    const bool added = effect_row_of(id)->sensor && id != PALP_EFFECT_SENSOR_LAG &&
                       id != PALP_EFFECT_SENSOR_GAIN && id != PALP_EFFECT_FORCE_SATURATION;
    if (!info->in_lumped || !info->in_network)
        return;
    palp_model net = network_model(2, 2, PALP_NEIGHBOURS_6), plain = lumped_model(2);
    all_phases(&s, 14);
    all_phases(&lumped, 14);
    palp_effect *there = add_effect(&net, id, 1), *here = add_effect(&plain, id, 1);
    if (id == PALP_EFFECT_FRAME_COMPLIANCE)
        there->value[0] = here->value[0] = 4e-4;
    if (id == PALP_EFFECT_FORCE_SATURATION)
        there->value[0] = here->value[0] = 1;
    there->value[0] = of_four(id, there->value[0]);
    press_network_model(&net, &s);
    press_model(&plain, &lumped);
    double few = id == PALP_EFFECT_POWER_LAW_RELAXATION || id == PALP_EFFECT_POROELASTIC ? 2e-3 : 1e-9;
    palp_model without = lumped_model(2);
    static samples base;
    all_phases(&base, 14);
    press_model(&without, &base);
    for (size_t i = 0; i < s.n; i++) {
        double wanted = added ? lumped.force_N[i] + 3 * base.force_N[i] : 4 * lumped.force_N[i];
        ck_assert_msg(fabs(s.force_N[i] - wanted) < few, "%s at %g s, %g mm: %.9g, not %.9g", info->id,
                      s.time_s[i], 1e3 * s.depth_m[i], s.force_N[i], wanted);
    }
}
END_TEST

static palp_network *network_of(const palp_model *m) {
    palp_network_settings settings = palp_network_settings_default();
    palp_support supports[2];
    palp_mesh *mesh;
    palp_network *net;
    palp_supports_default(supports);
    ck_assert_int_eq(palp_model_mesh(m, &mesh, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_create(mesh, &m->material, 2, supports, &settings, &net, NULL), PALP_OK);
    palp_mesh_free(mesh);
    return net;
}

/* 27 nodes: what the frame lets through is what the network answers at the depth that is left. */
START_TEST(frame_gives_way_to_a_network) {
    palp_model m = network_model(2, 3, PALP_NEIGHBOURS_26), plain = m;
    double compliance = add_effect(&m, PALP_EFFECT_FRAME_COMPLIANCE, 1)->value[0] = 5e-5;
    start(&s, 0, 0);
    go(&s, 1, 3, 20);
    go(&s, 6, 3, 15);
    press_network_model(&m, &s);
    palp_network *net = network_of(&plain);
    palp_step_info info;
    for (size_t i = 1; i < s.n; i++) {
        double depth = s.depth_m[i] - compliance * s.force_N[i];
        ck_assert_int_eq(palp_network_step(net, depth, s.time_s[i] - s.time_s[i - 1], &info), PALP_OK);
        ck_assert_double_eq_tol(s.force_N[i], info.force_N, 1e-7);
    }
    palp_network_free(net);
}
END_TEST

/* Up to the largest strain of every element a worn network is a fresh one; on the way back it is softer. */
START_TEST(wear_shows_on_the_way_back) {
    static samples plain;
    palp_model m = network_model(0, 3, PALP_NEIGHBOURS_26), without = m;
    start(&s, 0, 0);
    go(&s, 1, 3, 10);
    go(&s, 2, 0.5, 10);
    go(&s, 3, 3, 10);
    plain = s;
    palp_effect_id id = _i == 0 ? PALP_EFFECT_DAMAGE_SOFTENING : PALP_EFFECT_PERMANENT_SET;
    add_effect(&m, id, 1);
    press_network_model(&m, &s);
    press_network_model(&without, &plain);
    for (size_t i = 1; i < s.n; i++) {
        bool deepest = s.time_s[i] <= 1 || i == s.n - 1;
        if (deepest)
            ck_assert_double_eq_tol(s.force_N[i], plain.force_N[i], 1e-8 * plain.force_N[i]);
        else
            ck_assert_msg(s.force_N[i] < 0.999 * plain.force_N[i], "at %g s", s.time_s[i]);
    }
    ck_assert(s.force_N[20] < 0.9 * plain.force_N[20]);
}
END_TEST

/* A network that is slack when the plate leaves it is no mechanism, and has no force until it is met again.
 */
START_TEST(slack_network_waits) {
    palp_model m = network_model(0, 3, PALP_NEIGHBOURS_26);
    add_effect(&m, PALP_EFFECT_PERMANENT_SET, 1)->value[0] = 0.2;
    start(&s, 0, 0);
    go(&s, 1, 3, 20);
    go(&s, 2, -1, 20);
    go(&s, 3, 4, 20);
    press_network_model(&m, &s);
    for (size_t i = 1; i < s.n; i++) {
        bool rising = s.time_s[i] <= 1 || s.depth_m[i] > 3e-3;
        ck_assert(s.force_N[i] >= 0 && (!rising || s.force_N[i] > 0));
        if (!rising && s.depth_m[i] < 0.4e-3)
            ck_assert_double_le(s.force_N[i], 1e-3 * s.force_N[20]);
    }
}
END_TEST

/* The surface of a network left behind comes back: it is met later the longer it had. */
START_TEST(network_recovers) {
    palp_model m = network_model(2, 3, PALP_NEIGHBOURS_26);
    add_effect(&m, PALP_EFFECT_SENSOR_BIAS, 0);
    double met[2];
    for (int i = 0; i < 2; i++) {
        start(&s, 0, 4);
        go(&s, 20, 4, 15);
        go(&s, 20.2, -1, 10);
        go(&s, i ? 80 : 20.5, -1, 5);
        go(&s, i ? 80.2 : 20.7, 4, 40);
        press_network_model(&m, &s);
        size_t first = s.n - 40;
        ck_assert_double_eq(s.force_N[first], 0);
        while (s.force_N[first] <= 0)
            first++;
        met[i] = s.depth_m[first];
    }
    ck_assert_msg(met[1] < met[0] - 1e-4, "met at %g and %g mm", 1e3 * met[0], 1e3 * met[1]);
    ck_assert(met[1] > -1e-9);
}
END_TEST

/* The more the plates slip, the less they hold the network together: softer, and never less than without
 * hold. */
START_TEST(slip_softens) {
    double last = INFINITY;
    const double slips[] = {0, 1e-7, 0.2, 0.5, 0.8, 1};
    for (size_t i = 0; i < 6; i++) {
        palp_model m = network_model(1, 3, PALP_NEIGHBOURS_26);
        add_effect(&m, PALP_EFFECT_PLATE_SLIP, 1)->value[0] = slips[i];
        start(&s, 0, 0);
        go(&s, 1, 2, 10);
        press_network_model(&m, &s);
        double force = s.force_N[s.n - 1];
        if (i == 1) /* next to none is none */
            ck_assert_double_eq_tol(force, last, 1e-5 * last);
        else
            ck_assert_msg(force < last * (1 - 1e-6) && force > 0, "slip %g: %g N", slips[i], force);
        last = force;
    }
}
END_TEST

START_TEST(what_cannot_be_run_is_told) {
    palp_model m = lumped_model(1);
    palp_error error;
    start(&s, 0, 0);
    go(&s, 1, 2, 10);
    palp_forward_run run = run_of(&s);
    ck_assert_int_eq(palp_forward_network(&m, NULL, &run, s.force_N, &error), PALP_ERR_ARGUMENT);
    m = network_model(2, 3, PALP_NEIGHBOURS_26);
    m.material.n_arms = 12;
    for (size_t j = 0; j < 12; j++)
        m.material.arms[j] = (palp_arm){.stiffness_N = 1, .viscosity_Ns = 1};
    add_effect(&m, PALP_EFFECT_POROELASTIC, 1);
    ck_assert_int_eq(palp_forward_network(&m, NULL, &run, s.force_N, &error), PALP_ERR_LIMIT);
    ck_assert_ptr_nonnull(strstr(error.text, "poroelastic: the network already has all arms"));
    m.n_effects = m.material.n_arms = 0;
    palp_mesh_source flat = *m.mesh;
    flat.nodes[0] = 1;
    m.mesh = &flat;
    ck_assert_int_ne(palp_forward_network(&m, NULL, &run, s.force_N, &error), PALP_OK);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, column_is_four_lumped_models, 0, PALP_EFFECT_COUNT);
    tcase_add_test(tc, frame_gives_way_to_a_network);
    tcase_add_loop_test(tc, wear_shows_on_the_way_back, 0, 2);
    tcase_add_test(tc, slack_network_waits);
    tcase_add_test(tc, network_recovers);
    tcase_add_test(tc, slip_softens);
    tcase_add_test(tc, what_cannot_be_run_is_told);
}
