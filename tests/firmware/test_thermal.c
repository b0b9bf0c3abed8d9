/* test_thermal.c: the thermistor's table, the winding's heat, derating. */
#include "thermal.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

static const machine *const m = &machine_indenter;

enum { ROOM = 2141 }; /* counts at 23 C */

static void assert_near(double got, double wanted, double tolerance) {
    if (!(fabs(got - wanted) <= tolerance))
        fail_msg("%.9g is not %.9g to %g", got, wanted, tolerance);
}

/* Of the divider, by the thermistor's formula. */
static double counts_at(double celsius) {
    double r = exp(3950 * (1 / (celsius + 273.15) - 1 / 298.15));
    return 4095 * r / (1 + r);
}

static double celsius_at(double counts) {
    double r = counts / (4095 - counts);
    return 1 / (1 / 298.15 + log(r) / 3950) - 273.15;
}

/* ---- thermistor ---- */

static void test_table(void **state) {
    double most = 0, warm = 0;
    (void)state;
    for (int counts = (int)ceil(counts_at(150)); counts <= (int)counts_at(-40); counts++) {
        double off = fabs((double)thermal_thermistor_C((uint16_t)counts) - celsius_at(counts));
        most = fmax(most, off);
        warm = counts < counts_at(0) ? fmax(warm, off) : warm;
    }
    printf("thermistor: table off by at most %.3f K, above 0 C %.3f K\n", most, warm);
    assert_true(most < 0.2 && warm < 0.12);
    assert_near((double)thermal_thermistor_C((uint16_t)lrint(counts_at(25))), 25, 0.03);
}

static void test_clamped(void **state) {
    (void)state;
    assert_near((double)thermal_thermistor_C(0), 150, 0);
    assert_near((double)thermal_thermistor_C(4095), -40, 1e-4);
    assert_near((double)thermal_thermistor_C(UINT16_MAX), -40, 1e-4);
    for (uint16_t counts = 1; counts < 4095; counts++)
        assert_true(thermal_thermistor_C(counts) <= thermal_thermistor_C((uint16_t)(counts - 1)));
}

/* Open and short are told, also at the start; the last good reading stays; a good one ends it. */
static void test_broken(void **state) {
    static const uint16_t bad[] = {0, 30, 4060, 4095};
    (void)state;
    for (int i = 0; i < 4; i++) {
        thermal t = {.started = false};
        thermal_step(&t, m, 0, 0, bad[i]);
        assert_true(t.broken && !t.started);
        thermal_step(&t, m, 0, 0, ROOM);
        assert_true(!t.broken && t.started);
        thermal_step(&t, m, 0, 0, bad[i]);
        assert_true(t.broken);
        assert_near((double)t.case_C, 23, 0.1);
    }
}

static void test_filter(void **state) {
    thermal t = {.started = false};
    (void)state;
    thermal_step(&t, m, 0, 0, (uint16_t)lrint(counts_at(60)));
    assert_near((double)t.case_C, 60, 0.1); /* the first reading counts in full */
    for (int i = 1; i <= 640; i++) {
        thermal_step(&t, m, 0, 0, ROOM);
        assert_near((double)t.case_C, 23 + 37 * pow(63.0 / 64, i), 0.15);
    }
}

/* ---- winding ---- */

/* Constant duty and speed for so long, against the exponential; power from the formula in double. */
static void heat_up(double duty, double velocity, double seconds) {
    thermal t = {.started = false};
    double current = (duty * 24 - 12 * velocity) / 4;
    current = fmax(-3.5, fmin(3.5, current));
    double final = 2.5 * 4 * current * current, most = 0;
    long ticks = lrint(1e3 * seconds);
    for (long i = 1; i <= ticks; i++) {
        thermal_step(&t, m, (float)duty, (float)velocity, ROOM);
        if (i % THERMAL_TICKS == 0)
            most = fmax(most, fabs((double)t.rise_K - final * (1 - exp(-1e-3 * (double)i / 100))));
    }
    printf("duty %5.2f at %5.2f m/s: rise %6.2f K of %6.2f after %4.0f s, off by at most %.4f K\n", duty,
           velocity, (double)t.rise_K, final, seconds, most);
    assert_true(most < 2e-3 + 1e-5 * final);
    assert_near((double)thermal_winding_C(&t), (double)t.case_C + (double)t.rise_K, 1e-5);
}

static void test_winding(void **state) {
    (void)state;
    heat_up(0.3, 0, 1000);
    heat_up(-0.3, 0, 300);
    heat_up(0.5, 0.1, 300);
    heat_up(0.1, 0.2, 300); /* in balance with the back-EMF: no heat */
    heat_up(1, 0, 300);     /* held at the driver's limit */
    heat_up(-1, 0.2, 300);
}

static void test_cools(void **state) {
    thermal t = {.rise_K = 80};
    (void)state;
    for (int i = 0; i < 200 * 1000; i++)
        thermal_step(&t, m, 0, 0, ROOM);
    assert_near((double)t.rise_K, 80 * exp(-2), 1e-2);
}

/* Ten hours of a little heat do not get lost in rounding. */
static void test_long(void **state) {
    thermal t = {.started = false};
    (void)state;
    for (int i = 0; i < 36000 * 1000; i++)
        thermal_step(&t, m, 0.05f, 0, ROOM);
    assert_near((double)t.rise_K, 2.5 * 4 * 0.3 * 0.3, 5e-4);
}

static void test_derating(void **state) {
    (void)state;
    for (int i = 0; i <= 1500; i++) {
        double winding = 0.1 * i;
        const thermal t = {.case_C = (float)(winding * 0.5), .rise_K = (float)(winding * 0.5)};
        assert_near((double)thermal_derating(&t, m), fmax(0, fmin(1, (110 - winding) / 20)), 2e-6);
    }
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_table),  cmocka_unit_test(test_clamped),  cmocka_unit_test(test_broken),
    cmocka_unit_test(test_filter), cmocka_unit_test(test_winding),  cmocka_unit_test(test_cools),
    cmocka_unit_test(test_long),   cmocka_unit_test(test_derating), {0},
};
