/* test_relaxation_parameters.c: what the relaxation stage fits, its bounds, and a material by its parameters.
 */
#include "fit/relaxation_parameters.h"

#include <check.h>
#include <math.h>

/* Relaxation times of 0.5 s and 20 s. */
static palp_material two_arms(void) {
    palp_material m = {.n_arms = 2, .arms = {{0.4, 0.2, 1.5, 0.5}, {0.1, 2.0, 2.5, 0.75}}};
    ck_assert_int_eq(palp_law_polynomial(2, (double[]){3.0, 5.0}, &m.law), PALP_OK);
    return m;
}

static size_t list_of(const palp_material *m, bool scale, bool dependence, bool one,
                      relaxation_parameter *list) {
    palp_relaxation_settings settings = palp_relaxation_settings_default();
    settings.fit_scale = scale;
    settings.fit_beta = settings.fit_gamma = dependence;
    settings.one_beta = one;
    return relaxation_list(m, &settings, list);
}

START_TEST(first_guess_is_the_start) {
    static const double wanted[2][9] = {
        {1.0, 0.4, -0.69314718055994531, 0.1, 2.9957322735539909, 1.5, 0.5},
        {1.0, 0.4, -0.69314718055994531, 0.1, 2.9957322735539909, 1.5, 0.5, 2.5, 0.75}};
    palp_material start = two_arms(), same;
    relaxation_parameter list[RELAXATION_PARAMETERS_MAX];
    double p[RELAXATION_PARAMETERS_MAX];
    size_t n = list_of(&start, true, true, _i == 0, list);
    ck_assert_uint_eq(n, _i == 0 ? 7 : 9);
    relaxation_first_guess(n, list, &start, p);
    for (size_t k = 0; k < n; k++)
        ck_assert_double_eq_tol(p[k], wanted[_i][k], 1e-15);
    ck_assert_uint_eq(list[n - 1].first, _i == 0 ? 0 : 1);
    ck_assert_uint_eq(list[n - 1].last, 1);
    if (_i == 1) {
        ck_assert_int_eq(relaxation_material(n, list, &start, p, &same), PALP_OK);
        for (size_t j = 0; j < 2; j++) {
            ck_assert_double_eq(same.arms[j].stiffness_N, start.arms[j].stiffness_N);
            ck_assert_double_eq_tol(same.arms[j].viscosity_Ns, start.arms[j].viscosity_Ns, 1e-14);
            ck_assert_double_eq(same.arms[j].beta, start.arms[j].beta);
            ck_assert_double_eq(same.arms[j].gamma, start.arms[j].gamma);
        }
    }
}
END_TEST

/* One beta stands in both arms; a stiffness keeps the arm's time, a time its stiffness. */
START_TEST(material_of_parameters) {
    palp_material start = two_arms(), m;
    relaxation_parameter list[RELAXATION_PARAMETERS_MAX];
    double p[] = {2.0, 0.8, log(0.5), 0.1, log(30.0), 4.0, 3.0};
    size_t n = list_of(&start, true, true, true, list);
    ck_assert_uint_eq(n, 7);
    ck_assert_int_eq(relaxation_material(n, list, &start, p, &m), PALP_OK);
    ck_assert_double_eq(m.law.coefficients[0], 6.0);
    ck_assert_double_eq(m.law.coefficients[1], 10.0);
    ck_assert_double_eq(m.arms[0].stiffness_N, 0.8);
    ck_assert_double_eq_tol(m.arms[0].viscosity_Ns, 0.4, 1e-14);
    ck_assert_double_eq(m.arms[1].stiffness_N, 0.1);
    ck_assert_double_eq_tol(m.arms[1].viscosity_Ns, 3.0, 1e-13);
    for (size_t j = 0; j < 2; j++) {
        ck_assert_double_eq(m.arms[j].beta, 4.0);
        ck_assert_double_eq(m.arms[j].gamma, 3.0);
    }
    p[0] = 0.0;
    ck_assert_int_eq(relaxation_material(n, list, &start, p, &m), PALP_ERR_ARGUMENT);
}
END_TEST

/* Times between 1e-5 and 1e2 of the longest record, and wherever the start is. */
START_TEST(bounds_of_parameters) {
    enum { N = 7, ROWS = 9 };
    static const size_t column[ROWS] = {0, 1, 2, 2, 3, 4, 4, 5, 6};
    static const double sign[ROWS] = {1, 1, 1, -1, 1, 1, -1, 1, 1};
    const double longest[2] = {10.0, 0.01}, late[2] = {1000.0, 20.0};
    palp_material start = two_arms();
    relaxation_parameter list[RELAXATION_PARAMETERS_MAX];
    double row[2 * N * N], floor[2 * N];
    const double wanted[ROWS] = {0.05,
                                 0.4e-6,
                                 log(1e-5 * longest[_i]),
                                 -log(_i ? 1.0 : 1000.0),
                                 0.1e-6,
                                 log(1e-5 * longest[_i]),
                                 -log(late[_i]),
                                 0.0,
                                 0.0};
    ck_assert_uint_eq(list_of(&start, true, true, true, list), N);
    ck_assert_uint_eq(relaxation_bounds(N, list, &start, longest[_i], row, floor), ROWS);
    for (size_t r = 0; r < ROWS; r++) {
        ck_assert_double_eq_tol(floor[r], wanted[r], 1e-14);
        for (size_t k = 0; k < N; k++)
            ck_assert_double_eq(row[r * N + k], k == column[r] ? sign[r] : 0.0);
    }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, first_guess_is_the_start, 0, 2);
    tcase_add_test(tc, material_of_parameters);
    tcase_add_loop_test(tc, bounds_of_parameters, 0, 2);
}
