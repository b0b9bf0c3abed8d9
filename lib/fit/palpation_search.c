/* palpation_search.c: place and size of a region by least squares, for each of several stiffnesses.
 */
#include "palpation_internal.h"

#include "base/dense.h"
#include "solve/least_squares.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SCAN = 5, THICKNESSES = 8 };
enum { MIDDLE = PALPATION_STIFFNESSES / 2 }; /* the stiffness that is tried first */
static const double SCANNED = 1.5;           /* that of the scan, which is linear in its logarithm */

/* ---- the fit for one stiffness -------------------------------------------------------------------- */

static void set_bounds(const palpation_search *s, double *row, double *floor) {
    const size_t n = s->kind->n;
    memset(row, 0, 2 * n * n * sizeof *row);
    for (size_t k = 0; k < n; k++) {
        double high;
        row[2 * k * n + k] = 1.0;
        row[(2 * k + 1) * n + k] = -1.0;
        palpation_range(s, k, &floor[2 * k], &high);
        floor[2 * k + 1] = -high;
    }
}

static palp_status fit_region(palpation_search *s, size_t most, palpation_candidate *c) {
    double row[2 * PALPATION_PLACE * PALPATION_PLACE], floor[2 * PALPATION_PLACE], norm;
    bool converged;
    const least_squares problem = {.n_parameters = s->kind->n,
                                   .n_residuals = s->n,
                                   .max_evaluations = most,
                                   .stop_relative = 1e-3,
                                   .evaluate = palpation_residuals,
                                   .user = s,
                                   .n_constraints = 2 * s->kind->n,
                                   .constraint = row,
                                   .floor = floor};
    set_bounds(s, row, floor);
    s->log_stiffness = c->log_stiffness;
    palp_status status = least_squares_solve(&problem, c->p, &norm, &converged);
    c->squares = norm * norm;
    return status;
}

/* Covariance, and how place and size follow the stiffness: slope[n (n + 1)] has the gain's share still. */
static void measure_normal(const palpation_search *s, palpation_candidate *c, double *slope) {
    const size_t n = s->kind->n;
    double normal[PALPATION_PLACE * PALPATION_PLACE], along[PALPATION_PLACE];
    for (size_t k = 0; k <= n; k++)
        palpation_whiten(s, slope + k * s->n);
    dense_transposed_product(n, n, s->n, slope, slope, normal);
    memset(c->covariance, 0, sizeof c->covariance);
    for (size_t k = 0; k < n; k++)
        c->covariance[k * n + k] = 1.0;
    c->known = dense_cholesky(n, normal);
    if (!c->known)
        return;
    dense_cholesky_solve(n, normal, n, c->covariance);
    for (size_t k = 0; k < n; k++)
        along[k] = -dense_dot(s->n, slope + k * s->n, slope + n * s->n);
    dense_cholesky_solve(n, normal, 1, along);
    memcpy(c->along, along, n * sizeof *along);
}

/* r[n]: logarithms of the forces that were solved last, less those wanted. */
static void find_differences(const palpation_search *s, double *r) {
    for (size_t i = 0; i < s->n; i++)
        r[i] = log(s->work[i]) - s->wanted[i];
}

/* Likelihood, gain and what measure_normal finds, at the region found. */
static palp_status measure_region(palpation_search *s, palpation_candidate *c) {
    const size_t n = s->kind->n;
    double *r = malloc((n + 2) * s->n * sizeof *r), *slope = r + s->n;
    if (!r)
        return PALP_ERR_NO_MEMORY;
    c->known = false;
    memset(c->along, 0, sizeof c->along);
    s->log_stiffness = c->log_stiffness;
    palp_status status = palpation_residuals(s, c->p, r, NULL);
    if (!status)
        c->squares = dense_dot(s->n, r, r);
    if (!status && !s->solved)
        status = PALP_ERR_NOT_CONVERGED;
    if (!status) {
        find_differences(s, r);
        c->likelihood = palpation_likelihood(s, r);
        c->gain = palpation_gain(s, r);
        status = palpation_slopes(s, c->p, n + 1, slope);
    }
    if (!status)
        measure_normal(s, c, slope);
    free(r);
    return palpation_lost(status) ? PALP_OK : status;
}

/* ---- where to begin ------------------------------------------------------------------------------- */

typedef struct start {
    double p[PALPATION_PLACE], score, sign;
} start;

/* The part of the residual that a region there explains, if forces change in proportion to the logarithm of
 * its stiffness: *sign is that of the stiffness. */
static palp_status score_of_place(palpation_search *s, const double *residual, const double *p, double *score,
                                  double *sign) {
    double along = 0.0, square = 0.0;
    *score = *sign = 0.0;
    palp_status status = palpation_place(s, p);
    if (status == PALP_ERR_INPUT)
        return PALP_OK;
    if (!status)
        status = palpation_hold(s, s->moved);
    for (size_t i = 0; i < s->n && !status; i++)
        s->moved[i] = (s->moved[i] - s->elastic[i]) / s->work[i];
    if (status)
        return status;
    palpation_whiten(s, s->moved);
    along = dense_dot(s->n, s->moved, residual);
    square = dense_dot(s->n, s->moved, s->moved);
    *score = square > 0.0 ? along * along / square : 0.0;
    *sign = along < 0.0 ? 1.0 : -1.0; /* residuals are the model's less the measured ones */
    return PALP_OK;
}

static void keep_start(start found[PALPATION_STARTS], const start *s) {
    for (size_t i = 0; i < PALPATION_STARTS; i++)
        if (s->score > found[i].score) {
            memmove(found + i + 1, found + i, (PALPATION_STARTS - 1 - i) * sizeof *found);
            found[i] = *s;
            return;
        }
}

/* Height of the surface by the press that is nearest in x and z, in edges. */
static double surface_near(const palpation_search *s, double x, double z) {
    double least = INFINITY, height = 0.0;
    for (size_t i = 0; i < s->n; i++) {
        const palp_tool *tool = &s->press[i].tool;
        const double d = hypot(tool->position_m[0] - x, tool->position_m[2] - z);
        if (d < least) {
            least = d;
            height = tool->position_m[1] - tool->radius_m;
        }
    }
    return height / s->edge;
}

/* Tries layers of so many thicknesses. A thin layer is not in proportion to the logarithm of its stiffness,
 * so the best is tried both stiffer and softer. residual: of the tissue alone. */
static palp_status scan_thicknesses(palpation_search *s, const double *residual,
                                    start found[PALPATION_STARTS]) {
    double low, high;
    palp_status status = PALP_OK;
    palpation_range(s, 0, &low, &high);
    for (int i = 0; i < THICKNESSES && !status; i++) {
        start next = {.p = {low + (high - low) * (i + 0.5) / THICKNESSES}};
        status = score_of_place(s, residual, next.p, &next.score, &next.sign);
        keep_start(found, &next);
    }
    found[1] = found[0];
    found[1].sign = -found[0].sign;
    found[2].score = 0.0;
    return status;
}

/* Tries places on a grid below the presses, at three depths and two radii. residual: of the tissue alone. */
static palp_status scan_places(palpation_search *s, const double *residual, start found[PALPATION_STARTS]) {
    static const double DEPTH[] = {1.2, 2.0, 3.2}, RADIUS[] = {0.12, 0.22};
    double from[3], to[3], least, unused;
    palp_status status = PALP_OK;
    palpation_range(s, s->kind->n - 1, &least, &unused);
    for (int k = 0; k < 3; k += 2) {
        from[k] = INFINITY;
        to[k] = -INFINITY;
        for (size_t i = 0; i < s->n; i++) {
            from[k] = fmin(from[k], s->press[i].tool.position_m[k]);
            to[k] = fmax(to[k], s->press[i].tool.position_m[k]);
        }
    }
    for (int at = 0; at < SCAN * SCAN && !status; at++)
        for (int deep = 0; deep < 6 && !status; deep++) {
            const double x = from[0] + (to[0] - from[0]) * (at / SCAN) / (SCAN - 1),
                         z = from[2] + (to[2] - from[2]) * (at % SCAN) / (SCAN - 1),
                         radius = fmax(RADIUS[deep % 2] * s->shortest / s->edge, 1.1 * exp(least));
            start next = {.p = {x / s->edge, surface_near(s, x, z) - DEPTH[deep / 2] * radius, z / s->edge,
                                log(radius)}};
            status = score_of_place(s, residual, next.p, &next.score, &next.sign);
            if (next.p[1] * s->edge > s->low[1])
                keep_start(found, &next);
        }
    return status;
}

static palp_status scan_for_starts(palpation_search *s, const double *residual,
                                   start found[PALPATION_STARTS]) {
    memset(found, 0, PALPATION_STARTS * sizeof *found);
    s->log_stiffness = log(SCANNED);
    return s->kind == &palpation_ball ? scan_places(s, residual, found)
                                      : scan_thicknesses(s, residual, found);
}

/* ---- all stiffnesses ------------------------------------------------------------------------------ */

/* Residuals of the tissue alone, whitened, and their likelihood. */
static palp_status find_residuals_of_tissue(palpation_search *s, double *residual, double *likelihood) {
    palp_status status = palpation_press_tissue(s, NULL);
    if (!status)
        status = palpation_hold(s, s->elastic);
    if (status)
        return status;
    for (size_t i = 0; i < s->n; i++)
        s->tissue[i] = log(s->work[i]);
    find_differences(s, residual);
    *likelihood = palpation_likelihood(s, residual);
    palpation_whiten(s, residual);
    return PALP_OK;
}

static palp_status fit_first_region(palpation_search *s, const start found[PALPATION_STARTS],
                                    palpation_candidate *best) {
    palp_status status = PALP_OK;
    best->squares = INFINITY;
    for (size_t i = 0; i < PALPATION_STARTS && !status; i++) {
        palpation_candidate c = {.log_stiffness = found[i].sign * log(palpation_stiffness[MIDDLE])};
        if (!(found[i].score > 0.0))
            continue;
        memcpy(c.p, found[i].p, sizeof c.p);
        status = fit_region(s, 12, &c);
        if (!status && c.squares < best->squares)
            *best = c;
    }
    return status || !isinf(best->squares) ? status : PALP_ERR_NOT_CONVERGED;
}

/* Regions of all stiffnesses on the side of the first, each from its neighbour. */
static palp_status fit_all_stiffnesses(palpation_search *s, const palpation_candidate *first,
                                       palpation_candidate found[PALPATION_STIFFNESSES]) {
    const double sign = first->log_stiffness > 0.0 ? 1.0 : -1.0;
    palp_status status = PALP_OK;
    for (size_t turn = 0; turn < PALPATION_STIFFNESSES && !status; turn++) {
        const size_t i =
            turn < PALPATION_STIFFNESSES - MIDDLE ? MIDDLE + turn : PALPATION_STIFFNESSES - 1 - turn;
        const palpation_candidate *from = i == MIDDLE ? first : i > MIDDLE ? &found[i - 1] : &found[i + 1];
        found[i] = *from;
        found[i].log_stiffness = sign * log(palpation_stiffness[i]);
        if (i != MIDDLE)
            status = fit_region(s, 8, &found[i]);
        if (!status)
            status = measure_region(s, &found[i]);
    }
    return status;
}

/* A region again, from itself, with the lattice's error with it. variance: of the forces. */
static palp_status fit_with_own_error(palpation_search *s, double variance, palpation_candidate *c) {
    palp_status status = palpation_press_region(s, c->p, c->log_stiffness, NULL);
    if (!status)
        palpation_use_region(s, variance);
    if (status && !palpation_lost(status))
        return status;
    status = fit_region(s, 8, c);
    return status ? status : measure_region(s, c);
}

palp_status palpation_find(palpation_search *s, const palpation_kind *kind, double *residual,
                           palp_palpation_value *const *value, palpation_answer *a) {
    start from[PALPATION_STARTS];
    palpation_candidate first = {0}, found[PALPATION_STIFFNESSES];
    double posterior[PALPATION_STIFFNESSES];
    s->kind = kind;
    palpation_set_errors(s, s->bare, 0.0);
    double none;
    palp_status status = find_residuals_of_tissue(s, residual, &none);
    if (!status)
        status = scan_for_starts(s, residual, from);
    if (!status)
        status = fit_first_region(s, from, &first);
    if (!status)
        status = fit_all_stiffnesses(s, &first, found);
    if (status)
        return status;
    palpation_evidence(s, found, none, posterior);
    const double variance = palpation_variance(s, &found[palpation_intervals(s, found, posterior, value)]);
    status = palpation_measure_region(s, &found[MIDDLE]);
    for (size_t i = 0; i < PALPATION_STIFFNESSES && !status; i++)
        status = fit_with_own_error(s, variance, &found[i]);
    if (status)
        return status;
    a->evidence = palpation_evidence(s, found, none, posterior);
    a->best = found[palpation_intervals(s, found, posterior, value)];
    a->scatter = sqrt(a->best.squares / palpation_freedom(s, kind->n + 1));
    a->gain = exp(a->best.gain);
    return PALP_OK;
}
