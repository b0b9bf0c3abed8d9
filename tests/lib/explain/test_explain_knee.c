/* test_explain_knee.c: a law with a knee, in correlated noise that hides little of what changes from sample
 * to sample: a law of more knots follows it, and what one of too few misses is no uneven surface. check: once
 */
#include "forward_make.h"

#include <palpate/explain.h>

enum { RUNS = 6, LEGS = 20, KNOTS = 30, BEFORE = 8 };

static const double TICK = 0.02, KEEP = 0.8, DEEP_MM = 4.8, KNEE = 0.1063;

typedef struct leg {
    double depth_mm;
    size_t n; /* samples */
} leg;

/* Three times as stiff beyond the knee, after which its knots are dense. */
static palp_model knee_model(void) {
    palp_model m = linear_model(20);
    double strain[KNOTS], stiffness[KNOTS];
    for (size_t i = 0; i < KNOTS; i++)
        strain[i] = i <= BEFORE ? KNEE * (double)i / BEFORE
                                : KNEE + 5e-4 * pow(240, (double)(i - BEFORE) / (KNOTS - BEFORE - 1));
    for (size_t i = 0; i < KNOTS; i++)
        stiffness[i] = 20 * (strain[i] <= KNEE ? 1 : 3 - 2 * KNEE / strain[i]);
    ck_assert_int_eq(palp_law_spline(KNOTS, strain, stiffness, &m.material.law), PALP_OK);
    m.material.n_arms = 1;
    m.material.arms[0] = (palp_arm){18, 4, 0, 0};
    return m;
}

/* The way of run r, in legs: cycles of one in three speeds, presses that wait. */
static size_t way(size_t r, leg *legs) {
    static const size_t times[] = {1, 3, 8}, slow[] = {250, 60, 20};
    size_t n = 0;
    legs[n++] = (leg){-1.4, 40};
    for (size_t k = 0; r < 3 && k < times[r]; k++) {
        legs[n++] = (leg){DEEP_MM, slow[r]};
        legs[n++] = (leg){k + 1 < times[r] ? 0 : -1.4, slow[r]};
    }
    if (r >= 3) {
        double deep_mm = DEEP_MM * (0.6 + 0.2 * (double)(r - 3));
        legs[n++] = (leg){deep_mm, r == 4 ? 160 : 40};
        legs[n++] = (leg){deep_mm, 350};
        legs[n++] = (leg){-1.4, 50};
    }
    legs[n++] = (leg){-1.4, 60};
    return n;
}

static palp_experiment *record(const palp_model *m, size_t r, double sd, uint64_t *state) {
    static const double surface_mm[RUNS] = {-0.04, -0.03, 0.06, 0.02, -0.05, 0.02};
    static samples s;
    leg legs[LEGS];
    palp_experiment *e;
    const size_t n_legs = way(r, legs);
    double noise = sd * white_noise(state);
    start(&s, 0, -1.4 - surface_mm[r]);
    for (size_t k = 0; k < n_legs; k++) {
        const double from = s.depth_m[s.n - 1], to = 1e-3 * (legs[k].depth_mm - surface_mm[r]);
        for (size_t i = 1; i <= legs[k].n; i++, s.n++) {
            s.time_s[s.n] = TICK * (double)s.n;
            s.depth_m[s.n] = from + (to - from) * (double)i / (double)legs[k].n;
        }
    }
    press_model(m, &s);
    ck_assert_int_eq(palp_experiment_create(s.n, &e), PALP_OK);
    for (size_t i = 0; i < s.n; i++) {
        palp_experiment_column(e, "time_s")[i] = s.time_s[i];
        palp_experiment_column(e, "depth_mm")[i] = 1e3 * s.depth_m[i] + surface_mm[r];
        palp_experiment_column(e, "force_N")[i] = s.force_N[i] + noise;
        noise = KEEP * noise + sd * sqrt(1 - KEEP * KEEP) * white_noise(state);
    }
    return e;
}

/* What is said of the runs of that model, if a polynomial is the law that is given. sd, state: of the noise.
 */
static palp_explanation answer(const palp_model *truth, double sd, uint64_t state) {
    static const double law[] = {38.5, -662, 6371, -15284};
    palp_explain_settings settings = palp_explain_settings_default();
    palp_explain_input input[RUNS];
    palp_explanation e;
    palp_model m = *truth;
    m.n_effects = 0;
    ck_assert_int_eq(palp_law_polynomial(4, law, &m.material.law), PALP_OK);
    memset(settings.candidate, 0, sizeof settings.candidate);
    settings.candidate[PALP_EFFECT_TOE_REGION] = 1;
    for (size_t r = 0; r < RUNS; r++)
        input[r] = (palp_explain_input){record(truth, r, sd, &state), "run"};
    ck_assert_int_eq(palp_explain(&m, RUNS, input, &settings, &e, NULL), PALP_OK);
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
    return e;
}

START_TEST(a_knee_of_the_law_is_no_toe) {
    static const uint64_t noises[] = {
        2, 47}; /* the stiffness at the surface, of which the runs say little, is driven to zero */
    const palp_model m = knee_model();
    const double sd = 0.02;
    for (size_t k = 0; k < sizeof noises / sizeof *noises; k++) {
        palp_explanation e = answer(&m, sd, noises[k]);
        ck_assert(e.law.found);
        ck_assert_msg(e.gap.after_N < 1.05 * sd, "noise %zu: %g N are left", k, e.gap.after_N);
        ck_assert_msg(e.n_effects == 0, "noise %zu: a toe of %g mm is named", k,
                      1e3 * e.effect[0].effect.value[0]);
        palp_explanation_free(&e);
    }
}
END_TEST

/* Of 14 knots the spacing is a thirteenth of the strain: at the knee it is at most half of that, whether a
 * few more were put there or twice as many everywhere. */
START_TEST(knots_are_close_at_a_knee) {
    const palp_model m = knee_model();
    palp_explanation e = answer(&m, 0.05, 1);
    const palp_law *law = &e.model.material.law;
    ck_assert_msg(law->kind == PALP_LAW_SPLINE && law->n > 14, "%zu coefficients", law->n);
    size_t i = 0;
    while (i + 2 < law->n && law->strain[i + 1] < KNEE)
        i++;
    const double apart = law->strain[i + 1] - law->strain[i], evenly = law->strain[law->n - 1] / 13;
    ck_assert_msg(apart < 0.51 * evenly, "the knots at the knee are %g apart", apart);
    palp_explanation_free(&e);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, knots_are_close_at_a_knee);
    tcase_add_test(tc, a_knee_of_the_law_is_no_toe);
}
