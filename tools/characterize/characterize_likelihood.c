/* characterize_likelihood.c: --likelihood: law, arms, contacts and specimens by the likelihood of palpate
 * explain. */
#include <palpate/explain.h>

#include "characterize.h"
#include "shared/opening.h"
#include "shared/watch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "characterize";

int characterize_likelihood_check(const characterize_options *o) {
    const bool whole = o->method == METHOD_NLOPT && o->arms_form != PALP_ARMS_FRACTIONAL && !o->shared_arms &&
                       !o->per_depth && !o->fit_filtered;
    return !o->likelihood || whole
               ? CLI_OK
               : cli_usage_error(NAME, "--likelihood fits raw runs; leave out --method grid, --shared-arms, "
                                       "--per-depth, --fit-filtered and --arms fractional");
}

/* ---- the runs ---- */

/* Parts of the way for the blocks of a run. On a ramp, where the force grows with the square of the depth, a
 * block's mean is peak / (12 parts^2) off. Over all n samples this may change chi2 by a tenth. A hundred
 * parts are three between two knots of a law. An exact file counts as one with noise of a millionth of its
 * peak. */
static double parts_of(const palp_recording *run) {
    const double n = (double)run->n;
    double peak = 0;
    for (size_t i = 0; i < run->n; i++)
        peak = fmax(peak, fabs(run->force_N[i]));
    const double noise = fmax(run->noise_N, 1e-6 * peak);
    return fmax(100.0, pow(10.0 * n, 0.25) * sqrt(peak / (12.0 * noise)));
}

/* Run r in blocks, with the height and area of its own specimen: those of the state are scaled to one. */
static palp_status make_run(const characterize_state *s, size_t r, palp_experiment **e) {
    const palp_recording *run = &s->run[r];
    const characterize_body *body = &s->body[s->specimen[r]];
    const double height = body->height_m, radius = body->radius_m, length = height / run->height_m,
                 area = radius > 0 ? pow(radius / run->radius_m, 2) : 1;
    char name[32];
    palp_status status = palp_recording_blocks(run, parts_of(run), e);
    if (status)
        return status;
    double *depth = palp_experiment_column(*e, "depth_mm"), *force = palp_experiment_column(*e, "force_N");
    for (size_t i = 0; i < palp_experiment_rows(*e); i++) {
        depth[i] *= length;
        force[i] *= area;
    }
    snprintf(name, sizeof name, "specimen %zu", s->n_specimens > 1 ? s->specimen[r] + 1 : 1);
    status = palp_experiment_set_string(*e, "specimen.name", name);
    if (!status)
        status = palp_experiment_set_number(*e, "specimen.height_mm", 1e3 * height);
    if (!status && radius > 0)
        status = palp_experiment_set_number(*e, "specimen.radius_mm", 1e3 * radius);
    if (!status && run->contact_rule == PALP_CONTACT_GIVEN)
        status = palp_experiment_set_number(*e, "contact.sd_mm", 1e3 * run->contact_sd_m * length);
    return status;
}

static int make_runs(const characterize_state *s, palp_experiment **run, palp_explain_input *input) {
    for (size_t r = 0; r < s->n; r++) {
        palp_status status = make_run(s, r, &run[r]);
        if (status)
            return cli_status_of(NAME, s->run[r].name, status, NULL);
        input[r] = (palp_explain_input){run[r], s->run[r].name};
    }
    return CLI_OK;
}

/* ---- the choice ---- */

static palp_status choose(const characterize_options *o, characterize_state *s, palp_explain_choice *choice) {
    palp_status status = PALP_OK;
    choice->least_arms = o->arms_auto ? 0 : o->arms;
    choice->most_arms = o->arms_auto ? PALP_ARMS_MAX : o->arms;
    choice->per_decade = o->per_decade;
    choice->dwell_only = o->dwell_only;
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

/* Residual of the model over all samples that count, without a zero and a gain of each run. */
static palp_status measure_residuals(characterize_state *s) {
    for (size_t r = 0; r < s->n; r++) {
        const palp_recording *run = &s->run[r];
        double square = 0, sum = 0, count = 0, *force = malloc(run->n * sizeof *force);
        palp_status status = force ? palp_lumped_fit_force(&s->final, r, run, force) : PALP_ERR_NO_MEMORY;
        for (size_t i = 0; i < run->n && status == PALP_OK; i++) {
            if (!run->use[i] || run->depth_m[i] <= 0)
                continue;
            const double miss = force[i] - run->force_N[i];
            square += miss * miss;
            sum += fabs(miss);
            count += 1;
        }
        free(force);
        if (status)
            return status;
        s->final.rms_N[r] = count > 0 ? sqrt(square / count) : 0;
        s->final.absolute_N[r] = sum;
    }
    return PALP_OK;
}

static palp_status take(characterize_state *s) {
    for (size_t k = 0; k < s->n_specimens; k++)
        s->factor[k] = 1.0;
    characterize_take_spread(s);
    s->has_final = true;
    s->material = s->final.material;
    s->n_arms = s->material.n_arms;
    if (s->material.law.kind == PALP_LAW_POLYNOMIAL)
        s->degree = s->material.law.n;
    s->contact_scatter_m = s->final.contact_scatter_m;
    characterize_move_contacts(s, &s->final);
    memset(s->final.contact_m, 0, s->n * sizeof *s->final.contact_m);
    return measure_residuals(s);
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
    settings.contact = s->contact = forms[o->contact];
    int code = make_runs(s, run, input);
    if (code == CLI_OK) {
        palp_status status = choose(o, s, &choice);
        if (status == PALP_ERR_INPUT)
            code =
                cli_failure(NAME, "%s: --law needs the specimen's radius; add a line # specimen.radius_mm: R",
                            s->run[0].name);
        if (!status) {
            watch w;
            watch_start(&w, NAME, &settings);
            status = palp_explain_material(&specimen, s->n, input, &settings, &choice, &s->specimens, &error);
            watch_finish(&w);
        }
        code = code || !status ? code : cli_status(NAME, status, &error);
    }
    for (size_t i = 0; i < s->n; i++)
        palp_experiment_free(run[i]);
    palp_status status = code == CLI_OK ? take(s) : PALP_OK;
    return code || !status ? code : cli_status(NAME, status, NULL);
}
