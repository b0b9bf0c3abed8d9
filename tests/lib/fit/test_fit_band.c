/* test_fit_band.c: how well a model knows a force: the band of a press by the fit's covariance. */
#include "recordings.h"

#include <stdio.h>
#include <string.h>

enum { SAMPLES = 60, REPEATS = 60 };

static const double TRUTH[3] = {8.0, -6.0, 80.0};

static palp_material truth(void) {
    palp_material m = {.n_arms = 1, .arms = {{2.4, 4.8, 0, 0}}};
    m.law = polynomial(3, TRUTH);
    return m;
}

static palp_lumped_fit fit_once(uint64_t seed) {
    palp_recording r[3];
    for (uint64_t q = 0; q < 3; q++) {
        take t = {truth(), 3.0 + 2.0 * (double)q, 1.0 + (double)q, 15.0, 1.0, 50.0,
                  0.01,    "ramp_hold",           1000 * seed + q};
        r[q] = prepare(record(&t));
    }
    palp_lumped_fit f = fit(3, r, with_law(polynomial(3, (double[3]){5.0, 1.0, 1.0}), 1));
    free_all(3, r);
    return f;
}

/* A press of another depth and speed than those of the fit, with an unloading in it. */
static void press(double *time_s, double *depth_m) {
    for (int i = 0; i < SAMPLES; i++) {
        time_s[i] = 0.4 * i;
        depth_m[i] = 1e-3 * fmin(6.0, fmin(3.0 * time_s[i], fmax(2.0, 6.0 - 0.4 * (time_s[i] - 12.0))));
    }
}

static palp_model model_of(const palp_lumped_fit *f) {
    return (palp_model){.kind = PALP_MODEL_LUMPED, .height_m = 0.024, .material = f->material};
}

/* sd^2 = sum over a, b of dF/da C_ab dF/db, with derivatives by differences of whole presses. */
START_TEST(the_band_is_that_of_the_derivatives) {
    double time_s[SAMPLES], depth_m[SAMPLES], force[SAMPLES], sd[SAMPLES], by[5][SAMPLES], low[SAMPLES], p[5];
    palp_lumped_fit f = fit_once(7);
    palp_model m = model_of(&f);
    press(time_s, depth_m);
    const palp_forward_run run = {.n = SAMPLES, .time_s = time_s, .depth_m = depth_m};
    ck_assert_uint_eq(f.n_parameters, 5);
    ck_assert_uint_eq(palp_forward_parameter_count(&m), 5);
    ck_assert_int_eq(palp_forward_band(&m, &run, f.covariance, force, sd, NULL), PALP_OK);
    ck_assert_int_eq(palp_forward_get(&m, p), PALP_OK);
    for (int k = 0; k < 5; k++) {
        double h = 1e-5 * fabs(p[k]), own = p[k];
        palp_model moved = m;
        p[k] = own - h;
        ck_assert_int_eq(palp_forward_set(&moved, p), PALP_OK);
        ck_assert_int_eq(palp_forward_force(&moved, &run, low, NULL, NULL), PALP_OK);
        p[k] = own + h;
        ck_assert_int_eq(palp_forward_set(&moved, p), PALP_OK);
        ck_assert_int_eq(palp_forward_force(&moved, &run, by[k], NULL, NULL), PALP_OK);
        p[k] = own;
        for (int i = 0; i < SAMPLES; i++)
            by[k][i] = (by[k][i] - low[i]) / (2 * h);
    }
    for (int i = 1; i < SAMPLES; i++) {
        double sum = 0.0;
        for (int a = 0; a < 5; a++)
            for (int b = 0; b < 5; b++)
                sum += by[a][i] * by[b][i] * f.covariance[a * 5 + b];
        ck_assert_double_eq_tol(sd[i], sqrt(sum), 1e-4 * sqrt(sum));
        ck_assert_double_gt(sd[i], 0.0);
    }
    palp_lumped_fit_free(&f);
}
END_TEST

/* Of many fits to other noise, how often the band holds the force without noise: of a press that no fit saw,
 * and of K(e). */
START_TEST(the_band_covers) {
    double time_s[SAMPLES], depth_m[SAMPLES], force[SAMPLES], sd[SAMPLES], wanted[SAMPLES];
    double strain[8], k[8], k_sd[8], known, count = 0.0, covered = 0.0, law_count = 0.0, law_covered = 0.0;
    press(time_s, depth_m);
    palp_material m = truth();
    ck_assert_int_eq(palp_lumped_run(&m, 0.024, SAMPLES, time_s, depth_m, wanted), PALP_OK);
    for (uint64_t seed = 1; seed <= REPEATS; seed++) {
        palp_lumped_fit f = fit_once(seed);
        palp_model model = model_of(&f);
        const palp_forward_run run = {.n = SAMPLES, .time_s = time_s, .depth_m = depth_m};
        ck_assert_int_eq(palp_forward_band(&model, &run, f.covariance, force, sd, NULL), PALP_OK);
        for (int i = 1; i < SAMPLES; i++) {
            covered += fabs(force[i] - wanted[i]) <= 1.96 * sd[i];
            count += 1.0;
        }
        for (int i = 0; i < 8; i++)
            strain[i] = 7.0 / 24.0 * i / 7.0;
        ck_assert_int_eq(palp_lumped_fit_stiffness(&f, 8, strain, k, k_sd), PALP_OK);
        for (int i = 0; i < 8; i++) {
            palp_law_stiffness(&m.law, strain[i], &known, NULL);
            law_covered += fabs(k[i] - known) <= 1.96 * k_sd[i];
            law_count += 1.0;
        }
        palp_lumped_fit_free(&f);
    }
    printf("the band holds the force of a press not seen in %.1f %%, K(e) in %.1f %%\n",
           100 * covered / count, 100 * law_covered / law_count);
    ck_assert_double_ge(covered / count, 0.90); /* 95 % of 60 fits whose samples go together: +- 3 % */
    ck_assert_double_le(covered / count, 0.995);
    ck_assert_double_ge(law_covered / law_count, 0.90);
    ck_assert_double_le(law_covered / law_count, 0.995);
}
END_TEST

START_TEST(what_has_no_band_is_refused) {
    double strain[1] = {0.1}, k[1], sd[1];
    palp_recording r;
    take t = {truth(), 5.0, 1.0, 15.0, 1.0, 50.0, 0.01, "ramp_hold", 3};
    r = prepare(record(&t));
    palp_lumped_fit f = fit(1, &r, with_arms(1));
    ck_assert_int_eq(palp_lumped_fit_stiffness(&f, 1, strain, k, sd),
                     PALP_ERR_ARGUMENT); /* a spring for each run */
    palp_lumped_fit_free(&f);
    palp_recording_free(&r);
    palp_lumped_fit good = fit_once(1);
    palp_model network = model_of(&good);
    const palp_forward_run run = {.n = 1, .time_s = (double[]){0.0}, .depth_m = (double[]){0.0}};
    network.kind = PALP_MODEL_NETWORK; /* without a mesh */
    ck_assert_int_eq(palp_forward_band(&network, &run, good.covariance, k, sd, NULL), PALP_ERR_ARGUMENT);
    network.material.formulation = PALP_SEDEF2008;
    ck_assert_int_eq(palp_forward_band(&network, &run, good.covariance, k, sd, NULL), PALP_ERR_UNSUPPORTED);
    palp_lumped_fit_free(&good);
}
END_TEST

/* A network of 27 nodes: sd^2 = sum of dF/da C_ab dF/db, with derivatives by differences of whole presses. */
START_TEST(the_band_of_a_network_is_that_of_the_derivatives) {
    enum { N = 8, P = 5 };
    const palp_mesh_source lattice = {.kind = PALP_MESH_LATTICE,
                                      .nodes = {3, 3, 3},
                                      .size_m = {0.024, 0.024, 0.024},
                                      .neighbourhood = PALP_NEIGHBOURS_26};
    const palp_model m = {
        .kind = PALP_MODEL_NETWORK, .height_m = 0.024, .material = truth(), .mesh = &lattice};
    double time_s[N], depth_m[N], force[N], sd[N], at[2][N], by[P][N], p[P], covariance[P * P];
    for (int i = 0; i < N; i++) {
        time_s[i] = 0.5 * i;
        depth_m[i] = 1e-3 * fmin(1.5 * time_s[i], 3.0);
    }
    const palp_forward_run run = {.n = N, .time_s = time_s, .depth_m = depth_m};
    ck_assert_int_eq(palp_forward_get(&m, p), PALP_OK);
    for (int a = 0; a < P; a++)
        for (int b = 0; b < P; b++)
            covariance[a * P + b] = p[a] * p[b] * (a == b ? 0.01 : 0.003);
    ck_assert_int_eq(palp_forward_band(&m, &run, covariance, force, sd, NULL), PALP_OK);
    for (int k = 0; k < P; k++) {
        for (int side = 0; side < 2; side++) {
            palp_model moved = m;
            double q[P];
            memcpy(q, p, sizeof q);
            q[k] *= side ? 1.001 : 0.999;
            ck_assert_int_eq(palp_forward_set(&moved, q), PALP_OK);
            ck_assert_int_eq(palp_forward_network(&moved, NULL, &run, at[side], NULL), PALP_OK);
        }
        for (int i = 0; i < N; i++)
            by[k][i] = (at[1][i] - at[0][i]) / (0.002 * p[k]);
    }
    for (int i = 1; i < N; i++) {
        double sum = 0.0;
        for (int a = 0; a < P; a++)
            for (int b = 0; b < P; b++)
                sum += by[a][i] * by[b][i] * covariance[a * P + b];
        ck_assert_double_eq_tol(sd[i], sqrt(sum), 1e-3 * sqrt(sum));
        ck_assert_double_gt(sd[i], 0.0);
    }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, the_band_is_that_of_the_derivatives);
    tcase_add_test(tc, the_band_covers);
    tcase_add_test(tc, what_has_no_band_is_refused);
    tcase_add_test(tc, the_band_of_a_network_is_that_of_the_derivatives);
}
