/* explain_join.c: recordings that continue in another file are one run. */
#include "explain_data.h"

#include <stdlib.h>

palp_status explain_join(size_t n, const palp_explain_input *inputs, explain_joined *joined) {
    *joined = (explain_joined){.n_inputs = n,
                               .input = malloc(n * sizeof *joined->input),
                               .made = malloc(n * sizeof *joined->made),
                               .of = malloc(n * sizeof *joined->of),
                               .first = malloc(n * sizeof *joined->first)};
    const palp_experiment **run = malloc(n * sizeof *run);
    palp_status status =
        joined->input && joined->made && joined->of && joined->first && run ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n && !status; i++)
        run[i] = inputs[i].experiment;
    if (!status)
        status = palp_experiment_join(n, run, joined->made, joined->of);
    for (size_t i = 0; i < n && !status; i++) {
        if (joined->of[i] != i)
            continue;
        size_t k = joined->n++;
        joined->input[k] = inputs[i];
        joined->made[k] = joined->made[i];
        joined->first[k] = i;
        if (joined->made[k])
            joined->input[k].experiment = joined->made[k];
    }
    free(run);
    return status;
}

void explain_joined_free(explain_joined *joined) {
    for (size_t i = 0; i < joined->n; i++)
        palp_experiment_free(joined->made[i]);
    free(joined->input);
    free(joined->made);
    free(joined->of);
    free(joined->first);
    *joined = (explain_joined){0};
}
