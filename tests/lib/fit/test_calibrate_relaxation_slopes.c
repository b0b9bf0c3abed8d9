/* test_calibrate_relaxation_slopes.c: derivatives of a relaxation by the parameters of the arms, against
 * differences. */
#include "relaxation_make.h"

#include <stdlib.h>
#include <string.h>

typedef enum change { BY_SCALE, BY_STIFFNESS, BY_TIME, BY_BETA, BY_GAMMA } change;

/* The material with one of its numbers moved by h, in the arms from first to last. */
static palp_material moved(const palp_material *like, change what, size_t first, size_t last, double h) {
    palp_material material = *like;
    if (what == BY_SCALE)
        ck_assert_int_eq(palp_law_scale(&like->law, 1.0 + h, &material.law), PALP_OK);
    for (size_t j = first; j <= last && what != BY_SCALE; j++) {
        palp_arm *arm = &material.arms[j];
        double time = arm->viscosity_Ns / arm->stiffness_N * (what == BY_TIME ? exp(h) : 1.0);
        arm->stiffness_N += what == BY_STIFFNESS ? h * like->arms[j].stiffness_N : 0.0;
        arm->viscosity_Ns = time * arm->stiffness_N;
        arm->beta += what == BY_BETA ? h : 0.0;
        arm->gamma += what == BY_GAMMA ? h : 0.0;
    }
    return material;
}

typedef struct comparison {
    palp_network *network;
    const palp_material *material;
    const palp_target *targets;
    const palp_relaxation_settings *settings;
    size_t n; /* samples of all targets */
    double jacobian[MOST_COLUMNS * 2 * SAMPLES];
} comparison;

static void check_column(comparison *c, size_t column, change what, size_t first, size_t last) {
    const double h = 1e-4;
    double r[2][2 * SAMPLES], largest = 0.0;
    size_t n;
    for (int side = 0; side < 2; side++) {
        palp_material m = moved(c->material, what, first, last, side ? h : -h);
        ck_assert_int_eq(relaxation_linearize(c->network, &m, 2, c->targets, c->settings, &n, r[side], NULL),
                         PALP_OK);
    }
    double *derivative = c->jacobian + column * c->n;
    for (size_t i = 0; i < c->n && what == BY_STIFFNESS; i++)
        derivative[i] *= c->material->arms[first].stiffness_N; /* as h does */
    for (size_t i = 0; i < c->n; i++)
        largest = fmax(largest, fabs(derivative[i]));
    ck_assert_double_gt(largest, 1e-4); /* N: the parameter does something */
    for (size_t i = 0; i < c->n; i++)
        ck_assert_double_eq_tol(derivative[i], (r[1][i] - r[0][i]) / (2.0 * h), 1e-6 * largest);
}

/* Central differences with 1e-4: 1e-8 of truncation, 1e-12 / 1e-4 of rounding. */
static void check_derivatives_on(palp_network *network, const palp_material *material, bool beta, bool gamma,
                                 bool shared, double dt_s) {
    static comparison c;
    records r;
    records_make(&r, 1.0);
    palp_relaxation_settings settings = palp_relaxation_settings_default();
    settings.fit_beta = beta;
    settings.fit_gamma = gamma;
    settings.one_beta = shared;
    settings.dt_s = dt_s;
    settings.tolerance = 1e-3;
    palp_target targets[2] = {r.target[1], r.target[11]};
    if (dt_s > 0.0) /* not as far as 200 s with fixed steps */
        targets[0].n = targets[1].n = 20;
    double residual[2 * SAMPLES];
    size_t n, column = 0, arms = material->n_arms;
    memset(r.force_N, 0, sizeof r.force_N);
    c = (comparison){.network = network,
                     .material = material,
                     .targets = targets,
                     .settings = &settings,
                     .n = targets[0].n + targets[1].n};
    ck_assert_int_eq(
        relaxation_linearize(c.network, material, 2, targets, &settings, &n, residual, c.jacobian), PALP_OK);
    ck_assert_uint_eq(n, 1 + 2 * arms + (beta + gamma) * (shared ? 1 : arms));
    check_column(&c, column++, BY_SCALE, 0, 0);
    for (size_t j = 0; j < arms; j++) {
        check_column(&c, column++, BY_STIFFNESS, j, j);
        check_column(&c, column++, BY_TIME, j, j);
    }
    for (size_t j = 0; j < (shared ? 1 : arms); j++) {
        size_t last = shared ? arms - 1 : j;
        if (beta)
            check_column(&c, column++, BY_BETA, j, last);
        if (gamma)
            check_column(&c, column++, BY_GAMMA, j, last);
    }
    ck_assert_uint_eq(column, n);
    palp_network_free(c.network);
    records_free(&r);
}

static void check_derivatives(const palp_material *material, bool beta, bool gamma, bool shared,
                              double dt_s) {
    check_derivatives_on(network_of(material), material, beta, gamma, shared, dt_s);
}

START_TEST(derivatives_of_scaled_elements) {
    palp_material material = network_n2();
    palp_network *network = network_of(&material);
    network->scale = arena_take(&network->memory, network->n_elements, sizeof *network->scale);
    ck_assert_ptr_nonnull(network->scale);
    for (size_t i = 0; i < network->n_elements; i++)
        network->scale[i] = 0.5 + (double)(i * 7 % 11) / 11.0;
    check_derivatives_on(network, &material, false, false, true, 0.0);
}
END_TEST

/* The modulus that holds Poisson's ratio goes with the scale of the law. */
START_TEST(derivatives_with_poissons_ratio) {
    palp_material material = network_n2();
    palp_network_settings settings = palp_network_settings_default();
    settings.tolerance = 1e-12;
    settings.poisson_ratio = 0.4;
    check_derivatives_on(cube_network(3, &material, &settings), &material, false, false, true, 0.0);
}
END_TEST

START_TEST(derivatives_of_constant_arms) {
    palp_material material = network_n2();
    check_derivatives(&material, false, false, true, 0.0);
    check_derivatives(&material, false, false, true, 0.04);
}
END_TEST

START_TEST(derivatives_by_strain_dependence) {
    palp_material material = network_n2();
    material.arms[0].beta = material.arms[1].beta = 3.0;
    material.arms[0].gamma = material.arms[1].gamma = 1.5;
    check_derivatives(&material, true, true, true, 0.0);
    material.arms[1].beta = 1.0;
    material.arms[1].gamma = 0.5;
    check_derivatives(&material, true, true, false, 0.0);
    material.arms[0].beta = material.arms[0].gamma = material.arms[1].beta = material.arms[1].gamma = 0.0;
    check_derivatives(&material, true, false, false, 0.0);
    check_derivatives(&material, false, true, true, 0.0);
}
END_TEST

START_TEST(derivatives_of_quasi_linear_arms) {
    palp_material material = network_n2();
    material.quasi_linear = true;
    check_derivatives(&material, false, false, true, 0.0);
    material.arms[0].gamma = material.arms[1].gamma = 1.0;
    check_derivatives(&material, false, true, true, 0.0);
}
END_TEST

START_TEST(derivatives_with_a_dashpot) {
    palp_material material = network_n2();
    material.dashpot_Ns = 0.05;
    check_derivatives(&material, false, false, true, 0.0);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, derivatives_with_poissons_ratio);
    tcase_add_test(tc, derivatives_of_constant_arms);
    tcase_add_test(tc, derivatives_of_scaled_elements);
    tcase_add_test(tc, derivatives_by_strain_dependence);
    tcase_add_test(tc, derivatives_of_quasi_linear_arms);
    tcase_add_test(tc, derivatives_with_a_dashpot);
}
