/* test_law.c: stiffness laws against closed forms, finite differences and each other. */
#include "law_make.h"

static palp_law remake(const palp_law *like, const double *c) {
    palp_law law;
    palp_status status;
    if (like->kind == PALP_LAW_POLYNOMIAL)
        status = palp_law_polynomial(like->n, c, &law);
    else if (like->kind == PALP_LAW_SPLINE)
        status = palp_law_spline(like->n, like->strain, c, &law);
    else
        status = palp_law_hyperelastic(like->kind, like->n, c, like->area_m2, &law);
    ck_assert_int_eq(status, PALP_OK);
    return law;
}

/* Fourth-order central difference. */
static double derivative(double (*f)(const palp_law *, double), const palp_law *law, double x, double h) {
    return (8.0 * (f(law, x + h) - f(law, x - h)) - (f(law, x + 2 * h) - f(law, x - 2 * h))) / (12.0 * h);
}

/* Away from the spline's knots by 2 h, both signs, near 0 and past the last knot. */
static const double strains[] = {0.002, 0.011, 0.031, 0.08, 0.12, 0.17, 0.25, 0.333, 0.36, 0.45};
enum { STRAINS = sizeof strains / sizeof strains[0] };

START_TEST(law_derivatives_meet_finite_differences) {
    palp_law law = sample_law(_i);
    for (int i = 0; i < 2 * STRAINS; i++) {
        double e = i % 2 ? -strains[i / 2] : strains[i / 2], h = fmin(4e-4, 0.2 * fabs(e));
        double f, t, w, k, slope;
        palp_law_force(&law, 1, &e, &f, &t, &w);
        palp_law_stiffness(&law, e, &k, &slope);
        /* truncation h^4 f(5) / 30 and rounding 1e-16 f / h are both below 1e-9 of the tangent */
        ck_assert_double_le(fabs(t - derivative(force_at, &law, e, h)), 1e-9 * k);
        ck_assert_double_le(fabs(f - derivative(energy_at, &law, e, h)), 1e-9 * k);
        ck_assert_double_le(fabs(slope * (e < 0 ? -1 : 1) - derivative(stiffness_at, &law, e, h)), 1e-7 * k);
        CLOSE(f, k * e, 1e-14);
        CLOSE(t, k + fabs(e) * slope, 1e-13);
    }
}
END_TEST

START_TEST(coefficient_gradient_meets_finite_differences) {
    palp_law law = sample_law(_i);
    for (int i = 0; i < 2 * STRAINS; i++) {
        double e = i % 2 ? -strains[i / 2] : strains[i / 2], g[PALP_LAW_MAX], k = stiffness_at(&law, e);
        palp_law_gradient(&law, e, g);
        for (size_t j = 0; j < law.n; j++) {
            double h = 4e-4 * fabs(law.coefficients[j]), f[4];
            for (int s = 0; s < 4; s++) {
                palp_law moved = law;
                moved.coefficients[j] += h * (double[]){-2.0, -1.0, 1.0, 2.0}[s];
                moved = remake(&law, moved.coefficients);
                f[s] = force_at(&moved, e);
            }
            double want = (8.0 * (f[2] - f[1]) - (f[3] - f[0])) / (12.0 * h);
            ck_assert_double_le(fabs(g[j] - want), 1e-8 * fabs(k * e / law.coefficients[j]));
        }
    }
}
END_TEST

START_TEST(force_is_odd_and_its_tangent_at_zero_is_the_stiffness) {
    palp_law law = sample_law(_i);
    double e[3] = {0.0, 0.21, -0.21}, f[3], t[3], w[3];
    palp_law_force(&law, 3, e, f, t, w);
    ck_assert_double_eq(f[0], 0.0);
    ck_assert_double_eq(w[0], 0.0);
    CLOSE(t[0], stiffness_at(&law, 0.0), 1e-15);
    CLOSE(t[0], force_at(&law, 1e-12) / 1e-12, 1e-10);
    ck_assert_double_gt(f[1], 0.0);
    ck_assert_double_eq(f[2], -f[1]);
    ck_assert_double_eq(t[2], t[1]);
    ck_assert_double_eq(w[2], w[1]);
}
END_TEST

START_TEST(array_and_single_calls_agree) {
    enum { N = 131 };
    palp_law law = sample_law(_i);
    double e[N], f[N], only[N], t[N], w[N];
    for (int i = 0; i < N; i++)
        e[i] = -0.5 + 0.0077 * i;
    palp_law_force(&law, N, e, f, t, w);
    palp_law_force(&law, N, e, only, NULL, NULL);
    for (int i = 0; i < N; i++) {
        CLOSE(f[i], force_at(&law, e[i]), 1e-15);
        CLOSE(only[i], f[i], 1e-15);
        CLOSE(w[i], energy_at(&law, e[i]), 1e-15);
    }
}
END_TEST

START_TEST(scaled_law_scales_the_force) {
    palp_law law = sample_law(_i), scaled;
    ck_assert_int_eq(palp_law_scale(&law, 1.7, &scaled), PALP_OK);
    for (int i = 0; i < STRAINS; i++)
        CLOSE(force_at(&scaled, strains[i]), 1.7 * force_at(&law, strains[i]), 1e-13);
    scaled = law;
    ck_assert_int_eq(palp_law_scale(&scaled, 0.3, &scaled), PALP_OK); /* in place */
    CLOSE(force_at(&scaled, 0.3), 0.3 * force_at(&law, 0.3), 1e-13);
    ck_assert_int_eq(palp_law_scale(&law, INFINITY, &scaled), PALP_ERR_ARGUMENT);
}
END_TEST

START_TEST(other_coefficients_make_the_same_kind_of_law) {
    palp_law law = sample_law(_i), other = sample_law(_i), scaled;
    double c[PALP_LAW_MAX] = {NAN};
    ck_assert_int_eq(palp_law_scale(&law, 1.7, &scaled), PALP_OK);
    ck_assert_int_eq(palp_law_set_coefficients(&other, scaled.coefficients), PALP_OK);
    ck_assert_mem_eq(&other, &scaled, sizeof other);
    ck_assert_int_eq(palp_law_set_coefficients(&other, c), PALP_ERR_ARGUMENT);
    ck_assert_mem_eq(&other, &scaled, sizeof other);
}
END_TEST

/* K(0.25) = 146.89/256 - 131.36/64 + 47.47/16 - 0.70/4 + 8.18, likewise at 0.1, by hand. */
START_TEST(polynomial_is_eq43) {
    palp_law law = polynomial43();
    double e = -0.25, k, slope, f, t, w;
    palp_law_stiffness(&law, e, &k, &slope);
    CLOSE(k, 9.4931640625, 1e-14);
    CLOSE(slope, -0.70 + 2 * 47.47 / 4 - 3 * 131.36 / 16 + 4 * 146.89 / 64, 1e-14);
    palp_law_force(&law, 1, &e, &f, &t, &w);
    CLOSE(f, -2.373291015625, 1e-14);
    CLOSE(t, 9.4931640625 + 0.25 * slope, 1e-14);
    CLOSE(w, 8.18 / 32 - 0.70 / 192 + 47.47 / 1024 - 131.36 / 5120 + 146.89 / 24576, 1e-14);
    CLOSE(stiffness_at(&law, 0.1), 8.468029, 1e-14);
}
END_TEST

START_TEST(spline_slopes_are_fritsch_butland) {
    /* secants 10 and 30 over h = 0.1 and 0.2: 1/(5/9/10 + 4/9/30) inside, three-point at the ends */
    static const double x[3] = {0.0, 0.1, 0.3}, y[3] = {1.0, 2.0, 8.0};
    palp_law law;
    ck_assert_int_eq(palp_law_spline(3, x, y, &law), PALP_OK);
    CLOSE(law.slope[0], 10.0 / 3.0, 1e-13);
    CLOSE(law.slope[1], 270.0 / 19.0, 1e-13);
    CLOSE(law.slope[2], 130.0 / 3.0, 1e-13);
    /* Hermite's middle of the first interval: (y0 + y1) / 2 + h (d0 - d1) / 8 */
    CLOSE(stiffness_at(&law, 0.05), 1.5 + 0.1 * (10.0 / 3.0 - 270.0 / 19.0) / 8.0, 1e-13);
    CLOSE(stiffness_at(&law, 0.5), 8.0 + 0.2 * 130.0 / 3.0, 1e-13); /* straight beyond the end */
    /* end slope of the wrong sign is 0, one too steep is three secants */
    static const double y_flat[3] = {1.0, 1.1, 8.0}, y_cap[3] = {1.0, 2.0, 0.5};
    static const double x_cap[3] = {0.0, 0.2, 0.22};
    ck_assert_int_eq(palp_law_spline(3, x, y_flat, &law), PALP_OK);
    ck_assert_double_eq(law.slope[0], 0.0);
    ck_assert_int_eq(palp_law_spline(3, x_cap, y_cap, &law), PALP_OK);
    CLOSE(law.slope[0], 3.0 * 5.0, 1e-13);
    ck_assert_double_eq(law.slope[1], 0.0);
}
END_TEST

START_TEST(spline_of_two_knots_is_a_line) {
    static const double x[2] = {0.0, 0.4}, y[2] = {5.0, 9.0}, line[2] = {5.0, 10.0};
    palp_law law, straight;
    ck_assert_int_eq(palp_law_spline(2, x, y, &law), PALP_OK);
    ck_assert_int_eq(palp_law_polynomial(2, line, &straight), PALP_OK);
    for (int i = 0; i < STRAINS; i++) {
        CLOSE(force_at(&law, strains[i]), force_at(&straight, strains[i]), 1e-14);
        CLOSE(energy_at(&law, strains[i]), energy_at(&straight, strains[i]), 1e-14);
    }
}
END_TEST

START_TEST(spline_interpolates_and_is_smooth_at_knots) {
    palp_law law = spline();
    for (int i = 0; i < 6; i++) {
        double k, slope, left, right, x = knots[i], d = 1e-9;
        palp_law_stiffness(&law, x, &k, &slope);
        CLOSE(k, knot_stiffness[i], 1e-15);
        palp_law_stiffness(&law, x - d, &k, &left);
        palp_law_stiffness(&law, x + d, &k, &right);
        if (i > 0)                                         /* at 0 the law is mirrored: |e| */
            ck_assert_double_le(fabs(left - right), 1e-5); /* second derivatives are below 1e3 */
        ck_assert_double_le(fabs(slope - right), 1e-5);
        CLOSE(energy_at(&law, x + d) - energy_at(&law, fabs(x - d)), i ? 2 * d * x * k : 0.0, 1e-5);
    }
}
END_TEST

START_TEST(monotone_data_give_a_monotone_law) {
    static const double x[7] = {0.0, 0.02, 0.1, 0.11, 0.2, 0.35, 0.4};
    static const double y[7] = {1.0, 1.001, 5.0, 5.0, 5.2, 30.0, 30.1};
    palp_law law;
    ck_assert_int_eq(palp_law_spline(7, x, y, &law), PALP_OK);
    double last = 0.0;
    for (int i = 0; i <= 5000; i++) {
        double k = stiffness_at(&law, 1e-4 * i);
        ck_assert_double_ge(k, last - 1e-13);
        last = k;
    }
    CLOSE(palp_law_minimum(&law, 0.5), 1.0, 1e-15);
}
END_TEST

START_TEST(minimum_finds_a_negative_stiffness) {
    static const double dip[3] = {1.0, -12.0, 30.0}; /* lowest at 0.2: 1 - 1.2 */
    palp_law law;
    ck_assert_int_eq(palp_law_polynomial(3, dip, &law), PALP_OK);
    CLOSE(palp_law_minimum(&law, 0.4), -0.2, 1e-5);
    CLOSE(palp_law_minimum(&law, 0.05), 1.0 - 0.6 + 0.075, 1e-14);
    law = spline();
    CLOSE(palp_law_minimum(&law, 0.4), 8.1, 1e-15);
}
END_TEST

START_TEST(bad_polynomials_and_splines_are_refused) {
    double c[PALP_LAW_MAX + 1] = {1.0, 2.0, NAN}, x[3] = {0.0, 0.1, 0.2}, y[3] = {1.0, 2.0, 3.0};
    palp_law law;
    ck_assert_int_eq(palp_law_polynomial(0, c, &law), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_law_polynomial(3, c, &law), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_law_polynomial(PALP_LAW_MAX + 1, c, &law), PALP_ERR_LIMIT);
    ck_assert_int_eq(palp_law_spline(1, x, y, &law), PALP_ERR_ARGUMENT);
    x[0] = 0.01;
    ck_assert_int_eq(palp_law_spline(3, x, y, &law), PALP_ERR_ARGUMENT);
    x[0] = 0.0;
    x[2] = 0.1;
    ck_assert_int_eq(palp_law_spline(3, x, y, &law), PALP_ERR_ARGUMENT);
    x[2] = INFINITY;
    ck_assert_int_eq(palp_law_spline(3, x, y, &law), PALP_ERR_ARGUMENT);
    x[2] = 0.2;
    y[1] = 0.0;
    ck_assert_int_eq(palp_law_spline(3, x, y, &law), PALP_ERR_ARGUMENT);
    law = spline();
    ck_assert_int_eq(palp_law_scale(&law, -1.0, &law), PALP_ERR_ARGUMENT);
    CLOSE(stiffness_at(&law, 0.0), 8.2, 1e-15); /* untouched */
}
END_TEST

START_TEST(kind_names_go_both_ways) {
    palp_law_kind kind;
    for (int i = PALP_LAW_POLYNOMIAL; i <= PALP_LAW_OGDEN; i++) {
        ck_assert_int_eq(palp_law_kind_parse(palp_law_kind_name((palp_law_kind)i), &kind), PALP_OK);
        ck_assert_int_eq((int)kind, i);
    }
    ck_assert_str_eq(palp_law_kind_name(PALP_LAW_MOONEY_RIVLIN5), "mooney_rivlin5");
    ck_assert_str_eq(palp_law_kind_name((palp_law_kind)99), "unknown");
    ck_assert_int_eq(palp_law_kind_parse("Polynomial", &kind), PALP_ERR_ARGUMENT);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, law_derivatives_meet_finite_differences, 0, SAMPLE_LAWS);
    tcase_add_loop_test(tc, coefficient_gradient_meets_finite_differences, 0, SAMPLE_LAWS);
    tcase_add_loop_test(tc, force_is_odd_and_its_tangent_at_zero_is_the_stiffness, 0, SAMPLE_LAWS);
    tcase_add_loop_test(tc, array_and_single_calls_agree, 0, SAMPLE_LAWS);
    tcase_add_loop_test(tc, scaled_law_scales_the_force, 0, SAMPLE_LAWS);
    tcase_add_loop_test(tc, other_coefficients_make_the_same_kind_of_law, 0, SAMPLE_LAWS);
    tcase_add_test(tc, polynomial_is_eq43);
    tcase_add_test(tc, spline_slopes_are_fritsch_butland);
    tcase_add_test(tc, spline_of_two_knots_is_a_line);
    tcase_add_test(tc, spline_interpolates_and_is_smooth_at_knots);
    tcase_add_test(tc, monotone_data_give_a_monotone_law);
    tcase_add_test(tc, minimum_finds_a_negative_stiffness);
    tcase_add_test(tc, bad_polynomials_and_splines_are_refused);
    tcase_add_test(tc, kind_names_go_both_ways);
}
