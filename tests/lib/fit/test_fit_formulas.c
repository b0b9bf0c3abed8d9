/* test_fit_formulas.c: blocks, bounds and intervals of a fit where they are formulas. */
#include "fit/fit_internal.h"
#include "recordings.h"

enum { MOST = 4000 };

typedef struct made {
    double time[MOST], depth[MOST], force[MOST];
    unsigned char use[MOST];
    palp_recording r;
} made;

/* A specimen of 20 mm, pressed from rest at sample 1 by 2 mm in `ramp` samples of 0.01 s, then held. */
static void press(made *m, size_t n, size_t ramp) {
    *m = (made){0};
    for (size_t i = 0; i < n; i++) {
        m->time[i] = 5.0 + 0.01 * (double)i;
        m->depth[i] = 2e-3 * fmin((double)i / (double)ramp, 1.0);
        m->force[i] = 40.0 * m->depth[i] / 0.02;
        m->use[i] = 1;
    }
    m->r = (palp_recording){.kind = PALP_RECORDING_RAMP_HOLD,
                            .n = n,
                            .time_s = m->time,
                            .depth_m = m->depth,
                            .force_N = m->force,
                            .use = m->use,
                            .height_m = 0.02,
                            .deepest_m = 2e-3,
                            .noise_N = 1e-3,
                            .ramp_end_s = 5.0 + 0.01 * (double)ramp,
                            .contact_rule = PALP_CONTACT_NOMINAL};
}

static fit_problem problem_of(const made *m, const palp_characterize_settings *s) {
    fit_problem p;
    ck_assert_int_eq(fit_problem_create(&p, 1, &m->r, s, NULL), PALP_OK);
    return p;
}

START_TEST(a_problem_in_numbers) {
    static made m;
    palp_characterize_settings s = with_arms(1);
    press(&m, 1101, 100);
    m.r.contact_sd_m = 4e-6;
    m.r.zero_sd_N = 2e-4;
    fit_problem p = problem_of(&m, &s);
    ck_assert_double_eq_tol(p.tau_min, 0.04, 1e-12);
    ck_assert_double_eq_tol(p.tau_max, 33.0, 1e-9);
    ck_assert_double_eq_tol(p.strain_max, 0.1, 1e-15);
    ck_assert_double_eq_tol(p.run[0].end, 11.0, 1e-12);
    ck_assert_double_eq_tol(p.run[0].peak, 4.0, 1e-12);
    ck_assert_double_eq_tol(p.stiffness, 4.0 * 0.02 / 2e-3, 1e-9);
    ck_assert_double_eq_tol(p.run[0].contact_sd, 4e-6 / 0.02, 1e-18);
    ck_assert_double_eq(p.run[0].zero_sd, 2e-4);
    ck_assert_double_eq(p.run[0].noise, 1e-3);
    for (size_t i = 0; i < p.run[0].n; i++) /* of a dwell every block has the same strain to the bit */
        ck_assert(p.run[0].time[i] < 1.0 || p.run[0].strain[i] == 2e-3 / 0.02);
    fit_problem_free(&p);
    m.r.noise_N = 0.0;
    m.r.contact_rule = PALP_CONTACT_FREE_AIR; /* nothing spoke against it: exact */
    p = problem_of(&m, &s);
    ck_assert_double_eq_tol(p.run[0].noise, 4e-6, 1e-15);
    ck_assert_double_eq(p.run[0].contact_sd, 0.0);
    fit_problem_free(&p);
    m.r.contact_m = 1e-5;
    s.tau_min_s = 0.5;
    s.tau_max_s = 7.0;
    p = problem_of(&m, &s);
    ck_assert_double_eq_tol(p.run[0].contact_sd, 2e-4, 1e-15);
    ck_assert_double_eq(p.tau_min, 0.5);
    ck_assert_double_eq(p.tau_max, 7.0);
    fit_problem_free(&p);
}
END_TEST

/* How many samples a block from sample `at` may have whose path is straight from sample `corner` on. */
static double longest_block(size_t at, size_t corner, double step_m) {
    double by_time = 0.02 * ((double)at - (double)corner),
           by_depth = step_m > 0.0 ? 2e-3 / 300.0 / step_m : by_time;
    return fmin(by_time, by_depth) + 1.0;
}

/* Blocks are the means of their samples, as long as they may be. */
static void blocks_are_right(const made *m, const fit_run *run, size_t n, size_t turn,
                             double (*longest)(size_t at)) {
    size_t at = 1; /* the first sample is not in contact */
    ck_assert_double_eq(run->count[0], 0.0);
    for (size_t b = 1; b < run->n; b++) {
        if (run->count[b] == 0.0) { /* the corner's last sample, for the history */
            ck_assert_double_eq_tol(run->time[b], m->time[at - 1] - 5.0, 1e-12);
            continue;
        }
        size_t count = (size_t)run->count[b], last = at + count - 1;
        double time = 0.0, depth = 0.0;
        for (size_t i = at; i <= last; i++) {
            time += (m->time[i] - 5.0) / (double)count;
            depth += m->depth[i] / (double)count;
        }
        ck_assert_double_eq_tol(run->time[b], time, 1e-9);
        ck_assert_double_eq_tol(run->strain[b], depth / 0.02, 1e-12);
        ck_assert_double_eq_tol(run->force[b], 40.0 * depth / 0.02, 1e-9);
        if ((at > turn || last < turn) && last + 1 < n) { /* rounding decides where it is a whole number */
            ck_assert_double_ge((double)count, floor(longest(at) - 1e-6));
            ck_assert_double_le((double)count, longest(at) + 1e-6);
        }
        at = last + 1;
    }
    ck_assert_uint_eq(at, n);
}

/* The ramp's 2e-6 m a sample pass the tolerance of 1e-6 m with the second sample of the hold, so the first is
 * the corner. */
static double in_ramp_and_hold(size_t at) {
    return at < 1001 ? longest_block(at, 0, 2e-6) : longest_block(at, 1001, 0.0);
}

static double there_and_back(size_t at) {
    return at < 1001 ? longest_block(at, 0, 2e-6) : longest_block(at, 1000, 2e-6);
}

START_TEST(blocks_are_as_long_as_they_may_be) {
    static made m;
    palp_characterize_settings s = with_arms(1);
    press(&m, 3001, 1000);
    fit_problem p = problem_of(&m, &s);
    blocks_are_right(&m, &p.run[0], 3001, 1001, in_ramp_and_hold);
    fit_problem_free(&p);
    press(&m, 1900, 1000);
    m.r.kind = PALP_RECORDING_OTHER;
    for (size_t i = 1001; i < 1900; i++) {
        m.depth[i] = 2e-6 * (double)(2000 - i);
        m.force[i] = 40.0 * m.depth[i] / 0.02;
    }
    p = problem_of(&m, &s);
    blocks_are_right(&m, &p.run[0], 1900, 1000, there_and_back);
    fit_problem_free(&p);
}
END_TEST

START_TEST(what_counts) {
    static made m;
    palp_characterize_settings s = with_arms(1);
    press(&m, 1101, 100);
    m.use[50] = 0;
    ck_assert(!fit_counts(&m.r, &s, 0) && fit_counts(&m.r, &s, 1) && !fit_counts(&m.r, &s, 50) &&
              fit_counts(&m.r, &s, 51));
    s.dwell_only = true;
    ck_assert(!fit_counts(&m.r, &s, 99) && fit_counts(&m.r, &s, 100));
    m.r.kind = PALP_RECORDING_STATIC;
    ck_assert(fit_counts(&m.r, &s, 99));
}
END_TEST

/* ---- K_inf alone: everything about it is a sum ---- */

typedef struct sums {
    double ee, e, ef, n; /* over the samples, each a block of its own */
} sums;

/* 60 samples, of which the first is not in contact; force 40 e and what `wrong` adds. */
static palp_lumped_fit spring_of(made *m, double (*wrong)(size_t i), sums *q) {
    *q = (sums){0};
    press(m, 60, 59);
    m->r.kind = PALP_RECORDING_STATIC;
    m->r.noise_N = 0.01;
    for (size_t i = 1; i < 60; i++) {
        double e = m->depth[i] / 0.02;
        m->force[i] += wrong(i);
        q->ee += e * e;
        q->e += e;
        q->ef += e * m->force[i];
        q->n += 1.0;
    }
    return fit(1, &m->r, with_arms(0));
}

static double nothing(size_t i) {
    (void)i;
    return 0.0;
}
static double jagged(size_t i) {
    return i % 2 ? 0.03 : -0.03;
}
static double slow(size_t i) {
    return 0.03 * sin(0.3 * (double)i);
}

static void interval_is(const palp_estimate *e, double value, double sd) {
    ck_assert_double_eq_tol(e->value, value, 1e-9 * value);
    ck_assert_double_eq_tol(e->sd, sd, 1e-6 * sd);
    ck_assert_double_eq_tol(e->low, value - 1.959963984540054 * sd, 1e-6 * sd);
    ck_assert_double_eq_tol(e->high, value + 1.959963984540054 * sd, 1e-6 * sd);
}

START_TEST(the_interval_of_a_spring) {
    static made m;
    sums q;
    palp_lumped_fit f = spring_of(&m, nothing, &q);
    ck_assert_double_lt(f.reduced_chi2, 1e-12);
    ck_assert_double_eq(f.inflation, 1.0);
    interval_is(&f.estimate[0], 40.0, 0.01 / sqrt(q.ee));
    ck_assert(f.estimate[0].determined);
    ck_assert_double_lt(f.rms_N[0], 1e-9);
    palp_lumped_fit_free(&f);
    m.r.zero_sd_N = 0.005; /* moves K by zero_sd sum(e) / sum(e^2) */
    f = fit(1, &m.r, with_arms(0));
    double white = 0.01 / sqrt(q.ee), zero = 0.005 * q.e / q.ee;
    interval_is(&f.estimate[0], 40.0, hypot(white, zero));
    palp_lumped_fit_free(&f);
    m.r.contact_sd_m = 2e-5; /* a strain of 1e-3 moves it by K times that */
    f = fit(1, &m.r, with_arms(0));
    interval_is(&f.estimate[0], 40.0, hypot(hypot(white, zero), 40.0 * 1e-3 * q.e / q.ee));
    palp_lumped_fit_free(&f);
}
END_TEST

/* Residuals at the least squares, their square and their correlation, as the interval sees them. */
static void misfit_is(double (*wrong)(size_t i)) {
    static made m;
    sums q;
    palp_lumped_fit f = spring_of(&m, wrong, &q);
    double k = q.ef / q.ee, chi2 = 0.0, next = 0.0, last = 0.0, absolute = 0.0;
    for (size_t i = 1; i < 60; i++) {
        double off = k * m.depth[i] / 0.02 - m.force[i], r = off / 0.01;
        chi2 += r * r;
        next += r * last;
        last = r;
        absolute += fabs(off);
    }
    double misfit = chi2 / (q.n - 1.0), rho = next / chi2, widen = fmax(1.0, misfit);
    if (rho > 3.0 / sqrt(q.n - 1.0))
        widen *= (1.0 + rho) / (1.0 - rho);
    ck_assert_double_eq_tol(f.reduced_chi2, misfit, 1e-6 * misfit);
    ck_assert_double_eq_tol(f.inflation, sqrt(widen), 1e-6);
    ck_assert_double_gt(misfit, 1.5);
    interval_is(&f.estimate[0], k, sqrt(widen / q.ee) * 0.01);
    ck_assert_double_eq_tol(f.rms_N[0], 0.01 * sqrt(chi2 / q.n), 1e-9);
    ck_assert_double_eq_tol(f.absolute_N[0], absolute, 1e-9);
    palp_lumped_fit_free(&f);
}

START_TEST(misfit_and_colour_widen_the_interval) {
    misfit_is(jagged); /* misfit without correlation */
    misfit_is(slow);
}
END_TEST

/* Arms: intervals are even in the logarithm, and arms more than a factor of 10 wide are not determined. */
START_TEST(the_interval_of_an_arm) {
    static made m;
    press(&m, 3001, 100);
    palp_material truth = {.n_arms = 1, .arms = {{6.0, 12.0, 0, 0}}};
    palp_element_state state = {0};
    uint64_t seed = 3;
    ck_assert_int_eq(palp_law_polynomial(1, &(double){40.0}, &truth.law), PALP_OK);
    for (int wide = 0; wide < 2; wide++) {
        double noise = wide ? 0.3 : 1e-3;
        state = (palp_element_state){0};
        for (size_t i = 0; i < 3001; i++) {
            ck_assert_int_eq(
                palp_element_advance(&truth, &state, m.depth[i] / 0.02, i ? 0.01 : 0.0, &state, NULL),
                PALP_OK);
            m.force[i] = state.force_N + noise * palp_random_normal(&seed);
        }
        m.r.noise_N = noise;
        palp_lumped_fit f = fit(1, &m.r, with_arms(1));
        for (size_t k = 1; k < 4; k++) {
            const palp_estimate *e = &f.estimate[k];
            double sd = e->sd / e->value;
            ck_assert_double_eq_tol(log(e->high / e->value), 1.959963984540054 * sd, 1e-9 * sd);
            ck_assert_double_eq_tol(log(e->value / e->low), 1.959963984540054 * sd, 1e-9 * sd);
            ck_assert(e->determined == (e->high < 10.0 * e->low));
        }
        palp_lumped_fit_free(&f);
    }
}
END_TEST

/* A press of an arm of 2 s, without noise. */
static void press_of_an_arm(made *m, double tau) {
    palp_material truth = {.n_arms = 1, .arms = {{6.0, 6.0 * tau, 0, 0}}};
    palp_element_state state = {0};
    press(m, 3001, 100);
    ck_assert_int_eq(palp_law_polynomial(1, &(double){40.0}, &truth.law), PALP_OK);
    for (size_t i = 0; i < 3001; i++) {
        ck_assert_int_eq(
            palp_element_advance(&truth, &state, m->depth[i] / 0.02, i ? 0.01 : 0.0, &state, NULL), PALP_OK);
        m->force[i] = state.force_N;
    }
}

START_TEST(times_stay_within_their_bounds) {
    static made m;
    const double low[3] = {0.05, 0.05, 4.0}, high[3] = {80.0, 1.0, 80.0}, found[3] = {2.0, 1.0, 4.0};
    press_of_an_arm(&m, 2.0);
    for (size_t k = 0; k < 3; k++) {
        palp_characterize_settings s = with_arms(1);
        s.tau_min_s = low[k];
        s.tau_max_s = high[k];
        palp_lumped_fit f = fit(1, &m.r, s);
        const palp_arm *arm = &f.material.arms[0];
        ck_assert_double_eq_tol(f.estimate[3].value, found[k], 2e-3 * found[k]); /* blocks are not samples */
        ck_assert_double_eq_tol(arm->viscosity_Ns, arm->stiffness_N * f.estimate[3].value, 1e-9);
        ck_assert_double_eq_tol(arm->stiffness_N, f.estimate[1].value, 1e-9);
        ck_assert_double_eq_tol(arm->viscosity_Ns, f.estimate[2].value, 1e-9);
        palp_lumped_fit_free(&f);
    }
}
END_TEST

/* Two arms for one whose time is between two of the grid: the pairs with a negative arm fit no worse, but
 * come last. */
START_TEST(a_first_guess_has_no_negative_arm) {
    static made m;
    palp_characterize_settings s = with_arms(2);
    press_of_an_arm(&m, 2.0);
    fit_problem p = problem_of(&m, &s);
    double start[8 * 5];
    size_t found;
    ck_assert_int_eq(fit_scan(&p, 8, start, &found), PALP_OK);
    ck_assert_uint_eq(found, 8);
    double low = exp(start[2]), high = exp(start[4]);
    ck_assert(low < 2.0 && 2.0 < high && high < 2.3 * low);
    ck_assert_double_eq_tol(exp(start[1]) + exp(start[3]), 6.0, 0.3);
    ck_assert_double_eq_tol(start[0], 40.0, 0.1);
    ck_assert_double_gt(fmin(start[1], start[3]), log(1.01e-3 * p.stiffness));
    double grid = log(p.tau_max / p.tau_min) / 14.0, place = (log(low) - log(p.tau_min)) / grid - 0.5;
    ck_assert_double_eq_tol(place, floor(place + 0.5), 1e-9);
    fit_problem_free(&p);
    press(&m, 3001, 100); /* no arm: a thousandth of the stiffness is the least to begin with */
    p = problem_of(&m, &s);
    ck_assert_int_eq(fit_scan(&p, 1, start, &found), PALP_OK);
    ck_assert_double_eq_tol(exp(fmin(start[1], start[3])), 1e-3 * p.stiffness, 1e-9);
    fit_problem_free(&p);
}
END_TEST

/* The response of an arm to a ramp and a hold is a formula. */
START_TEST(an_arm_follows_its_closed_form) {
    static made m;
    palp_characterize_settings s = with_arms(1);
    press(&m, 2001, 100);
    fit_problem p = problem_of(&m, &s);
    const fit_run *run = &p.run[0];
    double *response = malloc(3 * run->n * sizeof *response), *slope = response + run->n,
           *other = slope + run->n;
    const double tau = 0.7, rate = 0.1, end = 1.0;
    fit_arm_response(run, tau, response, slope);
    fit_arm_response(run, tau * exp(1e-6), other, NULL);
    for (size_t i = 0; i < run->n; i++) {
        double t = run->time[i], top = rate * tau * (1.0 - exp(-fmin(t, end) / tau));
        double wanted = t > end ? top * exp(-(t - end) / tau) : top;
        ck_assert_double_eq_tol(response[i], wanted, 2e-4 * rate * tau); /* blocks at the corner */
        ck_assert_double_eq_tol(slope[i], (other[i] - response[i]) / 1e-6, 1e-6);
    }
    free(response);
    fit_problem_free(&p);
}
END_TEST

/* A law that is none is ten times as far off as no force at all, in every block. */
START_TEST(no_law_is_far_off) {
    static made m;
    palp_characterize_settings s = with_law(polynomial(1, (double[1]){40.0}), 0);
    press(&m, 60, 59);
    fit_problem p = problem_of(&m, &s);
    double residual[60], jacobian[60], none = NAN;
    ck_assert_uint_eq(p.n_blocks, 60);
    ck_assert_int_eq(fit_evaluate(&p, &none, residual, jacobian), PALP_OK);
    for (size_t i = 0; i < 60; i++) {
        ck_assert_double_eq_tol(fabs(residual[i]), i ? 10.0 * m.force[i] / 1e-3 : 0.0, 1e-6);
        ck_assert_double_eq(jacobian[i], 0.0);
    }
    fit_problem_free(&p);
}
END_TEST

/* Two arms beside one spring: log K, log tau of each. */
static size_t weakest(double apart, double sd_k, double var_1, double var_2, double cov, double widen) {
    const fit_problem p = {.n_springs = 1, .n_arms = 2};
    const double v[5] = {40.0, 1.0, 0.3, 2.0, 0.3 + apart};
    double c[25] = {0};
    c[1 * 5 + 1] = 0.01;
    c[3 * 5 + 3] = sd_k * sd_k;
    c[2 * 5 + 2] = var_1;
    c[4 * 5 + 4] = var_2;
    c[2 * 5 + 4] = c[4 * 5 + 2] = cov;
    return fit_weakest_arm(&p, v, c, widen);
}

START_TEST(arms_that_cannot_be_told_apart) {
    ck_assert_uint_eq(weakest(0.15, 0.1, 1e-6, 1e-6, 0.0, 1.0), 2);
    ck_assert_uint_eq(weakest(0.13, 0.1, 1e-6, 1e-6, 0.0, 1.0), 0);
    ck_assert_uint_eq(weakest(0.61, 0.1, 0.04, 0.09, 0.02, 1.0), 2); /* sd 0.3 */
    ck_assert_uint_eq(weakest(0.59, 0.1, 0.04, 0.09, 0.02, 1.0), 0);
    ck_assert_uint_eq(weakest(0.71, 0.1, 0.04, 0.09, 0.02, 1.2), 0);
    ck_assert_uint_eq(weakest(0.73, 0.1, 0.04, 0.09, 0.02, 1.2), 2);
    ck_assert_uint_eq(weakest(2.0, 1.0, 0.0, 0.0, 0.0, 1.9), 2);
    ck_assert_uint_eq(weakest(2.0, 1.0, 0.0, 0.0, 0.0, 2.1), 1);
    ck_assert_uint_eq(weakest(2.0, 3.0, 0.0, 0.0, 0.0, 0.6), 2);
    ck_assert_uint_eq(weakest(2.0, 3.0, 0.0, 0.0, 0.0, 0.7), 1);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, no_law_is_far_off);
    tcase_add_test(tc, arms_that_cannot_be_told_apart);
    tcase_add_test(tc, a_problem_in_numbers);
    tcase_add_test(tc, blocks_are_as_long_as_they_may_be);
    tcase_add_test(tc, what_counts);
    tcase_add_test(tc, the_interval_of_a_spring);
    tcase_add_test(tc, misfit_and_colour_widen_the_interval);
    tcase_add_test(tc, the_interval_of_an_arm);
    tcase_add_test(tc, times_stay_within_their_bounds);
    tcase_add_test(tc, a_first_guess_has_no_negative_arm);
    tcase_add_test(tc, an_arm_follows_its_closed_form);
}
