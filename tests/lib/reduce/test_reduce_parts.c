/* test_reduce_parts.c: shapes and kept elements alone, from snapshots that are written by hand. */
#include "reduce_make.h"
#include "tangent_make.h"

enum { NODES = 4 };

/* Snapshots of n positions at these depths, x[3 n_nodes n] zeroed; a second apart. */
static palp_snapshots *by_hand(const palp_network *net, size_t n, size_t n_tools) {
    palp_snapshots *t = calloc(1, sizeof *t);
    t->n = n;
    t->n_nodes = net->n_nodes;
    t->n_tools = n_tools;
    t->time = arena_take(&t->memory, n, sizeof *t->time);
    t->depth = arena_take(&t->memory, n, sizeof *t->depth);
    t->x = arena_take(&t->memory, 3 * net->n_nodes * n, sizeof *t->x);
    t->tools = arena_take(&t->memory, n * n_tools, sizeof *t->tools);
    ck_assert(!t->memory.failed);
    for (size_t i = 0; i < n; i++)
        t->time[i] = 1.0 + (double)i;
    return t;
}

static double in_stiffness(const palp_network *net, const double *u, const double *v, double *scratch) {
    double sum = 0.0;
    network_tangent_times(net, v, scratch);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        sum += u[i] * scratch[i];
    return sum;
}

/* v[n]: displacements of the free coordinates, orthonormal in the stiffness at rest. */
static double *orthonormal(const palp_network *net, size_t n) {
    size_t n3 = 3 * net->n_nodes;
    double *v = calloc(n * n3, sizeof *v), *scratch = malloc(n3 * sizeof *scratch);
    for (size_t j = 0; j < n; j++) {
        double *u = v + j * n3;
        for (size_t i = 0; i < n3; i++)
            u[i] = net->dof[i] < 0 ? 0.0 : sin((double)((j + 1) * (i + 1)));
        for (int twice = 0; twice < 2; twice++) {
            for (size_t k = 0; k < j; k++) {
                double along = in_stiffness(net, v + k * n3, u, scratch);
                for (size_t i = 0; i < n3; i++)
                    u[i] -= along * v[k * n3 + i];
            }
            double size = sqrt(in_stiffness(net, u, u, scratch));
            for (size_t i = 0; i < n3; i++)
                u[i] /= size;
        }
    }
    free(scratch);
    return v;
}

/* So many shapes, all from the samples, which they hold but for the tolerance. */
static palp_reduce_settings of_samples(size_t modes, double tolerance) {
    palp_reduce_settings settings = palp_reduce_settings_default();
    settings.modes = modes;
    settings.static_modes = 0;
    settings.tolerance = tolerance;
    return settings;
}

static palp_network *at_rest(palp_material *m) {
    *m = quartic(0);
    palp_network *net = cube_network(NODES, m, NULL);
    reduced_at_rest(net);
    return net;
}

/* What a plate of unit depth does in linear answer leaves no force on a free coordinate. */
START_TEST(lift_is_the_linear_answer) {
    palp_material m;
    palp_network *net = at_rest(&m);
    palp_snapshots *t = by_hand(net, 1, 0);
    memcpy(t->x, net->rest, 3 * net->n_nodes * sizeof *t->x);
    t->x[3 * (net->n_nodes / 2)] += 1e-4;
    palp_reduce_settings settings = palp_reduce_settings_default();
    settings.modes = 1;
    settings.static_modes = 0;
    size_t modes;
    double *basis, *lift, *force = malloc(3 * net->n_nodes * sizeof *force), top = 0.0;
    reduced_samples samples;
    ck_assert_int_eq(reduced_pod(net, 1, &t, &settings, &modes, &basis, &lift, &samples), PALP_OK);
    network_tangent_times(net, lift, force);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        top = fmax(top, fabs(force[i]));
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] < 0)
            ck_assert_double_eq(lift[i], net->motion[i]);
        else
            ck_assert_double_eq_tol(force[i], 0.0, 1e-11 * top);
    free(force);
    free(basis);
    free(lift);
    free(samples.q);
    palp_snapshots_free(t);
    palp_network_free(net);
}
END_TEST

/* Snapshots along four orthonormal shapes of energies 1, 0.008, 0.006, 0.004: what a tolerance leaves out is
 * counted together. The shapes come back, the largest first, and the samples' coordinates are their sizes,
 * sign apart. */
START_TEST(shapes_hold_all_but_the_tolerance) {
    enum { N = 4 };
    static const double energy[N] = {0.006, 1.0, 0.004, 0.008};
    static const struct {
        double left_out;
        size_t most, kept;
    } wanted[] = {{0.003, N, 4}, {0.005, N, 3}, {0.0095, N, 3}, {0.011, N, 2}, {0.0185, N, 1}, {0.003, 2, 2}};
    static const size_t order[N] = {1, 3, 0, 2};
    palp_material m;
    palp_network *net = at_rest(&m);
    size_t n3 = 3 * net->n_nodes;
    double *v = orthonormal(net, N);
    palp_snapshots *paths[2] = {by_hand(net, 3, 0), by_hand(net, 1, 0)};
    const size_t n_wanted = sizeof wanted / sizeof *wanted;
    for (size_t w = 0; w < n_wanted; w++) {
        palp_reduce_settings settings = of_samples(wanted[w].most, sqrt(wanted[w].left_out / 1.018));
        size_t modes;
        double *basis, *lift;
        reduced_samples samples;
        for (size_t j = 0; j < N; j++) {
            palp_snapshots *t = paths[j / 3];
            t->depth[j % 3] = 0.0;
            for (size_t i = 0; i < n3; i++)
                t->x[j % 3 * n3 + i] = net->rest[i] + 1e-3 * sqrt(energy[j]) * v[j * n3 + i];
        }
        ck_assert_int_eq(reduced_pod(net, 2, paths, &settings, &modes, &basis, &lift, &samples), PALP_OK);
        ck_assert_uint_eq(modes, wanted[w].kept);
        ck_assert_uint_eq(samples.n, N);
        for (size_t k = 0; k < modes; k++) {
            const double *shape = v + order[k] * n3;
            double sign = samples.q[order[k] * modes + k] > 0.0 ? 1.0 : -1.0;
            for (size_t i = 0; i < n3; i++)
                ck_assert_double_eq_tol(sign * basis[i * modes + k], shape[i], 1e-8);
            for (size_t j = 0; j < N; j++)
                ck_assert_double_eq_tol(sign * samples.q[j * modes + k],
                                        j == order[k] ? 1e-3 * sqrt(energy[j]) : 0.0, 1e-12);
        }
        free(basis);
        free(lift);
        free(samples.q);
    }
    free(v);
    palp_snapshots_free(paths[0]);
    palp_snapshots_free(paths[1]);
    palp_network_free(net);
}
END_TEST

/* Shapes of energies that are ten powers of ten apart, of which the samples tell the smaller one with some
 * 1e-11 of the larger: they are orthonormal to rounding. */
START_TEST(shapes_are_orthonormal_to_rounding) {
    palp_material m;
    palp_network *net = at_rest(&m);
    size_t n3 = 3 * net->n_nodes, modes;
    double *v = orthonormal(net, 2), *basis, *lift, *column = malloc(2 * n3 * sizeof *column),
           *scratch = malloc(n3 * sizeof *scratch);
    palp_snapshots *t = by_hand(net, 3, 0);
    palp_reduce_settings settings = of_samples(2, 1e-8);
    reduced_samples samples;
    for (size_t j = 0; j < 3; j++)
        for (size_t i = 0; i < n3; i++)
            t->x[j * n3 + i] = net->rest[i] + 1e-3 * (v[i] + 1e-5 * (double)j * v[n3 + i]);
    ck_assert_int_eq(reduced_pod(net, 1, &t, &settings, &modes, &basis, &lift, &samples), PALP_OK);
    ck_assert_uint_eq(modes, 2);
    for (size_t i = 0; i < 2 * n3; i++)
        column[i] = basis[i % n3 * 2 + i / n3];
    for (size_t i = 0; i < 4; i++)
        ck_assert_double_eq_tol(in_stiffness(net, column + i / 2 * n3, column + i % 2 * n3, scratch),
                                i % 3 == 0, 1e-13);
    free(v);
    free(basis);
    free(lift);
    free(column);
    free(scratch);
    free(samples.q);
    palp_snapshots_free(t);
    palp_network_free(net);
}
END_TEST

/* The lift represents the plate's motion, so the modes have only the remainder. */
START_TEST(shapes_are_beside_the_lift) {
    palp_material m;
    palp_network *net = at_rest(&m);
    size_t n3 = 3 * net->n_nodes, modes;
    double *v = orthonormal(net, 1), *basis, *lift, *first;
    palp_snapshots *t = by_hand(net, 2, 0);
    palp_reduce_settings settings = of_samples(2, 1e-6);
    reduced_samples samples;
    for (size_t i = 0; i < 2 * n3; i++)
        t->x[i] = net->rest[i % n3] + 1e-3 * v[i % n3];
    ck_assert_int_eq(reduced_pod(net, 1, &t, &settings, &modes, &basis, &first, &samples), PALP_OK);
    free(basis);
    free(samples.q);
    for (size_t j = 0; j < 2; j++) {
        t->depth[j] = 0.002 * (double)(j + 1);
        for (size_t i = 0; i < n3; i++)
            t->x[j * n3 + i] = net->rest[i] + t->depth[j] * first[i] + 1e-3 * (double)(j + 1) * v[i];
    }
    ck_assert_int_eq(reduced_pod(net, 1, &t, &settings, &modes, &basis, &lift, &samples), PALP_OK);
    ck_assert_uint_eq(modes, 1);
    ck_assert_double_eq_tol(fabs(samples.q[0]), 1e-3, 1e-11);
    ck_assert_double_eq_tol(fabs(samples.q[1]), 2e-3, 1e-11);
    free(v);
    free(first);
    free(basis);
    free(lift);
    free(samples.q);
    palp_snapshots_free(t);
    palp_network_free(net);
}
END_TEST

/* Two samples far from rest, few elements that fit them to rounding: there the plate's force and the forces
 * along the shapes are those of all elements. */
START_TEST(kept_elements_have_the_forces_of_all) {
    enum { MODES = 2, N = 2 };
    palp_material m;
    palp_network *net = at_rest(&m);
    size_t n3 = 3 * net->n_nodes, modes, n;
    double *v = orthonormal(net, MODES), *basis, *lift, *weight, residual;
    palp_snapshots *t = by_hand(net, N, 0);
    palp_reduce_settings settings = of_samples(MODES, 1e-9);
    reduced_samples samples;
    int32_t *element;
    settings.elements = net->n_elements / 2;
    settings.element_tolerance = 1e-10;
    t->depth[0] = 0.004;
    t->depth[1] = 0.006;
    for (size_t i = 0; i < N * n3; i++)
        t->x[i] = net->rest[i % n3] + t->depth[i / n3] * net->motion[i % n3] + 5e-3 * v[i];
    ck_assert_int_eq(reduced_pod(net, 1, &t, &settings, &modes, &basis, &lift, &samples), PALP_OK);
    ck_assert_uint_eq(modes, MODES);
    ck_assert_int_eq(
        reduced_ecsw(net, 1, &t, &settings, modes, basis, lift, &samples, &n, &element, &weight, &residual),
        PALP_OK);
    ck_assert_double_le(residual, 1e-10);
    ck_assert_uint_le(n, settings.elements);
    element_step_prepare(&net->material, INFINITY, &net->step);
    for (size_t j = 0; j < N; j++) {
        memcpy(net->next.x, t->x + j * n3, n3 * sizeof *net->next.x);
        ck_assert(network_evaluate(net));
        double kept[MODES + 1] = {0.0}, all[MODES + 1] = {0.0};
        for (size_t e = 0, at = 0; e < net->n_elements; e++) {
            size_t a = 3 * (size_t)net->pair[2 * e], b = 3 * (size_t)net->pair[2 * e + 1];
            bool is_kept = at < n && (size_t)element[at] == e;
            for (size_t k = 0; k <= MODES; k++) {
                double work = 0.0;
                for (size_t c = 0; c < 3; c++) {
                    double gap = k == MODES ? lift[b + c] - lift[a + c]
                                            : basis[(b + c) * MODES + k] - basis[(a + c) * MODES + k];
                    work += net->force[e] * net->direction[c * net->n_elements + e] * gap;
                }
                all[k] += work;
                kept[k] += is_kept ? weight[at] * work : 0.0;
            }
            at += is_kept;
        }
        for (size_t k = 0; k <= MODES; k++)
            ck_assert_double_eq_tol(kept[k], all[k], 1e-7 * fabs(all[k]));
    }
    free(v);
    free(basis);
    free(lift);
    free(samples.q);
    free(element);
    free(weight);
    palp_snapshots_free(t);
    palp_network_free(net);
}
END_TEST

/* Static shapes: of the loads on the surface nodes that a tool was within an element's length of, and of no
 * others. One node, three loads, three shapes: they hold its compliance, so that a load on it moves it as in
 * the full network. */
START_TEST(static_shapes_answer_loads_near_a_tool) {
    palp_material m = quartic(0);
    palp_network *net = block(NODES, &m);
    reduced_at_rest(net);
    size_t n3 = 3 * net->n_nodes, modes, top = 0;
    double *basis, *lift, length = HEIGHT / (NODES - 1);
    reduced_samples samples;
    for (size_t i = 0; i < net->n_nodes; i++) /* the corner that is farthest along each axis */
        if (net->rest[3 * i] + net->rest[3 * i + 1] + net->rest[3 * i + 2] >
            net->rest[3 * top] + net->rest[3 * top + 1] + net->rest[3 * top + 2])
            top = i;
    palp_snapshots *t = by_hand(net, 1, 1);
    palp_reduce_settings settings = palp_reduce_settings_default();
    settings.modes = 7;
    settings.static_modes = 6;
    memcpy(t->x, net->rest, n3 * sizeof *t->x);
    t->x[3 * (net->n_nodes - 1)] += 1e-9; /* a sample's shape of its own */
    t->tools[0] = (palp_tool){.shape = PALP_TOOL_SPHERE, .radius_m = 0.1 * length};
    for (size_t k = 0; k < 3; k++) /* 0.95 lengths beyond the corner, its neighbours are farther */
        t->tools[0].position_m[k] = net->rest[3 * top + k] + 1.05 * length / sqrt(3.0);
    ck_assert_int_eq(reduced_pod(net, 1, &t, &settings, &modes, &basis, &lift, &samples), PALP_OK);
    ck_assert_uint_ge(modes, 3);
    ck_assert_uint_le(modes, 4);
    for (size_t load = 3 * top; load < 3 * top + 3; load++) {
        memset(net->dx, 0, net->n_free * sizeof *net->dx);
        net->dx[net->dof[load]] = 1.0;
        linsys_solve(net->ls, net->dx);
        for (size_t i = 0; i < n3; i++) {
            double moved = 0.0;
            for (size_t j = 0; j < modes; j++)
                moved += basis[i * modes + j] * basis[load * modes + j];
            ck_assert_double_eq_tol(moved, net->dof[i] < 0 ? 0.0 : net->dx[net->dof[i]],
                                    1e-8 * net->dx[net->dof[load]]);
        }
    }
    free(basis);
    free(lift);
    free(samples.q);
    palp_snapshots_free(t);
    palp_network_free(net);
}
END_TEST

/* A capsule whose box, with its margin of four edges and what it travels, ends between the nodes on one side
 * of it. */
START_TEST(places_near_a_tool_are_those_in_its_box) {
    palp_network *net;
    palp_reduced *r = under_a_ball(&net);
    reduced_contact *surface = r->surface;
    const double edge = surface->contacts.edge, radius = 0.001, length = 0.002, along[3] = {0.6, 0.64, -0.48};
    for (size_t side = 0; side < 6; side++) {
        size_t axis = side % 3, n = 0, inside = 0;
        double margin = 4.0 * edge + 0.003 + 2.0 * length, squares;
        palp_tool is = {.shape = PALP_TOOL_CAPSULE,
                        .radius_m = radius,
                        .length_m = length,
                        .position_m = {0.01, 0.01, 0.01}},
                  was;
        double beyond = side < 3 ? 0.55 * HEIGHT - margin - radius : 0.55 * HEIGHT + margin + radius;
        memcpy(is.axis, along, sizeof is.axis);
        /* the end that is nearer to the block is where the box begins */
        is.position_m[axis] =
            side < 3 ? beyond - fmax(0.0, length * along[axis]) : beyond - fmin(0.0, length * along[axis]);
        was = is;
        was.position_m[axis] += side < 3 ? -0.003 : 0.003;
        contact_set_reset(&surface->contacts);
        ck_assert_int_eq(reduced_contact_begin(r, 1, &was), PALP_OK);
        reduced_contact_commit(r, NULL, &squares);
        ck_assert_int_eq(reduced_contact_begin(r, 1, &is), PALP_OK);
        for (size_t i = 0; i < surface->n; i++) {
            bool in = side < 3 ? surface->rest[3 * i + axis] < 0.55 * HEIGHT
                               : surface->rest[3 * i + axis] > 0.55 * HEIGHT;
            bool listed = n < surface->n_near && surface->near[n] == (int32_t)i;
            ck_assert_msg(in == listed, "side %zu, node %zu", side, i);
            n += listed;
            inside += in;
        }
        ck_assert_uint_gt(inside, 20);
        ck_assert_uint_lt(inside, surface->n);
    }
    palp_reduced_free(r);
    palp_network_free(net);
}
END_TEST

/* Away from tools places may be out of date by two edges, which is counted by the fastest node. */
START_TEST(places_are_taken_anew_once_they_may_be_far_off) {
    palp_network *net;
    palp_reduced *r = under_a_ball(&net);
    reduced_contact *surface = r->surface;
    double speed = 0.0, lift = 0.0, squares = 0.0;
    for (size_t i = 0; i < surface->n; i++) {
        double row = 0.0, up = 0.0;
        for (size_t k = 0; k < 3; k++) {
            size_t at = 3 * (size_t)surface->node[i] + k;
            up += r->lift[at] * r->lift[at];
            for (size_t j = 0; j < r->modes; j++)
                row += r->basis[at * r->modes + j] * r->basis[at * r->modes + j];
        }
        speed = fmax(speed, sqrt(row));
        lift = fmax(lift, sqrt(up));
    }
    palp_tool far = ball(0.5, 0.5, -0.5);
    ck_assert_int_eq(reduced_contact_begin(r, 1, &far), PALP_OK);
    for (size_t j = 0; j < r->modes; j++)
        r->next.q[j] = r->now.q[j] + 1e-4 * (double)(j + 1);
    r->next.depth = r->now.depth + 2e-4;
    reduced_contact_commit(r, NULL, &squares);
    double n = (double)r->modes, moved = 1e-4 * sqrt(n * (n + 1.0) * (2.0 * n + 1.0) / 6.0);
    ck_assert_double_eq_tol(surface->drift, speed * moved + lift * 2e-4, 1e-12 * surface->drift);
    for (int all = 0; all < 2; all++) {
        surface->x[0] = 7.0;
        surface->drift = (all ? 2.001 : 1.999) * surface->contacts.edge;
        ck_assert_int_eq(reduced_contact_begin(r, 1, &far), PALP_OK);
        ck_assert_double_eq(surface->x[0],
                            all ? reduced_coordinate(r, r->now.q, r->now.depth, 3 * (size_t)surface->node[0])
                                : 7.0);
        ck_assert(all ? surface->drift == 0.0 : surface->drift > 0.0);
    }
    palp_reduced_free(r);
    palp_network_free(net);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, places_near_a_tool_are_those_in_its_box);
    tcase_add_test(tc, places_are_taken_anew_once_they_may_be_far_off);
    tcase_add_test(tc, lift_is_the_linear_answer);
    tcase_add_test(tc, shapes_hold_all_but_the_tolerance);
    tcase_add_test(tc, shapes_are_orthonormal_to_rounding);
    tcase_add_test(tc, shapes_are_beside_the_lift);
    tcase_add_test(tc, kept_elements_have_the_forces_of_all);
    tcase_add_test(tc, static_shapes_answer_loads_near_a_tool);
}
