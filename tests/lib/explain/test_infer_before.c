/* test_infer_before.c: what would be left if the runs had one zero, contact or gain: each finding needs
 * what it stands for. check: once */
#include "forward_make.h"

#include <palpate/explain.h>

#include <stdint.h>

enum { RUNS = 4 };

static const double NOISE = 4e-3; /* N */
static palp_explain_input input[RUNS];
static samples recorded;

/* n runs, each with its own zero (N), contact (mm) and gain; every skip-th sample. */
static void session(size_t n, const double *zero, const double *contact, const double *gain, size_t skip) {
    static const double plan[RUNS][2] = {{6, 3}, {4, 0.8}, {6, 8}, {5, 2}};
    uint64_t state = 21;
    const palp_model truth = lumped_model(1);
    samples *s = &recorded;
    for (size_t r = 0; r < n; r++) {
        const double depth = plan[r][0], ramp_s = (depth + 1) / plan[r][1];
        palp_experiment *e;
        start(s, -1, 0);
        go(s, 1 + ramp_s, depth, 60);
        go(s, 9 + ramp_s, depth, 60);
        go(s, 11 + 2 * ramp_s, -1, 60);
        palp_forward_run run = {
            .n = s->n, .time_s = s->time_s, .depth_m = s->depth_m, .contact_m = 1e-3 * contact[r]};
        ck_assert_int_eq(palp_forward_force(&truth, &run, s->force_N, NULL, NULL), PALP_OK);
        ck_assert_int_eq(palp_experiment_create(s->n / skip, &e), PALP_OK);
        for (size_t i = 0; i < s->n / skip; i++) {
            palp_experiment_column(e, "time_s")[i] = s->time_s[i * skip];
            palp_experiment_column(e, "depth_mm")[i] = 1e3 * s->depth_m[i * skip];
            palp_experiment_column(e, "force_N")[i] =
                gain[r] * s->force_N[i * skip] + zero[r] + NOISE * white_noise(&state);
        }
        input[r] = (palp_explain_input){e, "run.csv"};
    }
}

static void explain(size_t n, palp_contact_form contact, palp_explanation *e) {
    palp_explain_settings s = palp_explain_settings_default();
    palp_error error = {.text = ""};
    const palp_model m = lumped_model(1);
    s.contact = contact;
    memset(s.candidate, 0, sizeof s.candidate);
    ck_assert_msg(palp_explain(&m, n, input, &s, e, &error) == PALP_OK, "%s", error.text);
    for (size_t r = 0; r < n; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}

static const double none[RUNS] = {0, 0, 0, 0}, ones[RUNS] = {1, 1, 1, 1};
static const double zeros[RUNS] = {0.05, -0.06, 0.03, -0.04}, contacts[RUNS] = {0.4, -0.3, 0.2, -0.35},
                    gains[RUNS] = {1.05, 0.94, 1.03, 0.96};

/* Only one of the three differs: it is found, with the same residual without it as that of the model as
 * given. */
START_TEST(what_differs_is_found) {
    palp_explanation e;
    session(RUNS, _i == 0 ? zeros : none, _i == 1 ? contacts : none, _i == 2 ? gains : ones, 1);
    explain(RUNS, PALP_CONTACT_FREE, &e);
    const palp_explain_scatter *all[3] = {&e.zero, &e.contact, &e.gain}, *differs = all[_i];
    ck_assert_double_eq_tol(e.gap.after_N, NOISE, 0.1 * NOISE);
    ck_assert(differs->found);
    ck_assert_double_gt(differs->evidence, 100);
    if (_i == 0) /* of the four zeros about their mean, but for what the noise of a run hides */
        ck_assert_double_eq_tol(differs->sd, 0.0527, 1e-3);
    ck_assert_double_gt(differs->without_N, 2 * NOISE);
    /* All three in common leave no less, but for what tails let a likely fit leave more of. */
    ck_assert_double_gt(e.gap.before_N, 0.95 * differs->without_N);
    for (int k = 0; k < 3; k++)
        if (k != _i)
            ck_assert(!all[k]->found);
    palp_explanation_free(&e);
}
END_TEST

/* Contacts of up to a fifth of the depth are found where they are, and not taken by a discrepancy. */
START_TEST(contacts_far_apart_are_found) {
    palp_explanation e;
    double far[RUNS];
    for (size_t r = 0; r < RUNS; r++)
        far[r] = 2 * contacts[r];
    session(RUNS, none, far, ones, 1);
    explain(RUNS, PALP_CONTACT_FREE, &e);
    ck_assert_double_eq_tol(e.gap.after_N, NOISE, 0.1 * NOISE);
    ck_assert(e.contact.found && !e.discrepancy.found);
    palp_explanation_free(&e);
}
END_TEST

/* Of alike runs none has anything of its own. */
START_TEST(alike_runs_have_no_scatter) {
    palp_explanation e;
    session(RUNS, none, none, ones, 1);
    explain(RUNS, PALP_CONTACT_FREE, &e);
    const palp_explain_scatter *all[3] = {&e.zero, &e.contact, &e.gain};
    for (int k = 0; k < 3; k++) {
        ck_assert(!all[k]->found);
        ck_assert_double_eq_tol(all[k]->without_N, e.gap.after_N, 0.02 * NOISE);
    }
    palp_explanation_free(&e);
}
END_TEST

/* Zeros of half a newton in all runs do not differ. */
START_TEST(equal_zeros_have_no_scatter) {
    static const double equal[RUNS] = {0.5, 0.5, 0.5, 0.5};
    palp_explanation e;
    session(RUNS, equal, none, ones, 1);
    explain(RUNS, PALP_CONTACT_FREE, &e);
    ck_assert(!e.zero.found);
    ck_assert_double_lt(e.zero.sd, NOISE);
    palp_explanation_free(&e);
}
END_TEST

/* Where contacts are declared exact none scatters, whatever the runs show. */
START_TEST(a_contact_that_is_known_does_not_scatter) {
    palp_explanation e;
    session(RUNS, none, contacts, ones, 1);
    explain(RUNS, PALP_CONTACT_KNOWN, &e);
    ck_assert(!e.contact.found && e.contact.sd == 0);
    palp_explanation_free(&e);
}
END_TEST

/* One run has nothing in common with another, whatever its zero is. */
START_TEST(one_run_does_not_scatter) {
    static const double far[RUNS] = {0.3, 0, 0, 0};
    palp_explanation e;
    session(1, far, none, ones, 1);
    explain(1, PALP_CONTACT_FREE, &e);
    ck_assert(!e.zero.found && e.zero.sd == 0);
    palp_explanation_free(&e);
}
END_TEST

/* Two short runs whose zeros differ by about as much as noise hides: a scatter, but no finding. */
START_TEST(slight_evidence_is_no_finding) {
    static const double slight[RUNS] = {2.5e-3, -2.5e-3, 0, 0};
    palp_explanation e;
    session(2, slight, none, ones, 8);
    explain(2, PALP_CONTACT_FREE, &e);
    ck_assert(!e.zero.found);
    palp_explanation_free(&e);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, what_differs_is_found, 0, 3);
    tcase_add_test(tc, contacts_far_apart_are_found);
    tcase_add_test(tc, alike_runs_have_no_scatter);
    tcase_add_test(tc, equal_zeros_have_no_scatter);
    tcase_add_test(tc, a_contact_that_is_known_does_not_scatter);
    tcase_add_test(tc, one_run_does_not_scatter);
    tcase_add_test(tc, slight_evidence_is_no_finding);
}
