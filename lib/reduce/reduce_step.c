/* reduce_step.c: one time step of a reduced model: Newton with a tangent that is renewed in parts. */
#include "base/dense.h"
#include "reduce_internal.h"

#include <math.h>
#include <string.h>

static const double SLOW =
    0.3; /* a kept tangent that reduces the residual less than to this share is renewed at once */
static const double SHORTEST = 0.02; /* shortest step of the line search */
enum { TICKS = 24 };                 /* number of steps in which the tangent is renewed, a share in each */

static void renew_reduced_stiffness(palp_reduced *r) {
    memset(r->stiffness, 0, r->modes * r->modes * sizeof *r->stiffness);
    reduced_stiffness(r, 0, r->n_elements, r->stiffness);
    r->stiff = true;
    r->refreshed = 0;
}

/* Computes a share of the next tangent from the present state; the tangent is replaced when all shares are
 * there. */
static void refresh_share_of_tangent(palp_reduced *r) {
    size_t share = (r->n_elements + TICKS - 1) / TICKS, to = r->refreshed + share;
    if (r->refreshed == 0)
        memset(r->coming, 0, r->modes * r->modes * sizeof *r->coming);
    to = to < r->n_elements ? to : r->n_elements;
    reduced_stiffness(r, r->refreshed, to, r->coming);
    r->refreshed = to;
    if (to == r->n_elements) {
        double *old = r->stiffness;
        r->stiffness = r->coming;
        r->coming = old;
        r->refreshed = 0;
    }
}

/* Evaluates elements and tools at next; gives the residual and the norm at which it is converged. */
static bool evaluate_reduced_residual(palp_reduced *r, double *drive, double *residual, double *scale) {
    if (!reduced_evaluate(r, drive))
        return false;
    if (r->surface)
        reduced_contact_evaluate(r, drive);
    double force = 0.0, noise = 0.0;
    for (size_t i = 0; i < r->n_elements; i++) {
        double f = r->reach[i] * r->force[i], t = r->reach[i] * r->tangent[i];
        force += f * f;
        noise += t * t;
    }
    *residual = sqrt(dense_dot(r->modes, r->rhs, r->rhs));
    *scale = r->tolerance * sqrt(force) + 2e-15 * sqrt(noise);
    return true;
}

/* Copies the kept tangent to factor and adds that of the tools. */
static void assemble_total_tangent(palp_reduced *r) {
    memcpy(r->factor, r->stiffness, r->modes * r->modes * sizeof *r->factor);
    if (r->surface)
        reduced_contact_stiffness(r, r->factor);
}

/* Factors the tangent, as L D L' if it is not positive definite. */
static palp_status factor_total_tangent(palp_reduced *r) {
    assemble_total_tangent(r);
    r->definite = dense_cholesky(r->modes, r->factor);
    if (r->definite)
        return PALP_OK;
    assemble_total_tangent(r);
    return dense_ldl(r->modes, r->factor, r->pivot, r->work) ? PALP_OK : PALP_ERR_SINGULAR;
}

static void solve_newton_direction(palp_reduced *r) {
    memcpy(r->dq, r->rhs, r->modes * sizeof *r->dq);
    memcpy(r->start, r->next.q, r->modes * sizeof *r->start);
    if (r->definite)
        dense_cholesky_solve(r->modes, r->factor, 1, r->dq);
    else
        dense_ldl_solve(r->modes, r->factor, r->pivot, 1, r->dq);
}

typedef struct progress {
    double drive, residual, scale;
    int iterations;
} progress;

/* Moves along dq; with a kept tangent tries the full step only. */
static bool advance_along_newton_step(palp_reduced *r, bool kept, progress *p) {
    double before = p->residual;
    for (double alpha = 1.0; alpha >= SHORTEST; alpha *= 0.5) {
        for (size_t i = 0; i < r->modes; i++)
            r->next.q[i] = r->start[i] + alpha * r->dq[i];
        if (evaluate_reduced_residual(r, &p->drive, &p->residual, &p->scale) &&
            (p->residual <= (1.0 - 1e-4 * alpha) * before || p->residual <= p->scale))
            return true;
        if (kept)
            break;
    }
    return false;
}

static palp_status iterate_newton_to_tolerance(palp_reduced *r, progress *p) {
    bool kept = r->stiff;
    while (p->residual > p->scale) {
        if (p->iterations++ == r->max_iterations)
            return PALP_ERR_NOT_CONVERGED;
        if (!kept)
            renew_reduced_stiffness(r);
        double before = p->residual;
        palp_status status = factor_total_tangent(r);
        if (status)
            return status;
        solve_newton_direction(r);
        if (advance_along_newton_step(r, kept, p)) {
            kept = p->residual <= SLOW * before;
            continue;
        }
        memcpy(r->next.q, r->start, r->modes * sizeof *r->start);
        if (!kept || !evaluate_reduced_residual(r, &p->drive, &p->residual, &p->scale))
            return PALP_ERR_NOT_CONVERGED;
        kept = false;
    }
    return PALP_OK;
}

/* Solves from the last state, extrapolated if asked. */
static palp_status solve_reduced_equilibrium(palp_reduced *r, double share, progress *p) {
    enum { ROUNDS = 5 };
    palp_status status = PALP_OK;
    for (size_t i = 0; i < r->modes; i++)
        r->next.q[i] = r->now.q[i] + share * (r->now.q[i] - r->past[i]);
    for (int i = 0; i < ROUNDS && !status; i++) {
        status = evaluate_reduced_residual(r, &p->drive, &p->residual, &p->scale)
                     ? iterate_newton_to_tolerance(r, p)
                     : PALP_ERR_COLLAPSED;
        if (!status && !(r->surface && reduced_contact_refresh(r)))
            return PALP_OK;
    }
    return status ? status
           : evaluate_reduced_residual(r, &p->drive, &p->residual, &p->scale)
               ? iterate_newton_to_tolerance(r, p)
               : PALP_ERR_COLLAPSED;
}

/* How far a coordinate is outside its range in the snapshots, in widths of that range; large coordinates
 * count. */
static double distance_beyond_snapshots(const palp_reduced *r) {
    double beyond = 0.0, width = 0.0;
    for (size_t i = 0; i < r->modes; i++)
        width = fmax(width, r->high[i] - r->low[i]);
    for (size_t i = 0; i < r->modes && width > 0.0; i++)
        beyond = fmax(beyond, fmax(r->low[i] - r->next.q[i], r->next.q[i] - r->high[i]) / width);
    double travel = r->high[r->modes] - r->low[r->modes], depth = r->next.depth;
    double by = fmax(r->low[r->modes] - depth, depth - r->high[r->modes]);
    return by > 0.0 ? fmax(beyond, travel > 0.0 ? by / travel : INFINITY) : beyond;
}

/* The relative bound times the largest force so far, or times that usual on such paths. */
static double expected_force_error(const palp_reduced *r, double beyond) {
    const palp_reduced_summary *s = &r->summary;
    return isinf(s->bound) ? INFINITY : s->bound * (1.0 + beyond) * fmax(r->peak, s->held_out_peak_N);
}

static void commit_reduced_step(palp_reduced *r, double dt) {
    double *old = r->past;
    r->past = r->now.q;
    r->now.q = old;
    reduced_state state = r->now;
    r->now = r->next;
    r->next = state;
    r->past_step = dt;
}

static palp_status check_step_arguments(const palp_reduced *r, double depth, double dt) {
    bool rate = r->material.dashpot_Ns > 0.0;
    return !isfinite(depth) || !(dt >= 0.0) || (dt == 0.0 && rate) ? PALP_ERR_ARGUMENT : PALP_OK;
}

palp_status palp_reduced_step(palp_reduced *r, double depth_m, size_t n_tools, const palp_tool *tools,
                              double dt_s, palp_tool_force *force, palp_reduced_info *info) {
    if (!r || (n_tools > 0 && !tools))
        return PALP_ERR_ARGUMENT;
    progress p = {.iterations = 0};
    palp_status status = check_step_arguments(r, depth_m, dt_s);
    if (!status && n_tools > r->max_tools)
        status = PALP_ERR_ARGUMENT;
    if (!status && r->surface)
        status = reduced_contact_begin(r, n_tools, tools);
    if (status)
        return status;
    element_step_prepare(&r->material, dt_s, &r->step);
    r->next.depth = depth_m;
    r->next.time = r->now.time + (isinf(dt_s) ? 0.0 : dt_s);
    double share = r->past_step > 0.0 && isfinite(dt_s) ? fmin(dt_s / r->past_step, 2.0) : 0.0;
    status = solve_reduced_equilibrium(r, share, &p);
    if (status && share > 0.0) {
        if (r->surface)
            reduced_contact_begin(r, n_tools, tools);
        status = solve_reduced_equilibrium(r, 0.0, &p);
    }
    if (status)
        return status;
    double squares = p.drive * p.drive;
    size_t contacts = r->surface ? reduced_contact_commit(r, force, &squares) : 0;
    r->next.force = p.drive;
    r->peak = fmax(r->peak, sqrt(squares));
    refresh_share_of_tangent(r);
    if (info) {
        double beyond = distance_beyond_snapshots(r), largest = 0.0;
        for (size_t i = 0; i < r->n_elements; i++)
            largest = fmax(largest, fabs(r->strain[i]));
        *info = (palp_reduced_info){.iterations = p.iterations,
                                    .converged = true,
                                    .residual = p.scale > 0.0 ? r->tolerance * p.residual / p.scale : 0.0,
                                    .force_N = p.drive,
                                    .force_error_N = expected_force_error(r, beyond),
                                    .outside = beyond,
                                    .contacts = contacts,
                                    .beyond = palp_law_beyond(&r->material.law, largest)};
    }
    commit_reduced_step(r, isfinite(dt_s) ? dt_s : 0.0);
    return PALP_OK;
}
