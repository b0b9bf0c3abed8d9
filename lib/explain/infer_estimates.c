/* infer_estimates.c: the posterior of a material, its runs and its specimens, in the caller's form. */
#include "base/dense.h"
#include "base/file.h"
#include "base/statistics.h"
#include "infer_search.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- parameters ---- */

static double time_of(const palp_arm *arm) {
    return arm->viscosity_Ns / arm->stiffness_N;
}

/* Arms by rising time; order[n_arms]: where each stood. */
static void sort_arms(palp_material *m, size_t order[PALP_ARMS_MAX]) {
    for (size_t j = 0; j < m->n_arms; j++) {
        const palp_arm arm = m->arms[j];
        size_t k = j;
        for (; k > 0 && time_of(&m->arms[k - 1]) > time_of(&arm); k--) {
            m->arms[k] = m->arms[k - 1];
            order[k] = order[k - 1];
        }
        m->arms[k] = arm;
        order[k] = j;
    }
}

/* Derivatives by the coordinates of an estimate, or of its logarithm: springs, then K_j, b_j, tau_j; b_j =
 * K_j tau_j. order: of the arms among the coordinates. */
static double part(size_t springs, const size_t *order, size_t estimate, size_t coordinate) {
    if (estimate < springs)
        return estimate == coordinate;
    const size_t first = springs + 2 * order[(estimate - springs) / 3], what = (estimate - springs) % 3;
    return (coordinate == first && what < 2) || (coordinate == first + 1 && what > 0);
}

static void name_estimate(size_t springs, size_t i, palp_estimate *e) {
    static const char *const letter[3] = {"K", "b", "tau"}, *const unit[3] = {"N", "N s", "s"};
    if (i < springs) {
        snprintf(e->name, sizeof e->name, "c%zu", i);
        e->unit = "N";
        return;
    }
    snprintf(e->name, sizeof e->name, "%s_%zu", letter[(i - springs) % 3], 1 + (i - springs) / 3);
    e->unit = unit[(i - springs) % 3];
}

/* at: its coordinate, or the logarithm of it, and the sd of that. Units of hyperelastic laws are not N. */
static void fill_estimate(const palp_material *m, size_t i, double at, double sd, bool logarithmic,
                          palp_estimate *e) {
    name_estimate(m->law.n, i, e);
    if (i < m->law.n && m->law.kind >= PALP_LAW_NEO_HOOKEAN)
        e->unit = m->law.kind == PALP_LAW_OGDEN && i % 2 ? "" : "Pa";
    e->value = logarithmic ? exp(at) : at;
    e->sd = logarithmic ? e->value * sd : sd;
    e->low = logarithmic ? e->value * exp(-1.96 * sd) : at - 1.96 * sd;
    e->high = logarithmic ? e->value * exp(1.96 * sd) : at + 1.96 * sd;
    e->determined = logarithmic ? e->high < 10.0 * e->low : e->low > 0.0 || e->high < 0.0;
}

/* Index of an estimate among the parameters, which have no times; n: it is a time. */
static size_t parameter_of(size_t springs, size_t i, size_t n) {
    const size_t arm = i < springs ? 0 : (i - springs) / 3, what = i < springs ? 0 : (i - springs) % 3;
    return what < 2 ? i - arm : n;
}

static palp_status reserve(const palp_material *m, palp_lumped_fit *out) {
    out->n_estimates = m->law.n + 3 * m->n_arms;
    out->n_parameters = m->law.n + 2 * m->n_arms;
    out->estimate = calloc(out->n_estimates, sizeof *out->estimate);
    out->correlation = calloc(out->n_estimates * out->n_estimates, sizeof *out->correlation);
    out->covariance = calloc(out->n_parameters * out->n_parameters, sizeof *out->covariance);
    return out->estimate && out->correlation && out->covariance ? PALP_OK : PALP_ERR_NO_MEMORY;
}

/* Estimates, their correlation, and the parameters' covariance, all from the posterior's curvature. */
static palp_status fill_estimates(const infer_search *s, const infer_posterior *p, palp_lumped_fit *out) {
    const explain_fit *c = &s->fit.c;
    const palp_material *m = &out->material;
    size_t order[PALP_ARMS_MAX];
    out->material = c->model.material;
    sort_arms(&out->material, order);
    palp_status status = reserve(m, out);
    const size_t springs = m->law.n, n = out->n_estimates;
    double *row = status ? NULL : calloc(n * p->g + n, sizeof *row), *scale = row ? row + n * p->g : NULL;
    if (!row)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n; i++) {
        double at = 0.0;
        for (size_t a = 0; a < s->fit.k; a++) {
            row[i * p->g + p->hats + a] = part(springs, order, i, a) * infer_tail_widening(&s->fit);
            at += part(springs, order, i, a) * c->x[a];
        }
        dense_forward(p->g, p->factor, 1, row + i * p->g);
        const double sd = sqrt(dense_dot(p->g, row + i * p->g, row + i * p->g));
        const bool logarithmic = i >= springs || c->logarithmic[i];
        fill_estimate(m, i, at, sd, logarithmic, &out->estimate[i]);
        scale[i] = logarithmic ? out->estimate[i].value : 1.0;
    }
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            const double both = scale[i] * scale[j] * dense_dot(p->g, row + i * p->g, row + j * p->g);
            const size_t a = parameter_of(springs, i, n), b = parameter_of(springs, j, n);
            out->correlation[i * n + j] = both / (out->estimate[i].sd * out->estimate[j].sd);
            if (a < n && b < n)
                out->covariance[a * out->n_parameters + b] = both;
        }
    free(row);
    return PALP_OK;
}

/* ---- runs ---- */

/* One contact that all runs share, m; 0: it is no parameter. */
static double shared_contact(const infer_search *s) {
    const palp_model *m = &s->fit.c.model;
    for (size_t i = 0; i < m->n_effects && s->settings->contact == PALP_CONTACT_COMMON; i++)
        if (m->effects[i].id == PALP_EFFECT_CONTACT_OFFSET)
            return m->effects[i].value[0];
    return 0.0;
}

/* Residuals and own parameters of the runs, in the order of the inputs; an input that continues another run
 * has none. */
static palp_status fill_runs(infer_search *s, const infer_posterior *p, size_t n,
                             const palp_explain_input *inputs, palp_lumped_fit *out) {
    out->n_runs = n;
    out->contact_m = calloc(n, sizeof *out->contact_m);
    out->contact_sd_m = calloc(n, sizeof *out->contact_sd_m);
    out->rms_N = calloc(n, sizeof *out->rms_N);
    out->absolute_N = calloc(n, sizeof *out->absolute_N);
    if (!out->contact_m || !out->contact_sd_m || !out->rms_N || !out->absolute_N)
        return PALP_ERR_NO_MEMORY;
    double square = 0.0, count = 0.0; /* of the contacts, about where they average 0 */
    palp_status status = infer_residual(&s->fit, &s->data, s->residual, s->discrepancy);
    for (size_t r = 0, at = 0; r < s->data.n_runs && !status; at += s->data.run[r++].n) {
        double own[INFER_BLOCK], covariance[INFER_BLOCK * INFER_BLOCK], squares = 0.0;
        size_t i = 0;
        while (i < n && strncmp(inputs[i].name, s->data.run[r].name, PALP_NAME_MAX - 1) != 0)
            i++;
        if (i == n)
            continue;
        status = infer_own(&s->fit, &s->data, p, r, own, covariance);
        out->contact_m[i] = own[INFER_CONTACT] + shared_contact(s);
        if (s->fit.sizes.own[INFER_CONTACT] > 0.0) /* it has one */
            out->contact_sd_m[i] = sqrt(fmax(0.0, covariance[INFER_CONTACT * (INFER_BLOCK + 1)]));
        square += pow(own[INFER_CONTACT], 2.0) + pow(out->contact_sd_m[i], 2.0);
        count += 1.0;
        for (size_t j = 0; j < s->data.run[r].n; j++) {
            squares += s->residual[at + j] * s->residual[at + j];
            out->absolute_N[i] += fabs(s->residual[at + j]);
        }
        out->rms_N[i] = sqrt(squares / (double)s->data.run[r].n);
    }
    out->contact_scatter_m = sqrt(square / fmax(1.0, count - 1.0));
    out->reduced_chi2 = p->chi2 / (double)explain_samples(&s->data);
    out->inflation = 1.0;
    return status;
}

/* ---- specimens ---- */

/* Each specimen's material and the factor on its law; the mean covariance of their estimates, within[SPECIMEN
 * SPECIMEN]. */
static palp_status fill_each(const infer_search *s, const infer_posterior *p, palp_specimens_fit *out,
                             double *within) {
    enum { S = INFER_SPECIMEN };
    palp_status status = PALP_OK;
    size_t k = 0;
    for (size_t r = 0; r < s->data.n_runs && !status; r++) {
        double own[S], covariance[S * S];
        if (r > 0 && s->data.run[r].specimen == s->data.run[r - 1].specimen)
            continue;
        if (k == out->n_specimens) /* one without a run that presses it */
            break;
        status = infer_specimen_own(p, r, own, NULL);
        infer_specimen_left(p, r, covariance);
        if (!status)
            status = infer_specimen_material(&out->mean.material, own, &out->own[k]);
        for (size_t a = 0; a < S * S && !status; a++)
            within[a] += covariance[a] / (double)out->n_specimens;
        out->factor[k++] = status ? 1.0 : infer_law_factor(own);
    }
    return status;
}

/* The variance of the mean is estimated from few specimens: Student's t. */
static void widen(const infer_search *s, palp_specimens_fit *out) {
    const size_t n = out->mean.n_parameters;
    const double t = statistics_student_widening(out->n_specimens - 1);
    double square[INFER_SPECIMEN * INFER_SPECIMEN];
    infer_specimen_variances(&s->fit.sizes, (t * t - 1.0) / (double)out->n_specimens, square);
    infer_specimen_spread(&out->mean.material, square, n, out->mean.covariance);
    for (size_t i = 0; i < out->mean.n_estimates; i++) {
        palp_estimate *e = &out->mean.estimate[i];
        const size_t at = parameter_of(out->mean.material.law.n, i, n);
        const double more = at < n ? sqrt(out->mean.covariance[at * (n + 1)]) / e->sd : 1.0;
        e->sd *= more;
        e->low += (more - 1.0) * (e->low - e->value);
        e->high += (more - 1.0) * (e->high - e->value);
    }
}

static palp_status fill_specimens(const infer_search *s, const infer_posterior *p, palp_specimens_fit *out) {
    enum { S = INFER_SPECIMEN };
    const size_t n = out->mean.n_parameters, count = s->data.n_specimens;
    palp_explain_specimens found = {.n = 0};
    palp_status status = infer_spread_find(s, &found);
    double within[S * S] = {0.0}, between[S * S];
    out->n_specimens = count;
    out->own = calloc(count, sizeof *out->own);
    out->factor = calloc(count, sizeof *out->factor);
    out->between = calloc(n * n, sizeof *out->between);
    out->within = calloc(n * n, sizeof *out->within);
    if (!status && !(out->own && out->factor && out->between && out->within))
        status = PALP_ERR_NO_MEMORY;
    if (!status)
        status = fill_each(s, p, out, within);
    if (!status && found.found) {
        infer_specimen_variances(&s->fit.sizes, 1.0, between);
        infer_specimen_spread(&out->mean.material, between, n, out->between);
        infer_specimen_spread(&out->mean.material, within, n, out->within);
        widen(s, out);
        out->n_spread = 1;
        out->low = found.low / found.sd;
        out->high = found.high / found.sd;
    }
    return status;
}

palp_status infer_estimates_fill(infer_search *s, size_t n, const palp_explain_input *inputs,
                                 palp_specimens_fit *out) {
    infer_posterior p;
    palp_status status = infer_posterior_find(&s->fit, &s->data, &p);
    if (status)
        return status;
    status = fill_estimates(s, &p, &out->mean);
    if (!status)
        status = fill_runs(s, &p, n, inputs, &out->mean);
    if (!status && s->data.n_specimens > 1)
        status = fill_specimens(s, &p, out);
    infer_posterior_free(&p);
    return status;
}
