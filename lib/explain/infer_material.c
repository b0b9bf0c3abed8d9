/* infer_material.c: a lumped solid from runs: a law, and the number of arms with the largest evidence. */
#include <palpate/explain.h>

#include "base/dense.h"
#include "base/file.h"
#include "infer_search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Log likelihood of a fit whose law may bend as it likes. */
static palp_status fit_freely(const infer_search *s, const infer_fit *fit, double *log_likelihood) {
    enum { EVALUATIONS = 8 };
    const double FREE = 10.0; /* bends of the logarithm: as large as any */
    infer_fit freely;
    infer_posterior p = {.memory = NULL};
    palp_status status = infer_fit_copy(fit, &s->data, &freely);
    if (status)
        return status;
    freely.sizes.bend = FREE;
    for (size_t i = 0; i < PALP_LAW_MAX; i++)
        freely.certain[i] = 1.0;
    status = infer_fit_improve(&freely, &s->data, EVALUATIONS);
    if (!status)
        status = infer_posterior_find(&freely, &s->data, &p);
    *log_likelihood = -0.5 * (p.here + freely.log_noise);
    infer_posterior_free(&p);
    infer_fit_free(&freely);
    return status;
}

/* By how much an arm makes the runs more probable, nats; if that is less, by how much more likely beside a
 * law that may bend as it likes. At one speed a law can take the place of any arm, though an arm may be more
 * probable than the law's bends. wanted: less than this need not be known. */
static palp_status weigh_arm(const infer_search *s, const infer_fit *with, const infer_fit *without,
                             double wanted, double *nats) {
    double freely[2] = {0.0, 0.0};
    *nats = with->score - without->score;
    if (*nats <= wanted)
        return PALP_OK;
    palp_status status = fit_freely(s, with, &freely[0]);
    if (!status)
        status = fit_freely(s, without, &freely[1]);
    if (!status)
        *nats = fmin(*nats, freely[0] - freely[1]);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

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
    if (!status)
        status = infer_fit_converge(&next, &s->data);
    double nats = 0.0;
    if (!status)
        status = weigh_arm(s, &next, &s->fit, wanted, &nats);
    *taken = !status && nats > wanted;
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
            has_arm(arm)) /* near the current fit it may gain too little */
            status = take_arm(s, arm, wanted ? -HUGE_VAL : threshold + infer_price(s), &taken);
    }
    return status;
}

/* ---- from many arms ---- */

/* Arms even in log time: at fixed times so many a decade, else one a decade or nearly so. PALP_ERR_LIMIT: too
 * many. */
static palp_status place_arms(const explain_data *data, const palp_explain_choice *choice, double stiffness,
                              palp_material *m, palp_error *error) {
    const bool fixed = choice->per_decade > 0;
    const double shortest = fixed ? 4.0 * data->step : data->step,
                 longest = (fixed ? 3.0 : 1.0) * data->duration;
    const double decades = log10(fmax(longest / shortest, 1.0)),
                 each = fixed ? (double)choice->per_decade : 1.0;
    const double wanted = ceil(each * decades - 1e-9) + 1.0;
    if (fixed && wanted > PALP_ARMS_MAX)
        return palp_error_set(error, PALP_ERR_LIMIT,
                              "%g arms a decade over %.3g decades of time are more than %d", each, decades,
                              PALP_ARMS_MAX);
    m->n_arms = wanted < PALP_ARMS_MAX ? (size_t)wanted : PALP_ARMS_MAX;
    const double apart = fixed ? 1.0 / each : decades / fmax(1.0, (double)m->n_arms - 1.0);
    for (size_t j = 0; j < m->n_arms; j++) {
        const double own = stiffness / (double)m->n_arms;
        m->arms[j] =
            (palp_arm){.stiffness_N = own, .viscosity_Ns = own * shortest * pow(10.0, apart * (double)j)};
    }
    return PALP_OK;
}

/* The same arms driven by the elastic force, if that is more probable by the threshold; else raw stays NULL.
 * So many arms follow any spectrum; from few the other drive may not be found. */
static palp_status find_driven(const infer_search *s, infer_fit *driven) {
    enum { ROUNDS = 3 };
    palp_model model = s->fit.c.model;
    model.material.quasi_linear = true;
    palp_status status = infer_fit_create(&model, &s->data, &s->fit, driven);
    if (status)
        return status;
    status = infer_fit_evaluate(driven, &s->data);
    if (!status)
        status = infer_fit_settle(driven, &s->data, ROUNDS, true);
    if (status || driven->score - s->fit.score <= infer_threshold(s->settings) + infer_price(s))
        infer_fit_free(driven);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

/* A stiffness that is constant, of the largest force and depth; the arms have half of it. */
static palp_status start(infer_search *s, palp_model *model, const palp_explain_choice *choice,
                         palp_error *error) {
    const double own = 0.5 * s->data.peak * s->data.height / s->data.deepest;
    palp_status status = place_arms(&s->data, choice, own, &model->material, error);
    if (!status)
        status = palp_law_polynomial(1, &own, &model->material.law);
    if (!status)
        status = infer_fit_create(model, &s->data, NULL, &s->fit);
    return status ? status : infer_begin(&s->fit, &s->data, s->settings);
}

/* The current fit without arm j, near its best parameters; raw NULL: there is none. */
static palp_status take_out(const infer_search *s, size_t j, infer_fit *fit) {
    enum { EVALUATIONS = 8 };
    const infer_fit *with = &s->fit;
    palp_model model = with->c.model;
    palp_material *m = &model.material;
    const size_t last = --m->n_arms, to = m->law.n + 2 * j, from = m->law.n + 2 * last;
    m->arms[j] = m->arms[last];
    palp_status status = infer_fit_create(&model, &s->data, with, fit);
    if (status)
        return status;
    for (size_t a = 0; a < 2 && j < last; a++) {
        fit->given[to + a] = with->given[from + a];
        fit->c.low[to + a] = with->c.low[from + a];
        fit->c.high[to + a] = with->c.high[from + a];
    }
    status = infer_fit_evaluate(fit, &s->data);
    if (!status)
        status = infer_fit_improve(fit, &s->data, EVALUATIONS);
    if (status)
        infer_fit_free(fit);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

/* Variance of the logarithm of each arm's stiffness, variance[n_arms]. */
static palp_status find_variances(const infer_search *s, double *variance) {
    const palp_material *m = &s->fit.c.model.material;
    infer_posterior p;
    palp_status status = infer_posterior_find(&s->fit, &s->data, &p);
    double *unit = status ? NULL : calloc(p.g + 1, sizeof *unit);
    if (!status && !unit)
        status = PALP_ERR_NO_MEMORY;
    for (size_t j = 0; j < m->n_arms && !status; j++) {
        memset(unit, 0, p.g * sizeof *unit);
        unit[p.hats + m->law.n + 2 * j] = 1.0;
        dense_forward(p.g, p.factor, 1, unit);
        variance[j] = dense_dot(p.g, unit, unit);
    }
    free(unit);
    infer_posterior_free(&p);
    return status;
}

/* The fit without the arm whose evidence is smallest, of those whose stiffnesses are the least certain; raw
 * NULL: there is none. */
static palp_status find_needless(const infer_search *s, infer_fit *best) {
    enum { TRIED = 3 };
    const size_t n = s->fit.c.model.material.n_arms;
    double variance[PALP_ARMS_MAX];
    memset(best, 0, sizeof *best);
    palp_status status = find_variances(s, variance);
    for (size_t i = 0; i < TRIED && i < n && !status; i++) {
        infer_fit fit;
        size_t least = 0;
        for (size_t j = 1; j < n; j++)
            least = variance[j] > variance[least] ? j : least;
        variance[least] = -1.0;
        status = take_out(s, least, &fit);
        if (!status && fit.raw && (!best->raw || fit.score > best->score))
            infer_fit_exchange(best, &fit);
        infer_fit_free(&fit);
    }
    if (!status && best->raw)
        status = infer_fit_settle(best, &s->data, 2, true);
    if (status)
        infer_fit_free(best);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

/* Removes arms whose evidence is below the threshold. */
static palp_status drop_arms(infer_search *s, size_t least) {
    const double wanted = infer_threshold(s->settings) + infer_price(s);
    palp_status status = PALP_OK;
    for (bool taken = true; taken && !status && s->fit.c.model.material.n_arms > least;) {
        double nats = 0.0;
        infer_fit fit;
        if (s->settings->stop && s->settings->stop(s->settings->stop_user))
            return PALP_ERR_STOPPED;
        status = find_needless(s, &fit);
        if (!status && fit.raw)
            status = weigh_arm(s, &s->fit, &fit, wanted, &nats);
        taken = !status && fit.raw && nats <= wanted;
        if (taken)
            infer_fit_exchange(&s->fit, &fit);
        infer_fit_free(&fit);
    }
    return status;
}

/* A simpler model than the runs show is asked for. It shall follow them as closely as it can: all that it
 * misses is white noise. Correlated noise and tails would take its place. */
static palp_status reduce(infer_search *s) {
    infer_noise *noise = &s->fit.noise;
    s->data.reduced = true;
    noise->freedom = 1000.0;
    for (int a = 0; a < INFER_SLOW; a++) {
        noise->slow[a] = 0.0;
        noise->slow_freedom[a] = 1000.0;
    }
    for (size_t i = 0; i < s->data.n; i++) {
        s->fit.sample[i].certain = 1.0;
        for (size_t a = 0; a < INFER_SLOW; a++)
            s->fit.sample[i].steady[a] = 1.0;
    }
    palp_status status = infer_fit_products(&s->fit, &s->data);
    if (!status)
        status = infer_fit_score(&s->fit, &s->data);
    return status ? status : infer_fit_converge(&s->fit, &s->data);
}

/* Removes arms that are too many, those first whose evidence is smallest. */
static palp_status leave_arms(infer_search *s, size_t most) {
    palp_status status = s->fit.c.model.material.n_arms > most ? reduce(s) : PALP_OK;
    while (!status && s->fit.c.model.material.n_arms > most) {
        infer_fit fit;
        status = find_needless(s, &fit);
        if (!status && !fit.raw)
            status = PALP_ERR_NOT_CONVERGED;
        if (!status)
            infer_fit_exchange(&s->fit, &fit);
        infer_fit_free(&fit);
        if (!status)
            status = infer_fit_converge(&s->fit, &s->data);
    }
    return status;
}

/* A further share of the work is done: of one search less than a half, as there may be two. */
static void advance(const infer_search *s, double share) {
    if (s->settings->progress)
        s->settings->progress(s->settings->progress_user, share);
}

/* From many arms to those that the runs show. */
static palp_status settle_arms(infer_search *s, const palp_explain_choice *choice) {
    palp_status status = drop_arms(s, choice->per_decade ? 0 : choice->least_arms);
    if (!status)
        status = infer_fit_converge(&s->fit, &s->data);
    if (!status && !choice->per_decade)
        status = find_arms(s, choice->least_arms, choice->most_arms);
    return status;
}

/* The arms that the runs show, beside correlated noise of this longest time; 0: that of the longest run.
 * Where the elastic force seems to drive them, both drives are followed to the end: a misfit can make it seem
 * so. */
static palp_status search_arms(infer_search *s, palp_model model, const palp_explain_choice *choice,
                               double memory, palp_error *error) {
    infer_fit driven = {.raw = NULL};
    s->data.memory = memory;
    palp_status status = start(s, &model, choice, error);
    advance(s, 0.15);
    if (!status)
        status = find_driven(s, &driven);
    advance(s, 0.1);
    if (!status)
        status = settle_arms(s, choice);
    advance(s, 0.15);
    if (!status && driven.raw) {
        infer_fit_exchange(&s->fit, &driven);
        status = settle_arms(s, choice);
        if (status || s->fit.score - driven.score <= infer_threshold(s->settings) + infer_price(s))
            infer_fit_exchange(&s->fit, &driven);
        status = status == PALP_ERR_NO_MEMORY || status == PALP_ERR_STOPPED ? status : PALP_OK;
    }
    infer_fit_free(&driven);
    return status;
}

/* Gives the longest time to the smallest process of the correlated noise, unless that is less probable. */
static palp_status lengthen(infer_search *s) {
    infer_fit longer;
    infer_noise *noise = &longer.noise;
    int least = 0;
    palp_status status = infer_fit_copy(&s->fit, &s->data, &longer);
    if (status)
        return status;
    for (int a = 1; a < INFER_SLOW; a++)
        least = noise->slow[a] < noise->slow[least] ? a : least;
    noise->time[least] = s->data.duration;
    noise->slow_freedom[least] = 1000.0;
    for (size_t i = 0; i < s->data.n; i++)
        longer.sample[i].steady[least] = 1.0;
    status = infer_fit_products(&longer, &s->data);
    if (!status)
        status = infer_fit_score(&longer, &s->data);
    if (!status)
        status = infer_fit_converge(&longer, &s->data);
    if (!status && longer.score > s->fit.score - infer_threshold(s->settings))
        infer_fit_exchange(&s->fit, &longer);
    infer_fit_free(&longer);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

/* How much less probable the fit is without the correlated noise that is longer than this, nats. */
static palp_status find_long_noise(const infer_search *s, double memory, double *nats) {
    infer_fit without;
    palp_status status = infer_fit_copy(&s->fit, &s->data, &without);
    if (status)
        return status;
    for (int a = 0; a < INFER_SLOW; a++)
        if (without.noise.time[a] > memory)
            without.noise.slow[a] = 0.0;
    status = infer_fit_products(&without, &s->data);
    if (!status)
        status = infer_fit_score(&without, &s->data);
    *nats = status ? 0.0 : s->fit.score - without.score;
    infer_fit_free(&without);
    return status;
}

/* Correlated noise as long as a run can pass for relaxation where the model lacks an effect. So where the
 * runs show such noise, the search begins with noise of a hundredth of that time too. Its end is kept if it
 * is more probable. */
static palp_status search_in_two_ways(infer_search *s, const palp_model *model,
                                      const palp_explain_choice *choice, palp_error *error) {
    static const double SHARE = 0.01;
    const double memory = fmax(SHARE * s->data.duration, 40.0 * s->data.step); /* a decade of times */
    double nats = 0.0;
    palp_status status = search_arms(s, *model, choice, 0.0, error);
    if (!status && memory < s->data.duration)
        status = find_long_noise(s, memory, &nats);
    if (status || nats < infer_threshold(s->settings))
        return status;
    infer_fit whole = s->fit;
    memset(&s->fit, 0, sizeof s->fit);
    status = search_arms(s, *model, choice, memory, NULL);
    if (!status)
        status = lengthen(s);
    s->data.memory = 0.0;
    if (!s->fit.raw || s->fit.score - whole.score < infer_threshold(s->settings))
        infer_fit_exchange(&s->fit, &whole);
    infer_fit_free(&whole);
    return status == PALP_ERR_NO_MEMORY || status == PALP_ERR_STOPPED ? status : PALP_OK;
}

static palp_status characterize(infer_search *s, const palp_model *model, size_t n,
                                const palp_explain_input *inputs, const palp_explain_choice *choice,
                                palp_specimens_fit *fit, palp_error *error) {
    s->residual = malloc(2 * s->data.n * sizeof *s->residual);
    if (!s->residual)
        return PALP_ERR_NO_MEMORY;
    s->discrepancy = s->residual + s->data.n;
    palp_status status = search_in_two_ways(s, model, choice, error);
    fit->mean.converged = status != PALP_ERR_STOPPED;
    status = fit->mean.converged ? status : PALP_OK;
    if (!status && !choice->per_decade)
        status = leave_arms(s, choice->most_arms);
    const double score = s->fit.score;
    if (!status)
        status = infer_law_choose(s, choice);
    if (!status && choice->no_spline && !s->data.reduced && fit->mean.converged &&
        score - s->fit.score > infer_threshold(s->settings))
        status = reduce(s);
    if (!status)
        status = fit->mean.converged ? infer_fit_converge(&s->fit, &s->data)
                                     : infer_fit_improve(&s->fit, &s->data, INFER_LAST);
    return status ? status : infer_estimates_fill(s, n, inputs, fit);
}

/* Keeps the dwells only, of runs that have them. */
static void use_dwells(explain_data *data) {
    for (size_t r = 0; r < data->n_runs; r++) {
        explain_run *run = &data->run[r];
        bool dwells = false;
        for (size_t i = 0; i < run->n; i++)
            dwells = dwells || (run->stood[i] >= 0.0 && run->depth[i] > 0.0);
        for (size_t i = 0; i < run->n && dwells; i++)
            run->use[i] = run->use[i] && run->stood[i] >= 0.0;
    }
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
        s->data.times_fixed = choice->per_decade > 0;
        if (choice->dwell_only)
            use_dwells(&s->data);
        if (explain_fitted_runs(&s->data) < 2) /* that of one run is the average */
            s->data.contacts_alike = true;
        s->n_given = model.n_effects;
        status = characterize(s, &model, n, inputs, choice, fit, error);
        infer_search_free(s);
    }
    if (s)
        explain_data_free(&s->data);
    free(s);
    if (status)
        palp_specimens_fit_free(fit);
    return status == PALP_ERR_NO_MEMORY ? palp_error_set(error, status, "out of memory") : status;
}
