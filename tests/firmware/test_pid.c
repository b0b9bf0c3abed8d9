/* test_pid.c: the controller term by term, its anti-windup, and the table of gains. */
#include "machine.h"
#include "pid.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const gains none = {.filter_Hz = 100};

static void assert_near(double got, double wanted, double tolerance) {
    if (!(fabs(got - wanted) <= tolerance))
        fail_msg("%.9g is not %.9g to %g", got, wanted, tolerance);
}

/* A tick of a machine without mass, drag and friction. */
static double step(pid *p, const gains *g, float wanted_m, float position_m, float limit_N) {
    const reference to = {.position_m = wanted_m};
    return (double)pid_step(p, g, g->feed_N_m, &to, position_m, 0, 0, 0, 0, limit_N);
}

/* ---- each term ---- */

static void test_feed_forward(void **state) {
    gains g = none;
    pid p;
    reference to = {0.01f, 0.005f, 0.25f};
    (void)state;
    pid_reset(&p);
    g.feed_N_m = 500;
    assert_near((double)pid_step(&p, &g, g.feed_N_m, &to, 0.01f, 0, 0.4f, 40, 0, 100),
                0.4 * 0.25 + 40 * 0.005, 1e-6);
    assert_near((double)pid_step(&p, &g, g.feed_N_m, &to, 0.01f, 0.004f, 0.4f, 40, 0, 100), 0.1 + 0.2 + 2,
                1e-6);
    assert_near((double)pid_step(&p, &g, g.feed_N_m, &to, 0.01f, -0.004f, 0.4f, 40, 0, 100), 0.1 + 0.2, 1e-6);
}

/* Full after 10 um of travel, kept at rest, turned round over 20 um. */
static void test_friction(void **state) {
    reference to = {.velocity_m_s = 1e-3f};
    pid p;
    (void)state;
    pid_reset(&p);
    for (int i = 1; i <= 20; i++)
        assert_near((double)pid_step(&p, &none, none.feed_N_m, &to, 0, 0, 0, 0, 0.15f, 10),
                    0.15 * fmin(1, 0.1 * i), 1e-6);
    to.velocity_m_s = 0;
    assert_near((double)pid_step(&p, &none, none.feed_N_m, &to, 0, 0, 0, 0, 0.15f, 10), 0.15, 1e-6);
    to.velocity_m_s = -1e-3f;
    for (int i = 1; i <= 30; i++)
        assert_near((double)pid_step(&p, &none, none.feed_N_m, &to, 0, 0, 0, 0, 0.15f, 10),
                    0.15 * fmax(-1, 1 - 0.1 * i), 1e-6);
}

static void test_proportional(void **state) {
    gains g = none;
    pid p;
    (void)state;
    g.kp_N_m = 5000;
    pid_reset(&p);
    assert_near(step(&p, &g, 0.002f, 0.001f, 100), 5, 1e-5);
    assert_near(step(&p, &g, 0.001f, 0.002f, 100), -5, 1e-5);
}

static void test_integral(void **state) {
    gains g = none;
    pid p;
    (void)state;
    g.ki_N_ms = 1e5f;
    pid_reset(&p);
    for (int i = 1; i <= 1000; i++)
        assert_near(step(&p, &g, 1e-5f, 0, 100), 1e-3 * i, 1e-5);
}

/* A velocity error of 1 mm/s from the second tick on rises as a first-order low-pass does, by backward Euler.
 */
static void test_derivative(void **state) {
    gains g = none;
    double x = 2 * 3.14159265358979 * 100 * 1e-3;
    pid p;
    (void)state;
    g.kd_Ns_m = 50;
    pid_reset(&p);
    for (int i = 0; i < 50; i++)
        assert_near(step(&p, &g, 1e-6f * (float)i, 0, 100), 0.05 * (1 - pow(1 + x, -i)), 1e-5);
}

/* The first tick after a reset knows no velocity. */
static void test_no_kick(void **state) {
    gains g = none;
    pid p;
    (void)state;
    g.kd_Ns_m = 50;
    pid_reset(&p);
    assert_near(step(&p, &g, 0.02f, 0, 100), 0, 0);
    pid_reset(&p);
    assert_near(step(&p, &g, -0.02f, 0, 100), 0, 0);
}

/* ---- limits ---- */

static void test_limit(void **state) {
    gains g = none;
    pid p;
    (void)state;
    g.kp_N_m = 5000;
    pid_reset(&p);
    assert_near(step(&p, &g, 1, 0, 7), 7, 0);
    assert_near(step(&p, &g, -1, 0, 7), -7, 0);
    assert_near(step(&p, &g, 1, 0, 0), 0, 0);
}

/* However long it is held back, the integral does not grow, and shrinks as soon as it may. */
static void test_windup(void **state) {
    gains g = none;
    pid p;
    (void)state;
    g.kp_N_m = 5000;
    g.ki_N_ms = 1e5f;
    for (int sign = -1; sign <= 1; sign += 2) {
        float error = 1e-3f * (float)sign;
        pid_reset(&p);
        for (int i = 0; i < 10000; i++)
            assert_near(step(&p, &g, error, 0, 6), sign * fmin(6, 5 + 0.1 * (i + 1)), 1e-4);
        assert_true(fabs((double)p.integral_N) <= 1.001);
        assert_near(step(&p, &g, -error, 0, 6), sign * (0.9 - 5), 1e-4);
    }
}

/* Held back by feed-forward alone, an error the other way is still worked off. */
static void test_windup_feed(void **state) {
    const reference to = {.velocity_m_s = 1};
    gains g = none;
    pid p;
    (void)state;
    g.ki_N_ms = 1e5f;
    pid_reset(&p);
    for (int i = 0; i < 10; i++)
        assert_near((double)pid_step(&p, &g, g.feed_N_m, &to, 1e-4f, 0, 0, 40, 0, 10), 10, 0);
    assert_near((double)p.integral_N, -0.1, 1e-5);
}

/* A jump that saturates the motor for a while, on a bare mass: back within a tenth of it, hardly overshot. */
static void test_recovers(void **state) {
    const gains *g = &gains_table[GAINS_MIDDLE];
    double x = 0, v = 0, most = 0;
    pid p;
    (void)state;
    pid_reset(&p);
    for (int i = 0; i < 1500; i++) {
        const reference to = {.position_m = 0.01f};
        double force = (double)pid_step(&p, g, g->feed_N_m, &to, (float)x, 0, 0.4f, 40, 0, 10);
        for (int k = 0; k < 10; k++) {
            v += 1e-4 * (force - 40 * v) / 0.4;
            x += 1e-4 * v;
        }
        most = fmax(most, x);
    }
    assert_near(x, 0.01, 2e-6);
    assert_true(most < 0.0125);
}

/* ---- the table ---- */

static void test_table(void **state) {
    (void)state;
    for (int k = 0; k < GAINS_CLASSES; k++) {
        const gains *g = &gains_table[k];
        assert_true(g->kp_N_m > 0 && g->ki_N_ms > 0 && g->kd_Ns_m > 0 && g->filter_Hz > 0 && g->feed_N_m > 0);
        assert_true(k == 0 || g->stiffness_N_m > gains_table[k - 1].stiffness_N_m);
        assert_true(k == 0 || g->feed_N_m > gains_table[k - 1].feed_N_m);
        assert_int_equal(gains_class(gains_table, g->stiffness_N_m), k);
        assert_int_equal(gains_class(gains_table, 1.001f * g->stiffness_N_m),
                         k < GAINS_CLASSES - 1 ? k + 1 : k);
    }
    assert_int_equal(gains_class(gains_table, 477), GAINS_MIDDLE);
    assert_int_equal(gains_class(gains_table, 0), 0);
    assert_int_equal(gains_class(gains_table, 1e9f), GAINS_CLASSES - 1);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_feed_forward), cmocka_unit_test(test_friction),
    cmocka_unit_test(test_proportional), cmocka_unit_test(test_integral),
    cmocka_unit_test(test_derivative),   cmocka_unit_test(test_no_kick),
    cmocka_unit_test(test_limit),        cmocka_unit_test(test_windup),
    cmocka_unit_test(test_windup_feed),  cmocka_unit_test(test_recovers),
    cmocka_unit_test(test_table),        {0},
};
