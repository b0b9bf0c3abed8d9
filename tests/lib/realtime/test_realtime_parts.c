/* test_realtime_parts.c: conjugate gradients, the adjoint, the judgement of a tick and its pieces, one by
 * one, against formulas. */
#define _POSIX_C_SOURCE 200809L
#include "contact/contact_internal.h"
#include "realtime_make.h"
#include "realtime/realtime_internal.h"
#include "solve/multigrid_internal.h"
#include "tangent_make.h"

enum { SMALL = 5, LEVELS = 12 }; /* nodes a side: a factor alone; with coarser levels */

static double size_of(const double *v, size_t n) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += v[i] * v[i];
    return sqrt(sum);
}

static double product(const double *a, const double *b, size_t n) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* A pressed cube, its factor that of the present tangent; r random on the free axes. */
static palp_realtime *pressed(size_t n) {
    palp_material m = quartic(0);
    palp_realtime *rt = realtime_on(cube_network(n, &m, NULL), false);
    palp_network *net = net_of(rt);
    for (int i = 1; i <= 3; i++)
        ck_assert_int_eq(palp_realtime_step(rt, 0.04 * i * HEIGHT, DT, &ALL, NULL), PALP_OK);
    ck_assert_int_eq(network_begin(net, net->now.depth, DT), PALP_OK);
    memcpy(net->next.x, net->now.x, 3 * net->n_nodes * sizeof *net->next.x);
    ck_assert(network_evaluate(net));
    ck_assert_int_eq(realtime_refresh_now(rt), PALP_OK);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        rt->r[i] = net->dof[i] < 0 ? 0.0 : sin(1.0 + 3.7 * (double)i);
    return rt;
}

static double *copy(const double *v, size_t n) {
    double *c = malloc(n * sizeof *c);
    ck_assert_ptr_nonnull(c);
    return memcpy(c, v, n * sizeof *c);
}

/* With the tangent's own factor, which is of single precision, one correction solves; what it says of the
 * error is that of the start in the norm of the tangent. */
START_TEST(one_correction_with_the_factor_of_the_tangent) {
    palp_realtime *rt = pressed(SMALL);
    const palp_network *net = net_of(rt);
    const size_t n = 3 * net->n_nodes;
    double *before = copy(rt->r, n), first = size_of(before, n);
    ck_assert_uint_eq(realtime_solve(rt, 1, 0.0, 0.0), 1);
    ck_assert_double_le(size_of(rt->r, n), 1e-5 * first);
    network_tangent_times(net, rt->move, rt->q);
    for (size_t i = 0; i < n; i++)
        ck_assert_double_eq_tol(net->dof[i] < 0 ? rt->move[i] : rt->q[i], net->dof[i] < 0 ? 0.0 : before[i],
                                1e-5);
    double error = sqrt(product(before, rt->move, n));
    ck_assert_double_eq_tol(rt->error_ratio, error / first, 1e-5 * error / first);
    free(before);
    drop(rt);
}
END_TEST

/* After any number of corrections the residual is orthogonal to all moves, and equals what the last move
 * leaves, in single precision. */
START_TEST(corrections_are_conjugate) {
    for (size_t limit = 1; limit <= 5; limit++) {
        palp_realtime *rt = pressed(LEVELS);
        const palp_network *net = net_of(rt);
        const size_t n = 3 * net->n_nodes;
        double *before = copy(rt->r, n);
        ck_assert_uint_gt(multigrid_levels(rt->mg), 1);
        ck_assert_uint_eq(realtime_solve(rt, limit, 1e-12, 0.0), limit);
        double across = product(rt->r, rt->move, n), size = product(before, rt->move, n);
        ck_assert_double_gt(size, 0.0);
        ck_assert_double_eq_tol(across, 0.0, 1e-9 * size);
        network_tangent_times(net, rt->move, rt->q);
        for (size_t i = 0; i < n; i++)
            if (net->dof[i] >= 0)
                ck_assert_double_eq_tol(before[i] - rt->q[i], rt->r[i], 1e-6);
        free(before);
        drop(rt);
    }
}
END_TEST

/* They end with the first that leaves less than the share asked for. */
START_TEST(corrections_end_at_their_share) {
    double share = 1.0;
    for (size_t limit = 1; limit <= 4; limit++) {
        palp_realtime *rt = pressed(LEVELS), *again = pressed(LEVELS);
        const size_t n = 3 * net_of(rt)->n_nodes;
        double first = size_of(rt->r, n);
        realtime_solve(rt, limit, 0.0, 0.0);
        double left = size_of(rt->r, n) / first;
        ck_assert_double_lt(left, share);
        ck_assert_uint_eq(realtime_solve(again, 100, left * 1.01, 0.0), limit);
        share = left;
        drop(again); /* or once the error in the tangent's norm is small enough, which the first correction
                        tells */
        again = pressed(LEVELS);
        ck_assert_uint_eq(realtime_solve(again, limit, 0.0, 1.01 * rt->error_ratio * size_of(rt->r, n)),
                          limit);
        ck_assert_double_eq(size_of(again->r, n), size_of(rt->r, n));
        drop(rt);
        drop(again);
    }
}
END_TEST

/* Where the tangent is not definite: along the preconditioned residual, no farther than 2 thousandths of the
 * size. */
START_TEST(a_little_way_where_the_tangent_is_not_definite) {
    for (int small = 0; small < 2; small++) {
        palp_realtime *rt = pressed(SMALL);
        palp_network *net = net_of(rt);
        const size_t n = 3 * net->n_nodes;
        double largest = 0.0, moved = 0.0;
        for (size_t e = 0; e < net->n_elements; e++) { /* blocks of a negative tangent and no force */
            const multigrid_source source = multigrid_input(rt->mg);
            float *along = rt->element + source.place[e], *across = along + source.spacing;
            double square = 0.0;
            for (size_t k = 0; k < 3; k++)
                square += pow(net->next.x[3 * net->pair[2 * e + 1] + (int)k] -
                                  net->next.x[3 * net->pair[2 * e] + (int)k],
                              2.0);
            *along = -*along - *across / (float)square;
            *across = 0.0F;
        }
        for (size_t i = 0; i < n; i++)
            rt->r[i] *= small ? 1e-6 : 1.0;
        ck_assert_uint_eq(realtime_solve(rt, 5, 1e-12, 0.0), 1);
        for (size_t i = 0; i < n; i++) {
            largest = fmax(largest, fabs(rt->z[i]));
            moved = fmax(moved, fabs(rt->move[i]));
        }
        double most = 0.002 * HEIGHT;
        ck_assert(small ? largest < most : largest > most);
        for (size_t i = 0; i < n; i++)
            ck_assert_double_eq_tol(rt->move[i], (small ? 1.0 : most / largest) * rt->z[i], 1e-12 * moved);
        drop(rt);
    }
}
END_TEST

static void improve_adjoint(palp_realtime *rt) {
    for (int part = 0; part < ADJOINT_PARTS; part++)
        realtime_improve_adjoint(rt, part);
}

/* An adjoint that is off by e is put right by the tangent's factor; its error was sqrt(e K e), of which half
 * is believed to be left, and which has come by where the nodes went since: on the next interval by no less
 * than seven tenths for each m. */
START_TEST(the_adjoint_is_put_right) {
    palp_realtime *rt = pressed(SMALL);
    palp_network *net = net_of(rt);
    const size_t n = 3 * net->n_nodes;
    for (int i = 0; i < 3; i++)
        improve_adjoint(rt);
    double *exact = copy(rt->adjoint, n), *e = malloc(n * sizeof *e);
    for (size_t i = 0; i < n; i++) {
        e[i] = net->dof[i] < 0 ? 0.0 : 0.1 * sin(2.0 + 1.3 * (double)i);
        rt->adjoint[i] += e[i];
    }
    network_tangent_times(net, e, rt->q);
    double error = sqrt(product(e, rt->q, n));
    rt->adjoint_far = rt->adjoint_farthest = 2e-3;
    rt->adjoint_rate = 0.0;
    improve_adjoint(rt);
    ck_assert_double_eq_tol(rt->adjoint_error, 0.5 * error, 1e-5 * error);
    ck_assert_double_eq_tol(rt->adjoint_rate, error / 2e-3, 1e-5 * error / 2e-3);
    memcpy(net->next.x, net->now.x,
           n * sizeof *net->next.x); /* they went 0.1 m from where the residual was found */
    net->next.x[0] += 0.1;
    realtime_follow_adjoint(rt);
    ck_assert_double_eq_tol(realtime_adjoint_error(rt), (0.5 + 0.1 / 2e-3) * error, 1e-4 * error);
    for (size_t i = 0; i < n; i++)
        ck_assert_double_eq_tol(rt->adjoint[i], exact[i], 1e-5);
    improve_adjoint(rt);
    ck_assert_double_le(rt->adjoint_error, 1e-5 * error);
    ck_assert_double_eq_tol(rt->adjoint_rate, 0.7 * error / 2e-3, 1e-4 * error / 2e-3);
    free(exact);
    free(e);
    drop(rt);
}
END_TEST

/* A tick takes at least one correction; where the clock leaves no room it takes no other. What parts of it
 * take is a mean that gives a tenth to the last, and that no more than three times the mean. */
START_TEST(time_leaves_room) {
    const double endless = 1e9, nothing = 1e-30;
    palp_material m = quartic(0);
    palp_budget seconds = {.seconds = 1e6};
    palp_realtime *slow = realtime_on(cube_network(LEVELS, &m, NULL), false);
    palp_realtime *quick = realtime_on(cube_network(LEVELS, &m, NULL), false);
    palp_realtime *all = realtime_on(cube_network(LEVELS, &m, NULL), false);
    palp_tick_info info, other;
    slow->times = (realtime_times){endless, 1.0, endless};
    ck_assert_int_eq(palp_realtime_step(slow, 0.1 * HEIGHT, DT, &seconds, &info), PALP_OK);
    ck_assert_uint_eq(info.corrections, 1);
    ck_assert(!info.converged);
    ck_assert_double_eq_tol(slow->times.evaluation, 0.9 * endless, 1e-3 * endless);
    ck_assert_double_eq_tol(slow->times.rest, 0.9 * endless, 1e-3 * endless);
    slow->times = (realtime_times){0.0, endless, 0.0};
    ck_assert_int_eq(palp_realtime_step(slow, 0.15 * HEIGHT, DT, &seconds, &info), PALP_OK);
    ck_assert_uint_eq(info.corrections, 1);
    ck_assert_double_eq_tol(slow->times.correction, 0.9 * endless, 1e-3 * endless);
    quick->times = (realtime_times){nothing, nothing, nothing};
    ck_assert_int_eq(palp_realtime_step(quick, 0.1 * HEIGHT, DT, &seconds, &info), PALP_OK);
    ck_assert_int_eq(palp_realtime_step(all, 0.1 * HEIGHT, DT, &ALL, &other), PALP_OK);
    ck_assert(info.converged);
    ck_assert_uint_eq(info.corrections, other.corrections);
    ck_assert_double_eq_tol(quick->times.rest, 1.2 * nothing, 1e-9 * nothing);
    palp_budget five = {.corrections = 5}, over = {.seconds = 1e-12}; /* over before anything is done */
    quick->times = (realtime_times){0.0, 1e-15, 0.0};
    ck_assert_int_eq(palp_realtime_step(quick, 0.15 * HEIGHT, DT, &over, &info), PALP_OK);
    ck_assert_uint_eq(info.corrections, 1);
    ck_assert_uint_gt(other.corrections, 5);
    ck_assert_int_eq(palp_realtime_step(all, 0.2 * HEIGHT, DT, &five, &other), PALP_OK);
    ck_assert_uint_eq(other.corrections, 5);
    drop(slow);
    drop(quick);
    drop(all);
}
END_TEST

/* What a tick says of its residual and of the force's error, under a plate and under a plane on a free top.
 */
START_TEST(a_tick_is_judged) {
    for (int tool = 0; tool < 2; tool++) {
        palp_material m = quartic(1);
        palp_realtime *rt =
            tool ? cube_on_a_table(LEVELS, 1) : realtime_on(cube_network(LEVELS, &m, NULL), false);
        palp_network *net = net_of(rt);
        const palp_budget one = {.corrections = 1};
        palp_tick_info info;
        double remembered = 0.0;
        for (size_t tick = 1; tick <= 3; tick++) {
            double down = 3e-4 * (double)tick;
            palp_tool plane = {
                .shape = PALP_TOOL_PLANE, .position_m = {0, HEIGHT - down, 0}, .axis = {0, -1, 0}};
            if (tool)
                ck_assert_int_eq(palp_network_set_tools(net, 1, &plane), PALP_OK);
            ck_assert_int_eq(palp_realtime_step(rt, tool ? 0.0 : down, DT, &one, &info), PALP_OK);
            double left = 0.0, scale, squares = 0.0, stiffness = 0.0;
            double norm =
                network_residual(net, &scale); /* of the last evaluation, which is the committed state */
            for (size_t i = 0; i < net->n_elements; i++)
                squares += net->force[i] * net->force[i];
            for (size_t i = 0; i < 3 * net->n_nodes; i++)
                left += net->dof[i] < 0 ? 0.0 : pow(net->fint[i] + net->outer[i], 2.0);
            ck_assert_double_eq_tol(norm, sqrt(left), 1e-9 * norm);
            if (!tool) /* the scale has a little for rounding in it */
                ck_assert_double_eq_tol(info.residual, sqrt(left / squares), 0.01 * info.residual);
            else
                ck_assert_double_eq_tol(info.residual, net->settings.tolerance * norm / scale, 1e-12);
            for (size_t i = 0; tool && i < net->n_nodes; i++)
                if (contact_of(net)->triangles[i] > 0 && net->rest[3 * i + 1] > 0.99 * HEIGHT)
                    stiffness += 3.0 * net->unit[i] * (0.54 + 0.4);
            const double places = 3.0 * realtime_doubt(rt) * rt->error_ratio * norm;
            double fresh =
                places * (tool ? sqrt(stiffness) : rt->adjoint_error + rt->adjoint_rate * rt->adjoint_far);
            ck_assert_double_gt(fresh, 0.0);
            ck_assert_double_eq_tol(info.force_error_N, fresh + remembered,
                                    0.02 * tool * fresh + 1e-9 * fresh);
            double decay = exp(-DT / 0.5); /* 0.2 N s / 0.4 N, of 0.94 N in all */
            remembered = decay * remembered + (1.0 - decay) * 0.4 / 0.94 *
                                                  (info.force_error_N + (tool ? 0.0 : rt->forgets * places));
            ck_assert_double_eq_tol(rt->remembered, remembered, 1e-12 * remembered);
        }
        drop(rt);
    }
}
END_TEST

/* A tick's share of work on the next factor, which is begun when that share of a unit an element has passed.
 */
START_TEST(a_piece_is_its_share_of_a_tick) {
    palp_material m = quartic(0);
    palp_realtime_settings settings = {.refresh_share = 0.2};
    palp_network *net = cube_network(LEVELS, &m, NULL);
    palp_realtime *rt = NULL;
    ck_assert_int_eq(palp_realtime_create(net, &settings, &rt), PALP_OK);
    double tick = 2.0 * ((double)net->n_elements + multigrid_cycle_work(rt->mg));
    ck_assert_double_eq_tol(rt->piece, 0.25 * tick, 1e-9 * tick);
    rt->piece = 0.4 * (double)net->n_elements;
    for (size_t i = 1; i <= 3; i++) { /* the share of three pieces is more than all */
        ck_assert_int_eq(palp_realtime_step(rt, 1e-4, DT, &ALL, NULL), PALP_OK);
        ck_assert_int_eq(rt->stage, i < 3 ? REFRESH_DUE : REFRESH_MAKE);
        ck_assert_uint_eq(rt->at, i < 3 ? i : 0);
    }
    drop(rt);
}
END_TEST

/* A tick leaves the tangent out where nothing uses it: where it does, it is that of the committed state. */
START_TEST(tangent_of_a_tick_is_of_its_end) {
    const palp_budget budget = {.corrections = _i == 0 ? 1 : 0, .force_error = _i == 0 ? 0.0 : 1e-3};
    palp_material m = quartic(0);
    palp_realtime *rt = realtime_on(cube_network(LEVELS, &m, NULL), false);
    palp_network *net = net_of(rt);
    const multigrid_source source = multigrid_input(rt->mg);
    float *used = calloc(source.n_floats, sizeof *used);
    size_t wanted = 0, not_wanted = 0;
    ck_assert_ptr_nonnull(used);
    for (size_t i = 1; i <= 150; i++) {
        const int due = rt->adjoint_due;
        const bool begins = due == 0 && realtime_refresh_begins(rt);
        ck_assert_int_eq(palp_realtime_step(rt, 1e-3 * HEIGHT * (double)i, DT, &budget, NULL), PALP_OK);
        memcpy(used, begins ? multigrid_input(rt->mg).element : rt->element, source.n_floats * sizeof *used);
        ck_assert(!begins || rt->stage == REFRESH_MAKE);
        ck_assert_int_eq(network_begin(net, net->now.depth, DT), PALP_OK);
        memcpy(net->next.x, net->now.x, 3 * net->n_nodes * sizeof *net->next.x);
        ck_assert(realtime_evaluate(rt, true, false));
        const bool same = memcmp(used, rt->element, source.n_floats * sizeof *used) == 0;
        ck_assert(same || !(begins || due == ADJOINT_PARTS || due == 1));
        wanted += begins || due == ADJOINT_PARTS || due == 1;
        not_wanted += !same;
    }
    ck_assert_uint_gt(wanted, 5);
    ck_assert_uint_gt(not_wanted, 100);
    free(used);
    drop(rt);
}
END_TEST

/* From the start both sets of the factor's numbers have been made, so that no tick waits for memory that
 * nothing has used yet. */
START_TEST(both_sets_are_made_at_the_start) {
    palp_material m = quartic(0);
    palp_realtime *rt = realtime_on(cube_network(LEVELS, &m, NULL), false);
    const mg_level *l = &rt->mg->level[0];
    double sum = 0.0;
    for (size_t i = 0; i < BLOCK_FLOATS * l->n; i++) {
        ck_assert(l->inverse[0][i] == l->inverse[1][i]);
        sum += fabs((double)l->inverse[1][i]);
    }
    ck_assert_double_gt(sum, 0.0);
    drop(rt);
}
END_TEST

/* A cube whose corner is pulled through its box; the opposite one is free. */
static palp_network *corner_network(size_t *around) {
    const palp_support supports[] = {{"held", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0.0, 0.0, 0.0}},
                                     {"corner", {PALP_DRIVEN, PALP_DRIVEN, PALP_DRIVEN}, {-1.0, -1.0, -1.0}}};
    const palp_network_settings settings = palp_network_settings_default();
    const int32_t corner = 26, opposite = 0;
    palp_material m = quartic(0);
    palp_mesh *mesh = cube(3, PALP_NEIGHBOURS_26);
    palp_network *net = NULL;
    int32_t held[26];
    size_t n = 0;
    for (int32_t i = 0; i < corner; i++)
        if (i != opposite)
            held[n++] = i;
    *around = 0;
    for (size_t i = 0; i < 4 * palp_mesh_tetrahedron_count(mesh); i++)
        *around += palp_mesh_tetrahedra(mesh)[i] == corner;
    ck_assert_int_eq(palp_mesh_add_set(mesh, "held", n, held), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_set(mesh, "corner", 1, &corner), PALP_OK);
    ck_assert_int_eq(palp_network_create(mesh, &m, 2, supports, &settings, &net, NULL), PALP_OK);
    palp_mesh_free(mesh);
    return net;
}

/* Inverted tetrahedra: after as many ticks as there are parts, ticks report the same count as steps. A
 * restored state reports it at every tick. */
START_TEST(inverted_tetrahedra_are_counted) {
    size_t around = 0, middle = 0;
    palp_realtime *rt = realtime_on(corner_network(&around), false),
                  *other = realtime_on(corner_network(&around), false);
    palp_tick_info info, again;
    palp_step_info step;
    size_t size = palp_realtime_state_size(rt);
    void *state = malloc(size);
    ck_assert_ptr_nonnull(state);
    ck_assert_int_eq(palp_realtime_step(rt, 0.2 * HEIGHT, DT, &ALL, &info), PALP_OK);
    ck_assert_uint_eq(info.inverted, 0);
    for (size_t i = 0; i < REALTIME_PARTS; i++) {
        ck_assert_int_eq(palp_realtime_step(rt, 0.6 * HEIGHT, DT, &ALL, &info), PALP_OK);
        middle += info.inverted > 0 && info.inverted < around;
        if (i == REALTIME_PARTS / 2)
            ck_assert_int_eq(palp_realtime_save(rt, state, size), PALP_OK);
    }
    ck_assert_int_eq(palp_network_try(net_of(rt), 0.6 * HEIGHT, DT, &step), PALP_OK);
    ck_assert_uint_ge(step.inverted, around);
    ck_assert_uint_eq(info.inverted, step.inverted);
    ck_assert_uint_gt(middle, 0); /* it takes its ticks */
    ck_assert_int_eq(palp_realtime_restore(other, state, size), PALP_OK);
    for (size_t i = REALTIME_PARTS / 2 + 1; i < REALTIME_PARTS; i++)
        ck_assert_int_eq(palp_realtime_step(other, 0.6 * HEIGHT, DT, &ALL, &again), PALP_OK);
    ck_assert_uint_eq(again.inverted, info.inverted);
    ck_assert_int_eq(palp_realtime_reset(other), PALP_OK);
    ck_assert_int_eq(palp_realtime_step(other, 0.0, DT, &ALL, &again), PALP_OK);
    ck_assert_uint_eq(again.inverted, 0);
    for (size_t i = 0; i < REALTIME_PARTS; i++)
        ck_assert_int_eq(palp_realtime_step(rt, 0.1 * HEIGHT, DT, &ALL, &info), PALP_OK);
    ck_assert_uint_eq(info.inverted, 0);
    free(state);
    drop(rt);
    drop(other);
}
END_TEST

/* Springs of 0.54 N with an arm of 0.2 N, L (K e^2 + q^2 / K_1) / 2 each, and m v^2 / 2. */
START_TEST(energy_is_that_of_springs_arms_and_motion) {
    palp_material m = {.n_arms = 1, .arms = {{0.2, 0.01, 0, 0}}};
    palp_network_settings settings = palp_network_settings_default();
    settings.density_kg_m3 = 1070.0;
    ck_assert_int_eq(palp_law_polynomial(1, (double[]){0.54}, &m.law), PALP_OK);
    palp_realtime *rt = realtime_on(cube_network(SMALL, &m, &settings), false);
    const palp_network *net = net_of(rt);
    for (int i = 1; i <= 5; i++)
        ck_assert_int_eq(palp_realtime_step(rt, 0.01 * i * HEIGHT, DT, &ALL, NULL), PALP_OK);
    double springs = 0.0, arms = 0.0, motion = 0.0;
    for (size_t i = 0; i < net->n_elements; i++) {
        double e = net->now.history.strain[i], q = net->now.history.arm[i];
        springs += 0.5 * 0.54 * e * e / net->inverse_rest[i];
        arms += 0.5 * q * q / 0.2 / net->inverse_rest[i];
    }
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        motion += 0.5 * net->mass[i / 3] * net->now.velocity[i] * net->now.velocity[i];
    double all = springs + arms + motion;
    ck_assert(springs > 0.01 * all && arms > 0.01 * all && motion > 0.01 * all);
    ck_assert_double_eq_tol(palp_realtime_energy(rt), all, 1e-12 * all);
    drop(rt);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, energy_is_that_of_springs_arms_and_motion);
    tcase_add_test(tc, inverted_tetrahedra_are_counted);
    tcase_add_test(tc, one_correction_with_the_factor_of_the_tangent);
    tcase_add_test(tc, corrections_are_conjugate);
    tcase_add_test(tc, corrections_end_at_their_share);
    tcase_add_test(tc, a_little_way_where_the_tangent_is_not_definite);
    tcase_add_test(tc, the_adjoint_is_put_right);
    tcase_add_test(tc, time_leaves_room);
    tcase_add_test(tc, a_tick_is_judged);
    tcase_add_loop_test(tc, tangent_of_a_tick_is_of_its_end, 0, 2);
    tcase_add_test(tc, both_sets_are_made_at_the_start);
    tcase_add_test(tc, a_piece_is_its_share_of_a_tick);
}
