/* test_fit_degenerate.c: parameters that the data do not determine have wide intervals; it fails no fit. */
#include "fit/fit_internal.h"
#include "recordings.h"

enum { MOST = 400 };

typedef struct made {
    double time[MOST], depth[MOST], force[MOST];
    unsigned char use[MOST];
    palp_recording r;
} made;

/* A specimen of 20 mm with a spring of 40 N and an arm of 20 N and 0.3 s, pressed by 2 mm in 0.5 s, then
 * held. */
static void press(made *m) {
    const double ramp = 0.5, tau = 0.3;
    *m = (made){0};
    for (size_t i = 0; i < MOST; i++) {
        double t = m->time[i] = 0.01 * (double)i, loaded = fmin(t, ramp);
        m->depth[i] = 2e-3 * loaded / ramp;
        m->force[i] =
            40.0 * m->depth[i] / 0.02 + 20.0 * 0.1 / ramp * tau * (exp(-(t - loaded) / tau) - exp(-t / tau));
        m->use[i] = 1;
    }
    m->r = (palp_recording){.kind = PALP_RECORDING_RAMP_HOLD,
                            .n = MOST,
                            .time_s = m->time,
                            .depth_m = m->depth,
                            .force_N = m->force,
                            .use = m->use,
                            .height_m = 0.02,
                            .deepest_m = 2e-3,
                            .noise_N = 1e-3,
                            .ramp_end_s = ramp,
                            .contact_rule = PALP_CONTACT_NOMINAL};
}

/* Gram matrix of n columns of random numbers of which the last `dependent` are sums of all others. */
static void gram(uint64_t *state, size_t n, size_t dependent, double *square) {
    enum { ROWS = 50, COLUMNS = 12 };
    double column[COLUMNS][ROWS] = {{0}};
    for (size_t a = 0; a < n; a++)
        for (size_t i = 0; i < ROWS; i++)
            column[a][i] = a < n - dependent ? palp_random_uniform(state) : 0.0;
    for (size_t a = n - dependent; a < n; a++)
        for (size_t b = 0; b < n - dependent; b++) {
            double share = 0.5 + palp_random_uniform(state);
            for (size_t i = 0; i < ROWS; i++)
                column[a][i] += share * column[b][i];
        }
    for (size_t a = 0; a < n; a++)
        for (size_t b = 0; b < n; b++) {
            square[a * n + b] = 0.0;
            for (size_t i = 0; i < ROWS; i++)
                square[a * n + b] += column[a][i] * column[b][i];
        }
}

START_TEST(variances_along_what_is_not_told_are_large_and_never_negative) {
    enum { N = 10 };
    uint64_t state = 11;
    for (int k = 0; k < 200; k++)
        for (size_t dependent = 1; dependent < 5; dependent++) {
            double square[N * N], inverse[N * N];
            gram(&state, N, dependent, square);
            ck_assert_int_eq(fit_invert(N, square, inverse), PALP_OK);
            for (size_t a = 0; a < N; a++)
                ck_assert_double_gt(inverse[a * N + a], 1e6);
        }
}
END_TEST

START_TEST(a_regular_inverse) {
    double square[4] = {4e6, 2.0, 2.0, 5e-6}, inverse[4], by = 4e6 * 5e-6 - 4.0;
    ck_assert_int_eq(fit_invert(2, square, inverse), PALP_OK);
    ck_assert_double_eq_tol(inverse[0], 5e-6 / by, 1e-15);
    ck_assert_double_eq_tol(inverse[1], -2.0 / by, 1e-10);
    ck_assert_double_eq_tol(inverse[3], 4e6 / by, 1e-6);
    double indefinite[4] = {1.0, 2.0, 2.0, 1.0}, not_finite[4] = {1.0, 0.0, 0.0, NAN};
    ck_assert_int_eq(fit_invert(2, indefinite, inverse), PALP_ERR_SINGULAR);
    ck_assert_int_eq(fit_invert(2, not_finite, inverse), PALP_ERR_SINGULAR);
}
END_TEST

START_TEST(two_arms_of_one_time) {
    static made m;
    enum { N = 5 };
    palp_characterize_settings s = with_arms(2);
    press(&m);
    fit_problem p;
    ck_assert_int_eq(fit_problem_create(&p, 1, &m.r, &s, NULL), PALP_OK);
    double v[N] = {40.0, log(10.0), log(0.3), log(10.0), log(0.3)}, room[2 * N * N];
    fit_curvature c = {.covariance = room, .systematic = room + N * N};
    ck_assert_int_eq(fit_find_curvature(&p, v, &c), PALP_OK);
    for (size_t k = 1; k < N; k++)
        ck_assert_double_gt(room[k * N + k], 100.0);
    ck_assert_double_lt(room[0], 0.1);
    ck_assert_uint_eq(fit_weakest_arm(&p, v, room, 1.0), 0);
    fit_problem_free(&p);
}
END_TEST

/* The text for a network's tangent does not explain what is wrong with recordings. */
START_TEST(a_singular_fit_says_what_to_do) {
    palp_error error = {PALP_OK, ""};
    ck_assert_int_eq(fit_failed(&error, PALP_ERR_SINGULAR, "run.csv"), PALP_ERR_SINGULAR);
    ck_assert_ptr_nonnull(strstr(error.text, "run.csv: the recordings do not determine"));
    ck_assert_ptr_nonnull(strstr(error.text, "fewer arms"));
    ck_assert_ptr_null(strstr(error.text, "mechanism"));
    fit_failed(&error, PALP_ERR_NO_MEMORY, "other.csv"); /* the first word stays */
    ck_assert_ptr_null(strstr(error.text, "other.csv"));
}
END_TEST

/* An arm that starts far too weak wants a step beyond all numbers; it must not be taken for the way back to
 * the constraints that the start does not meet. */
START_TEST(a_step_back_to_the_constraints_stays_within_all_numbers) {
    static made m;
    palp_characterize_settings s = with_arms(1);
    press(&m);
    fit_problem p;
    ck_assert_int_eq(fit_problem_create(&p, 1, &m.r, &s, NULL), PALP_OK);
    double v[3] = {40.0, log(1e-6 * p.stiffness), log(2.0 * p.tau_max)}, chi2;
    bool converged;
    ck_assert_int_eq(fit_polish(&p, v, &chi2, &converged), PALP_OK);
    ck_assert(converged);
    ck_assert_double_lt(v[1], log(2e6 * p.stiffness));
    ck_assert_double_le(v[2], log(p.tau_max) + 1e-6);
    ck_assert_double_lt(chi2, 1e4);
    fit_problem_free(&p);
}
END_TEST

/* Data whose K(e) touches zero in a narrow dip, at 0 or anywhere else. */
START_TEST(stiffness_stays_positive_wherever_it_would_fall_below_zero) {
    static made m;
    for (int k = 0; k <= 40; k++) {
        double one[3] = {1.0}, v[3], dip = 0.1 * k / 40.0, chi2;
        palp_characterize_settings s = with_law(polynomial(3, one), 0);
        bool converged;
        press(&m);
        for (size_t i = 0; i < MOST; i++) {
            double e = m.depth[i] / 0.02;
            m.force[i] = (1e5 * (e - dip) * (e - dip) - 1.0) * e;
        }
        fit_problem p;
        palp_law law;
        ck_assert_int_eq(fit_problem_create(&p, 1, &m.r, &s, NULL), PALP_OK);
        ck_assert_int_eq(fit_solve(&p, v, &chi2, &converged), PALP_OK);
        ck_assert_int_eq(fit_law(&p, v, &law), PALP_OK);
        ck_assert_msg(palp_law_minimum(&law, 0.1) > 0.0, "dip at %g: K falls to %g", dip,
                      palp_law_minimum(&law, 0.1));
        fit_problem_free(&p);
    }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, stiffness_stays_positive_wherever_it_would_fall_below_zero);
    tcase_add_test(tc, variances_along_what_is_not_told_are_large_and_never_negative);
    tcase_add_test(tc, a_regular_inverse);
    tcase_add_test(tc, two_arms_of_one_time);
    tcase_add_test(tc, a_singular_fit_says_what_to_do);
    tcase_add_test(tc, a_step_back_to_the_constraints_stays_within_all_numbers);
}
