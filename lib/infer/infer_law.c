/* infer_law.c: whether the runs ask for a law beyond the family of the given one. */
#include "infer_answer.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The posterior of the law's coordinates, all others integrated out, and the prior's precision. */
typedef struct law_posterior {
    size_t n;
    double mean[PALP_LAW_MAX], precision[PALP_LAW_MAX * PALP_LAW_MAX], prior[PALP_LAW_MAX * PALP_LAW_MAX];
} law_posterior;

static void take_law_block(size_t k, size_t n, const double *from, double *to) {
    for (size_t a = 0; a < n; a++)
        memcpy(to + a * n, from + a * k, n * sizeof *to);
}

/* normal[k k] becomes its Schur complement on the first n. */
static bool eliminate_others(size_t k, size_t n, const double *normal, double *work, double *out) {
    const size_t o = k - n;
    double *others = work, *cross = work + o * o;
    for (size_t a = 0; a < o; a++)
        memcpy(others + a * o, normal + (n + a) * k + n, o * sizeof *others);
    for (size_t b = 0; b < n; b++)
        for (size_t a = 0; a < o; a++)
            cross[b * o + a] = normal[b * k + n + a];
    take_law_block(k, n, normal, out);
    if (o == 0)
        return true;
    if (!dense_cholesky(o, others))
        return false;
    dense_forward(o, others, n, cross);
    for (size_t a = 0; a < n; a++)
        for (size_t b = 0; b < n; b++)
            out[a * n + b] -= dense_dot(o, cross + a * o, cross + b * o);
    return true;
}

static palp_status find_law_posterior(const infer_fit *fit, const explain_data *data, law_posterior *law) {
    const size_t k = fit->k, n = law->n = fit->c.model.material.law.n;
    infer_posterior p;
    double log_det, *q = malloc(2 * k * k * sizeof *q);
    if (!q)
        return PALP_ERR_NO_MEMORY;
    palp_status status = infer_posterior_find(fit, data, &p);
    if (!status)
        status = infer_prior(fit, data, q, &log_det);
    if (!status)
        take_law_block(k, n, q, law->prior);
    if (!status && !eliminate_others(k, n, p.normal, q + k * k, law->precision))
        status = PALP_ERR_SINGULAR;
    for (size_t a = 0; a < n && !status; a++)
        law->mean[a] = fit->c.x[a] + p.mean[INFER_HATS + a];
    infer_posterior_free(&p);
    free(q);
    return status;
}

/* log K of a law at the fit's knots, where it is at least floor; slope[n family->n] by its coefficients. */
static void sample_law(const palp_law *family, const palp_law *knots, double least, double *x,
                       double *slope) {
    const double near = 1e-6 * knots->strain[knots->n - 1];
    for (size_t a = 0; a < knots->n; a++) {
        const double strain = fmax(near, knots->strain[a]);
        double stiffness, row[PALP_LAW_MAX];
        palp_law_stiffness(family, strain, &stiffness, NULL);
        palp_law_gradient(family, strain, row);
        for (size_t c = 0; c < family->n; c++)
            slope[a * family->n + c] = stiffness > least ? row[c] / (strain * stiffness) : 0.0;
        x[a] = log(fmax(least, stiffness));
    }
}

/* m[n n]: normal matrix h[p p] of slope[n p]; off[n]: its gradient g[p]; returns off' m off. */
static double project(size_t n, size_t p, const double *m, const double *slope, const double *off, double *h,
                      double *g) {
    double square = 0.0, turned[PALP_LAW_MAX];
    dense_times(n, n, 1.0, m, off, 0.0, turned);
    for (size_t c = 0; c < p; c++) {
        double by[PALP_LAW_MAX], pulled[PALP_LAW_MAX];
        for (size_t a = 0; a < n; a++)
            by[a] = slope[a * p + c];
        dense_times(n, n, 1.0, m, by, 0.0, pulled);
        g[c] = dense_dot(n, by, turned);
        for (size_t d = 0; d < p; d++) {
            h[c * p + d] = 0.0;
            for (size_t a = 0; a < n; a++)
                h[c * p + d] += pulled[a] * slope[a * p + d];
        }
    }
    for (size_t a = 0; a < n; a++)
        square += off[a] * turned[a];
    return square;
}

/* The square that the nearest law of the family leaves, and the normal matrix of its coefficients there. */
static double find_nearest(const law_posterior *law, const palp_law *knots, double least, palp_law *nearest,
                           double *h) {
    enum { STEPS = 30 };
    const size_t n = law->n, p = nearest->n;
    double x[PALP_LAW_MAX], off[PALP_LAW_MAX], slope[PALP_LAW_MAX * PALP_LAW_MAX], g[PALP_LAW_MAX],
        factor[PALP_LAW_MAX * PALP_LAW_MAX], square = HUGE_VAL, damping = 1e-9;
    palp_law at = *nearest;
    for (int i = 0; i < STEPS; i++) {
        double tried_h[PALP_LAW_MAX * PALP_LAW_MAX], tried_g[PALP_LAW_MAX];
        sample_law(&at, knots, least, x, slope);
        for (size_t a = 0; a < n; a++)
            off[a] = law->mean[a] - x[a];
        const double tried = project(n, p, law->precision, slope, off, tried_h, tried_g);
        if (tried < square) {
            square = tried;
            *nearest = at;
            memcpy(h, tried_h, p * p * sizeof *h);
            memcpy(g, tried_g, p * sizeof *g);
            damping = fmax(1e-9, 0.1 * damping);
        } else
            damping *= 100.0;
        memcpy(factor, h, p * p * sizeof *factor);
        for (size_t c = 0; c < p; c++)
            factor[c * p + c] *= 1.0 + damping;
        if (!dense_cholesky(p, factor))
            break;
        double step[PALP_LAW_MAX];
        memcpy(step, g, p * sizeof *step);
        dense_cholesky_solve(p, factor, 1, step);
        for (size_t c = 0; c < p; c++)
            step[c] += nearest->coefficients[c];
        at = *nearest;
        if (palp_law_set_coefficients(&at, step))
            break;
    }
    return square;
}

static double log_determinant(size_t n, double *a) {
    return dense_cholesky(n, a) ? dense_log_determinant(n, a) : NAN;
}

/* Posterior over prior density on the family's laws, which are a part of all laws (Dickey 1971); Laplace. The
 * given law is the mean of the prior. */
palp_status infer_law_compare(const infer_fit *fit, const explain_data *data, const palp_law *given,
                              palp_law *nearest, double *nats) {
    const palp_law *knots = &fit->c.model.material.law;
    *nearest = *given;
    *nats = 0.0;
    if (given->kind == PALP_LAW_SPLINE || knots->kind != PALP_LAW_SPLINE || given->n >= knots->n)
        return PALP_OK;
    law_posterior *law = calloc(1, sizeof *law);
    palp_status status = law ? find_law_posterior(fit, data, law) : PALP_ERR_NO_MEMORY;
    if (!status) {
        const size_t n = law->n, p = given->n;
        double typical, x[PALP_LAW_MAX], zero[PALP_LAW_MAX] = {0.0}, slope[PALP_LAW_MAX * PALP_LAW_MAX],
                                         g[PALP_LAW_MAX], before[PALP_LAW_MAX * PALP_LAW_MAX],
                                         after[PALP_LAW_MAX * PALP_LAW_MAX];
        palp_law_stiffness(given, knots->strain[n - 1], &typical, NULL);
        const double least = 1e-3 * fabs(typical);
        sample_law(given, knots, least, x, slope);
        project(n, p, law->prior, slope, zero, before, g);
        const double square = find_nearest(law, knots, least, nearest, after);
        *nats = 0.5 * (square + log_determinant(p, after) - log_determinant(p, before) -
                       log_determinant(n, law->precision) + log_determinant(n, law->prior));
        if (!isfinite(*nats)) /* a coefficient that neither prior nor posterior knows */
            *nats = 0.0;
    }
    free(law);
    return status;
}

/* rms that the given law and drive leave beside the same effects. */
static palp_status left_with_given(const infer_search *s, const palp_material *given, const palp_law *nearest,
                                   bool family, double *rms_N) {
    palp_model model = s->fit.c.model;
    infer_fit fit;
    model.material.quasi_linear = given->quasi_linear;
    if (family)
        model.material.law = *nearest; /* a spline follows it */
    double *work = malloc(2 * s->data.n * sizeof *work);
    palp_status status = work ? infer_fit_create(&model, &s->data, &s->fit, &fit) : PALP_ERR_NO_MEMORY;
    if (!status) {
        for (size_t a = 0; a < fit.c.model.material.law.n && family; a++)
            fit.c.low[a] = fit.c.high[a] = fit.c.x[a];
        status = infer_fit_improve(&fit, &s->data, 5);
        if (!status)
            status = infer_residual(&fit, &s->data, work, work + s->data.n);
        if (!status)
            *rms_N = explain_fitted_rms(&s->data, work);
        infer_fit_free(&fit);
    }
    free(work);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

palp_status infer_law_find(const infer_search *s, const palp_model *given, palp_explanation *e) {
    const double threshold = infer_threshold(s->settings);
    const bool driven = s->fit.c.model.material.quasi_linear != given->material.quasi_linear;
    palp_law nearest;
    double nats;
    palp_status status = infer_law_compare(&s->fit, &s->data, &given->material.law, &nearest, &nats);
    if (status)
        return status;
    const bool family = nats > threshold;
    e->law.found = driven || family;
    e->law.without_N = e->gap.after_N;
    e->law.evidence = (driven ? s->drive_gain : 0.0) + (family ? nats : 0.0);
    return e->law.found ? left_with_given(s, &given->material, &nearest, family, &e->law.without_N) : PALP_OK;
}
