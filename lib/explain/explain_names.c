/* explain_names.c: default settings, names of verdicts and objects, and the release of a result. */
#include <palpate/explain.h>

#include <stdlib.h>
#include <string.h>

palp_explain_settings palp_explain_settings_default(void) {
    palp_explain_settings s = {.contact = PALP_CONTACT_FREE, .max_effects = 4, .false_alarm = 0.05};
    memset(s.candidate, 1, sizeof s.candidate);
    return s;
}

const char *palp_explain_verdict_name(palp_explain_verdict verdict) {
    static const char *const names[] = {"agrees",      "explained", "ambiguous",
                                        "unexplained", "suspected", "another_law"};
    return (unsigned)verdict < sizeof names / sizeof *names ? names[verdict] : "unknown";
}

const char *palp_explain_object_name(palp_explain_object object) {
    static const char *const names[] = {"specimen", "air", "block"};
    return (unsigned)object < sizeof names / sizeof *names ? names[object] : "unknown";
}

void palp_explanation_free(palp_explanation *e) {
    if (!e)
        return;
    for (size_t r = 0; e->run && r < e->n_runs; r++)
        free(e->run[r].time_s);
    free(e->run);
    free(e->pressed);
    free(e->event);
    free(e->step);
    free(e->specimens.between);
    memset(e, 0, sizeof *e);
}
