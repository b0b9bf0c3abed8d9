/* characterize_likelihood.c: --likelihood: law, arms and contacts by the likelihood that palpate explain has.
 */
#include <palpate/infer.h>

#include "characterize.h"
#include "shared/opening.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "characterize";

int characterize_likelihood_check(const characterize_options *o) {
    const bool plain = o->law_choice == 0 && !o->degree_given && o->knots == 0 && o->method == METHOD_NLOPT &&
                       o->arms_form == PALP_ARMS_FREE && o->contact == 0 && isnan(o->contact_mm) &&
                       !o->shared_arms && !o->per_depth && !o->dwell_only && !o->fit_filtered;
    return !o->likelihood || plain
               ? CLI_OK
               : cli_usage_error(NAME,
                                 "--likelihood chooses law and contacts itself, from whole runs; of the "
                                 "options of the model and the fit only --arms N goes with it");
}

/* The fit's runs are the given words; those of the state are sorted and begin at their own contact. */
static palp_status take_runs(const characterize_options *o, characterize_state *s, palp_lumped_fit *fit) {
    double *sorted = calloc(4 * s->n, sizeof *sorted);
    if (!sorted)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < s->n; i++)
        for (size_t k = 0; k < o->n_words; k++)
            if (strcmp(o->words[k], s->run[i].name) == 0) {
                sorted[4 * i] = fit->contact_m[k] - s->run[i].contact_m;
                sorted[4 * i + 1] = fit->contact_sd_m[k];
                sorted[4 * i + 2] = fit->rms_N[k];
                sorted[4 * i + 3] = fit->absolute_N[k];
            }
    for (size_t i = 0; i < s->n; i++) { /* no more runs than words */
        fit->contact_m[i] = sorted[4 * i];
        fit->contact_sd_m[i] = sorted[4 * i + 1];
        fit->rms_N[i] = sorted[4 * i + 2];
        fit->absolute_N[i] = sorted[4 * i + 3];
    }
    fit->n_runs = s->n;
    free(sorted);
    return PALP_OK;
}

int characterize_likelihood(const characterize_options *o, characterize_state *s) {
    palp_experiment *run[CHARACTERIZE_RUNS_MAX] = {NULL};
    palp_explain_input input[CHARACTERIZE_RUNS_MAX];
    palp_error error = {PALP_OK, ""};
    const palp_explain_settings settings = palp_explain_settings_default();
    palp_model specimen = {
        .kind = PALP_MODEL_LUMPED, .height_m = s->run[0].height_m, .radius_m = s->run[0].radius_m};
    int code = open_runs(NAME, o->n_words, o->words, 0, run, input);
    if (code == CLI_OK) {
        palp_status status =
            palp_infer_material(&specimen, o->n_words, input, &settings, o->arms_auto ? 0 : o->arms,
                                o->arms_auto ? PALP_ARMS_MAX : o->arms, &s->final, &error);
        s->has_final = status == PALP_OK;
        status = status ? status : take_runs(o, s, &s->final);
        code = status ? cli_status(NAME, status, &error) : CLI_OK;
    }
    for (size_t i = 0; i < o->n_words; i++)
        palp_experiment_free(run[i]);
    if (code == CLI_OK) {
        s->material = s->final.material;
        s->n_arms = s->material.n_arms;
        s->degree = o->degree;
        s->contact = PALP_CONTACT_FREE;
        characterize_move_contacts(s, &s->final);
        memset(s->final.contact_m, 0, s->n * sizeof *s->final.contact_m);
    }
    return code;
}
