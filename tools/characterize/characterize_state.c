/* characterize_state.c: queries of the state of palpate characterize, and warnings. */
#include "characterize.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const char NAME[] = "characterize";

const palp_lumped_fit *characterize_fit_of(const characterize_state *s) {
    return s->has_final ? &s->final : &s->shared;
}

bool characterize_took(const characterize_state *s, size_t k) {
    return s->material.law.kind == s->law[k].kind && s->material.law.n == s->law[k].n;
}

double characterize_strain_max(const characterize_state *s) {
    double most = 0;
    for (size_t i = 0; i < s->n; i++)
        most = fmax(most, s->run[i].deepest_m / s->run[i].height_m);
    return most;
}

double characterize_total(const palp_lumped_fit *fit) {
    double sum = 0;
    for (size_t i = 0; i < fit->n_runs; i++)
        sum += fit->absolute_N[i];
    return sum;
}

double characterize_noise_ratio(const palp_lumped_fit *fit, size_t run, const palp_recording *r) {
    return r->noise_N > 0 ? fit->rms_N[run] / r->noise_N : NAN;
}

void characterize_warn(characterize_state *s, const char *format, ...) {
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    cli_warning(NAME, "%s", text);
    if (s->n_warnings < CHARACTERIZE_WARNINGS_MAX)
        memcpy(s->warning[s->n_warnings++], text, sizeof text);
}

/* Fits with a constant spring for each run use the dwell only, as K(e) is not constant on the ramp
 * (Section 4.3.3). The joint law also uses the ramp. */
palp_characterize_settings characterize_settings(const characterize_options *o, palp_spring_form spring,
                                                 size_t n_arms) {
    palp_characterize_settings settings = palp_characterize_settings_default();
    settings.spring = spring;
    settings.n_arms = n_arms;
    settings.dwell_only = o->dwell_only || spring == PALP_SPRING_PER_RUN;
    return settings;
}

/* Number of different depths of dwells, within 2 %: the data for a polynomial without a static run. A press
 * of another kind counts as three, enough for a quadratic. */
size_t characterize_depths(const characterize_state *s) {
    size_t count = 0;
    double last = 0;
    for (size_t i = s->n_static; i < s->n; i++) {
        bool other = s->run[i].kind >= PALP_RECORDING_OTHER;
        if (other || s->run[i].deepest_m > 1.02 * last) {
            count += other ? 3 : 1;
            last = other ? last : s->run[i].deepest_m;
        }
    }
    return count;
}
