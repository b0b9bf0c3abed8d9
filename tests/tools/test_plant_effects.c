/* test_plant_effects.c: what the simulated indenter reads of a specimen with effects, against the library. */
#include "plant_make.h"

#include <string.h>

enum { PRESSED = 3600 };

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

/* The plant's sensor on a model with an encoder of a nanometre reads what the library gives for the encoder's
 * depths. */
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
        {"adhesion \"force_N\": 0.2, \"reach_mm\": 0.4", 0, 0},
        {"frame_compliance \"compliance_mm_N\": 0.1", 0, 0},
        {"plate_inertia \"mass_kg\": 0.05", 6e-4, 1e-3},
        {"coulomb_friction \"force_N\": 0.1", 1.7e-3,
         1e-3}, /* it fades below 1e-3 of 16 mm/s, which the plant has yet to see */
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
                                          {"adhesion \"force_N\": 0.05, \"reach_mm\": 0.4", 0, 0},
                                          {"plate_slip \"slip\": 0.8", 0, 0},
                                          {"frame_compliance \"compliance_mm_N\": 0.1", 0, 0},
                                          {"coulomb_friction \"force_N\": 0.1", 1.7e-3, 1e-3}};
    (void)state;
    for (size_t i = 0; i < sizeof effects / sizeof effects[0]; i++) {
        reads_as_the_library(with_effect("network", mesh, effects[i].effect, 0.3, 0.15), &effects[i]);
    }
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_effects_of_lumped),
    cmocka_unit_test(test_effects_of_network),
    {0},
};
