/* test_network.c: networks against other solvers' figures and laws of conservation. */
#include "network_settle.h"

/* ---- figures ------------------------------------------------------------------------------------- */

/* Fully relaxed steps of 0.01 strain; the force at each tenth is that of two other solvers. */
static void check_figures(size_t n, palp_solver solver, const double want[4]) {
    palp_material m = quartic(0);
    palp_network_settings settings = palp_network_settings_default();
    settings.solver = solver;
    palp_network *net = cube_network(n, &m, &settings);
    for (int i = 1; i <= 40; i++) {
        ck_assert_int_eq(palp_network_step(net, 0.01 * i * HEIGHT, INFINITY, NULL), PALP_OK);
        if (i % 10 == 0)
            ck_assert_double_eq_tol(palp_network_force(net), want[i / 10 - 1], 1e-6);
    }
    palp_network_free(net);
}

START_TEST(figures_of_other_solvers) {
    static const double small[] = {0.851966, 1.831668, 2.961096, 4.306510};
    static const double large[] = {2.551424, 5.479929, 9.052187, 13.264005};
    static const palp_solver solvers[] = {PALP_SOLVER_AUTO, PALP_SOLVER_BAND, PALP_SOLVER_SIMPLICIAL};
    for (size_t s = 0; s < 3; s++) {
        check_figures(3, solvers[s], small);
        check_figures(5, solvers[s], large);
    }
}
END_TEST

START_TEST(one_long_step_finds_the_same_equilibrium) {
    palp_material m = quartic(0);
    palp_network *net = cube_network(3, &m, NULL);
    ck_assert_int_eq(palp_network_step(net, 0.3 * HEIGHT, INFINITY, NULL), PALP_OK);
    ck_assert_double_eq_tol(palp_network_force(net), 2.961096, 1e-6);
    palp_network_free(net);
}
END_TEST

START_TEST(buckling_is_found_where_it_is) {
    static const size_t nodes[] = {3, 5};
    static const double low[] = {0.33, 0.325}, high[] = {0.36, 0.33};
    palp_material m = quartic(0);
    for (size_t k = 0; k < 2; k++) {
        palp_network *net = cube_network(nodes[k], &m, NULL);
        palp_step_info info;
        double stable = -1.0, unstable = -1.0;
        int i = 0;
        for (i = 1; i <= 400 && !palp_network_buckled(net, &stable, &unstable); i++) {
            ck_assert_double_eq(stable, -1.0);
            ck_assert_int_eq(palp_network_step(net, 0.001 * i * HEIGHT, INFINITY, &info), PALP_OK);
        }
        ck_assert_int_gt(info.negative_pivots, 0);
        ck_assert_double_ge(unstable, low[k] * HEIGHT);
        ck_assert_double_le(unstable, high[k] * HEIGHT);
        ck_assert_double_lt(stable, unstable);
        ck_assert_double_le(unstable - stable, 0.0051 * HEIGHT);
        palp_network_reset(net);
        ck_assert(!palp_network_buckled(net, &stable, &unstable));
        palp_network_free(net);
    }
}
END_TEST

START_TEST(stable_branch_is_the_other_one) {
    palp_material m = quartic(0);
    palp_network_settings settings = palp_network_settings_default();
    settings.branch = PALP_BRANCH_STABLE;
    palp_network *net = cube_network(5, &m, &settings);
    palp_step_info info;
    double stable, unstable;
    for (int i = 1; i <= 40; i++) {
        ck_assert_int_eq(palp_network_step(net, 0.01 * i * HEIGHT, INFINITY, &info), PALP_OK);
        ck_assert_int_eq(info.negative_pivots, 0);
        if (i == 30)
            ck_assert_double_eq_tol(palp_network_force(net), 9.052187, 1e-6);
    }
    ck_assert_double_eq_tol(palp_network_force(net), 12.975, 1e-3);
    ck_assert(palp_network_buckled(net, &stable, &unstable));
    ck_assert_double_ge(unstable, 0.32 * HEIGHT);
    ck_assert_double_le(unstable, 0.335 * HEIGHT);
    palp_network_free(net);
}
END_TEST

/* ---- invariance and conservation ----------------------------------------------------------------- */

/* A rotation about a slanted axis (Rodrigues). */
static void rotation(double angle, double r[3][3]) {
    const double a[3] = {2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0}, c = cos(angle), s = sin(angle);
    const double cross[3][3] = {{0, -a[2], a[1]}, {a[2], 0, -a[0]}, {-a[1], a[0], 0}};
    for (size_t i = 0; i < 3; i++)
        for (size_t k = 0; k < 3; k++)
            r[i][k] = (i == k ? c : 0.0) + s * cross[i][k] + (1.0 - c) * a[i] * a[k];
}

static void turn(double r[3][3], const double *v, double *out) {
    for (size_t i = 0; i < 3; i++)
        out[i] = r[i][0] * v[0] + r[i][1] * v[1] + r[i][2] * v[2];
}

START_TEST(rigid_motion_gives_no_force) {
    static const double angles[] = {1e-3, 0.7, 2.0, 3.14159};
    for (int kind = 0; kind < KINDS; kind++) {
        palp_material m = material_of(kind);
        palp_network *net = cube_network(3, &m, NULL);
        element_step_prepare(&net->material, 0.1, &net->step);
        for (size_t a = 0; a < 4; a++) {
            double r[3][3];
            rotation(angles[a], r);
            for (size_t i = 0; i < net->n_nodes; i++) {
                turn(r, net->rest + 3 * i, net->next.x + 3 * i);
                net->next.x[3 * i] += 0.5;
                net->next.x[3 * i + 2] -= 0.03;
            }
            ck_assert(network_evaluate(net));
            /* positions of half a metre are known to 1e-16 m, strains to 1e-14, forces to that times 2 N
             * and 26 elements */
            for (size_t i = 0; i < 3 * net->n_nodes; i++)
                if (!(fabs(net->fint[i]) < 1e-12))
                    ck_abort_msg("kind %d, angle %g: force %g on axis %zu", kind, angles[a], net->fint[i], i);
        }
        palp_network_free(net);
    }
}
END_TEST

START_TEST(forces_turn_with_the_network) {
    seed = 2;
    for (int kind = 0; kind < SEDEF; kind++) { /* Eq. 5.11 carries a vector that does not turn */
        palp_material m = material_of(kind);
        palp_network *net = cube_network(3, &m, NULL);
        size_t n3 = 3 * net->n_nodes;
        double *x = malloc(n3 * sizeof *x), *f = malloc(n3 * sizeof *f), r[3][3], want[3];
        ck_assert(x && f);
        unsettle(net, 0.2 * HEIGHT);
        memcpy(x, net->next.x, n3 * sizeof *x);
        memcpy(f, net->fint, n3 * sizeof *f);
        rotation(1.1, r);
        for (size_t i = 0; i < net->n_nodes; i++)
            turn(r, x + 3 * i, net->next.x + 3 * i);
        ck_assert(network_evaluate(net));
        for (size_t i = 0; i < net->n_nodes; i++) {
            turn(r, f + 3 * i, want);
            for (size_t k = 0; k < 3; k++)
                if (!(fabs(net->fint[3 * i + k] - want[k]) < 1e-11))
                    ck_abort_msg("kind %d: force %g not %g", kind, net->fint[3 * i + k], want[k]);
        }
        free(x);
        free(f);
        palp_network_free(net);
    }
}
END_TEST

START_TEST(column_agrees_with_the_lumped_solid) {
    enum { N = 60 };
    double time[N], depth[N], force[N];
    for (size_t i = 0; i < N; i++) { /* in, held, out into tension, at uneven steps */
        double t = 0.003 * (double)(i * i);
        time[i] = t;
        depth[i] = HEIGHT * 0.35 * (t < 1.0 ? t : t < 4.0 ? 1.0 : t < 8.0 ? 1.0 - 0.4 * (t - 4.0) : -0.6);
    }
    for (int kind = 0; kind < KINDS; kind++)
        for (size_t nodes = 2; nodes <= 3; nodes++) {
            palp_material m = material_of(kind);
            palp_network *net = column_of(nodes, &m);
            ck_assert_int_eq(palp_lumped_run(&m, HEIGHT, N, time, depth, force), PALP_OK);
            for (size_t i = 1; i < N; i++) {
                ck_assert_int_eq(palp_network_step(net, depth[i], time[i] - time[i - 1], NULL), PALP_OK);
                double got = palp_network_force(net), element[2];
                palp_network_element_force(net, element);
                ck_assert_msg(fabs(got - force[i]) < 1e-10 * fmax(1.0, fabs(force[i])),
                              "kind %d, %zu nodes, t %g: %.15g not %.15g", kind, nodes, time[i], got,
                              force[i]);
                ck_assert_double_eq_tol(element[0], -got, 1e-10); /* tension positive */
            }
            palp_network_free(net);
        }
}
END_TEST

/* |sum over the sets| below 1e-9 of the force, and the plate's part of it is the force. */
static void check_balance(const palp_network *net) {
    double top[3], bottom[3], force = palp_network_force(net);
    ck_assert_int_eq(palp_network_reaction(net, "top", top), PALP_OK);
    ck_assert_int_eq(palp_network_reaction(net, "bottom", bottom), PALP_OK);
    for (size_t k = 0; k < 3; k++)
        ck_assert_double_eq_tol(top[k] + bottom[k], 0.0, 1e-9 * fabs(force));
    ck_assert_double_eq_tol(top[1], force, 1e-14 * fabs(force));
}

START_TEST(reactions_balance) {
    for (int kind = 0; kind < KINDS; kind++) {
        palp_material m = material_of(kind);
        palp_network *net = cube_network(4, &m, NULL);
        for (int i = 1; i <= 10; i++) {
            ck_assert_int_eq(palp_network_step(net, 0.02 * i * HEIGHT, 0.1, NULL), PALP_OK);
            check_balance(net);
        }
        for (int i = 1; i <= 5; i++) {
            ck_assert_int_eq(palp_network_step(net, 0.2 * HEIGHT, 0.1 * i, NULL), PALP_OK);
            check_balance(net);
        }
        palp_network_free(net);
    }
}
END_TEST

START_TEST(reactions_balance_where_it_buckled) {
    palp_material m = quartic(0);
    palp_network_settings settings = palp_network_settings_default();
    settings.branch = PALP_BRANCH_STABLE;
    palp_network *net = cube_network(3, &m, &settings);
    for (int i = 1; i <= 20; i++)
        ck_assert_int_eq(palp_network_step(net, 0.02 * i * HEIGHT, INFINITY, NULL), PALP_OK);
    check_balance(net);
    palp_network_free(net);
}
END_TEST

/* ---- solvers, neighbourhoods, mechanisms --------------------------------------------------------- */

START_TEST(solvers_agree) {
    static const palp_solver solvers[] = {
        PALP_SOLVER_BAND,
        PALP_SOLVER_SIMPLICIAL,
        PALP_SOLVER_AUTO,
#ifdef PALP_GPL
        PALP_SOLVER_SUPERNODAL,
#endif
    };
    enum { N = sizeof solvers / sizeof *solvers };
    palp_material m = quartic(2);
    double force[N], x[N];
    for (size_t s = 0; s < N; s++) {
        palp_network_settings settings = palp_network_settings_default();
        settings.solver = solvers[s];
        palp_network *net = cube_network(6, &m, &settings);
        for (int i = 1; i <= 4; i++)
            ck_assert_int_eq(palp_network_step(net, 0.05 * i * HEIGHT, 0.2, NULL), PALP_OK);
        force[s] = palp_network_force(net);
        x[s] = palp_network_positions(net)[3 * ((2 * 6 + 2) * 6 + 1)];
        palp_network_free(net);
    }
    for (size_t s = 1; s < N; s++) {
        ck_assert_double_eq_tol(force[s], force[0], 1e-9 * force[0]);
        ck_assert_double_eq_tol(x[s], x[0], 1e-9 * HEIGHT);
    }
}
END_TEST

START_TEST(eighteen_neighbours) {
    palp_mesh *mesh = cube(4, PALP_NEIGHBOURS_18);
    palp_material m = quartic(1);
    palp_network_settings settings = palp_network_settings_default();
    palp_network *net = network_on(mesh, &m, &settings), *all = cube_network(4, &m, NULL);
    for (int i = 1; i <= 5; i++) {
        ck_assert_int_eq(palp_network_step(net, 0.03 * i * HEIGHT, 0.1, NULL), PALP_OK);
        ck_assert_int_eq(palp_network_step(all, 0.03 * i * HEIGHT, 0.1, NULL), PALP_OK);
        check_balance(net);
    }
    ck_assert_double_gt(palp_network_force(net), 0.0);
    ck_assert_double_lt(palp_network_force(net), palp_network_force(all)); /* fewer elements are softer */
    palp_network_free(net);
    palp_network_free(all);
    palp_mesh_free(mesh);
}
END_TEST

/* A free corner of a lattice pulled through its box: the tetrahedra that it turns inside out are counted, and
 * only they. */
START_TEST(inverted_tetrahedra_are_counted) {
    palp_material m = quartic(0);
    palp_mesh *mesh = cube(3, PALP_NEIGHBOURS_26);
    palp_step_info info;
    palp_network *net = NULL;
    const int32_t corner = 26; /* of one box alone, in one or more of its six tetrahedra */
    const palp_support supports[] = {{"held", {PALP_FIXED, PALP_FIXED, PALP_FIXED}, {0.0, 0.0, 0.0}},
                                     {"corner", {PALP_DRIVEN, PALP_DRIVEN, PALP_DRIVEN}, {-1.0, -1.0, -1.0}}};
    int32_t held[26];
    for (int32_t i = 0; i < 26; i++)
        held[i] = i;
    ck_assert_int_eq(palp_mesh_add_set(mesh, "held", 26, held), PALP_OK);
    ck_assert_int_eq(palp_mesh_add_set(mesh, "corner", 1, &corner), PALP_OK);
    palp_network_settings settings = palp_network_settings_default();
    ck_assert_int_eq(palp_network_create(mesh, &m, 2, supports, &settings, &net, NULL), PALP_OK);
    size_t around = 0;
    for (size_t i = 0; i < 4 * palp_mesh_tetrahedron_count(mesh); i++)
        around += palp_mesh_tetrahedra(mesh)[i] == corner;
    ck_assert_uint_gt(around, 0);
    ck_assert_int_eq(palp_network_step(net, 0.2 * HEIGHT, INFINITY, &info), PALP_OK);
    ck_assert_uint_eq(info.inverted, 0);
    ck_assert_int_eq(palp_network_step(net, 0.6 * HEIGHT, INFINITY, &info),
                     PALP_OK); /* a box is half as wide */
    ck_assert_uint_eq(info.inverted, around);
    palp_network_free(net);
    palp_mesh_free(mesh);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, inverted_tetrahedra_are_counted);
    tcase_add_test(tc, figures_of_other_solvers);
    tcase_add_test(tc, one_long_step_finds_the_same_equilibrium);
    tcase_add_test(tc, buckling_is_found_where_it_is);
    tcase_add_test(tc, stable_branch_is_the_other_one);
    tcase_add_test(tc, rigid_motion_gives_no_force);
    tcase_add_test(tc, forces_turn_with_the_network);
    tcase_add_test(tc, column_agrees_with_the_lumped_solid);
    tcase_add_test(tc, reactions_balance);
    tcase_add_test(tc, reactions_balance_where_it_buckled);
    tcase_add_test(tc, solvers_agree);
    tcase_add_test(tc, eighteen_neighbours);
}
