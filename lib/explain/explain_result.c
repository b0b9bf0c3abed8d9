/* explain_result.c: the search's result in the caller's form: the runs with their residuals, and where these
 * are large. */
#include "explain_result.h"
#include "base/file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* All files of a run press the same object. */
static palp_status copy_pressed(const explain_data *data, palp_explanation *e) {
    const explain_joined *joined = &data->joined;
    e->n_inputs = joined->n_inputs;
    e->pressed = calloc(joined->n_inputs, sizeof *e->pressed);
    for (size_t k = 0; k < joined->n && e->pressed; k++)
        for (size_t i = 0; i < joined->n_inputs; i++)
            if (joined->of[i] == joined->first[k])
                e->pressed[i] = data->pressed[k];
    return e->pressed ? PALP_OK : PALP_ERR_NO_MEMORY;
}

palp_status explain_copy_runs(const explain_data *data, palp_explanation *e) {
    e->n_runs = data->n_runs;
    e->run = calloc(data->n_runs, sizeof *e->run);
    if (!e->run)
        return PALP_ERR_NO_MEMORY;
    for (size_t r = 0; r < data->n_runs; r++) {
        const explain_run *from = &data->run[r];
        palp_explain_run *to = &e->run[r];
        size_t bytes = from->n * sizeof *to->time_s;
        memcpy(to->name, from->name, sizeof to->name);
        to->n = from->n;
        to->stiffness = 1.0;
        to->time_s = malloc(5 * bytes);
        if (!to->time_s)
            return PALP_ERR_NO_MEMORY;
        to->depth_m = to->time_s + to->n;
        to->force_N = to->time_s + 2 * to->n;
        to->before_N = to->time_s + 3 * to->n;
        to->after_N = to->time_s + 4 * to->n;
        for (size_t i = 0; i < to->n; i++)
            to->time_s[i] = from->start + from->time[i];
        memcpy(to->depth_m, from->depth, bytes);
        memcpy(to->force_N, from->force, bytes);
    }
    return copy_pressed(data, e);
}

void explain_keep_residual(const double *from, palp_explanation *e, bool before) {
    for (size_t r = 0; r < e->n_runs; from += e->run[r++].n)
        memcpy(before ? e->run[r].before_N : e->run[r].after_N, from, e->run[r].n * sizeof *from);
}

palp_explain_candidate *explain_candidate_of(palp_explanation *e, palp_effect_id id) {
    for (size_t k = 0; k < e->n_candidates; k++)
        if (e->candidate[k].id == id)
            return &e->candidate[k];
    return NULL;
}

/* Shares of the squared gap by run and phase, the largest first; and the remaining share of it there. */
void explain_phase_shares(const explain_data *data, palp_explanation *e, double noise_level_N) {
    double total = 0.0;
    for (size_t r = 0; r < e->n_runs; r++) {
        double sum[PALP_PHASE_COUNT] = {0}, left[PALP_PHASE_COUNT] = {0};
        for (size_t i = 0; i < e->run[r].n; i++) {
            double x = e->run[r].before_N[i], y = e->run[r].after_N[i];
            sum[data->run[r].phase[i]] += x * x - noise_level_N * noise_level_N;
            left[data->run[r].phase[i]] += y * y - noise_level_N * noise_level_N;
        }
        for (int p = 0; p < PALP_PHASE_COUNT; p++) {
            if (!(sum[p] > 0.0))
                continue;
            total += sum[p];
            bool full = e->n_phase_shares == PALP_EXPLAIN_PHASE_SHARES;
            if (full && e->phase_share[e->n_phase_shares - 1].share >= sum[p])
                continue;
            size_t i = full ? e->n_phase_shares - 1 : e->n_phase_shares++;
            for (; i > 0 && e->phase_share[i - 1].share < sum[p]; i--)
                e->phase_share[i] = e->phase_share[i - 1];
            e->phase_share[i] = (palp_explain_phase_share){
                .run = r, .phase = (palp_phase)p, .share = sum[p], .remaining = fmax(0.0, left[p])};
        }
    }
    for (size_t i = 0; i < e->n_phase_shares; i++) {
        e->phase_share[i].share /= total;
        e->phase_share[i].remaining /= total;
    }
}
