/* test_plant_specimen.c: the force of the simulated indenter's specimen, against closed forms and the
 * library. */
/* check: valgrind */
#include "plant_make.h"

#include <string.h>

/* ---- specimens ---- */

/* Brings the plate to so deep by a controller of the test's own, and holds it there. */
static plant_truth press(plant *p, double depth_m, int ticks) {
    plant_truth t = plant_look(p);
    double integral = 0;
    for (int tick = 0; tick < ticks; tick++) {
        double error = depth_m - t.depth_m;
        integral += 1000 * error * TICK;
        double force = 2000 * error + integral - 20 * t.velocity_m_s;
        t = step(p, (int)(fmin(fmax(force / 72, -0.5), 0.5) * 32767), true, NULL);
    }
    return t;
}

static void test_rigid_block_and_compliance(void **state) {
    plant_settings s = in_air();
    (void)state;
    s.specimen = PLANT_RIGID;
    s.actuator.start_m = s.contact_m;
    s.actuator.coulomb_N = 0;
    s.actuator.compliance_m_N = 2e-5;
    plant *p = make(&s);
    plant_truth t = {0};
    for (int tick = 0; tick < 2000; tick++) {
        t = step(p, 4551, true, NULL); /* 10 N */
    }
    near(t.force_N, 72 * 4551 / 32767.0, 1e-6);
    near(t.depth_m, t.force_N / s.rigid_N_m, 1e-12);
    near(t.carriage_m - s.contact_m, t.force_N * (1 / s.rigid_N_m + 2e-5), 1e-9);
    plant_free(p);
}

/* The frame gives way: as deep as the force leaves it, on a network too. */
static void test_compliance_of_models(void **state) {
    static const char *const models[] = {"data/sedef2008/lumped_n2.json", "data/sedef2008/network_27.json"};
    (void)state;
    for (size_t i = 0; i < 2; i++) {
        plant_settings s = in_air();
        s.specimen = PLANT_MODEL;
        s.model = models[i];
        s.actuator.start_m = s.contact_m;
        s.actuator.compliance_m_N = 1e-4;
        plant *p = make(&s);
        plant_truth t = press(p, 2e-3, 400);
        assert_true(t.force_N > 0.5);
        near(t.carriage_m - s.contact_m - t.depth_m, 1e-4 * t.force_N, 1e-11);
        plant_free(p);
    }
}

/* The force of a lumped specimen is palp_lumped_run's along the depths that were pressed. */
static void test_lumped_force(void **state) {
    enum { N = 3000 };
    plant_settings s = plant_settings_default();
    plant *p;
    palp_model model;
    static double time[N + 1], depth[N + 1], force[N + 1], plain[N + 1];
    (void)state;
    s.model = "data/sedef2008/lumped_n2.json";
    s.actuator.start_m = s.contact_m;
    s.scale = 2;
    p = make(&s);
    assert_int_equal(palp_model_read(s.model, &model, NULL, NULL), PALP_OK);
    for (int i = 1; i <= N; i++) {
        plant_truth t = step(p, i < N / 2 ? 700 + i : 500, true, NULL);
        time[i] = i * TICK;
        depth[i] = t.depth_m;
        force[i] = t.force_N;
        assert_true(t.depth_m >= 0 && t.force_N >= 0);
    }
    assert_int_equal(palp_lumped_run(&model.material, model.height_m, N + 1, time, depth, plain), PALP_OK);
    for (int i = 1; i <= N; i++) {
        near(force[i], 2 * plain[i], 2e-5 * force[N]); /* depth is not straight within a tick */
    }
    plant_free(p);
}

/* Without a model it is the seed's phantom. */
static void test_phantom_is_the_file(void **state) {
    plant_settings s = plant_settings_default(), file = s;
    file.model = "data/sedef2008/lumped_n2.json";
    s.actuator.start_m = file.actuator.start_m = s.contact_m;
    plant *p = make(&s), *q = make(&file);
    (void)state;
    for (int i = 0; i < 2000; i++) {
        plant_truth a = step(p, 900, true, NULL), b = step(q, 900, true, NULL);
        assert_memory_equal(&a, &b, sizeof a);
    }
    plant_free(p);
    plant_free(q);
}

/* Left behind by the plate, a Maxwell solid has q = -K e and so recovers by e' = -e / (tau (1 + K1 / K)):
 * when the plate is brought back it is met where the closed form says. */
static void recovers(const char *model, double tau, double ratio, double tolerance_m) {
    plant_settings s = in_air();
    s.specimen = PLANT_MODEL;
    s.model = model;
    s.actuator.start_m = s.contact_m;
    s.actuator.coulomb_N = 0;
    plant *p = make(&s);
    press(p, 2e-3, 3000);
    plant_truth t, last = plant_look(p);
    do { /* away: how deep the specimen is when the force ends */
        t = last;
        last = step(p, -2000, true, NULL);
        assert_true(last.force_N >= 0);
    } while (last.force_N > 0);
    double left_m = 0.5 * (t.depth_m + last.depth_m), left_s = last.time_s - 0.5 * TICK;
    assert_true(left_m > 1e-3 && left_m < 2e-3);
    for (int i = 0; i < 50; i++) { /* 2 mm away, and back against it slowly */
        last = step(p, -1500, true, NULL);
        near(last.force_N, 0, 0);
    }
    assert_true(last.depth_m < 0.2e-3);
    while (last.force_N <= 0) {
        t = last;
        last = step(p, 400, true, NULL);
        assert_true(last.time_s < 10);
    }
    double met_m = 0.5 * (t.depth_m + last.depth_m), time = last.time_s - 0.5 * TICK - left_s;
    near(met_m, left_m * exp(-time / (tau * (1 + ratio))), 0.6 * (last.depth_m - t.depth_m) + tolerance_m);
    assert_true(met_m > 0.2e-3);
    plant_free(p);
}

static void test_recovery(void **state) {
    (void)state;
    recovers(model_file("lumped", "", 10, 20, 10), 0.5, 2, 5e-6);
}

/* All elements of a network being alike it recovers likewise, but for its large turns. */
static void test_recovery_of_network(void **state) {
    (void)state;
    const char *mesh = "\"mesh\": {\"kind\": \"lattice\", \"nodes\": [3, 3, 3], \"size_mm\": [20, 20, 20]},";
    recovers(model_file("network", mesh, 1, 2, 1), 0.5, 2, 2e-5);
}

/* Below the specimen there is a table. */
static void test_table(void **state) {
    plant_settings s = in_air();
    s.specimen = PLANT_MODEL;
    s.model = model_file("lumped", "", 0.1, 0.1, 0.1);
    s.actuator.start_m = s.contact_m = 5e-3;
    plant *p = make(&s);
    plant_truth t = {0};
    (void)state;
    for (int i = 0; i < 2000; i++) {
        t = step(p, 4551, true, NULL);
    }
    near(t.depth_m, 0.95 * 0.02, 2e-5);
    near(t.force_N, 10, 0.2);
    plant_free(p);
}

/* Pressed by more than the friction the plate is at the end of its play; after that friction keeps it while
 * the carriage goes back by the play. */
static void test_backlash(void **state) {
    plant_settings s = in_air();
    s.specimen = PLANT_RIGID;
    s.actuator.start_m = s.contact_m;
    s.actuator.backlash_m = 5e-5;
    plant *p = make(&s);
    plant_truth t = {0};
    (void)state;
    for (int i = 0; i < 1000; i++) {
        t = step(p, 2276, true, NULL); /* 5 N */
    }
    near(t.carriage_m - t.depth_m - s.contact_m, 5e-5, 1e-12);
    double deepest = t.depth_m;
    for (int i = 0; i < 20; i++) {
        t = step(p, -2000, true, NULL);
    }
    assert_true(t.depth_m < 0 && deepest > 0);
    near(t.carriage_m - t.depth_m - s.contact_m, 0, 1e-12);
    plant_free(p);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_rigid_block_and_compliance),
    cmocka_unit_test(test_compliance_of_models),
    cmocka_unit_test(test_lumped_force),
    cmocka_unit_test(test_phantom_is_the_file),
    cmocka_unit_test(test_recovery),
    cmocka_unit_test(test_recovery_of_network),
    cmocka_unit_test(test_table),
    cmocka_unit_test(test_backlash),
    {0},
};
