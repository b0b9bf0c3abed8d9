/* test_element_history.c: one element's history against closed forms and equations integrated here. */
#include "element_make.h"

#include <palpate/closed_form.h>

#include <math.h>

/* ---- against differential equations -------------------------------------------------------------- */

/* Smooth, into compression and back, |e| never turning: e = -0.16 (1 - cos(1.1 t)). */
static double path(double t) {
    return -0.16 * (1.0 - cos(1.1 * t));
}

static double path_rate(double t) {
    return -0.16 * 1.1 * sin(1.1 * t);
}

/* dq/dt of an arm, written from material.h and Eq. 3.77-3.79. */
static double arm_rate(const palp_material *m, size_t j, double q, double t) {
    const palp_arm *arm = &m->arms[j];
    double e = path(t), a = fabs(e), drive = 1.0 + arm->beta * a;
    double tau = arm->viscosity_Ns / arm->stiffness_N * (1.0 + arm->gamma * a);
    if (m->quasi_linear) {
        const double *c = QUARTIC;
        drive = (c[0] + a * (2 * c[1] + a * (3 * c[2] + a * (4 * c[3] + a * 5 * c[4])))) / c[0];
    }
    return arm->stiffness_N * drive * path_rate(t) - q / tau;
}

/* F at the end of the path by Runge and Kutta's fourth order, with steps so small that it is exact here. */
static double reference_force(const palp_material *m, double end) {
    double k, force, e = path(end);
    palp_law_stiffness(&m->law, e, &k, NULL);
    force = k * e + m->dashpot_Ns * path_rate(end);
    for (size_t j = 0; j < m->n_arms; j++) {
        enum { STEPS_TAKEN = 4000 };
        double q = 0.0, h = end / STEPS_TAKEN;
        for (int i = 0; i < STEPS_TAKEN; i++) {
            double t = i * h, a = arm_rate(m, j, q, t), b = arm_rate(m, j, q + 0.5 * h * a, t + 0.5 * h);
            double c = arm_rate(m, j, q + 0.5 * h * b, t + 0.5 * h), d = arm_rate(m, j, q + h * c, t + h);
            q += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
        }
        force += q;
    }
    return force;
}

static double stepped_force(const palp_material *m, double end, int steps) {
    palp_element_state state = {0};
    for (int i = 1; i <= steps; i++)
        state = advance(m, state, path(end * i / steps), end / steps);
    return state.force_N;
}

/* The dashpot's rate is a backward difference, of first order; it is checked by itself below. */
START_TEST(history_is_of_second_order) {
    static const int kinds[] = {PLAIN_1, PLAIN_5, BETA, GAMMA, BETA_GAMMA, QLV, QLV_GAMMA};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        palp_material m = material_of(kinds[i]);
        m.dashpot_Ns = 0.0;
        double want = reference_force(&m, 4.0), error[3];
        for (int k = 0; k < 3; k++)
            error[k] = fabs(stepped_force(&m, 4.0, 400 << k) - want);
        for (int k = 0; k < 2; k++)
            ck_assert_msg(error[k] / error[k + 1] > 3.8 && error[k] / error[k + 1] < 4.2,
                          "kind %d: errors %g, %g, %g", kinds[i], error[0], error[1], error[2]);
        ck_assert_msg(error[2] < 1e-5 * fabs(want), "kind %d: error %g of %g", kinds[i], error[2], want);
    }
}
END_TEST

START_TEST(sedef2008_is_of_first_order_in_its_own_equation) {
    /* Eq. 5.2, F + tau F' = K e + b1 (1 + K/K1) e', without the e K' that it lost */
    palp_material m = material_of(SEDEF_1);
    const palp_arm *arm = &m.arms[0];
    double force = 0.0, tau = arm->viscosity_Ns / arm->stiffness_N, h = 4.0 / 8000, error[3];
    for (int i = 0; i < 8000; i++) {
        double slope[4] = {0};
        for (int s = 0; s < 4; s++) {
            double c = s == 0 ? 0.0 : s == 3 ? 1.0 : 0.5, t = (i + c) * h, e = path(t), k;
            palp_law_stiffness(&m.law, e, &k, NULL);
            double f = force + (s ? c * h * slope[s - 1] : 0.0);
            slope[s] = (k * e + arm->viscosity_Ns * (1.0 + k / arm->stiffness_N) * path_rate(t) - f) / tau;
        }
        force += h / 6.0 * (slope[0] + 2.0 * slope[1] + 2.0 * slope[2] + slope[3]);
    }
    for (int k = 0; k < 3; k++)
        error[k] = fabs(stepped_force(&m, 4.0, 4000 << k) - force);
    for (int k = 0; k < 2; k++)
        ck_assert_msg(error[k] / error[k + 1] > 1.9 && error[k] / error[k + 1] < 2.1, "errors %g, %g, %g",
                      error[0], error[1], error[2]);
}
END_TEST

/* ---- against closed forms ------------------------------------------------------------------------ */

/* Steps of any size, here wildly different ones, are exact on ramps and holds. */
START_TEST(linear_arms_are_exact_on_ramps) {
    static const double times[] = {1e-4,  0.03, 0.031, 0.7,  2.0,
                                   2.001, 2.9,  50.0,  51.0, 4000.0}; /* ramp to 2 s */
    enum { N = sizeof times / sizeof *times };
    for (int sign = -1; sign <= 1; sign += 2)
        for (int kind = PLAIN_0; kind <= PLAIN_5; kind++) {
            palp_material m = material_of(kind);
            palp_element_state state = {0};
            double want[N], rate = sign * 0.15, before = 0.0;
            ck_assert_int_eq(palp_lumped_ramp_hold(&m, sign * 0.3, 2.0, N, times, want), PALP_OK);
            for (size_t i = 0; i < N; i++) {
                double t = times[i], up = fmin(t, 2.0), k, force;
                state = advance(&m, state, rate * up, t - before);
                palp_law_stiffness(&m.law, rate * up, &k, NULL);
                force = k * rate * up;
                for (size_t j = 0; j < m.n_arms; j++) { /* Eq. 3.56 with b_j rate for eta_j rate */
                    double tau = m.arms[j].viscosity_Ns / m.arms[j].stiffness_N;
                    force += m.arms[j].viscosity_Ns * rate * (exp((up - t) / tau) - exp(-t / tau));
                }
                ck_assert_double_eq_tol(state.force_N, force, 1e-13);
                ck_assert_double_eq_tol(state.force_N, want[i], 1e-13);
                before = t;
            }
        }
}
END_TEST

START_TEST(lumped_run_of_a_triangle) {
    /* linear spring and arms: superposed ramps (Boltzmann), up to 1 s, down to 2 s, rest */
    palp_material m = plain(3);
    ck_assert_int_eq(palp_law_polynomial(1, (double[]){2.5}, &m.law), PALP_OK);
    m.dashpot_Ns = 0.4;
    const double height = 0.024, rate = 0.2; /* of strain */
    double time[31], depth[31], force[31];
    for (int i = 0; i <= 30; i++) {
        time[i] = 0.1 * i + 7.0; /* where the clock starts is no matter */
        double t = 0.1 * i, strain = rate * (t < 1.0 ? t : fmax(0.0, 2.0 - t));
        depth[i] = height * strain;
    }
    ck_assert_int_eq(palp_lumped_run(&m, height, 31, time, depth, force), PALP_OK);
    for (int i = 0; i <= 30; i++) {
        static const double corner[] = {0.0, 1.0, 2.0}, turn[] = {1.0, -2.0, 1.0};
        double t = 0.1 * i, want = 2.5 * depth[i] / height;
        for (int c = 0; c < 3; c++)
            for (size_t j = 0; j < 3 && t > corner[c]; j++)
                want += turn[c] * rate * m.arms[j].viscosity_Ns *
                        -expm1(-(t - corner[c]) * m.arms[j].stiffness_N / m.arms[j].viscosity_Ns);
        if (i > 0 && i <= 20)
            want += 0.4 * (i <= 10 ? rate : -rate);
        ck_assert_double_eq_tol(force[i], want, 2e-14);
    }
}
END_TEST

START_TEST(lumped_run_that_starts_with_a_jump) {
    palp_material m = plain(2);
    const double time[] = {0.0, 0.5, 30.0}, depth[] = {0.006, 0.006, 0.006};
    double force[3], want[3];
    ck_assert_int_eq(palp_lumped_run(&m, 0.024, 3, time, depth, force), PALP_OK);
    ck_assert_int_eq(palp_lumped_ramp_hold(&m, 0.25, 0.0, 3, time, want), PALP_OK);
    for (size_t i = 0; i < 3; i++)
        ck_assert_double_eq_tol(force[i], want[i], 1e-14);
    m.dashpot_Ns = 1.0; /* would give an infinite force */
    ck_assert_int_eq(palp_lumped_run(&m, 0.024, 3, time, depth, force), PALP_ERR_ARGUMENT);
}
END_TEST

START_TEST(sedef2008_steps_by_hand) {
    /* Eq. 5.4 with K = 2 + 3 |e|, K1 = 0.5 N, b1 = 2 N s: b1 / (K1 dt) = 8 at dt = 0.5 s */
    palp_material m = {.n_arms = 1, .arms = {{0.5, 2.0, 0, 0}}, .formulation = PALP_SEDEF2008};
    ck_assert_int_eq(palp_law_polynomial(2, (double[]){2.0, 3.0}, &m.law), PALP_OK);
    palp_element_state state = {0};
    /* to -0.1: K = 2.3, (-0.23 + 2 * 5.6 * -0.2) / 9 */
    state = advance(&m, state, -0.1, 0.5);
    ck_assert_double_eq_tol(state.force_N, (-0.23 - 2.24) / 9.0, 1e-15);
    /* to -0.2: K = 2.6, (-0.52 + 2 * 6.2 * -0.2 + 8 F) / 9 */
    double before = state.force_N;
    state = advance(&m, state, -0.2, 0.5);
    ck_assert_double_eq_tol(state.force_N, (-0.52 - 2.48 + 8.0 * before) / 9.0, 1e-15);
    /* held, and let go into tension: K = 2.15, (0.1075 + 2 * 5.3 * 0.5 + 8 F) / 9 */
    before = state.force_N;
    state = advance(&m, state, -0.2, 0.5);
    ck_assert_double_eq_tol(state.force_N, (-0.52 + 8.0 * before) / 9.0, 1e-15);
    before = state.force_N;
    state = advance(&m, state, 0.05, 0.5);
    ck_assert_double_eq_tol(state.force_N, (0.1075 + 5.3 + 8.0 * before) / 9.0, 1e-15);
    /* a short step loses no digits: A to first order in dt is K1 / b1 (K e dt + b1 (1 + K/K1) de) */
    palp_element_state rest = {0};
    double want =
        0.25 * (2.0 * (1.0 + (2.0 + 3e-6) / 0.5) * 1e-6 + (2.0 + 3e-6) * 1e-6 * 1e-9) / (1.0 + 0.25e-9);
    ck_assert_double_eq_tol(advance(&m, rest, 1e-6, 1e-9).force_N / want, 1.0, 1e-14);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, history_is_of_second_order);
    tcase_add_test(tc, sedef2008_is_of_first_order_in_its_own_equation);
    tcase_add_test(tc, linear_arms_are_exact_on_ramps);
    tcase_add_test(tc, lumped_run_of_a_triangle);
    tcase_add_test(tc, lumped_run_that_starts_with_a_jump);
    tcase_add_test(tc, sedef2008_steps_by_hand);
}
