/* test_plant.c: the simulated indenter's motor and carriage against closed forms; faults, repetition and
 * files. */
/* check: valgrind */
#include "plant_make.h"

#include <string.h>

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
    cmocka_unit_test(test_faults),
    cmocka_unit_test(test_repeats),
    cmocka_unit_test(test_actuator_file),
    cmocka_unit_test(test_bad_models),
    {0},
};
