/* test_fit_coverage.c: the 95 % intervals cover the truth in 90 to 98 of 100 simulated recordings.
 * check: all */
#include "recordings.h"

#include <stdio.h>

enum { REPEATS = 600, RUNS_MAX = 3, ESTIMATES_MAX = 16 };

/* The truth of estimate i of a fit of n runs: springs of 9.0, 9.3 ... N, then K, b, tau of each arm. */
static double truth(const palp_material *m, size_t n, size_t i) {
    if (i < n)
        return 9.0 + 0.3 * (double)i;
    const palp_arm *arm = &m->arms[(i - n) / 3];
    double tau = arm->viscosity_Ns / arm->stiffness_N;
    return (i - n) % 3 == 0 ? arm->stiffness_N : (i - n) % 3 == 1 ? arm->viscosity_Ns : tau;
}

/* Counts the intervals of one fit that cover. */
static void fit_once(palp_material m, size_t n, uint64_t seed, size_t *covered) {
    palp_recording r[RUNS_MAX];
    for (size_t q = 0; q < n; q++) {
        double spring = truth(&m, n, q);
        m.law = polynomial(1, &spring);
        take t = {m, 4.0 + (double)q, 1.0, 20.0, 1.0, 100.0, 0.004, "ramp_hold", 1000 * seed + q};
        r[q] = prepare(record(&t));
    }
    palp_lumped_fit f = fit(n, r, with_arms(m.n_arms));
    ck_assert_uint_eq(f.n_merged, 0);
    ck_assert_uint_eq(f.n_estimates, n + 3 * m.n_arms);
    for (size_t i = 0; i < f.n_estimates; i++) {
        double known = truth(&m, n, i);
        covered[i] += f.estimate[i].low <= known && known <= f.estimate[i].high;
    }
    palp_lumped_fit_free(&f);
    free_all(n, r);
}

static void intervals_cover(const char *what, palp_material m, size_t n) {
    size_t covered[ESTIMATES_MAX] = {0}, count = n + 3 * m.n_arms;
    for (uint64_t seed = 1; seed <= REPEATS; seed++)
        fit_once(m, n, seed, covered);
    printf("%s:", what);
    for (size_t i = 0; i < count; i++)
        printf(" %.1f %%", 100.0 * (double)covered[i] / REPEATS);
    printf("\n");
    for (size_t i = 0; i < count; i++) {
        ck_assert_uint_ge(covered[i], REPEATS * 90 / 100);
        ck_assert_uint_le(covered[i], REPEATS * 98 / 100);
    }
}

static const palp_material ONE = {.n_arms = 1, .arms = {{1.2, 3.6, 0, 0}}};
static const palp_material TWO = {.n_arms = 2, .arms = {{2.4, 1.2, 0, 0}, {0.7, 3.5, 0, 0}}};

START_TEST(one_arm) {
    intervals_cover("one arm: K_inf, K, b, tau", ONE, 1);
}
END_TEST

START_TEST(two_arms_of_one_run) {
    intervals_cover("two arms: K_inf, K, b, tau, K, b, tau", TWO, 1);
}
END_TEST

START_TEST(two_arms_shared_by_three_runs) {
    intervals_cover("two arms of three runs: K_inf of each, K, b, tau, K, b, tau", TWO, 3);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, one_arm);
    tcase_add_test(tc, two_arms_of_one_run);
    tcase_add_test(tc, two_arms_shared_by_three_runs);
}
