/* test_closed_form.c: closed forms against the integrated models, their limits and one another. */
#include "closed_form_make.h"

typedef struct problem {
    palp_generalized_maxwell model; /* arms in parallel with the spring */
    double voigt_Pa_s;              /* or: one dashpot beside the spring, no arms (creep only) */
    double stress;                  /* creep */
    double strain, rate, ramp_s;    /* else strain + rate min(t, ramp_s) */
} problem;

static double strain_of(const problem *p, double t, const double *y) {
    if (p->voigt_Pa_s > 0.0)
        return y[0];
    if (p->stress == 0.0)
        return p->strain + p->rate * fmin(t, p->ramp_s);
    double sum = p->stress, modulus = p->model.spring_Pa;
    for (size_t j = 0; j < p->model.n_arms; j++) {
        sum += p->model.arms[j].modulus_Pa * y[j];
        modulus += p->model.arms[j].modulus_Pa;
    }
    return sum / modulus;
}

/* y: the strains of the dashpots. */
static void flow(const problem *p, double t, const double *y, double *dy) {
    double e = strain_of(p, t, y);
    for (size_t j = 0; j < p->model.n_arms; j++)
        dy[j] = p->model.arms[j].modulus_Pa * (e - y[j]) / p->model.arms[j].viscosity_Pa_s;
    if (p->voigt_Pa_s > 0.0)
        dy[0] = (p->stress - p->model.spring_Pa * y[0]) / p->voigt_Pa_s;
}

static void rk4(const problem *p, double from, double to, double *y) {
    double h = (to - from) / STEPS, k[4][STATES], z[STATES];
    for (int i = 0; i < STEPS; i++) {
        double t = from + i * h;
        flow(p, t, y, k[0]);
        for (int s = 1; s < 4; s++) {
            double part = s == 3 ? h : 0.5 * h;
            for (int j = 0; j < STATES; j++)
                z[j] = y[j] + part * k[s - 1][j];
            flow(p, t + part, z, k[s]);
        }
        for (int j = 0; j < STATES; j++)
            y[j] += h / 6.0 * (k[0][j] + 2.0 * k[1][j] + 2.0 * k[2][j] + k[3][j]);
    }
}

/* Strain (creep) or stress at t; the corner at ramp_s is a step of its own. */
static double integrate(problem p, double t) {
    double y[STATES] = {0.0};
    double corner = p.rate != 0.0 ? fmin(t, p.ramp_s) : 0.0;
    if (corner > 0.0)
        rk4(&p, 0.0, corner, y);
    rk4(&p, corner, t, y);
    double e = strain_of(&p, t, y), stress = p.model.spring_Pa * e;
    if (p.stress != 0.0)
        return e;
    for (size_t j = 0; j < p.model.n_arms; j++)
        stress += p.model.arms[j].modulus_Pa * (e - y[j]);
    return stress;
}

static palp_generalized_maxwell one_arm(double spring) {
    return (palp_generalized_maxwell){.spring_Pa = spring, .n_arms = 1, .arms = {one}};
}

static double generalized_creep(const palp_generalized_maxwell *model, double stress, double t) {
    palp_retardation spectrum;
    ck_assert_int_eq(palp_retardation_spectrum(model, &spectrum), PALP_OK);
    return palp_generalized_maxwell_creep(&spectrum, stress, t);
}

START_TEST(maxwell_meets_its_equation) {
    double t = times[_i];
    problem p = {.model = one_arm(0.0), .stress = 3.0};
    CLOSE(palp_maxwell_creep(one, 3.0, t), integrate(p, t), rk4_error);
    p = (problem){.model = one_arm(0.0), .strain = 0.25};
    CLOSE(palp_maxwell_relaxation(one, 0.25, t), integrate(p, t), rk4_error);
    p = (problem){.model = one_arm(0.0), .rate = 0.1, .ramp_s = INFINITY};
    CLOSE(palp_maxwell_ramp(one, 0.1, t), integrate(p, t), rk4_error);
    p.ramp_s = 1.3;
    CLOSE(palp_maxwell_ramp_hold(one, 0.1, 1.3, t), integrate(p, t), rk4_error);
}
END_TEST

START_TEST(voigt_meets_its_equation) {
    double t = times[_i], impulse;
    problem p = {.model = {.spring_Pa = one.modulus_Pa}, .voigt_Pa_s = one.viscosity_Pa_s, .stress = 3.0};
    CLOSE(palp_voigt_creep(one, 3.0, t), integrate(p, t), rk4_error);
    /* after that Eq. 3.26 with strain and rate inserted */
    CLOSE(palp_voigt_ramp(one, 0.1, t), 17.873062 * 0.1 + 1.2962987 * 0.1 * t, 1e-14);
    double held = t <= 1.3 ? palp_voigt_ramp(one, 0.1, t) : 1.2962987 * 0.13;
    CLOSE(palp_voigt_ramp_hold(one, 0.1, 1.3, t), held, 1e-14);
    CLOSE(palp_voigt_relaxation(one, 0.25, t, &impulse), 0.25 * 1.2962987, 1e-14);
    ck_assert_double_eq(palp_voigt_relaxation(one, 0.25, t, NULL), 0.25 * 1.2962987);
}
END_TEST

/* The impulse of a ramp to 0.25 in ever shorter time: its mean stress times its time. */
START_TEST(voigt_impulse_is_that_of_a_short_ramp) {
    double impulse, ramp = 1e-9;
    palp_voigt_relaxation(one, 0.25, 1.0, &impulse);
    double mean = palp_voigt_ramp(one, 0.25 / ramp, 0.5 * ramp);
    CLOSE(impulse, mean * ramp, 1e-9);
}
END_TEST

START_TEST(maxwell_solid_meets_its_equation) {
    double t = times[_i];
    problem p = {.model = one_arm(9.0), .stress = 3.0};
    CLOSE(palp_maxwell_solid_creep(9.0, one, 3.0, t), integrate(p, t), rk4_error);
    p = (problem){.model = one_arm(9.0), .strain = 0.25};
    CLOSE(palp_maxwell_solid_relaxation(9.0, one, 0.25, t), integrate(p, t), rk4_error);
    p = (problem){.model = one_arm(9.0), .rate = 0.1, .ramp_s = INFINITY};
    CLOSE(palp_maxwell_solid_ramp(9.0, one, 0.1, t), integrate(p, t), rk4_error);
    p.ramp_s = 1.3;
    CLOSE(palp_maxwell_solid_ramp_hold(9.0, one, 0.1, 1.3, t), integrate(p, t), rk4_error);
}
END_TEST

/* Solids and liquids of 0 to 5 arms; the fifth arm pairs up with no other, solid 6 has equal times. */
static palp_generalized_maxwell sample_solid(int i) {
    if (i < 6)
        return solid(8.18, (size_t)i);
    palp_generalized_maxwell model = solid(i == 6 ? 2.0 : 0.0, 5);
    model.arms[3] = (palp_spring_dashpot){14.0, 7.0}; /* tau as that of arms[2] */
    return model;
}
enum { SAMPLE_SOLIDS = 8 };

START_TEST(generalized_maxwell_meets_its_equations) {
    palp_generalized_maxwell model = sample_solid(_i);
    for (int i = 0; i < TIMES; i++) {
        double t = times[i];
        problem p = {.model = model, .stress = 3.0};
        CLOSE(generalized_creep(&model, 3.0, t), integrate(p, t), rk4_error);
        p = (problem){.model = model, .strain = 0.25};
        CLOSE(palp_generalized_maxwell_relaxation(&model, 0.25, t), integrate(p, t), rk4_error);
        p = (problem){.model = model, .rate = 0.1, .ramp_s = INFINITY};
        CLOSE(palp_generalized_maxwell_ramp(&model, 0.1, t), integrate(p, t), rk4_error);
        p.ramp_s = 1.3;
        CLOSE(palp_generalized_maxwell_ramp_hold(&model, 0.1, 1.3, t), integrate(p, t), rk4_error);
    }
}
END_TEST

START_TEST(one_arm_is_the_maxwell_solid) {
    for (int i = 0; i < 2 * TIMES; i++) {
        double t = times[i / 2], spring = i % 2 ? 0.0 : 9.0; /* 0: the Maxwell model */
        palp_generalized_maxwell model = one_arm(spring);
        CLOSE(generalized_creep(&model, 3.0, t), palp_maxwell_solid_creep(spring, one, 3.0, t), 1e-13);
        CLOSE(palp_generalized_maxwell_relaxation(&model, 0.2, t),
              palp_maxwell_solid_relaxation(spring, one, 0.2, t), 1e-14);
        CLOSE(palp_generalized_maxwell_ramp(&model, 0.2, t), palp_maxwell_solid_ramp(spring, one, 0.2, t),
              1e-14);
        CLOSE(palp_generalized_maxwell_ramp_hold(&model, 0.2, 1.3, t),
              palp_maxwell_solid_ramp_hold(spring, one, 0.2, 1.3, t), 1e-14);
    }
    CLOSE(palp_maxwell_solid_creep(0.0, one, 3.0, 2.0), palp_maxwell_creep(one, 3.0, 2.0), 1e-15);
    CLOSE(palp_maxwell_solid_creep(1e-14, one, 3.0, 2.0), palp_maxwell_creep(one, 3.0, 2.0), 1e-13);
}
END_TEST

/* Eq. 3.42 with 3.43 and Eq. 3.44 as printed. */
START_TEST(maxwell_solid_is_eq342_and_eq344) {
    double spring = 9.0, tau = one.viscosity_Pa_s / one.modulus_Pa;
    double tau_sigma = one.viscosity_Pa_s / spring * (1.0 + spring / one.modulus_Pa);
    for (int i = 0; i < TIMES; i++) {
        double t = times[i], creep = (1.0 - (1.0 - tau / tau_sigma) * exp(-t / tau_sigma)) / spring;
        CLOSE(palp_maxwell_solid_creep(spring, one, 3.0, t), 3.0 * creep, 1e-14);
        double relaxation = spring * (1.0 - (1.0 - tau_sigma / tau) * exp(-t / tau));
        CLOSE(palp_maxwell_solid_relaxation(spring, one, 0.25, t), 0.25 * relaxation, 1e-14);
    }
}
END_TEST

START_TEST(limits_are_glassy_and_rubbery) {
    palp_generalized_maxwell model = solid(8.18, 5);
    double glassy = 8.18 + 2.5847711 + 0.6853036 + 7.0 + 0.05 + 1.0;
    CLOSE(generalized_creep(&model, 3.0, 0.0), 3.0 / glassy, 1e-14);
    CLOSE(generalized_creep(&model, 3.0, 1e6), 3.0 / 8.18, 1e-13);
    CLOSE(palp_generalized_maxwell_relaxation(&model, 0.2, 0.0), 0.2 * glassy, 1e-14);
    CLOSE(palp_generalized_maxwell_relaxation(&model, 0.2, 1e6), 0.2 * 8.18, 1e-14);
    CLOSE(palp_generalized_maxwell_ramp(&model, 0.2, 1e-12), 0.2e-12 * glassy, 1e-11);
    CLOSE(palp_generalized_maxwell_ramp_hold(&model, 0.2, 1e5, 1e5 + 1e6), 0.2e5 * 8.18, 1e-14);
    CLOSE(palp_generalized_maxwell_ramp_hold(&model, 2e12, 1e-13, 0.7),
          palp_generalized_maxwell_relaxation(&model, 0.2, 0.7), 1e-12); /* a fast ramp is a step */
    CLOSE(palp_voigt_creep(one, 3.0, 1e6), 3.0 / one.modulus_Pa, 1e-15);
    ck_assert_double_eq(palp_voigt_creep(one, 3.0, 0.0), 0.0);
    CLOSE(palp_maxwell_ramp(one, 0.1, 1e6), 0.1 * one.viscosity_Pa_s, 1e-15);
}
END_TEST

START_TEST(nothing_happens_before_time_zero) {
    palp_generalized_maxwell model = solid(8.18, 2);
    double t = -1e-3;
    ck_assert_double_eq(palp_maxwell_creep(one, 1.0, t) + palp_maxwell_relaxation(one, 1.0, t), 0.0);
    ck_assert_double_eq(palp_maxwell_ramp(one, 1.0, t) + palp_maxwell_ramp_hold(one, 1.0, 1.0, t), 0.0);
    ck_assert_double_eq(palp_voigt_creep(one, 1.0, t) + palp_voigt_relaxation(one, 1.0, t, NULL), 0.0);
    ck_assert_double_eq(palp_voigt_ramp(one, 1.0, t) + palp_voigt_ramp_hold(one, 1.0, 1.0, t), 0.0);
    ck_assert_double_eq(palp_maxwell_solid_creep(1.0, one, 1.0, t), 0.0);
    ck_assert_double_eq(palp_maxwell_solid_relaxation(1.0, one, 1.0, t), 0.0);
    ck_assert_double_eq(palp_maxwell_solid_ramp(1.0, one, 1.0, t), 0.0);
    ck_assert_double_eq(palp_maxwell_solid_ramp_hold(1.0, one, 1.0, 1.0, t), 0.0);
    ck_assert_double_eq(generalized_creep(&model, 1.0, t), 0.0);
    ck_assert_double_eq(palp_generalized_maxwell_relaxation(&model, 1.0, t), 0.0);
    ck_assert_double_eq(palp_generalized_maxwell_ramp(&model, 1.0, t), 0.0);
    ck_assert_double_eq(palp_generalized_maxwell_ramp_hold(&model, 1.0, 1.0, t), 0.0);
}
END_TEST

/* 16 arms over 15 decades, moduli over 8: the compliances must add up and the times interlace. */
START_TEST(wide_spectra_are_found) {
    palp_generalized_maxwell model = {.spring_Pa = 1e-3, .n_arms = 16};
    double glassy = 1e-3, tau[16];
    for (int j = 0; j < 16; j++) {
        double modulus = pow(10.0, (j * 5) % 9 - 4);
        tau[j] = pow(10.0, 8 - j);
        model.arms[15 - j] = (palp_spring_dashpot){modulus, modulus * tau[j]};
        glassy += modulus;
    }
    palp_retardation spectrum;
    ck_assert_int_eq(palp_retardation_spectrum(&model, &spectrum), PALP_OK);
    ck_assert_uint_eq(spectrum.n, 16);
    CLOSE(spectrum.instant_1_Pa, 1.0 / glassy, 1e-14);
    double sum = spectrum.instant_1_Pa;
    for (int k = 0; k < 16; k++) {
        sum += spectrum.compliance_1_Pa[k];
        ck_assert_double_gt(spectrum.compliance_1_Pa[k], 0.0);
        ck_assert_double_gt(spectrum.time_s[k], tau[k] * (1.0 - 1e-15));
        if (k > 0)
            ck_assert_double_lt(spectrum.time_s[k], tau[k - 1] * (1.0 + 1e-15));
    }
    CLOSE(sum, 1e3, 1e-12); /* 1 / E_inf */
}
END_TEST

/* s E(s) s J(s) = 1 at a few s: the identity that defines creep from relaxation. */
START_TEST(creep_is_the_reciprocal_of_relaxation) {
    palp_generalized_maxwell model = sample_solid(_i);
    palp_retardation spectrum;
    ck_assert_int_eq(palp_retardation_spectrum(&model, &spectrum), PALP_OK);
    for (double s = 1e-4; s < 1e4; s *= 7.3) {
        double e = model.spring_Pa, j = spectrum.instant_1_Pa + spectrum.fluidity_1_Pa_s / s;
        for (size_t k = 0; k < model.n_arms; k++) {
            double tau = model.arms[k].viscosity_Pa_s / model.arms[k].modulus_Pa;
            e += model.arms[k].modulus_Pa * s * tau / (1.0 + s * tau);
        }
        for (size_t k = 0; k < spectrum.n; k++)
            j += spectrum.compliance_1_Pa[k] / (1.0 + s * spectrum.time_s[k]);
        CLOSE(e * j, 1.0, 1e-13);
    }
}
END_TEST

START_TEST(bad_solids_are_refused) {
    palp_retardation spectrum;
    palp_generalized_maxwell model = solid(0.0, 0);
    ck_assert_int_eq(palp_retardation_spectrum(&model, &spectrum), PALP_ERR_ARGUMENT);
    model = solid(-1.0, 1);
    ck_assert_int_eq(palp_retardation_spectrum(&model, &spectrum), PALP_ERR_ARGUMENT);
    model = solid(1.0, 2);
    model.arms[1].viscosity_Pa_s = 0.0;
    ck_assert_int_eq(palp_retardation_spectrum(&model, &spectrum), PALP_ERR_ARGUMENT);
    model.arms[1] = (palp_spring_dashpot){INFINITY, 1.0};
    ck_assert_int_eq(palp_retardation_spectrum(&model, &spectrum), PALP_ERR_ARGUMENT);
    model.n_arms = PALP_ARMS_MAX + 1;
    ck_assert_int_eq(palp_retardation_spectrum(&model, &spectrum), PALP_ERR_LIMIT);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, maxwell_meets_its_equation, 0, TIMES);
    tcase_add_loop_test(tc, voigt_meets_its_equation, 0, TIMES);
    tcase_add_test(tc, voigt_impulse_is_that_of_a_short_ramp);
    tcase_add_loop_test(tc, maxwell_solid_meets_its_equation, 0, TIMES);
    tcase_add_loop_test(tc, generalized_maxwell_meets_its_equations, 0, SAMPLE_SOLIDS);
    tcase_add_test(tc, one_arm_is_the_maxwell_solid);
    tcase_add_test(tc, maxwell_solid_is_eq342_and_eq344);
    tcase_add_test(tc, limits_are_glassy_and_rubbery);
    tcase_add_test(tc, nothing_happens_before_time_zero);
    tcase_add_test(tc, wide_spectra_are_found);
    tcase_add_loop_test(tc, creep_is_the_reciprocal_of_relaxation, 0, SAMPLE_SOLIDS);
    tcase_add_test(tc, bad_solids_are_refused);
}
