/* characterize_state.c: what is asked of the state of palpate characterize, and warnings. */
#include "characterize.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const char NAME[] = "characterize";

const char *characterize_kind(const palp_recording *r) {
    static const char *const kinds[] = {"static", "ramp_hold", "other"};
    return kinds[r->kind];
}

const char *characterize_rule(const palp_recording *r) {
    static const char *const rules[] = {"given", "free air", "nominal"};
    return rules[r->contact_rule];
}

const palp_lumped_fit *characterize_fit_of(const characterize_state *s) {
    return s->has_final ? &s->final : &s->shared;
}

double characterize_strain_max(const characterize_state *s) {
    double most = 0;
    for (size_t i = 0; i < s->n; i++) {
        most = fmax(most, s->run[i].deepest_m / s->run[i].height_m);
    }
    return most;
}

double characterize_total(const palp_lumped_fit *fit) {
    double sum = 0;
    for (size_t i = 0; i < fit->n_runs; i++) {
        sum += fit->absolute_N[i];
    }
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
    if (s->n_warnings < CHARACTERIZE_WARNINGS_MAX) {
        memcpy(s->warning[s->n_warnings++], text, sizeof text);
    }
}
