/* explain_order.c: the runs in the order of their recording, and which of them press a new specimen. */
#include "explain_data.h"

#include <math.h>
#include <string.h>

double explain_number_of(const palp_experiment *e, const char *key, double otherwise) {
    double value;
    return palp_experiment_get_number(e, key, &value) ? otherwise : value;
}

const char *explain_text_of(const palp_experiment *e, const char *key) {
    const char *text;
    return palp_experiment_get_string(e, key, &text) ? "" : text;
}

bool explain_same_specimen(const palp_experiment *a, const palp_experiment *b) {
    return strcmp(explain_text_of(a, "specimen.name"), explain_text_of(b, "specimen.name")) == 0;
}

/* When it began; NAN: not known. */
static double start_of(const palp_experiment *e) {
    return explain_number_of(e, "session.start_s", NAN);
}

/* Specimens in the order of their first runs; runs of one by their times, if both have one. */
void explain_order_find(size_t n, const palp_explain_input *inputs, size_t *order, bool *fresh) {
    size_t count = 0;
    for (size_t i = 0; i < n; i++) {
        const palp_experiment *e = inputs[i].experiment;
        size_t at = count;
        while (at > 0 && !explain_same_specimen(inputs[order[at - 1]].experiment, e))
            at--;
        at = at > 0 ? at : count; /* after the last of its specimen */
        while (at > 0 && explain_same_specimen(inputs[order[at - 1]].experiment, e) &&
               start_of(e) < start_of(inputs[order[at - 1]].experiment))
            at--;
        memmove(order + at + 1, order + at, (count - at) * sizeof *order);
        order[at] = i;
        count++;
    }
    for (size_t i = 0; i < n; i++) {
        const palp_experiment *e = inputs[order[i]].experiment,
                              *before = i ? inputs[order[i - 1]].experiment : NULL;
        fresh[i] = !before || !explain_same_specimen(before, e) || !(start_of(e) > start_of(before));
    }
}
