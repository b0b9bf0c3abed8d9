/* explain.h: the parts of palpate explain. */
#ifndef PALPATE_TOOL_EXPLAIN_H
#define PALPATE_TOOL_EXPLAIN_H

#include "shared/cli.h"
#include "shared/plot.h"

#include <jansson.h>
#include <palpate/palpate.h>
#include <palpate/explain.h>

enum { EXPLAIN_RUNS_MAX = 512 };

typedef struct explain_options {
    const char *words[2 * EXPLAIN_RUNS_MAX], *model, *hold_out, *candidates, *out, *result, *report, *next;
    size_t n_words, max_effects, jobs, every; /* every: as open_runs takes it */
    int contact;                              /* a palp_contact_form */
    double false_alarm, good_enough;
    palp_explain_limits limits; /* in mm and mm/s */
    bool json, simulated, sparse;
    size_t n_simulated;
    const char *simulated_files[EXPLAIN_RUNS_MAX]; /* [n_simulated] */
    size_t simulated_of[EXPLAIN_RUNS_MAX]; /* [n_words] the one of each run; n_simulated: it has none */
    char command[CLI_COMMAND_MAX];
} explain_options;

/* Takes the simulated files out of the words, and pairs them with the runs. Returns an exit code.
 * (explain_pairs.c) */
int explain_pair(const char *command, explain_options *o);

/* The result as JSON; NULL = out of memory. (explain_json.c) */
json_t *explain_json(const explain_options *o, const palp_explanation *e);

/* rms of recorded minus model by run, depth and speed, as given and with the effects. (explain_profile.c) */
json_t *explain_profile(const palp_explanation *e);

/* Amplitudes of waves in it over time and over depth. (explain_spectrum.c) */
json_t *explain_spectrum(const palp_explanation *e);

/* The free terms: tables with their bands, with o->sparse their formulas. And in sentences. (explain_free.c)
 */
json_t *explain_free(const explain_options *o, const palp_explanation *e);
void explain_free_say(json_t *story, const json_t *all);

/* The next experiment as a protocol file. */
json_t *explain_protocol(const palp_explanation *e);

/* Adds sentences, next_sentence and catalogue to the result, which has all else; and says them on a terminal,
 * with effects and candidates. (explain_words.c) */
void explain_add_words(json_t *result);
void explain_say(FILE *to, const json_t *result);

/* Recorded minus model, a figure explain_residuals for each run. (explain_figure.c) */
void explain_figures(json_t *figures, const palp_explanation *e);

#endif
