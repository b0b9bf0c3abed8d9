/* test_explain_evidence.c: what a gain in log likelihood counts: beside a scatter that few runs tell, and
 * beside noise that is more than was thought. */
#include "explain/explain_lines.h"
#include "explain/explain_fit.h"
#include "forward_make.h"

#include <palpate/explain.h>
#include <palpate/random.h>

enum { RUNS = 7, EACH = 400 };
static const double NOISE = 0.01; /* N */

static palp_explain_input input[RUNS];

/* Presses and withdrawals of the model at several speeds; zero: of each run, N. */
static void record(const palp_model *m, const double zero[RUNS]) {
    static samples s;
    uint64_t noise = 4;
    for (size_t r = 0; r < RUNS; r++) {
        const double ramp = 40 + 20 * (double)r;
        start(&s, 0, -1);
        for (size_t i = 1; i < EACH; i++) {
            const double up = (double)i / ramp, down = (EACH - 20.0 - (double)i) / ramp;
            s.time_s[i] = 0.05 * (double)i;
            s.depth_m[i] = 1e-3 * fmax(-1, 6 * fmin(1, fmin(up, down)) - 1);
        }
        s.n = EACH;
        press_model(m, &s);
        for (size_t i = 0; i < EACH; i++)
            s.force_N[i] = s.force_N[i] + zero[r] + NOISE * white_noise(&noise);
        input[r] = (palp_explain_input){samples_experiment(&s), "run.csv"};
    }
}

static void forget(void) {
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}

/* ---- the mean of what each run has of its own ---- */

/* Of runs' own values whose mean is 0: the likeliest scatter with a mean of their own and without, each
 * learned from them and from one run more, for which noise hides so many times what they scatter by. */
START_TEST(few_runs_have_a_mean_by_chance_as_often_as_asked) {
    enum { DRAWS = 20000 };
    static const double hidden[] = {0, 0.3, 1};
    const double limit = 0.5 * 3.841; /* 95 % of chi squared */
    const double known = hidden[_i] * hidden[_i];
    uint64_t state = 9;
    double above = 0, as_it_is = 0;
    for (size_t k = 0; k < DRAWS; k++) {
        double sum = 0, squares = known;
        for (size_t r = 0; r < RUNS; r++) {
            const double x = palp_random_normal(&state);
            sum += x;
            squares += x * x;
        }
        const double rest = squares - sum * sum / RUNS, gain = 0.5 * (RUNS + 1) * log(squares / rest);
        above += explain_students_gain(gain, RUNS, 1, known * (RUNS - 1) / (rest - known)) > limit;
        as_it_is += gain > limit;
    }
    ck_assert_msg(fabs(above / DRAWS - 0.05) < 0.013, "%g", above / DRAWS);
    ck_assert_double_gt(as_it_is / DRAWS, 0.07);
    ck_assert_double_eq(explain_students_gain(5, 1, 1, known), 0);
    ck_assert_double_eq_tol(explain_students_gain(5, RUNS, 1e9, 1e9), 5, 1e-6); /* the scatter is known */
}
END_TEST

/* Zeros of mean 0.3 N and a standard error so many times less: whether a bias is named where nothing else may
 * be. */
static bool bias_is_named(double times) {
    static const double own[RUNS] = {1.2, -0.4, 0.6, -1.5, 0.9, -1.1, 0.3}; /* of mean 0 and sd 1.03 */
    const palp_model m = lumped_model(1);
    palp_explain_settings settings = palp_explain_settings_default();
    palp_explanation e;
    double zero[RUNS];
    for (size_t r = 0; r < RUNS; r++)
        zero[r] = 0.3 * (1 + own[r] / 1.03 * sqrt(RUNS) / times);
    memset(settings.candidate, 0, sizeof settings.candidate);
    settings.candidate[PALP_EFFECT_SENSOR_BIAS] = true;
    record(&m, zero);
    ck_assert_int_eq(palp_explain(&m, RUNS, input, &settings, &e, NULL), PALP_OK);
    const bool named = e.n_effects > 0;
    palp_explanation_free(&e);
    forget();
    return named;
}

/* 3.9 standard errors of seven runs are as rare as 2.7 of many, which are not worth a parameter of 2800
 * samples. */
START_TEST(zeros_that_happen_to_have_a_mean_are_no_bias) {
    ck_assert(!bias_is_named(3.9));
    ck_assert(bias_is_named(12));
}
END_TEST

/* ---- noise that is more than was thought ---- */

/* Of heavy tails (Student's t, three degrees of freedom) the noise's robust size is too small, and every gain
 * too large by as much. */
START_TEST(heavy_tails_count_in_full) {
    const palp_model m = linear_model(40);
    const double zero[RUNS] = {0};
    palp_explain_settings settings = palp_explain_settings_default();
    explain_data data;
    uint64_t state = 3;
    double inflation, squares = 0;
    record(&m, zero);
    ck_assert_int_eq(explain_data_create(RUNS, input, &settings, &m, &data, NULL), PALP_OK);
    double *residual = calloc(data.n, sizeof *residual);
    ck_assert_ptr_nonnull(residual);
    for (size_t i = 0; i < data.n; i++) {
        const double a = palp_random_normal(&state), b = palp_random_normal(&state),
                     c = palp_random_normal(&state);
        residual[i] = NOISE * palp_random_normal(&state) / sqrt(a * a + b * b + c * c);
        squares += residual[i] * residual[i];
    }
    ck_assert_int_eq(explain_noise_find(&data, residual), PALP_OK);
    const double level = explain_noise_level(&data), more = squares / (double)data.n / (level * level);
    ck_assert_double_gt(more, 1.2);
    ck_assert_int_eq(explain_rest_inflation(&data, residual, &inflation), PALP_OK);
    ck_assert_double_gt(inflation, 0.9 * more); /* a tenth is what as few samples' own scatter may be */
    explain_data_free(&data);
    free(residual);
    forget();
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, few_runs_have_a_mean_by_chance_as_often_as_asked, 0, 3);
    tcase_add_test(tc, zeros_that_happen_to_have_a_mean_are_no_bias);
    tcase_add_test(tc, heavy_tails_count_in_full);
}
