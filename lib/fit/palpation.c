/* palpation.c: a ball of another stiffness from a map of presses: its place and radius by least squares for
 * each of several stiffnesses along a ridge of the likelihood; the evidence is a sum over these. */
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

static const char BALL[] = "palpation.ball"; /* the region */

enum {
    PLACE = 4,
    ALL = PLACE + 1,
    WITH_GAIN
};                   /* parameters: x, y, z and the logarithm of the radius; of the stiffness */
enum { LEVELS = 2 }; /* states of a press: at half its depth and at all of it */
enum { KNOWN = 4, STIFFNESSES = 7, STARTS = 3, SCAN = 5, FEWEST = 8 };
static const double STIFFNESS[STIFFNESSES] = {1.5, 2.2, 3.5, 6.0, 12.0, 25.0, 50.0}; /* or one over these */
static const double FIRST = 6.0;      /* the one that is tried first */
static const double SCANNED = 1.5;    /* that of the scan, which is linear in its logarithm */
static const double SOFT = 0.15;      /* half width of the ball's edge, in mean edges of the mesh */
static const double SHIFT = 0.02;     /* of a parameter for its derivative, in mean edges */
static const double LEAST = 0.6;      /* smallest radius, in mean edges: smaller balls are not in the mesh */
static const double MOST = 0.45;      /* largest, of the shortest side of the mesh */
static const double LOST = 10.0;      /* residual of a ball with which the network has no equilibrium */
static const double FINER = 1.6;      /* cells a side of the lattice by which the error is measured */
static const double TOLERANCE = 1e-6; /* of an equilibrium; that of its energy is the square of it */
static const double PI2 = 6.283185307179586;

typedef struct search {
    palp_model model;
    palp_mesh_source *source;
    palp_mesh *mesh;
    const palp_palpation_settings *settings;
    size_t n, n_nodes;
    const palp_palpation_press *press;
    double edge, low[3], high[3], shortest;
    palp_network *touched, *bare; /* with the tool, and without */
    double known_squares;         /* weight of the prior of the errors, in presses */
    size_t known;
    double *x;              /* [3 n_nodes] for each level of each press: the last equilibrium */
    bool solved;            /* x holds some */
    double *wanted;         /* [n] logarithms of the measured forces, less their mean */
    double *work, *elastic; /* [n] model's, and that of its elements at x */
    double *moved;          /* [n] */
    double log_stiffness;   /* of the ball */
    double gain;
    double done, planned; /* evaluations */
} search;

/* ---- the ball ------------------------------------------------------------------------------------- */

typedef struct ball {
    double middle[3], radius, edge;
} ball;

static double part_in_ball(void *user, const double x[3]) {
    const ball *b = user;
    const double dx = x[0] - b->middle[0], dy = x[1] - b->middle[1], dz = x[2] - b->middle[2],
                 far = sqrt(dx * dx + dy * dy + dz * dz);
    return fmin(fmax(0.5 + 0.5 * (b->radius - far) / b->edge, 0.0), 1.0);
}

/* p: place in edges, and the logarithm of the radius in edges. */
static palp_status place_ball(search *s, const double p[PLACE]) {
    ball b = {{p[0] * s->edge, p[1] * s->edge, p[2] * s->edge}, exp(p[3]) * s->edge, SOFT * s->edge};
    return palp_mesh_add_region(s->mesh, BALL, part_in_ball, &b);
}

/* The network with the ball as it was placed; it is made at the first call. */
static palp_status use_network(search *s, bool with_tool, palp_network **net, palp_error *error) {
    palp_network **kept = with_tool ? &s->touched : &s->bare;
    const size_t of = s->source->n_regions - 1;
    const double *part;
    palp_support supports[2];
    palp_network_settings settings = palp_network_settings_default();
    palp_supports_default(supports);
    settings.tolerance = TOLERANCE;
    palp_status status =
        *kept ? PALP_OK : palp_network_from_model(&s->model, s->mesh, 1, supports, &settings, kept, error);
    if (!status && with_tool && !contact_of(*kept))
        status = palp_network_enable_tools(*kept, 1, 0, &s->settings->contact);
    if (!status)
        status = palp_mesh_region(s->mesh, BALL, &part);
    if (!status)
        status = network_change_region(*kept, of, part, exp(s->log_stiffness));
    *net = *kept;
    return status;
}

/* ---- presses -------------------------------------------------------------------------------------- */

static double *place_of_nodes(const search *s, size_t press, size_t level) {
    return s->x + 3 * s->n_nodes * (LEVELS * press + level);
}

/* The equilibrium of a press at this level, from the nodes at x, which become those found; its energy. */
static palp_status solve_level(const search *s, palp_network *net, const palp_palpation_press *press,
                               size_t level, double *x, double *energy) {
    const size_t size = 3 * s->n_nodes * sizeof *x;
    palp_tool tool = press->tool;
    tool.friction = 0.0;
    tool.position_m[1] -= press->depth_m * (level == 0 ? 0.5 : 1.0);
    palp_network_reset(net);
    memcpy(net->now.x, x, size);
    palp_status status = palp_network_set_tools(net, 1, &tool);
    if (!status)
        status = palp_network_try(net, 0.0, INFINITY, NULL);
    if (!status && !network_energy(net, energy))
        status = PALP_ERR_UNSUPPORTED;
    if (!status)
        memcpy(x, net->next.x, size);
    return status;
}

/* Mean force over the deeper half by the energies at its ends. */
static palp_status solve_press(const search *s, palp_network *net, const palp_palpation_press *press,
                               double *x[LEVELS], bool known, double *force) {
    const size_t size = 3 * s->n_nodes * sizeof(double);
    double energy[LEVELS];
    if (!known)
        memcpy(x[0], net->rest, size);
    palp_status status = solve_level(s, net, press, 0, x[0], &energy[0]);
    if (!known)
        memcpy(x[1], x[0], size);
    if (!status)
        status = solve_level(s, net, press, 1, x[1], &energy[1]);
    *force = status ? 0.0 : (energy[1] - energy[0]) / (0.5 * press->depth_m);
    return status || *force > 0.0 ? status : PALP_ERR_NOT_CONVERGED;
}

static palp_status solve_presses(search *s, palp_error *error) {
    palp_network *net = NULL;
    palp_status status = use_network(s, true, &net, error);
    for (size_t i = 0; i < s->n && !status; i++) {
        double *x[LEVELS] = {place_of_nodes(s, i, 0), place_of_nodes(s, i, 1)};
        status = solve_press(s, net, &s->press[i], x, s->solved, &s->work[i]);
    }
    s->solved = !status;
    s->done += 1.0;
    if (!status && s->settings->progress &&
        s->settings->progress(s->settings->user, fmin(1.0, s->done / s->planned)))
        status = PALP_ERR_STOPPED;
    return status;
}

/* The mean forces of elements and cells with the nodes at x. For a derivative nodes in equilibrium may stay:
 * the energy does not change with them to first order. */
static palp_status work_of_held_nodes(search *s, double *work) {
    palp_network *net = NULL;
    palp_status status = use_network(s, false, &net, NULL);
    if (!status)
        status = network_begin(net, 0.0, INFINITY);
    for (size_t i = 0; i < LEVELS * s->n && !status; i++) {
        double energy;
        memcpy(net->next.x, s->x + 3 * s->n_nodes * i, 3 * s->n_nodes * sizeof *net->next.x);
        if (!network_evaluate(net) || !network_energy(net, &energy))
            status = PALP_ERR_UNSUPPORTED;
        else if (i % LEVELS == 0)
            work[i / LEVELS] = -energy;
        else
            work[i / LEVELS] = (work[i / LEVELS] + energy) / (0.5 * s->press[i / LEVELS].depth_m);
    }
    return status;
}

static void subtract_mean(size_t n, double *v) {
    const double mean = statistics_mean(v, n);
    for (size_t i = 0; i < n; i++)
        v[i] -= mean;
}

/* slope[n]: derivative of the logarithms of force by a parameter, the last one that of the stiffness. */
static palp_status slope_by_parameter(search *s, const double p[PLACE], size_t k, double *slope) {
    double next[PLACE];
    const double own = s->log_stiffness;
    memcpy(next, p, sizeof next);
    if (k < PLACE)
        next[k] += SHIFT;
    else
        s->log_stiffness += SHIFT;
    palp_status status = place_ball(s, next);
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

/* Residuals of the logarithms of force, without their mean: the gain is fitted. */
static palp_status residuals_of_ball(void *user, const double *p, double *r, double *jacobian) {
    search *s = user;
    palp_status status = place_ball(s, p);
    if (!status)
        status = solve_presses(s, NULL);
    if (is_lost(status)) {
        for (size_t i = 0; i < s->n; i++)
            r[i] = i % 2 == 0 ? LOST : -LOST;
        if (jacobian)
            memset(jacobian, 0, PLACE * s->n * sizeof *jacobian);
        return PALP_OK;
    }
    for (size_t i = 0; i < s->n && !status; i++)
        r[i] = log(s->work[i]);
    if (status)
        return status;
    s->gain = -statistics_mean(r, s->n);
    subtract_mean(s->n, r);
    for (size_t i = 0; i < s->n; i++)
        r[i] -= s->wanted[i];
    if (jacobian)
        status = work_of_held_nodes(s, s->elastic);
    for (size_t k = 0; k < PLACE && jacobian && !status; k++) {
        status = slope_by_parameter(s, p, k, jacobian + k * s->n);
        subtract_mean(s->n, jacobian + k * s->n);
    }
    return status;
}

/* A ball of one stiffness that fits best. */
typedef struct candidate {
    double log_stiffness, p[PLACE], squares, gain;
    double covariance[PLACE * PLACE]; /* over the variance of the forces, by rows */
    bool known;                       /* there is one */
} candidate;

/* Ends of a parameter's range. */
static void range_of_parameter(const search *s, size_t k, double *low, double *high) {
    *low = k < 3 ? s->low[k] / s->edge : log(LEAST);
    *high = k < 3 ? s->high[k] / s->edge : log(MOST * s->shortest / s->edge);
}

static void set_bounds(const search *s, double row[2 * PLACE * PLACE], double floor[2 * PLACE]) {
    memset(row, 0, 2 * PLACE * PLACE * sizeof *row);
    for (size_t k = 0; k < PLACE; k++) {
        double high;
        row[2 * k * PLACE + k] = 1.0;
        row[(2 * k + 1) * PLACE + k] = -1.0;
        range_of_parameter(s, k, &floor[2 * k], &high);
        floor[2 * k + 1] = -high;
    }
}

static palp_status fit_ball(search *s, size_t most, candidate *c) {
    double row[2 * PLACE * PLACE], floor[2 * PLACE], norm;
    bool converged;
    const least_squares problem = {.n_parameters = PLACE,
                                   .n_residuals = s->n,
                                   .max_evaluations = most,
                                   .stop_relative = 1e-3,
                                   .evaluate = residuals_of_ball,
                                   .user = s,
                                   .n_constraints = 2 * PLACE,
                                   .constraint = row,
                                   .floor = floor};
    set_bounds(s, row, floor);
    s->log_stiffness = c->log_stiffness;
    palp_status status = least_squares_solve(&problem, c->p, &norm, &converged);
    c->squares = norm * norm;
    return status;
}

/* Covariance, and the gain, at the ball found. */
static palp_status measure_ball(search *s, candidate *c) {
    double *r = malloc((PLACE + 1) * s->n * sizeof *r), *jacobian = r + s->n, normal[PLACE * PLACE];
    if (!r)
        return PALP_ERR_NO_MEMORY;
    s->log_stiffness = c->log_stiffness;
    palp_status status = residuals_of_ball(s, c->p, r, jacobian);
    if (!status) {
        dense_transposed_product(PLACE, PLACE, s->n, jacobian, jacobian, normal);
        memset(c->covariance, 0, sizeof c->covariance);
        for (size_t k = 0; k < PLACE; k++)
            c->covariance[k * PLACE + k] = 1.0;
        c->known = dense_cholesky(PLACE, normal);
        if (c->known)
            dense_cholesky_solve(PLACE, normal, PLACE, c->covariance);
        c->squares = dense_dot(s->n, r, r);
        c->gain = s->gain;
    }
    free(r);
    return status;
}

/* ---- where to begin ------------------------------------------------------------------------------- */

typedef struct start {
    double p[PLACE], score, sign;
} start;

/* The part of the residual that a ball there explains, if forces change in proportion to the logarithm of its
 * stiffness: *sign is that of the stiffness. */
static palp_status score_of_place(search *s, const double *residual, const double p[PLACE], double *score,
                                  double *sign) {
    double along = 0.0, square = 0.0;
    *score = *sign = 0.0;
    palp_status status = place_ball(s, p);
    if (status == PALP_ERR_INPUT)
        return PALP_OK;
    if (!status)
        status = work_of_held_nodes(s, s->moved);
    for (size_t i = 0; i < s->n && !status; i++)
        s->moved[i] = (s->moved[i] - s->elastic[i]) / s->work[i];
    if (status)
        return status;
    subtract_mean(s->n, s->moved);
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

/* Tries places on a grid below the presses, at three depths and two radii. residual: of the tissue alone. */
static palp_status scan_for_starts(search *s, const double *residual, start found[STARTS]) {
    static const double DEPTH[] = {1.2, 2.0, 3.2}, RADIUS[] = {0.12, 0.22};
    double from[3], to[3];
    palp_status status = PALP_OK;
    memset(found, 0, STARTS * sizeof *found);
    for (int k = 0; k < 3; k += 2) {
        from[k] = INFINITY;
        to[k] = -INFINITY;
        for (size_t i = 0; i < s->n; i++) {
            from[k] = fmin(from[k], s->press[i].tool.position_m[k]);
            to[k] = fmax(to[k], s->press[i].tool.position_m[k]);
        }
    }
    s->log_stiffness = log(SCANNED);
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

/* ---- all stiffnesses ------------------------------------------------------------------------------ */

/* Balls of all stiffnesses on the side of the first, each from its neighbour. */
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
            status = fit_ball(s, 8, &found[i]);
        if (!status)
            status = measure_ball(s, &found[i]);
    }
    return status;
}

/* Logarithm of the ratio of marginal likelihoods, this ball over none: the variance of the forces, with its
 * prior, and the gain are integrated out; the place over the mesh and the logarithm of the radius over its
 * range, by Laplace's method. */
static double evidence_of_ball(const search *s, const candidate *c, double squares) {
    const double freedom = (double)(s->n - 1 + s->known), own = c->squares + s->known_squares,
                 none = squares + s->known_squares, variance = own / freedom;
    double normal[PLACE * PLACE];
    if (!c->known)
        return -INFINITY;
    memcpy(normal, c->covariance, sizeof normal);
    if (!dense_cholesky(PLACE, normal))
        return -INFINITY;
    double volume = 0.5 * dense_log_determinant(PLACE, normal) + 0.5 * PLACE * log(PI2 * variance);
    for (size_t k = 0; k < PLACE; k++) {
        double low, high;
        range_of_parameter(s, k, &low, &high);
        volume -= log(high - low);
    }
    return -0.5 * freedom * log(own / none) + fmin(volume, 0.0);
}

/* Width of the interval of log stiffness of each of them. */
static double width_of_stiffness(size_t i) {
    const double before = i > 0 ? STIFFNESS[i - 1] : 1.0,
                 after = i + 1 < STIFFNESSES ? STIFFNESS[i + 1] : STIFFNESS[i];
    return 0.5 * log(after / before);
}

/* Sum over all stiffnesses; posterior[i] is the share of each. The other side of 1 has as much prior. */
static double evidence_of_all(const search *s, const candidate found[STIFFNESSES], double squares,
                              double posterior[STIFFNESSES]) {
    double sum = 0.0, widths = 0.0, most = -INFINITY;
    for (size_t i = 0; i < STIFFNESSES; i++) {
        posterior[i] = evidence_of_ball(s, &found[i], squares) + log(width_of_stiffness(i));
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

/* The ball of the most probable stiffness, whose index is returned, and intervals over all. */
static size_t find_intervals(const search *s, const candidate found[STIFFNESSES],
                             const double posterior[STIFFNESSES], palp_palpation *result) {
    static const double TAIL = 0.025;
    const size_t freedom = s->known + (s->n > ALL + 2 ? s->n - ALL - 1 : 1);
    palp_palpation_value *value[PLACE] = {&result->x_m, &result->y_m, &result->z_m, &result->radius_m};
    size_t best = 0;
    for (size_t i = 1; i < STIFFNESSES; i++)
        best = posterior[i] > posterior[best] ? i : best;
    for (size_t k = 0; k < PLACE; k++) {
        mixture m = {.n = STIFFNESSES};
        double least, most;
        range_of_parameter(s, k, &least, &most);
        for (size_t i = 0; i < STIFFNESSES; i++) {
            m.share[i] = posterior[i];
            m.mean[i] = found[i].p[k];
            m.sd[i] = statistics_student_widening(freedom) *
                      sqrt((found[i].squares + s->known_squares) / (double)freedom *
                           found[i].covariance[k * PLACE + k]);
            m.sd[i] = fmax(fmin(m.sd[i], most - least), 1e-9);
        }
        const double low = quantile_of_mixture(&m, TAIL, least, most),
                     high = quantile_of_mixture(&m, 1.0 - TAIL, least, most);
        *value[k] = k < 3 ? (palp_palpation_value){s->edge * found[best].p[k], s->edge * low, s->edge * high}
                          : (palp_palpation_value){s->edge * exp(found[best].p[k]), s->edge * exp(low),
                                                   s->edge * exp(high)};
    }
    find_interval_of_stiffness(found, posterior, TAIL, &result->stiffness);
    result->stiffness.best = exp(found[best].log_stiffness);
    return best;
}

/* ---- the next press ------------------------------------------------------------------------------- */

/* Parameter a of press i, of slope[all] by parameters: the gain is the last. */
static double slope_of_press(const double *slope, size_t all, size_t a, size_t i) {
    return a < ALL ? slope[a * all + i] : 1.0;
}

/* Information of the first n presses on place, radius, stiffness and gain: its factor. */
static bool factor_information(size_t n, const double *slope, size_t all,
                               double normal[WITH_GAIN * WITH_GAIN]) {
    for (size_t a = 0; a < WITH_GAIN; a++)
        for (size_t b = 0; b < WITH_GAIN; b++) {
            normal[a * WITH_GAIN + b] = a == b ? 1e-9 : 0.0;
            for (size_t i = 0; i < n; i++)
                normal[a * WITH_GAIN + b] +=
                    slope_of_press(slope, all, a, i) * slope_of_press(slope, all, b, i);
        }
    return dense_cholesky(WITH_GAIN, normal);
}

/* The candidate, of those from n on, whose force is least certain given the first n presses: it adds most
 * information. */
static size_t find_least_certain(size_t n, const double *slope, size_t all, const double *normal) {
    size_t next = all;
    double most = -1.0;
    for (size_t i = n; i < all; i++) {
        double g[WITH_GAIN];
        for (size_t a = 0; a < WITH_GAIN; a++)
            g[a] = slope_of_press(slope, all, a, i);
        dense_forward(WITH_GAIN, normal, 1, g);
        const double told = dense_dot(WITH_GAIN, g, g);
        next = told > most ? i : next;
        most = fmax(most, told);
    }
    return next;
}

/* Derivatives slope[ALL n] of all presses of the search by the parameters of this ball. */
static palp_status find_slopes(search *s, const candidate *found, double *slope) {
    s->log_stiffness = found->log_stiffness;
    palp_status status = place_ball(s, found->p);
    if (!status)
        status = solve_presses(s, NULL);
    if (!status)
        status = work_of_held_nodes(s, s->elastic);
    for (size_t k = 0; k < ALL && !status; k++)
        status = slope_by_parameter(s, found->p, k, slope + k * s->n);
    return status;
}

/* Presses all candidates too, with the ball found. */
static palp_status choose_next_press(const search *s, const candidate *best, palp_palpation *result) {
    const size_t more = s->settings->n_candidates, all = s->n + more;
    double normal[WITH_GAIN * WITH_GAIN];
    result->next = more;
    if (more == 0)
        return PALP_OK;
    palp_palpation_press *press = malloc(all * sizeof *press);
    double *x = malloc(LEVELS * 3 * s->n_nodes * all * sizeof *x),
           *slope = malloc((ALL + 3) * all * sizeof *slope);
    palp_status status = press && x && slope ? PALP_OK : PALP_ERR_NO_MEMORY;
    if (!status) {
        search own = *s;
        memcpy(press, s->press, s->n * sizeof *press);
        memcpy(press + s->n, s->settings->candidate, more * sizeof *press);
        own.n = all;
        own.press = press;
        own.x = x;
        own.solved = false;
        own.work = slope + ALL * all;
        own.elastic = own.work + all;
        own.moved = own.elastic + all;
        status = find_slopes(&own, best, slope);
    }
    if (!status && factor_information(s->n, slope, all, normal))
        result->next = find_least_certain(s->n, slope, all, normal) - s->n;
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
        return palp_error_set(error, PALP_ERR_ARGUMENT, "a ball needs at least %d presses", FEWEST);
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
    palp_region *ball_region = &s->source->regions[s->source->n_regions++];
    *ball_region = (palp_region){.shape = PALP_REGION_OF_MESH, .stiffness = 1.0};
    memcpy(ball_region->name, BALL, sizeof BALL);
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

static palp_status solve_without_ball(search *s, palp_error *error) {
    double p[PLACE] = {0.0};
    for (int k = 0; k < 3; k++)
        p[k] = 0.5 * (s->low[k] + s->high[k]) / s->edge;
    s->log_stiffness = 0.0;
    palp_status status = place_ball(s, p);
    return status ? status : solve_presses(s, error);
}

/* A lattice has an error at its borders and between its nodes. It is measured against a finer lattice of the
 * tissue without a ball, as log[n] of the forces. It is taken to be the same with a ball. The finer lattice
 * has an error as well. Its prior size is the same, which counts as so many presses. */
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
    fine.touched = fine.bare = NULL;
    fine.x = NULL;
    fine.solved = false;
    fine.work = more;
    fine.source->n_regions--; /* the ball is not of the mesh yet */
    palp_status status = palp_model_mesh(&fine.model, &fine.mesh, NULL);
    fine.source->n_regions++;
    if (!status) {
        fine.n_nodes = fine.mesh->n_nodes;
        fine.x = malloc(3 * fine.n_nodes * LEVELS * fine.n * sizeof *fine.x);
        status = fine.x ? solve_without_ball(&fine, NULL) : PALP_ERR_NO_MEMORY;
    }
    for (size_t i = 0; i < s->n; i++)
        more[i] = status ? 0.0 : log(more[i]) - log(s->work[i]);
    palp_network_free(fine.touched);
    palp_mesh_free(fine.mesh);
    free(fine.x);
    free(fine.source);
    return is_lost(status) ? PALP_OK : status;
}

/* The tissue alone: residual[n] and its squares. */
static palp_status press_tissue_alone(search *s, double *residual, double *squares, palp_error *error) {
    palp_status status = solve_without_ball(s, error);
    if (!status)
        status = measure_lattice_error(s, residual);
    for (size_t i = 0; i < s->n && !status; i++)
        s->wanted[i] -= residual[i];
    subtract_mean(s->n, s->wanted);
    subtract_mean(s->n, residual);
    s->known_squares = KNOWN * dense_dot(s->n, residual, residual) / (double)s->n;
    s->known = s->known_squares > 0.0 ? KNOWN : 0;
    if (!status)
        status = work_of_held_nodes(s, s->elastic);
    for (size_t i = 0; i < s->n && !status; i++)
        residual[i] = s->wanted[i] - log(s->work[i]);
    if (!status) {
        subtract_mean(s->n, residual);
        *squares = dense_dot(s->n, residual, residual);
    }
    return status;
}

static palp_status fit_first_ball(search *s, const start found[STARTS], candidate *best) {
    palp_status status = PALP_OK;
    best->squares = INFINITY;
    for (size_t i = 0; i < STARTS && !status; i++) {
        candidate c = {.log_stiffness = found[i].sign * log(FIRST)};
        if (!(found[i].score > 0.0))
            continue;
        memcpy(c.p, found[i].p, sizeof c.p);
        status = fit_ball(s, 12, &c);
        if (!status && c.squares < best->squares)
            *best = c;
    }
    return status;
}

static palp_status search_for_ball(search *s, double *residual, palp_palpation *result, palp_error *error) {
    start from[STARTS];
    candidate first = {0}, found[STIFFNESSES];
    double squares, mean = statistics_mean(s->wanted, s->n);
    subtract_mean(s->n, s->wanted);
    s->planned = 1.0 + 12.0 * STARTS + 9.0 * STIFFNESSES;
    palp_status status = press_tissue_alone(s, residual, &squares, error);
    if (!status)
        status = scan_for_starts(s, residual, from);
    if (!status)
        status = fit_first_ball(s, from, &first);
    if (status || isinf(first.squares))
        return status ? status : PALP_ERR_NOT_CONVERGED;
    status = fit_all_stiffnesses(s, &first, found);
    if (status)
        return status;
    double posterior[STIFFNESSES];
    result->evidence = evidence_of_all(s, found, squares, posterior);
    result->found = result->evidence > log((1.0 - s->settings->false_alarm) / s->settings->false_alarm);
    const candidate *best = &found[find_intervals(s, found, posterior, result)];
    result->scatter = sqrt(squares / ((double)s->n - 1.0));
    result->scatter_found = sqrt(best->squares / fmax(1.0, (double)s->n - ALL - 1.0));
    result->gain = exp(best->gain + mean);
    return choose_next_press(s, best, result);
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
    search s = {.model = *model, .settings = settings, .n = n, .press = presses};
    double *residual = malloc(n * sizeof *residual);
    memset(result, 0, sizeof *result);
    status = residual ? prepare_search(&s, model, mesh) : PALP_ERR_NO_MEMORY;
    if (!status)
        status = search_for_ball(&s, residual, result, error);
    free(residual);
    free(s.x);
    free(s.wanted);
    free(s.source);
    palp_network_free(s.touched);
    palp_network_free(s.bare);
    palp_mesh_free(s.mesh);
    if (status && error && error->status != status)
        palp_error_set(error, status, "%s", palp_status_text(status));
    return status;
}
