/* test_network_derivatives.c: derivatives of a network against finite differences. */
#include "network_settle.h"

#include <stdio.h>

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

void tests(TCase *tc) {
    tcase_add_test(tc, jacobian_is_the_derivative_of_the_residual);
    tcase_add_test(tc, force_slope_at_an_equilibrium);
    tcase_add_test(tc, weights_are_the_force_per_parameter);
}
