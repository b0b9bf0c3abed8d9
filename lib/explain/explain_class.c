/* explain_class.c: which effects are alike here: cosines of what is left of them beside the plain model. */
#include "explain_result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double COSINE = 0.9; /* above it effects are alike, unless the runs clearly prefer one */
static const double LIKELY =
    3.0; /* nats, at least: what the best of all candidates gains by chance may be more */

static double dot(size_t n, const double *a, const double *b) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

static void take_off(size_t n, size_t k, const double *basis, double *v) {
    for (size_t j = 0; j < k; j++) {
        double part = dot(n, basis + j * n, v);
        for (size_t i = 0; i < n; i++)
            v[i] -= part * basis[j * n + i];
    }
}

/* Orthonormal basis [k n] of what the fit's parameters can do to the forces; columns that add nothing are 0.
 */
static palp_status make_basis(const explain_fit *fit, const explain_data *data, double *basis) {
    size_t n = data->n, k = fit->n_columns;
    double *gradient = malloc((k + 1) * data->longest * sizeof *gradient);
    palp_status status = gradient ? PALP_OK : PALP_ERR_NO_MEMORY;
    explain_history history = {.renewed = fit->renewed};
    for (size_t r = 0, at = 0; r < data->n_runs && !status; at += data->run[r++].n) {
        size_t own = data->run[r].n;
        palp_forward_run path = explain_forward_run(&data->run[r], fit->contact[r], &history);
        status = explain_predict(&fit->model, &path, gradient + k * own, gradient, NULL);
        for (size_t j = 0; j < k && !status; j++)
            memcpy(basis + j * n + at, gradient + j * own, own * sizeof *basis);
    }
    palp_load_history_free(&history.load);
    for (size_t j = 0; j < k && !status; j++) {
        double *column = basis + j * n, whole = sqrt(dot(n, column, column));
        take_off(n, j, basis, column);
        take_off(n, j, basis, column);
        double length = sqrt(dot(n, column, column));
        for (size_t i = 0; i < n; i++)
            column[i] = length > 1e-9 * whole ? column[i] / length : 0.0;
    }
    free(gradient);
    return status;
}

static double cosine(size_t n, const double *a, const double *b) {
    double length = sqrt(dot(n, a, a) * dot(n, b, b));
    return length > 0.0 ? dot(n, a, b) / length : 0.0;
}

palp_status explain_class_find(const explain_search *full, const explain_search *rest, double threshold,
                               palp_explain_effect *out) {
    const double likely = fmax(LIKELY, threshold);
    size_t n = full->data.n, k = rest->fit.n_columns;
    palp_effect_id self = out->effect.id;
    const explain_trial *own = &rest->trial[self];
    out->n_class = 1;
    out->alike[0] = self;
    if (effect_row_of(self)->line)
        return PALP_OK;
    double *basis = malloc((k + 2) * n * sizeof *basis), *y = basis ? basis + k * n : NULL,
           *u = basis ? y + n : NULL;
    palp_status status = basis ? make_basis(&rest->fit, &rest->data, basis) : PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n && !status; i++)
        y[i] = full->force[i] - rest->force[i];
    if (!status)
        take_off(n, k, basis, y);
    for (size_t c = 0; c < PALP_EFFECT_COUNT && !status; c++) {
        const explain_trial *t = &rest->trial[c];
        if (c == (size_t)self || effect_row_of((palp_effect_id)c)->line || !t->force)
            continue;
        for (size_t i = 0; i < n; i++)
            u[i] = t->force[i] - rest->force[i];
        take_off(n, k, basis, u);
        explain_pair pair = {.gain = 0.0};
        if (own->fit.product)
            status = explain_paired(&rest->data, &t->fit, &own->fit, &pair);
        bool as_likely = own->fit.product && own->gain - t->gain < likely;
        if (as_likely || (cosine(n, y, u) > COSINE && pair.gain <= fmax(pair.se, likely)))
            out->alike[out->n_class++] = (palp_effect_id)c;
    }
    free(basis);
    return status;
}
