/* infer_material.c: a lumped solid from runs: a law, and as many arms as the evidence wants. */
#include <palpate/explain.h>

#include "base/file.h"
#include "infer_search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The added arm, last of the trial's effects, becomes one of the material's, if the fit with it is so much
 * more probable, nats. */
static palp_status take_arm(infer_search *s, infer_trial *t, double wanted, bool *taken) {
    palp_model model = t->fit.c.model;
    const palp_effect *arm = &model.effects[--model.n_effects];
    palp_material *m = &model.material;
    infer_fit next;
    m->arms[m->n_arms++] =
        (palp_arm){.stiffness_N = arm->value[0], .viscosity_Ns = arm->value[0] * arm->value[1]};
    palp_status status = infer_fit_create(&model, &s->data, &t->fit, &next);
    if (status)
        return status;
    status = infer_begin(&next, &s->data, s->settings);
    *taken = !status && next.score - s->fit.score > wanted;
    if (!*taken) {
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

/* Arms that are driven otherwise, if the fit with them is more probable. */
static palp_status take_drive(infer_search *s, infer_trial *t, bool *taken) {
    palp_status status = infer_fit_settle(&t->fit, &s->data, 2, true);
    *taken = !status && t->fit.score - s->fit.score > infer_threshold(s->settings) + infer_price(s);
    if (*taken)
        infer_fit_exchange(&s->fit, &t->fit);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

static palp_status find_arms(infer_search *s, size_t least, size_t most) {
    const double threshold = infer_threshold(s->settings);
    palp_status status = PALP_OK;
    bool taken = true;
    while (!status && taken && s->fit.c.model.material.n_arms < most) {
        infer_trial *arm = &s->trial[PALP_EFFECT_RELAXATION_ARM], *drive = &s->trial[INFER_DRIVE];
        status = infer_try_all(s);
        const bool wanted = s->fit.c.model.material.n_arms < least;
        taken = false;
        if (!status && drive->fit.raw && drive->gain > threshold &&
            !(arm->fit.raw && arm->gain > drive->gain))
            status = take_drive(s, drive, &taken);
        if (!status && !taken && arm->fit.raw &&
            has_arm(arm)) /* near the fit at hand it may gain too little */
            status = take_arm(s, arm, wanted ? -HUGE_VAL : threshold + infer_price(s), &taken);
    }
    return status;
}

/* A stiffness that is constant, of the largest force and depth, and no arms. */
static palp_status start(infer_search *s, palp_model *model) {
    const double stiffness = s->data.peak * s->data.height / s->data.deepest;
    model->material.n_arms = 0;
    palp_status status = palp_law_polynomial(1, &stiffness, &model->material.law);
    if (!status)
        status = infer_fit_create(model, &s->data, NULL, &s->fit);
    return status ? status : infer_begin(&s->fit, &s->data, s->settings);
}

static palp_status characterize(infer_search *s, palp_model *model, size_t n,
                                const palp_explain_input *inputs, const palp_explain_choice *choice,
                                palp_specimens_fit *fit) {
    s->residual = malloc(2 * s->data.n * sizeof *s->residual);
    if (!s->residual)
        return PALP_ERR_NO_MEMORY;
    s->discrepancy = s->residual + s->data.n;
    palp_status status = start(s, model);
    if (!status)
        status = find_arms(s, choice->least_arms, choice->most_arms);
    fit->mean.converged = status != PALP_ERR_STOPPED;
    status = fit->mean.converged ? status : PALP_OK;
    if (!status)
        status = infer_law_choose(s, choice);
    if (!status) /* sizes and noise moved last */
        status = infer_fit_improve(&s->fit, &s->data, INFER_LAST);
    return status ? status : infer_estimates_fill(s, n, inputs, fit);
}

/* One contact for all runs is an effect, the first of those added. */
static void share_contact(palp_model *model, const palp_explain_settings *settings) {
    if (settings->contact == PALP_CONTACT_COMMON)
        palp_effect_default(PALP_EFFECT_CONTACT_OFFSET, &model->effects[model->n_effects++]);
}

static palp_status check(const palp_model *specimen, size_t n, const palp_explain_choice *choice,
                         palp_error *error) {
    if (n == 0 || choice->least_arms > choice->most_arms || choice->most_arms > PALP_ARMS_MAX ||
        specimen->n_effects > PALP_EFFECTS_MAX - 4)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "no runs, or more than %d arms", PALP_ARMS_MAX);
    if (choice->n_laws == 0 && choice->no_spline)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "no law to choose from");
    return PALP_OK;
}

palp_status palp_explain_material(const palp_model *specimen, size_t n, const palp_explain_input *inputs,
                                  const palp_explain_settings *settings, const palp_explain_choice *choice,
                                  palp_specimens_fit *fit, palp_error *error) {
    if (!specimen || !inputs || !settings || !choice || !fit)
        return palp_error_null(error);
    memset(fit, 0, sizeof *fit);
    palp_status status = check(specimen, n, choice, error);
    if (status)
        return status;
    palp_explain_settings arms = *settings;
    memset(arms.candidate, 0, sizeof arms.candidate);
    arms.candidate[PALP_EFFECT_RELAXATION_ARM] = 1;
    palp_model model = *specimen;
    infer_search *s = calloc(1, sizeof *s);
    status = s ? explain_data_create(n, inputs, &arms, &model, &s->data, error) : PALP_ERR_NO_MEMORY;
    if (!status) {
        infer_use_spikes(&s->data);
        share_contact(&model, settings);
        s->settings = &arms;
        s->data.contacts_average_0 = s->data.law_alone = true;
        if (explain_fitted_runs(&s->data) < 2) /* that of one run is the average */
            s->data.contacts_alike = true;
        s->n_given = model.n_effects;
        status = characterize(s, &model, n, inputs, choice, fit);
        infer_search_free(s);
    }
    if (s)
        explain_data_free(&s->data);
    free(s);
    if (status)
        palp_specimens_fit_free(fit);
    return status == PALP_ERR_NO_MEMORY ? palp_error_set(error, status, "out of memory") : status;
}
