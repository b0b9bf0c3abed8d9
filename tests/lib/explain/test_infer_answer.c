/* test_infer_answer.c: cross-validation, next run, family of laws and line of the mains, of fits by hand.
 * check: once
 */
#include "base/dense.h"
#include "forward_make.h"
#include "explain/infer_answer.h"

#include <palpate/random.h>
#include <stdlib.h>

enum { RUNS = 3, EACH = 120 };

static const double TURN = 6.28318530717958647692;
static palp_explain_input input[RUNS];

static double step = 0.05, hum = 0.0; /* s; N, at 51 Hz */

static void record(const palp_model *m, size_t n_runs) {
    static samples s;
    uint64_t noise = 9;
    for (size_t r = 0; r < n_runs; r++) {
        start(&s, 0, -1);
        for (size_t i = 1; i < EACH; i++) {
            const double up = (double)i / (15 + 10 * (double)r), down = (EACH - 10.0 - (double)i) / 25;
            s.time_s[i] = step * (double)i;
            s.depth_m[i] = 1e-3 * fmax(-1, 6 * fmin(1, fmin(up, down)) - 1);
        }
        s.n = EACH;
        press_model(m, &s);
        for (size_t i = 0; i < EACH; i++)
            s.force_N[i] += 5e-3 * palp_random_normal(&noise) + hum * sin(TURN * 51.0 * s.time_s[i]);
        input[r] = (palp_explain_input){samples_experiment(&s), "run.csv"};
    }
}

static void begin(palp_model *m, size_t n_runs, const palp_explain_settings *settings, infer_search *s) {
    *s = (infer_search){.settings = settings};
    record(m, n_runs);
    ck_assert_int_eq(explain_data_create(n_runs, input, settings, m, &s->data, NULL), PALP_OK);
    ck_assert_int_eq(infer_fit_create(m, &s->data, NULL, &s->fit), PALP_OK);
    ck_assert_int_eq(infer_fit_evaluate(&s->fit, &s->data), PALP_OK);
    ck_assert_int_eq(infer_fit_settle(&s->fit, &s->data, 2, true), PALP_OK);
}

static void end(infer_search *s, size_t n_runs) {
    infer_search_free(s);
    explain_data_free(&s->data);
    for (size_t r = 0; r < n_runs; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}

/* A run's score given the others is what the evidence of all runs has beyond that of the others. */
START_TEST(a_run_left_out_has_the_evidence_it_adds) {
    const palp_explain_settings settings = palp_explain_settings_default();
    palp_model m = lumped_model(1);
    infer_search s;
    infer_left_out left;
    begin(&m, RUNS, &settings, &s);
    ck_assert_int_eq(infer_leave_out(&s.fit, &s.data, &left), PALP_OK);
    ck_assert_uint_eq(left.n, RUNS);
    ck_assert_double_eq_tol(left.rms_N, 5e-3, 1e-3);
    const double all = s.fit.promised;
    for (size_t r = 0; r < RUNS; r++) {
        s.data.run[r].held_out = true;
        ck_assert_int_eq(infer_fit_products(&s.fit, &s.data), PALP_OK);
        ck_assert_int_eq(infer_fit_score(&s.fit, &s.data), PALP_OK);
        ck_assert_double_eq_tol(left.score[r], all - s.fit.promised, 1e-6 * fabs(all));
        s.data.run[r].held_out = false;
    }
    infer_left_out_free(&left);
    end(&s, RUNS);
}
END_TEST

/* A run that the user keeps out is the only one that is predicted; a single one is, by eighths. */
START_TEST(what_is_left_out_depends_on_the_runs) {
    const palp_explain_settings settings = palp_explain_settings_default();
    palp_model m = lumped_model(1);
    infer_search s;
    infer_left_out left, other;
    double se;
    begin(&m, RUNS, &settings, &s);
    s.data.run[1].held_out = true;
    ck_assert_int_eq(infer_leave_out(&s.fit, &s.data, &left), PALP_OK);
    ck_assert_uint_eq(left.n, 1);
    ck_assert(s.data.run[1].held_out);
    infer_left_out_free(&left);
    end(&s, RUNS);
    begin(&m, 1, &settings, &s);
    ck_assert_int_eq(infer_leave_out(&s.fit, &s.data, &left), PALP_OK);
    ck_assert_uint_eq(left.n, 8);
    for (size_t i = 0; i < EACH; i++)
        ck_assert(s.data.run[0].use[i]);
    s.fit.noise.white *= 5; /* a worse model of the noise predicts worse */
    ck_assert_int_eq(infer_fit_products(&s.fit, &s.data), PALP_OK);
    ck_assert_int_eq(infer_fit_score(&s.fit, &s.data), PALP_OK);
    ck_assert_int_eq(infer_leave_out(&s.fit, &s.data, &other), PALP_OK);
    ck_assert_double_gt(infer_predicts_better(&left, &other, &se), 10);
    ck_assert_double_gt(se, 0);
    infer_left_out_free(&left);
    infer_left_out_free(&other);
    end(&s, 1);
}
END_TEST

/* A search that ended with a lag where another arm is more probable: the arm takes its place, if it may, and
 * keeps it. */
START_TEST(a_more_probable_look_alike_takes_the_place) {
    palp_explain_settings settings = palp_explain_settings_default();
    memset(settings.candidate, 0, sizeof settings.candidate);
    settings.candidate[PALP_EFFECT_RELAXATION_ARM] = settings.candidate[PALP_EFFECT_SENSOR_LAG] = true;
    settings.max_effects = 1;
    palp_model truth = lumped_model(1), wrong = truth;
    palp_effect *arm = add_effect(&truth, PALP_EFFECT_RELAXATION_ARM, 0);
    arm->value[0] = 2;
    arm->value[1] = 1.5;
    add_effect(&wrong, PALP_EFFECT_SENSOR_LAG, 0)->value[0] = 0.05;
    infer_search s;
    palp_explanation *e = calloc(1, sizeof *e);
    begin(&truth, RUNS, &settings, &s);
    infer_fit_free(&s.fit);
    s.residual = malloc(2 * s.data.n * sizeof *s.residual);
    s.discrepancy = s.residual + s.data.n;
    ck_assert_int_eq(infer_fit_create(&wrong, &s.data, NULL, &s.fit), PALP_OK);
    ck_assert_int_eq(infer_fit_evaluate(&s.fit, &s.data), PALP_OK);
    ck_assert_int_eq(infer_fit_settle(&s.fit, &s.data, 4, true), PALP_OK);
    ck_assert_int_eq(infer_fit_converge(&s.fit, &s.data), PALP_OK);
    for (int i = 0; i < 3; i++) {
        static const palp_effect_id id[] = {PALP_EFFECT_SENSOR_LAG, PALP_EFFECT_RELAXATION_ARM,
                                            PALP_EFFECT_RELAXATION_ARM};
        const double was = s.fit.score;
        bool exchanged = i > 0;
        ck_assert_int_eq(infer_describe(&s, e, &exchanged), PALP_OK);
        ck_assert(exchanged == (i == 1));
        ck_assert_uint_eq(infer_added(&s), 1);
        ck_assert_int_eq(infer_added_id(&s, 0), id[i]);
        ck_assert_double_gt(s.fit.score, was + (exchanged ? 1 : -1e-6));
        ck_assert(exchanged || e->effect[0].effect.id == id[i]);
    }
    free(e);
    end(&s, RUNS);
}
END_TEST

/* No experiment separates a set from itself. Another one, which has pores in place of the arm, is separated
 * the better the more time there is. Nothing fits into less time than a run takes. */
START_TEST(the_next_experiment_tells_two_sets_apart) {
    static const double time_s[] = {1e-3, 20, 200};
    palp_explain_settings settings = palp_explain_settings_default();
    palp_model m = lumped_model(1);
    infer_search s;
    begin(&m, RUNS, &settings, &s);
    ck_assert_int_eq(infer_fit_converge(&s.fit, &s.data), PALP_OK);
    double told[2][3] = {{0}};
    for (int same = 0; same < 2; same++) {
        infer_search *rest = calloc(1, sizeof *rest);
        palp_model other = s.fit.c.model;
        palp_explain_effect out = {.effect.id = PALP_EFFECT_SENSOR_LAG, .n_class = 2};
        infer_fit *fit = &rest->trial[PALP_EFFECT_POROELASTIC].fit;
        out.alike[0] = PALP_EFFECT_SENSOR_LAG;
        out.alike[1] = PALP_EFFECT_POROELASTIC;
        if (!same) {
            other.material.n_arms = 0;
            palp_effect *pores = add_effect(&other, PALP_EFFECT_POROELASTIC, 0);
            pores->value[0] = 1;
            pores->value[1] = 0.5;
        }
        ck_assert_int_eq(infer_fit_create(&other, &s.data, NULL, fit), PALP_OK);
        ck_assert_int_eq(infer_fit_evaluate(fit, &s.data), PALP_OK);
        ck_assert_int_eq(infer_fit_settle(fit, &s.data, 2, true), PALP_OK);
        ck_assert_int_eq(infer_fit_converge(fit, &s.data), PALP_OK);
        fit->score = s.fit.score; /* the runs so far do not separate them */
        for (int i = 0; i < 3; i++) {
            palp_explain_next next = {.wanted = false};
            settings.next.time_s = time_s[i];
            ck_assert_int_eq(infer_next_find(&s, rest, &out, &next), PALP_OK);
            ck_assert(next.wanted);
            ck_assert_double_le(next.time_s, time_s[i]);
            ck_assert_double_lt(next.information, 1 + 1e-9);
            ck_assert_int_eq(next.between[1], PALP_EFFECT_POROELASTIC);
            ck_assert(i > 0 || next.n_runs == 0);
            told[same][i] = next.information;
        }
        infer_trials_free(rest);
        free(rest);
    }
    ck_assert_double_lt(told[1][2], 0.01);
    ck_assert_double_gt(told[0][1], 2 * told[1][2]);
    ck_assert_double_gt(told[0][2], told[0][1]);
    end(&s, RUNS);
}
END_TEST

/* Posterior sd of the law's coordinate a: of the logarithm of a stiffness. */
static double law_sd(const infer_search *s, size_t a) {
    infer_posterior p;
    ck_assert_int_eq(infer_posterior_find(&s->fit, &s->data, &p), PALP_OK);
    double *unit = calloc(p.g, sizeof *unit);
    ck_assert_ptr_nonnull(unit);
    unit[p.hats + a] = 1.0;
    dense_forward(p.g, p.factor, 1, unit);
    const double sd = sqrt(dense_dot(p.g, unit, unit));
    free(unit);
    infer_posterior_free(&p);
    return sd;
}

/* The family of the given law is refuted where the runs show another one, and only there. */
START_TEST(a_family_is_refuted_by_its_runs) {
    static const double coefficient_N[] = {8, 3};
    const palp_explain_settings settings = palp_explain_settings_default();
    palp_model m = lumped_model(1);
    palp_law given, nearest;
    infer_search s;
    double nats;
    begin(&m, RUNS, &settings, &s);
    ck_assert_int_eq(infer_law_compare(&s.fit, &s.data, &m.material.law, &nearest, &nats), PALP_OK);
    ck_assert_double_lt(nats, 3);
    const double reach = 2 * law_sd(&s, INFER_KNOTS / 2); /* law and arm stand in for each other */
    ck_assert_double_lt(reach, 0.15);
    for (double strain = 0.02; strain < 0.2; strain += 0.02) {
        double near, far;
        palp_law_stiffness(&nearest, strain, &near, NULL);
        palp_law_stiffness(&m.material.law, strain, &far, NULL);
        ck_assert_double_eq_tol(near, far, reach * far);
    }
    ck_assert_int_eq(palp_law_polynomial(2, coefficient_N, &given), PALP_OK);
    given.coefficients[1] = -10;
    ck_assert_int_eq(infer_law_compare(&s.fit, &s.data, &given, &nearest, &nats), PALP_OK);
    ck_assert_uint_eq(nearest.n, 2);
    ck_assert_double_gt(fabs(nearest.coefficients[1] + 10), 1); /* it was fitted */
    ck_assert_int_eq(infer_law_compare(&s.fit, &s.data, &s.fit.c.model.material.law, &nearest, &nats),
                     PALP_OK);
    ck_assert_double_eq(nats, 0); /* a spline is no family */
    end(&s, RUNS);
}
END_TEST

/* What the prior of the frequency costs is the evidence's mean over the band, relative to its maximum. */
START_TEST(the_frequency_of_a_hum_has_a_prior) {
    enum { POINTS = 400 };
    const palp_explain_settings settings = palp_explain_settings_default();
    palp_model m = lumped_model(1);
    infer_search s;
    double most = -HUGE_VAL, sum = 0.0, cost = 0.0;
    step = 0.005;
    hum = 2.5e-3;
    begin(&m, RUNS, &settings, &s);
    s.fit.sizes.own[INFER_SINE] = s.fit.sizes.own[INFER_COSINE] = hum;
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < POINTS; i++) { /* the band of 30 Hz is zero outside of these 4 Hz */
            s.fit.c.hum_Hz = 49.0 + 4.0 * (i + 0.5) / POINTS;
            s.fit.c.hum_cost = 0.0;
            ck_assert_int_eq(infer_fit_evaluate(&s.fit, &s.data), PALP_OK);
            ck_assert_int_eq(infer_fit_score(&s.fit, &s.data), PALP_OK);
            if (pass == 0 && s.fit.promised > most) {
                most = s.fit.promised;
                ck_assert_int_eq(infer_hum_cost(&s.fit, &s.data), PALP_OK);
                cost = s.fit.c.hum_cost;
            } else if (pass == 1)
                sum += exp(s.fit.promised - most) * 4.0 / POINTS / 30.0;
        }
    ck_assert_double_eq_tol(cost, -log(sum), 0.15);
    ck_assert_double_gt(cost, 3.0);
    end(&s, RUNS);
    step = 0.05;
    hum = 0.0;
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, the_frequency_of_a_hum_has_a_prior);
    tcase_add_test(tc, a_run_left_out_has_the_evidence_it_adds);
    tcase_add_test(tc, what_is_left_out_depends_on_the_runs);
    tcase_add_test(tc, a_more_probable_look_alike_takes_the_place);
    tcase_add_test(tc, the_next_experiment_tells_two_sets_apart);
    tcase_add_test(tc, a_family_is_refuted_by_its_runs);
}
