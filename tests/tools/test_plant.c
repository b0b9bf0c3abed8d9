/* test_plant.c: the simulated indenter against closed forms. */
/* check: valgrind */
#include "force.h"
#include "rig/plant.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <palpate/palpate.h>

static const double TICK = 1e-3;

static plant *make(const plant_settings *settings) {
    plant *p;
    palp_error error = {PALP_OK, ""};
    if (plant_create(settings, &p, &error)) {
        fail_msg("%s", error.text);
    }
    return p;
}

static plant_truth step(plant *p, int duty, bool on, plant_in *in) {
    plant_out out = {.duty = (int16_t)duty, .motor_on = on};
    plant_in unused;
    palp_error error = {PALP_OK, ""};
    if (plant_step(p, &out, in ? in : &unused, &error)) {
        fail_msg("%s", error.text);
    }
    return plant_look(p);
}

static plant_settings in_air(void) {
    plant_settings s = plant_settings_default();
    s.specimen = PLANT_AIR;
    s.sensor.noise_N = 0;
    return s;
}

static void near(double got, double wanted, double tolerance) {
    if (!(fabs(got - wanted) <= tolerance)) {
        fail_msg("%.12g, not %.12g within %g", got, wanted, tolerance);
    }
}

static double z_of(const plant_in *in) {
    force_sensor f;
    force_init(&f);
    return (double)force_axis(&f, in->adc, FORCE_Z);
}

/* ---- motor and carriage ---- */

/* m dv/dt = k V / R - F_c - (b + k^2 / R) v from rest. */
static void test_step_response(void **state) {
    plant_settings s = in_air();
    const plant_actuator *a = &s.actuator;
    plant *p = make(&s);
    const int duty = 2000;
    double drag = a->viscous_Ns_m + a->force_constant_N_A * a->force_constant_N_A / a->resistance_ohm;
    double force = a->force_constant_N_A * a->supply_V * duty / 32767 / a->resistance_ohm - a->coulomb_N;
    (void)state;
    for (int tick = 1; tick <= 100; tick++) {
        plant_truth t = step(p, duty, true, NULL);
        double time = tick * TICK, decay = exp(-drag * time / a->moving_kg);
        near(t.velocity_m_s, force / drag * (1 - decay), 1e-5 * force / drag);
        near(t.carriage_m, a->start_m + force / drag * (time - a->moving_kg / drag * (1 - decay)), 4e-6);
    }
    plant_free(p);
}

/* The driver's limit holds the current until the speed has grown; then back-EMF holds the speed. */
static void test_limit_and_terminal_velocity(void **state) {
    plant_settings s = in_air();
    s.actuator.travel_m = 0.1;
    s.actuator.start_m = 0;
    plant *p = make(&s);
    plant_truth t = step(p, 32767, true, NULL);
    (void)state;
    near(t.current_A, 3.5, 0);
    near(t.velocity_m_s, (42 - 0.15) / 0.4 * TICK, 0.01 * 0.1);
    s.actuator.travel_m = 1;
    plant_free(p);
    p = make(&s);
    for (int tick = 0; tick < 300; tick++) {
        t = step(p, 16384, true, NULL);
    }
    near(t.velocity_m_s, (72 * 16384 / 32767.0 - 0.15) / 40, 1e-6);
    plant_free(p);
}

/* With the motor off only friction brakes: v falls by b v + F_c, and the carriage stays where it stops. */
static void test_coasting_and_stiction(void **state) {
    plant_settings s = in_air();
    plant *p = make(&s);
    plant_truth t = {0};
    (void)state;
    for (int tick = 0; tick < 20; tick++) {
        t = step(p, 4000, true, NULL);
    }
    double v0 = t.velocity_m_s, m = 0.4, b = 4, c = 0.15;
    for (int tick = 1; tick <= 20; tick++) {
        t = step(p, 4000, false, NULL);
        near(t.velocity_m_s, (v0 + c / b) * exp(-b * tick * TICK / m) - c / b, 1e-6);
        near(t.current_A, 0, 0);
    }
    for (int tick = 0; tick < 1000; tick++) {
        t = step(p, 0, false, NULL);
    }
    double rest = t.carriage_m;
    near(t.velocity_m_s, 0, 0);
    int holds = (int)(0.149 / 72 * 32767), moves = (int)(0.16 / 72 * 32767);
    for (int tick = 0; tick < 2000; tick++) {
        t = step(p, tick % 2 ? holds : -holds, true, NULL);
        near(t.carriage_m, rest, 0);
    }
    t = step(p, moves, true, NULL);
    assert_true(t.carriage_m > rest);
    plant_free(p);
}

static void test_stops_switch_and_encoder(void **state) {
    plant_settings s = in_air();
    plant *p = make(&s);
    plant_in in;
    plant_truth t = {0};
    (void)state;
    plant_first(p, &in);
    assert_int_equal(in.position, 0);
    assert_int_equal(in.switches, 0);
    for (int tick = 0; tick < 1000; tick++) {
        t = step(p, -3000, true, &in);
        assert_int_equal((in.switches & PLANT_SWITCH_HOME) != 0, t.carriage_m <= 0);
        assert_int_equal(in.position, (int)floor((t.carriage_m - 5e-3) * 1e6));
    }
    near(t.carriage_m, -1e-3, 0);
    assert_int_equal(in.position, -6000);
    plant_first(p, &in); /* the firmware has restarted, and with it the encoder's counter */
    assert_int_equal(in.position, 0);
    for (int tick = 0; tick < 1000; tick++) {
        t = step(p, 3000, true, &in);
    }
    near(t.carriage_m, 31e-3, 0);
    assert_int_equal(in.position, 32000);
    plant_free(p);
}

/* Winding and case against the closed form of their two nodes, driven against the stop. */
static void test_heating(void **state) {
    plant_settings s = in_air();
    s.actuator.start_m = s.actuator.travel_m;
    const plant_actuator *a = &s.actuator;
    plant *p = make(&s);
    double volt = a->supply_V * 10000 / 32767, power = volt * volt / a->resistance_ohm;
    double w = 1 / (a->winding_K_W * a->winding_J_K); /* rates, 1/s */
    double c = 1 / (a->winding_K_W * a->case_J_K), l = 1 / (a->case_K_W * a->case_J_K);
    double sum = w + c + l, product = w * l, root = sqrt(sum * sum - 4 * product);
    double slow = 0.5 * (sum - root), fast = 0.5 * (sum + root);
    /* rises over the air: case = end (1 - (fast e^-slow t - slow e^-fast t) / (fast - slow)) */
    double end = power * a->case_K_W;
    (void)state;
    for (int tick = 1; tick <= 400000; tick++) {
        plant_truth t = step(p, 10000, true, NULL);
        if (tick % 50000 == 0) {
            double time = tick * TICK, x = exp(-slow * time), y = exp(-fast * time);
            double rise = end * (1 - (fast * x - slow * y) / (fast - slow));
            double rate = end * fast * slow * (x - y) / (fast - slow);
            near(t.case_C, a->ambient_C + rise, 1e-2);
            near(t.winding_C, a->ambient_C + rise + (rate + l * rise) / c, 1e-2);
        }
    }
    plant_free(p);
}

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

/* A model of height 20 mm with one arm, as a file; of a network the figures are each element's. */
static const char *model_file(const char *kind, const char *more, double k, double arm, double b) {
    static char path[4096];
    const char *scratch = getenv("SCRATCH");
    snprintf(path, sizeof path, "%s/one_arm.json", scratch ? scratch : "/tmp");
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file,
            "{\"palpate\": {\"model\": 1}, \"kind\": \"%s\", \"specimen\": {\"height_mm\": 20}, %s\n"
            "\"stiffness\": {\"kind\": \"polynomial\", \"coefficients_N\": [%g]},\n"
            "\"arms\": [{\"stiffness_N\": %g, \"viscosity_Ns\": %g}]}\n",
            kind, more, k, arm, b);
    fclose(file);
    return path;
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

/* ---- effects ---- */

enum { PRESSED = 3600 };

/* Half a count of every channel, as z reads it. */
static double half_count_N(void) {
    force_sensor f;
    double sum = 0;
    force_init(&f);
    for (int i = 0; i < PALP_WIRE_CHANNELS; i++) {
        sum += fabs((double)f.matrix[FORCE_Z][i]);
    }
    return 0.5 * sum + 3e-6;
}

static double smooth(double x) {
    x = fmin(fmax(x, 0), 1);
    return x * x * x * (10 + x * (6 * x - 15));
}

/* Ramp, hold and withdrawal, twice and the second time deeper: between 1 mm above contact and so deep. */
static double path_m(double time_s) {
    double first = smooth(time_s / 0.6) - smooth((time_s - 1) / 0.6);
    double second = smooth((time_s - 1.7) / 0.6) - smooth((time_s - 2.8) / 0.6);
    return -1e-3 + 4e-3 * first + 5e-3 * second;
}

typedef struct effect_case {
    const char *effect;          /* its id, and its parameters in JSON */
    double slack_N, slowest_m_s; /* what else it may be off by; not compared where it moves slower */
} effect_case;

/* What the sensor of a plant on a model reads along that path, read by an encoder of a nanometre, is what the
 * library gives for the depths of the encoder. */
static void reads_as_the_library(const char *file, const effect_case *c) {
    static double time[PRESSED + 1], depth[PRESSED + 1], read[PRESSED + 1], force[PRESSED + 1];
    const palp_forward_run run = {.n = PRESSED + 1, .time_s = time, .depth_m = depth};
    plant_settings s = in_air();
    palp_error error = {PALP_OK, ""};
    palp_model model;
    palp_mesh_source mesh;
    plant_in in;
    s.specimen = PLANT_MODEL;
    s.model = file;
    s.actuator.count_m = 1e-9;
    s.actuator.start_m = s.contact_m - 1e-3;
    plant *p = make(&s);
    plant_first(p, &in);
    double integral = 0;
    for (int i = 0; i <= PRESSED; i++) {
        plant_truth t = plant_look(p);
        time[i] = i * TICK;
        depth[i] = 1e-9 * in.position - 1e-3;
        read[i] = z_of(&in);
        double miss = path_m(time[i] + TICK) - (t.carriage_m - s.contact_m);
        integral += 4e5 * miss * TICK;
        double push = 20000 * miss + integral - 100 * t.velocity_m_s;
        step(p, (int)(fmin(fmax(push / 72, -0.5), 0.5) * 32767), true, &in);
    }
    plant_free(p);
    assert_int_equal(palp_model_read(file, &model, &mesh, &error), PALP_OK);
    palp_status status = model.kind == PALP_MODEL_LUMPED
                             ? palp_forward_force(&model, &run, force, NULL, &error)
                             : palp_forward_network(&model, NULL, &run, force, &error);
    assert_int_equal(status, PALP_OK);
    for (int i = 1; i <= PRESSED; i++) {
        bool slow = fabs(depth[i] - depth[i - 1]) < c->slowest_m_s * TICK;
        if (!slow && !(fabs(read[i] - force[i]) <= half_count_N() + c->slack_N)) {
            fail_msg("%s: at %g s, %g mm it reads %g N, not %g", c->effect, time[i], 1e3 * depth[i], read[i],
                     force[i]);
        }
    }
}

static const char *with_effect(const char *kind, const char *mesh, const char *effect, double k, double b) {
    char more[1024], id[64];
    size_t length = strcspn(effect, " ");
    snprintf(id, sizeof id, "%.*s", (int)length, effect);
    snprintf(more, sizeof more, "%s \"effects\": [{\"id\": \"%s\", \"parameters\": {%s}}],", mesh, id,
             effect + length);
    return model_file(kind, more, k, k, b);
}

/* But for session_ageing, which takes hours. */
static void test_effects_of_lumped(void **state) {
    static const effect_case effects[] = {
        {"relaxation_arm \"stiffness_N\": 4, \"time_s\": 0.2", 0, 0},
        {"power_law_relaxation \"stiffness_N\": 2, \"exponent\": 0.3", 0, 0},
        {"strain_dependent_arm \"stiffness_per_strain\": 2, \"time_per_strain\": 1", 0, 0},
        {"rate_stiffening \"per_decade\": 0.02", 0, 1e-3},
        {"damage_softening \"softening\": 0.4, \"sharpness\": 0.5", 0, 0},
        {"permanent_set \"fraction\": 0.3", 0, 0},
        {"poroelastic \"stiffness_N\": 3, \"time_s\": 2", 0, 0},
        {"contact_offset \"offset_mm\": 0.3", 0, 0},
        {"toe_region \"length_mm\": 0.5", 0, 0},
        {"adhesion \"force_N\": 0.2", 0, 0},
        {"frame_compliance \"compliance_mm_N\": 0.1", 0, 0},
        {"plate_inertia \"mass_kg\": 0.05", 6e-4, 1e-3},
        {"coulomb_friction \"force_N\": 0.1", 0, 1e-3},
        {"sensor_lag \"time_s\": 0.05", 0, 0},
        {"sensor_bias \"force_N\": 0.3", 0, 0},
        {"sensor_drift \"force_N_s\": 0.05", 0, 0},
        {"sensor_gain \"gain\": 0.1", 0, 0},
        {"force_saturation \"force_N\": 1.2", 0, 0},
        {"mains_hum \"amplitude_N\": 0.1, \"frequency_Hz\": 48", 0, 0},
        {"drive_ripple \"amplitude_N\": 0.05, \"period_mm\": 0.7, \"phase_rad\": 1", 0, 0},
    };
    (void)state;
    for (size_t i = 0; i < sizeof effects / sizeof effects[0]; i++) {
        reads_as_the_library(with_effect("lumped", "", effects[i].effect, 10, 5), &effects[i]);
    }
}

static void test_effects_of_network(void **state) {
    static const char mesh[] =
        "\"mesh\": {\"kind\": \"lattice\", \"nodes\": [3, 3, 3], \"size_mm\": [20, 20, 20]},";
    static const effect_case effects[] = {{"damage_softening \"softening\": 0.4, \"sharpness\": 0.5", 0, 0},
                                          {"adhesion \"force_N\": 0.2", 0, 0},
                                          {"plate_slip \"slip\": 0.8", 0, 0},
                                          {"frame_compliance \"compliance_mm_N\": 0.1", 0, 0},
                                          {"coulomb_friction \"force_N\": 0.1", 0, 1e-3}};
    (void)state;
    for (size_t i = 0; i < sizeof effects / sizeof effects[0]; i++) {
        reads_as_the_library(with_effect("network", mesh, effects[i].effect, 0.3, 0.15), &effects[i]);
    }
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

/* ---- sensor ---- */

/* The inverse of the matrix, to half a count a channel; at rest there is 0.1 N sideways. */
static void test_sensor_inverse(void **state) {
    force_sensor f;
    plant_settings s = in_air();
    plant_in in;
    (void)state;
    force_init(&f);
    for (double bias = -24; bias <= 24; bias += 0.37) {
        s.sensor.bias_N = bias;
        plant *p = make(&s);
        plant_first(p, &in);
        for (uint8_t axis = 0; axis < FORCE_AXES; axis++) {
            double half = 0;
            for (int i = 0; i < PALP_WIRE_CHANNELS; i++) {
                half += 0.5 * fabs((double)f.matrix[axis][i]);
            }
            double wanted = axis == FORCE_Z ? bias : axis == 0 ? 0.1 : 0;
            near((double)force_axis(&f, in.adc, axis), wanted, half + 3e-6);
        }
        plant_free(p);
    }
}

static void test_noise_drift_hum(void **state) {
    enum { N = 20000 };
    plant_settings s = in_air();
    double mean = 0, square = 0, sine = 0, cosine = 0;
    (void)state;
    s.sensor = (plant_sensor){
        .noise_N = 5e-3, .hum_N = 0.02, .bias_N = 0.5, .drift_N_s = 0.01, .gain = 1, .seed = 3};
    plant *p = make(&s);
    for (int i = 0; i < N; i++) {
        plant_in in;
        double time = step(p, 0, false, &in).time_s, z = z_of(&in) - 0.5 - 0.01 * time;
        double angle = 2 * 3.14159265358979323846 * 50 * time;
        sine += 2 * z * sin(angle) / N;
        cosine += 2 * z * cos(angle) / N;
        z -= 0.02 * sin(angle);
        mean += z / N;
        square += z * z / N;
    }
    near(sine, 0.02, 4 * 5e-3 * sqrt(2.0 / N));
    near(cosine, 0, 4 * 5e-3 * sqrt(2.0 / N));
    near(mean, 0, 4 * 5e-3 / sqrt(N));
    near(sqrt(square), 5e-3, 5e-3 * 4 / sqrt(2.0 * N));
    plant_free(p);
}

static void test_range_and_rails(void **state) {
    plant_settings s = in_air();
    plant_in in;
    (void)state;
    s.sensor.range_N = 4;
    s.sensor.bias_N = 9;
    plant *p = make(&s);
    plant_first(p, &in);
    near(z_of(&in), 4, 2e-3);
    assert_false(force_saturated(in.adc));
    plant_free(p);
    s.sensor.range_N = 0;
    s.sensor.bias_N = -90;
    p = make(&s);
    plant_first(p, &in);
    assert_true(force_saturated(in.adc));
    assert_int_equal(in.adc[0], INT16_MIN);
    plant_free(p);
}

/* No reading is beyond the range by more than rounding, however noisy; half of them stand at it. */
static void test_range_clips_noise(void **state) {
    enum { N = 1000 };
    plant_settings s = in_air();
    int at_end = 0;
    (void)state;
    s.sensor = (plant_sensor){.noise_N = 0.05, .bias_N = 4, .range_N = 4, .gain = 1, .seed = 5};
    plant *p = make(&s);
    for (int i = 0; i < N; i++) {
        plant_in in;
        step(p, 0, false, &in);
        double z = z_of(&in);
        assert_true(z <= 4 + half_count_N());
        at_end += z >= 4 - half_count_N();
    }
    assert_in_range(at_end, N / 2 - 60, N / 2 + 60);
    plant_free(p);
}

/* 10 kOhm at 25 C is the middle of the divider; 25/85: R falls by exp(B (1/T0 - 1/T)). */
static void test_thermistor(void **state) {
    static const double celsius[] = {-20, 0, 25, 50, 85, 110};
    (void)state;
    for (size_t i = 0; i < 6; i++) {
        plant_settings s = in_air();
        plant_in in;
        s.actuator.ambient_C = celsius[i];
        plant *p = make(&s);
        plant_first(p, &in);
        double ohm = 1e4 * in.thermistor / (4095.0 - in.thermistor),
               half = 1e4 * 0.5 * 4095 / pow(4095.0 - in.thermistor, 2);
        double exact = 1e4 * exp(3950 * (1 / (celsius[i] + 273.15) - 1 / 298.15));
        near(ohm, exact, 1.01 * half);
        plant_free(p);
    }
}

/* ---- faults, repetition, files ---- */

static void test_faults(void **state) {
    plant_settings s = in_air();
    plant_in in;
    plant *p = make(&s);
    (void)state;
    plant_first(p, &in);
    plant_inject(p, PLANT_OBSTACLE);
    step(p, 0, false, &in);
    assert_true(z_of(&in) > 24 && !force_saturated(in.adc));
    plant_lift(p, PLANT_OBSTACLE);
    plant_inject(p, PLANT_SATURATED);
    step(p, 0, false, &in);
    assert_true(force_saturated(in.adc) && z_of(&in) < 24);
    plant_lift(p, PLANT_SATURATED);
    plant_inject(p, PLANT_SILENT);
    plant_inject(p, PLANT_EMERGENCY);
    step(p, 0, false, &in);
    assert_int_equal(in.switches, PLANT_SENSOR_SILENT | PLANT_SWITCH_EMERGENCY);
    plant_lift(p, PLANT_SILENT);
    plant_lift(p, PLANT_EMERGENCY);
    plant_inject(p, PLANT_JUMP);
    step(p, 0, false, &in);
    assert_int_equal(in.switches, 0);
    assert_int_equal(in.position, 5000);
    plant_inject(p, PLANT_JAMMED);
    plant_truth t = step(p, 10000, true, &in);
    assert_int_equal(in.position, 5000);
    near(t.current_A, 24 * 10000 / 32767.0 / 4, 1e-9);
    plant_inject(p, PLANT_PUSHED);
    for (int i = 0; i < 200; i++) {
        int32_t before = in.position;
        t = step(p, -10000, true, &in);
        assert_true(in.position - before <= 201);
    }
    near(t.carriage_m, 30.5e-3, 2e-5);
    plant_inject(p, PLANT_HOT);
    t = step(p, 0, false, &in);
    near(t.winding_C, 120, 0.01);
    near(t.case_C, 120, 0.01);
    plant_free(p);
}

/* The same settings and outputs give the same records to the bit. */
static void test_repeats(void **state) {
    plant_settings s = plant_settings_default();
    s.sensor.hum_N = 0.01;
    s.actuator.start_m = 0.011;
    plant *p = make(&s), *q = make(&s);
    s.sensor.seed = 2;
    plant *other = make(&s);
    plant_in a, b, c;
    int differ = 0;
    (void)state;
    for (int i = 0; i < 1000; i++) {
        int duty = 1500 - 2 * i;
        step(p, duty, true, &a);
        step(q, duty, true, &b);
        step(other, duty, true, &c);
        assert_memory_equal(&a, &b, sizeof a);
        differ += memcmp(&a, &c, sizeof a) != 0;
    }
    assert_true(differ > 900);
    plant_free(p);
    plant_free(q);
    plant_free(other);
}

static void test_actuator_file(void **state) {
    static const struct {
        const char *text, *says; /* NULL: good */
    } cases[] = {
        {"{\"palpate\": {\"actuator\": 1},\n \"moving_kg\": 0.1, \"travel_mm\": 20, \"count_mm\": 2e-3, "
         "\"about\": \"x\"}",
         NULL},
        {"{\"palpate\": {\"actuator\": 1},\n \"moving_kg\": 0}", ":2: moving_kg must be a positive number"},
        {"{\"palpate\": {\"actuator\": 1},\n\n \"coulomb_N\": -1}",
         ":3: coulomb_N must be a number, 0 or more"},
        {"{\"palpate\": {\"actuator\": 1},\n \"mass_kg\": 1}", ":2: mass_kg is not a key"},
        {"{\"palpate\": {\"actuator\": 1},\n \"moving_kg\": }", ":2: "},
        {"{\"palpate\": {\"actuator\": 1},\n \"start_mm\": 40}", ":2: start_mm is beyond the travel"},
        {"{\"palpate\": {\"model\": 1}}", ":1: is no actuator"},
        {"[]", ":1: is no actuator"},
    };
    char path[4096];
    const char *scratch = getenv("SCRATCH");
    (void)state;
    snprintf(path, sizeof path, "%s/actuator.json", scratch ? scratch : "/tmp");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        plant_actuator a = plant_actuator_default(), same = a;
        palp_error error = {PALP_OK, ""};
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        fputs(cases[i].text, file);
        fclose(file);
        palp_status status = plant_actuator_read(path, &a, &error);
        if (!cases[i].says) {
            assert_int_equal(status, PALP_OK);
            near(a.travel_m, 0.02, 1e-15);
            near(a.count_m, 2e-6, 1e-18);
            near(a.moving_kg, 0.1, 0);
            near(a.viscous_Ns_m, 4, 0);
            continue;
        }
        assert_int_equal(status, PALP_ERR_INPUT);
        assert_memory_equal(&a, &same, sizeof a);
        if (strncmp(error.text, path, strlen(path)) != 0 || !strstr(error.text, cases[i].says)) {
            fail_msg("\"%s\" lacks \"%s\"", error.text, cases[i].says);
        }
    }
    plant_actuator weak = plant_actuator_default();
    assert_int_equal(plant_actuator_read("data/rig/phantom_premium.json", &weak, NULL), PALP_OK);
    near(weak.force_constant_N_A, 3, 0);
    remove(path);
    assert_int_equal(plant_actuator_read(path, &(plant_actuator){0}, NULL), PALP_ERR_FILE);
}

static void test_bad_models(void **state) {
    plant_settings s = plant_settings_default();
    palp_error error = {PALP_OK, ""};
    plant *p;
    (void)state;
    s.model = "no/such/model.json";
    assert_int_equal(plant_create(&s, &p, &error), PALP_ERR_FILE);
    assert_null(p);
    assert_non_null(strstr(error.text, "no/such/model.json"));
    s.model = model_file("lumped", "\"formulation\": \"sedef2008\",", 1, 1, 1);
    assert_int_equal(plant_create(&s, &p, &error), PALP_ERR_UNSUPPORTED);
    assert_non_null(strstr(error.text, s.model));
    assert_non_null(strstr(error.text, "sedef2008"));
    plant_free(NULL);
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_step_response),
    cmocka_unit_test(test_limit_and_terminal_velocity),
    cmocka_unit_test(test_coasting_and_stiction),
    cmocka_unit_test(test_stops_switch_and_encoder),
    cmocka_unit_test(test_heating),
    cmocka_unit_test(test_rigid_block_and_compliance),
    cmocka_unit_test(test_compliance_of_models),
    cmocka_unit_test(test_lumped_force),
    cmocka_unit_test(test_phantom_is_the_file),
    cmocka_unit_test(test_recovery),
    cmocka_unit_test(test_recovery_of_network),
    cmocka_unit_test(test_effects_of_lumped),
    cmocka_unit_test(test_effects_of_network),
    cmocka_unit_test(test_table),
    cmocka_unit_test(test_backlash),
    cmocka_unit_test(test_sensor_inverse),
    cmocka_unit_test(test_noise_drift_hum),
    cmocka_unit_test(test_range_and_rails),
    cmocka_unit_test(test_range_clips_noise),
    cmocka_unit_test(test_thermistor),
    cmocka_unit_test(test_faults),
    cmocka_unit_test(test_repeats),
    cmocka_unit_test(test_actuator_file),
    cmocka_unit_test(test_bad_models),
    {0},
};
