/* characterize_likelihood.c: law, arms, contacts and specimens by the likelihood of palpate explain. */
#include <palpate/explain.h>

#include "characterize.h"
#include "shared/watch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "characterize";

/* ---- the choice ---- */

static palp_status choose(const characterize_options *o, characterize_state *s, palp_explain_choice *choice) {
    palp_status status = PALP_OK;
    choice->least_arms = o->arms_auto ? 0 : o->arms;
    choice->most_arms = o->arms_auto ? PALP_ARMS_MAX : o->arms;
    choice->per_decade = o->per_decade;
    choice->dwell_only = o->dwell_only;
    choice->law = s->law;
    choice->log_odds = s->log_odds;
    choice->no_spline = !o->law_auto;
    if (o->law_auto || o->degree_auto)
        status = characterize_list_laws(o, s);
    else {
        status = characterize_guess(o, s, &s->law[0]);
        s->n_laws = 1;
    }
    choice->n_laws = s->n_laws;
    return status;
}

/* ---- the result ---- */

/* Makes depth 0 the fitted contact, whose uncertainty is then the scatter. */
static void move_contacts(characterize_state *s) {
    const palp_lumped_fit *fit = &s->final;
    for (size_t r = 0; r < s->n; r++) {
        palp_recording *run = &s->run[r];
        const double sd = fmax(fit->contact_scatter_m, fit->contact_sd_m[r]);
        for (size_t i = 0; i < run->n; i++)
            run->depth_m[i] -= fit->contact_m[r];
        run->deepest_m -= fit->contact_m[r];
        run->contact_m += fit->contact_m[r];
        run->contact_sd_m = sd > 0.0 ? sd : run->contact_sd_m; /* 0: it was known */
    }
}

/* Contacts that the fit found to differ. */
static void tell_contacts(characterize_state *s) {
    bool differ = false;
    for (size_t r = 0; r < s->n; r++)
        differ = differ || s->final.contact_sd_m[r] > 0.0;
    if (s->contact != PALP_CONTACT_FREE)
        return;
    if (s->n < 2 || !differ)
        s->contact = PALP_CONTACT_KNOWN;
    else
        characterize_warn(s,
                          "contact differs between runs by %.3g mm (sd) and is fitted with the model; "
                          "--contact known takes it from the recordings",
                          1e3 * s->contact_scatter_m);
}

static void take(characterize_state *s) {
    for (size_t k = 0; k < s->n_specimens; k++)
        s->factor[k] = 1.0;
    characterize_take_spread(s);
    s->has_final = true;
    s->material = s->final.material;
    s->n_arms = s->material.n_arms;
    if (s->material.law.kind == PALP_LAW_POLYNOMIAL)
        s->degree = s->material.law.n;
    s->contact_scatter_m = s->final.contact_scatter_m;
    move_contacts(s);
    tell_contacts(s);
    memset(s->final.contact_m, 0, s->n * sizeof *s->final.contact_m);
}

/* Whether all runs have one specimen and tip. Otherwise a stiffer specimen or wider tip would look like an
 * earlier contact. */
static bool alike(const characterize_state *s) {
    bool same = s->n_tip_specimens < 2;
    for (size_t i = 1; i < s->n && s->has_tip; i++)
        same = same && s->tip[i].tip == s->tip[0].tip && s->tip[i].radius_m == s->tip[0].radius_m &&
               s->tip[i].half_angle_rad == s->tip[0].half_angle_rad;
    return same;
}

int characterize_likelihood(const characterize_options *o, characterize_state *s) {
    static const palp_contact_form forms[] = {PALP_CONTACT_FREE, PALP_CONTACT_KNOWN, PALP_CONTACT_COMMON,
                                              PALP_CONTACT_FREE};
    palp_error error = {PALP_OK, ""};
    palp_explain_settings settings = palp_explain_settings_default();
    palp_explain_choice choice = {.n_laws = 0};
    settings.contact = s->contact = o->contact == 0 && !alike(s) ? PALP_CONTACT_KNOWN : forms[o->contact];
    palp_status status = choose(o, s, &choice);
    if (status == PALP_ERR_INPUT)
        return cli_failure(NAME, "%s: --law needs the specimen's radius; add a line # specimen.radius_mm: R",
                           s->run[0].name);
    if (!status) {
        watch w;
        watch_start(&w, NAME, &settings);
        status =
            palp_explain_recordings(s->n, s->run, s->specimen, &settings, &choice, &s->specimens, &error);
        watch_finish(&w);
    }
    if (status)
        return cli_status(NAME, status, &error);
    take(s);
    return CLI_OK;
}
