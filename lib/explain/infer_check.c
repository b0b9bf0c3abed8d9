/* infer_check.c: cross-validation: each run predicted from the others, or each eighth of a single run. */
#include "infer_answer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { EIGHTHS = 8 };

/* Log determinant of the noise of run r alone, whose columns begin at sample at. */
static palp_status noise_of_run(const infer_fit *fit, const explain_data *data, size_t r, size_t at,
                                double *log_noise) {
    explain_data only = *data;
    explain_run run = data->run[r];
    run.held_out = false;
    only.run = &run;
    only.n_runs = 1;
    only.n = run.n;
    infer_fit part = *fit;
    part.raw = fit->raw + at * fit->m;
    part.sample = fit->sample + at;
    part.product = malloc(fit->m * fit->m * sizeof *part.product);
    palp_status status = part.product ? infer_fit_products(&part, &only) : PALP_ERR_NO_MEMORY;
    *log_noise = part.log_noise;
    free(part.product);
    return status;
}

/* Sum of squared residuals of run r, after the best step of the parameters and of its own. */
static palp_status left_of_run(const infer_fit *fit, const explain_data *data, const infer_posterior *p,
                               size_t r, size_t at, double *squares) {
    const explain_run *run = &data->run[r];
    double own[INFER_BLOCK];
    palp_status status = infer_own(fit, data, p, r, own, NULL);
    const double *column = fit->raw + at * fit->m, *step = p->mean + p->hats;
    for (size_t i = 0; i < run->n && !status; i++) {
        double left = column[(fit->m - 1) * run->n + i];
        for (size_t a = 0; a < fit->k; a++)
            left -= step[a] * column[a * run->n + i];
        for (size_t a = 0; a < INFER_OWN; a++)
            left -= own[a] * column[(fit->k + a) * run->n + i];
        *squares += run->use[i] ? left * left : 0.0;
    }
    return status;
}

static palp_status predict_run(const infer_fit *fit, explain_data *data, size_t r, size_t at, double *score,
                               double *squares) {
    explain_run *run = &data->run[r];
    const bool was = run->held_out;
    infer_posterior with = {.memory = NULL}, without = {.memory = NULL};
    double log_noise;
    palp_status status = noise_of_run(fit, data, r, at, &log_noise);
    run->held_out = false;
    if (!status)
        status = infer_posterior_find(fit, data, &with);
    run->held_out = true;
    if (!status)
        status = infer_posterior_find(fit, data, &without);
    run->held_out = was;
    if (!status)
        status = left_of_run(fit, data, &without, r, at, squares);
    *score = status ? 0.0
                    : infer_log_evidence(fit, &with, with.chi2) -
                          infer_log_evidence(fit, &without, without.chi2) - 0.5 * log_noise;
    infer_posterior_free(&with);
    infer_posterior_free(&without);
    return status;
}

/* The only run, without these of its samples. */
static palp_status predict_block(const infer_fit *fit, const explain_data *data, size_t from, size_t n,
                                 infer_fit *work, double *score) {
    unsigned char *use = data->run[0].use + from, *was = malloc(n);
    if (!was)
        return PALP_ERR_NO_MEMORY;
    memcpy(was, use, n);
    memset(use, 0, n);
    palp_status status = infer_fit_products(work, data);
    if (!status)
        status = infer_fit_score(work, data);
    memcpy(use, was, n);
    free(was);
    *score = status ? 0.0 : fit->promised - work->promised;
    return status;
}

static palp_status predict_eighths(const infer_fit *fit, explain_data *data, infer_left_out *out) {
    infer_fit work;
    palp_status status = infer_fit_copy(fit, data, &work);
    if (status)
        return status;
    out->n = EIGHTHS;
    for (size_t b = 0; b < EIGHTHS && !status; b++) {
        const size_t from = b * data->n / EIGHTHS, to = (b + 1) * data->n / EIGHTHS;
        status = predict_block(fit, data, from, to - from, &work, &out->score[b]);
    }
    infer_fit_free(&work);
    return status;
}

palp_status infer_leave_out(const infer_fit *fit, explain_data *data, infer_left_out *out) {
    const bool each = explain_fitted_runs(data) == data->n_runs, alone = each && data->n_runs == 1;
    double squares = 0.0, count = 0.0;
    *out = (infer_left_out){.score = calloc(data->n_runs + EIGHTHS, sizeof *out->score)};
    palp_status status = out->score ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t r = 0, at = 0; r < data->n_runs && !alone && !status; at += data->run[r++].n) {
        if (!each && !data->run[r].held_out)
            continue;
        status = predict_run(fit, data, r, at, &out->score[out->n++], &squares);
        count += (double)data->run[r].n;
    }
    if (!status && alone)
        status = predict_eighths(fit, data, out);
    out->rms_N = count > 0.0 ? sqrt(squares / count) : 0.0;
    return status;
}

double infer_predicts_better(const infer_left_out *with, const infer_left_out *without, double *se) {
    double sum = 0.0, square = 0.0;
    const double n = (double)with->n;
    for (size_t i = 0; i < with->n; i++)
        sum += with->score[i] - without->score[i];
    for (size_t i = 0; i < with->n; i++)
        square += pow(with->score[i] - without->score[i] - sum / n, 2.0);
    *se = with->n > 1 ? sqrt(square * n / (n - 1.0)) : 0.0;
    return sum;
}

void infer_left_out_free(infer_left_out *left) {
    free(left->score);
    *left = (infer_left_out){.n = 0};
}
