/* solid.c: fits the coefficients and the time dependence of a solid by least squares of the plate's force. By
 * virtual work the elastic force is the sum of coefficients times forces at the same deformation. Since the
 * energy is at its minimum, the derivative by a coefficient is that force. */
#include "solid_internal.h"

#include "base/dense.h"
#include "solve/levenberg.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A fitted solid has to be stable to a quarter beyond the deepest press: 3 of the 12 intervals between
 * knots. */
enum { KNOTS = 13, STABLE = KNOTS + 3, UNKNOWNS_MAX = PALP_SOLID_MAX + PALP_ARMS_MAX, EVALUATIONS = 40 };
static const double FIRST = 1e-3, NEAR_REST = 1e-2, FAR = 1e4; /* first knot, bounds over the first guess */

/* The plate's force by depth, of a solid with c0 = 1. */
typedef struct plate_table {
    double depth_m[STABLE];
    solid_feel feel[STABLE];
} plate_table;

typedef struct solid_problem {
    palp_solid solid;
    solid_body body;
    plate_table table;
    bool tabled;
    size_t n_press, n_unknowns;
    const palp_solid_press *press;
    double scale_Pa;
    double worst_N; /* of the last evaluation */
} solid_problem;

/* ---- the table ---- */

/* With stable also beyond the deepest press, where only the existence of an equilibrium matters. */
static palp_status make_table(solid_problem *p, const palp_solid *solid, double deepest_m, bool stable) {
    palp_solid unit = *solid;
    for (size_t k = 0; k < PALP_SOLID_MAX; k++)
        unit.c_Pa[k] = solid->c_Pa[k] / solid->c_Pa[0];
    const size_t bytes = palp_solid_count(solid->law) * sizeof unit.c_Pa[0];
    if (p->tabled && memcmp(unit.c_Pa, p->solid.c_Pa, bytes) == 0)
        return PALP_OK;
    for (size_t i = 0; i < STABLE; i++)
        p->table.depth_m[i] = deepest_m * (i == 0 ? FIRST : (double)i / (KNOTS - 1));
    p->tabled = false;
    palp_status status =
        solid_body_press(&p->body, &unit, stable ? STABLE : KNOTS, p->table.depth_m, p->table.feel);
    p->tabled = status == PALP_OK;
    p->solid = unit;
    return status;
}

/* Cubic through the four knots around the depth: of the forces over the depth, and of the viscous factor. */
static solid_feel feel_at(const plate_table *table, double depth_m) {
    solid_feel at = {{0}, 0};
    size_t first = 0;
    while (first + 4 < KNOTS && table->depth_m[first + 2] < depth_m)
        first++;
    for (size_t i = first; depth_m > 0.0 && i < first + 4; i++) {
        double weight = 1.0;
        for (size_t j = first; j < first + 4; j++)
            if (j != i)
                weight *= (depth_m - table->depth_m[j]) / (table->depth_m[i] - table->depth_m[j]);
        for (size_t k = 0; k < PALP_SOLID_MAX; k++)
            at.by_c_m2[k] += weight * table->feel[i].by_c_m2[k] * depth_m / table->depth_m[i];
        at.viscous += weight * table->feel[i].viscous;
    }
    return at;
}

/* ---- a press in time ---- */

typedef struct solid_state {
    double time_s, depth_m;
    solid_feel feel;
    double arm[PALP_ARMS_MAX][PALP_SOLID_MAX]; /* history of by_c_m2 */
} solid_state;

/* Advances to sample i and returns the force. gradient[n_unknowns]: by c, then by the shares, or by the
 * damping times c0 (SHEAR: the viscosity). */
static double advance(const solid_problem *p, const palp_solid *solid, const palp_solid_press *press,
                      size_t i, solid_state *state, double *gradient) {
    const size_t count = palp_solid_count(solid->law);
    const double dt = i > 0 ? press->time_s[i] - state->time_s : 0.0;
    const solid_feel feel = feel_at(&p->table, press->depth_m[i]);
    double force = 0.0;
    for (size_t k = 0; k < count; k++)
        gradient[k] = feel.by_c_m2[k];
    for (size_t j = 0; solid->time == PALP_SOLID_PRONY && j < solid->n_arms; j++) {
        const double rest = dt / solid->tau_s[j], keep = exp(-rest),
                     part = i > 0 ? -expm1(-rest) / rest : 1.0;
        gradient[count + j] = 0.0;
        for (size_t k = 0; k < count; k++) {
            state->arm[j][k] = keep * state->arm[j][k] + part * (feel.by_c_m2[k] - state->feel.by_c_m2[k]);
            gradient[k] += solid->share[j] * state->arm[j][k];
            gradient[count + j] += solid->c_Pa[k] * state->arm[j][k];
        }
    }
    for (size_t k = 0; k < count; k++)
        force += solid->c_Pa[k] * gradient[k];
    if (solid->time > PALP_SOLID_PRONY) {
        gradient[count] = i > 0 ? feel.viscous * (press->depth_m[i] - state->depth_m) / dt : 0.0;
        force += solid->damping * (solid->time == PALP_SOLID_SHEAR ? 1.0 : solid->c_Pa[0]) * gradient[count];
    }
    state->time_s = press->time_s[i];
    state->depth_m = press->depth_m[i];
    state->feel = feel;
    return force;
}

static size_t unknowns_of(const palp_solid *solid) {
    return palp_solid_count(solid->law) + (solid->time == PALP_SOLID_ELASTIC ? 0
                                           : solid->time == PALP_SOLID_PRONY ? solid->n_arms
                                                                             : 1);
}

static void from_unknowns(const double *x, double scale_Pa, palp_solid *solid) {
    const size_t count = palp_solid_count(solid->law);
    for (size_t k = 0; k < count; k++)
        solid->c_Pa[k] = scale_Pa * x[k];
    if (solid->time == PALP_SOLID_PRONY)
        memcpy(solid->share, x + count, solid->n_arms * sizeof *x);
    else if (solid->time != PALP_SOLID_ELASTIC)
        solid->damping = scale_Pa * x[count] / (solid->time == PALP_SOLID_SHEAR ? 1.0 : solid->c_Pa[0]);
}

/* ---- the fit ---- */

static double deepest_of(size_t n, const palp_solid_press *press) {
    double deepest = 0.0;
    for (size_t r = 0; r < n; r++)
        for (size_t i = 0; i < press[r].n; i++)
            deepest = fmax(deepest, press[r].depth_m[i]);
    return deepest;
}

static void add_sample(solid_problem *p, double off, const double *gradient, double *h, double *g,
                       double *chi2) {
    const size_t n = p->n_unknowns;
    for (size_t a = 0; a < n; a++) {
        g[a] += gradient[a] * off;
        for (size_t b = 0; b < n; b++)
            h[n * a + b] += gradient[a] * gradient[b];
    }
    *chi2 += off * off;
    p->worst_N = fmax(p->worst_N, fabs(off));
}

static palp_status evaluate(void *user, const double *x, double *h, double *g, double *chi2) {
    solid_problem *p = user;
    const size_t n = p->n_unknowns, count = palp_solid_count(p->solid.law);
    palp_solid solid = p->solid;
    from_unknowns(x, p->scale_Pa, &solid);
    palp_status status = make_table(p, &solid, deepest_of(p->n_press, p->press), p->body.stable);
    if (status)
        return status;
    memset(h, 0, n * n * sizeof *h);
    memset(g, 0, n * sizeof *g);
    *chi2 = p->worst_N = 0.0;
    for (size_t r = 0; r < p->n_press; r++) {
        const palp_solid_press *press = &p->press[r];
        solid_state state = {0};
        for (size_t i = 0; i < press->n; i++) {
            double gradient[UNKNOWNS_MAX];
            const double off = press->force_N[i] - advance(p, &solid, press, i, &state, gradient);
            for (size_t k = 0; k < n; k++)
                gradient[k] *= k < count || solid.time > PALP_SOLID_PRONY ? p->scale_Pa : 1.0;
            if (!press->use || press->use[i])
                add_sample(p, off, gradient, h, g, chi2);
        }
    }
    return PALP_OK;
}

static void keep(void *user) {
    (void)user;
}

/* The first guess: c0 alone, by least squares of an elastic solid; x = 1 there. */
static palp_status first_guess(solid_problem *p, double *x) {
    double ff = 0.0, fy = 0.0;
    p->solid.c_Pa[0] = 1.0;
    p->solid.c_Pa[1] = p->solid.c_Pa[2] = 0.0;
    palp_status status = make_table(p, &p->solid, deepest_of(p->n_press, p->press), false);
    for (size_t r = 0; !status && r < p->n_press; r++) {
        for (size_t i = 0; i < p->press[r].n; i++) {
            const double f = feel_at(&p->table, p->press[r].depth_m[i]).by_c_m2[0];
            ff += f * f;
            fy += f * p->press[r].force_N[i];
        }
    }
    memset(x, 0, UNKNOWNS_MAX * sizeof *x);
    x[0] = 1.0;
    p->scale_Pa = fy / ff;
    if (!status && !(p->scale_Pa > 0.0 && isfinite(p->scale_Pa)))
        status = PALP_ERR_ARGUMENT;
    return status;
}

static palp_status fit(solid_problem *p, palp_solid *solid, palp_solid_fit_info *info) {
    double x[UNKNOWNS_MAX], low[UNKNOWNS_MAX], high[UNKNOWNS_MAX], reach[UNKNOWNS_MAX];
    double h[UNKNOWNS_MAX * UNKNOWNS_MAX], g[UNKNOWNS_MAX], chi2 = 0.0;
    palp_status status = first_guess(p, x);
    if (status)
        return status;
    for (size_t k = 0; k < UNKNOWNS_MAX; k++) {
        const bool free_sign = k > 0 && k < palp_solid_count(p->solid.law);
        low[k] = k == 0 ? NEAR_REST : free_sign ? -FAR : 0.0;
        high[k] = FAR;
        reach[k] = FAR;
    }
    levenberg problem = {.n = p->n_unknowns,
                         .evaluations = EVALUATIONS,
                         .low = low,
                         .high = high,
                         .reach = reach,
                         .stop_relative = 1e-6,
                         .evaluate = evaluate,
                         .keep = keep,
                         .user = p};
    status = evaluate(p, x, h, g, &chi2);
    problem.stop_absolute = 1e-14 * chi2;
    status = status ? status : levenberg_solve(&problem, x, h, g, &chi2);
    status = status ? status : evaluate(p, x, h, g, &chi2);
    from_unknowns(x, p->scale_Pa, solid);
    for (size_t r = 0; r < p->n_press; r++) {
        for (size_t i = 0; i < p->press[r].n; i++) {
            if (!p->press[r].use || p->press[r].use[i]) {
                info->n++;
                info->peak_N = fmax(info->peak_N, fabs(p->press[r].force_N[i]));
            }
        }
    }
    info->rms_N = sqrt(chi2 / (double)(info->n > 0 ? info->n : 1));
    info->worst_N = p->worst_N;
    return status;
}

static bool good(const palp_solid *solid, const palp_mesh *mesh) {
    bool ok = solid && mesh && (unsigned)solid->law <= PALP_SOLID_ST_VENANT &&
              (unsigned)solid->time <= PALP_SOLID_SHEAR && solid->poisson >= 0.0 && solid->poisson < 0.5 &&
              solid->n_arms <= PALP_ARMS_MAX;
    for (size_t j = 0; ok && solid->time == PALP_SOLID_PRONY && j < solid->n_arms; j++)
        ok = solid->tau_s[j] > 0.0 && isfinite(solid->tau_s[j]);
    return ok;
}

static bool good_press(const palp_solid_press *press) {
    bool ok = press->n > 0 && press->time_s && press->depth_m && press->force_N;
    for (size_t i = 0; ok && i < press->n; i++)
        ok = isfinite(press->depth_m[i]) && isfinite(press->force_N[i]) && isfinite(press->time_s[i]) &&
             (i == 0 || press->time_s[i] > press->time_s[i - 1]);
    return ok;
}

palp_status palp_solid_fit(palp_solid *solid, const palp_mesh *mesh, size_t n, const palp_solid_press *press,
                           palp_solid_fit_info *info) {
    if (!good(solid, mesh) || n == 0 || !press || !info)
        return PALP_ERR_ARGUMENT;
    for (size_t r = 0; r < n; r++)
        if (!good_press(&press[r]))
            return PALP_ERR_ARGUMENT;
    if (!(deepest_of(n, press) > 0.0))
        return PALP_ERR_ARGUMENT;
    *info = (palp_solid_fit_info){0};
    solid_problem p = {.solid = *solid, .n_press = n, .press = press, .n_unknowns = unknowns_of(solid)};
    palp_status status = solid_body_create(mesh, solid->slides, &p.body);
    p.body.stable = palp_solid_count(solid->law) > 1; /* stability does not depend on a single one */
    status = status ? status : fit(&p, solid, info);
    solid_body_free(&p.body);
    return status;
}

palp_status palp_solid_run(const palp_solid *solid, const palp_mesh *mesh, const palp_solid_press *press,
                           double *force_N) {
    if (!good(solid, mesh) || !press || !force_N || !press->time_s || !press->depth_m)
        return PALP_ERR_ARGUMENT;
    solid_problem p = {.solid = *solid};
    palp_status status = solid_body_create(mesh, solid->slides, &p.body);
    const double deepest = deepest_of(1, press);
    if (!status && deepest > 0.0)
        status = make_table(&p, solid, deepest, false);
    solid_state state = {0};
    double gradient[UNKNOWNS_MAX];
    for (size_t i = 0; !status && i < press->n; i++)
        force_N[i] = deepest > 0.0 ? advance(&p, solid, press, i, &state, gradient) : 0.0;
    solid_body_free(&p.body);
    return status;
}

palp_status palp_solid_force(const palp_solid *solid, const palp_mesh *mesh, size_t n, const double *depth_m,
                             double *force_N) {
    if (!good(solid, mesh) || !depth_m || !force_N)
        return PALP_ERR_ARGUMENT;
    for (size_t i = 0; i < n; i++)
        if (!(depth_m[i] > (i > 0 ? depth_m[i - 1] : 0.0)) || !isfinite(depth_m[i]))
            return PALP_ERR_ARGUMENT;
    solid_body body;
    solid_feel *feel = malloc((n + 1) * sizeof *feel);
    palp_status status = solid_body_create(mesh, solid->slides, &body);
    status = status ? status : feel ? solid_body_press(&body, solid, n, depth_m, feel) : PALP_ERR_NO_MEMORY;
    for (size_t i = 0; !status && i < n; i++)
        force_N[i] = dense_dot(palp_solid_count(solid->law), feel[i].by_c_m2, solid->c_Pa);
    solid_body_free(&body);
    free(feel);
    return status;
}
