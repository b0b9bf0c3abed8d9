/* infer_material.c: a lumped solid from runs: a law, and as many arms as the evidence wants. */
#include <palpate/infer.h>

#include "base/dense.h"
#include "base/file.h"
#include "infer_search.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The added arm, last of the trial's effects, becomes one of the material's. */
static palp_status take_arm(infer_search *s, infer_trial *t) {
    palp_model model = t->fit.c.model;
    const palp_effect *arm = &model.effects[--model.n_effects];
    palp_material *m = &model.material;
    infer_fit next;
    m->arms[m->n_arms++] =
        (palp_arm){.stiffness_N = arm->value[0], .viscosity_Ns = arm->value[0] * arm->value[1]};
    palp_status status = infer_fit_create(&model, &s->data, &t->fit, &next);
    if (status)
        return status;
    status = infer_begin(&next, &s->data);
    if (status) {
        infer_fit_free(&next);
        return status;
    }
    infer_fit_free(&s->fit);
    s->fit = next;
    return PALP_OK;
}

static bool has_arm(const infer_trial *t) {
    const palp_model *m = &t->fit.c.model;
    return m->effects[m->n_effects - 1].value[0] > 0.0;
}

static palp_status find_arms(infer_search *s, size_t least, size_t most) {
    palp_status status = PALP_OK;
    while (!status && s->fit.c.model.material.n_arms < most) {
        infer_trial *arm = &s->trial[PALP_EFFECT_RELAXATION_ARM], *drive = &s->trial[INFER_DRIVE];
        status = infer_try_all(s);
        const bool wanted = s->fit.c.model.material.n_arms < least;
        if (status || !(arm->fit.raw || drive->fit.raw))
            break;
        if (drive->fit.raw && drive->gain > infer_threshold(s->settings) &&
            !(arm->fit.raw && arm->gain > drive->gain)) {
            infer_fit_free(&s->fit);
            s->fit = drive->fit;
            drive->fit.raw = NULL;
            status = infer_fit_settle(&s->fit, &s->data, 2, true);
        } else if (arm->fit.raw && has_arm(arm) && (wanted || arm->gain > infer_threshold(s->settings)))
            status = take_arm(s, arm);
        else
            break;
    }
    return status;
}

/* ---- the result ---- */

/* Of the estimates' logarithms by the coordinates: springs, then K_j, b_j, tau_j; b_j = K_j tau_j. */
static double part(size_t springs, size_t estimate, size_t coordinate) {
    if (estimate < springs)
        return estimate == coordinate;
    const size_t first = springs + 2 * ((estimate - springs) / 3), what = (estimate - springs) % 3;
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

/* Estimates, their correlation, and the parameters' covariance, all from the posterior's curvature. */
static palp_status fill_estimates(const infer_search *s, palp_lumped_fit *out) {
    const palp_material *m = &s->fit.c.model.material;
    const size_t springs = m->law.n, n = springs + 3 * m->n_arms, k = s->fit.k;
    infer_posterior p;
    palp_status status = infer_posterior_find(&s->fit, &s->data, &p);
    if (status)
        return status;
    double *row = calloc(n * p.g, sizeof *row);
    out->n_estimates = n;
    out->n_parameters = springs + 2 * m->n_arms;
    out->estimate = calloc(n, sizeof *out->estimate);
    out->correlation = calloc(n * n, sizeof *out->correlation);
    out->covariance = calloc(out->n_parameters * out->n_parameters, sizeof *out->covariance);
    if (!row || !out->estimate || !out->correlation || !out->covariance)
        status = PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n && !status; i++) {
        double logarithm = 0.0;
        for (size_t a = 0; a < k; a++) {
            row[i * p.g + INFER_HATS + a] = part(springs, i, a);
            logarithm += part(springs, i, a) * s->fit.c.x[a];
        }
        palp_estimate *e = &out->estimate[i];
        dense_forward(p.g, p.factor, 1, row + i * p.g);
        const double sd = sqrt(dense_dot(p.g, row + i * p.g, row + i * p.g));
        name_estimate(springs, i, e);
        e->value = exp(logarithm);
        e->sd = e->value * sd;
        e->low = e->value * exp(-1.96 * sd);
        e->high = e->value * exp(1.96 * sd);
        e->determined = e->high < 10.0 * e->low;
    }
    for (size_t i = 0; i < n && !status; i++)
        for (size_t j = 0; j < n; j++) {
            const double both = out->estimate[i].value * out->estimate[j].value *
                                dense_dot(p.g, row + i * p.g, row + j * p.g);
            const size_t ti = i < springs ? 0 : (i - springs) % 3, tj = j < springs ? 0 : (j - springs) % 3;
            out->correlation[i * n + j] = both / (out->estimate[i].sd * out->estimate[j].sd);
            if (ti < 2 && tj < 2)
                out->covariance[(i - (i < springs ? 0 : (i - springs) / 3)) * out->n_parameters + j -
                                (j < springs ? 0 : (j - springs) / 3)] = both;
        }
    free(row);
    infer_posterior_free(&p);
    return status;
}

/* What the runs leave and have of their own, in the order of the inputs; a part of another one has nothing.
 */
static palp_status fill_runs(infer_search *s, size_t n, const palp_explain_input *inputs,
                             palp_lumped_fit *out) {
    infer_posterior p;
    out->n_runs = n;
    out->contact_m = calloc(n, sizeof *out->contact_m);
    out->contact_sd_m = calloc(n, sizeof *out->contact_sd_m);
    out->rms_N = calloc(n, sizeof *out->rms_N);
    out->absolute_N = calloc(n, sizeof *out->absolute_N);
    if (!out->contact_m || !out->contact_sd_m || !out->rms_N || !out->absolute_N)
        return PALP_ERR_NO_MEMORY;
    palp_status status = infer_residual(&s->fit, &s->data, s->residual, s->discrepancy);
    if (!status)
        status = infer_posterior_find(&s->fit, &s->data, &p);
    if (status)
        return status;
    for (size_t r = 0, at = 0; r < s->data.n_runs && !status; at += s->data.run[r++].n) {
        double own[INFER_BLOCK], covariance[INFER_BLOCK * INFER_BLOCK];
        size_t i = 0;
        while (i < n && strncmp(inputs[i].name, s->data.run[r].name, PALP_NAME_MAX - 1) != 0)
            i++;
        if (i == n)
            continue;
        status = infer_own(&s->fit, &s->data, &p, r, own, covariance);
        out->contact_m[i] = own[INFER_CONTACT];
        out->contact_sd_m[i] = sqrt(covariance[INFER_CONTACT * (INFER_BLOCK + 1)]);
        double squares = 0.0;
        for (size_t j = 0; j < s->data.run[r].n; j++) {
            squares += s->residual[at + j] * s->residual[at + j];
            out->absolute_N[i] += fabs(s->residual[at + j]);
        }
        out->rms_N[i] = sqrt(squares / (double)s->data.run[r].n);
    }
    const double samples = (double)explain_samples(&s->data);
    out->contact_scatter_m = s->fit.sizes.own[INFER_CONTACT];
    out->reduced_chi2 = p.chi2 / samples;
    out->inflation = 1.0;
    infer_posterior_free(&p);
    return status;
}

/* A stiffness that is constant, of the largest force and depth, and no arms. */
static palp_status start(infer_search *s, palp_model *model) {
    const double stiffness = s->data.peak * s->data.height / s->data.deepest;
    model->material.n_arms = 0;
    palp_status status = palp_law_polynomial(1, &stiffness, &model->material.law);
    if (!status)
        status = infer_fit_create(model, &s->data, NULL, &s->fit);
    return status ? status : infer_begin(&s->fit, &s->data);
}

static palp_status characterize(infer_search *s, palp_model *model, size_t n,
                                const palp_explain_input *inputs, size_t least, size_t most,
                                palp_lumped_fit *fit) {
    s->residual = malloc(2 * s->data.n * sizeof *s->residual);
    if (!s->residual)
        return PALP_ERR_NO_MEMORY;
    s->discrepancy = s->residual + s->data.n;
    palp_status status = start(s, model);
    if (!status)
        status = find_arms(s, least, most);
    fit->converged = status != PALP_ERR_STOPPED;
    status = fit->converged ? status : PALP_OK;
    if (!status) /* sizes and noise moved last */
        status = infer_fit_improve(&s->fit, &s->data, INFER_LAST);
    if (!status)
        status = fill_estimates(s, fit);
    if (!status)
        status = fill_runs(s, n, inputs, fit);
    fit->material = s->fit.c.model.material;
    return status;
}

palp_status palp_infer_material(const palp_model *specimen, size_t n, const palp_explain_input *inputs,
                                const palp_explain_settings *settings, size_t least_arms, size_t most_arms,
                                palp_lumped_fit *fit, palp_error *error) {
    if (!specimen || !inputs || !settings || !fit)
        return palp_error_null(error);
    memset(fit, 0, sizeof *fit);
    if (n == 0 || least_arms > most_arms || most_arms > PALP_ARMS_MAX ||
        specimen->n_effects > PALP_EFFECTS_MAX - 3)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "no runs, or more than %d arms", PALP_ARMS_MAX);
    palp_explain_settings arms = *settings;
    memset(arms.candidate, 0, sizeof arms.candidate);
    arms.candidate[PALP_EFFECT_RELAXATION_ARM] = 1;
    palp_model model = *specimen;
    infer_search *s = calloc(1, sizeof *s);
    palp_status status = PALP_ERR_NO_MEMORY;
    if (s)
        status = explain_data_create(n, inputs, &arms, &model, &s->data, error);
    if (!status)
        status = explain_data_one_height(&s->data, error);
    if (!status) {
        s->settings = &arms;
        s->data.model_first = true;
        s->n_given = model.n_effects;
        status = characterize(s, &model, n, inputs, least_arms, most_arms, fit);
        infer_search_free(s);
    }
    if (s)
        explain_data_free(&s->data);
    free(s);
    if (status)
        palp_lumped_fit_free(fit);
    return status == PALP_ERR_NO_MEMORY ? palp_error_set(error, status, "out of memory") : status;
}
