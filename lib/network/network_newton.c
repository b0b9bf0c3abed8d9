/* network_newton.c: damped Newton iteration for one equilibrium, on either branch. */
#include "base/dense.h"
#include "network_internal.h"

#include <math.h>
#include <string.h>

static const double SLOW =
    0.3; /* a kept factor is rebuilt if a step reduces the residual less than to this share */
static const double NEAR =
    1e3; /* within this multiple of the tolerance the last step's factor is good enough */
static const double AT_FOLD =
    10.0; /* multiple of the tolerance accepted where Newton's direction brings no improvement */
static const double SHORTEST = 1e-7;    /* energy line search: smallest step */
static const double STUCK = 0.02;       /* residual line search: a shorter step counts as no progress */
enum { STANDSTILL = 6 };                /* consecutive full iterations without notable progress */
static const double FIRST_SHIFT = 1e-4; /* relative to the largest diagonal, to make a tangent definite */

static void gather_free_coordinates(const palp_network *net, double *x) {
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0)
            x[net->dof[i]] = net->next.x[i];
}

/* next.x = start + alpha dx, then evaluates. */
static bool move_along_newton_step(palp_network *net, double alpha) {
    for (size_t i = 0; i < 3 * net->n_nodes; i++)
        if (net->dof[i] >= 0)
            net->next.x[i] = net->start[net->dof[i]] + alpha * net->dx[net->dof[i]];
    return network_evaluate(net);
}

/* dx = K^-1 rhs with the present factor; start = next's unknowns. */
static void solve_newton_direction(palp_network *net, palp_step_info *info) {
    memcpy(net->dx, net->rhs, net->n_free * sizeof *net->dx);
    network_solve(net, net->dx);
    gather_free_coordinates(net, net->start);
    info->iterations++;
}

/* Halves the step until the residual falls; with one_step tries only the full step. */
static bool halve_until_residual_falls(palp_network *net, bool one_step, double *residual, double *scale) {
    double before = *residual;
    for (double alpha = 1.0; alpha >= STUCK; alpha *= 0.5) {
        if (move_along_newton_step(net, alpha)) {
            *residual = network_residual(net, scale);
            if (*residual <= (1.0 - 1e-4 * alpha) * before || *residual <= *scale)
                return true;
        }
        if (one_step)
            break;
    }
    return false;
}

/* Newton iteration on the residual, for any sign of the tangent. Expensive factors are kept as long as they
 * contract. */
static palp_status solve_on_current_branch(palp_network *net, palp_step_info *info) {
    double scale, residual = network_residual(net, &scale);
    bool keep = net->factored && (net->reuse_factor || residual <= NEAR * scale);
    for (int i = 0, idle = 0; residual > scale; i++) {
        if (i == net->settings.max_iterations || idle == STANDSTILL)
            return PALP_ERR_NOT_CONVERGED;
        if (!keep) {
            palp_status status = network_factor(net, 0.0, &info->negative_pivots);
            net->factored = !status;
            if (status)
                return status;
        }
        double before = residual;
        solve_newton_direction(net, info);
        if (halve_until_residual_falls(net, keep, &residual, &scale)) {
            idle = !keep && residual > 0.8 * before ? idle + 1 : 0;
            keep = net->reuse_factor && residual <= SLOW * before;
            continue;
        }
        if (!move_along_newton_step(net, 0.0))
            return PALP_ERR_NOT_CONVERGED;
        residual = network_residual(net, &scale);
        if (!keep && residual <= AT_FOLD * scale)
            break;
        if (!keep)
            return PALP_ERR_NOT_CONVERGED;
        keep = false;
    }
    info->residual = scale > 0.0 ? net->settings.tolerance * residual / scale : 0.0;
    return PALP_OK;
}

/* Factors the tangent, with a shift if that is needed to make it positive definite. *shift = 0: not
 * needed. */
static palp_status factor_positive_definite(palp_network *net, double *shift) {
    int negative = 0;
    palp_status status = network_factor(net, 0.0, &negative);
    *shift = 0.0;
    if (!status && negative == 0)
        return PALP_OK;
    double largest = 0.0;
    for (size_t i = 0; i < 6 * net->n_nodes; i++)
        largest = fmax(largest, fabs(net->node_block[i]));
    for (*shift = FIRST_SHIFT * largest; *shift < 1e3 * largest; *shift *= 2.0) {
        status = network_factor(net, *shift, &negative);
        if (!status && negative == 0)
            return PALP_OK;
    }
    return PALP_ERR_SINGULAR;
}

/* Armijo line search along dx on the energy, or on the slope along dx if there is no energy. */
static bool search_line_downhill(palp_network *net, double *residual, double *scale) {
    double energy, start, slope = -dense_dot(net->n_free, net->rhs, net->dx), before = *residual;
    bool known = network_energy(net, &start);
    for (double alpha = 1.0; alpha >= SHORTEST; alpha *= 0.5) {
        if (!move_along_newton_step(net, alpha))
            continue;
        *residual = network_residual(net, scale);
        if (*residual <= *scale)
            return true;
        if (!known) {
            if (-dense_dot(net->n_free, net->rhs, net->dx) <= -0.5 * slope)
                return true;
        } else if (network_energy(net, &energy) &&
                   (energy <= start + 1e-4 * alpha * slope ||
                    (energy <= start + 1e-13 * fabs(start) && *residual <= 0.5 * before)))
            return true;
    }
    return false;
}

/* At an unstable equilibrium: a step along the softest direction of the shifted factor that lowers the
 * energy. The direction is found from fixed numbers, so that the result is reproducible. */
static bool leave_unstable_equilibrium(palp_network *net) {
    enum { ROUNDS = 40 };
    double *v = net->dx, start, energy, largest = 0.0;
    for (size_t i = 0; i < net->n_free; i++)
        v[i] = (double)((i * 7919 + 13) % 1009) / 1009.0 - 0.5;
    for (int k = 0; k < ROUNDS; k++) {
        double norm = sqrt(dense_dot(net->n_free, v, v));
        for (size_t i = 0; i < net->n_free; i++)
            v[i] /= norm;
        network_solve(net, v);
    }
    for (size_t i = 0; i < net->n_free; i++)
        largest = fmax(largest, fabs(v[i]));
    bool known = network_energy(net, &start);
    gather_free_coordinates(net, net->start);
    for (double reach = 0.02 * net->extent; reach > 1e-9 * net->extent; reach *= 0.5)
        for (int sign = 1; sign >= -1; sign -= 2)
            if (move_along_newton_step(net, sign * reach / largest) &&
                (!known || (network_energy(net, &energy) && energy < start)))
                return true;
    return false;
}

static palp_status solve_on_stable_branch(palp_network *net, palp_step_info *info) {
    double scale, shift, residual = network_residual(net, &scale);
    for (int i = 0; i < 4 * net->settings.max_iterations; i++) {
        palp_status status = factor_positive_definite(net, &shift);
        net->factored = !status;
        if (status)
            return status;
        net->left_branch = net->left_branch || shift > 0.0;
        if (residual <= scale) {
            if (shift == 0.0) {
                info->negative_pivots = 0;
                info->residual = scale > 0.0 ? net->settings.tolerance * residual / scale : 0.0;
                return PALP_OK;
            }
            if (!leave_unstable_equilibrium(net))
                return PALP_ERR_BUCKLED;
            residual = network_residual(net, &scale);
            continue;
        }
        solve_newton_direction(net, info);
        if (!search_line_downhill(net, &residual, &scale))
            return PALP_ERR_NOT_CONVERGED;
    }
    return PALP_ERR_NOT_CONVERGED;
}

palp_status network_newton(palp_network *net, palp_step_info *info) {
    if (net->ranks)
        return net->ranks->newton(net->ranks, net, info);
    if (net->settings.branch == PALP_BRANCH_STABLE)
        return solve_on_stable_branch(net, info);
    palp_status status = solve_on_current_branch(net, info);
    return status == PALP_ERR_NOT_CONVERGED && info->negative_pivots > 0 ? PALP_ERR_BUCKLED : status;
}
