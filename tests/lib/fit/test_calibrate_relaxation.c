/* test_calibrate_relaxation.c: calibration of arms: what comes back of known ones, tolerances, and what is
 * refused. */
#include "relaxation_make.h"

#include <palpate/closed_form.h>

#include <string.h>

/* ---- known materials ---- */

typedef struct record {
    size_t n;
    double time_s[256], force_N[256];
} record;

static int keep_record(void *user, double time_s, double depth_m, double force_N) {
    record *r = user;
    (void)depth_m;
    if (time_s > 0.0) {
        r->time_s[r->n] = time_s;
        r->force_N[r->n++] = force_N;
    }
    return 0;
}

static double arm_time(const palp_arm *arm) {
    return arm->viscosity_Ns / arm->stiffness_N;
}

/* A network's own record with steps of 0.1 s, fitted with the same steps: the material comes back. */
static void recover(const palp_material *known, const palp_material *start,
                    palp_relaxation_settings settings) {
    static record kept[2];
    palp_target targets[2] = {{.n = 0}, {.n = 0}};
    palp_network *network = network_of(known);
    palp_calibration result;
    for (size_t t = 0; t < 2; t++) {
        palp_run_settings run = {.dt_s = 0.1, .observer = keep_record, .user = &kept[t]};
        kept[t].n = 0;
        palp_network_reset(network);
        ck_assert_int_eq(palp_path_ramp_hold(t ? 0.007 : 0.003, 1.0, 5.0, &targets[t].path), PALP_OK);
        ck_assert_int_eq(palp_network_run(network, &targets[t].path, &run, NULL), PALP_OK);
        targets[t].n = kept[t].n;
        targets[t].time_s = kept[t].time_s;
        targets[t].force_N = kept[t].force_N;
    }
    settings.dt_s = 0.1;
    settings.stop_relative = 1e-6;
    ck_assert_int_eq(palp_calibrate_relaxation(network, start, 2, targets, &settings, &result), PALP_OK);
    ck_assert(result.converged);
    ck_assert_double_lt(result.residual_N, 1e-7);
    for (size_t k = 0; k < known->law.n; k++)
        ck_assert_double_eq_tol(result.material.law.coefficients[k], known->law.coefficients[k],
                                1e-5 * fabs(known->law.coefficients[k]));
    bool swapped = arm_time(&result.material.arms[0]) > arm_time(&result.material.arms[1]);
    for (size_t j = 0; j < known->n_arms; j++) {
        const palp_arm *a = &result.material.arms[swapped ? 1 - j : j], *b = &known->arms[j];
        ck_assert_double_eq_tol(a->stiffness_N, b->stiffness_N, 1e-5 * b->stiffness_N);
        ck_assert_double_eq_tol(a->viscosity_Ns, b->viscosity_Ns, 1e-5 * b->viscosity_Ns);
        ck_assert_double_eq_tol(a->beta, b->beta, 1e-4);
        ck_assert_double_eq_tol(a->gamma, b->gamma, 1e-4);
    }
    palp_calibration_free(&result);
    palp_path_free(&targets[0].path);
    palp_path_free(&targets[1].path);
    palp_network_free(network);
}

START_TEST(known_arms_come_back) {
    palp_material known = network_n2(), start = known;
    palp_relaxation_settings settings = palp_relaxation_settings_default();
    known.arms[1].viscosity_Ns = 5.0 * known.arms[1].stiffness_N; /* seen in 6 s */
    for (size_t j = 0; j < 2; j++)
        start.arms[j] = (palp_arm){.stiffness_N = 0.1, .viscosity_Ns = j ? 1.0 : 0.05};
    ck_assert_int_eq(palp_law_scale(&known.law, 1.3, &start.law), PALP_OK);
    recover(&known, &start, settings);
    known.arms[0].beta = 3.0;
    known.arms[1].beta = 2.0;
    settings.fit_beta = true;
    settings.one_beta = false;
    recover(&known, &start, settings);
    known.arms[0].beta = known.arms[1].beta = 2.0;
    known.arms[0].gamma = known.arms[1].gamma = 1.0;
    settings.fit_gamma = settings.one_beta = true;
    recover(&known, &start, settings);
}
END_TEST

/* ---- the twelve depths ---- */

static void lumped_records(records *r) {
    palp_material lumped = lumped_n2();
    for (size_t t = 0; t < TARGETS; t++)
        ck_assert_int_eq(palp_lumped_ramp_hold(&lumped, r->target[t].path.depth_m[1] / CUBE_HEIGHT_M, 1.0,
                                               SAMPLES, r->time_s, r->force_N[t]),
                         PALP_OK);
}

/* Largest error of a material over all samples, in percent of its record's peak. */
static double worst_percent(palp_network *network, const palp_material *material, const records *r) {
    static double residual[TARGETS * SAMPLES];
    palp_relaxation_settings settings = palp_relaxation_settings_default();
    size_t n;
    double worst = 0.0;
    settings.tolerance = 1e-4;
    ck_assert_int_eq(
        relaxation_linearize(network, material, TARGETS, r->target, &settings, &n, residual, NULL), PALP_OK);
    for (size_t i = 0; i < TARGETS * SAMPLES; i++)
        worst = fmax(worst, 100.0 * sqrt((double)SAMPLES) * fabs(residual[i])); /* weight 1 / (n peak^2) */
    return worst;
}

static double lowest_rms(const palp_calibration *result) {
    double least = HUGE_VAL;
    for (size_t i = 0; i < result->n_iterations; i++)
        least = fmin(least, result->iterations[i].relative_rms);
    return least;
}

static palp_calibration fit_depths(palp_network *network, const palp_material *start, const records *r,
                                   const palp_relaxation_settings *settings, double *worst) {
    palp_calibration result;
    ck_assert_int_eq(palp_calibrate_relaxation(network, start, TARGETS, r->target, settings, &result),
                     PALP_OK);
    *worst = worst_percent(network, &result.material, r);
    ck_assert_double_le(100.0 * lowest_rms(&result), *worst);
    ck_assert_double_ge(400.0 * lowest_rms(&result), *worst);
    return result;
}

START_TEST(one_material_for_twelve_depths) {
    records r;
    records_make(&r, 0.0);
    lumped_records(&r);
    palp_material start = network_n2();
    palp_network *network = network_of(&start);
    palp_relaxation_settings settings = palp_relaxation_settings_default();
    double constant, dependent, worst;
    settings.tolerance = 1e-3;
    palp_calibration result = fit_depths(network, &start, &r, &settings, &constant);
    ck_assert(result.converged);
    ck_assert_double_ge(constant, 2.0);
    ck_assert_double_le(constant, 3.0);
    ck_assert_uint_le(result.n_iterations, 15);
    palp_calibration_free(&result);
    settings.fit_beta = true;
    result = fit_depths(network, &start, &r, &settings, &dependent);
    ck_assert(result.converged);
    ck_assert_double_le(dependent, 0.7);
    ck_assert_uint_le(result.n_iterations, 15);
    ck_assert_double_eq_tol(result.material.arms[0].beta, 3.0, 0.3);
    ck_assert_double_eq(result.material.arms[0].beta, result.material.arms[1].beta);
    /* a third arm between the two */
    palp_material more = result.material;
    more.n_arms = 3;
    more.arms[2] = more.arms[1];
    more.arms[1] = (palp_arm){.stiffness_N = 0.02, .viscosity_Ns = 0.1};
    settings.max_evaluations = 12;
    palp_calibration three = fit_depths(network, &more, &r, &settings, &worst);
    ck_assert_uint_eq(three.material.n_arms, 3);
    ck_assert_double_le(lowest_rms(&three), lowest_rms(&result) + 1e-6);
    palp_calibration_free(&three);
    palp_calibration_free(&result);
    palp_network_free(network);
    records_free(&r);
}
END_TEST

/* The graded steps err by less than 0.12 of the tolerance (0.2 with times that depend on strain), whether
 * samples are dense or few; steps ten times finer and more show the error. */
START_TEST(graded_steps_keep_the_tolerance) {
    records dense;
    records_make(&dense, 1.0);
    const double few_s[4] = {1.0, 3.0, 30.0, 201.0}, nothing[4] = {0};
    palp_target few = dense.target[9];
    palp_relaxation_settings settings = palp_relaxation_settings_default();
    palp_material material = network_n2();
    palp_network *network = network_of(&material);
    memset(dense.force_N, 0, sizeof dense.force_N);
    few.n = 4;
    few.time_s = few_s;
    few.force_N = nothing;
    material.arms[0].beta = material.arms[1].beta = 3.0;
    for (int dependent = 0; dependent < 2; dependent++) {
        material.arms[0].gamma = material.arms[1].gamma = dependent ? 2.0 : 0.0;
        for (int k = 0; k < 2; k++) {
            const palp_target *target = k ? &few : &dense.target[9];
            double exact[SAMPLES], force[SAMPLES], peak = 0.0, worst = 0.0;
            size_t n;
            settings.tolerance = 1e-7;
            ck_assert_int_eq(relaxation_linearize(network, &material, 1, target, &settings, &n, exact, NULL),
                             PALP_OK);
            for (size_t i = 0; i < target->n; i++)
                peak = fmax(peak, exact[i]);
            for (settings.tolerance = 1e-3; settings.tolerance > 1e-5; settings.tolerance *= 0.25) {
                ck_assert_int_eq(
                    relaxation_linearize(network, &material, 1, target, &settings, &n, force, NULL), PALP_OK);
                worst = 0.0;
                for (size_t i = 0; i < target->n; i++)
                    worst = fmax(worst, fabs(force[i] - exact[i]) / peak);
                ck_assert_double_le(worst, (dependent ? 0.2 : 0.12) * settings.tolerance);
            }
            ck_assert_double_gt(worst, 0.0);
        }
    }
    palp_network_free(network);
    records_free(&dense);
}
END_TEST

/* The same press at a thousandth of the pace: the steps follow, whatever the unit of the times. */
START_TEST(graded_steps_scale_with_time) {
    const double slow_s[3] = {1.0, 2.0, 50.0}, fast_s[3] = {1e-3, 2e-3, 50e-3}, nothing[3] = {0};
    palp_material slow = network_n2(), fast = slow;
    palp_network *network = network_of(&slow);
    palp_target target = {.n = 3, .time_s = slow_s, .force_N = nothing, .weight = 1.0};
    palp_relaxation_settings settings = palp_relaxation_settings_default();
    double force[2][3];
    size_t n;
    fast.arms[0].viscosity_Ns *= 1e-3;
    fast.arms[1].viscosity_Ns *= 1e-3;
    ck_assert_int_eq(palp_path_ramp_hold(0.006, 1.0, 49.0, &target.path), PALP_OK);
    ck_assert_int_eq(relaxation_linearize(network, &slow, 1, &target, &settings, &n, force[0], NULL),
                     PALP_OK);
    palp_path_free(&target.path);
    ck_assert_int_eq(palp_path_ramp_hold(0.006, 1e-3, 49e-3, &target.path), PALP_OK);
    target.time_s = fast_s;
    ck_assert_int_eq(relaxation_linearize(network, &fast, 1, &target, &settings, &n, force[1], NULL),
                     PALP_OK);
    for (size_t i = 0; i < 3; i++)
        ck_assert_double_eq_tol(force[0][i], force[1][i], 1e-10);
    palp_path_free(&target.path);
    palp_network_free(network);
}
END_TEST

/* ---- what goes wrong ---- */

static int stop_at_second(void *user, double fraction, const palp_calibrate_iteration *last) {
    ck_assert_double_gt(fraction, 0.0);
    ck_assert(isfinite(last->relative_rms));
    return ++*(int *)user == 2;
}

START_TEST(bad_input) {
    records r, bad;
    records_make(&r, 0.0);
    lumped_records(&r);
    palp_material start = network_n2(), other;
    palp_network *network = network_of(&start);
    const palp_relaxation_settings settings = palp_relaxation_settings_default();
    palp_relaxation_settings changed;
    palp_calibration result;
    palp_target target;
#define STATUS(material, n, targets, how, wanted)                                                            \
    do {                                                                                                     \
        ck_assert_int_eq(palp_calibrate_relaxation(network, material, n, targets, how, &result), wanted);    \
        ck_assert_ptr_null(result.iterations);                                                               \
    } while (0)
#define SETTING(member, value, wanted)                                                                       \
    do {                                                                                                     \
        changed = settings;                                                                                  \
        changed.member = value;                                                                              \
        STATUS(&start, 1, &target, &changed, wanted);                                                        \
    } while (0)
    target = r.target[0];
    SETTING(tolerance, 0.0, PALP_ERR_ARGUMENT);
    SETTING(tolerance, NAN, PALP_ERR_ARGUMENT);
    SETTING(dt_s, -0.1, PALP_ERR_ARGUMENT);
    SETTING(dt_s, NAN, PALP_ERR_ARGUMENT);
    SETTING(max_evaluations, 0, PALP_ERR_ARGUMENT);
    STATUS(&start, 0, &target, &settings, PALP_ERR_ARGUMENT);
    other = start;
    other.n_arms = 0;
    STATUS(&other, 1, &target, &settings, PALP_ERR_ARGUMENT);
    other = start;
    other.formulation = PALP_SEDEF2008;
    other.n_arms = 1;
    STATUS(&other, 1, &target, &settings, PALP_ERR_UNSUPPORTED);
    other = start;
    other.arms[1].viscosity_Ns = 0.0;
    STATUS(&other, 1, &target, &settings, PALP_ERR_ARGUMENT);
    other = start;
    other.quasi_linear = true;
    changed = settings;
    changed.fit_beta = true;
    STATUS(&other, 1, &target, &changed, PALP_ERR_UNSUPPORTED);
    target.n = 0;
    STATUS(&start, 1, &target, &settings, PALP_ERR_ARGUMENT);
    target = r.target[0];
    target.weight = -1.0;
    STATUS(&start, 1, &target, &settings, PALP_ERR_ARGUMENT);
    target.weight = NAN;
    STATUS(&start, 1, &target, &settings, PALP_ERR_ARGUMENT);
    bad = r;
    target = bad.target[0];
    target.time_s = bad.time_s;
    target.force_N = bad.force_N[0];
    bad.time_s[7] = bad.time_s[6];
    STATUS(&start, 1, &target, &settings, PALP_ERR_ARGUMENT);
    bad.time_s[7] = NAN;
    STATUS(&start, 1, &target, &settings, PALP_ERR_ARGUMENT);
    bad.time_s[7] = r.time_s[7];
    bad.force_N[0][3] = NAN;
    STATUS(&start, 1, &target, &settings, PALP_ERR_ARGUMENT);
    memset(bad.force_N[0], 0, sizeof bad.force_N[0]); /* no peak to weigh by */
    STATUS(&start, 1, &target, &settings, PALP_ERR_ARGUMENT);
    target = r.target[0];
    ck_assert_int_eq(palp_path_ramp_hold(0.005, 0.0, 10.0, &target.path), PALP_OK); /* starts at its depth */
    STATUS(&start, 1, &target, &settings, PALP_ERR_ARGUMENT);
    palp_path_free(&target.path);
    ck_assert_int_eq(palp_path_creep(1.0, 1.0, 10.0, &target.path), PALP_OK);
    STATUS(&start, 1, &target, &settings, PALP_ERR_ARGUMENT);
    palp_path_free(&target.path);
    int calls = 0;
    changed = settings;
    changed.progress = stop_at_second;
    changed.user = &calls;
    STATUS(&start, TARGETS, r.target, &changed, PALP_ERR_STOPPED);
    ck_assert_int_eq(calls, 2);
    palp_network_free(network);
    palp_network_settings heavy = palp_network_settings_default();
    heavy.density_kg_m3 = 1000.0;
    network = cube_network(3, &start, &heavy);
    STATUS(&start, TARGETS, r.target, &settings, PALP_ERR_UNSUPPORTED);
    palp_network_free(network);
#undef SETTING
#undef STATUS
    records_free(&r);
}
END_TEST

/* A press beyond the end of the branch has no first evaluation. */
START_TEST(press_beyond_the_reach) {
    const double one = 1.0, time_s[2] = {1.0, 2.0}, force_N[2] = {10.0, 9.0};
    palp_network_settings network_settings = palp_network_settings_default();
    palp_material start = cube_polynomial(1, &one);
    palp_target target = {.n = 2, .time_s = time_s, .force_N = force_N};
    palp_relaxation_settings settings = palp_relaxation_settings_default();
    palp_calibration result;
    start.n_arms = 1;
    start.arms[0] = (palp_arm){.stiffness_N = 0.1, .viscosity_Ns = 0.1};
    palp_network *network = cube_network(5, &start, &network_settings);
    ck_assert_int_eq(palp_path_ramp_hold(0.7 * CUBE_HEIGHT_M, 1.0, 10.0, &target.path), PALP_OK);
    palp_status status = palp_calibrate_relaxation(network, &start, 1, &target, &settings, &result);
    ck_assert(calibration_lost(status));
    ck_assert_ptr_null(result.iterations);
    palp_path_free(&target.path);
    palp_network_free(network);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, known_arms_come_back);
    tcase_add_test(tc, one_material_for_twelve_depths);
    tcase_add_test(tc, graded_steps_keep_the_tolerance);
    tcase_add_test(tc, graded_steps_scale_with_time);
    tcase_add_test(tc, bad_input);
    tcase_add_test(tc, press_beyond_the_reach);
}
