/* test_explain_wander.c: zeros that wander are distinguished from effects of the catalogue. check: once */
#include "explain/explain_lines.h"
#include "explain/explain_fit.h"
#include "forward_make.h"

enum { RUNS = 7, EACH = 400 };
static const double NOISE = 0.01; /* N */

/* What the zero of run r is at a share of its length, N. */
typedef double zero_of(size_t r, double share);

static double still(size_t r, double share) {
    (void)share;
    return 0.1 * (double)(r % 3);
}

/* By two noise levels in every second run, in one direction, at one place: as near to a drift of all runs as
 * such zeros come. */
static double some_jump(size_t r, double share) {
    return r % 2 == 0 && share > 0.45 ? -2 * NOISE : 0;
}

static double all_drift(size_t r, double share) {
    return still(r, share) - NOISE * share;
}

static palp_explain_input input[RUNS];

/* Presses and withdrawals at several speeds, with dwells, of the model, in samples of 0.05 s. */
static void record(const palp_model *m, zero_of *zero) {
    static samples s;
    uint64_t noise = 4;
    for (size_t r = 0; r < RUNS; r++) {
        const size_t ramp = 40 + 20 * r, rest = EACH - 2 * ramp - 20;
        start(&s, 0, -1);
        for (size_t i = 1; i < EACH; i++) {
            const double up = 6.0 * (double)i / (double)ramp,
                         down = 6.0 * ((double)EACH - (double)i - 20.0) / (double)ramp;
            s.time_s[i] = 0.05 * (double)i;
            s.depth_m[i] = 1e-3 * fmax(-1, fmin(5, fmin(up, i > ramp + rest ? down : 6.0) - 1));
        }
        s.n = EACH;
        press_model(m, &s);
        for (size_t i = 0; i < EACH; i++)
            s.force_N[i] = s.force_N[i] + zero(r, (double)i / EACH) + NOISE * white_noise(&noise);
        input[r] = (palp_explain_input){samples_experiment(&s), "run.csv"};
    }
}

static void forget(void) {
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}

/* Number of effects, where a drift is all that may be named. */
static size_t drifts(zero_of *zero, palp_explanation *e) {
    const palp_model m = lumped_model(1);
    palp_explain_settings settings = palp_explain_settings_default();
    palp_error error = {.text = ""};
    memset(settings.candidate, 0, sizeof settings.candidate);
    settings.candidate[PALP_EFFECT_SENSOR_DRIFT] = true;
    record(&m, zero);
    ck_assert_msg(palp_explain(&m, RUNS, input, &settings, e, &error) == PALP_OK, "%s", error.text);
    forget();
    return e->n_effects;
}

START_TEST(zeros_that_jump_are_no_drift) {
    palp_explanation e;
    ck_assert_uint_eq(drifts(some_jump, &e), 0);
    palp_explanation_free(&e);
}
END_TEST

START_TEST(a_drift_is_found) {
    palp_explanation e;
    ck_assert_uint_eq(drifts(all_drift, &e), 1);
    ck_assert_int_eq(e.effect[0].effect.id, PALP_EFFECT_SENSOR_DRIFT);
    ck_assert_double_eq_tol(e.effect[0].effect.value[0], -NOISE / (0.05 * EACH), 0.3 * NOISE / (0.05 * EACH));
    palp_explanation_free(&e);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, zeros_that_jump_are_no_drift);
    tcase_add_test(tc, a_drift_is_found);
}
