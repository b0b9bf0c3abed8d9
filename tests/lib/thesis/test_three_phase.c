/* test_three_phase.c: the thesis' loops of Figure 5.21 against Tables 5.2 to 5.5 and 5.7. */
#include "cube.h"

#include <palpate/closed_form.h>
#include <palpate/path.h>
#include <palpate/thesis.h>

#include <stdlib.h>
#include <string.h>

/* The record that Eq. 5.25 gives: n samples every dt_s, the ramp's end among them. */
typedef struct record {
    palp_target target;
    double *time_s, *force_N;
} record;

/* Eq. 4.3 with the arm of Table 4.4. */
static palp_material lumped_n1(void) {
    palp_material material = cube_polynomial(5, LUMPED_LAW);
    material.n_arms = 1;
    material.arms[0] = (palp_arm){.stiffness_N = 1.2962987, .viscosity_Ns = 17.873062};
    return material;
}

static record record_make(double depth_m, double hold_s, double dt_s) {
    record r = {.target = {.n = (size_t)((1.0 + hold_s) / dt_s + 0.5)}};
    palp_material lumped = lumped_n1();
    r.time_s = malloc(r.target.n * sizeof *r.time_s);
    r.force_N = malloc(r.target.n * sizeof *r.force_N);
    ck_assert(r.time_s && r.force_N);
    for (size_t i = 0; i < r.target.n; i++)
        r.time_s[i] = (double)(i + 1) * dt_s;
    ck_assert_int_eq(palp_path_ramp_hold(depth_m, 1.0, hold_s, &r.target.path), PALP_OK);
    ck_assert_int_eq(
        palp_lumped_ramp_hold(&lumped, depth_m / CUBE_HEIGHT_M, 1.0, r.target.n, r.time_s, r.force_N),
        PALP_OK);
    r.target.time_s = r.time_s;
    r.target.force_N = r.force_N;
    return r;
}

static void record_free(record *r) {
    palp_path_free(&r->target.path);
    free(r->time_s);
    free(r->force_N);
}

/* The law of Table 5.1 with the lumped arm: where the thesis starts. */
static palp_material thesis_start(palp_formulation formulation) {
    palp_material material = lumped_n1();
    material.law = cube_polynomial(5, NETWORK_LAW).law;
    material.formulation = formulation;
    return material;
}

static palp_three_phase_settings thesis_settings(double dt_s) {
    palp_three_phase_settings settings = palp_three_phase_settings_default();
    settings.max_evaluations = 200;
    settings.dt_s = dt_s;
    return settings;
}

static palp_calibration calibrate(const palp_material *start, const record *r,
                                  const palp_three_phase_settings *settings) {
    palp_network_settings network_settings = palp_network_settings_default();
    palp_network *network = cube_network(3, start, &network_settings);
    palp_calibration result;
    ck_assert_int_eq(palp_thesis_three_phase(network, start, &r->target, settings, &result), PALP_OK);
    palp_network_free(network);
    return result;
}

/* Phase 1 at 6 mm with steps of 1 ms. */
START_TEST(table_5_2) {
    static const double table[15][3] = {
        {1.296299, 17.873062, 164.06}, {0.490900, 6.768420, 50.42}, {0.326346, 4.499580, 27.20},
        {0.256555, 3.537327, 17.35},   {0.218616, 3.014230, 12.00}, {0.195193, 2.691272, 8.69},
        {0.179579, 2.475994, 6.49},    {0.168633, 2.325071, 4.94},  {0.160685, 2.215486, 3.82},
        {0.154766, 2.133873, 2.98},    {0.150274, 2.071937, 2.35},  {0.146816, 2.024260, 1.86},
        {0.144124, 1.987154, 1.48},    {0.142012, 1.958029, 1.18},  {0.140343, 1.935015, 0.95}};
    record r = record_make(0.006, 1.0, 1e-3);
    palp_material start = thesis_start(PALP_SEDEF2008);
    palp_three_phase_settings settings = thesis_settings(1e-3);
    settings.max_evaluations = 15;
    palp_calibration result = calibrate(&start, &r, &settings);
    ck_assert_uint_eq(result.n_iterations, 15);
    for (size_t i = 0; i < 15; i++) {
        const palp_calibrate_iteration *it = &result.iterations[i];
        ck_assert_int_eq(it->phase, 1);
        ck_assert_double_eq_tol(it->peak_error_percent, table[i][2], 0.4);
        ck_assert_double_eq_tol(it->material.arms[0].stiffness_N, table[i][0], 0.02 * table[i][0]);
        ck_assert_double_eq_tol(it->material.arms[0].viscosity_Ns, table[i][1], 0.02 * table[i][1]);
        ck_assert(isnan(it->steady_time_error_percent) && isnan(it->steady_force_error_percent));
    }
    ck_assert_double_lt(result.iterations[14].peak_error_percent, 1.0); /* as the thesis, and not before */
    ck_assert_double_gt(result.iterations[13].peak_error_percent, 1.0);
    palp_calibration_free(&result);
    record_free(&r);
}
END_TEST

/* Phases 2 and 3 at 6 mm with nodes that stand still in the dwell, phase by phase and after three global
 * iterations. */
START_TEST(tables_5_3_to_5_5) {
    static const struct {
        int phase;
        double viscosity_Ns, error_percent, thesis_percent;
    } rows[6] = {{2, 1.935015, 11.24, 12.17}, {2, 2.203140, 4.21, 4.70}, {2, 2.312092, 1.59, 1.83},
                 {2, 2.355420, 0.60, 0.72},   {3, 2.355420, 5.10, 5.40}, {3, 2.355420, 0.22, 0.20}};
    record r = record_make(0.006, 60.0, 1e-3);
    palp_material start = thesis_start(PALP_SEDEF2008);
    palp_three_phase_settings settings = thesis_settings(1e-3);
    settings.frozen_dwell = true;
    palp_calibration result = calibrate(&start, &r, &settings);
    ck_assert(result.converged);
    size_t global = 1;
    for (size_t i = 1; i < result.n_iterations; i++)
        global += result.iterations[i].phase == 1 && result.iterations[i - 1].phase == 3;
    ck_assert_uint_eq(global, 3);
    for (size_t i = 0; i < 6; i++) {
        const palp_calibrate_iteration *it = &result.iterations[15 + i];
        double error = it->phase == 2 ? it->steady_time_error_percent : it->steady_force_error_percent;
        ck_assert_int_eq(it->phase, rows[i].phase);
        ck_assert_double_eq_tol(error, rows[i].error_percent, 0.02);
        ck_assert_double_eq_tol(error, rows[i].thesis_percent, 0.95);
        ck_assert_double_eq_tol(it->material.arms[0].viscosity_Ns, rows[i].viscosity_Ns,
                                0.02 * rows[i].viscosity_Ns);
    }
    ck_assert_double_eq_tol(result.iterations[20].peak_error_percent, 3.3, 0.25);
    ck_assert_double_eq_tol(result.iterations[20].steady_time_error_percent, 2.2, 0.2);
    ck_assert_double_eq_tol(result.material.arms[0].stiffness_N, 0.159, 0.001);
    ck_assert_double_eq_tol(result.material.arms[0].viscosity_Ns, 2.251, 0.009);
    ck_assert_double_eq_tol(result.material.law.coefficients[4], 167.98, 0.005 * 167.98);
    palp_calibration_free(&result);
    record_free(&r);
}
END_TEST

static double stiffness_at(double depth_m, palp_formulation formulation) {
    record r = record_make(depth_m, 50.0, 0.02);
    palp_material start = thesis_start(formulation);
    palp_three_phase_settings settings = thesis_settings(0.02);
    palp_calibration result = calibrate(&start, &r, &settings);
    double stiffness = result.material.arms[0].stiffness_N;
    ck_assert_uint_lt(result.n_iterations, 40);
    palp_calibration_free(&result);
    record_free(&r);
    return stiffness;
}

/* Table 5.7: K1 grows 3.66 times from 2 to 9 mm, most of which is the formulation. */
START_TEST(growth_of_the_arm) {
    double sedef = stiffness_at(0.009, PALP_SEDEF2008) / stiffness_at(0.002, PALP_SEDEF2008);
    double history = stiffness_at(0.009, PALP_HISTORY) / stiffness_at(0.002, PALP_HISTORY);
    ck_assert_double_eq_tol(sedef, 0.223 / 0.061, 0.1 * 0.223 / 0.061);
    ck_assert_double_eq_tol(history, 1.5, 0.1);
}
END_TEST

/* A converged result keeps its word in a run of our own: peak, time and force of the steady state are
 * within the bound of the record's. */
START_TEST(converged_means_within_the_bound) {
    const double dt = 0.02, ramp = 1.0, slope = 1e-3;
    record r = record_make(0.006, 50.0, dt);
    for (int k = 0; k < 2; k++) {
        palp_material start = thesis_start(k ? PALP_SEDEF2008 : PALP_HISTORY);
        palp_network_settings network_settings = palp_network_settings_default();
        palp_three_phase_settings settings = thesis_settings(dt);
        settings.error_bound = 0.005;
        settings.steady_slope_N_s = slope;
        palp_calibration result = calibrate(&start, &r, &settings);
        ck_assert(result.converged);
        palp_network *network = cube_network(3, &result.material, &network_settings);
        double before = 0.0, force = 0.0, peak = 0.0;
        size_t i = 0, steady = 0, wanted_steady = 0;
        for (; i < r.target.n && !(steady && wanted_steady); i++) {
            double t = r.time_s[i];
            bool hold = t > ramp + 0.5 * dt;
            if (!steady) {
                before = force;
                ck_assert_int_eq(palp_network_step(network, 0.006 * fmin(t, ramp), dt, NULL), PALP_OK);
                force = palp_network_force(network);
                peak = fmax(peak, force);
                steady = hold && before - force < slope * dt ? i : 0;
            }
            if (hold && !wanted_steady && r.force_N[i - 1] - r.force_N[i] < slope * dt)
                wanted_steady = i;
        }
        double wanted_peak = r.force_N[(size_t)(ramp / dt + 0.5) - 1];
        ck_assert_double_eq_tol(peak, wanted_peak, 0.005 * wanted_peak);
        ck_assert_double_eq_tol(r.time_s[steady], r.time_s[wanted_steady],
                                0.005 * r.time_s[wanted_steady] + 1e-9);
        ck_assert_double_eq_tol(force, r.force_N[wanted_steady], 0.005 * force);
        ck_assert_double_eq_tol(result.residual_N, fabs(peak - wanted_peak), 1e-9);
        palp_network_free(network);
        palp_calibration_free(&result);
    }
    record_free(&r);
}
END_TEST

/* The errors listed are within the bound in the order of the phases, and as many as asked for. */
START_TEST(phases_and_their_limit) {
    record r = record_make(0.006, 50.0, 0.05);
    palp_material start = thesis_start(PALP_HISTORY);
    palp_three_phase_settings settings = thesis_settings(0.05);
    for (size_t most = 1; most < 30; most++) {
        settings.max_evaluations = most;
        palp_calibration result = calibrate(&start, &r, &settings);
        ck_assert_uint_le(result.n_iterations, most);
        ck_assert(result.converged || result.n_iterations == most);
        ck_assert_int_eq(result.iterations[0].phase, 1);
        for (size_t i = 0; i < result.n_iterations; i++) {
            const palp_calibrate_iteration *it = &result.iterations[i];
            bool hold = it->phase > 1;
            ck_assert_int_eq(!isnan(it->steady_time_error_percent), hold);
            ck_assert_int_eq(!isnan(it->steady_force_error_percent), hold);
            if (i && it->phase == 2 && it[-1].phase == 1)
                ck_assert_double_le(it->peak_error_percent, 1.0);
        }
        palp_calibration_free(&result);
        most += most > 4 ? 4 : 0;
    }
    record_free(&r);
}
END_TEST

static int stop_at_once(void *user, double fraction, const palp_calibrate_iteration *last) {
    (void)user;
    ck_assert_double_gt(fraction, 0.0);
    ck_assert_int_eq(last->phase, 1);
    return 1;
}

START_TEST(bad_input) {
    record r = record_make(0.006, 10.0, 0.1);
    palp_material start = thesis_start(PALP_SEDEF2008), other = start;
    palp_network_settings network_settings = palp_network_settings_default();
    palp_network *network = cube_network(3, &start, &network_settings);
    const palp_three_phase_settings settings = thesis_settings(0.1);
    palp_three_phase_settings changed;
    palp_target target;
    palp_calibration result;
#define STATUS(material, target, how, wanted)                                                                \
    do {                                                                                                     \
        ck_assert_int_eq(palp_thesis_three_phase(network, material, target, how, &result), wanted);          \
        ck_assert_ptr_null(result.iterations);                                                               \
    } while (0)
#define SETTING(member, value, wanted)                                                                       \
    do {                                                                                                     \
        changed = settings;                                                                                  \
        changed.member = value;                                                                              \
        STATUS(&start, &r.target, &changed, wanted);                                                         \
    } while (0)
    SETTING(dt_s, 0.0, PALP_ERR_ARGUMENT);
    SETTING(dt_s, NAN, PALP_ERR_ARGUMENT);
    SETTING(max_evaluations, 0, PALP_ERR_ARGUMENT);
    SETTING(error_bound, 0.0, PALP_ERR_ARGUMENT);
    SETTING(progress, stop_at_once, PALP_ERR_STOPPED);
    other.n_arms = 0;
    STATUS(&other, &r.target, &settings, PALP_ERR_UNSUPPORTED);
    other = start;
    other.formulation = PALP_HISTORY;
    other.n_arms = 2;
    other.arms[1] = other.arms[0];
    STATUS(&other, &r.target, &settings, PALP_ERR_UNSUPPORTED);
    other = start;
    other.arms[0].stiffness_N = -1.0;
    STATUS(&other, &r.target, &settings, PALP_ERR_ARGUMENT);
    target = r.target;
    target.n = 10; /* ends with the ramp */
    STATUS(&start, &target, &settings, PALP_ERR_ARGUMENT);
    target.n = 2;
    STATUS(&start, &target, &settings, PALP_ERR_ARGUMENT);
    target = r.target;
    ck_assert_int_eq(palp_path_cyclic(0.006, 0.001, 1, &target.path), PALP_OK);
    STATUS(&start, &target, &settings, PALP_ERR_ARGUMENT);
    palp_path_free(&target.path);
    ck_assert_int_eq(palp_path_creep(1.0, 1.0, 10.0, &target.path), PALP_OK);
    STATUS(&start, &target, &settings, PALP_ERR_ARGUMENT);
    palp_path_free(&target.path);
    double time = r.time_s[20];
    r.time_s[20] = r.time_s[19];
    STATUS(&start, &r.target, &settings, PALP_ERR_ARGUMENT);
    r.time_s[20] = time;
    memset(r.force_N, 0, r.target.n * sizeof *r.force_N);
    STATUS(&start, &r.target, &settings, PALP_ERR_ARGUMENT);
    r.force_N[9] = NAN;
    STATUS(&start, &r.target, &settings, PALP_ERR_ARGUMENT);
#undef SETTING
#undef STATUS
    palp_network_free(network);
    record_free(&r);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, table_5_2);
    tcase_add_test(tc, tables_5_3_to_5_5);
    tcase_add_test(tc, growth_of_the_arm);
    tcase_add_test(tc, converged_means_within_the_bound);
    tcase_add_test(tc, phases_and_their_limit);
    tcase_add_test(tc, bad_input);
}
