/* explain_cross.c: how well a fit to the other runs predicts each. */
#include "explain_fit.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Log score of run r, whose sums are among h and g if counted, predicted by a fit to the others. work: [3 k k + 3 k]. */
static double predicted_score(const explain_fit *fit, size_t r, bool counted, const double *h, const double *g,
                              double *work) {
    size_t k = fit->n_columns;
    double *own = work, *rest = own + k * k, *factor = rest + k * k, *own_g = factor + k * k, *move = own_g + k,
           *after = move + k, chi2, logdet, share = counted ? 1.0 : 0.0;
    explain_normal_of(fit, r, own, own_g, &chi2, &logdet);
    for (size_t i = 0; i < k * k; i++)
        rest[i] = h[i] - share * own[i];
    for (size_t i = 0; i < k; i++) { /* a coordinate on its bound stays there */
        bool stuck = fit->x[i] <= fit->low[i] || fit->x[i] >= fit->high[i];
        move[i] = stuck ? 0.0 : g[i] - share * own_g[i];
        rest[i * k + i] += 1e-9 * h[i * k + i];
        for (size_t j = 0; j < k && stuck; j++)
            rest[i * k + j] = rest[j * k + i] = 0.0;
        if (stuck)
            rest[i * k + i] = 1e30;
    }
    memcpy(factor, rest, k * k * sizeof *factor);
    if (!dense_cholesky(k, factor))
        return -HUGE_VAL;
    dense_cholesky_solve(k, factor, 1, move);
    logdet -= dense_log_determinant(k, factor);
    for (size_t i = 0; i < k; i++) {
        after[i] = own_g[i];
        for (size_t j = 0; j < k; j++)
            after[i] -= own[i * k + j] * move[j];
        chi2 -= move[i] * (own_g[i] + after[i]);
    }
    for (size_t i = 0; i < k * k; i++)
        factor[i] = rest[i] + own[i];
    if (!dense_cholesky(k, factor))
        return -HUGE_VAL;
    logdet += dense_log_determinant(k, factor);
    dense_forward(k, factor, 1, after);
    return -0.5 * (chi2 - dense_dot(k, after, after) + logdet);
}

palp_status explain_fit_leave_out(const explain_fit *fit, const explain_data *data, double *score) {
    size_t k = fit->n_columns;
    double *h = malloc((4 * k * k + 5 * k) * sizeof *h), chi2;
    if (!h)
        return PALP_ERR_NO_MEMORY;
    double *g = h + k * k, *work = g + k;
    explain_fit_total(fit, data, h, g, &chi2, work);
    for (size_t r = 0; r < data->n_runs; r++)
        score[r] = predicted_score(fit, r, !data->run[r].held_out, h, g, work);
    free(h);
    return PALP_OK;
}

palp_status explain_paired(const explain_data *data, const explain_fit *a, const explain_fit *b, explain_pair *pair) {
    size_t n = data->n_runs, counted = 0;
    double *score = malloc(2 * n * sizeof *score), squares = 0.0, most = -HUGE_VAL;
    if (!score)
        return PALP_ERR_NO_MEMORY;
    palp_status status = explain_fit_leave_out(a, data, score);
    if (!status)
        status = explain_fit_leave_out(b, data, score + n);
    *pair = (explain_pair){.gain = 0.0};
    for (size_t r = 0; r < n; r++) {
        if (data->run[r].held_out)
            continue;
        score[r] = fmax(score[n + r], -1e12) - fmax(score[r], -1e12);
        pair->gain += score[r];
        most = fmax(most, score[r]);
        counted++;
    }
    for (size_t r = 0; r < n; r++)
        squares += data->run[r].held_out ? 0.0 : pow(score[r] - pair->gain / (double)counted, 2);
    pair->rest = pair->gain - most;
    pair->se = counted > 1 ? sqrt(squares * (double)counted / (double)(counted - 1)) : 0.0;
    free(score);
    return status;
}
