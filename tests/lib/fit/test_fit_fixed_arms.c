/* test_fit_fixed_arms.c: arms at fixed times with the spectrum of a fractional element. */
#include "fractional_step.h"

static palp_lumped_fit fit_as(palp_arms_form form, const palp_recording *r, double force) {
    const double one = 10.0 * force;
    palp_characterize_settings s = with_law(polynomial(1, &one), 0);
    s.arms = form;
    return fit(1, r, s);
}

/* The law, the stiffness, the time and the exponent of the element to a percent, in any units. */
START_TEST(a_fractional_element_is_found) {
    static const double force[3] = {1.0, 1e-6, 1.0}, time[3] = {1.0, 1.0, 1e3},
                        truth[4] = {8.0, 5.0, 2.0, 0.5};
    palp_recording r = step(force[_i], time[_i], 1e-4);
    palp_lumped_fit f = fit_as(PALP_ARMS_FRACTIONAL, &r, force[_i]);
    ck_assert(f.converged);
    ck_assert_uint_eq(f.n_estimates, 4);
    ck_assert_uint_eq(f.material.n_arms, PALP_ARMS_MAX);
    for (size_t k = 0; k < 4; k++) {
        double want = truth[k] * (k < 2 ? force[_i] : k == 2 ? time[_i] : 1.0);
        ck_assert_double_eq_tol(f.estimate[k].value, want, 0.01 * want);
        ck_assert(f.estimate[k].determined);
    }
    ck_assert_str_eq(f.estimate[3].name, "exponent");
    ck_assert_double_lt(f.rms_N[0], 1.1e-4 * force[_i]);
    palp_lumped_fit_free(&f);
    palp_recording_free(&r);
}
END_TEST

START_TEST(what_cannot_be_is_refused) {
    palp_recording r = step(1.0, 1.0, 1e-4);
    palp_lumped_fit f;
    palp_error error = {PALP_OK, ""};
    palp_characterize_settings s = with_arms(0);
    s.arms = PALP_ARMS_FRACTIONAL;
    ck_assert_int_eq(palp_characterize_fit(1, &r, &s, &f, &error), PALP_ERR_ARGUMENT);
    palp_recording_free(&r);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, a_fractional_element_is_found, 0, 3);
    tcase_add_test(tc, what_cannot_be_is_refused);
}
