/* explain_improve.c: the steps to a fit's best parameters. */
#include "explain_fit.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double RISE = 1e-3; /* of chi2: less is rounding's */

palp_status explain_fit_predict(const explain_fit *fit, const explain_data *data, double *chi2) {
    size_t k = fit->n_columns;
    double *h = malloc((2 * k * k + 3 * k) * sizeof *h);
    levenberg_walls walls = {.count = 0};
    palp_status status = h ? explain_walls_find(fit, data, &walls) : PALP_ERR_NO_MEMORY;
    if (!status) {
        double *work = h + k * k, *g = work + k * k + k, *step = g + k;
        explain_fit_total(fit, data, h, g, chi2, work);
        if (levenberg_step(k, fit->x, fit->low, fit->high, h, g, 1e-9, work, step))
            status = levenberg_confine(k, &walls, fit->x, work, step);
        for (size_t i = 0; i < k; i++)
            *chi2 += step[i] * (dense_dot(k, h + i * k, step) - 2.0 * g[i]);
    }
    free(walls.row);
    free(h);
    return status;
}

/* The fit that moves, and the model and products of its best parameters so far. */
typedef struct improvement {
    explain_fit *fit;
    const explain_data *data;
    palp_model model;
    double *product;
    double *work;      /* [k k + k] */
    double best, last; /* chi2 of them, and of those tried last */
    size_t evaluations;
} improvement;

static palp_status evaluate(void *user, const double *x, double *h, double *g, double *chi2) {
    improvement *i = user;
    i->evaluations++;
    memcpy(i->fit->x, x, i->fit->n_columns * sizeof *x);
    palp_status status = explain_fit_to_model(i->fit);
    if (!status && explain_fit_wall(i->fit, i->data) > i->best + RISE) /* whatever its forces are */
        return PALP_ERR_NOT_CONVERGED;
    if (!status)
        status = explain_fit_products(i->fit, i->data, NULL);
    if (status)
        return status;
    explain_fit_total(i->fit, i->data, h, g, chi2, i->work);
    i->last = *chi2 += explain_fit_wall(i->fit, i->data);
    return PALP_OK;
}

static void keep(void *user) {
    improvement *i = user;
    i->best = i->last;
    i->model = i->fit->model;
    memcpy(i->product, i->fit->product, i->data->n_runs * i->fit->m * i->fit->m * sizeof *i->product);
}

/* From where fit is; *used: evaluations that it took. */
static palp_status descend(explain_fit *fit, const explain_data *data, size_t rounds, size_t *used) {
    size_t k = fit->n_columns, room = data->n_runs * fit->m * fit->m;
    double *h = malloc((2 * k * k + 3 * k + room) * sizeof *h), reach[EXPLAIN_COLUMNS], chi2;
    levenberg_walls walls = {.count = 0};
    palp_status status = h ? explain_walls_find(fit, data, &walls) : PALP_ERR_NO_MEMORY;
    if (!status) {
        double *g = h + k * k, *x = g + k;
        improvement i = {.fit = fit, .data = data, .work = x + k, .product = x + k + k * k + k};
        memcpy(x, fit->x, k * sizeof *x);
        for (size_t a = 0; a < k; a++)
            reach[a] = fit->logarithmic[a] ? 1.0 : HUGE_VAL;
        explain_fit_total(fit, data, h, g, &chi2, i.work);
        i.last = chi2 += explain_fit_wall(fit, data);
        keep(&i);
        const levenberg problem = {.n = k,
                                   .evaluations = rounds,
                                   .low = fit->low,
                                   .high = fit->high,
                                   .walls = &walls,
                                   .reach = reach,
                                   .stop_absolute = 0.02,
                                   .stop_relative = 1e-7,
                                   .stop_rise = RISE,
                                   .evaluate = evaluate,
                                   .keep = keep,
                                   .user = &i};
        status = levenberg_solve(&problem, x, h, g, &chi2);
        memcpy(fit->x, x, k * sizeof *x);
        memcpy(fit->product, i.product, room * sizeof *i.product);
        fit->model = i.model;
        fit->score = explain_fit_score(fit, data);
        *used = i.evaluations;
    }
    free(walls.row);
    free(h);
    return status;
}

/* *at to where it should be, at most so far from 0; but for less than what is as good as straight; whether it
 * moved. */
static bool move(double *at, double to, double most, double straight) {
    to = fmin(most, fmax(-most, to));
    if (!(fabs(to - *at) > straight))
        return false;
    *at = to;
    return true;
}

/* Every run's surface to where the fit finds it, at most a quarter of the deepest away, and its gain where a
 * sensor bends; whether one moved. */
static bool find_nuisances(explain_fit *fit, const explain_data *data) {
    const double deepest = 0.25 * data->deepest, gain = explain_bends(&fit->model) ? 0.5 : 0.0;
    bool moved = false;
    for (size_t r = 0; r < data->n_runs; r++) {
        double own[EXPLAIN_NUISANCES], sd[EXPLAIN_NUISANCES];
        explain_nuisances(fit, r, own, sd);
        moved =
            move(&fit->contact[r], own[1], deepest, fmin(0.1 * fit->scatter.contact, 1e-3 * data->deepest)) ||
            moved;
        moved = move(&fit->gain[r], own[2], gain, fmin(0.1 * fit->scatter.gain, 1e-3)) || moved;
    }
    return moved;
}

palp_status explain_fit_improve(explain_fit *fit, const explain_data *data, size_t rounds) {
    enum { PASSES = 4 };
    palp_status status = PALP_OK;
    for (int pass = 0; pass < PASSES && rounds > 0 && !status; pass++) {
        size_t used = 0;
        status = descend(fit, data, rounds, &used);
        rounds -= used;
        if (status || !find_nuisances(fit, data))
            break;
        status = explain_fit_products(fit, data, NULL);
    }
    return status;
}

palp_status explain_fit_settle(explain_fit *fit, const explain_data *data,
                               const palp_explain_settings *settings) {
    palp_status status = PALP_OK;
    for (size_t rounds = 15; rounds > 2 && !status; rounds /= 5) {
        status = explain_fit_improve(fit, data, rounds);
        if (!status)
            explain_fit_scatter(fit, data, settings);
    }
    return status;
}

palp_status explain_fit_settle_anew(explain_fit *fit, const explain_data *data,
                                    const palp_explain_settings *settings) {
    fit->spread = settings;
    palp_status status = explain_fit_products(fit, data, NULL);
    return status ? status : explain_fit_settle(fit, data, settings);
}
