/* machine_result.c: results of a step, on the terminal and as JSON, and questions to the user. */
#include "calibrate_device.h"
#include "shared/json_out.h"

#include <math.h>

static const char NAME[] = MACHINE_NAME;

void machine_tell(machine_result *r, const char *name, double value, double half, const char *what) {
    json_t *one = json_object();
    json_figures(one, {"value", value}, {"low", value - half}, {"high", value + half});
    if (!r->figures)
        r->figures = json_object();
    json_object_set_new(r->figures, name, one);
    if (isfinite(half))
        fprintf(stderr, "%-20s %.6g, %.6g to %.6g: %s\n", name, value, value - half, value + half, what);
    else
        fprintf(stderr, "%-20s %.4g: %s\n", name, value, what);
}

int machine_finish(const machine_options *o, machine_result *r, int code) {
    json_t *all = json_pack("{s{si} ss so sb}", "palpate", "calibrate_device", 1, "step", r->step, "figures",
                            r->figures ? r->figures : json_object(), "kept", code == CLI_OK);
    r->figures = NULL;
    if (o->json) {
        int printed = json_print(NAME, all);
        return code ? code : printed;
    }
    json_decref(all);
    return code;
}

bool machine_ready(const char *prompt) {
    int c;
    fprintf(stderr, "%s\n", prompt);
    while ((c = getchar()) != EOF && c != '\n')
        ;
    return c == '\n';
}

bool machine_ready_unless(const machine_options *o, const char *prompt) {
    return o->yes || machine_ready(prompt);
}

int machine_ended(session *s, outcome end) {
    char words[ACQUIRE_WORDS];
    acquire_live_end(&s->live);
    int code = session_words(s, end, words);
    if (words[0])
        cli_failure(NAME, "%s", words);
    return code;
}
