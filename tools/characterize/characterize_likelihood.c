/* characterize_likelihood.c: --likelihood: law, arms, contacts and specimens by the likelihood that palpate
 * explain has. */
#include <palpate/explain.h>

#include "characterize.h"
#include "shared/opening.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "characterize";

int characterize_likelihood_check(const characterize_options *o) {
    const bool whole = o->method == METHOD_NLOPT && o->arms_form == PALP_ARMS_FREE && !o->shared_arms &&
                       !o->per_depth && !o->dwell_only && !o->fit_filtered;
    return !o->likelihood || whole ? CLI_OK
                                   : cli_usage_error(NAME, "--likelihood fits whole raw runs with free arms; "
                                                           "leave out --method grid, --shared-arms, "
                                                           "--per-depth, --hold-only, --fit-filtered and "
                                                           "arms of another form");
}

/* ---- the runs as the recordings have them ---- */

/* Index of the word's run in the state; s->n: it has none, as a part of another one. */
static size_t run_of(const characterize_state *s, const char *word) {
    size_t r = 0;
    while (r < s->n && strcmp(s->run[r].name, word) != 0)
        r++;
    return r;
}

/* What the file says of contact, height, radius and specimen as the state has it: depth 0 is contact, force 0
 * that without one. The state's runs are scaled to one height and area. */
static palp_status set_run(const characterize_state *s, size_t r, palp_experiment *e) {
    const palp_recording *run = &s->run[r];
    const characterize_body *body = &s->body[s->specimen[r]];
    const double height = body->height_m, radius = body->radius_m,
                 area = radius > 0 ? pow(radius / run->radius_m, 2) : 1;
    double *depth = palp_experiment_column(e, "depth_mm"), *force = palp_experiment_column(e, "force_N");
    const double contact = 1e3 * run->contact_m * height / run->height_m, zero = run->zero_N * area;
    char name[32];
    for (size_t i = 0; i < palp_experiment_rows(e); i++) {
        depth[i] -= contact;
        force[i] -= zero;
    }
    snprintf(name, sizeof name, "specimen %zu", s->n_specimens > 1 ? s->specimen[r] + 1 : 1);
    palp_status status = palp_experiment_set_string(e, "specimen.name", name);
    if (!status)
        status = palp_experiment_set_number(e, "specimen.height_mm", 1e3 * height);
    return status || !(radius > 0) ? status
                                   : palp_experiment_set_number(e, "specimen.radius_mm", 1e3 * radius);
}

static int set_runs(const characterize_options *o, const characterize_state *s, palp_experiment **run) {
    palp_experiment *whole[CHARACTERIZE_RUNS_MAX];
    size_t of[CHARACTERIZE_RUNS_MAX];
    palp_status status = palp_experiment_join(o->n_words, (const palp_experiment *const *)run, whole, of);
    for (size_t i = 0; i < o->n_words && !status; i++) {
        const size_t r = run_of(s, o->words[of[i]]); /* a part is as the run that it continues */
        palp_experiment_free(whole[i]);
        status = r < s->n ? set_run(s, r, run[i]) : PALP_OK;
    }
    return status ? cli_status_of(NAME, o->words[0], status, NULL) : CLI_OK;
}

/* ---- the choice ---- */

static palp_status choose(const characterize_options *o, characterize_state *s, palp_explain_choice *choice) {
    palp_status status = PALP_OK;
    choice->least_arms = o->arms_auto ? 0 : o->arms;
    choice->most_arms = o->arms_auto ? PALP_ARMS_MAX : o->arms;
    s->degree = o->degree;
    choice->law = s->law;
    choice->no_spline = !o->law_auto;
    if (o->law_auto || o->degree_auto)
        status = characterize_list_laws(s);
    for (size_t i = 0; i < s->laws.n && !status; i++)
        if (o->degree_auto ? s->law[i].kind == PALP_LAW_POLYNOMIAL : s->law[i].kind != PALP_LAW_SPLINE)
            s->law[choice->n_laws++] = s->law[i];
    s->laws.n = 0;
    if (!o->law_auto && !o->degree_auto) {
        status = characterize_guess(o, s, &s->law[0]);
        choice->n_laws = 1;
    }
    return status;
}

/* ---- the result ---- */

/* The fit's runs are the given words; those of the state are sorted, and scaled. */
static palp_status take_runs(const characterize_options *o, characterize_state *s, palp_lumped_fit *fit) {
    double *sorted = calloc(4 * s->n, sizeof *sorted);
    if (!sorted)
        return PALP_ERR_NO_MEMORY;
    for (size_t k = 0; k < o->n_words; k++) {
        const size_t i = run_of(s, o->words[k]);
        if (i == s->n)
            continue;
        const double height = s->run[i].height_m / s->body[s->specimen[i]].height_m;
        sorted[4 * i] = fit->contact_m[k] * height;
        sorted[4 * i + 1] = fit->contact_sd_m[k] * height;
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

/* The fit numbers the specimens as they come first among the words. */
static void sort_specimens(const characterize_options *o, const characterize_state *s,
                           palp_specimens_fit *fit) {
    palp_material own[CHARACTERIZE_RUNS_MAX];
    double factor[CHARACTERIZE_RUNS_MAX];
    bool seen[CHARACTERIZE_RUNS_MAX] = {false};
    size_t n = 0;
    for (size_t k = 0; k < o->n_words && n < fit->n_specimens; k++) {
        const size_t r = run_of(s, o->words[k]);
        if (r == s->n || seen[s->specimen[r]])
            continue;
        seen[s->specimen[r]] = true;
        own[s->specimen[r]] = fit->own[n];
        factor[s->specimen[r]] = fit->factor[n++];
    }
    for (size_t k = 0; k < n; k++) {
        fit->own[k] = own[k];
        fit->factor[k] = factor[k];
    }
}

static void take(const characterize_options *o, characterize_state *s) {
    for (size_t k = 0; k < s->n_specimens; k++)
        s->factor[k] = 1.0;
    if (s->n_specimens > 1)
        sort_specimens(o, s, &s->specimens);
    characterize_take_spread(s);
    s->has_final = true;
    s->material = s->final.material;
    s->n_arms = s->material.n_arms;
    if (s->material.law.kind == PALP_LAW_POLYNOMIAL)
        s->degree = s->material.law.n;
    s->contact = PALP_CONTACT_FREE;
    characterize_move_contacts(s, &s->final);
    memset(s->final.contact_m, 0, s->n * sizeof *s->final.contact_m);
}

int characterize_likelihood(const characterize_options *o, characterize_state *s) {
    static const palp_contact_form forms[] = {PALP_CONTACT_FREE, PALP_CONTACT_KNOWN, PALP_CONTACT_COMMON,
                                              PALP_CONTACT_FREE};
    palp_experiment *run[CHARACTERIZE_RUNS_MAX] = {NULL};
    palp_explain_input input[CHARACTERIZE_RUNS_MAX];
    palp_error error = {PALP_OK, ""};
    palp_explain_settings settings = palp_explain_settings_default();
    palp_explain_choice choice = {.n_laws = 0};
    palp_model specimen = {
        .kind = PALP_MODEL_LUMPED, .height_m = s->run[0].height_m, .radius_m = s->run[0].radius_m};
    settings.contact = forms[o->contact];
    int code = open_runs(NAME, o->n_words, o->words, 0, run, input);
    code = code ? code : set_runs(o, s, run);
    if (code == CLI_OK) {
        palp_status status = choose(o, s, &choice);
        if (status == PALP_ERR_INPUT)
            code =
                cli_failure(NAME, "%s: --law needs the specimen's radius; add a line # specimen.radius_mm: R",
                            s->run[0].name);
        if (!status)
            status = palp_explain_material(&specimen, o->n_words, input, &settings, &choice, &s->specimens,
                                           &error);
        if (!status)
            status = take_runs(o, s, &s->specimens.mean);
        code = code || !status ? code : cli_status(NAME, status, &error);
    }
    for (size_t i = 0; i < o->n_words; i++)
        palp_experiment_free(run[i]);
    if (code == CLI_OK)
        take(o, s);
    return code;
}
