/* infer_trial.c: what decides about a fit with a further effect: its promise, and how much the runs say of
 * it. */
#include "infer_search.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>

double infer_threshold(const palp_explain_settings *settings) {
    return explain_threshold(settings->false_alarm);
}

double infer_price(const infer_search *s) {
    double n = 0.0;
    for (int i = 0; i < PALP_EFFECT_COUNT; i++)
        n += s->settings->candidate[i] ? 1.0 : 0.0;
    return log(fmax(1.0, n));
}

palp_status infer_learned(infer_fit *fit, const explain_data *data, size_t i, double *learned) {
    const palp_model *m = &fit->c.model;
    const size_t k = fit->k;
    const palp_effect_info *info = palp_effect_look_up(m->effects[i].id);
    size_t at = explain_first_column(m, i);
    for (size_t p = 0; p < info->n_parameters && !info->parameter[p].strength; p++)
        at += p + 1 < info->n_parameters;
    infer_posterior p = {.memory = NULL};
    double log_det, *q = calloc(k * k + k + INFER_HATS, sizeof *q);
    palp_status status = q ? infer_prior(fit, data, q, &log_det) : PALP_ERR_NO_MEMORY;
    if (!status)
        status = infer_posterior_find(fit, data, &p);
    if (!status) {
        double *unit = q + k * k;
        infer_take_scores(fit, &p);
        unit[p.hats + at] = 1.0;
        dense_forward(p.g, p.factor, 1, unit);
        *learned = 1.0 - dense_dot(p.g, unit, unit) * q[at * k + at];
    }
    infer_posterior_free(&p);
    free(q);
    return status;
}

bool infer_is_shown(double share) {
    return share > 0.5;
}

palp_status infer_change(const infer_search *s, const infer_fit *fit, double *rms) {
    const size_t n = s->data.n;
    double *left = malloc(2 * n * sizeof *left);
    palp_status status = left ? infer_residual(fit, &s->data, left, left + n) : PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n && !status; i++)
        left[i] -= s->residual[i];
    *rms = status ? 0.0 : explain_fitted_rms(&s->data, left);
    free(left);
    return status;
}

palp_status infer_approach(const infer_search *s, infer_fit *fit) {
    enum { EVALUATIONS = 3 };
    palp_status status = fit->raw ? infer_fit_improve(fit, &s->data, EVALUATIONS) : PALP_OK;
    if (status)
        infer_fit_free(fit);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

palp_status infer_settle_with_noise(const infer_search *s, size_t rounds, infer_fit *fit) {
    infer_fit before;
    palp_status status = infer_fit_copy(fit, &s->data, &before);
    if (status)
        return status;
    status = infer_fit_settle(fit, &s->data, rounds, true);
    if (status || fit->score < before.score) {
        infer_fit_free(fit);
        *fit = before;
    } else
        infer_fit_free(&before);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}
