/* test_fit_one_sided.c: a plate that withdraws faster than a solid of one arm recovers. Judged by the closed
 * form of the free recovery, and of the time at which the plate meets the solid again. check: valgrind */
#include "recordings.h"
#include "fit/fit_internal.h"

/* Down to DEPTH in RISE, back to 0 in as long, and so on: a spring K with an arm K1, TAU. */
static const double K = 8.0, K1 = 6.0, TAU = 1.5, DEPTH = 3.0, RISE = 2.0, HEIGHT = 24.0;

typedef struct solid {
    double rate;              /* strain a second */
    double left, left_strain; /* when the plate left, from the first corner on, and at which strain */
    double met;               /* when it met the surface again, from the second corner on */
} solid;

/* The arm's force after a time t of a ramp from q. */
static double ramp(double q, double rate, double t) {
    return q * exp(-t / TAU) - K1 * rate * TAU * expm1(-t / TAU);
}

/* Without force K e + q = 0, and so de/dt = -e K / ((K + K1) TAU). */
static double free_strain(const solid *s, double since_corner) {
    return s->left_strain * exp(-K / (K + K1) / TAU * (since_corner - s->left));
}

static double bisect(double (*f)(const solid *, double), const solid *s, double low, double high) {
    for (int i = 0; i < 200; i++) {
        double middle = 0.5 * (low + high);
        if (f(s, middle) > 0.0)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static double on_the_way_back(const solid *s, double t) {
    return K * s->rate * (RISE - t) + ramp(ramp(0.0, s->rate, RISE), -s->rate, t);
}

static double lag(const solid *s, double t) {
    return free_strain(s, RISE + t) - s->rate * t;
}

static solid solve(void) {
    solid s = {.rate = DEPTH / HEIGHT / RISE};
    s.left = bisect(on_the_way_back, &s, 0.0, RISE);
    s.left_strain = s.rate * (RISE - s.left);
    s.met = bisect(lag, &s, 0.0, RISE);
    return s;
}

/* The force at t from the first contact on, of two times down and once back. */
static double force_at(const solid *s, double t) {
    double down = t - 2.0 * RISE;
    if (t < RISE)
        return K * s->rate * t + ramp(0.0, s->rate, t);
    if (t < RISE + s->left)
        return on_the_way_back(s, t - RISE);
    if (down < s->met)
        return 0.0;
    return K * s->rate * down + ramp(-K * s->rate * s->met, s->rate, down - s->met);
}

static palp_recording cycles(double noise, uint64_t seed) {
    const double rate_Hz = 1000.0, air = 1.0;
    const solid s = solve();
    size_t n = (size_t)lround((air + 3.0 * RISE) * rate_Hz) + 1;
    palp_experiment *e;
    ck_assert_int_eq(palp_experiment_create(n, &e), PALP_OK);
    double *time = palp_experiment_column(e, "time_s"), *depth = palp_experiment_column(e, "depth_mm"),
           *force = palp_experiment_column(e, "force_N");
    for (size_t i = 0; i < n; i++) {
        double t = (double)i / rate_Hz - air;
        time[i] = (double)i / rate_Hz;
        depth[i] = DEPTH / RISE * (t < RISE ? t : t < 2.0 * RISE ? 2.0 * RISE - t : t - 2.0 * RISE);
        force[i] =
            (t > 0.0 ? force_at(&s, t) : 0.0) + (noise > 0.0 ? noise * palp_random_normal(&seed) : 0.0);
    }
    palp_experiment_set_number(e, "specimen.height_mm", HEIGHT);
    return prepare(e);
}

static palp_characterize_settings one_arm(void) {
    const double one = 1.0;
    return with_law(polynomial(1, &one), 1);
}

START_TEST(a_fit_of_cycles_finds_the_solid) {
    palp_recording r = cycles(0.0, 0);
    palp_lumped_fit f = fit(1, &r, one_arm());
    ck_assert(f.converged);
    ck_assert_double_eq_tol(f.material.law.coefficients[0], K, 2e-4 * K);
    ck_assert_double_eq_tol(f.material.arms[0].stiffness_N, K1, 2e-4 * K1);
    ck_assert_double_eq_tol(f.material.arms[0].viscosity_Ns, K1 * TAU, 3e-4 * K1 * TAU);
    palp_lumped_fit_free(&f);
    palp_recording_free(&r);
}
END_TEST

START_TEST(the_force_is_the_closed_form) {
    palp_recording r = cycles(0.0, 0);
    const solid s = solve();
    palp_lumped_fit f = fit(1, &r, one_arm());
    double *force = malloc(r.n * sizeof *force), start = -1.0, end = -1.0;
    f.material.law = polynomial(1, &K);
    f.material.arms[0] = (palp_arm){.stiffness_N = K1, .viscosity_Ns = K1 * TAU};
    ck_assert_int_eq(palp_lumped_fit_force(&f, 0, &r, force), PALP_OK);
    for (size_t i = 0; i < r.n; i++) {
        double t = r.time_s[i] - r.time_s[0] - 1.0;
        ck_assert_double_eq_tol(force[i], t > 0.0 ? force_at(&s, t) : 0.0, 1e-5);
        if (t > RISE && start < 0.0 && force[i] <= 0.0)
            start = t - RISE;
        if (t > 2.0 * RISE && end < 0.0 && force[i] > 0.0)
            end = t - 2.0 * RISE;
    }
    ck_assert_double_eq_tol(start, s.left, 1.1e-3); /* a sample */
    ck_assert_double_eq_tol(end, s.met, 1.1e-3);
    free(force);
    palp_lumped_fit_free(&f);
    palp_recording_free(&r);
}
END_TEST

START_TEST(with_noise_the_truth_is_within_four_sds) {
    palp_recording r = cycles(0.004, 7 + (uint64_t)_i);
    palp_lumped_fit f = fit(1, &r, one_arm());
    const double truth[] = {K, K1, K1 * TAU, TAU};
    ck_assert_uint_eq(f.n_estimates, 4);
    for (size_t k = 0; k < 4; k++) {
        double off = (f.estimate[k].value - truth[k]) / f.estimate[k].sd;
        ck_assert_msg(fabs(off) < 4.0, "%s: %g, off by %.1f sds", f.estimate[k].name, f.estimate[k].value,
                      off);
        ck_assert_double_lt(f.estimate[k].sd, 0.02 * truth[k]);
    }
    ck_assert_double_eq_tol(f.rms_N[0], 0.004, 0.0004);
    palp_lumped_fit_free(&f);
    palp_recording_free(&r);
}
END_TEST

/* A contact that pulls as much as it takes, as glued, is fitted as one. */
START_TEST(a_contact_that_pulls_is_left_to_pull) {
    palp_recording r = cycles(0.0, 0);
    const double one = K;
    palp_material m = {.law = polynomial(1, &one), .n_arms = 1, .arms = {{K1, K1 * TAU, 0, 0}}};
    palp_element_state s = {0};
    double least = 0.0;
    for (size_t i = 0; i < r.n; i++) {
        double dt = i ? r.time_s[i] - r.time_s[i - 1] : 0.0;
        ck_assert_int_eq(palp_element_advance(&m, &s, fmax(r.depth_m[i], 0.0) / r.height_m, dt, &s, NULL),
                         PALP_OK);
        r.force_N[i] = s.force_N;
        least = fmin(least, s.force_N);
    }
    ck_assert_double_lt(least, -0.1);
    palp_lumped_fit f = fit(1, &r, one_arm());
    ck_assert_double_eq_tol(f.material.law.coefficients[0], K, 2e-4 * K);
    ck_assert_double_eq_tol(f.material.arms[0].stiffness_N, K1, 2e-4 * K1);
    ck_assert_double_lt(f.rms_N[0], 1e-4);
    palp_lumped_fit_free(&f);
    palp_recording_free(&r);
}
END_TEST

/* A law that a fit tries on its way may pull near rest and be free of force far inside: the surface does not
 * jump there. */
START_TEST(a_surface_goes_no_way_that_nothing_pushed_it) {
    const double pulling[] = {-2.0, 10.0}, time[] = {0.0, 1.0, 2.0, 3.0};
    const palp_material m = {.law = polynomial(2, pulling), .n_arms = 1, .arms = {{0.1, 0.1 * TAU, 0, 0}}};
    const double strain[] = {0.01, 0.02, 0.01, 0.015};
    double at[] = {0.01, 0.02, 0.01, 0.015};
    palp_element_state glued = {0};
    fit_force_one_sided(&m, 4, time, at);
    for (size_t i = 0; i < 4; i++) {
        ck_assert_int_eq(palp_element_advance(&m, &glued, strain[i], i ? 1.0 : 0.0, &glued, NULL), PALP_OK);
        ck_assert_double_eq_tol(at[i], glued.force_N, 1e-12);
    }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, a_surface_goes_no_way_that_nothing_pushed_it);
    tcase_add_test(tc, a_fit_of_cycles_finds_the_solid);
    tcase_add_test(tc, the_force_is_the_closed_form);
    tcase_add_loop_test(tc, with_noise_the_truth_is_within_four_sds, 0, 5);
    tcase_add_test(tc, a_contact_that_pulls_is_left_to_pull);
}
