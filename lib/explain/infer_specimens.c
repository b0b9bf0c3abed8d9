/* infer_specimens.c: the scatter of the specimens' stiffnesses, in the caller's form. */
#include "infer_search.h"

#include <math.h>
#include <stdlib.h>

enum { GRID = 120 }; /* sizes of the scatter, uniform in the logarithm */

/* The 2.5 % and 97.5 % points of the posterior of the law's scatter. The factors on all stiffnesses and on
 * the law alone keep their shares of it. Its prior is even in the logarithm, as that of all sizes; with b_s
 * known exactly this is the interval of chi squared. */
static palp_status find_interval(const infer_search *s, palp_explain_specimens *out) {
    infer_fit fit = s->fit; /* its sizes alone change */
    const double least = fit.noise.white / sqrt((double)explain_samples(&s->data)) / s->data.peak;
    const double from = log(least), step = (log(20.0) - from) / GRID;
    double score[GRID + 1], best = -HUGE_VAL, all = 0.0, sum = 0.0;
    for (size_t i = 0; i <= GRID; i++) {
        const double ratio = exp(from + step * (double)i) / out->sd;
        fit.sizes.specimen[INFER_STIFFNESS] = ratio * s->fit.sizes.specimen[INFER_STIFFNESS];
        fit.sizes.specimen[INFER_LAW] = ratio * s->fit.sizes.specimen[INFER_LAW];
        const palp_status status = infer_fit_score(&fit, &s->data);
        if (status)
            return status;
        score[i] = fit.promised;
        best = fmax(best, fit.promised);
    }
    for (size_t i = 0; i <= GRID; i++)
        all += exp(score[i] - best);
    for (size_t i = 0; i <= GRID; i++) { /* each size stands for half a step to either side */
        const double before = sum / all, share = exp(score[i] - best) / all, left = (double)i - 0.5;
        sum += exp(score[i] - best);
        if (before < 0.025 && before + share >= 0.025)
            out->low = exp(from + step * (left + (0.025 - before) / share));
        if (before < 0.975 && before + share >= 0.975)
            out->high = exp(from + step * (left + (0.975 - before) / share));
    }
    return PALP_OK;
}

/* The residual if all specimens are alike, with sizes and noise estimated again. */
static palp_status as_one(const infer_search *s, palp_explain_specimens *out) {
    infer_fit fit;
    palp_status status = infer_fit_copy(&s->fit, &s->data, &fit);
    if (status)
        return status;
    for (size_t i = 0; i < INFER_SPECIMEN * s->data.n_runs; i++)
        fit.specimen[i] = 0.0;
    for (size_t a = 0; a < INFER_SPECIMEN; a++)
        fit.sizes.specimen[a] = 0.0;
    status = infer_fit_evaluate(&fit, &s->data);
    if (!status)
        status = infer_fit_improve(&fit, &s->data, 5);
    if (!status)
        status = infer_sizes_learn(&fit, &s->data, 6);
    if (!status)
        status = infer_noise_learn(&fit, &s->data, 15, true);
    if (!status)
        status = infer_residual(&fit, &s->data, s->residual, s->discrepancy);
    out->without_N = explain_fitted_rms(&s->data, s->residual);
    out->evidence = s->fit.score - fit.score;
    infer_fit_free(&fit);
    return status ? status : infer_residual(&s->fit, &s->data, s->residual, s->discrepancy);
}

palp_status infer_spread_find(const infer_search *s, palp_explain_specimens *out) {
    palp_status status = PALP_OK;
    out->n = s->data.n_specimens;
    out->sd = out->n > 1 ? infer_law_sd(&s->fit.sizes) : 0.0;
    if (out->sd > 0.0)
        status = find_interval(s, out);
    if (!status && out->sd > 0.0)
        status = as_one(s, out);
    out->found = out->evidence > infer_threshold(s->settings);
    out->law = s->fit.sizes.specimen[INFER_LAW] > s->fit.sizes.specimen[INFER_STIFFNESS];
    return status;
}

/* Covariance between specimens of the law's coefficients and the arms. */
static palp_status find_between(const infer_fit *fit, double **between) {
    const palp_material *material = &fit->c.model.material;
    const size_t n = material->law.n + 2 * material->n_arms;
    double square[INFER_SPECIMEN * INFER_SPECIMEN];
    *between = calloc(n * n, sizeof **between);
    if (!*between)
        return PALP_ERR_NO_MEMORY;
    infer_specimen_variances(&fit->sizes, 1.0, square);
    infer_specimen_spread(material, square, n, *between);
    return PALP_OK;
}

palp_status infer_specimens_find(const infer_search *s, palp_explanation *e) {
    palp_explain_specimens *out = &e->specimens;
    infer_posterior p = {.memory = NULL};
    palp_status status = infer_spread_find(s, out);
    if (status || out->n < 2)
        return status;
    status = infer_posterior_find(&s->fit, &s->data, &p);
    for (size_t r = 0; r < s->data.n_runs && !status; r++) {
        double own[INFER_SPECIMEN];
        status = infer_specimen_own(&p, r, own, NULL);
        if (!status)
            e->run[r].stiffness = infer_law_factor(own);
    }
    infer_posterior_free(&p);
    return status || !out->found ? status : find_between(&s->fit, &out->between);
}
