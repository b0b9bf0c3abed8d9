/* explain_widen.c: by how much what a fit leaves widens the scatter of one of its parameters. */
#include "explain_search.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* An estimate is off by the sum of influence times what is left. Of noise alone the squares of that sum over
 * stretches of the runs add up to the sum of squared influence; what a wrong model leaves adds up to more
 * where the estimate leans on it. */
typedef struct influence {
    const explain_fit *fit;
    const explain_data *data;
    double unit[EXPLAIN_COLUMNS]; /* column of the inverse normal matrix */
    double noise, found;          /* variance as noise has it, and as the stretches show it */
} influence;

enum { STRETCHES = 12 };

/* Adds the nuisance parameters' share of the run's columns times unit, with the opposite sign: own[]. */
static void respond(const influence *f, size_t r, double own[EXPLAIN_NUISANCES]) {
    const explain_fit *fit = f->fit;
    const double *product = fit->product + r * fit->m * fit->m;
    double pull[EXPLAIN_NUISANCES];
    for (size_t q = 0; q < EXPLAIN_NUISANCES; q++) {
        pull[q] = 0.0;
        for (size_t k = 0; k < fit->n_columns; k++)
            pull[q] += f->unit[k] * product[k * fit->m + fit->n_columns + q];
    }
    explain_nuisances_for(fit, r, pull, own);
}

static void add_run(void *user, size_t r, const double *column) {
    influence *f = user;
    const explain_fit *fit = f->fit;
    const size_t n = f->data->run[r].n, k = fit->n_columns;
    double own[EXPLAIN_NUISANCES], sd[EXPLAIN_NUISANCES], away[EXPLAIN_NUISANCES];
    if (f->data->run[r].held_out)
        return;
    explain_nuisances(fit, r, own, sd);
    respond(f, r, away);
    for (size_t b = 0; b < STRETCHES; b++) {
        double sum = 0.0;
        for (size_t i = b * n / STRETCHES; i < (b + 1) * n / STRETCHES; i++) {
            double weight = 0.0, left = column[(fit->m - 1) * n + i];
            for (size_t c = 0; c < k; c++)
                weight += f->unit[c] * column[c * n + i];
            for (size_t q = 0; q < EXPLAIN_NUISANCES; q++) {
                weight -= away[q] * column[(k + q) * n + i];
                left -= own[q] * column[(k + q) * n + i];
            }
            sum += weight * left;
            f->noise += weight * weight;
        }
        f->found += sum * sum;
    }
}

palp_status explain_widening(explain_fit *fit, const explain_data *data, size_t at, double *widening) {
    const size_t k = fit->n_columns;
    double *h = malloc((2 * k * k + 2 * k) * sizeof *h), chi2;
    *widening = 1.0;
    if (!h)
        return PALP_ERR_NO_MEMORY;
    influence f = {.fit = fit, .data = data};
    explain_fit_total(fit, data, h, h + k * k, &chi2, h + k * k + k);
    f.unit[at] = 1.0;
    palp_status status = PALP_OK;
    if (dense_cholesky(k, h)) {
        dense_cholesky_solve(k, h, 1, f.unit);
        status = explain_fit_visit(fit, data, NULL, NULL, add_run, &f);
    }
    if (f.noise > 0.0)
        *widening = fmax(1.0, f.found / f.noise);
    free(h);
    return status;
}
