/* explain_join.c: recordings that go on in another file are taken as one run. */
#include "explain_data.h"

#include <stdlib.h>
#include <string.h>

/* The first run among these that j continues; n: none. */
static size_t before(size_t n, const palp_explain_input *run, size_t j) {
    for (size_t i = 0; i < n; i++)
        if (palp_experiment_continues(run[i].experiment, run[j].experiment))
            return i;
    return n;
}

/* Run j goes on at the end of run i. */
static palp_status append(explain_joined *joined, size_t n, size_t i, size_t j) {
    palp_experiment *both = NULL;
    palp_status status = palp_experiment_join(joined->input[i].experiment, joined->input[j].experiment, &both);
    if (status)
        return status;
    palp_experiment_free(joined->made[i]);
    palp_experiment_free(joined->made[j]);
    joined->made[i] = both;
    joined->input[i].experiment = both;
    joined->n--;
    for (size_t k = j; k < joined->n; k++) {
        joined->input[k] = joined->input[k + 1];
        joined->made[k] = joined->made[k + 1];
    }
    joined->made[joined->n] = NULL;
    for (size_t k = 0; k < n; k++) {
        joined->of[k] = joined->of[k] == j ? i : joined->of[k];
        joined->of[k] -= joined->of[k] > j;
    }
    return PALP_OK;
}

palp_status explain_join(size_t n, const palp_explain_input *inputs, explain_joined *joined) {
    *joined = (explain_joined){.n = n, .input = malloc(n * sizeof *joined->input), .of = malloc(n * sizeof *joined->of),
                               .made = calloc(n, sizeof *joined->made)};
    if (!joined->input || !joined->of || !joined->made)
        return PALP_ERR_NO_MEMORY;
    memcpy(joined->input, inputs, n * sizeof *inputs);
    for (size_t i = 0; i < n; i++)
        joined->of[i] = i;
    palp_status status = PALP_OK;
    for (size_t j = 0; j < joined->n && !status;) {
        size_t i = before(joined->n, joined->input, j);
        if (i < joined->n)
            status = append(joined, n, i, j);
        j = i < joined->n ? 0 : j + 1;
    }
    return status;
}

void explain_joined_free(explain_joined *joined) {
    for (size_t i = 0; joined->made && i < joined->n; i++)
        palp_experiment_free(joined->made[i]);
    free(joined->made);
    free(joined->input);
    free(joined->of);
    *joined = (explain_joined){0};
}
