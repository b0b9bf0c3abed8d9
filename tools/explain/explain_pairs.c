/* explain_pairs.c: which simulated run goes with which measured one. */
#include "explain.h"

#include <string.h>

/* The word before number i that has its name, without folders; i: there is none. */
static size_t earlier_of_name(const explain_options *o, size_t i) {
    size_t k = 0;
    while (k < i && strcmp(cli_base(o->words[k]), cli_base(o->words[i])) != 0)
        k++;
    return k;
}

static size_t later_of_name(const explain_options *o, size_t i) {
    size_t k = i + 1;
    while (k < o->n_words && strcmp(cli_base(o->words[k]), cli_base(o->words[i])) != 0)
        k++;
    return k;
}

/* Of two words of one name the first is the simulated run. A word without a partner is a run without one. */
static void pair_by_name(explain_options *o) {
    size_t n = 0;
    bool simulated[2 * EXPLAIN_RUNS_MAX];
    for (size_t i = 0; i < o->n_words; i++)
        simulated[i] = earlier_of_name(o, i) == i && later_of_name(o, i) < o->n_words;
    for (size_t i = 0; i < o->n_words; i++)
        if (simulated[i])
            o->simulated_files[o->n_simulated++] = o->words[i];
    for (size_t i = 0; i < o->n_words; i++) {
        size_t k = 0;
        while (k < o->n_simulated && strcmp(cli_base(o->simulated_files[k]), cli_base(o->words[i])) != 0)
            k++;
        if (simulated[i])
            continue;
        o->simulated_of[n] = k;
        o->words[n++] = o->words[i];
    }
    o->n_words = n;
}

static int pair_by_order(const char *command, explain_options *o) {
    if (o->n_words % 2)
        return cli_usage_error(command,
                               "--simulated: no two of the %zu files have one name, and their number is odd: "
                               "give a simulated file for each run",
                               o->n_words);
    o->n_simulated = o->n_words /= 2;
    for (size_t r = 0; r < o->n_words; r++) {
        o->simulated_files[r] = o->words[r];
        o->words[r] = o->words[o->n_words + r];
        o->simulated_of[r] = r;
        cli_note(command, "%s is taken for the simulation of %s, by their order", o->simulated_files[r],
                 o->words[r]);
    }
    return CLI_OK;
}

int explain_pair(const char *command, explain_options *o) {
    size_t pairs = 0;
    for (size_t i = 0; i < o->n_words && o->simulated; i++) {
        const size_t first = earlier_of_name(o, i);
        pairs += first < i;
        if (first < i && later_of_name(o, first) < i)
            return cli_usage_error(command, "--simulated: more than two files are called %s",
                                   cli_base(o->words[i]));
    }
    if (pairs == 0 && o->simulated)
        return pair_by_order(command, o);
    if (pairs > 0 && o->n_words - pairs <= EXPLAIN_RUNS_MAX)
        pair_by_name(o);
    return o->n_words <= EXPLAIN_RUNS_MAX ? CLI_OK
                                          : cli_usage_error(command, "more than %d runs", EXPLAIN_RUNS_MAX);
}
