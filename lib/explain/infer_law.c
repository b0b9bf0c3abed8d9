/* infer_law.c: evidence of a law beyond the family of the given one. */
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
        law->mean[a] = fit->c.x[a] + p.mean[p.hats + a];
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

/* The squared distance of the nearest law of the family, and the normal matrix of its coefficients there. */
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

/* The prior of the spline on the laws of a family, linear about one of them: precision m[p p] of the
 * coefficients, and its slope[p] there, as the coefficients differ from its mean. */
static palp_status family_prior(const infer_fit *fit, const explain_data *data, const palp_law *given,
                                double *m, double *pull) {
    const palp_law *knots = &fit->c.model.material.law;
    const size_t k = fit->k, n = knots->n;
    double log_det, typical, x[PALP_LAW_MAX], slope[PALP_LAW_MAX * PALP_LAW_MAX],
        block[PALP_LAW_MAX * PALP_LAW_MAX];
    double *q = malloc(k * k * sizeof *q);
    palp_status status = q ? infer_prior(fit, data, q, &log_det) : PALP_ERR_NO_MEMORY;
    if (!status) {
        take_law_block(k, n, q, block);
        palp_law_stiffness(given, knots->strain[n - 1], &typical, NULL);
        sample_law(given, knots, EXPLAIN_SOFTEST * fabs(typical), x, slope);
        for (size_t a = 0; a < n; a++)
            x[a] -= fit->given[a];
        project(n, given->n, block, slope, x, m, pull);
    }
    free(q);
    return status;
}

/* Posterior over prior density on the family's laws, which are a part of all laws (Dickey 1971); Laplace. The
 * mean of the prior, a constant stiffness, is one of the family. */
palp_status infer_law_compare(const infer_fit *fit, const explain_data *data, const palp_law *given,
                              palp_law *nearest, double *nats) {
    const palp_law *knots = &fit->c.model.material.law;
    *nearest = *given;
    *nats = 0.0;
    if (given->kind == PALP_LAW_SPLINE || knots->kind != PALP_LAW_SPLINE || given->n >= knots->n)
        return PALP_OK;
    law_posterior *law = calloc(1, sizeof *law);
    palp_status status = law ? find_law_posterior(fit, data, law) : PALP_ERR_NO_MEMORY;
    double before[PALP_LAW_MAX * PALP_LAW_MAX], after[PALP_LAW_MAX * PALP_LAW_MAX], pull[PALP_LAW_MAX],
        typical;
    if (!status)
        status = family_prior(fit, data, given, before, pull);
    if (!status) {
        const size_t n = law->n, p = given->n;
        palp_law_stiffness(given, knots->strain[n - 1], &typical, NULL);
        const double square = find_nearest(law, knots, EXPLAIN_SOFTEST * fabs(typical), nearest, after);
        *nats = 0.5 * (square + log_determinant(p, after) - log_determinant(p, before) -
                       log_determinant(n, law->precision) + log_determinant(n, law->prior));
        if (!isfinite(*nats)) /* a coefficient that neither prior nor posterior determines */
            *nats = 0.0;
    }
    free(law);
    return status;
}

/* ---- the family's own fit ---- */

/* The change of the log evidence of a family's fit when the spline's prior takes the place of its wide one:
 * s[p p] is the posterior precision of its coefficients. NAN: that is not definite. */
static palp_status weigh_prior(const infer_fit *spline, const explain_data *data, const palp_law *law,
                               const double *s, double *gain) {
    enum { N = PALP_LAW_MAX };
    const size_t p = law->n;
    double sum[N * N], m[N * N], d[N], by_m[N], by_s[N], copy[N * N];
    palp_status status = family_prior(spline, data, law, m, by_m);
    if (status)
        return status;
    for (size_t a = 0; a < p * p; a++)
        sum[a] = s[a] + m[a];
    memcpy(copy, s, p * p * sizeof *copy);
    memcpy(d, by_m, p * sizeof *d);
    const double log_m = log_determinant(p, m), log_s = log_determinant(p, copy),
                 log_sum = log_determinant(p, sum);
    *gain = 0.5 * (log_m + log_s - log_sum);
    if (!isfinite(*gain))
        return PALP_OK;
    dense_cholesky_solve(p, m, 1, d);
    dense_times(p, p, 1.0, s, d, 0.0, by_s);
    dense_cholesky_solve(p, sum, 1, by_m);
    *gain -= 0.5 * dense_dot(p, by_s, by_m);
    return PALP_OK;
}

/* Log evidence of the family's fit under the prior of the spline's, in place of the wide one. The scale of
 * the bends is the most probable one for the family, as it is for the spline. */
static palp_status weigh_family(const infer_fit *spline, const infer_fit *fit, const explain_data *data,
                                double *score) {
    enum { N = PALP_LAW_MAX, SCALES = 16 }; /* each twice as large as the one before */
    const palp_law *law = &fit->c.model.material.law;
    const size_t k = fit->k, p = law->n;
    double s[N * N], most = NAN, gain = NAN;
    infer_fit prior = *spline;
    infer_posterior posterior = {.memory = NULL};
    double *work = malloc(k * k * sizeof *work);
    palp_status status = work ? infer_posterior_find(fit, data, &posterior) : PALP_ERR_NO_MEMORY;
    if (!status && !eliminate_others(k, p, posterior.normal, work, s))
        status = PALP_ERR_SINGULAR;
    infer_posterior_free(&posterior);
    free(work);
    for (int i = 0; i < SCALES && !status; i++, prior.sizes.bend *= 2.0) {
        status = weigh_prior(&prior, data, law, s, &gain);
        most = fmax(most, gain);
    }
    *score = fit->score + most;
    for (size_t a = 0; a < p; a++)
        *score += log(fit->width[a]);
    return status || isfinite(*score) ? status : PALP_ERR_SINGULAR;
}

/* The current fit with the nearest law of the family and the given drive; its rms residual. */
static palp_status fit_given(const infer_search *s, const palp_material *given, const palp_law *law,
                             infer_fit *fit, double *rms_N) {
    palp_model model = s->fit.c.model;
    model.material.quasi_linear = given->quasi_linear;
    model.material.law = *law;
    double *work = malloc(2 * s->data.n * sizeof *work);
    palp_status status = work ? infer_fit_create_as(&model, &s->data, NULL, fit) : PALP_ERR_NO_MEMORY;
    if (!status) {
        infer_fit_take_state(&s->fit, &s->data, fit);
        status = infer_fit_evaluate(fit, &s->data);
        if (!status)
            status = infer_fit_improve(fit, &s->data, 8);
        if (!status)
            status = infer_fit_converge(fit, &s->data);
        if (!status)
            status = infer_residual(fit, &s->data, work, work + s->data.n);
        if (!status)
            *rms_N = explain_fitted_rms(&s->data, work);
        if (status)
            infer_fit_free(fit);
    }
    free(work);
    return status;
}

/* Evidence of the spline over the family's own fit: a law of the family need not equal the spline at its
 * knots. */
static palp_status compare_fits(const infer_search *s, const palp_material *given, const palp_law *nearest,
                                double *nats, double *rms_N) {
    double score;
    infer_fit fit;
    palp_material driven = *given;
    driven.quasi_linear = s->fit.c.model.material.quasi_linear;
    palp_status status = fit_given(s, &driven, nearest, &fit, rms_N);
    if (status)
        return status;
    status = weigh_family(&s->fit, &fit, &s->data, &score);
    if (!status)
        *nats = s->fit.score - score;
    infer_fit_free(&fit);
    return status;
}

palp_status infer_law_find(const infer_search *s, const palp_model *given, palp_explanation *e) {
    const double threshold = infer_threshold(s->settings);
    const bool driven = s->fit.c.model.material.quasi_linear != given->material.quasi_linear;
    palp_law nearest;
    double nats;
    e->law.without_N = e->gap.after_N;
    palp_status status = infer_law_compare(&s->fit, &s->data, &given->material.law, &nearest, &nats);
    if (!status && nats > threshold)
        status = compare_fits(s, &given->material, &nearest, &nats, &e->law.without_N);
    const bool family = nats > threshold;
    e->law.found = driven || family;
    e->law.evidence = (driven ? s->drive_gain : 0.0) + (family ? nats : 0.0);
    if (!status && driven) {
        infer_fit fit;
        status = fit_given(s, &given->material, family ? &nearest : &s->fit.c.model.material.law, &fit,
                           &e->law.without_N);
        if (!status)
            infer_fit_free(&fit);
    }
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

/* ---- a law for a material ---- */

/* The current fit with another law, converged again. */
static palp_status settle_with(const infer_search *s, const palp_law *law, infer_fit *fit) {
    enum { ROUNDS = 3 };
    palp_model model = s->fit.c.model;
    model.material.law = *law;
    palp_status status = infer_fit_create_as(&model, &s->data, NULL, fit);
    if (status)
        return status;
    infer_fit_take_state(&s->fit, &s->data, fit);
    status = infer_fit_evaluate(fit, &s->data);
    if (!status)
        status = infer_fit_settle(fit, &s->data, ROUNDS, true);
    if (status)
        infer_fit_free(fit);
    return status;
}

/* A law of the same family that is stiff enough: the given one times what it lacks, or a constant. */
static palp_status make_stiff(const explain_fit *fit, const palp_law *given, palp_law *law) {
    const double lowest = palp_law_minimum(given, fit->strain), more = 1.0 + 1e-9;
    double c[PALP_LAW_MAX] = {0.0}, force;
    if (lowest > 0.0)
        return palp_law_scale(given, fmax(1.0, more * fit->softest / lowest), law);
    if (given->kind != PALP_LAW_POLYNOMIAL)
        return PALP_ERR_NOT_CONVERGED;
    palp_law_force(&fit->model.material.law, 1, &fit->strain, &force, NULL, NULL);
    c[0] = fmax(force / fit->strain, more * fit->softest);
    return palp_law_polynomial(given->n, c, law);
}

/* Moves a law towards a stiff one of the same family until it is stiff enough. */
static palp_status stiffen(const explain_fit *fit, const palp_law *given, palp_law *law) {
    enum { HALVES = 20 };
    palp_law stiff;
    if (explain_is_stiff(fit, law))
        return PALP_OK;
    palp_status status = make_stiff(fit, given, &stiff);
    for (int i = 0; i < HALVES && !status && !explain_is_stiff(fit, law); i++) {
        double middle[PALP_LAW_MAX];
        for (size_t c = 0; c < law->n; c++)
            middle[c] = 0.5 * (law->coefficients[c] + stiff.coefficients[c]);
        status = palp_law_set_coefficients(law, middle);
    }
    if (!status && !explain_is_stiff(fit, law))
        *law = stiff;
    return status;
}

/* Log odds of the current fit over the law, nats, and the nearest law of its family. A spline of fewer knots
 * has only its knots given; its values are those of the current spline. */
static palp_status judge(const infer_search *s, const palp_law *law, palp_law *nearest, double *nats) {
    const palp_law *spline = &s->fit.c.model.material.law;
    if (law->kind != PALP_LAW_SPLINE) {
        palp_status status = infer_law_compare(&s->fit, &s->data, law, nearest, nats);
        return status ? status : stiffen(&s->fit.c, law, nearest);
    }
    *nats = 0.0;
    return infer_spline_of(spline, law->n, spline->strain[spline->n - 1], nearest);
}

/* Its own log evidence, with the spline's prior on the family. */
static palp_status weigh(const infer_search *s, const infer_fit *fit, double *score) {
    *score = fit->score;
    return fit->c.model.material.law.kind == PALP_LAW_SPLINE ? PALP_OK
                                                             : weigh_family(&s->fit, fit, &s->data, score);
}

/* The nearest of a family, or no law any more, n 0. */
typedef struct nearest_law {
    palp_law law;
    double nats;
} nearest_law;

static palp_status judge_all(const infer_search *s, const palp_explain_choice *choice, nearest_law *near) {
    palp_status status = PALP_OK;
    for (size_t i = 0; i < choice->n_laws && !status; i++) {
        status = judge(s, &choice->law[i], &near[i].law, &near[i].nats);
        if (status == PALP_ERR_NOT_CONVERGED) { /* no law of this family is stiff enough */
            near[i].law.n = 0;
            status = PALP_OK;
        }
        if (choice->log_odds)
            choice->log_odds[i] = near[i].nats;
    }
    return status;
}

/* The law that is left with the best odds; NULL: there is none. */
static nearest_law *best_left(size_t n, nearest_law *near) {
    nearest_law *best = NULL;
    for (size_t i = 0; i < n; i++)
        if (near[i].law.n > 0 && (!best || near[i].nats < best->nats))
            best = &near[i];
    return best;
}

/* Fits laws, those of the best odds first, until one is less probable than the best so far. */
palp_status infer_law_choose(infer_search *s, const palp_explain_choice *choice) {
    nearest_law *near = calloc(choice->n_laws + 1, sizeof *near), *next;
    infer_fit best = {.raw = NULL}, fit;
    palp_status status = near ? judge_all(s, choice, near) : PALP_ERR_NO_MEMORY, last = PALP_OK;
    double most = s->fit.score, score;
    while (!status && (next = best_left(choice->n_laws, near)) != NULL) {
        last = settle_with(s, &next->law, &fit);
        next->law.n = 0;
        if (last == PALP_ERR_NO_MEMORY)
            status = last;
        if (last)
            continue;
        const bool first = choice->no_spline && !best.raw, known = weigh(s, &fit, &score) == PALP_OK;
        const bool better = first || (known && score > most);
        if (better) {
            most = known ? score : -HUGE_VAL;
            infer_fit_exchange(&best, &fit);
        }
        infer_fit_free(&fit);
        if (!better)
            break;
    }
    if (!status && best.raw)
        infer_fit_exchange(&s->fit, &best);
    else if (!status && choice->no_spline)
        status = last ? last : PALP_ERR_NOT_CONVERGED;
    infer_fit_free(&best);
    free(near);
    return status;
}
