/* palpation.c: a ball or a layer of another stiffness from a map of presses: its place and size by least
 * squares for each of several stiffnesses along a ridge of the likelihood; the evidence is a sum over these.
 */
#include <palpate/palpation.h>

#include "base/dense.h"
#include "base/file.h"
#include "base/statistics.h"
#include "calibrate_internal.h"
#include "contact/contact_internal.h"
#include "mesh/mesh_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char REGION[] = "palpation.region";

enum { MOST_PLACE = 4, MOST_ALL = MOST_PLACE + 2 }; /* parameters of place and size; stiffness and gain too */
enum { LEVELS = 2 }; /* states of a press: at half its depth and at all of it */
enum { STIFFNESSES = 7, STARTS = 3, SCAN = 5, THICKNESSES = 8, FEWEST = 8 };
static const double STIFFNESS[STIFFNESSES] = {1.5, 2.2, 3.5, 6.0, 12.0, 25.0, 50.0}; /* or one over these */
static const double KNOWN = 4.0;      /* degrees of freedom of the prior of errors (doc/palpation.md) */
static const double FIRST = 6.0;      /* the one that is tried first */
static const double SCANNED = 1.5;    /* that of the scan, which is linear in its logarithm */
static const double SOFT = 0.15;      /* half width of the region's edge, in mean edges of the mesh */
static const double SHIFT = 0.02;     /* of a parameter for its derivative, in mean edges */
static const double LEAST = 0.6;      /* smallest size, in mean edges: smaller regions are not in the mesh */
static const double MOST = 0.45;      /* largest, of the shortest side of the mesh */
static const double LOST = 10.0;      /* residual of a region with which the network has no equilibrium */
static const double FINER = 1.6;      /* cells a side of the lattice by which the error is measured */
static const double TOLERANCE = 1e-6; /* of an equilibrium; that of its energy is the square of it */
static const double PI2 = 6.283185307179586;

/* A region of some kind: a ball, or a layer whose upper end is at middle[1]. */
typedef struct hidden {
    double middle[3], size, edge;
} hidden;

/* What is looked for. Of the n parameters the last is the logarithm of the size, a radius or a thickness; the
 * others are the middle. Lengths are in mean edges. */
typedef struct hidden_kind {
    size_t n;
    palp_mesh_place *part;
} hidden_kind;

typedef struct search {
    const hidden_kind *kind;
    palp_model model;
    palp_mesh_source *source;
    palp_mesh *mesh;
    const palp_palpation_settings *settings;
    size_t n, n_nodes;
    const palp_palpation_press *press;
    double edge, low[3], high[3], shortest;
    palp_network *net;
    double known_squares; /* weight of the prior of the errors, in presses */
    double known;
    double gain_sd;    /* of the logarithm of a gain that is known */
    double gain_share; /* of a mean that is a gain if the errors have their prior size: 1 if it is not known
                          at all, 0 if exactly */
    double *x;         /* [3 n_nodes] for each level of each press: the last equilibrium */
    bool solved;       /* x holds some */
    double *wanted;    /* [n] logarithms of the measured forces */
    double *work, *elastic; /* [n] model's, and with the nodes held at x */
    double *moved;          /* [n] */
    double log_stiffness;   /* of the region */
    double gain;
    double done, planned; /* evaluations */
} search;

/* ---- the region ----------------------------------------------------------------------------------- */

static double part_in_ball(void *user, const double x[3]) {
    const hidden *h = user;
    const double dx = x[0] - h->middle[0], dy = x[1] - h->middle[1], dz = x[2] - h->middle[2],
                 far = sqrt(dx * dx + dy * dy + dz * dz);
    return fmin(fmax(0.5 + 0.5 * (h->size - far) / h->edge, 0.0), 1.0);
}

static double part_in_layer(void *user, const double x[3]) {
    const hidden *h = user;
    return fmin(fmax(0.5 + 0.5 * (h->size - (h->middle[1] - x[1])) / h->edge, 0.0), 1.0);
}

static const hidden_kind A_BALL = {4, part_in_ball}, A_LAYER = {1, part_in_layer};

static palp_status place_region(search *s, const double *p) {
    const size_t last = s->kind->n - 1;
    hidden h = {{0.0, s->high[1], 0.0}, exp(p[last]) * s->edge, SOFT * s->edge};
    for (size_t k = 0; k < last; k++)
        h.middle[k] = p[k] * s->edge;
    return palp_mesh_add_region(s->mesh, REGION, s->kind->part, &h);
}

/* The network with the region as it was placed; it is made at the first call. */
static palp_status use_network(search *s, palp_error *error) {
    const size_t of = s->source->n_regions - 1;
    const double *part;
    palp_support supports[2];
    palp_network_settings settings = palp_network_settings_default();
    palp_supports_default(supports);
    settings.tolerance = TOLERANCE;
    palp_status status = PALP_OK;
    if (!s->net) {
        status = palp_network_from_model(&s->model, s->mesh, 1, supports, &settings, &s->net, error);
        if (!status)
            status = palp_network_enable_tools(s->net, 1, 0, &s->settings->contact);
    }
    if (!status)
        status = palp_mesh_region(s->mesh, REGION, &part);
    return status ? status : network_change_region(s->net, of, part, exp(s->log_stiffness));
}

/* ---- presses -------------------------------------------------------------------------------------- */

static double *place_of_nodes(const search *s, size_t press, size_t level) {
    return s->x + 3 * s->n_nodes * (LEVELS * press + level);
}

/* The network with its nodes at x and the tool at this level. */
static palp_status place_level(const search *s, const palp_palpation_press *press, size_t level,
                               const double *x) {
    palp_tool tool = press->tool;
    tool.friction = 0.0;
    tool.position_m[1] -= press->depth_m * (level == 0 ? 0.5 : 1.0);
    palp_network_reset(s->net);
    memcpy(s->net->now.x, x, 3 * s->n_nodes * sizeof *x);
    return palp_network_set_tools(s->net, 1, &tool);
}

/* The equilibrium of a press at this level, from the nodes at x, which become those found; its energy. */
static palp_status solve_level(const search *s, const palp_palpation_press *press, size_t level, double *x,
                               double *energy) {
    palp_status status = place_level(s, press, level, x);
    if (!status)
        status = palp_network_try(s->net, 0.0, INFINITY, NULL);
    if (!status && !network_energy(s->net, energy))
        status = PALP_ERR_UNSUPPORTED;
    if (!status)
        memcpy(x, s->net->next.x, 3 * s->n_nodes * sizeof *x);
    return status;
}

/* Its energy with the nodes held at x. */
static palp_status hold_level(const search *s, const palp_palpation_press *press, size_t level,
                              const double *x, double *energy) {
    palp_status status = place_level(s, press, level, x);
    if (!status)
        status = network_begin(s->net, 0.0, INFINITY);
    if (status)
        return status;
    memcpy(s->net->next.x, x, 3 * s->n_nodes * sizeof *x);
    return network_evaluate(s->net) && network_energy(s->net, energy) ? PALP_OK : PALP_ERR_UNSUPPORTED;
}

static double force_of_energies(const palp_palpation_press *press, const double energy[LEVELS]) {
    return (energy[1] - energy[0]) / (0.5 * press->depth_m);
}

/* Mean force over the deeper half by the energies at its ends. */
static palp_status solve_press(const search *s, size_t i) {
    const size_t size = 3 * s->n_nodes * sizeof(double);
    double energy[LEVELS], *x[LEVELS] = {place_of_nodes(s, i, 0), place_of_nodes(s, i, 1)};
    if (!s->solved)
        memcpy(x[0], s->net->rest, size);
    palp_status status = solve_level(s, &s->press[i], 0, x[0], &energy[0]);
    if (!s->solved)
        memcpy(x[1], x[0], size);
    if (!status)
        status = solve_level(s, &s->press[i], 1, x[1], &energy[1]);
    s->work[i] = status ? 0.0 : force_of_energies(&s->press[i], energy);
    return status || s->work[i] > 0.0 ? status : PALP_ERR_NOT_CONVERGED;
}

static palp_status solve_presses(search *s, palp_error *error) {
    palp_status status = use_network(s, error);
    for (size_t i = 0; i < s->n && !status; i++)
        status = solve_press(s, i);
    s->solved = !status;
    s->done += 1.0;
    if (!status && s->settings->progress &&
        s->settings->progress(s->settings->user, fmin(1.0, s->done / s->planned)))
        status = PALP_ERR_STOPPED;
    return status;
}

/* The mean forces with the nodes held at x. For a derivative nodes in equilibrium may stay: the energy does
 * not change with them to first order. */
static palp_status work_of_held_nodes(search *s, double *work) {
    palp_status status = use_network(s, NULL);
    for (size_t i = 0; i < s->n && !status; i++) {
        double energy[LEVELS];
        for (size_t level = 0; level < LEVELS && !status; level++)
            status = hold_level(s, &s->press[i], level, place_of_nodes(s, i, level), &energy[level]);
        work[i] = status ? 0.0 : force_of_energies(&s->press[i], energy);
    }
    return status;
}

/* Fits the gain to the logarithms v[n], and returns it. A share of their mean is subtracted. The sum of
 * squares then is that of the best gain, with the square of its own deviation. */
static double subtract_gain(const search *s, double *v) {
    const double mean = statistics_mean(v, s->n), left = 1.0 - s->gain_share;
    for (size_t i = 0; i < s->n; i++)
        v[i] -= s->gain_share * mean;
    return (1.0 - left * left) * mean;
}

/* slope[n]: derivative of the logarithms of force by a parameter, the last one that of the stiffness. */
static palp_status slope_by_parameter(search *s, const double *p, size_t k, double *slope) {
    double next[MOST_PLACE];
    const double own = s->log_stiffness;
    memcpy(next, p, s->kind->n * sizeof *next);
    if (k < s->kind->n)
        next[k] += SHIFT;
    else
        s->log_stiffness += SHIFT;
    palp_status status = place_region(s, next);
    if (!status)
        status = work_of_held_nodes(s, s->moved);
    s->log_stiffness = own;
    for (size_t i = 0; i < s->n && !status; i++)
        slope[i] = (s->moved[i] - s->elastic[i]) / SHIFT / s->work[i];
    return status;
}

/* ---- the fit for one stiffness -------------------------------------------------------------------- */

static bool is_lost(palp_status status) {
    return calibration_lost(status) || status == PALP_ERR_SINGULAR || status == PALP_ERR_INSIDE ||
           status == PALP_ERR_INPUT;
}

/* Residuals of the logarithms of force, with the gain that fits best. */
static palp_status residuals_of_region(void *user, const double *p, double *r, double *jacobian) {
    search *s = user;
    palp_status status = place_region(s, p);
    if (!status)
        status = solve_presses(s, NULL);
    if (is_lost(status)) {
        for (size_t i = 0; i < s->n; i++)
            r[i] = i % 2 == 0 ? LOST : -LOST;
        if (jacobian)
            memset(jacobian, 0, s->kind->n * s->n * sizeof *jacobian);
        return PALP_OK;
    }
    for (size_t i = 0; i < s->n && !status; i++)
        r[i] = log(s->work[i]) - s->wanted[i];
    if (status)
        return status;
    s->gain = -subtract_gain(s, r);
    if (jacobian)
        status = work_of_held_nodes(s, s->elastic);
    for (size_t k = 0; k < s->kind->n && jacobian && !status; k++) {
        status = slope_by_parameter(s, p, k, jacobian + k * s->n);
        subtract_gain(s, jacobian + k * s->n);
    }
    return status;
}

/* A region of one stiffness that fits best. */
typedef struct candidate {
    double log_stiffness, p[MOST_PLACE], squares, gain, likelihood;
    double covariance[MOST_PLACE * MOST_PLACE]; /* over the variance of the forces, by rows */
    bool known;                                 /* there is one */
} candidate;

/* Ends of a parameter's range. */
static void range_of_parameter(const search *s, size_t k, double *low, double *high) {
    const bool is_size = k + 1 == s->kind->n;
    *low = is_size ? log(LEAST) : s->low[k] / s->edge;
    *high = is_size ? log(MOST * s->shortest / s->edge) : s->high[k] / s->edge;
}

static void set_bounds(const search *s, double *row, double *floor) {
    const size_t n = s->kind->n;
    memset(row, 0, 2 * n * n * sizeof *row);
    for (size_t k = 0; k < n; k++) {
        double high;
        row[2 * k * n + k] = 1.0;
        row[(2 * k + 1) * n + k] = -1.0;
        range_of_parameter(s, k, &floor[2 * k], &high);
        floor[2 * k + 1] = -high;
    }
}

static palp_status fit_region(search *s, size_t most, candidate *c) {
    double row[2 * MOST_PLACE * MOST_PLACE], floor[2 * MOST_PLACE], norm;
    bool converged;
    const least_squares problem = {.n_parameters = s->kind->n,
                                   .n_residuals = s->n,
                                   .max_evaluations = most,
                                   .stop_relative = 1e-3,
                                   .evaluate = residuals_of_region,
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

/* Logarithm of the likelihood of residuals r[n], of which the gain's share is subtracted, but for a constant.
 * The variance of the forces, with its prior, and the gain are integrated out. */
static double likelihood_of_residuals(const search *s, const double *r) {
    enum { STEPS = 400 };
    const double n = (double)s->n, rest = statistics_mean(r, s->n),
                 own = dense_dot(s->n, r, r) - n * rest * rest + s->known_squares;
    if (!s->settings->gain_known)
        return -0.5 * (n - 1.0 + s->known) * log(own);
    const double mean = rest / (1.0 - s->gain_share), reach = 5.0 * s->gain_sd;
    double most = -INFINITY, sum = 0.0, at[STEPS + 1];
    for (int i = 0; i <= STEPS; i++) {
        const double gain = reach * (2.0 * i / STEPS - 1.0), off = mean - gain, far = 10.0 * i / STEPS - 5.0;
        at[i] = -0.5 * far * far - 0.5 * (n + s->known) * log(own + n * off * off);
        most = fmax(most, at[i]);
    }
    for (int i = 0; i <= STEPS; i++)
        sum += exp(at[i] - most);
    return most + log(sum);
}

/* Degrees of freedom of the presses after so many parameters, and the gain if it is fitted; at least 1. */
static double freedom_without(const search *s, size_t parameters) {
    const size_t fitted = parameters + (s->settings->gain_known ? 0 : 1);
    return s->n > fitted + 1 ? (double)(s->n - fitted) : 1.0;
}

/* Covariance, and the gain, at the region found. */
static palp_status measure_region(search *s, candidate *c) {
    const size_t n = s->kind->n;
    double *r = malloc((n + 1) * s->n * sizeof *r), *jacobian = r + s->n, normal[MOST_PLACE * MOST_PLACE];
    if (!r)
        return PALP_ERR_NO_MEMORY;
    s->log_stiffness = c->log_stiffness;
    palp_status status = residuals_of_region(s, c->p, r, jacobian);
    if (!status) {
        dense_transposed_product(n, n, s->n, jacobian, jacobian, normal);
        memset(c->covariance, 0, sizeof c->covariance);
        for (size_t k = 0; k < n; k++)
            c->covariance[k * n + k] = 1.0;
        c->known = dense_cholesky(n, normal);
        if (c->known)
            dense_cholesky_solve(n, normal, n, c->covariance);
        c->squares = dense_dot(s->n, r, r);
        c->likelihood = likelihood_of_residuals(s, r);
        c->gain = s->gain;
    }
    free(r);
    return status;
}

/* ---- where to begin ------------------------------------------------------------------------------- */

typedef struct start {
    double p[MOST_PLACE], score, sign;
} start;

/* The part of the residual that a region there explains, if forces change in proportion to the logarithm of
 * its stiffness: *sign is that of the stiffness. */
static palp_status score_of_place(search *s, const double *residual, const double *p, double *score,
                                  double *sign) {
    double along = 0.0, square = 0.0;
    *score = *sign = 0.0;
    palp_status status = place_region(s, p);
    if (status == PALP_ERR_INPUT)
        return PALP_OK;
    if (!status)
        status = work_of_held_nodes(s, s->moved);
    for (size_t i = 0; i < s->n && !status; i++)
        s->moved[i] = (s->moved[i] - s->elastic[i]) / s->work[i];
    if (status)
        return status;
    subtract_gain(s, s->moved);
    along = dense_dot(s->n, s->moved, residual);
    square = dense_dot(s->n, s->moved, s->moved);
    *score = square > 0.0 ? along * along / square : 0.0;
    *sign = along > 0.0 ? 1.0 : -1.0;
    return PALP_OK;
}

static void keep_start(start found[STARTS], const start *s) {
    for (size_t i = 0; i < STARTS; i++)
        if (s->score > found[i].score) {
            memmove(found + i + 1, found + i, (STARTS - 1 - i) * sizeof *found);
            found[i] = *s;
            return;
        }
}

/* Height of the surface by the press that is nearest in x and z, in edges. */
static double surface_near(const search *s, double x, double z) {
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
static palp_status scan_thicknesses(search *s, const double *residual, start found[STARTS]) {
    double low, high;
    palp_status status = PALP_OK;
    range_of_parameter(s, 0, &low, &high);
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
static palp_status scan_places(search *s, const double *residual, start found[STARTS]) {
    static const double DEPTH[] = {1.2, 2.0, 3.2}, RADIUS[] = {0.12, 0.22};
    double from[3], to[3];
    palp_status status = PALP_OK;
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
                         radius = fmax(RADIUS[deep % 2] * s->shortest / s->edge, 1.1 * LEAST);
            start next = {.p = {x / s->edge, surface_near(s, x, z) - DEPTH[deep / 2] * radius, z / s->edge,
                                log(radius)}};
            status = score_of_place(s, residual, next.p, &next.score, &next.sign);
            if (next.p[1] * s->edge > s->low[1])
                keep_start(found, &next);
        }
    return status;
}

static palp_status scan_for_starts(search *s, const double *residual, start found[STARTS]) {
    memset(found, 0, STARTS * sizeof *found);
    s->log_stiffness = log(SCANNED);
    return s->kind == &A_BALL ? scan_places(s, residual, found) : scan_thicknesses(s, residual, found);
}

/* ---- all stiffnesses ------------------------------------------------------------------------------ */

/* Regions of all stiffnesses on the side of the first, each from its neighbour. */
static palp_status fit_all_stiffnesses(search *s, const candidate *first, candidate found[STIFFNESSES]) {
    const double sign = first->log_stiffness > 0.0 ? 1.0 : -1.0;
    size_t middle = 0;
    palp_status status = PALP_OK;
    while (middle + 1 < STIFFNESSES && STIFFNESS[middle] < FIRST)
        middle++;
    for (size_t turn = 0; turn < STIFFNESSES && !status; turn++) {
        const size_t i = turn < STIFFNESSES - middle ? middle + turn : STIFFNESSES - 1 - turn;
        const candidate *from = i == middle ? first : i > middle ? &found[i - 1] : &found[i + 1];
        found[i] = *from;
        found[i].log_stiffness = sign * log(STIFFNESS[i]);
        if (i != middle)
            status = fit_region(s, 8, &found[i]);
        if (!status)
            status = measure_region(s, &found[i]);
    }
    return status;
}

/* Logarithm of the ratio of marginal likelihoods, this region over none: the place is integrated out over the
 * mesh and the logarithm of the size over its range, by Laplace's method. none: the likelihood of none. */
static double evidence_of_region(const search *s, const candidate *c, double none) {
    const size_t n = s->kind->n;
    const double variance = (c->squares + s->known_squares) / (freedom_without(s, 0) + s->known);
    double normal[MOST_PLACE * MOST_PLACE];
    if (!c->known)
        return -INFINITY;
    memcpy(normal, c->covariance, sizeof normal);
    if (!dense_cholesky(n, normal))
        return -INFINITY;
    double volume = 0.5 * dense_log_determinant(n, normal) + 0.5 * (double)n * log(PI2 * variance);
    for (size_t k = 0; k < n; k++) {
        double low, high;
        range_of_parameter(s, k, &low, &high);
        volume -= log(high - low);
    }
    return c->likelihood - none + fmin(volume, 0.0);
}

/* Width of the interval of log stiffness of each of them. */
static double width_of_stiffness(size_t i) {
    const double before = i > 0 ? STIFFNESS[i - 1] : 1.0,
                 after = i + 1 < STIFFNESSES ? STIFFNESS[i + 1] : STIFFNESS[i];
    return 0.5 * log(after / before);
}

/* Sum over all stiffnesses; posterior[i] is the share of each. The other side of 1 has as much prior. */
static double evidence_of_all(const search *s, const candidate found[STIFFNESSES], double none,
                              double posterior[STIFFNESSES]) {
    double sum = 0.0, widths = 0.0, most = -INFINITY;
    for (size_t i = 0; i < STIFFNESSES; i++) {
        posterior[i] = evidence_of_region(s, &found[i], none) + log(width_of_stiffness(i));
        most = fmax(most, posterior[i]);
        widths += 2.0 * width_of_stiffness(i);
    }
    for (size_t i = 0; i < STIFFNESSES; i++) {
        posterior[i] = isfinite(most) ? exp(posterior[i] - most) : 1.0;
        sum += posterior[i];
    }
    for (size_t i = 0; i < STIFFNESSES; i++)
        posterior[i] /= sum;
    return most + log(sum / widths);
}

/* A mixture of normal distributions. */
typedef struct mixture {
    size_t n;
    double share[STIFFNESSES], mean[STIFFNESSES], sd[STIFFNESSES];
} mixture;

static double share_below(const mixture *m, double x) {
    double sum = 0.0;
    for (size_t i = 0; i < m->n; i++)
        sum += m->share[i] * 0.5 * erfc(-(x - m->mean[i]) / (sqrt(2.0) * m->sd[i]));
    return sum;
}

static double quantile_of_mixture(const mixture *m, double share, double low, double high) {
    enum { HALVES = 60 };
    for (int i = 0; i < HALVES; i++) {
        const double middle = 0.5 * (low + high);
        if (share_below(m, middle) < share)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

/* The posterior is uniform over the width of each stiffness. The interval is open where an end of the range
 * has more than the tail. */
static void find_interval_of_stiffness(const candidate found[STIFFNESSES],
                                       const double posterior[STIFFNESSES], double tail,
                                       palp_palpation_value *v) {
    double end[2] = {0.0, log(STIFFNESS[STIFFNESSES - 1])}, from = 0.0, below = 0.0;
    for (size_t i = 0; i < STIFFNESSES; i++) {
        const double width = width_of_stiffness(i);
        for (int side = 0; side < 2; side++) {
            const double wanted = side == 0 ? tail : 1.0 - tail;
            if (below < wanted && below + posterior[i] >= wanted)
                end[side] = from + width * (wanted - below) / posterior[i];
        }
        below += posterior[i];
        from += width;
    }
    const bool open = posterior[STIFFNESSES - 1] > tail, softer = found[0].log_stiffness < 0.0;
    v->low = softer ? (open ? 0.0 : exp(-end[1])) : exp(end[0]);
    v->high = softer ? exp(-end[0]) : open ? INFINITY : exp(end[1]);
}

/* The region of the most probable stiffness, whose index is returned, and intervals over all: value[n] of its
 * place and size, and of its stiffness. */
static size_t find_intervals(const search *s, const candidate found[STIFFNESSES],
                             const double posterior[STIFFNESSES], palp_palpation_value *const *value) {
    static const double TAIL = 0.025;
    const size_t n = s->kind->n;
    const double freedom = s->known + freedom_without(s, n + 1);
    size_t best = 0;
    for (size_t i = 1; i < STIFFNESSES; i++)
        best = posterior[i] > posterior[best] ? i : best;
    for (size_t k = 0; k < n; k++) {
        mixture m = {.n = STIFFNESSES};
        double least, most;
        range_of_parameter(s, k, &least, &most);
        for (size_t i = 0; i < STIFFNESSES; i++) {
            m.share[i] = posterior[i];
            m.mean[i] = found[i].p[k];
            m.sd[i] = statistics_student_widening((size_t)freedom) *
                      sqrt((found[i].squares + s->known_squares) / freedom * found[i].covariance[k * n + k]);
            m.sd[i] = fmax(fmin(m.sd[i], most - least), 1e-9);
        }
        const double low = quantile_of_mixture(&m, TAIL, least, most),
                     high = quantile_of_mixture(&m, 1.0 - TAIL, least, most), middle = found[best].p[k];
        *value[k] = k + 1 < n ? (palp_palpation_value){s->edge * middle, s->edge * low, s->edge * high}
                              : (palp_palpation_value){s->edge * exp(middle), s->edge * exp(low),
                                                       s->edge * exp(high)};
    }
    find_interval_of_stiffness(found, posterior, TAIL, value[n]);
    value[n]->best = exp(found[best].log_stiffness);
    return best;
}

/* ---- the next press ------------------------------------------------------------------------------- */

/* Slopes of press i of all by parameters, slope[parameters all]: the last parameter is the gain. */
static void slopes_of_press(const search *s, const double *slope, size_t all, size_t i, double g[MOST_ALL]) {
    for (size_t a = 0; a <= s->kind->n; a++)
        g[a] = slope[a * all + i];
    g[s->kind->n + 1] = s->gain_share;
}

/* Information of the search's presses on place, size, stiffness and gain: its factor. */
static bool factor_information(const search *s, const double *slope, size_t all, double *normal) {
    const size_t parameters = s->kind->n + 2;
    for (size_t a = 0; a < parameters * parameters; a++)
        normal[a] = a % (parameters + 1) == 0 ? 1e-9 : 0.0;
    for (size_t i = 0; i < s->n; i++) {
        double g[MOST_ALL];
        slopes_of_press(s, slope, all, i, g);
        for (size_t a = 0; a < parameters * parameters; a++)
            normal[a] += g[a / parameters] * g[a % parameters];
    }
    return dense_cholesky(parameters, normal);
}

/* The press, of those beyond the search's, whose force is least certain given the latter: it adds most
 * information. */
static size_t find_least_certain(const search *s, const double *slope, size_t all, const double *normal) {
    size_t next = all;
    double most = -1.0;
    for (size_t i = s->n; i < all; i++) {
        double g[MOST_ALL];
        slopes_of_press(s, slope, all, i, g);
        dense_forward(s->kind->n + 2, normal, 1, g);
        const double told = dense_dot(s->kind->n + 2, g, g);
        next = told > most ? i : next;
        most = fmax(most, told);
    }
    return next;
}

/* Derivatives slope[(n + 1) presses] of all presses of the search by the n parameters of this region and its
 * stiffness. */
static palp_status find_slopes(search *s, const candidate *found, double *slope) {
    s->log_stiffness = found->log_stiffness;
    palp_status status = place_region(s, found->p);
    if (!status)
        status = solve_presses(s, NULL);
    if (!status)
        status = work_of_held_nodes(s, s->elastic);
    for (size_t k = 0; k <= s->kind->n && !status; k++)
        status = slope_by_parameter(s, found->p, k, slope + k * s->n);
    return status;
}

/* Presses all candidates too, with the region found. */
static palp_status choose_next_press(const search *s, const candidate *best, palp_palpation *result) {
    const size_t more = s->settings->n_candidates, all = s->n + more, slopes = s->kind->n + 1;
    double normal[MOST_ALL * MOST_ALL];
    result->next = more;
    if (more == 0)
        return PALP_OK;
    palp_palpation_press *press = malloc(all * sizeof *press);
    double *x = malloc(LEVELS * 3 * s->n_nodes * all * sizeof *x),
           *slope = malloc((slopes + 3) * all * sizeof *slope);
    palp_status status = press && x && slope ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status) {
        search own = *s;
        memcpy(press, s->press, s->n * sizeof *press);
        memcpy(press + s->n, s->settings->candidate, more * sizeof *press);
        own.n = all;
        own.press = press;
        own.x = x;
        own.solved = false;
        own.work = slope + slopes * all;
        own.elastic = own.work + all;
        own.moved = own.elastic + all;
        status = find_slopes(&own, best, slope);
    }
    if (!status && factor_information(s, slope, all, normal))
        result->next = find_least_certain(s, slope, all, normal) - s->n;
    free(press);
    free(x);
    free(slope);
    return is_lost(status) ? PALP_OK : status;
}

/* ---- what is given -------------------------------------------------------------------------------- */

palp_palpation_settings palp_palpation_settings_default(void) {
    palp_palpation_settings s = {.false_alarm = 0.05, .contact = palp_contact_settings_default()};
    s.contact.subdivisions = 2;
    return s;
}

static bool is_press_valid(const palp_palpation_press *p, bool with_force) {
    const double *at = p->tool.position_m;
    return p->tool.shape == PALP_TOOL_SPHERE && p->tool.radius_m > 0.0 && isfinite(p->tool.radius_m) &&
           isfinite(at[0]) && isfinite(at[1]) && isfinite(at[2]) && p->depth_m > 0.0 &&
           isfinite(p->depth_m) && (!with_force || (p->force_N > 0.0 && isfinite(p->force_N)));
}

static palp_status check_given(const palp_model *model, size_t n, const palp_palpation_press *presses,
                               const palp_palpation_settings *settings, palp_error *error) {
    if (model->kind != PALP_MODEL_NETWORK)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "the model is no network");
    if (n < FEWEST)
        return palp_error_set(error, PALP_ERR_ARGUMENT, "a map needs at least %d presses", FEWEST);
    if (!(settings->false_alarm > 0.0 && settings->false_alarm < 1.0))
        return palp_error_set(error, PALP_ERR_ARGUMENT,
                              "the chance of a false alarm must be between 0 and 1");
    for (size_t i = 0; i < n; i++)
        if (!is_press_valid(&presses[i], true))
            return palp_error_set(error, PALP_ERR_ARGUMENT,
                                  "press %zu: needs a sphere, a depth and a force above 0", i + 1);
    for (size_t i = 0; i < settings->n_candidates; i++)
        if (!is_press_valid(&settings->candidate[i], false))
            return palp_error_set(error, PALP_ERR_ARGUMENT, "candidate %zu: needs a sphere and a depth",
                                  i + 1);
    if (model->density_kg_m3 > 0.0)
        return palp_error_set(error, PALP_ERR_UNSUPPORTED, "palpation takes networks without mass");
    if (model->mesh && model->mesh->n_regions == PALP_REGIONS_MAX)
        return palp_error_set(error, PALP_ERR_UNSUPPORTED, "the model has %d regions already",
                              PALP_REGIONS_MAX);
    return PALP_OK;
}

static double mean_edge_of(const palp_mesh *mesh) {
    double sum = 0.0, unused[3];
    for (size_t i = 0; i < mesh->n_elements; i++)
        sum += mesh_direction(mesh, mesh->pairs + 2 * i, unused);
    return sum / (double)mesh->n_elements;
}

static palp_status prepare_search(search *s, const palp_model *model, const palp_mesh *mesh) {
    s->source = malloc(sizeof *s->source);
    palp_status status = s->source ? mesh_copy(mesh, &s->mesh) : PALP_ERR_NO_MEMORY;
    if (status)
        return status;
    memset(s->source, 0, sizeof *s->source);
    if (model->mesh)
        *s->source = *model->mesh;
    s->model.mesh = s->source;
    s->model.n_effects = 0;
    palp_region *region = &s->source->regions[s->source->n_regions++];
    *region = (palp_region){.shape = PALP_REGION_OF_MESH, .stiffness = 1.0};
    memcpy(region->name, REGION, sizeof REGION);
    s->n_nodes = mesh->n_nodes;
    s->edge = mean_edge_of(mesh);
    palp_mesh_bounds(mesh, s->low, s->high);
    s->shortest = fmin(s->high[0] - s->low[0], fmin(s->high[1] - s->low[1], s->high[2] - s->low[2]));
    s->x = malloc(3 * s->n_nodes * LEVELS * s->n * sizeof *s->x);
    s->wanted = malloc(5 * s->n * sizeof *s->wanted);
    if (!s->x || !s->wanted)
        return PALP_ERR_NO_MEMORY;
    s->work = s->wanted + s->n;
    s->elastic = s->work + s->n;
    s->moved = s->elastic + s->n;
    for (size_t i = 0; i < s->n; i++)
        s->wanted[i] = log(s->press[i].force_N);
    return PALP_OK;
}

static palp_status press_tissue_alone(search *s, palp_error *error) {
    double p[MOST_PLACE] = {0.0};
    for (size_t k = 0; k + 1 < s->kind->n; k++)
        p[k] = 0.5 * (s->low[k] + s->high[k]) / s->edge;
    s->log_stiffness = 0.0;
    s->solved = false;
    palp_status status = place_region(s, p);
    return status ? status : solve_presses(s, error);
}

/* A lattice has an error at its borders and between its nodes. It is measured against a finer lattice of the
 * tissue alone, as log[n] of the forces. It is taken to be the same with a region. The finer lattice has an
 * error as well, with a prior of the same size. */
static palp_status measure_lattice_error(const search *s, double *more) {
    search fine = *s;
    memset(more, 0, s->n * sizeof *more);
    if (s->source->kind != PALP_MESH_LATTICE)
        return PALP_OK;
    fine.model.mesh = fine.source = malloc(sizeof *fine.source);
    if (!fine.source)
        return PALP_ERR_NO_MEMORY;
    *fine.source = *s->source;
    for (int k = 0; k < 3; k++)
        fine.source->nodes[k] = 1 + (size_t)ceil(FINER * (double)(s->source->nodes[k] - 1));
    fine.mesh = NULL;
    fine.net = NULL;
    fine.x = NULL;
    fine.solved = false;
    fine.work = more;
    fine.source->n_regions--; /* what is hidden is not of the mesh yet */
    palp_status status = palp_model_mesh(&fine.model, &fine.mesh, NULL);
    fine.source->n_regions++;
    if (!status) {
        fine.n_nodes = fine.mesh->n_nodes;
        fine.x = malloc(3 * fine.n_nodes * LEVELS * fine.n * sizeof *fine.x);
        status = fine.x ? press_tissue_alone(&fine, NULL) : PALP_ERR_NO_MEMORY;
    }
    for (size_t i = 0; i < s->n; i++)
        more[i] = status ? 0.0 : log(more[i]) - log(s->work[i]);
    palp_network_free(fine.net);
    palp_mesh_free(fine.mesh);
    free(fine.x);
    free(fine.source);
    return is_lost(status) ? PALP_OK : status;
}

/* Takes the lattice's error off the map. A common factor stays, as the network may have been calibrated with
 * it: the size of this factor is the standard deviation of a gain that is known. */
static palp_status correct_map(search *s, double *lattice, palp_error *error) {
    palp_status status = press_tissue_alone(s, error);
    if (!status)
        status = measure_lattice_error(s, lattice);
    if (status)
        return status;
    const double mean = statistics_mean(lattice, s->n), n = (double)s->n;
    for (size_t i = 0; i < s->n; i++) {
        lattice[i] -= mean;
        s->wanted[i] -= lattice[i];
    }
    const double square = dense_dot(s->n, lattice, lattice) / n;
    s->known_squares = KNOWN * square;
    s->known = square > 0.0 ? KNOWN : 0.0;
    s->gain_sd = fmax(fabs(mean), 1e-6);
    if (s->settings->gain_known)
        s->gain_share = square > 0.0 ? 1.0 - 1.0 / sqrt(1.0 + n * mean * mean / square) : 0.0;
    return PALP_OK;
}

/* Residuals of the tissue alone. */
static palp_status find_residuals_of_tissue(search *s, double *residual) {
    palp_status status = press_tissue_alone(s, NULL);
    if (!status)
        status = work_of_held_nodes(s, s->elastic);
    for (size_t i = 0; i < s->n && !status; i++)
        residual[i] = s->wanted[i] - log(s->work[i]);
    if (!status)
        subtract_gain(s, residual);
    return status;
}

static palp_status fit_first_region(search *s, const start found[STARTS], candidate *best) {
    palp_status status = PALP_OK;
    best->squares = INFINITY;
    for (size_t i = 0; i < STARTS && !status; i++) {
        candidate c = {.log_stiffness = found[i].sign * log(FIRST)};
        if (!(found[i].score > 0.0))
            continue;
        memcpy(c.p, found[i].p, sizeof c.p);
        status = fit_region(s, 12, &c);
        if (!status && c.squares < best->squares)
            *best = c;
    }
    return status || !isinf(best->squares) ? status : PALP_ERR_NOT_CONVERGED;
}

/* What was found of a kind. */
typedef struct answer {
    candidate best;
    double evidence, scatter, gain;
} answer;

static palp_status search_for_kind(search *s, const hidden_kind *kind, double *residual,
                                   palp_palpation_value *const *value, answer *a) {
    start from[STARTS];
    candidate first = {0}, found[STIFFNESSES];
    double posterior[STIFFNESSES];
    s->kind = kind;
    palp_status status = find_residuals_of_tissue(s, residual);
    const double none = status ? 0.0 : likelihood_of_residuals(s, residual);
    if (!status)
        status = scan_for_starts(s, residual, from);
    if (!status)
        status = fit_first_region(s, from, &first);
    if (!status)
        status = fit_all_stiffnesses(s, &first, found);
    if (status)
        return status;
    a->evidence = evidence_of_all(s, found, none, posterior);
    a->best = found[find_intervals(s, found, posterior, value)];
    a->scatter = sqrt(a->best.squares / freedom_without(s, kind->n + 1));
    a->gain = exp(a->best.gain);
    return PALP_OK;
}

/* Prior odds of a ball, a layer and neither are equal. */
static palp_status search_for_all(search *s, double *residual, palp_palpation *r, palp_error *error) {
    palp_palpation_value *const ball[] = {&r->x_m, &r->y_m, &r->z_m, &r->radius_m, &r->stiffness},
                                *const layer[] = {&r->thickness_m, &r->layer_stiffness};
    answer a_ball, a_layer;
    s->kind = &A_BALL;
    s->planned = 3.0 + 2.0 * (12.0 * STARTS + 9.0 * STIFFNESSES);
    palp_status status = correct_map(s, residual, error);
    if (!status)
        status = search_for_kind(s, &A_LAYER, residual, layer, &a_layer);
    if (!status)
        status = search_for_kind(s, &A_BALL, residual, ball, &a_ball);
    if (status)
        return status;
    const double alone = dense_dot(s->n, residual, residual);
    const bool is_layer = a_layer.evidence > a_ball.evidence;
    const double more = is_layer ? a_layer.evidence : a_ball.evidence,
                 less = is_layer ? a_ball.evidence : a_layer.evidence;
    r->found =
        more + log1p(exp(less - more)) > log((1.0 - s->settings->false_alarm) / s->settings->false_alarm);
    r->kind = !r->found ? PALP_PALPATION_NONE : is_layer ? PALP_PALPATION_LAYER : PALP_PALPATION_BALL;
    r->evidence = a_ball.evidence;
    r->evidence_layer = a_layer.evidence;
    r->scatter = sqrt(alone / freedom_without(s, 0));
    r->scatter_found = a_ball.scatter;
    r->scatter_layer = a_layer.scatter;
    r->gain = a_ball.gain;
    r->gain_layer = a_layer.gain;
    s->kind = is_layer ? &A_LAYER : &A_BALL;
    return choose_next_press(s, is_layer ? &a_layer.best : &a_ball.best, r);
}

palp_status palp_palpate(const palp_model *model, const palp_mesh *mesh, size_t n,
                         const palp_palpation_press *presses, const palp_palpation_settings *settings,
                         palp_palpation *result, palp_error *error) {
    if (!model || !mesh || !presses || !settings || !result ||
        (settings->n_candidates > 0 && !settings->candidate))
        return palp_error_null(error);
    palp_status status = check_given(model, n, presses, settings, error);
    if (status)
        return status;
    search s = {.model = *model, .settings = settings, .n = n, .press = presses, .gain_share = 1.0};
    double *residual = malloc(n * sizeof *residual);
    memset(result, 0, sizeof *result);
    status = residual ? prepare_search(&s, model, mesh) : PALP_ERR_NO_MEMORY;
    if (!status)
        status = search_for_all(&s, residual, result, error);
    free(residual);
    free(s.x);
    free(s.wanted);
    free(s.source);
    palp_network_free(s.net);
    palp_mesh_free(s.mesh);
    if (status && error && error->status != status)
        palp_error_set(error, status, "%s", palp_status_text(status));
    return status;
}
