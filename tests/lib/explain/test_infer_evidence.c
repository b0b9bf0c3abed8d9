/* test_infer_evidence.c: the likelihood of doc/likelihood.md against the joint normal distribution of all
 * samples, written out. */
#include "base/dense.h"
#include "forward_make.h"
#include "explain/explain_lines.h"
#include "explain/infer_internal.h"

#include <palpate/random.h>

enum { MOST = 3, EACH = 90 };
static size_t runs = 2;
static const double NOISE = 0.01; /* N */

static palp_explain_input input[MOST];

/* A ramp, a dwell and a way back, the second twice as fast. */
static void record(const palp_model *m) {
    static samples s;
    uint64_t noise = 4;
    for (size_t r = 0; r < runs; r++) {
        start(&s, 0, 0);
        for (size_t i = 1; i < EACH; i++) {
            const double up = (double)i * (double)(r + 1) / 60, down = (EACH - 10.0 - (double)i) / 20;
            s.time_s[i] = 0.05 * (double)i + (i % 7 ? 0 : 0.01);
            s.depth_m[i] = 1e-3 * fmax(-0.5, 5 * fmin(1, fmin(up, down)));
        }
        s.n = EACH;
        palp_model own = *m;
        own.height_m *= r == 2 ? 1.3 : 1;
        press_model(&own, &s);
        for (size_t i = 0; i < EACH; i++)
            s.force_N[i] = s.force_N[i] + NOISE * palp_random_normal(&noise);
        palp_experiment *e = samples_experiment(&s);
        if (runs == MOST) { /* the first two are of one specimen */
            ck_assert_int_eq(palp_experiment_set_string(e, "specimen.name", r < 2 ? "a" : "b"), PALP_OK);
            ck_assert_int_eq(palp_experiment_set_number(e, "specimen.height_mm", 1e3 * own.height_m),
                             PALP_OK);
        }
        input[r] = (palp_explain_input){e, "run.csv"};
    }
}

/* A fit with something of everything. */
static void begin(explain_data *data, infer_fit *fit, palp_model *m) {
    const palp_explain_settings settings = palp_explain_settings_default();
    *m = lumped_model(1);
    record(m);
    ck_assert_int_eq(palp_law_scale(&m->material.law, 1.05, &m->material.law), PALP_OK);
    add_effect(m, PALP_EFFECT_COULOMB_FRICTION, 0.1);
    ck_assert_int_eq(explain_data_create(runs, input, &settings, m, data, NULL), PALP_OK);
    ck_assert_int_eq(infer_fit_create(m, data, NULL, fit), PALP_OK);
    fit->sizes.own[INFER_GAIN] = 0.02;
    fit->noise.depth = 1e-6;
    fit->noise.clock = 3e-3;
    fit->noise.encoder = 5e-6;
    fit->noise.freedom = 4;
    fit->converter = 0.01;
    for (size_t i = 0; i < data->n; i++) {
        fit->sample[i].keep = 0.9 * cos((double)i);
        fit->sample[i].certain = i % 5 ? 1.1 : 0.3;
        for (size_t a = 0; a < INFER_SLOW; a++)
            fit->sample[i].steady[a] = (i + a) % 7 ? 1.2 : 0.05;
    }
    for (size_t a = 0; a < INFER_SLOW; a++)
        fit->noise.slow_freedom[a] = 2 + (double)a;
    ck_assert_int_eq(infer_fit_evaluate(fit, data), PALP_OK);
    ck_assert_int_eq(infer_fit_score(fit, data), PALP_OK);
}

static void end(explain_data *data, infer_fit *fit) {
    infer_fit_free(fit);
    explain_data_free(data);
    for (size_t r = 0; r < runs; r++)
        palp_experiment_free((palp_experiment *)(uintptr_t)input[r].experiment);
}

/* Variance that slow process a gains in the step to sample i of a run. */
static double gained(const infer_fit *fit, const explain_run *run, const infer_sample *sample, size_t a,
                     size_t i) {
    const double decay = exp((run->time[i - 1] - run->time[i]) / fit->noise.time[a]);
    return pow(fit->noise.slow[a], 2) * (1 - decay * decay) / sample[i].steady[a];
}

/* Covariance of the noise alone between samples i and j of run r. */
static double noise_between(const infer_fit *fit, const explain_data *data, size_t r, size_t i, size_t j) {
    const explain_run *run = &data->run[r];
    const infer_sample *at = fit->sample + r * EACH, *s = &at[i];
    double encoder = pow(fit->noise.encoder, 2) * s->by_depth * at[j].by_depth, sum = 0;
    if (i == j)
        sum = (pow(fit->noise.white, 2) + pow(fit->converter, 2) / 12 +
               pow(s->by_depth * fit->noise.depth, 2) + pow(s->by_time * fit->noise.clock, 2)) /
              s->certain;
    for (size_t k = (i < j ? i : j) + 1; k <= (i < j ? j : i); k++)
        encoder *= at[k].keep;
    sum += encoder;
    for (size_t a = 0; a < INFER_SLOW; a++) {
        const double tau = fit->noise.time[a];
        double variance = pow(fit->noise.slow[a], 2);
        for (size_t k = 1; k <= (i < j ? i : j); k++)
            variance =
                variance * exp(2 * (run->time[k - 1] - run->time[k]) / tau) + gained(fit, run, at, a, k);
        sum += variance * exp(-fabs(run->time[i] - run->time[j]) / tau);
    }
    return sum;
}

/* Covariance of one set of hat coefficients. */
static double hats_between(const double size[INFER_DOMAINS][INFER_LENGTHS], size_t a, size_t b) {
    double matern[INFER_NODES * INFER_NODES], sum = 0;
    if (a / INFER_NODES != b / INFER_NODES)
        return 0;
    for (int l = 0; l < INFER_LENGTHS; l++) {
        infer_matern(infer_lengths[l], matern);
        sum += pow(size[a / INFER_NODES][l], 2) * matern[a % INFER_NODES * INFER_NODES + b % INFER_NODES];
    }
    return sum;
}

/* Column a of sample i of run r. */
static double column(const infer_fit *fit, size_t r, size_t a, size_t i) {
    return fit->raw[r * EACH * fit->m + a * EACH + i];
}

/* The same of hat a of all runs, without what the law follows of it: turn[INFER_HATS k]. */
static double hat_column(const infer_fit *fit, const double *turn, size_t r, size_t a, size_t i) {
    double sum = column(fit, r, fit->k + INFER_OWN + a, i);
    for (size_t b = 0; b < fit->k; b++)
        sum -= turn[a * fit->k + b] * column(fit, r, b, i);
    return sum;
}

/* What parameters and common hats do to samples at and bt of runs ri and rj. */
static double shared_between(const infer_fit *fit, const double *prior, const double *turn, size_t ri,
                             size_t at, size_t rj, size_t bt) {
    static double common[INFER_HATS][INFER_HATS];
    double sum = 0, x[INFER_HATS], y[INFER_HATS];
    for (size_t a = 0; a < INFER_HATS && !(common[INFER_HATS - 1][INFER_HATS - 1] > 0); a++)
        for (size_t b = 0; b < INFER_HATS; b++)
            common[a][b] = hats_between(fit->sizes.common, a, b);
    for (size_t a = 0; a < INFER_HATS; a++) {
        x[a] = hat_column(fit, turn, ri, a, at);
        y[a] = hat_column(fit, turn, rj, a, bt);
    }
    for (size_t a = 0; a < INFER_HATS; a++)
        for (size_t b = 0; b < INFER_HATS; b++)
            sum += x[a] * y[b] * common[a][b];
    for (size_t a = 0; a < fit->k; a++)
        for (size_t b = 0; b < fit->k; b++)
            sum += column(fit, ri, a, at) * prior[a * fit->k + b] * column(fit, rj, b, bt);
    return sum;
}

/* Adds what parameters, hats and the runs' own do to all pairs of samples; average: the contacts average 0.
 */
static void add_effects(const infer_fit *fit, const double *prior, const double *turn, bool average,
                        double *c) {
    const size_t n = runs * EACH, k = fit->k, hats = k + INFER_OWN;
    static double each[INFER_HATS][INFER_HATS];
    for (size_t a = 0; a < INFER_HATS; a++)
        for (size_t b = 0; b < INFER_HATS; b++)
            each[a][b] = hats_between(fit->sizes.each, a, b);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            const size_t ri = i / EACH, rj = j / EACH, at = i % EACH, bt = j % EACH;
            double sum = shared_between(fit, prior, turn, ri, at, rj, bt);
            for (size_t a = 0; a < INFER_HATS && ri == rj; a++)
                for (size_t b = 0; b < INFER_HATS; b++)
                    sum += column(fit, ri, hats + a, at) * column(fit, rj, hats + b, bt) * each[a][b];
            for (size_t a = 0; a < INFER_SPECIMEN && ri / 2 == rj / 2; a++)
                sum += pow(fit->sizes.specimen[a], 2) * column(fit, ri, k + INFER_BLOCK + a, at) *
                       column(fit, rj, k + INFER_BLOCK + a, bt);
            for (size_t a = 0; a < INFER_OWN; a++) {
                const double mean = average && a == INFER_CONTACT ? 1.0 / (double)runs : 0;
                sum += ((ri == rj) - mean) * pow(fit->sizes.own[a], 2) * column(fit, ri, k + a, at) *
                       column(fit, rj, k + a, bt);
            }
            c[i * n + j] += sum;
        }
}

static void compare_with_joint_density(bool average) {
    explain_data data;
    infer_fit fit;
    infer_posterior p;
    palp_model m;
    begin(&data, &fit, &m);
    data.contacts_average_0 = average;
    ck_assert_int_eq(infer_fit_score(&fit, &data), PALP_OK);
    ck_assert_int_eq(infer_posterior_find(&fit, &data, &p), PALP_OK);
    const size_t n = runs * EACH, k = fit.k;
    double *c = calloc(n * n + 2 * k * k + n, sizeof *c), *q = c + n * n, *prior = q + k * k,
           *y = prior + k * k;
    double log_det;
    ck_assert_ptr_nonnull(c);
    ck_assert_int_eq(infer_prior(&fit, &data, q, &log_det), PALP_OK);
    for (size_t a = 0; a < k; a++)
        prior[a * k + a] = 1;
    ck_assert(dense_cholesky(k, q));
    dense_cholesky_solve(k, q, k, prior);
    for (size_t i = 0; i < n; i++) {
        y[i] = column(&fit, i / EACH, fit.m - 1, i % EACH);
        for (size_t a = 0; a < k; a++)
            y[i] -= column(&fit, i / EACH, a, i % EACH) * (fit.given[a] - fit.c.x[a]);
        for (size_t j = 0; j < n; j++)
            c[i * n + j] =
                i / EACH == j / EACH ? noise_between(&fit, &data, i / EACH, i % EACH, j % EACH) : 0;
    }
    add_effects(&fit, prior, p.turn, average, c);
    infer_posterior_free(&p);
    ck_assert(dense_cholesky(n, c));
    dense_forward(n, c, 1, y);
    double expected = -0.5 * (dense_dot(n, y, y) + dense_log_determinant(n, c));
    for (size_t i = 0; i < n; i++)
        if (data.run[i / EACH].use[i % EACH])
            expected += infer_tail_evidence(fit.noise.freedom, fit.sample[i].certain);
    for (size_t i = 0; i < n; i++)
        for (size_t a = 0; a < INFER_SLOW && i % EACH > 0; a++)
            expected += infer_tail_evidence(fit.noise.slow_freedom[a], fit.sample[i].steady[a]);
    ck_assert_double_eq_tol(fit.promised, expected, 1e-6 * fabs(expected));
    free(c);
    end(&data, &fit);
}

START_TEST(the_evidence_is_the_joint_normal_density) {
    runs = (size_t)_i;
    compare_with_joint_density(false);
    runs = 2;
}
END_TEST

START_TEST(it_is_so_too_where_contacts_average_nothing) {
    runs = (size_t)_i;
    compare_with_joint_density(true);
    runs = 2;
}
END_TEST

/* Forces with known columns have the same products as a full evaluation at the point of the columns. */
START_TEST(forces_alone_have_the_same_products) {
    explain_data data;
    infer_fit fit;
    palp_model m;
    begin(&data, &fit, &m);
    ck_assert_int_eq(infer_fit_evaluate(&fit, &data), PALP_OK);
    const size_t n = data.n_runs * fit.m * fit.m;
    double *product = malloc(n * sizeof *product), most = 0;
    ck_assert_ptr_nonnull(product);
    memcpy(product, fit.product, n * sizeof *product);
    for (size_t r = 0, at = 0; r < data.n_runs; at += data.run[r++].n) /* residuals must be found again */
        memset(fit.raw + at * fit.m + (fit.m - 1) * data.run[r].n, 0, data.run[r].n * sizeof *fit.raw);
    ck_assert_int_eq(infer_fit_reevaluate(&fit, &data), PALP_OK);
    for (size_t i = 0; i < n; i++)
        most = fmax(most, fabs(product[i]));
    for (size_t i = 0; i < n; i++)
        ck_assert_double_eq_tol(fit.product[i], product[i], 1e-9 * fmax(fabs(product[i]), 1e-6 * most));
    free(product);
    end(&data, &fit);
}
END_TEST

/* The functions of a discrepancy follow any straight line through their nodes. A dwell begins at 0. */
START_TEST(a_discrepancy_follows_straight_lines) {
    explain_data data;
    infer_fit fit;
    palp_model m;
    begin(&data, &fit, &m);
    const explain_run *run = &data.run[1]; /* the one that dwells */
    double *column = malloc(INFER_HATS * run->n * sizeof *column);
    size_t pressed = 0, stood = 0;
    ck_assert_ptr_nonnull(column);
    infer_hats(&data, 1, 0.0, column);
    for (size_t i = 0; i < run->n; i++) {
        double sum = 0, line = 0;
        for (size_t a = 0; a < INFER_UNLOADING * INFER_NODES + INFER_NODES; a++) { /* on either way */
            sum += column[a * run->n + i];
            line += (double)(a % INFER_NODES) / (INFER_NODES - 1) * column[a * run->n + i];
        }
        const double share = fmax(0, run->depth[i] / run->height / data.strain);
        ck_assert_double_eq_tol(sum, run->depth[i] > 0, 1e-12);
        ck_assert_double_eq_tol(line, share, 1e-12);
        pressed += run->depth[i] > 0;
        stood += run->stood[i] > 1;
        ck_assert_double_eq(column[INFER_DWELL * INFER_NODES * run->n + i], 0);
    }
    ck_assert_uint_gt(pressed, 50);
    ck_assert_uint_gt(stood, 3);
    free(column);
    end(&data, &fit);
}
END_TEST

/* The mean of a run's own parameters is the same with their covariance and without it, also where the
 * contacts average 0. */
START_TEST(the_mean_alone_is_the_same) {
    explain_data data;
    infer_fit fit;
    infer_posterior p;
    palp_model m;
    double alone[INFER_BLOCK], own[INFER_BLOCK], covariance[INFER_BLOCK * INFER_BLOCK];
    begin(&data, &fit, &m);
    data.contacts_average_0 = _i == 1;
    ck_assert_int_eq(infer_posterior_find(&fit, &data, &p), PALP_OK);
    for (size_t r = 0; r < runs; r++) {
        ck_assert_int_eq(infer_own(&fit, &data, &p, r, alone, NULL), PALP_OK);
        ck_assert_int_eq(infer_own(&fit, &data, &p, r, own, covariance), PALP_OK);
        ck_assert_double_gt(fabs(own[INFER_CONTACT]), 0);
        for (size_t a = 0; a < INFER_BLOCK; a++)
            ck_assert_double_eq_tol(alone[a], own[a], 1e-9 * sqrt(covariance[a * (INFER_BLOCK + 1)]));
    }
    infer_posterior_free(&p);
    end(&data, &fit);
}
END_TEST

/* Held, what is the runs' own is where the columns are. The density is largest where the posterior has it. */
START_TEST(what_is_held_is_where_the_columns_are) {
    explain_data data;
    infer_fit fit;
    infer_posterior p;
    palp_model m;
    double own[INFER_BLOCK], specimen[INFER_SPECIMEN], here[3];
    begin(&data, &fit, &m);
    fit.held = true;
    for (int i = 0; i < 3; i++) {
        ck_assert_int_eq(infer_posterior_find(&fit, &data, &p), PALP_OK);
        here[i] = infer_log_evidence(&fit, &p, p.chi2);
        for (size_t r = 0; r < runs; r++) {
            ck_assert_int_eq(infer_own(&fit, &data, &p, r, own, NULL), PALP_OK);
            ck_assert_double_eq_tol(own[INFER_CONTACT], fit.c.contact[r],
                                    1e-6 * fit.sizes.own[INFER_CONTACT]);
            ck_assert_int_eq(infer_specimen_own(&p, r, specimen, NULL), PALP_OK);
            for (size_t a = 0; a < INFER_SPECIMEN; a++)
                ck_assert_double_eq_tol(specimen[a], fit.specimen[r * INFER_SPECIMEN + a], 1e-6);
        }
        infer_posterior_free(&p);
        fit.held = false;
        ck_assert_int_eq(infer_posterior_find(&fit, &data, &p), PALP_OK);
        ck_assert_int_eq(infer_own(&fit, &data, &p, 0, own, NULL), PALP_OK);
        infer_posterior_free(&p);
        fit.held = true;
        fit.c.contact[0] = own[INFER_CONTACT] + (i ? 2 : 0) * fit.sizes.own[INFER_CONTACT];
    }
    ck_assert_double_ge(here[1], here[0] - 0.01); /* the other runs stay where they are */
    ck_assert_double_lt(here[2], here[1]);
    end(&data, &fit);
}
END_TEST

/* The contacts average 0, exactly. */
START_TEST(contacts_average_nothing) {
    explain_data data;
    infer_fit fit;
    infer_posterior p;
    palp_model m;
    double own[INFER_BLOCK], mean = 0, most = 0;
    begin(&data, &fit, &m);
    data.contacts_average_0 = true;
    ck_assert_int_eq(infer_posterior_find(&fit, &data, &p), PALP_OK);
    for (size_t r = 0; r < runs; r++) {
        ck_assert_int_eq(infer_own(&fit, &data, &p, r, own, NULL), PALP_OK);
        mean += own[INFER_CONTACT];
        most = fmax(most, fabs(own[INFER_CONTACT]));
    }
    infer_posterior_free(&p);
    ck_assert_double_gt(most, 0);
    ck_assert_double_eq_tol(mean, 0, 1e-9 * most);
    end(&data, &fit);
}
END_TEST

/* Its columns are the derivatives of the force by the logarithms of both factors, at any height. */
START_TEST(a_specimen_has_the_column_of_its_factor) {
    explain_data data;
    infer_fit fit;
    palp_model m;
    runs = MOST;
    begin(&data, &fit, &m);
    const size_t r = 2, at = fit.k + INFER_BLOCK + (size_t)_i, y = fit.m - 1;
    double *specimen = fit.specimen + r * INFER_SPECIMEN + _i, low[EACH], column_at[EACH], most = 0;
    ck_assert_double_eq_tol(data.run[r].height, 1.3 * data.height, 1e-9);
    *specimen = 0.1;
    ck_assert_int_eq(infer_fit_evaluate(&fit, &data), PALP_OK);
    for (size_t i = 0; i < EACH; i++) {
        column_at[i] = column(&fit, r, at, i);
        most = fmax(most, fabs(column_at[i]));
    }
    *specimen = 0.1 - 1e-4;
    ck_assert_int_eq(infer_fit_evaluate(&fit, &data), PALP_OK);
    for (size_t i = 0; i < EACH; i++) /* without what is added to the residual, the force's negative */
        low[i] = column(&fit, r, y, i) - *specimen * column(&fit, r, at, i);
    *specimen = 0.1 + 1e-4;
    ck_assert_int_eq(infer_fit_evaluate(&fit, &data), PALP_OK);
    for (size_t i = 0; i < EACH; i++) {
        const double high = column(&fit, r, y, i) - *specimen * column(&fit, r, at, i);
        ck_assert_double_eq_tol((low[i] - high) / 2e-4, column_at[i], 1e-5 * most);
    }
    ck_assert_double_gt(most, 0);
    end(&data, &fit);
    runs = 2;
}
END_TEST

START_TEST(the_noise_is_white_after_the_filter) {
    explain_data data;
    infer_fit fit;
    palp_model m;
    begin(&data, &fit, &m);
    static double x[EACH * EACH], work[EACH * (INFER_FILTER + INFER_STATES)], variance[EACH], c[EACH * EACH],
        v[EACH], inverse[EACH], square[INFER_SLOW * EACH];
    const explain_run *run = &data.run[1];
    memset(x, 0, sizeof x);
    for (size_t i = 0; i < EACH; i++) {
        x[i * EACH + i] = 1; /* the filter's matrix, a row a sample */
        v[i] = sin((double)i);
        for (size_t j = 0; j < EACH; j++)
            c[i * EACH + j] = noise_between(&fit, &data, 1, i, j);
    }
    const infer_sample *sample = fit.sample + EACH;
    infer_variance(&fit, EACH, sample, variance);
    const double log_det =
        infer_whiten(&fit.noise, EACH, run->time, sample, variance, run->use, EACH, x, work);
    for (size_t i = 0; i < EACH; i++)
        for (size_t j = 0; j < EACH; j++) {
            double sum = 0;
            for (size_t a = 0; a < EACH; a++)
                for (size_t b = 0; b < EACH; b++)
                    sum += x[i * EACH + a] * c[a * EACH + b] * x[j * EACH + b];
            ck_assert_double_eq_tol(sum, i == j, 1e-9);
        }
    ck_assert(dense_cholesky(EACH, c));
    ck_assert_double_eq_tol(log_det, dense_log_determinant(EACH, c), 1e-8);
    static double y[EACH];
    memcpy(y, v, sizeof y);
    infer_whiten(&fit.noise, EACH, run->time, sample, variance, run->use, 1, v, work);
    infer_unwhiten(&fit.noise, EACH, sample, work, v, inverse, square);
    dense_cholesky_solve(EACH, c, 1, y);
    for (size_t i = 0; i < EACH; i++) {
        static double unit[EACH];
        memset(unit, 0, sizeof unit);
        unit[i] = 1;
        dense_cholesky_solve(EACH, c, 1, unit);
        ck_assert_double_eq_tol(v[i], y[i], 1e-9 * fmax(1, fabs(y[i])));
        ck_assert_double_eq_tol(inverse[i], unit[i], 1e-9 * unit[i]);
        for (size_t a = 0; a < INFER_SLOW && i > 0;
             a++) { /* innovation a to this sample, given all samples */
            const double own = gained(&fit, run, sample, a, i);
            static double with[EACH], solved[EACH];
            for (size_t j = 0; j < EACH; j++)
                solved[j] = with[j] =
                    j < i || !run->use[j] ? 0 : own * exp((run->time[i] - run->time[j]) / fit.noise.time[a]);
            dense_cholesky_solve(EACH, c, 1, solved);
            const double mean = dense_dot(EACH, with, y),
                         found = (mean * mean + own - dense_dot(EACH, with, solved)) /
                                 (own * sample[i].steady[a]);
            ck_assert_double_eq_tol(square[i * INFER_SLOW + a], found, 1e-8 * fmax(1, found));
        }
    }
    end(&data, &fit);
}
END_TEST

/* At the best expected precision the bound is Student's density itself, for one sample known exactly. */
START_TEST(the_bound_of_a_tail_is_students_density) {
    static const double freedom[] = {1, 3.5, 30, 1000}, x[] = {0, 0.7, 3, 30};
    for (size_t i = 0; i < 4; i++)
        for (size_t j = 0; j < 4; j++) {
            const double f = freedom[i], square = x[j] * x[j], w = (f + 1) / (f + square);
            const double bound = infer_tail_evidence(f, w) + 0.5 * (log(w) - w * square),
                         density = lgamma(0.5 * f + 0.5) - lgamma(0.5 * f) - 0.5 * log(0.5 * f) -
                                   (0.5 * f + 0.5) * log1p(square / f);
            ck_assert_double_eq_tol(bound, density, 1e-9 * fmax(1, fabs(density)));
            ck_assert_double_lt(infer_tail_evidence(f, 1.1 * w) + 0.5 * (log(1.1 * w) - 1.1 * w * square),
                                bound);
        }
}
END_TEST

/* Decimals of a file make no step but their own; an offset of all is none. */
START_TEST(steps_are_read_off_the_files) {
    double coarse[200], fine[200];
    for (size_t i = 0; i < 200; i++) {
        coarse[i] = -0.0123 + 7.5e-6 * floor(40 * sin(0.05 * (double)i));
        fine[i] = 3e-3 * sin(0.05 * (double)i);
    }
    ck_assert_double_eq_tol(infer_common_step(200, coarse, 0), 7.5e-6, 1e-12);
    ck_assert_double_eq_tol(infer_common_step(200, coarse, 1.5e-5), 7.5e-6, 1e-12);
    ck_assert(isnan(infer_common_step(200, fine, 0)));
    ck_assert(isnan(infer_common_step(200, coarse, NAN)));
}
END_TEST

/* One sample far off in a session of normal noise is found to be unlike the others, whose residuals stay. */
START_TEST(a_lone_sample_far_off_changes_little) {
    enum { ODD = 40 };
    explain_data data;
    infer_fit fit;
    palp_model m;
    static double left[2][MOST * EACH], taken[MOST * EACH];
    begin(&data, &fit, &m);
    double square = 0;
    for (int pass = 0; pass < 2; pass++) {
        data.run[0].force[ODD] += pass * 30 * NOISE;
        ck_assert_int_eq(infer_fit_evaluate(&fit, &data), PALP_OK);
        ck_assert_int_eq(infer_fit_settle(&fit, &data, 6, true), PALP_OK);
        ck_assert_int_eq(infer_residual(&fit, &data, left[pass], taken), PALP_OK);
        for (size_t i = 0; i < data.n; i++)
            left[pass][i] -= taken[i];
    }
    for (size_t i = 0; i < data.n; i++)
        square += i == ODD ? 0 : pow(left[1][i] - left[0][i], 2) / (double)data.n;
    ck_assert_msg(sqrt(square) < 0.5 * NOISE, "the others change by %g N", sqrt(square));
    ck_assert_double_lt(fit.sample[ODD].certain, 0.1);
    end(&data, &fit);
}
END_TEST

/* Where the force of one run steps, the correlated noise may step too, at that sample alone. */
START_TEST(a_step_is_one_innovation) {
    enum { ODD = 30 };
    explain_data data;
    infer_fit fit;
    palp_model m;
    begin(&data, &fit, &m);
    data.law_alone = true;
    for (size_t i = ODD; i < EACH; i++)
        data.run[0].force[i] += 30 * NOISE;
    infer_noise_begin(&fit, &data);
    fit.sizes = infer_sizes_first(&data);
    ck_assert_int_eq(infer_fit_evaluate(&fit, &data), PALP_OK);
    for (int i = 0; i < 3; i++)
        ck_assert_int_eq(infer_noise_learn(&fit, &data, 20, i == 0), PALP_OK);
    for (size_t i = 1; i < data.n; i++) {
        double least = 1;
        for (size_t a = 0; a < INFER_SLOW; a++)
            least = fmin(least, fit.sample[i].steady[a]);
        ck_assert_msg(i == ODD ? least < 0.02 : least > 0.1, "precision %g at sample %zu", least, i);
    }
    end(&data, &fit);
}
END_TEST

static double promised_with(infer_fit *fit, const explain_data *data, double *size, double factor) {
    const double was = *size;
    *size *= factor;
    ck_assert_int_eq(infer_fit_products(fit, data), PALP_OK);
    ck_assert_int_eq(infer_fit_score(fit, data), PALP_OK);
    *size = was;
    return fit->promised;
}

/* In one run, in two, in two specimens, and where contacts average 0. What the law follows of a common
 * discrepancy depends on the noise too, which the slopes leave out: a few percent with it, nothing without.
 */
START_TEST(the_slopes_of_the_noise_are_those_of_the_evidence) {
    explain_data data;
    infer_fit fit;
    infer_posterior p;
    palp_model m;
    const bool with = _i >= 4;
    runs = _i % 4 < 3 ? (size_t)_i % 4 + 1 : MOST;
    begin(&data, &fit, &m);
    data.contacts_average_0 = _i % 4 == 3;
    for (size_t d = 0; d < INFER_DOMAINS && !with; d++)
        for (size_t l = 0; l < INFER_LENGTHS; l++)
            fit.sizes.common[d][l] = 0;
    for (int a = 0; a < INFER_SLOW; a++)
        fit.noise.slow[a] = NOISE * (0.2 + 0.1 * a);
    double slope[INFER_NOISES],
        information[INFER_NOISES * INFER_NOISES], *const size[INFER_NOISES] = {&fit.noise.white,
                                                                               &fit.noise.depth,
                                                                               &fit.noise.clock,
                                                                               &fit.noise.slow[0],
                                                                               &fit.noise.slow[1],
                                                                               &fit.noise.slow[2],
                                                                               &fit.noise.slow[3],
                                                                               &fit.noise.encoder};
    ck_assert_int_eq(infer_fit_products(&fit, &data), PALP_OK);
    ck_assert_int_eq(infer_posterior_find(&fit, &data, &p), PALP_OK);
    ck_assert_int_eq(infer_noise_slopes(&fit, &data, &p, slope, information), PALP_OK);
    infer_posterior_free(&p);
    for (int a = 0; a < INFER_NOISES; a++) {
        const double h = 3e-4, up = promised_with(&fit, &data, size[a], exp(h)),
                     down = promised_with(&fit, &data, size[a], exp(-h));
        ck_assert_double_eq_tol(slope[a], (up - down) / (2 * h), (with ? 0.05 : 1e-5) * fabs(slope[a]));
        ck_assert_double_gt(information[a * (INFER_NOISES + 1)], 0);
    }
    end(&data, &fit);
    runs = 2;
}
END_TEST

/* Twice or half of a learned size is less likely. One that goes to 0 does so slowly: a fifth of a nat is
 * left. */
START_TEST(learned_sizes_are_the_most_likely) {
    explain_data data;
    infer_fit fit, moved;
    palp_model m;
    begin(&data, &fit, &m);
    for (size_t r = 0; r < data.n_runs; r++) /* zeros that differ, by a size that stays */
        for (size_t i = 0; i < data.run[r].n; i++)
            data.run[r].force[i] += 5 * NOISE * ((double)r - 0.5);
    ck_assert_int_eq(infer_fit_evaluate(&fit, &data), PALP_OK);
    ck_assert_int_eq(infer_fit_settle(&fit, &data, 3, false), PALP_OK);
    ck_assert_int_eq(infer_sizes_learn(&fit, &data, 60), PALP_OK);
    const size_t n = sizeof fit.sizes / sizeof(double);
    size_t tried = 0;
    for (size_t a = 0; a < n; a++)
        for (int up = 0; up < 2; up++) {
            ck_assert_int_eq(infer_fit_copy(&fit, &data, &moved), PALP_OK);
            double *size = (double *)&moved.sizes + a;
            tried += *size > 0;
            *size *= up ? 2 : 0.5;
            if (a == INFER_SINE || a == INFER_COSINE)
                *size = 0;
            ck_assert_int_eq(infer_fit_score(&moved, &data), PALP_OK);
            ck_assert_msg(moved.promised <= fit.promised + 0.2, "size %zu of %g: %g more", a, *size,
                          moved.promised - fit.promised);
            infer_fit_free(&moved);
        }
    ck_assert_uint_ge(tried, 4);
    end(&data, &fit);
}
END_TEST

void tests(TCase *tc) {
    tcase_add_loop_test(tc, the_evidence_is_the_joint_normal_density, 2, MOST + 1);
    tcase_add_loop_test(tc, it_is_so_too_where_contacts_average_nothing, 2, MOST + 1);
    tcase_add_test(tc, forces_alone_have_the_same_products);
    tcase_add_test(tc, a_discrepancy_follows_straight_lines);
    tcase_add_loop_test(tc, the_mean_alone_is_the_same, 0, 2);
    tcase_add_test(tc, what_is_held_is_where_the_columns_are);
    tcase_add_test(tc, contacts_average_nothing);
    tcase_add_loop_test(tc, a_specimen_has_the_column_of_its_factor, 0, INFER_SPECIMEN);
    tcase_add_test(tc, the_noise_is_white_after_the_filter);
    tcase_add_test(tc, the_bound_of_a_tail_is_students_density);
    tcase_add_test(tc, steps_are_read_off_the_files);
    tcase_add_test(tc, a_lone_sample_far_off_changes_little);
    tcase_add_test(tc, a_step_is_one_innovation);
    tcase_add_loop_test(tc, the_slopes_of_the_noise_are_those_of_the_evidence, 0, 8);
    tcase_add_test(tc, learned_sizes_are_the_most_likely);
}
