/* test_law_range.c: a law beyond the strain it was measured to: its tangent goes on, in every path that
 * evaluates it. */
#include "law_make.h"
#include "material/law_internal.h"

#include <palpate/material.h>

#include <string.h>

enum { END_PERCENT = 27 };

static palp_law limited(int i) {
    palp_law law = sample_law(i);
    ck_assert_int_eq(palp_law_limit(&law, 0.01 * END_PERCENT), PALP_OK);
    return law;
}

/* Fourth-order central difference. */
static double derivative(double (*f)(const palp_law *, double), const palp_law *law, double x, double h) {
    return (8.0 * (f(law, x + h) - f(law, x - h)) - (f(law, x + 2 * h) - f(law, x - 2 * h))) / (12.0 * h);
}

START_TEST(within_its_range_a_law_is_the_same_to_the_bit) {
    enum { N = 101 };
    palp_law free_law = sample_law(_i), law = limited(_i);
    double e[N], f[2][N], t[2][N], w[2][N], g[2][PALP_LAW_MAX];
    for (int i = 0; i < N; i++)
        e[i] = law.strain_max * (i - 50) / 50;
    palp_law_force(&law, N, e, f[0], t[0], w[0]);
    palp_law_force(&free_law, N, e, f[1], t[1], w[1]);
    ck_assert_mem_eq(f[0], f[1], sizeof f[0]);
    ck_assert_mem_eq(t[0], t[1], sizeof t[0]);
    ck_assert_mem_eq(w[0], w[1], sizeof w[0]);
    for (int i = 0; i < N; i++) {
        palp_law_gradient(&law, e[i], g[0]);
        palp_law_gradient(&free_law, e[i], g[1]);
        ck_assert_mem_eq(g[0], g[1], law.n * sizeof *g[0]);
        ck_assert_double_eq(palp_law_beyond(&law, e[i]), 0.0);
    }
}
END_TEST

START_TEST(force_and_tangent_are_continuous_and_rise_beyond) {
    palp_law law = limited(_i);
    double end = law.strain_max, last = 0.0, e[2] = {end * (1 - 1e-9), end * (1 + 1e-9)}, f[2], t[2], w[2];
    palp_law_force(&law, 2, e, f, t, w);
    CLOSE(f[1], f[0], 1e-7);
    CLOSE(t[1], t[0], 1e-6);
    CLOSE(w[1], w[0], 1e-7);
    for (int i = 0; i <= 400; i++) {
        double at = end + 0.005 * i, force = force_at(&law, at);
        ck_assert_msg(force > last && isfinite(force), "strain %g: %g N after %g N", at, force, last);
        CLOSE(force_at(&law, -at), -force, 1e-15);
        ck_assert_double_gt(stiffness_at(&law, at), 0.0);
        last = force;
    }
    CLOSE(palp_law_beyond(&law, -end - 0.25), 0.25, 1e-12);
}
END_TEST

START_TEST(derivatives_beyond_meet_finite_differences) {
    static const double beyond[] = {1e-3, 0.01, 0.2, 0.6, 0.9};
    palp_law law = limited(_i);
    for (int i = 0; i < 10; i++) {
        double a = law.strain_max + beyond[i / 2], e = i % 2 ? -a : a, h = fmin(2e-4, 0.2 * beyond[i / 2]), f,
               t, w, k, slope;
        palp_law_force(&law, 1, &e, &f, &t, &w);
        palp_law_stiffness(&law, e, &k, &slope);
        ck_assert_double_le(fabs(t - derivative(force_at, &law, e, h)), 1e-9 * k);
        ck_assert_double_le(fabs(f - derivative(energy_at, &law, e, h)), 1e-9 * k);
        ck_assert_double_le(fabs(slope * (e < 0 ? -1 : 1) - derivative(stiffness_at, &law, e, h)), 1e-7 * k);
        CLOSE(f, k * e, 1e-14);
        CLOSE(t, k + a * slope, 1e-12);
    }
}
END_TEST

/* Central differences that straddle the end: the tangent is continuous, so they meet it to the size of their
 * step. */
START_TEST(the_tangent_holds_across_the_end) {
    palp_law law = limited(_i);
    for (int i = -4; i <= 4; i++) {
        double h = 1e-5, e = law.strain_max + 0.25 * i * h, f, t;
        palp_law_force(&law, 1, &e, &f, &t, NULL);
        double want = (force_at(&law, e + h) - force_at(&law, e - h)) / (2 * h);
        ck_assert_double_le(fabs(t - want),
                            1e-3 * stiffness_at(&law, e)); /* F'' h of these laws is below 1e-3 K */
    }
}
END_TEST

/* Of a law's value at e by coefficient j. */
static double by_coefficient(double (*f)(const palp_law *, double), const palp_law *law, double e, size_t j) {
    double h = 4e-4 * fabs(law->coefficients[j]), at[4];
    for (int s = 0; s < 4; s++) {
        palp_law moved = *law;
        double c[PALP_LAW_MAX];
        memcpy(c, law->coefficients, sizeof c);
        c[j] += h * (double[]){-2.0, -1.0, 1.0, 2.0}[s];
        ck_assert_int_eq(palp_law_set_coefficients(&moved, c), PALP_OK);
        ck_assert_double_eq(moved.strain_max, law->strain_max);
        at[s] = f(&moved, e);
    }
    return (8.0 * (at[2] - at[1]) - (at[3] - at[0])) / (12.0 * h);
}

START_TEST(gradients_by_coefficients_beyond_meet_finite_differences) {
    palp_law law = limited(_i);
    for (int i = 0; i < 4; i++) {
        double e = (i % 2 ? -1.0 : 1.0) * (law.strain_max + 0.01 + 0.3 * (i / 2)), g[PALP_LAW_MAX];
        double k = stiffness_at(&law, e);
        palp_law_gradient(&law, e, g);
        for (size_t j = 0; j < law.n; j++)
            ck_assert_double_le(fabs(g[j] - by_coefficient(force_at, &law, e, j)),
                                1e-8 * fabs(k * e / law.coefficients[j]));
    }
}
END_TEST

START_TEST(gradients_of_the_energy_meet_finite_differences) {
    palp_law law = limited(_i);
    const double part[] = {0.05, -0.4, 0.97, 1.3, -2.5};
    for (size_t i = 0; i < sizeof part / sizeof *part; i++) {
        double e = part[i] * law.strain_max, g[PALP_LAW_MAX], energy = energy_at(&law, e);
        law_energy_gradient(&law, e, g);
        for (size_t j = 0; j < law.n; j++)
            ck_assert_double_le(fabs(g[j] - by_coefficient(energy_at, &law, e, j)),
                                1e-8 * fabs(energy / law.coefficients[j]));
    }
}
END_TEST

START_TEST(arrays_across_the_end_agree_with_single_calls) {
    enum { N = 91 };
    palp_law law = limited(_i);
    double e[N], f[N], t[N], w[N];
    for (int i = 0; i < N; i++)
        e[i] = -1.4 + 0.031 * i;
    palp_law_force(&law, N, e, f, t, w);
    for (int i = 0; i < N; i++) {
        double one, tangent, energy;
        palp_law_force(&law, 1, &e[i], &one, &tangent, &energy);
        CLOSE(f[i], one, 1e-15);
        CLOSE(t[i], tangent, 1e-14);
        CLOSE(w[i], energy, 1e-15);
    }
}
END_TEST

/* Forces a million times smaller, as lengths in other units make them: the same numbers, scaled. */
START_TEST(scale_changes_nothing) {
    palp_law law = limited(_i), small;
    ck_assert_int_eq(palp_law_scale(&law, 1e-6, &small), PALP_OK);
    ck_assert_double_eq(small.strain_max, law.strain_max);
    ck_assert_int_eq(palp_law_limit(&small, law.strain_max), PALP_OK);
    ck_assert_double_eq(small.strain_max, law.strain_max);
    for (int i = 1; i < 30; i++)
        CLOSE(force_at(&small, 0.05 * i), 1e-6 * force_at(&law, 0.05 * i), 1e-12);
}
END_TEST

/* One element's step with arms, driven by strain or by the elastic force, in both formulations. */
START_TEST(elements_have_the_tangent_of_their_force_across_the_end) {
    static const palp_arm arms[2] = {{3.0, 0.6, 0.5, 0.0}, {1.0, 4.0, 0.2, 0.7}};
    palp_material m = {.law = limited(0), .n_arms = 2, .arms = {arms[0], arms[1]}};
    if (_i == 1)
        m = (palp_material){
            .law = limited(3), .n_arms = 1, .arms = {{3.0, 0.6, 0.0, 0.5}}, .quasi_linear = true};
    if (_i == 2)
        m = (palp_material){
            .law = limited(9), .n_arms = 1, .arms = {{3.0, 0.6, 0.0, 0.0}}, .formulation = PALP_SEDEF2008};
    palp_element_state start = {0}, low, high, mid;
    ck_assert_int_eq(palp_element_advance(&m, &start, 0.2, 0.1, &start, NULL), PALP_OK);
    for (int i = -3; i <= 6; i++) {
        double h = 1e-6, e = m.law.strain_max + (i < 2 ? 0.5 * i * h : 0.05 * i), tangent;
        ck_assert_int_eq(palp_element_advance(&m, &start, e, 0.05, &mid, &tangent), PALP_OK);
        ck_assert_int_eq(palp_element_advance(&m, &start, e - h, 0.05, &low, NULL), PALP_OK);
        ck_assert_int_eq(palp_element_advance(&m, &start, e + h, 0.05, &high, NULL), PALP_OK);
        CLOSE(tangent, (high.force_N - low.force_N) / (2 * h), 2e-5);
    }
}
END_TEST

START_TEST(a_force_that_falls_ends_the_range_before) {
    static const double falls[3] = {10.0, 0.0, -100.0}; /* F = 10 a - 100 a^3 rises to a = 0.1826 */
    static const double never[2] = {-1.0, 0.0};
    palp_law law, before;
    ck_assert_int_eq(palp_law_polynomial(3, falls, &law), PALP_OK);
    ck_assert_int_eq(palp_law_limit(&law, 0.25), PALP_OK);
    ck_assert_double_lt(law.strain_max, 0.1826);
    ck_assert_double_gt(law.strain_max, 0.178);
    ck_assert_double_gt(force_at(&law, 0.9), force_at(&law, 0.2));
    before = law;
    ck_assert_int_eq(palp_law_limit(&law, -0.1), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_law_limit(&law, NAN), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_law_limit(&law, INFINITY), PALP_ERR_ARGUMENT);
    ck_assert_mem_eq(&law, &before, sizeof law);
    ck_assert_int_eq(palp_law_limit(&law, 0.0), PALP_OK); /* lifted */
    ck_assert_double_lt(force_at(&law, 0.9), 0.0);
    ck_assert_double_eq(palp_law_beyond(&law, 0.9), 0.0);
    ck_assert_int_eq(palp_law_polynomial(2, never, &law), PALP_OK);
    ck_assert_int_eq(palp_law_limit(&law, 0.25), PALP_ERR_ARGUMENT);
    palp_material m = {.law = limited(0)};
    m.law.strain_max = NAN;
    ck_assert_int_eq(palp_material_check(&m, NULL), PALP_ERR_ARGUMENT);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, within_its_range_a_law_is_the_same_to_the_bit, 0, SAMPLE_LAWS);
    tcase_add_loop_test(tc, force_and_tangent_are_continuous_and_rise_beyond, 0, SAMPLE_LAWS);
    tcase_add_loop_test(tc, derivatives_beyond_meet_finite_differences, 0, SAMPLE_LAWS);
    tcase_add_loop_test(tc, the_tangent_holds_across_the_end, 0, SAMPLE_LAWS);
    tcase_add_loop_test(tc, gradients_by_coefficients_beyond_meet_finite_differences, 0, SAMPLE_LAWS);
    tcase_add_loop_test(tc, gradients_of_the_energy_meet_finite_differences, 0, SAMPLE_LAWS);
    tcase_add_loop_test(tc, arrays_across_the_end_agree_with_single_calls, 0, SAMPLE_LAWS);
    tcase_add_loop_test(tc, scale_changes_nothing, 0, SAMPLE_LAWS);
    tcase_add_loop_test(tc, elements_have_the_tangent_of_their_force_across_the_end, 0, 3);
    tcase_add_test(tc, a_force_that_falls_ends_the_range_before);
}
