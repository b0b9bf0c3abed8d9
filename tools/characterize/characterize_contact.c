/* characterize_contact.c: contacts that differ from run to run, found beside the law and the arms before all other fits. */
#include "characterize.h"

#include <math.h>
#include <stdlib.h>

static const char NAME[] = "characterize";

/* Depth 0 is the contact that was found; what is left of its doubt is its scatter. */
static void move_contacts(characterize_state *s, const palp_lumped_fit *fit) {
    for (size_t r = 0; r < s->n; r++) {
        palp_recording *run = &s->run[r];
        for (size_t i = 0; i < run->n; i++)
            run->depth_m[i] -= fit->contact_m[r];
        run->deepest_m -= fit->contact_m[r];
        run->contact_m += fit->contact_m[r];
        run->contact_sd_m = fmax(fit->contact_scatter_m, fit->contact_sd_m[r]);
    }
}

/* Contacts are judged by the law that is asked for, or by one that can follow any: what a law misses is not to be taken for
 * contacts. Its choice comes after them. */
static void choose_settings(const characterize_options *o, characterize_state *s, palp_characterize_settings *settings) {
    enum { RICH = 5 };
    *settings = characterize_settings(o, PALP_SPRING_LAW, s->n_arms);
    settings->starts = 2;
    palp_status status = o->law_auto ? characterize_guess_polynomial(s, RICH, &settings->law) : characterize_guess(o, s, &settings->law);
    if (status)
        s->contact = PALP_CONTACT_KNOWN; /* no law to judge them by: the fit will say why */
}

/* With the contacts known and not known: they are not, where that leaves less than two thirds of the misfit. */
static palp_status compare(characterize_state *s, palp_characterize_settings *settings, bool automatic, palp_lumped_fit *fit,
                           palp_error *error) {
    palp_lumped_fit known = {0};
    bool wanted = !automatic;
    settings->contact = PALP_CONTACT_KNOWN;
    palp_status status = automatic ? palp_characterize_fit(s->n, s->run, settings, &known, error) : PALP_OK;
    if (status == PALP_OK && (wanted || known.reduced_chi2 > 1.5)) {
        settings->contact = s->contact;
        status = palp_characterize_fit(s->n, s->run, settings, fit, error);
        wanted = wanted || (status == PALP_OK && fit->reduced_chi2 < 0.67 * known.reduced_chi2);
    }
    s->contact = wanted ? s->contact : PALP_CONTACT_KNOWN;
    palp_lumped_fit_free(&known);
    return status;
}

int characterize_contacts(const characterize_options *o, characterize_state *s) {
    enum { FEWEST = 3 };
    static const palp_contact_form forms[] = {PALP_CONTACT_FREE, PALP_CONTACT_KNOWN, PALP_CONTACT_COMMON, PALP_CONTACT_FREE};
    palp_characterize_settings settings;
    palp_error error = {PALP_OK, ""};
    palp_lumped_fit fit = {0};
    bool automatic = o->contact == 0, enough = s->n >= (automatic ? FEWEST : forms[o->contact] == PALP_CONTACT_FREE ? 2 : 1);
    enough = enough && !(automatic && s->n_tip_specimens > 1); /* a stiffer specimen is no earlier contact */
    s->contact = enough && o->method == METHOD_NLOPT ? forms[o->contact] : PALP_CONTACT_KNOWN;
    choose_settings(o, s, &settings);
    if (s->contact == PALP_CONTACT_KNOWN)
        return CLI_OK;
    palp_status status = compare(s, &settings, automatic, &fit, &error);
    if (status == PALP_OK && s->contact != PALP_CONTACT_KNOWN) {
        s->contact_scatter_m = fit.contact_scatter_m;
        move_contacts(s, &fit);
        if (s->contact == PALP_CONTACT_FREE)
            characterize_warn(s, "contacts differ from run to run by %.3g mm (sd): each is found with the model; --contact known takes those of the runs",
                              1e3 * fit.contact_scatter_m);
    }
    palp_lumped_fit_free(&fit);
    return status ? cli_status(NAME, status, &error) : CLI_OK;
}
