/* test_moduli.c: presses of a layer of known moduli with each tip give them back, in any units; two tips give
 * Poisson's ratio. */
#include "recordings.h"

typedef struct layer_truth {
    double shear_Pa, arm_Pa, tau_s, poisson, noise; /* of the peak */
} layer_truth;

static const layer_truth TRUTH = {2000, 1500, 3, 0.42, 0.002};

static palp_indentation tip_of(palp_tip_kind kind, double radius_mm) {
    return (palp_indentation){.tip = kind,
                              .radius_m = 1e-3 * radius_mm,
                              .half_angle_rad = 1.2,
                              .thickness_m = 24e-3,
                              .poisson = 0.1};
}

/* A ramp of 1 s to depth_mm and 40 s of hold, of lengths times a factor. */
static palp_recording press(layer_truth truth, palp_indentation tip, double depth_mm, double length,
                            uint64_t seed) {
    palp_material none = two_arms(1.0, 1e-9, 1e-9, 1e-9, 1e-6);
    take t = {none, depth_mm, 1.0, 40.0, 1.0, 50.0, 0.0, "ramp_hold", seed};
    palp_experiment *e = record(&t);
    size_t n = palp_experiment_rows(e);
    double *time = palp_experiment_column(e, "time_s"), *depth = palp_experiment_column(e, "depth_mm"),
           *force = palp_experiment_column(e, "force_N");
    double *reach = malloc(n * sizeof *reach), peak = 0;
    palp_material m = {.n_arms = 1,
                       .arms = {{truth.arm_Pa, truth.arm_Pa * truth.tau_s, 0, 0}},
                       .law = polynomial(1, &truth.shear_Pa)};
    tip.poisson = truth.poisson;
    for (size_t i = 0; i < n; i++) {
        depth[i] *= length;
        reach[i] = 1e-3 * depth[i];
    }
    ck_assert_int_eq(palp_indentation_force(&tip, n, reach, reach), PALP_OK);
    ck_assert_int_eq(palp_lumped_run(&m, 1.0, n, time, reach, force), PALP_OK);
    for (size_t i = 0; i < n; i++)
        peak = fmax(peak, force[i]);
    for (size_t i = 0; i < n; i++)
        force[i] += truth.noise * peak * palp_random_normal(&seed);
    free(reach);
    palp_experiment_set_number(e, "specimen.height_mm", 24.0 * length);
    return prepare(e);
}

static palp_moduli moduli(size_t n, const palp_recording *r, const palp_indentation *tips, double poisson) {
    palp_moduli m;
    palp_error error = {PALP_OK, ""};
    palp_moduli_settings s = palp_moduli_settings_default();
    s.n_arms = 1;
    s.poisson = poisson;
    palp_status status = palp_moduli_fit(n, r, tips, &s, &m, &error);
    ck_assert_msg(status == PALP_OK, "%s", error.text);
    return m;
}

/* Within 3 of the sds, which are small. */
static void is(palp_modulus m, double wanted, double largest_sd) {
    ck_assert_msg(fabs(m.value - wanted) < 3 * m.sd, "%g +- %g, not %g", m.value, m.sd, wanted);
    ck_assert_double_lt(m.sd, largest_sd * wanted);
    ck_assert_double_eq_tol(m.high - m.low, 3.92 * m.sd, 1e-9 * m.sd);
}

START_TEST(each_tip_gives_the_moduli) {
    palp_indentation tip = tip_of((palp_tip_kind)_i, 8);
    palp_recording r[2] = {press(TRUTH, tip, 3, 1, 7), press(TRUTH, tip, 2, 1, 8)};
    palp_indentation tips[2] = {tip, tip};
    palp_moduli m = moduli(2, r, tips, TRUTH.poisson);
    is(m.shear_inf_Pa, 2000, 0.08); /* the contact of a cone is known least */
    is(m.shear_0_Pa, 3500, 0.08);
    is(m.young_inf_Pa, 2 * 1.42 * 2000, 0.08);
    ck_assert_uint_eq(m.n_arms, 1);
    ck_assert_double_eq_tol(m.tau_s[0], 3, 0.1);
    ck_assert_uint_eq(m.n_tips, 1);
    ck_assert(!m.poisson_found && m.converged);
    ck_assert_double_eq_tol(m.largest_depth, 0.125, 1e-3);
    ck_assert_double_lt(m.misfit, 0.02);
    if (_i != PALP_TIP_PLATE) /* what one tip leaves open */
        ck_assert(m.shear_low_Pa < 2000 && m.shear_high_Pa > 2000);
    free_all(2, r);
}
END_TEST

START_TEST(two_tips_give_the_ratio) {
    palp_indentation tips[2] = {tip_of(PALP_TIP_FLAT, 4), tip_of(_i ? PALP_TIP_SPHERE : PALP_TIP_FLAT, 40)};
    palp_recording r[2] = {press(TRUTH, tips[0], 3, 1, 17), press(TRUTH, tips[1], 3, 1, 18)};
    palp_moduli m = moduli(2, r, tips, NAN);
    ck_assert(m.poisson_found);
    ck_assert_uint_eq(m.n_tips, 2);
    ck_assert_double_eq_tol(m.poisson.value, 0.42, 0.02);
    ck_assert(m.poisson.low <= 0.42 && m.poisson.high >= 0.42);
    is(m.shear_inf_Pa, 2000, 0.1);
    palp_moduli wrong = moduli(2, r, tips, 0.1); /* taken for known and wrong: the tips do not agree */
    ck_assert_double_gt(wrong.misfit, 5 * m.misfit);
    free_all(2, r);
}
END_TEST

START_TEST(one_tip_gives_no_ratio) {
    palp_indentation tips[2] = {tip_of(PALP_TIP_FLAT, 8), tip_of(PALP_TIP_FLAT, 8)};
    palp_recording r[2] = {press(TRUTH, tips[0], 3, 1, 7), press(TRUTH, tips[1], 2, 1, 8)};
    palp_moduli m;
    palp_error error = {PALP_OK, ""};
    palp_moduli_settings s = palp_moduli_settings_default();
    s.poisson = NAN;
    ck_assert_int_eq(palp_moduli_fit(2, r, tips, &s, &m, &error), PALP_ERR_INPUT);
    ck_assert_ptr_nonnull(strstr(error.text, "another shape or size"));
    s.poisson = 0.6;
    ck_assert_int_eq(palp_moduli_fit(2, r, tips, &s, &m, &error), PALP_ERR_ARGUMENT);
    ck_assert_int_eq(palp_moduli_fit(0, r, tips, &s, &m, &error), PALP_ERR_ARGUMENT);
    free_all(2, r);
}
END_TEST

/* Lengths times 1e-4 and a stiffer material: the same but for the factor. */
START_TEST(units_change_nothing) {
    const double length = 1e-4, force = 1e3;
    palp_indentation tip = tip_of((palp_tip_kind)_i, 8), small = tip;
    layer_truth stiff = TRUTH;
    stiff.shear_Pa *= force;
    stiff.arm_Pa *= force;
    small.radius_m *= length;
    small.thickness_m *= length;
    palp_recording r[2] = {press(TRUTH, tip, 3, 1, 7), press(stiff, small, 3, length, 7)};
    palp_moduli a = moduli(1, r, &tip, 0.5), b = moduli(1, r + 1, &small, 0.5);
    ck_assert_double_eq_tol(b.shear_inf_Pa.value / force, a.shear_inf_Pa.value, 1e-5 * a.shear_inf_Pa.value);
    ck_assert_double_eq_tol(b.shear_0_Pa.value / force, a.shear_0_Pa.value, 1e-5 * a.shear_0_Pa.value);
    ck_assert_double_eq_tol(b.shear_inf_Pa.sd / force, a.shear_inf_Pa.sd, 1e-2 * a.shear_inf_Pa.sd);
    free_all(2, r);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, each_tip_gives_the_moduli, 0, 4);
    tcase_add_loop_test(tc, two_tips_give_the_ratio, 0, 2);
    tcase_add_test(tc, one_tip_gives_no_ratio);
    tcase_add_loop_test(tc, units_change_nothing, 0, 4);
}
