/* explain_improve.c: the steps to a fit's best parameters, and what they would be without a run. */
#include "explain_internal.h"
#include "base/dense.h"
#include "model/model_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- towards the best parameters ---- */

/* A law that falls below a little of its stiffness before PALP_MODEL_STRAIN makes no model: a wall there, stiff beside
 * any data. */
static void add_wall(const explain_fit *fit, const explain_data *data, double *h, double *g, double *chi2) {
    enum { PLACES = 200 };
    const palp_law *law = &fit->model.material.law;
    double typical = data->peak * data->height / data->deepest, low = 1e-3 * typical, sd = 1e-7 * typical;
    double row[PALP_LAW_MAX], stiffness;
    for (int i = 0; i <= PLACES; i++) {
        double e = fmax(1e-6, PALP_MODEL_STRAIN * i / PLACES);
        palp_law_stiffness(law, e, &stiffness, NULL);
        if (!(stiffness < low))
            continue;
        palp_law_gradient(law, e, row);
        *chi2 += pow((low - stiffness) / sd, 2);
        for (size_t a = 0; a < law->n; a++) {
            g[a] += (low - stiffness) / sd * row[a] / e / sd;
            for (size_t b = 0; b < law->n; b++)
                h[a * fit->n_columns + b] += row[a] / e / sd * row[b] / e / sd;
        }
    }
}

void explain_fit_total(const explain_fit *fit, const explain_data *data, double *h, double *g, double *chi2,
                       double *work) {
    size_t k = fit->n_columns;
    memset(h, 0, k * k * sizeof *h);
    memset(g, 0, k * sizeof *g);
    *chi2 = 0.0;
    for (size_t r = 0; r < data->n_runs; r++) {
        double own, logdet;
        if (data->run[r].held_out)
            continue;
        explain_normal_of(fit, r, work, work + k * k, &own, &logdet);
        for (size_t i = 0; i < k * k; i++)
            h[i] += work[i];
        for (size_t i = 0; i < k; i++)
            g[i] += work[k * k + i];
        *chi2 += own;
    }
    for (size_t i = 0; i < k; i++)
        h[i * k + i] += 1.0 / (fit->unit[i] * fit->unit[i]);
    add_wall(fit, data, h, g, chi2);
}

/* (H + damping diag H) step = g without the coordinates that lie on a bound and are pushed out. work: [k k]. */
static void step_of(const explain_fit *fit, const double *h, const double *g, double damping, double *work,
                    double *step) {
    size_t k = fit->n_columns;
    memcpy(work, h, k * k * sizeof *work);
    for (size_t i = 0; i < k; i++) {
        bool stuck = (fit->x[i] <= fit->low[i] && g[i] <= 0.0) || (fit->x[i] >= fit->high[i] && g[i] >= 0.0);
        step[i] = stuck ? 0.0 : g[i];
        work[i * k + i] *= 1.0 + damping;
        for (size_t j = 0; j < k && stuck; j++)
            work[i * k + j] = work[j * k + i] = 0.0;
        if (stuck || !(work[i * k + i] > 0.0))
            work[i * k + i] = 1.0;
    }
    if (dense_cholesky(k, work))
        dense_cholesky_solve(k, work, 1, step);
    else
        memset(step, 0, k * sizeof *step);
}

palp_status explain_fit_predict(const explain_fit *fit, const explain_data *data, double *chi2) {
    size_t k = fit->n_columns;
    double *h = malloc((2 * k * k + 3 * k) * sizeof *h);
    if (!h)
        return PALP_ERR_NO_MEMORY;
    double *work = h + k * k, *g = work + k * k + k, *step = g + k;
    explain_fit_total(fit, data, h, g, chi2, work);
    step_of(fit, h, g, 1e-9, work, step);
    for (size_t i = 0; i < k; i++)
        *chi2 -= step[i] * g[i];
    free(h);
    return PALP_OK;
}

palp_status explain_fit_improve(explain_fit *fit, const explain_data *data, size_t rounds) {
    size_t k = fit->n_columns, bytes = data->n_runs * fit->m * fit->m * sizeof *fit->product;
    double *h = malloc((4 * k * k + 4 * k) * sizeof *h), *product = malloc(bytes), damping = 1e-6, chi2 = 0.0;
    palp_model *kept = malloc(sizeof *kept);
    palp_status status = h && product && kept ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status) {
        double *g = h + k * k, *step = g + k, *x = step + k, *work = x + k;
        explain_fit_total(fit, data, h, g, &chi2, work);
        for (size_t round = 0; round < rounds && !status; round++) {
            double next;
            step_of(fit, h, g, damping, work, step);
            memcpy(x, fit->x, k * sizeof *x);
            memcpy(product, fit->product, bytes);
            *kept = fit->model;
            for (size_t i = 0; i < k; i++) {
                double most = fit->logarithmic[i] ? 1.0 : HUGE_VAL;
                fit->x[i] = fmin(fit->high[i], fmax(fit->low[i], x[i] + fmax(-most, fmin(most, step[i]))));
            }
            palp_status tried = explain_fit_to_model(fit);
            tried = tried ? tried : explain_fit_products(fit, data, NULL);
            if (tried == PALP_ERR_NO_MEMORY)
                status = tried;
            if (!tried)
                explain_fit_total(fit, data, h, g, &next, work);
            if (!tried && next < chi2) {
                double gain = chi2 - next;
                chi2 = next;
                damping = fmax(1e-9, 0.1 * damping);
                if (gain < 0.02 + 1e-7 * chi2)
                    break;
                continue;
            }
            memcpy(fit->x, x, k * sizeof *x);
            memcpy(fit->product, product, bytes);
            fit->model = *kept;
            explain_fit_total(fit, data, h, g, &chi2, work);
            damping = fmax(1e-3, 10.0 * damping);
            if (damping > 1e4 || (!tried && next - chi2 < 1e-3))
                break;
        }
        fit->score = explain_fit_score(fit, data);
    }
    free(h);
    free(product);
    free(kept);
    return status;
}

/* ---- leaving a run out ---- */

palp_status explain_fit_leave_out(const explain_fit *fit, const explain_data *data, double *score, double *step) {
    size_t k = fit->n_columns;
    double *h = malloc((4 * k * k + 5 * k) * sizeof *h);
    if (!h)
        return PALP_ERR_NO_MEMORY;
    double *rest = h + k * k, *own = rest + k * k, *work = own + k * k, *g = work + k * k + k, *own_g = g + k,
           *move = own_g + k, *b = move + k, chi2;
    explain_fit_total(fit, data, h, g, &chi2, own);
    for (size_t r = 0; r < data->n_runs; r++) {
        double own_chi2, logdet, out = data->run[r].held_out ? 0.0 : 1.0;
        explain_normal_of(fit, r, own, own_g, &own_chi2, &logdet);
        for (size_t i = 0; i < k * k; i++)
            rest[i] = h[i] - out * own[i];
        for (size_t i = 0; i < k; i++) { /* a coordinate on its bound stays there */
            bool stuck = fit->x[i] <= fit->low[i] || fit->x[i] >= fit->high[i];
            move[i] = stuck ? 0.0 : g[i] - out * own_g[i];
            rest[i * k + i] += 1e-9 * h[i * k + i];
            for (size_t j = 0; j < k && stuck; j++)
                rest[i * k + j] = rest[j * k + i] = 0.0;
            if (stuck)
                rest[i * k + i] = 1e30;
        }
        memcpy(work, rest, k * k * sizeof *work);
        score[r] = -HUGE_VAL;
        if (!dense_cholesky(k, work))
            continue;
        dense_cholesky_solve(k, work, 1, move);
        double before = dense_log_determinant(k, work), chi2_at = own_chi2;
        for (size_t i = 0; i < k; i++) {
            b[i] = own_g[i];
            for (size_t j = 0; j < k; j++)
                b[i] -= own[i * k + j] * move[j];
            chi2_at -= move[i] * (own_g[i] + b[i]);
        }
        memcpy(work, rest, k * k * sizeof *work);
        for (size_t i = 0; i < k * k; i++)
            work[i] += own[i];
        if (step)
            memcpy(step + r * k, move, k * sizeof *move);
        if (!dense_cholesky(k, work))
            continue;
        double after = dense_log_determinant(k, work);
        memcpy(move, b, k * sizeof *move);
        dense_cholesky_solve(k, work, 1, move);
        for (size_t i = 0; i < k; i++)
            chi2_at -= b[i] * move[i];
        score[r] = -0.5 * (chi2_at + logdet + after - before);
    }
    free(h);
    return PALP_OK;
}
