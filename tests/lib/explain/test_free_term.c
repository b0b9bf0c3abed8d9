/* test_free_term.c: free terms: along a path, in a model file, their posterior against the dense formula of a
 * Gaussian process. */
#define _POSIX_C_SOURCE 200809L
#include "scratch.h"
#include "base/dense.h"
#include "explain/infer_internal.h"
#include "forward_make.h"

#include <palpate/random.h>

enum { N = PALP_FREE_NODES, SAMPLES = 120 };

static palp_free_term term_of(palp_free_kind kind, double from, double to) {
    palp_free_term t = {.kind = kind, .from = from, .to = to, .depth_m = 4e-3, .slow_m_s = 1e-3};
    for (int a = 0; a < N; a++) {
        const double x = from + (to - from) * a / (N - 1.0);
        t.force_N[a] = 0.3 * x; /* which a natural spline follows exactly */
        t.sd_N[a] = 0.01;
    }
    return t;
}

/* In, a dwell and out, at 2 mm/s to 4 mm. */
static void path(double *time, double *depth) {
    for (size_t i = 0; i < SAMPLES; i++) {
        time[i] = 7 + 0.05 * (double)i;
        const double t = time[i] - 7;
        depth[i] = 1e-3 * fmax(-1, t < 2 ? 2 * t : t < 4 ? 4 : 4 - 2 * (t - 4) * 1.5);
    }
}

START_TEST(a_line_is_followed_by_each_kind) {
    double time[SAMPLES], depth[SAMPLES], force[SAMPLES];
    path(time, depth);
    static const struct {
        palp_free_kind kind;
        double from, to, at_1s, at_5s; /* 2 mm on the way in, 1 mm on the way out */
    } cases[] = {
        {PALP_FREE_RUN, 0, 10, 0.3, 1.5},
        {PALP_FREE_SESSION, 100, 110, 0.3 * 101, 0.3 * 105},
        {PALP_FREE_PLACE, -0.01, 0.01, 0.3 * 2e-3, 0.3 * 1e-3},
        {PALP_FREE_LOADING, 0, 0.5, 0.3 * 0.2, 0},
        {PALP_FREE_UNLOADING, 0, 0.5, 0, 0.3 * 0.1},
        {PALP_FREE_EARLY, -5, 5, 0, 0.3 * 1.6094379124341003},
        {PALP_FREE_SPEED, -3, 3, 0.3 * 1.4436354751788103, -0.3 * 1.8184464592320668},
        {PALP_FREE_TURN, 0, 0.01, 0.3 * 2e-3 * 0.5, -0.3 * 3e-3 * 0.25},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        const palp_free_term t = term_of(cases[c].kind, cases[c].from, cases[c].to);
        memset(force, 0, sizeof force);
        ck_assert_int_eq(palp_free_term_add(&t, SAMPLES, time, depth, 0.01, 100, force), PALP_OK);
        ck_assert_double_eq_tol(force[20], cases[c].at_1s, 1e-9);
        ck_assert_double_eq_tol(force[100], cases[c].at_5s, 1e-9);
    }
    const palp_free_term dwell = term_of(PALP_FREE_DWELL, log(0.05), log(5));
    memset(force, 0, sizeof force);
    ck_assert_int_eq(palp_free_term_add(&dwell, SAMPLES, time, depth, 0.01, 0, force), PALP_OK);
    ck_assert_double_eq(force[20], 0);
    ck_assert_double_eq_tol(force[60], 0.3 * log(1.0), 0.3 * 0.06); /* a second, to a sample */
    ck_assert_double_eq(force[100], 0);
}
END_TEST

START_TEST(a_gain_multiplies_the_force_of_the_plate) {
    double time[SAMPLES], depth[SAMPLES], force[SAMPLES];
    path(time, depth);
    palp_free_term t = term_of(PALP_FREE_GAIN, 0, 0.01);
    ck_assert_int_eq(palp_free_term_check(&t), PALP_ERR_ARGUMENT);
    t.plate_N = 5;
    for (size_t i = 0; i < SAMPLES; i++)
        force[i] = 2 - 1e3 * depth[i];
    ck_assert_int_eq(palp_free_term_add(&t, SAMPLES, time, depth, 0.01, 100, force), PALP_OK);
    ck_assert_double_eq_tol(force[10], 1 + 0.3 * 1e-3 * 1 / 5, 1e-12);
    ck_assert_double_eq_tol(force[60], -2 + 0.3 * 4e-3 * -2 / 5, 1e-12);
    t = term_of(PALP_FREE_AGEING, 0, 10);
    ck_assert_int_eq(palp_free_term_check(&t), PALP_ERR_ARGUMENT);
    t.plate_N = 5;
    for (size_t i = 0; i < SAMPLES; i++)
        force[i] = 2 - 1e3 * depth[i];
    ck_assert_int_eq(palp_free_term_add(&t, SAMPLES, time, depth, 0.01, 100, force), PALP_OK);
    ck_assert_double_eq_tol(force[10], 1 + 0.3 * 0.5 * 1 / 5, 1e-12);
    ck_assert_double_eq_tol(force[60], -2 + 0.3 * 3 * -2 / 5, 1e-12);
}
END_TEST

/* Two changes of the speed, by -2 mm/s at 2 s and by -3 mm/s at 4 s: each starts the table, which ends at 0.
 */
START_TEST(a_response_begins_with_each_change_of_the_speed) {
    double time[SAMPLES], depth[SAMPLES], force[SAMPLES] = {0};
    path(time, depth);
    palp_free_term t = term_of(PALP_FREE_RESPONSE, 0, 2.5);
    for (int a = 0; a < N; a++)
        t.force_N[a] = 0.3 * (2.5 - 2.5 * a / (N - 1.0));
    const double unit = 4e-3 / 2.5;
    ck_assert_int_eq(palp_free_term_add(&t, SAMPLES, time, depth, 0.01, 100, force), PALP_OK);
    ck_assert_double_eq_tol(force[39], 0, 1e-9);
    ck_assert_double_eq_tol(force[40], -2e-3 / unit * 0.3 * 2.5, 1e-9);
    ck_assert_double_eq_tol(force[60], -2e-3 / unit * 0.3 * 1.5, 1e-9);
    ck_assert_double_eq_tol(force[84], -2e-3 / unit * 0.3 * 0.3 - 3e-3 / unit * 0.3 * 2.3, 1e-9);
    ck_assert_double_eq_tol(force[100], -3e-3 / unit * 0.3 * 1.5, 1e-9); /* the first is over */
}
END_TEST

START_TEST(a_wrong_term_is_refused) {
    palp_free_term t = term_of(PALP_FREE_RUN, 1, 1);
    double time[2] = {0, 1}, depth[2] = {0, 0}, force[2] = {0, 0};
    ck_assert_int_eq(palp_free_term_check(&t), PALP_ERR_ARGUMENT);
    ck_assert(isnan(palp_free_term_coordinate(&t, 0)));
    t.to = 2;
    ck_assert_int_eq(palp_free_term_check(&t), PALP_OK);
    ck_assert_int_eq(palp_free_term_add(&t, 2, time, depth, 0, 0, force), PALP_ERR_ARGUMENT);
    t.sd_N[3] = -1;
    ck_assert_int_eq(palp_free_term_check(&t), PALP_ERR_ARGUMENT);
    ck_assert_str_eq(palp_free_kind_name(PALP_FREE_KINDS), "unknown");
    ck_assert_str_eq(palp_free_class_name(PALP_FREE_CLASSES), "unknown");
}
END_TEST

/* Each kind is in four of the models. */
START_TEST(a_model_keeps_its_terms) {
    const size_t first = (size_t)_i;
    palp_model m = lumped_model(1), back;
    palp_error error;
    m.n_free = PALP_FREE_TERMS;
    for (size_t i = 0; i < m.n_free; i++) {
        const palp_free_kind kind = (palp_free_kind)((first + PALP_FREE_KINDS - 1 - i) % PALP_FREE_KINDS);
        m.free_term[i] = term_of(kind, -0.1, 0.37);
        m.free_term[i].does = (palp_free_class)i;
        m.free_term[i].plate_N = kind == PALP_FREE_GAIN || kind == PALP_FREE_AGEING ? 3.7 : 0;
    }
    const char *file = scratch_write("free.json", "", 0);
    ck_assert_int_eq(palp_model_write(&m, file, &error), PALP_OK);
    ck_assert_int_eq(palp_model_read(file, &back, NULL, &error), PALP_OK);
    ck_assert_uint_eq(back.n_free, m.n_free);
    for (size_t i = 0; i < m.n_free; i++) {
        ck_assert_int_eq(back.free_term[i].kind, m.free_term[i].kind);
        ck_assert_int_eq(back.free_term[i].does, m.free_term[i].does);
        ck_assert_double_eq_tol(back.free_term[i].from, m.free_term[i].from, 1e-15);
        ck_assert_double_eq(back.free_term[i].depth_m, m.free_term[i].depth_m);
        ck_assert_double_eq(back.free_term[i].plate_N, m.free_term[i].plate_N);
        ck_assert_mem_eq(back.free_term[i].force_N, m.free_term[i].force_N, sizeof m.free_term[i].force_N);
    }
    m.free_term[0].sd_N[0] = -1;
    ck_assert_int_eq(palp_model_write(&m, file, &error), PALP_ERR_ARGUMENT);
}
END_TEST

static palp_explain_input input[2];

/* Two runs of the model with a term, and a fit that has its kind. */
static void begin(explain_data *data, infer_fit *fit, palp_model *m) {
    const palp_explain_settings settings = palp_explain_settings_default();
    static samples s;
    uint64_t noise = 3;
    *m = lumped_model(1);
    for (size_t r = 0; r < 2; r++) {
        start(&s, 0, 0);
        for (size_t i = 1; i < 90; i++) {
            const double up = (double)i * (double)(r + 1) / 60, down = (80 - (double)i) / 20;
            s.time_s[i] = 0.05 * (double)i;
            s.depth_m[i] = 1e-3 * fmax(-0.5, 5 * fmin(1, fmin(up, down)));
        }
        s.n = 90;
        press_model(m, &s);
        for (size_t i = 0; i < s.n; i++)
            s.force_N[i] += 0.3 * exp(-s.time_s[i]) + 0.01 * palp_random_normal(&noise);
        input[r] = (palp_explain_input){samples_experiment(&s), "run.csv"};
    }
    ck_assert_int_eq(explain_data_create(2, input, &settings, m, data, NULL), PALP_OK);
    ck_assert_int_eq(infer_fit_create(m, data, NULL, fit), PALP_OK);
    fit->noise.encoder = 0; /* the steps of these straight ways are none */
    memset(fit->sizes.common, 0, sizeof fit->sizes.common);
    memset(fit->sizes.each, 0, sizeof fit->sizes.each);
    fit->free = true;
    fit->n_terms = 1;
    ck_assert_int_eq(infer_free_term(data, PALP_FREE_RUN, 0, &fit->term[0]), PALP_OK);
    fit->sizes.common[0][0] = 0.2;
    fit->sizes.common[0][1] = 0.05;
    ck_assert_int_eq(infer_fit_evaluate(fit, data), PALP_OK);
}

/* All samples' columns of parameters, the runs' own zero, contact and gain, and hats. */
static double column(const infer_fit *fit, const explain_data *data, size_t i, size_t a) {
    const size_t n = data->run[0].n, r = i / n;
    return fit->raw[r * n * fit->m + a * n + i % n];
}

/* mean = K H' S^-1 y of the hats, where S is the covariance of all samples: noise, prior and hats. */
START_TEST(its_posterior_is_that_of_a_gaussian_process) {
    explain_data data;
    infer_fit fit;
    palp_model m;
    infer_posterior p;
    double matern[N * N], kernel[N * N] = {0}, mean[N], log_det;
    begin(&data, &fit, &m);
    const size_t n = data.n, k = fit.k, hats = k + INFER_OWN;
    ck_assert_int_eq(infer_posterior_find(&fit, &data, &p), PALP_OK);
    for (int l = 0; l < INFER_LENGTHS; l++) {
        infer_matern(infer_lengths[l], matern);
        for (size_t i = 0; i < N * N; i++)
            kernel[i] += pow(fit.sizes.common[0][l], 2) * matern[i];
    }
    double *s = calloc(n * n + k * k * 2 + n * (N + 1), sizeof *s), *prior = s + n * n,
           *spread = prior + k * k, *y = spread + k * k, *hat = y + n;
    ck_assert_int_eq(infer_prior(&fit, &data, prior, &log_det), PALP_OK);
    for (size_t a = 0; a < k; a++)
        spread[a * (k + 1)] = 1;
    ck_assert(dense_cholesky(k, prior));
    dense_cholesky_solve(k, prior, k, spread);
    const size_t law = fit.c.model.material.law.n;
    for (size_t i = 0; i < n; i++) {
        y[i] = column(&fit, &data, i, fit.m - 1);
        for (size_t a = 0; a < k; a++) /* the prior is about its mean */
            y[i] += (fit.c.x[a] - fit.given[a]) * column(&fit, &data, i, a);
        for (size_t a = 0; a < N; a++) {
            hat[a * n + i] = column(&fit, &data, i, hats + a);
            for (size_t b = 0; b < law; b++)
                hat[a * n + i] -= p.turn[a * k + b] * column(&fit, &data, i, b);
        }
    }
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            const size_t r = i / data.run[0].n;
            double sum = i == j ? 1e-30 : 0;
            if (r == j / data.run[0].n) {
                double variance[90];
                infer_variance(&fit, 90, fit.sample + r * 90, variance);
                sum += i == j ? variance[i % 90] : 0;
                for (size_t a = 0; a < INFER_SLOW; a++)
                    sum +=
                        pow(fit.noise.slow[a], 2) *
                        exp(-fabs(data.run[r].time[i % 90] - data.run[r].time[j % 90]) / fit.noise.time[a]);
                for (size_t a = 0; a < INFER_OWN; a++)
                    sum += pow(fit.sizes.own[a], 2) * column(&fit, &data, i, k + a) *
                           column(&fit, &data, j, k + a);
            }
            for (size_t a = 0; a < k; a++)
                for (size_t b = 0; b < k; b++)
                    sum += column(&fit, &data, i, a) * spread[a * k + b] * column(&fit, &data, j, b);
            for (size_t a = 0; a < N; a++)
                for (size_t b = 0; b < N; b++)
                    sum += hat[a * n + i] * kernel[a * N + b] * hat[b * n + j];
            s[i * n + j] = sum;
        }
    ck_assert(dense_cholesky(n, s));
    dense_cholesky_solve(n, s, 1, y);
    for (size_t a = 0; a < N; a++) {
        mean[a] = 0;
        for (size_t b = 0; b < N; b++)
            mean[a] += kernel[a * N + b] * dense_dot(n, hat + b * n, y);
    }
    for (size_t a = 0; a < N; a++)
        ck_assert_double_eq_tol(mean[a], p.mean[a], 1e-5);
    ck_assert_double_gt(mean[0] - mean[N - 1], 0.1); /* it is the term indeed, but for the runs' zeros */
    infer_posterior_free(&p);
    free(s);
    infer_fit_free(&fit);
    explain_data_free(&data);
    for (size_t r = 0; r < 2; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}
END_TEST

/* What runs say of a table that they measure at each place with this sd, but for a constant if it is theirs.
 */
static void measure(const double table[N], double sd, bool free_constant, double information[N * N],
                    double pull[N]) {
    for (size_t a = 0; a < N; a++) {
        pull[a] = 0;
        for (size_t b = 0; b < N; b++) {
            information[a * N + b] = ((a == b ? 1.0 : 0.0) - (free_constant ? 1.0 / N : 0.0)) / (sd * sd);
            pull[a] += information[a * N + b] * table[b];
        }
    }
}

START_TEST(a_formula_is_found_again) {
    static const struct {
        palp_free_kind kind;
        double from, to;
        palp_formula_form form;
        double force, shape, sd; /* shape over the largest place */
    } cases[] = {
        {PALP_FREE_SPEED, -3, 3, PALP_FORM_POWER, 0.2, 0.4, 2e-3},
        {PALP_FREE_EARLY, -3, 3, PALP_FORM_EXPONENTIAL, 0.3, 0.06, 4e-3},
        {PALP_FREE_LOADING, 0, 0.3, PALP_FORM_HINGE, -0.5, 0.4, 4e-3},
        {PALP_FREE_PLACE, -2e-3, 5e-3, PALP_FORM_SATURATION, 0.3, 0.1, 2e-3},
    };
    uint64_t noise = 8;
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        palp_free_term t = term_of(cases[c].kind, cases[c].from, cases[c].to);
        palp_formula truth = {.n = 1, .scale = 0}, found;
        double table[N], information[N * N], pull[N];
        for (size_t a = 0; a < N; a++)
            truth.scale = fmax(truth.scale, fabs(palp_free_term_coordinate(&t, (double)a / (N - 1))));
        truth.part[0].form = cases[c].form;
        truth.part[0].force_N = cases[c].force;
        truth.part[0].shape = cases[c].shape;
        for (size_t a = 0; a < N; a++)
            table[a] = palp_formula_force(&truth, palp_free_term_coordinate(&t, (double)a / (N - 1))) +
                       cases[c].sd * palp_random_normal(&noise);
        measure(table, cases[c].sd, cases[c].kind != PALP_FREE_LOADING, information, pull);
        ck_assert_int_eq(palp_formula_find(&t, information, pull, 1, 0.05, &found), PALP_OK);
        ck_assert_uint_eq(found.n, 1);
        ck_assert_int_eq(found.part[0].form, cases[c].form);
        ck_assert_double_gt(found.evidence, 20);
        ck_assert_double_gt(found.evidence_over, 0);
        ck_assert_double_ge(cases[c].shape, found.part[0].shape_low - 0.02 * cases[c].shape);
        ck_assert_double_le(cases[c].shape, found.part[0].shape_high + 0.02 * cases[c].shape);
        ck_assert_double_ge(cases[c].force, found.part[0].force_low_N);
        ck_assert_double_le(cases[c].force, found.part[0].force_high_N);
    }
}
END_TEST

START_TEST(noise_has_no_formula) {
    const palp_free_term t = term_of(PALP_FREE_SPEED, -3, 3);
    uint64_t noise = 5;
    size_t named = 0;
    for (int k = 0; k < 100; k++) {
        double table[N], information[N * N], pull[N];
        palp_formula found;
        for (size_t a = 0; a < N; a++)
            table[a] = 0.01 * palp_random_normal(&noise);
        measure(table, 0.01, true, information, pull);
        ck_assert_int_eq(palp_formula_find(&t, information, pull, 1, 0.05, &found), PALP_OK);
        named += found.n > 0;
    }
    ck_assert_uint_le(named, 5);
    palp_formula none;
    double zero[N * N] = {0};
    ck_assert_int_eq(palp_formula_find(&t, zero, zero, 1, 0.05, &none), PALP_OK);
    ck_assert_uint_eq(none.n, 0);
    ck_assert_int_eq(palp_formula_find(&t, zero, zero, 1, 1, &none), PALP_ERR_ARGUMENT);
    ck_assert_str_eq(palp_formula_form_name(PALP_FORMS), "unknown");
}
END_TEST

void tests(TCase *tc) {
    tcase_add_checked_fixture(tc, scratch_setup, scratch_teardown);
    tcase_add_test(tc, a_line_is_followed_by_each_kind);
    tcase_add_test(tc, a_gain_multiplies_the_force_of_the_plate);
    tcase_add_test(tc, a_response_begins_with_each_change_of_the_speed);
    tcase_add_test(tc, a_wrong_term_is_refused);
    tcase_add_loop_test(tc, a_model_keeps_its_terms, 0, PALP_FREE_KINDS);
    tcase_add_test(tc, a_formula_is_found_again);
    tcase_add_test(tc, noise_has_no_formula);
    tcase_add_test(tc, its_posterior_is_that_of_a_gaussian_process);
}
