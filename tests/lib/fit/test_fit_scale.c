/* test_fit_scale.c: other units of force, length and time change the numbers of a fit by their factors and by
 * nothing else. */
#include "recordings.h"

typedef struct scale {
    double force, length, time;
} scale;

static const scale scales[] = {{1e-9, 1, 1}, {1e-6, 1, 1},       {1e-3, 1, 1},  {1e3, 1, 1},
                               {1, 1e-4, 1}, {1, 1e-2, 1},       {1, 10, 1},    {1, 1, 1e-3},
                               {1, 1, 1e3},  {1e-9, 1e-4, 1e-3}, {1e3, 10, 1e3}};
enum { SCALES = sizeof scales / sizeof scales[0] };

static palp_recording scaled(const take *t, scale by) {
    palp_experiment *e = record(t);
    double *time = palp_experiment_column(e, "time_s"), *depth = palp_experiment_column(e, "depth_mm"),
           *force = palp_experiment_column(e, "force_N");
    for (size_t i = 0; i < palp_experiment_rows(e); i++) {
        time[i] *= by.time;
        depth[i] *= by.length;
        force[i] *= by.force;
    }
    palp_experiment_set_number(e, "specimen.height_mm", 24.0 * by.length);
    return prepare(e);
}

static void runs_of(scale by, palp_recording r[3]) {
    palp_material m = phantom();
    m.law = polynomial(3, (double[3]){8.0, -6.0, 60.0});
    for (uint64_t q = 0; q < 3; q++) {
        take t = {m, 3.0 + 2.0 * (double)q, 1.0, 60.0, 1.0, 50.0, 0.004, "ramp_hold", 80 + q};
        if (q == 0)
            t = (take){m, 9.0, 90.0, 0.0, 1.0, 20.0, 0.004, "static", 80};
        r[q] = scaled(&t, by);
    }
}

#define NEAR(got, want)                                                                                      \
    ck_assert_msg(fabs((got) - (want)) <= 1e-6 * fabs(want), "scale %d: %s is %.9g, not %.9g", _i, #got,     \
                  (got), (want))

START_TEST(a_recording_scales) {
    const scale by = scales[_i], one = {1, 1, 1};
    palp_recording r[3], base[3];
    runs_of(by, r);
    runs_of(one, base);
    for (int q = 0; q < 3; q++) {
        ck_assert_int_eq(r[q].kind, base[q].kind);
        ck_assert_int_eq(r[q].contact_rule, base[q].contact_rule);
        NEAR(r[q].noise_N, by.force * base[q].noise_N);
        NEAR(r[q].zero_sd_N, by.force * base[q].zero_sd_N);
        NEAR(r[q].deepest_m, by.length * base[q].deepest_m);
        NEAR(r[q].ramp_end_s, by.time * base[q].ramp_end_s);
        ck_assert_double_eq_tol(r[q].contact_m / by.length, base[q].contact_m, 1e-9);
        ck_assert_double_eq_tol(r[q].zero_N / by.force, base[q].zero_N, 1e-9);
    }
    free_all(3, r);
    free_all(3, base);
}
END_TEST

START_TEST(a_fit_scales) {
    const scale by = scales[_i], one = {1, 1, 1};
    palp_recording r[3], base[3];
    runs_of(by, r);
    runs_of(one, base);
    palp_lumped_fit f =
        fit(3, r, with_law(polynomial(3, (double[3]){by.force, 0.1 * by.force, 0.1 * by.force}), 2));
    palp_lumped_fit g = fit(3, base, with_law(polynomial(3, (double[3]){1.0, 0.1, 0.1}), 2));
    ck_assert_uint_eq(f.n_parameters, g.n_parameters);
    for (size_t k = 0; k < 3; k++)
        NEAR(f.material.law.coefficients[k], by.force * g.material.law.coefficients[k]);
    for (size_t j = 0; j < 2; j++) {
        NEAR(f.material.arms[j].stiffness_N, by.force * g.material.arms[j].stiffness_N);
        NEAR(f.material.arms[j].viscosity_Ns, by.force * by.time * g.material.arms[j].viscosity_Ns);
    }
    for (size_t q = 0; q < 3; q++)
        NEAR(f.rms_N[q], by.force * g.rms_N[q]);
    for (size_t i = 0; i < f.n_estimates; i++)
        ck_assert_msg(fabs(f.estimate[i].sd / f.estimate[i].value - g.estimate[i].sd / g.estimate[i].value) <=
                          1e-4 * fabs(g.estimate[i].sd / g.estimate[i].value),
                      "scale %d: sd of %s", _i, f.estimate[i].name);
    palp_lumped_fit_free(&f);
    palp_lumped_fit_free(&g);
    free_all(3, r);
    free_all(3, base);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, a_recording_scales, 0, SCALES);
    tcase_add_loop_test(tc, a_fit_scales, 0, SCALES);
}
