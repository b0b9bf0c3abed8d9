/* explain_without.c: the search at the fit without one of the effects that were added. */
#include "explain_search.h"

#include <stdlib.h>
#include <string.h>

size_t explain_added_count(const explain_search *s) {
    return s->fit.model.n_effects - s->n_given + (s->fit.hum_Hz > 0.0);
}

palp_effect explain_added(const explain_search *s, size_t i) {
    if (s->n_given + i < s->fit.model.n_effects)
        return s->fit.model.effects[s->n_given + i];
    return (palp_effect){.id = effect_line(), .value = {0.0, s->fit.hum_Hz}};
}

static palp_status without(const explain_fit *fit, const explain_data *data, size_t n_given, size_t skip,
                           explain_fit *less) {
    palp_model model = fit->model;
    bool hum = n_given + skip >= model.n_effects;
    for (size_t i = n_given + skip; !hum && i + 1 < model.n_effects; i++)
        model.effects[i] = model.effects[i + 1];
    model.n_effects -= !hum;
    palp_status status = explain_fit_beside(fit, &model, data, less);
    if (hum)
        less->hum_Hz = less->hum_N = 0.0;
    return status;
}

/* A second search on the same data at the fit without added effect i. */
palp_status explain_search_without(const explain_search *full, size_t i, explain_search *rest) {
    size_t bytes = full->data.n * sizeof *rest->force;
    memset(rest, 0, sizeof *rest);
    rest->data = full->data;
    rest->settings = full->settings;
    rest->n_given = full->n_given;
    rest->opened = full->opened;
    rest->force = malloc(bytes);
    rest->residual = malloc(bytes);
    palp_status status = rest->force && rest->residual
                             ? without(&full->fit, &full->data, full->n_given, i, &rest->fit)
                             : PALP_ERR_NO_MEMORY;
    rest->fit.spread = full->settings;
    if (!status)
        status = explain_fit_products(&rest->fit, &rest->data, NULL);
    for (int round = 0; round < 2 && !status; round++) {
        status = explain_fit_improve(&rest->fit, &rest->data, 20);
        explain_fit_scatter(&rest->fit, &rest->data, rest->settings);
    }
    if (!status)
        status = explain_fit_evaluate(&rest->fit, &rest->data, rest->force, rest->residual);
    explain_fit_scatter(&rest->fit, &rest->data, rest->settings);
    return status;
}

void explain_search_free(explain_search *s) {
    explain_trials_free(s);
    explain_fit_free(&s->fit);
    free(s->force);
    free(s->residual);
    free(s->first);
}

palp_status explain_trial_again(const explain_search *full, explain_search *rest, palp_effect_id id) {
    explain_trial *t = &rest->trial[id];
    t->tried = true;
    palp_status status = explain_fit_copy(&full->fit, full->data.n_runs, &t->fit);
    return status ? status : explain_trial_examine(rest, id, t);
}
