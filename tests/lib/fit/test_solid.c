/* test_solid.c: derivatives of each energy by finite differences; a block between plates that slide against
 * the closed form; fits that find a known solid again, in any units. */
#include <palpate/solid.h>

#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LAWS = PALP_SOLID_ST_VENANT + 1, SAMPLES = 90 };

static palp_solid solid_of(int law) {
    return (palp_solid){.law = (palp_solid_law)law, .poisson = 0.4, .c_Pa = {1000, 300, 150}};
}

START_TEST(derivatives_by_differences) {
    const double F0[9] = {0.9, 0.2, -0.1, 0.05, 1.1, 0.15, -0.2, 0.1, 0.8}, h = 1e-6;
    const palp_solid solid = solid_of(_i);
    double P[9], H[81];
    palp_solid_energy(&solid, F0, P, H);
    for (int i = 0; i < 9; i++) {
        double up[9], down[9], Pu[9], Pd[9];
        memcpy(up, F0, sizeof up);
        memcpy(down, F0, sizeof down);
        up[i] += h;
        down[i] -= h;
        const double wu = palp_solid_energy(&solid, up, Pu, NULL),
                     wd = palp_solid_energy(&solid, down, Pd, NULL);
        ck_assert_double_eq_tol((wu - wd) / (2 * h), P[i], 2e-4);
        for (int j = 0; j < 9; j++)
            ck_assert_double_eq_tol((Pu[j] - Pd[j]) / (2 * h), H[9 * i + j], 2e-3);
    }
}
END_TEST

/* At rest each law is the solid of its shear modulus and Poisson's ratio, without stress. */
START_TEST(at_rest) {
    const double one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const palp_solid solid = solid_of(_i);
    const double G = palp_solid_shear(&solid), lambda = palp_solid_lambda(&solid);
    double P[9], H[81];
    palp_solid_energy(&solid, one, P, H);
    for (int i = 0; i < 9; i++)
        ck_assert_double_eq_tol(P[i], 0, 1e-9 * G);
    ck_assert_double_eq_tol(H[0], lambda + 2 * G, 1e-9 * G);
    ck_assert_double_eq_tol(H[4], lambda, 1e-9 * G);
    ck_assert_double_eq_tol(H[9 + 1], G, 1e-9 * G);
    ck_assert_double_eq_tol(palp_solid_bulk(&solid), lambda + 2 * G / 3, 1e-9 * G);
}
END_TEST

static palp_mesh *block(double length) {
    const size_t nodes[3] = {4, 5, 4};
    const double size[3] = {0.02 * length, 0.03 * length, 0.025 * length};
    palp_mesh *mesh = NULL;
    ck_assert_int_eq(palp_mesh_lattice(nodes, size, PALP_NEIGHBOURS_26, &mesh), PALP_OK);
    return mesh;
}

/* Across the press E is -nu times that along it; the force per section is young (s^3 - s) / 2 at the stretch
 * s. */
START_TEST(st_venant_slides) {
    palp_solid solid = solid_of(PALP_SOLID_ST_VENANT);
    const double depth[3] = {0.001, 0.004, 0.008}, young = 2 * 1.4 * 1000;
    double force[3];
    palp_mesh *mesh = block(1);
    solid.slides = true;
    ck_assert_int_eq(palp_solid_force(&solid, mesh, 3, depth, force), PALP_OK);
    for (int i = 0; i < 3; i++) {
        const double s = 1 - depth[i] / 0.03;
        ck_assert_double_eq_tol(force[i], 0.0005 * young * s * (1 - s * s) / 2, 1e-7 * fabs(force[2]));
    }
    palp_mesh_free(mesh);
}
END_TEST

/* Neo-Hookean with a logarithm: c0 (s - 1/s) + lambda ln J / s along and across, J = s a^2, bisected for a.
 */
START_TEST(neo_hookean_slides) {
    palp_solid solid = solid_of(PALP_SOLID_NEO_HOOKEAN_LOG);
    const double depth = 0.007, s = 1 - depth / 0.03, lambda = palp_solid_lambda(&solid);
    double low = 1, high = 2, force;
    for (int i = 0; i < 60; i++) {
        const double a = 0.5 * (low + high);
        *(1000 * (a - 1 / a) + lambda * log(s * a * a) / a > 0 ? &high : &low) = a;
    }
    palp_mesh *mesh = block(1);
    solid.slides = true;
    ck_assert_int_eq(palp_solid_force(&solid, mesh, 1, &depth, &force), PALP_OK);
    ck_assert_double_eq_tol(force, -0.0005 * (1000 * (s - 1 / s) + lambda * log(s * low * low) / s),
                            1e-7 * force);
    palp_mesh_free(mesh);
}
END_TEST

/* A ramp of 3 s and a dwell. */
static palp_solid_press ramp_and_hold(double length, double store[3][SAMPLES]) {
    for (int i = 0; i < SAMPLES; i++) {
        store[0][i] = i < 30 ? 0.1 * i : 3 + 0.5 * (i - 30 + 1);
        store[1][i] = 0.006 * length * fmin(1, store[0][i] / 3);
    }
    return (palp_solid_press){SAMPLES, store[0], store[1], store[2], NULL};
}

static palp_solid refit(palp_solid truth, double length) {
    static double store[3][SAMPLES];
    palp_solid_press press = ramp_and_hold(length, store);
    palp_mesh *mesh = block(length);
    palp_solid_fit_info info;
    ck_assert_int_eq(palp_solid_run(&truth, mesh, &press, store[2]), PALP_OK);
    palp_solid found = {.law = truth.law,
                        .poisson = truth.poisson,
                        .time = truth.time,
                        .n_arms = truth.n_arms,
                        .tau_s = {truth.tau_s[0], truth.tau_s[1]}};
    ck_assert_int_eq(palp_solid_fit(&found, mesh, 1, &press, &info), PALP_OK);
    ck_assert_double_lt(info.worst_N, 1e-4 * info.peak_N);
    ck_assert_int_eq((int)info.n, SAMPLES);
    palp_mesh_free(mesh);
    return found;
}

START_TEST(finds_yeoh_and_prony_again) {
    palp_solid truth = solid_of(PALP_SOLID_YEOH);
    truth.time = PALP_SOLID_PRONY;
    truth.n_arms = 2;
    truth.tau_s[0] = 1;
    truth.tau_s[1] = 12;
    truth.share[0] = 0.5;
    truth.share[1] = 0.2;
    const palp_solid found = refit(truth, 1), large = refit(truth, 7);
    ck_assert_double_eq_tol(found.c_Pa[0], 1000, 5);
    ck_assert_double_eq_tol(found.c_Pa[1], 300, 60);
    ck_assert_double_eq_tol(found.share[0], 0.5, 0.005);
    ck_assert_double_eq_tol(found.share[1], 0.2, 0.005);
    ck_assert_double_eq_tol(large.c_Pa[0], found.c_Pa[0], 1);
    ck_assert_double_eq_tol(large.share[0], found.share[0], 1e-3);
}
END_TEST

START_TEST(finds_damping_again) {
    static const struct {
        palp_solid_law law;
        palp_solid_time time;
        double damping;
    } OF[] = {{PALP_SOLID_ST_VENANT, PALP_SOLID_MATERIAL, 0.3},
              {PALP_SOLID_NEO_HOOKEAN_STABLE, PALP_SOLID_SHEAR, 400},
              {PALP_SOLID_NEO_HOOKEAN_LOG, PALP_SOLID_RAYLEIGH, 0.2}};
    palp_solid truth = solid_of((int)OF[_i].law);
    truth.time = OF[_i].time;
    truth.damping = OF[_i].damping;
    const palp_solid found = refit(truth, 1);
    ck_assert_double_eq_tol(found.c_Pa[0], 1000, 0.01);
    ck_assert_double_eq_tol(found.damping, truth.damping, 1e-4 * truth.damping);
}
END_TEST

/* Rayleigh damping of small strain is damping times Young's modulus times the strain's rate. */
START_TEST(viscous_force_of_a_slow_ramp) {
    for (int t = PALP_SOLID_RAYLEIGH; t <= PALP_SOLID_SHEAR; t++) {
        palp_solid solid = solid_of(PALP_SOLID_ST_VENANT);
        double time[2] = {0, 1}, depth[2] = {0, 3e-6}, force[2];
        const palp_solid_press press = {2, time, depth, NULL, NULL};
        palp_mesh *mesh = block(1);
        solid.slides = true;
        solid.time = (palp_solid_time)t;
        solid.damping = t == PALP_SOLID_SHEAR ? 2000 : 2;
        ck_assert_int_eq(palp_solid_run(&solid, mesh, &press, force), PALP_OK);
        /* SHEAR: 2 viscosity E:E = 2 viscosity (1 + 2 nu^2) of a press by 1 */
        const double young = 2800, viscous = t == PALP_SOLID_SHEAR ? 2 * 2000 * (1 + 2 * 0.16) : 2 * young;
        ck_assert_double_eq_tol(force[1] / (0.0005 * 1e-4), young + viscous, 3e-3 * young);
        palp_mesh_free(mesh);
    }
}
END_TEST

START_TEST(bad_input) {
    palp_mesh *mesh = block(1);
    palp_solid solid = solid_of(PALP_SOLID_YEOH);
    palp_solid_fit_info info;
    double time[2] = {0, 0}, depth[2] = {0, 1e-3}, force[2] = {0, 1};
    palp_solid_press press = {2, time, depth, force, NULL};
    ck_assert_int_eq(palp_solid_fit(&solid, mesh, 1, &press, &info), PALP_ERR_ARGUMENT);
    time[1] = 1;
    force[1] = -1;
    ck_assert_int_eq(palp_solid_fit(&solid, mesh, 1, &press, &info), PALP_ERR_ARGUMENT);
    force[1] = 1;
    solid.poisson = 0.5;
    ck_assert_int_eq(palp_solid_fit(&solid, mesh, 1, &press, &info), PALP_ERR_ARGUMENT);
    solid.poisson = 0.4;
    depth[1] = 0;
    ck_assert_int_eq(palp_solid_fit(&solid, mesh, 1, &press, &info), PALP_ERR_ARGUMENT);
    depth[1] = 0.04; /* more than the height */
    ck_assert_int_ne(palp_solid_force(&solid, mesh, 1, depth + 1, force), PALP_OK);
    palp_mesh_free(mesh);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, derivatives_by_differences, 0, LAWS);
    tcase_add_loop_test(tc, at_rest, 0, LAWS);
    tcase_add_test(tc, st_venant_slides);
    tcase_add_test(tc, neo_hookean_slides);
    tcase_add_test(tc, finds_yeoh_and_prony_again);
    tcase_add_loop_test(tc, finds_damping_again, 0, 3);
    tcase_add_test(tc, viscous_force_of_a_slow_ramp);
    tcase_add_test(tc, bad_input);
}
