/* characterize_contact.c: contacts that differ from run to run, found together with the law and the arms
 * before all other fits. */
#include "characterize.h"

#include <math.h>
#include <stdlib.h>

static const char NAME[] = "characterize";

void characterize_move_contacts(characterize_state *s, const palp_lumped_fit *fit) {
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

/* Contact shifts are estimated with the requested law, or with a flexible one: misfit of a law would look
 * like shifts. The law is chosen afterwards. */
static void choose_settings(const characterize_options *o, characterize_state *s,
                            palp_characterize_settings *settings) {
    enum { RICH = 5 };
    *settings = characterize_settings(o, PALP_SPRING_LAW, s->n_arms);
    settings->starts = 2;
    palp_status status = o->law_auto ? characterize_guess_polynomial(s, RICH, &settings->law)
                                     : characterize_guess(o, s, &settings->law);
    if (status)
        s->contact = PALP_CONTACT_KNOWN; /* no law is possible: the fit will report why */
}

/* Whether all runs have one specimen and tip. Otherwise a stiffer specimen or wider tip would look like an
 * earlier contact. */
static bool alike(const characterize_state *s) {
    bool same = s->n_tip_specimens < 2 && s->n_specimens < s->n;
    for (size_t i = 1; i < s->n && s->has_tip; i++)
        same = same && s->tip[i].tip == s->tip[0].tip && s->tip[i].radius_m == s->tip[0].radius_m &&
               s->tip[i].half_angle_rad == s->tip[0].half_angle_rad;
    return same;
}

int characterize_contacts(const characterize_options *o, characterize_state *s) {
    static const palp_contact_form forms[] = {PALP_CONTACT_AUTO, PALP_CONTACT_KNOWN, PALP_CONTACT_COMMON,
                                              PALP_CONTACT_FREE};
    palp_characterize_settings settings;
    palp_error error = {PALP_OK, ""};
    palp_lumped_fit fit = {0};
    palp_contact_form form = o->method == METHOD_NLOPT ? forms[o->contact] : PALP_CONTACT_KNOWN;
    s->contact = (form == PALP_CONTACT_AUTO && !alike(s)) || (form != PALP_CONTACT_COMMON && s->n < 2)
                     ? PALP_CONTACT_KNOWN
                     : form;
    choose_settings(o, s, &settings);
    if (s->contact == PALP_CONTACT_KNOWN)
        return CLI_OK;
    settings.contact = s->contact;
    palp_status status = palp_characterize_fit(s->n, s->run, &settings, &fit, &error);
    if (s->contact == PALP_CONTACT_AUTO)
        s->contact = fit.contact_m ? PALP_CONTACT_FREE : PALP_CONTACT_KNOWN;
    if (status == PALP_OK && s->contact != PALP_CONTACT_KNOWN) {
        s->contact_scatter_m = fit.contact_scatter_m;
        characterize_move_contacts(s, &fit);
        if (s->contact == PALP_CONTACT_FREE)
            characterize_warn(s,
                              "contact differs between runs by %.3g mm (sd) and is fitted with the model; "
                              "--contact known takes it from the recordings",
                              1e3 * fit.contact_scatter_m);
    }
    palp_lumped_fit_free(&fit);
    return status ? cli_status(NAME, status, &error) : CLI_OK;
}
