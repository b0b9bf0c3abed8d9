/* infer_improve.c: from the current columns to the most probable parameters. */
#include "infer_internal.h"
#include "solve/levenberg.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct improvement {
    infer_fit *fit;
    const explain_data *data;
    double log_noise; /* at the start: so that units do not matter */
    bool best;        /* the last evaluation is the best so far */
} improvement;

/* At the columns at hand. */
static palp_status take_normal(const improvement *i, double *h, double *g, double *chi2) {
    const size_t k = i->fit->k;
    infer_posterior p;
    palp_status status = infer_posterior_find(i->fit, i->data, &p);
    if (status)
        return status;
    memcpy(h, p.normal, k * k * sizeof *h);
    memcpy(g, p.pull, k * sizeof *g);
    *chi2 = p.here + i->fit->log_noise - i->log_noise;
    infer_take_scores(i->fit, &p);
    infer_posterior_free(&p);
    return PALP_OK;
}

static palp_status evaluate(void *user, const double *x, double *h, double *g, double *chi2) {
    improvement *i = user;
    i->best = false;
    memcpy(i->fit->c.x, x, i->fit->k * sizeof *x);
    palp_status status = explain_fit_to_model(&i->fit->c);
    if (!status)
        status = infer_fit_evaluate(i->fit, i->data);
    if (!status)
        status = take_normal(i, h, g, chi2);
    return !status || status == PALP_ERR_NO_MEMORY ? status : PALP_ERR_NOT_CONVERGED;
}

static void keep(void *user) {
    ((improvement *)user)->best = true;
}

/* The noise depends on slopes of the force, by which the gradient does not go. So these stay as they were
 * until the end: least squares with weights that are updated between the fits. A law alone has no
 * discrepancy. Its noise also takes the misfit, and follows the force in every step. */
palp_status infer_fit_improve(infer_fit *fit, const explain_data *data, size_t evaluations) {
    const size_t k = fit->k;
    double *h = malloc((k * k + 2 * k) * sizeof *h), reach[EXPLAIN_COLUMNS], chi2;
    if (!h)
        return PALP_ERR_NO_MEMORY;
    double *g = h + k * k, *x = g + k;
    memcpy(x, fit->c.x, k * sizeof *x);
    palp_status status = infer_fit_products(fit, data);
    improvement i = {.fit = fit, .data = data, .log_noise = fit->log_noise, .best = true};
    if (!status)
        status = take_normal(&i, h, g, &chi2);
    for (size_t a = 0; a < k; a++)
        reach[a] = fit->c.logarithmic[a] ? 1.0 : HUGE_VAL;
    const levenberg problem = {.n = k,
                               .evaluations = evaluations,
                               .low = fit->c.low,
                               .high = fit->c.high,
                               .reach = reach,
                               .stop_absolute = 0.02,
                               .stop_relative = 1e-7,
                               .stop_rise = 1e-3,
                               .stop_expected = 0.02,
                               .evaluate = evaluate,
                               .keep = keep,
                               .user = &i};
    fit->kept_weights = !data->law_alone;
    if (!status)
        status = levenberg_solve(&problem, x, h, g, &chi2);
    if (!status && !i.best)
        status = evaluate(&i, x, h, g, &chi2);
    if (fit->kept_weights) {
        fit->kept_weights = false;
        infer_weigh(fit, data);
        if (!status)
            status = infer_fit_products(fit, data);
        if (!status)
            status = infer_fit_score(fit, data);
    }
    free(h);
    return status ? status : infer_scan_bond(fit, data);
}
