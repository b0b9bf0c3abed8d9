/* test_explain_null.c: how often chance alone makes a candidate, in simulated runs in which nothing is
 * missing. check: all */
#include "forward_make.h"

#include <palpate/explain.h>

#include <stdint.h>
#include <stdio.h>

enum { RUNS = 4, NULLS = 80 };

static const double WHITE = 2e-3, GAIN = 3e-3, CONTACT_MM = 3e-3;

static uint64_t state;

/* Air, ramp, hold, withdrawal, air, with a gain and a contact of the run's own. */
static palp_experiment *record(const palp_model *m, double depth_mm, double ramp_s, double session_s) {
    static samples s;
    palp_experiment *e;
    double gain = 1 + GAIN * white_noise(&state), contact_mm = CONTACT_MM * white_noise(&state);
    start(&s, 0, -1);
    go(&s, 1, -1, 20);
    go(&s, 1 + ramp_s, depth_mm, 50);
    go(&s, 11 + ramp_s, depth_mm, 60);
    go(&s, 11 + 2 * ramp_s, -1, 50);
    go(&s, 13 + 2 * ramp_s, -1, 20);
    for (size_t i = 0; i < s.n; i++)
        s.depth_m[i] += 1e-3 * contact_mm;
    palp_forward_run run = {.n = s.n, .time_s = s.time_s, .depth_m = s.depth_m, .session_s = session_s};
    ck_assert_int_eq(palp_forward_force(m, &run, s.force_N, NULL, NULL), PALP_OK);
    ck_assert_int_eq(palp_experiment_create(s.n, &e), PALP_OK);
    for (size_t i = 0; i < s.n; i++) {
        palp_experiment_column(e, "time_s")[i] = s.time_s[i];
        palp_experiment_column(e, "depth_mm")[i] = 1e3 * s.depth_m[i] - contact_mm;
        palp_experiment_column(e, "force_N")[i] = gain * s.force_N[i] + WHITE * white_noise(&state);
    }
    palp_experiment_set_number(e, "session.start_s", session_s);
    return e;
}

/* More log likelihood than the threshold: the score is less by half a logarithm of the samples for each
 * parameter, and for the mains' line one parameter and the frequencies looked at. */
static bool beyond_chance(const palp_explain_candidate *candidate, double threshold, double rows) {
    bool hum = candidate->id == PALP_EFFECT_MAINS_HUM;
    double parameters = hum ? 1 : (double)palp_effect_look_up(candidate->id)->n_parameters;
    double gain = candidate->score + 0.5 * parameters * log(rows) + (hum ? log(601) : 0);
    return candidate->score != 0 && !hum && gain > threshold;
}

/* Wilson's 99 % interval of hits in n. */
static void interval(size_t hits, size_t n, double *low, double *high) {
    double z = 2.576, p = (double)hits / (double)n, d = 1 + z * z / (double)n;
    double middle = (p + z * z / (2 * (double)n)) / d;
    double half = z / d * sqrt(p * (1 - p) / (double)n + z * z / (4 * (double)n * (double)n));
    *low = middle - half;
    *high = middle + half;
}

START_TEST(chance_passes_the_threshold_as_often_as_asked) {
    static const double plan[RUNS][2] = {{3, 3}, {5, 1}, {7, 4}, {3, 3}};
    palp_model truth = lumped_model(1), guess = truth;
    palp_explain_settings s = palp_explain_settings_default();
    size_t beyond = 0, named = 0;
    double low, high;
    ck_assert_int_eq(palp_law_scale(&truth.material.law, 1.1, &guess.material.law), PALP_OK);
    s.false_alarm = 0.2; /* so that it can be counted */
    s.max_effects = 1;
    state = 11;
    for (size_t k = 0; k < NULLS; k++) {
        palp_explain_input input[RUNS];
        palp_explanation e;
        double rows = 0;
        bool any = false;
        for (size_t r = 0; r < RUNS; r++) {
            input[r] =
                (palp_explain_input){record(&truth, plan[r][0], plan[r][1], 100 * (double)r), "run.csv"};
            rows += (double)palp_experiment_rows(input[r].experiment);
        }
        ck_assert_int_eq(palp_explain(&guess, RUNS, input, &s, &e, NULL), PALP_OK);
        for (size_t i = 0; i < e.n_candidates; i++)
            any = any || beyond_chance(&e.candidate[i], e.null_threshold, rows);
        beyond += any;
        named += e.n_effects > 0;
        palp_explanation_free(&e);
        for (size_t r = 0; r < RUNS; r++)
            palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
    }
    interval(beyond, NULLS, &low, &high);
    printf("beyond the threshold: %zu of %d nulls (99 %%: %.3f to %.3f); named: %zu\n", beyond, NULLS, low,
           high, named);
    ck_assert_msg(low <= s.false_alarm && s.false_alarm <= high, "%zu of %d beyond the threshold", beyond,
                  NULLS);
    ck_assert_uint_le(named, beyond);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, chance_passes_the_threshold_as_often_as_asked);
}
