/* explain_interval.c: intervals of the accepted effects' parameters. */
#include "explain_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double EQUATIONS = 0.01; /* of a parameter: what samples of a path and an effect's equations are good for */

/* Student's 97.5 % quantile, to 1 %: Cornish and Fisher, exact below. */
static double student(size_t freedom) {
    static const double few[] = {12.71, 4.303, 3.182, 2.776};
    double f = (double)freedom;
    if (freedom == 0)
        return few[0];
    return freedom <= 4 ? few[freedom - 1] : 1.96 + 2.372 / f + 2.823 / (f * f);
}

/* Squared half width of parameter at's interval: what the noise allows (factor: of the normal matrix) and what the
 * runs, each counted as one, agree on; the wider. unit: [k] work. */
static double square_reach(const explain_fit *fit, const explain_data *data, const double *factor,
                           const double *gradient, size_t at, double inflation, double *unit) {
    size_t k = fit->n_columns, counted = 0;
    double between = 0.0;
    memset(unit, 0, k * sizeof *unit);
    unit[at] = 1.0;
    explain_solve(factor, k, unit);
    for (size_t r = 0; r < data->n_runs; r++) {
        double pull = 0.0;
        if (data->run[r].held)
            continue;
        for (size_t i = 0; i < k; i++)
            pull += unit[i] * gradient[r * k + i];
        between += pull * pull;
        counted++;
    }
    double noise = pow(1.96, 2) * unit[at] * inflation;
    if (counted < 2)
        return noise;
    double n = (double)counted;
    return fmax(noise, pow(student(counted - 1), 2) * between * n / (n - 1.0));
}

palp_status explain_intervals(const explain_fit *fit, const explain_data *data, size_t n_given, double inflation,
                                  palp_explanation *e) {
    size_t k = fit->n_columns;
    double *h = malloc((2 * k + 2 + data->n_runs) * k * sizeof *h), chi2, logdet;
    if (!h)
        return PALP_ERR_NO_MEMORY;
    double *work = h + k * k, *unit = work + k * k + k, *gradient = unit + k;
    explain_fit_total(fit, data, h, unit, &chi2, work);
    for (size_t r = 0; r < data->n_runs; r++)
        explain_normal_of(fit, r, work, gradient + r * k, &chi2, &logdet);
    if (explain_cholesky(h, k)) {
        size_t at = fit->model.material.law.n + 2 * fit->model.material.n_arms;
        for (size_t i = 0; i < fit->model.n_effects; i++)
            for (size_t p = 0; p < palp_effect_look_up(fit->model.effects[i].id)->n_parameters; p++, at++) {
                double reach = sqrt(square_reach(fit, data, h, gradient, at, inflation, unit));
                reach = hypot(reach, EQUATIONS * (fit->logarithmic[at] ? 1.0 : fabs(fit->x[at])));
                double low = fit->x[at] - reach, high = fit->x[at] + reach;
                if (i < n_given)
                    continue;
                if (fit->model.effects[i].id == PALP_EFFECT_ADHESION) { /* read at the releases, not fitted */
                    reach = 3.0 * data->run[0].white + EQUATIONS * fit->x[at];
                    low = fmin(data->pull, fit->x[at]) - reach;
                    high = fmax(data->pull_most, fit->x[at]) + reach;
                }
                e->effect[i - n_given].low[p] = fit->logarithmic[at] ? exp(low) : low;
                e->effect[i - n_given].high[p] = fit->logarithmic[at] ? exp(high) : high;
            }
    }
    free(h);
    return PALP_OK;
}

/* The hum is the model's last effect; its amplitude is the mean of the runs' own. */
void explain_add_hum(const explain_search *s, palp_explanation *e) {
    double square = 0.0;
    if (!(s->fit.hum_Hz > 0.0) || e->model.n_effects == PALP_EFFECTS_MAX)
        return;
    for (size_t r = 0; r < s->data.n_runs; r++) {
        double own[EXPLAIN_NUISANCES], sd[EXPLAIN_NUISANCES];
        explain_own(&s->fit, r, own, sd);
        square += (own[3] * own[3] + own[4] * own[4]) / (double)s->data.n_runs;
    }
    palp_effect hum = {.id = PALP_EFFECT_MAINS_HUM, .value = {sqrt(square), s->fit.hum_Hz}};
    palp_explain_effect *out = &e->effect[e->n_effects - 1];
    double sd = s->data.run[0].white * sqrt(2.0 / (double)s->data.n), width = 0.2 / s->data.duration;
    e->model.effects[e->model.n_effects++] = out->effect = hum;
    out->low[0] = hum.value[0] - 1.96 * sd - 0.02 * hum.value[0];
    out->high[0] = hum.value[0] + 1.96 * sd + 0.02 * hum.value[0];
    out->low[1] = hum.value[1] - width;
    out->high[1] = hum.value[1] + width;
}
