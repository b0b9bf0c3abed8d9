/* test_explain_data.c: what explain reads off the runs, the slope of their chi2, classes and the null
 * threshold. */
#include "explain/explain_lines.h"
#include "explain/explain_result.h"
#include "forward_make.h"

#include <palpate/random.h>

enum { RUNS = 3 };

static explain_data data;
static palp_explain_settings settings;

/* Air, ramp, dwell, withdrawal; the force times gain beside a zero. Lone spike and letting go where asked. */
static palp_experiment *record(const palp_model *m, double gain, double zero, double spike, double pull) {
    static samples s;
    static uint64_t state = 11;
    palp_experiment *e;
    start(&s, 0, -1);
    go(&s, 1, -1, 60);
    go(&s, 3, 4, 200);
    go(&s, 8, 4, 100);
    go(&s, 10, -1, 200);
    press_model(m, &s);
    ck_assert_int_eq(palp_experiment_create(s.n, &e), PALP_OK);
    for (size_t i = 0; i < s.n; i++) {
        double force = gain * s.force_N[i] + zero + 1e-4 * palp_random_normal(&state);
        if (pull > 0 && s.time_s[i] > 9.6 && s.time_s[i] < 9.8) /* grows, then lets go */
            force -= pull * (s.time_s[i] - 9.6) / 0.2;
        palp_experiment_column(e, "time_s")[i] = s.time_s[i];
        palp_experiment_column(e, "depth_mm")[i] = 1e3 * s.depth_m[i];
        palp_experiment_column(e, "force_N")[i] = force + (i == (spike > 0 ? 150 : s.n - 20) ? spike : 0);
    }
    palp_experiment_set_string(e, "protocol.kind", "ramp_hold");
    palp_experiment_set_number(e, "protocol.depth_mm", 4);
    return e;
}

static void begin(const palp_model *m, const double gain[RUNS], const double zero[RUNS], double spike,
                  double pull) {
    palp_explain_input input[RUNS];
    settings = palp_explain_settings_default();
    for (size_t r = 0; r < RUNS; r++)
        input[r] = (palp_explain_input){record(m, gain[r], zero[r], r == 1 ? spike : 0, r == 2 ? pull : 0),
                                        "run.csv"};
    ck_assert_int_eq(explain_data_create(RUNS, input, &settings, m, &data, NULL), PALP_OK);
    for (size_t r = 0; r < RUNS; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
    double *rest = calloc(data.n, sizeof *rest); /* the noise that record adds */
    uint64_t state = 12;
    ck_assert_ptr_nonnull(rest);
    for (size_t i = 0; i < data.n; i++)
        rest[i] = 1e-4 * palp_random_normal(&state);
    ck_assert_int_eq(explain_noise_find(&data, rest), PALP_OK);
    free(rest);
}

static const double ones[RUNS] = {1, 1, 1}, none[RUNS] = {0, 0, 0};

/* ---- data ---- */

/* Runs whose plate went the same way are replicates, whatever their files say of a protocol. */
START_TEST(replicates_by_their_paths) {
    palp_model m = lumped_model(1);
    begin(&m, ones, none, 0, 0);
    ck_assert_uint_eq(data.n_replicates, 2);
    ck_assert_double_eq_tol(data.run[0].white, 1e-4, 1.5e-5);
    ck_assert_double_eq_tol(data.deepest, 4e-3, 1e-12);
    ck_assert_double_eq(data.run[1].largest_strain, 0); /* each finds a specimen as new */
    explain_data_free(&data);
}
END_TEST

START_TEST(spikes_and_releases_are_events) {
    palp_model m = lumped_model(1);
    begin(&m, ones, none, 0.2, 0.3);
    ck_assert_uint_eq(data.n_events, 2);
    ck_assert_str_eq(data.event[0].kind, "spike");
    ck_assert_uint_eq(data.event[0].run, 1);
    ck_assert_double_eq_tol(data.event[0].size_N, 0.2, 0.01);
    ck_assert_uint_eq(data.run[1].use[150], 0);
    ck_assert_str_eq(data.event[1].kind, "release");
    ck_assert_uint_eq(data.event[1].run, 2);
    ck_assert_uint_eq(data.n_releases, 1);
    ck_assert_double_gt(data.pull, 0.25);
    ck_assert_double_lt(data.pull, 0.301);
    ck_assert_double_gt(data.pull_most, data.pull);
    ck_assert_double_lt(data.pull_most, data.pull + 0.03); /* one more rise */
    explain_data_free(&data);
}
END_TEST

/* One odd sample while the plate is far away, as noise with heavy tails has: nothing lets go. */
START_TEST(a_lone_sample_is_no_release) {
    palp_model m = lumped_model(1);
    begin(&m, ones, none, -0.2, 0);
    ck_assert_uint_eq(data.n_events, 1);
    ck_assert_str_eq(data.event[0].kind, "spike");
    ck_assert_uint_eq(data.n_releases, 0);
    explain_data_free(&data);
}
END_TEST

/* A pull is what the force is below the run's own zero. */
START_TEST(a_zero_is_no_pull) {
    static const double low[RUNS] = {0, 0, -0.1}, lower[RUNS] = {0, 0, -1e-3};
    palp_model m = lumped_model(1);
    begin(&m, ones, low, 0, 0.3);
    ck_assert_uint_eq(data.n_releases, 1);
    ck_assert_double_lt(data.pull, 0.301);
    ck_assert_double_gt(data.pulled, 0.25);
    ck_assert_double_lt(data.pulled, 0.301);
    explain_data_free(&data);
    begin(&m, ones, lower, 0, 9e-4);
    ck_assert_uint_eq(data.n_releases, 0); /* nine times the noise, with the zero nineteen */
    explain_data_free(&data);
}
END_TEST

/* Where the plate withdraws until the force is gone a pull may hide in the noise. */
START_TEST(a_pull_may_hide_in_the_noise) {
    palp_model m = lumped_model(1);
    begin(&m, ones, none, 0, 0);
    ck_assert_double_gt(data.pulled, 1e-4);
    ck_assert_double_lt(data.pulled, 5e-4);
    explain_data_free(&data);
}
END_TEST

/* ---- chi2's slope ---- */

/* With no nuisance but the zero g is minus half the slope of chi2 by the search coordinates, and h, the
 * residual being small, half its curvature. */
START_TEST(the_slope_of_chi2) {
    enum { LAW = 5, K = LAW + 2 + 1 };
    palp_model m = lumped_model(1);
    double *rest, h[K * K], g[K], work[K * K + K], other_g[K], chi2, moved[2];
    begin(&m, ones, none, 0, 0);
    rest = calloc(data.n, sizeof *rest);
    ck_assert_ptr_nonnull(rest);
    for (size_t i = 0; i < data.n; i++)
        rest[i] = 1e-3 * cos(2.0 * (double)i);
    ck_assert_int_eq(explain_noise_find(&data, rest), PALP_OK);
    add_effect(&m, PALP_EFFECT_SENSOR_LAG, 1);
    explain_fit fit;
    ck_assert_int_eq(explain_fit_create(&m, &data, &fit), PALP_OK);
    ck_assert_uint_eq(fit.n_columns, K);
    fit.scatter = (explain_scatter){1e-2, 0, 0, 0};
    for (size_t k = 0; k < K; k++)
        fit.unit[k] = 1e9;
    for (size_t k = 0; k < K; k++) {
        double here = fit.x[k], step = 1e-4 * fmax(1e-2, fabs(here));
        for (int side = 0; side < 2; side++) {
            fit.x[k] = here + (side ? -step : step);
            ck_assert_int_eq(explain_fit_to_model(&fit), PALP_OK);
            ck_assert_int_eq(explain_fit_products(&fit, &data, NULL), PALP_OK);
            explain_fit_total(&fit, &data, h, other_g, &moved[side], work);
        }
        fit.x[k] = here;
        ck_assert_int_eq(explain_fit_to_model(&fit), PALP_OK);
        ck_assert_int_eq(explain_fit_products(&fit, &data, NULL), PALP_OK);
        explain_fit_total(&fit, &data, h, g, &chi2, work);
        ck_assert_double_eq_tol(-2 * g[k], (moved[0] - moved[1]) / (2 * step),
                                1e-4 * sqrt(h[k * K + k] * chi2));
    }
    explain_fit_free(&fit);
    explain_data_free(&data);
    free(rest);
}
END_TEST

/* ---- a profile likelihood ---- */

/* Of a linear model and a bias chi2 is a parabola: followed, the interval ends where the normal matrix says.
 * A network's is not followed. */
START_TEST(a_likelihood_that_is_followed_ends_where_a_parabola_does) {
    palp_model m = linear_model(8);
    explain_search *s = calloc(1, sizeof *s);
    palp_explanation *e = calloc(2, sizeof *e);
    double *rest, half[2];
    ck_assert(s && e);
    begin(&m, ones, none, 0, 0);
    rest = calloc(data.n, sizeof *rest);
    ck_assert_ptr_nonnull(rest);
    for (size_t i = 0; i < data.n; i++)
        rest[i] = 1e-3 * cos(2.0 * (double)i);
    ck_assert_int_eq(explain_noise_find(&data, rest), PALP_OK);
    add_effect(&m, PALP_EFFECT_SENSOR_BIAS, 0);
    *s = (explain_search){.data = data, .settings = &settings};
    ck_assert_int_eq(explain_fit_create(&m, &data, &s->fit), PALP_OK);
    s->fit.scatter = (explain_scatter){1e-3, 0, 0, 0};
    ck_assert_int_eq(explain_fit_products(&s->fit, &data, NULL), PALP_OK);
    ck_assert_int_eq(explain_fit_improve(&s->fit, &data, 20), PALP_OK);
    for (int followed = 0; followed < 2; followed++) {
        s->fit.model.kind = followed ? PALP_MODEL_LUMPED : PALP_MODEL_NETWORK;
        ck_assert_int_eq(explain_intervals(s, &e[followed]), PALP_OK);
        half[followed] = 0.5 * (e[followed].effect[0].high[0] - e[followed].effect[0].low[0]);
    }
    ck_assert_double_gt(half[0], fabs(s->fit.x[1]) / 3); /* else it would not be followed */
    ck_assert_double_eq_tol(half[1], half[0], 0.035 * half[0]);
    explain_fit_free(&s->fit);
    explain_data_free(&data);
    free(rest);
    free(s);
    free(e);
}
END_TEST

/* ---- the next experiment ---- */

/* A bias and a gain are a run's own: only what is left beside them tells two models apart. */
START_TEST(a_zero_and_a_gain_separate_nothing) {
    palp_model m = linear_model(8);
    explain_search *full = calloc(1, sizeof *full), *rest = calloc(1, sizeof *rest);
    palp_explain_effect out = {.effect = {.id = PALP_EFFECT_SENSOR_BIAS},
                               .n_class = 2,
                               .alike = {PALP_EFFECT_SENSOR_BIAS, PALP_EFFECT_SENSOR_DRIFT}};
    palp_explain_next next = {.wanted = false};
    double product = 0, rate = 1e-4;
    ck_assert(full && rest);
    begin(&m, ones, none, 0, 0);
    *full = *rest = (explain_search){.data = data, .settings = &settings};
    full->fit.model = m;
    explain_trial *t = &rest->trial[PALP_EFFECT_SENSOR_DRIFT];
    t->fit.product = &product; /* it was tried */
    t->fit.model = linear_model(8.8);
    add_effect(&t->fit.model, PALP_EFFECT_SENSOR_BIAS, 0)->value[0] = 0.05;
    ck_assert_int_eq(explain_next_find(full, rest, &out, &next), PALP_OK);
    ck_assert(next.wanted);
    ck_assert_double_lt(next.separation_N, 1e-7);
    add_effect(&t->fit.model, PALP_EFFECT_SENSOR_DRIFT, 0)->value[0] = rate;
    ck_assert_int_eq(explain_next_find(full, rest, &out, &next), PALP_OK);
    ck_assert_str_eq(next.kind, "ramp_hold");
    /* a line's rms about its mean over the run, which goes there and back from the air; the force takes off
     * little of it */
    double way_mm = next.depth_mm + 0.3 * 1e3 * data.deepest,
           lasts = next.hold_s + 2 * way_mm / next.rate_mm_s;
    ck_assert_double_lt(next.separation_N, 1.2 * rate * lasts / sqrt(12));
    ck_assert_double_gt(next.separation_N, 0.8 * rate * lasts / sqrt(12));
    ck_assert_int_eq(next.between[0], PALP_EFFECT_SENSOR_BIAS);
    ck_assert_int_eq(next.between[1], PALP_EFFECT_SENSOR_DRIFT);
    explain_data_free(&data);
    free(full);
    free(rest);
}
END_TEST

/* ---- classes ---- */

static void orthogonalise(size_t n, double *v, const double *to) {
    double vt = 0, tt = 0;
    for (size_t i = 0; i < n; i++) {
        vt += v[i] * to[i];
        tt += to[i] * to[i];
    }
    for (size_t i = 0; i < n; i++)
        v[i] -= vt / tt * to[i];
}

/* Alike is what changes the forces with a cosine above 0.9 once the fit's own columns are taken off. */
START_TEST(alike_by_the_cosine) {
    palp_model m = linear_model(8);
    explain_search *full = calloc(1, sizeof *full), *rest = calloc(1, sizeof *rest);
    palp_explain_effect out = {.effect = {.id = PALP_EFFECT_SENSOR_BIAS}};
    ck_assert(full && rest);
    begin(&m, ones, none, 0, 0);
    size_t n = data.n;
    double *v = calloc(6 * n, sizeof *v), *column = v, *a = v + n, *b = v + 2 * n, length[2] = {0, 0};
    ck_assert_ptr_nonnull(v);
    *full = *rest = (explain_search){.data = data, .settings = &settings};
    ck_assert_int_eq(explain_fit_create(&m, &data, &rest->fit), PALP_OK);
    ck_assert_int_eq(explain_fit_products(&rest->fit, &data, column),
                     PALP_OK); /* linear: the column, times 8 */
    for (size_t i = 0; i < n; i++) {
        a[i] = cos(0.03 * (double)i);
        b[i] = sin(0.05 * (double)i);
    }
    orthogonalise(n, a, column);
    orthogonalise(n, b, column);
    orthogonalise(n, b, a);
    for (size_t i = 0; i < n; i++) {
        length[0] += a[i] * a[i];
        length[1] += b[i] * b[i];
    }
    full->force = v + 3 * n;
    rest->force = v + 4 * n;
    rest->trial[PALP_EFFECT_SENSOR_LAG].force = v + 5 * n;
    for (int alike = 0; alike < 2; alike++) {
        double angle = acos(alike ? 0.91 : 0.89);
        for (size_t i = 0; i < n; i++) {
            rest->force[i] = sin((double)i);
            full->force[i] = rest->force[i] + a[i] + 3 * column[i];
            v[5 * n + i] = rest->force[i] + cos(angle) * a[i] / sqrt(length[0]) +
                           sin(angle) * b[i] / sqrt(length[1]) - column[i];
        }
        ck_assert_int_eq(explain_class_find(full, rest, 0.0, &out), PALP_OK);
        ck_assert_uint_eq(out.n_class, alike ? 2 : 1);
    }
    explain_fit_free(&rest->fit);
    explain_data_free(&data);
    free(v);
    free(full);
    free(rest);
}
END_TEST

/* ---- evidence ---- */

static palp_status fit_here(explain_search *s, const palp_model *m) {
    palp_status status = explain_fit_create(m, &s->data, &s->fit);
    s->fit.scatter = (explain_scatter){1e-3, 3e-6, 3e-3, 0};
    return status ? status : explain_fit_evaluate(&s->fit, &s->data, s->force, s->residual);
}

/* A search of the data at m. */
static explain_search *search_make(const palp_model *m) {
    explain_search *s = calloc(1, sizeof *s);
    double *rest = calloc(2 * data.n, sizeof *rest);
    ck_assert(s && rest);
    *s = (explain_search){.data = data, .settings = &settings, .force = rest, .residual = rest + data.n};
    ck_assert_int_eq(fit_here(s, m), PALP_OK);
    return s;
}

static void search_end(explain_search *s) {
    explain_fit_free(&s->fit);
    explain_data_free(&s->data);
    free(s->force);
    free(s);
}

/* A lag shows at the corners. What is left there, as a lag that changes its sign from corner to corner,
 * hardly widens sums over all samples, but the evidence of a lag. */
START_TEST(evidence_is_widened_where_the_effect_leans) {
    palp_model m = linear_model(8), lagging = m;
    explain_search *s = calloc(1, sizeof *s);
    explain_trial t = {.tried = true};
    double inflation;
    add_effect(&lagging, PALP_EFFECT_SENSOR_LAG, 1);
    ck_assert_ptr_nonnull(s);
    begin(&m, ones, none, 0, 0);
    double *rest = calloc(3 * data.n, sizeof *rest);
    ck_assert_ptr_nonnull(rest);
    *s = (explain_search){.data = data, .settings = &settings, .force = rest, .residual = rest + data.n};
    ck_assert_int_eq(fit_here(s, &lagging), PALP_OK);
    memcpy(rest + 2 * data.n, s->force, data.n * sizeof *rest);
    explain_fit_free(&s->fit);
    ck_assert_int_eq(fit_here(s, &m), PALP_OK);
    for (size_t r = 0, at = 0; r < RUNS; at += data.run[r++].n)
        for (size_t i = 0; i < data.run[r].n; i++) {
            double lag = rest[2 * data.n + at + i] - s->force[at + i];
            data.run[r].force[i] += 0.1 * (i * 12 / data.run[r].n % 2 ? lag : -lag);
        }
    explain_fit_free(&s->fit);
    ck_assert_int_eq(fit_here(s, &m), PALP_OK);
    ck_assert_int_eq(explain_noise_find(&s->data, s->residual), PALP_OK);
    ck_assert_int_eq(explain_fit_beside(&s->fit, &lagging, &s->data, &t.fit), PALP_OK);
    ck_assert_int_eq(explain_fit_products(&t.fit, &s->data, NULL), PALP_OK);
    ck_assert_int_eq(explain_fit_improve(&t.fit, &s->data, 10), PALP_OK);
    ck_assert_int_eq(explain_trial_examine(s, PALP_EFFECT_SENSOR_LAG, &t), PALP_OK);
    ck_assert_int_eq(explain_rest_inflation(&s->data, s->residual, &inflation), PALP_OK);
    ck_assert_msg(t.inflation > 2 * inflation, "%g times, of all sums %g times", t.inflation, inflation);
    explain_fit_free(&t.fit);
    free(t.force);
    explain_fit_free(&s->fit);
    explain_data_free(&data);
    free(rest);
    free(s);
}
END_TEST

/* Where a surface lets go, what a step from afar promises says little: no start is left out for that. */
START_TEST(a_pull_is_searched_from_every_start) {
    palp_model m = linear_model(8);
    explain_multistart found = {.n = 0};
    const char *reason;
    begin(&m, ones, none, 0, 9e-4);
    explain_search *s = search_make(&m);
    ck_assert_int_eq(explain_candidate_multistart(&s->fit, &s->data, s->residual, &settings,
                                                  PALP_EFFECT_ADHESION, 1e9, &found, &reason),
                     PALP_OK);
    ck_assert_uint_gt(found.n, 0);
    explain_multistart_free(&found);
    search_end(s);
}
END_TEST

/* A lag that is not in the data gains what chance gives at most and is taken out at the end; one that is
 * there stays. */
START_TEST(a_needless_effect_is_taken_out) {
    for (int there = 0; there < 2; there++) {
        palp_model m = linear_model(8), lagging = m;
        explain_memory *memory = calloc(1, sizeof *memory);
        palp_effect_id dropped;
        ck_assert_ptr_nonnull(memory);
        memory->n = 1;
        add_effect(&lagging, PALP_EFFECT_SENSOR_LAG, there ? 1 : 1e-3);
        begin(&m, ones, none, 0, 0);
        explain_search *s = search_make(&lagging);
        s->memory = memory;
        for (size_t r = 0, at = 0; there && r < RUNS;
             at += data.run[r++].n) /* what the lagging model leaves is the noise */
            for (size_t i = 0; i < data.run[r].n; i++)
                data.run[r].force[i] = s->force[at + i] + 1e-4 * cos(2.0 * (double)(at + i));
        ck_assert_int_eq(explain_drop(s, 6, -HUGE_VAL, true, &dropped), PALP_OK);
        ck_assert_int_eq(dropped, (there ? PALP_EFFECT_COUNT : PALP_EFFECT_SENSOR_LAG));
        ck_assert_uint_eq(s->fit.model.n_effects, (size_t)there);
        search_end(s);
        free(memory);
    }
}
END_TEST

/* Starts that are eight orders of magnitude astray do not make a candidate worse than the fit that it is
 * added to: there the effect is nothing. The scatter is found in turn with the rest, which leaves some
 * hundredths of a nat. */
START_TEST(a_candidate_is_never_worse_than_its_base) {
    static const palp_effect_id id[] = {PALP_EFFECT_RELAXATION_ARM, PALP_EFFECT_SENSOR_LAG,
                                        PALP_EFFECT_FRAME_COMPLIANCE};
    palp_model m = linear_model(8);
    begin(&m, ones, none, 0, 0);
    explain_search *s = search_make(&m);
    ck_assert_int_eq(explain_fit_products(&s->fit, &s->data, NULL), PALP_OK);
    ck_assert_int_eq(explain_fit_settle(&s->fit, &s->data, &settings), PALP_OK);
    for (size_t i = 0; i < sizeof id / sizeof *id; i++) {
        palp_model astray = m;
        explain_multistart found = {.n = 1};
        explain_fit *start = &found.start[0].fit, added;
        add_effect(&astray, id[i], 1e8);
        ck_assert_int_eq(explain_fit_beside(&s->fit, &astray, &s->data, start), PALP_OK);
        ck_assert_int_eq(explain_fit_products(start, &s->data, NULL), PALP_OK);
        ck_assert_int_eq(explain_candidate_finish(&s->fit, &found, &s->data, &settings, id[i], true, &added),
                         PALP_OK);
        ck_assert_msg(added.score > s->fit.score - 0.1, "%s: %g, without it %g",
                      palp_effect_look_up(id[i])->id, added.score, s->fit.score);
        explain_fit_free(&added);
        explain_multistart_free(&found);
    }
    search_end(s);
}
END_TEST

/* A scatter that was found beside effects is told without them only if one value for all runs leaves more
 * than the plain model. */
START_TEST(a_scatter_without_its_effects) {
    explain_search s = {.opened = 2.0};
    palp_explanation e = {.n_effects = 1,
                          .zero = {.found = true, .without_N = 2.5},
                          .contact = {.found = true, .without_N = 1.5},
                          .gain = {.found = false, .without_N = 2.5},
                          .gap = {.after_N = 1, .heldout_before_N = 3, .heldout_after_N = 1}};
    explain_disown(&s, &e);
    ck_assert_uint_eq(e.n_effects, 0);
    ck_assert_double_eq(e.gap.after_N, 2);
    ck_assert_double_eq(e.gap.heldout_after_N, 3);
    ck_assert(e.zero.found && !e.contact.found && !e.gain.found);
}
END_TEST

/* ---- the null threshold ---- */

/* Of one candidate half the square of a normal number, of two the larger of two: quantiles 1.92 and 2.50 at a
 * chance of 0.05; the simulated ones have a standard error of 0.06 and 0.07. */
START_TEST(chance_gains_half_a_squared_normal_number) {
    palp_model m = linear_model(8);
    explain_search *s = calloc(1, sizeof *s);
    double threshold, *rest;
    double share[PALP_EFFECT_COUNT] = {0};
    ck_assert_ptr_nonnull(s);
    begin(&m, ones, none, 0, 0);
    rest = calloc(2 * data.n, sizeof *rest);
    ck_assert_ptr_nonnull(rest);
    for (size_t i = 0; i < data.n; i++)
        rest[i] = 1e-3 * cos(2.0 * (double)i);
    ck_assert_int_eq(explain_noise_find(&data, rest), PALP_OK);
    *s = (explain_search){.data = data, .settings = &settings, .force = rest, .residual = rest};
    ck_assert_int_eq(explain_fit_create(&m, &data, &s->fit), PALP_OK);
    s->fit.scatter = (explain_scatter){1e-3, 3e-6, 3e-3, 0};
    ck_assert_int_eq(explain_fit_products(&s->fit, &data, NULL), PALP_OK);
    memset(settings.candidate, 0, sizeof settings.candidate);
    settings.candidate[PALP_EFFECT_SENSOR_BIAS] = 1;
    ck_assert_int_eq(explain_null_threshold(s, &threshold, share), PALP_OK);
    ck_assert_double_eq_tol(threshold, 1.92, 0.2);
    ck_assert(share[PALP_EFFECT_SENSOR_BIAS] > 0.05 && share[PALP_EFFECT_COULOMB_FRICTION] == 0.0);
    settings.candidate[PALP_EFFECT_COULOMB_FRICTION] = 1;
    ck_assert_int_eq(explain_null_threshold(s, &threshold, share), PALP_OK);
    ck_assert_double_eq_tol(threshold, 2.50, 0.22);
    ck_assert_double_gt(share[PALP_EFFECT_COULOMB_FRICTION], 0.05);
    explain_fit_free(&s->fit);
    explain_data_free(&data);
    free(rest);
    free(s);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, replicates_by_their_paths);
    tcase_add_test(tc, spikes_and_releases_are_events);
    tcase_add_test(tc, a_lone_sample_is_no_release);
    tcase_add_test(tc, a_zero_is_no_pull);
    tcase_add_test(tc, a_pull_may_hide_in_the_noise);
    tcase_add_test(tc, the_slope_of_chi2);
    tcase_add_test(tc, a_likelihood_that_is_followed_ends_where_a_parabola_does);
    tcase_add_test(tc, a_zero_and_a_gain_separate_nothing);
    tcase_add_test(tc, alike_by_the_cosine);
    tcase_add_test(tc, a_pull_is_searched_from_every_start);
    tcase_add_test(tc, a_needless_effect_is_taken_out);
    tcase_add_test(tc, a_candidate_is_never_worse_than_its_base);
    tcase_add_test(tc, a_scatter_without_its_effects);
    tcase_add_test(tc, evidence_is_widened_where_the_effect_leans);
    tcase_add_test(tc, chance_gains_half_a_squared_normal_number);
}
