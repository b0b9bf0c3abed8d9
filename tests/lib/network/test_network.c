/* test_network.c: networks against other solvers' figures, finite differences and laws of conservation. */
#include "network/network_internal.h"
#include "network_make.h"

#include <stdio.h>

/* The same numbers on every machine: a 64-bit linear congruential generator (Knuth's MMIX). */
static uint64_t seed;
static double uniform(double low, double high) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(seed >> 11) / 9007199254740992.0;
}

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

/* ---- derivatives --------------------------------------------------------------------------------- */

/* Leaves the network in the middle of a step of 10 ms to depth, with a history and random displacements of
 * the free nodes. */
static void unsettle(palp_network *net, double depth) {
    ck_assert_int_eq(palp_network_step(net, 0.5 * depth, 0.02, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_step(net, 0.8 * depth, 0.05, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_try(net, depth, 0.01, NULL), PALP_OK);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0)
            net->next.x[i] += uniform(-4e-4, 4e-4);
    ck_assert(network_evaluate(net));
}

static void displace(palp_network *net, const double *x, const double *along, double h) {
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0)
            net->next.x[i] = x[net->dof[i]] + h * along[net->dof[i]];
    ck_assert(network_evaluate(net));
}

/* K^-1 (r(x - h v) - r(x + h v)) / 2 h is v if K, factored, is the derivative of the residual -r. */
static void check_jacobian(palp_network *net, const char *what) {
    size_t n = net->n_free;
    double *x = malloc(n * sizeof *x), *v = malloc(n * sizeof *v), *r = malloc(n * sizeof *r), scale;
    const double h = 1e-8;
    int negative;
    ck_assert(x && v && r);
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0)
            x[net->dof[i]] = net->next.x[i];
    ck_assert_int_eq(network_factor(net, 0.0, &negative), PALP_OK);
    for (int direction = 0; direction < 3; direction++) {
        for (size_t i = 0; i < n; i++)
            v[i] = uniform(-1.0, 1.0);
        displace(net, x, v, -h);
        network_residual(net, &scale);
        memcpy(r, net->rhs, n * sizeof *r);
        displace(net, x, v, h);
        network_residual(net, &scale);
        for (size_t i = 0; i < n; i++)
            r[i] = (r[i] - net->rhs[i]) / (2.0 * h);
        linsys_solve(net->ls, r);
        for (size_t i = 0; i < n; i++)
            if (!(fabs(r[i] - v[i]) < 1e-5))
                ck_abort_msg("%s: unknown %zu moves by %.9g not %.9g", what, i, r[i], v[i]);
    }
    displace(net, x, v, 0.0);
    free(x);
    free(v);
    free(r);
}

/* d residual / d depth, against differences too. */
static void check_drive(palp_network *net, const char *what) {
    size_t n = net->n_free;
    double *column = malloc(n * sizeof *column), *r = malloc(n * sizeof *r), scale, largest = 0.0;
    const double h = 1e-8, depth = net->next.depth;
    ck_assert(column && r);
    network_drive_column(net, column);
    network_place(net, depth - h);
    ck_assert(network_evaluate(net));
    network_residual(net, &scale);
    memcpy(r, net->rhs, n * sizeof *r);
    network_place(net, depth + h);
    ck_assert(network_evaluate(net));
    network_residual(net, &scale);
    for (size_t i = 0; i < n; i++)
        largest = fmax(largest, fabs(column[i]));
    for (size_t i = 0; i < n; i++)
        if (!(fabs((net->rhs[i] - r[i]) / (2.0 * h) - column[i]) < 1e-6 * largest))
            ck_abort_msg("%s: column of unknown %zu is %.9g", what, i, column[i]);
    free(column);
    free(r);
}

START_TEST(jacobian_is_the_derivative_of_the_residual) {
    static const palp_solver solvers[] = {PALP_SOLVER_BAND, PALP_SOLVER_SIMPLICIAL};
    seed = 1;
    for (int kind = 0; kind < KINDS; kind++)
        for (int mass = 0; mass < 3; mass++)
            for (size_t s = 0; s < 2; s++) {
                palp_material m = material_of(kind);
                palp_network_settings settings = palp_network_settings_default();
                char what[80];
                settings.density_kg_m3 = mass ? 1070.0 : 0.0;
                settings.integrator = mass == 2 ? PALP_GENERALIZED_ALPHA : PALP_BACKWARD_EULER;
                settings.solver = solvers[s];
                palp_network *net = cube_network(4, &m, &settings);
                snprintf(what, sizeof what, "material %d, mass %d, solver %zu", kind, mass, s);
                unsettle(net, 0.1 * HEIGHT);
                check_jacobian(net, what);
                check_drive(net, what);
                palp_network_free(net);
            }
}
END_TEST

/* The force's slope and the adjoint weights at an equilibrium, against steps to either side. */
static void check_weights(int kind, bool mass) {
    palp_material m = material_of(kind);
    palp_network_settings settings = palp_network_settings_default();
    settings.density_kg_m3 = mass ? 1070.0 : 0.0;
    settings.tolerance = 1e-13;
    palp_network *net = cube_network(3, &m, &settings);
    palp_step_info high, low, info;
    const double depth = 0.15 * HEIGHT, h = 1e-7, dt = 2e-3;
    double *weight = malloc(element_count(net) * sizeof *weight), stiffness;
    ck_assert(weight != NULL);
    ck_assert_int_eq(palp_network_step(net, 0.14 * HEIGHT, 0.5, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_try(net, depth + h, dt, &high), PALP_OK);
    ck_assert_int_eq(palp_network_try(net, depth - h, dt, &low), PALP_OK);
    ck_assert_int_eq(palp_network_try(net, depth, dt, &info), PALP_OK);
    ck_assert_int_eq(network_weights(net, weight, &stiffness), PALP_OK);
    double want = (high.force_N - low.force_N) / (2.0 * h);
    ck_assert_msg(fabs(stiffness - want) < 1e-5 * fabs(want), "kind %d, mass %d: %.9g not %.9g N/m", kind,
                  mass, stiffness, want);
    free(weight);
    palp_network_free(net);
}

START_TEST(force_slope_at_an_equilibrium) {
    for (int kind = 0; kind < KINDS; kind++) {
        check_weights(kind, false);
        check_weights(kind, true);
    }
}
END_TEST

START_TEST(weights_are_the_force_per_parameter) {
    /* F(all laws scaled by 1 + h) - F: sum of weight times element force, by the adjoint */
    palp_material m = quartic(0), more = m, less = m;
    const double h = 1e-6;
    palp_network *net = cube_network(3, &m, NULL), *other;
    size_t n = element_count(net);
    double *weight = malloc(n * sizeof *weight), *force = malloc(n * sizeof *force), stiffness, sum = 0.0,
           high;
    ck_assert(weight && force);
    ck_assert_int_eq(palp_network_step(net, 0.2 * HEIGHT, INFINITY, NULL), PALP_OK);
    ck_assert_int_eq(network_weights(net, weight, &stiffness), PALP_OK);
    /* of the second coefficient: dforce = |e| e */
    const double *e = palp_network_element_strain(net);
    for (size_t i = 0; i < n; i++)
        sum += weight[i] * fabs(e[i]) * e[i];
    more.law.coefficients[1] += h;
    less.law.coefficients[1] -= h;
    other = cube_network(3, &more, NULL);
    ck_assert_int_eq(palp_network_step(other, 0.2 * HEIGHT, INFINITY, NULL), PALP_OK);
    high = palp_network_force(other);
    ck_assert_int_eq(palp_network_set_material(other, &less), PALP_OK);
    ck_assert_int_eq(palp_network_step(other, 0.2 * HEIGHT, INFINITY, NULL), PALP_OK);
    double want = (high - palp_network_force(other)) / (2.0 * h);
    ck_assert_double_eq_tol(fabs(sum), fabs(want), 1e-6 * fabs(want));
    free(weight);
    free(force);
    palp_network_free(net);
    palp_network_free(other);
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

/* A lattice of faces only, and a free row of elements, have nothing to hold them sideways. */
START_TEST(mechanisms_are_singular) {
    static const palp_solver solvers[] = {PALP_SOLVER_BAND, PALP_SOLVER_SIMPLICIAL, PALP_SOLVER_AUTO};
    static const double depth[] = {1e-6, 0.01, 0.2, -0.01};
    for (size_t n = 3; n <= 8; n++)
        for (size_t s = 0; s < 3; s++)
            for (int branch = 0; branch < 2; branch++) {
                palp_mesh *mesh = cube(n, PALP_NEIGHBOURS_6);
                palp_material m = quartic(1);
                palp_network_settings settings = palp_network_settings_default();
                settings.solver = solvers[s];
                settings.branch = branch ? PALP_BRANCH_STABLE : PALP_BRANCH_CONTINUE;
                palp_network *net = network_on(mesh, &m, &settings);
                snapshot rest = snapshot_take(net);
                for (size_t i = 0; i < 4; i++) {
                    palp_status status = palp_network_step(net, depth[i] * HEIGHT, 0.1, NULL);
                    ck_assert_msg(status == PALP_ERR_SINGULAR,
                                  "%zu nodes a side, solver %zu, branch %d, depth %g: %s", n, s, branch,
                                  depth[i], palp_status_name(status));
                    ck_assert(still_at(net, &rest));
                }
                snapshot_free(&rest);
                palp_network_free(net);
                palp_mesh_free(mesh);
            }
}
END_TEST

/* ---- what is refused ----------------------------------------------------------------------------- */

static palp_status create_status(const palp_network_settings *settings, const palp_support *supports,
                                 palp_error *error) {
    palp_mesh *mesh = cube(3, PALP_NEIGHBOURS_26);
    palp_material m = quartic(1);
    palp_network *net = NULL;
    palp_support usual[2];
    palp_network_settings plain = palp_network_settings_default();
    palp_supports_default(usual);
    palp_status status = palp_network_create(mesh, &m, 2, supports ? supports : usual,
                                             settings ? settings : &plain, &net, error);
    ck_assert((status == PALP_OK) == (net != NULL));
    palp_network_free(net);
    palp_mesh_free(mesh);
    return status;
}

static void check_refused(const palp_network_settings *settings, size_t n) {
    for (size_t i = 0; i < n; i++) {
        palp_error error = {PALP_OK, ""};
        ck_assert_msg(create_status(&settings[i], NULL, &error) == PALP_ERR_ARGUMENT, "setting %zu is taken",
                      i);
        ck_assert_int_eq(error.status, PALP_ERR_ARGUMENT);
        ck_assert_uint_gt(strlen(error.text), 10);
    }
}

START_TEST(settings_out_of_range) {
    const palp_network_settings plain = palp_network_settings_default();
    static const double bad[] = {-1e-3, NAN, -INFINITY, INFINITY};
    ck_assert_int_eq(create_status(&plain, NULL, NULL), PALP_OK);
    for (size_t i = 0; i < 4; i++) {
        palp_network_settings s[4] = {plain, plain, plain, plain};
        s[0].tolerance = s[1].density_kg_m3 = s[2].spectral_radius = s[3].check_strain = bad[i];
        check_refused(s, bad[i] < INFINITY || isnan(bad[i]) ? 4 : 3); /* never to look is fine */
    }
    palp_network_settings s[6] = {plain, plain, plain, plain, plain, plain};
    s[0].tolerance = 0.0;
    s[1].spectral_radius = 1.1;
    s[2].max_iterations = 0;
    s[3].branch = (palp_branch)2;
    s[4].solver = (palp_solver)4;
    s[5].integrator = (palp_integrator)2;
    check_refused(s, 6);
#ifndef PALP_GPL
    s[0] = plain;
    s[0].solver = PALP_SOLVER_SUPERNODAL;
    ck_assert_int_eq(create_status(&s[0], NULL, NULL), PALP_ERR_UNSUPPORTED);
#endif
}
END_TEST

START_TEST(supports_that_make_no_sense) {
    palp_support s[2];
    palp_error error = {PALP_OK, ""};
    palp_supports_default(s);
    s[1].set = "no such set";
    ck_assert_int_eq(create_status(NULL, s, &error), PALP_ERR_INPUT);
    ck_assert_ptr_nonnull(strstr(error.text, "no such set"));
    palp_supports_default(s);
    s[1].motion[1] = NAN;
    ck_assert_int_eq(create_status(NULL, s, &error), PALP_ERR_ARGUMENT);
    s[1].motion[1] = INFINITY;
    ck_assert_int_eq(create_status(NULL, s, &error), PALP_ERR_ARGUMENT);
}
END_TEST

START_TEST(nothing_need_be_driven) {
    palp_material m = quartic(1);
    palp_mesh *mesh = NULL;
    palp_network *net = NULL;
    palp_support s[2];
    palp_step_info info;
    palp_supports_default(s);
    s[1].axis[1] = PALP_FIXED;
    palp_network_settings settings = palp_network_settings_default();
    ck_assert_int_eq(palp_mesh_lattice((size_t[]){3, 3, 3}, (double[]){0.024, 0.024, 0.024}, PALP_NEIGHBOURS_26, &mesh),
                     PALP_OK);
    ck_assert_int_eq(palp_network_create(mesh, &m, 2, s, &settings, &net, NULL), PALP_OK);
    ck_assert_int_eq(palp_network_step(net, 0.001, 0.1, &info), PALP_OK);
    ck_assert_double_eq(info.force_N, 0.0);
    ck_assert_mem_eq(palp_network_positions(net), palp_mesh_positions(mesh), 81 * sizeof(double));
    ck_assert_int_eq(palp_network_step_force(net, 0.1, 0.1, NULL), PALP_ERR_ARGUMENT);
    palp_network_free(net);
    palp_mesh_free(mesh);
}
END_TEST

START_TEST(steps_that_make_no_sense) {
    static const double bad_depth[] = {NAN, INFINITY, -INFINITY}, bad_dt[] = {-1.0, NAN, -INFINITY};
    palp_material m = quartic(1);
    palp_network *net = cube_network(3, &m, NULL);
    snapshot rest = snapshot_take(net);
    for (size_t i = 0; i < 3; i++) {
        ck_assert_int_eq(palp_network_step(net, bad_depth[i], 0.1, NULL), PALP_ERR_ARGUMENT);
        ck_assert_int_eq(palp_network_step(net, 0.001, bad_dt[i], NULL), PALP_ERR_ARGUMENT);
        ck_assert_int_eq(palp_network_step_force(net, bad_depth[i], 0.1, NULL), PALP_ERR_ARGUMENT);
        ck_assert_int_eq(palp_network_step_force(net, 0.1, bad_dt[i], NULL), PALP_ERR_ARGUMENT);
    }
    double force[3] = {7.0, 7.0, 7.0};
    ck_assert_int_eq(palp_network_reaction(net, "no such set", force), PALP_ERR_INPUT);
    ck_assert_double_eq(force[0], 7.0);
    ck_assert(still_at(net, &rest));
    ck_assert_int_eq(palp_network_step(net, 0.001, 0.0, NULL), PALP_OK); /* springs and arms take a jump */
    ck_assert_double_gt(palp_network_force(net), 0.0);
    ck_assert_double_eq(palp_network_time(net), 0.0);
    snapshot_free(&rest);
    palp_network_free(net);
}
END_TEST

START_TEST(jumps_where_there_is_a_rate) {
    palp_network_settings heavy = palp_network_settings_default();
    heavy.density_kg_m3 = 1000.0;
    palp_material dashpot = quartic(0), sedef = sedef2008(), plain = quartic(1);
    dashpot.dashpot_Ns = 0.1;
    palp_network *nets[] = {cube_network(3, &dashpot, NULL), cube_network(3, &sedef, NULL),
                            cube_network(3, &plain, &heavy)};
    for (size_t k = 0; k < 3; k++) {
        ck_assert_int_eq(palp_network_step(nets[k], 0.001, 0.0, NULL), PALP_ERR_ARGUMENT);
        ck_assert_int_eq(palp_network_step_force(nets[k], 0.1, 0.0, NULL), PALP_ERR_ARGUMENT);
        ck_assert_int_eq(palp_network_step(nets[k], 0.001, INFINITY, NULL), PALP_OK);
        palp_network_free(nets[k]);
    }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, figures_of_other_solvers);
    tcase_add_test(tc, one_long_step_finds_the_same_equilibrium);
    tcase_add_test(tc, buckling_is_found_where_it_is);
    tcase_add_test(tc, stable_branch_is_the_other_one);
    tcase_add_test(tc, jacobian_is_the_derivative_of_the_residual);
    tcase_add_test(tc, force_slope_at_an_equilibrium);
    tcase_add_test(tc, weights_are_the_force_per_parameter);
    tcase_add_test(tc, rigid_motion_gives_no_force);
    tcase_add_test(tc, forces_turn_with_the_network);
    tcase_add_test(tc, column_agrees_with_the_lumped_solid);
    tcase_add_test(tc, reactions_balance);
    tcase_add_test(tc, reactions_balance_where_it_buckled);
    tcase_add_test(tc, solvers_agree);
    tcase_add_test(tc, eighteen_neighbours);
    tcase_add_test(tc, mechanisms_are_singular);
    tcase_add_test(tc, settings_out_of_range);
    tcase_add_test(tc, supports_that_make_no_sense);
    tcase_add_test(tc, nothing_need_be_driven);
    tcase_add_test(tc, steps_that_make_no_sense);
    tcase_add_test(tc, jumps_where_there_is_a_rate);
}
