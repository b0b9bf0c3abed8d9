/* test_tie.c: threads and rods. */
#include "../network/network_settle.h"
#include "contact/contact_internal.h"

#include <palpate/realtime.h>
#include <palpate/tie.h>

static palp_material linear(void) {
    palp_material m = {.n_arms = 0};
    ck_assert_int_eq(palp_law_polynomial(1, (double[]){0.54}, &m.law), PALP_OK);
    return m;
}

/* A cube on its bottom, ready for ties; density 0 = none. */
static palp_network *block(size_t n, size_t max_ties, double density) {
    palp_mesh *mesh = cube(n, PALP_NEIGHBOURS_26);
    const palp_material m = linear();
    palp_network_settings settings = palp_network_settings_default();
    palp_support supports[2];
    palp_network *net = NULL;
    settings.density_kg_m3 = density;
    palp_supports_default(supports);
    ck_assert_int_eq(palp_network_create(mesh, &m, 1, supports, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_enable_ties(net, max_ties), PALP_OK);
    palp_mesh_free(mesh);
    return net;
}

static palp_tie_point at(const palp_network *net, double x, double y, double z) {
    palp_tie_point point;
    ck_assert_int_eq(palp_tie_point_at(palp_network_mesh(net), (double[]){x, y, z}, &point), PALP_OK);
    return point;
}

static palp_tie_point outside(double x, double y, double z) {
    return (palp_tie_point){.node = {-1, -1, -1, -1}, .place_m = {x, y, z}};
}

static void set(palp_network *net, size_t n, const palp_tie *tie) {
    palp_status status = palp_network_set_ties(net, n, tie);
    ck_assert_msg(!status, "%s", palp_status_text(status));
}

static void step(palp_network *net) {
    palp_status status = palp_network_step(net, 0.0, 0.01, NULL);
    ck_assert_msg(!status, "%s", palp_status_text(status));
}

static void place_of(const palp_network *net, const palp_tie_point *p, double place[3]) {
    place[0] = place[1] = place[2] = 0.0;
    for (int k = 0; k < 4; k++)
        if (p->share[k] != 0.0)
            along3(place, p->share[k], palp_network_positions(net) + 3 * p->node[k], place);
}

/* A string from the middle of the top is slack, then pulls by its stiffness times its stretch; the support
 * takes what it pulls. */
START_TEST(string_pulls) {
    palp_network *net = block(5, 1, 0.0);
    const double middle = 0.5 * HEIGHT;
    palp_tie tie = {.n_points = 2,
                    .point = {at(net, middle, HEIGHT, middle), outside(middle, HEIGHT + 0.01, middle)},
                    .length_m = 0.012,
                    .stiffness_N_m = 50.0,
                    .strength_N = INFINITY};
    palp_tie_state state;
    double up[3], place[3];
    set(net, 1, &tie);
    step(net);
    ck_assert_int_eq(palp_network_ties(net, &state), PALP_OK);
    ck_assert_double_eq(state.force_N, 0.0);
    ck_assert_double_eq_tol(state.length_m, 0.01, 1e-12);
    tie.point[1].place_m[0] += 0.004;
    tie.point[1].place_m[1] += 0.006;
    set(net, 1, &tie);
    step(net);
    ck_assert_int_eq(palp_network_ties(net, &state), PALP_OK);
    place_of(net, &tie.point[0], place);
    along3(tie.point[1].place_m, -1.0, place, place);
    const double length = sqrt(dot3(place, place));
    ck_assert_double_eq_tol(state.length_m, length, 1e-12);
    ck_assert_double_eq_tol(state.force_N, 50.0 * (length - 0.012), 1e-9);
    ck_assert_double_gt(state.force_N, 0.01);
    ck_assert_int_eq(palp_network_reaction(net, "bottom", up), PALP_OK);
    for (int k = 0; k < 3; k++)
        ck_assert_double_eq_tol(fabs(up[k]), state.force_N * fabs(place[k]) / length, 1e-8);
    palp_network_free(net);
}
END_TEST

/* Threads through points in cells, one node in several of them; a rod; one with an end outside. */
static void many_ties(const palp_network *net, palp_tie tie[3]) {
    tie[0] = (palp_tie){.n_points = 4,
                        .point = {at(net, 0.003, 0.02, 0.004), at(net, 0.005, 0.023, 0.005),
                                  at(net, 0.02, 0.022, 0.013), at(net, 0.0041, 0.0203, 0.02)},
                        .length_m = 0.02,
                        .stiffness_N_m = 30.0,
                        .strength_N = INFINITY};
    tie[1] = (palp_tie){.n_points = 2,
                        .point = {at(net, 0.012, 0.02, 0.012), at(net, 0.02, 0.01, 0.021)},
                        .length_m = 0.02,
                        .stiffness_N_m = 40.0,
                        .strength_N = INFINITY,
                        .rod = true};
    tie[2] = (palp_tie){
        .n_points = 3,
        .point = {at(net, 0.02, 0.024, 0.02), outside(0.024, 0.03, 0.024), at(net, 0.02, 0.024, 0.012)},
        .length_m = 0.01,
        .stiffness_N_m = 20.0,
        .strength_N = INFINITY};
}

START_TEST(tangent_by_differences) {
    palp_network *net = block(4, 3, 0.0);
    const size_t all = 3 * net->n_nodes;
    double *x = malloc(all * sizeof *x), *v = malloc(all * sizeof *v), *r = malloc(all * sizeof *r),
           *product = calloc(all, sizeof *product), *d = malloc(net->n_free * sizeof *d), scale;
    palp_tie tie[3];
    int negative;
    seed = 7;
    many_ties(net, tie);
    set(net, 3, tie);
    ck_assert_int_eq(palp_network_try(net, 0.0, 0.01, NULL), PALP_OK);
    memcpy(x, net->next.x, all * sizeof *x);
    ck_assert(network_evaluate(net));
    ck_assert_int_eq(network_factor(net, 0.0, &negative), PALP_OK);
    ck_assert_uint_gt(net->far.n, 20);
    for (int direction = 0; direction < 3; direction++) {
        const double h = 1e-7;
        for (size_t i = 0; i < all; i++)
            v[i] = net->dof[i] < 0 ? 0.0 : uniform(-1.0, 1.0);
        residual_at(net, x, v, 0.0, r);
        const double slope = (energy_at(net, x, v, h) - energy_at(net, x, v, -h)) / (2.0 * h);
        ck_assert_double_eq_tol(-network_dot(r, v, all), slope, 1e-7);
        for (int side = -1; side <= 1; side += 2) {
            energy_at(net, x, v, side * h);
            network_residual(net, &scale);
            for (size_t i = 0; i < net->n_free; i++)
                d[i] = side < 0 ? net->rhs[i] : (d[i] - net->rhs[i]) / (2.0 * h);
            for (size_t i = 0; i < all; i++)
                r[i] = side < 0 ? net->outer[i] : (r[i] - net->outer[i]) / (2.0 * h);
        }
        network_solve(net, d);
        energy_at(net, x, v, 0.0);
        memset(product, 0, all * sizeof *product);
        NETWORK_EACH_TERM(net, times, net, v, product);
        for (size_t i = 0; i < all; i++) {
            ck_assert_double_eq_tol(product[i], r[i], 1e-4);
            if (net->dof[i] >= 0)
                ck_assert_double_eq_tol(d[net->dof[i]], v[i], 1e-4);
        }
    }
    free(x);
    free(v);
    free(r);
    free(product);
    free(d);
    palp_network_free(net);
}
END_TEST

/* A thread within the tissue has neither force nor moment on all of it. */
START_TEST(thread_within_is_in_balance) {
    palp_network *net = block(4, 2, 0.0);
    palp_tie tie[3];
    double force[3] = {0.0}, moment[3] = {0.0}, largest = 0.0;
    many_ties(net, tie);
    set(net, 2, tie);
    step(net);
    for (size_t i = 0; i < net->n_nodes; i++) {
        double turn[3];
        cross3(net->now.x + 3 * i, net->outer + 3 * i, turn);
        along3(moment, 1.0, turn, moment);
        along3(force, 1.0, net->outer + 3 * i, force);
        largest = fmax(largest, sqrt(dot3(net->outer + 3 * i, net->outer + 3 * i)));
    }
    ck_assert_double_gt(largest, 0.01);
    for (int k = 0; k < 3; k++) {
        ck_assert_double_eq_tol(force[k], 0.0, 1e-14);
        ck_assert_double_eq_tol(moment[k], 0.0, 1e-15);
    }
    palp_network_free(net);
}
END_TEST

/* Two cubes, the second called "upper", a gap over the first. */
static palp_mesh *two_cubes(size_t n, double gap) {
    palp_mesh *lower = cube(n, PALP_NEIGHBOURS_26), *upper = cube(n, PALP_NEIGHBOURS_26), *both = NULL;
    ck_assert_int_eq(palp_mesh_scale(lower, PALP_SCALING_CONTINUUM, 0.0, NULL), PALP_OK);
    ck_assert_int_eq(palp_mesh_scale(upper, PALP_SCALING_CONTINUUM, 0.0, NULL), PALP_OK);
    ck_assert_int_eq(
        palp_mesh_transform(upper, (double[]){1, 0, 0, 0, 1, 0, 0, 0, 1}, (double[]){0.0, HEIGHT + gap, 0.0}),
        PALP_OK);
    ck_assert_int_eq(palp_mesh_join(lower, upper, "upper", &both), PALP_OK);
    palp_mesh_free(lower);
    palp_mesh_free(upper);
    return both;
}

static palp_network *pulled(palp_mesh *mesh, const char *top, size_t max_ties, bool touch) {
    const palp_support supports[] = {{"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0}},
                                     {top, {PALP_FIXED, PALP_DRIVEN, PALP_FIXED}, {0, -1, 0}}};
    const palp_material m = linear();
    palp_contact_settings contact_settings = palp_contact_settings_default();
    const palp_network_settings settings = palp_network_settings_default();
    palp_network *net = NULL;
    contact_settings.tissue = touch;
    ck_assert_int_eq(palp_network_create(mesh, &m, 2, supports, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_enable_ties(net, max_ties), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(net, 0, 0, &contact_settings), PALP_OK);
    palp_mesh_free(mesh);
    return net;
}

/* Cubes whose faces are tied node by node, stiffly, are pulled like a column of twice the height. */
START_TEST(tied_cubes_are_a_column) {
    enum { N = 4 };
    palp_mesh *column = NULL;
    ck_assert_int_eq(palp_mesh_lattice((size_t[]){N, 2 * N - 1, N}, (double[]){HEIGHT, 2 * HEIGHT, HEIGHT},
                                       PALP_NEIGHBOURS_26, &column),
                     PALP_OK);
    ck_assert_int_eq(palp_mesh_scale(column, PALP_SCALING_CONTINUUM, 0.0, NULL), PALP_OK);
    palp_network *one = pulled(column, "top", 0, false),
                 *two = pulled(two_cubes(N, 0.0), "upper.top", N * N, false);
    palp_tie tie[N * N];
    size_t n, n_other;
    const int32_t *node, *other;
    ck_assert_int_eq(palp_mesh_set(palp_network_mesh(two), "top", &n, &node), PALP_OK);
    ck_assert_int_eq(palp_mesh_set(palp_network_mesh(two), "upper.bottom", &n_other, &other), PALP_OK);
    ck_assert(n == N * N && n_other == n);
    for (size_t i = 0; i < n; i++)
        tie[i] =
            (palp_tie){.n_points = 2,
                       .point = {{.node = {node[i]}, .share = {1.0}}, {.node = {other[i]}, .share = {1.0}}},
                       .stiffness_N_m = 2e3,
                       .strength_N = INFINITY};
    set(two, n, tie);
    for (int i = 1; i <= 4; i++) {
        palp_step_info first, second;
        ck_assert_int_eq(palp_network_step(one, -1e-3 * i, 0.01, &first), PALP_OK);
        ck_assert_int_eq(palp_network_step(two, -1e-3 * i, 0.01, &second), PALP_OK);
        ck_assert_double_eq_tol(second.force_N / first.force_N, 1.0, 2e-3);
    }
    palp_network_free(one);
    palp_network_free(two);
}
END_TEST

/* A suture that runs to and fro across a gap closes it when it is shortened: the faces touch. Beyond its
 * strength it tears and lets go. */
START_TEST(suture_closes_a_gap) {
    palp_network *net = pulled(two_cubes(5, 2e-3), "upper.top", 1, true);
    palp_tie tie = {.n_points = 6, .stiffness_N_m = 200.0, .strength_N = INFINITY};
    palp_tie_state state;
    size_t n;
    for (size_t i = 0; i < 6; i++)
        tie.point[i] = at(net, 0.006 + 0.006 * (double)(i / 2), (i + 1) / 2 % 2 == 0 ? 0.02 : 0.03, 0.012);
    ck_assert_int_eq(palp_network_tie_length(net, &tie, &tie.length_m), PALP_OK);
    const double taut = tie.length_m;
    set(net, 1, &tie);
    step(net);
    ck_assert_int_eq(palp_network_ties(net, &state), PALP_OK);
    ck_assert_double_eq_tol(state.force_N, 0.0, 1e-9);
    for (int i = 1; i <= 6; i++) {
        tie.length_m = taut * (1.0 - 0.06 * i);
        set(net, 1, &tie);
        step(net);
    }
    ck_assert_int_eq(palp_network_ties(net, &state), PALP_OK);
    ck_assert_int_eq(palp_network_contacts(net, 0, NULL, &n), PALP_OK);
    ck_assert_double_gt(state.force_N, 0.01);
    ck_assert_uint_gt(n, 4);
    tie.strength_N = 0.5 * state.force_N;
    set(net, 1, &tie);
    step(net);
    ck_assert_int_eq(palp_network_ties(net, &state), PALP_OK);
    ck_assert(state.torn);
    for (int i = 0; i < 2; i++) {
        set(net, 1, &tie);
        step(net);
        ck_assert_int_eq(palp_network_ties(net, &state), PALP_OK);
        ck_assert(state.torn);
        ck_assert_double_eq(state.force_N, 0.0);
    }
    ck_assert_int_eq(palp_network_contacts(net, 0, NULL, &n), PALP_OK);
    ck_assert_uint_eq(n, 0);
    set(net, 0, NULL);
    set(net, 1, &tie);
    ck_assert_int_eq(palp_network_ties(net, &state), PALP_OK);
    ck_assert(!state.torn);
    palp_network_free(net);
}
END_TEST

/* A state that is saved goes on alike; so do ticks, within their error. */
START_TEST(saved_states_and_ticks) {
    palp_network *net = block(5, 3, 0.0), *other = block(5, 3, 0.0), *ticking = block(5, 3, 0.0);
    palp_realtime *rt = NULL;
    const palp_realtime_settings settings = palp_realtime_settings_default();
    const palp_budget budget = {.corrections = 40};
    palp_tie tie[3];
    palp_tie_state one[3], two[3], three[3];
    many_ties(net, tie);
    set(net, 3, tie);
    step(net);
    const size_t size = palp_network_state_size(net);
    void *saved = malloc(size);
    ck_assert_int_eq(palp_network_save(net, saved, size), PALP_OK);
    ck_assert_int_eq(palp_network_restore(other, saved, size), PALP_OK);
    ck_assert_int_eq(palp_realtime_create(ticking, &settings, &rt), PALP_OK);
    set(ticking, 3, tie);
    for (int i = 0; i < 20; i++)
        ck_assert_int_eq(palp_realtime_step(rt, 0.0, 0.01, &budget, NULL), PALP_OK);
    tie[2].point[1].place_m[1] += 0.002;
    set(net, 3, tie);
    set(other, 3, tie);
    set(ticking, 3, tie);
    step(net);
    step(other);
    for (int i = 0; i < 20; i++)
        ck_assert_int_eq(palp_realtime_step(rt, 0.0, 0.01, &budget, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_ties(net, one), PALP_OK);
    ck_assert_int_eq(palp_network_ties(other, two), PALP_OK);
    ck_assert_int_eq(palp_network_ties(ticking, three), PALP_OK);
    for (int i = 0; i < 3; i++) {
        ck_assert_double_eq_tol(two[i].force_N, one[i].force_N, 1e-8);
        ck_assert_double_eq_tol(three[i].force_N, one[i].force_N, 1e-4);
    }
    free(saved);
    palp_realtime_free(rt);
    palp_network_free(net);
    palp_network_free(other);
    palp_network_free(ticking);
}
END_TEST

START_TEST(points_are_found) {
    palp_network *net = block(4, 1, 0.0);
    double place[3];
    palp_tie_point p = at(net, 0.0051, 0.0172, 0.0213);
    place_of(net, &p, place);
    ck_assert_double_eq_tol(place[0], 0.0051, 1e-12);
    ck_assert_double_eq_tol(place[1], 0.0172, 1e-12);
    ck_assert_double_eq_tol(place[2], 0.0213, 1e-12);
    p = at(net, 0.0051, 0.0372, 0.0313);
    place_of(net, &p, place);
    ck_assert_double_eq_tol(place[0], 0.0051, 1e-12);
    ck_assert_double_eq_tol(place[1], HEIGHT, 1e-12);
    ck_assert_double_eq_tol(place[2], HEIGHT, 1e-12);
    palp_mesh *line = NULL;
    ck_assert_int_eq(palp_mesh_create(2, (double[]){0, 0, 0, 0, 1, 0}, 1, (int32_t[]){0, 1}, &line, NULL),
                     PALP_OK);
    ck_assert_int_eq(palp_tie_point_at(line, (double[]){0, 0.8, 3}, &p), PALP_OK);
    ck_assert(p.node[0] == 1 && p.share[0] == 1.0);
    ck_assert_int_eq(palp_tie_point_at(line, (double[]){0, NAN, 3}, &p), PALP_ERR_ARGUMENT);
    palp_mesh_free(line);
    palp_network_free(net);
}
END_TEST

START_TEST(refused) {
    palp_network *net = block(4, 1, 0.0);
    const palp_tie good = {.n_points = 2,
                           .point = {at(net, 0.01, 0.02, 0.01), outside(0.0, 0.03, 0.0)},
                           .length_m = 0.01,
                           .stiffness_N_m = 1.0,
                           .strength_N = INFINITY};
    palp_tie two[2] = {good, good};
    set(net, 1, two);
    ck_assert_int_eq(palp_network_enable_ties(net, 1), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_network_set_ties(net, 2, two), PALP_ERR_ARGUMENT);
    palp_tie bad[9];
    for (int i = 0; i < 9; i++)
        bad[i] = good;
    bad[0].n_points = 1;
    bad[1].n_points = PALP_TIE_POINTS + 1;
    bad[2].length_m = -1e-3;
    bad[3].stiffness_N_m = 0.0;
    bad[4].strength_N = 0.0;
    bad[5].point[0].node[1] = 64;
    bad[6].point[0].share[0] += 0.1;
    bad[7].point[1].place_m[1] = NAN;
    bad[8].point[1].node[0] = -2;
    for (int i = 0; i < 9; i++)
        ck_assert_msg(palp_network_set_ties(net, 1, &bad[i]) == PALP_ERR_ARGUMENT, "%d", i);
    palp_tie long_one = good;
    long_one.n_points = PALP_TIE_POINTS;
    for (int i = 0; i < PALP_TIE_POINTS; i++)
        long_one.point[i] = good.point[0];
    ck_assert_int_eq(palp_network_set_ties(net, 1, &long_one), PALP_ERR_LIMIT);
    palp_network_free(net);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, string_pulls);
    tcase_add_test(tc, tangent_by_differences);
    tcase_add_test(tc, thread_within_is_in_balance);
    tcase_add_test(tc, tied_cubes_are_a_column);
    tcase_add_test(tc, suture_closes_a_gap);
    tcase_add_test(tc, saved_states_and_ticks);
    tcase_add_test(tc, points_are_found);
    tcase_add_test(tc, refused);
}
