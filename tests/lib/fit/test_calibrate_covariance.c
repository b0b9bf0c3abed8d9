/* test_calibrate_covariance.c: a calibrated network knows its force as well as the lumped model that it was
 * calibrated to. */
#include "recordings.h"

#include <stdio.h>

enum { SAMPLES = 24, DEPTHS = 40, WORLDS = 30, HELD = 61 };

static const double TRUTH[3] = {8.0, -6.0, 80.0}, NOISE_N = 0.01;

static palp_material truth(void) {
    palp_material m = {.n_arms = 1, .arms = {{2.4, 4.8, 0, 0}}};
    m.law = polynomial(3, TRUTH);
    return m;
}

static palp_lumped_fit fit_once(uint64_t seed) {
    palp_recording r[2];
    for (uint64_t q = 0; q < 2; q++) {
        take t = {truth(), 4.0 + 2.0 * (double)q, 1.0 + (double)q, 15.0, 1.0, 20.0,
                  NOISE_N, "ramp_hold",           500 * seed + q};
        r[q] = prepare(record(&t));
    }
    palp_lumped_fit f = fit(2, r, with_law(polynomial(3, (double[3]){5.0, 1.0, 1.0}), 1));
    free_all(2, r);
    return f;
}

static const palp_mesh_source LATTICE = {.kind = PALP_MESH_LATTICE,
                                         .nodes = {3, 3, 3},
                                         .size_m = {0.024, 0.024, 0.024},
                                         .neighbourhood = PALP_NEIGHBOURS_26};

/* Ramp to a depth in so many seconds, and a dwell. */
static void press(double depth_m, double ramp_s, double hold_s, size_t n, double *time_s, double *at_m) {
    for (size_t i = 0; i < n; i++) {
        double part = (double)i / (double)(n - 1);
        time_s[i] =
            part < 0.5 ? 2.0 * part * ramp_s : ramp_s + hold_s * (2.0 * part - 1.0) * (2.0 * part - 1.0);
        at_m[i] = depth_m * fmin(time_s[i] / ramp_s, 1.0);
    }
}

/* The network's material by both stages, as the lumped model's forces ask for. */
static palp_model calibrated(const palp_model *lumped) {
    palp_model model = {
        .kind = PALP_MODEL_NETWORK, .height_m = 0.024, .material = lumped->material, .mesh = &LATTICE};
    palp_network *network;
    palp_calibration c;
    double depth[DEPTHS], force[DEPTHS], strain, time_s[SAMPLES], at_m[SAMPLES], wanted[SAMPLES];
    ck_assert_int_eq(palp_network_from_model(&model, NULL, 0, NULL, NULL, &network, NULL), PALP_OK);
    for (int i = 0; i < DEPTHS; i++) {
        depth[i] = 6.5e-3 * (i + 1) / DEPTHS;
        strain = depth[i] / 0.024;
        palp_law_force(&lumped->material.law, 1, &strain, &force[i], NULL, NULL);
    }
    palp_static_settings settings = palp_static_settings_default();
    palp_material start = model.material;
    start.n_arms = 0;
    start.law = polynomial(5, (double[5]){0.4, 0.0, 20.0, -10.0, 10.0});
    ck_assert_int_eq(palp_calibrate_static(network, &start, DEPTHS, depth, force, &settings, &c), PALP_OK);
    start = c.material;
    palp_calibration_free(&c);
    start.n_arms = 1;
    start.arms[0] = (palp_arm){.stiffness_N = 0.15, .viscosity_Ns = 0.3};
    press(5e-3, 1.0, 12.0, SAMPLES, time_s, at_m);
    ck_assert_int_eq(palp_lumped_run(&lumped->material, 0.024, SAMPLES, time_s, at_m, wanted), PALP_OK);
    palp_target target = {.n = SAMPLES, .time_s = time_s, .force_N = wanted};
    ck_assert_int_eq(palp_path_ramp_hold(5e-3, 1.0, 12.0, &target.path), PALP_OK);
    palp_relaxation_settings relaxation = palp_relaxation_settings_default();
    ck_assert_int_eq(palp_calibrate_relaxation(network, &start, 1, &target, &relaxation, &c), PALP_OK);
    model.material = c.material;
    palp_calibration_free(&c);
    palp_path_free(&target.path);
    palp_network_free(network);
    return model;
}

/* The network's covariance, by the static curve and the press that were met. */
static void know(const palp_model *lumped, const palp_model *network, double *covariance, double *between) {
    double time_s[2][SAMPLES], depth_m[2][SAMPLES];
    press(5e-3, 1.0, 12.0, SAMPLES, time_s[0], depth_m[0]);
    press(6.5e-3, 1e5, 1.0, SAMPLES, time_s[1], depth_m[1]);
    const palp_forward_run runs[2] = {{.n = SAMPLES, .time_s = time_s[0], .depth_m = depth_m[0]},
                                      {.n = SAMPLES, .time_s = time_s[1], .depth_m = depth_m[1]}};
    palp_error error = {PALP_OK, ""};
    palp_status status = palp_calibrate_covariance(lumped, network, 2, runs, covariance, between, &error);
    ck_assert_msg(status == PALP_OK, "%s", error.text);
}

/* Of a press of another depth and speed: sds of both models, and noisy samples of the truth within the
 * network's band. */
START_TEST(the_network_knows_its_force_as_the_lumped_model_does) {
    double time_s[HELD], depth_m[HELD], force[HELD], sd[2][HELD], wanted[HELD], covariance[49],
        held = 0.0, count = 0.0, plain = 0.0;
    const palp_material truth_of = truth();
    press(5.5e-3, 2.0, 10.0, HELD, time_s, depth_m);
    const palp_forward_run run = {.n = HELD, .time_s = time_s, .depth_m = depth_m};
    ck_assert_int_eq(palp_lumped_run(&truth_of, 0.024, HELD, time_s, depth_m, wanted), PALP_OK);
    for (uint64_t world = 1; world <= WORLDS; world++) {
        uint64_t state = 31 * world;
        palp_lumped_fit f = fit_once(world);
        palp_model lumped = {
            .kind = PALP_MODEL_LUMPED, .height_m = 0.024, .material = f.material, .covariance = f.covariance};
        palp_model network = calibrated(&lumped);
        know(&lumped, &network, covariance, NULL);
        ck_assert_int_eq(palp_forward_band(&lumped, &run, f.covariance, force, sd[0], NULL), PALP_OK);
        ck_assert_int_eq(palp_forward_band(&network, &run, covariance, force, sd[1], NULL), PALP_OK);
        for (int i = 4; i < HELD; i++) {
            double noisy = wanted[i] + NOISE_N * palp_random_normal(&state);
            held += fabs(force[i] - noisy) <= 1.96 * hypot(sd[1][i], NOISE_N);
            plain += fabs(force[i] - wanted[i]) <= 1.96 * sd[1][i];
            count += 1.0;
            ck_assert_double_ge(sd[1][i], 0.8 * sd[0][i]);
            ck_assert_double_le(sd[1][i], hypot(1.2 * sd[0][i], 0.01 * wanted[i]));
        }
        palp_lumped_fit_free(&f);
    }
    printf("the network's band holds %.1f %% of the noisy samples, %.1f %% of the force without noise\n",
           100 * held / count, 100 * plain / count);
    ck_assert_double_ge(held / count, 0.90);
    ck_assert_double_ge(plain / count, 0.88);
    ck_assert_double_le(held / count, 0.99);
}
END_TEST

/* The spread of specimens goes over likewise: of lumped specimens 10 % stiffer or softer, networks whose
 * force is so. */
START_TEST(the_spread_goes_over) {
    double p[5], covariance[25] = {0}, between[25], to[49], to_between[49], time_s[HELD], depth_m[HELD],
                 force[HELD], sd[HELD];
    palp_model lumped = {.kind = PALP_MODEL_LUMPED,
                         .height_m = 0.024,
                         .material = truth(),
                         .covariance = covariance,
                         .between = between};
    ck_assert_int_eq(palp_forward_get(&lumped, p), PALP_OK);
    for (int i = 0; i < 25; i++)
        between[i] = 0.01 * p[i / 5] * p[i % 5];
    palp_model network = calibrated(&lumped);
    know(&lumped, &network, to, to_between);
    press(5.5e-3, 2.0, 10.0, HELD, time_s, depth_m);
    const palp_forward_run run = {.n = HELD, .time_s = time_s, .depth_m = depth_m};
    ck_assert_int_eq(palp_forward_band(&network, &run, to_between, force, sd, NULL), PALP_OK);
    for (int i = 1; i < HELD; i++)
        ck_assert_double_eq_tol(sd[i], 0.1 * force[i], 0.005 * force[HELD / 2]);
    ck_assert_int_eq(palp_calibrate_covariance(&network, &lumped, 1, &run, to, NULL, NULL),
                     PALP_ERR_ARGUMENT);
    lumped.between = NULL;
    ck_assert_int_eq(palp_calibrate_covariance(&lumped, &network, 1, &run, to, to_between, NULL),
                     PALP_ERR_ARGUMENT);
    lumped.covariance = NULL;
    ck_assert_int_eq(palp_calibrate_covariance(&lumped, &network, 1, &run, to, NULL, NULL),
                     PALP_ERR_ARGUMENT);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, the_network_knows_its_force_as_the_lumped_model_does);
    tcase_add_test(tc, the_spread_goes_over);
}
