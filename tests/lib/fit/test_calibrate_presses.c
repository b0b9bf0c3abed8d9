/* test_calibrate_presses.c: a network's own forces under spheres and its plate give back its law, its arms
 * and its Poisson's ratio from a guess far off. */
#include <palpate/calibrate.h>

#include <check.h>
#include <math.h>
#include <string.h>

enum { SAMPLES = 16, TARGETS = 3 };
static const double SIDE = 0.024, DEPTH = 0.002;

typedef struct curve {
    double time[SAMPLES], depth[SAMPLES], force[SAMPLES];
} curve;

static palp_mesh *cube(void) {
    const size_t nodes[3] = {4, 4, 4};
    const double size[3] = {SIDE, SIDE, SIDE};
    palp_mesh *mesh;
    ck_assert_int_eq(palp_mesh_lattice(nodes, size, PALP_NEIGHBOURS_26, &mesh), PALP_OK);
    ck_assert_int_eq(palp_mesh_scale(mesh, PALP_SCALING_CONTINUUM, SIDE * SIDE, NULL), PALP_OK);
    return mesh;
}

static palp_model network(double k0, double k2, double ratio, double arm, double time) {
    palp_model model = {.kind = PALP_MODEL_NETWORK, .poisson_ratio = ratio};
    const double c[3] = {k0, 0.0, k2};
    ck_assert_int_eq(palp_law_polynomial(3, c, &model.material.law), PALP_OK);
    model.material.n_arms = arm > 0;
    model.material.arms[0] = (palp_arm){arm, arm * time, 0, 0};
    return model;
}

/* Plate, sphere of 6 mm, sphere of 12 mm: a ramp of 1 s, then a dwell. */
static void set_targets(bool relaxed, curve *c, palp_press_target *target) {
    const double radius[TARGETS] = {0, 0.006, 0.012};
    for (size_t t = 0; t < TARGETS; t++) {
        for (int i = 0; i < SAMPLES; i++) {
            c[t].time[i] = i < 9 ? i / 8.0 : 1 + (i - 8) * (i - 8) / 8.0;
            c[t].depth[i] = relaxed ? DEPTH * (i + 1) / SAMPLES : DEPTH * fmin(c[t].time[i], 1);
        }
        target[t] = (palp_press_target){.plate = t == 0,
                                        .tool = {.shape = PALP_TOOL_SPHERE,
                                                 .position_m = {SIDE / 2, SIDE + radius[t], SIDE / 2},
                                                 .radius_m = radius[t]},
                                        .relaxed = relaxed,
                                        .n = SAMPLES,
                                        .time_s = c[t].time,
                                        .depth_m = c[t].depth,
                                        .force_N = c[t].force};
    }
}

/* Forces by the public functions, step by step. */
static void press(const palp_model *model, const palp_mesh *mesh, const palp_press_target *target,
                  double *force) {
    const palp_contact_settings contact = palp_contact_settings_default();
    palp_support supports[2];
    palp_network *net;
    palp_tool_force felt;
    palp_supports_default(supports);
    ck_assert_int_eq(palp_network_from_model(model, mesh, target->plate ? 2 : 1, supports, NULL, &net, NULL),
                     PALP_OK);
    if (!target->plate)
        ck_assert_int_eq(palp_network_enable_tools(net, 1, 0, &contact), PALP_OK);
    for (size_t i = 0; i < target->n; i++) {
        double dt = i ? target->time_s[i] - target->time_s[i - 1] : 0;
        palp_tool tool = target->tool;
        tool.position_m[1] -= target->depth_m[i];
        if (!target->plate)
            ck_assert_int_eq(palp_network_set_tools(net, 1, &tool), PALP_OK);
        ck_assert_int_eq(palp_network_step(net, target->plate ? target->depth_m[i] : 0,
                                           target->relaxed ? INFINITY : dt, NULL),
                         PALP_OK);
        if (!target->plate)
            ck_assert_int_eq(palp_network_tool_force(net, &felt), PALP_OK);
        force[i] = target->plate ? palp_network_force(net) : felt.force_N[1];
    }
    palp_network_free(net);
}

static double stiffness(const palp_model *model, double strain) {
    double k;
    palp_law_stiffness(&model->material.law, strain, &k, NULL);
    return k;
}

#define NEAR(got, want, to)                                                                                  \
    ck_assert_msg(fabs((got) - (want)) <= (to)*fabs(want), "%s is %.6g, not %.6g", #got, (got), (want))

START_TEST(spheres_and_a_plate_give_law_and_ratio) {
    palp_mesh *mesh = cube();
    palp_model truth = network(5, 60, 0.42, 0, 0), guess = network(300, 0, 0, 0, 0);
    palp_presses_settings settings = palp_presses_settings_default();
    palp_press_target target[TARGETS];
    curve c[TARGETS];
    palp_calibration result;
    set_targets(true, c, target);
    for (size_t t = 0; t < TARGETS; t++)
        press(&truth, mesh, &target[t], c[t].force);
    settings.fit_poisson = true;
    ck_assert_int_eq(palp_calibrate_presses(&guess, mesh, TARGETS, target, &settings, &result), PALP_OK);
    ck_assert(result.converged);
    NEAR(guess.poisson_ratio, 0.42, 0.01);
    NEAR(stiffness(&guess, 0), 5.0, 0.01);
    NEAR(stiffness(&guess, 0.1), 5.6, 0.01);
    for (size_t i = 0; i < result.n_samples; i++)
        ck_assert_msg(fabs(result.force_N[i] - result.target_N[i]) < 1e-3 * c[i / SAMPLES].force[SAMPLES - 1],
                      "force %zu is %g for %g", i, result.force_N[i], result.target_N[i]);
    palp_calibration_free(&result);
    palp_mesh_free(mesh);
}
END_TEST

START_TEST(spheres_alone_give_law_and_arms) {
    palp_mesh *mesh = cube();
    palp_model truth = network(5, 60, 0.4, 8, 0.7), guess = network(1, 0, 0.4, 1, 3);
    const palp_presses_settings settings = palp_presses_settings_default();
    palp_press_target target[TARGETS];
    curve c[TARGETS];
    palp_calibration result;
    set_targets(false, c, target);
    for (size_t t = 1; t < TARGETS; t++)
        press(&truth, mesh, &target[t], c[t].force);
    ck_assert_int_eq(palp_calibrate_presses(&guess, mesh, 2, target + 1, &settings, &result), PALP_OK);
    const palp_arm *arm = &guess.material.arms[0];
    NEAR(stiffness(&guess, 0), 5.0, 0.03);
    NEAR(arm->stiffness_N, 8.0, 0.02);
    NEAR(arm->viscosity_Ns / arm->stiffness_N, 0.7, 0.02);
    ck_assert_double_eq(guess.poisson_ratio, 0.4);
    palp_calibration_free(&result);
    palp_mesh_free(mesh);
}
END_TEST

/* The law, a stiff quarter and a soft one beside each other, from a plate and a sphere over each quarter. */
START_TEST(regions_from_presses_above_them) {
    static const double STIFFNESS[2] = {6.0, 0.3};
    static palp_mesh_source source;
    palp_mesh *mesh = cube();
    palp_presses_settings settings = palp_presses_settings_default();
    palp_press_target target[TARGETS];
    curve c[TARGETS];
    palp_calibration result;
    palp_model truth = network(5, 60, 0.4, 0, 0), guess = network(8, 0, 0.4, 0, 0);
    truth.mesh = guess.mesh = &source;
    source.n_regions = 2;
    for (int r = 0; r < 2; r++) {
        palp_region *region = &source.regions[r];
        *region = (palp_region){.shape = PALP_REGION_BOX,
                                .low_m = {r ? SIDE / 2 : 0, SIDE / 3, 0},
                                .high_m = {r ? SIDE : SIDE / 2, SIDE, SIDE},
                                .stiffness = STIFFNESS[r]};
        strcpy(region->name, r ? "right" : "left");
        ck_assert_int_eq(palp_region_place_in(mesh, region, NULL), PALP_OK);
    }
    set_targets(true, c, target);
    for (size_t t = 0; t < TARGETS; t++) {
        target[t].tool.position_m[0] = t == 1 ? 0.3 * SIDE : 0.7 * SIDE;
        press(&truth, mesh, &target[t], c[t].force);
    }
    for (int r = 0; r < 2; r++) {
        source.regions[r].stiffness = 1.0;
        settings.fit_region[r] = true;
    }
    ck_assert_int_eq(palp_calibrate_presses(&guess, mesh, TARGETS, target, &settings, &result), PALP_OK);
    ck_assert(result.converged);
    NEAR(stiffness(&guess, 0), 5.0, 0.02);
    NEAR(stiffness(&guess, 0.1), 5.6, 0.02);
    for (int r = 0; r < 2; r++) {
        NEAR(result.region_stiffness[r], STIFFNESS[r], 0.02);
        ck_assert_double_eq(source.regions[r].stiffness, 1.0);
    }
    palp_calibration_free(&result);
    settings.fit_region[2] = true;
    ck_assert_int_eq(palp_calibrate_presses(&guess, mesh, TARGETS, target, &settings, &result),
                     PALP_ERR_ARGUMENT);
    palp_mesh_free(mesh);
}
END_TEST

START_TEST(what_cannot_be_met_is_refused) {
    palp_mesh *mesh = cube();
    palp_model model = network(5, 0, 0, 0, 0);
    palp_presses_settings settings = palp_presses_settings_default();
    palp_press_target target[TARGETS];
    curve c[TARGETS];
    palp_calibration result;
    memset(c, 0, sizeof c);
    set_targets(true, c, target);
    ck_assert_int_eq(palp_calibrate_presses(&model, mesh, 0, target, &settings, &result), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_calibrate_presses(&model, mesh, 1, target, &settings, &result), PALP_ERR_ARGUMENT);
    for (int i = 0; i < SAMPLES; i++)
        c[0].force[i] = 1 + i;
    c[0].depth[3] = NAN;
    ck_assert_int_eq(palp_calibrate_presses(&model, mesh, 1, target, &settings, &result), PALP_ERR_ARGUMENT);
    model.density_kg_m3 = 1000;
    ck_assert_int_eq(palp_calibrate_presses(&model, mesh, 1, target, &settings, &result),
                     PALP_ERR_UNSUPPORTED);
    palp_mesh_free(mesh);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, spheres_and_a_plate_give_law_and_ratio);
    tcase_add_test(tc, spheres_alone_give_law_and_arms);
    tcase_add_test(tc, regions_from_presses_above_them);
    tcase_add_test(tc, what_cannot_be_met_is_refused);
}
