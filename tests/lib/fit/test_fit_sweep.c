/* test_fit_sweep.c: the arms from a sweep, without the withdrawal after it. */
#include "sweeps.h"

static sweep rig_sweep(void) {
    return (sweep){phantom(), 3.0, 0.3, 10.0, 0.1, 10.0, 60.0, 200.0, 0.002, 3};
}

START_TEST(a_withdrawal_after_a_sweep_is_left_out) {
    sweep s = rig_sweep();
    palp_recording r = prepare(record_sweep(&s));
    ck_assert_int_eq(r.kind, PALP_RECORDING_OTHER);
    ck_assert_double_eq_tol(r.end_s, 72.0, 0.05);
    for (size_t i = 0; i < r.n; i++)
        ck_assert_uint_eq(r.use[i], r.time_s[i] <= r.end_s);
    palp_recording_free(&r);
}
END_TEST

/* Both arms to half a percent, and nothing left but the noise. */
START_TEST(a_sweep_tells_the_arms_of_the_phantom) {
    sweep s = rig_sweep();
    palp_recording r = prepare(record_sweep(&s));
    palp_lumped_fit f = fit(1, &r, with_law(polynomial(3, LAW), 2));
    ck_assert_uint_eq(f.material.n_arms, 2);
    for (size_t j = 0; j < 2; j++) {
        ck_assert_double_eq_tol(f.material.arms[j].stiffness_N, s.material.arms[j].stiffness_N,
                                0.005 * s.material.arms[j].stiffness_N);
        ck_assert_double_eq_tol(f.material.arms[j].viscosity_Ns, s.material.arms[j].viscosity_Ns,
                                0.02 * s.material.arms[j].viscosity_Ns);
    }
    ck_assert_double_lt(f.rms_N[0], 1.05 * s.noise_N);
    palp_lumped_fit_free(&f);
    palp_recording_free(&r);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, a_withdrawal_after_a_sweep_is_left_out);
    tcase_add_test(tc, a_sweep_tells_the_arms_of_the_phantom);
}
