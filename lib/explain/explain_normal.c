/* explain_normal.c: what the sums of a fit say once every run's nuisance parameters are eliminated. */
#include "explain_fit.h"
#include "base/dense.h"
#include "model/model_internal.h"

#include <math.h>
#include <string.h>

static void nuisance_sd(const explain_fit *fit, double sd[EXPLAIN_NUISANCES]) {
    const explain_scatter *s = &fit->scatter;
    double share = 1.0 / fmax(1.0, s->misfit);
    double all[EXPLAIN_NUISANCES] = {share * s->zero, share * s->contact, share * s->gain, fit->hum_N, fit->hum_N};
    memcpy(sd, all, sizeof all);
}

/* Factor of 1 + S N'N S. */
static void nuisance_factor(const explain_fit *fit, size_t r, const double *sd, double *factor) {
    const double *g = fit->product + r * fit->m * fit->m;
    size_t k = fit->n_columns;
    for (size_t i = 0; i < EXPLAIN_NUISANCES; i++)
        for (size_t j = 0; j < EXPLAIN_NUISANCES; j++)
            factor[i * EXPLAIN_NUISANCES + j] = (i == j) + sd[i] * g[(k + i) * fit->m + k + j] * sd[j];
    dense_cholesky(EXPLAIN_NUISANCES, factor);
}

void explain_normal_of(const explain_fit *fit, size_t r, double *h, double *g, double *chi2, double *logdet) {
    enum { Q = EXPLAIN_NUISANCES };
    const double *product = fit->product + r * fit->m * fit->m;
    size_t k = fit->n_columns, m = fit->m, first = h ? 0 : k;
    double sd[Q], factor[Q * Q], z[EXPLAIN_COLUMNS + 1][Q];
    nuisance_sd(fit, sd);
    nuisance_factor(fit, r, sd, factor);
    *logdet = dense_log_determinant(Q, factor);
    for (size_t c = first; c <= k; c++) { /* factor^-1 S N' of each column, the last: y */
        size_t at = c < k ? c : m - 1;
        for (size_t i = 0; i < Q; i++)
            z[c][i] = sd[i] * product[at * m + k + i];
    }
    dense_forward(Q, factor, k + 1 - first, z[first]);
    *chi2 = product[(m - 1) * m + m - 1];
    for (size_t i = 0; i < Q; i++)
        *chi2 -= z[k][i] * z[k][i];
    for (size_t a = 0; h && a < k; a++) {
        g[a] = product[a * m + m - 1];
        for (size_t i = 0; i < Q; i++)
            g[a] -= z[a][i] * z[k][i];
        for (size_t b = 0; b <= a; b++) {
            double sum = product[a * m + b];
            for (size_t i = 0; i < Q; i++)
                sum -= z[a][i] * z[b][i];
            h[a * k + b] = h[b * k + a] = sum;
        }
    }
}

void explain_nuisances(const explain_fit *fit, size_t r, double own[EXPLAIN_NUISANCES], double sd_out[EXPLAIN_NUISANCES]) {
    enum { Q = EXPLAIN_NUISANCES };
    double sd[Q], factor[Q * Q];
    const double *product = fit->product + r * fit->m * fit->m;
    nuisance_sd(fit, sd);
    nuisance_factor(fit, r, sd, factor);
    for (size_t i = 0; i < Q; i++)
        own[i] = sd[i] * product[(fit->m - 1) * fit->m + fit->n_columns + i];
    dense_cholesky_solve(Q, factor, 1, own);
    for (size_t i = 0; i < Q; i++) {
        double unit[Q] = {0};
        unit[i] = 1.0;
        dense_cholesky_solve(Q, factor, 1, unit);
        own[i] *= sd[i];
        sd_out[i] = sd[i] * sqrt(unit[i]);
    }
}

double explain_fit_score(const explain_fit *fit, const explain_data *data) {
    double sum = 0.0;
    for (size_t r = 0; r < data->n_runs; r++) {
        double chi2, logdet;
        if (data->run[r].held_out)
            continue;
        explain_normal_of(fit, r, NULL, NULL, &chi2, &logdet);
        sum -= 0.5 * (chi2 + logdet);
    }
    return sum;
}

double explain_chi2(const explain_data *data, const explain_fit *fit) {
    double sum = 0.0, chi2, logdet;
    for (size_t r = 0; r < data->n_runs; r++) {
        if (data->run[r].held_out)
            continue;
        explain_normal_of(fit, r, NULL, NULL, &chi2, &logdet);
        sum += chi2;
    }
    return sum / (double)explain_samples(data);
}

/* A law that falls below a little of its stiffness before PALP_MODEL_STRAIN makes no model: a wall there, stiff beside
 * any data. */
static void add_wall(const explain_fit *fit, const explain_data *data, double *h, double *g, double *chi2) {
    enum { PLACES = 200 };
    const palp_law *law = &fit->model.material.law;
    double typical = data->peak * data->height / data->deepest, low = 1e-3 * typical, sd = 1e-7 * typical;
    double row[PALP_LAW_MAX], stiffness;
    for (int i = 0; i <= PLACES; i++) {
        double e = fmax(1e-6, PALP_MODEL_STRAIN * i / PLACES);
        palp_law_stiffness(law, e, &stiffness, NULL);
        if (!(stiffness < low))
            continue;
        palp_law_gradient(law, e, row);
        *chi2 += pow((low - stiffness) / sd, 2);
        for (size_t a = 0; a < law->n; a++) {
            g[a] += (low - stiffness) / sd * row[a] / e / sd;
            for (size_t b = 0; b < law->n; b++)
                h[a * fit->n_columns + b] += row[a] / e / sd * row[b] / e / sd;
        }
    }
}

void explain_fit_total(const explain_fit *fit, const explain_data *data, double *h, double *g, double *chi2,
                       double *work) {
    size_t k = fit->n_columns;
    memset(h, 0, k * k * sizeof *h);
    memset(g, 0, k * sizeof *g);
    *chi2 = 0.0;
    for (size_t r = 0; r < data->n_runs; r++) {
        double own, logdet;
        if (data->run[r].held_out)
            continue;
        explain_normal_of(fit, r, work, work + k * k, &own, &logdet);
        for (size_t i = 0; i < k * k; i++)
            h[i] += work[i];
        for (size_t i = 0; i < k; i++)
            g[i] += work[k * k + i];
        *chi2 += own;
    }
    for (size_t i = 0; i < k; i++)
        h[i * k + i] += 1.0 / (fit->unit[i] * fit->unit[i]);
    add_wall(fit, data, h, g, chi2);
}

/* Never far beyond the expectation, or of gain what replicates show: a model's own faults are not scatter. */
void explain_fit_scatter(explain_fit *fit, const explain_data *data, const palp_explain_settings *settings) {
    enum { TRUST = 6, ROUNDS = 20 }; /* the expectation counts as so many runs */
    double white = 0.0;
    for (size_t r = 0; r < data->n_runs; r++)
        white += data->run[r].white / (double)data->n_runs;
    double expected[3] = {0.3 * white, settings->contact_scatter_m, settings->repeatability};
    double most[3] = {fmax(2.0 * expected[0], 1.5 * data->zero_scatter), 2.0 * expected[1],
                      fmax(2.0 * expected[2], 1.5 * data->replicate_gain)};
    double *scatter[3] = {&fit->scatter.zero, &fit->scatter.contact, &fit->scatter.gain};
    for (int i = 0; i < 3; i++)
        *scatter[i] = *scatter[i] > 0.0 ? *scatter[i] : expected[i];
    for (int round = 0; round < ROUNDS; round++) {
        double sum[3], count = TRUST;
        for (int i = 0; i < 3; i++)
            sum[i] = TRUST * expected[i] * expected[i];
        for (size_t r = 0; r < data->n_runs; r++) {
            double own[EXPLAIN_NUISANCES], sd[EXPLAIN_NUISANCES];
            if (data->run[r].held_out)
                continue;
            explain_nuisances(fit, r, own, sd);
            count += 1.0;
            for (int i = 0; i < 3; i++)
                sum[i] += own[i] * own[i] + sd[i] * sd[i];
        }
        for (int i = 0; i < 3; i++)
            *scatter[i] = fmin(sqrt(sum[i] / count), most[i]);
        fit->scatter.misfit = sqrt(fmax(1.0, explain_chi2(data, fit)));
    }
    fit->score = explain_fit_score(fit, data);
    for (int i = 0; i < 3; i++) { /* what scatter beyond the expected costs */
        double ratio = expected[i] / *scatter[i];
        fit->score -= 0.5 * TRUST * (ratio * ratio - 1.0 - 2.0 * log(ratio));
    }
}
