/* explain_before.c: what is left without what a search has found: without the effects, or with one contact or
 * one gain for all runs. */
#include "explain_result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static palp_status refit(const explain_data *data, explain_fit *fit, double *residual) {
    palp_status status = explain_fit_products(fit, data, NULL);
    if (!status)
        status = explain_fit_improve(fit, data, fit->model.kind == PALP_MODEL_NETWORK ? 4 : 20);
    return status ? status : explain_fit_evaluate(fit, data, NULL, residual);
}

palp_status explain_before_find(const explain_search *s, explain_fit *base, palp_explanation *e) {
    const explain_scatter none = explain_no_scatter(&s->data);
    base->spread = s->settings;
    double *residual = malloc(s->data.n * sizeof *residual);
    palp_status status = residual ? PALP_OK : PALP_ERR_NO_MEMORY;
    base->scatter = none;
    memset(base->contact, 0,
           s->data.n_runs * sizeof *base->contact); /* every surface where the model has it */
    if (!status)
        status = refit(&s->data, base, residual);
    if (!status) {
        explain_keep_residual(residual, e, true);
        e->gap.before_N = explain_fitted_rms(&s->data, residual);
        status = explain_held_out(s, base, &e->gap.heldout_before_N);
    }
    free(residual);
    return status;
}

/* Of the runs' own zeros, contacts or gains about their mean. */
static double own_sd(const explain_search *s, int which) {
    double sum = 0.0, square = 0.0, n = 0.0, own[EXPLAIN_NUISANCES], sd[EXPLAIN_NUISANCES];
    for (size_t r = 0; r < s->data.n_runs; r++) {
        if (s->data.run[r].held_out)
            continue;
        explain_nuisances(&s->fit, r, own, sd);
        n += 1.0;
        square += (n - 1.0) / n * pow(own[which] - sum / fmax(n - 1.0, 1.0), 2.0);
        sum += own[which];
    }
    return sqrt(square / fmax(n - 1.0, 1.0));
}

/* The fit at hand with no zero, contact or gain of the runs' own. */
static palp_status in_common(const explain_search *s, int which, palp_explain_scatter *out) {
    explain_fit fit = {.n_columns = 0};
    const explain_scatter *now = &s->fit.scatter, hidden = explain_hidden_scatter(&s->data),
                          none = explain_no_scatter(&s->data);
    const double prior[3] = {now->zero, now->contact, now->gain},
                 noise[3] = {hidden.zero, hidden.contact, hidden.gain};
    const double left = explain_fitted_rms(&s->data, s->residual);
    const double apart = own_sd(s, which);
    *out = (palp_explain_scatter){.sd = which ? prior[which] : apart, .without_N = left};
    if (which == 1 && s->settings->contact != PALP_CONTACT_FREE)
        out->sd = 0.0;
    if (!(prior[which] > noise[which] && apart > noise[which]))
        return PALP_OK;
    double *residual = malloc(s->data.n * sizeof *residual);
    palp_status status = residual ? explain_fit_copy(&s->fit, s->data.n_runs, &fit) : PALP_ERR_NO_MEMORY;
    fit.spread = s->settings;
    *(which == 0   ? &fit.scatter.zero
      : which == 1 ? &fit.scatter.contact
                   : &fit.scatter.gain) = which == 0   ? none.zero
                                          : which == 1 ? none.contact
                                                       : none.gain;
    if (!status && which == 1)
        memset(fit.contact, 0, s->data.n_runs * sizeof *fit.contact);
    if (!status)
        status = refit(&s->data, &fit, residual);
    if (!status) {
        out->without_N = explain_fitted_rms(&s->data, residual);
        out->evidence = explain_fit_score(&s->fit, &s->data) - fit.score;
        out->found = out->evidence > EXPLAIN_CLEAR && out->without_N > left;
    }
    explain_fit_free(&fit);
    free(residual);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

palp_status explain_scatter_find(const explain_search *s, palp_explanation *e) {
    palp_explain_scatter *out[3] = {&e->zero, &e->contact, &e->gain};
    palp_status status = PALP_OK;
    for (int i = 0; i < 3 && !status && s->data.n_runs > 1; i++)
        status = in_common(s, i, out[i]);
    return status;
}
