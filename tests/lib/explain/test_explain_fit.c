/* test_explain_fit.c: the sums of a fit against the covariances they stand for, with runs that are random
 * numbers. */
#include "base/dense.h"
#include "explain/explain_result.h"

#include <check.h>
#include <math.h>
#include <palpate/random.h>
#include <stdlib.h>
#include <string.h>

enum { N = 12, K = 2, Q = EXPLAIN_NUISANCES, M = K + Q + 1, RUNS_MAX = 7 };

static double column[RUNS_MAX][M * N]; /* whitened: two parameters, the nuisances, the residual */
static explain_run run[RUNS_MAX];
static explain_data data;
static explain_fit fit;

static void multiply(size_t r) {
    dense_transposed_product(M, M, N, column[r], column[r], fit.product + r * M * M);
}

/* A model of one coefficient and a sensor's bias. */
static void begin(size_t n_runs) {
    uint64_t state = 5;
    const double stiffness = 8;
    memset(run, 0, sizeof run);
    memset(&fit, 0, sizeof fit);
    data =
        (explain_data){.n_runs = n_runs, .n = n_runs * N, .run = run, .peak = 1, .deepest = 1, .height = 1};
    fit.n_columns = K;
    fit.m = M;
    fit.scatter = (explain_scatter){0.25, 0.4, 0.6, 0};
    fit.hum_N = 0.7;
    ck_assert_int_eq(palp_law_polynomial(1, &stiffness, &fit.model.material.law), PALP_OK);
    ck_assert_int_eq(palp_effect_default(PALP_EFFECT_SENSOR_BIAS, &fit.model.effects[0]), PALP_OK);
    fit.model.n_effects = 1;
    fit.product = calloc(RUNS_MAX * M * M, sizeof *fit.product);
    ck_assert_ptr_nonnull(fit.product);
    for (size_t k = 0; k < K; k++) {
        fit.low[k] = -HUGE_VAL;
        fit.high[k] = HUGE_VAL;
        fit.unit[k] = 0.4 + 0.3 * (double)k;
        fit.x[k] = 0.05;
    }
    for (size_t r = 0; r < n_runs; r++) {
        run[r].n = N;
        for (size_t i = 0; i < M * N; i++)
            column[r][i] = palp_random_normal(&state);
        multiply(r);
    }
}

static void end(void) {
    free(fit.product);
}

static void nuisance_sd(double sd[Q]) {
    const double all[Q] = {0.25, 0.4, 0.6, 0.7, 0.7};
    memcpy(sd, all, sizeof all);
}

/* The residual's covariance [N N] with the nuisances free: its factor; what is solved with it comes after. */
static void covariance(size_t r, double *v) {
    double sd[Q];
    nuisance_sd(sd);
    for (size_t i = 0; i < N; i++)
        for (size_t j = 0; j < N; j++) {
            v[i * N + j] = i == j;
            for (size_t q = 0; q < Q; q++)
                v[i * N + j] += sd[q] * sd[q] * column[r][(K + q) * N + i] * column[r][(K + q) * N + j];
        }
}

/* a' v^-1 b, and the log determinant of v. */
static double through(const double *v, const double *a, const double *b, double *logdet) {
    double factor[N * N], x[N];
    memcpy(factor, v, sizeof factor);
    memcpy(x, b, sizeof x);
    ck_assert(dense_cholesky(N, factor));
    dense_cholesky_solve(N, factor, 1, x);
    *logdet = 0;
    for (size_t i = 0; i < N; i++)
        *logdet += 2 * log(factor[i * N + i]);
    double sum = 0;
    for (size_t i = 0; i < N; i++)
        sum += a[i] * x[i];
    return sum;
}

#define CLOSE(a, b, tolerance) ck_assert_double_eq_tol(a, b, (tolerance) * (1 + fabs((double)(b))))

START_TEST(nuisances_are_integrated_out) {
    begin(3);
    for (size_t r = 0; r < 3; r++) {
        double v[N * N], h[K * K], g[K], chi2, logdet, known, alone, alone_logdet;
        const double *y = column[r] + (M - 1) * N;
        covariance(r, v);
        explain_normal_of(&fit, r, h, g, &chi2, &logdet);
        CLOSE(chi2, through(v, y, y, &known), 1e-10);
        CLOSE(logdet, known, 1e-10);
        for (size_t a = 0; a < K; a++) {
            CLOSE(g[a], through(v, column[r] + a * N, y, &known), 1e-10);
            for (size_t b = 0; b < K; b++)
                CLOSE(h[a * K + b], through(v, column[r] + a * N, column[r] + b * N, &known), 1e-10);
        }
        explain_normal_of(&fit, r, NULL, NULL, &alone, &alone_logdet);
        ck_assert_double_eq(alone, chi2);
        ck_assert_double_eq(alone_logdet, logdet);
    }
    end();
}
END_TEST

/* Their means and sds beside the residual: S S N' v^-1 y, and of S S - S S N' v^-1 N S S the diagonal. */
START_TEST(nuisances_at_the_fit) {
    begin(2);
    for (size_t r = 0; r < 2; r++) {
        double v[N * N], prior[Q], own[Q], sd[Q], known;
        covariance(r, v);
        nuisance_sd(prior);
        explain_nuisances(&fit, r, own, sd);
        for (size_t q = 0; q < Q; q++) {
            const double *n = column[r] + (K + q) * N, *y = column[r] + (M - 1) * N;
            double s2 = prior[q] * prior[q];
            CLOSE(own[q], s2 * through(v, n, y, &known), 1e-10);
            CLOSE(sd[q], sqrt(s2 - s2 * s2 * through(v, n, n, &known)), 1e-10);
        }
    }
    end();
}
END_TEST

START_TEST(likelihood_and_chi2_of_the_runs_that_are_fitted) {
    begin(3);
    double score = 0, chi2 = 0;
    run[1].held_out = true;
    for (size_t r = 0; r < 3; r += 2) {
        double v[N * N], logdet;
        const double *y = column[r] + (M - 1) * N;
        covariance(r, v);
        double own = through(v, y, y, &logdet);
        chi2 += own;
        score -= 0.5 * (own + logdet);
    }
    CLOSE(explain_fit_score(&fit, &data), score, 1e-10);
    CLOSE(explain_chi2(&data, &fit), chi2 / (2 * N), 1e-10);
    ck_assert_uint_eq(explain_samples(&data), 2 * N);
    end();
}
END_TEST

/* What the runs but r say of the parameters, h[K K] and g[K], with their priors. */
static void others(size_t r, double h[K * K], double g[K]) {
    memset(g, 0, K * sizeof *g);
    for (size_t a = 0; a < K; a++)
        for (size_t b = 0; b < K; b++)
            h[a * K + b] = a == b ? 1 / (fit.unit[a] * fit.unit[a]) : 0;
    for (size_t s = 0; s < data.n_runs; s++) {
        double own_h[K * K], own_g[K], chi2, logdet;
        if (s == r || run[s].held_out)
            continue;
        explain_normal_of(&fit, s, own_h, own_g, &chi2, &logdet);
        for (size_t i = 0; i < K * K; i++)
            h[i] += own_h[i];
        for (size_t a = 0; a < K; a++)
            g[a] += own_g[a];
    }
}

static void invert(const double h[K * K], double inverse[K * K]) {
    double det = h[0] * h[3] - h[1] * h[2];
    const double i[K * K] = {h[3] / det, -h[1] / det, -h[2] / det, h[0] / det};
    memcpy(inverse, i, sizeof i);
}

/* A run left out is normal about what the others' parameters predict, with their uncertainty beside its own.
 */
START_TEST(a_run_is_predicted_by_the_others) {
    double score[4];
    begin(4);
    run[2].held_out = true;
    ck_assert_int_eq(explain_fit_leave_out(&fit, &data, score), PALP_OK);
    for (size_t r = 0; r < 4; r++) {
        double v[N * N], h[K * K], g[K], p[K * K], y[N], logdet;
        covariance(r, v);
        others(r, h, g);
        invert(h, p);
        double move[K] = {p[0] * g[0] + p[1] * g[1], p[2] * g[0] + p[3] * g[1]};
        for (size_t i = 0; i < N; i++) {
            y[i] = column[r][(M - 1) * N + i] - move[0] * column[r][i] - move[1] * column[r][N + i];
            for (size_t j = 0; j < N; j++)
                for (size_t a = 0; a < K; a++)
                    for (size_t b = 0; b < K; b++)
                        v[i * N + j] += column[r][a * N + i] * p[a * K + b] * column[r][b * N + j];
        }
        double chi2 = through(v, y, y, &logdet);
        CLOSE(score[r], -0.5 * (chi2 + logdet), 1e-6);
    }
    end();
}
END_TEST

/* Two fits of the same runs: the sum of the scores' differences, its standard error as of that many numbers,
 * and the sum without the largest. */
START_TEST(a_pair_of_fits) {
    double a[4], b[4], gain = 0, squares = 0, most = -HUGE_VAL;
    explain_pair pair;
    begin(4);
    explain_fit other = fit;
    other.scatter.gain = 3;
    run[3].held_out = true;
    ck_assert_int_eq(explain_fit_leave_out(&fit, &data, a), PALP_OK);
    ck_assert_int_eq(explain_fit_leave_out(&other, &data, b), PALP_OK);
    for (size_t r = 0; r < 3; r++) {
        gain += b[r] - a[r];
        most = fmax(most, b[r] - a[r]);
    }
    for (size_t r = 0; r < 3; r++)
        squares += pow(b[r] - a[r] - gain / 3, 2);
    ck_assert_int_eq(explain_paired(&data, &fit, &other, &pair), PALP_OK);
    CLOSE(pair.gain, gain, 1e-12);
    CLOSE(pair.se, sqrt(3 * squares / 2), 1e-12);
    CLOSE(pair.rest, gain - most, 1e-12);
    end();
}
END_TEST

/* A law that falls below a thousandth of the typical stiffness meets a wall: of a polynomial at all strains,
 * of a spline at its knots. */
START_TEST(the_wall_below_a_law) {
    static const double soft = 5e-4, line[] = {2, -3}, strain[] = {0, 0.3}, stiffness[] = {1, 2};
    levenberg_walls walls;
    begin(1);
    const size_t n = fit.n_columns;
    ck_assert_int_eq(palp_law_polynomial(1, &soft, &fit.model.material.law), PALP_OK);
    CLOSE(explain_fit_wall(&fit, &data), 201 * pow(5e-4 / 1e-7, 2), 1e-9);
    ck_assert_int_eq(palp_law_polynomial(2, line, &fit.model.material.law), PALP_OK);
    ck_assert_double_eq(explain_fit_wall(&fit, &data), 0.0);
    ck_assert_int_eq(explain_walls_find(&fit, &data, &walls), PALP_OK);
    ck_assert_uint_eq(walls.count, 201);
    CLOSE(walls.row[200 * n] * line[0] + walls.row[200 * n + 1] * line[1], 2 - 3 * 0.4, 1e-12);
    CLOSE(walls.least[200], 1.001e-3, 1e-12);
    free(walls.row);
    ck_assert_int_eq(palp_law_spline(2, strain, stiffness, &fit.model.material.law), PALP_OK);
    ck_assert_int_eq(explain_walls_find(&fit, &data, &walls), PALP_OK);
    ck_assert_uint_eq(walls.count, 2);
    CLOSE(walls.least[1], 0.999e-3, 1e-12);
    for (size_t i = 0; i < 2; i++)
        for (size_t k = 0; k < n; k++)
            ck_assert_double_eq(walls.row[i * n + k], i == k ? 1.0 : 0.0);
    free(walls.row);
    end();
}
END_TEST

/* ---- a trial ---- */

/* An estimate that reaches either end to a hundredth of it is no finding, whatever the other end is. */
START_TEST(an_estimate_at_its_end) {
    static const struct {
        double bias;
        bool taken;
    } cases[] = {{0.5, true},  {1.9, true},   {1.99, false},  {2, false},
                 {-0.9, true}, {-0.94, true}, {-0.945, false}};
    palp_explain_settings settings = palp_explain_settings_default();
    explain_search *s = calloc(1, sizeof *s);
    ck_assert_ptr_nonnull(s);
    begin(2);
    s->data = data;
    s->settings = &settings;
    fit.low[1] = -0.95;
    fit.high[1] = 2;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        explain_trial t = {.tried = true,
                           .fit = fit,
                           .raw_gain = 30,
                           .gain = 20,
                           .inflation = 1,
                           .beside_zeros = 20,
                           .held_out_gain = 20,
                           .held_out_se = 5,
                           .held_out_rest = 10,
                           .explained = 1,
                           .from_zero = true};
        t.fit.x[1] = cases[i].bias;
        const char *reason = explain_judged(s, &t, 5);
        if (cases[i].taken)
            ck_assert_msg(reason == NULL, "%s", reason);
        else
            ck_assert_str_eq(reason, "its estimate is at the end of what these runs can mean");
    }
    end();
    free(s);
}
END_TEST

/* ---- intervals ---- */

static double half_width(size_t n_runs, double size, bool alike, double *noise, double *between) {
    double h[K * K], g[K], p[K * K], chi2, logdet, low, high;
    palp_explain_settings settings = palp_explain_settings_default();
    explain_search *s = calloc(1, sizeof *s);
    palp_explanation *e = calloc(1, sizeof *e);
    ck_assert(s && e);
    begin(n_runs);
    fit.model.kind = PALP_MODEL_NETWORK; /* whose likelihood is not followed */
    for (size_t r = 0; r < n_runs; r++) {
        for (size_t i = 0; i < N; i++) { /* alike: noise; else every run wants another bias */
            double *y = &column[r][(M - 1) * N + i], want = cos(2.0 * (double)r);
            *y = size * (alike ? *y : want * column[r][N + i]);
        }
        multiply(r);
    }
    *s = (explain_search){.data = data, .settings = &settings, .fit = fit};
    ck_assert_int_eq(explain_intervals(s, e), PALP_OK);
    low = e->effect[0].low[0];
    high = e->effect[0].high[0];
    CLOSE(0.5 * (low + high), 0.05, 1e-12);
    others(n_runs, h, g); /* all of them */
    invert(h, p);
    *noise = 1.96 * sqrt(p[3] * fmax(1, explain_chi2(&data, &fit)));
    *between = 0;
    for (size_t r = 0; r < n_runs; r++) {
        explain_normal_of(&fit, r, h, g, &chi2, &logdet);
        *between += pow(p[2] * g[0] + p[3] * g[1], 2);
    }
    *between = sqrt(*between * (double)n_runs / ((double)n_runs - 1));
    end();
    free(s);
    free(e);
    return 0.5 * (high - low);
}

/* The wider of what the noise allows and what the runs agree on, with a hundredth of the parameter beside it.
 */
START_TEST(intervals_by_noise_and_by_runs) {
    static const struct {
        size_t n;
        double student;
    } rows[] = {{2, 12.706}, {3, 4.303}, {4, 3.182}, {7, 2.447}};
    double noise, between;
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        double wide = half_width(rows[k].n, 3, false, &noise, &between);
        between *= rows[k].student;
        ck_assert_double_gt(between, 1.2 * noise);
        CLOSE(wide, hypot(between, 5e-4), rows[k].n > 5 ? 0.01 : 1e-3);
    }
    double wide = half_width(4, 0.02, true, &noise, &between);
    ck_assert_double_gt(noise, 3.182 * between);
    CLOSE(wide, hypot(noise, 5e-4), 1e-9);
}
END_TEST

/* ---- scatter ---- */

/* Columns so large that a run's nuisance parameters are known: they and the expectation make the scatter,
 * whatever its size. What the caller expects counts as six runs, what the noise hides as one; no contact is a
 * quarter of the travel. */
START_TEST(scatter_between_runs) {
    palp_explain_settings settings = palp_explain_settings_default();
    const double own[3][3] = {{2e-4, 4e-6, 3e-3}, {-3e-4, -2e-6, 4e-3}, {1e-4, 5e-6, -5e-3}}, white = 1e-3;
    settings.contact_scatter_m = 3e-6;
    settings.repeatability = 3e-3;
    const double expected[3] = {0.3 * white, 3e-6, 3e-3}, trust[3] = {1, 6, 6};
    for (int capped = 0; capped < 2; capped++) {
        begin(3);
        const double large[3] = {30 * expected[0], 0.6, 0.3};
        double wanted[3], cost = 0;
        for (size_t r = 0; r < 3; r++) {
            run[r].white = white;
            for (size_t i = 0; i < N; i++) {
                double *y = &column[r][(M - 1) * N + i];
                *y = 0;
                for (size_t q = 0; q < 3; q++) {
                    column[r][(K + q) * N + i] *= 1e4 / expected[q];
                    *y += (capped ? large[q] : own[r][q]) * column[r][(K + q) * N + i];
                }
            }
            multiply(r);
        }
        fit.scatter = (explain_scatter){0, 0, 0, 0};
        fit.hum_N = 0;
        explain_fit_scatter(&fit, &data, &settings);
        for (size_t q = 0; q < 3; q++) {
            double sum = trust[q] * expected[q] * expected[q];
            for (size_t r = 0; r < 3; r++)
                sum += pow(capped ? large[q] : own[r][q], 2);
            wanted[q] = fmin(sqrt(sum / (3 + trust[q])), q == 1 ? 0.25 : HUGE_VAL);
            cost += 0.5 * trust[q] * (pow(expected[q] / wanted[q], 2) - 1 - 2 * log(expected[q] / wanted[q]));
        }
        CLOSE(fit.scatter.zero / wanted[0], 1, 1e-6);
        CLOSE(fit.scatter.contact / wanted[1], 1, 1e-6);
        CLOSE(fit.scatter.gain / wanted[2], 1, 1e-6);
        CLOSE(explain_fit_score(&fit, &data) - fit.score, cost, 1e-6);
        end();
    }
}
END_TEST

void tests(TCase *tc) {
    tcase_add_test(tc, nuisances_are_integrated_out);
    tcase_add_test(tc, nuisances_at_the_fit);
    tcase_add_test(tc, likelihood_and_chi2_of_the_runs_that_are_fitted);
    tcase_add_test(tc, a_run_is_predicted_by_the_others);
    tcase_add_test(tc, a_pair_of_fits);
    tcase_add_test(tc, the_wall_below_a_law);
    tcase_add_test(tc, an_estimate_at_its_end);
    tcase_add_test(tc, intervals_by_noise_and_by_runs);
    tcase_add_test(tc, scatter_between_runs);
}
