/* explain_specimens.c: where the files name several specimens, a stiffness of each as a candidate: what the
 * runs have of their own is the specimens' if it is alike in the runs of one. */
#include "explain_result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WHOLE = 2, LAW = 5 }; /* nuisance parameters: of all the force, of the law beside the arms */

/* ---- between specimens, or between runs ---- */

/* Log likelihood of the runs' own values, if specimens differ by an sd and the runs of one by another. */
static double likelihood(const explain_data *data, const double *own, const double *sd, double between,
                         double within) {
    double sum = 0.0;
    for (size_t from = 0, to = 0; from < data->n_runs; from = to) {
        double weights = 0.0, weighted = 0.0;
        for (; to < data->n_runs && data->run[to].specimen == data->run[from].specimen; to++) {
            if (data->run[to].held_out)
                continue;
            const double variance = sd[to] * sd[to] + within * within;
            weights += 1.0 / variance;
            weighted += own[to] / variance;
            sum -= 0.5 * (own[to] * own[to] / variance + log(variance));
        }
        const double shared = 1.0 + between * between * weights;
        sum += 0.5 * (between * between * weighted * weighted / shared - log(shared));
    }
    return sum;
}

bool explain_of_specimens(const explain_fit *fit, const explain_data *data, size_t q) {
    enum { SIZES = 24 };
    const double doubt = 0.5; /* nats: as where each run has a specimen of its own */
    double *own = malloc(2 * data->n_runs * sizeof *own), *sd = own ? own + data->n_runs : NULL, most = 0.0;
    double by_specimens = -HUGE_VAL, by_runs = -HUGE_VAL;
    for (size_t r = 0; own && r < data->n_runs; r++) {
        double value[EXPLAIN_NUISANCES], wide[EXPLAIN_NUISANCES];
        explain_nuisances(fit, r, value, wide);
        own[r] = value[q];
        sd[r] = wide[q];
        most = fmax(most, fabs(own[r]));
    }
    for (int i = 0; own && i < SIZES * SIZES; i++) {
        const double between = 2.0 * most * pow(0.7, i / SIZES), within = 2.0 * most * pow(0.7, i % SIZES);
        double *best = between > within ? &by_specimens : &by_runs;
        *best = fmax(*best, likelihood(data, own, sd, between, within));
    }
    free(own);
    return data->n_specimens > 1 && by_specimens > by_runs - doubt;
}

/* ---- as a candidate ---- */

palp_status explain_specimens_try(const explain_search *s, double threshold, explain_trial *trial) {
    const double price = 0.5 * log((double)s->data.n); /* of their sd */
    *trial = (explain_trial){.tried = true};
    if (s->data.n_specimens < 2 || s->fit.scatter.stiffness > 0.0)
        return PALP_OK;
    palp_status status = explain_fit_copy(&s->fit, s->data.n_runs, &trial->fit);
    trial->fit.spread = s->settings;
    trial->fit.scatter.stiffness = fmax(trial->fit.scatter.gain, explain_hidden_scatter(&s->data).stiffness);
    if (!status) {
        explain_fit_scatter(&trial->fit, &s->data, s->settings);
        status = explain_fit_settle(&trial->fit, &s->data, s->settings);
    }
    if (!status)
        status = explain_trial_examine(s, PALP_EFFECT_COUNT, trial);
    trial->gain -= price;
    if (status || !explain_law_believed(s, trial, threshold) ||
        !explain_of_specimens(&trial->fit, &s->data, LAW))
        explain_law_free(trial);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

palp_status explain_specimens_take(explain_search *s, explain_trial *trial) {
    explain_fit_free(&s->fit);
    s->fit = trial->fit;
    trial->fit.product = NULL;
    explain_law_free(trial);
    return explain_refit_anywhere(s);
}

/* ---- the result ---- */

/* The fit at hand with one law for all specimens. */
static palp_status as_one(const explain_search *s, palp_explain_specimens *out) {
    explain_fit fit = {.n_columns = 0};
    double *residual = malloc(s->data.n * sizeof *residual);
    palp_status status = residual ? explain_fit_copy(&s->fit, s->data.n_runs, &fit) : PALP_ERR_NO_MEMORY;
    fit.spread = s->settings;
    fit.scatter.stiffness = 0.0;
    if (!status) {
        explain_fit_scatter(&fit, &s->data, s->settings);
        status = explain_fit_settle(&fit, &s->data, s->settings);
    }
    if (!status)
        status = explain_fit_evaluate(&fit, &s->data, NULL, residual);
    if (!status) {
        out->without_N = explain_fitted_rms(&s->data, residual);
        out->evidence = s->fit.score - fit.score;
        out->found = out->law = out->evidence > EXPLAIN_CLEAR;
    }
    explain_fit_free(&fit);
    free(residual);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

/* Spread between specimens of the law's coefficients and the arms, if all their force differs by a share and
 * the law by another. */
palp_status explain_between_find(const palp_material *material, double whole, double law,
                                 palp_explanation *e) {
    const size_t n = material->law.n + 2 * material->n_arms,
                 step = material->law.kind == PALP_LAW_OGDEN ? 2 : 1;
    double *x = calloc(2 * n, sizeof *x), *y = x ? x + n : NULL, *between = malloc(n * n * sizeof *between);
    if (x && between) {
        for (size_t k = 0; k < material->law.n; k += step) {
            x[k] = whole * material->law.coefficients[k];
            y[k] = law * material->law.coefficients[k];
        }
        for (size_t j = 0; j < material->n_arms; j++) {
            x[material->law.n + 2 * j] = whole * material->arms[j].stiffness_N;
            x[material->law.n + 2 * j + 1] = whole * material->arms[j].viscosity_Ns;
        }
        for (size_t i = 0; i < n; i++)
            for (size_t j = 0; j < n; j++)
                between[i * n + j] = x[i] * x[j] + y[i] * y[j];
        e->specimens.between = between;
    } else
        free(between);
    palp_status status = x && between ? PALP_OK : PALP_ERR_NO_MEMORY;
    free(x);
    return status;
}

/* Each run has what all runs of its specimen have on average. */
static void find_stiffnesses(const explain_search *s, bool whole, bool law, palp_explanation *e) {
    for (size_t from = 0, to = 0; from < s->data.n_runs; from = to) {
        double sum[2] = {0.0, 0.0}, count = 0.0;
        for (; to < s->data.n_runs && s->data.run[to].specimen == s->data.run[from].specimen; to++) {
            double own[EXPLAIN_NUISANCES], sd[EXPLAIN_NUISANCES];
            explain_nuisances(&s->fit, to, own, sd);
            sum[0] += own[WHOLE];
            sum[1] += own[LAW];
            count += 1.0;
        }
        for (size_t r = from; r < to; r++)
            e->run[r].stiffness =
                (1.0 + (whole ? sum[0] / count : 0.0)) * (1.0 + (law ? sum[1] / count : 0.0));
    }
}

palp_status explain_specimens_find(const explain_search *s, palp_explanation *e) {
    palp_explain_specimens *out = &e->specimens;
    palp_status status = PALP_OK;
    *out = (palp_explain_specimens){.n = s->data.n_specimens,
                                    .without_N = explain_fitted_rms(&s->data, s->residual)};
    if (s->fit.scatter.stiffness > 0.0)
        status = as_one(s, out);
    const bool whole = e->gain.found && explain_of_specimens(&s->fit, &s->data, WHOLE);
    if (whole) { /* no gain of the sensor */
        e->gain.found = false;
        out->found = true;
        out->without_N = fmax(out->without_N, e->gain.without_N);
        out->evidence = fmax(out->evidence, e->gain.evidence);
    }
    const double sd[2] = {whole ? s->fit.scatter.gain : 0.0, out->law ? s->fit.scatter.stiffness : 0.0};
    out->sd = hypot(sd[0], sd[1]);
    find_stiffnesses(s, whole, out->law, e);
    return status || !out->found ? status : explain_between_find(&s->fit.model.material, sd[0], sd[1], e);
}
