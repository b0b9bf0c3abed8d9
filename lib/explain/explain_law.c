/* explain_law.c: the material's law as a candidate: another family of stiffness laws beside the same effects,
 * or arms that the elastic force drives (Fung's quasi-linear ones) in place of the strain. */
#include "explain_search.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* By their freedom; a polynomial follows a smooth law with fewer coefficients than a spline does. */
static const struct family {
    palp_law_kind kind;
    size_t n;
} families[] = {{PALP_LAW_POLYNOMIAL, 2}, {PALP_LAW_POLYNOMIAL, 3}, {PALP_LAW_POLYNOMIAL, 4},
                {PALP_LAW_POLYNOMIAL, 5}, {PALP_LAW_POLYNOMIAL, 6}, {PALP_LAW_SPLINE, 8},
                {PALP_LAW_SPLINE, 14},    {PALP_LAW_SPLINE, 27}};

static double price(const explain_search *s, size_t n) {
    return 0.5 * (double)n * log((double)s->data.n);
}

/* The law of that family nearest to one that is there, over the strains of these runs, if the surface were
 * higher by a strain; what it is before that is not known. ERR_ARGUMENT: there is none. */
static palp_status resemble(const palp_law *from, const struct family *family, double deepest, double higher,
                            palp_law *law) {
    enum { PLACES = 200 };
    double strain[PLACES], force[PLACES], value[PALP_LAW_MAX], left, most = fmax(from->strain_max, deepest);
    palp_status status;
    size_t n = 0;
    for (size_t i = 0; i < PLACES; i++) {
        strain[n] = most * (double)(i + 1) / PLACES;
        const double before = strain[n] - higher;
        palp_law_force(from, 1, &before, &force[n], NULL, NULL);
        n += before > 0.5 * higher;
    }
    if (n < PLACES / 2)
        return PALP_ERR_ARGUMENT;
    if (family->kind == PALP_LAW_POLYNOMIAL) {
        status = dense_polynomial(n, strain, force, 1, family->n, value, &left);
        if (!status)
            status = palp_law_polynomial(family->n, value, law);
    } else {
        size_t at = 0;
        for (size_t i = 0; i < family->n; i++) {
            strain[i] = most * (double)i / (double)(family->n - 1);
            value[i] = 0.0;
            double before = strain[i] - higher, there;
            if (higher == 0.0 || (i > 0 && before > 0.5 * fabs(higher))) {
                palp_law_force(from, 1, &before, &there, NULL, NULL);
                palp_law_stiffness(from, strain[i], &value[i], NULL);
                value[i] = higher == 0.0 ? value[i] : there / strain[i];
            } else
                at = i + 1;
        }
        for (size_t i = 0; i < at && at < family->n; i++)
            value[i] = value[at];
        status = palp_law_spline(family->n, strain, value, law);
    }
    return status ? status : palp_law_limit(law, most);
}

/* What drives the material's arms at a strain, of what drives linear ones. */
static double drive_of(const palp_material *material, double strain) {
    double first, there;
    if (!material->quasi_linear)
        return 1.0;
    palp_law_stiffness(&material->law, 0.0, &first, NULL);
    palp_law_stiffness(&material->law, strain, &there, NULL);
    return there > 0.0 && first > 0.0 ? there / first : 1.0;
}

/* Another law and other arms for the model, which are as stiff as they were at half the deepest strain. */
static void give(const explain_data *data, const palp_law *law, bool quasi_linear, palp_model *model) {
    const double strain = 0.5 * data->deepest / data->height;
    palp_material *m = &model->material;
    double scale = drive_of(m, strain);
    m->law = *law;
    m->quasi_linear = quasi_linear;
    scale /= drive_of(m, strain);
    for (size_t j = 0; j < m->n_arms; j++) {
        m->arms[j].stiffness_N *= scale;
        m->arms[j].viscosity_Ns *= scale;
    }
    for (size_t i = 0; i < model->n_effects; i++)
        if (effect_row_of(model->effects[i].id)->arm)
            model->effects[i].value[0] *= scale;
}

/* The effects at hand with another law and other arms. ERR_ARGUMENT: it promises less than its coefficients
 * cost. */
static palp_status fit_with(const explain_search *s, const palp_law *law, bool quasi_linear, bool anyhow,
                            explain_fit *fit) {
    const double samples = (double)explain_samples(&s->data);
    double promised = 0.0;
    palp_model model = s->fit.model;
    give(&s->data, law, quasi_linear, &model);
    palp_status status = explain_fit_beside(&s->fit, &model, &s->data, fit);
    fit->spread = s->settings;
    if (!status)
        status = explain_fit_products(fit, &s->data, NULL);
    if (!status)
        status = explain_fit_predict(fit, &s->data, &promised);
    const double gain = 0.5 * (samples * explain_chi2(&s->data, &s->fit) - promised);
    if (!status && !anyhow && !(gain > price(s, law->n - s->fit.model.material.law.n)))
        status = PALP_ERR_ARGUMENT;
    return status ? status : explain_fit_settle(fit, &s->data, s->settings);
}

bool explain_law_believed(const explain_search *s, const explain_trial *t, double threshold) {
    const double cost = t->raw_gain - t->gain;
    bool gains = t->gain > fmax(0.0, (t->inflation - 1.0) * cost) && t->raw_gain > t->inflation * threshold;
    return t->fit.product && gains &&
           (explain_fitted_runs(&s->data) == 1 || t->held_out_gain > t->held_out_se);
}

void explain_law_free(explain_trial *t) {
    explain_fit_free(&t->fit);
    free(t->force);
    *t = (explain_trial){.tried = true};
}

/* Whether there is an arm that may be driven otherwise. */
static bool has_arms(const palp_model *model) {
    bool any = model->material.n_arms > 0;
    for (size_t i = 0; i < model->n_effects; i++)
        any = any || effect_row_of(model->effects[i].id)->arm;
    return any;
}

/* The effects at hand with arms that are driven otherwise. A spline's knots of next to no stiffness begin at
 * a tenth of that at half the deepest strain: arms that the elastic force drives are counted by the stiffness
 * at the surface. */
static palp_status fit_driven(const explain_search *s, explain_fit *fit) {
    static const double FIRST = 0.1;
    const palp_material *now = &s->fit.model.material;
    palp_law law = now->law;
    double typical, stiffness[PALP_LAW_MAX];
    palp_law_stiffness(&law, 0.5 * s->data.deepest / s->data.height, &typical, NULL);
    for (size_t i = 0; i < law.n; i++)
        stiffness[i] = law.kind == PALP_LAW_SPLINE && !now->quasi_linear
                           ? fmax(law.coefficients[i], FIRST * typical)
                           : law.coefficients[i];
    palp_status status = palp_law_set_coefficients(&law, stiffness);
    if (!status)
        status = fit_with(s, &law, !now->quasi_linear, true, fit);
    return status ? status : explain_fit_settle(fit, &s->data, s->settings);
}

/* Keeps the trial of another law in *best if it is believed and gains more; more: nats that it costs beside
 * its coefficients. */
static palp_status consider(const explain_search *s, double threshold, double more, palp_status status,
                            explain_trial *t, explain_trial *best) {
    if (!status)
        status = explain_trial_examine(s, PALP_EFFECT_COUNT, t);
    t->raw_gain -= more;
    t->gain -= more;
    const bool better =
        !status && explain_law_believed(s, t, threshold) && (!best->fit.product || t->gain > best->gain);
    explain_trial other = better ? *best : *t;
    if (better)
        *best = *t;
    explain_law_free(&other);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

palp_status explain_law_try(const explain_search *s, double threshold, explain_trial *best) {
    const palp_law *now = &s->fit.model.material.law;
    palp_status status = PALP_OK;
    *best = (explain_trial){.tried = true};
    if (s->fit.model.kind == PALP_MODEL_NETWORK) /* whose fits are dear */
        return PALP_OK;
    for (size_t f = 0; f < sizeof families / sizeof *families && !status; f++) {
        explain_trial t = {.tried = true};
        palp_law law;
        if (families[f].n <= now->n ||
            resemble(now, &families[f], s->data.deepest / s->data.height, 0.0, &law))
            continue;
        status = fit_with(s, &law, s->fit.model.material.quasi_linear, false, &t.fit);
        status = consider(s, threshold, 0.0, status, &t, best);
    }
    if (!status && has_arms(&s->fit.model)) {
        explain_trial t = {.tried = true};
        status = fit_driven(s, &t.fit);
        status = consider(s, threshold, log(2.0), status, &t, best); /* a choice of two */
    }
    if (!status && now->kind == PALP_LAW_SPLINE &&
        explain_fitted_runs(&s->data) > 1) { /* one alone accuses no instrument */
        explain_trial t = {.tried = true};
        status = explain_knots_add(s, &t.fit);
        status = consider(s, threshold, explain_knots_cost(s, t.fit.model.material.law.n), status, &t, best);
    }
    return status;
}

palp_status explain_law_spares(const explain_search *s, const explain_trial *law, const explain_trial *t,
                               double threshold, bool *stands) {
    explain_fit fit = {.n_columns = 0};
    palp_model model = law->fit.model;
    const size_t last = t->fit.model.n_effects;
    *stands = true;
    if (last == model.n_effects ||
        palp_effect_look_up(t->fit.model.effects[last - 1].id)->place == PALP_EFFECT_SPECIMEN)
        return PALP_OK;
    model.effects[model.n_effects++] = t->fit.model.effects[last - 1];
    palp_status status = explain_fit_beside(&law->fit, &model, &s->data, &fit);
    fit.renewed = t->fit.renewed;
    if (!status)
        status = explain_fit_settle_anew(&fit, &s->data, s->settings);
    const double gain = fit.score - law->fit.score;
    if (!status)
        *stands = gain > threshold && gain > price(s, fit.n_columns - law->fit.n_columns);
    explain_fit_free(&fit);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

/* ---- a surface that all runs have elsewhere ---- */

/* The fit with all surfaces higher (a length), and the law that goes with them. ERR_ARGUMENT: there is none.
 */
static palp_status raise_surfaces(const explain_search *s, const explain_fit *from, double higher,
                                  explain_fit *fit) {
    const palp_law *law = &from->model.material.law;
    const struct family same = {law->kind, law->n};
    palp_model model = from->model;
    palp_law raised;
    palp_status status =
        resemble(law, &same, s->data.deepest / s->data.height, higher / s->data.height, &raised);
    if (!status) {
        give(&s->data, &raised, model.material.quasi_linear, &model);
        status = explain_fit_beside(from, &model, &s->data, fit);
    }
    for (size_t r = 0; r < s->data.n_runs && !status; r++)
        fit->contact[r] -= higher;
    return status ? status : explain_fit_settle_anew(fit, &s->data, s->settings);
}

/* Moves fit there by steps as long as that is more likely. */
static palp_status walk(const explain_search *s, explain_fit *fit, double step, bool *moved) {
    enum { STEPS = 4 };
    static const double LEAST = 1.0; /* nats that a step must gain */
    for (int k = 0; k < STEPS; k++) {
        explain_fit there = {.n_columns = 0};
        palp_status status = raise_surfaces(s, fit, step, &there);
        const bool better = !status && there.score > fit->score + LEAST;
        explain_fit_free(better ? fit : &there);
        if (better)
            *fit = there;
        *moved = *moved || better;
        if (!better)
            return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
    }
    return PALP_OK;
}

palp_status explain_refit_anywhere(explain_search *s) {
    palp_status status = explain_refit(s);
    const palp_law_kind kind = s->fit.model.material.law.kind;
    const bool other_laws =
        s->fit.model.kind != PALP_MODEL_NETWORK && (kind == PALP_LAW_POLYNOMIAL || kind == PALP_LAW_SPLINE);
    bool moved = false;
    if (status || !other_laws || s->settings->contact != PALP_CONTACT_FREE)
        return status;
    double step = fmin(0.05 * s->data.deepest, s->fit.scatter.contact);
    for (int round = 0; round < 2 && !status; round++, step /= 3.0) {
        status = walk(s, &s->fit, step, &moved);
        if (!status && (kind == PALP_LAW_POLYNOMIAL ||
                        explain_fitted_runs(&s->data) > 1)) /* of one contact a spline takes in the rest */
            status = walk(s, &s->fit, -step, &moved);
    }
    return status || !moved ? status : explain_refit(s);
}

palp_status explain_law_take(explain_search *s, explain_trial *law) {
    if (!s->law_changed)
        s->first_material = s->fit.model.material;
    s->law_changed = true;
    explain_fit_free(&s->fit);
    s->fit = law->fit;
    law->fit.product = NULL;
    s->given = *s->data.given; /* where trials go back to */
    give(&s->data, &s->fit.model.material.law, s->fit.model.material.quasi_linear, &s->given);
    s->data.given = &s->given;
    explain_law_free(law);
    return explain_refit_anywhere(s);
}

palp_status explain_law_review(explain_search *s, palp_explain_law *found) {
    explain_fit fit = {.n_columns = 0};
    *found = (palp_explain_law){.found = s->law_changed};
    if (!s->law_changed)
        return PALP_OK;
    double *residual = malloc(s->data.n * sizeof *residual);
    palp_status status = residual
                             ? fit_with(s, &s->first_material.law, s->first_material.quasi_linear, true, &fit)
                             : PALP_ERR_NO_MEMORY;
    if (!status)
        status = explain_fit_evaluate(&fit, &s->data, NULL, residual);
    if (!status) {
        found->without_N = explain_fitted_rms(&s->data, residual);
        found->evidence =
            s->fit.score - fit.score - price(s, s->fit.model.material.law.n - s->first_material.law.n);
    }
    if (!status && !(found->evidence > 0.0)) {
        explain_fit_free(&s->fit);
        s->fit = fit;
        fit.product = NULL;
        give(&s->data, &s->fit.model.material.law, s->fit.model.material.quasi_linear, &s->given);
        s->law_changed = found->found = false;
        status = explain_refit(s);
    }
    explain_fit_free(&fit);
    free(residual);
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}
