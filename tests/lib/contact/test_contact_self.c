/* test_contact_self.c: tissue that touches tissue. */
#include "../network/network_settle.h"
#include "contact/contact_internal.h"

#include <palpate/cut.h>
#include <palpate/realtime.h>

/* Two cubes, of n and m nodes a side, the second called "upper": gap over the first, turned about y by angle
 * and shifted along x. */
static palp_mesh *two_cubes(size_t n, size_t m, double gap, double angle, double shift) {
    palp_mesh *lower = cube(n, PALP_NEIGHBOURS_26), *upper = cube(m, PALP_NEIGHBOURS_26), *both = NULL;
    const double c = cos(angle), s = sin(angle), middle = 0.5 * HEIGHT,
                 turn[9] = {c, 0, s, 0, 1, 0, -s, 0, c},
                 move[3] = {middle - (c + s) * middle + shift, HEIGHT + gap, middle - (c - s) * middle};
    ck_assert_int_eq(palp_mesh_scale(lower, PALP_SCALING_CONTINUUM, 0.0, NULL), PALP_OK);
    ck_assert_int_eq(palp_mesh_scale(upper, PALP_SCALING_CONTINUUM, 0.0, NULL), PALP_OK);
    ck_assert_int_eq(palp_mesh_transform(upper, turn, move), PALP_OK);
    ck_assert_int_eq(palp_mesh_join(lower, upper, "upper", &both), PALP_OK);
    palp_mesh_free(lower);
    palp_mesh_free(upper);
    return both;
}

static palp_material linear(void) {
    palp_material m = {.n_arms = 0};
    ck_assert_int_eq(palp_law_polynomial(1, (double[]){0.54}, &m.law), PALP_OK);
    return m;
}

static palp_contact_settings touching(double friction) {
    palp_contact_settings s = palp_contact_settings_default();
    s.tissue = true;
    s.tissue_friction = friction;
    return s;
}

/* The lower cube on its bottom, the top of the upper one driven; frees the mesh. */
static palp_network *pressed(palp_mesh *mesh, double friction) {
    const palp_support supports[] = {{"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0}},
                                     {"upper.top", {PALP_FIXED, PALP_DRIVEN, PALP_FIXED}, {0, -1, 0}}};
    const palp_material m = linear();
    const palp_contact_settings touch = touching(friction);
    const palp_network_settings settings = palp_network_settings_default();
    palp_network *net = NULL;
    ck_assert_int_eq(palp_network_create(mesh, &m, 2, supports, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(net, 1, 4, &touch), PALP_OK);
    palp_mesh_free(mesh);
    return net;
}

static double force_at(palp_network *net, double depth) {
    palp_step_info info;
    palp_status status = palp_network_step(net, depth, 0.01, &info);
    ck_assert_msg(!status, "%g: %s", depth, palp_status_text(status));
    return info.force_N;
}

/* Two cubes on each other, whose nodes meet, are a column of twice the height. By its symmetry the middle of
 * the column has no shear, so friction changes nothing. */
START_TEST(two_cubes_are_a_column) {
    palp_mesh *mesh = NULL;
    const palp_material m = linear();
    const palp_network_settings settings = palp_network_settings_default();
    ck_assert_int_eq(palp_mesh_lattice((size_t[]){5, 9, 5}, (double[]){HEIGHT, 2 * HEIGHT, HEIGHT},
                                       PALP_NEIGHBOURS_26, &mesh),
                     PALP_OK);
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, 0.0, NULL), PALP_OK);
    palp_network *column = network_on(mesh, &m, &settings);
    palp_mesh_free(mesh);
    palp_network *two = pressed(two_cubes(5, 5, 0.0, 0.0, 0.0), _i == 0 ? 0.0 : 0.5);
    for (int i = 1; i <= 8; i++) {
        const double one = force_at(column, 5e-4 * i), other = force_at(two, 5e-4 * i);
        ck_assert_double_eq_tol(other / one, 1.0, i == 1 ? 0.06 : 0.04);
    }
    palp_network_free(column);
    palp_network_free(two);
}
END_TEST

/* Nodes that do not meet: another mesh, turned and shifted. The force is that of the column, with less in
 * touch; nothing pushes before the gap has closed. */
START_TEST(other_nodes_and_a_gap) {
    palp_network *even = pressed(two_cubes(5, 5, 0.0, 0.0, 0.0), 0.0),
                 *other = pressed(two_cubes(5, 6, 5e-4, 0.0, 0.0), 0.0);
    ck_assert_double_eq_tol(force_at(other, 4.9e-4), 0.0, 1e-12);
    for (int i = 1; i <= 6; i++) {
        const double one = force_at(even, 5e-4 * i), two = force_at(other, 5e-4 * (i + 1));
        ck_assert_double_eq_tol(two / one, 1.0, 0.01);
    }
    palp_network_free(even);
    palp_network_free(other);
}
END_TEST

static void leave_unsettled(palp_network *net, double depth) {
    force_at(net, 0.5 * depth);
    force_at(net, 0.8 * depth);
    ck_assert_int_eq(palp_network_try(net, depth, 0.01, NULL), PALP_OK);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0)
            net->next.x[i] += uniform(-1e-5, 1e-5);
    ck_assert(network_evaluate(net));
}

/* Forces are the slope of the energy, and the tangent, whose blocks the factor lacks, that of the forces:
 * K^-1 of the difference of two residuals is the way between them. With friction it leaves out that normals
 * turn. */
START_TEST(tangent_by_differences) {
    palp_network *net = pressed(two_cubes(4, 5, 0.0, 0.3, 0.002), _i == 0 ? 0.0 : 1e4);
    const size_t all = 3 * net->n_nodes;
    double *x = malloc(all * sizeof *x), *v = malloc(all * sizeof *v), *low = malloc(all * sizeof *low),
           *d = malloc(net->n_free * sizeof *d), scale;
    const double h = 1e-9;
    int negative;
    seed = 5;
    leave_unsettled(net, 2e-3);
    memcpy(x, net->next.x, all * sizeof *x);
    ck_assert_int_eq(network_factor(net, 0.0, &negative), PALP_OK);
    ck_assert_uint_gt(net->far.n, 20);
    ck_assert_uint_lt(net->far.n, net->far.room);
    for (int direction = 0; direction < 3; direction++) {
        for (size_t i = 0; i < all; i++)
            v[i] = net->dof[i] < 0 ? 0.0 : uniform(-1.0, 1.0);
        if (_i == 0) {
            residual_at(net, x, v, 0.0, low);
            const double step = 1e-7,
                         slope = (energy_at(net, x, v, step) - energy_at(net, x, v, -step)) / (2.0 * step);
            ck_assert_double_eq_tol(-network_dot(low, v, all), slope, 1e-4 * fabs(slope));
        }
        for (int side = -1; side <= 1; side += 2) {
            for (size_t i = 0; i < all; i++)
                net->next.x[i] = x[i] + side * h * v[i];
            ck_assert(network_evaluate(net));
            network_residual(net, &scale);
            for (size_t i = 0; i < net->n_free; i++)
                d[i] = side < 0 ? net->rhs[i] : (d[i] - net->rhs[i]) / (2.0 * h);
        }
        network_solve(net, d);
        for (size_t i = 0; i < all; i++)
            if (net->dof[i] >= 0)
                ck_assert_double_eq_tol(d[net->dof[i]], v[i], _i == 0 ? 1e-4 : 2e-2);
    }
    free(x);
    free(v);
    free(low);
    free(d);
    palp_network_free(net);
}
END_TEST

/* Two cubes in free flight, with mass. */
static palp_network *in_flight(double gap, double friction) {
    palp_mesh *mesh = two_cubes(4, 5, gap, 0.3, 0.004);
    const palp_material m = linear();
    const palp_contact_settings touch = touching(friction);
    palp_network_settings settings = palp_network_settings_default();
    palp_network *net = NULL;
    settings.density_kg_m3 = 1000.0;
    ck_assert_int_eq(palp_network_create(mesh, &m, 0, NULL, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_enable_tools(net, 0, 0, &touch), PALP_OK);
    palp_mesh_free(mesh);
    return net;
}

static void throw_at_each_other(palp_network *net, double speed) {
    double *v = calloc(3 * net->n_nodes, sizeof *v);
    for (size_t i = 0; i < net->n_nodes; i++)
        v[3 * i + 1] = net->rest[3 * i + 1] > HEIGHT * 1.001 ? -speed : speed;
    ck_assert_int_eq(palp_network_set_velocities(net, v), PALP_OK);
    free(v);
}

/* Momentum and moment of momentum; the energy of motion. */
static double motion_of(const palp_network *net, double sum[6]) {
    const double *x = palp_network_positions(net), *v = palp_network_velocities(net);
    double energy = 0.0;
    memset(sum, 0, 6 * sizeof *sum);
    for (size_t i = 0; i < net->n_nodes; i++) {
        double turn[3];
        cross3(x + 3 * i, v + 3 * i, turn);
        for (int k = 0; k < 3; k++) {
            sum[k] += net->mass[i] * v[3 * i + (size_t)k];
            sum[3 + k] += net->mass[i] * turn[k];
        }
        energy += 0.5 * net->mass[i] * dot3(v + 3 * i, v + 3 * i);
    }
    return energy;
}

/* Distance along y between the middles of the faces that meet. */
static double gap_between_cubes(const palp_network *net) {
    const double *x = palp_network_positions(net);
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < net->n_nodes; i++) {
        const double *rest = net->rest + 3 * i;
        if (hypot(rest[0] - 0.014, rest[2] - 0.012) > 0.007)
            continue;
        if (rest[1] > HEIGHT * 1.001)
            low = fmin(low, x[3 * i + 1]);
        else
            high = fmax(high, x[3 * i + 1]);
    }
    return low - high;
}

/* Cubes that fly at each other at 0.5 m/s in steps of a millisecond bounce: neither goes into the other,
 * momentum stays and energy does not grow. */
START_TEST(cubes_bounce) {
    palp_network *net = in_flight(1e-3, 0.0);
    double at_first[6], now[6], energy;
    bool touched = false;
    throw_at_each_other(net, 0.25);
    energy = motion_of(net, at_first);
    for (int i = 0; i < 200; i++) {
        size_t n;
        ck_assert_int_eq(palp_network_step(net, 0.0, 1e-3, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_contacts(net, 0, NULL, &n), PALP_OK);
        touched = touched || n > 0;
        ck_assert_double_gt(gap_between_cubes(net), -5e-4);
        ck_assert_double_lt(motion_of(net, now), energy * (1 + 1e-9));
        const double momentum = sqrt(2.0 * energy * 0.0276);
        for (int k = 0; k < 3; k++)
            ck_assert_double_eq_tol(now[k], at_first[k], 1e-6 * momentum);
    }
    ck_assert(touched);
    ck_assert_double_gt(gap_between_cubes(net), 1e-3);
    palp_network_free(net);
}
END_TEST

/* The same in ticks. */
START_TEST(cubes_bounce_in_ticks) {
    palp_network *net = in_flight(1e-3, 0.0);
    palp_realtime *rt = NULL;
    const palp_realtime_settings settings = palp_realtime_settings_default();
    const palp_budget budget = {.corrections = 30};
    double at_first[6], now[6];
    ck_assert_int_eq(palp_realtime_create(net, &settings, &rt), PALP_OK);
    throw_at_each_other(net, 0.25);
    const double energy = motion_of(net, at_first), momentum = sqrt(2.0 * energy * 0.0276);
    for (int i = 0; i < 200; i++) {
        palp_tick_info info;
        ck_assert_int_eq(palp_realtime_step(rt, 0.0, 1e-3, &budget, &info), PALP_OK);
        ck_assert_double_gt(gap_between_cubes(net), -5e-4);
        motion_of(net, now);
        for (int k = 0; k < 3; k++)
            ck_assert_double_eq_tol(now[k], at_first[k], 1e-2 * momentum);
    }
    ck_assert_double_gt(gap_between_cubes(net), 1e-3);
    palp_realtime_free(rt);
    palp_network_free(net);
}
END_TEST

/* A cube goes down on another and up again, twice, in ticks with three corrections, sideways too and with
 * friction: forces are those of steps that are solved, and stay bounded while contacts come and go. */
START_TEST(touch_and_part_in_ticks) {
    const double middle = 1.5e-3, period = 500.0;
    palp_mesh *mesh = two_cubes(5, 5, 5e-4, 0.3, 0.0);
    palp_network *net = pressed(mesh, 0.3), *solved = pressed(two_cubes(5, 5, 5e-4, 0.3, 0.0), 0.3);
    palp_realtime *rt = NULL;
    const palp_realtime_settings settings = palp_realtime_settings_default();
    const palp_budget budget = {.corrections = 3};
    ck_assert_int_eq(palp_realtime_create(net, &settings, &rt), PALP_OK);
    for (int i = 1; i <= 1000; i++) {
        palp_tick_info info;
        const double depth = middle * (1.0 - cos(6.283185307179586 * i / period));
        ck_assert_int_eq(palp_realtime_step(rt, depth, 1e-3, &budget, &info), PALP_OK);
        ck_assert_double_lt(fabs(info.force_N), 0.04);
        if (i % 25 == 0)
            ck_assert_double_eq_tol(info.force_N, force_at(solved, depth), 2e-3);
    }
    palp_realtime_free(rt);
    palp_network_free(net);
    palp_network_free(solved);
}
END_TEST

/* The upper cube goes down and to and fro on the lower one, with few corrections a tick. What friction
 * between them keeps of the error of earlier ticks is in the estimate. */
START_TEST(estimate_with_friction) {
    enum { TICKS = 400 };
    const palp_support supports[] = {{"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0}},
                                     {"upper.top", {PALP_DRIVEN, PALP_DRIVEN, PALP_FIXED}, {1.5, -1, 0}}};
    const palp_realtime_settings settings = palp_realtime_settings_default();
    const palp_network_settings plain = palp_network_settings_default();
    const palp_contact_settings touch = touching(0.3);
    const palp_material m = linear();
    const palp_budget budget = {.corrections = (size_t)_i};
    palp_network *net[2] = {NULL, NULL};
    palp_realtime *rt = NULL;
    for (int k = 0; k < 2; k++) {
        palp_mesh *mesh = two_cubes(4, 5, 0.0, 0.3, 0.0);
        ck_assert_int_eq(palp_network_create(mesh, &m, 2, supports, &plain, &net[k], NULL), PALP_OK);
        ck_assert_int_eq(palp_network_enable_tools(net[k], 0, 0, &touch), PALP_OK);
        palp_mesh_free(mesh);
    }
    ck_assert_int_eq(palp_realtime_create(net[0], &settings, &rt), PALP_OK);
    double peak = 0.0, worst = 0.0;
    for (int i = 1; i <= TICKS; i++) {
        palp_tick_info tick;
        palp_step_info step;
        const double depth = fmin(1e-5 * i, 2e-3) + (i > 200 ? 3e-4 * sin(0.05 * (i - 200)) : 0.0);
        ck_assert_int_eq(palp_realtime_step(rt, depth, 1e-3, &budget, &tick), PALP_OK);
        ck_assert_int_eq(palp_network_step(net[1], depth, 1e-3, &step), PALP_OK);
        const double off = fabs(tick.force_N - step.force_N);
        peak = fmax(peak, fabs(step.force_N));
        worst = fmax(worst, off - tick.force_error_N);
    }
    ck_assert_msg(worst <= 1e-6 * peak, "%g beyond the estimate, of %g", worst, peak);
    palp_realtime_free(rt);
    palp_network_free(net[0]);
    palp_network_free(net[1]);
}
END_TEST

/* The upper cube is led sideways: without friction the lower one feels no pull, with a little of it slips at
 * the limit, with much it is sheared along. */
START_TEST(friction_between_tissues) {
    static const double FRICTION[] = {0.0, 0.1, 5.0};
    double pull[3];
    for (int i = 0; i < 3; i++) {
        palp_mesh *mesh = two_cubes(5, 5, 0.0, 0.0, 0.0);
        const palp_support supports[] = {{"bottom", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0}},
                                         {"upper.top", {PALP_DRIVEN, PALP_DRIVEN, PALP_FIXED}, {2, -1, 0}}};
        const palp_material m = linear();
        const palp_contact_settings touch = touching(FRICTION[i]);
        palp_network *net = NULL;
        const palp_network_settings settings = palp_network_settings_default();
        ck_assert_int_eq(palp_network_create(mesh, &m, 2, supports, &settings, &net, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_enable_tools(net, 0, 0, &touch), PALP_OK);
        palp_mesh_free(mesh);
        for (int k = 1; k <= 10; k++)
            force_at(net, 3e-4 * k);
        double up[3];
        ck_assert_int_eq(palp_network_reaction(net, "bottom", up), PALP_OK);
        pull[i] = up[0] / up[1];
        palp_network_free(net);
    }
    ck_assert_double_eq_tol(pull[0] - pull[1], 0.1, 0.02);
    ck_assert_double_lt(pull[2], -0.2);
}
END_TEST

/* A block with a slit through its middle, from the left nearly to the right, is pressed from above: the lips
 * close and carry. Without contact they pass through each other. */
START_TEST(lips_of_a_cut_close) {
    double force[2];
    for (int i = 0; i < 2; i++) {
        palp_mesh *mesh = cube(7, PALP_NEIGHBOURS_26);
        const palp_material m = linear();
        palp_contact_settings touch = touching(0.0);
        const palp_network_settings settings = palp_network_settings_default();
        palp_network *net = network_on(mesh, &m, &settings);
        size_t n;
        touch.tissue = i == 1;
        ck_assert_int_eq(palp_network_enable_cutting(net), PALP_OK);
        ck_assert_int_eq(palp_network_enable_tools(net, 0, 0, &touch), PALP_OK);
        ck_assert_int_eq(
            palp_network_cut(net, (double[]){-0.01, 0.0141, -0.1, -0.01, 0.0141, 0.1, 0.02, 0.0141, 0.012},
                             &n),
            PALP_OK);
        ck_assert_uint_gt(n, 50);
        for (int k = 1; k <= 16; k++)
            force[i] = force_at(net, 4e-4 * k);
        ck_assert_int_eq(palp_network_contacts(net, 0, NULL, &n), PALP_OK);
        ck_assert(i == 0 ? n == 0 : n > 10);
        palp_mesh_free(mesh);
        palp_network_free(net);
    }
    ck_assert_double_gt(force[1], 2.0 * force[0]);
}
END_TEST

/* A saved state of cubes in touch goes on as the network itself does. */
START_TEST(saved_state_goes_on) {
    palp_network *net = pressed(two_cubes(4, 5, 0.0, 0.3, 0.002), 0.3),
                 *other = pressed(two_cubes(4, 5, 0.0, 0.3, 0.002), 0.3);
    force_at(net, 1e-3);
    const size_t size = palp_network_state_size(net);
    void *state = malloc(size);
    ck_assert_int_eq(palp_network_save(net, state, size), PALP_OK);
    ck_assert_int_eq(palp_network_restore(other, state, size), PALP_OK);
    for (int i = 0; i < 3; i++) {
        const double one = force_at(net, 1.2e-3 + 2e-4 * i), two = force_at(other, 1.2e-3 + 2e-4 * i);
        ck_assert_double_eq_tol(two / one, 1.0, 1e-6);
    }
    free(state);
    palp_network_free(net);
    palp_network_free(other);
}
END_TEST

/* The list says what each part does to the other: the nodes' forces of both sides add up to the press. */
START_TEST(contacts_are_listed) {
    enum { ROOM = 400 };
    palp_network *net = pressed(two_cubes(5, 5, 0.0, 0.2, 0.0), 0.0);
    palp_contact list[ROOM];
    size_t n;
    double sum = 0.0;
    const double press = force_at(net, 1e-3);
    ck_assert_int_eq(palp_network_contacts(net, ROOM, list, &n), PALP_OK);
    ck_assert(n > 20 && n < ROOM);
    for (size_t i = 0; i < n; i++) {
        ck_assert(list[i].tool == PALP_CONTACT_TISSUE);
        const bool upper = list[i].node >= 125;
        ck_assert((list[i].other >= 125) != upper);
        ck_assert_double_gt((upper ? 1.0 : -1.0) * list[i].normal[1], 0.9);
        sum += fabs(list[i].normal_N * list[i].normal[1]);
    }
    ck_assert_double_eq_tol(sum, press, 1e-6 * press);
    palp_network_free(net);
}
END_TEST

static palp_status check_terms(palp_network *net) {
    palp_status status = network_begin(net, 0.0, INFINITY);
    for (size_t i = 0; i < net->n_terms && !status; i++)
        if (net->terms[i]->kind->check)
            status = net->terms[i]->kind->check(net->terms[i], net);
    return status;
}

/* All of the surface within an edge of all of it: more pairs than there is room for are no contact missed,
 * but an error, until the surface is as it was. */
START_TEST(too_many_pairs) {
    palp_network *net = pressed(two_cubes(7, 7, 0.0, 0.0, 0.0), 0.0);
    ck_assert_int_eq(check_terms(net), PALP_OK);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        net->now.x[i] = 0.02 * net->rest[i];
    ck_assert_int_eq(check_terms(net), PALP_ERR_LIMIT);
    palp_network_reset(net);
    ck_assert_int_eq(check_terms(net), PALP_OK);
    palp_network_free(net);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, too_many_pairs);
    tcase_add_loop_test(tc, two_cubes_are_a_column, 0, 2);
    tcase_add_test(tc, other_nodes_and_a_gap);
    tcase_add_loop_test(tc, tangent_by_differences, 0, 2);
    tcase_add_test(tc, cubes_bounce);
    tcase_add_test(tc, cubes_bounce_in_ticks);
    tcase_add_test(tc, touch_and_part_in_ticks);
    tcase_add_loop_test(tc, estimate_with_friction, 1, 4);
    tcase_add_test(tc, friction_between_tissues);
    tcase_add_test(tc, lips_of_a_cut_close);
    tcase_add_test(tc, saved_state_goes_on);
    tcase_add_test(tc, contacts_are_listed);
}
