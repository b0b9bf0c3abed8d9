/* infer_scan.c: the posterior of a bond's parameters. The force jumps where a plate lets go, so it has no
 * derivative by them. The posterior is evaluated on a grid, with all other parameters integrated out at each
 * point. */
#include "infer_internal.h"
#include "base/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PLACES = 16, OTHERS = 12 }; /* of the strength, and of the bond's other parameter */

static const double NEGLIGIBLE = 7.0; /* nats below the most probable point: a density of less than a
                                         thousandth */

/* Points of a coordinate in ascending order, and the log of the posterior there. */
typedef struct places {
    size_t n, most; /* at most so many */
    double at[PLACES], score[PLACES];
} places;

/* Points of the bond's other parameter, and at each those of its strength. */
typedef struct grid {
    infer_fit *fit;
    const explain_data *data;
    size_t strength, other; /* coordinates; the same: there is no other one */
    bool both;              /* the other one is scanned too */
    places outer, inner[OTHERS];
} grid;

/* A point and its share of the posterior. */
typedef struct part {
    double at, mass;
} part;

static size_t best_of(const places *p) {
    size_t best = 0;
    for (size_t i = 0; i < p->n; i++)
        best = p->score[i] > p->score[best] ? i : best;
    return best;
}

/* Weight of point i in the integral by trapezoids. */
static double width_of(const places *p, size_t i) {
    return 0.5 * (p->at[i + 1 < p->n ? i + 1 : i] - p->at[i > 0 ? i - 1 : 0]);
}

static double log_integral(const places *p) {
    const double best = p->score[best_of(p)];
    double sum = 0.0;
    for (size_t i = 0; i < p->n; i++)
        sum += exp(p->score[i] - best) * width_of(p, i);
    return isfinite(best) ? best + log(sum) : -HUGE_VAL;
}

/* ---- places ---- */

/* Adds a point of zero density until it is evaluated; returns its index. */
static size_t insert(places *p, double at) {
    size_t i = p->n++;
    for (; i > 0 && p->at[i - 1] > at; i--) {
        p->at[i] = p->at[i - 1];
        p->score[i] = p->score[i - 1];
    }
    p->at[i] = at;
    p->score[i] = -HUGE_VAL;
    return i;
}

typedef palp_status look(grid *g, double at, places *p); /* adds a place */

/* Steps of growing length from the current point to both sides, until it is improbable or at a bound. */
static palp_status find_ends(grid *g, size_t a, double step, look *add, places *p) {
    const double low = g->fit->c.low[a], high = g->fit->c.high[a],
                 from = fmin(high, fmax(low, g->fit->c.x[a]));
    palp_status status = add(g, from, p);
    for (int side = -1; side <= 1; side += 2)
        for (double way = step; !status && p->n < p->most; way *= 2.0) {
            const size_t end = side < 0 ? 0 : p->n - 1;
            const double next = fmin(high, fmax(low, from + side * way));
            if (next == p->at[end] || p->score[end] < p->score[best_of(p)] - NEGLIGIBLE)
                break;
            status = add(g, next, p);
        }
    return status;
}

/* Halves the interval that may have most of the posterior, repeatedly. */
static palp_status refine(grid *g, look *add, places *p) {
    palp_status status = PALP_OK;
    while (!status && p->n > 1 && p->n < p->most) {
        const double best = p->score[best_of(p)];
        double most = -1.0, half = 0.0;
        for (size_t i = 0; i + 1 < p->n; i++) {
            const double may = exp(fmax(p->score[i], p->score[i + 1]) - best) * (p->at[i + 1] - p->at[i]);
            if (may > most) {
                most = may;
                half = 0.5 * (p->at[i] + p->at[i + 1]);
            }
        }
        status = add(g, half, p);
    }
    return status;
}

/* near: the other columns are those of a nearby point. */
static palp_status go_to(grid *g, double strength, bool near) {
    g->fit->c.x[g->strength] = strength;
    palp_status status = explain_fit_to_model(&g->fit->c);
    if (!status)
        status = (near ? infer_fit_reevaluate : infer_fit_evaluate)(g->fit, g->data);
    return status ? status : infer_fit_score(g->fit, g->data);
}

/* One that makes no model is not probable. */
static palp_status add_strength(grid *g, double at, places *p) {
    palp_status status = go_to(g, at, p->n > 0 && isfinite(p->score[best_of(p)]));
    const size_t i = insert(p, at);
    p->score[i] = status ? -HUGE_VAL : g->fit->promised;
    return status == PALP_ERR_NO_MEMORY ? status : PALP_OK;
}

/* A first step as wide as the former posterior, or half of the current value. */
static double first_step(const infer_scan *known, double otherwise) {
    return known->high > known->low ? 0.5 * (known->high - known->low) : otherwise;
}

/* Begins at the best strength of all other points. */
static palp_status add_other(grid *g, double at, places *p) {
    const double x =
        p->n > 0 ? g->inner[best_of(p)].at[best_of(&g->inner[best_of(p)])] : g->fit->c.x[g->strength];
    const double step = first_step(&g->fit->scan[g->strength], fmax(0.5 * x, 0.1 * g->fit->noise.white));
    const size_t i = insert(p, at);
    memmove(g->inner + i + 1, g->inner + i, (p->n - 1 - i) * sizeof *g->inner);
    places *strength = &g->inner[i];
    *strength = (places){.n = 0, .most = PLACES};
    g->fit->c.x[g->strength] = x;
    if (g->both)
        g->fit->c.x[g->other] = at;
    palp_status status = find_ends(g, g->strength, step, add_strength, strength);
    if (!status)
        status = refine(g, add_strength, strength);
    p->score[i] = status ? -HUGE_VAL : log_integral(strength);
    return status;
}

/* ---- what they say ---- */

static int by_place(const void *a, const void *b) {
    const double x = ((const part *)a)->at, y = ((const part *)b)->at;
    return (x > y) - (x < y);
}

/* The ends of 95 % of it; returns the median. */
static double find_quantiles(size_t n, part *of, double *low, double *high) {
    double sum = 0.0, below = 0.0, median = of[0].at;
    qsort(of, n, sizeof *of, by_place);
    for (size_t i = 0; i < n; i++)
        sum += of[i].mass;
    *low = *high = median;
    for (size_t i = 0; i < n; below += of[i++].mass) {
        *low = below <= 0.025 * sum ? of[i].at : *low;
        median = below <= 0.5 * sum ? of[i].at : median;
        *high = below <= 0.975 * sum ? of[i].at : *high;
    }
    return median;
}

/* Parts of one row of points, each in units of exp(top) times width; returns how many. */
static size_t take_parts(const places *p, double top, double width, part *out) {
    for (size_t i = 0; i < p->n; i++)
        out[i] = (part){p->at[i], width * exp(p->score[i] - top) * width_of(p, i)};
    return p->n;
}

/* Intervals from the grid; returns the median of the strength where the other one is most probable. */
static double find_intervals(grid *g) {
    const size_t best = best_of(&g->outer);
    const double top = g->outer.score[best];
    part all[OTHERS * PLACES];
    double low, high;
    size_t n = 0;
    for (size_t i = 0; i < g->outer.n; i++)
        n += take_parts(&g->inner[i], top, g->both ? width_of(&g->outer, i) : 1.0, all + n);
    infer_scan *strength = &g->fit->scan[g->strength], *other = &g->fit->scan[g->other];
    if (g->both || g->other == g->strength)
        find_quantiles(n, all, &strength->low, &strength->high);
    if (g->both)
        find_quantiles(take_parts(&g->outer, top, 1.0, all), all, &other->low, &other->high);
    return find_quantiles(take_parts(&g->inner[best], top, 1.0, all), all, &low, &high);
}

/* The integral of a posterior over its density at the fit at hand, by their logarithms: its width, which is
 * at most that of the coordinate's range. */
static double spread_of(const grid *g, size_t at, double log_ratio) {
    return fmin(exp(log_ratio), g->fit->c.high[at] - g->fit->c.low[at]);
}

/* Moves to the other parameter's most probable value, and to the strength's median there, unless that is
 * between two maxima. */
static palp_status settle(grid *g) {
    const size_t best = best_of(&g->outer);
    const places *there = &g->inner[best];
    infer_scan *strength = &g->fit->scan[g->strength], *other = &g->fit->scan[g->other];
    const double most = there->score[best_of(there)], median = find_intervals(g);
    if (g->both)
        g->fit->c.x[g->other] = g->outer.at[best];
    palp_status status = go_to(g, median, false);
    if (status != PALP_ERR_NO_MEMORY && (status || g->fit->promised < most - 0.5 * NEGLIGIBLE))
        status = go_to(g, there->at[best_of(there)], false);
    if (status)
        return status;
    strength->spread = spread_of(g, g->strength, g->outer.score[best] - g->fit->promised);
    if (g->both)
        other->spread = spread_of(g, g->other, log_integral(&g->outer) - g->outer.score[best]);
    return infer_fit_score(g->fit, g->data);
}

palp_status infer_scan_bond(infer_fit *fit, const explain_data *data) {
    size_t at = 0;
    while (at < fit->k && !fit->scan[at].jumps)
        at++;
    if (at == fit->k)
        return PALP_OK;
    grid *g = calloc(1, sizeof *g);
    if (!g)
        return PALP_ERR_NO_MEMORY;
    const size_t other = at + 1 < fit->k && fit->scan[at + 1].jumps ? at + 1 : at;
    *g = (grid){.fit = fit, .data = data, .strength = at, .other = other};
    g->both = other != at && !(fit->scan[other].spread > 0.0);
    g->outer.most = g->both ? OTHERS : 1;
    fit->scan[at].spread = 0.0;
    palp_status status = find_ends(g, other, first_step(&fit->scan[other], log(2.0)), add_other, &g->outer);
    if (!status)
        status = refine(g, add_other, &g->outer);
    if (!status && !isfinite(g->outer.score[best_of(&g->outer)]))
        status = PALP_ERR_NOT_CONVERGED;
    if (!status)
        status = settle(g);
    free(g);
    return status;
}

/* ---- the pull at which plates let go ---- */

/* Variance of run r's pull where the bond's strength matters most, from all that changes it but the bond. 0:
 * the plate does not pull. room: m + m m numbers. */
static palp_status find_pull_variance(const infer_fit *fit, const explain_data *data,
                                      const infer_posterior *p, size_t r, size_t at, size_t strength,
                                      double *room, double *variance) {
    const size_t m = fit->m, n = data->run[r].n, columns = m - 1;
    const double *raw = fit->raw + at * m, *by = raw + strength * n;
    double *row = room, *covariance = room + m;
    size_t most = 0;
    for (size_t i = 0; i < n; i++)
        most = data->run[r].use[i] && fabs(by[i]) > fabs(by[most]) ? i : most;
    *variance = 0.0;
    if (by[most] == 0.0)
        return PALP_OK;
    palp_status status = infer_run_moments(fit, data, p, r, row, covariance);
    for (size_t a = 0; a < columns; a++) {
        const bool other = a < fit->k ? fit->scan[a].jumps
                                      : a < fit->k + INFER_BLOCK && a != fit->k + INFER_CONTACT &&
                                            a != fit->k + INFER_GAIN; /* zero, hum, discrepancy */
        row[a] = other ? 0.0 : raw[a * n + most];
    }
    for (size_t a = 0; a < columns && !status; a++)
        *variance += row[a] * dense_dot(columns, covariance + a * columns, row);
    return status;
}

palp_status infer_scan_pull(const infer_fit *fit, const explain_data *data, const infer_posterior *p,
                            size_t strength, double *sd) {
    double sum = 0.0, pulls = 0.0, *room = malloc((fit->m + fit->m * fit->m) * sizeof *room);
    palp_status status = room ? PALP_OK : PALP_ERR_NO_MEMORY;
    for (size_t r = 0, at = 0; r < data->n_runs && !status; at += data->run[r++].n) {
        double variance;
        status = find_pull_variance(fit, data, p, r, at, strength, room, &variance);
        if (status || !(variance > 0.0))
            continue;
        sum += variance;
        pulls += 1.0;
    }
    *sd = pulls > 0.0 ? sqrt(sum / pulls) : 0.0;
    free(room);
    return status;
}
