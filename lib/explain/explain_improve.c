/* explain_improve.c: the steps to a fit's best parameters, and what they would be without a run. */
#include "explain_internal.h"
#include "base/dense.h"
#include "model/model_internal.h"
#include "solve/levenberg.h"

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

palp_status explain_fit_predict(const explain_fit *fit, const explain_data *data, double *chi2) {
    size_t k = fit->n_columns;
    double *h = malloc((2 * k * k + 3 * k) * sizeof *h);
    if (!h)
        return PALP_ERR_NO_MEMORY;
    double *work = h + k * k, *g = work + k * k + k, *step = g + k;
    explain_fit_total(fit, data, h, g, chi2, work);
    levenberg_step(k, fit->x, fit->low, fit->high, h, g, 1e-9, work, step);
    *chi2 -= dense_dot(k, step, g);
    free(h);
    return PALP_OK;
}

/* The fit that moves, and the model and products of its best parameters so far. */
typedef struct improvement {
    explain_fit *fit;
    const explain_data *data;
    palp_model model;
    double *product;
    double *work; /* [k k + k] */
} improvement;

static palp_status evaluate(void *user, const double *x, double *h, double *g, double *chi2) {
    improvement *i = user;
    memcpy(i->fit->x, x, i->fit->n_columns * sizeof *x);
    palp_status status = explain_fit_to_model(i->fit);
    if (!status)
        status = explain_fit_products(i->fit, i->data, NULL);
    if (!status)
        explain_fit_total(i->fit, i->data, h, g, chi2, i->work);
    return status;
}

static void keep(void *user) {
    improvement *i = user;
    i->model = i->fit->model;
    memcpy(i->product, i->fit->product, i->data->n_runs * i->fit->m * i->fit->m * sizeof *i->product);
}

palp_status explain_fit_improve(explain_fit *fit, const explain_data *data, size_t rounds) {
    size_t k = fit->n_columns, room = data->n_runs * fit->m * fit->m;
    double *h = malloc((2 * k * k + 3 * k + room) * sizeof *h), reach[EXPLAIN_COLUMNS], chi2;
    improvement *i = malloc(sizeof *i);
    palp_status status = h && i ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status) {
        double *g = h + k * k, *x = g + k;
        *i = (improvement){.fit = fit, .data = data, .work = x + k, .product = x + k + k * k + k};
        keep(i);
        memcpy(x, fit->x, k * sizeof *x);
        for (size_t a = 0; a < k; a++)
            reach[a] = fit->logarithmic[a] ? 1.0 : HUGE_VAL;
        explain_fit_total(fit, data, h, g, &chi2, i->work);
        const levenberg problem = {.n = k, .evaluations = rounds, .low = fit->low, .high = fit->high, .reach = reach,
                                   .stop_absolute = 0.02, .stop_relative = 1e-7, .stop_rise = 1e-3,
                                   .evaluate = evaluate, .keep = keep, .user = i};
        status = levenberg_solve(&problem, x, h, g, &chi2);
        memcpy(fit->x, x, k * sizeof *x);
        memcpy(fit->product, i->product, room * sizeof *i->product);
        fit->model = i->model;
        fit->score = explain_fit_score(fit, data);
    }
    free(h);
    free(i);
    return status;
}

/* ---- leaving a run out ---- */

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
