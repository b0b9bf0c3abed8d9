/* test_contact.c: the search for the specimen, on lines, on noise, and on the simulated indenter. */
#include "closed_loop.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

static void assert_near(double got, double wanted, double tolerance) {
    if (!(fabs(got - wanted) <= tolerance))
        fail_msg("%.9g is not %.9g to %g", got, wanted, tolerance);
}

/* ---- made-up forces: half a micrometre a tick ---- */

enum { STEPS_MOST = 100000 };
static const double STEP_M = 5e-7;

/* Air with an offset, then a line from at_m on; end_m as asked for. */
static contact search_line(double at_m, double stiffness_N_m, double offset_N, double end_m) {
    contact c;
    contact_begin(&c, 0.01f, (float)end_m);
    for (int i = 0; i < STEPS_MOST && c.phase < CONTACT_FOUND; i++) {
        double x = STEP_M * i, force = offset_N + (x > at_m ? stiffness_N_m * (x - at_m) : 0);
        contact_step(&c, (float)x, (float)force);
    }
    return c;
}

static void test_line(void **state) {
    static const double stiffness[] = {50, 95, 477, 2385, 9000};
    (void)state;
    for (int i = 0; i < 5; i++)
        for (int k = 0; k < 2; k++) {
            contact c = search_line(1e-3 + 9e-3 * k, stiffness[i], -3.5 * k, 2e-2);
            assert_int_equal(c.phase, CONTACT_FOUND);
            assert_near((double)c.stiffness_N_m, stiffness[i], 2e-3 * stiffness[i]);
            assert_near((double)c.position_m, 1e-3 + 9e-3 * k, 1e-6);
            assert_true((double)c.touched_m > (double)c.position_m);
            assert_int_equal(contact_step(&c, 1, 1), CONTACT_FOUND); /* and stays so */
        }
}

/* It measures over a tenth of a millimetre, or until a newton more than the threshold. */
static void test_stops(void **state) {
    (void)state;
    for (int hard = 0; hard < 2; hard++) {
        const double stiffness = hard ? 1e5 : 477;
        contact c;
        double x = 0, force = 0;
        contact_begin(&c, 0.01f, 1);
        for (int i = 0; i < STEPS_MOST && c.phase < CONTACT_FOUND; i++) {
            x = STEP_M * i;
            force = x > 1e-3 ? stiffness * (x - 1e-3) : 0;
            contact_step(&c, (float)x, (float)force);
        }
        assert_int_equal(c.phase, CONTACT_FOUND);
        assert_true(x - (double)c.touched_m <= 1e-4 + 1.1 * STEP_M &&
                    force <= 1.01 + 1.1 * stiffness * STEP_M);
        assert_near((double)c.stiffness_N_m, stiffness, 0.01 * stiffness);
    }
}

/* From nothing to far too much within a tick, and a position that does not change. */
static void test_wall(void **state) {
    contact c;
    (void)state;
    contact_begin(&c, 0.01f, 1);
    for (int i = 0; i < 1000; i++)
        assert_int_equal(contact_step(&c, 1e-6f * (float)i, 0), CONTACT_SEEKING);
    assert_int_equal(contact_step(&c, 1e-3f, 5.0f), CONTACT_FOUND);
    assert_true(c.stiffness_N_m == CONTACT_RIGID_N_M && c.position_m == 1e-3f);
}

static void test_air(void **state) {
    (void)state;
    assert_int_equal(search_line(1, 477, 0.3, 5e-3).phase, CONTACT_MISSED);
    assert_int_equal(search_line(4.99e-3, 477, 0.3, 5e-3).phase, CONTACT_MISSED); /* too late to be felt */
}

/* A search that begins in the specimen has no air to compare with. */
static void test_no_air(void **state) {
    static const double stiffness[] = {95, 477, 2385, 1e6};
    (void)state;
    for (int i = 0; i < 4; i++) {
        assert_int_equal(search_line(-1e-3, stiffness[i], 0, 5e-3).phase, CONTACT_MISSED);
        assert_int_equal(search_line(2e-5, stiffness[i], 0, 5e-3).phase, CONTACT_MISSED);
    }
}

/* A force that steps, falls or only shakes is no specimen. */
static void test_no_slope(void **state) {
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        contact c;
        uint32_t random = 1;
        contact_begin(&c, 0.01f, 1);
        for (int i = 0; i < STEPS_MOST && c.phase < CONTACT_FOUND; i++) {
            random = random * 1664525u + 1013904223u;
            double noise = 0.004 * ((double)random / 2147483648.0 - 1), late = fmax(0, i - 2000);
            double force = i < 2000    ? 0
                           : kind == 0 ? 0.05
                           : kind == 1 ? 0.05 * exp(-late / 300)
                                       : 0.05 * (random >> 31);
            contact_step(&c, (float)(STEP_M * i), (float)(force + noise));
        }
        assert_int_equal(c.phase, CONTACT_MISSED);
    }
}

/* ---- the simulated indenter ---- */

typedef struct tally {
    double sum, squares, largest;
    int n;
} tally;

static void add(tally *t, double x) {
    t->sum += x;
    t->squares += x * x;
    t->largest = fmax(t->largest, fabs(x));
    t->n++;
}

static double mean(const tally *t) {
    return t->sum / t->n;
}

static double deviation(const tally *t) {
    return sqrt(fmax(0, t->squares / t->n - mean(t) * mean(t)));
}

/* Mean and spread of what 20 seeds of 2 mN noise give, for each class. */
static void test_classes(void **state) {
    (void)state;
    for (int k = 0; k < SOFTNESSES; k++) {
        tally position = {.n = 0}, stiffness = {.n = 0};
        for (uint64_t seed = 1; seed <= 20; seed++) {
            plant_settings s = plant_settings_default();
            loop l;
            s.scale = softness_scale[k];
            s.sensor.seed = seed;
            s.sensor.bias_N = 0.2;
            loop_open(&l, s);
            loop_rest(&l, 0, 50);
            contact c = loop_search(&l, 5e-4f, 3e-3f);
            assert_int_equal(c.phase, CONTACT_FOUND);
            assert_int_equal(gains_class(gains_table, c.stiffness_N_m), k);
            add(&position, 1e6 * ((double)c.position_m - (double)LOOP_AIR_M));
            add(&stiffness, (double)c.stiffness_N_m);
            loop_close(&l);
        }
        printf("%4.2f x: contact off by %+6.2f um (sd %5.2f, most %5.2f), stiffness %6.1f N/m (sd %4.1f) of "
               "%6.1f\n",
               softness_scale[k], mean(&position), deviation(&position), position.largest, mean(&stiffness),
               deviation(&stiffness), 477 * softness_scale[k]);
        assert_true(k < GAINS_MIDDLE || position.largest < 5);
        assert_true(position.largest < 25);
        assert_near(mean(&stiffness), 477 * softness_scale[k], 0.05 * 477 * softness_scale[k]);
    }
}

static void test_rigid(void **state) {
    plant_settings s = plant_settings_default();
    loop l;
    (void)state;
    s.specimen = PLANT_RIGID;
    loop_open(&l, s);
    contact c = loop_search(&l, 5e-4f, 3e-3f);
    printf("rigid: %.2f um, %.3g N/m, stopped at %.2f N\n", 1e6 * ((double)c.position_m - (double)LOOP_AIR_M),
           (double)c.stiffness_N_m, plant_look(l.plant).force_N);
    assert_int_equal(c.phase, CONTACT_FOUND);
    assert_near((double)c.position_m, (double)LOOP_AIR_M, 5e-6);
    assert_true(c.stiffness_N_m > 1e5f);
    assert_true(plant_look(l.plant).force_N < 2);
    loop_close(&l);
}

static void test_nothing_there(void **state) {
    plant_settings s = plant_settings_default();
    loop l;
    (void)state;
    s.specimen = PLANT_AIR;
    loop_open(&l, s);
    assert_int_equal(loop_search(&l, 5e-4f, 5e-3f).phase, CONTACT_MISSED);
    loop_close(&l);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_line),          cmocka_unit_test(test_stops),
    cmocka_unit_test(test_wall),          cmocka_unit_test(test_air),
    cmocka_unit_test(test_no_air),        cmocka_unit_test(test_no_slope),
    cmocka_unit_test(test_classes),       cmocka_unit_test(test_rigid),
    cmocka_unit_test(test_nothing_there), {0},
};
