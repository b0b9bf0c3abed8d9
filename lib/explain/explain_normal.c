/* explain_normal.c: what the sums of a fit say once every run's nuisance parameters are eliminated. */
#include "explain_fit.h"
#include "base/dense.h"

#include <math.h>
#include <string.h>

static void nuisance_sd(const explain_fit *fit, double sd[EXPLAIN_NUISANCES]) {
    const explain_scatter *s = &fit->scatter;
    double all[EXPLAIN_NUISANCES] = {s->zero, s->contact, s->gain, fit->hum_N, fit->hum_N, s->stiffness};
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

void explain_nuisances(const explain_fit *fit, size_t r, double own[EXPLAIN_NUISANCES],
                       double sd_out[EXPLAIN_NUISANCES]) {
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

void explain_nuisances_for(const explain_fit *fit, size_t r, const double pull[EXPLAIN_NUISANCES],
                           double own[EXPLAIN_NUISANCES]) {
    enum { Q = EXPLAIN_NUISANCES };
    double sd[Q], factor[Q * Q];
    nuisance_sd(fit, sd);
    nuisance_factor(fit, r, sd, factor);
    for (size_t i = 0; i < Q; i++)
        own[i] = sd[i] * pull[i];
    dense_cholesky_solve(Q, factor, 1, own);
    for (size_t i = 0; i < Q; i++)
        own[i] *= sd[i];
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
}

/* What the noise of one sample hides. */
explain_scatter explain_hidden_scatter(const explain_data *data) {
    const double noise = explain_noise_level(data), share = fmin(0.25, noise / data->peak);
    return (explain_scatter){
        .zero = 0.3 * noise, .contact = share * data->deepest, .gain = share, .stiffness = share};
}

explain_scatter explain_no_scatter(const explain_data *data) {
    explain_scatter hidden = explain_hidden_scatter(data);
    double share = 1.0 / sqrt((double)data->n);
    return (explain_scatter){share * hidden.zero, share * hidden.contact, share * hidden.gain,
                             share * hidden.stiffness};
}

enum { SCATTERS = 4 }; /* zero, contact, gain, stiffness */

/* What is expected of each, and as how many runs that counts: what the caller expects as six, what a run's
 * file says and what the noise hides as one. */
static void expect_scatter(const explain_data *data, const palp_explain_settings *settings,
                           double expected[SCATTERS], double trust[SCATTERS], double most[SCATTERS]) {
    const double many = 6.0;
    const explain_scatter hidden = explain_hidden_scatter(data);
    const double noise[SCATTERS] = {hidden.zero, hidden.contact, hidden.gain, hidden.stiffness};
    const double told[SCATTERS] = {0.0, settings->contact_scatter_m, settings->repeatability, 0.0};
    const double widest[SCATTERS] = {data->peak, 0.25 * data->deepest, 0.5, 0.5};
    for (int i = 0; i < SCATTERS; i++) {
        expected[i] = told[i] > 0.0 ? told[i] : noise[i];
        trust[i] = told[i] > 0.0 ? many : 1.0;
    }
    if (data->n_contact_told > 0 && !(told[1] > 0.0)) {
        expected[1] = fmax(data->contact_told, noise[1]);
        trust[1] = (double)data->n_contact_told;
    }
    for (int i = 0; i < SCATTERS; i++) {
        most[i] = widest[i];
        expected[i] = fmin(expected[i], widest[i]);
    }
    if (settings->contact != PALP_CONTACT_FREE) /* no run has one of its own */
        expected[1] = most[1] = explain_no_scatter(data).contact;
}

/* From the runs' nuisance parameters, whatever their size; that of the stiffness only where the specimens
 * have laws of their own. */
void explain_fit_scatter(explain_fit *fit, const explain_data *data, const palp_explain_settings *settings) {
    enum { ROUNDS = 400 };
    static const size_t nuisance[SCATTERS] = {0, 1, 2, 5};
    const int n = fit->scatter.stiffness > 0.0 ? SCATTERS : SCATTERS - 1;
    double moved = 1.0;
    double expected[SCATTERS], trust[SCATTERS], most[SCATTERS];
    double *scatter[SCATTERS] = {&fit->scatter.zero, &fit->scatter.contact, &fit->scatter.gain,
                                 &fit->scatter.stiffness};
    const double start[SCATTERS] = {0.01 * data->peak, 0.05 * data->deepest, 0.02, 0.02};
    expect_scatter(data, settings, expected, trust, most);
    for (int i = 0; i < n; i++)
        *scatter[i] = *scatter[i] > 0.0 ? *scatter[i] : fmin(most[i], fmax(start[i], expected[i]));
    for (int round = 0; round < ROUNDS && moved > 1e-4; round++) {
        double sum[SCATTERS], count = 0.0;
        for (int i = 0; i < n; i++)
            sum[i] = trust[i] * expected[i] * expected[i];
        for (size_t r = 0; r < data->n_runs; r++) {
            double own[EXPLAIN_NUISANCES], sd[EXPLAIN_NUISANCES];
            if (data->run[r].held_out)
                continue;
            explain_nuisances(fit, r, own, sd);
            count += 1.0;
            for (int i = 0; i < n; i++)
                sum[i] += own[nuisance[i]] * own[nuisance[i]] + sd[nuisance[i]] * sd[nuisance[i]];
        }
        moved = 0.0;
        for (int i = 0; i < n; i++) {
            double was = *scatter[i];
            *scatter[i] = fmin(sqrt(sum[i] / (count + trust[i])), most[i]);
            moved = fmax(moved, fabs(*scatter[i] / was - 1.0));
        }
    }
    fit->score = explain_fit_score(fit, data);
    for (int i = 0; i < n; i++) { /* what scatter beyond the expected costs */
        double ratio = expected[i] / *scatter[i];
        fit->score -= 0.5 * trust[i] * (ratio * ratio - 1.0 - 2.0 * log(ratio));
    }
}

double explain_students_gain(double gain, size_t n, double trust, double known) {
    const double own = (double)n - 1.0, share = own / (own + known), freedom = (own + known) / share;
    const double wallace = (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0),
                 square = expm1(2.0 * gain / ((double)n + trust));
    return n > 1 ? fmin(gain, 0.5 * wallace * wallace * freedom * log1p(share * square)) : fmin(gain, 0.0);
}

double explain_gain_of_mean(const explain_fit *fit, const explain_data *data,
                            const palp_explain_settings *settings, const effect_row *row, double gain) {
    const int i = row->info.place == PALP_EFFECT_CONTACT ? 1 : row->as_scatter ? 2 : 0;
    const double scatter[] = {fit->scatter.zero, fit->scatter.contact, fit->scatter.gain};
    const double n = (double)explain_fitted_runs(data);
    double expected[SCATTERS], trust[SCATTERS], most[SCATTERS];
    expect_scatter(data, settings, expected, trust, most);
    if (!(most[i] > expected[i])) /* no run has one of its own */
        return gain;
    const double told = trust[i] * expected[i] * expected[i],
                 own = (n + trust[i]) * scatter[i] * scatter[i] - told;
    return explain_students_gain(gain, explain_fitted_runs(data), trust[i],
                                 told * (n - 1.0) / fmax(own, 1e-3 * told));
}
